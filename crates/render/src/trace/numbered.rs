//! Steps in the algorithm's own order, with numbers and parents.
//!
//! Threads tell the steps of tiles, bands and rays as they are done, each its own in order. A
//! [`Collector`] keeps them, and puts them in an order that does not depend on the threads:
//! culling, clipping, what is built before anything is seen, then windows from the whole picture
//! down, each before its parts, lines from top to bottom, facets and lists in their order, rays by
//! their pixels. Two pictures of one view have the same steps, whatever the session knew before.
//!
//! In:   steps as they are told. Out: numbered steps.
//! Cost: sorting the steps; memory: all of them, charged to the budget.

use super::{Observer, Step};
use serde::Serialize;
use std::collections::HashMap;
use std::sync::Mutex;
use vitral_exec::{Budget, Limit};

/// A step with its place among all.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NumberedStep {
    /// Counted from 0.
    pub number: u32,
    /// Number of the step that this one is a part of or follows from, where there is one.
    pub parent: Option<u32>,
    /// What was done.
    #[serde(flatten)]
    pub step: Step,
}

/// Keeps the steps of one picture.
#[derive(Debug)]
pub struct Collector {
    budget: Budget,
    /// A pixel at which each comparison of the z-buffer is kept.
    watched: Option<[u32; 2]>,
    kept: Mutex<RecordedSteps>,
}

#[derive(Debug, Default)]
struct RecordedSteps {
    steps: Vec<Step>,
    charged: u64,
    /// Where it gave up.
    limit: Option<Limit>,
}

impl Collector {
    /// Charges the steps to `budget`; `watched` is a pixel at which each comparison of the z-buffer
    /// is kept.
    pub fn new(budget: Budget, watched: Option<[u32; 2]>) -> Self {
        Self { budget, watched, kept: Mutex::default() }
    }

    /// Takes the steps that were told.
    ///
    /// # Errors
    /// [`Limit::Memory`] if they were too many.
    pub fn take(&self) -> Result<Vec<NumberedStep>, Limit> {
        let kept = self.recorded();
        kept.limit.map_or_else(|| Ok(numbered(kept.steps)), Err)
    }

    /// Takes the steps that were told until the memory of the budget was full, and whether more
    /// followed.
    pub fn take_first(&self) -> (Vec<NumberedStep>, bool) {
        let kept = self.recorded();
        (numbered(kept.steps), kept.limit.is_some())
    }

    /// What was recorded, which is charged to the budget no more.
    fn recorded(&self) -> RecordedSteps {
        let kept =
            std::mem::take(&mut *self.kept.lock().expect("no thread panics while it keeps a step"));
        self.budget.release(kept.charged);
        kept
    }
}

impl Observer for Collector {
    fn step(&self, step: &Step) {
        let mut kept = self.kept.lock().expect("no thread panics while it keeps a step");
        if kept.limit.is_some() {
            return;
        }
        let bytes = step.bytes();
        match self.budget.charge(bytes, "the steps") {
            Ok(()) => {
                kept.charged += bytes;
                kept.steps.push(step.clone());
            }
            Err(limit) => kept.limit = Some(limit),
        }
    }

    fn watches(&self, pixel: [u32; 2]) -> bool {
        self.watched == Some(pixel)
    }
}

/// Puts steps in order, and numbers them.
pub fn numbered(mut steps: Vec<Step>) -> Vec<NumberedStep> {
    steps.sort_by_key(place);
    let mut parents = Parents::default();
    let steps = joined(steps).into_iter().zip(0..);
    steps
        .map(|(step, number)| NumberedStep { number, parent: parents.of(&step, number), step })
        .collect()
}

