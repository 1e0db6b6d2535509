//! Batches built from buffer objects, kept until the buffers change, so that the same draw gives
//! the same batch.

use crate::state::ArrayPointer;
use crate::vertex::VertexBatch;
use std::sync::Arc;

/// Which vertices a draw takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Vertices {
    /// In order.
    Range { first: usize, count: usize },
    /// By indices of a type, at an address (or offset in the buffer of that number), plus `base`.
    /// The index `restart` begins the primitive anew.
    Elements {
        count: usize,
        kind: u32,
        pointer: usize,
        buffer: u64,
        base: i32,
        restart: Option<u32>,
    },
}

/// Everything that a batch depends on.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Key {
    pub(super) mode: u32,
    pub(super) vertices: Vertices,
    /// Enabled arrays, with what they are for; their buffers are only marked, not kept.
    pub(super) arrays: Vec<(usize, ArrayPointer)>,
    /// Version of each buffer in use.
    pub(super) versions: Vec<u64>,
}

impl Key {
    /// Whether it is the same draw, perhaps from other data.
    pub(super) fn is_same_draw(&self, other: &Self) -> bool {
        self.mode == other.mode && self.vertices == other.vertices && self.arrays == other.arrays
    }

    pub(super) fn uses(&self, buffer: u64) -> bool {
        let element = matches!(self.vertices, Vertices::Elements { buffer: b, .. } if b == buffer);
        element || self.arrays.iter().any(|(_, array)| array.buffer.id() == buffer)
    }
}

/// How many batches are kept.
const ENTRIES: usize = 256;

/// How many vertices and indices they may have in all.
const VERTICES: usize = 1 << 21;

/// The batches, that used last at the end.
#[derive(Debug, Default)]
pub(super) struct Cache {
    entries: Vec<(Key, Arc<VertexBatch>)>,
    vertices: usize,
}

/// What a batch counts: vertices, and indices as far as they take memory.
pub(super) fn weight(batch: &VertexBatch) -> usize {
    batch.positions.len() + batch.indices.as_ref().map_or(0, Vec::len) / 8
}

impl Cache {
    /// The batch of a draw.
    pub(super) fn find(&mut self, key: &Key) -> Option<Arc<VertexBatch>> {
        let at = self.entries.iter().rposition(|(other, _)| other == key)?;
        let entry = self.entries.remove(at);
        let batch = entry.1.clone();
        self.entries.push(entry);
        Some(batch)
    }

    /// Keeps a batch, in place of that of the same draw from older data.
    pub(super) fn insert(&mut self, key: Key, batch: Arc<VertexBatch>) {
        self.remove_if(|other| other.is_same_draw(&key));
        self.vertices += weight(&batch);
        self.entries.push((key, batch));
        while self.entries.len() > ENTRIES || self.vertices > VERTICES && self.entries.len() > 1 {
            let (_, batch) = self.entries.remove(0);
            self.vertices -= weight(&batch);
        }
    }

    /// Drops what was built from a buffer.
    pub(super) fn forget(&mut self, buffer: u64) {
        self.remove_if(|key| key.uses(buffer));
    }

    fn remove_if(&mut self, condition: impl Fn(&Key) -> bool) {
        let vertices = &mut self.vertices;
        self.entries.retain(|(key, batch)| {
            let keep = !condition(key);
            if !keep {
                *vertices -= weight(batch);
            }
            keep
        });
    }
}
