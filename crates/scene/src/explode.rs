//! Exploded views: the parts of a scene moved apart.
//!
//! Each part moves by a multiple of the way from the centre of the whole to its own centre, both
//! those of boxes in world space. Parts are the instances. If there is only one, its groups are;
//! and if these have one name, its bodies: triangles that are connected by their corners. Free
//! lines and points stay where they are when an instance is taken apart.
//!
//! In:   a scene and a factor. Out: the scene with a root node for each part.
//! Cost: linear; `n log n` where an instance is taken apart.

use crate::disjoint_sets::DisjointSets;
use crate::weld::Weld;
use crate::{Attribute, Corners, Faces, Mesh, Node, NodeTransform, Part, Scene, World, WorldError};
use std::collections::BTreeMap;
use std::sync::Arc;
use vitral_exec::Workers;
use vitral_math::{Aabb, DMat4};

impl Scene {
    /// The scene with its parts moved away from its centre by `factor` times the way from there to
    /// theirs. 0 moves nothing; lights and cameras stay where they are.
    ///
    /// ```
    /// use vitral_scene::{Scene, World, builtin::solids};
    /// use vitral_math::{DMat4, DVec3};
    ///
    /// let mut scene = Scene::default();
    /// scene.add_mesh(solids::cuboid(DVec3::ONE), DMat4::from_translation(DVec3::X));
    /// scene.add_instance(0, DMat4::from_translation(-DVec3::X));
    /// let apart = World::new(&scene.exploded(0.5).unwrap()).unwrap();
    /// assert_eq!(apart.bounds.max.x, 2.0);
    /// ```
    ///
    /// # Errors
    /// A scene whose graph or numbers cannot be.
    pub fn exploded(&self, factor: f64) -> Result<Self, WorldError> {
        self.exploded_on(factor, &Workers::single())
    }

    /// [`exploded`](Self::exploded) with all of `workers`.
    ///
    /// # Errors
    /// As [`exploded`](Self::exploded).
    pub fn exploded_on(&self, factor: f64, workers: &Workers) -> Result<Self, WorldError> {
        let world = World::with_workers(self, workers)?;
        let mut scene = self.clone();
        if factor == 0.0 || world.instances.is_empty() {
            return Ok(scene);
        }

        // Find the parts: the instances, or those of the only one.
        let mut parts: Vec<(Arc<Mesh>, DMat4, Aabb)> = Vec::new();
        let taken_apart = match &world.instances[..] {
            [one] => taken_apart(&one.mesh, workers),
            _ => Vec::new(),
        };
        if taken_apart.is_empty() {
            parts.extend(
                world.instances.iter().map(|i| (Arc::clone(&i.mesh), i.world_from_model, i.bounds)),
            );
        } else {
            let placement = world.instances[0].world_from_model;
            parts.extend(taken_apart.into_iter().map(|mesh| {
                // Free lines and points stay.
                let is_free = mesh.triangles.is_empty();
                let bounds =
                    if is_free { world.bounds } else { mesh.bounds().transformed(&placement) };
                (Arc::new(mesh), placement, bounds)
            }));
        }

        // Give each a node of its own, in the same order.
        for instance in &world.instances {
            scene.nodes[instance.node as usize].mesh = None;
        }
        for (i, (mesh, world_from_model, bounds)) in parts.into_iter().enumerate() {
            let way = (bounds.center() - world.bounds.center()) * factor;
            let moved =
                if way.is_finite() { DMat4::from_translation(way) } else { DMat4::IDENTITY };
            let instance =
                world.instances.get(i).filter(|instance| Arc::ptr_eq(&instance.mesh, &mesh));
            let index = instance.map_or(scene.meshes.len() as u32, |instance| instance.mesh_index);
            let name =
                instance.map_or(mesh.name.clone(), |i| self.nodes[i.node as usize].name.clone());
            if instance.is_none() {
                scene.meshes.push(mesh);
            }
            let transform = NodeTransform::Matrix(moved * world_from_model);
            scene.add_root(Node { name, transform, mesh: Some(index), ..Node::default() });
        }
        Ok(scene)
    }
}

