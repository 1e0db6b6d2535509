//! Convex polygons in the world: the faces of the file as a BSP tree cuts them.
//!
//! The triangles of a face that lie in one plane of the world are joined over the edges that they
//! share, as long as the outline stays convex: a flat convex face is one polygon, another flat face
//! a few, a face that is not flat its triangles. Which facets lie in one plane is found once for
//! all algorithms ([`SharedPlanes`]), so two polygons are coplanar if their planes have one number,
//! however their corners were rounded.
//!
//! In:   the world's facets and planes (world space). Out: polygons, in the order of their first
//!       facets.
//! Cost: linear in triangles; for a face, its triangles times the polygons it comes out as.
//! Source: the joining of triangles after [Hertel & Mehlhorn 1983].

use super::super::polygons::{JoinedOutline, RECENT};
use crate::Execution;
use crate::prepare::mirrors;
use vitral_exec::Limit;
use vitral_math::{DVec3, DVec4};
use vitral_scene::planes::{NO_PLANE, TOLERANCE};
use vitral_scene::{Instance, SharedPlanes, World};

/// The polygons of a world: facets of one plane, joined as long as outlines stay convex.
#[derive(Debug, Default)]
pub(super) struct WorldPolygons {
    pub(super) facets: PolygonFacets,
    /// Where each polygon's corners begin, and the end of the last ones.
    corner_starts: Vec<u32>,
    /// Corners, counter-clockwise for whom the polygon faces.
    corners: Vec<DVec3>,
    /// The number of each polygon's plane, or [`NO_PLANE`].
    planes: Vec<u32>,
    /// The planes by number, world space.
    equations: Vec<DVec4>,
    /// How far a corner may be off a plane that its polygon lies in, world units.
    pub(super) tolerance: f64,
}

/// The facets of each polygon.
#[derive(Debug, Default)]
pub(super) struct PolygonFacets {
    /// Where those of each polygon begin, and the end of the last ones.
    starts: Vec<u32>,
    facets: Vec<u32>,
}

/// A polygon of a face that is being joined.
struct Growing {
    plane: u32,
    facets: Vec<u32>,
    /// Vertices of the mesh.
    outline: JoinedOutline<u32>,
}

impl PolygonFacets {
    /// The facets of a polygon, the lowest first.
    pub(super) fn of(&self, polygon: u32) -> &[u32] {
        let [start, end] = [0, 1].map(|k| self.starts[polygon as usize + k] as usize);
        &self.facets[start..end]
    }

    /// How many polygons there are.
    pub(super) fn len(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// The facet by which a polygon is named: its first.
    pub(super) fn name(&self, polygon: u32) -> u32 {
        self.facets[self.starts[polygon as usize] as usize]
    }

    /// Bytes in memory.
    pub(super) fn bytes(&self) -> u64 {
        (size_of_val(self.starts.as_slice()) + size_of_val(self.facets.as_slice())) as u64
    }
}

impl WorldPolygons {
    /// Joins the facets of a world. Charges the budget for [`Self::bytes`].
    pub(super) fn new(
        world: &World,
        planes: &SharedPlanes,
        execution: &Execution,
    ) -> Result<Self, Limit> {
        // Charge for the worst case: each facet a polygon of its own.
        let count = world.facet_count as usize;
        let most = count as u64 * (3 * size_of::<DVec3>() + 4 * size_of::<u32>()) as u64;
        execution.budget.charge(most, "the BSP tree")?;
        let mut polygons = Self {
            facets: PolygonFacets {
                starts: Vec::with_capacity(count + 1),
                facets: Vec::with_capacity(count),
            },
            corner_starts: Vec::with_capacity(count + 1),
            corners: Vec::with_capacity(count * 3),
            planes: Vec::with_capacity(count),
            equations: in_world(planes),
            tolerance: world.bounds.size().length() * TOLERANCE,
        };

        // Join the facets of each instance.
        for instance in &world.instances {
            let first = instance.first_facet;
            polygons.add_instance(
                instance,
                planes.of(first..first + instance.mesh.triangles.len() as u32),
            );
        }
        polygons.end();

        // Replace the worst case by what was used.
        execution.budget.release(most);
        execution.budget.charge(polygons.bytes(), "the BSP tree")?;
        Ok(polygons)
    }

    /// Triangles in no common plane, each a polygon; their facets are their indices.
    #[cfg(test)]
    pub(super) fn of_triangles(triangles: &[[DVec3; 3]]) -> Self {
        let mut polygons = Self::default();
        for (facet, corners) in (0..).zip(triangles) {
            polygons.push(&[facet], corners.iter().copied(), NO_PLANE);
        }
        polygons.end();
        polygons
    }

