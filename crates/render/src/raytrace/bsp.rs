//! A box round the scene, cut in two by a plane across one axis, and its parts again: binary space
//! partitioning.
//!
//! Planes lie across an axis (such a tree is also called a k-d tree), but anywhere on it: where the
//! surface area heuristic expects rays to have least to do. A plane costs its visit and, on each
//! side, the triangles there in proportion to the side's surface; planes are tried at equal
//! distances between the first and the last triangle of a cell, and just before and behind these,
//! which cuts off empty space. Sides fill their cell and do not overlap, so a ray passes them one
//! after the other. A triangle belongs to every leaf it reaches into; a visitor may see it several
//! times.
//!
//! Nodes keep their plane alone: who goes down carries the cell along, so that whatever is followed
//! (a ray, a beam, rays through a block of pixels) is tested against boxes, as in the other trees.
//!
//! The tree of `--visibility bsp` is another: it cuts polygons by the planes of polygons, and gives
//! an order.
//!
//! In:   triangles. Out: [`KdTree`].
//! Cost: `O(n log n)` to build; 16 bytes a node, and at most [`REFERENCES`] entries a triangle,
//!       whatever the scene.
//! Source: [Kaplan 1985], the heuristic after [MacDonald & Booth 1990]. Departs from them: planes
//!         are tried at equal distances, not at every triangle.

use super::beam::Beam;
use super::follow::{Follow, StructureUser};
use super::path::PartExtent;
use super::triangles::{Triangles, bounds_of, reaches};
use super::{Probe, Structure, Tree, Visitor, space_step};
use crate::trace::{Passed, Step};
use crate::{Cached, Execution, Session};
use std::collections::HashMap;
use std::sync::Arc;
use vitral_exec::{Budget, Limit, Workers};
use vitral_math::Vec3;

/// Cells with at most so many triangles are not cut.
const LEAF: usize = 2;
/// Cells are not cut more often than this.
const DEPTH: usize = 48;
/// Planes that are tried across an axis, less one.
const BINS: usize = 32;
/// The cost of going through a node, in triangle tests.
const VISIT: f32 = 1.0;
/// What the triangles cost where the other side is empty, as a part of what they would.
const EMPTY_SIDE: f32 = 0.8;
/// Entries of leaves for each triangle, at most, on the whole.
pub const REFERENCES: usize = 8;
/// Cells with more triangles have their sides built at the same time, and ask the budget.
const LARGE: usize = 4096;
/// One side waits at each level, at most.
const STACK: usize = DEPTH + 2;
/// In place of an axis.
const NO_AXIS: u32 = 3;

/// A plane and what is on its sides, or the entries of a leaf.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Node {
    /// The axis that the plane is across; [`NO_AXIS`] for a leaf.
    axis: u32,
    /// Where the plane is on it.
    at: f32,
    /// Distance to the node of the upper side (that of the lower one is the next); the first entry
    /// of a leaf.
    link: u32,
    /// A leaf's entries.
    count: u32,
}

/// Least and largest coordinates of a cell.
type Cell = [Vec3; 2];

/// See the module.
#[derive(Clone, Debug, PartialEq)]
pub struct KdTree {
    /// Least and largest coordinates of the root.
    root: Cell,
    /// How much cells overlap, to each side of a plane, so that rounding lets nothing slip through.
    slack: f32,
    nodes: Vec<Node>,
    /// Places of triangles, leaf by leaf.
    entries: Vec<u32>,
    triangles: Arc<Triangles>,
}

/// A part of the tree while it is built; its node 0 is its root.
#[derive(Default)]
struct Part {
    nodes: Vec<Node>,
    entries: Vec<u32>,
}

/// What the whole tree shares.
struct Build<'a> {
    triangles: &'a Triangles,
    slack: f32,
    workers: &'a Workers,
    budget: &'a Budget,
}

impl Cached for KdTree {
    type Key = ();
}

impl KdTree {
    /// The session's, built when first asked for: the views of a turntable share it.
    ///
    /// # Errors
    /// A limit of the budget.
    pub fn of(session: &Session, execution: &Execution) -> Result<Arc<Self>, Limit> {
        let triangles = Triangles::of(session, execution)?;
        session
            .cache
            .get_or_build((), || Self::build(&triangles, &execution.workers, &execution.budget))
    }

