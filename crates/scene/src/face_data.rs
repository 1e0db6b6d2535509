//! What faces say to their vertices: their normals, and their angles there.
//!
//! Idea: a polygon's normal is the sum of the cross products of the fan from its first corner.
//! Triangles are taken eight at a time, whichever faces they are; so are the arc tangents of the
//! angles of other polygons.
//!
//! In:   a mesh, model space.
//! Out:  unit normals and angles in radians; zero for faces without area.
//! Cost: `O(corners)`.
//! Source: Newell's normal after [Sutherland, Sproull & Schumacker 1974]; arc tangent: [Abramowitz
//!         & Stegun 1964], 4.4.49.

use crate::Mesh;
use std::f64::consts::{FRAC_PI_2, PI};
use vitral_exec::Workers;
use vitral_math::DVec3;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F64x8, LANES, Level, Simd, dispatch};

/// Faces or corners that are worked on together.
pub(crate) const BATCH: usize = 1 << 14;
/// Normals before they are made unit must be longer than this times the largest squared distance
/// between corners.
const MOST_SLENDER: f64 = 1e-7;

/// What the faces say to their vertices.
pub(crate) struct FaceData {
    /// Unit normal of each face; zero without area.
    pub(crate) normals: Vec<[f32; 3]>,
    /// Angle of the face at each of its corners, radians; zero without area.
    pub(crate) weights: Vec<f32>,
}

/// Normals and angles of all faces.
pub(crate) fn face_data(mesh: &Mesh, workers: &Workers) -> FaceData {
    let faces = mesh.face_count();
    let mut normals = vec![[0.0; 3]; faces];
    let mut weights = vec![0.0; mesh.corner_list().len()];

    // Cut both arrays at the same faces, so that each batch writes to its own piece of both.
    let mut batches = Vec::new();
    let mut rest = weights.as_mut_slice();
    for (batch, normals) in normals.chunks_mut(BATCH).enumerate() {
        let first = batch * BATCH;
        let corners = mesh.first_corner(first + normals.len()) - mesh.first_corner(first);
        let (weights, after) = rest.split_at_mut(corners);
        rest = after;
        batches.push((first, normals, weights));
    }
    let level = Level::new();
    workers.for_each(batches, |(first, normals, weights)| {
        dispatch!(level, simd => measure_faces(simd, mesh, first, normals, weights));
    });
    FaceData { normals, weights }
}

/// The normals of the triangles in `list`, and their angles, three each.
pub(crate) fn measure_triangles(
    mesh: &Mesh,
    list: &[u32],
    normals: &mut [[f32; 3]],
    angles: &mut [f32],
) {
    dispatch!(Level::new(), simd => measure_listed(simd, mesh, list, normals, angles));
}

#[inline(always)]
fn measure_listed<S: Simd>(
    simd: S,
    mesh: &Mesh,
    list: &[u32],
    normals: &mut [[f32; 3]],
    angles: &mut [f32],
) {
    let mut triangles = Triangles::default();
    for (k, &triangle) in list.iter().enumerate() {
        triangles.push(k, 3 * k, mesh.triangles[triangle as usize]);
        if triangles.count == LANES {
            triangles.measure(simd, mesh, normals, angles);
        }
    }
    triangles.measure(simd, mesh, normals, angles);
}

/// The normals of the faces from `first` on, and their angles.
#[inline(always)]
fn measure_faces<S: Simd>(
    simd: S,
    mesh: &Mesh,
    first: usize,
    normals: &mut [[f32; 3]],
    weights: &mut [f32],
) {
    let (mut triangles, mut angles) = (Triangles::default(), Angles::default());
    let mut at = 0;
    for face in 0..normals.len() {
        let outline = mesh.face_corners(first + face);
        if let &[a, b, c] = outline {
            triangles.push(face, at, [a, b, c]);
            if triangles.count == LANES {
                triangles.measure(simd, mesh, normals, weights);
            }
        } else {
            let normal = outline_normal(mesh, outline);
            normals[face] = normal.as_vec3().to_array();
            if normal != DVec3::ZERO {
                for k in 0..outline.len() {
                    angles.push(at + k, corner_angle(mesh, outline, k, normal));
                    if angles.count == LANES {
                        angles.measure(simd, weights);
                    }
                }
            }
        }
        at += outline.len();
    }
    triangles.measure(simd, mesh, normals, weights);
    angles.measure(simd, weights);
}

