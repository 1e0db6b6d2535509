//! Cameras whose middle is not the picture's: a part of a larger picture.

use vitral::{Camera, Global, Renderer, Shadows, Visibility};

/// A renderer for `width` x 48 pixels of one sample.
fn renderer(name: &str, width: u32) -> Renderer {
    let mut renderer = vitral::open(format!("builtin:{name}")).unwrap();
    renderer.settings = renderer.settings.with_size(width, 48).with_samples(1);
    renderer
}

/// The right two thirds of a picture of 96 x 48 pixels, by a camera of its own.
fn part(whole: &Renderer) -> Camera {
    let camera = whole.frame_camera().with_view_angle(0.6);
    let focal = 24.0 / vitral::internals::math::func::tan(0.3);
    camera.with_intrinsics([focal, focal], [48.0 - 32.0, 24.0], [64, 48])
}

#[test]
fn a_window_shows_its_part_of_the_whole_picture() {
    for (name, global, shadows) in [
        ("teapot", Global::None, Shadows::NONE),
        ("cubs", Global::None, Shadows::MAP),
        ("mirrors", Global::RayTrace, Shadows::RAY),
        ("refraction", Global::None, Shadows::NONE),
    ] {
        let mut whole = renderer(name, 96);
        whole.settings.global.model = global;
        whole.settings.shadows.algorithm = shadows;
        let camera = part(&whole);
        let expected = whole.render_from(&whole.frame_camera().with_view_angle(0.6)).unwrap();
        let mut window = renderer(name, 64);
        window.settings.global.model = global;
        window.settings.shadows.algorithm = shadows;
        // Lights that follow the camera would follow its middle.
        window.lights = Some(whole.frame_lights(&whole.frame_camera()));
        whole.lights.clone_from(&window.lights);
        let expected = match window.lights {
            Some(_) => whole.render_from(&whole.frame_camera().with_view_angle(0.6)).unwrap(),
            None => expected,
        };
        let picture = window.render_from(&camera).unwrap();
        let cut: Vec<[u8; 4]> = expected
            .rgba8()
            .as_chunks::<4>()
            .0
            .chunks(96)
            .flat_map(|row| &row[32..])
            .copied()
            .collect();
        let apart = |a: &[u8; 4], b: &[u8; 4]| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 3);
        let seen = picture.rgba8().as_chunks::<4>().0;
        let different = cut.iter().zip(seen).filter(|(a, b)| apart(a, b)).count();
        // Corners are snapped to 1/256 of a pixel, from other numbers.
        assert!(different * 200 < cut.len(), "{name}: {different} of {} pixels", cut.len());
    }
}

#[test]
fn every_algorithm_sees_the_same_through_a_window() {
    let mut renderer = renderer("teapot", 64);
    let camera = part(&renderer);
    let expected = renderer.render_from(&camera).unwrap();
    for visibility in Visibility::all() {
        renderer.settings.visibility = visibility;
        let picture = renderer.render_from(&camera).unwrap();
        assert_eq!(picture.rgba8(), expected.rgba8(), "{visibility}");
    }
}
