//! Where a scene is drawn: a context, its buffer, and the numbers that the scene notes.

use crate::gl::{Gl, OsmesaContext, at_mut};
use vitral_gl::enums::*;

/// What a context draws to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    /// `OSMESA_RGBA` ...
    pub(crate) format: u32,
    /// `UNSIGNED_BYTE` ...
    pub(crate) kind: u32,
    /// Pixels.
    pub(crate) size: [i32; 2],
    /// `OSMESA_ROW_LENGTH`, 0 is the width.
    pub(crate) row_length: i32,
    /// `OSMESA_Y_UP`.
    pub(crate) y_up: bool,
}

/// The usual one: 64 x 64, RGBA, 8 bits.
pub(crate) const USUAL: Surface =
    Surface { format: RGBA, kind: UNSIGNED_BYTE, size: [64, 64], row_length: 0, y_up: true };

/// What came out.
pub(crate) struct Outcome {
    /// Pixels.
    pub(crate) width: u32,
    /// Pixels.
    pub(crate) height: u32,
    /// Lowest row first.
    pub(crate) rgba: Vec<u8>,
    /// Lowest row first.
    pub(crate) depth: Vec<f32>,
    /// What the scene noted, and the error at the end.
    pub(crate) numbers: Vec<f32>,
}

/// A context that is current, with its buffer.
pub(crate) struct Stage<'a> {
    gl: &'a Gl,
    context: OsmesaContext,
    /// Space for the widest pixels (four floats), and a row more than needed.
    buffer: Vec<u32>,
    surface: Surface,
    numbers: Vec<f32>,
}

impl std::ops::Deref for Stage<'_> {
    type Target = Gl;

    fn deref(&self) -> &Gl {
        self.gl
    }
}

const OSMESA_ROW_LENGTH: i32 = 0x10;
const OSMESA_Y_UP: i32 = 0x11;

impl<'a> Stage<'a> {
    /// A fresh context with 24 bits of depth, 8 of stencil, 16 of accumulation.
    pub(crate) fn new(gl: &'a Gl, surface: Surface) -> Result<Self, String> {
        let [width, height] = surface.size;
        let row = width.max(surface.row_length) as usize;
        let mut buffer = vec![0_u32; 4 * row * (height as usize + 1)];
        let context = gl.OSMesaCreateContextExt(surface.format, 24, 8, 16, 0);
        if context == 0 {
            return Err("no context".to_owned());
        }
        if gl.OSMesaMakeCurrent(context, at_mut(&mut buffer), surface.kind, width, height) == 0 {
            return Err("the context cannot be made current".to_owned());
        }
        gl.OSMesaPixelStore(OSMESA_ROW_LENGTH, surface.row_length);
        gl.OSMesaPixelStore(OSMESA_Y_UP, i32::from(surface.y_up));
        gl.glClear(COLOR_BUFFER_BIT | DEPTH_BUFFER_BIT | STENCIL_BUFFER_BIT | ACCUM_BUFFER_BIT);
        Ok(Self { gl, context, buffer, surface, numbers: Vec::new() })
    }

    /// Notes a number: libraries must agree on it.
    pub(crate) fn note(&mut self, number: impl Into<f64>) {
        self.numbers.push(number.into() as f32);
    }

    /// Notes several numbers.
    pub(crate) fn notes(&mut self, numbers: &[f32]) {
        self.numbers.extend_from_slice(numbers);
    }

    /// Notes a state variable of `N` numbers.
    pub(crate) fn note_floats<const N: usize>(&mut self, name: u32) {
        let mut values = [0.0_f32; N];
        self.gl.glGetFloatv(name, &mut values);
        self.notes(&values);
    }

    /// The context's address.
    pub(crate) fn context(&self) -> OsmesaContext {
        self.context
    }

