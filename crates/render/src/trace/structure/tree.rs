//! A BSP tree as nodes and links: the back to the left, the front to the right.

use super::super::Step;
use super::super::lists::{PlaneSide, PolygonSet};
use super::svg_picture::{BLUE, GREY, INK, LINE, MARGIN, Picture, RED, row_of};
use std::collections::{BTreeMap, VecDeque};

/// Nodes that are drawn. What hangs below others is counted.
const MOST_NODES: usize = 63;
/// Size of a node's box.
const BOX: [f64; 2] = [190.0, 4.0 * LINE + 8.0];
/// From box to box.
const ACROSS: f64 = 206.0;
const DOWN: f64 = 118.0;

/// A node as its step tells it.
struct Node<'s> {
    splitter: Option<u32>,
    plane: [f64; 4],
    coincident: &'s PolygonSet,
    cut: &'s PolygonSet,
    /// What hangs on the back and on the front, and how many polygons and parts that are.
    children: [Option<u32>; 2],
    counts: [u32; 2],
    /// Its place in the walk, and the viewer's side.
    visit: Option<(u32, PlaneSide)>,
}

/// Where a node is drawn, or what stands for those that are not.
struct Placed {
    node: u32,
    parent: Option<(usize, PlaneSide)>,
    level: usize,
    /// Middle of its box, in boxes from the left.
    across: f64,
    is_drawn: bool,
}

/// Draws the BSP tree of [`Step::TreeNode`]s, with the walk of [`Step::TreeVisit`]s: nodes are
/// named by the splitter's facet, and numbered as the walk comes to them, from back to front.
pub fn bsp_tree_svg(steps: &[Step]) -> String {
    // Count nodes and cuts for the title.
    let nodes = nodes(steps);
    let cuts: u64 = nodes.values().map(|node| u64::from(node.cut.count)).sum();
    let polygons: u64 = nodes.values().map(|node| u64::from(node.coincident.count)).sum();
    let title = format!(
        "BSP tree: {} node(s), {cuts} cut(s), {polygons} polygon(s) and parts in the list",
        nodes.len()
    );
    let explained = [
        "A node: the facet that gave its plane, its polygons in the plane, those cut by it (red). A link: polygons on that side.",
        "#n: its place in the walk for this viewer, from back to front; blue links lead to the viewer's side.",
    ];

    // Choose places for the nodes.
    let mut picture = Picture::new(&title, &explained);
    let top = picture.bottom();
    let placed = place(&nodes);
    let middle =
        |p: &Placed| [MARGIN + BOX[0] / 2.0 + p.across * ACROSS, top + p.level as f64 * DOWN];

    // Draw the links below the boxes.
    for p in &placed {
        let Some((parent, side)) = p.parent else { continue };
        let (from, to) = (middle(&placed[parent]), middle(p));
        let from = [from[0], from[1] + BOX[1]];
        let above = nodes.get(&placed[parent].node);
        let viewer = above.and_then(|node| node.visit).map(|(_, side)| side);
        let count = above.map_or(0, |node| node.counts[usize::from(side == PlaneSide::Front)]);
        let color = if viewer == Some(side) { BLUE } else { GREY };
        picture.line(from, to, color, if color == BLUE { 2.0 } else { 1.0 });
        let (x, anchor) = if to[0] < from[0] { (-12.0, "end") } else { (12.0, "start") };
        let at = [(from[0] + to[0]) / 2.0 + x, (from[1] + to[1]) / 2.0];
        picture.text(at, &format!("{} {count}", side.name()), color, anchor);
    }

    // Draw the nodes; those without room are counted in a box.
    for p in &placed {
        let [x, y] = middle(p);
        let corner = [x - BOX[0] / 2.0, y];
        if !p.is_drawn {
            let (below, polygons) = below(&nodes, p.node);
            picture.rectangle(corner, [BOX[0], 2.0 * LINE + 8.0], GREY, "#f4f4f4");
            picture.text([x, y + LINE], &format!("... {below} node(s)"), GREY, "middle");
            picture.text(
                [x, y + 2.0 * LINE],
                &format!("with {polygons} polygon(s)"),
                GREY,
                "middle",
            );
            continue;
        }
        let Some(node) = nodes.get(&p.node) else { continue };
        draw_node(&mut picture, p.node, node, corner);
    }
    picture.finish()
}

