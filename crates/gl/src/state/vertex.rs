//! Current vertex attributes, the raster position, evaluators.

use super::MAX_TEXTURE_UNITS;
use crate::enums;

/// The attributes a vertex gets when none were given with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Current {
    /// Colour, not clamped.
    pub color: [f32; 4],
    /// Secondary colour.
    pub secondary: [f32; 3],
    /// Normal, model space.
    pub normal: [f32; 3],
    /// Texture coordinates s, t, r, q of each unit.
    pub tex: [[f32; 4]; MAX_TEXTURE_UNITS],
    /// Fog coordinate.
    pub fog: f32,
    /// Colour index, kept for queries alone.
    pub index: f32,
    /// Edge flag.
    pub edge: bool,
}

impl Default for Current {
    fn default() -> Self {
        Self {
            color: [1.0; 4],
            secondary: [0.0; 3],
            normal: [0.0, 0.0, 1.0],
            tex: [[0.0, 0.0, 0.0, 1.0]; MAX_TEXTURE_UNITS],
            fog: 0.0,
            index: 1.0,
            edge: true,
        }
    }
}

/// `RasterPos`: window coordinates and what fragments drawn there take over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RasterPosition {
    /// Window x, y, z; clip w.
    pub window: [f32; 4],
    /// Whether it was inside the view volume.
    pub valid: bool,
    /// Distance to the eye, for fog.
    pub distance: f32,
    /// Colour, after lighting, clamped.
    pub color: [f32; 4],
    /// Secondary colour, after lighting, clamped.
    pub secondary: [f32; 3],
    /// Texture coordinates after generation and texture matrix.
    pub tex: [[f32; 4]; MAX_TEXTURE_UNITS],
}

impl Default for RasterPosition {
    fn default() -> Self {
        Self {
            window: [0.0, 0.0, 0.0, 1.0],
            valid: true,
            distance: 0.0,
            color: [1.0; 4],
            secondary: [0.0; 3],
            tex: [[0.0, 0.0, 0.0, 1.0]; MAX_TEXTURE_UNITS],
        }
    }
}

/// A one-dimensional evaluator map.
#[derive(Clone, Debug, PartialEq)]
pub struct Map1 {
    /// Order of the polynomial.
    pub order: usize,
    /// Domain.
    pub u: [f32; 2],
    /// `order` control points, each with as many numbers as the target has.
    pub points: Vec<f32>,
}

/// A two-dimensional evaluator map.
#[derive(Clone, Debug, PartialEq)]
pub struct Map2 {
    /// Orders in u and v.
    pub order: [usize; 2],
    /// Domain in u.
    pub u: [f32; 2],
    /// Domain in v.
    pub v: [f32; 2],
    /// `order[0] * order[1]` control points, v fastest.
    pub points: Vec<f32>,
}

/// Evaluators; maps are indexed by `target - MAP1_COLOR_4` and `target - MAP2_COLOR_4`: colour 4,
/// index, normal, texture coordinates 1-4, vertex 3, vertex 4.
#[derive(Clone, Debug, PartialEq)]
pub struct Eval {
    /// One-dimensional maps.
    pub map1: [Map1; 9],
    /// Two-dimensional maps.
    pub map2: [Map2; 9],
    /// Enables of `map1`.
    pub map1_enabled: [bool; 9],
    /// Enables of `map2`.
    pub map2_enabled: [bool; 9],
    /// `AUTO_NORMAL`.
    pub auto_normal: bool,
    /// `MapGrid1`: segments, u1, u2.
    pub grid1: (i32, [f32; 2]),
    /// `MapGrid2`: segments in u and v, domains.
    pub grid2: ([i32; 2], [f32; 2], [f32; 2]),
}

/// The initial single control point of map `index`.
pub(crate) fn initial_point(index: usize) -> Vec<f32> {
    match index as u32 + enums::MAP1_COLOR_4 {
        enums::MAP1_COLOR_4 => vec![1.0; 4],
        enums::MAP1_INDEX => vec![1.0],
        enums::MAP1_NORMAL => vec![0.0, 0.0, 1.0],
        enums::MAP1_TEXTURE_COORD_1 => vec![0.0],
        enums::MAP1_TEXTURE_COORD_2 => vec![0.0; 2],
        enums::MAP1_TEXTURE_COORD_3 => vec![0.0; 3],
        enums::MAP1_VERTEX_3 => vec![0.0; 3],
        _ => vec![0.0, 0.0, 0.0, 1.0],
    }
}

impl Default for Eval {
    fn default() -> Self {
        let unit = [0.0, 1.0];
        Self {
            map1: std::array::from_fn(|i| Map1 { order: 1, u: unit, points: initial_point(i) }),
            map2: std::array::from_fn(|i| Map2 {
                order: [1, 1],
                u: unit,
                v: unit,
                points: initial_point(i),
            }),
            map1_enabled: [false; 9],
            map2_enabled: [false; 9],
            auto_normal: false,
            grid1: (1, unit),
            grid2: ([1, 1], unit, unit),
        }
    }
}
