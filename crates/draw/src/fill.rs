//! The visible surface as regions that do not overlap.
//!
//! Of each triangle that faces the viewer, everything that lies in front of it is taken away; what is left is visible. Whether another
//! triangle lies in front is decided by exact heights of corners over planes, once for each pair in the order of their numbers, so that
//! both agree: where two triangles cross, each loses the part beyond the line in which their planes meet; coplanar ones give way to
//! the lower rank, or else the lower number. Regions of one colour that touch become one.
//!
//! Polygons are clipped and joined on a grid that is [`FINER`] times as fine as the page's, since the corners of what is left are
//! rounded to it.
//!
//! In:   the page's mesh, a grid of the triangles that hide, a colour for each face. Out: regions in units of the page.
//! Cost: for each triangle `k log k` with `k` triangles in front of it.
//! Source: the overlay of polygons is the crate `i_overlay`'s; what lies in front, see above.

use crate::grid::Grid;
use crate::page_mesh::{NONE, PageMesh, Source, Triangle};
use crate::run::Run;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::Overlay;
use i_overlay::core::overlay::{IntOverlayOptions, ShapeType};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::i_float::int::point::IntPoint;
use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use vitral_exec::{Limit, Spare};
use vitral_math::exact::{GridPlane, GridPoint, orient2d};

/// Steps of the finer grid in a unit of the page.
const FINER: i32 = 128;
/// Area in units of the page below which a region or a hole is a trace of rounding: a millionth of a square millimetre on a sheet.
const LEAST_AREA: u64 = 1024;
/// Triangles in one piece of work.
const BATCH: usize = 256;
/// Triangles in lists between two looks at the clock.
const TESTS_A_CHECK: u32 = 1 << 14;
/// Bytes of a corner of a region, with those of its lists.
const BYTES_A_CORNER: u64 = 24;

/// What a colour is chosen by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceLook {
    /// Surface id.
    pub surface: u32,
    /// Index into the scene's materials.
    pub material: Option<u32>,
    /// Unit normal on the side that is seen, world space.
    pub normal: [f32; 3],
}

/// Gives each face its colour, sRGB.
pub type Palette<'p> = dyn Fn(&FaceLook) -> [u8; 3] + Sync + 'p;

/// A visible region on the page.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PageRegion {
    /// The lowest surface id of its faces.
    pub(crate) surface: u32,
    pub(crate) material: u32,
    pub(crate) color: [u8; 3],
    /// Counter-clockwise round the region, clockwise round holes; in units.
    pub(crate) rings: Vec<Vec<[f64; 2]>>,
}

type Corner = IntPoint<i32>;
type Shapes = Vec<Vec<Vec<Corner>>>;

/// A visible part of a triangle.
struct Part {
    color: [u8; 3],
    source: Source,
    shapes: Shapes,
}

/// The visible regions.
pub(crate) fn regions(
    mesh: &PageMesh,
    grid: &Grid,
    palette: &Palette<'_>,
    run: &Run<'_>,
) -> Result<Vec<PageRegion>, Limit> {
    regions_of(mesh, grid, &|_| true, palette, run)
}

/// The visible regions of some surfaces.
pub(crate) fn regions_of(
    mesh: &PageMesh,
    grid: &Grid,
    is_wanted: &(dyn Fn(u32) -> bool + Sync),
    palette: &Palette<'_>,
    run: &Run<'_>,
) -> Result<Vec<PageRegion>, Limit> {
    // Find the visible part of each triangle.
    let (spare, count) = (Spare::<Clipping>::default(), mesh.triangles.len());
    run.budget.begin("triangles", count as u64);
    let pieces = run.workers.map(count.div_ceil(BATCH), |batch| {
        spare.lend(|clipping| {
            clipping.asked.resize(count, NONE);
            let mut parts = Vec::new();
            for t in batch * BATCH..count.min((batch + 1) * BATCH) {
                run.budget.advance();
                let triangle = &mesh.triangles[t];
                if !triangle.hides || !is_wanted(mesh.sources[t].surface) {
                    continue;
                }
                let shapes = clipping.visible(mesh, grid, t as u32, run)?;
                if shapes.is_empty() {
                    continue;
                }
                let corners: usize = shapes.iter().flatten().map(Vec::len).sum();
                run.memory.add(corners as u64 * BYTES_A_CORNER)?;
                let source = mesh.sources[t];
                parts.push(Part { color: palette(&look(triangle, &source)), source, shapes });
            }
            run.budget.check("visible surfaces")?;
            run.budget.progress("visible surfaces", run.budget.achieved().done, count as u64);
            Ok(parts)
        })
    });
    let mut parts = Vec::new();
    for piece in pieces {
        parts.extend(piece?);
    }
    join(parts, run)
}

