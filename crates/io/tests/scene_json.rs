//! Scene files: everything comes back, references are followed, mistakes are reported with their
//! place.

use proptest::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;
use vitral_exec::Workers;
use vitral_frame::{Encoding, Filter, MipFilter, Plane, Sampler, Texture, Wrap};
use vitral_io::{Error, NoFiles, ResolveError, Resolver, scene_json};
use vitral_light::{
    AlphaMode, AreaShape, Attenuation, Light, LightKind, Material, Reflectance, TextureRef,
    Transmission,
};
use vitral_math::{DMat4, DQuat, DVec3, func};
use vitral_scene::{
    Attribute, Axis, Camera, Faces, FreePart, Mesh, Node, NodeTransform, Part, Projection, Scene,
    World,
};

/// Files in memory.
#[derive(Default)]
struct Memory(BTreeMap<String, Vec<u8>>);

impl Memory {
    fn with(files: &[(&str, &str)]) -> Self {
        Self(
            files
                .iter()
                .map(|(name, text)| ((*name).to_owned(), text.as_bytes().to_vec()))
                .collect(),
        )
    }
}

impl Resolver for Memory {
    fn read(&self, path: &str) -> Result<Vec<u8>, ResolveError> {
        if path.starts_with("..") {
            return Err(ResolveError::Outside);
        }
        self.0.get(path).cloned().ok_or(ResolveError::NotFound)
    }
}

fn load(text: &str) -> Result<Scene, Error> {
    vitral_io::load(text.as_bytes(), "a.json", &NoFiles, &Workers::new(2))
}

fn assert_equal(a: &Scene, b: &Scene) {
    assert_eq!(a.meshes, b.meshes);
    assert_eq!(a.materials, b.materials);
    assert_eq!(a.textures, b.textures);
    assert_eq!(format!("{:?}", a.nodes), format!("{:?}", b.nodes));
    assert_eq!(
        (&a.roots, &a.lights, &a.cameras, a.ambient),
        (&b.roots, &b.lights, &b.cameras, b.ambient)
    );
}

/// A mesh with everything that a mesh can have, its cut not the usual one.
fn full_mesh() -> Mesh {
    Mesh {
        name: "patch \"1\"".to_owned(),
        positions: vec![
            [0.1, 0.0, -0.0],
            [1.0, 1e-30, 0.0],
            [1.0, 1.0, 3.4e38],
            [0.0, 1.0, 0.0],
            [2.0, 0.5, 0.0],
        ],
        triangles: vec![[1, 2, 3], [1, 3, 0], [1, 4, 2]],
        faces: Faces::Polygons { starts: vec![0, 4, 7], corners: vec![0, 1, 2, 3, 1, 4, 2] },
        parts: vec![
            Part { name: "left".to_owned(), triangles: 0..2, material: Some(1) },
            Part { name: String::new(), triangles: 2..3, material: None },
        ],
        normals: Some(Attribute {
            values: vec![[0.0, 0.0, 1.0]; 2],
            corners: Some(vec![[0, 0, 1]; 3]),
        }),
        normals_stay: true,
        tangents: Some(Attribute {
            values: vec![[1.0, 0.0, 0.0, -1.0]],
            corners: Some(vec![[0; 3]; 3]),
        }),
        uvs: vec![
            Attribute::per_vertex(vec![[0.1, 0.7]; 5]),
            Attribute { values: vec![[0.3; 2]], corners: Some(vec![[0; 3]; 3]) },
        ],
        colors: Some(Attribute::per_vertex(vec![[0.1, 0.2, 0.3, 0.4]; 5])),
        colors_from_srgb: true,
        lines: vec![[0, 4]],
        points: vec![2],
        line_parts: vec![FreePart { elements: 0..1, material: Some(0) }],
        point_parts: vec![FreePart { elements: 0..1, material: Some(1) }],
        smoothing_groups: Some(vec![1, 0]),
        // Found out again where it is needed, not written.
        solidity: None,
        section: None,
    }
}

