//! The scene of a file that holds a single mesh, and the warnings that every reader gives about
//! geometry.

use vitral_math::{DMat4, DVec3};
use vitral_scene::{Mesh, Scene};

/// Adds the mesh of a file to its scene, and warns of what a renderer drops: a mesh with nothing to
/// show, vertices with coordinates that are not finite (they are kept; a renderer drops the
/// primitives that touch them).
pub(crate) fn with_mesh(scene: Scene, mesh: Mesh, file: &str) -> Scene {
    with_mesh_at(scene, mesh, None, file)
}

/// [`with_mesh`] for a mesh of whose positions `offset` was taken: its node brings it back.
pub(crate) fn with_mesh_at(
    mut scene: Scene,
    mesh: Mesh,
    offset: Option<[f64; 3]>,
    file: &str,
) -> Scene {
    let broken = mesh.positions.iter().filter(|p| !p.iter().all(|c| c.is_finite())).count();
    if broken > 0 {
        scene
            .warnings
            .push(format!("{file}: {broken} vertices have coordinates that are not finite; what they touch vanishes"));
    }
    if is_blank(&mesh) {
        scene.warnings.push(nothing_to_show(file));
        return scene;
    }
    let place =
        offset.map_or(DMat4::IDENTITY, |offset| DMat4::from_translation(DVec3::from_array(offset)));
    scene.add_mesh(mesh, place);
    scene
}

/// Whether a mesh has no triangles, lines or points.
pub(crate) fn is_blank(mesh: &Mesh) -> bool {
    mesh.triangles.is_empty() && mesh.lines.is_empty() && mesh.points.is_empty()
}

/// The warning of a file without triangles, lines and points.
pub(crate) fn nothing_to_show(file: &str) -> String {
    format!("{file}: the file holds nothing to show")
}
