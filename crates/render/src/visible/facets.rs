//! All facets of a view at once, for algorithms that look at several facets before they decide.
//!
//! The z-buffer takes triangles a few hundred thousand at a time and forgets them; algorithms that sort, subdivide or
//! sweep need them together. Here all draws of a view are brought to the screen and set up, opaque ones apart from the
//! layers, with their lists by tile and by row of tiles. The frame of such an algorithm is the same each time, too: fill
//! some tiles with opaque facets, collect the layers and marks in front, hand the tiles on ([`fill_tiles`]).
//!
//! In:   prepared draws (model space). Out: set-up triangles (screen space).
//! Cost: linear in vertices and triangles; memory: all triangles, charged to the budget before they are set up.

use super::zbuffer::hide_behind;
use super::zbuffer::{jobs, retire_vertices, rounds, set_up, transform_vertices, walk};
use super::{Peel, Resolved, TileSink};
use crate::marks::Marks;
use crate::stats::VisibilityCounters;
use crate::{Execution, PreparedView};
use std::sync::{Mutex, OnceLock};
use vitral_exec::Limit;
use vitral_raster::{Batch, LayerList, SUBPIXEL, SamplePattern, ScreenVertex, Setup, TILE, Tile, TileGrid, TileLists};

/// Bytes of a triangle: its setup, its entry in a tile's list, and what becomes of that when the lists are sorted.
pub(super) const BYTES_A_TRIANGLE: u64 = size_of::<Setup>() as u64 + 16;

/// The set-up triangles of a view. A facet that was clipped has several, with one depth plane.
pub(super) struct Facets<'v, 'a> {
    view: &'v PreparedView<'a>,
    execution: &'v Execution,
    opaque: Vec<Batch>,
    layered: Vec<Batch>,
    /// For each row of tiles the opaque triangles that may have samples in it: batch and index in the batch. Once asked.
    rows: OnceLock<Vec<Vec<[u32; 2]>>>,
    charged: u64,
}

impl<'v, 'a> Facets<'v, 'a> {
    /// Brings the view's triangles to the screen, and counts that in `resolved`.
    pub(super) fn new(
        view: &'v PreparedView<'a>,
        execution: &'v Execution,
        resolved: &mut Resolved,
    ) -> Result<Self, Limit> {
        let start = execution.budget.elapsed();
        let draws = view.instances.iter().flat_map(|i| i.opaque.iter().chain(&i.layered));
        let triangles: u64 = draws.flat_map(|d| &d.ranges).map(|r| u64::from(r.end - r.start)).sum();
        let charged = triangles * BYTES_A_TRIANGLE;
        execution.budget.charge(charged, "the view's facets")?;
        let rows = OnceLock::new();
        let mut facets = Self { view, execution, opaque: Vec::new(), layered: Vec::new(), rows, charged };
        let jobs = jobs(view);
        let mut vertices: Vec<Vec<ScreenVertex>> = view.instances.iter().map(|_| Vec::new()).collect();
        for round in rounds(&jobs) {
            execution.budget.check("the view's facets")?;
            let jobs = &jobs[round];
            transform_vertices(view, jobs, &mut vertices, execution, &mut resolved.geometry);
            for (layered, batch) in set_up(view, jobs, &vertices, TileLists::Kept, execution) {
                resolved.geometry.add(&batch.counters);
                let list = if layered { &mut facets.layered } else { &mut facets.opaque };
                list.push(batch);
            }
            retire_vertices(view, jobs, &mut vertices);
        }
        let mut spare = view.session.spare_vertices.lock().expect("spare vertices");
        spare.extend(vertices.into_iter().filter(|v| v.capacity() > 0));
        drop(spare);
        resolved.geometry_seconds = execution.budget.elapsed() - start;
        Ok(facets)
    }

    /// Lists the opaque triangles by the rows of tiles that their box touches.
    fn sort_by_row(&self) -> Vec<Vec<[u32; 2]>> {
        let tile_rows = self.view.viewport.tiles_y() as i32;
        let mut rows = vec![Vec::new(); tile_rows as usize];
        // A sample lies below the top of its pixel and above its bottom: the tile of its y is the tile of its pixel.
        let row = |y: i32| y.div_euclid(TILE as i32 * SUBPIXEL);
        for (b, batch) in self.opaque.iter().enumerate() {
            for (i, setup) in batch.setups().iter().enumerate() {
                let [y0, y1, y2] = setup.y;
                let (first, last) = (row(y0.min(y1).min(y2)).max(0), row(y0.max(y1).max(y2)).min(tile_rows - 1));
                for r in first..=last {
                    rows[r as usize].push([b as u32, i as u32]);
                }
            }
        }
        rows
    }

    /// The opaque triangles that may have samples in a row of tiles.
    pub(super) fn in_row(&self, row: usize) -> impl ExactSizeIterator<Item = &Setup> {
        let rows = self.rows.get_or_init(|| self.sort_by_row());
        rows[row].iter().map(|&[batch, index]| &self.opaque[batch as usize].setups()[index as usize])
    }

    /// The opaque triangles that touch a tile.
    pub(super) fn in_tile(&self, tile: usize) -> impl Iterator<Item = &Setup> {
        self.opaque.iter().flat_map(move |batch| batch.tile(tile))
    }

    /// All opaque triangles; those of a clipped facet follow one another.
    pub(super) fn opaque(&self) -> Vec<&Setup> {
        self.opaque.iter().flat_map(Batch::setups).collect()
    }

    /// All layers, where they are to be drawn by a list; none elsewhere.
    pub(super) fn listed_layers(&self) -> impl Iterator<Item = &Setup> {
        self.layered.iter().filter(|_| self.view.lists_layers).flat_map(Batch::setups)
    }

