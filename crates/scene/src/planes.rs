//! Planes that several facets of a world lie in, found once and numbered.
//!
//! A decal on a floor, the two sides of a sheet, the triangles of a flat polygon: they have equal
//! depths only if their depths come from one plane, not from corners that were rounded each by
//! itself. So facets are gathered by the planes of the world, in double precision. Large facets
//! come first, since their corners tell a plane best; a facet joins a plane that is there if all
//! its corners are within [`TOLERANCE`] of it. To find that plane, planes are hashed by normal and
//! distance, on a grid whose cells are as wide as the rounding of corners can turn the facets at
//! hand: small facets are looked up on a coarser grid than large ones. Facets too small for that
//! share a plane where they have the same corners.
//!
//! In:   a world. Out: for each facet the number of its plane, if it shares it; the planes.
//! Cost: linear in facets, some memory accesses each.

use crate::{Instance, World};
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};
use std::ops::Range;
use vitral_exec::Workers;
use vitral_math::{DVec3, DVec4};

/// Number of the plane of a facet that shares its plane with no other.
pub const NO_PLANE: u32 = u32::MAX;

/// How far a corner may be from a plane that its facet lies in, in diagonals of the world's box:
/// coordinates are often written with six digits.
pub const TOLERANCE: f64 = 1.0 / (1 << 21) as f64;

/// The heights of facets that are looked up by their planes, in powers of two times the tolerance.
/// Lower ones hardly have a direction.
const LEVELS: Range<u32> = 6..24;

/// Faces in one piece of work.
const FACES_A_JOB: usize = 1 << 14;

/// See the module.
#[derive(Clone, Debug, Default)]
pub struct SharedPlanes {
    of_facet: Vec<u32>,
    equations: Vec<DVec4>,
    center: DVec3,
}

/// A facet, or all facets of a flat polygon.
#[derive(Clone, Copy, Debug)]
struct Piece {
    /// Unit normal, world space, turned to one side of the world.
    normal: DVec3,
    /// Distance of the plane from the world's centre along the normal.
    distance: f64,
    first_facet: u32,
    facets: u32,
    /// Power of two of its height; below [`LEVELS`] it is too small to have a plane.
    level: u32,
}

/// A plane that is being gathered.
#[derive(Clone, Copy, Debug)]
struct Gathered {
    /// The piece that it is the plane of.
    piece: u32,
    facets: u32,
    /// The plane before it in its cell of the grid.
    next: u32,
}

/// What the gathering is about.
struct World64<'w> {
    world: &'w World,
    center: DVec3,
    /// Diagonal of the world's box.
    size: f64,
    /// Greatest distance from a plane.
    tolerance: f64,
}

impl SharedPlanes {
    /// Finds the planes of a world.
    pub fn new(world: &World, workers: &Workers) -> Self {
        let (center, size) = (world.bounds.center(), world.bounds.size().length());
        if !(size.is_finite() && size > 0.0) {
            return Self::default();
        }
        let world = World64 { world, center, size, tolerance: size * TOLERANCE };
        let pieces = world.pieces(workers);
        let mut of_facet = vec![NO_PLANE; world.world.facet_count as usize];
        let mut planes = world.gather(&pieces, &mut of_facet);
        world.gather_equal(&pieces, &mut planes, &mut of_facet);

        // Number the planes that are shared.
        let mut equations = Vec::new();
        let numbers: Vec<u32> = planes
            .iter()
            .map(|plane| {
                if plane.facets < 2 {
                    return NO_PLANE;
                }
                let piece = &pieces[plane.piece as usize];
                equations.push(piece.normal.extend(-piece.distance));
                equations.len() as u32 - 1
            })
            .collect();
        if equations.is_empty() {
            return Self::default();
        }
        for plane in of_facet.iter_mut().filter(|p| **p != NO_PLANE) {
            *plane = numbers[*plane as usize];
        }
        Self { of_facet, equations, center }
    }

    /// For each of some facets the number of its plane, or [`NO_PLANE`]; empty if no facets share a
    /// plane.
    pub fn of(&self, facets: Range<u32>) -> &[u32] {
        self.of_facet.get(facets.start as usize..facets.end as usize).unwrap_or(&[])
    }

    /// The planes, by number: unit normal `n` and `d`, with `n·(p - center) + d = 0` for points `p`
    /// of world space.
    pub fn equations(&self) -> &[DVec4] {
        &self.equations
    }

    /// The point that the equations are relative to, world space.
    pub fn center(&self) -> DVec3 {
        self.center
    }
}

