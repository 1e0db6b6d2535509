//! Form factors between polygons: the part of the diffuse light of one that arrives at the other,
//! nothing between them.
//!
//! From a point (a differential area), Lambert's formula sums over the polygon's edges the angle
//! under which each is seen, times the cosine between the normal and the edge's plane. From an
//! area, Stokes' theorem turns the double integral over both areas into one over both outlines,
//! `F = 1 / (2π A) ∮∮ ln r dx·dy`. The inner integral, of the logarithm of the distance to a point
//! along an edge, has a closed form; the outer one is computed by Gauss' rule, cut in half until
//! the result settles, which resolves the corner where edges meet.
//!
//! In:   planar polygons, counter-clockwise seen from the side that shines or is shone on; each
//!       wholly in front of the other. Out: form factors.
//! Cost: edges of one times edges of the other, each some hundred logarithms.
//! Source: \[Lambert 1760\], \[Goral et al. 1984\], \[Schröder & Hanrahan 1993\]. Departs from the
//! last: one of its two integrals is done by quadrature, to about 12 digits.

use std::f64::consts::PI;
use vitral_math::{DVec3, func};

/// Where Gauss' rule of eight points looks, on `-1..1`, and how it weighs.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_361_98),
    (0.525_532_409_916_329, 0.313_706_645_877_887_29),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_47),
    (0.960_289_856_497_536_2, 0.101_228_536_290_376_26),
];
/// Halvings until an interval is let be.
const MOST_HALVINGS: u32 = 48;

fn edges(polygon: &[DVec3]) -> impl Iterator<Item = (DVec3, DVec3)> + Clone {
    (0..polygon.len()).map(|i| (polygon[i], polygon[(i + 1) % polygon.len()]))
}

/// Twice the area, along the normal.
fn doubled_area(polygon: &[DVec3]) -> DVec3 {
    edges(polygon).map(|(a, b)| (a - polygon[0]).cross(b - polygon[0])).sum()
}

/// The form factor from a small area at `point` with unit normal to a polygon in front of it that
/// faces it.
pub fn from_point(point: DVec3, normal: DVec3, polygon: &[DVec3]) -> f64 {
    let sum: f64 = edges(polygon)
        .map(|(a, b)| {
            let (a, b) = (a - point, b - point);
            let across = a.cross(b);
            let sin = across.length();
            if sin > 0.0 { func::atan2(sin, a.dot(b)) * normal.dot(across) / sin } else { 0.0 }
        })
        .sum();
    // Seen from the point, a polygon that faces it runs clockwise.
    -sum / (2.0 * PI)
}

/// The form factor from one polygon to another; 0 from one without area.
pub fn between(from: &[DVec3], to: &[DVec3]) -> f64 {
    let area = 0.5 * doubled_area(from).length();
    if area == 0.0 {
        return 0.0;
    }

    // Scale the tolerance to the edges.
    let scale = edges(from).chain(edges(to)).map(|(a, b)| a.distance(b)).fold(0.0, f64::max);
    let mut sum = 0.0;

    // Sum the contour integrals of all pairs of edges.
    for (a, b) in edges(from) {
        for (p, q) in edges(to) {
            let along = (b - a).dot(q - p);
            let length = p.distance(q);
            if along == 0.0 || length == 0.0 {
                continue;
            }
            let inner = |t: f64| logarithms(a.lerp(b, t), p, (q - p) / length, length);
            sum += along / length * integral(&inner, [0.0, 1.0], 1e-13 * scale, MOST_HALVINGS);
        }
    }
    sum / (2.0 * PI * area)
}

/// `∫ ln |point - (start + s direction)| ds` for `s` from 0 to `length`; `direction` is unit.
fn logarithms(point: DVec3, start: DVec3, direction: DVec3, length: f64) -> f64 {
    let way = point - start;
    let foot = way.dot(direction);
    let height = (way - direction * foot).length();
    let up_to = |u: f64| {
        let square = u * u + height * height;
        let log = if square > 0.0 { 0.5 * u * func::ln(square) } else { 0.0 };
        log - u + height * func::atan2(u, height)
    };
    up_to(length - foot) - up_to(-foot)
}

