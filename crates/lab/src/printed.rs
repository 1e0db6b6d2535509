//! Formulas of illumination that the notes print wrongly, beside the right ones, with the numbers
//! of a pixel.
//!
//! Source: the course, notes V: reflectance, Phong's formula, attenuation; Phong 1975 for the
//!         clamps.

use serde_json::{Value, json};
use vitral::explain::Explanation;
use vitral::internals::math::func;
use vitral::internals::render::shading::pixel_light::{CoefficientValues, Evaluation};
use vitral::{Attenuation, Light};

/// Red, green, blue.
const GREEN: usize = 1;

/// A row for each formula: what it is, both forms as MathML, both results.
pub(crate) fn printed(told: &Explanation, lights: &[Light], names: &[String]) -> Vec<Value> {
    let point = told.light.points.first();
    let Some(evaluation) = point.and_then(|point| point.evaluations.first()) else {
        return Vec::new();
    };
    let CoefficientValues::Empirical { kd, ks, shininess, .. } = evaluation.coefficients else {
        return Vec::new();
    };
    let mut rows = Vec::new();

    // A reflectance is what is reflected of what arrives.
    if kd[GREEN] > 0.0 {
        rows.push(row(
            "reflectance kd",
            "<msub><mi>k</mi><mi>d</mi></msub><mo>=</mo><mfrac><mtext>reflected</mtext><mtext>incident</mtext></mfrac>",
            "<msub><mi>k</mi><mi>d</mi></msub><mo>=</mo><mfrac><mtext>incident</mtext><mtext>reflected</mtext></mfrac>",
            [f64::from(kd[GREEN]), 1.0 / f64::from(kd[GREEN])],
        ));
    }
    for of_light in &evaluation.lights {
        let (t, name) = (&of_light.terms, &names[of_light.light]);
        let cosines = unclamped(evaluation, t.l);

        // Light from behind adds nothing.
        let colors = t.colors.map(|color| f64::from(color[GREEN]));
        let [_, light_d, light_s] = colors;
        let (kd, ks) = (f64::from(kd[GREEN]), f64::from(ks[GREEN]));
        let arrives = f64::from(t.attenuation) * f64::from(t.visibility[GREEN]);
        let without = arrives
            * (light_d * kd * cosines[0] + light_s * ks * power(cosines[1], f64::from(shininess)));
        let with = f64::from(t.diffuse[GREEN]) + f64::from(t.specular[GREEN]);
        rows.push(row(
            &format!("diffuse and specular light of {name}"),
            "<mi>max</mi><mo>(</mo><mn>0</mn><mo>,</mo><mi>N·L</mi><mo>)</mo><mo>,</mo>\
             <mi>max</mi><msup><mrow><mo>(</mo><mn>0</mn><mo>,</mo><mi>R·V</mi><mo>)</mo></mrow><mi>n</mi></msup>",
            "<mi>N·L</mi><mo>,</mo><msup><mrow><mo>(</mo><mi>R·V</mi><mo>)</mo></mrow><mi>n</mi></msup>",
            [with, without],
        ));

        // The distance is squared.
        let distance = t.distance.map(f64::from).filter(|distance| *distance > 0.0);
        let [c1, c2, c3] = match lights.get(of_light.light).map(|light| light.attenuation) {
            Some(Attenuation::InverseSquare) => [0.0, 0.0, 1.0],
            Some(Attenuation::Clamped { c1, c2, c3 }) => [c1, c2, c3].map(f64::from),
            _ => [1.0, 0.0, 0.0],
        };
        if let Some(d) = distance.filter(|_| c3 > 0.0) {
            rows.push(row(
                &format!("attenuation of {name}"),
                "<msup><mi>d</mi><mn>2</mn></msup>",
                "<mi>d</mi><mn>2</mn>",
                [f64::from(t.attenuation), (1.0 / (c1 + c2 * d + c3 * d * 2.0)).min(1.0)],
            ));
        }
    }
    rows
}

fn row(what: &str, right: &str, printed: &str, values: [f64; 2]) -> Value {
    let mathml =
        |inner: &str| format!("<math xmlns=\"http://www.w3.org/1998/Math/MathML\">{inner}</math>");
    json!({"what": what, "right": mathml(right), "printed": mathml(printed), "right-value": values[0], "printed-value": values[1]})
}

/// `N·L` and `R·V` with their signs, for a unit vector to the light.
fn unclamped(evaluation: &Evaluation, l: [f32; 3]) -> [f64; 2] {
    let [n, l, v] = [evaluation.normal, l, evaluation.viewer].map(|vector| vector.map(f64::from));
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let n_l = dot(n, l);
    let r = [0, 1, 2].map(|k| 2.0 * n[k] * n_l - l[k]);
    [n_l, dot(r, v)]
}

/// A power of a number that may be negative, with a whole exponent then.
fn power(base: f64, exponent: f64) -> f64 {
    let size = func::pow(base.abs(), exponent);
    let is_odd = exponent.round() % 2.0 != 0.0;
    if base < 0.0 && is_odd { -size } else { size }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_negative_numbers_alternate() {
        assert_eq!([power(-0.5, 2.0), power(-0.5, 3.0), power(0.5, 2.0)], [0.25, -0.125, 0.25]);
    }
}