impl World {
    /// The number of the part of each surface, by surface id. Parts are those of
    /// [`Scene::exploded`].
    pub fn parts_of_surfaces(&self, workers: &Workers) -> Vec<u32> {
        match &self.instances[..] {
            [one] => parts_of_faces(&one.mesh, workers).0,
            all => all
                .iter()
                .enumerate()
                .flat_map(|(i, instance)| std::iter::repeat_n(i as u32, instance.mesh.face_count()))
                .collect(),
        }
    }
}

/// For each face of a mesh the number of its part, a group or else a body, in order of their first
/// faces; and how many there are.
fn parts_of_faces(mesh: &Mesh, workers: &Workers) -> (Vec<u32>, usize) {
    let mut names: BTreeMap<&str, u32> = BTreeMap::new();
    for part in mesh.parts.iter().filter(|part| !part.triangles.is_empty()) {
        let next = names.len() as u32;
        names.entry(&part.name).or_insert(next);
    }
    let first_triangles = (0..mesh.face_count()).map(|face| mesh.face_triangles(face).start);
    if names.len() > 1 {
        let mut part = 0;
        let numbers = first_triangles.map(|t| {
            while mesh.parts[part].triangles.end as usize <= t {
                part += 1;
            }
            names[mesh.parts[part].name.as_str()]
        });
        (numbers.collect::<Vec<_>>(), names.len())
    } else {
        let roots = bodies(mesh, workers);
        let mut numbers = BTreeMap::new();
        let numbered = first_triangles.map(|t| {
            let next = numbers.len() as u32;
            *numbers.entry(roots[t]).or_insert(next)
        });
        let numbered: Vec<u32> = numbered.collect();
        (numbered, numbers.len())
    }
}

/// The groups or bodies of a mesh as meshes of their own, in order of their first faces; none if
/// there is only one.
fn taken_apart(mesh: &Mesh, workers: &Workers) -> Vec<Mesh> {
    let (part_of_face, count) = parts_of_faces(mesh, workers);
    if count < 2 {
        return Vec::new();
    }

    // Deal the faces, and make a mesh of each part and one of free lines and points.
    let mut faces_of_part: Vec<Vec<u32>> = vec![Vec::new(); count];
    part_of_face
        .iter()
        .enumerate()
        .for_each(|(face, &part)| faces_of_part[part as usize].push(face as u32));
    let mut parts: Vec<Mesh> = faces_of_part.iter().map(|faces| subset(mesh, faces)).collect();
    if !mesh.lines.is_empty() || !mesh.points.is_empty() {
        let free = Mesh {
            name: mesh.name.clone(),
            positions: mesh.positions.clone(),
            lines: mesh.lines.clone(),
            points: mesh.points.clone(),
            line_parts: mesh.line_parts.clone(),
            point_parts: mesh.point_parts.clone(),
            ..Mesh::default()
        };
        parts.push(free);
    }
    parts
}

/// For each triangle a number that all triangles of its body have.
fn bodies(mesh: &Mesh, workers: &Workers) -> Vec<u32> {
    let weld = Weld::new(&mesh.positions, workers);
    let sets = DisjointSets::new(mesh.positions.len());
    for face in 0..mesh.face_count() {
        let corners = mesh.face_corners(face);
        corners.windows(2).for_each(|pair| sets.join(weld.of(pair[0]), weld.of(pair[1])));
    }
    mesh.triangles.iter().map(|corners| sets.find(weld.of(corners[0]))).collect()
}

