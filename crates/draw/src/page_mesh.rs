//! The scene on the page: vertices on an integer grid, triangles that hide, and edges that may be
//! drawn.

use crate::classes::Classes;
use vitral_math::exact::{GridPlane, GridPoint};

/// No triangle, vertex or material.
pub(crate) const NONE: u32 = u32::MAX;

/// Units of the grid along the longer side of the page. A page of 200 mm has steps of a twentieth
/// of a micrometre.
pub(crate) const PAGE_UNITS: i32 = 1 << 22;

/// The scene on the page. Everything is counter-clockwise as the viewer sees it; z grows towards
/// the viewer.
#[derive(Debug, Default)]
pub(crate) struct PageMesh {
    /// Size of the page in units.
    pub(crate) size: [i32; 2],
    /// Vertices, snapped.
    pub(crate) vertices: Vec<GridPoint>,
    /// All triangles that are on the page.
    pub(crate) triangles: Vec<Triangle>,
    /// What each triangle was cut from.
    pub(crate) sources: Vec<Source>,
    /// Edges, each once, those of the faces first and then those of intersections.
    pub(crate) edges: Vec<Edge>,
    /// The triangles at the edges, edge by edge.
    pub(crate) edge_triangles: Vec<u32>,
    /// Free points, as vertices, each once.
    pub(crate) points: Vec<u32>,
    /// For each triangle a rank: of coplanar triangles, the one of the lowest rank is in front.
    /// Empty: all are equal.
    pub(crate) ranks: Vec<u32>,
}

/// A triangle on the page.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    /// The box round it on the page, inclusive.
    pub(crate) low: [i32; 2],
    /// See `low`.
    pub(crate) high: [i32; 2],
    /// Depth of its nearest corner.
    pub(crate) nearest: i32,
    /// Corners, counter-clockwise on the page.
    pub(crate) corners: [GridPoint; 3],
    /// The same, as vertices.
    pub(crate) vertices: [u32; 3],
    /// Whether lines behind it are hidden by it: it has an area on the page and is not the back of
    /// a solid body.
    pub(crate) hides: bool,
    /// Whether it is filled and hides nothing, since light passes it.
    pub(crate) clear: bool,
    /// 1 where the file's front is seen, -1 where its back is, 0 where it is seen edge-on.
    pub(crate) facing: i8,
}

/// Where a triangle comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Source {
    /// Number of the facet in the world.
    pub(crate) facet: u32,
    /// Surface id of its face.
    pub(crate) surface: u32,
    /// Index into the scene's materials, or [`NONE`].
    pub(crate) material: u32,
    /// Unit normal of the face, world space.
    pub(crate) normal: [f32; 3],
}

/// An edge of faces, a free line, or the line in which two triangles intersect.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    /// Its ends, the lower vertex first.
    pub(crate) ends: [u32; 2],
    /// Where its triangles begin in [`PageMesh::edge_triangles`], and how many there are.
    pub(crate) first: u32,
    /// See `first`.
    pub(crate) count: u32,
    /// What it may be drawn as.
    pub(crate) classes: Classes,
}

impl PageMesh {
    /// The ends of an edge on the grid.
    #[inline]
    pub(crate) fn ends(&self, edge: &Edge) -> [GridPoint; 2] {
        edge.ends.map(|v| self.vertices[v as usize])
    }

    /// The place of a triangle in the order of coplanar ones: by rank, then by number.
    #[inline]
    pub(crate) fn order_of(&self, triangle: u32) -> (u32, u32) {
        (self.ranks.get(triangle as usize).copied().unwrap_or(0), triangle)
    }

    /// The triangles at an edge: a line lies in them and is not hidden by them.
    #[inline]
    pub(crate) fn triangles_at(&self, edge: &Edge) -> &[u32] {
        &self.edge_triangles[edge.first as usize..(edge.first + edge.count) as usize]
    }
}

impl Triangle {
    /// A triangle of the file's winding, turned counter-clockwise if need be.
    pub(crate) fn new(mut corners: [GridPoint; 3], mut vertices: [u32; 3]) -> Self {
        let area = vitral_math::exact::orient2d(corners[0], corners[1], corners[2]);
        if area < 0 {
            corners.swap(1, 2);
            vertices.swap(1, 2);
        }
        let of = |k: usize| corners.map(|p| p[k]);
        let low = [0, 1].map(|k| of(k).into_iter().fold(i32::MAX, i32::min));
        let high = [0, 1].map(|k| of(k).into_iter().fold(i32::MIN, i32::max));
        let nearest = of(2).into_iter().fold(i32::MIN, i32::max);
        Self {
            low,
            high,
            nearest,
            corners,
            vertices,
            hides: area != 0,
            clear: false,
            facing: area.signum() as i8,
        }
    }

    /// Its plane, exact on the grid of the page.
    #[inline(always)]
    pub(crate) fn plane(&self) -> GridPlane {
        GridPlane::new(self.corners)
    }

    /// Depth of its farthest corner.
    pub(crate) fn farthest(&self) -> i32 {
        self.corners.iter().fold(i32::MAX, |farthest, p| farthest.min(p[2]))
    }

    /// Whether it has no area on the page.
    pub(crate) fn is_flat(&self) -> bool {
        let [a, b, c] = self.corners;
        vitral_math::exact::orient2d(a, b, c) == 0
    }
}
