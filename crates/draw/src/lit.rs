//! Lit and shadowed parts of polygons on the page.
//!
//! Atherton, Weiler and Greenberg remove hidden surfaces twice: what the light sees becomes lit polygons, which lie on the polygons of
//! the model as surface detail; then the viewer's hidden surfaces are removed, and what is left of a polygon is lit where a lit polygon
//! lies on it. Here lit polygons come from elsewhere, convex and in space. They are projected, and each visible polygon is cut with
//! those of its own facets.
//!
//! In:   polygons on the page, and lit polygons by facet and light (world space). Out: parts of the polygons, each with the lights that do
//!       not reach it.
//! Cost: for each polygon and light the corners of both.
//! Source: \[Atherton, Weiler & Greenberg 1978\]; the cuts are made by `i_overlay`.

use crate::fill::{FINER, LEAST_AREA, PageRegion};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{IntOverlayOptions, Overlay, ShapeType};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::i_float::int::point::IntPoint;
use std::cmp::Ordering;
use std::ops::Range;
use vitral_math::{DMat4, DVec3, DVec4};

/// What is left of a colour where no light arrives.
const DARKENED: f64 = 0.5;
/// Units of the page by which lit polygons are made larger: corners of what they lie on are rounded to a unit, and between two that share a
/// side there is to be no crack.
const REACH: f64 = 2.0;
/// Farthest that a light may seem to lie below a face that it grazes, as a sine.
const GRAZING: f64 = 1e-6;

type Corner = IntPoint<i32>;
type Rings = Vec<Vec<[f64; 2]>>;

/// What lights reach.
#[derive(Debug)]
pub struct LitPolygons {
    /// Where each light is: a point, or with `w` 0 the direction to it.
    lights: Vec<DVec4>,
    /// Once sorted, by facet and light.
    polygons: Vec<Lit>,
    corners: Vec<DVec3>,
}

/// A convex polygon.
#[derive(Debug)]
struct Lit {
    facet: u32,
    light: u32,
    corners: Range<usize>,
}

/// How the page lies in space.
pub(crate) struct Page {
    pub(crate) clip_from_world: DMat4,
    /// Distance of the near plane.
    pub(crate) near: f64,
    /// Width and height in units.
    pub(crate) size: [i32; 2],
}

impl LitPolygons {
    /// Most lights.
    pub const MOST_LIGHTS: usize = 64;

    /// None yet, of at most [`Self::MOST_LIGHTS`] lights: points, or with `w` 0 directions to them.
    pub fn new(lights: Vec<DVec4>) -> Self {
        Self { lights, polygons: Vec::new(), corners: Vec::new() }
    }

