//! Edges of shadows within a pixel: shadows are asked once for each facet in a pixel, and for each
//! of its samples where that is not enough.
//!
//! A point whose answer differs from one in a neighbouring pixel lies near the edge of a shadow;
//! there each sample is asked, and the point gets the mean. At the border of a tile, whose
//! neighbours are not known, a place one pixel beyond is asked, on the facet's plane. What comes
//! out does not depend on how a picture is cut into tiles' work.
//!
//! In:   points of an object and material, what reaches them. Out: the same, with means at edges.
//! Cost: a pass over the points; as many questions as samples near edges, and one more at the
//!       border of a tile.

use super::FrameConstants;
use super::points::{NO_POINT, Points, Source, samples_in};
use crate::shadow::{LightVisibility, SurfacePoints, grey};
use vitral_raster::TILE;

/// What must differ between neighbours. Answers about area lights differ by chance, so it takes
/// more.
const DIFFERS: [f32; 2] = [1.0 / 256.0, 0.3];
/// Numbers in a tile with a rim of one pixel.
const WIDE: usize = TILE + 2;

/// What is asked about: for each place its point's number in the group.
pub(super) struct Questions {
    pub(super) numbers: Vec<u32>,
    pub(super) screen: Vec<[f32; 2]>,
}

impl Questions {
    fn new() -> Self {
        Self { numbers: Vec::new(), screen: Vec::new() }
    }

    fn push(&mut self, number: usize, place: [f32; 2]) {
        self.numbers.push(number as u32);
        self.screen.push(place);
    }
}

/// Asks each sample of the points of a group that are near the edge of a shadow. `place` finds the
/// places of questions.
pub(super) fn soften(
    constants: &FrameConstants<'_>,
    points: &Points,
    order: &[u32],
    parts: &mut [LightVisibility],
    place: impl Fn(&Questions) -> SurfacePoints,
    ask: impl Fn(&SurfacePoints) -> Vec<LightVisibility>,
) {
    // Ask beyond the border of the tile.
    let mut beyond = Questions::new();
    for (number, &point) in order.iter().enumerate() {
        let [x, y] = points.place[point as usize];
        let step = |v: f32| match v as usize % TILE {
            0 => -1.0,
            last if last == TILE - 1 => 1.0,
            _ => 0.0,
        };
        let way = [step(x), step(y)];
        if way != [0.0; 2] {
            beyond.push(number, [x + way[0], y + way[1]]);
        }
    }
    let beyond_parts = if beyond.numbers.is_empty() { Vec::new() } else { ask(&place(&beyond)) };

    // Find the points whose neighbours have other answers.
    let mut is_edge = vec![false; order.len()];
    for (light, parts) in parts.iter().enumerate() {
        let differs = DIFFERS[usize::from(constants.lights[light].has_area())];
        mark_edges(points, order, parts, (&beyond, beyond_parts.get(light)), differs, &mut is_edge);
    }

    // Ask their samples, and take the mean.
    let masks = masks(points, constants.view.pattern.len());
    let mut samples = Questions::new();
    for (number, &point) in order.iter().enumerate().filter(|(number, _)| is_edge[*number]) {
        let corner = points.place[point as usize].map(f32::floor);
        for sample in samples_in(masks[point as usize]) {
            samples.push(number, constants.middle(corner, 1 << sample));
        }
    }
    if samples.numbers.is_empty() {
        return;
    }
    for (parts, found) in parts.iter_mut().zip(ask(&place(&samples))) {
        let mut at = 0;
        for run in samples.numbers.chunk_by(|a, b| a == b) {
            let mut sum = [0.0; 3];
            for i in at..at + run.len() {
                let part = found.get(i);
                (0..3).for_each(|k| sum[k] += part[k]);
            }
            at += run.len();
            parts.set(run[0] as usize, sum.map(|s| s / run.len() as f32));
        }
    }
}

/// Marks the points that have another answer in their pixel or one beside it.
fn mark_edges(
    points: &Points,
    order: &[u32],
    parts: &LightVisibility,
    (beyond, beyond_parts): (&Questions, Option<&LightVisibility>),
    differs: f32,
    is_edge: &mut [bool],
) {
    // Mostly a group has one answer.
    let all = (0..order.len()).map(|i| parts.get(i)).chain(
        beyond_parts.into_iter().flat_map(|parts| (0..beyond.numbers.len()).map(|i| parts.get(i))),
    );
    let [low, high] =
        all.map(grey).fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], part| {
            [low.min(part), high.max(part)]
        });
    if high - low <= differs {
        return;
    }

    let slot = |[x, y]: [f32; 2]| (y as usize % TILE + 1) * WIDE + x as usize % TILE + 1;
    // The least and greatest answer in each pixel.
    let mut ranges = vec![[f32::INFINITY, f32::NEG_INFINITY]; WIDE * WIDE];
    let mut add = |slot: usize, part: [f32; 3]| {
        let [low, high] = &mut ranges[slot];
        (*low, *high) = (low.min(grey(part)), high.max(grey(part)));
    };

    // Enter the points and those beyond the border.
    for (number, &point) in order.iter().enumerate() {
        add(slot(points.place[point as usize]), parts.get(number));
    }
    for (i, &number) in beyond.numbers.iter().enumerate() {
        let (own, way) = (points.place[order[number as usize] as usize], beyond.screen[i]);
        let step = |k: usize, stride: isize| (way[k] - own[k]).round() as isize * stride;
        let slot = (slot(own) as isize + step(0, 1) + step(1, WIDE as isize)) as usize;
        beyond_parts.into_iter().for_each(|parts| add(slot, parts.get(i)));
    }

    // Compare each pixel with its neighbours.
    for (number, &point) in order.iter().enumerate() {
        let middle = slot(points.place[point as usize]);
        let around =
            [middle - WIDE, middle, middle + WIDE].into_iter().flat_map(|row| row - 1..=row + 1);
        let [low, high] = around.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], slot| {
            [low.min(ranges[slot][0]), high.max(ranges[slot][1])]
        });
        is_edge[number] |= high - low > differs;
    }
}

/// The samples for which each point stands.
fn masks(points: &Points, samples: usize) -> Vec<u32> {
    let whole = u32::MAX >> (32 - samples.clamp(1, 32));
    let mut masks = vec![0; points.facet.len()];
    for pixel in &points.pixels {
        match pixel.source {
            Source::Point(point) if point != NO_POINT => masks[point as usize] = whole,
            Source::Point(_) => {}
            Source::Mixed(start) => {
                let mixed = points.mixed[start as usize..][..samples].iter().enumerate();
                mixed
                    .filter(|(_, p)| **p != NO_POINT)
                    .for_each(|(s, &p)| masks[p as usize] |= 1 << s);
            }
        }
    }
    for fragment in points.fragments.iter().filter(|f| !f.is_mark) {
        if let Some(mask) = masks.get_mut(fragment.source as usize) {
            *mask |= fragment.mask;
        }
    }
    masks
}