fn full_materials() -> Vec<Material> {
    let sampler = Sampler {
        wrap_s: Wrap::ClampToEdge,
        wrap_t: Wrap::MirroredRepeat,
        magnify: Filter::Nearest,
        minify: Filter::Nearest,
        mip: MipFilter::None,
    };
    let reference = TextureRef {
        texture: 1,
        sampler,
        uv_set: 1,
        transform: [[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]],
    };
    let glass = Material {
        name: "glass".to_owned(),
        reflectance: Reflectance::MetallicRoughness {
            base_color: [0.1, 0.2, 0.3],
            metallic: 0.4,
            roughness: 0.7,
        },
        srgb_colors: true,
        texture_tint: Some([0.2, 0.4, 0.6]),
        emission: [1.5, 0.0, 0.1],
        opacity: 0.3,
        kt_min: 0.2,
        alpha_mode: AlphaMode::Mask { cutoff: 0.1 },
        transmission: Transmission::Translucent,
        glass: true,
        filter: [0.9, 0.5, 0.25],
        ior: 1.33,
        mirror: true,
        double_sided: true,
        front_only: true,
        unlit: true,
        base_texture: Some(TextureRef::new(0)),
        specular_texture: Some(reference),
        emission_texture: Some(TextureRef::new(0)),
        opacity_texture: Some(reference),
        metallic_roughness_texture: Some(reference),
        occlusion_texture: Some(reference),
        occlusion_strength: 0.6,
        normal_texture: Some(reference),
        normal_scale: 0.9,
    };
    vec![
        Material::default(),
        glass,
        Material { alpha_mode: AlphaMode::Blend, ..Material::default() },
    ]
}

fn full_lights() -> Vec<Light> {
    let (position, direction) = (DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.0, -1.0, 1e-3));
    let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    let kinds = [
        (LightKind::Ambient, Attenuation::None),
        (LightKind::Directional { direction }, Attenuation::InverseSquare),
        (LightKind::Point { position }, Attenuation::Clamped { c1: 1.0, c2: 0.1, c3: 0.01 }),
        (
            LightKind::Spot { position, direction, cutoff: 0.7, inner: 0.1, exponent: 3.0 },
            Attenuation::Range { range: 9.0 },
        ),
        (
            LightKind::Area {
                shape: AreaShape::Disc { center: position, normal: direction, radius: 2.0 },
            },
            Attenuation::Gl { constant: 1.0, linear: 0.3, quadratic: 0.2 },
        ),
        (LightKind::Area { shape: AreaShape::Polygon { corners } }, Attenuation::None),
    ];
    let light = |(kind, attenuation)| Light {
        kind,
        attenuation,
        diffuse: [0.3, 2.0, 0.1],
        ..Light::default()
    };
    kinds
        .into_iter()
        .map(light)
        .chain([Light { enabled: false, shadow: false, ..Light::default() }])
        .collect()
}

fn full_scene() -> Scene {
    let picture = |n: u8| {
        let pixels = (0..15).map(|i| [i * 16, n, 255 - i, if n == 0 { 255 } else { i }]).collect();
        Plane::from_rows(5, 3, pixels).unwrap()
    };
    let camera = |projection, clip| Camera {
        position: DVec3::new(0.1, 1.0 / 3.0, 5.0),
        focal_point: DVec3::ZERO,
        view_up: DVec3::Y,
        projection,
        clip,
    };
    let turned = DQuat::from_xyzw(func::sin(0.3), 0.0, 0.0, func::cos(0.3));
    let nodes = vec![
        Node { name: "root".to_owned(), children: vec![2, 1], ..Node::default() },
        Node {
            transform: NodeTransform::Parts {
                translation: DVec3::new(0.1, 0.2, 0.3),
                rotation: turned,
                scale: DVec3::splat(1.0 / 3.0),
            },
            mesh: Some(0),
            light: Some(full_lights().remove(3)),
            ..Node::default()
        },
        Node {
            transform: NodeTransform::Matrix(DMat4::from_scale(DVec3::new(0.1, 2.0, -3.0))),
            mesh: Some(1),
            camera: Some(1),
            ..Node::default()
        },
        Node { mesh: Some(0), ..Node::default() },
        Node { name: "hidden".to_owned(), camera: Some(0), ..Node::default() },
    ];
    let triangle = Mesh {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        triangles: vec![[0, 1, 2]],
        parts: vec![Part { name: String::new(), triangles: 0..1, material: Some(2) }],
        ..Mesh::default()
    };
    Scene {
        meshes: vec![Arc::new(full_mesh()), Arc::new(triangle), Arc::new(Mesh::default())],
        materials: full_materials(),
        textures: vec![
            Arc::new(Texture::new("a".to_owned(), picture(0), Encoding::Srgb)),
            Arc::new(Texture::new("b".to_owned(), picture(7), Encoding::Linear)),
        ],
        nodes,
        roots: vec![3, 0],
        lights: full_lights(),
        cameras: vec![
            camera(Projection::Parallel { height: 0.7 }, None),
            camera(Projection::Perspective { view_angle: 0.1 }, Some((0.1, 1e9))),
        ],
        own_camera: None,
        ambient: [0.1, 0.2, 0.3],
        ups: Vec::new(),
        animations: Vec::new(),
        warnings: Vec::new(),
    }
}

