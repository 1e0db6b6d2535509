//! Where draws go and reads come from: completeness of framebuffers, and their planes.

use super::framebuffer::{Attached, DEPTH_POINT, FramebufferObject, STENCIL_POINT};
use super::image::{Shared, lock};
use super::internal_format::{InternalFormat, Storage};
use crate::Context;
use crate::enums::*;
use crate::state::MAX_COLOR_ATTACHMENTS;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use vitral_raster::Viewport;
use vitral_raster::forward::{Clamping, ColorPlane, DepthPlane, StencilPlane, Target};

/// The image behind an attachment point.
#[derive(Clone, Debug)]
pub(crate) struct Surface {
    pub format: InternalFormat,
    pub viewport: Viewport,
    /// 0 if not multisampled.
    pub samples: usize,
    pub color: Option<Shared<ColorPlane>>,
    pub depth: Option<Shared<DepthPlane>>,
    pub stencil: Option<Shared<StencilPlane>>,
    /// Counts draws to a texture's colours.
    pub writes: Option<Arc<AtomicU64>>,
}

impl Attached {
    /// The image, with the plane that point `point` needs. `None` if the attachment is not complete.
    pub(crate) fn surface(&self, point: usize) -> Option<Surface> {
        let surface = match self {
            Self::Renderbuffer(renderbuffer) => {
                let storage = lock(renderbuffer).storage.clone()?;
                Surface {
                    format: storage.format,
                    viewport: storage.viewport,
                    samples: storage.samples,
                    color: storage.color,
                    depth: storage.depth,
                    stencil: storage.stencil,
                    writes: None,
                }
            }
            Self::Texture { texture, face, level, layer } => {
                let mut texture = lock(texture);
                let image = texture.image(*face, *level)?;
                let viewport = Viewport::new(image.size[0], image.size[1])?;
                let color = point < MAX_COLOR_ATTACHMENTS;
                let had_planes = image.has_planes();
                let surface = Surface {
                    format: image.format,
                    viewport,
                    samples: 0,
                    color: if color { image.color_plane(*layer) } else { None },
                    depth: if point == DEPTH_POINT { image.depth_plane() } else { None },
                    stencil: if point == STENCIL_POINT { image.stencil_plane() } else { None },
                    writes: color.then(|| image.writes()),
                };
                if !had_planes {
                    // A snapshot made before has texels that are no longer the truth.
                    texture.touch();
                }
                surface
            }
        };
        let fits = match point {
            DEPTH_POINT => surface.depth.is_some(),
            STENCIL_POINT => surface.stencil.is_some(),
            _ => surface.color.is_some(),
        };
        fits.then_some(surface)
    }
}

/// The colour attachment that a buffer token names.
fn color_point(buffer: u32) -> Option<usize> {
    (COLOR_ATTACHMENT0..COLOR_ATTACHMENT0 + MAX_COLOR_ATTACHMENTS as u32)
        .contains(&buffer)
        .then(|| (buffer - COLOR_ATTACHMENT0) as usize)
}

/// All planes of a framebuffer, for drawing or reading.
#[derive(Clone, Debug, Default)]
pub(crate) struct Surfaces {
    pub status: u32,
    pub size: Option<Viewport>,
    /// 0 if not multisampled.
    pub samples: usize,
    pub color: Option<Surface>,
    pub depth: Option<Surface>,
    pub stencil: Option<Surface>,
}

impl FramebufferObject {
    /// The planes with the colour buffer that `buffer` names, and whether they are complete.
    pub(crate) fn surfaces(&self, buffer: u32) -> Surfaces {
        let mut out = Surfaces { status: FRAMEBUFFER_COMPLETE, ..Surfaces::default() };
        let mut found: Vec<(usize, Surface)> = Vec::new();
        for (point, attached) in self.attachments.iter().enumerate() {
            let Some(attached) = attached else { continue };
            match attached.surface(point) {
                Some(surface) => found.push((point, surface)),
                None => out.status = FRAMEBUFFER_INCOMPLETE_ATTACHMENT,
            }
        }
        if out.status != FRAMEBUFFER_COMPLETE {
            return out;
        }
        // ARB_framebuffer_object has drawing and reading of attachments that are not there make a framebuffer incomplete.
        // OpenGL 4.1 dropped the rule, Mesa does not have it, and programs rely on that: here it is for buffers that were
        // named, not for the first, which is the initial value.
        let missing = |buffer: u32| {
            buffer != COLOR_ATTACHMENT0 && color_point(buffer).is_some_and(|p| self.attachments[p].is_none())
        };
        out.status = match found.first().map(|f| f.1.samples) {
            None => FRAMEBUFFER_INCOMPLETE_MISSING_ATTACHMENT,
            _ if missing(self.draw_buffer) => FRAMEBUFFER_INCOMPLETE_DRAW_BUFFER,
            _ if missing(self.read_buffer) => FRAMEBUFFER_INCOMPLETE_READ_BUFFER,
            Some(samples) if found.iter().any(|f| f.1.samples != samples) => FRAMEBUFFER_INCOMPLETE_MULTISAMPLE,
            Some(samples) => {
                // The area that all images have.
                let least = |size: fn(&Viewport) -> u32| found.iter().map(|f| size(&f.1.viewport)).min().unwrap_or(0);
                out.size = Viewport::new(least(|v| v.width), least(|v| v.height));
                out.samples = samples;
                FRAMEBUFFER_COMPLETE
            }
        };
        let mut take = |point| found.iter().position(|f| f.0 == point).map(|i| found.swap_remove(i).1);
        out.color = color_point(buffer).and_then(&mut take);
        out.depth = take(DEPTH_POINT);
        out.stencil = take(STENCIL_POINT);
        out
    }
}

