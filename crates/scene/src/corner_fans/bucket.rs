//! The corners at a bucket of vertices, and what their faces say to them.
//!
//! Idea: triangles are dealt to the buckets that they have corners in, and measured there, into memory that stays in the
//! cache; measured beforehand, all of them would go through main memory twice. Of other faces each corner is dealt, and they
//! are measured beforehand: a large one may lie in many buckets.

use super::is_near;
use crate::buckets::{Buckets, Source};
use crate::normals::{FaceData, face_corner_list, face_data, measure_triangles};
use crate::weld::Weld;
use crate::{Faces, Mesh};
use std::ops::Range;
use vitral_exec::Workers;

/// Faces that are looked up together.
const PIECE: usize = 1 << 14;

/// All faces, dealt by the welded vertices that their corners lie at: triangles once to each bucket, others by their corners.
pub(super) struct AllFaces<'a> {
    mesh: &'a Mesh,
    weld: &'a Weld,
    polygons: Option<Polygons<'a>>,
    shift: u32,
}

/// Faces that are not all triangles.
struct Polygons<'a> {
    corners: &'a [u32],
    data: FaceData,
    /// The face of each corner.
    of_corner: Vec<u32>,
}

impl<'a> AllFaces<'a> {
    /// The faces of `mesh`, for buckets of `1 << shift` vertices.
    pub(super) fn new(mesh: &'a Mesh, weld: &'a Weld, shift: u32, workers: &Workers) -> Self {
        let polygons = matches!(mesh.faces, Faces::Polygons { .. }).then(|| {
            let pieces = workers.map(mesh.face_count().div_ceil(PIECE), |piece| {
                let faces = piece * PIECE..mesh.face_count().min((piece + 1) * PIECE);
                faces.flat_map(|f| mesh.face_corners(f).iter().map(move |_| f as u32)).collect::<Vec<_>>()
            });
            Polygons { corners: face_corner_list(mesh), data: face_data(mesh, workers), of_corner: pieces.concat() }
        });
        Self { mesh, weld, polygons, shift }
    }
}

impl Source<u32> for AllFaces<'_> {
    fn items(&self) -> usize {
        self.polygons.as_ref().map_or(self.mesh.triangles.len(), |polygons| polygons.corners.len())
    }

    fn visit(&self, range: Range<usize>, mut put: impl FnMut(usize, u32)) {
        let bucket = |v: u32| (self.weld.of(v) >> self.shift) as usize;
        if let Some(polygons) = &self.polygons {
            range.for_each(|c| put(bucket(polygons.corners[c]), c as u32));
            return;
        }
        for t in range {
            let [a, b, c] = self.mesh.triangles[t].map(bucket);
            put(a, t as u32);
            if b != a {
                put(b, t as u32);
            }
            if c != a && c != b {
                put(c, t as u32);
            }
        }
    }
}

/// A corner of a face.
#[derive(Clone, Copy, Default)]
pub(super) struct Corner {
    /// Its place in the list of all corners.
    pub(super) index: u32,
    /// Which of the bucket's faces it belongs to.
    pub(super) face: u32,
    /// The face's angle there, radians; zero without area.
    pub(super) angle: f32,
}

/// The corners at a bucket's vertices. These are counted from the first one.
#[derive(Default)]
pub(super) struct Bucket {
    first_vertex: u32,
    /// How many corners there are at each vertex.
    pub(super) degrees: Vec<u32>,
    /// Faces with a corner here, by their number in the mesh, in order.
    pub(super) faces: Vec<u32>,
    /// Their normals, unit; zero without area.
    pub(super) normals: Vec<[f32; 3]>,
    /// If they are triangles, their corners' welded vertices, and the angles there.
    pub(super) welded: Vec<[u32; 3]>,
    angles: Vec<f32>,
    /// If they are not, the corners in order of the list, each with its vertex.
    listed: Vec<(u32, Corner)>,
    /// For each vertex that was asked for, where its corners begin among the sorted ones.
    starts: Vec<u32>,
    sorted: Vec<Corner>,
}

