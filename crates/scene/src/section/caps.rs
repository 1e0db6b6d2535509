//! Closes the cuts through bodies.
//!
//! The loops of all closed bodies of one material lie on an integer grid in the plane. What they go
//! round is cut into triangles; corners of the loops stay the mesh's vertices, so that a closed
//! surface is closed afterwards. Where loops cross, as where surfaces penetrate themselves,
//! vertices are added. Rounding makes short sides cross as well; triangles that thin close these
//! gaps.
//!
//! In:   a clipped mesh and the outline of the cut. Out: the mesh with a flat face for each region
//!       inside.
//! Cost: `n log n` in the corners of the loops.

use super::gaps::close_gaps;
use super::outline::{BodyLoops, Inside, Outline};
use super::plane::SectionPlane;
use super::rings::rings;
use crate::{Attribute, Corners, Faces, Instance, Mesh, Part};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{IntOverlayOptions, Overlay, ShapeType};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::i_float::int::point::IntPoint;
use i_triangle::int::unchecked::IntUncheckedTriangulatable;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;
use vitral_math::{DMat4, DVec2, DVec3};

/// Half the steps of the grid across a cut.
const HALF_GRID: f64 = (1u64 << 29) as f64;
/// How far rounding may move a vertex, as a part of the largest coordinate: two steps of single
/// precision.
const ROUNDING: f64 = 1.0 / (1u64 << 22) as f64;

type Point = IntPoint<i32>;

/// The grid in the plane of a cut.
struct Grid {
    origin: DVec3,
    /// Unit vectors, world space; the plane's normal is `across × up`.
    across: DVec3,
    up: DVec3,
    steps_a_unit: f64,
    /// Steps by which rounding may move a vertex.
    rounding: f64,
    world_from_model: DMat4,
    model_from_world: DMat4,
    /// The vertex at each point.
    vertices: BTreeMap<[i32; 2], u32>,
    /// The vertex at each position, by its bits.
    vertex_at: HashMap<[u32; 3], u32>,
}

impl Grid {
    /// A grid for loops of a mesh; `None` where it would be of no size.
    fn new(
        mesh: &Mesh,
        instance: &Instance,
        plane: &SectionPlane,
        loops: &[BodyLoops],
    ) -> Option<Self> {
        // Measure the loops along two axes of the plane.
        let across = plane.normal.any_orthonormal_vector();
        let up = plane.normal.cross(across);
        let place = |v: u32| instance.world_from_model.transform_point3(mesh.position(v));
        let corners = || loops.iter().flat_map(|body| body.loops.iter().flatten()).copied();
        let along = |axis: DVec3| {
            let all = corners().map(|v| axis.dot(place(v) - plane.point));
            let (low, high) =
                all.fold((f64::MAX, f64::MIN), |(low, high), at| (low.min(at), high.max(at)));
            ((low + high) / 2.0, (high - low) / 2.0)
        };
        let ((x, half_width), (y, half_height)) = (along(across), along(up));

        // Fit the grid to the longer side, and give up if its size is zero or infinite.
        let steps_a_unit = HALF_GRID / half_width.max(half_height);
        let model_from_world = instance.world_from_model.inverse();
        if !(steps_a_unit.is_finite() && steps_a_unit > 0.0 && model_from_world.is_finite()) {
            return None;
        }

        // Bound how far rounding may move a vertex.
        let origin = plane.point + across * x + up * y;
        let largest = corners().fold(DVec3::ZERO, |largest, v| largest.max(mesh.position(v).abs()));
        let scale =
            DVec3::AXES.map(|axis| instance.world_from_model.transform_vector3(axis).length());
        let farthest = DVec3::from_array(scale).dot(largest);
        let rounding = 2.0 + farthest * ROUNDING * steps_a_unit;
        let mut grid = Self {
            origin,
            across,
            up,
            steps_a_unit,
            rounding,
            world_from_model: instance.world_from_model,
            model_from_world,
            vertices: BTreeMap::new(),
            vertex_at: HashMap::new(),
        };

        // Find the vertex at each point and at each position; of several, the first.
        for vertex in corners() {
            let Point { x, y } = grid.point(mesh, vertex);
            let first = grid.vertices.entry([x, y]).or_insert(vertex);
            *first = vertex.min(*first);
            let first =
                grid.vertex_at.entry(bits(mesh.positions[vertex as usize])).or_insert(vertex);
            *first = vertex.min(*first);
        }
        Some(grid)
    }

