//! `BlitFramebuffer`.

use super::Failure;
use super::attachments::Surfaces;
use super::copy_plane::{
    Axis, Job, average_colors, average_words, converted, copy, first_sample, kept, resolved,
    scale_linear, scale_nearest,
};
use super::image::{Shared, lock};
use super::texels::{color_from_word, word_from_color};
use crate::Context;
use crate::enums::*;
use std::sync::Arc;
use vitral_exec::Workers;
use vitral_raster::Viewport;
use vitral_raster::forward::{ColorPlane, Plane, Resolve};

/// The arguments.
#[derive(Clone, Copy, Debug)]
struct Blit {
    /// x0, y0, x1, y1.
    from: [i32; 4],
    to: [i32; 4],
    mask: u32,
    filter: u32,
}

/// The pixels to copy, and their places.
struct Plan {
    /// Without scaling.
    job: Option<Job>,
    x: Axis,
    y: Axis,
    linear: bool,
    workers: Workers,
}

impl Blit {
    fn check(&self, read: &Surfaces, draw: &Surfaces) -> Result<(), Failure> {
        let size = |r: [i32; 4]| {
            [i64::from(r[2]) - i64::from(r[0]), i64::from(r[3]) - i64::from(r[1])].map(i64::abs)
        };
        if (read.samples > 0 || draw.samples > 0) && size(self.from) != size(self.to) {
            return Err((INVALID_OPERATION, "multisampled rectangles must have the same size"));
        }
        // Stencil values are alike, but where depths lie with them on both sides these count as
        // part of the format.
        for (bit, from, to) in [
            (DEPTH_BUFFER_BIT, &read.depth, &draw.depth),
            (STENCIL_BUFFER_BIT, &read.stencil, &draw.stencil),
        ] {
            if let (Some(from), Some(to)) = (from, to)
                && self.mask & bit != 0
                && from.format.has_depth()
                && to.format.has_depth()
                && from.format.storage != to.format.storage
            {
                return Err((INVALID_OPERATION, "the depth or stencil formats differ"));
            }
        }
        Ok(())
    }

    /// Whether the source or the destination has no pixels: then nothing is copied.
    fn is_empty(&self) -> bool {
        [self.from, self.to].iter().any(|r| r[0] == r[2] || r[1] == r[3])
    }

    /// The plan for a source and a destination; `clip` is the part of the destination that may
    /// change.
    fn plan(&self, from: Viewport, clip: [i32; 4], workers: Workers) -> Plan {
        // Find the extents of both rectangles.
        let axis = |i: usize, size| {
            Axis::new(
                [self.from[i], self.from[i + 2]],
                [self.to[i], self.to[i + 2]],
                [clip[i], clip[i + 2]],
                size,
            )
        };
        let extent = |r: [i32; 4], i: usize| i64::from(r[i + 2]) - i64::from(r[i]);
        let same = (0..2).all(|i| extent(self.from, i) == extent(self.to, i));

        // Copy without scaling if the extents agree, both mirrored included: clip the destination
        // to both surfaces.
        let corner = |r: [i32; 4], i: usize| i64::from(r[i].min(r[i + 2]));
        let job = same.then(|| {
            let limit = [from.width, from.height].map(i64::from);
            let mut rect = [0u32; 4];
            let mut shift = [0i32; 2];
            for i in 0..2 {
                let (source, target, length) =
                    (corner(self.from, i), corner(self.to, i), extent(self.to, i).abs());
                let by = source - target;
                let low = target.max(i64::from(clip[i])).max(-by).max(0);
                let high =
                    (target + length).min(i64::from(clip[i + 2])).min(limit[i] - by).max(low);
                rect[i] = low.min(i64::from(u32::MAX)) as u32;
                rect[i + 2] = high.min(i64::from(u32::MAX)) as u32;
                shift[i] = by.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32;
            }
            Job { clip: rect, shift }
        });
        Plan {
            job,
            x: axis(0, from.width),
            y: axis(1, from.height),
            linear: self.filter == LINEAR,
            workers,
        }
    }
}

