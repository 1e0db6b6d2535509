//! The scene graph walked once: instances, lights and cameras in world space, and the numbering of
//! surfaces.

use crate::{Camera, Mesh, Node, Scene};
use std::sync::Arc;
use vitral_exec::Workers;
use vitral_light::Light;
use vitral_math::{Aabb, DMat4, DVec3};

/// A mesh at a place.
#[derive(Clone, Debug)]
pub struct Instance {
    /// The shared mesh.
    pub mesh: Arc<Mesh>,
    /// Index of the mesh in the scene.
    pub mesh_index: u32,
    /// The node that shows it.
    pub node: u32,
    /// Placement.
    pub world_from_model: DMat4,
    /// The box round the mesh, model space.
    pub model_bounds: Aabb,
    /// The box round it, world space.
    pub bounds: Aabb,
    /// Surface id of its first face.
    pub first_surface: u32,
    /// Facet id of its first triangle.
    pub first_facet: u32,
}

/// The flattened scene.
#[derive(Clone, Debug, Default)]
pub struct World {
    /// Instances in scene order: depth first, children in order.
    pub instances: Vec<Instance>,
    /// Lights that are switched on or off, world space: the scene's own first, then the nodes'.
    pub lights: Vec<Light>,
    /// Cameras in world space, in the order of [`Scene::cameras`]; one that several nodes name, in
    /// scene order.
    pub cameras: Vec<Camera>,
    /// The one of these that is [`Scene::own_camera`].
    pub own_camera: Option<usize>,
    /// The box round all instances.
    pub bounds: Aabb,
    /// For each mesh of the scene, the boxes round its runs of triangles ([`Mesh::run_bounds`]),
    /// model space.
    pub run_bounds: Vec<Vec<Aabb>>,
    /// Number of surfaces (faces of all instances).
    pub surface_count: u32,
    /// Number of facets (triangles of all instances).
    pub facet_count: u32,
}

/// Why a scene graph cannot be walked.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum WorldError {
    /// A node is its own ancestor, or has two parents.
    #[error("node {node} is reached twice: the scene graph must be a tree")]
    NotATree {
        /// The node that is the cause.
        node: u32,
    },
    /// An index points nowhere.
    #[error("node {node} refers to {what} {index}, there are {count}")]
    BadIndex {
        /// The node that is the cause.
        node: u32,
        /// What it refers to.
        what: &'static str,
        /// The index that is out of range.
        index: u32,
        /// How many there are.
        count: usize,
    },
    /// A root is no node.
    #[error("roots[{place}] is node {index}, there are {count}")]
    BadRoot {
        /// Its place in the list of roots.
        place: usize,
        /// The index that is out of range.
        index: u32,
        /// How many nodes there are.
        count: usize,
    },
    /// More triangles than ids.
    #[error("the scene has more than 4294967294 triangles")]
    TooManyFacets,
}

impl Instance {
    /// The corners of a triangle, world space.
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.mesh.triangles[triangle as usize].map(|vertex| self.place(vertex))
    }

    /// The position of a vertex, world space.
    pub fn place(&self, vertex: u32) -> DVec3 {
        let position = self.mesh.positions[vertex as usize].map(f64::from);
        self.world_from_model.transform_point3(DVec3::from_array(position))
    }
}

impl World {
    /// Walks the graph from its roots. Bounds of each mesh are computed once, however many
    /// instances it has.
    ///
    /// # Errors
    /// A scene whose graph or numbers cannot be, see [`WorldError`].
    pub fn new(scene: &Scene) -> Result<Self, WorldError> {
        Self::with_workers(scene, &Workers::single())
    }

