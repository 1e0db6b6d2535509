//! Clipping at the border of the page, the near and the far plane, in homogeneous coordinates of
//! double precision.
//!
//! A triangle is cut by one plane after the other. A new vertex on a side of the triangle is
//! computed from the two ends of the *whole* side, in the order of their numbers, even where
//! another plane has cut the side before. So it depends on the side and the plane alone, and all
//! triangles at the side get the same vertex: it is made once and found by its name.
//!
//! In:   triangles with vertices in clip space. Out: triangles inside, and the vertices that are
//!       new.
//! Cost: constant for each triangle that crosses a plane; six planes.
//! Source: [Sutherland & Hodgman 1974], in the clip space of [Blinn & Newell 1978].

use crate::projection::{CUT_SIDES, Facet};
use std::collections::HashMap;
use vitral_math::DVec4;

/// Bit of the near plane in an outcode.
pub(crate) const OUT_OF_NEAR: u8 = 1 << 5;
/// Bit of a vertex that is not finite: nothing with it is drawn.
const NOT_FINITE: u8 = 1 << 6;
const PLANES: u32 = 6;

/// A vertex in clip space, and on the wrong side of which planes it is.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ClipVertex {
    pub(crate) at: DVec4,
    pub(crate) outcode: u8,
}

/// Distance from a plane, positive inside: left, right, bottom, top, far, near.
fn distance(p: DVec4, plane: u32) -> f64 {
    match plane {
        0 => p.w + p.x,
        1 => p.w - p.x,
        2 => p.w + p.y,
        3 => p.w - p.y,
        4 => p.z,
        _ => p.w - p.z,
    }
}

/// A bit for each plane that a point is outside of; all bits for a point that is not finite.
pub(crate) fn outcode(p: DVec4) -> u8 {
    if !p.is_finite() {
        return !OUT_OF_NEAR;
    }
    (0..PLANES).fold(0, |code, plane| code | u8::from(distance(p, plane) < 0.0) << plane)
}

/// What a side of a polygon is part of: a side of the triangle, by the numbers of its ends in
/// order, or a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Origin {
    /// A side of the facet: its ends, lower number first, and whether it is a side of the face and
    /// of a cut.
    Side { ends: [u32; 2], outline: bool, cut: bool },
    /// A clip plane.
    Plane,
}

/// A corner, and the side from it to the next corner.
#[derive(Clone, Copy, Debug)]
struct Corner {
    vertex: u32,
    origin: Origin,
}

/// Clips triangles and lines, and makes the vertices that they need.
pub(crate) struct Clipper<'v> {
    vertices: &'v mut Vec<ClipVertex>,
    /// New vertices by side and plane.
    made: HashMap<([u32; 2], u32), u32>,
}

impl<'v> Clipper<'v> {
    pub(crate) fn new(vertices: &'v mut Vec<ClipVertex>) -> Self {
        Self { vertices, made: HashMap::new() }
    }

    /// All vertices, the new ones included.
    pub(crate) fn vertices(&self) -> &[ClipVertex] {
        self.vertices
    }

