//! DXF: a drawing for CAD programs, in the format of AutoCAD release 12, which everything reads.
//!
//! Layers have the names of classes, their colours and line types; entities take both from their
//! layer, and none is on layer 0. The unit is the millimetre, y is upwards. The release knows
//! neither line widths nor filled areas: regions are left out.
//!
//! Source: \[DXF\].

use super::pens::{DrawingOptions, Layer, Precision, layers};
use std::fmt::{Display, Write};
use vitral_frame::Drawing;

/// Colour numbers of layers by their numbers; 7 is black on white and white on black.
const COLORS: [u32; 12] = [7, 7, 5, 3, 6, 1, 2, 8, 4, 9, 8, 30];
/// The line types' names.
const SOLID: &str = "CONTINUOUS";
const DASHED: &str = "HIDDEN";
/// The bit of a polyline that is closed.
const CLOSED: u32 = 1;
/// `$INSUNITS` for millimetres. Release 12 does not have the variable; later programs read it.
const MILLIMETRES: u32 = 4;

/// Writes the lines of a drawing.
pub fn dxf(drawing: &Drawing, options: &DrawingOptions) -> Vec<u8> {
    let layers = layers(drawing, options);
    let precision = options.precision();
    let mut file = Groups { text: String::new(), precision };
    file.header(drawing);

    // Define line types, then layers.
    file.section("TABLES");
    file.line_types(&layers);
    file.table("LAYER", layers.len() + 1);
    file.layer("0", COLORS[0], SOLID);
    for layer in &layers {
        file.layer(
            layer.name,
            COLORS[layer.number],
            if layer.dashes.is_some() { DASHED } else { SOLID },
        );
    }
    file.group(0, "ENDTAB");
    file.group(0, "ENDSEC");

    // Draw.
    file.section("ENTITIES");
    for layer in &layers {
        for (corners, closed) in layer.lines.iter().filter_map(|line| precision.line(line)) {
            file.entity(layer.name, &corners, closed);
        }
        for &point in layer.points {
            file.group(0, "POINT");
            file.group(8, layer.name);
            file.point(10, point.map(|at| precision.steps(at)));
        }
    }
    file.group(0, "ENDSEC");
    file.group(0, "EOF");
    file.text.into_bytes()
}

/// The file: pairs of a code and a value, a line each.
struct Groups {
    text: String,
    precision: Precision,
}

impl Groups {
    fn group(&mut self, code: u32, value: impl Display) {
        let _ = writeln!(self.text, "{code}\n{value}");
    }

    fn section(&mut self, name: &str) {
        self.group(0, "SECTION");
        self.group(2, name);
    }

    fn table(&mut self, name: &str, rows: usize) {
        self.group(0, "TABLE");
        self.group(2, name);
        self.group(70, rows);
    }

    /// A point, with the codes `x_code` and `x_code + 10`.
    fn point(&mut self, x_code: u32, at: [i32; 2]) {
        for (code, steps) in [(x_code, at[0]), (x_code + 10, at[1])] {
            let mut number = String::new();
            self.precision.write(&mut number, steps);
            if !number.contains('.') {
                number.push_str(".0");
            }
            self.group(code, number);
        }
    }

    fn header(&mut self, drawing: &Drawing) {
        let size = [drawing.width, drawing.height].map(|side| self.precision.steps(side));
        self.section("HEADER");
        self.group(9, "$ACADVER");
        self.group(1, "AC1009");
        self.group(9, "$INSUNITS");
        self.group(70, MILLIMETRES);
        for (name, at) in
            [("$EXTMIN", [0, 0]), ("$EXTMAX", size), ("$LIMMIN", [0, 0]), ("$LIMMAX", size)]
        {
            self.group(9, name);
            self.point(10, at);
            if name.starts_with("$EXT") {
                self.group(30, "0.0");
            }
        }
        self.group(0, "ENDSEC");
    }

