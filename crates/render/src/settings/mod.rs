//! What the user may choose, in one plain structure that command line, files and other faces share.
//!
//! Settings stand in groups: what the picture is like, who finds visible surfaces, and how light,
//! shadows, transparency and light from other surfaces are computed. In files they are one flat
//! object (`flat.rs`). Algorithms are chosen by a [`Choice`] of a row of the
//! [`registry`](crate::registry), closed sets by an enum.

mod choices;
mod error;
mod flat;
mod picture;

pub use choices::{
    ColorSpace, Environment, Global, GroundShadow, Interpolation, Lines, Shading, Terminator,
    Transparency, VolumeCounting,
};
pub use error::SettingsError;
pub use picture::{Background, Channels, DepthCue, PictureSettings};

use crate::catalogue::{Acceleration, Shadows, Visibility};
use crate::choice::Choice;
use crate::transparency::registry::Order;
use crate::{Coherence, CoherenceSet};
use serde::{Deserialize, Serialize};
use vitral_light::Illumination;
use vitral_raster::Viewport;

/// The order in which transparent surfaces are combined.
pub type TransparencyOrder = Choice<Order>;

/// How a scene is to be rendered.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    /// Size, samples, colours, channels.
    pub picture: PictureSettings,
    /// What finds the visible surface at each sample.
    pub visibility: Visibility,
    /// What finds the triangles near a ray; only where there are rays: of algorithms that cast
    /// them, of shadows by rays, of ray tracing. `None`: the default structure for them.
    pub acceleration: Option<Acceleration>,
    /// Kinds of coherence that the visibility algorithm uses; `None`: all that it exploits. They do
    /// not change the picture.
    pub coherence: Option<Vec<Coherence>>,
    /// Bits of an integer depth, `8..=32`, of the z-buffer alone: it shows what few of them do.
    /// `None`: depths are of floating point.
    pub depth_bits: Option<u32>,
    /// What is thrown away early.
    pub cull: Culling,
    /// Materials that show their front alone are seen from behind, too: for views from lights, to
    /// which every face is solid.
    pub shows_all_backs: bool,
    /// How light is reflected, and where that is computed.
    pub shading: ShadingSettings,
    /// What keeps light away.
    pub shadows: ShadowSettings,
    /// What shows through.
    pub transparency: TransparencySettings,
    /// Light from other surfaces.
    pub global: GlobalSettings,
}

/// Early rejection. Neither changes the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct Culling {
    /// Objects, and runs of triangles of large objects, outside the view volume.
    pub frustum: bool,
    /// Faces of closed meshes that are turned away.
    pub back_face: bool,
}

impl Default for Culling {
    fn default() -> Self {
        Self { frustum: true, back_face: true }
    }
}

/// How light is reflected, and where that is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadingSettings {
    /// How light is reflected at a point.
    pub illumination: Illumination,
    /// Where illumination is computed.
    pub model: Shading,
    /// How values between vertices are found.
    pub interpolation: Interpolation,
    /// What polished surfaces mirror of their surroundings.
    pub environment: Environment,
    /// Rays by which a point finds out how much of the ambient light, and of the light of the
    /// surroundings, nearby surfaces keep away, `1..=4096`; `None`: all of it arrives.
    pub ambient_occlusion: Option<u32>,
    /// How far away such things may be, in the world's unit, above 0; `None`: half the radius of
    /// the scene's bounding sphere.
    pub occlusion_radius: Option<f64>,
    /// Light sources on; off shows each surface's own colour.
    pub lighting: bool,
}

impl Default for ShadingSettings {
    /// The model of each material, at each pixel, lights on.
    fn default() -> Self {
        Self {
            illumination: Illumination::default(),
            model: Shading::default(),
            interpolation: Interpolation::default(),
            environment: Environment::default(),
            ambient_occlusion: None,
            occlusion_radius: None,
            lighting: true,
        }
    }
}

