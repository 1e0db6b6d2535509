//! Building a BSP tree, and walking it.
//!
//! A set of polygons is cut by a plane into those in front, those behind and those in the plane;
//! polygons that cross it are split. Sets of many polygons are first halved by a plane across an
//! axis, through a corner in the middle: it crosses few polygons of a surface, and the tree gets
//! shallow. Small sets take the plane of one of their polygons: several are tried on a sample of
//! the set, and the one that splits least and halves best is taken.
//!
//! Planes are thick. A corner that is off the plane by no more than positions are rounded lies in
//! it, so faces that were meant to be coplanar do not split one another, and the rounding of split
//! corners never turns a side over. Thickness is some 2^-21 of the numbers that enter the distance,
//! rounding of `f64` some 2^-50: a side that is told is certain. The plane of a needle, whose
//! normal is uncertain, is replaced by one along its longest edge. The polygon that gave the plane
//! is always in it. So each node consumes a polygon or halves the set, and the build ends.
//!
//! Polygons whose facets share a plane of the world lie in one node, however their corners were
//! rounded. A node keeps those that face the front apart from those that face the back: of two in
//! one plane, the one that faces the viewer is nearer.
//!
//! A fragment keeps the planes that cut it and that it is near to. Those that stay clear of it are
//! implied by the others but for rounding; should that move a sample across one, two fragments hold
//! the sample, never none.
//!
//! In:   the world's polygons, world space. Out: nodes, and fragments: polygons with the planes
//!       that cut them.
//! Cost: `O(n log n)` until sets are small, if planes split few polygons; `O(n^2)` fragments for
//!       the worst scenes.
//! Source: [Fuchs, Kedem & Naylor 1980]; axis planes first after [Paterson & Yao 1990], who also
//!         bound the size.

mod plane;
mod report;

use super::polygons::{PolygonFacets, WorldPolygons};
use crate::Execution;
use plane::{BspSide, ThickPlane, side_of};
use std::ops::Range;
use vitral_exec::Limit;
use vitral_math::{DVec3, DVec4};
use vitral_scene::{SharedPlanes, World};

/// Sets of fewer polygons are cut by planes of their polygons.
const SMALL: usize = 24;
/// How many splitters are tried.
const CANDIDATES: usize = 8;
/// On how many polygons they are tried.
const TRIED_ON: usize = 64;
/// What a split costs, in polygons of imbalance.
const SPLIT_COST: usize = 6;
/// Eighths of the set that an axis plane may leave on one side at most; a plane that halves worse
/// is not used.
const WORST_HALF: usize = 6;
/// Pieces of work that the set is divided into before threads share them.
const JOBS: usize = 64;
/// A cut is forgotten if all of a fragment is farther from it than this part of the fragment's
/// size.
const CLEAR: f64 = 0.125;
/// No node; no cut.
const NONE: u32 = u32::MAX;
/// Marks a cut of the part of the tree that was built before the jobs.
const OUTER: u32 = 1 << 31;

/// A node of the tree.
#[derive(Clone, Debug)]
struct Node {
    plane: DVec4,
    front: u32,
    back: u32,
    /// The fragments in the plane: those that face the back, then those that face the front, of
    /// each the highest polygon first.
    fragments: Range<u32>,
    /// The first that faces the front.
    facing_front: u32,
    /// The polygon that gave the plane, if one did.
    splitter: u32,
}

/// A polygon, or a part of one.
#[derive(Clone, Copy, Debug)]
struct Fragment {
    polygon: u32,
    /// The planes that cut it off from its surroundings, in the tree's list.
    first_cut: u32,
    cuts: u32,
}

/// A plane that cuts a fragment, and on which side of it that lies.
#[derive(Clone, Copy, Debug)]
struct Cut {
    /// The node with the plane; in a finished tree its number among the cutters.
    node: u32,
    positive: bool,
}

/// One of the planes that cut a part, and the one before.
#[derive(Clone, Copy, Debug)]
struct CutLink {
    cut: Cut,
    before: u32,
}

/// A fragment that is still on its way down.
#[derive(Clone, Copy, Debug)]
struct Part {
    polygon: u32,
    /// The last of the planes that cut it, or none.
    cuts: u32,
    /// Its corners, in the job's list.
    first: u32,
    count: u32,
}

