//! What textures and vertex colours make of a material at eight points.
//!
//! A material says how a surface reflects on the whole; its textures and the mesh's colours vary
//! that from point to point. Here they are looked up and put together into the coefficients that
//! the illumination models take.
//!
//! In:   points of one object and material. Out: [`SurfaceParameters`], linear or raw as the
//!       picture is.
//! Cost: a lookup for each texture and point.
//! Source: \[Foley et al. 1990\], 16.3, for textures; the transparency models name their own.

use super::FrameConstants;
use super::batch::ShadingBatch8;
use super::geometry::{F, Surface, blend, blend3, constant, gather, linear as linear_map};
use super::hits::Along;
use super::lighting::Coefficients;
use super::material_constants::{MaterialConstants, TextureConstants};
use super::model::Model;
use super::slots::Slots;
use super::subject::Subject;
use crate::Shading;
use crate::transparency::{kay, linear};
use vitral_light::{
    DIELECTRIC_F0, Microfacet, Phong, Reflectance, microfacet_from_phong, phong_from_microfacet,
};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, LANES, Lanes, Simd, V3};
use vitral_scene::{Attribute, Mesh};

/// What textures and vertex colours make of a material at eight points.
pub(super) struct SurfaceParameters<S: Simd> {
    /// Texture colour alone.
    pub(super) texture: V3<F<S>>,
    /// Texture colour times vertex colour: multiplies the diffuse or base colour.
    pub(super) base: V3<F<S>>,
    /// Vertex colours at the three corners.
    pub(super) corner_colors: [V3<F<S>>; 3],
    pub(super) specular: V3<F<S>>,
    pub(super) emission: V3<F<S>>,
    pub(super) metallic_factor: F<S>,
    pub(super) roughness_factor: F<S>,
    /// How much of the ambient light arrives.
    pub(super) occlusion: F<S>,
    /// How much of the point textures and vertex colours leave of the surface.
    pub(super) coverage: F<S>,
    /// Transmission of the surface where it is.
    pub(super) kt: F<S>,
    /// Opacity, both together.
    pub(super) alpha: F<S>,
}

impl<S: Simd> SurfaceParameters<S> {
    #[inline(always)]
    pub(super) fn new(
        simd: S,
        mesh: &Mesh,
        slots: &Slots,
        surface: &Surface<F<S>>,
        material: &MaterialConstants<'_>,
        raw: bool,
    ) -> Self {
        let one = constant(simd, 1.0);
        let white = V3::new(one, one, one);
        let lookup = lanes::inlined(
            #[inline(always)]
            |texture: &Option<TextureConstants<'_>>| match texture {
                Some(t) => sample(simd, mesh, slots, (surface, &surface.weights), t),
                None => None,
            },
        );

        // Multiply vertex colours by the base texture.
        let colors = vertex_colors(simd, mesh, slots, surface, raw);
        let mut alpha = colors.alpha;
        let base_texture = lookup(&material.base);
        let mut texture = white;
        if let Some(t) = &base_texture {
            texture = V3::new(t[0], t[1], t[2]);
            alpha *= t[3];
        }

        // Look up metalness and roughness.
        let (mut metallic_factor, mut roughness_factor) = (one, one);
        if let Some([_, g, b, _]) = lookup(&material.metallic_roughness) {
            (metallic_factor, roughness_factor) = (b, g);
        }
        // See `Material::opacity_texture`.
        let mut kept = one;
        match lookup(&material.opacity) {
            Some(t) if material.material.glass => kept = t[0],
            Some(t) => alpha *= t[0],
            None => {}
        }
        // Only blended surfaces have degrees of opacity; Kay's model changes it later.
        let coverage = Lanes::saturate(alpha);
        let mut kt = constant(simd, 0.0);
        if material.blend {
            let passing = linear::opacity(kept * material.material.opacity);
            kt = passing * linear::dielectric_part(&material.material, metallic_factor);
        }

        // Apply the cut-out.
        let alpha = if material.soft_cut {
            soft_cut(simd, mesh, slots, surface, material, alpha)
        } else {
            opaque_part(material, alpha)
        };

