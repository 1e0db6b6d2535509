//! Framebuffer objects: their attachments, the planes behind that, and whether they are
//! complete.

use super::image::{Shared, lock};
use super::internal_format::InternalFormat;
use super::renderbuffer::RenderbufferHandle;
use super::texture::TextureHandle;
use crate::enums::*;
use crate::state::MAX_COLOR_ATTACHMENTS;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;
use vitral_raster::Viewport;
use vitral_raster::forward::{ColorPlane, DepthBuffer, StencilPlane};

/// Index of the depth attachment; colours come first.
pub(crate) const DEPTH_POINT: usize = MAX_COLOR_ATTACHMENTS;
/// Index of the stencil attachment.
pub(crate) const STENCIL_POINT: usize = MAX_COLOR_ATTACHMENTS + 1;

/// The image attached to an attachment point.
#[derive(Clone, Debug)]
pub(crate) enum Attached {
    Renderbuffer(RenderbufferHandle),
    Texture { texture: TextureHandle, face: usize, level: usize, layer: usize },
}

impl Attached {
    /// Whether both are the same image.
    pub(crate) fn same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Renderbuffer(a), Self::Renderbuffer(b)) => Arc::ptr_eq(a, b),
            (
                Self::Texture { texture, face, level, layer },
                Self::Texture { texture: t, face: f, level: l, layer: y },
            ) => Arc::ptr_eq(texture, t) && (face, level, layer) == (f, l, y),
            _ => false,
        }
    }
}

/// A framebuffer object: images at attachment points.
#[derive(Clone, Debug)]
pub(crate) struct FramebufferObject {
    /// Colours, depth, stencil.
    pub attachments: [Option<Attached>; MAX_COLOR_ATTACHMENTS + 2],
    /// `COLOR_ATTACHMENTn` or `NONE`.
    pub draw_buffer: u32,
    /// `COLOR_ATTACHMENTn` or `NONE`.
    pub read_buffer: u32,
}

impl Default for FramebufferObject {
    fn default() -> Self {
        Self {
            attachments: std::array::from_fn(|_| None),
            draw_buffer: COLOR_ATTACHMENT0,
            read_buffer: COLOR_ATTACHMENT0,
        }
    }
}

/// The image behind an attachment point.
#[derive(Clone, Debug)]
pub(crate) struct Surface {
    pub format: InternalFormat,
    pub viewport: Viewport,
    /// 0 if not multisampled.
    pub samples: usize,
    pub color: Option<Shared<ColorPlane>>,
    pub depth: Option<Shared<DepthBuffer>>,
    pub stencil: Option<Shared<StencilPlane>>,
    /// Counts draws to a texture's colours.
    pub writes: Option<Arc<AtomicU64>>,
}

impl Attached {
    /// The image, with the plane that point `point` needs. `None` if the attachment is not
    /// complete.
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
                    // The plane holds the image from here on: earlier snapshots have stale texels.
                    texture.touch();
                }
                surface
            }
        };

        // The image fits the point if it has the plane for it.
        let fits = match point {
            DEPTH_POINT => surface.depth.is_some(),
            STENCIL_POINT => surface.stencil.is_some(),
            _ => surface.color.is_some(),
        };
        fits.then_some(surface)
    }
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

/// The colour attachment that a buffer token names.
fn color_point(buffer: u32) -> Option<usize> {
    (COLOR_ATTACHMENT0..COLOR_ATTACHMENT0 + MAX_COLOR_ATTACHMENTS as u32)
        .contains(&buffer)
        .then(|| (buffer - COLOR_ATTACHMENT0) as usize)
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
        // ARB_framebuffer_object has drawing and reading of attachments that are not there make a
        // framebuffer incomplete. OpenGL 4.1 dropped the rule, Mesa does not have it, and programs
        // rely on that: here it is for buffers that were named, not for the first, which is the
        // initial value.
        let missing = |buffer: u32| {
            buffer != COLOR_ATTACHMENT0
                && color_point(buffer).is_some_and(|p| self.attachments[p].is_none())
        };
        out.status = match found.first().map(|f| f.1.samples) {
            None => FRAMEBUFFER_INCOMPLETE_MISSING_ATTACHMENT,
            _ if missing(self.draw_buffer) => FRAMEBUFFER_INCOMPLETE_DRAW_BUFFER,
            _ if missing(self.read_buffer) => FRAMEBUFFER_INCOMPLETE_READ_BUFFER,
            Some(samples) if found.iter().any(|f| f.1.samples != samples) => {
                FRAMEBUFFER_INCOMPLETE_MULTISAMPLE
            }
            Some(samples) => {
                // The area that all images have.
                let least = |size: fn(&Viewport) -> u32| {
                    found.iter().map(|f| size(&f.1.viewport)).min().unwrap_or(0)
                };
                out.size = Viewport::new(least(|v| v.width), least(|v| v.height));
                out.samples = samples;
                FRAMEBUFFER_COMPLETE
            }
        };
        let mut take =
            |point| found.iter().position(|f| f.0 == point).map(|i| found.swap_remove(i).1);
        out.color = color_point(buffer).and_then(&mut take);
        out.depth = take(DEPTH_POINT);
        out.stencil = take(STENCIL_POINT);
        out
    }
}
