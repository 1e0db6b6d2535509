//! Colours of tiny facets eight at a time, where they come from corners, textures of the common
//! kinds and fog.
//!
//! Each facet has a lane while what its corners have is interpolated, at one place of all boxes
//! after the other. The pixels that show are then brought together, since boxes are mostly empty,
//! and textures are looked up for eight of them at a time, whichever facets they belong to. The
//! colours are those of [`Shader::block`].

use super::Shader;
use super::interpolation::MOST_W;
use crate::SUBPIXEL;
use crate::forward::assemble::{Facet, Primitives};
use crate::forward::environment::fog::fog;
use crate::forward::environment::{format_of, modulate};
use crate::forward::fragment_ops::compare::alpha_test;
use crate::forward::fragment_ops::packed::pack;
use crate::forward::pass::DrawContext;
use crate::forward::sample::PackedTexture;
use crate::forward::sample::cube::{Chart, derivatives as derivatives_on_faces};
use crate::forward::sample::mip::half_log2;
use crate::forward::sample::packed::Packed;
use crate::forward::sample::packed_cube::PackedCube;
use crate::forward::state::{EnvironmentMode, Unit};
use crate::forward::wide::{Rgba, bits_of, max, saturate_rgba, splat, splat_rgba};
use crate::kernel::tiny::{PLACES, TinyEight, set_bits};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, F64x8, I32x8, LANES, Simd};

/// Most units whose textures are looked up here.
const MOST_UNITS: usize = 2;

/// Numbers of a pixel: a colour, where in each unit's texture it is looked up, the fog coordinate.
const NUMBERS: usize = 4 * (1 + MOST_UNITS) + 1;

/// The fog coordinate's place among them.
const FOG: usize = NUMBERS - 1;

/// Pixels of all eight facets, and room for eights that reach beyond the last.
const ROOM: usize = LANES * PLACES + LANES;

/// The pixels of eight facets that show, side by side.
pub(crate) struct FacetPixels {
    /// How many pixels there are.
    count: usize,
    /// Position of each pixel in its facet's box: `8 * row + column`.
    places: [u8; ROOM],
    /// Lane of each pixel's facet, as a float so that lanes compress it with the numbers.
    facets: [f32; ROOM],
    /// The interpolated numbers, one list each.
    numbers: [[f32; ROOM]; NUMBERS],
}

impl Default for FacetPixels {
    fn default() -> Self {
        Self { count: 0, places: [0; ROOM], facets: [0.0; ROOM], numbers: [[0.0; ROOM]; NUMBERS] }
    }
}

/// Four numbers of eight facets' corners as they are interpolated: see `Differences`.
#[derive(Clone, Copy)]
struct Numbers<S: Simd> {
    base: Rgba<S>,
    d1: Rgba<S>,
    d2: Rgba<S>,
}

/// Perspective-correct barycentric coordinates of all facets at a place.
struct Weights<S: Simd> {
    /// Weight of corner 1.
    b1: F32x8<S>,
    /// Weight of corner 2.
    b2: F32x8<S>,
    /// Interpolated clip-space w.
    w: F32x8<S>,
}

/// Up to eight facets ready to be interpolated: see `Interpolation`.
pub(crate) struct EightFacets<'d, S: Simd> {
    draw: &'d DrawContext<'d>,
    /// Pixel position of corner 0, x and y.
    origin: [F32x8<S>; 2],
    /// Change of `l1 / w1` with x and y.
    first: [F32x8<S>; 2],
    /// Change of `l2 / w2` with x and y.
    second: [F32x8<S>; 2],
    /// `Σ l / w` at the origin, and its change with x and y.
    sum: [F32x8<S>; 3],
    values: Values<S>,
}

/// What is interpolated.
struct Values<S: Simd> {
    color: Numbers<S>,
    /// Of each unit's texture.
    coordinates: [Numbers<S>; MOST_UNITS],
    /// The fog coordinate, as one of [`Numbers`].
    fog: [F32x8<S>; 3],
}