        // Look up the other textures.
        let mut emission = V3::splat(one, material.material.emission);
        if let Some([r, g, b, _]) = lookup(&material.emission) {
            emission = emission.times(V3::new(r, g, b));
        }
        let mut specular = white;
        if let Some([r, g, b, _]) = lookup(&material.specular) {
            specular = V3::new(r, g, b);
        }
        let mut occlusion = one;
        if let Some([r, ..]) = lookup(&material.occlusion) {
            occlusion = one + (r - one) * material.material.occlusion_strength;
        }
        Self {
            texture,
            base: texture.times(colors.color),
            corner_colors: colors.corners,
            specular,
            emission,
            metallic_factor,
            roughness_factor,
            occlusion,
            coverage,
            kt,
            alpha,
        }
    }

    /// Nearby surfaces keep ambient light away.
    #[inline(always)]
    pub(super) fn occlude(&mut self, simd: S, eight: &ShadingBatch8<'_>) {
        let Some(open) = eight.open.get(eight.first..) else { return };
        if !open.is_empty() {
            let part: [f32; LANES] = std::array::from_fn(|lane| open[lane.min(open.len() - 1)]);
            self.occlusion *= F32x8::from_slice(simd, &part);
        }
    }

    /// Kay's model, and glass: how much light a blended surface lets through depends on how it is
    /// turned.
    #[inline(always)]
    pub(super) fn let_through(
        &mut self,
        simd: S,
        surface: &Surface<F<S>>,
        material: &MaterialConstants<'_>,
        constants: &FrameConstants<'_>,
        along: Option<&Along>,
    ) {
        let kay = constants.transparency.varies_by_angle();
        if !material.blend || !(kay || material.material.glass) {
            return;
        }
        let flat = constants.shading == Shading::Flat;
        let n = if flat { surface.facet_normal } else { surface.interpolated_normal() };
        let facing = match along {
            Some(along) => {
                let position = surface.position();
                let towards = n.dot((along.origin(simd) - position).normalize());
                // As the eye sees it without rays, as long as they come straight from there.
                let straight = Lanes::lt(constant(simd, 0.0), along.straight(simd));
                straight.select(n.z, towards)
            }
            None => n.z,
        };
        self.kt = if kay {
            let least = Lanes::min(constant(simd, material.material.kt_min), self.kt);
            kay::transmission(least, self.kt, facing, constant(simd, constants.kay_exponent))
        } else {
            // Kay's formula with these numbers is what Schlick's leaves.
            let most = self.kt * (1.0 - DIELECTRIC_F0);
            kay::transmission(constant(simd, 0.0), most, facing, constant(simd, 5.0))
        };
        self.alpha = self.coverage * linear::opacity(self.kt);
    }

    /// The surface's own colour.
    #[inline(always)]
    pub(super) fn own(&self, simd: S, material: &MaterialConstants<'_>) -> V3<F<S>> {
        let color = match material.material.reflectance {
            Reflectance::Phong { kd, .. } => kd,
            Reflectance::MetallicRoughness { base_color, .. } => base_color,
        };
        V3::splat(constant(simd, 1.0), color).times(self.base)
    }

    /// What the mirror image is weighed with: the specular coefficient of mirrors.
    #[inline(always)]
    pub(super) fn mirror(&self, simd: S, material: &MaterialConstants<'_>) -> V3<F<S>> {
        let one = constant(simd, 1.0);
        if !material.material.mirror {
            return V3::splat(one, [0.0; 3]);
        }
        match material.material.reflectance {
            Reflectance::Phong { ks, .. } => V3::splat(one, ks).times(self.specular),
            Reflectance::MetallicRoughness { base_color, metallic, .. } => {
                let metallic = Lanes::saturate(self.metallic_factor * metallic);
                let metal = V3::splat(one, base_color).times(self.base).scale(metallic);
                let dielectric = (one - metallic) * DIELECTRIC_F0;
                metal + V3::new(dielectric, dielectric, dielectric)
            }
        }
    }

    /// Coefficients for the material's model, with `color` multiplying the diffuse or base colour.
    pub(super) fn coefficients(
        &self,
        simd: S,
        material: &MaterialConstants<'_>,
        color: V3<F<S>>,
    ) -> Coefficients<F<S>> {
        simd.vectorize(
            #[inline(always)]
            || {
                let factors = Factors {
                    specular: self.specular,
                    metallic: self.metallic_factor,
                    roughness: self.roughness_factor,
                    occlusion: self.occlusion,
                };
                coefficients(&material.material.reflectance, material.model, color, &factors)
            },
        )
    }

    /// The shading normal bent by the normal texture, if there is one and the mesh has texture
    /// coordinates. Red leans it along growing u, green along falling v, which is upwards in the
    /// picture, on both sides of a surface and however its texture is mirrored (glTF's convention).
    pub(super) fn mapped_normal(
        &self,
        simd: S,
        subject: &Subject<'_>,
        slots: &Slots,
        surface: &Surface<F<S>>,
        material: &MaterialConstants<'_>,
    ) -> Option<V3<F<S>>> {
        let (texture, mesh) = (material.normal.as_ref()?, subject.mesh);
        simd.vectorize(
            #[inline(always)]
            || {
                let texel = sample(simd, mesh, slots, (surface, &surface.weights), texture)?;
                let attribute = mesh.uvs.get(texture.reference.uv_set as usize)?;
                let uv = gather_attribute(simd, attribute, mesh, slots);
                let n = surface.interpolated_normal();

                let (e1, e2) = (
                    surface.positions[1] - surface.positions[0],
                    surface.positions[2] - surface.positions[0],
                );
                let (dv1, dv2) = (uv[1][1] - uv[0][1], uv[2][1] - uv[0][1]);
                let (du1, du2) = (uv[1][0] - uv[0][0], uv[2][0] - uv[0][0]);
                let zero = constant(simd, 0.0);
                let flipped = Lanes::lt(du1 * dv2 - du2 * dv1, zero);
                let tangent = e1.scale(dv2) - e2.scale(dv1);
                let tangent = V3::select(flipped, -tangent, tangent);
                // Whether falling v is normal × tangent where corners run counter-clockwise.
                let (tangent, upwards) = match subject.tangents {
                    Some(attribute) => {
                        let (smooth, w) =
                            interpolated_tangent(simd, attribute, subject, slots, surface);
                        let known = Lanes::lt(zero, smooth.dot(smooth));
                        let upwards = (known & Lanes::lt(zero, w)) | (!known & flipped);
                        (V3::select(known, smooth, tangent), upwards)
                    }
                    None => (tangent, flipped),
                };
                let tangent = (tangent - n.scale(n.dot(tangent))).normalize();

                // The normal, u and falling v make a right-handed frame where corners run
                // counter-clockwise on the surface and clockwise in the texture, whose v grows
                // downwards, or both the other way.
                let clockwise = Lanes::lt(e1.cross(e2).dot(surface.facet_normal), zero);
                let bitangent = n.cross(tangent);
                let bitangent = V3::select(clockwise ^ upwards, bitangent, -bitangent);
                let scale = material.material.normal_scale;
                let (x, y, z) = (
                    (texel[0] * 2.0 - 1.0) * scale,
                    (texel[1] * 2.0 - 1.0) * scale,
                    texel[2] * 2.0 - 1.0,
                );
                let leaning = tangent.scale(x) + bitangent.scale(y);
                // The back of a bump is a dent: seen from there, the normal was turned, and leans
                // the other way.
                let back = if subject.instance.mirrored { !clockwise } else { clockwise };
                Some((V3::select(back, -leaning, leaning) + n.scale(z)).normalize())
            },
        )
    }
}

