//! Lights, materials, the light model.

use super::MAX_LIGHTS;
use crate::enums;

/// One light. Position and direction are in eye space: transformed when they were given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// `GL_LIGHTi`.
    pub enabled: bool,
    /// Ambient intensity.
    pub ambient: [f32; 4],
    /// Diffuse intensity.
    pub diffuse: [f32; 4],
    /// Specular intensity.
    pub specular: [f32; 4],
    /// Eye-space position; `w = 0`: a direction towards the light.
    pub position: [f32; 4],
    /// Eye-space direction of the spot, not normalised.
    pub spot_direction: [f32; 3],
    /// Spot exponent, 0..=128.
    pub spot_exponent: f32,
    /// Spot cutoff in degrees, 0..=90 or 180.
    pub spot_cutoff: f32,
    /// Constant, linear, quadratic attenuation.
    pub attenuation: [f32; 3],
}

/// What one side of a polygon is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialFace {
    /// Ambient colour.
    pub ambient: [f32; 4],
    /// Diffuse colour; its alpha is the vertex's.
    pub diffuse: [f32; 4],
    /// Specular colour.
    pub specular: [f32; 4],
    /// Emitted colour.
    pub emission: [f32; 4],
    /// Specular exponent, 0..=128.
    pub shininess: f32,
    /// Colour indices, kept for queries alone.
    pub indexes: [f32; 3],
}

impl Default for MaterialFace {
    fn default() -> Self {
        Self {
            ambient: [0.2, 0.2, 0.2, 1.0],
            diffuse: [0.8, 0.8, 0.8, 1.0],
            specular: [0.0, 0.0, 0.0, 1.0],
            emission: [0.0, 0.0, 0.0, 1.0],
            shininess: 0.0,
            indexes: [0.0, 1.0, 1.0],
        }
    }
}

/// `LightModel`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightModel {
    /// Ambient light of the scene.
    pub ambient: [f32; 4],
    /// `LIGHT_MODEL_LOCAL_VIEWER`.
    pub local_viewer: bool,
    /// `LIGHT_MODEL_TWO_SIDE`.
    pub two_side: bool,
    /// `LIGHT_MODEL_COLOR_CONTROL`.
    pub color_control: u32,
}

/// `COLOR_MATERIAL`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorMaterial {
    /// Whether materials follow the current colour.
    pub enabled: bool,
    /// `COLOR_MATERIAL_FACE`.
    pub face: u32,
    /// `COLOR_MATERIAL_PARAMETER`.
    pub mode: u32,
}

/// Everything about lighting.
#[derive(Clone, Debug, PartialEq)]
pub struct Lighting {
    /// `LIGHTING`.
    pub enabled: bool,
    /// `SHADE_MODEL`.
    pub shade_model: u32,
    /// `PROVOKING_VERTEX`.
    pub provoking_vertex: u32,
    /// `COLOR_MATERIAL`.
    pub color_material: ColorMaterial,
    /// Front and back.
    pub material: [MaterialFace; 2],
    /// The light model.
    pub model: LightModel,
    /// The lights.
    pub lights: Vec<Light>,
}

impl Default for Lighting {
    fn default() -> Self {
        // Light 0 is white; the others are dark.
        let light = |i: usize| {
            let color = if i == 0 { [1.0; 4] } else { [0.0, 0.0, 0.0, 1.0] };
            Light {
                enabled: false,
                ambient: [0.0, 0.0, 0.0, 1.0],
                diffuse: color,
                specular: color,
                position: [0.0, 0.0, 1.0, 0.0],
                spot_direction: [0.0, 0.0, -1.0],
                spot_exponent: 0.0,
                spot_cutoff: 180.0,
                attenuation: [1.0, 0.0, 0.0],
            }
        };
        Self {
            enabled: false,
            shade_model: enums::SMOOTH,
            provoking_vertex: enums::LAST_VERTEX_CONVENTION,
            color_material: ColorMaterial {
                enabled: false,
                face: enums::FRONT_AND_BACK,
                mode: enums::AMBIENT_AND_DIFFUSE,
            },
            material: [MaterialFace::default(); 2],
            model: LightModel {
                ambient: [0.2, 0.2, 0.2, 1.0],
                local_viewer: false,
                two_side: false,
                color_control: enums::SINGLE_COLOR,
            },
            lights: (0..MAX_LIGHTS).map(light).collect(),
        }
    }
}