    /// Bytes needed while a tree over this many triangles is built.
    pub fn bytes(triangles: u64) -> u64 {
        // Entries twice, while parts are joined; a leaf has one at least or is the other side of a
        // cut.
        triangles * (REFERENCES * 8 + size_of::<Node>() * 4 * 2 + 40) as u64
    }

    /// Builds the tree. The result does not depend on the number of workers.
    ///
    /// # Errors
    /// A limit of the budget.
    pub fn build(
        triangles: &Arc<Triangles>,
        workers: &Workers,
        budget: &Budget,
    ) -> Result<Self, Limit> {
        budget.check("building the partition of space")?;
        let count = triangles.count();
        let root = if count > 0 { triangles.bounds() } else { [Vec3::ZERO; 2] };
        let slack = triangles.extent * (1.0 / (1 << 19) as f32);
        let build = Build { triangles, slack, workers, budget };
        let mut part = Part::default();
        build.grow((0..count as u32).collect(), root, (0, REFERENCES * count), &mut part)?;
        let root = widened(root, slack);
        Ok(Self {
            root,
            slack,
            nodes: part.nodes,
            entries: part.entries,
            triangles: Arc::clone(triangles),
        })
    }
}

fn widened([min, max]: Cell, slack: f32) -> Cell {
    [min - slack, max + slack]
}

/// The cells below and above a plane; each reaches beyond it by `slack`.
#[inline(always)]
fn sides(cell: Cell, axis: usize, at: f32, slack: f32) -> [Cell; 2] {
    let (mut lower, mut upper) = (cell, cell);
    lower[1][axis] = at + slack;
    upper[0][axis] = at - slack;
    [lower, upper]
}

/// Half the surface of a box.
fn area(size: Vec3) -> f32 {
    size.x * size.y + size.y * size.z + size.z * size.x
}

