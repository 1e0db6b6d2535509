//! What hemicubes look at: facets to be drawn, and the elements that lie in each.
//!
//! A facet's quadtrees are the same down to some depth: a grid, in which the cell at a point is
//! found by dividing, however deep. Only below that a tree is gone down. Of facets with holes the
//! elements are drawn one by one, and of elements with holes the parts that are there.
//!
//! In:   quadtrees over facets. Out: the facets as a scene, and the element at a point of each.
//! Cost: linear in nodes; a question takes a step, and one for each level of a tree below the grid.

use super::parts::{PARTS, WHOLE, parts};
use super::patch::{Cell, NONE, Trees};
use crate::Session;
use std::collections::HashMap;
use std::sync::{Arc, Mutex};
use vitral_math::{DVec3, Vec3};
use vitral_scene::{Mesh, Part, Scene};

/// See the module.
#[derive(Debug)]
pub struct Targets {
    /// The facets as a scene of their own.
    pub(super) session: Session,
    /// The grid of each of the scene's facets.
    grids: Vec<Grid>,
    /// The cells of all grids.
    cells: Vec<Content>,
    /// The number of each node that is a leaf.
    numbers: Vec<u32>,
    /// How many leaves there are.
    leaves: usize,
    /// Sums that are not in use.
    spare: Mutex<Vec<Sums>>,
}

/// A sum for each leaf. Most are 0: those that are not are known without a look at all.
#[derive(Debug)]
pub(super) struct Sums {
    sums: Vec<f64>,
    /// A bit for each sum that something was added to.
    touched: Vec<u64>,
}

impl Sums {
    #[inline]
    pub(super) fn add(&mut self, leaf: u32, factor: f64) {
        self.sums[leaf as usize] += factor;
        self.touched[leaf as usize / 64] |= 1 << (leaf % 64);
    }

    /// The sums that are above 0, with their leaves, in the order of leaves; all are 0 afterwards.
    fn take(&mut self) -> Vec<(u32, f64)> {
        let count: u32 = self.touched.iter().map(|bits| bits.count_ones()).sum();
        let mut found = Vec::with_capacity(count as usize);
        for (word, bits) in (0..).zip(&mut self.touched) {
            while *bits != 0 {
                let leaf = 64 * word + bits.trailing_zeros();
                *bits &= *bits - 1;
                let sum = std::mem::take(&mut self.sums[leaf as usize]);
                if sum > 0.0 {
                    found.push((leaf, sum));
                }
            }
        }
        found
    }
}

/// Cells of a facet.
#[derive(Clone, Copy, Debug)]
struct Grid {
    /// The first one.
    first: u32,
    /// Cells along an edge.
    side: u32,
}

/// What is in a cell.
#[derive(Clone, Copy, Debug)]
enum Content {
    /// A leaf, by its number.
    Leaf(u32),
    /// A node with children.
    Node(u32),
}

impl Targets {
    /// The leaves of `trees`, in their order.
    pub fn new(trees: &Trees) -> Self {
        Self::with_holes(trees, &vec![WHOLE; trees.leaves().len()])
    }

    /// The leaves of `trees`, and for each, in their order, which parts of it are there. Facets
    /// with holes are drawn in pieces.
    pub(super) fn with_holes(trees: &Trees, there: &[u16]) -> Self {
        // Number the leaves, and find the facets without holes.
        let mut numbers = vec![NONE; trees.nodes.len()];
        let leaves = trees.leaves();
        (0..).zip(&leaves).for_each(|(number, &leaf)| numbers[leaf as usize] = number);
        let mut whole: Vec<bool> = trees.roots.iter().map(|&root| root != NONE).collect();
        let facet = |leaf: u32| trees.nodes[leaf as usize].facet as usize;
        let with_holes = leaves.iter().zip(there).filter(|(_, there)| **there != WHOLE);
        with_holes.for_each(|(&leaf, _)| whole[facet(leaf)] = false);

        // Facets that are whole, with a grid of cells each.
        let (mut triangles, mut grids, mut cells) = (Vec::new(), Vec::new(), Vec::new());
        for facet in (0..whole.len() as u32).filter(|&f| whole[f as usize]) {
            let roots = trees.roots_of(facet);
            let depth = roots.clone().map(|root| least_depth(trees, root)).min().unwrap_or(0);
            let (first, side) = (cells.len(), trees.cuts << depth);
            cells.resize(first + (side * side) as usize, Content::Node(NONE));
            for (number, root) in (0..).zip(roots) {
                fill(
                    trees,
                    &numbers,
                    (root, Cell::numbered(number, trees.cuts)),
                    side,
                    &mut cells[first..],
                );
            }
            triangles.push(trees.corners_of(facet));
            grids.push(Grid { first: first as u32, side });
        }

        // The leaves of the others, or the parts of them that are there, with a cell each leaf.
        for ((&leaf, &there), number) in
            leaves.iter().zip(there).zip(0..).filter(|((leaf, _), _)| !whole[facet(**leaf)])
        {
            let corners = trees.places(leaf);
            let before = triangles.len();
            match there {
                WHOLE => triangles.push(corners),
                _ => triangles.extend(
                    (0..PARTS)
                        .filter(|part| there >> part & 1 == 1)
                        .map(|part| parts(corners)[part]),
                ),
            }
            grids.extend(
                (before..triangles.len()).map(|_| Grid { first: cells.len() as u32, side: 1 }),
            );
            cells.push(Content::Leaf(number));
        }

        // Make a scene of the triangles, which the z-buffer can draw.
        let session = scene_of(&triangles);
        Self { session, grids, cells, numbers, leaves: leaves.len(), spare: Mutex::default() }
    }

