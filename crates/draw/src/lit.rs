//! Lit and shadowed parts of visible shapes.
//!
//! A light's lit polygons are details of the facets that they lie in, found in space. They are
//! projected to the page, where they divide the visible shapes of their facet: a part outside all
//! of them is in the light's shadow.
//!
//! Lit polygons are enlarged by [`REACH`]. Otherwise rounding could leave hairs of shadow between
//! two of them, and where one reaches a side of its facet.
//!
//! In:   shapes of facets on the page, lit polygons of these facets in world space. Out: shapes,
//!       each with the lights that reach it.
//! Cost: `k log k` with `k` corners of lit polygons.
//! Source: [Atherton, Weiler & Greenberg 1978].

use crate::shapes::{Corner, Shapes, corner_at, without, without_hairs};
use std::collections::BTreeMap;
use vitral_frame::drawing::signed_area;
use vitral_math::{DMat4, DVec3, DVec4};

/// Units of the page by which lit polygons are made larger: what they lie on is rounded to a unit,
/// and two that share a side leave no crack.
const REACH: f64 = 2.0;
/// The sine of the angle from which on a light is before a plane.
const GRAZING: f64 = 1e-6;
/// The least homogeneous coordinate in front of the viewer, as a part of the facet's largest.
const NEAR: f64 = 1e-6;

/// The polygons that one light reaches.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LitPolygons {
    /// The light's number, 0 to 31: its bit in [`FaceLook::lights`](crate::FaceLook::lights).
    pub light: u8,
    /// Where the light is: a point, or with `w` 0 the direction to it.
    pub place: DVec4,
    /// For each facet of the world that it reaches, convex polygons that do not overlap, world
    /// space.
    pub of_facet: BTreeMap<u32, Vec<Vec<DVec3>>>,
}

/// From the world to units of the page.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Projector {
    pub(crate) clip_from_world: DMat4,
    /// Width and height of the page in units.
    pub(crate) size: [f64; 2],
}

/// Divides shapes of some facets in one plane between the lights: each part comes with a bit for
/// every light that reaches it. Lights that are not among `lights` reach everything. Facets come
/// with a corner, world space; `normal` is the unit normal on the side that is seen: a light on the
/// other side reaches nothing.
pub(crate) fn divide(
    shapes: Shapes,
    facets: &[(u32, DVec3)],
    normal: [f32; 3],
    lights: &[LitPolygons],
    to_page: &Projector,
) -> Vec<(u32, Shapes)> {
    let mut parts = vec![(u32::MAX, shapes)];
    for light in lights {
        let mut lit: Vec<Vec<Corner>> = Vec::new();
        for &(facet, _) in facets.iter().filter(|(_, corner)| light.is_before(*corner, normal)) {
            let polygons = light.of_facet.get(&facet).map_or(&[][..], Vec::as_slice);
            lit.extend(polygons.iter().filter_map(|polygon| to_page.polygon(polygon)));
        }
        parts = parts
            .into_iter()
            .flat_map(|(lights, shapes)| split(lights, shapes, &lit, light.light))
            .collect();
    }
    parts
}

/// The lights among `lights` that do not reach a part.
pub(crate) fn unlit(reached_by: u32, lights: &[LitPolygons]) -> u32 {
    lights.iter().fold(0, |unlit, light| unlit | 1 << light.light) & !reached_by
}

impl LitPolygons {
    /// Whether the light is on the side of a plane that a normal points to.
    fn is_before(&self, corner: DVec3, normal: [f32; 3]) -> bool {
        let to_light = (self.place.truncate() - corner * self.place.w).normalize_or_zero();
        to_light.dot(DVec3::from_array(normal.map(f64::from))) > GRAZING
    }
}

/// The part of some shapes that a light reaches, and its shadow.
fn split(lights: u32, shapes: Shapes, lit: &[Vec<Corner>], light: u8) -> Vec<(u32, Shapes)> {
    let dark = lights & !(1 << light);
    if lit.is_empty() {
        return vec![(dark, shapes)];
    }
    let shadow = without_hairs(without(&shapes, lit));
    if shadow.is_empty() {
        return vec![(lights, shapes)];
    }
    let bright = without_hairs(without(&shapes, shadow.iter().flatten()));
    let mut parts = vec![(lights, bright), (dark, shadow)];
    parts.retain(|(_, shapes)| !shapes.is_empty());
    parts
}

impl Projector {
    /// A convex polygon on the page, made larger; `None` if nothing of it is in front of the viewer
    /// or it is seen edge-on.
    fn polygon(&self, polygon: &[DVec3]) -> Option<Vec<Corner>> {
        // Leave out the part behind the viewer.
        let clip: Vec<DVec4> =
            polygon.iter().map(|p| self.clip_from_world * p.extend(1.0)).collect();
        let near = NEAR * clip.iter().fold(0.0f64, |most, p| most.max(p.w));
        let visible = in_front(&clip, near);

        // Far outside the page it does not matter where.
        let within =
            |at: [f64; 2]| [0, 1].map(|k| at[k].clamp(-0.5 * self.size[k], 1.5 * self.size[k]));
        let mut outline: Vec<[f64; 2]> = visible.iter().map(|p| within(self.point(p))).collect();
        let area = signed_area(&outline);
        if area < 0.0 {
            outline.reverse();
        }
        (area != 0.0).then(|| enlarged(&outline))
    }

