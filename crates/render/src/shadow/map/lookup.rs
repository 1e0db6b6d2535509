//! Questions to one map, eight at a time.
//!
//! Where a place is on the map and how deep its facet's plane is in the four texels round it is found for eight places at
//! once; each then looks at its texels.
//!
//! In:   places that face the light. Out: the part of the light that passes to each of them.
//! Cost: a constant number of operations a place.

use super::{BEYOND, DEPTH_BIAS, LIFT, Map, SLOPE_BIAS};
use crate::shadow::Place;
use std::ops::{Add, Mul, Sub};
use vitral_light::Rgb;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, F64x8, LANES, Level, Simd, dispatch};
use vitral_math::{DMat4, DVec3};
use vitral_raster::TILE;

/// Where eight places are on a map, and how deep.
struct Eight {
    /// In texels; not a number where the map does not tell.
    at: [[f64; LANES]; 2],
    /// The upper left of the four texels whose middles are nearest.
    first: [[f64; LANES]; 2],
    /// Depths of the places' planes in the four texels, row by row, less what they may be wrong by.
    depths: [[f64; LANES]; 4],
    /// What lies farther in the four texels than this is not the surface that the place is on.
    ends: [[f64; LANES]; 4],
}

/// What a texel says about a surface.
#[derive(Clone, Copy)]
struct Answer {
    /// The part of each colour of light that passes to it.
    passing: Rgb,
    /// Whether the light sees only what is far behind, or nothing.
    beyond: bool,
}

/// What maps answer to questions: the number of a map, and the place that is asked about, which faces its light.
pub(super) fn answers(level: Level, maps: &[&Map], questions: &[(usize, &Place)]) -> Vec<Rgb> {
    let mut parts = vec![[1.0; 3]; questions.len()];
    let mut own: Vec<u32> = Vec::with_capacity(questions.len());
    for (number, map) in maps.iter().enumerate() {
        own.clear();
        own.extend((0..questions.len() as u32).filter(|&q| questions[q as usize].0 == number));
        dispatch!(level, simd => map.answer(simd, &own, questions, &mut parts));
    }
    parts
}

/// What the map of a parallel light tells about places: the part of the light that arrives, none at those that face away.
pub(super) fn arriving(level: Level, map: &Map, towards: DVec3, places: &[Place], parts: &mut [Rgb]) {
    parts.fill([0.0; 3]);
    let faces = |number: &u32| places[*number as usize].normal.dot(towards) > 0.0;
    let asking: Vec<_> = (0..places.len() as u32).filter(faces).collect();
    dispatch!(level, simd => map.arriving(simd, &asking, places, parts));
}

impl Map {
    /// The part of light that arrives at the places of these numbers, which face it.
    #[inline(always)]
    fn arriving<S: Simd>(&self, simd: S, asking: &[u32], places: &[Place], parts: &mut [Rgb]) {
        for asked in asking.chunks(LANES) {
            // The last are asked again to fill up.
            let eight = std::array::from_fn(|lane| &places[asked[lane.min(asked.len() - 1)] as usize]);
            for (&question, part) in asked.iter().zip(self.passing(simd, &eight)) {
                parts[question as usize] = part;
            }
        }
    }

    /// Answers the questions of these numbers.
    #[inline(always)]
    fn answer<S: Simd>(&self, simd: S, own: &[u32], questions: &[(usize, &Place)], parts: &mut [Rgb]) {
        for asked in own.chunks(LANES) {
            let eight = std::array::from_fn(|lane| questions[asked[lane.min(asked.len() - 1)] as usize].1);
            for (&question, part) in asked.iter().zip(self.passing(simd, &eight)) {
                parts[question as usize] = part;
            }
        }
    }

