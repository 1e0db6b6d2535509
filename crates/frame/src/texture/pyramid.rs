//! Building a mipmap pyramid: each level is the one before at half the size, down to a single
//! texel.
//!
//! A texel of the next level is the mean of the area that it covers (a box filter). A side of even
//! length halves cleanly; of an odd side of `2n + 1` texels each new texel covers `2 + 1/n` old
//! ones, so three of them count, the outer two in part. That way every old texel has the same share
//! in the result, and the mean of the image survives.
//!
//! Colours are averaged as light, that is decoded from sRGB first, and weighted with their alpha,
//! so that a colour hidden under full transparency does not bleed into the visible ones. Where
//! everything is transparent the plain mean is kept (a material may ignore alpha): every texel
//! counts as if its alpha were 2^-20 higher, which has no visible effect anywhere else.
//!
//! In:   the base image, straight alpha, as bytes.
//! Out:  all levels as bytes; each is computed from the unrounded level before, so rounding errors
//!       do not add up.
//! Cost: `O(texels)`; transient memory of 4 bytes for each byte of level 1.
//! Source: \[Williams 1983\]; the weights of odd sizes are the exact areas.

use super::{Encoding, Texture};
use crate::Plane;
use vitral_math::color::{byte_from_unit, linear_from_srgb};

/// What is added to each alpha to give its weight.
const LEAST_WEIGHT: f32 = 1.0 / 1_048_576.0;

/// Linear light times weight (RGB), and the weight.
type Weighted = [f32; 4];

impl Texture {
    /// A texture with all its levels. `base` is RGBA with straight alpha, its first row the top of
    /// the image; an empty one counts as a single white texel, which changes nothing that it
    /// multiplies.
    #[must_use]
    pub fn new(name: String, base: Plane<[u8; 4]>, encoding: Encoding) -> Self {
        let base = if base.data().is_empty() { Plane::filled(1, 1, [255; 4]) } else { base };
        let mut levels = vec![base];
        let codec = Codec::new(encoding);

        // Halve the bytes of the base, then always the unrounded level that this gave.
        let (mut width, mut height) = (levels[0].width() as usize, levels[0].height() as usize);
        let mut unrounded: Option<Vec<Weighted>> = None;
        while width > 1 || height > 1 {
            let (narrow, low) = ((width / 2).max(1), (height / 2).max(1));
            let half = match &unrounded {
                None => halve(width, height, levels[0].data(), |&texel| codec.decode(texel)),
                Some(texels) => halve(width, height, texels, |&texel| texel),
            };
            let bytes = half.iter().map(|&texel| codec.encode(texel)).collect();
            levels.extend(Plane::from_rows(narrow as u32, low as u32, bytes));
            (width, height, unrounded) = (narrow, low, Some(half));
        }
        Self { name, levels, encoding }
    }
}

/// The texels of one side that make up one texel of the halved side: from `first` on, with these
/// shares (sum 1).
struct Taps {
    first: usize,
    count: usize,
    shares: [f32; 3],
}

/// The taps of texel `i` when a side of `size` texels is halved.
fn taps(size: usize, i: usize) -> Taps {
    if size == 1 {
        return Taps { first: 0, count: 1, shares: [1.0, 0.0, 0.0] };
    }
    if size.is_multiple_of(2) {
        return Taps { first: 2 * i, count: 2, shares: [0.5, 0.5, 0.0] };
    }
    let (n, whole) = ((size / 2) as f32, size as f32);
    Taps {
        first: 2 * i,
        count: 3,
        shares: [(n - i as f32) / whole, n / whole, (i as f32 + 1.0) / whole],
    }
}

