//! Look-ups by hand; the scalar reference is in [`reference`].

mod by_hand;
mod cube_maps;
mod reference;
mod shadows;

use super::anisotropic::sample_anisotropic;
use super::mip::{derivatives, half_log2, lod};
use super::sample;
use crate::forward::texture::{
    BaseFormat, Filter, Level, Sampler, Texels, Texture, TextureKind, Wrap,
};
use std::sync::Arc;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, available_levels, dispatch};

const NEAREST: Sampler = Sampler {
    min: Filter::Nearest,
    mag: Filter::Nearest,
    wrap: [Wrap::Repeat; 3],
    border: [0.0; 4],
    lod: [-1000.0, 1000.0],
    anisotropy: 1.0,
    compare: None,
    seamless: false,
};

fn linear(wrap: Wrap) -> Sampler {
    Sampler { min: Filter::Linear, mag: Filter::Linear, wrap: [wrap; 3], ..NEAREST }
}

fn level(size: [u32; 3], border: u32, texels: Texels) -> Arc<Level> {
    Arc::new(Level::new(size, border, texels))
}

fn texture(kind: TextureKind, faces: Vec<Vec<Arc<Level>>>, sampler: Sampler) -> Texture {
    Texture::new(kind, BaseFormat::Rgba, faces, sampler)
}

/// Red bytes, opaque.
fn reds(values: &[u8]) -> Texels {
    Texels::Rgba8(values.iter().map(|&r| u32::from_le_bytes([r, 0, 0, 255])).collect())
}

/// A 2D texture of one level.
fn flat(width: u32, height: u32, texels: Texels, sampler: Sampler) -> Texture {
    texture(TextureKind::Two, vec![vec![level([width, height, 1], 0, texels)]], sampler)
}

/// Eight look-ups, the same at every instruction set.
fn look(texture: &Texture, coords: [[f32; 4]; 8], lods: [f32; 8], active: u32) -> [[f32; 4]; 8] {
    let column = |k: usize| coords.map(|c| c[k]);
    let mut results = available_levels().into_iter().map(|(name, level)| {
        let out: [[f32; 8]; 4] = dispatch!(level, simd => {
            let load = |values: [f32; 8]| F32x8::from_slice(simd, &values);
            let coords = [load(column(0)), load(column(1)), load(column(2)), load(column(3))];
            let [r, g, b, a] = sample(simd, texture, None, coords, load(lods), active);
            [r.to_array(), g.to_array(), b.to_array(), a.to_array()]
        });
        (name, out)
    });
    let (_, first) = results.next().expect("at least one level");
    for (name, other) in results {
        assert_eq!(
            first.map(|c| c.map(f32::to_bits)),
            other.map(|c| c.map(f32::to_bits)),
            "{name}"
        );
    }
    std::array::from_fn(|lane| std::array::from_fn(|k| first[k][lane]))
}

/// One look-up, in every lane.
fn at(texture: &Texture, coords: [f32; 4], lod: f32) -> [f32; 4] {
    let out = look(texture, [coords; 8], [lod; 8], 0xff);
    assert!(out.iter().all(|c| c.map(f32::to_bits) == out[0].map(f32::to_bits)));
    out[0]
}

/// Red in bytes at `(s, t)`.
fn red(texture: &Texture, s: f32, t: f32) -> f32 {
    at(texture, [s, t, 0.0, 1.0], -1.0)[0] * 255.0
}

fn close(a: f32, b: f32) -> bool {
    (a - b).abs() < 1e-3
}

