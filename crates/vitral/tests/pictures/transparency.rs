//! Transparent surfaces in whole pictures: models, orders, and what they do to each other.

use super::common::{colors, exact, largest_difference, on_z, one, settings_error, sun};
use std::sync::Arc;
use vitral::internals::frame::TwoBuffers;
use vitral::internals::render::registry::VISIBILITY;
use vitral::internals::render::transparency::registry::ORDERS;
use vitral::{
    AlphaMode, Attribute, Background, Camera, DMat4, DVec3, Encoding, Global, Lines, Material,
    Mesh, Part, Plane, Projection, Reflectance, Renderer, Scene, SettingsError, Shading, Texture,
    TextureRef, Transparency, TransparencyOrder, solids,
};

/// A square from -1 to 1 at height `z`, which rises by `slope` along x.
pub(crate) fn square(z: f32, slope: f32) -> Mesh {
    let corner = |x: f32, y: f32| [x, y, z + slope * x];
    Mesh {
        positions: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        parts: vec![Part { name: String::new(), triangles: 0..2, material: None }],
        ..Mesh::default()
    }
}

/// Glass without light of its own but its colour.
pub(crate) fn glass(color: [f32; 3], kt: f32) -> Material {
    let reflectance = Reflectance::Phong { ka: color, kd: color, ks: [0.0; 3], shininess: 1.0 };
    let mut material =
        Material { reflectance, unlit: true, alpha_mode: AlphaMode::Blend, ..Material::default() };
    material.set_kt(kt);
    material
}

/// A scene of meshes with a material each, submitted in this order.
fn scene_of(parts: impl IntoIterator<Item = (Mesh, Material)>) -> Scene {
    let mut scene = Scene::default();
    for (mut mesh, material) in parts {
        let material = Some(scene.add_material(material));
        mesh.parts.iter_mut().for_each(|p| p.material = material);
        scene.add_mesh(mesh, DMat4::IDENTITY);
    }
    scene
}

/// Panes that cross each other, a glass ball, and something opaque among them.
fn glasses() -> Vec<(Mesh, Material)> {
    let mut opaque = glass([0.9, 0.8, 0.1], 0.0);
    opaque.alpha_mode = AlphaMode::Opaque;
    vec![
        (square(-0.8, 0.1), glass([0.9, 0.1, 0.1], 0.3)),
        (square(0.1, 0.9), glass([0.1, 0.8, 0.2], 0.6)),
        (square(0.2, -0.7), glass([0.2, 0.1, 0.9], 0.5)),
        (solids::sphere(0.6, 24, 12), glass([0.7, 0.7, 0.7], 0.7)),
        (square(-0.3, -0.2), opaque),
    ]
}

fn renderer(parts: Vec<(Mesh, Material)>, order: TransparencyOrder, samples: u32) -> Renderer {
    let mut renderer = exact(scene_of(parts), 90, 70);
    renderer.camera = Some(on_z(3.0, 0.9));
    (renderer.settings.transparency.order, renderer.settings.picture.samples) = (order, samples);
    renderer
}

#[test]
fn t10_t11_t12_f6_exact_orders_agree_in_every_algorithm_and_permutation() {
    for samples in [1, 4] {
        let reference = colors(&mut renderer(glasses(), TransparencyOrder::SORTED, samples));
        for order in ORDERS.iter().filter(|o| o.exact && !o.needs_list) {
            let own = colors(&mut renderer(glasses(), order.choice(), samples));
            assert!(largest_difference(&own, &reference) <= 1, "{}, {samples}", order.name);
            for turn in 0..5 {
                let mut parts = glasses();
                parts.rotate_left(turn);
                parts.swap(0, 3);
                let mut permuted = renderer(parts, order.choice(), samples);
                assert!(
                    colors(&mut permuted) == own,
                    "{}, {samples} samples, permutation {turn}",
                    order.name
                );
            }
        }
        for algorithm in VISIBILITY {
            for order in ORDERS.iter().filter(|o| !o.needs_list) {
                let mut r = renderer(glasses(), order.choice(), samples);
                let expected = colors(&mut r);
                r.settings.visibility = algorithm.choice();
                assert!(
                    colors(&mut r) == expected,
                    "{} with {}, {samples}",
                    algorithm.name,
                    order.name
                );
            }
        }
    }
}

