//! How a pass is cut: draws into jobs of about equal size, and many jobs into rounds.
//!
//! In:   commands. Out: the jobs, the order of jobs and other commands, and where rounds begin.
//! Cost: linear in commands and their pieces.

use super::pass::Command;
use std::ops::Range;

/// Triangles of a job.
const JOB: usize = 4096;

/// Jobs whose primitives wait in memory at a time: so many that caches hold them until tiles have
/// walked them.
const JOBS_A_ROUND: usize = 16;

/// A job before it runs.
pub(super) struct Plan {
    /// Index of the command, pieces of it.
    pub(super) pieces: Vec<(usize, Range<usize>)>,
    pub(super) weight: usize,
}

pub(super) enum PlanItem {
    /// A command that is no draw, by its number.
    Command(usize),
    /// A job of several draws' pieces, by its number.
    Job(usize),
}

/// Cuts draws into jobs; what is no draw stands between them.
pub(super) fn plan(commands: &[Command]) -> (Vec<Plan>, Vec<PlanItem>) {
    let (mut plans, mut order): (Vec<Plan>, Vec<PlanItem>) = (Vec::new(), Vec::new());
    let mut open = false;
    for (c, command) in commands.iter().enumerate() {
        let Command::Draw(geometry, _) = command else {
            order.push(PlanItem::Command(c));
            open = false;
            continue;
        };
        // Append pieces to the open job until it is full.
        for piece in 0..geometry.pieces() {
            let weight = geometry.weight(piece);
            if !open || plans.last().is_none_or(|p| p.weight + weight > JOB && p.weight > 0) {
                order.push(PlanItem::Job(plans.len()));
                plans.push(Plan { pieces: Vec::new(), weight: 0 });
                open = true;
            }
            let Some(plan) = plans.last_mut() else { continue };
            plan.weight += weight;
            match plan.pieces.last_mut() {
                Some((last, range)) if *last == c => range.end = piece + 1,
                _ => plan.pieces.push((c, piece..piece + 1)),
            }
        }
    }
    (plans, order)
}

/// Cuts a pass where it has many jobs; there is at least one round.
pub(super) fn rounds(order: &[PlanItem]) -> Vec<&[PlanItem]> {
    let (mut rounds, mut start, mut jobs) = (Vec::new(), 0, 0);
    for (at, item) in order.iter().enumerate() {
        if let PlanItem::Job(_) = item {
            if jobs == JOBS_A_ROUND {
                rounds.push(&order[start..at]);
                (start, jobs) = (at, 0);
            }
            jobs += 1;
        }
    }
    rounds.push(&order[start..]);
    rounds
}
