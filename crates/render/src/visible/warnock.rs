//! Warnock's area subdivision: a simple window is drawn, the rest is looked at in four
//! smaller windows.
//!
//! A polygon is to a window one of four things: disjoint, contained, intersecting, or surrounding
//! it. Four cases are simple. All polygons are disjoint: the window stays empty. One polygon is
//! left, contained or intersecting: it is drawn into the window. One polygon is left, and
//! surrounds: it fills the window. Several are left, but one that surrounds is nearer than all
//! others at the window's four corners, hence everywhere in it: it fills the window. Everything
//! else is put off: the window is cut in four. Disjoint polygons and those behind a surrounder are
//! not handed down, so lists become shorter; surrounders stay surrounders and need no further test.
//! A window of one pixel is not cut: the nearest facet at each of the pixel's samples is taken.
//!
//! The first window is the whole picture. Windows of several tiles are looked at first, all of one
//! size at once, then the tiles, each by one thread.
//!
//! In:   set-up triangles, joined to polygons (screen space). Out: the samples of each tile (screen
//!       space).
//! Cost: windows (about the length of visible edges in pixels) times the polygons in them.
//! Source: [Warnock 1969]. Departs from it: large windows are cut between tiles of 64x64 pixels,
//! nearest to their middle (`warnock/window.rs`); a window's corners are those of the box round its
//! samples. The four-corner test leaves a margin for rounding and reckons with the clamping of
//! depths, so that it never decides but what the facets' depth function would
//! (`warnock/depths.rs`); two facets with one depth plane are decided by their ids.

mod depths;
mod lists;
mod window;

use super::facets::{Facets, Fill, fill_with};
use super::polygons::{ConvexPolygon, Polygons};
use super::sink::TileSink;
use super::tiles::put;
use super::{Resolved, VisibleSurface};
use crate::marks::Marks;
use crate::stats::VisibilityCounters;
use crate::{Execution, PreparedView};
use lists::{Entry, Lists};
use std::ops::Range;
use std::sync::Arc;
use vitral_exec::{Charge, Limit};
use vitral_raster::{SUBPIXEL, SamplePattern, TILE, TILE_PIXELS, Tile, TileGrid};
use window::{Window, WindowRelation};

/// See the module.
#[derive(Clone, Copy, Debug)]
pub struct Warnock;

impl VisibleSurface for Warnock {
    fn resolve(
        &self,
        view: &PreparedView<'_>,
        marks: Option<&Marks>,
        grid: &mut TileGrid,
        execution: &Execution,
        sink: &dyn TileSink,
    ) -> Result<Resolved, Limit> {
        // Set up the facets and join them to polygons.
        let mut resolved = Resolved::default();
        let facets = Facets::new(view, execution, &mut resolved)?;
        let polygons = Polygons::new(facets.opaque(), view);
        let bytes = polygons.bytes() + (polygons.len() * BYTES_A_POLYGON) as u64;

        // Divide the picture down to tiles, then finish each tile on a thread.
        resolved.counters = execution.budget.charged(bytes, STAGE, || {
            let lists = Charge::new(&execution.budget, STAGE);
            let Divided { tiles, mut counters } = Divided::new(&facets, &polygons, &lists)?;
            let fill: &Fill<'_> = &|facets, index, tile, counters| {
                let Some(work) = &tiles[index] else { return Ok(()) };
                Subdivision::new(facets, &polygons, &mut tile[0], counters, work).run(work)
            };
            counters.add(&fill_with(&facets, marks, grid, sink, 1, fill, None)?);
            Ok(counters)
        })?;
        Ok(resolved)
    }
}

/// The stage, for the budget.
const STAGE: &str = "area subdivision";

/// A polygon's entries on the lists of windows that are being looked at.
const BYTES_A_POLYGON: usize = 7 * size_of::<Entry>();

/// What is left to do in a tile.
struct TileWork {
    /// The tile's pixels in the picture.
    window: Window,
    task: Task,
}

/// How far a tile's window, or a larger one that it is part of, is decided.
enum Task {
    /// One polygon is drawn into it.
    Draw(Entry),
    /// It is looked at, with the list of the window that it is a part of.
    LookAt(Arc<[Entry]>),
}

