//! `ReadPixels`: whole rows from the planes to the client.

use super::encode;
use super::format::{Content, PixelFormat};
use super::image::lock;
use super::internal_format::InternalFormat;
use super::store::{MAX_IMAGE_BYTES, Region, write_region};
use super::target::Surfaces;
use super::texels::color_from_word;
use super::transfer::{Transfer, clamp_colors, clamp_unit};
use crate::Context;
use crate::enums::*;
use crate::memory::ClientMemory;
use vitral_exec::Workers;
use vitral_raster::TILE;
use vitral_raster::forward::{ColorPlane, DepthPlane, Plane, StencilPlane};

/// A rectangle of a framebuffer, and where it lies in the rectangle that was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Rectangle {
    /// Window position.
    pub x: u32,
    pub y: u32,
    /// Offset from the corner that was asked for.
    pub skip: [usize; 2],
    /// Size, perhaps 0.
    pub size: [usize; 2],
}

/// The part of a rectangle that is inside a framebuffer.
pub(crate) fn inside(surfaces: &Surfaces, x: i32, y: i32, width: i32, height: i32) -> Rectangle {
    let (w, h) = surfaces.size.map_or((0, 0), |v| (i64::from(v.width), i64::from(v.height)));
    let part = |first: i32, size: i32, limit: i64| {
        let first = i64::from(first);
        let start = first.clamp(0, limit);
        let end = (first + i64::from(size)).clamp(start, limit);
        (start as u32, (start - first).max(0) as usize, (end - start) as usize)
    };
    let (x, skip_x, width) = part(x, width, w);
    let (y, skip_y, height) = part(y, height, h);
    Rectangle { x, y, skip: [skip_x, skip_y], size: [width, height] }
}

/// Colours of a rectangle, as the buffer's format returns them.
pub(crate) fn read_colors(plane: &ColorPlane, format: &InternalFormat, r: &Rectangle) -> Vec<[f32; 4]> {
    let [width, height] = r.size;
    let mut out = vec![[0.0; 4]; width * height];
    let mut words = vec![0; width];
    for (y, row) in out.chunks_exact_mut(width.max(1)).enumerate() {
        match plane {
            ColorPlane::Rgba8(plane) => {
                plane.read_row(r.x, r.y + y as u32, 0, &mut words);
                row.iter_mut().zip(&words).for_each(|(c, &w)| *c = color_from_word(w));
            }
            ColorPlane::RgbaF32(plane) => plane.read_row(r.x, r.y + y as u32, 0, row),
        }
    }
    if format.missing() != [false; 4] {
        out.iter_mut().for_each(|color| *color = format.kept(*color));
    }
    out
}

/// Words of a rectangle of a plane of bytes.
pub(crate) fn read_words(plane: &ColorPlane, format: &InternalFormat, r: &Rectangle) -> Option<Vec<u32>> {
    let ColorPlane::Rgba8(plane) = plane else { return None };
    if !matches!(format.base, RGB | RGBA) {
        return None;
    }
    let mut words = vec![0; r.size[0] * r.size[1]];
    for (y, row) in words.chunks_exact_mut(r.size[0].max(1)).enumerate() {
        plane.read_row(r.x, r.y + y as u32, 0, row);
    }
    if format.base == RGB {
        words.iter_mut().for_each(|w| *w |= 0xff00_0000);
    }
    Some(words)
}

/// Pixels in one piece of work: small pictures are one.
const PIXELS_A_JOB: usize = 1 << 14;

/// Calls `read` with each row's place in the window and its part of `out`.
fn each_row<T: Send>(workers: &Workers, r: &Rectangle, out: &mut [T], read: impl Fn(u32, &mut [T]) + Sync + Send) {
    let length = (out.len() / r.size[1].max(1)).max(1);
    let rows_a_job = (PIXELS_A_JOB / r.size[0].max(1)).max(1);
    workers.for_each_chunk(out, length * rows_a_job, |job, rows| {
        for (y, row) in (r.y + (job * rows_a_job) as u32..).zip(rows.chunks_exact_mut(length)) {
            read(y, row);
        }
    });
}

/// Depths of a rectangle, 0..=1.
pub(crate) fn read_depths(workers: &Workers, plane: &mut DepthPlane, r: &Rectangle) -> Vec<f32> {
    let (mut depths, scale) = (vec![0.0; r.size[0] * r.size[1]], plane.scale);
    let plane = &*plane.resolved();
    each_row(workers, r, &mut depths, |y, row| read_depth_row(plane, scale, [r.x, y], row));
    depths
}

fn read_depth_row(plane: &Plane<f32>, scale: f32, [x, y]: [u32; 2], row: &mut [f32]) {
    plane.read_row(x, y, 0, row);
    if scale != 1.0 {
        row.iter_mut().for_each(|d| *d /= scale);
    }
}

