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
use vitral_math::lanes::{self, F32x8, LANES, Simd};
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
        encode(simd, &self.places, &self.colors, constants.raw, out);
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

/// Premultiplied colours to display bytes with straight alpha, put in their places.
#[inline(always)]
fn encode<S: Simd>(simd: S, places: &[u32], colors: &[[f32; 4]], raw: bool, out: &mut [[u8; 4]]) {
    for (places, pixels) in places.chunks(LANES).zip(colors.chunks(LANES)) {
        let mut soa = [[0.0f32; LANES]; 4];
        for (lane, p) in pixels.iter().enumerate() {
            for k in 0..4 {
                soa[k][lane] = p[k];
            }
        }
        let load = lanes::inlined(
            #[inline(always)]
            |k: usize| F32x8::from_slice(simd, &soa[k]),
        );
        let (r, g, b, a) = (load(0), load(1), load(2), load(3));
        let zero = F32x8::from_slice(simd, &[0.0; LANES]);
        let visible = lanes::Lanes::lt(zero, a);
        let straight = lanes::Lanes::select(visible, (zero + 1.0) / a, zero);
        let curve = !raw;
        let bytes =
            [byte(r * straight, curve), byte(g * straight, curve), byte(b * straight, curve), byte(a, false)];
        for (lane, &place) in places.iter().enumerate() {
            out[place as usize] = [bytes[0][lane] as u8, bytes[1][lane] as u8, bytes[2][lane] as u8, bytes[3][lane] as u8];
        }
    }
}

/// Display bytes of eight values, through the sRGB curve or as they are.
#[inline(always)]
fn byte<S: Simd>(value: F32x8<S>, curve: bool) -> [i32; LANES] {
    let value = lanes::Lanes::saturate(value);
    let value = if curve { lanes::Lanes::srgb_from_linear(value) } else { value };
    let bytes: lanes::I32x8<S> = (value * 255.0 + 0.5).to_int();
    bytes.to_array()
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
            encode(simd, &[0, 1, 2], &[[0.25, 0.0, 0.5, 0.5], [0.0; 4], [2.0, f32::NAN, 1.0, 1.0]], true, &mut out)
        });
        assert_eq!(out, [[128, 0, 255, 128], [0; 4], [255, 0, 255, 255]]);
    }
}