/// The nodes by their numbers.
fn nodes(steps: &[Step]) -> BTreeMap<u32, Node<'_>> {
    let mut nodes = BTreeMap::new();
    // Link each node to its parent, and note when the walk came to it.
    for step in steps {
        match step {
            Step::TreeNode { node, above, side, splitter, plane, coincident, cut, front, back } => {
                if let Some(above) = above.and_then(|above| nodes.get_mut(&above)) {
                    let above: &mut Node<'_> = above;
                    above.children[usize::from(*side == Some(PlaneSide::Front))] = Some(*node);
                }
                let (children, visit) = ([None; 2], None);
                let (splitter, plane) = (*splitter, *plane);
                let counts = [back.count, front.count];
                nodes.insert(
                    *node,
                    Node { splitter, plane, coincident, cut, children, counts, visit },
                );
            }
            Step::TreeVisit { order, node, viewer, .. } => {
                if let Some(node) = nodes.get_mut(node) {
                    node.visit = Some((*order, *viewer));
                }
            }
            _ => {}
        }
    }
    nodes
}

/// Chooses the nodes nearest to the root, and places them: leaves side by side, others above the
/// middle of what hangs below.
fn place(nodes: &BTreeMap<u32, Node<'_>>) -> Vec<Placed> {
    let Some(&root) = nodes.keys().next() else { return Vec::new() };

    // Walk the tree level by level.
    let mut placed: Vec<Placed> = Vec::new();
    let mut children: Vec<Vec<usize>> = Vec::new();
    let mut waiting = VecDeque::from([(root, None, 0)]);
    while let Some((node, parent, level)) = waiting.pop_front() {
        let is_drawn = placed.iter().filter(|p| p.is_drawn).count() < MOST_NODES;
        let index = placed.len();
        if let Some((parent, _)) = parent {
            let siblings: &mut Vec<usize> = &mut children[parent];
            siblings.push(index);
        }
        placed.push(Placed { node, parent, level, across: 0.0, is_drawn });
        children.push(Vec::new());
        if is_drawn && let Some(n) = nodes.get(&node) {
            for (child, side) in n.children.into_iter().zip([PlaneSide::Back, PlaneSide::Front]) {
                waiting.extend(child.map(|child| (child, Some((index, side)), level + 1)));
            }
        }
    }

    // From left to right, each after what hangs below it.
    let (mut next, mut stack) = (0.0, vec![(0, false)]);
    while let Some((index, is_done)) = stack.pop() {
        match (children[index].as_slice(), is_done) {
            ([], _) => {
                placed[index].across = next;
                next += 1.0;
            }
            (below, true) => {
                let sum: f64 = below.iter().map(|&child| placed[child].across).sum();
                let aside = match (below, placed[below[0]].parent) {
                    // An only child stands to its side, lest the link be a plumb line.
                    ([_], Some((_, PlaneSide::Front))) => -0.25,
                    ([_], _) => 0.25,
                    _ => 0.0,
                };
                placed[index].across = sum / below.len() as f64 + aside;
            }
            (below, false) => {
                stack.push((index, true));
                stack.extend(below.iter().rev().map(|&child| (child, false)));
            }
        }
    }

    // Move all nodes to the right of the margin.
    let left = placed.iter().map(|p| p.across).fold(0.0, f64::min);
    placed.iter_mut().for_each(|p| p.across -= left);
    placed
}

/// How many nodes a node and what hangs below it are, and how many polygons and parts they have.
fn below(nodes: &BTreeMap<u32, Node<'_>>, node: u32) -> (usize, u64) {
    let (mut count, mut polygons, mut waiting) = (0, 0, vec![node]);
    while let Some(node) = waiting.pop() {
        let Some(node) = nodes.get(&node) else { continue };
        count += 1;
        polygons += u64::from(node.coincident.count);
        waiting.extend(node.children.into_iter().flatten());
    }
    (count, polygons)
}