/// Vertex colours of eight points.
struct VertexColors<S: Simd> {
    /// At the three corners of each facet.
    corners: [V3<F<S>>; 3],
    /// At the points.
    color: V3<F<S>>,
    alpha: F<S>,
}

/// The mesh's vertex colours at eight points; white without any. They are kept linear; the raw
/// colour space wants them as they were in the file: glTF's are linear there, as its factors are.
#[inline(always)]
fn vertex_colors<S: Simd>(
    simd: S,
    mesh: &Mesh,
    slots: &Slots,
    surface: &Surface<F<S>>,
    raw: bool,
) -> VertexColors<S> {
    let one = constant(simd, 1.0);
    let white = V3::new(one, one, one);
    let Some(attribute) = &mesh.colors else {
        return VertexColors { corners: [white; 3], color: white, alpha: one };
    };
    let values = gather_attribute(simd, attribute, mesh, slots);
    let mut corners = [white; 3];
    for c in 0..3 {
        let [r, g, b, _] = values[c];
        corners[c] = V3::new(r, g, b);
        if raw && mesh.colors_from_srgb {
            let encode = Lanes::srgb_from_linear;
            corners[c] = V3::new(encode(r), encode(g), encode(b));
        }
    }
    let color = blend3(&surface.weights, &corners);
    VertexColors {
        corners,
        color,
        alpha: blend(&surface.weights, [values[0][3], values[1][3], values[2][3]]),
    }
}

