//! Convex polygons in space, what solids leave of them, and the tree that leads to what is left.

use crate::shadow::casters::{Solid, box_around};
use vitral_math::DVec3;

/// Solids up to which a part is not divided: they are clipped one by one.
const MAX_CLIPPED: usize = 6;
/// Cuts above a part.
const DEEPEST: u32 = 40;
/// Cuts in a row that may leave more than three quarters of the solids to a part. Where solids meet
/// in a line, cutting goes on and on along it and separates none: they are clipped one by one, too.
const MAX_VAIN_CUTS: u32 = 6;

/// A part of a facet.
#[derive(Clone, Copy, Debug)]
enum Node {
    /// Cut across an axis: what is below, what is not.
    Cut { axis: u8, at: f64, children: [u32; 2] },
    /// Lit polygons from the first to before the last.
    Lit([u32; 2]),
}

/// Lit polygons of several facets.
#[derive(Debug, Default)]
pub(super) struct Detail {
    nodes: Vec<Node>,
    /// Where each polygon ends among the corners, and the normal of its plane.
    polygons: Vec<(u32, DVec3)>,
    corners: Vec<DVec3>,
}

impl Detail {
    /// A facet without a lit polygon.
    pub(super) fn dark(&mut self) -> u32 {
        self.lit(DVec3::ZERO, &[])
    }

    fn lit(&mut self, normal: DVec3, polygons: &[Vec<DVec3>]) -> u32 {
        let first = self.polygons.len() as u32;
        for polygon in polygons {
            self.corners.extend_from_slice(polygon);
            self.polygons.push((self.corners.len() as u32, normal));
        }
        self.nodes.push(Node::Lit([first, self.polygons.len() as u32]));
        self.nodes.len() as u32 - 1
    }

    fn polygon(&self, number: u32) -> (&[DVec3], DVec3) {
        let n = number as usize;
        let first = if n == 0 { 0 } else { self.polygons[n - 1].0 as usize };
        (&self.corners[first..self.polygons[n].0 as usize], self.polygons[n].1)
    }

    /// Whether a place in the plane of the facet with this root lies in a lit polygon, or beside
    /// one by no more than `slack`.
    pub(super) fn lights(&self, root: u32, place: DVec3, slack: f64) -> bool {
        // Descend to the leaf that holds the place, and test its polygons.
        let mut node = root;
        loop {
            match &self.nodes[node as usize] {
                Node::Cut { axis, at, children } => {
                    node = children[usize::from(place[usize::from(*axis)] >= *at)];
                }
                Node::Lit([first, end]) => {
                    return (*first..*end).any(|n| {
                        let (corners, normal) = self.polygon(n);
                        let next = |i: usize| corners[(i + 1) % corners.len()];
                        corners.iter().enumerate().all(|(i, &a)| {
                            let inwards = normal.cross(next(i) - a);
                            inwards.dot(place - a) >= -slack * inwards.length()
                        })
                    });
                }
            }
        }
    }

    /// Calls `found` with the corners of the lit polygons of a facet.
    pub(super) fn each(&self, root: u32, found: &mut dyn FnMut(&[DVec3])) {
        match &self.nodes[root as usize] {
            Node::Cut { children, .. } => {
                children.iter().for_each(|&child| self.each(child, found))
            }
            Node::Lit([first, end]) => (*first..*end).for_each(|n| found(self.polygon(n).0)),
        }
    }

    pub(super) fn bytes(&self) -> u64 {
        let nodes = self.nodes.capacity() * size_of::<Node>()
            + self.polygons.capacity() * size_of::<(u32, DVec3)>();
        (nodes + self.corners.capacity() * size_of::<DVec3>()) as u64
    }
}

/// The cuts above a part.
#[derive(Clone, Copy, Debug)]
struct Cuts {
    depth: u32,
    /// Solids of the last part that had a quarter less than such a part before it.
    last: usize,
    /// Cuts since then.
    in_vain: u32,
}

/// Clips one facet.
pub(super) struct Cutter<'a> {
    pub(super) detail: &'a mut Detail,
    /// Unit normal: its corners run round it anticlockwise, or will.
    pub(super) normal: DVec3,
    /// What is nearer to a plane than this lies in it.
    pub(super) eps: f64,
    /// What is taken away; their normals have unit length.
    pub(super) solids: &'a [Solid],
}

/// What a solid leaves of a polygon.
#[derive(Debug, PartialEq)]
enum Left {
    /// It does not reach it.
    All,
    /// It covers it.
    Nothing,
    Several(Vec<Vec<DVec3>>),
}

