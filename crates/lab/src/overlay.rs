//! What a step is about, drawn over the picture, in its pixels.

use std::fmt::Write;
use vitral::internals::render::trace::Step;
use vitral::internals::render::trace::outlines::Contour;

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

/// An SVG of the picture's size with the step's windows, lines, outlines; each shape has a class
/// that says what it is.
pub(crate) fn drawing(step: &Step, width: u32, height: u32) -> String {
    let mut svg =
        format!(r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}">"#);
    match step {
        Step::Window { pixels, verdict, .. } => {
            let verdict = serde_json::to_value(verdict).unwrap_or_default();
            rectangle(
                &mut svg,
                *pixels,
                &format!("window {}", verdict.as_str().unwrap_or_default()),
            );
        }
        Step::Rays { pixels, .. } => rectangle(&mut svg, *pixels, "rays"),
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
        Step::Drawn { stays, hidden, .. } => {
            runs(&mut svg, hidden, "hidden");
            runs(&mut svg, stays, "stays");
        }
        Step::DepthTest { pixel: [x, y], .. }
        | Step::RayMeets { pixel: [x, y], .. }
        | Step::RayGoesOn { pixel: [x, y], .. } => rectangle(&mut svg, [*x, *y, 1, 1], "pixel"),
        Step::Piece { outline, .. } => polygon(&mut svg, outline, "piece"),
        Step::Clip { outline, .. } => polygon(&mut svg, outline, "clip"),
        Step::Visible { contours, .. } => path(&mut svg, contours),
        _ => {}
    }
    svg.push_str("</svg>");
    svg
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

fn polygon(svg: &mut String, corners: &[[f32; 2]], class: &str) {
    let points: Vec<String> = corners.iter().map(|[x, y]| format!("{x},{y}")).collect();
    let _ = write!(svg, r#"<polygon class="{class}" points="{}"/>"#, points.join(" "));
}

fn path(svg: &mut String, contours: &[Contour]) {
    svg.push_str(r#"<path class="visible" fill-rule="evenodd" d=""#);
    for contour in contours {
        for (i, [x, y]) in contour.corners.iter().enumerate() {
            let _ = write!(svg, "{}{x} {y}", if i == 0 { 'M' } else { 'L' });
        }
        svg.push('Z');
    }
    svg.push_str("\"/>");
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
        let svg = drawing(&rays, 20, 10);
        assert!(
            svg.contains(r#"viewBox="0 0 20 10""#)
                && svg.contains(r#"x="2" y="3" width="8" height="4""#),
            "{svg}"
        );
        let drawn = Step::Drawn { facet: 0, stays: vec![[5, 1, 4]], hidden: Vec::new() };
        assert!(drawing(&drawn, 20, 10).contains("M1 5h3v1H1z"));
    }
}
