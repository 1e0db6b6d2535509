//! One pixel explained: which facets lie over it and what became of each, how its light adds up to
//! its bytes, and what algorithms decided and why.
//!
//! Facets and light are those of the colour picture, with all its samples. Surfaces and decisions
//! are those at the pixel's centre, as in the channels of data. These look straight on, through
//! what is transparent; with ray tracing, the pixel's rays tell what is seen in mirrors and through
//! what bends light.
//!
//! Only the tile that holds the pixel is made, of the facets that may touch it; it is what it is in
//! the whole picture. Whole pictures are made for algorithms that are asked for by name
//! ([`Deciders::Named`]), and where translucent materials are in view.

mod corner_normals;
mod gouraud;
mod spaces;
mod text;

pub use corner_normals::{CornerNormal, NormalOfFace, corner_normals};
pub use gouraud::{Gouraud, GouraudEdge, GouraudLine};
pub use spaces::{FacetSpaces, facet_outlines, spaces};

use crate::bench::Entrant;
use crate::{Error, Renderer};
use serde::Serialize;
use std::sync::{Arc, Mutex};
use vitral_exec::Budget;
use vitral_raster::{NO_FACET, SUBPIXEL, SamplePattern, TILE, TileGrid};
use vitral_render::registry::VISIBILITY;
use vitral_render::shading::pixel_light::PixelLight;
use vitral_render::stats::CullCounters;
use vitral_render::trace::{Observer, Step, Way};
use vitral_render::visible::NullSink;
use vitral_render::visible::fates::{Candidate, facets_at};
use vitral_render::{
    Channels, ExaminedPixel, Execution, Global, PreparedView, Session, Settings, Shading,
    examine_pixel,
};
use vitral_scene::Camera;

/// Steps that are kept of one algorithm.
const MOST_STEPS: usize = 200;
/// Rays, and turns of rays, that are kept.
const MOST_RAYS: usize = 2000;

/// A pixel, and what is known of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Explanation {
    /// Column and row, from the top left.
    pub pixel: [u32; 2],
    /// Its colour in the picture, display bytes with straight opacity.
    pub bytes: [u8; 4],
    /// The facets whose outlines hold it, and what became of each: those that cover samples first,
    /// from near to far.
    pub candidates: Vec<Overlying>,
    /// How its colour comes about. In a picture with ray tracing, or of translucent materials,
    /// light from behind them comes on top.
    pub light: PixelLight,
    /// The surfaces that cover its centre, the nearest first.
    pub surfaces: Vec<Surface>,
    /// The normals at the corners of the nearest surface's facet; empty on the background.
    pub normals: Vec<CornerNormal>,
    /// How Gouraud's shading gets the nearest surface's intensity, with that shading.
    pub gouraud: Option<Gouraud>,
    /// What algorithms decided.
    pub decisions: Vec<Decision>,
    /// With ray tracing, the rays of the pixel, generation by generation, the eye's first; empty
    /// where the first surface is neither a mirror nor transparent, and all there is to see.
    pub rays: Vec<TracedRay>,
}

/// A facet whose outline holds the pixel.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Overlying {
    /// The facet, and what became of it.
    #[serde(flatten)]
    pub candidate: Candidate,
    /// The face of the file that it is of, as in the channel `id`.
    pub surface: u32,
    /// Name of its mesh.
    pub mesh: String,
    /// Name of its material, if it has one.
    pub material: Option<String>,
}

/// Which algorithms are asked to decide about a pixel.
#[derive(Clone, Debug)]
pub enum Deciders {
    /// The one that the settings choose, of the pixel's tile.
    Chosen,
    /// These, each with the whole picture.
    Named(Vec<Entrant>),
}

