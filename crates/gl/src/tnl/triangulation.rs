//! What a batch draws when polygons are filled: triangles in pieces. Each is made when it is first
//! drawn, and kept with the batch.

use super::grid::Grid;
use super::piece::{PIECE_TRIANGLES, Piece};
use crate::primitive::Primitive;
use std::ops::Range;
use std::sync::{Arc, OnceLock};

/// All triangles of a batch.
#[derive(Debug)]
pub(crate) struct Triangulation {
    /// Each made by the thread that first draws it.
    pub(super) pieces: Vec<OnceLock<Piece>>,
    /// For each primitive, how many triangles those before it have; then how many there are.
    pub(super) starts: Vec<u32>,
    /// Whether there are points or lines.
    pub others: bool,
    /// Whether there are points.
    pub points: bool,
    /// The flat grid that all triangles form, if they do.
    pub grid: Option<Grid>,
    /// All primitives in parts, for draws that are not only filled triangles: without a stipple
    /// along lines, with one.
    pub(super) ordered: [OnceLock<Vec<Vec<Primitive>>>; 2],
}

/// The cached `Triangulation` of a batch, no part of the batch's value: copies start without.
#[derive(Default)]
pub struct TriangulationCell(OnceLock<Arc<Triangulation>>);

impl TriangulationCell {
    /// The cached triangulation; made by `make` if there is none.
    pub(super) fn get_or_make(&self, make: impl FnOnce() -> Triangulation) -> Arc<Triangulation> {
        self.0.get_or_init(|| Arc::new(make())).clone()
    }
}

impl std::fmt::Debug for TriangulationCell {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("TriangulationCell")
    }
}

impl Clone for TriangulationCell {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl PartialEq for TriangulationCell {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Triangulation {
    /// How many pieces there are.
    pub(crate) fn len(&self) -> usize {
        self.pieces.len()
    }

    /// The triangles of a piece, by their numbers.
    pub(super) fn range(&self, piece: usize) -> Range<u32> {
        let count = self.starts.last().copied().unwrap_or(0);
        let first = (piece * PIECE_TRIANGLES) as u32;
        first..count.min(first + PIECE_TRIANGLES as u32)
    }

    /// How many triangles piece number `piece` has.
    pub(crate) fn weight(&self, piece: usize) -> usize {
        self.range(piece).len()
    }
}
