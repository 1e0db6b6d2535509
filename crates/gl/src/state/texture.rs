//! Texture units: enables, bindings, generation, environment.

use crate::enums;

/// Generation of one coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TexGen {
    /// `TEXTURE_GEN_S` ...
    pub enabled: bool,
    /// `TEXTURE_GEN_MODE`.
    pub mode: u32,
    /// Plane in model space.
    pub object_plane: [f32; 4],
    /// Plane in eye space: transformed when it was given.
    pub eye_plane: [f32; 4],
}

/// The `COMBINE` environment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Combine {
    /// `COMBINE_RGB`, `COMBINE_ALPHA`.
    pub functions: [u32; 2],
    /// `SOURCE0_RGB` ...
    pub rgb_sources: [u32; 3],
    /// `SOURCE0_ALPHA` ...
    pub alpha_sources: [u32; 3],
    /// `OPERAND0_RGB` ...
    pub rgb_operands: [u32; 3],
    /// `OPERAND0_ALPHA` ...
    pub alpha_operands: [u32; 3],
    /// `RGB_SCALE`, `ALPHA_SCALE`.
    pub scale: [f32; 2],
}

/// `TexEnv`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureEnvironment {
    /// `TEXTURE_ENV_MODE`.
    pub mode: u32,
    /// `TEXTURE_ENV_COLOR`, clamped.
    pub color: [f32; 4],
    /// `TEXTURE_LOD_BIAS` of the unit.
    pub lod_bias: f32,
    /// `COORD_REPLACE` of point sprites.
    pub coord_replace: bool,
    /// `COMBINE`.
    pub combine: Combine,
}

impl Default for TextureEnvironment {
    fn default() -> Self {
        use enums::{CONSTANT, PREVIOUS, SRC_ALPHA, SRC_COLOR, TEXTURE};
        Self {
            mode: enums::MODULATE,
            color: [0.0; 4],
            lod_bias: 0.0,
            coord_replace: false,
            combine: Combine {
                functions: [enums::MODULATE; 2],
                rgb_sources: [TEXTURE, PREVIOUS, CONSTANT],
                alpha_sources: [TEXTURE, PREVIOUS, CONSTANT],
                rgb_operands: [SRC_COLOR, SRC_COLOR, SRC_ALPHA],
                alpha_operands: [SRC_ALPHA; 3],
                scale: [1.0; 2],
            },
        }
    }
}

/// Indices of [`TextureUnit::enabled`], lowest priority first.
pub mod target {
    /// `TEXTURE_1D`.
    pub const ONE: usize = 0;
    /// `TEXTURE_2D`.
    pub const TWO: usize = 1;
    /// `TEXTURE_RECTANGLE`.
    pub const RECTANGLE: usize = 2;
    /// `TEXTURE_3D`.
    pub const THREE: usize = 3;
    /// `TEXTURE_CUBE_MAP`.
    pub const CUBE: usize = 4;
}

/// One texture unit.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureUnit {
    /// Enables by [`target`].
    pub enabled: [bool; 5],
    /// Generation of s, t, r, q.
    pub generation: [TexGen; 4],
    /// How the unit's texture is combined with the colour.
    pub environment: TextureEnvironment,
}

impl Default for TextureUnit {
    fn default() -> Self {
        let plane = |i| match i {
            0 => [1.0, 0.0, 0.0, 0.0],
            1 => [0.0, 1.0, 0.0, 0.0],
            _ => [0.0; 4],
        };
        Self {
            enabled: [false; 5],
            generation: std::array::from_fn(|i| TexGen {
                enabled: false,
                mode: enums::EYE_LINEAR,
                object_plane: plane(i),
                eye_plane: plane(i),
            }),
            environment: TextureEnvironment::default(),
        }
    }
}
