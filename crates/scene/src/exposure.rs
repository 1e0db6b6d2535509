//! How far a scene's own lights are dimmed for a picture: files have them in candela and lux, often tens of thousands, and a
//! picture shows 0 to 1.
//!
//! Idea: a light meter held to the model. Some thousand places, spread evenly over its triangles, tell what Lambert surfaces
//! get there; the light that nine tenths of the surface do not exceed is brought between 1/2 and 1. That is a power of two, as
//! cameras count stops, and it depends on scene and lights alone: pictures from all sides of a turntable agree. Lights that a
//! picture shows well enough are left as they are.
//!
//! In:   instances and lights in world space. What lies between them is not looked at.
//! Out:  the factor for all lights.
//! Cost: linear in the places times the lights.
//! Source: places by the sequence of [Roberts 2018]; exposure by a percentile is photographers' practice; the numbers are ours.

use crate::{Instance, World};
use vitral_light::PreparedLight;
use vitral_math::lanes::V3;
use vitral_math::{DMat4, DVec3};

/// Places at which light is measured.
const PLACES: u32 = 4096;
/// The part of the surface that gets no more light than what counts.
const PART: f64 = 0.9;
/// Lights whose measure lies between these are left as they are: a white surface is a dark grey, or much of it is white.
const SHOWN: [f32; 2] = [1.0 / 16.0, 2.0];
/// Multiples of these, less their whole parts, fill a square evenly: the inverses of the root of `x³ = x + 1` and of its square.
const SPREAD: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];
/// Shares of red, green and blue in the brightness of linear colours ([sRGB]).
const BRIGHTNESS: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// What to multiply the lights of a world with; 1 where pictures show them well, or where they reach nothing.
pub fn exposure(world: &World) -> f32 {
    let measured = measure(world);
    if measured < f32::MIN_POSITIVE || (SHOWN[0]..=SHOWN[1]).contains(&measured) {
        return 1.0;
    }
    // The whole number not below the logarithm, read off the bits: the same on every machine.
    let bits = measured.to_bits();
    let stops = (bits >> 23).cast_signed() - 127 + i32::from(bits & 0x007f_ffff != 0);
    f32::from_bits(((127 - stops).clamp(1, 254) as u32) << 23)
}

/// The light that [`PART`] of the surface do not exceed.
fn measure(world: &World) -> f32 {
    let lights: Vec<_> = world.lights.iter().filter_map(|light| PreparedLight::new(light, &DMat4::IDENTITY)).collect();
    if lights.is_empty() || world.facet_count == 0 {
        return 0.0;
    }
    let mut found: Vec<(f32, f64)> = (0..PLACES)
        .filter_map(|number| {
            let facet = (u64::from(number) * u64::from(world.facet_count) / u64::from(PLACES)) as u32;
            let instance = &world.instances[world.instance_of_facet(facet)];
            let (place, normal, area) = place(instance, facet - instance.first_facet, number)?;
            let light: f32 = lights.iter().map(|light| brightness(light, place, normal)).sum();
            light.is_finite().then_some((light, area))
        })
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut rest = found.iter().map(|(_, area)| area).sum::<f64>() * PART;
    let reached = found.iter().find(|(_, area)| {
        rest -= area;
        rest <= 0.0
    });
    reached.map_or(0.0, |(light, _)| *light)
}

/// A place in an instance's triangle with the unit normal there and the triangle's area, world space; none if it has no area.
fn place(instance: &Instance, triangle: u32, number: u32) -> Option<(DVec3, DVec3, f64)> {
    let [a, b, c] = instance.mesh.triangles[triangle as usize].map(|corner| {
        let position = DVec3::from_array(instance.mesh.positions[corner as usize].map(f64::from));
        instance.world_from_model.transform_point3(position)
    });
    let twice = (b - a).cross(c - a);
    let area = twice.length();
    let normal = twice.try_normalize().filter(|_| area.is_finite())?;
    let [mut u, mut v] = SPREAD.map(|step| (f64::from(number) * step).fract());
    if u + v > 1.0 {
        [u, v] = [1.0 - u, 1.0 - v];
    }
    Some((a + (b - a) * u + (c - a) * v, normal, area))
}

