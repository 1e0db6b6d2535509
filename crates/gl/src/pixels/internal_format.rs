//! Internal formats: what a texture or renderbuffer of each token stores.

use crate::enums::*;
use vitral_raster::forward::BaseFormat;

/// How samples are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Storage {
    /// 8 bits a component.
    Unorm8,
    /// 8 bits, colour encoded as sRGB.
    Srgb8,
    /// Floats rounded to 16-bit integers.
    Unorm16,
    /// Floats, of textures rounded to half precision.
    Half,
    /// Single precision.
    Float,
    /// Depth of 16 or 24 bits, or 32 floating-point ones.
    Depth(u32),
    /// Stencil of 8 bits.
    Stencil,
}

/// An internal format: the token that was asked for, and how texels are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct InternalFormat {
    /// The token to report.
    pub token: u32,
    /// `ALPHA`, `LUMINANCE`, `LUMINANCE_ALPHA`, `INTENSITY`, `RED`, `RG`, `RGB`, `RGBA`,
    /// `DEPTH_COMPONENT`, `DEPTH_STENCIL`, `STENCIL_INDEX`.
    pub base: u32,
    /// The components stored for each texel.
    pub storage: Storage,
}

/// Bits of each component as queries report them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Bits {
    /// Red, green, blue, alpha.
    pub rgba: [i32; 4],
    /// Bits of luminance.
    pub luminance: i32,
    /// Bits of intensity.
    pub intensity: i32,
    /// Bits of depth.
    pub depth: i32,
    /// Bits of stencil values.
    pub stencil: i32,
}

impl InternalFormat {
    /// The format of a texture. `None` if it is none, or a specific compressed format.
    pub(crate) fn of_texture(token: u32) -> Option<Self> {
        // Texels that are not given as blocks are not compressed.
        let token = super::s3tc::base(token);
        let (base, storage) = color(token).or_else(|| depth(token))?;
        // A generic compressed format that is not compressed becomes its base format.
        let token = match token {
            COMPRESSED_ALPHA
            | COMPRESSED_LUMINANCE
            | COMPRESSED_LUMINANCE_ALPHA
            | COMPRESSED_INTENSITY
            | COMPRESSED_RED
            | COMPRESSED_RG
            | COMPRESSED_RGB
            | COMPRESSED_RGBA => base,
            COMPRESSED_SRGB_EXT
            | COMPRESSED_SRGB_ALPHA_EXT
            | COMPRESSED_SLUMINANCE_EXT
            | COMPRESSED_SLUMINANCE_ALPHA_EXT => base,
            _ => token,
        };
        Some(Self { token, base, storage })
    }

    /// The format of a renderbuffer: colours, depths or stencil values.
    pub(crate) fn of_renderbuffer(token: u32) -> Option<Self> {
        if matches!(
            token,
            STENCIL_INDEX | STENCIL_INDEX1 | STENCIL_INDEX4 | STENCIL_INDEX8 | STENCIL_INDEX16
        ) {
            return Some(Self { token, base: STENCIL_INDEX, storage: Storage::Stencil });
        }
        if matches!(token, 1..=4) {
            return None;
        }
        Self::of_texture(token).filter(|f| f.token == token)
    }

    /// Whether samples hold a depth.
    pub(crate) fn has_depth(&self) -> bool {
        matches!(self.base, DEPTH_COMPONENT | DEPTH_STENCIL)
    }

    /// Whether samples hold a stencil value.
    pub(crate) fn has_stencil(&self) -> bool {
        matches!(self.base, STENCIL_INDEX | DEPTH_STENCIL)
    }

    /// Whether samples hold a colour.
    pub(crate) fn is_color(&self) -> bool {
        !self.has_depth() && !self.has_stencil()
    }

    /// What the rasteriser's environment makes of it.
    pub(crate) fn base_format(&self) -> BaseFormat {
        match self.base {
            ALPHA => BaseFormat::Alpha,
            LUMINANCE => BaseFormat::Luminance,
            LUMINANCE_ALPHA => BaseFormat::LuminanceAlpha,
            INTENSITY => BaseFormat::Intensity,
            // Texels are expanded: missing components are 0, and alpha the fragment's.
            RED | RG | RGB => BaseFormat::Rgb,
            RGBA => BaseFormat::Rgba,
            _ => BaseFormat::Depth,
        }
    }

