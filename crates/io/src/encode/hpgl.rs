//! HP-GL: a drawing for pen plotters and cutters, a pen for each layer.
//!
//! The unit is that of plotters, 1/40 mm, y is upwards. `PS` and `PW`, which tell the size of the
//! sheet and widths of pens, are of HP-GL/2; older plotters skip them. Lines are ordered for a
//! plotter, and dashes are drawn one by one, since devices differ in what they make of line types.
//!
//! Source: \[HP-GL\].

use super::pens::{DrawingOptions, Precision, layers};
use super::plotter::in_steps;
use std::fmt::Write;
use vitral_frame::Drawing;

/// Plotter units in a millimetre.
const UNITS: f64 = 40.0;
/// Points of one instruction: old plotters have small buffers.
const POINTS_AN_INSTRUCTION: usize = 32;

/// Writes the lines of a drawing.
pub fn hpgl(drawing: &Drawing, options: &DrawingOptions) -> Vec<u8> {
    let units = Precision { decimals: 0, steps_a_millimetre: UNITS };
    let (drawing, options) = in_steps(drawing, options, units.steps_a_millimetre);
    let mut out = format!("IN;PS{},{};\n", units.steps(drawing.width), units.steps(drawing.height));

    // Draw the title block and the most important lines first, as long as there is ink.
    for layer in layers(&drawing, &options).iter().rev() {
        let _ = writeln!(out, "SP{};PW{};", layer.number, layer.width);
        for points in &layer.lines {
            let corners = units.corners(points);
            let Some((first, rest)) = corners.split_first() else { continue };
            let _ = write!(out, "PU{},{};", first[0], first[1]);
            for run in rest.chunks(POINTS_AN_INSTRUCTION) {
                let points: Vec<String> = run.iter().map(|[x, y]| format!("{x},{y}")).collect();
                let _ = writeln!(out, "PD{};", points.join(","));
            }
        }
        for &[x, y] in layer.points {
            let _ = writeln!(out, "PU{},{};PD;", units.steps(x), units.steps(y));
        }
    }
    out.push_str("PU;SP0;\n");
    out.into_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_frame::drawing::{Line, LineClass};

    #[test]
    fn pens_are_chosen_and_lines_are_drawn_once() {
        let line =
            |class, layers, points: &[[f64; 2]]| Line { class, layers, points: points.to_vec() };
        let lines = vec![
            line(LineClass::Contour, 0, &[[1.0, 1.0], [2.5, 1.0]]),
            line(LineClass::Crease, 0, &[[2.5, 1.0], [1.0, 1.0], [0.0, 0.0]]),
            line(LineClass::Crease, 1, &[[0.0, 2.0], [4.0, 2.0]]),
        ];
        let drawing = Drawing {
            width: 4.0,
            height: 2.0,
            lines,
            points: vec![[0.5, 1.0]],
            ..Drawing::default()
        };
        let text = String::from_utf8(hpgl(&drawing, &DrawingOptions::default())).unwrap();
        let expected = "IN;PS160,80;\nSP11;PW0.5;\nPU20,40;PD;\nSP1;PW0.5;\nPU40,40;PD100,40;\nSP3;PW0.35;\nPU0,0;PD40,40;\n\
                        SP8;PW0.18;\nPU0,80;PD80,80;\nPU120,80;PD160,80;\nPU;SP0;\n";
        assert_eq!(text, expected);
    }
}
