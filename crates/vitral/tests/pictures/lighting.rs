//! The course's checks on illumination and shading that need whole pictures (docs/course.md L1-L22,
//! P30-P35).

use super::common::{
    all_channels, colors, colors_and_ids, exact, exact_builtin, largest_difference, on_z, one,
    project, sun,
};
use std::collections::{BTreeMap, HashSet};
use vitral::internals::math::DVec2;
use vitral::{
    Attenuation, Attribute, Camera, ColorSpace, DMat4, DQuat, DVec3, Encoding, Frame, Illumination,
    Light, LightKind, Material, Mesh, NodeTransform, Part, Plane, Projection, Reflectance,
    Renderer, Scene, Shading, Texture, TextureRef, View, lab, load_builtin, solids,
};

const BLACK: [u8; 4] = [0, 0, 0, 255];

#[test]
fn l1_unlit_disc_has_one_colour_and_lighting_gives_it_form() {
    let mut renderer = exact_builtin("sphere", 160, 120);
    let mut shades = |lighting| {
        renderer.settings.shading.lighting = lighting;
        let colors: HashSet<_> =
            colors(&mut renderer).into_iter().filter(|c| *c != BLACK).collect();
        colors.len()
    };
    assert_eq!(shades(false), 1, "a flat disc");
    assert!(shades(true) > 100, "a ball");
}

#[test]
fn l7_flat_one_colour_per_face() {
    for name in ["sphere", "cubs", "teapot"] {
        let mut renderer = exact_builtin(name, 200, 150);
        renderer.settings.shading.model = Shading::Flat;
        renderer.settings.picture.channels = all_channels();
        let frame = renderer.render().unwrap().frame;
        let mut of_face: BTreeMap<u32, HashSet<[u8; 4]>> = BTreeMap::new();
        for (color, id) in colors_and_ids(&frame).filter(|(_, id)| *id != Frame::BACKGROUND) {
            of_face.entry(id).or_default().insert(color);
        }
        assert!(of_face.len() >= 15, "{name}: {} faces are seen", of_face.len());
        assert!(of_face.values().all(|colors| colors.len() == 1), "{name}");
    }
}

/// A glossy square that faces the viewer, with a light that is mirrored in its middle.
fn square_with_highlight(shading: Shading) -> Vec<[u8; 4]> {
    let reflectance =
        Reflectance::Phong { ka: [0.0; 3], kd: [0.1; 3], ks: [0.9; 3], shininess: 100.0 };
    let square = solids::plane(2.0, 2.0, 1, 1);
    let mut scene = one(square, Material { reflectance, ..Material::default() });
    scene.nodes[0].transform =
        NodeTransform::Matrix(DMat4::from_rotation_x(std::f64::consts::FRAC_PI_2));
    scene.lights = vec![Light {
        kind: LightKind::Point { position: DVec3::new(0.0, 0.0, 3.0) },
        ..sun(DVec3::Z, 1.0)
    }];
    let mut renderer = exact(scene, 101, 101);
    renderer.camera = Some(on_z(4.0, 0.6));
    renderer.settings.shading.model = shading;
    colors(&mut renderer)
}

#[test]
fn l10_a_highlight_in_the_middle_of_a_face_is_lost_by_gouraud() {
    let middle = 50 * 101 + 50;
    let (phong, gouraud) =
        (square_with_highlight(Shading::Phong), square_with_highlight(Shading::Gouraud));
    assert!(phong[middle][0] > 240, "the highlight: {:?}", phong[middle]);
    assert!(gouraud[middle][0] < 40, "between dull corners: {:?}", gouraud[middle]);
}

