//! Walls that stand on a facet, or go through it: the facet is cut along them.
//!
//! An element on both sides of a wall would carry light from one side to the other. So a facet is
//! cut along the line in which another one meets it, and its pieces share no vertices across the
//! wall: nothing is interpolated through it. Only facets that are large as against a patch are cut;
//! others are as good as elements that end somewhere near the wall.
//!
//! In:   facets, world space less the scene's middle. Out: [`WallPieces`].
//! Cost: large facets times all facets, for boxes; a few operations for those that meet.
//! Source: \[Baum, Mann, Smith & Winget 1991\]. Departs from it: only facets are cut, along whole
//!         lines within a convex piece.

use crate::Execution;
use std::collections::{BTreeMap, HashMap};
use vitral_exec::Limit;
use vitral_math::DVec3;

/// Facets whose longest edge is less than this part of a patch's are not cut.
const LARGE: f64 = 0.25;
/// Corners count as in a plane up to this part of the scene's size from it: some steps of single
/// precision.
const IN_PLANE: f64 = 2e-6;
/// Walls on one facet at most, the longest.
const MOST_WALLS: usize = 64;
/// Pieces of one facet at most.
const MOST_PIECES: usize = 128;
/// Boxes that may be compared: some seconds.
const MOST_BOXES: u64 = 1 << 31;
/// A cut is a wall where walls stand on more than this part of it.
const COVERED: f64 = 0.5;

/// The pieces of facets that are cut. They have numbers of their own, behind those of all facets.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct WallPieces {
    /// The facet of each piece, in ascending order.
    pub(super) facets: Vec<u32>,
    /// Corners of each piece, turned as the facet is.
    pub(super) corners: Vec<[DVec3; 3]>,
    /// Corners of its facet.
    pub(super) wholes: Vec<[DVec3; 3]>,
    /// Corners beside walls, by the number of their facet or piece, with a number for the side of
    /// the walls that they are on.
    sides: HashMap<(u32, u8), u32>,
}

impl WallPieces {
    /// Which side of the walls a corner is on, the same for corners at one place that are to share
    /// a vertex.
    pub(super) fn side(&self, piece: u32, corner: u8) -> u32 {
        self.sides.get(&(piece, corner)).copied().unwrap_or(0)
    }
}

/// A line in which a wall meets a facet.
#[derive(Clone, Copy, Debug)]
struct Wall {
    from: DVec3,
    to: DVec3,
}

/// A convex part of a facet: corners, and whether a wall stands on the edge from each to the next.
type Part = Vec<(DVec3, bool)>;

/// Cuts facets along the walls on them; patches will have edges of at most `longest`.
///
/// # Errors
/// A limit of the budget.
pub(super) fn cut(
    facets: &[Option<[DVec3; 3]>],
    longest: f64,
    extent: f64,
    execution: &Execution,
) -> Result<WallPieces, Limit> {
    // Find the walls on large facets.
    let near = IN_PLANE * extent;
    let large: Vec<u32> = (0..facets.len() as u32)
        .filter(|&f| facets[f as usize].is_some_and(|c| longest_edge(&c) > LARGE * longest))
        .collect();
    if large.len() as u64 * facets.len() as u64 > MOST_BOXES {
        return Ok(WallPieces::default());
    }
    let boxes: Vec<[DVec3; 2]> =
        facets.iter().map(|corners| bounds(corners.as_ref(), near)).collect();
    let found = execution.workers.map(large.len(), |i| {
        execution.budget.check("radiosity")?;
        Ok(walls_on(large[i], facets, &boxes, near))
    });
    let found: Vec<Vec<Wall>> = found.into_iter().collect::<Result<_, Limit>>()?;

    // Cut each facet along its walls, and its parts in triangles.
    let (mut pieces, mut walls) = (WallPieces::default(), Vec::new());
    for (&facet, on_it) in large.iter().zip(&found).filter(|(_, walls)| !walls.is_empty()) {
        let corners = facets[facet as usize].expect("large facets have corners");
        let parts = parts_between(&corners, on_it, near);
        if parts.len() < 2 {
            continue;
        }
        for part in parts {
            for k in 1..part.len() - 1 {
                let own = |edge: usize, real: bool| real && part[edge].1;
                walls.push([
                    own(0, k == 1),
                    own(k, true),
                    own(part.len() - 1, k + 2 == part.len()),
                ]);
                pieces.facets.push(facet);
                pieces.wholes.push(corners);
                pieces.corners.push([part[0].0, part[k].0, part[k + 1].0]);
            }
        }
    }
    pieces.sides = sides(facets, &pieces, &walls);
    Ok(pieces)
}

