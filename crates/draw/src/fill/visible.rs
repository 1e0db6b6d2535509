//! The visible part of each triangle.
//!
//! From each triangle that faces the viewer, the triangles in front of it are subtracted; the rest
//! is visible. Whether another triangle lies in front is decided by exact heights of corners over
//! planes, once for each pair in the order of their numbers, so that both agree: where two
//! triangles cross, each loses the part beyond the line in which their planes meet; coplanar ones
//! give way to the lower rank, or else the lower number.
//!
//! Clear triangles are not subtracted: they lie in layers over each other. A place of a clear
//! triangle is in layer `k` if `k` other clear triangles lie in front of it, as depth peeling finds
//! it for pixels ([Everitt 2001]).
//!
//! In:   the page's mesh, grids of the triangles that hide and of the clear ones. Out: shapes of
//!       the finer grid.
//! Cost: for each triangle `k log k` with `k` triangles in front of it.
//! Source: the overlay of polygons is the crate `i_overlay`'s; what lies in front, see above.

use crate::grid::Grid;
use crate::page_mesh::{NONE, PageMesh, Triangle};
use crate::run::Run;
use crate::shapes::{Corner, Shapes, corner_between, covered, within, without};
use std::cmp::Ordering;
use std::ops::ControlFlow;
use vitral_exec::Limit;
use vitral_math::exact::{GridPlane, GridPoint, orient2d};

/// Triangles in lists between two looks at the clock.
const TESTS_A_CHECK: u32 = 1 << 14;
/// Polygons that are taken away together.
const AT_ONCE: usize = 16;
/// How far a corner lies from the outline that made it, in steps of the finer grid.
const BESIDE: f64 = 2.0;

/// The triangles of a drawing that are filled.
#[derive(Clone, Copy)]
pub(super) struct Stage<'s> {
    pub(super) mesh: &'s PageMesh,
    /// Those that hide.
    pub(super) opaque: &'s Grid,
    /// Those that let light through, if there are any.
    pub(super) clear: Option<&'s Grid>,
    /// Whether contacts are collected: the triangles whose outlines cut others.
    pub(super) with_contacts: bool,
}

/// What a thread needs to clip triangles.
#[derive(Default)]
pub(super) struct Clipping {
    /// For each triangle the one that asked it last.
    asked: Vec<u32>,
    tests: u32,
    in_front: Vec<InFront>,
}

/// A polygon in front of a triangle.
struct InFront {
    triangle: u32,
    polygon: Vec<Corner>,
}

/// The visible shapes of a triangle.
#[derive(Default)]
pub(super) struct VisibleShapes {
    /// Its visible shapes: of an opaque triangle at most one entry, of a clear one the shapes of
    /// each layer.
    pub(super) layers: Vec<Shapes>,
    /// The triangles whose outlines cut it.
    pub(super) contacts: Vec<u32>,
}

/// What of one triangle lies in front of another.
enum Front {
    Nothing,
    All,
    /// Where it is above the other's plane.
    Above,
}

