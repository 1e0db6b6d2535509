//! From illuminated points to the pixels of a tile: samples, layers, background, display encoding.
//!
//! The layers in front of a pixel are laid over its samples by the chosen order of transparency (see
//! [`crate::transparency`]); a pixel is the mean of its samples. Everything is premultiplied and, except in the raw
//! colour space, linear; bytes are encoded at the end.
//! Source: [Porter & Duff 1984] for the operator.

use super::FrameConstants;
use super::behind::DeepPicture;
use super::group::Lit;
use super::points::{FragmentPoint, NO_POINT, Points, Source, visible_part};
use crate::marks::MarkColors;
use crate::transparency::{Fragment, MOST_SAMPLES};
use vitral_math::Vec2;
use vitral_math::color::{SrgbBytes, byte_from_unit};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, Level, Simd, dispatch};
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
    /// `deep` is the whole picture and the tile's number in it, where there are translucent surfaces.
    pub(crate) fn compose(
        &mut self,
        tile: &Tile,
        points: &Points,
        lit: &Lit,
        constants: &FrameConstants<'_>,
        marks: &MarkColors,
        deep: Option<(&DeepPicture<'_>, usize)>,
        out: &mut [[u8; 4]],
    ) {
        self.begin(tile, constants, out);
        if points.mixed.is_empty() && points.fragments.is_empty() {
            // One point fills each pixel, in the order of the pixels.
            self.places.extend(points.pixels.iter().map(|p| p.index));
            encode(constants.level, &self.places, &lit.colors, constants.raw, out);
            return;
        }
        if points.fragments.is_empty() {
            self.mix_opaque(tile, points, lit, constants);
        } else {
            self.mix(tile, points, lit, constants, marks, deep);
        }
        encode(constants.level, &self.places, &self.colors, constants.raw, out);
    }

    /// Begins a picture with the background.
    pub(super) fn begin(&mut self, tile: &Tile, constants: &FrameConstants<'_>, out: &mut [[u8; 4]]) {
        let (width, height) = visible_part(tile, constants);
        for y in 0..height {
            out[y * TILE..y * TILE + width].fill(constants.background.bytes[tile.y as usize + y]);
        }
        self.places.clear();
        self.colors.clear();
    }

    /// Adds a pixel that is the mean of samples.
    pub(super) fn put(&mut self, pixel: u32, samples: &[[f32; 4]]) {
        self.places.push(pixel);
        self.colors.push(if let [one] = samples { *one } else { mean(samples.iter().copied()) });
    }

    /// Encodes the pixels that were added.
    pub(super) fn end(&self, constants: &FrameConstants<'_>, out: &mut [[u8; 4]]) {
        encode(constants.level, &self.places, &self.colors, constants.raw, out);
    }

    /// [`Self::mix`] where nothing lies in front.
    fn mix_opaque(&mut self, tile: &Tile, points: &Points, lit: &Lit, constants: &FrameConstants<'_>) {
        let samples = constants.view.pattern.len();
        let background = &constants.background.colors[tile.y as usize..];
        self.places.extend(points.pixels.iter().map(|p| p.index));
        self.colors.extend(points.pixels.iter().map(|pixel| match pixel.source {
            Source::Point(point) => lit.colors[point as usize],
            Source::Mixed(start) => {
                let behind = background[pixel.index as usize / TILE];
                let color = |&point: &u32| if point == NO_POINT { behind } else { lit.colors[point as usize] };
                mean(points.mixed[start as usize..][..samples].iter().map(color))
            }
        }));
    }

    /// Mixes the samples of every pixel that shows more than the background.
    fn mix(
        &mut self,
        tile: &Tile,
        points: &Points,
        lit: &Lit,
        constants: &FrameConstants<'_>,
        marks: &MarkColors,
        deep: Option<(&DeepPicture<'_>, usize)>,
    ) {
        let samples = constants.view.pattern.len();
        let (mut pixels, mut layers) = (points.pixels.as_slice(), points.fragments.as_slice());
        let mut fragments = Vec::new();
        loop {
            // The next pixel in either list.
            let of_layer = layers.first().map_or(u32::MAX, |l| l.pixel);
            let of_surface = pixels.first().map_or(u32::MAX, |p| p.index);
            let index = of_layer.min(of_surface);
            if index == u32::MAX {
                return;
            }
            let background = constants.background.colors[tile.y as usize + index as usize / TILE];
            let behind = |point: u32| if point == NO_POINT { background } else { lit.colors[point as usize] };
            let mut source = Source::Point(NO_POINT);
            if of_surface == index {
                source = pixels[0].source;
                pixels = &pixels[1..];
            }
            let in_front = layers.iter().take_while(|l| l.pixel == index).count();
            let (mine, rest) = layers.split_at(in_front);
            layers = rest;
            let color = match source {
                Source::Point(point) if mine.is_empty() => behind(point),
                _ => {
                    let mut below = [[0.0; 4]; MOST_SAMPLES];
                    let below = &mut below[..samples];
                    match source {
                        Source::Point(point) => below.fill(behind(point)),
                        Source::Mixed(start) => {
                            let points = &points.mixed[start as usize..][..samples];
                            below.iter_mut().zip(points).for_each(|(sample, &point)| *sample = behind(point));
                        }
                    }
                    if !mine.is_empty() {
                        fragments.clear();
                        fragments.extend(mine.iter().map(|f| fragment(f, tile, points, lit, constants, marks)));
                        if let Some((deep, index)) = deep {
                            let behind = mine.iter().map(|f| deep.behind(index, f, mine));
                            fragments.iter_mut().zip(behind).for_each(|(f, behind)| f.behind = behind);
                        }
                        (constants.lay)(&fragments, below);
                    }
                    mean(below.iter().copied())
                }
            };
            self.places.push(index);
            self.colors.push(color);
        }
    }
}

fn mean(samples: impl ExactSizeIterator<Item = [f32; 4]>) -> [f32; 4] {
    let (count, mut sum) = (samples.len() as f32, [0.0; 4]);
    for color in samples {
        for k in 0..4 {
            sum[k] += color[k];
        }
    }
    sum.map(|c| c / count)
}

/// A fragment of a tile with its colour.
pub(super) fn fragment<'a>(
    f: &FragmentPoint,
    tile: &Tile,
    points: &'a Points,
    lit: &Lit,
    constants: &FrameConstants<'_>,
    marks: &MarkColors,
) -> Fragment<'a> {
    let (start, source) = (f.start as usize, f.source as usize);
    let color = if f.is_mark {
        let (x, y) = (tile.x + f.pixel % TILE as u32, tile.y + f.pixel / TILE as u32);
        marks.color(source, Vec2::new(x as f32, y as f32), constants.background.colors[y as usize])
    } else {
        lit.colors[source]
    };
    let passes = match lit.passes.get(source) {
        Some(passes) if !f.is_mark => *passes,
        _ => [1.0 - color[3]; 3],
    };
    let depths = &points.depths[start..start + f.count as usize];
    let FragmentPoint { facet, mask, far, near, .. } = *f;
    Fragment { facet, mask, depths, far, near, color, passes, behind: None }
}

