//! What a tree tells an observer: its nodes, and the walk for a viewer. It is told from the
//! finished tree, so that it is the same whoever built it and whether it was there already.

use super::{BspTree, NONE};
use crate::Execution;
use crate::trace::Step;
use crate::trace::lists::{PlaneSide, PolygonSet};
use vitral_math::DVec4;

impl BspTree {
    /// Tells the nodes, each after the one that it hangs below.
    pub(crate) fn tell_nodes(&self, execution: &Execution) {
        if execution.observer.is_none() {
            return;
        }
        let parents = self.parents();
        for node in 0..self.nodes.len() as u32 {
            execution.report(|| self.node_step(node, &parents));
        }
    }

    /// Tells the walk for a viewer, see [`BspTree::back_to_front`], node by node.
    pub(crate) fn tell_walk(&self, viewer: DVec4, execution: &Execution) {
        if execution.observer.is_none() {
            return;
        }
        let parents = self.parents();
        let mut order = 0;
        self.walk(viewer, |node, in_front| {
            let mut polygons = Vec::new();
            self.nodes[node as usize].each_fragment(in_front, |f| polygons.push(self.name(f)));
            let viewer = if in_front { PlaneSide::Front } else { PlaneSide::Back };
            let above = parents[node as usize].map(|(parent, _)| parent);
            execution.report(|| Step::TreeVisit { order, node, above, viewer, polygons });
            order += 1;
        });
    }

    /// For each fragment the node in whose plane it lies; none for polygons that have no place in
    /// the tree.
    pub(crate) fn nodes_of_fragments(&self) -> Vec<Option<u32>> {
        let mut nodes = vec![None; self.fragments.len()];
        for (number, node) in (0..).zip(&self.nodes) {
            nodes[node.fragments.start as usize..node.fragments.end as usize].fill(Some(number));
        }
        nodes
    }

    /// The facet by which the polygon of a fragment is named.
    pub(crate) fn name(&self, fragment: u32) -> u32 {
        self.facets.name(self.fragments[fragment as usize].polygon)
    }

    /// For each node the one that it hangs below, and on which side; none for the root.
    fn parents(&self) -> Vec<Option<(u32, PlaneSide)>> {
        let mut parents = vec![None; self.nodes.len()];
        for (number, node) in (0..).zip(&self.nodes) {
            for (child, side) in [(node.front, PlaneSide::Front), (node.back, PlaneSide::Back)] {
                if let Some(parent) = parents.get_mut(child as usize) {
                    *parent = Some((number, side));
                }
            }
        }
        parents
    }

    /// The step of a node. Each polygon of its set has one part in it: what hangs on both sides was
    /// cut here.
    fn node_step(&self, node: u32, parents: &[Option<(u32, PlaneSide)>]) -> Step {
        let n = &self.nodes[node as usize];
        let parent = parents[node as usize];

        // Find the polygons on both sides; those on both were cut.
        let [front, back] = [n.front, n.back].map(|child| self.polygons_below(child));
        let mut coincident: Vec<u32> =
            n.fragments.clone().map(|fragment| self.fragments[fragment as usize].polygon).collect();
        coincident.sort_unstable();
        let cut = front.iter().copied().filter(|polygon| back.binary_search(polygon).is_ok());
        let named =
            |polygons: &[u32]| PolygonSet::new(polygons.iter().map(|&p| self.facets.name(p)));
        Step::TreeNode {
            node,
            above: parent.map(|(parent, _)| parent),
            side: parent.map(|(_, side)| side),
            splitter: (n.splitter != NONE).then(|| self.facets.name(n.splitter)),
            // Adding 0 takes the sign of zeros.
            plane: n.plane.to_array().map(|v| v + 0.0),
            coincident: named(&coincident),
            cut: PolygonSet::new(cut.map(|p| self.facets.name(p))),
            front: named(&front),
            back: named(&back),
        }
    }

    /// The polygons of a node and all that hang below it, the lowest first.
    fn polygons_below(&self, node: u32) -> Vec<u32> {
        let (mut polygons, mut waiting) = (Vec::new(), vec![node]);
        while let Some(node) = waiting.pop() {
            let Some(n) = self.nodes.get(node as usize) else { continue };
            polygons.extend(
                n.fragments.clone().map(|fragment| self.fragments[fragment as usize].polygon),
            );
            waiting.extend([n.front, n.back]);
        }
        polygons.sort_unstable();
        polygons.dedup();
        polygons
    }
}