    /// Adds a convex part of a facet that a light reaches, world space; whether from before it or from behind does not matter.
    pub fn push(&mut self, light: usize, facet: u32, corners: &[DVec3]) {
        let first = self.corners.len();
        self.corners.extend(corners);
        self.polygons.push(Lit { facet, light: light as u32, corners: first..self.corners.len() });
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> u64 {
        (size_of_val(self.polygons.as_slice()) + size_of_val(self.corners.as_slice())) as u64
    }

    /// Sorts what was added. Call it once, at the end.
    #[must_use]
    pub fn sorted(mut self) -> Self {
        self.polygons.sort_by_key(|lit| (lit.facet, lit.light));
        self
    }

    /// Adds the parts of a region to `parts`: cut so that each light reaches all of one, or nothing. `(corner, normal)` is a place on its
    /// face, and the normal on the side that is seen.
    pub(crate) fn divide(
        &self,
        whole: PageRegion,
        facets: &[u32],
        (corner, normal): (DVec3, [f32; 3]),
        page: &Page,
        parts: &mut Vec<PageRegion>,
    ) {
        let normal = DVec3::from_array(normal.map(f64::from));
        let (mut pieces, mut facing) = (vec![(whole.rings, 0u64)], 0u64);
        for (number, light) in self.lights.iter().enumerate() {
            // What faces away from the light is in its own shadow.
            let to_light = (light.truncate() - corner * light.w).normalize_or_zero();
            if normal.dot(to_light) <= GRAZING {
                pieces.iter_mut().for_each(|(_, unlit)| *unlit |= 1 << number);
                continue;
            }
            facing |= 1 << number;

            // Cut the rest at the borders of the light.
            let lit = self.on_page(number as u32, facets, page);
            let mut cut = Vec::with_capacity(2 * pieces.len());
            for (rings, unlit) in pieces {
                let [reached, dark] = cut_at(&rings, &lit);
                cut.extend((!reached.is_empty()).then_some((reached, unlit)));
                cut.extend((!dark.is_empty()).then_some((dark, unlit | 1 << number)));
            }
            pieces = cut;
        }
        parts.extend(pieces.into_iter().map(|(rings, unlit)| {
            let color = darkened(whole.color, facing, unlit);
            PageRegion { surface: whole.surface, material: whole.material, color, unlit, rings }
        }));
    }

    /// What a light reaches of some facets, on the finer grid of the page.
    fn on_page(&self, light: u32, facets: &[u32], page: &Page) -> Vec<Vec<Corner>> {
        let mut all = Vec::new();
        for &facet in facets {
            let first = self.polygons.partition_point(|lit| (lit.facet, lit.light) < (facet, light));
            let own = self.polygons[first..].iter().take_while(|lit| (lit.facet, lit.light) == (facet, light));
            all.extend(own.map(|lit| page.outline(&self.corners[lit.corners.clone()])).filter(|ring| ring.len() > 2));
        }
        all
    }
}

impl Page {
    /// A convex polygon of the world on the finer grid, as far as it lies on the page; empty if nothing does.
    fn outline(&self, corners: &[DVec3]) -> Vec<Corner> {
        let mut polygon: Vec<DVec4> = corners.iter().map(|c| self.clip_from_world * c.extend(1.0)).collect();
        let borders = [[1.0, 0.0, 1.0], [-1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [0.0, -1.0, 1.0]];
        // Without distance from the eye there is no division; a parallel view has the same everywhere.
        let least = (self.near * 0.5).min(1.0);
        polygon = clipped(&polygon, |p| p.w - least);
        for [x, y, w] in borders {
            polygon = clipped(&polygon, |p| p.x * x + p.y * y + p.w * w);
        }
        let on_page = |p: &DVec4| {
            let at = |k: usize| {
                let share = p[k] / p.w * 0.5 + 0.5;
                (share * f64::from(self.size[k]) * f64::from(FINER)).round() as i32
            };
            Corner::new(at(0), at(1))
        };
        let mut outline: Vec<Corner> = polygon.iter().map(on_page).collect();
        // Whether it is seen from before or from behind, it runs counter-clockwise.
        match doubled_area(&outline).cmp(&0) {
            Ordering::Less => outline.reverse(),
            Ordering::Equal => outline.clear(),
            Ordering::Greater => {}
        }
        enlarged(&outline)
    }
}

/// A convex outline with its sides moved outwards by [`REACH`], and its corners cut off where they would become longer than that.
fn enlarged(outline: &[Corner]) -> Vec<Corner> {
    let mut larger = Vec::with_capacity(2 * outline.len());
    let next = outline.iter().cycle().skip(1);
    for (p, q) in outline.iter().zip(next) {
        let [dx, dy] = [q.x - p.x, q.y - p.y].map(f64::from);
        let length = (dx * dx + dy * dy).sqrt();
        if length > 0.0 {
            let step = REACH * f64::from(FINER) / length;
            let [x, y] = [dy * step, -dx * step].map(|at| at.round() as i32);
            larger.extend([p, q].map(|corner| Corner::new(corner.x + x, corner.y + y)));
        }
    }
    larger
}

/// The box round points.
fn bounds(points: &[Corner]) -> [i32; 4] {
    points.iter().fold([i32::MAX, i32::MAX, i32::MIN, i32::MIN], |[x0, y0, x1, y1], p| {
        [x0.min(p.x), y0.min(p.y), x1.max(p.x), y1.max(p.y)]
    })
}

/// Twice the area of an outline, positive where it runs counter-clockwise.
fn doubled_area(outline: &[Corner]) -> i128 {
    let next = outline.iter().cycle().skip(1);
    let cross = |(p, q): (&Corner, &Corner)| i128::from(p.x) * i128::from(q.y) - i128::from(p.y) * i128::from(q.x);
    outline.iter().zip(next).map(cross).sum()
}

/// What of a convex polygon lies where a linear function is not negative.
fn clipped(polygon: &[DVec4], inside: impl Fn(&DVec4) -> f64) -> Vec<DVec4> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, p) in polygon.iter().enumerate() {
        let q = &polygon[(i + 1) % polygon.len()];
        let [a, b] = [p, q].map(&inside);
        if a >= 0.0 {
            kept.push(*p);
        }
        if (a >= 0.0) != (b >= 0.0) {
            kept.push(*p + (*q - *p) * (a / (a - b)));
        }
    }
    kept
}