    /// The view.
    pub(super) fn view(&self) -> &'v PreparedView<'a> {
        self.view
    }

    /// Limits and threads.
    pub(super) fn execution(&self) -> &'v Execution {
        self.execution
    }

    /// Collects what lies in front of a tile's finished opaque samples, and hands the tile on.
    fn finish(
        &self,
        index: usize,
        tile: &mut Tile,
        marks: Option<&Marks>,
        sink: &dyn TileSink,
        collect: Option<&Collect<'_>>,
    ) {
        let (level, pattern) = (self.execution.level, &self.view.pattern);
        if let Some(marks) = marks {
            hide_behind(level, &marks.hiding, index, tile, pattern);
        }
        let all = marks.map(|m| &m.all);
        if sink.takes_passes() {
            let batches = self.layered.iter().chain(all);
            let go_on = || self.execution.budget.check("passes over layers").is_ok();
            let mut pass = |peel: &mut Peel| go_on() && peel.pass(level, batches.clone(), index, tile, pattern);
            return sink.tile_in_passes(index, tile, &mut pass);
        }
        let mut layers = self.view.layer_list_for(sink);
        let mut layered = self.layered.as_slice();
        if let Some(collect) = collect.filter(|_| self.view.lists_layers) {
            collect(self, index, tile, &mut layers);
            layered = &[];
        }
        let in_front: Vec<_> = layered.iter().chain(all).map(|batch| (true, batch)).collect();
        walk(level, &in_front, index, tile, pattern, &mut layers);
        layers.finish();
        sink.tile(index, tile, &mut layers);
    }
}

impl Drop for Facets<'_, '_> {
    fn drop(&mut self) {
        let batches = self.opaque.drain(..).chain(self.layered.drain(..));
        if let Ok(mut spare) = self.view.session.spare_batches.lock() {
            spare.extend(batches);
        }
        self.execution.budget.release(self.charged);
    }
}

/// Collects the layers in front of a tile's finished opaque samples, from back to front.
pub(super) type Collect<'f> = dyn Fn(&Facets<'_, '_>, usize, &Tile, &mut LayerList) + Sync + Send + 'f;

/// Fills tiles with opaque facets: all facets, index of the first tile, the tiles (empty), counters.
pub(super) type Fill<'f> =
    dyn Fn(&Facets<'_, '_>, usize, &mut [Tile], &mut VisibilityCounters) -> Result<(), Limit> + Sync + 'f;

/// Calls `fill` for each `chunk` tiles, on all threads, and hands the tiles on.
pub(super) fn fill_tiles(
    view: &PreparedView<'_>,
    marks: Option<&Marks>,
    grid: &mut TileGrid,
    execution: &Execution,
    sink: &dyn TileSink,
    chunk: usize,
    fill: &Fill<'_>,
) -> Result<Resolved, Limit> {
    let mut resolved = Resolved::default();
    let facets = Facets::new(view, execution, &mut resolved)?;
    resolved.counters = fill_with(&facets, marks, grid, sink, chunk, fill, None)?;
    Ok(resolved)
}

/// [`fill_tiles`], of facets that are on the screen already; `collect` takes the layers by a list, if there is one.
pub(super) fn fill_with(
    facets: &Facets<'_, '_>,
    marks: Option<&Marks>,
    grid: &mut TileGrid,
    sink: &dyn TileSink,
    chunk: usize,
    fill: &Fill<'_>,
    collect: Option<&Collect<'_>>,
) -> Result<VisibilityCounters, Limit> {
    let outcome = Mutex::new(Ok(VisibilityCounters::default()));
    facets.execution.budget.begin("tiles", grid.tiles.len() as u64);
    facets.execution.workers.for_each_chunk(&mut grid.tiles, chunk, |piece, tiles| {
        // After a limit, the rest of the pieces are passed over.
        if outcome.lock().expect("no thread panics while it counts").is_err() {
            return;
        }
        tiles.iter_mut().for_each(Tile::clear);
        let (first, mut counters) = (piece * chunk, VisibilityCounters::default());
        let filled = fill(facets, first, tiles, &mut counters);
        if filled.is_ok() {
            for (i, tile) in tiles.iter_mut().enumerate() {
                facets.finish(first + i, tile, marks, sink, collect);
                facets.execution.budget.advance();
            }
        }
        let mut outcome = outcome.lock().expect("no thread panics while it counts");
        match filled {
            Ok(()) => {
                if let Ok(sum) = &mut *outcome {
                    sum.add(&counters);
                }
            }
            Err(limit) if outcome.is_ok() => *outcome = Err(limit),
            Err(_) => {}
        }
    });
    if sink.takes_passes() {
        // Passes end early at a limit.
        facets.execution.budget.check("passes over layers")?;
    }
    outcome.into_inner().expect("no thread panics while it counts")
}

/// Smallest and largest x, then y, of a pattern's samples within the pixel.
pub(super) fn extent(pattern: &SamplePattern) -> [[i32; 2]; 2] {
    [0, 1].map(|axis| {
        let values = (0..pattern.len()).map(|s| pattern.position(s)[axis]);
        values.fold([i32::MAX, i32::MIN], |[low, high], v| [low.min(v), high.max(v)])
    })
}

/// Whether depth `a` of facet `fa` hides depth `b` of facet `fb` at one sample: the law of agreement.
#[inline]
pub(crate) fn nearer((a, fa): (f32, u32), (b, fb): (f32, u32)) -> bool {
    a > b || (a == b && fa < fb)
}

/// Puts a facet into a sample, `at` its index in the tile's planes.
#[inline]
pub(super) fn put(tile: &mut Tile, at: usize, (depth, facet): (f32, u32)) {
    tile.depth[at] = depth;
    tile.facet[at] = facet;
    tile.touched = true;
}
