//! Lights: ambient, directional, point, spot, area, with their attenuation over distance.
//!
//! Self-luminous objects are materials with an `emission`.

use crate::Rgb;
use serde::{Deserialize, Serialize};
use vitral_math::{DMat3, DMat4, DVec2, DVec3, func};

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
    /// Intensities are candela or lux, divided by pi, not shares of white: pictures are exposed for
    /// them.
    pub photometric: bool,
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
            photometric: false,
        }
    }
}

/// Where a light's rays come from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(
    tag = "type",
    rename_all = "kebab-case",
    rename_all_fields = "kebab-case",
    deny_unknown_fields
)]
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
        /// Half angle in radians inside which a `smooth` fall-off has not yet begun (glTF's inner
        /// cone); equal to `cutoff` for a hard edge.
        inner: f64,
        /// Inside the cone intensity goes with `cos^exponent` of the angle to the axis (GL's form;
        /// 0: constant).
        exponent: f64,
    },
    /// From a flat shape, on the side its normal points to. Diffuse surfaces get what the whole
    /// shape sends, highlights are those of one sample at its centre, shadows those of many.
    Area {
        /// The shape whose points shine.
        shape: AreaShape,
    },
}

/// Outline of an area light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(
    tag = "shape",
    rename_all = "kebab-case",
    rename_all_fields = "kebab-case",
    deny_unknown_fields
)]
pub enum AreaShape {
    /// A disc that shines to one side.
    Disc {
        /// Its centre.
        center: DVec3,
        /// The side that shines; any length but 0.
        normal: DVec3,
        /// Radius in units of the world.
        radius: f64,
    },
    /// A planar polygon; it shines towards the side from which its corners run counter-clockwise.
    Polygon {
        /// At least three corners.
        corners: Vec<DVec3>,
    },
}

impl AreaShape {
    /// The centre of a disc, or the mean of a polygon's corners.
    pub fn middle(&self) -> DVec3 {
        match self {
            Self::Disc { center, .. } => *center,
            Self::Polygon { corners } => {
                corners.iter().sum::<DVec3>() / corners.len().max(1) as f64
            }
        }
    }
}

/// Loss of intensity over the distance `d` from a point, spot or area light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(
    tag = "form",
    rename_all = "kebab-case",
    rename_all_fields = "kebab-case",
    deny_unknown_fields
)]
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

/// Widest half angle of a cone: a right one, as it may be rounded.
const WIDEST: f64 = std::f64::consts::FRAC_PI_2 + 1e-3;
/// How far corners of a polygon may lie off its plane, as a part of its size: what a few digits of
/// a file leave.
const FLAT: f64 = 1e-3;
/// A polygon whose area is a smaller part of the square round it has none.
const AREA: f64 = 1e-9;
/// Outlines of more corners are not searched for crossings, which takes the square of their number.
const SEARCHED: usize = 1000;

impl AreaShape {
    /// What is wrong with the shape, for those who read it and can say so.
    ///
    /// # Errors
    /// A sentence on what is required.
    pub fn check(&self) -> Result<(), &'static str> {
        match self {
            Self::Disc { normal, radius, .. } => {
                normal.try_normalize().ok_or("normal: a direction of some length is required")?;
                if *radius >= 0.0 {
                    Ok(())
                } else {
                    Err("radius: a number of at least 0 is required")
                }
            }
            Self::Polygon { corners } => check_polygon(corners),
        }
    }
}

fn check_polygon(corners: &[DVec3]) -> Result<(), &'static str> {
    let &[first, _, _, ..] = corners else { return Err("corners: at least three are required") };
    let from_first: Vec<DVec3> = corners.iter().map(|&c| c - first).collect();
    let size = from_first.iter().map(|c| c.length()).fold(0.0, f64::max);
    let twice: DVec3 = from_first.windows(2).map(|pair| pair[0].cross(pair[1])).sum();
    let has_area = twice.length() > AREA * size * size;
    // Without an area, it may be that parts of an outline that crosses itself cancel each other.
    let normal = if has_area { twice.normalize() } else { any_normal(&from_first) };
    if normal == DVec3::ZERO {
        return Err("corners: a polygon with an area is required");
    }
    if from_first.iter().any(|c| c.dot(normal).abs() > FLAT * size) {
        return Err("corners: they have to lie in one plane");
    }
    let (x, y) = normal.any_orthonormal_pair();
    let corners: Vec<DVec2> = from_first.iter().map(|c| DVec2::new(c.dot(x), c.dot(y))).collect();
    if crosses_itself(&corners) {
        return Err("corners: the outline must not cross itself");
    }
    if has_area { Ok(()) } else { Err("corners: a polygon with an area is required") }
}

