//! Viewport, scissor, points, lines, polygons.

use crate::enums;
use std::sync::Arc;

/// Viewport in pixels and depth range.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Viewport {
    /// x, y, width, height.
    pub rect: [i32; 4],
    /// Near and far, clamped to 0..=1.
    pub depth_range: DepthRange,
}

/// `DEPTH_RANGE`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthRange {
    /// Window depth of the near plane.
    pub near: f64,
    /// Window depth of the far plane.
    pub far: f64,
}

impl Default for DepthRange {
    fn default() -> Self {
        Self { near: 0.0, far: 1.0 }
    }
}

/// What `glScissor` and `SCISSOR_TEST` set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Scissor {
    /// `SCISSOR_TEST`.
    pub enabled: bool,
    /// x, y, width, height.
    pub rect: [i32; 4],
}

/// What `glPoint...` calls set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Points {
    /// `POINT_SIZE`.
    pub size: f32,
    /// `POINT_SMOOTH`.
    pub smooth: bool,
    /// `POINT_SPRITE`.
    pub sprite: bool,
    /// `POINT_SIZE_MIN`, `POINT_SIZE_MAX`.
    pub limits: [f32; 2],
    /// `POINT_FADE_THRESHOLD_SIZE`.
    pub fade_threshold: f32,
    /// `POINT_DISTANCE_ATTENUATION`.
    pub attenuation: [f32; 3],
    /// `POINT_SPRITE_COORD_ORIGIN` (GL 2.0; `UPPER_LEFT` always in 1.5).
    pub sprite_r_mode: u32,
}

impl Default for Points {
    fn default() -> Self {
        Self {
            size: 1.0,
            smooth: false,
            sprite: false,
            limits: [0.0, super::MAX_POINT_SIZE],
            fade_threshold: 1.0,
            attenuation: [1.0, 0.0, 0.0],
            sprite_r_mode: enums::ZERO,
        }
    }
}

/// What `glLine...` calls set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lines {
    /// `LINE_WIDTH`.
    pub width: f32,
    /// `LINE_SMOOTH`.
    pub smooth: bool,
    /// `LINE_STIPPLE`.
    pub stipple: bool,
    /// Repeat factor 1..=256 and pattern.
    pub pattern: (i32, u16),
}

impl Default for Lines {
    fn default() -> Self {
        Self { width: 1.0, smooth: false, stipple: false, pattern: (1, 0xffff) }
    }
}

/// What `glPolygon...`, `glCullFace` and `glFrontFace` set.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygons {
    /// `CULL_FACE`.
    pub cull: bool,
    /// `CULL_FACE_MODE`.
    pub cull_mode: u32,
    /// `FRONT_FACE`.
    pub front_face: u32,
    /// `POLYGON_SMOOTH`.
    pub smooth: bool,
    /// `POLYGON_MODE`, front and back.
    pub mode: [u32; 2],
    /// Factor and units.
    pub offset: [f32; 2],
    /// `POLYGON_OFFSET_POINT`, `_LINE`, `_FILL`.
    pub offset_enabled: [bool; 3],
    /// `POLYGON_STIPPLE`.
    pub stipple: bool,
    /// 32 rows from the bottom, the leftmost pixel in the highest bit.
    pub stipple_pattern: Arc<[u32; 32]>,
}

impl Default for Polygons {
    fn default() -> Self {
        Self {
            cull: false,
            cull_mode: enums::BACK,
            front_face: enums::CCW,
            smooth: false,
            mode: [enums::FILL; 2],
            offset: [0.0; 2],
            offset_enabled: [false; 3],
            stipple: false,
            stipple_pattern: Arc::new([u32::MAX; 32]),
        }
    }
}
