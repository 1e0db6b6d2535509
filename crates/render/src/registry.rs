//! The one table of algorithms. Command line, documents, tests and other faces iterate over it.

use crate::shadow::{
    ShadowAlgorithm, map::MapShadows, object_precision::ObjectPrecisionShadows, ray::RayShadows,
    scan_line::ScanLineShadows, volume::VolumeShadows,
};
use crate::trace::legend::Legend;
use crate::visible::{
    VisibleSurface, brute_force::BruteForce, bsp::Bsp, painter::Painter, ray_cast::RayCast, scanline::ScanLine,
    warnock::Warnock, weiler_atherton::WeilerAtherton, zbuffer::ZBuffer,
};
use crate::{Acceleration, Coherence, Global};

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
    /// Whether it follows rays, so that [`ACCELERATION`] is a choice.
    pub casts_rays: bool,
    /// Kinds of coherence that it exploits and that can be switched off.
    pub coherence: &'static [Coherence],
    /// What its picture of steps shows.
    pub steps: Legend,
    /// The code.
    pub algorithm: &'static dyn VisibleSurface,
}

impl VisibilityAlgorithm {
    /// Whether it makes a list of polygons from back to front, which transparent ones can be drawn by.
    pub fn makes_list(&self) -> bool {
        self.precision == "list-priority"
    }
}

/// All visible-surface algorithms, the default first.
pub static VISIBILITY: &[VisibilityAlgorithm] = &[
    VisibilityAlgorithm {
        name: "z-buffer",
        description: "every sample keeps its nearest facet",
        source: "Catmull 1974",
        precision: "image",
        casts_rays: false,
        coherence: &[Coherence::Object, Coherence::Frame],
        steps: Legend::Cost("opaque facets that cover the pixel"),
        algorithm: &ZBuffer,
    },
    VisibilityAlgorithm {
        name: "scan-line",
        description: "line by line, from edge to edge",
        source: "Watkins 1970",
        precision: "image",
        casts_rays: false,
        coherence: &[
            Coherence::Object,
            Coherence::Face,
            Coherence::Edge,
            Coherence::ImpliedEdge,
            Coherence::ScanLine,
            Coherence::Area,
            Coherence::Depth,
            Coherence::Frame,
        ],
        steps: Legend::Cost("polygons that are in, over the spans of the pixel"),
        algorithm: &ScanLine,
    },
    VisibilityAlgorithm {
        name: "warnock",
        description: "windows are cut in four until they are simple",
        source: "Warnock 1969",
        precision: "image",
        casts_rays: false,
        coherence: &[Coherence::Object, Coherence::Area, Coherence::Depth, Coherence::Frame],
        steps: Legend::Windows,
        algorithm: &Warnock,
    },
    VisibilityAlgorithm {
        name: "ray-cast",
        description: "a ray through every sample, and a structure that finds what it meets (--acceleration)",
        source: "Appel 1968",
        precision: "image",
        casts_rays: true,
        coherence: &[Coherence::Object, Coherence::Area, Coherence::Frame],
        steps: Legend::Cost("boxes or cells and facets that the rays of its block of pixels were tested against"),
        algorithm: &RayCast,
    },
    VisibilityAlgorithm {
        name: "brute-force",
        description: "every facet against every sample: slow, the reference of the others",
        source: "Foley et al. 1990",
        precision: "image",
        casts_rays: false,
        coherence: &[Coherence::Object, Coherence::Frame],
        steps: Legend::Cost("facets that the rays of its block of pixels were tested against"),
        algorithm: &BruteForce,
    },
    VisibilityAlgorithm {
        name: "painter",
        description: "polygons sorted by depth are painted over each other",
        source: "Newell, Newell & Sancha 1972",
        precision: "list-priority",
        casts_rays: false,
        coherence: &[Coherence::Object, Coherence::Frame],
        steps: Legend::List,
        algorithm: &Painter,
    },
    VisibilityAlgorithm {
        name: "bsp",
        description: "a tree of planes gives the order from back to front",
        source: "Fuchs, Kedem & Naylor 1980",
        precision: "list-priority",
        casts_rays: false,
        coherence: &[Coherence::Object, Coherence::Frame],
        steps: Legend::List,
        algorithm: &Bsp,
    },
    VisibilityAlgorithm {
        name: "weiler-atherton",
        description: "polygons are clipped against each other until only visible ones are left",
        source: "Weiler & Atherton 1977",
        precision: "object",
        casts_rays: false,
        coherence: &[Coherence::Object, Coherence::Frame],
        steps: Legend::Outlines,
        algorithm: &WeilerAtherton,
    },
];

/// A visible-surface algorithm by its name.
pub fn visibility(name: &str) -> Option<&'static VisibilityAlgorithm> {
    VISIBILITY.iter().find(|a| a.name == name)
}

/// A structure that finds the triangles near a ray.
#[derive(Clone, Copy, Debug)]
pub struct AccelerationStructure {
    /// Name on the command line.
    pub name: &'static str,
    /// What it does, in a line.
    pub description: &'static str,
    /// Key into the bibliography.
    pub source: &'static str,
    /// As a setting.
    pub value: Acceleration,
    /// Whether a ray asks few of many triangles, however they are distributed over objects.
    pub grows_slowly: bool,
}

