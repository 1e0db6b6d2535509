//! `--trace FILE`: the steps of the algorithm, a JSON object a line. `--structure FILE.svg`: the
//! structure that they build.

use crate::render_args::ReportArgs;
use crate::report::{self, Failure, is_standard};
use serde::Serialize;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use vitral::Renderer;
use vitral::internals::render::trace::numbered::{Collector, NumberedStep};
use vitral::internals::render::trace::structure::drawer;

/// Takes the steps of each frame when it is done, writes them, and draws what they build.
pub(crate) struct Onlooker {
    collector: Arc<Collector>,
    /// The file of the trace, or standard output.
    trace: Option<(PathBuf, BufWriter<Box<dyn Write + Send>>)>,
    /// The file of the structure.
    structure: Option<PathBuf>,
    /// Whether several frames are traced.
    has_frames: bool,
}

/// A line of the file.
#[derive(Serialize)]
struct Line<'s> {
    /// The frame of a turntable.
    #[serde(skip_serializing_if = "Option::is_none")]
    frame: Option<u32>,
    #[serde(flatten)]
    step: &'s NumberedStep,
}

impl Onlooker {
    /// Looks on at `renderer` if anybody asked for that; makes the file of the trace.
    pub(crate) fn new(
        args: &ReportArgs,
        renderer: &mut Renderer,
        has_frames: bool,
    ) -> Result<Option<Self>, Failure> {
        if args.trace.is_none() && args.structure.is_none() {
            return Ok(None);
        }
        let open = |path: &PathBuf| {
            let out: Box<dyn Write + Send> = if is_standard(path) {
                // Tells where nothing is open.
                report::print(&[])?;
                Box::new(std::io::stdout())
            } else {
                Box::new(File::create(path).map_err(|e| failure(path, &e))?)
            };
            Ok::<_, Failure>((path.clone(), BufWriter::new(out)))
        };
        let (trace, structure) =
            (args.trace.as_ref().map(open).transpose()?, args.structure.clone());
        // At the pixel that is explained, the z-buffer tells each comparison.
        let execution = renderer.execution_mut();
        let collector = Arc::new(Collector::new(execution.budget.clone(), args.pixel));
        execution.observer = Some(collector.clone());
        Ok(Some(Self { collector, trace, structure, has_frames }))
    }

    /// Takes the steps of a frame. The structure of the last one stays.
    pub(crate) fn take_frame(&mut self, renderer: &Renderer, frame: u32) -> Result<(), Failure> {
        let steps = self.collector.take()?;
        if let Some((path, out)) = &mut self.trace {
            let frame = self.has_frames.then_some(frame);
            for step in &steps {
                let written = serde_json::to_writer(&mut *out, &Line { frame, step })
                    .map_err(std::io::Error::from);
                written.and_then(|()| out.write_all(b"\n")).map_err(|e| failure(path, &e))?;
            }
        }
        let (settings, picture) = (&renderer.settings, &renderer.settings.picture);
        if let (Some(path), Some(draw)) = (&self.structure, drawer(settings.visibility)) {
            report::write(path, draw(&steps, picture.width, picture.height).as_bytes())?;
        }
        Ok(())
    }

    /// Flushes the trace, and takes the observer away.
    pub(crate) fn finish(self, renderer: &mut Renderer) -> Result<(), Failure> {
        renderer.execution_mut().observer = None;
        match self.trace {
            Some((path, mut out)) => out.flush().map_err(|e| failure(&path, &e)),
            None => Ok(()),
        }
    }
}

fn failure(path: &Path, error: &std::io::Error) -> Failure {
    if is_standard(path) {
        return Failure::standard_output(error);
    }
    Failure::with_code(5, format!("{}: {error}", path.display()))
}
