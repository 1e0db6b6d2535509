//! The SVG that pictures of structures are written to.
//!
//! In:   texts, lines and boxes. Out: a file as large as they reach.

use std::fmt::Write;

/// An SVG that is being written. Lengths are in its units, pixels where it is shown in its own
/// size.
pub(super) struct Picture {
    pub(super) elements: String,
    /// What has been drawn so far reaches so far.
    pub(super) size: [f64; 2],
}

/// Height of a line of text.
pub(super) const LINE: f64 = 16.0;
/// About the width of a character.
pub(super) const CHARACTER: f64 = 7.3;
/// Room around the picture.
pub(super) const MARGIN: f64 = 16.0;

pub(super) const INK: &str = "#222222";
pub(super) const GREY: &str = "#999999";
pub(super) const BLUE: &str = "#1f5fbf";
pub(super) const RED: &str = "#c03020";

impl Picture {
    /// With a title and lines that explain it.
    pub(super) fn new(title: &str, explained: &[&str]) -> Self {
        let mut picture = Self { elements: String::new(), size: [0.0; 2] };
        picture.text([MARGIN, MARGIN + LINE], title, INK, "start");
        for (i, line) in explained.iter().enumerate() {
            picture.text([MARGIN, MARGIN + LINE * (i + 2) as f64], line, GREY, "start");
        }
        picture
    }

    /// Where there is room below what is drawn.
    pub(super) fn bottom(&self) -> f64 {
        self.size[1] + MARGIN
    }

    pub(super) fn reach(&mut self, x: f64, y: f64) {
        self.size = [self.size[0].max(x), self.size[1].max(y)];
    }

    /// Text whose baseline begins at a point, or has it in its middle or at its end; returns how
    /// far it reaches.
    pub(super) fn text(&mut self, [x, y]: [f64; 2], text: &str, color: &str, anchor: &str) -> f64 {
        let escaped = text.replace('&', "&amp;").replace('<', "&lt;");
        // Writing to a string cannot fail.
        let _ = writeln!(
            self.elements,
            r#"<text x="{x:.1}" y="{y:.1}" fill="{color}" text-anchor="{anchor}">{escaped}</text>"#
        );
        let width = text.chars().count() as f64 * CHARACTER;
        let after = match anchor {
            "end" => 0.0,
            "middle" => width / 2.0,
            _ => width,
        };
        self.reach(x + after, y + 4.0);
        x + after
    }

    pub(super) fn line(&mut self, [x0, y0]: [f64; 2], [x1, y1]: [f64; 2], color: &str, width: f64) {
        let _ = writeln!(
            self.elements,
            r#"<line x1="{x0:.1}" y1="{y0:.1}" x2="{x1:.1}" y2="{y1:.1}" stroke="{color}" stroke-width="{width}"/>"#
        );
        self.reach(x0.max(x1), y0.max(y1));
    }

    /// A line with a head at its second end.
    pub(super) fn arrow(&mut self, from: [f64; 2], to: [f64; 2], color: &str) {
        self.line(from, to, color, 1.5);
        let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
        let length = (dx * dx + dy * dy).sqrt().max(1.0);
        let [ux, uy] = [dx / length * 8.0, dy / length * 8.0];
        let [left, right] = [0.5, -0.5]
            .map(|k| [to[0] - ux - uy * k, to[1] - uy + ux * k])
            .map(|[x, y]| format!("{x:.1},{y:.1}"));
        let [x, y] = to;
        let _ = writeln!(
            self.elements,
            r#"<polygon points="{x:.1},{y:.1} {left} {right}" fill="{color}"/>"#
        );
    }

    /// A box by its upper left corner and its size.
    pub(super) fn rectangle(
        &mut self,
        [x, y]: [f64; 2],
        [width, height]: [f64; 2],
        stroke: &str,
        fill: &str,
    ) {
        let _ = writeln!(
            self.elements,
            r#"<rect x="{x:.1}" y="{y:.1}" width="{width:.1}" height="{height:.1}" rx="4" fill="{fill}" stroke="{stroke}"/>"#
        );
        self.reach(x + width, y + height);
    }

    /// The whole file.
    pub(super) fn finish(self) -> String {
        let [width, height] = self.size.map(|side| (side + MARGIN).ceil());
        let elements = self.elements;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} \
             {height}\" font-family=\"monospace\" font-size=\"12\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n{elements}</svg>\n"
        )
    }
}

/// Some numbers in a row, and how many there are if these are not all.
pub(super) fn row_of(numbers: &[u32], count: u32) -> String {
    const MAX_NAMED: usize = 8;
    let names: Vec<_> = numbers.iter().take(MAX_NAMED).map(u32::to_string).collect();
    let more = (count as usize).saturating_sub(names.len());
    if more > 0 { format!("{} and {more} more", names.join(" ")) } else { names.join(" ") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_picture_holds_what_is_drawn() {
        let mut picture = Picture::new("A < B", &["explained"]);
        picture.rectangle([10.0, 100.0], [30.0, 20.0], INK, "none");
        picture.arrow([0.0, 0.0], [200.0, 50.0], BLUE);
        assert_eq!(picture.bottom(), 120.0 + MARGIN);
        let svg = picture.finish();
        assert!(svg.contains("viewBox=\"0 0 216 136\"") && svg.contains("A &lt; B"), "{svg}");
        assert!(svg.ends_with("</svg>\n"));
    }

    #[test]
    fn long_rows_are_counted() {
        assert_eq!(row_of(&[1, 2], 2), "1 2");
        assert_eq!(row_of(&[1, 2], 9), "1 2 and 7 more");
    }
}