fn longest_edge([a, b, c]: &[DVec3; 3]) -> f64 {
    a.distance(*b).max(b.distance(*c)).max(c.distance(*a))
}

/// The box round a facet, with a margin.
fn bounds(corners: Option<&[DVec3; 3]>, margin: f64) -> [DVec3; 2] {
    let Some([a, b, c]) = corners else { return [DVec3::INFINITY, DVec3::NEG_INFINITY] };
    [a.min(*b).min(*c) - margin, a.max(*b).max(*c) + margin]
}

/// The walls on a facet, the longest first.
fn walls_on(
    facet: u32,
    facets: &[Option<[DVec3; 3]>],
    boxes: &[[DVec3; 2]],
    near: f64,
) -> Vec<Wall> {
    let Some(corners) = facets[facet as usize] else { return Vec::new() };
    let [low, high] = boxes[facet as usize];
    let Some(normal) = (corners[1] - corners[0]).cross(corners[2] - corners[0]).try_normalize()
    else {
        return Vec::new();
    };

    // Intersect every facet whose box touches this one's.
    let mut walls: Vec<Wall> = Vec::new();
    for (other, [other_low, other_high]) in boxes.iter().enumerate() {
        if low.cmpgt(*other_high).any() || other_low.cmpgt(high).any() || other == facet as usize {
            continue;
        }
        let Some(wall) = facets[other].and_then(|other| meeting(&corners, normal, &other, near))
        else {
            continue;
        };
        join(&mut walls, wall, near);
    }

    // Keep the longest.
    let length = |wall: &Wall| wall.from.distance(wall.to);
    walls.sort_by(|a, b| length(b).total_cmp(&length(a)));
    walls.truncate(MOST_WALLS);
    walls
}

/// Where the facet `other` meets the plane of a facet, as far as that lies within the facet and not
/// along its edges.
fn meeting(corners: &[DVec3; 3], normal: DVec3, other: &[DVec3; 3], near: f64) -> Option<Wall> {
    // Find the two points in which the other's outline meets the plane.
    let heights = other.map(|p| {
        let height = (p - corners[0]).dot(normal);
        if height.abs() <= near { 0.0 } else { height }
    });
    if heights.iter().all(|h| *h == 0.0)
        || heights.iter().all(|h| *h > 0.0)
        || heights.iter().all(|h| *h < 0.0)
    {
        return None;
    }
    let mut ends = Vec::with_capacity(3);
    for k in 0..3 {
        let (here, next) = (heights[k], heights[(k + 1) % 3]);
        if here == 0.0 {
            ends.push(other[k]);
        } else if here * next < 0.0 {
            ends.push(other[k].lerp(other[(k + 1) % 3], here / (here - next)));
        }
    }
    let &[from, to] = ends.as_slice() else { return None };
    let way = to - from;
    let (mut first, mut last) = (0.0f64, 1.0f64);

    // Clip to the facet; what lies along an edge of it cuts nothing.
    for k in 0..3 {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        let inwards = normal.cross(b - a).normalize_or_zero();
        let (start, slope) = ((from - a).dot(inwards), way.dot(inwards));
        if start.max(start + slope) <= 2.0 * near {
            return None;
        }
        if slope.abs() > f64::MIN_POSITIVE {
            let crossing = -start / slope;
            if slope > 0.0 { first = first.max(crossing) } else { last = last.min(crossing) }
        }
    }
    let wall = Wall { from: from + way * first, to: from + way * last };
    (last > first && wall.from.distance(wall.to) > 8.0 * near).then_some(wall)
}

