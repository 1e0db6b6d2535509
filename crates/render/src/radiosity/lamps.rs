//! Surfaces that shine, as area lights: what they light directly is found for each point of the
//! picture, by rays and without elements, so that shadows are sharp where they are sharp.
//!
//! That is for few lamps, which shine evenly. Many small ones, and those whose light is a texture,
//! send their light from element to element as all other surfaces do. A light of the scene is left
//! out if at least half of it lies on surfaces that shine to the same side: it stands for them.
//! Lights that were chosen for the picture stay, wherever they are.
//!
//! In:   a session, lights. Out: the lights that light surfaces directly, and the facets that they
//!       stand for.
//! Cost: area lights times facets that shine.

use super::enclosure::takes_part;
use crate::Session;
use crate::raytrace::triangles::Triangles;
use crate::shadow::{facet as facet_of, weights};
use vitral_light::{AreaShape, Attenuation, Light, LightKind, Material};
use vitral_math::DVec3;
use vitral_scene::{Scene, World};

/// How far a light may be from the surface, as a part of its own size.
const APART: f64 = 0.05;
/// The least cosine between their normals.
const PARALLEL: f64 = 0.98;
/// By how much points may miss the surface, in weights of its corners: on the edge between two
/// facets they hit one.
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

/// More lamps than these are no lights: each would be asked for at each point.
const MOST_LAMPS: usize = 16;

/// A surface that shines, as a light.
pub(super) struct Lamp {
    /// The facets that it stands for: one, or the two of a quadrilateral.
    pub(super) facets: Vec<u32>,
    pub(super) light: Light,
}

/// The lights that light surfaces directly: without ambient light, without those that surfaces
/// stand for, and with those that stand for surfaces.
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
    direct.chain(lamps(session).into_iter().map(|lamp| lamp.light)).collect()
}

/// The surfaces that shine, as lights; none if there are many.
pub(super) fn lamps(session: &Session) -> Vec<Lamp> {
    let mut lamps = Vec::new();
    for instance in &session.world.instances {
        for part in &instance.mesh.parts {
            let material = part.material.and_then(|m| session.scene.materials.get(m as usize));
            let Some(material) = material.filter(|m| shines_evenly(m)) else { continue };
            let mut before: Option<(u32, [DVec3; 3], DVec3)> = None;
            // Skip facets without area.
            for triangle in part.triangles.clone() {
                let (corners, normal) = facet_of(instance, triangle, DVec3::ZERO);
                let facet = instance.first_facet + triangle;
                if normal == DVec3::ZERO || !corners.iter().all(|c| c.is_finite()) {
                    continue;
                }
                // Two halves of a quadrilateral are one lamp.
                let whole = before.filter(|(_, _, n)| n.dot(normal) > 1.0 - 1e-9);
                let whole = whole.and_then(|(other, first, _)| {
                    Some((other, quadrilateral(&first, &corners, normal)?))
                });

                // Replace the last lamp by the quadrilateral of both, or add a lamp.
                if let Some((other, outline)) = whole {
                    let sides = if material.double_sided { 2 } else { 1 };
                    lamps.truncate(lamps.len() - sides);
                    push(&mut lamps, vec![other, facet], &outline, material);
                    before = None;
                } else {
                    push(&mut lamps, vec![facet], &turned_to(corners, normal), material);
                    before = Some((facet, turned_to(corners, normal), normal));
                }

                // Give up when there are too many.
                if lamps.len() > 2 * MOST_LAMPS {
                    return Vec::new();
                }
            }
        }
    }
    if lamps.len() > MOST_LAMPS { Vec::new() } else { lamps }
}

/// Corners counter-clockwise round a normal.
fn turned_to([a, b, c]: [DVec3; 3], normal: DVec3) -> [DVec3; 3] {
    if (b - a).cross(c - a).dot(normal) < 0.0 { [a, c, b] } else { [a, b, c] }
}

/// The convex outline of two triangles that share an edge, counter-clockwise round their normal.
fn quadrilateral(first: &[DVec3; 3], second: &[DVec3; 3], normal: DVec3) -> Option<[DVec3; 4]> {
    let apart = second.iter().copied().find(|p| !first.contains(p))?;
    let lone = (0..3).find(|&k| !second.contains(&first[k]))?;
    if second.iter().filter(|p| first.contains(p)).count() != 2 {
        return None;
    }
    let outline = [first[lone], first[(lone + 1) % 3], apart, first[(lone + 2) % 3]];
    let turns = |k: usize| {
        let [a, b, c] = [outline[k], outline[(k + 1) % 4], outline[(k + 2) % 4]];
        (b - a).cross(c - b).dot(normal) > 0.0
    };
    (0..4).all(turns).then_some(outline)
}

