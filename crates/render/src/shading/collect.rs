//! Which points of a tile to illuminate, sorted by object and material: one for each facet in a
//! pixel.
//!
//! In:   the facets and depths of a tile's samples, and what lies in front of them. Out: its
//!       [`Points`].
//! Cost: linear in samples; layers are sorted pixel by pixel.

use super::FrameConstants;
use super::points::{
    FragmentPoint, Group, LayerPoint, NO_POINT, Pixel, Points, Source, samples_in, visible_part,
};
use crate::marks::MarkColors;
use crate::visible::Peel;
use vitral_raster::{Fragment, Layer, NO_FACET, TILE, TILE_PIXELS, Tile};

/// Pixels of a row that are looked at together.
const RUN: usize = 8;

/// What lies in front of a tile's opaque samples.
pub(crate) enum InFront<'l> {
    /// Sample by sample.
    Samples(&'l [Layer]),
    /// Facets in pixels, and their depths.
    Fragments(&'l [Fragment], Vec<f32>),
}

impl Points {
    /// Finds the points of a tile and sorts them into groups.
    pub(crate) fn collect(
        &mut self,
        tile: &Tile,
        layers: InFront<'_>,
        constants: &FrameConstants<'_>,
        marks: &MarkColors,
    ) {
        // Empty the lists.
        self.facet.clear();
        self.place.clear();
        self.layers.clear();
        self.fragments.clear();
        self.depths.clear();
        self.pixels.clear();
        self.mixed.clear();
        self.followed.clear();
        self.overruled = 0;

        // Collect the opaque points.
        if tile.touched {
            match constants.view.pattern.len() {
                _ if constants.follows_rays() => self.collect_opaque(tile, constants),
                1 => self.collect_single(tile, constants),
                2 => self.collect_samples::<2>(tile, constants),
                4 => self.collect_samples::<4>(tile, constants),
                _ => self.collect_opaque(tile, constants),
            }
        }

        // Collect the layers, and group all points.
        self.covered_pixels = self.pixels.len() as u64;
        match layers {
            InFront::Samples([]) | InFront::Fragments([], _) => {}
            InFront::Samples(layers) => self.collect_layers(tile, layers, constants, marks),
            InFront::Fragments(fragments, depths) => {
                self.depths = depths;
                self.collect_fragments(tile, fragments, constants, marks);
            }
        }
        self.group(constants);
    }

    /// [`Self::collect_opaque`] for one sample a pixel and no rays that go on: no pixel is mixed.
    fn collect_single(&mut self, tile: &Tile, constants: &FrameConstants<'_>) {
        let (width, height) = visible_part(tile, constants.view.viewport);
        let mut count = 0;
        for y in 0..height {
            let row = y * TILE;
            let down = (tile.y as usize + y) as f32 + 0.5;
            for (facets, first) in tile.facet[row..row + width].chunks(RUN).zip((0..).step_by(RUN))
            {
                if is_empty(facets) {
                    continue;
                }
                if self.facet.len() < count + RUN {
                    self.facet.resize(count + 16 * RUN, 0);
                    self.place.resize(count + 16 * RUN, [0.0; 2]);
                    self.pixels
                        .resize(count + 16 * RUN, Pixel { index: 0, source: Source::Point(0) });
                }
                for (x, &facet) in (first..).zip(facets) {
                    // Written in any case, kept where something is: no branch to guess.
                    self.facet[count] = facet;
                    self.place[count] = [(tile.x as usize + x) as f32 + 0.5, down];
                    self.pixels[count] =
                        Pixel { index: (row + x) as u32, source: Source::Point(count as u32) };
                    count += usize::from(facet != NO_FACET);
                }
            }
        }
        self.facet.truncate(count);
        self.place.truncate(count);
        self.pixels.truncate(count);
    }

    /// [`Self::collect_opaque`] for few samples and no rays that go on: where facets are small,
    /// whether they fill a pixel is anyone's guess, so everything is written in any case, and kept
    /// where it is needed.
    fn collect_samples<const SAMPLES: usize>(
        &mut self,
        tile: &Tile,
        constants: &FrameConstants<'_>,
    ) {
        let middles = &constants.middles[..1 << SAMPLES];
        let (width, height) = visible_part(tile, constants.view.viewport);
        let [mut points, mut pixels, mut mixed] = [0; 3];
        // Find which samples of the run differ and whether it is empty.
        for y in 0..height {
            let down = (tile.y as usize + y) as f32;
            for first in (0..width).step_by(RUN) {
                let start = y * TILE + first;
                let planes: [&[u32; RUN]; SAMPLES] = std::array::from_fn(|s| {
                    tile.facet[s * TILE_PIXELS + start..]
                        .first_chunk()
                        .expect("a tile's rows are whole runs")
                });
                let (mut all, mut different) = ([NO_FACET; RUN], [0; RUN]);
                for plane in planes {
                    for x in 0..RUN {
                        all[x] &= plane[x];
                        different[x] |= plane[x] ^ planes[0][x];
                    }
                }
                if is_empty(&all) {
                    continue;
                }

                // Reserve room for the whole run.
                if self.facet.len() < points + RUN * SAMPLES {
                    self.facet.resize(points + 16 * RUN * SAMPLES, 0);
                    self.place.resize(points + 16 * RUN * SAMPLES, [0.0; 2]);
                }
                if self.pixels.len() < pixels + RUN {
                    self.pixels
                        .resize(pixels + 16 * RUN, Pixel { index: 0, source: Source::Point(0) });
                }
                if self.mixed.len() < mixed + RUN * SAMPLES {
                    self.mixed.resize(mixed + 16 * RUN * SAMPLES, NO_POINT);
                }

                // Write each sample's point.
                for x in 0..RUN.min(width - first) {
                    let facets: [u32; SAMPLES] = std::array::from_fn(|s| planes[s][x]);
                    let across = (tile.x as usize + first + x) as f32;
                    let mut point_of = [NO_POINT; SAMPLES];
                    for s in 0..SAMPLES {
                        // The facet is new unless an earlier sample has it.
                        let (mut point, mut is_new, mut mask) =
                            (points as u32, facets[s] != NO_FACET, 0);
                        for t in 0..s {
                            let same = facets[t] == facets[s];
                            point = if same { point_of[t] } else { point };
                            is_new &= !same;
                        }
                        for t in s..SAMPLES {
                            mask |= usize::from(facets[t] == facets[s]) << t;
                        }
                        let [right, below] = middles[mask];
                        self.facet[points] = facets[s];
                        self.place[points] = [across + right, down + below];
                        points += usize::from(is_new);
                        point_of[s] = if facets[s] == NO_FACET { NO_POINT } else { point };
                    }

                    // Write the pixel, with its points if they differ.
                    let is_mixed = different[x] != 0;
                    let source = if is_mixed {
                        Source::Mixed(mixed as u32)
                    } else {
                        Source::Point(point_of[0])
                    };
                    self.mixed[mixed..mixed + SAMPLES].copy_from_slice(&point_of);
                    self.pixels[pixels] = Pixel { index: (start + x) as u32, source };
                    mixed += SAMPLES * usize::from(is_mixed);
                    pixels += usize::from(all[x] != NO_FACET);
                }
            }
        }
        self.facet.truncate(points);
        self.place.truncate(points);
        self.pixels.truncate(pixels);
        self.mixed.truncate(mixed);
    }

    fn collect_opaque(&mut self, tile: &Tile, constants: &FrameConstants<'_>) {
        let samples = constants.view.pattern.len();
        let (width, height) = visible_part(tile, constants.view.viewport);

        // Visit the rows in runs and skip empty ones.
        for y in 0..height {
            let row = y * TILE;
            for x in (0..width).step_by(RUN) {
                let run = row + x..row + width.min(x + RUN);
                if (0..samples).all(|s| is_empty(&tile.facet[s * TILE_PIXELS..][run.clone()])) {
                    continue;
                }
                for pixel in run {
                    let x = pixel - row;
                    let first = tile.facet[pixel];
                    let facet_of = |s: usize| tile.facet[s * TILE_PIXELS + pixel];
                    let place = [(tile.x as usize + x) as f32, (tile.y as usize + y) as f32];
                    let source = if !constants.follows(first)
                        && (1..samples).all(|s| facet_of(s) == first)
                    {
                        // The common case: one facet, or none, fills the pixel.
                        if first == NO_FACET {
                            continue;
                        }
                        Source::Point(self.push(first, [place[0] + 0.5, place[1] + 0.5]))
                    } else {
                        self.mix(samples, facet_of, place, constants)
                    };
                    self.pixels.push(Pixel { index: pixel as u32, source });
                }
            }
        }
    }

    /// One point for each facet among a pixel's samples.
    fn mix(
        &mut self,
        samples: usize,
        facet_of: impl Fn(usize) -> u32,
        place: [f32; 2],
        constants: &FrameConstants<'_>,
    ) -> Source {
        let start = self.mixed.len();
        self.mixed.resize(start + samples, NO_POINT);
        for s in 0..samples {
            let facet = facet_of(s);
            if facet == NO_FACET || self.mixed[start + s] != NO_POINT {
                continue;
            }
            if constants.follows(facet) {
                // Rays go their own way from every sample.
                let point = self.push(facet, constants.middle(place, 1 << s));
                self.mixed[start + s] = point;
                self.followed.push(point);
                continue;
            }
            let mask = (s..samples).filter(|&t| facet_of(t) == facet).fold(0, |m, t| m | 1 << t);
            let point = self.push(facet, constants.middle(place, mask));
            for t in (s..samples).filter(|t| mask >> t & 1 == 1) {
                self.mixed[start + t] = point;
            }
        }
        Source::Mixed(start as u32)
    }

    fn collect_layers(
        &mut self,
        tile: &Tile,
        layers: &[Layer],
        constants: &FrameConstants<'_>,
        marks: &MarkColors,
    ) {
        self.sort_layers(tile, layers, constants);
        let mut layers = std::mem::take(&mut self.layers);
        let mut start = 0;
        for pixel in 0..TILE_PIXELS {
            let end = self.ends[pixel] as usize;
            let here = &mut layers[start..end];
            start = end;
            if here.is_empty() {
                continue;
            }
            let place =
                [(tile.x as usize + pixel % TILE) as f32, (tile.y as usize + pixel / TILE) as f32];
            if constants.view.lists_layers {
                self.collect_listed(pixel as u32, here, place, constants, marks);
                continue;
            }

            // Emit one fragment for each facet. Layers mostly come in the order of the scene.
            let count =
                if here.is_sorted_by(|a, b| a.key() < b.key()) { here.len() } else { settle(here) };
            let mut i = 0;
            while i < count {
                // One point for each facet in a pixel.
                let facet = here[i].facet;
                let (start, mut mask) = (self.depths.len() as u32, 0);
                while i < count && here[i].facet == facet {
                    mask |= 1 << here[i].sample;
                    self.depths.push(here[i].depth);
                    i += 1;
                }
                let mark = marks.index(facet);
                let source =
                    mark.unwrap_or_else(|| self.push(facet, constants.middle(place, mask)));
                let fragment =
                    self.fragment((pixel as u32, facet), (mask, start), (source, mark.is_some()));
                self.fragments.push(fragment);
            }
        }
        self.layers = layers;
    }

    /// [`Self::collect_layers`] of facets whose samples in a pixel are together.
    fn collect_fragments(
        &mut self,
        tile: &Tile,
        fragments: &[Fragment],
        constants: &FrameConstants<'_>,
        marks: &MarkColors,
    ) {
        self.sort_fragments(tile, fragments, constants);
        // Mostly they come in the order of the scene, each facet once.
        if !self.fragments.is_sorted_by(|a, b| (a.pixel, a.facet) < (b.pixel, b.facet)) {
            self.unite();
        }
        let first = self.facet.len() as u32;
        let mut sources = first..;
        for fragment in &mut self.fragments {
            let mark = marks.index(fragment.facet);
            fragment.is_mark = mark.is_some();
            fragment.source = mark.or_else(|| sources.next()).unwrap_or(first);
        }
        let corner = [tile.x as usize, tile.y as usize];
        let place = |f: &FragmentPoint| {
            let pixel = f.pixel as usize;
            constants.middle(
                [(corner[0] + pixel % TILE) as f32, (corner[1] + pixel / TILE) as f32],
                f.mask,
            )
        };
        let surfaces = || self.fragments.iter().filter(|f| !f.is_mark);
        self.facet.extend(surfaces().map(|f| f.facet));
        self.place.extend(surfaces().map(place));
    }

    /// Sorts each pixel's fragments by facet and makes one of those of a facet, as where it was
    /// clipped into several triangles: of a sample on their common border the nearer depth stays.
    fn unite(&mut self) {
        let mut fragments = std::mem::take(&mut self.fragments);
        fragments.sort_by_key(|f| (f.pixel, f.facet));
        fragments.dedup_by(|next, f| {
            let same = (next.pixel, next.facet) == (f.pixel, f.facet);
            if same {
                let (start, mask) = (self.depths.len() as u32, f.mask | next.mask);
                for sample in samples_in(mask) {
                    let depth = |f: &FragmentPoint| {
                        if f.covers(sample) { self.depth(f, sample) } else { f32::MIN }
                    };
                    self.depths.push(depth(f).max(depth(next)));
                }
                *f = self.fragment((f.pixel, f.facet), (mask, start), (0, false));
            }
            same
        });
        self.fragments = fragments;
    }

    /// Fragments pixel by pixel, each pixel's in the order in which they came.
    fn sort_fragments(
        &mut self,
        tile: &Tile,
        fragments: &[Fragment],
        constants: &FrameConstants<'_>,
    ) {
        let inside = pixels_inside(tile, constants);
        let point = |f: &Fragment| {
            let &Fragment { facet, start, far, near, pixel, mask, count } = f;
            let (pixel, count) = (u32::from(pixel), u32::from(count));
            (
                pixel as usize,
                FragmentPoint {
                    pixel,
                    facet,
                    mask,
                    start,
                    count,
                    far,
                    near,
                    source: 0,
                    is_mark: false,
                },
            )
        };
        let points = fragments.iter().map(point).filter(|(pixel, _)| inside(*pixel));
        sort_by_slot(&mut self.ends, TILE_PIXELS, &mut self.fragments, points);
    }

    /// Layers of one pass, a fragment for each facet in a pixel, illuminated where it would be with
    /// all layers at once.
    pub(crate) fn collect_pass(
        &mut self,
        tile: &Tile,
        peel: &Peel,
        constants: &FrameConstants<'_>,
        marks: &MarkColors,
    ) {
        // Empty the lists.
        self.facet.clear();
        self.place.clear();
        self.fragments.clear();
        self.depths.clear();
        let (samples, (width, height)) =
            (constants.view.pattern.len(), visible_part(tile, constants.view.viewport));

        // Emit one fragment for each facet of the layer.
        for pixel in (0..height).flat_map(|y| (0..width).map(move |x| y * TILE + x)) {
            let place =
                [(tile.x as usize + pixel % TILE) as f32, (tile.y as usize + pixel / TILE) as f32];
            let layer = |sample: usize| peel.layer(sample * TILE_PIXELS + pixel);
            let mut done = 0u32;
            for first in 0..samples {
                let Some(found) = layer(first).filter(|_| done >> first & 1 == 0) else { continue };
                let (facet, start, mut mask) = (found.facet, self.depths.len() as u32, 0);
                for sample in first..samples {
                    if let Some(same) = layer(sample).filter(|l| l.facet == facet) {
                        mask |= 1 << sample;
                        self.depths.push(same.depth);
                    }
                }
                done |= mask;
                let mark = marks.index(facet);
                let source =
                    mark.unwrap_or_else(|| self.push(facet, constants.middle(place, found.covers)));
                let fragment =
                    self.fragment((pixel as u32, facet), (mask, start), (source, mark.is_some()));
                self.fragments.push(fragment);
            }
        }
        self.group(constants);
    }

    /// Layers pixel by pixel, each pixel's in the order in which they came; leaves each pixel's end
    /// in `ends`.
    fn sort_layers(&mut self, tile: &Tile, layers: &[Layer], constants: &FrameConstants<'_>) {
        let inside = pixels_inside(tile, constants);
        let point = |l: &Layer| {
            let (sample, pixel) = (l.at / TILE_PIXELS as u32, l.at as usize % TILE_PIXELS);
            (pixel, LayerPoint { sample, depth: l.depth, facet: l.facet })
        };
        let points = layers.iter().map(point).filter(|(pixel, _)| inside(*pixel));
        sort_by_slot(&mut self.ends, TILE_PIXELS, &mut self.layers, points);
    }

    /// Takes facets as points that are nowhere on the screen, and sorts them into groups.
    pub(crate) fn collect_facets(
        &mut self,
        facets: impl Iterator<Item = u32>,
        constants: &FrameConstants<'_>,
    ) {
        self.facet.clear();
        self.facet.extend(facets);
        self.group(constants);
    }

    /// Sorts points by instance and part, keeping their order otherwise (a counting sort).
    fn group(&mut self, constants: &FrameConstants<'_>) {
        let world = &constants.view.session.world;
        self.keys.clear();
        self.key_of_point.clear();
        // Neighbours mostly share object and part: remember the last run of facets.
        let (mut from, mut to, mut key) = (0, 0, 0);
        for &facet in &self.facet {
            if !(from..to).contains(&facet) {
                let i = world.instance_of_facet(facet);
                let instance = &world.instances[i];
                let triangle = facet - instance.first_facet;
                let p = instance.mesh.parts.partition_point(|p| p.triangles.end <= triangle);
                let part = &instance.mesh.parts[p];
                (from, to) = (
                    instance.first_facet + part.triangles.start,
                    instance.first_facet + part.triangles.end,
                );
                let wanted = [i as u32, p as u32];
                key = match self.keys.iter().position(|k| *k == wanted) {
                    Some(k) => k as u32,
                    None => {
                        self.keys.push(wanted);
                        self.keys.len() as u32 - 1
                    }
                };
            }
            self.key_of_point.push(key);
        }

        // Skip sorting where there is one group.
        let count = self.facet.len() as u32;
        if let [[instance, part]] = self.keys[..] {
            // Of one group nothing need be sorted.
            self.groups.clear();
            self.groups.push(Group { instance, part, start: 0, end: count });
            self.order.clear();
            self.order.extend(0..count);
            return;
        }

        // Sort the points by group.
        let points = self.key_of_point.iter().zip(0..).map(|(&key, point)| (key as usize, point));
        sort_by_slot(&mut self.ends, self.keys.len(), &mut self.order, points);
        self.groups.clear();
        let mut start = 0;
        for (&[instance, part], &end) in self.keys.iter().zip(&self.ends) {
            self.groups.push(Group { instance, part, start, end });
            start = end;
        }
    }
}

/// Sorts items by the slots that they come with, those of one slot in the order in which they come
/// (a counting sort). Leaves each slot's end in `ends`.
#[inline(always)]
fn sort_by_slot<T: Copy + Default>(
    ends: &mut Vec<u32>,
    slots: usize,
    sorted: &mut Vec<T>,
    items: impl Iterator<Item = (usize, T)> + Clone,
) {
    ends.clear();
    ends.resize(slots, 0);
    items.clone().for_each(|(slot, _)| ends[slot] += 1);
    let mut sum = 0;
    for end in ends.iter_mut() {
        sum += std::mem::replace(end, sum);
    }
    sorted.clear();
    sorted.resize(sum as usize, T::default());
    for (slot, item) in items {
        let at = &mut ends[slot];
        sorted[*at as usize] = item;
        *at += 1;
    }
}

/// Whether no facet is seen at any of the samples.
#[inline(always)]
fn is_empty(samples: &[u32]) -> bool {
    // All bits are set in `NO_FACET` alone.
    samples.iter().fold(NO_FACET, |all, facet| all & facet) == NO_FACET
}

/// Whether a pixel of the tile lies in the picture.
fn pixels_inside(tile: &Tile, constants: &FrameConstants<'_>) -> impl Fn(usize) -> bool {
    let (width, height) = visible_part(tile, constants.view.viewport);
    let whole = (width, height) == (TILE, TILE);
    move |pixel| whole || (pixel % TILE < width && pixel / TILE < height)
}

/// Sorts a pixel's layers facet by facet, sample by sample; the first so many are left. A clipped
/// facet's pieces may both touch a sample on their common border: the nearer stays.
fn settle(layers: &mut [LayerPoint]) -> usize {
    layers.sort_unstable_by_key(LayerPoint::key);
    let mut last = 0;
    for i in 1..layers.len() {
        let layer = layers[i];
        if layer.key() == layers[last].key() {
            layers[last].depth = layers[last].depth.max(layer.depth);
        } else {
            last += 1;
            layers[last] = layer;
        }
    }
    last + 1
}