#[test]
fn derivatives_are_those_of_texel_coordinates() {
    // Differences of the projected coordinates over a small step, against the quotient rule.
    let image =
        |kind, size: [u32; 3]| texture(kind, vec![vec![level(size, 0, reds(&[]))]], NEAREST);
    let (c, dx, dy) =
        ([0.7f32, -0.4, 0.9, 1.3], [0.02f32, 0.01, -0.03, 0.05], [-0.01f32, 0.04, 0.02, -0.02]);
    for (kind, size) in [
        (TextureKind::One, [16, 1, 1]),
        (TextureKind::Two, [16, 8, 1]),
        (TextureKind::Rectangle, [16, 8, 1]),
        (TextureKind::Three, [16, 8, 4]),
    ] {
        let texture = image(kind, size);
        let used = super::mip::dimensions(kind);
        for (name, simd_level) in available_levels() {
            let steps = dispatch!(simd_level, simd => {
                let load = |v: [f32; 4]| crate::forward::wide::splat_rgba(simd, v);
                let d = derivatives(simd, &texture, load(c), load(dx), load(dy));
                [[d[0][0][0], d[0][1][0], d[0][2][0]], [d[1][0][0], d[1][1][0], d[1][2][0]]]
            });
            for (step, d) in steps.iter().zip([dx, dy]) {
                for k in 0..3 {
                    let e = 1e-4f64;
                    let project = |h: f64| {
                        let value = |i: usize| f64::from(c[i]) + h * f64::from(d[i]);
                        value(k) / value(3)
                    };
                    let scale =
                        if kind == TextureKind::Rectangle { 1.0 } else { f64::from(size[k]) };
                    let expected =
                        if k < used { (project(e) - project(-e)) / (2.0 * e) * scale } else { 0.0 };
                    assert!(
                        (f64::from(step[k]) - expected).abs() < 1e-4,
                        "{name} {kind:?} {k}: {steps:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn level_of_detail_is_the_logarithm_of_the_longer_step() {
    for (_, simd_level) in available_levels() {
        let out = dispatch!(simd_level, simd => {
            let v = |x| crate::forward::wide::splat(simd, x);
            let zero = v(0.0);
            [
                lod(v(4.0), zero, zero, zero, v(2.0), zero)[0],
                lod(v(3.0), v(4.0), zero, zero, v(-4.0), zero)[0],
                lod(zero, zero, zero, zero, zero, v(0.5))[0],
                lod(zero, zero, zero, zero, zero, zero)[0],
                lod(v(f32::NAN), zero, zero, zero, v(8.0), zero)[0],
            ]
        });
        assert_eq!((out[0], out[2], out[4]), (2.0, -1.0, 3.0));
        assert!((vitral_math::func::exp2_32(out[1]) - 5.0).abs() < 1e-5);
        assert!(out[3] <= -60.0);
    }
}

#[test]
fn level_of_detail_never_falls_as_steps_grow() {
    for (name, simd_level) in available_levels() {
        let mut before = f32::NEG_INFINITY;
        // Steps of 1/8 to 64 texels.
        for k in 0..=9000 {
            let exact = f64::from(k) / 1000.0 - 3.0;
            let step = vitral_math::func::exp2_32(exact as f32);
            let level = dispatch!(simd_level, simd => half_log2(crate::forward::wide::splat(simd, step * step))[0]);
            assert!((f64::from(level) - exact).abs() < 1e-6, "{name}: {step} {level} {exact}");
            assert!(level >= before, "{name}: {step}");
            before = level;
        }
    }
}

#[test]
fn anisotropic_probes_average_along_the_long_side() {
    // Rows of 0 and 255 alternate down; columns are constant. 8 texels across and 1 up a pixel.
    let levels = |base: u8, other: u8| {
        let fine: Vec<u8> =
            (0..16 * 16).map(|i| if (i / 16) % 2 == 0 { base } else { other }).collect();
        let coarse = |n: u32| level([n, n, 1], 0, reds(&vec![128; (n * n) as usize]));
        vec![level([16, 16, 1], 0, reds(&fine)), coarse(8), coarse(4), coarse(2), coarse(1)]
    };
    let trilinear =
        Sampler { min: Filter::LinearMipmapLinear, anisotropy: 16.0, ..linear(Wrap::Repeat) };
    let t = texture(TextureKind::Two, vec![levels(0, 255)], trilinear);
    let row_centre = 2.5 / 16.0;
    let probe = |texture: &Texture, along: f32, width: f32| {
        let mut all = Vec::new();
        for (_, simd_level) in available_levels() {
            all.push(dispatch!(simd_level, simd => {
                let v = |x| crate::forward::wide::splat(simd, x);
                let steps = [[v(along), v(0.0), v(0.0)], [v(0.0), v(width), v(0.0)]];
                let coords = [v(0.3), v(row_centre), v(0.0), v(1.0)];
                sample_anisotropic(simd, (texture, None), coords, steps, v(0.0), 0xff)[0].to_array()[6]
            }));
        }
        assert!(all.iter().all(|v| v.to_bits() == all[0].to_bits()));
        all[0] * 255.0
    };
    assert!(close(probe(&t, 8.0, 1.0), 0.0), "eight probes of level 0 stay in their row");
    let isotropic = Texture { sampler: Sampler { anisotropy: 1.0, ..trilinear }, ..t.clone() };
    assert!(close(probe(&isotropic, 8.0, 1.0), 128.0), "one probe of level 3");
    let four = Texture { sampler: Sampler { anisotropy: 4.0, ..trilinear }, ..t.clone() };
    assert!(close(probe(&four, 8.0, 1.0), 128.0), "four probes of level 1");
    assert!(close(probe(&t, 0.5, 0.25), 0.0), "magnified");
    assert!(probe(&t, f32::NAN, f32::INFINITY).is_finite());
}
