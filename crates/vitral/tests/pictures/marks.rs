//! Lines, points and edges: those that are nearest to the viewer lie just behind the fitted near
//! plane.

use super::common::{colors, exact, one};
use vitral::internals::scene::FreePart;
use vitral::{
    Camera, DVec3, Interpolation, LineClass, LineClasses, Lines, Material, Mesh, Projection,
    TransparencyOrder, solids,
};

/// Seen along z from `distance`, or without a perspective.
fn camera(distance: f64, perspective: bool) -> Camera {
    let projection = if perspective {
        Projection::Perspective { view_angle: 0.6 }
    } else {
        Projection::Parallel { height: 3.0 }
    };
    Camera {
        position: DVec3::new(0.0, 0.0, distance),
        focal_point: DVec3::ZERO,
        view_up: DVec3::Y,
        projection,
        clip: None,
    }
}

/// How many pixels of a picture of the mesh are light: edges on black ground are, and lines of this
/// material.
fn light_pixels(mesh: Mesh, lines: Lines, (side, samples): (u32, u32), camera: Camera) -> usize {
    let white =
        vitral::Reflectance::Phong { ka: [0.0; 3], kd: [1.0; 3], ks: [0.0; 3], shininess: 1.0 };
    let mut renderer =
        exact(one(mesh, Material { reflectance: white, ..Material::default() }), side, side);
    (renderer.settings.picture.lines, renderer.settings.picture.samples) = (lines, samples);
    // What is no edge stays dark.
    renderer.lights = Some(Vec::new());
    renderer.camera = Some(camera);
    colors(&mut renderer).iter().filter(|c| c[0] > 100).count()
}

#[test]
fn edges_of_the_nearest_face_are_seen_at_every_size() {
    for perspective in [true, false] {
        for (side, samples) in [(60, 1), (60, 4), (200, 4), (700, 1)] {
            let distance = if perspective { 4.5 } else { 3.0 };
            for lines in [Lines::Edges, Lines::Wireframe, Lines::WireframeHiddenLine] {
                let count = light_pixels(
                    solids::cuboid(DVec3::splat(2.0)),
                    lines,
                    (side, samples),
                    camera(distance, perspective),
                );
                // The front face fills at least half of the picture's side.
                let border = 4 * side as usize / 2;
                assert!(
                    count > border,
                    "{lines:?}, {side} pixels, {samples} samples: {count} of {border}"
                );
            }
        }
    }
}

/// A line across the picture at height `y`, in the colours of two corners.
fn colored_line(y: f32, z: [f32; 2], colors: [[f32; 4]; 2]) -> Mesh {
    Mesh {
        positions: vec![[-1.0, y, z[0]], [1.0, y, z[1]]],
        lines: vec![[0, 1]],
        colors: Some(vitral::Attribute::per_vertex(colors.to_vec())),
        ..Mesh::default()
    }
}

/// The colours of the row of pixels in the middle of a picture.
fn middle_row(mut renderer: vitral::Renderer, camera: Camera) -> Vec<[u8; 4]> {
    renderer.camera = Some(camera);
    let (width, height) =
        (renderer.settings.picture.width as usize, renderer.settings.picture.height as usize);
    colors(&mut renderer)[height / 2 * width..][..width].to_vec()
}

#[test]
fn colours_go_over_from_one_end_of_a_line_to_the_other() {
    let ends = [[1.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0]];
    let row = |mesh: Mesh, perspective, interpolation| {
        let mut scene = vitral::Scene::default();
        scene.add_mesh(mesh, vitral::DMat4::IDENTITY);
        let mut renderer = exact(scene, 81, 81);
        renderer.settings.shading.interpolation = interpolation;
        middle_row(renderer, camera(4.0, perspective))
    };
    // Across the picture of height 3, from pixel 13.5 to 67.5.
    let flat = row(colored_line(0.0, [0.0; 2], ends), false, Interpolation::Perspective);
    for (x, pixel) in flat.iter().enumerate().take(66).skip(15) {
        let t = (x as f32 + 0.5 - 13.5) / 54.0;
        let near = |seen: u8, expected: f32| (f32::from(seen) - 255.0 * expected).abs() < 4.0;
        assert!(
            near(pixel[0], 1.0 - t) && near(pixel[2], t) && pixel[1] == 0,
            "pixel {x}: {pixel:?}, {t}"
        );
    }
    // One end four times as far away: in the middle of the line on the screen a fifth of its length
    // is passed.
    let mut deep = colored_line(0.0, [2.0, -4.0], ends);
    (deep.positions[0][0], deep.positions[1][0]) = (-0.4, 1.6);
    let middle = |interpolation| {
        let row = row(deep.clone(), true, interpolation);
        let seen: Vec<usize> = (0..row.len()).filter(|&x| row[x][0] > 0 || row[x][2] > 0).collect();
        let at = row[(seen[0] + seen[seen.len() - 1]) / 2];
        f32::from(at[2]) / 255.0
    };
    let (space, screen) = (middle(Interpolation::Perspective), middle(Interpolation::Linear));
    assert!((screen - 0.5).abs() < 0.05 && space < screen - 0.2, "{space} {screen}");
}

