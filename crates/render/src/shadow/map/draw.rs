//! The first pass: depths from the light, by the z-buffer algorithm of the renderer itself.
//!
//! Depths are all that is asked of opaque things, and a kernel for depths alone finds them, unless
//! there are so many triangles that the whole map must wait for them. Transparent things are found
//! by their facets, as in a picture.
//!
//! Much of what the light sees is hidden from the viewer. A tile with opaque things alone is drawn
//! when it is first asked about; until then the map keeps its triangles.

use super::lens::Lens;
use super::tiles::{Layer, Map, MapTile, Pending, nearest_depths};
use crate::raytrace::triangles::Triangles;
use crate::shadow::occluders::Occluders;
use crate::stats::CullCounters;
use crate::visible::{
    TileSink, all_batches, give_back, layer_list, resolve_in_passing, tile_origin, touching, walk,
    with_spare,
};
use crate::{Background, Execution, Lines, PreparedView, Session, Settings, Visibility};
use std::sync::{Mutex, OnceLock};
use vitral_exec::Limit;
use vitral_light::Rgb;
use vitral_math::{DMat4, DVec3, dvec3};
use vitral_raster::{Batch, LayerList, NO_FACET, SamplePattern, TILE, TILE_PIXELS, Tile, Viewport};

/// Turns tiles into distances and layers.
struct DepthSink<'a> {
    lens: &'a Lens,
    session: &'a Session,
    occluders: &'a Occluders<'a>,
    center: DVec3,
    execution: &'a Execution,
    tiles: Vec<OnceLock<MapTile>>,
    /// Bytes of transparent things, charged to the budget while the map is drawn, and why it was
    /// given up.
    charged: Mutex<(u64, Option<Limit>)>,
}

/// When a map is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum When {
    /// Before anyone asks: for maps so many that their triangles had better not be kept.
    Before,
    /// Tile by tile as they are asked about, if possible.
    Asked,
}

/// What is drawn into maps, and when.
#[derive(Clone, Copy)]
pub(super) struct FirstPass<'a> {
    pub(super) session: &'a Session,
    pub(super) occluders: &'a Occluders<'a>,
    pub(super) settings: &'a Settings,
    pub(super) execution: &'a Execution,
    pub(super) when: When,
}

impl FirstPass<'_> {
    /// The map of what the light sees through a lens.
    pub(super) fn draw(&self, lens: Lens) -> Result<Map, Limit> {
        let Self { session, execution, .. } = *self;
        let viewport = Viewport { width: lens.width, height: lens.height };
        let bytes = u64::from(lens.width) * u64::from(lens.height) * 8;
        execution.budget.check("shadow maps")?;
        execution.budget.charge(bytes, "a shadow map")?;
        execution.budget.release(bytes);

        // Prepare the view from the light.
        let settings = self.view_settings();
        let (pattern, counters) = (SamplePattern::new(1), &mut CullCounters::default());
        let view = PreparedView::new(
            session,
            &lens.camera,
            &settings,
            viewport,
            pattern,
            execution,
            counters,
        );
        let sink = DepthSink::new(self, &lens, viewport);
        let columns = viewport.tiles_x() as usize;

        // Draw everything at once if the triangles are too many to be kept.
        let Some(batches) = all_batches(&view, execution)? else {
            resolve_in_passing(&view, viewport.tiles_y(), execution, &sink)?;
            let tiles = sink.finish()?;
            return Ok(Map { lens, columns, tiles, pending: None });
        };

        // Draw the tiles that cannot wait.
        let numbers = sink.settle_tiles(&batches, self.when);
        let spare = Mutex::default();
        execution.workers.for_each(numbers, |index: usize| {
            sink.draw(&view, index, &touching(&batches, index), &spare);
        });
        let tiles = sink.finish()?;
        Ok(Map { lens, columns, tiles, pending: self.keep_pending(batches) })
    }

    /// The settings of the view from the light: nothing but surfaces.
    fn view_settings(&self) -> Settings {
        let settings = Settings {
            acceleration: None,
            depth_bits: None,
            shows_all_backs: true,
            ..self.settings.clone()
        };
        let settings = settings.with_visibility(Visibility::Z_BUFFER).with_lines(Lines::None);
        settings.with_background(Background::Transparent)
    }

    /// Keeps the opaque batches for tiles that wait, if any may; the session gets the memory of the
    /// others back.
    fn keep_pending(&self, mut batches: Vec<(bool, Batch)>) -> Option<Pending> {
        let mut pending = None;
        if self.when == When::Asked {
            let (layered, opaque): (Vec<_>, Vec<_>) =
                batches.into_iter().partition(|(layered, _)| *layered);
            batches = layered;
            let opaque = opaque.into_iter().map(|(_, batch)| batch).collect();
            pending = Some(Pending { batches: opaque, level: self.execution.level });
        }
        give_back(self.session, batches);
        pending
    }
}

