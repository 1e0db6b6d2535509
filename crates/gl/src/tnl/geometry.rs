//! A recorded draw: its vertices and state, and how the vertices of a piece are transformed and
//! shaded.

use super::grid::Grid;
use super::parts::TransformRanges;
use super::piece::PieceVertices;
use super::snapshot::VertexSnapshot;
use super::triangulation::Triangulation;
use super::vertices::{VertexBatch8, shade};
use crate::enums as gl;
use crate::primitive::Primitive;
use crate::state;
use crate::vertex::VertexBatch;
use std::sync::Arc;
use vitral_math::lanes::{LANES, Level, dispatch};
use vitral_raster::forward::{
    Assembler, ForwardScreen, Layout, PrimitiveState, Primitives, Vertices, flag_user_planes,
    project,
};

/// Point parameters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PointSizes {
    pub size: f32,
    pub limits: [f32; 2],
    pub attenuation: [f32; 3],
    /// Multisampled points smaller than this fade.
    pub fade: Option<f32>,
}

/// See the module.
#[derive(Debug)]
pub(crate) struct DrawGeometry {
    pub batch: Arc<VertexBatch>,
    /// Its triangles; none for few vertices, which are not drawn again.
    pub triangulation: Option<Arc<Triangulation>>,
    /// The batch is a flat grid, and drawn as one.
    pub grid: bool,
    /// Quads are cut from their first corner to the third, not from the second to the fourth. The
    /// specification leaves open which; Mesa does so with quads neither indexed nor from a
    /// list, and where colours vary all see it.
    pub first_diagonal: bool,
    pub snapshot: VertexSnapshot,
    pub primitive: PrimitiveState,
    pub layout: Layout,
    pub points: PointSizes,
}

impl DrawGeometry {
    /// Whether polygons are filled, with hard edges.
    pub(super) fn filled(&self) -> bool {
        self.primitive.polygon_mode == [2, 2] && !self.primitive.polygon_smooth
    }

    /// The flat grid that is drawn.
    pub(super) fn grid(&self) -> Option<&Grid> {
        self.triangulation.as_ref()?.grid.as_ref().filter(|_| self.grid)
    }
}

/// Adds the distances of each position to the planes of the user.
fn add_user_distances(planes: &[[f32; 4]], positions: &[[f32; 4]], distances: &mut Vec<f32>) {
    let distance =
        |p: &[f32; 4], q: &[f32; 4]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3];
    if !planes.is_empty() {
        for p in positions {
            distances.extend(planes.iter().map(|plane| distance(plane, p)));
        }
    }
}

