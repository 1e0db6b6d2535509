//! Polygons that another algorithm comes to, on the page: in its own order, overlapping or not, as
//! it cut them.
//!
//! The page is that of [`draw`](crate::draw): the same camera brings a point to the same place.
//! Nothing is decided about visibility here.
//!
//! In:   polygons as shares of the camera's window. Out: regions in the same order and, if wanted,
//!       their outlines as lines, each part once.
//! Cost: linear in corners, and that of [`strokes`](crate::strokes) for lines.

use crate::DrawingSettings;
use crate::fill::{FaceLook, PageRegion, Palette};
use crate::hatch::Cuts;
use crate::layout::{self, Content, STEPS_A_MILLIMETRE};
use crate::lit::{self, LitPolygons, Projector};
use crate::page_mesh::NONE;
use crate::projection::{page_size, source_of_facet};
use crate::run::Run;
use crate::shapes::{Corner, Shapes, area_of, corner_at, on_page, union};
use crate::strokes::{DUST, Stroke, without_coincident};
use vitral_exec::{Budget, Limit, Workers};
use vitral_frame::Drawing;
use vitral_frame::drawing::{LineClass, Region};
use vitral_math::DVec3;
use vitral_scene::{Camera, ViewTransform, World, depth_range};

/// Polygons between two looks at the clock.
const POLYGONS_A_CHECK: usize = 4096;
/// Bytes of a corner in a region.
const BYTES_A_CORNER: u64 = 16;

/// A polygon of a list.
#[derive(Clone, Debug, PartialEq)]
pub struct ListedPolygon {
    /// The facets of the flat polygon that it is a part of, at least one.
    pub facets: Vec<u32>,
    /// Outlines, counter-clockwise round the polygon, clockwise round holes, closed without
    /// repeating the first point. The window of the camera reaches from `[0, 0]`, lower left, to
    /// `[1, 1]`.
    pub outlines: Vec<Vec<[f64; 2]>>,
}

/// Polygons, and whether their regions and outlines are drawn.
pub struct ListedPolygons<'p> {
    /// In the order in which they are painted.
    pub list: Vec<ListedPolygon>,
    /// Gives regions their colours; `None`: no regions.
    pub fill: Option<&'p Palette<'p>>,
    /// The class of lines that outlines become; `None`: no lines.
    pub lines: Option<LineClass>,
    /// Divides the polygons in what each of these lights reaches and what it does not.
    pub lit: &'p [LitPolygons],
}

/// Lays polygons out on the page of a drawing of what `camera` sees in a window of `aspect` (width
/// by height).
///
/// # Errors
/// A limit of the budget.
pub fn draw_polygons(
    world: &World,
    camera: &Camera,
    aspect: f64,
    mut polygons: ListedPolygons<'_>,
    page: &DrawingSettings,
    workers: &Workers,
    budget: &Budget,
) -> Result<Drawing, Limit> {
    // Find the page and the view.
    let run = Run::new(workers, budget);
    let size = page_size(aspect);
    let view = camera.transform(aspect, depth_range(camera, &world.bounds));
    let sides = Sides::new(world, &view);
    let to_page = Projector { clip_from_world: view.clip_from_world(), size: size.map(f64::from) };

    // Bring the polygons to the page.
    let mut regions = Vec::with_capacity(polygons.list.len());
    let list = std::mem::take(&mut polygons.list);
    for (done, polygon) in list.into_iter().enumerate() {
        if done % POLYGONS_A_CHECK == 0 {
            budget.check("polygons on the page")?;
        }
        let corners: usize = polygon.outlines.iter().map(Vec::len).sum();
        run.memory.add(corners as u64 * BYTES_A_CORNER)?;
        let on_page = |p: [f64; 2]| [0, 1].map(|k| p[k] * f64::from(size[k]));
        let rings = polygon
            .outlines
            .into_iter()
            .map(|ring| ring.into_iter().map(on_page).collect())
            .collect();
        sides.add(rings, &polygon.facets, &polygons, &to_page, &mut regions);
    }

    // Draw each part of their outlines once.
    let mut strokes = Vec::new();
    if let Some(class) = polygons.lines {
        for ring in regions.iter().flat_map(|region| &region.rings) {
            let next = ring.iter().cycle().skip(1);
            let sides =
                ring.iter().zip(next).map(|(&p, &q)| Stroke { class, layers: 0, ends: [p, q] });
            strokes.extend(sides.filter(|stroke| stroke.length() >= DUST));
        }
        run.memory.add((strokes.len() * size_of::<Stroke>()) as u64)?;
        strokes = without_coincident(strokes, size, &run)?;
    }

    // Place the regions and lines on the sheet.
    if polygons.fill.is_none() {
        regions.clear();
    }
    let content =
        Content { size, strokes: &strokes, regions: &regions, cuts: &Cuts::default(), points: &[] };
    page.limited(layout::lay_out(&content, page.page, page.margin))
}

