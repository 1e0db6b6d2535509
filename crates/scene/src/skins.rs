//! Solidity: is the surface the skin of solids, and are their insides inside?
//!
//! Idea: if every edge has exactly two triangles and they run along it in opposite directions, the
//! surface is the skin of solids, and back faces can never be seen from outside; but only if the
//! triangles look outwards, which the sign of the enclosed volume tells, body by body. A mesh is
//! often many bodies, some of them solid and others not: a body is solid whatever the others are.
//! Where more than two triangles meet in an edge, as where two boxes touch, it is those of each
//! body that must run both ways equally often.
//!
//! In:   a mesh, model space. Faces with more than three corners count as triangulated.
//! Out:  [`Solidity`] and [`Solids`] for back-face culling.
//! Cost: `O(triangles)` expected. Who lists the triangles round every vertex anyway, as for
//!       normals, has most of it for nothing: the mesh keeps the answer, and what it is an answer
//!       to.
//! Source: [Mirtich 1996] and others for the volume as a sum of signed tetrahedra.

use crate::disjoint_sets::DisjointSets;
use crate::edge_table::{MAX_FACES, Use, is_collapsed};
use crate::triangle_buckets::{Around, TriangleBuckets};
use crate::weld::Weld;
use crate::{Corners, KnownSolidity, Mesh, Solidity, Solids};
use std::ops::Range;
use std::sync::atomic::AtomicU32;
use std::sync::atomic::Ordering::Relaxed;
use vitral_exec::{Spare, Workers};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, LANES, Level, Simd, dispatch};
use vitral_math::{DVec3, Fingerprint, mixed};

impl Solidity {
    /// Asks everything that [`Self::is_solid`] needs. A body is what is connected through edges of
    /// two triangles.
    pub fn of(mesh: &Mesh, workers: &Workers) -> Self {
        Solids::of(mesh, workers).solidity
    }
}

impl Solids {
    /// Looks at all edges, unless the mesh knows.
    pub fn of(mesh: &Mesh, workers: &Workers) -> Self {
        if let Some(known) = &mesh.solidity
            && known.surface == fingerprint(mesh, workers)
        {
            return known.solids.clone();
        }
        let weld = Weld::new(&mesh.positions, workers);
        let Some(skins) = Skins::new(mesh, &weld) else { return Self::default() };
        let triangles = TriangleBuckets::new(mesh, &weld, workers);
        let spare = Spare::<(Around, EdgeFindings)>::default();
        workers.map(triangles.count(), |b| {
            spare.lend(|(around, seen)| {
                around.fill(&triangles, b);
                skins.look_at(seen, around);
            });
        });
        drop(triangles);
        skins.solids(spare.into_inner().iter().map(|(_, seen)| seen), workers)
    }

    /// [`Self::of`] what these ranges of triangles are by themselves, as if the mesh had no others;
    /// their numbers stay what they are.
    ///
    /// # Panics
    /// If a range goes beyond the mesh's triangles.
    pub fn of_some(mesh: &Mesh, ranges: &[Range<u32>], workers: &Workers) -> Self {
        let numbers = || ranges.iter().cloned().flatten();
        let triangles = numbers().map(|t| mesh.triangles[t as usize]).collect();
        let apart = Mesh { positions: mesh.positions.clone(), triangles, ..Mesh::default() };
        let Self { solidity, triangles } = Self::of(&apart, workers);
        if triangles.is_empty() {
            return Self { solidity, triangles };
        }
        let mut words = vec![0; mesh.triangles.len().div_ceil(32)];
        for (_, t) in numbers().enumerate().filter(|&(k, _)| triangles[k / 32] >> (k % 32) & 1 == 1)
        {
            words[t as usize / 32] |= 1 << (t % 32);
        }
        Self { solidity, triangles: words.into() }
    }
}

impl KnownSolidity {
    /// `solids`, found out for the present mesh.
    pub(crate) fn new(mesh: &Mesh, solids: Solids, workers: &Workers) -> Self {
        Self { solids, surface: fingerprint(mesh, workers) }
    }
}

/// Corners at a vertex above which its sides are sorted instead of searched.
const SORT_THRESHOLD: u32 = 64;
/// Not an edge.
const NONE: u32 = u32::MAX;

