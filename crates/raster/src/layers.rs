//! The layers of a tile, as many as memory is allowed for.
//!
//! Every facet in front of a sample is one entry. Thousands of faces behind each other would fill any memory, so the
//! list has a limit. When it is reached, each sample keeps its nearest few and loses the ones behind, which count least
//! in the picture; what was lost is counted, so that the user can be told. Which entries survive depends on depth and
//! facet alone: in whatever order facets come, the same ones stay.
//!
//! Cost: constant an entry; at the limit a sort, after which at least half the list is free.

use crate::{Layer, TILE_PIXELS};

/// A list of layers with a limit.
#[derive(Clone, Debug)]
pub struct LayerList {
    list: Vec<Layer>,
    limit: usize,
    /// LayerList of each sample that stay when the limit is reached.
    kept: usize,
    lost: u64,
    /// Entries come from back to front, and stay in their order.
    from_back: bool,
}

impl Default for LayerList {
    /// Without a limit.
    fn default() -> Self {
        Self { list: Vec::new(), limit: usize::MAX, kept: usize::MAX, lost: 0, from_back: false }
    }
}

impl LayerList {
    /// At most `limit` entries of a tile with `samples` samples a pixel; two for each sample are always allowed.
    pub fn new(limit: usize, samples: usize) -> Self {
        let tile = TILE_PIXELS * samples;
        let limit = limit.max(2 * tile);
        // Half the list at most stays: then a sort pays for at least as many entries as it looked at.
        Self { limit, kept: limit / (2 * tile), ..Self::default() }
    }

    /// For entries that come from back to front: their order is kept, and the nearest of a sample are its last.
    #[must_use]
    pub fn from_back_to_front(self) -> Self {
        Self { from_back: true, ..self }
    }

    /// Adds an entry.
    #[inline(always)]
    pub fn push(&mut self, layer: Layer) {
        if self.list.len() >= self.limit {
            self.keep_nearest();
        }
        self.list.push(layer);
    }

    /// To be called after the last entry: if the limit was reached, every sample has its nearest few and no more.
    pub fn finish(&mut self) {
        if self.lost > 0 || self.list.len() >= self.limit {
            self.keep_nearest();
        }
    }

    /// How many entries were dropped.
    pub fn lost(&self) -> u64 {
        self.lost
    }

    #[cold]
    #[inline(never)]
    fn keep_nearest(&mut self) {
        if self.from_back {
            return self.keep_last();
        }
        self.list
            .sort_unstable_by(|a, b| (a.at.cmp(&b.at)).then(b.depth.total_cmp(&a.depth)).then(a.facet.cmp(&b.facet)));
        let before = self.list.len();
        let (mut at, mut rank) = (u32::MAX, 0);
        let kept = self.kept;
        self.list.retain(|layer| {
            rank = if layer.at == at { rank + 1 } else { 0 };
            at = layer.at;
            rank < kept
        });
        self.lost += (before - self.list.len()) as u64;
    }

    /// Of each sample the last few entries stay, in their order.
    fn keep_last(&mut self) {
        let samples = self.list.iter().map(|l| l.at as usize + 1).max().unwrap_or(0);
        let mut surplus = vec![0usize; samples];
        self.list.iter().for_each(|l| surplus[l.at as usize] += 1);
        surplus.iter_mut().for_each(|count| *count = count.saturating_sub(self.kept));
        let before = self.list.len();
        self.list.retain(|l| {
            let surplus = &mut surplus[l.at as usize];
            let stays = *surplus == 0;
            *surplus -= usize::from(!stays);
            stays
        });
        self.lost += (before - self.list.len()) as u64;
    }
}

impl std::ops::Deref for LayerList {
    type Target = [Layer];

    fn deref(&self) -> &[Layer] {
        &self.list
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_layers_stay_in_whatever_order_they_come() {
        let limit = 2 * TILE_PIXELS;
        // 3 samples with 10,000 layers each; the limit leaves one a sample.
        let mut all: Vec<Layer> = (0..30_000)
            .map(|i| Layer { at: i % 3, depth: ((i * 7919) % 30_000) as f32 / 30_000.0, facet: i })
            .collect();
        let run = |list: &[Layer]| {
            let mut layers = LayerList::new(limit, 1);
            list.iter().for_each(|l| layers.push(*l));
            layers.finish();
            let mut left = layers.to_vec();
            left.sort_by_key(|l| (l.at, l.facet));
            (left, layers.lost())
        };
        let (left, lost) = run(&all);
        assert_eq!((left.len(), lost), (3, 29_997));
        for layer in &left {
            let nearest = all.iter().filter(|l| l.at == layer.at).map(|l| l.depth).fold(0.0, f32::max);
            assert_eq!(layer.depth, nearest);
        }
        all.reverse();
        assert_eq!(run(&all), (left.clone(), lost));
        all.rotate_left(12_345);
        assert_eq!(run(&all), (left, lost));
    }

    #[test]
    fn from_back_to_front_the_last_layers_stay_in_their_order() {
        let mut layers = LayerList::new(4 * TILE_PIXELS, 1).from_back_to_front();
        (0..30_000).for_each(|i| layers.push(Layer { at: i % 3, depth: 0.5, facet: i }));
        layers.finish();
        let left: Vec<_> = layers.iter().map(|l| l.facet).collect();
        assert_eq!((left, layers.lost()), ((29_994..30_000).collect(), 29_994));
    }

    #[test]
    fn below_the_limit_nothing_is_lost() {
        let mut layers = LayerList::default();
        (0..100_000).for_each(|i| layers.push(Layer { at: 0, depth: 0.5, facet: i }));
        layers.finish();
        assert_eq!((layers.len(), layers.lost()), (100_000, 0));
    }
}
