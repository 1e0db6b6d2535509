//! Translucent surfaces in whole pictures: they blur what is behind them, glow in the light behind
//! them, and are refused where they cannot be shown.

use super::common::{colors, exact, limit, on_z, settings_error, sun};
use vitral::internals::math::dvec3;
use vitral::internals::math::lanes::available_levels;
use vitral::internals::render::registry::{SHADOWS, VISIBILITY};
use vitral::internals::render::transparency::registry::ORDERS;
use vitral::{
    AlphaMode, Budget, Camera, DMat4, DVec3, Execution, Global, Limit, Material, Mesh, Part,
    Projection, Reflectance, Renderer, Scene, SettingsError, SystemClock, Transmission,
    Transparency, TransparencyOrder, Workers, solids,
};

/// A colour that no light changes.
fn plain(color: [f32; 3]) -> Material {
    let reflectance = Reflectance::Phong { ka: color, kd: color, ks: [0.0; 3], shininess: 1.0 };
    Material { reflectance, unlit: true, double_sided: true, ..Material::default() }
}

/// Black glass that lets `kt` pass, with the highlight's exponent of its roughness.
fn glass(kt: f32, transmission: Transmission, shininess: f32) -> Material {
    let reflectance = Reflectance::Phong { ka: [0.0; 3], kd: [0.0; 3], ks: [0.0; 3], shininess };
    let alpha_mode = AlphaMode::Blend;
    let mut material = Material {
        name: "pane".into(),
        reflectance,
        transmission,
        alpha_mode,
        ior: 1.0,
        ..plain([0.0; 3])
    };
    material.set_kt(kt);
    material
}

fn add(scene: &mut Scene, mut mesh: Mesh, material: Material) {
    let material = Some(scene.add_material(material));
    mesh.parts.iter_mut().for_each(|p| p.material = material);
    scene.add_mesh(mesh, DMat4::IDENTITY);
}

/// A rectangle across z.
fn rectangle(low: [f32; 2], high: [f32; 2], z: f32) -> Mesh {
    Mesh {
        positions: vec![
            [low[0], low[1], z],
            [high[0], low[1], z],
            [high[0], high[1], z],
            [low[0], high[1], z],
        ],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        parts: vec![Part { name: String::new(), triangles: 0..2, material: None }],
        ..Mesh::default()
    }
}

/// A checker of black and white squares of side 0.25 at `z`, from -3 to 3.
fn checker(scene: &mut Scene, z: f32) {
    for (parity, color) in [(0, [0.0; 3]), (1, [1.0; 3])] {
        let mut mesh = Mesh::default();
        for i in (0..24 * 24).filter(|i| (i / 24 + i % 24) % 2 == parity) {
            let low = [(i % 24) as f32 * 0.25 - 3.0, (i / 24) as f32 * 0.25 - 3.0];
            let square = rectangle(low, [low[0] + 0.25, low[1] + 0.25], z);
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(square.positions);
            mesh.triangles.extend(square.triangles.iter().map(|t| t.map(|i| i + first)));
        }
        let count = mesh.triangles.len() as u32;
        mesh.parts = vec![Part { name: String::new(), triangles: 0..count, material: None }];
        add(scene, mesh, plain(color));
    }
}

fn seen(scene: Scene, samples: u32) -> Renderer {
    let mut renderer = exact(scene, 96, 80);
    renderer.camera = Some(on_z(4.0, 0.5));
    renderer.settings.picture.samples = samples;
    renderer
}

/// A slab of glass from z = 0 to 0.1, a checker `behind` it.
fn slab(material: Material, behind: f32) -> Scene {
    let mut scene = Scene::default();
    checker(&mut scene, -behind);
    let mut body = solids::cuboid(dvec3(3.0, 3.0, 0.1));
    body.positions.iter_mut().for_each(|p| p[2] += 0.05);
    add(&mut scene, body, material);
    scene
}

