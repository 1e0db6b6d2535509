//! Looking a texture up at one point: wrap, choose levels, filter.
//!
//! The level of detail `lod` is the logarithm to base 2 of how many texels of level 0 fall on one
//! pixel. At 0 or below a texel is larger than a pixel and the magnification filter reads level 0;
//! above, the minification filter reads the level whose texels are about as large as a pixel, or
//! mixes the two nearest.
//!
//! In:   texture coordinates (origin at the top left, one texture wide), `lod`, and a table that
//!       makes colour bytes linear.
//! Out:  RGBA with straight alpha. Texels are mixed in straight form, after decoding, as OpenGL and
//!       glTF define it.
//! Cost: one texel (nearest), four (bilinear) or eight (trilinear), read one by one.
//! Source: \[Williams 1983\] for trilinear lookup; [OpenGL 2.1], section 3.8, for wrap modes and
//! texel centres. Departs from it: magnification begins at `lod <= 0` whatever the filters are.

use super::{Encoding, Filter, MipFilter, Sampler, Texture, Wrap};
use crate::Plane;
use vitral_math::color::linear_from_srgb_table;

/// The value of each colour byte, for [`Texture::sample`]: linear light, or with `raw` simply
/// `byte / 255`, which is the course's arithmetic on encoded values.
pub fn decode_table(encoding: Encoding, raw: bool) -> [f32; 256] {
    match encoding {
        Encoding::Srgb if !raw => linear_from_srgb_table(),
        Encoding::Srgb | Encoding::Linear => std::array::from_fn(|byte| byte as f32 / 255.0),
    }
}

impl Texture {
    /// The texture at `(u, v)`: RGBA, straight alpha. Colour bytes become values through `decode`
    /// (see [`decode_table`]), alpha is `byte / 255`. `lod` is the logarithm to base 2 of the
    /// texels of level 0 per pixel; NaN counts as 0. A coordinate that is not finite counts as 0. A
    /// texture without texels is white.
    #[inline]
    #[must_use]
    pub fn sample(
        &self,
        sampler: &Sampler,
        u: f32,
        v: f32,
        lod: f32,
        decode: &[f32; 256],
    ) -> [f32; 4] {
        let Some(last) = self.levels.len().checked_sub(1) else { return [1.0; 4] };
        let point = Lookup {
            u: reduce(u, sampler.wrap_s),
            v: reduce(v, sampler.wrap_t),
            repeat_s: sampler.wrap_s == Wrap::Repeat,
            repeat_t: sampler.wrap_t == Wrap::Repeat,
            decode,
        };
        let minified = lod > 0.0;
        let filter = if minified { sampler.minify } else { sampler.magnify };
        let rgba = if !minified || sampler.mip == MipFilter::None || last == 0 {
            point.filtered(&self.levels[0], filter)
        } else {
            let lod = lod.min(last as f32);
            if sampler.mip == MipFilter::Nearest {
                point.filtered(&self.levels[(lod + 0.5) as usize], filter)
            } else {
                let fine = lod as usize;
                let coarse = (fine + 1).min(last);
                let t = lod - fine as f32;
                mix(
                    point.filtered(&self.levels[fine], filter),
                    point.filtered(&self.levels[coarse], filter),
                    t,
                )
            }
        };
        [rgba[0], rgba[1], rgba[2], rgba[3] / 255.0]
    }
}

/// Brings a texture coordinate into `0..=1`. What remains to be done at the edge is
/// [`neighbour`]'s.
#[inline(always)]
fn reduce(coordinate: f32, wrap: Wrap) -> f32 {
    let x = if coordinate.is_finite() { coordinate } else { 0.0 };
    match wrap {
        Wrap::Repeat => x - floor(x),
        Wrap::ClampToEdge => x.clamp(0.0, 1.0),
        Wrap::MirroredRepeat => {
            let t = x - 2.0 * floor(x * 0.5);
            if t > 1.0 { 2.0 - t } else { t }
        }
    }
}

/// Largest whole number not above a finite `x`, without the library call that `f32::floor` is
/// before SSE4.1.
#[inline(always)]
fn floor(x: f32) -> f32 {
    let towards_zero = (x as i32) as f32;
    let below = if towards_zero > x { towards_zero - 1.0 } else { towards_zero };
    // From 2^23 on every f32 is whole.
    if x.abs() < 8_388_608.0 { below } else { x }
}

/// The texel for index `i` in `-1..=size`: round the corner if the texture repeats, else the edge
/// texel (a mirrored texture has its own edge texel on the other side of the edge).
#[inline(always)]
fn neighbour(i: i32, size: i32, repeat: bool) -> usize {
    let below = if repeat { size - 1 } else { 0 };
    let above = if repeat { 0 } else { size - 1 };
    let i = if i < 0 { below } else { i };
    (if i >= size { above } else { i }) as usize
}

