//! The steps of the algorithms, for whoever wants to look on.
//!
//! An [`Observer`] in the [`Execution`](crate::Execution) is told each step as it is done, from any
//! thread: in one tile or band they come in order, those of different tiles mix ([`numbered`] puts
//! them in the algorithm's own). Nobody listening costs nothing that can be measured: the question
//! is asked once for a window, a line, a polygon of a list, a ray or a block of rays, never in a
//! loop within.
//!
//! [`picture`] draws the steps over the image.

mod canvas;
pub mod legend;
pub mod lists;
pub mod numbered;
pub mod outlines;
pub mod picture;
pub mod replay;
pub mod structure;
pub mod tables;
mod words;

use lists::{ListTest, ListVerdict, ListedPolygon, OverruledSample, PlaneSide, PolygonSet};
use outlines::{Contour, CutPolygon, SortedPolygon};
use serde::Serialize;
use tables::{Bucket, Crossing, TablePolygon};

/// Is told the steps of an algorithm.
pub trait Observer: std::fmt::Debug + Send + Sync {
    /// A step was done.
    fn step(&self, step: &Step);

    /// Whether each comparison of the z-buffer at a pixel is to be told.
    fn watches(&self, _pixel: [u32; 2]) -> bool {
        false
    }

    /// Whether it reads [`Step::NearestFirst`] and [`Step::Clip`], whose outlines grow with the
    /// square of the scene.
    fn reads_clips(&self) -> bool {
        true
    }
}

/// What was found about a window of Warnock's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum WindowVerdict {
    /// No polygon is in it.
    Empty,
    /// One polygon is contained or intersects: it is drawn.
    One,
    /// A polygon surrounds it, in front of all others: it fills the window.
    Surrounded,
    /// One pixel: decided sample by sample.
    Pixel,
    /// Not simple: cut in four.
    Cut,
}

/// Where a box lies with respect to the view volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum BoxVerdict {
    /// Beyond a plane: all that is in it is culled.
    Outside,
    /// Partly beyond: what is in it is looked at.
    Crossing,
    /// All of it is in view.
    Inside,
}

/// How a span of a line was decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SpanVerdict {
    /// One polygon is in.
    Only,
    /// One hides the others at both ends, hence throughout.
    Hides,
    /// One hides the others on its side of the line where they penetrate each other.
    ImpliedEdge,
    /// Sample by sample.
    Samples,
}

/// A span of a scan line.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Span {
    /// First pixel, and the one behind the last.
    pub pixels: [u32; 2],
    /// The first facet of each polygon whose in-out flag is in, the lowest first.
    pub inside: Vec<u32>,
    /// How it was decided.
    pub verdict: SpanVerdict,
    /// The first facet of the polygon that fills it, where one does.
    pub facet: Option<u32>,
}

/// The parts of a structure that rays went through, in the order in which they came to them.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Passed {
    /// There is no structure.
    Nowhere,
    /// Nodes of a tree of boxes, or of a partition of space, that were opened, numbered from the
    /// root, 0, each before those below it.
    Nodes(Vec<u32>),
    /// Cells of an octree that were opened, by the way down from the root, which has no name: a
    /// digit a level, the sum of 1 for the larger x, 2 for the larger y, 4 for the larger z.
    Octants(Vec<String>),
    /// Cells of a grid along x, y and z.
    Cells(Vec<[u32; 3]>),
    /// Objects whose volumes were met, by their place among those with triangles.
    Objects(Vec<u32>),
}

impl Passed {
    /// The name of each part; none where there is no structure.
    pub fn names(&self) -> Vec<String> {
        match self {
            Self::Nowhere => Vec::new(),
            Self::Nodes(numbers) | Self::Objects(numbers) => {
                numbers.iter().map(u32::to_string).collect()
            }
            Self::Octants(cells) => cells.clone(),
            Self::Cells(cells) => cells.iter().map(|[x, y, z]| format!("{x},{y},{z}")).collect(),
        }
    }

