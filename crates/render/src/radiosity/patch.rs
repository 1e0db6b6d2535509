//! Patches and elements: the surfaces of a scene, cut into small triangles.
//!
//! A facet is cut in four at the middles of its edges, and its parts again, until no edge is longer
//! than asked for: the *patches*, which send light. Where fewer patches come of it, the edges of
//! all facets are first cut in three. Where light changes fast patches are cut further, into the
//! *elements*, which receive it. So each facet is a small grid of quadtrees. Vertices on edges are
//! shared by all facets that share the edge, and the trees are kept balanced: across an edge,
//! levels differ by one at most. A leaf whose neighbour is finer has a vertex in the middle of its
//! edge; whoever interpolates cuts it there, so that there are no T-junctions. Facets much smaller
//! than a patch are patches in groups: those in one cell of a grid that face one axis.
//!
//! In:   facets, world space less the scene's middle. Out: the trees.
//! Cost: linear in leaves.
//! Source: \[Cohen & Wallace 1993\], chapter 8; \[Cohen et al. 1988\] for patches and elements.

use super::walls::WallPieces;
use std::collections::{BTreeMap, HashMap};
use vitral_math::DVec3;

/// No node.
pub(super) const NONE: u32 = u32::MAX;
/// In how many parts the edges of facets may be cut before they are halved: sizes half-way between
/// those of halving.
const CUTS: [u32; 2] = [1, MOST_CUTS];
/// Most of these parts.
pub(super) const MOST_CUTS: u32 = 3;

/// Leaves whose longest edge is less than this part of the longest of patches may be a patch
/// together with others.
const SMALL: f64 = 0.5;
/// So many patches of several leaves at most: each looks at the whole scene from either side.
const MOST_GROUPS: usize = 2048;
/// By how much coarser the grid becomes where there are more.
const COARSER: f64 = 1.25;

/// A triangle of some size.
#[derive(Clone, Copy, Debug)]
pub struct QuadtreeNode {
    /// Vertices.
    pub corners: [u32; 3],
    /// The first of four children, or `u32::MAX` for a leaf. The k-th of the first three keeps
    /// corner k, the fourth is in the middle.
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
    pub nodes: Vec<QuadtreeNode>,
    /// The first root of each facet, `u32::MAX` for those that take no part. Its other roots
    /// follow: rows from corner 0 on, each from corner 2 to corner 1, every second one upside down.
    pub roots: Vec<u32>,
    /// Parts of each facet's edges before quadtrees begin, at least 1.
    pub cuts: u32,
    /// How many patches there are.
    pub patches: u32,
    /// Those of them, the first, that are groups of small facets.
    pub(super) groups: u32,
    /// How far around small facets tell about each other's light.
    pub(super) reach: f64,
    /// Facets that walls cut, in pieces: these have trees in place of the facets.
    pub(super) pieces: WallPieces,
    /// How many facets there are, without pieces.
    pub(super) facets: u32,
    middles: HashMap<[u32; 2], u32>,
}

impl Trees {
    /// Trees for each of the facets that `corners` gives corners for, with no edge longer than
    /// `longest`. `None`: there would be more than `most` leaves.
    pub fn new(
        facets: u32,
        corners: impl Fn(u32) -> Option<[DVec3; 3]>,
        longest: f64,
        most: usize,
    ) -> Option<Self> {
        Self::with_pieces(facets, corners, WallPieces::default(), longest, most)
    }

