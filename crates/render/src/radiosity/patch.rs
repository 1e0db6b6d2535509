//! Patches and elements: the surfaces of a scene, cut into small triangles.
//!
//! A facet is cut in four at the middles of its edges, and its parts again, until no edge is longer than asked for: the
//! *patches*, which send light. Where light changes fast they are cut further, into the *elements*, which receive it. So
//! each facet is the root of a quadtree. Middles of edges are shared by all facets that share the edge, and the trees are
//! kept balanced: across an edge, levels differ by one at most. A leaf whose neighbour is finer has a vertex in the middle
//! of its edge; whoever interpolates cuts it there, so that there are no T-junctions.
//!
//! In:   facets, world space less the scene's middle. Out: the trees.
//! Cost: linear in leaves.
//! Source: \[Cohen & Wallace 1993\], chapter 8; \[Cohen et al. 1988\] for patches and elements.

use std::collections::HashMap;
use vitral_math::DVec3;

/// No node.
pub(super) const NONE: u32 = u32::MAX;

/// A triangle of some size.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    /// Vertices.
    pub corners: [u32; 3],
    /// The first of four children, or `u32::MAX` for a leaf. The k-th of the first three keeps corner k, the fourth is
    /// in the middle.
    pub children: u32,
    /// The facet that it is a part of.
    pub facet: u32,
    /// The patch that it is a part of.
    pub patch: u32,
}

/// See the module.
#[derive(Clone, Debug, Default)]
pub struct Trees {
    /// Places of the vertices.
    pub vertices: Vec<DVec3>,
    /// All nodes, parents before children.
    pub nodes: Vec<Node>,
    /// The root of each facet, `u32::MAX` for those that take no part.
    pub roots: Vec<u32>,
    /// How many patches there are.
    pub patches: u32,
    middles: HashMap<[u32; 2], u32>,
}

impl Trees {
    /// A tree for each of the facets that `corners` gives corners for, with no edge longer than `longest`. `None`: there
    /// would be more than `most` leaves.
    pub fn new(facets: u32, corners: impl Fn(u32) -> Option<[DVec3; 3]>, longest: f64, most: usize) -> Option<Self> {
        let mut trees = Self { roots: vec![NONE; facets as usize], ..Self::default() };
        let mut welded: HashMap<[u64; 3], u32> = HashMap::new();
        for facet in 0..facets {
            let Some(corners) = corners(facet) else { continue };
            let corners = corners.map(|p| {
                // Adding 0 makes -0 to 0.
                let key = (p + 0.0).to_array().map(f64::to_bits);
                *welded.entry(key).or_insert_with(|| {
                    trees.vertices.push(p);
                    trees.vertices.len() as u32 - 1
                })
            });
            trees.roots[facet as usize] = trees.nodes.len() as u32;
            trees.nodes.push(Node { corners, children: NONE, facet, patch: NONE });
        }
        let mut at = 0;
        while at < trees.nodes.len() {
            if trees.longest_edge(at) > longest {
                trees.split(at);
            }
            at += 1;
            if trees.nodes.len() > 2 * most {
                return None;
            }
        }
        trees.balance();
        for at in 0..trees.nodes.len() {
            if trees.nodes[at].children == NONE {
                trees.nodes[at].patch = trees.patches;
                trees.patches += 1;
            }
        }
        Some(trees)
    }

    /// The leaves.
    pub fn leaves(&self) -> Vec<u32> {
        (0..self.nodes.len() as u32).filter(|&n| self.nodes[n as usize].children == NONE).collect()
    }

    /// Places of a node's corners.
    pub fn places(&self, node: u32) -> [DVec3; 3] {
        self.nodes[node as usize].corners.map(|v| self.vertices[v as usize])
    }

    /// The vertex in the middle of each edge (0 to 1, 1 to 2, 2 to 0) of a node, if there is one.
    pub fn middles(&self, node: u32) -> [Option<u32>; 3] {
        let c = self.nodes[node as usize].corners;
        [0, 1, 2].map(|k| self.middle(c[k], c[(k + 1) % 3]))
    }

    fn middle(&self, a: u32, b: u32) -> Option<u32> {
        self.middles.get(&[a.min(b), a.max(b)]).copied()
    }

    fn longest_edge(&self, node: usize) -> f64 {
        let [a, b, c] = self.places(node as u32);
        a.distance(b).max(b.distance(c)).max(c.distance(a))
    }

    /// Cuts a leaf in four.
    pub fn split(&mut self, node: usize) {
        let Node { corners, facet, patch, .. } = self.nodes[node];
        let [m0, m1, m2] = [0, 1, 2].map(|k| self.make_middle(corners[k], corners[(k + 1) % 3]));
        let [a, b, c] = corners;
        self.nodes[node].children = self.nodes.len() as u32;
        for corners in [[a, m0, m2], [m0, b, m1], [m2, m1, c], [m1, m2, m0]] {
            self.nodes.push(Node { corners, children: NONE, facet, patch });
        }
    }

    fn make_middle(&mut self, a: u32, b: u32) -> u32 {
        let (vertices, low, high) = (&mut self.vertices, a.min(b), a.max(b));
        *self.middles.entry([low, high]).or_insert_with(|| {
            vertices.push((vertices[low as usize] + vertices[high as usize]) * 0.5);
            vertices.len() as u32 - 1
        })
    }

