//! The tables of a band, for whoever looks on.
//!
//! In:   polygon table, edge table, active edges (screen space). Out: the same in pixels.
//! Cost: linear in what is reported; nothing if nobody listens.

use super::edges::{ActiveEdge, EdgeEntry, PolygonEntry, SampleLine, downwards};
use crate::trace::Step;
use crate::trace::tables::{Bucket, Crossing, TableEdge, TablePolygon};
use crate::{Execution, PreparedView};
use vitral_exec::Limit;
use vitral_raster::SUBPIXEL;

/// Reports the tables of the band of these `rows` of pixels.
pub(super) fn tables(
    execution: &Execution,
    view: &PreparedView<'_>,
    rows: [usize; 2],
    (polygons, edges): (&[PolygonEntry<'_>], &[EdgeEntry]),
    lines: &[SampleLine],
) -> Result<(), Limit> {
    if execution.observer.is_none() {
        return Ok(());
    }
    let bytes = size_of_val(edges) / size_of::<EdgeEntry>()
        * (size_of::<TableEdge>() + size_of::<Bucket>())
        + polygons.len() * size_of::<TablePolygon>();
    execution.budget.charge(bytes as u64, "the edge table that is told")?;
    let rows = rows.map(|row| row as u32);
    let world = view.session.world();
    let polygon_table =
        polygons.iter().map(|p| polygon(p, world.surface_of_facet(p.shape.facet()))).collect();
    let buckets = buckets(polygons, edges, lines, rows[0]);
    execution.report(|| Step::EdgeTable { rows, polygons: polygon_table, buckets });
    execution.budget.release(bytes as u64);
    Ok(())
}

fn polygon(polygon: &PolygonEntry<'_>, surface: u32) -> TablePolygon {
    let setup = polygon.plane();
    let [dx, dy] = [setup.dz_dx, setup.dz_dy].map(f64::from);
    let [x, y] = setup.origin.map(pixels);
    TablePolygon {
        facet: setup.facet,
        surface,
        plane: [dx, dy, f64::from(setup.z) - x * dx - y * dy],
    }
}

/// The edge table, of a band whose first row of pixels is `top`.
fn buckets(
    polygons: &[PolygonEntry<'_>],
    edges: &[EdgeEntry],
    lines: &[SampleLine],
    top: u32,
) -> Vec<Bucket> {
    let place = |line: &SampleLine| [top + line.row as u32, line.sample as u32];

    // Describe an edge by its first crossing and its slope.
    let entry = |edge: &EdgeEntry| {
        let (shape, line) =
            (polygons[edge.polygon as usize].shape, &lines[usize::from(edge.lines.start)]);
        let active = ActiveEdge::new(edge, shape.outline(), line.y, 0);
        let (dx, dy, _) = downwards(shape.outline(), edge.corner);
        TableEdge {
            polygon: edge.polygon,
            facet: shape.facet(),
            edge: edge.corner,
            x: active.place(),
            dx: f64::from(dx) / f64::from(dy),
            last: place(&lines[usize::from(edge.lines.end) - 1]),
        }
    };

    // Put edges that begin on one line into one bucket.
    let bucket = |edges: &[EdgeEntry]| {
        let [row, sample] = place(&lines[usize::from(edges[0].lines.start)]);
        Bucket { row, sample, edges: edges.iter().map(entry).collect() }
    };
    edges.chunk_by(|a, b| a.lines.start == b.lines.start).map(bucket).collect()
}

/// The active edge table, from left to right; edges that cross the line at one place in the order
/// of the polygon table.
pub(super) fn crossings(active: &[ActiveEdge], polygons: &[PolygonEntry<'_>]) -> Vec<Crossing> {
    let crossing = |edge: &ActiveEdge| Crossing {
        x: edge.place(),
        polygon: edge.polygon,
        facet: polygons[edge.polygon as usize].shape.facet(),
        edge: edge.corner,
    };
    let mut crossings: Vec<_> = active.iter().map(crossing).collect();
    crossings
        .sort_by(|a, b| a.x.total_cmp(&b.x).then((a.polygon, a.edge).cmp(&(b.polygon, b.edge))));
    crossings
}

impl ActiveEdge {
    /// Where it crosses its line, in pixels.
    fn place(&self) -> f64 {
        pixels(self.x) + f64::from(self.remainder) / f64::from(self.dy) / f64::from(SUBPIXEL)
    }
}

fn pixels(v: i32) -> f64 {
    f64::from(v) / f64::from(SUBPIXEL)
}

#[cfg(test)]
mod tests {
    use super::super::edges::tests::{apart, triangle};
    use super::super::edges::{edge_table, lines, polygon_table};
    use super::*;
    use vitral_raster::{SamplePattern, Setup};

    /// Two triangles in pixels: corners (2,1) (10,1) (2,9), and (4,2) (12,10) (4,10), which
    /// overlap.
    fn overlapping() -> [Setup; 2] {
        let corners = |c: [[i32; 2]; 3]| c.map(|p| p.map(|v| v * SUBPIXEL));
        let [a, b] = [[[2, 1], [10, 1], [2, 9]], [[4, 2], [12, 10], [4, 10]]].map(corners);
        [triangle(a, [0.25; 3]), Setup { facet: 7, ..triangle(b, [0.5, 0.75, 0.5]) }]
    }

    #[test]
    fn p19_edge_table_of_two_triangles_by_hand() {
        let setups = overlapping();
        let shapes = apart(&setups);
        let polygons = polygon_table(&shapes);
        let lines = lines(&SamplePattern::new(1), 0, 16);
        let table = buckets(&polygons, &edge_table(&polygons, &lines), &lines, 0);
        // The line through the middle of row 1 is the first that meets a triangle whose top is at
        // 1; tops have no entry.
        let places: Vec<_> = table.iter().map(|b| (b.row, b.sample, b.edges.len())).collect();
        assert_eq!(places, [(1, 0, 2), (2, 0, 2)]);
        let of = |bucket: usize| {
            let mut told: Vec<_> = table[bucket]
                .edges
                .iter()
                .map(|e| (e.polygon, e.facet, e.x, e.dx, e.last))
                .collect();
            told.sort_by(|a, b| a.2.total_cmp(&b.2));
            told
        };
        // The first: upright at 2, and from (10,1) one to the left for each pixel down; at 1.5 it
        // is at 9.5.
        assert_eq!(of(0), [(0, 0, 2.0, 0.0, [8, 0]), (0, 0, 9.5, -1.0, [8, 0])]);
        // The second: upright at 4, and from (4,2) one to the right; at 2.5 it is at 4.5.
        assert_eq!(of(1), [(1, 7, 4.0, 0.0, [9, 0]), (1, 7, 4.5, 1.0, [9, 0])]);
        // Its depth rises from 0.5 to 0.75 over 8 pixels to the right.
        let TablePolygon { facet, surface, plane } = polygon(&polygons[1], 3);
        assert_eq!((facet, surface, plane), (7, 3, [1.0 / 32.0, 0.0, 0.5 - 4.0 / 32.0]));
    }

    #[test]
    fn p19_edges_from_above_a_band_begin_on_its_first_line() {
        let setups = [triangle([[0, -2560], [0, 2560], [5120, 2560]], [0.5; 3])];
        let shapes = apart(&setups);
        let polygons = polygon_table(&shapes);
        let lines = lines(&SamplePattern::new(1), 0, 4);
        let table = buckets(&polygons, &edge_table(&polygons, &lines), &lines, 0);
        assert_eq!((table.len(), table[0].row, table[0].edges.len()), (1, 0, 2));
        let slanted = table[0].edges.iter().find(|e| e.dx != 0.0).unwrap();
        assert_eq!((slanted.x, slanted.dx, slanted.last), (10.5, 1.0, [3, 0]));
    }
}
