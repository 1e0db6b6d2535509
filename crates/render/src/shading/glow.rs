//! Light that comes through a translucent surface from light sources behind it.
//!
//! A sheet glows in the light that falls on its other side. The skin of a solid body glows on its
//! inner side, where the light that enters the body is scattered; from outside one sees that
//! through the skin in front, which scatters it once more, and to count the same light there again
//! would be once too much.
//!
//! In:   up to eight points of one object and material. Out: light, premultiplied, in the space of
//!       composition.
//! Cost: one pass over the lights; with shadows one more question for each point of a sheet and
//!       each light.
//! Source: \[Rushmeier & Torrance 1990\], see `vitral_light::transmitted_light`.

use super::FrameConstants;
use super::batch::ShadingBatch8;
use super::geometry::{F, Surface, constant};
use super::lighting::towards_viewer;
use super::surface_parameters::SurfaceParameters;
use crate::Shading;
use vitral_light::transmitted_light;
use vitral_math::lanes::{self, Simd, V3};

/// See the module. One instruction-set function: kept out of line, so that each level compiles it
/// once.
#[inline(never)]
pub(super) fn glow<S: Simd>(
    simd: S,
    eight: &ShadingBatch8<'_>,
    parameters: &SurfaceParameters<S>,
    surface: &Surface<F<S>>,
    constants: &FrameConstants<'_>,
) -> V3<F<S>> {
    simd.vectorize(
        #[inline(always)]
        || {
            let (subject, material, one) = (eight.subject, eight.material, constant(simd, 1.0));
            let position = surface.position();
            let normal = match constants.shading {
                Shading::Flat => surface.facet_normal,
                _ => parameters
                    .mapped_normal(simd, subject, eight.slots, surface, material)
                    .unwrap_or_else(|| surface.interpolated_normal()),
            };

            // Normals are turned to the viewer, light comes from the other side.
            let parts = eight.light_visibility_behind;
            let (v, zero) = (
                towards_viewer(simd, &position, eight.along, subject.viewing.perspective),
                constant(simd, 0.0),
            );
            let away = lanes::Lanes::lt(surface.facet_normal.dot(v), zero);
            let normal = V3::select(away, -normal, normal);
            let light_visibility = lanes::inlined(
                #[inline(always)]
                |j: usize| match parts.get(j) {
                    Some(parts) => parts.eight(simd, eight.first),
                    None => V3::new(one, one, one),
                },
            );

            // Sum the light that shines through; the walls of a body get it on their inner side.
            let mut light =
                transmitted_light(&constants.lights, position, normal, light_visibility);
            if !subject.is_sheet() {
                let [a, b, c] = surface.positions;
                let winding = (b - a).cross(c - a).dot(v);
                let outward = if subject.instance.mirrored { -winding } else { winding };
                light =
                    V3::select(lanes::Lanes::lt(outward, zero), light, V3::new(zero, zero, zero));
            }

            // Filter it by the material.
            let passes = if constants.transparency.tints() {
                V3::splat(one, material.material.filter.map(|f| f.clamp(0.0, 1.0)))
            } else {
                V3::new(one, one, one)
            };
            light.times(passes).scale(lanes::Lanes::saturate(parameters.kt) * parameters.coverage)
        },
    )
}
