//! A tree of boxes over things in their given order: one test rejects any number of them.
//!
//! Leaves are boxes round single things, or round runs of consecutive triangles; each inner node
//! holds the box round two nodes below. Order is kept, so that numbering is, and files usually list
//! neighbours together.
//!
//! Cost: building is linear; a query visits the nodes whose parents cross the view volume.
//! Source: [Clark 1976].

use std::ops::Range;
use vitral_math::Aabb;
use vitral_math::frustum::{Containment, Frustum};
use vitral_scene::TRIANGLES_A_RUN;

/// A box that was tested against the view volume.
#[derive(Clone, Debug)]
pub struct BoxTest {
    /// The box.
    pub bounds: Aabb,
    /// What it holds.
    pub items: Range<u32>,
    /// Where it lies.
    pub containment: Containment,
    /// Index of the plane that it lies beyond, if it is outside.
    pub beyond: Option<usize>,
}

/// Is told each test of a box.
pub type BoxTested<'f> = dyn FnMut(&BoxTest) + 'f;

/// A complete binary tree: node `i` has the children `2 i + 1` and `2 i + 2`; leaves fill the last
/// places.
#[derive(Clone, Debug)]
pub struct BoundsTree {
    nodes: Vec<Aabb>,
    leaves: usize,
    first_leaf: usize,
    items: usize,
    items_a_leaf: usize,
}

impl BoundsTree {
    /// A tree over `boxes`, one leaf each.
    pub fn new(boxes: &[Aabb]) -> Self {
        Self::build(boxes, boxes.len(), 1)
    }

    /// A tree over a mesh's triangles in order, [`TRIANGLES_A_RUN`] a leaf, from the boxes round
    /// them.
    pub fn over_runs(run_bounds: &[Aabb], triangles: usize) -> Self {
        Self::build(run_bounds, triangles, TRIANGLES_A_RUN)
    }

    fn build(boxes: &[Aabb], items: usize, items_a_leaf: usize) -> Self {
        let leaves = boxes.len().next_power_of_two();
        let first_leaf = leaves - 1;
        let mut nodes = vec![Aabb::EMPTY; 2 * leaves - 1];
        nodes[first_leaf..first_leaf + boxes.len()].copy_from_slice(boxes);
        for i in (0..first_leaf).rev() {
            nodes[i] = nodes[2 * i + 1].union(&nodes[2 * i + 2]);
        }
        Self { nodes, leaves, first_leaf, items, items_a_leaf }
    }

    /// The runs of items whose boxes reach into the frustum, in order and joined where they meet;
    /// tells `tested` each box that is tested, with the items in it.
    pub fn visible(&self, frustum: &Frustum, tested: &mut BoxTested<'_>) -> Vec<Range<u32>> {
        let mut runs = Vec::new();
        self.visit(0, 0, self.leaves, frustum, tested, &mut runs);
        runs
    }

    fn visit(
        &self,
        node: usize,
        first: usize,
        count: usize,
        frustum: &Frustum,
        tested: &mut BoxTested<'_>,
        runs: &mut Vec<Range<u32>>,
    ) {
        if self.nodes[node].is_empty() {
            return;
        }
        let start = (first * self.items_a_leaf) as u32;
        let end = ((first + count) * self.items_a_leaf).min(self.items) as u32;
        let (containment, beyond) = frustum.find_box(&self.nodes[node]);
        tested(&BoxTest { bounds: self.nodes[node], items: start..end, containment, beyond });
        if containment == Containment::Outside {
            return;
        }
        if containment == Containment::Inside || node >= self.first_leaf {
            match runs.last_mut() {
                Some(last) if last.end == start => last.end = end,
                _ => runs.push(start..end),
            }
            return;
        }
        let half = count / 2;
        self.visit(2 * node + 1, first, half, frustum, tested, runs);
        self.visit(2 * node + 2, first + half, half, frustum, tested, runs);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::{DMat4, DVec3};

    fn unit(x: f64) -> Aabb {
        Aabb { min: DVec3::new(x, 0.0, 0.4), max: DVec3::new(x + 0.1, 0.1, 0.6) }
    }

    #[test]
    fn p10_one_test_rejects_everything() {
        let frustum = Frustum::from_matrix(&DMat4::IDENTITY);
        let tree =
            BoundsTree::new(&(0..1000).map(|i| unit(5.0 + f64::from(i))).collect::<Vec<_>>());
        let mut tests = 0;
        assert!(tree.visible(&frustum, &mut |_| tests += 1).is_empty());
        assert_eq!(tests, 1);
    }

    #[test]
    fn p10_the_visible_ones_are_all_there() {
        let frustum = Frustum::from_matrix(&DMat4::IDENTITY);
        let boxes: Vec<_> = (0..37).map(|i| unit(f64::from(i) * 0.3 - 4.0)).collect();
        let tree = BoundsTree::new(&boxes);
        let mut told = Vec::new();
        let runs = tree.visible(&frustum, &mut |test| told.push(test.clone()));
        assert_eq!((told[0].items.clone(), told[0].containment), (0..37, Containment::Crossing));
        assert!(
            told.iter()
                .all(|test| (test.containment == Containment::Outside) == test.beyond.is_some())
        );
        for (i, b) in boxes.iter().enumerate() {
            let inside = runs.iter().any(|r| r.contains(&(i as u32)));
            assert_eq!(inside, frustum.test_box(b) != Containment::Outside, "box {i}");
        }
    }
}
