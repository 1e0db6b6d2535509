//! From draws to tiles: vertices to the screen, triangles culled, clipped, set up and sorted into
//! the tiles they touch.
//!
//! In:   [`Draw`]s: a mesh's positions and triangles, and the matrix from its model space to clip
//!       space.
//! Out:  [`Batch`]es of [`Setup`]s with a list for each tile.
//! Cost: linear in vertices and triangles, plus one list entry for each tile that a triangle
//!       touches.

use crate::clip::{Polygon, clip};
use crate::kernel::sift::{Sieve, sift};
use crate::screen::covered_pixels;
pub use crate::screen::{Screen, ScreenVertex, ViewportTransform, flag};
use crate::setup::{CornerPosition, DepthPlane, Setup, SharedPlane};
use crate::{SUBPIXEL, TILE, Viewport};
use bytemuck::Zeroable;
use std::ops::Range;
use vitral_math::lanes::{LANES, Level, Simd, dispatch};
use vitral_math::{Mat4, Vec4};

/// What becomes of triangles whose corners run clockwise as the viewer sees them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BackFaces<'a> {
    /// They are drawn.
    Kept,
    /// They are dropped.
    Dropped,
    /// They are dropped if bit `t % 32` of word `t / 32` is set for triangle `t`.
    DroppedOf(&'a [u32]),
}

impl BackFaces<'_> {
    /// Whether a triangle is dropped if it faces away.
    pub fn drops(self, triangle: u32) -> bool {
        self.eight(triangle) & 1 == 1
    }

    /// The same for eight triangles in a row, a bit each. Those behind the last one are dropped or
    /// not.
    #[inline(always)]
    fn eight(self, first: u32) -> u32 {
        match self {
            Self::Kept => 0,
            Self::Dropped => 0xff,
            Self::DroppedOf(words) => {
                let at = first as usize / 32;
                let next = words.get(at + 1).copied().unwrap_or(0);
                ((u64::from(next) << 32 | u64::from(words[at])) >> (first % 32)) as u32 & 0xff
            }
        }
    }
}

/// Triangles of one mesh under one transform.
#[derive(Clone, Debug)]
pub struct Draw<'a> {
    /// Vertex positions, model space.
    pub positions: &'a [[f32; 3]],
    /// Indices into `positions`.
    pub triangles: &'a [[u32; 3]],
    /// Which triangles to draw.
    pub ranges: Vec<Range<u32>>,
    /// Model space to clip space.
    pub clip_from_model: Mat4,
    /// Facet id of triangle 0.
    pub first_facet: u32,
    /// Which triangles are dropped if they face away.
    pub back_faces: BackFaces<'a>,
    /// For each triangle the number of the plane that it lies in with others, see
    /// [`Screen::with_planes`], or a number beyond; empty if it is so for all.
    pub planes: &'a [u32],
    /// The transform mirrors: what runs clockwise in model space is the front.
    pub mirrored: bool,
}

impl Draw<'_> {
    /// The depths of the plane that a triangle lies in with others.
    #[inline(always)]
    fn plane<'s>(&self, facet: u32, screen: &'s Screen) -> Option<&'s SharedPlane> {
        screen.plane(*self.planes.get((facet - self.first_facet) as usize)?)
    }
}

/// What happened to triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GeometryCounters {
    /// Triangles looked at.
    pub triangles: u64,
    /// Outside one plane of the view volume with all corners.
    pub outside: u64,
    /// Facing away.
    pub back_facing: u64,
    /// Without area on the grid of 1/256 pixel.
    pub degenerate: u64,
    /// Between the samples, or beside the picture.
    pub no_sample: u64,
    /// With a NaN or infinite corner.
    pub not_finite: u64,
    /// Cut at a clipping plane.
    pub clipped: u64,
    /// Set up (a clipped triangle may count several times).
    pub set_up: u64,
    /// Entries in tile lists.
    pub tile_entries: u64,
}

