//! The steps of the visibility algorithm, with one sample a pixel: drawn over the picture, or one
//! after the other.

use super::{FrameContext, Shot, render};
use crate::display::BackgroundRows;
use crate::stats::CullCounters;
use crate::trace::numbered::{Collector, NumberedStep};
use crate::trace::replay::WatchedSteps;
use crate::trace::{Observer, Step, picture::Recorder};
use crate::visible::{NullSink, TileSink};
use crate::{Channels, ColorSpace, Error, Execution, Session, Settings};
use std::sync::{Arc, Mutex};
use vitral_exec::Budget;
use vitral_frame::{Frame, Plane};
use vitral_raster::{LayerList, NO_FACET, SamplePattern, TILE, Tile, TileGrid, Viewport};

impl FrameContext<'_> {
    /// The steps over the colour picture, which goes if it was not asked for.
    pub(super) fn render_steps(&self, session: &Session, frame: &mut Frame) -> Result<(), Error> {
        let Viewport { width, height, .. } = self.viewport;
        self.execution.budget.charged(
            Recorder::bytes(width, height),
            "the picture of the steps",
            || {
                let recorder = Arc::new(Recorder::new(width, height));
                self.resolve_watched(
                    session,
                    Arc::clone(&recorder) as Arc<dyn Observer>,
                    &NullSink,
                )?;
                frame.steps = frame.color.as_ref().map(|image| recorder.over(image));
                Ok(())
            },
        )?;
        if !self.settings.picture.channels.color {
            frame.color = None;
        }
        Ok(())
    }

    /// Finds the visible surfaces with one sample a pixel while `observer` looks on.
    fn resolve_watched(
        &self,
        session: &Session,
        observer: Arc<dyn Observer>,
        sink: &dyn TileSink,
    ) -> Result<(), vitral_exec::Limit> {
        let execution = Execution { observer: Some(observer), ..self.execution.clone() };
        let context = FrameContext { execution: &execution, ..*self };
        let mut grid = TileGrid::new(self.viewport, 1);
        let view = context.view(session, SamplePattern::new(1), &mut CullCounters::default());
        self.visibility().resolve(&view, None, &mut grid, &execution, sink)?;
        Ok(())
    }
}

/// Renders a picture, and keeps the steps of the visibility algorithm with one sample a pixel.
///
/// # Errors
/// As [`render`]; [`Limit::Memory`](vitral_exec::Limit::Memory) if the steps are too many.
pub fn watch_steps(
    session: &mut Session,
    shot: &Shot<'_>,
    settings: &Settings,
    execution: &Execution,
) -> Result<WatchedSteps, Error> {
    let settings = &settings.clone().with_channels(Channels::default());
    let unwatched = Execution { observer: None, ..execution.clone() };
    let image = color_of(render(session, shot, settings, &unwatched)?.frame);

    // Look on while it finds the surfaces.
    let viewport = settings.check()?;
    let context = FrameContext { shot, settings, viewport, execution: &unwatched };
    let collector = Arc::new(Collector::new(execution.budget.clone(), None));
    let seen = SeenFacets::new(viewport);
    context.resolve_watched(session, Arc::clone(&collector) as Arc<dyn Observer>, &seen)?;
    Ok(context.watched(session, (collector.take()?, false), image, seen))
}

/// Renders a picture, and keeps the first steps of all its algorithms with all samples of each
/// pixel, those that take no more than `most_bytes` of memory.
///
/// # Errors
/// As [`render`].
pub fn watch_picture(
    session: &mut Session,
    shot: &Shot<'_>,
    settings: &Settings,
    execution: &Execution,
    most_bytes: u64,
) -> Result<WatchedSteps, Error> {
    // Look on while the picture is rendered.
    let steps_budget = Budget::default().with_memory_limit(Some(most_bytes));
    let collector = Arc::new(Collector::new(steps_budget, None));
    let observer = Some(Arc::clone(&collector) as Arc<dyn Observer>);
    let observed = Execution { observer, ..execution.clone() };
    let image = color_of(render(session, shot, settings, &observed)?.frame);

    // Find what is seen at the centre of each pixel.
    let unwatched = Execution { observer: None, ..execution.clone() };
    let viewport = settings.check()?;
    let context = FrameContext { shot, settings, viewport, execution: &unwatched };
    let seen = SeenFacets::new(viewport);
    let mut grid = TileGrid::new(viewport, 1);
    let view = context.view(session, SamplePattern::new(1), &mut CullCounters::default());
    context.visibility().resolve(&view, None, &mut grid, &unwatched, &seen)?;
    drop(view);
    Ok(context.watched(session, collector.take_first(), image, seen))
}

fn color_of(frame: Frame) -> Plane<[u8; 4]> {
    frame.color.expect("the colour channel was asked for")
}

impl FrameContext<'_> {
    /// Puts together what a replay needs. `more` says whether the steps go on.
    fn watched(
        &self,
        session: &Session,
        (steps, more): (Vec<NumberedStep>, bool),
        image: Plane<[u8; 4]>,
        seen: SeenFacets,
    ) -> WatchedSteps {
        // Name surfaces instead of facets: a polygon is of several.
        let surface = |facet: u32| session.world().surface_of_facet(facet);
        let drawn = |step: &Step| match step {
            Step::Drawn { facet, .. } | Step::Piece { facet, .. } => Some(surface(*facet)),
            _ => None,
        };
        let drawn = steps.iter().map(|numbered| drawn(&numbered.step)).collect();
        let seen = seen
            .facets()
            .into_iter()
            .map(|facet| (facet != NO_FACET).then(|| surface(facet)))
            .collect();
        let picture = &self.settings.picture;
        let is_raw = picture.color_space == ColorSpace::Raw;
        let background = BackgroundRows::new(&(picture.background, self.viewport.height, is_raw));
        WatchedSteps { steps, more, image, background: background.bytes, seen, drawn }
    }
}

/// Keeps the opaque facet that is seen at each pixel.
struct SeenFacets {
    viewport: Viewport,
    facets: Mutex<Plane<u32>>,
}

impl SeenFacets {
    fn new(viewport: Viewport) -> Self {
        Self {
            viewport,
            facets: Mutex::new(Plane::filled(viewport.width, viewport.height, NO_FACET)),
        }
    }

    /// Row by row.
    fn facets(self) -> Vec<u32> {
        self.facets.into_inner().expect("no thread panics while it keeps facets").into_data()
    }
}

impl TileSink for SeenFacets {
    fn tile(&self, _: usize, tile: &Tile, _: &mut LayerList) {
        let mut facets = self.facets.lock().expect("no thread panics while it keeps facets");
        let Viewport { width, height, .. } = self.viewport;
        for y in tile.y..height.min(tile.y + TILE as u32) {
            for x in tile.x..width.min(tile.x + TILE as u32) {
                let place = (y - tile.y) as usize * TILE + (x - tile.x) as usize;
                facets.data_mut()[y as usize * width as usize + x as usize] = tile.facet[place];
            }
        }
    }
}
