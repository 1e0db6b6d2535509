//! Steps in words, for one of the pixels that they concern, and what they take in memory.

use super::lists::ListVerdict;
use super::outlines::{Contour, CutPolygon, edges};
use super::{BoxVerdict, Span, SpanVerdict, Step, WindowVerdict};

impl Step {
    /// Whether a pixel's first sample is in what the step is about.
    pub fn concerns(&self, [x, y]: [u32; 2]) -> bool {
        match self {
            Self::Drawn { stays, hidden, .. } => stays
                .iter()
                .chain(hidden)
                .any(|&[row, from, to]| row == y && (from..to).contains(&x)),
            Self::DepthTest { pixel, .. }
            | Self::RayMeets { pixel, .. }
            | Self::RayGoesOn { pixel, .. } => *pixel == [x, y],
            Self::Window { pixels: [left, top, width, height], .. }
            | Self::Rays { pixels: [left, top, width, height], .. } => {
                (*left..left + width).contains(&x) && (*top..top + height).contains(&y)
            }
            Self::Line { row, sample, .. } => *row == y && *sample == 0,
            Self::Piece { outline, .. } | Self::Clip { outline, .. } => {
                holds(edges(outline), [x, y])
            }
            Self::Visible { contours, .. } => {
                holds(contours.iter().flat_map(Contour::edges), [x, y])
            }
            Self::Overruled { samples, .. } => samples.iter().any(|sample| sample.pixel == [x, y]),
            Self::TreeNode { .. }
            | Self::TreeVisit { .. }
            | Self::FirstOrder { .. }
            | Self::Turn { .. } => false,
            Self::Compared { .. } | Self::Moved { .. } | Self::Circle { .. } => false,
            Self::Split { .. } | Self::Painted { .. } => false,
            Self::NearestFirst { .. }
            | Self::Space { .. }
            | Self::EdgeTable { .. }
            | Self::Box { .. } => false,
            Self::Clipped { .. } => false,
        }
    }

