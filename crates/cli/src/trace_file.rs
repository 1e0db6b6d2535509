//! `--trace FILE`: the steps of the algorithm, a JSON object a line.

use crate::report::{Failure, is_standard};
use serde::Serialize;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use vitral::Renderer;
use vitral::internals::render::trace::numbered::{Collector, NumberedStep};

/// A file, or standard output, that the steps of each frame are written to when it is done.
pub(crate) struct TraceFile {
    path: PathBuf,
    out: BufWriter<Box<dyn Write + Send>>,
    collector: Arc<Collector>,
    /// Whether several frames are traced.
    has_frames: bool,
}

/// A line of the file.
#[derive(Serialize)]
struct Line {
    /// The frame of a turntable.
    #[serde(skip_serializing_if = "Option::is_none")]
    frame: Option<u32>,
    #[serde(flatten)]
    step: NumberedStep,
}

impl TraceFile {
    /// Makes the file, and lets `renderer` be watched; each comparison of the z-buffer at the pixel `watched` is written.
    pub(crate) fn create(
        path: &Path,
        renderer: &mut Renderer,
        watched: Option<[u32; 2]>,
        has_frames: bool,
    ) -> Result<Self, Failure> {
        let out: Box<dyn Write + Send> = if is_standard(path) {
            Box::new(std::io::stdout())
        } else {
            Box::new(File::create(path).map_err(|e| failure(path, &e))?)
        };
        let execution = renderer.execution_mut();
        let collector = Arc::new(Collector::new(execution.budget.clone(), watched));
        execution.observer = Some(collector.clone());
        Ok(Self { path: path.to_owned(), out: BufWriter::new(out), collector, has_frames })
    }

    /// Writes the steps of a frame.
    pub(crate) fn write_frame(&mut self, frame: u32) -> Result<(), Failure> {
        let frame = self.has_frames.then_some(frame);
        for step in self.collector.take()? {
            let written = serde_json::to_writer(&mut self.out, &Line { frame, step }).map_err(std::io::Error::from);
            written.and_then(|()| self.out.write_all(b"\n")).map_err(|e| failure(&self.path, &e))?;
        }
        Ok(())
    }

    /// Writes what is left, and ends watching.
    pub(crate) fn finish(mut self, renderer: &mut Renderer) -> Result<(), Failure> {
        renderer.execution_mut().observer = None;
        self.out.flush().map_err(|e| failure(&self.path, &e))
    }
}

fn failure(path: &Path, error: &std::io::Error) -> Failure {
    if is_standard(path) {
        return Failure::standard_output(error);
    }
    Failure::with_code(5, format!("{}: {error}", path.display()))
}
