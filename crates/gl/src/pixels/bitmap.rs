//! `Bitmap`: pixels of one colour at the raster position, which then moves on. Bits are taken from
//! the client when the call is made, so that a display list of glyphs has them ready.

use super::format::PixelFormat;
use super::store::drawable;
use crate::Context;
use crate::enums::*;
use std::sync::Arc;
use vitral_raster::forward::{Command, ImageFragments};

/// Raster positions that transformation puts this little below a whole pixel mean that pixel.
const SLACK: f32 = 1e-4;

/// The arguments, with the bits.
#[derive(Debug)]
struct Glyph {
    size: [i32; 2],
    origin: [f32; 2],
    step: [f32; 2],
    bits: Option<Vec<bool>>,
}

impl Context {
    /// `glBitmap`.
    pub fn bitmap(
        &mut self,
        width: i32,
        height: i32,
        xorig: f32,
        yorig: f32,
        xmove: f32,
        ymove: f32,
        bitmap: usize,
    ) {
        let format = PixelFormat { format: COLOR_INDEX, kind: BITMAP };
        let image = drawable([width, height])
            .map_or(Ok(None), |size| self.read_image(format, size, false, bitmap));
        let image = match image {
            Ok(image) => image,
            Err((error, why)) => return self.record_error(error, "glBitmap", why),
        };
        let bits = image
            .filter(|i| !i.bytes.is_empty())
            .map(|i| i.bytes.iter().map(|&b| b != 0).collect());
        let glyph =
            Glyph { size: [width, height], origin: [xorig, yorig], step: [xmove, ymove], bits };
        let glyph = Arc::new(glyph);
        self.listable(move |c| c.exec_bitmap(&glyph));
    }

    fn exec_bitmap(&mut self, glyph: &Glyph) {
        const CALL: &str = "glBitmap";
        if !self.outside_begin(CALL) {
            return;
        }

        // Check the size and the raster position.
        if glyph.size.iter().any(|&s| s < 0) {
            return self.record_error(INVALID_VALUE, CALL, "a size is negative");
        }
        if drawable(glyph.size).is_none() {
            return self.record_error(OUT_OF_MEMORY, CALL, "the bitmap is too large");
        }
        if !self.draw_framebuffer_complete(CALL) || !self.state.raster_position.valid {
            return;
        }

        // Record the bits as fragments of the raster colour.
        if self.raster_draws(BITMAP_TOKEN)
            && let Some(bits) = &glyph.bits
            && bits.contains(&true)
        {
            let raster = self.state.raster_position.window;
            let corner = std::array::from_fn(|i| (raster[i] - glyph.origin[i] + SLACK).floor());
            let fragments = self.raster_fragments(corner, [1.0; 2], glyph.size.map(|s| s as usize));
            let image = ImageFragments { bits: Some(bits.clone()), ..fragments };
            let state = self.fragment_state(true);
            self.record(Command::Image(Arc::new(image), state));
        }

        // Move the raster position.
        for i in 0..2 {
            self.state.raster_position.window[i] += glyph.step[i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{BASE, context_with};
    use super::*;

    #[test]
    fn the_raster_position_moves_on() {
        let mut c = context_with(8, 8);
        c.bitmap(8, 1, 0.0, 0.0, 2.5, -1.0, BASE);
        c.bitmap(0, 0, 0.0, 0.0, 1.0, 0.0, 0);
        assert_eq!(c.state.raster_position.window[..2], [3.5, -1.0]);
        c.state.raster_position.valid = false;
        c.bitmap(0, 0, 0.0, 0.0, 1.0, 0.0, 0);
        assert_eq!(c.state.raster_position.window[0], 3.5);
        c.bitmap(-1, 0, 0.0, 0.0, 1.0, 0.0, 0);
        assert_eq!(c.error, INVALID_VALUE);
    }
}