/// All orders of so many things.
fn permutations(count: usize) -> Vec<Vec<usize>> {
    if count == 0 {
        return vec![Vec::new()];
    }
    let longer = |shorter: Vec<usize>| {
        (0..count).map(move |at| {
            let mut order = shorter.clone();
            order.insert(at, count - 1);
            order
        })
    };
    permutations(count - 1).into_iter().flat_map(longer).collect()
}

#[test]
fn t11_all_permutations_are_bit_equal_in_exact_orders_and_not_in_inexact_ones() {
    let orders = permutations(glasses().len());
    assert_eq!(orders.len(), 120);
    for order in ORDERS.iter().filter(|o| !o.needs_list) {
        let mut pictures: Vec<Vec<[u8; 4]>> = Vec::new();
        for permutation in &orders {
            if pictures.len() > 1 {
                break;
            }
            let parts = permutation.iter().map(|&part| glasses().swap_remove(part)).collect();
            let mut r = renderer(parts, order.choice(), 1);
            (r.settings.picture.width, r.settings.picture.height) = (36, 28);
            let picture = colors(&mut r);
            if !pictures.contains(&picture) {
                pictures.push(picture);
            }
        }
        assert_eq!(pictures.len() == 1, order.exact, "{}", order.name);
    }
}

#[test]
fn t10_the_lists_of_painter_and_bsp_give_what_sorting_gives() {
    for samples in [1, 4] {
        let reference = colors(&mut renderer(glasses(), TransparencyOrder::SORTED, samples));
        for algorithm in VISIBILITY {
            let mut r = renderer(glasses(), TransparencyOrder::BACK_TO_FRONT, samples);
            r.settings.visibility = algorithm.choice();
            if !algorithm.makes_list() {
                let error = r.render().unwrap_err();
                assert!(error.to_string().contains("painter, bsp"), "{}: {error}", algorithm.name);
                assert!(matches!(settings_error(&error), SettingsError::ListOrder { .. }));
                continue;
            }
            let rendered = r.render().unwrap();
            assert!(rendered.stats.visibility.splits > 0, "{}: the panes cross", algorithm.name);
            let own = rendered.frame.color.unwrap().into_data();
            let apart = |own: &[[u8; 4]]| {
                let far = |(a, b): &(&[u8; 4], &[u8; 4])| {
                    a.iter().zip(*b).any(|(x, y)| x.abs_diff(*y) > 1)
                };
                own.iter().zip(&reference).filter(far).count()
            };
            // The tree cuts where planes of the world meet, depths are those of corners that were
            // snapped to 1/256 pixel: a sample between the two has another order, and depth has the
            // last word. There are few of them.
            let picture = rendered.stats.picture;
            assert!(
                picture.overruled_layers * 5000 <= picture.layer_samples,
                "{}: {picture:?}",
                algorithm.name
            );
            assert_eq!(apart(&own), 0, "{}, {samples} samples", algorithm.name);
            for turn in 0..5 {
                let mut parts = glasses();
                parts.rotate_left(turn);
                parts.swap(0, 3);
                let mut permuted = renderer(parts, TransparencyOrder::BACK_TO_FRONT, samples);
                permuted.settings.visibility = algorithm.choice();
                let apart = apart(&colors(&mut permuted));
                assert_eq!(apart, 0, "{}, {samples} samples, permutation {turn}", algorithm.name);
            }
        }
    }
}

#[test]
fn t10_lines_take_their_place_among_the_panes_of_a_list() {
    for visibility in ["painter", "bsp"] {
        let picture = |order| {
            let mut r = renderer(glasses(), order, 4);
            (r.settings.picture.lines, r.settings.visibility) =
                (Lines::Edges, visibility.parse().unwrap());
            colors(&mut r)
        };
        let (own, sorted) =
            (picture(TransparencyOrder::BACK_TO_FRONT), picture(TransparencyOrder::SORTED));
        let apart = own.iter().zip(&sorted).filter(|(a, b)| a != b).count();
        assert!(apart <= 2, "{visibility}: {apart} pixels");
    }
}

#[test]
fn rays_take_no_order() {
    let mut r = renderer(glasses(), TransparencyOrder::SORTED, 1);
    r.settings.global.model = Global::RayTrace;
    let error = r.render().unwrap_err();
    assert!(matches!(settings_error(&error), SettingsError::OrderOfRays("sorted")), "{error}");
    assert!(error.to_string().contains("`sorted`"), "{error}");
}

