//! How long a picture takes: loads a model once, renders views all round it, and prints the times as JSON.
//!
//! `cargo run --release -p vitral --example turntable_bench -- MODEL FRAMES SAMPLES [WIDTHxHEIGHT]`
//!
//! Every frame ends as RGBA bytes in memory; nothing is encoded. `VITRAL_THREADS` limits the threads.

use std::time::Instant;
use vitral::{Error, LoadOptions, Renderer, default_up, execution, load};

/// What is to be measured.
struct Plan {
    model: String,
    frames: usize,
    samples: u32,
    size: (u32, u32),
}

impl Plan {
    fn from_arguments() -> Option<Self> {
        let mut arguments = std::env::args().skip(1);
        let (model, frames, samples) =
            (arguments.next()?, arguments.next()?.parse().ok()?, arguments.next()?.parse().ok()?);
        let size = match arguments.next() {
            Some(text) => {
                let (width, height) = text.split_once('x')?;
                (width.parse().ok()?, height.parse().ok()?)
            }
            None => (1024, 768),
        };
        (frames > 0).then_some(Self { model, frames, samples, size })
    }
}

fn measure(plan: &Plan) -> Result<serde_json::Value, Error> {
    let threads = std::env::var("VITRAL_THREADS").ok().and_then(|n| n.parse().ok()).unwrap_or(0);
    let execution = execution(threads)?;
    let start = Instant::now();
    let scene = load(&plan.model, &LoadOptions::default(), &execution.workers)?;
    let load_ms = start.elapsed().as_secs_f64() * 1e3;

    let mut renderer = Renderer::with_execution(scene, execution)?;
    renderer.up = default_up(&plan.model);
    (renderer.settings.width, renderer.settings.height) = plan.size;
    renderer.settings.samples = plan.samples;
    let mut milliseconds = Vec::with_capacity(plan.frames);
    let mut bytes = 0;
    for camera in renderer.turntable_cameras(plan.frames) {
        let start = Instant::now();
        let rendered = renderer.render_from(&camera)?;
        milliseconds.push(start.elapsed().as_secs_f64() * 1e3);
        bytes += rendered.frame.color.map_or(0, |c| c.data().as_flattened().len());
    }
    milliseconds.sort_by(f64::total_cmp);
    Ok(serde_json::json!({
        "median_ms": milliseconds[plan.frames / 2],
        "min_ms": milliseconds[0],
        "frames": plan.frames,
        "triangles": renderer.world().facet_count,
        "load_ms": load_ms,
        "bytes": bytes,
    }))
}

fn main() -> std::process::ExitCode {
    let Some(plan) = Plan::from_arguments() else {
        eprintln!("turntable_bench MODEL FRAMES SAMPLES [WIDTHxHEIGHT]");
        return 2.into();
    };
    match measure(&plan) {
        Ok(result) => {
            println!("{result}");
            0.into()
        }
        Err(error) => {
            eprintln!("turntable_bench: {error}");
            error.exit_code().into()
        }
    }
}