    /// In words: how many, and the first few.
    fn describe(&self) -> String {
        const MAX_NAMED: usize = 16;
        if self.is_empty() {
            return String::new();
        }
        let mut names = self.names();
        names.truncate(MAX_NAMED);
        let what = match self {
            Self::Nowhere => return String::new(),
            Self::Nodes(_) => "node(s)",
            Self::Objects(_) => "object(s)",
            Self::Octants(_) => {
                names.iter_mut().for_each(|name| *name = format!("\"{name}\""));
                "octant(s)"
            }
            Self::Cells(_) => "cell(s)",
        };
        let count = self.len();
        if count > MAX_NAMED {
            names.push("...".to_owned());
        }
        format!("; through {count} {what}: {}", names.join(" "))
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Nowhere => 0,
            Self::Nodes(nodes) => nodes.len(),
            Self::Objects(objects) => objects.len(),
            Self::Octants(cells) => cells.len(),
            Self::Cells(cells) => cells.len(),
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// How a ray goes on from a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Way {
    /// A mirror sends it back.
    Mirrored,
    /// No light passes at this angle, and all is sent back.
    TotallyReflected,
    /// It passes and is bent.
    Refracted,
    /// It passes straight on.
    Straight,
    /// A translucent surface scatters it.
    Scattered,
}

impl Way {
    /// In a word or two.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mirrored => "mirrored",
            Self::TotallyReflected => "totally reflected",
            Self::Refracted => "refracted",
            Self::Straight => "straight on",
            Self::Scattered => "scattered",
        }
    }
}