/// The picture, divided among the tiles.
struct Divided {
    /// What is left to do in each; nothing in those that no polygon is in.
    tiles: Vec<Option<TileWork>>,
    counters: VisibilityCounters,
}

impl Divided {
    /// Looks at the windows of several tiles, from the whole picture down. What the lists take is
    /// charged to `memory`.
    fn new(
        facets: &Facets<'_, '_>,
        polygons: &Polygons<'_>,
        memory: &Charge<'_>,
    ) -> Result<Self, Limit> {
        // Begin with the whole picture and all polygons.
        let view = facets.view();
        // Of the facets of a single tile no list of a larger window can be told.
        let observer = facets.execution().observer.clone().filter(|_| view.makes_all_tiles());
        let execution = &Execution { observer, ..facets.execution().clone() };
        let tiles = (0..view.viewport.tiles_x() * view.viewport.tiles_y()).map(|_| None).collect();
        let mut divided = Self { tiles, counters: VisibilityCounters::default() };
        let all = (0..polygons.len() as u32)
            .map(|polygon| Entry { polygon, relation: WindowRelation::Intersecting });
        let whole = Window::whole(view.viewport.width, view.viewport.height);
        let mut level: Vec<(Window, Arc<[Entry]>)> = vec![(whole, all.collect())];
        while !level.is_empty() {
            // Windows of single tiles are looked at with the tile.
            let (single, several): (Vec<_>, Vec<_>) =
                level.into_iter().partition(|(window, _)| window.is_in_tile());
            for (window, list) in single {
                let index = tile_of(&window, view);
                divided.tiles[index] = Some(TileWork { window, task: Task::LookAt(list) });
            }

            // Look at the others, and cut those that are not simple.
            execution.budget.check(STAGE)?;
            let looked_at = execution.workers.map(several.len(), |i| {
                let (window, list) = &several[i];
                let mut lists = Lists::new(view, execution, polygons, list);
                let start = lists.look_at(window, 0..list.len());
                (lists.own(start), lists.counters)
            });
            level = Vec::new();

            // Draw windows with one polygon, and queue the parts of the others.
            for ((window, _), (own, counted)) in several.into_iter().zip(looked_at) {
                divided.counters.add(&counted);
                match own[..] {
                    [] => {}
                    [only] => divided.draw_in_tiles(window, only, view),
                    _ => {
                        memory.add(size_of_val(own.as_slice()) as u64)?;
                        let own: Arc<[Entry]> = own.into();
                        let parts = window.parts().into_iter().filter(|part| is_wanted(part, view));
                        level.extend(parts.map(|part| (part, Arc::clone(&own))));
                    }
                }
            }
        }
        Ok(divided)
    }

    /// A window of several tiles is simple: each draws its part of it.
    fn draw_in_tiles(&mut self, window: Window, entry: Entry, view: &PreparedView<'_>) {
        let mut open = vec![window];
        while let Some(window) = open.pop() {
            if window.is_in_tile() {
                let index = tile_of(&window, view);
                self.tiles[index] = Some(TileWork { window, task: Task::Draw(entry) });
            } else {
                open.extend(window.parts());
            }
        }
    }
}

/// The number of the tile that a window lies in.
fn tile_of(window: &Window, view: &PreparedView<'_>) -> usize {
    let [column, row] = [window.x.start, window.y.start].map(|at| at / TILE as u32);
    (row * view.viewport.tiles_x() + column) as usize
}

/// Whether a tile in the window is made.
fn is_wanted(window: &Window, view: &PreparedView<'_>) -> bool {
    let tiles = |pixels: &Range<u32>| pixels.start / TILE as u32..pixels.end.div_ceil(TILE as u32);
    let columns = view.viewport.tiles_x();
    tiles(&window.y).any(|row| {
        tiles(&window.x).any(|column| view.makes_tile((row * columns + column) as usize))
    })
}

