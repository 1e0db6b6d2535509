//! The background of a picture, row by row.

use super::composed;
use crate::{Background, Cached, Reuse};
use vitral_math::color::byte_from_unit;
use vitral_math::lanes::Lanes;

/// What the rows of the background depend on: what it is, the picture's height, whether the colour
/// space is raw.
pub(crate) type BackgroundKey = (Background, u32, bool);

/// The background of each row of a picture.
#[derive(Debug)]
pub(crate) struct BackgroundRows {
    /// In the space in which colours are composed, and 0 or 1 for its alpha.
    pub colors: Vec<[f32; 4]>,
    /// As display bytes.
    pub bytes: Vec<[u8; 4]>,
    /// The colour space is raw.
    raw: bool,
}

impl Cached for BackgroundRows {
    type Key = BackgroundKey;
    const REUSE: Reuse = Reuse::Session;
    const PLACED: bool = false;
}

impl BackgroundRows {
    /// The rows of a picture of this height.
    pub(crate) fn new((background, height, raw): &BackgroundKey) -> Self {
        let light = |c| composed(c, *raw);
        let opaque = |c: [f32; 3]| [c[0], c[1], c[2], 1.0];
        let row = |y: u32| match background {
            Background::Transparent => [0.0; 4],
            Background::Color { color } => opaque(light(*color)),
            Background::Gradient { top, bottom } => {
                let t = (y as f32 + 0.5) / *height as f32;
                opaque(light([0, 1, 2].map(|k| top[k] + (bottom[k] - top[k]) * t)))
            }
        };
        let encode = |c: f32| byte_from_unit(if *raw { c } else { Lanes::srgb_from_linear(c) });
        let bytes = |c: &[f32; 4]| [encode(c[0]), encode(c[1]), encode(c[2]), byte_from_unit(c[3])];
        let colors: Vec<[f32; 4]> = (0..*height).map(row).collect();
        Self { bytes: colors.iter().map(bytes).collect(), colors, raw: *raw }
    }

    /// The colour of a row, or of the last one, of which a shadow takes the part `dark`. On nothing
    /// it is a black veil: viewers lay pictures over what they show in the display's encoding, so
    /// its alpha is what darkens that as light is darkened here.
    pub(crate) fn shaded(&self, row: u32, dark: f32) -> [f32; 4] {
        let [r, g, b, a] = self.color(row);
        let kept = 1.0 - dark;
        let veil = 1.0 - if self.raw { kept } else { Lanes::srgb_from_linear(kept) };
        [r * kept, g * kept, b * kept, a + (1.0 - a) * veil]
    }

    /// The colour of a row, or of the last one, in the space of composition.
    #[inline]
    pub(crate) fn color(&self, row: u32) -> [f32; 4] {
        self.colors[(row as usize).min(self.colors.len() - 1)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shadow_darkens_colours_and_veils_nothing() {
        let rows = |background, raw| BackgroundRows::new(&(background, 2, raw));
        let grey = rows(Background::Color { color: [0.5; 3] }, true);
        assert_eq!(grey.shaded(0, 0.75), [0.125, 0.125, 0.125, 1.0]);
        assert_eq!(rows(Background::Transparent, true).shaded(9, 0.75), [0.0, 0.0, 0.0, 0.75]);
        // Laid over an encoded colour, the veil gives about the code of the darkened colour.
        let [.., alpha] = rows(Background::Transparent, false).shaded(0, 0.75);
        for code in [1.0f32, 0.8, 0.5] {
            let darkened: f32 = Lanes::srgb_from_linear(0.25 * Lanes::linear_from_srgb(code));
            assert!((code * (1.0 - alpha) - darkened).abs() < 0.02, "{code}: {alpha}");
        }
    }
}
