//! What a facet's textures make of its colour: coordinates, level of detail, lookups and
//! environments, eight pixels at a time.

use super::{Groups, MAX_NUMBERS, Scratch, Shader, Weights};
use crate::forward::environment::{UNITS, environment, format_of, modulate};
use crate::forward::sample::anisotropic::sample_anisotropic;
use crate::forward::sample::cube::{Chart, derivatives as derivatives_on_faces};
use crate::forward::sample::depth::PackedShadow;
use crate::forward::sample::mip::{derivatives, half_log2, lod, needs_lod};
use crate::forward::sample::packed::Packed;
use crate::forward::sample::packed_cube::PackedCube;
use crate::forward::sample::{PackedTexture, sample};
use crate::forward::state::{EnvironmentMode, Unit};
use crate::forward::texture::{BaseFormat, Swizzle};
use crate::forward::wide::{Rgba, every, max, splat, splat_rgba};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, Floats, Simd};

/// Eight pixels: where, and which of them matter.
struct SampleBatch8<S: Simd> {
    weights: Weights<F32x8<S>>,
    active: u32,
}

impl<V, const N: usize> Groups<'_, V, N> {
    /// The colours of group `i`, made for eight pixels at a time.
    #[inline(always)]
    fn by_eights<S: Simd>(
        &self,
        simd: S,
        i: usize,
        f: impl Fn(&SampleBatch8<S>) -> Rgba<S>,
    ) -> [V; 4]
    where
        V: Floats<S>,
    {
        let Weights { b1, b2, w } = self.weights[i];
        V::by_eights(
            simd,
            [b1, b2, w],
            #[inline(always)]
            |first, [b1, b2, w]| {
                f(&SampleBatch8 {
                    weights: Weights { b1, b2, w },
                    active: self.active >> first & 0xff,
                })
            },
        )
    }
}

impl<'d> Shader<'d> {
    /// All units' textures and environments: `colors` are the primary colours before.
    #[inline(always)]
    pub(super) fn textured<S: Simd, V: Floats<S>, const N: usize>(
        &self,
        simd: S,
        groups: &Groups<'_, V, N>,
        colors: &mut [[V; 4]; N],
    ) {
        // The mode that nearly all programs use needs no other unit's texture.
        if self.draw.unlimited
            || !self.draw.state.units.iter().all(|unit| unit.mode == EnvironmentMode::Modulate)
        {
            return self.combined(simd, groups, colors);
        }
        for unit in &self.draw.state.units {
            if !self.multiply(simd, groups, unit, colors) {
                let format = format_of(&unit.texture);
                for i in 0..N {
                    let texture = self.texture_by_eights(simd, groups, i, unit);
                    colors[i] = modulate(format, &texture, colors[i]);
                }
            }
        }
    }

    /// Modulates colours with a unit's texture, if it is of a common kind; whether it is.
    #[inline(always)]
    fn multiply<S: Simd, V: Floats<S>, const N: usize>(
        &self,
        simd: S,
        groups: &Groups<'_, V, N>,
        unit: &Unit,
        colors: &mut [[V; 4]; N],
    ) -> bool {
        match self.common(unit) {
            Some((PackedTexture::Flat(packed), at)) => {
                self.plain(simd, groups, (unit, packed, at), colors)
            }
            Some((PackedTexture::Cube(packed), at)) => {
                self.cube(simd, groups, (unit, packed, at), colors)
            }
            Some((PackedTexture::Shadow(packed), at)) => {
                self.shadow(simd, groups, (unit, packed, at), colors)
            }
            None => return false,
        }
        true
    }

