//! Points, lines and outlined polygons, and filled ones mixed with them, emitted in the order of
//! their primitives.

use super::geometry::DrawGeometry;
use super::piece::PieceVertices;
use super::triangulate::add_filled;
use crate::enums as gl;
use crate::primitive::Primitive;
use vitral_math::lanes::Level;
use vitral_raster::forward::{Assembler, ForwardScreen, PrimitiveState, Primitives};

impl DrawGeometry {
    /// Emits some primitives, one after the other.
    pub(super) fn emit_ordered(
        &self,
        level: Level,
        primitives: &[Primitive],
        state: &PrimitiveState,
        screen: &ForwardScreen,
        out: &mut Primitives,
    ) {
        let indices = || primitives.iter().flat_map(|p| p.first..p.first + p.count);
        let own = PieceVertices::from_numbers(
            || indices().map(|i| self.batch.vertex(i) as u32),
            4 * indices().count() + 64,
        );
        self.emit_vertices(level, &own, state, screen, out, &|assembler| {
            self.emit_primitives(level, primitives, &own, assembler);
        });
    }

    fn emit_primitives(
        &self,
        level: Level,
        primitives: &[Primitive],
        own: &PieceVertices,
        assembler: &mut Assembler<'_>,
    ) {
        let mut filled = Vec::new();
        // Gather filled primitives, and emit them together before anything else.
        for primitive in primitives {
            if self.filled() && primitive.mode >= gl::TRIANGLES {
                let turned = self.first_diagonal.then(|| !self.snapshot.is_linear());
                add_filled(&self.batch, primitive, turned, &mut filled);
                continue;
            }
            self.emit_filled(level, &mut filled, own, assembler);

            // Emit points and lines.
            let vertex = |i: u32| own.number(self.batch.vertex(primitive.first + i) as u32);
            let n = primitive.count;
            match primitive.mode {
                gl::POINTS => (0..n).for_each(|i| assembler.point(vertex(i))),
                gl::LINES => (0..n / 2).for_each(|i| {
                    assembler.line([vertex(2 * i), vertex(2 * i + 1)], vertex(2 * i + 1), 0);
                }),
                gl::LINE_STRIP | gl::LINE_LOOP => {
                    let mut stipple = 0;
                    for i in 1..n {
                        stipple = assembler.line([vertex(i - 1), vertex(i)], vertex(i), stipple);
                    }
                    if primitive.mode == gl::LINE_LOOP {
                        assembler.line([vertex(n - 1), vertex(0)], vertex(0), stipple);
                    }
                }
                _ => self.emit_outlined(assembler, primitive, own),
            }
        }
        self.emit_filled(level, &mut filled, own, assembler);
    }

    /// Emits triangles that have gathered.
    fn emit_filled(
        &self,
        level: Level,
        filled: &mut Vec<[u32; 3]>,
        own: &PieceVertices,
        assembler: &mut Assembler<'_>,
    ) {
        filled.iter_mut().flatten().for_each(|corner| *corner = own.number(*corner));
        assembler.triangles(level, filled);
        filled.clear();
    }

    /// Polygons with their edges.
    fn emit_outlined(
        &self,
        assembler: &mut Assembler<'_>,
        primitive: &Primitive,
        own: &PieceVertices,
    ) {
        // Find the corners and their edge flags.
        let vertex = |i: u32| own.number(self.batch.vertex(primitive.first + i) as u32);
        let flag = |v: u32| match &self.batch.edges {
            Some(edges) => edges[own.get(v) as usize],
            None => self.snapshot.current.edge,
        };
        let n = primitive.count;
        let mut polygon = |corners: &[u32], provoking: u32, flagged: bool| {
            let edges: Vec<bool> = corners.iter().map(|&v| !flagged || flag(v)).collect();
            assembler.polygon(corners, &edges, provoking);
        };

        // Cut the primitive into polygons.
        match primitive.mode {
            gl::TRIANGLES => (0..n / 3).for_each(|i| {
                let c = [0, 1, 2].map(|k| vertex(3 * i + k));
                polygon(&c, c[2], true);
            }),
            gl::QUADS => (0..n / 4).for_each(|i| {
                let c = [0, 1, 2, 3].map(|k| vertex(4 * i + k));
                polygon(&c, c[3], true);
            }),
            gl::POLYGON => {
                let c: Vec<u32> = (0..n).map(vertex).collect();
                polygon(&c, c[0], true);
            }
            gl::TRIANGLE_STRIP => (2..n).for_each(|i| {
                let (a, b) = if i % 2 == 0 { (i - 2, i - 1) } else { (i - 1, i - 2) };
                polygon(&[vertex(a), vertex(b), vertex(i)], vertex(i), false);
            }),
            gl::TRIANGLE_FAN => (2..n).for_each(|i| {
                polygon(&[vertex(0), vertex(i - 1), vertex(i)], vertex(i), false);
            }),
            gl::QUAD_STRIP => (0..n.saturating_sub(2) / 2).for_each(|i| {
                let c = [0, 1, 3, 2].map(|k| vertex(2 * i + k));
                polygon(&c, c[2], false);
            }),
            _ => {}
        }
    }
}
