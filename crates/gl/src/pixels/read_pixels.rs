//! `ReadPixels`: whole rows from the planes to the client.

use super::PIXELS_A_JOB;
use super::attachments::Surfaces;
use super::encode;
use super::format::{Content, PixelFormat};
use super::image::lock;
use super::internal_format::InternalFormat;
use super::store::{MAX_IMAGE_BYTES, Region, write_region};
use super::texels::color_from_word;
use super::transfer::{Transfer, clamp_colors, clamp_unit};
use crate::Context;
use crate::enums::*;
use crate::memory::ClientMemory;
use vitral_exec::Workers;
use vitral_raster::TILE;
use vitral_raster::forward::{ColorPlane, DepthBuffer, Plane, StencilPlane};

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
pub(crate) fn read_colors(
    workers: &Workers,
    plane: &ColorPlane,
    format: &InternalFormat,
    r: &Rectangle,
) -> Vec<[f32; 4]> {
    let mut out = vec![[0.0; 4]; r.size[0] * r.size[1]];
    each_row(workers, r, &mut out, |y, row| {
        let pieces = (r.x..).step_by(TILE).zip(row.chunks_mut(TILE));
        pieces.for_each(|(x, piece)| read_color_row(plane, format, [x, y], piece));
    });
    out
}

/// Up to [`TILE`] colours of a row.
fn read_color_row(
    plane: &ColorPlane,
    format: &InternalFormat,
    [x, y]: [u32; 2],
    out: &mut [[f32; 4]],
) {
    match plane {
        ColorPlane::Rgba8(plane) => {
            let words = &mut [0; TILE][..out.len()];
            plane.read_row(x, y, 0, words);
            out.iter_mut().zip(words).for_each(|(c, &mut w)| *c = color_from_word(w));
        }
        ColorPlane::RgbaF32(plane) => plane.read_row(x, y, 0, out),
    }
    if format.missing() != [false; 4] {
        out.iter_mut().for_each(|color| *color = format.kept(*color));
    }
}