    /// A point in units of the page.
    fn point(&self, p: &DVec4) -> [f64; 2] {
        [(p.x / p.w * 0.5 + 0.5) * self.size[0], (p.y / p.w * 0.5 + 0.5) * self.size[1]]
    }
}

/// A convex outline with its sides moved outwards by [`REACH`].
fn enlarged(outline: &[[f64; 2]]) -> Vec<Corner> {
    let mut larger = Vec::with_capacity(2 * outline.len());
    for (p, q) in outline.iter().zip(outline.iter().cycle().skip(1)) {
        let [dx, dy] = [q[0] - p[0], q[1] - p[1]];
        let length = (dx * dx + dy * dy).sqrt();
        if length > 0.0 {
            let [x, y] = [dy * REACH / length, -dx * REACH / length];
            larger.extend([p, q].map(|corner| corner_at([corner[0] + x, corner[1] + y])));
        }
    }
    larger
}

/// The part of a convex polygon with a homogeneous coordinate above `near`.
fn in_front(polygon: &[DVec4], near: f64) -> Vec<DVec4> {
    if polygon.iter().all(|p| p.w >= near) {
        return polygon.to_vec();
    }
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (p, q) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
        if p.w >= near {
            kept.push(*p);
        }
        if (p.w >= near) != (q.w >= near) {
            kept.push(p.lerp(*q, (near - p.w) / (q.w - p.w)));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::on_page;
    use vitral_math::dvec3;

    const FACET: [DVec3; 3] = [dvec3(0.0, 0.0, 0.0), dvec3(1.0, 0.0, 0.0), dvec3(0.0, 1.0, 0.0)];
    /// A page of 1000 units that shows a square of two by two.
    const TO_PAGE: Projector = Projector { clip_from_world: DMat4::IDENTITY, size: [1000.0; 2] };

    fn area(shapes: &Shapes) -> f64 {
        let ring = |ring: &Vec<Corner>| ring.iter().map(on_page).collect::<Vec<_>>();
        shapes.iter().flatten().map(|r| signed_area(&ring(r))).sum()
    }

    /// The parts of the facet that two lights make, by their bits.
    fn parts(first: &[Vec<DVec3>], second: &[Vec<DVec3>]) -> Vec<(u32, f64)> {
        let whole = FACET.map(|p| corner_at([p.x * 500.0 + 500.0, p.y * 500.0 + 500.0])).to_vec();
        let of = |light, polygons: &[Vec<DVec3>]| LitPolygons {
            light,
            place: DVec4::new(0.0, 0.0, 5.0, 1.0),
            of_facet: [(7, polygons.to_vec())].into_iter().filter(|(_, p)| !p.is_empty()).collect(),
        };
        let lights = [of(0, first), of(3, second)];
        let divided =
            divide(vec![vec![whole]], &[(7, FACET[0])], [0.0, 0.0, 1.0], &lights, &TO_PAGE);
        divided.iter().map(|(lights, shapes)| (lights & 0b1001, area(shapes))).collect()
    }

    #[test]
    fn a_facet_is_lit_dark_or_divided() {
        let half = vec![
            dvec3(0.0, 0.0, 0.0),
            dvec3(0.5, 0.0, 0.0),
            dvec3(0.5, 0.5, 0.0),
            dvec3(0.0, 1.0, 0.0),
        ];
        assert_eq!(parts(&[FACET.to_vec()], &[FACET.to_vec()]), [(0b1001, 125_000.0)]);
        assert_eq!(parts(&[], &[FACET.to_vec()]), [(0b1000, 125_000.0)]);
        let divided = parts(&[half], &[]);
        assert_eq!(divided.iter().map(|part| part.0).collect::<Vec<_>>(), [0b0001, 0b0000]);
        // The shadow is a right triangle with legs of 250 units, and of 248 beside the enlarged
        // polygon.
        assert!((divided[1].1 - 248.0 * 248.0 / 2.0).abs() < 2.0, "{divided:?}");
        assert!((divided[0].1 + divided[1].1 - 125_000.0).abs() < 1.0, "{divided:?}");
    }

    #[test]
    fn what_is_behind_the_viewer_is_cut_off() {
        let point = |w: f64| DVec4::new(w, 0.0, 0.0, w);
        let cut = in_front(&[point(1.0), point(-1.0), point(3.0)], 0.5);
        assert_eq!(cut.iter().map(|p| p.w).collect::<Vec<_>>(), [1.0, 0.5, 0.5, 3.0]);
        assert!(in_front(&[point(-1.0), point(-2.0), point(-1.0)], 0.5).is_empty());
    }
}