/// Variance of red in the middle of the picture, in squares of 1.
fn variance(renderer: &mut Renderer) -> f64 {
    let picture = colors(renderer);
    let middle = (20..60).flat_map(|y| (24..72).map(move |x| y * 96 + x));
    let values: Vec<f64> = middle.map(|i| f64::from(picture[i][0]) / 255.0).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / values.len() as f64
}

fn traced(mut renderer: Renderer) -> Renderer {
    renderer.settings.global.model = Global::RayTrace;
    renderer
}

#[test]
fn t1_a_translucent_slab_blurs_a_checker_and_a_transparent_one_does_not() {
    let of = |transmission, behind: f32| seen(slab(glass(1.0, transmission, 30.0), behind), 4);
    let mut bare = Scene::default();
    checker(&mut bare, -1.0);
    let whole = variance(&mut seen(bare, 4));
    for (name, with) in [("layers", (|r| r) as fn(Renderer) -> Renderer), ("rays", traced)] {
        let clear = variance(&mut with(of(Transmission::Transparent, 1.0)));
        assert!(
            (clear / whole - 1.0).abs() < 0.02,
            "{name}: transparent leaves it, {clear} of {whole}"
        );
        let blurred = variance(&mut with(of(Transmission::Translucent, 1.0)));
        assert!(blurred < 0.1 * whole, "{name}: translucent blurs, {blurred} of {whole}");
        // What touches the slab stays nearly sharp.
        let touching = variance(&mut with(of(Transmission::Translucent, 0.001)));
        assert!(touching > 0.5 * whole, "{name}: {touching} of {whole}");
        let smooth = glass(1.0, Transmission::Translucent, 1000.0);
        let fine = variance(&mut with(seen(slab(smooth, 1.0), 4)));
        assert!(fine > 2.0 * blurred, "{name}: smooth glass blurs less, {fine}");
    }
}

#[test]
fn layers_and_rays_blur_alike() {
    for (exponent, behind) in [(30.0, 1.0), (100.0, 0.4), (300.0, 2.0)] {
        let mut pane = Scene::default();
        checker(&mut pane, -behind);
        add(
            &mut pane,
            rectangle([-3.0; 2], [3.0; 2], 0.0),
            glass(0.8, Transmission::Translucent, exponent),
        );
        let mut renderer = seen(pane, 4);
        renderer.settings.transparency.scatter_samples = 400;
        let [layers, rays] = [colors(&mut renderer), colors(&mut traced(renderer))];
        let apart: u64 =
            layers.iter().zip(&rays).map(|(a, b)| u64::from(a[0].abs_diff(b[0]))).sum();
        assert!(
            apart < 4 * layers.len() as u64,
            "{exponent}, {behind}: {} on the mean",
            apart / layers.len() as u64
        );
    }
}

#[test]
fn what_is_in_front_of_a_translucent_pane_is_not_blurred_into_it() {
    let mut scene = Scene::default();
    add(&mut scene, rectangle([-9.0; 2], [9.0; 2], -2.0), plain([0.2, 0.4, 0.6]));
    add(
        &mut scene,
        rectangle([-3.0; 2], [3.0; 2], 0.0),
        glass(1.0, Transmission::Translucent, 20.0),
    );
    add(&mut scene, rectangle([-0.2, -3.0], [0.2, 3.0], 0.5), plain([1.0, 0.0, 0.0]));
    for with in [(|r| r) as fn(Renderer) -> Renderer, traced] {
        let picture = colors(&mut with(seen(scene.clone(), 1)));
        let (mut bar, mut wall) = (0, 0);
        for color in &picture {
            match color {
                [255, 0, 0, 255] => bar += 1,
                [51, 102, 153, 255] => wall += 1,
                other => panic!("{other:?}"),
            }
        }
        assert!(bar > 500 && wall > 5000, "{bar}, {wall}");
    }
}