#[test]
fn everything_comes_back() {
    let scene = full_scene();
    for mesh in &scene.meshes {
        mesh.check().unwrap();
    }
    let text = scene_json::write(&scene).unwrap();
    let back = load(&text).unwrap();
    assert_equal(&scene, &back);
    assert_eq!(back.warnings, [""; 0]);
    assert_eq!(scene_json::write(&back).unwrap(), text);
    let empty = load(&scene_json::write(&Scene::default()).unwrap()).unwrap();
    assert_equal(&empty, &Scene::default());
}

#[test]
fn every_builtin_scene_comes_back() {
    for (name, _) in vitral_scene::builtin::names() {
        let scene = vitral_scene::builtin::scene(name).unwrap();
        assert_equal(&scene, &load(&scene_json::write(&scene).unwrap()).unwrap());
    }
}

#[test]
fn infinite_coordinates_come_back_as_nan() {
    let mut scene = full_scene();
    let mut mesh = full_mesh();
    mesh.positions[0] = [f32::INFINITY, 1.0, f32::NAN];
    mesh.normals.as_mut().unwrap().values[0] = [f32::NAN, 0.0, 1.0];
    scene.meshes[0] = Arc::new(mesh);
    let back = load(&scene_json::write(&scene).unwrap()).unwrap();
    let p = back.meshes[0].positions[0];
    assert!(p[0].is_nan() && p[1] == 1.0 && p[2].is_nan());
    assert_eq!(back.meshes[0].normals.as_ref().unwrap().values[0], [0.0, 0.0, 1.0]);
}

#[test]
fn what_could_not_be_read_back_is_not_written() {
    let refused = |change: fn(&mut Scene), part: &str| {
        let mut scene = full_scene();
        change(&mut scene);
        let error = scene_json::write(&scene).unwrap_err();
        assert!(
            matches!(error, Error::Encode { .. }) && error.to_string().contains(part),
            "{error}"
        );
    };
    refused(
        |scene| scene.materials[0].occlusion_strength = 3.0,
        "materials[0]: ``: occlusion-strength 3",
    );
    refused(|scene| scene.lights[0].diffuse = [-1.0; 3], "lights[0]: ");
    refused(|scene| scene.ambient = [f32::NAN; 3], "ambient[0]: ");
    refused(|scene| scene.roots.push(99), "node 99");
}

