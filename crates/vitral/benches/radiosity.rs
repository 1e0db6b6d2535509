//! How the time of radiosity grows with the patches: the Cornell box, until 1 % of the light is
//! left. Each size has about twice the patches of the one before; linear growth shows as a
//! throughput that stays.
#![allow(missing_docs)]

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use vitral::internals::scene::builtin;
use vitral::{Global, Renderer, Scene};

/// Longest edges of patches.
const PATCH_SIZES: [f64; 7] = [0.15, 0.1, 0.09, 0.055, 0.045, 0.025, 0.0225];

/// A renderer that knows no solution yet. Its picture is as good as nothing: looking up light is
/// not what is measured.
fn renderer(scene: &Scene, patch_size: f64) -> Renderer {
    let mut renderer = Renderer::new(scene.clone()).expect("the box is a scene");
    renderer.camera = renderer.world().cameras.first().copied();
    let settings = &mut renderer.settings;
    (settings.picture.width, settings.picture.height, settings.picture.samples) = (8, 8, 1);
    (settings.global.model, settings.global.patch_size) = (Global::Radiosity, Some(patch_size));
    renderer
}

fn bench(criterion: &mut Criterion) {
    let scene = builtin::scene("cornell").expect("it is built in");
    let mut group = criterion.benchmark_group("radiosity");
    group.sample_size(10);
    for patch_size in PATCH_SIZES {
        // One shot, to know how many patches there are.
        let mut one = renderer(&scene, patch_size);
        one.settings.global.iterations = Some(1);
        let patches = one.render().expect("nothing limits it").stats.radiosity.patches;
        group.throughput(Throughput::Elements(patches));
        group.bench_function(BenchmarkId::from_parameter(patches), |b| {
            let fresh = || renderer(&scene, patch_size);
            b.iter_batched_ref(
                fresh,
                |r| black_box(r.render().expect("nothing limits it")),
                BatchSize::PerIteration,
            );
        });
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