#[test]
fn l13_light_contributions_add_up() {
    let mut renderer = exact_builtin("scene0", 120, 90);
    let mut lights = lab::lights();
    lights.push(Light { name: "LIGHT2".to_owned(), ..sun(DVec3::new(0.3, 1.0, -0.2), 0.6) });
    renderer.light_intensity = Some(0.45);
    let mut with = |enabled: &dyn Fn(usize) -> bool| {
        let mut some = lights.clone();
        some.iter_mut().enumerate().for_each(|(i, l)| l.enabled = enabled(i));
        renderer.lights = Some(some);
        colors(&mut renderer)
    };
    let all = with(&|_| true);
    assert!(all.iter().all(|c| c[..3].iter().all(|&v| v < 255)), "nothing is clamped");
    for i in 0..3 {
        let (without, alone) = (with(&|j| j != i), with(&|j| j == i));
        assert_ne!(alone, with(&|_| false), "LIGHT{i} shines");
        for pixel in 0..all.len() {
            for k in 0..3 {
                let sum = i32::from(without[pixel][k]) + i32::from(alone[pixel][k]);
                // Three values are rounded to bytes.
                assert!((sum - i32::from(all[pixel][k])).abs() <= 1, "LIGHT{i}, pixel {pixel}");
            }
        }
    }
}

/// The sphere under LIGHT0 with some fields changed, by one model.
fn sphere_with(model: Illumination, change: impl Fn(&mut Light)) -> Vec<[u8; 4]> {
    let mut renderer = exact_builtin("sphere", 100, 75);
    renderer.settings.shading.illumination = model;
    renderer.light_intensity = Some(0.5);
    let mut lights = lab::lights();
    change(&mut lights[0]);
    renderer.lights = Some(lights);
    colors(&mut renderer)
}

#[test]
fn l19_one_field_changes_one_term_and_linearly() {
    use Illumination::{Ambient, Lambert, Phong};
    type Field = fn(&mut Light) -> &mut [f32; 3];
    let fields: [(Field, [bool; 3]); 3] = [
        (|l| &mut l.ambient, [true, true, true]),
        (|l| &mut l.diffuse, [false, true, true]),
        (|l| &mut l.specular, [false, false, true]),
    ];
    for (field, touches) in fields {
        let at = |model, t: f32| sphere_with(model, |l| *field(l) = [0.6 * t; 3]);
        for (model, touched) in [Ambient, Lambert, Phong].into_iter().zip(touches) {
            let [none, half, full] = [0.0, 0.5, 1.0].map(|t| at(model, t));
            assert_eq!(none != full, touched, "{model}");
            for (pixel, (n, f)) in none.iter().zip(&full).enumerate() {
                let middle = i32::from(n[0]) + i32::from(f[0]) - 2 * i32::from(half[pixel][0]);
                assert!(middle.abs() <= 2, "{model}: the picture is linear in the field");
            }
        }
    }
}

/// Where light from `light` is mirrored by the unit sphere towards `eye`: by bisection on the arc
/// between the two.
fn mirror_point(light: DVec3, eye: DVec3) -> DVec3 {
    let (a, b) = (light.normalize(), eye.normalize());
    let (mut low, mut high) = (0.0, 1.0);
    let at = |t: f64| (a * (1.0 - t) + b * t).normalize();
    for _ in 0..60 {
        let middle = (low + high) * 0.5;
        let p = at(middle);
        let (to_light, to_eye) = ((light - p).normalize(), (eye - p).normalize());
        // Closer to the light's direction than to the eye's: go on towards the eye.
        if p.dot(to_light) > p.dot(to_eye) { low = middle } else { high = middle }
    }
    at(low)
}