#[test]
fn the_smallest_files() {
    let teapot = load(r#"{"vitral-scene":1,"meshes":[{"builtin":"teapot"}]}"#).unwrap();
    assert!(World::new(&teapot).unwrap().facet_count > 500);
    let text = r#"{"vitral-scene":1,"materials":[{}],"meshes":[{"positions":[[0,0,0],[1,0,0],[0,1,0]],"triangles":[[0,1,2]],"material":0}]}"#;
    let scene = load(text).unwrap();
    assert_eq!(
        (scene.nodes.len(), scene.roots.as_slice(), scene.meshes[0].parts[0].material),
        (1, &[0][..], Some(0))
    );
    assert!(load(r#"{"vitral-scene":1}"#).unwrap().nodes.is_empty());
}

#[test]
fn the_first_model_says_which_way_is_up() {
    let solid = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a";
    let files = Memory::with(&[("a.x", solid), ("b.obj", SQUARE)]);
    let ups = |meshes: &str| {
        let text = format!(r#"{{"vitral-scene":1,"meshes":[{meshes}]}}"#);
        vitral_io::load(text.as_bytes(), "-", &files, &Workers::single()).unwrap().ups
    };
    assert_eq!(ups(r#"{"file":"a.x"}"#), [Axis::PlusZ], "by content, not by name");
    assert_eq!(ups(r#"{"file":"b.obj"},{"file":"a.x"}"#), [Axis::PlusY, Axis::PlusZ]);
    assert_eq!(ups(r#"{"builtin":"cubs"},{"file":"b.obj"}"#), [Axis::PlusY]);
    assert_eq!(ups(""), [Axis::PlusY]);
}

#[test]
fn cameras_without_a_node_stand_in_the_world() {
    let camera = |x: u32| {
        format!(
            r#"{{"position":[{x},0,5],"focal-point":[{x},0,0],"view-up":[0,1,0],"projection":{{"type":"parallel","height":1}}}}"#
        )
    };
    let text = format!(
        r#"{{"vitral-scene":1,"meshes":[{{"builtin":"sphere"}}],"cameras":[{},{},{}],
        "nodes":[{{"mesh":0}},{{"camera":1,"translation":[0,7,0]}}]}}"#,
        camera(0),
        camera(1),
        camera(2)
    );
    let scene = load(&text).unwrap();
    let seen = World::new(&scene).unwrap().cameras;
    // The sphere brings a camera of its own, which comes last.
    assert_eq!(seen.len(), 4);
    let places = [DVec3::new(0.0, 0.0, 5.0), DVec3::new(1.0, 7.0, 5.0), DVec3::new(2.0, 0.0, 5.0)];
    assert_eq!(seen[..3].iter().map(|c| c.position).collect::<Vec<_>>(), places);
    let back = load(&scene_json::write(&scene).unwrap()).unwrap();
    assert_equal(&scene, &back);
}

const SQUARE: &str = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl red\nf 1 2 3 4\n";

#[test]
fn references_are_followed_from_folder_to_folder() {
    let files = Memory::with(&[
        (
            "parts/a.json",
            r#"{"vitral-scene":1,"meshes":[{"file":"obj/square.obj"}],"lights":[{"name":"lamp"}],
            "nodes":[{"mesh":0,"translation":[0,0,1]},{"mesh":0,"translation":[0,0,2]}],"ambient":[0.5,0,0]}"#,
        ),
        ("parts/obj/square.obj", SQUARE),
        ("parts/obj/m.mtl", "newmtl red\nKd 1 0 0\n"),
    ]);
    let text = r#"{"vitral-scene":1,"materials":[{"name":"blue"}],
        "meshes":[{"file":"./parts/a.json"},{"file":"parts/x/../obj/square.obj","material":0}],
        "nodes":[{"mesh":0,"translation":[10,0,0]},{"mesh":0,"translation":[20,0,0]},{"mesh":1}]}"#;
    let scene =
        scene_json::load(text.as_bytes(), "dir/root.json", &files, &Workers::single()).unwrap();
    assert_eq!(scene.warnings, [""; 0]);
    let world = World::new(&scene).unwrap();
    let at: Vec<DVec3> = world.instances.iter().map(|i| i.bounds.min).collect();
    let expected = [(10.0, 1.0), (10.0, 2.0), (20.0, 1.0), (20.0, 2.0), (0.0, 0.0)];
    assert_eq!(at, expected.map(|(x, z)| DVec3::new(x, 0.0, z)));
    assert_eq!(
        world.lights.iter().filter(|l| l.name == "lamp").count(),
        2,
        "a light for each place"
    );
    assert_eq!(scene.ambient, [0.5, 0.0, 0.0]);

    // Placed four times, the square of a.json is one mesh; with another material it is another one.
    let meshes: Vec<u32> = world.instances.iter().map(|i| i.mesh_index).collect();
    assert!(meshes[..4].iter().all(|&m| m == meshes[0]) && meshes[4] != meshes[0]);
    let material = |i: usize| {
        scene.materials[world.instances[i].mesh.parts[0].material.unwrap() as usize].name.clone()
    };
    assert_eq!((material(0), material(4)), ("red".to_owned(), "blue".to_owned()));
}

#[test]
fn what_is_no_object_is_told_in_words() {
    for (text, what) in [
        (
            "[]",
            "a.json: line 1: column 1: a scene file is an object, `{ \"vitral-scene\": 1, ... }`",
        ),
        ("{", "a.json: line 1: column 1: EOF while parsing an object"),
        (
            r#"{"vitral-scene":1,"nodes":[3]}"#,
            "nodes[0]: invalid type: integer `3`, expected an object",
        ),
        (
            r#"{"vitral-scene":1,"materials":[7]}"#,
            "materials[0]: invalid type: integer `7`, expected an object",
        ),
        (
            r#"{"vitral-scene":1,"lights":[[]]}"#,
            "lights[0]: invalid type: sequence, expected an object",
        ),
        (
            r#"{"vitral-scene":1,"nodes":[{"light":[]}]}"#,
            "nodes[0].light: invalid type: sequence, expected an object",
        ),
        (
            r#"{"vitral-scene":1,"meshes":[{},["a.obj"]]}"#,
            "meshes[1]: invalid type: sequence, expected an object",
        ),
        (
            r#"{"vitral-scene":1,"nodes":[[]]}"#,
            "nodes[0]: invalid type: sequence, expected an object",
        ),
    ] {
        let error = load(text).unwrap_err().to_string();
        assert!(error.contains(what), "{error}");
    }
}

#[test]
fn circles_depth_and_floods_are_refused() {
    let fails = |files: &Memory, text: &str, part: &str| {
        let error = scene_json::load(text.as_bytes(), "root.json", files, &Workers::single())
            .unwrap_err()
            .to_string();
        assert!(error.contains(part), "{error}");
    };
    let refer = |to: &str| format!(r#"{{"vitral-scene":1,"meshes":[{{"file":"{to}"}}]}}"#);
    let circle = Memory::with(&[("x/b.json", &refer("../root.json"))]);
    fails(
        &circle,
        &refer("x/b.json"),
        "x/b.json: meshes[0]: needs `../root.json`: it refers back to itself",
    );
    fails(&Memory::default(), &refer("no.obj"), "needs `no.obj`: there is no such file");
    fails(&Memory::default(), &refer("../out.obj"), "outside the model's folder");

    let chain: Vec<(String, String)> =
        (1..12).map(|i| (format!("{i}.json"), refer(&format!("{}.json", i + 1)))).collect();
    let deep = Memory(chain.into_iter().map(|(name, text)| (name, text.into_bytes())).collect());
    fails(&deep, &refer("1.json"), "scene files are read 8 deep");

    // Each file shows the next one a hundred times: 10^8 nodes.
    let many = |to: &str| {
        format!(
            r#"{{"vitral-scene":1,"meshes":[{{"file":"{to}"}}],"nodes":[{}]}}"#,
            vec![r#"{"mesh":0}"#; 100].join(",")
        )
    };
    let flood = Memory::with(&[
        ("1.json", &many("2.json")),
        ("2.json", &many("3.json")),
        ("3.json", &many("4.json")),
        ("4.json", r#"{"vitral-scene":1,"nodes":[{}]}"#),
    ]);
    fails(&flood, &many("1.json"), "there are more than 1048576 nodes");
}

#[test]
fn lights_that_cannot_shine_are_refused() {
    for (kind, part) in [
        (
            r#""directional","direction":[0,0,0]"#,
            "direction: a direction of some length is required",
        ),
        (
            r#""spot","position":[0,0,0],"direction":[0,1,0],"cutoff":0,"inner":0,"exponent":0"#,
            "cutoff: a half angle above 0",
        ),
        (
            r#""area","shape":{"shape":"polygon","corners":[[0,5,0],[1,5,0],[2,5,0]]}"#,
            "corners: a polygon with an area is required",
        ),
        (
            r#""spot","position":[0,0,0],"direction":[0,1,0],"cutoff":0.5,"inner":0.6,"exponent":0"#,
            "inner: a half angle from 0 to the cutoff",
        ),
        (
            r#""ambient"},"ambient":[0,-1,0],"attenuation":{"form":"none""#,
            "intensities of at least 0 are required",
        ),
        (
            r#""ambient"},"attenuation":{"form":"clamped","c1":1,"c2":-1,"c3":0"#,
            "attenuation: three terms of at least 0",
        ),
    ] {
        let light = format!(r#"{{"kind":{{"type":{kind}}}}}"#);
        let error = load(&format!(r#"{{"vitral-scene":1,"lights":[{{}},{light}]}}"#))
            .unwrap_err()
            .to_string();
        assert!(error.contains("lights[1]") && error.contains(part), "{error}");
        let error = load(&format!(r#"{{"vitral-scene":1,"nodes":[{{"light":{light}}}]}}"#))
            .unwrap_err()
            .to_string();
        assert!(error.contains("nodes[0].light") && error.contains(part), "{error}");
    }
    let point = r#"{"shape":"disc","center":[0,1,0],"normal":[0,-1,0],"radius":0}"#;
    let text =
        format!(r#"{{"vitral-scene":1,"lights":[{{"kind":{{"type":"area","shape":{point}}}}}]}}"#);
    assert!(load(&text).is_ok(), "a disc of radius 0 is a point");
    let error = load(r#"{"vitral-scene":1,"ambient":[0.1,-0.1,0.1]}"#).unwrap_err().to_string();
    assert!(error.contains("ambient: intensities of at least 0 are required"), "{error}");
}

#[test]
fn materials_out_of_range_are_refused() {
    for (property, part) in [
        (r#""opacity":-0.5"#, "materials[1]: `glass`: opacity -0.5: 0 to 1 is required"),
        (r#""opacity":1.001"#, "opacity 1.001: 0 to 1 is required"),
        (r#""ior":0"#, "index of refraction 0: a number above 0 is required"),
        (r#""ior":-1.5"#, "index of refraction -1.5"),
        (r#""filter":[1,2,0]"#, "filter 2: 0 to 1 in each channel is required"),
        (r#""occlusion-strength":2"#, "occlusion-strength 2: 0 to 1 is required"),
        (r#""emission":[0,-1,0]"#, "emission -1: a number of at least 0 is required"),
        (
            r#""reflectance":{"form":"metallic-roughness","base-color":[1,1,1],"metallic":1.5,"roughness":0.5}"#,
            "metallic 1.5: 0 to 1 is required",
        ),
        (
            r#""reflectance":{"form":"phong","ka":[0,0,0],"kd":[0,0,0],"ks":[0,0,0],"shininess":-3}"#,
            "shininess -3: a number of at least 0 is required",
        ),
    ] {
        let text =
            format!(r#"{{"vitral-scene":1,"materials":[{{}},{{"name":"glass",{property}}}]}}"#);
        let error = load(&text).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
    assert!(
        load(r#"{"vitral-scene":1,"materials":[{"opacity":0,"ior":0.7,"filter":[0,1,0.5]}]}"#)
            .is_ok()
    );
}

#[test]
fn what_is_wrong_is_told_with_its_place() {
    for (text, part) in [
        ("{\n\"vitral-scene\": 1,\n\"mesh\": []}", "a.json: line 3: column 6: "),
        ("{\n\"vitral-scene\": 1,\n\"nodes\": [{\"childs\": [1]}]}", "nodes[0]"),
        ("{\"vitral-scene\": 1} x", "line 1: column 21: "),
        (r#"{"vitral-scene":2}"#, "version 2"),
        (r#"{"vitral-scene":1,"nodes":[{"mesh":3}]}"#, "nodes[0].mesh: mesh 3, there are 0"),
        (r#"{"vitral-scene":1,"nodes":[{"camera":0}]}"#, "nodes[0].camera: camera 0, there are 0"),
        (
            r#"{"vitral-scene":1,"nodes":[{"children":[0]}]}"#,
            "nodes[0]: the node is its own ancestor",
        ),
        (
            r#"{"vitral-scene":1,"nodes":[{"children":[2]},{"children":[2]},{}]}"#,
            "nodes[1].children[0]: node 2 has a parent",
        ),
        (
            r#"{"vitral-scene":1,"nodes":[{}],"roots":[0,0]}"#,
            "roots[1]: node 0 is in the tree already",
        ),
        (
            r#"{"vitral-scene":1,"nodes":[{"matrix":[1,0,0,1,0,1,0,0,0,0,1,0,0,0,0,1]}]}"#,
            "0 0 0 1 as its last row",
        ),
        (r#"{"vitral-scene":1,"nodes":[{"rotation":[0,0,0,0]}]}"#, "is zero"),
        (
            r#"{"vitral-scene":1,"materials":[{"opacity":1e39}]}"#,
            "materials[0].opacity: number out of range",
        ),
        (
            r#"{"vitral-scene":1,"materials":[{"base-texture":{"texture":0}}]}"#,
            "materials[0]: texture 0, there are 0",
        ),
        (r#"{"vitral-scene":1,"meshes":[{"positions":[],"points":[0]}]}"#, "meshes[0]: "),
        (
            r#"{"vitral-scene":1,"meshes":[{"points":[],"material":0}]}"#,
            "meshes[0]: material 0, there are 0",
        ),
        (
            r#"{"vitral-scene":1,"meshes":[{"builtin":"cow"}]}"#,
            "no built-in scene `cow`; there are cubs, sphere",
        ),
        (r#"{"vitral-scene":1,"textures":[{}]}"#, "textures[0]: either `file` or `data`"),
        (
            r#"{"vitral-scene":1,"lights":[{"diffuse":[1e39,0,0]}]}"#,
            "lights[0].diffuse[0]: number out of range",
        ),
        (
            r#"{"vitral-scene":1,"cameras":[{"position":[0,0,1],"focal-point":[0,0,0],"view-up":[0,1,0],"projection":{"type":"perspective","view-angle":4}}]}"#,
            "cameras[0].projection",
        ),
    ] {
        let message = load(text).map(|_| ()).unwrap_err().to_string();
        assert!(message.contains(part), "{text}\n{message}");
    }
    let missing =
        load(r#"{"vitral-scene":1,"textures":[{"file":"no.png"}],"materials":[{"base-texture":{"texture":0}}]}"#)
            .unwrap();
    assert_eq!(
        (missing.warnings.len(), missing.materials[0].base_texture, missing.textures.len()),
        (1, None, 0)
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damaged_files_never_panic(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)) {
        let mut bytes = scene_json::write(&full_scene()).unwrap().into_bytes();
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if let Ok(scene) = scene_json::load(&bytes, "a.json", &NoFiles, &Workers::single()) {
            for mesh in &scene.meshes {
                mesh.check().unwrap();
            }
            World::new(&scene).unwrap();
        }
    }

    #[test]
    fn numbers_survive_exactly(x in any::<f64>().prop_filter("finite", |x| x.is_finite()), y in any::<f32>().prop_filter("finite", |y| y.is_finite())) {
        let mut scene = Scene::from_mesh(Mesh { positions: vec![[y; 3]], points: vec![0], ..Mesh::default() });
        scene.nodes[0].transform = NodeTransform::Parts { translation: DVec3::splat(x), rotation: DQuat::IDENTITY, scale: DVec3::ONE };
        assert_equal(&scene, &load(&scene_json::write(&scene).unwrap()).unwrap());
    }
}

/// What docs/scene-format.md shows can be copied.
#[test]
fn the_examples_of_the_documentation_are_read() {
    let text =
        std::fs::read_to_string(vitral_testkit::fixture::repository().join("docs/scene-format.md"))
            .unwrap();
    let examples: Vec<&str> =
        text.split("```json\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    assert_eq!(examples.len(), 2);
    for example in examples {
        let beside = vitral_testkit::fuzz::Beside::default();
        let scene = scene_json::load(example.as_bytes(), "a.json", &beside, &Workers::single());
        let scene = scene.unwrap_or_else(|e| panic!("{e}\n{example}"));
        assert!(scene.warnings.is_empty() && !scene.meshes.is_empty(), "{:?}", scene.warnings);
    }
}

#[test]
fn the_documentation_has_all_builtin_scenes() {
    let text =
        std::fs::read_to_string(vitral_testkit::fixture::repository().join("docs/scene-format.md"))
            .unwrap();
    for (name, _) in vitral_scene::builtin::names() {
        assert!(text.contains(&format!("`{name}`")), "{name}");
    }
}

/// Every key is written with hyphens, as the documentation says.
#[test]
fn keys_have_hyphens() {
    let text = scene_json::write(&full_scene()).unwrap();
    let keys = text.split('"').skip(1).step_by(2);
    let wrong: Vec<&str> =
        keys.filter(|key| key.contains('_') && !key.starts_with("data:")).collect();
    assert!(wrong.is_empty(), "{wrong:?}");
}