impl Clipping {
    /// Finds the visible shapes of the triangle with this number.
    pub(super) fn visible_shapes(
        &mut self,
        stage: &Stage<'_>,
        number: u32,
        run: &Run<'_>,
    ) -> Result<VisibleShapes, Limit> {
        // Take away what hides it.
        let triangle = &stage.mesh.triangles[number as usize];
        let whole = triangle.corners.map(|p| corner_between(p, 1.0, p)).to_vec();
        if !self.collect_in_front(stage.mesh, stage.opaque, number, true, run)? {
            return Ok(VisibleShapes::default());
        }
        let (mut visible, mut contacts) = (vec![vec![whole]], Vec::new());
        if !self.in_front.is_empty() {
            // Large and near ones come first: often little is left for the others.
            for some in self.in_front.chunks(AT_ONCE) {
                visible = without(&visible, some.iter().map(|front| &front.polygon));
                if visible.is_empty() {
                    break;
                }
                run.budget.check("visible surfaces")?;
            }
            if stage.with_contacts {
                contacts = self.contacts(triangle, &visible);
            }
        }
        let Some(clear) = stage.clear.filter(|_| triangle.clear && !visible.is_empty()) else {
            return Ok(VisibleShapes { layers: vec![visible], contacts });
        };

        // Take it apart by the number of clear triangles in front.
        self.collect_in_front(stage.mesh, clear, number, false, run)?;
        let over: Vec<Vec<Corner>> = self.in_front.drain(..).map(|front| front.polygon).collect();
        let mut layers = Vec::new();
        for count in 1.. {
            run.budget.check("visible surfaces")?;
            let deeper = covered(&over, count);
            if deeper.is_empty() {
                break;
            }
            layers.push(without(&visible, &deeper));
            visible = within(&visible, &deeper);
            if visible.is_empty() {
                break;
            }
        }
        layers.push(visible);
        Ok(VisibleShapes { layers, contacts })
    }

    /// Collects the polygons of a grid's triangles that lie in front of one triangle. With `hides`,
    /// stops and gives `false` at a polygon that covers all of it.
    fn collect_in_front(
        &mut self,
        mesh: &PageMesh,
        grid: &Grid,
        number: u32,
        hides: bool,
        run: &Run<'_>,
    ) -> Result<bool, Limit> {
        self.in_front.clear();
        self.asked.resize(mesh.triangles.len(), NONE);
        let triangle = &mesh.triangles[number as usize];
        let farthest = triangle.farthest();

        // Walk the lists, the nearest triangles first, until they begin behind this one.
        let flow = grid.over(triangle.low, triangle.high, |list| {
            for &other in list {
                let front = &mesh.triangles[other as usize];
                if front.nearest < farthest {
                    break;
                }
                self.tests += 1;
                if self.tests.is_multiple_of(TESTS_A_CHECK)
                    && let Err(limit) = run.budget.check("visible surfaces")
                {
                    return ControlFlow::Break(Some(limit));
                }

                // Pass over triangles that do not overlap this one, or were met in another cell.
                let apart =
                    |k: usize| front.low[k] >= triangle.high[k] || front.high[k] <= triangle.low[k];
                if other == number || apart(0) || apart(1) {
                    continue;
                }
                if std::mem::replace(&mut self.asked[other as usize], number) == number
                    || are_beside(triangle, front)
                    || are_beside(front, triangle)
                {
                    continue;
                }

                // Keep the part that lies in front.
                let polygon = match front_part(
                    (mesh.order_of(number), triangle),
                    (mesh.order_of(other), front),
                ) {
                    Front::Nothing => continue,
                    Front::All
                        if hides && triangle.corners.iter().all(|&p| is_inside(front, p)) =>
                    {
                        return ControlFlow::Break(None);
                    }
                    Front::All => front.corners.map(|p| corner_between(p, 1.0, p)).to_vec(),
                    Front::Above => above(front, &triangle.plane()),
                };
                self.in_front.push(InFront { triangle: other, polygon });
            }
            ControlFlow::Continue(())
        });
        match flow {
            ControlFlow::Break(Some(limit)) => Err(limit),
            ControlFlow::Break(None) => Ok(false),
            ControlFlow::Continue(()) => Ok(true),
        }
    }

    /// The triangles in front whose outlines made corners of the visible shapes.
    fn contacts(&self, triangle: &Triangle, visible: &Shapes) -> Vec<u32> {
        let own = triangle.corners.map(|p| corner_between(p, 1.0, p));
        let new: Vec<Corner> =
            visible.iter().flatten().flatten().filter(|p| !own.contains(p)).copied().collect();
        let touches = |front: &&InFront| new.iter().any(|p| is_on_outline(&front.polygon, p));
        self.in_front.iter().filter(touches).map(|front| front.triangle).collect()
    }
}