    /// Sums that are all 0.
    pub(super) fn sums(&self) -> Sums {
        let spare = self.spare.lock().expect("spare sums").pop();
        spare.unwrap_or_else(|| Sums {
            sums: vec![0.0; self.leaves],
            touched: vec![0; self.leaves.div_ceil(64)],
        })
    }

    /// The sums that are above 0, with their leaves, in the order of leaves.
    pub(super) fn finish(&self, mut sums: Sums) -> Vec<(u32, f64)> {
        let found = sums.take();
        self.spare.lock().expect("spare sums").push(sums);
        found
    }

    /// Corners of a facet, by its number in the scene that is drawn.
    pub(super) fn corners(&self, facet: u32) -> [DVec3; 3] {
        let mesh = &self.session.world.instances[0].mesh;
        let vertices = mesh.triangles[facet as usize];
        vertices.map(|vertex| Vec3::from(mesh.positions[vertex as usize]).as_dvec3())
    }

    /// How many borders of a facet's cells a line crosses in its first step, about; `slopes` tells
    /// how the weights change.
    #[inline]
    pub(super) fn borders_crossed(&self, facet: u32, weights: [f64; 3], slopes: [f64; 3]) -> f64 {
        let [sum, slope] = [weights, slopes].map(|values| values[0] + values[1] + values[2]);
        let changes = [0, 1, 2].map(|k| (slopes[k] * sum - weights[k] * slope).abs());
        f64::from(self.grids[facet as usize].side) * (changes[0] + changes[1] + changes[2])
            / (sum * sum)
    }

    /// The leaf at a point of a facet, by its number; the sum of the weights is above 0.
    #[inline]
    pub(super) fn leaf_at(&self, trees: &Trees, facet: u32, weights: [f64; 3]) -> u32 {
        let Grid { first, side } = self.grids[facet as usize];
        let scale = f64::from(side) / (weights[0] + weights[1] + weights[2]);
        let cell = Cell::at(weights.map(|w| w * scale), side);
        match self.cells[(first + cell.number(side)) as usize] {
            Content::Leaf(number) => number,
            Content::Node(node) => {
                let (leaf, ..) = trees.leaf_along(node, cell.inside(weights, side), [0.0; 3]);
                self.numbers[leaf as usize]
            }
        }
    }

    /// The same, and the way on: how the weights change along some line comes in, those of the
    /// leaf's corners and how they change go out, times any positive number.
    #[inline]
    pub(super) fn leaf_along(
        &self,
        trees: &Trees,
        facet: u32,
        weights: [f64; 3],
        slopes: [f64; 3],
    ) -> (u32, [f64; 3], [f64; 3]) {
        let Grid { first, side } = self.grids[facet as usize];
        let scale = f64::from(side) / (weights[0] + weights[1] + weights[2]);
        let cell = Cell::at(weights.map(|w| w * scale), side);
        let (weights, slopes) = (cell.inside(weights, side), cell.inside(slopes, side));
        match self.cells[(first + cell.number(side)) as usize] {
            Content::Leaf(number) => (number, weights, slopes),
            Content::Node(node) => {
                let (leaf, weights, slopes) = trees.leaf_along(node, weights, slopes);
                (self.numbers[leaf as usize], weights, slopes)
            }
        }
    }
}

/// Triangles as a scene of their own. Corners in one place are one vertex, which each of many small
/// pictures transforms once.
fn scene_of(triangles: &[[DVec3; 3]]) -> Session {
    let (mut positions, mut numbers) = (Vec::new(), HashMap::new());
    let mut number = |corner: DVec3| {
        let position = corner.as_vec3().to_array();
        *numbers.entry(position.map(f32::to_bits)).or_insert_with(|| {
            positions.push(position);
            positions.len() as u32 - 1
        })
    };
    let triangles: Vec<_> = triangles.iter().map(|corners| corners.map(&mut number)).collect();
    let parts =
        vec![Part { name: String::new(), triangles: 0..triangles.len() as u32, material: None }];
    let mesh = Mesh { positions, triangles, parts, ..Mesh::default() };
    Session::new(Arc::new(Scene::from_mesh(mesh))).expect("a mesh of its own triangles is sound")
}