fn draw_node(picture: &mut Picture, number: u32, node: &Node<'_>, [x, y]: [f64; 2]) {
    picture.rectangle([x, y], BOX, INK, "#ffffff");
    let middle = x + BOX[0] / 2.0;
    let name = match (node.splitter, node.plane) {
        (Some(facet), _) => format!("facet {facet}"),
        (None, [a, b, _, d]) => {
            let axis = if a.abs() == 1.0 {
                "x"
            } else if b.abs() == 1.0 {
                "y"
            } else {
                "z"
            };
            format!("plane {axis} = {:.4}", -d)
        }
    };
    picture.text([middle, y + LINE], &name, INK, "middle");
    let place = node.visit.map_or(String::new(), |(order, _)| format!(" #{order}"));
    picture.text([middle, y + 2.0 * LINE], &format!("node {number}{place}"), BLUE, "middle");
    let inside = format!("in plane: {}", row_of(&node.coincident.facets, node.coincident.count));
    picture.text([middle, y + 3.0 * LINE], &short(&inside), INK, "middle");
    if node.cut.count > 0 {
        let cut = format!("cut {}: {}", node.cut.count, row_of(&node.cut.facets, node.cut.count));
        picture.text([middle, y + 4.0 * LINE], &short(&cut), RED, "middle");
    }
}

/// What fits into a box.
fn short(text: &str) -> String {
    const MAX_CHARACTERS: usize = 25;
    if text.chars().count() <= MAX_CHARACTERS {
        text.to_owned()
    } else {
        text.chars().take(MAX_CHARACTERS - 3).chain("...".chars()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tree whose nodes each have one polygon, the children of node `n` being `2 n + 1` behind
    /// and `2 n + 2` in front.
    fn heap(count: u32) -> Vec<Step> {
        let node = |node: u32| Step::TreeNode {
            node,
            above: (node > 0).then(|| (node - 1) / 2),
            side: (node > 0).then_some(if node % 2 == 1 {
                PlaneSide::Back
            } else {
                PlaneSide::Front
            }),
            splitter: Some(node + 100),
            plane: [0.0, 0.0, 1.0, 0.0],
            coincident: PolygonSet::new([node + 100]),
            front: PolygonSet::new([1, 2, 3]),
            back: PolygonSet::new([4]),
            cut: PolygonSet::new((node == 0).then_some(107)),
        };
        (0..count).map(node).collect()
    }

    #[test]
    fn a_small_tree_is_drawn_whole() {
        let mut steps = heap(3);
        let visit = |order, node| Step::TreeVisit {
            order,
            node,
            above: None,
            viewer: PlaneSide::Front,
            polygons: vec![node + 100],
        };
        steps.extend([visit(0, 1), visit(1, 0), visit(2, 2)]);
        let svg = bsp_tree_svg(&steps);
        for text in [
            ">facet 100<",
            ">facet 101<",
            ">facet 102<",
            ">back 1<",
            ">front 3<",
            ">cut 1: 107<",
            ">node 1 #0<",
        ] {
            assert!(svg.contains(text), "{text} in {svg}");
        }
        assert!(svg.contains("3 node(s), 1 cut(s), 3 polygon(s)") && !svg.contains("..."), "{svg}");
        // The link to the viewer's side alone is blue.
        assert_eq!(svg.matches("stroke=\"#1f5fbf\"").count(), 1);
    }

    #[test]
    fn what_is_left_out_of_a_large_tree_is_counted() {
        let svg = bsp_tree_svg(&heap(255));
        assert_eq!(svg.matches(">facet ").count(), 63);
        // Below the 32 on the last level that is drawn.
        assert_eq!(svg.matches(">... 3 node(s)<").count(), 64);
        assert_eq!(svg.matches(">with 3 polygon(s)<").count(), 64);
    }

    #[test]
    fn no_tree_is_an_empty_picture() {
        assert!(bsp_tree_svg(&[]).contains("0 node(s)"));
    }
}
