//! Wrapping, filtering, levels, formats: small numbers worked out by hand.

use super::*;

#[test]
fn bilinear_between_four_texels() {
    let t = flat(2, 2, reds(&[0, 100, 40, 200]), linear(Wrap::ClampToEdge));
    for (s, v, expected) in [
        (0.25, 0.25, 0.0),
        (0.75, 0.25, 100.0),
        (0.25, 0.75, 40.0),
        (0.75, 0.75, 200.0),
        (0.5, 0.25, 50.0),
        (0.25, 0.5, 20.0),
        (0.5, 0.5, 85.0),
        (0.375, 0.25, 25.0),
    ] {
        assert!(close(red(&t, s, v), expected), "({s}, {v})");
    }
    assert_eq!(
        at(&t, [1.0, 0.5, 0.0, 2.0], 0.0),
        at(&t, [0.5, 0.25, 0.0, 1.0], 0.0),
        "divided by q"
    );
}

#[test]
fn wrapping_by_the_truth_table() {
    // Texels 10, 20, 30 of a third each, looked up at texel centres from -1 to 2. Border 90.
    let border = [90.0 / 255.0, 0.0, 0.0, 0.0];
    let centres = |wrap| -> Vec<f32> {
        let t = flat(3, 1, reds(&[10, 20, 30]), Sampler { wrap: [wrap; 3], border, ..NEAREST });
        (-3..6).map(|i| red(&t, (i as f32 + 0.5) / 3.0, 0.5).round()).collect()
    };
    assert_eq!(centres(Wrap::Repeat), [10., 20., 30., 10., 20., 30., 10., 20., 30.]);
    assert_eq!(centres(Wrap::MirroredRepeat), [30., 20., 10., 10., 20., 30., 30., 20., 10.]);
    assert_eq!(centres(Wrap::ClampToEdge), [10., 10., 10., 10., 20., 30., 30., 30., 30.]);
    assert_eq!(centres(Wrap::Clamp), [10., 10., 10., 10., 20., 30., 30., 30., 30.]);
    assert_eq!(centres(Wrap::ClampToBorder), [90., 90., 90., 10., 20., 30., 90., 90., 90.]);

    // At the very edge a linear filter mixes half of what the wrap mode puts beyond it.
    for (wrap, low, high, far) in [
        (Wrap::Repeat, 20.0, 20.0, 20.0),
        (Wrap::MirroredRepeat, 10.0, 30.0, 10.0),
        (Wrap::ClampToEdge, 10.0, 30.0, 30.0),
        (Wrap::Clamp, 50.0, 60.0, 60.0),
        (Wrap::ClampToBorder, 50.0, 60.0, 90.0),
    ] {
        let s = Sampler { wrap: [wrap, Wrap::ClampToEdge, wrap], border, ..linear(wrap) };
        let t = flat(3, 1, reds(&[10, 20, 30]), s);
        assert!(close(red(&t, 0.0, 0.5), low), "{wrap:?} at 0: {}", red(&t, 0.0, 0.5));
        assert!(close(red(&t, 1.0, 0.5), high), "{wrap:?} at 1");
        assert!(close(red(&t, 2.0, 0.5), far), "{wrap:?} at 2: {}", red(&t, 2.0, 0.5));
    }
}

#[test]
fn border_texels_replace_the_border_colour() {
    // Two texels 100, 200 with border texels 0 and 60 in one dimension.
    for (wrap, low, high) in [(Wrap::Clamp, 50.0, 130.0), (Wrap::ClampToEdge, 100.0, 200.0)] {
        let image = level([4, 1, 1], 1, reds(&[0, 100, 200, 60]));
        let s = Sampler { border: [1.0; 4], ..linear(wrap) };
        let t = texture(TextureKind::One, vec![vec![image]], s);
        assert!(close(red(&t, 0.0, 0.0), low) && close(red(&t, 1.0, 0.0), high), "{wrap:?}");
        assert!(close(red(&t, 0.5, 9.0), 150.0), "t does not count");
    }
    let image = level([4, 1, 1], 1, reds(&[0, 100, 200, 60]));
    let t = texture(
        TextureKind::One,
        vec![vec![image]],
        Sampler { border: [1.0; 4], ..linear(Wrap::ClampToBorder) },
    );
    assert!(
        close(red(&t, -9.0, 0.0), 0.0),
        "the border's own texel, as far as the coordinate is clamped"
    );
}

