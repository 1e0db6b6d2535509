//! A cube round the scene, cut in eight where there is much, and its parts again.
//!
//! Unlike a tree of boxes round triangles, an octree divides *space*: the eight children of a cell
//! fill it and do not overlap, so a ray passes them one after the other. A triangle belongs to
//! every leaf it reaches into; a visitor may see it several times. Empty cells cost nothing but
//! their test. A cell is cut while more than a few triangles reach into it, unless its children
//! together would hold many more than it does: no cut separates triangles that share a vertex.
//!
//! Whether a triangle reaches into a cell is asked of its box and of its plane. A needle that lies
//! aslant may be listed in cells that it only passes by, which costs a test and is not wrong.
//!
//! In:   triangles. Out: [`Octree`].
//! Cost: `O(n log n)` to build; at most [`REFERENCES`] entries a triangle, whatever the scene.
//! Source: [Glassner 1984]. Departs from it: children are found through their parent, not by a hash
//!         of their names, and tested against the ray one by one, since a beam of rays may be as
//!         wide as a block of pixels.

use super::beam::Beam;
use super::follow::{Follow, StructureUser};
use super::path::PartExtent;
use super::triangles::{Triangles, reaches};
use super::{Probe, Structure, Tree, Visitor, space_step};
use crate::trace::{Passed, Step};
use crate::{Cached, Execution, Session};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};
use vitral_exec::{Budget, Limit, Workers};
use vitral_math::Vec3;

/// Cells with at most so many triangles are not cut.
const LEAF: usize = 8;
/// Cells are not cut more often than this.
const DEPTH: usize = 20;
/// A cell is cut only if its children hold at most so many times its triangles.
const GROWTH: usize = 3;
/// Entries of leaves for each triangle, at most, on the whole.
pub const REFERENCES: usize = 8;
/// Cells with more triangles have their children built at the same time, and ask the budget.
const LARGE: usize = 4096;
/// Seven brothers wait at each level, at most.
const STACK: usize = DEPTH * 7 + 8;

/// A node of the tree: a cube with eight children, or a leaf with triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cell {
    /// Lower corner of its box, scene less its middle.
    min: [f32; 3],
    /// Upper corner of its box.
    max: [f32; 3],
    /// First of eight children, or 0 for a leaf: the root is nobody's child.
    children: u32,
    /// A leaf's entries.
    first: u32,
    count: u32,
}

/// See the module.
#[derive(Clone, Debug, PartialEq)]
pub struct Octree {
    cells: Vec<Cell>,
    /// Places of triangles, leaf by leaf.
    entries: Vec<u32>,
    triangles: Arc<Triangles>,
}

/// A part of the tree while it is built; its cell 0 is its root.
#[derive(Default)]
struct Part {
    cells: Vec<Cell>,
    entries: Vec<u32>,
}

/// A cube by its middle and half its side.
#[derive(Clone, Copy, Debug)]
struct Cube {
    middle: Vec3,
    /// Half its side.
    half: f32,
}

impl Cube {
    /// Whether the triangle reaches into the cube, widened by `slack`.
    fn holds(self, corners: &[Vec3; 3], slack: f32) -> bool {
        reaches(corners, self.middle, Vec3::splat(self.half + slack))
    }

    fn child(self, i: usize) -> Self {
        let half = self.half * 0.5;
        let side = |bit: usize| if i >> bit & 1 == 1 { half } else { -half };
        Self { middle: self.middle + Vec3::new(side(0), side(1), side(2)), half }
    }

    /// A cell of this cube, wider by what rounding may do to it.
    fn cell(self, slack: f32) -> Cell {
        let half = self.half + slack;
        let (min, max) = ((self.middle - half).to_array(), (self.middle + half).to_array());
        Cell { min, max, children: 0, first: 0, count: 0 }
    }
}

/// What the whole tree shares.
struct Build<'a> {
    triangles: &'a Triangles,
    slack: f32,
    workers: &'a Workers,
    budget: &'a Budget,
}

