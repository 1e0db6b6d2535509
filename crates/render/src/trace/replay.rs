//! The picture as it is after a step: what is decided so far, with what the step is about outlined.
//!
//! Algorithms that decide a place once and for all (windows, spans, rays, visible polygons) uncover
//! the picture there; the rest is paper. Those that overwrite (the z-buffer, lists painted from the
//! back) begin with the background: where another surface than the one that is seen in the end lies
//! on top, it has a pale colour of its own.
//!
//! In:   numbered steps, the finished picture, the surface that is seen at each pixel. Out: a
//!       picture for each step.
//! Cost: for each step the pixels that it is about, for each picture all pixels.

use super::canvas::Canvas;
use super::numbered::NumberedStep;
use super::outlines::{Contour, edges};
use super::{Step, WindowVerdict};
use vitral_frame::Plane;

/// The steps of a picture, and what is needed to tell what it was like after each.
#[derive(Debug)]
pub struct WatchedSteps {
    /// The steps, in order.
    pub steps: Vec<NumberedStep>,
    /// Whether more steps followed, for which there was no memory.
    pub more: bool,
    /// The finished picture, display colour.
    pub image: Plane<[u8; 4]>,
    /// The background of each row, display colour.
    pub background: Vec<[u8; 4]>,
    /// The surface that is seen at each pixel, row by row; none for the background.
    pub seen: Vec<Option<u32>>,
    /// The surface of the facet that a step draws, where it may be drawn over; by the step's
    /// number.
    pub drawn: Vec<Option<u32>>,
}

/// A picture after one step after the other.
#[derive(Debug)]
pub struct Replay<'w> {
    watched: &'w WatchedSteps,
    canvas: Canvas,
    shown: Vec<Shown>,
    /// How many steps were taken.
    taken: usize,
}

/// What a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shown {
    /// Nothing yet.
    Paper,
    /// The background, as long as nothing is drawn over it.
    Background,
    /// What it shows in the end.
    Final,
    /// A surface that may be drawn over.
    Surface(u32),
}

/// The colour of what is not decided.
const PAPER: [u8; 3] = [246, 245, 240];

/// The colour of what the step is about.
const ABOUT: [u8; 3] = [225, 40, 40];

impl<'w> Replay<'w> {
    /// Before the first step.
    pub fn new(watched: &'w WatchedSteps) -> Self {
        let canvas = Canvas { width: watched.image.width(), height: watched.image.height() };
        let overwrites = watched.drawn.iter().any(Option::is_some);
        let at_first = if overwrites { Shown::Background } else { Shown::Paper };
        Self { watched, canvas, shown: vec![at_first; watched.seen.len()], taken: 0 }
    }

    /// Takes the steps up to the one with this number, that one too. Steps are not taken back.
    pub fn go_to(&mut self, number: usize) {
        let steps = &self.watched.steps;
        while self.taken <= number && self.taken < steps.len() {
            let drawn = self.watched.drawn[self.taken];
            self.take(&steps[self.taken].step, drawn);
            self.taken += 1;
        }
        // Nothing is left to decide after the last.
        if self.taken == steps.len() {
            let open = |shown: &&mut Shown| matches!(**shown, Shown::Paper | Shown::Background);
            self.shown.iter_mut().filter(open).for_each(|shown| *shown = Shown::Final);
        }
    }

    /// The picture after the steps that were taken, with what the last of them is about outlined.
    pub fn picture(&self) -> Plane<[u8; 4]> {
        let mut picture = self.decided();
        if let Some(last) = self.taken.checked_sub(1) {
            let mut data = picture.data().to_vec();
            self.outline(&self.watched.steps[last].step, &mut data);
            picture = Plane::from_rows(self.canvas.width, self.canvas.height, data)
                .expect("as many pixels as before");
        }
        picture
    }