/// Where a step comes among all: the stage, and the place in it. Those of one place stay in the
/// order in which they were told.
fn place(step: &Step) -> [u64; 3] {
    let row_by_row = |stage, [x, y]: [u32; 2]| [stage, u64::from(y), u64::from(x)];
    match step {
        Step::Box { .. } => [0, 0, 0],
        Step::Clipped { facet, .. } => [1, u64::from(*facet), 0],
        // Told by one thread after the other, in order.
        Step::Space { .. } | Step::TreeNode { .. } => [2, 0, 0],
        Step::TreeVisit { .. } => [3, 0, 0],
        Step::FirstOrder { .. }
        | Step::Turn { .. }
        | Step::Compared { .. }
        | Step::Moved { .. } => [3, 0, 0],
        Step::Circle { .. } | Step::Split { .. } | Step::Painted { .. } => [3, 0, 0],
        Step::NearestFirst { .. } | Step::Clip { .. } | Step::Visible { .. } => [3, 0, 0],
        Step::DepthTest { facet, .. } => [3, u64::from(*facet), 0],
        Step::Drawn { facet, .. } => [3, u64::from(*facet), 1],
        Step::Window { path, .. } => [3, path_key(path), 0],
        Step::EdgeTable { rows, .. } => [3, u64::from(rows[0]), 0],
        Step::Line { row, .. } => [3, u64::from(*row), 1],
        Step::Rays { pixels: [x, y, ..], .. } => row_by_row(3, [*x, *y]),
        Step::Piece { .. } => [4, 0, 0],
        Step::Overruled { pixels: [x, y, ..], .. } => row_by_row(5, [*x, *y]),
        Step::RayMeets { pixel, .. } | Step::RayGoesOn { pixel, .. } => row_by_row(6, *pixel),
    }
}

/// A path of quarters as a number that sorts a window before its parts, and these in their order:
/// three bits a digit.
fn path_key(path: &str) -> u64 {
    let digits = path.bytes().take(20).enumerate();
    digits.fold(0, |key, (level, digit)| key | u64::from(digit - b'0' + 1) << (60 - 3 * level))
}

/// Joins what is told of one facet of the z-buffer in several tiles.
fn joined(steps: Vec<Step>) -> Vec<Step> {
    let mut joined: Vec<Step> = Vec::with_capacity(steps.len());
    for step in steps {
        match (joined.last_mut(), step) {
            (
                Some(Step::Drawn { facet, stays, hidden }),
                Step::Drawn { facet: same, stays: more_stays, hidden: more_hidden },
            ) if *facet == same => {
                stays.extend(more_stays);
                hidden.extend(more_hidden);
            }
            (_, step) => joined.push(step),
        }
    }
    for step in &mut joined {
        if let Step::Drawn { stays, hidden, .. } = step {
            join_runs(stays);
            join_runs(hidden);
        }
    }
    joined
}

/// Sorts runs of pixels, and joins those that touch.
fn join_runs(runs: &mut Vec<[u32; 3]>) {
    runs.sort_unstable();
    runs.dedup_by(|next, run| {
        let touches = next[0] == run[0] && next[1] == run[2];
        if touches {
            run[2] = next[2];
        }
        touches
    });
}

/// What is known of the steps that others may follow from.
#[derive(Default)]
struct Parents {
    windows: HashMap<String, u32>,
    /// The boxes round the last one, from the root down: what each holds, of which instance, and
    /// its number.
    boxes: Vec<([u32; 2], Option<u32>, u32)>,
    /// Boxes round instances that came before.
    boxes_of_instances: Vec<([u32; 2], Option<u32>, u32)>,
    /// The polygons in their first order, the turn of one of them, nodes of a tree and visits to
    /// them by the nodes' numbers, clips by their own.
    first_order: Option<u32>,
    turn: Option<u32>,
    nodes: HashMap<u32, u32>,
    visits: HashMap<u32, u32>,
    clips: HashMap<u32, u32>,
    /// The facet that was clipped last.
    clipped: Option<(u32, u32)>,
    /// The last table of edges, and the last step about what rays go through.
    edge_table: Option<u32>,
    space: Option<u32>,
    /// Of the pixel at hand: what rays met, by the turns they had taken, and where they went on.
    pixel: Option<[u32; 2]>,
    met: Vec<u32>,
    went_on: Vec<([f64; 3], u32)>,
}

