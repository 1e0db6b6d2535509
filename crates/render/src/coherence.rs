//! Kinds of coherence: what one part of a picture, or one picture of a turntable, says about the
//! next.
//!
//! The names are those of the course. An algorithm lists in the [`registry`](crate::registry) the
//! kinds that it exploits and that can be switched off: the picture stays the same, and the work
//! that was saved is done.
//!
//! What each kind means here is in [`Coherence::description`].

use serde::{Deserialize, Serialize};

/// A kind of coherence.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Coherence {
    /// Of a whole object.
    Object,
    /// Of a face: neighbouring samples mostly show the same one.
    Face,
    /// Of an edge: its crossing moves by a constant from line to line.
    Edge,
    /// Of the line where two faces penetrate each other.
    ImpliedEdge,
    /// Of a line and the next.
    ScanLine,
    /// Of neighbouring pixels.
    Area,
    /// Of depths: they are linear over a face.
    Depth,
    /// Of a picture and the next.
    Frame,
}

impl Coherence {
    /// All kinds with their names.
    pub const ALL: [(Self, &'static str); 8] = [
        (Self::Object, "object"),
        (Self::Face, "face"),
        (Self::Edge, "edge"),
        (Self::ImpliedEdge, "implied-edge"),
        (Self::ScanLine, "scan-line"),
        (Self::Area, "area"),
        (Self::Depth, "depth"),
        (Self::Frame, "frame"),
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(kind, _)| *kind == self).map_or("", |(_, name)| name)
    }

    /// What it means, in a line.
    pub fn description(self) -> &'static str {
        match self {
            Self::Object => {
                "what is true of an object's box is true of its polygons: outside the view volume, all are"
            }
            Self::Face => {
                "the depth of a face in one place follows from its depth in a place beside"
            }
            Self::Edge => {
                "where an edge crosses a line follows from where it crossed the line before"
            }
            Self::ImpliedEdge => {
                "two points fix the line where two faces penetrate each other; it cuts the spans that area coherence makes"
            }
            Self::ScanLine => {
                "the edges that cross a line are nearly those that cross the line before"
            }
            Self::Area => {
                "neighbouring pixels show the same surface: spans, windows, packets of rays"
            }
            Self::Depth => {
                "what is nearest in a place is so around it, and hides whole polygons that are farther"
            }
            Self::Frame => {
                "the next picture shows the same scene: trees and what is known of meshes are kept"
            }
        }
    }
}

/// The kinds that are to be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CoherenceSet(u8);

impl CoherenceSet {
    /// These kinds.
    pub fn of(kinds: &[Coherence]) -> Self {
        Self(kinds.iter().fold(0, |set, &kind| set | 1 << kind as u8))
    }

    /// Whether a kind is to be used.
    #[inline]
    pub fn has(self, kind: Coherence) -> bool {
        self.0 & 1 << kind as u8 != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_hold_what_was_put_in() {
        let set = CoherenceSet::of(&[Coherence::Edge, Coherence::Frame]);
        let held: Vec<_> = Coherence::ALL
            .iter()
            .filter(|(kind, _)| set.has(*kind))
            .map(|(_, name)| *name)
            .collect();
        assert_eq!(held, ["edge", "frame"]);
        assert_eq!(Coherence::ImpliedEdge.name(), "implied-edge");
    }
}