    /// Cuts a triangle, and adds the inner part as a fan.
    pub(crate) fn clip(&mut self, facet: &Facet, to: &mut Vec<Facet>) {
        // Drop facets without finite coordinates.
        let codes = facet.vertices.map(|v| self.vertices[v as usize].outcode);
        let crossed = codes[0] | codes[1] | codes[2];
        if crossed & NOT_FINITE != 0 {
            return;
        }

        // Start with the facet's corners and their sides.
        let mut polygon: Vec<Corner> = (0..3)
            .map(|k| {
                let (a, b) = (facet.vertices[k], facet.vertices[(k + 1) % 3]);
                let has = |bit: u32| facet.outline >> bit & 1 == 1;
                let (outline, cut) = (has(k as u32), has(k as u32 + CUT_SIDES));
                Corner {
                    vertex: a,
                    origin: Origin::Side { ends: [a.min(b), a.max(b)], outline, cut },
                }
            })
            .collect();

        // Clip at each plane that some corner lies outside.
        for plane in (0..PLANES).filter(|plane| crossed >> plane & 1 == 1) {
            polygon = self.cut(&polygon, plane);
        }

        // Collapsed sides vanish; diagonals of the fan are no sides of the face.
        let mut kept: Vec<Corner> = Vec::with_capacity(polygon.len());
        for (k, corner) in polygon.iter().enumerate() {
            if corner.vertex != polygon[(k + 1) % polygon.len()].vertex {
                kept.push(*corner);
            }
        }
        let bits = |corner: &Corner| match corner.origin {
            Origin::Side { outline, cut, .. } => u8::from(outline) | u8::from(cut) << CUT_SIDES,
            Origin::Plane => 0,
        };

        // Emit the fan with the bits of its outer sides.
        for k in 1..kept.len().saturating_sub(1) {
            let vertices = [kept[0].vertex, kept[k].vertex, kept[k + 1].vertex];
            let first = if k == 1 { bits(&kept[0]) } else { 0 };
            let last = if k + 2 == kept.len() { bits(&kept[k + 1]) } else { 0 };
            let outline = first | bits(&kept[k]) << 1 | last << 2;
            to.push(Facet { vertices, source: facet.source, outline });
        }
    }

    /// The inner part of a line.
    pub(crate) fn clip_line(&mut self, ends: [u32; 2]) -> Option<[u32; 2]> {
        let codes = ends.map(|v| self.vertices[v as usize].outcode);
        if codes[0] & codes[1] != 0 || (codes[0] | codes[1]) & NOT_FINITE != 0 {
            return None;
        }
        let (whole, mut left) = ([ends[0].min(ends[1]), ends[0].max(ends[1])], ends);
        for plane in (0..PLANES).filter(|plane| (codes[0] | codes[1]) >> plane & 1 == 1) {
            let inside = left.map(|v| self.distance(v, plane) >= 0.0);
            match inside {
                [true, true] => {}
                [false, false] => return None,
                [true, false] => left[1] = self.vertex_on(whole, plane),
                [false, true] => left[0] = self.vertex_on(whole, plane),
            }
        }
        Some(left)
    }

    fn distance(&self, vertex: u32, plane: u32) -> f64 {
        distance(self.vertices[vertex as usize].at, plane)
    }

    /// The part of a polygon inside a plane.
    fn cut(&mut self, polygon: &[Corner], plane: u32) -> Vec<Corner> {
        let mut inside = Vec::with_capacity(polygon.len() + 1);
        for (k, corner) in polygon.iter().enumerate() {
            let next = polygon[(k + 1) % polygon.len()].vertex;
            let [here, there] = [corner.vertex, next].map(|v| self.distance(v, plane) >= 0.0);
            if here {
                inside.push(*corner);
            }
            if here != there {
                let vertex = match corner.origin {
                    Origin::Side { ends, .. } => self.vertex_on(ends, plane),
                    Origin::Plane => self.vertex_between(corner.vertex, next, plane),
                };
                // Where the polygon leaves, it goes on along the plane.
                let origin = if here { Origin::Plane } else { corner.origin };
                inside.push(Corner { vertex, origin });
            }
        }
        inside
    }

    /// The vertex where a side meets a plane.
    fn vertex_on(&mut self, ends: [u32; 2], plane: u32) -> u32 {
        if let Some(&made) = self.made.get(&(ends, plane)) {
            return made;
        }
        let vertex = self.vertex_between(ends[0], ends[1], plane);
        self.made.insert((ends, plane), vertex);
        vertex
    }

