//! Points whose colours are all that a picture takes of them, as most are: sixteen go together
//! where registers hold as many, and what textures and vertex colours would vary is left out where
//! there are none. The results are those of the general way, bit by bit.
//!
//! In:   points of one object and material. Out: their colours.
//! Cost: linear in points, times the number of lights.

use super::FrameConstants;
use super::batch::ShadingBatch8;
use super::geometry::{F, Placed, every, surface, surfaces};
use super::lighting::{Coefficients, NUMBERS, lighting};
use super::material_constants::MaterialConstants;
use super::model::Model;
use super::phong;
use super::shaded_points::{ShadedPoints, premultiplied};
use super::surface_parameters::{self, SurfaceParameters};
use crate::{Interpolation, Shading};
use vitral_math::lanes::{Floats, LANES, Lanes, Simd, V3};

/// Whether the picture takes nothing of a material's points but what they reflect and shine.
#[inline(always)]
pub(super) fn has_color_only(
    material: &MaterialConstants<'_>,
    constants: &FrameConstants<'_>,
) -> bool {
    constants.shading == Shading::Phong
        && material.model.needs_light_visibility()
        && constants.radiosity.is_none()
        && !constants.transparency.tints()
        && material.scatters.is_none()
        && !constants.follows_rays()
        && constants.interpolation == Interpolation::Perspective
        && constants.fade.is_none()
        && constants.occlusion.is_none()
}

/// Illuminates what [`has_color_only`]: eight points and the next eight of the group, or the first
/// eight alone.
pub(super) fn shade_color_only<S: Simd, V: Floats<S>>(
    simd: S,
    eights: [&ShadingBatch8<'_>; 2],
    uniform: bool,
    constants: &FrameConstants<'_>,
    lit: &mut ShadedPoints,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            // Find the numbers of the points: the same for all, or by lane.
            let first = eights[0];
            let points: PointNumbers<V> = if uniform {
                PointNumbers::uniform(simd, eights)
            } else {
                PointNumbers::from_array(
                    first.material.model,
                    V::by_eights(
                        simd,
                        [],
                        #[inline(always)]
                        |lane, []| point_numbers(simd, eights[lane / LANES], constants),
                    ),
                )
            };
            let PointNumbers {
                placed: Placed { position, normal },
                emission,
                alpha,
                coverage,
                coefficients,
            } = points;

            // Reflect the lights and premultiply the colours by alpha and coverage.
            let reflected =
                lighting(first, constants).reflect(simd, &position, &normal, &coefficients);
            let color = premultiplied(first.material, false, &reflected, emission, alpha, coverage);

            // Store the colours, eight points at a time.
            V::by_eights(
                simd,
                [color.x, color.y, color.z, alpha],
                #[inline(always)]
                |lane, color| {
                    lit.put_colors(simd, eights[lane / LANES].points, color);
                    []
                },
            );
        },
    );
}

/// What [`shade_color_only`] needs of points.
struct PointNumbers<T> {
    placed: Placed<T>,
    emission: V3<T>,
    alpha: T,
    coverage: T,
    coefficients: Coefficients<T>,
}

impl<T: Lanes> PointNumbers<T> {
    #[inline(always)]
    fn to_array(&self) -> [T; NUMBERS + 11] {
        let Self {
            placed: Placed { position: p, normal: n },
            emission: e,
            alpha,
            coverage,
            coefficients,
        } = self;
        let mut numbers = [*alpha; NUMBERS + 11];
        numbers[..11]
            .copy_from_slice(&[p.x, p.y, p.z, n.x, n.y, n.z, e.x, e.y, e.z, *alpha, *coverage]);
        numbers[11..].copy_from_slice(&coefficients.numbers());
        numbers
    }

    #[inline(always)]
    fn from_array(model: Model, numbers: [T; NUMBERS + 11]) -> Self {
        let v3 = |at: usize| V3::new(numbers[at], numbers[at + 1], numbers[at + 2]);
        let mut of_coefficients = [numbers[0]; NUMBERS];
        of_coefficients.copy_from_slice(&numbers[11..]);
        Self {
            placed: Placed { position: v3(0), normal: v3(3) },
            emission: v3(6),
            alpha: numbers[9],
            coverage: numbers[10],
            coefficients: Coefficients::from_numbers(model, of_coefficients),
        }
    }
}

impl<T: Lanes> PointNumbers<T> {
    /// Of a material that nothing varies.
    #[inline(always)]
    fn uniform<S: Simd>(simd: S, eights: [&ShadingBatch8<'_>; 2]) -> Self
    where
        T: Floats<S>,
    {
        let (one, material) = (every(simd, 1.0), eights[0].material);
        let (coefficients, alpha) = surface_parameters::uniform(one, material);
        let placed =
            Placed::new(&surfaces(simd, eights[0].records, [eights[0].slots, eights[1].slots]));
        Self {
            placed,
            emission: V3::splat(one, material.material.emission),
            alpha,
            coverage: one,
            coefficients,
        }
    }
}

/// Whether all points of a material on a mesh look the same but for how they are placed.
pub(super) fn is_uniform(eight: &ShadingBatch8<'_>, constants: &FrameConstants<'_>) -> bool {
    let (material, mesh) = (eight.material, eight.subject.mesh);
    let varied_by_angle =
        material.blend && (material.material.glass || constants.transparency.varies_by_angle());
    !varied_by_angle && !material.has_textures() && mesh.colors.is_none()
}

/// [`PointNumbers`] of eight points, whatever the material.
#[inline(never)]
fn point_numbers<S: Simd>(
    simd: S,
    eight: &ShadingBatch8<'_>,
    constants: &FrameConstants<'_>,
) -> [F<S>; NUMBERS + 11] {
    simd.vectorize(
        #[inline(always)]
        || {
            let &ShadingBatch8 { subject, material, slots, records, .. } = eight;
            let surface = surface(simd, records, slots);
            let mut parameters = SurfaceParameters::new(
                simd,
                subject.mesh,
                slots,
                &surface,
                material,
                constants.raw,
            );
            parameters.let_through(simd, &surface, material, constants, None);
            let normal = parameters.mapped_normal(simd, subject, slots, &surface, material);
            let numbers = PointNumbers {
                placed: phong::placed(&surface, normal),
                emission: parameters.emission,
                alpha: parameters.alpha,
                coverage: parameters.coverage,
                coefficients: parameters.coefficients(simd, material, parameters.base),
            };
            numbers.to_array()
        },
    )
}