    /// The picture after the steps that were taken: what is decided so far; after the last of all,
    /// the finished one.
    pub fn decided(&self) -> Plane<[u8; 4]> {
        let watched = self.watched;
        if self.taken == watched.steps.len() && !watched.more && self.taken > 0 {
            return watched.image.clone();
        }
        let pixel = |(i, shown): (usize, &Shown)| match *shown {
            Shown::Paper => opaque(PAPER),
            Shown::Background => self.watched.background[i / self.canvas.width as usize],
            Shown::Final => self.watched.image.data()[i],
            Shown::Surface(surface) if self.watched.seen[i] == Some(surface) => {
                self.watched.image.data()[i]
            }
            Shown::Surface(surface) => opaque(pale(surface)),
        };
        let data: Vec<[u8; 4]> = self.shown.iter().enumerate().map(pixel).collect();
        Plane::from_rows(self.canvas.width, self.canvas.height, data)
            .expect("as many pixels as before")
    }

    /// Takes a step, which draws a surface that may be drawn over, or none.
    fn take(&mut self, step: &Step, drawn: Option<u32>) {
        let (canvas, shown) = (self.canvas, &mut self.shown);
        let overwritten = drawn.map_or(Shown::Final, Shown::Surface);
        match step {
            Step::Window { verdict: WindowVerdict::Cut, .. } => {}
            Step::Window { pixels, .. } | Step::Rays { pixels, .. } => {
                rectangle(canvas, *pixels, |at| shown[at] = Shown::Final);
            }
            Step::Line { row, .. } => {
                rectangle(canvas, [0, *row, canvas.width, 1], |at| shown[at] = Shown::Final)
            }
            Step::Drawn { stays, .. } => runs(canvas, stays, |at| shown[at] = overwritten),
            Step::Piece { outline, .. } => {
                canvas.fill(edges(outline), |at| shown[at] = overwritten)
            }
            Step::Visible { contours, .. } => {
                canvas
                    .fill(contours.iter().flat_map(Contour::edges), |at| shown[at] = Shown::Final);
            }
            _ => {}
        }
    }

    /// Marks in a picture what a step is about.
    fn outline(&self, step: &Step, data: &mut [[u8; 4]]) {
        let canvas = self.canvas;
        let mut mark = |at: usize| data[at] = opaque(ABOUT);

        // Mark rectangles, rows, pixels or outlines, whichever the step names.
        match step {
            Step::Window { pixels, .. } | Step::Rays { pixels, .. } => sides(canvas, *pixels, mark),
            Step::Line { row, .. } => rectangle(canvas, [0, *row, canvas.width, 1], mark),
            Step::EdgeTable { rows: [first, end], .. } => {
                sides(canvas, [0, *first, canvas.width, end - first], mark)
            }
            Step::Drawn { stays, hidden, .. } => {
                // The border of what it covers, and every other pixel of what is hidden.
                let mut covers = vec![false; data.len()];
                runs(canvas, stays, |at| covers[at] = true);
                runs(canvas, hidden, |at| covers[at] = true);
                runs(canvas, hidden, |at| {
                    let (x, y) = (at % canvas.width as usize, at / canvas.width as usize);
                    if (x + y).is_multiple_of(3) {
                        data[at] = opaque(ABOUT);
                    }
                });
                let border = borders(canvas, &covers);
                border.into_iter().for_each(|at| data[at] = opaque(ABOUT));
            }
            Step::DepthTest { pixel: [x, y], .. } | Step::RayMeets { pixel: [x, y], .. } => {
                sides(canvas, [x.saturating_sub(2), y.saturating_sub(2), 5, 5], mark);
            }
            Step::Piece { outline, .. } | Step::Clip { outline, .. } => {
                edges(outline).for_each(|edge| canvas.line(edge, &mut mark));
            }
            Step::Visible { contours, .. } => {
                contours
                    .iter()
                    .flat_map(Contour::edges)
                    .for_each(|edge| canvas.line(edge, &mut mark));
            }
            _ => {}
        }
    }
}

fn opaque([r, g, b]: [u8; 3]) -> [u8; 4] {
    [r, g, b, 255]
}

/// The pale colour of a surface.
fn pale(surface: u32) -> [u8; 3] {
    let hash = surface.wrapping_add(1).wrapping_mul(0x9e37_79b9);
    [0, 8, 16].map(|shift| 150 + ((hash >> (shift + 8)) & 63) as u8)
}

/// Calls `f` with the pixels of a rectangle that are in the picture.
fn rectangle(canvas: Canvas, [left, top, width, height]: [u32; 4], mut f: impl FnMut(usize)) {
    for y in top..(top + height).min(canvas.height) {
        let row = y as usize * canvas.width as usize;
        (row + left as usize..row + (left + width).min(canvas.width) as usize).for_each(&mut f);
    }
}

