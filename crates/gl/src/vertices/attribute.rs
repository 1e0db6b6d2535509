//! The attributes of a vertex by number, so that one function serves them all.

use crate::state::{Current, MAX_TEXTURE_UNITS};
use crate::vertex::VertexBatch;
use std::ops::Range;

pub(crate) const NORMAL: usize = 0;
pub(crate) const COLOR: usize = 1;
pub(crate) const SECONDARY: usize = 2;
pub(crate) const FOG: usize = 3;
pub(crate) const EDGE: usize = 4;
/// Texture coordinates of unit 0; the others follow.
pub(crate) const TEX: usize = 5;
/// Colour index: current state that vertices do not carry.
pub(crate) const INDEX: usize = TEX + MAX_TEXTURE_UNITS;
/// How many there are.
pub(crate) const COUNT: usize = INDEX + 1;

/// Attributes that vertices carry.
pub(crate) const CARRIED: u32 = (1 << INDEX) - 1;

impl Current {
    /// Sets attribute `which`; numbers that it does not have are dropped.
    #[inline(always)]
    pub(crate) fn set(&mut self, which: usize, value: [f32; 4]) {
        let [x, y, z, _] = value;
        match which {
            NORMAL => self.normal = [x, y, z],
            COLOR => self.color = value,
            SECONDARY => self.secondary = [x, y, z],
            FOG => self.fog = x,
            EDGE => self.edge = x != 0.0,
            INDEX => self.index = x,
            _ => self.tex[which - TEX] = value,
        }
    }

    /// Attribute `which`.
    pub(crate) fn get(&self, which: usize) -> [f32; 4] {
        let three = |[x, y, z]: [f32; 3]| [x, y, z, 1.0];
        match which {
            NORMAL => three(self.normal),
            COLOR => self.color,
            SECONDARY => three(self.secondary),
            FOG => [self.fog, 0.0, 0.0, 1.0],
            EDGE => [f32::from(u8::from(self.edge)), 0.0, 0.0, 1.0],
            INDEX => [self.index, 0.0, 0.0, 1.0],
            _ => self.tex[which - TEX],
        }
    }
}

/// The attributes in `mask`, lowest first.
pub(crate) fn each(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let which = mask.trailing_zeros() as usize;
        mask &= mask.wrapping_sub(1);
        (which < 32).then_some(which)
    })
}

#[inline(always)]
fn push<T>(values: &mut Option<Vec<T>>, value: T) {
    if let Some(values) = values {
        values.push(value);
    }
}

impl VertexBatch {
    /// Appends the attributes in `seen` from `current`.
    #[inline(always)]
    pub(crate) fn push_attributes(&mut self, seen: u32, current: &Current) {
        const USUAL: u32 = 1 << NORMAL | 1 << COLOR | 1 << TEX;
        if seen & 1 << NORMAL != 0 {
            push(&mut self.normals, current.normal);
        }
        if seen & 1 << COLOR != 0 {
            push(&mut self.colors, current.color);
        }
        if seen & 1 << TEX != 0 {
            push(&mut self.tex[0], current.tex[0]);
        }
        if seen & !USUAL != 0 {
            self.push_others(current);
        }
    }

    #[inline(never)]
    fn push_others(&mut self, current: &Current) {
        push(&mut self.secondary, current.secondary);
        push(&mut self.fog, current.fog);
        push(&mut self.edges, current.edge);
        for unit in 1..MAX_TEXTURE_UNITS {
            push(&mut self.tex[unit], current.tex[unit]);
        }
    }

    /// The attributes that have arrays.
    pub(crate) fn attributes(&self) -> impl Iterator<Item = usize> {
        (0..INDEX).filter(|which| self.has(*which))
    }

    /// Whether attribute `which` has an array, or needs none.
    pub(crate) fn has(&self, which: usize) -> bool {
        match which {
            NORMAL => self.normals.is_some(),
            COLOR => self.colors.is_some(),
            SECONDARY => self.secondary.is_some(),
            FOG => self.fog.is_some(),
            EDGE => self.edges.is_some(),
            INDEX => true,
            _ => self.tex[which - TEX].is_some(),
        }
    }