#[test]
fn lines_of_blended_materials_let_light_through() {
    let material = |alpha_mode| Material {
        reflectance: vitral::Reflectance::Phong {
            ka: [0.0; 3],
            kd: [1.0; 3],
            ks: [0.0; 3],
            shininess: 1.0,
        },
        opacity: 0.5,
        alpha_mode,
        ..Material::default()
    };
    let seen = |alpha_mode, alpha: f32, transparency| {
        let mut mesh = colored_line(0.0, [0.0; 2], [[1.0, 1.0, 1.0, alpha]; 2]);
        FreePart::extend(&mut mesh.line_parts, 0..1, Some(0));
        let mut renderer = exact(one(mesh, material(alpha_mode)), 81, 81);
        renderer.settings.picture.background = vitral::Background::Color { color: [0.2, 0.0, 0.0] };
        renderer.settings.transparency.model = transparency;
        middle_row(renderer, camera(4.0, false))[40]
    };
    use vitral::AlphaMode;
    use vitral::Transparency;
    let linear = Transparency::Linear;
    assert_eq!(seen(AlphaMode::Opaque, 0.5, linear), [255; 4]);
    assert_eq!(seen(AlphaMode::Blend, 1.0, linear), [153, 128, 128, 255]);
    assert_eq!(seen(AlphaMode::Blend, 0.5, linear), [102, 64, 64, 255]);
    assert_eq!(seen(AlphaMode::Blend, 0.5, Transparency::None), [255; 4]);
    assert_eq!(seen(AlphaMode::Mask { cutoff: 0.4 }, 1.0, linear), [255; 4]);
    assert_eq!(seen(AlphaMode::Mask { cutoff: 0.6 }, 1.0, linear), [51, 0, 0, 255]);
}

#[test]
fn raw_colours_of_lines_and_faces_are_those_of_the_file() {
    for (from_srgb, byte) in [(true, 188), (false, 128)] {
        let mut line = colored_line(0.0, [0.0; 2], [[0.5, 0.5, 0.5, 1.0]; 2]);
        line.colors_from_srgb = from_srgb;
        let mut face = line.clone();
        face.positions = vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]];
        face.colors = Some(vitral::Attribute::per_vertex(vec![[0.5, 0.5, 0.5, 1.0]; 3]));
        (face.triangles, face.lines) = (vec![[0, 1, 2]], Vec::new());
        face.parts = vec![vitral::Part { name: String::new(), triangles: 0..1, material: None }];
        let white =
            vitral::Reflectance::Phong { ka: [0.0; 3], kd: [1.0; 3], ks: [0.0; 3], shininess: 1.0 };
        let unlit = Material { reflectance: white, unlit: true, ..Material::default() };
        for mesh in [line, face] {
            let row = middle_row(exact(one(mesh, unlit.clone()), 81, 81), camera(4.0, false));
            assert!(
                row[40][..3].iter().all(|&c| c.abs_diff(byte) <= 1),
                "{from_srgb}: {:?}",
                row[40]
            );
        }
    }
}

#[test]
fn flat_models_of_lines_and_points_alone_are_seen() {
    let positions = vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    let lines = Mesh {
        positions: positions.clone(),
        lines: vec![[0, 1], [1, 2], [2, 3], [3, 0]],
        ..Mesh::default()
    };
    let points = Mesh { positions, points: vec![0, 1, 2, 3], ..Mesh::default() };
    for perspective in [true, false] {
        for side in [60, 200, 700] {
            for (mesh, least) in [(&lines, side as usize), (&points, 4 * 4)] {
                let mut white = mesh.clone();
                FreePart::extend(&mut white.line_parts, 0..white.lines.len(), Some(0));
                FreePart::extend(&mut white.point_parts, 0..white.points.len(), Some(0));
                let count = light_pixels(white, Lines::None, (side, 1), camera(5.0, perspective));
                assert!(count >= least, "{side} pixels: {count} of {least}");
            }
        }
    }
}

