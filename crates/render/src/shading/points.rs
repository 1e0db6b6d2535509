//! The points of a tile that are illuminated, and which samples and fragments show them.

use crate::display::BackgroundRows;
use crate::transparency::range;
use vitral_raster::{TILE, Tile, Viewport};

/// The points of a tile.
#[derive(Default)]
pub(crate) struct Points {
    /// Facet of each point.
    pub facet: Vec<u32>,
    /// Where it is illuminated, in pixels of the picture.
    pub place: Vec<[f32; 2]>,
    /// Pixels with an opaque surface, in order.
    pub pixels: Vec<Pixel>,
    /// The points of the samples of mixed pixels, or [`NO_POINT`].
    pub mixed: Vec<u32>,
    /// The points that rays are followed on from, one for each sample.
    pub followed: Vec<u32>,
    /// Layers, facet by facet in each pixel, in the order of the scene; by a list, piece by piece
    /// in its order.
    pub fragments: Vec<FragmentPoint>,
    /// Their depths, sample by sample.
    pub depths: Vec<f32>,
    pub(super) layers: Vec<LayerPoint>,
    /// Points in the order of their groups.
    pub order: Vec<u32>,
    /// Runs of `order` with one object and material.
    pub groups: Vec<Group>,
    /// For each pixel the part of its background that a shadow on the ground takes; empty without
    /// one.
    pub ground: Vec<f32>,
    /// Pixels with a surface.
    pub covered_pixels: u64,
    /// Samples of layers where depth contradicted a list.
    pub overruled: u64,
    pub(super) keys: Vec<[u32; 2]>,
    pub(super) key_of_point: Vec<u32>,
    pub(super) ends: Vec<u32>,
}

/// A sample without an opaque surface.
pub(crate) const NO_POINT: u32 = u32::MAX;

/// A pixel with an opaque surface.
#[derive(Clone, Copy)]
pub(crate) struct Pixel {
    /// Its number in the tile, row by row.
    pub index: u32,
    /// The point that fills it, or where its samples start in [`Points::mixed`].
    pub source: Source,
}

/// What fills a pixel.
#[derive(Clone, Copy)]
pub(crate) enum Source {
    /// One point.
    Point(u32),
    /// Samples from this place in [`Points::mixed`].
    Mixed(u32),
}

/// A layer at a sample of a pixel.
#[derive(Clone, Copy, Default)]
pub(super) struct LayerPoint {
    pub sample: u32,
    pub depth: f32,
    pub facet: u32,
}

impl LayerPoint {
    /// Orders layers by facets, those of a facet by samples.
    #[inline(always)]
    pub(super) fn key(&self) -> u64 {
        u64::from(self.facet) << 32 | u64::from(self.sample)
    }
}

/// A facet in a pixel, in front of its opaque samples.
#[derive(Clone, Copy, Default)]
pub(crate) struct FragmentPoint {
    /// The pixel's number in the tile.
    pub pixel: u32,
    /// The facet.
    pub facet: u32,
    /// Which samples it covers.
    pub mask: u32,
    /// Its depth at each of them, from this place in [`Points::depths`].
    pub start: u32,
    /// How many those are, and the farthest and nearest of them.
    pub count: u32,
    pub far: f32,
    pub near: f32,
    /// Index of a point, or of a mark.
    pub source: u32,
    /// It is a line or a point of the model, not a surface.
    pub is_mark: bool,
}

impl FragmentPoint {
    /// Whether it covers a sample.
    pub(crate) fn covers(&self, sample: u32) -> bool {
        self.mask >> sample & 1 == 1
    }
}

/// Points of one object with one material.
#[derive(Clone, Copy)]
pub(crate) struct Group {
    /// Index into the world's instances.
    pub instance: u32,
    /// Index into the mesh's parts.
    pub part: u32,
    /// Start in `order`.
    pub start: u32,
    /// End in `order`.
    pub end: u32,
}

impl Points {
    /// The colour behind all surfaces of a pixel of the tile, in the space of composition.
    #[inline]
    pub(crate) fn background(&self, tile: &Tile, pixel: usize, rows: &BackgroundRows) -> [f32; 4] {
        let row = tile.y + (pixel / TILE) as u32;
        self.ground.get(pixel).map_or_else(|| rows.color(row), |&dark| rows.shaded(row, dark))
    }

    /// The part of the background that a shadow on the ground takes in the pixel of a point.
    pub(crate) fn ground_at(&self, tile: &Tile, point: u32) -> f32 {
        let [x, y] = self.place[point as usize].map(|v| v as usize);
        let pixel = (y - tile.y as usize) * TILE + x - tile.x as usize;
        self.ground.get(pixel).copied().unwrap_or(0.0)
    }

    pub(crate) fn len(&self) -> usize {
        self.facet.len()
    }

    /// Depth of a fragment at a sample that it covers.
    pub(super) fn depth(&self, f: &FragmentPoint, sample: u32) -> f32 {
        let before = f.mask & ((1u32 << sample) - 1);
        self.depths[(f.start + before.count_ones()) as usize]
    }

    /// A fragment of a pixel and facet with the samples `mask`, whose depths begin at `start`.
    pub(super) fn fragment(
        &self,
        (pixel, facet): (u32, u32),
        (mask, start): (u32, u32),
        (source, is_mark): (u32, bool),
    ) -> FragmentPoint {
        let count = mask.count_ones();
        let [far, near] = range(&self.depths[start as usize..(start + count) as usize]);
        FragmentPoint { pixel, facet, mask, start, count, far, near, source, is_mark }
    }

    pub(super) fn push(&mut self, facet: u32, place: [f32; 2]) -> u32 {
        self.facet.push(facet);
        self.place.push(place);
        self.facet.len() as u32 - 1
    }

    /// Frees what only finding the points took.
    pub(crate) fn forget_workspace(&mut self) {
        (self.layers, self.order, self.keys, self.key_of_point) = Default::default();
        (self.ends, self.followed, self.groups) = Default::default();
    }

    /// Bytes of what is left then.
    pub(crate) fn bytes(&self) -> usize {
        let fragments =
            self.fragments.capacity() * size_of::<FragmentPoint>() + self.depths.capacity() * 4;
        let pixels = self.pixels.capacity() * size_of::<Pixel>() + self.mixed.capacity() * 4;
        fragments
            + pixels
            + self.facet.capacity() * 4
            + self.place.capacity() * 8
            + self.ground.capacity() * 4
    }
}

/// Columns and rows of the tile that lie in the picture.
pub(crate) fn visible_part(tile: &Tile, viewport: Viewport) -> (usize, usize) {
    (
        (viewport.width - tile.x).min(TILE as u32) as usize,
        (viewport.height - tile.y).min(TILE as u32) as usize,
    )
}

/// The samples of a mask, from the lowest.
pub(super) fn samples_in(mask: u32) -> impl Iterator<Item = u32> {
    let mut left = mask;
    std::iter::from_fn(move || {
        let sample = (left != 0).then(|| left.trailing_zeros());
        left &= left.wrapping_sub(1);
        sample
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_of_neighbouring_facets_are_told_apart_at_every_sample() {
        let all = (0..4).flat_map(|facet| (0..32).map(move |sample| (facet, sample)));
        let key = |(facet, sample)| LayerPoint { sample, depth: 0.0, facet }.key();
        assert!(all.clone().map(key).is_sorted_by(|a, b| a < b));
    }
}
