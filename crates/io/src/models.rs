//! The readers of model formats, and what they share after reading: the usual upward axis of the format, and materials
//! for vertex colours. Scene files refer to models and therefore stand above this file.

use crate::{Error, Format, Resolver, colored, gltf, obj, off, ply, stl};
use vitral_exec::Workers;
use vitral_scene::{Axis, Scene, normals};

/// Reads a file of a model format. `None` for scene files, which are no model format.
pub(crate) fn load(
    format: Format,
    bytes: &[u8],
    file: &str,
    resolver: &dyn Resolver,
    workers: &Workers,
) -> Option<Result<Scene, Error>> {
    let scene = match format {
        Format::Gltf | Format::Glb => gltf::load(bytes, file, resolver, workers),
        Format::Obj => obj::load(bytes, file, resolver, workers),
        Format::Stl => stl::load(bytes, file, workers),
        Format::Ply => ply::load(bytes, file, resolver, workers),
        Format::Off => off::load(bytes, file, workers),
        Format::SceneJson => return None,
    };
    Some(scene.map(|scene| completed(scene, format, workers)))
}

/// The scene with what its format implies and its file does not say.
fn completed(mut scene: Scene, format: Format, workers: &Workers) -> Scene {
    scene.meshes.iter_mut().for_each(|mesh| normals::make_measurable(mesh, workers));
    scene.ups = vec![if format == Format::Stl { Axis::PlusZ } else { Axis::PlusY }];

    // The default material of glTF is opaque, whatever the alpha of `COLOR_0`.
    let alpha_counts = !matches!(format, Format::Gltf | Format::Glb);
    colored::give_materials(&mut scene, alpha_counts);
    scene
}
