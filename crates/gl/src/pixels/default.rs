//! Framebuffer 0: planes of our own, whose colours are stored in the client's buffer when it may
//! look, and loaded from there before the first draw that does not clear them all, since programs
//! draw into their buffer too.
//!
//! The client's buffer is touched in the calls alone that are documented to do so; it may be gone
//! at any other time.

use super::attachments::{Surface, Surfaces};
use super::client_buffer::{ClientBuffer, LoadedTiles};
use super::encode;
use super::format::PixelFormat;
use super::image::{Shared, lock, new_color_plane};
use super::internal_format::{InternalFormat, Storage};
use super::store::MAX_IMAGE_BYTES;
use crate::Context;
use crate::enums::*;
use std::sync::{Arc, Mutex};
use vitral_raster::Viewport;
use vitral_raster::forward::{ColorPlane, DepthBuffer, Plane, StencilPlane};

/// `OSMESA_BGRA`.
pub const OSMESA_BGRA: u32 = 0x1;
/// `OSMESA_ARGB`.
pub const OSMESA_ARGB: u32 = 0x2;
/// `OSMESA_BGR`.
pub const OSMESA_BGR: u32 = 0x4;
/// `OSMESA_RGB_565`.
pub const OSMESA_RGB_565: u32 = 0x5;

/// The planes of framebuffer 0.
#[derive(Debug, Default)]
pub(crate) struct DefaultFramebuffer {
    format: u32,
    depth_bits: i32,
    stencil_bits: i32,
    accum_bits: i32,
    row_length: usize,
    y_down: bool,
    pub(super) buffer: Option<ClientBuffer>,
    /// What the planes were made for: size, and type of the client's components.
    made_for: Option<(Viewport, u32)>,
    color: Option<Surface>,
    depth: Option<Surface>,
    stencil: Option<Surface>,
    accum: Option<Plane<[f32; 4]>>,
    /// Something was drawn since the planes were stored.
    pub(super) drawn: bool,
    /// Where the colours hold what the client's buffer held.
    pub(super) loaded: LoadedTiles,
    was_current: bool,
    version: u64,
}

fn surface(format: InternalFormat, viewport: Viewport) -> Surface {
    Surface { format, viewport, samples: 0, color: None, depth: None, stencil: None, writes: None }
}

impl DefaultFramebuffer {
    /// Grows when planes change.
    pub(crate) fn version(&self) -> u64 {
        self.version
    }

    /// Notes that draws may have changed colours.
    pub(crate) fn set_drawn(&mut self) {
        self.drawn = true;
    }

    /// Notes that all colours are about to be overwritten.
    pub(crate) fn set_loaded(&mut self) {
        self.loaded.set_all();
    }

    /// `ACCUM_RED_BITS` ...
    pub(crate) fn accum_bits(&self) -> i32 {
        if self.accum_bits > 0 { 16 } else { 0 }
    }

    /// The accumulation plane, if there is one.
    pub(crate) fn accum(&mut self) -> Option<&mut Plane<[f32; 4]>> {
        let (viewport, _) =
            self.made_for.filter(|_| self.accum_bits > 0 && self.buffer.is_some())?;
        Some(self.accum.get_or_insert_with(|| Plane::new(viewport, 1, [0.0; 4])))
    }

    /// The planes, with the colours if `buffer` names them.
    pub(crate) fn surfaces(&self, buffer: u32) -> Surfaces {
        let Some(client) = &self.buffer else {
            return Surfaces { status: FRAMEBUFFER_UNDEFINED, ..Surfaces::default() };
        };
        // There is one buffer, which all names that are taken mean.
        let named = buffer != NONE;
        Surfaces {
            status: FRAMEBUFFER_COMPLETE,
            size: Some(client.viewport),
            samples: 0,
            color: self.color.clone().filter(|_| named),
            depth: self.depth.clone(),
            stencil: self.stencil.clone(),
        }
    }

    /// Notes that nothing is loaded, and that no colours differ from the buffer's where nothing
    /// will be.
    pub(super) fn forget_loaded(&mut self) {
        self.loaded.clear();
        let Some(plane) = self.color_plane() else { return };
        match &mut *lock(&plane) {
            ColorPlane::Rgba8(plane) => {
                plane.tiles.iter_mut().for_each(|tile| _ = tile.take_changed())
            }
            ColorPlane::RgbaF32(plane) => {
                plane.tiles.iter_mut().for_each(|tile| _ = tile.take_changed())
            }
        }
    }

