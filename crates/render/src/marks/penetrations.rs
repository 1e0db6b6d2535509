//! The lines in which faces penetrate each other: where a triangle of the scene passes through
//! another one.
//!
//! A tree of boxes over all triangles finds the pairs that may meet: it is gone through against
//! itself, two boxes at a time. Each triangle of a pair must have corners on both sides of the
//! other's plane. Then both triangles cut the line in which the planes meet, and the part of it
//! that lies in both is the line of penetration. A corner in a plane counts as in front of it, so
//! that a body whose edge lies in a face is cut once. Neighbours along an edge share that line
//! already, and coplanar triangles have none.
//!
//! In:   the world's triangles. Out: segments, world space less [`Penetrations::center`].
//! Cost: `n log n` for the tree, then one test for each pair of triangles whose boxes meet; a mesh
//! without penetrations has about seven pairs a triangle, its neighbours. Memory: about 110 bytes a
//! triangle while it is built.
//! Source: \[Möller 1997\] for the test of a pair, in double precision.

use crate::{Cached, Execution, Session};
use std::ops::Range;
use std::sync::Arc;
use vitral_exec::Limit;
use vitral_math::DVec3;
use vitral_scene::World;

/// Triangles in a leaf of the tree. With more, more pairs are tested; with fewer, more boxes.
const LEAF: usize = 4;
/// Pairs of subtrees that are gone through by different threads.
const TASKS: usize = 256;
/// Sine of the angle between planes, squared, below which they count as parallel.
const PARALLEL: f64 = 1e-12;
/// Part of the scene's largest coordinate below which a distance or a length is rounding of
/// positions, which are of single precision: two of its steps.
const ROUNDING: f64 = 1.0 / (1u32 << 22) as f64;
/// Bytes of a triangle, its box and its place in the tree.
const BYTES_A_TRIANGLE: u64 = 112;
/// Most lines that are kept.
const MOST_LINES: usize = 1 << 22;

/// The lines in which the faces of a scene penetrate each other.
#[derive(Debug)]
pub struct Penetrations {
    /// What the ends are relative to, world space.
    pub center: DVec3,
    /// The ends of each line.
    pub lines: Vec<[[f32; 3]; 2]>,
}

impl Cached for Penetrations {
    type Key = ();
}

impl Penetrations {
    /// Those of a session's scene.
    ///
    /// # Errors
    /// A limit of the budget.
    pub fn of(session: &Session, execution: &Execution) -> Result<Arc<Self>, Limit> {
        session.cache().get_or_build((), || {
            let bytes = u64::from(session.world().facet_count) * BYTES_A_TRIANGLE;
            execution
                .budget
                .charged(bytes, "lines of penetration", || Self::find(session.world(), execution))
        })
    }

    fn find(world: &World, execution: &Execution) -> Result<Self, Limit> {
        // Collect the triangles relative to the scene's middle.
        let bounds = &world.bounds;
        let center = if bounds.is_empty() { DVec3::ZERO } else { bounds.center() };
        let triangles = triangles(world, center);
        if triangles.len() < 2 {
            return Ok(Self { center, lines: Vec::new() });
        }

        // Build the tree and search pairs of subtrees in parallel.
        let noise = bounds.min.abs().max(bounds.max.abs()).max_element() * ROUNDING;
        let tree = Tree::new(&triangles, noise, execution)?;
        let tasks = tree.tasks();
        let found = execution.workers.map(tasks.len(), |i| {
            execution.budget.check("lines of penetration")?;
            let mut lines = Vec::new();
            let [a, b] = tasks[i];
            tree.meet(a, b, &triangles, &mut lines, &|| {
                execution.budget.check("lines of penetration")
            })?;
            Ok(lines)
        });

        // Join the lines up to the limit.
        let mut lines = Vec::new();
        for found in found {
            lines.extend(found?);
            lines.truncate(MOST_LINES);
        }
        Ok(Self { center, lines })
    }
}

/// The triangles with area of a scene, world space less `center`.
fn triangles(world: &World, center: DVec3) -> Vec<[DVec3; 3]> {
    let mut triangles = Vec::with_capacity(world.facet_count as usize);
    for instance in &world.instances {
        let placed = |p: &[f32; 3]| {
            instance.world_from_model.transform_point3(DVec3::from_array(p.map(f64::from))) - center
        };
        let positions: Vec<DVec3> = instance.mesh.positions.iter().map(placed).collect();
        let corners = instance.mesh.triangles.iter().map(|t| t.map(|i| positions[i as usize]));
        triangles.extend(corners.filter(|[a, b, c]| {
            let normal = (*b - *a).cross(*c - *a);
            normal.is_finite() && normal != DVec3::ZERO
        }));
    }
    triangles
}

