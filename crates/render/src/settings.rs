//! What the user may choose, in one plain structure that command line, files and other faces share.

use crate::{Coherence, CoherenceSet, registry, transparency};
use serde::{Deserialize, Serialize};
use vitral_light::Illumination;
use vitral_raster::{MAX_SIDE, Viewport};

/// How a scene is to be rendered.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct Settings {
    /// Width of the picture in pixels, `1..=16384`.
    pub width: u32,
    /// Height of the picture in pixels, `1..=16384`.
    pub height: u32,
    /// Samples a pixel, `1..=16`; 1 means no anti-aliasing.
    pub samples: u32,
    /// Name of a visible-surface algorithm in the [`registry`].
    pub visibility: String,
    /// What finds the triangles near a ray; only where there are rays: of algorithms that cast them, of shadows by rays, of
    /// ray tracing. `None`: [`Acceleration::Bvh`] for them.
    pub acceleration: Option<Acceleration>,
    /// Kinds of coherence that the algorithm uses; `None`: all that it exploits. They do not change the picture.
    pub coherence: Option<Vec<Coherence>>,
    /// What is thrown away early.
    pub cull: Culling,
    /// How light is reflected.
    pub illumination: Illumination,
    /// Where illumination is computed.
    pub shading: Shading,
    /// Name of a shadow algorithm in the [`registry`].
    pub shadows: String,
    /// Places on each area light that are asked for its shadows, `1..=4096`.
    pub light_samples: u32,
    /// Texels along the longer side of a shadow map, `16..=8192`.
    pub shadow_map_size: u32,
    /// Shadow maps that share what is near the viewer of a large scene, for each light, `1..=8`; 1: one for the whole scene.
    pub shadow_cascades: u32,
    /// Where shadow volumes are counted from; only for them. `None`: [`VolumeCounting::ZFail`].
    pub volume_counting: Option<VolumeCounting>,
    /// Light from other surfaces.
    pub global: Global,
    /// How often a ray may be mirrored or bent, `1..=64`.
    pub max_depth: u32,
    /// Longest edge of a patch, in the world's unit, above 0; `None`: a sixteenth of the scene's diagonal.
    pub patch_size: Option<f64>,
    /// Patches that may send light, at least 1; `None`: until no more than
    /// [`RESIDUAL`](crate::radiosity::RESIDUAL) of it is left.
    pub iterations: Option<u64>,
    /// Light sources on; off shows each surface's own colour.
    pub lighting: bool,
    /// How values between vertices are found.
    pub interpolation: Interpolation,
    /// What the numbers in the picture mean.
    pub color_space: ColorSpace,
    /// How transparent surfaces are combined.
    pub transparency: Transparency,
    /// The exponent `m` of [`Transparency::Kay`], above 0: the larger, the thinner the glass; 2 or 3 are usual.
    pub kay_exponent: f32,
    /// In which order they are.
    pub transparency_order: TransparencyOrder,
    /// Rays a pixel that each translucent surface scatters, about, `1..=4096`.
    pub scatter_samples: u32,
    /// Memory in bytes for the transparent layers of a picture. When it is full, the layers behind others are dropped,
    /// and the picture comes with a warning. Two for each sample are always allowed.
    pub layer_memory: u64,
    /// Distance shows: what is farther away fades into the background.
    pub depth_cue: Option<DepthCue>,
    /// Edges instead of, or on top of, surfaces.
    pub lines: Lines,
    /// Behind everything.
    pub background: Background,
    /// Which planes of the frame are wanted.
    pub channels: Channels,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            width: 1024,
            height: 768,
            samples: 4,
            visibility: "z-buffer".to_owned(),
            acceleration: None,
            coherence: None,
            cull: Culling::default(),
            illumination: Illumination::default(),
            shading: Shading::default(),
            shadows: "none".to_owned(),
            light_samples: 16,
            shadow_map_size: 2048,
            shadow_cascades: 1,
            volume_counting: None,
            global: Global::default(),
            max_depth: 8,
            patch_size: None,
            iterations: None,
            lighting: true,
            interpolation: Interpolation::default(),
            color_space: ColorSpace::default(),
            transparency: Transparency::default(),
            kay_exponent: 3.0,
            transparency_order: TransparencyOrder::default(),
            scatter_samples: 32,
            layer_memory: 1 << 30,
            depth_cue: None,
            lines: Lines::default(),
            background: Background::default(),
            channels: Channels::default(),
        }
    }
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

