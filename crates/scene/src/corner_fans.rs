//! The faces round each vertex, and which of them are smooth together.
//!
//! Idea: list the corners of faces at every vertex (a counting sort). At a vertex, each face is averaged with those
//! that the rule allows: faces within the crease angle of *it*, or faces of its smoothing group. Faces that end up
//! with the same sum share one normal.
//!
//! In:   faces with normals and angles, welded vertices.
//! Out:  normals, and for each corner of a face which one it takes.
//! Cost: `O(k²)` at a vertex with `k` faces. From 257 faces on (the tip of a fine cone), faces are first gathered by
//!       direction into cells about 6° wide, and the cells are compared: at most 1536² pairs, whatever the mesh.
//! Source: the crease angle is that of \[VRML97\]; smoothing groups are those of \[OBJ\].

use crate::normals::{DEFAULT_NORMAL, FaceData, face_corner_list, unit};
use crate::weld::Weld;
use crate::{Faces, Mesh};
use vitral_exec::Workers;
use vitral_math::func;

/// Vertices that are worked on together.
const BATCH: usize = 1 << 12;
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

/// Corners by vertex.
struct Fans {
    /// Where each vertex's corners begin in `corners`; one more than there are vertices.
    starts: Vec<u32>,
    /// Corners of faces, vertex by vertex, in the order of the faces.
    corners: Vec<u32>,
    /// For each corner its place in `corners`.
    place: Vec<u32>,
    /// For each corner its face; `None` if faces are triangles, three corners each.
    face: Option<Vec<u32>>,
}

impl Fans {
    fn new(mesh: &Mesh, weld: &Weld) -> Self {
        let list = face_corner_list(mesh);
        let mut starts = vec![0u32; mesh.positions.len() + 1];
        for &v in list {
            starts[weld.representative[v as usize] as usize + 1] += 1;
        }
        for v in 0..mesh.positions.len() {
            starts[v + 1] += starts[v];
        }
        let mut next = starts.clone();
        let (mut corners, mut place) = (vec![0; list.len()], vec![0; list.len()]);
        for (c, &v) in list.iter().enumerate() {
            let at = &mut next[weld.representative[v as usize] as usize];
            (corners[*at as usize], place[c]) = (c as u32, *at);
            *at += 1;
        }
        let face = matches!(mesh.faces, Faces::Polygons { .. })
            .then(|| (0..mesh.face_count()).flat_map(|f| mesh.face_corners(f).iter().map(move |_| f as u32)).collect());
        Self { starts, corners, place, face }
    }

    fn face(&self, corner: u32) -> usize {
        self.face.as_ref().map_or(corner / 3, |face| face[corner as usize]) as usize
    }

    fn at(&self, v: usize) -> &[u32] {
        &self.corners[self.starts[v] as usize..self.starts[v + 1] as usize]
    }
}

/// The normals of a batch of vertices.
#[derive(Default)]
struct Batch {
    values: Vec<[f32; 3]>,
    /// For each place in the batch's part of [`Fans::corners`], an index into `values`.
    slots: Vec<u32>,
    /// Whether some vertex has two normals.
    split: bool,
}

/// Normals; with `None`, one for each vertex, else for each corner of a face an index into them.
pub(crate) fn fan_normals(
    mesh: &Mesh,
    weld: &Weld,
    faces: &FaceData,
    rule: Rule,
    workers: &Workers,
) -> (Vec<[f32; 3]>, Option<Vec<u32>>) {
    let fans = Fans::new(mesh, weld);
    let vertices = mesh.positions.len();
    let batches = workers.map(vertices.div_ceil(BATCH), |b| {
        let mut batch = Batch::default();
        let mut scratch = Scratch::default();
        for v in b * BATCH..vertices.min((b + 1) * BATCH) {
            let before = batch.values.len();
            scratch.vertex(&fans, v, faces, rule, &mut batch);
            batch.split |= batch.values.len() > before + 1;
        }
        batch
    });

    // One normal a vertex: no indices needed.
    if !batches.iter().any(|b| b.split) {
        let normal = |&v: &u32| {
            let (v, batch) = (v as usize, &batches[v as usize / BATCH]);
            let place = fans.starts[v] - fans.starts[v / BATCH * BATCH];
            let some = fans.starts[v] < fans.starts[v + 1];
            if some { batch.values[batch.slots[place as usize] as usize] } else { DEFAULT_NORMAL }
        };
        return (weld.representative.iter().map(normal).collect(), None);
    }

    let mut first = 0;
    let firsts: Vec<u32> = batches
        .iter()
        .map(|b| {
            first += b.values.len() as u32;
            first - b.values.len() as u32
        })
        .collect();
    let list = face_corner_list(mesh);
    let mut of_corner = vec![0; list.len()];
    workers.for_each_chunk(&mut of_corner, 1 << 16, |k, part| {
        for (c, index) in part.iter_mut().enumerate() {
            let c = (k << 16) + c;
            let b = weld.representative[list[c] as usize] as usize / BATCH;
            *index = firsts[b] + batches[b].slots[(fans.place[c] - fans.starts[b * BATCH]) as usize];
        }
    });
    (batches.into_iter().flat_map(|b| b.values).collect(), Some(of_corner))
}