/// Halves an image of `width * height` texels, which `weigh` makes linear.
fn halve<T>(
    width: usize,
    height: usize,
    texels: &[T],
    weigh: impl Fn(&T) -> Weighted,
) -> Vec<Weighted> {
    let (narrow, low) = ((width / 2).max(1), (height / 2).max(1));
    let columns: Vec<Taps> = (0..narrow).map(|i| taps(width, i)).collect();
    let mut half = Vec::with_capacity(narrow * low);
    let mut sums = vec![[0.0; 4]; width];
    for y in 0..low {
        // Mix the two or three rows into one.
        let rows = taps(height, y);
        sums.fill([0.0; 4]);
        for (k, &share) in rows.shares[..rows.count].iter().enumerate() {
            let row = &texels[(rows.first + k) * width..][..width];
            for (sum, texel) in sums.iter_mut().zip(row) {
                add_share(sum, weigh(texel), share);
            }
        }

        // Mix the columns of that row.
        half.extend(columns.iter().map(|column| {
            let mut sum = [0.0; 4];
            for (&texel, &share) in sums[column.first..][..column.count].iter().zip(&column.shares)
            {
                add_share(&mut sum, texel, share);
            }
            sum
        }));
    }
    half
}

/// Adds `share` of a texel.
#[inline(always)]
fn add_share(sum: &mut Weighted, texel: Weighted, share: f32) {
    for channel in 0..4 {
        sum[channel] += texel[channel] * share;
    }
}

/// Buckets of the search for the sRGB byte of a linear value: no byte's range is narrower than a
/// bucket.
const BUCKETS: usize = 4096;

/// Bytes to weighted linear light and back.
struct Codec {
    /// Linear value of each colour byte.
    linear: [f32; 256],
    /// Weight of each alpha byte.
    weight: [f32; 256],
    /// For sRGB: the least linear value that rounds to the byte (index 0 is never used), and the
    /// byte at the start of each bucket.
    search: Option<([f32; 256], Vec<u8>)>,
}

impl Codec {
    fn new(encoding: Encoding) -> Self {
        let search = (encoding == Encoding::Srgb).then(|| {
            let least: [f32; 256] =
                std::array::from_fn(|byte| linear_from_srgb((byte as f32 - 0.5) / 255.0));
            let start = |bucket: usize| {
                let value = bucket as f32 / BUCKETS as f32;
                least[1..].partition_point(|&limit| limit <= value) as u8
            };
            (least, (0..=BUCKETS).map(start).collect())
        });
        Self {
            linear: super::decode_table(encoding, false),
            weight: std::array::from_fn(|byte| byte as f32 / 255.0 + LEAST_WEIGHT),
            search,
        }
    }

    #[inline(always)]
    fn decode(&self, [r, g, b, a]: [u8; 4]) -> Weighted {
        let weight = self.weight[usize::from(a)];
        let colour = |byte: u8| self.linear[usize::from(byte)] * weight;
        [colour(r), colour(g), colour(b), weight]
    }

    #[inline(always)]
    fn encode(&self, [r, g, b, weight]: Weighted) -> [u8; 4] {
        let scale = 1.0 / weight;
        let colour = |value: f32| self.byte(value * scale);
        [colour(r), colour(g), colour(b), byte_from_unit(weight - LEAST_WEIGHT)]
    }

