//! Transform and lighting; the recorder of passes.

use crate::Context;
use crate::state::RasterPosition;
use crate::vertex::VertexBatch;
use std::sync::Arc;
use vitral_raster::forward::{Command, FragmentState};

/// Recorded passes that have not run.
#[derive(Debug, Default)]
pub(crate) struct Recorder {}

/// A vertex after transformation and lighting, for feedback and selection.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ProcessedVertex {
    /// Clip coordinates.
    pub clip: [f32; 4],
    /// Signed distances to the user clip planes (0 for disabled ones): inside is >= 0.
    pub user: [f32; 8],
    /// Front colour, clamped.
    pub color: [f32; 4],
    /// Front secondary colour, clamped.
    pub secondary: [f32; 3],
    /// Back colour, clamped (two-sided lighting; else the front's).
    pub back_color: [f32; 4],
    /// Coordinates of each unit after generation and texture matrix.
    pub tex: [[f32; 4]; 8],
    /// Fog coordinate.
    pub fog: f32,
    /// Edge flag.
    pub edge: bool,
}

impl Context {
    /// Records the drawing of `batch` with a snapshot of the state.
    pub(crate) fn record_draw(&mut self, batch: Arc<VertexBatch>) {
        let _ = batch;
    }

    /// Records a command on the current draw target.
    pub(crate) fn record(&mut self, command: Command) {
        let _ = command;
    }

    /// Runs everything recorded: afterwards all planes and queries are up to date.
    pub(crate) fn flush_recorded(&mut self) {}

    /// The per-fragment state as it is now. `images` leaves out what pixel rectangles do not meet (polygon stipple).
    pub(crate) fn fragment_state(&mut self, images: bool) -> Arc<FragmentState> {
        let _ = images;
        Arc::new(FragmentState::default())
    }

    /// Transforms and lights all vertices of a batch now.
    pub(crate) fn process_batch(&mut self, batch: &VertexBatch) -> Vec<ProcessedVertex> {
        let _ = batch;
        Vec::new()
    }

    /// What `RasterPos` of a model-space position gives: with the current attributes, lit, clipped against the view
    /// volume and user planes.
    pub(crate) fn raster_position(&mut self, position: [f32; 4]) -> RasterPosition {
        let _ = position;
        RasterPosition::default()
    }
}
