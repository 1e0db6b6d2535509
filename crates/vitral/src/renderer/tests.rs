//! Tests of `renderer.rs`.

use super::*;
use crate::load_builtin;

fn small(name: &str) -> Renderer {
    let mut renderer = Renderer::new(load_builtin(name).unwrap()).unwrap();
    (renderer.settings.picture.width, renderer.settings.picture.height) = (48, 36);
    renderer
}

#[test]
fn default_lights_are_for_scenes_without_lights() {
    let mut renderer = small("teapot");
    let camera = renderer.frame_camera();
    let renderer_lights = renderer.frame_lights(&camera);
    assert_eq!(renderer_lights, default_lights(&camera));
    renderer.lights = Some(Vec::new());
    assert!(renderer.frame_lights(&camera).is_empty(), "no lights were asked for");
    // Radiosity does not depend on the camera, and needs no lamps where surfaces shine.
    let mut fixed = small("teapot");
    fixed.settings.global.model = Global::Radiosity;
    let (near, far) =
        (Camera { position: DVec3::ONE, ..camera }, Camera { position: -DVec3::ONE, ..camera });
    assert!(!fixed.frame_lights(&near).is_empty());
    assert_eq!(fixed.frame_lights(&near), fixed.frame_lights(&far));
    // None of them goes through walls; the usual fill light does.
    let leak = |lights: &[Light]| lights.iter().any(|l| l.kind != LightKind::Ambient && !l.shadow);
    assert!(!leak(&fixed.frame_lights(&near)) && leak(&renderer_lights));
    let mut scene = load_builtin("teapot").unwrap();
    let lamp =
        scene.add_material(vitral_light::Material { emission: [1.0; 3], ..Default::default() });
    let with_lamp = |scene: &Scene| {
        let mut shining = Renderer::new(scene.clone()).unwrap();
        shining.settings.global.model = Global::Radiosity;
        shining.frame_lights(&near)
    };
    assert_eq!(with_lamp(&scene), fixed.frame_lights(&near), "nothing is made of the material");
    Arc::make_mut(&mut scene.meshes[0]).parts[0].material = Some(lamp);
    assert!(with_lamp(&scene).is_empty());
    let mut lab = small("sphere");
    lab.light_intensity = Some(0.5);
    let lights = lab.frame_lights(&camera);
    assert_eq!(lights.len(), 2);
    assert_eq!(lights[0].diffuse[0], lab.world().lights[0].diffuse[0] * 0.5);
}

#[test]
fn a_turntable_goes_round_once() {
    let mut renderer = small("teapot");
    renderer.view = View::Front;
    let cameras = renderer.turntable_cameras(4);
    let away = |i: usize| (cameras[i].position - cameras[i].focal_point).normalize();
    assert!(away(0).abs_diff_eq(DVec3::Z, 1e-12) && away(1).abs_diff_eq(DVec3::X, 1e-12));
    let mut seen = Vec::new();
    renderer
        .turntable(3, |i, picture| {
            seen.push((i, picture.frame.color.is_some()));
            Ok(())
        })
        .unwrap();
    assert_eq!(seen, [(0, true), (1, true), (2, true)]);
    let stop = renderer.turntable(3, |_, _| Err(Error::usage("stop", "")));
    assert_eq!(stop.unwrap_err().to_string(), "stop");
}