/// Whether a corner lies on the outline of a polygon, but for rounding.
fn is_on_outline(polygon: &[Corner], p: &Corner) -> bool {
    let step =
        |a: &Corner, b: &Corner| [f64::from(b.x) - f64::from(a.x), f64::from(b.y) - f64::from(a.y)];
    polygon.iter().zip(polygon.iter().cycle().skip(1)).any(|(a, b)| {
        let (side, way) = (step(a, b), step(a, p));
        let square = side[0] * side[0] + side[1] * side[1];
        let (along, beside) =
            (side[0] * way[0] + side[1] * way[1], side[0] * way[1] - side[1] * way[0]);
        beside * beside <= BESIDE * BESIDE * square && along >= 0.0 && along <= square
    })
}

/// Whether a side of `a` has all of `b` on its outside: they overlap in no area.
fn are_beside(a: &Triangle, b: &Triangle) -> bool {
    (0..3)
        .any(|k| b.corners.iter().all(|&p| orient2d(a.corners[k], a.corners[(k + 1) % 3], p) <= 0))
}

/// Whether a point of the page lies in a triangle, its outline included.
fn is_inside(triangle: &Triangle, p: GridPoint) -> bool {
    (0..3).all(|k| orient2d(triangle.corners[k], triangle.corners[(k + 1) % 3], p) >= 0)
}

/// What of `other` lies in front of `own`, each with its place in the order of coplanar ones. The
/// answer for the two the other way round is the opposite.
fn front_part(own: ((u32, u32), &Triangle), other: ((u32, u32), &Triangle)) -> Front {
    let ((_, first), (_, second)) = if own.0 < other.0 { (own, other) } else { (other, own) };
    // Whether the second is in front of the first.
    let (above, below) = (over(&first.plane(), second), over(&second.plane(), first));
    let order = match (above, below) {
        (Some(order), _) if order.is_ne() => order,
        (_, Some(order)) if order.is_ne() => order.reverse(),
        (None, None) => return Front::Above,
        // Coplanar: the first in the order is in front.
        _ => Ordering::Less,
    };
    let other_is_second = other.0 > own.0;
    if (order == Ordering::Greater) == other_is_second { Front::All } else { Front::Nothing }
}

/// On which side of a plane a triangle lies: in front (`Greater`), behind, in it but for snapping;
/// `None` on both.
fn over(plane: &GridPlane, triangle: &Triangle) -> Option<Ordering> {
    let snapping = plane.snapping();
    let heights = triangle.corners.map(|p| plane.rounded_height(p).0);
    let (up, down) =
        (heights.iter().any(|&h| h > snapping), heights.iter().any(|&h| h < -snapping));
    match (up, down) {
        (true, true) => None,
        (true, false) => Some(Ordering::Greater),
        (false, true) => Some(Ordering::Less),
        (false, false) => Some(Ordering::Equal),
    }
}

/// The part of a triangle above a plane.
fn above(triangle: &Triangle, plane: &GridPlane) -> Vec<Corner> {
    // Clip the outline at the plane.
    let heights = triangle.corners.map(|p| plane.height(p));
    let mut polygon = Vec::with_capacity(4);
    for k in 0..3 {
        let next = (k + 1) % 3;
        let [p, q] = [triangle.corners[k], triangle.corners[next]];
        if heights[k] >= 0 {
            polygon.push(corner_between(p, 1.0, p));
        }
        if (heights[k] > 0 && heights[next] < 0) || (heights[k] < 0 && heights[next] > 0) {
            // In the order of the vertices, so that neighbours get the same corner.
            let (a, b, from, to) = if triangle.vertices[k] < triangle.vertices[next] {
                (p, q, heights[k], heights[next])
            } else {
                (q, p, heights[next], heights[k])
            };
            polygon.push(corner_between(a, from as f64 / (from - to) as f64, b));
        }
    }
    polygon
}