impl Parents {
    /// The parent of a step, which gets this number.
    fn of(&mut self, step: &Step, number: u32) -> Option<u32> {
        // Boxes, clipped facets and windows hang below what contains them.
        match step {
            Step::Box { instance, items, .. } => self.above(*instance, *items, number),
            Step::Clipped { facet, .. } => {
                let before = self.clipped.replace((*facet, number));
                before.filter(|(same, _)| same == facet).map(|(_, number)| number)
            }
            Step::Window { path, .. } => {
                self.windows.insert(path.clone(), number);
                let above = path.char_indices().next_back().map(|(at, _)| &path[..at]);
                above.and_then(|above| self.windows.get(above).copied())
            }

            // Steps of list priority hang below the first order or the turn.
            Step::FirstOrder { .. } | Step::NearestFirst { .. } => {
                self.first_order = Some(number);
                None
            }
            Step::Turn { .. } => {
                self.turn = Some(number);
                self.first_order
            }
            Step::Compared { .. } | Step::Moved { .. } | Step::Circle { .. } => self.turn,
            Step::Split { .. } | Step::Painted { .. } => self.turn,

            // Nodes hang below their parent; visits and pieces below the node they are of.
            Step::TreeNode { node, above, .. } => {
                self.nodes.insert(*node, number);
                above.and_then(|above| self.nodes.get(&above).copied())
            }
            Step::TreeVisit { node, .. } => {
                let built = self.nodes.get(node).copied();
                self.visits.insert(*node, number);
                built
            }
            Step::Piece { node: Some(node), .. } => self.visits.get(node).copied(),
            Step::Piece { node: None, .. } => self.first_order,

            // Clips hang below the clip whose list they are of.
            Step::Clip { clip, within, .. } => {
                self.clips.insert(*clip, number);
                within.map_or(self.first_order, |outer| self.clips.get(&outer).copied())
            }
            Step::Visible { clip, .. } => {
                clip.map_or(self.first_order, |clip| self.clips.get(&clip).copied())
            }

            // Lines hang below the edge table, and rays below the structure.
            Step::EdgeTable { .. } => {
                self.edge_table = Some(number);
                None
            }
            Step::Line { .. } => self.edge_table,
            Step::Space { .. } => {
                self.space = Some(number);
                None
            }
            Step::Rays { .. } => self.space,

            // Hits of a traced ray hang below the hit that it came from.
            Step::RayMeets { pixel, turns, direction, .. } => {
                self.begin(*pixel);
                self.met.truncate(*turns as usize);
                self.met.push(number);
                let from = self.went_on.iter().rev().find(|(toward, _)| toward == direction);
                from.filter(|_| *turns > 0).map(|(_, from)| *from)
            }
            Step::RayGoesOn { pixel, direction, .. } => {
                self.begin(*pixel);
                self.went_on.push((*direction, number));
                self.met.last().copied()
            }
            _ => None,
        }
    }

    /// The smallest box before that holds what this one holds. Boxes are told from the root down,
    /// those of an instance together.
    fn above(&mut self, instance: Option<u32>, items: [u32; 2], number: u32) -> Option<u32> {
        let holds = |outer: [u32; 2], inner: [u32; 2]| outer[0] <= inner[0] && inner[1] <= outer[1];
        if self.boxes.last().is_some_and(|(_, of, _)| *of != instance) {
            let done = std::mem::take(&mut self.boxes);
            self.boxes_of_instances.extend(done.into_iter().filter(|(_, of, _)| of.is_none()));
        }
        while self.boxes.last().is_some_and(|(outer, ..)| !holds(*outer, items)) {
            let done = self.boxes.pop();
            self.boxes_of_instances.extend(done.filter(|(_, of, _)| of.is_none()));
        }
        let above = self.boxes.last().map(|(.., number)| *number).or_else(|| {
            let own = instance.map(|i| [i, i + 1])?;
            let round = self.boxes_of_instances.iter().filter(|(outer, ..)| holds(*outer, own));
            round.min_by_key(|(outer, ..)| outer[1] - outer[0]).map(|(.., number)| *number)
        });
        self.boxes.push((items, instance, number));
        above
    }

