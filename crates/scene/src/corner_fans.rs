//! The faces round each vertex, and which of them are smooth together.
//!
//! Idea: list the corners of faces at every vertex (dealt into buckets of vertices, then a counting sort). At a vertex, each
//! face is averaged with those that the rule allows: faces within the crease angle of *it*, or faces of its smoothing
//! group. Faces that end up with the same sum share one normal.
//!
//! In:   faces with normals and angles, welded vertices.
//! Out:  normals, and for each corner of a face which one it takes.
//! Cost: `O(k²)` at a vertex with `k` faces. From 257 faces on (the tip of a fine cone), faces are first gathered by
//!       direction into cells about 6° wide, and the cells are compared: at most 1536² pairs, whatever the mesh.
//! Source: the crease angle is that of \[VRML97\]; smoothing groups are those of \[OBJ\].

use crate::buckets::{Buckets, Source, shift_and_count};
use crate::normals::{DEFAULT_NORMAL, FaceData, face_corner_list, unit};
use crate::solidity::{Seen, Skins};
use crate::weld::Weld;
use crate::{Faces, Mesh, Solidity};
use std::ops::Range;
use std::sync::OnceLock;
use std::sync::atomic::AtomicU32;
use std::sync::atomic::Ordering::Relaxed;
use vitral_exec::Workers;
use vitral_math::func;

/// Vertices or corners that are worked on together, where each is little work.
const PIECE: usize = 1 << 16;
/// With more faces at one vertex, they are gathered into cells.
const MANY: usize = 256;

/// Which faces at a vertex are averaged.
#[derive(Clone, Copy)]
pub(crate) enum Rule<'a> {
    /// Those whose normals are within an angle of each other.
    Angle {
        /// Cosine of the angle.
        whole: f32,
        /// Cosine of half of it.
        half: f32,
    },
    /// Those with the same number, if it is not 0; one number a face.
    Groups(&'a [u32]),
}

impl Rule<'_> {
    /// Within `angle` radians.
    pub(crate) fn within(angle: f64) -> Self {
        // A hair of slack, so that a right angle is not above π/2; it must be less for half the angle.
        let angle = angle.max(0.0);
        Self::Angle { whole: (func::cos(angle) - 1e-6) as f32, half: func::cos(0.5 * angle) as f32 }
    }
}

/// Corners of faces, dealt by the welded vertex that they lie at.
struct Corners<'a> {
    list: &'a [u32],
    weld: &'a Weld,
    shift: u32,
}

impl Corners<'_> {
    fn vertex(&self, corner: u32) -> u32 {
        self.weld.representative[self.list[corner as usize] as usize]
    }
}

impl Source<u32> for Corners<'_> {
    fn items(&self) -> usize {
        self.list.len()
    }

    fn visit(&self, range: Range<usize>, mut put: impl FnMut(usize, u32)) {
        for c in range {
            put((self.vertex(c as u32) >> self.shift) as usize, c as u32);
        }
    }
}

/// What was made of the fans.
pub(crate) struct FanNormals {
    /// The normals: one for each vertex, or as `of_corner` says.
    pub(crate) values: Vec<[f32; 3]>,
    /// For each corner of a face, which normal it takes, if some vertex has two.
    pub(crate) of_corner: Option<Vec<u32>>,
    /// What was seen on the way, if faces are triangles.
    pub(crate) solidity: Option<Solidity>,
}

/// The normals at a bucket's vertices.
struct Batch {
    seen: Seen,
    values: Vec<[f32; 3]>,
    /// Where each vertex's values begin; one more than there are vertices.
    first: Vec<u32>,
}

