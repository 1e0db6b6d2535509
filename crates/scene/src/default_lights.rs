//! Lights for models that bring none: key, fill, back light and a weak one from below, fixed to the
//! camera.
//!
//! Idea: the photographer's three lights, and the light that a floor reflects. The key, from the
//! upper left in front, gives form; the fill, from the right, weakly lights what the key leaves
//! dark; the back light, from behind and above, draws a rim that parts the model from the
//! background. What faces down is lit weakly from below. A little ambient light keeps the rest from
//! black, and so does the fill, which casts no shadows: a large soft lamp hardly does, and many
//! materials reflect no ambient light (`Ka 0` in their files). They turn with the camera: the model
//! is well lit from every side.
//!
//! In:   the camera.
//! Out:  directional lights and one ambient light, world space. A white Lambert surface (`kd = 1`)
//!       that faces the camera gets 0.95 from the directional ones, one with `ka = 1` another 0.1
//!       of ambient light.
//! Cost: constant.
//! Source: three-point lighting is studio practice; the proportions are ours.

use crate::Camera;
use vitral_light::{Light, LightKind, Rgb};
use vitral_math::DVec3;

/// What a white surface that faces the camera gets from the directional lights.
const FACING: f64 = 0.95;
/// Ambient intensity.
const AMBIENT: f32 = 0.1;

/// Name, direction to the light in view space (x right, y up, z to the viewer), strength relative
/// to the key, tint, and whether it casts shadows.
const LIGHTS: [(&str, DVec3, f64, Rgb, bool); 4] = [
    ("key", DVec3::new(-0.45, 0.6, 0.75), 1.0, [1.0, 0.98, 0.95], true),
    ("fill", DVec3::new(0.75, 0.1, 0.6), 0.35, [0.93, 0.96, 1.0], false),
    ("below", DVec3::new(-0.3, -1.0, 0.25), 0.25, [1.0, 0.97, 0.93], false),
    ("back", DVec3::new(0.35, 0.6, -0.7), 0.45, [1.0, 1.0, 1.0], true),
];

/// The lights for `camera`.
pub fn default_lights(camera: &Camera) -> Vec<Light> {
    let world_from_view = camera.view_from_world().inverse();

    // Scale all so that the sum of the cosines at a surface facing the camera is as wished.
    let facing: f64 = LIGHTS
        .iter()
        .map(|(_, to_light, strength, _, _)| to_light.normalize().z.max(0.0) * strength)
        .sum();
    let mut lights = Vec::new();
    for (name, to_light, strength, tint, casts) in &LIGHTS {
        let intensity = tint.map(|c| c * (strength * FACING / facing) as f32);
        lights.push(Light {
            name: (*name).to_owned(),
            kind: LightKind::Directional {
                direction: world_from_view.transform_vector3(-to_light.normalize()),
            },
            diffuse: intensity,
            specular: intensity,
            shadow: *casts,
            ..Light::default()
        });
    }
    lights.push(Light {
        name: "ambient".to_owned(),
        kind: LightKind::Ambient,
        ambient: [AMBIENT; 3],
        diffuse: [0.0; 3],
        specular: [0.0; 3],
        shadow: false,
        ..Light::default()
    });
    lights
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axis, Lens, View, frame};
    use vitral_math::Aabb;

    #[test]
    fn a_white_surface_facing_the_camera_gets_the_promised_light_from_every_side() {
        let bounds = Aabb { min: DVec3::ZERO, max: DVec3::ONE };
        for view in [View::Iso, View::Front, View::Left, View::Bottom] {
            let camera = frame(&bounds, view, Axis::PlusZ, Lens::default(), 1.0);
            let normal = (camera.position - camera.focal_point).normalize();
            let mut sum = [0.0f64; 3];
            let lights = default_lights(&camera);
            assert_eq!(
                lights.iter().filter(|l| !l.shadow).map(|l| &*l.name).collect::<Vec<_>>(),
                ["fill", "below", "ambient"]
            );
            for light in lights {
                if let LightKind::Directional { direction } = light.kind {
                    let cosine = (-direction.normalize()).dot(normal).max(0.0);
                    (0..3).for_each(|k| sum[k] += cosine * f64::from(light.diffuse[k]));
                }
            }
            assert!(sum.iter().all(|s| (s - FACING).abs() < 0.04), "{view:?}: {sum:?}");
        }
    }
}