/// The part of a region inside convex polygons, and the part outside.
fn cut_at(rings: &Rings, lit: &[Vec<Corner>]) -> [Rings; 2] {
    let fine = |p: &[f64; 2]| {
        let [x, y] = p.map(|at| (at * f64::from(FINER)).round() as i32);
        Corner::new(x, y)
    };
    let subject: Vec<Vec<Corner>> = rings.iter().map(|ring| ring.iter().map(fine).collect()).collect();

    // Take the polygons that come near.
    let [x0, y0, x1, y1] = bounds(&subject.concat());
    let is_near = |polygon: &&Vec<Corner>| {
        let [u0, v0, u1, v1] = bounds(polygon);
        u0 < x1 && x0 < u1 && v0 < y1 && y0 < v1
    };
    let near: Vec<&Vec<Corner>> = lit.iter().filter(is_near).collect();
    if near.is_empty() {
        return [Vec::new(), rings.clone()];
    }

    // Cut.
    let rough = |p: &Corner| [p.x, p.y].map(|at| f64::from(at) / f64::from(FINER));
    let least = LEAST_AREA * u64::from(FINER.unsigned_abs()).pow(2);
    [OverlayRule::Intersect, OverlayRule::Difference].map(|rule| {
        let options = IntOverlayOptions { min_output_area: least, ..IntOverlayOptions::default() };
        let mut overlay = Overlay::<i32>::new_custom(rings.len() * 8 + near.len() * 8, options, Default::default());
        subject.iter().for_each(|ring| overlay.add_contour(ring, ShapeType::Subject));
        near.iter().for_each(|polygon| overlay.add_contour(polygon, ShapeType::Clip));
        let shapes = overlay.overlay(rule, FillRule::NonZero);
        shapes.iter().flatten().map(|ring| ring.iter().map(rough).collect()).collect()
    })
}

