//! Loading speed: a torus of a million triangles in each format, on one thread and on two.
//!
//! Targets on two cores: OBJ 200 MB/s, binary PLY 1 GB/s, binary STL 400 MB/s with its vertices
//! welded.
#![allow(missing_docs)]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use std::io::Write as _;
use vitral_exec::Workers;
use vitral_io::{NoFiles, load};
use vitral_math::func::sin_cos;

/// A closed torus of about `triangles` triangles: positions and faces.
fn torus(triangles: usize) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let side = ((triangles / 2) as f64).sqrt() as u32;
    let angle = |i: u32| f64::from(i) / f64::from(side) * std::f64::consts::TAU;
    let grid = || (0..side).flat_map(move |i| (0..side).map(move |j| (i, j)));
    let positions = grid().map(|(i, j)| {
        let ((su, cu), (sv, cv)) = (sin_cos(angle(i)), sin_cos(angle(j)));
        [(2.0 + cv) * cu, (2.0 + cv) * su, sv].map(|c| c as f32)
    });
    let faces = grid().flat_map(|(i, j)| {
        let at = |i: u32, j: u32| (i % side) * side + j % side;
        [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
    });
    (positions.collect(), faces.collect())
}

fn obj(positions: &[[f32; 3]], faces: &[[u32; 3]], full: bool) -> Vec<u8> {
    let mut out = Vec::new();
    for p in positions {
        writeln!(out, "v {:.6} {:.6} {:.6}", p[0], p[1], p[2]).unwrap();
        if full {
            writeln!(out, "vt {:.6} {:.6}", p[0], p[1]).unwrap();
            writeln!(out, "vn {:.4} {:.4} {:.4}", p[0], p[1], p[2]).unwrap();
        }
    }
    for f in faces {
        let [a, b, c] = f.map(|i| i + 1);
        if full {
            writeln!(out, "f {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}").unwrap();
        } else {
            writeln!(out, "f {a} {b} {c}").unwrap();
        }
    }
    out
}

fn ply(positions: &[[f32; 3]], faces: &[[u32; 3]]) -> Vec<u8> {
    let mut out = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
        positions.len(),
        faces.len()
    )
    .into_bytes();
    out.extend(positions.as_flattened().iter().flat_map(|c| c.to_le_bytes()));
    for f in faces {
        out.push(3);
        out.extend(f.iter().flat_map(|i| i.to_le_bytes()));
    }
    out
}

fn stl(positions: &[[f32; 3]], faces: &[[u32; 3]]) -> Vec<u8> {
    let mut out = vec![b' '; 80];
    out.extend((faces.len() as u32).to_le_bytes());
    for f in faces {
        out.extend([0; 12]);
        out.extend(f.iter().flat_map(|&i| positions[i as usize]).flat_map(f32::to_le_bytes));
        out.extend([0; 2]);
    }
    out
}

fn bench(criterion: &mut Criterion) {
    let (positions, faces) = torus(1_000_000);
    let files = [
        ("torus.obj", obj(&positions, &faces, false)),
        ("torus_full.obj", obj(&positions, &faces, true)),
        ("torus.ply", ply(&positions, &faces)),
        ("torus.stl", stl(&positions, &faces)),
    ];
    let mut group = criterion.benchmark_group("load");
    group.sample_size(10);
    for (name, bytes) in &files {
        group.throughput(Throughput::Bytes(bytes.len() as u64));
        for threads in [1, 2] {
            let workers = Workers::new(threads);
            group.bench_with_input(BenchmarkId::new(*name, threads), bytes, |b, bytes| {
                b.iter(|| load(bytes, name, &NoFiles, &workers).unwrap());
            });
        }
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