    /// Adds the polygons of an instance; `planes` are the numbers of its facets' planes, none if no
    /// planes are shared.
    fn add_instance(&mut self, instance: &Instance, planes: &[u32]) {
        let mesh = &instance.mesh;
        let mirrored = mirrors(&instance.world_from_model);
        let mut growing: Vec<Growing> = Vec::new();

        // Add lone triangles as they are, and join the triangles of larger faces.
        for face in 0..mesh.face_count() {
            let triangles = mesh.face_triangles(face);
            if triangles.len() == 1 {
                let triangle = triangles.start;
                let plane = planes.get(triangle).copied().unwrap_or(NO_PLANE);
                let outline = &mesh.triangles[triangle];
                self.push_placed(
                    instance,
                    mirrored,
                    (&[instance.first_facet + triangle as u32], outline, plane),
                );
                continue;
            }
            for triangle in triangles {
                let plane = planes.get(triangle).copied().unwrap_or(NO_PLANE);
                self.join(instance, triangle, plane, &mut growing);
            }
            for done in growing.drain(..) {
                self.push_placed(
                    instance,
                    mirrored,
                    (&done.facets, &done.outline.corners, done.plane),
                );
            }
        }
    }

    /// Adds a triangle of a mesh to one of the polygons of its face, or begins one.
    fn join(&self, instance: &Instance, triangle: usize, plane: u32, growing: &mut Vec<Growing>) {
        let (facet, corners) =
            (instance.first_facet + triangle as u32, instance.mesh.triangles[triangle]);

        // Try to join the triangle to a recent polygon of its plane, as long as that stays convex.
        let (recent, in_plane) =
            (growing.len().saturating_sub(RECENT), |polygon: &&mut Growing| polygon.plane == plane);
        let joined = plane != NO_PLANE
            && growing[recent..].iter_mut().filter(in_plane).any(|polygon| {
                let turns =
                    Turns::new(instance, corners, self.equation(plane).truncate(), self.tolerance);
                let joined = polygon.outline.add(corners, |a, b, c| turns.is_convex([a, b, c]));
                if joined {
                    polygon.facets.push(facet);
                }
                joined
            });

        // Otherwise begin a polygon.
        if !joined {
            growing.push(Growing {
                plane,
                facets: vec![facet],
                outline: JoinedOutline::new(corners),
            });
        }
    }

    /// Adds a polygon of an instance: its facets, the vertices round it, and its plane.
    fn push_placed(
        &mut self,
        instance: &Instance,
        mirrored: bool,
        (facets, outline, plane): (&[u32], &[u32], u32),
    ) {
        let places = outline.iter().map(|&vertex| instance.place(vertex));
        if mirrored {
            self.push(facets, places.rev(), plane);
        } else {
            self.push(facets, places, plane);
        }
    }

    fn push(&mut self, facets: &[u32], corners: impl Iterator<Item = DVec3>, plane: u32) {
        self.facets.starts.push(self.facets.facets.len() as u32);
        self.facets.facets.extend(facets);
        self.corner_starts.push(self.corners.len() as u32);
        self.corners.extend(corners);
        self.planes.push(plane);
    }

    /// Notes where the last polygon ends.
    fn end(&mut self) {
        self.facets.starts.push(self.facets.facets.len() as u32);
        self.corner_starts.push(self.corners.len() as u32);
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.planes.len()
    }

    /// The corners of a polygon.
    pub(super) fn corners(&self, polygon: u32) -> &[DVec3] {
        let [start, end] = [0, 1].map(|k| self.corner_starts[polygon as usize + k] as usize);
        &self.corners[start..end]
    }

    /// The number of a polygon's plane, if it may share it with others.
    pub(super) fn plane(&self, polygon: u32) -> Option<u32> {
        Some(self.planes[polygon as usize]).filter(|&plane| plane != NO_PLANE)
    }

    /// The plane of this number: unit normal and offset.
    pub(super) fn equation(&self, plane: u32) -> DVec4 {
        self.equations[plane as usize]
    }

    /// Twice the area, along the normal that points to whom a polygon faces.
    pub(super) fn doubled_area(&self, polygon: u32) -> DVec3 {
        doubled_area(self.corners(polygon))
    }

    /// Bytes in memory.
    pub(super) fn bytes(&self) -> u64 {
        let numbers = self.corner_starts.len() + self.planes.len();
        let bytes = size_of_val(self.corners.as_slice())
            + size_of_val(self.equations.as_slice())
            + numbers * 4;
        self.facets.bytes() + bytes as u64
    }
}

/// Twice the area of a polygon, along its normal.
fn doubled_area(corners: &[DVec3]) -> DVec3 {
    let fan =
        corners.windows(2).skip(1).map(|edge| (edge[0] - corners[0]).cross(edge[1] - corners[0]));
    fan.fold(DVec3::ZERO, |sum, part| sum + part)
}

/// The planes in world space.
fn in_world(planes: &SharedPlanes) -> Vec<DVec4> {
    let center = planes.center();
    planes.equations().iter().map(|e| e.truncate().extend(e.w - e.truncate().dot(center))).collect()
}

/// Which way corners turn that follow each other in a plane.
struct Turns<'i> {
    instance: &'i Instance,
    /// The normal about which the face turns counter-clockwise.
    normal: DVec3,
    tolerance: f64,
}