    fn make_planes(&mut self, viewport: Viewport, kind: u32) {
        // Make the colour plane.
        let base =
            if matches!(self.format, RGB | OSMESA_BGR | OSMESA_RGB_565) { RGB } else { RGBA };
        let (token, storage) = match kind {
            UNSIGNED_SHORT => (if base == RGB { RGB16 } else { RGBA16 }, Storage::Unorm16),
            FLOAT => (if base == RGB { RGB32F_ARB } else { RGBA32F_ARB }, Storage::Float),
            UNSIGNED_SHORT_5_6_5 => (RGB565, Storage::Unorm8),
            _ => (if base == RGB { RGB8 } else { RGBA8 }, Storage::Unorm8),
        };
        let mut color = surface(InternalFormat { token, base, storage }, viewport);
        color.color = Some(Arc::new(Mutex::new(new_color_plane(&color.format, viewport, 1))));
        self.color = Some(color);

        // Make depth and stencil planes of the context's sizes.
        self.depth = (self.depth_bits > 0).then(|| {
            let (token, bits) = match self.depth_bits {
                ..=16 => (DEPTH_COMPONENT16, 16),
                17..=24 => (DEPTH_COMPONENT24, 24),
                _ => (DEPTH_COMPONENT32, 32),
            };
            let format =
                InternalFormat { token, base: DEPTH_COMPONENT, storage: Storage::Depth(bits) };
            let scale = format.depth_scale();
            let plane = DepthBuffer::new(Plane::new(viewport, 1, scale), scale);
            Surface { depth: Some(Arc::new(Mutex::new(plane))), ..surface(format, viewport) }
        });
        self.stencil = (self.stencil_bits > 0).then(|| {
            let format = InternalFormat {
                token: STENCIL_INDEX8,
                base: STENCIL_INDEX,
                storage: Storage::Stencil,
            };
            let plane: Shared<StencilPlane> = Arc::new(Mutex::new(Plane::new(viewport, 1, 0)));
            Surface { stencil: Some(plane), ..surface(format, viewport) }
        });

        // Drop the accumulation buffer and note what the planes are made for.
        self.accum = None;
        self.made_for = Some((viewport, kind));
        self.version += 1;
    }

    pub(super) fn color_plane(&self) -> Option<Shared<ColorPlane>> {
        self.color.as_ref()?.color.clone()
    }
}

/// A copy of framebuffer 0's depths.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DepthCopy {
    /// Pixels in a row.
    pub width: u32,
    /// Rows, lowest first.
    pub height: u32,
    /// 2 or 4; with 24 bits, values lie in the lower bits of 4 bytes.
    pub bytes_per_value: usize,
    /// Unsigned integers in native order.
    pub bytes: Vec<u8>,
}

/// Size and buffer of framebuffer 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BufferInfo {
    /// Pixels in a row; 0 without a buffer.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `OSMESA_FORMAT`.
    pub format: u32,
    /// `OSMESA_TYPE`.
    pub kind: u32,
    /// `OSMESA_ROW_LENGTH`.
    pub row_length: usize,
    /// `OSMESA_Y_UP`.
    pub y_up: bool,
    /// Where it is; 0 without a buffer.
    pub address: usize,
}

impl Context {
    /// Says once what framebuffer 0 is: `format` is `RGBA`, `RGB` or one of the `OSMESA_` formats;
    /// bits of 0 mean none. `false` if the format is unknown.
    pub fn configure_default_framebuffer(
        &mut self,
        format: u32,
        depth_bits: i32,
        stencil_bits: i32,
        accum_bits: i32,
    ) -> bool {
        let known =
            matches!(format, RGBA | RGB | OSMESA_BGRA | OSMESA_ARGB | OSMESA_BGR | OSMESA_RGB_565);
        if known {
            let version = self.default_framebuffer.version + 1;
            let new = DefaultFramebuffer {
                format,
                depth_bits,
                stencil_bits,
                accum_bits,
                version,
                ..Default::default()
            };
            self.default_framebuffer = new;
        }
        known
    }

