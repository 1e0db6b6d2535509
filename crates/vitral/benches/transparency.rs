//! What transparent surfaces cost: frames of a turntable with and without them, in turns, as ratios of the fastest.
//!
//! `cargo bench -p vitral --bench transparency -- MODEL [ROUNDS [WAY]...]`; without a model the teapot. A model without
//! transparent materials gets `kt` 0.6 everywhere. Four samples a pixel, 1024x768. *Opaque* is the same model with
//! `--transparency none`; the orders and models are those of the registry, *translucent* blurs what is behind every surface.
//! `VITRAL_THREADS` limits the threads.

use std::time::Instant;
use vitral::render::Transparency;
use vitral::render::transparency::registry::{MODELS, ORDERS};
use vitral::{Axis, Error, LoadOptions, Renderer, Scene, default_up, execution, load, override_material};

/// Frames of the turntable.
const FRAMES: usize = 8;
/// A frame of the default order takes at most so many times an opaque one.
const MOST: f64 = 1.6;

/// A way to make frames: its renderer, with the settings.
struct Way {
    name: String,
    renderer: Renderer,
    fastest: [f64; FRAMES],
}

fn way(name: &str, scene: &Scene, threads: usize, up: Axis) -> Result<Way, Error> {
    let mut renderer = Renderer::with_execution(scene.clone(), execution(threads)?)?;
    renderer.up = up;
    (renderer.settings.width, renderer.settings.height, renderer.settings.samples) = (1024, 768, 4);
    Ok(Way { name: name.to_owned(), renderer, fastest: [f64::INFINITY; FRAMES] })
}

/// All ways, the opaque one first.
fn ways(model: &str, threads: usize) -> Result<Vec<Way>, Error> {
    let mut scene = load(model, &LoadOptions::default(), &execution(threads)?.workers)?;
    if scene.materials.iter().all(|m| m.opacity >= 1.0) {
        override_material(&mut scene, "*", "kt", "0.6")?;
    }
    let mut blurred = scene.clone();
    override_material(&mut blurred, "*", "transmission", "translucent")?;
    let up = default_up(model);
    let mut ways = vec![way("opaque", &scene, threads, up)?];
    ways[0].renderer.settings.transparency = Transparency::None;
    for order in ORDERS {
        let mut way = way(order.name, &scene, threads, up)?;
        way.renderer.settings.transparency_order = order.value;
        let visibility = if order.needs_list { "bsp" } else { "z-buffer" };
        visibility.clone_into(&mut way.renderer.settings.visibility);
        ways.push(way);
    }
    for row in MODELS.iter().filter(|m| m.value != Transparency::default() && m.value != Transparency::None) {
        let mut way = way(row.name, &scene, threads, up)?;
        way.renderer.settings.transparency = row.value;
        ways.push(way);
    }
    ways.push(way("translucent", &blurred, threads, up)?);
    Ok(ways)
}

impl Way {
    /// Renders the turntable and keeps each frame's least milliseconds.
    fn turn(&mut self) -> Result<(), Error> {
        let cameras = self.renderer.turntable_cameras(FRAMES);
        // What outlives a frame is made before.
        self.renderer.render_from(&cameras[0])?;
        for (camera, least) in cameras.iter().zip(&mut self.fastest) {
            let start = Instant::now();
            self.renderer.render_from(camera)?;
            *least = least.min(start.elapsed().as_secs_f64() * 1e3);
        }
        Ok(())
    }
}

fn measure(model: &str, rounds: usize, only: &[String]) -> Result<(), Error> {
    let threads = std::env::var("VITRAL_THREADS").ok().and_then(|n| n.parse().ok()).unwrap_or(0);
    let mut ways = ways(model, threads)?;
    ways.retain(|w| only.is_empty() || only.contains(&w.name));
    // In turns, and of each frame the fastest time: what else the machine does takes from all alike.
    for _ in 0..rounds {
        ways.iter_mut().try_for_each(Way::turn)?;
    }
    let Some(first) = ways.first() else { return Ok(()) };
    let mean = |way: &Way| way.fastest.iter().sum::<f64>() / FRAMES as f64;
    println!("{model}: {} triangles, {rounds} rounds of {FRAMES} frames", first.renderer.world().facet_count);
    println!("| way | ms a frame | {} = 1 | at most |", first.name);
    println!("|---|---|---|---|");
    for way in &ways {
        let (time, ratio) = (mean(way), mean(way) / mean(first));
        let missed = if ratio > MOST { " missed" } else { "" };
        let most = if way.name == ORDERS[0].name { format!("{MOST}{missed}") } else { "-".to_owned() };
        println!("| {} | {time:.1} | {ratio:.2} | {most} |", way.name);
    }
    Ok(())
}

fn main() -> std::process::ExitCode {
    let mut arguments = std::env::args().skip(1).filter(|a| a != "--bench");
    let model = arguments.next().unwrap_or_else(|| "builtin:teapot".to_owned());
    let rounds = arguments.next().and_then(|n| n.parse().ok()).unwrap_or(5);
    match measure(&model, rounds, &arguments.collect::<Vec<_>>()) {
        Ok(()) => 0.into(),
        Err(error) => {
            eprintln!("transparency: {error}");
            error.exit_code().into()
        }
    }
}
