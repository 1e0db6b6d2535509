//! How long a picture takes: loads a model once, renders views all round it, and prints the times
//! as JSON.
//!
//! `cargo run --release -p vitral --example turntable_bench -- MODEL FRAMES SAMPLES [WIDTHxHEIGHT]`
//!
//! Every frame ends as RGBA bytes in memory; nothing is encoded. The camera goes round the model as
//! that of the peers does (`benches/peers/common.py`), with the same angle of view; `coverage` is
//! the share of pixels of the last frame that show the model. `parts_ms` is what the parts of a
//! whole run take one by one, the median of five each: reading the file, the first picture of a
//! scene, encoding it as PNG. `VITRAL_THREADS` limits the threads, `VITRAL_SIMD` names the
//! instruction set.

use std::f64::consts::{PI, TAU};
use std::time::Instant;
use vitral::internals::math::{func, lanes::level_from_environment};
use vitral::{
    Camera, DVec3, Error, Execution, LoadOptions, PictureFormat, Renderer, execution, load_on,
};

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

/// A file as a renderer that will draw it.
fn open(plan: &Plan, execution: &Execution) -> Result<Renderer, Error> {
    let scene = load_on(&plan.model, &LoadOptions::default(), &execution.workers)?;
    let mut renderer = Renderer::with_execution(scene, execution.clone())?;
    (renderer.settings.picture.width, renderer.settings.picture.height) = plan.size;
    renderer.settings.picture.samples = plan.samples;
    Ok(renderer)
}

/// The cameras of the peers, those of the first frame last.
fn cameras(renderer: &Renderer, count: usize) -> Vec<Camera> {
    let bounds = &renderer.world().bounds;
    let (aspect, center) = (renderer.aspect(), bounds.center());
    let distance = 0.5 * bounds.diagonal() / func::sin(PI / 12.0);
    let turned = |i: usize| {
        let angle = TAU * i as f64 / count as f64;
        let position = center + DVec3::new(func::sin(angle), 0.0, func::cos(angle)) * distance;
        Camera::look_at(position, center).with_view_angle(PI / 6.0)
    };
    let mut cameras: Vec<_> = (1..=count).map(turned).collect();

    // The box round the model, as it is seen, fits 0.9 of the widest picture.
    let fill = |camera: &Camera| {
        let view = camera.view_from_world();
        let corners = bounds
            .corners()
            .map(|corner| view.transform_point3(corner))
            .map(|p| [p.x / -p.z, p.y / -p.z]);
        let extent = |axis: usize| {
            let of = |least: f64, pick: fn(f64, f64) -> f64| {
                corners.iter().fold(least, |so_far, c| pick(so_far, c[axis]))
            };
            of(f64::NEG_INFINITY, f64::max) - of(f64::INFINITY, f64::min)
        };
        extent(1).max(extent(0) / aspect)
    };
    let widest = cameras.iter().map(fill).fold(0.0, f64::max);
    let view_angle = 2.0 * func::atan2(0.5 * widest / 0.9, 1.0);
    cameras.iter_mut().for_each(|camera| *camera = camera.with_view_angle(view_angle));
    cameras
}

/// Reading, the first picture, encoding: the sum of their medians.
fn parts(plan: &Plan, execution: &Execution) -> Result<f64, Error> {
    let mut times = [const { Vec::new() }; 3];
    let mut timed =
        |part: usize, start: Instant| times[part].push(start.elapsed().as_secs_f64() * 1e3);
    for _ in 0..5 {
        let start = Instant::now();
        let mut renderer = open(plan, execution)?;
        timed(0, start);
        let start = Instant::now();
        let picture = renderer.render()?;
        timed(1, start);
        let start = Instant::now();
        std::hint::black_box(picture.encode(PictureFormat::Png)?);
        timed(2, start);
    }
    let median = |mut part: Vec<f64>| {
        part.sort_by(f64::total_cmp);
        part[part.len() / 2]
    };
    Ok(times.map(median).into_iter().sum())
}

fn measure(plan: &Plan) -> Result<serde_json::Value, Error> {
    let threads = std::env::var("VITRAL_THREADS").ok().and_then(|n| n.parse().ok()).unwrap_or(0);
    let level =
        level_from_environment().map_err(|what| Error::Usage { what, hint: String::new() })?;
    let execution = Execution { level, ..execution(threads) };
    let start = Instant::now();
    let mut renderer = open(plan, &execution)?;
    let load_ms = start.elapsed().as_secs_f64() * 1e3;
    let mut milliseconds = Vec::with_capacity(plan.frames);
    let (mut bytes, mut coverage) = (0, 0.0);
    for camera in cameras(&renderer, plan.frames) {
        let start = Instant::now();
        let picture = renderer.render_from(&camera)?;
        milliseconds.push(start.elapsed().as_secs_f64() * 1e3);
        coverage =
            picture.stats.picture.covered_pixels as f64 / picture.stats.picture.pixels as f64;
        bytes += picture.rgba8().len();
        renderer.recycle(picture);
    }
    milliseconds.sort_by(f64::total_cmp);
    let parts_ms = parts(plan, renderer.execution())?;
    Ok(serde_json::json!({
        "median_ms": milliseconds[plan.frames / 2],
        "min_ms": milliseconds[0],
        "frames": plan.frames,
        "triangles": renderer.world().facet_count,
        "load_ms": load_ms,
        "parts_ms": parts_ms,
        "bytes": bytes,
        "coverage": coverage,
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
            1.into()
        }
    }
}
