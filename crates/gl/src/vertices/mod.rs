//! Where vertices come from: Begin/End, arrays, display lists, evaluators; and where they go besides the screen:
//! feedback and selection.

use crate::Context;
use crate::vertex::VertexBatch;
use std::sync::Arc;

/// Begin/End.
#[derive(Debug, Default)]
pub(crate) struct Builder {}

/// Display lists being made and called.
#[derive(Debug, Default)]
pub(crate) struct Lists {}

/// Feedback and selection.
#[derive(Debug, Default)]
pub(crate) struct Feedback {}

impl Context {
    /// Runs `call` now, or keeps it in the list that is being compiled, or both (`COMPILE_AND_EXECUTE`).
    pub(crate) fn listable(&mut self, call: impl Fn(&mut Self) + Send + Sync + 'static) {
        call(self);
    }

    /// Whether a Begin is open, of the immediate stream.
    pub(crate) fn inside_begin(&self) -> bool {
        false
    }

    /// Draws a batch: to the screen, or to the feedback or selection buffer.
    pub(crate) fn draw_batch(&mut self, batch: Arc<VertexBatch>) {
        self.record_draw(batch);
    }
}
