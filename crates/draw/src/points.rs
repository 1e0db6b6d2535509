//! Which free points are visible.
//!
//! A point is hidden by a triangle if it lies inside its outline on the page, the outline included,
//! and behind it by more than snapping can make of a contact, as for lines in `hiding.rs`.
//!
//! In:   the page's mesh and a grid of the triangles that hide. Out: the visible points, in units
//!       of the page.
//! Cost: one test for each triangle in the cells of the point, the nearest first.

use crate::page_mesh::{PageMesh, Triangle};
use crate::run::Run;
use crate::visibility::Search;
use std::ops::ControlFlow;
use vitral_exec::Limit;
use vitral_math::exact::{GridPoint, orient2d};

/// Points in one piece of work.
const BATCH: usize = 1024;
/// Bytes of a point until it is on the sheet.
const BYTES_A_POINT: u64 = 32;

/// The free points that no triangle hides.
pub(crate) fn visible_points(
    mesh: &PageMesh,
    search: Search<'_>,
    run: &Run<'_>,
) -> Result<Vec<[f64; 2]>, Limit> {
    run.memory.add(mesh.points.len() as u64 * BYTES_A_POINT)?;
    let pieces = run.workers.map(mesh.points.len().div_ceil(BATCH), |batch| {
        run.budget.check("free points")?;
        let points = &mesh.points[batch * BATCH..mesh.points.len().min((batch + 1) * BATCH)];
        let visible = points
            .iter()
            .map(|&v| mesh.vertices[v as usize])
            .filter(|&point| !is_hidden(mesh, search, point));
        Ok(visible.map(|[x, y, _]| [x, y].map(f64::from)).collect::<Vec<_>>())
    });
    let mut all = Vec::with_capacity(mesh.points.len());
    for piece in pieces {
        all.extend(piece?);
    }
    Ok(all)
}

/// Whether a triangle lies in front of a point.
fn is_hidden(mesh: &PageMesh, search: Search<'_>, point: GridPoint) -> bool {
    let grid = match search {
        Search::Grid(grid) => grid,
        Search::All => {
            return mesh
                .triangles
                .iter()
                .any(|triangle| triangle.hides && triangle.hides_point(point));
        }
    };
    let across = [point[0], point[1]];
    let flow = grid.over(across, across, |list| {
        let in_front =
            list.iter().map(|&t| &mesh.triangles[t as usize]).take_while(|t| t.nearest > point[2]);
        match in_front.into_iter().any(|triangle| triangle.hides_point(point)) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    });
    flow.is_break()
}

impl Triangle {
    /// Whether a point lies within the outline and behind the plane.
    fn hides_point(&self, point: GridPoint) -> bool {
        let [a, b, c] = self.corners;
        if orient2d(a, b, point) < 0 || orient2d(b, c, point) < 0 || orient2d(c, a, point) < 0 {
            return false;
        }
        let plane = self.plane();
        plane.side(point) < 0 && plane.rounded_height(point).0 < -plane.snapping()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Grid;
    use crate::testing::{mesh_of, with_run};
    use proptest::prelude::*;

    const BIG: [GridPoint; 3] = [[0, 0, 1000], [4000, 0, 1000], [0, 4000, 1000]];

    fn visible(triangles: &[[GridPoint; 3]], points: &[GridPoint]) -> Vec<[f64; 2]> {
        let mut mesh = mesh_of([1 << 14; 2], triangles);
        mesh.points = (mesh.vertices.len() as u32..).take(points.len()).collect();
        mesh.vertices.extend(points);
        with_run(2, |run| {
            let grid = Grid::new(&mesh, |triangle| triangle.hides, run).unwrap();
            let found = visible_points(&mesh, Search::Grid(&grid), run).unwrap();
            assert_eq!(
                found,
                visible_points(&mesh, Search::All, run).unwrap(),
                "as by brute force"
            );
            found
        })
    }

    #[test]
    fn points_are_hidden_inside_and_behind() {
        assert!(
            visible(&[BIG], &[[500, 500, 0], [2000, 2000, 0], [0, 0, 0]]).is_empty(),
            "inside, on a side, at a corner"
        );
        assert_eq!(
            visible(&[BIG], &[[500, 500, 1001], [3000, 3000, 0]]).len(),
            2,
            "in front, beside"
        );
        assert_eq!(visible(&[BIG], &[[500, 500, 999], [0, 0, 1000]]).len(), 2, "contacts");
        assert_eq!(visible(&[BIG], &[[500, 500, 998], [600, 600, 1000]]), [[600.0, 600.0]]);
        assert_eq!(visible(&[], &[[7, 8, 9]]), [[7.0, 8.0]]);
    }

    proptest! {
        #[test]
        fn the_grid_hides_what_brute_force_hides(
            corners in prop::collection::vec(prop::array::uniform3(prop::array::uniform3(0i32..9)), 1..30),
            points in prop::collection::vec(prop::array::uniform3(0i32..9), 1..30),
        ) {
            let large = |p: GridPoint| p.map(|c| c * 1000);
            let triangles: Vec<_> = corners.into_iter().map(|t| t.map(large)).collect();
            let points: Vec<_> = points.into_iter().map(large).collect();
            visible(&triangles, &points);
        }
    }
}
