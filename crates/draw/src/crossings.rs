//! The lines in which triangles penetrate each other, as edges of the page's mesh.
//!
//! Two triangles cross if each has corners on both sides of the other's plane. Then two sides of
//! each pierce the other's plane, and all four points lie on the line in which the planes meet: the
//! common part of the two intervals is the line of intersection. A corner within the reach of
//! snapping counts as in front of the plane, so that a body that stands on a floor does not cross
//! it, and one whose edge lies in a face is cut once.
//!
//! The point where a side pierces a plane is computed from the ends of the side in the order of
//! their numbers and snapped: triangles that share the side get the same point, and the lines of
//! neighbours join.
//!
//! In:   the page's mesh and a grid of the triangles to ask. Out: more vertices and edges of class
//!       intersection, with both triangles.
//! Cost: one test for each pair of triangles whose boxes meet.
//! Source: \[Möller 1997\] for the test of a pair; the decisions are exact
//!         ([`vitral_math::exact`]).

use crate::classes::Classes;
use crate::grid::Grid;
use crate::page_mesh::{Edge, NONE, PageMesh, Triangle};
use crate::run::Run;
use std::ops::ControlFlow;
use vitral_exec::{Limit, Spare};
use vitral_frame::drawing::LineClass;
use vitral_math::DVec3;
use vitral_math::exact::{GridPlane, GridPoint};

/// Triangles in one piece of work.
const BATCH: usize = 512;
/// Pairs between two looks at the clock.
const PAIRS_A_CHECK: u32 = 1 << 14;
/// Sine of the angle between faces below which their intersection is not drawn: a line between
/// faces that are almost the same.
const LEAST_SINE: f32 = 1e-4;

/// A line in which two triangles cross.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Crossing {
    /// The two triangles.
    triangles: [u32; 2],
    /// The ends of the common line, on the grid.
    ends: [GridPoint; 2],
}

/// Adds the lines of intersection among the triangles in a grid, which `asks` accepts; gives their
/// number.
pub(crate) fn add_crossings(
    mesh: &mut PageMesh,
    grid: &Grid,
    asks: impl Fn(&Triangle) -> bool + Sync,
    run: &Run<'_>,
) -> Result<u64, Limit> {
    let spare = Spare::<Pairs>::default();
    let count = mesh.triangles.len();
    run.budget.begin("triangles", count as u64);

    // Search each batch of triangles on a thread of its own.
    let found = run.workers.map(count.div_ceil(BATCH), |batch| {
        spare.lend(|pairs| {
            pairs.met.resize(count, NONE);
            let mut found = Vec::new();
            for t in batch * BATCH..count.min((batch + 1) * BATCH) {
                if asks(&mesh.triangles[t]) {
                    pairs.of_triangle(mesh, grid, t as u32, run, &mut found)?;
                }
                run.budget.advance();
            }
            run.budget.check("intersections")?;
            Ok(found)
        })
    });

    // Add an edge for each line of intersection.
    let before = mesh.edges.len();
    for piece in found {
        for crossing in piece? {
            let vertex = mesh.vertices.len() as u32;
            mesh.vertices.extend(crossing.ends);
            let (first, classes) =
                (mesh.edge_triangles.len() as u32, Classes::one(LineClass::Intersection));
            mesh.edge_triangles.extend(crossing.triangles);
            mesh.edges.push(Edge { ends: [vertex, vertex + 1], first, count: 2, classes });
        }
    }
    Ok((mesh.edges.len() - before) as u64)
}

/// What a thread needs to meet pairs.
#[derive(Default)]
struct Pairs {
    /// For each triangle the one that it met last.
    met: Vec<u32>,
    tests: u32,
}