#[test]
fn rectangles_count_in_texels() {
    let image = level([3, 2, 1], 0, reds(&[10, 20, 30, 40, 50, 60]));
    let t = |sampler| texture(TextureKind::Rectangle, vec![vec![image.clone()]], sampler);
    let nearest = t(Sampler { wrap: [Wrap::ClampToEdge; 3], ..NEAREST });
    assert_eq!([0.1, 1.9, 2.5, 9.0].map(|s| red(&nearest, s, 1.5).round()), [40., 50., 60., 60.]);
    let filtered = t(linear(Wrap::ClampToEdge));
    assert!(close(red(&filtered, 1.0, 0.5), 15.0) && close(red(&filtered, 1.5, 1.0), 35.0));
}

#[test]
fn three_dimensions_mix_eight_texels() {
    let image = level([2, 2, 2], 0, reds(&[0, 8, 16, 24, 80, 88, 96, 104]));
    let t = texture(TextureKind::Three, vec![vec![image]], linear(Wrap::ClampToEdge));
    let value = |s, t_, r| at(&t, [s, t_, r, 1.0], 0.0)[0] * 255.0;
    assert!(close(value(0.5, 0.5, 0.5), 52.0), "the mean");
    assert!(close(value(0.25, 0.25, 0.375), 20.0) && close(value(0.75, 0.5, 0.75), 96.0));
}

#[test]
fn srgb_is_decoded_before_filtering_and_alpha_is_not() {
    let texels = Texels::Srgb8(vec![0xff00_0000, 0x33ff_ffff]);
    let t = flat(2, 1, texels.clone(), linear(Wrap::ClampToEdge));
    let [r, g, b, a] = at(&t, [0.5, 0.5, 0.0, 1.0], 0.0);
    assert!(close(r, 0.5) && close(g, 0.5) && close(b, 0.5) && close(a, 0.6));
    let grey = flat(1, 1, Texels::Srgb8(vec![0xffbc_bcbc]), NEAREST);
    assert!(close(red(&grey, 0.5, 0.5) / 255.0, 0.502_886));
    // The general path decodes alike.
    let bordered = flat(2, 1, texels, linear(Wrap::Clamp));
    assert!(close(red(&bordered, 0.5, 0.5) / 255.0, 0.5));
}

#[test]
fn floats_are_not_clamped() {
    let t = flat(
        2,
        1,
        Texels::RgbaF32(vec![[-2.0, 1e9, 0.5, 3.0], [4.0, 1e9, 0.5, 5.0]]),
        linear(Wrap::ClampToEdge),
    );
    assert_eq!(at(&t, [0.5, 0.5, 0.0, 1.0], 0.0), [1.0, 1e9, 0.5, 4.0]);
}

/// Levels 8x8, 4x4, 2x2, 1x1 whose red is the level's number.
fn pyramid(sampler: Sampler) -> Texture {
    let levels = [8, 4, 2, 1].into_iter().enumerate().map(|(n, side): (usize, u32)| {
        level(
            [side, side, 1],
            0,
            Texels::RgbaF32(vec![[n as f32, 0.0, 0.0, 1.0]; (side * side) as usize]),
        )
    });
    texture(TextureKind::Two, vec![levels.collect()], sampler)
}

#[test]
fn levels_are_chosen_as_specified() {
    let chosen = |min, lods: [f32; 8]| {
        let t = pyramid(Sampler { min, ..NEAREST });
        look(&t, [[0.3, 0.4, 0.0, 1.0]; 8], lods, 0xff).map(|c| c[0])
    };
    let lods = [-5.0, 0.5, 0.500_1, 1.5, 1.500_1, 2.25, 3.4, 99.0];
    for min in [Filter::NearestMipmapNearest, Filter::LinearMipmapNearest] {
        assert_eq!(chosen(min, lods), [0., 0., 1., 1., 2., 2., 3., 3.], "{min:?}");
    }
    for min in [Filter::NearestMipmapLinear, Filter::LinearMipmapLinear] {
        let expected = [0.0, 0.5, 0.500_1, 1.5, 1.500_1, 2.25, 3.0, 3.0];
        let out = chosen(min, lods);
        assert!((0..8).all(|i| close(out[i], expected[i])), "{min:?}: {out:?}");
    }
    assert_eq!(chosen(Filter::Linear, lods), [0.0; 8]);
    assert_eq!(chosen(Filter::NearestMipmapNearest, [f32::NAN; 8]), [0.0; 8]);
}