#[test]
fn t11_f8_e3_inexact_orders_show_their_error_and_are_exact_for_one_layer() {
    let mut turned = glasses();
    turned.reverse();
    let exact = colors(&mut renderer(glasses(), TransparencyOrder::A_BUFFER, 1));
    for order in ORDERS.iter().filter(|o| !o.exact) {
        let first = colors(&mut renderer(glasses(), order.choice(), 1));
        let other = colors(&mut renderer(turned.clone(), order.choice(), 1));
        assert!(
            largest_difference(&first, &other) > 20,
            "{}: the order of the scene shows",
            order.name
        );
        assert!(largest_difference(&first, &exact) > 20, "{}", order.name);
        let panes = || vec![glasses().remove(4), glasses().remove(2)];
        let single = |value| colors(&mut renderer(panes(), value, 4));
        let difference =
            largest_difference(&single(order.choice()), &single(TransparencyOrder::SORTED));
        assert!(difference <= 1, "{}: one layer is exact", order.name);
    }
}

/// The two buffers of a scene, and its picture.
fn two_buffers(parts: Vec<(Mesh, Material)>) -> (TwoBuffers, Vec<[u8; 4]>) {
    let mut renderer = renderer(parts, TransparencyOrder::TWO_BUFFER, 1);
    renderer.settings.picture.channels.buffers = true;
    // Depths of scenes of other extents are compared.
    renderer.camera = renderer.camera.map(|camera| Camera { clip: Some((1.0, 6.0)), ..camera });
    let frame = renderer.render().unwrap().frame;
    (frame.buffers.unwrap(), frame.color.unwrap().into_data())
}

#[test]
fn f7_the_opaque_buffer_does_not_depend_on_the_transparent_list() {
    let (whole, picture) = two_buffers(glasses());
    assert!(
        whole.layers.data().iter().any(|&n| n >= 3)
            && whole.opaque.data().iter().any(|c| c[0] > 0.5)
    );
    let mut turned = glasses();
    turned.reverse();
    let (other, other_picture) = two_buffers(turned);
    assert!(
        whole.opaque == other.opaque && whole.depth == other.depth && whole.layers == other.layers
    );
    assert_ne!(picture, other_picture, "the second buffer does depend on its order");
    // Nothing is on the list: the second buffer is empty and the picture is the first one.
    let (alone, picture) = two_buffers(vec![glasses().remove(4)]);
    assert!(whole.opaque == alone.opaque && whole.depth == alone.depth);
    assert!(
        alone.layers.data().iter().all(|&n| n == 0)
            && alone.coefficient.data().iter().all(|k| *k == [0.0; 3])
    );
    let bytes = alone.opaque.map(|c| c.map(|v| (v * 255.0 + 0.5) as u8));
    assert_eq!(bytes.data(), picture);
}

#[test]
fn f8_one_layer_in_the_second_buffer_is_exact() {
    let (kt, color) = (0.25, [0.2, 0.6, 0.9]);
    let (buffers, picture) =
        two_buffers(vec![(square(0.5, 0.0), glass(color, kt)), glasses().remove(4)]);
    let mut seen = 0;
    for (i, pixel) in picture.iter().enumerate() {
        let (layers, k, light) =
            (buffers.layers.data()[i], buffers.coefficient.data()[i], buffers.intensity.data()[i]);
        let expected = if layers == 0 { 0.0 } else { 1.0 - kt };
        seen += layers;
        for c in 0..3 {
            assert!(
                layers <= 1
                    && (k[c] - expected).abs() < 1e-6
                    && (light[c] - expected * color[c]).abs() < 1e-6
            );
            let combined = light[c] + (1.0 - k[c]) * buffers.opaque.data()[i][c];
            assert!(
                (f32::from(pixel[c]) - 255.0 * combined).abs() <= 0.51,
                "{pixel:?}, {combined}"
            );
        }
    }
    assert!(seen > 500, "{seen}");
}

#[test]
fn t7_f4_stacks_of_one_to_eight_panes_in_a_picture() {
    for n in 1..=8 {
        let panes =
            (0..n).map(|i| (square(0.1 * i as f32, 0.0), glass([0.1 * (i + 1) as f32; 3], 0.5)));
        let mut r = renderer(panes.collect(), TransparencyOrder::A_BUFFER, 4);
        r.settings.picture.background = Background::Color { color: [0.6; 3] };
        let expected = (0..n).fold(0.6f32, |behind, i| 0.5 * 0.1 * (i + 1) as f32 + 0.5 * behind);
        let middle = colors(&mut r)[35 * 90 + 45];
        assert!((f32::from(middle[0]) - 255.0 * expected).abs() <= 1.0, "{n}: {middle:?}");
    }
}

