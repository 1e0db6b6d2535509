//! Mipmaps: each level is the one before it, looked up with a linear filter at its own texels'
//! centres.
//!
//! For a side of even length that is the average of two texels; for an odd one, of the two nearest,
//! as hardware does it when it draws a level from the one before. sRGB colours are averaged as
//! light. Borders are filtered along their edge.

use super::image::{TextureImage, lock};
use super::internal_format::{InternalFormat, Storage};
use super::texels::{self, TexelData, color_from_word, word_from_color};
use super::texture::{ImageTarget, TextureObject, slot, slot_of};
use crate::Context;
use crate::enums::*;
use std::ops::Range;
use std::sync::OnceLock;
use vitral_math::color::{linear_from_srgb, linear_from_srgb_table};
use vitral_raster::forward::{Level, Texels};

/// Source texels with weights, for each texel along one axis.
type Taps = Vec<Vec<(usize, f32)>>;

/// The taps from `from` to `to` texels inside borders of `border`: the two source texels round each
/// new centre.
fn taps(from: usize, to: usize, border: usize) -> Taps {
    let mut out: Taps = Vec::with_capacity(to + 2 * border);
    for i in 0..to {
        let center = ((2 * i + 1) * from) as f32 / (2 * to) as f32 - 0.5;
        let low = center.floor().max(0.0);
        let weight = center.max(0.0) - low;
        let (low, high) = (low as usize, (low as usize + 1).min(from - 1));
        out.push(if from == to {
            vec![(i + border, 1.0)]
        } else {
            vec![(low + border, 1.0 - weight), (high + border, weight)]
        });
    }
    if border > 0 {
        out.insert(0, vec![(0, 1.0)]);
        out.push(vec![(from + border, 1.0)]);
    }
    out
}

/// Filters one axis. The source is `[outer][from][inner]`.
fn filter_axis(source: &[[f32; 4]], from: usize, inner: usize, taps: &Taps) -> Vec<[f32; 4]> {
    // Skip empty images and axes that keep their length.
    if from == 0 || inner == 0 {
        return Vec::new();
    }
    if taps.len() == from && taps.iter().all(|t| t.len() == 1) {
        return source.to_vec();
    }

    // Sum the weighted texels of each tap.
    let mut out = Vec::with_capacity(source.len() / from * taps.len());
    for block in source.chunks_exact(from * inner) {
        for taps in taps {
            for i in 0..inner {
                let mut sum = [0.0f32; 4];
                for &(t, weight) in taps {
                    let texel = block[t * inner + i];
                    for c in 0..4 {
                        sum[c] += texel[c] * weight;
                    }
                }
                out.push(sum);
            }
        }
    }
    out
}

/// Averages two by two words. Both sides of the source are even.
fn halve_words(source: &[u32], width: usize) -> Vec<u32> {
    let mut out = Vec::with_capacity(source.len() / 4);
    for rows in source.chunks_exact(2 * width) {
        let (low, high) = rows.split_at(width);
        out.extend(
            low.chunks_exact(2)
                .zip(high.chunks_exact(2))
                .map(|(a, b)| average4([a[0], a[1], b[0], b[1]])),
        );
    }
    out
}

/// As [`halve_words`], of sRGB words: light is averaged, in 65535ths.
fn halve_srgb(source: &[u32], width: usize) -> Vec<u32> {
    let light = linear_table().map(|v| (v * 65535.0 + 0.5) as u32);
    let bytes = srgb_bytes();
    let mix = |words: [u32; 4]| {
        let alpha = average4(words) & 0xff00_0000;
        (0..3).fold(alpha, |word, c| {
            let sum: u32 = words.iter().map(|w| light[((w >> (8 * c)) & 255) as usize]).sum();
            word | (u32::from(bytes[((sum + 2) / 4) as usize]) << (8 * c))
        })
    };
    let mut out = Vec::with_capacity(source.len() / 4);
    for rows in source.chunks_exact(2 * width) {
        let (low, high) = rows.split_at(width);
        out.extend(
            low.chunks_exact(2)
                .zip(high.chunks_exact(2))
                .map(|(a, b)| mix([a[0], a[1], b[0], b[1]])),
        );
    }
    out
}