/// Adds a wall; one that goes on another along the same line is one with it.
fn join(walls: &mut Vec<Wall>, mut wall: Wall, near: f64) {
    let mut at = 0;
    // Measure the known wall along the line of this one.
    while at < walls.len() {
        let known = walls[at];
        let along = (wall.to - wall.from).normalize_or_zero();
        let beside = |p: DVec3| (p - wall.from).reject_from_normalized(along).length();
        let [a, b] = [known.from, known.to].map(|p| (p - wall.from).dot(along));
        let length = wall.from.distance(wall.to);
        let touches = a.min(b) <= length + 4.0 * near && a.max(b) >= -4.0 * near;
        if beside(known.from) > 4.0 * near || beside(known.to) > 4.0 * near || !touches {
            at += 1;
            continue;
        }

        // Extend this one by a wall on the same line, and search from the start.
        let start = wall.from;
        wall = Wall {
            from: start + along * a.min(b).min(0.0),
            to: start + along * a.max(b).max(length),
        };
        walls.swap_remove(at);
        at = 0;
    }
    walls.push(wall);
}

/// The parts of a facet between walls.
fn parts_between(corners: &[DVec3; 3], walls: &[Wall], near: f64) -> Vec<Part> {
    let mut parts = vec![corners.iter().map(|p| (*p, false)).collect::<Part>()];
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
    for wall in walls {
        let mut next = Vec::with_capacity(parts.len() + 2);
        for part in parts {
            if next.len() < MOST_PIECES {
                split(part, wall, normal, near, &mut next);
            } else {
                next.push(part);
            }
        }
        parts = next;
    }
    parts
}

/// Cuts a part along a wall, if the wall goes through it; marks the edge that it stands on.
fn split(mut part: Part, wall: &Wall, normal: DVec3, near: f64, into: &mut Vec<Part>) {
    let along = (wall.to - wall.from).normalize_or_zero();
    let across = normal.cross(along);
    let length = wall.from.distance(wall.to);
    let covers = |a: DVec3, b: DVec3| {
        let [a, b] = [a, b].map(|p| (p - wall.from).dot(along));
        let (low, high) = (a.min(b), a.max(b));
        (high.min(length) - low.max(0.0)).max(0.0) / (high - low).max(near)
    };
    let heights: Vec<f64> = part
        .iter()
        .map(|(p, _)| {
            let height = (*p - wall.from).dot(across);
            if height.abs() <= 2.0 * near { 0.0 } else { height }
        })
        .collect();
    let count = part.len();

    // Mark an edge that lies along the wall.
    for k in 0..count {
        let next = (k + 1) % count;
        if heights[k] == 0.0 && heights[next] == 0.0 && covers(part[k].0, part[next].0) > COVERED {
            part[k].1 = true;
        }
    }
    if heights.iter().all(|h| *h >= 0.0) || heights.iter().all(|h| *h <= 0.0) {
        into.push(part);
        return;
    }

    // Deal the corners out to both sides; the points on the line go to both.
    let mut halves: [Part; 2] = [Vec::new(), Vec::new()];
    let mut ends = Vec::with_capacity(2);
    for k in 0..count {
        let ((here, walled), (there, _)) = (part[k], part[(k + 1) % count]);
        let (height, next) = (heights[k], heights[(k + 1) % count]);
        if height == 0.0 {
            // The edge that leaves the line towards a side keeps its mark there; the other half has
            // the cut.
            halves[0].push((here, walled && next > 0.0));
            halves[1].push((here, walled && next < 0.0));
            ends.push(here);
        } else {
            halves[usize::from(height < 0.0)].push((here, walled));
        }
        if height * next < 0.0 {
            let point = rounded(here.lerp(there, height / (height - next)), near);
            let leaving = usize::from(height < 0.0);
            halves[leaving].push((point, false));
            halves[1 - leaving].push((point, walled));
            ends.push(point);
        }
    }
    let &[a, b] = ends.as_slice() else {
        into.push(part);
        return;
    };
    if covers(a, b) * a.distance(b) <= 4.0 * near {
        into.push(part);
        return;
    }

    // The cut is a wall on both sides where walls stand on most of it.
    let is_wall = covers(a, b) > COVERED;
    for mut half in halves {
        let corners = half.len();
        for k in 0..corners {
            let (here, there) = (half[k].0, half[(k + 1) % corners].0);
            let is_cut = (here == a && there == b) || (here == b && there == a);
            half[k].1 |= is_cut && is_wall;
        }
        if corners > 2 {
            into.push(half);
        }
    }
}

