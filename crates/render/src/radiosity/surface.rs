//! What elements are made of: what they reflect, what they send out by themselves, and what of them
//! is there at all.
//!
//! An element is looked at in 16 equal parts, in the middle of each: at textures at the level whose
//! texels are as large as a part, so that each element has its own part of the picture, and at
//! vertex colours. Parts that are cut out, or let more than half of the light pass, are not there:
//! light goes through, and the rest of the element has the light to itself. That is asked of the
//! finest level, whose holes have not been blurred away.
//!
//! In:   an element's corners. Out: [`ElementSurface`].
//! Cost: 16 lookups in each texture.

use super::element::Color;
use super::parts::{PARTS, WHOLE, middle, parts};
use super::patch::{Trees, area};
use crate::display::DecodeTables;
use crate::raytrace::triangles::Triangles;
use crate::shadow::{Occluders, facet as facet_of, texel, weights};
use crate::{ColorSpace, Session, Settings, Transparency, TransparencySettings};
use vitral_light::{Material, Reflectance, TextureRef};
use vitral_math::lanes::Lanes;
use vitral_math::{DVec3, Vec3, func};
use vitral_scene::Mesh;

/// Reflectances above this count as this, so that light dies out.
const MOST_REFLECTED: f64 = 0.99;
/// Surfaces that let more of the light pass are not there.
const MOST_PASSING: f32 = 0.5;

/// See the module.
pub(super) struct ElementSurface {
    /// Unit normal of the front.
    pub normal: DVec3,
    /// A bit for each part that is there.
    pub there: u16,
    /// Reflected part of diffuse light, of the parts that are there.
    pub reflectance: Color,
    /// What they send out on front and back.
    pub emission: [Color; 2],
}

/// Looks at surfaces.
pub(super) struct Surfaces<'a> {
    session: &'a Session,
    tables: DecodeTables,
    raw: bool,
    occluders: Occluders<'a>,
    default: Material,
    center: DVec3,
}

impl<'a> Surfaces<'a> {
    pub(super) fn new(session: &'a Session, settings: &Settings) -> Self {
        let linear = Settings {
            transparency: TransparencySettings {
                model: Transparency::Linear,
                ..settings.transparency
            },
            ..settings.clone()
        };
        Self {
            session,
            tables: DecodeTables::new(settings.picture.color_space),
            raw: settings.picture.color_space == ColorSpace::Raw,
            occluders: Occluders::new(session, &linear),
            default: Material::default(),
            center: Triangles::center_of(&session.world),
        }
    }

    /// Looks at a leaf.
    pub(super) fn of(&self, trees: &Trees, node: u32) -> ElementSurface {
        // Find the facet and its material.
        let facet = trees.facet_of_piece(trees.nodes[node as usize].facet);
        let world = &self.session.world;
        let instance = &world.instances[world.instance_of_facet(facet)];
        let triangle = (facet - instance.first_facet) as usize;
        let (corners, normal) = facet_of(instance, triangle as u32, self.center);
        let mesh = &*instance.mesh;
        let material = mesh.material_of_triangle(triangle);
        let material = material
            .and_then(|m| self.session.scene.materials.get(m as usize))
            .unwrap_or(&self.default);

        let corners = corners.map(|c| c.as_vec3());
        let own = trees.places(node);
        let share = area(own) / (PARTS as f64 * area(corners.map(|c| c.as_dvec3())));
        let look = Look { surfaces: self, mesh, triangle, material, share };
        let opaque = self.occluders.is_opaque(facet);
        // What is the same all over is looked at once.
        let varies = look.varies() || !opaque;
        let places = if varies { parts(own).map(middle).to_vec() } else { vec![middle(own)] };

        // Sum over the parts that are not cut out.
        let mut surface =
            ElementSurface { normal, there: 0, reflectance: [0.0; 3], emission: [[0.0; 3]; 2] };
        let mut count = 0.0;
        for (part, &place) in places.iter().enumerate() {
            if opaque || self.is_there(facet, &corners, place) {
                let (reflected, glow) = look.at(weights(&corners, place));
                (0..3).for_each(|k| surface.reflectance[k] += reflected[k]);
                (0..3).for_each(|k| surface.emission[0][k] += glow[k]);
                surface.there |= 1 << part;
                count += 1.0;
            }
        }
        if !varies {
            surface.there = WHOLE;
        }

        // Take the mean, and emit from both sides if the material has two.
        surface.reflectance =
            surface.reflectance.map(|c| (c / f64::max(count, 1.0)).clamp(0.0, MOST_REFLECTED));
        surface.emission[0] = surface.emission[0].map(|c| c / f64::max(count, 1.0));
        if material.double_sided {
            surface.emission[1] = surface.emission[0];
        }
        surface
    }

    fn is_there(&self, facet: u32, corners: &[Vec3; 3], place: DVec3) -> bool {
        self.occluders.transmittance(facet, corners, || place)[0] <= MOST_PASSING
    }
}