/// A ray that was followed for the pixel.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct TracedRay {
    /// Turns that it took before: mirrored, bent or scattered.
    pub turns: u32,
    /// Where it starts, world space.
    pub origin: [f64; 3],
    /// Where it goes, unit.
    pub direction: [f64; 3],
    /// What it meets; none: the background.
    pub meets: Option<MetSurface>,
    /// How red, green and blue of what it meets count in the pixel.
    pub weight: [f32; 3],
    /// What that adds to the pixel by its own light, before it is encoded.
    pub light: [f32; 3],
    /// The rays that go on from there.
    pub goes_on: Vec<Turn>,
}

/// What a ray meets.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct MetSurface {
    /// Id of the facet, counted over all instances.
    pub facet: u32,
    /// The face of the file that it is of, as in the channel `id`.
    pub surface: u32,
    /// Name of its mesh.
    pub mesh: String,
    /// Name of its material, if it has one.
    pub material: Option<String>,
    /// How far away it is.
    pub distance: f64,
}

/// How a ray goes on.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Turn {
    /// Which way.
    pub way: Way,
    /// Angles between the normal and the ray before and after.
    #[serde(rename = "angles")]
    pub angles_degrees: [f64; 2],
    /// Indices of refraction of what it comes from and what it goes on in.
    pub indices: [f32; 2],
    /// Where it goes, unit, world space.
    pub direction: [f64; 3],
    /// How red, green and blue of what it will meet count in the pixel.
    pub weight: [f32; 3],
}

/// A facet over the pixel's centre.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Surface {
    /// The facet: a triangle of the scene.
    pub facet: u32,
    /// The face of the file that it is of, as in the channel `id`.
    pub surface: u32,
    /// Name of its mesh.
    pub mesh: String,
    /// Name of its material, if it has one.
    pub material: Option<String>,
    /// 1 on the near plane, 0 on the far plane.
    pub depth: f32,
    /// Something behind it may be seen through it: a layer, which hides nothing.
    pub layer: bool,
}

/// What an algorithm decided.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Decision {
    /// The algorithm, with its structure.
    pub algorithm: String,
    /// The opaque facet that is seen, none for the background.
    pub facet: Option<u32>,
    /// Its depth: 1 on the near plane, 0 on the far plane.
    pub depth: Option<f32>,
    /// The steps that concerned the pixel, in the order they came.
    pub steps: Vec<String>,
    /// The limit at which it gave up.
    pub limit: Option<String>,
}

/// Keeps the steps that concern a pixel.
#[derive(Debug)]
struct Onlooker {
    pixel: [u32; 2],
    steps: Mutex<Vec<String>>,
}

/// Keeps the rays of a pixel.
#[derive(Debug)]
struct RayOnlooker {
    pixel: [u32; 2],
    rays: Mutex<Vec<Step>>,
}

impl Observer for RayOnlooker {
    fn step(&self, step: &Step) {
        if matches!(step, Step::RayMeets { .. } | Step::RayGoesOn { .. })
            && step.concerns(self.pixel)
        {
            let mut rays = self.rays.lock().expect("no thread panics while it keeps a ray");
            if rays.len() < MOST_RAYS {
                rays.push(step.clone());
            }
        }
    }
}

impl Observer for Onlooker {
    fn step(&self, step: &Step) {
        // The comparisons of the pixel say it all.
        if step.concerns(self.pixel) && !matches!(step, Step::Drawn { .. }) {
            let mut steps = self.steps.lock().expect("no thread panics while it keeps a step");
            if steps.len() < MOST_STEPS {
                steps.push(step.describe(self.pixel));
            }
        }
    }

    fn watches(&self, pixel: [u32; 2]) -> bool {
        pixel == self.pixel
    }
}