/// What a face shows to its palette.
fn look(triangle: &Triangle, source: &Source) -> FaceLook {
    let normal = if triangle.facing < 0 { source.normal.map(|c| -c) } else { source.normal };
    FaceLook { surface: source.surface, material: Some(source.material).filter(|&m| m != NONE), normal }
}

/// Joins the parts of each colour and material.
fn join(parts: Vec<Part>, run: &Run<'_>) -> Result<Vec<PageRegion>, Limit> {
    // Gather the parts of each colour and material.
    let mut groups: BTreeMap<(u32, [u8; 3]), (u32, Vec<Shapes>)> = BTreeMap::new();
    for Part { color, source, shapes } in parts {
        let (surface, all) = groups.entry((source.material, color)).or_insert((source.surface, Vec::new()));
        *surface = source.surface.min(*surface);
        all.push(shapes);
    }
    let groups: Vec<_> = groups.into_iter().collect();

    // Join those that touch.
    let joined = run.workers.map(groups.len(), |i| {
        run.budget.check("regions")?;
        let ((material, color), (surface, all)) = &groups[i];
        let least = LEAST_AREA * u64::from(FINER.unsigned_abs()).pow(2);
        let options = IntOverlayOptions { min_output_area: least, ..IntOverlayOptions::default() };
        let mut overlay = Overlay::<i32>::new_custom(all.len() * 4, options, Default::default());
        for ring in all.iter().flatten().flatten() {
            overlay.add_contour(ring, ShapeType::Subject);
        }
        let shapes = overlay.overlay(OverlayRule::Subject, FillRule::NonZero);
        let point = |p: &Corner| [p.x, p.y].map(|c| f64::from(c) / f64::from(FINER));
        let region = |shape: Vec<Vec<Corner>>| {
            let rings = shape.iter().map(|ring| ring.iter().map(point).collect()).collect();
            PageRegion { surface: *surface, material: *material, color: *color, rings }
        };
        Ok(shapes.into_iter().map(region).collect::<Vec<_>>())
    });
    let mut regions = Vec::new();
    for group in joined {
        regions.extend(group?);
    }
    Ok(regions)
}

/// What a thread needs to clip triangles.
#[derive(Default)]
struct Clipping {
    /// For each triangle the one that asked it last.
    asked: Vec<u32>,
    tests: u32,
}

/// What of one triangle lies in front of another.
enum Front {
    Nothing,
    All,
    /// Where it is above the other's plane.
    Above,
}

