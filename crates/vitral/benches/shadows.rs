//! What shadows cost: frames of a turntable with and without them, in turns, as ratios of the
//! fastest.
//!
//! `cargo bench -p vitral --bench shadows -- MODEL [ROUNDS [WAY]...]`; without a model the teapot.
//! One parallel light, maps of 2048 texels a side, four samples a pixel, 1024x768. *Kept*: the
//! light stands still, and what was found out for it serves all frames. *Made anew*: the light
//! turns a little before every frame, so that nothing can be kept. `VITRAL_THREADS` limits the
//! threads.

mod turntable;

use turntable::{Arguments, FRAMES, Way};
use vitral::{DVec3, Error, Light};

/// How a way makes shadows: the algorithm, the maps' cascades, whether the light moves.
type Shadows = (&'static str, u32, bool);

/// All ways, and most times of a frame without shadows.
const WAYS: [(&str, Shadows, Option<f64>); 9] = [
    ("none", ("none", 1, false), None),
    ("map, kept", ("map", 1, false), Some(1.3)),
    ("map, made anew", ("map", 1, true), Some(1.8)),
    ("map, 4 cascades, kept", ("map", 4, false), None),
    ("volume, kept", ("volume", 1, false), Some(4.0)),
    ("volume, made anew", ("volume", 1, true), Some(4.0)),
    ("ray", ("ray", 1, false), None),
    ("scan-line", ("scan-line", 1, false), None),
    ("object-precision, kept", ("object-precision", 1, false), None),
];

fn sun(turn: f64) -> Light {
    let kind =
        vitral::LightKind::Directional { direction: DVec3::new(-1.0 + turn, -2.0, -1.0 - turn) };
    Light { kind, ..Light::default() }
}

fn measure(arguments: &Arguments) -> Result<(), Error> {
    let mut renderer = arguments.renderer(arguments.scene()?)?;
    renderer.settings.shadows.map_size = 2048;
    let wanted = WAYS.into_iter().filter(|(name, ..)| arguments.wants(name));
    let mut ways: Vec<_> =
        wanted.map(|(name, shadows, most)| (Way::new(name, most), shadows)).collect();
    for round in 0..arguments.rounds {
        for (way, (shadows, cascades, moves)) in &mut ways {
            renderer.settings.shadows.algorithm = shadows.parse().expect("a registered name");
            renderer.settings.shadows.cascades = *cascades;
            renderer.lights = Some(vec![sun(0.0)]);
            way.turn(&mut renderer, |renderer, frame| {
                if *moves {
                    renderer.lights = Some(vec![sun(1e-3 * (1 + frame + round * FRAMES) as f64)]);
                }
            })?;
        }
    }
    arguments.print("shadows", &renderer, ways.iter().map(|(way, _)| way));
    Ok(())
}

fn main() -> std::process::ExitCode {
    turntable::run("shadows", measure)
}
