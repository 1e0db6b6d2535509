//! Takes away what of a mesh lies in front of a plane.
//!
//! A new vertex on an edge is computed from the edge's ends in the order of their numbers, once for
//! all triangles at it. A face is clipped triangle by triangle and put together again, so that a
//! polygon stays a polygon. Triangles within the plane stay where they look to the side that is
//! taken away: the body behind them is not cut.
//!
//! In:   a mesh, heights of its vertices over the plane. Out: the mesh below the plane, and the
//!       sides of its triangles in the plane.
//! Cost: linear.
//! Source: [Sutherland & Hodgman 1974].

use super::plane::Heights;
use super::rings::rings;
use crate::cut_marks::Section;
use crate::weld::Weld;
use crate::{Attribute, Corners, Faces, FreePart, Mesh, Part};
use std::collections::HashMap;
use std::sync::Arc;

/// A side of a triangle that lies in the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PlaneSide {
    /// The triangle of the whole mesh that it is a side of, or was cut from.
    pub(super) triangle: u32,
    /// Its ends in the order of the triangle, as vertices of the clipped mesh.
    pub(super) ends: [u32; 2],
}

/// A corner of a clipped triangle.
#[derive(Clone, Copy, Debug)]
struct Corner {
    vertex: u32,
    /// It lies between these corners of the whole triangle, so far on the way.
    between: [usize; 2],
    way: f64,
    in_plane: bool,
}

/// A triangle of the clipped mesh.
#[derive(Clone, Copy, Debug)]
struct Piece {
    triangle: u32,
    corners: [Corner; 3],
}

struct Clipper<'m> {
    mesh: &'m Mesh,
    weld: &'m Weld,
    heights: &'m Heights,
    positions: Vec<[f32; 3]>,
    /// New vertices by the ends of their edges, welded, the lower first.
    made: HashMap<[u32; 2], u32>,
}

/// The part of a mesh below a plane, and the sides of triangles in the plane.
pub(super) fn clip(mesh: &Mesh, weld: &Weld, heights: &Heights) -> (Mesh, Vec<PlaneSide>) {
    // Start with all positions; crossings are appended.
    let mut clipper =
        Clipper { mesh, weld, heights, positions: mesh.positions.clone(), made: HashMap::new() };
    let (mut pieces, mut parts, mut groups) = (Vec::new(), Vec::<Part>::new(), Vec::new());
    let (mut starts, mut outlines) = (vec![0], Vec::new());
    let first_cap =
        mesh.section.as_ref().map_or(mesh.face_count(), |section| section.first_cap as usize);
    let mut kept_first_cap = None;
    let mut part = 0;
    for face in 0..mesh.face_count() {
        if face == first_cap {
            kept_first_cap = Some(starts.len() as u32 - 1);
        }

        // Clip the triangles of the face, and put them together.
        let whole = mesh.face_triangles(face);
        let first = whole.start as u32;
        let of_face: Vec<Piece> = whole.flat_map(|t| clipper.triangle(t as u32)).collect();
        let corners: Vec<Corners> =
            of_face.iter().map(|piece| piece.corners.map(|c| c.vertex)).collect();
        for ring in if corners.is_empty() { Vec::new() } else { rings(&corners) } {
            pieces.extend(ring.triangles.iter().map(|&t| of_face[t as usize]));
            outlines.extend(ring.corners);
            starts.push(outlines.len() as u32);
            groups.extend(mesh.smoothing_groups.as_ref().map(|groups| groups[face]));
        }

        // Lengthen the part that the face is in.
        while mesh.parts.get(part).is_some_and(|p| p.triangles.end <= first) {
            part += 1;
        }
        let (start, end) = (parts.last().map_or(0, |p| p.triangles.end), pieces.len() as u32);
        if let Some(of) = mesh.parts.get(part).filter(|_| end > start) {
            match parts.last_mut() {
                Some(last) if last.material == of.material && last.name == of.name => {
                    last.triangles.end = end
                }
                _ => parts.push(Part { triangles: start..end, ..of.clone() }),
            }
        }
    }
    let faces = starts.len() as u32 - 1;
    let old_outline =
        mesh.section.as_ref().map_or(Vec::new(), |section| clipper.old_outline(section));
    let section = Section { first_cap: kept_first_cap.unwrap_or(faces), outline: old_outline };

    // Clip lines and points.
    let (lines, line_parts) = clipper.lines();
    let (points, point_parts) = clipper.points();

    // Collect the mesh, with attributes interpolated at the crossings.
    let clipped = Mesh {
        name: mesh.name.clone(),
        positions: clipper.positions,
        triangles: pieces.iter().map(|piece| piece.corners.map(|c| c.vertex)).collect(),
        faces: Faces::Polygons { starts, corners: outlines },
        parts,
        normals: mesh.normals.as_ref().map(|all| attribute(all, mesh, &pieces)),
        normals_stay: mesh.normals_stay,
        tangents: mesh.tangents.as_ref().map(|all| attribute(all, mesh, &pieces)),
        uvs: mesh.uvs.iter().map(|all| attribute(all, mesh, &pieces)).collect(),
        colors: mesh.colors.as_ref().map(|all| attribute(all, mesh, &pieces)),
        colors_from_srgb: mesh.colors_from_srgb,
        lines,
        points,
        line_parts,
        point_parts,
        smoothing_groups: mesh.smoothing_groups.as_ref().map(|_| groups),
        solidity: None,
        section: Some(Arc::new(section)),
    };
    (clipped, plane_sides(&pieces))
}

