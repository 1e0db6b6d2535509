//! The rule by which the faces round a vertex are averaged.

use vitral_math::func;

/// Which faces at a vertex are averaged.
#[derive(Clone, Copy)]
pub(crate) enum Rule<'a> {
    /// Those whose normals are within an angle of each other.
    Angle {
        /// Cosine of the angle.
        whole: f32,
        /// Cosine of half of it.
        half: f32,
    },
    /// Those with the same number, if it is not 0; one number a face.
    Groups(&'a [u32]),
}

impl Rule<'_> {
    /// Within `angle` radians.
    pub(crate) fn within(angle: f64) -> Self {
        // A hair of slack, so that a right angle is not above π/2; it must be less for half the angle.
        let angle = angle.max(0.0);
        Self::Angle { whole: (func::cos(angle) - 1e-6) as f32, half: func::cos(0.5 * angle) as f32 }
    }
}