impl Cached for Octree {
    type Key = ();
}

impl Octree {
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
        // Entries twice, while parts are joined; and about as many cells as leaves can fill.
        triangles * (REFERENCES * 8 + size_of::<Cell>() * 2 + 40) as u64
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
        budget.check("building the octree")?;
        let count = triangles.count();
        let [min, max] = if count > 0 { triangles.bounds() } else { [Vec3::ZERO; 2] };
        let cube = Cube { middle: (min + max) * 0.5, half: (max - min).max_element() * 0.5 };
        let slack = triangles.extent * (1.0 / (1 << 19) as f32);
        let build = Build { triangles, slack, workers, budget };
        let part = build.part((0..count as u32).collect(), cube, 0, REFERENCES * count)?;
        Ok(Self { cells: part.cells, entries: part.entries, triangles: Arc::clone(triangles) })
    }
}

impl Build<'_> {
    /// The tree in `cube`, into which `inside` reach; its leaves may have `allowance` entries.
    fn part(
        &self,
        inside: Vec<u32>,
        cube: Cube,
        depth: usize,
        allowance: usize,
    ) -> Result<Part, Limit> {
        // Emit a leaf for few triangles, at the greatest depth, or where overlap would outgrow the
        // cell.
        let leaf = |inside: Vec<u32>| Part {
            cells: vec![Cell { count: inside.len() as u32, ..cube.cell(self.slack) }],
            entries: inside,
        };
        if inside.len() <= LEAF || depth == DEPTH || cube.half <= self.slack * 4.0 {
            return Ok(leaf(inside));
        }
        let large = inside.len() > LARGE;
        if large {
            self.budget.check("building the octree")?;
        }
        // Sort what is inside into the children.
        let child = |i: usize| -> Vec<u32> {
            let cube = cube.child(i);
            let holds = |&&t: &&u32| cube.holds(&self.triangles.corners[t as usize], self.slack);
            inside.iter().filter(holds).copied().collect()
        };
        let children = if large { self.workers.map(8, child) } else { (0..8).map(child).collect() };
        let total: usize = children.iter().map(Vec::len).sum();

        // Emit a leaf, too, where children would hold too many entries.
        if total > allowance.min(inside.len() * GROWTH) {
            return Ok(leaf(inside));
        }
        drop(inside);
        // Each gets its share of the allowance.
        let grow = |(i, inside): (usize, Vec<u32>)| {
            let share = (allowance as u128 * inside.len() as u128 / total.max(1) as u128) as usize;
            self.part(inside, cube.child(i), depth + 1, share)
        };
        let children: Vec<_> = children.into_iter().enumerate().collect();
        let parts: Vec<Result<Part, Limit>> = if large {
            let slots: Vec<_> = children.into_iter().map(|c| Mutex::new(Some(c))).collect();
            let take = |i: usize| {
                slots[i]
                    .lock()
                    .expect("no thread panics while it takes")
                    .take()
                    .expect("taken once")
            };
            self.workers.map(8, |i| grow(take(i)))
        } else {
            children.into_iter().map(grow).collect()
        };

        // Put the children's trees under this cell.
        join(cube.cell(self.slack), parts)
    }
}

/// Puts eight children under a cell: their roots in a row behind it, then what is below them.
fn join(root: Cell, parts: Vec<Result<Part, Limit>>) -> Result<Part, Limit> {
    // Reserve room and emit the root.
    let parts = parts.into_iter().collect::<Result<Vec<_>, _>>()?;
    let count = 1 + parts.iter().map(|p| p.cells.len()).sum::<usize>();
    let mut all = Part { cells: Vec::with_capacity(count), entries: Vec::new() };
    all.cells.push(Cell { children: 1, ..root });
    let mut below = 1 + parts.len();

    // Move a cell's indices to where its part comes to stand.
    let moved = |cell: &Cell, below: usize, first: usize| Cell {
        // A part's own cells from 1 on come to stand at `below`.
        children: if cell.children == 0 { 0 } else { cell.children - 1 + below as u32 },
        first: cell.first + first as u32,
        ..*cell
    };

    // Emit the roots of the parts in a row, then everything below them.
    let mut first = 0;
    for part in &parts {
        all.cells.push(moved(&part.cells[0], below, first));
        (below, first) = (below + part.cells.len() - 1, first + part.entries.len());
    }
    let mut below = 1 + parts.len();
    for part in parts {
        let first = all.entries.len();
        all.cells.extend(part.cells[1..].iter().map(|cell| moved(cell, below, first)));
        all.entries.extend(&part.entries);
        below += part.cells.len() - 1;
    }
    Ok(all)
}