#[test]
fn tilted_and_curved_surfaces_do_not_see_themselves() {
    // Black glass that lets half pass: one pane halves the wall, a ball's two surfaces leave a
    // quarter.
    let mut tilted = rectangle([-0.9; 2], [0.9; 2], 0.0);
    tilted.positions.iter_mut().for_each(|p| p[2] = -1.5 * p[0] + p[1]);
    for (mesh, expected) in [(tilted, 127), (solids::sphere(0.8, 48, 24), 64)] {
        let mut scene = Scene::default();
        add(&mut scene, rectangle([-30.0; 2], [30.0; 2], -4.0), plain([1.0; 3]));
        add(&mut scene, mesh, glass(0.5, Transmission::Translucent, 40.0));
        let middle = colors(&mut seen(scene, 1))[40 * 96 + 48][0];
        assert!(middle.abs_diff(expected) <= 3, "{middle}, not {expected}");
    }
}

#[test]
fn two_panes_behind_each_other_blur_twice_and_let_the_product_pass() {
    let mut scene = Scene::default();
    add(&mut scene, rectangle([-30.0; 2], [30.0; 2], -2.0), plain([1.0; 3]));
    let mut both = rectangle([-3.0; 2], [3.0; 2], -0.5);
    let front = rectangle([-3.0; 2], [3.0; 2], 0.5);
    both.positions.extend(front.positions);
    both.triangles.extend([[4, 5, 6], [4, 6, 7]]);
    both.parts[0].triangles = 0..4;
    add(&mut scene, both, glass(0.6, Transmission::Translucent, 40.0));
    for with in [(|r| r) as fn(Renderer) -> Renderer, traced] {
        let picture = colors(&mut with(seen(scene.clone(), 4)));
        let middle = picture[40 * 96 + 48][0];
        assert!(middle.abs_diff(92) <= 2, "0.36 of white, {middle}");
    }
}

#[test]
fn every_algorithm_and_order_that_can_blurs_the_same_and_the_others_refuse() {
    let picture = |order: TransparencyOrder, visibility: &str| {
        let mut r = seen(slab(glass(0.7, Transmission::Translucent, 30.0), 1.0), 4);
        (r.settings.transparency.order, r.settings.visibility) =
            (order, visibility.parse().unwrap());
        r.render().map(|rendered| rendered.frame.color.unwrap().into_data())
    };
    let expected = picture(TransparencyOrder::A_BUFFER, "z-buffer").unwrap();
    for order in ORDERS {
        for algorithm in VISIBILITY.iter().filter(|a| a.makes_list() || !order.needs_list) {
            let own = picture(order.choice(), algorithm.name);
            if order.blurs {
                let same = own
                    .unwrap()
                    .iter()
                    .zip(&expected)
                    .all(|(a, b)| (0..4).all(|k| a[k].abs_diff(b[k]) <= 1));
                assert!(same, "{} with {}", algorithm.name, order.name);
            } else {
                let error = own.unwrap_err();
                assert!(error.to_string().contains("`pane` is translucent"), "{error}");
                assert!(matches!(settings_error(&error), SettingsError::Translucent { .. }));
            }
        }
    }
    let mut r = seen(slab(glass(0.7, Transmission::Translucent, 30.0), 1.0), 1);
    (r.settings.transparency.order, r.settings.transparency.model) =
        (TransparencyOrder::TWO_BUFFER, Transparency::None);
    assert!(r.render().is_ok(), "as opaque surfaces they need no order");
}

#[test]
fn blur_is_the_same_at_every_level_with_one_and_three_threads() {
    let mut reference = None;
    for (name, level) in available_levels() {
        for threads in [1, 3] {
            let execution = Execution {
                workers: Workers::new(threads),
                level,
                budget: Budget::default(),
                observer: None,
            };
            let scene = slab(glass(0.7, Transmission::Translucent, 30.0), 1.0);
            let mut r = Renderer::with_execution(scene, execution).unwrap();
            (r.settings.picture.width, r.settings.picture.height, r.camera) =
                (130, 70, Some(on_z(4.0, 0.5)));
            let layers = colors(&mut r);
            let pictures = [layers, colors(&mut traced(r))];
            let expected = reference.get_or_insert_with(|| pictures.clone());
            assert!(pictures == *expected, "{name} with {threads} threads");
        }
    }
}

