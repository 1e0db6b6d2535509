//! Memory for the shading of a tile.

use super::composite::Composer;
use super::facets::FacetTable;
use super::points::Points;
use super::shaded_points::ShadedPoints;

/// Memory of one tile's work, reused for the next tile.
#[derive(Default)]
pub(crate) struct Scratch {
    pub(super) points: Points,
    pub(super) facets: FacetTable,
    pub(super) lit: ShadedPoints,
    pub(super) composer: Composer,
    pub(super) picture: Vec<[u8; 4]>,
}

impl std::fmt::Debug for Scratch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Scratch").finish_non_exhaustive()
    }
}