/// A box, rounded outwards to single precision.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    min: [f32; 3],
    max: [f32; 3],
}

impl Bounds {
    const EMPTY: Self = Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    fn of(corners: &[DVec3; 3]) -> Self {
        let [a, b, c] = *corners;
        let (min, max) = (a.min(b).min(c), a.max(b).max(c));
        Self {
            min: min.to_array().map(|v| (v as f32).next_down()),
            max: max.to_array().map(|v| (v as f32).next_up()),
        }
    }

    fn with(&self, other: &Self) -> Self {
        Self {
            min: [0, 1, 2].map(|k| self.min[k].min(other.min[k])),
            max: [0, 1, 2].map(|k| self.max[k].max(other.max[k])),
        }
    }

    fn meets(&self, other: &Self) -> bool {
        (0..3).all(|k| self.min[k] <= other.max[k] && other.min[k] <= self.max[k])
    }

    /// Twice its middle along an axis.
    fn middle(&self, axis: usize) -> f32 {
        self.min[axis] + self.max[axis]
    }

    fn longest_axis(&self) -> usize {
        let size = |k: usize| self.max[k] - self.min[k];
        (0..3).max_by(|&a, &b| size(a).total_cmp(&size(b))).unwrap_or(0)
    }
}

/// A node of the tree: its box, its triangles, and where its children stand, the second one's
/// number; 0 for a leaf.
#[derive(Clone, Debug)]
struct Node {
    bounds: Bounds,
    items: Range<u32>,
    second: u32,
}

/// Boxes over triangles; the first child of a node stands right behind it.
struct Tree {
    nodes: Vec<Node>,
    /// Triangles in the order of the leaves, and their boxes.
    order: Vec<u32>,
    boxes: Vec<Bounds>,
    /// Greatest distance, world space, that counts as rounding.
    noise: f64,
}

impl Tree {
    fn new(triangles: &[[DVec3; 3]], noise: f64, execution: &Execution) -> Result<Self, Limit> {
        let mut items: Vec<(Bounds, u32)> = triangles.iter().map(Bounds::of).zip(0..).collect();
        let count = items.len();
        let nodes = build(&mut items, 0, execution)?;
        debug_assert_eq!(nodes[0].items, 0..count as u32);
        let (boxes, order) = items.into_iter().unzip();
        Ok(Self { nodes, order, boxes, noise })
    }

    fn children(&self, node: usize) -> Option<[usize; 2]> {
        let second = self.nodes[node].second as usize;
        (second != 0).then_some([node + 1, second])
    }

    /// The pairs of two nodes' parts whose boxes may meet; `None` if neither has parts.
    fn split(&self, a: usize, b: usize) -> Option<Vec<[usize; 2]>> {
        if a == b {
            return self.children(a).map(|[l, r]| vec![[l, l], [r, r], [l, r]]);
        }
        let size = |node: usize| self.nodes[node].items.len();
        let (large, small) = if size(a) >= size(b) { (a, b) } else { (b, a) };
        match (self.children(large), self.children(small)) {
            (Some([l, r]), _) => Some(vec![[l, small], [r, small]]),
            (None, Some([l, r])) => Some(vec![[l, large], [r, large]]),
            (None, None) => None,
        }
    }

    /// Pairs of subtrees for the threads; together they hold all pairs.
    fn tasks(&self) -> Vec<[usize; 2]> {
        let mut tasks = vec![[0, 0]];
        loop {
            let mut next = Vec::with_capacity(3 * tasks.len());
            for &[a, b] in &tasks {
                match self.split(a, b) {
                    Some(parts) => {
                        next.extend(parts.into_iter().filter(|&[a, b]| self.may_meet(a, b)))
                    }
                    None => next.push([a, b]),
                }
            }
            let grown = next.len() > tasks.len();
            tasks = next;
            if tasks.len() >= TASKS || !grown {
                return tasks;
            }
        }
    }

    fn may_meet(&self, a: usize, b: usize) -> bool {
        a == b || self.nodes[a].bounds.meets(&self.nodes[b].bounds)
    }

