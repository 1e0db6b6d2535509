//! Questions to one map, eight at a time.
//!
//! Where a place is on the map and how deep its facet's plane is in the four texels round it is
//! found for eight places at once; each then looks at its texels.
//!
//! In:   places that face the light. Out: the part of the light that passes to each of them.
//! Cost: a constant number of operations a place.

use super::tiles::{Map, MapTile};
use crate::shadow::places::{LightVisibility, SurfacePoints, SurfacePoints8};
use std::ops::{Add, Mul, Sub};
use vitral_light::{DIRECTION_ROUNDING, Rgb};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, F64x8, I32x8, LANES, Level, Mask8, Simd, dispatch};
use vitral_math::{DMat4, DVec4};
use vitral_raster::TILE;

/// How far a point is lifted along its normal, in texels.
const LIFT: f64 = 0.5;
/// How far behind a point's plane a surface may be and still count as its own, in texels.
const BEYOND: f64 = 2.0;
/// How far in front of a point's plane a surface may be and still only touch it, in texels, such as
/// a wall that begins on a floor between a texel and the next.
const TOUCHING: f64 = 4.0;
/// Error of a texel's depth for each texel of depth that the plane rises over a texel: corners are
/// rounded to 1/256 texel, and two roundings may add up.
const SLOPE_BIAS: f64 = 1.0 / 64.0;
/// Relative error of a depth.
const DEPTH_BIAS: f64 = 1.0 / (1 << 19) as f64;

/// Where eight places are on a map, and how deep.
struct LookupBatch8<S: Simd> {
    /// In texels; not a number where the map does not tell.
    at: [F64x8<S>; 2],
    /// The upper left of the four texels whose middles are nearest.
    first: [F64x8<S>; 2],
    /// Depths of the places' planes in the four texels, row by row, less what they may be wrong by.
    depths: [F64x8<S>; 4],
    /// What lies farther in the four texels than this is not the surface that the place is on.
    ends: [F64x8<S>; 4],
    /// By how much less than its plane something may be deep that only touches it.
    touching: F64x8<S>,
}

/// Where the four texels of eight places lie.
struct Addresses {
    /// Column and row of the upper left one.
    corner: [[i32; LANES]; 2],
    /// The tile that holds it, and which of the tile's texels it is.
    tiles: [i32; LANES],
    first: [i32; LANES],
    /// The places whose four texels are in one tile, one bit each.
    together: u32,
}

/// What a texel says about a surface.
#[derive(Clone, Copy)]
struct Answer {
    /// The part of each colour of light that passes to it.
    passing: Rgb,
    /// Whether the light sees only what is far behind, or nothing.
    beyond: bool,
    /// Whether something opaque lies in front, and how deep it is.
    dark: bool,
    nearest: f64,
}

/// What maps answer to questions: the number of a map, and which of the places is asked about,
/// which faces its light.
pub(super) fn answers(
    level: Level,
    maps: &[&Map],
    questions: &[(usize, usize)],
    places: &SurfacePoints,
) -> Vec<Rgb> {
    let mut parts = vec![[1.0; 3]; questions.len()];
    let mut own: Vec<u32> = Vec::with_capacity(questions.len());
    for (number, map) in maps.iter().enumerate() {
        own.clear();
        own.extend((0..questions.len() as u32).filter(|&q| questions[q as usize].0 == number));
        dispatch!(level, simd => map.answer(simd, &own, (questions, places), &mut parts));
    }
    parts
}

/// What the only map of a light at one place (homogeneous) tells: the part of the light that
/// arrives, none at places that face away.
pub(super) fn light_visibility(
    level: Level,
    map: &Map,
    light: DVec4,
    places: &SurfacePoints,
    parts: &mut LightVisibility,
) {
    dispatch!(level, simd => map.light_visibility(simd, light, places, parts));
}