/// Triangles that wait until there are eight.
#[derive(Default)]
struct Triangles {
    count: usize,
    /// For each, its face, the place of its first angle, and its corners.
    face: [usize; LANES],
    at: [usize; LANES],
    corners: [[u32; 3]; LANES],
}

impl Triangles {
    #[inline(always)]
    fn push(&mut self, face: usize, at: usize, corners: [u32; 3]) {
        (self.face[self.count], self.at[self.count], self.corners[self.count]) =
            (face, at, corners);
        self.count += 1;
    }

    /// Writes the normals and angles of those that wait; all three angles share one cross product.
    #[inline(always)]
    fn measure<S: Simd>(
        &mut self,
        simd: S,
        mesh: &Mesh,
        normals: &mut [[f32; 3]],
        weights: &mut [f32],
    ) {
        if self.count == 0 {
            return;
        }
        // Places that are not taken repeat something.
        let corner = lanes::inlined(
            #[inline(always)]
            |k: usize| {
                lanes::wide_points(
                    simd,
                    #[inline(always)]
                    |lane| mesh.positions[self.corners[lane][k] as usize],
                )
            },
        );

        // Compute the cross product of two sides.
        let [a, b, c] = [corner(0), corner(1), corner(2)];
        let (ab, ac) =
            ([b[0] - a[0], b[1] - a[1], b[2] - a[2]], [c[0] - a[0], c[1] - a[1], c[2] - a[2]]);
        let cross = [
            ab[1] * ac[2] - ac[1] * ab[2],
            ab[2] * ac[0] - ac[2] * ab[0],
            ab[0] * ac[1] - ac[0] * ab[1],
        ];
        let length = dot(cross, cross).sqrt();
        let longest = dot(ab, ab).max(dot(ac, ac));

        // Compute the angles at the corners; the last one is what is left of half a turn.
        let bc = [ab[0] - ac[0], ab[1] - ac[1], ab[2] - ac[2]];
        let at_a = angle_from(simd, length, dot(ab, ac));
        let at_b = angle_from(simd, length, dot(ab, bc));
        let at_c = (F64x8::splat(simd, PI) - at_a - at_b).max(F64x8::splat(simd, 0.0));
        let zero = F64x8::splat(simd, 0.0);
        // As `has_area` says.
        let sound = length.simd_lt(F64x8::splat(simd, f64::INFINITY))
            & length.simd_gt(longest * MOST_SLENDER);
        let out = lanes::inlined(
            #[inline(always)]
            |value: F64x8<S>| lanes::narrowed(simd, sound.select(value, zero)).bitcast(),
        );

        // Store unit normals, and the angles as weights.
        let normal =
            [out(cross[0] / length), out(cross[1] / length), out(cross[2] / length), out(zero)];
        let three = lanes::inlined(
            #[inline(always)]
            |row: [i32; 4]| {
                let [a, b, c, _]: [f32; 4] = bytemuck::cast(row);
                [a, b, c]
            },
        );
        lanes::rows_of_columns(
            simd,
            normal,
            #[inline(always)]
            |lane, normal| {
                if lane < self.count {
                    normals[self.face[lane]] = three(normal);
                }
            },
        );
        lanes::rows_of_columns(
            simd,
            [out(at_a), out(at_b), out(at_c), out(zero)],
            #[inline(always)]
            |lane, angles| {
                if lane < self.count {
                    weights[self.at[lane]..self.at[lane] + 3].copy_from_slice(&three(angles));
                }
            },
        );
        self.count = 0;
    }
}