/// A ball of radius 1 in front of black, the row through its middle: place from -1 to 1 and
/// intensity.
fn profile(material: Material, model: Transparency) -> Vec<(f64, f64)> {
    let mut renderer = exact(one(solids::sphere(1.0, 256, 128), material), 201, 201);
    let projection = Projection::Parallel { height: 2.01 };
    renderer.camera = Some(Camera { projection, ..on_z(5.0, 1.0) });
    renderer.settings.transparency.model = model;
    let row = colors(&mut renderer)[100 * 201..101 * 201].to_vec();
    let place = |i: usize| (i as f64 - 100.0) * 0.01;
    row.iter()
        .enumerate()
        .map(|(i, c)| (place(i), f64::from(c[0]) / 255.0))
        .filter(|p| p.0.abs() < 0.97)
        .collect()
}

#[test]
fn t8_t9_f5_the_profile_of_a_glass_ball_tells_kays_model_from_the_linear_one() {
    // Two layers of white glass before black: 1 - kt².
    for (x, seen) in profile(glass([1.0; 3], 0.8), Transparency::Linear) {
        assert!((seen - (1.0 - 0.8 * 0.8)).abs() < 0.01, "linear: flat, {seen} at {x}");
    }
    for (x, seen) in profile(glass([1.0; 3], 0.8), Transparency::Kay) {
        let nz = (1.0 - x * x).sqrt();
        let kt = 0.8 * (1.0 - (1.0 - nz) * (1.0 - nz) * (1.0 - nz));
        assert!(
            (seen - (1.0 - kt * kt)).abs() < 0.012,
            "Kay: {seen} at {x}, not {}",
            1.0 - kt * kt
        );
    }
}

#[test]
fn filtered_glass_tints_what_is_behind() {
    let green = Material { filter: [0.0, 1.0, 0.5], ..glass([0.0; 3], 0.8) };
    let mut r = exact(one(square(0.0, 0.0), green), 20, 20);
    r.camera = Some(on_z(1.0, 0.9));
    r.settings.picture.background = Background::Color { color: [1.0; 3] };
    assert_eq!(colors(&mut r)[210], [204, 204, 204, 255], "the linear model knows no filter");
    r.settings.transparency.model = Transparency::Filtered;
    assert_eq!(colors(&mut r)[210], [0, 204, 102, 255]);
}

#[test]
fn f2_highlights_stay_on_clear_filtered_glass() {
    let mirror = Reflectance::Phong { ka: [0.0; 3], kd: [0.9; 3], ks: [0.5; 3], shininess: 4.0 };
    let clear = Material { reflectance: mirror, unlit: false, ..glass([0.0; 3], 1.0) };
    let mut r = exact(one(square(0.0, 0.0), clear), 20, 20);
    (r.camera, r.lights) = (Some(on_z(1.0, 0.1)), Some(vec![sun(DVec3::Z, 1.0)]));
    r.settings.picture.background = Background::Color { color: [0.2; 3] };
    assert_eq!(colors(&mut r)[210][0], 51, "linear: 1 - kt = 0 leaves nothing of the surface");
    r.settings.transparency.model = Transparency::Filtered;
    let seen = i32::from(colors(&mut r)[210][0]);
    assert!((seen - 179).abs() <= 2, "0.2 behind and the highlight of 0.5: {seen}");
}

#[test]
fn clear_bodies_of_glass_keep_highlights_and_rim() {
    let mirror = Reflectance::Phong { ka: [0.0; 3], kd: [0.0; 3], ks: [0.5; 3], shininess: 4.0 };
    let clear = Material { reflectance: mirror, unlit: false, glass: true, ..glass([0.0; 3], 1.0) };
    let mut r = exact(one(square(0.0, 0.0), clear), 20, 20);
    (r.camera, r.lights) = (Some(on_z(1.0, 0.1)), Some(vec![sun(DVec3::Z, 1.0)]));
    r.settings.picture.background = Background::Color { color: [0.2; 3] };
    let seen = i32::from(colors(&mut r)[210][0]);
    assert!((seen - 176).abs() <= 2, "0.96 of 0.2 behind and the highlight of 0.5: {seen}");

    let white = Material { glass: true, ..glass([1.0; 3], 1.0) };
    for (x, seen) in profile(white, Transparency::Linear) {
        let nz = (1.0 - x * x).sqrt();
        let away = 1.0 - nz;
        let kt = 0.96 * (1.0 - away * away * away * away * away);
        assert!((seen - (1.0 - kt * kt)).abs() < 0.012, "{seen} at {x}, not {}", 1.0 - kt * kt);
    }
}

