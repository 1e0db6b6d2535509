//! Which points of a tile to illuminate, sorted by object and material.

use super::FrameConstants;
use crate::marks::MarkColors;
use vitral_raster::{Layer, NO_FACET, TILE, TILE_PIXELS, Tile};

/// The points of a tile.
#[derive(Default)]
pub(crate) struct Points {
    /// Facet of each point.
    pub facet: Vec<u32>,
    /// Where it is illuminated, in pixels of the picture.
    pub place: Vec<[f32; 2]>,
    /// Pixels with an opaque surface, in order.
    pub pixels: Vec<Pixel>,
    /// The points of the samples of mixed pixels, or [`NO_POINT`].
    pub mixed: Vec<u32>,
    /// Layers sorted by pixel and sample, at each sample from far to near.
    pub layers: Vec<LayerPoint>,
    /// Points in the order of their groups.
    pub order: Vec<u32>,
    /// Runs of `order` with one object and material.
    pub groups: Vec<Group>,
    /// Pixels with a surface.
    pub covered_pixels: u64,
    keys: Vec<[u32; 2]>,
    key_of_point: Vec<u32>,
    starts: Vec<u32>,
}

/// A sample without an opaque surface.
pub(crate) const NO_POINT: u32 = u32::MAX;

/// A pixel with an opaque surface.
#[derive(Clone, Copy)]
pub(crate) struct Pixel {
    /// Its number in the tile, row by row.
    pub index: u32,
    /// The point that fills it, or where its samples start in [`Points::mixed`].
    pub source: Source,
}

/// What fills a pixel.
#[derive(Clone, Copy)]
pub(crate) enum Source {
    /// One point.
    Point(u32),
    /// Samples from this place in [`Points::mixed`].
    Mixed(u32),
}

/// A layer at a sample.
#[derive(Clone, Copy)]
pub(crate) struct LayerPoint {
    /// `pixel * samples + sample`.
    pub sample: u32,
    depth: f32,
    facet: u32,
    /// Index of a point, or of a mark.
    pub source: u32,
    /// It is a line or a point of the model, not a surface.
    pub is_mark: bool,
}

/// Points of one object with one material.
#[derive(Clone, Copy)]
pub(crate) struct Group {
    /// Index into the world's instances.
    pub instance: u32,
    /// Index into the mesh's parts.
    pub part: u32,
    /// Start in `order`.
    pub start: u32,
    /// End in `order`.
    pub end: u32,
}

impl Points {
    pub(crate) fn len(&self) -> usize {
        self.facet.len()
    }

    /// Finds the points of a tile and sorts them into groups.
    pub(crate) fn collect(
        &mut self,
        tile: &Tile,
        layers: &[Layer],
        constants: &FrameConstants<'_>,
        marks: &MarkColors,
    ) {
        self.facet.clear();
        self.place.clear();
        self.layers.clear();
        self.pixels.clear();
        self.mixed.clear();
        if tile.touched {
            self.collect_opaque(tile, constants);
        }
        self.covered_pixels = self.pixels.len() as u64;
        if !layers.is_empty() {
            self.collect_layers(tile, layers, constants, marks);
        }
        self.group(constants);
    }

