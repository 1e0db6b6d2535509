//! Regions that are clipped, by hand and at random.

use super::super::fill::first_right;
use super::*;
use vitral_raster::SamplePattern;

/// In pixels; corners run clockwise as one looks at the screen.
fn convex(corners: &[[i32; 2]]) -> ConvexOutline {
    ConvexOutline::polygon(&corners.iter().map(|c| c.map(|v| v * 256)).collect::<Vec<_>>())
}

fn region(corners: &[[i32; 2]]) -> Region {
    Region::polygon(&convex(corners))
}

fn clip(region: &Region, corners: &[[i32; 2]]) -> [Region; 2] {
    let mut outside = region.clone();
    match outside.clip(&convex(corners), &convex(&SQUARE), &mut Workspace::default()) {
        Clipped::Inside => [outside, Region::default()],
        Clipped::Outside => [Region::default(), outside],
        Clipped::Both(inside) => [inside, outside],
    }
}

/// Whether the sample of this column, at `x` in its pixel, and at `y`, is in a region.
fn covers(region: &[FillEdge], column: i32, x: i32, y: i32) -> bool {
    let crossed = region
        .iter()
        .filter(|e| (e.y[0]..e.y[1]).contains(&y) && first_right(e, y, x) <= column.into());
    crossed.count() % 2 == 1
}

const SQUARE: [[i32; 2]; 4] = [[0, 0], [10, 0], [10, 10], [0, 10]];

fn shape(region: &Region) -> Vec<usize> {
    let mut shape: Vec<_> = region.outlines().iter().map(|outline| outline.corners.len()).collect();
    shape.sort_unstable();
    shape
}

#[test]
fn p24_a_triangle_in_the_middle_leaves_a_hole() {
    let [inside, outside] = clip(&region(&SQUARE), &[[3, 3], [7, 3], [3, 7]]);
    assert!((inside.area() - 8.0).abs() < 1e-9 && (outside.area() - 92.0).abs() < 1e-9);
    assert_eq!((shape(&inside), shape(&outside)), (vec![3], vec![3, 4]));
    // A second one across the hole's edge: the hole grows.
    let [inside, outside] = clip(&outside, &[[5, 3], [9, 3], [5, 7]]);
    assert!((inside.area() + outside.area() - 92.0).abs() < 1e-9);
    assert!((inside.area() - 6.0).abs() < 1e-9, "{}", inside.area());
    // And one that cuts the square in two.
    let [_, outside] = clip(&outside, &[[-5, 4], [20, 4], [20, 5], [-5, 5]]);
    assert_eq!(shape(&outside).len(), 2);
}

#[test]
fn p24_degenerate_cases() {
    let square = region(&SQUARE);
    let areas = |corners: &[[i32; 2]]| clip(&square, corners).map(|r| r.area());
    // Itself; the same with a corner on an edge; half of it along three edges.
    assert_eq!(areas(&SQUARE), [100.0, 0.0]);
    assert_eq!(areas(&[[0, 0], [10, 0], [10, 10]]), [50.0, 50.0]);
    assert_eq!(areas(&[[0, 0], [5, 0], [5, 10], [0, 10]]), [50.0, 50.0]);
    // Touching along an edge, in a part of an edge, in a corner.
    for touching in [
        [[10, 0], [20, 0], [20, 10], [10, 10]],
        [[10, 3], [20, 3], [20, 5], [10, 5]],
        [[10, 10], [20, 10], [20, 20], [10, 20]],
    ] {
        assert_eq!(areas(&touching), [0.0, 100.0]);
    }
    // From outside to a corner; corners on two edges.
    assert_eq!(areas(&[[0, 0], [5, -5], [10, 0]]), [0.0, 100.0]);
    assert_eq!(areas(&[[5, 0], [10, 5], [5, 10], [0, 5]]), [50.0, 50.0]);
    // Clipped again with the same: nothing is left to clip.
    let [inside, outside] = clip(&square, &[[5, 0], [10, 5], [5, 10], [0, 5]]);
    assert!(clip(&outside, &[[5, 0], [10, 5], [5, 10], [0, 5]])[0].is_empty());
    assert!(clip(&inside, &[[5, 0], [10, 5], [5, 10], [0, 5]])[1].is_empty());
    // A hole may touch the outline, and outlines that touch in a point stay apart.
    assert_eq!(shape(&outside), [4, 4]);
    let [_, left] = clip(&square, &[[0, 0], [10, 0], [5, 5]]);
    assert_eq!(shape(&clip(&left, &[[10, 10], [0, 10], [5, 5]])[1]), [3, 3]);
}