/// A set of parts, and the child of which node it becomes.
struct Task {
    parts: Vec<Part>,
    parent: u32,
    front: bool,
}

/// The tree, or a part of it under construction.
#[derive(Debug, Default)]
pub(crate) struct BspTree {
    nodes: Vec<Node>,
    fragments: Vec<Fragment>,
    cuts: Vec<Cut>,
    /// The planes that cut fragments, in the order of the first: far fewer than nodes.
    cutters: Vec<DVec4>,
    /// The facets of the polygons.
    facets: PolygonFacets,
    /// Polygons without finite corners; on the screen they are nothing, or clipped beyond
    /// recognition.
    loose: Range<u32>,
    splits: u64,
}

impl BspTree {
    /// Builds the tree of all polygons of a world.
    pub(crate) fn of_world(
        world: &World,
        planes: &SharedPlanes,
        execution: &Execution,
    ) -> Result<Self, Limit> {
        let polygons = WorldPolygons::new(world, planes, execution)?;
        let bytes = polygons.bytes();
        let tree = Self::new(polygons, execution);
        execution.budget.release(bytes);
        tree
    }

    /// Builds the tree of polygons.
    fn new(polygons: WorldPolygons, execution: &Execution) -> Result<Self, Limit> {
        let budget = &execution.budget;
        let mut top = Builder::new(&polygons, execution);
        let result = top.of_all(execution);
        budget.release(top.charged);
        result.map(|tree| Self { facets: polygons.facets, ..tree })
    }

    pub(crate) fn node_count(&self) -> u64 {
        self.nodes.len() as u64
    }

    /// How many polygons the fragments are parts of.
    pub(crate) fn polygon_count(&self) -> u64 {
        self.facets.len() as u64
    }

    pub(crate) fn fragment_count(&self) -> u64 {
        self.fragments.len() as u64
    }

    pub(crate) fn splits(&self) -> u64 {
        self.splits
    }

    /// Bytes it takes.
    pub(crate) fn bytes(&self) -> u64 {
        let bytes = size_of_val(self.nodes.as_slice()) + size_of_val(self.fragments.as_slice());
        let bytes =
            bytes + size_of_val(self.cuts.as_slice()) + size_of_val(self.cutters.as_slice());
        bytes as u64 + self.facets.bytes()
    }

    /// The facets of the polygon that a fragment is part of, the lowest first.
    pub(crate) fn facets(&self, fragment: u32) -> &[u32] {
        self.facets.of(self.fragments[fragment as usize].polygon)
    }

    /// The planes that cut fragments, world space.
    pub(crate) fn cutters(&self) -> &[DVec4] {
        &self.cutters
    }

    /// The cutters of a fragment by their numbers, and whether it lies on the positive side of
    /// each.
    pub(crate) fn cuts(&self, fragment: u32) -> impl ExactSizeIterator<Item = (u32, bool)> + '_ {
        let Fragment { first_cut, cuts, .. } = self.fragments[fragment as usize];
        let cuts = &self.cuts[first_cut as usize..][..cuts as usize];
        cuts.iter().map(|cut| (cut.node, cut.positive))
    }

    /// Calls `f` with the fragments from back to front. `viewer` is a homogeneous point: an eye, or
    /// a direction towards it.
    pub(crate) fn back_to_front(&self, viewer: DVec4, mut f: impl FnMut(u32)) {
        self.loose.clone().for_each(&mut f);
        self.walk(viewer, |node, in_front| {
            self.nodes[node as usize].each_fragment(in_front, &mut f)
        });
    }

    /// Calls `f` with the nodes from back to front, and whether the viewer is in front of each.
    fn walk(&self, viewer: DVec4, mut f: impl FnMut(u32, bool)) {
        // A stack of our own: trees may be deep. Nodes wait until all behind them is done.
        let (mut waiting, mut node) = (Vec::new(), if self.nodes.is_empty() { NONE } else { 0 });
        loop {
            while node != NONE {
                let n = &self.nodes[node as usize];
                let in_front = n.plane.dot(viewer) >= 0.0;
                if n.front == NONE && n.back == NONE {
                    // A leaf: its plane divides nothing.
                    f(node, in_front);
                    break;
                }
                let (far, near) = if in_front { (n.back, n.front) } else { (n.front, n.back) };
                waiting.push((node, in_front, near));
                node = far;
            }
            let Some((done, in_front, near)) = waiting.pop() else { return };
            f(done, in_front);
            node = near;
        }
    }
}