    /// Cuts leaves until no edge of a leaf has more than one vertex between its ends.
    pub fn balance(&mut self) {
        let mut waiting = self.leaves();
        while let Some(leaf) = waiting.pop() {
            let node = self.nodes[leaf as usize];
            if node.children != NONE || !self.is_too_coarse(&node) {
                continue;
            }
            self.split(leaf as usize);
            // The new vertices may make neighbours too coarse: look at all leaves again in the end.
            if waiting.is_empty() {
                waiting = self.leaves();
            }
        }
        if self.leaves().iter().any(|&l| self.is_too_coarse(&self.nodes[l as usize])) {
            self.balance();
        }
    }

    fn is_too_coarse(&self, node: &Node) -> bool {
        (0..3).any(|k| {
            let (a, b) = (node.corners[k], node.corners[(k + 1) % 3]);
            self.middle(a, b).is_some_and(|m| self.middle(a, m).is_some() || self.middle(m, b).is_some())
        })
    }

    /// The leaf at a point of the tree from `root` on. The weights of the root's corners there, and how they change along
    /// some line, come in, those of the leaf's go out; all may be times any positive number.
    pub fn leaf_along(&self, root: u32, mut weights: [f64; 3], mut slopes: [f64; 3]) -> (u32, [f64; 3], [f64; 3]) {
        let mut at = root;
        while self.nodes[at as usize].children != NONE {
            let half = 0.5 * (weights[0] + weights[1] + weights[2]);
            let child = (0..3).find(|&k| weights[k] >= half).unwrap_or(3);
            for values in [&mut weights, &mut slopes] {
                let [a, b, c] = *values;
                let sum = a + b + c;
                *values = match child {
                    3 => [sum - 2.0 * a, sum - 2.0 * b, sum - 2.0 * c],
                    _ => [2.0 * a, 2.0 * b, 2.0 * c],
                };
                if child < 3 {
                    values[child] -= sum;
                }
            }
            at = self.nodes[at as usize].children + child as u32;
        }
        (at, weights, slopes)
    }
}

/// Which child holds the point with these weights, and its weights there.
pub(super) fn descend(w: [f32; 3]) -> (u32, [f32; 3]) {
    match (0..3).find(|&k| w[k] >= 0.5) {
        Some(k) => {
            let mut inside = w.map(|w| 2.0 * w);
            inside[k] -= 1.0;
            (k as u32, inside)
        }
        None => (3, w.map(|w| 1.0 - 2.0 * w)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::dvec3;

    /// Two triangles of a square.
    fn square(longest: f64) -> Trees {
        let p = [DVec3::ZERO, DVec3::X, dvec3(1.0, 1.0, 0.0), DVec3::Y];
        let corners = move |f: u32| Some(if f == 0 { [p[0], p[1], p[2]] } else { [p[0], p[2], p[3]] });
        Trees::new(2, corners, longest, 1 << 20).unwrap()
    }

    fn area(trees: &Trees, node: u32) -> f64 {
        let [a, b, c] = trees.places(node);
        0.5 * (b - a).cross(c - a).length()
    }

    #[test]
    fn patches_are_as_small_as_asked_for_and_share_their_vertices() {
        let trees = square(0.4);
        // The diagonal of 1.41 is halved twice.
        assert_eq!((trees.leaves().len(), trees.patches), (32, 32));
        assert_eq!(trees.vertices.len(), 25);
        let sum: f64 = trees.leaves().iter().map(|&l| area(&trees, l)).sum();
        assert!((sum - 1.0).abs() < 1e-12);
        assert!(Trees::new(2, |_| Some([DVec3::ZERO, DVec3::X, DVec3::Y]), 1e-4, 1000).is_none());
    }

    #[test]
    fn trees_stay_balanced_across_facets() {
        let mut trees = square(2.0);
        // Cut towards the middle of the diagonal, four levels deep, in the first facet alone.
        let mut at = 0;
        for _ in 0..4 {
            trees.split(at);
            at = trees.nodes[at].children as usize + 2;
        }
        trees.balance();
        assert!(trees.leaves().iter().all(|&l| !trees.is_too_coarse(&trees.nodes[l as usize])));
        assert!(trees.nodes[1].children != NONE, "the neighbour was cut too");
        let sum: f64 = trees.leaves().iter().map(|&l| area(&trees, l)).sum();
        assert!((sum - 1.0).abs() < 1e-12);
    }

    #[test]
    fn points_are_found_in_their_leaf() {
        let mut trees = square(0.8);
        trees.split(trees.leaves()[3] as usize);
        for i in 0..200u32 {
            let (u, v) = (f64::from(i % 14) / 14.0 + 0.01, f64::from(i / 14) / 15.0 + 0.02);
            let w = if u + v < 1.0 { [u, v, 1.0 - u - v] } else { [1.0 - u, 1.0 - v, u + v - 1.0] };
            // Any scale will do.
            let (w, step) = (w.map(|w| 3.0 * w), [0.2, -0.3, 0.1]);
            let (leaf, inside, along) = trees.leaf_along(trees.roots[i as usize % 2], w, step);
            let place = |corners: [DVec3; 3], w: [f64; 3]| {
                (corners[0] * w[0] + corners[1] * w[1] + corners[2] * w[2]) / w.iter().sum::<f64>()
            };
            let root = trees.places(trees.roots[i as usize % 2]);
            let ahead = |w: [f64; 3], step: [f64; 3]| [0, 1, 2].map(|k| w[k] + 0.7 * step[k]);
            assert!(place(trees.places(leaf), inside).abs_diff_eq(place(root, w), 1e-12));
            assert!(place(trees.places(leaf), ahead(inside, along)).abs_diff_eq(place(root, ahead(w, step)), 1e-12));
            assert!(inside.iter().all(|w| *w > -1e-12));
        }
    }
}
