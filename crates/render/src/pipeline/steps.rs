//! The steps of the visibility algorithm, with one sample a pixel: drawn over the picture, or one
//! after the other.

use super::{FrameContext, Shot, render};
use crate::display::BackgroundRows;
use crate::stats::CullCounters;
use crate::trace::numbered::Collector;
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

/// Renders a picture, and keeps the steps of the visibility algorithm with one sample a pixel: all,
/// or with `most_bytes` the first that take no more memory.
///
/// # Errors
/// As [`render`]; without `most_bytes` [`Limit::Memory`](vitral_exec::Limit::Memory) if the steps
/// are too many for the budget.
pub fn watch_steps(
    session: &mut Session,
    shot: &Shot<'_>,
    settings: &Settings,
    execution: &Execution,
    most_bytes: Option<u64>,
) -> Result<WatchedSteps, Error> {
    let settings = &settings.clone().with_channels(Channels::default());
    let unwatched = Execution { observer: None, ..execution.clone() };
    let rendered = render(session, shot, settings, &unwatched)?;
    let image = rendered.frame.color.expect("the colour channel was asked for");

    // Look on while it finds the surfaces.
    let viewport = settings.check()?;
    let context = FrameContext { shot, settings, viewport, execution: &unwatched };
    let budget = match most_bytes {
        Some(_) => Budget::default().with_memory_limit(most_bytes),
        None => execution.budget.clone(),
    };
    let collector = Arc::new(Collector::new(budget, None));
    let seen = SeenFacets::new(viewport);
    context.resolve_watched(session, Arc::clone(&collector) as Arc<dyn Observer>, &seen)?;
    let (steps, more) = match most_bytes {
        Some(_) => collector.take_first(),
        None => (collector.take()?, false),
    };

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
    let picture = &settings.picture;
    let background = (picture.background, viewport.height, picture.color_space == ColorSpace::Raw);
    let background = BackgroundRows::new(&background).bytes;
    Ok(WatchedSteps { steps, more, image, background, seen, drawn })
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