#[test]
fn textures_of_glass_say_what_factors_say_and_metals_let_nothing_through() {
    // Opacity and metal, by factors and by textures of one texel. A wall behind shows what passes,
    // and how light the shadow is.
    let pane = |opacity: f32, metallic: f32, textured: bool| {
        let mut pane = square(0.0, 0.0);
        pane.uvs = vec![Attribute::per_vertex(vec![[0.5; 2]; pane.positions.len()])];
        let number = |value: f32| if textured { 1.0 } else { value };
        let base_color = [0.0; 3];
        let reflectance = Reflectance::MetallicRoughness {
            base_color,
            metallic: number(metallic),
            roughness: 0.5,
        };
        let texture = |number| textured.then(|| TextureRef::new(number));
        let material = Material {
            reflectance,
            opacity: number(opacity),
            alpha_mode: AlphaMode::Blend,
            glass: true,
            unlit: true,
            opacity_texture: texture(0),
            metallic_roughness_texture: texture(1),
            ..Material::default()
        };
        let reflectance =
            Reflectance::Phong { ka: [0.0; 3], kd: [1.0; 3], ks: [0.0; 3], shininess: 1.0 };
        let wall = (square(-0.5, 0.0), Material { reflectance, ..Material::default() });
        let mut scene = scene_of([wall, (pane, material)]);
        for value in [opacity, metallic] {
            let byte = (value * 255.0).round() as u8;
            let plane = Plane::filled(1, 1, [byte, 255, byte, 255]);
            scene.textures.push(Arc::new(Texture::new("number".into(), plane, Encoding::Linear)));
        }
        scene
    };
    let seen = |opacity, metallic, textured, shadows: &str| {
        let mut r = exact(pane(opacity, metallic, textured), 20, 20);
        (r.camera, r.lights, r.ambient) =
            (Some(on_z(1.0, 0.1)), Some(vec![sun(DVec3::Z, 1.0)]), [0.0; 3]);
        r.settings.shadows.algorithm = shadows.parse().unwrap();
        i32::from(colors(&mut r)[210][0])
    };
    for (opacity, metallic) in [(0.0f32, 0.0f32), (0.4, 0.0), (0.0, 0.6), (0.4, 0.6), (0.2, 1.0)] {
        let kt = (1.0 - opacity) * (1.0 - metallic);
        // Schlick's formula takes 0.04 of what the viewer sees straight on.
        for (shadows, expected) in [("none", 0.96 * kt), ("ray", 0.96 * kt * kt)] {
            for textured in [false, true] {
                let found = seen(opacity, metallic, textured, shadows);
                let expected = (expected * 255.0).round() as i32;
                assert!(
                    (found - expected).abs() <= 2,
                    "{opacity} {metallic} {textured} {shadows}: {found}, not {expected}"
                );
            }
        }
    }
}

#[test]
fn thousands_of_layers_stay_within_their_memory_with_a_warning() {
    let panes: Vec<_> =
        (0..1200).map(|i| (square(-0.5 + 0.0005 * i as f32, 0.0), glass([0.5; 3], 0.98))).collect();
    let run = |parts: Vec<(Mesh, Material)>, memory: u64| {
        let mut r = exact(scene_of(parts), 24, 24);
        r.camera = Some(on_z(3.0, 0.9));
        r.settings.transparency.layer_memory = memory;
        let rendered = r.render().unwrap();
        (
            rendered.frame.color.unwrap().into_data(),
            rendered.warnings,
            rendered.stats.picture.lost_layers,
        )
    };
    let (whole, warnings, lost) = run(panes.clone(), 1 << 30);
    assert!(warnings.is_empty() && lost == 0, "{warnings:?}");
    let (cut, warnings, lost) = run(panes.clone(), 1 << 20);
    assert!(warnings.len() == 1 && warnings[0].contains("dropped") && lost > 0, "{warnings:?}");
    assert_ne!(cut, whole, "what is lost shows");
    let reversed: Vec<_> = panes.into_iter().rev().collect();
    assert!(run(reversed, 1 << 20).0 == cut, "the nearest layers stay in every order");
}

