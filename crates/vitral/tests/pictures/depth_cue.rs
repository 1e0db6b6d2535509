//! P41: depth cueing. Light fades with distance, the same with every algorithm, on surfaces, glass,
//! mirrors and lines.

use super::common::{colors, exact, largest_difference, on_z, pixel, poster};
use vitral::internals::render::registry::VISIBILITY;
use vitral::internals::scene::FreePart;
use vitral::{
    AlphaMode, Background, Camera, DMat4, DVec3, DepthCue, Global, Lines, Material, Mesh,
    Projection, Reflectance, Renderer, Scene, Shading, solids,
};

/// A square towards +z.
fn add(scene: &mut Scene, side: f64, material: Material, place: DVec3) {
    let mut mesh = solids::plane(side, side, 1, 1);
    let material = Some(scene.add_material(material));
    mesh.parts.iter_mut().for_each(|p| p.material = material);
    scene.add_mesh(
        mesh,
        DMat4::from_translation(place) * DMat4::from_rotation_x(std::f64::consts::FRAC_PI_2),
    );
}

/// White squares at 2, 4 and 8 from a viewer at z = 0.
const PLACES: [DVec3; 3] =
    [DVec3::new(-0.5, 0.0, -2.0), DVec3::new(0.0, 0.0, -4.0), DVec3::new(2.0, 0.0, -8.0)];

fn squares() -> Scene {
    let mut scene = Scene::default();
    PLACES
        .into_iter()
        .zip([0.4, 0.8, 1.6])
        .for_each(|(place, side)| add(&mut scene, side, poster([1.0; 3]), place));
    scene
}

/// A viewer at the origin who looks along -z.
fn from_origin() -> Camera {
    Camera { position: DVec3::ZERO, focal_point: DVec3::NEG_Z, ..on_z(1.0, 0.7) }
}

const CUE: DepthCue =
    DepthCue { color: None, front: Some(3.0), back: Some(7.0), front_scale: 1.0, back_scale: 0.25 };

fn cued(scene: Scene, cue: DepthCue) -> Renderer {
    let mut r = exact(scene, 90, 60);
    r.camera = Some(from_origin());
    r.settings.picture.background = Background::Color { color: [0.0, 0.0, 0.4] };
    r.settings.picture.depth_cue = Some(cue);
    r
}

/// White of which the part `s` is left before the background of [`cued`].
fn faded(s: f32) -> [u8; 4] {
    [s, s, s + (1.0 - s) * 0.4, 1.0].map(|c| (c * 255.0).round() as u8)
}

#[test]
fn p41_what_is_farther_away_fades_by_the_formula() {
    for projection in
        [Projection::Perspective { view_angle: 0.7 }, Projection::Parallel { height: 3.0 }]
    {
        for shading in [Shading::Phong, Shading::Gouraud, Shading::Flat] {
            let mut r = cued(squares(), CUE);
            r.settings.shading.model = shading;
            r.camera = Some(Camera { projection, ..from_origin() });
            let picture = colors(&mut r);
            // Before the front plane, between the planes, behind the back plane.
            for (place, s) in PLACES.into_iter().zip([1.0, 0.8125, 0.25]) {
                let seen = pixel(&r, &picture, place);
                assert!(
                    largest_difference(&[seen], &[faded(s)]) <= 1,
                    "{place}: {seen:?}, not {:?}",
                    faded(s)
                );
            }
        }
    }
}

#[test]
fn p41_open_planes_lie_where_the_scene_begins_and_ends() {
    // Seen from the front, a sphere round the squares touches what is nearest and farthest but for
    // their sides.
    let mut r = cued(squares(), DepthCue::default());
    let sphere = r.world().bounds.bounding_sphere();
    let picture = colors(&mut r);
    for place in PLACES {
        let t = (-place.z - (-sphere.center.z - sphere.radius).max(0.0))
            / (2.0 * sphere.radius).min(-sphere.center.z + sphere.radius);
        let s = 1.0 + (0.2 - 1.0) * t.clamp(0.0, 1.0) as f32;
        assert!(
            largest_difference(&[pixel(&r, &picture, place)], &[faded(s)]) <= 1,
            "{place}: {s}"
        );
    }
}

#[test]
fn p41_every_algorithm_fades_alike_and_whole_scales_change_nothing() {
    let picture = |name: &str, cue: Option<DepthCue>| {
        let mut r = cued(squares(), CUE);
        (r.settings.picture.depth_cue, r.settings.visibility) = (cue, name.parse().unwrap());
        colors(&mut r)
    };
    let expected = picture("z-buffer", Some(CUE));
    for algorithm in VISIBILITY {
        assert!(picture(algorithm.name, Some(CUE)) == expected, "{}", algorithm.name);
    }
    let whole = DepthCue { back_scale: 1.0, ..CUE };
    assert!(
        picture("z-buffer", Some(whole)) == picture("z-buffer", None)
            && picture("z-buffer", None) != expected
    );
}

/// Panes of glass before a wall.
fn panes() -> Scene {
    let mut scene = Scene::default();
    add(&mut scene, 9.0, poster([1.0, 0.5, 0.1]), DVec3::new(0.0, 0.0, -6.0));
    for z in [-5.0, -4.0, -3.5] {
        let mut glass = Material { alpha_mode: AlphaMode::Blend, ..poster([0.1, 0.8, 0.3]) };
        glass.set_kt(0.6);
        add(&mut scene, 2.0, glass, DVec3::new(0.0, 0.0, z));
    }
    scene
}

