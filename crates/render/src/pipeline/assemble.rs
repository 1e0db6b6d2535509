//! Planes of the picture from the planes of its tiles.

use crate::Channels;
use crate::shading::{BufferPlanes, DataPlanes, Passes};
use std::sync::Mutex;
use vitral_exec::{Budget, Limit, Workers};
use vitral_frame::{Frame, Plane, TwoBuffers};
use vitral_raster::{TILE, Viewport};

/// Puts tiles together, several bands of them at a time.
#[derive(Clone, Copy)]
pub(super) struct Assembler<'a> {
    pub(super) viewport: Viewport,
    pub(super) workers: &'a Workers,
}

impl Assembler<'_> {
    /// One plane of the picture: `plane` gives that of a tile, row by row.
    fn plane<P: Send + Sync, T: Copy + Default + Send + Sync>(
        &self,
        tiles: &[Mutex<P>],
        plane: impl Fn(&P) -> &Vec<T> + Sync + Send,
    ) -> Option<Plane<T>> {
        let Viewport { width, height, .. } = self.viewport;
        let (row_length, tiles_x) = (width as usize, self.viewport.tiles_x() as usize);
        let mut out = vec![T::default(); row_length * height as usize];
        self.workers.for_each_chunk(&mut out, row_length * TILE, |band, rows| {
            for tx in 0..tiles_x {
                let tile = tiles[band * tiles_x + tx].lock().expect("finished tile");
                let plane = plane(&tile);
                let (x, count) = (tx * TILE, TILE.min(row_length - tx * TILE));
                for (y, row) in rows.chunks_mut(row_length).enumerate() {
                    row[x..x + count].copy_from_slice(&plane[y * TILE..y * TILE + count]);
                }
            }
        });
        Plane::from_rows(width, height, out)
    }

    /// The pictures after each pass, which `budget` has room for.
    pub(super) fn passes(
        &self,
        passes: &Passes,
        budget: &Budget,
    ) -> Result<Vec<Plane<[u8; 4]>>, Limit> {
        let count =
            passes.iter().map(|p| p.lock().expect("finished tile").len()).max().unwrap_or(0);
        let bytes =
            count as u64 * u64::from(self.viewport.width) * u64::from(self.viewport.height) * 4;
        budget.charge(bytes, "pictures after each pass")?;
        budget.release(bytes);
        // A tile that is done stays as it is.
        let after = |number: usize| {
            self.plane(passes, |tile: &Vec<Vec<[u8; 4]>>| {
                tile.get(number).or(tile.last()).expect("at least the opaque tile")
            })
        };
        Ok((0..count).filter_map(after).collect())
    }

    /// The two buffers from those of the tiles.
    pub(super) fn two_buffers(&self, tiles: &[Mutex<BufferPlanes>]) -> Option<TwoBuffers> {
        Some(TwoBuffers {
            opaque: self.plane(tiles, |t| &t.opaque)?,
            depth: self.plane(tiles, |t| &t.depth)?,
            layers: self.plane(tiles, |t| &t.layers)?,
            intensity: self.plane(tiles, |t| &t.intensity)?,
            coefficient: self.plane(tiles, |t| &t.coefficient)?,
        })
    }

    /// Sets the channels of data that are wanted.
    pub(super) fn data(&self, tiles: &[Mutex<DataPlanes>], wanted: Channels, frame: &mut Frame) {
        if wanted.depth {
            frame.depth = self.plane(tiles, |t| &t.depth);
        }
        if wanted.surface {
            frame.surface = self.plane(tiles, |t| &t.surface);
        }
        if wanted.object {
            frame.object = self.plane(tiles, |t| &t.object);
        }
        if wanted.material {
            frame.material = self.plane(tiles, |t| &t.material);
        }
        if wanted.normal {
            frame.normal = self.plane(tiles, |t| &t.normal);
        }
        if wanted.attached_shadow {
            frame.attached_shadow = self.plane(tiles, |t| &t.attached_shadow);
        }
        if wanted.cast_shadow {
            frame.cast_shadow = self.plane(tiles, |t| &t.cast_shadow);
        }
    }
}