#[test]
fn l20_highlight_lies_where_a_mirror_would_show_the_light() {
    let reflectance =
        Reflectance::Phong { ka: [0.0; 3], kd: [0.0; 3], ks: [1.0; 3], shininess: 200.0 };
    let mut renderer = exact(
        one(solids::sphere(1.0, 128, 64), Material { reflectance, ..Material::default() }),
        320,
        240,
    );
    let eye = DVec3::new(0.5, 0.8, 5.0);
    renderer.camera = Some(Camera { position: eye, ..on_z(1.0, 0.5) });
    let mut last: Option<(DVec2, DVec2)> = None;
    for light in [DVec3::new(-3.0, 3.0, 6.0), DVec3::new(0.0, 4.0, 6.0), DVec3::new(4.0, 1.0, 5.0)]
    {
        renderer.lights =
            Some(vec![Light { kind: LightKind::Point { position: light }, ..sun(DVec3::Z, 1.0) }]);
        let (mut sum, mut weight) = (DVec2::ZERO, 0.0);
        for (i, color) in colors(&mut renderer).iter().enumerate() {
            let place = DVec2::new((i % 320) as f64 + 0.5, (i / 320) as f64 + 0.5);
            sum += place * f64::from(color[0]);
            weight += f64::from(color[0]);
        }
        let (seen, expected) = (sum / weight, project(&renderer, mirror_point(light, eye)));
        assert!(seen.distance(expected) < 2.0, "{seen} instead of {expected}");
        // The lamp is behind the viewer: what counts is how it moves across the view.
        let lamp = DVec2::new(light.x, -light.y);
        if let Some((seen_before, lamp_before)) = last {
            assert!(
                (seen - seen_before).dot(lamp - lamp_before) > 0.0,
                "it moves the way the light does"
            );
        }
        last = Some((seen, lamp));
    }
}

/// The sphere in white, moved as a whole (with the camera) by `offset`, with or without exercise
/// 5.1.
fn white_sphere(offset: DVec3, exercise: bool) -> Vec<[u8; 4]> {
    let white = Reflectance::Phong { ka: [0.4; 3], kd: [0.5; 3], ks: [0.3; 3], shininess: 20.0 };
    let mut scene =
        one(solids::sphere(1.0, 48, 24), Material { reflectance: white, ..Material::default() });
    scene.nodes[0].transform = NodeTransform::Matrix(DMat4::from_translation(offset));
    scene.lights = vec![sun(DVec3::new(-0.5, 1.0, 1.0), 0.3)];
    if exercise {
        lab::exercise_5_1(&mut scene);
    }
    let mut renderer = exact(scene, 90, 90);
    let camera = on_z(5.0, 0.5);
    let (position, focal_point) = (camera.position + offset, camera.focal_point + offset);
    renderer.camera = Some(Camera { position, focal_point, ..camera });
    colors(&mut renderer)
}

#[test]
fn l21_exercise_5_1_a_green_light_at_infinity() {
    let (before, after) = (white_sphere(DVec3::ZERO, false), white_sphere(DVec3::ZERO, true));
    let mut brighter = [0, 0];
    for (i, (b, a)) in before.iter().zip(&after).enumerate() {
        assert_eq!((b[0], b[2], b[3]), (a[0], a[2], a[3]), "red and blue stay");
        assert!(a[1] >= b[1]);
        // Its ambient part is everywhere on the ball; what is more than that lies on the right.
        brighter[usize::from(i % 90 >= 45)] += u32::from(a[1] - b[1] > 110);
    }
    assert!(brighter[0] == 0 && brighter[1] > 500, "the light comes from the right: {brighter:?}");
    let moved = white_sphere(DVec3::new(2.0, -1.0, 4.0), true);
    assert!(largest_difference(&after, &moved) <= 1, "a translation does not change it");
}

/// The colours of each object of scene 0 without normals, its front halves alone where it is
/// `open`, under directional lights, for a viewer at infinity.
fn without_normals(turn: f64, open: bool) -> BTreeMap<u32, HashSet<[u8; 4]>> {
    let mut scene = load_builtin("scene0").unwrap();
    if open {
        // Every other triangle is gone: backs are seen through the gaps.
        for mesh in &mut scene.meshes {
            let mesh = std::sync::Arc::make_mut(mesh);
            let triangles: Vec<_> = mesh.triangles.iter().copied().step_by(2).collect();
            let material = mesh.parts[0].material;
            *mesh = Mesh { triangles, positions: mesh.positions.clone(), ..Mesh::default() };
            mesh.parts = vec![Part {
                name: String::new(),
                triangles: 0..mesh.triangles.len() as u32,
                material,
            }];
        }
    }
    lab::exercise_5_2(&mut scene);
    let turned = DMat4::from_rotation_y(turn);
    for node in scene.nodes.iter_mut().filter(|n| n.mesh.is_some()) {
        node.transform = NodeTransform::Matrix(node.transform.matrix() * turned);
    }
    scene.lights = vec![sun(DVec3::new(0.4, 0.5, 1.0), 0.8), sun(DVec3::new(-1.0, 0.3, 0.5), 0.2)];
    let mut renderer = exact(scene, 120, 90);
    let camera = renderer.world().cameras[0];
    renderer.camera = Some(Camera { projection: Projection::Parallel { height: 6.0 }, ..camera });
    renderer.settings.picture.channels = all_channels();
    let frame = renderer.render().unwrap().frame;
    // The floor has two materials: tell objects apart by object and material.
    let ids =
        frame.object.unwrap().into_data().into_iter().zip(frame.material.unwrap().into_data());
    let mut of_object: BTreeMap<u32, HashSet<[u8; 4]>> = BTreeMap::new();
    for ((object, material), color) in
        ids.zip(frame.color.unwrap().into_data()).filter(|((o, _), _)| *o != Frame::BACKGROUND)
    {
        of_object.entry(object * 100 + material).or_default().insert(color);
    }
    of_object
}

