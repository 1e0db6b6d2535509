//! What is the same all over a facet, computed once for each facet that a tile shows.
//!
//! Weights of the corners: with corners in homogeneous screen coordinates `(X, Y, W)` relative to a
//! point, `e0 = X1 Y2 - X2 Y1` and so on are in the ratio of the point's barycentric coordinates on
//! the surface in space (perspective-correct), for corners behind the eye too. As functions of the
//! point's place they are linear: `c + a x + b y`, taken from an anchor on the facet so that little
//! cancels. Each multiplied with its corner's `W` they would be those on the screen; that is the
//! classical defect, kept for comparison.
//!
//! In:   the points of one object and material. Out: a record for each of their facets, and which
//!       one each point has.
//! Cost: linear in points; the record of a facet costs as much as a few points.
//! Source: [Heckbert & Moreton 1991], [Olano & Greer 1997].

use super::geometry::{F, Record, affine, constant, gather, linear};
use super::points::Points;
use super::subject::Subject;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, LANES, Simd, V3};
use vitral_scene::Mesh;

/// The records of a group's facets.
#[derive(Default)]
pub(crate) struct FacetTable {
    /// One for each facet; a facet that was forgotten in between may have several.
    pub records: Vec<Record>,
    /// Record of each point, in the group's order.
    pub of_point: Vec<u32>,
    /// Triangle and anchor of each record.
    triangles: Vec<u32>,
    anchors: Vec<[f32; 2]>,
    /// A facet and its record, by the facet's lowest bits.
    recent: Vec<[u32; 2]>,
}

/// Facets that are remembered at a time.
const RECENT: usize = 1024;

impl FacetTable {
    /// The triangle of each record.
    pub(crate) fn triangles(&self) -> &[u32] {
        &self.triangles
    }

    /// Makes the records for the points `order`.
    pub(crate) fn fill<S: Simd>(
        &mut self,
        simd: S,
        points: &Points,
        order: &[u32],
        subject: &Subject<'_>,
    ) {
        // Number the facets; a small table finds those seen lately.
        self.triangles.clear();
        self.anchors.clear();
        self.of_point.clear();
        self.recent.clear();
        self.recent.resize(RECENT, [u32::MAX; 2]);
        for &p in order {
            let facet = points.facet[p as usize];
            let recent = &mut self.recent[facet as usize % RECENT];
            if recent[0] != facet {
                *recent = [facet, self.triangles.len() as u32];
                self.triangles.push(facet - subject.first_facet);
                self.anchors.push(points.place[p as usize]);
            }
            self.of_point.push(recent[1]);
        }
        // Every record is written, so old contents may stay.
        self.records.resize(self.triangles.len(), Record([0.0; 32]));

        // Compute the records, eight at a time.
        let eights = self
            .triangles
            .chunks(LANES)
            .zip(self.anchors.chunks(LANES))
            .zip(self.records.chunks_mut(LANES));
        for ((triangles, anchors), records) in eights {
            simd.vectorize(
                #[inline(always)]
                || eight_records(simd, triangles, anchors, subject, records),
            );
        }
    }
}

/// The corners of each lane's triangle, model space.
#[inline(always)]
pub(super) fn model_corners<S: Simd>(simd: S, triangles: &[u32], mesh: &Mesh) -> [[F<S>; 3]; 3] {
    let last = triangles.len() - 1;
    gather(
        simd,
        #[inline(always)]
        |lane, corner| {
            mesh.positions[mesh.triangles[triangles[lane.min(last)] as usize][corner] as usize]
        },
    )
}

#[inline(always)]
fn eight_records<S: Simd>(
    simd: S,
    triangles: &[u32],
    anchors: &[[f32; 2]],
    subject: &Subject<'_>,
    out: &mut [Record],
) {
    // Gather the corners and the points at which weights are anchored.
    let (instance, viewing) = (subject.instance, subject.viewing);
    let last = triangles.len() - 1;
    let model = model_corners(simd, triangles, subject.mesh);
    let (mut x, mut y) = ([0.0; LANES], [0.0; LANES]);
    for lane in 0..LANES {
        [x[lane], y[lane]] = anchors[lane.min(last)];
    }
    let (x0, y0) = (F32x8::from_slice(simd, &x), F32x8::from_slice(simd, &y));

    // Weights as functions of the place.
    let to_screen = &instance.screen_from_model;
    let mut s =
        [affine(to_screen, &model[0]), affine(to_screen, &model[1]), affine(to_screen, &model[2])];
    for c in 0..3 {
        s[c] = V3::new(s[c].x - x0 * s[c].z, s[c].y - y0 * s[c].z, s[c].z);
    }
    let mut edges = [[constant(simd, 0.0); 3]; 3];
    for c in 0..3 {
        let (p, q) = (s[(c + 1) % 3], s[(c + 2) % 3]);
        edges[c] = [p.x * q.y - q.x * p.y, q.z * p.y - p.z * q.y, q.x * p.z - p.x * q.z];
    }
    if viewing.screen_linear() {
        // Linear on the screen. A facet that reaches behind the eye has corners that are nowhere on
        // it.
        let before = lanes::Lanes::lt(
            constant(simd, 0.0),
            lanes::Lanes::min(lanes::Lanes::min(s[0].z, s[1].z), s[2].z),
        );
        for c in 0..3 {
            let scale = lanes::Lanes::select(before, s[c].z, constant(simd, 1.0));
            edges[c] = [edges[c][0] * scale, edges[c][1] * scale, edges[c][2] * scale];
        }
    }

    write_records(simd, triangles, subject, &model, None, edges, [x0, y0], out);
}