impl Node {
    /// Calls `f` with its fragments in the order of the list: those that face away from the viewer
    /// first.
    fn each_fragment(&self, in_front: bool, f: impl FnMut(u32)) {
        let (facing_back, facing_front) =
            (self.fragments.start..self.facing_front, self.facing_front..self.fragments.end);
        let (first, then) =
            if in_front { (facing_back, facing_front) } else { (facing_front, facing_back) };
        first.chain(then).for_each(f);
    }
}

/// Builds a tree, or what hangs below a set of parts.
struct Builder<'t> {
    polygons: &'t WorldPolygons,
    execution: &'t Execution,
    tree: BspTree,
    links: Vec<CutLink>,
    /// The builder of the tree that this is a branch of.
    outer: Option<&'t Builder<'t>>,
    points: Vec<DVec3>,
    /// Bytes charged so far, and the corners that there were then.
    charged: u64,
    accounted: usize,
    /// Workspace: corners of a polygon that is split.
    split: [Vec<DVec3>; 2],
    /// Workspace: where the parts of a set lie, and the planes that those in the node's plane
    /// share.
    sides: Vec<BspSide>,
    coplanar: Vec<u32>,
}

impl<'t> Builder<'t> {
    fn new(polygons: &'t WorldPolygons, execution: &'t Execution) -> Self {
        let (tree, split) = (BspTree::default(), Default::default());
        Self {
            polygons,
            execution,
            tree,
            links: Vec::new(),
            outer: None,
            points: Vec::new(),
            charged: 0,
            accounted: 0,
            split,
            sides: Vec::new(),
            coplanar: Vec::new(),
        }
    }

    /// Begins the tree by axis planes, lets jobs finish its branches, and puts them together.
    fn of_all(&mut self, execution: &Execution) -> Result<BspTree, Limit> {
        let polygons = self.polygons;

        // Collect the polygons, and set those aside that no plane can order.
        let mut parts = Vec::with_capacity(polygons.len());
        for polygon in 0..polygons.len() as u32 {
            let corners = polygons.corners(polygon);
            if corners.iter().all(|p| p.is_finite() && p.abs().max_element() < 1e60) {
                let (first, count) = (self.points.len() as u32, corners.len() as u32);
                parts.push(Part { polygon, cuts: NONE, first, count });
                self.points.extend(corners);
            } else {
                self.tree.fragments.push(Fragment { polygon, first_cut: 0, cuts: 0 });
            }
        }
        self.tree.loose = 0..self.tree.fragments.len() as u32;

        // Cut along axis planes until the sets are small enough for a job.
        execution.budget.begin("polygons", parts.len() as u64);
        let job_size = (parts.len() / JOBS).max(256);
        let mut tasks = vec![Task { parts, parent: NONE, front: true }];
        let mut jobs = Vec::new();
        while let Some(task) = tasks.pop() {
            let plane =
                if task.parts.len() > job_size { self.axis_plane(&task.parts) } else { None };
            match plane {
                Some(plane) => self.cut(task, plane, None, &mut tasks)?,
                None => jobs.push(task),
            }
        }

        // Build all branches in parallel.
        let outer = &*self;
        let branches = execution.workers.map(jobs.len(), |i| {
            let mut builder = Builder { outer: Some(outer), ..Builder::new(polygons, execution) };
            let done = builder.branch(&jobs[i].parts, &outer.points);
            execution.budget.release(builder.charged);
            done.map(|()| builder.tree)
        });

        // Attach the branches to the top of the tree.
        let mut tree = std::mem::take(&mut self.tree);
        for (job, branch) in jobs.iter().zip(branches) {
            tree.attach(job, branch?);
        }
        tree.number_cutters();
        Ok(tree)
    }