    /// All units' textures and environments, where one may use another's texture.
    #[inline(never)]
    fn combined<S: Simd, V: Floats<S>, const N: usize>(
        &self,
        simd: S,
        groups: &Groups<'_, V, N>,
        colors: &mut [[V; 4]; N],
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                let (zero, one) = (every(simd, 0.0), every(simd, 1.0));
                let mut textures = [[[zero; 4]; UNITS]; N];

                // Sample all units first, as one may use another's texture.
                for unit in &self.draw.state.units {
                    let (own, format) = (unit.index % UNITS, format_of(&unit.texture));
                    // White, modulated with a texture, is the texture's colour; but alpha alone
                    // comes with black.
                    let mut found = [[one; 4]; N];
                    let common = self.multiply(simd, groups, unit, &mut found);
                    for i in 0..N {
                        textures[i][own] = match (common, format) {
                            (false, _) => self.texture_by_eights(simd, groups, i, unit),
                            (true, BaseFormat::Alpha) => [zero, zero, zero, found[i][3]],
                            (true, _) => found[i],
                        };
                    }
                }

                // Then apply the environments in the order of units.
                for i in 0..N {
                    let primary = colors[i];
                    for unit in &self.draw.state.units {
                        colors[i] = environment(
                            simd,
                            unit,
                            &textures[i],
                            &primary,
                            colors[i],
                            !self.draw.unlimited,
                        );
                    }
                }
            },
        );
    }

    /// The texture of a unit and where its coordinates are in records, if it is of a common kind:
    /// two dimensions or a cube, 8 bits a component, no texels of a border, no anisotropy, no q of
    /// a cube's that could turn directions round.
    #[inline(always)]
    fn common(&self, unit: &Unit) -> Option<(&'d PackedTexture<'d>, usize)> {
        let (_, packed) = self.draw.plain.iter().find(|(index, _)| *index == unit.index)?;
        let at = self.draw.layout.tex[unit.index % UNITS]?;
        let turns = matches!(packed, PackedTexture::Cube(_)) && self.is_divided(at);
        (!turns).then_some((packed, at))
    }

    /// Whether the coordinates at `at` must be divided by q: it is not 1 all over the facet.
    #[inline(always)]
    fn is_divided(&self, at: usize) -> bool {
        let (d, q_at) = (&self.scratch.differences, (at + 3) % MAX_NUMBERS);
        d.varies >> q_at & 1 == 1 || d.base[q_at] != 1.0
    }

    /// A unit's texture at group `i`.
    #[inline(always)]
    fn texture_by_eights<S: Simd, V: Floats<S>, const N: usize>(
        &self,
        simd: S,
        groups: &Groups<'_, V, N>,
        i: usize,
        unit: &Unit,
    ) -> [V; 4] {
        groups.by_eights(
            simd,
            i,
            #[inline(always)]
            |eight| self.texture(simd, eight, unit),
        )
    }

    /// A unit's texture at eight pixels.
    #[inline(never)]
    fn texture<S: Simd>(&self, simd: S, eight: &SampleBatch8<S>, unit: &Unit) -> Rgba<S> {
        // Sample textures of the common kinds by their packed form.
        let SampleBatch8 { weights, active, .. } = eight;
        if let Some((common, at)) = self.common(unit) {
            return simd.vectorize(
                #[inline(always)]
                || match common {
                    PackedTexture::Flat(packed) => {
                        let slopes = Slopes::new(self, packed, at);
                        let (place, level) = self.place(simd, weights, (unit, packed, at), &slopes);
                        packed.at(simd, place, level, *active)
                    }
                    PackedTexture::Cube(packed) => {
                        let (place, level) = self.place_on_cube(simd, weights, (unit, packed, at));
                        packed.at(simd, place, level)
                    }
                    PackedTexture::Shadow(packed) => {
                        packed.at(simd, packed.place(simd, self.four(simd, weights, at)), *active)
                    }
                },
            );
        }

        // Sample any other texture and swizzle its components.
        let color = simd.vectorize(
            #[inline(always)]
            || self.any(simd, eight, unit),
        );
        let Some(swizzle) = unit.texture.swizzle else { return color };
        simd.vectorize(
            #[inline(always)]
            || {
                let from = lanes::inlined(
                    #[inline(always)]
                    |k: usize| match swizzle[k] {
                        Swizzle::Red => color[0],
                        Swizzle::Green => color[1],
                        Swizzle::Blue => color[2],
                        Swizzle::Alpha => color[3],
                        Swizzle::Zero => splat(simd, 0.0),
                        Swizzle::One => splat(simd, 1.0),
                    },
                );
                [from(0), from(1), from(2), from(3)]
            },
        )
    }

    /// Any texture: borders, volumes, cubes, depth, anisotropy.
    #[inline(always)]
    fn any<S: Simd>(&self, simd: S, eight: &SampleBatch8<S>, unit: &Unit) -> Rgba<S> {
        let SampleBatch8 { weights, active } = *eight;
        let weights = &weights;

        // Interpolate the coordinates.
        let texture = &*unit.texture;
        let coords = match self.draw.layout.tex[unit.index % UNITS] {
            Some(at) => self.four(simd, weights, at),
            None => splat_rgba(simd, [0.0, 0.0, 0.0, 1.0]),
        };

        // Sample with the bias alone where no level of detail is needed.
        let bias = splat(simd, unit.lod_bias);
        let anisotropic = texture.sampler.anisotropy > 1.0;
        let plane = self.draw.planes[unit.index % UNITS];
        if !needs_lod(texture) && !anisotropic {
            return sample(simd, texture, plane, coords, bias, active);
        }

        // Find the derivatives in texels, and sample by them.
        let [dx, dy] = self.steps(simd, weights, self.draw.layout.tex[unit.index % UNITS]);
        let steps = derivatives(simd, texture, coords, dx, dy);
        if anisotropic {
            return sample_anisotropic(simd, (texture, plane), coords, steps, bias, active);
        }
        let level =
            lod(steps[0][0], steps[0][1], steps[0][2], steps[1][0], steps[1][1], steps[1][2]);
        sample(simd, texture, plane, coords, level + bias, active)
    }

    /// How s, t, r, q change with one pixel to the right, and one up.
    #[inline(always)]
    fn steps<S: Simd>(
        &self,
        simd: S,
        weights: &Weights<F32x8<S>>,
        at: Option<usize>,
    ) -> [Rgba<S>; 2] {
        let zero = splat_rgba(simd, [0.0; 4]);
        let Some(at) = at else { return [zero; 2] };
        let i = &self.scratch.interpolation;
        let d = &self.scratch.differences;
        let mut steps = [zero; 2];
        for axis in 0..2 {
            let [db1, db2] = i.weight_steps(simd, weights, axis);
            for k in 0..4 {
                steps[axis][k] =
                    db1 * d.d1[(at + k) % MAX_NUMBERS] + db2 * d.d2[(at + k) % MAX_NUMBERS];
            }
        }
        steps
    }

    /// Looks up the colours of the texture that the draw shows repeatedly, in a block of pixels,
    /// unless the cache has them. Leaves the block out of the cache if they cannot be kept.
    #[inline(always)]
    pub(super) fn see<S: Simd, V: Floats<S>, const N: usize>(
        &mut self,
        simd: S,
        block: usize,
        weights: &[Weights<V>; N],
    ) {
        let draw = self.draw;
        let Some(unit) = draw.state.units.iter().find(|unit| draw.again == Some(unit.index)) else {
            return;
        };
        let Some((PackedTexture::Flat(packed), at)) = self.common(unit) else { return };
        let Scratch { interpolation, differences, seen } = &mut *self.scratch;
        seen.look_at(unit, at, interpolation, differences);
        if seen.get(block).is_some() {
            return;
        }
        let words = self.look::<S, V, N>(simd, (unit, packed, at), weights);
        let Some(kept) = words.and_then(|_| self.scratch.seen.keep(block)) else { return };
        for (words, kept) in words.iter().flatten().zip(kept.chunks_exact_mut(V::LEN)) {
            words.store_slice(kept);
        }
    }

    /// The bytes of a texture of the common kind at groups of pixels, if it can be looked up for
    /// all together.
    #[inline(never)]
    fn look<S: Simd, V: Floats<S>, const N: usize>(
        &self,
        simd: S,
        (unit, packed, at): (&Unit, &Packed<'_>, usize),
        weights: &[Weights<V>; N],
    ) -> Option<[V::Words; N]> {
        simd.vectorize(
            #[inline(always)]
            || {
                let places = self.places(simd, (unit, packed, at), weights);
                packed.sample_batch(simd, &places, u32::MAX)
            },
        )
    }

    /// Coordinates of a texture of the common kind at groups of pixels, and their levels of detail.
    #[inline(always)]
    fn places<S: Simd, V: Floats<S>, const N: usize>(
        &self,
        simd: S,
        (unit, packed, at): (&Unit, &Packed<'_>, usize),
        weights: &[Weights<V>; N],
    ) -> [([V; 2], V); N] {
        let slopes = Slopes::new(self, packed, at);
        let mut places = [self.place(simd, &weights[0], (unit, packed, at), &slopes); N];
        for i in 1..N {
            places[i] = self.place(simd, &weights[i], (unit, packed, at), &slopes);
        }
        places
    }

    /// Modulates colours with a texture of the common kind.
    #[inline(never)]
    fn plain<S: Simd, V: Floats<S>, const N: usize>(
        &self,
        simd: S,
        groups: &Groups<'_, V, N>,
        (unit, packed, at): (&Unit, &Packed<'_>, usize),
        colors: &mut [[V; 4]; N],
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                // Take the colours that are kept from the last draw.
                let format = format_of(&unit.texture);
                if let Some(words) = groups.seen.filter(|_| self.draw.again == Some(unit.index)) {
                    for (color, words) in colors.iter_mut().zip(words.chunks_exact(V::LEN)) {
                        *color = modulate(
                            format,
                            &packed.meaning(V::Words::from_slice(simd, words)),
                            *color,
                        );
                    }
                    return;
                }
                // Places and levels of all groups come first: each takes long, but they need not
                // wait for each other.
                let places = self.places(simd, (unit, packed, at), &groups.weights);
                if let Some(words) = packed.sample_batch(simd, &places, groups.active) {
                    for i in 0..N {
                        colors[i] = modulate(format, &packed.meaning(words[i]), colors[i]);
                    }
                    return;
                }

                // Otherwise sample group by group.
                for i in 0..N {
                    let (place, level) = places[i];
                    let texture = packed.at(simd, place, level, groups.active);
                    colors[i] = modulate(format, &texture, colors[i]);
                }
            },
        );
    }

    /// Modulates colours with a cube map of the common kind.
    #[inline(never)]
    fn cube<S: Simd, V: Floats<S>, const N: usize>(
        &self,
        simd: S,
        groups: &Groups<'_, V, N>,
        (unit, packed, at): (&Unit, &PackedCube<'_>, usize),
        colors: &mut [[V; 4]; N],
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                let format = format_of(&unit.texture);
                // As for flat textures, places of all groups come first.
                let mut places =
                    [self.place_on_cube(simd, &groups.weights[0], (unit, packed, at)); N];
                for i in 1..N {
                    places[i] = self.place_on_cube(simd, &groups.weights[i], (unit, packed, at));
                }
                for i in 0..N {
                    let (place, level) = places[i];
                    colors[i] = modulate(format, &packed.at(simd, place, level), colors[i]);
                }
            },
        );
    }

    /// Modulates colours with a shadow map of the common kind.
    #[inline(never)]
    fn shadow<S: Simd, V: Floats<S>, const N: usize>(
        &self,
        simd: S,
        groups: &Groups<'_, V, N>,
        (unit, packed, at): (&Unit, &PackedShadow<'_>, usize),
        colors: &mut [[V; 4]; N],
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                let format = format_of(&unit.texture);
                let mut places = [packed.place(simd, self.four(simd, &groups.weights[0], at)); N];
                for i in 1..N {
                    places[i] = packed.place(simd, self.four(simd, &groups.weights[i], at));
                }
                for i in 0..N {
                    let texture = packed.at(simd, places[i], groups.active);
                    colors[i] = modulate(format, &texture, colors[i]);
                }
            },
        );
    }

    /// Faces of a cube map of the common kind and points on them at a group of pixels, and the
    /// level of detail.
    #[inline(always)]
    fn place_on_cube<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        weights: &Weights<V>,
        (unit, packed, at): (&Unit, &PackedCube<'_>, usize),
    ) -> ((V::Ints, [V; 2]), V) {
        // Find the face and the point on it.
        let direction = lanes::three(
            #[inline(always)]
            |k| self.value(simd, weights, at + k),
        );
        let chart = Chart::new(simd, direction);

        // Add the level of detail from the derivatives on the face.
        let mut level = every(simd, unit.lod_bias);
        if packed.needs_lod() {
            let steps = [self.step(simd, weights, at, 0), self.step(simd, weights, at, 1)];
            let [across, up] = derivatives_on_faces(simd, packed.size(), &chart, steps);
            let square = lanes::inlined(
                #[inline(always)]
                |[s, t]: [V; 2]| s * s + t * t,
            );
            level += half_log2(max(square(across), square(up)));
        }
        ((chart.face(simd), chart.point()), level)
    }

    /// How s, t, r change with one pixel to the right (axis 0), or one up.
    #[inline(always)]
    fn step<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        weights: &Weights<V>,
        at: usize,
        axis: usize,
    ) -> [V; 3] {
        let [db1, db2] = self.scratch.interpolation.weight_steps(simd, weights, axis);
        let d = &self.scratch.differences;
        lanes::three(
            #[inline(always)]
            |k| db1 * d.d1[(at + k) % MAX_NUMBERS] + db2 * d.d2[(at + k) % MAX_NUMBERS],
        )
    }

    /// Coordinates of a texture of the common kind at a group of pixels, and the level of detail.
    #[inline(always)]
    fn place<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        weights: &Weights<V>,
        (unit, packed, at): (&Unit, &Packed<'_>, usize),
        slopes: &Slopes,
    ) -> ([V; 2], V) {
        let place = [self.value(simd, weights, at), self.value(simd, weights, at + 1)];
        let bias = every(simd, unit.lod_bias);
        if slopes.divided {
            let (place, level) = self.divided(simd, weights, packed.size(), at, place);
            return (place, level + bias);
        }
        let level =
            if packed.needs_lod() { slopes.level(simd, weights, &place) + bias } else { bias };
        (place, level)
    }

    /// Coordinates divided by q, and the level of detail.
    #[inline(never)]
    fn divided<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        weights: &Weights<V>,
        size: [f32; 2],
        at: usize,
        place: [V; 2],
    ) -> ([V; 2], V) {
        simd.vectorize(
            #[inline(always)]
            || {
                // Divide the coordinates by q.
                let d = &self.scratch.differences;
                let q_at = (at + 3) % MAX_NUMBERS;
                let inverse_q = every::<S, V>(simd, 1.0) / self.value(simd, weights, q_at);
                let place = [place[0] * inverse_q, place[1] * inverse_q];

                // Sum the squares of the derivatives along both screen axes.
                let mut squares: [V; 2] = [every(simd, 0.0); 2];
                for axis in 0..2 {
                    let [db1, db2] = self.scratch.interpolation.weight_steps(simd, weights, axis);
                    let dq = db1 * d.d1[q_at] + db2 * d.d2[q_at];
                    for k in 0..2 {
                        let n = (at + k) % MAX_NUMBERS;
                        let step =
                            (db1 * d.d1[n] + db2 * d.d2[n] - place[k] * dq) * inverse_q * size[k];
                        squares[axis] += step * step;
                    }
                }
                (place, half_log2(max(squares[0], squares[1])))
            },
        )
    }
}