#[test]
fn slanted_lines_are_as_dark_all_along() {
    // A white line over black, nearly upright: what each row of pixels gets of it is the same,
    // whichever samples it hits.
    let mut mesh = colored_line(0.0, [0.0; 2], [[1.0; 4]; 2]);
    mesh.positions = vec![[-0.13, -1.2, 0.0], [0.17, 1.2, 0.0]];
    for samples in [4, 9] {
        let mut scene = vitral::Scene::default();
        scene.add_mesh(mesh.clone(), vitral::DMat4::IDENTITY);
        let mut renderer = exact(scene, 90, 90);
        renderer.settings.picture.samples = samples;
        renderer.settings.picture.color_space = vitral::ColorSpace::Raw;
        renderer.camera = Some(camera(4.0, false));
        let picture = colors(&mut renderer);
        let rows = (15..75)
            .map(|y| picture[y * 90..][..90].iter().map(|c| f32::from(c[0]) / 255.0).sum::<f32>());
        let rows: Vec<f32> = rows.collect();
        let (least, most) =
            rows.iter().fold((f32::MAX, 0.0f32), |(low, high), &row| (low.min(row), high.max(row)));
        assert!(
            (1.2..1.4).contains(&least) && most - least < 0.15,
            "{samples} samples: {least} to {most}"
        );
    }
}

#[test]
fn clouds_of_points_are_no_heap_of_layers() {
    // Ten thousand points behind each other, and a glass pane in front of them and one behind.
    let deep = Mesh {
        positions: (0..10_000).map(|i| [0.0, 0.0, -1e-4 * i as f32]).collect(),
        points: (0..10_000).collect(),
        ..Mesh::default()
    };
    let glass = Material {
        opacity: 0.5,
        alpha_mode: vitral::AlphaMode::Blend,
        unlit: true,
        ..Material::default()
    };
    let mut scene = one(solids::cuboid(DVec3::new(2.0, 2.0, 3.0)), glass);
    scene.add_mesh(deep, vitral::DMat4::IDENTITY);
    let mut pictures = Vec::new();
    for (visibility, order) in [
        ("z-buffer", TransparencyOrder::A_BUFFER),
        ("z-buffer", TransparencyOrder::MULTI_PASS),
        ("warnock", TransparencyOrder::SORTED),
        ("bsp", TransparencyOrder::BACK_TO_FRONT),
        ("ray-cast", TransparencyOrder::A_BUFFER),
    ] {
        let mut renderer = exact(scene.clone(), 41, 41);
        renderer.settings.visibility = visibility.parse().unwrap();
        renderer.settings.transparency.order = order;
        renderer.settings.picture.samples = 4;
        renderer.camera = Some(camera(6.0, false));
        let rendered = renderer.render().unwrap();
        let picture = rendered.frame.color.unwrap();
        // The pane in front shows everywhere, over the points and over the pane behind.
        assert!(
            rendered.stats.picture.layer_samples < 3 * 41 * 41 * 4,
            "{visibility}: {:?}",
            rendered.stats.picture
        );
        pictures.push((visibility, picture));
    }
    let (_, first) = &pictures[0];
    assert_ne!(first.at(20, 20), first.at(5, 20), "the points are seen through the pane");
    for (name, picture) in &pictures {
        let far = picture
            .data()
            .iter()
            .zip(first.data())
            .filter(|(a, b)| (0..4).any(|k| a[k].abs_diff(b[k]) > 1));
        assert_eq!(far.count(), 0, "{name}");
    }
}

#[test]
fn lines_shine_with_their_emission() {
    let mut mesh = colored_line(0.0, [0.0; 2], [[1.0; 4]; 2]);
    FreePart::extend(&mut mesh.line_parts, 0..1, Some(0));
    let black =
        vitral::Reflectance::Phong { ka: [0.0; 3], kd: [0.0; 3], ks: [0.0; 3], shininess: 1.0 };
    let glowing = Material { reflectance: black, emission: [1.0, 0.0, 0.0], ..Material::default() };
    assert_eq!(
        middle_row(exact(one(mesh, glowing), 81, 81), camera(4.0, false))[40],
        [255, 0, 0, 255]
    );
}

/// Pixels of edges of the wanted classes, in a colour that nothing else has; seen from `eye`, one
/// sample a pixel.
fn edge_pixels(mesh: Mesh, eye: DVec3, classes: &[LineClass], width: f32) -> usize {
    let mut renderer = exact(one(mesh, Material::default()), 200, 200);
    let picture = &mut renderer.settings.picture;
    picture.lines = Lines::WireframeHiddenLine;
    (picture.line_width, picture.edge_color) = (width, Some([1.0, 0.0, 1.0]));
    picture.edge_classes = classes.iter().copied().collect();
    let projection = Projection::Parallel { height: 4.0 };
    renderer.camera = Some(Camera { projection, ..Camera::look_at(eye, DVec3::ZERO) });
    colors(&mut renderer).iter().filter(|c| **c == [255, 0, 255, 255]).count()
}

