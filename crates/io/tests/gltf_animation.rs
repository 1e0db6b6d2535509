//! glTF animations at moments whose poses are worked out by hand.

use crate::common::documents::{FLOAT, ONE_NODE, document, floats, triangle};
use vitral_exec::Workers;
use vitral_io::{Error, Moment, NoFiles, load_at};
use vitral_math::DVec3;
use vitral_scene::{Scene, World};

/// A document of a triangle whose node, number 0, is moved by one channel: path, interpolation,
/// keyframes, values.
fn moved(path: &str, interpolation: &str, keys: &[f32], width: usize, values: &[f32]) -> String {
    let shape = ["", "SCALAR", "VEC2", "VEC3", "VEC4"][width];
    let arrays = [
        triangle(),
        (floats(keys), FLOAT, "SCALAR", keys.len(), ""),
        (floats(values), FLOAT, shape, values.len() / width, ""),
    ];
    let mesh = r#""meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]"#;
    let sampler = format!(r#"{{"input":1,"output":2,"interpolation":"{interpolation}"}}"#);
    let channel = format!(r#"{{"sampler":0,"target":{{"node":0,"path":"{path}"}}}}"#);
    let animation = format!(
        r#""animations":[{{"name":"Walk","samplers":[{sampler}],"channels":[{channel}]}}]"#
    );
    document(&arrays, &format!("{ONE_NODE},{mesh},{animation}"))
}

fn at(text: &str, animation: &str, seconds: f64) -> Result<Scene, Error> {
    let moment = Moment { animation: animation.to_owned(), seconds };
    load_at(text.as_bytes(), "a.gltf", &NoFiles, &Workers::single(), Some(&moment))
}

/// Where a point of the first instance is.
fn place(scene: &Scene, point: DVec3) -> DVec3 {
    World::new(scene).unwrap().instances[0].world_from_model.transform_point3(point)
}

fn near(a: DVec3, b: DVec3) -> bool {
    (a - b).length() < 1e-6
}

#[test]
fn straight_lines_steps_and_clamped_ends() {
    let values = [0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 4.0, 2.0, 0.0];
    let origin = |interpolation: &str, seconds| {
        place(
            &at(&moved("translation", interpolation, &[1.0, 2.0, 4.0], 3, &values), "0", seconds)
                .unwrap(),
            DVec3::ZERO,
        )
    };
    for (seconds, x, y) in
        [(0.0, 0.0, 0.0), (1.25, 1.0, 0.0), (2.0, 4.0, 0.0), (3.0, 4.0, 1.0), (9.0, 4.0, 2.0)]
    {
        assert_eq!(origin("LINEAR", seconds), DVec3::new(x, y, 0.0), "{seconds} s");
    }
    for (seconds, x, y) in [(1.99, 0.0, 0.0), (2.0, 4.0, 0.0), (3.99, 4.0, 0.0), (4.0, 4.0, 2.0)] {
        assert_eq!(origin("STEP", seconds), DVec3::new(x, y, 0.0), "{seconds} s");
    }
}

#[test]
fn cubic_splines_follow_their_tangents() {
    // In-tangent, value, out-tangent of two keyframes, 2 s apart.
    let values = [
        [[9.0, 9.0, 9.0], [0.0, 0.0, 0.0], [3.0, 0.0, 0.0]],
        [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [9.0, 9.0, 9.0]],
    ];
    let text =
        moved("translation", "CUBICSPLINE", &[0.0, 2.0], 3, values.as_flattened().as_flattened());
    // Half way both values weigh 1/2, the tangents 2 s times 1/8 and -1/8: x = 0.5 + 2 * 3/8, y = 2
    // * 1/8.
    assert!(near(place(&at(&text, "0", 1.0).unwrap(), DVec3::ZERO), DVec3::new(1.25, 0.25, 0.0)));
    assert_eq!(place(&at(&text, "0", 2.0).unwrap(), DVec3::ZERO), DVec3::X);
}

#[test]
fn rotations_turn_evenly_and_scales_grow() {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let text =
        moved("rotation", "LINEAR", &[0.0, 1.0], 4, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, half, half]);
    // A third of a quarter turn about z.
    let (sin, cos) = (0.5, 0.75f64.sqrt());
    assert!(near(place(&at(&text, "0", 1.0 / 3.0).unwrap(), DVec3::X), DVec3::new(cos, sin, 0.0)));
    let text = moved("scale", "LINEAR", &[0.0, 1.0], 3, &[0.0, 0.0, 0.0, 2.0, 4.0, 6.0]);
    assert_eq!(place(&at(&text, "0", 0.5).unwrap(), DVec3::ONE), DVec3::new(1.0, 2.0, 3.0));
}

#[test]
fn morph_weights_move_vertices() {
    let arrays = [
        triangle(),
        (floats(&[0.0, 0.0, 4.0, 0.0, 0.0, 4.0, 0.0, 0.0, 4.0]), FLOAT, "VEC3", 3, ""),
        (floats(&[0.0, 1.0]), FLOAT, "SCALAR", 2, ""),
        // Two targets at each keyframe.
        (floats(&[0.0, 0.0, 1.0, 0.5]), FLOAT, "SCALAR", 4, ""),
    ];
    let mesh = r#""meshes":[{"weights":[0,0],"primitives":[{"attributes":{"POSITION":0},
        "targets":[{"POSITION":1},{"POSITION":1}]}]}]"#;
    let animation = r#""animations":[{"samplers":[{"input":2,"output":3}],
        "channels":[{"sampler":0,"target":{"node":0,"path":"weights"}}]}]"#;
    let text = document(&arrays, &format!("{ONE_NODE},{mesh},{animation}"));
    let height = |seconds| at(&text, "0", seconds).unwrap().meshes[0].positions[0][2];
    assert_eq!([height(0.0), height(0.5), height(1.0)], [0.0, 3.0, 6.0]);
}

