//! Sections: what is left of a scene where planes take one side of it away, and caps on bodies that
//! they cut open.
//!
//! Each mesh that a plane crosses is clipped exactly there, faces staying faces. Where bodies are
//! closed, the cut is closed as well: a cap is one flat face with the body's material. Caps are the
//! last faces of a mesh, and [`Section`](crate::Section) names them and the edges along the cuts. A
//! cut mesh with its caps is an ordinary mesh: pictures and drawings show it, and the next plane
//! cuts it.
//!
//! In:   a scene and planes in world space. Out: the scene with meshes of its own for each instance
//!       that is cut.
//! Cost: linear in the triangles of these instances, `n log n` in the length of the cuts.
//! Source: polygons are clipped as by [Sutherland & Hodgman 1974]; the crates `i_overlay` and
//! `i_triangle` tell the inside of a cut by winding numbers and cut it into triangles.

mod caps;
mod clip;
mod gaps;
mod outline;
mod plane;
mod rings;

pub use plane::SectionPlane;

use crate::weld::Weld;
use crate::{Instance, Mesh, Scene, World, WorldError};
use plane::Heights;
use std::sync::Arc;
use vitral_exec::{Budget, Charge, Limit, Workers};

/// Bytes that a triangle takes while its mesh is cut.
const BYTES_A_TRIANGLE: u64 = 320;
/// Why a scene cannot be cut.
#[derive(Clone, Debug, thiserror::Error)]
pub enum SectionError {
    /// Its graph is unsound.
    #[error(transparent)]
    World(#[from] WorldError),
    /// A limit was reached.
    #[error(transparent)]
    Limit(#[from] Limit),
}

impl Scene {
    /// The scene without what lies in front of the planes, cut one after the other. Closed bodies
    /// get caps of their material.
    ///
    /// ```
    /// use vitral_scene::{Scene, SectionPlane, World, builtin::solids};
    ///
    /// let ball = Scene::from_mesh(solids::sphere(1.0, 32, 16));
    /// let front = SectionPlane::new([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]).unwrap();
    /// let half = ball.cut(&[front]).unwrap();
    /// assert_eq!(World::new(&half).unwrap().bounds.max.z, 0.0);
    /// ```
    ///
    /// # Errors
    /// A scene whose graph or numbers cannot be.
    pub fn cut(&self, planes: &[SectionPlane]) -> Result<Self, WorldError> {
        cut(self, planes, &Workers::single(), &Budget::default()).map_err(|error| match error {
            SectionError::World(error) => error,
            SectionError::Limit(_) => unreachable!("this budget has no limits"),
        })
    }

    /// Whether a plane has cut one of the meshes.
    pub fn is_cut(&self) -> bool {
        self.shown_meshes()
            .filter_map(|mesh| mesh.section.as_deref())
            .any(|section| !section.outline.is_empty())
    }

    /// Whether a plane has cut a closed body, which has a cap then.
    pub fn has_caps(&self) -> bool {
        let has_cap = |mesh: &Arc<Mesh>| {
            mesh.section
                .as_ref()
                .is_some_and(|section| (section.first_cap as usize) < mesh.face_count())
        };
        self.shown_meshes().any(has_cap)
    }

    /// The meshes that nodes show.
    fn shown_meshes(&self) -> impl Iterator<Item = &Arc<Mesh>> {
        self.nodes.iter().filter_map(|node| self.meshes.get(node.mesh? as usize))
    }
}

/// [`Scene::cut`] with all of `workers` and within a budget.
///
/// # Errors
/// A scene whose graph or numbers cannot be; a limit.
pub fn cut(
    scene: &Scene,
    planes: &[SectionPlane],
    workers: &Workers,
    budget: &Budget,
) -> Result<Scene, SectionError> {
    let world = World::with_workers(scene, workers)?;
    let mut scene = scene.clone();
    for mut instance in world.instances {
        // Cut the mesh of each instance by one plane after the other.
        let node = instance.node as usize;
        let mut shown = true;
        for plane in planes {
            budget.check("section")?;
            let memory = Charge::new(budget, "the section");
            memory.add(instance.mesh.triangles.len() as u64 * BYTES_A_TRIANGLE)?;
            match cut_mesh(&instance, plane, workers, budget)? {
                Cut::Whole => {}
                Cut::Nothing => shown = false,
                Cut::Partly(mesh) => instance.mesh = Arc::new(*mesh),
            }
            if !shown {
                break;
            }
        }

        // Show what is left.
        if !shown {
            scene.nodes[node].mesh = None;
        } else if !Arc::ptr_eq(&instance.mesh, &scene.meshes[instance.mesh_index as usize]) {
            scene.meshes.push(instance.mesh);
            scene.nodes[node].mesh = Some(scene.meshes.len() as u32 - 1);
        }
    }
    Ok(scene)
}

/// What is left of a mesh.
enum Cut {
    Whole,
    Nothing,
    Partly(Box<Mesh>),
}

/// Cuts the mesh of an instance.
fn cut_mesh(
    instance: &Instance,
    plane: &SectionPlane,
    workers: &Workers,
    budget: &Budget,
) -> Result<Cut, SectionError> {
    // Leave meshes alone that lie wholly on one side.
    let mesh = &*instance.mesh;
    let heights = Heights::new(instance, plane);
    let used =
        mesh.triangles.as_flattened().iter().chain(mesh.lines.as_flattened()).chain(&mesh.points);
    let (mut stays, mut goes) = (false, false);
    used.filter_map(|&v| heights.side(v))
        .for_each(|side| (stays, goes) = (stays || side < 0, goes || side > 0));
    match (stays, goes) {
        (_, false) => return Ok(Cut::Whole),
        (false, true) => return Ok(Cut::Nothing),
        (true, true) => {}
    }

    // Clip, then close.
    let weld = Weld::new(&mesh.positions, workers);
    let bodies = outline::Bodies::new(mesh, &weld, workers);
    budget.check("section")?;
    let (mut clipped, sides) = clip::clip(mesh, &weld, &heights);
    budget.check("section")?;
    let outline = outline::Outline::new(&bodies, sides, &weld);
    caps::close(&mut clipped, mesh, instance, plane, &outline);
    Ok(Cut::Partly(Box::new(clipped)))
}

#[cfg(test)]
mod tests;
