//! Long lists on all threads.
//!
//! In a list, an item is clipped by the clipping polygons before it, in their order; the part
//! inside one goes into that one's list, and the rest goes on to the next. That asks nothing of
//! other items but whether they have anything left when it is their turn to clip. And even that
//! hardly matters: if nothing is left of a clipping polygon, those before it have taken everything
//! inside its outline from the others, too, and a clip finds nothing there. But where a part was
//! cut off in penetration, the outline encloses more than what there was. Such items are therefore
//! taken first.
//!
//! In:   a list. Out: its visible polygons.
//! Cost: as in the plain order; memory: all parts inside clipping polygons at once.

use super::buckets::Buckets;
use super::{AreaSorting, Found, Item, LONG, List, Worker};
use std::sync::atomic::{AtomicBool, Ordering};
use vitral_exec::Limit;

/// Items that a thread takes at once.
const ITEMS_A_JOB: usize = 16;
/// Items of short lists that a thread takes at once.
const LISTED_ITEMS_A_JOB: usize = 256;

/// A place of a list, as the others see it.
#[derive(Clone, Copy)]
struct Clipper {
    polygon: u32,
    /// Whether the list is clipped with it.
    clips: bool,
}

/// An item on its way through the clipping polygons of its list.
struct Passing {
    place: usize,
    item: Item,
    is_done: bool,
    /// The parts that are inside clipping polygons and may be visible, with their places.
    parts: Vec<(u32, Item)>,
}

/// Short lists that one thread treats.
struct Job {
    lists: Vec<List>,
    found: Result<Found, Limit>,
}