/// Adds the lights of a shape that shines to its front, or to both sides.
fn push(lamps: &mut Vec<Lamp>, facets: Vec<u32>, outline: &[DVec3], material: &Material) {
    let fan =
        outline.windows(2).skip(1).map(|pair| (pair[0] - outline[0]).cross(pair[1] - outline[0]));
    let area = 0.5 * fan.sum::<DVec3>().length();
    // A white surface that a light of intensity 1 faces receives 1: a lamp of radiosity B sends B A
    // / π along its axis.
    let diffuse =
        material.emission.map(|e| (f64::from(e.max(0.0)) * area / std::f64::consts::PI) as f32);
    let backwards = outline.iter().rev().copied().collect();
    let sides = [outline.to_vec(), backwards];
    for corners in sides.into_iter().take(if material.double_sided { 2 } else { 1 }) {
        let light = Light {
            name: material.name.clone(),
            kind: LightKind::Area { shape: AreaShape::Polygon { corners } },
            diffuse,
            specular: [0.0; 3],
            attenuation: Attenuation::InverseSquare,
            ..Light::default()
        };
        lamps.push(Lamp { facets: facets.clone(), light });
    }
}

/// Whether a material's surfaces send out the same light everywhere.
fn shines_evenly(material: &Material) -> bool {
    shining(material) && material.emission_texture.is_none() && !material.is_layered()
}

fn lies_on_a_lamp(session: &Session, shape: &AreaShape) -> bool {
    // Spread points over the shape.
    let center = Triangles::center_of(&session.world);
    let Some(Spread { normal, size, mut points }) = Spread::new(shape) else { return false };
    let count = points.len();
    points.iter_mut().for_each(|p| *p -= center);

    // Drop the points that lie on a shining facet parallel to it.
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

    // Decide by the majority of points.
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
        Some(Self {
            normal,
            size,
            points: outline.into_iter().map(|p| p.midpoint(middle)).collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use vitral_math::DMat4;
    use vitral_scene::builtin::{self, solids};

    /// Whether the light of the Cornell box, changed, is left out because the lamp stands for it.
    fn is_left_out(change: &dyn Fn(&mut Scene)) -> bool {
        let mut scene = builtin::scene("cornell").unwrap();
        change(&mut scene);
        let session = Session::new(Arc::new(scene)).unwrap();
        !direct_lights(&session, &session.world.lights)[0].enabled
    }

    fn corners(scene: &mut Scene) -> &mut Vec<DVec3> {
        match &mut scene.lights[0].kind {
            LightKind::Area { shape: AreaShape::Polygon { corners } } => corners,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn only_area_lights_on_surfaces_that_shine_are_left_out() {
        assert!(is_left_out(&|_| ()), "the lamp is there twice");
        let mut disc = AreaShape::Disc {
            center: DVec3::new(0.278, 0.5478, -0.28),
            normal: DVec3::NEG_Y,
            radius: 0.04,
        };
        assert!(is_left_out(
            &|scene| scene.lights[0].kind = LightKind::Area { shape: disc.clone() }
        ));
        let AreaShape::Disc { normal, .. } = &mut disc else { unreachable!() };
        *normal = DVec3::Y;
        assert!(!is_left_out(
            &|scene| scene.lights[0].kind = LightKind::Area { shape: disc.clone() }
        ));
        assert!(
            !is_left_out(&|scene| corners(scene).iter_mut().for_each(|c| c.y -= 0.01)),
            "below the lamp"
        );
        assert!(
            !is_left_out(&|scene| corners(scene).iter_mut().for_each(|c| c.x += 0.1)),
            "beside it"
        );
        // A lamp that is no surface of the scene.
        let dark = |scene: &mut Scene| {
            let lamp = scene.materials.iter().position(|m| m.emission != [0.0; 3]).unwrap();
            let emission = std::mem::take(&mut scene.materials[lamp].emission);
            scene.add_material(Material { emission, ..Material::default() });
        };
        assert!(!is_left_out(&dark), "a material that nothing is made of");
    }

    #[test]
    fn a_lamp_is_one_light_of_its_outline_and_as_bright() {
        let session = Session::new(Arc::new(builtin::scene("cornell").unwrap())).unwrap();
        let lamps = lamps(&session);
        assert_eq!(lamps.len(), 1, "two triangles");
        let LightKind::Area { shape: AreaShape::Polygon { corners } } = &lamps[0].light.kind else {
            panic!()
        };
        assert_eq!((corners.len(), lamps[0].facets.len()), (4, 2));
        let area = (corners[1] - corners[0]).length() * (corners[2] - corners[1]).length();
        let emission =
            session.scene.materials.iter().find(|m| m.emission != [0.0; 3]).unwrap().emission;
        for k in 0..3 {
            let expected = f64::from(emission[k]) * area / std::f64::consts::PI;
            assert!((f64::from(lamps[0].light.diffuse[k]) / expected - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn chosen_lights_stay() {
        let session = Session::new(Arc::new(builtin::scene("cornell").unwrap())).unwrap();
        let mut light = session.world.lights[0].clone();
        light.diffuse = [1.0; 3];
        assert!(
            !direct_lights(&session, &[light.clone()])[0].enabled,
            "the scene's, at another intensity"
        );
        let LightKind::Area { shape: AreaShape::Polygon { corners } } = &mut light.kind else {
            unreachable!()
        };
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