    /// Builds what hangs below a job's set.
    fn branch(&mut self, parts: &[Part], points: &[DVec3]) -> Result<(), Limit> {
        // Copy the parts' corners, which belong to the outer builder.
        let own = |part: &Part| {
            let first = self.points.len() as u32;
            self.points.extend(&points[part.first as usize..][..part.count as usize]);
            let cuts = if part.cuts == NONE { NONE } else { part.cuts | OUTER };
            Part { first, cuts, ..*part }
        };

        // Cut large sets along axis planes and small ones along one of their own.
        let mut tasks =
            vec![Task { parts: parts.iter().map(own).collect(), parent: NONE, front: true }];
        while let Some(task) = tasks.pop() {
            if task.parts.is_empty() {
                continue;
            }
            let axis = if task.parts.len() >= SMALL { self.axis_plane(&task.parts) } else { None };
            match axis {
                Some(plane) => self.cut(task, plane, None, &mut tasks)?,
                None => {
                    let splitter = self.splitter(&task.parts);
                    let plane = self.plane_of(&task.parts[splitter]);
                    self.cut(task, plane, Some(splitter), &mut tasks)?;
                }
            }
        }
        Ok(())
    }

    fn points_of(&self, part: &Part) -> &[DVec3] {
        points_of(&self.points, part)
    }

    fn plane_of(&self, part: &Part) -> ThickPlane {
        ThickPlane::of_polygon(self.polygons, part.polygon)
    }

    /// The best plane across an axis, if one halves the set.
    fn axis_plane(&self, parts: &[Part]) -> Option<ThickPlane> {
        let step = parts.len().div_ceil(TRIED_ON * 4);
        let mut best: Option<(usize, ThickPlane)> = None;
        for axis in 0..3 {
            // Corners that are there, so that grids are not cut between their lines.
            let mut values: Vec<f64> =
                parts.iter().step_by(step).map(|p| self.points[p.first as usize][axis]).collect();
            values.sort_unstable_by(f64::total_cmp);
            let plane = ThickPlane::across(axis, values[values.len() / 2]);
            let score = self.score(parts, &plane, step);
            let (front, back, across) = (score.front, score.back, score.across);
            let whole = front + back + across + score.within;
            let halves = (front.max(back) + across) * 8 <= whole * WORST_HALF;
            if halves && best.as_ref().is_none_or(|(cost, _)| score.cost() < *cost) {
                best = Some((score.cost(), plane));
            }
        }
        best.map(|(_, plane)| plane)
    }

    /// The part whose plane cuts the set best, of some.
    fn splitter(&self, parts: &[Part]) -> usize {
        let step = parts.len().div_ceil(CANDIDATES);
        let stride = parts.len().div_ceil(TRIED_ON);
        let cost = |&i: &usize| self.score(parts, &self.plane_of(&parts[i]), stride).cost();
        (0..parts.len()).step_by(step).min_by_key(cost).unwrap_or(0)
    }

    /// What a plane would do to every `step`th part.
    fn score(&self, parts: &[Part], plane: &ThickPlane, step: usize) -> Score {
        let mut score = Score::default();
        for part in parts.iter().step_by(step) {
            match side_of(plane, self.points_of(part)) {
                BspSide::Front => score.front += 1,
                BspSide::Back => score.back += 1,
                BspSide::In => score.within += 1,
                BspSide::Across => score.across += 1,
            }
        }
        score
    }