/// Explains a pixel of the picture that `camera` sees. Each algorithm that is asked may take
/// `time_limit` seconds.
///
/// # Errors
/// A pixel outside the picture, settings that cannot be, or a cancellation.
pub fn explain(
    renderer: &Renderer,
    camera: &Camera,
    pixel: [u32; 2],
    deciders: &Deciders,
    time_limit: Option<f64>,
) -> Result<Explanation, Error> {
    // Check that the pixel lies in the picture.
    let settings = &renderer.picture_settings();
    if pixel[0] >= settings.picture.width || pixel[1] >= settings.picture.height {
        let size = format!(
            "the picture has {} x {} pixels, counted from 0",
            settings.picture.width, settings.picture.height
        );
        return Err(Error::usage(format!("there is no pixel {},{}", pixel[0], pixel[1]), size));
    }

    // The limit is each algorithm's; what remains of the whole is that the user may cancel.
    let budget = renderer.execution().budget.renewed().with_time_limit(None);
    let examined = examined(
        renderer,
        camera,
        pixel,
        settings,
        &budget.clone().with_time_limit(time_limit),
        None,
    )?;

    // Find the surfaces over the pixel's centre, and interpolate Gouraud's colours on the nearest.
    let surfaces = surfaces(renderer, camera, pixel)?;
    let normals = surfaces.first().map(|s| corner_normals(renderer, s.facet)).transpose()?;
    let normals = normals.map_or(Vec::new(), Vec::from);
    let nearest = surfaces.first().filter(|_| settings.shading.model == Shading::Gouraud);
    let gouraud =
        nearest.map_or(Ok(None), |s| gouraud::gouraud(renderer, camera, pixel, s.facet))?;

    // Let each algorithm decide the pixel.
    let (entrants, tile_only) = match deciders {
        Deciders::Chosen => (chosen(settings), true),
        Deciders::Named(entrants) => (entrants.clone(), false),
    };
    let mut decisions = Vec::new();
    for entrant in entrants {
        decisions.push(decide(renderer, camera, pixel, &entrant, tile_only, time_limit)?);
        budget.check("explaining a pixel").map_err(vitral_render::Error::from)?;
    }

    // Follow the pixel's rays.
    let rays = match settings.global.model {
        Global::RayTrace => rays(renderer, camera, pixel, &budget.with_time_limit(time_limit))?,
        Global::None | Global::Radiosity => Vec::new(),
    };

    // Name the surface, mesh and material of each candidate.
    let overlying = |candidate: Candidate| {
        let (surface, mesh, material) = named(renderer.session(), candidate.facet);
        Overlying { candidate, surface, mesh, material }
    };
    let ExaminedPixel { candidates, light, bytes } = examined;
    let candidates = candidates.into_iter().map(overlying).collect();
    Ok(Explanation { pixel, bytes, candidates, light, surfaces, normals, gouraud, decisions, rays })
}

/// The algorithm that the settings choose.
fn chosen(settings: &Settings) -> Vec<Entrant> {
    let algorithms = VISIBILITY.iter().filter(|a| a.choice() == settings.visibility);
    algorithms.map(|algorithm| Entrant { algorithm, acceleration: settings.acceleration }).collect()
}

/// Makes the pixel's tile and takes the pixel apart; `observer` looks on.
fn examined(
    renderer: &Renderer,
    camera: &Camera,
    pixel: [u32; 2],
    settings: &Settings,
    budget: &Budget,
    observer: Option<Arc<dyn Observer>>,
) -> Result<ExaminedPixel, Error> {
    let execution = Execution { budget: budget.clone(), observer, ..renderer.execution().clone() };
    let lights = renderer.frame_lights(camera);
    let shot = renderer.shot(camera, &lights);
    Ok(examine_pixel(renderer.session(), &shot, settings, &execution, pixel)?)
}

