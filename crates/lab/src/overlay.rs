//! What a step is about, drawn over the picture, in its pixels.

use crate::steps::Recording;
use std::collections::BTreeSet;
use std::fmt::Write;
use vitral::Error;
use vitral::explain::facet_outlines;
use vitral::internals::render::trace::Step;
use vitral::internals::render::trace::outlines::{Contour, CutPolygon};

/// Facets of a step that are drawn.
const MOST_FACETS: usize = 64;

/// A pixel that a step is about, for its words.
pub(crate) fn place(step: &Step) -> [u32; 2] {
    match step {
        Step::Window { pixels: [x, y, ..], .. } | Step::Rays { pixels: [x, y, ..], .. } => [*x, *y],
        Step::Line { row, spans, .. } => [spans.first().map_or(0, |span| span.pixels[0]), *row],
        Step::DepthTest { pixel, .. }
        | Step::RayMeets { pixel, .. }
        | Step::RayGoesOn { pixel, .. } => *pixel,
        Step::Drawn { stays, hidden, .. } => {
            stays.first().or_else(|| hidden.first()).map_or([0; 2], |[row, from, _]| [*from, *row])
        }
        _ => [0; 2],
    }
}

/// An SVG of the picture's size with the windows, lines and outlines of the step at place `at`;
/// each shape has a class that says what it is.
///
/// # Errors
/// Settings that cannot be.
pub(crate) fn drawing(recording: &Recording, at: usize) -> Result<String, Error> {
    let picture = &recording.renderer.settings.picture;
    let (width, height) = (picture.width, picture.height);
    let mut svg =
        format!(r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}">"#);
    let step = &recording.watched.steps[at].step;
    match step {
        // Draw the windows, rows and blocks of algorithms that work on areas.
        Step::Window { pixels, verdict, .. } => {
            let verdict = serde_json::to_value(verdict).unwrap_or_default();
            rectangle(
                &mut svg,
                *pixels,
                &format!("window {}", verdict.as_str().unwrap_or_default()),
            );
        }
        Step::Rays { pixels, .. } => rectangle(&mut svg, *pixels, "rays"),
        Step::EdgeTable { rows: [first, end], .. } => {
            rectangle(&mut svg, [0, *first, width, end - first], "line");
        }
        Step::Line { row, spans, .. } => {
            rectangle(&mut svg, [0, *row, width, 1], "line");
            for span in spans {
                rectangle(
                    &mut svg,
                    [span.pixels[0], *row, span.pixels[1] - span.pixels[0], 1],
                    "span",
                );
            }
        }

        // Draw the pixels that a facet, a comparison or a ray is about.
        Step::Drawn { stays, hidden, .. } => {
            runs(&mut svg, hidden, "hidden");
            runs(&mut svg, stays, "stays");
        }
        Step::DepthTest { pixel: [x, y], .. }
        | Step::RayMeets { pixel: [x, y], .. }
        | Step::RayGoesOn { pixel: [x, y], .. } => rectangle(&mut svg, [*x, *y, 1, 1], "pixel"),
        Step::Overruled { samples, .. } => {
            let mut pixels: Vec<[u32; 2]> = samples.iter().map(|sample| sample.pixel).collect();
            pixels.dedup();
            pixels.iter().for_each(|[x, y]| rectangle(&mut svg, [*x, *y, 1, 1], "pixel"));
        }

        // Draw the polygons of lists and trees.
        Step::Piece { facet, outline, .. } => polygon(&mut svg, outline, "piece", *facet),
        Step::Clip { facet, outline, cut, .. } => clip(&mut svg, *facet, outline, cut),
        Step::Visible { facet, contours, .. } => path(&mut svg, contours, "visible", *facet),
        _ => polygons(&mut svg, recording, step)?,
    }
    svg.push_str("</svg>");
    Ok(svg)
}

