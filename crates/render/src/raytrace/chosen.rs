//! The structure that was chosen for rays which begin at surfaces: mirrored and bent ones, and those to lights.
//!
//! Through the tree of boxes they go eight at a time (`packet.rs`), through every other structure one after the other. What a
//! ray is told is the same: each triangle that it hits, once, whatever else the structure shows it. Only the order may be
//! another, and who asks must not depend on it.
//!
//! In:   rays in the space of the structure's triangles. Out: triangles that they hit.
//! Cost: that of the structure.
//! Source: that of the structure.

use super::beam::Beam;
use super::bsp::Bsp;
use super::bvh::Bvh;
use super::grid::Grid;
use super::intersect::Ray;
use super::octree::Octree;
use super::packet::{PacketVisitor, closest_hits};
use super::triangles::Triangles;
use super::volumes::{Shape, Volumes};
use super::{Counters, Structure, Visitor};
use crate::{Acceleration, Execution, Session};
use std::sync::Arc;
use vitral_exec::Limit;
use vitral_math::lanes::{LANES, Simd};

/// See the module.
#[derive(Debug)]
pub(crate) enum Chosen {
    Bvh(Arc<Bvh>),
    Octree(Arc<Octree>),
    Bsp(Arc<Bsp>),
    Grid(Arc<Grid>),
    Volumes(Arc<Volumes>),
    List(Arc<Triangles>),
}

/// Runs `$body` with the structure itself.
macro_rules! with {
    ($chosen:expr, $structure:ident => $body:expr) => {
        match $chosen {
            Chosen::Bvh($structure) => $body,
            Chosen::Octree($structure) => $body,
            Chosen::Bsp($structure) => $body,
            Chosen::Grid($structure) => $body,
            Chosen::Volumes($structure) => $body,
            Chosen::List($structure) => $body,
        }
    };
}

impl Chosen {
    /// Bytes needed while a structure over this many triangles is built.
    pub(crate) fn bytes(acceleration: Acceleration, triangles: u64) -> u64 {
        match acceleration {
            Acceleration::Bvh => Bvh::bytes(triangles),
            Acceleration::Octree => Octree::bytes(triangles),
            Acceleration::Bsp => Bsp::bytes(triangles),
            Acceleration::Grid => Grid::bytes(triangles),
            Acceleration::Box | Acceleration::OrientedBox | Acceleration::Sphere => Volumes::bytes(triangles),
            Acceleration::None => 0,
        }
    }

    /// The session's.
    pub(crate) fn new(acceleration: Acceleration, session: &Session, execution: &Execution) -> Result<Self, Limit> {
        Ok(match acceleration {
            Acceleration::Bvh => Self::Bvh(session.bvh(execution)?),
            Acceleration::Octree => Self::Octree(session.octree(execution)?),
            Acceleration::Bsp => Self::Bsp(session.partition(execution)?),
            Acceleration::Grid => Self::Grid(session.uniform_grid(execution)?),
            Acceleration::Box => Self::Volumes(session.volumes(Shape::Aligned, execution)?),
            Acceleration::OrientedBox => Self::Volumes(session.volumes(Shape::Oriented, execution)?),
            Acceleration::Sphere => Self::Volumes(session.volumes(Shape::Sphere, execution)?),
            Acceleration::None => Self::List(session.triangles(execution)?),
        })
    }

    /// See [`Structure::triangles`].
    #[inline]
    pub(crate) fn triangles(&self) -> &Triangles {
        with!(self, structure => structure.triangles())
    }

    /// See [`Structure::traverse`]. A triangle may be shown several times.
    pub(crate) fn traverse(&self, beam: &Beam, visitor: &mut impl Visitor) -> u64 {
        with!(self, structure => structure.traverse(beam, visitor))
    }

    /// See [`Bvh::closest_hits`].
    pub(crate) fn closest_hits<S: Simd>(
        &self,
        simd: S,
        rays: &[Ray],
        own: &[u32],
        counters: &mut Counters,
    ) -> ([Option<(usize, f32)>; LANES], [bool; LANES]) {
        match self {
            Self::Bvh(tree) => tree.closest_hits(simd, rays, own, counters),
            _ => closest_hits(self.triangles(), rays, own, |visitor| self.follow(simd, rays, visitor, counters)),
        }
    }

    /// Shows `visitor` what one to eight rays meet, each triangle once.
    #[inline(always)]
    pub(crate) fn follow<S: Simd>(
        &self,
        simd: S,
        rays: &[Ray],
        visitor: &mut impl PacketVisitor,
        counters: &mut Counters,
    ) {
        match self {
            Self::Bvh(tree) => tree.follow(simd, rays, visitor, counters),
            Self::Octree(structure) => one_by_one(&**structure, rays, visitor, counters),
            Self::Bsp(structure) => one_by_one(&**structure, rays, visitor, counters),
            Self::Grid(structure) => one_by_one(&**structure, rays, visitor, counters),
            Self::Volumes(structure) => one_by_one(&**structure, rays, visitor, counters),
            Self::List(structure) => one_by_one(&**structure, rays, visitor, counters),
        }
    }
}

/// Shows a packet's visitor what each ray of it meets.
fn one_by_one<T: Structure>(structure: &T, rays: &[Ray], visitor: &mut impl PacketVisitor, counters: &mut Counters) {
    let triangles = structure.triangles();
    let mut hit = Vec::new();
    for (lane, ray) in rays.iter().enumerate() {
        let mut alone = Alone::<T, _> { structure, ray, lane, visitor, hit: &mut hit, tests: 0 };
        counters.boxes += structure.traverse(&Beam::around(ray, triangles.extent), &mut alone);
        counters.triangles += alone.tests;
        hit.clear();
    }
}

/// One ray of a packet, whose visitor is told what it hits.
struct Alone<'a, T, V> {
    structure: &'a T,
    ray: &'a Ray,
    lane: usize,
    visitor: &'a mut V,
    /// Places of the triangles that it was told of, where the structure shows some again.
    hit: &'a mut Vec<usize>,
    tests: u64,
}

impl<T: Structure, V: PacketVisitor> Visitor for Alone<'_, T, V> {
    #[inline(always)]
    fn skips(&self, _: usize, near: f32) -> bool {
        self.done(near)
    }

    #[inline(always)]
    fn done(&self, near: f32) -> bool {
        near > self.visitor.limits()[self.lane]
    }

    #[inline(always)]
    fn triangle(&mut self, place: usize) {
        self.tests += 1;
        let Some(t) = self.ray.hit(&self.structure.triangles().corners[place]) else { return };
        if T::REPEATS {
            if self.hit.contains(&place) {
                return;
            }
            self.hit.push(place);
        }
        self.visitor.hit(self.lane, place, t);
    }
}