impl Build<'_> {
    /// Adds the tree in `cell`, into which `inside` reach. It is cut so often already, and its
    /// leaves may have so many entries.
    fn grow(
        &self,
        inside: Vec<u32>,
        cell: Cell,
        (depth, allowance): (usize, usize),
        part: &mut Part,
    ) -> Result<(), Limit> {
        // Choose a plane, unless the cell is small or deep enough.
        let large = inside.len() > LARGE;
        if large {
            self.budget.check("building the partition of space")?;
        }
        let plane =
            (inside.len() > LEAF && depth < DEPTH).then(|| self.plane(&inside, cell)).flatten();
        let cut = plane.map(|(axis, at)| (axis, at, sides(cell, axis, at, 0.0)));
        let cut = cut.map(|(axis, at, cells)| {
            (axis, at, cells, cells.map(|cell| self.within(&inside, cell)))
        });

        // Emit a leaf where no plane pays within the allowance.
        let Some((axis, at, cells, [lower, upper])) =
            cut.filter(|(.., [lower, upper])| lower.len() + upper.len() <= allowance)
        else {
            let (link, count) = (part.entries.len() as u32, inside.len() as u32);
            part.nodes.push(Node { axis: NO_AXIS, at: 0.0, link, count });
            part.entries.extend(inside);
            return Ok(());
        };
        drop(inside);

        // Each side gets its share of the allowance.
        let both = (lower.len() + upper.len()).max(1) as u128;
        let share = (allowance as u128 * lower.len() as u128 / both) as usize;
        let (below, above) = ((depth + 1, share), (depth + 1, allowance - share));

        // Emit the node, then both children: large ones on two threads.
        let root = part.nodes.len();
        part.nodes.push(Node { axis: axis as u32, at, link: 0, count: 0 });
        if large {
            let alone = |inside, cell, limits| {
                let mut part = Part::default();
                self.grow(inside, cell, limits, &mut part).map(|()| part)
            };
            let (lower, upper) = self
                .workers
                .join(|| alone(lower, cells[0], below), || alone(upper, cells[1], above));
            part.append(lower?);
            part.nodes[root].link = (part.nodes.len() - root) as u32;
            part.append(upper?);
        } else {
            self.grow(lower, cells[0], below, part)?;
            part.nodes[root].link = (part.nodes.len() - root) as u32;
            self.grow(upper, cells[1], above, part)?;
        }
        Ok(())
    }

    /// Those that reach into a cell.
    fn within(&self, inside: &[u32], cell: Cell) -> Vec<u32> {
        let [min, max] = widened(cell, self.slack);
        let (middle, half) = ((min + max) * 0.5, (max - min) * 0.5);
        let reaches =
            |&&place: &&u32| reaches(&self.triangles.corners[place as usize], middle, half);
        inside.iter().filter(reaches).copied().collect()
    }

    /// The cheapest plane, if any is cheaper than a leaf: its axis, and where it is on that.
    fn plane(&self, inside: &[u32], [min, max]: Cell) -> Option<(usize, f32)> {
        // The boxes of what is in the cell, and what is empty round them.
        let boxes: Vec<Cell> = inside
            .iter()
            .map(|&place| bounds_of(&self.triangles.corners[place as usize]))
            .map(|[least, most]| [least.clamp(min, max), most.clamp(min, max)])
            .collect();

        // Bound the contents.
        let [least, most] = boxes.iter().fold([max, min], |[l, m], b| [l.min(b[0]), m.max(b[1])]);
        let count = boxes.len() as u32;
        let mut planes = Planes::new([min, max], count);
        for axis in 0..3 {
            // Cut off what is empty, if it is more than what cells overlap by.
            let (low, high) = (least[axis] - 2.0 * self.slack, most[axis] + 2.0 * self.slack);
            if low - min[axis] > 4.0 * self.slack {
                planes.consider(axis, low, [0, count]);
            }
            if max[axis] - high > 4.0 * self.slack {
                planes.consider(axis, high, [count, 0]);
            }

            // Count who begins and who ends in each bin, and try the borders between bins.
            let width = (most[axis] - least[axis]) / BINS as f32;
            if width <= 4.0 * self.slack {
                continue;
            }
            let bin = |p: f32| (((p - least[axis]) / width) as usize).min(BINS - 1);
            let (mut begin, mut end) = ([0u32; BINS], [0u32; BINS]);
            for [least, most] in &boxes {
                begin[bin(least[axis])] += 1;
                end[bin(most[axis])] += 1;
            }
            let (mut lower, mut upper) = (0, count);
            for plane in 1..BINS {
                lower += begin[plane - 1];
                upper -= end[plane - 1];
                planes.consider(axis, least[axis] + width * plane as f32, [lower, upper]);
            }
        }
        planes.cheapest
    }
}

/// The planes that a cell might be cut by, and the cheapest so far.
struct Planes {
    min: Vec3,
    max: Vec3,
    /// Half the surface of the whole cell; sizes are relative to its longest side.
    whole: f32,
    cost: f32,
    /// Its axis, and where it is on that; `None` if a leaf is cheaper.
    cheapest: Option<(usize, f32)>,
}

impl Planes {
    /// None yet, of a cell with `count` triangles.
    fn new([min, max]: Cell, count: u32) -> Self {
        let size = max - min;
        let whole = area(size * (1.0 / size.max_element()));
        Self { min, max, whole, cost: count as f32, cheapest: None }
    }

    /// Considers a plane with so many triangles below and above.
    fn consider(&mut self, axis: usize, at: f32, [lower, upper]: [u32; 2]) {
        let size = self.max - self.min;
        let scale = 1.0 / size.max_element();
        let side = |extent: f32| {
            let mut side = size;
            side[axis] = extent;
            area(side * scale)
        };
        let triangles =
            side(at - self.min[axis]) * lower as f32 + side(self.max[axis] - at) * upper as f32;
        let empty = if lower == 0 || upper == 0 { EMPTY_SIDE } else { 1.0 };
        let cost = VISIT + empty * triangles / self.whole;
        if cost < self.cost {
            (self.cost, self.cheapest) = (cost, Some((axis, at)));
        }
    }
}

