//! A map of depths in tiles, each drawn when it is first asked about, and what a tile holds.

use super::lens::Lens;
use std::sync::OnceLock;
use vitral_light::Rgb;
use vitral_math::lanes::{Level, Simd, dispatch};
use vitral_raster::{Batch, NearestDepths, TILE};

/// What the light sees through one lens.
#[derive(Debug)]
pub(super) struct Map {
    pub(super) lens: Lens,
    /// Tiles in a row.
    pub(super) columns: usize,
    pub(super) tiles: Vec<OnceLock<MapTile>>,
    /// What tiles that are not there yet are drawn from; without it, nothing is in them.
    pub(super) pending: Option<Pending>,
}

/// Opaque triangles of a map.
#[derive(Debug)]
pub(super) struct Pending {
    pub(super) batches: Vec<Batch>,
    pub(super) level: Level,
}

/// What the light sees in a tile.
#[derive(Debug, Default)]
pub(super) struct MapTile {
    /// Distance of the nearest opaque thing along the axis, ∞ where there is none; empty if there
    /// is none at all.
    pub(super) depth: Vec<f32>,
    /// Transparent things, sorted by texel.
    pub(super) layers: Vec<Layer>,
}

/// A transparent thing at a texel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layer {
    /// Within the tile.
    pub(super) texel: u32,
    pub(super) depth: f32,
    /// The part of each colour of light that passes.
    pub(super) passing: Rgb,
}

impl Map {
    /// A tile, drawn if nobody asked about it before.
    #[inline(always)]
    pub(super) fn tile(&self, number: usize) -> &MapTile {
        self.tiles[number].get().unwrap_or_else(|| self.drawn(number))
    }

    #[cold]
    #[inline(never)]
    fn drawn(&self, number: usize) -> &MapTile {
        self.tiles[number].get_or_init(|| {
            let Some(pending) = &self.pending else { return MapTile::default() };
            let place =
                [number % self.columns, number / self.columns].map(|tile| (tile * TILE) as u32);
            let nearest =
                nearest_depths(pending.level, place.into(), pending.batches.iter(), number);
            MapTile::new(pending.level, &self.lens, nearest.into_depths(), Vec::new())
        })
    }
}

/// The nearest depths in a tile whose first texel is given.
pub(super) fn nearest_depths<'b>(
    level: Level,
    place: (u32, u32),
    batches: impl Iterator<Item = &'b Batch>,
    tile: usize,
) -> NearestDepths {
    let mut nearest = NearestDepths::new(place);
    for batch in batches {
        nearest.draw(level, batch.tile(tile));
    }
    nearest
}

impl MapTile {
    /// Keeps a tile, given its depths, −∞ where nothing is.
    pub(super) fn new(level: Level, lens: &Lens, mut depth: Vec<f32>, layers: Vec<Layer>) -> Self {
        if !dispatch!(level, simd => distances(simd, lens, &mut depth)) {
            depth = Vec::new();
        }
        Self { depth, layers }
    }

    /// What the transparent things at a texel let through to this depth.
    #[inline(never)]
    pub(super) fn filtered(&self, texel: usize, depth: f64) -> Rgb {
        let first = self.layers.partition_point(|l| (l.texel as usize) < texel);
        let here = self.layers[first..].iter().take_while(|l| l.texel as usize == texel);
        let before = here.filter(|l| f64::from(l.depth) < depth);
        before.fold([1.0; 3], |left, l| [0, 1, 2].map(|k| left[k] * l.passing[k]))
    }
}

/// Makes distances of depths, ∞ of −∞. Whether there is any of the former.
fn distances<S: Simd>(simd: S, lens: &Lens, depths: &mut [f32]) -> bool {
    // Plain loops, for the compiler to do several at once.
    simd.vectorize(
        #[inline(always)]
        || {
            if depths.iter().all(|&depth| depth == f32::NEG_INFINITY) {
                return false;
            }
            for depth in depths {
                let distance = lens.distance(*depth);
                *depth = if *depth < 0.0 { f32::INFINITY } else { distance };
            }
            true
        },
    )
}
