//! Materials that show their front alone, as glTF's `doubleSided: false` has it.

use super::common::{colors, exact, on_z, one, poster, sun};
use vitral::internals::render::registry::{SHADOWS, VISIBILITY};
use vitral::{
    AlphaMode, Camera, DMat4, DVec3, Light, Material, MaterialOverride, Mesh, NodeTransform,
    Projection, Renderer, Scene, override_material, solids,
};

const RED: [f32; 3] = [1.0, 0.0, 0.0];
const BLUE: [f32; 3] = [0.0, 0.0, 1.0];

/// A rectangle that faces the viewer on the z axis, or turns its back on him.
fn sheet(faces_viewer: bool) -> Mesh {
    let quarter = if faces_viewer { 0.5 } else { -0.5 } * std::f64::consts::PI;
    let mut mesh = solids::plane(1.0, 1.0, 2, 2);
    let turn = DMat4::from_rotation_x(quarter);
    mesh.normals = None;
    for p in &mut mesh.positions {
        let [x, y, z] = p.map(f64::from);
        *p = turn.transform_point3(DVec3::new(x, y, z)).as_vec3().to_array();
    }
    mesh
}

/// Pixels of the sheet, by an algorithm.
fn seen(scene: Scene, algorithm: &str) -> usize {
    let mut r = exact(scene, 40, 40);
    r.camera = Some(on_z(4.0, 0.4));
    r.settings.visibility = algorithm.parse().unwrap();
    colors(&mut r).iter().filter(|p| **p != [0, 0, 0, 255]).count()
}

#[test]
fn backs_are_not_seen_by_any_algorithm() {
    let front_only = || Material { front_only: true, ..poster(RED) };
    let layered = |alpha_mode| Material { alpha_mode, opacity: 0.75, ..front_only() };
    for row in VISIBILITY {
        let count = |faces_viewer, material| seen(one(sheet(faces_viewer), material), row.name);
        let all = count(true, front_only());
        assert!(all > 300, "{}", row.name);
        assert_eq!(count(false, front_only()), 0, "{}", row.name);
        assert_eq!(count(false, poster(RED)), all, "{}: others show both sides", row.name);
        assert_eq!(
            count(false, Material { double_sided: true, ..front_only() }),
            all,
            "{}",
            row.name
        );
        for mode in [AlphaMode::Blend, AlphaMode::Mask { cutoff: 0.5 }] {
            assert_eq!(
                [count(true, layered(mode)), count(false, layered(mode))],
                [all, 0],
                "{}, {mode:?}",
                row.name
            );
        }
    }
}

#[test]
fn culling_that_is_switched_off_shows_no_backs_either() {
    let mut r = exact(one(sheet(false), Material { front_only: true, ..poster(RED) }), 20, 20);
    r.camera = Some(on_z(4.0, 0.4));
    (r.settings.cull.frustum, r.settings.cull.back_face) = (false, false);
    assert!(colors(&mut r).iter().all(|p| *p == [0, 0, 0, 255]));
}

#[test]
fn a_mirrored_node_shows_what_its_front_became() {
    let mut scene = one(sheet(true), Material { front_only: true, ..poster(RED) });
    scene.nodes[0].transform = NodeTransform::Matrix(DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0)));
    assert!(seen(scene, "z-buffer") > 300);
}

#[test]
fn a_sheet_with_a_copy_for_its_back_shows_the_front_alone() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../io/tests/fixtures/sheet_back.gltf");
    let scene = vitral::load(path).unwrap();
    for row in VISIBILITY {
        let mut r = Renderer::new(scene.clone()).unwrap();
        (r.settings.picture.width, r.settings.picture.height, r.settings.picture.samples) =
            (80, 60, 1);
        r.settings.visibility = row.name.parse().unwrap();
        r.settings.picture.channels.material = true;
        let frame = r.render().unwrap().frame;
        let of = |number| {
            frame.material.as_ref().unwrap().data().iter().filter(|m| **m == number).count()
        };
        assert!(of(0) > 500 && of(1) == 0, "{}: {} and {}", row.name, of(0), of(1));
    }
}

#[test]
fn the_property_double_sided_decides() {
    let with = |value: &str| {
        let mut scene =
            one(sheet(false), Material { name: "m".to_owned(), front_only: true, ..poster(RED) });
        override_material(&mut scene, "m", "double-sided", value).unwrap();
        seen(scene, "z-buffer")
    };
    assert!(with("true") > 300);
    assert_eq!(with("false"), 0);
    let mut plain = one(sheet(false), Material { name: "m".to_owned(), ..poster(RED) });
    MaterialOverride::parse("m.double-sided=false").unwrap().apply(&mut plain).unwrap();
    assert_eq!(seen(plain, "z-buffer"), 0, "of any format");
}

/// A floor, and over it a sheet that turns its back on the light and the viewer, who look straight
/// down.
fn floor_below_a_back() -> (Scene, Camera, Vec<Light>) {
    let mut scene = one(solids::plane(4.0, 4.0, 1, 1), Material::matte([1.0; 3]));
    let material = Some(scene.add_material(Material { front_only: true, ..Material::matte(BLUE) }));
    let mut sheet = solids::plane(1.0, 1.0, 1, 1);
    sheet.parts.iter_mut().for_each(|p| p.material = material);
    let place = DMat4::from_translation(DVec3::Y) * DMat4::from_rotation_x(std::f64::consts::PI);
    scene.add_mesh(sheet, place);
    let camera = Camera {
        view_up: DVec3::NEG_Z,
        projection: Projection::Parallel { height: 3.0 },
        ..Camera::look_at(DVec3::new(0.0, 5.0, 0.0), DVec3::ZERO)
    };
    (scene, camera, vec![sun(DVec3::Y, 1.0)])
}

#[test]
fn shadows_take_it_as_solid() {
    for row in SHADOWS.iter().filter(|row| !row.is_none) {
        let (scene, camera, lights) = floor_below_a_back();
        let mut r = exact(scene, 60, 60).with_camera(camera).with_lights(lights);
        r.settings.shadows.algorithm = row.name.parse().unwrap();
        let picture = colors(&mut r);
        let at = |x: usize, y: usize| picture[y * 60 + x];
        assert!(
            at(30, 30)[0] < 40 && at(30, 30)[2] < 40,
            "{}: the floor in the shadow: {:?}",
            row.name,
            at(30, 30)
        );
        assert!(at(5, 5)[0] > 200, "{}: the floor in the light: {:?}", row.name, at(5, 5));
    }
}
