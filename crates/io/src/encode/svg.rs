//! SVG: a drawing with one group for each class of lines.
//!
//! The unit of the file is the micrometre: the page is a view box of whole numbers, and paths go from corner to corner in relative
//! steps, which are short and whole. Groups are layers for Inkscape, and `data-class` tells the class to whoever reads the file. They
//! come in the order in which they are painted: fills, hidden lines, then visible lines, the most important last.
//!
//! Source: \[SVG\].

use std::fmt::Write;
use vitral_frame::Drawing;
use vitral_frame::drawing::{Line, LineClass, Region};

/// Micrometres in a millimetre.
const UNITS: f64 = 1000.0;
/// Points of a path in a line of the file: editors and version control choke on longer ones.
const POINTS_A_LINE: usize = 16;

/// How lines look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SvgOptions {
    /// Widths of visible lines in millimetres, in the order of [`LineClass::ALL`].
    pub widths: [f64; 7],
    /// Width of hidden lines in millimetres.
    pub hidden_width: f64,
    /// Lengths of dashes and gaps of hidden lines in millimetres; `None`: solid.
    pub hidden_dashes: Option<[f64; 2]>,
}

impl Default for SvgOptions {
    /// The widths of ISO 128: wide lines for outlines, narrow ones inside, thin dashes where lines are hidden.
    fn default() -> Self {
        let widths = LineClass::ALL.map(|(class, ..)| match class {
            LineClass::Contour | LineClass::Boundary => 0.5,
            LineClass::Section => 0.7,
            LineClass::Smooth => 0.18,
            _ => 0.35,
        });
        Self { widths, hidden_width: 0.18, hidden_dashes: Some([2.0, 1.0]) }
    }
}

/// Writes a drawing.
pub fn svg(drawing: &Drawing, options: &SvgOptions) -> Vec<u8> {
    let [width, height] = [drawing.width, drawing.height].map(units);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" \
         width=\"{}mm\" height=\"{}mm\" viewBox=\"0 0 {width} {height}\">\n",
        f64::from(width) / UNITS,
        f64::from(height) / UNITS,
    );
    regions(&mut out, &drawing.regions, height);

    // Hidden lines of all classes are one layer, below the visible ones.
    let mut pen = format!("stroke-width=\"{}\"", units(options.hidden_width));
    if let Some([dash, gap]) = options.hidden_dashes {
        let _ = write!(pen, " stroke-dasharray=\"{} {}\"", units(dash), units(gap));
    }
    let hidden = drawing.lines.iter().filter(|line| line.layers > 0);
    lines(&mut out, hidden, "hidden", LineClass::ALL.len() + 1, &pen, height);
    for (i, (class, name, _)) in LineClass::ALL.iter().enumerate().rev() {
        let visible = drawing.lines.iter().filter(|line| line.layers == 0 && line.class == *class);
        lines(&mut out, visible, name, i + 1, &format!("stroke-width=\"{}\"", units(options.widths[i])), height);
    }
    out.push_str("</svg>\n");
    out.into_bytes()
}

/// Whole micrometres.
fn units(millimetres: f64) -> i32 {
    (millimetres * UNITS).round() as i32
}

/// A group of lines, if there are any.
fn lines<'l>(
    out: &mut String,
    lines: impl Iterator<Item = &'l Line>,
    name: &str,
    layer: usize,
    pen: &str,
    height: i32,
) {
    let mut lines = lines.peekable();
    if lines.peek().is_none() {
        return;
    }
    let _ = writeln!(
        out,
        "<g id=\"{name}\" inkscape:groupmode=\"layer\" inkscape:label=\"{layer} {name}\" data-class=\"{name}\" fill=\"none\" \
         stroke=\"#000\" {pen} stroke-linecap=\"round\" stroke-linejoin=\"round\">"
    );
    for line in lines {
        let closed = line.points.len() > 3 && line.points.first() == line.points.last();
        let corners = if closed { &line.points[..line.points.len() - 1] } else { &line.points[..] };
        out.push_str("<path d=\"");
        path(out, corners, closed, height);
        out.push_str("\"/>\n");
    }
    out.push_str("</g>\n");
}

/// The group of fills, if there are any.
fn regions(out: &mut String, regions: &[Region], height: i32) {
    if regions.is_empty() {
        return;
    }
    out.push_str("<g id=\"fill\" inkscape:groupmode=\"layer\" inkscape:label=\"0 fill\" data-class=\"fill\" fill-rule=\"evenodd\">\n");
    for region in regions {
        let [red, green, blue] = region.color;
        let _ = write!(out, "<path fill=\"#{red:02x}{green:02x}{blue:02x}\" d=\"");
        region.rings.iter().for_each(|ring| path(out, ring, true, height));
        out.push_str("\"/>\n");
    }
    out.push_str("</g>\n");
}

/// A path through points of the page, which begin with the lower left corner; files begin with the upper left one.
fn path(out: &mut String, points: &[[f64; 2]], closed: bool, height: i32) {
    let mut at = [0, 0];
    for (i, point) in points.iter().enumerate() {
        let next = [units(point[0]), height - units(point[1])];
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

#[cfg(test)]
mod tests {
    use super::*;

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
        let region = Region { surface: 3, material: None, color: [255, 0, 16], rings: vec![ring] };
        let drawing = Drawing { width: 3.0, height: 2.0, lines, regions: vec![region] };
        let text = String::from_utf8(svg(&drawing, &SvgOptions::default())).unwrap();
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
</svg>
";
        assert_eq!(text, expected);
    }

    #[test]
    fn solid_hidden_lines_have_no_dashes_and_nothing_has_no_groups() {
        let lines = vec![line(LineClass::Smooth, 1, &[[0.0, 0.0], [1.0, 0.0]])];
        let options = SvgOptions { hidden_dashes: None, ..SvgOptions::default() };
        let text = String::from_utf8(svg(&Drawing { lines, ..Drawing::default() }, &options)).unwrap();
        assert!(text.contains("data-class=\"hidden\"") && !text.contains("dash"));
        let empty = String::from_utf8(svg(&Drawing::default(), &options)).unwrap();
        assert!(!empty.contains("<g"));
    }
}