impl Cutter<'_> {
    /// Adds the facet with these corners, less the solids; gives its root.
    pub(super) fn add(&mut self, mut corners: Vec<DVec3>) -> u32 {
        let winding = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        if winding.dot(self.normal) < 0.0 {
            corners.reverse();
        }
        let solids: Vec<_> = (0..self.solids.len() as u32).collect();
        self.part(corners, &solids, Cuts { depth: 0, last: usize::MAX, in_vain: 0 })
    }

    /// Adds a part of it, which these solids may reach.
    fn part(&mut self, polygon: Vec<DVec3>, solids: &[u32], mut cuts: Cuts) -> u32 {
        // Keep the solids that reach the part; stop dividing when there are few or when cuts do not
        // help.
        let Some(solids) = self.reaching(&polygon, solids) else { return self.detail.dark() };
        if solids.len() <= cuts.last / 4 * 3 {
            (cuts.last, cuts.in_vain) = (solids.len(), 0);
        } else {
            cuts.in_vain += 1;
        }
        if solids.len() <= MAX_CLIPPED || cuts.depth == DEEPEST || cuts.in_vain > MAX_VAIN_CUTS {
            return self.clip(polygon, &solids);
        }
        cuts.depth += 1;

        // Cut it in the middle of its longest side.
        let (middle, half) = box_around(polygon.iter().copied(), 0.0);
        let axis = (1..3).fold(0, |k, other| if half[other] > half[k] { other } else { k });
        let [below, above] = split(&polygon, |p| middle[axis] - p[axis], self.eps);
        if below.len() < 3 || above.len() < 3 {
            return self.clip(polygon, &solids);
        }

        // Recurse into both halves.
        let lower = self.part(below, &solids, cuts);
        let upper = self.part(above, &solids, cuts);
        // Nothing to tell apart: two dark halves are a dark whole.
        let empty = |node: &Node| matches!(node, Node::Lit([first, end]) if first == end);
        if [lower, upper].iter().all(|&n| empty(&self.detail.nodes[n as usize])) {
            return lower;
        }
        self.detail.nodes.push(Node::Cut {
            axis: axis as u8,
            at: middle[axis],
            children: [lower, upper],
        });
        self.detail.nodes.len() as u32 - 1
    }

    /// Those of the solids that reach a polygon; `None` if one covers it.
    fn reaching(&self, polygon: &[DVec3], solids: &[u32]) -> Option<Vec<u32>> {
        let mut reaching = Vec::with_capacity(solids.len());
        for &solid in solids {
            match reach(polygon, &self.solids[solid as usize], self.eps) {
                Reach::None => {}
                Reach::Some => reaching.push(solid),
                Reach::Covers => return None,
            }
        }
        Some(reaching)
    }

    /// Takes the solids away one by one.
    fn clip(&mut self, polygon: Vec<DVec3>, solids: &[u32]) -> u32 {
        let mut left = vec![polygon];
        for &solid in solids {
            let mut next = Vec::with_capacity(left.len());
            for polygon in left {
                match less(&polygon, &self.solids[solid as usize], self.eps) {
                    Left::All => next.push(polygon),
                    Left::Nothing => {}
                    Left::Several(parts) => next.extend(parts),
                }
            }
            left = next;
        }
        self.detail.lit(self.normal, &left)
    }
}

/// How much of a polygon a solid reaches.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Reach {
    /// The solid does not touch the polygon.
    None,
    /// It touches a part of it.
    Some,
    /// It holds all of it.
    Covers,
}

/// Distance inside a plane.
fn inside(plane: &(DVec3, DVec3), p: DVec3) -> f64 {
    plane.0.dot(p - plane.1)
}

fn reach(polygon: &[DVec3], solid: &Solid, eps: f64) -> Reach {
    let mut covers = true;
    for plane in &solid.planes {
        let (mut some, mut all) = (false, true);
        for &p in polygon {
            let d = inside(plane, p);
            some |= d > eps;
            all &= d >= -eps;
        }
        if !some {
            return Reach::None;
        }
        covers &= all;
    }
    if covers { Reach::Covers } else { Reach::Some }
}

/// The parts of a convex polygon where a linear function is not negative, and where it is not
/// positive; a part without inner points has fewer than three corners.
fn split(polygon: &[DVec3], value: impl Fn(DVec3) -> f64, eps: f64) -> [Vec<DVec3>; 2] {
    let mut parts = [Vec::with_capacity(polygon.len() + 1), Vec::with_capacity(polygon.len() + 1)];
    let mut reached = [false; 2];

    // Distribute the corners, and add crossings to both parts.
    for (i, &p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        let (a, b) = (value(p), value(q));
        if a >= -eps {
            parts[0].push(p);
            reached[0] |= a > eps;
        }
        if a <= eps {
            parts[1].push(p);
            reached[1] |= a < -eps;
        }
        if (a > eps && b < -eps) || (a < -eps && b > eps) {
            let crossing = p + (q - p) * (a / (a - b));
            parts.iter_mut().for_each(|part| part.push(crossing));
        }
    }

    // Drop parts that reach nowhere beyond the tolerance.
    for (part, reached) in parts.iter_mut().zip(reached) {
        if !reached {
            part.clear();
        }
    }
    parts
}