/// Tells which side of a face is seen.
struct Sides<'w> {
    world: &'w World,
    perspective: bool,
    eye: DVec3,
    backwards: DVec3,
}

impl<'w> Sides<'w> {
    fn new(world: &'w World, view: &ViewTransform) -> Self {
        let world_from_view = view.view_from_world.inverse();
        let eye = world_from_view.transform_point3(DVec3::ZERO);
        Self {
            world,
            perspective: view.perspective,
            eye,
            backwards: world_from_view.transform_vector3(DVec3::Z),
        }
    }

    /// Adds the regions of a polygon: itself, or its lit and shadowed parts.
    fn add(
        &self,
        rings: Vec<Vec<[f64; 2]>>,
        facets: &[u32],
        polygons: &ListedPolygons<'_>,
        to_page: &Projector,
        regions: &mut Vec<PageRegion>,
    ) {
        // Look up the face's colour.
        let look = self.look(facets[0]);
        let region = |lights: u32, rings: Vec<Vec<[f64; 2]>>| PageRegion {
            surface: look.surface,
            material: look.material.unwrap_or(NONE),
            color: polygons.fill.map_or([0; 3], |palette| palette(&FaceLook { lights, ..look })),
            opacity: 1.0,
            unlit: lit::unlit(lights, polygons.lit),
            rings,
        };

        // Add the polygon as it is, or divided between the lights.
        if polygons.lit.is_empty() {
            regions.push(region(u32::MAX, rings));
            return;
        }
        let shape = rings.iter().map(|ring| ring.iter().map(|&p| corner_at(p)).collect()).collect();
        let facets: Vec<_> =
            facets.iter().map(|&facet| (facet, self.world.corners_of_facet(facet)[0])).collect();
        let parts = lit::divide(vec![shape], &facets, look.normal, polygons.lit, to_page);
        regions.extend(parts.into_iter().map(|(lights, shapes)| {
            let rings =
                shapes.iter().flatten().map(|ring| ring.iter().map(on_page).collect()).collect();
            region(lights, rings)
        }));
    }

    /// What a facet's face shows to a palette.
    fn look(&self, facet: u32) -> FaceLook {
        let source = source_of_facet(self.world, facet);
        let towards = if self.perspective {
            self.eye - self.world.corners_of_facet(facet)[0]
        } else {
            self.backwards
        };
        let is_back = towards.dot(DVec3::from_array(source.normal.map(f64::from))) < 0.0;
        let normal = if is_back { source.normal.map(|c| -c) } else { source.normal };
        let material = Some(source.material).filter(|&m| m != NONE);
        FaceLook { facet, surface: source.surface, material, normal, lights: u32::MAX }
    }
}

/// The area that regions cover together, in square millimetres.
pub fn covered_area(regions: &[Region]) -> f64 {
    let step = |p: &[f64; 2]| {
        let [x, y] = p.map(|at| (at * STEPS_A_MILLIMETRE).round() as i32);
        Corner::new(x, y)
    };
    let outlines = |region: &Region| {
        vec![region.rings.iter().map(|ring| ring.iter().map(step).collect()).collect()]
    };
    let all: Vec<Shapes> = regions.iter().map(outlines).collect();
    area_of(&union(&all, 0)) / (STEPS_A_MILLIMETRE * STEPS_A_MILLIMETRE)
}
