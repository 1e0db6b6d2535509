//! Exposure of photometric lights: files have them in candela and lux, often tens of thousands, and
//! a picture shows 0 to 1.
//!
//! Idea: a light meter held to the model. Some thousand points, spread evenly over its triangles,
//! tell the light that white Lambert surfaces get there. The mean of its logarithm, weighted by
//! area and by the square root of the light itself, is the reading: unlit parts have no weight, and
//! a spot next to a lamp has little. The reading is brought between 1/8 and 1/2; one that lies
//! there is left alone. Every step is continuous, so a lamp that moves a little changes the picture
//! a little.
//!
//! Only lights marked as photometric are scaled. All other light, ambient light included, is shown
//! by its numbers, and leaves the photometric lights that much less room. The reading depends on
//! scene and lights alone: pictures from all sides of a turntable agree.
//!
//! In:   instances and lights in world space. Occlusion is not considered.
//! Out:  the factor for the photometric lights.
//! Cost: linear in the points times the lights.
//! Source: points by the sequence of [Roberts 2018]; log-average metering is photographers'
//!         practice; the numbers are ours.

use crate::{Instance, World};
use vitral_light::{PreparedLight, Rgb};
use vitral_math::lanes::V3;
use vitral_math::{DMat4, DVec3, func};

/// Points at which light is measured.
pub(crate) const POINTS: u32 = 4096;
/// Readings between these need no exposure: half-lit white surfaces are a dark grey, or the best
/// lit ones are just white.
const SHOWN: [f64; 2] = [0.125, 0.5];
/// Multiples of these, less their whole parts, fill a square evenly: the inverses of the root of
/// `x³ = x + 1` and of its square.
const SPREAD: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];
/// Shares of red, green and blue in the brightness of linear colours ([sRGB]).
pub(crate) const BRIGHTNESS: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// Light on the surfaces of a world, measured once and good for any ambient light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LightMeter {
    /// Reading of the photometric lights alone; 0 where they reach nothing.
    photometric: f64,
    /// Reading of all other lights.
    other: f64,
}

impl LightMeter {
    /// Measures the lights of a world.
    pub fn read(world: &World) -> Self {
        // Most scenes have no photometric lights, and then nothing is to be measured.
        if !world.lights.iter().any(|light| light.photometric) {
            return Self::default();
        }
        Self { photometric: reading(world, true), other: reading(world, false) }
    }

    /// The factor for the photometric lights under `ambient` light; 1 without such lights, or where
    /// they reach nothing.
    pub fn exposure(&self, ambient: Rgb) -> f32 {
        if self.photometric <= 0.0 {
            return 1.0;
        }
        let other = self.other + (0..3).map(|k| f64::from(BRIGHTNESS[k] * ambient[k])).sum::<f64>();
        // Other light leaves less room, but never less than the dark end: lights that are there
        // must be seen.
        let least = (SHOWN[0] - other).max(0.0);
        let most = (SHOWN[1] - other).max(SHOWN[0]);
        let factor = self.photometric.clamp(least, most) / self.photometric;
        factor.clamp(f64::from(f32::MIN_POSITIVE), f64::from(f32::MAX)) as f32
    }
}

/// The reading of the lights that are photometric, or of those that are not.
fn reading(world: &World, photometric: bool) -> f64 {
    let chosen = world.lights.iter().filter(|light| light.photometric == photometric);
    let lights: Vec<_> =
        chosen.filter_map(|light| PreparedLight::new(light, &DMat4::IDENTITY)).collect();
    if lights.is_empty() || world.facet_count == 0 {
        return 0.0;
    }
    let [mut weights, mut sum] = [0.0; 2];
    for number in 0..POINTS {
        let facet = (u64::from(number) * u64::from(world.facet_count) / u64::from(POINTS)) as u32;
        let instance = &world.instances[world.instance_of_facet(facet)];
        let Some((point, normal, area)) =
            surface_point(instance, facet - instance.first_facet, number)
        else {
            continue;
        };
        let light: f64 =
            lights.iter().map(|light| f64::from(brightness(light, point, normal))).sum();
        if light.is_finite() && light > 0.0 {
            let weight = area * light.sqrt();
            weights += weight;
            sum += weight * func::ln(light);
        }
    }
    if weights > 0.0 { func::exp(sum / weights) } else { 0.0 }
}