/// Premultiplied colours to display bytes with straight alpha, put in their places.
fn encode(level: Level, places: &[u32], colors: &[[f32; 4]], raw: bool, out: &mut [[u8; 4]]) {
    if raw {
        return places.iter().zip(colors).for_each(|(&place, color)| {
            let [r, g, b, alpha] = straight(color);
            out[place as usize] = [r, g, b, alpha].map(byte_from_unit);
        });
    }
    dispatch!(level, simd => encode_srgb(simd, places, colors, out));
}

#[inline(always)]
fn encode_srgb<S: Simd>(simd: S, places: &[u32], colors: &[[f32; 4]], out: &mut [[u8; 4]]) {
    let table = SrgbBytes::get();
    for (places, colors) in places.chunks(2).zip(colors.chunks(2)) {
        if let ([first, second], &[[_, _, _, a], [_, _, _, b]]) = (places, colors)
            && a >= 1.0
            && b >= 1.0
        {
            // Nearly all pixels are opaque: no division, no alpha to encode.
            let bytes = table.eight(F32x8::from_slice(simd, colors.as_flattened())).to_array();
            let [r, g, b, _, s, h, c, _] = bytes.map(|byte| byte as u8);
            out[*first as usize] = [r, g, b, u8::MAX];
            out[*second as usize] = [s, h, c, u8::MAX];
            continue;
        }
        for (&place, color) in places.iter().zip(colors) {
            let [r, g, b, alpha] = straight(color);
            out[place as usize] = [table.byte(r), table.byte(g), table.byte(b), byte_from_unit(alpha)];
        }
    }
}

/// A premultiplied colour with straight alpha.
#[inline(always)]
fn straight(&[r, g, b, alpha]: &[f32; 4]) -> [f32; 4] {
    let straight = match alpha {
        1.0.. => 1.0,
        _ if alpha > 0.0 => 1.0 / alpha,
        _ => 0.0,
    };
    [r * straight, g * straight, b * straight, alpha]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_encode_with_straight_alpha() {
        let (level, mut out) = (Level::new(), [[9; 4]; 3]);
        encode(level, &[0, 1, 2], &[[0.25, 0.0, 0.5, 0.5], [0.0; 4], [2.0, f32::NAN, 1.0, 1.0]], true, &mut out);
        assert_eq!(out, [[128, 0, 255, 128], [0; 4], [255, 0, 255, 255]]);
        let colors = [[0.25, 0.0, 0.5, 1.0], [2.0, f32::NAN, 1.0, 1.0], [0.125, 0.5, 0.25, 0.5]];
        encode(level, &[2, 0, 1], &colors, false, &mut out);
        assert_eq!(out, [[255, 0, 255, 255], [137, 255, 188, 128], [137, 0, 188, 255]]);
    }
}