/// A place on a grid that is finer than what counts as near: both facets at an edge find the same
/// place.
fn rounded(p: DVec3, near: f64) -> DVec3 {
    // The power of two at or below an eighth.
    let step = f64::from_bits((near * 0.125).to_bits() & !((1 << 52) - 1));
    (p / step).round() * step
}

/// A place, as a key.
fn key(p: DVec3) -> [u64; 3] {
    // Adding 0 makes -0 to 0.
    (p + 0.0).to_array().map(f64::to_bits)
}

/// For corners at the ends of walls, which side of them they are on: those whose triangles hang
/// together round the place, by edges without walls, are on one.
fn sides(
    facets: &[Option<[DVec3; 3]>],
    pieces: &WallPieces,
    walls: &[[bool; 3]],
) -> HashMap<(u32, u8), u32> {
    // Collect the places at the ends of walls.
    let mut at_walls: BTreeMap<[u64; 3], Vec<(u32, u8)>> = BTreeMap::new();
    for (corners, walls) in pieces.corners.iter().zip(walls) {
        for k in (0..3).filter(|&k| walls[k]) {
            at_walls.entry(key(corners[k])).or_default();
            at_walls.entry(key(corners[(k + 1) % 3])).or_default();
        }
    }

    // Collect the corners there, of pieces and of whole facets.
    let mut is_cut = vec![false; facets.len()];
    pieces.facets.iter().for_each(|&f| is_cut[f as usize] = true);
    let whole = facets
        .iter()
        .enumerate()
        .filter(|(f, _)| !is_cut[*f])
        .filter_map(|(f, c)| Some((f as u32, (*c)?)));
    let cut =
        pieces.corners.iter().enumerate().map(|(i, corners)| ((facets.len() + i) as u32, *corners));
    let all: Vec<(u32, [DVec3; 3])> = whole.chain(cut).collect();
    let mut triangles: HashMap<u32, [[u64; 3]; 3]> = HashMap::new();
    for (number, corners) in all {
        for (k, corner) in (0..3u8).zip(corners) {
            if let Some(list) = at_walls.get_mut(&key(corner)) {
                list.push((number, k));
                triangles.insert(number, corners.map(key));
            }
        }
    }

    // Join corners whose triangles share an edge from there without a wall.
    let has_wall = |number: u32, edge: usize| {
        (number as usize).checked_sub(facets.len()).is_some_and(|piece| walls[piece][edge])
    };
    let mut sides = HashMap::new();
    for list in at_walls.values() {
        let mut group: Vec<usize> = (0..list.len()).collect();
        for i in 0..list.len() {
            for j in 0..i {
                let [(a, ka), (b, kb)] = [list[i], list[j]];
                let (ta, tb) = (triangles[&a], triangles[&b]);
                let (ka, kb) = (usize::from(ka), usize::from(kb));
                // The edge to the next corner, and the one from the corner before.
                let joined = [(ka, 1), (ka, 2)].into_iter().any(|(ka, step)| {
                    let edge = if step == 1 { ka } else { (ka + 2) % 3 };
                    let end = ta[(ka + step) % 3];
                    [(1, kb), (2, (kb + 2) % 3)].into_iter().any(|(step, other)| {
                        tb[(kb + step) % 3] == end && !has_wall(a, edge) && !has_wall(b, other)
                    })
                });
                if joined {
                    let (old, new) = (group[i].max(group[j]), group[i].min(group[j]));
                    group.iter_mut().filter(|g| **g == old).for_each(|g| *g = new);
                }
            }
        }
        // Sides are named after their first corner, which does not depend on the order of places.
        for (corner, group) in list.iter().zip(group) {
            let (number, k) = list[group];
            sides.insert(*corner, 1 + 3 * number + u32::from(k));
        }
    }
    sides
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::dvec3;

    /// A square floor from 0 to 4 in two triangles, and the triangles of upright walls along these
    /// lines.
    fn floor_with(walls: &[[[f64; 2]; 2]]) -> Vec<Option<[DVec3; 3]>> {
        let at = |x: f64, z: f64| dvec3(x, 0.0, z);
        let mut facets = vec![
            [at(0.0, 0.0), at(0.0, 4.0), at(4.0, 4.0)],
            [at(0.0, 0.0), at(4.0, 4.0), at(4.0, 0.0)],
        ];
        for [[ax, az], [bx, bz]] in walls {
            let [a, b] = [at(*ax, *az), at(*bx, *bz)];
            facets.extend([[a, b, b + DVec3::Y], [a, b + DVec3::Y, a + DVec3::Y]]);
        }
        facets.into_iter().map(Some).collect()
    }

    fn area([a, b, c]: &[DVec3; 3]) -> f64 {
        0.5 * (*b - *a).cross(*c - *a).length()
    }

    #[test]
    fn a_wall_across_a_floor_cuts_it_and_no_vertex_is_shared_through_it() {
        let facets = floor_with(&[[[1.0, 0.0], [1.0, 4.0]]]);
        let pieces = cut(&facets, 1.0, 4.0, &Execution::default()).unwrap();
        let sum: f64 = pieces.corners.iter().map(area).sum();
        assert!((sum - 16.0).abs() < 1e-9, "nothing is lost: {sum}");
        let mut sides: [Vec<u32>; 2] = [Vec::new(), Vec::new()];
        for (i, corners) in pieces.corners.iter().enumerate() {
            let beyond = corners.iter().any(|p| p.x > 1.0 + 1e-9);
            assert!(
                !beyond || corners.iter().all(|p| p.x > 1.0 - 1e-9),
                "{corners:?} is on both sides"
            );
            for (k, _) in (0..3u8).zip(corners).filter(|(_, p)| (p.x - 1.0).abs() < 1e-9) {
                sides[usize::from(beyond)].push(pieces.side((facets.len() + i) as u32, k));
            }
        }
        assert!(sides[0].iter().all(|side| *side > 0 && !sides[1].contains(side)), "{sides:?}");
    }

    #[test]
    fn what_stands_on_a_floor_cuts_out_its_outline() {
        let p = [[1.0, 1.5], [2.0, 1.5], [2.0, 2.5], [1.0, 2.5]];
        let facets = floor_with(&[[p[0], p[1]], [p[1], p[2]], [p[2], p[3]], [p[3], p[0]]]);
        let pieces = cut(&facets, 1.0, 4.0, &Execution::default()).unwrap();
        let inside = |c: &&[DVec3; 3]| {
            let middle = (c[0] + c[1] + c[2]) / 3.0;
            (1.0..2.0).contains(&middle.x) && (1.5..2.5).contains(&middle.z)
        };
        let (within, all): (f64, f64) = (
            pieces.corners.iter().filter(inside).map(area).sum(),
            pieces.corners.iter().map(area).sum(),
        );
        assert!((within - 1.0).abs() < 1e-9 && (all - 16.0).abs() < 1e-9, "{within} {all}");
    }

    #[test]
    fn edges_that_facets_share_and_small_facets_cut_nothing() {
        // A corner of a room: walls along two edges of the floor.
        let corner = floor_with(&[[[0.0, 0.0], [4.0, 0.0]], [[0.0, 0.0], [0.0, 4.0]]]);
        assert_eq!(cut(&corner, 1.0, 4.0, &Execution::default()).unwrap(), WallPieces::default());
        let across = floor_with(&[[[1.0, 0.0], [1.0, 4.0]]]);
        assert_eq!(cut(&across, 40.0, 4.0, &Execution::default()).unwrap(), WallPieces::default());
    }
}
