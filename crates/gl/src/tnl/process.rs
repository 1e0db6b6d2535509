//! Vertices processed at once, for feedback, selection and the raster position.

use super::snapshot::{LightCache, VertexSnapshot};
use super::vertices::{LaneFaces, VertexBatch8, process};
use crate::Context;
use crate::enums as gl;
use crate::state::{MAX_TEXTURE_UNITS, RasterPosition};
use crate::vertex::{CurrentState, VertexBatch};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{LANES, Level, dispatch};
use vitral_raster::forward::WindowTransform;

/// A vertex after transformation and lighting, with the coordinates of some texture units.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ProcessedVertex<const UNITS: usize> {
    /// Clip coordinates.
    pub clip: [f32; 4],
    /// Signed distances to the user clip planes (0 for disabled ones): inside is >= 0.
    pub user: [f32; 8],
    /// Front colour, clamped.
    pub color: [f32; 4],
    /// Front secondary colour, clamped.
    pub secondary: [f32; 3],
    /// Back colour, clamped (two-sided lighting; else the front's).
    pub back_color: [f32; 4],
    /// Coordinates of the first units after generation and texture matrix.
    pub tex: [[f32; 4]; UNITS],
    /// Fog coordinate.
    pub fog: f32,
    /// Edge flag.
    pub edge: bool,
}

impl<const UNITS: usize> Default for ProcessedVertex<UNITS> {
    fn default() -> Self {
        Self {
            clip: [0.0; 4],
            user: [0.0; 8],
            color: [0.0; 4],
            secondary: [0.0; 3],
            back_color: [0.0; 4],
            tex: [[0.0; 4]; UNITS],
            fog: 0.0,
            edge: false,
        }
    }
}

/// What of processed vertices matters besides their places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wanted {
    /// Nothing.
    Places,
    /// Colours.
    Colors,
    /// Colours and coordinates of textures.
    All,
}

impl Context {
    /// Transforms and lights all vertices of a batch at once.
    pub(crate) fn process_batch<const UNITS: usize>(
        &mut self,
        batch: &VertexBatch,
        wanted: Wanted,
    ) -> Vec<ProcessedVertex<UNITS>> {
        // Take a snapshot of the state.
        let units: Vec<usize> = (0..if wanted == Wanted::All { UNITS } else { 0 }).collect();
        let snapshot = VertexSnapshot::new(
            &self.state,
            &CurrentState::current(&self.state),
            &units,
            true,
            &mut LightCache::default(),
        );
        let mut planes = snapshot.transform.clip_planes.iter();
        let planes =
            self.state.clip_plane_enabled.map(|enabled| if enabled { planes.next() } else { None });

        // Shade eight vertices at a time.
        let level = Level::new();
        let mut out = vec![ProcessedVertex::default(); batch.positions.len()];
        let shaded = if wanted == Wanted::Places { 0 } else { batch.positions.len() };
        for first in (0..shaded).step_by(LANES) {
            let count = LANES.min(batch.positions.len() - first);
            let vertices = std::array::from_fn(|lane| (first + lane.min(count - 1)) as u32);
            let faces = &LaneFaces::new(&snapshot, batch, &vertices);
            let eight =
                VertexBatch8 { vertices, count, batch, transform: &snapshot.transform, faces };
            dispatch!(level, simd => {
                // Transpose the results to vertices.
                let (_, shaded, tex) = process(simd, &snapshot, &eight);
                let color = shaded.color.map(|c| c.to_array());
                let back = shaded.back.map_or(shaded.color, |(c, _)| c).map(|c| c.to_array());
                let secondary = shaded.secondary.map(|c| [c.x.to_array(), c.y.to_array(), c.z.to_array()]);
                let tex: [_; UNITS] = std::array::from_fn(|unit| tex[unit].map(|c| c.to_array()));
                let fog = shaded.fog.to_array();
                for lane in 0..count {
                    let vertex = &mut out[first + lane];
                    vertex.color = color.map(|c| c[lane]);
                    vertex.back_color = back.map(|c| c[lane]);
                    vertex.secondary = secondary.map_or([0.0; 3], |s| s.map(|c| c[lane]));
                    vertex.tex = tex.map(|unit| unit.map(|c| c[lane]));
                    vertex.fog = fog[lane];
                }
            });
        }

        // Transform all positions and measure their distances from the user's planes.
        let m = &snapshot.transform.clip_from_model;
        for (i, (vertex, p)) in out.iter_mut().zip(&batch.positions).enumerate() {
            vertex.clip = [0, 1, 2, 3]
                .map(|r| p[0] * m[r] + p[1] * m[4 + r] + p[2] * m[8 + r] + p[3] * m[12 + r]);
            vertex.user = planes.map(|plane| {
                plane.map_or(0.0, |q| p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3])
            });
            vertex.edge = batch.edges.as_ref().map_or(self.state.current.edge, |edges| edges[i]);
        }
        out
    }

    /// What `RasterPos` of a model-space position gives: with the current attributes, lit, clipped
    /// against the view volume and user planes.
    pub(crate) fn raster_position(&mut self, position: [f32; 4]) -> RasterPosition {
        // Process the position as a vertex.
        let batch = VertexBatch { positions: vec![position], ..VertexBatch::default() };
        let vertices = self.process_batch::<MAX_TEXTURE_UNITS>(&batch, Wanted::All);
        let Some(vertex) = vertices.first().copied() else { return RasterPosition::default() };

        // Project and clip it.
        let v = &self.state.viewport;
        let (origin, depth_mode) = self.state.clip_control;
        let zero_to_one = depth_mode == gl::ZERO_TO_ONE;
        let range = [v.depth_range.near, v.depth_range.far];
        let window = WindowTransform::new(v.rect, range, zero_to_one, origin == gl::UPPER_LEFT);
        let [x, y, z, w] = vertex.clip;
        let depth_ok = self.state.depth_clamp || (z >= window.near * w && z <= w);
        let in_view = x.abs() <= w && y.abs() <= w && depth_ok;
        let in_view = in_view || self.state.raster_position_unclipped;
        let inside = w > 0.0 && in_view && vertex.user.iter().all(|d| *d >= 0.0);
        if !inside {
            return RasterPosition { valid: false, ..self.state.raster_position };
        }

        // Keep the vertex's values as the raster's.
        let [wx, wy, wz] = window.project_exact(vertex.clip);
        RasterPosition {
            window: [wx, wy, wz, w],
            valid: true,
            distance: vertex.fog,
            color: vertex.color,
            secondary: vertex.secondary,
            tex: vertex.tex,
        }
    }
}
