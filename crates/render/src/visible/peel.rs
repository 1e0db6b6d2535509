//! One pass over the transparent facets of a tile: at each sample the farthest layer that is left.
//!
//! A pass needs two depths a sample, whatever the number of layers: that of what has been laid so
//! far, and that of the farthest layer found that is nearer than it and in front of what is opaque.
//! Of coincident facets the lower is nearer, so that none is passed over. A second walk finds which
//! samples of its pixel each of these facets covers, those of other passes included: it is
//! illuminated in the middle of them.
//!
//! In:   set-up triangles (screen space), a tile's opaque samples. Out: a layer for each sample.
//! Cost: twice the covered samples; memory: five numbers a sample.
//! Source: \[Mammen 1989\].

use super::agreement::nearer;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{Level, Mask8, Simd, dispatch};
use vitral_raster::{
    Batch, NO_FACET, RowPlane, RowSink, SUBPIXEL, SamplePattern, Setup, TILE, TILE_PIXELS, Tile,
    traverse_by_rows,
};

/// Depth and facet; [`NO_FACET`] for none.
type Candidate = (f32, u32);

/// Nothing, farther than everything.
const NOTHING: Candidate = (f32::NEG_INFINITY, NO_FACET);

/// What is known of a tile between passes. Indices are those of the tile's planes.
#[derive(Debug, Default)]
pub struct Peel {
    /// The last layer that was laid at each sample.
    laid: Vec<Candidate>,
    /// The farthest that is nearer.
    farthest: Vec<Candidate>,
    /// The samples of its pixel that this facet covers.
    covers: Vec<u32>,
}

/// A layer of one pass at a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassLayer {
    /// Depth, 1 near.
    pub depth: f32,
    /// Id of the facet.
    pub facet: u32,
    /// All samples of the pixel that the facet covers in front of what is opaque, one bit each.
    pub covers: u32,
}

impl Peel {
    /// Before the first pass over a tile of `samples` samples a pixel.
    pub fn reset(&mut self, samples: usize) {
        self.laid.clear();
        self.laid.resize(samples * TILE_PIXELS, NOTHING);
    }

    /// The layer of the last pass at a sample.
    pub fn layer(&self, at: usize) -> Option<PassLayer> {
        let (depth, facet) = self.farthest[at];
        (facet != NO_FACET).then(|| PassLayer { depth, facet, covers: self.covers[at] })
    }

    /// Goes through all layers of a tile; false if none was left.
    pub(super) fn pass<'b>(
        &mut self,
        level: Level,
        batches: impl Iterator<Item = &'b Batch> + Clone,
        index: usize,
        tile: &Tile,
        pattern: &SamplePattern,
    ) -> bool {
        // What the last pass found has been laid.
        for (laid, farthest) in self.laid.iter_mut().zip(&self.farthest) {
            if farthest.1 != NO_FACET {
                *laid = *farthest;
            }
        }
        self.farthest.clear();
        self.farthest.resize(self.laid.len(), NOTHING);
        self.covers.clear();
        self.covers.resize(self.laid.len(), 0);
        for second in [false, true] {
            let mut sink = PassSink { peel: self, tile, pattern, second };
            dispatch!(level, simd => walk(simd, batches.clone(), index, &mut sink));
        }
        self.farthest.iter().any(|f| f.1 != NO_FACET)
    }
}

#[inline(always)]
fn walk<'b, S: Simd>(
    simd: S,
    batches: impl Iterator<Item = &'b Batch>,
    index: usize,
    sink: &mut PassSink<'_>,
) {
    let (place, pattern) = ((sink.tile.x, sink.tile.y), sink.pattern);
    for setup in batches.flat_map(|batch| batch.tile(index)) {
        traverse_by_rows(simd, setup, place, pattern, sink);
    }
}

/// Takes the covered samples of a pass.
struct PassSink<'a> {
    peel: &'a mut Peel,
    tile: &'a Tile,
    pattern: &'a SamplePattern,
    /// The farthest are known: what do they cover?
    second: bool,
}

impl PassSink<'_> {
    fn take(&mut self, facet: u32, depth: f32, sample: usize, pixel: usize) {
        let candidate = (depth, facet);
        let at = sample * TILE_PIXELS + pixel;
        if !nearer(candidate, (self.tile.depth[at], self.tile.facet[at])) {
            return;
        }
        let Peel { laid, farthest, covers } = &mut *self.peel;
        if self.second {
            for s in 0..self.pattern.len() {
                let other = s * TILE_PIXELS + pixel;
                covers[other] |= u32::from(farthest[other].1 == facet) << sample;
            }
        } else if nearer(candidate, laid[at])
            && (farthest[at].1 == NO_FACET || nearer(farthest[at], candidate))
        {
            farthest[at] = candidate;
        }
    }
}

impl<S: Simd> RowSink<S> for PassSink<'_> {
    #[inline(always)]
    fn hiding(&self) -> Option<&Tile> {
        Some(self.tile)
    }

    #[inline(always)]
    fn first(&self, sample: usize, x: usize) -> [i32; 2] {
        let [sx, sy] = self.pattern.position(sample);
        [(self.tile.x as usize + x) as i32 * SUBPIXEL + sx, self.tile.y as i32 * SUBPIXEL + sy]
    }

    fn cover_row(
        &mut self,
        _: S,
        (setup, plane): (&Setup, &RowPlane<S>),
        sample: usize,
        [x, y]: [usize; 2],
        covered: Mask8<S>,
    ) {
        let (depths, mut left) = (plane.row(y).to_array(), covered.to_bitmask());
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            self.take(setup.facet, depths[lane], sample, y * TILE + x + lane);
        }
    }
}
