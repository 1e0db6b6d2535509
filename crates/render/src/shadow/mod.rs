//! Which part of each light arrives at a point: `S_j` of the course's formula
//!
//! `I = Ia ka + Σj S_j f_att,j Ip,j (kd (N·L_j) + ks (R_j·V)^n)`.
//!
//! A point that faces away from a light is in its own, *attached* shadow; one that something else
//! hides from the light is in a *cast* shadow. Attached means that the facet or the shading normal
//! faces away: a facet behind its own plane gets no light, whatever its interpolated normal says.
//! Ambient light is not touched.
//!
//! An algorithm is asked about points that are seen, after visibility was decided by whatever
//! algorithm, and about many neighbours at once: those of one object and material in a tile. What
//! it finds out for one may serve the next. [`crate::registry::SHADOWS`] lists them. A transparent
//! thing lets through what its opacity leaves, coloured by its filter where transparency is
//! filtered; a cut-out one lets light through its holes.

mod ambient_occlusion;
mod blocker;
mod casters;
mod contact;
mod facet;
mod ground;
mod hash;
mod light_rays;
pub mod map;
pub mod object_precision;
mod occluders;
mod place;
mod places;
pub mod ray;
mod rounding;
pub mod scan_line;
mod scattering;
mod sources;
pub mod volume;

pub(crate) use ambient_occlusion::AmbientOcclusion;
pub(crate) use blocker::blocker;
pub(crate) use facet::{facet, weighted, weights};
pub(crate) use ground::Ground;
pub(crate) use hash::hash;
pub(crate) use occluders::{Occluders, texel};
pub(crate) use place::Placing;
pub use places::{LightVisibility, SurfacePoint, SurfacePoints};
pub(crate) use rounding::clearance;
pub(crate) use scattering::Strata;

use crate::{Execution, PreparedView, Session, Settings, Transparency};
use vitral_exec::Limit;
use vitral_light::{Light, Rgb};
use vitral_math::{DVec3, DVec4};

/// Shadows of one set of lights in one scene.
pub trait PreparedShadows: Send + Sync {
    /// Which part of each colour of the light of this number reaches each of the places, `0..=1`,
    /// into as many `parts`. Other places in the same call do not change the answer. Adds the rays
    /// that it took.
    fn light_visibility(
        &self,
        light: usize,
        places: &SurfacePoints,
        parts: &mut LightVisibility,
        rays: &mut u64,
    );

    /// Whether answers change little from pixel to pixel, so that samples of one pixel have the
    /// same.
    fn is_smooth(&self) -> bool {
        false
    }

    /// Hands on the polygons that it works with; nothing where
    /// [`ShadowInfo::polygons`](crate::catalogue::ShadowInfo::polygons) says so.
    fn draw(&self, _: &mut dyn FnMut(Drawn<'_>)) {}
}

/// A polygon that a shadow algorithm works with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drawn<'a> {
    /// The light's number.
    pub light: usize,
    /// What it is: `lit`; a `shadow` on the polygon that it falls on, or a `tinted-shadow` of
    /// something transparent; or a `side`, `near-cap` or `far-cap` of a volume.
    pub kind: &'static str,
    /// The facet that a lit polygon is a part of.
    pub facet: Option<u32>,
    /// World space.
    pub corners: &'a [DVec3],
}

/// A way to find shadows.
pub trait ShadowAlgorithm: Sync {
    /// Makes ready for questions about these lights (world space). `viewer` is where projectors
    /// meet, homogeneous (world space; `w` is 0 in a parallel view), for algorithms that begin
    /// there; the answers do not depend on it.
    ///
    /// # Errors
    /// A limit of the budget.
    fn prepare<'a>(
        &self,
        session: &'a Session,
        lights: &[Light],
        viewer: DVec4,
        settings: &Settings,
        execution: &Execution,
    ) -> Result<Box<dyn PreparedShadows + 'a>, Limit>;

    /// Makes ready for a picture of this view: [`Self::prepare`], but for algorithms whose
    /// precision follows the viewer.
    ///
    /// # Errors
    /// A limit of the budget.
    fn prepare_for<'a>(
        &self,
        view: &PreparedView<'a>,
        lights: &[Light],
        settings: &Settings,
        execution: &Execution,
    ) -> Result<Box<dyn PreparedShadows + 'a>, Limit> {
        self.prepare(view.session, lights, view.viewer(), settings, execution)
    }
}

/// What shadows depend on, besides the scene.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ShadowKey {
    lights: Vec<Light>,
    samples: u32,
    transparency: Transparency,
}

impl ShadowKey {
    fn new(lights: &[Light], settings: &Settings) -> Self {
        Self {
            lights: lights.to_vec(),
            samples: settings.shadows.light_samples,
            transparency: settings.transparency.model,
        }
    }
}

/// The mean of three channels, written so that grey stays as it is.
pub(crate) fn grey([r, g, b]: Rgb) -> f32 {
    r + ((g - r) + (b - r)) / 3.0
}

/// Bytes that are charged to the budget together while polygons are handed on.
const CHARGED_AHEAD: u64 = 1 << 20;

/// Hands on the polygons that an algorithm works with, none for `None`, until a limit is reached.
/// `take` says how many bytes it keeps of all that it got; the budget allows them or ends it.
///
/// # Errors
/// The limit; what was handed on until then stays handed on.
pub fn draw(
    algorithm: Option<&dyn ShadowAlgorithm>,
    session: &Session,
    lights: &[Light],
    settings: &Settings,
    execution: &Execution,
    take: &mut dyn FnMut(Drawn<'_>) -> u64,
) -> Result<(), Limit> {
    let Some(algorithm) = algorithm else { return Ok(()) };
    // They are the same for every viewer.
    let shadows = algorithm.prepare(session, lights, DVec4::Z, settings, execution)?;
    let budget = &execution.budget;
    let (mut charged, mut kept, mut within) = (0, 0, Ok(()));
    shadows.draw(&mut |polygon| {
        if within.is_ok() && kept + CHARGED_AHEAD / 2 > charged {
            within = budget
                .check("shadow polygons")
                .and_then(|()| budget.charge(CHARGED_AHEAD, "shadow polygons"));
            charged += if within.is_ok() { CHARGED_AHEAD } else { 0 };
        }
        if within.is_ok() {
            kept = take(polygon);
        }
    });
    budget.release(charged);
    // An algorithm that saw the limit first may have ended without a word.
    within.and_then(|()| budget.check("shadow polygons"))
}

/// The shadows of a picture by this algorithm; `None` without one, and where nothing asks for
/// light.
pub(crate) fn prepare<'a>(
    algorithm: Option<&dyn ShadowAlgorithm>,
    view: &PreparedView<'a>,
    lights: &[Light],
    settings: &Settings,
    execution: &Execution,
) -> Result<Option<Box<dyn PreparedShadows + 'a>>, Limit> {
    if !settings.shading.lighting && !settings.picture.channels.cast_shadow {
        return Ok(None);
    }
    algorithm.map(|a| a.prepare_for(view, lights, settings, execution)).transpose()
}
