//! Tests of `lanes.rs`.

use super::*;

#[inline(always)]
fn formula<T: Lanes>(x: T) -> [T; 4] {
    [x.exp2(), x.abs().log2(), x.abs().pow(x.splat(7.3)), x.abs().srgb_from_linear()]
}

fn wide(level: Level, x: [f32; 8]) -> [[f32; 8]; 4] {
    dispatch!(level, simd => formula(F32x8::from_slice(simd, &x)).map(|v| v.to_array()))
}

fn wider(level: Level, x: [f32; 16]) -> [[f32; 16]; 4] {
    dispatch!(level, simd => formula(F32x16::from_slice(simd, &x)).map(|v| v.to_array()))
}

#[test]
fn one_lane_eight_and_sixteen_give_the_same_bits_at_every_level() {
    let x: [f32; 8] = [0.0, 1.0, -3.7, 0.25, 88.2, -140.0, 1e-20, 0.5];
    let more: [f32; 16] =
        std::array::from_fn(|lane| if lane < 8 { x[7 - lane] } else { x[lane - 8] });
    for (name, level) in available_levels() {
        let (w, ww) = (wide(level, x), wider(level, more));
        for lane in 0..8 {
            let one = formula(x[lane]);
            for k in 0..4 {
                assert_eq!(
                    one[k].to_bits(),
                    w[k][lane].to_bits(),
                    "{name}: function {k} of {}",
                    x[lane]
                );
                assert_eq!(
                    one[k].to_bits(),
                    ww[k][7 - lane].to_bits(),
                    "{name}: function {k} of {}",
                    x[lane]
                );
                assert_eq!(
                    one[k].to_bits(),
                    ww[k][8 + lane].to_bits(),
                    "{name}: function {k} of {}",
                    x[lane]
                );
            }
        }
    }
}

#[test]
fn doubles_are_rounded_as_numbers_are() {
    let half = f64::from(f32::EPSILON) / 2.0;
    let x = [1.0 + half, 1.0 + 3.0 * half, -0.0, 1e-42, -1e300, 3.4e38, f64::NAN, 0.1];
    for (name, level) in available_levels() {
        let (narrow, wide) = dispatch!(level, simd => {
            let narrow = narrowed(simd, F64x8::from_slice(simd, &x));
            let [_, _, z] = wide_points(simd, |lane| [0.0, 1.0, narrow.to_array()[lane]]);
            (narrow.to_array(), z.to_array())
        });
        for lane in (0..8).filter(|lane| *lane != 6) {
            assert_eq!(narrow[lane].to_bits(), (x[lane] as f32).to_bits(), "{name}: {}", x[lane]);
            assert_eq!(
                wide[lane].to_bits(),
                f64::from(x[lane] as f32).to_bits(),
                "{name}: {}",
                x[lane]
            );
        }
        assert!(narrow[6].is_nan() && wide[6].is_nan(), "{name}");
    }
}

#[test]
fn sixteen_go_by_eights_in_order() {
    let x: [f32; 16] = std::array::from_fn(|lane| lane as f32);
    for (name, level) in available_levels() {
        let (sum, eights) = dispatch!(level, simd => {
            let mut eights = Vec::new();
            let x = F32x16::from_slice(simd, &x);
            let [sum] = Floats::by_eights(simd, [x, x * 10.0], |first, [a, b]| {
                eights.push(first);
                [a + b]
            });
            (sum.to_array(), eights)
        });
        assert_eq!(sum, x.map(|x| x * 11.0), "{name}");
        assert_eq!(eights, [0, 8], "{name}");
    }
}

#[test]
fn rows_become_columns_and_rows_again() {
    let rows: [[i32; 4]; 8] =
        std::array::from_fn(|r| std::array::from_fn(|c| 10 * r as i32 + c as i32));
    for (name, level) in available_levels() {
        let mut again = [[0; 4]; 8];
        let columns = dispatch!(level, simd => {
            let columns = columns_of_rows(simd, |lane| rows[lane]);
            rows_of_columns(simd, columns, |lane, row| again[lane] = row);
            columns.map(|column| column.to_array())
        });
        assert_eq!(columns[2], [2, 12, 22, 32, 42, 52, 62, 72], "{name}");
        assert_eq!(again, rows, "{name}");
    }
}

#[test]
fn exp2_log2_and_pow_are_accurate() {
    for i in -1200..1200 {
        let x = i as f32 * 0.1;
        let exact = libm::exp2(f64::from(x));
        assert!((f64::from(Lanes::exp2(x)) / exact - 1.0).abs() < 4e-7, "2^{x}");
        let y = libm::exp2f(x);
        if (1e-37..1e37).contains(&y) {
            let exact = libm::log2(f64::from(y));
            assert!(
                (f64::from(Lanes::log2(y)) - exact).abs() < 3e-7 * exact.abs().max(1.0),
                "log2 {y}"
            );
        }
    }
    assert_eq!(Lanes::pow(0.0f32, 5.0), 0.0);
    assert_eq!(Lanes::pow(0.0f32, 0.0), 1.0);
    assert!((Lanes::pow(0.866_025_4f32, 10.0) - 0.237_304_7).abs() < 1e-6);
}
