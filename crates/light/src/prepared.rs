//! A light made ready for a pass: in the space of shading, in `f32`, with everything constant
//! computed.
//!
//! In:   a [`Light`] in world space, and the transform to the space in which surfaces are
//!       illuminated.
//! Out:  for a point, the unit direction towards the light and how much of the light arrives there.
//! Cost: one square root and two divisions a point; a spot with an exponent adds a power.
//! Source: course notes, part P (light types, attenuation); [OpenGL 2.1], section 2.14 (spot
//!         exponent, GL attenuation); KHR_lights_punctual (smooth edge of a spot, range). Departs
//!         from them: an area light shines like a Lambert surface, and not to the back. Where one
//!         direction towards it is asked for, it counts as one sample at its centroid, weighted
//!         with the cosine of emission; what a diffuse surface gets is that of the whole shape
//!         ([`PreparedLight::irradiance`]).

use crate::area::Shape;
use crate::{Attenuation, Light, LightKind, Rgb};
use vitral_math::lanes::{Lanes, V3};
use vitral_math::{DMat4, DVec3, func};

/// Positions and distances beyond this do not take part in lighting: their squares must stay
/// finite.
const FARTHEST: f32 = 1e18;
/// A light is in the very place of a point if it is nearer than this part of the point's distance
/// from the origin, squared: four steps of single precision. What lies between is rounding, which
/// has no direction.
const SAME_PLACE2: f32 = 1.0 / (1u64 << 42) as f32;
/// What is left of the rounding of places and normals, each a few times `2^-24`, in a cosine.
pub const DIRECTION_ROUNDING: f32 = 1.0 / (1u32 << 20) as f32;
/// Square of the least distance that the inverse square laws tell apart from zero.
const LEAST_DISTANCE2: f64 = 1e-18;
/// Brightest intensity of a channel.
const BRIGHTEST: f32 = 1e12;

/// What arrives at a point from one light.
#[derive(Clone, Copy, Debug)]
pub struct Incident<T> {
    /// Unit vector towards the light; zero for ambient light, and where the point is the light's
    /// own position.
    pub l: V3<T>,
    /// Attenuation times spot factor (times cosine of emission of an area light, 0 behind it). To
    /// be multiplied with the light's diffuse and specular colours. 0 for ambient light.
    pub intensity: T,
    /// The same for the light's ambient colour: like `intensity`, as OpenGL attenuates it; 1 for
    /// ambient light.
    pub ambient_intensity: T,
}

/// The factors behind an [`Incident`] at one point: their product is its intensity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// How far away the light is, where it has a place.
    pub distance: Option<f32>,
    /// What the distance leaves of the light.
    pub attenuation: f32,
    /// The share that a spot sends in this direction.
    pub spot: Option<f32>,
    /// The cosine of emission of an area light, 0 behind it.
    pub emission: Option<f32>,
}

/// A light, ready to illuminate points.
#[derive(Clone, Debug, PartialEq)]
pub struct PreparedLight {
    /// Intensity for the ambient coefficient.
    pub ambient: Rgb,
    /// Intensity for the diffuse coefficient.
    pub diffuse: Rgb,
    /// Intensity for the specular coefficient.
    pub specular: Rgb,
    source: Source,
    falloff: Falloff,
}

/// Where the light comes from.
#[derive(Clone, Debug, PartialEq)]
enum Source {
    Everywhere,
    /// Unit vector towards the light.
    Infinity([f32; 3]),
    Point([f32; 3]),
    Spot {
        position: [f32; 3],
        axis: [f32; 3],
        cone: Cone,
    },
    Area(Shape),
}

/// How a spot's intensity depends on the cosine of the angle to its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cone {
    cos_cutoff: f32,
    /// `1 / (cos inner - cos cutoff)`, 0 for a hard edge.
    softness: f32,
    exponent: f32,
}

