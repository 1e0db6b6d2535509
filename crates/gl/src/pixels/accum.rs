//! The accumulation buffer. It belongs to framebuffer 0 and is touched by these calls alone, at
//! once.

use super::image::lock;
use super::texels::{color_from_word, word_from_color};
use crate::Context;
use crate::enums::*;
use vitral_raster::forward::{ColorPlane, Plane};

/// Copies colours of a row.
fn read_colors(plane: &ColorPlane, x: u32, y: u32, out: &mut [[f32; 4]]) {
    match plane {
        ColorPlane::Rgba8(plane) => {
            let mut words = vec![0; out.len()];
            plane.read_row(x, y, 0, &mut words);
            out.iter_mut().zip(words).for_each(|(c, w)| *c = color_from_word(w));
        }
        ColorPlane::RgbaF32(plane) => plane.read_row(x, y, 0, out),
    }
}

fn write_colors(plane: &mut ColorPlane, x: u32, y: u32, colors: &[[f32; 4]]) {
    match plane {
        ColorPlane::Rgba8(plane) => {
            let words: Vec<u32> = colors.iter().map(|&c| word_from_color(c)).collect();
            plane.write_row(x, y, &words);
        }
        ColorPlane::RgbaF32(plane) => plane.write_row(x, y, colors),
    }
}

/// Runs `f` on the rows of a rectangle of the accumulation plane.
fn for_rows(plane: &mut Plane<[f32; 4]>, clip: [i32; 4], mut f: impl FnMut(u32, &mut [[f32; 4]])) {
    let [x0, y0, x1, y1] = clip.map(|v| v as u32);
    let mut row = vec![[0.0; 4]; (x1 - x0) as usize];
    for y in y0..y1 {
        plane.read_row(x0, y, 0, &mut row);
        f(y, &mut row);
        plane.write_row(x0, y, &row);
    }
}

impl Context {
    /// Clears a part of the accumulation buffer.
    pub(crate) fn clear_accum_plane(&mut self, clip: [i32; 4]) {
        let value = self.state.color_buffer.accum_clear;
        let Some(plane) = self.default_framebuffer.accum() else { return };
        let viewport = plane.viewport();
        if clip == [0, 0, viewport.width as i32, viewport.height as i32] {
            plane.clear(value);
        } else if clip[0] < clip[2] {
            for_rows(plane, clip, |_, row| row.fill(value));
        }
    }

    /// `glAccum`.
    pub fn accum(&mut self, op: u32, value: f32) {
        self.listable(move |c| c.exec_accum(op, value));
    }

    fn exec_accum(&mut self, op: u32, value: f32) {
        const CALL: &str = "glAccum";
        if !self.outside_begin(CALL) {
            return;
        }

        // Check the operation and the buffer.
        if !matches!(op, ACCUM | LOAD | ADD | MULT | RETURN) {
            return self.record_error(INVALID_ENUM, CALL, "op is not an accumulation operation");
        }
        if self.framebuffers.draw != 0 || self.default_framebuffer.accum_bits() == 0 {
            return self.record_error(INVALID_OPERATION, CALL, "there is no accumulation buffer");
        }
        if !self.draw_framebuffer_complete(CALL) || !self.renders() {
            return;
        }

        // Limit the operation to the scissor rectangle.
        let Some(viewport) = self.draw_surfaces().size else { return };
        let clip = self.scissored(viewport);
        if clip[0] >= clip[2] || clip[1] >= clip[3] {
            return;
        }

        // Run the operation.
        match op {
            ACCUM | LOAD => self.accumulate(value, op == LOAD, clip),
            RETURN => self.return_accum(value, clip),
            _ => {
                let Some(plane) = self.default_framebuffer.accum() else { return };
                let change = |v: f32| if op == ADD { v + value } else { v * value };
                for_rows(plane, clip, |_, row| row.iter_mut().for_each(|c| *c = c.map(change)));
            }
        }
    }

    /// `ACCUM` and `LOAD`: from the read buffer.
    fn accumulate(&mut self, value: f32, load: bool, clip: [i32; 4]) {
        let Some(surfaces) = self.read_surfaces("glAccum", true, None) else { return };
        let source = surfaces.color.and_then(|s| s.color).filter(|_| self.framebuffers.read == 0);
        let (Some(source), Some(plane)) = (source, self.default_framebuffer.accum()) else {
            return;
        };
        let source = lock(&source);
        let mut colors = vec![[0.0; 4]; (clip[2] - clip[0]) as usize];
        for_rows(plane, clip, |y, row| {
            read_colors(&source, clip[0] as u32, y, &mut colors);
            for (accum, color) in row.iter_mut().zip(&colors) {
                for c in 0..4 {
                    accum[c] = if load { 0.0 } else { accum[c] } + color[c] * value;
                }
            }
        });
    }

    /// `RETURN`: to the draw buffer, through the colour mask.
    fn return_accum(&mut self, value: f32, clip: [i32; 4]) {
        // Counts as a draw.
        if self.draw_target(None).is_none() {
            return;
        }
        self.flush_recorded();
        let written = self.state.color_buffer.mask;
        let Some((target, missing)) = self.draw_color() else { return };
        let Some(plane) = self.default_framebuffer.accum() else { return };
        let mut target = lock(&target);
        let [x0, y0, x1, y1] = clip.map(|v| v as u32);
        let mut sums = vec![[0.0; 4]; (x1 - x0) as usize];
        let mut colors = sums.clone();
        for y in y0..y1 {
            plane.read_row(x0, y, 0, &mut sums);
            read_colors(&target, x0, y, &mut colors);
            for (color, sum) in colors.iter_mut().zip(&sums) {
                for c in (0..4).filter(|&c| written[c] && !missing[c]) {
                    color[c] = (sum[c] * value).clamp(0.0, 1.0);
                }
            }
            write_colors(&mut target, x0, y, &colors);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{context, context_with};
    use super::*;

    fn pixel(c: &mut Context) -> u32 {
        let (plane, _) = c.draw_color().unwrap();
        let ColorPlane::Rgba8(plane) = &*lock(&plane) else { panic!() };
        plane.get(1, 1, 0)
    }

    #[test]
    fn two_half_frames_make_one() {
        let mut c = context_with(4, 4);
        assert!(c.draw_target(None).is_some());
        if let ColorPlane::Rgba8(plane) = &mut *lock(&c.draw_color().unwrap().0) {
            plane.set(1, 1, 0, u32::from_le_bytes([255, 100, 0, 255]));
        }
        c.accum(LOAD, 0.5);
        c.accum(ACCUM, 0.25);
        c.accum(ADD, 0.25);
        c.state.color_buffer.mask[3] = false;
        c.accum(RETURN, 1.0);
        assert_eq!(c.error, NO_ERROR);
        assert_eq!(pixel(&mut c).to_le_bytes(), [255, 139, 64, 255]);
        c.state.scissor.enabled = true;
        c.state.scissor.rect = [0, 0, 1, 1];
        c.accum(MULT, 0.0);
        c.accum(RETURN, 0.0);
        assert_eq!(pixel(&mut c).to_le_bytes(), [255, 139, 64, 255]);
    }

    #[test]
    fn without_a_buffer_it_is_an_error() {
        let mut c = context();
        c.accum(LOAD, 1.0);
        assert_eq!(c.error, INVALID_OPERATION);
        let mut c = context_with(4, 4);
        c.accum(0x1234, 1.0);
        assert_eq!(c.error, INVALID_ENUM);
    }
}