/// Whether a draw's colours are those of corners, textures of the common kinds and fog, and nothing
/// else.
pub(crate) fn can_batch_facets(draw: &DrawContext<'_>) -> bool {
    let (state, layout) = (draw.state, draw.layout);
    let common =
        |unit: &Unit| unit.mode == EnvironmentMode::Modulate && layout.tex[unit.index].is_some();
    (state.fog.is_none() || layout.fog.is_some())
        && !state.color_sum
        && layout.grid.is_none()
        && state.units.len() <= MOST_UNITS
        && draw.plain.len() == state.units.len()
        && state.units.iter().all(common)
}

impl<'d, S: Simd> EightFacets<'d, S> {
    /// Makes the facets of `eight` ready, in a tile whose first pixel is `tile`, for a draw whose
    /// colours [`can_batch_facets`]. `None` if `1 / w` differs much at the corners of one, or
    /// coordinates must be divided: this needs more care.
    #[inline(always)]
    pub(crate) fn new(
        simd: S,
        eight: &TinyEight,
        facets: &[&Facet; LANES],
        (draw, primitives): (&'d DrawContext<'d>, &Primitives),
        tile: [u32; 2],
    ) -> Option<Self> {
        // Gather 1 / w of the corners and refuse facets with strong perspective.
        let records = primitives.records.as_slice();
        let mut inverse_w = [[0.0; LANES]; 3];
        for (lane, facet) in facets.iter().enumerate() {
            for (k, &slot) in facet.corners.iter().enumerate() {
                inverse_w[k][lane] = records[slot as usize];
            }
        }
        let inverse_w = lanes::three(
            #[inline(always)]
            |k| F32x8::from_slice(simd, &inverse_w[k]),
        );
        let least =
            lanes::Lanes::min(lanes::Lanes::min(inverse_w[0], inverse_w[1]), inverse_w[2]) * MOST_W;
        if (inverse_w[0].simd_gt(least) | inverse_w[1].simd_gt(least) | inverse_w[2].simd_gt(least))
            .any_true()
        {
            return None;
        }

        // Set up the colour of each facet.
        let color_at = |lane: usize| Shader::color_of(draw, facets[lane]);
        let zero = splat_rgba(simd, [0.0; 4]);
        let color = if draw.state.flat {
            let base = four(simd, records, |lane| facets[lane].provoking as usize + color_at(lane));
            Numbers { base, d1: zero, d2: zero }
        } else {
            Numbers::of_corners(simd, records, facets, color_at)
        };

        // Set up texture coordinates, which must need no division by q.
        let mut coordinates = [Numbers { base: zero, d1: zero, d2: zero }; MOST_UNITS];
        for (i, (unit, (_, common))) in draw.state.units.iter().zip(&draw.plain).enumerate() {
            let at = draw.layout.tex[unit.index]?;
            let own = Numbers::of_corners(simd, records, facets, |_| at);
            let undivided = own.base[3].simd_eq(splat(simd, 1.0))
                & own.d1[3].simd_eq(own.d2[3])
                & own.d1[3].simd_eq(zero[3]);
            if !matches!(common, PackedTexture::Shadow(_)) && !undivided.all_true() {
                return None;
            }
            coordinates[i % MOST_UNITS] = own;
        }

        // Set up the fog coordinate.
        let mut fog = [zero[0]; 3];
        if let (Some(_), Some(at)) = (&draw.state.fog, draw.layout.fog) {
            // Four that lie within a record, and it among them.
            let first = at.min(draw.layout.stride.saturating_sub(4));
            let four = Numbers::of_corners(simd, records, facets, |_| first);
            fog = [four.base, four.d1, four.d2].map(|numbers| numbers[(at - first) % 4]);
        }
        Some(Self::with_planes(
            simd,
            eight,
            inverse_w,
            tile,
            draw,
            Values { color, coordinates, fog },
        ))
    }

