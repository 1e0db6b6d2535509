//! Floor 3: exact vector drawings of meshes, visible and hidden lines, each with its class, and
//! visible surfaces.
//!
//! All geometry is snapped to an integer grid once; afterwards every decision about visibility is
//! exact. The way of a drawing:
//!
//! | step | file |
//! |---|---|
//! | weld, project, clip, snap | `projection.rs`, `clip.rs` |
//! | edges with all their triangles, and what they are | `edges.rs`, `classes.rs` |
//! | a pyramid of grids over the triangles that hide | `grid.rs` |
//! | lines in which triangles penetrate each other | `crossings.rs` |
//! | for each edge, the parts that triangles hide | `hiding.rs`, `place.rs`, `visibility.rs` |
//! | free points that are visible | `points.rs` |
//! | strokes, of which no two coincide | `strokes.rs` |
//! | the visible surface as regions that do not overlap | `fill.rs` |
//! | hatching on cuts by planes of section | `cuts.rs`, `hatch.rs` |
//! | long polylines on the page | `chains.rs`, `layout.rs` |
//! | several views on one sheet | `sheet/` |
//!
//! Polygons that another algorithm comes to are laid out on the same page (`listed.rs`), divided in
//! lit and shadowed parts if that is wanted (`lit.rs`).
//!
//! Nothing depends on the number of threads.
//!
//! ```
//! use vitral_draw::{DrawingSettings, draw};
//! use vitral_exec::{Budget, Workers};
//! use vitral_scene::{Axis, Lens, Scene, View, World, builtin::solids, frame};
//!
//! let world = World::new(&Scene::from_mesh(solids::cuboid([2.0, 1.0, 1.0].into()))).unwrap();
//! let camera = frame(&world.bounds, View::Front, Axis::PlusY, Lens::Parallel, 1.0);
//! let (settings, workers, budget) = (DrawingSettings::default(), Workers::single(), Budget::default());
//! let drawn = draw(&world, &camera, 1.0, &settings, None, &workers, &budget).unwrap();
//! assert_eq!(drawn.drawing.lines.len(), 1, "a box from the front is one closed line");
//! assert_eq!(drawn.drawing.lines[0].points.len(), 5);
//! ```
#![forbid(unsafe_code)]

mod chains;
mod classes;
mod clip;
mod crossings;
mod cuts;
mod edges;
mod fill;
mod grid;
mod hatch;
mod hiding;
mod layout;
mod listed;
mod lit;
mod page_mesh;
mod place;
mod points;
mod projection;
mod run;
mod shapes;
pub mod sheet;
mod strokes;
#[cfg(test)]
mod testing;
mod visibility;

pub use classes::Classes;
pub use fill::{FaceLook, Palette, Seams, Surfaces};
pub use hatch::Hatch;
pub use layout::PageSize;
pub use listed::{ListedPolygon, ListedPolygons, covered_area, draw_polygons};
pub use lit::LitPolygons;
pub use visibility::VisibilityStats;

use grid::Grid;
use layout::Content;
use page_mesh::{PageMesh, Triangle};
use run::Run;
use visibility::{Search, Wanted, fragments};
use vitral_exec::{Achieved, Budget, Limit, Workers};
use vitral_frame::Drawing;
use vitral_frame::drawing::LineClass;
use vitral_scene::{Camera, World, depth_range};

/// Settings of a drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawingSettings {
    /// Which lines are drawn, if any; an edge of several classes is drawn as the first of these.
    pub lines: Classes,
    /// Lines behind up to so many faces are drawn as well. 0: visible lines alone.
    pub hidden_layers: u32,
    /// Edges at a larger angle are creases, radians.
    pub crease_angle: f64,
    /// Leave out edges between two faces whose normals agree within a degree, unless they are
    /// contours.
    pub hide_tangent: bool,
    /// The most segments that lines and outlines may have in all.
    pub max_segments: Option<u64>,
    /// The sheet.
    pub page: PageSize,
    /// Distance of the drawing from the border of the sheet, millimetres.
    pub margin: f64,
    /// Hatching where planes of section have cut bodies ([`Scene::cut`](vitral_scene::Scene::cut)),
    /// if lines are drawn; `None`: none.
    pub hatch: Option<Hatch>,
    /// Ask all triangles about each edge instead of those near it: the same lines in quadratic
    /// time, to check the grid by.
    pub brute_force: bool,
}

impl Default for DrawingSettings {
    fn default() -> Self {
        Self {
            lines: Classes::USUAL,
            hidden_layers: 0,
            crease_angle: std::f64::consts::FRAC_PI_6,
            hide_tangent: false,
            max_segments: None,
            page: PageSize::default(),
            margin: 5.0,
            hatch: Some(Hatch::default()),
            brute_force: false,
        }
    }
}

/// A drawing and how it came about.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawn {
    /// Lines and regions.
    pub drawing: Drawing,
    /// Counters.
    pub stats: DrawingStats,
}

/// Counters of a drawing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DrawingStats {
    /// Triangles on the page.
    pub triangles: u64,
    /// Of these, triangles that hide surfaces behind them.
    pub hiding_triangles: u64,
    /// Edges of faces, diagonals of polygons included.
    pub edges: u64,
    /// Lines in which two triangles intersect.
    pub intersections: u64,
    /// Parts of edges between changes of visibility.
    pub fragments: u64,
    /// Work of the pass over the edges.
    pub visibility: VisibilityStats,
}