    /// The point nearest to a vertex of the mesh.
    fn point(&self, mesh: &Mesh, vertex: u32) -> Point {
        let at = self.world_from_model.transform_point3(mesh.position(vertex));
        let step = |axis: DVec3| (axis.dot(at - self.origin) * self.steps_a_unit).round() as i32;
        Point::new(step(self.across), step(self.up))
    }

    /// Twice the area of a triangle by its circumference, in what rounding may move a vertex.
    fn thickness(&self, mesh: &Mesh, corners: Corners) -> f64 {
        let [a, b, c] = corners.map(|v| {
            let Point { x, y } = self.point(mesh, v);
            DVec2::new(f64::from(x), f64::from(y))
        });
        (b - a).perp_dot(c - a).abs()
            / (a.distance(b) + b.distance(c) + c.distance(a)).max(1.0)
            / self.rounding
    }

    /// The vertex at a point, a new one where the mesh has none.
    fn vertex(&mut self, point: &Point, positions: &mut Vec<[f32; 3]>) -> u32 {
        *self.vertices.entry([point.x, point.y]).or_insert_with(|| {
            let [x, y] = [point.x, point.y].map(|step| f64::from(step) / self.steps_a_unit);
            let at = self.origin + self.across * x + self.up * y;
            let position = self.model_from_world.transform_point3(at).as_vec3().to_array();
            *self.vertex_at.entry(bits(position)).or_insert_with(|| {
                positions.push(position);
                positions.len() as u32 - 1
            })
        })
    }
}

/// The bits of a position, the same for both zeros.
fn bits(position: [f32; 3]) -> [u32; 3] {
    position.map(|axis| (axis + 0.0).to_bits())
}

/// The loops in which the plane cuts some bodies.
type Loops<'o> = Vec<&'o [u32]>;

/// Adds caps and the outline of the cut to a clipped mesh.
pub(super) fn close(
    clipped: &mut Mesh,
    whole: &Mesh,
    instance: &Instance,
    plane: &SectionPlane,
    outline: &Outline,
) {
    // Gather the loops of each group and material.
    let mut edges: Vec<[u32; 2]> = outline.edges.clone();
    let mut groups: BTreeMap<(&str, Option<u32>, Inside), Loops<'_>> = BTreeMap::new();
    for body in &outline.bodies {
        let material = whole.material_of_triangle(body.triangle as usize);
        let part = whole.parts.iter().find(|part| part.triangles.contains(&body.triangle));
        let name = part.map_or("", |part| part.name.as_str());
        let loops = groups.entry((name, material, body.inside)).or_default();
        loops.extend(body.loops.iter().map(Vec::as_slice));
    }

    // Cut what they go round into triangles.
    let normal =
        instance.world_from_model.transpose().transform_vector3(plane.normal).normalize_or_zero();
    let mirrored = instance.world_from_model.determinant() < 0.0;
    if let Some(mut grid) = Grid::new(clipped, instance, plane, &outline.bodies) {
        for ((name, material, inside), loops) in groups {
            let shapes = regions(clipped, &grid, &loops, inside);
            let mut cap: Vec<Corners> = Vec::new();
            shapes.iter().for_each(|shape| {
                cap.extend(triangles(shape, &mut grid, &mut clipped.positions, mirrored))
            });
            if inside == Inside::Winding {
                close_gaps(&loops, &mut cap, |corners| grid.thickness(clipped, corners));
            }
            add_outline(&cap, &mut edges);
            add_faces(clipped, &cap, name, material, normal);
        }
    }

    // Note the edges along the cut.
    edges.iter_mut().for_each(|edge| edge.sort_unstable());
    if let Some(section) = &mut clipped.section {
        let section = Arc::make_mut(section);
        section.outline.extend(edges);
        section.outline.sort_unstable();
        section.outline.dedup();
    }
}