/// How the coordinates of a texture of the common kind change over a facet. With `s` a coordinate
/// less corner 0's, `ds/dx = (d(Σ s l / w)/dx - s d(Σ l / w)/dx) w`.
struct Slopes {
    /// For x and y, for s and t: `d(Σ s l / w)` and `d(Σ l / w)`, times the size in texels.
    numerator: [[f32; 2]; 2],
    sum: [[f32; 2]; 2],
    /// The coordinates of corner 0.
    base: [f32; 2],
    /// All corners have one w: `ds/dx` is the numerator.
    flat: bool,
    /// Coordinates must be divided by q.
    divided: bool,
}

impl Slopes {
    #[inline(always)]
    fn new(shader: &Shader<'_>, packed: &Packed<'_>, at: usize) -> Self {
        // Compute the changes along both screen axes, in texels.
        let (i, d) = (&shader.scratch.interpolation, &shader.scratch.differences);
        let size = packed.size();
        let (mut numerator, mut sum) = ([[0.0; 2]; 2], [[0.0; 2]; 2]);
        for axis in 0..2 {
            for k in 0..2 {
                let n = (at + k) % MAX_NUMBERS;
                numerator[axis][k] =
                    (i.first[axis + 1] * d.d1[n] + i.second[axis + 1] * d.d2[n]) * size[k];
                sum[axis][k] = i.sum[axis + 1] * size[k];
            }
        }
        Self {
            numerator,
            sum,
            base: [d.base[at % MAX_NUMBERS], d.base[(at + 1) % MAX_NUMBERS]],
            flat: i.flat_w.is_some(),
            divided: shader.is_divided(at),
        }
    }

    /// The level of detail.
    #[inline(always)]
    fn level<S: Simd, V: Floats<S>>(&self, simd: S, weights: &Weights<V>, place: &[V; 2]) -> V {
        let mut squares: [V; 2] = [every(simd, 0.0); 2];
        for axis in 0..2 {
            for k in 0..2 {
                let mut step: V = every(simd, self.numerator[axis][k]);
                if !self.flat {
                    step -= (place[k] - self.base[k]) * self.sum[axis][k];
                }
                squares[axis] += step * step;
            }
        }
        let longer = max(squares[0], squares[1]);
        let longer = if self.flat { longer } else { longer * weights.w * weights.w };
        half_log2(longer)
    }
}
