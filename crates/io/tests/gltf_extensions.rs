//! glTF: extensions that change the picture, in small files made here.

use crate::common::documents::{FLOAT, Memory, document, floats, load_text, triangle};
use std::collections::BTreeMap;
use vitral_exec::Workers;
use vitral_frame::{Encoding, Plane};
use vitral_io::encode::{PngOptions, png};
use vitral_io::{Error, gltf};
use vitral_light::AlphaMode;
use vitral_math::DVec3;
use vitral_scene::{Instance, World};

#[test]
fn metals_are_not_transmissive() {
    let material = |metallic: &str| {
        format!(
            r#"{{"pbrMetallicRoughness":{{{metallic}}},
            "extensions":{{"KHR_materials_transmission":{{"transmissionFactor":0.8}}}}}}"#
        )
    };
    let texture = r#""metallicRoughnessTexture":{"index":0}"#;
    let list =
        ["", r#""metallicFactor":0.5"#, r#""metallicFactor":0"#, texture].map(material).join(",");
    let scene = load_text(&format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[]}}],"materials":[{list}],
        "textures":[{{"source":0}}],"images":[{{"uri":"missing.png"}}]}}"#
    ))
    .unwrap();
    let seen: Vec<_> =
        scene.materials.iter().map(|m| (m.glass, (m.opacity * 100.0).round())).collect();
    // What is metal in part, or where a texture says so, is asked point by point.
    assert_eq!(seen, [(false, 100.0), (true, 20.0), (true, 20.0), (true, 20.0)]);
}

#[test]
fn a_transmission_texture_says_where_a_surface_is_glass() {
    let pixels = vec![[0, 255, 255, 255], [255, 0, 0, 255], [102, 9, 9, 0]];
    let picture = png(&Plane::from_rows(3, 1, pixels).unwrap(), PngOptions::default()).unwrap();
    let material = |factor: f32, image: usize, more: &str| {
        format!(
            r#"{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}},"metallicFactor":0}},{more}"extensions":{{
            "KHR_materials_transmission":{{"transmissionFactor":{factor},"transmissionTexture":{{"index":{image},"texCoord":1}}}}}}}}"#
        )
    };
    let list =
        [material(1.0, 0, ""), material(0.5, 0, ""), material(0.0, 0, ""), material(1.0, 1, "")];
    let mask = material(1.0, 0, r#""alphaMode":"MASK","#);
    let text = format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[]}}],"materials":[{},{mask}],
        "textures":[{{"source":0}},{{"source":1}}],"images":[{{"uri":"a.png"}},{{"uri":"missing.png"}}]}}"#,
        list.join(",")
    );
    let files = Memory(BTreeMap::from([("a.png", picture)]));
    let scene = gltf::load(text.as_bytes(), "a.gltf", &files, &Workers::single()).unwrap();
    let [clear, half, none, lost, mask] = &scene.materials[..] else { panic!() };

    for (material, greys) in [(clear, [255, 0, 153]), (half, [255, 128, 204])] {
        assert_eq!(
            (material.opacity, material.alpha_mode, material.glass),
            (1.0, AlphaMode::Blend, true)
        );
        let reference = material.opacity_texture.unwrap();
        let texture = &scene.textures[reference.texture as usize];
        assert_eq!((reference.uv_set, texture.encoding), (1, Encoding::Linear));
        assert_eq!(texture.levels[0].data(), greys.map(|grey| [grey, grey, grey, 255]));
        // Alpha of an opaque material counts for nothing, transmissive or not.
        let base = &scene.textures[material.base_texture.unwrap().texture as usize];
        assert_eq!(base.levels[0].data(), [[0, 255, 255, 255], [255, 0, 0, 255], [102, 9, 9, 255]]);
    }
    assert_eq!(
        (none.opacity, none.alpha_mode, none.opacity_texture),
        (1.0, AlphaMode::Opaque, None)
    );
    assert_eq!(
        (lost.opacity, lost.opacity_texture),
        (1.0, None),
        "rather opaque than not to be seen"
    );
    assert_eq!((mask.glass, mask.opacity_texture), (false, None));
    let told = |part: &str| scene.warnings.iter().filter(|w| w.contains(part)).count();
    assert_eq!((told("missing.png"), told("ransmission")), (1, 1), "{:?}", scene.warnings);
}