/// Faces that are treated as one: a face, or a cell of directions.
#[derive(Clone, Copy)]
struct Member {
    /// Unit, or zero for a face without area.
    direction: [f32; 3],
    /// Normals times angles.
    sum: [f32; 3],
}

#[derive(Default)]
struct Scratch {
    members: Vec<Member>,
    /// Pairs of a sorting key and a position in the fan.
    keyed: Vec<(u32, u32)>,
    slots: Vec<u32>,
}

impl Scratch {
    /// Appends the normals at one vertex and the slots of its corners to `batch`.
    fn vertex(&mut self, fans: &Fans, v: usize, faces: &FaceData, rule: Rule, batch: &mut Batch) {
        let corners = fans.at(v);
        let member = |&c: &u32| {
            let (n, w) = (faces.normals[fans.face(c)], faces.weights[c as usize]);
            Member { direction: n, sum: n.map(|k| k * w) }
        };
        self.members.clear();
        self.members.extend(corners.iter().map(member));
        match rule {
            Rule::Groups(groups) => {
                let group = corners.iter().map(|&c| groups[fans.face(c)]);
                self.keyed.clear();
                self.keyed.extend(group.zip(0..));
                self.by_group(batch);
            }
            Rule::Angle { whole, half } if corners.len() > MANY => {
                self.keyed.clear();
                self.keyed.extend(self.members.iter().map(|m| cell(m.direction)).zip(0..));
                let cells = self.merge_cells();
                self.by_angle(whole, half, batch);
                // From cells back to faces.
                let cell_slots = std::mem::take(&mut self.slots);
                batch.slots.extend(cells.iter().map(|&c| cell_slots[c as usize]));
            }
            Rule::Angle { whole, half } => {
                self.by_angle(whole, half, batch);
                batch.slots.append(&mut self.slots);
            }
        }
    }

    /// Finds the normal of each member, with those within the angle; `slots` says which value of `batch` it is.
    fn by_angle(&mut self, whole: f32, half: f32, batch: &mut Batch) {
        let all = total(self.members.iter());
        let first = batch.values.len();
        self.slots.clear();

        // Faces within half the angle of their average are within the angle of each other: no pairs to compare.
        let near =
            |mean: &[f32; 3]| self.members.iter().all(|m| m.direction == [0.0; 3] || dot(*mean, m.direction) >= half);
        if let Some(mean) = unit(all).filter(near) {
            batch.values.push(mean);
            self.slots.resize(self.members.len(), first as u32);
            return;
        }
        for m in &self.members {
            let near = self.members.iter().filter(|o| dot(m.direction, o.direction) >= whole);
            let normal = if m.direction == [0.0; 3] { unit(all) } else { unit(total(near)).or(Some(m.direction)) };
            let slot = share(&mut batch.values, first, normal.unwrap_or(DEFAULT_NORMAL));
            self.slots.push(slot);
        }
    }

    /// One normal for each group (`keyed` holds the groups), one for each face without a group.
    fn by_group(&mut self, batch: &mut Batch) {
        self.keyed.sort_unstable();
        let (first_value, first_slot) = (batch.values.len(), batch.slots.len());
        let few = self.keyed.len() <= MANY;
        batch.slots.resize(first_slot + self.keyed.len(), 0);
        for group in self.keyed.chunk_by(|a, b| a.0 == b.0 && a.0 != 0) {
            let members = || group.iter().map(|k| &self.members[k.1 as usize]);
            let direction = members().map(|m| m.direction).find(|d| *d != [0.0; 3]);
            let normal = unit(total(members())).or(direction).unwrap_or(DEFAULT_NORMAL);
            let from = if few { first_value } else { batch.values.len() };
            let slot = share(&mut batch.values, from, normal);
            group.iter().for_each(|k| batch.slots[first_slot + k.1 as usize] = slot);
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
