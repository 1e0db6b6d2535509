//! The corners at a bucket of vertices, and what their faces say to them.
//!
//! Idea: triangles are measured in the buckets that they have corners in, into memory that stays in
//! the cache; measured beforehand, all of them would go through main memory twice. Of other faces
//! each corner is dealt, and they are measured beforehand: a large one may lie in many buckets.

use crate::buckets::{Buckets, Source, shift_and_count};
use crate::directions::is_near;
use crate::face_data::{FaceData, face_data, measure_triangles};
use crate::triangle_buckets::{Around, TriangleBuckets};
use crate::weld::Weld;
use crate::{Faces, Mesh};
use std::ops::Range;
use vitral_exec::Workers;

/// Faces that are looked up together.
const PIECE: usize = 1 << 14;

/// All faces, dealt by the welded vertices that their corners lie at.
pub(super) enum AllFaces<'a> {
    Triangles(&'a Mesh, TriangleBuckets<'a>),
    Polygons(Polygons<'a>, Buckets<u32>),
}

/// Faces that are not all triangles.
pub(super) struct Polygons<'a> {
    weld: &'a Weld,
    shift: u32,
    corners: &'a [u32],
    data: FaceData,
    /// The face of each corner.
    of_corner: Vec<u32>,
}

impl<'a> AllFaces<'a> {
    /// The faces of `mesh`.
    pub(super) fn new(mesh: &'a Mesh, weld: &'a Weld, workers: &Workers) -> Self {
        if matches!(mesh.faces, Faces::Triangles) {
            return Self::Triangles(mesh, TriangleBuckets::new(mesh, weld, workers));
        }
        let pieces = workers.map(mesh.face_count().div_ceil(PIECE), |piece| {
            let faces = piece * PIECE..mesh.face_count().min((piece + 1) * PIECE);
            faces
                .flat_map(|f| mesh.face_corners(f).iter().map(move |_| f as u32))
                .collect::<Vec<_>>()
        });
        let (shift, count) = shift_and_count(mesh.positions.len());
        let corners = mesh.corner_list();
        let polygons = Polygons {
            weld,
            shift,
            corners,
            data: face_data(mesh, workers),
            of_corner: pieces.concat(),
        };
        let dealt = Buckets::deal(&polygons, count, workers);
        Self::Polygons(polygons, dealt)
    }
}

impl Source<u32> for Polygons<'_> {
    fn items(&self) -> usize {
        self.corners.len()
    }

    fn visit(&self, range: Range<usize>, mut put: impl FnMut(usize, u32)) {
        range.for_each(|c| put((self.weld.of(self.corners[c]) >> self.shift) as usize, c as u32));
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

/// The corners at a bucket's vertices.
#[derive(Default)]
pub(super) struct Bucket {
    pub(super) around: Around,
    /// The normals of its faces, unit; zero without area.
    pub(super) normals: Vec<[f32; 3]>,
    /// If they are triangles, the angles at their corners.
    angles: Vec<f32>,
    /// If they are not, the corners in order of the list, each with its vertex.
    listed: Vec<(u32, Corner)>,
    /// For each vertex that was asked for, where its corners begin among the sorted ones.
    starts: Vec<u32>,
    sorted: Vec<Corner>,
}

impl Bucket {
    /// Fills it with bucket `b`, which has `size` vertices.
    pub(super) fn gather(&mut self, all: &AllFaces, b: usize, size: usize) {
        match all {
            AllFaces::Triangles(mesh, triangles) => {
                self.around.fill(triangles, b);
                let faces = &self.around.faces;
                self.normals.resize(faces.len(), [0.0; 3]);
                self.angles.resize(3 * faces.len(), 0.0);
                measure_triangles(mesh, faces, &mut self.normals, &mut self.angles);
            }
            AllFaces::Polygons(polygons, dealt) => self.gather_polygons(polygons, dealt, b, size),
        }
    }

    fn gather_polygons(&mut self, all: &Polygons, dealt: &Buckets<u32>, b: usize, size: usize) {
        let Around { first_vertex, degrees, faces, .. } = &mut self.around;
        *first_vertex = (b << all.shift) as u32;
        degrees.clear();
        degrees.resize(size, 0);
        faces.clear();
        self.normals.clear();
        self.listed.clear();
        for &index in dealt.pieces(b).flatten() {
            let face = all.of_corner[index as usize];
            if faces.last() != Some(&face) {
                faces.push(face);
                self.normals.push(all.data.normals[face as usize]);
            }
            let vertex = all.weld.of(all.corners[index as usize]) - *first_vertex;
            degrees[vertex as usize] += 1;
            let angle = all.data.weights[index as usize];
            self.listed.push((vertex, Corner { index, face: faces.len() as u32 - 1, angle }));
        }
    }

    /// Calls `visit(vertex, corner)` for the corners at the bucket's vertices, in order of faces.
    #[inline(always)]
    fn for_each_corner(&self, mut visit: impl FnMut(usize, Corner)) {
        let Around { first_vertex, degrees, faces, welded } = &self.around;
        // One of the two is empty.
        let triangles = faces.iter().zip(welded).zip(self.angles.as_chunks::<3>().0);
        for (face, ((triangle, welded), angles)) in (0..).zip(triangles) {
            for k in 0..3 {
                let vertex = welded[k].wrapping_sub(*first_vertex) as usize;
                if vertex < degrees.len() {
                    visit(
                        vertex,
                        Corner { index: 3 * triangle + k as u32, face, angle: angles[k] },
                    );
                }
            }
        }
        self.listed.iter().for_each(|&(vertex, corner)| visit(vertex as usize, corner));
    }

    /// The sums of the normals at each vertex, weighted by their angles.
    pub(super) fn sums(&self, sums: &mut [[f32; 3]]) {
        sums.fill([0.0; 3]);
        self.for_each_corner(|vertex, corner| {
            let (sum, n) = (&mut sums[vertex], self.normals[corner.face as usize]);
            (0..3).for_each(|k| sum[k] += n[k] * corner.angle);
        });
    }

    /// Tells the vertices with a face whose normal is farther from the vertex's mean than `half`, a
    /// cosine.
    pub(super) fn for_each_crease(
        &self,
        means: &[[f32; 3]],
        half: f32,
        mut tell: impl FnMut(usize),
    ) {
        self.for_each_corner(|vertex, corner| {
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
        self.starts.extend(self.around.degrees.iter().zip(chosen).map(|(degree, chosen)| {
            before += if *chosen { *degree } else { 0 };
            before
        }));
        self.sorted.resize(before as usize, Corner::default());
        // Each start runs ahead to the next one's, and is put back.
        let (mut starts, mut sorted) =
            (std::mem::take(&mut self.starts), std::mem::take(&mut self.sorted));
        self.for_each_corner(|vertex, corner| {
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