/// Draws what `camera` sees in a window of `aspect` (width by height): lines, and with `surfaces`
/// the visible parts of faces. Faces of materials that let light through hide no lines there.
///
/// # Errors
/// A limit of the budget.
pub fn draw(
    world: &World,
    camera: &Camera,
    aspect: f64,
    settings: &DrawingSettings,
    surfaces: Option<&Surfaces<'_>>,
    workers: &Workers,
    budget: &Budget,
) -> Result<Drawn, Limit> {
    draw_one_sided(world, camera, aspect, settings, surfaces, &[], workers, budget)
}

/// [`draw`] where faces of some materials show their front alone: from behind they hide nothing and
/// are not filled. `front_only` says so of each material, by index; those beyond the end show both
/// sides.
///
/// # Errors
/// A limit of the budget.
pub fn draw_one_sided(
    world: &World,
    camera: &Camera,
    aspect: f64,
    settings: &DrawingSettings,
    surfaces: Option<&Surfaces<'_>>,
    front_only: &[bool],
    workers: &Workers,
    budget: &Budget,
) -> Result<Drawn, Limit> {
    // Project the world and decide which faces hide.
    let run = Run::new(workers, budget);
    let view = camera.transform(aspect, depth_range(camera, &world.bounds));
    let mut projected = projection::project(world, &view, aspect, &run)?;
    if let Some(surfaces) = surfaces {
        projected.let_through(|material| surfaces.opacity(material));
    }
    projected
        .leave_out_backs(|material| front_only.get(material as usize).copied().unwrap_or(false));

    // Join the facets to a mesh of edges, and add the lines of intersection.
    let mut mesh =
        edges::with_edges(projected, settings.crease_angle, settings.hide_tangent, &run)?;
    let caps = cuts::Caps::new(world);
    mesh.ranks = caps.ranks(&mesh);
    let grid = Grid::new(&mesh, |triangle| triangle.hides, &run)?;

    // Count what the mesh holds.
    let mut stats = DrawingStats {
        triangles: mesh.triangles.len() as u64,
        hiding_triangles: mesh.triangles.iter().filter(|triangle| triangle.hides).count() as u64,
        edges: mesh.edges.len() as u64,
        ..DrawingStats::default()
    };
    if settings.lines.has(LineClass::Intersection) {
        stats.intersections = intersect(&mut mesh, &grid, settings.hidden_layers > 0, &run)?;
    }

    // Find the visible fragments of all edges, and join them to strokes.
    let wanted = Wanted {
        classes: settings.lines,
        most_layers: settings.hidden_layers,
        most_segments: settings.max_segments,
    };
    let search = if settings.brute_force { Search::All } else { Search::Grid(&grid) };
    let (fragments, visibility) = fragments(&mesh, search, wanted, &run)?;
    (stats.fragments, stats.visibility) = (fragments.len() as u64, visibility);
    let strokes = strokes::strokes(&mesh, &fragments, settings.lines, &run)?;

    // Find the points, the filled regions and the hatched cuts.
    let points = match settings.lines.has(LineClass::Boundary) {
        true => points::visible_points(&mesh, search, &run)?,
        false => Vec::new(),
    };
    budget.check("lines")?;
    let corner = |facet: u32| world.corners_of_facet(facet)[0];
    let to_page =
        lit::Projector { clip_from_world: view.clip_from_world(), size: mesh.size.map(f64::from) };
    let facets = fill::Facets { corner: &corner, to_page };
    let regions = match surfaces {
        Some(surfaces) => fill::regions(&mesh, &grid, surfaces, &facets, &run)?,
        None => Vec::new(),
    };
    let cuts = match settings.hatch.filter(|_| !settings.lines.is_empty()) {
        Some(hatch) => caps.visible(&mesh, &grid, &facets, hatch, &run)?,
        None => hatch::Cuts::default(),
    };

    // Lay everything out on the sheet.
    let content = Content {
        size: mesh.size,
        strokes: &strokes,
        regions: &regions,
        cuts: &cuts,
        points: &points,
    };
    let drawing = layout::lay_out(&content, settings.page, settings.margin);
    Ok(Drawn { drawing: settings.limited(drawing)?, stats })
}

impl DrawingSettings {
    /// A drawing with no more segments than are allowed.
    pub(crate) fn limited(&self, drawing: Drawing) -> Result<Drawing, Limit> {
        match self.max_segments.filter(|&limit| drawing.segments() > limit) {
            Some(limit) => {
                let achieved =
                    Achieved { done: limit, whole: drawing.segments(), pieces: "segments" };
                Err(Limit::Segments { limit, stage: "the layout", achieved })
            }
            None => Ok(drawing),
        }
    }
}

/// Adds the lines of intersection. Where hidden lines are drawn, back faces of solid bodies have
/// some, too.
fn intersect(
    mesh: &mut PageMesh,
    grid: &Grid,
    with_backs: bool,
    run: &Run<'_>,
) -> Result<u64, Limit> {
    let is_wanted = |triangle: &Triangle| {
        !triangle.is_flat() && (with_backs || triangle.hides || triangle.clear)
    };
    if mesh.triangles.iter().any(|triangle| is_wanted(triangle) && !triangle.hides) {
        let all = Grid::new(mesh, is_wanted, run)?;
        return crossings::add_crossings(mesh, &all, is_wanted, run);
    }
    crossings::add_crossings(mesh, grid, |triangle| triangle.hides, run)
}

#[cfg(test)]
mod tests;
