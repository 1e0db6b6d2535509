//! The faces round each vertex, and which of them are smooth together.
//!
//! Idea: deal the corners of faces to buckets of vertices. Most vertices take the average of all their faces; only where one is
//! far from it are corners listed by vertex (a counting sort) and looked at. There, each face is averaged with those that the rule allows: faces within the crease angle of *it*, or faces of its smoothing
//! group. Faces that end up with the same sum share one normal.
//!
//! In:   a mesh, welded vertices.
//! Out:  normals, and for each corner of a face which one it takes.
//! Cost: `O(k²)` at a vertex with `k` faces. From 257 faces on (the tip of a fine cone), faces are first gathered by
//!       direction into cells about 6° wide, and the cells are compared: at most 1536² pairs, whatever the mesh.
//! Source: the crease angle is that of \[VRML97\]; smoothing groups are those of \[OBJ\].

mod bucket;
mod fan;

use crate::buckets::shift_and_count;
use crate::normals::{DEFAULT_NORMAL, face_corner_list, unit};
use crate::solidity::{Seen, Skins};
use crate::weld::Weld;
use crate::{Faces, Mesh, Solids};
use bucket::{AllFaces, Bucket};
use fan::Fan;
use std::sync::OnceLock;
use std::sync::atomic::AtomicU32;
use std::sync::atomic::Ordering::Relaxed;
use vitral_exec::{Spare, Workers};
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
    seen: Seen,
}

/// Gives each vertex the average of all its faces, and tells in `apart` those that need a closer look: where some face is farther
/// from the average than half the angle, so that not all are within the angle of each other. Whether there are any. By groups, all
/// vertices with faces need it.
fn average(bucket: &Bucket, rule: Rule, normals: &mut [[f32; 3]], apart: &mut Vec<bool>) -> bool {
    let has_faces = |degree: &u32| *degree > 0;
    let Rule::Angle { half, .. } = rule else {
        apart.clear();
        apart.extend(bucket.around.degrees.iter().map(has_faces));
        return apart.contains(&true);
    };
    apart.clear();
    apart.resize(normals.len(), false);
    bucket.sums(normals);
    for ((normal, apart), &degree) in normals.iter_mut().zip(&mut *apart).zip(&bucket.around.degrees) {
        let mean = unit(*normal).filter(|_| degree as usize <= MANY);
        *apart = degree > 0 && mean.is_none();
        *normal = mean.unwrap_or(DEFAULT_NORMAL);
    }
    bucket.for_each_crease(normals, half, |v| apart[v] = true);
    apart.contains(&true)
}

/// Makes the normals of all corners.
pub(crate) fn fan_normals(mesh: &Mesh, weld: &Weld, rule: Rule, workers: &Workers) -> FanNormals {
    let vertices = mesh.positions.len();
    let (shift, count) = shift_and_count(vertices);
    let all = AllFaces::new(mesh, weld, workers);
    let skins = if matches!(mesh.faces, Faces::Triangles) { Skins::new(mesh, weld) } else { None };

    // Each vertex has room for one normal; further ones are kept by bucket. For each corner 0 if it takes the first, else one more
    // than the place of a further one; made when the first vertex with two is found.
    let mut first = vec![DEFAULT_NORMAL; vertices];
    let mut further: Vec<Vec<[f32; 3]>> = vec![Vec::new(); count];
    let which: OnceLock<Vec<AtomicU32>> = OnceLock::new();
    let spare = Spare::<Scratch>::default();
    let buckets: Vec<_> = first.chunks_mut(1 << shift).zip(&mut further).enumerate().collect();
    let make = |b: usize, first: &mut [[f32; 3]], further: &mut Vec<[f32; 3]>, scratch: &mut Scratch| {
        let Scratch { bucket, fan, apart, seen } = scratch;
        bucket.gather(&all, b, first.len());
        if let Some(skins) = &skins {
            skins.look_at(seen, &bucket.around);
        }
        if !average(bucket, rule, first, apart) {
            return;
        }
        bucket.sort(apart);
        for (v, first) in first.iter_mut().enumerate().filter(|(v, _)| apart[*v]) {
            let corners = bucket.at(v);
            fan.make(corners, &bucket.around.faces, &bucket.normals, rule);
            *first = fan.values[0];
            if fan.values.len() > 1 {
                let which = which.get_or_init(|| face_corner_list(mesh).iter().map(|_| AtomicU32::new(0)).collect());
                for (c, &slot) in corners.iter().zip(&fan.slots).filter(|(_, slot)| **slot > 0) {
                    which[c.index as usize].store(further.len() as u32 + slot, Relaxed);
                }
                further.extend_from_slice(&fan.values[1..]);
            }
        }
    };
    workers.for_each(buckets, |(b, (first, further))| spare.lend(|scratch| make(b, first, further, scratch)));
    drop(all);
    let spare = spare.into_inner();
    let solids = skins.map(|skins| skins.solids(spare.iter().map(|scratch| &scratch.seen), workers));

    // One normal a vertex: no indices needed.
    let Some(which) = which.into_inner() else {
        if weld.distinct < vertices {
            let of_representative = std::mem::replace(&mut first, vec![DEFAULT_NORMAL; vertices]);
            workers.for_each_chunk(&mut first, PIECE, |k, part| {
                for (normal, &v) in part.iter_mut().zip(&weld.representative[k * PIECE..]) {
                    *normal = of_representative[v as usize];
                }
            });
        }
        return FanNormals { values: first, of_corner: None, solids };
    };

    // What was welded to another vertex has no normal of its own. Further normals follow the first ones.
    let mut own: Vec<u32> = Vec::new();
    if weld.distinct < vertices {
        let mut next = 0;
        let number = |(v, normal): (u32, [f32; 3])| {
            let is_own = weld.of(v) == v;
            own.push(next);
            next += u32::from(is_own);
            is_own.then_some(normal)
        };
        first = (0..).zip(first).filter_map(number).collect();
    }
    let mut values = first;
    let before: Vec<u32> = further
        .iter()
        .map(|further| {
            values.extend_from_slice(further);
            (values.len() - further.len()) as u32
        })
        .collect();
    let list = face_corner_list(mesh);
    let mut of_corner: Vec<u32> = which.into_iter().map(AtomicU32::into_inner).collect();
    workers.for_each_chunk(&mut of_corner, PIECE, |k, part| {
        for (c, index) in part.iter_mut().enumerate() {
            let v = weld.of(list[k * PIECE + c]);
            let first = own.get(v as usize).copied().unwrap_or(v);
            *index = index.checked_sub(1).map_or(first, |further| before[(v >> shift) as usize] + further);
        }
    });
    FanNormals { values, of_corner: Some(of_corner), solids }
}

/// Whether a face's normal is within an angle of another direction; a face without area always is.
#[inline]
fn is_near(direction: [f32; 3], normal: [f32; 3], cosine: f32) -> bool {
    dot(direction, normal) >= cosine || normal == [0.0; 3]
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
