//! What stays the same for all points of a frame: matrices of each instance, lights, materials, the
//! background.

use super::face_table::FaceTable;
use super::instance_constants::InstanceConstants;
use super::material_constants::MaterialConstants;
use super::terminator::SoftTerminator;
use crate::display::{BackgroundRows, DecodeTables, Fade};
use crate::marks::PointLighting;
use crate::radiosity::Solution;
use crate::settings::Terminator;
use crate::shadow::{AmbientOcclusion, Ground, PreparedShadows};
use crate::transparency::Lay;
use crate::{
    ColorSpace, DepthCue, Environment, Execution, Global, Interpolation, PerMesh, PreparedView,
    Settings, Shading, Surroundings, Transparency,
};
use std::convert::Infallible;
use std::sync::Arc;
use vitral_light::{EnvironmentLight, Light, Material, PreparedLight, Rgb, Sky};
use vitral_math::lanes::Level;
use vitral_math::{DMat3, DVec3};
use vitral_raster::{SamplePattern, Tile};

/// The light of a frame, and what keeps it away.
#[derive(Clone, Copy)]
pub(crate) struct FrameLight<'a> {
    /// The lights, world space.
    pub lights: &'a [Light],
    /// Global ambient light.
    pub ambient: Rgb,
    pub surroundings: &'a Surroundings,
    /// What says which part of a light arrives; `None` without shadows.
    pub shadows: Option<&'a dyn PreparedShadows>,
    /// What says which part of ambient light arrives; `None`: all of it.
    pub occlusion: Option<&'a AmbientOcclusion<'a>>,
    /// What darkens the background.
    pub ground: Option<&'a Ground<'a>>,
    /// Light from other surfaces; `None` without radiosity.
    pub radiosity: Option<&'a Solution>,
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
    pub shadows: Option<&'a dyn PreparedShadows>,
    /// What softens the border of attached shadows; `None` without shadows, and where it is to be
    /// exact.
    pub(super) terminator: Option<Box<dyn PreparedShadows + 'a>>,
    /// What says which part of ambient light arrives; `None`: all of it.
    pub occlusion: Option<&'a AmbientOcclusion<'a>>,
    /// What darkens the background.
    pub ground: Option<&'a Ground<'a>>,
    /// Light from other surfaces; `None` without radiosity.
    pub radiosity: Option<&'a Solution>,
    /// For each facet whether rays that meet it are followed on; empty without ray tracing.
    follows: Vec<bool>,
    /// Global ambient light.
    pub ambient: Rgb,
    /// What polished surfaces mirror: the soft sky, or nothing.
    pub sky: Option<Sky>,
    /// An image in its place, which lights all metallic-roughness materials.
    pub environment: Option<EnvironmentLight>,
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
    /// For each set of few samples their middle within the pixel, see [`Self::middle`].
    pub middles: Vec<[f32; 2]>,
    /// Layers are wanted pass by pass.
    pub in_passes: bool,
    /// Surfaces are drawn in the background's colour.
    pub surfaces_are_background: bool,
    pub background: Arc<BackgroundRows>,
    /// Instructions to use.
    pub level: Level,
}

impl<'a> FrameConstants<'a> {
    pub(crate) fn new(
        view: &'a PreparedView<'a>,
        settings: &Settings,
        light: &FrameLight<'a>,
        tables: &'a DecodeTables,
        execution: &Execution,
    ) -> Self {
        let FrameLight { lights, ambient, surroundings, shadows, occlusion, ground, radiosity } =
            *light;
        let session = view.session;
        let raw = settings.picture.color_space == ColorSpace::Raw;
        let instances = (0..session.world.instances.len())
            .map(|i| InstanceConstants::new(view, i, settings, execution))
            .collect();
        let default = Material { name: "default".to_owned(), ..Material::default() };
        let materials = session.scene.materials.iter().chain([&default]);
        let materials: Vec<_> =
            materials.map(|m| MaterialConstants::new(m, view, settings, tables)).collect();

        // Find the facets from which rays go on.
        let follows = match settings.global.model {
            Global::RayTrace => facets_that_follow(view, &materials),
            _ => Vec::new(),
        };

        // Prepare the background and the lights.
        let key = (settings.picture.background, settings.picture.height, raw);
        let make = || Ok::<_, Infallible>(BackgroundRows::new(&key));
        let Ok(background) = session.cache.get_or_build(key, make);
        let prepared =
            lights.iter().map(|l| PreparedLight::new(l, &view.view.view_from_world)).enumerate();
        let soft = shadows.is_some() && settings.shadows.terminator == Terminator::Soft;
        let terminator = || {
            Box::new(SoftTerminator::new(view, lights, settings, execution))
                as Box<dyn PreparedShadows + 'a>
        };
        let terminator = soft.then(terminator);
        let (light_numbers, lights) = prepared.filter_map(|(i, l)| Some((i, l?))).unzip();

        // Collect everything.
        Self {
            view,
            instances,
            materials,
            lights,
            light_numbers,
            shadows,
            terminator,
            occlusion,
            ground,
            radiosity,
            follows,
            ambient,
            sky: sky(view, settings),
            environment: environment(view, settings, surroundings),
            shading: settings.shading.model,
            interpolation: settings.shading.interpolation,
            raw,
            transparency: settings.transparency.model,
            kay_exponent: settings.transparency.kay_exponent,
            fade: settings.picture.depth_cue.map(|cue| fade(view, &cue, raw)),
            lay: settings.transparency.order.lay,
            middles: (0..1 << view.pattern.len().min(8))
                .map(|mask| offset(mask, &view.pattern))
                .collect(),
            in_passes: settings.transparency.order.draws_passes,
            surfaces_are_background: settings.picture.lines == crate::Lines::WireframeHiddenLine,
            background,
            faces: session.per_mesh(),
            level: execution.level,
        }
    }

