//! What painter's algorithm and BSP trees tell about their lists and nodes.
//!
//! Polygons are named by the id of their first facet: the flat convex face that they are, or a part
//! of it.

use serde::Serialize;

/// A polygon in the first order of the painter's list.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ListedPolygon {
    /// Its number, by which later steps name it.
    pub polygon: u32,
    /// Its first facet.
    pub facet: u32,
    /// Its farthest depth, 1 on the near plane, 0 on the far plane.
    pub far: f32,
    /// Its nearest depth, 1 on the near plane, 0 on the far plane.
    pub near: f32,
}

/// What decided which of two polygons is painted first: P is to be painted, Q waits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ListTest {
    /// Before the five tests: P's extent in depth is farther than Q's.
    DepthExtent,
    /// First test: their extents in x do not overlap.
    XExtent,
    /// Second test: their extents in y do not overlap.
    YExtent,
    /// Third test: P lies behind the plane of Q; or in it, and facing and facet put it first.
    BehindPlane,
    /// Fourth test: Q lies in front of the plane of P; or in it, and facing and facet put it last.
    InFrontOfPlane,
    /// Fifth test: their projections do not overlap.
    Projection,
    /// The third test with the roles exchanged: Q lies behind the plane of P.
    ExchangedBehind,
    /// The fourth test with the roles exchanged: P lies in front of the plane of Q.
    ExchangedInFront,
    /// Both lie in one plane: the one that faces the viewer is painted last; of two that face one
    /// way, the lower facet.
    Coplanar,
    /// After all tests: the depths in the overlap of the projections.
    Overlap,
}

impl ListTest {
    /// In words, for polygons of these names.
    pub fn describe(self, p: u32, q: u32) -> String {
        match self {
            Self::DepthExtent => format!("all of {p} is farther than {q}"),
            Self::XExtent => "test 1: the extents in x do not overlap".to_owned(),
            Self::YExtent => "test 2: the extents in y do not overlap".to_owned(),
            Self::BehindPlane => format!("test 3: {p} lies behind the plane of {q}"),
            Self::InFrontOfPlane => format!("test 4: {q} lies in front of the plane of {p}"),
            Self::Projection => "test 5: the projections do not overlap".to_owned(),
            Self::ExchangedBehind => format!("test 3 exchanged: {q} lies behind the plane of {p}"),
            Self::ExchangedInFront => {
                format!("test 4 exchanged: {p} lies in front of the plane of {q}")
            }
            Self::Coplanar => "both lie in one plane: facing and facet decide".to_owned(),
            Self::Overlap => "the depths where the projections overlap".to_owned(),
        }
    }
}

/// Whether P may be painted before Q.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ListVerdict {
    /// P does not cover Q.
    Before,
    /// Q has to be painted first.
    After,
    /// Each covers a part of the other.
    Across,
}

/// A side of a plane of a BSP tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PlaneSide {
    /// The side that the normal `(a, b, c)` points to.
    Front,
    /// The other one.
    Back,
}

impl PlaneSide {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Front => "front",
            Self::Back => "back",
        }
    }
}

/// A set of polygons or their parts: how many, and the first few.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PolygonSet {
    /// How many there are.
    pub count: u32,
    /// The first facets of the first [`PolygonSet::MAX_NAMED`] of them, in the order of the set.
    pub facets: Vec<u32>,
}

impl PolygonSet {
    /// Polygons that are named.
    pub const MAX_NAMED: usize = 64;

    /// Those with these first facets.
    pub fn new(facets: impl IntoIterator<Item = u32>) -> Self {
        let mut set = Self::default();
        for facet in facets {
            set.count += 1;
            if set.facets.len() < Self::MAX_NAMED {
                set.facets.push(facet);
            }
        }
        set
    }
}

/// A sample at which the depth function contradicted the order of a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct OverruledSample {
    /// Column and row, pixels from the top left.
    pub pixel: [u32; 2],
    /// Which sample of the pixel.
    pub sample: u32,
    /// The facet that the list alone would show.
    pub by_list: u32,
    /// The facet that is nearer, and seen.
    pub by_depth: u32,
}
