//! What the rasteriser asks of a recorded draw: how many pieces it has, and the primitives of each.

use super::geometry::DrawGeometry;
use super::grid::Grid;
use super::piece::Piece;
use super::triangulation::Triangulation;
use super::vertices::{LaneFaces, VertexBatch8, front_colors};
use crate::enums as gl;
use crate::primitive::Primitive;
use std::sync::Arc;
use vitral_math::lanes::{LANES, Level, dispatch};
use vitral_raster::forward::{ForwardScreen, Geometry, Layout, PrimitiveState, Primitives};

/// How a draw is cut into pieces.
enum Cut<'a> {
    /// One piece for a flat grid.
    Grid(&'a Grid),
    /// One piece for few vertices.
    Small(&'a [Primitive]),
    /// Primitives in their order.
    Ordered(&'a [Vec<Primitive>]),
    /// Triangles alone.
    Filled(&'a Triangulation),
}

impl Geometry for DrawGeometry {
    fn vertex_source(&self) -> usize {
        Arc::as_ptr(&self.batch) as usize
    }

    fn pieces(&self) -> usize {
        match self.cut() {
            Cut::Grid(_) | Cut::Small(_) => 1,
            Cut::Ordered(parts) => parts.len(),
            Cut::Filled(triangulation) => triangulation.len(),
        }
    }

    fn weight(&self, piece: usize) -> usize {
        let count = |primitives: &[Primitive]| primitives.iter().map(|p| p.count as usize).sum();
        match self.cut() {
            Cut::Grid(grid) => grid.rectangle.triangles.len(),
            Cut::Small(primitives) => count(primitives),
            Cut::Ordered(parts) => count(&parts[piece]),
            Cut::Filled(triangulation) => triangulation.weight(piece),
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
        self.primitive.polygon_mode != [2, 2]
            || self.triangulation.as_ref().map_or_else(others, |all| all.others)
    }

    fn emit(
        &self,
        level: Level,
        piece: usize,
        draw: u32,
        screen: &ForwardScreen,
        out: &mut Primitives,
    ) {
        let mut state = self.primitive.clone();
        state.draw = draw;

        // Leave whatever is not a piece of filled triangles to others.
        let triangulation = match self.cut() {
            Cut::Grid(grid) => return self.emit_grid(level, grid, state, screen, out),
            Cut::Small(primitives) => {
                return self.emit_ordered(level, primitives, &state, screen, out);
            }
            Cut::Ordered(parts) => {
                return self.emit_ordered(level, &parts[piece], &state, screen, out);
            }
            Cut::Filled(triangulation) => triangulation,
        };
        let whole = triangulation.piece(level, &self.batch, piece);
        let Piece { triangles, vertices, .. } = whole;

        // Drop a piece that lies outside the view. With depth clamping near and far do not bound
        // it.
        let bounded = !state.depth_clamp && self.batch.modelviews.is_empty();
        if bounded && self.is_outside(whole, &state) {
            return;
        }

        // Cut quads along the diagonal that this draw wants, and emit.
        let turned = self.first_diagonal.then(|| {
            let all = !self.snapshot.is_linear();
            triangulation.turned(&self.batch, piece, triangles, all)
        });
        let turned = turned.flatten();
        let triangles = turned.as_deref().unwrap_or(triangles);
        self.emit_vertices(level, vertices, &state, screen, out, &|assembler| {
            assembler.triangles(level, triangles)
        });
    }

    fn grid_colors(&self, level: Level, row: u32, eight: u32) -> [[f32; 4]; LANES] {
        let Some(grid) = self.grid() else { return [[0.0; 4]; LANES] };
        let columns = grid.cells[0] as usize + 1;

        // Take the eight vertices, the last one repeated at the end of a row.
        let row = &grid.vertices[row as usize * columns..][..columns];
        let own = &row[eight as usize * LANES..];
        let vertices = std::array::from_fn(|lane| own[lane.min(own.len() - 1)]);

        // Light them.
        let faces = &LaneFaces::new(&self.snapshot, &self.batch, &vertices);
        let transform = &self.snapshot.transform;
        let lanes = VertexBatch8 { vertices, count: LANES, batch: &self.batch, transform, faces };
        let [r, g, b, a] = dispatch!(level, simd => front_colors(simd, &self.snapshot, &lanes));
        std::array::from_fn(|lane| [r[lane], g[lane], b[lane], a[lane]])
    }
}

impl DrawGeometry {
    /// How the draw is cut into pieces.
    fn cut(&self) -> Cut<'_> {
        let Some(triangulation) = &self.triangulation else {
            return Cut::Small(&self.batch.primitives);
        };
        match self.grid() {
            Some(grid) => Cut::Grid(grid),
            None if triangulation.others || !self.filled() => {
                Cut::Ordered(triangulation.ordered(&self.batch, self.layout.line_stipple.is_some()))
            }
            None => Cut::Filled(triangulation),
        }
    }

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
        if !state.depth_clamp && self.is_outside(&grid.rectangle, &state) {
            return;
        }
        if self.layout.grid.is_some() {
            state.grid = out.grids.len() as u32;
            out.grids.push(out.grid_colors.add(grid.cells.map(|cells| cells + 1), grid.rising));
        }
        self.emit_vertices(level, vertices, &state, screen, out, &|assembler| {
            assembler.triangles(level, triangles)
        });
    }

    /// Whether a piece lies outside one plane of the view volume or of the user.
    fn is_outside(&self, piece: &Piece, state: &PrimitiveState) -> bool {
        let transform = &self.snapshot.transform;
        piece.is_outside(&transform.clip_from_model, &transform.clip_planes, state.window.near)
    }
}
