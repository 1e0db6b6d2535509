//! The layers of a tile, as many as memory is allowed for.
//!
//! Every facet in front of a sample is one entry. Thousands of faces behind each other would fill
//! any memory, so the list has a limit. When it is reached, each sample keeps its nearest few and
//! loses the ones behind, which count least in the picture; what was lost is counted, so that the
//! user can be told. Which entries survive depends on depth and facet alone: in whatever order
//! facets come, the same ones stay.
//!
//! Whoever wants to know which facets are in a pixel, at whichever samples, asks for fragments
//! ([`LayerList::gather`]): they take half the memory. Before they could take more than is allowed
//! they are spread out into samples, so that the limit means the same.
//!
//! Cost: constant an entry; at the limit a sort, after which at least half the list is free.

use crate::TILE_PIXELS;

/// A facet seen at a sample, in front of the nearest opaque one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// `sample * TILE_PIXELS + y * TILE + x` within the tile.
    pub at: u32,
    /// Depth, 1 near.
    pub depth: f32,
    /// Id of the facet.
    pub facet: u32,
}

/// A facet in a pixel, in front of the nearest opaque one at each sample that it covers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fragment {
    /// Id of the facet.
    pub facet: u32,
    /// Where its depths begin in [`LayerList::depths`]: one for each sample that it covers, in the
    /// order of samples.
    pub start: u32,
    /// The farthest of them.
    pub far: f32,
    /// The nearest of them.
    pub near: f32,
    /// `y * TILE + x` within the tile.
    pub pixel: u16,
    /// The samples that it covers, one bit each; not 0.
    pub mask: u32,
    /// How many they are.
    pub count: u16,
}

/// A list of layers with a limit.
#[derive(Clone, Debug)]
pub struct LayerList {
    /// The layers, in the order in which they came.
    list: Vec<Layer>,
    limit: usize,
    /// Layers of each sample that stay when the limit is reached.
    kept: usize,
    /// Layers that the limit has dropped.
    lost: u64,
    /// Entries come from back to front, and stay in their order.
    from_back: bool,
    /// Fragments are kept as they come.
    gathers: bool,
    fragments: Vec<Fragment>,
    /// Depths of the fragments' samples, fragment by fragment.
    depths: Vec<f32>,
}

impl Default for LayerList {
    /// Without a limit.
    fn default() -> Self {
        let (list, fragments, depths) = (Vec::new(), Vec::new(), Vec::new());
        Self {
            list,
            limit: usize::MAX,
            kept: usize::MAX,
            lost: 0,
            from_back: false,
            gathers: false,
            fragments,
            depths,
        }
    }
}

impl LayerList {
    /// At most `limit` entries of a tile with `samples` samples a pixel; two for each sample are
    /// always allowed.
    pub fn new(limit: usize, samples: usize) -> Self {
        let tile = TILE_PIXELS * samples;
        let limit = limit.max(2 * tile);
        // Half the list at most stays: then a sort pays for at least as many entries as it looked
        // at.
        Self { limit, kept: limit / (2 * tile), ..Self::default() }
    }

    /// For entries that come from back to front: their order is kept, and the nearest of a sample
    /// are its last.
    #[must_use]
    pub fn from_back_to_front(self) -> Self {
        Self { from_back: true, ..self }
    }

    /// Keeps fragments as they are, for someone who takes [`Self::fragments`]; to be called before
    /// the first entry. By a list, where parts of a facet come at different times, there are none.
    pub fn gather(&mut self) {
        self.gathers = !self.from_back && self.list.is_empty();
    }

    /// Whether [`Self::fragments`] are all that there is; else all samples are in the list.
    pub fn gathers(&self) -> bool {
        self.gathers
    }

    /// The fragments, in the order in which they came.
    pub fn fragments(&self) -> &[Fragment] {
        &self.fragments
    }

    /// The fragments' depths, 1 near.
    pub fn depths(&self) -> &[f32] {
        &self.depths
    }

    /// Takes them out.
    pub fn take_depths(&mut self) -> Vec<f32> {
        std::mem::take(&mut self.depths)
    }

    /// How many samples the entries have.
    pub fn sample_count(&self) -> usize {
        self.list.len() + self.depths.len()
    }

    /// Makes room for one layer all over a tile.
    pub(crate) fn expect_fragments(&mut self, samples: usize) {
        if self.gathers && self.fragments.capacity() == 0 {
            self.fragments.reserve(TILE_PIXELS);
            self.depths.reserve(samples * TILE_PIXELS);
        }
    }

