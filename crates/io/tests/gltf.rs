//! glTF and GLB: small files made here, and files damaged at random.

use crate::common::documents::{FLOAT, Memory, ONE_NODE, document, floats, load_text, triangle};
use proptest::prelude::*;
use std::collections::BTreeMap;
use vitral_exec::Workers;
use vitral_io::{NoFiles, gltf};
use vitral_light::{AlphaMode, Attenuation, LightKind, Reflectance};
use vitral_math::{DVec3, DVec4};
use vitral_scene::{Faces, FreePart, Scene, World};

/// Every mesh is sound and every index of the scene points at something.
pub(super) fn check(scene: &Scene) {
    for mesh in &scene.meshes {
        mesh.check().unwrap();
    }
    World::new(scene).unwrap();
    for mut material in scene.materials.iter().cloned() {
        assert!(
            material
                .textures_mut()
                .all(|t| (t.texture as usize) < scene.textures.len() && t.uv_set < 2)
        );
    }
    let materials = scene.materials.len() as u32;
    for mesh in &scene.meshes {
        assert!(mesh.materials().all(|m| m < materials));
    }
}

#[test]
fn primitives_share_vertices_and_read_only_what_they_use() {
    let positions = floats(&(0..30).map(|v| v as f32).collect::<Vec<_>>());
    let arrays = [
        (positions, FLOAT, "VEC3", 10, ""),
        (vec![4, 5, 6], 5121, "SCALAR", 3, ""),
        (vec![6, 5, 7], 5121, "SCALAR", 3, ""),
        (vec![7, 5], 5121, "SCALAR", 2, ""),
    ];
    let rest = format!(
        r#"{ONE_NODE},"materials":[{{}},{{}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"material":1}},
        {{"attributes":{{"POSITION":0}},"indices":2}},{{"attributes":{{"POSITION":0}},"indices":3,"mode":1,"material":0}}]}}]"#
    );
    let scene = load_text(&document(&arrays, &rest)).unwrap();
    check(&scene);
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.positions.len(), 4, "vertices 4 to 7, once");
    assert_eq!(mesh.positions[0], [12.0, 13.0, 14.0]);
    assert_eq!(
        (mesh.triangles.as_slice(), mesh.lines.as_slice()),
        (&[[0, 1, 2], [2, 1, 3]][..], &[[3, 1]][..])
    );
    assert_eq!(
        mesh.parts.iter().map(|p| (p.triangles.clone(), p.material)).collect::<Vec<_>>(),
        [(0..1, Some(1)), (1..2, None)]
    );
    assert_eq!(
        (&mesh.faces, FreePart::material_of(&mesh.line_parts, 0), mesh.normals.is_none()),
        (&Faces::Triangles, Some(0), true)
    );
}

#[test]
fn quantised_and_normalised_attributes() {
    let arrays = [
        (vec![0u8, 0, 0, 0, 100, 0, 0, 0, 0, 50, 0, 0], 5121, "VEC3", 3, ""),
        (
            vec![0u8, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0],
            5120,
            "VEC3",
            3,
            r#","normalized":true"#,
        ),
        (
            vec![0u8, 0, 255, 255, 0, 0, 255, 255, 0, 0, 255, 255],
            5123,
            "VEC2",
            3,
            r#","normalized":true"#,
        ),
        (
            vec![255u8, 0, 51, 0, 255, 0, 51, 0, 255, 0, 51, 0],
            5121,
            "VEC3",
            3,
            r#","normalized":true"#,
        ),
    ];
    let rest = format!(
        r#"{ONE_NODE},"extensionsRequired":["KHR_mesh_quantization"],"extensionsUsed":["KHR_mesh_quantization"],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2,"COLOR_0":3}}}}]}}]"#
    );
    // Elements of three bytes are four bytes apart, as the format demands.
    let text = document(&arrays, &rest)
        .replace(r#""byteLength":12}"#, r#""byteLength":12,"byteStride":4}"#);
    let scene = load_text(&text).unwrap();
    check(&scene);
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.positions, [[0.0; 3], [100.0, 0.0, 0.0], [0.0, 50.0, 0.0]]);
    assert_eq!(mesh.normals.as_ref().unwrap().values[2], [0.0, 0.0, 1.0]);
    assert_eq!(mesh.uvs[0].values[0], [0.0, 1.0]);
    assert_eq!(mesh.colors.as_ref().unwrap().values[1], [1.0, 0.0, 0.2, 1.0]);
}

