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
    /// The points that rays are followed on from, one for each sample.
    pub followed: Vec<u32>,
    /// Layers, facet by facet in each pixel, in the order of the scene.
    pub fragments: Vec<FragmentPoint>,
    /// Their depths, sample by sample.
    pub depths: Vec<f32>,
    layers: Vec<LayerPoint>,
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
#[derive(Clone, Copy, Default)]
struct LayerPoint {
    pixel: u32,
    sample: u32,
    depth: f32,
    facet: u32,
}

impl LayerPoint {
    fn key(&self) -> u64 {
        u64::from(self.pixel) << 36 | u64::from(self.facet) << 4 | u64::from(self.sample)
    }
}

/// A facet in a pixel, in front of its opaque samples.
#[derive(Clone, Copy)]
pub(crate) struct FragmentPoint {
    /// The pixel's number in the tile.
    pub pixel: u32,
    /// The facet.
    pub facet: u32,
    /// Which samples it covers.
    pub mask: u32,
    /// Its depth at each of them, from this place in [`Points::depths`].
    pub start: u32,
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
        self.fragments.clear();
        self.depths.clear();
        self.pixels.clear();
        self.mixed.clear();
        self.followed.clear();
        if tile.touched {
            if constants.view.pattern.len() == 1 && !constants.follows_rays() {
                self.collect_single(tile, constants);
            } else {
                self.collect_opaque(tile, constants);
            }
        }
        self.covered_pixels = self.pixels.len() as u64;
        if !layers.is_empty() {
            self.collect_layers(tile, layers, constants, marks);
        }
        self.group(constants);
    }

    /// [`Self::collect_opaque`] for one sample a pixel and no rays that go on: no pixel is mixed.
    fn collect_single(&mut self, tile: &Tile, constants: &FrameConstants<'_>) {
        let (width, height) = visible_part(tile, constants);
        self.facet.resize(TILE_PIXELS, 0);
        self.place.resize(TILE_PIXELS, [0.0; 2]);
        self.pixels.resize(TILE_PIXELS, Pixel { index: 0, source: Source::Point(0) });
        let mut count = 0;
        for y in 0..height {
            let row = y * TILE;
            let down = (tile.y as usize + y) as f32 + 0.5;
            for (x, &facet) in tile.facet[row..row + width].iter().enumerate() {
                // Written in any case, kept where something is: no branch to guess.
                self.facet[count] = facet;
                self.place[count] = [(tile.x as usize + x) as f32 + 0.5, down];
                self.pixels[count] = Pixel { index: (row + x) as u32, source: Source::Point(count as u32) };
                count += usize::from(facet != NO_FACET);
                if count == TILE_PIXELS {
                    return;
                }
            }
        }
        self.facet.truncate(count);
        self.place.truncate(count);
        self.pixels.truncate(count);
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
                let source = if !constants.follows(first) && (1..samples).all(|s| facet_of(s) == first) {
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
            if constants.follows(facet) {
                // Rays go their own way from every sample.
                let point = self.push(facet, middle(place, 1 << s, constants));
                self.mixed[start + s] = point;
                self.followed.push(point);
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
        self.sort_layers(tile, layers, constants);
        // A clipped facet's pieces may both touch a sample on their common border: keep the nearer.
        self.layers.dedup_by(|second, first| {
            let same = second.key() == first.key();
            if same {
                first.depth = first.depth.max(second.depth);
            }
            same
        });
        let mut i = 0;
        while i < self.layers.len() {
            // One point for each facet in a pixel.
            let LayerPoint { pixel, facet, .. } = self.layers[i];
            let same = |l: &&LayerPoint| l.pixel == pixel && l.facet == facet;
            let (start, mut mask) = (self.depths.len() as u32, 0);
            for layer in self.layers[i..].iter().take_while(same) {
                mask |= 1 << layer.sample;
                self.depths.push(layer.depth);
                i += 1;
            }
            let mark = marks.index(facet);
            let source = mark.unwrap_or_else(|| {
                let (x, y) = (pixel as usize % TILE, pixel as usize / TILE);
                let place = [(tile.x as usize + x) as f32, (tile.y as usize + y) as f32];
                self.push(facet, middle(place, mask, constants))
            });
            self.fragments.push(FragmentPoint { pixel, facet, mask, start, source, is_mark: mark.is_some() });
        }
    }

    /// Layers pixel by pixel, facet by facet, sample by sample. A counting sort by pixel leaves each pixel's in the order
    /// in which they came, which mostly is that of the scene: little is left to sort.
    fn sort_layers(&mut self, tile: &Tile, layers: &[Layer], constants: &FrameConstants<'_>) {
        let (width, height) = visible_part(tile, constants);
        let pixel_of = |l: &Layer| l.at as usize % TILE_PIXELS;
        let inside = |pixel: usize| pixel % TILE < width && pixel / TILE < height;
        let starts = &mut self.starts;
        starts.clear();
        starts.resize(TILE_PIXELS + 1, 0);
        for pixel in layers.iter().map(pixel_of).filter(|&p| inside(p)) {
            starts[pixel + 1] += 1;
        }
        for pixel in 0..TILE_PIXELS {
            starts[pixel + 1] += starts[pixel];
        }
        self.layers.clear();
        self.layers.resize(starts[TILE_PIXELS] as usize, LayerPoint::default());
        for layer in layers {
            let (sample, pixel) = (layer.at / TILE_PIXELS as u32, pixel_of(layer));
            if inside(pixel) {
                self.layers[starts[pixel] as usize] =
                    LayerPoint { pixel: pixel as u32, sample, depth: layer.depth, facet: layer.facet };
                starts[pixel] += 1;
            }
        }
        // Each start has moved to the end of its pixel.
        let mut start = 0;
        for &end in &starts[..TILE_PIXELS] {
            let end = end as usize;
            if end > start + 1 {
                self.layers[start..end].sort_unstable_by_key(LayerPoint::key);
            }
            start = end;
        }
    }

    /// Takes facets as points that are nowhere on the screen, and sorts them into groups.
    pub(crate) fn collect_facets(&mut self, facets: impl Iterator<Item = u32>, constants: &FrameConstants<'_>) {
        self.facet.clear();
        self.facet.extend(facets);
        self.group(constants);
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