    /// Appends vertices of another batch, by their place in its order; attributes that it does not
    /// have come from `current`.
    pub(crate) fn append(&mut self, other: &Self, vertices: Range<u32>, current: &Current) {
        let numbers = vertices.map(|i| other.vertex(i));
        fn add<T: Copy>(
            values: &mut Option<Vec<T>>,
            others: &Option<Vec<T>>,
            current: T,
            numbers: impl ExactSizeIterator<Item = usize>,
        ) {
            match (values, others) {
                (None, _) => {}
                (Some(values), Some(others)) => values.extend(numbers.map(|v| others[v])),
                (Some(values), None) => values.resize(values.len() + numbers.len(), current),
            }
        }

        // Append each attribute.
        self.positions.extend(numbers.clone().map(|v| other.positions[v]));
        add(&mut self.normals, &other.normals, current.normal, numbers.clone());
        add(&mut self.colors, &other.colors, current.color, numbers.clone());
        add(&mut self.secondary, &other.secondary, current.secondary, numbers.clone());
        add(&mut self.fog, &other.fog, current.fog, numbers.clone());
        add(&mut self.edges, &other.edges, current.edge, numbers.clone());
        for (unit, values) in self.tex.iter_mut().enumerate() {
            add(values, &other.tex[unit], current.tex[unit], numbers.clone());
        }
    }

    /// Makes an array for attribute `which`, in the memory of `spare`'s if there is any: all
    /// vertices so far have the value in `current`.
    #[inline(never)]
    pub(crate) fn back_fill(&mut self, which: usize, current: &Current, spare: &mut Self) {
        fn fill<T: Clone>(
            values: &mut Option<Vec<T>>,
            spare: &mut Option<Vec<T>>,
            value: T,
            n: usize,
        ) {
            let mut all = spare.take().unwrap_or_default();
            all.resize(n, value);
            *values = Some(all);
        }
        let n = self.positions.len();
        match which {
            NORMAL => fill(&mut self.normals, &mut spare.normals, current.normal, n),
            COLOR => fill(&mut self.colors, &mut spare.colors, current.color, n),
            SECONDARY => fill(&mut self.secondary, &mut spare.secondary, current.secondary, n),
            FOG => fill(&mut self.fog, &mut spare.fog, current.fog, n),
            EDGE => fill(&mut self.edges, &mut spare.edges, current.edge, n),
            INDEX => {}
            _ => {
                let unit = which - TEX;
                fill(&mut self.tex[unit], &mut spare.tex[unit], current.tex[unit], n);
            }
        }
    }

    /// Copies what vertex `i` has to `current`.
    pub(crate) fn load_attributes(&self, i: usize, current: &mut Current) {
        fn load<T: Copy>(values: &Option<Vec<T>>, i: usize, to: &mut T) {
            if let Some(values) = values {
                *to = values[i];
            }
        }
        load(&self.normals, i, &mut current.normal);
        load(&self.colors, i, &mut current.color);
        load(&self.secondary, i, &mut current.secondary);
        load(&self.fog, i, &mut current.fog);
        load(&self.edges, i, &mut current.edge);
        for (values, to) in self.tex.iter().zip(&mut current.tex) {
            load(values, i, to);
        }
    }

    /// Keeps the vertices that `keep` names, in that order.
    pub(crate) fn select_vertices(&mut self, keep: &[u32]) {
        fn select<T: Copy>(values: &mut Vec<T>, keep: &[u32]) {
            *values = keep.iter().map(|&i| values[i as usize]).collect();
        }
        select(&mut self.positions, keep);
        self.normals.iter_mut().for_each(|values| select(values, keep));
        self.colors.iter_mut().for_each(|values| select(values, keep));
        self.secondary.iter_mut().for_each(|values| select(values, keep));
        self.fog.iter_mut().for_each(|values| select(values, keep));
        self.edges.iter_mut().for_each(|values| select(values, keep));
        self.tex.iter_mut().flatten().for_each(|values| select(values, keep));
    }

    /// Drops all vertices from `n` on.
    pub(crate) fn truncate_vertices(&mut self, n: usize) {
        self.positions.truncate(n);
        self.normals.iter_mut().for_each(|values| values.truncate(n));
        self.colors.iter_mut().for_each(|values| values.truncate(n));
        self.secondary.iter_mut().for_each(|values| values.truncate(n));
        self.fog.iter_mut().for_each(|values| values.truncate(n));
        self.edges.iter_mut().for_each(|values| values.truncate(n));
        self.tex.iter_mut().flatten().for_each(|values| values.truncate(n));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_attribute_is_found_again() {
        let mut current = Current::default();
        for which in 0..COUNT {
            current.set(which, [1.0, 0.0, 0.0, 1.0]);
            assert_eq!(current.get(which)[0], 1.0);
        }
        assert_eq!(each(0b1010).collect::<Vec<_>>(), [1, 3]);
        assert_eq!(each(0).count(), 0);
    }
}