/// Every attenuation as one formula: `window / max(constant + linear d + quadratic d², least)`,
/// where `window = max(1 - (d²/range²)², 0)`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Falloff {
    constant: f32,
    linear: f32,
    quadratic: f32,
    least: f32,
    inverse_range2: f32,
}

impl PreparedLight {
    /// The light in the space "here". `here_from_world` should keep lengths (a rigid motion, as the
    /// view transform is), since attenuation is a function of the distance there.
    ///
    /// `None` if the light is switched off or cannot shine: a direction of length 0, a polygon
    /// without area, a range of 0, a coordinate that is not finite or beyond 1e18. Components of a
    /// colour that are not finite count as 0.
    pub fn new(light: &Light, here_from_world: &DMat4) -> Option<Self> {
        if !light.enabled {
            return None;
        }
        let light = light.transformed(here_from_world);
        let source = match &light.kind {
            LightKind::Ambient => Source::Everywhere,
            LightKind::Directional { direction } => Source::Infinity(unit(-*direction)?),
            LightKind::Point { position } => Source::Point(place(*position)?),
            &LightKind::Spot { position, direction, cutoff, inner, exponent } => {
                let cone = Cone::new(cutoff, inner, exponent)?;
                Source::Spot { position: place(position)?, axis: unit(direction)?, cone }
            }
            LightKind::Area { shape } => Source::Area(Shape::new(shape, f64::from(FARTHEST))?),
        };
        let falloff = Falloff::new(light.attenuation)?;
        let [ambient, diffuse, specular] =
            [light.ambient, light.diffuse, light.specular].map(finite);
        Some(Self { ambient, diffuse, specular, source, falloff })
    }

    /// What arrives at `position` if nothing is in between.
    #[inline(always)]
    pub fn incident<T: Lanes>(&self, position: V3<T>) -> Incident<T> {
        let one = position.x.splat(1.0);
        let zero = position.x.splat(0.0);
        match &self.source {
            Source::Everywhere => {
                Incident { l: V3::new(zero, zero, zero), intensity: zero, ambient_intensity: one }
            }
            Source::Infinity(towards) => {
                Incident { l: V3::splat(zero, *towards), intensity: one, ambient_intensity: one }
            }
            Source::Point(at) => {
                let (l, attenuation) = self.arrive(position, *at);
                Incident { l, intensity: attenuation, ambient_intensity: attenuation }
            }
            Source::Spot { position: at, axis, cone } => {
                let (l, attenuation) = self.arrive(position, *at);
                let intensity = attenuation * cone.factor(-l.dot(V3::splat(zero, *axis)));
                Incident { l, intensity, ambient_intensity: intensity }
            }
            Source::Area(shape) => {
                let (l, attenuation) = self.arrive(position, shape.centroid);
                let intensity = attenuation * (-l.dot(V3::splat(zero, shape.normal))).positive();
                Incident { l, intensity, ambient_intensity: intensity }
            }
        }
    }

    /// The factors of what arrives at `position`, as [`Self::incident`] multiplies them.
    pub fn arrival(&self, position: V3<f32>) -> Arrival {
        let everywhere = Arrival { distance: None, attenuation: 1.0, spot: None, emission: None };
        let at = match &self.source {
            Source::Everywhere | Source::Infinity(_) => return everywhere,
            Source::Point(at) | Source::Spot { position: at, .. } => *at,
            Source::Area(shape) => shape.centroid,
        };
        let to = V3::splat(position.x, at) - position;
        let (l, attenuation) = self.arrive(position, at);
        let cosine = |axis: [f32; 3]| -l.dot(V3::splat(position.x, axis));
        let arrival = Arrival { distance: Some(to.dot(to).sqrt()), attenuation, ..everywhere };
        match &self.source {
            Source::Spot { axis, cone, .. } => {
                Arrival { spot: Some(cone.factor(cosine(*axis))), ..arrival }
            }
            Source::Area(shape) => {
                Arrival { emission: Some(cosine(shape.normal).positive()), ..arrival }
            }
            _ => arrival,
        }
    }

