//! What became of the facets whose outline holds a pixel: which stage took each away, or which
//! samples show it.
//!
//! In:   a view before visibility, a pixel, and what was seen at its samples. Out: a [`Candidate`]
//!       for each facet of the scene that the projectors through the pixel meet, in front of the
//!       near plane and beyond the far one, too.
//! Cost: a box test for each run of triangles; a few operations for each facet found.

use crate::PreparedView;
use crate::cull::window::PixelWindow;
use serde::Serialize;
use vitral_math::{DVec3, DVec4};
use vitral_raster::geometry::flag;
use vitral_raster::{Draw, Layer, NO_FACET, SUBPIXEL, Setup, TILE, TILE_PIXELS, Tile};
use vitral_scene::Instance;

/// A plane of the view volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClipPlane {
    /// Left of the picture.
    Left,
    /// Right of it.
    Right,
    /// Below it.
    Bottom,
    /// Above it.
    Top,
    /// Beyond the far plane.
    Far,
    /// In front of the near plane.
    Near,
}

impl ClipPlane {
    /// Each with its bit, see [`flag`].
    const BITS: [(Self, u32); 6] = [
        (Self::Left, flag::LEFT),
        (Self::Right, flag::RIGHT),
        (Self::Bottom, flag::BOTTOM),
        (Self::Top, flag::TOP),
        (Self::Far, flag::FAR),
        (Self::Near, flag::NEAR),
    ];

    /// Those whose bits are set.
    fn of_flags(flags: u32) -> Vec<Self> {
        Self::BITS.iter().filter(|(_, bit)| flags & bit != 0).map(|(plane, _)| *plane).collect()
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
            Self::Bottom => "bottom",
            Self::Top => "top",
            Self::Far => "far",
            Self::Near => "near",
        }
    }
}

/// What became of a facet at a pixel.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "stage")]
pub enum Fate {
    /// Surfaces are not drawn at all in a wireframe.
    NotDrawn,
    /// Frustum culling rejected the box round its object, or round its run of triangles.
    BoxCulled {
        /// The planes beyond which all its corners lie.
        planes: Vec<ClipPlane>,
    },
    /// All its corners lie beyond one plane of the view volume.
    OutsideFrustum {
        /// The planes for which that is so.
        planes: Vec<ClipPlane>,
    },
    /// A corner is not a finite number.
    NotFinite,
    /// It has no area on the grid of 1/256 pixel.
    Degenerate,
    /// It faces away, and nothing of its body can be seen from behind.
    BackFace,
    /// What clipping leaves of it does not reach the pixel.
    ClippedAway {
        /// The planes that cut it.
        planes: Vec<ClipPlane>,
    },
    /// It covers no sample of the pixel.
    BetweenSamples,
    /// Something nearer is seen at each sample that it covers.
    Hidden {
        /// The samples that it covers.
        samples: Vec<u32>,
        /// The facets that are seen there.
        by: Vec<u32>,
    },
    /// It is seen through: nothing opaque is nearer at these samples.
    Layer {
        /// The samples at which it is a layer.
        samples: Vec<u32>,
    },
    /// It is the nearest opaque facet at these samples.
    Visible {
        /// The samples at which it is visible.
        samples: Vec<u32>,
    },
}

/// A facet whose outline holds a pixel.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Candidate {
    /// Id of the facet.
    pub facet: u32,
    /// Its nearest depth at the samples that it covers, 1 near; `None` if there are none.
    pub depth: Option<f32>,
    /// What became of it.
    #[serde(flatten)]
    pub fate: Fate,
}

/// What is seen at the samples of a pixel.
pub(crate) struct SeenPixel<'s> {
    pub tile: &'s Tile,
    pub layers: &'s [Layer],
    /// Its number in the tile.
    pub pixel: usize,
}

impl SeenPixel<'_> {
    fn facet(&self, sample: usize) -> u32 {
        self.tile.facet.get(sample * TILE_PIXELS + self.pixel).copied().unwrap_or(NO_FACET)
    }

    fn is_layer(&self, facet: u32, sample: usize) -> bool {
        let at = (sample * TILE_PIXELS + self.pixel) as u32;
        self.layers.iter().any(|layer| layer.facet == facet && layer.at == at)
    }

    /// Its column and row in the picture.
    fn place(&self) -> [u32; 2] {
        [self.tile.x + (self.pixel % TILE) as u32, self.tile.y + (self.pixel / TILE) as u32]
    }
}

