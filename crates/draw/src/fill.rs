//! The visible surface as regions.
//!
//! | step | file |
//! |---|---|
//! | the visible part of each triangle, in layers where it is clear | `fill/visible.rs` |
//! | lit and shadowed parts | `lit.rs` |
//! | colours; parts that look alike and touch become one region | `fill/groups.rs` |
//! | regions reach under those that are painted later | `fill/seams.rs` |
//! | clear layers mixed with the colours behind them | `fill/flatten.rs` |
//!
//! In:   the page's mesh, a grid of the triangles that hide, colours. Out: regions in units of the
//!       page, in the order of painting.
//! Cost: for each triangle `k log k` with `k` triangles in front of it; the union of all parts.

mod flatten;
mod groups;
mod parts;
mod seams;
mod visible;

use crate::grid::Grid;
use crate::lit::{self, LitPolygons, Projector};
use crate::page_mesh::{NONE, PageMesh, Source};
use crate::run::Run;
use groups::Groups;
pub(crate) use parts::PageRegion;
pub use parts::Seams;
use parts::{Look, Part, VisibleParts};
use std::ops::Range;
use visible::{Clipping, Stage, VisibleShapes};
use vitral_exec::{Limit, Spare};
use vitral_math::DVec3;

/// Triangles in one piece of work.
const BATCH: usize = 256;
/// Bytes of a corner of a region, with those of its lists.
const BYTES_A_CORNER: u64 = 24;

/// The properties of a face by which a palette chooses its colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceLook {
    /// Number of the facet in the world.
    pub facet: u32,
    /// Surface id.
    pub surface: u32,
    /// Index into the scene's materials.
    pub material: Option<u32>,
    /// Unit normal on the side that is seen, world space.
    pub normal: [f32; 3],
    /// A bit for each light that reaches the place, by [`LitPolygons::light`]; all bits without
    /// shadows.
    pub lights: u32,
}

/// Gives each face its colour, sRGB.
pub type Palette<'p> = dyn Fn(&FaceLook) -> [u8; 3] + Sync + 'p;

/// How visible surfaces are filled.
#[derive(Clone, Copy)]
pub struct Surfaces<'s> {
    /// The colours.
    pub palette: &'s Palette<'s>,
    /// Opacity of each material, by index, 0 to 1. Materials beyond the end are opaque.
    pub opacities: &'s [f32],
    /// Mix clear layers with the colours behind them, so that every region is opaque.
    pub flatten: bool,
    /// Lit polygons of the lights that cast shadows; the other lights reach everything.
    pub lit: &'s [LitPolygons],
    /// How regions of different colours meet.
    pub seams: Seams,
    /// Each face is a region of its own, whatever its colour.
    pub by_face: bool,
    /// Fill only faces whose surface ids this accepts; the others hide all the same.
    pub only: Option<&'s (dyn Fn(u32) -> bool + Sync)>,
}

impl<'s> Surfaces<'s> {
    /// Opaque surfaces of these colours without shadows.
    pub fn new(palette: &'s Palette<'s>) -> Self {
        Self {
            palette,
            opacities: &[],
            flatten: false,
            lit: &[],
            seams: Seams::default(),
            by_face: false,
            only: None,
        }
    }

    /// The opacity of a material.
    pub(crate) fn opacity(&self, material: u32) -> f32 {
        self.opacities.get(material as usize).copied().unwrap_or(1.0)
    }
}

/// Access from the page's facets to the world.
#[derive(Clone, Copy)]
pub(crate) struct Facets<'f> {
    /// A corner of a facet of the world.
    pub(crate) corner: &'f (dyn Fn(u32) -> DVec3 + Sync),
    pub(crate) to_page: Projector,
}

/// The visible regions in the order in which they are painted.
pub(crate) fn regions(
    mesh: &PageMesh,
    opaque: &Grid,
    surfaces: &Surfaces<'_>,
    facets: &Facets<'_>,
    run: &Run<'_>,
) -> Result<Vec<PageRegion>, Limit> {
    // Find the visible parts.
    let clear = match mesh.triangles.iter().any(|triangle| triangle.clear) {
        true => Some(Grid::new(mesh, |triangle| triangle.clear, run)?),
        false => None,
    };
    let with_contacts = surfaces.seams == Seams::Under;
    let stage = Stage { mesh, opaque, clear: clear.as_ref(), with_contacts };
    let parts = parts(&stage, surfaces, facets, run)?;

    // Join those that look alike.
    let groups = Groups::new(&parts.all);
    let beneath = match surfaces.seams {
        Seams::Under => seams::beneath(mesh, &parts, &groups, run)?,
        Seams::None => vec![Vec::new(); groups.len()],
    };
    let mut joined = groups.joined(&parts.all, &beneath, run)?;
    if surfaces.seams == Seams::Under && !surfaces.by_face {
        joined.splice(0..0, seams::ground(&parts.all, &joined));
    }

    // Flatten clear layers if the page cannot be transparent.
    match surfaces.flatten && clear.is_some() {
        true => flatten::flattened(joined, &groups, &parts.all, surfaces.seams, run),
        false => Ok(joined.iter().flat_map(groups::Joined::regions).collect()),
    }
}

