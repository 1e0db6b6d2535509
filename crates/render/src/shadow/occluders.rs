//! How much of the light a facet keeps: all of it if it is opaque, else what its opacity, textures
//! and vertex colours say at the point where the ray passes. With filtered transparency, what
//! passes has the colour of the glass.

use super::facet::weights;
use crate::display::DecodeTables;
use crate::transparency::{filtered, linear};
use crate::{Session, Settings};
use vitral_frame::Encoding;
use vitral_light::{AlphaMode, Material, Rgb, TextureRef};
use vitral_math::{DVec3, Vec3};
use vitral_scene::{Attribute, Mesh};

/// See the module.
pub(crate) struct Occluders<'a> {
    session: &'a Session,
    /// For each material whether it keeps all light.
    opaque: Vec<bool>,
    all_opaque: bool,
    /// Blended materials keep all light, too.
    blend_is_opaque: bool,
    filtered: bool,
    tables: DecodeTables,
}

impl<'a> Occluders<'a> {
    pub(crate) fn new(session: &'a Session, settings: &Settings) -> Self {
        let blend_is_opaque = !settings.transparency.model.sees_through();
        let opaque = |m: &Material| match m.alpha_mode {
            AlphaMode::Opaque => true,
            AlphaMode::Mask { .. } => false,
            AlphaMode::Blend => blend_is_opaque,
        };
        let opaque: Vec<bool> = session.scene.materials.iter().map(opaque).collect();
        let all_opaque = opaque.iter().all(|&o| o);
        let filtered = settings.transparency.model.tints();
        let tables = DecodeTables::new(settings.picture.color_space);
        Self { session, opaque, all_opaque, blend_is_opaque, filtered, tables }
    }

    /// Facets keep all light in one scene and not in another, or with other settings; this tells
    /// the settings apart.
    pub(super) fn key(&self) -> bool {
        self.blend_is_opaque
    }

    /// Whether a facet keeps all light.
    pub(crate) fn is_opaque(&self, facet: u32) -> bool {
        if self.all_opaque {
            return true;
        }
        let world = &self.session.world;
        let instance = &world.instances[world.instance_of_facet(facet)];
        let material = instance.mesh.material_of_triangle((facet - instance.first_facet) as usize);
        material.and_then(|m| self.opaque.get(m as usize)).is_none_or(|&opaque| opaque)
    }

    /// The part of light that passes the facet with these corners at `point` of it.
    #[inline(always)]
    pub(crate) fn transmittance(
        &self,
        facet: u32,
        corners: &[Vec3; 3],
        point: impl Fn() -> DVec3,
    ) -> Rgb {
        if self.all_opaque { [0.0; 3] } else { self.transmittance_at(facet, corners, point()) }
    }

    /// What passes the facet, if it is the same all over.
    pub(super) fn transmittance_anywhere(&self, facet: u32) -> Option<Rgb> {
        let (mesh, _, material) = self.look(facet);
        let Some(material) = material else { return Some([0.0; 3]) };
        let textures = [material.base_texture, material.opacity_texture, metal_texture(material)];
        let differs = mesh.colors.is_some() || textures.iter().any(Option::is_some);
        (!differs)
            .then(|| self.let_through(material, 1.0, opaque_part(material, material.opacity, 1.0)))
    }

    /// The facet's mesh, its triangle there, and its material if that lets light through.
    fn look(&self, facet: u32) -> (&Mesh, usize, Option<&Material>) {
        let world = &self.session.world;
        let instance = &world.instances[world.instance_of_facet(facet)];
        let triangle = (facet - instance.first_facet) as usize;
        let index = instance.mesh.material_of_triangle(triangle);
        let material = index.filter(|&m| self.opaque.get(m as usize).is_some_and(|opaque| !opaque));
        (&instance.mesh, triangle, material.map(|m| &self.session.scene.materials[m as usize]))
    }