impl World64<'_> {
    /// The pieces of all instances, in the order of facets.
    fn pieces(&self, workers: &Workers) -> Vec<Piece> {
        let jobs: Vec<_> = (0..self.world.instances.len())
            .flat_map(|i| {
                let faces = self.world.instances[i].mesh.face_count();
                (0..faces)
                    .step_by(FACES_A_JOB)
                    .map(move |first| (i, first..faces.min(first + FACES_A_JOB)))
            })
            .collect();
        let pieces = workers.map(jobs.len(), |job| {
            let (instance, faces) = &jobs[job];
            let mut pieces = Vec::with_capacity(faces.len());
            faces.clone().for_each(|face| self.face(*instance, face, &mut pieces));
            pieces
        });
        let mut all = Vec::with_capacity(pieces.iter().map(Vec::len).sum());
        pieces.into_iter().for_each(|some| all.extend(some));
        all
    }

    /// Adds a face: whole if it is flat, by its triangles otherwise.
    fn face(&self, index: usize, face: usize, pieces: &mut Vec<Piece>) {
        let instance = &self.world.instances[index];
        let triangles = instance.mesh.face_triangles(face);
        let start = pieces.len();
        pieces.extend(triangles.map(|t| self.triangle(instance, instance.first_facet + t as u32)));
        let own = &pieces[start..];
        if own.len() < 2 {
            return;
        }
        let Some(&largest) = own.iter().max_by_key(|piece| piece.level) else { return };
        let corners =
            instance.mesh.face_corners(face).iter().map(|&c| instance.place(c) - self.center);
        if LEVELS.contains(&largest.level) && largest.holds(corners, self.tolerance) {
            let whole =
                Piece { first_facet: own[0].first_facet, facets: own.len() as u32, ..largest };
            pieces.truncate(start);
            pieces.push(whole);
        }
    }

    /// A facet.
    fn triangle(&self, instance: &Instance, facet: u32) -> Piece {
        // Measure its height, the least of the three.
        let [a, b, c] = self.corners(instance, facet);
        let (normal, longest) =
            ((b - a).cross(c - a), (b - a).length_squared().max((c - a).length_squared()));
        let longest = longest.max((c - b).length_squared()).sqrt();
        let area = normal.length();
        let height = area / longest / self.tolerance;
        // Its power of two; below 1, or not a number: no level.
        let whole = height.min(f64::from(u32::MAX)) as u32;
        let level = whole.checked_ilog2().unwrap_or(0).min(LEVELS.end - 1);

        // Turn the normal to one side: any direction will do that models seldom have a plane along.
        let mut normal = normal / area;
        if normal.dot(DVec3::new(0.8137, 0.4391, 0.3803)) < 0.0 {
            normal = -normal;
        }
        let distance = normal.dot((a + b + c) / 3.0);
        Piece { normal, distance, first_facet: facet, facets: 1, level }
    }

    /// Corners of a facet, relative to the world's centre.
    fn corners(&self, instance: &Instance, facet: u32) -> [DVec3; 3] {
        instance.corners(facet - instance.first_facet).map(|p| p - self.center)
    }

    /// Gathers pieces by plane, large ones first.
    fn gather(&self, pieces: &[Piece], of_facet: &mut [u32]) -> Vec<Gathered> {
        // Sort them by height.
        let mut by_level: Vec<Vec<u32>> = vec![Vec::new(); LEVELS.end as usize];
        for (i, piece) in pieces.iter().enumerate() {
            by_level[piece.level as usize].push(i as u32);
        }
        let mut planes: Vec<Gathered> = Vec::new();
        for level in LEVELS.rev() {
            let members = &by_level[level as usize];
            if members.is_empty() {
                continue;
            }

            // Put the planes of larger pieces on this level's coarser grid.
            let mut grid = Grid::new(level, self.size, planes.len() + members.len());
            for (i, plane) in planes.iter_mut().enumerate() {
                let piece = &pieces[plane.piece as usize];
                plane.next = grid.enter(piece.normal, piece.distance, i as u32);
            }

            // Let each piece join the first plane that it lies in, or begin one.
            for &member in members {
                let piece = &pieces[member as usize];
                let number = self.plane_of(piece, &grid, &planes, pieces).unwrap_or_else(|| {
                    let number = planes.len() as u32;
                    let next = grid.enter(piece.normal, piece.distance, number);
                    planes.push(Gathered { piece: member, facets: 0, next });
                    number
                });
                planes[number as usize].facets += piece.facets;
                of_facet[piece.first_facet as usize..][..piece.facets as usize].fill(number);
            }
        }
        planes
    }

    /// The first plane that a piece lies in.
    fn plane_of(
        &self,
        piece: &Piece,
        grid: &Grid,
        planes: &[Gathered],
        pieces: &[Piece],
    ) -> Option<u32> {
        let mut found: Option<u32> = None;
        grid.near(piece.normal, piece.distance, |mut candidate| {
            while candidate != NO_PLANE {
                let Gathered { piece: first, next, .. } = planes[candidate as usize];
                let plane = &pieces[first as usize];
                let close = (plane.normal - piece.normal).length_squared() <= grid.turn * grid.turn
                    && (plane.distance - piece.distance).abs() <= grid.turn * self.size;
                if close && found.is_none_or(|f| candidate < f) && self.lies_in(piece, plane) {
                    found = Some(candidate);
                }
                candidate = next;
            }
        });
        found
    }

    /// The instance that a piece is of.
    fn instance(&self, piece: &Piece) -> &Instance {
        &self.world.instances[self.world.instance_of_facet(piece.first_facet)]
    }

    /// Whether all corners of a piece are in a plane.
    fn lies_in(&self, piece: &Piece, plane: &Piece) -> bool {
        let instance = self.instance(piece);
        let facets = piece.first_facet..piece.first_facet + piece.facets;
        plane.holds(facets.flat_map(|f| self.corners(instance, f)), self.tolerance)
    }

    /// Gathers facets too small to have a plane by their corners.
    fn gather_equal(&self, pieces: &[Piece], planes: &mut Vec<Gathered>, of_facet: &mut [u32]) {
        let mut by_corners: HashMap<[[u64; 3]; 3], u32> = HashMap::new();
        let is_small = |piece: &Piece| piece.level < LEVELS.start && piece.normal.is_finite();
        for (i, piece) in pieces.iter().enumerate().filter(|(_, piece)| is_small(piece)) {
            let corners = self.corners(self.instance(piece), piece.first_facet);
            let mut key = corners.map(|p| p.to_array().map(f64::to_bits));
            key.sort_unstable();
            let number = *by_corners.entry(key).or_insert_with(|| {
                planes.push(Gathered { piece: i as u32, facets: 0, next: NO_PLANE });
                planes.len() as u32 - 1
            });
            planes[number as usize].facets += 1;
            of_facet[piece.first_facet as usize] = number;
        }
    }
}

