//! Transform and lighting; the recorder of passes.

mod assembled;
mod derive;
mod geometry;
mod grid;
mod ordered;
mod parts;
mod process;
mod record;
mod snapshot;
mod vertices;

pub use assembled::AssembledCell;
pub(crate) use process::{ProcessedVertex, Wanted};
pub(crate) use record::Recorder;
pub use record::RunnerSource;