impl Clipping {
    /// The visible part of a triangle.
    fn visible(&mut self, mesh: &PageMesh, grid: &Grid, number: u32, run: &Run<'_>) -> Result<Shapes, Limit> {
        let triangle = &mesh.triangles[number as usize];
        // Collect what lies in front, until something hides all of it.
        let (farthest, mut in_front) = (triangle.farthest(), Vec::new());
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
                let apart = |k: usize| front.low[k] >= triangle.high[k] || front.high[k] <= triangle.low[k];
                if other == number || apart(0) || apart(1) {
                    continue;
                }
                if std::mem::replace(&mut self.asked[other as usize], number) == number
                    || are_beside(triangle, front)
                    || are_beside(front, triangle)
                {
                    continue;
                }
                match front_part((mesh.order_of(number), triangle), (mesh.order_of(other), front)) {
                    Front::Nothing => {}
                    Front::All if triangle.corners.iter().all(|&p| is_inside(front, p)) => {
                        return ControlFlow::Break(None);
                    }
                    Front::All => in_front.push(front.corners.map(|p| corner(p, 1.0, p)).to_vec()),
                    Front::Above => in_front.push(above(front, &triangle.plane())),
                }
            }
            ControlFlow::Continue(())
        });
        match flow {
            ControlFlow::Break(Some(limit)) => return Err(limit),
            ControlFlow::Break(None) => return Ok(Vec::new()),
            ControlFlow::Continue(()) => {}
        }

        // Take it away.
        let whole = triangle.corners.map(|p| corner(p, 1.0, p)).to_vec();
        if in_front.is_empty() {
            return Ok(vec![vec![whole]]);
        }
        let mut overlay = Overlay::<i32>::new(3 + 4 * in_front.len());
        overlay.add_contour(&whole, ShapeType::Subject);
        in_front.iter().for_each(|polygon| overlay.add_contour(polygon, ShapeType::Clip));
        Ok(overlay.overlay(OverlayRule::Difference, FillRule::NonZero))
    }
}

/// Whether a side of `a` has all of `b` on its outside: they overlap in no area.
fn are_beside(a: &Triangle, b: &Triangle) -> bool {
    (0..3).any(|k| b.corners.iter().all(|&p| orient2d(a.corners[k], a.corners[(k + 1) % 3], p) <= 0))
}

/// Whether a point of the page lies in a triangle, its outline included.
fn is_inside(triangle: &Triangle, p: GridPoint) -> bool {
    (0..3).all(|k| orient2d(triangle.corners[k], triangle.corners[(k + 1) % 3], p) >= 0)
}

/// What of `other` lies in front of `own`, each with its place in the order of coplanar ones. The answer for the two the other way round
/// is the opposite.
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

/// On which side of a plane a triangle lies: in front (`Greater`), behind, in it but for snapping; `None` on both.
fn over(plane: &GridPlane, triangle: &Triangle) -> Option<Ordering> {
    let snapping = plane.snapping();
    let heights = triangle.corners.map(|p| plane.rounded_height(p).0);
    let (up, down) = (heights.iter().any(|&h| h > snapping), heights.iter().any(|&h| h < -snapping));
    match (up, down) {
        (true, true) => None,
        (true, false) => Some(Ordering::Greater),
        (false, true) => Some(Ordering::Less),
        (false, false) => Some(Ordering::Equal),
    }
}

/// The part of a triangle above a plane.
fn above(triangle: &Triangle, plane: &GridPlane) -> Vec<Corner> {
    let heights = triangle.corners.map(|p| plane.height(p));
    let mut polygon = Vec::with_capacity(4);
    for k in 0..3 {
        let next = (k + 1) % 3;
        let [p, q] = [triangle.corners[k], triangle.corners[next]];
        if heights[k] >= 0 {
            polygon.push(corner(p, 1.0, p));
        }
        if (heights[k] > 0 && heights[next] < 0) || (heights[k] < 0 && heights[next] > 0) {
            // In the order of the vertices, so that neighbours get the same corner.
            let (a, b, from, to) = if triangle.vertices[k] < triangle.vertices[next] {
                (p, q, heights[k], heights[next])
            } else {
                (q, p, heights[next], heights[k])
            };
            polygon.push(corner(a, from as f64 / (from - to) as f64, b));
        }
    }
    polygon
}