    /// The operations of `Interpolation::near`, in their order.
    #[inline(always)]
    fn with_planes(
        simd: S,
        eight: &TinyEight,
        inverse_w: [F32x8<S>; 3],
        tile: [u32; 2],
        draw: &'d DrawContext<'d>,
        values: Values<S>,
    ) -> Self {
        // Solve for the slopes of the barycentric weights in double precision.
        let [x, y] = eight.corners(simd);
        let double = lanes::inlined(
            #[inline(always)]
            |value: F32x8<S>| {
                let (low, high) = simd.widen_f32x8(value);
                simd.combine_f64x4(low, high)
            },
        );
        let single = lanes::inlined(
            #[inline(always)]
            |value: F64x8<S>| {
                let (low, high) = simd.split_f64x8(value);
                simd.narrow_f64x4(low, high)
            },
        );
        let side = lanes::inlined(
            #[inline(always)]
            |to: I32x8<S>, from: I32x8<S>| double((to - from).to_float()),
        );
        let (dx1, dy1) = (side(x[1], x[0]), side(y[1], y[0]));
        let (dx2, dy2) = (side(x[2], x[0]), side(y[2], y[0]));
        let inverse = F64x8::splat(simd, f64::from(SUBPIXEL)) / (dx1 * dy2 - dx2 * dy1);
        let zero = F64x8::splat(simd, 0.0);
        let (a, b) =
            ([dy2 * inverse, (zero - dx2) * inverse], [(zero - dy1) * inverse, dx1 * inverse]);
        // With one w for all corners the weights themselves are planes, and their sum is 1.
        let flat = inverse_w[0].simd_eq(inverse_w[1]) & inverse_w[1].simd_eq(inverse_w[2]);
        let weight = lanes::inlined(
            #[inline(always)]
            |k: usize| double(lanes::Lanes::select(flat, splat(simd, 1.0), inverse_w[k])),
        );
        let [w0, w1, w2] = [weight(0), weight(1), weight(2)];

        // Move the first corner to the window's coordinates.
        let (e1, e2) = (w1 - w0, w2 - w0);
        let origin = lanes::inlined(
            #[inline(always)]
            |corner: I32x8<S>, first: u32| -> F32x8<S> {
                let absolute: F32x8<S> = (corner + first as i32 * SUBPIXEL).to_float();
                absolute * (1.0 / SUBPIXEL as f32)
            },
        );

        // Combine weights and 1 / w to three planes.
        Self {
            draw,
            origin: [origin(x[0], tile[0]), origin(y[0], tile[1])],
            first: [single(a[0] * w1), single(a[1] * w1)],
            second: [single(b[0] * w2), single(b[1] * w2)],
            sum: [single(w0), single(a[0] * e1 + b[0] * e2), single(a[1] * e1 + b[1] * e2)],
            values,
        }
    }

    /// The packed colours of the pixels `shown` of each facet go to their places in `words`; of
    /// `shown` those remain that pass the alpha test.
    #[inline(always)]
    pub(crate) fn colors(
        &self,
        simd: S,
        eight: &TinyEight,
        tile: [u32; 2],
        shown: &mut [u64; LANES],
        pixels: &mut FacetPixels,
        words: &mut [[u32; LANES]; PLACES],
    ) {
        if self.draw.state.units.is_empty() && self.draw.state.alpha_test.is_none() {
            for place in set_bits(shown.iter().fold(0, |all, mask| all | mask)) {
                let weights = self.weights(simd, eight, place, tile);
                let mut color = value(&weights, &self.values.color);
                if let Some(state) = &self.draw.state.fog {
                    color = fog(state, saturate_rgba(color), self.fog_coordinate(&weights));
                }
                pack::<S, F32x8<S>>(&color).store_slice(&mut words[place]);
            }
            return;
        }
        self.interpolate(simd, eight, tile, shown, pixels);
        self.look_up(simd, pixels, shown, words);
    }