    /// Adds a fragment, given its place and facet, of a pixel with `samples` samples, at most
    /// `MAX`: `at` says whether it covers a sample, and its depth there.
    #[inline(always)]
    pub(crate) fn push_fragment<const MAX: usize>(
        &mut self,
        place: Fragment,
        samples: usize,
        at: impl Fn(usize) -> (bool, f32),
    ) {
        // Depths are written in any case, and those kept where it is seen: no branch to guess.
        let start = self.depths.len();
        self.depths.resize(start + MAX, 0.0);
        let depths = &mut self.depths[start..start + MAX];
        let (mut mask, mut count) = (0u32, 0usize);
        for s in 0..samples.min(MAX) {
            let (seen, depth) = at(s);
            depths[count % MAX] = depth;
            count += usize::from(seen);
            mask |= u32::from(seen) << s;
        }

        // Gather the fragment, or spread it to the lists of its samples.
        let fragment = Fragment { start: start as u32, mask, count: count as u16, ..place };
        if self.gathers {
            self.depths.truncate(start + count);
            self.fragments.push(fragment);
        } else {
            let depths = std::mem::take(&mut self.depths);
            self.spread(fragment, &depths[..count]);
        }
    }

    /// Spreads fragments out into samples as soon as they, and then the samples besides, could take
    /// more memory than the list may have.
    #[inline(always)]
    pub(crate) fn spread_at_limit(&mut self) {
        let bytes =
            self.fragments.len() * size_of::<Fragment>() + self.depths.len() * size_of::<f32>();
        if bytes / size_of::<Layer>() > self.limit / 3 {
            self.spread_all();
        }
    }

    #[cold]
    #[inline(never)]
    fn spread_all(&mut self) {
        self.gathers = false;
        let (fragments, depths) =
            (std::mem::take(&mut self.fragments), std::mem::take(&mut self.depths));
        for fragment in fragments {
            self.spread(
                fragment,
                &depths[fragment.start as usize..][..usize::from(fragment.count)],
            );
        }
    }

    fn spread(&mut self, fragment: Fragment, depths: &[f32]) {
        let samples = (0..u32::BITS as usize).filter(|s| fragment.mask >> s & 1 == 1);
        for (sample, &depth) in samples.zip(depths) {
            let at = (sample * TILE_PIXELS + usize::from(fragment.pixel)) as u32;
            self.push(Layer { at, depth, facet: fragment.facet });
        }
    }

    /// Adds an entry.
    #[inline(always)]
    pub fn push(&mut self, layer: Layer) {
        if self.list.len() >= self.limit {
            self.keep_nearest();
        }
        self.list.push(layer);
    }

    /// To be called after the last entry: if the limit was reached, every sample has its nearest
    /// few and no more.
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
        self.list.sort_unstable_by(|a, b| {
            (a.at.cmp(&b.at)).then(b.depth.total_cmp(&a.depth)).then(a.facet.cmp(&b.facet))
        });
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
            let nearest =
                all.iter().filter(|l| l.at == layer.at).map(|l| l.depth).fold(0.0, f32::max);
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
    fn fragments_beyond_the_limit_are_its_samples() {
        let mut gathered = LayerList::new(2 * TILE_PIXELS, 4);
        gathered.gather();
        let mut samples = LayerList::new(2 * TILE_PIXELS, 4);
        for i in 0..60_000u32 {
            // Samples 0 and 2 of a pixel each.
            let (pixel, depths) =
                ((i * 7919 % 3) as u16, [(i % 1000) as f32 / 1000.0, 0.5, 0.0, 0.0]);
            let place = Fragment { facet: i, pixel, ..Fragment::default() };
            gathered.push_fragment::<4>(place, 4, |s| (s % 2 == 0, depths[s / 2]));
            gathered.spread_at_limit();
            for (sample, depth) in [0, 2].into_iter().zip(depths) {
                samples.push(Layer {
                    at: (sample * TILE_PIXELS) as u32 + u32::from(pixel),
                    depth,
                    facet: i,
                });
            }
        }
        let ends = [&mut gathered, &mut samples].map(|list| {
            list.finish();
            let mut left = list.to_vec();
            left.sort_by_key(|l| (l.at, l.facet));
            (left, list.lost(), list.sample_count())
        });
        assert!(!gathered.gathers() && ends[0].1 > 0);
        assert_eq!(ends[0], ends[1]);
    }

    #[test]
    fn below_the_limit_nothing_is_lost() {
        let mut layers = LayerList::default();
        (0..100_000).for_each(|i| layers.push(Layer { at: 0, depth: 0.5, facet: i }));
        layers.finish();
        assert_eq!((layers.len(), layers.lost()), (100_000, 0));
    }
}
