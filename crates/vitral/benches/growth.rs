//! How the time of a frame grows: with the triangles (a torus, 1024x768), and with the pixels (the
//! same torus). Four sizes each, each four times the one before; linear growth shows as a
//! throughput that stays.
#![allow(missing_docs)]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use vitral::{DMat4, Material, Renderer, Scene, solids};

/// A torus of about `triangles` triangles that fills much of the picture.
fn renderer(triangles: u32, size: (u32, u32)) -> Renderer {
    let side = ((f64::from(triangles) / 2.0).sqrt()) as u32;
    let mut scene = Scene::default();
    scene.add_material(Material::default());
    scene.add_mesh(solids::torus(2.0, 1.0, side, side), DMat4::IDENTITY);
    let mut renderer = Renderer::new(scene).expect("a torus is a scene");
    (renderer.settings.picture.width, renderer.settings.picture.height) = size;
    renderer.settings.picture.samples = 1;
    renderer
}

fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("triangles");
    group.sample_size(20);
    for triangles in [62_500, 250_000, 1_000_000, 4_000_000] {
        let mut renderer = renderer(triangles, (1024, 768));
        group.throughput(Throughput::Elements(u64::from(triangles)));
        group.bench_function(BenchmarkId::from_parameter(triangles), |b| {
            b.iter(|| black_box(renderer.render().expect("nothing limits it")));
        });
    }
    group.finish();

    let mut group = criterion.benchmark_group("pixels");
    group.sample_size(20);
    for scale in [1, 2, 4, 8] {
        let (width, height) = (512 * scale, 384 * scale);
        let mut renderer = renderer(20_000, (width, height));
        group.throughput(Throughput::Elements(u64::from(width * height)));
        group.bench_function(BenchmarkId::from_parameter(format!("{width}x{height}")), |b| {
            b.iter(|| black_box(renderer.render().expect("nothing limits it")));
        });
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
