//! `--trace FILE`: the steps of the algorithm, a JSON object a line.

use crate::report::{Failure, is_standard};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use vitral::internals::render::trace::{Observer, Step};

/// A file, or standard output, that steps are written to as they are done.
pub(crate) struct TraceFile {
    path: PathBuf,
    /// Where they go, or why that cannot be written.
    file: Mutex<std::io::Result<BufWriter<Box<dyn Write + Send>>>>,
}

impl std::fmt::Debug for TraceFile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("TraceFile").field("path", &self.path).finish_non_exhaustive()
    }
}

impl TraceFile {
    /// Makes the file.
    pub(crate) fn create(path: &Path) -> Result<Arc<Self>, Failure> {
        let out: Box<dyn Write + Send> = if is_standard(path) {
            Box::new(std::io::stdout())
        } else {
            Box::new(File::create(path).map_err(|e| failure(path, &e))?)
        };
        Ok(Arc::new(Self { path: path.to_owned(), file: Mutex::new(Ok(BufWriter::new(out))) }))
    }

    /// Writes what is left, and tells if something could not be written.
    pub(crate) fn finish(&self) -> Result<(), Failure> {
        let mut file = self.file.lock().expect("no thread panics while it writes a step");
        match &mut *file {
            Ok(file) => file.flush().map_err(|e| failure(&self.path, &e)),
            Err(e) => Err(failure(&self.path, e)),
        }
    }
}

impl Observer for TraceFile {
    fn step(&self, step: &Step) {
        let mut file = self.file.lock().expect("no thread panics while it writes a step");
        // After an error nothing more is written; the end tells it.
        if let Ok(out) = &mut *file {
            let written =
                serde_json::to_writer(&mut *out, step).map_err(Into::into).and_then(|()| out.write_all(b"\n"));
            if let Err(e) = written {
                *file = Err(e);
            }
        }
    }
}

fn failure(path: &Path, error: &std::io::Error) -> Failure {
    if is_standard(path) {
        return Failure::standard_output(error);
    }
    Failure::with_code(5, format!("{}: {error}", path.display()))
}
