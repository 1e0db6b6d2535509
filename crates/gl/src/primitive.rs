//! Primitives: which of a run of vertices form elements, which triangles these are, and where a
//! long run may be cut.

use crate::enums::{
    LINE_LOOP, LINE_STRIP, LINES, POINTS, POLYGON, QUAD_STRIP, QUADS, TRIANGLE_FAN, TRIANGLE_STRIP,
    TRIANGLES,
};
use std::ops::Range;

/// What a run of vertices is assembled into; `mode` is `POINTS` ... `POLYGON`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Primitive {
    /// `POINTS` ... `POLYGON`.
    pub mode: u32,
    /// First index (or first vertex, without indices).
    pub first: u32,
    /// Indices (or vertices).
    pub count: u32,
}

/// Whether elements of this mode share no vertices, so that runs of them can be joined.
pub(crate) fn is_independent(mode: u32) -> bool {
    matches!(mode, POINTS | LINES | TRIANGLES | QUADS)
}

/// How many of `count` vertices form complete elements.
pub(crate) fn complete(mode: u32, count: u32) -> u32 {
    let (least, step) = match mode {
        POINTS => (1, 1),
        LINES => (2, 2),
        LINE_LOOP | LINE_STRIP => (2, 1),
        TRIANGLES => (3, 3),
        QUADS => (4, 4),
        QUAD_STRIP => (4, 2),
        _ => (3, 1),
    };
    if count < least { 0 } else { count - count % step }
}

/// How many triangles a primitive has; none for points and lines.
pub(crate) fn triangle_count(p: &Primitive) -> u32 {
    match p.mode {
        TRIANGLES => p.count / 3,
        TRIANGLE_STRIP | TRIANGLE_FAN | POLYGON => p.count.saturating_sub(2),
        QUADS => p.count / 4 * 2,
        QUAD_STRIP => p.count.saturating_sub(2) / 2 * 2,
        _ => 0,
    }
}

/// Some triangles of a primitive as index numbers, provoking corner last.
pub(crate) fn add_triangles(p: &Primitive, range: Range<u32>, out: &mut Vec<[u32; 3]>) {
    let first = p.first;
    match p.mode {
        TRIANGLES => out.extend(range.map(|i| [0, 1, 2].map(|k| first + 3 * i + k))),
        TRIANGLE_STRIP => out.extend(range.map(|i| {
            let v = first + i;
            if i % 2 == 0 { [v, v + 1, v + 2] } else { [v + 1, v, v + 2] }
        })),
        TRIANGLE_FAN => out.extend(range.map(|i| [first, first + i + 1, first + i + 2])),
        // The first vertex of a polygon provokes.
        POLYGON => out.extend(range.map(|i| [first + i + 1, first + i + 2, first])),
        QUADS => out.extend(range.map(|i| {
            let v = first + i / 2 * 4;
            if i % 2 == 0 { [v, v + 1, v + 3] } else { [v + 1, v + 2, v + 3] }
        })),
        QUAD_STRIP => out.extend(range.map(|i| {
            let v = first + i / 2 * 2;
            if i % 2 == 0 { [v, v + 1, v + 3] } else { [v + 2, v, v + 3] }
        })),
        _ => {}
    }
}

/// About how many vertices [`cut_into_parts`] puts into a part.
const PART_VERTICES: u32 = 1024;

/// Cuts primitives into parts of about equal size. Fans, loops and polygons stay whole, and so do
/// strips of lines if a stipple runs along them.
pub(crate) fn cut_into_parts(primitives: &[Primitive], stippled: bool) -> Vec<Vec<Primitive>> {
    let (mut parts, mut weight) = (Vec::new(), u32::MAX);
    for primitive in primitives {
        // Vertices from one place where it may be cut to the next, and how many both sides share.
        let (element, shared) = match primitive.mode {
            POINTS => (1, 0),
            LINES => (2, 0),
            TRIANGLES => (3, 0),
            QUADS => (4, 0),
            LINE_STRIP if !stippled => (1, 1),
            TRIANGLE_STRIP | QUAD_STRIP => (2, 2),
            _ => (primitive.count, 0),
        };

        // Append pieces of whole elements, and begin a part when one is full.
        let most = (PART_VERTICES / element).max(1) * element;
        for start in (0..primitive.count - shared).step_by(most as usize) {
            let count = (most + shared).min(primitive.count - start);
            if weight.saturating_add(count) > PART_VERTICES {
                parts.push(Vec::new());
                weight = 0;
            }
            weight += count;
            if let Some(part) = parts.last_mut() {
                part.push(Primitive {
                    mode: primitive.mode,
                    first: primitive.first + start,
                    count,
                });
            }
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn incomplete_elements_are_cut() {
        assert_eq!(complete(TRIANGLES, 8), 6);
        assert_eq!(complete(QUAD_STRIP, 7), 6);
        assert_eq!(complete(QUAD_STRIP, 3), 0);
        assert_eq!(complete(POLYGON, 2), 0);
        assert_eq!(complete(LINE_STRIP, 5), 5);
    }

    fn triangles(mode: u32, count: u32) -> Vec<[u32; 3]> {
        let p = Primitive { mode, first: 0, count };
        let mut out = Vec::new();
        add_triangles(&p, 0..triangle_count(&p), &mut out);
        out
    }

    #[test]
    fn the_provoking_vertex_is_last() {
        assert_eq!(triangles(QUADS, 4), [[0, 1, 3], [1, 2, 3]]);
        assert_eq!(triangles(QUAD_STRIP, 6), [[0, 1, 3], [2, 0, 3], [2, 3, 5], [4, 2, 5]]);
        assert_eq!(triangles(TRIANGLE_STRIP, 4), [[0, 1, 2], [2, 1, 3]]);
        assert_eq!(triangles(TRIANGLE_FAN, 4), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(triangles(POLYGON, 4), [[1, 2, 0], [2, 3, 0]]);
    }

    #[test]
    fn parts_hold_all_elements_once() {
        let all = [
            (LINE_STRIP, 3000),
            (TRIANGLE_STRIP, 2501),
            (QUADS, 8),
            (LINE_LOOP, 2000),
            (POINTS, 1),
        ];
        let mut first = 5;
        let primitives = all.map(|(mode, count)| {
            first += count;
            Primitive { mode, first: first - count, count }
        });
        // Elements by their last vertex; loops and quads here have none but that of the whole.
        let elements = |p: &Primitive| match p.mode {
            LINE_STRIP => (p.first + 1..p.first + p.count).collect(),
            TRIANGLE_STRIP => (p.first + 2..p.first + p.count).collect(),
            _ => vec![p.first + p.count - 1],
        };
        for stippled in [false, true] {
            let parts = cut_into_parts(&primitives, stippled);
            assert_eq!(parts.len(), if stippled { 6 } else { 8 });
            let found: Vec<u32> = parts.iter().flatten().flat_map(elements).collect();
            assert_eq!(found, primitives.iter().flat_map(elements).collect::<Vec<_>>());
            let strips = parts.iter().flatten().filter(|p| p.mode == TRIANGLE_STRIP);
            assert!(
                strips.clone().count() == 3
                    && strips.clone().all(|p| (p.first - primitives[1].first) % 2 == 0)
            );
        }
    }
}