/// A hash of positions and triangles. Reading them once is little against finding neighbours again.
fn fingerprint(mesh: &Mesh, workers: &Workers) -> u64 {
    const PIECE: usize = 1 << 16;
    let hash = |words: &[u32]| {
        let pieces = workers.map(words.len().div_ceil(PIECE), |k| {
            let piece = Fingerprint::of(&words[k * PIECE..words.len().min((k + 1) * PIECE)]);
            piece.0.map(|h| [h as u32, (h >> 32) as u32])
        });
        let whole = Fingerprint::of(pieces.as_flattened().as_flattened());
        whole.0.iter().fold(words.len() as u64, |all, h| mixed(all, *h))
    };
    mixed(hash(bytemuck::cast_slice(&mesh.positions)), hash(mesh.triangles.as_flattened()))
}

/// The skins of a mesh, while its edges are looked at.
pub(crate) struct Skins<'a> {
    mesh: &'a Mesh,
    weld: &'a Weld,
    bodies: DisjointSets,
    /// A bit for each triangle: whether its body cannot be solid.
    unsound: Bits,
}

/// A bit for each triangle, set by several threads at once.
struct Bits(Vec<AtomicU32>);

impl Bits {
    fn new(count: usize) -> Self {
        Self((0..count.div_ceil(32)).map(|_| AtomicU32::new(0)).collect())
    }

    fn set(&self, t: u32) {
        if !self.has(t) {
            self.0[t as usize / 32].fetch_or(1 << (t % 32), Relaxed);
        }
    }

    fn has(&self, t: u32) -> bool {
        self.0[t as usize / 32].load(Relaxed) >> (t % 32) & 1 == 1
    }
}

/// What was seen of some of the edges.
#[derive(Default)]
pub(crate) struct EdgeFindings {
    some: bool,
    open: bool,
    twisted: bool,
    /// Memory for the edges of some vertices.
    edges: Vec<Edge>,
    /// For each vertex, the newest edge that has it as its lower one.
    newest: Vec<u32>,
    /// The uses of edges at vertices with many corners, with the lower vertex.
    long: Vec<(u32, Use)>,
    /// Uses beyond an edge's second one, with the number of the edge.
    further: Vec<(u32, Use)>,
    /// The uses of edges with more than two, edge by edge: the first of each edge has `true`.
    crossings: Vec<(bool, Use)>,
}

/// An edge, at its lower vertex.
struct Edge {
    /// The first one, and the second one if there are more.
    uses: [Use; 2],
    count: u32,
    /// The edge before it at this vertex.
    older: u32,
}

impl EdgeFindings {
    fn use_edge(&mut self, vertex: usize, side: Use) {
        let mut at = self.newest[vertex];
        while let Some(edge) = self.edges.get_mut(at as usize) {
            if edge.uses[0].higher() == side.higher() {
                edge.count += 1;
                if edge.count == 2 {
                    edge.uses[1] = side;
                } else {
                    self.further.push((at, side));
                }
                return;
            }
            at = edge.older;
        }
        let older = std::mem::replace(&mut self.newest[vertex], self.edges.len() as u32);
        self.edges.push(Edge { uses: [side; 2], count: 1, older });
    }
}

impl<'a> Skins<'a> {
    /// `None` if there are no triangles, or more than can be told apart.
    pub(crate) fn new(mesh: &'a Mesh, weld: &'a Weld) -> Option<Self> {
        let countable = !mesh.triangles.is_empty() && mesh.triangles.len() < MAX_FACES;
        let count = mesh.triangles.len();
        countable.then(|| Self {
            mesh,
            weld,
            bodies: DisjointSets::new(count),
            unsound: Bits::new(count),
        })
    }

    fn welded(&self, corners: &[u32; 3]) -> [u32; 3] {
        corners.map(|i| self.weld.of(i))
    }

    /// Looks at an edge that these triangles use.
    fn edge(&self, seen: &mut EdgeFindings, uses: &[Use]) {
        seen.some = true;
        match uses {
            [a, b] => {
                self.bodies.join(a.face(), b.face());
                if a.reversed() == b.reversed() {
                    seen.twisted = true;
                    self.unsound.set(a.face());
                }
            }
            [alone] => {
                seen.open = true;
                self.unsound.set(alone.face());
            }
            // Which bodies these are of is not known yet.
            _ => {
                seen.open = true;
                seen.crossings.extend(uses.iter().enumerate().map(|(i, side)| (i == 0, *side)));
            }
        }
    }