#[test]
fn l22_exercise_5_2_without_normals_one_colour_per_object() {
    for (open, objects) in [(false, 6), (true, 5)] {
        let (still, turned) = (without_normals(0.0, open), without_normals(0.9, open));
        assert!(still.len() >= objects, "{}", still.len());
        for (object, colors) in &still {
            assert_eq!(colors.len(), 1, "object {object}, open: {open}");
            assert_ne!(
                turned.get(object),
                Some(colors),
                "object {object} changes its colour as it turns"
            );
        }
    }
}

#[test]
fn p30_self_luminous_objects_have_one_value_each() {
    let mut renderer = exact_builtin("scene1", 120, 90);
    renderer.settings.shading.illumination = Illumination::Constant;
    renderer.settings.picture.channels = all_channels();
    let frame = renderer.render().unwrap().frame;
    let mut of_material: BTreeMap<u32, HashSet<[u8; 4]>> = BTreeMap::new();
    for (material, color) in frame.material.unwrap().data().iter().zip(frame.color.unwrap().data())
    {
        of_material.entry(*material).or_default().insert(*color);
    }
    assert!(
        of_material.len() > 8 && of_material.values().all(|colors| colors.len() == 1),
        "{of_material:?}"
    );
}

#[test]
fn p33_lambert_looks_the_same_from_everywhere() {
    // Flat shading illuminates each face at its centre, so that both cameras see the very same
    // points.
    let mut renderer = exact_builtin("sphere", 200, 200);
    renderer.settings.shading.model = Shading::Flat;
    renderer.settings.shading.illumination = Illumination::Lambert;
    renderer.settings.picture.channels = all_channels();
    let mut faces = |position: DVec3, projection| -> BTreeMap<u32, [u8; 4]> {
        renderer.camera = Some(Camera { position, projection, ..on_z(1.0, 0.6) });
        let frame = renderer.render().unwrap().frame;
        colors_and_ids(&frame)
            .map(|(color, id)| (id, color))
            .filter(|(id, _)| *id != Frame::BACKGROUND)
            .collect()
    };
    let one = faces(DVec3::new(1.0, 1.0, 4.0), Projection::Perspective { view_angle: 0.6 });
    let other = faces(DVec3::new(3.0, -0.5, 2.0), Projection::Parallel { height: 2.5 });
    let both: Vec<_> = one.iter().filter_map(|(id, color)| Some((color, other.get(id)?))).collect();
    assert!(both.len() > 300);
    for (a, b) in both {
        // The last bit may turn: positions and normals are in another view space.
        assert!(largest_difference(&[*a], &[*b]) <= 1, "{a:?} and {b:?}");
    }
}