/// All structures for rays, the default first.
pub static ACCELERATION: &[AccelerationStructure] = &[
    AccelerationStructure {
        name: "bvh",
        description: "a tree of boxes round triangles, cut by the surface area heuristic",
        source: "MacDonald & Booth 1990",
        value: Acceleration::Bvh,
        grows_slowly: true,
    },
    AccelerationStructure {
        name: "octree",
        description: "a cube cut in eight where there is much, and its parts again",
        source: "Glassner 1984",
        value: Acceleration::Octree,
        grows_slowly: true,
    },
    AccelerationStructure {
        name: "bsp",
        description: "a box cut in two across an axis where rays have least to do, and its parts again",
        source: "Kaplan 1985",
        value: Acceleration::Bsp,
        grows_slowly: true,
    },
    AccelerationStructure {
        name: "grid",
        description: "equal cells, which a ray passes one by one",
        source: "Amanatides & Woo 1987",
        value: Acceleration::Grid,
        grows_slowly: true,
    },
    AccelerationStructure {
        name: "box",
        description: "a box along the axes round each object, before its triangles",
        source: "Rubin & Whitted 1980",
        value: Acceleration::Box,
        grows_slowly: false,
    },
    AccelerationStructure {
        name: "oriented-box",
        description: "a box that is turned to fit, round each object",
        source: "Gottschalk, Lin & Manocha 1996",
        value: Acceleration::OrientedBox,
        grows_slowly: false,
    },
    AccelerationStructure {
        name: "sphere",
        description: "a sphere round each object",
        source: "Ritter 1990",
        value: Acceleration::Sphere,
        grows_slowly: false,
    },
    AccelerationStructure {
        name: "none",
        description: "every ray asks every triangle",
        source: "Appel 1968",
        value: Acceleration::None,
        grows_slowly: false,
    },
];

/// A figure sequence of the notes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Panels {
    /// Depths from the light and from the viewer, and how a picture is darkened by them.
    ImageSpace,
    /// What the light sees becomes polygons of the scene.
    ObjectPrecision,
}

/// A way to find shadows.
pub struct Shadowing {
    /// Name on the command line.
    pub name: &'static str,
    /// What it does, in a line.
    pub description: &'static str,
    /// Key into the bibliography.
    pub source: &'static str,
    /// What polygons it works with, if it does, which can be drawn.
    pub polygons: Option<&'static str>,
    /// The notes' figure sequence that shows how it works, if there is one.
    pub panels: Option<Panels>,
    /// The code; `None` for no shadows.
    pub algorithm: Option<&'static dyn ShadowAlgorithm>,
}

/// All shadow algorithms, the default first.
pub static SHADOWS: &[Shadowing] = &[
    Shadowing {
        name: "none",
        description: "every light reaches what faces it",
        source: "Foley et al. 1990",
        polygons: None,
        panels: None,
        algorithm: None,
    },
    Shadowing {
        name: "ray",
        description: "a ray from every point to every light: the reference of the others",
        source: "Appel 1968",
        polygons: None,
        panels: None,
        algorithm: Some(&RayShadows),
    },
    Shadowing {
        name: "map",
        description: "the z-buffer from the light, kept while lights and scene stay (--shadow-map-size, --shadow-cascades)",
        source: "Williams 1978",
        polygons: None,
        panels: Some(Panels::ImageSpace),
        algorithm: Some(&MapShadows),
    },
    Shadowing {
        name: "volume",
        description: "solids behind what keeps light, counted along a path (--volume-counting)",
        source: "Crow 1977",
        polygons: Some("caps and sides of the volumes, as far as the scene is large"),
        panels: None,
        algorithm: Some(&VolumeShadows),
    },
    Shadowing {
        name: "scan-line",
        description: "each line of pixels on a facet is cut where it crosses the shadows on the facet",
        source: "Bouknight & Kelley 1970",
        polygons: Some("shadow polygons, on the polygons that they fall on"),
        panels: None,
        algorithm: Some(&ScanLineShadows),
    },
    Shadowing {
        name: "object-precision",
        description: "facets are cut in lit polygons, as the light sees them, kept while lights and scene stay",
        source: "Atherton, Weiler & Greenberg 1978",
        polygons: Some("lit polygons"),
        panels: Some(Panels::ObjectPrecision),
        algorithm: Some(&ObjectPrecisionShadows),
    },
];

/// A way to find light that comes from other surfaces.
#[derive(Clone, Copy, Debug)]
pub struct GlobalIllumination {
    /// Name on the command line.
    pub name: &'static str,
    /// What it does, in a line.
    pub description: &'static str,
    /// Key into the bibliography.
    pub source: &'static str,
    /// As a setting.
    pub value: Global,
    /// Name of the shadow algorithm that belongs to it, for faces that choose one if the user does not.
    pub shadows: &'static str,
}

/// All global illumination models, the default first.
pub static GLOBALS: &[GlobalIllumination] = &[
    GlobalIllumination {
        name: "none",
        description: "surfaces are lit by lights alone",
        source: "Foley et al. 1990",
        value: Global::None,
        shadows: "none",
    },
    GlobalIllumination {
        name: "ray-trace",
        description: "rays go on where they are mirrored and bent; with ray-traced shadows",
        source: "Whitted 1980",
        value: Global::RayTrace,
        shadows: "ray",
    },
    GlobalIllumination {
        name: "radiosity",
        description: "matt surfaces light each other; solved once for all cameras",
        source: "Cohen et al. 1988",
        value: Global::Radiosity,
        shadows: "ray",
    },
];

/// A shadow algorithm by its name.
pub fn shadows(name: &str) -> Option<&'static Shadowing> {
    SHADOWS.iter().find(|s| s.name == name)
}

/// The algorithm of a row of [`SHADOWS`], by the row's name; `None` without shadows.
pub fn shadow_algorithm(name: &str) -> Option<&'static dyn ShadowAlgorithm> {
    shadows(name).and_then(|row| row.algorithm)
}
