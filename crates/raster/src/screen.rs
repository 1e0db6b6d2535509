//! The screen: where vertices land, on a grid of 1/256 pixel, and which pixels and samples lie
//! there.

use crate::setup::{CornerPosition, SharedPlane};
use crate::{GUARD_BAND, SUBPIXEL, SamplePattern, Viewport};
use bytemuck::{Pod, Zeroable};
use vitral_math::{Vec2, Vec4, vec2};

/// Bits of [`ScreenVertex::flags`].
pub mod flag {
    /// `x < -w`.
    pub const LEFT: u32 = 1;
    /// `x > w`.
    pub const RIGHT: u32 = 2;
    /// `y < -w`.
    pub const BOTTOM: u32 = 4;
    /// `y > w`.
    pub const TOP: u32 = 8;
    /// `z < 0`.
    pub const FAR: u32 = 16;
    /// `z > w`.
    pub const NEAR: u32 = 32;
    /// All bits of the view volume.
    pub const FRUSTUM: u32 = 63;
    /// Beyond near, far or the guard band: a triangle with such a vertex is clipped.
    pub const CLIP: u32 = 64;
    /// A coordinate is NaN or infinite: the primitive is dropped.
    pub const NOT_FINITE: u32 = 128;
    /// Beyond the first of up to six planes of the user; the next bits are the next planes'.
    pub const USER: u32 = 256;
    /// All bits of the user's planes.
    pub const USERS: u32 = 63 * USER;
    /// What snapping took from x: the bits from this one on, as `ScreenVertex::residue`.
    pub const RESIDUE_X: u32 = 14;
    /// What it took from y: the bits from this one on, which are the last.
    pub const RESIDUE_Y: u32 = RESIDUE_X + RESIDUE_BITS;
    /// Bits of each of the two.
    pub const RESIDUE_BITS: u32 = 9;
}

/// The unit of [`ScreenVertex::residue`], in 1/256 pixel.
pub(crate) const RESIDUE: f32 = 1.0 / (1 << flag::RESIDUE_BITS) as f32;

/// A vertex on the screen. Coordinates are only meaningful without [`flag::CLIP`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ScreenVertex {
    /// 1/256 pixel from the left.
    pub x: i32,
    /// 1/256 pixel from the top.
    pub y: i32,
    /// Depth, 1 near, 0 far.
    pub z: f32,
    /// Where it lies, see [`flag`].
    pub flags: u32,
}

impl ScreenVertex {
    /// Its position, for setup.
    pub(crate) fn corner(self) -> CornerPosition {
        CornerPosition { x: self.x, y: self.y, z: self.z }
    }

    /// How far right of and below its snapped place it lies, in units of [`RESIDUE`], -256 to 255;
    /// 0 from those who keep none.
    #[cfg(any(test, feature = "forward"))]
    #[inline(always)]
    pub(crate) fn residue(self) -> [i32; 2] {
        let kept = self.flags.cast_signed();
        [kept << flag::RESIDUE_BITS >> flag::RESIDUE_Y, kept >> flag::RESIDUE_Y]
    }
}

/// The map from ndc to the screen, in 1/256 pixel.
#[derive(Clone, Copy, Debug)]
pub struct ViewportTransform {
    pub(crate) scale: Vec2,
    pub(crate) center: Vec2,
    pub(crate) guard: Vec2,
}

impl ViewportTransform {
    /// The map onto the whole viewport, y downwards.
    pub fn new(viewport: Viewport) -> Self {
        let half = vec2(viewport.width as f32, viewport.height as f32) * 0.5;
        let subpixel = SUBPIXEL as f32;
        Self {
            scale: vec2(half.x, -half.y) * subpixel,
            center: half * subpixel,
            guard: vec2(GUARD_BAND / half.x, GUARD_BAND / half.y),
        }
    }

