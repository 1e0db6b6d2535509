//! The one table of algorithms. Command line, documents, tests and other faces iterate over it.
//!
//! It stands on top of all algorithms, and nothing below looks into it: an algorithm that is asked
//! for by name is a [`Choice`](crate::choice::Choice), and the pipeline hands its code in. A new
//! algorithm is a row here.

use crate::catalogue::{
    LIST_PRIORITY, Panels, PolygonOrder, ShadowInfo, Shadows, Visibility, VisibilityInfo,
};
use crate::choice::table;
use crate::shadow::{
    ShadowAlgorithm, map::MapShadows, object_precision::ObjectPrecisionShadows, ray::RayShadows,
    scan_line::ScanLineShadows, volume::VolumeShadows,
};
use crate::trace::legend::Legend;
use crate::visible::{
    PolygonAlgorithm, VisibleSurface, brute_force::BruteForce, bsp::Bsp, painter::Painter,
    ray_cast::RayCast, scanline::ScanLine, warnock::Warnock, weiler_atherton::WeilerAtherton,
    zbuffer::ZBuffer,
};
use crate::{Coherence, Global};

pub use crate::raytrace::structures::ACCELERATION;

/// An algorithm that finds the visible surface at each sample: what is known of it, and its code.
pub struct VisibilityAlgorithm {
    /// What faces list.
    pub info: VisibilityInfo,
    /// The code.
    pub algorithm: &'static dyn VisibleSurface,
    /// The code that gives its polygons, if it comes to some.
    pub polygons: Option<&'static dyn PolygonAlgorithm>,
}

table! {
    /// All visible-surface algorithms, the default first.
    VISIBILITY: VisibilityAlgorithm of VisibilityInfo, "visibility algorithm";

    /// Catmull's z-buffer.
    Z_BUFFER = VisibilityAlgorithm {
        info: VisibilityInfo {
            name: "z-buffer",
            description: "every sample keeps its nearest facet",
            source: "Catmull 1974",
            precision: "image",
            casts_rays: false,
            finds_layers_at_once: false,
            has_edge_table: false,
            coherence: &[Coherence::Object, Coherence::Frame],
            steps: Legend::Cost("opaque facets that cover the pixel"),
            polygons: None,
        },
        algorithm: &ZBuffer,
        polygons: None,
    };
    /// Watkins' scan-line algorithm.
    SCAN_LINE = VisibilityAlgorithm {
        info: VisibilityInfo {
            name: "scan-line",
            description: "line by line, from edge to edge",
            source: "Watkins 1970",
            precision: "image",
            casts_rays: false,
            finds_layers_at_once: false,
            has_edge_table: true,
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
            polygons: None,
        },
        algorithm: &ScanLine,
        polygons: None,
    };
    /// Warnock's area subdivision.
    WARNOCK = VisibilityAlgorithm {
        info: VisibilityInfo {
            name: "warnock",
            description: "windows are cut in four until they are simple",
            source: "Warnock 1969",
            precision: "image",
            casts_rays: false,
            finds_layers_at_once: false,
            has_edge_table: false,
            coherence: &[Coherence::Object, Coherence::Area, Coherence::Depth, Coherence::Frame],
            steps: Legend::Windows,
            polygons: None,
        },
        algorithm: &Warnock,
        polygons: None,
    };
    /// Appel's ray casting.
    RAY_CAST = VisibilityAlgorithm {
        info: VisibilityInfo {
            name: "ray-cast",
            description: "a ray through every sample, and a structure that finds what it meets (--acceleration)",
            source: "Appel 1968",
            precision: "image",
            casts_rays: true,
            finds_layers_at_once: true,
            has_edge_table: false,
            coherence: &[Coherence::Object, Coherence::Area, Coherence::Frame],
            steps: Legend::Cost("boxes or cells and facets that the rays of its block of pixels were tested against"),
            polygons: None,
        },
        algorithm: &RayCast,
        polygons: None,
    };
    /// Every facet against every sample.
    BRUTE_FORCE = VisibilityAlgorithm {
        info: VisibilityInfo {
            name: "brute-force",
            description: "every facet against every sample: slow, the reference of the others",
            source: "Foley et al. 1990",
            precision: "image",
            casts_rays: false,
            finds_layers_at_once: true,
            has_edge_table: false,
            coherence: &[Coherence::Object, Coherence::Frame],
            steps: Legend::Cost("facets that the rays of its block of pixels were tested against"),
            polygons: None,
        },
        algorithm: &BruteForce,
        polygons: None,
    };
    /// The depth-sort of Newell, Newell and Sancha.
    PAINTER = VisibilityAlgorithm {
        info: VisibilityInfo {
            name: "painter",
            description: "polygons sorted by depth are painted over each other",
            source: "Newell, Newell & Sancha 1972",
            precision: LIST_PRIORITY,
            casts_rays: false,
            finds_layers_at_once: false,
            has_edge_table: false,
            coherence: &[Coherence::Object, Coherence::Frame],
            steps: Legend::List,
            polygons: Some(PolygonOrder::BackToFront),
        },
        algorithm: &Painter,
        polygons: Some(&Painter),
    };
    /// The BSP tree of Fuchs, Kedem and Naylor.
    BSP = VisibilityAlgorithm {
        info: VisibilityInfo {
            name: "bsp",
            description: "a tree of planes gives the order from back to front",
            source: "Fuchs, Kedem & Naylor 1980",
            precision: LIST_PRIORITY,
            casts_rays: false,
            finds_layers_at_once: false,
            has_edge_table: false,
            coherence: &[Coherence::Object, Coherence::Frame],
            steps: Legend::List,
            polygons: Some(PolygonOrder::BackToFront),
        },
        algorithm: &Bsp,
        polygons: Some(&Bsp),
    };
    /// Weiler and Atherton's object-precision algorithm.
    WEILER_ATHERTON = VisibilityAlgorithm {
        info: VisibilityInfo {
            name: "weiler-atherton",
            description: "polygons are clipped against each other until only visible ones are left",
            source: "Weiler & Atherton 1977",
            precision: "object",
            casts_rays: false,
            finds_layers_at_once: false,
            has_edge_table: false,
            coherence: &[Coherence::Object, Coherence::Frame],
            steps: Legend::Outlines,
            polygons: Some(PolygonOrder::Disjoint),
        },
        algorithm: &WeilerAtherton,
        polygons: Some(&WeilerAtherton),
    };
}