impl GeometryCounters {
    /// Adds `other`'s counts.
    pub fn add(&mut self, other: &Self) {
        self.triangles += other.triangles;
        self.outside += other.outside;
        self.back_facing += other.back_facing;
        self.degenerate += other.degenerate;
        self.no_sample += other.no_sample;
        self.not_finite += other.not_finite;
        self.clipped += other.clipped;
        self.set_up += other.set_up;
        self.tile_entries += other.tile_entries;
    }
}

/// Whether a batch lists the triangles of each tile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TileLists {
    /// It does.
    #[default]
    Kept,
    /// It does, and copies them so that those of a tile lie side by side in memory: for who walks
    /// all tiles.
    Copied,
    /// Nobody is going to ask: all tiles are empty.
    Unwanted,
    /// It does, and keeps the box of the pixels that each triangle may cover in each tile.
    #[cfg(feature = "forward")]
    WithBoxes,
}

/// Pixels of a tile as four bytes: how far columns and rows begin behind the tile's first, and end
/// before its last ones. In the lowest byte the first column, then the last, the first row, the
/// last.
#[cfg(feature = "forward")]
#[inline(always)]
pub(crate) fn packed_box([x0, y0, x1, y1]: [i32; 4]) -> i32 {
    let last = TILE as i32 - 1;
    x0 | (last - x1) << 8 | y0 << 16 | (last - y1) << 24
}

/// Triangles set up, and for each tile the ones that touch it, in order.
#[derive(Clone, Debug, Default)]
pub struct Batch {
    setups: Vec<Setup>,
    tile_lists: TileLists,
    /// `(tile, index of the setup)`, in the order of submission.
    entries: Vec<[u32; 2]>,
    /// The box of each entry, if they were wanted.
    entry_boxes: Vec<i32>,
    /// `starts[t]..starts[t + 1]` are the places of tile `t` in what follows.
    starts: Vec<u32>,
    /// Which of the setups each entry is, or a copy of that.
    items: Vec<u32>,
    sorted: Vec<Setup>,
    /// What happened.
    pub counters: GeometryCounters,
}

/// Memory that a batch needs up to [`Batch::finish`] only: those who make batches one after the
/// other need one of it.
#[derive(Clone, Debug, Default)]
pub struct Unsorted {
    setups: Vec<Setup>,
    entries: Vec<[u32; 2]>,
    boxes: Vec<i32>,
}

/// Fewer triangles than lanes, and their first one again and again.
#[cold]
fn padded(triangles: &[[u32; 3]]) -> [[u32; 3]; LANES] {
    std::array::from_fn(|lane| *triangles.get(lane).unwrap_or(&triangles[0]))
}

impl Batch {
    /// Empties the batch, keeping its memory.
    pub fn clear(&mut self, tile_lists: TileLists) {
        self.tile_lists = tile_lists;
        self.setups.clear();
        self.entries.clear();
        self.entry_boxes.clear();
        self.counters = GeometryCounters::default();
    }

    /// Adds triangles `range` of `draw`, whose vertices were transformed to `vertices`.
    pub fn add(
        &mut self,
        level: Level,
        draw: &Draw<'_>,
        vertices: &[ScreenVertex],
        range: Range<u32>,
        screen: &Screen,
    ) {
        dispatch!(level, simd => self.add_by_eights(simd, draw, vertices, range, screen));
    }

