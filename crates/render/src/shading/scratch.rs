//! Memory for the shading of a tile, which finished tiles leave to the next.

use super::composite::Composer;
use super::facets::FacetTable;
use super::points::Points;
use super::shaded_points::ShadedPoints;
use crate::{Cached, Reuse, Session};
use std::convert::Infallible;
use std::sync::{Arc, Mutex};

/// Memory of one tile's work, reused for the next tile.
#[derive(Default)]
pub(crate) struct Scratch {
    pub(super) points: Points,
    pub(super) facets: FacetTable,
    pub(super) lit: ShadedPoints,
    pub(super) composer: Composer,
    pub(super) picture: Vec<[u8; 4]>,
}

/// The session's scratch memory that no tile uses.
#[derive(Default)]
pub(super) struct SpareScratch(Mutex<Vec<Scratch>>);

impl Cached for SpareScratch {
    type Key = ();
    const REUSE: Reuse = Reuse::Session;
    const PLACED: bool = false;
}

impl SpareScratch {
    /// The session's.
    pub(super) fn of(session: &Session) -> Arc<Self> {
        let Ok(spare) = session.cache.get_or_build((), || Ok::<_, Infallible>(Self::default()));
        spare
    }

    /// Memory for a tile.
    pub(super) fn take(&self) -> Scratch {
        self.0.lock().expect("spare scratch").pop().unwrap_or_default()
    }

    /// Takes back the memory of a finished tile.
    pub(super) fn give_back(&self, scratch: Scratch) {
        self.0.lock().expect("spare scratch").push(scratch);
    }
}

impl std::fmt::Debug for Scratch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Scratch").finish_non_exhaustive()
    }
}