    /// Makes this stage's context current again.
    pub(crate) fn back(&mut self) {
        let [width, height] = self.surface.size;
        self.gl.OSMesaMakeCurrent(
            self.context,
            at_mut(&mut self.buffer),
            self.surface.kind,
            width,
            height,
        );
    }

    /// Ends the scene.
    pub(crate) fn finish(mut self) -> Outcome {
        let [width, height] = self.surface.size;
        let gl = self.gl;
        gl.glFinish();
        let error = gl.glGetError();
        self.note(error);

        // The buffer as it is, made RGBA where it has another form.
        let raw: Vec<u8> = self.buffer.iter().flat_map(|word| word.to_le_bytes()).collect();
        let rgba = self.rgba(&raw);

        // Depth as glReadPixels sees it in its initial state.
        gl.glPushClientAttrib(CLIENT_PIXEL_STORE_BIT);
        gl.glPushAttrib(PIXEL_MODE_BIT);
        gl.glBindFramebuffer(FRAMEBUFFER, 0);
        for (name, value) in [
            (PACK_ALIGNMENT, 4),
            (PACK_ROW_LENGTH, 0),
            (PACK_SKIP_ROWS, 0),
            (PACK_SKIP_PIXELS, 0),
            (PACK_SWAP_BYTES, 0),
        ] {
            gl.glPixelStorei(name, value);
        }
        gl.glPixelTransferf(DEPTH_SCALE, 1.0);
        gl.glPixelTransferf(DEPTH_BIAS, 0.0);
        let mut depth = vec![0.0_f32; (width * height) as usize];
        gl.glReadPixels(0, 0, width, height, DEPTH_COMPONENT, FLOAT, at_mut(&mut depth));
        gl.glPopAttrib();
        gl.glPopClientAttrib();

        gl.OSMesaMakeCurrent(0, 0, 0, 0, 0);
        gl.OSMesaDestroyContext(self.context);
        Outcome { width: width as u32, height: height as u32, rgba, depth, numbers: self.numbers }
    }

    /// The picture part of the buffer as RGBA bytes in the order of the buffer's rows. Pixels that
    /// are not four bytes are given as RGBA with 8 bits.
    fn rgba(&self, raw: &[u8]) -> Vec<u8> {
        let [width, height] = self.surface.size.map(|side| side as usize);
        let row =
            if self.surface.row_length > 0 { self.surface.row_length as usize } else { width };
        let bytes = match self.surface.kind {
            UNSIGNED_BYTE if self.surface.format == RGB || self.surface.format == 4 => 3,
            UNSIGNED_BYTE => 4,
            UNSIGNED_SHORT_5_6_5 => 2,
            UNSIGNED_SHORT => 8,
            _ => 16,
        };
        let mut out = Vec::with_capacity(4 * width * height);
        for y in 0..height {
            for x in 0..width {
                let pixel = &raw[(y * row + x) * bytes..][..bytes];
                let short = |at: usize| u16::from_le_bytes([pixel[2 * at], pixel[2 * at + 1]]);
                let float =
                    |at: usize| f32::from_le_bytes(std::array::from_fn(|i| pixel[4 * at + i]));
                match self.surface.kind {
                    UNSIGNED_BYTE if bytes == 3 => {
                        out.extend_from_slice(&[pixel[0], pixel[1], pixel[2], 255])
                    }
                    UNSIGNED_BYTE => out.extend_from_slice(pixel),
                    UNSIGNED_SHORT_5_6_5 => {
                        let v = short(0);
                        out.extend([v >> 8 & 0xf8, v >> 3 & 0xfc, v << 3 & 0xf8].map(|c| c as u8));
                        out.push(255);
                    }
                    UNSIGNED_SHORT => out.extend((0..4).map(|i| (short(i) >> 8) as u8)),
                    _ => {
                        out.extend((0..4).map(|i| (float(i).clamp(0.0, 1.0) * 255.0).round() as u8))
                    }
                }
            }
        }
        out
    }
}