    /// Adds the lines of the triangles of two nodes. `check` is asked now and then.
    fn meet(
        &self,
        a: usize,
        b: usize,
        triangles: &[[DVec3; 3]],
        lines: &mut Vec<[[f32; 3]; 2]>,
        check: &dyn Fn() -> Result<(), Limit>,
    ) -> Result<(), Limit> {
        let (mut stack, mut leaves) = (vec![[a, b]], 0usize);
        // Skip pairs of nodes whose boxes are apart, and split larger ones.
        while let Some([a, b]) = stack.pop() {
            if !self.may_meet(a, b) || lines.len() >= MOST_LINES {
                continue;
            }
            if let Some(parts) = self.split(a, b) {
                stack.extend(parts);
                continue;
            }

            // Intersect the triangles of two leaves.
            leaves += 1;
            if leaves.is_multiple_of(4096) {
                check()?;
            }
            for i in self.nodes[a].items.clone() {
                let others = if a == b {
                    i + 1..self.nodes[a].items.end
                } else {
                    self.nodes[b].items.clone()
                };
                let own = &self.boxes[i as usize];
                for j in others.filter(|&j| own.meets(&self.boxes[j as usize])) {
                    let pair = [i, j].map(|at| &triangles[self.order[at as usize] as usize]);
                    lines.extend(
                        penetration(pair[0], pair[1], self.noise)
                            .map(|ends| ends.map(|p| p.as_vec3().to_array())),
                    );
                }
            }
        }
        Ok(())
    }
}

/// The nodes of a subtree over `items`, the first of which is the `first` of all; sorts them into
/// the order of the leaves.
fn build(
    items: &mut [(Bounds, u32)],
    first: u32,
    execution: &Execution,
) -> Result<Vec<Node>, Limit> {
    /// Subtrees of fewer triangles are built by one thread.
    const ALONE: usize = 8192;

    // Make a leaf of few triangles.
    let bounds = items.iter().fold(Bounds::EMPTY, |all, (b, _)| all.with(b));
    let node = |second| Node { bounds, items: first..first + items.len() as u32, second };
    if items.len() <= LEAF {
        return Ok(vec![node(0)]);
    }

    // Split at the median along the longest side.
    let mut nodes = vec![node(0)];
    let (axis, half) = (bounds.longest_axis(), items.len() / 2);
    items.select_nth_unstable_by(half, |a, b| {
        a.0.middle(axis).total_cmp(&b.0.middle(axis)).then(a.1.cmp(&b.1))
    });
    let (low, high) = items.split_at_mut(half);
    let middle = first + half as u32;
    let (low, high) = if half >= ALONE {
        execution.budget.check("lines of penetration")?;
        execution.workers.join(|| build(low, first, execution), || build(high, middle, execution))
    } else {
        (build(low, first, execution), build(high, middle, execution))
    };

    // Append both subtrees with their indices moved.
    for part in [low?, high?] {
        let offset = nodes.len() as u32;
        if offset > 1 {
            nodes[0].second = offset;
        }
        let moved =
            |n: Node| Node { second: if n.second == 0 { 0 } else { n.second + offset }, ..n };
        nodes.extend(part.into_iter().map(moved));
    }
    Ok(nodes)
}

/// The line in which two triangles penetrate each other, if they do and it is longer than `noise`.
fn penetration(a: &[DVec3; 3], b: &[DVec3; 3], noise: f64) -> Option<[DVec3; 2]> {
    // Neighbours along an edge touch there and nowhere else, or are coplanar.
    if b.iter().filter(|q| a.contains(q)).count() >= 2 {
        return None;
    }
    let normal = |t: &[DVec3; 3]| (t[1] - t[0]).cross(t[2] - t[0]);
    let (n, m) = (normal(a), normal(b));
    let of_b = distances(a[0], n, b, noise)?;
    let of_a = distances(b[0], m, a, noise)?;
    let along = n.cross(m);
    if along.length_squared() <= PARALLEL * n.length_squared() * m.length_squared() {
        return None;
    }

    // Both cut the line of the planes: what do their pieces have in common?
    let along = along.normalize();
    let piece = |t: &[DVec3; 3], d: &[f64; 3]| {
        let [p, q] = crossing(t, d);
        if along.dot(p) <= along.dot(q) { [p, q] } else { [q, p] }
    };
    let ([p, q], [r, s]) = (piece(a, &of_a), piece(b, &of_b));
    let start = if along.dot(p) >= along.dot(r) { p } else { r };
    let end = if along.dot(q) <= along.dot(s) { q } else { s };
    // Corners that only touch leave a point, up to rounding.
    (along.dot(end - start) > noise).then_some([start, end])
}