/// The normal of the largest triangle with the first corner, the origin, and a side; zero if all
/// are on one line.
fn any_normal(corners: &[DVec3]) -> DVec3 {
    let size = corners.iter().map(|c| c.length()).fold(0.0, f64::max);
    let crosses = corners.windows(2).map(|pair| pair[0].cross(pair[1]));
    let largest = crosses.max_by(|a, b| a.length().total_cmp(&b.length())).unwrap_or(DVec3::ZERO);
    if largest.length() > AREA * size * size { largest.normalize() } else { DVec3::ZERO }
}

/// Whether two sides of a polygon cross at a point inside both.
fn crosses_itself(corners: &[DVec2]) -> bool {
    let count = corners.len();
    let side = |i: usize| (corners[i], corners[(i + 1) % count]);
    let left = |(a, b): (DVec2, DVec2), p: DVec2| (b - a).perp_dot(p - a);
    let apart = |s: (DVec2, DVec2), t: (DVec2, DVec2)| left(s, t.0) * left(s, t.1) < 0.0;
    let cross = |i: usize, j: usize| apart(side(i), side(j)) && apart(side(j), side(i));
    count <= SEARCHED && (0..count).any(|i| (i + 2..count).any(|j| cross(i, j)))
}

impl LightKind {
    fn check(&self) -> Result<(), &'static str> {
        let directed = |direction: &DVec3| direction.try_normalize().is_some();
        match self {
            Self::Directional { direction } | Self::Spot { direction, .. }
                if !directed(direction) =>
            {
                Err("direction: a direction of some length is required")
            }
            Self::Spot { cutoff, .. } if !(*cutoff > 0.0 && *cutoff <= WIDEST) => {
                Err("cutoff: a half angle above 0, up to 90 degrees, is required")
            }
            Self::Spot { cutoff, inner, .. } if !(*inner >= 0.0 && inner <= cutoff) => {
                Err("inner: a half angle from 0 to the cutoff is required")
            }
            Self::Spot { exponent, .. } if exponent.is_nan() || *exponent < 0.0 => {
                Err("exponent: a number of at least 0 is required")
            }
            Self::Area { shape } => shape.check(),
            _ => Ok(()),
        }
    }
}

impl Attenuation {
    fn check(&self) -> Result<(), &'static str> {
        let sound =
            |terms: [f64; 3]| terms.iter().all(|&t| t >= 0.0) && terms.iter().any(|&t| t > 0.0);
        match *self {
            Self::Range { range } if range.is_nan() || range <= 0.0 => {
                Err("attenuation: a range above 0 is required")
            }
            Self::Clamped { c1: a, c2: b, c3: c }
            | Self::Gl { constant: a, linear: b, quadratic: c }
                if !sound([a, b, c]) =>
            {
                Err("attenuation: three terms of at least 0, not all 0, are required")
            }
            _ => Ok(()),
        }
    }
}