    /// Looks at the edges whose lower vertex is in a bucket.
    pub(crate) fn look_at(&self, seen: &mut EdgeFindings, around: &Around) {
        // Sort the sides of each triangle by their lower vertex.
        let Around { first_vertex, degrees, faces, welded } = around;
        seen.edges.clear();
        seen.further.clear();
        seen.long.clear();
        seen.newest.clear();
        seen.newest.resize(degrees.len(), NONE);
        for (&face, &at) in faces.iter().zip(welded) {
            if is_collapsed(at) {
                continue;
            }
            for (from, to) in [(at[0], at[1]), (at[1], at[2]), (at[2], at[0])] {
                let (lower, higher) = (from.min(to), from.max(to));
                let vertex = lower.wrapping_sub(*first_vertex) as usize;
                match degrees.get(vertex) {
                    None => {}
                    Some(&degree) if degree > SORT_THRESHOLD => {
                        seen.long.push((lower, Use::new(higher, face, from > to)))
                    }
                    Some(_) => seen.use_edge(vertex, Use::new(higher, face, from > to)),
                }
            }
        }

        // Look at each edge: those with one or two uses, then those with more.
        let (edges, mut further) =
            (std::mem::take(&mut seen.edges), std::mem::take(&mut seen.further));
        for edge in edges.iter().filter(|edge| edge.count <= 2) {
            self.edge(seen, &edge.uses[..edge.count as usize]);
        }
        further.sort_unstable();
        for more in further.chunk_by(|a, b| a.0 == b.0) {
            let first = edges[more[0].0 as usize].uses;
            let all: Vec<Use> =
                first.into_iter().chain(more.iter().map(|(_, side)| *side)).collect();
            self.edge(seen, &all);
        }
        (seen.edges, seen.further) = (edges, further);

        // Look at the edges of vertices with many neighbours, sorted by their ends.
        let mut long = std::mem::take(&mut seen.long);
        long.sort_unstable();
        let mut uses = Vec::new();
        for edge in long.chunk_by(|a, b| (a.0, a.1.higher()) == (b.0, b.1.higher())) {
            uses.clear();
            uses.extend(edge.iter().map(|(_, side)| *side));
            self.edge(seen, &uses);
        }
        seen.long = long;
    }