    /// How wrong the direction from `position` to the light may be, and with it a cosine: what
    /// rounding does to both places.
    #[inline(always)]
    pub fn direction_rounding<T: Lanes>(&self, position: V3<T>) -> T {
        let constant = position.x.splat(DIRECTION_ROUNDING);
        let at = match &self.source {
            Source::Everywhere => return position.x.splat(0.0),
            Source::Infinity(_) => return constant,
            Source::Point(at) | Source::Spot { position: at, .. } => *at,
            Source::Area(shape) => shape.centroid,
        };
        constant.outlined(
            #[inline(always)]
            || {
                let at = V3::splat(position.x, at);
                let distance = (at - position)
                    .dot(at - position)
                    .sqrt()
                    .max(position.x.splat(f32::MIN_POSITIVE));
                ((position.dot(position).sqrt() + at.dot(at).sqrt()) / distance + 1.0) * constant
            },
        )
    }

    /// What a diffuse surface with unit normal `n` at `position` gets of an area light if nothing
    /// is in between, where a point would give `intensity * N·L`: the integral over the shape that
    /// is above the surface's horizon. `None` for other lights.
    ///
    /// Exact for attenuation by the inverse square. Other laws are no part of the integral: they
    /// multiply it by what they make of the inverse square at the mean distance from the shape, the
    /// square root of the mean of `d²`.
    #[inline(always)]
    pub fn irradiance<T: Lanes>(&self, position: V3<T>, n: V3<T>) -> Option<T> {
        let Source::Area(shape) = &self.source else { return None };
        let to = V3::splat(position.x, shape.centroid) - position;
        let limit = position.x.splat(FARTHEST * FARTHEST);
        let square = (to.dot(to) + shape.spread).min(limit);
        let law = self.falloff.attenuation(square.sqrt(), square) * square;
        Some(
            (shape.mean(position, n) * law).positive().min(position.x.splat(BRIGHTEST * BRIGHTEST)),
        )
    }

    /// Whether it is an area light.
    pub fn has_area(&self) -> bool {
        matches!(self.source, Source::Area(_))
    }

    /// Unit direction from `position` to the light at `at`, and the attenuation over that distance.
    #[inline(always)]
    fn arrive<T: Lanes>(&self, position: V3<T>, at: [f32; 3]) -> (V3<T>, T) {
        let to = V3::splat(position.x, at) - position;
        let square = to.dot(to);
        let (zero, limit) = (square.splat(0.0), square.splat(FARTHEST * FARTHEST));
        let rounding = position.dot(position) * SAME_PLACE2;
        let reachable = rounding.lt(square) & square.le(limit);
        let square = square.min(limit);
        let distance = square.sqrt();
        let inverse = T::select(reachable, square.splat(1.0) / distance, zero);
        (to.scale(inverse), self.falloff.attenuation(distance, square))
    }
}

impl Falloff {
    fn new(attenuation: Attenuation) -> Option<Self> {
        let form = |constant: f64, linear: f64, quadratic: f64, least: f64, inverse_range2: f64| {
            let values =
                [constant, linear, quadratic, least, inverse_range2].map(|value| value as f32);
            let [constant, linear, quadratic, least, inverse_range2] = values;
            let sound = values.iter().all(|value| value.is_finite());
            sound.then_some(Self { constant, linear, quadratic, least, inverse_range2 })
        };
        match attenuation {
            Attenuation::None => form(1.0, 0.0, 0.0, 1.0, 0.0),
            Attenuation::InverseSquare => form(0.0, 0.0, 1.0, LEAST_DISTANCE2, 0.0),
            // min(1/x, 1) is 1/max(x, 1).
            Attenuation::Clamped { c1, c2, c3 } => form(c1, c2, c3, 1.0, 0.0),
            Attenuation::Gl { constant, linear, quadratic } => {
                form(constant, linear, quadratic, LEAST_DISTANCE2, 0.0)
            }
            Attenuation::Range { range } if range > 0.0 => {
                form(0.0, 0.0, 1.0, LEAST_DISTANCE2, 1.0 / (range * range))
            }
            Attenuation::Range { .. } => None,
        }
    }