/// The brightest pixel of a sphere under a light of this specular colour.
fn highlight(reflectance: Reflectance, model: Illumination, light: [f32; 3]) -> [f32; 3] {
    let mut renderer: Renderer = exact(
        one(solids::sphere(1.0, 96, 48), Material { reflectance, ..Material::default() }),
        200,
        200,
    );
    renderer.settings.shading.illumination = model;
    renderer.camera = Some(on_z(5.0, 0.5));
    let sun = sun(DVec3::new(0.3, 0.4, 1.0), 1.0);
    renderer.lights = Some(vec![Light { diffuse: light, specular: light, ..sun }]);
    let brightest = colors(&mut renderer)
        .into_iter()
        .max_by_key(|c| c[..3].iter().map(|&v| u32::from(v)).sum::<u32>());
    brightest.unwrap()[..3]
        .iter()
        .map(|&v| f32::from(v) / 255.0)
        .collect::<Vec<_>>()
        .try_into()
        .unwrap()
}

#[test]
fn p35_the_highlight_on_an_apple_has_the_colour_of_the_light() {
    let apple = Reflectance::Phong {
        ka: [0.3, 0.0, 0.0],
        kd: [0.1, 0.0, 0.0],
        ks: [0.9; 3],
        shininess: 60.0,
    };
    for light in [[1.0, 1.0, 1.0], [0.4, 0.7, 1.0]] {
        let seen = highlight(apple, Illumination::Phong, light);
        for k in 0..3 {
            assert!((seen[k] / 0.9 - light[k]).abs() < 0.12, "{seen:?} under {light:?}");
        }
    }
    // A metal tints it.
    let gold = Reflectance::MetallicRoughness {
        base_color: [1.0, 0.75, 0.3],
        metallic: 1.0,
        roughness: 0.7,
    };
    let seen = highlight(gold, Illumination::CookTorrance, [0.6; 3]);
    assert!(
        (seen[1] / seen[0] - 0.75).abs() < 0.05 && (seen[2] / seen[0] - 0.3).abs() < 0.05,
        "{seen:?}"
    );
}

#[test]
fn walkthroughs_can_be_rendered_and_their_steps_differ() {
    for number in ["4.1", "4.2", "4.3"] {
        let mut pictures = HashSet::new();
        let steps = vitral_scene::walkthrough::walkthrough(number).unwrap();
        for step in &steps {
            let mut renderer = exact(step.scene.clone(), 60, 45);
            renderer.camera = renderer.world().cameras.first().copied();
            renderer.settings.shading.lighting = step.lighting;
            pictures.insert(colors(&mut renderer));
        }
        assert_eq!(pictures.len(), steps.len(), "L20: every step of {number} shows something else");
    }
}

#[test]
fn l16_lights_stay_in_the_world_while_the_objects_move() {
    let lit = |all_t: DVec3| {
        let mut scene: Scene = load_builtin("sphere").unwrap();
        lab::LabView { all_t, ..lab::LabView::default() }.move_objects(&mut scene);
        let mut renderer = exact(scene, 80, 60);
        let camera = renderer.world().cameras[0];
        let (position, focal_point) = (camera.position + all_t, camera.focal_point + all_t);
        renderer.camera = Some(Camera { position, focal_point, ..camera });
        colors(&mut renderer)
    };
    assert_ne!(lit(DVec3::ZERO), lit(DVec3::new(6.0, 0.0, 0.0)), "LIGHT0 is now on the other side");
}

#[test]
fn an_occlusion_texture_takes_ambient_light_only() {
    let dark =
        Texture::new("dark".into(), Plane::filled(1, 1, [0, 255, 255, 255]), Encoding::Linear);
    let middle = |illumination, ambient: f32, suns: &[Light], strength| {
        let material = Material {
            reflectance: Reflectance::MetallicRoughness {
                base_color: [1.0; 3],
                metallic: 0.0,
                roughness: 1.0,
            },
            occlusion_texture: Some(TextureRef::new(0)),
            occlusion_strength: strength,
            ..Material::default()
        };
        let mut scene = one(solids::plane(2.0, 2.0, 1, 1), material);
        scene.nodes[0].transform =
            NodeTransform::Matrix(DMat4::from_rotation_x(std::f64::consts::FRAC_PI_2));
        scene.textures.push(std::sync::Arc::new(dark.clone()));
        (scene.ambient, scene.lights) = ([ambient; 3], suns.to_vec());
        let mut renderer = exact(scene, 33, 33);
        renderer.camera = Some(on_z(4.0, 0.4));
        renderer.settings.shading.illumination = illumination;
        colors(&mut renderer)[16 * 33 + 16][0]
    };
    // A light that is out keeps the lights of a scene without any away.
    let out = [sun(DVec3::Z, 0.0)];
    for illumination in [Illumination::Ambient, Illumination::Phong, Illumination::CookTorrance] {
        assert_eq!(
            [0.0, 0.5, 1.0].map(|strength| middle(illumination, 0.8, &out, strength)),
            [204, 102, 0]
        );
    }
    for illumination in [Illumination::Lambert, Illumination::CookTorrance] {
        let lit = |strength| middle(illumination, 0.0, &[sun(DVec3::Z, 0.5)], strength);
        assert!(lit(1.0) > 50 && lit(1.0) == lit(0.0), "{illumination}");
    }
}