    /// The same, where some facets are cut in pieces.
    pub(super) fn with_pieces(
        count: u32,
        corners: impl Fn(u32) -> Option<[DVec3; 3]>,
        pieces: WallPieces,
        longest: f64,
        most: usize,
    ) -> Option<Self> {
        // Pieces come behind all facets, in place of their own.
        let mut is_cut = vec![false; count as usize];
        pieces.facets.iter().for_each(|&f| is_cut[f as usize] = true);
        let (facets, own) = (count + pieces.facets.len() as u32, pieces.corners.clone());
        let corners = |f: u32| match f.checked_sub(count) {
            Some(piece) => Some(own[piece as usize]),
            None if is_cut[f as usize] => None,
            None => corners(f),
        };

        let lengths: Vec<f64> =
            (0..facets).filter_map(|f| Some(longest_edge(corners(f)?))).collect();
        let leaves =
            |cuts: u32| lengths.iter().map(|length| leaves(length / longest, cuts)).sum::<f64>();
        let cuts = CUTS
            .into_iter()
            .fold(CUTS[0], |best, cuts| if leaves(cuts) < leaves(best) { cuts } else { best });
        if leaves(cuts) > most as f64 {
            return None;
        }
        let mut trees = Self {
            roots: vec![NONE; facets as usize],
            cuts,
            pieces,
            facets: count,
            ..Self::default()
        };
        trees.plant_all(facets, corners);
        trees.split_longer(longest, most)?;
        trees.balance();
        trees.number_patches(longest);
        Some(trees)
    }

    /// Makes the roots of all facets; facets with a corner at one place share its vertex.
    fn plant_all(&mut self, facets: u32, corners: impl Fn(u32) -> Option<[DVec3; 3]>) {
        let mut welded: HashMap<([u64; 3], u32), u32> = HashMap::new();
        let mut edges: HashMap<[u32; 2], u32> = HashMap::new();
        for facet in 0..facets {
            let Some(corners) = corners(facet) else { continue };
            let corners = [0, 1, 2u8].map(|k| {
                let p = corners[usize::from(k)];
                // Adding 0 makes -0 to 0.
                let key = ((p + 0.0).to_array().map(f64::to_bits), self.pieces.side(facet, k));
                *welded.entry(key).or_insert_with(|| {
                    self.vertices.push(p);
                    self.vertices.len() as u32 - 1
                })
            });
            self.roots[facet as usize] = self.nodes.len() as u32;
            self.plant(facet, corners, &mut edges);
        }
    }

    /// Cuts nodes until no edge is longer than `longest`. `None`: there would be more than `most`
    /// leaves.
    fn split_longer(&mut self, longest: f64, most: usize) -> Option<()> {
        let mut at = 0;
        while at < self.nodes.len() {
            if longest_edge(self.places(at as u32)) > longest * (1.0 + ROUNDING) {
                self.split(at);
            }
            at += 1;
            if self.nodes.len() > 2 * most {
                return None;
            }
        }
        Some(())
    }

    /// Makes each leaf a patch. Facets much smaller than `longest` that lie together and face about
    /// the same way are one.
    fn number_patches(&mut self, longest: f64) {
        // Find leaves that are small as against a patch, and how coarse a grid leaves few groups of
        // them. Pieces of one facet may be on two sides of a wall.
        let whole = &self.roots[..self.facets as usize];
        let roots = whole
            .iter()
            .filter(|&&root| root != NONE)
            .flat_map(|&root| root..root + self.cuts * self.cuts);
        let is_leaf = |n: &u32| self.nodes[*n as usize].children == NONE;
        let is_small = |n: &u32| longest_edge(self.places(*n)) < SMALL * longest;
        let small: Vec<u32> = roots.filter(is_leaf).filter(is_small).collect();
        let mut size = longest;
        let mut groups = self.groups(&small, size);
        while groups.len() > MOST_GROUPS && size < 1e9 * longest {
            size *= COARSER;
            groups = self.groups(&small, size);
        }

        // Number the groups, and then the other leaves.
        (self.groups, self.reach) = (groups.len() as u32, 0.5 * size);
        for members in groups.into_values() {
            members.into_iter().for_each(|n| self.nodes[n as usize].patch = self.patches);
            self.patches += 1;
        }
        for node in self.nodes.iter_mut().filter(|node| node.children == NONE && node.patch == NONE)
        {
            node.patch = self.patches;
            self.patches += 1;
        }
    }

