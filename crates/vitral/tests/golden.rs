//! Golden pictures: small references in `tests/golden`, byte for byte, at every instruction set and thread count.

use vitral::render::{Background, Lines};
use vitral::{Execution, Illumination, LoadOptions, Renderer, Scene, Shading, Workers};
use vitral_testkit::fixture::repository;
use vitral_testkit::golden::{Tolerance, check_everywhere};

/// Renders `scene` as `change` wants it and compares.
fn golden(name: &str, scene: Scene, change: impl Fn(&mut Renderer)) {
    check_everywhere(name, Tolerance::EXACT, |setting| {
        let execution = Execution { workers: setting.workers.clone(), level: setting.level, ..Execution::default() };
        let mut renderer = Renderer::with_execution(scene.clone(), execution).unwrap();
        (renderer.settings.width, renderer.settings.height) = (200, 150);
        change(&mut renderer);
        renderer.render().unwrap().frame.color.unwrap()
    });
}

fn builtin(name: &str) -> Scene {
    vitral::load_builtin(name).unwrap()
}

fn example(path: &str) -> Scene {
    let file = repository().join("examples/models").join(path);
    vitral::load(file, &LoadOptions::default(), &Workers::single()).unwrap()
}

#[test]
fn teapot() {
    golden("teapot", builtin("teapot"), |_| {});
}

#[test]
fn teapot_without_anti_aliasing_on_nothing() {
    golden("teapot-plain", builtin("teapot"), |r| {
        r.settings.samples = 1;
        r.settings.background = Background::Transparent;
        r.settings.illumination = Illumination::BlinnPhong;
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
    golden("sphere-flat", builtin("sphere"), |r| r.settings.shading = Shading::Flat);
    golden("sphere-gouraud", builtin("sphere"), |r| r.settings.shading = Shading::Gouraud);
}

#[test]
fn cook_torrance() {
    golden("scene0-cook-torrance", builtin("scene0"), |r| r.settings.illumination = Illumination::CookTorrance);
}

#[test]
fn edges() {
    golden("scene1-edges", builtin("scene1"), |r| r.settings.lines = Lines::Edges);
    golden("cubs-hidden-line", builtin("cubs"), |r| r.settings.lines = Lines::WireframeHiddenLine);
}

#[test]
fn textures_and_glass() {
    golden("stone-lantern", example("stoneLantern/stoneLantern.obj"), |_| {});
    golden("glass-door-cabinet", example("glassDoorCabinet/glassDoorCabinet.obj"), |_| {});
}