#[test]
fn p41_rays_that_go_straight_see_what_layers_show() {
    for color in [None, Some([1.0, 0.0, 1.0])] {
        let cue = DepthCue { color, ..CUE };
        let layers = colors(&mut cued(panes(), cue));
        let mut r = cued(panes(), cue);
        r.settings.global.model = Global::RayTrace;
        let plain = {
            r.settings.picture.depth_cue = None;
            colors(&mut r)
        };
        r.settings.picture.depth_cue = Some(cue);
        let rays = colors(&mut r);
        assert!(largest_difference(&rays, &layers) <= 1);
        assert!(largest_difference(&rays, &plain) > 50);
    }
}

#[test]
fn p41_mirrors_and_bent_light_fade_with_the_surface_that_turns_it() {
    let nothing_left = DepthCue {
        color: Some([0.2, 0.4, 0.6]),
        front: Some(0.5),
        back: Some(1.0),
        back_scale: 0.0,
        ..CUE
    };
    let mirror = Reflectance::Phong { ka: [0.0; 3], kd: [0.0; 3], ks: [1.0; 3], shininess: 200.0 };
    let mirror = Material { reflectance: mirror, mirror: true, unlit: true, ..Material::default() };
    let mut ball = Material { alpha_mode: AlphaMode::Blend, ior: 1.5, ..poster([0.0; 3]) };
    ball.set_kt(0.9);
    for material in [mirror, ball] {
        let mut scene = Scene::default();
        let mut mesh = solids::sphere(1.0, 32, 16);
        let of_ball = Some(scene.add_material(material));
        mesh.parts.iter_mut().for_each(|p| p.material = of_ball);
        scene.add_mesh(mesh, DMat4::from_translation(DVec3::new(0.0, 0.0, -4.0)));
        add(&mut scene, 9.0, poster([1.0; 3]), DVec3::new(0.0, 0.0, -7.0));
        let mut r = cued(scene, nothing_left);
        r.settings.global.model = Global::RayTrace;
        let picture = colors(&mut r);
        let seen = largest_difference(&picture, &vec![[51, 102, 153, 255]; picture.len()]);
        assert!(seen <= 1, "all is faded: {seen}");
        r.settings.picture.depth_cue = None;
        assert!(colors(&mut r)[30 * 90 + 45] != [51, 102, 153, 255]);
    }
}

#[test]
fn p41_lines_and_points_fade_along_their_way() {
    let (near, far) = ([-0.4f32, -0.4, -3.0], [2.0f32, 1.0, -7.0]);
    let mut scene = Scene::default();
    let material = Some(scene.add_material(poster([1.0; 3])));
    let mut mesh = Mesh {
        positions: vec![near, far, [0.5, -1.0, -5.0]],
        lines: vec![[0, 1]],
        points: vec![2],
        ..Mesh::default()
    };
    FreePart::extend(&mut mesh.line_parts, 0..1, material);
    FreePart::extend(&mut mesh.point_parts, 0..1, material);
    scene.add_mesh(mesh, DMat4::IDENTITY);
    let mut r = cued(scene, CUE);
    (r.settings.picture.width, r.settings.picture.height) = (600, 400);
    let picture = colors(&mut r);
    let [near, far] = [near, far].map(|p| DVec3::from(p.map(f64::from)));
    for share in [0.1, 0.4, 0.7, 0.95] {
        let place = near.lerp(far, share);
        let seen = pixel(&r, &picture, place);
        let s = 1.0 - 0.75 * (-place.z as f32 - 3.0) / 4.0;
        assert!(
            largest_difference(&[seen], &[faded(s)]) <= 2,
            "{share}: {seen:?}, not {:?}",
            faded(s)
        );
    }
    assert!(
        largest_difference(&[pixel(&r, &picture, DVec3::new(0.5, -1.0, -5.0))], &[faded(0.625)])
            <= 1
    );
    // Edges of faces, too.
    let mut edges = cued(squares(), CUE);
    edges.settings.picture.lines = Lines::Wireframe;
    edges.settings.picture.background = Background::Color { color: [0.0; 3] };
    let brightest = |picture: &[[u8; 4]], columns: std::ops::Range<usize>| {
        picture
            .iter()
            .enumerate()
            .filter(|(i, _)| columns.contains(&(i % 90)))
            .map(|(_, c)| c[0])
            .max()
            .unwrap()
    };
    let picture = colors(&mut edges);
    let (left, right) = (brightest(&picture, 0..35), brightest(&picture, 58..90));
    assert!((i32::from(right) - i32::from(left) / 4).abs() <= 1, "{left} {right}");
}

#[test]
fn p41_numbers_without_sense_are_refused() {
    for (cue, background, part) in [
        (DepthCue { front_scale: 1.5, ..CUE }, None, "0 to 1"),
        (DepthCue { back: Some(3.0), ..CUE }, None, "farther away"),
        (DepthCue { front: Some(-1.0), ..CUE }, None, "at least 0"),
        (DepthCue { color: Some([2.0, 0.0, 0.0]), ..CUE }, None, "colour"),
        (CUE, Some(Background::Transparent), "colour to fade into"),
    ] {
        let mut r = cued(squares(), cue);
        r.settings.picture.background = background.unwrap_or(r.settings.picture.background);
        let error = r.render().unwrap_err().to_string();
        assert!(error.contains("depth cueing") && error.contains(part), "{error}");
    }
}
