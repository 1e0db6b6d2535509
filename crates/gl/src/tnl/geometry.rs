//! A recorded draw: what the rasteriser asks for its primitives.

use super::assembled::{Assembled, Piece, PieceVertices};
use super::grid::Grid;
use super::parts::Parts;
use super::snapshot::VertexSnapshot;
use super::vertices::{Eight, LaneFaces, front_colors, shade};
use crate::enums as gl;
use crate::state;
use crate::vertex::{Primitive, VertexBatch};
use std::sync::Arc;
use vitral_math::lanes::{LANES, Level, dispatch};
use vitral_raster::forward::{
    Assembler, ForwardScreen, Geometry, Layout, PrimitiveState, Primitives, Vertices, flag_user_planes, project,
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
    pub assembled: Option<Arc<Assembled>>,
    /// The batch is a flat grid, and drawn as one.
    pub grid: bool,
    /// Quads are cut from their first corner to the third, not from the second to the fourth. The specification leaves
    /// open which; Mesa does so with what is neither indexed nor comes from a list, and where colours vary all see it.
    pub first_diagonal: bool,
    pub snapshot: VertexSnapshot,
    pub primitive: PrimitiveState,
    pub layout: Layout,
    pub points: PointSizes,
}

impl DrawGeometry {
    pub(super) fn filled(&self) -> bool {
        self.primitive.polygon_mode == [2, 2] && !self.primitive.polygon_smooth
    }

    /// The flat grid that is drawn.
    fn grid(&self) -> Option<&Grid> {
        self.assembled.as_ref()?.grid.as_ref().filter(|_| self.grid)
    }

    /// How it is cut into pieces.
    fn cut(&self) -> Cut<'_> {
        let Some(assembled) = &self.assembled else { return Cut::Small(&self.batch.primitives) };
        match self.grid() {
            Some(grid) => Cut::Grid(grid),
            None if assembled.others || !self.filled() => {
                Cut::Ordered(assembled.ordered(&self.batch, self.layout.line_stipple.is_some()))
            }
            None => Cut::Filled(assembled),
        }
    }
}