/// A colour where some of the lights that face a place do not reach it.
fn darkened(color: [u8; 3], facing: u64, unlit: u64) -> [u8; 3] {
    let missing = match facing.count_ones() {
        0 => 1.0,
        count => f64::from((unlit & facing).count_ones()) / f64::from(count),
    };
    color.map(|level| (f64::from(level) * (1.0 - missing * (1.0 - DARKENED))).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use vitral_frame::drawing::signed_area;

    /// A page of 4096 units a side that shows the square from -1 to 1 in the plane z = 0.
    fn page() -> Page {
        Page { clip_from_world: DMat4::IDENTITY, near: 1.0, size: [4096; 2] }
    }

    fn square([x0, y0]: [f64; 2], [x1, y1]: [f64; 2]) -> Vec<[f64; 2]> {
        vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]]
    }

    fn in_space(ring: &[[f64; 2]]) -> Vec<DVec3> {
        ring.iter().map(|&[x, y]| DVec3::new(x / 2048.0 - 1.0, y / 2048.0 - 1.0, 0.0)).collect()
    }

    /// Areas of the parts of a square of 1024 units by the lights that do not reach them.
    fn parts(lights: &[DVec4], lit: &[(usize, Vec<[f64; 2]>)]) -> Vec<(u64, f64, [u8; 3])> {
        let mut polygons = LitPolygons::new(lights.to_vec());
        lit.iter().for_each(|(light, ring)| polygons.push(*light, 7, &in_space(ring)));
        let rings = vec![square([1024.0; 2], [2048.0; 2])];
        let whole = PageRegion { surface: 3, material: 0, color: [200; 3], unlit: 0, rings };
        let mut parts = Vec::new();
        polygons.sorted().divide(whole, &[7], (DVec3::ZERO, [0.0, 0.0, 1.0]), &page(), &mut parts);
        let area = |part: &PageRegion| part.rings.iter().map(|ring| signed_area(ring)).sum();
        parts.iter().map(|part| (part.unlit, area(part), part.color)).collect()
    }

    const ABOVE: DVec4 = DVec4::new(0.0, 0.0, 9.0, 1.0);
    const BELOW: DVec4 = DVec4::new(0.0, 0.0, -1.0, 0.0);

    #[test]
    fn a_polygon_is_lit_where_a_lit_polygon_lies_on_it() {
        let half = square([0.0; 2], [1536.0, 4096.0]);
        let expected = [(0, (512.0 + REACH) * 1024.0, [200; 3]), (1, (512.0 - REACH) * 1024.0, [100; 3])];
        assert_eq!(parts(&[ABOVE], &[(0, half.clone())]), expected);
        // Run the other way round, it is the same.
        let turned = half.iter().rev().copied().collect();
        assert_eq!(parts(&[ABOVE], &[(0, turned)]), expected);
        // What a light reaches from behind is in its own shadow.
        assert_eq!(parts(&[BELOW], &[(0, half.clone())]), [(1, 1024.0 * 1024.0, [100; 3])]);
        assert_eq!(parts(&[ABOVE, BELOW], &[(0, square([0.0; 2], [4096.0; 2]))]), [(2, 1024.0 * 1024.0, [200; 3])]);
    }

    #[test]
    fn two_lights_make_up_to_four_parts() {
        let (left, lower) = (square([0.0; 2], [1280.0, 4096.0]), square([0.0; 2], [4096.0, 1280.0]));
        let mut found = parts(&[ABOVE, ABOVE], &[(0, left), (1, lower)]);
        found.sort_by_key(|part| part.0);
        let (lit, dark) = (256.0 + REACH, 768.0 - REACH);
        let areas = [lit * lit, dark * lit, lit * dark, dark * dark];
        let colors = [200, 150, 150, 100];
        let expected: Vec<_> = (0..4).map(|i| (i as u64, areas[i], [colors[i]; 3])).collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn between_lit_polygons_there_is_no_crack() {
        // The corner of the middle one lies on the side of the first but for rounding.
        let lower = square([0.0; 2], [4096.0, 1500.3]);
        let upper = vec![[4096.0, 1500.3], [4096.0, 4096.0], [0.0, 4096.0], [0.0, 1500.3], [1111.1, 1500.305]];
        let found = parts(&[ABOVE], &[(0, lower), (0, upper)]);
        assert_eq!(found, [(0, 1024.0 * 1024.0, [200; 3])]);
    }

    #[test]
    fn what_lies_behind_the_eye_is_cut_off() {
        // The eye is in the origin and looks along -z: a floor that begins behind it.
        let clip_from_world = DMat4::from_cols(DVec4::X, DVec4::Y, DVec4::NEG_W, DVec4::Z * 0.1);
        let page = Page { clip_from_world, near: 0.1, size: [4096; 2] };
        let floor = [[-1e3, 1e3], [-1e3, -1e3], [1e3, -1e3], [1e3, 1e3]].map(|[x, z]| DVec3::new(x, -1.0, z));
        let outline = page.outline(&floor);
        let page = -3 * FINER..=4099 * FINER;
        assert!(outline.len() > 2 && outline.iter().all(|p| page.contains(&p.x)), "{outline:?}");
        let highest = outline.iter().map(|p| f64::from(p.y) / f64::from(FINER)).fold(0.0, f64::max);
        assert!(highest > 2042.0 && highest < 2050.0, "just below the horizon: {highest}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn parts_make_up_the_whole(
            lit in prop::collection::vec((0usize..3, prop::array::uniform3(prop::array::uniform2(0u16..4096))), 0..8),
        ) {
            let lit: Vec<_> = lit.into_iter().map(|(light, ring)| (light, ring.map(|p| p.map(f64::from)).to_vec())).collect();
            let found = parts(&[ABOVE; 3], &lit);
            let sum: f64 = found.iter().map(|part| part.1).sum();
            prop_assert!((sum - 1024.0 * 1024.0).abs() < 1e-3 * sum + 40.0 * LEAST_AREA as f64, "{}", sum);
        }
    }
}