impl Piece {
    /// Whether points are in its plane.
    fn holds(&self, mut points: impl Iterator<Item = DVec3>, tolerance: f64) -> bool {
        points.all(|p| (self.normal.dot(p) - self.distance).abs() <= tolerance)
    }
}

/// A hash of a cell, taken as it is.
#[derive(Default)]
struct AsItIs(u64);

impl Hasher for AsItIs {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
    }

    fn write_u64(&mut self, value: u64) {
        self.0 = value;
    }
}

/// Planes by normal and distance: a grid of four dimensions of which only the filled cells are
/// kept.
struct Grid {
    cells: HashMap<u64, u32, BuildHasherDefault<AsItIs>>,
    /// How much corners' rounding can turn the facets of this level, radians.
    turn: f64,
    /// Cells a unit of a normal, and a unit of distance.
    scale: [f64; 2],
}

impl Grid {
    /// Cells are four times as wide as what is looked for around a place.
    fn new(level: u32, size: f64, planes: usize) -> Self {
        let turn = 2.0 / f64::from(1 << level);
        let cells = HashMap::with_capacity_and_hasher(planes, BuildHasherDefault::default());
        Self { cells, turn, scale: [0.25 / turn, 0.25 / (turn * size)] }
    }

    /// Where a plane lies on the grid.
    fn place(&self, normal: DVec3, distance: f64) -> [f64; 4] {
        let [n, d] = self.scale;
        [normal.x * n, normal.y * n, normal.z * n, distance * d]
    }

