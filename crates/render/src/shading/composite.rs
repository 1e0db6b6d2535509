//! From illuminated points to the pixels of a tile: samples, layers, background, display encoding.
//!
//! At each sample, layers are laid over what is behind from far to near, `I = (1 - kt) I1 + kt I2` with the opacity
//! `1 - kt` of the layer; a pixel is the mean of its samples. Everything is premultiplied and, except in the raw
//! colour space, linear; bytes are encoded at the end.
//! Source: [Porter & Duff 1984] for the operator.

use super::FrameConstants;
use super::points::{NO_POINT, Points, visible_part};
use crate::marks::MarkColors;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, LANES, Simd};
use vitral_raster::{TILE, Tile};

/// Memory of one tile's composition.
#[derive(Default)]
pub(crate) struct Composer {
    /// Premultiplied, for each pixel.
    pixels: Vec<[f32; 4]>,
}

impl Composer {
    #[inline(always)]
    pub(crate) fn compose<S: Simd>(
        &mut self,
        simd: S,
        tile: &Tile,
        points: &Points,
        colors: &[[f32; 4]],
        constants: &FrameConstants<'_>,
        marks: &MarkColors,
        out: &mut [[u8; 4]],
    ) {
        let samples = constants.view.pattern.len();
        let (width, height) = visible_part(tile, constants);
        let mut layers = points.layers.as_slice();
        for y in 0..height {
            let row = tile.y as usize + y;
            let background = constants.background[row];
            self.pixels.clear();
            let mut plain = true;
            for x in 0..width {
                let pixel = y * TILE + x;
                let sources = &points.of_sample[pixel * samples..(pixel + 1) * samples];
                let behind = |source: u32| if source == NO_POINT { background } else { colors[source as usize] };
                let end = ((pixel + 1) * samples) as u32;
                let in_front = layers.iter().take_while(|l| l.sample < end).count();
                let color = if in_front > 0 {
                    let mine = &layers[..in_front];
                    layers = &layers[in_front..];
                    let mut sum = [0.0; 4];
                    for (s, &source) in sources.iter().enumerate() {
                        let mut color = behind(source);
                        let sample = (pixel * samples + s) as u32;
                        for layer in mine.iter().filter(|l| l.sample == sample) {
                            let source = layer.source as usize;
                            over(&mut color, if layer.is_mark { marks.color(source) } else { colors[source] });
                        }
                        add(&mut sum, color);
                    }
                    sum.map(|c| c / samples as f32)
                } else if sources.iter().all(|&s| s == sources[0]) {
                    behind(sources[0])
                } else {
                    let mut sum = [0.0; 4];
                    sources.iter().for_each(|&s| add(&mut sum, behind(s)));
                    sum.map(|c| c / samples as f32)
                };
                plain &= in_front == 0 && sources.iter().all(|&s| s == NO_POINT);
                self.pixels.push(color);
            }
            let out = &mut out[y * TILE..y * TILE + width];
            if plain {
                out.fill(constants.background_bytes[row]);
            } else {
                encode_row(simd, &self.pixels, constants.raw, out);
            }
        }
    }
}

fn add(sum: &mut [f32; 4], color: [f32; 4]) {
    for k in 0..4 {
        sum[k] += color[k];
    }
}

/// Lays a premultiplied colour over another.
fn over(below: &mut [f32; 4], above: [f32; 4]) {
    for k in 0..4 {
        below[k] = above[k] + (1.0 - above[3]) * below[k];
    }
}

/// Premultiplied colours to display bytes with straight alpha.
#[inline(always)]
fn encode_row<S: Simd>(simd: S, pixels: &[[f32; 4]], raw: bool, out: &mut [[u8; 4]]) {
    for (pixels, out) in pixels.chunks(LANES).zip(out.chunks_mut(LANES)) {
        let mut soa = [[0.0f32; LANES]; 4];
        for (lane, p) in pixels.iter().enumerate() {
            for k in 0..4 {
                soa[k][lane] = p[k];
            }
        }
        let [r, g, b, a] = [0, 1, 2, 3].map(|k| F32x8::from_slice(simd, &soa[k]));
        let zero = F32x8::from_slice(simd, &[0.0; LANES]);
        let one = zero + 1.0;
        let visible = lanes::Lanes::lt(zero, a);
        let straight = lanes::Lanes::select(visible, one / a, zero);
        let byte = |c: F32x8<S>, curve: bool| {
            let c = lanes::Lanes::saturate(c);
            let c = if curve { lanes::Lanes::srgb_from_linear(c) } else { c };
            let bytes: lanes::I32x8<S> = (c * 255.0 + 0.5).to_int();
            bytes.to_array()
        };
        let bytes = [byte(r * straight, !raw), byte(g * straight, !raw), byte(b * straight, !raw), byte(a, false)];
        for (lane, o) in out.iter_mut().enumerate() {
            *o = [0, 1, 2, 3].map(|k| bytes[k][lane] as u8);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn t6_linear_transparency_mixes_exactly() {
        // I = (1 - kt) I1 + kt I2 with I1 = 0.8 in front, I2 = 0.4 behind, premultiplied.
        for (kt, expected) in [(0.0, 0.8), (1.0, 0.4), (0.25, 0.75 * 0.8 + 0.25 * 0.4)] {
            let opacity = 1.0 - kt;
            let mut below = [0.4, 0.4, 0.4, 1.0];
            over(&mut below, [0.8 * opacity, 0.8 * opacity, 0.8 * opacity, opacity]);
            assert!((below[0] - expected).abs() < 1e-6 && below[3] == 1.0);
        }
    }

    #[test]
    fn rows_encode_with_straight_alpha() {
        let mut out = [[9; 4]; 3];
        lanes::dispatch!(lanes::Level::new(), simd => {
            encode_row(simd, &[[0.25, 0.0, 0.5, 0.5], [0.0; 4], [2.0, f32::NAN, 1.0, 1.0]], true, &mut out)
        });
        assert_eq!(out, [[128, 0, 255, 128], [0; 4], [255, 0, 255, 255]]);
    }
}
