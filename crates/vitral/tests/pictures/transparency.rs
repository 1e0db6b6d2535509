//! Transparent surfaces in whole pictures: models, orders, and what they do to each other.

use crate::common::{colors, exact, largest_difference, on_z, one, sun};
use vitral::light::{AlphaMode, Reflectance};
use vitral::math::{DMat4, DVec3};
use vitral::render::registry::VISIBILITY;
use vitral::render::transparency::registry::ORDERS;
use vitral::render::{Background, Transparency, TransparencyOrder};
use vitral::scene::Part;
use vitral::scene::builtin::solids;
use vitral::{Camera, Material, Mesh, Projection, Renderer, Scene};

/// A square from -1 to 1 at height `z`, which rises by `slope` along x.
fn square(z: f32, slope: f32) -> Mesh {
    let corner = |x: f32, y: f32| [x, y, z + slope * x];
    Mesh {
        positions: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        parts: vec![Part { name: String::new(), triangles: 0..2, material: None }],
        ..Mesh::default()
    }
}

/// Glass without light of its own but its colour.
fn glass(color: [f32; 3], kt: f32) -> Material {
    let reflectance = Reflectance::Phong { ka: color, kd: color, ks: [0.0; 3], shininess: 1.0 };
    let mut material = Material { reflectance, unlit: true, alpha_mode: AlphaMode::Blend, ..Material::default() };
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
    (renderer.settings.transparency_order, renderer.settings.samples) = (order, samples);
    renderer
}

#[test]
fn t10_t11_t12_f6_exact_orders_agree_in_every_algorithm_and_permutation() {
    for samples in [1, 4] {
        let reference = colors(&mut renderer(glasses(), TransparencyOrder::Sorted, samples));
        for order in ORDERS.iter().filter(|o| o.exact) {
            let own = colors(&mut renderer(glasses(), order.value, samples));
            assert!(largest_difference(&own, &reference) <= 1, "{}, {samples}", order.name);
            for turn in 0..5 {
                let mut parts = glasses();
                parts.rotate_left(turn);
                parts.swap(0, 3);
                let mut permuted = renderer(parts, order.value, samples);
                assert!(colors(&mut permuted) == own, "{}, {samples} samples, permutation {turn}", order.name);
            }
        }
        for algorithm in VISIBILITY {
            for order in ORDERS {
                let mut r = renderer(glasses(), order.value, samples);
                let expected = colors(&mut r);
                algorithm.name.clone_into(&mut r.settings.visibility);
                assert!(colors(&mut r) == expected, "{} with {}, {samples}", algorithm.name, order.name);
            }
        }
    }
}

#[test]
fn t11_f8_e3_inexact_orders_show_their_error_and_are_exact_for_one_layer() {
    let mut turned = glasses();
    turned.reverse();
    let exact = colors(&mut renderer(glasses(), TransparencyOrder::ABuffer, 1));
    for order in ORDERS.iter().filter(|o| !o.exact) {
        let first = colors(&mut renderer(glasses(), order.value, 1));
        let other = colors(&mut renderer(turned.clone(), order.value, 1));
        assert!(largest_difference(&first, &other) > 20, "{}: the order of the scene shows", order.name);
        assert!(largest_difference(&first, &exact) > 20, "{}", order.name);
        let panes = || vec![glasses().remove(4), glasses().remove(2)];
        let single = |value| colors(&mut renderer(panes(), value, 4));
        let difference = largest_difference(&single(order.value), &single(TransparencyOrder::Sorted));
        assert!(difference <= 1, "{}: one layer is exact", order.name);
    }
}

#[test]
fn t7_f4_stacks_of_one_to_eight_panes_in_a_picture() {
    for n in 1..=8 {
        let panes = (0..n).map(|i| (square(0.1 * i as f32, 0.0), glass([0.1 * (i + 1) as f32; 3], 0.5)));
        let mut r = renderer(panes.collect(), TransparencyOrder::ABuffer, 4);
        r.settings.background = Background::Color { color: [0.6; 3] };
        let expected = (0..n).fold(0.6f32, |behind, i| 0.5 * 0.1 * (i + 1) as f32 + 0.5 * behind);
        let middle = colors(&mut r)[35 * 90 + 45];
        assert!((f32::from(middle[0]) - 255.0 * expected).abs() <= 1.0, "{n}: {middle:?}");
    }
}

