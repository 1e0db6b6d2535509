//! What the vertex stage needs of the state, as it was when a draw was recorded.

use crate::enums as gl;
use crate::state::{Current, Fog, MaterialFace, State};
use crate::vertex::CurrentState;
use std::sync::Arc;
use vitral_light::{Attenuation, Light, LightKind, PreparedLight};
use vitral_math::{DMat4, DVec3, Mat3, Mat4, Vec4, func};

/// Generation of one coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Generation {
    /// The given coordinate.
    None,
    /// `plane · position`, model space.
    Object([f32; 4]),
    /// `plane · position`, eye space.
    Eye([f32; 4]),
    Sphere,
    Reflection,
    Normal,
}

impl Generation {
    /// Whether it is a linear function of the position, or none.
    pub(crate) fn is_linear(&self) -> bool {
        matches!(self, Self::None | Self::Object(_) | Self::Eye(_))
    }
}

/// A unit's texture coordinates.
#[derive(Clone, Debug)]
pub(crate) struct UnitSnapshot {
    pub index: usize,
    pub generation: [Generation; 4],
    /// Texture matrix, unless it is the identity.
    pub matrix: Option<[f32; 16]>,
}

/// Which material properties follow the colour.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Tracked {
    pub ambient: bool,
    pub diffuse: bool,
    pub specular: bool,
    pub emission: bool,
}

/// Lighting as it was.
#[derive(Clone, Debug)]
pub(crate) struct LightingSnapshot {
    pub lights: Arc<[PreparedLight]>,
    pub ambient: [f32; 3],
    pub local_viewer: bool,
    pub two_side: bool,
    pub separate_specular: bool,
    pub material: [MaterialFace; 2],
    /// Front, back.
    pub tracked: [Tracked; 2],
}

/// Where fog coordinates come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FogSource {
    /// The distance from the eye's plane.
    Depth,
    /// How far it lies ahead of the eye: as `Depth` for visible vertices, but linear.
    Ahead,
    /// The distance from the eye.
    Radial,
    Given,
}

impl FogSource {
    fn of(fog: &Fog) -> Self {
        match (fog.source, fog.distance_mode) {
            (gl::FOG_COORD, _) => Self::Given,
            (_, gl::EYE_RADIAL_NV) => Self::Radial,
            (_, gl::EYE_PLANE) => Self::Ahead,
            _ => Self::Depth,
        }
    }

    /// Whether coordinates are linear functions of what vertices are given.
    pub(crate) fn is_linear(self) -> bool {
        matches!(self, Self::Ahead | Self::Given)
    }
}

/// See the module.
#[derive(Clone, Debug)]
pub(crate) struct VertexSnapshot {
    pub current: Current,
    /// With the modelview matrix that all have for which the batch names none.
    pub transform: Transform,
    projection: Mat4,
    pub normalize: bool,
    rescale_normal: bool,
    pub lighting: Option<LightingSnapshot>,
    pub units: Vec<UnitSnapshot>,
    pub fog: Option<FogSource>,
    /// Eye-space planes: inside is >= 0.
    clip_planes: Vec<[f32; 4]>,
    /// The secondary colour is used although lighting is off.
    pub color_sum: bool,
    /// Colours are brought into `0..=1`.
    pub clamps: bool,
}

/// What depends on the modelview matrix.
#[derive(Clone, Debug)]
pub(crate) struct Transform {
    /// Column-major.
    pub modelview: [f32; 16],
    pub clip_from_model: [f32; 16],
    /// Rows of the map of normals to eye space.
    pub normal_rows: [[f32; 3]; 3],
    /// Model-space planes: inside is >= 0.
    pub clip_planes: Vec<[f32; 4]>,
}

impl Transform {
    fn new(modelview: &Mat4, projection: &Mat4, rescale_normal: bool, planes: &[[f32; 4]]) -> Self {
        let model_plane =
            |plane: &[f32; 4]| (modelview.transpose() * Vec4::from_array(*plane)).to_array();
        Self {
            modelview: modelview.to_cols_array(),
            clip_from_model: (*projection * *modelview).to_cols_array(),
            normal_rows: normal_map(modelview, rescale_normal),
            clip_planes: planes.iter().map(model_plane).collect(),
        }
    }
}

