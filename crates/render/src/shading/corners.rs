//! What illumination makes of the corners of facets, for whoever wants to see that stage.
//!
//! Pictures illuminate visible points, after visibility. Here the corners of facets go through the
//! same formulas, textures and shadows, seen or not, each as part of its facet: that is where
//! Gouraud's shading takes its intensities.
//!
//! In:   a prepared view. Out: a colour for each corner of the facets that culling left.
//! Cost: three points a facet.

use super::FrameConstants;
use super::hits::Hit;
use super::points::Points;
use super::shade::shade_hits;
use super::shaded_points::ShadedPoints;
use crate::PreparedView;
use crate::raytrace::triangles::Triangles;
use crate::shadow::{self, SurfacePoint};
use vitral_exec::{Budget, Limit};
use vitral_math::lanes::dispatch;
use vitral_math::{DVec3, DVec4};

/// A corner of a facet, illuminated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LitCorner {
    /// The facet.
    pub facet: u32,
    /// Which of its corners.
    pub corner: u8,
    /// Where it is, world space.
    pub world: DVec3,
    /// Where it is, view space.
    pub view: DVec3,
    /// Its colour, premultiplied RGBA; linear, or the course's numbers in the raw colour space.
    pub color: [f32; 4],
}

/// Facets that are illuminated together.
const FACETS_AT_ONCE: usize = 4096;

/// Shadow asks about a place this much inside the facet, by weight: on an edge it would be decided
/// by rounding.
const INSIDE: f32 = 1.0 / 4096.0;

/// Illuminates the corners of `facets`.
pub(crate) fn lit_corners(
    facets: &[u32],
    constants: &FrameConstants<'_>,
    budget: &Budget,
) -> Result<Vec<LitCorner>, Limit> {
    let mut corners = Vec::with_capacity(3 * facets.len());
    let (mut points, mut lit, mut hits) = (Points::default(), ShadedPoints::default(), Vec::new());
    for facets in facets.chunks(FACETS_AT_ONCE) {
        budget.check("illuminating corners")?;
        hits.clear();
        let first = corners.len();
        for &facet in facets {
            of_facet(facet, constants, &mut hits, &mut corners);
        }
        points.collect_facets(hits.iter().map(|hit: &Hit| hit.place.facet), constants);
        lit.reset(hits.len(), constants);
        dispatch!(constants.level, simd => shade_hits(simd, &points, &hits, constants, &mut lit));
        corners[first..]
            .iter_mut()
            .zip(&lit.colors)
            .for_each(|(corner, color)| corner.color = *color);
    }
    Ok(corners)
}

/// The row of the picture, or the first or last one, in which a point of the world appears.
fn row_of(view: &PreparedView<'_>, point: DVec3) -> u32 {
    let clip = view.view.clip_from_world() * point.extend(1.0);
    let rows = f64::from(view.viewport.height);
    ((1.0 - clip.y / clip.w) * 0.5 * rows).clamp(0.0, rows - 1.0) as u32
}

/// Adds the corners of a facet, seen from where the eye is.
fn of_facet(
    facet: u32,
    constants: &FrameConstants<'_>,
    hits: &mut Vec<Hit>,
    corners: &mut Vec<LitCorner>,
) {
    // Place the facet and turn its normal to the viewer.
    let view = constants.view;
    let world = &view.session.world;
    let center = Triangles::center_of(world);
    let instance = &world.instances[world.instance_of_facet(facet)];
    let (places, normal) = shadow::facet(instance, facet - instance.first_facet, center);
    let viewer = view.viewer();
    let to_viewer = |p: DVec3| viewer.truncate() - p * viewer.w;
    let away = normal.dot(to_viewer(places[0] + center)) < 0.0;
    // The back of a body is lit on its outer side, which nobody sees.
    let triangle = (facet - instance.first_facet) as usize;
    let material = constants.material(instance.mesh.material_of_triangle(triangle));
    let constants = &constants.instances[world.instance_of_facet(facet)];
    let turns = constants.two_sided || material.material.double_sided || material.is_layered();
    let normal = if away && turns { -normal } else { normal };

    // Add a hit at each corner, a little inside the facet.
    for corner in 0..3 {
        let at = places[corner] + center;
        let share = |k: usize| if k == corner { 1.0 - 2.0 * INSIDE } else { INSIDE };
        let position = shadow::weighted(&places, [0, 1, 2].map(share));
        let weights = [0, 1, 2].map(|k| [if k == corner { 1.0 } else { 0.0 }, 0.0, 0.0]);
        let in_view = view.view.view_from_world.transform_point3(at);
        // In a parallel view the ray comes from in front.
        let origin = match (away && !turns, view.view.perspective) {
            (true, _) => in_view + view.view.view_from_world.transform_vector3(normal),
            (false, true) => DVec3::ZERO,
            (false, false) => in_view + DVec3::Z,
        };
        let seed = facet.wrapping_mul(0x9e37_79b9) ^ corner as u32;
        let place = SurfacePoint { position, normal, facet, seed, pixel: None };
        hits.push(Hit {
            weights,
            origin: origin.as_vec3().to_array(),
            place,
            row: Some(row_of(view, at)),
        });
        corners.push(LitCorner {
            facet,
            corner: corner as u8,
            world: at,
            view: in_view,
            color: [0.0; 4],
        });
    }
    debug_assert!(viewer != DVec4::ZERO);
}