impl Map {
    /// The part of light that arrives at each of the places.
    #[inline(always)]
    fn light_visibility<S: Simd>(
        &self,
        simd: S,
        light: DVec4,
        places: &SurfacePoints,
        parts: &mut LightVisibility,
    ) {
        let at = [light.x, light.y, light.z];
        // See `horizon`, of which these are the operations.
        let rounding = f64::from(DIRECTION_ROUNDING);
        let sum = at[0].abs() + at[1].abs() + at[2].abs();
        for (places, parts) in places.eights().iter().zip(parts.eights_mut()) {
            *parts = [[0.0; LANES]; 3];
            let (position, normal) = (load(simd, &places.position), load(simd, &places.normal));
            let along = lanes::inlined(
                #[inline(always)]
                |k: usize| normal[k] * (splat(simd, at[k]) - position[k] * light.w),
            );
            let place = position[0].abs() + position[1].abs() + position[2].abs();
            let horizon = ((place * 2.0 + sum) * light.w + sum) * rounding;
            let asked = (along(0) + along(1) + along(2)).simd_gt(horizon).to_bitmask() as u32;
            if asked != 0 {
                self.transmittance(simd, places, asked, parts);
            }
        }
    }

    /// Answers the questions of these numbers.
    #[inline(always)]
    fn answer<S: Simd>(
        &self,
        simd: S,
        own: &[u32],
        (questions, places): (&[(usize, usize)], &SurfacePoints),
        parts: &mut [Rgb],
    ) {
        for asked in own.chunks(LANES) {
            let number = |lane: usize| questions[asked[lane.min(asked.len() - 1)] as usize].1;
            let eight = places.pick(std::array::from_fn(number));
            let mut passing = [[0.0; LANES]; 3];
            self.transmittance(simd, &eight, (1 << asked.len()) - 1, &mut passing);
            for (lane, &question) in asked.iter().enumerate() {
                parts[question as usize] = passing.map(|channel| channel[lane]);
            }
        }
    }

    /// The part of light that arrives at those of eight places whose bits are set in `asked`, which
    /// face it; others keep theirs.
    #[inline(always)]
    fn transmittance<S: Simd>(
        &self,
        simd: S,
        places: &SurfacePoints8,
        asked: u32,
        parts: &mut [[f32; LANES]; 3],
    ) {
        let eight = self.locate(simd, places);

        // Look at the texels. Outside of the map, and where it does not tell, all is lit.
        let near = lanes::inlined(
            #[inline(always)]
            |first: F64x8<S>, side: u32| {
                first.simd_ge(splat(simd, -1.0)) & first.simd_lt(splat(simd, f64::from(side)))
            },
        );
        let told = (near(eight.first[0], self.lens.width) & near(eight.first[1], self.lens.height))
            .to_bitmask() as u32;
        let (texels, apart) = self.texels(simd, &eight, asked & told);

        // Blend the answers by where the place is between the texels.
        let told = lanes_of(simd, told);
        let zero = F32x8::splat(simd, 0.0);
        let share = lanes::inlined(
            #[inline(always)]
            |k: usize| {
                lanes::Lanes::select(
                    told,
                    lanes::narrowed(simd, eight.at[k] - 0.5 - eight.first[k]),
                    zero,
                )
            },
        );
        let shares = [share(0), share(1)];
        let part = eight.filtered(simd, &texels, shares, asked);
        let asked_lanes = lanes_of(simd, asked);
        for channel in &mut *parts {
            lanes::Lanes::select(asked_lanes, part, F32x8::from_slice(simd, channel))
                .store_slice(channel);
        }

        // Ask texels with something transparent one by one.
        if apart != 0 {
            self.eight_apart(&Stored::new(&eight, shares), apart, parts);
        }
    }