    /// Brings together the pixels of `shown`, with their colours and places in textures.
    #[inline(always)]
    fn interpolate(
        &self,
        simd: S,
        eight: &TinyEight,
        tile: [u32; 2],
        shown: &[u64; LANES],
        pixels: &mut FacetPixels,
    ) {
        // Find the slopes of coordinates whose level of detail depends on them.
        let mut slopes = [None; MOST_UNITS];
        for (i, (_, common)) in self.draw.plain.iter().enumerate() {
            if let PackedTexture::Flat(packed) = common
                && packed.needs_lod()
            {
                slopes[i % MOST_UNITS] =
                    Some(self.slopes(packed, &self.values.coordinates[i % MOST_UNITS]));
            }
        }
        let mut count = 0;
        let used = (4 + 4 * self.draw.plain.len()).min(FOG);
        let word = lanes::inlined(
            #[inline(always)]
            |half: usize| {
                I32x8::from_slice(
                    simd,
                    &std::array::from_fn::<_, LANES, _>(|f| (shown[f] >> (32 * half)) as i32),
                )
            },
        );
        let (halves, none) = ([word(0), word(1)], I32x8::splat(simd, 0));
        let lane = F32x8::from_slice(simd, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);

        // Interpolate at each place of the boxes where some facet shows.
        for place in set_bits(shown.iter().fold(0, |all, mask| all | mask)) {
            let weights = self.weights(simd, eight, place, tile);
            let mut numbers = [splat(simd, 0.0); NUMBERS];
            let mut keep = lanes::inlined(
                #[inline(always)]
                |first: usize, four: Rgba<S>| {
                    for k in 0..4 {
                        numbers[(first + k) % FOG] = four[k];
                    }
                },
            );
            keep(0, saturate_rgba(value(&weights, &self.values.color)));
            for (i, (unit, (_, common))) in
                self.draw.state.units.iter().zip(&self.draw.plain).enumerate()
            {
                let i = i % MOST_UNITS;
                keep(4 + 4 * i, self.texel_position(simd, &weights, (unit, common), i, &slopes[i]));
            }
            if self.draw.state.fog.is_some() {
                numbers[FOG] = self.fog_coordinate(&weights);
            }

            // Append the numbers of the facets that show there: the bit of the place becomes the
            // sign.
            let shows = (halves[place / 32 % 2] << (31 - place as u32 % 32)).simd_lt(none);
            let append = lanes::inlined(
                #[inline(always)]
                |values: F32x8<S>, list: &mut [f32; ROOM]| {
                    simd.compress_f32x8(values, shows).store_slice(&mut list[count..count + LANES]);
                },
            );
            for k in 0..used {
                append(numbers[k], &mut pixels.numbers[k]);
            }
            append(numbers[FOG], &mut pixels.numbers[FOG]);
            append(lane, &mut pixels.facets);
            pixels.places[count..count + LANES].fill(place as u8);
            count += bits_of(shows).count_ones() as usize;
        }
        pixels.count = count;

        // Repeat the last pixel in the lanes that no pixel fills.
        if count > 0 {
            for k in 0..NUMBERS {
                let last = pixels.numbers[k][count - 1];
                pixels.numbers[k][count..count + LANES].fill(last);
            }
        }
    }

    /// Looks textures up, for eight pixels at a time.
    #[inline(always)]
    fn look_up(
        &self,
        simd: S,
        pixels: &FacetPixels,
        shown: &mut [u64; LANES],
        words: &mut [[u32; LANES]; PLACES],
    ) {
        // Load the interpolated numbers of eight pixels.
        for start in (0..pixels.count).step_by(LANES) {
            let count = (pixels.count - start).min(LANES);
            let active = (1 << count) - 1;
            let number = lanes::inlined(
                #[inline(always)]
                |k: usize| F32x8::from_slice(simd, &pixels.numbers[k][start..start + LANES]),
            );
            let mut color = lanes::four(number);

            // Modulate with the texture of each unit.
            for (i, (unit, (_, common))) in
                self.draw.state.units.iter().zip(&self.draw.plain).enumerate()
            {
                let [a, b, c, d] = lanes::four(
                    #[inline(always)]
                    |k| number((4 + 4 * i + k) % FOG),
                );
                let texture = match common {
                    PackedTexture::Flat(packed) => {
                        match packed.sample_batch(simd, &[([a, b], c)], active) {
                            Some([words]) => packed.meaning(words),
                            None => packed.at(simd, [a, b], c, active),
                        }
                    }
                    PackedTexture::Cube(packed) => packed.at(simd, (a.to_int(), [b, c]), d),
                    PackedTexture::Shadow(packed) => packed.at(simd, [a, b, c], active),
                };
                color = modulate(format_of(&unit.texture), &texture, color);
            }

            // Apply fog and the alpha test.
            if let Some(state) = &self.draw.state.fog {
                color = fog(state, color, number(FOG));
            }
            let mut passed = u32::MAX;
            if let Some(test) = self.draw.state.alpha_test {
                passed = bits_of(alpha_test(simd, test, color[3]));
            }

            // Scatter the packed colours to their facets and places.
            let packed = pack::<S, F32x8<S>>(&color).to_array();
            for lane in 0..count {
                let (place, facet) = (
                    usize::from(pixels.places[start + lane]),
                    pixels.facets[start + lane] as usize,
                );
                words[place % PLACES][facet % LANES] = packed[lane];
                shown[facet % LANES] &= !(u64::from(!passed >> lane & 1) << place);
            }
        }
    }

