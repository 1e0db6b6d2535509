//! Tests of `tree.rs`.

use super::*;

fn tree(triangles: &[[[f64; 3]; 3]]) -> BspTree {
    let triangles: Vec<_> = triangles.iter().map(|t| t.map(DVec3::from_array)).collect();
    BspTree::new(WorldPolygons::of_triangles(&triangles), &Execution::default()).unwrap()
}

fn order(tree: &BspTree, viewer: DVec4) -> Vec<u32> {
    let mut order = Vec::new();
    tree.back_to_front(viewer, |f| order.extend(tree.facets(f)));
    order
}

const FLAT: [[f64; 3]; 3] = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]];

#[test]
fn p22_three_floors_from_above_and_below() {
    let floor = |z: f64| FLAT.map(|[x, y, _]| [x, y, z]);
    let tree = tree(&[floor(1.0), floor(3.0), floor(2.0), floor(2.0)]);
    let at = |z: f64| DVec4::new(0.3, 0.1, z, 1.0);
    // The two in one plane: the lower facet last, from either side.
    assert_eq!(order(&tree, at(9.0)), [0, 3, 2, 1]);
    assert_eq!(order(&tree, at(-9.0)), [1, 3, 2, 0]);
    assert_eq!(order(&tree, DVec4::new(0.0, 0.0, 1.0, 0.0)), [0, 3, 2, 1]);
    assert_eq!((tree.splits(), tree.node_count()), (0, 3));
}

#[test]
fn p22_of_two_in_one_plane_the_one_that_faces_the_viewer_comes_last() {
    let turned = [FLAT[0], FLAT[2], FLAT[1]];
    for facets in [[FLAT, turned, FLAT], [turned, FLAT, turned]] {
        let tree = tree(&facets);
        let from = |z: f64| order(&tree, DVec4::new(0.3, 0.1, z, 1.0));
        let [up, down] = if facets[0] == FLAT { [9.0, -9.0] } else { [-9.0, 9.0] };
        assert_eq!((from(up), from(down)), (vec![1, 2, 0], vec![2, 0, 1]));
    }
}

#[test]
fn p22_a_polygon_through_another_is_split() {
    let wall = [[0.0, -1.0, -1.0], [0.0, 1.0, -1.0], [0.0, 0.0, 2.0]];
    let tree = tree(&[FLAT, wall]);
    assert_eq!((tree.splits(), tree.fragment_count()), (1, 3));
    let seen = order(&tree, DVec4::new(0.1, 0.0, 5.0, 1.0));
    assert_eq!(seen.len(), 3);
    let cut: Vec<_> = (0..3).flat_map(|f| tree.cuts(f).map(|(_, positive)| positive)).collect();
    assert_eq!(cut.len(), 2);
    assert_ne!(cut[0], cut[1], "one half lies on each side");
}

#[test]
fn a_needle_has_a_plane_and_odd_numbers_are_loose() {
    let needle = [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [0.5, 0.5, 0.5]];
    let point = [[2.0, 2.0, 2.0]; 3];
    let odd = [[f64::NAN, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let tree = tree(&[needle, point, odd, FLAT]);
    let mut seen = order(&tree, DVec4::new(3.0, 2.0, 5.0, 1.0));
    assert_eq!(seen[0], 2);
    seen.sort_unstable();
    seen.dedup();
    assert_eq!(seen, [0, 1, 2, 3]);
}

/// Area of all fragments of a facet, from the corners that the builder keeps.
fn area(points: &[DVec3]) -> f64 {
    let fan =
        (1..points.len() - 1).map(|i| (points[i] - points[0]).cross(points[i + 1] - points[0]));
    fan.fold(DVec3::ZERO, |sum, c| sum + c).length() * 0.5
}

#[test]
fn p22_the_halves_add_up() {
    let triangles = [FLAT.map(DVec3::from_array)];
    let (execution, polygons) = (Execution::default(), WorldPolygons::of_triangles(&triangles));
    let mut builder = Builder::new(&polygons, &execution);
    builder.points.extend(triangles[0]);
    let part = Part { polygon: 0, cuts: NONE, first: 0, count: 3 };
    let mut parts = vec![part];
    for plane in [
        ThickPlane::across(0, 0.1),
        ThickPlane::across(1, -0.3),
        ThickPlane::of([DVec3::X * 0.3, DVec3::Y * 0.3, DVec3::Z]),
    ] {
        let mut next = Vec::new();
        for part in parts {
            match side_of(&plane, builder.points_of(&part)) {
                BspSide::Across => next.extend(builder.split(&part, &plane, 0)),
                _ => next.push(part),
            }
        }
        parts = next;
    }
    let sum: f64 = parts.iter().map(|p| area(builder.points_of(p))).sum();
    assert!(parts.len() > 4 && (sum - 2.0).abs() < 1e-12, "{} parts, area {sum}", parts.len());
}
