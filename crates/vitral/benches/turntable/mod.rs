//! What it costs to make frames in one way or another: each way's frames of a turntable, in turns,
//! as ratios of the fastest.

use std::process::ExitCode;
use std::time::Instant;
use vitral::internals::math::lanes::level_from_environment;
use vitral::{Error, Execution, LoadOptions, Renderer, Scene, execution, load_on};

/// Frames of the turntable.
pub(crate) const FRAMES: usize = 8;

/// What the command line asks for: `[MODEL [ROUNDS [WAY]...]]`.
pub(crate) struct Arguments {
    pub(crate) model: String,
    pub(crate) rounds: usize,
    ways: Vec<String>,
}

/// A way to make frames, and the milliseconds that each took at least.
pub(crate) struct Way {
    pub(crate) name: String,
    /// Most times of a frame of the first way.
    most: Option<f64>,
    fastest: [f64; FRAMES],
}

/// Runs a bench as a program.
pub(crate) fn run(bench: &str, measure: impl FnOnce(&Arguments) -> Result<(), Error>) -> ExitCode {
    let mut arguments = std::env::args().skip(1).filter(|a| a != "--bench");
    let model = arguments.next().unwrap_or_else(|| "builtin:teapot".to_owned());
    let rounds = arguments.next().and_then(|n| n.parse().ok()).unwrap_or(5);
    match measure(&Arguments { model, rounds, ways: arguments.collect() }) {
        Ok(()) => 0.into(),
        Err(error) => {
            eprintln!("{bench}: {error}");
            ExitCode::FAILURE
        }
    }
}

/// As many threads as `VITRAL_THREADS` says, with the instruction set that `VITRAL_SIMD` names.
fn threads() -> Result<Execution, Error> {
    let execution =
        execution(std::env::var("VITRAL_THREADS").ok().and_then(|n| n.parse().ok()).unwrap_or(0));
    let level =
        level_from_environment().map_err(|what| Error::Usage { what, hint: String::new() })?;
    Ok(Execution { level, ..execution })
}

impl Arguments {
    /// Whether a way is wanted; without names all are.
    pub(crate) fn wants(&self, way: &str) -> bool {
        self.ways.is_empty() || self.ways.iter().any(|name| name == way)
    }

    /// The model.
    pub(crate) fn scene(&self) -> Result<Scene, Error> {
        load_on(&self.model, &LoadOptions::default(), &threads()?.workers)
    }

    /// Renders the model, or what was made of it.
    pub(crate) fn renderer(&self, scene: Scene) -> Result<Renderer, Error> {
        let mut renderer = Renderer::with_execution(scene, threads()?)?;
        (
            renderer.settings.picture.width,
            renderer.settings.picture.height,
            renderer.settings.picture.samples,
        ) = (1024, 768, 4);
        Ok(renderer)
    }

    /// Prints a table of the ways; the first is what the others are measured by.
    pub(crate) fn print<'a>(
        &self,
        bench: &str,
        renderer: &Renderer,
        ways: impl IntoIterator<Item = &'a Way>,
    ) {
        let mut ways = ways.into_iter().peekable();
        let Some(&first) = ways.peek() else { return };
        println!(
            "{}: {} triangles, {} rounds of {FRAMES} frames",
            self.model,
            renderer.world().facet_count,
            self.rounds
        );
        println!("| {bench} | ms a frame | {} = 1 | at most |", first.name);
        println!("|---|---|---|---|");
        for way in ways {
            let ratio = way.mean() / first.mean();
            let missed = |most| if ratio > most { " missed" } else { "" };
            let most = way.most.map_or("-".to_owned(), |most| format!("{most}{}", missed(most)));
            println!("| {} | {:.1} | {ratio:.2} | {most} |", way.name, way.mean());
        }
    }
}

impl Way {
    pub(crate) fn new(name: &str, most: Option<f64>) -> Self {
        Self { name: name.to_owned(), most, fastest: [f64::INFINITY; FRAMES] }
    }

    /// Renders the turntable, with `before` done before each frame, and keeps each frame's fastest
    /// time: what else the machine does takes from all ways alike when they take turns.
    pub(crate) fn turn(
        &mut self,
        renderer: &mut Renderer,
        mut before: impl FnMut(&mut Renderer, usize),
    ) -> Result<(), Error> {
        let cameras = renderer.turntable_cameras(FRAMES);
        // What outlives a frame is made before.
        renderer.render_from(&cameras[0])?;
        for (i, (camera, least)) in cameras.iter().zip(&mut self.fastest).enumerate() {
            before(renderer, i);
            let start = Instant::now();
            renderer.render_from(camera)?;
            *least = least.min(start.elapsed().as_secs_f64() * 1e3);
        }
        Ok(())
    }

    fn mean(&self) -> f64 {
        self.fastest.iter().sum::<f64>() / FRAMES as f64
    }
}