#[test]
fn a_light_in_the_plane_of_a_wall_leaves_no_specks() {
    // A turned box under a light straight above: N·L of its walls is rounding, here above zero and
    // there below.
    let reflectance =
        Reflectance::Phong { ka: [0.1; 3], kd: [0.7; 3], ks: [0.9; 3], shininess: 5.0 };
    let mut scene = Scene::default();
    let material = Some(scene.add_material(Material { reflectance, ..Material::default() }));
    let mut cube = solids::cuboid(DVec3::splat(2.0));
    cube.parts.iter_mut().for_each(|part| part.material = material);
    scene.add_mesh(cube, DMat4::from_quat(DQuat::from_xyzw(0.0, 0.2, 0.0, 0.98).normalize()));
    scene.ambient = [1.0; 3];
    let lamp = LightKind::Point { position: DVec3::new(1.2, 9.0, 0.7) };
    for light in [sun(DVec3::Y, 1.0), Light { kind: lamp, ..Light::default() }] {
        for (illumination, shadows) in [
            (Illumination::Phong, "none"),
            (Illumination::BlinnPhong, "none"),
            (Illumination::BlinnPhong, "ray"),
        ] {
            // The lamp is in the plane of no wall: it only must not be forgotten.
            let in_plane = matches!(light.kind, LightKind::Directional { .. });
            let mut renderer = exact(scene.clone(), 400, 300);
            renderer.settings.shading.illumination = illumination;
            renderer.settings.shadows.algorithm = shadows.parse().unwrap();
            renderer.lights = Some(vec![light.clone()]);
            let camera = on_z(1.0, 0.7);
            let (position, view_up) = (DVec3::new(2.9, -2.9, 3.3), DVec3::new(0.3, 1.0, 0.0));
            renderer.camera = Some(Camera { position, view_up, ..camera });
            let shades: HashSet<_> =
                colors(&mut renderer).into_iter().filter(|c| *c != BLACK).collect();
            assert_eq!(
                shades.len() == 1,
                in_plane,
                "{illumination}, shadows {shadows}: {}",
                shades.len()
            );
        }
    }
}

/// glTF files have lights in candela and lux.
#[test]
fn photometric_lights_are_exposed_unless_an_intensity_is_asked_for_and_the_picture_says_so() {
    let picture = |strength: f32, photometric: bool, intensity: Option<f32>| {
        let mut scene = load_builtin("sphere").unwrap();
        for light in &mut scene.lights {
            light.photometric = photometric;
            let colors = [&mut light.ambient, &mut light.diffuse, &mut light.specular];
            colors.into_iter().flatten().for_each(|c| *c *= strength);
        }
        let mut renderer = exact(scene, 60, 45);
        renderer.settings.picture.color_space = ColorSpace::Srgb;
        renderer.light_intensity = intensity;
        renderer.render().unwrap()
    };
    let named = |file: &[u8]| file.windows(13).any(|w| w == b"tEXtExposure\0");
    for (strength, photometric, intensity) in
        [(4096.0, true, Some(1.0)), (4096.0, false, None), (1.0, false, None)]
    {
        let shown = picture(strength, photometric, intensity);
        assert!(shown.warnings.is_empty() && shown.exposure == 1.0, "{:?}", shown.warnings);
        assert!(!named(&shown.encode(vitral::PictureFormat::Png).unwrap()));
        let same = picture(strength, false, Some(1.0));
        assert_eq!(shown.frame.color, same.frame.color, "shown as written");
    }
    for strength in [4096.0, 1.0 / 4096.0] {
        let shown = picture(strength, true, None);
        let factor = shown.exposure;
        assert!(factor * strength > 0.1 && factor * strength < 10.0, "{factor}");
        assert!(
            shown.warnings.len() == 1 && shown.warnings[0].contains("photometric"),
            "{:?}",
            shown.warnings
        );
        assert!(named(&shown.encode(vitral::PictureFormat::Png).unwrap()));
        let pixels = shown.frame.color.unwrap().into_data();
        let most = pixels
            .iter()
            .flat_map(|c| c[..3].iter().copied())
            .filter(|&c| c > 60 && c < 250)
            .count();
        assert!(most > 500, "{strength}: {most}");
    }
}