    #[inline(always)]
    fn add_by_eights<S: Simd>(
        &mut self,
        simd: S,
        draw: &Draw<'_>,
        vertices: &[ScreenVertex],
        range: Range<u32>,
        screen: &Screen,
    ) {
        // Cull eight triangles at a time.
        let Viewport { width, height, .. } = screen.viewport;
        let clip = [0, 0, width as i32, height as i32];
        let mut sieve = Sieve { outside: flag::FRUSTUM, cut: flag::CLIP, culls: [0; 2], clip };
        self.counters.triangles += u64::from(range.end - range.start);
        let triangles = &draw.triangles[range.start as usize..range.end as usize];
        for (eight, first) in triangles.chunks(LANES).zip((range.start..).step_by(LANES)) {
            // A short last chunk repeats its first triangle.
            let corners = eight.try_into().unwrap_or_else(|_| padded(eight));
            sieve.culls[usize::from(!draw.mirrored)] = draw.back_faces.eight(first);
            let sifted = sift::<S, false>(simd, screen, &sieve, vertices, &corners);
            let whole = 0xff >> (LANES - eight.len());

            // Count what was dropped, without the repetitions.
            let count = |set: u32| u64::from((set & whole).count_ones());
            let c = &mut self.counters;
            c.not_finite += count(sifted.not_finite);
            c.outside += count(sifted.outside);
            c.degenerate += count(sifted.degenerate);
            c.back_facing += count(sifted.culled);
            let gone = sifted.not_finite | sifted.outside | sifted.degenerate | sifted.culled;
            c.no_sample += count(!(gone | sifted.others | sifted.seen));

            // Set up the visible triangles one by one; those that cross a clip plane or are large
            // take the general path.
            let mut left = (sifted.seen | sifted.others) & whole;
            while left != 0 {
                let lane = left.trailing_zeros() as usize % LANES;
                left &= left - 1;
                let (corners, facet) = (corners[lane], draw.first_facet + first + lane as u32);
                if sifted.others >> lane & 1 == 1 {
                    self.add_other(draw, corners, vertices, facet, screen);
                } else {
                    let [a, b, c] = corners.map(|i| vertices[i as usize].corner());
                    let area = sifted.area[lane];
                    let plane = match draw.plane(facet, screen) {
                        Some(plane) => plane.of_facet(&[a, b, c], (area > 0) != draw.mirrored),
                        None => sifted.plane(lane, a),
                    };
                    let setup = Setup::with_plane([a, b, c], i64::from(area), &plane, facet);
                    self.push(setup, sifted.pixels(lane), screen);
                }
            }
        }
    }

    /// Adds a triangle that may be large or cut by a clipping plane.
    #[inline(never)]
    fn add_other(
        &mut self,
        draw: &Draw<'_>,
        corners: [u32; 3],
        vertices: &[ScreenVertex],
        facet: u32,
        screen: &Screen,
    ) {
        let [a, b, c] = corners.map(|i| vertices[i as usize]);
        if (a.flags | b.flags | c.flags) & flag::CLIP == 0 {
            let corners = [a.corner(), b.corner(), c.corner()];
            let cull_back = draw.back_faces.drops(facet - draw.first_facet);
            let plane = draw.plane(facet, screen);
            self.add_corners(corners, cull_back, draw.mirrored, plane, facet, screen);
        } else {
            let corners =
                corners.map(|i| transform_point(&draw.clip_from_model, draw.positions[i as usize]));
            self.add_clipped(draw, corners, facet, screen);
        }
    }

    /// Adds one triangle of snapped corners inside the guard band, with the depths of the plane
    /// that it shares, if it does.
    #[inline(always)]
    pub fn add_corners(
        &mut self,
        corners: [CornerPosition; 3],
        cull_back: bool,
        mirrored: bool,
        plane: Option<&SharedPlane>,
        facet: u32,
        screen: &Screen,
    ) {
        let [a, b, c] = corners;
        let area = Setup::doubled_area(a, b, c);
        let faces_away = (area > 0) != mirrored;
        if area == 0 {
            self.counters.degenerate += 1;
        } else if faces_away && cull_back {
            self.counters.back_facing += 1;
        } else if let Some(pixels) = covered_pixels(&corners, screen) {
            let setup = match plane {
                Some(plane) => {
                    Setup::with_plane(corners, area, &plane.of_facet(&corners, faces_away), facet)
                }
                None => Setup::new(corners, area, facet),
            };
            self.push(setup, pixels, screen);
        } else {
            self.counters.no_sample += 1;
        }
    }