/// Words of a rectangle of a plane of bytes.
pub(crate) fn read_words(
    plane: &ColorPlane,
    format: &InternalFormat,
    r: &Rectangle,
) -> Option<Vec<u32>> {
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

/// Calls `read` with each row's place in the window and its part of `out`.
fn each_row<T: Send>(
    workers: &Workers,
    r: &Rectangle,
    out: &mut [T],
    read: impl Fn(u32, &mut [T]) + Sync + Send,
) {
    let length = (out.len() / r.size[1].max(1)).max(1);
    let rows_a_job = (PIXELS_A_JOB / r.size[0].max(1)).max(1);
    workers.for_each_chunk(out, length * rows_a_job, |job, rows| {
        for (y, row) in (r.y + (job * rows_a_job) as u32..).zip(rows.chunks_exact_mut(length)) {
            read(y, row);
        }
    });
}

/// Depths of a rectangle, 0..=1.
pub(crate) fn read_depths(workers: &Workers, plane: &mut DepthBuffer, r: &Rectangle) -> Vec<f32> {
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

/// Calls `encode` with places in the window and their part of the bytes of a rectangle: pieces of
/// rows, so that the values between planes and bytes stay in the cache.
fn encoded(
    workers: &Workers,
    format: PixelFormat,
    r: &Rectangle,
    encode: impl Fn([u32; 2], &mut [u8]) + Sync + Send,
) -> Vec<u8> {
    let pixel = format.pixel_bytes();
    let mut out = vec![0; r.size[0] * r.size[1] * pixel];
    each_row(workers, r, &mut out, |y, bytes| {
        let pieces = bytes.chunks_mut(TILE * pixel);
        (r.x..).step_by(TILE).zip(pieces).for_each(|(x, bytes)| encode([x, y], bytes));
    });
    out
}

/// Colours of a rectangle as the client's bytes.
fn encode_colors(
    workers: &Workers,
    plane: &ColorPlane,
    stored: &InternalFormat,
    format: PixelFormat,
    r: &Rectangle,
    transfer: &Transfer<'_>,
    clamps: bool,
) -> Vec<u8> {
    let pixel = format.pixel_bytes();

    // Encode words directly if neither transfer nor format changes them.
    if let ColorPlane::Rgba8(plane) = plane
        && transfer.keeps_colors()
        && matches!(stored.base, RGB | RGBA)
        && encode::takes_words(format)
    {
        return encoded(workers, format, r, |[x, y], bytes| {
            let words = &mut [0; TILE][..bytes.len() / pixel];
            plane.read_row(x, y, 0, words);
            if stored.base == RGB {
                words.iter_mut().for_each(|w| *w |= 0xff00_0000);
            }
            encode::words(words, format, bytes);
        });
    }

    // Otherwise convert through floats.
    let clamps = clamps
        || stored.component_type() != FLOAT
        || !matches!(format.kind, FLOAT | HALF_FLOAT_ARB);
    encoded(workers, format, r, |[x, y], bytes| {
        let colors = &mut [[0.0; 4]; TILE][..bytes.len() / pixel];
        read_color_row(plane, stored, [x, y], colors);
        transfer.colors(colors);
        if clamps {
            clamp_colors(colors);
        }
        encode::colors(colors, format, bytes);
    })
}

/// Bytes of the client's format for a rectangle.
fn encode_rectangle(
    workers: &Workers,
    surfaces: &Surfaces,
    format: PixelFormat,
    r: &Rectangle,
    transfer: &Transfer<'_>,
    clamps: bool,
) -> Vec<u8> {
    let content = format.content();

    // Encode colours.
    if matches!(content, Content::Color | Content::Index) {
        let Some(surface) = &surfaces.color else { return Vec::new() };
        let Some(plane) = &surface.color else { return Vec::new() };
        return encode_colors(workers, &lock(plane), &surface.format, format, r, transfer, clamps);
    }

    // Lock the planes of depth and stencil.
    let of_depth = surfaces.depth.as_ref().filter(|_| content != Content::Stencil);
    let of_stencil = surfaces.stencil.as_ref().filter(|_| content != Content::Depth);
    let mut depth = of_depth.and_then(|s| s.depth.as_ref()).map(|plane| lock(plane));
    let scale = depth.as_ref().map_or(1.0, |plane| plane.scale);
    let depth = depth.as_mut().map(|plane| &*plane.resolved());
    let stencil = of_stencil.and_then(|s| s.stencil.as_ref()).map(|plane| lock(plane));
    let clamps = !transfer.keeps_depths();

    // Read depths with transfer.
    let depths = |[x, y]: [u32; 2], depths: &mut [f32]| {
        if let Some(plane) = depth {
            read_depth_row(plane, scale, [x, y], depths);
        }
        transfer.depths(depths);
        if clamps {
            depths.iter_mut().for_each(|d| *d = clamp_unit(*d));
        }
    };

    // Read stencil values.
    let stencils = |[x, y]: [u32; 2], values: &mut [u8]| {
        if let Some(plane) = &stencil {
            plane.read_row(x, y, 0, values);
        }
    };

    // Encode what the format asks for.
    encoded(workers, format, r, |place, bytes| {
        let count = bytes.len() / format.pixel_bytes();
        let (numbers, values) = (&mut [0.0; TILE][..count], &mut [0; TILE][..count]);
        let transferred = |v: u8| transfer.stencil(i64::from(v));
        match content {
            Content::Depth => {
                depths(place, numbers);
                encode::depths(numbers, format, bytes);
            }
            Content::Stencil => {
                stencils(place, values);
                encode::stencils(values.iter().map(|&v| transferred(v)), format, bytes);
            }
            _ => {
                depths(place, numbers);
                stencils(place, values);
                values.iter_mut().for_each(|v| *v = (transferred(*v) & 255) as u8);
                encode::depth_stencils(numbers, values, format.kind, bytes);
            }
        }
    })
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
    pub fn read_pixels(
        &mut self,
        x: i32,
        y: i32,
        width: i32,
        height: i32,
        format: u32,
        type_: u32,
        pixels: usize,
    ) {
        const CALL: &str = "glReadPixels";
        if !self.outside_begin(CALL) {
            return;
        }

        // Check the arguments.
        if width < 0 || height < 0 {
            return self.record_error(INVALID_VALUE, CALL, "a size is negative");
        }
        let format = match PixelFormat::new(format, type_) {
            Ok(format) => format,
            Err((error, why)) => return self.record_error(error, CALL, why),
        };

        // Check the framebuffer.
        let Some(surfaces) = self.read_surfaces(CALL, true, Some([x, y, width, height])) else {
            return;
        };
        if !has_content(&surfaces, format.content()) {
            return self.record_error(
                INVALID_OPERATION,
                CALL,
                "the read framebuffer has no such buffer",
            );
        }

        // Read the part inside the framebuffer; what lies outside leaves the client's memory
        // unchanged.
        let r = inside(&surfaces, x, y, width, height);
        if (pixels == 0 && self.client.pack.buffer.is_none())
            || r.size.contains(&0)
            || r.size[0] * r.size[1] > MAX_IMAGE_BYTES / 4
        {
            return;
        }

        // Encode the pixels.
        let clamps = self.state.color_buffer.clamps[2] == TRUE;
        let mut bytes = encode_rectangle(
            &self.workers(),
            &surfaces,
            format,
            &r,
            &Transfer::new(&self.state.pixel),
            clamps,
        );
        let mut skip = r.skip;
        if self.client.pack.invert {
            // MESA_pack_invert: the first row is the highest.
            skip[1] = height as usize - r.size[1] - r.skip[1];
            bytes = bytes
                .chunks_exact(r.size[0] * format.pixel_bytes())
                .rev()
                .flatten()
                .copied()
                .collect();
        }

        // Write them to the client's memory or the bound buffer.
        let region = Region {
            full: [width as usize, height as usize, 1],
            origin: [skip[0], skip[1], 0],
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
        assert!(c.draw_target(None).is_some());
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
