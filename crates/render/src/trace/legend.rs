//! What the colours of a picture of steps mean, algorithm by algorithm: `docs/steps.md`,
//! `vitral algorithms`.

use super::picture::{MARKS, OUTLINE, STOPS};
use std::fmt::Write;

/// What an algorithm's picture of steps shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Legend {
    /// What each pixel cost, as a ramp; the cost is the number of these.
    Cost(&'static str),
    /// Windows, outlined in the colour of their verdict.
    Windows,
    /// The place of the polygon on top in the list, as a ramp, with the outlines of polygons that
    /// were cut.
    List,
    /// Outlines of visible polygons.
    Outlines,
}

impl Legend {
    /// In a line.
    pub fn tell(self) -> String {
        match self {
            Self::Cost(of) => format!("cost from blue to red: {of}"),
            Self::Windows => {
                "outlines of windows: green one polygon, yellow surrounded, red one pixel, blue empty".to_owned()
            }
            Self::List => {
                "place in the list from blue (far) to red (near), outlines of polygons that were cut".to_owned()
            }
            Self::Outlines => "outlines of the visible polygons, blue".to_owned(),
        }
    }

    /// Its colours and what they mean.
    fn colors(self) -> Vec<(String, String)> {
        let ramp = STOPS.map(|stop| hex(stop.map(|c| c as u8))).join(" ");
        let mark = |number: usize| hex(MARKS[number]);
        let pair = |color: String, what: &str| (color, what.to_owned());
        match self {
            Self::Cost(of) => vec![
                (
                    ramp,
                    format!(
                        "{of}: the redder the more, by the square root of the share of the picture's dearest pixel"
                    ),
                ),
                pair("grey".to_owned(), "no cost: the picture alone"),
            ],
            Self::Windows => vec![
                pair(mark(0), "an empty window"),
                pair(mark(1), "a window with one polygon, which is drawn"),
                pair(mark(2), "a window that a polygon surrounds, in front of all others"),
                pair(mark(3), "a window of one pixel, decided sample by sample"),
                pair("paler".to_owned(), "windows smaller than three pixels, lest the picture disappear"),
                pair("none".to_owned(), "windows that were cut in four have no outline; the four have"),
            ],
            Self::List => vec![
                (
                    ramp,
                    "place in the list of the polygon that is on top, from the first (far) to the last (near)"
                        .to_owned(),
                ),
                pair(hex(OUTLINE), "outline of a polygon that was cut, or of a part of it"),
                pair("grey".to_owned(), "no polygon"),
            ],
            Self::Outlines => vec![
                pair(mark(0), "edges of the visible polygons, their outlines and holes"),
                pair("grey".to_owned(), "the picture within and beside them"),
            ],
        }
    }
}

fn hex([r, g, b]: [u8; 3]) -> String {
    format!("`#{r:02x}{g:02x}{b:02x}`")
}

/// The text of `docs/steps.md`, of the algorithms' names and legends.
pub fn page(algorithms: impl IntoIterator<Item = (&'static str, Legend)>) -> String {
    let mut text = "# What `--channel steps` shows\n\n\
        The steps of the visibility algorithm with one sample a pixel, drawn over the picture, which is grey there. Colours of a \
        ramp are darker where the picture is; outlines are not. `--trace FILE` writes the same steps as numbers, `--pixel X,Y` \
        tells those of a pixel in words. This page is made of the tables that draw the picture \
        (`crates/render/src/trace/legend.rs`).\n"
        .to_owned();
    for (name, legend) in algorithms {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "\n## `--visibility {}`\n\n| colour | meaning |\n|---|---|", name);
        for (color, meaning) in legend.colors() {
            let _ = writeln!(text, "| {color} | {meaning} |");
        }
    }
    text
}