impl Follow for Octree {
    fn lend<U: StructureUser>(&self, user: U) -> U::Outcome {
        user.with_tree(self)
    }
}

impl Structure for Octree {
    const REPEATS: bool = true;

    fn triangles(&self) -> &Triangles {
        &self.triangles
    }

    fn largest(&self, value: &dyn Fn(usize) -> f32) -> Vec<f32> {
        let mut values = vec![f32::NEG_INFINITY; self.cells.len()];
        // Children stand behind their parent.
        for (i, cell) in self.cells.iter().enumerate().rev() {
            values[i] = if cell.children == 0 {
                let entries =
                    &self.entries[cell.first as usize..(cell.first + cell.count) as usize];
                entries.iter().map(|&place| value(place as usize)).fold(f32::NEG_INFINITY, f32::max)
            } else {
                let first = cell.children as usize;
                values[first..first + 8].iter().copied().fold(f32::NEG_INFINITY, f32::max)
            };
        }
        values
    }

    fn step(&self) -> Option<Step> {
        let [min, max] = self.root()?.map(Vec3::from_array);
        Some(space_step(&self.triangles, [min, max], None))
    }

    fn names(&self, parts: &[u32]) -> Passed {
        // The names of cells by the first of their children.
        let mut parents: BTreeMap<u32, String> = BTreeMap::new();
        let name = |&part: &u32| {
            let name = match parents.range(..=part).next_back() {
                Some((first, parent)) => format!("{parent}{}", part - first),
                None => String::new(),
            };
            let children = self.cells[part as usize].children;
            if children > 0 {
                parents.insert(children, name.clone());
            }
            name
        };
        Passed::Octants(parts.iter().map(name).collect())
    }

    fn part_count(&self) -> u32 {
        self.cells.len() as u32
    }

    fn extents(&self, parts: &[u32]) -> Vec<PartExtent> {
        // Cells by the first of their children.
        let mut parents: BTreeMap<u32, u32> = BTreeMap::new();
        let extent = |&part: &u32| {
            let above = parents.range(..=part).next_back().map(|(_, &parent)| parent);
            let Cell { min, max, children, .. } = self.cells[part as usize];
            if children > 0 {
                parents.insert(children, part);
            }
            PartExtent::of_box(above, [min, max].map(Vec3::from_array), self.triangles.center)
        };
        parts.iter().map(extent).collect()
    }

    fn traverse(&self, beam: &Beam, visitor: &mut impl Visitor) -> u64 {
        self.descend(beam, visitor)
    }
}

impl Tree for Octree {
    fn root(&self) -> Option<[[f32; 3]; 2]> {
        self.cells.first().map(|root| [root.min, root.max])
    }

