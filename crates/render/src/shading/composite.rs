//! From illuminated points to the pixels of a tile: samples, layers, background, display encoding.
//!
//! The layers in front of a pixel are laid over its samples by the chosen order of transparency
//! (see [`crate::transparency`]); a pixel is the mean of its samples. Everything is premultiplied
//! and, except in the raw colour space, linear; bytes are encoded at the end.
//! Source: [Porter & Duff 1984] for the operator.

use super::FrameConstants;
use super::behind::DeepPicture;
use super::fragments::fragment;
use super::points::{NO_POINT, Points, Source, visible_part};
use super::shaded_points::ShadedPoints;
use crate::display::encode;
use crate::marks::MarkColors;
use crate::transparency::MOST_SAMPLES;
use vitral_raster::{TILE, TILE_PIXELS, Tile};

/// Memory of one tile's composition.
#[derive(Default)]
pub(crate) struct Composer {
    /// Pixels that are not plain background.
    places: Vec<u32>,
    /// Their colours, premultiplied.
    colors: Vec<[f32; 4]>,
}

impl Composer {
    /// `deep` is the whole picture and the tile's number in it, where there are translucent
    /// surfaces.
    pub(crate) fn compose(
        &mut self,
        tile: &Tile,
        points: &Points,
        lit: &ShadedPoints,
        constants: &FrameConstants<'_>,
        marks: &MarkColors,
        deep: Option<(&DeepPicture<'_>, usize)>,
        out: &mut [[u8; 4]],
    ) {
        self.begin(tile, points, constants, out);
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

    /// Begins a picture with the background, and the shadow on the ground.
    pub(super) fn begin(
        &mut self,
        tile: &Tile,
        points: &Points,
        constants: &FrameConstants<'_>,
        out: &mut [[u8; 4]],
    ) {
        let (width, height) = visible_part(tile, constants.view.viewport);
        for y in 0..height {
            out[y * TILE..y * TILE + width].fill(constants.background.bytes[tile.y as usize + y]);
        }
        self.places.clear();
        self.colors.clear();
        if !points.ground.is_empty() {
            let is_dark = |&pixel: &u32| points.ground[pixel as usize] > 0.0;
            let seen =
                |&pixel: &u32| (pixel as usize % TILE) < width && (pixel as usize / TILE) < height;
            self.places.extend((0..TILE_PIXELS as u32).filter(seen).filter(is_dark));
            let color =
                |&pixel: &u32| points.background(tile, pixel as usize, &constants.background);
            self.colors.extend(self.places.iter().map(color));
            encode(constants.level, &self.places, &self.colors, constants.raw, out);
            self.places.clear();
            self.colors.clear();
        }
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
    fn mix_opaque(
        &mut self,
        tile: &Tile,
        points: &Points,
        lit: &ShadedPoints,
        constants: &FrameConstants<'_>,
    ) {
        let samples = constants.view.pattern.len();
        self.places.extend(points.pixels.iter().map(|p| p.index));
        self.colors.extend(points.pixels.iter().map(|pixel| match pixel.source {
            Source::Point(point) => lit.colors[point as usize],
            Source::Mixed(start) => {
                let behind = points.background(tile, pixel.index as usize, &constants.background);
                let color = |&point: &u32| {
                    if point == NO_POINT { behind } else { lit.colors[point as usize] }
                };
                mean(points.mixed[start as usize..][..samples].iter().map(color))
            }
        }));
    }

    /// Mixes the samples of every pixel that shows more than the background.
    fn mix(
        &mut self,
        tile: &Tile,
        points: &Points,
        lit: &ShadedPoints,
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

            // Take the pixel's surface and its layers.
            // Found when a pixel first needs it: most are covered.
            let background = || points.background(tile, index as usize, &constants.background);
            let behind = |point: u32| {
                if point == NO_POINT { background() } else { lit.colors[point as usize] }
            };
            let mut source = Source::Point(NO_POINT);
            if of_surface == index {
                source = pixels[0].source;
                pixels = &pixels[1..];
            }
            let in_front = layers.iter().take_while(|l| l.pixel == index).count();
            let (mine, rest) = layers.split_at(in_front);
            layers = rest;

            // Compose the samples and take their mean.
            let color = match source {
                Source::Point(point) if mine.is_empty() => behind(point),
                _ => {
                    let mut below = [[0.0; 4]; MOST_SAMPLES];
                    let below = &mut below[..samples];
                    opaque_of_pixel(source, points, behind, below);
                    if !mine.is_empty() {
                        fragments.clear();
                        fragments.extend(
                            mine.iter().map(|f| fragment(f, tile, points, lit, constants, marks)),
                        );
                        if let Some((deep, index)) = deep {
                            let behind = mine.iter().map(|f| deep.behind(index, f, mine));
                            fragments
                                .iter_mut()
                                .zip(behind)
                                .for_each(|(f, behind)| f.behind = behind);
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

/// The colours of a pixel's samples without what lies in front: `behind` gives that of a point.
pub(super) fn opaque_of_pixel(
    source: Source,
    points: &Points,
    behind: impl Fn(u32) -> [f32; 4],
    below: &mut [[f32; 4]],
) {
    match source {
        Source::Point(point) => below.fill(behind(point)),
        Source::Mixed(start) => {
            let points = &points.mixed[start as usize..][..below.len()];
            below.iter_mut().zip(points).for_each(|(sample, &point)| *sample = behind(point));
        }
    }
}

/// The colour of a pixel with these samples.
pub(super) fn mean(samples: impl ExactSizeIterator<Item = [f32; 4]>) -> [f32; 4] {
    let (count, mut sum) = (samples.len() as f32, [0.0; 4]);
    for color in samples {
        for k in 0..4 {
            sum[k] += color[k];
        }
    }
    sum.map(|c| c / count)
}

/// The colours of a tile's samples, all pixels of one sample after the other: opaque ones, and
/// the background.
pub(super) fn opaque_samples(
    tile: &Tile,
    points: &Points,
    lit: &ShadedPoints,
    constants: &FrameConstants<'_>,
) -> Vec<[f32; 4]> {
    let background = |pixel: usize| points.background(tile, pixel, &constants.background);
    let samples = constants.view.pattern.len();
    let mut colors: Vec<_> =
        (0..samples * TILE_PIXELS).map(|at| background(at % TILE_PIXELS)).collect();
    for pixel in &points.pixels {
        for sample in 0..samples {
            let point = match pixel.source {
                Source::Point(point) => point,
                Source::Mixed(start) => points.mixed[start as usize + sample],
            };
            if point != NO_POINT {
                colors[sample * TILE_PIXELS + pixel.index as usize] = lit.colors[point as usize];
            }
        }
    }
    colors
}