    /// Forgets the rays of the pixel before.
    fn begin(&mut self, pixel: [u32; 2]) {
        if self.pixel != Some(pixel) {
            self.pixel = Some(pixel);
            self.met.clear();
            self.went_on.clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{BoxVerdict, WindowVerdict};
    use super::*;

    fn window(path: &str) -> Step {
        let mut step = super::super::tests::window([0, 0, 1, 1], WindowVerdict::Cut);
        if let Step::Window { path: own, .. } = &mut step {
            own.push_str(path);
        }
        step
    }

    #[test]
    fn windows_come_before_their_parts_and_know_where_they_come_from() {
        let told = ["3", "1", "", "10", "0", "133", "13", "2"].map(window).to_vec();
        let steps = numbered(told);
        let path = |step: &NumberedStep| match &step.step {
            Step::Window { path, .. } => path.clone(),
            other => panic!("{other:?}"),
        };
        let paths: Vec<_> = steps.iter().map(path).collect();
        assert_eq!(paths, ["", "0", "1", "10", "13", "133", "2", "3"]);
        let parents: Vec<_> = steps.iter().map(|s| s.parent).collect();
        assert_eq!(parents, [None, Some(0), Some(0), Some(2), Some(2), Some(4), Some(0), Some(0)]);
    }

    #[test]
    fn boxes_follow_from_those_round_them() {
        let tested = |instance, items| Step::Box {
            instance,
            items,
            min: [0.0; 3],
            max: [1.0; 3],
            verdict: BoxVerdict::Crossing,
            beyond: None,
        };
        let world = [[0, 4], [0, 2], [0, 1], [1, 2], [2, 4]].map(|items| tested(None, items));
        let own = [(1, [0, 9000]), (1, [0, 4096]), (1, [4096, 9000]), (3, [0, 5000])];
        let own = own.map(|(instance, items)| tested(Some(instance), items));
        let steps = numbered(world.into_iter().chain(own).collect());
        let parents: Vec<_> = steps.iter().map(|s| s.parent).collect();
        let right = [None, Some(0), Some(1), Some(1), Some(0), Some(3), Some(5), Some(5), Some(4)];
        assert_eq!(parents, right);
    }

    #[test]
    fn a_facet_of_several_tiles_is_one_step() {
        let drawn = |facet, stays: &[[u32; 3]]| Step::Drawn {
            facet,
            stays: stays.to_vec(),
            hidden: Vec::new(),
        };
        let steps = numbered(vec![
            drawn(1, &[[5, 64, 70]]),
            drawn(0, &[[0, 0, 1]]),
            drawn(1, &[[5, 60, 64], [6, 0, 2]]),
        ]);
        assert_eq!(steps.len(), 2);
        assert_eq!(steps[1].step, drawn(1, &[[5, 60, 70], [6, 0, 2]]));
    }

    #[test]
    fn lines_follow_from_the_tables_of_their_band() {
        let table = |first, end| Step::EdgeTable {
            rows: [first, end],
            polygons: Vec::new(),
            buckets: Vec::new(),
        };
        let line = |row| Step::Line { row, sample: 0, active_edges: Vec::new(), spans: Vec::new() };
        let steps = numbered(vec![table(8, 16), line(8), line(9), table(0, 8), line(0)]);
        let parents: Vec<_> = steps.iter().map(|s| s.parent).collect();
        assert_eq!(parents, [None, Some(0), None, Some(2), Some(2)]);
    }

    #[test]
    fn steps_that_do_not_fit_are_an_error() {
        let budget = Budget::default().with_memory_limit(Some(2000));
        let collector = Collector::new(budget.clone(), None);
        (0..100).for_each(|_| collector.step(&window("0123")));
        assert!(matches!(collector.take(), Err(Limit::Memory { .. })));
        collector.step(&window(""));
        assert_eq!(collector.take().unwrap().len(), 1, "what was charged is released");
    }

    #[test]
    fn the_first_steps_are_kept_where_more_do_not_fit() {
        let budget = Budget::default().with_memory_limit(Some(2000));
        let collector = Collector::new(budget, None);
        (0..100).for_each(|_| collector.step(&window("0123")));
        let (first, more) = collector.take_first();
        assert!(more && (2..100).contains(&first.len()), "{}", first.len());
        collector.step(&window(""));
        assert!(matches!(collector.take_first(), (all, false) if all.len() == 1));
    }
}
