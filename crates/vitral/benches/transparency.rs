//! What transparent layers cost: the teapot of glass, 1024x768, in each order and model, beside the opaque one.
#![allow(missing_docs)]

use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use vitral::render::Transparency;
use vitral::render::transparency::registry::{MODELS, ORDERS};
use vitral::{Renderer, load_builtin, override_material};

/// The glass teapot; with [`Transparency::None`] it is opaque.
fn renderer(translucent: bool) -> Renderer {
    let mut scene = load_builtin("teapot").expect("it is built in");
    override_material(&mut scene, "*", "kt", "0.6").expect("every material has it");
    if translucent {
        override_material(&mut scene, "*", "transmission", "translucent").expect("every material has it");
    }
    Renderer::new(scene).expect("a teapot is a scene")
}

fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("transparency");
    group.sample_size(10);
    for order in ORDERS {
        let mut renderer = renderer(false);
        renderer.settings.transparency_order = order.value;
        let visibility = if order.needs_list { "bsp" } else { "z-buffer" };
        visibility.clone_into(&mut renderer.settings.visibility);
        group.bench_function(order.name, |b| b.iter(|| black_box(renderer.render().expect("nothing limits it"))));
    }
    for model in MODELS.iter().filter(|m| m.value != Transparency::default()) {
        let mut renderer = renderer(false);
        renderer.settings.transparency = model.value;
        group.bench_function(model.name, |b| b.iter(|| black_box(renderer.render().expect("nothing limits it"))));
    }
    let mut renderer = renderer(true);
    group.bench_function("translucent", |b| b.iter(|| black_box(renderer.render().expect("nothing limits it"))));
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
