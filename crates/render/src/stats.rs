//! Counters that every stage reports, and the time it took.

use serde::Serialize;
use vitral_raster::GeometryCounters;

/// What happened while a picture was made. Times are in seconds, 0 where the caller gave no clock.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Stats {
    /// Rejection before any triangle was looked at.
    pub cull: CullCounters,
    /// Triangles on their way to the screen.
    pub geometry: GeometryStats,
    /// What finding the visible surfaces took.
    pub visibility: VisibilityCounters,
    /// Saved by frame coherence: what earlier pictures found out (properties of meshes, trees, structures for rays).
    pub reused: u64,
    /// Rays that were followed on from what is seen.
    pub tracing: TracingCounters,
    /// Light from surface to surface; zeros where a known solution was used.
    pub radiosity: RadiosityCounters,
    /// Samples and pixels.
    pub picture: PictureCounters,
    /// Seconds a stage.
    pub seconds: StageSeconds,
}

/// Rejection of whole objects and runs of triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct CullCounters {
    /// Instances in the scene.
    pub instances: u64,
    /// Instances that no box test let through.
    pub instances_culled: u64,
    /// Box tests against the view volume.
    pub box_tests: u64,
    /// Triangles in the scene.
    pub triangles: u64,
    /// Triangles thrown away with the box round them.
    pub triangles_culled: u64,
    /// Instances of which faces turned away are thrown away: all, or those of the bodies that are solid.
    pub back_face_culled_instances: u64,
}

/// [`GeometryCounters`], in a form that can be written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct GeometryStats {
    /// Vertices transformed.
    pub vertices: u64,
    /// Triangles looked at.
    pub triangles: u64,
    /// With all corners outside one plane of the view volume.
    pub outside: u64,
    /// Facing away.
    pub back_facing: u64,
    /// Without area.
    pub degenerate: u64,
    /// Between the samples.
    pub no_sample: u64,
    /// With a NaN or infinite corner.
    pub not_finite: u64,
    /// Cut at a clipping plane.
    pub clipped: u64,
    /// Set up for rasterising.
    pub set_up: u64,
    /// Entries in tile lists.
    pub tile_entries: u64,
}

impl GeometryStats {
    pub(crate) fn add(&mut self, c: &GeometryCounters) {
        self.triangles += c.triangles;
        self.outside += c.outside;
        self.back_facing += c.back_facing;
        self.degenerate += c.degenerate;
        self.no_sample += c.no_sample;
        self.not_finite += c.not_finite;
        self.clipped += c.clipped;
        self.set_up += c.set_up;
        self.tile_entries += c.tile_entries;
    }
}