    /// The part of light that arrives at each of eight places that face it.
    #[inline(always)]
    fn passing<S: Simd>(&self, simd: S, places: &[&Place; LANES]) -> [Rgb; LANES] {
        let eight = self.locate(simd, places);
        let mut texels = [[f64::INFINITY; LANES]; 4];
        let (mut told, mut apart) = ([false; LANES], [false; LANES]);
        for lane in 0..LANES {
            let [left, top] = [eight.first[0][lane], eight.first[1][lane]];
            // Outside of the map, and where it does not tell, all is lit.
            let near = |first: f64, side: u32| first >= -1.0 && first < f64::from(side);
            if !near(left, self.lens.width) || !near(top, self.lens.height) {
                continue;
            }
            told[lane] = true;
            // Most find their texels in one tile without transparent things.
            match self.four_texels(left as i32, top as i32) {
                Some(None) => {}
                Some(Some(found)) => {
                    for k in 0..4 {
                        texels[k][lane] = f64::from(found[k]);
                    }
                }
                None => apart[lane] = true,
            }
        }
        let mut lit = [F32x8::splat(simd, 1.0); 4];
        for k in 0..4 {
            let mut each = [0.0f32; LANES];
            for lane in 0..LANES {
                each[lane] = if texels[k][lane] < eight.depths[k][lane] { 0.0 } else { 1.0 };
            }
            lit[k] = F32x8::from_slice(simd, &each);
        }
        let mut shares = [[0.0f32; LANES]; 2];
        for k in 0..2 {
            for lane in 0..LANES {
                let share = (eight.at[k][lane] - 0.5 - eight.first[k][lane]) as f32;
                shares[k][lane] = if told[lane] { share } else { 0.0 };
            }
        }
        let [right, bottom] = [F32x8::from_slice(simd, &shares[0]), F32x8::from_slice(simd, &shares[1])];
        let mut parts = blended(lit, right, bottom).to_array().map(|part| [part; 3]);
        for lane in 0..LANES {
            // Few are answered differently by their texels.
            let differ = parts[lane][0] > 0.0 && parts[lane][0] < 1.0;
            if differ || apart[lane] {
                let [left, top] = [eight.first[0][lane] as i32, eight.first[1][lane] as i32];
                let surface = std::array::from_fn(|k| [eight.depths[k][lane], eight.ends[k][lane]]);
                parts[lane] = self.four_apart([left, top], surface, [shares[0][lane], shares[1][lane]]);
            }
        }
        parts
    }

    #[inline(always)]
    fn locate<S: Simd>(&self, simd: S, places: &[&Place; LANES]) -> Eight {
        let lens = &self.lens;
        let splat = lanes::inlined(
            #[inline(always)]
            |x: f64| F64x8::splat(simd, x),
        );
        let (zero, infinity) = (splat(0.0), splat(f64::INFINITY));
        let mut inputs = [[0.0; LANES]; 6];
        for (lane, place) in places.iter().enumerate() {
            let (p, n) = (place.position, place.normal);
            for (input, value) in inputs.iter_mut().zip([p.x, p.y, p.z, n.x, n.y, n.z]) {
                input[lane] = value;
            }
        }
        let load = lanes::inlined(
            #[inline(always)]
            |k: usize| F64x8::from_slice(simd, &inputs[k]),
        );
        let matrix = &lens.view_from_world;
        let normal = rotated(matrix, [load(3), load(4), load(5)]);
        let [px, py, pz] = rotated(matrix, [load(0), load(1), load(2)]);
        let (px, py, pz) = (px + matrix.w_axis.x, py + matrix.w_axis.y, pz + matrix.w_axis.z);

        // Lifted along the normal.
        let texel = if lens.perspective { pz.abs() * lens.side() } else { splat(lens.side()) };
        let lift = texel * LIFT;
        let point = [px + normal[0] * lift, py + normal[1] * lift, pz + normal[2] * lift];
        let own = -point[2];

        let distance = if lens.perspective { own } else { splat(1.0) };
        let (width, height) = (f64::from(lens.width), f64::from(lens.height));
        let before = distance.simd_gt(zero);
        let nowhere = splat(f64::NAN);
        let [across, down] = if lens.perspective {
            [point[0] / (distance * lens.extent[0]), point[1] / (distance * lens.extent[1])]
        } else {
            [point[0] * (1.0 / lens.extent[0]), point[1] * (1.0 / lens.extent[1])]
        };
        let u = (across + 1.0) * 0.5 * width;
        let v = (splat(1.0) - down) * 0.5 * height;
        let (u, v) = (before.select(u, nowhere), before.select(v, nowhere));
        let (left, top) = ((u + 0.5).floor() - 1.0, (v + 0.5).floor() - 1.0);

        // The facet's plane: how a step of a texel changes what the normal measures, at distance 1 or at any, and so what
        // its height is to be divided by; for a parallel light the distance itself.
        let step = [normal[0] * 2.0 * lens.extent[0] / width, -normal[1] * 2.0 * lens.extent[1] / height];
        let corner = normal[1] * lens.extent[1] - normal[0] * lens.extent[0];
        let height = normal[0] * point[0] + normal[1] * point[1] + normal[2] * point[2];
        let scale = splat(1.0) / normal[2];
        let (start, step) = if lens.perspective {
            (corner - normal[2], step)
        } else {
            ((corner - height) * scale, [step[0] * scale, step[1] * scale])
        };
        let deep = own.abs() * DEPTH_BIAS;
        let (mut depths, mut ends) = ([[0.0; LANES]; 4], [[0.0; LANES]; 4]);
        for (k, (stored, end)) in depths.iter_mut().zip(&mut ends).enumerate() {
            let (x, y) = (left + (k % 2) as f64 + 0.5, top + (k / 2) as f64 + 0.5);
            let value = start + step[0] * x + step[1] * y;
            let there = if lens.perspective {
                let there = height / value;
                (there.simd_gt(zero) & there.simd_lt(infinity)).select(there, own)
            } else {
                value.abs().simd_lt(infinity).select(value, own)
            };
            // The nearer of the two: the plane may go down further than the facet does.
            let slope = (there - own).abs();
            let nearer = there.simd_lt(own).select(there, own);
            (nearer - slope * SLOPE_BIAS - deep).store_slice(stored);
            // The farther of the two, and as much again for a surface that bends away.
            (nearer + slope * 2.0 + texel * BEYOND).store_slice(end);
        }
        let store = lanes::inlined(
            #[inline(always)]
            |value: F64x8<S>| {
                let mut stored = [0.0; LANES];
                value.store_slice(&mut stored);
                stored
            },
        );
        Eight { at: [store(u), store(v)], first: [store(left), store(top)], depths, ends }
    }