/// What a white Lambert surface gets from a light, on the side that faces it: files wind triangles either way.
fn brightness(light: &PreparedLight, place: DVec3, normal: DVec3) -> f32 {
    let [x, y, z] = place.as_vec3().to_array();
    let [nx, ny, nz] = normal.as_vec3().to_array();
    let (place, n) = (V3::new(x, y, z), V3::new(nx, ny, nz));
    let incident = light.incident(place);
    let facing = n.dot(incident.l);
    let n = if facing < 0.0 { n.scale(-1.0) } else { n };
    let arriving = light.irradiance(place, n).unwrap_or(incident.intensity * facing.abs());
    (0..3).map(|k| BRIGHTNESS[k] * light.diffuse[k]).sum::<f32>() * arriving
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Scene, builtin, default_lights, framing, lab};
    use vitral_light::{Attenuation, Light, LightKind};

    fn world(name: &str, lights: Vec<Light>) -> World {
        let mut scene: Scene = builtin::scene(name).unwrap();
        scene.lights = lights;
        scene.nodes.iter_mut().for_each(|node| node.light = None);
        World::new(&scene).unwrap()
    }

    fn sun(lux: f32) -> Light {
        let kind = LightKind::Directional { direction: DVec3::new(-1.0, -2.0, -3.0) };
        Light { kind, diffuse: [lux; 3], specular: [lux; 3], ..Light::default() }
    }

    #[test]
    fn daylight_and_starlight_are_brought_to_what_pictures_show() {
        for lux in [1e-6, 0.01, 3.0, 400.0, 30_000.0, 1e9] {
            let factor = exposure(&world("teapot", vec![sun(lux)]));
            let shown = measure(&world("teapot", vec![sun(lux * factor)]));
            assert!(factor.to_bits() & 0x007f_ffff == 0 && shown > 0.5 && shown <= 1.0, "{lux} lux: {factor}, {shown}");
        }
        let lamp = |candela, position| {
            let kind = LightKind::Point { position };
            Light { kind, attenuation: Attenuation::InverseSquare, ..sun(candela) }
        };
        let box_ = world("teapot", Vec::new()).bounds;
        let inside = exposure(&world("teapot", vec![lamp(54_000.0, box_.center())]));
        let far = exposure(&world("teapot", vec![lamp(54_000.0, box_.center() + DVec3::X * 100.0)]));
        assert!(inside < 1e-3 && far < 1.0 && far > 100.0 * inside, "{inside} {far}");
    }

    #[test]
    fn lights_that_pictures_show_stay_as_they_are() {
        for lux in [0.1, 0.5, 1.0, 1.9] {
            assert_eq!(exposure(&world("teapot", vec![sun(lux)])), 1.0, "{lux} lux");
        }
        let bounds = world("teapot", Vec::new()).bounds;
        let camera = framing::frame(&bounds, crate::View::Iso, crate::Axis::PlusY, crate::Lens::default(), 1.0);
        assert_eq!(exposure(&world("teapot", default_lights(&camera))), 1.0);
        assert_eq!(exposure(&world("teapot", lab::lights())), 1.0);
        // Nothing to dim: no light, none that shines, none that reaches anything, no surface.
        let off = Light { enabled: false, ..sun(1e5) };
        let elsewhere = Light {
            kind: LightKind::Spot {
                position: DVec3::X * 50.0,
                direction: DVec3::X,
                cutoff: 0.3,
                inner: 0.0,
                exponent: 0.0,
            },
            ..sun(1e5)
        };
        for lights in [vec![], vec![off], vec![elsewhere]] {
            assert_eq!(exposure(&world("teapot", lights)), 1.0);
        }
        let mut empty = world("teapot", vec![sun(1e5)]);
        empty.instances.clear();
        empty.facet_count = 0;
        assert_eq!(exposure(&empty), 1.0);
    }

    #[test]
    fn built_in_scenes_are_shown_as_they_are() {
        for &(name, _) in builtin::names() {
            let world = World::new(&builtin::scene(name).unwrap()).unwrap();
            assert_eq!(exposure(&world), 1.0, "builtin:{name}: {}", measure(&world));
        }
    }
}