/// How far outside a pixel an outline may lie, in pixels, because corners are snapped.
const SNAPPED: f64 = 2.0 / SUBPIXEL as f64;

/// All facets of the scene whose outlines hold a pixel of `view`, the nearest first; those that
/// cover no sample after them, in the order of the scene.
pub(crate) fn candidates(
    view: &PreparedView<'_>,
    seen: &SeenPixel<'_>,
    wireframe: bool,
) -> Vec<Candidate> {
    let world = &view.session.world;

    // Search all instances, whether they are drawn or not.
    let window = PixelWindow::new(&view.view, view.viewport, seen.place(), 1, SNAPPED);
    let mut found = Vec::new();
    for (index, instance) in world.instances.iter().enumerate() {
        let all = 0..instance.mesh.triangles.len() as u32;
        let bounds = &world.run_bounds[instance.mesh_index as usize];
        let prepared = view.instances.iter().find(|p| p.instance == index);
        let draws = || prepared.iter().flat_map(|p| p.opaque.iter().chain(&p.layered));
        // Judge each triangle whose outline holds the pixel.
        for triangle in window
            .pyramid_of(instance)
            .triangles(&instance.mesh, bounds, &[all])
            .into_iter()
            .flatten()
        {
            let facet = instance.first_facet + triangle;
            let draw = draws().find(|d| d.ranges.iter().any(|range| range.contains(&triangle)));
            let (fate, depth) = match draw {
                Some(draw) => fate(view, draw, facet, seen),
                None if wireframe => (Fate::NotDrawn, None),
                None => (
                    Fate::BoxCulled {
                        planes: ClipPlane::of_flags(common(view.corner_flags(facet))),
                    },
                    None,
                ),
            };
            found.push(Candidate { facet, depth, fate });
        }
    }
    found.sort_by(|a, b| {
        b.depth.unwrap_or(-1.0).total_cmp(&a.depth.unwrap_or(-1.0)).then(a.facet.cmp(&b.facet))
    });
    found
}

/// The flags that all corners have.
fn common([a, b, c]: [u32; 3]) -> u32 {
    a & b & c & flag::FRUSTUM
}

/// What becomes of a facet that a draw holds, and its nearest depth at the samples that it covers.
fn fate(
    view: &PreparedView<'_>,
    draw: &Draw<'_>,
    facet: u32,
    seen: &SeenPixel<'_>,
) -> (Fate, Option<f32>) {
    // Test what culling and clipping test, in their order.
    let flags = view.corner_flags(facet);
    let any = flags[0] | flags[1] | flags[2];
    if any & flag::NOT_FINITE != 0 {
        return (Fate::NotFinite, None);
    }
    if common(flags) != 0 {
        return (Fate::OutsideFrustum { planes: ClipPlane::of_flags(common(flags)) }, None);
    }
    let batch = view.set_up(facet, draw.back_faces);
    let cutting = ClipPlane::of_flags(any & (flag::NEAR | flag::FAR));
    let counted = &batch.counters;
    if counted.back_facing > 0 {
        return (Fate::BackFace, None);
    }
    if counted.degenerate > 0 {
        return (Fate::Degenerate, None);
    }
    if counted.outside > 0 {
        return (Fate::ClippedAway { planes: cutting }, None);
    }

    // Which samples does it cover, and who is seen there?
    let places = sample_places(view, seen.place());
    let depth_at = |[x, y]: [i32; 2]| {
        let covering = batch.setups().iter().filter(|s: &&Setup| s.covers(x, y));
        covering.map(|s| s.depth(x, y)).reduce(f32::max)
    };
    let depths: Vec<Option<f32>> = places.iter().map(|&place| depth_at(place)).collect();
    let covered: Vec<usize> = (0..places.len()).filter(|&s| depths[s].is_some()).collect();
    let nearest = depths.iter().flatten().copied().reduce(f32::max);
    if covered.is_empty() {
        let instance = &view.session.world.instances[view.session.world.instance_of_facet(facet)];
        let was_there =
            !cutting.is_empty() && places.iter().any(|&place| meets(view, instance, facet, place));
        let fate =
            if was_there { Fate::ClippedAway { planes: cutting } } else { Fate::BetweenSamples };
        return (fate, None);
    }

    // Tell who is seen at the covered samples: the facet itself, or layers and others in front.
    let numbers = |samples: &[usize]| samples.iter().map(|&s| s as u32).collect::<Vec<_>>();
    let visible: Vec<usize> = covered.iter().copied().filter(|&s| seen.facet(s) == facet).collect();
    if !visible.is_empty() {
        return (Fate::Visible { samples: numbers(&visible) }, nearest);
    }
    let passed: Vec<usize> = covered.iter().copied().filter(|&s| seen.is_layer(facet, s)).collect();
    if !passed.is_empty() {
        return (Fate::Layer { samples: numbers(&passed) }, nearest);
    }
    let mut by: Vec<u32> =
        covered.iter().map(|&s| seen.facet(s)).filter(|&f| f != NO_FACET).collect();
    by.sort_unstable();
    by.dedup();
    (Fate::Hidden { samples: numbers(&covered), by }, nearest)
}

