//! Parts that look alike, and the regions that they make.
//!
//! In:   visible parts. Out: one union for each look, in the order of painting: opaque ones,
//!       then clear layers from the deepest on.
//! Cost: `n log n` for the corners of each union.

use super::parts::{Look, PageRegion, Part};
use crate::run::Run;
use crate::shapes::{FINER, Shapes, on_page, union};
use std::collections::BTreeMap;
use vitral_exec::Limit;

/// Area in units of the page below which a region or a hole is a trace of rounding: a millionth of
/// a square millimetre on a sheet.
pub(super) const LEAST_AREA: u64 = 1024;
/// The same in steps of the finer grid, squared.
pub(super) const LEAST_SHAPE: u64 = LEAST_AREA * (FINER as u64).pow(2);

/// The parts of each look.
pub(super) struct Groups {
    groups: Vec<(Look, Vec<u32>)>,
    /// The group of each part.
    of_part: Vec<u32>,
}

/// What a group looks like, and its shapes.
#[derive(Clone, Debug)]
pub(super) struct Joined {
    pub(super) look: Look,
    /// The lowest surface id of its faces.
    pub(super) surface: u32,
    pub(super) shapes: Shapes,
}

impl Groups {
    /// Sorts parts by their looks.
    pub(super) fn new(parts: &[Part]) -> Self {
        let mut by_look: BTreeMap<Look, Vec<u32>> = BTreeMap::new();
        for (i, part) in parts.iter().enumerate() {
            by_look.entry(part.look).or_default().push(i as u32);
        }
        let groups: Vec<_> = by_look.into_iter().collect();
        let mut of_part = vec![0; parts.len()];
        for (g, (_, members)) in groups.iter().enumerate() {
            members.iter().for_each(|&i| of_part[i as usize] = g as u32);
        }
        Self { groups, of_part }
    }

    pub(super) fn len(&self) -> usize {
        self.groups.len()
    }

    /// The group of a part, in the order of painting.
    pub(super) fn of_part(&self, part: u32) -> u32 {
        self.of_part[part as usize]
    }

    /// The union of each group, with other parts beneath it.
    pub(super) fn joined(
        &self,
        parts: &[Part],
        beneath: &[Vec<u32>],
        run: &Run<'_>,
    ) -> Result<Vec<Joined>, Limit> {
        let joined = run.workers.map(self.groups.len(), |g| {
            run.budget.check("regions")?;
            let (look, members) = &self.groups[g];
            let all = members.iter().chain(&beneath[g]).map(|&i| &parts[i as usize].shapes);
            let surface = members.iter().map(|&i| parts[i as usize].surface).min().unwrap_or(0);
            Ok(Joined { look: *look, surface, shapes: union(all, LEAST_SHAPE) })
        });
        joined.into_iter().collect()
    }
}

impl Joined {
    /// Its shapes as regions, each with the outline and the holes.
    pub(super) fn regions(&self) -> impl Iterator<Item = PageRegion> + '_ {
        self.shapes.iter().map(|shape| PageRegion {
            surface: self.surface,
            material: self.look.material,
            color: self.look.color,
            opacity: self.look.opacity,
            unlit: self.look.unlit,
            rings: shape.iter().map(|ring| ring.iter().map(on_page).collect()).collect(),
        })
    }
}
