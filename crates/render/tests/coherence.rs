//! Coherence (docs/course.md, the kinds that the notes name): switched off, the picture is the same
//! and nothing is saved.

use std::sync::Arc;
use vitral_math::{DMat4, DQuat, DVec3};
use vitral_render::registry::VISIBILITY;
use vitral_render::{
    Acceleration, Channels, Coherence, Execution, PictureSettings, Rendered, Session, Settings,
    Shot, Surroundings, render,
};
use vitral_scene::builtin::solids;
use vitral_scene::{Axis, Camera, Lens, Scene, View, World, framing};

/// Three rings and two boards that penetrate each other, and a ring that the camera does not see.
fn scene() -> Arc<Scene> {
    let mut scene = Scene::default();
    for i in 0..3 {
        let turn = DQuat::from_rotation_x(0.9 * f64::from(i));
        let place =
            DMat4::from_rotation_translation(turn, DVec3::new(0.3 * f64::from(i), 0.0, 0.0));
        scene.add_mesh(solids::torus(1.0, 0.4, 24, 12), place);
    }
    for turn in [DQuat::from_rotation_x(0.9), DQuat::from_rotation_z(0.7)] {
        scene.add_mesh(solids::plane(4.0, 4.0, 1, 1), DMat4::from_quat(turn));
    }
    scene.add_mesh(
        solids::torus(1.0, 0.4, 24, 12),
        DMat4::from_translation(DVec3::new(500.0, 0.0, 0.0)),
    );
    Arc::new(scene)
}

/// A camera that looks at what penetrates from an angle.
fn camera(angle: f64) -> Camera {
    let near = World::new(&{
        let mut scene = Scene::default();
        scene.add_mesh(solids::torus(1.0, 0.4, 24, 12), DMat4::IDENTITY);
        scene
    })
    .unwrap();
    let framed = framing::frame(&near.bounds, View::Iso, Axis::PlusY, Lens::default(), 4.0 / 3.0);
    let turned = DQuat::from_rotation_y(angle) * (framed.position - framed.focal_point);
    Camera { position: framed.focal_point + turned, ..framed }
}

fn shown(session: &mut Session, settings: &Settings, angle: f64) -> Rendered {
    let shot = Shot {
        camera: camera(angle),
        lights: &[],
        ambient: [1.0; 3],
        surroundings: Surroundings::default(),
    };
    render(session, &shot, settings, &Execution::default()).unwrap()
}

/// What a kind saved.
fn saved(rendered: &Rendered, kind: Coherence) -> u64 {
    let counters = &rendered.stats.visibility;
    match kind {
        Coherence::Object => rendered.stats.cull.triangles_culled,
        Coherence::Face => counters.saved_by_face,
        Coherence::Edge => counters.saved_by_edge,
        Coherence::ImpliedEdge => counters.saved_by_implied_edge,
        Coherence::ScanLine => counters.saved_by_scan_line,
        Coherence::Area => counters.saved_by_area,
        Coherence::Depth => counters.saved_by_depth,
        Coherence::Frame => rendered.stats.reused,
    }
}

#[test]
fn without_a_kind_of_coherence_the_picture_is_the_same_and_nothing_is_saved() {
    let scene = scene();
    for algorithm in VISIBILITY {
        let structures =
            [Acceleration::BVH, Acceleration::OCTREE, Acceleration::BSP, Acceleration::GRID]
                .map(Some);
        for acceleration in if algorithm.casts_rays { structures.to_vec() } else { vec![None] } {
            let mut settings = Settings {
                picture: PictureSettings {
                    width: 64,
                    height: 48,
                    channels: Channels { depth: true, surface: true, ..Channels::default() },
                    ..PictureSettings::default()
                },
                visibility: algorithm.choice(),
                acceleration,
                ..Settings::default()
            };
            let mut session = Session::new(Arc::clone(&scene)).unwrap();
            shown(&mut session, &settings, 0.0);
            let all = shown(&mut session, &settings, 0.5);
            for &kind in algorithm.coherence {
                let (name, label) = (algorithm.name, kind.name());
                assert!(saved(&all, kind) > 0, "{name}: {label} saves work: {:?}", all.stats);
                settings.coherence =
                    Some(algorithm.coherence.iter().copied().filter(|k| *k != kind).collect());
                let without = shown(&mut session, &settings, 0.5);
                assert!(
                    without.frame == all.frame,
                    "{name} without {label} makes the same picture"
                );
                assert_eq!(saved(&without, kind), 0, "{name} without {label} saves nothing by it");
                // Implied edges cut spans, which area coherence makes.
                let spans = (kind == Coherence::ImpliedEdge).then_some(Coherence::Area);
                settings.coherence = Some(std::iter::once(kind).chain(spans).collect());
                // Twice: what is kept from picture to picture is there the second time.
                shown(&mut session, &settings, 0.0);
                let alone = shown(&mut session, &settings, 0.5);
                assert!(
                    alone.frame == all.frame,
                    "{name} with {label} alone makes the same picture"
                );
                assert!(
                    saved(&alone, kind) > 0,
                    "{name}: {label} saves work without the others, too"
                );
            }
            settings.coherence = Some(Vec::new());
            assert!(
                shown(&mut session, &settings, 0.5).frame == all.frame,
                "{} without any",
                algorithm.name
            );
        }
    }
}

#[test]
fn a_turntable_reuses_what_its_first_picture_found_out() {
    for name in ["z-buffer", "bsp", "ray-cast"] {
        let mut settings =
            Settings::default().with_size(32, 24).with_visibility(name.parse().unwrap());
        let turn = |settings: &Settings| {
            let mut session = Session::new(scene()).unwrap();
            (0..4).map(|i| shown(&mut session, settings, f64::from(i))).collect::<Vec<_>>()
        };
        let with = turn(&settings);
        settings.coherence = Some(vec![Coherence::Object]);
        let without = turn(&settings);
        assert_eq!(with[0].stats.reused, 0, "{name}");
        assert!(with[1..].iter().all(|r| r.stats.reused > 0), "{name}");
        assert!(without.iter().all(|r| r.stats.reused == 0), "{name}");
        assert!(with.iter().zip(&without).all(|(a, b)| a.frame == b.frame), "{name}");
        let kept: Vec<_> = with.iter().map(|r| r.stats.visibility.saved_by_frame > 0).collect();
        assert_eq!(
            kept,
            [false, name == "bsp", name == "bsp", name == "bsp"],
            "{name}: the tree is kept"
        );
    }
}

#[test]
fn a_kind_that_an_algorithm_does_not_exploit_is_refused() {
    for algorithm in VISIBILITY {
        for (kind, label) in Coherence::ALL {
            let settings = Settings {
                visibility: algorithm.choice(),
                coherence: Some(vec![kind]),
                ..Settings::default()
            };
            match settings.check() {
                Ok(_) => {
                    assert!(algorithm.coherence.contains(&kind), "{}: {label}", algorithm.name)
                }
                Err(e) => {
                    assert!(!algorithm.coherence.contains(&kind), "{}: {label}", algorithm.name);
                    let text = e.to_string();
                    assert!(text.contains(label) && text.contains("object"), "{text}");
                }
            }
        }
    }
}
