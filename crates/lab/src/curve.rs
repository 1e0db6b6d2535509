//! Curves of illumination: `cosⁿ` and attenuation.
//!
//! Source: the course, notes V: Phong's exponent, attenuation `1 / (c1 + c2 d + c3 d²)`, at most 1.

use crate::answer::Answer;
use crate::request::Curve;
use serde_json::json;
use std::fmt::Write;
use vitral::Error;
use vitral::internals::math::func;

/// Points of a curve.
const POINTS: u32 = 181;
/// Distance up to which attenuation is shown.
const FARTHEST: f64 = 10.0;

/// The points of a curve, and its drawing of 180 by 100 units.
pub(crate) fn curve(what: Curve, ns: Option<f64>, c: Option<[f64; 3]>) -> Answer {
    let at = |i: u32| f64::from(i) / f64::from(POINTS - 1);
    let points: Vec<[f64; 2]> = match what {
        Curve::CosN => {
            let ns = ns.filter(|n| n.is_finite() && *n >= 0.0);
            let ns =
                ns.ok_or_else(|| Error::usage("the exponent `ns` is a number of at least 0", ""))?;
            let point = |i: u32| {
                let degrees = at(i) * 180.0 - 90.0;
                [degrees, func::pow(func::cos(degrees.to_radians()).max(0.0), ns)]
            };
            (0..POINTS).map(point).collect()
        }
        Curve::Attenuation => {
            let c = c.filter(|c| c.iter().all(|c| c.is_finite() && *c >= 0.0));
            let [c1, c2, c3] =
                c.ok_or_else(|| Error::usage("`c` are three numbers of at least 0", ""))?;
            let point = |i: u32| {
                let d = at(i) * FARTHEST;
                [d, (1.0 / (c1 + c2 * d + c3 * d * d)).min(1.0)]
            };
            (0..POINTS).map(point).collect()
        }
    };

    // Draw it.
    let ([first, last], mut path) = ([points[0][0], points[points.len() - 1][0]], String::new());
    for (i, [x, y]) in points.iter().enumerate() {
        let (x, y) = ((x - first) / (last - first) * 180.0, (1.0 - y) * 100.0);
        // Writing to a String cannot fail.
        let _ = write!(path, "{}{x:.2} {y:.2}", if i == 0 { 'M' } else { 'L' });
    }
    let svg = format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="-2 -4 184 108"><path class="axes" d="M0 0V100H180"/><path class="curve" d="{path}"/></svg>"#
    );
    Ok((json!({"points": points, "svg": svg}), Vec::new()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(answer: Answer) -> Vec<[f64; 2]> {
        serde_json::from_value(answer.unwrap().0["points"].clone()).unwrap()
    }

    #[test]
    fn p37_the_half_width_of_a_lobe_is_acos_of_the_root_of_a_half() {
        for ns in [1.0, 5.0, 50.0] {
            let points = points(curve(Curve::CosN, Some(ns), None));
            assert_eq!(points[90], [0.0, 1.0]);
            let half = func::acos(func::pow(0.5, 1.0 / ns)).to_degrees();
            for [degrees, value] in points {
                assert_eq!(value >= 0.5, degrees.abs() <= half, "{ns} {degrees}");
            }
        }
        assert!(
            curve(Curve::CosN, Some(-1.0), None).is_err()
                && curve(Curve::CosN, None, None).is_err()
        );
    }

    #[test]
    fn p40_attenuation_is_clamped_and_falls() {
        let points = points(curve(Curve::Attenuation, None, Some([0.25, 0.0, 0.25])));
        assert_eq!(points[0], [0.0, 1.0]);
        let [d, value] = points[180];
        assert!((value - 1.0 / (0.25 + 0.25 * d * d)).abs() < 1e-12);
        assert!(points.windows(2).all(|pair| pair[1][1] <= pair[0][1]));
    }
}
