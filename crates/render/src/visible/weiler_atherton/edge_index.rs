//! An index of a region's edges, so that a clip looks only at those near the clipping polygon.
//!
//! The region's longer side is divided into bands; each lists the edges that reach into it.
//!
//! In:   edges. Out: numbers of edges near a box, or in a band.
//! Cost: of an entry, the bands that an edge reaches; of a search, the edges in the box's bands.

use super::line::{ROUNDING, RegionEdge};

/// About how many edges a band has, when they are short.
const EDGES_A_BAND: usize = 4;
/// Bands at most.
const MAX_BANDS: usize = 1024;

/// See the module. Numbers of edges are their positions in the region's list; removed ones keep
/// theirs.
#[derive(Clone, Debug)]
pub(super) struct EdgeIndex {
    /// The axis that is divided: 0 for x, 1 for y.
    pub(super) axis: usize,
    origin: f64,
    bands_a_unit: f64,
    bands: Vec<Vec<u32>>,
    is_removed: Vec<bool>,
    removed: usize,
}

impl EdgeIndex {
    /// Of edges in a box: smallest x and y, largest x and y.
    pub(super) fn new(edges: &[RegionEdge], [x0, y0, x1, y1]: [f64; 4]) -> Self {
        let axis = usize::from(y1 - y0 > x1 - x0);
        let (origin, length) = if axis == 0 { (x0, x1 - x0) } else { (y0, y1 - y0) };
        let count = (edges.len() / EDGES_A_BAND).clamp(1, MAX_BANDS);
        let mut index = Self {
            axis,
            origin,
            bands_a_unit: count as f64 / length.max(1.0),
            bands: vec![Vec::new(); count],
            is_removed: Vec::with_capacity(edges.len()),
            removed: 0,
        };
        edges.iter().for_each(|edge| index.push(edge));
        index
    }

    fn band(&self, at: f64) -> usize {
        (((at - self.origin) * self.bands_a_unit).max(0.0) as usize).min(self.bands.len() - 1)
    }

    /// First and last band that something from `low` to `high` reaches.
    fn reach(&self, low: f64, high: f64) -> [usize; 2] {
        [self.band(low - ROUNDING), self.band(high + ROUNDING)]
    }

    fn reach_of(&self, edge: &RegionEdge) -> [usize; 2] {
        let [from, to] = edge.about.map(|p| p[self.axis]);
        self.reach(from.min(to), from.max(to))
    }

    /// Enters the next edge.
    pub(super) fn push(&mut self, edge: &RegionEdge) {
        let [first, last] = self.reach_of(edge);
        let number = self.is_removed.len() as u32;
        self.bands[first..=last].iter_mut().for_each(|band| band.push(number));
        self.is_removed.push(false);
    }

    /// Removes an edge.
    pub(super) fn remove(&mut self, number: u32) {
        self.is_removed[number as usize] = true;
        self.removed += 1;
    }

    /// Whether an edge is there still.
    pub(super) fn has(&self, number: usize) -> bool {
        !self.is_removed[number]
    }

    /// How many edges are there.
    pub(super) fn len(&self) -> usize {
        self.is_removed.len() - self.removed
    }

    /// Whether it is worthwhile to make it anew.
    pub(super) fn is_stale(&self) -> bool {
        self.removed > self.len() + MAX_BANDS
    }

    /// Adds to `found` the edges whose boxes touch a box.
    pub(super) fn near(&self, edges: &[RegionEdge], around: [f64; 4], found: &mut Vec<u32>) {
        let [low, high] = [around[self.axis], around[self.axis + 2]];
        let [first, last] = self.reach(low, high);
        for band in first..=last {
            for &number in &self.bands[band] {
                let edge = &edges[number as usize];
                let touches = self.has(number as usize) && edge.touches(around);
                // An edge is taken in the first band that both reach.
                if touches && self.reach_of(edge)[0].max(first) == band {
                    found.push(number);
                }
            }
        }
    }

    /// Edges that may be met by a line across the bands.
    pub(super) fn across(&self, at: f64) -> impl Iterator<Item = usize> {
        self.bands[self.band(at)]
            .iter()
            .map(|&number| number as usize)
            .filter(|&number| self.has(number))
    }

    /// Bytes in memory, about.
    pub(super) fn bytes(&self) -> usize {
        let entries: usize = self.bands.iter().map(Vec::capacity).sum();
        self.bands.len() * size_of::<Vec<u32>>()
            + entries * size_of::<u32>()
            + self.is_removed.len()
    }
}
