//! Textures: a pyramid of images (mipmaps), and the sampler that says how to look things up in it.
//!
//! `pyramid.rs` builds the levels, `sample.rs` looks them up. Texture coordinates: `(0, 0)` is the
//! top left corner of the image and `(1, 1)` the bottom right one; texel `i` of `n` covers
//! `i/n .. (i+1)/n`.

mod pyramid;
mod sample;

pub use sample::decode_table;

use crate::Plane;
use serde::{Deserialize, Serialize};

/// What the bytes of an image mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Encoding {
    /// Proportional to the quantity.
    Linear,
    /// Colours in sRGB; alpha stays linear.
    Srgb,
}

/// What lies beyond the edge of a texture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Wrap {
    /// The texture again.
    #[default]
    Repeat,
    /// The texture again, every other time mirrored.
    MirroredRepeat,
    /// The edge texel.
    ClampToEdge,
}

/// Nearest texel, or bilinear between four.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Filter {
    /// The texel that holds the point.
    Nearest,
    /// Bilinear between the four texel centres round it.
    #[default]
    Linear,
}

/// How to choose among the levels of the pyramid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MipFilter {
    /// The base level always.
    None,
    /// The nearest level.
    Nearest,
    /// Between the two nearest levels; with [`Filter::Linear`] this is trilinear.
    #[default]
    Linear,
}

/// How a texture is looked up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case")]
pub struct Sampler {
    /// Beyond the left and right edge.
    pub wrap_s: Wrap,
    /// Beyond the top and bottom edge.
    pub wrap_t: Wrap,
    /// When a texel is larger than a pixel.
    pub magnify: Filter,
    /// When a texel is smaller than a pixel.
    pub minify: Filter,
    /// Between levels, when a texel is smaller than a pixel.
    pub mip: MipFilter,
}

/// An image with its mipmap pyramid, 8 bits a channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Where it came from, for messages.
    pub name: String,
    /// Level 0 is the image; each next level halves both sides (rounding down, at least 1), down to
    /// 1x1. RGBA, straight alpha. Row 0 is the top of the image, at texture coordinate `v = 0`
    /// (glTF's convention; loaders of formats with `v` upwards flip the coordinate).
    pub levels: Vec<Plane<[u8; 4]>>,
    /// Meaning of the colour bytes.
    pub encoding: Encoding,
}