/// A point to look up in one or two levels.
struct Lookup<'a> {
    u: f32,
    v: f32,
    repeat_s: bool,
    repeat_t: bool,
    decode: &'a [f32; 256],
}

impl Lookup<'_> {
    /// The decoded colour in one level, alpha as `0..=255`.
    #[inline(always)]
    fn filtered(&self, level: &Plane<[u8; 4]>, filter: Filter) -> [f32; 4] {
        let (width, height) = (level.width() as i32, level.height() as i32);
        let (x, y) = (self.u * width as f32, self.v * height as f32);
        if filter == Filter::Nearest {
            let (i, j) = (
                neighbour(x as i32, width, self.repeat_s),
                neighbour(y as i32, height, self.repeat_t),
            );
            return self.texel(level, i, j);
        }

        // Find the four texels whose centres surround the point, and how far it is from the upper
        // left one.
        let (x, y) = (x - 0.5, y - 0.5);
        let (i, j) = (x as i32 - i32::from(x < 0.0), y as i32 - i32::from(y < 0.0));
        let (i0, i1) = (neighbour(i, width, self.repeat_s), neighbour(i + 1, width, self.repeat_s));
        let (j0, j1) =
            (neighbour(j, height, self.repeat_t), neighbour(j + 1, height, self.repeat_t));

        // Mix along the two rows, then between them.
        let (s, t) = (x - i as f32, y - j as f32);
        let upper = mix(self.texel(level, i0, j0), self.texel(level, i1, j0), s);
        let lower = mix(self.texel(level, i0, j1), self.texel(level, i1, j1), s);
        mix(upper, lower, t)
    }

    /// One decoded texel, alpha as `0..=255`.
    #[inline(always)]
    fn texel(&self, level: &Plane<[u8; 4]>, i: usize, j: usize) -> [f32; 4] {
        let [r, g, b, a] =
            level.data().get(j * level.width() as usize + i).copied().unwrap_or([255; 4]);
        let colour = |byte: u8| self.decode[usize::from(byte)];
        [colour(r), colour(g), colour(b), f32::from(a)]
    }
}

