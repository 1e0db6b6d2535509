//! Pixel transfer, maps and zoom.

use crate::enums;
use std::sync::Arc;

/// A table that pixel transfer looks components up in.
#[derive(Clone, Debug, PartialEq)]
pub struct PixelMap {
    /// At least one entry.
    pub values: Arc<Vec<f32>>,
}

impl Default for PixelMap {
    fn default() -> Self {
        Self { values: Arc::new(vec![0.0]) }
    }
}

/// `PixelTransfer` and `PixelMap`.
#[derive(Clone, Debug, PartialEq)]
pub struct PixelTransfer {
    /// `MAP_COLOR`.
    pub map_color: bool,
    /// `MAP_STENCIL`.
    pub map_stencil: bool,
    /// `INDEX_SHIFT`, `INDEX_OFFSET`.
    pub index: (i32, i32),
    /// `RED_SCALE` ...
    pub scale: [f32; 4],
    /// `RED_BIAS` ...
    pub bias: [f32; 4],
    /// `DEPTH_SCALE`, `DEPTH_BIAS`.
    pub depth: (f32, f32),
    /// Maps by `map - PIXEL_MAP_I_TO_I`: I to I, S to S, I to R, G, B, A, R to R, G to G, B to B, A
    /// to A.
    pub maps: [PixelMap; 10],
}

impl Default for PixelTransfer {
    fn default() -> Self {
        Self {
            map_color: false,
            map_stencil: false,
            index: (0, 0),
            scale: [1.0; 4],
            bias: [0.0; 4],
            depth: (1.0, 0.0),
            maps: std::array::from_fn(|_| PixelMap::default()),
        }
    }
}

/// `PixelZoom`, `ReadBuffer`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelMode {
    /// Zoom in x and y.
    pub zoom: [f32; 2],
    /// `READ_BUFFER` of the default framebuffer.
    pub read_buffer: u32,
}

impl Default for PixelMode {
    fn default() -> Self {
        Self { zoom: [1.0; 2], read_buffer: enums::FRONT }
    }
}
