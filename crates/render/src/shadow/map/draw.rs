//! The first pass: depths from the light, by the z-buffer algorithm of the renderer itself.

use super::super::grey;
use super::super::occluders::Occluders;
use super::{Layer, Lens, Map, MapTile};
use crate::stats::CullCounters;
use crate::visible::TileSink;
use crate::visible::zbuffer::resolve_in_passing;
use crate::{Background, Execution, Lines, PreparedView, Session, Settings};
use std::sync::Mutex;
use vitral_exec::Limit;
use vitral_math::{DVec3, dvec3};
use vitral_raster::{LayerList, NO_FACET, SamplePattern, TILE, TILE_PIXELS, Tile, Viewport};

/// Turns tiles into distances and layers.
struct DepthSink<'a> {
    lens: &'a Lens,
    session: &'a Session,
    occluders: &'a Occluders<'a>,
    center: DVec3,
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
        let sink = DepthSink { lens: &lens, session, occluders, center, tiles };
        resolve_in_passing(&view, viewport.tiles_y(), execution, &sink)?;
        let tiles = sink.tiles.into_iter().map(|t| t.into_inner().expect("finished tile")).collect();
        Ok(Self { lens, columns, tiles })
    }
}

impl TileSink for DepthSink<'_> {
    fn tile(&self, index: usize, tile: &Tile, layers: &mut LayerList) {
        let lens = self.lens;
        let seen = tile.facet[..TILE_PIXELS].iter().zip(&tile.depth);
        let distance =
            |(&facet, &depth): (&u32, &f32)| if facet == NO_FACET { f32::INFINITY } else { lens.distance(depth) };
        let distances = if tile.touched { seen.map(distance).collect() } else { Vec::new() };
        let mut found = Vec::new();
        for layer in layers.iter() {
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
        let layers = found.into_iter().map(|(_, layer)| layer).collect();
        *self.tiles[index].lock().expect("finished tile") = MapTile { depth: distances, layers };
    }
}

impl DepthSink<'_> {
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
