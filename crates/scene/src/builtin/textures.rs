//! Textures by formulas: chequered marble, checks, wood, a lattice with round holes.
//!
//! Idea: marble and wood are stripes that turbulence bends; turbulence is noise at several scales,
//! the finer the weaker; noise is a random number at each corner of a grid, smoothly interpolated.
//! All repeat without a seam.
//!
//! Source: \[Perlin 1985\]; the noise is the simpler one of values instead of gradients.

use std::f64::consts::PI;
use vitral_frame::{Encoding, Plane, Texture};
use vitral_math::func;

/// Texels along a side.
const SIDE: u32 = 256;

/// A texture whose texel at `(u, v)`, each `0..1`, is `texel(u, v)`: sRGB and alpha.
fn texture(name: &str, side: u32, texel: impl Fn(f64, f64) -> [u8; 4]) -> Texture {
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(side);
    let texels = (0..side * side).map(|i| texel(at(i % side), at(i / side))).collect();
    let image =
        Plane::from_rows(side, side, texels).unwrap_or_else(|| Plane::filled(1, 1, [255; 4]));
    Texture::new(name.to_owned(), image, Encoding::Srgb)
}

/// A number from 0 to 1 for a corner of the grid, which looks like chance.
fn random(x: u32, y: u32) -> f64 {
    let mut h = x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77);
    h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
    h = (h ^ (h >> 12)).wrapping_mul(0x297a_2d39);
    f64::from(h ^ (h >> 15)) / f64::from(u32::MAX)
}

/// Smooth noise from 0 to 1 with `periods` cells in `0..1` of x and of y.
fn noise([x, y]: [f64; 2], periods: [u32; 2]) -> f64 {
    let cell = |t: f64, period: u32| {
        let t = t.rem_euclid(1.0) * f64::from(period);
        let (low, part) = (t.floor(), t - t.floor());
        (low as u32 % period, (low as u32 + 1) % period, part * part * (3.0 - 2.0 * part))
    };
    let ((x0, x1, s), (y0, y1, t)) = (cell(x, periods[0]), cell(y, periods[1]));
    let row = |y| random(x0, y) * (1.0 - s) + random(x1, y) * s;
    row(y0) * (1.0 - t) + row(y1) * t
}

/// Noise at four scales, from 0 to 1.
fn turbulence(at: [f64; 2], periods: [u32; 2]) -> f64 {
    let octave = |k: u32| noise(at, periods.map(|p| p << k)) / f64::from(1u32 << k);
    (0..4).map(octave).sum::<f64>() * (8.0 / 15.0)
}

/// From colour `a` to colour `b`, sRGB.
fn mix(a: [f64; 3], b: [f64; 3], t: f64) -> [u8; 4] {
    let [r, g, b] = [0, 1, 2].map(|k| (a[k] + (b[k] - a[k]) * t.clamp(0.0, 1.0)).round() as u8);
    [r, g, b, 255]
}

/// Four by four tiles of light and dark marble, with joints.
pub(super) fn marble_tiles() -> Texture {
    texture("marble tiles", SIDE, |u, v| {
        let tile = [u, v].map(|t| (t * 4.0).floor());
        let within = [u * 4.0 - tile[0], v * 4.0 - tile[1]];
        if within.iter().any(|t| !(0.012..0.988).contains(t)) {
            return [120, 115, 108, 255];
        }
        let is_dark = (tile[0] + tile[1]) % 2.0 == 0.0;
        // The veins of each tile run as they were cut: those of neighbours neither meet nor agree.
        let turn = random(tile[0] as u32, tile[1] as u32 + 17);
        let at = [u + 0.37 * turn, v + 0.71 * turn];
        let along = if turn < 0.5 { u - v } else { u + v };
        let vein = func::sin(PI * (4.0 * along + 5.0 * turbulence(at, [4, 4]))).abs();
        let vein = 1.0 - func::pow(vein, 0.35);
        if is_dark {
            mix([104.0, 110.0, 116.0], [150.0, 152.0, 152.0], vein)
        } else {
            mix([222.0, 215.0, 202.0], [172.0, 162.0, 150.0], vein)
        }
    })
}

/// Two by two cells, black and white.
pub(super) fn checks() -> Texture {
    texture("checks", 64, |u, v| {
        if (u < 0.5) == (v < 0.5) { [235, 235, 230, 255] } else { [40, 44, 52, 255] }
    })
}

/// Boards of wood with the grain along u.
pub(super) fn wood() -> Texture {
    texture("wood", SIDE, |u, v| {
        let ring = 7.0 * v + 2.2 * turbulence([u, v], [1, 4]);
        let late = func::pow(ring - ring.floor(), 2.5);
        let fibre = noise([u, v], [8, 128]);
        mix([196.0, 142.0, 84.0], [112.0, 66.0, 32.0], 0.75 * late + 0.3 * fibre - 0.08)
    })
}

/// One mesh of a lattice: a round hole.
pub(super) fn lattice() -> Texture {
    texture("lattice", 64, |u, v| {
        let (x, y) = (u - 0.5, v - 0.5);
        let alpha = if x * x + y * y < 0.39 * 0.39 { 0 } else { 255 };
        [78, 60, 48, alpha]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turbulence_fills_its_range_and_repeats_without_a_seam() {
        let places = || (0..1000).map(|i| f64::from(i) / 1000.0);
        let at = |x: f64, y: f64| turbulence([x, y], [3, 4]);
        for t in places() {
            for (here, there) in
                [(at(1e-9, t), at(1.0 - 1e-9, t)), (at(t, 1e-9), at(t, 1.0 - 1e-9))]
            {
                assert!((here - there).abs() < 1e-6, "{t}: {here} {there}");
            }
        }
        let all: Vec<f64> = places().map(|t| at(t, (t * 37.0).fract())).collect();
        assert!(all.iter().all(|t| (0.0..=1.0).contains(t)));
        assert!(all.iter().any(|t| *t < 0.3) && all.iter().any(|t| *t > 0.7));
    }

    #[test]
    fn the_lattice_has_a_hole_of_half_its_size() {
        let image = &lattice().levels[0];
        let holes = image.data().iter().filter(|p| p[3] == 0).count() as f64;
        assert!((holes / 4096.0 - PI * 0.39 * 0.39).abs() < 0.01);
    }
}
