//! SVG: a drawing with one group for each class of lines.
//!
//! The unit of the file is the step of the precision, usually a micrometre: the page is a view box
//! of whole numbers, and paths go from corner to corner in relative steps, which are short and
//! whole. Groups are layers for Inkscape, and `data-class` tells the class to whoever reads the
//! file. They come in the order in which they are painted: fills, hidden lines, then visible lines,
//! the most important last.
//!
//! Source: \[SVG\].

use super::pens::{DrawingOptions, FILL, Layer, Precision, layers, thousandths};
use std::fmt::Write;
use vitral_frame::Drawing;
use vitral_frame::drawing::Region;

/// Points of a path in a line of the file: editors and version control choke on longer ones.
const POINTS_A_LINE: usize = 16;

/// Writes a drawing.
pub fn svg(drawing: &Drawing, options: &DrawingOptions) -> Vec<u8> {
    let precision = options.precision();
    let [width, height] = [drawing.width, drawing.height].map(|side| precision.steps(side));
    let millimetres = |steps| f64::from(steps) / precision.steps_a_millimetre;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" \
         width=\"{}mm\" height=\"{}mm\" viewBox=\"0 0 {width} {height}\">\n",
        millimetres(width),
        millimetres(height),
    );
    let page = Page { precision, height };
    page.regions(&mut out, &drawing.regions, options);
    layers(drawing, options).iter().for_each(|layer| page.lines(&mut out, layer));
    out.push_str("</svg>\n");
    out.into_bytes()
}

/// The unit of the file, and its height in it.
struct Page {
    precision: Precision,
    height: i32,
}

impl Page {
    /// A width or the length of a dash, which may be finer than the precision of corners.
    fn length(&self, millimetres: f64) -> f64 {
        (millimetres * self.precision.steps_a_millimetre * 1000.0).round() / 1000.0
    }

    /// A group of lines.
    fn lines(&self, out: &mut String, layer: &Layer<'_>) {
        let length = |millimetres| self.length(millimetres);
        let (name, number) = (layer.name, layer.number);
        let _ = write!(
            out,
            "<g id=\"{name}\" inkscape:groupmode=\"layer\" inkscape:label=\"{number} {name}\" data-class=\"{name}\" \
             fill=\"none\" stroke=\"#000\" stroke-width=\"{}\"",
            length(layer.width)
        );
        if let Some([dash, gap]) = layer.dashes {
            let _ = write!(out, " stroke-dasharray=\"{} {}\"", length(dash), length(gap));
        }
        out.push_str(" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n");
        for (corners, closed) in layer.lines.iter().filter_map(|line| self.precision.line(line)) {
            out.push_str("<path d=\"");
            self.path(out, &corners, closed);
            out.push_str("\"/>\n");
        }
        // A line without length and with round ends is a dot.
        for point in layer.points {
            let [x, y] = point.map(|at| self.precision.steps(at));
            let _ = writeln!(out, "<path d=\"M{x} {}h0\"/>", self.height - y);
        }
        out.push_str("</g>\n");
    }

    /// The group of fills, if there are any.
    fn regions(&self, out: &mut String, regions: &[Region], options: &DrawingOptions) {
        if regions.is_empty() {
            return;
        }
        let _ = write!(
            out,
            "<g id=\"{FILL}\" inkscape:groupmode=\"layer\" inkscape:label=\"0 {FILL}\" data-class=\"{FILL}\" \
             fill-rule=\"evenodd\""
        );
        if let Some(width) = options.outline_width() {
            let width = self.length(width);
            let _ =
                write!(out, " stroke=\"#000\" stroke-width=\"{width}\" stroke-linejoin=\"round\"");
        }
        out.push_str(">\n");
        for region in regions {
            let [red, green, blue] = region.color;
            out.push_str("<path");
            if options.surface_ids {
                let _ = write!(out, " data-face=\"{}\"", region.surface);
            }
            if region.unlit != 0 {
                let lights = (0..u32::BITS).filter(|light| region.unlit >> light & 1 == 1);
                let lights: Vec<_> = lights.map(|light| light.to_string()).collect();
                let _ = write!(out, " data-shadow=\"{}\"", lights.join(" "));
            }
            let _ = write!(out, " fill=\"#{red:02x}{green:02x}{blue:02x}\"");
            if thousandths(region.opacity) < 1000 {
                let _ = write!(
                    out,
                    " fill-opacity=\"{}\"",
                    f64::from(thousandths(region.opacity)) / 1000.0
                );
            }
            out.push_str(" d=\"");
            region.rings.iter().for_each(|ring| self.path(out, &self.precision.ring(ring), true));
            out.push_str("\"/>\n");
        }
        out.push_str("</g>\n");
    }

