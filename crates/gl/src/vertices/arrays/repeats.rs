//! Draws from the client's own memory that are repeated: programs without buffer objects give the
//! same arrays frame after frame.
//!
//! What lies there may change without a word, so each draw takes a fingerprint of all bytes that it
//! would read. One with the fingerprint of the time before gets a batch that is kept from then on,
//! and with it all that was found out about it. Draws that keep changing are seldom asked.

use super::cache::{Key, Vertices};
use super::draw::build;
use super::fetch::{Reader, Refusal, Run};
use crate::vertex::VertexBatch;
use std::sync::Arc;
use vitral_math::Fingerprint;

/// Vertices or indices from which on a draw is compared with earlier ones: smaller ones are read
/// faster than compared.
const MIN_COUNT: usize = 1 << 10;

/// How many draws are known.
const ENTRIES: usize = 64;

/// How many vertices the batches that are kept may have in all.
const VERTICES: usize = 1 << 20;

/// Changes without a repeat after which a draw is compared only every [`RETRY_INTERVAL`] times.
const MAX_CHANGES: u32 = 4;

/// Draws between two comparisons of a draw that keeps changing.
const RETRY_INTERVAL: u32 = 16;

/// The draws, that seen last at the end.
#[derive(Debug, Default)]
pub(super) struct Repeats {
    entries: Vec<Entry>,
}

/// A draw and what it read the last time it was asked.
#[derive(Debug)]
struct Entry {
    key: Key,
    indices: Option<Fingerprint>,
    elements: Option<Fingerprint>,
    /// The elements that its indices name.
    runs: Vec<Run>,
    /// Kept once the draw was repeated.
    batch: Option<Arc<VertexBatch>>,
    /// How often it was there.
    draws: u32,
    /// How often it was not what it had been, since it was.
    changes: u32,
}

impl Entry {
    fn new(key: Key) -> Self {
        Self {
            key,
            indices: None,
            elements: None,
            runs: Vec::new(),
            batch: None,
            draws: 0,
            changes: 0,
        }
    }

    /// Whether a draw would read what it read when this was made.
    fn is_unchanged(&self, key: &Key, indices: Option<Fingerprint>, reader: &Reader) -> bool {
        self.key.versions == key.versions
            && self.indices == indices
            && self.elements.is_some()
            && self.elements == reader.fingerprint(&key.arrays, &self.runs)
    }

    fn weight(&self) -> usize {
        self.batch.as_deref().map_or(0, super::cache::weight)
    }
}

impl Repeats {
    /// The batch of a draw of which something lies in the client's memory.
    pub(super) fn batch(&mut self, reader: &Reader, key: Key) -> Result<Arc<VertexBatch>, Refusal> {
        let built = || build(reader, &key.arrays, key.mode, key.vertices);

        // Build small batches without comparison.
        let (Vertices::Range { count, .. } | Vertices::Elements { count, .. }) = key.vertices;
        if count < MIN_COUNT {
            return Ok(Arc::new(built()?.0));
        }

        // Find the draw's entry; stop comparing draws that change every time.
        let known = self.entries.iter().rposition(|entry| entry.key.is_same_draw(&key));
        let mut entry = known.map_or_else(|| Entry::new(key.clone()), |at| self.entries.remove(at));
        entry.draws = entry.draws.wrapping_add(1);
        if entry.changes >= MAX_CHANGES && !entry.draws.is_multiple_of(RETRY_INTERVAL) {
            self.entries.push(entry);
            return Ok(Arc::new(built()?.0));
        }

        // Reuse the batch if neither indices nor elements have changed.
        let indices = reader.index_fingerprint(key.vertices);
        let unchanged = entry.is_unchanged(&key, indices, reader);
        if unchanged && let Some(batch) = entry.batch.clone() {
            self.entries.push(entry);
            return Ok(batch);
        }

        // Otherwise build it and note the fingerprints.
        let (batch, runs) = built()?;
        let batch = Arc::new(batch);
        if unchanged {
            (entry.batch, entry.changes) = (Some(batch.clone()), 0);
        } else {
            entry.elements = reader.fingerprint(&key.arrays, &runs);
            (entry.batch, entry.changes) = (None, entry.changes.saturating_add(1));
            (entry.key, entry.indices, entry.runs) = (key, indices, runs);
        }
        self.entries.push(entry);
        self.trim();
        Ok(batch)
    }

    /// Forgets what was seen longest ago.
    fn trim(&mut self) {
        let mut vertices = 0;
        let weights = self.entries.iter().rev().map(Entry::weight);
        let fitting = weights.take_while(|weight| {
            vertices += weight;
            vertices <= VERTICES
        });
        // The last one may stay however large it is.
        let kept = fitting.take(ENTRIES).count().max(1);
        self.entries.drain(..self.entries.len().saturating_sub(kept));
    }