    /// What a depth of 1 is stored as in a depth plane.
    pub(crate) fn depth_scale(&self) -> f32 {
        match self.storage {
            Storage::Depth(16) => 65_535.0,
            Storage::Depth(24) => 16_777_215.0,
            _ => 1.0,
        }
    }

    /// The components of a colour as this base format returns them from a sampler.
    #[inline]
    pub(crate) fn expand(&self, [r, g, b, a]: [f32; 4]) -> [f32; 4] {
        match self.base {
            ALPHA => [0.0, 0.0, 0.0, a],
            LUMINANCE => [r, r, r, 1.0],
            LUMINANCE_ALPHA => [r, r, r, a],
            INTENSITY => [r; 4],
            RED => [r, 0.0, 0.0, 1.0],
            RG => [r, g, 0.0, 1.0],
            RGB => [r, g, b, 1.0],
            _ => [r, g, b, a],
        }
    }

    /// As [`Self::expand`], of a word with red in the lowest byte.
    #[inline]
    pub(crate) fn expand_word(&self, word: u32) -> u32 {
        let red = (word & 255) * 0x0001_0101;
        match self.base {
            ALPHA => word & 0xff00_0000,
            LUMINANCE => red | 0xff00_0000,
            LUMINANCE_ALPHA => red | (word & 0xff00_0000),
            INTENSITY => red | (word << 24),
            RED => (word & 0xff) | 0xff00_0000,
            RG => (word & 0xffff) | 0xff00_0000,
            RGB => word | 0xff00_0000,
            _ => word,
        }
    }

    /// Which of R, G, B, A a framebuffer of this format does not store.
    pub(crate) fn missing(&self) -> [bool; 4] {
        match self.base {
            ALPHA => [true, true, true, false],
            RED | LUMINANCE | INTENSITY => [false, true, true, true],
            RG => [false, false, true, true],
            LUMINANCE_ALPHA => [false, true, true, false],
            RGB => [false, false, false, true],
            _ => [false; 4],
        }
    }

    /// A colour as a framebuffer of this format keeps it: components not stored are 0, alpha 1, for
    /// blending reads it.
    pub(crate) fn kept(&self, color: [f32; 4]) -> [f32; 4] {
        let missing = self.missing();
        std::array::from_fn(|c| if missing[c] { f32::from(u8::from(c == 3)) } else { color[c] })
    }

    /// As [`Self::kept`], of a word with red in the lowest byte.
    pub(crate) fn kept_word(&self, word: u32) -> u32 {
        let missing = self.missing();
        let byte =
            |c: usize, byte: u8| if missing[c] { if c == 3 { 255 } else { 0 } } else { byte };
        let bytes = word.to_le_bytes();
        u32::from_le_bytes(std::array::from_fn(|c| byte(c, bytes[c])))
    }

    /// Sizes of the components.
    pub(crate) fn bits(&self) -> Bits {
        let size = match self.storage {
            Storage::Unorm8 | Storage::Srgb8 | Storage::Stencil => 8,
            Storage::Unorm16 | Storage::Half => 16,
            Storage::Float => 32,
            Storage::Depth(bits) => bits as i32,
        };
        let none = Bits::default();
        match self.base {
            ALPHA => Bits { rgba: [0, 0, 0, size], ..none },
            LUMINANCE => Bits { luminance: size, ..none },
            LUMINANCE_ALPHA => Bits { luminance: size, rgba: [0, 0, 0, size], ..none },
            INTENSITY => Bits { intensity: size, ..none },
            RED => Bits { rgba: [size, 0, 0, 0], ..none },
            RG => Bits { rgba: [size, size, 0, 0], ..none },
            // Kept in 8 bits, but not by the client.
            RGB if self.token == RGB565 => Bits { rgba: [5, 6, 5, 0], ..none },
            RGB => Bits { rgba: [size, size, size, 0], ..none },
            RGBA => Bits { rgba: [size; 4], ..none },
            DEPTH_COMPONENT => Bits { depth: size, ..none },
            DEPTH_STENCIL => Bits { depth: size, stencil: 8, ..none },
            _ => Bits { stencil: 8, ..none },
        }
    }

