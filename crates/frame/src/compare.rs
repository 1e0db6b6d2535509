//! How far two pictures are apart, as numbers and as a picture.
//!
//! Golden tests and the command `vitral compare` share this: a pixel differs when any of its four
//! channels is further apart than a threshold. The peak signal-to-noise ratio looks at red, green
//! and blue only, since an alpha plane that is opaque on both sides would flatter it.
//!
//! In: two planes of RGBA of one size, of 8 or 16 bits a channel, the top row first.
//! Out: a [`Difference`], and [`picture`], which shows where it lies.
//! Cost: one pass over the pixels.

use crate::Plane;
use vitral_math::func;

/// Two planes that cannot be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the first picture is {}x{} pixels, the second {}x{}", .first[0], .first[1], .second[0], .second[1])]
pub struct SizeMismatch {
    /// Width and height of the first plane.
    pub first: [u32; 2],
    /// Width and height of the second plane.
    pub second: [u32; 2],
}

/// A rectangle of pixels; both corners belong to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bounds {
    /// Leftmost column and topmost row.
    pub min: [u32; 2],
    /// Rightmost column and lowest row.
    pub max: [u32; 2],
}

/// A channel of a pixel: 8 or 16 bits.
pub trait Component: Copy + Default + Ord + Into<u64> + std::fmt::Display {
    /// The largest value.
    const LARGEST: Self;

    /// How far two are apart.
    #[must_use]
    fn difference(self, other: Self) -> Self;
}

impl Component for u8 {
    const LARGEST: Self = Self::MAX;

    fn difference(self, other: Self) -> Self {
        self.abs_diff(other)
    }
}

impl Component for u16 {
    const LARGEST: Self = Self::MAX;

    fn difference(self, other: Self) -> Self {
        self.abs_diff(other)
    }
}

/// What [`compare`] found.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference<T = u8> {
    /// Pixels in each plane.
    pub pixels: u64,
    /// Pixels with a channel further apart than the threshold.
    pub over: u64,
    /// Largest distance in each channel, whatever the threshold.
    pub max: [T; 4],
    /// Peak signal-to-noise ratio over red, green and blue, in decibels; infinite when they are
    /// equal.
    pub psnr: f64,
    /// The topmost, then leftmost pixel over the threshold: column, row.
    pub first: Option<[u32; 2]>,
    /// The smallest rectangle that holds all pixels over the threshold.
    pub bounds: Option<Bounds>,
}

impl<T: Component> Difference<T> {
    /// The share of pixels over the threshold, `0..=1`; 0 for a picture without pixels.
    pub fn share(&self) -> f64 {
        if self.pixels == 0 { 0.0 } else { self.over as f64 / self.pixels as f64 }
    }

    /// The largest distance in any channel.
    pub fn max_any(&self) -> T {
        self.max.into_iter().max().unwrap_or_default()
    }
}

impl<T: Component> std::fmt::Display for Difference<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { pixels, over, max: [r, g, b, a], psnr, .. } = self;
        write!(
            f,
            "{over} of {pixels} pixels over the threshold, largest distance {r} {g} {b} {a} (RGBA), {psnr:.2} dB"
        )?;
        if let (Some([x, y]), Some(bounds)) = (self.first, self.bounds) {
            let ([x0, y0], [x1, y1]) = (bounds.min, bounds.max);
            write!(f, ", first at ({x}, {y}), all within ({x0}, {y0}) to ({x1}, {y1})")?;
        }
        Ok(())
    }
}

/// Compares two pictures; a pixel counts as different when a channel is more than `threshold`
/// apart.
///
/// # Errors
/// If the sizes differ.
pub fn compare<T: Component>(
    a: &Plane<[T; 4]>,
    b: &Plane<[T; 4]>,
    threshold: T,
) -> Result<Difference<T>, SizeMismatch> {
    check_sizes(a, b)?;
    let mut found = Difference {
        pixels: a.data().len() as u64,
        over: 0,
        max: [T::default(); 4],
        psnr: f64::INFINITY,
        first: None,
        bounds: None,
    };
    let mut squares = 0u64;

    // Walk both pictures row by row; the first difference met is the topmost, then leftmost one.
    for y in 0..a.height() {
        for (x, (p, q)) in (0..).zip(a.row(y).iter().zip(b.row(y))) {
            if p == q {
                continue;
            }
            let apart: [T; 4] = std::array::from_fn(|c| p[c].difference(q[c]));
            squares += apart[..3].iter().map(|&d| d.into().pow(2)).sum::<u64>();
            for (max, d) in found.max.iter_mut().zip(apart) {
                *max = (*max).max(d);
            }
            if apart.iter().any(|&d| d > threshold) {
                found.over += 1;
                found.first.get_or_insert([x, y]);
                found.bounds = Some(grow(found.bounds, [x, y]));
            }
        }
    }

    // Turn the mean square into decibels below the peak value.
    if squares > 0 {
        let mean = squares as f64 / (3.0 * found.pixels as f64);
        let peak = T::LARGEST.into() as f64;
        found.psnr = 10.0 * func::ln(peak * peak / mean) / std::f64::consts::LN_10;
    }
    Ok(found)
}