/// Some faces of a mesh, with the positions and values that they use.
fn subset(mesh: &Mesh, faces: &[u32]) -> Mesh {
    // Renumber the triangles' corners by the positions in use.
    let triangles: Vec<usize> =
        faces.iter().flat_map(|&face| mesh.face_triangles(face as usize)).collect();
    let own: Vec<Corners> = triangles.iter().map(|&t| mesh.triangles[t]).collect();
    let (used, own) = compacted(&own);
    let corners_of = |all: Option<&[Corners]>| {
        let all = all.unwrap_or(&mesh.triangles);
        compacted(&triangles.iter().map(|&t| all[t]).collect::<Vec<_>>())
    };

    // Number the outlines anew.
    let (mut starts, mut corners) = (vec![0], Vec::new());
    for &face in faces {
        let outline = mesh.face_corners(face as usize);
        corners.extend(outline.iter().map(|v| used.partition_point(|u| u < v) as u32));
        starts.push(corners.len() as u32);
    }

    // Join the triangles of one group and material.
    let mut parts: Vec<Part> = Vec::new();
    for (i, &t) in triangles.iter().enumerate() {
        let index = mesh.parts.partition_point(|part| part.triangles.end as usize <= t);
        let Some(of) = mesh.parts.get(index) else { continue };
        match parts.last_mut() {
            Some(last) if last.material == of.material && last.name == of.name => {
                last.triangles.end = i as u32 + 1
            }
            _ => parts.push(Part { triangles: i as u32..i as u32 + 1, ..of.clone() }),
        }
    }

    // Name the mesh after its first part, and select the values of each attribute.
    let name = parts.first().map(|part| part.name.clone()).filter(|name| !name.is_empty());
    Mesh {
        name: name.unwrap_or_else(|| mesh.name.clone()),
        positions: used.iter().map(|&v| mesh.positions[v as usize]).collect(),
        triangles: own,
        faces: if mesh.faces == Faces::Triangles {
            Faces::Triangles
        } else {
            Faces::Polygons { starts, corners }
        },
        parts,
        normals: mesh
            .normals
            .as_ref()
            .map(|all| some_values(all, corners_of(all.corners.as_deref()))),
        normals_stay: mesh.normals_stay,
        tangents: mesh
            .tangents
            .as_ref()
            .map(|all| some_values(all, corners_of(all.corners.as_deref()))),
        uvs: mesh
            .uvs
            .iter()
            .map(|all| some_values(all, corners_of(all.corners.as_deref())))
            .collect(),
        colors: mesh
            .colors
            .as_ref()
            .map(|all| some_values(all, corners_of(all.corners.as_deref()))),
        colors_from_srgb: mesh.colors_from_srgb,
        smoothing_groups: mesh
            .smoothing_groups
            .as_ref()
            .map(|g| faces.iter().map(|&f| g[f as usize]).collect()),
        ..Mesh::default()
    }
}

/// The indices in use, in order, and the corners as places among them.
fn compacted(corners: &[Corners]) -> (Vec<u32>, Vec<Corners>) {
    let mut used = corners.as_flattened().to_vec();
    used.sort_unstable();
    used.dedup();
    let places =
        corners.iter().map(|c| c.map(|v| used.partition_point(|&u| u < v) as u32)).collect();
    (used, places)
}

