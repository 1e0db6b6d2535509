//! Where draws go and reads come from.

use super::attachments::{Surface, Surfaces};
use super::image::lock;
use super::internal_format::Storage;
use crate::Context;
use crate::enums::*;
use std::sync::atomic::Ordering;
use vitral_raster::forward::{Clamping, Target};

/// What [`Resolved`] depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Key {
    version: u64,
    epoch: u64,
    default_buffer: u32,
    default_version: u64,
}

/// All pixels.
const EVERYWHERE: [i32; 4] = [0, 0, i32::MAX, i32::MAX];

/// Where draws go.
#[derive(Clone, Debug)]
pub(crate) struct Resolved {
    key: Key,
    surfaces: Surfaces,
    target: Option<Target>,
    /// Whether it is framebuffer 0 with a colour buffer.
    default_color: bool,
}

impl Context {
    fn resolve(&mut self) -> &Resolved {
        let key = Key {
            version: self.framebuffers.version,
            epoch: self.shared.storage_epoch.load(Ordering::Relaxed),
            default_buffer: self.state.color_buffer.draw_buffer,
            default_version: self.default_framebuffer.version(),
        };
        if self.framebuffers.resolved.as_ref().is_none_or(|r| r.key != key) {
            let surfaces = self.surfaces_of(self.framebuffers.draw, true);
            let target = target_of(&surfaces);
            let default_color = self.framebuffers.draw == 0 && surfaces.color.is_some();
            self.framebuffers.resolved = Some(Resolved { key, surfaces, target, default_color });
        }
        self.framebuffers.resolved.as_ref().expect("just resolved")
    }

    /// The planes of a framebuffer with its draw (or read) buffer.
    pub(crate) fn surfaces_of(&self, name: u32, draw: bool) -> Surfaces {
        match self.framebuffers.object(name) {
            Some(object) => {
                object.surfaces(if draw { object.draw_buffer } else { object.read_buffer })
            }
            None => {
                let buffer = if draw {
                    self.state.color_buffer.draw_buffer
                } else {
                    self.state.pixel_mode.read_buffer
                };
                self.default_framebuffer.surfaces(buffer)
            }
        }
    }

    /// The planes that draws go to: of the bound framebuffer object or framebuffer 0. `None` if it
    /// is incomplete (see [`Self::draw_framebuffer_complete`]), has no size, or draws nowhere.
    pub(crate) fn target(&mut self) -> Option<Target> {
        self.resolve().target.clone()
    }

    /// The same for a command that changes pixels of `area` (x0, y0, x1, y1, the last two
    /// exclusive) or, without it, any. To be called for each recorded command: the target counts as
    /// drawn to from then on.
    pub(crate) fn draw_target(&mut self, area: Option<[i32; 4]>) -> Option<Target> {
        let resolved = self.resolve();
        let target = resolved.target.clone();
        let default_color = resolved.default_color;
        if let Some(writes) = resolved.surfaces.color.as_ref().and_then(|c| c.writes.as_ref()) {
            writes.fetch_add(1, Ordering::Relaxed);
        }
        if default_color {
            self.load_default_framebuffer(area.unwrap_or(EVERYWHERE));
            self.default_framebuffer.set_drawn();
        }
        target
    }

    /// Whether the draw framebuffer is complete; records the error if not.
    pub(crate) fn draw_framebuffer_complete(&mut self, call: &str) -> bool {
        let complete = self.resolve().surfaces.status == FRAMEBUFFER_COMPLETE;
        if !complete {
            self.record_error(
                INVALID_FRAMEBUFFER_OPERATION,
                call,
                "the draw framebuffer is not complete",
            );
        }
        complete
    }

    /// Whether an incomplete framebuffer object stands against a call that draws nothing itself;
    /// then the error is recorded.
    pub(crate) fn refused_by_framebuffer(&mut self, call: &str) -> bool {
        self.framebuffers.draw != 0 && !self.draw_framebuffer_complete(call)
    }

    /// Which of red, green, blue, alpha the draw buffer does not store: writes to them must be
    /// masked.
    pub(crate) fn missing_components(&mut self) -> [bool; 4] {
        self.resolve().surfaces.color.as_ref().map_or([false; 4], |c| c.format.missing())
    }

