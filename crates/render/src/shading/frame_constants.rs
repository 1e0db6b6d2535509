//! What stays the same for all points of a frame: matrices of each instance, lights, materials, the background.

use super::depth_cue::Fade;
use super::flat::FaceTable;
use super::group::{Model, model};
use super::points::offset;
use crate::prepare::{is_solid, mirrors};
use crate::radiosity::Solution;
use crate::shadow::Shadows;
use crate::transparency::{Lay, registry};
use crate::{
    Cached, PerMesh, Reuse,
    Background, ColorSpace, Execution, Global, Interpolation, PreparedView, Settings, Shading, Transparency,
    TransparencyOrder,
};
use std::convert::Infallible;
use std::sync::Arc;
use vitral_frame::Texture;
use vitral_frame::texture::decode_table;
use vitral_light::{AlphaMode, Light, Material, PreparedLight, Rgb, TextureRef, Transmission, scattering_exponent};
use vitral_math::color::byte_from_unit;
use vitral_math::lanes::{Lanes, Level};
use vitral_math::{DMat4, DVec4};

/// Matrices of an instance, as rows.
#[derive(Clone, Debug)]
pub(crate) struct InstanceConstants {
    /// Model space to `(X, Y, W)` with `X / W`, `Y / W` in pixels.
    pub screen_from_model: [[f32; 4]; 3],
    /// Model space to view space.
    pub view_from_model: [[f32; 4]; 3],
    /// Normals, model to view space, up to a positive factor.
    pub view_from_model_normal: [[f32; 3]; 3],
    /// Back faces can be seen and are lit like front faces.
    pub two_sided: bool,
    /// The transform turns right into left: geometric normals change sign.
    pub mirrored: bool,
}

/// A texture as a material uses it, ready to sample.
pub(crate) struct TextureConstants<'a> {
    pub texture: &'a Texture,
    pub reference: TextureRef,
    pub decode: &'a [f32; 256],
}

/// A material, ready for the formulas.
pub(crate) struct MaterialConstants<'a> {
    pub material: Material,
    pub model: Model,
    pub base: Option<TextureConstants<'a>>,
    pub specular: Option<TextureConstants<'a>>,
    pub emission: Option<TextureConstants<'a>>,
    pub opacity: Option<TextureConstants<'a>>,
    pub metallic_roughness: Option<TextureConstants<'a>>,
    pub occlusion: Option<TextureConstants<'a>>,
    pub normal: Option<TextureConstants<'a>>,
    /// Below this alpha nothing is there (cut-outs), else `None`.
    pub cutoff: Option<f32>,
    /// Its cut-outs have soft borders, a pixel wide: pixels have several samples, which do not decide by themselves.
    pub soft_cut: bool,
    /// Alpha matters.
    pub blend: bool,
    /// Rays that meet it are followed on.
    pub follows: bool,
    /// It is translucent: the exponent with which it scatters what passes.
    pub scatters: Option<f32>,
}

impl MaterialConstants<'_> {
    /// Whether something may be seen behind it.
    pub(super) fn is_layered(&self) -> bool {
        self.cutoff.is_some() || self.blend
    }

    /// Whether textures vary it.
    pub(super) fn has_textures(&self) -> bool {
        let Self { base, specular, emission, opacity, metallic_roughness, occlusion, normal, .. } = self;
        [base, specular, emission, opacity, metallic_roughness, occlusion, normal]
            .iter()
            .any(|texture| texture.is_some())
    }
}

/// Decode tables of one frame.
pub(crate) struct DecodeTables {
    pub(crate) srgb: [f32; 256],
    pub(crate) linear: [f32; 256],
}

impl DecodeTables {
    pub(crate) fn new(color_space: ColorSpace) -> Self {
        let raw = color_space == ColorSpace::Raw;
        Self {
            srgb: decode_table(vitral_frame::Encoding::Srgb, raw),
            linear: decode_table(vitral_frame::Encoding::Linear, raw),
        }
    }
}

/// See the module.
pub(crate) struct FrameConstants<'a> {
    pub view: &'a PreparedView<'a>,
    pub instances: Vec<InstanceConstants>,
    /// The scene's materials, and the default material last.
    pub materials: Vec<MaterialConstants<'a>>,
    pub lights: Vec<PreparedLight>,
    /// What flat shading knows of each mesh.
    pub faces: Arc<PerMesh<FaceTable>>,
    /// For each of these lights its number among all, as shadows count them.
    pub light_numbers: Vec<usize>,
    /// What says which part of a light arrives; `None` without shadows.
    pub shadows: Option<&'a dyn Shadows>,
    /// Light from other surfaces; `None` without radiosity.
    pub radiosity: Option<&'a Solution>,
    /// For each facet whether rays that meet it are followed on; empty without ray tracing.
    follows: Vec<bool>,
    /// Global ambient light.
    pub ambient: Rgb,
    pub shading: Shading,
    pub interpolation: Interpolation,
    pub raw: bool,
    /// How much transparent surfaces let through.
    pub transparency: Transparency,
    /// The exponent of Kay's model.
    pub kay_exponent: f32,
    /// How they are laid over each other.
    pub lay: Lay,
    /// How distance shows; `None` where it does not.
    pub fade: Option<Fade>,
    /// For each set of few samples their middle within the pixel, see `points`.
    pub middles: Vec<[f32; 2]>,
    /// Layers are wanted pass by pass.
    pub in_passes: bool,
    /// Surfaces are drawn in the background's colour.
    pub surfaces_are_background: bool,
    pub background: Arc<BackgroundRows>,
    /// Instructions to use.
    pub level: Level,
}