impl AreaSorting<'_> {
    /// Treats a list, and the inside lists that come of it.
    pub(super) fn spread(&self, list: List) -> Result<Found, Limit> {
        let (mut found, mut long) = (Found::default(), vec![list]);
        while let Some(list) = long.pop() {
            let lists = if list.items.len() > LONG {
                self.clip_long(list, &mut found)?
            } else {
                vec![list]
            };
            let (longer, short) =
                lists.into_iter().partition(|list: &List| list.items.len() > LONG);
            long.extend::<Vec<_>>(longer);
            self.treat_short(short, &mut found)?;
        }
        Ok(found)
    }

    /// Treats short lists, each on one thread.
    fn treat_short(&self, lists: Vec<List>, found: &mut Found) -> Result<(), Limit> {
        // Gather lists to jobs of enough items.
        let mut jobs: Vec<Job> = Vec::new();
        let mut items = LISTED_ITEMS_A_JOB;
        for list in lists {
            if items >= LISTED_ITEMS_A_JOB {
                jobs.push(Job { lists: Vec::new(), found: Ok(Found::default()) });
                items = 0;
            }
            items += list.items.len();
            if let Some(job) = jobs.last_mut() {
                job.lists.push(list);
            }
        }

        // Treat the jobs on all threads until one meets a limit.
        let is_stopped = AtomicBool::new(false);
        self.execution.workers.for_each_chunk(&mut jobs, 1, |_, jobs| {
            for job in jobs.iter_mut().filter(|_| !is_stopped.load(Ordering::Relaxed)) {
                let mut worker = Worker::default();
                let treated =
                    job.lists.drain(..).try_for_each(|list| self.treat(list, &mut worker));
                is_stopped.fetch_or(treated.is_err(), Ordering::Relaxed);
                job.found = treated.map(|()| worker.found);
            }
        });

        // Append what they found, in their order.
        for job in jobs {
            found.append(job.found?);
        }
        Ok(())
    }

    /// Clips a long list, adds the polygons that are visible already, and gives the inside lists.
    fn clip_long(&self, list: List, found: &mut Found) -> Result<Vec<List>, Limit> {
        // Sort the outlines into buckets, and list what clips.
        let bytes = Buckets::bytes(list.items.len()) as u64;
        self.held.add(bytes)?;
        let outline = |item: &Item| match item.is_reduced {
            true => self.polygons[item.polygon as usize].shape.bounds,
            false => item.region.bounds(),
        };
        let buckets = Buckets::new(list.items.iter().map(outline).collect());
        let clipper = |item: &Item| Clipper { polygon: item.polygon, clips: !item.clipped_with };
        let mut clippers: Vec<_> = list.items.iter().map(clipper).collect();
        let passing = |(place, item)| Passing { place, item, is_done: false, parts: Vec::new() };
        let mut passing: Vec<_> = list.items.into_iter().enumerate().map(passing).collect();

        // Take those first whose outlines enclose more than them.
        let mut worker = Worker::default();
        for one in &mut passing {
            if one.item.is_reduced && !one.item.clipped_with {
                self.pass(one, &clippers, &buckets, &mut worker)?;
                clippers[one.place].clips = !one.item.region.is_empty();
            }
        }
        found.append(worker.found);

        // Take the others on all threads.
        let results = std::sync::Mutex::new(Vec::new());
        let is_stopped = AtomicBool::new(false);
        self.execution.workers.for_each_chunk(&mut passing, ITEMS_A_JOB, |_, items| {
            if is_stopped.load(Ordering::Relaxed) {
                return;
            }
            let mut worker = Worker::default();
            let mut open = items.iter_mut().filter(|one| !one.is_done);
            let passed = open.try_for_each(|one| self.pass(one, &clippers, &buckets, &mut worker));
            is_stopped.fetch_or(passed.is_err(), Ordering::Relaxed);
            results
                .lock()
                .expect("no thread panics while it adds")
                .push(passed.map(|()| worker.found.counters));
        });
        for counters in results.into_inner().expect("no thread panics while it adds") {
            found.counters.add(&counters?);
        }
        self.held.change(bytes, 0)?;
        Ok(self.gather(passing, found))
    }

    /// Clips an item by the clipping polygons of its list.
    fn pass(
        &self,
        one: &mut Passing,
        clippers: &[Clipper],
        buckets: &Buckets,
        worker: &mut Worker,
    ) -> Result<(), Limit> {
        // Find the clippers near the item.
        let before = one.item.bytes();
        let mut near = std::mem::take(&mut worker.near);
        buckets.overlapping(one.item.region.bounds(), &mut near);
        let ends = if one.item.clipped_with { clippers.len() } else { one.place };

        // Clip by those that come before it.
        for &place in near.iter().take_while(|&&place| (place as usize) < ends) {
            let clipper = clippers[place as usize];
            if clipper.clips {
                let front = &self.polygons[clipper.polygon as usize];
                let inside = self.clip(&mut one.item, front, worker)?;
                one.parts.extend(inside.and_then(|inside| inside.kept).map(|part| (place, part)));
            }
            if one.item.region.is_empty() {
                break;
            }
        }

        // Account for the memory of the parts.
        worker.near = near;
        one.is_done = true;
        self.execution.budget.advance();
        let parts: u64 = one.parts.iter().map(|(_, part)| part.bytes()).sum();
        self.held.change(before, one.item.bytes() + parts)
    }

    /// Sorts what has passed into inside lists; what has clipped before is visible.
    fn gather(&self, passing: Vec<Passing>, found: &mut Found) -> Vec<List> {
        // Collect the parts by the clipper's place.
        let mut lists: Vec<List> = passing.iter().map(|_| List::default()).collect();
        let mut is_again = vec![false; passing.len()];
        for one in passing {
            for (place, part) in one.parts {
                is_again[place as usize] |= !part.clipped_with;
                lists[place as usize].items.push(part);
            }

            // Show the polygons that have clipped already, and list the rest under its own place.
            if one.item.region.is_empty() {
                continue;
            }
            if one.item.clipped_with {
                self.show(&one.item, None, found);
            } else {
                lists[one.place].items.push(Item { clipped_with: true, ..one.item });
            }
        }

        // Count the lists that recurse.
        found.counters.recursions += is_again.iter().filter(|again| **again).count() as u64;
        lists.retain(|list| !list.items.is_empty());
        lists
    }
}