/// Traces the rays through the centres of a tile's pixels, and looks on at one of them.
fn rays(
    renderer: &Renderer,
    camera: &Camera,
    pixel: [u32; 2],
    budget: &Budget,
) -> Result<Vec<TracedRay>, Error> {
    let settings = renderer.picture_settings().with_samples(1).with_channels(Channels::default());
    let onlooker = Arc::new(RayOnlooker { pixel, rays: Mutex::default() });
    let observer = Some(Arc::clone(&onlooker) as Arc<dyn Observer>);
    examined(renderer, camera, pixel, &settings, budget, observer)?;

    let steps =
        std::mem::take(&mut *onlooker.rays.lock().expect("no thread panics while it keeps a ray"));
    let mut rays: Vec<TracedRay> = Vec::new();
    for step in steps {
        match step {
            Step::RayMeets { turns, facet, origin, direction, distance, weight, light, .. } => {
                let meets = facet
                    .zip(distance)
                    .map(|(facet, distance)| met(renderer.session(), facet, distance));
                rays.push(TracedRay {
                    turns,
                    origin,
                    direction,
                    meets,
                    weight,
                    light,
                    goes_on: Vec::new(),
                });
            }
            Step::RayGoesOn { way, angles, indices, direction, weight, .. } => {
                let turn = Turn { way, angles_degrees: angles, indices, direction, weight };
                rays.last_mut().into_iter().for_each(|ray| ray.goes_on.push(turn.clone()));
            }
            _ => {}
        }
    }
    Ok(rays)
}

fn met(session: &Session, facet: u32, distance: f64) -> MetSurface {
    let (surface, mesh, material) = named(session, facet);
    MetSurface { facet, surface, mesh, material, distance }
}

/// What a facet belongs to.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct FacetNames {
    /// The face of the file that it is of, as in the channel `id`.
    pub surface: u32,
    /// Name of its mesh.
    pub mesh: String,
    /// Name of its material, if it has one.
    pub material: Option<String>,
}

/// What a facet belongs to.
///
/// # Errors
/// A facet that the scene has not.
pub fn facet_names(renderer: &Renderer, facet: u32) -> Result<FacetNames, Error> {
    spaces::check_facet(renderer.world(), facet)?;
    let (surface, mesh, material) = named(renderer.session(), facet);
    Ok(FacetNames { surface, mesh, material })
}

/// The face of a facet, and the names of its mesh and material.
fn named(session: &Session, facet: u32) -> (u32, String, Option<String>) {
    let world = session.world();
    let instance = &world.instances[world.instance_of_facet(facet)];
    let material = instance.mesh.material_of_triangle((facet - instance.first_facet) as usize);
    let material = material.and_then(|m| session.scene().materials.get(m as usize));
    (world.surface_of_facet(facet), instance.mesh.name.clone(), material.map(|m| m.name.clone()))
}

/// A facet over the centre of a pixel, and its depth there: 1 on the near plane, 0 on the far
/// plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacetDepth {
    /// Id of the facet, counted over all instances.
    pub facet: u32,
    /// Its depth.
    pub depth: f32,
}

/// The facets over the centres of a square of pixels, the nearest first, row by row: `size` by
/// `size` pixels from `corner`, the top left one. Outside of the picture there are none.
///
/// # Errors
/// Settings that cannot be.
pub fn facets_over(
    renderer: &Renderer,
    camera: &Camera,
    corner: [i64; 2],
    size: u32,
) -> Result<Vec<Vec<FacetDepth>>, Error> {
    let view = renderer.prepared(camera, &mut CullCounters::default())?;
    let picture =
        [renderer.settings.picture.width, renderer.settings.picture.height].map(i64::from);
    let mut all = Vec::with_capacity((size * size) as usize);
    for row in 0..i64::from(size) {
        for column in 0..i64::from(size) {
            let place = [corner[0] + column, corner[1] + row];
            let is_inside = (0..2).all(|k| (0..picture[k]).contains(&place[k]));
            let found = if is_inside {
                facets_at(&view, center(&view, place.map(|v| v as u32)))
            } else {
                Vec::new()
            };
            all.push(
                found.into_iter().map(|(facet, depth, _)| FacetDepth { facet, depth }).collect(),
            );
        }
    }
    Ok(all)
}

/// The surfaces over the pixel's centre.
fn surfaces(renderer: &Renderer, camera: &Camera, pixel: [u32; 2]) -> Result<Vec<Surface>, Error> {
    let view = renderer.prepared(camera, &mut CullCounters::default())?;
    let session = renderer.session();
    let surface = |(facet, depth, layer)| {
        let (surface, mesh, material) = named(session, facet);
        Surface { facet, surface, mesh, material, depth, layer }
    };
    Ok(facets_at(&view, center(&view, pixel)).into_iter().map(surface).collect())
}