    #[inline(always)]
    fn attenuation<T: Lanes>(&self, distance: T, square: T) -> T {
        let loss = square * self.quadratic + distance * self.linear + self.constant;
        let ratio = square * self.inverse_range2;
        let window = (-(ratio * ratio) + 1.0).positive();
        window / loss.max(loss.splat(self.least))
    }
}

impl Cone {
    fn new(cutoff: f64, inner: f64, exponent: f64) -> Option<Self> {
        if !(cutoff.is_finite() && inner.is_finite() && exponent.is_finite()) {
            return None;
        }
        let cos_cutoff = func::cos(cutoff.clamp(0.0, std::f64::consts::FRAC_PI_2));
        let cos_inner = func::cos(inner.clamp(0.0, std::f64::consts::FRAC_PI_2));
        let width = (cos_inner - cos_cutoff) as f32;
        let softness = if width > 1e-6 { 1.0 / width } else { 0.0 };
        Some(Self { cos_cutoff: cos_cutoff as f32, softness, exponent: exponent.max(0.0) as f32 })
    }

    /// The share of intensity in a direction at this cosine to the axis.
    #[inline(always)]
    fn factor<T: Lanes>(&self, cos: T) -> T {
        let (zero, one) = (cos.splat(0.0), cos.splat(1.0));
        let above = cos - self.cos_cutoff;

        // Fade from the inner cone to the edge, with the square of the ramp that
        // KHR_lights_punctual proposes.
        let mut factor = if self.softness > 0.0 {
            let ramp = (above * self.softness).saturate();
            ramp * ramp
        } else {
            T::select(zero.le(above), one, zero)
        };
        if self.exponent > 0.0 {
            factor = factor * cos.saturate().pow(cos.splat(self.exponent));
        }
        factor
    }
}

/// A position that lighting can compute with.
fn place(position: DVec3) -> Option<[f32; 3]> {
    (position.abs().max_element() <= f64::from(FARTHEST)).then(|| position.as_vec3().to_array())
}

/// Unit vector, if there is one.
fn unit(direction: DVec3) -> Option<[f32; 3]> {
    direction.try_normalize().map(|unit| unit.as_vec3().to_array())
}