/// The average of each byte of four words, rounded to nearest, halves up.
#[inline]
pub(crate) fn average4(words: [u32; 4]) -> u32 {
    const EVEN: u32 = 0x00ff_00ff;
    let even = words.iter().fold(0x0002_0002, |sum, w| sum + (w & EVEN));
    let odd = words.iter().fold(0x0002_0002, |sum, w| sum + ((w >> 8) & EVEN));
    ((even >> 2) & EVEN) | (((odd >> 2) & EVEN) << 8)
}

/// The sRGB byte of each 16-bit amount of light.
fn srgb_bytes() -> &'static [u8] {
    static TABLE: OnceLock<Vec<u8>> = OnceLock::new();
    TABLE.get_or_init(|| {
        let mut table = vec![255; 65536];
        let mut first = 0;
        for byte in 0..255u8 {
            let end = (linear_from_srgb((f32::from(byte) + 0.5) / 255.0) * 65535.0) as usize + 1;
            table[first..end].fill(byte);
            first = end;
        }
        table
    })
}

fn linear_table() -> &'static [f32; 256] {
    static TABLE: OnceLock<[f32; 256]> = OnceLock::new();
    TABLE.get_or_init(linear_from_srgb_table)
}

/// The light of an sRGB word.
fn light_from_word(word: u32) -> [f32; 4] {
    let [r, g, b, a] = word.to_le_bytes();
    let table = linear_table();
    [table[r as usize], table[g as usize], table[b as usize], f32::from(a) / 255.0]
}

/// The sRGB word of light.
fn word_from_light([r, g, b, a]: [f32; 4]) -> u32 {
    let table = srgb_bytes();
    let byte = |v: f32| table[(v.clamp(0.0, 1.0) * 65535.0 + 0.5) as usize];
    u32::from_le_bytes([byte(r), byte(g), byte(b), (a.clamp(0.0, 1.0) * 255.0 + 0.5) as u8])
}

/// The level after `level`.
fn next_level(
    level: &Level,
    format: &InternalFormat,
    inner: [u32; 3],
    next: [u32; 3],
) -> TexelData {
    let border = level.border as usize;
    let halved = inner[2] == next[2] && inner[0] == 2 * next[0] && inner[1] == 2 * next[1];

    // Halve words with a box filter where all sizes are even.
    match level.texels() {
        Texels::Rgba8(words) if halved && border == 0 => {
            return TexelData::Words(halve_words(words, inner[0] as usize));
        }
        Texels::Srgb8(words) if halved && border == 0 => {
            return TexelData::Words(halve_srgb(words, inner[0] as usize));
        }
        _ => {}
    }

    // Expand the texels to colours.
    let colors: Vec<[f32; 4]> = match level.texels() {
        Texels::Rgba8(words) => words.iter().map(|&w| color_from_word(w)).collect(),
        Texels::Srgb8(words) => words.iter().map(|&w| light_from_word(w)).collect(),
        Texels::RgbaF32(colors) => colors.clone(),
        Texels::Depth(depths) => depths.iter().map(|&d| [d, 0.0, 0.0, 0.0]).collect(),
        Texels::DepthBuffer(plane) => {
            let mut plane = lock(plane);
            plane.resolved();
            let [width, height] = [level.size[0], level.size[1]];
            let at = |i: u32| plane.plane().get(i % width, i / width, 0) / plane.scale;
            (0..width * height).map(|i| [at(i), 0.0, 0.0, 0.0]).collect()
        }
    };
    let [width, height, depth] = level.size.map(|s| s as usize);
    // An axis that the kind of texture does not use has no border.
    let axis = |i: usize| {
        let used = level.size[i] as usize - inner[i] as usize;
        taps(inner[i] as usize, next[i] as usize, used / 2)
    };

    // Filter the axes one after the other.
    let across = axis(0);
    let up = axis(1);
    let colors = filter_axis(&colors, width, 1, &across);
    let colors = filter_axis(&colors, height, across.len(), &up);
    let colors = filter_axis(&colors, depth, across.len() * up.len(), &axis(2));

    // Convert the colours to the format's texels.
    match format.storage {
        Storage::Unorm8 => TexelData::Words(colors.into_iter().map(word_from_color).collect()),
        Storage::Srgb8 => TexelData::Words(colors.into_iter().map(word_from_light).collect()),
        Storage::Depth(_) | Storage::Stencil => {
            let mut depths: Vec<f32> = colors.into_iter().map(|c| c[0]).collect();
            texels::round_depths(&mut depths, format);
            TexelData::Depths(depths, None)
        }
        _ => texels::from_colors(colors, format),
    }
}

