//! What a renderer hands to whoever asked: a colour picture, and the channels that were wanted.

use crate::Plane;

/// A finished picture. Planes that were not asked for are `None`; all others have the same size.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Display colour, straight (not premultiplied) alpha. sRGB-encoded, or raw where the raw
    /// colour space was chosen.
    pub color: Option<Plane<[u8; 4]>>,
    /// The colour picture after each pass of an algorithm that draws transparent surfaces in
    /// passes: what is opaque first, the finished picture last. Empty if they were not asked for.
    pub passes: Vec<Plane<[u8; 4]>>,
    /// The buffers of the two-buffer z-buffer, where they were asked for.
    pub buffers: Option<TwoBuffers>,
    /// Depth at the pixel centre, `1` on the near plane, `0` on the far plane and on the
    /// background.
    pub depth: Option<Plane<f32>>,
    /// Surface id: faces counted instance by instance in scene order; [`Frame::BACKGROUND`] where
    /// there is none.
    pub surface: Option<Plane<u32>>,
    /// Instance index in scene order; [`Frame::BACKGROUND`] where there is none.
    pub object: Option<Plane<u32>>,
    /// Material index; [`Frame::BACKGROUND`] where there is none.
    pub material: Option<Plane<u32>>,
    /// Unit shading normal in world space, facing the viewer; zero on the background.
    pub normal: Option<Plane<[f32; 3]>>,
    /// The steps of the visibility algorithm over the picture, display colour.
    pub steps: Option<Plane<[u8; 4]>>,
    /// Share of the lights (ambient ones apart) from which the surface faces away, `0..=1`; 0 on
    /// the background.
    pub attached_shadow: Option<Plane<f32>>,
    /// Share of these lights that something else hides from a surface that faces them, `0..=1`.
    pub cast_shadow: Option<Plane<f32>>,
}

/// The two buffers that a picture with transparent surfaces is made of: `I + (1 - k) opaque`.
/// Colours are premultiplied and linear, or the course's numbers in the raw colour space; with
/// several samples a pixel they are their means.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TwoBuffers {
    /// Colour of what is opaque, the background included, RGBA.
    pub opaque: Plane<[f32; 4]>,
    /// Its depth at the first sample, `1` near, `0` far and on the background.
    pub depth: Plane<f32>,
    /// How many transparent surfaces are in front of that at the first sample.
    pub layers: Plane<u32>,
    /// The intensity `I` that these add up to.
    pub intensity: Plane<[f32; 3]>,
    /// Their coefficient `k`, one for each channel: they differ where filters colour what passes.
    pub coefficient: Plane<[f32; 3]>,
}

impl Frame {
    /// The id that no surface has.
    pub const BACKGROUND: u32 = u32::MAX;
}