    /// Makes a node of a plane and distributes the parts; the one at `splitter` gave the plane.
    fn cut(
        &mut self,
        task: Task,
        plane: ThickPlane,
        splitter: Option<usize>,
        tasks: &mut Vec<Task>,
    ) -> Result<(), Limit> {
        // Link the node to its parent.
        let node = self.tree.nodes.len() as u32;
        self.execution.budget.check("building the BSP tree")?;
        if node.is_multiple_of(256) || self.points.len() > self.accounted + (1 << 16) {
            self.account()?;
        }
        if let Some(parent) = self.tree.nodes.get_mut(task.parent as usize) {
            *(if task.front { &mut parent.front } else { &mut parent.back }) = node;
        }

        // Distribute the parts, splitting those that cross the plane.
        self.sort_out(&task.parts, &plane, splitter);
        let (mut front, mut back) = (Vec::new(), Vec::new());
        let start = self.tree.fragments.len();
        for (i, part) in task.parts.iter().enumerate() {
            match self.sides[i] {
                BspSide::In => self.place(part),
                BspSide::Front => front.push(*part),
                BspSide::Back => back.push(*part),
                BspSide::Across => {
                    let halves = self.split(part, &plane, node);
                    front.push(halves[0]);
                    back.push(halves[1]);
                }
            }
        }

        // Sort the node's own polygons by the side that they face.
        let (polygons, normal) = (self.polygons, plane.equation.truncate());
        let placed = &mut self.tree.fragments[start..];
        let faces_front = |f: &Fragment| polygons.doubled_area(f.polygon).dot(normal) >= 0.0;
        placed.sort_by_cached_key(|f| (faces_front(f), std::cmp::Reverse(f.polygon)));
        let facing_front = (start + placed.partition_point(|f| !faces_front(f))) as u32;
        let fragments = start as u32..self.tree.fragments.len() as u32;

        // Store the node and queue both sides.
        let splitter = splitter.map_or(NONE, |i| task.parts[i].polygon);
        let plane = plane.equation;
        self.tree.nodes.push(Node {
            plane,
            front: NONE,
            back: NONE,
            fragments,
            facing_front,
            splitter,
        });
        tasks.push(Task { parts: front, parent: node, front: true });
        tasks.push(Task { parts: back, parent: node, front: false });
        Ok(())
    }

    /// Finds where the parts of a set lie, into `sides`. The one at `splitter` gave the plane.
    fn sort_out(&mut self, parts: &[Part], plane: &ThickPlane, splitter: Option<usize>) {
        // Classify each part, and note the shared planes of those in the node's.
        self.sides.clear();
        self.coplanar.clear();
        for (i, part) in parts.iter().enumerate() {
            let side = if splitter == Some(i) {
                BspSide::In
            } else {
                side_of(plane, points_of(&self.points, part))
            };
            self.sides.push(side);
            if side == BspSide::In
                && let Some(number) = self.polygons.plane(part.polygon)
                && !self.coplanar.contains(&number)
            {
                self.coplanar.push(number);
            }
        }

        // What shares a plane with a polygon in the node's lies in it, too, however its corners
        // were rounded.
        if self.coplanar.is_empty() {
            return;
        }
        let thick =
            ThickPlane { thickness: plane.thickness.max(2.0 * self.polygons.tolerance), ..*plane };
        for (side, part) in
            self.sides.iter_mut().zip(parts).filter(|(side, _)| **side != BspSide::In)
        {
            let number = self.polygons.plane(part.polygon);
            if number.is_some_and(|number| self.coplanar.contains(&number))
                && side_of(&thick, points_of(&self.points, part)) == BspSide::In
            {
                *side = BspSide::In;
            }
        }
    }

    /// Makes a part a fragment of the node that is being made. Of the planes that cut it on its way
    /// down, the tree keeps those that it is near to.
    fn place(&mut self, part: &Part) {
        // Measure the part.
        let points = points_of(&self.points, part);
        let (low, high) =
            points.iter().fold((points[0], points[0]), |(l, h), &p| (l.min(p), h.max(p)));
        let clear = (high - low).max_element() * CLEAR;

        // Walk up the planes that cut it and keep the near ones.
        let (first_cut, mut link) = (self.tree.cuts.len() as u32, part.cuts);
        while link != NONE {
            let outer = link & OUTER;
            let builder = if outer == 0 { None } else { self.outer };
            let (links, nodes) =
                builder.map_or((&self.links, &self.tree.nodes), |b| (&b.links, &b.tree.nodes));
            let CutLink { cut, before } = links[(link & !OUTER) as usize];
            // The part's own node is about to be made, so all nodes that cut it are there.
            let plane = nodes[cut.node as usize].plane;
            if points.iter().any(|p| plane.dot(p.extend(1.0)).abs() <= clear) {
                self.tree.cuts.push(Cut { node: cut.node | outer, ..cut });
            }
            link = if before == NONE { NONE } else { before | outer };
        }
        let cuts = self.tree.cuts.len() as u32 - first_cut;
        self.tree.fragments.push(Fragment { polygon: part.polygon, first_cut, cuts });
        self.execution.budget.advance();
    }