impl TileSink for DepthSink<'_> {
    fn tile(&self, index: usize, tile: &Tile, layers: &mut LayerList) {
        let seen = tile.facet[..TILE_PIXELS].iter().zip(&tile.depth);
        let depth = |(&facet, &depth): (&u32, &f32)| {
            if facet == NO_FACET { f32::NEG_INFINITY } else { depth }
        };
        let depths = if tile.touched { seen.map(depth).collect() } else { Vec::new() };
        self.keep(index, depths, self.layers(tile, layers));
    }
}

impl<'a> DepthSink<'a> {
    fn new(pass: &FirstPass<'a>, lens: &'a Lens, viewport: Viewport) -> Self {
        let FirstPass { session, occluders, execution, .. } = *pass;
        let center = Triangles::center_of(&session.world);
        let tiles = (0..(viewport.tiles_x() * viewport.tiles_y()) as usize)
            .map(|_| OnceLock::new())
            .collect();
        Self { lens, session, occluders, center, execution, tiles, charged: Mutex::default() }
    }

    /// Settles the tiles that no batch touches as empty. The numbers of those that are to be drawn:
    /// all others, or those with transparent things if the rest may wait.
    fn settle_tiles(&self, batches: &[(bool, Batch)], when: When) -> Vec<usize> {
        // By opaque things, by transparent ones.
        let mut touched = [vec![false; self.tiles.len()], vec![false; self.tiles.len()]];
        for (layered, batch) in batches {
            for (tile, here) in touched[usize::from(*layered)].iter_mut().zip(batch.touched()) {
                *tile |= here;
            }
        }
        let [opaque, layered] = touched;
        let mut numbers = Vec::new();
        for (index, tile) in self.tiles.iter().enumerate() {
            if !(opaque[index] || layered[index]) {
                let _ = tile.set(MapTile::default());
            } else if when == When::Before || layered[index] {
                numbers.push(index);
            }
        }
        numbers
    }

    fn is_given_up(&self) -> bool {
        self.charged.lock().expect("bytes of a map").1.is_some()
    }

    /// The tiles, unless the map was given up.
    fn finish(self) -> Result<Vec<OnceLock<MapTile>>, Limit> {
        let (bytes, limit) = self.charged.into_inner().expect("bytes of a map");
        self.execution.budget.release(bytes);
        limit.map_or(Ok(self.tiles), Err)
    }

    /// Draws a tile of the view.
    fn draw(
        &self,
        view: &PreparedView<'_>,
        index: usize,
        batches: &[(bool, &Batch)],
        spare: &Mutex<Vec<Tile>>,
    ) {
        if self.is_given_up() {
            return;
        }

        // Find the nearest opaque depths.
        let place = tile_origin(view, index);
        let opaque = batches.iter().filter(|(layered, _)| !layered).map(|(_, batch)| *batch);
        let level = self.execution.level;
        let nearest = nearest_depths(level, place, opaque, index);
        let far = nearest.far();
        let depths = nearest.into_depths();

        // Collect the transparent layers in front of them.
        let mut layers = Vec::new();
        if batches.iter().any(|(layered, _)| *layered) {
            with_spare(spare, view.pattern.len(), |tile| {
                // Its facets stay unknown: a facet as near as the nearest opaque one hides
                // nothing that this does not.
                (tile.x, tile.y) = place;
                (tile.block_far, tile.touched) = (far, true);
                tile.depth.copy_from_slice(&depths);
                let mut list = layer_list(view, self);
                let layered: Vec<_> =
                    batches.iter().copied().filter(|(layered, _)| *layered).collect();
                walk(level, &layered, index, tile, &view.pattern, &mut list);
                list.finish();
                layers = self.layers(tile, &list);
            });
        }

        // Store the tile.
        self.keep(index, depths, layers);
    }