    /// Projects and snaps a clipped point. Rounding may leave a corner of a vast triangle far
    /// outside the guard band: it is moved to twice the band, where setup still computes without
    /// overflow.
    pub fn project(&self, clip: Vec4) -> CornerPosition {
        let most = 2.0 * GUARD_BAND * SUBPIXEL as f32;
        let snapped = |v: f32| (v.clamp(-most, most) + 0.5).floor() as i32;
        CornerPosition {
            x: snapped(clip.x / clip.w * self.scale.x + self.center.x),
            y: snapped(clip.y / clip.w * self.scale.y + self.center.y),
            z: (clip.z / clip.w).clamp(0.0, 1.0),
        }
    }

    /// The guard band, in multiples of the view.
    pub fn guard(&self) -> Vec2 {
        self.guard
    }
}

/// Where triangles go on the screen: shared by all batches of a picture.
#[derive(Clone, Debug)]
pub struct Screen {
    pub(crate) viewport: Viewport,
    transform: ViewportTransform,
    pattern: SamplePattern,
    lines: [[i32; 2]; 2],
    /// Depths of planes that several facets lie in, by number; `None` where the facets keep to
    /// their corners.
    planes: Vec<Option<SharedPlane>>,
}

impl Screen {
    /// The screen for a viewport and sample pattern.
    pub fn new(viewport: Viewport, pattern: &SamplePattern) -> Self {
        let lines = [pattern.lines(0), pattern.lines(1)];
        Self {
            viewport,
            transform: ViewportTransform::new(viewport),
            pattern: pattern.clone(),
            lines,
            planes: Vec::new(),
        }
    }

    /// The same with the depths of planes that several facets lie in, by the numbers of
    /// [`Draw::planes`](crate::Draw::planes).
    #[must_use]
    pub fn with_planes(self, planes: Vec<Option<SharedPlane>>) -> Self {
        Self { planes, ..self }
    }

    /// The depths of a plane.
    #[inline(always)]
    pub(crate) fn plane(&self, number: u32) -> Option<&SharedPlane> {
        self.planes.get(number as usize)?.as_ref()
    }

    /// Where samples lie in a pixel.
    #[inline(always)]
    pub(crate) fn pattern(&self) -> &SamplePattern {
        &self.pattern
    }

    /// Whether `low..=high` along an axis holds a line of samples.
    #[inline(always)]
    fn crosses_line(&self, low: i32, high: i32, axis: usize) -> bool {
        let [offset, shift] = self.lines[axis];
        (high - offset) >> shift > (low - 1 - offset) >> shift
    }

    /// Along an axis: the lines of samples (offset and shift of their distance), the outermost
    /// samples in a pixel, and how many pixels there are.
    #[inline(always)]
    pub(crate) fn along(&self, axis: usize) -> ([i32; 2], [i32; 2], u32) {
        let Viewport { width, height, .. } = self.viewport;
        (self.lines[axis], self.pattern.extent()[axis], if axis == 0 { width } else { height })
    }

    /// The map from ndc to the screen.
    pub fn transform(&self) -> &ViewportTransform {
        &self.transform
    }

    /// First and last pixel of `size` whose samples may lie in `min..=max` (1/256 pixel); empty if
    /// the first is larger.
    #[inline(always)]
    fn pixels(min: i32, max: i32, samples: [i32; 2], size: u32) -> (i32, i32) {
        let first = (min - samples[1] + SUBPIXEL - 1) >> 8;
        let last = (max - samples[0]) >> 8;
        (first.max(0), last.min(size as i32 - 1))
    }
}

/// The pixels whose samples the triangle's box may hold, `[x0, y0, x1, y1]` inclusive.
#[inline(always)]
pub(crate) fn covered_pixels([a, b, c]: &[CornerPosition; 3], screen: &Screen) -> Option<[u32; 4]> {
    let (min_x, max_x) = (a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x));
    let (min_y, max_y) = (a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y));
    if !(screen.crosses_line(min_x, max_x, 0) && screen.crosses_line(min_y, max_y, 1)) {
        return None;
    }
    let [sample_x, sample_y] = screen.pattern.extent();
    let (x0, x1) = Screen::pixels(min_x, max_x, sample_x, screen.viewport.width);
    let (y0, y1) = Screen::pixels(min_y, max_y, sample_y, screen.viewport.height);
    (x0 <= x1 && y0 <= y1).then_some([x0 as u32, y0 as u32, x1 as u32, y1 as u32])
}
