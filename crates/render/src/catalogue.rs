//! The catalogue: what is known of each algorithm besides its code.
//!
//! Faces list it, and settings are checked by its flags. Which algorithms there are, and their
//! code, is in the [`registry`](crate::registry), which stands above all of them.

use crate::Coherence;
use crate::choice::Choice;
use crate::trace::legend::Legend;

/// What finds the visible surface at each sample.
pub type Visibility = Choice<VisibilityInfo>;

/// What finds the triangles near a ray. It does not change the picture.
pub type Acceleration = Choice<AccelerationInfo>;

/// What finds shadows.
pub type Shadows = Choice<ShadowInfo>;

/// What is known of an algorithm that finds the visible surface at each sample.
#[derive(Clone, Copy, Debug)]
pub struct VisibilityInfo {
    /// Name on the command line.
    pub name: &'static str,
    /// What it does, in a line.
    pub description: &'static str,
    /// Key into the bibliography.
    pub source: &'static str,
    /// `image`, `list-priority` or `object` precision.
    pub precision: &'static str,
    /// Whether it follows rays, so that [`Acceleration`] is a choice.
    pub casts_rays: bool,
    /// Whether it finds all transparent layers of a sample at once, and not pass by pass.
    pub finds_layers_at_once: bool,
    /// Whether it goes through the picture line by line, with an edge table.
    pub has_edge_table: bool,
    /// Kinds of coherence that it exploits and that can be switched off.
    pub coherence: &'static [Coherence],
    /// What its picture of steps shows.
    pub steps: Legend,
    /// How the polygons that it comes to before it looks at samples make a drawing; `None`: it
    /// comes to none.
    pub polygons: Option<PolygonOrder>,
}

/// How a list of polygons makes a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PolygonOrder {
    /// From back to front: what comes later covers what came before.
    BackToFront,
    /// In any order: they are what is visible, and do not overlap.
    Disjoint,
}

impl VisibilityInfo {
    /// Whether it makes a list of polygons from back to front, which transparent ones can be drawn
    /// by.
    pub fn makes_list(&self) -> bool {
        self.precision == LIST_PRIORITY
    }
}

/// The precision of algorithms that make a list.
pub(crate) const LIST_PRIORITY: &str = "list-priority";

/// What is known of a structure that finds the triangles near a ray.
#[derive(Clone, Copy, Debug)]
pub struct AccelerationInfo {
    /// Name on the command line.
    pub name: &'static str,
    /// What it does, in a line.
    pub description: &'static str,
    /// Key into the bibliography.
    pub source: &'static str,
    /// Whether a ray asks few of many triangles, however they are distributed over objects.
    pub grows_slowly: bool,
    /// Whether a ray asks every triangle.
    pub asks_all: bool,
}

/// A figure sequence of the notes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Panels {
    /// Depths from the light and from the viewer, and how a picture is darkened by them.
    ImageSpace,
    /// What the light sees becomes polygons of the scene.
    ObjectPrecision,
}

/// What is known of a way to find shadows.
#[derive(Clone, Copy, Debug)]
pub struct ShadowInfo {
    /// Name on the command line.
    pub name: &'static str,
    /// What it does, in a line.
    pub description: &'static str,
    /// Key into the bibliography.
    pub source: &'static str,
    /// Whether no shadows are found.
    pub is_none: bool,
    /// Whether it follows rays, so that [`Acceleration`] is a choice.
    pub casts_rays: bool,
    /// Whether it draws shadow maps, whose size and number are choices.
    pub draws_maps: bool,
    /// Whether it counts shadow volumes, and from where is a choice.
    pub counts_volumes: bool,
    /// What polygons it works with, if it does, which can be drawn.
    pub polygons: Option<&'static str>,
    /// The notes' figure sequence that shows how it works, if there is one.
    pub panels: Option<Panels>,
}

impl ShadowInfo {
    /// A way to find shadows that needs nothing but what all have.
    pub(crate) const fn new(
        name: &'static str,
        description: &'static str,
        source: &'static str,
    ) -> Self {
        Self {
            name,
            description,
            source,
            is_none: false,
            casts_rays: false,
            draws_maps: false,
            counts_volumes: false,
            polygons: None,
            panels: None,
        }
    }
}