    /// The depths of the four texels of each of these places, ∞ where nothing is; and in which of
    /// them something transparent may be.
    #[inline(always)]
    fn texels<S: Simd>(
        &self,
        simd: S,
        eight: &LookupBatch8<S>,
        mut asked: u32,
    ) -> ([[f32; LANES]; 4], u32) {
        // Find the address of each place's four texels.
        let mut texels = [[f32::INFINITY; LANES]; 4];
        let Addresses { corner, tiles, first, together } = self.addresses(simd, eight);
        let mut apart = 0;
        // Neighbours mostly find theirs in one tile.
        let mut current: Option<(i32, &MapTile)> = None;
        while asked != 0 {
            let lane = asked.trailing_zeros() as usize % LANES;
            asked &= asked - 1;
            // Fetch from several tiles where the four texels straddle a border.
            if together >> lane & 1 == 0 {
                match self.texels_of_tiles([corner[0][lane], corner[1][lane]]) {
                    Some(found) => (0..4).for_each(|k| texels[k][lane] = found[k]),
                    None => apart |= 1 << lane,
                }
                continue;
            }

            // Otherwise read all four from one tile, reusing the last place's.
            let tile = match current {
                Some((number, tile)) if number == tiles[lane] => tile,
                _ => self.tile(tiles[lane] as usize),
            };
            current = Some((tiles[lane], tile));
            if !tile.layers.is_empty() {
                apart |= 1 << lane;
                continue;
            }
            let first = first[lane] as usize;
            if let Some(found) = tile.depth.get(first..first + TILE + 2) {
                for (k, at) in [0, 1, TILE, TILE + 1].into_iter().enumerate() {
                    texels[k][lane] = found[at];
                }
            }
        }
        (texels, apart)
    }

    /// Where the four texels of each place lie.
    #[inline(always)]
    fn addresses<S: Simd>(&self, simd: S, eight: &LookupBatch8<S>) -> Addresses {
        let whole = lanes::inlined(
            #[inline(always)]
            |number: F64x8<S>| -> I32x8<S> { lanes::narrowed(simd, number).to_int() },
        );

        // Find the upper left texel.
        let (left, top) = (whole(eight.first[0]), whole(eight.first[1]));
        let (size, shift) = (TILE as i32, TILE.trailing_zeros());
        let (x, y) = (left & (size - 1), top & (size - 1));
        let splat = lanes::inlined(
            #[inline(always)]
            |number: i32| I32x8::splat(simd, number),
        );

        // Tell which places lie inside the map, and with all four texels in one tile.
        let (width, height) = (self.lens.width as i32 - 1, self.lens.height as i32 - 1);
        let inside = left.simd_ge(splat(0)) & top.simd_ge(splat(0));
        let inside = inside & left.simd_lt(splat(width)) & top.simd_lt(splat(height));
        let together = inside & x.simd_lt(splat(size - 1)) & y.simd_lt(splat(size - 1));
        Addresses {
            corner: [left.to_array(), top.to_array()],
            tiles: ((top >> shift) * self.columns as i32 + (left >> shift)).to_array(),
            first: (y * size + x).to_array(),
            together: together.to_bitmask() as u32,
        }
    }

    /// The depths of four texels that are not in one tile, ∞ outside of the map; `None` if
    /// something transparent may be there.
    #[inline(never)]
    fn texels_of_tiles(&self, [left, top]: [i32; 2]) -> Option<[f32; 4]> {
        let mut texels = [f32::INFINITY; 4];
        for (k, texel) in texels.iter_mut().enumerate() {
            if let Some((tile, at)) = self.texel([left + (k % 2) as i32, top + (k / 2) as i32]) {
                if !tile.layers.is_empty() {
                    return None;
                }
                *texel = tile.depth.get(at).copied().unwrap_or(f32::INFINITY);
            }
        }
        Some(texels)
    }

    /// The tile of a texel, and where in the tile it is; `None` outside of the map.
    fn texel(&self, [column, row]: [i32; 2]) -> Option<(&MapTile, usize)> {
        let outside = |k: i32, side: u32| k < 0 || k >= side as i32;
        if outside(column, self.lens.width) || outside(row, self.lens.height) {
            return None;
        }
        let (column, row) = (column as usize, row as usize);
        let tile = self.tile(row / TILE * self.columns + column / TILE);
        Some((tile, row % TILE * TILE + column % TILE))
    }