impl Pairs {
    /// Finds the lines in which one triangle crosses others of its size or larger ones.
    fn of_triangle(
        &mut self,
        mesh: &PageMesh,
        grid: &Grid,
        number: u32,
        run: &Run<'_>,
        found: &mut Vec<Crossing>,
    ) -> Result<(), Limit> {
        // Visit the cells around the triangle, the nearest triangles first.
        let triangle = &mesh.triangles[number as usize];
        let farthest = triangle.farthest();
        let start = found.len();
        let flow = grid.around(triangle, |list, own_level| {
            for &other_number in list {
                let other = &mesh.triangles[other_number as usize];
                if other.nearest < farthest {
                    break;
                }

                // Check the budget from time to time.
                self.tests += 1;
                if self.tests.is_multiple_of(PAIRS_A_CHECK)
                    && let Err(limit) = run.budget.check("intersections")
                {
                    return ControlFlow::Break(limit);
                }

                // Reject pairs whose boxes are disjoint, seen pairs and nearly parallel ones.
                let apart =
                    |k: usize| other.low[k] > triangle.high[k] || other.high[k] < triangle.low[k];
                let twice = own_level && other_number <= number;
                if twice || apart(0) || apart(1) || other.farthest() > triangle.nearest {
                    continue;
                }
                if std::mem::replace(&mut self.met[other_number as usize], number) == number {
                    continue;
                }
                let angle = sine(
                    &mesh.sources[number as usize].normal,
                    &mesh.sources[other_number as usize].normal,
                );
                if angle < LEAST_SINE {
                    continue;
                }

                // Intersect the two triangles exactly.
                if let Some(ends) = crossing(triangle, other) {
                    found.push(Crossing { triangles: [number, other_number], ends });
                }
            }
            ControlFlow::Continue(())
        });
        // Two vertices, an edge and two entries in its list, here and in the mesh.
        run.memory.add(
            (found.len() - start) as u64 * (2 * size_of::<Crossing>() + size_of::<Edge>()) as u64,
        )?;
        if let ControlFlow::Break(limit) = flow { Err(limit) } else { Ok(()) }
    }
}

/// The sine of the angle between two directions.
fn sine(a: &[f32; 3], b: &[f32; 3]) -> f32 {
    let [x, y, z] = [[1, 2], [2, 0], [0, 1]].map(|[i, k]| a[i] * b[k] - a[k] * b[i]);
    (x * x + y * y + z * z).sqrt()
}

/// Where two triangles cross, if they do and the line has a length on the grid.
fn crossing(a: &Triangle, b: &Triangle) -> Option<[GridPoint; 2]> {
    // Neighbours along a side meet there and nowhere else.
    if a.vertices.iter().filter(|&&v| b.has(v)).count() > 1 {
        return None;
    }
    let planes = [a.plane(), b.plane()];
    let own = piercings(a, &planes[1])?;
    let others = piercings(b, &planes[0])?;

    // Along the common line of the planes, take the later start and the earlier end.
    let [n, m] = planes.map(|p| DVec3::from_array(p.normal.map(|c| c as f64)).normalize_or_zero());
    let along = n.cross(m);
    let parameter = |p: &GridPoint| along.dot(DVec3::from_array(p.map(f64::from)));
    let ordered =
        |[p, q]: [GridPoint; 2]| if parameter(&p) <= parameter(&q) { [p, q] } else { [q, p] };
    let ([a, b], [c, d]) = (ordered(own), ordered(others));
    let start = if parameter(&a) >= parameter(&c) { a } else { c };
    let end = if parameter(&b) <= parameter(&d) { b } else { d };
    (parameter(&start) < parameter(&end)).then_some([start, end])
}

/// The two points in which a triangle's sides pierce a plane.
fn piercings(triangle: &Triangle, plane: &GridPlane) -> Option<[GridPoint; 2]> {
    let snapping = plane.snapping();
    let in_front = triangle.corners.map(|p| plane.rounded_height(p).0 >= -snapping);
    let lone = (0..3)
        .find(|&k| in_front[k] != in_front[(k + 1) % 3] && in_front[k] != in_front[(k + 2) % 3])?;
    Some([(lone + 1) % 3, (lone + 2) % 3].map(|k| piercing(triangle, [lone, k], plane, snapping)))
}