    /// Drops what was built from a buffer.
    pub(super) fn forget(&mut self, buffer: u64) {
        self.entries.retain(|entry| !entry.key.uses(buffer));
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::tests::{BASE, context};
    use super::*;
    use crate::{Context, enums};

    const COUNT: usize = MIN_COUNT + 8;

    /// Draws triangles from `COUNT` positions, by indices if `indexed`; gives the batch.
    fn draw(c: &mut Context, indexed: bool) -> Arc<VertexBatch> {
        let count = COUNT as i32;
        if indexed {
            c.draw_elements(enums::TRIANGLES, count, enums::UNSIGNED_SHORT, BASE + 0x8000);
        } else {
            c.draw_arrays(enums::TRIANGLES, 0, count);
        }
        assert_eq!(c.error, 0);
        c.builder.log.pop().unwrap()
    }

    fn with_arrays() -> Context {
        let mut c = context();
        let positions: Vec<[f32; 3]> = (0..COUNT).map(|i| [i as f32, 1.0, 2.0]).collect();
        let indices: Vec<u16> = (0..COUNT as u16).rev().collect();
        c.memory.write(BASE, bytemuck::cast_slice(&positions));
        c.memory.write(BASE + 0x8000, bytemuck::cast_slice(&indices));
        c.vertex_pointer(3, enums::FLOAT, 0, BASE);
        c.enable_client_state(enums::VERTEX_ARRAY);
        c
    }

    #[test]
    fn the_second_repeat_is_the_same_batch_until_a_byte_changes() {
        for indexed in [false, true] {
            let mut c = with_arrays();
            let batches: Vec<_> = (0..4).map(|_| draw(&mut c, indexed)).collect();
            assert!(
                !Arc::ptr_eq(&batches[0], &batches[1]) && Arc::ptr_eq(&batches[1], &batches[3])
            );
            assert_eq!(batches[0], batches[1]);
            // The last number that is read, then the last index.
            let last = BASE + 12 * COUNT - 4;
            c.memory.write(last, &7.0f32.to_ne_bytes());
            let changed = draw(&mut c, indexed);
            assert_eq!(changed.positions[COUNT - 1], [(COUNT - 1) as f32, 1.0, 7.0, 1.0]);
            if indexed {
                c.memory.write(BASE + 0x8000 + 2 * COUNT - 2, &5u16.to_ne_bytes());
                // Number 0 is used no more, so all come one earlier.
                let other = draw(&mut c, true);
                assert_eq!((other.positions.len(), other.positions[0][0]), (COUNT - 1, 1.0));
                assert_eq!(other.indices.as_ref().unwrap().last(), Some(&4));
            }
        }
    }

    #[test]
    fn what_is_not_read_may_change() {
        let mut c = with_arrays();
        let batches: Vec<_> = (0..3).map(|_| draw(&mut c, false)).collect();
        c.memory.write(BASE + 12 * COUNT, &[1, 2, 3]);
        assert!(Arc::ptr_eq(&batches[2], &draw(&mut c, false)));
        // Another mode is another draw.
        c.draw_arrays(enums::POINTS, 0, COUNT as i32);
        let points = c.builder.log.pop().unwrap();
        assert_eq!((points.primitives[0].mode, points.positions.len()), (enums::POINTS, COUNT));
    }

    #[test]
    fn restless_draws_are_right_and_come_to_rest() {
        let mut c = with_arrays();
        for i in 0..40 {
            let x = 100.0 + i as f32;
            c.memory.write(BASE, &x.to_ne_bytes());
            assert_eq!(draw(&mut c, false).positions[0][0], x);
        }
        assert!(c.arrays.repeats.entries[0].changes >= MAX_CHANGES);
        let batches: Vec<_> = (0..3 * RETRY_INTERVAL).map(|_| draw(&mut c, false)).collect();
        assert!(Arc::ptr_eq(&batches[batches.len() - 1], &batches[batches.len() - 2]));
        assert_eq!(batches[0], batches[batches.len() - 1]);
    }

    #[test]
    fn a_buffer_beside_the_clients_memory_counts_too() {
        let mut c = with_arrays();
        c.bind_buffer(enums::ARRAY_BUFFER, 1);
        c.buffer_data(enums::ARRAY_BUFFER, 12 * COUNT as isize, BASE, enums::STATIC_DRAW);
        c.normal_pointer(enums::FLOAT, 0, 0);
        c.enable_client_state(enums::NORMAL_ARRAY);
        // Without it no normals are read.
        c.enable(enums::LIGHTING);
        let batches: Vec<_> = (0..3).map(|_| draw(&mut c, false)).collect();
        assert!(Arc::ptr_eq(&batches[1], &batches[2]));
        c.buffer_sub_data(enums::ARRAY_BUFFER, 0, 4, BASE + 4);
        assert_eq!(draw(&mut c, false).normals.as_ref().unwrap()[0], [1.0, 1.0, 2.0]);
        c.memory.write(BASE + 0x9000, &1u32.to_ne_bytes());
        c.delete_buffers(1, BASE + 0x9000);
        assert!(c.arrays.repeats.entries.is_empty());
    }

    #[test]
    fn few_are_kept() {
        let mut c = with_arrays();
        for first in 0..2 * ENTRIES {
            for _ in 0..2 {
                c.draw_arrays(
                    enums::POINTS,
                    (first % 4) as i32,
                    (MIN_COUNT + first / 4 % 4) as i32,
                );
                c.vertex_pointer(3, enums::FLOAT, 0, BASE + 4 * (first / 16));
            }
        }
        assert!((2..=ENTRIES).contains(&c.arrays.repeats.entries.len()));
    }
}