    /// The depths of four texels whose upper left one is given, `Some(None)` where nothing is; `None` if they are not in one
    /// tile, or if something transparent is in it.
    #[inline(always)]
    fn four_texels(&self, left: i32, top: i32) -> Option<Option<[f32; 4]>> {
        let (x, y) = (left as usize % TILE, top as usize % TILE);
        let inside = left >= 0 && top >= 0 && left + 1 < self.lens.width as i32 && top + 1 < self.lens.height as i32;
        if !inside || x + 1 >= TILE || y + 1 >= TILE {
            return None;
        }
        let tile = self.tile(top as usize / TILE * self.columns + left as usize / TILE);
        if !tile.layers.is_empty() {
            return None;
        }
        let texels = tile.depth.get(y * TILE + x..y * TILE + x + TILE + 2);
        Some(texels.map(|texels| [texels[0], texels[1], texels[TILE], texels[TILE + 1]]))
    }

    /// What passes four texels, across tiles, at the map's border, behind transparent things and where not all say the same.
    /// `surface` is how deep the place's surface begins and ends in each.
    ///
    /// A texel in which the light sees something far behind that surface tells nothing about it: there, it has come to its
    /// end. Were such a texel lit, light would leak in where two walls of a closed room meet.
    #[inline(never)]
    fn four_apart(&self, [left, top]: [i32; 2], surface: [[f64; 2]; 4], [right, bottom]: [f32; 2]) -> Rgb {
        let at = |k: usize| self.passing_at([left + (k % 2) as i32, top + (k / 2) as i32], surface[k]);
        let four = [at(0), at(1), at(2), at(3)];
        let passing = four.map(|answer| answer.passing);
        if passing.iter().all(|part| *part == [1.0; 3]) || !four.iter().any(|answer| answer.beyond) {
            return [0, 1, 2].map(|k| blended(passing.map(|color| color[k]), right, bottom));
        }
        let shares = [(1.0 - right) * (1.0 - bottom), right * (1.0 - bottom), (1.0 - right) * bottom, right * bottom];
        let (mut sum, mut all) = ([0.0; 3], 0.0);
        for (answer, share) in four.iter().zip(shares).filter(|(answer, _)| !answer.beyond) {
            sum = [0, 1, 2].map(|k| sum[k] + answer.passing[k] * share);
            all += share;
        }
        sum.map(|part| if all > 0.0 { part / all } else { 0.0 })
    }

    /// What one texel says about a surface that begins and ends at these depths.
    fn passing_at(&self, [column, row]: [i32; 2], [begin, end]: [f64; 2]) -> Answer {
        let outside = |k: i32, side: u32| k < 0 || k >= side as i32;
        if outside(column, self.lens.width) || outside(row, self.lens.height) {
            return Answer { passing: [1.0; 3], beyond: true };
        }
        let (column, row) = (column as usize, row as usize);
        let tile = self.tile(row / TILE * self.columns + column / TILE);
        let texel = row % TILE * TILE + column % TILE;
        let nearest = f64::from(tile.depth.get(texel).copied().unwrap_or(f32::INFINITY));
        if nearest < begin {
            Answer { passing: [0.0; 3], beyond: false }
        } else if tile.layers.is_empty() {
            Answer { passing: [1.0; 3], beyond: nearest > end }
        } else {
            // The surface itself may be among the transparent things.
            Answer { passing: tile.filtered(texel, begin), beyond: false }
        }
    }
}

/// The answers of four texels, blended. Written so that four equal answers stay what they are.
#[inline(always)]
fn blended<T>([a, b, c, d]: [T; 4], right: T, bottom: T) -> T
where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T>,
{
    let (above, below) = (a + (b - a) * right, c + (d - c) * right);
    above + (below - above) * bottom
}

/// Eight directions in another space, by the operations of [`DMat4::transform_vector3`].
#[inline(always)]
fn rotated<S: Simd>(matrix: &DMat4, [x, y, z]: [F64x8<S>; 3]) -> [F64x8<S>; 3] {
    let (a, b, c) = (matrix.x_axis, matrix.y_axis, matrix.z_axis);
    [z * c.x + (y * b.x + x * a.x), z * c.y + (y * b.y + x * a.y), z * c.z + (y * b.z + x * a.z)]
}