/// Makes the levels after the base level of some faces. Recorded commands must have run if the
/// texture is stale.
pub(crate) fn generate(texture: &mut TextureObject, faces: Range<usize>) {
    let Some(base) = texture.base_level() else { return };
    let used = texture.dimensions();
    for face in faces {
        // Find the size of the base level without borders.
        let Some(image) = texture.image(face, base) else { continue };
        let (format, border, mut inner) = (image.format, image.border, image.size);
        inner[..used].iter_mut().for_each(|s| *s -= 2 * border);
        // There is nothing to filter between borders that meet.
        if inner.contains(&0) {
            continue;
        }

        // Choose the last level.
        let mut level = image.level();
        let largest = inner[..used].iter().max().map_or(1, |&s| s.max(1));
        let limit = usize::try_from(texture.parameters.levels[1]).unwrap_or(0);
        let last = (base + largest.ilog2() as usize).min(limit);

        // Filter level by level.
        for number in base + 1..=last {
            let next = texture.next_size(inner);
            let data = next_level(&level, &format, inner, next);
            let mut size = next;
            size[..used].iter_mut().for_each(|s| *s += 2 * border);
            let mut image = TextureImage::new(format, size, border);
            image.replace(data);
            level = image.level();
            texture.set_image(face, number, Some(image));
            inner = next;
        }
    }
    texture.touch();
}

