//! From illuminated points to the pixels of a tile: samples, layers, background, display encoding.
//!
//! At each sample, layers are laid over what is behind from far to near, `I = (1 - kt) I1 + kt I2` with the opacity
//! `1 - kt` of the layer; a pixel is the mean of its samples. Everything is premultiplied and, except in the raw
//! colour space, linear; bytes are encoded at the end.
//! Source: [Porter & Duff 1984] for the operator.

use super::FrameConstants;
use super::points::{NO_POINT, Points, Source, visible_part};
use crate::marks::MarkColors;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, I32x8, LANES, Mask8, Simd};
use vitral_raster::{TILE, Tile};

/// Memory of one tile's composition.
#[derive(Default)]
pub(crate) struct Composer {
    /// Pixels that are not plain background.
    places: Vec<u32>,
    /// Their colours, premultiplied.
    colors: Vec<[f32; 4]>,
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
        let (width, height) = visible_part(tile, constants);
        for y in 0..height {
            out[y * TILE..y * TILE + width].fill(constants.background_bytes[tile.y as usize + y]);
        }
        self.places.clear();
        self.colors.clear();
        self.mix(tile, points, colors, constants, marks);
        encode(simd, &self.places, &mut self.colors, constants.raw, out);
    }

    /// Mixes the samples of every pixel that shows more than the background.
    fn mix(
        &mut self,
        tile: &Tile,
        points: &Points,
        colors: &[[f32; 4]],
        constants: &FrameConstants<'_>,
        marks: &MarkColors,
    ) {
        let samples = constants.view.pattern.len();
        let (mut pixels, mut layers) = (points.pixels.as_slice(), points.layers.as_slice());
        loop {
            // The next pixel in either list.
            let of_layer = layers.first().map_or(u32::MAX, |l| l.sample / samples as u32);
            let of_surface = pixels.first().map_or(u32::MAX, |p| p.index);
            let index = of_layer.min(of_surface);
            if index == u32::MAX {
                return;
            }
            let background = constants.background[tile.y as usize + index as usize / TILE];
            let behind = |point: u32| if point == NO_POINT { background } else { colors[point as usize] };
            let mut source = Source::Point(NO_POINT);
            if of_surface == index {
                source = pixels[0].source;
                pixels = &pixels[1..];
            }
            let point_of = |s: usize| match source {
                Source::Point(point) => point,
                Source::Mixed(start) => points.mixed[start as usize + s],
            };
            let in_front = layers.iter().take_while(|l| l.sample / samples as u32 == index).count();
            let (mine, rest) = layers.split_at(in_front);
            layers = rest;
            let color = match source {
                Source::Point(point) if mine.is_empty() => behind(point),
                _ => {
                    let mut sum = [0.0; 4];
                    for s in 0..samples {
                        let mut color = behind(point_of(s));
                        let sample = index * samples as u32 + s as u32;
                        for layer in mine.iter().filter(|l| l.sample == sample) {
                            let source = layer.source as usize;
                            over(&mut color, if layer.is_mark { marks.color(source) } else { colors[source] });
                        }
                        add(&mut sum, color);
                    }
                    sum.map(|c| c / samples as f32)
                }
            };
            self.places.push(index);
            self.colors.push(color);
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

/// Premultiplied colours to display bytes with straight alpha, put in their places; two pixels a step.
#[inline(always)]
fn encode<S: Simd>(simd: S, places: &[u32], colors: &mut Vec<[f32; 4]>, raw: bool, out: &mut [[u8; 4]]) {
    for color in colors.iter_mut().filter(|c| c[3] < 1.0) {
        let straight = if color[3] > 0.0 { 1.0 / color[3] } else { 0.0 };
        *color = [color[0] * straight, color[1] * straight, color[2] * straight, color[3]];
    }
    if colors.len() % 2 == 1 {
        colors.push([0.0; 4]);
    }
    let alpha = Mask8::from_bitmask(simd, 0b1000_1000);
    for (places, pair) in places.chunks(2).zip(colors.as_flattened().chunks_exact(LANES)) {
        let value = lanes::Lanes::saturate(F32x8::from_slice(simd, pair));
        let curve = if raw { value } else { lanes::Lanes::srgb_from_linear(value) };
        let bytes: I32x8<S> = (alpha.select(value, curve) * 255.0 + 0.5).to_int();
        let bytes = bytes.to_array();
        for (k, &place) in places.iter().enumerate() {
            let at = 4 * k;
            out[place as usize] = [bytes[at] as u8, bytes[at + 1] as u8, bytes[at + 2] as u8, bytes[at + 3] as u8];
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
    fn colors_encode_with_straight_alpha() {
        let mut out = [[9; 4]; 3];
        lanes::dispatch!(lanes::Level::new(), simd => {
            encode(simd, &[0, 1, 2], &mut vec![[0.25, 0.0, 0.5, 0.5], [0.0; 4], [2.0, f32::NAN, 1.0, 1.0]], true, &mut out)
        });
        assert_eq!(out, [[128, 0, 255, 128], [0; 4], [255, 0, 255, 255]]);
    }
}