    #[inline(always)]
    fn weights(&self, simd: S, eight: &TinyEight, place: usize, tile: [u32; 2]) -> Weights<S> {
        let away = lanes::inlined(
            #[inline(always)]
            |pixel: I32x8<S>, first: u32, origin: F32x8<S>| -> F32x8<S> {
                let pixel: F32x8<S> = (pixel + first as i32).to_float();
                pixel + 0.5 - origin
            },
        );
        let [column, row] = eight.pixels(simd, place);
        let (dx, dy) = (away(column, tile[0], self.origin[0]), away(row, tile[1], self.origin[1]));
        let w = splat(simd, 1.0) / (dx * self.sum[1] + dy * self.sum[2] + self.sum[0]);
        let (q1, q2) =
            (dx * self.first[0] + dy * self.first[1], dx * self.second[0] + dy * self.second[1]);
        Weights { b1: q1 * w, b2: q2 * w, w }
    }

    #[inline(always)]
    fn fog_coordinate(&self, weights: &Weights<S>) -> F32x8<S> {
        let [base, d1, d2] = self.values.fog;
        weights.b1 * d1 + weights.b2 * d2 + base
    }

    /// How the weights of corners 1 and 2 change with one pixel to the right (axis 0), or one up.
    /// Where w is the same at all corners the sum changes nothing.
    #[inline(always)]
    fn weight_steps(&self, weights: &Weights<S>, axis: usize) -> [F32x8<S>; 2] {
        let sum = self.sum[axis + 1];
        [
            (self.first[axis] - weights.b1 * sum) * weights.w,
            (self.second[axis] - weights.b2 * sum) * weights.w,
        ]
    }

    /// See `Slopes` of textures: numerators and sums, times the size in texels.
    #[inline(always)]
    fn slopes(&self, packed: &Packed<'_>, coordinates: &Numbers<S>) -> [[[F32x8<S>; 2]; 2]; 2] {
        let size = packed.size();
        let slope = lanes::inlined(
            #[inline(always)]
            |axis: usize, k: usize| {
                let numerator = (self.first[axis] * coordinates.d1[k]
                    + self.second[axis] * coordinates.d2[k])
                    * size[k];
                [numerator, self.sum[axis + 1] * size[k]]
            },
        );
        [[slope(0, 0), slope(0, 1)], [slope(1, 0), slope(1, 1)]]
    }