#[test]
fn tangents_come_along_where_all_surfaces_have_them_and_stay_as_they_are() {
    let normals = (floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]), FLOAT, "VEC3", 3, "");
    let tangents = (
        floats(&[1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, -1.0, 1.0, 0.0, 0.0, 1.0]),
        FLOAT,
        "VEC4",
        3,
        "",
    );
    let read = |primitives: &str| {
        let rest = format!(r#"{ONE_NODE},"meshes":[{{"primitives":[{primitives}]}}]"#);
        load_text(&document(&[triangle(), normals.clone(), tangents.clone()], &rest))
            .unwrap()
            .meshes[0]
            .tangents
            .clone()
    };
    let with = r#"{"attributes":{"POSITION":0,"NORMAL":1,"TANGENT":2}}"#;
    assert_eq!(read(with).unwrap().values[1], [0.0, 1.0, 0.0, -1.0]);
    assert_eq!(read(&format!(r#"{with},{{"attributes":{{"POSITION":0,"NORMAL":1}}}}"#)), None);
    assert_eq!(
        read(r#"{"attributes":{"POSITION":0,"TANGENT":2}}"#),
        None,
        "they belong to normals"
    );
}

#[test]
fn attribute_counts_must_agree() {
    let two = (floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]), FLOAT, "VEC3", 2, "");
    let fails = |primitive: &str, part: &str| {
        let rest = format!(r#"{ONE_NODE},"meshes":[{{"primitives":[{primitive}]}}]"#);
        let message =
            load_text(&document(&[triangle(), two.clone()], &rest)).unwrap_err().to_string();
        assert!(message.contains(part), "{message}");
    };
    let differ =
        "meshes[0].primitives[0].attributes.NORMAL: accessor 1 has 2 elements, POSITION has 3";
    fails(r#"{"attributes":{"POSITION":0,"NORMAL":1}}"#, differ);
    fails(
        r#"{"attributes":{"POSITION":0},"targets":[{},{"POSITION":1}]}"#,
        "primitives[0].targets[1].POSITION: accessor 1",
    );
    fails(
        r#"{"attributes":{"POSITION":0,"TEXCOORD_0":0}}"#,
        "TEXCOORD_0: accessor 0 has 3 components an element, 2 are needed",
    );
    fails(
        r#"{"attributes":{"POSITION":0},"indices":0}"#,
        "primitives[0].indices: accessor 0 is not SCALAR",
    );
    fails(r#"{"attributes":{"POSITION":0},"mode":1}"#, "3 vertices, LINES need a multiple of 2");
}

#[test]
fn indices_behind_the_last_whole_triangle_are_left_out() {
    let shown = |indices: Vec<u8>, mode: u32| {
        let count = indices.len();
        let primitive = format!(r#"{{"attributes":{{"POSITION":0}},"indices":1,"mode":{mode}}}"#);
        let rest = format!(r#"{ONE_NODE},"meshes":[{{"primitives":[{primitive}]}}]"#);
        load_text(&document(&[triangle(), (indices, 5121, "SCALAR", count, "")], &rest)).unwrap()
    };
    let scene = shown(vec![0, 1, 2, 2, 1], 4);
    let told = "5 indices, TRIANGLES need a multiple of 3; the rest is left out";
    assert_eq!(scene.warnings, [format!("a.gltf: meshes[0].primitives[0].indices: {told}")]);
    assert_eq!(scene.meshes[0].triangles, [[0, 1, 2]]);
    let scene = shown(vec![2, 1, 0], 1);
    assert!(
        scene.warnings[0].contains("3 indices, LINES need a multiple of 2; the rest is left out")
    );
    assert_eq!(
        (scene.meshes[0].lines.as_slice(), scene.meshes[0].positions.len()),
        (&[[1, 0]][..], 2)
    );
    assert_eq!(shown(vec![0, 1, 2, 0], 5).warnings.len(), 0);
}

#[test]
fn morph_targets_at_default_weights() {
    let shift = |x: f32| (floats(&[x, 0.0, 0.0, x, 0.0, 0.0, x, 0.0, 0.0]), FLOAT, "VEC3", 3, "");
    let rest = r#""scenes":[{"nodes":[0,1,2]}],"nodes":[{"mesh":0},{"mesh":0,"weights":[0,2]},{"mesh":0}],
        "meshes":[{"weights":[0.5,0],"primitives":[{"attributes":{"POSITION":0},"targets":[{"POSITION":1},{"POSITION":2}]}]}]"#;
    let scene = load_text(&document(&[triangle(), shift(4.0), shift(10.0)], rest)).unwrap();
    check(&scene);
    assert_eq!(scene.meshes.len(), 2, "one mesh for each pose");
    assert_eq!(scene.nodes.iter().map(|n| n.mesh).collect::<Vec<_>>(), [Some(0), Some(1), Some(0)]);
    assert_eq!(scene.meshes[0].positions[0], [2.0, 0.0, 0.0]);
    assert_eq!(scene.meshes[1].positions[1], [21.0, 0.0, 0.0]);
}

#[test]
fn a_skin_blends_its_joints() {
    // Vertex 0 goes with joint 0 (at x = 10), vertex 1 with joint 1 (turned a quarter about z),
    // vertex 2 with both.
    let joints = (vec![0u8, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0], 5121, "VEC4", 3, "");
    let weights = (
        floats(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0]),
        FLOAT,
        "VEC4",
        3,
        "",
    );
    let normals = (floats(&[0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]), FLOAT, "VEC3", 3, "");
    let rest = r#""scenes":[{"nodes":[0,1,2]}],
        "nodes":[{"mesh":0,"skin":0,"translation":[99,0,0]},{"translation":[10,0,0]},{"rotation":[0,0,0.70710678,0.70710678]}],
        "skins":[{"joints":[1,2]}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2,"NORMAL":3}}]}]"#;
    let arrays = [triangle(), joints, weights, normals];
    let scene = load_text(&document(&arrays, rest)).unwrap();
    check(&scene);
    let near = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
    let mesh = &scene.meshes[0];
    assert!(near(mesh.positions[0], [10.0, 0.0, 0.0]), "{:?}", mesh.positions);
    assert!(near(mesh.positions[1], [0.0, 1.0, 0.0]));
    assert!(near(mesh.positions[2], [4.5, 0.5, 0.0]), "half of (10, 1) and half of (-1, 0)");
    assert!(near(mesh.normals.as_ref().unwrap().values[1], [0.0, 1.0, 0.0]));
    let out_of_range = document(&arrays, &rest.replace(r#""joints":[1,2]"#, r#""joints":[1]"#));
    let message = load_text(&out_of_range).unwrap_err().to_string();
    assert!(
        message.contains("attributes.JOINTS_0: vertex 1 has joint 1, the skin has 1"),
        "{message}"
    );
}

#[test]
fn primitives_with_and_without_normals() {
    let normals = (floats(&[0.0, 0.0, 2.0, 0.0, 0.0, 2.0, 0.0, 0.0, 2.0]), FLOAT, "VEC3", 3, "");
    let rest = format!(
        r#"{ONE_NODE},"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"NORMAL":1}}}},{{"attributes":{{"POSITION":0}}}}]}}]"#
    );
    let scene = load_text(&document(&[triangle(), normals], &rest)).unwrap();
    check(&scene);
    let mesh = &scene.meshes[0];
    let normals = mesh.normals.as_ref().unwrap();
    assert_eq!(normals.at(0, &mesh.triangles), [[0.0, 0.0, 2.0]; 3]);
    assert_eq!(
        normals.at(1, &mesh.triangles),
        [[0.0, 0.0, 1.0]; 3],
        "flat, as the specification asks"
    );
}

#[test]
fn materials_and_their_extensions() {
    let scene = load_text(
        r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[]}],"extensionsUsed":["KHR_materials_clearcoat","KHR_materials_ior"],
        "materials":[
        {"name":"glass","emissiveFactor":[1,0.5,0],"pbrMetallicRoughness":{"baseColorFactor":[1,0.5,0.25,1],"metallicFactor":0},"extensions":{"KHR_materials_transmission":{"transmissionFactor":0.75},
         "KHR_materials_ior":{"ior":1.33},"KHR_materials_emissive_strength":{"emissiveStrength":4}}},
        {"alphaMode":"MASK","alphaCutoff":0.25,"doubleSided":true,"pbrMetallicRoughness":{"baseColorFactor":[1,0.5,0.25,0.5]}},
        {"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.5],"metallicFactor":0,"roughnessFactor":0.3},
         "extensions":{"KHR_materials_unlit":{}}},
        {"pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.5],"baseColorTexture":{"index":0}},
         "extensions":{"KHR_materials_ior":{"ior":0}}}],
        "textures":[{"source":0}],"images":[{"uri":"missing.png"}]}"#,
    )
    .unwrap();
    let [glass, mask, blend, opaque] = &scene.materials[..] else { panic!() };
    assert_eq!(
        (glass.opacity, glass.alpha_mode, glass.ior, glass.emission),
        (0.25, AlphaMode::Blend, 1.33, [4.0, 2.0, 0.0])
    );
    assert_eq!((glass.glass, glass.filter), (true, [1.0, 0.5, 0.25]));
    assert_eq!((blend.glass, blend.filter), (false, [1.0; 3]), "alpha alone is no glass");
    assert_eq!(
        (mask.alpha_mode, mask.opacity, mask.double_sided),
        (AlphaMode::Mask { cutoff: 0.25 }, 0.5, true)
    );
    let expected =
        Reflectance::MetallicRoughness { base_color: [1.0; 3], metallic: 0.0, roughness: 0.3 };
    assert_eq!(
        (blend.alpha_mode, blend.opacity, blend.unlit, blend.reflectance),
        (AlphaMode::Blend, 0.5, true, expected)
    );
    assert_eq!(
        (opaque.alpha_mode, opaque.opacity, opaque.base_texture),
        (AlphaMode::Opaque, 1.0, None)
    );
    let told = |part: &str| scene.warnings.iter().filter(|w| w.contains(part)).count();
    assert_eq!(
        (
            told("extensions not read: KHR_materials_clearcoat"),
            told("missing.png"),
            told("no nodes")
        ),
        (1, 1, 1)
    );
    assert_eq!(
        (
            opaque.ior,
            told(
                "materials[3]: an index of refraction of 0 (no light enters) is not shown, 1.5 is used"
            )
        ),
        (1.5, 1)
    );
}

#[test]
fn samplers_and_texture_sets() {
    let mut files = BTreeMap::new();
    let picture = vitral_frame::Plane::filled(2, 2, [255, 0, 0, 255]);
    files.insert(
        "a b.png",
        vitral_io::encode::png(&picture, vitral_io::encode::PngOptions::default()).unwrap(),
    );
    let text = r#"{"asset":{"version":"2.0"},"materials":[{
        "pbrMetallicRoughness":{"baseColorTexture":{"index":0,"texCoord":1},"metallicRoughnessTexture":{"index":0}},
        "normalTexture":{"index":0,"scale":0.5,"extensions":{"KHR_texture_transform":{"offset":[0.5,0],"texCoord":1}}},
        "emissiveTexture":{"index":0,"texCoord":3},"occlusionTexture":{"index":0,"strength":0.25}}],
        "textures":[{"source":0,"sampler":0}],"images":[{"uri":"a%20b.png"}],
        "samplers":[{"magFilter":9728,"minFilter":9985,"wrapS":33071,"wrapT":33648}]}"#;
    let scene = gltf::load(text.as_bytes(), "a.gltf", &Memory(files), &Workers::new(2)).unwrap();
    check(&scene);
    let m = &scene.materials[0];
    let (base, rough, normal) =
        (m.base_texture.unwrap(), m.metallic_roughness_texture.unwrap(), m.normal_texture.unwrap());
    assert_eq!(scene.textures.len(), 2, "once as colour, once as data");
    assert_eq!((base.texture, base.uv_set, rough.texture, normal.texture), (0, 1, 1, 1));
    assert_eq!((m.occlusion_texture.unwrap().texture, m.occlusion_strength), (1, 0.25));
    assert_eq!((m.normal_scale, normal.uv_set, normal.transform[0][2]), (0.5, 1, 0.5));
    use vitral_frame::{Encoding, Filter, MipFilter, Sampler, Wrap};
    let expected = Sampler {
        wrap_s: Wrap::ClampToEdge,
        wrap_t: Wrap::MirroredRepeat,
        magnify: Filter::Nearest,
        minify: Filter::Linear,
        mip: MipFilter::Nearest,
    };
    assert_eq!(base.sampler, expected);
    assert_eq!([0, 1].map(|i| scene.textures[i].encoding), [Encoding::Srgb, Encoding::Linear]);
    assert_eq!(
        scene
            .warnings
            .iter()
            .filter(|w| w.contains("texCoord 3") || w.contains("occlusion"))
            .count(),
        1
    );
}

