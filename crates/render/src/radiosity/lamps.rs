//! Lamps that are there twice: as an area light for the local models, and as a surface that shines for radiosity.
//!
//! A light of the scene is left out if at least half of it lies on surfaces that shine to the same side. Lights that were
//! chosen for the picture stay, wherever they are.
//!
//! In:   a session, lights. Out: the lights that light surfaces directly, and which were left out.
//! Cost: area lights times facets that shine.

use super::enclosure::takes_part;
use crate::Session;
use crate::raytrace::triangles::Triangles;
use crate::shadow::{facet as facet_of, weights};
use vitral_light::{AreaShape, Light, LightKind, Material};
use vitral_math::DVec3;
use vitral_scene::{Scene, World};

/// How far a light may be from the surface, as a part of its own size.
const APART: f64 = 0.05;
/// The least cosine between their normals.
const PARALLEL: f64 = 0.98;
/// By how much points may miss the surface, in weights of its corners: on the edge between two facets they hit one.
const BESIDE: f32 = 1e-3;

/// Whether a surface of the world shines by itself.
pub fn shines(scene: &Scene, world: &World) -> bool {
    made_of(scene, world, shining)
}

/// Whether a surface of the world is made of such a material.
pub(crate) fn made_of(scene: &Scene, world: &World, such: impl Fn(&Material) -> bool) -> bool {
    let parts = world.instances.iter().flat_map(|instance| &instance.mesh.parts);
    let mut used = parts.filter(|part| !part.triangles.is_empty()).filter_map(|part| part.material);
    used.any(|m| scene.materials.get(m as usize).is_some_and(&such))
}

/// Whether a material's surfaces send out light.
fn shining(material: &Material) -> bool {
    takes_part(Some(material)) && material.emission.iter().any(|&e| e > 0.0)
}

/// The lights that light surfaces directly: without ambient light, and without those that surfaces stand for.
pub(crate) fn direct_lights(session: &Session, lights: &[Light]) -> Vec<Light> {
    let own = |light: &Light| session.world.lights.iter().any(|own| own.kind == light.kind);
    let twice = |light: &Light| match &light.kind {
        LightKind::Area { shape } if light.enabled && own(light) => lies_on_a_lamp(session, shape),
        _ => false,
    };
    let direct = lights.iter().map(|light| Light {
        ambient: [0.0; 3],
        enabled: light.enabled && !twice(light),
        ..light.clone()
    });
    direct.collect()
}

/// A sentence on lights that are on, and not among the `direct` ones.
pub(crate) fn left_out(lights: &[Light], direct: &[Light]) -> Option<String> {
    let left_out =
        lights.iter().zip(direct).enumerate().filter(|(_, (light, direct))| light.enabled && !direct.enabled);
    let names = left_out.map(|(number, (light, _))| match &*light.name {
        "" => format!("number {number}"),
        name => format!("`{name}`"),
    });
    let names: Vec<String> = names.collect();
    let on = "on surfaces that shine themselves";
    match &*names {
        [] => None,
        [name] => Some(format!("radiosity does without the area light {name}, which lies {on}")),
        _ => Some(format!("radiosity does without the area lights {}, which lie {on}", names.join(", "))),
    }
}

fn lies_on_a_lamp(session: &Session, shape: &AreaShape) -> bool {
    let center = Triangles::center_of(&session.world);
    let Some(Spread { normal, size, mut points }) = Spread::new(shape) else { return false };
    let count = points.len();
    points.iter_mut().for_each(|p| *p -= center);
    for instance in &session.world.instances {
        for part in &instance.mesh.parts {
            let material = part.material.and_then(|m| session.scene.materials.get(m as usize));
            let Some(material) = material.filter(|m| shining(m)) else { continue };
            for triangle in part.triangles.clone() {
                let (corners, facing) = facet_of(instance, triangle, center);
                let cos = facing.dot(normal);
                let cos = if material.double_sided { cos.abs() } else { cos };
                if cos < PARALLEL {
                    continue;
                }
                let corner = corners[0];
                let corners = corners.map(|c| c.as_vec3());
                points.retain(|p| {
                    let near = (*p - corner).dot(facing).abs() <= APART * size;
                    !(near && weights(&corners, *p).iter().all(|&w| w >= -BESIDE))
                });
            }
        }
    }
    2 * points.len() <= count
}