#[test]
fn the_inner_sides_of_bodies_are_lit_as_both_sides_of_sheets_are() {
    // Through the front of a closed body its back is seen from within, through holes as through
    // glass.
    let hole = Mesh { uvs: Vec::new(), ..solids::sphere(0.8, 24, 12) };
    let leaves = Material { alpha_mode: AlphaMode::Mask { cutoff: 0.5 }, ..Material::default() };
    let mut holed = hole.clone();
    holed.colors = Some(Attribute::per_vertex(
        hole.positions.iter().map(|p| [0.8, 0.7, 0.3, f32::from(p[2] < 0.3)]).collect(),
    ));
    let lit = Material { unlit: false, ..glass([0.8, 0.3, 0.2], 0.6) };
    for (mesh, material) in
        [(solids::cuboid(DVec3::ONE), lit.clone()), (hole, lit), (holed, leaves)]
    {
        for (shading, shadows, global) in [
            (Shading::Phong, "none", Global::None),
            (Shading::Flat, "none", Global::None),
            (Shading::Gouraud, "ray", Global::None),
            (Shading::Phong, "ray", Global::None),
            (Shading::Phong, "volume", Global::None),
            (Shading::Phong, "ray", Global::RayTrace),
        ] {
            let picture = |double_sided| {
                let material = Material { double_sided, ..material.clone() };
                let mut r = exact(scene_of([(mesh.clone(), material)]), 80, 60);
                let position = DVec3::new(1.1, 0.9, 2.3);
                r.camera = Some(Camera { position, ..on_z(2.5, 0.7) });
                r.lights = Some(vec![sun(DVec3::new(0.4, 0.6, -0.7), 1.0)]);
                (r.settings.shading.model, r.settings.global.model) = (shading, global);
                r.settings.shadows.algorithm = shadows.parse().unwrap();
                colors(&mut r)
            };
            assert!(
                picture(false) == picture(true),
                "{:?}, {shading:?}, {shadows}, {global:?}",
                material.alpha_mode
            );
        }
    }
}

#[test]
fn opacities_outside_their_range_and_coincident_panes_are_harmless() {
    for opacity in [-3.0, 7.0, f32::NAN, f32::INFINITY] {
        for model in [Transparency::Linear, Transparency::Kay, Transparency::Filtered] {
            let odd = Material { opacity, filter: [f32::NAN, -1.0, 9.0], ..glass([0.5; 3], 0.5) };
            let mut r =
                exact(scene_of([(square(0.0, 0.0), odd.clone()), (square(0.0, 0.0), odd)]), 16, 16);
            (r.camera, r.settings.transparency.model) = (Some(on_z(1.0, 0.9)), model);
            assert!(colors(&mut r).iter().all(|c| c[3] == 255), "{model:?} with {opacity}");
        }
    }
}

#[test]
fn coincident_panes_are_two_layers_and_the_first_of_the_scene_is_in_front() {
    let panes = || {
        vec![(square(0.0, 0.2), glass([0.8; 3], 0.5)), (square(0.0, 0.2), glass([0.2; 3], 0.25))]
    };
    // 0.5 * 0.8 + 0.5 * (0.75 * 0.2 + 0.25 * 0), and the other way round.
    for (parts, expected) in [(panes(), 121u8), (panes().into_iter().rev().collect(), 64)] {
        for order in ORDERS.iter().filter(|o| o.exact) {
            let listing = VISIBILITY.iter().filter(|a| a.makes_list());
            for algorithm in VISIBILITY
                .iter()
                .filter(|_| !order.needs_list)
                .chain(listing.filter(|_| order.needs_list))
            {
                let mut r = renderer(Vec::clone(&parts), order.choice(), 4);
                r.settings.visibility = algorithm.choice();
                let middle = colors(&mut r)[35 * 90 + 45][0];
                assert!(
                    middle.abs_diff(expected) <= 1,
                    "{}, {}: {middle}, not {expected}",
                    algorithm.name,
                    order.name
                );
            }
        }
    }
}