fn finite(color: Rgb) -> Rgb {
    color
        .map(|channel| if channel.is_finite() { channel.clamp(-BRIGHTEST, BRIGHTEST) } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::AreaShape;
    use vitral_math::dvec3;

    fn light(kind: LightKind, attenuation: Attenuation) -> Light {
        Light { kind, attenuation, ..Light::default() }
    }

    /// What a light at the origin sends to a point at distance `d` along -z.
    fn loss(attenuation: Attenuation, d: f32) -> f32 {
        let light = light(LightKind::Point { position: DVec3::ZERO }, attenuation);
        PreparedLight::new(&light, &DMat4::IDENTITY)
            .unwrap()
            .incident(V3::new(0.0, 0.0, -d))
            .intensity
    }

    #[test]
    fn directions_to_near_lights_are_rounded_the_most() {
        let light =
            |kind| PreparedLight::new(&light(kind, Attenuation::None), &DMat4::IDENTITY).unwrap();
        let lamp = light(LightKind::Point { position: dvec3(0.3, 5.0, 0.2) });
        // Places of a plane that the lamp lies in, turned so that no coordinate is exact.
        let mut seen = 0;
        for i in 0..1000u16 {
            let (a, b) = (f32::from(i % 40) * 0.1 - 2.0, f32::from(i / 40) * 0.1 - 1.0);
            let (u, n) = (V3::new(0.6f32, 0.48, 0.64), V3::new(0.0f32, 0.8, -0.6));
            let v = V3::new(-0.8f32, 0.36, 0.48);
            let p = V3::new(0.3f32, 5.0, 0.2) + u.scale(a) + v.scale(b);
            let cosine = n.dot(lamp.incident(p).l);
            assert!(cosine.abs() <= lamp.direction_rounding(p), "{a} {b}: {cosine}");
            seen += u32::from(cosine != 0.0);
        }
        assert!(seen > 100, "{seen} are rounded");
        let near = lamp.direction_rounding(V3::new(0.3, 5.0, 0.21));
        let sun = light(LightKind::Directional { direction: DVec3::X });
        assert!(
            near > 100.0 * sun.direction_rounding(V3::new(0.3, 5.0, 0.21)) && near < 0.01,
            "{near}"
        );
    }

    #[test]
    fn p40_attenuation_has_exact_values() {
        assert_eq!(loss(Attenuation::None, 1e6), 1.0);
        assert_eq!(loss(Attenuation::InverseSquare, 2.0), 0.25);
        assert_eq!(loss(Attenuation::InverseSquare, 0.5), 4.0);
        assert_eq!(loss(Attenuation::Clamped { c1: 1.0, c2: 0.0, c3: 1.0 }, 2.0), 0.2);
        assert_eq!(loss(Attenuation::Clamped { c1: 0.1, c2: 0.0, c3: 0.0 }, 2.0), 1.0);
        assert_eq!(loss(Attenuation::Clamped { c1: 0.0, c2: 0.5, c3: 0.0 }, 4.0), 0.5);
    }

    #[test]
    fn e16_opengl_does_not_clamp_and_the_physical_law_is_one_over_d_squared() {
        assert_eq!(loss(Attenuation::Gl { constant: 0.1, linear: 0.0, quadratic: 0.0 }, 2.0), 10.0);
        assert_eq!(
            loss(Attenuation::Gl { constant: 1.0, linear: 0.5, quadratic: 0.25 }, 2.0),
            1.0 / 3.0
        );
        assert_eq!(
            loss(Attenuation::InverseSquare, 3.0) / loss(Attenuation::InverseSquare, 6.0),
            4.0
        );
    }

    #[test]
    fn a_range_ends_the_light() {
        let range = Attenuation::Range { range: 4.0 };
        assert_eq!((loss(range, 4.0), loss(range, 5.0)), (0.0, 0.0));
        assert_eq!(loss(range, 2.0), (1.0 - 1.0 / 16.0) / 4.0);
    }

    #[test]
    fn p40_the_light_itself_is_a_defined_place() {
        for attenuation in
            [Attenuation::None, Attenuation::InverseSquare, Attenuation::Range { range: 1.0 }]
        {
            let light = light(LightKind::Point { position: DVec3::ZERO }, attenuation);
            let here = PreparedLight::new(&light, &DMat4::IDENTITY)
                .unwrap()
                .incident(V3::splat(0.0f32, [0.0; 3]));
            assert!(
                here.intensity.is_finite() && (here.l.x, here.l.y, here.l.z) == (0.0, 0.0, 0.0)
            );
        }
    }

    #[test]
    fn p40_rounding_gives_the_light_in_a_lit_point_no_direction() {
        let at = dvec3(0.1, 7.3, -2.9);
        let spot = LightKind::Spot {
            position: at,
            direction: DVec3::X,
            cutoff: 0.5,
            inner: 0.5,
            exponent: 2.0,
        };
        for kind in [LightKind::Point { position: at }, spot] {
            for attenuation in
                [Attenuation::None, Attenuation::InverseSquare, Attenuation::Range { range: 1.0 }]
            {
                let light = PreparedLight::new(&light(kind.clone(), attenuation), &DMat4::IDENTITY)
                    .unwrap();
                let [x, y, z] = at.as_vec3().to_array();
                // The place itself, and what a step of single precision makes of it.
                for p in
                    [[x, y, z], [x, y.next_up(), z], [x.next_down(), y.next_down(), z.next_up()]]
                {
                    let here = light.incident(V3::splat(0.0f32, p));
                    assert_eq!((here.l.x, here.l.y, here.l.z), (0.0, 0.0, 0.0), "{p:?}");
                    assert!(
                        here.intensity.is_finite() && here.ambient_intensity.is_finite(),
                        "{here:?}"
                    );
                }
                let beside = light.incident(V3::splat(0.0f32, [x - 1e-3, y, z]));
                assert!((beside.l.x - 1.0).abs() < 1e-3, "{beside:?}");
            }
        }
    }

    #[test]
    fn p32_a_directional_light_is_constant_and_ambient_light_has_no_direction() {
        let sun = light(
            LightKind::Directional { direction: dvec3(0.0, -2.0, 0.0) },
            Attenuation::InverseSquare,
        );
        let sun = PreparedLight::new(&sun, &DMat4::IDENTITY).unwrap();
        for p in [[0.0f32, 0.0, 0.0], [5.0, -3.0, 1e6]] {
            let i = sun.incident(V3::splat(0.0f32, p));
            assert_eq!((i.l.x, i.l.y, i.l.z, i.intensity), (0.0, 1.0, 0.0, 1.0));
        }
        let sky =
            PreparedLight::new(&light(LightKind::Ambient, Attenuation::None), &DMat4::IDENTITY)
                .unwrap();
        let i = sky.incident(V3::splat(0.0f32, [1.0; 3]));
        assert_eq!((i.intensity, i.ambient_intensity), (0.0, 1.0));
    }

    /// Intensity of a spot at the origin along -z, in a direction `degrees` off its axis.
    fn spot(cutoff: f64, inner: f64, exponent: f64, degrees: f64) -> f32 {
        let kind = LightKind::Spot {
            position: DVec3::ZERO,
            direction: dvec3(0.0, 0.0, -3.0),
            cutoff: cutoff.to_radians(),
            inner: inner.to_radians(),
            exponent,
        };
        let (sin, cos) = func::sin_cos(degrees.to_radians());
        let at = dvec3(sin * 7.0, 0.0, -cos * 7.0).as_vec3().to_array();
        let light = PreparedLight::new(&light(kind, Attenuation::None), &DMat4::IDENTITY).unwrap();
        light.incident(V3::splat(0.0f32, at)).intensity
    }

    #[test]
    fn p32_a_spot_shines_inside_its_cone_only() {
        assert_eq!((spot(30.0, 30.0, 0.0, 29.9), spot(30.0, 30.0, 0.0, 30.1)), (1.0, 0.0));
        assert_eq!(spot(90.0, 90.0, 0.0, 170.0), 0.0);
        assert_eq!((spot(30.0, 10.0, 0.0, 9.9), spot(30.0, 10.0, 0.0, 30.1)), (1.0, 0.0));
        assert_eq!(
            (spot(60.0, 60.0, 5.0, 60.1), spot(60.0, 0.0, 5.0, 75.0)),
            (0.0, 0.0),
            "with an exponent, too"
        );
        assert_eq!(spot(30.0, 10.0, 0.0, 150.0), 0.0, "behind");
        // Between the cones: the square of the ramp between their cosines, whose middle is a
        // quarter; no linear ramp.
        let cos = |degrees: f64| func::cos(degrees.to_radians());
        for degrees in [11.0, 15.0, 20.0, 22.5, 25.0, 29.0] {
            let ramp = (cos(degrees) - cos(30.0)) / (cos(10.0) - cos(30.0));
            let found = f64::from(spot(30.0, 10.0, 0.0, degrees));
            assert!((found - ramp * ramp).abs() < 1e-5, "{degrees}: {found}, not {}", ramp * ramp);
        }
        let middle = func::acos((cos(10.0) + cos(30.0)) / 2.0).to_degrees();
        assert!((spot(30.0, 10.0, 0.0, middle) - 0.25).abs() < 1e-5);
    }

    #[test]
    fn e9_the_spot_exponent_is_a_power_of_the_cosine() {
        assert!((spot(90.0, 90.0, 2.0, 60.0) - 0.25).abs() < 1e-6);
        assert!((spot(90.0, 90.0, 10.0, 30.0) - 0.237_304_7).abs() < 1e-6);
        // With an inner cone it multiplies the ramp, also within that cone.
        let ramp = spot(60.0, 20.0, 0.0, 40.0);
        assert!(
            (spot(60.0, 20.0, 3.0, 40.0)
                - ramp * func::pow(func::cos(40f64.to_radians()), 3.0) as f32)
                .abs()
                < 1e-6
        );
        assert!(
            (spot(60.0, 20.0, 3.0, 15.0) - func::pow(func::cos(15f64.to_radians()), 3.0) as f32)
                .abs()
                < 1e-6
        );
    }

    #[test]
    fn p32_an_area_light_shines_to_its_front_with_the_cosine_of_emission() {
        let square = [[-1., -1.], [1., -1.], [1., 1.], [-1., 1.]]
            .map(|[x, y]| dvec3(x + 3.0, y, 2.0))
            .to_vec();
        let disc = AreaShape::Disc {
            center: dvec3(3.0, 0.0, 2.0),
            normal: dvec3(0.0, 0.0, 5.0),
            radius: 1.0,
        };
        for shape in [AreaShape::Polygon { corners: square }, disc] {
            let lamp = light(LightKind::Area { shape }, Attenuation::None);
            let lamp = PreparedLight::new(&lamp, &DMat4::IDENTITY).unwrap();
            let at = |p: [f32; 3]| lamp.incident(V3::splat(0.0f32, p)).intensity;
            assert!((at([3.0, 0.0, 9.0]) - 1.0).abs() < 1e-6, "straight ahead");
            assert!(
                (at([3.0 + 2.0 * 3.0f32.sqrt(), 0.0, 4.0]) - 0.5).abs() < 1e-6,
                "60 degrees off"
            );
            assert_eq!(at([3.0, 0.0, 1.0]), 0.0, "behind");
        }
    }

    #[test]
    fn lights_move_with_the_view() {
        let lamp = light(LightKind::Point { position: dvec3(1.0, 2.0, 3.0) }, Attenuation::None);
        let view = DMat4::from_translation(dvec3(-1.0, -2.0, 0.0));
        let i = PreparedLight::new(&lamp, &view).unwrap().incident(V3::splat(0.0f32, [0.0; 3]));
        assert_eq!((i.l.x, i.l.y, i.l.z), (0.0, 0.0, 1.0));
    }

    #[test]
    fn lights_that_cannot_shine_are_left_out() {
        let point = |position| LightKind::Point { position };
        let spot = |cutoff| LightKind::Spot {
            position: DVec3::ZERO,
            direction: DVec3::X,
            cutoff,
            inner: 0.0,
            exponent: 0.0,
        };
        let flat = |corners| LightKind::Area { shape: AreaShape::Polygon { corners } };
        for kind in [
            LightKind::Directional { direction: DVec3::ZERO },
            LightKind::Directional { direction: DVec3::NAN },
            point(dvec3(f64::INFINITY, 0.0, 0.0)),
            point(dvec3(0.0, 1e19, 0.0)),
            spot(f64::NAN),
            flat(vec![]),
            flat(vec![DVec3::ZERO, DVec3::X, DVec3::X * 2.0]),
        ] {
            assert_eq!(PreparedLight::new(&light(kind, Attenuation::None), &DMat4::IDENTITY), None);
        }
        let ended = light(point(DVec3::ZERO), Attenuation::Range { range: 0.0 });
        assert_eq!(PreparedLight::new(&ended, &DMat4::IDENTITY), None);
        let off = Light { enabled: false, ..Light::default() };
        assert_eq!(PreparedLight::new(&off, &DMat4::IDENTITY), None);
        let odd = Light { diffuse: [f32::NAN, f32::INFINITY, 0.5], ..Light::default() };
        assert_eq!(PreparedLight::new(&odd, &DMat4::IDENTITY).unwrap().diffuse, [0.0, 0.0, 0.5]);
    }
}
