//! What pictures look like without options: colours as displays show them, forms that read as
//! forms, metals that mirror.

use crate::pictures::common::one;
use vitral::internals::io::{ResolveError, Resolver};
use vitral::{
    Background, Channel, DVec3, Environment, FileColors, Illumination, LoadOptions, Material,
    Reflectance, Renderer, Scene, View, load_builtin, load_bytes_with, solids,
};

/// Files by name.
struct Files(Vec<(&'static str, Vec<u8>)>);

impl Resolver for Files {
    fn read(&self, path: &str) -> Result<Vec<u8>, ResolveError> {
        let file = self.0.iter().find(|(name, _)| *name == path).ok_or(ResolveError::NotFound)?;
        Ok(file.1.clone())
    }
}

/// A square that fills the front view, with a library that holds this.
fn square(library: &str, options: &LoadOptions) -> Scene {
    let text =
        "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1 4/1\n";
    // Type 2, one pixel of 24 bits.
    let mut texture = vec![0; 21];
    (texture[2], texture[12], texture[14], texture[16]) = (2, 1, 1, 24);
    texture[18..].copy_from_slice(&[0, 128, 255]);
    let files = Files(vec![("a.mtl", library.as_bytes().to_vec()), ("t.tga", texture)]);
    load_bytes_with(text.as_bytes(), "a.obj", &files, options).unwrap()
}

/// The middle pixel of a scene seen from the front, each surface in its own colour.
fn shown(scene: Scene) -> [u8; 3] {
    let mut renderer = Renderer::new(scene).unwrap();
    let picture = &mut renderer.settings.picture;
    (picture.width, picture.height, picture.samples) = (9, 9, 1);
    renderer.settings.shading.illumination = Illumination::Constant;
    renderer.view = View::Front;
    let [r, g, b, _] = *renderer.render().unwrap().frame.color.unwrap().at(4, 4);
    [r, g, b]
}

/// A renderer of pictures of this size.
fn sized(scene: Scene, width: u32, height: u32) -> Renderer {
    let mut renderer = Renderer::new(scene).unwrap();
    (renderer.settings.picture.width, renderer.settings.picture.height) = (width, height);
    renderer
}

#[test]
fn colours_of_material_libraries_are_shown_as_they_are_written() {
    let red = "newmtl a\nKd 0.69 0.20 0.19\n";
    assert_eq!(shown(square(red, &LoadOptions::default())), [176, 51, 48]);
    let linear = LoadOptions { file_colors: FileColors::Linear, ..LoadOptions::default() };
    assert_eq!(shown(square(red, &linear)), [216, 124, 121]);
    // What shines brighter than a display can show keeps its strength.
    let lamp = square("newmtl a\nKe 5 0.5 0\n", &LoadOptions::default());
    assert_eq!(lamp.materials[0].emission[0], 5.0);
    assert!((lamp.materials[0].emission[1] - 0.214).abs() < 1e-3);
}

#[test]
fn raw_colours_are_the_numbers_of_the_file() {
    let file = std::env::temp_dir().join(format!("vitral-looks-{}.obj", std::process::id()));
    let library = file.with_extension("mtl");
    std::fs::write(&library, "newmtl a\nKd 0.69 0.20 0.19\n").unwrap();
    let name = library.file_name().unwrap().to_string_lossy().into_owned();
    std::fs::write(&file, format!("mtllib {name}\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl a\nf 1 2 3\n"))
        .unwrap();
    let mut state = vitral::State {
        models: vec![file.to_string_lossy().into_owned()],
        ..vitral::State::default()
    };
    let kd = |state: &vitral::State| match state.load_scene().unwrap().materials[0].reflectance {
        Reflectance::Phong { kd, .. } => kd,
        other => panic!("{other:?}"),
    };
    assert!((kd(&state)[0] - 0.4336).abs() < 1e-3);
    state.settings.picture.color_space = vitral::ColorSpace::Raw;
    assert_eq!(kd(&state), [0.69, 0.20, 0.19]);
    std::fs::remove_file(file).unwrap();
    std::fs::remove_file(library).unwrap();
}

#[test]
fn a_colour_beside_a_texture_multiplies_only_if_it_is_told_to() {
    let dark = "newmtl a\nKd 0.1 0.1 0.1\nmap_Kd t.tga\n";
    let mut scene = square(dark, &LoadOptions::default());
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    assert_eq!(shown(scene.clone()), [255, 128, 0]);
    vitral::override_material(&mut scene, "a", "texture-tint", "multiply").unwrap();
    // 0.1 is 0.01 in linear light.
    assert_eq!(shown(scene), [26, 7, 0]);
    // Without its texture the colour is all that there is.
    assert_eq!(
        shown(square("newmtl a\nKd 1 0 0\nmap_Kd gone.tga\n", &LoadOptions::default())),
        [255, 0, 0]
    );
}

#[test]
fn the_edges_of_a_box_are_sharp_inside_a_smoothing_group() {
    let corners =
        "v -3 -1 -1\nv 3 -1 -1\nv 3 1 -1\nv -3 1 -1\nv -3 -1 1\nv 3 -1 1\nv 3 1 1\nv -3 1 1\n";
    let faces = "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 1 5 8 4\n";
    let picture = |smoothing: &str, crease_angle: Option<f64>| {
        let options = LoadOptions { crease_angle, ..LoadOptions::default() };
        let text = format!("{corners}{smoothing}{faces}");
        let scene =
            load_bytes_with(text.as_bytes(), "box.obj", &Files(Vec::new()), &options).unwrap();
        let mut renderer = sized(scene, 64, 48);
        renderer.render().unwrap().frame.color.unwrap().into_data()
    };
    assert!(picture("s 1\n", None) == picture("", None));
    assert!(
        picture("s 1\n", Some(std::f64::consts::PI)) != picture("", None),
        "a wide angle smooths all"
    );
}

#[test]
fn polished_metal_shows_a_horizon() {
    let tones = |metallic: f32, roughness: f32, environment: Environment| {
        let reflectance =
            Reflectance::MetallicRoughness { base_color: [0.9; 3], metallic, roughness };
        let ball =
            one(solids::sphere(1.0, 64, 32), Material { reflectance, ..Material::default() });
        let mut renderer = sized(ball, 96, 96);
        renderer.settings.picture.background = Background::Transparent;
        renderer.settings.shading.environment = environment;
        renderer.view = View::Front;
        let picture = renderer.render().unwrap().frame.color.unwrap();
        // From above to below through the middle.
        (20..76).map(|y| i32::from(picture.at(48, y)[1])).collect::<Vec<_>>()
    };
    let spread = |tones: &[i32]| tones.iter().max().unwrap() - tones.iter().min().unwrap();
    let chrome = tones(1.0, 0.05, Environment::Sky);
    let step = chrome.windows(6).map(|w| (w[0] - w[5]).abs()).max().unwrap();
    assert!(spread(&chrome) > 90 && step > 60, "bright above, dark below: {chrome:?}");
    let brushed = tones(1.0, 0.6, Environment::Sky);
    let soft = brushed.windows(6).map(|w| (w[0] - w[5]).abs()).max().unwrap();
    assert!(soft < step, "{brushed:?}");
    // Matt dielectrics hardly mirror.
    let (with, without) = (tones(0.0, 1.0, Environment::Sky), tones(0.0, 1.0, Environment::None));
    assert!(with.iter().zip(&without).all(|(a, b)| (a - b).abs() < 14), "{with:?} {without:?}");
}

#[test]
fn models_with_empirical_materials_mirror_no_sky() {
    let picture = |environment| {
        let mut renderer = sized(load_builtin("teapot").unwrap(), 64, 48);
        renderer.settings.shading.environment = environment;
        renderer.render().unwrap().frame.color.unwrap().into_data()
    };
    assert!(picture(Environment::Sky) == picture(Environment::None));
}

/// A ball of points as a PLY file, with normals or without.
fn ball_of_points(with_normals: bool) -> Scene {
    let ball = solids::sphere(1.0, 96, 48);
    let mut text = format!("ply\nformat ascii 1.0\nelement vertex {}\n", ball.positions.len());
    let names =
        if with_normals { &["x", "y", "z", "nx", "ny", "nz"][..] } else { &["x", "y", "z"] };
    names.iter().for_each(|name| text += &format!("property float {name}\n"));
    text += "end_header\n";
    for [x, y, z] in &ball.positions {
        text += &format!("{x} {y} {z}");
        text += &if with_normals { format!(" {x} {y} {z}\n") } else { "\n".to_owned() };
    }
    load_bytes_with(text.as_bytes(), "ball.ply", &Files(Vec::new()), &LoadOptions::default())
        .unwrap()
}

#[test]
fn points_with_normals_are_lit_and_others_grow_paler_with_distance() {
    let shown = |scene: Scene| {
        let mut renderer = sized(scene, 96, 96);
        renderer.view = View::Front;
        renderer.settings.picture.point_size = 6.0;
        renderer.render().unwrap().frame.color.unwrap()
    };
    let grey = |picture: &vitral::Plane<[u8; 4]>, x, y| i32::from(picture.at(x, y)[1]);
    // The key light comes from the upper left, and below it is darkest.
    let lit = shown(ball_of_points(true));
    assert!(
        grey(&lit, 36, 30) > grey(&lit, 60, 80) + 60,
        "{} {}",
        grey(&lit, 36, 30),
        grey(&lit, 60, 80)
    );

    // In the middle the near side is seen, at the rim what is farther away.
    let bare = shown(ball_of_points(false));
    let rim = (0..20).map(|x| grey(&bare, x, 48)).min().unwrap();
    assert!(grey(&bare, 48, 48) + 20 < rim, "{} {rim}", grey(&bare, 48, 48));

    let mut large = sized(ball_of_points(true), 8, 8);
    large.settings.picture.point_size = 0.0;
    assert!(large.render().unwrap_err().to_string().contains("0.1 to 64"));
}

#[test]
fn what_faces_down_is_not_black() {
    let mut renderer = sized(one(solids::cuboid(DVec3::ONE), Material::default()), 33, 33);
    renderer.view = View::Bottom;
    let [r, g, b, _] = *renderer.render().unwrap().frame.color.unwrap().at(16, 16);
    assert!(r.min(g).min(b) > 60, "{r} {g} {b}");
}

#[test]
fn the_default_view_looks_slightly_down_and_centres_the_model() {
    let mut renderer = sized(load_builtin("teapot").unwrap(), 256, 256);
    let camera = renderer.frame_camera();
    let away = (camera.position - camera.focal_point).normalize();
    // The sines of 15 and 25 degrees.
    assert!((0.26..0.42).contains(&away.y), "{away}");

    Channel::Depth.request(&mut renderer.settings.picture.channels);
    let depth = renderer.render().unwrap().frame.depth.unwrap();
    let seen: Vec<(u32, u32)> = (0..256)
        .flat_map(|y| (0..256).map(move |x| (x, y)))
        .filter(|&(x, y)| *depth.at(x, y) > 0.0)
        .collect();
    let margins = |of: fn(&(u32, u32)) -> u32| {
        let (least, most) =
            (seen.iter().map(of).min().unwrap(), seen.iter().map(of).max().unwrap());
        (least, 255 - most)
    };
    let ((left, right), (above, below)) = (margins(|p| p.0), margins(|p| p.1));
    assert!(
        left.abs_diff(right) <= 2 && above.abs_diff(below) <= 6,
        "{left} {right} {above} {below}"
    );
    assert!((10..=16).contains(&left), "the model fills the width: {left}");
}
