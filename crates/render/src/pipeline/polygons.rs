//! The polygons of a visible-surface algorithm in its own order, for vector drawings: no sample is
//! looked at.
//!
//! The algorithm sees a picture as large as pictures can be: its grid of 1/256 pixel has up to 2^22
//! steps a side. Surfaces through which something behind would be seen count as opaque.

use crate::stats::CullCounters;
use crate::visible::PolygonList;
use crate::{
    Error, Execution, Lines, PreparedView, Session, Settings, SettingsError, Transparency,
    Visibility, registry,
};
use vitral_raster::{MAX_SIDE, SamplePattern, Viewport};
use vitral_scene::Camera;

/// Samples a pixel: what lies between two lines of samples is not brought to the screen, and so
/// many leave steps of 1/16 pixel.
const SAMPLES: usize = 16;

/// The polygons that `settings.visibility` comes to, in a view of the shape of the picture of
/// `settings`.
///
/// # Errors
/// An algorithm that comes to no polygons, settings that cannot be carried out, or a limit that was
/// reached.
pub fn outlined_polygons(
    session: &Session,
    camera: &Camera,
    settings: &Settings,
    execution: &Execution,
) -> Result<PolygonList, Error> {
    let visibility = settings.visibility;
    let Some(algorithm) = registry::polygons(visibility) else {
        let choices = Visibility::names(|row| row.polygons.is_some());
        return Err(SettingsError::Polygons { visibility, choices }.into());
    };

    // Take the largest picture of this shape, in which everything is opaque.
    let small = settings.check()?;
    let factor = MAX_SIDE / small.width.max(small.height);
    let viewport = Viewport::new(small.width * factor, small.height * factor).unwrap_or(small);
    let mut settings = settings.clone().with_lines(Lines::None);
    settings.transparency.model = Transparency::None;

    // Cull, and let the algorithm find its polygons.
    let (pattern, culled) = (SamplePattern::new(SAMPLES), &mut CullCounters::default());
    let execution = &Execution { observer: None, ..execution.clone() };
    execution.budget.check("preparing the view")?;
    let view = PreparedView::new(session, camera, &settings, viewport, pattern, execution, culled);
    let mut list = PolygonList::new(viewport);
    algorithm.polygons(&view, execution, &mut list)?;
    Ok(list)
}