impl VertexSnapshot {
    /// Whether vertices get nothing but linear functions of what they are given.
    pub(crate) fn is_linear(&self) -> bool {
        self.lighting.is_none()
            && self.units.iter().flat_map(|unit| &unit.generation).all(Generation::is_linear)
    }

    /// What another modelview matrix makes of it.
    pub(crate) fn transform_by(&self, modelview: &Mat4) -> Transform {
        Transform::new(modelview, &self.projection, self.rescale_normal, &self.clip_planes)
    }

    /// Takes the state that the draw needs; `units` are the sampled units, `fog` whether fog is on,
    /// `lights` a cache.
    pub(crate) fn new(
        state: &State,
        given: &CurrentState,
        units: &[usize],
        fog: bool,
        lights: &mut LightCache,
    ) -> Self {
        // Collect the enabled clip planes and the source of fog.
        let matrices = &state.matrices;
        let planes = state
            .clip_planes
            .iter()
            .zip(&state.clip_plane_enabled)
            .filter(|(_, enabled)| **enabled);
        let clip_planes: Vec<_> = planes.map(|(plane, _)| plane.map(|v| v as f32)).collect();
        let projection = matrices.projection.top();
        let rescale_normal = matrices.rescale_normal && !matrices.normalize;

        // Copy what the vertex stages read.
        Self {
            current: state.current,
            transform: Transform::new(&given.modelview, &projection, rescale_normal, &clip_planes),
            projection,
            normalize: matrices.normalize,
            rescale_normal,
            lighting: state.lighting.enabled.then(|| LightingSnapshot::new(state, given, lights)),
            units: units.iter().map(|&u| unit(state, u)).collect(),
            fog: fog.then(|| FogSource::of(&state.fog)),
            clip_planes,
            color_sum: state.color_sum,
            clamps: true,
        }
    }
}

/// Rows of the map of normals.
fn normal_map(modelview: &Mat4, rescale: bool) -> [[f32; 3]; 3] {
    let upper = Mat3::from_mat4(*modelview);
    let determinant = upper.determinant();
    let inverse = if determinant != 0.0 && determinant.is_finite() {
        upper.inverse()
    } else {
        Mat3::IDENTITY
    };
    // n_eye = (M^-1)^T n: its rows are the columns of the inverse.
    let mut rows =
        [inverse.x_axis.to_array(), inverse.y_axis.to_array(), inverse.z_axis.to_array()];
    if rescale {
        let third = inverse.row(2);
        let length = third.length();
        if length > 0.0 {
            rows.iter_mut().flatten().for_each(|v| *v /= length);
        }
    }
    rows
}

fn unit(state: &State, index: usize) -> UnitSnapshot {
    let generation = state.units[index].generation.map(|g| match (g.enabled, g.mode) {
        (false, _) => Generation::None,
        (_, gl::OBJECT_LINEAR) => Generation::Object(g.object_plane),
        (_, gl::EYE_LINEAR) => Generation::Eye(g.eye_plane),
        (_, gl::SPHERE_MAP) => Generation::Sphere,
        (_, gl::REFLECTION_MAP) => Generation::Reflection,
        _ => Generation::Normal,
    });
    let matrix = state.matrices.texture[index].top();
    UnitSnapshot {
        index,
        generation,
        matrix: (matrix != Mat4::IDENTITY).then(|| matrix.to_cols_array()),
    }
}

impl LightingSnapshot {
    fn new(state: &State, given: &CurrentState, cache: &mut LightCache) -> Self {
        let lighting = &state.lighting;
        let material = lighting.color_material;

        // Find the parameters that follow the colour.
        let tracked = |face: u32| {
            if !material.enabled || (material.face != gl::FRONT_AND_BACK && material.face != face) {
                return Tracked::default();
            }
            Tracked {
                ambient: matches!(material.mode, gl::AMBIENT | gl::AMBIENT_AND_DIFFUSE),
                diffuse: matches!(material.mode, gl::DIFFUSE | gl::AMBIENT_AND_DIFFUSE),
                specular: material.mode == gl::SPECULAR,
                emission: material.mode == gl::EMISSION,
            }
        };

        // Collect the light model and the materials.
        let [r, g, b, _] = lighting.model.ambient;
        Self {
            lights: cache.prepare(&lighting.lights),
            ambient: [r, g, b],
            local_viewer: lighting.model.local_viewer,
            two_side: lighting.model.two_side,
            separate_specular: lighting.model.color_control == gl::SEPARATE_SPECULAR_COLOR,
            material: given.material,
            tracked: [tracked(gl::FRONT), tracked(gl::BACK)],
        }
    }
}