/// What [`Resolved`] depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Key {
    version: u64,
    epoch: u64,
    default_buffer: u32,
    default_version: u64,
}

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
            Some(object) => object.surfaces(if draw { object.draw_buffer } else { object.read_buffer }),
            None => {
                let buffer = if draw { self.state.color_buffer.draw_buffer } else { self.state.pixel_mode.read_buffer };
                self.default_framebuffer.surfaces(buffer)
            }
        }
    }

    /// The planes that draws go to: of the bound framebuffer object or framebuffer 0. `None` if it is incomplete (see
    /// [`Self::draw_framebuffer_complete`]), has no size, or draws nowhere. To be called for each recorded command:
    /// the target counts as drawn to from then on.
    pub(crate) fn draw_target(&mut self) -> Option<Target> {
        let resolved = self.resolve();
        let target = resolved.target.clone();
        let default_color = resolved.default_color;
        if let Some(writes) = resolved.surfaces.color.as_ref().and_then(|c| c.writes.as_ref()) {
            writes.fetch_add(1, Ordering::Relaxed);
        }
        if default_color {
            self.load_default_framebuffer();
            self.default_framebuffer.set_drawn();
        }
        target
    }

    /// To be called when something comes that is drawn later: the client may free its buffer before, or write to it.
    pub(crate) fn will_draw(&mut self) {
        if self.resolve().default_color {
            self.load_default_framebuffer();
        }
    }

    /// Whether the draw framebuffer is complete; records the error if not.
    pub(crate) fn draw_framebuffer_complete(&mut self, call: &str) -> bool {
        let complete = self.resolve().surfaces.status == FRAMEBUFFER_COMPLETE;
        if !complete {
            self.record_error(INVALID_FRAMEBUFFER_OPERATION, call, "the draw framebuffer is not complete");
        }
        complete
    }

    /// Whether an incomplete framebuffer object stands against a call that draws nothing itself; then the error is recorded.
    pub(crate) fn refused_by_framebuffer(&mut self, call: &str) -> bool {
        self.framebuffers.draw != 0 && !self.draw_framebuffer_complete(call)
    }

    /// Which of red, green, blue, alpha the draw buffer does not store: writes to them must be masked.
    pub(crate) fn missing_components(&mut self) -> [bool; 4] {
        self.resolve().surfaces.color.as_ref().map_or([false; 4], |c| c.format.missing())
    }

    /// Where colours are clamped on their way to the draw buffer.
    pub(crate) fn clamping(&mut self) -> Clamping {
        let fragments = self.state.clamp_fragments;
        match self.resolve().surfaces.color.as_ref().map(|c| c.format.component_type()) {
            Some(FLOAT) if fragments => Clamping::Fragments,
            Some(FLOAT) => Clamping::None,
            _ => Clamping::Results,
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
        enabled && self.resolve().surfaces.color.as_ref().is_some_and(|c| c.format.storage == Storage::Srgb8)
    }

    /// The planes that draws go to now.
    pub(crate) fn draw_surfaces(&mut self) -> Surfaces {
        self.resolve().surfaces.clone()
    }

    /// The planes that reads come from, when everything recorded has run. Records errors: an incomplete framebuffer,
    /// or, if `single`, a multisampled one.
    pub(crate) fn read_surfaces(&mut self, call: &str, single: bool) -> Option<Surfaces> {
        let surfaces = self.surfaces_of(self.framebuffers.read, false);
        if surfaces.status != FRAMEBUFFER_COMPLETE {
            self.record_error(INVALID_FRAMEBUFFER_OPERATION, call, "the read framebuffer is not complete");
            return None;
        }
        if single && surfaces.samples > 0 {
            self.record_error(INVALID_OPERATION, call, "the read framebuffer is multisampled");
            return None;
        }
        self.flush_recorded();
        if self.framebuffers.read == 0 && surfaces.color.is_some() {
            self.load_default_framebuffer();
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