    /// [`Self::new`] with all of `workers`.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_workers(scene: &Scene, workers: &Workers) -> Result<Self, WorldError> {
        // Compute the boxes of meshes once, however many instances they have.
        let run_bounds: Vec<Vec<Aabb>> =
            scene.meshes.iter().map(|m| m.run_bounds(workers)).collect();
        let bounds: Vec<Aabb> =
            scene.meshes.iter().zip(&run_bounds).map(|(m, runs)| m.bounds_from(runs)).collect();
        Self::place(scene, run_bounds, &bounds)
    }

    /// The world of a scene whose meshes are those of this world's scene, and whose nodes may be
    /// elsewhere. What is known of the meshes is kept.
    ///
    /// # Errors
    /// As [`Self::new`].
    ///
    /// # Panics
    /// If the scene has another number of meshes.
    pub fn moved(&self, scene: &Scene) -> Result<Self, WorldError> {
        assert_eq!(scene.meshes.len(), self.run_bounds.len(), "the meshes stay");
        let mut bounds = vec![None; scene.meshes.len()];
        for instance in &self.instances {
            bounds[instance.mesh_index as usize] = Some(instance.model_bounds);
        }
        let known = bounds.into_iter().zip(scene.meshes.iter().zip(&self.run_bounds));
        let bounds: Vec<Aabb> =
            known.map(|(known, (m, runs))| known.unwrap_or_else(|| m.bounds_from(runs))).collect();
        Self::place(scene, self.run_bounds.clone(), &bounds)
    }

    /// Walks the graph. `run_bounds` and `bounds` are the boxes of the scene's meshes.
    fn place(
        scene: &Scene,
        run_bounds: Vec<Vec<Aabb>>,
        bounds: &[Aabb],
    ) -> Result<Self, WorldError> {
        let mut world = Self {
            lights: scene.lights.clone(),
            bounds: Aabb::EMPTY,
            run_bounds,
            ..Self::default()
        };
        let mut cameras: Vec<(u32, Camera)> = Vec::new();
        for (index, world_from_node) in placed_nodes(scene)? {
            let node = &scene.nodes[index as usize];
            if let Some(m) = node.mesh {
                let (mesh, model_bounds) = (&scene.meshes[m as usize], bounds[m as usize]);
                world.add_instance(index, m, mesh, model_bounds, world_from_node)?;
            }
            if let Some(light) = &node.light {
                world.lights.push(light.transformed(&world_from_node));
            }
            if let Some(c) = node.camera {
                cameras.push((c, camera_in_world(&scene.cameras[c as usize], &world_from_node)));
            }
        }

        // Put the cameras in the order of the scene's list.
        cameras.sort_by_key(|&(c, _)| c);
        world.own_camera =
            scene.own_camera.and_then(|own| cameras.iter().position(|&(c, _)| c == own));
        world.cameras = cameras.into_iter().map(|(_, camera)| camera).collect();
        Ok(world)
    }

    /// Adds mesh number `mesh_index` at a node, and numbers its surfaces and facets.
    fn add_instance(
        &mut self,
        node: u32,
        mesh_index: u32,
        mesh: &Arc<Mesh>,
        model_bounds: Aabb,
        world_from_model: DMat4,
    ) -> Result<(), WorldError> {
        let bounds = model_bounds.transformed(&world_from_model);
        self.bounds = self.bounds.union(&bounds);
        self.instances.push(Instance {
            mesh: Arc::clone(mesh),
            mesh_index,
            node,
            world_from_model,
            model_bounds,
            bounds,
            first_surface: self.surface_count,
            first_facet: self.facet_count,
        });

        // A face has at least one triangle, so that surfaces cannot outnumber facets.
        let facets = u64::from(self.facet_count) + mesh.triangles.len() as u64;
        if facets >= u64::from(u32::MAX) {
            return Err(WorldError::TooManyFacets);
        }
        self.facet_count = facets as u32;
        self.surface_count += mesh.face_count() as u32;
        Ok(())
    }

    /// The instance that facet `facet` belongs to, as an index.
    pub fn instance_of_facet(&self, facet: u32) -> usize {
        self.instances.partition_point(|i| i.first_facet <= facet) - 1
    }

    /// Corners of a facet, world space.
    pub fn corners_of_facet(&self, facet: u32) -> [DVec3; 3] {
        let instance = &self.instances[self.instance_of_facet(facet)];
        instance.corners(facet - instance.first_facet)
    }

    /// The surface id of a facet.
    pub fn surface_of_facet(&self, facet: u32) -> u32 {
        let instance = &self.instances[self.instance_of_facet(facet)];
        instance.first_surface
            + instance.mesh.face_of_triangle((facet - instance.first_facet) as usize) as u32
    }
}

/// The nodes that are shown, depth first, each with its matrix to the world.
pub(crate) fn placed_nodes(scene: &Scene) -> Result<Vec<(u32, DMat4)>, WorldError> {
    check_roots(scene)?;

    // Walk with a stack of our own: a deep graph must not overflow the thread's.
    let mut placed = Vec::with_capacity(scene.nodes.len());
    let mut seen = vec![false; scene.nodes.len()];
    let mut stack: Vec<(u32, DMat4)> =
        scene.roots.iter().rev().map(|&r| (r, DMat4::IDENTITY)).collect();
    while let Some((index, world_from_parent)) = stack.pop() {
        let node = &scene.nodes[index as usize];
        check_references(scene, index, node)?;
        if std::mem::replace(&mut seen[index as usize], true) {
            return Err(WorldError::NotATree { node: index });
        }
        let world_from_node = world_from_parent * node.transform.matrix();
        placed.push((index, world_from_node));
        stack.extend(node.children.iter().rev().map(|&c| (c, world_from_node)));
    }
    Ok(placed)
}

