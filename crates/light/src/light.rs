//! Lights: ambient, directional, point, spot, area, with their attenuation over distance.
//!
//! Self-luminous objects are materials with an `emission`.

use crate::Rgb;
use serde::{Deserialize, Serialize};
use vitral_math::{DMat3, DMat4, DVec3, func};

/// A light source. Positions and directions are in world space.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct Light {
    /// For messages and overrides; may be empty.
    pub name: String,
    /// Where the light comes from.
    pub kind: LightKind,
    /// Intensity that the ambient coefficient `ka` reflects (Ia), RGB.
    pub ambient: Rgb,
    /// Intensity that the diffuse coefficient `kd` reflects (Ip), RGB.
    pub diffuse: Rgb,
    /// Intensity that the specular coefficient `ks` reflects, RGB.
    pub specular: Rgb,
    /// Loss over distance; a directional light has none whatever is set.
    pub attenuation: Attenuation,
    /// Switched on.
    pub enabled: bool,
    /// Casts shadows, where a shadow algorithm is chosen.
    pub shadow: bool,
}

impl Default for Light {
    fn default() -> Self {
        Self {
            name: String::new(),
            kind: LightKind::Directional { direction: DVec3::NEG_Z },
            ambient: [0.0; 3],
            diffuse: [1.0; 3],
            specular: [1.0; 3],
            attenuation: Attenuation::None,
            enabled: true,
            shadow: true,
        }
    }
}

/// Where a light's rays come from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "kebab-case", rename_all_fields = "kebab-case", deny_unknown_fields)]
pub enum LightKind {
    /// From everywhere, without direction.
    Ambient,
    /// Parallel rays from infinitely far away.
    Directional {
        /// The way the light travels (not towards the light); any length but 0.
        direction: DVec3,
    },
    /// From a point, the same in all directions.
    Point {
        /// The point.
        position: DVec3,
    },
    /// From a point, into a cone.
    Spot {
        /// Apex of the cone.
        position: DVec3,
        /// Axis of the cone, the way the light travels; any length but 0.
        direction: DVec3,
        /// Half angle of the cone in radians, `0..=π/2`: no light outside.
        cutoff: f64,
        /// Half angle in radians inside which a `smooth` fall-off has not yet begun (glTF's inner cone); equal to
        /// `cutoff` for a hard edge.
        inner: f64,
        /// Inside the cone intensity goes with `cos^exponent` of the angle to the axis (GL's form; 0: constant).
        exponent: f64,
    },
    /// From a flat shape, on the side its normal points to. Diffuse surfaces get what the whole shape sends, highlights
    /// are those of one sample at its centre, shadows those of many.
    Area {
        /// The shape.
        shape: AreaShape,
    },
}

/// Outline of an area light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "shape", rename_all = "kebab-case", rename_all_fields = "kebab-case", deny_unknown_fields)]
pub enum AreaShape {
    /// A disc.
    Disc {
        /// Its centre.
        center: DVec3,
        /// The side that shines; any length but 0.
        normal: DVec3,
        /// Its radius.
        radius: f64,
    },
    /// A planar polygon; it shines towards the side from which its corners run counter-clockwise.
    Polygon {
        /// At least three corners.
        corners: Vec<DVec3>,
    },
}

/// Loss of intensity over the distance `d` from a point, spot or area light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(tag = "form", rename_all = "kebab-case", rename_all_fields = "kebab-case", deny_unknown_fields)]
pub enum Attenuation {
    /// No loss.
    #[default]
    None,
    /// `1 / d²`, the physical law.
    InverseSquare,
    /// `min(1 / (c1 + c2 d + c3 d²), 1)`, the compromise of the course.
    Clamped {
        /// Keeps the denominator from vanishing near the light.
        c1: f64,
        /// Linear term.
        c2: f64,
        /// Quadratic term.
        c3: f64,
    },
    /// `1 / (constant + linear d + quadratic d²)`, OpenGL's form, without a clamp.
    Gl {
        /// Constant term.
        constant: f64,
        /// Linear term.
        linear: f64,
        /// Quadratic term.
        quadratic: f64,
    },
    /// `max(min(1 - (d/range)^4, 1), 0) / d²`, the window of KHR_lights_punctual.
    Range {
        /// Distance at which the light ends.
        range: f64,
    },
}

impl Light {
    /// The light after an affine transform: positions as points, directions as vectors, normals as normals.
    #[must_use]
    pub fn transformed(&self, to_from_here: &DMat4) -> Self {
        let point = |p: DVec3| to_from_here.transform_point3(p);
        let vector = |v: DVec3| to_from_here.transform_vector3(v);
        let kind = match &self.kind {
            LightKind::Ambient => LightKind::Ambient,
            LightKind::Directional { direction } => LightKind::Directional { direction: vector(*direction) },
            LightKind::Point { position } => LightKind::Point { position: point(*position) },
            &LightKind::Spot { position, direction, cutoff, inner, exponent } => {
                LightKind::Spot { position: point(position), direction: vector(direction), cutoff, inner, exponent }
            }
            LightKind::Area { shape: AreaShape::Disc { center, normal, radius } } => {
                let linear = DMat3::from_mat4(*to_from_here);
                let normal = linear.inverse().transpose() * *normal;
                let radius = radius * func::pow(linear.determinant().abs(), 1.0 / 3.0);
                LightKind::Area { shape: AreaShape::Disc { center: point(*center), normal, radius } }
            }
            LightKind::Area { shape: AreaShape::Polygon { corners } } => {
                let corners = corners.iter().map(|&c| point(c)).collect();
                LightKind::Area { shape: AreaShape::Polygon { corners } }
            }
        };
        Self { kind, ..self.clone() }
    }
}