/// Gauss' rule, and in halves again until both agree.
fn integral(f: &impl Fn(f64) -> f64, [from, to]: [f64; 2], tolerance: f64, halvings: u32) -> f64 {
    let middle = 0.5 * (from + to);
    let (whole, halves) = (gauss(f, from, to), [gauss(f, from, middle), gauss(f, middle, to)]);
    let sum = halves[0] + halves[1];
    if (whole - sum).abs() <= tolerance * (to - from) || halvings == 0 {
        return sum;
    }
    integral(f, [from, middle], tolerance, halvings - 1)
        + integral(f, [middle, to], tolerance, halvings - 1)
}

fn gauss(f: &impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    half * GAUSS.iter().map(|(x, w)| w * (f(middle - half * x) + f(middle + half * x))).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::dvec3;

    /// A unit square from `corner` along two directions.
    fn square(corner: DVec3, u: DVec3, v: DVec3) -> [DVec3; 4] {
        [corner, corner + u, corner + u + v, corner + v]
    }

    #[test]
    fn squares_have_the_factors_of_the_handbooks() {
        let floor = square(DVec3::ZERO, DVec3::X, DVec3::Y);
        let ceiling = square(DVec3::Z, DVec3::Y, DVec3::X);
        let wall = square(DVec3::ZERO, DVec3::Y, DVec3::Z);
        let (parallel, perpendicular) = (between(&floor, &ceiling), between(&floor, &wall));
        // Closed forms: Howell's catalogue, C-11 and C-14, for unit squares.
        let p = 2.0 / PI
            * (func::ln((4.0f64 / 3.0).sqrt()) + 2.0 * 2f64.sqrt() * func::atan2(1.0, 2f64.sqrt())
                - PI / 2.0);
        assert!((p - 0.199_824_895_7).abs() < 1e-9);
        assert!((parallel - p).abs() < 1e-9, "{parallel} {p}");
        assert!((perpendicular - 0.200_043_776_1).abs() < 1e-9, "{perpendicular}");
        assert!(
            (4.0 * perpendicular + parallel - 1.0).abs() < 1e-11,
            "the row of a cube: {}",
            4.0 * perpendicular + parallel - 1.0
        );
    }

    #[test]
    fn reciprocity_holds_between_unequal_polygons() {
        let triangle = [dvec3(0.2, 0.1, 0.0), dvec3(2.0, 0.3, 0.0), dvec3(0.4, 1.7, 0.1)];
        let quad = [
            dvec3(-1.0, 0.0, 3.0),
            dvec3(-1.0, 0.9, 2.5),
            dvec3(0.5, 0.9, 2.5),
            dvec3(0.5, 0.0, 3.0),
        ];
        let (there, back) = (between(&triangle, &quad), between(&quad, &triangle));
        let areas = [doubled_area(&triangle).length(), doubled_area(&quad).length()];
        assert!(
            there > 0.01 && (areas[0] * there - areas[1] * back).abs() < 1e-10,
            "{there} {back}"
        );
    }

    #[test]
    fn the_factor_from_points_averages_to_that_from_the_area() {
        let ceiling = square(DVec3::Z, DVec3::Y, DVec3::X);
        const STEPS: usize = 24;
        let at = |i: usize| (i as f64 + 0.5) / STEPS as f64;
        let sum: f64 = (0..STEPS * STEPS)
            .map(|i| from_point(dvec3(at(i % STEPS), at(i / STEPS), 0.0), DVec3::Z, &ceiling))
            .sum();
        let mean = sum / (STEPS * STEPS) as f64;
        assert!((mean - 0.199_824_895_7).abs() < 1e-4, "{mean}");
        // A polygon so large that it fills the hemisphere.
        let sky = square(dvec3(-1e7, -1e7, 1.0), DVec3::Y * 2e7, DVec3::X * 2e7);
        assert!((from_point(DVec3::ZERO, DVec3::Z, &sky) - 1.0).abs() < 1e-6);
    }
}
