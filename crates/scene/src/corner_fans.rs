//! The faces round each vertex, and which of them are smooth together.
//!
//! Idea: deal the corners of faces to buckets of vertices. Most vertices take the average of all
//! their faces. Only where a face is far from that average are corners listed by vertex (a counting
//! sort). There, each face is averaged with those that the rule allows: faces within the crease
//! angle of *it*, of its smoothing group where there are groups. Faces that end up with the same
//! sum share one normal.
//!
//! In:   a mesh, welded vertices.
//! Out:  normals, and for each corner of a face which one it takes.
//! Cost: `O(k²)` at a vertex with `k` faces. From 257 faces on (the tip of a fine cone), faces are
//!       first gathered by direction into cells about 6° wide, and the cells are compared: at most
//!       1536² pairs, whatever the mesh.
//! Source: the crease angle is that of \[VRML97\]; smoothing groups are those of \[OBJ\].

mod bucket;
mod fan;
mod rule;

pub(crate) use rule::Rule;

use crate::buckets::shift_and_count;
use crate::directions::{DEFAULT_NORMAL, unit};
use crate::skins::{EdgeFindings, Skins};
use crate::weld::Weld;
use crate::{Faces, Mesh, Solids};
use bucket::{AllFaces, Bucket};
use fan::{CELL_THRESHOLD, Fan};
use std::sync::OnceLock;
use std::sync::atomic::AtomicU32;
use std::sync::atomic::Ordering::Relaxed;
use vitral_exec::{Spare, Workers};

/// Vertices or corners that are worked on together, where each is little work.
const PIECE: usize = 1 << 16;

/// What was made of the fans.
pub(crate) struct FanNormals {
    /// The normals: one for each vertex, or as `of_corner` says.
    pub(crate) values: Vec<[f32; 3]>,
    /// For each corner of a face, which normal it takes, if some vertex has two.
    pub(crate) of_corner: Option<Vec<u32>>,
    /// What was seen on the way, if faces are triangles.
    pub(crate) solids: Option<Solids>,
}

/// What the threads keep between buckets.
#[derive(Default)]
struct Scratch {
    bucket: Bucket,
    fan: Fan,
    apart: Vec<bool>,
    seen: EdgeFindings,
}

/// Gives each vertex the average of the normals of all its faces, and marks in `apart` the vertices
/// that need a closer look. By angle these are vertices where some face is farther from the average
/// than half the angle: only there can two faces differ by more than the whole one. By groups all
/// vertices with faces are marked. Returns whether any is.
fn average(bucket: &Bucket, rule: Rule, normals: &mut [[f32; 3]], apart: &mut Vec<bool>) -> bool {
    let has_faces = |degree: &u32| *degree > 0;
    if rule.groups.is_some() {
        apart.clear();
        apart.extend(bucket.around.degrees.iter().map(has_faces));
        return apart.contains(&true);
    }
    apart.clear();
    apart.resize(normals.len(), false);

    // Average all faces. A vertex without a mean or with too many faces is marked at once.
    bucket.sums(normals);
    for ((normal, apart), &degree) in
        normals.iter_mut().zip(&mut *apart).zip(&bucket.around.degrees)
    {
        let mean = unit(*normal).filter(|_| degree as usize <= CELL_THRESHOLD);
        *apart = degree > 0 && mean.is_none();
        *normal = mean.unwrap_or(DEFAULT_NORMAL);
    }

    // Mark vertices with a face far from the mean.
    bucket.for_each_crease(normals, rule.half, |v| apart[v] = true);
    apart.contains(&true)
}

/// The making of normals, bucket by bucket on all threads.
struct Maker<'a> {
    mesh: &'a Mesh,
    faces: AllFaces<'a>,
    skins: Option<Skins<'a>>,
    rule: Rule<'a>,
    /// For each corner 0 if it takes its vertex's first normal, else one more than the position of
    /// a further one in its bucket. Made when the first vertex with two normals is found.
    further_of_corner: OnceLock<Vec<AtomicU32>>,
}

impl Maker<'_> {
    /// Makes the normals of bucket `b`: the first one of each of its vertices, and further ones.
    fn make_bucket(
        &self,
        b: usize,
        first: &mut [[f32; 3]],
        further: &mut Vec<[f32; 3]>,
        scratch: &mut Scratch,
    ) {
        let Scratch { bucket, fan, apart, seen } = scratch;
        bucket.gather(&self.faces, b, first.len());
        if let Some(skins) = &self.skins {
            skins.look_at(seen, &bucket.around);
        }

        // Average all faces of a vertex; most need no more.
        if !average(bucket, self.rule, first, apart) {
            return;
        }

        // Look closer at the others, corner by corner.
        bucket.sort(apart);
        for (v, first) in first.iter_mut().enumerate().filter(|(v, _)| apart[*v]) {
            let corners = bucket.at(v);
            fan.make(corners, &bucket.around.faces, &bucket.normals, self.rule);
            *first = fan.values[0];
            if fan.values.len() > 1 {
                let of_corner = self.further_of_corner.get_or_init(|| unset_corners(self.mesh));
                for (c, &slot) in corners.iter().zip(&fan.slots).filter(|(_, slot)| **slot > 0) {
                    of_corner[c.index as usize].store(further.len() as u32 + slot, Relaxed);
                }
                further.extend_from_slice(&fan.values[1..]);
            }
        }
    }
}

