//! A picture of an algorithm's steps, over the image in grey.
//!
//! - Windows and visible polygons: outlines; the window's verdict is its colour (green one polygon,
//!   yellow surrounded, red single pixels, blue empty).
//! - Lists: the order as a ramp from blue (the first, far) over green to red (the last, near), with
//!   the outlines of polygons that were cut.
//! - Everything else: what each pixel cost, from blue to red: facets over it, polygons in its
//!   spans, boxes and facets its rays were tested against.
//!
//! [`super::legend`] tells that to users. Steps are added as they come and not kept, so a large
//! model takes no more than the picture. Sums and maxima do not depend on the order of threads.

use super::canvas::Canvas;
use super::outlines::{Contour, edges};
use super::{Observer, Step, WindowVerdict};
use std::sync::Mutex;
use vitral_frame::Plane;

/// Draws steps.
#[derive(Debug)]
pub struct Recorder {
    canvas: Canvas,
    planes: Mutex<Planes>,
}

/// What is known of each pixel.
#[derive(Debug, Default)]
struct Planes {
    cost: Vec<u64>,
    /// 1 + place in the list of what is on top, 0 where nothing is.
    order: Vec<u32>,
    /// The same of the outline that is on top.
    outline: Vec<u32>,
    /// An outline's colour, 0 for none.
    mark: Vec<u8>,
}

/// Outlines: empty windows and visible polygons, one polygon, surrounded, single pixels.
pub(super) const MARKS: [[u8; 3]; 4] =
    [[70, 110, 220], [60, 190, 90], [250, 210, 60], [225, 60, 50]];

/// Outlines of polygons in a list that were cut.
pub(super) const OUTLINE: [u8; 3] = [20; 3];

/// What is added to a mark that lets the image through.
const FAINT: u8 = 8;

impl Recorder {
    /// For a picture of this size.
    pub fn new(width: u32, height: u32) -> Self {
        let count = width as usize * height as usize;
        let planes = Planes {
            cost: vec![0; count],
            order: vec![0; count],
            outline: vec![0; count],
            mark: vec![0; count],
        };
        Self { canvas: Canvas { width, height }, planes: Mutex::new(planes) }
    }

    /// Bytes that it takes.
    pub fn bytes(width: u32, height: u32) -> u64 {
        u64::from(width) * u64::from(height) * 24
    }

    /// The steps over `image`.
    pub fn over(&self, image: &Plane<[u8; 4]>) -> Plane<[u8; 4]> {
        // Find the largest values, to which colours are relative.
        let planes = self.planes.lock().expect("no thread panics while it draws steps");
        let most = |values: &mut dyn Iterator<Item = u64>| values.max().unwrap_or(0).max(1) as f32;
        let dearest = most(&mut planes.cost.iter().copied());
        let last = most(&mut planes.order.iter().map(|&o| u64::from(o)));
        let lists = planes.order.iter().any(|&o| o > 0);

        // Colour each pixel: marks first, then the place in the list, then the cost.
        let pixel = |i: usize, &[r, g, b, _]: &[u8; 4]| {
            // Light grey, so that colours can be told from the image.
            let grey = (u32::from(r) * 77 + u32::from(g) * 150 + u32::from(b) * 29) / 256;
            let light = 0.45 + grey as f32 / 255.0 * 0.5;
            let shade = |color: [u8; 3]| color.map(|c| f32::from(c) * light);
            let color = if planes.mark[i] > FAINT {
                let color = shade(MARKS[usize::from(planes.mark[i] - FAINT) - 1]);
                color.map(|c| c * 0.4 + light * 255.0 * 0.6)
            } else if planes.mark[i] > 0 {
                MARKS[usize::from(planes.mark[i]) - 1].map(f32::from)
            } else if lists {
                match planes.order[i] {
                    0 => [light * 255.0; 3],
                    order if planes.outline[i] >= order => OUTLINE.map(f32::from),
                    order => shade(ramp(order as f32 / last)),
                }
            } else if planes.cost[i] > 0 {
                // The root lets cheap pixels be told apart beside dear ones.
                shade(ramp((planes.cost[i] as f32 / dearest).sqrt()))
            } else {
                [light * 255.0; 3]
            };
            let [r, g, b] = color.map(|c| (c + 0.5).clamp(0.0, 255.0) as u8);
            [r, g, b, 255]
        };
        let data = image.data().iter().enumerate().map(|(i, p)| pixel(i, p)).collect();
        Plane::from_rows(image.width(), image.height(), data).expect("as many pixels as before")
    }

