//! Pieces of polygons: what painter's algorithm and BSP trees cut polygons into.
//!
//! A piece of a polygon is its facets and the lines it was cut along, no new corners: a sample
//! belongs to the piece if one of the facets covers it and it lies on the kept side of each line.
//! The two halves of a cut share the line and differ in the side, so a sample belongs to one of
//! them, never to none or both. The outline of a piece, by contrast, is computed with rounding; it
//! only bounds the pixels where samples are looked for, a little too far out. A triangle of few
//! samples needs no outline: each sample is asked, and the piece is the list of those that belong
//! to it.
//!
//! In:   polygons' set-up triangles and lines (screen space). Out: pieces, sorted into tiles.
//! Cost: linear in the pieces and the tiles that each touches.
//! Source: the lines are those of [Fuchs, Kedem & Naylor 1980].

use super::cut::{Cut, Depth, around, bounds, clip_outline, corners};
use super::tiles::extent;
use std::ops::Range;
use vitral_raster::{BLOCK, SUBPIXEL, SamplePattern, Setup, TILE, Viewport};

/// Samples in the box of a triangle that are asked one by one, in at most 8x8 pixels.
const MAX_LISTED_SAMPLES: usize = 64;
/// Samples of a block that are asked without a look at the block's corners first.
const CORNER_TEST_THRESHOLD: u32 = 4;

/// A part of a set-up triangle: a polygon in the list has one for each of its triangles.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    /// Index among the view's triangles.
    pub(super) setup: u32,
    /// First and last pixel column and row that may have samples of it.
    pub(super) pixels: [u16; 4],
    pub(super) cuts: Range<u32>,
    /// Where its own samples are listed, if they are: then no cut is needed.
    pub(super) samples: u32,
}

/// The samples of a piece are not listed.
pub(super) const UNLISTED: u32 = u32::MAX;

/// A run of the list, sorted into tiles.
#[derive(Debug, Default)]
pub(super) struct Pieces {
    /// The polygons that have samples, in the order of the list: the numbers that
    /// [`Pieces::add_polygon`] was given.
    pub(super) listed: Vec<u32>,
    pub(super) pieces: Vec<Piece>,
    pub(super) cuts: Vec<Cut>,
    /// Samples of small pieces: for each sample of a pixel the pixels from the upper left of the
    /// piece's, 8 a row.
    pub(super) samples: Vec<u64>,
    /// Tile and piece, in the order of the list.
    entries: Vec<[u32; 2]>,
    starts: Vec<u32>,
    items: Vec<u32>,
    /// Workspace.
    outline: [Vec<[f64; 2]>; 2],
}

/// Where a triangle may have samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct Footprint {
    /// First and last pixel column and row.
    pixels: [u16; 4],
    /// If they are few: which have their first sample in the triangle, 8 a row.
    few: Option<u64>,
}

/// What bounds the pixels of a piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct Raster<'p> {
    viewport: Viewport,
    pattern: &'p SamplePattern,
    samples: [[i32; 2]; 2],
}

impl<'p> Raster<'p> {
    pub(super) fn new(viewport: Viewport, pattern: &'p SamplePattern) -> Self {
        Self { viewport, pattern, samples: extent(pattern) }
    }

    pub(super) fn viewport(&self) -> Viewport {
        self.viewport
    }

    /// Whether it takes less to ask each sample of these pixels than to clip an outline.
    fn are_few(&self, [x0, y0, x1, y1]: [u16; 4]) -> bool {
        let [width, height] = [x1 - x0 + 1, y1 - y0 + 1].map(usize::from);
        width <= BLOCK
            && height <= BLOCK
            && width * height * self.pattern.len() <= MAX_LISTED_SAMPLES
    }

    /// Where a triangle may have samples, if anywhere; what has few pixels is asked for each.
    pub(super) fn footprint(&self, setup: &Setup) -> Option<Footprint> {
        let pixels = self.pixels(around(setup))?;
        if !self.are_few(pixels) {
            return Some(Footprint { pixels, few: None });
        }
        let first = self.covered(setup, pixels, 0);
        let any =
            first != 0 || (1..self.pattern.len()).any(|s| self.covered(setup, pixels, s) != 0);
        any.then_some(Footprint { pixels, few: Some(first) })
    }