/// The subdivision of one tile.
struct Subdivision<'t, 'f> {
    execution: &'f Execution,
    pattern: &'f SamplePattern,
    polygons: &'f Polygons<'f>,
    lists: Lists<'f>,
    tile: &'t mut Tile,
    counters: &'t mut VisibilityCounters,
}

impl<'t, 'f> Subdivision<'t, 'f> {
    fn new(
        facets: &'f Facets<'_, '_>,
        polygons: &'f Polygons<'f>,
        tile: &'t mut Tile,
        counters: &'t mut VisibilityCounters,
        work: &TileWork,
    ) -> Self {
        let first: &[Entry] = match &work.task {
            Task::Draw(_) => &[],
            Task::LookAt(list) => list,
        };
        let lists = Lists::new(facets.view(), facets.execution(), polygons, first);
        Self {
            execution: facets.execution(),
            pattern: &facets.view().pattern,
            polygons,
            lists,
            tile,
            counters,
        }
    }

    /// Draws what is seen in the tile.
    fn run(&mut self, work: &TileWork) -> Result<(), Limit> {
        let done = match &work.task {
            Task::Draw(entry) => {
                self.draw(&work.window, *entry);
                Ok(())
            }
            Task::LookAt(list) => self.window(&work.window, 0..list.len()),
        };
        self.counters.add(&self.lists.counters);
        done
    }

    /// Draws what is seen in a window, of the polygons at `list`.
    fn window(&mut self, window: &Window, list: Range<usize>) -> Result<(), Limit> {
        if self.lists.counters.windows % 1024 == 1 {
            self.execution.budget.check(STAGE)?;
        }

        // Draw the simple cases; cut the window otherwise.
        let start = self.lists.look_at(window, list);
        let result = match *self.lists.from(start) {
            [] => Ok(()),
            [only] => {
                self.draw(window, only);
                Ok(())
            }
            _ if window.is_pixel() => {
                self.draw_nearest(window, start);
                Ok(())
            }
            _ => {
                let own = start..start + self.lists.from(start).len();
                window.parts().iter().try_for_each(|part| self.window(part, own.clone()))
            }
        };
        self.lists.leave(start);
        result
    }

    /// Fills a window with a surrounder, or draws the one polygon in it.
    fn draw(&mut self, window: &Window, entry: Entry) {
        let polygon = self.polygons.get(entry.polygon as usize);
        for s in 0..self.pattern.len() {
            for row in window.y.clone() {
                for column in window.x.clone() {
                    let [x, y] = sample(self.pattern, [column, row], s);
                    if let Some(facet) = facet_at(polygon, entry, [x, y]) {
                        put(
                            self.tile,
                            place(self.tile, [column, row], s),
                            (polygon.depth(x, y), facet),
                        );
                    }
                }
            }
        }
    }

    /// Takes the nearest facet at each sample of a window of one pixel.
    fn draw_nearest(&mut self, window: &Window, start: usize) {
        let pixel = [window.x.start, window.y.start];
        for s in 0..self.pattern.len() {
            let seen = self.lists.nearest(start, sample(self.pattern, pixel, s));
            if let Some(seen) = seen {
                put(self.tile, place(self.tile, pixel, s), seen);
            }
        }
    }
}

/// Where sample `s` of a pixel lies in the picture, 1/256 pixel.
fn sample(pattern: &SamplePattern, [column, row]: [u32; 2], s: usize) -> [i32; 2] {
    let [x, y] = pattern.position(s);
    [column as i32 * SUBPIXEL + x, row as i32 * SUBPIXEL + y]
}

/// Index of sample `s` of a pixel of the picture in its tile's planes.
fn place(tile: &Tile, [column, row]: [u32; 2], s: usize) -> usize {
    s * TILE_PIXELS + (row - tile.y) as usize * TILE + (column - tile.x) as usize
}

/// The facet of a polygon at a sample, if it covers it, as a surrounder does.
fn facet_at(polygon: ConvexPolygon<'_, '_>, entry: Entry, [x, y]: [i32; 2]) -> Option<u32> {
    match entry.relation {
        WindowRelation::Surrounding => Some(polygon.facet_within(x, y)),
        _ => polygon.facet_at(x, y),
    }
}