    /// Clips a triangle given in clip space and adds the pieces: one facet with one depth plane,
    /// that which it shares or that of the largest piece of the fan.
    #[cold]
    fn add_clipped(&mut self, draw: &Draw<'_>, corners: [Vec4; 3], facet: u32, screen: &Screen) {
        self.counters.clipped += 1;
        let polygon = clip(Polygon::triangle(corners), screen.transform().guard());
        let count = polygon.corners().len();
        if count < 3 {
            self.counters.outside += 1;
            return;
        }

        // Project the corners and find the largest triangle of the fan.
        let mut snapped = [CornerPosition { x: 0, y: 0, z: 0.0 }; crate::clip::MAX_CORNERS + 1];
        for (s, &p) in snapped.iter_mut().zip(polygon.corners()) {
            *s = screen.transform().project(p);
        }
        let snapped = &snapped[..count];
        let fan = |i: usize| [snapped[0], snapped[i], snapped[i + 1]];
        let areas = |i: usize| {
            let [a, b, c] = fan(i);
            Setup::doubled_area(a, b, c)
        };
        let total: i64 = (1..count - 1).map(areas).sum();
        let Some(largest) =
            (1..count - 1).max_by_key(|&i| areas(i).abs()).filter(|&i| areas(i) != 0)
        else {
            self.counters.degenerate += 1;
            return;
        };

        // Drop it if it faces away.
        let faces_away = (total > 0) != draw.mirrored;
        if faces_away && draw.back_faces.drops(facet - draw.first_facet) {
            self.counters.back_facing += 1;
            return;
        }

        // All pieces have the plane that the facet shares with others, or that of the largest.
        let own_plane = || {
            let [a, b, c] = fan(largest);
            let mut plane = DepthPlane::new(a, b, c, areas(largest));
            for corner in snapped {
                plane.z_min = plane.z_min.min(corner.z);
                plane.z_max = plane.z_max.max(corner.z);
            }
            plane
        };
        let shared = draw.plane(facet, screen).map(|plane| plane.of_facet(snapped, faces_away));
        let plane = shared.unwrap_or_else(own_plane);

        // Set up the pieces.
        for i in 1..count - 1 {
            let area = areas(i);
            // Snapping can turn a sliver of the fan over; its neighbours cover it.
            if area != 0
                && (area > 0) == (total > 0)
                && let Some(pixels) = covered_pixels(&fan(i), screen)
            {
                self.push(Setup::with_plane(fan(i), area, &plane, facet), pixels, screen);
            }
        }
    }

    #[inline(always)]
    pub(crate) fn push(&mut self, setup: Setup, pixels: [u32; 4], screen: &Screen) {
        self.push_where(setup, pixels, screen, |tx, ty| touches_tile(&setup, tx, ty));
    }

    /// Adds something that may cover these pixels, of those tiles that it touches.
    #[inline(always)]
    pub(crate) fn push_where(
        &mut self,
        setup: Setup,
        [x0, y0, x1, y1]: [u32; 4],
        screen: &Screen,
        touches: impl Fn(i32, i32) -> bool,
    ) {
        // Keep the setup once.
        let index = self.setups.len() as u32;
        let tiles_x = screen.viewport.tiles_x();
        let tile = TILE as u32;
        let (tx0, ty0, tx1, ty1) = (x0 / tile, y0 / tile, x1 / tile, y1 / tile);
        self.setups.push(setup);
        if self.tile_lists == TileLists::Unwanted {
            return;
        }

        // Enter it in its tile, or in all tiles of its box that it touches.
        if tx0 == tx1 && ty0 == ty1 {
            self.enter([tx0, ty0], index, [x0, y0, x1, y1], tiles_x);
            return;
        }
        for ty in ty0..=ty1 {
            for tx in tx0..=tx1 {
                if touches(tx as i32, ty as i32) {
                    self.enter([tx, ty], index, [x0, y0, x1, y1], tiles_x);
                }
            }
        }
    }

