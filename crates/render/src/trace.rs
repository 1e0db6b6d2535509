//! The steps of the algorithms, for whoever wants to look on.
//!
//! An [`Observer`] in the [`Execution`](crate::Execution) is told each step as it is done, from any thread: in one tile or
//! band they come in order, those of different tiles mix. Nobody listening costs nothing that can be measured: the
//! question is asked once for a window, a line, a polygon of a list, a ray or a block of rays, never in a loop within.
//!
//! [`picture`] draws the steps over the image.

pub mod legend;
pub mod outlines;
pub mod picture;
pub mod tables;

use outlines::{Contour, CutPolygon, SortedPolygon};
use serde::Serialize;
use tables::{Bucket, Crossing, TablePolygon};

/// Is told the steps of an algorithm.
pub trait Observer: std::fmt::Debug + Send + Sync {
    /// A step was done.
    fn step(&self, step: &Step);

    /// Whether it reads [`Step::FirstOrder`] and [`Step::Clip`], whose outlines grow with the square of the scene.
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
    /// Facets of the polygons whose in-out flag is in, the lowest first.
    pub inside: Vec<u32>,
    /// How it was decided.
    pub verdict: SpanVerdict,
    /// The facet that fills it, where one does.
    pub facet: Option<u32>,
}

/// The parts of a structure that rays went through, in the order in which they came to them.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Passed {
    /// There is no structure.
    Nowhere,
    /// Nodes of a tree of boxes, or of a partition of space, that were opened, numbered from the root, 0, each before those below it.
    Nodes(Vec<u32>),
    /// Cells of an octree that were opened, by the way down from the root, which has no name: a digit a level, the sum
    /// of 1 for the larger x, 2 for the larger y, 4 for the larger z.
    Octants(Vec<String>),
    /// Cells of a grid along x, y and z.
    Cells(Vec<[u32; 3]>),
    /// Objects whose volumes were met, by their place among those with triangles.
    Objects(Vec<u32>),
}