/// A node at (0, 0, 5) with a mesh and copies of it: `attributes` name accessors from 1 on.
fn copies(
    attributes: &str,
    more: &str,
    arrays: &[(Vec<u8>, u32, &'static str, usize, &'static str)],
) -> String {
    let rest = format!(
        r#""extensionsUsed":["EXT_mesh_gpu_instancing"],"extensionsRequired":["EXT_mesh_gpu_instancing"],
        "scenes":[{{"nodes":[0,2]}}],"nodes":[{{"mesh":0,"translation":[0,0,5],"children":[1],{more}
        "extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{{{attributes}}}}}}}}},{{"mesh":0}},{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}]"#
    );
    document(&[&[triangle()], arrays].concat(), &rest)
}

#[test]
fn copies_of_a_mesh_share_it() {
    let moves = (floats(&[1.0, 0.0, 0.0, 0.0, 2.0, 0.0]), FLOAT, "VEC3", 2, "");
    // A quarter turn about z, and none.
    let turns = (vec![0, 0, 90, 90, 0, 0, 0, 127], 5120, "VEC4", 2, r#","normalized":true"#);
    let scales = (floats(&[2.0, 2.0, 2.0, 1.0, 1.0, 1.0]), FLOAT, "VEC3", 2, "");
    let all = r#""TRANSLATION":1,"ROTATION":2,"SCALE":3,"_ID":77"#;
    let scene = load_text(&copies(all, "", &[moves, turns, scales])).unwrap();
    assert_eq!((scene.meshes.len(), scene.nodes.len(), scene.nodes[0].mesh), (1, 5, None));
    assert_eq!(
        (scene.nodes[0].children.as_slice(), &scene.warnings),
        (&[1, 3, 4][..], &Vec::<String>::new())
    );
    let world = World::new(&scene).unwrap();
    let corner = |i: &Instance| {
        (i.world_from_model.transform_point3(DVec3::X) * 100.0).round().as_ivec3().to_array()
    };
    let mut corners: Vec<[i32; 3]> = world.instances.iter().map(corner).collect();
    corners.sort_unstable();
    // The node beside, the child, and both copies: doubled and turned at (1, 0, 5), and moved to
    // (0, 2, 5).
    assert_eq!(corners, [[100, 0, 0], [100, 0, 500], [100, 200, 500], [100, 200, 500]]);
}

#[test]
fn wrong_copies_are_refused_with_their_place() {
    let moves = |count: usize| (vec![0; 12 * count], FLOAT, "VEC3", count, "");
    let zeros = (vec![0; 32], FLOAT, "VEC4", 2, "");
    let refused = |attributes: &str, arrays: &[_], part: &str| {
        let told = load_text(&copies(attributes, "", arrays)).unwrap_err().to_string();
        let place = "a.gltf: nodes[0].extensions.EXT_mesh_gpu_instancing";
        assert!(told.starts_with(place) && told.contains(part), "{told}");
    };
    refused(r#""TRANSLATION":9"#, &[], ".attributes.TRANSLATION: 9 is no accessor, there are 1");
    refused(r#""SCALE":"x""#, &[], "\"x\" is no accessor");
    refused(
        r#""TRANSLATION":1,"SCALE":2"#,
        &[moves(2), moves(3)],
        ".attributes.SCALE: accessor 2 has 3 elements, TRANSLATION has 2",
    );
    refused(r#""ROTATION":1"#, &[moves(2)], "3 components an element, 4 are needed");
    refused(
        r#""SCALE":1"#,
        &[(vec![0; 8], 5121, "VEC3", 2, "")],
        "accessor 1 has other components than floats",
    );
    let infinite = (floats(&[0.0, 0.0, 0.0, 0.0, f32::NAN, 0.0]), FLOAT, "VEC3", 2, "");
    refused(r#""TRANSLATION":1"#, &[infinite], "element 1 of accessor 1 is not finite");
    let claimed = load_text(&copies(
        r#""TRANSLATION":1"#,
        "",
        &[(vec![0; 12], FLOAT, "VEC3", 4_000_000_000, "")],
    ));
    assert!(claimed.unwrap_err().to_string().starts_with("a.gltf: accessors[1]: count 4000000000"));

    let scene = load_text(&copies(r#""ROTATION":1"#, "", &[zeros])).unwrap();
    let told = "a.gltf: nodes[0].extensions.EXT_mesh_gpu_instancing: 2 of 2 rotations are zero, none is used there";
    assert_eq!((scene.nodes.len(), scene.warnings.as_slice()), (5, &[told.to_owned()][..]));
    let none = load_text(&copies(r#""TRANSLATION":1"#, "", &[moves(0)])).unwrap();
    assert_eq!((none.nodes.len(), none.nodes[0].mesh), (3, None));
    assert_eq!(load_text(&copies("", "", &[])).unwrap().nodes[0].mesh, Some(0));
}

#[test]
fn a_small_file_cannot_unfold_into_many_copies() {
    // 100 nodes with 60000 copies each, in an accessor without bytes.
    let node =
        r#"{"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":1}}}}"#;
    let roots: Vec<String> = (0..100).map(|k| k.to_string()).collect();
    let rest = format!(
        r#""scenes":[{{"nodes":[{}]}}],"nodes":[{}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}]"#,
        roots.join(","),
        vec![node; 100].join(",")
    );
    let empty = (vec![0; 12], FLOAT, "VEC3", 60_000, "");
    let text = document(&[triangle(), empty], &rest).replace(r#""bufferView":1,"#, "");
    let told = load_text(&text).unwrap_err().to_string();
    assert!(told.contains("copies of meshes in all"), "{told}");
}

#[test]
fn vertices_that_are_only_there_compressed_are_refused() {
    let load = |position: &str, view: &str| {
        load_text(&format!(
            r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
            "extensionsUsed":["KHR_draco_mesh_compression"],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},
            "extensions":{{"KHR_draco_mesh_compression":{{"bufferView":0,"attributes":{{"POSITION":0}}}}}}}}]}}],
            "accessors":[{{"componentType":5126,"count":3,"type":"VEC3"{position}}}],
            "bufferViews":[{{"buffer":1,"byteLength":36}},{{"buffer":0,"byteLength":36{view}}}],
            "buffers":[{{"byteLength":36}},{{"byteLength":36,"uri":"data:;base64,{}"}}]}}"#,
            "A".repeat(48)
        ))
    };
    let refused = |position: &str, view: &str, what: &str| match load(position, view) {
        Err(Error::Unsupported { what: seen, .. }) => assert_eq!(seen, what),
        other => panic!("{other:?}"),
    };
    let draco = "meshes[0].primitives[0] is compressed with KHR_draco_mesh_compression, which is not supported";
    refused("", "", draco);
    assert_eq!(
        load(r#","bufferView":0"#, "").unwrap().meshes[0].triangles.len(),
        1,
        "there a second time"
    );
    for name in ["EXT_meshopt_compression", "KHR_meshopt_compression"] {
        let packed = format!(
            r#","extensions":{{"{name}":{{"buffer":1,"byteLength":9,"byteStride":12,"count":3}}}}"#
        );
        let what = format!("bufferViews[1] is compressed with {name}, which is not supported");
        refused(r#","bufferView":1"#, &packed, &what);
    }
}
