//! A material for surfaces that have colours at their vertices and no material: white, so that they
//! are seen in these colours.

use std::sync::Arc;
use vitral_light::{AlphaMode, Material, Reflectance};
use vitral_scene::{Mesh, Scene};

/// Makes colours opaque that would leave nothing of a mesh to be seen: all of them have alpha 0,
/// which programs write that do not know alpha. Warns of it.
pub(crate) fn ignore_clear_colors(scene: &mut Scene, file: &str) {
    let is_clear = |mesh: &Mesh| {
        let colors = mesh.colors.as_ref().filter(|colors| !colors.values.is_empty());
        colors.is_some_and(|colors| colors.values.iter().all(|color| color[3] == 0.0))
    };
    let clear: Vec<usize> =
        (0..scene.meshes.len()).filter(|&number| is_clear(&scene.meshes[number])).collect();
    for &number in &clear {
        let colors = Arc::make_mut(&mut scene.meshes[number]).colors.as_mut();
        colors.into_iter().flat_map(|colors| &mut colors.values).for_each(|color| color[3] = 1.0);
    }
    if !clear.is_empty() {
        scene.warnings.push(format!(
            "{file}: all colours have alpha 0 and would be invisible; alpha is ignored"
        ));
    }
}

/// Gives parts without a material one if their mesh has colours; where some of these are not opaque
/// it blends, if `alpha_counts`.
pub(crate) fn give_materials(scene: &mut Scene, alpha_counts: bool) {
    let bare = |mesh: &Mesh| {
        mesh.colors.is_some() && mesh.parts.iter().any(|part| part.material.is_none())
    };
    let mut known = [None; 2];
    for number in 0..scene.meshes.len() {
        let Some(colors) =
            scene.meshes[number].colors.as_ref().filter(|_| bare(&scene.meshes[number]))
        else {
            continue;
        };
        let blends = alpha_counts && colors.values.iter().any(|color| color[3] < 1.0);
        let index =
            *known[usize::from(blends)].get_or_insert_with(|| scene.add_material(white(blends)));
        for part in &mut Arc::make_mut(&mut scene.meshes[number]).parts {
            part.material.get_or_insert(index);
        }
    }
}

/// The default material with the diffuse colour left to the vertices.
fn white(blends: bool) -> Material {
    let mut material = Material { name: "default".to_owned(), ..Material::default() };
    if let Reflectance::Phong { ka, kd, .. } = &mut material.reflectance {
        (*ka, *kd) = ([1.0; 3], [1.0; 3]);
    }
    if blends {
        material.alpha_mode = AlphaMode::Blend;
    }
    material
}

#[cfg(test)]
mod tests {
    use crate::{NoFiles, load};
    use vitral_exec::Workers;
    use vitral_light::{AlphaMode, Reflectance};

    #[test]
    fn colours_of_vertices_are_not_dimmed_and_their_opacity_counts() {
        let square = |alphas: &str| {
            let corners = ["0 0 0", "1 0 0", "1 1 0", "0 1 0"]
                .map(|p| format!("{p} 255 128 0 {alphas}\n"))
                .concat();
            format!("COFF\n4 1 0\n{corners}4 0 1 2 3\n")
        };
        for (alphas, mode) in [("255", AlphaMode::Opaque), ("128", AlphaMode::Blend)] {
            let scene = load(square(alphas).as_bytes(), "square.off", &NoFiles, &Workers::single())
                .unwrap();
            let material = &scene.materials[scene.meshes[0].parts[0].material.unwrap() as usize];
            assert_eq!(material.alpha_mode, mode);
            assert!(
                matches!(material.reflectance, Reflectance::Phong { kd: [1.0, 1.0, 1.0], .. }),
                "{material:?}"
            );
        }
        let clear =
            load(square("0").as_bytes(), "square.off", &NoFiles, &Workers::single()).unwrap();
        assert_eq!(clear.materials[0].alpha_mode, AlphaMode::Opaque);
        assert_eq!(clear.meshes[0].colors.as_ref().unwrap().values[0][3], 1.0);
        assert!(clear.warnings[0].contains("alpha 0"), "{:?}", clear.warnings);
        let plain = load(
            b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
            "a.off",
            &NoFiles,
            &Workers::single(),
        )
        .unwrap();
        assert!(plain.materials.is_empty());
    }

    #[test]
    fn the_default_material_of_gltf_is_opaque_whatever_the_colours() {
        // Three times the same four bytes, as positions and as colours with an alpha of 1/255.
        let text = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
            "meshes":[{"primitives":[{"attributes":{"POSITION":0,"COLOR_0":1}}]}],
            "accessors":[{"bufferView":0,"componentType":5121,"count":3,"type":"VEC3"},
            {"bufferView":0,"componentType":5121,"count":3,"type":"VEC4","normalized":true}],
            "bufferViews":[{"buffer":0,"byteLength":12,"byteStride":4}],
            "buffers":[{"byteLength":12,"uri":"data:;base64,AQIDAQECAwEBAgMB"}]}"#;
        let scene = load(text.as_bytes(), "a.gltf", &NoFiles, &Workers::single()).unwrap();
        let mesh = &scene.meshes[0];
        assert_eq!(mesh.colors.as_ref().unwrap().values[0][3], 1.0 / 255.0);
        let material = &scene.materials[mesh.parts[0].material.unwrap() as usize];
        assert_eq!((material.alpha_mode, material.opacity), (AlphaMode::Opaque, 1.0));
    }
}
