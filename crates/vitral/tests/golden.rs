//! Golden pictures: small references in `tests/golden`, byte for byte, at every instruction set and
//! thread count.

use vitral::{
    Background, DMat4, DVec3, DepthCue, Execution, Global, GroundShadow, Illumination, Light,
    Lines, Material, Renderer, Scene, Shading, Shadows, Transparency, panels, solids,
};
use vitral_testkit::fixture::repository;
use vitral_testkit::golden::{Tolerance, check_everywhere};
use vitral_testkit::matrix::Setting;

/// Renders `scene` as `change` wants it and compares.
fn golden(name: &str, scene: Scene, change: impl Fn(&mut Renderer)) {
    check_everywhere(name, Tolerance::EXACT, |setting| {
        let mut renderer = renderer(&scene, setting, [200, 150]);
        change(&mut renderer);
        renderer.render().unwrap().frame.color.unwrap()
    });
}

fn renderer(scene: &Scene, setting: &Setting, [width, height]: [u32; 2]) -> Renderer {
    let execution = Execution {
        workers: setting.workers.clone(),
        level: setting.level,
        ..Execution::default()
    };
    let mut renderer = Renderer::with_execution(scene.clone(), execution).unwrap();
    (renderer.settings.picture.width, renderer.settings.picture.height) = (width, height);
    renderer
}

/// A built-in figure, small, seen by its own camera.
fn figure(file: &str, name: &str, change: impl Fn(&mut Renderer)) {
    golden(file, builtin(name), |r| {
        (r.settings.picture.width, r.settings.picture.height) = (160, 120);
        r.camera = r.world().cameras.first().copied();
        change(r);
    });
}

fn traced(renderer: &mut Renderer) {
    renderer.settings.global.model = Global::RayTrace;
    renderer.settings.shadows.algorithm = Shadows::RAY;
}

fn builtin(name: &str) -> Scene {
    vitral::load_builtin(name).unwrap()
}

fn example(path: &str) -> Scene {
    let file = repository().join("examples/models").join(path);
    vitral::load(file).unwrap()
}

#[test]
fn teapot() {
    golden("teapot", builtin("teapot"), |_| {});
}

#[test]
fn teapot_without_anti_aliasing_on_nothing() {
    golden("teapot-plain", builtin("teapot"), |r| {
        r.settings.picture.samples = 1;
        r.settings.picture.background = Background::Transparent;
        r.settings.shading.illumination = Illumination::BlinnPhong;
    });
}

#[test]
fn lab_scenes() {
    for name in ["cubs", "sphere", "scene0", "scene1"] {
        golden(name, builtin(name), |_| {});
    }
}

#[test]
fn shading_models() {
    golden("sphere-flat", builtin("sphere"), |r| r.settings.shading.model = Shading::Flat);
    golden("sphere-gouraud", builtin("sphere"), |r| r.settings.shading.model = Shading::Gouraud);
}

#[test]
fn cook_torrance() {
    golden("scene0-cook-torrance", builtin("scene0"), |r| {
        r.settings.shading.illumination = Illumination::CookTorrance
    });
}

#[test]
fn edges() {
    golden("scene1-edges", builtin("scene1"), |r| r.settings.picture.lines = Lines::Edges);
    golden("cubs-hidden-line", builtin("cubs"), |r| {
        r.settings.picture.lines = Lines::WireframeHiddenLine
    });
}

#[test]
fn textures_and_glass() {
    golden("stone-lantern", example("stoneLantern/stoneLantern.obj"), |_| {});
    golden("glass-door-cabinet", example("glassDoorCabinet/glassDoorCabinet.obj"), |_| {});
}

/// The notes' figure: straight on, P shows 3 and Q shows 4; bent, the other way round.
#[test]
fn t4_refraction_off_and_on() {
    figure("refraction-off", "refraction", |_| {});
    figure("refraction-on", "refraction", traced);
}

#[test]
fn ray_traced_figures() {
    for name in ["rod", "lens", "mirrors"] {
        figure(name, name, traced);
    }
}

#[test]
fn p42_everything_at_once() {
    figure("realism", "realism", |r| {
        traced(r);
        r.settings.transparency.model = Transparency::Filtered;
        (
            r.settings.picture.samples,
            r.settings.shadows.light_samples,
            r.settings.transparency.scatter_samples,
        ) = (2, 4, 8);
    });
}

#[test]
fn shadows() {
    for (shadows, scene) in [("map", "scene1"), ("volume", "scene0")] {
        golden(&format!("{scene}-shadows-{shadows}"), builtin(scene), |r| {
            (r.settings.picture.width, r.settings.picture.height) = (160, 120);
            r.settings.shadows.algorithm = shadows.parse().unwrap();
            r.settings.shadows.map_size = 512;
        });
    }
}

