//! The images that comments of a PLY file name, as materials of runs of faces.

use crate::Resolver;
use crate::file_name::stem;
use crate::textures::{Requests, Usage};
use vitral_exec::Workers;
use vitral_light::{Material, Reflectance, TextureRef};
use vitral_scene::{Mesh, Part, Scene};

/// Gives the mesh materials with the images. `runs` are the ends of runs of triangles, each with
/// the number of its image; without any, all triangles show the first. An image that cannot be had
/// is a warning.
pub(super) fn add(
    mesh: &mut Mesh,
    scene: &mut Scene,
    runs: &[(u32, i64)],
    images: &[(u64, String)],
    file: &str,
    resolver: &dyn Resolver,
    workers: &Workers,
) {
    if images.is_empty() || mesh.uvs.is_empty() || mesh.triangles.is_empty() {
        return;
    }
    // Images lie beside the file, whose own folder the resolver knows.
    let label = file.rsplit('/').next().unwrap_or(file);
    let mut requests = Requests::default();
    let asked: Vec<u32> =
        images.iter().map(|(line, name)| requests.add(label, *line, name, Usage::Color)).collect();
    let loaded = requests.load(resolver, workers);
    scene.textures.extend(loaded.textures);
    let told = loaded
        .warnings
        .iter()
        .map(|w| w.strip_prefix(label).map_or_else(|| w.clone(), |w| format!("{file}{w}")));
    scene.warnings.extend(told);

    // Make a material of each image that was loaded.
    let materials: Vec<Option<u32>> = images
        .iter()
        .zip(asked)
        .map(|((_, name), number)| {
            let texture = loaded.index[number as usize]?;
            let white =
                Reflectance::Phong { ka: [1.0; 3], kd: [1.0; 3], ks: [0.0; 3], shininess: 1.0 };
            let base_texture = Some(TextureRef::new(texture));
            Some(scene.add_material(Material {
                name: stem(name),
                reflectance: white,
                base_texture,
                ..Material::default()
            }))
        })
        .collect();

    // Cut the mesh into parts by image.
    let whole = [(mesh.triangles.len() as u32, 0)];
    let runs = if runs.is_empty() { &whole } else { runs };
    let starts = std::iter::once(0).chain(runs.iter().map(|r| r.0));
    let material = |image: i64| usize::try_from(image).ok().and_then(|i| *materials.get(i)?);
    let part = |(start, &(end, image))| Part {
        name: String::new(),
        triangles: start..end,
        material: material(image),
    };
    mesh.parts = starts.zip(runs).map(part).collect();
}