/// A way to find shadows: what is known of it, and its code.
pub struct Shadowing {
    /// What faces list.
    pub info: ShadowInfo,
    /// The code; `None` for no shadows.
    pub algorithm: Option<&'static dyn ShadowAlgorithm>,
}

table! {
    /// All shadow algorithms, the default first.
    SHADOWS: Shadowing of ShadowInfo, "shadow algorithm";

    /// No shadows.
    NONE = Shadowing {
        info: ShadowInfo {
            is_none: true,
            ..ShadowInfo::new(
                "none",
                "every light reaches what faces it",
                "Foley et al. 1990",
            )
        },
        algorithm: None,
    };
    /// Rays to the lights.
    RAY = Shadowing {
        info: ShadowInfo {
            casts_rays: true,
            ..ShadowInfo::new(
                "ray",
                "a ray from every point to every light: the reference of the others",
                "Appel 1968",
            )
        },
        algorithm: Some(&RayShadows),
    };
    /// Williams' shadow maps.
    MAP = Shadowing {
        info: ShadowInfo {
            draws_maps: true,
            panels: Some(Panels::ImageSpace),
            ..ShadowInfo::new(
                "map",
                "the z-buffer from the light, kept while lights and scene stay (--shadow-map-size, --shadow-cascades)",
                "Williams 1978",
            )
        },
        algorithm: Some(&MapShadows),
    };
    /// Crow's shadow volumes.
    VOLUME = Shadowing {
        info: ShadowInfo {
            counts_volumes: true,
            polygons: Some("caps and sides of the volumes, as far as the scene is large"),
            ..ShadowInfo::new(
                "volume",
                "solids behind what keeps light, counted along a path (--volume-counting)",
                "Crow 1977",
            )
        },
        algorithm: Some(&VolumeShadows),
    };
    /// The scan-line shadows of Bouknight and Kelley.
    SCAN_LINE = Shadowing {
        info: ShadowInfo {
            polygons: Some("shadow polygons, on the polygons that they fall on"),
            ..ShadowInfo::new(
                "scan-line",
                "each line of pixels on a facet is cut where it crosses the shadows on the facet",
                "Bouknight & Kelley 1970",
            )
        },
        algorithm: Some(&ScanLineShadows),
    };
    /// The object-precision shadows of Atherton, Weiler and Greenberg.
    OBJECT_PRECISION = Shadowing {
        info: ShadowInfo {
            polygons: Some("lit polygons"),
            panels: Some(Panels::ObjectPrecision),
            ..ShadowInfo::new(
                "object-precision",
                "facets are cut in lit polygons, as the light sees them, kept while lights and scene stay",
                "Atherton, Weiler & Greenberg 1978",
            )
        },
        algorithm: Some(&ObjectPrecisionShadows),
    };
}

/// A way to find light that comes from other surfaces.
#[derive(Clone, Copy, Debug)]
pub struct GlobalIllumination {
    /// The setting, which knows name and description.
    pub value: Global,
    /// Key into the bibliography.
    pub source: &'static str,
    /// The shadow algorithm that belongs to it, for faces that choose one if the user does not.
    pub shadows: Shadows,
}

/// All global illumination models, the default first.
pub static GLOBALS: &[GlobalIllumination] = &[
    GlobalIllumination { value: Global::None, source: "Foley et al. 1990", shadows: Shadows::NONE },
    GlobalIllumination { value: Global::RayTrace, source: "Whitted 1980", shadows: Shadows::RAY },
    GlobalIllumination {
        value: Global::Radiosity,
        source: "Cohen et al. 1988",
        shadows: Shadows::RAY,
    },
];

/// The code of a visible-surface algorithm.
///
/// # Panics
/// Never: a choice is made of a row.
pub fn visibility(choice: Visibility) -> &'static dyn VisibleSurface {
    let row = VISIBILITY.iter().find(|row| row.name == choice.name);
    row.expect("a choice is made of a row").algorithm
}

/// The code that gives the polygons of a visible-surface algorithm; `None`: it comes to none.
///
/// # Panics
/// Never: a choice is made of a row.
pub fn polygons(choice: Visibility) -> Option<&'static dyn PolygonAlgorithm> {
    let row = VISIBILITY.iter().find(|row| row.name == choice.name);
    row.expect("a choice is made of a row").polygons
}

/// The code of a shadow algorithm; `None` for no shadows.
///
/// # Panics
/// Never: a choice is made of a row.
pub fn shadows(choice: Shadows) -> Option<&'static dyn ShadowAlgorithm> {
    let row = SHADOWS.iter().find(|row| row.name == choice.name);
    row.expect("a choice is made of a row").algorithm
}