/// What finds the triangles near a ray. It does not change the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Acceleration {
    /// A tree of boxes round triangles, by the surface area heuristic.
    #[default]
    Bvh,
    /// A cube cut in eight, again and again.
    Octree,
    /// A box cut in two across an axis, again and again.
    Bsp,
    /// Equal cells, which a ray passes one by one.
    Grid,
    /// A box along the axes round each object, before its triangles.
    Box,
    /// A box that is turned to fit, round each object.
    OrientedBox,
    /// A sphere round each object.
    Sphere,
    /// Every triangle is asked.
    None,
}

/// Where the count of shadow volumes begins. It does not change the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum VolumeCounting {
    /// At infinity, behind what is seen.
    #[default]
    ZFail,
    /// At the viewer.
    ZPass,
}

/// Where illumination is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shading {
    /// Once a face, at its centre with its own normal.
    Flat,
    /// At each vertex; intensities are interpolated.
    Gouraud,
    /// At each pixel, with the interpolated normal.
    #[default]
    Phong,
}

impl Shading {
    /// All, with a line each.
    pub const ALL: [(Self, &'static str, &'static str); 3] = [
        (Self::Phong, "phong", "normals are interpolated, each pixel is illuminated"),
        (Self::Gouraud, "gouraud", "vertices are illuminated, intensities are interpolated"),
        (Self::Flat, "flat", "one colour for each face"),
    ];
}

/// Light that comes from other surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Global {
    /// None: surfaces are lit by lights alone.
    #[default]
    None,
    /// Mirror images and refraction; shadows are those of [`Settings::shadows`].
    RayTrace,
    /// What matt surfaces send to each other.
    Radiosity,
}

/// How values between vertices are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Interpolation {
    /// As on the surface in space.
    #[default]
    Perspective,
    /// Linearly on the screen: the classical defect, for comparison.
    Linear,
}

/// What the numbers in a picture mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ColorSpace {
    /// Light is computed linearly and encoded as sRGB.
    #[default]
    Srgb,
    /// Intensities go straight to bytes, as in the course's arithmetic. Textures, coefficients and colours of vertices are
    /// taken as the file has them: sRGB in OBJ, PLY and OFF files, linear factors and `COLOR_0` in glTF.
    Raw,
}

/// How transparent surfaces are combined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Transparency {
    /// `opacity` of the surface, the rest of what is behind.
    #[default]
    Linear,
    /// Less where the surface turns away from the viewer: with the material's `kt` and `kt-min` it is
    /// `kt_min + (kt - kt_min) (1 - (1 - |nz|)^m)`.
    Kay,
    /// Tinted by the material's filter; highlights stay whole.
    Filtered,
    /// Everything is opaque (cut-outs stay).
    None,
}

/// The order in which transparent surfaces are combined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TransparencyOrder {
    /// Lists of fragments with coverage masks in each pixel.
    #[default]
    ABuffer,
    /// Sorted by depth at each sample.
    Sorted,
    /// The farthest layer that is left, pass after pass.
    MultiPass,
    /// In the order of the list of a list-priority algorithm.
    BackToFront,
    /// Opaque and transparent surfaces in a buffer each: exact for one layer.
    TwoBuffer,
    /// As they come: the error of the plain z-buffer.
    Submission,
}

/// Depth cueing: `I' = s I + (1 - s) Idc`, where `s` depends linearly on the distance between two planes across the direction of sight.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct DepthCue {
    /// `Idc` in the display's encoding, `0..=1`; `None`: the background of the pixel's row.
    pub color: Option<[f32; 3]>,
    /// Distance of the front plane from the viewer along the direction of sight, at least 0, world units; `None`: where the scene begins.
    pub front: Option<f64>,
    /// Distance of the back plane, farther away; `None`: where the scene ends.
    pub back: Option<f64>,
    /// `s` at the front plane and before it, `0..=1`.
    pub front_scale: f32,
    /// `s` at the back plane and behind it, `0..=1`.
    pub back_scale: f32,
}

impl Default for DepthCue {
    /// From a sphere's near side round the scene to its far side, where a fifth is left.
    fn default() -> Self {
        Self { color: None, front: None, back: None, front_scale: 1.0, back_scale: 0.2 }
    }
}

