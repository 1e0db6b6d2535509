//! What the vertices' room tells this one.

use crate::Context;

impl Context {
    /// Whether `RENDER_MODE` is `RENDER`.
    pub(crate) fn renders(&self) -> bool {
        true
    }

    /// Feedback and selection: notes a pixel rectangle or bitmap (`token`) at the current raster position.
    pub(crate) fn feedback_image(&mut self, token: u32) {
        let _ = token;
    }
}
