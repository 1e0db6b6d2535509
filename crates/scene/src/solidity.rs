//! Solidity: is the surface the skin of solids, and are their insides inside?
//!
//! Idea: if every edge has exactly two triangles and they run along it in opposite directions, the surface is the skin of
//! solids, and back faces can never be seen from outside; but only if the triangles look outwards, which the sign of the
//! enclosed volume tells, body by body.
//!
//! In:   a mesh, model space. Faces with more than three corners count as triangulated.
//! Out:  [`Solidity`] for back-face culling.
//! Cost: `O(triangles)` expected. Who lists the triangles round every vertex anyway, as for normals, has most of it for
//!       nothing: the mesh keeps the answer, and what it is an answer to.
//! Source: [Mirtich 1996] and others for the volume as a sum of signed tetrahedra.

use crate::disjoint_sets::DisjointSets;
use crate::edge_table::{MAX_FACES, Use, is_collapsed};
use crate::triangle_buckets::{Around, TriangleBuckets};
use crate::weld::Weld;
use crate::{Corners, Mesh};
use vitral_exec::{Spare, Workers};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, LANES, Level, Simd, dispatch};
use vitral_math::{DVec3, Fingerprint, mixed};

/// What back-face culling must know. Triangles with two corners at one position are left out: they are invisible.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Solidity {
    /// Every edge has exactly two triangles.
    pub closed: bool,
    /// Neighbours run along their common edge in opposite directions.
    pub consistent: bool,
    /// Every body encloses a positive volume: its triangles are counter-clockwise seen from outside. Only a closed and
    /// consistent mesh has this. A hollow solid, whose inner skin counts as a body of negative volume, has it not.
    pub outward: bool,
}

impl Solidity {
    /// Asks everything that [`Self::is_solid`] needs. A body is what is connected through edges.
    pub fn of(mesh: &Mesh, workers: &Workers) -> Self {
        if let Some(known) = &mesh.solidity
            && known.surface == fingerprint(mesh, workers)
        {
            return known.solidity;
        }
        let weld = Weld::new(&mesh.positions, workers);
        let Some(skins) = Skins::new(mesh, &weld) else { return Self::default() };
        let triangles = TriangleBuckets::new(mesh, &weld, workers);
        let spare = Spare::<(Around, Seen)>::default();
        workers.map(triangles.count(), |b| {
            spare.lend(|(around, seen)| {
                around.fill(&triangles, b);
                skins.look_at(seen, around);
            });
        });
        drop(triangles);
        skins.solidity(spare.into_inner().iter().map(|(_, seen)| seen), workers)
    }

    /// Whether back faces can never be seen from a point outside the mesh.
    pub fn is_solid(&self) -> bool {
        self.closed && self.consistent && self.outward
    }
}

/// A mesh's solidity, and what surface it is that of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KnownSolidity {
    solidity: Solidity,
    surface: u64,
}

impl KnownSolidity {
    /// `solidity`, found out for the mesh as it is now.
    pub(crate) fn new(mesh: &Mesh, solidity: Solidity, workers: &Workers) -> Self {
        Self { solidity, surface: fingerprint(mesh, workers) }
    }
}

/// With more corners at a vertex its sides are sorted.
const MANY: u32 = 64;
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
}

/// What was seen of some of the edges.
#[derive(Default)]
pub(crate) struct Seen {
    some: bool,
    open: bool,
    twisted: bool,
    /// Memory for the edges of some vertices.
    edges: Vec<Edge>,
    /// For each vertex, the newest edge that has it as its lower one.
    newest: Vec<u32>,
    /// The uses of edges at vertices with many corners, with the lower vertex.
    long: Vec<(u32, Use)>,
}

/// An edge, at its lower vertex.
struct Edge {
    /// The first one, and the last one if there are more.
    uses: [Use; 2],
    count: u32,
    /// The edge before it at this vertex.
    older: u32,
}

