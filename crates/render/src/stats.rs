//! Counters that every stage reports, and the time it took.

use serde::Serialize;
use vitral_raster::GeometryCounters;

/// Declares a group of counters, each once: the struct, which is written under the same names in
/// kebab case, the sum with another group, and what each means. A `count` is added up. A `number`
/// and a `measure` are set by whoever knows them.
macro_rules! counters {
    (
        $(#[$about:meta])*
        $name:ident += $summand:ty {
            $( $(#[doc = $text:literal])+ $field:ident: $kind:ident, )+
        }
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
        #[serde(rename_all = "kebab-case")]
        pub struct $name {
            $( $(#[doc = $text])+ pub $field: counters!(@type $kind), )+
        }

        impl $name {
            /// What each counter means, in the order of the fields; names have `_` for `-`.
            pub const MEANINGS: &[(&str, &str)] = &[
                $( (stringify!($field), concat!($($text),+).trim_ascii()), )+
            ];

            /// Adds the counts of `other`.
            pub(crate) fn add(&mut self, other: &$summand) {
                $( counters!(@add $kind, self.$field, other.$field); )+
            }
        }
    };
    (@type count) => { u64 };
    (@type number) => { u64 };
    (@type measure) => { f64 };
    (@add count, $sum:expr, $summand:expr) => { $sum += $summand };
    (@add number, $sum:expr, $summand:expr) => {};
    (@add measure, $sum:expr, $summand:expr) => {};
}

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
    /// Saved by frame coherence: what earlier pictures found out (properties of meshes, trees,
    /// structures for rays).
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
    /// Instances of which faces turned away are thrown away: all, or those of the bodies that are
    /// solid.
    pub back_face_culled_instances: u64,
}

counters! {
    /// [`GeometryCounters`], in a form that can be written.
    #[derive(Eq)]
    GeometryStats += GeometryCounters {
        /// Vertices transformed.
        vertices: number,
        /// Triangles looked at.
        triangles: count,
        /// With all corners outside one plane of the view volume.
        outside: count,
        /// Facing away.
        back_facing: count,
        /// Without area.
        degenerate: count,
        /// Between the samples.
        no_sample: count,
        /// With a NaN or infinite corner.
        not_finite: count,
        /// Cut at a clipping plane.
        clipped: count,
        /// Set up for rasterising.
        set_up: count,
        /// Entries in tile lists.
        tile_entries: count,
    }
}

counters! {
    /// What finding the visible surfaces took, each algorithm in its own terms; 0 where an
    /// algorithm has no such thing.
    #[derive(Eq)]
    VisibilityCounters += Self {
        /// Comparisons of two facets' depths, at a sample, over a span or over a window. The
        /// z-buffer does not count its own.
        depth_comparisons: count,
        /// Saved by face coherence: looks at a face whose depth had been brought to the line for
        /// another.
        saved_by_face: count,
        /// Saved by edge coherence: crossings stepped from the line before.
        saved_by_edge: count,
        /// Saved by implied-edge coherence: samples at which two depths were not compared, since
        /// the line where their faces penetrate each other lies beside.
        saved_by_implied_edge: count,
        /// Saved by scan-line coherence: edges that stayed in the table.
        saved_by_scan_line: count,
        /// Saved by area coherence: pixels decided with their neighbours, inherited surrounders,
        /// rays that went together or met what the one before met.
        saved_by_area: count,
        /// Saved by depth coherence: polygons passed over because something nearer hides them in a
        /// whole span or window.
        saved_by_depth: count,
        /// Saved by frame coherence: nodes of a tree that was there already.
        saved_by_frame: count,
        /// Scan-line: edges in the active edge table, summed over the lines.
        active_edges: count,
        /// Scan-line: spans with a polygon in.
        spans: count,
        /// Scan-line: spans, or parts of them, that had to be decided sample by sample.
        penetrated_spans: count,
        /// Scan-line: lines found along which two polygons penetrate each other, or would if they
        /// went on.
        implied_edges: count,
        /// Area subdivision: windows looked at.
        windows: count,
        /// Area subdivision: windows of one pixel, decided sample by sample.
        pixel_windows: count,
        /// Area subdivision: polygons tested against a window.
        window_tests: count,
        /// Ray casting and brute force: rays, one for each sample.
        rays: count,
        /// Ray casting: boxes of a tree, or cells of a grid, tested against a ray or a packet of
        /// rays.
        box_tests: count,
        /// Ray casting and brute force: pairs of a ray and a facet on the screen that were tested.
        triangle_tests: count,
        /// Ray casting: pairs of a ray and a facet on the screen that bounding volumes left
        /// untested.
        tests_saved: count,
        /// BSP: nodes of the tree.
        tree_nodes: count,
        /// BSP: polygons and parts of polygons in the tree.
        fragments: count,
        /// List priority: polygons and parts of polygons in the list that is drawn.
        pieces: count,
        /// Object precision: polygons cut in two.
        splits: count,
        /// Painter: pairs of polygons compared.
        list_tests: count,
        /// Painter: pairs decided by their extents in depth.
        by_depth_extent: count,
        /// Painter: pairs decided by the first test, extents in x.
        by_x_extent: count,
        /// Painter: pairs decided by the second test, extents in y.
        by_y_extent: count,
        /// Painter: pairs decided by the third test, the farther polygon lies behind the nearer
        /// one's plane, or in it.
        by_plane_of_nearer: count,
        /// Painter: pairs decided by the fourth test, the nearer polygon lies in front of the
        /// farther one's plane.
        by_plane_of_farther: count,
        /// Painter: pairs decided by the fifth test, the projections do not overlap.
        by_projection: count,
        /// Painter: pairs decided by their depths in the overlap of the projections.
        by_overlap: count,
        /// Painter: polygons moved to an earlier place in the list.
        reordered: count,
        /// Painter: cycles that were cut.
        cycles: count,
        /// Weiler–Atherton: polygons that another cut in two.
        clipped_polygons: count,
        /// Weiler–Atherton: lists looked at again because the preliminary order erred.
        recursions: count,
        /// Weiler–Atherton: visible polygons.
        visible_polygons: count,
        /// List priority: samples drawn over by something later in the list.
        overdrawn: count,
        /// List priority: samples where the depth function contradicted the list.
        overruled: count,
        /// List priority: those of them with at least 2^-20 of the depth range between the two
        /// surfaces.
        overruled_far: count,
    }
}

counters! {
    /// Rays that were followed on from visible points: to mirror images, through transparent
    /// surfaces, to lights.
    TracingCounters += Self {
        /// Rays that look for the first thing they meet.
        rays: count,
        /// Rays to lights, which end at the first opaque thing; from what is seen and from what
        /// rays meet.
        shadow_rays: count,
        /// Rays that met something.
        hits: count,
        /// Rays that a mirror sent back.
        mirrored: count,
        /// Rays that were bent.
        refracted: count,
        /// Rays that passed straight through something transparent.
        passed: count,
        /// Rays into which translucent surfaces scattered what passed.
        scattered: count,
        /// Rays that could not leave a denser medium.
        total_reflections: count,
        /// Branches that ended after the most turns.
        stopped_by_depth: count,
        /// Branches that ended because their light would not be seen.
        stopped_by_weight: count,
        /// Boxes that were tested against rays; not those to lights.
        box_tests: count,
        /// Triangles that were tested against rays; not those to lights.
        triangle_tests: count,
        /// Both kinds of rays for each second of the tiles, with all that was computed there.
        rays_per_second: measure,
    }
}

impl TracingCounters {
    /// Rays of both kinds a second; 0 without a clock.
    pub(crate) fn rate(&self, seconds: f64) -> f64 {
        if seconds > 0.0 { (self.rays + self.shadow_rays) as f64 / seconds } else { 0.0 }
    }
}

/// What solving for radiosity took. Light is in units of intensity times area, all colours
/// together.
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
    /// It ended before its time, at a time limit.
    pub stopped: bool,
    /// Light that was there in the beginning.
    pub emitted: f64,
    /// Light that surfaces kept.
    pub absorbed: f64,
    /// Light that left the scene.
    pub escaped: f64,
    /// Time.
    pub seconds: f64,
}

counters! {
    /// Samples and pixels.
    #[derive(Eq)]
    PictureCounters += Self {
        /// Pixels of the picture.
        pixels: count,
        /// Pixels in which some sample shows a surface.
        covered_pixels: count,
        /// Places where illumination was computed.
        shaded_points: count,
        /// Samples of transparent or cut-out surfaces, lines and points that were kept.
        layer_samples: count,
        /// Layers behind others that were dropped to stay within the memory for layers.
        lost_layers: count,
        /// Samples of layers where the depth function contradicted the order of a list.
        overruled_layers: count,
    }
}

/// Seconds a stage, which together are the whole but for a few allocations. The first ones are
/// those of the colour picture; rasterising and shading share the tiles, so they count as one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct StageSeconds {
    /// Culling, preparing the view and what illumination needs of it.
    pub prepare: f64,
    /// Solving for radiosity, or finding the solution that is known.
    pub radiosity: f64,
    /// What shadows need before the first point is asked for: maps, volumes, polygons.
    pub shadows: f64,
    /// Vertices and triangle setup.
    pub geometry: f64,
    /// Visibility in the tiles, illumination and shading.
    pub tiles: f64,
    /// Lines, points and edges.
    pub marks: f64,
    /// What needs all tiles: translucent surfaces, pictures of passes.
    pub compose: f64,
    /// Putting the tiles together.
    pub assemble: f64,
    /// The pass for the data channels (depth, ids, normals, shadows), all its stages.
    pub data: f64,
    /// The pass for the picture of the steps.
    pub steps: f64,
    /// All.
    pub total: f64,
}
