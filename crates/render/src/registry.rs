//! The one table of algorithms. Command line, documents, tests and other faces iterate over it.

use crate::visible::{
    VisibleSurface, brute_force::BruteForce, ray_cast::RayCast, scanline::ScanLine, warnock::Warnock, zbuffer::ZBuffer,
};

/// An algorithm that finds the visible surface at each sample.
pub struct VisibilityAlgorithm {
    /// Name on the command line.
    pub name: &'static str,
    /// What it does, in a line.
    pub description: &'static str,
    /// Key into the bibliography.
    pub source: &'static str,
    /// `image` or `list-priority` precision.
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
        name: "ray-cast",
        description: "a ray through every sample, and a tree of boxes to find what it meets",
        source: "Appel 1968",
        precision: "image",
        algorithm: &RayCast,
    },
    VisibilityAlgorithm {
        name: "brute-force",
        description: "every facet against every sample: slow, the reference of the others",
        source: "Foley et al. 1990",
        precision: "image",
        algorithm: &BruteForce,
    },
];

/// A visible-surface algorithm by its name.
pub fn visibility(name: &str) -> Option<&'static VisibilityAlgorithm> {
    VISIBILITY.iter().find(|a| a.name == name)
}
