//! The same picture at every instruction set, with any number of threads, in a fresh session and in
//! a used one. The same files of drawings with any number of threads.

use super::common::{all_channels, colors, exact, exact_builtin};
use vitral::internals::math::lanes::available_levels;
use vitral::{
    Budget, DrawingFormat, DrawingOptions, DrawingSettings, Execution, FillSettings, Frame,
    Illumination, Interpolation, Lines, Renderer, Seams, Shading, Workers, execution, load_builtin,
    override_material,
};

/// Scene 1 with a transparent ball, lines on top, all channels, and one model and shading after the
/// other.
fn pictures(execution: &Execution) -> Vec<Frame> {
    let mut scene = load_builtin("scene1").unwrap();
    override_material(&mut scene, "teal ball", "opacity", "0.4").unwrap();
    let mut renderer = Renderer::with_execution(scene, execution.clone()).unwrap();
    (renderer.settings.picture.width, renderer.settings.picture.height) = (150, 101);
    renderer.settings.picture.channels = all_channels();
    renderer.camera = renderer.world().cameras.first().copied();
    let mut frames = Vec::new();
    for (shading, illumination, lines, samples) in [
        (Shading::Phong, Illumination::Auto, Lines::None, 4),
        (Shading::Gouraud, Illumination::BlinnPhong, Lines::Edges, 1),
        (Shading::Flat, Illumination::CookTorrance, Lines::WireframeHiddenLine, 3),
    ] {
        let settings = &mut renderer.settings;
        (
            settings.shading.model,
            settings.shading.illumination,
            settings.picture.lines,
            settings.picture.samples,
        ) = (shading, illumination, lines, samples);
        frames.push(renderer.render().unwrap().frame);
    }
    renderer.settings.shading.interpolation = Interpolation::Linear;
    frames.push(renderer.render().unwrap().frame);
    frames
}

#[test]
fn equal_bytes_at_every_level_with_one_and_three_threads() {
    let mut reference: Option<Vec<Frame>> = None;
    for (name, level) in available_levels() {
        for threads in [1, 3] {
            let workers = Workers::new(threads);
            let frames =
                pictures(&Execution { workers, level, budget: Budget::default(), observer: None });
            let expected = reference.get_or_insert_with(|| frames.clone());
            for (i, (frame, expected)) in frames.iter().zip(expected.iter()).enumerate() {
                assert!(
                    frame == expected,
                    "{name} with {threads} threads: picture {i} differs from the scalar one"
                );
            }
        }
    }
}

#[test]
fn files_of_drawings_are_equal_with_any_number_of_threads() {
    let mut scene = load_builtin("scene1").unwrap();
    override_material(&mut scene, "teal ball", "opacity", "0.4").unwrap();
    let files = |threads| {
        let renderer = Renderer::with_execution(scene.clone(), execution(threads)).unwrap();
        let settings = DrawingSettings { hidden_layers: u32::MAX, ..DrawingSettings::default() };
        let mut files = Vec::new();
        for (seams, flatten) in [(Seams::Under, false), (Seams::None, true)] {
            let fill = FillSettings {
                transparency: true,
                shadows: true,
                seams,
                flatten,
                ..FillSettings::default()
            };
            let drawing = renderer.draw_filled(&settings, &fill).unwrap().drawing;
            for (format, _) in DrawingFormat::ALL {
                files.push(format.encode(&drawing, &DrawingOptions::default()));
            }
        }
        files
    };
    let one = files(1);
    assert!(
        one.iter().all(|file| file.len() > 10_000),
        "{:?}",
        one.iter().map(Vec::len).collect::<Vec<_>>()
    );
    for threads in [2, 3, 7] {
        assert!(files(threads) == one, "{threads} threads");
    }
}

#[test]
fn a_used_session_gives_the_pictures_of_a_fresh_one() {
    let setups: [(u32, u32, u32, bool); 4] =
        [(70, 50, 4, true), (200, 130, 1, false), (70, 50, 2, true), (70, 50, 4, true)];
    let mut used = exact_builtin("scene0", 1, 1);
    let prepare = |renderer: &mut Renderer,
                   (width, height, samples, perspective): (u32, u32, u32, bool)| {
        let settings = &mut renderer.settings;
        (settings.picture.width, settings.picture.height, settings.picture.samples) =
            (width, height, samples);
        settings.picture.channels = all_channels();
        let camera = renderer.world().cameras[0];
        renderer.camera =
            Some(if perspective { camera } else { camera.orthographic().azimuth(1.0) });
    };
    for setup in setups {
        let mut fresh = exact_builtin("scene0", 1, 1);
        prepare(&mut used, setup);
        prepare(&mut fresh, setup);
        assert!(used.render().unwrap().frame == fresh.render().unwrap().frame, "{setup:?}");
    }
}

#[test]
fn every_number_of_samples_works_and_more_samples_come_closer() {
    let mut renderer = exact_builtin("cubs", 90, 70);
    let pictures: Vec<_> = (1..=16)
        .chain([32])
        .map(|samples| {
            renderer.settings.picture.samples = samples;
            colors(&mut renderer)
        })
        .collect();
    let best = &pictures[16];
    let error = |picture: &[[u8; 4]]| {
        let sum: u64 = picture
            .as_flattened()
            .iter()
            .zip(best.as_flattened())
            .map(|(a, b)| u64::from(a.abs_diff(*b)).pow(2))
            .sum();
        sum as f64 / picture.len() as f64
    };
    let errors: Vec<f64> = pictures.iter().map(|p| error(p)).collect();
    assert!(errors[0] > 3.0 * errors[3] && errors[3] > errors[7], "{errors:?}");
    assert!(errors[15] < errors[7], "{errors:?}");
    assert!(errors[1..16].iter().all(|e| *e < errors[0]), "{errors:?}");
}

#[test]
fn several_models_and_instances_are_numbered_in_scene_order() {
    let mut scene = load_builtin("sphere").unwrap();
    scene.append(load_builtin("cubs").unwrap());
    let mut renderer = exact(scene, 60, 60);
    renderer.settings.picture.channels = all_channels();
    let frame = renderer.render().unwrap().frame;
    let objects: std::collections::BTreeSet<u32> =
        frame.object.unwrap().into_data().into_iter().collect();
    assert!(objects.range(1..9).count() >= 4 && renderer.world().instances.len() == 9);
    let first = &renderer.world().instances[1];
    assert_eq!(first.first_surface as usize, renderer.world().instances[0].mesh.face_count());
}
