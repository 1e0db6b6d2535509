//! The quadtree of Warnock's windows as a drawing: the windows in the picture, and how they come from each other.
//!
//! In:   numbered steps. Out: an SVG text, in pixels.
//! Cost: linear in windows.

use super::numbered::NumberedStep;
use super::picture::MARKS;
use super::{Step, WindowVerdict};
use std::collections::HashMap;
use std::fmt::Write;

/// A window that was looked at.
struct Window {
    number: u32,
    parent: Option<u32>,
    pixels: [u32; 4],
    depth: usize,
    /// Polygons on its list.
    polygons: usize,
    verdict: WindowVerdict,
}

/// Windows of a level that are drawn one by one; of a larger level the number is written.
const MOST: usize = 48;

/// Between two nodes, between two levels, and round everything, pixels.
const ACROSS: f64 = 26.0;
const DOWN: f64 = 60.0;
const MARGIN: f64 = 24.0;

/// The longer side of the picture in the drawing, pixels.
const SIDE: f64 = 512.0;

/// The windows of a trace: in a picture of `width` x `height` pixels on top, as a tree below. Levels with more than a few dozen windows are
/// summed up.
pub fn quadtree_svg(steps: &[NumberedStep], width: u32, height: u32) -> String {
    let windows: Vec<Window> = steps.iter().filter_map(window).collect();
    let scale = SIDE / f64::from(width.max(height).max(1));
    let (plan_width, plan_height) = (f64::from(width) * scale, f64::from(height) * scale);
    let mut body = String::new();
    plan(&windows, scale, &mut body);
    let top = MARGIN + plan_height + 2.0 * MARGIN;
    let (tree_width, bottom) = tree(&windows, top, &mut body);
    let (legend_top, full_width) = (bottom + MARGIN, tree_width.max(plan_width).max(SIDE) + 2.0 * MARGIN);
    legend(legend_top, &mut body);
    let full_height = legend_top + 2.0 * MARGIN;
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{full_width:.0}\" height=\"{full_height:.0}\" \
         viewBox=\"0 0 {full_width:.0} {full_height:.0}\" font-family=\"sans-serif\" font-size=\"10\">\n\
         <title>Area subdivision: {} windows</title>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n{body}</svg>\n",
        windows.len()
    )
}

fn window(step: &NumberedStep) -> Option<Window> {
    let Step::Window { pixels, path, contained, intersecting, surrounding, verdict, .. } = &step.step else {
        return None;
    };
    let polygons = contained.len() + intersecting.len() + surrounding.len();
    let (number, parent, depth) = (step.number, step.parent, path.len());
    Some(Window { number, parent, pixels: *pixels, depth, polygons, verdict: *verdict })
}