impl DrawGeometry {
    /// Transforms a piece's vertices, assembles, and shades the vertices that primitives use.
    pub(super) fn emit_vertices(
        &self,
        level: Level,
        vertices: &PieceVertices,
        state: &PrimitiveState,
        screen: &ForwardScreen,
        out: &mut Primitives,
        assemble: &dyn Fn(&mut Assembler<'_>),
    ) {
        // Find the positions of the piece's vertices.
        let count = vertices.len();
        let gathered: Vec<[f32; 4]>;
        let positions = match vertices {
            PieceVertices::Range(start, end) => {
                &self.batch.positions[*start as usize..*end as usize]
            }
            PieceVertices::List(list) => {
                gathered = list.iter().map(|&v| self.batch.positions[v as usize]).collect();
                &gathered
            }
        };

        // Transform them, a run with one modelview matrix after the other.
        let (mut clip_memory, mut window_memory) = out.scratch.take(count);
        let (clip, window) = (&mut clip_memory[..count], &mut window_memory[..count]);
        let (mut user, mut sizes) = (Vec::new(), Vec::new());
        let (parts, sized) =
            (TransformRanges::new(&self.snapshot, &self.batch, vertices), self.needs_sizes());
        for (part, transform) in parts.each(count) {
            let positions = &positions[part.clone()];
            let (clip, window) = (&mut clip[part.clone()], &mut window[part.clone()]);
            project(level, positions, &transform.clip_from_model, &state.window, clip, window);
            add_user_distances(&transform.clip_planes, positions, &mut user);
            if sized {
                self.add_sizes(&transform.modelview, positions, &mut sizes);
            }
        }
        flag_user_planes(&user, window);

        // Assemble primitives, then shade the vertices that they use.
        let in_piece = Vertices { clip, screen: window, user: &user, sizes: &sizes };
        let mut assembler =
            Assembler::new(state, screen.screen(state.multisample), out, &self.layout, &in_piece);
        assemble(&mut assembler);
        assembler.shade(|eight, records| {
            self.shade_eight(level, vertices, &parts, clip, eight, records);
            if let (Some(at), Some(grid)) = (self.layout.grid, self.grid()) {
                // Tell fragments where in the grid they lie.
                let own = eight
                    .iter()
                    .zip(records.chunks_exact_mut(self.layout.stride))
                    .filter(|(v, _)| Assembler::is_own(**v));
                own.for_each(|(&v, record)| record[at..at + 2].copy_from_slice(&grid.corner(v)));
            }
        });
        drop(assembler);
        (out.scratch.clip, out.scratch.screen) = (clip_memory, window_memory);
    }

    /// Shades up to eight used vertices; those that clipping made are skipped.
    fn shade_eight(
        &self,
        level: Level,
        vertices: &PieceVertices,
        parts: &TransformRanges<'_>,
        clip: &[[f32; 4]],
        eight: &[u32],
        records: &mut [f32],
    ) {
        // Give all vertices the current colour if nothing varies.
        let stride = self.layout.stride;
        if self.layout.uniform {
            let limited = |c: f32| if self.snapshot.clamps { c.clamp(0.0, 1.0) } else { c };
            let color = self.snapshot.current.color.map(limited);
            return records.chunks_exact_mut(stride).for_each(|record| {
                record[0] = 1.0;
                record[self.layout.color..].copy_from_slice(&color);
            });
        }

        // Replace vertices that clipping made, and lanes beyond the last, by some other vertex.
        let Some(some) = eight.iter().copied().find(|&v| Assembler::is_own(v)) else { return };
        let own: [u32; LANES] = std::array::from_fn(|lane| {
            eight.get(lane).copied().filter(|&v| Assembler::is_own(v)).unwrap_or(some)
        });
        let numbers = own.map(|v| vertices.get(v));

        // Shade runs of vertices that share the modelview matrix.
        let mut lane = 0;
        while lane < eight.len() {
            let (transform, part) = parts.at(own[lane]);
            let same = |l: usize| parts.is_whole() || (own[lane]..part).contains(&own[l]);
            let end = (lane + 1..eight.len()).find(|&l| !same(l)).unwrap_or(eight.len());
            let used = |i: usize| (lane + i).min(end - 1);
            let inverse_w = std::array::from_fn(|i| 1.0 / clip[own[used(i)] as usize][3]);
            let some = std::array::from_fn(|i| numbers[used(i)]);
            let faces = &*parts.faces(&some);
            let some = VertexBatch8 {
                vertices: some,
                count: end - lane,
                batch: &self.batch,
                transform,
                faces,
            };
            let records = &mut records[lane * stride..];
            dispatch!(level, simd => shade(simd, &self.snapshot, &self.layout, &some, &inverse_w, records));
            lane = end;
        }
    }

    /// Whether points are drawn, which have sizes.
    fn needs_sizes(&self) -> bool {
        let points = |primitive: &Primitive| primitive.mode == gl::POINTS;
        self.primitive.polygon_mode.contains(&0)
            || self
                .triangulation
                .as_ref()
                .map_or_else(|| self.batch.primitives.iter().any(points), |all| all.points)
    }

    /// Point sizes and fade factors.
    fn add_sizes(&self, m: &[f32; 16], positions: &[[f32; 4]], sizes: &mut Vec<[f32; 2]>) {
        let points = &self.points;
        let size_at = |p: &[f32; 4]| {
            // The distance from the eye, taken along its axis as Mesa does.
            let d = (p[0] * m[2] + p[1] * m[6] + p[2] * m[10] + p[3] * m[14]).abs();
            let [a, b, c] = points.attenuation;
            let loss = a + b * d + c * d * d;
            let size = if loss > 0.0 { points.size / loss.sqrt() } else { points.limits[1] };
            let most = points.limits[1].min(state::MAX_POINT_SIZE);
            let size = size.max(points.limits[0]).min(most).max(1.0);
            match points.fade {
                Some(threshold) if size < threshold => {
                    [threshold.min(state::MAX_POINT_SIZE), (size / threshold) * (size / threshold)]
                }
                _ => [size, 1.0],
            }
        };
        sizes.extend(positions.iter().map(size_at));
    }
}
