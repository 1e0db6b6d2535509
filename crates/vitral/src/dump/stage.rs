//! What the stages share: how files are written and listed, and the view that the tables are made of.

use crate::{Error, Renderer};
use vitral_raster::{SamplePattern, Viewport};
use vitral_render::PreparedView;
use vitral_render::stats::CullCounters;
use vitral_scene::Camera;

/// A file that the index lists.
pub(super) struct Listed {
    pub(super) name: String,
    pub(super) what: String,
}

/// Takes a file: its name and bytes.
pub(super) type Write<'a> = dyn FnMut(&str, &[u8]) -> Result<(), Error> + 'a;

/// The view from `camera`, with one sample a pixel.
pub(super) fn prepare<'a>(
    renderer: &'a Renderer,
    camera: &Camera,
    viewport: Viewport,
    counters: &mut CullCounters,
) -> PreparedView<'a> {
    let pattern = SamplePattern::new(1);
    PreparedView::new(renderer.session(), camera, &renderer.settings, viewport, pattern, renderer.execution(), counters)
}
