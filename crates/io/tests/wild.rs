//! Files as programs write them in the wild, each with the shape, the colours and the warning that
//! are right for it.

use crate::common::Folder;
use std::path::PathBuf;
use vitral_exec::Workers;
use vitral_io::load;
use vitral_light::{AlphaMode, Material, Reflectance};
use vitral_math::DVec3;
use vitral_scene::{Mesh, Scene, World};

/// The scene of a file of `tests/fixtures`.
fn read(path: &str) -> Result<Scene, String> {
    let full = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures").join(path);
    let bytes = std::fs::read(&full).unwrap();
    let folder = Folder(full.parent().unwrap().to_path_buf());
    let scene = load(&bytes, path, &folder, &Workers::single()).map_err(|e| e.to_string())?;
    scene.meshes.iter().for_each(|m| m.check().unwrap());
    Ok(scene)
}

/// The same, with exactly one warning, which has these words.
fn read_with_warning(path: &str, words: &str) -> Scene {
    let scene = read(path).unwrap();
    assert!(
        scene.warnings.len() == 1 && scene.warnings[0].contains(words),
        "{path}: {:?}",
        scene.warnings
    );
    scene
}

fn mesh(scene: &Scene) -> &Mesh {
    &scene.meshes[0]
}

/// The box round the scene.
fn bounds(scene: &Scene) -> [DVec3; 2] {
    let world = World::new(scene).unwrap();
    [world.bounds.min, world.bounds.max]
}

const UNIT_CUBE: [DVec3; 2] = [DVec3::ZERO, DVec3::ONE];

#[test]
fn binary_stl_with_wrong_counts_is_read_by_its_size() {
    for path in ["count0.stl", "countlarge.stl"] {
        let scene = read_with_warning(path, "triangles are announced, the 12 are read");
        assert_eq!((mesh(&scene).triangles.len(), bounds(&scene)), (12, UNIT_CUBE), "{path}");
    }
    let scene = read_with_warning("payload.stl", "attribute bytes behind the facets are skipped");
    assert_eq!((mesh(&scene).triangles.len(), bounds(&scene)), (12, UNIT_CUBE));
}

#[test]
fn ascii_stl_is_read_as_it_is_written() {
    for (path, warning) in [("endloop.stl", "`end loop`"), ("comment.stl", "comments")] {
        let scene = read_with_warning(path, warning);
        assert_eq!((mesh(&scene).triangles.len(), bounds(&scene)), (12, UNIT_CUBE), "{path}");
    }
    let scene = read_with_warning("quad.stl", "a facet with 4 corners");
    assert_eq!(mesh(&scene).triangles.len(), 2);
    let scene = read("comma.stl").unwrap();
    assert_eq!(bounds(&scene), [DVec3::new(0.5, 0.25, 0.0), DVec3::new(1.5, 1.25, 1.0)]);
}

#[test]
fn numbers_of_fortran_are_read() {
    let scene = read("fortran.obj").unwrap();
    assert_eq!(
        (bounds(&scene), scene.warnings.len()),
        ([DVec3::ZERO, DVec3::new(2.0, 2.0, 0.0)], 0)
    );
}

#[test]
fn a_face_with_a_bad_index_is_left_out() {
    let told = "line 5: index 9, the file has 3 vertices; 1 face with vertices that are not there is left out";
    assert_eq!(mesh(&read_with_warning("oor.obj", told)).triangles, [[0, 1, 2]]);
}

#[test]
fn colours_a_hair_above_1_are_clamped() {
    for path in ["over.obj", "floatover.ply", "faceover.off"] {
        let scene = read_with_warning(path, "colours exceed 1 and are clamped");
        let colors = mesh(&scene).colors.as_ref().unwrap();
        assert_eq!(colors.at(0, &mesh(&scene).triangles)[0], [1.0, 0.0, 0.0, 1.0], "{path}");
    }
}

#[test]
fn colours_that_are_all_clear_are_opaque() {
    let scene = read_with_warning("alpha0.ply", "all colours have alpha 0");
    assert!(mesh(&scene).colors.as_ref().unwrap().values.iter().all(|c| c[3] == 1.0));
    assert_eq!(scene.materials[0].alpha_mode, AlphaMode::Opaque);
}

#[test]
fn values_and_counts_may_be_spread_otherwise() {
    let square = [DVec3::ZERO, DVec3::new(2.0, 2.0, 0.0)];
    let scene = read_with_warning("wrapped.ply", "values run over line ends");
    assert_eq!((bounds(&scene), mesh(&scene).face_count()), (square, 1));
    let scene = read("twocounts.off").unwrap();
    assert_eq!((bounds(&scene), mesh(&scene).face_count(), scene.warnings.len()), (square, 1, 0));
}

