//! The readers of model formats, and what they share after reading: the usual upward axis of the
//! format, and materials for vertex colours. Scene files refer to models and therefore stand above
//! this file.

#[cfg(feature = "gltf")]
use crate::gltf;
use crate::moment::Moment;
#[cfg(feature = "obj")]
use crate::obj;
#[cfg(feature = "off")]
use crate::off;
#[cfg(feature = "ply")]
use crate::ply;
#[cfg(feature = "stl")]
use crate::stl;
use crate::{Error, Format, Resolver, colored};
use vitral_exec::Workers;
use vitral_scene::{Axis, Scene, normals};

/// Reads a file of a model format. `None` for scene files, which are no model format.
pub(crate) fn load(
    format: Format,
    bytes: &[u8],
    file: &str,
    resolver: &dyn Resolver,
    workers: &Workers,
    moment: Option<&Moment>,
) -> Option<Result<Scene, Error>> {
    let scene = match format {
        #[cfg(feature = "gltf")]
        Format::Gltf | Format::Glb => gltf::load_at(bytes, file, resolver, workers, moment),
        #[cfg(feature = "obj")]
        Format::Obj => obj::load(bytes, file, resolver, workers),
        #[cfg(feature = "stl")]
        Format::Stl => stl::load(bytes, file, workers),
        #[cfg(feature = "ply")]
        Format::Ply => ply::load(bytes, file, resolver, workers),
        #[cfg(feature = "off")]
        Format::Off => off::load(bytes, file, workers),
        Format::SceneJson => return None,
        #[cfg(not(all(
            feature = "gltf",
            feature = "obj",
            feature = "stl",
            feature = "ply",
            feature = "off"
        )))]
        _ => Err(Error::Unsupported { file: file.to_owned(), what: format.left_out() }),
    };
    Some(scene.map(|scene| completed(scene, format, file, workers)))
}

/// The scene with what its format implies and its file does not say.
fn completed(mut scene: Scene, format: Format, file: &str, workers: &Workers) -> Scene {
    scene.meshes.iter_mut().for_each(|mesh| normals::make_measurable(mesh, workers));
    scene.ups = vec![if format == Format::Stl { Axis::PlusZ } else { Axis::PlusY }];

    // The default material of glTF is opaque, whatever the alpha of `COLOR_0`.
    let alpha_counts = !matches!(format, Format::Gltf | Format::Glb);
    if alpha_counts {
        colored::ignore_clear_colors(&mut scene, file);
    }
    colored::give_materials(&mut scene, alpha_counts);
    scene
}