impl ShadingSettings {
    fn check(&self) -> Result<(), SettingsError> {
        if let Some(rays) = self.ambient_occlusion.filter(|rays| !(1..=4096).contains(rays)) {
            return Err(SettingsError::AmbientOcclusion(rays));
        }
        let Some(radius) = self.occlusion_radius else { return Ok(()) };
        if !(radius > 0.0 && radius.is_finite()) {
            return Err(SettingsError::OcclusionRadius(radius));
        }
        if self.ambient_occlusion.is_none() {
            return Err(SettingsError::NoOcclusion);
        }
        Ok(())
    }
}

/// What keeps light away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowSettings {
    /// What finds shadows.
    pub algorithm: Shadows,
    /// Samples of each area light that are tested for its shadows, `1..=4096`.
    pub light_samples: u32,
    /// Texels along the longer side of a shadow map, `16..=8192`.
    pub map_size: u32,
    /// Shadow maps that share the part near the viewer of a large scene, for each light, `1..=8`;
    /// 1: one for the whole scene.
    pub cascades: u32,
    /// Where shadow volumes are counted from; only for them. `None`: [`VolumeCounting::ZFail`].
    pub volume_counting: Option<VolumeCounting>,
    /// Where light ends on surfaces that facets only stand for.
    pub terminator: Terminator,
    /// What darkens the background where there would be a ground below the model.
    pub ground: GroundShadow,
}

impl Default for ShadowSettings {
    /// No shadows.
    fn default() -> Self {
        Self {
            algorithm: Shadows::default(),
            light_samples: 16,
            map_size: 2048,
            cascades: 1,
            volume_counting: None,
            terminator: Terminator::default(),
            ground: GroundShadow::default(),
        }
    }
}

impl ShadowSettings {
    fn check(&self) -> Result<(), SettingsError> {
        if !(1..=4096).contains(&self.light_samples) {
            return Err(SettingsError::LightSamples(self.light_samples));
        }
        if !(16..=8192).contains(&self.map_size) {
            return Err(SettingsError::ShadowMapSize(self.map_size));
        }
        if !(1..=8).contains(&self.cascades) {
            return Err(SettingsError::ShadowCascades(self.cascades));
        }
        if self.volume_counting.is_some() && !self.algorithm.counts_volumes {
            return Err(SettingsError::VolumeCounting(self.algorithm));
        }
        Ok(())
    }
}

/// What shows through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransparencySettings {
    /// How much light a transparent surface lets through.
    pub model: Transparency,
    /// In which order transparent surfaces are combined.
    pub order: TransparencyOrder,
    /// The exponent `m` of [`Transparency::Kay`], above 0: the larger, the thinner the glass; 2 or
    /// 3 are usual.
    pub kay_exponent: f32,
    /// Rays a pixel that each translucent surface scatters, and into which ray tracing splits what a
    /// metal mirrors that is not quite smooth, about, `1..=4096`.
    pub scatter_samples: u32,
    /// Memory in bytes for the transparent layers of a picture. When it is full, the layers behind
    /// others are dropped, and the picture comes with a warning. Two for each sample are always
    /// allowed.
    pub layer_memory: u64,
}

impl Default for TransparencySettings {
    /// By opacity, exactly, in at most 1 GiB.
    fn default() -> Self {
        Self {
            model: Transparency::default(),
            order: TransparencyOrder::default(),
            kay_exponent: 3.0,
            scatter_samples: 32,
            layer_memory: 1 << 30,
        }
    }
}

/// Light from other surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlobalSettings {
    /// Which light from other surfaces is followed.
    pub model: Global,
    /// How often a ray may be mirrored or bent, `1..=64`.
    pub max_depth: u32,
    /// Longest edge of a patch, in the world's unit, above 0; `None`: a sixteenth of the scene's
    /// diagonal.
    pub patch_size: Option<f64>,
    /// Patches that may send light, at least 1; `None`: until no more than
    /// [`RESIDUAL`](crate::radiosity::RESIDUAL) of it is left.
    pub iterations: Option<u64>,
}

impl Default for GlobalSettings {
    /// None.
    fn default() -> Self {
        Self { model: Global::default(), max_depth: 8, patch_size: None, iterations: None }
    }
}