/// A step. Places are pixels from the top left.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "step", rename_all = "kebab-case")]
pub enum Step {
    /// Culling: a box was tested against the view volume.
    Box {
        /// The instance whose triangles it holds; none for a box round whole instances.
        instance: Option<u32>,
        /// The first of these, and the one behind the last.
        items: [u32; 2],
        /// Smallest x, y, z: world space for instances, model space for triangles.
        min: [f64; 3],
        /// Largest x, y, z.
        max: [f64; 3],
        /// Where it lies.
        verdict: BoxVerdict,
        /// The plane of the view volume that it lies beyond, if it is outside.
        beyond: Option<&'static str>,
    },
    /// Clipping: a plane cut a facet.
    Clipped {
        /// Id of the facet.
        facet: u32,
        /// Near, far, or a side of the guard band, which is wider than the view.
        plane: &'static str,
        /// The polygon before, in clip space: x, y, z, w.
        before: Vec<[f32; 4]>,
        /// What is left of it; nothing with fewer than three corners.
        after: Vec<[f32; 4]>,
    },
    /// Z-buffer: a facet came, in the order of the scene, and its depth was compared at the first
    /// samples that it covers.
    Drawn {
        /// Id of the facet.
        facet: u32,
        /// Where it is nearer than what was there, and stays: runs of pixels, each by its row, its
        /// first and the one behind its last.
        stays: Vec<[u32; 3]>,
        /// Where it is hidden by what was there.
        hidden: Vec<[u32; 3]>,
    },
    /// Z-buffer: what happened at a watched pixel when a facet came.
    DepthTest {
        /// Column and row of the pixel.
        pixel: [u32; 2],
        /// The facet that came.
        facet: u32,
        /// Its depth at the first sample: 1 on the near plane, 0 on the far one.
        depth: f32,
        /// The facet that was there; none for the background.
        there: Option<u32>,
        /// Depth of that facet at the first sample.
        there_depth: Option<f32>,
        /// The facet that is kept, one of the two.
        stays: u32,
    },
    /// Warnock: a window was looked at.
    Window {
        /// Left, top, width, height.
        pixels: [u32; 4],
        /// The way down from the whole picture: for each cut the quarter, `0` top left, `1` top
        /// right, `2` bottom left, `3` bottom right. Its parent is the window without the last
        /// digit.
        path: String,
        /// How many polygons of the list that was handed down have no sample in it.
        disjoint: u32,
        /// Facets of the polygons that are left and lie within it.
        contained: Vec<u32>,
        /// Of those that are partly in it.
        intersecting: Vec<u32>,
        /// Of those that cover it.
        surrounding: Vec<u32>,
        /// Of those that are taken off the list, as one that surrounds the window hides them in all
        /// of it.
        hidden: Vec<u32>,
        /// What that means.
        verdict: WindowVerdict,
        /// The facet of the polygon that is drawn, where it is one.
        facet: Option<u32>,
    },
    /// Scan-line: the tables of a band of rows, before it is swept.
    EdgeTable {
        /// The band's first row of pixels, and the one behind its last.
        rows: [u32; 2],
        /// The polygon table.
        polygons: Vec<TablePolygon>,
        /// The edge table, from top to bottom; lines on which no edge begins have no bucket. Edges
        /// that begin above the band are in the bucket of its first line.
        buckets: Vec<Bucket>,
    },
    /// Scan-line: a line of samples was swept.
    Line {
        /// Row of pixels.
        row: u32,
        /// Which sample of the pixels.
        sample: u32,
        /// The active edge table, from left to right.
        active_edges: Vec<Crossing>,
        /// The spans with something in, from left to right.
        spans: Vec<Span>,
    },
    /// Ray casting: the box that a structure divides, before any ray is followed.
    Space {
        /// Smallest x, y, z, world space.
        min: [f64; 3],
        /// Largest x, y, z.
        max: [f64; 3],
        /// A grid's cells along x, y and z, all of one size.
        cells: Option<[u32; 3]>,
    },
    /// Ray casting and brute force: the rays through some pixels were followed.
    Rays {
        /// Left, top, width, height.
        pixels: [u32; 4],
        /// Rays that were cast.
        rays: u64,
        /// Boxes or cells looked at.
        boxes: u64,
        /// How many tests of facets there were.
        facets: u64,
        /// The facets of these tests in order, ray after ray; none for brute force, which tests all
        /// in the order of their numbers.
        tested: Vec<u32>,
        /// What they went through, each part once.
        through: Passed,
    },
    /// Ray tracing: a ray met a surface, or nothing. How it goes on from there follows.
    RayMeets {
        /// The pixel that it is for.
        pixel: [u32; 2],
        /// Turns that it took before.
        turns: u32,
        /// The facet; none for the background.
        facet: Option<u32>,
        /// Where it starts, world space.
        origin: [f64; 3],
        /// Where it goes, unit.
        direction: [f64; 3],
        /// How far away the facet is.
        distance: Option<f64>,
        /// How red, green and blue of what it meets count in the pixel.
        weight: [f32; 3],
        /// What the surface's own light, or the background, adds to the pixel, before that is
        /// encoded.
        light: [f32; 3],
    },
    /// Ray tracing: a ray goes on from the surface that it met.
    RayGoesOn {
        /// The pixel that it is for.
        pixel: [u32; 2],
        /// The facet that it leaves.
        facet: u32,
        /// How it goes on.
        way: Way,
        /// Between the normal and the ray before and after, degrees.
        angles: [f64; 2],
        /// Indices of refraction of what it comes from and what it goes on in.
        indices: [f32; 2],
        /// Where it goes, unit, world space.
        direction: [f64; 3],
        /// How red, green and blue of what it will meet count in the pixel.
        weight: [f32; 3],
    },
    /// BSP: a node of the tree, each after the one that it hangs below. A tree that is there
    /// already is told like one that was just built.
    TreeNode {
        /// Its number. The root is 0.
        node: u32,
        /// The number of the node that it hangs below; none for the root.
        above: Option<u32>,
        /// The side of that node's plane that it divides.
        side: Option<PlaneSide>,
        /// The first facet of the polygon that gave the plane, the splitter; none for a plane
        /// across an axis.
        splitter: Option<u32>,
        /// `a x + b y + c z + d = 0`, world units; `(a, b, c)` is unit and points to the front.
        plane: [f64; 4],
        /// The polygons in the plane, the splitter among them, the lowest facet first.
        coincident: PolygonSet,
        /// The polygons in front, parts of those that are cut among them, the lowest facet first.
        front: PolygonSet,
        /// The polygons behind, parts of those that are cut among them, the lowest facet first.
        back: PolygonSet,
        /// The polygons that cross the plane and are cut, the lowest facet first.
        cut: PolygonSet,
    },
    /// BSP: the walk through the tree comes to a node, whose polygons are next in the list. All
    /// nodes on the far side of its plane came before, all on the viewer's side follow.
    TreeVisit {
        /// Its place in the walk, 0 for the farthest node.
        order: u32,
        /// The number of the node.
        node: u32,
        /// The number of the node that it hangs below; none for the root.
        above: Option<u32>,
        /// The side of its plane on which the viewer is.
        viewer: PlaneSide,
        /// The first facets of its polygons, in the order of the list, from back to front.
        polygons: Vec<u32>,
    },
    /// Painter: the first order, before any comparison.
    FirstOrder {
        /// The polygons, the farthest first.
        polygons: Vec<ListedPolygon>,
    },
    /// Painter: the farthest polygon that is left has its turn, and is compared with those that it
    /// might cover.
    Turn {
        /// Its number.
        polygon: u32,
        /// Its first facet.
        facet: u32,
    },
    /// Painter: a polygon P was compared with another one, Q, that is not painted yet.
    Compared {
        /// The number of P.
        polygon: u32,
        /// The first facet of P.
        facet: u32,
        /// The number of Q.
        with: u32,
        /// The first facet of Q.
        with_facet: u32,
        /// The test that decided.
        test: ListTest,
        /// What it decided: before lets P be painted before Q.
        verdict: ListVerdict,
    },
    /// Painter: a polygon has to be painted before one that was farther in the first order. It is
    /// moved and marked.
    Moved {
        /// The number of the polygon that is moved.
        polygon: u32,
        /// Its first facet.
        facet: u32,
        /// The number of the polygon that waits for it.
        before_polygon: u32,
        /// The first facet of that one.
        before: u32,
    },
    /// Painter: polygons wait for each other in a circle. Each waits for the next one, the last for
    /// the first.
    Circle {
        /// Their numbers.
        polygons: Vec<u32>,
        /// Their first facets.
        facets: Vec<u32>,
    },
    /// Painter: a polygon is split along `a x + b y + c = 0` on the screen; `(a, b)` is unit.
    Split {
        /// Its number.
        polygon: u32,
        /// Its first facet.
        facet: u32,
        /// The number of the polygon whose plane or edge the line is of.
        by: u32,
        /// The first facet of that one.
        by_facet: u32,
        /// The line: `a`, `b`, and `c` in pixels.
        line: [f64; 3],
        /// The numbers of its parts, those that can have samples; they wait by their own depths.
        parts: Vec<ListedPolygon>,
        /// The numbers of polygons that were marked after it: they lose the mark and wait again.
        unmarked: Vec<u32>,
    },
    /// Painter: nothing has to come before a polygon that is left: it is painted.
    Painted {
        /// Its number.
        polygon: u32,
        /// Its first facet.
        facet: u32,
    },
    /// List priority: a polygon has its place in the list, the smallest first from the back.
    Piece {
        /// The place, 0 for the farthest.
        order: u32,
        /// The number of the polygon, or of the part: painter's as in the steps before, a BSP
        /// tree's as it is kept in the tree.
        polygon: u32,
        /// The number of the node in whose plane it lies; none in a painter's list.
        node: Option<u32>,
        /// Its first facet.
        facet: u32,
        /// Lines it was cut along.
        cuts: u32,
        /// Its corners, pixels.
        outline: Vec<[f32; 2]>,
    },
    /// List priority: a tile's samples at which the depth function contradicts the list, and wins.
    Overruled {
        /// Left, top, width, height of the tile, pixels.
        pixels: [u32; 4],
        /// The samples, those of a pixel one after the other.
        samples: Vec<OverruledSample>,
    },
    /// Weiler–Atherton: the polygons in their first order, the one with the nearest point first.
    NearestFirst {
        /// The polygons in the order, with what they were sorted by.
        polygons: Vec<SortedPolygon>,
    },
    /// Weiler–Atherton: a list was clipped with a polygon. The inside list is treated before the
    /// outside list: clips of the inside list follow, then that of the outside list.
    Clip {
        /// The clip's own number, from 0 in the order of steps.
        clip: u32,
        /// The clip whose inside list was clipped; none for the first list.
        within: Option<u32>,
        /// First facet of the clipping polygon.
        facet: u32,
        /// The clipping polygon's corners in order, clockwise, as it came in, pixels.
        outline: Vec<[f32; 2]>,
        /// Polygons of the list with an area inside the clipping polygon, in the list's order, the
        /// clipping polygon among them.
        cut: Vec<CutPolygon>,
        /// First facets of the inside list, in order: what is inside and not hidden.
        inside: Vec<u32>,
        /// First facets of the outside list, in order, at most [`MAX_LISTED`](outlines::MAX_LISTED)
        /// of them.
        outside: Vec<u32>,
        /// How many polygons the outside list has.
        outside_count: u32,
        /// First facets of polygons with a part that was removed, since the clipping polygon hides
        /// it.
        hidden: Vec<u32>,
        /// The preliminary order erred: the inside list is clipped again.
        again: bool,
    },
    /// Weiler–Atherton: a visible polygon.
    Visible {
        /// Its first facet.
        facet: u32,
        /// The clip in whose inside list it was left; none for observers that do not read clips.
        clip: Option<u32>,
        /// Square pixels.
        area: f64,
        /// Its outlines, those around it before its holes.
        contours: Vec<Contour>,
    },
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A window without polygons.
    pub(super) fn window(pixels: [u32; 4], verdict: WindowVerdict) -> Step {
        let none = Vec::new;
        Step::Window {
            pixels,
            path: String::new(),
            disjoint: 0,
            contained: none(),
            intersecting: none(),
            surrounding: none(),
            hidden: none(),
            verdict,
            facet: None,
        }
    }