impl Seen {
    fn use_edge(&mut self, vertex: usize, side: Use) {
        let mut at = self.newest[vertex];
        while let Some(edge) = self.edges.get_mut(at as usize) {
            if edge.uses[0].higher() == side.higher() {
                edge.uses[1] = side;
                edge.count += 1;
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
        countable.then(|| Self { mesh, weld, bodies: DisjointSets::new(mesh.triangles.len()) })
    }

    fn welded(&self, corners: &[u32; 3]) -> [u32; 3] {
        corners.map(|i| self.weld.of(i))
    }

    /// Looks at an edge that `count` triangles use, of which it needs no more than two.
    fn edge(&self, seen: &mut Seen, uses: &[Use], count: u32) {
        seen.some = true;
        match uses {
            [a, b] if count == 2 => {
                seen.twisted |= a.reversed() == b.reversed();
                self.bodies.join(a.face(), b.face());
            }
            _ => seen.open = true,
        }
    }

    /// Looks at the edges whose lower vertex is in a bucket.
    pub(crate) fn look_at(&self, seen: &mut Seen, around: &Around) {
        let Around { first_vertex, degrees, faces, welded } = around;
        seen.edges.clear();
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
                    Some(&degree) if degree > MANY => seen.long.push((lower, Use::new(higher, face, from > to))),
                    Some(_) => seen.use_edge(vertex, Use::new(higher, face, from > to)),
                }
            }
        }

        let edges = std::mem::take(&mut seen.edges);
        edges.iter().for_each(|edge| self.edge(seen, &edge.uses[..(edge.count as usize).min(2)], edge.count));
        seen.edges = edges;
        let mut long = std::mem::take(&mut seen.long);
        long.sort_unstable();
        for edge in long.chunk_by(|a, b| (a.0, a.1.higher()) == (b.0, b.1.higher())) {
            self.edge(seen, &[edge[0].1, edge[edge.len() - 1].1], edge.len() as u32);
        }
        seen.long = long;
    }

    /// The answer, when all edges were looked at.
    pub(crate) fn solidity<'b>(self, seen: impl IntoIterator<Item = &'b Seen> + Clone, workers: &Workers) -> Solidity {
        let any = |of: fn(&Seen) -> bool| seen.clone().into_iter().any(of);
        let closed = any(|s| s.some) && !any(|s| s.open);
        let consistent = !any(|s| s.twisted);
        Solidity { closed, consistent, outward: closed && consistent && self.all_outward(workers) }
    }

    /// Whether no body has a negative volume. A flat body (two sheets back to back) has none at all and passes.
    fn all_outward(&self, workers: &Workers) -> bool {
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
                    continue;
                }
                let body = self.bodies.find(t);
                match volumes.last_mut() {
                    Some(last) if last.body == body => {
                        last.signed += tetrahedron;
                        last.magnitude += tetrahedron.abs();
                    }
                    _ => volumes.push(Volume { body, signed: tetrahedron, magnitude: tetrahedron.abs() }),
                }
            }
            volumes
        });
        let mut volumes = batches.into_iter().flatten().collect::<Vec<_>>();
        volumes.sort_by_key(|v| v.body);
        volumes.chunk_by(|a, b| a.body == b.body).all(|parts| {
            let sum = |of: fn(&Volume) -> f64| parts.iter().map(of).sum::<f64>();
            sum(|v| v.signed) >= -1e-9 * sum(|v| v.magnitude)
        })
    }
}

/// Six times the signed volumes of the tetrahedra between triangles and a point, the last repeated to fill up eight.
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

/// A body's volume, times six, and the sum of the magnitudes it was added up from, to know what rounding may do.
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
        assert_eq!(ball.solidity.as_ref().map(|known| known.solidity), Some(alone));
        assert_eq!(fingerprint(&ball, &Workers::single()), fingerprint(&ball, &Workers::new(3)));

        // The mesh still carries the old answer, which is none any more.
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
        ball.triangles.extend(sound.iter().flat_map(|&[a, b, c]| [[a, a, b], [b, c, c], [c, a, c]]));
        assert!(Solidity::of(&ball, &Workers::single()).is_solid());
        normals::generate(&mut ball, 1.0, &Workers::single());
        assert!(Solidity::of(&ball, &Workers::single()).is_solid());
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
            assert!(!Solidity::of(&holed, &workers).closed && Solidity::of(&holed, &workers).consistent);
            let mut turned = body.clone();
            turned.triangles[middle].swap(0, 1);
            assert!(Solidity::of(&turned, &workers).closed && !Solidity::of(&turned, &workers).consistent);
            let mut doubled = body.clone();
            doubled.triangles.push(body.triangles[middle]);
            assert!(!Solidity::of(&doubled, &workers).closed);
            let mut with_normals = turned;
            normals::generate(&mut with_normals, 0.5, &workers);
            assert!(!Solidity::of(&with_normals, &workers).consistent);
        }
    }
}