/// Random triangles within `side` units, on a grid of `step`.
fn triangles(state: &mut u32, count: usize, side: i32, size: i32, step: i32) -> Vec<ConvexOutline> {
    let mut next = |size: i32| {
        *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (*state >> 8) as i32 % size
    };
    let mut triangles = Vec::new();
    while triangles.len() < count {
        let origin = [0; 2].map(|_| next(side + size) - size);
        let mut corners = [0; 3].map(|_| origin.map(|v| (v + next(size * 3 / 2)) / step * step));
        let [a, b, c] = corners;
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        if area < 0 {
            corners.swap(1, 2);
        }
        if area != 0 {
            triangles.push(ConvexOutline::polygon(&corners));
        }
    }
    triangles
}

#[test]
fn p24_random_polygons_share_samples_and_area_out() {
    let pattern = SamplePattern::new(4);
    let (mut state, mut work) = (5u32, Workspace::default());
    let whole = convex(&[[0, 0], [64, 0], [64, 64], [0, 64]]);
    for round in 0..100 {
        // Coarse grids make degenerate cases, and samples on edges.
        let step = [1, 32, 1024, 4096][round % 4];
        let mut parts = vec![Region::polygon(&whole)];
        for polygon in triangles(&mut state, 12, 16384, 12000, step) {
            for i in 0..parts.len() {
                if let Clipped::Both(inside) = parts[i].clip(&polygon, &whole, &mut work) {
                    parts.push(inside);
                }
            }
        }
        let area: f64 = parts.iter().map(Region::area).sum();
        assert!((area - 4096.0).abs() < 1e-6, "round {round}: {area}");
        // Each sample is in exactly one.
        let parts: Vec<Vec<_>> = parts.iter().map(|part| part.fill_edges().collect()).collect();
        for (row, s) in (0..64).step_by(3).flat_map(|row| (0..4).map(move |s| (row, s))) {
            let [x, y] = pattern.position(s);
            for column in 0..64 {
                let count =
                    parts.iter().filter(|part| covers(part, column, x, row * 256 + y)).count();
                assert_eq!(count, 1, "round {round}: {column}, {row}, {s}");
            }
        }
    }
}

#[test]
fn an_index_of_edges_changes_nothing() {
    let (mut state, mut work) = (17u32, Workspace::default());
    let whole = convex(&[[0, 0], [64, 0], [64, 48], [0, 48]]);
    for round in 0..12 {
        let (size, step) = ([700, 2500, 6000][round % 3], [1, 64][round % 2]);
        let mut left = Region::polygon(&whole);
        let mut left_of_bands = [0, 1, 2, 3].map(|i| {
            let [top, bottom] = [i * 12, i * 12 + 12];
            let band = convex(&[[0, top], [64, top], [64, bottom], [0, bottom]]);
            (Region::polygon(&band), band)
        });
        for (i, polygon) in triangles(&mut state, 300, 16384, size, step).iter().enumerate() {
            let inside_of = |clipped, region: &mut Region| match clipped {
                Clipped::Outside => 0.0,
                Clipped::Inside => std::mem::take(region).area(),
                Clipped::Both(inside) => inside.area(),
            };
            let clipped = left.clip(polygon, &whole, &mut work);
            let inside = inside_of(clipped, &mut left);
            let of_bands = left_of_bands.iter_mut().map(|(region, band)| {
                let clipped = region.clip(polygon, band, &mut work);
                inside_of(clipped, region)
            });
            let expected: f64 = of_bands.sum();
            assert!((inside - expected).abs() < 1e-6, "round {round}, {i}: {inside} of {expected}");
        }
        let outlines = left.outlines();
        let edges: usize = outlines.iter().map(|outline| outline.corners.len()).sum();
        assert!(edges > 0 && edges <= left.edges().count(), "{edges}");
    }
}

#[test]
fn p24_samples_of_a_triangle_are_those_that_its_edge_functions_cover() {
    use vitral_raster::{CornerPosition, Setup};
    for corners in [
        [[0, 0], [2048, 0], [0, 2048]],
        [[128, 128], [1408, 640], [640, 1408]],
        [[77, 9], [3000, 1111], [500, 4000]],
    ] {
        let [a, b, c] = corners.map(|[x, y]| CornerPosition { x, y, z: 0.5 });
        let setup = Setup::new([a, b, c], Setup::doubled_area(a, b, c), 0);
        let edges: Vec<_> =
            Region::polygon(&ConvexOutline::polygon(&corners)).fill_edges().collect();
        for (row, column) in (0..20).flat_map(|row| (0..20).map(move |column| (row, column))) {
            let expected = setup.covers(column * 256 + 128, row * 256 + 128);
            assert_eq!(
                covers(&edges, column, 128, row * 256 + 128),
                expected,
                "{corners:?}: {column}, {row}"
            );
        }
    }
}