    /// The answer, when all edges were looked at.
    pub(crate) fn solids<'b>(
        self,
        seen: impl IntoIterator<Item = &'b EdgeFindings> + Clone,
        workers: &Workers,
    ) -> Solids {
        let any = |of: fn(&EdgeFindings) -> bool| seen.clone().into_iter().any(of);
        let closed = any(|s| s.some) && !any(|s| s.open);
        let consistent = !any(|s| s.twisted);
        seen.into_iter().for_each(|seen| self.weigh_crossings(&seen.crossings));
        self.blame_bodies();
        let inside_out = self.find_inside_out(workers);
        let solidity =
            Solidity { closed, consistent, outward: closed && consistent && !inside_out };
        let triangles =
            if solidity.is_solid() { Vec::new() } else { self.of_solid_bodies(workers) };
        Solids { solidity, triangles: triangles.into() }
    }

    /// Finds the bodies that run along an edge more often one way than the other, among edges of
    /// many triangles.
    fn weigh_crossings(&self, crossings: &[(bool, Use)]) {
        let mut ways: Vec<(u32, i32)> = Vec::new();
        for edge in crossings.chunk_by(|_, next| !next.0) {
            ways.clear();
            ways.extend(edge.iter().map(|(_, side)| {
                (self.bodies.find(side.face()), 1 - 2 * i32::from(side.reversed()))
            }));
            ways.sort_unstable();
            for of_body in ways.chunk_by(|a, b| a.0 == b.0) {
                if of_body.iter().map(|(_, way)| way).sum::<i32>() != 0 {
                    self.unsound.set(of_body[0].0);
                }
            }
        }
    }

    /// What one triangle of a body is blamed for, its root is, which stands for all of them.
    fn blame_bodies(&self) {
        for (t, word) in (0u32..).step_by(32).zip(&self.unsound.0) {
            let mut left = word.load(Relaxed);
            while left != 0 {
                self.unsound.set(self.bodies.find(t + left.trailing_zeros()));
                left &= left - 1;
            }
        }
    }

    /// A bit for each triangle: whether its body is solid. Empty if none is.
    fn of_solid_bodies(&self, workers: &Workers) -> Vec<u32> {
        const WORDS: usize = 1 << 10;
        let triangles = &self.mesh.triangles;
        let mut words = vec![0; triangles.len().div_ceil(32)];
        workers.for_each_chunk(&mut words, WORDS, |chunk, words| {
            for (word, first) in words.iter_mut().zip((32 * WORDS * chunk..).step_by(32)) {
                for (bit, t) in (first..triangles.len().min(first + 32)).enumerate() {
                    *word |= u32::from(!self.unsound.has(self.bodies.find(t as u32))) << bit;
                }
            }
        });
        if words.iter().any(|word| *word != 0) { words } else { Vec::new() }
    }

    /// Whether bodies have a negative volume. These are blamed for it, and flat ones (two sheets
    /// back to back): the sheets are equally far away, so that the one behind may be seen.
    fn find_inside_out(&self, workers: &Workers) -> bool {
        const BATCH: usize = 1 << 14;
        let mesh = self.mesh;
        // Volumes are taken as seen from some place near.
        let (near, level) = (mesh.position(mesh.triangles[0][0]), Level::new());
        let batches = workers.map(mesh.triangles.len().div_ceil(BATCH), |batch| {
            let first = batch * BATCH;
            let triangles = &mesh.triangles[first..mesh.triangles.len().min(first + BATCH)];
            let tetrahedra = dispatch!(level, simd => tetrahedra(simd, mesh, triangles, near));
            // Neighbours in the list are mostly of one body.
            let mut volumes: Vec<Volume> = Vec::new();
            for ((t, corners), tetrahedron) in (first as u32..).zip(triangles).zip(tetrahedra) {
                // What has collapsed is no part of a body: its volume is nothing but rounding.
                if is_collapsed(self.welded(corners)) {
                    self.unsound.set(t);
                    continue;
                }
                let body = self.bodies.find(t);
                match volumes.last_mut() {
                    Some(last) if last.body == body => {
                        last.signed += tetrahedron;
                        last.magnitude += tetrahedron.abs();
                    }
                    _ => volumes.push(Volume {
                        body,
                        signed: tetrahedron,
                        magnitude: tetrahedron.abs(),
                    }),
                }
            }
            volumes
        });
        let mut volumes = batches.into_iter().flatten().collect::<Vec<_>>();
        volumes.sort_by_key(|v| v.body);
        let mut any = false;
        for parts in volumes.chunk_by(|a, b| a.body == b.body) {
            let sum = |of: fn(&Volume) -> f64| parts.iter().map(of).sum::<f64>();
            let (volume, rounding) = (sum(|v| v.signed), 1e-9 * sum(|v| v.magnitude));
            if volume.is_nan() || volume <= rounding {
                self.unsound.set(parts[0].body);
            }
            any |= volume.is_nan() || volume < -rounding;
        }
        any
    }
}

/// Six times the signed volumes of the tetrahedra between triangles and a point, the last repeated
/// to fill up eight.
#[inline(always)]
fn tetrahedra<S: Simd>(simd: S, mesh: &Mesh, triangles: &[Corners], point: DVec3) -> Vec<f64> {
    let mut volumes = vec![0.0; triangles.len().next_multiple_of(LANES)];
    for (triangles, volumes) in triangles.chunks(LANES).zip(volumes.chunks_mut(LANES)) {
        let corner = lanes::inlined(
            #[inline(always)]
            |k: usize| {
                let [x, y, z] = lanes::wide_points(
                    simd,
                    #[inline(always)]
                    |lane| mesh.positions[triangles[lane.min(triangles.len() - 1)][k] as usize],
                );
                [x - point.x, y - point.y, z - point.z]
            },
        );
        let (a, [bx, by, bz], [cx, cy, cz]) = (corner(0), corner(1), corner(2));
        let across = [by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx];
        (a[0] * across[0] + a[1] * across[1] + a[2] * across[2]).store_slice(volumes);
    }
    volumes
}

/// A body's volume, times six, and the sum of the magnitudes it was added up from, to know what
/// rounding may do.
struct Volume {
    body: u32,
    signed: f64,
    magnitude: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::solids;
    use crate::normals;