impl DepthCue {
    fn check(&self, background: &Background) -> Result<(), SettingsError> {
        let bad = |what: &'static str| Err(SettingsError::DepthCue(what));
        let unit = |value: f32| (0.0..=1.0).contains(&value);
        if !(unit(self.front_scale) && unit(self.back_scale)) {
            return bad("scales from 0 to 1 are required");
        }
        if ![self.front, self.back].into_iter().flatten().all(|d| d >= 0.0 && d.is_finite()) {
            return bad("distances of at least 0 are required");
        }
        if let (Some(front), Some(back)) = (self.front, self.back)
            && back <= front
        {
            return bad("the back plane must be farther away than the front plane");
        }
        match (self.color, background) {
            (None, Background::Transparent) => bad("without a background there must be a colour to fade into"),
            (Some(color), _) if !color.into_iter().all(unit) => bad("a colour from 0 to 1 is required"),
            _ => Ok(()),
        }
    }
}

/// Edges instead of, or on top of, surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Lines {
    /// Only the lines and points that the model itself has.
    #[default]
    None,
    /// Surfaces with their faces' edges.
    Edges,
    /// Edges alone, the hidden ones too.
    Wireframe,
    /// Edges alone, the visible ones.
    WireframeHiddenLine,
}

/// Behind everything.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "kebab-case", rename_all_fields = "kebab-case", deny_unknown_fields)]
pub enum Background {
    /// Alpha 0.
    Transparent,
    /// One colour, in the display's encoding, `0..=1`.
    Color {
        /// RGB.
        color: [f32; 3],
    },
    /// From the top row to the bottom row, in the display's encoding, `0..=1`.
    Gradient {
        /// RGB of the top row.
        top: [f32; 3],
        /// RGB of the bottom row.
        bottom: [f32; 3],
    },
}

impl Default for Background {
    fn default() -> Self {
        Self::Gradient { top: [0.965, 0.972, 0.98], bottom: [0.76, 0.79, 0.83] }
    }
}

/// Which planes of the frame are wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct Channels {
    /// The picture.
    pub color: bool,
    /// Depth.
    pub depth: bool,
    /// Surface ids: of what lies straight on, also with ray tracing.
    pub surface: bool,
    /// Instances.
    pub object: bool,
    /// Materials.
    pub material: bool,
    /// Normals.
    pub normal: bool,
    /// The steps of the visibility algorithm over the picture.
    pub steps: bool,
    /// The picture after each pass; only where the order of transparency draws in passes.
    pub passes: bool,
    /// The buffers of the two-buffer z-buffer; only with that order of transparency.
    pub buffers: bool,
    /// Attached shadows.
    pub attached_shadow: bool,
    /// Cast shadows.
    pub cast_shadow: bool,
}

impl Default for Channels {
    fn default() -> Self {
        Self {
            color: true,
            depth: false,
            surface: false,
            object: false,
            material: false,
            normal: false,
            passes: false,
            buffers: false,
            attached_shadow: false,
            cast_shadow: false,
            steps: false,
        }
    }
}

impl Channels {
    /// Whether any plane besides colour is wanted.
    pub fn any_data(&self) -> bool {
        self.depth || self.surface || self.object || self.material || self.normal || self.any_shadow()
    }

    /// Whether a plane of shadows is wanted.
    pub fn any_shadow(&self) -> bool {
        self.attached_shadow || self.cast_shadow
    }
}