#[test]
fn a_picture_in_webp_goes_before_the_one_for_other_readers() {
    // One red pixel, lossless.
    let webp = "data:image/webp;base64,UklGRhwAAABXRUJQVlA4TA8AAAAvAAAAAAcQ/Y/+ByKi/wEA";
    let scene = load_text(&format!(
        r#"{{"asset":{{"version":"2.0"}},"extensionsUsed":["EXT_texture_webp"],"extensionsRequired":["EXT_texture_webp"],
        "materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}},"emissiveTexture":{{"index":1}}}}],
        "textures":[{{"source":0,"extensions":{{"EXT_texture_webp":{{"source":1}}}}}},
        {{"extensions":{{"EXT_texture_webp":{{"source":1}}}}}}],
        "images":[{{"uri":"missing.png"}},{{"uri":"{webp}"}}]}}"#
    ))
    .unwrap();
    let material = &scene.materials[0];
    let numbers =
        [material.base_texture, material.emission_texture].map(|texture| texture.unwrap().texture);
    assert_eq!((scene.textures.len(), numbers), (1, [0, 0]));
    assert!(
        !scene.warnings.iter().any(|w| w.contains("missing.png") || w.contains("webp")),
        "{:?}",
        scene.warnings
    );
}

#[test]
fn lights_shine_along_minus_z() {
    let text = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0,1,2]}],
        "nodes":[{"extensions":{"KHR_lights_punctual":{"light":0}},"rotation":[0.70710678,0,0,0.70710678]},
        {"extensions":{"KHR_lights_punctual":{"light":1}},"translation":[1,2,3]},{"extensions":{"KHR_lights_punctual":{"light":2}}}],
        "extensionsUsed":["KHR_lights_punctual"],"extensions":{"KHR_lights_punctual":{"lights":[
        {"type":"directional","color":[1,0.5,0],"intensity":2},{"type":"point","range":7},
        {"type":"spot","intensity":3,"spot":{"innerConeAngle":0.25,"outerConeAngle":0.5}}]}}}"#;
    let world = World::new(&load_text(text).unwrap()).unwrap();
    let [sun, lamp, spot] = &world.lights[..] else { panic!("{:?}", world.lights) };
    let LightKind::Directional { direction } = sun.kind else { panic!("{sun:?}") };
    assert!(
        (direction - DVec3::Y).length() < 1e-6,
        "-z turned a quarter about x is +y, not {direction}"
    );
    // One lux on a white Lambert surface reflects 1/pi.
    let lux = std::f32::consts::FRAC_1_PI;
    assert_eq!((sun.diffuse, sun.specular), ([2.0 * lux, lux, 0.0], [2.0 * lux, lux, 0.0]));
    assert_eq!((lamp.diffuse, spot.diffuse), ([lux; 3], [3.0 * lux; 3]));
    assert_eq!(lamp.kind, LightKind::Point { position: DVec3::new(1.0, 2.0, 3.0) });
    assert_eq!(lamp.attenuation, Attenuation::Range { range: 7.0 });
    let LightKind::Spot { cutoff, inner, exponent, .. } = spot.kind else { panic!("{spot:?}") };
    assert_eq!(
        (cutoff, inner, exponent, spot.attenuation),
        (0.5, 0.25, 0.0, Attenuation::InverseSquare)
    );
}