    /// Answers what texels with something transparent tell, place by place.
    #[inline(never)]
    fn eight_apart(&self, eight: &Stored, mut apart: u32, parts: &mut [[f32; LANES]; 3]) {
        while apart != 0 {
            let lane = apart.trailing_zeros() as usize % LANES;
            apart &= apart - 1;
            let first = [eight.first[0][lane] as i32, eight.first[1][lane] as i32];
            let surface = std::array::from_fn(|k| [eight.depths[k][lane], eight.ends[k][lane]]);
            let shares = [eight.shares[0][lane], eight.shares[1][lane]];
            let part = self.four_apart(first, surface, eight.touching[lane], shares);
            parts.iter_mut().zip(part).for_each(|(channel, part)| channel[lane] = part);
        }
    }

    /// Finds where places are on the map, and how deep their planes are in the texels there.
    #[inline(always)]
    fn locate<S: Simd>(&self, simd: S, places: &SurfacePoints8) -> LookupBatch8<S> {
        let lens = &self.lens;
        let matrix = &lens.view_from_world;
        let normal = rotated(matrix, load(simd, &places.normal));
        let [px, py, pz] = rotated(matrix, load(simd, &places.position));
        let (px, py, pz) = (px + matrix.w_axis.x, py + matrix.w_axis.y, pz + matrix.w_axis.z);

        // Lift the places along their normals.
        let texel =
            if lens.perspective { pz.abs() * lens.side() } else { splat(simd, lens.side()) };
        let lift = texel * LIFT;
        let point = [px + normal[0] * lift, py + normal[1] * lift, pz + normal[2] * lift];

        let at = self.project(simd, point);
        let first = [(at[0] + 0.5).floor() - 1.0, (at[1] + 0.5).floor() - 1.0];
        let (depths, ends) = self.plane_depths(simd, point, normal, first, texel);
        LookupBatch8 { at, first, depths, ends, touching: texel * TOUCHING }
    }

    /// Where points of view space are on the map, in texels; not a number behind the light.
    #[inline(always)]
    fn project<S: Simd>(&self, simd: S, point: [F64x8<S>; 3]) -> [F64x8<S>; 2] {
        let lens = &self.lens;
        let distance = if lens.perspective { -point[2] } else { splat(simd, 1.0) };
        let (width, height) = (f64::from(lens.width), f64::from(lens.height));
        let before = distance.simd_gt(splat(simd, 0.0));
        let nowhere = splat(simd, f64::NAN);
        let [across, down] = if lens.perspective {
            [point[0] / (distance * lens.extent[0]), point[1] / (distance * lens.extent[1])]
        } else {
            [point[0] * (1.0 / lens.extent[0]), point[1] * (1.0 / lens.extent[1])]
        };
        let u = (across + 1.0) * 0.5 * width;
        let v = (splat(simd, 1.0) - down) * 0.5 * height;
        [before.select(u, nowhere), before.select(v, nowhere)]
    }