fn only_material(scene: &Scene) -> &Material {
    assert_eq!(scene.materials.len(), 1, "{:?}", scene.warnings);
    &scene.materials[mesh(scene).parts[0].material.unwrap() as usize]
}

#[test]
fn options_stand_behind_names_of_textures() {
    let scene = read("options-behind/after.obj").unwrap();
    let texture = only_material(&scene).base_texture.unwrap();
    assert_eq!(texture.sampler.wrap_s, vitral_frame::Wrap::ClampToEdge);
    assert_eq!((scene.textures.len(), scene.warnings.len()), (1, 0));
}

#[test]
fn the_single_material_of_a_library_is_used() {
    let scene = read("one-material/nouse.obj").unwrap();
    assert_eq!(only_material(&scene).name, "only");
}

#[test]
fn alpha_of_a_texture_cuts_out() {
    let scene = read("leaf/kdalpha.obj").unwrap();
    assert_eq!(only_material(&scene).alpha_mode, AlphaMode::Mask { cutoff: 0.5 });
    assert!(matches!(only_material(&scene).reflectance, Reflectance::Phong { .. }));
}

#[test]
fn names_from_windows_are_found() {
    let scene = read("windows-gltf/backslash.gltf").unwrap();
    assert_eq!(scene.textures.len(), 1);
    assert_eq!(
        scene.warnings,
        ["windows-gltf/backslash.gltf: there is no `sub\\t.png`; `sub/t.png` is read"]
    );
    let scene = read("other-case/a.obj").unwrap();
    assert_eq!((only_material(&scene).name.as_str(), scene.textures.len()), ("m", 1));
    let told = [
        "there is no `A.MTL`; `a.mtl` is read, whose case differs",
        "there is no `T.PNG`; `t.png` is read",
    ];
    assert_eq!(scene.warnings.len(), told.len(), "{:?}", scene.warnings);
    assert!(scene.warnings.iter().zip(told).all(|(w, t)| w.contains(t)), "{:?}", scene.warnings);
}

#[test]
fn shapes_far_away_are_those_near_by() {
    let (near, far) = (read("far/sph_origin.obj").unwrap(), read("far/sph_utm2m.obj").unwrap());
    assert_eq!(
        (mesh(&near).triangles.len(), &mesh(&near).triangles),
        (mesh(&far).triangles.len(), &mesh(&far).triangles)
    );
    let [(near_low, near_high), (far_low, far_high)] = [&near, &far].map(|scene| {
        let [low, high] = bounds(scene);
        (low, high)
    });
    assert!(((far_high - far_low) - (near_high - near_low)).abs().max_element() < 2e-3);
    let moved = far_low - near_low;
    let (world_near, world_far) = (World::new(&near).unwrap(), World::new(&far).unwrap());
    for facet in 0..world_near.facet_count {
        for (a, b) in
            world_near.corners_of_facet(facet).into_iter().zip(world_far.corners_of_facet(facet))
        {
            assert!((b - a - moved).abs().max_element() < 2e-3, "{a} {b}");
        }
    }
    let cube = read("far/e7.obj").unwrap();
    assert_eq!(bounds(&cube), [DVec3::splat(9_999_999.5), DVec3::splat(10_000_000.5)]);
}

#[test]
fn hidden_nodes_are_hidden() {
    let scene = read("vis0.gltf").unwrap();
    assert_eq!(
        (World::new(&scene).unwrap().instances.len(), scene.warnings.len()),
        (1, 0),
        "{:?}",
        scene.warnings
    );
    assert_eq!(bounds(&scene), [DVec3::ZERO, DVec3::new(2.0, 2.0, 0.0)]);
}

#[test]
fn what_has_no_extent_at_rest_is_shown_as_its_animation_begins() {
    let scene = read_with_warning("anim.gltf", "the first animation is shown at time 0");
    assert_eq!(bounds(&scene), [DVec3::ZERO, DVec3::new(2.0, 2.0, 0.0)]);
}

#[test]
fn nodes_keep_the_digits_of_their_place() {
    let text = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0,1]}],"nodes":[
        {"translation":[500012.34,0,4500067.89]},
        {"matrix":[1,0,0,0, 0,1,0,0, 0,0,1,0, -4500067.89,0.5,0,1]}]}"#;
    let scene = load(text.as_bytes(), "far.gltf", &vitral_io::NoFiles, &Workers::single()).unwrap();
    let places = [0, 1].map(|n: usize| scene.nodes[n].transform.matrix().w_axis.truncate());
    assert_eq!(
        places,
        [DVec3::new(500_012.34, 0.0, 4_500_067.89), DVec3::new(-4_500_067.89, 0.5, 0.0)]
    );
}
