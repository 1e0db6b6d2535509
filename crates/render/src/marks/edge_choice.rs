//! Which edges of an instance are drawn: those of the wanted classes, and none whose faces are not
//! seen by themselves.
//!
//! The classes are those of vector drawings (crate `draw`), decided for whole edges by their first
//! two faces:
//!
//! | class | an edge |
//! |---|---|
//! | contour | of a face that faces the viewer and one that does not |
//! | boundary | of one face |
//! | crease | of two faces at an angle above [`CREASE_ANGLE`], or of more than two |
//! | material | of faces with different materials |
//! | section | along which a plane of section has cut a face |
//! | smooth | of any face |
//!
//! Cost: constant for each edge, and a pass over the faces where it counts how they face.
//! Source: the classes are those of [Bénard & Hertzmann 2019], section 2.

use crate::{Lines, PreparedView, Settings};
use vitral_exec::Workers;
use vitral_frame::LineClasses;
use vitral_frame::drawing::LineClass;
use vitral_math::{DVec3, DVec4, func};
use vitral_scene::normals::face_normals;
use vitral_scene::{Edge, EdgeKind, Instance, Mesh};

/// Edges at larger angles are creases, as in drawings: 30 degrees in radians.
const CREASE_ANGLE: f64 = std::f64::consts::FRAC_PI_6;

/// The edges of one instance that are drawn.
pub(super) struct EdgeChoice<'a> {
    mesh: &'a Mesh,
    classes: LineClasses,
    /// Cosine of [`CREASE_ANGLE`].
    crease: f32,
    /// By face, whether it faces the viewer (1), away (-1) or is seen edge-on (0); empty where it
    /// does not count.
    facing: Vec<i8>,
    /// Unit normals of faces, model space; empty where they do not count.
    normals: Vec<[f32; 3]>,
    /// By material, whether it shows its front alone; empty where backs count as other faces.
    front_only: Vec<bool>,
}

impl<'a> EdgeChoice<'a> {
    pub(super) fn new(
        view: &PreparedView<'_>,
        instance: &'a Instance,
        settings: &Settings,
        workers: &Workers,
    ) -> Self {
        let (mesh, classes) = (&*instance.mesh, settings.picture.edge_classes);
        let materials = &view.session.scene.materials;
        let hides = |material: Option<u32>| {
            material
                .and_then(|m| materials.get(m as usize))
                .is_some_and(|m| m.front_only && !m.double_sided)
        };
        let hides_backs = settings.picture.lines != Lines::Wireframe
            && mesh.parts.iter().any(|p| hides(p.material));
        let front_only = if hides_backs {
            (0..materials.len()).map(|m| hides(Some(m as u32))).collect()
        } else {
            Vec::new()
        };

        // Turn the faces to the viewer.
        let names_contours = classes.has(LineClass::Contour) && !classes.has(LineClass::Smooth);
        let (mut facing, mut normals) = (Vec::new(), Vec::new());
        if names_contours || hides_backs {
            normals = face_normals(mesh, workers);
            let viewer = instance.world_from_model.inverse() * view.viewer();
            facing =
                (0..mesh.face_count()).map(|f| facing_of(mesh, f, normals[f], viewer)).collect();
        }
        Self { mesh, classes, crease: func::cos(CREASE_ANGLE) as f32, facing, normals, front_only }
    }

    /// Whether an edge is drawn.
    pub(super) fn has(&self, edge: &Edge) -> bool {
        let mut faces = edge.faces.iter().filter(|&&face| face != Edge::NO_FACE);
        if !self.front_only.is_empty() && faces.clone().all(|&face| self.is_hidden_back(face)) {
            return false;
        }
        self.classes.has(LineClass::Smooth) && !edge_is_cut(self.mesh, edge)
            || self.classes.has(LineClass::Section) && edge_is_cut(self.mesh, edge)
            || self.classes.has(LineClass::Boundary) && edge.kind == EdgeKind::Boundary
            || self.classes.has(LineClass::Crease)
                && (edge.kind == EdgeKind::NonManifold || edge.cosine < self.crease)
            || self.classes.has(LineClass::Contour) && self.is_contour(edge)
            || self.classes.has(LineClass::Material) && {
                let first = faces.next().map(|&face| self.material(face));
                faces.any(|&face| Some(self.material(face)) != first)
            }
    }

    /// Whether a face of the edge faces the viewer and the other does not.
    fn is_contour(&self, edge: &Edge) -> bool {
        let [a, b] = edge.faces;
        if b == Edge::NO_FACE || self.facing.is_empty() {
            return false;
        }
        let ([n, m], [s, t]) =
            ([a, b].map(|f| self.normals[f as usize]), [a, b].map(|f| self.facing[f as usize]));
        // Where both run along the edge in the same direction, the cosine is that of one of them
        // turned.
        let dot = n[0] * m[0] + n[1] * m[1] + n[2] * m[2];
        let t = if dot * edge.cosine < 0.0 { -t } else { t };
        (s > 0) != (t > 0)
    }

    fn material(&self, face: u32) -> Option<u32> {
        self.mesh.material_of_triangle(self.mesh.face_triangles(face as usize).start)
    }

    fn is_hidden_back(&self, face: u32) -> bool {
        let is_front_only = |m: u32| self.front_only.get(m as usize).copied().unwrap_or(false);
        self.facing[face as usize] < 0 && self.material(face).is_some_and(is_front_only)
    }
}

/// Whether an edge runs along a cut by a plane of section.
fn edge_is_cut(mesh: &Mesh, edge: &Edge) -> bool {
    mesh.section.as_ref().is_some_and(|section| section.has_edge(edge.ends[0], edge.ends[1]))
}

/// Which way a face looks: 1 to the viewer, -1 away, 0 across. `viewer` is a place or, without `w`,
/// a direction, model space.
fn facing_of(mesh: &Mesh, face: usize, normal: [f32; 3], viewer: DVec4) -> i8 {
    let Some(&corner) = mesh.face_corners(face).first() else { return 0 };
    let [normal, place] =
        [normal, mesh.positions[corner as usize]].map(|v| DVec3::from_array(v.map(f64::from)));
    let to_viewer = viewer.truncate() - place * viewer.w;
    let cosine = normal.dot(to_viewer.normalize_or_zero());
    if cosine.abs() < 1e-6 { 0 } else { cosine.signum() as i8 }
}
