//! The normals at one vertex, made from the faces round it.

use super::bucket::Corner;
use super::rule::Rule;
use crate::directions::{DEFAULT_NORMAL, dot, is_near, unit};

/// With more faces at one vertex, they are gathered into cells.
pub(super) const CELL_THRESHOLD: usize = 256;

/// Faces that are treated as one: a face, or a cell of directions.
#[derive(Clone, Copy)]
struct Member {
    /// Unit, or zero for a face without area.
    direction: [f32; 3],
    /// Normals times angles.
    sum: [f32; 3],
}

/// The faces round a vertex, and memory for making their normals.
#[derive(Default)]
pub(super) struct Fan {
    members: Vec<Member>,
    /// Pairs of a sorting key and a position in the fan.
    keyed: Vec<(u32, u32)>,
    /// The normals that were made; where few faces meet, all different.
    pub(super) values: Vec<[f32; 3]>,
    /// For each corner, which value it takes.
    pub(super) slots: Vec<u32>,
}

impl Fan {
    /// Makes the normals at a vertex with these corners, at least one of them; `normals` are those
    /// of the bucket's `faces`.
    pub(super) fn make(
        &mut self,
        corners: &[Corner],
        faces: &[u32],
        normals: &[[f32; 3]],
        rule: Rule,
    ) {
        let member = |c: &Corner| {
            let n = normals[c.face as usize];
            Member { direction: n, sum: n.map(|k| k * c.angle) }
        };
        let mut values = std::mem::take(&mut self.values);
        values.clear();
        self.members.clear();
        self.members.extend(corners.iter().map(member));
        self.slots.clear();
        match rule.groups {
            None => self.extend_by_angle(rule, &mut values),
            Some(groups) => {
                let group = corners.iter().map(|c| groups[faces[c.face as usize] as usize]);
                let keyed: Vec<_> = group.zip(0..).collect();
                self.by_group(keyed, rule, &mut values);
            }
        }
        self.values = values;
    }

    /// Finds the normal of each member in each group, and of each face without a group.
    fn by_group(&mut self, mut keyed: Vec<(u32, u32)>, rule: Rule, values: &mut Vec<[f32; 3]>) {
        keyed.sort_unstable();
        let all = std::mem::take(&mut self.members);
        let mut slots = vec![0; all.len()];
        for group in keyed.chunk_by(|a, b| a.0 == b.0 && a.0 != 0) {
            self.members.clear();
            self.members.extend(group.iter().map(|k| all[k.1 as usize]));
            self.slots.clear();
            self.extend_by_angle(rule, values);
            group.iter().zip(&self.slots).for_each(|(k, slot)| slots[k.1 as usize] = *slot);
        }
        self.slots = slots;
    }

    /// Finds the normal of each member, with those within the angle; many members are gathered into
    /// cells first.
    fn extend_by_angle(&mut self, rule: Rule, values: &mut Vec<[f32; 3]>) {
        if self.members.len() <= CELL_THRESHOLD {
            return self.by_angle(rule, values);
        }
        self.keyed.clear();
        self.keyed.extend(self.members.iter().map(|m| cell(m.direction)).zip(0..));
        let cells = self.merge_cells();
        self.by_angle(rule, values);

        // Go back from cells to faces.
        let of_cell = std::mem::take(&mut self.slots);
        self.slots.extend(cells.iter().map(|&c| of_cell[c as usize]));
    }

    /// Finds the normal of each member, with those within the angle.
    fn by_angle(&mut self, rule: Rule, values: &mut Vec<[f32; 3]>) {
        let Rule { whole, half, .. } = rule;
        // Where many faces meet, few of their normals are equal.
        let from = if values.len() <= CELL_THRESHOLD { 0 } else { values.len() };
        let all = total(self.members.iter());
        let near = |mean: &[f32; 3]| self.members.iter().all(|m| is_near(*mean, m.direction, half));
        if let Some(mean) = unit(all).filter(near) {
            let slot = share(values, from, mean);
            self.slots.resize(self.members.len(), slot);
            return;
        }
        for m in &self.members {
            let near = self.members.iter().filter(|o| dot(m.direction, o.direction) >= whole);
            let normal = if m.direction == [0.0; 3] {
                unit(all)
            } else {
                unit(total(near)).or(Some(m.direction))
            };
            let slot = share(values, from, normal.unwrap_or(DEFAULT_NORMAL));
            self.slots.push(slot);
        }
    }

    /// Replaces the members by one for each cell in use; gives each former member's cell.
    fn merge_cells(&mut self) -> Vec<u32> {
        self.keyed.sort_unstable();
        let mut cell_of = vec![0; self.keyed.len()];
        let mut cells = Vec::new();
        for cell in self.keyed.chunk_by(|a, b| a.0 == b.0) {
            let sum = total(cell.iter().map(|k| &self.members[k.1 as usize]));
            cell.iter().for_each(|k| cell_of[k.1 as usize] = cells.len() as u32);
            let direction = unit(sum).unwrap_or(self.members[cell[0].1 as usize].direction);
            cells.push(Member { direction, sum });
        }
        self.members = cells;
        cell_of
    }
}

/// The index of `normal` among `values[first..]`, appended if it is new.
fn share(values: &mut Vec<[f32; 3]>, first: usize, normal: [f32; 3]) -> u32 {
    let known = values[first..].iter().position(|v| *v == normal);
    known.map_or_else(
        || {
            values.push(normal);
            values.len() - 1
        },
        |k| first + k,
    ) as u32
}

fn total<'a>(members: impl Iterator<Item = &'a Member>) -> [f32; 3] {
    members.fold([0.0; 3], |s, m| [s[0] + m.sum[0], s[1] + m.sum[1], s[2] + m.sum[2]])
}

/// A cell of a 16x16 grid on each side of the cube round the unit sphere; the zero vector has a
/// cell of its own.
fn cell(d: [f32; 3]) -> u32 {
    let axis = (0..3).fold(0, |best, k| if d[k].abs() > d[best].abs() { k } else { best });
    if d[axis] == 0.0 {
        return u32::MAX;
    }
    let grid = |k: usize| ((d[(axis + k) % 3] / d[axis].abs() + 1.0) * 8.0).clamp(0.0, 15.0) as u32;
    let side = 2 * axis as u32 + u32::from(d[axis] < 0.0);
    side << 8 | grid(1) << 4 | grid(2)
}