/// What the rows of the background depend on: what it is, the picture's height, whether the colour space is raw.
pub(crate) type BackgroundKey = (Background, u32, bool);

/// The background of each row of a picture.
#[derive(Debug)]
pub(crate) struct BackgroundRows {
    /// In the space in which colours are composed, and 0 or 1 for its alpha.
    pub colors: Vec<[f32; 4]>,
    /// As display bytes.
    pub bytes: Vec<[u8; 4]>,
}

impl Cached for BackgroundRows {
    type Key = BackgroundKey;
    const REUSE: Reuse = Reuse::Session;
}

impl BackgroundRows {
    /// The colour of a row, or of the last one, in the space of composition.
    #[inline]
    pub(crate) fn color(&self, row: u32) -> [f32; 4] {
        self.colors[(row as usize).min(self.colors.len() - 1)]
    }
}

impl<'a> FrameConstants<'a> {
    pub(crate) fn new(
        view: &'a PreparedView<'a>,
        settings: &Settings,
        lights: &[Light],
        ambient: Rgb,
        shadows: Option<&'a dyn Shadows>,
        radiosity: Option<&'a Solution>,
        tables: &'a DecodeTables,
        execution: &Execution,
    ) -> Self {
        let session = view.session;
        let raw = settings.color_space == ColorSpace::Raw;
        let instances =
            (0..session.world.instances.len()).map(|i| instance_constants(view, i, settings, execution)).collect();
        let default = Material { name: "default".to_owned(), ..Material::default() };
        let materials = session.scene.materials.iter().chain([&default]);
        let materials: Vec<_> = materials.map(|m| material_constants(m, view, settings, tables)).collect();
        let follows = match settings.global {
            Global::RayTrace => facets_that_follow(view, &materials),
            _ => Vec::new(),
        };
        let key = (settings.background, settings.height, raw);
        let make = || Ok::<_, Infallible>(background_rows(&settings.background, settings.height, raw));
        let Ok(background) = session.cache.get_or_build(key, make);
        let prepared = lights.iter().map(|l| PreparedLight::new(l, &view.view.view_from_world)).enumerate();
        let (light_numbers, lights) = prepared.filter_map(|(i, l)| Some((i, l?))).unzip();
        Self {
            view,
            instances,
            materials,
            lights,
            light_numbers,
            shadows,
            radiosity,
            follows,
            ambient,
            shading: settings.shading,
            interpolation: settings.interpolation,
            raw,
            transparency: settings.transparency,
            kay_exponent: settings.kay_exponent,
            fade: settings.depth_cue.map(|cue| Fade::new(view, &cue, |color| composed(color, raw))),
            lay: registry::order(settings.transparency_order).lay,
            middles: (0..1 << view.pattern.len().min(8)).map(|mask| offset(mask, &view.pattern)).collect(),
            in_passes: settings.transparency_order == TransparencyOrder::MULTI_PASS,
            surfaces_are_background: settings.lines == crate::Lines::WireframeHiddenLine,
            background,
            faces: session.per_mesh(),
            level: execution.level,
        }
    }

    /// Whether rays are followed at all.
    pub(crate) fn follows_rays(&self) -> bool {
        !self.follows.is_empty()
    }

    /// Whether rays that meet the facet are followed on.
    #[inline(always)]
    pub(crate) fn follows(&self, facet: u32) -> bool {
        self.follows.get(facet as usize).copied().unwrap_or(false)
    }

    /// The name of a translucent material that the view shows, if there is one.
    pub(crate) fn translucent(&self) -> Option<&str> {
        let world = &self.view.session.world;
        let shown = self.view.instances.iter().filter(|i| !i.layered.is_empty());
        let mut parts = shown.flat_map(|i| &world.instances[i.instance].mesh.parts);
        let scatters = |m: &&MaterialConstants<'_>| m.scatters.is_some();
        parts.find_map(|part| Some(self.material(part.material)).filter(scatters)).map(|m| m.material.name.as_str())
    }

    /// The material of a part of a mesh.
    pub(crate) fn material(&self, index: Option<u32>) -> &MaterialConstants<'a> {
        let last = self.materials.len() - 1;
        &self.materials[index.map_or(last, |m| (m as usize).min(last))]
    }
}