    /// The step in words, for one of the pixels it concerns.
    pub fn describe(&self, [x, y]: [u32; 2]) -> String {
        match self {
            // Steps of the z-buffer.
            Self::Drawn { facet, stays, .. } => {
                let stays =
                    stays.iter().any(|&[row, from, to]| row == y && (from..to).contains(&x));
                format!(
                    "facet {facet} comes: {}",
                    if stays { "nearer than what is there" } else { "hidden" }
                )
            }
            Self::DepthTest { facet, depth, there, there_depth, stays, .. } => {
                let was = match there.zip(*there_depth) {
                    Some((there, depth)) => format!("facet {there} is there with depth {depth}"),
                    None => "nothing is there".to_owned(),
                };
                format!("facet {facet} comes with depth {depth}, {was}: facet {stays} stays")
            }
            // Steps of Warnock's subdivision.
            Self::Window { pixels: [left, top, width, height], verdict, .. } => {
                let what = match verdict {
                    WindowVerdict::Empty => "empty",
                    WindowVerdict::One => "one polygon is drawn",
                    WindowVerdict::Surrounded => {
                        "filled by a polygon that surrounds it in front of all others"
                    }
                    WindowVerdict::Pixel => "one pixel, the nearest at each sample",
                    WindowVerdict::Cut => "cut in four",
                };
                format!("window {left},{top} of {width} x {height}, {}: {what}", self.relations())
            }
            // Steps of the scan-line algorithm.
            Self::Line { active_edges, spans, .. } => describe_line(active_edges.len(), spans, x),
            // Steps of ray casting.
            Self::Rays { pixels: [_, _, width, height], rays, boxes, facets, tested, through } => {
                let which =
                    if tested.is_empty() { String::new() } else { format!(": {}", few(tested)) };
                let tests = format!("{boxes} box(es) and {facets} facet(s) tested{which}");
                format!(
                    "{rays} ray(s) of {width} x {height} pixel(s): {tests}{}",
                    through.describe()
                )
            }
            // Steps of list priority.
            Self::Piece { order, facet, cuts, node, .. } => {
                let node =
                    node.map_or(String::new(), |node| format!(", of node {node} of the tree"));
                format!(
                    "place {order} in the list, from the back: polygon of facet {facet}, cut {cuts} time(s){node}"
                )
            }
            Self::Overruled { samples, .. } => {
                let own: Vec<_> = samples.iter().filter(|sample| sample.pixel == [x, y]).collect();
                let facets = own.first().map_or(String::new(), |sample| {
                    format!(
                        ": facet {} is nearer than facet {}, which the list shows",
                        sample.by_depth, sample.by_list
                    )
                });
                format!("depth overrules the list at {} sample(s){facets}", own.len())
            }
            // Steps of Weiler and Atherton.
            Self::Clip { clip, within, facet, inside, outside_count, hidden, again, .. } => {
                let within =
                    within.map_or(String::new(), |outer| format!(" of the inside of clip {outer}"));
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
            other => tell_what_is_built(other),
        }
    }

    /// About how many bytes it takes in memory.
    pub fn bytes(&self) -> u64 {
        fn of<T>(list: &[T]) -> usize {
            size_of_val(list)
        }
        let listed = match self {
            // Count the lists that the step owns.
            Self::Drawn { stays, hidden, .. } => of(stays) + of(hidden),
            Self::Window { path, contained, intersecting, surrounding, hidden, .. } => {
                path.len() + of(contained) + of(intersecting) + of(surrounding) + of(hidden)
            }
            Self::EdgeTable { polygons, buckets, .. } => {
                of(polygons) + buckets.iter().map(|b| size_of_val(b) + of(&b.edges)).sum::<usize>()
            }
            Self::Line { active_edges, spans, .. } => {
                of(active_edges)
                    + spans.iter().map(|s| size_of_val(s) + of(&s.inside)).sum::<usize>()
            }
            Self::Clipped { before, after, .. } => of(before) + of(after),
            Self::Rays { tested, through, .. } => of(tested) + 24 * through.len(),
            Self::Circle { polygons, facets } => of(polygons) + of(facets),
            Self::Piece { outline, .. } => of(outline),
            Self::NearestFirst { polygons } => {
                of(polygons) + polygons.iter().map(|p| contours_bytes(&p.contours)).sum::<usize>()
            }
            Self::Clip { outline, cut, inside, outside, hidden, .. } => {
                let parts = |c: &CutPolygon| {
                    [&c.before, &c.inside, &c.hidden, &c.outside].map(|c| contours_bytes(c))
                };
                let cuts: usize = cut.iter().flat_map(parts).sum();
                of(outline) + of(cut) + cuts + of(inside) + of(outside) + of(hidden)
            }
            Self::Visible { contours, .. } => contours_bytes(contours),
            Self::TreeNode { coincident, front, back, cut, .. } => {
                [coincident, front, back, cut].iter().map(|set| of(&set.facets)).sum()
            }
            Self::TreeVisit { polygons, .. } => of(polygons),
            Self::FirstOrder { polygons } => of(polygons),
            Self::Split { parts, unmarked, .. } => of(parts) + of(unmarked),
            Self::Overruled { samples, .. } => of(samples),

            // Count nothing for steps that own no list.
            Self::DepthTest { .. }
            | Self::Space { .. }
            | Self::RayMeets { .. }
            | Self::RayGoesOn { .. } => 0,
            Self::Turn { .. }
            | Self::Compared { .. }
            | Self::Moved { .. }
            | Self::Painted { .. } => 0,
            Self::Box { .. } => 0,
        };

        // Add the step itself.
        (size_of::<Self>() + listed) as u64
    }

    /// Of a window's polygons, how many are left and what they are to it.
    fn relations(&self) -> String {
        let Self::Window { contained, intersecting, surrounding, hidden, .. } = self else {
            return String::new();
        };
        let left = contained.len() + intersecting.len() + surrounding.len();
        let kinds = [
            (surrounding, "surrounding"),
            (intersecting, "intersecting"),
            (contained, "contained"),
            (hidden, "hidden"),
        ];
        let told = kinds.iter().filter(|(facets, _)| !facets.is_empty());
        let told: Vec<_> = told.map(|(facets, kind)| format!("{kind} {}", few(facets))).collect();
        let told = if told.is_empty() { String::new() } else { format!(" ({})", told.join("; ")) };
        format!("{left} polygon(s) left{told}")
    }
}

/// Bytes of outlines in memory.
fn contours_bytes(contours: &[Contour]) -> usize {
    size_of_val(contours)
        + contours.iter().map(|contour| size_of_val(contour.corners.as_slice())).sum::<usize>()
}

/// The first few of some facets.
fn few(facets: &[u32]) -> String {
    const MAX_NAMED: usize = 8;
    let names: Vec<_> = facets.iter().take(MAX_NAMED).map(u32::to_string).collect();
    names.join(" ") + if facets.len() > MAX_NAMED { " ..." } else { "" }
}

/// A scan line with so many active edges, and its span at column `x`, in words.
fn describe_line(active_edges: usize, spans: &[Span], x: u32) -> String {
    let line = format!("{active_edges} active edge(s)");
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

/// A step of culling and clipping, of a list or a tree, or of a ray, in words.
fn tell_what_is_built(step: &Step) -> String {
    match step {
        // Tell of culling and clipping.
        Step::Box { instance, items: [from, to], verdict, beyond, .. } => {
            let of = instance.map_or("instances".to_owned(), |instance| {
                format!("triangles of instance {instance}")
            });
            let found = match verdict {
                BoxVerdict::Outside => "outside, all is culled",
                BoxVerdict::Crossing => "partly outside, looked into",
                BoxVerdict::Inside => "inside, all stays",
            };
            let beyond =
                beyond.map_or(String::new(), |plane| format!(", beyond the {plane} plane"));
            format!("the box round {of} {from} to {}: {found}{beyond}", to.saturating_sub(1))
        }
        Step::Clipped { facet, plane, before, after } => {
            let left = if after.len() < 3 {
                "nothing is left".to_owned()
            } else {
                format!("{} are left", after.len())
            };
            format!(
                "facet {facet} is clipped at the {plane} plane: of {} corners {left}",
                before.len()
            )
        }
        // Tell of what is there before the first line, polygon or ray.
        Step::Space { cells: Some([x, y, z]), .. } => {
            format!("space is divided into {x} x {y} x {z} cells")
        }
        Step::Space { cells: None, .. } => "the box that the structure divides".to_owned(),
        Step::EdgeTable { rows: [from, to], polygons, buckets } => {
            let edges: usize = buckets.iter().map(|bucket| bucket.edges.len()).sum();
            format!(
                "tables of rows {from} to {}: {} polygon(s), {edges} edge(s)",
                to.saturating_sub(1),
                polygons.len()
            )
        }
        Step::NearestFirst { polygons } => {
            format!("{} polygon(s), the nearest first", polygons.len())
        }
        // Tell of rays.
        Step::RayMeets { facet: Some(facet), distance, turns, .. } => {
            let distance = distance
                .map_or(String::new(), |distance| format!(" at a distance of {distance:.4}"));
            format!("after {turns} turn(s) a ray meets facet {facet}{distance}")
        }
        Step::RayMeets { facet: None, turns, .. } => {
            format!("after {turns} turn(s) a ray meets nothing")
        }
        Step::RayGoesOn { facet, way, angles: [before, after], .. } => {
            format!(
                "at facet {facet} it goes on {}: {before:.2} degrees before, {after:.2} after",
                way.name()
            )
        }
        other => tell_of_list(other),
    }
}

/// A step of painter's algorithm or of a BSP tree in words.
fn tell_of_list(step: &Step) -> String {
    match step {
        // Tell of a BSP tree.
        Step::TreeNode { node, above, side, splitter, .. } => {
            let place = match above.zip(*side) {
                Some((above, side)) => format!(", in {} of node {above}", side.name()),
                None => ", the root".to_owned(),
            };
            let cut = splitter.map_or(String::new(), |splitter| {
                format!(", cut by the plane of polygon {splitter}")
            });
            format!("node {node}{place}{cut}")
        }
        Step::TreeVisit { node, viewer, polygons, .. } => {
            let side = viewer.name();
            format!(
                "the viewer is in {side} of the plane of node {node}: its polygon(s) {} come now",
                few(polygons)
            )
        }

        // Tell of the painter's list and of the turn of each polygon.
        Step::FirstOrder { polygons } => {
            format!("{} polygon(s) in their first order, by their farthest depths", polygons.len())
        }
        Step::Turn { polygon, facet } => {
            format!("it is the turn of polygon {polygon}, of facet {facet}")
        }

        // Tell of comparisons, and of what they change in the list.
        Step::Compared { polygon, with, test, verdict, .. } => {
            let found = match verdict {
                ListVerdict::Before => format!("{polygon} may be painted before {with}"),
                ListVerdict::After => format!("{with} has to be painted before {polygon}"),
                ListVerdict::Across => "each covers a part of the other".to_owned(),
            };
            format!("polygons {polygon} and {with}: {}: {found}", test.describe(*polygon, *with))
        }
        Step::Moved { polygon, before_polygon, .. } => {
            format!(
                "polygon {polygon} moves before polygon {before_polygon} in the list, and is marked"
            )
        }
        Step::Circle { polygons, .. } => {
            format!("polygons {} cover each other in a circle", few(polygons))
        }
        Step::Split { polygon, by, parts, .. } => {
            format!("polygon {polygon} is split by the plane of {by} into {} parts", parts.len())
        }
        Step::Painted { polygon, facet } => {
            format!("polygon {polygon}, of facet {facet}, is painted")
        }
        other => format!("{other:?}"),
    }
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