/// A lamp that moves by a step changes the picture by a step: a white plane under a lamp of the
/// `1 / d²` law.
#[test]
fn a_lamp_of_a_scene_file_that_moves_away_gets_darker_by_the_law() {
    let shade = |d: f64| {
        let reflectance =
            Reflectance::Phong { ka: [0.0; 3], kd: [1.0; 3], ks: [0.0; 3], shininess: 1.0 };
        let mut scene =
            one(solids::plane(0.4, 0.4, 1, 1), Material { reflectance, ..Material::default() });
        let kind = LightKind::Point { position: DVec3::Y * d };
        scene.lights =
            vec![Light { kind, attenuation: Attenuation::InverseSquare, ..Light::default() }];
        let mut renderer = exact(scene, 20, 20);
        renderer.settings.picture.color_space = ColorSpace::Srgb;
        renderer.view = View::Top;
        renderer.render().unwrap().frame.color.unwrap().at(10, 10)[0]
    };
    // sRGB of 1/3.9² = 0.0657 and 1/4.1² = 0.0595.
    assert_eq!([3.9, 4.1].map(shade), [73, 69]);
}

/// Raw colours are made of the numbers of the file, however dark or bright its lights are.
#[test]
fn raw_colours_are_those_of_the_lights_added_up() {
    let shade = |strengths: &[f32]| {
        let reflectance =
            Reflectance::Phong { ka: [0.0; 3], kd: [0.5; 3], ks: [0.0; 3], shininess: 1.0 };
        let mut scene =
            one(solids::plane(4.0, 4.0, 1, 1), Material { reflectance, ..Material::default() });
        scene.lights = strengths.iter().map(|&strength| sun(DVec3::Y, strength)).collect();
        let mut renderer = exact(scene, 20, 20);
        renderer.view = View::Top;
        let rendered = renderer.render().unwrap();
        assert!(rendered.warnings.is_empty(), "{:?}", rendered.warnings);
        rendered.frame.color.unwrap().at(10, 10)[0]
    };
    assert_eq!(
        [shade(&[0.02]), shade(&[0.2]), shade(&[0.02, 0.2]), shade(&[30.0])],
        [3, 26, 28, 255]
    );
}

/// Ambient light alone: the formula's first term, and no light that nobody asked for.
#[test]
fn p31_a_scene_with_ambient_light_alone_has_no_other() {
    let reflectance =
        Reflectance::Phong { ka: [0.5; 3], kd: [0.5; 3], ks: [0.5; 3], shininess: 1.0 };
    let mut scene =
        one(solids::plane(4.0, 4.0, 1, 1), Material { reflectance, ..Material::default() });
    scene.ambient = [0.5, 0.25, 0.0];
    let mut renderer = exact(scene, 20, 20);
    renderer.view = View::Top;
    assert_eq!(colors(&mut renderer)[210], [64, 32, 0, 255]);
}