#[test]
fn edges_are_as_wide_as_asked_for() {
    let square = || solids::plane(2.0, 2.0, 1, 1);
    // Four sides of 100 pixels, with the corners: 100 w * 4, and more by the ends.
    for width in [1.0f32, 2.0, 5.0, 12.0] {
        let count =
            edge_pixels(square(), DVec3::new(0.0, 5.0, 1e-9), &[LineClass::Boundary], width) as f32;
        let expected = (100.0 + width) * (100.0 + width) - (100.0 - width) * (100.0 - width);
        assert!((count / expected - 1.0).abs() < 0.05, "{width}: {count} of {expected}");
    }
}

#[test]
fn wide_edges_are_not_eaten_by_the_faces_that_meet_in_them() {
    let eye = DVec3::new(3.0, 2.0, 4.0);
    let cube =
        |width| edge_pixels(solids::cuboid(DVec3::ONE), eye, &[LineClass::Smooth], width) as f32;
    let ratio = cube(8.0) / cube(2.0);
    assert!((3.5..4.1).contains(&ratio), "{ratio}");
}

#[test]
fn classes_choose_the_edges() {
    use LineClass::{Boundary, Contour, Crease, Material as Border, Smooth};
    let eye = DVec3::new(3.0, 2.0, 4.0);
    let cube = |classes: &[LineClass]| edge_pixels(solids::cuboid(DVec3::ONE), eye, classes, 1.0);

    // Nine edges of a cube are seen, six of them are its outline.
    assert_eq!([cube(&[Boundary]), cube(&[Border])], [0, 0]);
    let (outline, creases) = (cube(&[Contour]), cube(&[Crease]));
    assert_eq!(creases, cube(&[Smooth]));
    assert!(
        outline > 0 && (1.3..1.7).contains(&(creases as f64 / outline as f64)),
        "{creases} and {outline}"
    );

    // Of a sheet of four squares the border is a boundary; the cross within is neither crease nor
    // contour.
    let above = DVec3::new(0.0, 5.0, 1e-9);
    let sheet =
        |classes: &[LineClass]| edge_pixels(solids::plane(2.0, 2.0, 2, 2), above, classes, 1.0);
    assert_eq!([sheet(&[Crease]), sheet(&[Contour])], [0, 0]);
    let (border, all) = (sheet(&[Boundary]) as f64, sheet(&[Smooth]) as f64);
    assert!((1.4..1.6).contains(&(all / border)), "{all} and {border}");

    // A ball has an outline and no creases.
    let ball = |classes: &[LineClass]| edge_pixels(solids::sphere(1.0, 32, 16), eye, classes, 1.0);
    assert_eq!(ball(&[Crease]), 0);
    assert!((100..700).contains(&ball(&[Contour])), "{}", ball(&[Contour]));
}

#[test]
fn borders_of_materials_are_a_class() {
    let mut scene = vitral::Scene::default();
    let mut floor = solids::checkerboard(2.0, 2);
    for part in &mut floor.parts {
        part.material = Some(scene.add_material(Material::default()));
    }
    scene.add_mesh(floor, vitral::DMat4::IDENTITY);
    let mut renderer = exact(scene, 200, 200);
    let picture = &mut renderer.settings.picture;
    (picture.lines, picture.line_width, picture.edge_color) =
        (Lines::Edges, 1.0, Some([1.0, 0.0, 1.0]));
    picture.edge_classes = LineClasses::one(LineClass::Material);
    let projection = Projection::Parallel { height: 4.0 };
    renderer.camera =
        Some(Camera { projection, ..Camera::look_at(DVec3::new(0.0, 5.0, 1e-9), DVec3::ZERO) });
    let count = colors(&mut renderer).iter().filter(|c| **c == [255, 0, 255, 255]).count();
    // The cross of two lines of 100 pixels.
    assert!((190..=210).contains(&count), "{count}");
}

#[test]
fn edges_of_backs_that_are_not_seen_are_not_drawn() {
    let count = |lines, front_only, y: f64| {
        let material = Material { front_only, ..Material::default() };
        let mut renderer = exact(one(solids::plane(2.0, 2.0, 2, 2), material), 100, 100);
        (renderer.settings.picture.lines, renderer.settings.picture.edge_color) =
            (lines, Some([1.0, 0.0, 1.0]));
        renderer.camera = Some(Camera::look_at(DVec3::new(0.1, y, 0.2), DVec3::ZERO));
        colors(&mut renderer).iter().filter(|c| **c == [255, 0, 255, 255]).count()
    };
    for lines in [Lines::Edges, Lines::WireframeHiddenLine] {
        assert!(count(lines, true, 6.0) > 50 && count(lines, false, -6.0) > 50);
        assert_eq!(count(lines, true, -6.0), 0);
    }
    assert!(count(Lines::Wireframe, true, -6.0) > 50, "hidden ones, too");
}