    /// Depths of the planes through points of view space in the four texels from `first` on, less
    /// what they may be wrong by; and where depths farther away belong to another surface. `texel`
    /// is the side of a texel at each point.
    #[inline(always)]
    fn plane_depths<S: Simd>(
        &self,
        simd: S,
        point: [F64x8<S>; 3],
        normal: [F64x8<S>; 3],
        [left, top]: [F64x8<S>; 2],
        texel: F64x8<S>,
    ) -> ([F64x8<S>; 4], [F64x8<S>; 4]) {
        let lens = &self.lens;
        let (zero, infinity) = (splat(simd, 0.0), splat(simd, f64::INFINITY));
        let (width, height) = (f64::from(lens.width), f64::from(lens.height));
        let own = -point[2];

        // The facet's plane: how a step of a texel changes what the normal measures, at distance 1
        // or at any, and so what its height is to be divided by; for a parallel light the distance
        // itself.
        let step =
            [normal[0] * 2.0 * lens.extent[0] / width, -normal[1] * 2.0 * lens.extent[1] / height];
        let corner = normal[1] * lens.extent[1] - normal[0] * lens.extent[0];
        let height = normal[0] * point[0] + normal[1] * point[1] + normal[2] * point[2];
        let scale = splat(simd, 1.0) / normal[2];
        let (start, step) = if lens.perspective {
            (corner - normal[2], step)
        } else {
            ((corner - height) * scale, [step[0] * scale, step[1] * scale])
        };
        let deep = own.abs() * DEPTH_BIAS;
        let (mut depths, mut ends) = ([zero; 4], [zero; 4]);
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
            *stored = nearer - slope * SLOPE_BIAS - deep;
            // The farther of the two, and as much again for a surface that bends away.
            *end = nearer + slope * 2.0 + texel * BEYOND;
        }
        (depths, ends)
    }

    /// What passes four texels, some of them behind transparent things. `surface` is how deep the
    /// place's surface begins and ends in each.
    ///
    /// A texel in which the light sees something far behind that surface tells nothing about it:
    /// there, it has come to its end. Were such a texel lit, light would leak in where two walls of
    /// a closed room meet. Where a wall begins, texels are dark because of something that only
    /// touches the surface. They tell nothing about a place whose own texel is lit, or beside which
    /// nothing else is dark and the surface itself is lit.
    #[inline(never)]
    fn four_apart(
        &self,
        [left, top]: [i32; 2],
        surface: [[f64; 2]; 4],
        touching: f64,
        [right, bottom]: [f32; 2],
    ) -> Rgb {
        let at = |k: usize| {
            self.transmittance_at([left + (k % 2) as i32, top + (k / 2) as i32], surface[k])
        };
        let mut four = [at(0), at(1), at(2), at(3)];
        let own = usize::from(right >= 0.5) + 2 * usize::from(bottom >= 0.5);
        let touches = |(answer, [begin, _]): (&Answer, [f64; 2])| {
            !answer.dark || answer.nearest >= begin - touching
        };
        let only_touched =
            four.iter().zip(surface).all(touches) && four.iter().any(|a| !a.dark && !a.beyond);
        if !four[own].dark || only_touched {
            for (answer, [begin, _]) in four.iter_mut().zip(surface) {
                answer.beyond |= answer.dark && answer.nearest >= begin - touching;
            }
        }
        let passing = four.map(|answer| answer.passing);
        if passing.iter().all(|part| *part == [1.0; 3]) || !four.iter().any(|answer| answer.beyond)
        {
            return [0, 1, 2].map(|k| blended(passing.map(|color| color[k]), right, bottom));
        }
        let shares = [
            (1.0 - right) * (1.0 - bottom),
            right * (1.0 - bottom),
            (1.0 - right) * bottom,
            right * bottom,
        ];
        let (mut sum, mut all) = ([0.0; 3], 0.0);
        for (answer, share) in four.iter().zip(shares).filter(|(answer, _)| !answer.beyond) {
            sum = [0, 1, 2].map(|k| sum[k] + answer.passing[k] * share);
            all += share;
        }
        sum.map(|part| if all > 0.0 { part / all } else { 0.0 })
    }

    /// What one texel says about a surface that begins and ends at these depths.
    fn transmittance_at(&self, place: [i32; 2], [begin, end]: [f64; 2]) -> Answer {
        let lit = Answer { passing: [1.0; 3], beyond: true, dark: false, nearest: f64::INFINITY };
        let Some((tile, texel)) = self.texel(place) else { return lit };
        let nearest = f64::from(tile.depth.get(texel).copied().unwrap_or(f32::INFINITY));
        if nearest < begin {
            Answer { passing: [0.0; 3], beyond: false, dark: true, nearest }
        } else if tile.layers.is_empty() {
            Answer { beyond: nearest > end, nearest, ..lit }
        } else {
            // The surface itself may be among the transparent things.
            Answer { passing: tile.filtered(texel, begin), beyond: false, nearest, ..lit }
        }
    }
}