impl Bucket {
    /// Fills it with bucket `b`, which has `size` vertices.
    pub(super) fn gather(&mut self, all: &AllFaces, dealt: &Buckets<u32>, b: usize, size: usize) {
        self.first_vertex = (b << all.shift) as u32;
        self.faces.clear();
        self.listed.clear();
        self.normals.clear();
        match &all.polygons {
            None => {
                dealt.pieces(b).for_each(|piece| self.faces.extend_from_slice(piece));
                let welded = |t: &u32| all.mesh.triangles[*t as usize].map(|v| all.weld.of(v));
                self.welded.clear();
                self.welded.extend(self.faces.iter().map(welded));
                self.normals.resize(self.faces.len(), [0.0; 3]);
                self.angles.resize(3 * self.faces.len(), 0.0);
                measure_triangles(all.mesh, &self.faces, &mut self.normals, &mut self.angles);
            }
            Some(polygons) => {
                for &index in dealt.pieces(b).flatten() {
                    let face = polygons.of_corner[index as usize];
                    if self.faces.last() != Some(&face) {
                        self.faces.push(face);
                        self.normals.push(polygons.data.normals[face as usize]);
                    }
                    let vertex = all.weld.of(polygons.corners[index as usize]) - self.first_vertex;
                    let angle = polygons.data.weights[index as usize];
                    self.listed.push((vertex, Corner { index, face: self.faces.len() as u32 - 1, angle }));
                }
            }
        }
        let mut degrees = std::mem::take(&mut self.degrees);
        degrees.clear();
        degrees.resize(size, 0);
        self.for_each_corner(size, |vertex, _| degrees[vertex] += 1);
        self.degrees = degrees;
    }

    /// Calls `visit(vertex, corner)` for the corners at the bucket's `size` vertices, in order of faces.
    #[inline(always)]
    fn for_each_corner(&self, size: usize, mut visit: impl FnMut(usize, Corner)) {
        // One of the two is empty.
        let triangles = if self.listed.is_empty() { self.faces.as_slice() } else { &[] };
        for (((face, triangle), welded), angles) in
            (0..).zip(triangles).zip(&self.welded).zip(self.angles.as_chunks().0)
        {
            let _: &[f32; 3] = angles;
            for k in 0..3 {
                let vertex = welded[k].wrapping_sub(self.first_vertex) as usize;
                if vertex < size {
                    visit(vertex, Corner { index: 3 * triangle + k as u32, face, angle: angles[k] });
                }
            }
        }
        self.listed.iter().for_each(|&(vertex, corner)| visit(vertex as usize, corner));
    }

    /// The sums of the normals at each vertex, weighted by their angles.
    pub(super) fn sums(&self, sums: &mut [[f32; 3]]) {
        sums.fill([0.0; 3]);
        self.for_each_corner(sums.len(), |vertex, corner| {
            let (sum, n) = (&mut sums[vertex], self.normals[corner.face as usize]);
            (0..3).for_each(|k| sum[k] += n[k] * corner.angle);
        });
    }

    /// Tells the vertices with a face whose normal is farther from the vertex's mean than `half`, a cosine.
    pub(super) fn for_each_crease(&self, means: &[[f32; 3]], half: f32, mut tell: impl FnMut(usize)) {
        self.for_each_corner(means.len(), |vertex, corner| {
            if !is_near(means[vertex], self.normals[corner.face as usize], half) {
                tell(vertex);
            }
        });
    }

    /// Sorts the corners of these vertices by vertex; [`Self::at`] gives them.
    pub(super) fn sort(&mut self, chosen: &[bool]) {
        self.starts.clear();
        self.starts.push(0);
        let mut before = 0;
        self.starts.extend(self.degrees.iter().zip(chosen).map(|(degree, chosen)| {
            before += if *chosen { *degree } else { 0 };
            before
        }));
        self.sorted.resize(before as usize, Corner::default());
        // Each start runs ahead to the next one's, and is put back.
        let (mut starts, mut sorted) = (std::mem::take(&mut self.starts), std::mem::take(&mut self.sorted));
        self.for_each_corner(chosen.len(), |vertex, corner| {
            if chosen[vertex] {
                sorted[starts[vertex] as usize] = corner;
                starts[vertex] += 1;
            }
        });
        (self.starts, self.sorted) = (starts, sorted);
        self.starts.rotate_right(1);
        self.starts[0] = 0;
    }

    /// The corners at a vertex that was sorted.
    pub(super) fn at(&self, vertex: usize) -> &[Corner] {
        &self.sorted[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }
}