    /// A sample of each of a few pixels, where a triangle covers it: bits from the upper left, 8 a
    /// row.
    fn covered(&self, setup: &Setup, [x0, y0, x1, y1]: [u16; 4], sample: usize) -> u64 {
        let [dx, dy] = self.pattern.position(sample);
        let first = [i32::from(x0) * SUBPIXEL + dx, i32::from(y0) * SUBPIXEL + dy];
        setup.covered(first, usize::from(x1 - x0 + 1), usize::from(y1 - y0 + 1))
    }

    /// First and last column and row of pixels that may have samples in a box, given by its
    /// smallest and largest corner.
    pub(super) fn pixels(&self, around: [[f64; 2]; 2]) -> Option<[u16; 4]> {
        let mut ends = [[0u16; 2]; 2];
        for (axis, size) in [self.viewport.width, self.viewport.height].into_iter().enumerate() {
            let [low, high] = self.samples[axis].map(f64::from);
            let (min, max) = (around[0][axis], around[1][axis]);
            // Outlines are good to far less than this.
            const SLACK: f64 = 0.01;
            let pixel = f64::from(SUBPIXEL);
            let first = ((min - SLACK - high) / pixel).max(0.0);
            let last = ((max + SLACK - low) / pixel).min(f64::from(size) - 1.0);
            // An empty outline's box is inside out, without end.
            if last < first {
                return None;
            }
            // Not negative: conversion rounds down.
            let up = first as u32 + u32::from(first > f64::from(first as u32));
            if up > last as u32 {
                return None;
            }
            ends[axis] = [up as u16, last as u16];
        }
        let [[x0, x1], [y0, y1]] = ends;
        Some([x0, y0, x1, y1])
    }
}

impl Pieces {
    /// Adds the next polygon of the list: its triangles with their indices and footprints, each
    /// with the cuts for its depth, as far as they can have samples.
    pub(super) fn add_polygon<'s, C: ExactSizeIterator<Item = Cut>>(
        &mut self,
        number: u32,
        triangles: impl Iterator<Item = (u32, &'s Setup, Option<Footprint>)>,
        cuts: impl Fn(Depth) -> C,
        raster: &Raster<'_>,
    ) {
        let mut any = false;
        for (index, setup, footprint) in triangles {
            any |= footprint.is_some_and(|footprint| {
                self.add(index, (setup, footprint), cuts(Depth::of(setup)), raster)
            });
        }
        if any {
            self.listed.push(number);
        }
    }

    /// Adds a piece, a triangle with its footprint and the cuts that make it, if it can have
    /// samples; whether it can.
    fn add(
        &mut self,
        index: u32,
        (setup, footprint): (&Setup, Footprint),
        cuts: impl ExactSizeIterator<Item = Cut>,
        raster: &Raster<'_>,
    ) -> bool {
        // List the samples of small pieces, and cut the outline of others.
        let pixels = footprint.pixels;
        let (first, listed) = (self.cuts.len(), self.samples.len());
        let (found, samples) = match footprint.few {
            _ if cuts.len() == 0 => (Some(pixels), UNLISTED),
            Some(covered) => {
                (self.list_samples(setup, (pixels, covered), cuts, raster), listed as u32)
            }
            None => (self.cut_outline(setup, cuts, raster), UNLISTED),
        };

        // Drop a piece that keeps nothing.
        let Some(found) = found else {
            self.cuts.truncate(first);
            self.samples.truncate(listed);
            return false;
        };
        // A list counts from where it began.
        let pixels =
            if samples == UNLISTED { found } else { [pixels[0], pixels[1], found[2], found[3]] };
        let piece = self.pieces.len() as u32;
        self.pieces.push(Piece {
            setup: index,
            pixels,
            cuts: first as u32..self.cuts.len() as u32,
            samples,
        });

        // Enter the piece in the tiles it touches.
        let [tx0, ty0, tx1, ty1] = found.map(|p| u32::from(p) / TILE as u32);
        let tiles_x = raster.viewport.tiles_x();
        for ty in ty0..=ty1 {
            self.entries.extend((tx0..=tx1).map(|tx| [ty * tiles_x + tx, piece]));
        }
        true
    }

