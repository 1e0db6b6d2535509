//! The moment of an animation at which a file is read.

/// A moment of an animation.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// Which animation: its number, from 0, or its name.
    pub animation: String,
    /// Since it began; before the first keyframe and after the last one nothing moves.
    pub seconds: f64,
}