/// The corner of the finer grid at a fraction of the way from one point to another.
fn corner(from: GridPoint, way: f64, to: GridPoint) -> Corner {
    let at = |k: usize| {
        let (p, q) = (f64::from(from[k]), f64::from(to[k]));
        ((p + way * (q - p)) * f64::from(FINER)).round() as i32
    };
    IntPoint::new(at(0), at(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{mesh_of, with_run};
    use proptest::prelude::*;

    /// Area of each surface that is seen; each has a colour of its own.
    fn areas(corners: &[[GridPoint; 3]]) -> Vec<f64> {
        let mesh = mesh_of([4096; 2], corners);
        let all = [1, 3].map(|threads| {
            with_run(threads, |run| {
                let grid = Grid::new(&mesh, |t| t.hides, run).unwrap();
                let color = |look: &FaceLook| [look.surface as u8, 0, 0];
                regions(&mesh, &grid, &color, run).unwrap()
            })
        });
        assert_eq!(all[0], all[1]);
        let mut areas = vec![0.0; corners.len()];
        for region in &all[0] {
            let rings = region.rings.iter().map(|ring| vitral_frame::drawing::signed_area(ring));
            areas[usize::from(region.color[0])] += rings.sum::<f64>();
        }
        areas
    }

    const BIG: [GridPoint; 3] = [[0, 0, 0], [4000, 0, 0], [0, 4000, 0]];

    #[test]
    fn a_triangle_in_front_cuts_a_hole() {
        let small = [[500, 500, 9], [1500, 500, 9], [500, 1500, 9]];
        assert_eq!(areas(&[BIG, small]), [7_500_000.0, 500_000.0]);
        assert_eq!(areas(&[small, BIG]), [500_000.0, 7_500_000.0]);
        let behind = small.map(|p| [p[0], p[1], -9]);
        assert_eq!(areas(&[BIG, behind]), [8_000_000.0, 0.0]);
    }

    #[test]
    fn coplanar_triangles_give_way_to_the_first_and_crossing_ones_share() {
        assert_eq!(areas(&[BIG, [[0, 0, 0], [2000, 0, 0], [0, 2000, 0]]]), [8_000_000.0, 0.0]);
        // The second rises from left to right through the first: each shows its half of what they cover together.
        let up = [[0, 0, -1000], [2000, 0, 1000], [0, 2000, -1000]];
        let shown = areas(&[BIG, up]);
        assert!((shown[1] - 500_000.0).abs() < 1.0 && (shown[0] - 7_500_000.0).abs() < 1.0, "{shown:?}");
    }

    #[test]
    fn neighbours_of_one_colour_become_one_region() {
        let square = [[[0, 0, 0], [1000, 0, 0], [1000, 1000, 5]], [[0, 0, 0], [1000, 1000, 5], [0, 1000, 0]]];
        let mesh = mesh_of([4096; 2], &square);
        let found = with_run(1, |run| {
            let grid = Grid::new(&mesh, |t| t.hides, run).unwrap();
            regions(&mesh, &grid, &|_| [9; 3], run).unwrap()
        });
        assert_eq!((found.len(), found[0].rings.len(), found[0].rings[0].len()), (1, 1, 4));
    }

    /// The area that triangles cover together.
    fn union(corners: &[[GridPoint; 3]]) -> f64 {
        let mut overlay = Overlay::<i32>::new(corners.len() * 3);
        for triangle in corners {
            let ring = Triangle::new(*triangle, [0, 1, 2]).corners.map(|p| corner(p, 1.0, p));
            overlay.add_contour(&ring, ShapeType::Subject);
        }
        let point = |p: &Corner| [p.x, p.y].map(|c| f64::from(c) / f64::from(FINER));
        let shapes = overlay.overlay(OverlayRule::Subject, FillRule::NonZero);
        let rings = shapes.iter().flatten().map(|ring| ring.iter().map(point).collect::<Vec<_>>());
        rings.map(|ring| vitral_frame::drawing::signed_area(&ring)).sum()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        #[test]
        fn regions_cover_once_what_triangles_cover(
            corners in prop::collection::vec(prop::array::uniform3(prop::array::uniform3(0i32..4096)), 1..16),
        ) {
            let seen: f64 = areas(&corners).iter().sum();
            let covered = union(&corners);
            // Lost are slivers below the least area, and what rounding makes of thin ones.
            prop_assert!((seen - covered).abs() < 2e-3 * covered + 20.0 * LEAST_AREA as f64, "{} {}", seen, covered);
        }
    }
}