/// What finding the visible surfaces took, each algorithm in its own terms; 0 where an algorithm has no such thing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct VisibilityCounters {
    /// Comparisons of two facets' depths, at a sample, over a span or over a window. The z-buffer does not count its own.
    pub depth_comparisons: u64,
    /// Saved by face coherence: looks at a face whose depth had been brought to the line for another.
    pub saved_by_face: u64,
    /// Saved by edge coherence: crossings stepped from the line before.
    pub saved_by_edge: u64,
    /// Saved by implied-edge coherence: samples at which two depths were not compared, since the line where their faces
    /// penetrate each other lies beside.
    pub saved_by_implied_edge: u64,
    /// Saved by scan-line coherence: edges that stayed in the table.
    pub saved_by_scan_line: u64,
    /// Saved by area coherence: pixels decided with their neighbours, inherited surrounders, rays that went together or met
    /// what the one before met.
    pub saved_by_area: u64,
    /// Saved by depth coherence: polygons passed over because something nearer hides them in a whole span or window.
    pub saved_by_depth: u64,
    /// Saved by frame coherence: nodes of a tree that was there already.
    pub saved_by_frame: u64,
    /// Scan-line: edges in the active edge table, summed over the lines.
    pub active_edges: u64,
    /// Scan-line: spans with a polygon in.
    pub spans: u64,
    /// Scan-line: spans, or parts of them, that had to be decided sample by sample.
    pub penetrated_spans: u64,
    /// Scan-line: lines found along which two polygons penetrate each other, or would if they went on.
    pub implied_edges: u64,
    /// Area subdivision: windows looked at.
    pub windows: u64,
    /// Area subdivision: windows of one pixel, decided sample by sample.
    pub pixel_windows: u64,
    /// Area subdivision: polygons tested against a window.
    pub window_tests: u64,
    /// Ray casting and brute force: rays, one for each sample.
    pub rays: u64,
    /// Ray casting: boxes of a tree, or cells of a grid, tested against a ray or a packet of rays.
    pub box_tests: u64,
    /// Ray casting and brute force: pairs of a ray and a facet on the screen that were tested.
    pub triangle_tests: u64,
    /// Ray casting: pairs of a ray and a facet on the screen that bounding volumes left untested.
    pub tests_saved: u64,
    /// BSP: nodes of the tree.
    pub tree_nodes: u64,
    /// BSP: polygons and parts of polygons in the tree.
    pub fragments: u64,
    /// List priority: polygons and parts of polygons in the list that is drawn.
    pub pieces: u64,
    /// Object precision: polygons cut in two.
    pub splits: u64,
    /// Painter: pairs of polygons compared.
    pub list_tests: u64,
    /// Painter: pairs decided by their extents in depth.
    pub by_depth_extent: u64,
    /// Painter: pairs decided by the first test, extents in x.
    pub by_x_extent: u64,
    /// Painter: pairs decided by the second test, extents in y.
    pub by_y_extent: u64,
    /// Painter: pairs decided by the third test, the farther polygon lies behind the nearer one's plane.
    pub by_plane_of_nearer: u64,
    /// Painter: pairs decided by the fourth test, the nearer polygon lies in front of the farther one's plane.
    pub by_plane_of_farther: u64,
    /// Painter: pairs decided by the fifth test, the projections do not overlap.
    pub by_projection: u64,
    /// Painter: pairs decided by their depths in the overlap of the projections.
    pub by_overlap: u64,
    /// Painter: polygons moved to an earlier place in the list.
    pub reordered: u64,
    /// Painter: cycles that were cut.
    pub cycles: u64,
    /// Weiler–Atherton: polygons clipped against another.
    pub clipped_polygons: u64,
    /// Weiler–Atherton: lists looked at again because the preliminary order erred.
    pub recursions: u64,
    /// Weiler–Atherton: visible polygons, tile by tile.
    pub visible_polygons: u64,
    /// List priority: samples drawn over by something later in the list.
    pub overdrawn: u64,
    /// List priority: samples where the depth function contradicted the list.
    pub overruled: u64,
    /// List priority: those of them with at least 2^-20 of the depth range between the two surfaces.
    pub overruled_far: u64,
}

impl VisibilityCounters {
    pub(crate) fn add(&mut self, o: &Self) {
        self.depth_comparisons += o.depth_comparisons;
        self.saved_by_face += o.saved_by_face;
        self.saved_by_edge += o.saved_by_edge;
        self.saved_by_implied_edge += o.saved_by_implied_edge;
        self.saved_by_scan_line += o.saved_by_scan_line;
        self.saved_by_area += o.saved_by_area;
        self.saved_by_depth += o.saved_by_depth;
        self.saved_by_frame += o.saved_by_frame;
        self.active_edges += o.active_edges;
        self.spans += o.spans;
        self.penetrated_spans += o.penetrated_spans;
        self.implied_edges += o.implied_edges;
        self.windows += o.windows;
        self.pixel_windows += o.pixel_windows;
        self.window_tests += o.window_tests;
        self.rays += o.rays;
        self.box_tests += o.box_tests;
        self.triangle_tests += o.triangle_tests;
        self.tests_saved += o.tests_saved;
        self.tree_nodes += o.tree_nodes;
        self.fragments += o.fragments;
        self.pieces += o.pieces;
        self.splits += o.splits;
        self.list_tests += o.list_tests;
        self.by_depth_extent += o.by_depth_extent;
        self.by_x_extent += o.by_x_extent;
        self.by_y_extent += o.by_y_extent;
        self.by_plane_of_nearer += o.by_plane_of_nearer;
        self.by_plane_of_farther += o.by_plane_of_farther;
        self.by_projection += o.by_projection;
        self.by_overlap += o.by_overlap;
        self.reordered += o.reordered;
        self.cycles += o.cycles;
        self.clipped_polygons += o.clipped_polygons;
        self.recursions += o.recursions;
        self.visible_polygons += o.visible_polygons;
        self.overdrawn += o.overdrawn;
        self.overruled += o.overruled;
        self.overruled_far += o.overruled_far;
    }
}