    /// Where colours are clamped on their way to the draw buffer.
    pub(crate) fn clamping(&mut self) -> Clamping {
        let fragments = self.state.color_buffer.clamps[1] == TRUE;
        match self.resolve().surfaces.color.as_ref().map(|c| c.format.component_type()) {
            Some(FLOAT) if fragments => Clamping::Fragments,
            Some(FLOAT) => Clamping::None,
            _ => Clamping::Results,
        }
    }

    /// Whether colours of vertices are clamped on their way to the draw buffer.
    pub(crate) fn clamps_vertices(&mut self) -> bool {
        match self.state.color_buffer.clamps[0] {
            TRUE => true,
            FIXED_ONLY => self
                .resolve()
                .surfaces
                .color
                .as_ref()
                .is_none_or(|c| c.format.component_type() != FLOAT),
            _ => false,
        }
    }

    /// What the draw buffer stores a component of 1 as, if it stores whole numbers.
    pub(crate) fn stored_one(&mut self) -> Option<f32> {
        match self.resolve().surfaces.color.as_ref().map(|c| c.format.storage) {
            Some(Storage::Half | Storage::Float) => None,
            Some(Storage::Unorm16) => Some(65_535.0),
            _ => Some(255.0),
        }
    }

    /// Whether colours are sRGB-encoded on their way to the draw buffer.
    pub(crate) fn encodes_srgb(&mut self) -> bool {
        let enabled = self.state.framebuffer_srgb;
        enabled
            && self
                .resolve()
                .surfaces
                .color
                .as_ref()
                .is_some_and(|c| c.format.storage == Storage::Srgb8)
    }

    /// The planes that draws go to at present.
    pub(crate) fn draw_surfaces(&mut self) -> Surfaces {
        self.resolve().surfaces.clone()
    }

    /// The planes that reads of `area` (x, y, width, height) come from, when everything recorded
    /// has run. Records errors: an incomplete framebuffer, or, if `single`, a multisampled one.
    pub(crate) fn read_surfaces(
        &mut self,
        call: &str,
        single: bool,
        area: Option<[i32; 4]>,
    ) -> Option<Surfaces> {
        let surfaces = self.surfaces_of(self.framebuffers.read, false);
        if surfaces.status != FRAMEBUFFER_COMPLETE {
            self.record_error(
                INVALID_FRAMEBUFFER_OPERATION,
                call,
                "the read framebuffer is not complete",
            );
            return None;
        }
        if single && surfaces.samples > 0 {
            self.record_error(INVALID_OPERATION, call, "the read framebuffer is multisampled");
            return None;
        }
        self.flush_recorded();
        if self.framebuffers.read == 0 && surfaces.color.is_some() {
            let ends = |[x, y, width, height]: [i32; 4]| {
                [x, y, x.saturating_add(width), y.saturating_add(height)]
            };
            self.load_default_framebuffer(area.map_or(EVERYWHERE, ends));
            if !self.default_framebuffer.drawn {
                // Nothing waits: the client may draw into its buffer before the next command.
                self.default_framebuffer.loaded.clear();
            }
        }
        Some(surfaces)
    }

    /// `glCheckFramebufferStatus`.
    pub fn check_framebuffer_status(&mut self, target: u32) -> u32 {
        const CALL: &str = "glCheckFramebufferStatus";
        if !self.outside_begin(CALL) {
            return 0;
        }
        let Some(name) = self.framebuffer_of(CALL, target) else { return 0 };
        self.surfaces_of(name, target != READ_FRAMEBUFFER).status
    }
}

fn target_of(surfaces: &Surfaces) -> Option<Target> {
    if surfaces.status != FRAMEBUFFER_COMPLETE {
        return None;
    }
    let depth_scale = |s: &Surface| s.depth.as_ref().map(|depth| lock(depth).scale);
    let target = Target {
        depth_scale: surfaces.depth.as_ref().and_then(depth_scale).unwrap_or(16_777_215.0),
        viewport: surfaces.size?,
        samples: surfaces.samples.max(1),
        color: surfaces.color.as_ref().and_then(|s| s.color.clone()),
        depth: surfaces.depth.as_ref().and_then(|s| s.depth.clone()),
        stencil: surfaces.stencil.as_ref().and_then(|s| s.stencil.clone()),
    };
    (target.color.is_some() || target.depth.is_some() || target.stencil.is_some()).then_some(target)
}
