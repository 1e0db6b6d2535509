//! Points, lines and outlined polygons, and whatever is mixed with them: in the order of their primitives.

use super::assembled::{PieceVertices, add_filled};
use super::geometry::DrawGeometry;
use crate::enums as gl;
use crate::vertex::Primitive;
use vitral_math::lanes::Level;
use vitral_raster::forward::{Assembler, ForwardScreen, PrimitiveState, Primitives};

/// About how many vertices a part has.
const PART: u32 = 1024;

/// Cuts primitives into parts of about equal size. Fans, loops and polygons stay whole, and so do strips of lines if a stipple
/// runs along them.
pub(super) fn parts(primitives: &[Primitive], stippled: bool) -> Vec<Vec<Primitive>> {
    let (mut parts, mut weight) = (Vec::new(), u32::MAX);
    for primitive in primitives {
        // Vertices from one place where it may be cut to the next, and how many both sides share.
        let (element, shared) = match primitive.mode {
            gl::POINTS => (1, 0),
            gl::LINES => (2, 0),
            gl::TRIANGLES => (3, 0),
            gl::QUADS => (4, 0),
            gl::LINE_STRIP if !stippled => (1, 1),
            gl::TRIANGLE_STRIP | gl::QUAD_STRIP => (2, 2),
            _ => (primitive.count, 0),
        };
        let most = (PART / element).max(1) * element;
        for start in (0..primitive.count - shared).step_by(most as usize) {
            let count = (most + shared).min(primitive.count - start);
            if weight.saturating_add(count) > PART {
                parts.push(Vec::new());
                weight = 0;
            }
            weight += count;
            if let Some(part) = parts.last_mut() {
                part.push(Primitive { mode: primitive.mode, first: primitive.first + start, count });
            }
        }
    }
    parts
}

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
        let own = PieceVertices::of(|| indices().map(|i| self.batch.vertex(i) as u32), 4 * indices().count() + 64);
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
        for primitive in primitives {
            if self.filled() && primitive.mode >= gl::TRIANGLES {
                let turned = self.first_diagonal.then(|| !self.snapshot.is_linear());
                add_filled(&self.batch, primitive, turned, &mut filled);
                continue;
            }
            self.emit_filled(level, &mut filled, own, assembler);
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
    fn emit_outlined(&self, assembler: &mut Assembler<'_>, primitive: &Primitive, own: &PieceVertices) {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_hold_all_elements_once() {
        let all = [
            (gl::LINE_STRIP, 3000),
            (gl::TRIANGLE_STRIP, 2501),
            (gl::QUADS, 8),
            (gl::LINE_LOOP, 2000),
            (gl::POINTS, 1),
        ];
        let mut first = 5;
        let primitives = all.map(|(mode, count)| {
            first += count;
            Primitive { mode, first: first - count, count }
        });
        // Elements by their last vertex; loops and quads here have none but that of the whole.
        let elements = |p: &Primitive| match p.mode {
            gl::LINE_STRIP => (p.first + 1..p.first + p.count).collect(),
            gl::TRIANGLE_STRIP => (p.first + 2..p.first + p.count).collect(),
            _ => vec![p.first + p.count - 1],
        };
        for stippled in [false, true] {
            let parts = parts(&primitives, stippled);
            assert_eq!(parts.len(), if stippled { 6 } else { 8 });
            let found: Vec<u32> = parts.iter().flatten().flat_map(elements).collect();
            assert_eq!(found, primitives.iter().flat_map(elements).collect::<Vec<_>>());
            let strips = parts.iter().flatten().filter(|p| p.mode == gl::TRIANGLE_STRIP);
            assert!(strips.clone().count() == 3 && strips.clone().all(|p| (p.first - primitives[1].first) % 2 == 0));
        }
    }
}