impl Light {
    /// What keeps the light from shining, or from being what it says, for those who read lights and
    /// can say so; in a picture, lights that cannot shine are left out.
    ///
    /// # Errors
    /// A sentence on what is required.
    pub fn check(&self) -> Result<(), &'static str> {
        let sound = |intensity: &Rgb| {
            intensity.iter().all(|&channel| channel.is_finite() && channel >= 0.0)
        };
        if ![self.ambient, self.diffuse, self.specular].iter().all(sound) {
            return Err(
                "ambient, diffuse, specular: finite intensities of at least 0 are required",
            );
        }
        self.kind.check()?;
        self.attenuation.check()
    }

    /// The light after an affine transform: positions as points, directions as vectors, normals as
    /// normals.
    #[must_use]
    pub fn transformed(&self, to_from_here: &DMat4) -> Self {
        let point = |p: DVec3| to_from_here.transform_point3(p);
        let vector = |v: DVec3| to_from_here.transform_vector3(v);
        let kind = match &self.kind {
            LightKind::Ambient => LightKind::Ambient,
            LightKind::Directional { direction } => {
                LightKind::Directional { direction: vector(*direction) }
            }
            LightKind::Point { position } => LightKind::Point { position: point(*position) },
            &LightKind::Spot { position, direction, cutoff, inner, exponent } => LightKind::Spot {
                position: point(position),
                direction: vector(direction),
                cutoff,
                inner,
                exponent,
            },
            LightKind::Area { shape: AreaShape::Disc { center, normal, radius } } => {
                let linear = DMat3::from_mat4(*to_from_here);
                let normal = linear.inverse().transpose() * *normal;
                let radius = radius * func::pow(linear.determinant().abs(), 1.0 / 3.0);
                LightKind::Area {
                    shape: AreaShape::Disc { center: point(*center), normal, radius },
                }
            }
            LightKind::Area { shape: AreaShape::Polygon { corners } } => {
                let mut corners: Vec<DVec3> = corners.iter().map(|&c| point(c)).collect();
                // Mirrored corners run the other way, and the light would leave the other side.
                if DMat3::from_mat4(*to_from_here).determinant() < 0.0 {
                    corners.reverse();
                }
                LightKind::Area { shape: AreaShape::Polygon { corners } }
            }
        };
        Self { kind, ..self.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::dvec3;

    fn polygon(corners: &[[f64; 3]]) -> Result<(), &'static str> {
        AreaShape::Polygon { corners: corners.iter().map(|&c| DVec3::from_array(c)).collect() }
            .check()
    }

    #[test]
    fn polygons_that_cannot_shine_are_told_apart() {
        let area = Err("corners: a polygon with an area is required");
        let crossing = Err("corners: the outline must not cross itself");
        assert_eq!(
            polygon(&[[0.0; 3], [1.0, 0.0, 0.0]]),
            Err("corners: at least three are required")
        );
        assert_eq!(
            polygon(&[[0.0, 5.0, 0.0], [1.0, 5.0, 0.0], [2.0, 5.0, 0.0]]),
            area,
            "on a line"
        );
        assert_eq!(polygon(&[[1.0, 5.0, 3.0]; 3]), area, "all one place");
        assert_eq!(
            polygon(&[[0.0; 3], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
            crossing,
            "a bow-tie"
        );
        assert_eq!(
            polygon(&[[0.0; 3], [2.0, 2.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
            crossing,
            "with an area"
        );
        let bent = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.5], [0.0, 1.0, 0.0]];
        assert_eq!(polygon(&bent), Err("corners: they have to lie in one plane"));
    }

    #[test]
    fn sound_polygons_may_be_concave_rounded_small_and_have_corners_on_sides() {
        let l = [
            [0.0; 3],
            [2.0, 0.0, 0.0],
            [2.0, 1.0, 0.0],
            [1.0, 1.0, 0.0],
            [1.0, 2.0, 0.0],
            [0.0, 2.0, 0.0],
        ];
        assert_eq!(polygon(&l), Ok(()));
        let small = l.map(|c| c.map(|x| 1e5 + x * 1e-2));
        assert_eq!(polygon(&small), Ok(()), "as files have them");
        assert_eq!(
            polygon(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 1e-4, 0.0]]),
            Ok(())
        );
        let rounded = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 1e-4], [0.0, 1.0, 0.0]];
        assert_eq!(polygon(&rounded), Ok(()));
    }

    #[test]
    fn mirrored_polygons_shine_to_the_mirrored_side() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y].to_vec();
        let light = Light {
            kind: LightKind::Area { shape: AreaShape::Polygon { corners } },
            ..Light::default()
        };
        // It shines along z: mirroring in x leaves that as it is, in z turns it round.
        for (scale, z) in
            [([1.0; 3], 1.0), ([-1.0, 1.0, 1.0], 1.0), ([1.0, 1.0, -1.0], -1.0), ([-1.0; 3], -1.0)]
        {
            let kind = light.transformed(&DMat4::from_scale(DVec3::from_array(scale))).kind;
            let LightKind::Area { shape: AreaShape::Polygon { corners } } = kind else {
                panic!("it is a polygon")
            };
            assert_eq!(
                (corners[1] - corners[0]).cross(corners[2] - corners[0]),
                DVec3::Z * z,
                "{scale:?}"
            );
        }
    }

    #[test]
    fn lights_that_cannot_shine_say_why() {
        let check = |kind: LightKind| Light { kind, ..Light::default() }.check();
        let spot = |direction, cutoff| {
            check(LightKind::Spot {
                position: DVec3::ZERO,
                direction,
                cutoff,
                inner: 0.0,
                exponent: 0.0,
            })
        };
        let direction = Err("direction: a direction of some length is required");
        assert_eq!(check(LightKind::Directional { direction: DVec3::ZERO }), direction);
        assert_eq!(spot(DVec3::ZERO, 0.5), direction);
        assert_eq!(spot(DVec3::Y, std::f64::consts::FRAC_PI_2), Ok(()));
        assert_eq!(spot(DVec3::Y, 1.571), Ok(()), "rounded");
        for cutoff in [0.0, -0.1, 1.6, f64::NAN] {
            assert!(spot(DVec3::Y, cutoff).is_err_and(|why| why.starts_with("cutoff")), "{cutoff}");
        }
        let disc = |normal, radius| {
            check(LightKind::Area {
                shape: AreaShape::Disc { center: dvec3(1.0, 2.0, 3.0), normal, radius },
            })
        };
        assert_eq!(disc(DVec3::Y, 0.0), Ok(()), "a point");
        assert!(disc(DVec3::Y, -1.0).is_err() && disc(DVec3::ZERO, 1.0).is_err());
        let cone = |inner, exponent| {
            check(LightKind::Spot {
                position: DVec3::ZERO,
                direction: DVec3::Y,
                cutoff: 0.5,
                inner,
                exponent,
            })
        };
        assert_eq!([cone(0.0, 0.0), cone(0.5, 9.0)], [Ok(()); 2]);
        assert!(
            [0.6, -0.1, f64::NAN]
                .iter()
                .all(|&inner| cone(inner, 0.0).is_err_and(|why| why.starts_with("inner")))
        );
        assert!(
            [-1.0, f64::NAN]
                .iter()
                .all(|&e| cone(0.0, e).is_err_and(|why| why.starts_with("exponent")))
        );
        let ranged =
            |range| Light { attenuation: Attenuation::Range { range }, ..Light::default() }.check();
        assert_eq!(
            (ranged(1.0), ranged(0.0)),
            (Ok(()), Err("attenuation: a range above 0 is required"))
        );
    }

    #[test]
    fn light_and_its_loss_are_not_negative() {
        let colored = |diffuse| Light { diffuse, ..Light::default() }.check().is_ok();
        assert!(colored([0.0, 3.0, 0.5]) && !colored([1.0, -0.1, 1.0]) && !colored([f32::NAN; 3]));
        let fading = |c1, c2, c3| {
            let (clamped, gl) = (
                Attenuation::Clamped { c1, c2, c3 },
                Attenuation::Gl { constant: c1, linear: c2, quadratic: c3 },
            );
            [clamped, gl]
                .map(|attenuation| Light { attenuation, ..Light::default() }.check().is_ok())
        };
        assert_eq!([fading(1.0, 0.0, 0.0), fading(0.0, 0.0, 2.0)], [[true; 2]; 2]);
        assert_eq!(
            [fading(1.0, -0.1, 0.0), fading(0.0, 0.0, 0.0), fading(f64::NAN, 1.0, 1.0)],
            [[false; 2]; 3]
        );
    }
}