    #[test]
    fn what_normals_found_out_holds_until_the_surface_is_changed() {
        let mut ball = solids::sphere(1.0, 32, 16);
        (ball.normals, ball.faces, ball.solidity) = (None, crate::Faces::Triangles, None);
        let alone = Solidity::of(&ball, &Workers::single());
        assert!(alone.is_solid());
        normals::generate(&mut ball, 1.0, &Workers::new(2));
        assert_eq!(ball.solidity.as_ref().map(|known| known.solids.solidity), Some(alone));
        assert_eq!(fingerprint(&ball, &Workers::single()), fingerprint(&ball, &Workers::new(3)));

        // The mesh still carries the old answer, which is stale.
        let mut turned = ball.clone();
        turned.triangles[5].swap(0, 1);
        assert!(!Solidity::of(&turned, &Workers::single()).consistent);
        let mut inside_out = ball.clone();
        inside_out.positions.iter_mut().for_each(|p| p[0] = -p[0]);
        assert!(!Solidity::of(&inside_out, &Workers::single()).outward);
        ball.triangles.pop();
        assert!(!Solidity::of(&ball, &Workers::single()).closed);
    }

    #[test]
    fn collapsed_triangles_have_no_say() {
        let mut ball = solids::sphere(1.0, 32, 16);
        (ball.normals, ball.faces, ball.solidity) = (None, crate::Faces::Triangles, None);
        let sound = ball.triangles.clone();
        ball.triangles
            .extend(sound.iter().flat_map(|&[a, b, c]| [[a, a, b], [b, c, c], [c, a, c]]));
        assert!(Solidity::of(&ball, &Workers::single()).is_solid());
        normals::generate(&mut ball, 1.0, &Workers::single());
        assert!(Solidity::of(&ball, &Workers::single()).is_solid());
    }

    /// A ball, triangles alone, with this middle and radius; inside out if wanted.
    fn ball(middle: f32, radius: f64, inside_out: bool) -> Mesh {
        let mut ball = solids::sphere(radius, 12, 8);
        (ball.normals, ball.faces, ball.solidity, ball.uvs) =
            (None, crate::Faces::Triangles, None, Vec::new());
        ball.positions.iter_mut().for_each(|p| p[0] += middle);
        if inside_out {
            ball.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        }
        ball
    }

    /// All bodies in one mesh, and for each how many triangles it has.
    fn together(bodies: &[Mesh]) -> (Mesh, Vec<usize>) {
        let mut all = Mesh::default();
        for body in bodies {
            let first = all.positions.len() as u32;
            all.positions.extend(&body.positions);
            all.triangles.extend(body.triangles.iter().map(|t| t.map(|i| i + first)));
        }
        (all, bodies.iter().map(|body| body.triangles.len()).collect())
    }

    /// Which of the bodies are solid, by the bits of their triangles, which must agree.
    fn solid_bodies(solids: &Solids, counts: &[usize]) -> Vec<bool> {
        let words = solids.some().expect("some are solid");
        let mut first = 0;
        counts
            .iter()
            .map(|count| {
                let bits: Vec<_> =
                    (first..first + count).map(|t| words[t / 32] >> (t % 32) & 1 == 1).collect();
                first += count;
                assert!(bits.iter().all(|bit| *bit == bits[0]));
                bits[0]
            })
            .collect()
    }

