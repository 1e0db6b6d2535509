//! The buffers of the two-buffer order of transparency, for whoever wants to see them.
//!
//! The first holds opaque surfaces, with their depth. The second holds what the list of transparent
//! surfaces leaves there, a coefficient and an intensity, in front of that depth. The picture is
//! made of both.
//!
//! In:   a tile with its layers. Out: the buffers of its pixels.
//! Cost: linear in the samples; nothing if nobody asks.
//! Source: see [`crate::transparency::two_buffer`], which fills them.

use super::FrameConstants;
use super::composite::opaque_samples;
use super::fragments::fragment;
use super::points::Points;
use super::shaded_points::ShadedPoints;
use crate::marks::MarkColors;
use crate::transparency::two_buffer::{self, Behind};
use vitral_raster::{TILE_PIXELS, Tile};

/// The buffers of a tile, row by row.
#[derive(Debug, Default)]
pub(crate) struct BufferPlanes {
    pub opaque: Vec<[f32; 4]>,
    pub depth: Vec<f32>,
    pub layers: Vec<u32>,
    pub intensity: Vec<[f32; 3]>,
    pub coefficient: Vec<[f32; 3]>,
}

/// Bytes of the buffers of a pixel, tile by tile and in the picture.
pub(crate) const BYTES_A_PIXEL: u64 = 2 * (16 + 4 + 4 + 12 + 12);

/// The buffers of a tile whose points are lit: means of the samples, but depth and number of
/// layers, which are those of the first sample.
pub(super) fn planes(
    tile: &Tile,
    points: &Points,
    lit: &ShadedPoints,
    constants: &FrameConstants<'_>,
    marks: &MarkColors,
) -> BufferPlanes {
    // Start with the opaque samples.
    let opaque = opaque_samples(tile, points, lit, constants);
    let samples = constants.view.pattern.len();
    let share = 1.0 / samples as f32;
    let mut planes = BufferPlanes {
        opaque: vec![[0.0; 4]; TILE_PIXELS],
        depth: tile.depth[..TILE_PIXELS].to_vec(),
        layers: vec![0; TILE_PIXELS],
        intensity: vec![[0.0; 3]; TILE_PIXELS],
        coefficient: vec![[0.0; 3]; TILE_PIXELS],
    };
    let mut layers = points.fragments.as_slice();
    let mut fragments = Vec::new();

    // Compose each pixel's layers, sample by sample.
    for pixel in 0..TILE_PIXELS {
        let (mine, rest) =
            layers.split_at(layers.iter().take_while(|l| l.pixel as usize == pixel).count());
        layers = rest;
        fragments.clear();
        fragments.extend(mine.iter().map(|f| fragment(f, tile, points, lit, constants, marks)));
        for sample in 0..samples {
            let behind = Behind { color: opaque[sample * TILE_PIXELS + pixel], depth: None };
            let filled = two_buffer::fill(&fragments, sample, behind);
            if sample == 0 {
                planes.layers[pixel] = filled.layers;
                planes.depth[pixel] = filled.behind.depth.unwrap_or(planes.depth[pixel]);
            }

            // Add the sample to the means.
            for k in 0..4 {
                planes.opaque[pixel][k] += filled.behind.color[k] * share;
            }
            for k in 0..3 {
                planes.intensity[pixel][k] += filled.light[k] * share;
                planes.coefficient[pixel][k] += (1.0 - filled.passes[k]) * share;
            }
        }
    }
    planes
}