/// How a draw is cut into pieces.
enum Cut<'a> {
    /// One piece for a flat grid.
    Grid(&'a Grid),
    /// One piece for few vertices.
    Small(&'a [Primitive]),
    /// Primitives in their order.
    Ordered(&'a [Vec<Primitive>]),
    /// Triangles alone.
    Filled(&'a Assembled),
}

impl Geometry for DrawGeometry {
    fn vertex_source(&self) -> usize {
        Arc::as_ptr(&self.batch) as usize
    }

    fn pieces(&self) -> usize {
        match self.cut() {
            Cut::Grid(_) | Cut::Small(_) => 1,
            Cut::Ordered(parts) => parts.len(),
            Cut::Filled(assembled) => assembled.len(),
        }
    }

    fn weight(&self, piece: usize) -> usize {
        let count = |primitives: &[Primitive]| primitives.iter().map(|p| p.count as usize).sum();
        match self.cut() {
            Cut::Grid(grid) => grid.rectangle.triangles.len(),
            Cut::Small(primitives) => count(primitives),
            Cut::Ordered(parts) => count(&parts[piece]),
            Cut::Filled(assembled) => assembled.weight(piece),
        }
    }

    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn clip(&self) -> [i32; 4] {
        self.primitive.clip
    }

    fn has_strokes(&self) -> bool {
        let stroke = |primitive: &Primitive| primitive.mode < gl::TRIANGLES;
        let others = || self.batch.primitives.iter().any(stroke);
        self.primitive.polygon_mode != [2, 2] || self.assembled.as_ref().map_or_else(others, |all| all.others)
    }

    fn emit(&self, level: Level, piece: usize, draw: u32, screen: &ForwardScreen, out: &mut Primitives) {
        let mut state = self.primitive.clone();
        state.draw = draw;
        let assembled = match self.cut() {
            Cut::Grid(grid) => return self.emit_grid(level, grid, state, screen, out),
            Cut::Small(primitives) => return self.emit_ordered(level, primitives, &state, screen, out),
            Cut::Ordered(parts) => return self.emit_ordered(level, &parts[piece], &state, screen, out),
            Cut::Filled(assembled) => assembled,
        };
        let whole = assembled.piece(level, &self.batch, piece);
        let Piece { triangles, vertices, .. } = whole;
        // With depth clamping near and far do not bound the view.
        let bounded = !state.depth_clamp && self.batch.modelviews.is_empty();
        if bounded && whole.is_outside(&self.snapshot.transform, state.window.near) {
            return;
        }
        let turned = self.first_diagonal.then(|| {
            let all = !self.snapshot.is_linear();
            assembled.turned(&self.batch, piece, triangles, all)
        });
        let turned = turned.flatten();
        let triangles = turned.as_deref().unwrap_or(triangles);
        self.emit_vertices(level, vertices, &state, screen, out, &|assembler| assembler.triangles(level, triangles));
    }

    fn grid_colors(&self, level: Level, row: u32, eight: u32) -> [[f32; 4]; LANES] {
        let Some(grid) = self.grid() else { return [[0.0; 4]; LANES] };
        let columns = grid.cells[0] as usize + 1;
        let row = &grid.vertices[row as usize * columns..][..columns];
        let own = &row[eight as usize * LANES..];
        let vertices = std::array::from_fn(|lane| own[lane.min(own.len() - 1)]);
        let faces = &LaneFaces::new(&self.snapshot, &self.batch, &vertices);
        let transform = &self.snapshot.transform;
        let lanes = Eight { vertices, count: LANES, batch: &self.batch, transform, faces };
        let [r, g, b, a] = dispatch!(level, simd => front_colors(simd, &self.snapshot, &lanes));
        std::array::from_fn(|lane| [r[lane], g[lane], b[lane], a[lane]])
    }
}

/// Distances to the planes of the user, one after the other for each position.
fn add_user_distances(planes: &[[f32; 4]], positions: &[[f32; 4]], distances: &mut Vec<f32>) {
    let distance = |p: &[f32; 4], q: &[f32; 4]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3];
    if !planes.is_empty() {
        for p in positions {
            distances.extend(planes.iter().map(|plane| distance(plane, p)));
        }
    }
}

impl DrawGeometry {
    /// The rectangle of a flat grid, and room for the colours of the grid's vertices.
    fn emit_grid(
        &self,
        level: Level,
        grid: &Grid,
        mut state: PrimitiveState,
        screen: &ForwardScreen,
        out: &mut Primitives,
    ) {
        let Piece { triangles, vertices, .. } = &grid.rectangle;
        if !state.depth_clamp && grid.rectangle.is_outside(&self.snapshot.transform, state.window.near) {
            return;
        }
        if self.layout.grid.is_some() {
            state.grid = out.grids.len() as u32;
            out.grids.push(out.grid_colors.add(grid.cells.map(|cells| cells + 1), grid.rising));
        }
        self.emit_vertices(level, vertices, &state, screen, out, &|assembler| assembler.triangles(level, triangles));
    }

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
        let count = vertices.len();
        let gathered: Vec<[f32; 4]>;
        let positions = match vertices {
            PieceVertices::Range(start, end) => &self.batch.positions[*start as usize..*end as usize],
            PieceVertices::List(list) => {
                gathered = list.iter().map(|&v| self.batch.positions[v as usize]).collect();
                &gathered
            }
        };
        let (mut clip_memory, mut window_memory) = out.scratch.take(count);
        let (clip, window) = (&mut clip_memory[..count], &mut window_memory[..count]);
        let (mut user, mut sizes) = (Vec::new(), Vec::new());
        let (parts, sized) = (Parts::new(&self.snapshot, &self.batch, vertices), self.needs_sizes());
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
        let in_piece = Vertices { clip, screen: window, user: &user, sizes: &sizes };
        let mut assembler = Assembler::new(state, screen.screen(state.multisample), out, &self.layout, &in_piece);
        assemble(&mut assembler);
        assembler.shade(|eight, records| {
            self.shade_eight(level, vertices, &parts, clip, eight, records);
            if let (Some(at), Some(grid)) = (self.layout.grid, self.grid()) {
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
        parts: &Parts<'_>,
        clip: &[[f32; 4]],
        eight: &[u32],
        records: &mut [f32],
    ) {
        let stride = self.layout.stride;
        if self.layout.uniform {
            let color = self.snapshot.current.color.map(|c| c.clamp(0.0, 1.0));
            return records.chunks_exact_mut(stride).for_each(|record| {
                record[0] = 1.0;
                record[self.layout.color..].copy_from_slice(&color);
            });
        }
        let Some(some) = eight.iter().copied().find(|&v| Assembler::is_own(v)) else { return };
        let own: [u32; LANES] =
            std::array::from_fn(|lane| eight.get(lane).copied().filter(|&v| Assembler::is_own(v)).unwrap_or(some));
        let numbers = own.map(|v| vertices.get(v));
        let mut lane = 0;
        while lane < eight.len() {
            // Together as far as they share the matrix.
            let (transform, part) = parts.at(own[lane]);
            let same = |l: usize| parts.is_whole() || (own[lane]..part).contains(&own[l]);
            let end = (lane + 1..eight.len()).find(|&l| !same(l)).unwrap_or(eight.len());
            let used = |i: usize| (lane + i).min(end - 1);
            let inverse_w = std::array::from_fn(|i| 1.0 / clip[own[used(i)] as usize][3]);
            let some = std::array::from_fn(|i| numbers[used(i)]);
            let faces = &*parts.faces(&some);
            let some = Eight { vertices: some, count: end - lane, batch: &self.batch, transform, faces };
            let records = &mut records[lane * stride..];
            dispatch!(level, simd => shade(simd, &self.snapshot, &self.layout, &some, &inverse_w, records));
            lane = end;
        }
    }

    fn needs_sizes(&self) -> bool {
        let points = |primitive: &Primitive| primitive.mode == gl::POINTS;
        self.primitive.polygon_mode.contains(&0)
            || self.assembled.as_ref().map_or_else(|| self.batch.primitives.iter().any(points), |all| all.points)
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