/// That all roots are nodes.
fn check_roots(scene: &Scene) -> Result<(), WorldError> {
    let count = scene.nodes.len();
    match scene.roots.iter().position(|&root| root as usize >= count) {
        Some(place) => Err(WorldError::BadRoot { place, index: scene.roots[place], count }),
        None => Ok(()),
    }
}

/// That all is there that node number `number` refers to.
fn check_references(scene: &Scene, number: u32, node: &Node) -> Result<(), WorldError> {
    let there = |what, index: u32, count: usize| match (index as usize) < count {
        true => Ok(()),
        false => Err(WorldError::BadIndex { node: number, what, index, count }),
    };
    node.mesh.map_or(Ok(()), |mesh| there("mesh", mesh, scene.meshes.len()))?;
    node.camera.map_or(Ok(()), |camera| there("camera", camera, scene.cameras.len()))?;
    node.children.iter().try_for_each(|&child| there("node", child, scene.nodes.len()))
}

fn camera_in_world(camera: &Camera, world_from_node: &DMat4) -> Camera {
    let forward = world_from_node.transform_vector3(camera.focal_point - camera.position);
    let position = world_from_node.transform_point3(camera.position);
    let up = world_from_node.transform_vector3(camera.view_up);
    let distance = (camera.focal_point - camera.position).length();
    Camera {
        position,
        focal_point: position + forward.normalize_or(DVec3::NEG_Z) * distance,
        view_up: up.normalize_or(DVec3::Y),
        ..*camera
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flat_scene_has_the_same_world() {
        let mut scene = crate::builtin::scene("cubs").unwrap();
        // Hang all there is below a node that is turned, with a light and a camera.
        let roots = std::mem::take(&mut scene.roots);
        let turned = crate::NodeTransform::Matrix(DMat4::from_rotation_y(0.3));
        scene.cameras.push(Camera::look_at([1.0, 2.0, 3.0], [0.0; 3]));
        let (light, camera) = (Some(Light::default()), Some(scene.cameras.len() as u32 - 1));
        scene.add_root(Node {
            transform: turned,
            children: roots,
            light,
            camera,
            ..Node::default()
        });
        let nested = World::new(&scene).unwrap();
        scene.flatten().unwrap();
        assert!(scene.nodes.iter().all(|node| node.children.is_empty()));
        for flat in [World::new(&scene).unwrap(), nested.moved(&scene).unwrap()] {
            let places = |world: &World| {
                world.instances.iter().map(|i| (i.node, i.world_from_model)).collect::<Vec<_>>()
            };
            assert_eq!(places(&flat), places(&nested));
            assert_eq!(
                (&flat.lights, &flat.cameras, flat.bounds),
                (&nested.lights, &nested.cameras, nested.bounds)
            );
            assert_eq!(
                (flat.facet_count, flat.surface_count),
                (nested.facet_count, nested.surface_count)
            );
        }
    }

    #[test]
    fn a_bad_index_is_told_with_the_node_that_has_it() {
        let node = |children: &[u32], mesh, camera| Node {
            children: children.to_vec(),
            mesh,
            camera,
            ..Node::default()
        };
        let told = |roots: &[u32], nodes: [Node; 2]| {
            let scene = Scene { roots: roots.to_vec(), nodes: nodes.to_vec(), ..Scene::default() };
            World::new(&scene).map_or_else(|e| e.to_string(), |_| String::new())
        };
        let good = || node(&[], None, None);
        assert_eq!(told(&[1], [good(), node(&[0], None, None)]), "");
        assert_eq!(
            told(&[1], [good(), node(&[0, 7], None, None)]),
            "node 1 refers to node 7, there are 2"
        );
        assert_eq!(
            told(&[0], [node(&[1], None, None), node(&[], Some(3), None)]),
            "node 1 refers to mesh 3, there are 0"
        );
        assert_eq!(
            told(&[0, 1], [good(), node(&[], None, Some(0))]),
            "node 1 refers to camera 0, there are 0"
        );
        assert_eq!(told(&[0, 5], [good(), good()]), "roots[1] is node 5, there are 2");
    }
}