    /// `FLOAT` or `UNSIGNED_NORMALIZED`.
    pub(crate) fn component_type(&self) -> u32 {
        match self.storage {
            Storage::Half | Storage::Float | Storage::Depth(32) => FLOAT,
            _ => UNSIGNED_NORMALIZED,
        }
    }

    /// Bytes of a texel in memory.
    pub(crate) fn texel_bytes(&self) -> usize {
        match self.storage {
            Storage::Unorm8 | Storage::Srgb8 | Storage::Depth(_) => 4,
            Storage::Unorm16 | Storage::Half | Storage::Float => 16,
            Storage::Stencil => 1,
        }
    }
}

/// Whether a token says how many bits there are.
pub(crate) fn is_sized(token: u32) -> bool {
    !matches!(
        token,
        1..=4
            | ALPHA
            | LUMINANCE
            | LUMINANCE_ALPHA
            | INTENSITY
            | RED
            | RG
            | RGB
            | RGBA
            | SRGB_EXT
            | SRGB_ALPHA_EXT
            | SLUMINANCE_EXT
            | SLUMINANCE_ALPHA_EXT
            | DEPTH_COMPONENT
            | DEPTH_STENCIL
    )
}

fn color(token: u32) -> Option<(u32, Storage)> {
    use Storage::{Float, Half, Srgb8, Unorm8, Unorm16};
    Some(match token {
        ALPHA | ALPHA4 | ALPHA8 | COMPRESSED_ALPHA => (ALPHA, Unorm8),
        ALPHA12 | ALPHA16 => (ALPHA, Unorm16),
        1 | LUMINANCE | LUMINANCE4 | LUMINANCE8 | COMPRESSED_LUMINANCE => (LUMINANCE, Unorm8),
        LUMINANCE12 | LUMINANCE16 => (LUMINANCE, Unorm16),
        2
        | LUMINANCE_ALPHA
        | LUMINANCE4_ALPHA4
        | LUMINANCE6_ALPHA2
        | LUMINANCE8_ALPHA8
        | COMPRESSED_LUMINANCE_ALPHA => (LUMINANCE_ALPHA, Unorm8),
        LUMINANCE12_ALPHA4 | LUMINANCE12_ALPHA12 | LUMINANCE16_ALPHA16 => {
            (LUMINANCE_ALPHA, Unorm16)
        }
        INTENSITY | INTENSITY4 | INTENSITY8 | COMPRESSED_INTENSITY => (INTENSITY, Unorm8),
        INTENSITY12 | INTENSITY16 => (INTENSITY, Unorm16),
        RED | R8 | COMPRESSED_RED => (RED, Unorm8),
        R16 => (RED, Unorm16),
        RG | RG8 | COMPRESSED_RG => (RG, Unorm8),
        RG16 => (RG, Unorm16),
        3 | RGB | R3_G3_B2 | RGB2_EXT | RGB4 | RGB5 | RGB8 | COMPRESSED_RGB => (RGB, Unorm8),
        RGB10 | RGB12 | RGB16 => (RGB, Unorm16),
        4 | RGBA | RGBA2 | RGBA4 | RGB5_A1 | RGBA8 | COMPRESSED_RGBA => (RGBA, Unorm8),
        RGB10_A2 | RGBA12 | RGBA16 => (RGBA, Unorm16),
        SRGB_EXT | SRGB8_EXT | COMPRESSED_SRGB_EXT => (RGB, Srgb8),
        SRGB_ALPHA_EXT | SRGB8_ALPHA8_EXT | COMPRESSED_SRGB_ALPHA_EXT => (RGBA, Srgb8),
        SLUMINANCE_EXT | SLUMINANCE8_EXT | COMPRESSED_SLUMINANCE_EXT => (LUMINANCE, Srgb8),
        SLUMINANCE_ALPHA_EXT | SLUMINANCE8_ALPHA8_EXT | COMPRESSED_SLUMINANCE_ALPHA_EXT => {
            (LUMINANCE_ALPHA, Srgb8)
        }
        R32F => (RED, Float),
        RG32F => (RG, Float),
        R16F => (RED, Half),
        RG16F => (RG, Half),
        RGBA32F_ARB => (RGBA, Float),
        RGB32F_ARB => (RGB, Float),
        ALPHA32F_ARB => (ALPHA, Float),
        INTENSITY32F_ARB => (INTENSITY, Float),
        LUMINANCE32F_ARB => (LUMINANCE, Float),
        LUMINANCE_ALPHA32F_ARB => (LUMINANCE_ALPHA, Float),
        RGBA16F_ARB => (RGBA, Half),
        RGB16F_ARB => (RGB, Half),
        ALPHA16F_ARB => (ALPHA, Half),
        INTENSITY16F_ARB => (INTENSITY, Half),
        LUMINANCE16F_ARB => (LUMINANCE, Half),
        LUMINANCE_ALPHA16F_ARB => (LUMINANCE_ALPHA, Half),
        _ => return None,
    })
}