    /// The vertex where the way between two vertices meets a plane: a new one, unless an end lies
    /// in the plane.
    fn vertex_between(&mut self, a: u32, b: u32, plane: u32) -> u32 {
        let [p, q] = [a, b].map(|v| self.vertices[v as usize].at);
        let (d, e) = (distance(p, plane), distance(q, plane));
        match (d == 0.0, e == 0.0) {
            (true, _) => return a,
            (_, true) => return b,
            _ => {}
        }
        // Rounding may leave both ends on one side.
        let way = if d == e { 0.0 } else { (d / (d - e)).clamp(0.0, 1.0) };
        let at = p + (q - p) * way;
        self.vertices.push(ClipVertex { at, outcode: 0 });
        self.vertices.len() as u32 - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vertices(points: &[[f64; 3]]) -> Vec<ClipVertex> {
        let vertex = |p: &[f64; 3]| {
            let at = DVec4::new(p[0], p[1], p[2], 1.0);
            ClipVertex { at, outcode: outcode(at) }
        };
        points.iter().map(vertex).collect()
    }

    #[test]
    fn neighbours_share_the_vertices_on_their_common_side() {
        // A square of two triangles that reaches beyond the right border.
        let mut all =
            vertices(&[[0.0, 0.0, 0.5], [2.0, 0.0, 0.5], [2.0, 0.8, 0.5], [0.0, 0.8, 0.5]]);
        let mut clipper = Clipper::new(&mut all);
        let mut facets = Vec::new();
        clipper.clip(&Facet { vertices: [0, 1, 2], source: 0, outline: 0b011 }, &mut facets);
        clipper.clip(&Facet { vertices: [0, 2, 3], source: 1, outline: 0b110 }, &mut facets);
        assert_eq!(facets.len(), 3);
        let cut: Vec<u32> = facets.iter().flat_map(|f| f.vertices).filter(|&v| v >= 4).collect();
        let distinct: std::collections::BTreeSet<u32> = cut.iter().copied().collect();
        assert_eq!(distinct.len(), 3, "two sides and the diagonal are cut once each: {facets:?}");
        assert!(all[4..].iter().all(|v| v.at.x == 1.0));
        // The first is a triangle with one side along the page's border and one diagonal: one side
        // of the face is left.
        let outlines: Vec<u32> = facets.iter().map(|f| u32::from(f.outline).count_ones()).collect();
        assert_eq!(outlines.iter().sum::<u32>(), 3, "{facets:?}");
    }

    #[test]
    fn a_corner_of_the_page_is_cut_by_two_planes() {
        let mut all = vertices(&[[-9.0, -9.0, 0.5], [9.0, -9.0, 0.5], [0.0, 20.0, 0.5]]);
        let mut facets = Vec::new();
        Clipper::new(&mut all)
            .clip(&Facet { vertices: [0, 1, 2], source: 0, outline: 0b111 }, &mut facets);
        let area = |f: &Facet| {
            let [a, b, c] = f.vertices.map(|v| all[v as usize].at);
            ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2.0
        };
        assert!((facets.iter().map(area).sum::<f64>() - 4.0).abs() < 1e-12, "{facets:?}");
        assert!(facets.iter().all(|f| f.outline == 0));
    }

    #[test]
    fn lines_are_cut_and_what_is_not_finite_vanishes() {
        let mut all = vertices(&[
            [-3.0, 0.0, 0.5],
            [3.0, 0.0, 0.5],
            [f64::NAN, 0.0, 0.0],
            [0.0, 0.0, 0.5],
            [5.0, 5.0, 0.5],
        ]);
        let mut clipper = Clipper::new(&mut all);
        let [a, b] = clipper.clip_line([1, 0]).unwrap();
        assert!(clipper.clip_line([0, 2]).is_none() && clipper.clip_line([4, 1]).is_none());
        assert_eq!(clipper.clip_line([3, 3]), Some([3, 3]));
        let mut none = Vec::new();
        clipper.clip(&Facet { vertices: [0, 1, 2], source: 0, outline: 0 }, &mut none);
        assert!(none.is_empty());
        assert_eq!([all[a as usize].at.x, all[b as usize].at.x], [1.0, -1.0]);
    }
}
