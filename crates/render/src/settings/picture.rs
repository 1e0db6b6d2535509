//! What the picture is like, whatever is in it.

use super::{ColorSpace, Lines, SettingsError};
use serde::{Deserialize, Serialize};
use vitral_frame::LineClasses;
use vitral_raster::Viewport;

/// Size, samples, colours and channels of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureSettings {
    /// Width in pixels, `1..=16384`.
    pub width: u32,
    /// Height in pixels, `1..=16384`.
    pub height: u32,
    /// Samples a pixel, `1..=16` or 32; 1 means no anti-aliasing.
    pub samples: u32,
    /// What the numbers in the picture mean.
    pub color_space: ColorSpace,
    /// Behind everything.
    pub background: Background,
    /// Distance shows: what is farther away fades into the background.
    pub depth_cue: Option<DepthCue>,
    /// Edges instead of, or on top of, surfaces.
    pub lines: Lines,
    /// Width of edges and of the model's own lines in pixels, `0.1..=64`.
    pub line_width: f32,
    /// Colour of edges in the display's encoding, `0..=1`; `None`: dark on light ground and the
    /// other way round.
    pub edge_color: Option<[f32; 3]>,
    /// Which edges are drawn, where some are; at least one class.
    pub edge_classes: LineClasses,
    /// Side of the model's own points in pixels, `0.1..=64`.
    pub point_size: f32,
    /// Which planes of the frame are wanted.
    pub channels: Channels,
}

impl Default for PictureSettings {
    /// 1024 x 768 pixels of four samples, on a grey gradient.
    fn default() -> Self {
        Self {
            width: 1024,
            height: 768,
            samples: 4,
            color_space: ColorSpace::default(),
            background: Background::default(),
            depth_cue: None,
            lines: Lines::default(),
            line_width: Self::LINE_WIDTH,
            edge_color: None,
            edge_classes: LineClasses::ALL,
            point_size: Self::POINT_SIZE,
            channels: Channels::default(),
        }
    }
}

impl PictureSettings {
    /// Width of lines where nothing is said, pixels: a little more than one, so that slanted ones
    /// do not look thin.
    pub const LINE_WIDTH: f32 = 1.3;

    /// Side of points where nothing is said, pixels.
    pub const POINT_SIZE: f32 = 3.0;

    /// The picture's pixels, if all numbers are in their ranges.
    pub(super) fn check(&self) -> Result<Viewport, SettingsError> {
        if !matches!(self.samples, 1..=16 | 32) {
            return Err(SettingsError::Samples(self.samples));
        }
        if !(0.1..=64.0).contains(&self.line_width) {
            return Err(SettingsError::LineWidth(self.line_width));
        }
        if !(0.1..=64.0).contains(&self.point_size) {
            return Err(SettingsError::PointSize(self.point_size));
        }
        if self.edge_color.is_some_and(|color| !color.iter().all(|c| (0.0..=1.0).contains(c))) {
            return Err(SettingsError::EdgeColor);
        }
        if self.edge_classes.is_empty() {
            return Err(SettingsError::EdgeClasses);
        }
        self.depth_cue.map_or(Ok(()), |cue| cue.check(&self.background))?;
        let (width, height) = (self.width, self.height);
        Viewport::new(width, height).ok_or(SettingsError::Resolution { width, height })
    }
}

/// Depth cueing: `I' = s I + (1 - s) Idc`, where `s` depends linearly on the distance between two
/// planes across the direction of sight.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct DepthCue {
    /// `Idc` in the display's encoding, `0..=1`; `None`: the background of the pixel's row.
    pub color: Option<[f32; 3]>,
    /// Distance of the front plane from the viewer along the direction of sight, at least 0, world
    /// units; `None`: where the scene begins.
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
            (None, Background::Transparent) => {
                bad("without a background there must be a colour to fade into")
            }
            (Some(color), _) if !color.into_iter().all(unit) => {
                bad("a colour from 0 to 1 is required")
            }
            _ => Ok(()),
        }
    }
}

/// Behind everything.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(
    tag = "type",
    rename_all = "kebab-case",
    rename_all_fields = "kebab-case",
    deny_unknown_fields
)]
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
        self.depth
            || self.surface
            || self.object
            || self.material
            || self.normal
            || self.any_shadow()
    }

    /// Whether a plane of shadows is wanted.
    pub fn any_shadow(&self) -> bool {
        self.attached_shadow || self.cast_shadow
    }
}