/// What loops go round: outlines counter-clockwise, holes clockwise.
fn regions(mesh: &Mesh, grid: &Grid, loops: &[&[u32]], inside: Inside) -> Vec<Vec<Vec<Point>>> {
    let options = IntOverlayOptions {
        preserve_input_collinear: true,
        preserve_output_collinear: true,
        ..IntOverlayOptions::default()
    };
    let capacity = loops.iter().map(|corners| corners.len()).sum();
    let mut overlay = Overlay::<i32>::new_custom(capacity, options, Default::default());
    for corners in loops {
        let contour: Vec<Point> = corners.iter().map(|&v| grid.point(mesh, v)).collect();
        overlay.add_contour(&contour, ShapeType::Subject);
    }
    let rule = match inside {
        Inside::Winding => FillRule::NonZero,
        Inside::Parity => FillRule::EvenOdd,
    };
    overlay.overlay(OverlayRule::Subject, rule)
}

/// The triangles of a region, as vertices of the mesh, counter-clockwise seen from the side that is
/// taken away.
fn triangles(
    shape: &Vec<Vec<Point>>,
    grid: &mut Grid,
    positions: &mut Vec<[f32; 3]>,
    mirrored: bool,
) -> Vec<Corners> {
    let found = shape.uncheck_triangulate().into_triangulation::<u32>();
    let vertices: Vec<u32> =
        found.points.iter().map(|point| grid.vertex(point, positions)).collect();
    let corners =
        found.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]].map(|i| vertices[i as usize]));
    let turned = corners.map(|[a, b, c]| if mirrored { [a, c, b] } else { [a, b, c] });
    turned.filter(|[a, b, c]| a != b && b != c && c != a).collect()
}

/// Adds the sides that one triangle uses.
fn add_outline(triangles: &[Corners], edges: &mut Vec<[u32; 2]>) {
    let sides = |&[a, b, c]: &Corners| [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)]);
    let mut all: Vec<[u32; 2]> = triangles.iter().flat_map(sides).collect();
    all.sort_unstable();
    edges.extend(all.chunk_by(|a, b| a == b).filter(|uses| uses.len() == 1).map(|uses| uses[0]));
}

/// Adds flat faces of these triangles at the end of a mesh.
fn add_faces(
    mesh: &mut Mesh,
    triangles: &[Corners],
    name: &str,
    material: Option<u32>,
    normal: DVec3,
) {
    let Faces::Polygons { starts, corners } = &mut mesh.faces else { return };
    let first = mesh.triangles.len() as u32;
    for ring in if triangles.is_empty() { Vec::new() } else { rings(triangles) } {
        mesh.triangles.extend(ring.triangles.iter().map(|&t| triangles[t as usize]));
        corners.extend(ring.corners);
        starts.push(corners.len() as u32);
        mesh.smoothing_groups.iter_mut().for_each(|groups| groups.push(0));
    }

    // Give them their material, and values for what the mesh has at its corners.
    let end = mesh.triangles.len() as u32;
    match mesh.parts.last_mut() {
        Some(last) if last.material == material && last.name == name => last.triangles.end = end,
        _ => mesh.parts.push(Part { name: name.to_owned(), triangles: first..end, material }),
    }
    let count = (end - first) as usize;
    mesh.normals.iter_mut().for_each(|all| add_value(all, normal.as_vec3().to_array(), count));
    mesh.tangents.iter_mut().for_each(|all| add_value(all, [0.0, 0.0, 0.0, 1.0], count));
    mesh.uvs.iter_mut().for_each(|all| add_value(all, [0.0; 2], count));
    mesh.colors.iter_mut().for_each(|all| add_value(all, [1.0; 4], count));
}

/// Adds triangles with one value at all corners.
fn add_value<T>(all: &mut Attribute<T>, value: T, triangles: usize) {
    all.values.push(value);
    let index = all.values.len() as u32 - 1;
    if let Some(corners) = &mut all.corners {
        corners.extend(std::iter::repeat_n([index; 3], triangles));
    }
}
