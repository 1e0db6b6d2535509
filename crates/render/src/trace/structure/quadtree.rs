//! Warnock's windows: in the picture, and as a tree that shows how they come from each other.

use super::super::numbered::NumberedStep;
use super::super::picture::MARKS;
use super::super::{Step, WindowVerdict};
use super::svg_picture::{GREY, INK, LINE, MARGIN, Picture};
use std::collections::HashMap;

/// Windows of a level that are drawn one by one. Of a larger level the number is written.
const MAX_WINDOWS: usize = 48;
/// From node to node, and from level to level.
const ACROSS: f64 = 26.0;
const DOWN: f64 = 60.0;
/// Size of a node's box.
const BOX: [f64; 2] = [20.0, 16.0];
/// The longer side of the picture in the drawing.
const SIDE: f64 = 512.0;

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

/// Draws the windows of a trace: in a picture of `width` x `height` pixels on top, as a tree below,
/// in which nodes tell how many polygons are on the list. Levels with more than a few dozen windows
/// are summed up.
pub fn quadtree_svg(steps: &[NumberedStep], width: u32, height: u32) -> String {
    let windows: Vec<Window> = steps.iter().filter_map(window).collect();
    let title = format!("Area subdivision: {} window(s)", windows.len());
    let mut picture = Picture::new(
        &title,
        &[
            "The windows that were not cut. Below: the tree, with the polygons on each window's list.",
        ],
    );
    legend(&mut picture);
    plan(&windows, SIDE / f64::from(width.max(height).max(1)), &mut picture);
    tree(&windows, &mut picture);
    picture.finish()
}

fn window(step: &NumberedStep) -> Option<Window> {
    let Step::Window { pixels, path, contained, intersecting, surrounding, verdict, .. } =
        &step.step
    else {
        return None;
    };
    let polygons = contained.len() + intersecting.len() + surrounding.len();
    let (number, parent, depth) = (step.number, step.parent, path.len());
    Some(Window { number, parent, pixels: *pixels, depth, polygons, verdict: *verdict })
}

/// The colour of a verdict: that of the picture of steps.
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

/// The colours with their meaning, in a row.
fn legend(picture: &mut Picture) {
    let kinds = [
        (WindowVerdict::Cut, "cut"),
        (WindowVerdict::Empty, "empty"),
        (WindowVerdict::One, "one polygon"),
        (WindowVerdict::Surrounded, "surrounded"),
        (WindowVerdict::Pixel, "one pixel"),
    ];
    let (mut x, y) = (MARGIN, picture.bottom());
    for (verdict, text) in kinds {
        picture.rectangle([x, y], [12.0, 12.0], INK, &color(verdict));
        x = picture.text([x + 18.0, y + 11.0], text, INK, "start") + MARGIN;
    }
}

/// The windows that were not cut, in the picture.
fn plan(windows: &[Window], scale: f64, picture: &mut Picture) {
    let top = picture.bottom();
    for window in windows.iter().filter(|w| w.verdict != WindowVerdict::Cut) {
        let [x, y, width, height] = window.pixels.map(|v| f64::from(v) * scale);
        picture.rectangle([MARGIN + x, top + y], [width, height], INK, &color(window.verdict));
    }
}

/// The tree, level by level.
fn tree(windows: &[Window], picture: &mut Picture) {
    // Sort the windows by level.
    let levels = windows.iter().map(|w| w.depth + 1).max().unwrap_or(0);
    let by_level: Vec<Vec<&Window>> =
        (0..levels).map(|level| windows.iter().filter(|w| w.depth == level).collect()).collect();
    let widest =
        by_level.iter().map(Vec::len).filter(|count| *count <= MAX_WINDOWS).max().unwrap_or(1);
    let width = (widest as f64 * ACROSS).max(SIDE);

    // Links begin at the boxes of the level above.
    let mut places: HashMap<u32, [f64; 2]> = HashMap::new();
    let mut y = picture.bottom() + LINE;
    for level in &by_level {
        if level.len() > MAX_WINDOWS {
            let told = format!("{} windows", level.len());
            picture.text([MARGIN + width / 2.0, y + 4.0], &told, GREY, "middle");
        } else {
            let step = width / level.len() as f64;
            for (i, window) in level.iter().enumerate() {
                let place = [MARGIN + (i as f64 + 0.5) * step, y];
                places.insert(window.number, place);
                if let Some([x, above]) = window.parent.and_then(|parent| places.get(&parent)) {
                    picture.line(
                        [*x, above + BOX[1] / 2.0],
                        [place[0], y - BOX[1] / 2.0],
                        GREY,
                        1.0,
                    );
                }
                node(window, place, picture);
            }
        }
        y += DOWN;
    }
}

/// A window in the tree.
fn node(window: &Window, [x, y]: [f64; 2], picture: &mut Picture) {
    picture.rectangle([x - BOX[0] / 2.0, y - BOX[1] / 2.0], BOX, INK, &color(window.verdict));
    picture.text([x, y + 4.0], &window.polygons.to_string(), INK, "middle");
}

#[cfg(test)]
mod tests {
    use super::super::super::numbered::numbered;
    use super::*;

    #[test]
    fn every_window_is_drawn_once() {
        let window = |path: &str, pixels, verdict| {
            let mut step = crate::trace::tests::window(pixels, verdict);
            if let Step::Window { path: own, .. } = &mut step {
                own.push_str(path);
            }
            step
        };
        let cut = window("", [0, 0, 64, 64], WindowVerdict::Cut);
        let parts = [("0", [0, 0]), ("1", [32, 0]), ("2", [0, 32]), ("3", [32, 32])];
        let parts = parts.map(|(path, [x, y])| window(path, [x, y, 32, 32], WindowVerdict::Empty));
        let svg = quadtree_svg(&numbered([cut].into_iter().chain(parts).collect()), 64, 64);
        // Five kinds, four windows in the picture, five in the tree with four links.
        assert_eq!(svg.matches("<rect x=").count(), 5 + 4 + 5);
        assert_eq!(svg.matches("<line ").count(), 4);
        assert!(svg.contains(">Area subdivision: 5 window(s)<"), "{svg}");
    }
}