    fn key(cell: [i64; 4]) -> u64 {
        let mixed = cell.iter().fold(0u64, |hash, &c| {
            (hash ^ c.cast_unsigned()).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29)
        });
        mixed ^ mixed >> 32
    }

    /// Puts a plane into its cell, and gives the one that was there, or [`NO_PLANE`].
    fn enter(&mut self, normal: DVec3, distance: f64, number: u32) -> u32 {
        let cell = self.place(normal, distance).map(|v| v.floor() as i64);
        self.cells.insert(Self::key(cell), number).unwrap_or(NO_PLANE)
    }

    /// Calls `visit` with the last plane of each cell that may hold planes near to this one.
    fn near(&self, normal: DVec3, distance: f64, mut visit: impl FnMut(u32)) {
        let place = self.place(normal, distance);
        let low = place.map(|v| (v - 0.25).floor() as i64);
        let high = place.map(|v| (v + 0.25).floor() as i64);
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    for d in low[3]..=high[3] {
                        if let Some(&plane) = self.cells.get(&Self::key([x, y, z, d])) {
                            visit(plane);
                        }
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Faces, Mesh, Node, NodeTransform, Scene};
    use std::sync::Arc;
    use vitral_math::DMat4;

    fn planes(meshes: Vec<(Mesh, DMat4)>) -> (SharedPlanes, World) {
        let mut scene = Scene::default();
        for (mesh, transform) in meshes {
            scene.meshes.push(Arc::new(mesh));
            let mesh = Some(scene.meshes.len() as u32 - 1);
            scene.roots.push(scene.nodes.len() as u32);
            scene.nodes.push(Node {
                mesh,
                transform: NodeTransform::Matrix(transform),
                ..Node::default()
            });
        }
        let world = World::new(&scene).unwrap();
        (SharedPlanes::new(&world, &Workers::single()), world)
    }

    /// A square in z = 0 as a grid of `n` by `n` pairs of triangles, from `low` to `high`.
    fn square(low: f32, high: f32, n: u32) -> Mesh {
        let at = |i: u32| low + (high - low) * i as f32 / n as f32;
        let positions: Vec<_> =
            (0..=n).flat_map(|y| (0..=n).map(move |x| [at(x), at(y), 0.0])).collect();
        let cell = |x: u32, y: u32| {
            let [a, b, c, d] =
                [[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]].map(|[x, y]| y * (n + 1) + x);
            [[a, b, c], [a, c, d]]
        };
        Mesh::new(
            positions,
            (0..n).flat_map(|y| (0..n).flat_map(move |x| cell(x, y))).collect::<Vec<_>>(),
        )
    }

    #[test]
    fn nothing_is_shared_where_all_planes_differ() {
        let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let tetrahedron = Mesh::new(corners, vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]);
        let (shared, world) = planes(vec![(tetrahedron, DMat4::IDENTITY)]);
        assert!(shared.equations().is_empty() && shared.of(0..world.facet_count).is_empty());
    }

    #[test]
    fn decals_of_all_sizes_lie_in_the_plane_of_the_floor() {
        let turned = DMat4::from_rotation_x(0.4) * DMat4::from_rotation_y(1.1);
        let lifted = turned * DMat4::from_translation(DVec3::new(0.0, 0.0, 1e-3));
        let decals = vec![
            (square(-1.0, 1.0, 1), turned),
            (square(0.1, 0.2, 7), turned),
            (square(0.0, 0.01, 3), turned * DMat4::from_rotation_z(0.3)),
            (square(-0.5, 0.5, 100), turned * DMat4::from_rotation_x(std::f64::consts::PI)),
            (square(-0.5, 0.5, 2), lifted),
        ];
        let (shared, world) = planes(decals);
        let above = world.instances[4].first_facet;
        assert_eq!(shared.equations().len(), 2);
        assert!(shared.of(0..above).iter().all(|&p| p == shared.of(0..1)[0]));
        assert!(shared.of(above..world.facet_count).iter().all(|&p| p == 1 - shared.of(0..1)[0]));
    }

    #[test]
    fn the_same_tiny_corners_are_one_plane_in_any_order() {
        let mut corners = vec![[-1.0, -1.0, 0.0], [1.0, 0.0, 0.5], [0.0, 1.0, 3.0]];
        corners.extend([[0.5, 0.5, 0.5], [0.500_001, 0.5, 0.5], [0.5, 0.500_001, 0.500_001]]);
        let tiny = Mesh::new(corners, vec![[0, 1, 2], [3, 4, 5], [5, 4, 3], [4, 5, 3]]);
        let (shared, world) = planes(vec![(tiny, DMat4::IDENTITY)]);
        assert_eq!(shared.of(0..world.facet_count), [NO_PLANE, 0, 0, 0]);
    }

    #[test]
    fn a_flat_polygon_is_in_one_plane_and_a_bent_one_is_not() {
        let corners = vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 2.0, 0.5],
        ];
        let faces =
            Faces::Polygons { starts: vec![0, 4, 8], corners: vec![0, 1, 2, 3, 3, 2, 1, 4] };
        let triangles = vec![[0, 1, 2], [0, 2, 3], [3, 2, 1], [3, 1, 4]];
        let (shared, _) =
            planes(vec![(Mesh { faces, ..Mesh::new(corners, triangles) }, DMat4::IDENTITY)]);
        assert_eq!(shared.of(0..4), [0, 0, 0, NO_PLANE]);
    }
}