impl Part {
    fn append(&mut self, other: Self) {
        let first = self.entries.len() as u32;
        self.entries.extend(other.entries);
        self.nodes.extend(other.nodes.into_iter().map(|node| match node.axis {
            NO_AXIS => Node { link: node.link + first, ..node },
            _ => node,
        }));
    }
}

impl KdTree {
    /// A leaf's entries.
    fn entries_of(&self, node: &Node) -> &[u32] {
        &self.entries[node.link as usize..(node.link + node.count) as usize]
    }
}

impl Follow for KdTree {
    fn lend<U: StructureUser>(&self, user: U) -> U::Outcome {
        user.with_tree(self)
    }
}

impl Structure for KdTree {
    const REPEATS: bool = true;

    fn triangles(&self) -> &Triangles {
        &self.triangles
    }

    fn largest(&self, value: &dyn Fn(usize) -> f32) -> Vec<f32> {
        let mut values = vec![f32::NEG_INFINITY; self.nodes.len()];
        // Sides stand behind their node.
        for (i, node) in self.nodes.iter().enumerate().rev() {
            values[i] = if node.axis == NO_AXIS {
                let entries = self.entries_of(node).iter();
                entries.map(|&place| value(place as usize)).fold(f32::NEG_INFINITY, f32::max)
            } else {
                values[i + 1].max(values[i + node.link as usize])
            };
        }
        values
    }

    fn step(&self) -> Option<Step> {
        (self.triangles.count() > 0).then(|| space_step(&self.triangles, self.root, None))
    }

    fn names(&self, parts: &[u32]) -> Passed {
        Passed::Nodes(parts.to_vec())
    }

    fn part_count(&self) -> u32 {
        self.nodes.len() as u32
    }

    fn extents(&self, parts: &[u32]) -> Vec<PartExtent> {
        // Each node's plane cuts its cell into those of its sides.
        let mut cells = HashMap::from([(0, (None, self.root))]);
        let extent = |&part: &u32| {
            let (above, cell) = cells[&part];
            let node = &self.nodes[part as usize];
            if node.axis != NO_AXIS {
                let below = [part + 1, part + node.link];
                let sides = sides(cell, node.axis as usize, node.at, self.slack);
                cells.extend(below.into_iter().zip(sides.map(|side| (Some(part), side))));
            }
            PartExtent::of_box(above, cell, self.triangles.center)
        };
        parts.iter().map(extent).collect()
    }

    fn traverse(&self, beam: &Beam, visitor: &mut impl Visitor) -> u64 {
        self.descend(beam, visitor)
    }
}

impl Tree for KdTree {
    fn root(&self) -> Option<[[f32; 3]; 2]> {
        (self.triangles.count() > 0).then(|| self.root.map(|p| p.to_array()))
    }