/// Locks two planes, of which the first is copied if they are one. Two threads may copy between the
/// same two in opposite directions: both lock them in the order of their addresses.
fn with_both<T: Clone>(from: &Shared<T>, into: &Shared<T>, f: impl FnOnce(&T, &mut T)) {
    if Arc::ptr_eq(from, into) {
        let copy = lock(from).clone();
        f(&copy, &mut lock(into));
    } else if Arc::as_ptr(from) < Arc::as_ptr(into) {
        let from = lock(from);
        f(&from, &mut lock(into));
    } else {
        let mut into = lock(into);
        f(&lock(from), &mut into);
    }
}

impl Plan {
    fn plain<T: Copy + Send + Sync>(&self, from: &Plane<T>, into: &mut Plane<T>) {
        match self.job {
            Some(job) => copy(&self.workers, from, into, job, first_sample),
            None => scale_nearest(from, into, &self.x, &self.y),
        }
    }

    fn colors(&self, from: &ColorPlane, into: &mut ColorPlane) {
        match (from, into) {
            (ColorPlane::Rgba8(from), ColorPlane::Rgba8(into)) => {
                self.values(from, into, average_words, color_from_word, word_from_color);
            }
            (ColorPlane::RgbaF32(from), ColorPlane::RgbaF32(into)) => {
                self.values(from, into, average_colors, |c| c, |c| c);
            }
            (from, into) => {
                let bytes = matches!(into, ColorPlane::Rgba8(_));
                self.colors(&converted(from, bytes), into);
            }
        }
    }

    fn values<T: Copy + Send + Sync>(
        &self,
        from: &Plane<T>,
        into: &mut Plane<T>,
        resolve: Resolve<T>,
        color: impl Fn(T) -> [f32; 4],
        value: impl Fn([f32; 4]) -> T,
    ) {
        match self.job {
            Some(job) => copy(&self.workers, from, into, job, resolve),
            // A flipped resolve.
            None if from.samples() > 1 => {
                self.values(&resolved(&self.workers, from, resolve), into, resolve, color, value);
            }
            None if self.linear => scale_linear(from, into, &self.x, &self.y, color, value),
            None => scale_nearest(from, into, &self.x, &self.y),
        }
    }
}

impl Context {
    /// `glBlitFramebuffer`.
    pub fn blit_framebuffer(
        &mut self,
        src_x0: i32,
        src_y0: i32,
        src_x1: i32,
        src_y1: i32,
        dst_x0: i32,
        dst_y0: i32,
        dst_x1: i32,
        dst_y1: i32,
        mask: u32,
        filter: u32,
    ) {
        let (from, to) = ([src_x0, src_y0, src_x1, src_y1], [dst_x0, dst_y0, dst_x1, dst_y1]);
        let blit = Blit { from, to, mask, filter };
        self.listable(move |c| {
            if c.outside_begin("glBlitFramebuffer")
                && let Err((error, why)) = c.exec_blit(&blit)
            {
                c.record_error(error, "glBlitFramebuffer", why);
            }
        });
    }