/// The place of a pixel's sample, 1/256 pixel.
fn center(view: &PreparedView<'_>, pixel: [u32; 2]) -> [i32; 2] {
    let offset = view.pattern.position(0);
    [0, 1].map(|k| pixel[k] as i32 * SUBPIXEL + offset[k])
}

/// Lets an algorithm make the picture, or the pixel's tile of it, and looks on.
fn decide(
    renderer: &Renderer,
    camera: &Camera,
    pixel: [u32; 2],
    entrant: &Entrant,
    tile_only: bool,
    time_limit: Option<f64>,
) -> Result<Decision, Error> {
    // Set up the entrant's settings, an observer and a budget.
    let settings = Settings { coherence: None, ..entrant.settings(&renderer.settings) };
    let viewport = settings.check().map_err(vitral_render::Error::from)?;
    let onlooker = Arc::new(Onlooker { pixel, steps: Mutex::default() });
    let own = renderer.execution();
    let budget = own.budget.renewed().with_time_limit(time_limit);
    let execution = Execution {
        budget,
        observer: Some(Arc::clone(&onlooker) as Arc<dyn Observer>),
        ..own.clone()
    };

    // Prepare the view, limited to the pixel's tile where that is enough.
    let session: &Session = renderer.session();
    let culled = &mut CullCounters::default();
    let mut view = PreparedView::new(
        session,
        camera,
        &settings,
        viewport,
        SamplePattern::new(1),
        &execution,
        culled,
    );
    if tile_only {
        let [column, row] = pixel.map(|v| v / TILE as u32);
        view.limit_to_tile((row * viewport.tiles_x() + column) as usize);
    }

    // Resolve visibility, and look up the pixel's sample.
    let mut grid = TileGrid::new(viewport, 1);
    let resolved =
        entrant.algorithm.algorithm.resolve(&view, None, &mut grid, &execution, &NullSink);
    let (tile, at) = grid.locate(pixel[0], pixel[1]);
    let seen = resolved.is_ok() && tile.facet[at] != NO_FACET;

    // Report the visible facet and the steps, or the limit that ended the algorithm.
    let steps = std::mem::take(
        &mut *onlooker.steps.lock().expect("no thread panics while it keeps a step"),
    );
    Ok(Decision {
        algorithm: entrant.name(),
        facet: seen.then(|| tile.facet[at]),
        depth: seen.then(|| tile.depth[at]),
        steps,
        limit: resolved.err().map(|limit| limit.to_string()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load_builtin;

    #[test]
    fn the_nearest_surface_is_what_every_algorithm_sees_and_says_why() {
        let mut renderer = Renderer::new(load_builtin("cubs").unwrap()).unwrap();
        (renderer.settings.picture.width, renderer.settings.picture.height) = (64, 48);
        renderer.settings.cull.back_face = false;
        let camera = renderer.frame_camera();
        let told =
            explain(&renderer, &camera, [32, 20], &Deciders::Named(Entrant::all()), None).unwrap();
        assert!(told.surfaces.len() >= 2, "front and back of a cube: {told}");
        assert!(told.surfaces.windows(2).all(|w| w[0].depth >= w[1].depth));
        for d in &told.decisions {
            assert_eq!(
                (d.facet, d.depth),
                (Some(told.surfaces[0].facet), Some(told.surfaces[0].depth)),
                "{told}"
            );
            assert!(!d.steps.is_empty(), "{} says why: {told}", d.algorithm);
        }
        let nothing = explain(&renderer, &camera, [0, 0], &Deciders::Chosen, None).unwrap();
        assert!(nothing.surfaces.is_empty() && nothing.decisions.iter().all(|d| d.facet.is_none()));
        assert!(explain(&renderer, &camera, [64, 0], &Deciders::Chosen, None).is_err());
    }
}