    fn collect_opaque(&mut self, tile: &Tile, constants: &FrameConstants<'_>) {
        let samples = constants.view.pattern.len();
        let (width, height) = visible_part(tile, constants);
        for y in 0..height {
            let row = y * TILE;
            for x in 0..width {
                let pixel = row + x;
                let first = tile.facet[pixel];
                let facet_of = |s: usize| tile.facet[s * TILE_PIXELS + pixel];
                let place = [(tile.x as usize + x) as f32, (tile.y as usize + y) as f32];
                let source = if (1..samples).all(|s| facet_of(s) == first) {
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
            let mask = (s..samples).filter(|&t| facet_of(t) == facet).fold(0, |m, t| m | 1 << t);
            let point = self.push(facet, middle(place, mask, constants));
            for t in (s..samples).filter(|t| mask >> t & 1 == 1) {
                self.mixed[start + t] = point;
            }
        }
        Source::Mixed(start as u32)
    }

    fn collect_layers(&mut self, tile: &Tile, layers: &[Layer], constants: &FrameConstants<'_>, marks: &MarkColors) {
        let samples = constants.view.pattern.len();
        let (width, height) = visible_part(tile, constants);
        self.layers.extend(layers.iter().filter_map(|l| {
            let (sample, pixel) = (l.at as usize / TILE_PIXELS, l.at as usize % TILE_PIXELS);
            let inside = pixel % TILE < width && pixel / TILE < height;
            let sample = (pixel * samples + sample) as u32;
            let mark = marks.index(l.facet);
            let source = mark.unwrap_or(NO_POINT);
            inside.then_some(LayerPoint { sample, depth: l.depth, facet: l.facet, source, is_mark: mark.is_some() })
        }));

        // One point for each facet in a pixel.
        let key = |l: &LayerPoint| (l.sample / samples as u32, l.facet, l.sample);
        self.layers.sort_unstable_by_key(key);
        let mut i = 0;
        while i < self.layers.len() {
            let (pixel, facet) = (self.layers[i].sample / samples as u32, self.layers[i].facet);
            let same = |l: &LayerPoint| l.sample / samples as u32 == pixel && l.facet == facet;
            let end = i + self.layers[i..].iter().take_while(|l| same(l)).count();
            if !self.layers[i].is_mark {
                let mask = self.layers[i..end].iter().fold(0, |m, l| m | 1 << (l.sample as usize % samples));
                let (x, y) = (pixel as usize % TILE, pixel as usize / TILE);
                let place = [(tile.x as usize + x) as f32, (tile.y as usize + y) as f32];
                let point = self.push(facet, middle(place, mask, constants));
                self.layers[i..end].iter_mut().for_each(|l| l.source = point);
            }
            i = end;
        }

        // From far to near at each sample; of equal depths the lower facet is in front.
        let order = |a: &LayerPoint, b: &LayerPoint| {
            (a.sample.cmp(&b.sample)).then(a.depth.total_cmp(&b.depth)).then(b.facet.cmp(&a.facet))
        };
        self.layers.sort_unstable_by(order);
        // A clipped facet's pieces may both touch a sample on their common border: keep one.
        self.layers.dedup_by_key(|l| (l.sample, l.facet));
    }

    fn push(&mut self, facet: u32, place: [f32; 2]) -> u32 {
        self.facet.push(facet);
        self.place.push(place);
        self.facet.len() as u32 - 1
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
                (from, to) = (instance.first_facet + part.triangles.start, instance.first_facet + part.triangles.end);
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
        self.starts.clear();
        self.starts.resize(self.keys.len() + 1, 0);
        for &k in &self.key_of_point {
            self.starts[k as usize + 1] += 1;
        }
        for k in 1..self.starts.len() {
            self.starts[k] += self.starts[k - 1];
        }
        self.groups.clear();
        self.groups.extend(self.keys.iter().enumerate().map(|(k, &[instance, part])| Group {
            instance,
            part,
            start: self.starts[k],
            end: self.starts[k + 1],
        }));
        self.order.clear();
        self.order.resize(self.facet.len(), 0);
        for (point, &k) in self.key_of_point.iter().enumerate() {
            let place = &mut self.starts[k as usize];
            self.order[*place as usize] = point as u32;
            *place += 1;
        }
    }
}

/// Columns and rows of the tile that lie in the picture.
pub(crate) fn visible_part(tile: &Tile, constants: &FrameConstants<'_>) -> (usize, usize) {
    let viewport = constants.view.viewport;
    ((viewport.width - tile.x).min(TILE as u32) as usize, (viewport.height - tile.y).min(TILE as u32) as usize)
}

/// Where to illuminate a facet that covers the samples `mask` of the pixel at `place`: at the pixel's centre if it
/// covers them all, else in their middle, so that nothing is extrapolated.
fn middle(place: [f32; 2], mask: u32, constants: &FrameConstants<'_>) -> [f32; 2] {
    let pattern = &constants.view.pattern;
    let count = mask.count_ones();
    if count as usize == pattern.len() {
        return [place[0] + 0.5, place[1] + 0.5];
    }
    let mut sum = [0.0; 2];
    for s in (0..pattern.len()).filter(|s| mask >> s & 1 == 1) {
        let offset = pattern.offset(s);
        sum = [sum[0] + offset[0], sum[1] + offset[1]];
    }
    [place[0] + sum[0] / count as f32, place[1] + sum[1] / count as f32]
}