    /// Draws to the client's buffer at `buffer` from now on. `kind` is `UNSIGNED_BYTE`,
    /// `UNSIGNED_SHORT`, `UNSIGNED_SHORT_5_6_5` or `FLOAT`. `false` if the format does not go with
    /// it or a size is out of range. With the buffer it has already nothing happens.
    pub fn make_current(&mut self, buffer: usize, kind: u32, width: i32, height: i32) -> bool {
        let Some(viewport) = Viewport::new(width.max(0) as u32, height.max(0) as u32) else {
            return false;
        };

        // Check that the type fits the context's format.
        let fits = match kind {
            UNSIGNED_SHORT_5_6_5 => self.default_framebuffer.format == OSMESA_RGB_565,
            UNSIGNED_BYTE | UNSIGNED_SHORT | FLOAT => {
                self.default_framebuffer.format != OSMESA_RGB_565
            }
            _ => false,
        };
        if !fits
            || buffer == 0
            || viewport.width as usize * viewport.height as usize * 4 > MAX_IMAGE_BYTES
        {
            return false;
        }

        // Keep everything if the buffer stays the same.
        let fb = &self.default_framebuffer;
        let (format, row_length, y_up) = (fb.format, fb.row_length, !fb.y_down);
        let new = ClientBuffer { address: buffer, kind, format, viewport, row_length, y_up };
        if fb.buffer == Some(new) {
            return true;
        }
        // The buffer before may be gone: what was drawn to it since the last store is not stored,
        // and nothing is loaded.
        self.default_framebuffer.loaded.set_all();
        self.flush_recorded();

        // Take the buffer over, with planes of its size.
        let fb = &mut self.default_framebuffer;
        fb.drawn = false;
        fb.buffer = Some(new);
        fb.version += 1;
        if fb.made_for != Some((viewport, kind)) {
            fb.make_planes(viewport, kind);
        }
        fb.forget_loaded();

        // Set viewport and scissor when the context is first made current.
        if !fb.was_current {
            fb.was_current = true;
            self.state.viewport.rect = [0, 0, width, height];
            self.state.scissor.rect = [0, 0, width, height];
        }
        true
    }

    /// Lets go of the client's buffer, after storing what was drawn. Call it before another context
    /// becomes current.
    pub fn release(&mut self) {
        self.store_unasked();
        // Contexts with the same objects must see what was drawn to them.
        self.flush_recorded();
        let fb = &mut self.default_framebuffer;
        fb.buffer = None;
        fb.version += 1;
    }

    /// `OSMESA_ROW_LENGTH`: pixels from row to row of the client's buffer, 0 for its width.
    pub fn set_buffer_row_length(&mut self, row_length: usize) {
        self.store_default_framebuffer();
        let fb = &mut self.default_framebuffer;
        fb.row_length = row_length;
        fb.forget_loaded();
        if let Some(buffer) = &mut fb.buffer {
            buffer.row_length = row_length;
        }
    }

    /// `OSMESA_Y_UP`: whether the first row of the client's buffer is the lowest.
    pub fn set_buffer_y_up(&mut self, y_up: bool) {
        self.store_default_framebuffer();
        let fb = &mut self.default_framebuffer;
        fb.y_down = !y_up;
        fb.forget_loaded();
        if let Some(buffer) = &mut fb.buffer {
            buffer.y_up = y_up;
        }
    }

    /// The current properties of framebuffer 0.
    pub fn buffer_info(&self) -> BufferInfo {
        let fb = &self.default_framebuffer;
        let info = BufferInfo {
            format: fb.format,
            row_length: fb.row_length,
            y_up: !fb.y_down,
            kind: UNSIGNED_BYTE,
            ..BufferInfo::default()
        };
        fb.buffer.map_or(info, |b| BufferInfo {
            width: b.viewport.width,
            height: b.viewport.height,
            kind: b.kind,
            address: b.address,
            ..info
        })
    }