#[test]
fn f25_panels_of_shadow_maps() {
    let scene = builtin("scene0");
    check_everywhere("scene0-panels-map", Tolerance::EXACT, |setting| {
        let mut renderer = renderer(&scene, setting, [88, 66]);
        renderer.settings.shadows.algorithm = Shadows::MAP;
        renderer.settings.shadows.map_size = 256;
        let camera = renderer.frame_camera();
        panels(&mut renderer, &camera).unwrap().frame.color.unwrap()
    });
}

#[test]
fn radiosity() {
    figure("cornell", "cornell", |r| {
        r.settings.global.model = Global::Radiosity;
        (r.settings.global.patch_size, r.settings.global.iterations) = (Some(0.3), Some(16));
    });
}

/// The scene of glass and lights, small.
fn room(file: &str, change: impl Fn(&mut Renderer)) {
    golden(file, builtin("scene0"), |r| {
        (r.settings.picture.width, r.settings.picture.height) = (120, 90);
        change(r);
    });
}

#[test]
fn models_and_orders_of_transparency() {
    let glass = |file: &str, change: fn(&mut Renderer)| {
        golden(file, example("glassDoorCabinet/glassDoorCabinet.obj"), |r| {
            (r.settings.picture.width, r.settings.picture.height) = (120, 90);
            change(r);
        });
    };
    glass("glass-kay", |r| r.settings.transparency.model = Transparency::Kay);
    glass("glass-filtered", |r| r.settings.transparency.model = Transparency::Filtered);
    glass("glass-two-buffer", |r| r.settings.transparency.order = "two-buffer".parse().unwrap());
}

#[test]
fn depth_cueing() {
    room("scene0-depth-cue", |r| r.settings.picture.depth_cue = Some(DepthCue::default()));
}

#[test]
fn other_shadows() {
    for shadows in ["ray", "scan-line", "object-precision"] {
        room(&format!("scene0-shadows-{shadows}"), |r| {
            r.settings.shadows.algorithm = shadows.parse().unwrap()
        });
    }
    room("scene0-shadows-cascades", |r| {
        r.settings.shadows.algorithm = Shadows::MAP;
        (r.settings.shadows.map_size, r.settings.shadows.cascades) = (256, 3);
    });
    let lamp = Light::disc([3.0, 7.0, 2.0], [-3.0, -7.0, -2.0], 1.0);
    room("scene0-shadows-area", |r| {
        r.settings.shadows.algorithm = Shadows::RAY;
        r.settings.shadows.light_samples = 4;
        r.lights = Some(vec![lamp.clone()]);
    });
}

/// Polished, brushed and rough metal.
fn metal_balls() -> Scene {
    let mut scene = Scene::default();
    for (k, roughness) in [0.05, 0.3, 0.7].into_iter().enumerate() {
        let base_color = [[0.9, 0.9, 0.9], [1.0, 0.77, 0.34], [0.95, 0.64, 0.54]][k];
        let material = Some(scene.add_material(Material::metal(base_color, roughness)));
        let mut ball = solids::sphere(1.0, 32, 16);
        ball.parts.iter_mut().for_each(|part| part.material = material);
        scene.add_mesh(ball, DMat4::from_translation(DVec3::X * 2.2 * k as f64));
    }
    scene
}

fn wide(renderer: &mut Renderer) {
    (renderer.settings.picture.width, renderer.settings.picture.height) = (180, 80);
}

/// Metal under the sky that it mirrors.
#[test]
fn metals() {
    golden("metals", metal_balls(), wide);
}

/// Metal in an image of a studio, on a ground that shows its shadow.
#[test]
fn surroundings() {
    let file = repository().join("examples/environments/studio.png");
    let image = vitral::load_environment(file, 1 << 20).unwrap();
    golden("metals-studio", metal_balls(), |r| {
        wide(r);
        r.environment_image = Some(image.clone());
        r.settings.shadows.ground = GroundShadow::Auto;
    });
    golden("scene1-ambient-occlusion", builtin("scene1"), |r| {
        r.settings.shading.ambient_occlusion = Some(16);
        r.settings.picture.background = Background::Color { color: [1.0; 3] };
        r.settings.shadows.ground = GroundShadow::Lights;
    });
}

/// A metal that is not quite smooth blurs what it mirrors.
#[test]
fn blurred_mirrors() {
    let mut scene = builtin("scene0");
    let metal = Some(scene.add_material(Material::metal([0.9; 3], 0.15)));
    let mut floor = solids::cuboid(DVec3::new(6.0, 0.1, 6.0));
    floor.parts.iter_mut().for_each(|part| part.material = metal);
    scene.add_mesh(floor, DMat4::from_translation(DVec3::Y * 0.03));
    golden("scene0-blurred-mirror", scene, traced);
}