    /// The lights, for points.
    pub(crate) fn point_lighting(&self) -> PointLighting<'_> {
        PointLighting { lights: &self.lights, ambient: self.ambient }
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
        parts
            .find_map(|part| Some(self.material(part.material)).filter(scatters))
            .map(|m| m.material.name.as_str())
    }

    /// Where to illuminate a facet that covers the samples `mask` of the pixel at `place`: at the
    /// pixel's centre if it covers them all, else in their middle, so that nothing is extrapolated.
    #[inline(always)]
    pub(super) fn middle(&self, place: [f32; 2], mask: u32) -> [f32; 2] {
        let [x, y] = self
            .middles
            .get(mask as usize)
            .copied()
            .unwrap_or_else(|| offset(mask, &self.view.pattern));
        [place[0] + x, place[1] + y]
    }

    /// The part of the background that a shadow on the ground takes in each pixel of a tile; empty
    /// without one.
    pub(crate) fn ground_shadow(&self, tile: &Tile) -> Vec<f32> {
        self.ground.map(|ground| ground.tile(tile, self.fade.as_ref())).unwrap_or_default()
    }

    /// The material of a part of a mesh.
    pub(crate) fn material(&self, index: Option<u32>) -> &MaterialConstants<'a> {
        let last = self.materials.len() - 1;
        &self.materials[index.map_or(last, |m| (m as usize).min(last))]
    }
}

/// The sky that polished surfaces mirror. Radiosity, which computes what surfaces light each other
/// with, does without.
fn sky(view: &PreparedView<'_>, settings: &Settings) -> Option<Sky> {
    let wanted = settings.shading.environment == Environment::Sky
        && settings.global.model != Global::Radiosity;
    let up =
        view.view.view_from_world.transform_vector3(view.camera.view_up).normalize_or(DVec3::Y);
    wanted.then(|| Sky { up: up.as_vec3().to_array() })
}

/// The image that polished surfaces mirror. Radiosity does without.
fn environment(
    view: &PreparedView<'_>,
    settings: &Settings,
    surroundings: &Surroundings,
) -> Option<EnvironmentLight> {
    let wanted = settings.shading.environment == Environment::Auto
        && settings.global.model != Global::Radiosity;
    let map = surroundings.image.as_ref().filter(|_| wanted)?;
    let world_from_view = DMat3::from_mat4(view.view.view_from_world).transpose();
    let image_from_view = surroundings.image_from_world() * world_from_view;
    let rows = [0, 1, 2].map(|row| image_from_view.row(row).as_vec3().to_array());
    Some(EnvironmentLight::new(Arc::clone(map), rows, surroundings.factors))
}

/// Depth cueing in a view of the whole scene.
fn fade(view: &PreparedView<'_>, cue: &DepthCue, raw: bool) -> Fade {
    let sphere = view.session.world.bounds.bounding_sphere();
    let middle = -view.view.view_from_world.transform_point3(sphere.center).z;
    Fade::new(cue, middle, sphere.radius, raw)
}

/// For each facet whether its material lets rays on.
fn facets_that_follow(view: &PreparedView<'_>, materials: &[MaterialConstants<'_>]) -> Vec<bool> {
    let world = &view.session.world;
    let mut follows = vec![false; world.facet_count as usize];
    for instance in &world.instances {
        for part in &instance.mesh.parts {
            let index = part.material.map_or(materials.len() - 1, |m| m as usize);
            let range = part.triangles.start + instance.first_facet
                ..part.triangles.end + instance.first_facet;
            follows[range.start as usize..range.end as usize].fill(materials[index].follows);
        }
    }
    follows
}

/// The middle of the samples `mask` within their pixel.
fn offset(mask: u32, pattern: &SamplePattern) -> [f32; 2] {
    let count = mask.count_ones();
    if count as usize == pattern.len() {
        return [0.5; 2];
    }
    let mut sum = [0.0; 2];
    for s in (0..pattern.len()).filter(|s| mask >> s & 1 == 1) {
        let offset = pattern.offset(s);
        sum = [sum[0] + offset[0], sum[1] + offset[1]];
    }
    sum.map(|s| s / count as f32)
}