#[test]
fn skins_follow_their_joints() {
    let zeros = vec![0u8; 12];
    let ones = floats(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
    let arrays = [
        triangle(),
        (zeros, 5121, "VEC4", 3, ""),
        (ones, FLOAT, "VEC4", 3, ""),
        (floats(&[0.0, 2.0]), FLOAT, "SCALAR", 2, ""),
        (floats(&[0.0, 0.0, 0.0, 0.0, 0.0, 8.0]), FLOAT, "VEC3", 2, ""),
    ];
    let mesh =
        r#""meshes":[{"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2}}]}]"#;
    let nodes =
        r#""scenes":[{"nodes":[0,1]}],"nodes":[{"mesh":0,"skin":0},{}],"skins":[{"joints":[1]}]"#;
    let animation = r#""animations":[{"samplers":[{"input":3,"output":4}],
        "channels":[{"sampler":0,"target":{"node":1,"path":"translation"}}]}]"#;
    let scene = at(&document(&arrays, &format!("{nodes},{mesh},{animation}")), "0", 0.5).unwrap();
    assert_eq!(scene.meshes[0].positions, [[0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [0.0, 1.0, 2.0]]);
}

#[test]
fn animations_are_named_and_listed() {
    let text = moved("translation", "LINEAR", &[0.0, 2.5], 3, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    let listed = |scene: Scene| {
        scene.animations.into_iter().map(|a| (a.name, a.seconds)).collect::<Vec<_>>()
    };
    for name in ["0", "Walk", "walk"] {
        assert_eq!(listed(at(&text, name, 0.0).unwrap()), [("Walk".to_owned(), 2.5)]);
    }
    let Err(Error::Absent { what, hint }) = at(&text, "run", 0.0) else { panic!("there is none") };
    assert_eq!([what.as_str(), &hint], ["a.gltf: no animation `run`", "0 `Walk`"]);
    let moment = Moment { animation: "0".to_owned(), seconds: 0.0 };
    let stl =
        load_at(b"solid a\nendsolid a\n", "a.stl", &NoFiles, &Workers::single(), Some(&moment));
    assert!(matches!(stl, Err(Error::Absent { .. })));
}

#[test]
fn channels_that_make_no_sense_are_told_where_the_animation_is_asked_for() {
    let text = moved("translation", "LINEAR", &[0.0, 1.0], 4, &[0.0; 8]);
    assert!(vitral_io::load(text.as_bytes(), "a.gltf", &NoFiles, &Workers::single()).is_ok());
    let told = at(&text, "0", 0.5).unwrap_err().to_string();
    assert_eq!(told, "a.gltf: animations[0].channels[0]: vectors of 3 numbers are required");
    let text = moved("scale", "CUBICSPLINE", &[0.0, 1.0], 3, &[1.0; 12]);
    let told = at(&text, "0", 0.5).unwrap_err().to_string();
    assert_eq!(told, "a.gltf: animations[0].channels[0]: keyframes without values");
}
