//! What a piece's vertices were given with besides their attributes: parts of them with one
//! modelview matrix, and materials.

use super::piece::PieceVertices;
use super::snapshot::{Transform, VertexSnapshot};
use super::vertices::LaneFaces;
use crate::vertex::VertexBatch;
use std::borrow::Cow;
use std::ops::Range;
use vitral_math::lanes::LANES;

/// See the module.
pub(crate) struct TransformRanges<'a> {
    snapshot: &'a VertexSnapshot,
    batch: &'a VertexBatch,
    /// The materials, if all vertices of the batch have the same.
    faces: Option<LaneFaces>,
    /// How many vertices of the piece there are up to the end of each part, and its transform. None
    /// if all vertices of the batch have the matrix of the snapshot.
    parts: Vec<(usize, Transform)>,
}

impl<'a> TransformRanges<'a> {
    pub(crate) fn new(
        snapshot: &'a VertexSnapshot,
        batch: &'a VertexBatch,
        vertices: &PieceVertices,
    ) -> Self {
        let (mut parts, mut start) = (Vec::new(), 0);
        while start < vertices.len() {
            let vertex = vertices.get(start as u32);
            let Some((modelview, more)) = batch.modelview(vertex) else { break };
            start += vertices.below(start, vertex.saturating_add(more));
            parts.push((start, snapshot.transform_by(modelview)));
        }
        let faces =
            batch.materials.is_empty().then(|| LaneFaces::new(snapshot, batch, &[0; LANES]));
        Self { snapshot, batch, faces, parts }
    }

    /// The materials of eight vertices of the batch.
    pub(crate) fn faces(&self, vertices: &[u32; LANES]) -> Cow<'_, LaneFaces> {
        match &self.faces {
            Some(faces) => Cow::Borrowed(faces),
            None => Cow::Owned(LaneFaces::new(self.snapshot, self.batch, vertices)),
        }
    }

    /// Whether all vertices have the matrix of the snapshot.
    pub(crate) fn is_whole(&self) -> bool {
        self.parts.is_empty()
    }

    /// The vertices of each part, out of `count`.
    pub(crate) fn each(&self, count: usize) -> impl Iterator<Item = (Range<usize>, &Transform)> {
        let whole = self.is_whole().then_some((0..count, &self.snapshot.transform));
        let start = |i: usize| if i == 0 { 0 } else { self.parts[i - 1].0 };
        let parts = self.parts.iter().enumerate();
        whole.into_iter().chain(parts.map(move |(i, (end, transform))| (start(i)..*end, transform)))
    }

    /// The transform of a vertex of the piece, and up to which one it holds.
    pub(crate) fn at(&self, vertex: u32) -> (&Transform, u32) {
        let part = self.parts.partition_point(|(end, _)| *end <= vertex as usize);
        self.parts.get(part).map_or((&self.snapshot.transform, u32::MAX), |(end, transform)| {
            (transform, *end as u32)
        })
    }
}