    /// Cuts a part in the halves in front of and behind a plane.
    fn split(&mut self, part: &Part, plane: &ThickPlane, node: u32) -> [Part; 2] {
        // Reuse the lists of the last split.
        self.tree.splits += 1;
        let [mut front, mut back] = std::mem::take(&mut self.split);
        front.clear();
        back.clear();

        // Walk the outline, and put crossings into both halves.
        let points = self.points_of(part);
        for (i, &to) in points.iter().enumerate() {
            let from = points[(i + points.len() - 1) % points.len()];
            let (d_from, d_to) = (plane.side(from), plane.side(to));
            if d_from * d_to < 0.0 {
                let crossing = from + (to - from) * (d_from / (d_from - d_to));
                front.push(crossing);
                back.push(crossing);
            }
            if d_to >= 0.0 {
                front.push(to);
            }
            if d_to <= 0.0 {
                back.push(to);
            }
        }

        // Store both halves with the new cut.
        let halves = [(&front, true), (&back, false)].map(|(corners, positive)| {
            let cuts = self.links.len() as u32;
            self.links.push(CutLink { cut: Cut { node, positive }, before: part.cuts });
            let first = self.points.len() as u32;
            self.points.extend(corners);
            Part { polygon: part.polygon, cuts, first, count: corners.len() as u32 }
        });
        self.split = [front, back];
        halves
    }

    /// Charges what has grown since the last time.
    fn account(&mut self) -> Result<(), Limit> {
        self.accounted = self.points.len();
        let parts = self.points.len() / 3 * size_of::<Part>();
        let work = size_of_val(self.points.as_slice()) + size_of_val(self.links.as_slice()) + parts;
        let now = self.tree.bytes() + work as u64;
        // A branch of that many corners is of no use to anybody, limit or not.
        let most = 1 << 26;
        if self.points.len() > most {
            return Err(Limit::Memory { needed: now, limit: now, stage: "the BSP tree" });
        }
        let more = now.saturating_sub(self.charged);
        self.execution.budget.charge(more, "the BSP tree")?;
        self.charged += more;
        Ok(())
    }
}

/// The corners of a part, among those of its job.
fn points_of<'p>(points: &'p [DVec3], part: &Part) -> &'p [DVec3] {
    &points[part.first as usize..][..part.count as usize]
}

/// What a plane does to a set.
#[derive(Clone, Copy, Debug, Default)]
struct Score {
    front: usize,
    back: usize,
    within: usize,
    across: usize,
}

impl Score {
    fn cost(&self) -> usize {
        self.across * SPLIT_COST + self.front.abs_diff(self.back)
    }
}

impl BspTree {
    /// Hangs a branch where its job was cut off.
    fn attach(&mut self, job: &Task, branch: Self) {
        if branch.nodes.is_empty() {
            return;
        }

        // Find how far the branch's indices move.
        let [nodes, fragments, cuts] =
            [self.nodes.len(), self.fragments.len(), self.cuts.len()].map(|length| length as u32);
        if let Some(parent) = self.nodes.get_mut(job.parent as usize) {
            *(if job.front { &mut parent.front } else { &mut parent.back }) = nodes;
        }
        let moved = |index: u32, by: u32| if index == NONE { NONE } else { index + by };
        let node = |index: u32| if index & OUTER == 0 { index + nodes } else { index & !OUTER };

        // Append nodes, fragments and cuts with their indices moved.
        self.nodes.extend(branch.nodes.into_iter().map(|n| Node {
            front: moved(n.front, nodes),
            back: moved(n.back, nodes),
            fragments: n.fragments.start + fragments..n.fragments.end + fragments,
            facing_front: n.facing_front + fragments,
            ..n
        }));
        let placed = |f: Fragment| Fragment { first_cut: f.first_cut + cuts, ..f };
        self.fragments.extend(branch.fragments.into_iter().map(placed));
        self.cuts.extend(branch.cuts.into_iter().map(|c| Cut { node: node(c.node), ..c }));
        self.splits += branch.splits;
    }

    /// Lists the planes that cut fragments, and lets cuts refer to that list.
    fn number_cutters(&mut self) {
        let mut numbers = vec![NONE; self.nodes.len()];
        for cut in &mut self.cuts {
            let number = &mut numbers[cut.node as usize];
            if *number == NONE {
                *number = self.cutters.len() as u32;
                self.cutters.push(self.nodes[cut.node as usize].plane);
            }
            cut.node = *number;
        }
    }
}

#[cfg(test)]
mod tests;
