//! Depth cueing: what is farther away fades into the background, as through haze.
//!
//! `I' = s I + (1 - s) Idc`. The share `s` goes linearly from its value at the front plane to that
//! at the back plane, and stays as it is in front of the one and behind the other. Every surface
//! that is seen on a straight way fades by its own depth; what a mirror shows, or bent light, is
//! light of the surface that mirrors or bends it.
//!
//! In:   a depth along the direction of sight, a colour, premultiplied. Out: the faded colour.
//! Cost: a multiplication and a few additions a point.
//! Source: \[Foley et al. 1990\], 16.1.3. Departs from it: depths are distances in view space, not
//! those after the perspective transformation; `Idc` is the background of the pixel's row unless a
//! colour is given.

use super::composed;
use crate::DepthCue;
use vitral_math::lanes::Lanes;

/// What a view's points fade with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fade {
    /// The depth from which on things fade.
    front: f32,
    /// How much of the way to the back plane lies in a unit of depth.
    per_depth: f32,
    /// `s` at the front plane, and what is added to it towards the back plane.
    front_scale: f32,
    more: f32,
    /// `Idc` in the space of composition; `None`: the background.
    color: Option<[f32; 3]>,
}

impl Fade {
    /// For a scene whose bounding sphere has its centre at the depth `middle`: planes that the
    /// settings leave open touch the sphere. In the raw colour space, colours are composed as they
    /// are.
    pub(crate) fn new(cue: &DepthCue, middle: f64, radius: f64, raw: bool) -> Self {
        let front = cue.front.unwrap_or((middle - radius).max(0.0));
        let back = cue.back.unwrap_or(middle + radius);
        // Where the planes coincide, as round a single point, everything is in front or behind.
        let per_depth =
            (1.0 / (back - front).max(f64::from(f32::MIN_POSITIVE))).min(f64::from(f32::MAX));
        Self {
            front: front as f32,
            per_depth: per_depth as f32,
            front_scale: cue.front_scale,
            more: cue.back_scale - cue.front_scale,
            color: cue.color.map(|color| composed(color, raw)),
        }
    }

    /// The share of its own light that a surface keeps at this depth, 0 to 1.
    #[inline(always)]
    pub(crate) fn kept<T: Lanes>(&self, depth: T) -> T {
        ((depth - self.front) * self.per_depth).saturate() * self.more + self.front_scale
    }

    /// What things fade into where the background is this.
    pub(crate) fn into(&self, background: [f32; 4]) -> [f32; 3] {
        self.color.unwrap_or([background[0], background[1], background[2]])
    }

    /// A premultiplied colour of one point.
    pub(crate) fn faded(&self, color: [f32; 4], depth: f32, background: [f32; 4]) -> [f32; 4] {
        let (kept, [r, g, b]) = (self.kept(depth), self.into(background));
        let cue = [r, g, b, 1.0].map(|c| c * color[3] * (1.0 - kept));
        [0, 1, 2, 3].map(|k| color[k] * kept + cue[k])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn p41_light_fades_between_the_planes() {
        let fade = Fade {
            front: 2.0,
            per_depth: 0.25,
            front_scale: 1.0,
            more: -0.75,
            color: Some([0.0, 0.5, 1.0]),
        };
        let kept = [1.0f32, 2.0, 4.0, 6.0, 100.0].map(|depth| fade.kept(depth));
        assert_eq!(kept, [1.0, 1.0, 0.625, 0.25, 0.25]);
        // Half transparent red, faded to a quarter.
        assert_eq!(fade.faded([0.5, 0.0, 0.0, 0.5], 7.0, [0.0; 4]), [0.125, 0.1875, 0.375, 0.5]);
        let fade = Fade { color: None, ..fade };
        assert_eq!(
            fade.faded([1.0, 0.0, 0.0, 1.0], 4.0, [0.0, 0.0, 1.0, 1.0]),
            [0.625, 0.0, 0.375, 1.0]
        );
    }
}
