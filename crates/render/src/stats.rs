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
    /// Rays and samples that were tested one by one.
    pub rays: RayCounters,
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
    /// Instances whose faces turned away are thrown away.
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

/// What algorithms that ask sample by sample did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct RayCounters {
    /// Samples asked for.
    pub rays: u64,
    /// Boxes of the tree that were tested.
    pub nodes_visited: u64,
    /// Facets that were tested for covering a sample.
    pub triangle_tests: u64,
}

impl RayCounters {
    pub(crate) fn add(&mut self, o: &Self) {
        self.rays += o.rays;
        self.nodes_visited += o.nodes_visited;
        self.triangle_tests += o.triangle_tests;
    }
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
}

impl PictureCounters {
    pub(crate) fn add(&mut self, o: &Self) {
        self.pixels += o.pixels;
        self.covered_pixels += o.covered_pixels;
        self.shaded_points += o.shaded_points;
        self.layer_samples += o.layer_samples;
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