    /// Leaves by the cell of a grid that they are in, and the axis that they face.
    fn groups(&self, leaves: &[u32], size: f64) -> BTreeMap<([i64; 3], u8), Vec<u32>> {
        let mut groups: BTreeMap<([i64; 3], u8), Vec<u32>> = BTreeMap::new();
        for &leaf in leaves {
            let [a, b, c] = self.places(leaf);
            let (middle, normal) = ((a + b + c) / 3.0, (b - a).cross(c - a).to_array());
            let axis = (0..3)
                .fold(0, |most, k| if normal[k].abs() > normal[most].abs() { k } else { most });
            let faces = 2 * axis as u8 + u8::from(normal[axis] < 0.0);
            let cell = (middle / size).floor().to_array().map(|c| c as i64);
            groups.entry((cell, faces)).or_default().push(leaf);
        }
        groups
    }

    /// The facet of the scene to which a facet of these trees belongs, itself or as a piece.
    pub fn facet_of_piece(&self, facet: u32) -> u32 {
        facet.checked_sub(self.facets).map_or(facet, |piece| self.pieces.facets[piece as usize])
    }

    /// The nodes without children, in the order of the tree.
    pub fn leaves(&self) -> Vec<u32> {
        (0..self.nodes.len() as u32).filter(|&n| self.nodes[n as usize].children == NONE).collect()
    }

    /// The roots of a facet that takes part.
    pub(super) fn roots_of(&self, facet: u32) -> std::ops::Range<u32> {
        let first = self.roots[facet as usize];
        first..first + self.cuts * self.cuts
    }