/// Settings that cannot be carried out.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SettingsError {
    /// The picture's size.
    #[error("resolution {width}x{height}: each side must be 1 to {MAX_SIDE}")]
    Resolution {
        /// Asked for.
        width: u32,
        /// Asked for.
        height: u32,
    },
    /// Number of samples.
    #[error("{0} samples a pixel: 1 to 16 are possible")]
    Samples(u32),
    /// The exponent of Kay's model.
    #[error("an exponent of {0} in Kay's model of transparency: a number above 0 is required")]
    KayExponent(f32),
    /// The numbers of depth cueing.
    #[error("depth cueing: {0}")]
    DepthCue(&'static str),
    /// The name of an algorithm.
    #[error("there is no visibility algorithm `{name}`: choose {choices}")]
    Visibility {
        /// Asked for.
        name: String,
        /// What there is.
        choices: String,
    },
    /// A kind of coherence that the algorithm does not exploit.
    #[error("`{visibility}` does not exploit {kind} coherence: choose of {choices}; or none")]
    Coherence {
        /// The visibility algorithm.
        visibility: String,
        /// Asked for.
        kind: &'static str,
        /// What it exploits.
        choices: String,
    },
    /// The name of a shadow algorithm.
    #[error("there is no shadow algorithm `{name}`: choose {choices}")]
    Shadows {
        /// Asked for.
        name: String,
        /// What there is.
        choices: String,
    },
    /// Turns of a ray.
    #[error("{0} turns of a ray: 1 to 64 are possible")]
    MaxDepth(u32),
    /// Length of a patch's edge.
    #[error("patches of {0}: a length above 0 is required")]
    PatchSize(f64),
    /// Number of shots.
    #[error("0 iterations: at least 1 is required")]
    Iterations,
    /// Light from other surfaces, but no surfaces.
    #[error("without surfaces there is no global illumination")]
    GlobalLines,
    /// Number of places on area lights.
    #[error("{0} samples of a light: 1 to 4096 are possible")]
    LightSamples(u32),
    /// Size of shadow maps.
    #[error("shadow maps of {0} texels a side: 16 to 8192 are possible")]
    ShadowMapSize(u32),
    /// Number of cascades.
    #[error("{0} cascades of shadow maps: 1 to 8 are possible")]
    ShadowCascades(u32),
    /// A way to count shadow volumes, but none.
    #[error("a way to count shadow volumes was chosen, but the shadows are `{0}`: choose volume")]
    VolumeCounting(String),
    /// The polygons of a shadow algorithm are wanted, but it works with none.
    #[error("the shadows `{shadows}` work with no polygons: choose {choices}")]
    ShadowPolygons {
        /// Asked for.
        shadows: String,
        /// Those that do.
        choices: String,
    },
    /// The panels of a shadow algorithm are wanted, but it has none.
    #[error("the shadows `{shadows}` have no panels: choose {choices}")]
    Panels {
        /// Asked for.
        shadows: String,
        /// Those that have.
        choices: String,
    },
    /// Cast shadows are wanted, but none are computed.
    #[error("the channel cast-shadow needs a shadow algorithm: choose {0}")]
    CastShadow(String),
    /// An order that takes a list, but no list.
    #[error(
        "the order of transparency `back-to-front` takes the list of a list-priority algorithm, and `{visibility}` makes none: choose {choices}"
    )]
    ListOrder {
        /// The visibility algorithm.
        visibility: String,
        /// Those that make a list.
        choices: String,
    },
    /// An order of transparency, but rays find what is behind.
    #[error(
        "the order of transparency `{0}` was chosen, but rays find what is behind transparent surfaces, one by one"
    )]
    OrderOfRays(&'static str),
    /// A translucent material, and an order of transparency that has no picture of what is behind.
    #[error(
        "material `{material}` is translucent, which the order of transparency `{order}` cannot show: choose {choices}"
    )]
    Translucent {
        /// The material's name.
        material: String,
        /// The order.
        order: &'static str,
        /// Those that can.
        choices: String,
    },
    /// Pictures of passes are wanted, but there are none.
    #[error(
        "there are no passes with the order of transparency `{0}` and these algorithms: choose multi-pass, and neither rays nor brute-force"
    )]
    Passes(&'static str),
    /// The buffers of the two-buffer z-buffer are wanted, but there are none.
    #[error("there are no two buffers with the order of transparency `{0}`: choose two-buffer")]
    Buffers(&'static str),
    /// Number of scattered rays.
    #[error("{0} scattered rays: 1 to 4096 are possible")]
    ScatterSamples(u32),
    /// A structure for rays, but no rays.
    #[error(
        "an acceleration structure was chosen, but `{visibility}` casts no rays, nor does anything else: choose the visibility \
         {choices}, the shadows ray, or the global illumination ray-trace"
    )]
    Acceleration {
        /// The visibility algorithm.
        visibility: String,
        /// Those that cast rays.
        choices: String,
    },
}