/// Calls `f` with the outermost pixels of a rectangle.
fn sides(canvas: Canvas, [left, top, width, height]: [u32; 4], mut f: impl FnMut(usize)) {
    let (right, bottom) = ((left + width).max(1) - 1, (top + height).max(1) - 1);
    rectangle(canvas, [left, top, width, 1], &mut f);
    rectangle(canvas, [left, bottom, width, 1], &mut f);
    rectangle(canvas, [left, top, 1, height], &mut f);
    rectangle(canvas, [right, top, 1, height], &mut f);
}

/// Calls `f` with the pixels of runs.
fn runs(canvas: Canvas, runs: &[[u32; 3]], mut f: impl FnMut(usize)) {
    for &[row, from, to] in runs {
        rectangle(canvas, [from, row, to - from, 1], &mut f);
    }
}

/// The covered pixels beside one that is not covered.
fn borders(canvas: Canvas, covers: &[bool]) -> Vec<usize> {
    let (width, height) = (canvas.width as usize, canvas.height as usize);
    let is_inner = |at: usize| {
        let (x, y) = (at % width, at / width);
        x > 0 && x + 1 < width && y > 0 && y + 1 < height
    };
    let is_border = |&at: &usize| {
        covers[at]
            && !(is_inner(at)
                && [at - 1, at + 1, at - width, at + width].iter().all(|n| covers[*n]))
    };
    (0..covers.len()).filter(is_border).collect()
}

#[cfg(test)]
mod tests {
    use super::super::numbered::numbered;
    use super::*;

    const RED: [u8; 4] = [255, 0, 0, 255];

    #[test]
    fn facets_cover_each_other_as_they_come() {
        // The far facet covers all, the near one the right half.
        let drawn =
            |facet, from| Step::Drawn { facet, stays: vec![[0, from, 4]], hidden: Vec::new() };
        let steps = numbered(vec![drawn(0, 0), drawn(1, 2)]);
        let image = Plane::from_rows(4, 1, vec![RED; 4]).unwrap();
        let seen = vec![Some(7), Some(7), Some(8), Some(8)];
        let (background, drawn) = (vec![[9; 4]], vec![Some(7), Some(8)]);
        let watched = WatchedSteps { steps, more: false, image, background, seen, drawn };
        let mut replay = Replay::new(&watched);
        assert_eq!(replay.picture().data(), [[9; 4]; 4]);
        replay.go_to(0);
        assert_eq!(replay.shown, [Shown::Surface(7); 4]);
        replay.go_to(1);
        assert_eq!(
            replay.shown,
            [Shown::Surface(7), Shown::Surface(7), Shown::Surface(8), Shown::Surface(8)]
        );
        // All that is not outlined is as in the end.
        let picture = replay.picture();
        assert_eq!(picture.data()[..2], [RED; 2]);
        assert_eq!(picture.data()[2..], [opaque(ABOUT); 2]);
    }

    #[test]
    fn windows_uncover_the_picture() {
        let window = super::super::tests::window;
        let steps = vec![
            window([0, 0, 4, 4], WindowVerdict::Cut),
            window([0, 0, 2, 4], WindowVerdict::Empty),
        ];
        let steps = steps.into_iter().zip(0..).map(|(step, number)| NumberedStep {
            number,
            parent: None,
            step,
        });
        let image = Plane::from_rows(4, 4, vec![RED; 16]).unwrap();
        let (steps, background, seen, drawn) =
            (steps.collect(), vec![[9; 4]; 4], vec![None; 16], vec![None; 2]);
        let watched = WatchedSteps { steps, more: false, image, background, seen, drawn };
        let mut replay = Replay::new(&watched);
        replay.go_to(0);
        assert!(
            replay.shown.iter().all(|s| *s == Shown::Paper),
            "a window that is cut decides nothing"
        );
        assert_eq!(replay.picture().data()[5], opaque(PAPER), "only its sides are marked");
        replay.go_to(1);
        assert!(
            replay.shown.iter().all(|s| *s == Shown::Final),
            "the last step leaves nothing open"
        );
    }
}
