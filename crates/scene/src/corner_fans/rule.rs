//! The rule by which the faces round a vertex are averaged.

use std::f64::consts::PI;
use vitral_math::func;

/// Which faces at a vertex are averaged.
#[derive(Clone, Copy)]
pub(crate) struct Rule<'a> {
    /// Cosine of the crease angle: faces that differ by more are not averaged.
    pub(super) whole: f32,
    /// Cosine of half of it.
    pub(super) half: f32,
    /// One number a face: of faces within the angle, those with the same number are averaged, if it
    /// is not 0.
    pub(super) groups: Option<&'a [u32]>,
}

impl<'a> Rule<'a> {
    /// Within `angle` radians; NaN stands for `π`.
    pub(crate) fn within(angle: f64) -> Self {
        // A hair of slack, so that a right angle is not above π/2; it must be less for half the
        // angle.
        let angle = if angle.is_nan() { PI } else { angle.clamp(0.0, PI) };
        Self {
            whole: (func::cos(angle) - 1e-6) as f32,
            half: func::cos(0.5 * angle) as f32,
            groups: None,
        }
    }

    /// The rule within smoothing groups.
    pub(crate) fn in_groups(self, groups: &'a [u32]) -> Self {
        Self { groups: Some(groups), ..self }
    }
}