#[test]
fn bad_trees_and_odd_nodes() {
    let with = |nodes: &str| {
        load_text(&format!(
            r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{nodes}]}}"#
        ))
    };
    let two_parents = with(r#"{"children":[1,2]},{"children":[2]},{}"#).unwrap_err().to_string();
    assert!(
        two_parents.contains("nodes[1].children[0]: node 2 is a child of node 0 already"),
        "{two_parents}"
    );
    assert!(with(r#"{"children":[0]}"#).unwrap_err().to_string().contains("its own ancestor"));
    assert!(
        with(r#"{"translation":[1e300,0,0]}"#)
            .unwrap_err()
            .to_string()
            .contains("nodes[0].translation")
    );
    let odd = with(r#"{"rotation":[0,0,0,0],"scale":[2,2,2]}"#).unwrap();
    assert_eq!((odd.warnings.len(), odd.nodes[0].transform.matrix().x_axis), (2, DVec4::X * 2.0));
    assert_eq!(odd.warnings[1], "a.gltf: the file holds nothing to show");

    // A very deep chain is walked without recursion.
    let chain: Vec<String> =
        (1..50_000).map(|i| format!(r#"{{"children":[{i}],"translation":[0,0,1]}}"#)).collect();
    let deep = with(&format!("{},{{}}", chain.join(","))).unwrap();
    assert_eq!(deep.nodes.len(), 50_000);

    // A root below another root is shown once.
    let text =
        r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0,1,0]}],"nodes":[{"children":[1]},{}]}"#;
    let scene = load_text(text).unwrap();
    assert_eq!((scene.roots.len(), scene.nodes.len(), scene.warnings.len()), (1, 2, 2));
}

#[test]
fn a_small_file_cannot_unfold_into_a_huge_scene() {
    // 2000 primitives that each draw the same 100000 indices.
    let indices = (vec![0u8; 100_000], 5121, "SCALAR", 100_000, "");
    let primitives = vec![r#"{"attributes":{"POSITION":0},"indices":1}"#; 2000].join(",");
    let rest = format!(r#"{ONE_NODE},"meshes":[{{"primitives":[{primitives}]}}]"#);
    let message = load_text(&document(&[triangle(), indices], &rest)).unwrap_err().to_string();
    assert!(message.contains("unfold into more than"), "{message}");
}

/// A document that uses most of the format.
fn rich_document() -> String {
    let arrays = [
        triangle(),
        (vec![0u8, 1, 2, 0], 5121, "SCALAR", 3, ""),
        (vec![0u8; 12], 5121, "VEC4", 3, ""),
        (floats(&[1.0; 12]), FLOAT, "VEC4", 3, ""),
        (
            floats(&[0.5; 6]),
            FLOAT,
            "VEC2",
            3,
            r#","sparse":{"count":1,"indices":{"bufferView":1,"componentType":5121},"values":{"bufferView":4}}"#,
        ),
        (floats(&[1.0; 16]), FLOAT, "MAT4", 1, ""),
    ];
    let rest = r#""scene":0,"scenes":[{"nodes":[0,2]}],
        "nodes":[{"mesh":0,"children":[1],"rotation":[0,0,0,1],"extensions":{"EXT_mesh_gpu_instancing":
        {"attributes":{"TRANSLATION":0}}}},{"camera":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]},
        {"mesh":0,"skin":0,"weights":[0.5],"extensions":{"KHR_lights_punctual":{"light":0}}}],
        "skins":[{"joints":[1],"inverseBindMatrices":5}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":0,"JOINTS_0":2,"WEIGHTS_0":3,"COLOR_0":3,"TEXCOORD_0":4},
        "indices":1,"material":0,"mode":5,"targets":[{"POSITION":0}]},{"attributes":{"POSITION":0},"mode":2}]}],
        "materials":[{"alphaMode":"MASK","pbrMetallicRoughness":{"baseColorTexture":{"index":0}},"normalTexture":{"index":0}}],
        "textures":[{"source":0,"sampler":0}],"samplers":[{"wrapS":33071}],"images":[{"bufferView":0}],
        "cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":0.1}}],
        "extensions":{"KHR_lights_punctual":{"lights":[{"type":"point"}]}}"#;
    document(&arrays, rest)
}