/// The visible parts of all triangles, in order.
fn parts(
    stage: &Stage<'_>,
    surfaces: &Surfaces<'_>,
    facets: &Facets<'_>,
    run: &Run<'_>,
) -> Result<VisibleParts, Limit> {
    let (spare, count) = (Spare::<Clipping>::default(), stage.mesh.triangles.len());
    run.budget.begin("triangles", count as u64);
    let pieces = run.workers.map(count.div_ceil(BATCH), |batch| {
        let range = batch * BATCH..count.min((batch + 1) * BATCH);
        let parts =
            spare.lend(|clipping| parts_of(range, stage, clipping, surfaces, facets, run))?;
        run.budget.check("visible surfaces")?;
        run.budget.progress("visible surfaces", run.budget.achieved().done, count as u64);
        Ok(parts)
    });

    // Put the pieces together.
    let mut parts = VisibleParts::default();
    for piece in pieces {
        let (piece, before): (VisibleParts, _) = (piece?, parts.all.len() as u32);
        parts.all.extend(piece.all);
        parts
            .contacts
            .extend(piece.contacts.into_iter().map(|[part, triangle]| [before + part, triangle]));
    }
    Ok(parts)
}

/// The visible parts of some triangles.
fn parts_of(
    triangles: Range<usize>,
    stage: &Stage<'_>,
    clipping: &mut Clipping,
    surfaces: &Surfaces<'_>,
    facets: &Facets<'_>,
    run: &Run<'_>,
) -> Result<VisibleParts, Limit> {
    let mut parts = VisibleParts::default();
    for t in triangles {
        run.budget.advance();
        let triangle = &stage.mesh.triangles[t];
        let source = &stage.mesh.sources[t];

        // Skip triangles of unwanted surfaces, and those that neither hide nor are clear.
        let is_wanted = surfaces.only.is_none_or(|only| only(source.surface));
        if !is_wanted || (!triangle.hides && !triangle.clear) {
            continue;
        }

        // Find the visible parts of the triangle, layer by layer.
        let VisibleShapes { layers, contacts } = clipping.visible_shapes(stage, t as u32, run)?;

        // Divide each layer between the lights, and colour the parts.
        for (layer, shapes) in
            layers.into_iter().enumerate().filter(|(_, shapes)| !shapes.is_empty())
        {
            let divided = match surfaces.lit.is_empty() {
                true => vec![(u32::MAX, shapes)],
                false => {
                    let normal = normal_seen(triangle.facing, source);
                    let facet = (source.facet, (facets.corner)(source.facet));
                    lit::divide(shapes, &[facet], normal, surfaces.lit, &facets.to_page)
                }
            };

            // Colour the part that each set of lights reaches.
            for (lights, shapes) in divided {
                let corners: usize = shapes.iter().flatten().map(Vec::len).sum();
                run.memory.add(corners as u64 * BYTES_A_CORNER)?;
                let color = (surfaces.palette)(&look(triangle.facing, source, lights));
                // Layers are painted from the deepest to the nearest, over opaque ones.
                let over = if triangle.clear { u32::MAX - layer as u32 } else { 0 };
                let face = if surfaces.by_face { source.surface } else { 0 };
                let opacity = surfaces.opacity(source.material);
                let unlit = lit::unlit(lights, surfaces.lit);
                let look = Look { over, material: source.material, color, opacity, unlit, face };
                let part = parts.all.len() as u32;
                parts.contacts.extend(contacts.iter().map(|&triangle| [part, triangle]));
                parts.all.push(Part { triangle: t as u32, surface: source.surface, look, shapes });
            }
        }
    }
    Ok(parts)
}

/// The look of a face for its palette.
fn look(facing: i8, source: &Source, lights: u32) -> FaceLook {
    let material = Some(source.material).filter(|&m| m != NONE);
    let normal = normal_seen(facing, source);
    FaceLook { facet: source.facet, surface: source.surface, material, normal, lights }
}

/// The normal on the side that is seen.
fn normal_seen(facing: i8, source: &Source) -> [f32; 3] {
    if facing < 0 { source.normal.map(|c| -c) } else { source.normal }
}

#[cfg(test)]
mod tests;