/// Corners and normals in view space, and with the weights into records; seen from `origin` (view
/// space) if not by the eye.
#[inline(always)]
pub(super) fn write_records<S: Simd>(
    simd: S,
    triangles: &[u32],
    subject: &Subject<'_>,
    model: &[[F<S>; 3]; 3],
    origin: Option<V3<F<S>>>,
    weights: [[F<S>; 3]; 3],
    [x0, y0]: [F<S>; 2],
    out: &mut [Record],
) {
    // Bring corners and normals to view space, on the viewer's side.
    let instance = subject.instance;
    let to_view = &instance.view_from_model;
    let positions =
        [affine(to_view, &model[0]), affine(to_view, &model[1]), affine(to_view, &model[2])];
    let geometric = (positions[1] - positions[0]).cross(positions[2] - positions[0]).normalize();
    let geometric = if instance.mirrored { -geometric } else { geometric };
    let normals = corner_normals(simd, triangles, subject, geometric);
    let (facet_normal, normals) = facing(simd, subject, &positions, origin, geometric, normals);

    // Write the numbers in the order of [`Record`].
    let (e, n, p, m) = (weights, facet_normal, positions, normals);
    let numbers: [[F<S>; 4]; 8] = [
        [e[0][0], e[0][1], e[0][2], e[1][0]],
        [e[1][1], e[1][2], e[2][0], e[2][1]],
        [e[2][2], x0, y0, n.x],
        [n.y, n.z, p[0].x, p[0].y],
        [p[0].z, p[1].x, p[1].y, p[1].z],
        [p[2].x, p[2].y, p[2].z, m[0].x],
        [m[0].y, m[0].z, m[1].x, m[1].y],
        [m[1].z, m[2].x, m[2].y, m[2].z],
    ];
    for (k, four) in numbers.into_iter().enumerate() {
        let columns = [four[0].bitcast(), four[1].bitcast(), four[2].bitcast(), four[3].bitcast()];
        lanes::rows_of_columns(
            simd,
            columns,
            #[inline(always)]
            |lane, row| {
                if let Some(record) = out.get_mut(lane) {
                    record.0[4 * k..4 * k + 4].copy_from_slice(&bytemuck::cast::<_, [f32; 4]>(row));
                }
            },
        );
    }
}

/// Unit normals at the corners: the mesh's, or the facet's where there is none.
#[inline(always)]
fn corner_normals<S: Simd>(
    simd: S,
    triangles: &[u32],
    subject: &Subject<'_>,
    geometric: V3<F<S>>,
) -> [V3<F<S>>; 3] {
    let (mesh, last) = (subject.mesh, triangles.len() - 1);
    let mut normals = [geometric; 3];
    if let Some(attribute) = &mesh.normals {
        let corners = attribute.corners.as_deref().unwrap_or(&mesh.triangles);
        let values: [[F<S>; 3]; 3] = gather(
            simd,
            #[inline(always)]
            |lane, corner| {
                attribute.values[corners[triangles[lane.min(last)] as usize][corner] as usize]
            },
        );
        for c in 0..3 {
            let n = linear(&subject.instance.view_from_model_normal, &values[c]).normalize();
            // A zero normal in the file falls back to the facet's.
            normals[c] = V3::select(lanes::Lanes::lt(constant(simd, 0.0), n.dot(n)), n, geometric);
        }
    }
    normals
}

/// Where both sides are seen, turns normals to the viewer's side of the facet.
#[inline(always)]
fn facing<S: Simd>(
    simd: S,
    subject: &Subject<'_>,
    positions: &[V3<F<S>>; 3],
    origin: Option<V3<F<S>>>,
    geometric: V3<F<S>>,
    mut normals: [V3<F<S>>; 3],
) -> (V3<F<S>>, [V3<F<S>>; 3]) {
    // A ray inside a body sees the back of its surface.
    if origin.is_none() && !subject.turns() {
        return (geometric, normals);
    }
    // Every point of the facet is on the same side of the eye.
    let towards = if let Some(origin) = origin {
        geometric.dot(origin - positions[0])
    } else if subject.viewing.perspective {
        let middle = positions[0] + positions[1] + positions[2];
        geometric.dot(-middle)
    } else {
        geometric.z
    };
    let facet_normal =
        V3::select(lanes::Lanes::lt(towards, constant(simd, 0.0)), -geometric, geometric);
    if subject.mesh.normals_stay {
        return (facet_normal, normals);
    }
    // Each by itself: files have facets of which one corner's normal lies on the wrong side. A
    // normal in the facet's plane, but for rounding, is on neither side: it stays as it is.
    let hair = constant(simd, -1e-4);
    for normal in &mut normals {
        let behind = lanes::Lanes::lt(normal.dot(facet_normal), hair);
        *normal = V3::select(behind, -*normal, *normal);
    }
    (facet_normal, normals)
}
