//! The first pass: depths from the light, by the z-buffer algorithm of the renderer itself.
//!
//! Depths are all that is asked of opaque things, and a kernel for depths alone finds them, unless there are so many
//! triangles that the whole map must wait for them. Transparent things are found by their facets, as in a picture.

use super::super::grey;
use super::super::occluders::Occluders;
use super::{Layer, Lens, Map, MapTile};
use crate::stats::CullCounters;
use crate::visible::TileSink;
use crate::visible::zbuffer::{each_tile, resolve_in_passing, tile_place, walk, with_spare};
use crate::{Background, Execution, Lines, PreparedView, Session, Settings};
use std::sync::Mutex;
use vitral_exec::Limit;
use vitral_math::lanes::{Level, Simd, dispatch};
use vitral_math::{DVec3, dvec3};
use vitral_raster::{Batch, LayerList, NO_FACET, NearestDepths, SamplePattern, TILE, TILE_PIXELS, Tile, Viewport};

/// Turns tiles into distances and layers.
struct DepthSink<'a> {
    lens: &'a Lens,
    session: &'a Session,
    occluders: &'a Occluders<'a>,
    center: DVec3,
    level: Level,
    tiles: Vec<Mutex<MapTile>>,
}

impl Map {
    pub(super) fn draw(
        lens: Lens,
        session: &Session,
        occluders: &Occluders<'_>,
        settings: &Settings,
        execution: &Execution,
    ) -> Result<Self, Limit> {
        let viewport = Viewport { width: lens.width, height: lens.height };
        let bytes = u64::from(lens.width) * u64::from(lens.height) * 8;
        execution.budget.check("shadow maps")?;
        execution.budget.charge(bytes, "a shadow map")?;
        execution.budget.release(bytes);
        let settings = Settings {
            visibility: "z-buffer".to_owned(),
            acceleration: None,
            lines: Lines::None,
            background: Background::Transparent,
            ..settings.clone()
        };
        let (pattern, counters) = (SamplePattern::new(1), &mut CullCounters::default());
        let view = PreparedView::new(session, &lens.camera, &settings, viewport, pattern, execution, counters);
        let center = crate::raytrace::triangles::Triangles::center_of(&session.world);
        let columns = viewport.tiles_x() as usize;
        let tiles = (0..columns * viewport.tiles_y() as usize).map(|_| Mutex::default()).collect();
        let sink = DepthSink { lens: &lens, session, occluders, center, level: execution.level, tiles };
        let spare = Mutex::default();
        let tile = |index: usize, batches: &[(bool, &Batch)]| {
            sink.draw(&view, index, batches, &spare);
        };
        if !each_tile(&view, viewport.tiles_y(), execution, tile)? {
            resolve_in_passing(&view, viewport.tiles_y(), execution, &sink)?;
        }
        let tiles = sink.tiles.into_iter().map(|t| t.into_inner().expect("finished tile")).collect();
        Ok(Self { lens, columns, tiles })
    }
}

impl TileSink for DepthSink<'_> {
    fn tile(&self, index: usize, tile: &Tile, layers: &mut LayerList) {
        let seen = tile.facet[..TILE_PIXELS].iter().zip(&tile.depth);
        let depth = |(&facet, &depth): (&u32, &f32)| if facet == NO_FACET { f32::NEG_INFINITY } else { depth };
        let depths = if tile.touched { seen.map(depth).collect() } else { Vec::new() };
        self.keep(index, depths, self.layers(tile, layers));
    }
}

impl DepthSink<'_> {
    /// Draws a tile of the view.
    fn draw(&self, view: &PreparedView<'_>, index: usize, batches: &[(bool, &Batch)], spare: &Mutex<Vec<Tile>>) {
        let place = tile_place(view, index);
        let mut nearest = NearestDepths::new(place);
        let opaque = batches.iter().filter(|(layered, _)| !layered);
        for (_, batch) in opaque {
            nearest.draw(self.level, batch.tile(index));
        }
        let far = nearest.far();
        let depths = nearest.into_depths();
        let mut layers = Vec::new();
        if batches.iter().any(|(layered, _)| *layered) {
            with_spare(spare, view.pattern.len(), |tile| {
                // Its facets stay unknown: what is as near as the nearest opaque thing hides nothing that this does not.
                (tile.x, tile.y) = place;
                (tile.block_far, tile.touched) = (far, true);
                tile.depth.copy_from_slice(&depths);
                let mut list = view.layer_list_for(self);
                let layered = batches.iter().copied().filter(|(layered, _)| *layered);
                walk(self.level, layered, index, tile, &view.pattern, &mut list);
                list.finish();
                layers = self.layers(tile, &list);
            });
        }
        self.keep(index, depths, layers);
    }

    /// Keeps a tile, given its depths, −∞ where nothing is.
    fn keep(&self, index: usize, mut depth: Vec<f32>, layers: Vec<Layer>) {
        if !dispatch!(self.level, simd => distances(simd, self.lens, &mut depth)) {
            depth = Vec::new();
        }
        *self.tiles[index].lock().expect("finished tile") = MapTile { depth, layers };
    }

    /// The transparent things in a tile, sorted.
    fn layers(&self, tile: &Tile, list: &LayerList) -> Vec<Layer> {
        let lens = self.lens;
        let mut found = Vec::new();
        for layer in list.iter() {
            let [x, y] = [layer.at as usize % TILE, layer.at as usize / TILE].map(|k| k as u32);
            let [x, y] = [tile.x + x, tile.y + y];
            if x < lens.width && y < lens.height {
                let depth = lens.distance(layer.depth);
                let passing = self.passing(layer.facet, [x, y], depth);
                found.push((layer.facet, Layer { texel: layer.at, depth, passing }));
            }
        }
        found.sort_unstable_by(|(f, a): &(u32, Layer), (g, b)| {
            a.texel.cmp(&b.texel).then(a.depth.total_cmp(&b.depth)).then(f.cmp(g))
        });
        found.dedup_by_key(|(facet, l)| (*facet, l.texel));
        found.into_iter().map(|(_, layer)| layer).collect()
    }

    /// What passes a facet in the middle of a texel.
    fn passing(&self, facet: u32, texel: [u32; 2], depth: f32) -> f32 {
        let world = &self.session.world;
        let instance = &world.instances[world.instance_of_facet(facet)];
        let triangle = instance.mesh.triangles[(facet - instance.first_facet) as usize];
        let corners = triangle.map(|i| {
            let [x, y, z] = instance.mesh.positions[i as usize].map(f64::from);
            (instance.world_from_model.transform_point3(dvec3(x, y, z)) - self.center).as_vec3()
        });
        let point = self.lens.point(texel.map(|k| f64::from(k) + 0.5), f64::from(depth));
        let world_from_view = self.lens.view_from_world.inverse();
        // A map knows one number for all colours.
        grey(self.occluders.passing(facet, &corners, || world_from_view.transform_point3(point)))
    }
}

/// Makes distances of depths, ∞ of −∞. Whether there is any of the former.
fn distances<S: Simd>(simd: S, lens: &Lens, depths: &mut [f32]) -> bool {
    // Plain loops, for the compiler to do several at once.
    simd.vectorize(
        #[inline(always)]
        || {
            if depths.iter().all(|&depth| depth == f32::NEG_INFINITY) {
                return false;
            }
            for depth in depths {
                let distance = lens.distance(*depth);
                *depth = if *depth < 0.0 { f32::INFINITY } else { distance };
            }
            true
        },
    )
}