/// A facet that has the light in its plane gets nothing of it, wherever rounding puts the light:
/// the picture shows what the channel says.
#[test]
fn a_light_in_the_plane_of_a_facet_leaves_no_specks() {
    for shadows in ["ray", "map", "volume", "scan-line", "object-precision"] {
        let reflectance =
            Reflectance::Phong { ka: [0.0; 3], kd: [0.8; 3], ks: [0.0; 3], shininess: 1.0 };
        let mesh = Mesh {
            positions: vec![
                [0.0, 0.0, -2.0],
                [0.0, 0.5, -1.0],
                [1.0, 0.5, -1.0],
                [1.0, -0.5, -2.0],
            ],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            parts: vec![Part { name: String::new(), triangles: 0..2, material: None }],
            // As of the polygon: both facets' alike.
            normals: Some(Attribute { values: vec![[0.5, 2.0, -1.5]; 4], corners: None }),
            ..Mesh::default()
        };
        let mut scene = one(mesh, Material { reflectance, ..Material::default() });
        let kind = LightKind::Point { position: DVec3::new(0.0, 3.0, 1.0) };
        scene.lights.push(Light { kind, ..Light::default() });
        let mut renderer = exact(scene, 198, 270);
        renderer.camera = Some(Camera {
            position: DVec3::new(3.410_679_92, -0.565_680_80, -2.069_570_58),
            focal_point: DVec3::new(0.361_712_19, 0.435_892_14, -0.158_553_88),
            view_up: DVec3::new(0.1, 1.0, 0.05),
            projection: Projection::Parallel { height: 3.0 },
            clip: Some((0.01, 20.0)),
        });
        renderer.settings.shadows.algorithm = shadows.parse().unwrap();
        renderer.settings.picture.channels = all_channels();
        let frame = renderer.render().unwrap().frame;
        let attached = frame.attached_shadow.as_ref().unwrap().data().to_vec();
        let in_plane: Vec<_> =
            colors_and_ids(&frame).zip(attached).filter(|((_, id), _)| *id == 1).collect();
        assert!(in_plane.len() > 100, "{} pixels", in_plane.len());
        let lit = in_plane
            .iter()
            .filter(|((color, _), attached)| *color != BLACK || *attached != 1.0)
            .count();
        assert_eq!(lit, 0, "{shadows}: of {}", in_plane.len());
    }
}

/// What nothing varies takes a shorter way than what a texture of ones varies.
#[test]
fn a_white_texture_changes_not_a_bit() {
    let white = Texture::new("white".into(), Plane::filled(1, 1, [255; 4]), Encoding::Linear);
    let picture = |reflectance, illumination, opacity, textured: bool| {
        let material = Material {
            reflectance,
            opacity,
            base_texture: textured.then(|| TextureRef::new(0)),
            ..Material::default()
        };
        let mut scene = one(solids::torus(2.0, 0.7, 40, 20), material);
        scene.textures.push(std::sync::Arc::new(white.clone()));
        scene.lights = lab::lights();
        let lamp = LightKind::Point { position: DVec3::new(0.0, 2.0, 3.0) };
        scene.lights.push(Light { kind: lamp, ..Light::default() });
        let mut renderer = exact(scene, 90, 70);
        (renderer.settings.shading.illumination, renderer.settings.picture.samples) =
            (illumination, 4);
        colors(&mut renderer)
    };
    let phong = Reflectance::Phong {
        ka: [0.1, 0.2, 0.3],
        kd: [0.7, 0.3, 0.5],
        ks: [0.9; 3],
        shininess: 17.0,
    };
    let rough = Reflectance::MetallicRoughness {
        base_color: [0.9, 0.4, 0.2],
        metallic: 0.6,
        roughness: 0.4,
    };
    let models = [
        Illumination::Lambert,
        Illumination::Phong,
        Illumination::BlinnPhong,
        Illumination::CookTorrance,
    ];
    for (reflectance, illumination, opacity) in [phong, rough]
        .iter()
        .flat_map(|r| models.iter().flat_map(move |m| [1.0, 0.5].map(|o| (*r, *m, o))))
    {
        let plain = picture(reflectance, illumination, opacity, false);
        assert!(plain.iter().collect::<HashSet<_>>().len() > 200, "{illumination}");
        assert!(
            plain == picture(reflectance, illumination, opacity, true),
            "{reflectance:?} {illumination} {opacity}"
        );
    }
}