/// What is left of a polygon outside a solid.
fn less(polygon: &[DVec3], solid: &Solid, eps: f64) -> Left {
    let mut inner = polygon.to_vec();
    let mut outer = Vec::new();
    for plane in &solid.planes {
        let [within, beyond] = split(&inner, |p| inside(plane, p), eps);
        if within.len() < 3 {
            return Left::All;
        }
        if beyond.len() >= 3 {
            outer.push(beyond);
        }
        inner = within;
    }
    if outer.is_empty() { Left::Nothing } else { Left::Several(outer) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::{DVec4, dvec3, func};

    fn area(polygon: &[DVec3]) -> f64 {
        let doubled: DVec3 = (2..polygon.len())
            .map(|i| (polygon[i - 1] - polygon[0]).cross(polygon[i] - polygon[0]))
            .sum();
        doubled.length() / 2.0
    }

    #[test]
    fn f22_lit_polygons_make_up_for_the_shadow() {
        // Many small triangles at height 1, under a lamp at height 2.
        let mut state = 7u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24)
        };
        let cell = |i: i32, k: i32| [f64::from(i) * 0.25 - 1.0, f64::from(k) * 0.25 - 1.0];
        let mut solids = Vec::new();
        let mut shadow = 0.0;
        for (i, k) in (0..8).flat_map(|i| (0..8).map(move |k| (i, k))) {
            let [x, z] = cell(i, k);
            let mut corner = || dvec3(x + next() * 0.25, 1.0, z + next() * 0.25);
            let corners = [corner(), corner(), corner()];
            if let Some(solid) = Solid::new(&corners, DVec4::new(0.0, 2.0, 0.0, 1.0), 1e-9) {
                shadow += area(&corners) * 4.0;
                solids.push(Solid { planes: solid.planes.map(|(n, at)| (n.normalize(), at)) });
            }
        }
        let mut detail = Detail::default();
        let floor = vec![
            dvec3(-3.0, 0.0, -3.0),
            dvec3(-3.0, 0.0, 3.0),
            dvec3(3.0, 0.0, 3.0),
            dvec3(3.0, 0.0, -3.0),
        ];
        let root = Cutter { detail: &mut detail, normal: DVec3::Y, eps: 1e-13, solids: &solids }
            .add(floor);
        let mut lit = 0.0;
        detail.each(root, &mut |corners| lit += area(corners));
        assert!((lit + shadow - 36.0).abs() < 1e-9, "{lit} and {shadow}");
        for _ in 0..2000 {
            let p = dvec3(next() * 6.0 - 3.0, 0.0, next() * 6.0 - 3.0);
            assert_eq!(detail.lights(root, p, 1e-12), !solids.iter().any(|s| s.contains(p)), "{p}");
        }
    }

    #[test]
    fn solids_that_meet_in_a_line_are_not_cut_apart() {
        // Light falls along a wall, all but; on its upper edge lies a fan, whose wedges meet above
        // a corner of the wall.
        let light = DVec4::new(0.0, 1.0, 0.0, 0.0);
        let rim = |k: i32| {
            let angle = std::f64::consts::PI * f64::from(k) / 64.0;
            dvec3(func::cos(angle), 1.0, -func::sin(angle))
        };
        let wedges = (0..64)
            .filter_map(|k| Solid::new(&[dvec3(0.0, 1.0, 0.0), rim(k), rim(k + 1)], light, 1e-9));
        let solids: Vec<_> = wedges
            .map(|solid| Solid { planes: solid.planes.map(|(n, at)| (n.normalize(), at)) })
            .collect();
        assert_eq!(solids.len(), 64);
        let mut detail = Detail::default();
        let wall = [
            dvec3(0.0, 0.0, -1e-6),
            dvec3(0.0, 1.0, 0.0),
            dvec3(1.0, 1.0, 0.0),
            dvec3(1.0, 0.0, -1e-6),
        ];
        let normal = (wall[1] - wall[0]).cross(wall[2] - wall[0]).normalize();
        let mut cutter = Cutter { detail: &mut detail, normal, eps: 1e-13, solids: &solids };
        cutter.add(wall[..3].to_vec());
        cutter.add(vec![wall[0], wall[2], wall[3]]);
        assert!(detail.nodes.len() < 1000, "{} parts", detail.nodes.len());
        assert!(detail.polygons.len() < 10_000, "{} polygons", detail.polygons.len());
    }

    #[test]
    fn what_only_touches_leaves_all() {
        let square = [
            dvec3(0.0, 0.0, 0.0),
            dvec3(1.0, 0.0, 0.0),
            dvec3(1.0, 1.0, 0.0),
            dvec3(0.0, 1.0, 0.0),
        ];
        let [left, right] = split(&square, |p| -p.x, 1e-12);
        assert!(left.is_empty() && right == square);
        let sun = DVec4::new(0.0, 0.0, 1.0, 0.0);
        let beside = [dvec3(1.0, 0.0, 1.0), dvec3(2.0, 0.0, 1.0), dvec3(1.0, 1.0, 1.0)];
        assert_eq!(less(&square, &Solid::new(&beside, sun, 1e-9).unwrap(), 1e-12), Left::All);
        let over = [dvec3(-9.0, -9.0, 1.0), dvec3(9.0, -9.0, 1.0), dvec3(0.0, 9.0, 1.0)];
        assert_eq!(less(&square, &Solid::new(&over, sun, 1e-9).unwrap(), 1e-12), Left::Nothing);
        assert_eq!(reach(&square, &Solid::new(&over, sun, 1e-9).unwrap(), 1e-12), Reach::Covers);
    }
}
