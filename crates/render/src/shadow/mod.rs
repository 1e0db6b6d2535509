//! Which part of each light arrives at a point: `S_j` of the course's formula
//!
//! `I = Ia ka + Σj S_j f_att,j Ip,j (kd (N·L_j) + ks (R_j·V)^n)`.
//!
//! A point that faces away from a light is in its own, *attached* shadow; one that something else hides from the light is
//! in a *cast* shadow. Attached means that the facet or the shading normal faces away: a facet behind its own plane gets
//! no light, whatever its interpolated normal says. Ambient light is not touched.
//!
//! Shadows belong to the world, not to a viewer: an algorithm is asked about points, after visibility was decided by
//! whatever algorithm. [`crate::registry::SHADOWS`] lists them. A transparent thing lets through what its opacity leaves,
//! coloured by its filter where transparency is filtered; a cut-out one lets light through its holes.

pub mod map;
mod occluders;
mod place;
pub mod ray;
mod sources;

pub(crate) use occluders::{texel, weights};
pub(crate) use place::{facet, places, weighted};
pub(crate) use ray::clearance;

use crate::{Execution, Session, Settings, registry};
use vitral_exec::Limit;
use vitral_light::{Light, Rgb};
use vitral_math::DVec3;

/// A point of a surface that asks for light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// World space less [`crate::raytrace::triangles::Triangles::center`].
    pub position: DVec3,
    /// Unit normal of the facet on the side that is seen, world space; zero for a facet without area.
    pub normal: DVec3,
    /// The facet.
    pub facet: u32,
    /// Chooses the places on area lights that are asked; neighbours should differ.
    pub seed: u32,
}

/// Shadows of one set of lights in one scene.
pub trait Shadows: Sync {
    /// Which part of each colour of the light of this number reaches the place, `0..=1`. Adds the rays that it took.
    fn arriving(&self, light: usize, place: &Place, rays: &mut u64) -> Rgb;
}

/// A way to find shadows.
pub trait ShadowAlgorithm: Sync {
    /// Makes ready for questions about these lights (world space).
    fn prepare<'a>(
        &self,
        session: &'a Session,
        lights: &[Light],
        settings: &Settings,
        execution: &Execution,
    ) -> Result<Box<dyn Shadows + 'a>, Limit>;
}

/// The mean of three channels, written so that grey stays as it is.
pub(crate) fn grey([r, g, b]: Rgb) -> f32 {
    r + ((g - r) + (b - r)) / 3.0
}

/// The chosen algorithm, ready; `None` without shadows.
pub(crate) fn prepare<'a>(
    session: &'a Session,
    lights: &[Light],
    settings: &Settings,
    execution: &Execution,
) -> Result<Option<Box<dyn Shadows + 'a>>, Limit> {
    let algorithm = registry::shadows(&settings.shadows).and_then(|s| s.algorithm);
    if !settings.lighting && !settings.channels.cast_shadow {
        return Ok(None);
    }
    algorithm.map(|a| a.prepare(session, lights, settings, execution)).transpose()
}