/// A zero for each corner of a face.
fn unset_corners(mesh: &Mesh) -> Vec<AtomicU32> {
    mesh.corner_list().iter().map(|_| AtomicU32::new(0)).collect()
}

/// Makes the normals of all corners.
pub(crate) fn fan_normals(mesh: &Mesh, weld: &Weld, rule: Rule, workers: &Workers) -> FanNormals {
    let vertices = mesh.positions.len();
    let (shift, count) = shift_and_count(vertices);

    // Each vertex has room for one normal; further ones are kept by bucket.
    let mut first = vec![DEFAULT_NORMAL; vertices];
    let mut further: Vec<Vec<[f32; 3]>> = vec![Vec::new(); count];
    let faces = AllFaces::new(mesh, weld, workers);
    let skins = if matches!(mesh.faces, Faces::Triangles) { Skins::new(mesh, weld) } else { None };
    let maker = Maker { mesh, faces, skins, rule, further_of_corner: OnceLock::new() };
    let spare = Spare::<Scratch>::default();
    let buckets: Vec<_> = first.chunks_mut(1 << shift).zip(&mut further).enumerate().collect();
    workers.for_each(buckets, |(b, (first, further))| {
        spare.lend(|scratch| maker.make_bucket(b, first, further, scratch));
    });

    // Answer for the skins of bodies what was seen on the way.
    let Maker { faces, skins, further_of_corner, .. } = maker;
    drop(faces);
    let spare = spare.into_inner();
    let solids =
        skins.map(|skins| skins.solids(spare.iter().map(|scratch| &scratch.seen), workers));

    // Number the normals of the corners, unless every vertex has one.
    match further_of_corner.into_inner() {
        None => {
            FanNormals { values: spread_to_welded(first, weld, workers), of_corner: None, solids }
        }
        Some(of_corner) => {
            let (values, numbers) = drop_welded(first, weld);
            let of_corner = of_corner.into_iter().map(AtomicU32::into_inner).collect();
            let (values, of_corner) =
                number(mesh, weld, Numbered { values, numbers, further, of_corner }, workers);
            FanNormals { values, of_corner: Some(of_corner), solids }
        }
    }
}

/// Gives vertices that are welded to others the normal of these.
fn spread_to_welded(mut normals: Vec<[f32; 3]>, weld: &Weld, workers: &Workers) -> Vec<[f32; 3]> {
    if weld.distinct == normals.len() {
        return normals;
    }
    let empty = vec![DEFAULT_NORMAL; normals.len()];
    let of_representative = std::mem::replace(&mut normals, empty);
    workers.for_each_chunk(&mut normals, PIECE, |k, part| {
        for (normal, &v) in part.iter_mut().zip(&weld.representative[k * PIECE..]) {
            *normal = of_representative[v as usize];
        }
    });
    normals
}

/// The normals of vertices that are not welded to others, and for each vertex the number of its
/// normal; no numbers if they are those of the vertices.
fn drop_welded(normals: Vec<[f32; 3]>, weld: &Weld) -> (Vec<[f32; 3]>, Vec<u32>) {
    if weld.distinct == normals.len() {
        return (normals, Vec::new());
    }
    let mut numbers = Vec::new();
    let mut next = 0;
    let own = |(v, normal): (u32, [f32; 3])| {
        let is_own = weld.of(v) == v;
        numbers.push(next);
        next += u32::from(is_own);
        is_own.then_some(normal)
    };
    let normals = (0..).zip(normals).filter_map(own).collect();
    (normals, numbers)
}

/// Normals of which some vertices have several.
struct Numbered {
    /// The first normal of each vertex that is not welded to another.
    values: Vec<[f32; 3]>,
    /// Where each vertex's is among them; empty if at the vertex's own number.
    numbers: Vec<u32>,
    /// The further ones, by bucket.
    further: Vec<Vec<[f32; 3]>>,
    /// For each corner 0 for the first, else one more than the position in `further` of its bucket.
    of_corner: Vec<u32>,
}

/// Puts further normals behind the first ones; gives all, and for each corner its number among
/// them.
fn number(
    mesh: &Mesh,
    weld: &Weld,
    normals: Numbered,
    workers: &Workers,
) -> (Vec<[f32; 3]>, Vec<u32>) {
    let Numbered { mut values, numbers, further, mut of_corner } = normals;
    let (shift, _) = shift_and_count(mesh.positions.len());

    // Where the further normals of each bucket begin.
    let starts: Vec<u32> = further
        .iter()
        .map(|further| {
            values.extend_from_slice(further);
            (values.len() - further.len()) as u32
        })
        .collect();

    let list = mesh.corner_list();
    workers.for_each_chunk(&mut of_corner, PIECE, |k, part| {
        for (c, index) in part.iter_mut().enumerate() {
            let v = weld.of(list[k * PIECE + c]);
            let first = numbers.get(v as usize).copied().unwrap_or(v);
            *index = index
                .checked_sub(1)
                .map_or(first, |further| starts[(v >> shift) as usize] + further);
        }
    });
    (values, of_corner)
}