    /// The nearer side comes first.
    #[inline(always)]
    fn descend_from(&self, near: f32, probe: &impl Probe, visitor: &mut impl Visitor) -> u64 {
        // Begin with the root.
        let mut visited = 0;
        let mut stack = [(0, 0.0f32, [Vec3::ZERO; 2]); STACK];
        let mut top = 1;
        stack[0] = (0, near, self.root);

        // Descend, nearest first, until nothing waits.
        while top > 0 {
            top -= 1;
            let (index, near, cell) = stack[top];
            if visitor.skips(index, near) {
                continue;
            }
            visitor.passes(index);
            let node = &self.nodes[index];

            // Visit the triangles of a leaf.
            if node.axis == NO_AXIS {
                self.entries_of(node).iter().for_each(|&place| visitor.triangle(place as usize));
                continue;
            }

            // Find where the ray enters the two children.
            let cells = sides(cell, node.axis as usize, node.at, self.slack);
            let below = [index + 1, index + node.link as usize];
            let mut enters = [None; 2];
            for side in 0..2 {
                let Node { axis, count, .. } = self.nodes[below[side]];
                if axis != NO_AXIS || count > 0 {
                    visited += 1;
                    enters[side] =
                        probe.enters(cells[side][0].to_array(), cells[side][1].to_array());
                }
            }
            // The farther one waits below the nearer one.
            let upper_first = matches!(enters, [Some(lower), Some(upper)] if upper < lower);
            for side in if upper_first { [0, 1] } else { [1, 0] } {
                if let Some(near) = enters[side] {
                    stack[top] = (below[side], near, cells[side]);
                    top += 1;
                }
            }
        }
        visited
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::vec3;
    use vitral_scene::{World, builtin};

    fn build(triangles: Triangles, threads: usize) -> KdTree {
        KdTree::build(&Arc::new(triangles), &Workers::new(threads), &Budget::default()).unwrap()
    }

    #[test]
    fn planes_cut_off_empty_space_and_separate_what_is_apart() {
        // Two clusters at the ends of a long box.
        let small = |x: f32, i: u32| {
            let at = vec3(x, 0.1 * i as f32, 0.0);
            [at, at + vec3(0.1, 0.0, 0.0), at + vec3(0.0, 0.05, 0.1)]
        };
        let corners: Vec<_> = (0..8).flat_map(|i| [small(-10.0, i), small(10.0, i)]).collect();
        let triangles =
            Triangles { extent: 10.1, facets: (0..16).collect(), corners, ..Triangles::default() };
        let tree = build(triangles, 1);
        assert_eq!(tree.nodes[0].axis, 0, "{:?}", tree.nodes[0]);
        assert!(tree.nodes[0].at > -9.9 && tree.nodes[0].at < 10.0, "{:?}", tree.nodes[0]);
        assert!(tree.nodes.iter().any(|n| n.axis == NO_AXIS && n.count == 0), "some cell is empty");
        assert!(tree.entries.len() < 24, "{} entries of 16 triangles", tree.entries.len());
    }

    #[test]
    fn every_triangle_is_in_the_leaves_it_reaches_and_entries_are_bounded() {
        let world = World::new(&builtin::scene("teapot").unwrap()).unwrap();
        let trees = [1, 3]
            .map(|threads| build(Triangles::of_world(&world, &Workers::new(threads)), threads));
        assert!(trees[0] == trees[1], "threads change nothing");
        let tree = &trees[0];
        let count = tree.triangles.count();
        assert!(tree.nodes.len() > count / 4 && tree.entries.len() <= REFERENCES * count);
        let mut listed = vec![false; count];
        tree.entries.iter().for_each(|&t| listed[t as usize] = true);
        assert!(listed.iter().all(|&l| l));
        // Go down to each leaf: no corner strictly within its cell is of a triangle that it does
        // not list.
        let mut cells = vec![(0, tree.root)];
        while let Some((index, cell)) = cells.pop() {
            let node = &tree.nodes[index];
            if node.axis != NO_AXIS {
                let [lower, upper] = sides(cell, node.axis as usize, node.at, 0.0);
                cells.extend([(index + 1, lower), (index + node.link as usize, upper)]);
                continue;
            }
            let within = |p: &Vec3| p.cmpgt(cell[0]).all() && p.cmplt(cell[1]).all();
            for (t, corners) in (0..).zip(&tree.triangles.corners) {
                assert!(
                    !corners.iter().any(within) || tree.entries_of(node).contains(&t),
                    "{t} in {cell:?}"
                );
            }
        }
    }

    #[test]
    fn what_no_plane_separates_stays_together() {
        let fan =
            |i: u16| [Vec3::ZERO, vec3(1.0, f32::from(i), 0.0), vec3(1.0, f32::from(i) + 1.0, 0.5)];
        let corners = (0..400).map(fan).collect();
        let tree = build(
            Triangles {
                extent: 500.0,
                corners,
                facets: (0..400).collect(),
                ..Triangles::default()
            },
            1,
        );
        assert!(tree.entries.len() <= REFERENCES * 400, "{} entries", tree.entries.len());
        let same = vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 300];
        let tree = build(
            Triangles {
                extent: 1.0,
                corners: same,
                facets: (0..300).collect(),
                ..Triangles::default()
            },
            1,
        );
        assert!(tree.nodes.len() < 8, "{:?}", tree.nodes);
        let none = build(Triangles::default(), 1);
        assert!(none.root().is_none() && none.step().is_none());
    }
}