    /// Adds the same cost to all pixels of a rectangle.
    fn spend(&self, planes: &mut Planes, [left, top, width, height]: [u32; 4], cost: u64) {
        for y in top..(top + height).min(self.canvas.height) {
            let row = y as usize * self.canvas.width as usize;
            let (from, to) =
                (row + left as usize, row + (left + width).min(self.canvas.width) as usize);
            planes.cost[from..to].iter_mut().for_each(|c| *c += cost);
        }
    }

    fn window(
        &self,
        planes: &mut Planes,
        [left, top, width, height]: [u32; 4],
        verdict: WindowVerdict,
    ) {
        let mark = match verdict {
            WindowVerdict::Empty => 1,
            WindowVerdict::One => 2,
            WindowVerdict::Surrounded => 3,
            WindowVerdict::Pixel => 4,
            WindowVerdict::Cut => return,
        };
        // Windows that are nothing but sides would hide the image.
        let mark = if width.max(height) < 3 { mark + FAINT } else { mark };
        // The upper and left sides are enough: the others are those of neighbours.
        let across = (left..left + width).map(|x| (x, top));
        let down = (top..top + height).map(|y| (left, y));
        for (x, y) in across.chain(down) {
            if let Some(at) = self.canvas.index(x.into(), y.into()) {
                planes.mark[at] = mark;
            }
        }
    }
}

impl Observer for Recorder {
    fn reads_clips(&self) -> bool {
        false
    }

    fn step(&self, step: &Step) {
        let planes = &mut *self.planes.lock().expect("no thread panics while it draws steps");
        match step {
            // Add a cost of one to each pixel that a facet covers.
            Step::Drawn { stays, hidden, .. } => {
                for &[row, from, to] in stays.iter().chain(hidden) {
                    self.spend(planes, [from, row, to - from, 1], 1);
                }
            }
            Step::DepthTest { .. } | Step::Box { .. } | Step::Clipped { .. } => {}

            // Outline a window in the colour of its verdict.
            Step::Window { pixels, verdict, .. } => self.window(planes, *pixels, *verdict),

            // Add to the cost the polygons of each span, and the boxes and facets that rays test.
            Step::Line { row, spans, .. } => {
                for span in spans {
                    let [from, to] = span.pixels;
                    self.spend(planes, [from, *row, to - from, 1], span.inside.len() as u64);
                }
            }
            Step::Rays { pixels, boxes, facets, .. } => {
                self.spend(planes, *pixels, boxes + facets);
            }

            // Enter a list's piece in the order, and outline it if it is cut.
            Step::Piece { order, cuts, outline, .. } => {
                self.canvas
                    .fill(edges(outline), |at| planes.order[at] = planes.order[at].max(order + 1));
                if *cuts > 0 {
                    for edge in edges(outline) {
                        self.canvas.line(edge, |at| {
                            planes.outline[at] = planes.outline[at].max(order + 1)
                        });
                    }
                }
            }

            // Outline a visible polygon.
            Step::Visible { contours, .. } => {
                for edge in contours.iter().flat_map(Contour::edges) {
                    self.canvas.line(edge, |at| planes.mark[at] = 1);
                }
            }

            // Leave out steps that have no pixels of their own to colour.
            Step::TreeNode { .. }
            | Step::TreeVisit { .. }
            | Step::FirstOrder { .. }
            | Step::Turn { .. } => {}
            Step::Compared { .. }
            | Step::Moved { .. }
            | Step::Circle { .. }
            | Step::Split { .. } => {}
            Step::Painted { .. } | Step::Overruled { .. } | Step::NearestFirst { .. } => {}
            Step::Clip { .. } | Step::Space { .. } | Step::EdgeTable { .. } => {}
            Step::RayMeets { .. } | Step::RayGoesOn { .. } => {}
        }
    }
}

/// The colours of the ramp.
pub(super) const STOPS: [[f32; 3]; 5] = [
    [50.0, 60.0, 200.0],
    [50.0, 170.0, 220.0],
    [90.0, 210.0, 90.0],
    [250.0, 220.0, 60.0],
    [230.0, 50.0, 40.0],
];