/// The polygons that a step about a list or a tree names.
fn polygons(svg: &mut String, recording: &Recording, step: &Step) -> Result<(), Error> {
    let picture = &recording.renderer.settings.picture;
    match step {
        Step::Turn { polygon, facet } | Step::Painted { polygon, facet } => {
            listed(svg, recording, *polygon, *facet, "p")?;
        }
        Step::Moved { polygon, facet, before_polygon, before } => {
            listed(svg, recording, *before_polygon, *before, "q")?;
            listed(svg, recording, *polygon, *facet, "p")?;
        }
        Step::Compared { polygon, facet, with, with_facet, .. } => {
            // Draw both with the rectangles of their extents, which tests 1 and 2 compare.
            for (number, facet, class) in [(*with, *with_facet, "q"), (*polygon, *facet, "p")] {
                let parts = listed(svg, recording, number, facet, class)?;
                extent(svg, &parts, &format!("extent {class}"));
            }
        }
        Step::Circle { polygons, facets } => {
            for (polygon, facet) in polygons.iter().zip(facets) {
                listed(svg, recording, *polygon, *facet, "p")?;
            }
        }
        Step::Split { polygon, facet, by, by_facet, line, .. } => {
            listed(svg, recording, *by, *by_facet, "q")?;
            listed(svg, recording, *polygon, *facet, "p")?;
            across(svg, *line, [picture.width, picture.height]);
        }
        Step::TreeNode { splitter, coincident, cut, .. } => {
            facets(svg, recording, &cut.facets, "cut")?;
            facets(svg, recording, &coincident.facets, "piece")?;
            facets(svg, recording, splitter.as_slice(), "splitter")?;
        }
        Step::TreeVisit { polygons, .. } => {
            facets(svg, recording, &polygons[..polygons.len().min(MOST_FACETS)], "piece")?;
        }
        Step::Clipped { facet, .. } => facets(svg, recording, &[*facet], "clip")?,
        _ => {}
    }
    Ok(())
}

/// A polygon of the painter's list: its own piece, or the pieces that it was split into; those of
/// its first facet where no piece is left. Returns the outlines.
fn listed(
    svg: &mut String,
    recording: &Recording,
    number: u32,
    first_facet: u32,
    class: &str,
) -> Result<Vec<Vec<[f32; 2]>>, Error> {
    // Collect the number of the polygon and those of its parts.
    let mut numbers = BTreeSet::from([number]);
    for told in &recording.watched.steps {
        if let Step::Split { polygon, parts, .. } = &told.step
            && numbers.contains(polygon)
        {
            numbers.extend(parts.iter().map(|part| part.polygon));
        }
    }

    // Collect their pieces.
    let mut outlines: Vec<Vec<[f32; 2]>> = Vec::new();
    for told in &recording.watched.steps {
        if let Step::Piece { polygon, outline, .. } = &told.step
            && numbers.contains(polygon)
        {
            outlines.push(outline.clone());
        }
    }
    if outlines.is_empty() {
        outlines = facet_shapes(recording, &[first_facet])?;
    }
    outlines.iter().for_each(|outline| polygon(svg, outline, class, first_facet));
    Ok(outlines)
}

/// The outlines of facets.
fn facets(svg: &mut String, recording: &Recording, ids: &[u32], class: &str) -> Result<(), Error> {
    for (outline, facet) in facet_shapes(recording, ids)?.iter().zip(ids) {
        polygon(svg, outline, class, *facet);
    }
    Ok(())
}

fn facet_shapes(recording: &Recording, ids: &[u32]) -> Result<Vec<Vec<[f32; 2]>>, Error> {
    let renderer = &recording.renderer;
    let outlines = facet_outlines(renderer, &renderer.frame_camera(), ids)?;
    let single = |outline: Vec<[f64; 2]>| outline.iter().map(|p| p.map(|v| v as f32)).collect();
    Ok(outlines.into_iter().map(single).collect())
}

/// A clip: the inside, removed and outside parts of polygons, below the clipping polygon.
fn clip(svg: &mut String, facet: u32, outline: &[[f32; 2]], cut: &[CutPolygon]) {
    for polygon in cut {
        path(svg, &polygon.outside, "outside", polygon.facet);
        path(svg, &polygon.hidden, "removed", polygon.facet);
        path(svg, &polygon.inside, "inside", polygon.facet);
    }
    polygon(svg, outline, "clip", facet);
}

// Writing to a String cannot fail.