    fn transmittance_at(&self, facet: u32, corners: &[Vec3; 3], point: DVec3) -> Rgb {
        let (mesh, triangle, material) = self.look(facet);
        let Some(material) = material else { return [0.0; 3] };

        // Multiply the coverage of vertex colours and of the texture's alpha.
        let weights = weights(corners, point);
        let mut coverage = 1.0;
        if let Some(colors) = &mesh.colors {
            coverage *= blend(colors, mesh, triangle, weights)[3];
        }
        if let Some(texel) = self.sample(material.base_texture, mesh, triangle, weights) {
            coverage *= texel[3];
        }

        // Apply the opacity texture: to the opacity of glass, to the coverage of anything else.
        let mut opacity = material.opacity;
        match self.sample(material.opacity_texture, mesh, triangle, weights) {
            Some(texel) if material.glass => opacity *= texel[0],
            Some(texel) => coverage *= texel[0],
            None => {}
        }

        // Let light through by coverage and the opaque part.
        let metallic = self
            .sample(metal_texture(material), mesh, triangle, weights)
            .map_or(1.0, |texel| texel[2]);
        self.let_through(material, coverage, opaque_part(material, opacity, metallic))
    }

    /// What passes a material of this opacity, of which textures and colours leave so much; as
    /// shading finds it.
    fn let_through(&self, material: &Material, coverage: f32, opacity: f32) -> Rgb {
        let alpha = (opacity * coverage).clamp(0.0, 1.0);
        match material.alpha_mode {
            AlphaMode::Mask { cutoff } => {
                [f32::from(u8::from(alpha < AlphaMode::least_opacity(cutoff))); 3]
            }
            AlphaMode::Blend if self.filtered => {
                let passes = filtered::passes(
                    coverage.clamp(0.0, 1.0),
                    linear::opacity(opacity),
                    material.filter,
                );
                [passes.x, passes.y, passes.z]
            }
            _ => [1.0 - alpha; 3],
        }
    }

    fn sample(
        &self,
        reference: Option<TextureRef>,
        mesh: &Mesh,
        triangle: usize,
        weights: [f32; 3],
    ) -> Option<[f32; 4]> {
        texel(self.session, &self.tables, reference, mesh, triangle, weights, 0.0)
    }
}

/// An opacity, more where glass is metal.
fn opaque_part(material: &Material, opacity: f32, metallic_factor: f32) -> f32 {
    if !material.glass {
        return opacity;
    }
    linear::opacity(linear::opacity(opacity) * linear::dielectric_part(material, metallic_factor))
}

/// The texture that says where glass is metal, which lets nothing through.
fn metal_texture(material: &Material) -> Option<TextureRef> {
    material.metallic_roughness_texture.filter(|_| material.glass)
}

/// A texture at a point of a triangle, at a level of detail (0: the finest); `None` where there is
/// none.
pub(crate) fn texel(
    session: &Session,
    tables: &DecodeTables,
    reference: Option<TextureRef>,
    mesh: &Mesh,
    triangle: usize,
    weights: [f32; 3],
    level: f32,
) -> Option<[f32; 4]> {
    let reference = reference?;
    let texture = session.scene.textures.get(reference.texture as usize)?;
    let uv = blend(mesh.uvs.get(reference.uv_set as usize)?, mesh, triangle, weights);
    let [u, v] = reference.transform.map(|row| uv[0] * row[0] + uv[1] * row[1] + row[2]);
    let decode = match texture.encoding {
        Encoding::Srgb => &tables.srgb,
        Encoding::Linear => &tables.linear,
    };
    Some(texture.sample(&reference.sampler, u, v, level, decode))
}

/// An attribute between the corners of a triangle.
fn blend<const N: usize>(
    a: &Attribute<[f32; N]>,
    mesh: &Mesh,
    triangle: usize,
    weights: [f32; 3],
) -> [f32; N] {
    let corners = a.at(triangle, &mesh.triangles);
    std::array::from_fn(|k| (0..3).map(|c| weights[c] * corners[c][k]).sum())
}