/// The same as GLB.
fn container(json: &str, binary: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut out = b"glTF\x02\0\0\0".to_vec();
    out.extend((28 + json.len() as u32 + binary.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", json.as_slice()), (b"BIN\0", binary)] {
        out.extend((chunk.len() as u32).to_le_bytes());
        out.extend(kind);
        out.extend(chunk);
    }
    out
}

#[test]
fn the_rich_document_is_sound() {
    let scene = load_text(&rich_document()).unwrap();
    check(&scene);
    assert_eq!((scene.meshes.len(), scene.cameras.len()), (2, 1));
}

/// Loads whatever comes; a scene that comes out is sound.
fn survives(bytes: &[u8]) {
    if let Ok(scene) = gltf::load(bytes, "a.gltf", &NoFiles, &Workers::single()) {
        check(&scene);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damaged_json_never_panics(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)) {
        let mut bytes = rich_document().into_bytes();
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        survives(&bytes);
    }

    #[test]
    fn other_numbers_never_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), prop::sample::select(vec![
            "0", "1", "2", "3", "5", "7", "-1", "255", "256", "5120", "5121", "5123", "5125", "5126", "65535", "4294967295",
            "4294967296", "18446744073709551615", "1e39", "-1e308", "0.5", "null", "[]", "{}", "\"x\"",
        ])), 1..4),
    ) {
        // Replace whole numbers by other values, so that the JSON stays well-formed.
        let mut text = rich_document();
        for (at, value) in changes {
            let starts: Vec<usize> = text.match_indices([':', ',', '[']).map(|(i, _)| i + 1)
                .filter(|&i| text[i..].starts_with(|c: char| c.is_ascii_digit())).collect();
            let start = starts[at.index(starts.len())];
            let length = text[start..].find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap();
            text.replace_range(start..start + length, value);
        }
        survives(text.as_bytes());
    }

    #[test]
    fn damaged_containers_never_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        keep in any::<prop::sample::Index>(), cut in any::<bool>(),
    ) {
        let mut bytes = container(&rich_document(), &[0; 16]);
        for (at, byte) in changes {
            let at = at.index(bytes.len().min(64));
            bytes[at] = byte;
        }
        let length = if cut { keep.index(bytes.len()) } else { bytes.len() };
        survives(&bytes[..length]);
    }

    #[test]
    fn noise_never_panics(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        survives(&bytes);
        let mut glb = b"glTF\x02\0\0\0".to_vec();
        glb.extend(&bytes);
        survives(&glb);
    }
}