    /// Places of the corners of a facet that takes part.
    pub(super) fn corners_of(&self, facet: u32) -> [DVec3; 3] {
        [0, 1, 2].map(|k| {
            let mut steps = [0; 3];
            steps[k] = self.cuts - 1;
            let root = self.roots[facet as usize] + Cell { steps, upright: true }.number(self.cuts);
            self.places(root)[k]
        })
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

    /// Makes a facet's roots; `edges` has the first of the vertices that cut an edge, from its
    /// lower end on.
    fn plant(&mut self, facet: u32, corners: [u32; 3], edges: &mut HashMap<[u32; 2], u32>) {
        // Make each vertex once: a corner, one on an edge shared with neighbours, or one inside.
        let n = self.cuts;
        let mut vertices: HashMap<[u32; 3], u32> = HashMap::new();
        let mut vertex = |trees: &mut Self, steps: [u32; 3]| {
            let on = (0..3).filter(|&k| steps[k] > 0).map(|k| (corners[k], steps[k]));
            let mut on: Vec<(u32, u32)> = on.collect();
            on.sort_unstable();
            match on[..] {
                [(corner, _)] => corner,
                [(low, _), (high, along)] => {
                    let first = *edges.entry([low, high]).or_insert_with(|| {
                        let [a, b] = [low, high].map(|v| trees.vertices[v as usize]);
                        trees
                            .vertices
                            .extend((1..n).map(|i| a.lerp(b, f64::from(i) / f64::from(n))));
                        trees.vertices.len() as u32 - (n - 1)
                    });
                    first + along - 1
                }
                _ => *vertices.entry(steps).or_insert_with(|| {
                    let parts =
                        (0..3).map(|k| trees.vertices[corners[k] as usize] * f64::from(steps[k]));
                    let sum: DVec3 = parts.sum();
                    trees.vertices.push(sum / f64::from(n));
                    trees.vertices.len() as u32 - 1
                }),
            }
        };

        // Make the cells.
        for number in 0..n * n {
            let corners = Cell::numbered(number, n).corners().map(|steps| vertex(self, steps));
            self.nodes.push(QuadtreeNode { corners, children: NONE, facet, patch: NONE });
        }
    }

    /// Cuts a leaf in four.
    pub fn split(&mut self, node: usize) {
        let QuadtreeNode { corners, facet, patch, .. } = self.nodes[node];
        let [m0, m1, m2] = [0, 1, 2].map(|k| self.make_middle(corners[k], corners[(k + 1) % 3]));
        let [a, b, c] = corners;
        self.nodes[node].children = self.nodes.len() as u32;
        for corners in [[a, m0, m2], [m0, b, m1], [m2, m1, c], [m1, m2, m0]] {
            self.nodes.push(QuadtreeNode { corners, children: NONE, facet, patch });
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

    fn is_too_coarse(&self, node: &QuadtreeNode) -> bool {
        (0..3).any(|k| {
            let (a, b) = (node.corners[k], node.corners[(k + 1) % 3]);
            self.middle(a, b)
                .is_some_and(|m| self.middle(a, m).is_some() || self.middle(m, b).is_some())
        })
    }

    /// The leaf at a point of the tree from `node` on. The weights of the node's corners there, and
    /// how they change along some line, come in, those of the leaf's go out; all may be times any
    /// positive number.
    pub fn leaf_along(
        &self,
        node: u32,
        mut weights: [f64; 3],
        mut slopes: [f64; 3],
    ) -> (u32, [f64; 3], [f64; 3]) {
        let mut at = node;
        while self.nodes[at as usize].children != NONE {
            // Find the child: at a corner if its weight is at least half, else the middle one.
            let half = 0.5 * (weights[0] + weights[1] + weights[2]);
            let child = (0..3).find(|&k| weights[k] >= half).unwrap_or(3);

            // Convert the weights to the child's corners.
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

/// What lengths may be too long by, as a part: that of rounding.
const ROUNDING: f64 = 1e-12;

pub(super) fn longest_edge([a, b, c]: [DVec3; 3]) -> f64 {
    a.distance(b).max(b.distance(c)).max(c.distance(a))
}

/// A triangle's.
pub(super) fn area([a, b, c]: [DVec3; 3]) -> f64 {
    0.5 * (b - a).cross(c - a).length()
}

/// Leaves of a facet whose longest edge is this many times the longest that is wanted.
fn leaves(length: f64, cuts: u32) -> f64 {
    let mut pieces = f64::from(cuts);
    while length > pieces * (1.0 + ROUNDING) && pieces < 1e9 {
        pieces *= 2.0;
    }
    pieces * pieces
}

/// A cell of a triangle whose edges are cut in `n` parts: upright as the triangle, or upside down
/// between others. Corner k of a cell upside down lies opposite to where corner k of an upright one
/// is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cell {
    /// Of the n-ths of the weights in the cell, the whole numbers; their sum is `n - 1`, or `n - 2`
    /// upside down.
    pub steps: [u32; 3],
    pub upright: bool,
}

impl Cell {
    /// Where the cell comes: rows from corner 0 on, each from corner 2 to corner 1.
    pub(super) fn number(&self, n: u32) -> u32 {
        let row = n - 1 - self.steps[0];
        row * row + 2 * self.steps[1] + u32::from(!self.upright)
    }

    /// The cell of this number.
    pub(super) fn numbered(number: u32, n: u32) -> Self {
        let row = number.isqrt();
        let along = number - row * row;
        let (j, upright) = (along / 2, along.is_multiple_of(2));
        Self { steps: [n - 1 - row, j, row - j - u32::from(!upright)], upright }
    }

    /// The cell at the point whose weights are these n-ths; outside the triangle some cell near it.
    #[inline]
    pub(super) fn at(weights: [f64; 3], n: u32) -> Self {
        // Casts take what is below 0 to 0.
        let i = (weights[0] as u32).min(n - 1);
        let j = (weights[1] as u32).min(n - 1 - i);
        let k = n - 1 - i - j;
        let upright = k == 0 || weights[2] >= f64::from(k);
        Self { steps: [i, j, k - u32::from(!upright)], upright }
    }

    /// Weights within the cell of a point with these weights in the triangle, both times the same
    /// number.
    #[inline]
    pub(super) fn inside(&self, weights: [f64; 3], n: u32) -> [f64; 3] {
        let sum = weights[0] + weights[1] + weights[2];
        [0, 1, 2].map(|k| {
            let (w, steps) = (f64::from(n) * weights[k], f64::from(self.steps[k]));
            if self.upright { w - steps * sum } else { (steps + 1.0) * sum - w }
        })
    }

    /// The child of this number, where edges are cut in twice as many parts.
    pub(super) fn child(&self, child: usize) -> Self {
        let steps = [0, 1, 2].map(|k| 2 * self.steps[k] + u32::from(self.upright == (child == k)));
        Self { steps, upright: self.upright == (child != 3) }
    }

    /// The n-ths of the triangle's corners in each corner.
    fn corners(&self) -> [[u32; 3]; 3] {
        [0, 1, 2].map(|corner| {
            [0, 1, 2].map(|k| self.steps[k] + u32::from(self.upright == (k == corner)))
        })
    }
}

/// Which of a facet's roots holds the point with these weights, and its weights there.
pub(super) fn within(w: [f32; 3], cuts: u32) -> (u32, [f32; 3]) {
    if cuts == 1 {
        return (0, w);
    }
    let weights = w.map(f64::from);
    let cell = Cell::at(weights.map(|w| w * f64::from(cuts)), cuts);
    (cell.number(cuts), cell.inside(weights, cuts).map(|w| w as f32))
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
        let corners =
            move |f: u32| Some(if f == 0 { [p[0], p[1], p[2]] } else { [p[0], p[2], p[3]] });
        Trees::new(2, corners, longest, 1 << 20).unwrap()
    }

    #[test]
    fn patches_are_as_small_as_asked_for_and_share_their_vertices() {
        let trees = square(0.4);
        // The diagonal of 1.41 is halved twice.
        assert_eq!((trees.leaves().len(), trees.patches), (32, 32));
        assert_eq!(trees.vertices.len(), 25);
        let sum: f64 = trees.leaves().iter().map(|&l| area(trees.places(l))).sum();
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
        let sum: f64 = trees.leaves().iter().map(|&l| area(trees.places(l))).sum();
        assert!((sum - 1.0).abs() < 1e-12);
    }

    #[test]
    fn facets_are_cut_in_three_where_fewer_patches_come_of_it() {
        // The diagonal of 1.41 in three parts, not in four.
        let trees = square(0.5);
        assert_eq!((trees.cuts, trees.leaves().len(), trees.patches), (3, 18, 18));
        assert_eq!(trees.vertices.len(), 16, "those on the diagonal belong to both facets");
        for leaf in trees.leaves() {
            let [a, b, c] = trees.places(leaf);
            assert!(
                ((b - a).cross(c - a).z - 1.0 / 9.0).abs() < 1e-12,
                "all of one size, and turned alike"
            );
        }
        assert_eq!(square(0.25).leaves().len(), 72, "in three parts and these in two");
        assert_eq!(square(2.0).cuts, 1);
        for i in 0..60 {
            let w = [i as f32 / 60.0 + 0.003, (59 - i) as f32 / 120.0 + 0.001];
            let w = [w[0], w[1], 1.0 - w[0] - w[1]];
            let (root, inside) = within(w, 3);
            let place = |corners: [DVec3; 3], w: [f32; 3]| {
                (0..3).map(|k| corners[k] * f64::from(w[k])).sum::<DVec3>()
            };
            assert!(inside.iter().all(|w| *w > -1e-6), "{inside:?}");
            let (root, facet) = (trees.places(trees.roots[1] + root), trees.corners_of(1));
            assert!(place(root, inside).abs_diff_eq(place(facet, w), 1e-6));
        }
    }
}