#[test]
fn magnification_ends_at_a_half_for_a_linear_filter_over_nearest_levels() {
    let chosen = |mag, min| {
        let t = pyramid(Sampler { mag, min, ..NEAREST });
        [0.3, 0.5, 0.75].map(|lod| at(&t, [0.3, 0.4, 0.0, 1.0], lod)[0])
    };
    let same = |a: [f32; 3], b: [f32; 3]| (0..3).all(|i| close(a[i], b[i]));
    assert!(same(chosen(Filter::Linear, Filter::NearestMipmapLinear), [0.0, 0.0, 0.75]));
    assert!(same(chosen(Filter::Nearest, Filter::NearestMipmapLinear), [0.3, 0.5, 0.75]));
    assert!(same(chosen(Filter::Linear, Filter::LinearMipmapLinear), [0.3, 0.5, 0.75]));
    // Which filter it is that reads level 0.
    let two = |mag, min, lod| {
        let t = flat(
            2,
            1,
            reds(&[0, 200]),
            Sampler { mag, min, wrap: [Wrap::ClampToEdge; 3], ..NEAREST },
        );
        (at(&t, [0.4, 0.5, 0.0, 1.0], lod)[0] * 255.0).round()
    };
    assert_eq!(two(Filter::Linear, Filter::Nearest, 0.0), 60.0);
    assert_eq!(two(Filter::Linear, Filter::Nearest, 0.1), 0.0);
    assert_eq!(two(Filter::Nearest, Filter::Linear, 0.0), 0.0);
    assert_eq!(two(Filter::Nearest, Filter::Linear, 0.1), 60.0);
    assert_eq!(two(Filter::Linear, Filter::NearestMipmapNearest, 0.4), 60.0);
}

#[test]
fn the_level_of_detail_is_clamped() {
    let t = pyramid(Sampler { min: Filter::LinearMipmapLinear, lod: [1.0, 2.25], ..NEAREST });
    let out =
        look(&t, [[0.5, 0.5, 0.0, 1.0]; 8], [-9.0, 0.0, 1.0, 1.5, 2.25, 2.5, 7.0, 1e30], 0xff);
    assert_eq!(out.map(|c| c[0]), [1.0, 1.0, 1.0, 1.5, 2.25, 2.25, 2.25, 2.25]);
}

#[test]
fn any_coordinate_gives_a_finite_colour() {
    let odd = [0.0, -1e-9, 1e9, -3e38, f32::MAX, f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    let kinds = [
        TextureKind::One,
        TextureKind::Two,
        TextureKind::Rectangle,
        TextureKind::Three,
        TextureKind::Cube,
    ];
    let wraps =
        [Wrap::Repeat, Wrap::MirroredRepeat, Wrap::Clamp, Wrap::ClampToEdge, Wrap::ClampToBorder];
    for kind in kinds {
        for wrap in wraps {
            for border in [0, 1] {
                let size = [4, if kind == TextureKind::One { 1 } else { 4 }, 4];
                let image = level(size, border, reds(&[7; 64]));
                let s = Sampler {
                    min: Filter::LinearMipmapLinear,
                    border: [7.0 / 255.0; 4],
                    ..linear(wrap)
                };
                let t = texture(kind, vec![vec![image]; 6], s);
                for x in odd {
                    for y in odd {
                        for c in look(&t, odd.map(|z| [x, y, z, x]), odd, 0xff) {
                            assert!(
                                close(c[0] * 255.0, 7.0),
                                "{kind:?} {wrap:?} ({x}, {y}): {c:?}"
                            );
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn what_is_missing_reads_as_nothing() {
    let none = texture(TextureKind::Two, vec![], NEAREST);
    assert_eq!(at(&none, [0.5, 0.5, 0.0, 1.0], 0.0), [0.0, 0.0, 0.0, 1.0]);
    let hollow = texture(TextureKind::Cube, vec![vec![]; 6], NEAREST);
    assert_eq!(at(&hollow, [0.5, 0.5, 1.0, 1.0], 3.0), [0.0, 0.0, 0.0, 1.0]);
    for kind in [
        TextureKind::One,
        TextureKind::Two,
        TextureKind::Rectangle,
        TextureKind::Three,
        TextureKind::Cube,
    ] {
        for texels in [reds(&[]), Texels::Depth(vec![]), Texels::RgbaF32(vec![])] {
            for size in [[0, 0, 0], [4, 4, 4], [16384, 16384, 2]] {
                let image = level(size, 0, texels.clone());
                let t = texture(kind, vec![vec![image]], linear(Wrap::ClampToBorder));
                assert!(at(&t, [0.3, 0.9, 1e9, 1.0], 5.0).iter().all(|c| c.is_finite()));
            }
        }
    }
}

#[test]
fn lanes_that_are_not_active_do_not_matter() {
    let t = pyramid(Sampler { min: Filter::NearestMipmapNearest, ..NEAREST });
    let out =
        look(&t, [[0.5, 0.5, 0.0, 1.0]; 8], [0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0], 0b0010_1010);
    assert_eq!([out[1][0], out[3][0], out[5][0]], [1.0, 3.0, 1.0]);
}