    /// The byte whose decoded value is nearest in the encoding's own scale.
    #[inline(always)]
    fn byte(&self, value: f32) -> u8 {
        let Some((least, starts)) = &self.search else { return byte_from_unit(value) };
        let value = value.clamp(0.0, 1.0);
        let mut byte = starts[(value * BUCKETS as f32) as usize];
        while byte < 255 && least[usize::from(byte) + 1] <= value {
            byte += 1;
        }
        byte
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::color::srgb_from_linear;

    fn texture(
        width: u32,
        height: u32,
        encoding: Encoding,
        texel: impl Fn(u32, u32) -> [u8; 4],
    ) -> Texture {
        let data = (0..width * height).map(|i| texel(i % width, i / width)).collect();
        Texture::new("test".into(), Plane::from_rows(width, height, data).unwrap(), encoding)
    }

    /// Some bytes without pattern.
    fn noise(x: u32, y: u32, channel: u32) -> u8 {
        ((x * 73 + y * 151 + channel * 61 + x * y * 7).wrapping_mul(2_654_435_761) >> 24) as u8
    }

    #[test]
    fn sides_halve_rounding_down_until_one_texel_is_left() {
        let t = texture(5, 2, Encoding::Linear, |_, _| [9, 9, 9, 255]);
        let sizes: Vec<_> = t.levels.iter().map(|l| (l.width(), l.height())).collect();
        assert_eq!(sizes, [(5, 2), (2, 1), (1, 1)]);
        assert!(
            t.levels.iter().flat_map(Plane::data).all(|&texel| texel == [9, 9, 9, 255]),
            "a flat colour stays"
        );
        assert_eq!(texture(1, 1, Encoding::Srgb, |_, _| [1, 2, 3, 4]).levels.len(), 1);
    }

    #[test]
    fn an_empty_image_is_one_white_texel() {
        let t = Texture::new(String::new(), Plane::default(), Encoding::Srgb);
        assert_eq!((t.levels.len(), t.levels[0].data()), (1, &[[255; 4]][..]));
    }

    #[test]
    fn a_checker_becomes_the_mean_of_its_light() {
        let checker = |x, y| if (x + y) % 2 == 0 { [255; 4] } else { [0, 0, 0, 255] };
        assert_eq!(
            *texture(2, 2, Encoding::Srgb, checker).levels[1].at(0, 0),
            [188, 188, 188, 255]
        );
        assert_eq!(
            *texture(2, 2, Encoding::Linear, checker).levels[1].at(0, 0),
            [128, 128, 128, 255]
        );
        assert_eq!(
            *texture(64, 64, Encoding::Srgb, checker).levels[6].at(0, 0),
            [188, 188, 188, 255]
        );
    }

    #[test]
    fn odd_sizes_conserve_the_mean() {
        for (width, height) in [(3, 1), (1, 7), (5, 5), (7, 12), (31, 9)] {
            let t = texture(width, height, Encoding::Linear, |x, y| {
                [noise(x, y, 0), noise(x, y, 1), noise(x, y, 2), 255]
            });
            for channel in 0..3 {
                let mean = |level: &Plane<[u8; 4]>| {
                    level.data().iter().map(|t| f64::from(t[channel])).sum::<f64>()
                        / level.data().len() as f64
                };
                for level in &t.levels {
                    let error = (mean(level) - mean(&t.levels[0])).abs();
                    assert!(
                        error <= 0.51,
                        "{width}x{height}, level of width {}: {error}",
                        level.width()
                    );
                }
            }
        }
    }

    #[test]
    fn five_texels_become_two_of_two_and_a_half() {
        let t = texture(5, 1, Encoding::Linear, |x, _| [(x * 50) as u8, 0, 0, 255]);
        // Two new texels of 2.5 old ones: (0 + 50 + 100/2) / 2.5 and (100/2 + 150 + 200) / 2.5.
        assert_eq!(t.levels[1].data().iter().map(|t| t[0]).collect::<Vec<_>>(), [40, 160]);
    }

    #[test]
    fn transparent_colours_do_not_bleed_and_survive_alone() {
        let t = texture(4, 1, Encoding::Linear, |x, _| {
            if x == 0 { [200, 0, 0, 255] } else { [0, 255, 80, 0] }
        });
        assert_eq!(t.levels[1].data(), [[200, 0, 0, 128], [0, 255, 80, 0]]);
        assert_eq!(t.levels[2].data(), [[200, 0, 0, 64]]);
    }

    #[test]
    fn the_byte_search_is_the_encoding_formula() {
        let codec = Codec::new(Encoding::Srgb);
        for i in 0..=200_000u32 {
            let value = i as f32 / 200_000.0;
            let encoded = srgb_from_linear(value) * 255.0;
            let off = (f32::from(codec.byte(value)) - encoded).abs();
            assert!(off <= 0.500_1, "{value}: {encoded} became {}", codec.byte(value));
        }
        for byte in 0..=255u8 {
            assert_eq!(codec.byte(linear_from_srgb(f32::from(byte) / 255.0)), byte);
        }
    }
}