/// Makes the normals of all corners.
pub(crate) fn fan_normals(mesh: &Mesh, weld: &Weld, faces: &FaceData, rule: Rule, workers: &Workers) -> FanNormals {
    let (list, vertices) = (face_corner_list(mesh), mesh.positions.len());
    let (shift, count) = shift_and_count(vertices);
    let source = Corners { list, weld, shift };
    let face_of_corner: Option<Vec<u32>> = matches!(mesh.faces, Faces::Polygons { .. })
        .then(|| (0..mesh.face_count()).flat_map(|f| mesh.face_corners(f).iter().map(move |_| f as u32)).collect());
    let skins = if face_of_corner.is_none() { Skins::new(mesh, weld) } else { None };
    let dealt = Buckets::deal(&source, count, workers);
    // For each corner, which of its vertex's values it takes; made when the first vertex with two is found.
    let which: OnceLock<Vec<AtomicU32>> = OnceLock::new();
    let batches = workers.map(count, |b| {
        let (starts, corners) = by_vertex(&dealt, b, &source);
        let mut scratch = Scratch::new(faces, face_of_corner.as_deref());
        let (values, first) = (Vec::with_capacity(starts.len()), Vec::with_capacity(starts.len()));
        let mut batch = Batch { seen: Seen::default(), values, first };
        for (v, ends) in ((b << shift) as u32..).zip(starts.windows(2)) {
            let first = batch.values.len();
            batch.first.push(first as u32);
            let corners = &corners[ends[0] as usize..ends[1] as usize];
            scratch.vertex(corners, rule, &mut batch.values);
            if let Some(skins) = &skins {
                skins.vertex(&mut batch.seen, v, corners);
            }
            if batch.values.len() > first + 1 {
                let which = which.get_or_init(|| list.iter().map(|_| AtomicU32::new(0)).collect());
                for (&c, slot) in corners.iter().zip(&scratch.slots) {
                    which[c as usize].store(slot - first as u32, Relaxed);
                }
            }
        }
        batch.first.push(batch.values.len() as u32);
        batch
    });
    drop(dealt);
    let solidity = skins.map(|skins| skins.solidity(batches.iter().map(|b| &b.seen), workers));
    let place = |v: u32| (&batches[(v >> shift) as usize], (v & ((1 << shift) - 1)) as usize);

    // One normal a vertex: no indices needed.
    let Some(which) = which.into_inner() else {
        let mut normals = vec![DEFAULT_NORMAL; vertices];
        workers.for_each_chunk(&mut normals, PIECE, |k, part| {
            for (normal, &v) in part.iter_mut().zip(&weld.representative[k * PIECE..]) {
                let (batch, at) = place(v);
                if batch.first[at] < batch.first[at + 1] {
                    *normal = batch.values[batch.first[at] as usize];
                }
            }
        });
        return FanNormals { values: normals, of_corner: None, solidity };
    };

    let mut before = 0;
    let before: Vec<u32> = batches
        .iter()
        .map(|b| {
            before += b.values.len() as u32;
            before - b.values.len() as u32
        })
        .collect();
    let mut of_corner: Vec<u32> = which.into_iter().map(AtomicU32::into_inner).collect();
    workers.for_each_chunk(&mut of_corner, PIECE, |k, part| {
        for (c, index) in part.iter_mut().enumerate() {
            let v = source.vertex((k * PIECE + c) as u32);
            let (batch, at) = place(v);
            *index += before[(v >> shift) as usize] + batch.first[at];
        }
    });
    let values = batches.into_iter().flat_map(|b| b.values).collect();
    FanNormals { values, of_corner: Some(of_corner), solidity }
}

/// The corners of bucket `b` in order of their vertex, and where each vertex begins.
fn by_vertex(dealt: &Buckets<u32>, b: usize, source: &Corners) -> (Vec<u32>, Vec<u32>) {
    let base = b << source.shift;
    let size = (1 << source.shift).min(source.weld.representative.len() - base);
    let vertices: Vec<u32> = dealt.pieces(b).flatten().map(|&c| source.vertex(c) - base as u32).collect();
    let mut starts = vec![0u32; size + 1];
    for &v in &vertices {
        starts[v as usize + 1] += 1;
    }
    for v in 0..size {
        starts[v + 1] += starts[v];
    }
    let mut next = starts.clone();
    let mut corners = vec![0; vertices.len()];
    for (&c, &v) in dealt.pieces(b).flatten().zip(&vertices) {
        let at = &mut next[v as usize];
        corners[*at as usize] = c;
        *at += 1;
    }
    (starts, corners)
}

/// Faces that are treated as one: a face, or a cell of directions.
#[derive(Clone, Copy)]
struct Member {
    /// Unit, or zero for a face without area.
    direction: [f32; 3],
    /// Normals times angles.
    sum: [f32; 3],
}

struct Scratch<'a> {
    faces: &'a FaceData,
    /// For each corner its face; `None` if faces are triangles, three corners each.
    face_of_corner: Option<&'a [u32]>,
    members: Vec<Member>,
    /// Pairs of a sorting key and a position in the fan.
    keyed: Vec<(u32, u32)>,
    /// For each corner, which value it takes.
    slots: Vec<u32>,
}

impl<'a> Scratch<'a> {
    fn new(faces: &'a FaceData, face_of_corner: Option<&'a [u32]>) -> Self {
        Self { faces, face_of_corner, members: Vec::new(), keyed: Vec::new(), slots: Vec::new() }
    }