    /// A path through corners of the page, which begin with the lower left one; files begin with
    /// the upper left one.
    fn path(&self, out: &mut String, corners: &[[i32; 2]], closed: bool) {
        let mut at = [0, 0];
        for (i, corner) in corners.iter().enumerate() {
            let next = [corner[0], self.height - corner[1]];
            let [dx, dy] = [next[0] - at[0], next[1] - at[1]];
            at = next;
            match i {
                0 => out.push('M'),
                1 => out.push('l'),
                _ if i.is_multiple_of(POINTS_A_LINE) => out.push('\n'),
                // A minus sign separates numbers as well.
                _ if dx >= 0 => out.push(' '),
                _ => {}
            }
            let separator = if dy >= 0 { " " } else { "" };
            let _ = write!(out, "{dx}{separator}{dy}");
        }
        if closed {
            out.push('z');
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::pens::Pens;
    use super::*;
    use vitral_frame::drawing::{Line, LineClass};

    fn line(class: LineClass, layers: u32, points: &[[f64; 2]]) -> Line {
        Line { class, layers, points: points.to_vec() }
    }

    #[test]
    fn lines_are_in_the_groups_of_their_classes() {
        let square = [[1.0, 1.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0], [1.0, 1.0]];
        let lines = vec![
            line(LineClass::Contour, 0, &square),
            line(LineClass::Crease, 0, &[[0.0, 0.0], [1.5, 0.25]]),
            line(LineClass::Crease, 2, &[[0.0, 0.0], [3.0, 2.0]]),
        ];
        let ring = square[..4].to_vec();
        let region = Region {
            surface: 3,
            material: None,
            color: [255, 0, 16],
            opacity: 1.0,
            unlit: 0,
            rings: vec![ring],
        };
        let points = vec![[0.5, 1.5]];
        let drawing = Drawing { width: 3.0, height: 2.0, lines, regions: vec![region], points };
        let text = String::from_utf8(svg(&drawing, &DrawingOptions::default())).unwrap();
        let expected = "\
<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" width=\"3mm\" height=\"2mm\" viewBox=\"0 0 3000 2000\">
<g id=\"fill\" inkscape:groupmode=\"layer\" inkscape:label=\"0 fill\" data-class=\"fill\" fill-rule=\"evenodd\">
<path fill=\"#ff0010\" d=\"M1000 1000l1000 0 0-1000-1000 0z\"/>
</g>
<g id=\"hidden\" inkscape:groupmode=\"layer\" inkscape:label=\"8 hidden\" data-class=\"hidden\" fill=\"none\" stroke=\"#000\" stroke-width=\"180\" stroke-dasharray=\"2000 1000\" stroke-linecap=\"round\" stroke-linejoin=\"round\">
<path d=\"M0 2000l3000-2000\"/>
</g>
<g id=\"crease\" inkscape:groupmode=\"layer\" inkscape:label=\"3 crease\" data-class=\"crease\" fill=\"none\" stroke=\"#000\" stroke-width=\"350\" stroke-linecap=\"round\" stroke-linejoin=\"round\">
<path d=\"M0 2000l1500-250\"/>
</g>
<g id=\"contour\" inkscape:groupmode=\"layer\" inkscape:label=\"1 contour\" data-class=\"contour\" fill=\"none\" stroke=\"#000\" stroke-width=\"500\" stroke-linecap=\"round\" stroke-linejoin=\"round\">
<path d=\"M1000 1000l1000 0 0-1000-1000 0z\"/>
</g>
<g id=\"point\" inkscape:groupmode=\"layer\" inkscape:label=\"11 point\" data-class=\"point\" fill=\"none\" stroke=\"#000\" stroke-width=\"500\" stroke-linecap=\"round\" stroke-linejoin=\"round\">
<path d=\"M500 500h0\"/>
</g>
</svg>
";
        assert_eq!(text, expected);
    }

    #[test]
    fn hatching_lies_below_other_lines() {
        let lines = vec![
            line(LineClass::Section, 0, &[[0.0, 0.0], [1.0, 0.0]]),
            line(LineClass::Hatch, 0, &[[0.0, 0.0], [1.0, 1.0]]),
        ];
        let text = String::from_utf8(svg(
            &Drawing { lines, ..Drawing::default() },
            &DrawingOptions::default(),
        ))
        .unwrap();
        let (hatch, section) =
            (text.find("label=\"10 hatch\"").unwrap(), text.find("label=\"6 section\"").unwrap());
        assert!(
            hatch < section
                && text.contains("stroke-width=\"180\"")
                && text.contains("stroke-width=\"700\"")
        );
    }

    #[test]
    fn solid_hidden_lines_have_no_dashes_and_nothing_has_no_groups() {
        let lines = vec![line(LineClass::Smooth, 1, &[[0.0, 0.0], [1.0, 0.0]])];
        let pens = Pens { hidden_dashes: None, ..Pens::default() };
        let options = DrawingOptions { pens, ..DrawingOptions::default() };
        let text =
            String::from_utf8(svg(&Drawing { lines, ..Drawing::default() }, &options)).unwrap();
        assert!(text.contains("data-class=\"hidden\"") && !text.contains("dash"));
        let empty = String::from_utf8(svg(&Drawing::default(), &options)).unwrap();
        assert!(!empty.contains("<g"));
    }

    #[test]
    fn outlined_regions_are_stroked_in_their_order() {
        let ring = |x: f64| vec![[x, 0.0], [x + 1.0, 0.0], [x, 1.0]];
        let region = |x: f64| Region {
            surface: 0,
            material: None,
            color: [255; 3],
            opacity: 1.0,
            unlit: 5,
            rings: vec![ring(x)],
        };
        let drawing = Drawing { regions: vec![region(0.0), region(0.5)], ..Drawing::default() };
        let options = DrawingOptions {
            region_outlines: Some(LineClass::Smooth),
            ..DrawingOptions::default()
        };
        let text = String::from_utf8(svg(&drawing, &options)).unwrap();
        assert!(
            text.contains(
                "fill-rule=\"evenodd\" stroke=\"#000\" stroke-width=\"180\" stroke-linejoin"
            ),
            "{text}"
        );
        assert_eq!(
            (text.matches("<g").count(), text.matches("<path data-shadow=\"0 2\" fill").count()),
            (1, 2)
        );
    }

    #[test]
    fn a_coarse_precision_makes_coarse_units_and_faces_are_told() {
        let lines = vec![line(LineClass::Contour, 0, &[[0.0, 0.0], [1.26, 0.01], [1.26, 0.04]])];
        let region = Region {
            surface: 3,
            material: None,
            color: [0; 3],
            opacity: 0.25,
            unlit: 0,
            rings: vec![vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]],
        };
        let drawing =
            Drawing { width: 3.0, height: 2.0, lines, regions: vec![region], ..Drawing::default() };
        let options =
            DrawingOptions { decimals: 1, surface_ids: true, ..DrawingOptions::default() };
        let text = String::from_utf8(svg(&drawing, &options)).unwrap();
        assert!(text.contains("width=\"3mm\" height=\"2mm\" viewBox=\"0 0 30 20\""), "{text}");
        assert!(
            text.contains("stroke-width=\"5\"") && text.contains("<path d=\"M0 20l13 0\"/>"),
            "{text}"
        );
        assert!(
            text.contains("<path data-face=\"3\" fill=\"#000000\" fill-opacity=\"0.25\" d=\"M0 20l10 0 0-10z\"/>"),
            "{text}"
        );
    }
}