    /// Lists the samples of a few pixels that the triangle covers (`covered`: the first of each)
    /// and all cuts keep. First and last column and row of pixels with such a sample.
    fn list_samples(
        &mut self,
        setup: &Setup,
        (pixels, covered): ([u16; 4], u64),
        cuts: impl Iterator<Item = Cut>,
        raster: &Raster<'_>,
    ) -> Option<[u16; 4]> {
        // List the covered samples.
        let listed = self.samples.len();
        self.samples.push(covered);
        self.samples.extend((1..raster.pattern.len()).map(|s| raster.covered(setup, pixels, s)));
        let lists = &mut self.samples[listed..];
        let mut any = lists.iter().fold(0, |any, list| any | list);
        let origin = [pixels[0], pixels[1]].map(usize::from);

        // Drop the samples beyond each cut.
        for cut in cuts {
            if any == 0 {
                return None;
            }
            any = 0;
            for (s, list) in lists.iter_mut().enumerate() {
                *list = keep(&cut, raster.pattern.position(s), origin, *list);
                any |= *list;
            }
        }

        // Bound the pixels that keep a sample.
        let columns = (1..BLOCK).fold(any, |columns, row| columns | any >> (BLOCK * row)) as u8;
        (any != 0).then(|| {
            let x = [columns.trailing_zeros(), 7 - columns.leading_zeros()]
                .map(|x| pixels[0] + x as u16);
            let y = [any.trailing_zeros() / 8, 7 - any.leading_zeros() / 8]
                .map(|y| pixels[1] + y as u16);
            [x[0], y[0], x[1], y[1]]
        })
    }

    /// Clips a triangle's outline: first and last column and row of pixels that may have samples in
    /// the clipped part. Adds the cuts that matter.
    fn cut_outline(
        &mut self,
        setup: &Setup,
        cuts: impl Iterator<Item = Cut>,
        raster: &Raster<'_>,
    ) -> Option<[u16; 4]> {
        // Clip the outline, skipping cuts that leave it whole.
        let mut around = around(setup);
        let [outline, scratch] = &mut self.outline;
        outline.clear();
        outline.extend(corners(setup));
        let first = self.cuts.len();
        for cut in cuts {
            if !cut.holds_box(around) && !cut.holds(outline) {
                clip_outline(outline, scratch, &cut);
                around = bounds(outline);
                self.cuts.push(cut);
            }
        }
        let pixels = raster.pixels(around)?;

        // Forget the cuts that later ones made superfluous.
        let mut kept = first;
        for i in first..self.cuts.len() {
            if !self.cuts[i].holds(outline) {
                self.cuts[kept] = self.cuts[i];
                kept += 1;
            }
        }
        self.cuts.truncate(kept);
        Some(pixels)
    }

    /// Sorts the pieces into tiles, keeping their order. Call it once, at the end.
    pub(super) fn finish(&mut self, viewport: Viewport) {
        let tiles = (viewport.tiles_x() * viewport.tiles_y()) as usize;
        self.starts.resize(tiles + 2, 0);
        // Starts is shifted by one, so that filling it leaves the final offsets.
        for [tile, _] in &self.entries {
            self.starts[*tile as usize + 2] += 1;
        }
        for t in 2..self.starts.len() {
            self.starts[t] += self.starts[t - 1];
        }
        self.items.resize(self.entries.len(), 0);
        for &[tile, piece] in &self.entries {
            let place = &mut self.starts[tile as usize + 1];
            self.items[*place as usize] = piece;
            *place += 1;
        }
        self.entries = Vec::new();
    }

    /// The pieces that may touch a tile, in the order of the list.
    pub(super) fn in_tile(&self, index: usize) -> impl DoubleEndedIterator<Item = &Piece> {
        let items = &self.items[self.starts[index] as usize..self.starts[index + 1] as usize];
        items.iter().map(|&item| &self.pieces[item as usize])
    }

    /// How many polygons and parts of polygons there are.
    pub(super) fn len(&self) -> usize {
        self.listed.len()
    }

    /// Bytes it takes.
    pub(super) fn bytes(&self) -> u64 {
        let numbers = self.listed.len() + self.starts.len() + self.items.len();
        let cuts = self.cuts.len() * size_of::<Cut>() + numbers * 4;
        (self.pieces.len() * size_of::<Piece>() + self.samples.len() * 8 + cuts) as u64
    }
}