/// Between the tangents at the corners of each lane's facet, view space, and their common `w`.
#[inline(always)]
fn interpolated_tangent<S: Simd>(
    simd: S,
    attribute: &Attribute<[f32; 4]>,
    subject: &Subject<'_>,
    slots: &Slots,
    surface: &Surface<F<S>>,
) -> (V3<F<S>>, F<S>) {
    let to_view = subject.instance.view_from_model.map(|[x, y, z, _]| [x, y, z]);
    let corners = gather_attribute(simd, attribute, subject.mesh, slots);
    let corner = lanes::inlined(
        #[inline(always)]
        |c: usize| {
            let [x, y, z, _] = corners[c];
            linear_map(&to_view, &[x, y, z]).normalize()
        },
    );
    (blend3(&surface.weights, &[corner(0), corner(1), corner(2)]), corners[0][3])
}

/// What textures make of a material's coefficients, besides its colour.
struct Factors<T> {
    specular: V3<T>,
    metallic: T,
    roughness: T,
    occlusion: T,
}

/// Coefficients for a material's model.
#[inline(always)]
fn coefficients<T: Lanes>(
    reflectance: &Reflectance,
    model: Model,
    color: V3<T>,
    factors: &Factors<T>,
) -> Coefficients<T> {
    let &Factors { specular, metallic: metallic_factor, roughness: roughness_factor, occlusion } =
        factors;
    match (*reflectance, model) {
        (Reflectance::Phong { ka, kd, ks, shininess }, model) => {
            let k = Phong {
                ka: V3::splat(occlusion, ka).times(color).scale(occlusion),
                kd: V3::splat(occlusion, kd).times(color),
                ks: V3::splat(occlusion, ks).times(specular),
                shininess: occlusion.splat(shininess),
            };
            match model {
                Model::Microfacet => {
                    Coefficients::Microfacet(Microfacet { occlusion, ..microfacet_from_phong(&k) })
                }
                _ => Coefficients::Empirical(k),
            }
        }
        (Reflectance::MetallicRoughness { base_color, metallic, roughness }, model) => {
            let m = Microfacet {
                base_color: V3::splat(occlusion, base_color).times(color),
                metallic: metallic_factor * metallic,
                roughness: roughness_factor * roughness,
                occlusion,
            };
            match model {
                Model::Microfacet => Coefficients::Microfacet(m),
                _ => Coefficients::Empirical(phong_from_microfacet(&m)),
            }
        }
    }
}

/// A material's coefficients and opacity where neither textures nor vertex colours vary them; `one`
/// is 1.
#[inline(always)]
pub(super) fn uniform<T: Lanes>(one: T, material: &MaterialConstants<'_>) -> (Coefficients<T>, T) {
    let white = V3::new(one, one, one);
    (
        of_base(one, &material.material.reflectance, material.model, white),
        opaque_part(material, one),
    )
}

/// Coefficients where only a base colour varies them; `one` is 1.
#[inline(always)]
pub(super) fn of_base<T: Lanes>(
    one: T,
    reflectance: &Reflectance,
    model: Model,
    base: V3<T>,
) -> Coefficients<T> {
    let white = V3::new(one, one, one);
    let factors = Factors { specular: white, metallic: one, roughness: one, occlusion: one };
    coefficients(reflectance, model, base, &factors)
}

/// Opacity of a material where textures and vertex colours leave `alpha` of the surface.
#[inline(always)]
fn opaque_part<T: Lanes>(material: &MaterialConstants<'_>, alpha: T) -> T {
    let (alpha, one) = (Lanes::saturate(alpha * material.material.opacity), alpha.splat(1.0));
    match (material.cutoff, material.blend) {
        (Some(cutoff), _) => T::select(alpha.lt(alpha.splat(cutoff)), alpha.splat(0.0), one),
        (None, true) => alpha,
        (None, false) => one,
    }
}

/// How much of a pixel a cut-out surface fills where its opacity is `alpha` in the middle: as if
/// that went on as it does to the next pixels, to the right and down, a border of the surface runs
/// through the pixel where it reaches the cutoff.
#[inline(never)]
fn soft_cut<S: Simd>(
    simd: S,
    mesh: &Mesh,
    slots: &Slots,
    surface: &Surface<F<S>>,
    material: &MaterialConstants<'_>,
    alpha: F<S>,
) -> F<S> {
    simd.vectorize(
        #[inline(always)]
        || {
            let [right, down] = surface.neighbours();
            let change = lanes::inlined(
                #[inline(always)]
                |weights: &[F<S>; 3]| {
                    Lanes::abs(alpha_at(simd, mesh, slots, (surface, weights), material) - alpha)
                },
            );
            let opacity = material.material.opacity;
            let width =
                Lanes::max((change(&right) + change(&down)) * opacity, constant(simd, 1e-6));
            let beyond = alpha * opacity - material.cutoff.unwrap_or(0.0);
            Lanes::saturate(beyond / width + 0.5)
        },
    )
}