/// An angle between 0 and 2π by what is proportional to its sine and cosine.
struct Angle {
    /// Not negative.
    sine: f64,
    cosine: f64,
    /// More than π.
    reflex: bool,
}

/// The interior angle at corner `k` of an outline with this normal.
fn corner_angle(mesh: &Mesh, outline: &[u32], k: usize, normal: DVec3) -> Angle {
    let n = outline.len();
    let at = mesh.position(outline[k]);
    let forth = mesh.position(outline[if k + 1 == n { 0 } else { k + 1 }]) - at;
    let back = mesh.position(outline[if k == 0 { n - 1 } else { k - 1 }]) - at;
    let cross = forth.cross(back);
    Angle { sine: cross.length(), cosine: forth.dot(back), reflex: cross.dot(normal) < 0.0 }
}

/// Angles that wait until there are eight.
#[derive(Default)]
struct Angles {
    count: usize,
    at: [usize; LANES],
    sine: [f64; LANES],
    cosine: [f64; LANES],
    reflex: [bool; LANES],
}

impl Angles {
    #[inline(always)]
    fn push(&mut self, at: usize, angle: Angle) {
        let k = self.count;
        (self.at[k], self.sine[k], self.cosine[k], self.reflex[k]) =
            (at, angle.sine, angle.cosine, angle.reflex);
        self.count += 1;
    }

    /// Writes those that wait.
    #[inline(always)]
    fn measure<S: Simd>(&mut self, simd: S, weights: &mut [f32]) {
        let load = |values: &[f64; LANES]| F64x8::from_slice(simd, values);
        let mut out = [0.0; LANES];
        angle_from(simd, load(&self.sine), load(&self.cosine)).store_slice(&mut out);
        for lane in 0..self.count {
            let angle = if self.reflex[lane] { 2.0 * PI - out[lane] } else { out[lane] };
            weights[self.at[lane]] = angle as f32;
        }
        self.count = 0;
    }
}

/// Newell's normal as a fan of cross products from the first corner, unit; zero without area or
/// with bad coordinates.
pub(crate) fn outline_normal(mesh: &Mesh, outline: &[u32]) -> DVec3 {
    let origin = mesh.position(outline[0]);
    let (mut sum, mut longest) = (DVec3::ZERO, 0.0f64);
    let mut previous = mesh.position(outline[1]) - origin;
    for &corner in &outline[2..] {
        let next = mesh.position(corner) - origin;
        sum += previous.cross(next);
        longest = longest.max(previous.length_squared()).max(next.length_squared());
        previous = next;
    }
    let length = sum.length();
    if has_area(length, longest) { sum / length } else { DVec3::ZERO }
}

/// Whether a normal of this length, before it is made unit, means anything, for the largest squared
/// distance between corners. A sliver only as wide as the rounding of its coordinates has no
/// direction worth averaging.
fn has_area(length: f64, longest_squared: f64) -> bool {
    length.is_finite() && length > MOST_SLENDER * longest_squared
}

