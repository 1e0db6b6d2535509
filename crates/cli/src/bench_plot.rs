//! Growth drawn as SVG: both axes logarithmic, so that a power is a straight line and its exponent
//! the slope.

use std::fmt::Write;
use vitral::internals::math::func;

/// A curve.
pub(crate) struct Curve {
    /// Its name.
    pub(crate) name: String,
    /// Drawn dashed.
    pub(crate) dashed: bool,
    /// Size and seconds, all positive.
    pub(crate) points: Vec<[f64; 2]>,
}

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 460.0;
/// Left, top, right and bottom of the plot within the picture.
const FRAME: [f64; 4] = [70.0, 40.0, 560.0, 410.0];

/// Colours that are told apart by most eyes, in the order of the curves.
const COLORS: [&str; 10] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#a6761d", "#000000", "#e69f00",
    "#7570b3", "#666666",
];

/// The exponent of the power of the size that fits the points best: the slope of the regression
/// line of the logarithms.
pub(crate) fn exponent(points: &[[f64; 2]]) -> Option<f64> {
    let logs: Vec<_> = points.iter().map(|p| p.map(func::ln)).collect();
    let count = logs.len() as f64;
    let mean = [0, 1].map(|k| logs.iter().map(|p| p[k]).sum::<f64>() / count);
    let spread: f64 = logs.iter().map(|p| (p[0] - mean[0]) * (p[0] - mean[0])).sum();
    let common: f64 = logs.iter().map(|p| (p[0] - mean[0]) * (p[1] - mean[1])).sum();
    (logs.len() > 1 && spread > 0.0).then(|| common / spread)
}

/// The base-10 logarithm.
fn log10(x: f64) -> f64 {
    func::ln(x) / std::f64::consts::LN_10
}

/// A plot of seconds over sizes.
pub(crate) fn svg(title: &str, axis: &str, curves: &[Curve]) -> String {
    // Map the logarithms between whole powers of ten to the frame.
    let ends = |k: usize| {
        let values = curves.iter().flat_map(|c| &c.points).map(|p| log10(p[k]));
        let (low, high) =
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        if low <= high { (low.floor(), high.ceil().max(low.floor() + 1.0)) } else { (0.0, 1.0) }
    };
    let (x_ends, y_ends) = (ends(0), ends(1));
    let [left, top, right, bottom] = FRAME;
    let x = |log: f64| left + (log - x_ends.0) / (x_ends.1 - x_ends.0) * (right - left);
    let y = |log: f64| bottom - (log - y_ends.0) / (y_ends.1 - y_ends.0) * (bottom - top);

    // Open the picture. Writing to a String cannot fail.
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"white\"/>\n\
         <text x=\"{left}\" y=\"24\" font-size=\"15\">{title}</text>\n"
    );

    // Draw a line of the grid and a label for each power of ten.
    let line = |out: &mut String, [x0, y0, x1, y1]: [f64; 4]| {
        let _ = writeln!(out, "<path d=\"M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}\" stroke=\"#ddd\"/>");
    };
    for power in x_ends.0 as i32..=x_ends.1 as i32 {
        let at = x(f64::from(power));
        line(&mut out, [at, top, at, bottom]);
        let _ = writeln!(
            out,
            "<text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">1e{power}</text>",
            bottom + 16.0
        );
    }
    for power in y_ends.0 as i32..=y_ends.1 as i32 {
        let at = y(f64::from(power));
        line(&mut out, [left, at, right, at]);
        let _ = writeln!(
            out,
            "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">1e{power}</text>",
            left - 6.0,
            at + 4.0
        );
    }

    // Name the axes.
    let middle = (left + right) / 2.0;
    let _ = writeln!(
        out,
        "<text x=\"{middle}\" y=\"{}\" text-anchor=\"middle\">{axis}</text>",
        bottom + 36.0
    );
    let _ = writeln!(out, "<text x=\"8\" y=\"{}\">seconds</text>", top - 4.0);

    // Draw each curve, its points and its entry in the key.
    for (i, curve) in curves.iter().enumerate() {
        let (color, dash) =
            (COLORS[i % COLORS.len()], if curve.dashed { " stroke-dasharray=\"6 4\"" } else { "" });
        let place = |p: &[f64; 2]| format!("{:.1},{:.1}", x(log10(p[0])), y(log10(p[1])));
        let points: Vec<_> = curve.points.iter().map(place).collect();
        let line = format!("fill=\"none\" stroke=\"{color}\" stroke-width=\"2\"{dash}");
        let _ = writeln!(out, "<polyline points=\"{}\" {line}/>", points.join(" "));
        for p in &curve.points {
            let (cx, cy) = (x(log10(p[0])), y(log10(p[1])));
            let _ =
                writeln!(out, "<circle cx=\"{cx:.1}\" cy=\"{cy:.1}\" r=\"3\" fill=\"{color}\"/>");
        }
        let (key, at) = (right + 16.0, top + 10.0 + 20.0 * i as f64);
        let _ = writeln!(out, "<path d=\"M{key} {}h26\" {line}/>", at - 4.0);
        let _ = writeln!(out, "<text x=\"{}\" y=\"{at}\">{}</text>", key + 34.0, curve.name);
    }
    out.push_str("</svg>\n");
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponent_of_a_power_is_found() {
        let square: Vec<_> = [1.0, 2.0, 4.0, 8.0].map(|n: f64| [n, 3.0 * n * n]).to_vec();
        assert!((exponent(&square).unwrap() - 2.0).abs() < 1e-12);
        assert_eq!([exponent(&[]), exponent(&[[1.0, 1.0]])], [None, None]);
    }

    #[test]
    fn every_curve_is_drawn_within_the_frame() {
        let curve = |dashed| Curve {
            name: "c".to_owned(),
            dashed,
            points: vec![[10.0, 0.1], [1000.0, 10.0]],
        };
        let picture = svg("t", "n", &[curve(false), curve(true)]);
        assert_eq!(
            (picture.matches("<polyline").count(), picture.matches("<circle").count()),
            (2, 4)
        );
        assert!(
            picture.contains("points=\"70.0,410.0 560.0,40.0\"")
                && picture.matches("dasharray").count() == 2
        );
    }
}