impl<S: Simd> LookupBatch8<S> {
    /// The part of light that passes texels of these depths, blended by the places' `shares` to the
    /// right and below; exact for places whose bits are set in `asked`.
    #[inline(always)]
    fn filtered(
        &self,
        simd: S,
        texels: &[[f32; LANES]; 4],
        [right, bottom]: [F32x8<S>; 2],
        asked: u32,
    ) -> F32x8<S> {
        // Compare the depths.
        let (one, zero) = (F32x8::splat(simd, 1.0), F32x8::splat(simd, 0.0));
        let (mut lit, mut beyond) = ([one; 4], [Mask8::splat(simd, false); 4]);
        let mut touching = [Mask8::splat(simd, false); 4];
        for k in 0..4 {
            let texel = lanes::widened(simd, F32x8::from_slice(simd, &texels[k]));
            let dark = lanes_of(simd, texel.simd_lt(self.depths[k]).to_bitmask() as u32);
            lit[k] = lanes::Lanes::select(dark, zero, one);
            beyond[k] = lanes_of(simd, texel.simd_gt(self.ends[k]).to_bitmask() as u32) & !dark;
            let touches = texel.simd_ge(self.depths[k] - self.touching);
            touching[k] = lanes_of(simd, touches.to_bitmask() as u32) & dark;
        }
        let part = blended(lit, right, bottom);

        // Where answers differ, leave out texels that the surface does not reach: see `four_apart`,
        // of which these are the operations.
        let differ = part.simd_gt(zero) & part.simd_lt(one);
        let half = F32x8::splat(simd, 0.5);
        let pick = lanes::inlined(
            #[inline(always)]
            |a: F32x8<S>, b: F32x8<S>| lanes::Lanes::select(right.simd_ge(half), b, a),
        );
        let own =
            lanes::Lanes::select(bottom.simd_ge(half), pick(lit[2], lit[3]), pick(lit[0], lit[1]));
        let mut only_touched = Mask8::splat(simd, true);
        let mut some_lit = Mask8::splat(simd, false);
        for k in 0..4 {
            let is_lit = lit[k].simd_gt(zero);
            only_touched &= is_lit | touching[k];
            some_lit |= is_lit & !beyond[k];
        }
        let begins = own.simd_gt(zero) | (only_touched & some_lit);
        (0..4).for_each(|k| beyond[k] |= touching[k] & begins);

        // Keep the blended part where no place that is asked for is affected.
        let beside = differ & (beyond[0] | beyond[1] | beyond[2] | beyond[3]);
        if beside.to_bitmask() as u32 & asked == 0 {
            return part;
        }

        // Blend the remaining texels by their shares.
        let (left, top) = (one - right, one - bottom);
        let (mut sum, mut all) = (zero, zero);
        for (k, share) in
            [left * top, right * top, left * bottom, right * bottom].into_iter().enumerate()
        {
            let share = lanes::Lanes::select(beyond[k], zero, share);
            sum += lit[k] * share;
            all += share;
        }
        let rest = lanes::Lanes::select(all.simd_gt(zero), sum / all, zero);
        lanes::Lanes::select(beside, rest, part)
    }
}

/// What [`Map::eight_apart`] needs of [`LookupBatch8`].
struct Stored {
    /// As in [`LookupBatch8`], lane by lane.
    first: [[f64; LANES]; 2],
    depths: [[f64; LANES]; 4],
    ends: [[f64; LANES]; 4],
    touching: [f64; LANES],
    shares: [[f32; LANES]; 2],
}

impl Stored {
    #[inline(always)]
    fn new<S: Simd>(eight: &LookupBatch8<S>, shares: [F32x8<S>; 2]) -> Self {
        let store = lanes::inlined(
            #[inline(always)]
            |value: F64x8<S>| {
                let mut stored = [0.0; LANES];
                value.store_slice(&mut stored);
                stored
            },
        );
        let four = lanes::inlined(
            #[inline(always)]
            |values: &[F64x8<S>; 4]| {
                [store(values[0]), store(values[1]), store(values[2]), store(values[3])]
            },
        );

        // Store every register, lane by lane.
        Self {
            first: [store(eight.first[0]), store(eight.first[1])],
            depths: four(&eight.depths),
            ends: four(&eight.ends),
            touching: store(eight.touching),
            shares: [shares[0].to_array(), shares[1].to_array()],
        }
    }
}