#[inline(always)]
fn dot<S: Simd>(a: [F64x8<S>; 3], b: [F64x8<S>; 3]) -> F64x8<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The angles in `0..=π` whose sine and cosine are proportional to `y >= 0` and `x`; 0 for the zero
/// vector. Absolute error below 2e-8.
#[inline(always)]
fn angle_from<S: Simd>(simd: S, y: F64x8<S>, x: F64x8<S>) -> F64x8<S> {
    let zero = F64x8::splat(simd, 0.0);
    let (low, high) = (y.min(x.abs()), y.max(x.abs()));
    let t = high.simd_eq(zero).select(zero, low / high);
    let t2 = t * t;
    let mut p = F64x8::splat(simd, 0.002_866_225_7);
    for c in [
        -0.016_165_736_7,
        0.042_909_613_8,
        -0.075_289_640_0,
        0.106_562_639_3,
        -0.142_088_994_4,
        0.199_935_508_5,
        -0.333_331_452_8,
        1.0,
    ] {
        p = p * t2 + c;
    }
    let first_octant = p * t;
    let quadrant =
        y.simd_gt(x.abs()).select(F64x8::splat(simd, FRAC_PI_2) - first_octant, first_octant);
    x.simd_lt(zero).select(F64x8::splat(simd, PI) - quadrant, quadrant)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Faces;

    fn angles(y: &[f64], x: &[f64]) -> Vec<f64> {
        let mut out = Vec::new();
        for (y, x) in y.chunks(LANES).zip(x.chunks(LANES)) {
            let (mut sine, mut cosine, mut angle) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
            sine[..y.len()].copy_from_slice(y);
            cosine[..x.len()].copy_from_slice(x);
            dispatch!(Level::new(), simd => {
                let (y, x) = (F64x8::from_slice(simd, &sine), F64x8::from_slice(simd, &cosine));
                angle_from(simd, y, x).store_slice(&mut angle);
            });
            out.extend_from_slice(&angle[..y.len()]);
        }
        out
    }

    #[test]
    fn angles_are_right_in_every_octant() {
        let angle = |k: i32| PI * f64::from(k) / 1000.0;
        let (sines, cosines): (Vec<_>, Vec<_>) = (0..=1000)
            .map(|k| {
                (
                    vitral_math::func::sin(angle(k)).max(0.0) * 3.0,
                    vitral_math::func::cos(angle(k)) * 3.0,
                )
            })
            .unzip();
        for (k, found) in (0..).zip(angles(&sines, &cosines)) {
            assert!((found - angle(k)).abs() < 3e-8, "{}", angle(k));
        }
        assert_eq!(angles(&[0.0], &[0.0]), [0.0]);
    }

    /// Faces of three, four and five corners, one of them without area, in odd numbers: each gets
    /// its own.
    #[test]
    fn every_face_gets_its_own_normal_and_angles() {
        let mut positions = Vec::new();
        let (mut starts, mut corners, mut triangles) = (vec![0], Vec::new(), Vec::new());
        for face in 0..53u32 {
            let n = 3 + face % 3;
            let first = positions.len() as u32;
            for k in 0..n {
                // A regular polygon in a plane z = face, turned over for every fourth; of no size
                // for one.
                let turn = std::f64::consts::TAU * f64::from(k) / f64::from(n)
                    * if face % 4 == 0 { -1.0 } else { 1.0 };
                let size = if face == 21 { 0.0 } else { 1.0 + f64::from(face) };
                let (x, y) =
                    (size * vitral_math::func::cos(turn), size * vitral_math::func::sin(turn));
                positions.push([x as f32, y as f32, face as f32]);
            }
            corners.extend(first..first + n);
            starts.push(corners.len() as u32);
            triangles.extend((1..n - 1).map(|k| [first, first + k, first + k + 1]));
        }
        let mesh = Mesh {
            positions,
            triangles,
            faces: Faces::Polygons { starts, corners },
            ..Mesh::default()
        };
        let data = face_data(&mesh, &Workers::single());
        for face in 0..53 {
            let n = 3 + face % 3;
            let z = if face % 4 == 0 { -1.0 } else { 1.0 };
            let expected = if face == 21 { [0.0; 3] } else { [0.0, 0.0, z] };
            let normal = data.normals[face];
            assert!(
                (0..3).all(|k| (normal[k] - expected[k]).abs() < 1e-6),
                "face {face}: {normal:?}"
            );
            let angle = if face == 21 { 0.0 } else { PI * (1.0 - 2.0 / n as f64) };
            for weight in &data.weights[mesh.first_corner(face)..mesh.first_corner(face + 1)] {
                assert!((f64::from(*weight) - angle).abs() < 1e-6, "face {face}: {weight}");
            }
        }
    }
}