/// From blue over green and yellow to red, for 0 to 1.
fn ramp(t: f32) -> [u8; 3] {
    let place = t.clamp(0.0, 1.0) * 4.0;
    let i = (place as usize).min(3);
    let part = place - i as f32;
    [0, 1, 2].map(|k| (STOPS[i][k] + (STOPS[i + 1][k] - STOPS[i][k]) * part) as u8)
}

#[cfg(test)]
mod tests {
    use super::super::Passed;
    use super::super::legend::Legend;
    use super::super::tests::window;
    use super::*;

    #[test]
    fn what_is_on_top_of_the_list_has_its_colour() {
        let recorder = Recorder::new(4, 4);
        let square = |low: f32, high: f32| vec![[low, low], [high, low], [high, high], [low, high]];
        let piece = |order, outline| Step::Piece {
            order,
            polygon: 0,
            node: None,
            facet: 0,
            cuts: 0,
            outline,
        };
        // Told in the wrong order, as threads may.
        recorder.step(&piece(1, square(0.0, 2.0)));
        recorder.step(&piece(0, square(0.0, 4.0)));
        let order = recorder.planes.lock().unwrap().order.clone();
        assert_eq!(order, [2, 2, 1, 1, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1]);
        let image = Plane::from_rows(4, 4, vec![[255; 4]; 16]).unwrap();
        let shown = recorder.over(&image);
        assert_ne!(shown.data()[0], shown.data()[15]);
    }

    #[test]
    fn costs_add_up_and_windows_have_sides() {
        let recorder = Recorder::new(4, 2);
        let through = Passed::Cells(vec![[0; 3]; 5]);
        recorder.step(&Step::Rays {
            pixels: [2, 0, 8, 8],
            rays: 4,
            boxes: 5,
            facets: 2,
            tested: vec![1, 0],
            through,
        });
        recorder.step(&Step::Drawn { facet: 0, stays: vec![[0, 1, 4]], hidden: vec![[0, 3, 4]] });
        recorder.step(&Step::Drawn { facet: 1, stays: vec![], hidden: vec![[0, 3, 9]] });
        recorder.step(&window([0, 0, 4, 2], WindowVerdict::One));
        let planes = recorder.planes.lock().unwrap();
        assert_eq!(planes.cost, [0, 1, 8, 10, 0, 0, 7, 7]);
        assert_eq!(planes.mark, [2, 2, 2, 2, 2, 0, 0, 0]);
    }

    #[test]
    fn every_algorithm_draws_what_its_legend_says() {
        let scene = vitral_scene::builtin::scene("cubs").unwrap();
        let session = crate::Session::new(std::sync::Arc::new(scene)).unwrap();
        let viewport = vitral_raster::Viewport { width: 96, height: 72 };
        let camera = vitral_scene::framing::frame(
            &session.world().bounds,
            vitral_scene::View::Iso,
            vitral_scene::Axis::default(),
            vitral_scene::Lens::default(),
            96.0 / 72.0,
        );
        for algorithm in crate::registry::VISIBILITY {
            let settings = crate::Settings::default().with_visibility(algorithm.choice());
            let recorder = std::sync::Arc::new(Recorder::new(96, 72));
            let observer = Some(std::sync::Arc::clone(&recorder) as std::sync::Arc<dyn Observer>);
            let execution = crate::Execution { observer, ..crate::Execution::default() };
            let (pattern, culled) =
                (vitral_raster::SamplePattern::new(1), &mut crate::stats::CullCounters::default());
            let view = crate::PreparedView::new(
                &session, &camera, &settings, viewport, pattern, &execution, culled,
            );
            let mut grid = vitral_raster::TileGrid::new(viewport, 1);
            let resolved = algorithm.algorithm.resolve(
                &view,
                None,
                &mut grid,
                &execution,
                &crate::visible::NullSink,
            );
            resolved.unwrap();
            let planes = recorder.planes.lock().unwrap();
            let drawn = [
                planes.mark.iter().any(|m| *m > 1),
                planes.order.iter().any(|o| *o > 0),
                planes.mark.contains(&1),
                planes.cost.iter().any(|c| *c > 0),
            ];
            // What is drawn first hides the rest: marks, then the list, then costs.
            let first = drawn.iter().position(|d| *d);
            let expected = match algorithm.steps {
                Legend::Windows => 0,
                Legend::List => 1,
                Legend::Outlines => 2,
                Legend::Cost(_) => 3,
            };
            assert_eq!(first, Some(expected), "{}: {drawn:?}", algorithm.name);
        }
    }
}
