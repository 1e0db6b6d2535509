//! The table of structures that find the triangles near a ray, and the one that was chosen.
//!
//! A new structure is its file and its row here. The row names its type; `AnyStructure` is one of
//! these types, and code that is written for any structure runs with the type itself, so that
//! choosing costs one branch for each packet of rays.
//!
//! What a ray is told is the same with every structure: each triangle that it hits, once. Only the
//! order may be another, and who asks must not depend on it.
//!
//! In:   rays in the space of the structure's triangles. Out: triangles that they hit.
//! Cost: that of the structure.
//! Source: that of the structure.

use super::beam::Beam;
use super::bsp::KdTree;
use super::bvh::Bvh;
use super::follow::{Follow, StructureUser};
use super::grid::Grid;
use super::intersect::Ray;
use super::octree::Octree;
use super::packet::PacketVisitor;
use super::triangles::Triangles;
use super::volumes::{Shape, Volumes};
use super::{Counters, Structure, Visitor};
use crate::catalogue::{Acceleration, AccelerationInfo};
use crate::choice::table;
use crate::{Execution, Session};
use std::sync::Arc;
use vitral_exec::Limit;
use vitral_math::lanes::{LANES, Simd};

/// A structure that finds the triangles near a ray: what is known of it, and how it is built.
pub struct AccelerationStructure {
    /// What faces list.
    pub info: AccelerationInfo,
    /// Bytes needed while a structure over this many triangles is built.
    bytes: fn(u64) -> u64,
    /// The session's structure, built when first asked for.
    build: fn(&Session, &Execution) -> Result<AnyStructure, Limit>,
}

/// Makes the table and [`AnyStructure`] of one row for each structure.
macro_rules! structures {
    ($($(#[$doc:meta])* $name:ident = $variant:ident($type:ty) { bytes: $bytes:expr, build: $build:expr, info: $info:expr, })*) => {
        /// The structure that was chosen.
        #[derive(Debug)]
        pub(crate) enum AnyStructure {
            $($variant(Arc<$type>),)*
        }

        /// Runs `$body` with the structure itself.
        macro_rules! with {
            ($any:expr, $structure:ident => $body:expr) => {
                match $any {
                    $(AnyStructure::$variant($structure) => $body,)*
                }
            };
        }

        table! {
            /// All structures for rays, the default first.
            ACCELERATION: AccelerationStructure of AccelerationInfo, "acceleration structure";

            $($(#[$doc])* $name = AccelerationStructure {
                info: $info,
                bytes: $bytes,
                build: |session, execution| {
                    let build: fn(&Session, &Execution) -> Result<Arc<$type>, Limit> = $build;
                    build(session, execution).map(AnyStructure::$variant)
                },
            };)*
        }
    };
}

structures! {
    /// A tree of boxes round triangles.
    BVH = Bvh(Bvh) {
        bytes: Bvh::bytes,
        build: Bvh::of,
        info: AccelerationInfo {
            name: "bvh",
            description: "a tree of boxes round triangles, cut by the surface area heuristic",
            source: "MacDonald & Booth 1990",
            grows_slowly: true,
            asks_all: false,
        },
    }
    /// A cube cut in eight, again and again.
    OCTREE = Octree(Octree) {
        bytes: Octree::bytes,
        build: Octree::of,
        info: AccelerationInfo {
            name: "octree",
            description: "a cube cut in eight where there is much, and its parts again",
            source: "Glassner 1984",
            grows_slowly: true,
            asks_all: false,
        },
    }
    /// A box cut in two across an axis, again and again.
    BSP = KdTree(KdTree) {
        bytes: KdTree::bytes,
        build: KdTree::of,
        info: AccelerationInfo {
            name: "bsp",
            description: "a box cut in two across an axis where rays have least to do, and its parts again",
            source: "Kaplan 1985",
            grows_slowly: true,
            asks_all: false,
        },
    }
    /// Equal cells.
    GRID = Grid(Grid) {
        bytes: Grid::bytes,
        build: Grid::of,
        info: AccelerationInfo {
            name: "grid",
            description: "equal cells, which a ray passes one by one",
            source: "Amanatides & Woo 1987",
            grows_slowly: true,
            asks_all: false,
        },
    }
    /// A box along the axes round each object.
    BOX = AlignedBoxes(Volumes) {
        bytes: Volumes::bytes,
        build: |session, execution| Volumes::of(session, Shape::Aligned, execution),
        info: AccelerationInfo {
            name: "box",
            description: "a box along the axes round each object, before its triangles",
            source: "Rubin & Whitted 1980",
            grows_slowly: false,
            asks_all: false,
        },
    }
    /// A turned box round each object.
    ORIENTED_BOX = OrientedBoxes(Volumes) {
        bytes: Volumes::bytes,
        build: |session, execution| Volumes::of(session, Shape::Oriented, execution),
        info: AccelerationInfo {
            name: "oriented-box",
            description: "a box that is turned to fit, round each object",
            source: "Gottschalk, Lin & Manocha 1996",
            grows_slowly: false,
            asks_all: false,
        },
    }
    /// A sphere round each object.
    SPHERE = Spheres(Volumes) {
        bytes: Volumes::bytes,
        build: |session, execution| Volumes::of(session, Shape::Sphere, execution),
        info: AccelerationInfo {
            name: "sphere",
            description: "a sphere round each object",
            source: "Ritter 1990",
            grows_slowly: false,
            asks_all: false,
        },
    }
    /// Every triangle is asked.
    NONE = List(Triangles) {
        bytes: |_| 0,
        build: Triangles::of,
        info: AccelerationInfo {
            name: "none",
            description: "every ray asks every triangle",
            source: "Appel 1968",
            grows_slowly: false,
            asks_all: true,
        },
    }
}

/// The row of a choice.
fn row(acceleration: Acceleration) -> &'static AccelerationStructure {
    let row = ACCELERATION.iter().find(|row| row.name == acceleration.name);
    row.expect("a choice is made of a row")
}

impl AnyStructure {
    /// Bytes needed while a structure over this many triangles is built.
    pub(crate) fn bytes(acceleration: Acceleration, triangles: u64) -> u64 {
        (row(acceleration).bytes)(triangles)
    }

    /// The session's.
    pub(crate) fn new(
        acceleration: Acceleration,
        session: &Session,
        execution: &Execution,
    ) -> Result<Self, Limit> {
        (row(acceleration).build)(session, execution)
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

    /// See [`Follow::lend`].
    pub(crate) fn lend<U: StructureUser>(&self, user: U) -> U::Outcome {
        with!(self, structure => structure.lend(user))
    }

    /// See [`Follow::closest_hits`].
    pub(crate) fn closest_hits<S: Simd>(
        &self,
        simd: S,
        rays: &[Ray],
        own: &[u32],
        counters: &mut Counters,
    ) -> ([Option<(usize, f32)>; LANES], [bool; LANES]) {
        with!(self, structure => structure.closest_hits(simd, rays, own, counters))
    }

    /// See [`Follow::follow`].
    #[inline(always)]
    pub(crate) fn follow<S: Simd>(
        &self,
        simd: S,
        rays: &[Ray],
        visitor: &mut impl PacketVisitor,
        counters: &mut Counters,
    ) {
        with!(self, structure => structure.follow(simd, rays, visitor, counters));
    }
}