/// Rays that were followed on from what is seen: to mirror images, through transparent surfaces, to lights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct TracingCounters {
    /// Rays that look for the first thing they meet.
    pub rays: u64,
    /// Rays to lights, which end at the first opaque thing; from what is seen and from what rays meet.
    pub shadow_rays: u64,
    /// Rays that met something.
    pub hits: u64,
    /// Rays that a mirror sent back.
    pub mirrored: u64,
    /// Rays that were bent.
    pub refracted: u64,
    /// Rays that passed straight through something transparent.
    pub passed: u64,
    /// Rays into which translucent surfaces scattered what passed.
    pub scattered: u64,
    /// Rays that could not leave a denser medium.
    pub total_reflections: u64,
    /// Branches that ended after the most turns.
    pub stopped_by_depth: u64,
    /// Branches that ended because their light would not be seen.
    pub stopped_by_weight: u64,
    /// Boxes that were tested against rays; not those to lights.
    pub box_tests: u64,
    /// Triangles that were tested against rays; not those to lights.
    pub triangle_tests: u64,
    /// Both kinds of rays for each second of the tiles, with all that was computed there.
    pub rays_per_second: f64,
}

impl TracingCounters {
    pub(crate) fn add(&mut self, o: &Self) {
        self.rays += o.rays;
        self.shadow_rays += o.shadow_rays;
        self.hits += o.hits;
        self.mirrored += o.mirrored;
        self.refracted += o.refracted;
        self.passed += o.passed;
        self.scattered += o.scattered;
        self.total_reflections += o.total_reflections;
        self.stopped_by_depth += o.stopped_by_depth;
        self.stopped_by_weight += o.stopped_by_weight;
        self.box_tests += o.box_tests;
        self.triangle_tests += o.triangle_tests;
    }

    /// Rays of both kinds a second; 0 without a clock.
    pub(crate) fn rate(&self, seconds: f64) -> f64 {
        if seconds > 0.0 { (self.rays + self.shadow_rays) as f64 / seconds } else { 0.0 }
    }
}

/// What solving for radiosity took. Light is in units of intensity times area, all colours together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct RadiosityCounters {
    /// Triangles that send light.
    pub patches: u64,
    /// Triangles that receive it.
    pub elements: u64,
    /// Patches that sent light, some of them several times.
    pub shots: u64,
    /// Light not yet sent on, as a part of what has not left the scene.
    pub residual: f64,
    /// Light that was there in the beginning.
    pub emitted: f64,
    /// Light that surfaces kept.
    pub absorbed: f64,
    /// Light that left the scene.
    pub escaped: f64,
    /// Time.
    pub seconds: f64,
}

/// Samples and pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct PictureCounters {
    /// Pixels of the picture.
    pub pixels: u64,
    /// Pixels in which some sample shows a surface.
    pub covered_pixels: u64,
    /// Places where illumination was computed.
    pub shaded_points: u64,
    /// Samples of transparent or cut-out surfaces, lines and points that were kept.
    pub layer_samples: u64,
    /// Layers behind others that were dropped to stay within the memory for layers.
    pub lost_layers: u64,
    /// Samples of layers where the depth function contradicted the order of a list.
    pub overruled_layers: u64,
}

impl PictureCounters {
    pub(crate) fn add(&mut self, o: &Self) {
        self.pixels += o.pixels;
        self.covered_pixels += o.covered_pixels;
        self.shaded_points += o.shaded_points;
        self.layer_samples += o.layer_samples;
        self.lost_layers += o.lost_layers;
        self.overruled_layers += o.overruled_layers;
    }
}

/// Seconds a stage of the colour picture; the passes for data channels count in the total alone. Rasterising and shading
/// share the tiles, so they count as one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct StageSeconds {
    /// Culling and preparing the view.
    pub prepare: f64,
    /// Vertices and triangle setup.
    pub geometry: f64,
    /// Visibility in the tiles, illumination and shading.
    pub tiles: f64,
    /// Lines, points and edges.
    pub marks: f64,
    /// Putting the tiles together.
    pub assemble: f64,
    /// All.
    pub total: f64,
}
