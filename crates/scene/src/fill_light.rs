//! A dim light from the viewer, for scenes whose own lights reach nothing that is seen.
//!
//! Idea: points spread over the triangles, as those of the light meter, with normals turned to the
//! viewer. If the scene's lights leave all of them black, so would be the picture: a light is
//! switched off, or shines past the model or on its far side alone. One point with light is enough
//! to leave the scene as its author lit it, and so is a surface that shines by itself.
//!
//! In:   instances and lights in world space, the camera. Occlusion is not considered.
//! Cost: one point with light where scenes are lit, else linear in the points times the lights.
//! Source: ours.

use crate::exposure::{BRIGHTNESS, POINTS, surface_point};
use crate::{Camera, Instance, Projection, World};
use vitral_light::{Light, LightKind, Material, PreparedLight, Rgb};
use vitral_math::lanes::V3;
use vitral_math::{DMat4, DVec3};

/// What a white surface that faces the camera gets from the fill light.
const DIM: f32 = 0.4;
/// The direction to the light in view space, x right, y up, z to the viewer: a little from the
/// upper left, so that faces differ.
const TO_LIGHT: DVec3 = DVec3::new(-0.3, 0.4, 1.0);
/// Light that a picture of 8 bits shows as black on white surfaces: half of the first step of sRGB.
const BLACK: f32 = 0.5 / 255.0 / 12.92;

/// The fill light for `camera`.
pub fn fill_light(camera: &Camera) -> Light {
    let direction = camera.view_from_world().inverse().transform_vector3(-TO_LIGHT);
    Light {
        name: "viewer".to_owned(),
        kind: LightKind::Directional { direction },
        diffuse: [DIM; 3],
        specular: [0.0; 3],
        shadow: false,
        ..Light::default()
    }
}

/// Whether the world's lights, the photometric ones times `exposure`, and `ambient` light leave
/// everything black that `camera` may see. Surfaces that shine or are unlit are not.
pub fn leaves_dark(
    world: &World,
    materials: &[Material],
    camera: &Camera,
    exposure: f32,
    ambient: Rgb,
) -> bool {
    // Add up what comes from everywhere.
    let enabled = || world.lights.iter().filter(|light| light.enabled);
    let scale = |light: &Light| if light.photometric { exposure } else { 1.0 };
    let from_everywhere =
        enabled().map(|light| bright(light.ambient) * scale(light)).sum::<f32>() + bright(ambient);
    if world.facet_count == 0 || from_everywhere > BLACK {
        return false;
    }

    // Look for a point that is lit on the side of the viewer.
    let lights: Vec<(PreparedLight, f32)> = enabled()
        .filter_map(|light| Some((PreparedLight::new(light, &DMat4::IDENTITY)?, scale(light))))
        .collect();
    let lit = |number: u32| {
        let facet = (u64::from(number) * u64::from(world.facet_count) / u64::from(POINTS)) as u32;
        let instance = &world.instances[world.instance_of_facet(facet)];
        let triangle = facet - instance.first_facet;
        if shines(instance, triangle, materials) {
            return true;
        }
        let Some((point, normal, _)) = surface_point(instance, triangle, number) else {
            return false;
        };
        let towards_viewer = match camera.projection {
            Projection::Parallel { .. } => camera.position - camera.focal_point,
            Projection::Perspective { .. } | Projection::Window { .. } => camera.position - point,
        };
        let normal = if normal.dot(towards_viewer) < 0.0 { -normal } else { normal };
        lights.iter().map(|(light, scale)| arriving(light, point, normal) * scale).sum::<f32>()
            > BLACK
    };
    !(0..POINTS).any(lit)
}

/// Whether a triangle is seen without any light.
fn shines(instance: &Instance, triangle: u32, materials: &[Material]) -> bool {
    let material = instance
        .mesh
        .material_of_triangle(triangle as usize)
        .and_then(|m| materials.get(m as usize));
    material.is_some_and(|m| m.unlit || bright(m.emission) > 0.0)
}

/// What a white Lambert surface gets from a light on the side of its normal.
fn arriving(light: &PreparedLight, point: DVec3, normal: DVec3) -> f32 {
    let [point, n] = [point, normal].map(|v| {
        let [x, y, z] = v.as_vec3().to_array();
        V3::new(x, y, z)
    });
    let incident = light.incident(point);
    let arriving =
        light.irradiance(point, n).unwrap_or(incident.intensity * n.dot(incident.l).max(0.0));
    (0..3).map(|k| BRIGHTNESS[k] * light.diffuse[k]).sum::<f32>() * arriving
}

fn bright(color: Rgb) -> f32 {
    (0..3).map(|k| BRIGHTNESS[k] * color[k]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Scene, builtin};

    fn is_dark(lights: Vec<Light>, eye: DVec3, change: impl Fn(&mut Scene)) -> bool {
        let mut scene = Scene { lights, ..Scene::from_mesh(builtin::solids::cuboid(DVec3::ONE)) };
        change(&mut scene);
        let world = World::new(&scene).unwrap();
        leaves_dark(
            &world,
            &scene.materials,
            &Camera::look_at(eye, DVec3::ZERO),
            1.0,
            scene.ambient,
        )
    }

    fn sun(direction: DVec3, strength: f32) -> Light {
        let kind = LightKind::Directional { direction };
        Light { kind, diffuse: [strength; 3], ambient: [0.0; 3], ..Light::default() }
    }

    #[test]
    fn only_what_the_viewer_may_see_counts() {
        let (above, below) = (DVec3::new(3.0, 4.0, 5.0), DVec3::new(3.0, -4.0, 5.0));
        let up = || vec![sun(DVec3::Y, 1.0)];
        assert!(is_dark(up(), above, |_| {}), "the sun from below lights the bottom alone");
        assert!(!is_dark(up(), below, |_| {}));
        assert!(is_dark(vec![sun(DVec3::NEG_Y, 0.0)], above, |_| {}), "switched off");
        assert!(!is_dark(vec![sun(DVec3::NEG_Y, 0.01)], above, |_| {}), "weak, but the author's");
        assert!(!is_dark(up(), above, |scene| scene.ambient = [0.01; 3]));
    }

    #[test]
    fn what_shines_is_seen() {
        let shine = |material: Material| {
            move |scene: &mut Scene| {
                let number = scene.add_material(material.clone());
                let mesh = std::sync::Arc::make_mut(&mut scene.meshes[0]);
                mesh.parts.iter_mut().for_each(|part| part.material = Some(number));
            }
        };
        let (eye, dark) = (DVec3::new(3.0, 4.0, 5.0), || vec![sun(DVec3::Y, 1.0)]);
        assert!(is_dark(dark(), eye, shine(Material::default())));
        assert!(!is_dark(
            dark(),
            eye,
            shine(Material { emission: [0.1; 3], ..Material::default() })
        ));
        assert!(!is_dark(dark(), eye, shine(Material { unlit: true, ..Material::default() })));
    }
}