/// The values of an attribute at these indices, with these corners.
fn some_values<T: Copy>(
    all: &Attribute<T>,
    (used, corners): (Vec<u32>, Vec<Corners>),
) -> Attribute<T> {
    Attribute {
        values: used.iter().map(|&i| all.values[i as usize]).collect(),
        corners: Some(corners),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::solids;
    use vitral_math::DVec3;

    /// The centres of the parts of an exploded scene.
    fn centers(scene: &Scene, factor: f64) -> Vec<DVec3> {
        let world = World::new(&scene.exploded(factor).unwrap()).unwrap();
        world.instances.iter().for_each(|instance| instance.mesh.check().unwrap());
        world.instances.iter().map(|instance| instance.bounds.center()).collect()
    }

    /// Two cubes in one mesh, with their centres at -3 and 3, as parts of these names.
    fn two(names: [&str; 2]) -> Mesh {
        let cube = solids::cuboid(DVec3::ONE);
        let mut mesh = Mesh::new(cube.positions.clone(), cube.triangles.clone());
        let (vertices, triangles) = (mesh.positions.len() as u32, mesh.triangles.len() as u32);
        mesh.positions.extend(cube.positions.iter().map(|p| [p[0] + 6.0, p[1], p[2]]));
        mesh.triangles.extend(cube.triangles.iter().map(|t| t.map(|v| v + vertices)));
        mesh.positions.iter_mut().for_each(|p| p[0] -= 3.0);
        let part = |k: u32| Part {
            name: names[k as usize].into(),
            triangles: k * triangles..(k + 1) * triangles,
            material: None,
        };
        Mesh { parts: vec![part(0), part(1)], ..mesh }
    }

    #[test]
    fn instances_move_by_a_multiple_of_their_distance() {
        let mut scene = Scene::default();
        scene.add_mesh(
            solids::cuboid(DVec3::ONE),
            DMat4::from_translation(DVec3::new(1.0, 0.0, 0.0)),
        );
        let child = Node {
            transform: NodeTransform::Matrix(DMat4::from_translation(DVec3::new(-4.0, 2.0, 0.0))),
            mesh: Some(0),
            ..Node::default()
        };
        // The second hangs on the first and moves by itself all the same.
        scene.nodes.push(child);
        scene.nodes[0].children.push(1);
        let [first, second] = [DVec3::new(1.0, 0.0, 0.0), DVec3::new(-3.0, 2.0, 0.0)];
        assert_eq!(centers(&scene, 0.0), [first, second]);
        let middle = DVec3::new(-1.0, 1.0, 0.0);
        let apart = centers(&scene, 1.5);
        assert_eq!(apart, [first, second].map(|center| middle + (center - middle) * 2.5));
        assert_eq!(scene.exploded(1.5).unwrap().meshes.len(), 1, "meshes stay shared");
    }

    #[test]
    fn a_single_instance_is_taken_apart_by_groups_or_bodies() {
        for names in [["left", "right"], ["", ""], ["one", "one"]] {
            let mut scene = Scene::default();
            scene.add_mesh(two(names), DMat4::from_scale(DVec3::splat(2.0)));
            let apart = centers(&scene, 1.0);
            assert_eq!(apart, [DVec3::X * -12.0, DVec3::X * 12.0], "{names:?}");
        }
        let mut one = two(["", ""]);
        one.lines = vec![[0, 8]];
        assert_eq!(centers(&Scene::from_mesh(one), 1.0).len(), 3, "lines stay behind");
        assert_eq!(centers(&Scene::from_mesh(solids::cuboid(DVec3::ONE)), 2.0), [DVec3::ZERO]);
        assert!(centers(&Scene::default(), 1.0).is_empty());
    }

    #[test]
    fn parts_keep_their_values_and_faces() {
        let mut mesh = solids::cuboid(DVec3::ONE);
        let half = mesh.triangles.len() as u32 / 2;
        let part = |name: &str, triangles| Part { name: name.into(), triangles, material: Some(3) };
        mesh.parts = vec![part("a", 0..half), part("b", half..2 * half)];
        let count = mesh.positions.len() as u32;
        mesh = mesh
            .with_smooth_normals(0.1)
            .with_uvs((0..count).map(|i| [i as f32; 2]).collect::<Vec<_>>());
        let parts = taken_apart(&mesh, &Workers::single());
        assert_eq!(parts.iter().map(Mesh::face_count).collect::<Vec<_>>(), [3, 3]);
        for t in 0..half as usize {
            let [own, whole] = [&parts[1], &mesh].map(|m| {
                let t = if std::ptr::eq(m, &mesh) { t + half as usize } else { t };
                let normals = m.normals.as_ref().map(|n| n.at(t, &m.triangles));
                (
                    m.triangles[t].map(|v| m.positions[v as usize]),
                    m.uvs[0].at(t, &m.triangles),
                    normals,
                )
            });
            assert_eq!(own, whole);
        }
        assert_eq!((parts[1].name.as_str(), parts[1].material_of_triangle(0)), ("b", Some(3)));
    }
}
