//! Composing a tile pass by pass, with one layer in memory.
//!
//! The picture begins with opaque surfaces. Each pass brings one layer for each sample that has
//! some left, the farthest: it is illuminated, laid over the picture, and forgotten. What a layer
//! looks like, and where in the pixel it is illuminated, is the same as when all layers are there
//! at once, to the last bit.
//!
//! In:   a tile, and passes over the layers in front of it. Out: its pixels, and on demand those
//!       after each pass.
//! Cost: see `visible/peel.rs`; memory: a colour for each sample.
//! Source: \[Mammen 1989\].

use super::FrameConstants;
use super::composite::opaque_samples;
use super::fragments::fragment;
use super::points::{Points, Source, samples_in};
use super::scratch::Scratch;
use super::shade::shade;
use super::shaded_points::ShadedPoints;
use crate::marks::MarkColors;
use crate::visible::Peel;
use vitral_raster::{TILE_PIXELS, Tile};

/// The picture of a tile, as far as it is composed.
struct Canvas {
    samples: Vec<[f32; 4]>,
    /// Pixels in which something is, and those that have layers.
    filled: Vec<bool>,
    layered: Vec<bool>,
}

/// Composes a tile; `pass` goes through the layers. Gives what each pass made of it, the opaque
/// tile first, if it is to be `shown`, else the last alone; and how many samples of layers there
/// were.
pub(super) fn compose(
    tile: &Tile,
    scratch: &mut Scratch,
    constants: &FrameConstants<'_>,
    marks: &MarkColors,
    pass: &mut dyn FnMut(&mut Peel) -> bool,
    shown: bool,
) -> (Vec<Vec<[u8; 4]>>, u64, u64) {
    let samples = constants.view.pattern.len();

    // Start with the opaque tile.
    let mut canvas = canvas(tile, &scratch.points, &scratch.lit, constants);
    let (mut pictures, mut layers, mut shaded) = (Vec::new(), 0, 0);
    let mut peel = Peel::default();
    peel.reset(samples);

    // Shade each layer and lay it over the samples.
    while pass(&mut peel) {
        if shown {
            pictures.push(encode(tile, scratch, &canvas, constants));
        }
        let Scratch { points, facets, lit, .. } = &mut *scratch;
        points.collect_pass(tile, &peel, constants, marks);
        shade(points, facets, constants, lit);
        shaded += points.len() as u64;
        for of in &points.fragments {
            let fragment = fragment(of, tile, points, lit, constants, marks);
            (canvas.filled[of.pixel as usize], canvas.layered[of.pixel as usize]) = (true, true);
            for sample in samples_in(of.mask) {
                fragment
                    .over(&mut canvas.samples[sample as usize * TILE_PIXELS + of.pixel as usize]);
                layers += 1;
            }
        }
    }

    // Encode the finished tile.
    pictures.push(encode(tile, scratch, &canvas, constants));
    (pictures, layers, shaded)
}

/// What is opaque, and the background.
fn canvas(
    tile: &Tile,
    points: &Points,
    lit: &ShadedPoints,
    constants: &FrameConstants<'_>,
) -> Canvas {
    let mut canvas = Canvas {
        samples: opaque_samples(tile, points, lit, constants),
        filled: vec![false; TILE_PIXELS],
        layered: vec![false; TILE_PIXELS],
    };
    for pixel in &points.pixels {
        canvas.filled[pixel.index as usize] = true;
        canvas.layered[pixel.index as usize] = matches!(pixel.source, Source::Mixed(_));
    }
    canvas
}

/// The canvas as display bytes.
fn encode(
    tile: &Tile,
    scratch: &mut Scratch,
    canvas: &Canvas,
    constants: &FrameConstants<'_>,
) -> Vec<[u8; 4]> {
    let Scratch { points, composer, .. } = scratch;
    let mut picture = vec![[0; 4]; TILE_PIXELS];
    let samples = constants.view.pattern.len();
    composer.begin(tile, points, constants, &mut picture);
    let mut of_pixel = Vec::with_capacity(samples);
    for pixel in (0..TILE_PIXELS).filter(|&p| canvas.filled[p]) {
        of_pixel.clear();
        // Pixels that one opaque point fills are that point, not a mean.
        let count = if canvas.layered[pixel] { samples } else { 1 };
        of_pixel.extend((0..count).map(|s| canvas.samples[s * TILE_PIXELS + pixel]));
        composer.put(pixel as u32, &of_pixel);
    }
    composer.end(constants, &mut picture);
    picture
}