fn rectangle(svg: &mut String, [x, y, width, height]: [u32; 4], class: &str) {
    let _ =
        write!(svg, r#"<rect class="{class}" x="{x}" y="{y}" width="{width}" height="{height}"/>"#);
}

/// Rows of pixels as one path.
fn runs(svg: &mut String, runs: &[[u32; 3]], class: &str) {
    if runs.is_empty() {
        return;
    }
    let _ = write!(svg, r#"<path class="{class}" d=""#);
    for [row, from, to] in runs {
        let _ = write!(svg, "M{from} {row}h{}v1H{from}z", to - from);
    }
    svg.push_str("\"/>");
}

fn polygon(svg: &mut String, corners: &[[f32; 2]], class: &str, facet: u32) {
    if corners.is_empty() {
        return;
    }
    let points: Vec<String> = corners.iter().map(|[x, y]| format!("{x},{y}")).collect();
    let points = points.join(" ");
    let _ = write!(svg, r#"<polygon class="{class}" data-facet="{facet}" points="{points}"/>"#);
}

fn path(svg: &mut String, contours: &[Contour], class: &str, facet: u32) {
    if contours.is_empty() {
        return;
    }
    let _ = write!(svg, r#"<path class="{class}" data-facet="{facet}" fill-rule="evenodd" d=""#);
    for contour in contours {
        for (i, [x, y]) in contour.corners.iter().enumerate() {
            let _ = write!(svg, "{}{x} {y}", if i == 0 { 'M' } else { 'L' });
        }
        svg.push('Z');
    }
    svg.push_str("\"/>");
}

/// The rectangle round outlines.
fn extent(svg: &mut String, outlines: &[Vec<[f32; 2]>], class: &str) {
    let corners = || outlines.iter().flatten();
    let least = |k: usize| corners().map(|p| p[k]).fold(f32::INFINITY, f32::min);
    let largest = |k: usize| corners().map(|p| p[k]).fold(f32::NEG_INFINITY, f32::max);
    let ([x, y], [right, bottom]) = ([least(0), least(1)], [largest(0), largest(1)]);
    if x < right && y < bottom {
        let (width, height) = (right - x, bottom - y);
        let _ = write!(
            svg,
            r#"<rect class="{class}" x="{x}" y="{y}" width="{width}" height="{height}"/>"#
        );
    }
}

/// The part of the line `a x + b y + c = 0` that lies in the picture.
fn across(svg: &mut String, [a, b, c]: [f64; 3], size: [u32; 2]) {
    let [width, height] = size.map(f64::from);
    // Find where it crosses the sides that it is steeper to.
    let [[x1, y1], [x2, y2]] = if b.abs() >= a.abs() {
        [0.0, width].map(|x| [x, -(a * x + c) / b])
    } else {
        [0.0, height].map(|y| [-(b * y + c) / a, y])
    };
    if [x1, y1, x2, y2].iter().all(|v| v.is_finite()) {
        let _ = write!(
            svg,
            r#"<line class="split-line" x1="{x1:.2}" y1="{y1:.2}" x2="{x2:.2}" y2="{y2:.2}"/>"#
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral::internals::render::trace::Passed;

    #[test]
    fn a_step_is_drawn_where_it_is() {
        let rays = Step::Rays {
            pixels: [2, 3, 8, 4],
            rays: 1,
            boxes: 0,
            facets: 0,
            tested: vec![],
            through: Passed::Nowhere,
        };
        assert_eq!(place(&rays), [2, 3]);
        let mut svg = String::new();
        rectangle(&mut svg, [2, 3, 8, 4], "rays");
        assert!(svg.contains(r#"x="2" y="3" width="8" height="4""#), "{svg}");
        svg.clear();
        runs(&mut svg, &[[5, 1, 4]], "stays");
        assert!(svg.contains("M1 5h3v1H1z"), "{svg}");
    }

    #[test]
    fn a_line_of_a_split_crosses_the_picture() {
        let mut svg = String::new();
        across(&mut svg, [0.0, 1.0, -4.0], [20, 10]);
        assert!(svg.contains(r#"x1="0.00" y1="4.00" x2="20.00" y2="4.00""#), "{svg}");
        svg.clear();
        across(&mut svg, [1.0, 0.0, -7.0], [20, 10]);
        assert!(svg.contains(r#"x1="7.00" y1="0.00" x2="7.00" y2="10.00""#), "{svg}");
    }

    #[test]
    fn p11_extents_hold_their_outlines() {
        let mut svg = String::new();
        extent(&mut svg, &[vec![[1.0, 2.0], [5.0, 3.0], [4.0, 8.0]]], "extent p");
        assert!(svg.contains(r#"x="1" y="2" width="4" height="6""#), "{svg}");
    }
}
