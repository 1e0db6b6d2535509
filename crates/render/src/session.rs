//! What outlives a frame: the flattened scene, derived data of its meshes, and memory to reuse.
//!
//! Pictures with a fresh session and with a used one are equal.

use crate::cache::{Cache, PerMesh};
use crate::cull::{backface, opacity::is_layered};
use crate::{Error, Transparency};
use std::any::Any;
use std::convert::Infallible;
use std::sync::{Arc, Mutex, OnceLock};
use vitral_exec::Workers;
use vitral_frame::Frame;
use vitral_light::AlphaMode;
use vitral_math::{Aabb, DMat4, DVec4, Mat4, Vec3};
use vitral_raster::{BackFaces, Batch, ScreenVertex, Tile, TileGrid, Unsorted};
use vitral_scene::bodies::{self, Side};
use vitral_scene::edges::Edge;
use vitral_scene::{
    Attribute, Instance, NodeTransform, Part, Scene, SharedPlanes, Solids, World, tangents,
};

/// A scene made ready for many frames. Its nodes may be moved ([`Session::place`]); all else cannot
/// change under it: edit a copy and make a new session.
#[derive(Debug)]
pub struct Session {
    pub(crate) scene: Arc<Scene>,
    pub(crate) world: World,
    meshes: Arc<Vec<MeshKnowledge>>,
    planes: OnceLock<SharedPlanes>,
    pub(crate) grid: Option<TileGrid>,
    pub(crate) spare_vertices: Mutex<Vec<Vec<ScreenVertex>>>,
    pub(crate) spare_batches: Mutex<Vec<Batch>>,
    pub(crate) spare_unsorted: Mutex<Vec<Unsorted>>,
    pub(crate) spare_picture: Mutex<Vec<[u8; 4]>>,
    pub(crate) spare_tiles: Mutex<Vec<Tile>>,
    /// What algorithms keep between frames.
    pub(crate) cache: Cache,
}

/// What is found out about a mesh when it is first needed.
#[derive(Debug, Default)]
struct MeshKnowledge {
    solids: OnceLock<Solids>,
    /// Of what is opaque, if that is not all and not nothing; without and with blended materials.
    opaque_solids: [OnceLock<Option<Solids>>; 2],
    edges: OnceLock<Vec<Edge>>,
    sides: OnceLock<Vec<Side>>,
    centred: OnceLock<Vec<[f32; 3]>>,
    /// For each set of texture coordinates.
    tangents: [OnceLock<Option<Attribute<[f32; 4]>>>; 2],
}

/// Half sides of its box that a mesh lies away from the origin before its positions are moved
/// there.
const FAR: f64 = 64.0;

/// The middle of a box far away from the origin, along the axes along which it is; `None` if it is
/// along none.
fn far_middle(bounds: &Aabb) -> Option<Vec3> {
    let (middle, half) = (bounds.center(), bounds.size().max_element() * 0.5);
    let far = middle.to_array().map(|m| if m.abs() > FAR * half { m as f32 } else { 0.0 });
    (far != [0.0; 3] && middle.is_finite()).then(|| Vec3::from_array(far))
}

impl MeshKnowledge {
    fn count(&self) -> usize {
        let known = [
            self.solids.get().is_some(),
            self.opaque_solids.iter().any(|s| s.get().is_some()),
            self.edges.get().is_some(),
            self.sides.get().is_some(),
            self.centred.get().is_some(),
            self.tangents.iter().any(|t| t.get().is_some()),
        ];
        known.into_iter().filter(|known| *known).count()
    }
}

impl Session {
    /// Flattens the scene and checks that its parts fit together.
    ///
    /// # Errors
    /// [`Error::Scene`] for parts that do not fit.
    pub fn new(scene: Arc<Scene>) -> Result<Self, Error> {
        Self::with_workers(scene, &Workers::single())
    }