    /// Keeps a tile, given its depths, −∞ where nothing is.
    fn keep(&self, index: usize, depth: Vec<f32>, layers: Vec<Layer>) {
        let (budget, bytes) = (&self.execution.budget, (layers.len() * size_of::<Layer>()) as u64);
        let allowed = budget
            .check("shadow maps")
            .and_then(|()| budget.charge(bytes, "what is transparent in a shadow map"));
        let mut charged = self.charged.lock().expect("bytes of a map");
        match allowed {
            Ok(()) => charged.0 += bytes,
            Err(limit) => return charged.1 = Some(limit),
        }
        drop(charged);
        let new =
            self.tiles[index].set(MapTile::new(self.execution.level, self.lens, depth, layers));
        new.expect("each tile is drawn once");
    }

    /// The transparent things in a tile, sorted.
    fn layers(&self, tile: &Tile, list: &LayerList) -> Vec<Layer> {
        let lens = self.lens;
        let mut found = Vec::new();
        let world_from_view = lens.view_from_world.inverse();
        // Facets come one after the other.
        let mut last = (NO_FACET, None);

        // Convert each layer to a distance and what it lets through there.
        for layer in list.iter() {
            let [x, y] = [layer.at as usize % TILE, layer.at as usize / TILE].map(|k| k as u32);
            let [x, y] = [tile.x + x, tile.y + y];
            if x < lens.width && y < lens.height {
                let depth = lens.distance(layer.depth);
                if last.0 != layer.facet {
                    last = (layer.facet, self.occluders.transmittance_anywhere(layer.facet));
                }
                let there = || self.transmittance(layer.facet, &world_from_view, [x, y], depth);
                let passing = last.1.unwrap_or_else(there);
                found.push((layer.facet, Layer { texel: layer.at, depth, passing }));
            }
        }

        // Sort by texel and depth, and drop duplicates of a facet.
        found.sort_unstable_by(|(f, a): &(u32, Layer), (g, b)| {
            a.texel.cmp(&b.texel).then(a.depth.total_cmp(&b.depth)).then(f.cmp(g))
        });
        found.dedup_by_key(|(facet, l)| (*facet, l.texel));
        // Behind what lets nothing through nothing need be known.
        let mut shut = u32::MAX;
        found.retain(|(_, layer)| {
            let hidden = layer.texel == shut;
            if layer.passing == [0.0; 3] {
                shut = layer.texel;
            }
            !hidden
        });
        found.into_iter().map(|(_, layer)| layer).collect()
    }

    /// What passes a facet in the middle of a texel.
    fn transmittance(
        &self,
        facet: u32,
        world_from_view: &DMat4,
        texel: [u32; 2],
        depth: f32,
    ) -> Rgb {
        let world = &self.session.world;
        let instance = &world.instances[world.instance_of_facet(facet)];
        let triangle = instance.mesh.triangles[(facet - instance.first_facet) as usize];
        let corners = triangle.map(|i| {
            let [x, y, z] = instance.mesh.positions[i as usize].map(f64::from);
            (instance.world_from_model.transform_point3(dvec3(x, y, z)) - self.center).as_vec3()
        });
        let point = self.lens.point(texel.map(|k| f64::from(k) + 0.5), f64::from(depth));
        self.occluders.transmittance(facet, &corners, || world_from_view.transform_point3(point))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shadow::map::testing::teapot;

    #[test]
    fn tiles_drawn_when_they_are_asked_about_are_those_drawn_before() {
        for transparent in [false, true] {
            let draw = |when| teapot(transparent, dvec3(1.0, 2.0, 3.0), 300, when).0;
            let [before, asked] = [When::Before, When::Asked].map(draw);
            assert_eq!((before.pending.is_some(), asked.pending.is_some()), (false, true));
            let waiting = asked.tiles.iter().filter(|tile| tile.get().is_none()).count();
            assert_eq!(waiting > 0, !transparent, "{waiting} tiles wait");
            let mut seen = 0;
            for number in 0..before.tiles.len() {
                let [a, b] = [before.tile(number), asked.tile(number)];
                assert!(a.depth == b.depth && a.layers == b.layers, "tile {number}");
                seen += usize::from(!a.depth.is_empty() || !a.layers.is_empty());
            }
            assert!(seen > 5, "{seen} tiles with something");
        }
    }
}
