//! The rays of a generation, and where their light goes.

use super::media::Media;
use crate::shading::FrameConstants;
use vitral_math::DVec3;

/// A ray, and what it is for.
#[derive(Clone, Copy)]
pub(super) struct Branch {
    /// The point whose colour it adds to.
    pub(super) target: u32,
    /// How its red, green, blue and alpha count.
    pub(super) weight: [f32; 4],
    /// Where it starts, world space less the scene's middle.
    pub(super) origin: DVec3,
    /// Where it goes, unit, world space.
    pub(super) direction: DVec3,
    /// The facet that it leaves.
    pub(super) own: u32,
    pub(super) media: Media,
    /// The pile in which it is, and the next of its triangles: the ray meets that without looking
    /// for it.
    pub(super) pile: Option<u32>,
    pub(super) layer: u32,
    /// Turns that it took.
    pub(super) depth: u32,
    /// It is one of many that a translucent surface scattered.
    pub(super) scattered: bool,
    /// What its light must count at least to be followed.
    pub(super) least: f32,
    /// Distance from the eye to its start.
    pub(super) travelled: f64,
    /// Row of the picture whose background it sees; `None` after a turn.
    pub(super) row: Option<u32>,
    /// The part of it that a shadow on the ground takes.
    pub(super) ground: f32,
    pub(super) seed: u32,
}

/// Depth cueing at a surface that the eye sees on a straight way: the part of its light that is
/// kept, and the colour that the rest becomes. Light that turns there is its light.
pub(super) struct Haze {
    /// The part of the light that is left.
    pub(super) kept: f32,
    /// The colour that the rest becomes.
    pub(super) color: [f32; 3],
}

impl Haze {
    /// At a point of the world, for a ray that sees the background of this row; after a turn there
    /// is none.
    pub(super) fn new(constants: &FrameConstants<'_>, row: Option<u32>, point: DVec3) -> Self {
        let (Some(fade), Some(row)) = (&constants.fade, row) else {
            return Self { kept: 1.0, color: [0.0; 3] };
        };
        let depth = -constants.view.view.view_from_world.transform_point3(point).z;
        Self { kept: fade.kept(depth as f32), color: fade.into(constants.background.color(row)) }
    }
}

/// Rays of one generation.
#[derive(Default)]
pub(super) struct Rays {
    /// Those that look for what they meet.
    pub(super) free: Vec<Branch>,
    /// Those within a pile.
    pub(super) piled: Vec<Branch>,
    /// Points, and the colours added to them where branches end (black, not a hole) and where light
    /// fades.
    pub(super) ended: Vec<(u32, [f32; 4])>,
}

impl Rays {
    pub(super) fn is_empty(&self) -> bool {
        self.free.is_empty() && self.piled.is_empty()
    }

    /// How many there are: free ones, and those within piles.
    pub(super) fn len(&self) -> [usize; 2] {
        [self.free.len(), self.piled.len()]
    }

    pub(super) fn clear(&mut self) {
        self.free.clear();
        self.piled.clear();
    }

    /// A branch with this weight ends.
    pub(super) fn end(&mut self, target: u32, weight: [f32; 4]) {
        if weight[3] > 0.0 {
            self.ended.push((target, [0.0, 0.0, 0.0, weight[3]]));
        }
    }

    /// The rest of a branch with this weight where light fades that turns here; the rest is of
    /// the colour that it fades into.
    pub(super) fn fade(&mut self, target: u32, weight: [f32; 4], haze: &Haze) -> [f32; 4] {
        if haze.kept < 1.0 {
            let [r, g, b] = haze.color;
            let lost = weight.map(|w| w * (1.0 - haze.kept));
            self.ended.push((target, [r * lost[0], g * lost[1], b * lost[2], lost[3]]));
        }
        weight.map(|w| w * haze.kept)
    }

    /// Adds what ended to the points' colours.
    pub(super) fn settle(&mut self, colors: &mut [[f32; 4]]) {
        self.ended
            .drain(..)
            .for_each(|(target, color)| add(&mut colors[target as usize], [1.0; 4], color));
    }
}

pub(super) fn counts(weight: [f32; 4], least: f32) -> bool {
    weight.iter().any(|&w| w >= least)
}

pub(super) fn add(sum: &mut [f32; 4], weight: [f32; 4], color: [f32; 4]) {
    for k in 0..4 {
        sum[k] += weight[k] * color[k];
    }
}