    /// [`Self::new`] with all of `workers`.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_workers(scene: Arc<Scene>, workers: &Workers) -> Result<Self, Error> {
        for mesh in &scene.meshes {
            mesh.check_with(workers).map_err(Error::Scene)?;
            let materials = scene.materials.len();
            if let Some(bad) = mesh.materials().find(|&m| m as usize >= materials) {
                return Err(Error::Scene(format!(
                    "mesh `{}`: material {bad}, there are {materials}",
                    mesh.name
                )));
            }
        }
        let mut materials = scene.materials.clone();
        for material in &mut materials {
            let name = material.name.clone();
            let count = scene.textures.len();
            if let Some(bad) = material.textures_mut().find(|t| t.texture as usize >= count) {
                return Err(Error::Scene(format!(
                    "material `{name}`: texture {}, there are {count}",
                    bad.texture
                )));
            }
        }
        let world = World::with_workers(&scene, workers)?;
        let meshes = Arc::new(scene.meshes.iter().map(|_| MeshKnowledge::default()).collect());
        Ok(Self::assemble(scene, world, meshes, Cache::default()))
    }

    fn assemble(
        scene: Arc<Scene>,
        world: World,
        meshes: Arc<Vec<MeshKnowledge>>,
        cache: Cache,
    ) -> Self {
        Self {
            scene,
            world,
            meshes,
            planes: OnceLock::new(),
            grid: None,
            spare_vertices: Mutex::default(),
            spare_batches: Mutex::default(),
            spare_unsorted: Mutex::default(),
            spare_picture: Mutex::default(),
            spare_tiles: Mutex::default(),
            cache,
        }
    }

    /// Another session of the same scene, for another thread. Both share the derived data of the
    /// meshes, whichever finds it out, and the acceleration structures that are built already.
    #[must_use]
    pub fn fork(&self) -> Self {
        let (scene, meshes) = (Arc::clone(&self.scene), Arc::clone(&self.meshes));
        Self::assemble(scene, self.world.clone(), meshes, self.cache.fork())
    }

    /// Moves nodes: each of `nodes` gets the transform to its parent that stands beside it. What is
    /// known of the meshes stays; what depends on where they are is found out anew when it is
    /// needed.
    ///
    /// # Errors
    /// [`Error::Scene`] for a node that is not there, and for a transform that is not affine;
    /// nothing is moved then.
    pub fn place(&mut self, nodes: &[(u32, DMat4)]) -> Result<(), Error> {
        let count = self.scene.nodes.len();
        for (node, transform) in nodes {
            if *node as usize >= count {
                return Err(Error::Scene(format!("there is no node {node}, there are {count}")));
            }
            if !transform.is_finite() || transform.row(3) != DVec4::W {
                return Err(Error::Scene(format!(
                    "the transform of node {node} is no finite affine matrix"
                )));
            }
        }

        // Move the nodes of this session's scene.
        let scene = Arc::make_mut(&mut self.scene);
        for &(node, transform) in nodes {
            scene.nodes[node as usize].transform = NodeTransform::Matrix(transform);
        }
        self.world = self.world.moved(scene)?;
        self.planes = OnceLock::new();
        self.cache.forget_placed();
        Ok(())
    }

    /// Takes back a picture that the caller has done with; the next one of its size is made in the
    /// same memory.
    pub fn recycle(&mut self, frame: Frame) {
        if let Some(color) = frame.color {
            self.spare_picture = Mutex::new(color.into_data());
        }
    }

    /// The scene.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// The flattened scene.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// What algorithms keep between frames.
    pub fn cache(&self) -> &Cache {
        &self.cache
    }

    /// The cached values of type `T`, one for each mesh.
    pub fn per_mesh<T: Any + Send + Sync>(&self) -> Arc<PerMesh<T>> {
        let Ok(values) = self
            .cache
            .get_or_build((), || Ok::<_, Infallible>(PerMesh::new(self.scene.meshes.len())));
        values
    }

    /// An instance's positions as they are brought to clip space, and by which matrix. A mesh far
    /// away from the origin of its model is moved there first, which costs no digit; single
    /// precision would lose some as its products are added up.
    pub(crate) fn placed_positions<'a>(
        &'a self,
        instance: &'a Instance,
        clip_from_world: &DMat4,
    ) -> (&'a [[f32; 3]], Mat4) {
        let clip_from_model = *clip_from_world * instance.world_from_model;
        let Some(middle) = far_middle(&instance.model_bounds) else {
            return (&instance.mesh.positions, clip_from_model.as_mat4());
        };
        let centred = self.meshes[instance.mesh_index as usize].centred.get_or_init(|| {
            let middle = middle.to_array();
            instance.mesh.positions.iter().map(|p| [0, 1, 2].map(|k| p[k] - middle[k])).collect()
        });
        (centred, (clip_from_model * DMat4::from_translation(middle.as_dvec3())).as_mat4())
    }

    /// The planes that several facets lie in.
    pub fn planes(&self, workers: &Workers) -> &SharedPlanes {
        self.planes.get_or_init(|| SharedPlanes::new(&self.world, workers))
    }

    /// Whether a mesh is closed, consistently wound and wound outwards, and which of its bodies
    /// are.
    pub fn solids(&self, mesh: u32, workers: &Workers) -> &Solids {
        let known = &self.meshes[mesh as usize].solids;
        known.get_or_init(|| Solids::of(&self.scene.meshes[mesh as usize], workers))
    }

    /// Whether back faces of a mesh can never be seen from outside: neither past its skin nor
    /// through a window in it.
    pub fn is_solid(&self, mesh: u32, transparency: Transparency, workers: &Workers) -> bool {
        // What is opaque is asked about first: of a mesh with windows that is known already.
        let opaque = self.opaque_solids(mesh, transparency, workers);
        opaque.is_none_or(|solids| backface::applies(solids.solidity))
            && backface::applies(self.solids(mesh, workers).solidity)
    }

    /// Which of a mesh's opaque triangles are never seen from behind, from outside the mesh.
    pub fn back_faces(
        &self,
        mesh: u32,
        transparency: Transparency,
        workers: &Workers,
    ) -> BackFaces<'_> {
        let solids = self
            .opaque_solids(mesh, transparency, workers)
            .unwrap_or_else(|| self.solids(mesh, workers));
        match solids.some() {
            _ if backface::applies(solids.solidity) => BackFaces::Dropped,
            Some(triangles) => BackFaces::DroppedOf(triangles),
            None => BackFaces::Kept,
        }
    }

    /// The solids that the opaque triangles of a mesh make by themselves, if that is not all and
    /// not nothing.
    fn opaque_solids(
        &self,
        mesh: u32,
        transparency: Transparency,
        workers: &Workers,
    ) -> Option<&Solids> {
        let known =
            &self.meshes[mesh as usize].opaque_solids[usize::from(!transparency.sees_through())];
        let mesh = &self.scene.meshes[mesh as usize];
        let make = || {
            let is_opaque = |part: &&Part| {
                let material = part.material.and_then(|m| self.scene.materials.get(m as usize));
                !is_layered(material, transparency)
            };
            let opaque: Vec<_> =
                mesh.parts.iter().filter(is_opaque).map(|part| part.triangles.clone()).collect();
            let count: usize = opaque.iter().map(|triangles| triangles.len()).sum();
            (count != 0 && count != mesh.triangles.len())
                .then(|| Solids::of_some(mesh, &opaque, workers))
        };
        known.get_or_init(make).as_ref()
    }

    /// Forgets what the steps of a picture have found out for earlier ones: each picture of the
    /// steps is the first. Light from other surfaces stays, which has no steps, and the background.
    pub(crate) fn forget(&mut self) {
        self.meshes =
            Arc::new(self.scene.meshes.iter().map(|_| MeshKnowledge::default()).collect());
        self.planes = OnceLock::new();
        self.cache.forget_frames();
    }

    /// How many things were found out for earlier pictures: properties of meshes, trees, structures
    /// for rays, shadows.
    pub(crate) fn known(&self) -> u64 {
        let of_meshes: usize = self.meshes.iter().map(MeshKnowledge::count).sum();
        (of_meshes + self.cache.results()) as u64
    }

    /// The tangents of a mesh: its own, or along a set of texture coordinates, if it has these and
    /// normals.
    pub(crate) fn tangents(&self, mesh: u32, set: u32) -> Option<&Attribute<[f32; 4]>> {
        if let Some(own) = &self.scene.meshes[mesh as usize].tangents {
            return Some(own);
        }
        let known = self.meshes[mesh as usize].tangents.get(set as usize)?;
        known.get_or_init(|| tangents(&self.scene.meshes[mesh as usize], set as usize)).as_ref()
    }

    /// For each triangle where its body is; asked of transparent materials where any bends light.
    /// One whose index is 1 is a medium, too: a bubble in glass.
    pub(crate) fn sides(&self, mesh: u32, workers: &Workers) -> &[Side] {
        let known = &self.meshes[mesh as usize].sides;
        let is_medium = |material: Option<u32>| {
            let material = material.and_then(|m| self.scene.materials.get(m as usize));
            material.is_some_and(|m| m.alpha_mode == AlphaMode::Blend)
        };
        known.get_or_init(|| {
            let any = (0..self.scene.materials.len() as u32).any(|m| self.bends(Some(m)));
            bodies::sides(&self.scene.meshes[mesh as usize], |m| any && is_medium(m), workers)
        })
    }

    fn bends(&self, material: Option<u32>) -> bool {
        let material = material.and_then(|m| self.scene.materials.get(m as usize));
        material.is_some_and(|m| m.alpha_mode == AlphaMode::Blend && m.ior != 1.0)
    }

    /// Names of the materials that bend light, some of whose surfaces are not closed.
    pub(crate) fn sheets(&self, workers: &Workers) -> Vec<String> {
        let mut sheets = vec![false; self.scene.materials.len()];
        for instance in &self.world.instances {
            for part in instance.mesh.parts.iter().filter(|p| self.bends(p.material)) {
                let range = part.triangles.start as usize..part.triangles.end as usize;
                let sides = &self.sides(instance.mesh_index, workers)[range];
                sheets[part.material.unwrap_or_default() as usize] |= sides.contains(&Side::None);
            }
        }
        let named = self.scene.materials.iter().zip(sheets).filter(|(_, sheet)| *sheet);
        named.map(|(m, _)| m.name.clone()).collect()
    }

    pub(crate) fn edges(&self, mesh: u32, workers: &Workers) -> &[Edge] {
        let known = &self.meshes[mesh as usize].edges;
        known.get_or_init(|| {
            vitral_scene::edges::edges(&self.scene.meshes[mesh as usize], 0.0, workers)
        })
    }
}
