//! The one table of algorithms. Command line, documents, tests and other faces iterate over it.

use crate::visible::{
    VisibleSurface, bsp::Bsp, painter::Painter, scanline::ScanLine, warnock::Warnock, weiler_atherton::WeilerAtherton,
    zbuffer::ZBuffer,
};

/// An algorithm that finds the visible surface at each sample.
pub struct VisibilityAlgorithm {
    /// Name on the command line.
    pub name: &'static str,
    /// What it does, in a line.
    pub description: &'static str,
    /// Key into the bibliography.
    pub source: &'static str,
    /// `image`, `list-priority` or `object` precision.
    pub precision: &'static str,
    /// The code.
    pub algorithm: &'static dyn VisibleSurface,
}

/// All visible-surface algorithms, the default first.
pub static VISIBILITY: &[VisibilityAlgorithm] = &[
    VisibilityAlgorithm {
        name: "z-buffer",
        description: "every sample keeps its nearest facet",
        source: "Catmull 1974",
        precision: "image",
        algorithm: &ZBuffer,
    },
    VisibilityAlgorithm {
        name: "scan-line",
        description: "line by line, from edge to edge",
        source: "Watkins 1970",
        precision: "image",
        algorithm: &ScanLine,
    },
    VisibilityAlgorithm {
        name: "warnock",
        description: "windows are cut in four until they are simple",
        source: "Warnock 1969",
        precision: "image",
        algorithm: &Warnock,
    },
    VisibilityAlgorithm {
        name: "painter",
        description: "polygons sorted by depth are painted over each other",
        source: "Newell, Newell & Sancha 1972",
        precision: "list-priority",
        algorithm: &Painter,
    },
    VisibilityAlgorithm {
        name: "bsp",
        description: "a tree of planes gives the order from back to front",
        source: "Fuchs, Kedem & Naylor 1980",
        precision: "list-priority",
        algorithm: &Bsp,
    },
    VisibilityAlgorithm {
        name: "weiler-atherton",
        description: "polygons are clipped against each other until only visible ones are left",
        source: "Weiler & Atherton 1977",
        precision: "object",
        algorithm: &WeilerAtherton,
    },
];

/// A visible-surface algorithm by its name.
pub fn visibility(name: &str) -> Option<&'static VisibilityAlgorithm> {
    VISIBILITY.iter().find(|a| a.name == name)
}