/// The point in which the side between two corners pierces a plane, snapped.
fn piercing(
    triangle: &Triangle,
    mut corners: [usize; 2],
    plane: &GridPlane,
    snapping: f64,
) -> GridPoint {
    if triangle.vertices[corners[0]] > triangle.vertices[corners[1]] {
        corners.reverse();
    }
    let [p, q] = corners.map(|k| triangle.corners[k]);
    let heights = [p, q].map(|p| plane.height(p) as f64);
    if let Some(touching) = (0..2).find(|&k| heights[k].abs() <= snapping) {
        return [p, q][touching];
    }
    let way = heights[0] / (heights[0] - heights[1]);
    [0, 1, 2].map(|k| (f64::from(p[k]) + way * (f64::from(q[k]) - f64::from(p[k]))).round() as i32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{mesh_of, with_run};

    fn crossings(corners: &[[GridPoint; 3]]) -> Vec<[GridPoint; 2]> {
        let all = [1, 3].map(|threads| {
            let mut mesh = mesh_of([4096; 2], corners);
            let before = mesh.edges.len();
            with_run(threads, |run| {
                let grid = Grid::new(&mesh, |t| t.hides, run).unwrap();
                let count = add_crossings(&mut mesh, &grid, |t| t.hides, run).unwrap();
                assert_eq!(count as usize, mesh.edges.len() - before);
            });
            let mut ends: Vec<_> =
                mesh.edges[before..].iter().map(|edge| mesh.ends(edge)).collect();
            ends.iter_mut().for_each(|ends| ends.sort_unstable());
            ends
        });
        assert_eq!(all[0], all[1]);
        all[0].clone()
    }

    const FLOOR: [GridPoint; 3] = [[0, 0, 500], [4000, 0, 500], [0, 4000, 500]];

    #[test]
    fn triangles_cross_in_the_common_part_of_two_intervals() {
        let sail = [[500, 500, 0], [1500, 500, 0], [1000, 900, 1000]];
        assert_eq!(crossings(&[FLOOR, sail]), [[[750, 700, 500], [1250, 700, 500]]]);
        assert_eq!(crossings(&[sail, FLOOR]), [[[750, 700, 500], [1250, 700, 500]]]);
        // One that reaches beyond the floor ends at its border.
        let wide = [[1000, 500, 0], [4000, 500, 0], [4000, 1500, 1000]];
        assert_eq!(crossings(&[FLOOR, wide]), [[[2500, 1000, 500], [3000, 1000, 500]]]);
    }

    #[test]
    fn what_touches_does_not_cross_and_an_edge_in_a_face_is_cut_once() {
        let above = [[500, 500, 500], [1500, 500, 500], [1000, 900, 1000]];
        let below = [[1500, 500, 500], [500, 500, 500], [1000, 100, 0]];
        assert!(crossings(&[FLOOR, above]).is_empty());
        let sunk = above.map(|p| [p[0], p[1], p[2] - 1]);
        assert!(crossings(&[FLOOR, sunk]).is_empty(), "within the reach of snapping");
        assert_eq!(crossings(&[FLOOR, above, below]).len(), 1);
        let coplanar = [[100, 100, 500], [300, 100, 500], [100, 300, 500]];
        assert!(crossings(&[FLOOR, coplanar]).is_empty());
    }

    #[test]
    fn triangles_with_a_common_corner_may_cross() {
        let fan = [[0, 0, 500], [1000, 1500, 0], [1500, 1000, 1000]];
        assert_eq!(crossings(&[FLOOR, fan]), [[[0, 0, 500], [1250, 1250, 500]]]);
        let neighbour = [[0, 0, 500], [4000, 0, 500], [4000, 4000, 0]];
        assert!(crossings(&[FLOOR, neighbour]).is_empty());
    }

    #[test]
    fn neighbours_share_the_ends_of_their_lines() {
        // Two triangles of a folded sheet through the floor.
        let (a, b) = ([1000, 333, -1001], [1003, 777, 1999]);
        let lines = crossings(&[FLOOR, [a, b, [300, 800, 1500]], [b, a, [1700, 650, 1200]]]);
        assert_eq!(lines.len(), 2);
        assert!(lines[0].iter().any(|end| lines[1].contains(end)), "{lines:?}");
    }
}