    /// Line types: solid, and dashed if a layer is.
    fn line_types(&mut self, layers: &[Layer<'_>]) {
        let dashes = layers.iter().find_map(|layer| layer.dashes);
        self.table("LTYPE", 1 + usize::from(dashes.is_some()));
        self.line_type(SOLID, "Solid line", &[]);
        if let Some([dash, gap]) = dashes {
            self.line_type(DASHED, "Hidden __ __ __ __", &[dash, -gap]);
        }
        self.group(0, "ENDTAB");
    }

    /// A line type; gaps are negative.
    fn line_type(&mut self, name: &str, description: &str, pattern: &[f64]) {
        self.group(0, "LTYPE");
        self.group(2, name);
        self.group(70, 0);
        self.group(3, description);
        self.group(72, 65);
        self.group(73, pattern.len());
        self.group(
            40,
            format_args!("{:?}", pattern.iter().fold(0.0, |sum, length| sum + length.abs())),
        );
        pattern.iter().for_each(|length| self.group(49, format_args!("{length:?}")));
    }

    fn layer(&mut self, name: &str, color: u32, line_type: &str) {
        self.group(0, "LAYER");
        self.group(2, name);
        self.group(70, 0);
        self.group(62, color);
        self.group(6, line_type);
    }

    fn entity(&mut self, layer: &str, corners: &[[i32; 2]], closed: bool) {
        if let &[from, to] = corners {
            self.group(0, "LINE");
            self.group(8, layer);
            self.point(10, from);
            self.point(11, to);
            return;
        }
        self.group(0, "POLYLINE");
        self.group(8, layer);
        self.group(66, 1);
        self.point(10, [0, 0]);
        self.group(70, if closed { CLOSED } else { 0 });
        for &corner in corners {
            self.group(0, "VERTEX");
            self.group(8, layer);
            self.point(10, corner);
        }
        self.group(0, "SEQEND");
        self.group(8, layer);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_frame::drawing::{Line, LineClass};

    #[test]
    fn layers_line_types_and_entities_are_written() {
        let line =
            |class, layers, points: &[[f64; 2]]| Line { class, layers, points: points.to_vec() };
        let lines = vec![
            line(LineClass::Contour, 0, &[[1.0, 1.0], [2.5, 1.0], [2.0, 2.0], [1.0, 1.0]]),
            line(LineClass::Crease, 1, &[[0.0, 0.0], [1.5, 0.25]]),
        ];
        let drawing = Drawing {
            width: 3.0,
            height: 2.0,
            lines,
            points: vec![[0.5, 1.0]],
            ..Drawing::default()
        };
        let text = String::from_utf8(dxf(&drawing, &DrawingOptions::default())).unwrap();
        for part in [
            "9\n$ACADVER\n1\nAC1009\n9\n$INSUNITS\n70\n4\n9\n$EXTMIN\n10\n0.0\n20\n0.0\n30\n0.0\n9\n$EXTMAX\n10\n3.0\n20\n2.0\n",
            "LTYPE\n2\nHIDDEN\n70\n0\n3\nHidden __ __ __ __\n72\n65\n73\n2\n40\n3.0\n49\n2.0\n49\n-1.0\n",
            "0\nLAYER\n2\nhidden\n70\n0\n62\n4\n6\nHIDDEN\n0\nLAYER\n2\ncontour\n70\n0\n62\n7\n6\nCONTINUOUS\n\
             0\nLAYER\n2\npoint\n70\n0\n62\n30\n6\nCONTINUOUS\n0\nENDTAB\n",
            "ENTITIES\n0\nLINE\n8\nhidden\n10\n0.0\n20\n0.0\n11\n1.5\n21\n0.25\n0\nPOLYLINE\n8\ncontour\n66\n1\n10\n0.0\n20\n0.0\n70\n1\n\
             0\nVERTEX\n8\ncontour\n10\n1.0\n20\n1.0\n0\nVERTEX\n8\ncontour\n10\n2.5\n20\n1.0\n0\nVERTEX\n8\ncontour\n10\n2.0\n20\n2.0\n\
             0\nSEQEND\n8\ncontour\n0\nPOINT\n8\npoint\n10\n0.5\n20\n1.0\n0\nENDSEC\n0\nEOF\n",
        ] {
            assert!(text.contains(part), "{part}\nis not in\n{text}");
        }
        assert!(!text.contains("8\n0\n"), "nothing is on layer 0");
        let empty =
            String::from_utf8(dxf(&Drawing::default(), &DrawingOptions::default())).unwrap();
        assert!(!empty.contains("HIDDEN") && empty.ends_with("ENTITIES\n0\nENDSEC\n0\nEOF\n"));
    }
}