/// Opacity by textures and vertex colours, at the place with these weights of the corners.
#[inline(always)]
fn alpha_at<S: Simd>(
    simd: S,
    mesh: &Mesh,
    slots: &Slots,
    (surface, weights): (&Surface<F<S>>, &[F<S>; 3]),
    material: &MaterialConstants<'_>,
) -> F<S> {
    let mut alpha = constant(simd, 1.0);
    if let Some(attribute) = &mesh.colors {
        let corners = gather_attribute(simd, attribute, mesh, slots);
        alpha = blend(weights, [corners[0][3], corners[1][3], corners[2][3]]);
    }
    if let Some(texel) =
        material.base.as_ref().and_then(|t| sample(simd, mesh, slots, (surface, weights), t))
    {
        alpha *= texel[3];
    }
    // That of glass says how much light it keeps.
    let opacity = material.opacity.as_ref().filter(|_| !material.material.glass);
    if let Some(texel) = opacity.and_then(|t| sample(simd, mesh, slots, (surface, weights), t)) {
        alpha *= texel[0];
    }
    alpha
}

/// The values of an attribute at the corners of each lane's facet.
#[inline(always)]
fn gather_attribute<S: Simd, const N: usize>(
    simd: S,
    attribute: &Attribute<[f32; N]>,
    mesh: &Mesh,
    slots: &Slots,
) -> [[F<S>; N]; 3] {
    let corners = attribute.corners.as_deref().unwrap_or(&mesh.triangles);
    gather(
        simd,
        #[inline(always)]
        |lane, corner| attribute.values[corners[slots.triangle[lane] as usize][corner] as usize],
    )
}

/// SurfaceParameters a texture up at eight points, where the corners have these weights; `None` if
/// the mesh has no such texture coordinates.
fn sample<S: Simd>(
    simd: S,
    mesh: &Mesh,
    slots: &Slots,
    (surface, weights): (&Surface<F<S>>, &[F<S>; 3]),
    t: &TextureConstants<'_>,
) -> Option<[F<S>; 4]> {
    simd.vectorize(
        #[inline(always)]
        || {
            // Interpolate the coordinates after the texture's transform.
            let attribute = mesh.uvs.get(t.reference.uv_set as usize)?;
            let m = &t.reference.transform;
            let corners = gather_attribute(simd, attribute, mesh, slots);
            let coordinate = lanes::inlined(
                #[inline(always)]
                |r: usize, c: usize| corners[c][0] * m[r][0] + corners[c][1] * m[r][1] + m[r][2],
            );
            let u = [coordinate(0, 0), coordinate(0, 1), coordinate(0, 2)];
            let v = [coordinate(1, 0), coordinate(1, 1), coordinate(1, 2)];
            let here = (blend(weights, u), blend(weights, v));

            // Level of detail: the longer side of the pixel's footprint, in texels.
            let base = t.texture.levels.first()?;
            let (w, h) = (base.width() as f32, base.height() as f32);
            let [right, down] = surface.neighbours();
            let middle = (blend(&surface.weights, u), blend(&surface.weights, v));
            let length2 = lanes::inlined(
                #[inline(always)]
                |weights: &[F<S>; 3]| {
                    let (du, dv) =
                        ((blend(weights, u) - middle.0) * w, (blend(weights, v) - middle.1) * h);
                    du * du + dv * dv
                },
            );
            let lod = Lanes::log2(Lanes::max(length2(&right), length2(&down))) * 0.5;

            // Sample lane by lane.
            let (us, vs, lods) = (here.0.to_array(), here.1.to_array(), lod.to_array());
            let mut soa = [[0.0f32; LANES]; 4];
            for lane in 0..LANES {
                let texel = t.texture.sample(
                    &t.reference.sampler,
                    us[lane],
                    vs[lane],
                    lods[lane],
                    t.decode,
                );
                for k in 0..4 {
                    soa[k][lane] = texel[k];
                }
            }
            Some([
                F32x8::from_slice(simd, &soa[0]),
                F32x8::from_slice(simd, &soa[1]),
                F32x8::from_slice(simd, &soa[2]),
                F32x8::from_slice(simd, &soa[3]),
            ])
        },
    )
}