impl Passed {
    /// In words: how many, and the first few.
    fn tell(&self) -> String {
        const MOST: usize = 16;
        let (what, mut names): (_, Vec<String>) = match self {
            Self::Nowhere => return String::new(),
            Self::Nodes(nodes) => ("node(s)", nodes.iter().take(MOST).map(u32::to_string).collect()),
            Self::Objects(objects) => ("object(s)", objects.iter().take(MOST).map(u32::to_string).collect()),
            Self::Octants(cells) => ("octant(s)", cells.iter().take(MOST).map(|c| format!("\"{c}\"")).collect()),
            Self::Cells(cells) => {
                let name = |[x, y, z]: &[u32; 3]| format!("{x},{y},{z}");
                ("cell(s)", cells.iter().take(MOST).map(name).collect())
            }
        };
        let count = self.len();
        if count > MOST {
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
    /// Z-buffer: a tile is done; for each of its pixels, row by row, how many opaque facets cover its first sample.
    Tile {
        /// Left, top, width, height.
        pixels: [u32; 4],
        /// Facets a pixel.
        facets: Vec<u32>,
    },
    /// Warnock: a window was looked at.
    Window {
        /// Left, top, width, height.
        pixels: [u32; 4],
        /// Polygons left on its list.
        polygons: u32,
        /// What that means.
        verdict: WindowVerdict,
        /// The facet that is drawn, where it is one.
        facet: Option<u32>,
    },
    /// Scan-line: the tables of a band of rows, before it is swept.
    EdgeTable {
        /// The band's first row of pixels, and the one behind its last.
        rows: [u32; 2],
        /// The polygon table.
        polygons: Vec<TablePolygon>,
        /// The edge table, from top to bottom; lines on which no edge begins have no bucket. Edges that begin above the band
        /// are in the bucket of its first line.
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
        /// Rays.
        rays: u64,
        /// Boxes or cells looked at.
        boxes: u64,
        /// Facets tested.
        facets: u64,
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
        /// What the surface's own light, or the background, adds to the pixel, before that is encoded.
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
    /// BSP, while the tree is built: a facet, or a part of one, crosses a plane and is split.
    TreeSplit {
        /// The facet.
        facet: u32,
        /// `a x + b y + c z + d = 0`, world space.
        plane: [f64; 4],
    },
    /// Painter: a polygon has to be painted before one that was farther in the first order.
    Moved {
        /// Facet of the polygon that is moved.
        facet: u32,
        /// Facet of the one that waits.
        before: u32,
    },
    /// Painter: polygons wait for each other in a circle.
    Circle {
        /// Their facets.
        facets: Vec<u32>,
    },
    /// Painter: a polygon is split along `a x + b y + c = 0` on the screen, 1/256 pixel.
    Split {
        /// The facet.
        facet: u32,
        /// The line.
        line: [f64; 3],
    },
    /// List priority: a polygon has its place in the list, the smallest first from the back.
    Piece {
        /// The place.
        order: u32,
        /// The facet.
        facet: u32,
        /// Lines it was cut along.
        cuts: u32,
        /// Its corners.
        outline: Vec<[f32; 2]>,
    },
    /// Weiler–Atherton: the polygons in their first order, the one with the nearest point first.
    FirstOrder {
        /// The polygons.
        polygons: Vec<SortedPolygon>,
    },
    /// Weiler–Atherton: a list was clipped with a polygon. The inside list is treated before the outside list: clips of the
    /// inside list follow, then that of the outside list.
    Clip {
        /// The clip's own number, from 0 in the order of steps.
        clip: u32,
        /// The clip whose inside list was clipped; none for the first list.
        parent: Option<u32>,
        /// First facet of the clipping polygon.
        facet: u32,
        /// The clipping polygon's corners in order, clockwise, as it came in, pixels.
        outline: Vec<[f32; 2]>,
        /// Polygons of the list with an area inside the clipping polygon, in the list's order, the clipping polygon among
        /// them.
        cut: Vec<CutPolygon>,
        /// First facets of the inside list, in order: what is inside and not hidden.
        inside: Vec<u32>,
        /// First facets of the outside list, in order, at most [`MAX_LISTED`](outlines::MAX_LISTED) of them.
        outside: Vec<u32>,
        /// How many polygons the outside list has.
        outside_count: u32,
        /// First facets of polygons with a part that was removed, since the clipping polygon hides it.
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

impl Step {
    /// Whether a pixel's first sample is in what the step is about.
    pub fn concerns(&self, [x, y]: [u32; 2]) -> bool {
        match self {
            Self::Tile { pixels: [left, top, width, height], .. }
            | Self::Window { pixels: [left, top, width, height], .. }
            | Self::Rays { pixels: [left, top, width, height], .. } => {
                (*left..left + width).contains(&x) && (*top..top + height).contains(&y)
            }
            Self::Line { row, sample, .. } => *row == y && *sample == 0,
            Self::RayMeets { pixel, .. } | Self::RayGoesOn { pixel, .. } => *pixel == [x, y],
            Self::Piece { outline, .. } => {
                let edges = outline.iter().zip(outline.iter().cycle().skip(1));
                holds(edges.map(|(a, b)| [*a, *b]), [x, y])
            }
            Self::Visible { contours, .. } => holds(contours.iter().flat_map(Contour::edges), [x, y]),
            Self::Clip { outline, .. } => {
                let edges = outline.iter().zip(outline.iter().cycle().skip(1));
                holds(edges.map(|(a, b)| [*a, *b]), [x, y])
            }
            Self::TreeSplit { .. } | Self::Moved { .. } | Self::Circle { .. } | Self::Split { .. } => false,
            Self::FirstOrder { .. } | Self::Space { .. } | Self::EdgeTable { .. } => false,
        }
    }

    /// The step in words, for one of the pixels it concerns.
    pub fn tell(&self, [x, y]: [u32; 2]) -> String {
        match self {
            Self::Tile { pixels: [left, top, width, _], facets } => {
                let count = facets.get(((y - top) * width + (x - left)) as usize).copied().unwrap_or(0);
                format!("{count} opaque facet(s) of the tile cover it; the nearest depth stayed")
            }
            Self::Window { pixels: [left, top, width, height], polygons, verdict, .. } => {
                let what = match verdict {
                    WindowVerdict::Empty => "empty",
                    WindowVerdict::One => "one polygon is drawn",
                    WindowVerdict::Surrounded => "filled by a polygon that surrounds it in front of all others",
                    WindowVerdict::Pixel => "one pixel, the nearest at each sample",
                    WindowVerdict::Cut => "cut in four",
                };
                format!("window {left},{top} of {width} x {height}, {polygons} polygon(s) left: {what}")
            }
            Self::Line { active_edges, spans, .. } => {
                let line = format!("{} active edge(s)", active_edges.len());
                match spans.iter().find(|s| (s.pixels[0]..s.pixels[1]).contains(&x)) {
                    Some(span) => {
                        let how = match span.verdict {
                            SpanVerdict::Only => "one polygon is in",
                            SpanVerdict::Hides => "one hides the others at both ends",
                            SpanVerdict::ImpliedEdge => "one hides the others on its side of an implied edge",
                            SpanVerdict::Samples => "decided sample by sample",
                        };
                        let ([from, to], inside) = (span.pixels, span.inside.len());
                        let won = span.facet.map_or(String::new(), |facet| format!(", facet {facet}"));
                        let facets = few(&span.inside);
                        format!(
                            "{line}; span {from} to {} with {inside} polygon(s) in, of facet(s) {facets}: {how}{won}",
                            to - 1
                        )
                    }
                    None => format!("{line}; no polygon is in here"),
                }
            }
            Self::Rays { pixels: [_, _, width, height], rays, boxes, facets, through } => {
                let tested = format!("{boxes} box(es), {facets} facet(s) tested");
                format!("{rays} ray(s) of {width} x {height} pixel(s): {tested}{}", through.tell())
            }
            Self::Piece { order, facet, cuts, .. } => {
                format!("place {order} in the list, from the back: facet {facet}, cut {cuts} time(s)")
            }
            Self::Clip { clip, parent, facet, inside, outside_count, hidden, again, .. } => {
                let within = parent.map_or(String::new(), |parent| format!(" of the inside of clip {parent}"));
                let order = if *again { ", which is clipped again" } else { "" };
                format!(
                    "clip {clip}{within} with facet {facet}: inside {}{order}; {outside_count} outside, {} hidden",
                    few(inside),
                    hidden.len()
                )
            }
            Self::Visible { facet, contours, .. } => {
                let edges: usize = contours.iter().map(|contour| contour.corners.len()).sum();
                format!("a visible polygon of facet {facet}, with {edges} edges")
            }
            other => format!("{other:?}"),
        }
    }
}

/// The first few of some facets.
fn few(facets: &[u32]) -> String {
    const MOST: usize = 8;
    let names: Vec<_> = facets.iter().take(MOST).map(u32::to_string).collect();
    names.join(" ") + if facets.len() > MOST { " ..." } else { "" }
}

/// Whether a pixel's centre is inside an outline, by the parity of crossings.
fn holds(edges: impl Iterator<Item = [[f32; 2]; 2]>, [x, y]: [u32; 2]) -> bool {
    let (x, y) = (x as f32 + 0.5, y as f32 + 0.5);
    let crossings = edges.filter(|[a, b]| {
        let crosses = (a[1] > y) != (b[1] > y);
        crosses && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
    });
    crossings.count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_knows_its_pixels() {
        let window = Step::Window { pixels: [8, 4, 4, 2], polygons: 2, verdict: WindowVerdict::Cut, facet: None };
        assert!(window.concerns([8, 4]) && window.concerns([11, 5]));
        assert!(!window.concerns([12, 4]) && !window.concerns([8, 6]) && !window.concerns([7, 4]));
        let outline = vec![[0.0, 0.0], [10.0, 0.0], [0.0, 10.0]];
        let piece = Step::Piece { order: 1, facet: 2, cuts: 0, outline };
        assert!(piece.concerns([1, 1]) && !piece.concerns([8, 8]) && !piece.concerns([1, 11]));
        assert!(!Step::Moved { facet: 0, before: 1 }.concerns([0, 0]));
    }
}