/// The colour of a verdict.
fn color(verdict: WindowVerdict) -> String {
    let [r, g, b] = match verdict {
        WindowVerdict::Empty => MARKS[0],
        WindowVerdict::One => MARKS[1],
        WindowVerdict::Surrounded => MARKS[2],
        WindowVerdict::Pixel => MARKS[3],
        WindowVerdict::Cut => [255; 3],
    };
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The windows that were not cut, in the picture. Writing to a String cannot fail.
fn plan(windows: &[Window], scale: f64, body: &mut String) {
    let _ = writeln!(body, "<g stroke=\"#444\" stroke-width=\"0.5\" fill-opacity=\"0.6\">");
    for window in windows.iter().filter(|w| w.verdict != WindowVerdict::Cut) {
        let [x, y, width, height] = window.pixels.map(|v| f64::from(v) * scale);
        let (x, y, fill) = (x + MARGIN, y + MARGIN, color(window.verdict));
        let _ = writeln!(
            body,
            "<rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{height:.2}\" fill=\"{fill}\"/>"
        );
    }
    let _ = writeln!(body, "</g>");
}

/// The tree, level by level; returns how wide it is and where it ends.
fn tree(windows: &[Window], top: f64, body: &mut String) -> (f64, f64) {
    let levels = windows.iter().map(|w| w.depth + 1).max().unwrap_or(0);
    let by_level: Vec<Vec<&Window>> =
        (0..levels).map(|level| windows.iter().filter(|w| w.depth == level).collect()).collect();
    let widest = by_level.iter().map(Vec::len).filter(|count| *count <= MOST).max().unwrap_or(1);
    let tree_width = widest as f64 * ACROSS;
    let mut places: HashMap<u32, [f64; 2]> = HashMap::new();
    let mut y = top;
    for level in &by_level {
        if level.len() > MOST {
            let _ = writeln!(
                body,
                "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\" fill=\"#555\">{} windows</text>",
                MARGIN + tree_width / 2.0,
                y + 4.0,
                level.len()
            );
        } else {
            let step = tree_width / level.len() as f64;
            for (i, window) in level.iter().enumerate() {
                let place = [MARGIN + (i as f64 + 0.5) * step, y];
                places.insert(window.number, place);
                if let Some([x0, y0]) = window.parent.and_then(|parent| places.get(&parent)) {
                    let [x, y] = place;
                    let line = format!("x1=\"{x0:.1}\" y1=\"{:.1}\" x2=\"{x:.1}\" y2=\"{:.1}\"", y0 + 8.0, y - 8.0);
                    let _ = writeln!(body, "<line {line} stroke=\"#888\"/>");
                }
                node(window, place, body);
            }
        }
        y += DOWN;
    }
    (tree_width, y - DOWN + 8.0)
}

/// A window in the tree: the number of polygons on its list.
fn node(window: &Window, [x, y]: [f64; 2], body: &mut String) {
    let [left, top, width, height] = window.pixels;
    let (number, fill, polygons) = (window.number, color(window.verdict), window.polygons);
    let _ = writeln!(
        body,
        "<g><title>step {number}: {width} x {height} at {left},{top}, {polygons} polygon(s)</title>\
         <rect x=\"{:.1}\" y=\"{:.1}\" width=\"20\" height=\"16\" fill=\"{fill}\" stroke=\"#444\"/>\
         <text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{polygons}</text></g>",
        x - 10.0,
        y - 8.0,
        y + 4.0
    );
}

/// What the colours mean.
fn legend(top: f64, body: &mut String) {
    let kinds = [
        (WindowVerdict::Cut, "cut; polygons on its list"),
        (WindowVerdict::Empty, "empty"),
        (WindowVerdict::One, "one polygon"),
        (WindowVerdict::Surrounded, "surrounded"),
        (WindowVerdict::Pixel, "one pixel"),
    ];
    let mut x = MARGIN;
    for (verdict, text) in kinds {
        let fill = color(verdict);
        let _ = writeln!(
            body,
            "<rect x=\"{x:.1}\" y=\"{top:.1}\" width=\"12\" height=\"12\" fill=\"{fill}\" stroke=\"#444\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\">{text}</text>",
            x + 17.0,
            top + 10.0
        );
        x += 34.0 + text.len() as f64 * 5.6;
    }
}

#[cfg(test)]
mod tests {
    use super::super::numbered::numbered;
    use super::*;

    #[test]
    fn every_window_is_drawn_once() {
        let window = |path: &str, pixels, verdict| {
            let mut step = super::super::tests::window(pixels, verdict);
            if let Step::Window { path: own, .. } = &mut step {
                own.push_str(path);
            }
            step
        };
        let cut = window("", [0, 0, 64, 64], WindowVerdict::Cut);
        let parts = [("0", [0, 0]), ("1", [32, 0]), ("2", [0, 32]), ("3", [32, 32])];
        let parts = parts.map(|(path, [x, y])| window(path, [x, y, 32, 32], WindowVerdict::Empty));
        let svg = quadtree_svg(&numbered([cut].into_iter().chain(parts).collect()), 64, 64);
        // Four in the plan, five in the tree with their texts, four lines, five kinds.
        assert_eq!(svg.matches("<rect x=").count(), 4 + 5 + 5);
        assert_eq!(svg.matches("<line ").count(), 4);
        assert!(svg.contains("<title>step 0: 64 x 64 at 0,0, 0 polygon(s)</title>"));
    }
}
