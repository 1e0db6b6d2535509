//! Flat (constant) shading: one intensity for each face of the file, however many triangles it was
//! cut into.
//!
//! The model supposes light and viewer at infinity; here both are taken as seen from the face's
//! centre. Neighbouring faces differ in steps, and the eye exaggerates them (Mach bands).
//!
//! Input: the face's centre and normal, model space. Output: reflected light, the same at all
//! points of the face.
//! Source: [Foley et al. 1990], 16.2.1.

use super::face_table::FaceTable;
use super::geometry::{Placed, Surface, affine, gather, linear};
use super::instance_constants::InstanceConstants;
use super::lighting::{Coefficients, Lighting};
use super::slots::Slots;
use vitral_light::Reflected;
use vitral_math::lanes::{F32x8, Lanes, Simd, V3};
use vitral_scene::Mesh;

/// Illuminates each point's face at its centre.
#[inline(always)]
pub(crate) fn shade<S: Simd>(
    simd: S,
    mesh: &Mesh,
    faces: &FaceTable,
    instance: &InstanceConstants,
    slots: &Slots,
    surface: &Surface<F32x8<S>>,
    lighting: &Lighting<'_>,
    coefficients: &Coefficients<F32x8<S>>,
) -> Reflected<F32x8<S>> {
    let Placed { position, normal } = placed(simd, (mesh, faces), instance, slots, surface);
    lighting.reflect(simd, &position, &normal, coefficients)
}

/// Where each point's face has its centre, and how it is turned.
#[inline(always)]
pub(super) fn placed<S: Simd>(
    simd: S,
    (mesh, faces): (&Mesh, &FaceTable),
    instance: &InstanceConstants,
    slots: &Slots,
    surface: &Surface<F32x8<S>>,
) -> Placed<F32x8<S>> {
    let [a, b, c] = surface.positions;
    if faces.centers_and_normals.is_empty() {
        let third = a.x.splat(1.0 / 3.0);
        return Placed { position: (a + b + c).scale(third), normal: surface.facet_normal };
    }
    let [center, normal] = gather(
        simd,
        #[inline(always)]
        |lane, which| {
            let face = mesh.face_of_triangle(slots.triangle[lane] as usize);
            faces.centers_and_normals[face][which]
        },
    );
    let position = affine(&instance.view_from_model, &center);
    let normal = linear(&instance.view_from_model_normal, &normal).normalize();
    // The facet's own normal has been turned to the viewer where both sides are seen: follow it.
    let behind = normal.dot(surface.facet_normal).lt(a.x.splat(0.0));
    Placed { position, normal: V3::select(behind, -normal, normal) }
}