/// A pane with a highlight that moves over the pixel, and a checked texture's worth of facets.
fn lit_glasses() -> Vec<(Mesh, Material)> {
    let shiny = |color: [f32; 3], kt| {
        let reflectance =
            Reflectance::Phong { ka: color, kd: color, ks: [0.9; 3], shininess: 60.0 };
        Material { reflectance, unlit: false, ..glass(color, kt) }
    };
    vec![
        (solids::sphere(0.7, 40, 20), shiny([0.7, 0.3, 0.2], 0.5)),
        (square(0.1, 0.9), shiny([0.1, 0.8, 0.2], 0.6)),
        (solids::torus(0.6, 0.2, 24, 12), shiny([0.2, 0.3, 0.9], 0.4)),
    ]
}

#[test]
fn t12_passes_over_the_triangles_give_the_picture_of_all_layers_at_once() {
    for samples in [1, 3, 4] {
        for algorithm in VISIBILITY {
            let picture = |order| {
                let mut r = renderer(lit_glasses(), order, samples);
                r.lights = Some(vec![sun(DVec3::new(0.3, 0.4, 0.8), 1.0)]);
                (r.settings.picture.lines, r.settings.visibility) =
                    (Lines::Edges, algorithm.name.parse().unwrap());
                colors(&mut r)
            };
            let same =
                picture(TransparencyOrder::MULTI_PASS) == picture(TransparencyOrder::A_BUFFER);
            assert!(same, "{}, {samples} samples", algorithm.name);
        }
    }
}

#[test]
fn t12_the_picture_after_each_pass_can_be_had() {
    let panes = |n: usize| {
        (0..n).map(|i| (square(0.1 * i as f32, 0.0), glass([0.1 * (i + 1) as f32; 3], 0.5)))
    };
    let mut r = renderer(panes(5).collect(), TransparencyOrder::MULTI_PASS, 4);
    r.settings.picture.channels.passes = true;
    let frame = r.render().unwrap().frame;
    assert_eq!(frame.passes.len(), 6, "what is opaque, and five panes");
    assert_eq!(frame.passes.last(), frame.color.as_ref());
    for (n, pass) in frame.passes.iter().enumerate() {
        // The farthest n panes alone.
        let expected = colors(&mut renderer(panes(n).collect(), TransparencyOrder::SORTED, 4));
        let middle = |picture: &[[u8; 4]]| picture[35 * 90 + 45];
        assert_eq!(middle(pass.data()), middle(&expected), "after pass {n}");
    }
    // Without passes it is an error to ask for them.
    for (order, visibility) in
        [("sorted", "z-buffer"), ("multi-pass", "ray-cast"), ("multi-pass", "brute-force")]
    {
        let order = ORDERS.iter().find(|o| o.name == order).unwrap();
        (r.settings.transparency.order, r.settings.visibility) =
            (order.choice(), visibility.parse().unwrap());
        assert!(r.render().unwrap_err().to_string().contains("multi-pass"), "{visibility}");
    }
}

#[test]
fn passes_lose_no_layer_and_lists_keep_the_nearest() {
    let panes: Vec<_> =
        (0..400).map(|i| (square(-0.5 + 0.001 * i as f32, 0.0), glass([0.5; 3], 0.98))).collect();
    let run = |order, visibility: &str, memory: u64| {
        let mut r = exact(scene_of(panes.clone()), 24, 24);
        (r.camera, r.settings.transparency.order) = (Some(on_z(3.0, 0.9)), order);
        (r.settings.transparency.layer_memory, r.settings.visibility) =
            (memory, visibility.parse().unwrap());
        let rendered = r.render().unwrap();
        (rendered.frame.color.unwrap().into_data(), rendered.warnings.len())
    };
    let (small, large) = (1 << 20, 1 << 30);
    let whole = run(TransparencyOrder::A_BUFFER, "z-buffer", large);
    assert_eq!(
        run(TransparencyOrder::MULTI_PASS, "z-buffer", small),
        whole,
        "passes need no memory for layers"
    );
    let cut = run(TransparencyOrder::A_BUFFER, "z-buffer", small);
    assert!(cut.1 == 1 && cut.0 != whole.0);
    for visibility in ["painter", "bsp"] {
        let listed = run(TransparencyOrder::BACK_TO_FRONT, visibility, small);
        assert!(
            listed.1 == 1 && largest_difference(&listed.0, &cut.0) <= 1,
            "{visibility}: the nearest stay"
        );
    }
}