    #[test]
    fn a_body_is_solid_whatever_the_others_are() {
        let mut holed = ball(3.0, 1.0, false);
        holed.triangles.pop();
        // Two sheets back to back, and a ball with one triangle turned.
        let sheet = Mesh {
            positions: ball(9.0, 1.0, false).positions,
            triangles: vec![[0, 13, 1], [0, 1, 13]],
            ..Mesh::default()
        };
        let mut turned = ball(12.0, 1.0, false);
        turned.triangles[20].swap(1, 2);
        let bodies = [
            ball(0.0, 1.0, false),
            holed,
            ball(6.0, 1.0, true),
            ball(6.0, 2.0, false),
            sheet,
            turned,
            ball(20.0, 0.1, false),
        ];
        let (mut mesh, counts) = together(&bodies);
        let solids = Solids::of(&mesh, &Workers::new(2));
        assert_eq!(solids.solidity, Solidity::default());
        assert_eq!(solid_bodies(&solids, &counts), [true, false, false, true, false, false, true]);
        normals::generate(&mut mesh, 1.0, &Workers::single());
        assert_eq!(mesh.solidity.as_ref().map(|known| &known.solids), Some(&solids));

        // Of some of them alone.
        let end = counts[..4].iter().sum::<usize>() as u32;
        let all = end..mesh.triangles.len() as u32;
        assert_eq!(
            Solids::of_some(
                &mesh,
                &[0..counts[0] as u32, all.end - 3..all.end],
                &Workers::single()
            )
            .some()
            .map(|words| words[0]),
            Some(u32::MAX)
        );
        let first = 0..counts[0] as u32;
        assert!(
            Solids::of_some(&mesh, std::slice::from_ref(&first), &Workers::single())
                .solidity
                .is_solid()
        );
        let last = solids.some().expect("some are").to_vec();
        let others = Solids::of_some(&mesh, std::slice::from_ref(&all), &Workers::single());
        let others = others.some().expect("the small ball is");
        assert!((0..mesh.triangles.len()).all(|t| {
            let bit = |words: &[u32]| words[t / 32] >> (t % 32) & 1;
            bit(others) == if t < end as usize { 0 } else { bit(&last) }
        }));
    }

    #[test]
    fn bodies_that_share_an_edge_are_solid_and_those_that_make_one_only_together_are_not() {
        let cube = |middle: [f32; 3]| {
            let mut cube = solids::cuboid(DVec3::ONE);
            (cube.normals, cube.faces, cube.solidity, cube.uvs) =
                (None, crate::Faces::Triangles, None, Vec::new());
            cube.positions.iter_mut().for_each(|p| *p = [0, 1, 2].map(|k| p[k] + middle[k]));
            cube
        };
        let cubes = [cube([0.0; 3]), cube([1.0, 1.0, 0.0])];
        let shared = |p: &[f32; 3]| cubes[1].positions.contains(p);
        assert_eq!(cubes[0].positions.iter().filter(|p| shared(p)).count(), 2, "one edge");
        let (mesh, counts) = together(&cubes);
        let solids = Solids::of(&mesh, &Workers::single());
        assert!(!solids.solidity.closed);
        assert_eq!(solid_bodies(&solids, &counts), [true, true]);

        // A third one inside out, which shares another edge, is none; nor is what is there twice.
        let mut inside_out = cube([-1.0, -1.0, 0.0]);
        inside_out.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        let twice = [cube([5.0, 0.0, 0.0]), cube([5.0, 0.0, 0.0])];
        let (mesh, counts) = together(&[
            cubes[0].clone(),
            cubes[1].clone(),
            inside_out,
            twice[0].clone(),
            twice[1].clone(),
        ]);
        let found = Solids::of(&mesh, &Workers::single());
        assert!(!found.solidity.closed);
        let solid = solid_bodies(&found, &counts);
        assert_eq!(solid, [true, true, false, false, false]);
    }

    #[test]
    fn bodies_of_many_buckets_and_corners_with_many_faces_are_solid_unless_something_is_amiss() {
        // The tip and the middle of the base have 20000 faces each.
        let mut cone = solids::cone(1.0, 1.0, 20_000);
        (cone.normals, cone.faces, cone.solidity) = (None, crate::Faces::Triangles, None);
        let mut ball = solids::sphere(1.0, 160, 80);
        (ball.normals, ball.faces, ball.solidity) = (None, crate::Faces::Triangles, None);
        for body in [cone, ball] {
            let (middle, workers) = (body.triangles.len() / 2, Workers::new(2));
            assert!(Solidity::of(&body, &workers).is_solid());
            let mut holed = body.clone();
            holed.triangles.remove(middle);
            assert!(
                !Solidity::of(&holed, &workers).closed && Solidity::of(&holed, &workers).consistent
            );
            let mut turned = body.clone();
            turned.triangles[middle].swap(0, 1);
            assert!(
                Solidity::of(&turned, &workers).closed
                    && !Solidity::of(&turned, &workers).consistent
            );
            let mut doubled = body.clone();
            doubled.triangles.push(body.triangles[middle]);
            assert!(!Solidity::of(&doubled, &workers).closed);
            let mut with_normals = turned;
            normals::generate(&mut with_normals, 0.5, &workers);
            assert!(!Solidity::of(&with_normals, &workers).consistent);
        }
    }
}