/// Lights that were on before, prepared: most draws share them.
#[derive(Debug, Default)]
pub(crate) struct LightCache {
    lights: Vec<Option<(crate::state::Light, Option<PreparedLight>)>>,
    /// Those that were on.
    on: Arc<[PreparedLight]>,
}

impl LightCache {
    fn prepare(&mut self, lights: &[crate::state::Light]) -> Arc<[PreparedLight]> {
        self.lights.resize(lights.len(), None);
        let mut changed = false;
        for (light, kept) in lights.iter().zip(&mut self.lights) {
            if !kept.as_ref().map_or(!light.enabled, |(of, _)| of == light) {
                *kept = light.enabled.then(|| (*light, prepare(light)));
                changed = true;
            }
        }
        if changed {
            self.on =
                self.lights.iter().flatten().filter_map(|(_, prepared)| prepared.clone()).collect();
        }
        self.on.clone()
    }
}

fn prepare(light: &crate::state::Light) -> Option<PreparedLight> {
    // Scale the colours of a light at infinity by its cone.
    let [x, y, z, w] = light.position.map(f64::from);
    let [constant, linear, quadratic] = light.attenuation.map(f64::from);
    let position = DVec3::new(x, y, z) / w;
    let share = if w == 0.0 { cone_at_infinity(light) } else { 1.0 };
    let rgb = |c: [f32; 4]| [c[0] * share, c[1] * share, c[2] * share];

    // Translate the kind of light.
    let (kind, attenuation) = if w == 0.0 {
        (LightKind::Directional { direction: -DVec3::new(x, y, z) }, Attenuation::None)
    } else if light.spot_cutoff == 180.0 {
        (LightKind::Point { position }, Attenuation::Gl { constant, linear, quadratic })
    } else {
        let cutoff = f64::from(light.spot_cutoff).to_radians();
        let direction = DVec3::from_array(light.spot_direction.map(f64::from));
        let exponent = f64::from(light.spot_exponent);
        let kind = LightKind::Spot { position, direction, cutoff, inner: cutoff, exponent };
        (kind, Attenuation::Gl { constant, linear, quadratic })
    };

    // Prepare it in eye space.
    let light = Light {
        kind,
        attenuation,
        ambient: rgb(light.ambient),
        diffuse: rgb(light.diffuse),
        specular: rgb(light.specular),
        ..Light::default()
    };
    PreparedLight::new(&light, &DMat4::IDENTITY)
}

/// How much of a light at infinity its cone lets through: all of its rays make the same angle with
/// the axis.
fn cone_at_infinity(light: &crate::state::Light) -> f32 {
    if light.spot_cutoff == 180.0 {
        return 1.0;
    }
    let [x, y, z, _] = light.position.map(f64::from);
    let axis = DVec3::from_array(light.spot_direction.map(f64::from));
    let cos = (-DVec3::new(x, y, z)).normalize_or_zero().dot(axis.normalize_or_zero());
    if cos < func::cos(f64::from(light.spot_cutoff).to_radians()) {
        return 0.0;
    }
    func::pow(cos.max(0.0), f64::from(light.spot_exponent)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_light_at_infinity_has_a_cone() {
        let mut light = crate::state::Lighting::default().lights[0];
        light.position = [0.0, 0.0, -2.0, 0.0];
        assert_eq!(cone_at_infinity(&light), 1.0);
        (light.spot_cutoff, light.spot_exponent) = (89.0, 2.0);
        light.spot_direction = [3.0f32.sqrt(), 0.0, 1.0];
        assert!((cone_at_infinity(&light) - 0.25).abs() < 1e-6);
        light.spot_cutoff = 59.0;
        assert_eq!(cone_at_infinity(&light), 0.0);
    }
}
