//! Pixel transfer: what happens to pixels between the client and the framebuffer or a texture.

use crate::enums::*;
use crate::state::PixelTransfer;

/// Entry of a map of colours for a component: the nearest of its entries spread over 0..=1.
fn look_up(values: &[f32], component: f32) -> f32 {
    let last = values.len() - 1;
    values[((component.clamp(0.0, 1.0) * last as f32 + 0.5) as usize).min(last)]
}

/// Entry of a map of indices: the index is masked (map sizes are powers of two).
fn look_up_index(values: &[f32], index: i64) -> f32 {
    values[index.rem_euclid(values.len() as i64) as usize]
}

/// A pixel transfer state, prepared.
pub(crate) struct Transfer<'a> {
    state: &'a PixelTransfer,
    /// No scale and bias of colours.
    plain: bool,
}

impl<'a> Transfer<'a> {
    /// The transfer operations of a state.
    pub(crate) fn new(state: &'a PixelTransfer) -> Self {
        Self { state, plain: state.scale == [1.0; 4] && state.bias == [0.0; 4] }
    }

    fn map(&self, token: u32) -> &[f32] {
        &self.state.maps[(token - PIXEL_MAP_I_TO_I) as usize].values
    }

    /// Whether colours stay as they are.
    pub(crate) fn keeps_colors(&self) -> bool {
        self.plain && !self.state.map_color
    }

    /// Whether depths stay as they are, apart from clamping.
    pub(crate) fn keeps_depths(&self) -> bool {
        self.state.depth == (1.0, 0.0)
    }

    /// Scales, biases and maps colours.
    pub(crate) fn colors(&self, colors: &mut [[f32; 4]]) {
        if !self.plain {
            for color in colors.iter_mut() {
                for c in 0..4 {
                    color[c] = color[c] * self.state.scale[c] + self.state.bias[c];
                }
            }
        }
        if self.state.map_color {
            let maps = [PIXEL_MAP_R_TO_R, PIXEL_MAP_G_TO_G, PIXEL_MAP_B_TO_B, PIXEL_MAP_A_TO_A]
                .map(|m| self.map(m));
            for color in colors {
                for c in 0..4 {
                    color[c] = look_up(maps[c], color[c]);
                }
            }
        }
    }

    /// `INDEX_SHIFT` and `INDEX_OFFSET`.
    pub(crate) fn index(&self, index: i64) -> i64 {
        let (shift, offset) = self.state.index;
        let shifted = match shift {
            0.. => index.checked_shl(shift as u32).filter(|_| shift < 40).unwrap_or(0),
            _ => index >> shift.unsigned_abs().min(63),
        };
        shifted.wrapping_add(i64::from(offset))
    }

    /// The colour of a colour index.
    pub(crate) fn color_of_index(&self, index: i64) -> [f32; 4] {
        let index = self.index(index);
        [PIXEL_MAP_I_TO_R, PIXEL_MAP_I_TO_G, PIXEL_MAP_I_TO_B, PIXEL_MAP_I_TO_A]
            .map(|m| look_up_index(self.map(m), index))
    }

    /// The stencil value of a stencil index, not masked to the buffer's bits.
    pub(crate) fn stencil(&self, index: i64) -> i64 {
        let index = self.index(index);
        if !self.state.map_stencil {
            return index;
        }
        (look_up_index(self.map(PIXEL_MAP_S_TO_S), index) + 0.5) as i64
    }

    /// Scales and biases depths.
    pub(crate) fn depths(&self, depths: &mut [f32]) {
        let (scale, bias) = self.state.depth;
        if !self.keeps_depths() {
            for depth in depths {
                *depth = *depth * scale + bias;
            }
        }
    }
}

/// Clamps all components to 0..=1; NaN becomes 0.
pub(crate) fn clamp_colors(colors: &mut [[f32; 4]]) {
    for color in colors {
        for component in color {
            *component = clamp_unit(*component);
        }
    }
}

/// `value` in 0..=1, NaN as 0.
#[inline]
#[allow(clippy::manual_clamp)]
pub(crate) fn clamp_unit(value: f32) -> f32 {
    // Unlike `clamp`, `max` takes the number when one side is NaN.
    value.max(0.0).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::PixelMap;
    use std::sync::Arc;

    #[test]
    fn scale_bias_then_map() {
        let mut state = PixelTransfer {
            scale: [2.0, 1.0, 1.0, 1.0],
            map_color: true,
            ..PixelTransfer::default()
        };
        state.bias[3] = -0.5;
        let map = PixelMap { values: Arc::new(vec![1.0, 0.5, 0.25]) };
        state.maps[(PIXEL_MAP_R_TO_R - PIXEL_MAP_I_TO_I) as usize] = map;
        let mut colors = [[0.25, 1.0, 0.0, 1.0]];
        Transfer::new(&state).colors(&mut colors);
        // 0.25 * 2 = 0.5: the middle of the red map. The other maps have their initial single 0.
        assert_eq!(colors, [[0.5, 0.0, 0.0, 0.0]]);
    }

    #[test]
    fn indices_shift_offset_and_wrap_in_the_map() {
        let mut state = PixelTransfer { index: (2, 1), ..PixelTransfer::default() };
        assert_eq!(Transfer::new(&state).index(3), 13);
        state.index = (-1, 0);
        assert_eq!(Transfer::new(&state).index(5), 2);
        state.index = (i32::MIN, i32::MAX);
        assert_eq!(Transfer::new(&state).index(5), i64::from(i32::MAX));
        state.index = (0, 0);
        state.map_stencil = true;
        state.maps[1].values = Arc::new(vec![7.0, 9.0]);
        assert_eq!(Transfer::new(&state).stencil(3), 9);
    }
}
