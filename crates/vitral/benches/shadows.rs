//! What shadows cost: frames of a turntable with and without them, in turns, as ratios of the fastest.
//!
//! `cargo bench -p vitral --bench shadows -- MODEL [ROUNDS]`; without a model the teapot. One parallel light, maps of 2048
//! texels a side, four samples a pixel, 1024x768. *Kept*: the light stands still, and what was found out for it serves all
//! frames. *Made anew*: the light turns a little before every frame, so that nothing can be kept. `VITRAL_THREADS` limits
//! the threads.

use std::time::Instant;
use vitral::math::DVec3;
use vitral::{Error, Light, LoadOptions, Renderer, default_up, execution, load};

/// Frames of the turntable.
const FRAMES: usize = 8;

/// A way to make frames: the shadows, the maps' cascades, whether the light moves; most times of a frame without shadows.
struct Way {
    name: &'static str,
    shadows: &'static str,
    cascades: u32,
    moves: bool,
    most: Option<f64>,
}

const WAYS: [Way; 9] = [
    Way { name: "none", shadows: "none", cascades: 1, moves: false, most: None },
    Way { name: "map, kept", shadows: "map", cascades: 1, moves: false, most: Some(1.3) },
    Way { name: "map, made anew", shadows: "map", cascades: 1, moves: true, most: Some(1.8) },
    Way { name: "map, 4 cascades, kept", shadows: "map", cascades: 4, moves: false, most: None },
    Way { name: "volume, kept", shadows: "volume", cascades: 1, moves: false, most: Some(4.0) },
    Way { name: "volume, made anew", shadows: "volume", cascades: 1, moves: true, most: Some(4.0) },
    Way { name: "ray", shadows: "ray", cascades: 1, moves: false, most: None },
    Way { name: "scan-line", shadows: "scan-line", cascades: 1, moves: false, most: None },
    Way { name: "object-precision, kept", shadows: "object-precision", cascades: 1, moves: false, most: None },
];

fn sun(turn: f64) -> Light {
    let kind = vitral::light::LightKind::Directional { direction: DVec3::new(-1.0 + turn, -2.0, -1.0 - turn) };
    Light { kind, ..Light::default() }
}

/// Milliseconds of each frame.
fn turntable(renderer: &mut Renderer, way: &Way, round: usize) -> Result<Vec<f64>, Error> {
    way.shadows.clone_into(&mut renderer.settings.shadows);
    renderer.settings.shadow_cascades = way.cascades;
    renderer.lights = Some(vec![sun(0.0)]);
    let cameras = renderer.turntable_cameras(FRAMES);
    // What is kept is made before.
    renderer.render_from(&cameras[0])?;
    let mut times = Vec::with_capacity(FRAMES);
    for (i, camera) in cameras.iter().enumerate() {
        if way.moves {
            renderer.lights = Some(vec![sun(1e-3 * (1 + i + round * FRAMES) as f64)]);
        }
        let start = Instant::now();
        renderer.render_from(camera)?;
        times.push(start.elapsed().as_secs_f64() * 1e3);
    }
    Ok(times)
}

fn measure(model: &str, rounds: usize, only: Option<&str>) -> Result<(), Error> {
    let threads = std::env::var("VITRAL_THREADS").ok().and_then(|n| n.parse().ok()).unwrap_or(0);
    let execution = execution(threads)?;
    let scene = load(model, &LoadOptions::default(), &execution.workers)?;
    let mut renderer = Renderer::with_execution(scene, execution)?;
    renderer.up = default_up(model);
    (renderer.settings.width, renderer.settings.height, renderer.settings.samples) = (1024, 768, 4);
    renderer.settings.shadow_map_size = 2048;
    let ways: Vec<&Way> = WAYS.iter().filter(|w| only.is_none_or(|name| w.name == name)).collect();

    // In turns, and of each frame the fastest time: what else the machine does takes from all alike.
    let mut fastest = vec![[f64::INFINITY; FRAMES]; ways.len()];
    for round in 0..rounds {
        for (way, fastest) in ways.iter().zip(&mut fastest) {
            let times = turntable(&mut renderer, way, round)?;
            fastest.iter_mut().zip(times).for_each(|(least, time)| *least = least.min(time));
        }
    }
    let sum = |times: &[f64; FRAMES]| times.iter().sum::<f64>() / FRAMES as f64;
    println!("{model}: {} triangles, {rounds} rounds of {FRAMES} frames", renderer.world().facet_count);
    println!("| shadows | ms a frame | without shadows = 1 | at most |");
    println!("|---|---|---|---|");
    for (way, times) in ways.iter().zip(&fastest) {
        let (time, ratio) = (sum(times), sum(times) / sum(&fastest[0]));
        let most =
            way.most.map_or("-".to_owned(), |most| format!("{most}{}", if ratio > most { " missed" } else { "" }));
        println!("| {} | {time:.1} | {ratio:.2} | {most} |", way.name);
    }
    Ok(())
}

fn main() -> std::process::ExitCode {
    let mut arguments = std::env::args().skip(1).filter(|a| a != "--bench");
    let model = arguments.next().unwrap_or_else(|| "builtin:teapot".to_owned());
    let rounds = arguments.next().and_then(|n| n.parse().ok()).unwrap_or(5);
    match measure(&model, rounds, arguments.next().as_deref()) {
        Ok(()) => 0.into(),
        Err(error) => {
            eprintln!("shadows: {error}");
            error.exit_code().into()
        }
    }
}