    #[test]
    fn a_step_knows_its_pixels() {
        let window = window([8, 4, 4, 2], WindowVerdict::Cut);
        assert!(window.concerns([8, 4]) && window.concerns([11, 5]));
        let drawn = Step::Drawn { facet: 0, stays: vec![[2, 1, 3]], hidden: vec![[2, 3, 4]] };
        assert!(
            drawn.concerns([1, 2])
                && drawn.concerns([3, 2])
                && !drawn.concerns([4, 2])
                && !drawn.concerns([1, 1])
        );
        assert!(!window.concerns([12, 4]) && !window.concerns([8, 6]) && !window.concerns([7, 4]));
        let outline = vec![[0.0, 0.0], [10.0, 0.0], [0.0, 10.0]];
        let piece = Step::Piece { order: 1, polygon: 5, node: None, facet: 2, cuts: 0, outline };
        assert!(piece.concerns([1, 1]) && !piece.concerns([8, 8]) && !piece.concerns([1, 11]));
        assert!(!Step::Turn { polygon: 0, facet: 0 }.concerns([0, 0]));
        let sample = OverruledSample { pixel: [1, 2], sample: 0, by_list: 3, by_depth: 4 };
        let overruled = Step::Overruled { pixels: [0, 0, 8, 8], samples: vec![sample] };
        assert!(overruled.concerns([1, 2]) && !overruled.concerns([2, 1]));
        let told = overruled.describe([1, 2]);
        assert!(told.contains("facet 4 is nearer than facet 3"), "{told}");
    }
}