/// The sides of triangles that lie in the plane.
fn plane_sides(pieces: &[Piece]) -> Vec<PlaneSide> {
    let mut sides = Vec::new();
    for Piece { triangle, corners } in pieces {
        for k in 0..3 {
            let (from, to) = (corners[k], corners[(k + 1) % 3]);
            if from.in_plane && to.in_plane && from.vertex != to.vertex {
                sides.push(PlaneSide { triangle: *triangle, ends: [from.vertex, to.vertex] });
            }
        }
    }
    sides
}

/// The values of an attribute at the corners of pieces.
fn attribute<const N: usize>(
    all: &Attribute<[f32; N]>,
    mesh: &Mesh,
    pieces: &[Piece],
) -> Attribute<[f32; N]> {
    let indices = all.corners.as_deref().unwrap_or(&mesh.triangles);
    let mut values = all.values.clone();
    let corners = pieces.iter().map(|piece| {
        let own = indices[piece.triangle as usize];
        piece.corners.map(|corner| {
            let [from, to] = corner.between.map(|k| own[k]);
            if corner.between[0] == corner.between[1] || from == to {
                return from;
            }
            let [a, b] = [from, to].map(|i| values[i as usize]);
            values.push(std::array::from_fn(|k| {
                let [a, b] = [a[k], b[k]].map(f64::from);
                (a + (b - a) * corner.way) as f32
            }));
            values.len() as u32 - 1
        })
    });
    let corners = Some(corners.collect());
    Attribute { values, corners }
}

impl Clipper<'_> {
    /// The pieces of a triangle.
    fn triangle(&mut self, t: u32) -> Vec<Piece> {
        let vertices = self.mesh.triangles[t as usize];
        let [Some(a), Some(b), Some(c)] = vertices.map(|v| self.heights.side(v)) else {
            return Vec::new();
        };
        let sides = [a, b, c];
        let whole = |k: usize| Corner {
            vertex: vertices[k],
            between: [k; 2],
            way: 0.0,
            in_plane: sides[k] == 0,
        };
        let piece = |corners: [Corner; 3]| Piece { triangle: t, corners };
        if sides == [0; 3] {
            let [p, q, r] = vertices.map(|v| self.mesh.position(v));
            let looks_away = (q - p).cross(r - p).dot(self.heights.normal) > 0.0;
            return if looks_away { vec![piece([0, 1, 2].map(whole))] } else { Vec::new() };
        }
        if sides.iter().all(|&side| side >= 0) {
            return Vec::new();
        }

        // Walk round it: corners that stay, and where sides leave and enter.
        let mut polygon = Vec::with_capacity(4);
        for k in 0..3 {
            let next = (k + 1) % 3;
            if sides[k] <= 0 {
                polygon.push(whole(k));
            }
            if sides[k] * sides[next] < 0 {
                let (vertex, way) = self.vertex_between(vertices[k], vertices[next]);
                polygon.push(Corner { vertex, between: [k, next], way, in_plane: true });
            }
        }
        polygon.windows(2).skip(1).map(|pair| piece([polygon[0], pair[0], pair[1]])).collect()
    }

    /// The vertex where the way from one vertex to another meets the plane, and how far on the way
    /// it is.
    fn vertex_between(&mut self, from: u32, to: u32) -> (u32, f64) {
        let [a, b] = [from, to].map(|v| self.weld.of(v));
        let (low, high) = (a.min(b), a.max(b));
        let [d, e] = [low, high].map(|v| self.heights.of[v as usize]);
        let way = (d / (d - e)).clamp(0.0, 1.0);
        let vertex = *self.made.entry([low, high]).or_insert_with(|| {
            let [p, q] = [low, high].map(|v| self.mesh.position(v));
            self.positions.push((p + (q - p) * way).as_vec3().to_array());
            self.positions.len() as u32 - 1
        });
        (vertex, if a == low { way } else { 1.0 - way })
    }

    /// What is left of a free line.
    fn line(&mut self, [a, b]: [u32; 2]) -> Option<[u32; 2]> {
        let (at_a, at_b) = (self.heights.side(a)?, self.heights.side(b)?);
        if at_a <= 0 && at_b <= 0 {
            return Some([a, b]);
        }
        let between = (at_a * at_b < 0).then(|| self.vertex_between(a, b).0)?;
        Some(if at_a > 0 { [between, b] } else { [a, between] })
    }

    /// What is left of the free lines, and their parts.
    fn lines(&mut self) -> (Vec<[u32; 2]>, Vec<FreePart>) {
        let (mut lines, mut parts) = (Vec::new(), Vec::new());
        for (i, &line) in self.mesh.lines.iter().enumerate() {
            if let Some(line) = self.line(line) {
                lines.push(line);
                FreePart::extend(
                    &mut parts,
                    lines.len() - 1..lines.len(),
                    FreePart::material_of(&self.mesh.line_parts, i),
                );
            }
        }
        (lines, parts)
    }

    /// The free points that are left, and their parts.
    fn points(&self) -> (Vec<u32>, Vec<FreePart>) {
        let (mut points, mut parts) = (Vec::new(), Vec::new());
        for (i, &point) in self
            .mesh
            .points
            .iter()
            .enumerate()
            .filter(|&(_, &p)| self.heights.side(p).is_some_and(|side| side <= 0))
        {
            points.push(point);
            let material = FreePart::material_of(&self.mesh.point_parts, i);
            FreePart::extend(&mut parts, points.len() - 1..points.len(), material);
        }
        (points, parts)
    }

    /// What is left of the outline of earlier cuts.
    fn old_outline(&mut self, section: &Section) -> Vec<[u32; 2]> {
        let left = section.outline.iter().filter_map(|&edge| self.line(edge));
        let mut left: Vec<[u32; 2]> = left.map(|[a, b]| [a.min(b), a.max(b)]).collect();
        left.sort_unstable();
        left
    }
}