#[test]
fn t1_light_behind_a_translucent_pane_makes_it_glow() {
    let picture = |transmission, from: DVec3, model: Transparency| {
        let mut scene = Scene::default();
        let pane =
            Material { unlit: false, filter: [1.0, 0.5, 0.0], ..glass(0.5, transmission, 40.0) };
        add(&mut scene, rectangle([-3.0; 2], [3.0; 2], 0.0), pane);
        let mut r = seen(scene, 1);
        r.lights = Some(vec![sun(from, 0.8)]);
        r.settings.transparency.model = model;
        colors(&mut r)[40 * 96 + 48]
    };
    let behind = dvec3(0.6, 0.0, -0.8);
    let linear = Transparency::Linear;
    // kt Ip cos = 0.5 * 0.8 * 0.8.
    assert_eq!(picture(Transmission::Translucent, behind, linear), [82, 82, 82, 255]);
    assert_eq!(
        picture(Transmission::Translucent, behind, Transparency::Filtered),
        [82, 41, 0, 255]
    );
    assert_eq!(picture(Transmission::Transparent, behind, linear), [0, 0, 0, 255]);
    assert_eq!(picture(Transmission::Translucent, -behind, linear), [0, 0, 0, 255]);
}

#[test]
fn the_shadow_of_what_is_behind_falls_on_the_glow() {
    for shadows in SHADOWS.iter().filter(|s| s.algorithm.is_some()) {
        let mut scene = Scene::default();
        let pane = Material { unlit: false, ..glass(0.5, Transmission::Translucent, 1000.0) };
        add(&mut scene, rectangle([-3.0; 2], [3.0; 2], 0.0), pane);
        // Hides the light from the left half.
        add(&mut scene, rectangle([-3.0, -3.0], [0.0, 3.0], -0.2), plain([0.0; 3]));
        let mut r = seen(scene, 1);
        r.lights = Some(vec![sun(dvec3(0.0, 0.0, -1.0), 0.8)]);
        r.settings.shadows.algorithm = shadows.choice();
        let picture = colors(&mut r);
        let [left, right] = [20, 76].map(|x| picture[40 * 96 + x][0]);
        assert!(left <= 2 && right.abs_diff(102) <= 2, "{}: {left}, {right}", shadows.name);
    }
}

#[test]
fn parallel_views_blur_too() {
    let camera = Camera { projection: Projection::Parallel { height: 2.0 }, ..on_z(4.0, 0.5) };
    let of = |transmission| {
        let mut r = seen(slab(glass(1.0, transmission, 30.0), 1.0), 1);
        r.camera = Some(camera);
        variance(&mut r)
    };
    let (clear, blurred) = (of(Transmission::Transparent), of(Transmission::Translucent));
    assert!(blurred < 0.15 * clear, "{blurred} of {clear}");
}

#[test]
fn blur_and_passes_stop_at_a_time_limit() {
    let with_limit = |scene: Scene, order| {
        let mut r = seen(scene, 4);
        r.settings.transparency.order = order;
        let budget =
            Budget::new(std::sync::Arc::new(SystemClock::default())).with_time_limit(Some(1e-9));
        r.execution_mut().budget = budget;
        limit(&mut r)
    };
    let clear = glass(0.7, Transmission::Transparent, 30.0);
    assert!(matches!(
        with_limit(slab(clear, 1.0), TransparencyOrder::MULTI_PASS),
        Limit::Time { .. }
    ));
    let translucent = glass(0.7, Transmission::Translucent, 30.0);
    assert!(matches!(
        with_limit(slab(translucent, 1.0), TransparencyOrder::A_BUFFER),
        Limit::Time { .. }
    ));
    // And at one of memory.
    let mut r = seen(slab(glass(0.7, Transmission::Translucent, 30.0), 1.0), 16);
    (r.settings.picture.width, r.settings.picture.height) = (800, 600);
    r.execution_mut().budget = Budget::default().with_memory_limit(Some(80 << 20));
    assert!(r.render().unwrap_err().to_string().contains("behind translucent"));
}