/// Signed distances, times the length of `normal`, of the corners of `t` from the plane through
/// `point`; a corner nearer to the plane than `noise` counts as in front of it. `None` if all
/// corners are on one side.
fn distances(point: DVec3, normal: DVec3, t: &[DVec3; 3], noise: f64) -> Option<[f64; 3]> {
    let least = normal.length() * noise;
    let d = t.map(|p| {
        let distance = normal.dot(p - point);
        if distance.abs() <= least { 0.0 } else { distance }
    });
    let before = d.iter().filter(|d| **d >= 0.0).count();
    (before != 0 && before != 3).then_some(d)
}

/// Where the sides of a triangle cross the plane from which its corners have these distances.
fn crossing(t: &[DVec3; 3], d: &[f64; 3]) -> [DVec3; 2] {
    // The corner that is alone on its side.
    let is_before = d.map(|d| d >= 0.0);
    let alone = (0..3).find(|&i| {
        is_before[i] != is_before[(i + 1) % 3] && is_before[i] != is_before[(i + 2) % 3]
    });
    let i = alone.unwrap_or(0);
    [1, 2].map(|k| {
        let j = (i + k) % 3;
        t[i] + (t[j] - t[i]) * (d[i] / (d[i] - d[j]))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::dvec3;

    /// [`super::penetration`] of triangles about as large as 2.
    fn penetration(a: &[DVec3; 3], b: &[DVec3; 3]) -> Option<[DVec3; 2]> {
        super::penetration(a, b, 2.0 * ROUNDING)
    }

    fn triangle(corners: [[f64; 3]; 3]) -> [DVec3; 3] {
        corners.map(DVec3::from_array)
    }

    #[test]
    fn two_triangles_that_cross_have_the_line_that_both_hold() {
        let floor = triangle([[-2.0, 0.0, -2.0], [2.0, 0.0, -2.0], [0.0, 0.0, 2.0]]);
        let wall = triangle([[-0.5, -1.0, 0.0], [0.5, -1.0, 0.0], [0.0, 1.0, 0.0]]);
        let [mut p, mut q] = penetration(&floor, &wall).unwrap();
        if p.x > q.x {
            std::mem::swap(&mut p, &mut q);
        }
        assert!(
            p.distance(dvec3(-0.25, 0.0, 0.0)) < 1e-6 && q.distance(dvec3(0.25, 0.0, 0.0)) < 1e-6,
            "{p} {q}"
        );
        let same = penetration(&wall, &floor).unwrap();
        assert!(same.iter().all(|r| r.distance(p) < 1e-9 || r.distance(q) < 1e-9), "{same:?}");
    }

    #[test]
    fn triangles_that_touch_or_lie_in_one_plane_have_none() {
        let floor = triangle([[-2.0, 0.0, -2.0], [2.0, 0.0, -2.0], [0.0, 0.0, 2.0]]);
        let moved = |by: DVec3| floor.map(|p| p * 0.5 + by);
        assert_eq!(penetration(&floor, &moved(DVec3::ZERO)), None, "coplanar");
        assert_eq!(penetration(&floor, &moved(DVec3::Y)), None, "parallel");
        let standing = triangle([[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        let pricking = triangle([[0.0, 0.0, 0.0], [0.5, 1.0, 0.0], [-0.5, 1.0, 0.3]]);
        assert_eq!(penetration(&floor, &pricking), None, "a corner on a face");
        let neighbour = [floor[0], floor[1], dvec3(0.0, -1.0, 0.0)];
        assert_eq!(penetration(&floor, &neighbour), None, "neighbours");
        let [a, ..] = floor;
        assert_eq!(
            penetration(&floor, &[a, a + dvec3(1.0, 1.0, 0.1), a + dvec3(0.0, -1.0, -1.0)]),
            None,
            "one corner in common"
        );
        assert_eq!(
            penetration(&floor, &standing.map(|p| p + DVec3::X * 9.0 - DVec3::Y * 0.5)),
            None,
            "beside it"
        );
    }

    #[test]
    fn an_edge_in_a_face_is_a_line_of_one_of_the_triangles_at_it() {
        let floor = triangle([[-2.0, 0.0, -2.0], [2.0, 0.0, -2.0], [0.0, 0.0, 2.0]]);
        let up = triangle([[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        let down = triangle([[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, -1.0, 0.0]]);
        let found = [up, down].map(|t| penetration(&floor, &t).is_some());
        assert_eq!(found.iter().filter(|f| **f).count(), 1, "{found:?}");
    }
}