    /// Enters triangle `index`, which may cover these pixels, in the list of a tile.
    #[inline(always)]
    fn enter(&mut self, [tx, ty]: [u32; 2], index: u32, pixels: [u32; 4], tiles_x: u32) {
        self.entries.push([ty * tiles_x + tx, index]);
        #[cfg(feature = "forward")]
        if self.tile_lists == TileLists::WithBoxes {
            let within = |v: u32, tile: u32| {
                (v as i32 - (tile * TILE as u32) as i32).clamp(0, TILE as i32 - 1)
            };
            let [x0, y0, x1, y1] = pixels;
            self.entry_boxes.push(packed_box([
                within(x0, tx),
                within(y0, ty),
                within(x1, tx),
                within(y1, ty),
            ]));
        }
        #[cfg(not(feature = "forward"))]
        let _ = pixels;
    }

    /// Sorts the entries by tile, keeping their order. Call it once, after the last triangle.
    pub fn finish(&mut self, screen: &Screen) {
        self.finish_with(screen, |_, _, _| {});
    }

    /// [`Self::finish`]; `placed` gets each entry's place among those of all tiles, its number
    /// before, and its triangle.
    #[inline(always)]
    fn finish_with(&mut self, screen: &Screen, mut placed: impl FnMut(usize, usize, &Setup)) {
        // Count the entries of each tile.
        let tiles = (screen.viewport.tiles_x() * screen.viewport.tiles_y()) as usize;
        self.starts.clear();
        self.starts.resize(tiles + 2, 0);
        // Counting sort; starts is shifted by one so that filling it leaves the final offsets.
        for [tile, _] in &self.entries {
            self.starts[*tile as usize + 2] += 1;
        }
        for t in 2..self.starts.len() {
            self.starts[t] += self.starts[t - 1];
        }
        let (entries, copies) = (self.entries.len(), self.copies());
        // What was there is written over.
        if copies && self.sorted.capacity() < entries {
            self.sorted = bytemuck::zeroed_vec(entries);
        }
        self.sorted.resize(if copies { entries } else { 0 }, Setup::zeroed());
        self.items.resize(if copies { 0 } else { entries }, 0);

        // Copy each triangle, or its number, to its tile's range.
        for (number, &[tile, item]) in self.entries.iter().enumerate() {
            let place = &mut self.starts[tile as usize + 1];
            let setup = &self.setups[item as usize];
            if copies {
                self.sorted[*place as usize] = *setup;
            } else {
                self.items[*place as usize] = item;
            }
            placed(*place as usize, number, setup);
            *place += 1;
        }
        self.counters.set_up = self.setups.len() as u64;
        self.counters.tile_entries = self.entries.len() as u64;
    }

    /// [`Self::finish`] of a batch with boxes; `placed` gets each entry's place among those of all
    /// tiles, its box and its triangle.
    #[cfg(feature = "forward")]
    pub(crate) fn finish_with_boxes(
        &mut self,
        screen: &Screen,
        mut placed: impl FnMut(usize, i32, &Setup),
    ) {
        let boxes = std::mem::take(&mut self.entry_boxes);
        self.finish_with(screen, |place, number, setup| placed(place, boxes[number], setup));
        self.entry_boxes = boxes;
    }

    /// Exchanges the memory of the data needed up to [`Batch::finish`]: once after
    /// [`Batch::clear`], once after `finish`. What was in `unsorted` is forgotten. Of
    /// [`TileLists::Copied`] that is [`Batch::setups`], too: only the copies remain.
    pub fn exchange(&mut self, unsorted: &mut Unsorted) {
        unsorted.setups.clear();
        unsorted.entries.clear();
        unsorted.boxes.clear();
        std::mem::swap(&mut self.entries, &mut unsorted.entries);
        std::mem::swap(&mut self.entry_boxes, &mut unsorted.boxes);
        if self.copies() {
            std::mem::swap(&mut self.setups, &mut unsorted.setups);
        }
    }