/// Stencil values of a rectangle.
pub(crate) fn read_stencils(plane: &StencilPlane, r: &Rectangle) -> Vec<u8> {
    let mut values = vec![0; r.size[0] * r.size[1]];
    for (y, row) in values.chunks_exact_mut(r.size[0].max(1)).enumerate() {
        plane.read_row(r.x, r.y + y as u32, 0, row);
    }
    values
}

/// Row by row, from a plane of bytes to the client's bytes; none for other planes and formats.
fn encode_words(
    workers: &Workers,
    plane: &ColorPlane,
    stored: &InternalFormat,
    format: PixelFormat,
    r: &Rectangle,
) -> Option<Vec<u8>> {
    let ColorPlane::Rgba8(plane) = plane else { return None };
    if !matches!(stored.base, RGB | RGBA) || !encode::takes_words(format) {
        return None;
    }
    let mut out = vec![0; r.size[0] * r.size[1] * format.pixel_bytes()];
    each_row(workers, r, &mut out, |y, bytes| {
        // Pieces of a row, so that words need no memory of their own.
        let mut words = [0; TILE];
        let pieces = bytes.chunks_mut(TILE * format.pixel_bytes());
        for (x, bytes) in (r.x..).step_by(TILE).zip(pieces) {
            let words = &mut words[..bytes.len() / format.pixel_bytes()];
            plane.read_row(x, y, 0, words);
            if stored.base == RGB {
                words.iter_mut().for_each(|w| *w |= 0xff00_0000);
            }
            encode::words(words, format, bytes);
        }
    });
    Some(out)
}

/// Row by row, from a plane of depths to the client's floating-point numbers.
fn encode_depths(workers: &Workers, plane: &mut DepthPlane, r: &Rectangle) -> Vec<u8> {
    const BYTES: usize = size_of::<f32>();
    let scale = plane.scale;
    let plane = &*plane.resolved();
    let mut out = vec![0; r.size[0] * r.size[1] * BYTES];
    each_row(workers, r, &mut out, |y, bytes| {
        let mut depths = [0.0; TILE];
        for (x, bytes) in (r.x..).step_by(TILE).zip(bytes.chunks_mut(TILE * BYTES)) {
            let depths = &mut depths[..bytes.len() / BYTES];
            read_depth_row(plane, scale, [x, y], depths);
            bytes.copy_from_slice(bytemuck::cast_slice(depths));
        }
    });
    out
}

/// Bytes of the client's format for a rectangle.
fn encode_rectangle(
    workers: &Workers,
    surfaces: &Surfaces,
    format: PixelFormat,
    r: &Rectangle,
    transfer: &Transfer<'_>,
) -> Vec<u8> {
    let mut out = Vec::new();
    let depth_plane = surfaces.depth.as_ref().and_then(|s| s.depth.as_ref());
    let depths = |clamp: bool| {
        let mut depths = depth_plane.map_or_else(Vec::new, |plane| read_depths(workers, &mut lock(plane), r));
        transfer.depths(&mut depths);
        if clamp && !transfer.keeps_depths() {
            depths.iter_mut().for_each(|d| *d = clamp_unit(*d));
        }
        depths
    };
    let stencils = || {
        let plane = surfaces.stencil.as_ref().and_then(|s| s.stencil.as_ref());
        plane.map_or_else(Vec::new, |plane| read_stencils(&lock(plane), r))
    };
    match format.content() {
        Content::Depth if format.kind == FLOAT && transfer.keeps_depths() => {
            return depth_plane.map_or_else(Vec::new, |plane| encode_depths(workers, &mut lock(plane), r));
        }
        Content::Depth => encode::depths(&depths(true), format, &mut out),
        Content::Stencil => {
            let values = stencils().into_iter().map(|v| transfer.stencil(i64::from(v)));
            encode::stencils(values, format.kind, &mut out);
        }
        Content::DepthStencil => {
            let values: Vec<u8> =
                stencils().into_iter().map(|v| (transfer.stencil(i64::from(v)) & 255) as u8).collect();
            encode::depth_stencils(&depths(true), &values, format.kind, &mut out);
        }
        Content::Color | Content::Index => {
            let Some(surface) = &surfaces.color else { return out };
            let Some(plane) = &surface.color else { return out };
            let plane = lock(plane);
            if transfer.keeps_colors()
                && let Some(bytes) = encode_words(workers, &plane, &surface.format, format, r)
            {
                return bytes;
            }
            let mut colors = read_colors(&plane, &surface.format, r);
            transfer.colors(&mut colors);
            if surface.format.component_type() != FLOAT || !matches!(format.kind, FLOAT | HALF_FLOAT_ARB) {
                clamp_colors(&mut colors);
            }
            encode::colors(&colors, format, &mut out);
        }
    }
    out
}