/// A point in an instance's triangle with the unit normal there and the triangle's area, world
/// space; none if it has no area.
pub(crate) fn surface_point(
    instance: &Instance,
    triangle: u32,
    number: u32,
) -> Option<(DVec3, DVec3, f64)> {
    let [a, b, c] = instance.corners(triangle);
    let twice = (b - a).cross(c - a);
    let area = twice.length();
    let normal = twice.try_normalize().filter(|_| area.is_finite())?;
    let [mut u, mut v] = SPREAD.map(|step| (f64::from(number) * step).fract());
    if u + v > 1.0 {
        [u, v] = [1.0 - u, 1.0 - v];
    }
    Some((a + (b - a) * u + (c - a) * v, normal, area))
}

/// What a white Lambert surface gets from a light, on the side that faces it: files wind triangles
/// either way.
fn brightness(light: &PreparedLight, point: DVec3, normal: DVec3) -> f32 {
    let [x, y, z] = point.as_vec3().to_array();
    let [nx, ny, nz] = normal.as_vec3().to_array();
    let (point, n) = (V3::new(x, y, z), V3::new(nx, ny, nz));
    let incident = light.incident(point);
    let facing = n.dot(incident.l);
    let n = if facing < 0.0 { n.scale(-1.0) } else { n };
    let arriving = light.irradiance(point, n).unwrap_or(incident.intensity * facing.abs());
    (0..3).map(|k| BRIGHTNESS[k] * light.diffuse[k]).sum::<f32>() * arriving
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Scene, builtin, lab};
    use vitral_light::{Attenuation, Light, LightKind};

    const DARK: Rgb = [0.0; 3];

    fn world(name: &str, lights: Vec<Light>) -> World {
        let mut scene: Scene = builtin::scene(name).unwrap();
        scene.lights = lights;
        scene.nodes.iter_mut().for_each(|node| node.light = None);
        World::new(&scene).unwrap()
    }

    fn sun(lux: f32) -> Light {
        let kind = LightKind::Directional { direction: DVec3::new(-1.0, -2.0, -3.0) };
        Light { kind, diffuse: [lux; 3], specular: [lux; 3], photometric: true, ..Light::default() }
    }

    fn lamp(candela: f32, position: DVec3) -> Light {
        Light {
            kind: LightKind::Point { position },
            attenuation: Attenuation::InverseSquare,
            ..sun(candela)
        }
    }

    fn exposure(lights: Vec<Light>, ambient: Rgb) -> f32 {
        LightMeter::read(&world("teapot", lights)).exposure(ambient)
    }

    #[test]
    fn daylight_and_starlight_are_brought_to_what_pictures_show() {
        for lux in [1e-6, 0.01, 3.0, 400.0, 30_000.0, 1e9] {
            let factor = exposure(vec![sun(lux)], DARK);
            let shown = reading(&world("teapot", vec![sun(lux * factor)]), true);
            let end = if lux < 1.0 { SHOWN[0] } else { SHOWN[1] };
            assert!((shown / end - 1.0).abs() < 1e-4, "{lux} lux: {factor}, {shown}");
        }
        let center = world("teapot", Vec::new()).bounds.center();
        let inside = exposure(vec![lamp(54_000.0, center)], DARK);
        let far = exposure(vec![lamp(54_000.0, center + DVec3::X * 100.0)], DARK);
        assert!(inside < 1e-3 && far > 100.0 * inside, "{inside} {far}");
    }

    #[test]
    fn a_small_step_of_a_lamp_or_its_strength_is_a_small_step_of_exposure() {
        let bounds = world("teapot", Vec::new()).bounds;
        let size = bounds.max - bounds.min;
        let walk = |i: u32| {
            let position = bounds.center() + DVec3::X * size.length() * (1.0 + 0.01 * f64::from(i));
            exposure(vec![lamp(100.0, position)], DARK)
        };
        let strengthen =
            |i: u32| exposure(vec![sun((0..i).fold(0.05, |strength, _| strength * 1.02))], DARK);
        let brighten = |i: u32| exposure(vec![sun(30.0)], [i as f32 * 0.005; 3]);
        for step in [&walk as &dyn Fn(u32) -> f32, &strengthen, &brighten] {
            let factors: Vec<f32> = (0..300).map(step).collect();
            for pair in factors.windows(2) {
                // The largest step is that of the ambient light, 0.005 of 0.125.
                assert!((pair[1] / pair[0] - 1.0).abs() < 0.042, "{pair:?}");
            }
            assert!(factors[0] != factors[299], "the exposure followed");
        }
    }

    #[test]
    fn a_cone_that_slides_off_the_model_does_not_make_the_exposure_jump() {
        let bounds = world("teapot", Vec::new()).bounds;
        let reach = (bounds.max - bounds.min).length();
        let slide = |i: u32| {
            let position =
                bounds.center() + DVec3::new(reach * 0.002 * f64::from(i), 0.0, reach * 2.0);
            let kind = LightKind::Spot {
                position,
                direction: DVec3::NEG_Z,
                cutoff: 0.1,
                inner: 0.0,
                exponent: 0.0,
            };
            exposure(vec![Light { kind, ..sun(1e5) }], DARK)
        };
        let factors: Vec<f32> = (0..200).map(slide).collect();
        assert!(factors.windows(2).all(|p| (p[1] / p[0] - 1.0).abs() < 0.3), "{factors:?}");
    }

    #[test]
    fn ambient_and_other_light_leaves_less_room() {
        let alone = exposure(vec![sun(1e4)], DARK);
        let half = exposure(vec![sun(1e4)], [0.25; 3]);
        let bright = exposure(vec![sun(1e4)], [7.0; 3]);
        assert!(
            (half / alone - 0.5).abs() < 1e-3 && (bright / alone - 0.25).abs() < 1e-3,
            "{alone} {half} {bright}"
        );
        // Faint lights beside enough other light stay faint.
        assert_eq!(exposure(vec![sun(1e-3)], [0.3; 3]), 1.0);
        let other = Light { photometric: false, ..sun(0.3) };
        assert!(exposure(vec![sun(1e4), other], DARK) < alone);
    }

    #[test]
    fn only_photometric_lights_are_exposed() {
        for intensity in [1e-9, 0.1, 1.0, 1e9] {
            assert_eq!(exposure(vec![Light { photometric: false, ..sun(intensity) }], DARK), 1.0);
        }
        assert_eq!(exposure(lab::lights(), DARK), 1.0);
        for &(name, _) in builtin::names() {
            let world = World::new(&builtin::scene(name).unwrap()).unwrap();
            assert_eq!(LightMeter::read(&world).exposure(DARK), 1.0, "builtin:{name}");
        }
    }

    #[test]
    fn lights_that_reach_nothing_are_not_exposed() {
        let off = Light { enabled: false, ..sun(1e5) };
        let (position, direction) = (DVec3::X * 50.0, DVec3::X);
        let kind = LightKind::Spot { position, direction, cutoff: 0.3, inner: 0.0, exponent: 0.0 };
        for lights in [vec![], vec![off], vec![Light { kind, ..sun(1e5) }]] {
            assert_eq!(exposure(lights, DARK), 1.0);
        }
        let mut empty = world("teapot", vec![sun(1e5)]);
        empty.instances.clear();
        empty.facet_count = 0;
        assert_eq!(LightMeter::read(&empty).exposure(DARK), 1.0);
    }
}