impl Settings {
    /// Checks what a type cannot.
    ///
    /// # Errors
    /// What cannot be carried out: the first that is found.
    pub fn check(&self) -> Result<Viewport, SettingsError> {
        if !(1..=16).contains(&self.samples) {
            return Err(SettingsError::Samples(self.samples));
        }
        if !(self.kay_exponent > 0.0 && self.kay_exponent.is_finite()) {
            return Err(SettingsError::KayExponent(self.kay_exponent));
        }
        self.depth_cue.map_or(Ok(()), |cue| cue.check(&self.background))?;
        let visibility = self.visibility.clone();
        let Some(algorithm) = registry::visibility(&visibility) else {
            let choices: Vec<_> = registry::VISIBILITY.iter().map(|a| a.name).collect();
            return Err(SettingsError::Visibility { name: visibility, choices: choices.join(", ") });
        };
        let rays = algorithm.casts_rays || self.shadows == "ray" || self.global == Global::RayTrace;
        if self.acceleration.is_some() && !rays {
            let casting = registry::VISIBILITY.iter().filter(|a| a.casts_rays);
            let choices: Vec<_> = casting.map(|a| a.name).collect();
            return Err(SettingsError::Acceleration { visibility, choices: choices.join(", ") });
        }
        let asked = self.coherence.iter().flatten();
        if let Some(kind) = asked.copied().find(|kind| !algorithm.coherence.contains(kind)) {
            let choices: Vec<_> = algorithm.coherence.iter().map(|kind| kind.name()).collect();
            return Err(SettingsError::Coherence { visibility, kind: kind.name(), choices: choices.join(", ") });
        }
        self.check_shadows()?;
        self.check_order()?;
        if !(1..=64).contains(&self.max_depth) {
            return Err(SettingsError::MaxDepth(self.max_depth));
        }
        if let Some(size) = self.patch_size.filter(|size| !(*size > 0.0 && size.is_finite())) {
            return Err(SettingsError::PatchSize(size));
        }
        if self.iterations == Some(0) {
            return Err(SettingsError::Iterations);
        }
        if self.global != Global::None && matches!(self.lines, Lines::Wireframe | Lines::WireframeHiddenLine) {
            return Err(SettingsError::GlobalLines);
        }
        let (width, height) = (self.width, self.height);
        Viewport::new(width, height).ok_or(SettingsError::Resolution { width, height })
    }

    fn check_order(&self) -> Result<(), SettingsError> {
        if !(1..=4096).contains(&self.scatter_samples) {
            return Err(SettingsError::ScatterSamples(self.scatter_samples));
        }
        let order = transparency::registry::order(self.transparency_order);
        if self.global == Global::RayTrace && self.transparency_order != TransparencyOrder::default() {
            return Err(SettingsError::OrderOfRays(order.name));
        }
        let rays = self.global == Global::RayTrace
            || registry::visibility(&self.visibility).is_some_and(|a| a.casts_rays || a.name == "brute-force");
        if self.channels.passes && (self.transparency_order != TransparencyOrder::MultiPass || rays) {
            return Err(SettingsError::Passes(order.name));
        }
        if self.channels.buffers && self.transparency_order != TransparencyOrder::TwoBuffer {
            return Err(SettingsError::Buffers(order.name));
        }
        if order.needs_list && registry::visibility(&self.visibility).is_some_and(|a| !a.makes_list()) {
            let listing = registry::VISIBILITY.iter().filter(|a| a.makes_list());
            let choices: Vec<_> = listing.map(|a| a.name).collect();
            let visibility = self.visibility.clone();
            return Err(SettingsError::ListOrder { visibility, choices: choices.join(", ") });
        }
        Ok(())
    }

    /// The kinds of coherence that are used.
    pub fn coherence(&self) -> CoherenceSet {
        let all = || registry::visibility(&self.visibility).map_or(&[][..], |a| a.coherence);
        CoherenceSet::of(self.coherence.as_deref().unwrap_or_else(all))
    }

    /// Whether layers come in the order of a list of polygons, where the algorithm makes one.
    pub fn lists_layers(&self) -> bool {
        transparency::registry::order(self.transparency_order).needs_list
    }

    fn check_shadows(&self) -> Result<(), SettingsError> {
        if !(1..=4096).contains(&self.light_samples) {
            return Err(SettingsError::LightSamples(self.light_samples));
        }
        if !(16..=8192).contains(&self.shadow_map_size) {
            return Err(SettingsError::ShadowMapSize(self.shadow_map_size));
        }
        if !(1..=8).contains(&self.shadow_cascades) {
            return Err(SettingsError::ShadowCascades(self.shadow_cascades));
        }
        let choices = |all: bool| {
            let names = registry::SHADOWS.iter().filter(|s| all || s.algorithm.is_some()).map(|s| s.name);
            names.collect::<Vec<_>>().join(", ")
        };
        let Some(shadows) = registry::shadows(&self.shadows) else {
            return Err(SettingsError::Shadows { name: self.shadows.clone(), choices: choices(true) });
        };
        if self.volume_counting.is_some() && shadows.name != "volume" {
            return Err(SettingsError::VolumeCounting(self.shadows.clone()));
        }
        if self.channels.cast_shadow && shadows.algorithm.is_none() {
            return Err(SettingsError::CastShadow(choices(false)));
        }
        Ok(())
    }
}