/// A material on a triangle.
struct Look<'a> {
    surfaces: &'a Surfaces<'a>,
    mesh: &'a Mesh,
    triangle: usize,
    material: &'a Material,
    /// What a part is of the triangle.
    share: f64,
}

impl Look<'_> {
    fn varies(&self) -> bool {
        let m = self.material;
        let textures = [m.base_texture, m.emission_texture, m.metallic_roughness_texture];
        self.mesh.colors.is_some() || textures.iter().any(Option::is_some)
    }

    /// What is reflected and what is sent out at a point.
    fn at(&self, weights: [f32; 3]) -> (Color, Color) {
        let rgb = |texel: Option<[f32; 4]>| texel.map_or([1.0; 3], |[r, g, b, _]| [r, g, b]);
        let (base, glow) = [self.material.base_texture, self.material.emission_texture]
            .map(|texture| rgb(self.texel(texture, weights)))
            .into();
        let vertex = self.vertex_color(weights);
        let diffuse = match self.material.reflectance {
            Reflectance::Phong { kd, .. } => kd,
            Reflectance::MetallicRoughness { base_color, metallic, .. } => {
                let texel = self.texel(self.material.metallic_roughness_texture, weights);
                let metallic = texel.map_or(metallic, |[_, _, factor, _]| metallic * factor);
                base_color.map(|c| c * (1.0 - metallic.clamp(0.0, 1.0)))
            }
        };
        let reflected = [0, 1, 2].map(|k| f64::from(diffuse[k] * base[k] * vertex[k]));
        let emission = self.material.emission;
        (reflected, [0, 1, 2].map(|k| f64::from(emission[k].max(0.0) * glow[k])))
    }

    /// As shading has it: where files say sRGB, the raw colour space wants it as in the file.
    fn vertex_color(&self, weights: [f32; 3]) -> [f32; 3] {
        let Some(colors) = &self.mesh.colors else { return [1.0; 3] };
        let mut corners = colors.at(self.triangle, &self.mesh.triangles);
        if self.surfaces.raw && self.mesh.colors_from_srgb {
            corners.iter_mut().flatten().for_each(|c| *c = Lanes::srgb_from_linear(*c));
        }
        [0, 1, 2].map(|k| (0..3).map(|c| weights[c] * corners[c][k]).sum())
    }

    fn texel(&self, reference: Option<TextureRef>, weights: [f32; 3]) -> Option<[f32; 4]> {
        let Surfaces { session, tables, .. } = self.surfaces;
        texel(
            session,
            tables,
            reference,
            self.mesh,
            self.triangle,
            weights,
            self.level(reference?)?,
        )
    }

    /// The level whose texels are as large as a part.
    fn level(&self, reference: TextureRef) -> Option<f32> {
        let finest =
            self.surfaces.session.scene.textures.get(reference.texture as usize)?.levels.first()?;
        let uvs =
            self.mesh.uvs.get(reference.uv_set as usize)?.at(self.triangle, &self.mesh.triangles);
        let [[au, av], [bu, bv], [cu, cv]] = uvs.map(|uv| uv.map(f64::from));
        let [[ux, uy, _], [vx, vy, _]] = reference.transform.map(|row| row.map(f64::from));
        let doubled = ((bu - au) * (cv - av) - (bv - av) * (cu - au)) * (ux * vy - uy * vx);
        let texels = 0.5
            * doubled.abs()
            * f64::from(finest.width())
            * f64::from(finest.height())
            * self.share;
        Some((0.5 * func::ln(texels.max(1.0)) / std::f64::consts::LN_2) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use vitral_frame::{Encoding, Plane, Texture, Wrap};
    use vitral_light::AlphaMode;
    use vitral_scene::{Attribute, Scene, builtin::solids};

    const MATT: Reflectance =
        Reflectance::Phong { ka: [0.0; 3], kd: [0.9; 3], ks: [0.0; 3], shininess: 1.0 };

    /// The elements of a unit square in `y = 0`, with their middles. Its texture, 64 texels wide,
    /// is `left` in the left half and `right` in the other.
    fn looks(
        [left, right]: [[u8; 4]; 2],
        settings: &Settings,
        change: impl Fn(&mut Material, &mut Mesh, TextureRef),
    ) -> Vec<(DVec3, ElementSurface)> {
        let mut square = solids::plane(1.0, 1.0, 1, 1);
        let texels = (0..64 * 4).map(|i| if i % 64 < 32 { left } else { right }).collect();
        let texture = Texture::new(
            "halves".to_owned(),
            Plane::from_rows(64, 4, texels).unwrap(),
            Encoding::Linear,
        );
        let mut reference = TextureRef::new(0);
        reference.sampler.wrap_s = Wrap::ClampToEdge;
        let mut material = Material { reflectance: MATT, ..Material::default() };
        change(&mut material, &mut square, reference);
        let mut scene = Scene::default();
        scene.textures.push(Arc::new(texture));
        let material = scene.add_material(material);
        square.parts.iter_mut().for_each(|p| p.material = Some(material));
        scene.add_mesh(square, vitral_math::DMat4::IDENTITY);
        let session = Session::new(Arc::new(scene)).unwrap();
        let trees = crate::radiosity::enclosure::trees(&session, 0.4, &crate::Execution::default())
            .unwrap();
        let surfaces = Surfaces::new(&session, settings);
        trees
            .leaves()
            .into_iter()
            .map(|leaf| (middle(trees.places(leaf)), surfaces.of(&trees, leaf)))
            .collect()
    }

    fn close(a: Color, b: Color) -> bool {
        (0..3).all(|k| (a[k] - b[k]).abs() < 1e-3)
    }

    #[test]
    fn each_element_has_its_part_of_the_texture() {
        let settings = Settings::default();
        let colors = [[255, 0, 0, 255], [0, 255, 0, 255]];
        let found = looks(colors, &settings, |material, _, texture| {
            (material.base_texture, material.emission_texture) = (Some(texture), Some(texture));
            material.emission = [2.0; 3];
        });
        let away = |found: Vec<(DVec3, ElementSurface)>| {
            found.into_iter().filter(|(middle, _)| middle.x.abs() > 0.2)
        };
        assert!(found.len() >= 16);
        for (middle, surface) in away(found) {
            let color = if middle.x < 0.0 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
            assert!(
                close(surface.reflectance, color.map(|c| 0.9 * c)),
                "{middle} {:?}",
                surface.reflectance
            );
            assert!(
                close(surface.emission[0], color.map(|c| 2.0 * c)),
                "{middle} {:?}",
                surface.emission
            );
            assert_eq!((surface.there, surface.emission[1]), (WHOLE, [0.0; 3]));
        }
        // Blue says where there is metal, which is not matt.
        let found = looks([[0, 0, 255, 255], [0, 0, 0, 255]], &settings, |material, _, texture| {
            material.reflectance = Reflectance::MetallicRoughness {
                base_color: [0.8; 3],
                metallic: 1.0,
                roughness: 1.0,
            };
            material.metallic_roughness_texture = Some(texture);
        });
        for (middle, surface) in away(found) {
            let expected = if middle.x < 0.0 { 0.0 } else { 0.8 };
            assert!(
                close(surface.reflectance, [expected; 3]),
                "{middle} {:?}",
                surface.reflectance
            );
        }
    }

    #[test]
    fn each_element_has_its_part_of_the_vertex_colours_as_they_are_shown() {
        let white = [[255; 4]; 2];
        let of = |raw, from_srgb| {
            let color_space = if raw { ColorSpace::Raw } else { ColorSpace::default() };
            looks(white, &Settings::default().with_color_space(color_space), |_, mesh, _| {
                let colors = mesh.positions.iter().map(|p| [p[0] + 0.5, 0.2, 0.2, 1.0]).collect();
                mesh.colors = Some(Attribute::per_vertex(colors));
                mesh.colors_from_srgb = from_srgb;
            })
        };
        for (middle, surface) in of(false, true) {
            assert!(
                close(surface.reflectance, [0.9 * (middle.x + 0.5), 0.18, 0.18]),
                "{:?}",
                surface.reflectance
            );
        }
        let encoded = 0.9 * f64::from(Lanes::srgb_from_linear(0.2f32));
        assert!(of(true, true).iter().all(|(_, s)| (s.reflectance[1] - encoded).abs() < 1e-3));
        assert!(of(true, false).iter().all(|(_, s)| (s.reflectance[1] - 0.18).abs() < 1e-3));
    }

    #[test]
    fn parts_that_are_cut_out_are_not_there() {
        let half = [[255, 255, 255, 0], [255; 4]];
        for alpha_mode in [AlphaMode::Mask { cutoff: 0.5 }, AlphaMode::Blend, AlphaMode::Opaque] {
            let found = looks(half, &Settings::default(), |material, _, texture| {
                (material.alpha_mode, material.base_texture) = (alpha_mode, Some(texture));
            });
            let count =
                |there: fn(u16) -> bool| found.iter().filter(|(_, s)| there(s.there)).count();
            if alpha_mode == AlphaMode::Opaque {
                assert_eq!(count(|there| there == WHOLE), found.len());
                continue;
            }
            assert!(
                count(|there| there == 0) > 0 && count(|there| there == WHOLE) > 0,
                "{alpha_mode:?}"
            );
            let area: u32 = found.iter().map(|(_, s)| s.there.count_ones()).sum();
            let share = f64::from(area) / (PARTS * found.len()) as f64;
            assert!((share - 0.5).abs() < 0.05, "{share}");
            assert!(found.iter().all(|(_, s)| s.there == 0 || close(s.reflectance, [0.9; 3])));
        }
    }
}
