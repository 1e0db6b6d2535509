//! Transform and lighting; the recorder of passes.

mod area;
mod derive;
mod emit;
mod geometry;
mod grid;
mod grid_search;
mod ordered;
mod parts;
mod piece;
mod process;
mod record;
mod snapshot;
mod triangulate;
mod triangulation;
mod vertices;

pub(crate) use process::{ProcessedVertex, Wanted};
pub(crate) use record::Recorder;
pub use record::RunnerSource;
pub use triangulation::TriangulationCell;