#[inline(always)]
fn splat<S: Simd>(simd: S, number: f64) -> F64x8<S> {
    F64x8::splat(simd, number)
}

#[inline(always)]
fn load<S: Simd>(simd: S, numbers: &[[f64; LANES]; 3]) -> [F64x8<S>; 3] {
    lanes::three(
        #[inline(always)]
        |k| F64x8::from_slice(simd, &numbers[k]),
    )
}

/// Eight lanes by their bits.
#[inline(always)]
fn lanes_of<S: Simd>(simd: S, bits: u32) -> Mask8<S> {
    Mask8::from_bitmask(simd, u64::from(bits))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shadow::SurfacePoint;
    use crate::shadow::casters::faces;
    use crate::shadow::map::draw::When;
    use crate::shadow::map::testing::teapot;
    use vitral_math::dvec3;
    use vitral_math::lanes::available_levels;

    /// What a map tells about eight places that face the light, each by itself.
    fn one_by_one<S: Simd>(simd: S, map: &Map, places: &SurfacePoints8) -> [Rgb; LANES] {
        let eight = map.locate(simd, places);
        let share = |k: usize| lanes::narrowed(simd, eight.at[k] - 0.5 - eight.first[k]);
        let stored = Stored::new(&eight, [share(0), share(1)]);
        std::array::from_fn(|lane| {
            let first = [stored.first[0][lane], stored.first[1][lane]];
            let within = |k: usize, side: u32| first[k] >= -1.0 && first[k] < f64::from(side);
            if !within(0, map.lens.width) || !within(1, map.lens.height) {
                return [1.0; 3];
            }
            let surface = std::array::from_fn(|k| [stored.depths[k][lane], stored.ends[k][lane]]);
            let shares = [stored.shares[0][lane], stored.shares[1][lane]];
            map.four_apart(first.map(|v| v as i32), surface, stored.touching[lane], shares)
        })
    }

    #[test]
    fn eight_together_are_told_what_each_is_told_alone() {
        for (transparent, towards) in [(false, dvec3(1.0, 2.0, 3.0)), (true, dvec3(-2.0, 1.0, 0.5))]
        {
            let (map, bounds) = teapot(transparent, towards, 200, When::Asked);
            let extent = bounds.size() * 0.6;
            let mut state = 1u32;
            let mut random = || {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                f64::from(state >> 8) / f64::from(1u32 << 24) - 0.5
            };
            let place = |_| {
                let position = dvec3(random(), random(), random()) * extent * 2.0;
                let normal = dvec3(random(), random(), random()).normalize();
                SurfacePoint { position, normal, facet: 0, seed: 0, pixel: None }
            };
            let places: SurfacePoints = (0..40_003).map(place).collect();
            for (name, level) in available_levels() {
                let mut parts = LightVisibility::new(places.len(), [f32::NAN; 3]);
                light_visibility(level, &map, towards.extend(0.0), &places, &mut parts);
                let mut partly = 0;
                for (number, eight) in places.eights().iter().enumerate() {
                    let expected = dispatch!(level, simd => one_by_one(simd, &map, eight));
                    for lane in 0..LANES.min(places.len() - number * LANES) {
                        let faces = faces(&eight.get(lane), towards.extend(0.0));
                        let expected = if faces { expected[lane] } else { [0.0; 3] };
                        assert_eq!(
                            parts.get(number * LANES + lane),
                            expected,
                            "{name}: {:?}",
                            eight.get(lane)
                        );
                        partly += usize::from(expected[0] > 0.0 && expected[0] < 1.0);
                    }
                }
                assert!(partly > 100, "{name}: {partly} places partly lit");
            }
        }
    }
}