    /// The nearest child comes first.
    #[inline(always)]
    fn descend_from(&self, near: f32, probe: &impl Probe, visitor: &mut impl Visitor) -> u64 {
        // Begin with the root.
        let mut visited = 0;
        let mut stack = [(0u32, 0.0f32); STACK];
        let mut top = 1;
        stack[0] = (0, near);

        // Descend, nearest first, until nothing waits.
        while top > 0 {
            top -= 1;
            let (index, near) = (stack[top].0 as usize, stack[top].1);
            if visitor.skips(index, near) {
                continue;
            }
            visitor.passes(index);
            let cell = &self.cells[index];
            // Visit the triangles of a leaf.
            if cell.children == 0 {
                let entries =
                    &self.entries[cell.first as usize..(cell.first + cell.count) as usize];
                for &place in entries {
                    visitor.triangle(place as usize);
                }
                continue;
            }
            // Put the children that are met on the stack, the farthest lowest.
            let bottom = top;
            for child in cell.children as usize..cell.children as usize + 8 {
                let Cell { min, max, children, count, .. } = self.cells[child];
                if children == 0 && count == 0 {
                    continue;
                }
                visited += 1;
                let Some(near) = probe.enters(min, max) else { continue };
                let mut at = top;
                while at > bottom && stack[at - 1].1 < near {
                    stack[at] = stack[at - 1];
                    at -= 1;
                }
                stack[at] = (child as u32, near);
                top += 1;
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

    #[test]
    fn a_triangle_reaches_into_the_cells_that_it_touches() {
        let cube = Cube { middle: Vec3::ZERO, half: 1.0 };
        let inside = [vec3(0.1, 0.1, 0.1), vec3(0.2, 0.1, 0.1), vec3(0.1, 0.2, 0.3)];
        assert!(cube.holds(&inside, 0.0));
        assert!((0..8).filter(|&i| cube.child(i).holds(&inside, 0.0)).eq([7]));
        let corner_cut = [vec3(4.0, 0.0, 0.0), vec3(0.0, 4.0, 0.0), vec3(0.0, 0.0, 4.0)];
        assert!(
            !cube.holds(&corner_cut, 0.0),
            "its box reaches in, its plane x + y + z = 4 does not"
        );
        assert!(cube.holds(&corner_cut.map(|p| p * 0.7), 0.0));
    }

    #[test]
    fn every_triangle_is_in_the_leaves_it_reaches_and_entries_are_bounded() {
        let world = World::new(&builtin::scene("teapot").unwrap()).unwrap();
        let trees = [1, 3].map(|threads| {
            let workers = Workers::new(threads);
            Octree::build(
                &Arc::new(Triangles::of_world(&world, &workers)),
                &workers,
                &Budget::default(),
            )
            .unwrap()
        });
        assert!(trees[0] == trees[1], "threads change nothing");
        let tree = &trees[0];
        let count = tree.triangles.count();
        assert!(tree.cells.len() > count / 8 && tree.entries.len() <= REFERENCES * count);
        let mut listed = vec![false; count];
        tree.entries.iter().for_each(|&t| listed[t as usize] = true);
        assert!(listed.iter().all(|&l| l));
        for cell in tree.cells.iter().filter(|c| c.children == 0) {
            let [min, max] = [cell.min, cell.max].map(Vec3::from_array);
            let cube = Cube { middle: (min + max) * 0.5, half: (max.x - min.x) * 0.49 };
            let entries = &tree.entries[cell.first as usize..(cell.first + cell.count) as usize];
            for (t, corners) in (0..).zip(&tree.triangles.corners) {
                assert!(
                    !corners.iter().any(|p| (*p - cube.middle).abs().max_element() < cube.half)
                        || entries.contains(&t)
                );
            }
        }
    }

    #[test]
    fn triangles_that_no_cut_separates_stay_together() {
        let fan =
            |i: u16| [Vec3::ZERO, vec3(1.0, f32::from(i), 0.0), vec3(1.0, f32::from(i) + 1.0, 0.5)];
        let triangles = Arc::new(Triangles {
            extent: 500.0,
            corners: (0..400).map(fan).collect(),
            facets: (0..400).collect(),
            ..Triangles::default()
        });
        let tree = Octree::build(&triangles, &Workers::single(), &Budget::default()).unwrap();
        assert!(tree.entries.len() <= REFERENCES * 400, "{} entries", tree.entries.len());
        let empty = Octree::build(&Arc::default(), &Workers::single(), &Budget::default()).unwrap();
        assert_eq!((empty.cells.len(), empty.entries.len()), (1, 0));
    }
}