impl Context {
    /// `glGenerateMipmap`. It is not compiled into display lists.
    pub fn generate_mipmap(&mut self, target: u32) {
        const CALL: &str = "glGenerateMipmap";
        if !self.outside_begin(CALL) {
            return;
        }

        // Check the target.
        let Some(slot) = slot_of(target).filter(|&s| s != slot::RECTANGLE) else {
            self.record_error(INVALID_ENUM, CALL, "target is not a texture target with mipmaps");
            return;
        };

        // Finish the draws into the texture.
        let texture = self.target_texture(ImageTarget { slot, face: 0, proxy: false });
        let stale = lock(&texture).needs_flush();
        if stale {
            self.flush_recorded();
        }

        // Check that there is something to filter.
        let mut texture = lock(&texture);
        let faces = if slot == slot::CUBE { 6 } else { 1 };
        if slot == slot::CUBE && !texture.is_cube_base_complete() {
            drop(texture);
            self.record_error(INVALID_OPERATION, CALL, "the cube map's base level is not complete");
            return;
        }
        if texture
            .base_level()
            .and_then(|level| texture.image(0, level))
            .is_some_and(|i| i.format.has_stencil())
        {
            drop(texture);
            self.record_error(INVALID_OPERATION, CALL, "depths and stencil values have no mipmaps");
            return;
        }

        // Generate the levels.
        generate(&mut texture, 0..faces);
        drop(texture);
        self.shared.storage_changed();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn averages_round_to_nearest() {
        assert_eq!(average4([0xff00_0001, 0xff00_0002, 0xff00_0002, 0xff00_0001]), 0xff00_0002);
        assert_eq!(average4([u32::MAX; 4]), u32::MAX);
        assert_eq!(average4([255, 0, 0, 0]), 64);
    }

    #[test]
    fn odd_sides_interpolate_at_the_new_centres() {
        // 3 texels become 1; 5 become 2, with centres at 1.25 and 3.75.
        assert_eq!(taps(3, 1, 0).len(), 1);
        let weights: f32 = taps(3, 1, 0)[0].iter().map(|t| t.1).sum();
        assert!((weights - 1.0).abs() < 1e-6);
        assert_eq!(taps(5, 2, 0)[0], [(0, 0.25), (1, 0.75)]);
        assert_eq!(taps(5, 2, 0)[1], [(3, 0.75), (4, 0.25)]);
        assert_eq!(taps(2, 1, 1), [vec![(0, 1.0)], vec![(1, 0.5), (2, 0.5)], vec![(3, 1.0)]]);
    }

    #[test]
    fn srgb_averages_light() {
        for byte in 0..=255u8 {
            let word = u32::from_le_bytes([byte; 4]);
            assert_eq!(word_from_light(light_from_word(word)), word);
        }
        // Half of the light of white is brighter than the middle byte.
        assert_eq!(word_from_light([0.5, 0.5, 0.5, 0.5]), u32::from_le_bytes([188, 188, 188, 128]));
    }

    #[test]
    fn halves_of_srgb_agree_with_the_general_way() {
        let source = [0x4000_ff10, 0x40ff_0020, 0x40ff_0030, 0x4000_ff40];
        let light = source.map(light_from_word);
        let mean = std::array::from_fn(|c| light.iter().map(|l| l[c]).sum::<f32>() / 4.0);
        assert_eq!(halve_srgb(&source, 2), [word_from_light(mean)]);
    }

    #[test]
    fn lists_do_not_hold_back_mipmaps() {
        let mut c = super::super::testing::context();
        c.tex_image_2d(TEXTURE_2D, 0, RGBA as i32, 2, 2, 0, RGBA, UNSIGNED_BYTE, 0);
        c.new_list(1, COMPILE);
        c.generate_mipmap(TEXTURE_2D);
        c.end_list();
        let texture = c.bound_texture(0, slot::TWO);
        assert!(lock(&texture).image(0, 1).is_some());
        lock(&texture).set_image(0, 1, None);
        c.call_list(1);
        assert!(lock(&texture).image(0, 1).is_none());
    }

    #[test]
    fn borders_without_an_interior_have_no_levels() {
        let mut c = super::super::testing::context();
        for (width, height) in [(2, 6), (6, 2), (2, 2)] {
            c.tex_image_2d(TEXTURE_2D, 0, RGBA as i32, width, height, 1, RGBA, UNSIGNED_BYTE, 0);
            c.generate_mipmap(TEXTURE_2D);
        }
        assert_eq!(c.error, NO_ERROR);
        assert!(lock(&c.bound_texture(0, slot::TWO)).image(0, 1).is_none());
    }

    #[test]
    fn all_levels_are_made() {
        let mut texture = TextureObject::new(1, slot::TWO);
        let mut image = TextureImage::new(InternalFormat::of_texture(RGB).unwrap(), [6, 3, 1], 0);
        image.replace(TexelData::Words(vec![0xff10_2030; 18]));
        texture.set_image(0, 0, Some(image));
        generate(&mut texture, 0..1);
        let snapshot = texture.sampled(false, None).unwrap();
        let sizes: Vec<_> = snapshot.faces[0].iter().map(|l| [l.size[0], l.size[1]]).collect();
        assert_eq!(sizes, [[6, 3], [3, 1], [1, 1]]);
        let Texels::Rgba8(last) = snapshot.faces[0][2].texels() else { panic!() };
        assert_eq!(last[..], [0xff10_2030]);
    }
}
