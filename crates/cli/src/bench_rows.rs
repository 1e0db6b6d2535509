//! The measurements of `vitral bench`, one row for each algorithm.

use crate::args::BenchArgs;
use crate::report::{self, Failure};
use vitral::Limit;
use vitral::Renderer;
use vitral::bench::{Entrant, Measured, Task, measure};

/// A row of the table: who, and what it took or the limit it met.
pub(crate) type Row = (Entrant, Result<Measured, Limit>);

/// Measures one after the other, and says on standard error where it is.
pub(crate) fn rows(
    args: &BenchArgs,
    renderer: &Renderer,
    entrants: &[Entrant],
) -> Result<Vec<Row>, Failure> {
    let camera = renderer.frame_camera();
    let task = Task {
        scene: renderer.scene(),
        camera: &camera,
        settings: &renderer.settings,
        frames: args.frames as usize + 1,
        time_limit: Some(args.time_limit),
        memory_limit: args.max_memory.or_else(crate::machine::memory),
    };
    let mut rows = Vec::new();
    for (i, entrant) in entrants.iter().enumerate() {
        if !args.quiet {
            report::line(&format!("{} of {}: {}", i + 1, entrants.len(), entrant.name()));
        }
        let measured =
            measure(&task, entrant, renderer.execution()).map_err(vitral::Error::from)?;
        if let Err(limit @ Limit::Cancelled { .. }) = measured {
            return Err(limit.into());
        }
        rows.push((*entrant, measured));
    }
    Ok(rows)
}

/// Samples that differ from what the first row saw, if both saw something.
pub(crate) fn differing(rows: &[Row], row: &Measured) -> Option<u64> {
    rows.first()
        .and_then(|(_, first)| first.as_ref().ok())
        .map(|first| row.seen.differing(&first.seen))
}