    fn exec_blit(&mut self, blit: &Blit) -> Result<(), Failure> {
        const CALL: &str = "glBlitFramebuffer";

        // Check the arguments.
        if blit.mask & !(COLOR_BUFFER_BIT | DEPTH_BUFFER_BIT | STENCIL_BUFFER_BIT) != 0 {
            return Err((INVALID_VALUE, "mask has bits that name no buffer"));
        }
        if !matches!(blit.filter, NEAREST | LINEAR) {
            return Err((INVALID_ENUM, "filter is neither NEAREST nor LINEAR"));
        }
        if blit.filter == LINEAR && blit.mask & (DEPTH_BUFFER_BIT | STENCIL_BUFFER_BIT) != 0 {
            return Err((INVALID_OPERATION, "depth and stencil cannot be interpolated"));
        }

        // Check both framebuffers.
        if !self.draw_framebuffer_complete(CALL) {
            return Ok(());
        }
        let draw = self.draw_surfaces();
        let read = self.surfaces_of(self.framebuffers.read, false);
        if read.status == FRAMEBUFFER_COMPLETE {
            blit.check(&read, &draw)?;
        }
        let Some(read) = self.read_surfaces(CALL, false, None) else { return Ok(()) };
        let (Some(from), Some(to)) = (read.size, draw.size) else { return Ok(()) };

        // Plan the copy, and finish the recorded commands.
        let plan = blit.plan(from, self.scissored(to), self.workers());
        // The copy counts as a draw, and happens at once.
        if blit.mask == 0 || blit.is_empty() || self.draw_target(None).is_none() {
            return Ok(());
        }
        self.flush_recorded();

        // Copy colours, converting them if the formats differ.
        let wants = |bit| blit.mask & bit != 0;
        if let (true, Some(from), Some(to)) = (wants(COLOR_BUFFER_BIT), &read.color, &draw.color)
            && let (Some(a), Some(b)) = (&from.color, &to.color)
        {
            // Of equal formats nothing needs to change.
            let other = to.format.missing() != from.format.missing();
            with_both(a, b, |a, b| {
                if other { plan.colors(&kept(a, &to.format), b) } else { plan.colors(a, b) }
            });
        }

        // Copy depths and stencil values.
        if let (true, Some(from), Some(to)) = (wants(DEPTH_BUFFER_BIT), &read.depth, &draw.depth)
            && let (Some(a), Some(b)) = (&from.depth, &to.depth)
        {
            lock(a).resolved();
            with_both(a, b, |a, b| plan.plain(a.plane(), b.resolved()));
        }
        if let (true, Some(from), Some(to)) =
            (wants(STENCIL_BUFFER_BIT), &read.stencil, &draw.stencil)
            && let (Some(a), Some(b)) = (&from.stencil, &to.stencil)
        {
            with_both(a, b, |a: &Plane<u8>, b| plan.plain(a, b));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{BASE, context_with, read_u32};
    use super::*;

    /// A framebuffer object with renderbuffers of colour and depth; bound to draw and read.
    fn framebuffer(c: &mut Context, samples: i32, width: i32, height: i32) -> u32 {
        c.gen_framebuffers(1, BASE);
        let name = read_u32(c, BASE);
        c.bind_framebuffer(FRAMEBUFFER, name);
        for (format, point) in
            [(RGBA8, COLOR_ATTACHMENT0), (DEPTH32F_STENCIL8, DEPTH_STENCIL_ATTACHMENT)]
        {
            c.gen_renderbuffers(1, BASE);
            let renderbuffer = read_u32(c, BASE);
            c.bind_renderbuffer(RENDERBUFFER, renderbuffer);
            c.renderbuffer_storage_multisample(RENDERBUFFER, samples, format, width, height);
            c.framebuffer_renderbuffer(FRAMEBUFFER, point, RENDERBUFFER, renderbuffer);
        }
        assert_eq!(c.check_framebuffer_status(FRAMEBUFFER), FRAMEBUFFER_COMPLETE);
        name
    }

    fn draw(c: &mut Context, x: u32, y: u32, values: &[u32]) {
        let (plane, _) = c.draw_color().unwrap();
        let ColorPlane::Rgba8(plane) = &mut *lock(&plane) else { panic!() };
        values.iter().enumerate().for_each(|(s, &v)| plane.set(x, y, s, v));
    }

    fn pixel(c: &mut Context, x: i32, y: i32) -> u32 {
        c.read_pixels(x, y, 1, 1, RGBA, UNSIGNED_BYTE, BASE);
        u32::from_le_bytes(read_u32(c, BASE).to_ne_bytes())
    }

    #[test]
    fn samples_are_resolved() {
        let mut c = context_with(4, 4);
        let many = framebuffer(&mut c, 4, 70, 70);
        draw(&mut c, 65, 66, &[4, 8, 12, 16]);
        let one = framebuffer(&mut c, 0, 70, 70);
        c.bind_framebuffer(READ_FRAMEBUFFER, many);
        c.blit_framebuffer(
            0,
            0,
            70,
            70,
            0,
            0,
            70,
            70,
            COLOR_BUFFER_BIT | DEPTH_BUFFER_BIT,
            NEAREST,
        );
        assert_eq!(c.error, NO_ERROR);
        c.blit_framebuffer(0, 0, 70, 70, 0, 0, 35, 35, COLOR_BUFFER_BIT, NEAREST);
        assert_eq!(c.error, INVALID_OPERATION);
        c.error = NO_ERROR;
        c.read_pixels(0, 0, 1, 1, RGBA, UNSIGNED_BYTE, BASE);
        assert_eq!(c.error, INVALID_OPERATION);
        c.error = NO_ERROR;
        c.bind_framebuffer(FRAMEBUFFER, one);
        assert_eq!(pixel(&mut c, 65, 66), 10);
    }

    #[test]
    fn rectangles_scale_flip_and_clip() {
        let mut c = context_with(4, 4);
        let source = framebuffer(&mut c, 0, 2, 2);
        draw(&mut c, 0, 0, &[10]);
        draw(&mut c, 1, 0, &[30]);
        let target = framebuffer(&mut c, 0, 8, 8);
        c.bind_framebuffer(READ_FRAMEBUFFER, source);
        c.blit_framebuffer(0, 0, 2, 2, 8, 0, 4, 4, COLOR_BUFFER_BIT, NEAREST);
        c.blit_framebuffer(0, 0, 2, 1, 0, 6, 4, 7, COLOR_BUFFER_BIT, LINEAR);
        c.blit_framebuffer(1, 0, 5, 1, 0, 7, 4, 8, COLOR_BUFFER_BIT, NEAREST);
        assert_eq!(c.error, NO_ERROR);
        c.bind_framebuffer(FRAMEBUFFER, target);
        assert_eq!([4, 5, 6, 7].map(|x| pixel(&mut c, x, 1)), [30, 30, 10, 10]);
        assert_eq!([0, 1, 2, 3].map(|x| pixel(&mut c, x, 6)), [10, 15, 25, 30]);
        assert_eq!([0, 1].map(|x| pixel(&mut c, x, 7)), [30, 0]);
    }

    #[test]
    fn components_that_are_not_stored_are_not_copied() {
        let mut c = context_with(4, 4);
        let source = framebuffer(&mut c, 0, 2, 2);
        draw(&mut c, 0, 0, &[0x4030_2010]);
        for (format, kept) in
            [(RGB8, 0xff30_2010), (R8, 0xff00_0010), (LUMINANCE8_ALPHA8, 0x4000_0010)]
        {
            framebuffer(&mut c, 0, 2, 2);
            c.gen_renderbuffers(1, BASE);
            let renderbuffer = read_u32(&c, BASE);
            c.bind_renderbuffer(RENDERBUFFER, renderbuffer);
            c.renderbuffer_storage(RENDERBUFFER, format, 2, 2);
            c.framebuffer_renderbuffer(FRAMEBUFFER, COLOR_ATTACHMENT0, RENDERBUFFER, renderbuffer);
            c.bind_framebuffer(READ_FRAMEBUFFER, source);
            c.blit_framebuffer(0, 0, 1, 1, 1, 1, 2, 2, COLOR_BUFFER_BIT, NEAREST);
            let (plane, _) = c.draw_color().unwrap();
            let ColorPlane::Rgba8(plane) = &*lock(&plane) else { panic!() };
            assert_eq!(plane.get(1, 1, 0), kept);
        }
        assert_eq!(c.error, NO_ERROR);
    }

    #[test]
    fn empty_rectangles_copy_nothing() {
        let mut c = context_with(4, 4);
        let source = framebuffer(&mut c, 0, 2, 2);
        draw(&mut c, 0, 0, &[10]);
        let target = framebuffer(&mut c, 0, 4, 4);
        c.bind_framebuffer(READ_FRAMEBUFFER, source);
        for filter in [NEAREST, LINEAR] {
            for [x, y] in [[0, 0], [0, 1], [1, 0]] {
                c.blit_framebuffer(0, 0, x, y, 0, 0, 4, 4, COLOR_BUFFER_BIT, filter);
                c.blit_framebuffer(0, 0, 1, 1, 0, 0, 4 * x, 4 * y, COLOR_BUFFER_BIT, filter);
            }
        }
        assert_eq!(c.error, NO_ERROR);
        c.bind_framebuffer(FRAMEBUFFER, target);
        assert!((0..16).all(|i| pixel(&mut c, i % 4, i / 4) == 0));
    }

    #[test]
    fn one_framebuffer_may_be_both() {
        let mut c = context_with(4, 4);
        framebuffer(&mut c, 0, 4, 4);
        draw(&mut c, 0, 0, &[9]);
        c.blit_framebuffer(0, 0, 1, 1, 2, 2, 3, 3, COLOR_BUFFER_BIT, NEAREST);
        assert_eq!(pixel(&mut c, 2, 2), 9);
        let size = i32::MAX;
        c.blit_framebuffer(
            i32::MIN,
            0,
            size,
            size,
            size,
            0,
            i32::MIN,
            5,
            COLOR_BUFFER_BIT,
            NEAREST,
        );
        assert_eq!(c.error, NO_ERROR);
    }
}