impl GlobalSettings {
    fn check(&self) -> Result<(), SettingsError> {
        if !(1..=64).contains(&self.max_depth) {
            return Err(SettingsError::MaxDepth(self.max_depth));
        }
        if let Some(size) = self.patch_size.filter(|size| !(*size > 0.0 && size.is_finite())) {
            return Err(SettingsError::PatchSize(size));
        }
        if self.iterations == Some(0) {
            return Err(SettingsError::Iterations);
        }
        Ok(())
    }
}

/// Settings by chained calls: `Settings::default().with_size(640, 480).with_shadows(Shadows::RAY)`.
impl Settings {
    /// A picture of `width` by `height` pixels.
    #[must_use]
    pub fn with_size(mut self, width: u32, height: u32) -> Self {
        (self.picture.width, self.picture.height) = (width, height);
        self
    }

    /// `samples` samples a pixel; 1 means no anti-aliasing.
    #[must_use]
    pub fn with_samples(mut self, samples: u32) -> Self {
        self.picture.samples = samples;
        self
    }

    /// What is behind everything.
    #[must_use]
    pub fn with_background(mut self, background: Background) -> Self {
        self.picture.background = background;
        self
    }

    /// Which planes of the frame are wanted.
    #[must_use]
    pub fn with_channels(mut self, channels: Channels) -> Self {
        self.picture.channels = channels;
        self
    }

    /// Edges instead of, or on top of, surfaces.
    #[must_use]
    pub fn with_lines(mut self, lines: Lines) -> Self {
        self.picture.lines = lines;
        self
    }

    /// What the numbers in the picture mean.
    #[must_use]
    pub fn with_color_space(mut self, color_space: ColorSpace) -> Self {
        self.picture.color_space = color_space;
        self
    }

    /// What finds the visible surface at each sample.
    #[must_use]
    pub fn with_visibility(mut self, visibility: Visibility) -> Self {
        self.visibility = visibility;
        self
    }

    /// What finds the triangles near a ray.
    #[must_use]
    pub fn with_acceleration(mut self, acceleration: Acceleration) -> Self {
        self.acceleration = Some(acceleration);
        self
    }

    /// How light is reflected at a point.
    #[must_use]
    pub fn with_illumination(mut self, illumination: Illumination) -> Self {
        self.shading.illumination = illumination;
        self
    }

    /// Where illumination is computed.
    #[must_use]
    pub fn with_shading(mut self, shading: Shading) -> Self {
        self.shading.model = shading;
        self
    }

    /// What finds shadows.
    #[must_use]
    pub fn with_shadows(mut self, shadows: Shadows) -> Self {
        self.shadows.algorithm = shadows;
        self
    }

    /// How much light a transparent surface lets through, and in which order such surfaces are
    /// combined.
    #[must_use]
    pub fn with_transparency(mut self, model: Transparency, order: TransparencyOrder) -> Self {
        (self.transparency.model, self.transparency.order) = (model, order);
        self
    }

    /// Light from other surfaces. Ray tracing and radiosity usually go with [`Shadows::RAY`].
    #[must_use]
    pub fn with_global(mut self, global: Global) -> Self {
        self.global.model = global;
        self
    }
}

impl Settings {
    /// Checks what a type cannot: ranges of numbers, and choices that exclude each other.
    ///
    /// # Errors
    /// What cannot be carried out: the first that is found.
    pub fn check(&self) -> Result<Viewport, SettingsError> {
        let viewport = self.picture.check()?;
        if !(self.transparency.kay_exponent > 0.0 && self.transparency.kay_exponent.is_finite()) {
            return Err(SettingsError::KayExponent(self.transparency.kay_exponent));
        }
        self.check_visibility()?;
        self.shading.check()?;
        self.shadows.check()?;
        if self.picture.channels.cast_shadow && self.shadows.algorithm.is_none {
            return Err(SettingsError::CastShadow(Shadows::names(|row| !row.is_none)));
        }
        self.check_order()?;
        self.global.check()?;
        let wires = matches!(self.picture.lines, Lines::Wireframe | Lines::WireframeHiddenLine);
        if self.global.model != Global::None && wires {
            return Err(SettingsError::GlobalLines);
        }
        Ok(viewport)
    }