impl<'i> Turns<'i> {
    /// About the normal of a plane, on the side from which a triangle turns counter-clockwise.
    fn new(instance: &'i Instance, triangle: [u32; 3], normal: DVec3, tolerance: f64) -> Self {
        let [a, b, c] = triangle.map(|vertex| instance.place(vertex));
        let normal = if (b - a).cross(c - a).dot(normal) < 0.0 { -normal } else { normal };
        Self { instance, normal, tolerance }
    }

    /// Whether three corners turn that way or go straight on. A corner that is off the straight
    /// line by no more than positions are rounded lies on it.
    fn is_convex(&self, corners: [u32; 3]) -> bool {
        let [a, b, c] = corners.map(|vertex| self.instance.place(vertex));
        let turn = (b - a).cross(c - a).dot(self.normal);
        turn >= -self.tolerance * (c - a).length()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use vitral_exec::Workers;
    use vitral_math::DMat4;
    use vitral_scene::{Faces, Mesh, Node, NodeTransform, Scene};

    /// The polygons of faces given by their corners in the plane z = x / 3, each with its fan of
    /// triangles.
    fn polygons(faces: &[&[[f32; 2]]], transform: DMat4) -> WorldPolygons {
        let (mut positions, mut triangles, mut starts, mut corners) =
            (Vec::new(), Vec::new(), vec![0], Vec::new());
        for face in faces {
            let first = positions.len() as u32;
            positions.extend(face.iter().map(|&[x, y]| [x, y, x / 3.0]));
            corners.extend(first..first + face.len() as u32);
            triangles.extend((1..face.len() as u32 - 1).map(|i| [first, first + i, first + i + 1]));
            starts.push(corners.len() as u32);
        }
        let mesh =
            Mesh { faces: Faces::Polygons { starts, corners }, ..Mesh::new(positions, triangles) };
        let mut scene = Scene { meshes: vec![Arc::new(mesh)], roots: vec![0], ..Scene::default() };
        scene.nodes.push(Node {
            mesh: Some(0),
            transform: NodeTransform::Matrix(transform),
            ..Node::default()
        });
        let world = World::new(&scene).unwrap();
        let planes = SharedPlanes::new(&world, &Workers::single());
        WorldPolygons::new(&world, &planes, &Execution::default()).unwrap()
    }

    const HEXAGON: &[[f32; 2]] =
        &[[4.0, 0.0], [8.0, 0.0], [12.0, 6.0], [8.0, 12.0], [4.0, 12.0], [0.0, 6.0]];

    #[test]
    fn flat_convex_faces_are_one_polygon_each() {
        let square: &[[f32; 2]] = &[[20.0, 0.0], [30.0, 0.0], [30.0, 10.0], [20.0, 10.0]];
        let turned = DMat4::from_rotation_x(0.4) * DMat4::from_rotation_y(1.1);
        for transform in
            [DMat4::IDENTITY, turned, turned * DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0))]
        {
            let polygons = polygons(&[HEXAGON, square], transform);
            assert_eq!(
                (polygons.len(), polygons.corners(0).len(), polygons.corners(1).len()),
                (2, 6, 4)
            );
            assert_eq!(
                (polygons.facets.of(0), polygons.facets.of(1)),
                (&[0, 1, 2, 3][..], &[4, 5][..])
            );
            assert_eq!(polygons.facets.name(1), 4);
            assert!(polygons.plane(0).is_some() && polygons.plane(0) == polygons.plane(1));
            // Both face the same side, that of z upwards in the mesh.
            let up = transform.transform_vector3(DVec3::Z);
            assert!((0..2).all(|p| polygons.doubled_area(p).dot(up) > 0.0));
            let equation = polygons.equation(polygons.plane(0).unwrap());
            let off = polygons
                .corners(0)
                .iter()
                .map(|p| equation.dot(p.extend(1.0)).abs())
                .fold(0.0, f64::max);
            assert!(off <= polygons.tolerance, "{off}");
        }
    }

    #[test]
    fn a_flat_face_with_a_notch_is_a_few_polygons() {
        // A fan from the notch's corner reaches all others.
        let face: &[[f32; 2]] =
            &[[4.0, 4.0], [12.0, 4.0], [12.0, 8.0], [0.0, 8.0], [0.0, 0.0], [4.0, 0.0]];
        let polygons = polygons(&[face], DMat4::IDENTITY);
        assert_eq!(polygons.len(), 2);
        let areas: f64 = (0..2).map(|p| polygons.doubled_area(p).z * 0.5).sum();
        assert!((areas - 64.0).abs() < 1e-9, "{areas}");
    }
}