/// Whether a framebuffer has what a pixel of `format` holds.
pub(crate) fn has_content(surfaces: &Surfaces, content: Content) -> bool {
    match content {
        Content::Color => surfaces.color.is_some(),
        // There are no colour index buffers.
        Content::Index => false,
        Content::Depth => surfaces.depth.is_some(),
        Content::Stencil => surfaces.stencil.is_some(),
        Content::DepthStencil => surfaces.depth.is_some() && surfaces.stencil.is_some(),
    }
}

impl Context {
    /// `glReadPixels`.
    pub fn read_pixels(&mut self, x: i32, y: i32, width: i32, height: i32, format: u32, type_: u32, pixels: usize) {
        const CALL: &str = "glReadPixels";
        if !self.outside_begin(CALL) {
            return;
        }
        if width < 0 || height < 0 {
            return self.record_error(INVALID_VALUE, CALL, "a size is negative");
        }
        let format = match PixelFormat::new(format, type_) {
            Ok(format) => format,
            Err((error, why)) => return self.record_error(error, CALL, why),
        };
        let Some(surfaces) = self.read_surfaces(CALL, true) else { return };
        if !has_content(&surfaces, format.content()) {
            return self.record_error(INVALID_OPERATION, CALL, "the read framebuffer has no such buffer");
        }
        let r = inside(&surfaces, x, y, width, height);
        if (pixels == 0 && self.client.pack.buffer.is_none())
            || r.size.contains(&0)
            || r.size[0] * r.size[1] > MAX_IMAGE_BYTES / 4
        {
            return;
        }
        let bytes = encode_rectangle(&self.workers(), &surfaces, format, &r, &Transfer::new(&self.state.pixel));
        let region = Region {
            full: [width as usize, height as usize, 1],
            origin: [r.skip[0], r.skip[1], 0],
            size: [r.size[0], r.size[1], 1],
            volume: false,
        };
        let write = |memory: &dyn ClientMemory, address: usize| {
            write_region(memory, &self.client.pack, format, &region, address, bytes)
        };
        if let Err((error, why)) = self.pack_into(pixels, format.element_bytes(), write) {
            self.record_error(error, CALL, why);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{BASE, context_with, get, put};
    use super::*;

    #[test]
    fn rectangles_are_cut_to_the_framebuffer() {
        let mut c = context_with(4, 3);
        let surfaces = c.draw_surfaces();
        let r = inside(&surfaces, -1, 2, 3, 5);
        assert_eq!(r, Rectangle { x: 0, y: 2, skip: [1, 0], size: [2, 1] });
        assert_eq!(inside(&surfaces, 9, 9, 3, 3).size, [0, 0]);
        assert_eq!(inside(&surfaces, i32::MIN, 0, i32::MAX, 1).size[0], 0);
        // Of a rectangle that ends one pixel inside, that pixel remains.
        assert_eq!(inside(&surfaces, i32::MIN + 2, 0, i32::MAX, 1).size, [1, 1]);
    }

    #[test]
    fn pixels_outside_stay_as_they_were() {
        let mut c = context_with(2, 1);
        assert!(c.draw_target().is_some());
        if let ColorPlane::Rgba8(plane) = &mut *lock(&c.draw_color().unwrap().0) {
            plane.write_row(0, 0, &[0x0403_0201, 0x0807_0605]);
        }
        put(&c, BASE, &[99; 16]);
        c.read_pixels(1, 0, 2, 1, BGR, UNSIGNED_BYTE, BASE);
        assert_eq!(get(&c, BASE), [7, 6, 5, 99, 99, 99, 99]);
        c.read_pixels(0, 0, 1, 1, DEPTH_COMPONENT, FLOAT, BASE);
        assert_eq!(get(&c, BASE), 1.0f32.to_ne_bytes());
        c.read_pixels(0, 0, 1, 1, DEPTH_STENCIL, UNSIGNED_INT_24_8, BASE);
        assert_eq!(get(&c, BASE), 0xffff_ff00u32.to_ne_bytes());
        assert_eq!(c.error, NO_ERROR);
        c.read_pixels(0, 0, 1, 1, COLOR_INDEX, UNSIGNED_BYTE, BASE);
        assert_eq!(c.error, INVALID_OPERATION);
    }

    #[test]
    fn transfer_applies() {
        let mut c = context_with(1, 1);
        c.state.pixel.bias = [0.5, 0.0, 0.0, 2.0];
        c.read_pixels(0, 0, 1, 1, RGBA, UNSIGNED_BYTE, BASE);
        assert_eq!(get(&c, BASE), [128, 0, 0, 255]);
        c.state.stencil.clear = 0;
        c.state.pixel.index = (0, 5);
        c.read_pixels(0, 0, 1, 1, STENCIL_INDEX, UNSIGNED_SHORT, BASE);
        assert_eq!(get(&c, BASE), 5u16.to_ne_bytes());
    }
}
