//! Meshes on the grid for tests, without a world and a camera.

use crate::edges::with_edges;
use crate::page_mesh::{PageMesh, Source, Triangle};
use crate::projection::{Facet, Projected};
use crate::run::Run;
use std::collections::BTreeMap;
use vitral_exec::{Budget, Workers};
use vitral_math::DVec3;
use vitral_math::exact::GridPoint;

/// The mesh of these triangles, welded by position; each is a face.
pub(crate) fn mesh_of(size: [i32; 2], corners: &[[GridPoint; 3]]) -> PageMesh {
    let mut numbers: BTreeMap<GridPoint, u32> = BTreeMap::new();
    let mut projected = Projected { size, ..Projected::default() };
    for (t, triangle) in corners.iter().enumerate() {
        let vertices = triangle.map(|p| {
            *numbers.entry(p).or_insert_with(|| {
                projected.vertices.push(p);
                projected.vertices.len() as u32 - 1
            })
        });
        let [a, b, c] = triangle.map(|p| DVec3::from_array(p.map(f64::from)));
        let normal = (b - a).cross(c - a);
        if vertices[0] == vertices[1]
            || vertices[1] == vertices[2]
            || vertices[2] == vertices[0]
            || normal == DVec3::ZERO
        {
            continue;
        }
        let source = projected.sources.len() as u32;
        let normal = normal.normalize_or_zero().as_vec3().to_array();
        projected.sources.push(Source { facet: source, surface: t as u32, material: 0, normal });
        projected.facets.push(Facet { vertices, source, outline: 0b111 });
        projected.triangles.push(Triangle::new(*triangle, vertices));
    }
    with_run(1, |run| with_edges(projected, std::f64::consts::FRAC_PI_6, false, run)).unwrap()
}

/// Calls `f` with so many threads and without limits.
pub(crate) fn with_run<R>(threads: usize, f: impl FnOnce(&Run<'_>) -> R) -> R {
    let (workers, budget) =
        (if threads == 1 { Workers::single() } else { Workers::new(threads) }, Budget::default());
    f(&Run::new(&workers, &budget))
}