fn depth(token: u32) -> Option<(u32, Storage)> {
    Some(match token {
        DEPTH_COMPONENT16 => (DEPTH_COMPONENT, Storage::Depth(16)),
        // A float holds 24-bit integers exactly, no wider ones.
        DEPTH_COMPONENT | DEPTH_COMPONENT24 | DEPTH_COMPONENT32 => {
            (DEPTH_COMPONENT, Storage::Depth(24))
        }
        DEPTH_COMPONENT32F => (DEPTH_COMPONENT, Storage::Depth(32)),
        DEPTH_STENCIL | DEPTH24_STENCIL8 => (DEPTH_STENCIL, Storage::Depth(24)),
        DEPTH32F_STENCIL8 => (DEPTH_STENCIL, Storage::Depth(32)),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_report_what_they_store() {
        let bits = |token| InternalFormat::of_texture(token).unwrap().bits();
        assert_eq!(bits(RGB5_A1).rgba, [8; 4]);
        assert_eq!(bits(3).rgba, [8, 8, 8, 0]);
        assert_eq!(bits(LUMINANCE16_ALPHA16).luminance, 16);
        assert_eq!(bits(DEPTH32F_STENCIL8), Bits { depth: 32, stencil: 8, ..Bits::default() });
        assert_eq!(InternalFormat::of_texture(COMPRESSED_RGB).unwrap().token, RGB);
        assert_eq!(InternalFormat::of_texture(COMPRESSED_RGB_S3TC_DXT1_EXT).unwrap().token, RGB);
        assert_eq!(
            InternalFormat::of_texture(COMPRESSED_SRGB_EXT).unwrap().storage,
            Storage::Srgb8
        );
        assert_eq!(InternalFormat::of_renderbuffer(LUMINANCE8).unwrap().bits().luminance, 8);
        assert!(InternalFormat::of_renderbuffer(COMPRESSED_RGB).is_none());
        assert_eq!(InternalFormat::of_renderbuffer(RGBA16).unwrap().bits().rgba, [16; 4]);
        assert_eq!(
            InternalFormat::of_renderbuffer(RGB16F_ARB).unwrap().bits().rgba,
            [16, 16, 16, 0]
        );
    }

    #[test]
    fn words_expand_as_colours_do() {
        for token in [ALPHA, LUMINANCE, LUMINANCE_ALPHA, INTENSITY, RED, RG, RGB, RGBA] {
            let format = InternalFormat::of_texture(token).unwrap();
            let color = format.expand([51.0, 102.0, 153.0, 204.0].map(|v| v / 255.0));
            let word = u32::from_le_bytes(color.map(|v| (v * 255.0 + 0.5) as u8));
            assert_eq!(format.expand_word(u32::from_le_bytes([51, 102, 153, 204])), word);
            let kept = format.kept([51.0, 102.0, 153.0, 204.0].map(|v| v / 255.0));
            let word = u32::from_le_bytes(kept.map(|v| (v * 255.0 + 0.5) as u8));
            assert_eq!(format.kept_word(u32::from_le_bytes([51, 102, 153, 204])), word);
        }
    }
}