    /// Whether anything casts rays that a structure serves.
    pub fn casts_rays(&self) -> bool {
        let for_ambient =
            self.shading.ambient_occlusion.is_some() || self.shadows.ground != GroundShadow::None;
        self.visibility.casts_rays
            || self.shadows.algorithm.casts_rays
            || for_ambient
            || self.global.model == Global::RayTrace
    }

    /// The kinds of coherence that are used.
    pub fn coherence(&self) -> CoherenceSet {
        CoherenceSet::of(self.coherence.as_deref().unwrap_or(self.visibility.coherence))
    }

    fn check_visibility(&self) -> Result<(), SettingsError> {
        let visibility = self.visibility;
        if let Some(bits) = self.depth_bits.filter(|bits| !(8..=32).contains(bits)) {
            return Err(SettingsError::DepthBits(bits));
        }
        if self.depth_bits.is_some() && visibility != Visibility::Z_BUFFER {
            return Err(SettingsError::IntegerDepth(visibility));
        }
        if self.depth_bits.is_some() && self.transparency.order.draws_passes {
            return Err(SettingsError::PassesOfIntegers(self.transparency.order.name));
        }
        if self.acceleration.is_some() && !self.casts_rays() {
            let choices = Visibility::names(|row| row.casts_rays);
            return Err(SettingsError::Acceleration { visibility, choices });
        }
        let asked = self.coherence.iter().flatten();
        if let Some(kind) = asked.copied().find(|kind| !visibility.coherence.contains(kind)) {
            let choices: Vec<_> = visibility.coherence.iter().map(|kind| kind.name()).collect();
            return Err(SettingsError::Coherence {
                visibility,
                kind: kind.name(),
                choices: choices.join(", "),
            });
        }
        Ok(())
    }

    fn check_order(&self) -> Result<(), SettingsError> {
        let (transparency, channels, visibility) =
            (&self.transparency, &self.picture.channels, self.visibility);
        let (order, traces) = (transparency.order, self.global.model == Global::RayTrace);
        if !(1..=4096).contains(&transparency.scatter_samples) {
            return Err(SettingsError::ScatterSamples(transparency.scatter_samples));
        }
        if traces && order != TransparencyOrder::default() {
            return Err(SettingsError::OrderOfRays(order.name));
        }
        if channels.passes && (!order.draws_passes || traces || visibility.finds_layers_at_once) {
            return Err(SettingsError::Passes(order.name));
        }
        if channels.buffers && !order.has_buffers {
            return Err(SettingsError::Buffers(order.name));
        }
        if order.needs_list && !visibility.makes_list() {
            return Err(SettingsError::ListOrder {
                visibility,
                choices: Visibility::names(|row| row.makes_list()),
            });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_chained() {
        let settings = Settings::default()
            .with_size(64, 48)
            .with_samples(1)
            .with_visibility(Visibility::PAINTER)
            .with_shadows(Shadows::RAY)
            .with_shading(Shading::Flat);
        assert_eq!(settings.check().map(|v| (v.width, v.height)), Ok((64, 48)));
        assert!(settings.casts_rays(), "shadows by rays cast them");
        let error = settings.with_samples(17).check().unwrap_err();
        assert_eq!(error.to_string(), "17 samples per pixel: 1 to 16, or 32, are possible");
    }

    #[test]
    fn choices_that_exclude_each_other_are_told() {
        let order = TransparencyOrder::BACK_TO_FRONT;
        let listed = Settings::default().with_transparency(Transparency::Linear, order);
        let error = listed.check().unwrap_err().to_string();
        assert!(error.contains("`z-buffer` does not: choose painter, bsp"), "{error}");
        assert!(listed.with_visibility(Visibility::BSP).check().is_ok());
        let structure = Settings::default()
            .with_acceleration(Acceleration::GRID)
            .check()
            .unwrap_err()
            .to_string();
        assert!(
            structure.contains("choose the visibility ray-cast, the shadows ray"),
            "{structure}"
        );
    }
}