    /// Where unit `i`'s texture is looked up: coordinates, and the level of detail or the reference
    /// of a shadow map.
    #[inline(always)]
    fn texel_position(
        &self,
        simd: S,
        weights: &Weights<S>,
        (unit, common): (&Unit, &PackedTexture<'_>),
        i: usize,
        slopes: &Option<[[[F32x8<S>; 2]; 2]; 2]>,
    ) -> Rgba<S> {
        let coordinates = &self.values.coordinates[i];
        let at = value(weights, coordinates);
        match common {
            PackedTexture::Flat(_) => self.place(simd, weights, unit, coordinates, at, slopes),
            PackedTexture::Cube(packed) => {
                self.place_on_cube(simd, weights, (unit, packed), coordinates, at)
            }
            PackedTexture::Shadow(packed) => {
                let [x, y, reference] = packed.place(simd, at);
                [x, y, reference, reference]
            }
        }
    }

    /// Coordinates of a texture of two dimensions, and the level of detail.
    #[inline(always)]
    fn place(
        &self,
        simd: S,
        weights: &Weights<S>,
        unit: &Unit,
        coordinates: &Numbers<S>,
        [s, t, ..]: Rgba<S>,
        slopes: &Option<[[[F32x8<S>; 2]; 2]; 2]>,
    ) -> Rgba<S> {
        let mut level = splat(simd, unit.lod_bias);
        if let Some(slopes) = slopes {
            let place = [s, t];
            let mut squares = [splat(simd, 0.0); 2];
            for axis in 0..2 {
                for k in 0..2 {
                    let [numerator, sum] = slopes[axis][k];
                    let step = numerator - (place[k] - coordinates.base[k]) * sum;
                    squares[axis] += step * step;
                }
            }
            level += half_log2(max(squares[0], squares[1]) * weights.w * weights.w);
        }
        [s, t, level, level]
    }

    /// Faces of a cube map and points on them, and the level of detail.
    #[inline(always)]
    fn place_on_cube(
        &self,
        simd: S,
        weights: &Weights<S>,
        (unit, packed): (&Unit, &PackedCube<'_>),
        coordinates: &Numbers<S>,
        [s, t, r, _]: Rgba<S>,
    ) -> Rgba<S> {
        // Start with the level's bias.
        let chart = Chart::new(simd, [s, t, r]);
        let mut level = splat(simd, unit.lod_bias);

        // Add the level of detail from the derivatives on the face.
        if packed.needs_lod() {
            let step = lanes::inlined(
                #[inline(always)]
                |axis: usize| {
                    let [db1, db2] = self.weight_steps(weights, axis);
                    lanes::three(
                        #[inline(always)]
                        |k| db1 * coordinates.d1[k] + db2 * coordinates.d2[k],
                    )
                },
            );
            let [across, up] =
                derivatives_on_faces(simd, packed.size(), &chart, [step(0), step(1)]);
            let square = lanes::inlined(
                #[inline(always)]
                |[s, t]: [F32x8<S>; 2]| s * s + t * t,
            );
            level += half_log2(max(square(across), square(up)));
        }
        let [x, y] = chart.point();
        [chart.face(simd).to_float(), x, y, level]
    }
}

/// Numbers at a place.
#[inline(always)]
fn value<S: Simd>(weights: &Weights<S>, numbers: &Numbers<S>) -> Rgba<S> {
    lanes::four(
        #[inline(always)]
        |k| weights.b1 * numbers.d1[k] + weights.b2 * numbers.d2[k] + numbers.base[k],
    )
}

impl<S: Simd> Numbers<S> {
    /// Of the records of `facets`; `at` is where the numbers begin in those of a lane's facet.
    #[inline(always)]
    fn of_corners(
        simd: S,
        records: &[f32],
        facets: &[&Facet; LANES],
        at: impl Fn(usize) -> usize + Copy,
    ) -> Self {
        let base = four(simd, records, |lane| facets[lane].corners[0] as usize + at(lane));
        let second = four(simd, records, |lane| facets[lane].corners[1] as usize + at(lane));
        let third = four(simd, records, |lane| facets[lane].corners[2] as usize + at(lane));
        Self { base, d1: less(second, base), d2: less(third, base) }
    }
}

/// Four numbers of eight lanes; `from` is where a lane's begin.
#[inline(always)]
fn four<S: Simd>(simd: S, records: &[f32], from: impl Fn(usize) -> usize) -> Rgba<S> {
    let words = lanes::columns_of_rows(
        simd,
        #[inline(always)]
        |lane| bytemuck::cast(*records[from(lane)..].first_chunk::<4>().unwrap_or(&[0.0; 4])),
    );
    [words[0].bitcast(), words[1].bitcast(), words[2].bitcast(), words[3].bitcast()]
}

#[inline(always)]
fn less<S: Simd>(numbers: Rgba<S>, base: Rgba<S>) -> Rgba<S> {
    lanes::four(
        #[inline(always)]
        |k| numbers[k] - base[k],
    )
}