/// What of 8x8 pixels is left when they are moved by `dx` to the right and `dy` down, less than 8
/// either way.
#[inline(always)]
pub(super) fn moved(pixels: u64, dx: i32, dy: i32) -> u64 {
    let shifted = |v: u64, by: i32| if by >= 0 { v << by } else { v >> -by };
    // Those that enter a row of 8 from the next one are not meant.
    let columns = shifted(0xff, dx) & 0xff;
    shifted(shifted(pixels, 8 * dy), dx) & (columns * 0x0101_0101_0101_0101)
}

/// Takes from the coverage of a block, at pixel `origin`, what lies beyond the cuts; false if
/// nothing is left.
pub(super) fn cut_masks(
    cuts: &[Cut],
    pattern: &SamplePattern,
    origin: [usize; 2],
    masks: &mut [u64],
) -> bool {
    let mut any = false;
    for (s, mask) in masks.iter_mut().enumerate() {
        for cut in cuts {
            if *mask == 0 {
                break;
            }
            *mask = keep(cut, pattern.position(s), origin, *mask);
        }
        any |= *mask != 0;
    }
    any
}

/// What of a sample's bits, one for each of 8x8 pixels from `origin` on, a cut keeps. `offset` is
/// the sample's place in a pixel.
fn keep(cut: &Cut, offset: [i32; 2], origin: [usize; 2], mut mask: u64) -> u64 {
    let at = |column: usize, row: usize| {
        let place =
            |k: usize, pixel: usize| ((origin[k] + pixel) as i32 * SUBPIXEL + offset[k]) as f64;
        [place(0, column), place(1, row)]
    };
    // The value is monotonic: the corners of the block decide for all, where they agree. For few
    // samples it takes no more to ask them.
    if mask.count_ones() > CORNER_TEST_THRESHOLD {
        let last = BLOCK - 1;
        let keeps = [at(0, 0), at(last, 0), at(0, last), at(last, last)].map(|p| cut.keeps(p));
        if keeps[1..].iter().all(|&k| k == keeps[0]) {
            return if keeps[0] { mask } else { 0 };
        }
    }

    // Test the remaining samples one by one.
    let mut left = mask;
    while left != 0 {
        let bit = left.trailing_zeros() as usize;
        left &= left - 1;
        if !cut.keeps(at(bit % BLOCK, bit / BLOCK)) {
            mask &= !(1 << bit);
        }
    }
    mask
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_raster::CornerPosition;

    fn triangle() -> Setup {
        let [a, b, c] =
            [[0, 0], [2560, 0], [0, 2560]].map(|[x, y]| CornerPosition { x, y, z: 0.5 });
        Setup::new([a, b, c], Setup::doubled_area(a, b, c), 0)
    }

    #[test]
    fn the_halves_of_a_cut_share_the_samples_out() {
        let pattern = SamplePattern::new(4);
        let lines = [
            [1.0, 0.0, -1000.0],
            [0.3, -0.7, 128.0],
            [1.0, 1.0, -1024.0],
            [f64::NAN, 0.0, 0.0],
            [0.0, 0.0, 1.0],
        ];
        for [a, b, c] in lines {
            let cut = Cut { a, b, c, positive: true };
            let (mut one, mut other) = ([u64::MAX; 4], [u64::MAX; 4]);
            cut_masks(&[cut], &pattern, [0, 0], &mut one);
            cut_masks(&[cut.opposite()], &pattern, [0, 0], &mut other);
            for s in 0..4 {
                assert_eq!((one[s] ^ other[s], one[s] & other[s]), (u64::MAX, 0), "{a} {b} {c}");
                let [x, y] = pattern.position(s);
                let bit = 3 + 8 * 2;
                let keeps = cut.keeps([f64::from(x + 3 * 256), f64::from(y + 2 * 256)]);
                assert_eq!(one[s] >> bit & 1 == 1, keeps);
            }
        }
    }

    #[test]
    fn an_outline_holds_the_samples_of_its_piece() {
        let pattern = SamplePattern::new(1);
        let raster = Raster::new(Viewport::new(10, 10).unwrap(), &pattern);
        let mut pieces = Pieces::default();
        let cut = Cut { a: 1.0, b: 0.0, c: -1280.0, positive: false };
        for cuts in [&[][..], &[cut], &[cut.opposite()], &[cut, cut.opposite()]] {
            let setup = triangle();
            pieces.add(
                0,
                (&setup, raster.footprint(&setup).unwrap()),
                cuts.iter().copied(),
                &raster,
            );
        }
        let bounds: Vec<_> = pieces.pieces.iter().map(|p| p.pixels).collect();
        // The last is the line itself: no pixel centre lies on it.
        assert_eq!(bounds, [[0, 0, 9, 9], [0, 0, 4, 9], [5, 0, 9, 4]]);
        pieces.finish(raster.viewport);
        assert_eq!(
            (pieces.items.as_slice(), pieces.starts.as_slice()),
            (&[0, 1, 2][..], &[0, 3, 3][..])
        );
    }
    #[test]
    fn a_piece_has_the_samples_that_all_its_cuts_keep() {
        let mut state = 3u32;
        let mut next = |size: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) % size
        };
        let (mut few, mut gone) = (0, 0);
        for round in 0..600 {
            let pattern = SamplePattern::new([1, 3][round % 2]);
            let raster = Raster::new(Viewport::new(12, 12).unwrap(), &pattern);
            let size = [700, 3000][round / 2 % 2];
            let corners = [(); 3].map(|()| [next(size) as i32, next(size) as i32]);
            let [a, b, c] = corners.map(|[x, y]| CornerPosition { x, y, z: 0.5 });
            let area = Setup::doubled_area(a, b, c);
            if area == 0 {
                continue;
            }
            let setup = Setup::new([a, b, c], area, 0);
            let cuts: Vec<_> = (0..next(5))
                .map(|i| {
                    let [a, b] = [(); 2].map(|()| f64::from(next(200)) - 100.0);
                    let [x, y] = [(); 2].map(|()| f64::from(next(size)));
                    Cut { a, b, c: -(a * x + b * y), positive: i % 2 == 0 }
                })
                .collect();
            let mut pieces = Pieces::default();
            let added = raster.footprint(&setup).is_some_and(|footprint| {
                pieces.add(0, (&setup, footprint), cuts.iter().copied(), &raster)
            });
            few += usize::from(
                raster.pixels([[0.0; 2], [f64::from(size); 2]]).is_some_and(|p| raster.are_few(p)),
            );
            gone += usize::from(!added);
            for (x, y, s) in (0..12u16)
                .flat_map(|y| (0..12u16).flat_map(move |x| (0..3).map(move |s| (x, y, s))))
            {
                if s >= pattern.len() {
                    continue;
                }
                let offset = pattern.position(s);
                let [px, py] = [i32::from(x) * 256 + offset[0], i32::from(y) * 256 + offset[1]];
                let expected = setup.covers(px, py)
                    && cuts.iter().all(|c| c.keeps([f64::from(px), f64::from(py)]));
                let within = pieces.pieces.iter().any(|p| {
                    let [x0, y0, x1, y1] = p.pixels;
                    if p.samples != UNLISTED {
                        // Seen from a block about the sample.
                        let corner = [x & !7, y & !7].map(i32::from);
                        let [dx, dy] = [i32::from(x0) - corner[0], i32::from(y0) - corner[1]];
                        let list = pieces.samples[p.samples as usize + s];
                        let near = dx.abs() < 8 && dy.abs() < 8;
                        return near && moved(list, dx, dy) >> ((y & 7) * 8 + (x & 7)) & 1 == 1;
                    }
                    let own = &pieces.cuts[p.cuts.start as usize..p.cuts.end as usize];
                    // Without cuts the whole triangle is drawn.
                    let inside =
                        own.is_empty() || ((x0..=x1).contains(&x) && (y0..=y1).contains(&y));
                    inside && own.iter().all(|c| c.keeps([f64::from(px), f64::from(py)]))
                });
                assert_eq!(
                    setup.covers(px, py) && within,
                    expected,
                    "{setup:?} {cuts:?} {x} {y} {s}"
                );
            }
        }
        assert!(few > 100 && gone > 50, "{few} {gone}");
    }
}