/// `a` at `t = 0`, `b` at `t = 1`.
#[inline(always)]
fn mix(a: [f32; 4], b: [f32; 4], t: f32) -> [f32; 4] {
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    const NEAREST: Sampler = Sampler {
        wrap_s: Wrap::Repeat,
        wrap_t: Wrap::Repeat,
        magnify: Filter::Nearest,
        minify: Filter::Nearest,
        mip: MipFilter::None,
    };

    fn linear(wrap: Wrap) -> Sampler {
        Sampler { wrap_s: wrap, wrap_t: wrap, ..Sampler::default() }
    }

    /// A texture with the given red bytes in one level, opaque.
    fn reds(width: u32, height: u32, reds: &[u8]) -> Texture {
        let data = reds.iter().map(|&r| [r, 0, 0, 255]).collect();
        Texture::new(
            "test".into(),
            Plane::from_rows(width, height, data).unwrap(),
            Encoding::Linear,
        )
    }

    /// Red in bytes.
    fn red(t: &Texture, sampler: &Sampler, u: f32, v: f32, lod: f32) -> f32 {
        t.sample(sampler, u, v, lod, &decode_table(Encoding::Linear, false))[0] * 255.0
    }

    fn close(a: f32, b: f32) -> bool {
        (a - b).abs() < 1e-3
    }

    #[test]
    fn bilinear_is_exact_at_centres_and_half_way_between() {
        let t = reds(2, 2, &[0, 100, 40, 200]);
        let s = linear(Wrap::ClampToEdge);
        for (u, v, expected) in [
            (0.25, 0.25, 0.0),
            (0.75, 0.25, 100.0),
            (0.25, 0.75, 40.0),
            (0.75, 0.75, 200.0),
            (0.5, 0.25, 50.0),
            (0.25, 0.5, 20.0),
            (0.5, 0.5, 85.0),
            (0.375, 0.25, 25.0),
        ] {
            assert!(close(red(&t, &s, u, v, 0.0), expected), "({u}, {v})");
        }
    }

    #[test]
    fn wrapping_by_the_truth_table() {
        // Texels 10, 20, 30 of a third each, looked up half a texel at a time from -1 to 2.
        let t = reds(3, 1, &[10, 20, 30]);
        let centres = |wrap| -> Vec<f32> {
            let s = Sampler { wrap_s: wrap, ..NEAREST };
            (-3..6).map(|i| red(&t, &s, (i as f32 + 0.5) / 3.0, 0.5, 0.0).round()).collect()
        };
        assert_eq!(centres(Wrap::Repeat), [10., 20., 30., 10., 20., 30., 10., 20., 30.]);
        assert_eq!(centres(Wrap::MirroredRepeat), [30., 20., 10., 10., 20., 30., 30., 20., 10.]);
        assert_eq!(centres(Wrap::ClampToEdge), [10., 10., 10., 10., 20., 30., 30., 30., 30.]);

        // At the edge, bilinear mixes what the wrap mode puts there.
        for (wrap, expected) in
            [(Wrap::Repeat, 20.0), (Wrap::MirroredRepeat, 10.0), (Wrap::ClampToEdge, 10.0)]
        {
            assert!(close(red(&t, &linear(wrap), 0.0, 0.5, 0.0), expected), "{wrap:?} at 0");
        }
        for (wrap, expected) in
            [(Wrap::Repeat, 20.0), (Wrap::MirroredRepeat, 30.0), (Wrap::ClampToEdge, 30.0)]
        {
            assert!(close(red(&t, &linear(wrap), 1.0, 0.5, 0.0), expected), "{wrap:?} at 1");
        }
    }

    #[test]
    fn trilinear_is_half_and_half_between_two_levels() {
        // Levels: 2x2, then 1x1 with the mean 60.
        let t = reds(2, 2, &[0, 40, 80, 120]);
        let s = linear(Wrap::Repeat);
        let fine = red(&t, &s, 0.75, 0.75, 0.0);
        assert!(close(fine, 120.0) && close(red(&t, &s, 0.75, 0.75, 1.0), 60.0));
        assert!(close(red(&t, &s, 0.75, 0.75, 0.5), 90.0));
        assert!(
            close(red(&t, &s, 0.75, 0.75, 99.0), 60.0),
            "beyond the last level the last one is read"
        );
    }

    #[test]
    fn filters_and_levels_follow_the_sampler() {
        let t = reds(2, 2, &[0, 40, 80, 120]);
        let s = Sampler {
            minify: Filter::Nearest,
            mip: MipFilter::Nearest,
            ..linear(Wrap::ClampToEdge)
        };
        assert!(close(red(&t, &s, 0.5, 0.25, -1.0), 20.0), "magnified: bilinear");
        assert!(close(red(&t, &s, 0.6, 0.25, 0.4), 40.0), "minified a little: nearest of level 0");
        assert!(close(red(&t, &s, 0.6, 0.25, 0.6), 60.0), "level 1 is nearer");
        assert!(
            close(red(&t, &Sampler { mip: MipFilter::None, ..s }, 0.6, 0.25, 5.0), 40.0),
            "no mipmaps"
        );
    }

    #[test]
    fn any_coordinate_gives_a_finite_colour() {
        let t = reds(3, 2, &[1, 2, 3, 4, 5, 6]);
        let single = reds(1, 1, &[7]);
        let odd = [
            0.0,
            1.0,
            -1e-9,
            1e9,
            -3e38,
            f32::MAX,
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::MIN_POSITIVE,
        ];
        for wrap in [Wrap::Repeat, Wrap::MirroredRepeat, Wrap::ClampToEdge] {
            for filter in [Filter::Nearest, Filter::Linear] {
                let s = Sampler {
                    wrap_s: wrap,
                    wrap_t: wrap,
                    magnify: filter,
                    minify: filter,
                    mip: MipFilter::Linear,
                };
                for (u, v, lod) in odd.iter().flat_map(|&u| odd.iter().map(move |&v| (u, v, u))) {
                    let r = red(&t, &s, u, v, lod);
                    assert!((0.999..6.001).contains(&r), "{s:?} ({u}, {v}), lod {lod}: {r}");
                    assert!(close(red(&single, &s, u, v, lod), 7.0));
                }
            }
        }
        let empty = Texture { name: String::new(), levels: Vec::new(), encoding: Encoding::Linear };
        assert_eq!(empty.sample(&NEAREST, 0.5, 0.5, 0.0, &[0.0; 256]), [1.0; 4]);
        let hollow = Texture { levels: vec![Plane::default()], ..empty };
        assert_eq!(
            hollow.sample(
                &linear(Wrap::Repeat),
                0.5,
                0.5,
                0.0,
                &decode_table(Encoding::Linear, false)
            ),
            [1.0; 4]
        );
    }

    #[test]
    fn decoding_is_linear_light_or_raw() {
        assert!(close(decode_table(Encoding::Srgb, false)[188], 0.502_886));
        assert_eq!(decode_table(Encoding::Srgb, true)[51], 0.2);
        assert_eq!(decode_table(Encoding::Linear, false)[255], 1.0);
        let t = Texture::new(String::new(), Plane::filled(1, 1, [188, 0, 255, 51]), Encoding::Srgb);
        let [r, g, b, a] = t.sample(&NEAREST, 0.5, 0.5, 0.0, &decode_table(t.encoding, false));
        assert!(close(r, 0.502_886) && (g, b, a) == (0.0, 1.0, 0.2));
    }
}