/// A white glass ball of radius 1 in front of black, the row through its middle: place from -1 to 1 and intensity.
fn profile(model: Transparency) -> Vec<(f64, f64)> {
    let mut renderer = exact(one(solids::sphere(1.0, 256, 128), glass([1.0; 3], 0.8)), 201, 201);
    let projection = Projection::Parallel { height: 2.01 };
    renderer.camera = Some(Camera { projection, ..on_z(5.0, 1.0) });
    renderer.settings.transparency = model;
    let row = colors(&mut renderer)[100 * 201..101 * 201].to_vec();
    let place = |i: usize| (i as f64 - 100.0) * 0.01;
    row.iter().enumerate().map(|(i, c)| (place(i), f64::from(c[0]) / 255.0)).filter(|p| p.0.abs() < 0.97).collect()
}

#[test]
fn t8_t9_f5_the_profile_of_a_glass_ball_tells_kays_model_from_the_linear_one() {
    // Two layers of white glass before black: 1 - kt².
    for (x, seen) in profile(Transparency::Linear) {
        assert!((seen - (1.0 - 0.8 * 0.8)).abs() < 0.01, "linear: flat, {seen} at {x}");
    }
    for (x, seen) in profile(Transparency::Kay) {
        let nz = (1.0 - x * x).sqrt();
        let kt = 0.8 * (1.0 - (1.0 - nz) * (1.0 - nz) * (1.0 - nz));
        assert!((seen - (1.0 - kt * kt)).abs() < 0.012, "Kay: {seen} at {x}, not {}", 1.0 - kt * kt);
    }
}

#[test]
fn filtered_glass_tints_what_is_behind() {
    let green = Material { filter: [0.0, 1.0, 0.5], ..glass([0.0; 3], 0.8) };
    let mut r = exact(one(square(0.0, 0.0), green), 20, 20);
    r.camera = Some(on_z(1.0, 0.9));
    r.settings.background = Background::Color { color: [1.0; 3] };
    assert_eq!(colors(&mut r)[210], [204, 204, 204, 255], "the linear model knows no filter");
    r.settings.transparency = Transparency::Filtered;
    assert_eq!(colors(&mut r)[210], [0, 204, 102, 255]);
}

#[test]
fn f2_highlights_stay_on_clear_filtered_glass() {
    let mirror = Reflectance::Phong { ka: [0.0; 3], kd: [0.9; 3], ks: [0.5; 3], shininess: 4.0 };
    let clear = Material { reflectance: mirror, unlit: false, ..glass([0.0; 3], 1.0) };
    let mut r = exact(one(square(0.0, 0.0), clear), 20, 20);
    (r.camera, r.lights) = (Some(on_z(1.0, 0.1)), Some(vec![sun(DVec3::Z, 1.0)]));
    r.settings.background = Background::Color { color: [0.2; 3] };
    assert_eq!(colors(&mut r)[210][0], 51, "linear: 1 - kt = 0 leaves nothing of the surface");
    r.settings.transparency = Transparency::Filtered;
    let seen = i32::from(colors(&mut r)[210][0]);
    assert!((seen - 179).abs() <= 2, "0.2 behind and the highlight of 0.5: {seen}");
}

#[test]
fn thousands_of_layers_stay_within_their_memory_with_a_warning() {
    let panes: Vec<_> = (0..1200).map(|i| (square(-0.5 + 0.0005 * i as f32, 0.0), glass([0.5; 3], 0.98))).collect();
    let run = |parts: Vec<(Mesh, Material)>, memory: u64| {
        let mut r = exact(scene_of(parts), 24, 24);
        r.camera = Some(on_z(3.0, 0.9));
        r.settings.layer_memory = memory;
        let rendered = r.render().unwrap();
        (rendered.frame.color.unwrap().into_data(), rendered.warnings, rendered.stats.picture.lost_layers)
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
fn opacities_outside_their_range_and_coincident_panes_are_harmless() {
    for opacity in [-3.0, 7.0, f32::NAN, f32::INFINITY] {
        for model in [Transparency::Linear, Transparency::Kay, Transparency::Filtered] {
            let odd = Material { opacity, filter: [f32::NAN, -1.0, 9.0], ..glass([0.5; 3], 0.5) };
            let mut r = exact(scene_of([(square(0.0, 0.0), odd.clone()), (square(0.0, 0.0), odd)]), 16, 16);
            (r.camera, r.settings.transparency) = (Some(on_z(1.0, 0.9)), model);
            assert!(colors(&mut r).iter().all(|c| c[3] == 255), "{model:?} with {opacity}");
        }
    }
}