    /// How many entries all tiles have, before they are sorted.
    #[cfg(feature = "forward")]
    pub(crate) fn entries(&self) -> usize {
        self.entries.len()
    }

    /// All triangles, in order of submission; see [`Self::exchange`].
    pub fn setups(&self) -> &[Setup] {
        &self.setups
    }

    /// Where the tile's entries lie among all.
    #[cfg(feature = "forward")]
    pub(crate) fn tile_range(&self, tile: usize) -> Range<usize> {
        self.starts[tile] as usize..self.starts[tile + 1] as usize
    }

    /// Hands out those of some tiles that have triangles, in order.
    #[cfg(feature = "forward")]
    #[inline(always)]
    pub(crate) fn touched_tiles<S: Simd>(
        &self,
        simd: S,
        tiles: Range<usize>,
        mut touched: impl FnMut(u32),
    ) {
        use vitral_math::lanes::{U32x8, prelude::*};
        let mut tile = tiles.start;
        while tile + LANES <= tiles.end {
            let starts = &self.starts[tile..tile + LANES + 1];
            let (first, next) =
                (U32x8::from_slice(simd, &starts[..LANES]), U32x8::from_slice(simd, &starts[1..]));
            let mut some = !first.simd_eq(next).to_bitmask() & 0xff;
            while some != 0 {
                touched(tile as u32 + some.trailing_zeros());
                some &= some - 1;
            }
            tile += LANES;
        }
        (tile..tiles.end)
            .filter(|&t| !self.tile_range(t).is_empty())
            .for_each(|t| touched(t as u32));
    }

    /// Whether setups are copied into the order of tiles.
    fn copies(&self) -> bool {
        self.tile_lists == TileLists::Copied
    }

    /// The setup of an entry.
    #[inline(always)]
    pub(crate) fn item(&self, at: usize) -> &Setup {
        if self.copies() { &self.sorted[at] } else { &self.setups[self.items[at] as usize] }
    }

    /// The triangles that touch tile `tile`, in order of submission.
    pub fn tile(&self, tile: usize) -> impl Iterator<Item = &Setup> {
        let range = self.starts[tile] as usize..self.starts[tile + 1] as usize;
        range.map(|at| self.item(at))
    }

    /// For each tile, whether a triangle touches it.
    pub fn touched(&self) -> impl Iterator<Item = bool> {
        self.starts.windows(2).map(|range| range[0] < range[1])
    }
}

/// `clip_from_model * (p, 1)` with the operations in the order of the vertex kernel.
pub fn transform_point(clip_from_model: &Mat4, p: [f32; 3]) -> Vec4 {
    let m = clip_from_model.to_cols_array();
    let row = |r: usize| p[0] * m[r] + p[1] * m[4 + r] + p[2] * m[8 + r] + m[12 + r];
    Vec4::new(row(0), row(1), row(2), row(3))
}

/// Whether a tile may hold covered samples: no edge has the whole tile on its outer side.
fn touches_tile(setup: &Setup, tx: i32, ty: i32) -> bool {
    let side = TILE as i32 * SUBPIXEL;
    let (x, y) = (tx * side, ty * side);
    (0..3).all(|i| {
        let j = (i + 1) % 3;
        let (dx, dy) = (i64::from(setup.x[j] - setup.x[i]), i64::from(setup.y[j] - setup.y[i]));
        // The corner of the tile where the edge function is largest.
        let corner_x = i64::from(if dy < 0 { x + side } else { x } - setup.x[i]);
        let corner_y = i64::from(if dx > 0 { y + side } else { y } - setup.y[i]);
        dx * corner_y - dy * corner_x >= 0
    })
}