    /// Appends the normals at a vertex with these corners to `values`; `slots` says which each corner takes.
    fn vertex(&mut self, corners: &[u32], rule: Rule, values: &mut Vec<[f32; 3]>) {
        let (faces, face_of_corner) = (self.faces, self.face_of_corner);
        let face = |c: u32| face_of_corner.map_or(c / 3, |face| face[c as usize]) as usize;
        let member = |&c: &u32| {
            let (n, w) = (faces.normals[face(c)], faces.weights[c as usize]);
            Member { direction: n, sum: n.map(|k| k * w) }
        };
        self.members.clear();
        self.members.extend(corners.iter().map(member));
        match rule {
            Rule::Groups(groups) => {
                let group = corners.iter().map(|&c| groups[face(c)]);
                self.keyed.clear();
                self.keyed.extend(group.zip(0..));
                self.by_group(values);
            }
            Rule::Angle { whole, half } if corners.len() > MANY => {
                self.keyed.clear();
                self.keyed.extend(self.members.iter().map(|m| cell(m.direction)).zip(0..));
                let cells = self.merge_cells();
                self.by_angle(whole, half, values);
                // From cells back to faces.
                let of_cell = std::mem::take(&mut self.slots);
                self.slots.extend(cells.iter().map(|&c| of_cell[c as usize]));
            }
            Rule::Angle { whole, half } => self.by_angle(whole, half, values),
        }
    }

    /// Finds the normal of each member, with those within the angle.
    fn by_angle(&mut self, whole: f32, half: f32, values: &mut Vec<[f32; 3]>) {
        self.slots.clear();
        if self.members.is_empty() {
            return;
        }
        let all = total(self.members.iter());
        let first = values.len();

        // Faces within half the angle of their average are within the angle of each other: no pairs to compare.
        let near =
            |mean: &[f32; 3]| self.members.iter().all(|m| m.direction == [0.0; 3] || dot(*mean, m.direction) >= half);
        if let Some(mean) = unit(all).filter(near) {
            values.push(mean);
            self.slots.resize(self.members.len(), first as u32);
            return;
        }
        for m in &self.members {
            let near = self.members.iter().filter(|o| dot(m.direction, o.direction) >= whole);
            let normal = if m.direction == [0.0; 3] { unit(all) } else { unit(total(near)).or(Some(m.direction)) };
            let slot = share(values, first, normal.unwrap_or(DEFAULT_NORMAL));
            self.slots.push(slot);
        }
    }

    /// One normal for each group (`keyed` holds the groups), one for each face without a group.
    fn by_group(&mut self, values: &mut Vec<[f32; 3]>) {
        self.keyed.sort_unstable();
        let first_value = values.len();
        let few = self.keyed.len() <= MANY;
        self.slots.clear();
        self.slots.resize(self.keyed.len(), 0);
        for group in self.keyed.chunk_by(|a, b| a.0 == b.0 && a.0 != 0) {
            let members = || group.iter().map(|k| &self.members[k.1 as usize]);
            let direction = members().map(|m| m.direction).find(|d| *d != [0.0; 3]);
            let normal = unit(total(members())).or(direction).unwrap_or(DEFAULT_NORMAL);
            let from = if few { first_value } else { values.len() };
            let slot = share(values, from, normal);
            group.iter().for_each(|k| self.slots[k.1 as usize] = slot);
        }
    }

    /// Replaces the members by one for each cell in use; gives each former member's cell.
    fn merge_cells(&mut self) -> Vec<u32> {
        self.keyed.sort_unstable();
        let mut cell_of = vec![0; self.keyed.len()];
        let mut cells = Vec::new();
        for cell in self.keyed.chunk_by(|a, b| a.0 == b.0) {
            let sum = total(cell.iter().map(|k| &self.members[k.1 as usize]));
            cell.iter().for_each(|k| cell_of[k.1 as usize] = cells.len() as u32);
            let direction = unit(sum).unwrap_or(self.members[cell[0].1 as usize].direction);
            cells.push(Member { direction, sum });
        }
        self.members = cells;
        cell_of
    }
}

/// The index of `normal` among `values[first..]`, appended if it is new.
fn share(values: &mut Vec<[f32; 3]>, first: usize, normal: [f32; 3]) -> u32 {
    let known = values[first..].iter().position(|v| *v == normal);
    known.map_or_else(
        || {
            values.push(normal);
            values.len() - 1
        },
        |k| first + k,
    ) as u32
}

fn total<'a>(members: impl Iterator<Item = &'a Member>) -> [f32; 3] {
    members.fold([0.0; 3], |s, m| [s[0] + m.sum[0], s[1] + m.sum[1], s[2] + m.sum[2]])
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A cell of a 16x16 grid on each side of the cube round the unit sphere; the zero vector has a cell of its own.
fn cell(d: [f32; 3]) -> u32 {
    let axis = (0..3).fold(0, |best, k| if d[k].abs() > d[best].abs() { k } else { best });
    if d[axis] == 0.0 {
        return u32::MAX;
    }
    let grid = |k: usize| ((d[(axis + k) % 3] / d[axis].abs() + 1.0) * 8.0).clamp(0.0, 15.0) as u32;
    let side = 2 * axis as u32 + u32::from(d[axis] < 0.0);
    side << 8 | grid(1) << 4 | grid(2)
}