/// A picture of the difference: `a` faded to grey, and over it each differing pixel in red, the
/// brighter the further apart it is. Any difference at all is visible: the red starts at half
/// brightness.
///
/// # Errors
/// If the sizes differ.
pub fn picture<T: Component>(
    a: &Plane<[T; 4]>,
    b: &Plane<[T; 4]>,
) -> Result<Plane<[u8; 4]>, SizeMismatch> {
    check_sizes(a, b)?;
    let byte = |value: T| value.into() * 255 / T::LARGEST.into();
    let shown = a.data().iter().zip(b.data()).map(|(p, q)| {
        let apart = (0..4).map(|c| p[c].difference(q[c])).max().unwrap_or_default();
        let grey = (byte(p[0]) + 2 * byte(p[1]) + byte(p[2])) / 4;
        let faded = (160 + grey / 4) as u8;
        if apart == T::default() {
            [faded, faded, faded, 255]
        } else {
            [(128 + byte(apart) / 2) as u8, 0, 0, 255]
        }
    });
    Ok(Plane::from_rows(a.width(), a.height(), shown.collect()).unwrap_or_default())
}

fn check_sizes<T>(a: &Plane<[T; 4]>, b: &Plane<[T; 4]>) -> Result<(), SizeMismatch> {
    let (first, second) = ([a.width(), a.height()], [b.width(), b.height()]);
    if first == second { Ok(()) } else { Err(SizeMismatch { first, second }) }
}

/// The smallest rectangle that holds `bounds` and `pixel`.
fn grow(bounds: Option<Bounds>, pixel: [u32; 2]) -> Bounds {
    let old = bounds.unwrap_or(Bounds { min: pixel, max: pixel });
    Bounds {
        min: std::array::from_fn(|i| old.min[i].min(pixel[i])),
        max: std::array::from_fn(|i| old.max[i].max(pixel[i])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn black(width: u32, height: u32) -> Plane<[u8; 4]> {
        Plane::filled(width, height, [0, 0, 0, 255])
    }

    #[test]
    fn equal_pictures_are_infinitely_close() {
        let found = compare(&black(3, 2), &black(3, 2), 0).unwrap();
        assert_eq!(
            (found.pixels, found.over, found.max, found.first, found.bounds),
            (6, 0, [0; 4], None, None)
        );
        assert!(found.psnr.is_infinite() && found.share() == 0.0);
    }

    #[test]
    fn differences_are_counted_and_placed() {
        let (a, mut b) = (black(4, 3), black(4, 3));
        b.data_mut()[4 + 2] = [9, 0, 0, 255];
        b.data_mut()[8 + 1] = [0, 3, 0, 250];
        let found = compare(&a, &b, 0).unwrap();
        assert_eq!((found.over, found.max, found.max_any()), (2, [9, 3, 0, 5], 9));
        assert_eq!(
            (found.first, found.bounds),
            (Some([2, 1]), Some(Bounds { min: [1, 1], max: [2, 2] }))
        );
        let found = compare(&a, &b, 5).unwrap();
        assert_eq!((found.over, found.first, found.max), (1, Some([2, 1]), [9, 3, 0, 5]));
    }

    #[test]
    fn psnr_has_its_textbook_values() {
        let white = Plane::filled(2, 2, [255, 255, 255, 255]);
        assert_eq!(compare(&black(2, 2), &white, 0).unwrap().psnr, 0.0, "as far apart as can be");
        let one_off = Plane::filled(2, 2, [1, 1, 1, 255]);
        let psnr = compare(&black(2, 2), &one_off, 0).unwrap().psnr;
        assert!((psnr - 48.130_803_6).abs() < 1e-6, "20 log10(255), was {psnr}");
    }

    #[test]
    fn sixteen_bits_are_told_apart() {
        let grey = |v: u16| Plane::filled(2, 2, [v, v, v, u16::MAX]);
        let found = compare(&grey(30_000), &grey(30_101), 100).unwrap();
        assert_eq!((found.over, found.max), (4, [101, 101, 101, 0]));
        assert_eq!(compare(&grey(30_000), &grey(30_101), 101).unwrap().over, 0);
        assert_eq!(compare(&grey(0), &grey(u16::MAX), 0).unwrap().psnr, 0.0);
        assert_eq!(picture(&grey(30_000), &grey(30_001)).unwrap().data(), [[128, 0, 0, 255]; 4]);
    }

    #[test]
    fn sizes_must_agree_and_may_be_zero() {
        let error = compare(&black(2, 1), &black(1, 2), 0).unwrap_err();
        assert_eq!(error.to_string(), "the first picture is 2x1 pixels, the second 1x2");
        assert_eq!(compare(&black(0, 0), &black(0, 0), 0).unwrap().share(), 0.0);
    }

    #[test]
    fn the_picture_shows_the_smallest_difference() {
        let (a, mut b) = (black(2, 1), black(2, 1));
        b.data_mut()[1] = [1, 0, 0, 255];
        assert_eq!(picture(&a, &b).unwrap().data(), &[[160, 160, 160, 255], [128, 0, 0, 255]]);
    }
}
