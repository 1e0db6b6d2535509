//! Strongly connected components of a graph.
//!
//! In:   nodes by number, each with its successors.
//! Out:  the components in reverse topological order, each with its nodes in ascending order.
//! Cost: `O(nodes + edges)`.
//! Source: Tarjan 1972.

/// The components of a graph whose node `n` has the successors `successors[n]`.
pub(super) fn components(successors: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let unvisited = Node { index: None, low: 0, on_stack: false };
    let mut search = Search {
        successors,
        nodes: vec![unvisited; successors.len()],
        stack: Vec::new(),
        count: 0,
        components: Vec::new(),
    };
    for node in 0..successors.len() {
        if search.nodes[node].index.is_none() {
            search.visit(node);
        }
    }
    search.components
}

#[derive(Clone, Copy)]
struct Node {
    /// Order of the visit.
    index: Option<usize>,
    /// Least index that is known to be reachable within the component.
    low: usize,
    on_stack: bool,
}

struct Search<'a> {
    successors: &'a [Vec<usize>],
    nodes: Vec<Node>,
    stack: Vec<usize>,
    count: usize,
    components: Vec<Vec<usize>>,
}

impl Search<'_> {
    fn visit(&mut self, node: usize) -> usize {
        let index = self.count;
        self.count += 1;
        self.nodes[node] = Node { index: Some(index), low: index, on_stack: true };
        self.stack.push(node);

        // Lower the mark to what the successors reach.
        for &next in &self.successors[node] {
            let reached = match self.nodes[next].index {
                None => self.visit(next),
                Some(index) if self.nodes[next].on_stack => index,
                Some(_) => continue,
            };
            self.nodes[node].low = self.nodes[node].low.min(reached);
        }

        // Close the component of which this node was visited first.
        if self.nodes[node].low == index {
            let start = self.stack.iter().position(|&other| other == node).unwrap_or(0);
            let mut component = self.stack.split_off(start);
            component.iter().for_each(|&member| self.nodes[member].on_stack = false);
            component.sort_unstable();
            self.components.push(component);
        }
        self.nodes[node].low
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_that_reach_each_other_are_one_component() {
        let graph = [vec![1], vec![2], vec![0, 3], vec![4], vec![3], vec![0]];
        assert_eq!(components(&graph), [vec![3, 4], vec![0, 1, 2], vec![5]]);
    }

    #[test]
    fn nodes_without_circle_stand_alone() {
        assert_eq!(
            components(&[vec![1, 2], vec![2], vec![], vec![3]]),
            [vec![2], vec![1], vec![0], vec![3]]
        );
        assert!(components(&[]).is_empty());
    }
}