/// Levels below a node down to its first leaf.
fn least_depth(trees: &Trees, node: u32) -> u32 {
    match trees.nodes[node as usize].children {
        NONE => 0,
        children => {
            1 + (children..children + 4).map(|child| least_depth(trees, child)).min().unwrap_or(0)
        }
    }
}

/// Enters what is below a node into the cells of a grid with `side` of them along an edge.
fn fill(
    trees: &Trees,
    numbers: &[u32],
    (node, cell): (u32, Cell),
    side: u32,
    cells: &mut [Content],
) {
    // Upright and upside down, the numbers of steps tell in how many parts edges are cut here.
    let along = cell.steps.iter().sum::<u32>() + if cell.upright { 1 } else { 2 };
    let children = trees.nodes[node as usize].children;
    if along == side {
        let content = if children == NONE {
            Content::Leaf(numbers[node as usize])
        } else {
            Content::Node(node)
        };
        cells[cell.number(side) as usize] = content;
    } else {
        (0..4).for_each(|k| {
            fill(trees, numbers, (children + k, cell.child(k as usize)), side, cells)
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::dvec3;

    #[test]
    fn points_are_found_in_their_leaf() {
        let p = [DVec3::ZERO, DVec3::X, dvec3(1.0, 1.0, 0.0), DVec3::Y];
        let corners = |f: u32| Some(if f == 0 { [p[0], p[1], p[2]] } else { [p[0], p[2], p[3]] });
        for (longest, cuts, roots) in [(0.25, 3, 9), (0.5, 3, 9), (0.8, 1, 1), (2.0, 1, 1)] {
            let mut trees = Trees::new(2, corners, longest, 1 << 20).unwrap();
            assert_eq!((trees.cuts, trees.roots_of(1).len()), (cuts, roots), "{longest}");
            for k in [1, 5, 1] {
                let leaves = trees.leaves();
                trees.split(leaves[k % leaves.len()] as usize);
            }
            trees.balance();
            let (targets, leaves) = (Targets::new(&trees), trees.leaves());
            let mut met = vec![false; leaves.len()];
            for i in 0..4096u32 {
                let (facet, (u, v)) =
                    (i % 2, (f64::from(i % 64) / 64.0 + 0.004, f64::from(i / 64) / 64.0 + 0.009));
                let w =
                    if u + v < 1.0 { [u, v, 1.0 - u - v] } else { [1.0 - u, 1.0 - v, u + v - 1.0] };
                // Any scale will do.
                let (w, step) = (w.map(|w| 3.0 * w), [0.02, -0.03, 0.01]);
                let (leaf, inside, along) = targets.leaf_along(&trees, facet, w, step);
                met[leaf as usize] = true;
                assert_eq!(targets.leaf_at(&trees, facet, w), leaf);
                let place = |corners: [DVec3; 3], w: [f64; 3]| {
                    (corners[0] * w[0] + corners[1] * w[1] + corners[2] * w[2])
                        / w.iter().sum::<f64>()
                };
                let (facet, leaf) = (trees.corners_of(facet), trees.places(leaves[leaf as usize]));
                let ahead = |w: [f64; 3], step: [f64; 3]| [0, 1, 2].map(|k| w[k] + 0.7 * step[k]);
                assert!(place(leaf, inside).abs_diff_eq(place(facet, w), 1e-12));
                assert!(
                    place(leaf, ahead(inside, along))
                        .abs_diff_eq(place(facet, ahead(w, step)), 1e-12)
                );
                assert!(inside.iter().all(|w| *w > -1e-12), "{inside:?}");
            }
            assert!(met.iter().all(|met| *met));
        }
    }

    #[test]
    fn lines_cross_as_many_borders_as_is_said() {
        let trees =
            Trees::new(1, |_| Some([DVec3::ZERO, DVec3::X, DVec3::Y]), 0.36, 1 << 10).unwrap();
        let targets = Targets::new(&trees);
        // Along an edge of the facet four borders of either other direction begin, those of the
        // corners with them.
        assert_eq!(
            (trees.leaves().len(), targets.borders_crossed(0, [1.0, 0.0, 0.0], [-1.0, 1.0, 0.0])),
            (16, 8.0)
        );
        assert_eq!(targets.borders_crossed(0, [3.0, 0.0, 0.0], [-1.5, 1.5, 0.0]), 4.0);
    }

    #[test]
    fn sums_are_given_in_order_and_begin_anew() {
        let trees =
            Trees::new(1, |_| Some([DVec3::ZERO, DVec3::X, DVec3::Y]), 0.1, 1 << 10).unwrap();
        let targets = Targets::new(&trees);
        for _ in 0..2 {
            let mut sums = targets.sums();
            [(70, 0.5), (3, 0.25), (70, 0.25), (64, 0.0)]
                .into_iter()
                .for_each(|(leaf, factor)| sums.add(leaf, factor));
            assert_eq!(targets.finish(sums), [(3, 0.25), (70, 0.75)]);
        }
    }
}
