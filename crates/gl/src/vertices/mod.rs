//! Where vertices come from: Begin/End, arrays, display lists, evaluators; and where they go besides the screen:
//! feedback and selection.

mod arrays;
mod attribute;
mod buffers;
mod builder;
mod client;
mod compile;
mod evaluators;
mod feedback;
mod immediate;
mod lists;
mod merge;
mod names;
mod position;
mod rect;

pub(crate) use arrays::Arrays;
pub use buffers::Buffer;
pub(crate) use builder::Builder;
pub(crate) use feedback::Feedback;
pub(crate) use lists::Lists;
pub use lists::{List, ListNames};

use crate::Context;
use crate::enums;
use crate::vertex::VertexBatch;
use std::sync::Arc;

impl Context {
    /// Draws a batch: to the screen, or to the feedback or selection buffer.
    pub(crate) fn draw_batch(&mut self, batch: Arc<VertexBatch>) {
        if batch.primitives.is_empty() {
            return;
        }
        #[cfg(test)]
        self.builder.log.push(batch.clone());
        if self.feedback.mode == enums::RENDER {
            self.record_draw(batch);
        } else {
            self.feed_batch(&batch);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::memory::Arena;
    use crate::{Context, Shared};
    use std::sync::Arc;

    /// Where the client's memory begins.
    pub(super) const BASE: usize = 0x1000;

    /// A new context with 64 KiB of client memory at [`BASE`].
    pub(super) fn context() -> Context {
        Context::new(Arc::new(Arena::new(BASE, 1 << 16)), Arc::new(Shared::default()))
    }
}