/// Where the samples of a pixel lie, 1/256 pixel.
fn sample_places(view: &PreparedView<'_>, pixel: [u32; 2]) -> Vec<[i32; 2]> {
    let place = |s: usize| {
        let offset = view.pattern.position(s);
        [0, 1].map(|k| pixel[k] as i32 * SUBPIXEL + offset[k])
    };
    (0..view.pattern.len()).map(place).collect()
}

/// Whether the projector through a place on the screen, 1/256 pixel, meets a facet before it is
/// clipped.
fn meets(view: &PreparedView<'_>, instance: &Instance, facet: u32, place: [i32; 2]) -> bool {
    let size = [view.viewport.width, view.viewport.height].map(f64::from);
    let at = place.map(|p| f64::from(p) / f64::from(SUBPIXEL));
    let ndc = [2.0 * at[0] / size[0] - 1.0, 1.0 - 2.0 * at[1] / size[1]];
    let clip_from_model = view.view.clip_from_world() * instance.world_from_model;
    let corners = crate::cull::window::corners(&instance.mesh, facet - instance.first_facet);
    // Homogeneous and sheared so that the projector is the axis: its side of each edge, seen from
    // the eye.
    let sheared = corners.map(|p: DVec3| {
        let clip: DVec4 = clip_from_model * p.extend(1.0);
        DVec3::new(clip.x - ndc[0] * clip.w, clip.y - ndc[1] * clip.w, clip.w)
    });
    let [a, b, c] = sheared;
    let side = |p: DVec3, q: DVec3| p.x * q.y - p.y * q.x;
    let weights = [side(b, c), side(c, a), side(a, b)];
    let total: f64 = weights.iter().sum();
    let w = weights[0] * a.z + weights[1] * b.z + weights[2] * c.z;
    total != 0.0 && weights.iter().all(|v| v * total >= 0.0) && w / total > 0.0
}

/// The facets of a view that cover a place of the screen, 1/256 pixel, with their depths there and
/// whether they are layers; the nearest first.
pub fn facets_at(view: &PreparedView<'_>, [x, y]: [i32; 2]) -> Vec<(u32, f32, bool)> {
    // Find the triangles near the pixel.
    let world = &view.session.world;
    let pixel = [x, y].map(|v| v.div_euclid(SUBPIXEL) as u32);
    let window = PixelWindow::new(&view.view, view.viewport, pixel, 1, SNAPPED);
    let mut found = Vec::new();
    for prepared in &view.instances {
        let instance = &world.instances[prepared.instance];
        let (pyramid, bounds) =
            (window.pyramid_of(instance), &world.run_bounds[instance.mesh_index as usize]);
        let opaque = prepared.opaque.iter().map(|draw| (false, draw));
        for (is_layer, draw) in opaque.chain(prepared.layered.iter().map(|draw| (true, draw))) {
            // Keep those that cover the position.
            for triangle in
                pyramid.triangles(&instance.mesh, bounds, &draw.ranges).into_iter().flatten()
            {
                let facet = draw.first_facet + triangle;
                let setups = view.setups(facet, draw.back_faces);
                if let Some(setup) = setups.iter().find(|setup| setup.covers(x, y)) {
                    found.push((facet, setup.depth(x, y), is_layer));
                }
            }
        }
    }

    // Sort by depth, then by facet.
    found.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    found
}
