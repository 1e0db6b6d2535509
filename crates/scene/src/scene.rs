//! The scene graph: nodes with transforms, each of which may show a mesh, carry a light or a
//! camera.

use crate::{Axis, Camera, Mesh, WorldError};
use std::sync::Arc;
use vitral_frame::Texture;
use vitral_light::{Light, Material};
use vitral_math::{DMat4, DQuat, DVec3};

/// Everything there is to see, and how it is placed. Meshes and textures are shared, never copied
/// by instances.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Meshes, model space.
    pub meshes: Vec<Arc<Mesh>>,
    /// Materials that mesh parts refer to.
    pub materials: Vec<Material>,
    /// Textures that materials refer to.
    pub textures: Vec<Arc<Texture>>,
    /// All nodes. A node is in at most one `children` list and the graph has no cycle.
    pub nodes: Vec<Node>,
    /// The nodes without a parent that are shown, in order.
    pub roots: Vec<u32>,
    /// Lights of the scene as a whole, world space (those in nodes come in addition).
    pub lights: Vec<Light>,
    /// Cameras, each placed by the node that names it.
    pub cameras: Vec<Camera>,
    /// Index into [`Scene::cameras`] of the one from which the scene is seen where nothing is said
    /// about the view; `None`: the scene is framed.
    pub own_camera: Option<u32>,
    /// Global ambient light (Ia of the course), RGB, on top of the lights' own.
    pub ambient: [f32; 3],
    /// Which ways are up in models of the formats that the scene comes from, each once, that of the
    /// first model first.
    pub ups: Vec<Axis>,
    /// The animations of the files. The scene is one moment of at most one of them: that at which
    /// it was read.
    pub animations: Vec<Animation>,
    /// What was odd in the files, for the user to read.
    pub warnings: Vec<String>,
}

/// An animation that a file holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Animation {
    /// Its name, or its kind and number.
    pub name: String,
    /// When it ends, seconds.
    pub seconds: f64,
}

/// A place in the scene graph.
#[derive(Clone, Debug, Default)]
pub struct Node {
    /// For messages; may be empty.
    pub name: String,
    /// From this node's space to its parent's.
    pub transform: NodeTransform,
    /// Indices of its children in [`Scene::nodes`].
    pub children: Vec<u32>,
    /// Index into [`Scene::meshes`].
    pub mesh: Option<u32>,
    /// A light; its position and direction are in the node's space.
    pub light: Option<Light>,
    /// Index into [`Scene::cameras`]; the camera's position, focal point and up are in the node's
    /// space.
    pub camera: Option<u32>,
}

/// A node's placement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NodeTransform {
    /// Any affine matrix.
    Matrix(DMat4),
    /// Scale, then rotate, then translate.
    Parts {
        /// Translation.
        translation: DVec3,
        /// Unit quaternion.
        rotation: DQuat,
        /// Scale along the axes.
        scale: DVec3,
    },
}

impl Default for NodeTransform {
    fn default() -> Self {
        Self::Matrix(DMat4::IDENTITY)
    }
}

impl NodeTransform {
    /// As a matrix.
    pub fn matrix(&self) -> DMat4 {
        match *self {
            Self::Matrix(m) => m,
            Self::Parts { translation, rotation, scale } => {
                DMat4::from_scale_rotation_translation(scale, rotation, translation)
            }
        }
    }
}

impl Scene {
    /// A scene that shows one mesh where it is.
    pub fn from_mesh(mesh: Mesh) -> Self {
        let mut scene = Self::default();
        scene.add_mesh(mesh, DMat4::IDENTITY);
        scene
    }

    /// Adds a mesh and a root node that shows it; gives the node's index.
    pub fn add_mesh(&mut self, mesh: Mesh, parent_from_model: DMat4) -> u32 {
        self.meshes.push(Arc::new(mesh));
        self.add_instance(self.meshes.len() as u32 - 1, parent_from_model)
    }

    /// Adds a root node that shows the mesh with index `mesh` in [`Scene::meshes`]; gives the
    /// node's index. Instances share their mesh.
    pub fn add_instance(&mut self, mesh: u32, parent_from_model: DMat4) -> u32 {
        let name = self.meshes.get(mesh as usize).map_or(String::new(), |mesh| mesh.name.clone());
        let transform = NodeTransform::Matrix(parent_from_model);
        self.add_root(Node { name, transform, mesh: Some(mesh), ..Node::default() })
    }

    /// Adds a root node; gives its index.
    pub fn add_root(&mut self, node: Node) -> u32 {
        self.nodes.push(node);
        let index = self.nodes.len() as u32 - 1;
        self.roots.push(index);
        index
    }

    /// Adds a light of the scene as a whole, world space.
    pub fn add_light(&mut self, light: Light) {
        self.lights.push(light);
    }

    /// Adds a material; gives its index.
    pub fn add_material(&mut self, material: Material) -> u32 {
        self.materials.push(material);
        self.materials.len() as u32 - 1
    }

    /// Takes everything of `other` into this scene, behind what is there: several models in one
    /// picture.
    pub fn append(&mut self, other: Self) {
        // Count what is there, by which the other's indices move.
        let (meshes, materials, textures, nodes, cameras) = (
            self.meshes.len() as u32,
            self.materials.len() as u32,
            self.textures.len() as u32,
            self.nodes.len() as u32,
            self.cameras.len() as u32,
        );

        // Append meshes, materials, textures and nodes with their indices moved.
        self.meshes.extend(other.meshes.into_iter().map(|mut mesh| {
            if materials > 0 {
                let mesh = Arc::make_mut(&mut mesh);
                for material in mesh.materials_mut().flatten() {
                    *material += materials;
                }
            }
            mesh
        }));
        self.materials.extend(other.materials.into_iter().map(|mut material| {
            for texture in material.textures_mut() {
                texture.texture += textures;
            }
            material
        }));
        self.textures.extend(other.textures);
        self.nodes.extend(other.nodes.into_iter().map(|mut node| {
            node.mesh = node.mesh.map(|m| m + meshes);
            node.camera = node.camera.map(|c| c + cameras);
            node.children.iter_mut().for_each(|c| *c += nodes);
            node
        }));
        self.roots.extend(other.roots.into_iter().map(|r| r + nodes));
        self.lights.extend(other.lights);
        self.cameras.extend(other.cameras);
        // What one of them is seen from may not show the other.
        self.own_camera = None;

        // Keep the brighter ambient light, and every axis that is up.
        for k in 0..3 {
            self.ambient[k] = self.ambient[k].max(other.ambient[k]);
        }
        for up in other.ups {
            if !self.ups.contains(&up) {
                self.ups.push(up);
            }
        }
        self.animations.extend(other.animations);
        self.warnings.extend(other.warnings);
    }

    /// Makes every shown node a root where it is in the world, so that nodes can be moved one by
    /// one. Instances, lights and cameras keep their order; a node that is not shown stays as it
    /// is.
    ///
    /// # Errors
    /// A graph that is no tree, see [`WorldError`].
    pub fn flatten(&mut self) -> Result<(), WorldError> {
        let placed = crate::world::placed_nodes(self)?;
        self.roots = placed.iter().map(|(node, _)| *node).collect();
        for (node, world_from_node) in placed {
            let node = &mut self.nodes[node as usize];
            node.transform = NodeTransform::Matrix(world_from_node);
            node.children.clear();
        }
        Ok(())
    }

    /// The upward axis that models such as the first one usually have.
    pub fn usual_up(&self) -> Axis {
        self.ups.first().copied().unwrap_or_default()
    }
}