/// For each facet whether its material lets rays on.
fn facets_that_follow(view: &PreparedView<'_>, materials: &[MaterialConstants<'_>]) -> Vec<bool> {
    let world = &view.session.world;
    let mut follows = vec![false; world.facet_count as usize];
    for instance in &world.instances {
        for part in &instance.mesh.parts {
            let index = part.material.map_or(materials.len() - 1, |m| m as usize);
            let range = part.triangles.start + instance.first_facet..part.triangles.end + instance.first_facet;
            follows[range.start as usize..range.end as usize].fill(materials[index].follows);
        }
    }
    follows
}

fn rows(m: &DMat4) -> [[f32; 4]; 3] {
    [0, 1, 2].map(|r| m.row(r).as_vec4().to_array())
}

fn instance_constants(
    view: &PreparedView<'_>,
    index: usize,
    settings: &Settings,
    execution: &Execution,
) -> InstanceConstants {
    let instance = &view.session.world.instances[index];
    let view_from_model = view.view.view_from_world * instance.world_from_model;
    let clip = view.view.clip_from_view * view_from_model;
    let (w, h) = (f64::from(view.viewport.width) * 0.5, f64::from(view.viewport.height) * 0.5);
    let [x, y, clip_w] = [clip.row(0), clip.row(1), clip.row(3)];
    let screen: [DVec4; 3] = [x * w + clip_w * w, clip_w * h - y * h, clip_w];
    // The cofactor matrix is the inverse transpose times the determinant, and exists for flat transforms too.
    let [a, b, c] = [0, 1, 2].map(|k| view_from_model.col(k).truncate());
    let cofactor = [b.cross(c), c.cross(a), a.cross(b)];
    let mirrored = mirrors(&instance.world_from_model);
    let sign = if mirrored { -1.0 } else { 1.0 };
    let scale = cofactor.iter().map(|v| v.length()).fold(0.0, f64::max);
    let scale = if scale > 0.0 { sign / scale } else { 0.0 };
    let normal_row = |r: usize| [0, 1, 2].map(|k| (cofactor[k][r] * scale) as f32);
    InstanceConstants {
        screen_from_model: screen.map(|r| r.as_vec4().to_array()),
        view_from_model: rows(&view_from_model),
        view_from_model_normal: [0, 1, 2].map(normal_row),
        two_sided: !is_solid(view.session, instance, &view.camera, &view.view, settings, execution),
        mirrored,
    }
}

fn material_constants<'a>(
    material: &Material,
    view: &'a PreparedView<'a>,
    settings: &Settings,
    tables: &'a DecodeTables,
) -> MaterialConstants<'a> {
    let scene = &view.session.scene;
    let texture = |reference: Option<TextureRef>| {
        let reference = reference?;
        let texture = scene.textures.get(reference.texture as usize)?;
        let decode = match texture.encoding {
            vitral_frame::Encoding::Srgb => &tables.srgb,
            vitral_frame::Encoding::Linear => &tables.linear,
        };
        Some(TextureConstants { texture, reference, decode })
    };
    let (cutoff, blend) = match material.alpha_mode {
        AlphaMode::Opaque => (None, false),
        AlphaMode::Mask { cutoff } => (Some(AlphaMode::least_opacity(cutoff)), false),
        AlphaMode::Blend => (None, settings.transparency != Transparency::None),
    };
    MaterialConstants {
        model: model(material, settings.illumination, settings.lighting),
        base: texture(material.base_texture),
        specular: texture(material.specular_texture),
        emission: texture(material.emission_texture),
        opacity: texture(material.opacity_texture),
        metallic_roughness: texture(material.metallic_roughness_texture),
        occlusion: texture(material.occlusion_texture),
        normal: texture(material.normal_texture),
        cutoff,
        soft_cut: cutoff.is_some() && view.pattern.len() > 1 && settings.global != Global::RayTrace,
        blend,
        follows: settings.global == Global::RayTrace && (cutoff.is_some() || blend || material.mirror),
        scatters: (blend && material.transmission == Transmission::Translucent)
            .then(|| scattering_exponent(&material.reflectance)),
        material: material.clone(),
    }
}

/// A colour in the display's encoding, in the space in which colours are composed.
fn composed(color: [f32; 3], raw: bool) -> [f32; 3] {
    if raw { color } else { color.map(Lanes::linear_from_srgb) }
}

fn background_rows(background: &Background, height: u32, raw: bool) -> BackgroundRows {
    let light = |c| composed(c, raw);
    let opaque = |c: [f32; 3]| [c[0], c[1], c[2], 1.0];
    let row = |y: u32| match background {
        Background::Transparent => [0.0; 4],
        Background::Color { color } => opaque(light(*color)),
        Background::Gradient { top, bottom } => {
            let t = (y as f32 + 0.5) / height as f32;
            opaque(light([0, 1, 2].map(|k| top[k] + (bottom[k] - top[k]) * t)))
        }
    };
    let encode = |c: f32| byte_from_unit(if raw { c } else { Lanes::srgb_from_linear(c) });
    let bytes = |c: &[f32; 4]| [encode(c[0]), encode(c[1]), encode(c[2]), byte_from_unit(c[3])];
    let colors: Vec<[f32; 4]> = (0..height).map(row).collect();
    BackgroundRows { bytes: colors.iter().map(bytes).collect(), colors }
}
