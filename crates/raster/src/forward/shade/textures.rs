//! What a facet's textures make of its colour: coordinates, level of detail, lookups and environments, eight pixels at a
//! time.

use super::{Eight, MOST, Shader, Weights};
use crate::forward::assemble::Shape;
use crate::forward::environment::{UNITS, environment, format_of, modulate};
use crate::forward::sample::anisotropic::sample_anisotropic;
use crate::forward::sample::mip::{derivatives, half_log2, lod, needs_lod};
use crate::forward::sample::packed::Packed;
use crate::forward::sample::sample;
use crate::forward::state::{EnvironmentMode, Unit};
use crate::forward::wide::{Rgba, splat, splat_rgba};
use vitral_math::lanes::Simd;

impl Shader<'_> {
    /// All units' textures and environments.
    #[inline(always)]
    pub(super) fn textured<S: Simd>(&self, simd: S, eight: &Eight<'_, S>, primary: &Rgba<S>) -> Rgba<S> {
        // The mode that nearly all programs use needs no other unit's texture.
        if self.state.units.iter().all(|unit| unit.mode == EnvironmentMode::Modulate) {
            let mut color = *primary;
            for unit in &self.state.units {
                let texture = self.texture(simd, eight, unit);
                color = modulate(format_of(&unit.texture), &texture, color);
            }
            return color;
        }
        self.combined(simd, eight, primary)
    }

    /// All units' textures and environments, where one may use another's texture.
    #[inline(never)]
    fn combined<S: Simd>(&self, simd: S, eight: &Eight<'_, S>, primary: &Rgba<S>) -> Rgba<S> {
        let mut textures = [splat_rgba(simd, [0.0; 4]); UNITS];
        for unit in &self.state.units {
            textures[unit.index % UNITS] = self.texture(simd, eight, unit);
        }
        let mut color = *primary;
        for unit in &self.state.units {
            color = environment(simd, unit, &textures, primary, color);
        }
        color
    }

    /// A unit's texture: the common kind has a path of its own.
    #[inline(never)]
    fn texture<S: Simd>(&self, simd: S, eight: &Eight<'_, S>, unit: &Unit) -> Rgba<S> {
        if let Some((_, packed)) = self.plain.iter().find(|(index, _)| *index == unit.index)
            && let Some(at) = self.layout.tex[unit.index % UNITS]
        {
            return self.plain(simd, eight, packed, (at, unit.lod_bias));
        }
        simd.vectorize(
            #[inline(always)]
            || self.any(simd, eight, unit),
        )
    }

    /// Any texture: sprites, borders, volumes, cubes, depth, anisotropy.
    #[inline(always)]
    fn any<S: Simd>(&self, simd: S, eight: &Eight<'_, S>, unit: &Unit) -> Rgba<S> {
        let &Eight { weights, x, y, active } = eight;
        let texture = &*unit.texture;
        let mut coords = match self.layout.tex[unit.index % UNITS] {
            Some(at) => self.four(simd, weights, at),
            None => splat_rgba(simd, [0.0, 0.0, 0.0, 1.0]),
        };
        let bias = splat(simd, unit.lod_bias);
        let mut sprite = None;
        if self.layout.sprites >> unit.index & 1 == 1
            && let Some(Shape::Point { center, size, .. }) = self.shape
        {
            // s runs to the right, t downwards.
            coords[0] = (x - center[0]) / size + 0.5;
            coords[1] = (-(y - center[1])) / size + 0.5;
            (coords[2], coords[3]) = (splat(simd, 0.0), splat(simd, 1.0));
            sprite = Some(1.0 / size);
        }
        let anisotropic = texture.sampler.anisotropy > 1.0;
        if !needs_lod(texture) && !anisotropic {
            let plane = self.planes[unit.index % UNITS];
            return sample(simd, texture, plane, coords, bias, active);
        }
        let [dx, dy] = match sprite {
            Some(step) => {
                let (zero, step) = (splat(simd, 0.0), splat(simd, step));
                [[step, zero, zero, zero], [zero, -step, zero, zero]]
            }
            None => self.steps(simd, weights, self.layout.tex[unit.index % UNITS]),
        };
        let steps = derivatives(simd, texture, coords, dx, dy);
        if anisotropic {
            return sample_anisotropic(simd, texture, coords, steps, bias, active);
        }
        let level = lod(steps[0][0], steps[0][1], steps[0][2], steps[1][0], steps[1][1], steps[1][2]);
        sample(simd, texture, None, coords, level + bias, active)
    }

    /// How s, t, r, q change with one pixel to the right, and one up.
    #[inline(always)]
    fn steps<S: Simd>(&self, simd: S, weights: &Weights<S>, at: Option<usize>) -> [Rgba<S>; 2] {
        let zero = splat_rgba(simd, [0.0; 4]);
        let Some(at) = at else { return [zero; 2] };
        let i = &self.scratch.interpolation;
        let d = &self.scratch.differences;
        let mut steps = [zero; 2];
        for axis in 0..2 {
            let [db1, db2] = i.weight_steps(simd, weights, axis);
            for k in 0..4 {
                steps[axis][k] = db1 * d.d1[(at + k) % MOST] + db2 * d.d2[(at + k) % MOST];
            }
        }
        steps
    }

    /// The common kind of texture: two dimensions, 8 bits a component, no border in reach, no anisotropy.
    #[inline(never)]
    fn plain<S: Simd>(
        &self,
        simd: S,
        &Eight { weights, active, .. }: &Eight<'_, S>,
        packed: &Packed<'_>,
        (at, bias): (usize, f32),
    ) -> Rgba<S> {
        simd.vectorize(
            #[inline(always)]
            || {
                let d = &self.scratch.differences;
                let [mut s, mut t] = [self.value(simd, weights, at), self.value(simd, weights, at + 1)];
                let (q_at, projected) = ((at + 3) % MOST, d.varies >> ((at + 3) % MOST) & 1 == 1);
                let q = projected || d.base[q_at] != 1.0;
                let inverse_q = if q { splat(simd, 1.0) / self.value(simd, weights, q_at) } else { splat(simd, 1.0) };
                if q {
                    (s, t) = (s * inverse_q, t * inverse_q);
                }
                let mut level = splat(simd, bias);
                if packed.needs_lod() {
                    let size = packed.size();
                    let mut squares = [splat(simd, 0.0); 2];
                    for axis in 0..2 {
                        let [db1, db2] = self.scratch.interpolation.weight_steps(simd, weights, axis);
                        for (k, place) in [s, t].into_iter().enumerate() {
                            let mut step = db1 * d.d1[(at + k) % MOST] + db2 * d.d2[(at + k) % MOST];
                            if projected {
                                step -= place * (db1 * d.d1[q_at] + db2 * d.d2[q_at]);
                            }
                            if q {
                                step *= inverse_q;
                            }
                            let step = step * size[k];
                            squares[axis] += step * step;
                        }
                    }
                    level += half_log2(squares[0], squares[1]);
                }
                packed.at(simd, [s, t], level, active)
            },
        )
    }
}