    /// The depths of framebuffer 0, if it has some.
    pub fn default_depths(&mut self) -> Option<DepthCopy> {
        self.default_framebuffer.buffer?;

        // Find the depth plane.
        self.flush_recorded();
        let surface = self.default_framebuffer.depth.as_ref()?;
        let bits = surface.format.bits().depth;
        let mut plane = lock(surface.depth.as_ref()?);
        let Viewport { width, height } = surface.viewport;
        let bytes_per_value = if bits == 16 { 2 } else { 4 };
        let mut row = vec![0.0; width as usize];
        let mut bytes = Vec::with_capacity(row.len() * height as usize * bytes_per_value);

        // Convert row by row to the integers that the client expects.
        for y in 0..height {
            plane.resolved().read_row(0, y, 0, &mut row);
            match bits {
                16 => row.iter().for_each(|&d| bytes.extend((d as u16).to_ne_bytes())),
                24 => row.iter().for_each(|&d| bytes.extend((d as u32).to_ne_bytes())),
                _ => {
                    let format = PixelFormat { format: DEPTH_COMPONENT, kind: UNSIGNED_INT };
                    let first = bytes.len();
                    bytes.resize(first + 4 * row.len(), 0);
                    encode::depths(&row, format, &mut bytes[first..]);
                }
            }
        }
        Some(DepthCopy { width, height, bytes_per_value, bytes })
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{BASE, context, get, put};
    use super::super::texels::color_from_word;
    use super::*;

    fn fill(c: &mut Context, x: u32, y: u32, word: u32) {
        assert!(c.draw_target(None).is_some());
        let plane = c.default_framebuffer.color_plane().unwrap();
        match &mut *lock(&plane) {
            ColorPlane::Rgba8(plane) => plane.set(x, y, 0, word),
            ColorPlane::RgbaF32(plane) => plane.set(x, y, 0, color_from_word(word)),
        }
    }

    #[test]
    fn the_clients_pixels_are_loaded_and_stored() {
        let mut c = context();
        assert!(c.configure_default_framebuffer(OSMESA_ARGB, 24, 8, 0));
        put(&c, BASE, &[9, 8, 7, 6, 5, 4, 3, 2]);
        assert!(c.make_current(BASE, UNSIGNED_BYTE, 1, 2));
        assert_eq!(c.state.viewport.rect, [0, 0, 1, 2]);
        fill(&mut c, 0, 1, 0x4433_2211);
        c.store_default_framebuffer();
        assert_eq!(get(&c, BASE), [9, 8, 7, 6, 0x44, 0x11, 0x22, 0x33]);
        // Upside down, after the client has drawn there.
        c.set_buffer_y_up(false);
        put(&c, BASE, &[1, 2, 3, 4]);
        fill(&mut c, 0, 0, 0);
        c.store_default_framebuffer();
        assert_eq!(get(&c, BASE), [1, 2, 3, 4, 0, 0, 0, 0]);
    }

    #[test]
    fn the_buffer_is_left_alone_without_draws() {
        let mut c = context();
        c.configure_default_framebuffer(RGBA, 0, 0, 0);
        assert!(c.make_current(8, FLOAT, 4096, 4096));
        assert!(c.make_current(8, FLOAT, 4096, 4096));
        c.release();
        assert_eq!(c.check_framebuffer_status(FRAMEBUFFER), FRAMEBUFFER_UNDEFINED);
    }

    #[test]
    fn the_back_buffer_is_the_only_one() {
        for name in [BACK, BACK_LEFT, FRONT_AND_BACK, FRONT] {
            let mut c = context();
            assert!(c.configure_default_framebuffer(RGBA, 0, 0, 0));
            assert!(c.make_current(BASE, UNSIGNED_BYTE, 1, 1));
            c.draw_buffer(name);
            c.read_buffer(if name == FRONT_AND_BACK { BACK } else { name });
            c.clear_color(1.0, 0.0, 1.0, 1.0);
            c.clear(COLOR_BUFFER_BIT);
            c.read_pixels(0, 0, 1, 1, RGBA, UNSIGNED_BYTE, BASE + 512);
            c.finish();
            assert_eq!(
                (get::<4>(&c, BASE + 512), get::<4>(&c, BASE)),
                ([255, 0, 255, 255], [255, 0, 255, 255])
            );
            assert_eq!(c.get_error(), NO_ERROR);
        }
    }

    #[test]
    fn reading_back_does_not_store() {
        let mut c = context();
        assert!(c.configure_default_framebuffer(RGBA, 0, 0, 0));
        put(&c, BASE, &[1, 2, 3, 4]);
        assert!(c.make_current(BASE, UNSIGNED_BYTE, 1, 1));
        c.clear_color(1.0, 1.0, 1.0, 1.0);
        c.clear(COLOR_BUFFER_BIT);
        c.read_pixels(0, 0, 1, 1, RGBA, UNSIGNED_BYTE, BASE + 512);
        assert_eq!((get::<4>(&c, BASE + 512), get::<4>(&c, BASE)), ([255; 4], [1, 2, 3, 4]));
        c.finish();
        assert_eq!(get::<4>(&c, BASE), [255; 4]);
    }

    #[test]
    fn formats_have_their_types() {
        let mut c = context();
        assert!(!c.configure_default_framebuffer(COLOR_INDEX, 0, 0, 0));
        c.configure_default_framebuffer(OSMESA_RGB_565, 0, 0, 0);
        assert!(!c.make_current(BASE, UNSIGNED_BYTE, 2, 2));
        assert!(c.make_current(BASE, UNSIGNED_SHORT_5_6_5, 2, 2));
        fill(&mut c, 0, 0, 0xff00_00ff);
        c.store_default_framebuffer();
        assert_eq!(get(&c, BASE), 0xf800u16.to_ne_bytes());
        assert_eq!(c.framebuffer_bits().color, [5, 6, 5, 0]);
        c.configure_default_framebuffer(OSMESA_BGR, 0, 0, 0);
        assert!(c.make_current(BASE, UNSIGNED_SHORT, 1, 1));
        fill(&mut c, 0, 0, 0xff00_00ff);
        c.store_default_framebuffer();
        assert_eq!(get(&c, BASE), [0, 0, 0, 0, 255, 255]);
    }
}
