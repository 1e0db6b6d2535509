//! The polygon stipple, on its way through the pixel store.

use crate::state::PixelStore;
use crate::{ClientMemory, Context};
use std::sync::Arc;

/// Where row `row` of a 32x32 bitmap at `address` begins: the address of its first byte that
/// matters, and the bit in it.
fn row_start(store: &PixelStore, address: usize, row: usize) -> Option<(usize, usize)> {
    let whole = |value: i32| usize::try_from(value).unwrap_or(0);
    let length = if store.row_length > 0 { whole(store.row_length) } else { 32 };
    let alignment = whole(store.alignment).max(1);
    let stride = length.div_ceil(8).div_ceil(alignment).checked_mul(alignment)?;
    let skipped = whole(store.skip_rows).checked_add(row)?.checked_mul(stride)?;
    let pixels = whole(store.skip_pixels);
    Some((address.checked_add(skipped)?.checked_add(pixels / 8)?, pixels % 8))
}

/// How many bytes hold 32 bits from bit `first` on.
fn row_bytes(first: usize) -> usize {
    (first + 32).div_ceil(8)
}

/// Where bit `at` of a row is: byte and mask.
fn locate(at: usize, lsb_first: bool) -> (usize, u8) {
    (at / 8, if lsb_first { 1 << (at % 8) } else { 0x80 >> (at % 8) })
}

/// Reads the 32x32 bits at `address`.
fn read_stipple(
    store: &PixelStore,
    memory: &dyn ClientMemory,
    address: usize,
) -> Option<[u32; 32]> {
    let mut pattern = [0; 32];
    for (row, bits) in pattern.iter_mut().enumerate() {
        let (start, first) = row_start(store, address, row)?;
        let mut bytes = [0; 5];
        if address == 0 || !memory.read(start, &mut bytes[..row_bytes(first)]) {
            return None;
        }
        for x in 0..32 {
            let (byte, mask) = locate(first + x, store.lsb_first);
            *bits = *bits << 1 | u32::from(bytes[byte] & mask != 0);
        }
    }
    Some(pattern)
}

impl Context {
    /// `glPolygonStipple`.
    pub fn polygon_stipple(&mut self, mask: usize) {
        const CALL: &str = "glPolygonStipple";
        let pattern = match self.unpack_memory(mask, 1) {
            Err((error, why)) => return self.record_error(error, CALL, why),
            Ok((memory, at)) => read_stipple(&self.client.unpack, &*memory, at),
        };
        let Some(pattern) = pattern else {
            return match self.client.unpack.buffer.name {
                0 => self.refuse_value(CALL, "the pattern is not in readable memory"),
                _ => self.refuse_operation(CALL, "the pattern does not lie in the buffer"),
            };
        };
        let pattern = Arc::new(pattern);
        self.listable(move |c| {
            if c.may_set(CALL) {
                c.state.polygons.stipple_pattern = pattern.clone();
            }
        });
    }

    /// `glGetPolygonStipple`.
    pub fn get_polygon_stipple(&mut self, mask: usize) {
        const CALL: &str = "glGetPolygonStipple";
        if !self.may_set(CALL) {
            return;
        }
        let mut there = false;
        let written = self.pack_into(mask, 1, |memory, address| {
            there = self.write_stipple(memory, address).is_some();
            there
        });
        match written {
            Err((error, why)) => self.record_error(error, CALL, why),
            Ok(()) if !there => self.refuse_value(CALL, "the result has no writable memory"),
            Ok(()) => {}
        }
    }

    /// Bits beside the pattern stay as they are.
    fn write_stipple(&self, memory: &dyn ClientMemory, address: usize) -> Option<()> {
        let store = &self.client.pack;
        for (row, bits) in self.state.polygons.stipple_pattern.iter().enumerate() {
            let (start, first) = row_start(store, address, row)?;
            let mut bytes = [0; 5];
            let bytes = &mut bytes[..row_bytes(first)];
            if address == 0 || !memory.read(start, bytes) {
                return None;
            }
            for x in 0..32 {
                let (byte, mask) = locate(first + x, store.lsb_first);
                if bits >> (31 - x) & 1 == 1 {
                    bytes[byte] |= mask;
                } else {
                    bytes[byte] &= !mask;
                }
            }
            if !memory.write(start, bytes) {
                return None;
            }
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use crate::api::testing::{BASE, RESULT, context, put, take};
    use crate::enums as gl;

    #[test]
    fn the_leftmost_pixel_is_the_highest_bit() {
        let mut c = context();
        let mut bytes = [0_u8; 128];
        bytes[0] = 0x80;
        bytes[5] = 0x01;
        let at = put(&c, &bytes);
        c.polygon_stipple(at);
        assert_eq!(c.state.polygons.stipple_pattern[0], 0x8000_0000);
        assert_eq!(c.state.polygons.stipple_pattern[1], 0x0001_0000);
        c.get_polygon_stipple(RESULT);
        assert_eq!(take::<u8, 128>(&c), bytes);
        c.pixel_storei(gl::UNPACK_LSB_FIRST, 1);
        c.polygon_stipple(at);
        assert_eq!(c.state.polygons.stipple_pattern[0], 0x0100_0000);
    }

    #[test]
    fn skipped_rows_and_pixels() {
        let mut c = context();
        c.pixel_storei(gl::UNPACK_ROW_LENGTH, 48);
        c.pixel_storei(gl::UNPACK_SKIP_ROWS, 2);
        c.pixel_storei(gl::UNPACK_SKIP_PIXELS, 9);
        c.pixel_storei(gl::UNPACK_ALIGNMENT, 8);
        // Rows are 8 bytes apart; pixel 9 is bit 1 of byte 1.
        let mut bytes = [0_u8; 300];
        bytes[17] = 0x40;
        put(&c, &bytes);
        c.polygon_stipple(BASE);
        assert_eq!(c.state.polygons.stipple_pattern[0], 0x8000_0000);
        c.pixel_storei(gl::PACK_SKIP_PIXELS, 1);
        assert!(c.memory.write(RESULT, &[0xFF; 160]));
        c.get_polygon_stipple(RESULT);
        // Rows are 4 bytes apart, so the last pixel of a row is the first bit of the next.
        let written = take::<u8, 4>(&c);
        assert_eq!(written, [0b1100_0000, 0, 0, 0]);
        c.polygon_stipple(usize::MAX - 3);
        assert_eq!(c.get_error(), gl::INVALID_VALUE);
    }

    #[test]
    fn a_buffer_holds_the_whole_pattern_or_none() {
        let mut c = context();
        c.bind_buffer(gl::PIXEL_UNPACK_BUFFER, 1);
        c.buffer_data(gl::PIXEL_UNPACK_BUFFER, 129, 0, gl::STREAM_DRAW);
        c.polygon_stipple(2);
        assert_eq!(c.get_error(), gl::INVALID_OPERATION);
        c.polygon_stipple(1);
        assert_eq!(c.get_error(), gl::NO_ERROR);
        assert_eq!(*c.state.polygons.stipple_pattern, [0; 32]);
        c.map_buffer(gl::PIXEL_UNPACK_BUFFER, gl::READ_ONLY);
        c.polygon_stipple(0);
        assert_eq!(c.get_error(), gl::INVALID_OPERATION);
    }
}