/// Points of an area light.
struct Spread {
    /// Unit normal of the side that shines.
    normal: DVec3,
    /// From the middle to the farthest corner.
    size: f64,
    /// Half-way between its middle and its outline.
    points: Vec<DVec3>,
}

impl Spread {
    fn new(shape: &AreaShape) -> Option<Self> {
        let (middle, normal, outline) = match shape {
            &AreaShape::Disc { center, normal, radius } => {
                let normal = normal.try_normalize()?;
                let (x, y) = normal.any_orthonormal_pair();
                (center, normal, [x, y, -x, -y].map(|way| center + way * radius).to_vec())
            }
            AreaShape::Polygon { corners } => {
                let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
                let ways = corners.iter().zip(corners.iter().cycle().skip(1));
                let doubled: DVec3 = ways.map(|(a, b)| (*a - middle).cross(*b - middle)).sum();
                (middle, doubled.try_normalize()?, corners.clone())
            }
        };
        let size = outline.iter().map(|p| p.distance(middle)).fold(0.0, f64::max);
        Some(Self { normal, size, points: outline.into_iter().map(|p| p.midpoint(middle)).collect() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use vitral_math::DMat4;
    use vitral_scene::builtin::{self, solids};

    /// The Cornell box, whose lamp is there twice, changed.
    fn left_out_of(change: &dyn Fn(&mut Scene)) -> Option<String> {
        let mut scene = builtin::scene("cornell").unwrap();
        change(&mut scene);
        let session = Session::new(Arc::new(scene)).unwrap();
        let lights = &session.world.lights;
        left_out(lights, &direct_lights(&session, lights))
    }

    fn corners(scene: &mut Scene) -> &mut Vec<DVec3> {
        match &mut scene.lights[0].kind {
            LightKind::Area { shape: AreaShape::Polygon { corners } } => corners,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn only_area_lights_on_surfaces_that_shine_are_left_out() {
        let said = left_out_of(&|_| ()).expect("the lamp is there twice");
        assert!(said.contains("the area light `lamp`, which"), "{said}");
        let mut disc = AreaShape::Disc { center: DVec3::new(0.278, 0.5478, -0.28), normal: DVec3::NEG_Y, radius: 0.04 };
        assert!(left_out_of(&|scene| scene.lights[0].kind = LightKind::Area { shape: disc.clone() }).is_some());
        let AreaShape::Disc { normal, .. } = &mut disc else { unreachable!() };
        *normal = DVec3::Y;
        assert!(left_out_of(&|scene| scene.lights[0].kind = LightKind::Area { shape: disc.clone() }).is_none());
        assert!(left_out_of(&|scene| corners(scene).iter_mut().for_each(|c| c.y -= 0.01)).is_none(), "below the lamp");
        assert!(left_out_of(&|scene| corners(scene).iter_mut().for_each(|c| c.x += 0.1)).is_none(), "beside it");
        // A lamp that is no surface of the scene.
        let dark = |scene: &mut Scene| {
            let lamp = scene.materials.iter().position(|m| m.emission != [0.0; 3]).unwrap();
            let emission = std::mem::take(&mut scene.materials[lamp].emission);
            scene.add_material(Material { emission, ..Material::default() });
        };
        assert!(left_out_of(&dark).is_none(), "a material that nothing is made of");
    }

    #[test]
    fn chosen_lights_stay() {
        let session = Session::new(Arc::new(builtin::scene("cornell").unwrap())).unwrap();
        let mut light = session.world.lights[0].clone();
        light.diffuse = [1.0; 3];
        assert!(!direct_lights(&session, &[light.clone()])[0].enabled, "the scene's, at another intensity");
        let LightKind::Area { shape: AreaShape::Polygon { corners } } = &mut light.kind else { unreachable!() };
        corners[0].x += 1e-3;
        assert!(direct_lights(&session, &[light])[0].enabled);
    }

    #[test]
    fn surfaces_shine_and_unused_materials_do_not() {
        let mut scene = Scene::from_mesh(solids::plane(1.0, 1.0, 1, 1));
        let lamp = scene.add_material(Material { emission: [1.0; 3], ..Material::default() });
        let shines = |scene: &Scene| shines(scene, &World::new(scene).unwrap());
        assert!(!shines(&scene));
        let mut plane = solids::plane(1.0, 1.0, 1, 1);
        plane.parts.iter_mut().for_each(|p| p.material = Some(lamp));
        scene.add_mesh(plane, DMat4::IDENTITY);
        assert!(shines(&scene));
    }
}
