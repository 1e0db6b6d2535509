//! The scene graph walked once: instances, lights and cameras in world space, and the numbering of surfaces.

use crate::{Camera, Mesh, Scene};
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
    /// Cameras in world space, in the order of [`Scene::cameras`]; one that several nodes name, in scene order.
    pub cameras: Vec<Camera>,
    /// The box round all instances.
    pub bounds: Aabb,
    /// For each mesh of the scene, the boxes round its runs of triangles ([`Mesh::run_bounds`]), model space.
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
        /// The node.
        node: u32,
    },
    /// An index points nowhere.
    #[error("node {node} refers to {what} {index}, there are {count}")]
    BadIndex {
        /// The node.
        node: u32,
        /// What it refers to.
        what: &'static str,
        /// The index.
        index: u32,
        /// How many there are.
        count: usize,
    },
    /// More triangles than ids.
    #[error("the scene has more than 4294967294 triangles")]
    TooManyFacets,
}

impl World {
    /// Walks the graph from its roots. Bounds of each mesh are computed once, however many instances it has.
    pub fn new(scene: &Scene) -> Result<Self, WorldError> {
        Self::with_workers(scene, &Workers::single())
    }

    /// [`Self::new`] with all of `workers`.
    pub fn with_workers(scene: &Scene, workers: &Workers) -> Result<Self, WorldError> {
        let run_bounds: Vec<Vec<Aabb>> = scene.meshes.iter().map(|m| m.run_bounds(workers)).collect();
        let bounds: Vec<Aabb> = scene.meshes.iter().zip(&run_bounds).map(|(m, runs)| m.bounds_from(runs)).collect();
        let mut world = Self { lights: scene.lights.clone(), bounds: Aabb::EMPTY, run_bounds, ..Self::default() };
        let mut seen = vec![false; scene.nodes.len()];
        // A stack of our own: a deep graph must not overflow the thread's.
        let mut cameras: Vec<(u32, Camera)> = Vec::new();
        let mut stack: Vec<(u32, DMat4)> = scene.roots.iter().rev().map(|&r| (r, DMat4::IDENTITY)).collect();
        let (mut surfaces, mut facets) = (0u64, 0u64);
        while let Some((index, world_from_parent)) = stack.pop() {
            let count = scene.nodes.len();
            let bad = |what, index: u32, count| WorldError::BadIndex { node: index, what, index, count };
            let node = scene.nodes.get(index as usize).ok_or(bad("node", index, count))?;
            if std::mem::replace(&mut seen[index as usize], true) {
                return Err(WorldError::NotATree { node: index });
            }
            let world_from_node = world_from_parent * node.transform.matrix();
            if let Some(m) = node.mesh {
                let mesh = scene.meshes.get(m as usize).ok_or(bad("mesh", m, scene.meshes.len()))?;
                let model_bounds = bounds[m as usize];
                let bounds = model_bounds.transformed(&world_from_node);
                world.bounds = world.bounds.union(&bounds);
                world.instances.push(Instance {
                    mesh: Arc::clone(mesh),
                    mesh_index: m,
                    node: index,
                    world_from_model: world_from_node,
                    model_bounds,
                    bounds,
                    first_surface: surfaces as u32,
                    first_facet: facets as u32,
                });
                surfaces += mesh.face_count() as u64;
                facets += mesh.triangles.len() as u64;
                if facets >= u64::from(u32::MAX) {
                    return Err(WorldError::TooManyFacets);
                }
            }
            if let Some(light) = &node.light {
                world.lights.push(light.transformed(&world_from_node));
            }
            if let Some(c) = node.camera {
                let camera = scene.cameras.get(c as usize).ok_or(bad("camera", c, scene.cameras.len()))?;
                cameras.push((c, camera_in_world(camera, &world_from_node)));
            }
            stack.extend(node.children.iter().rev().map(|&c| (c, world_from_node)));
        }
        cameras.sort_by_key(|&(c, _)| c);
        world.cameras = cameras.into_iter().map(|(_, camera)| camera).collect();
        (world.surface_count, world.facet_count) = (surfaces as u32, facets as u32);
        Ok(world)
    }

    /// The instance that facet `facet` belongs to, as an index.
    pub fn instance_of_facet(&self, facet: u32) -> usize {
        self.instances.partition_point(|i| i.first_facet <= facet) - 1
    }

    /// The surface id of a facet.
    pub fn surface_of_facet(&self, facet: u32) -> u32 {
        let instance = &self.instances[self.instance_of_facet(facet)];
        instance.first_surface + instance.mesh.face_of_triangle((facet - instance.first_facet) as usize) as u32
    }
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
