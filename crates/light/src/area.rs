//! What arrives at a point from a whole shape: the irradiance of an area light, without sampling.
//!
//! A flat shape that shines like a Lambert surface sends to a point `E = L ∫ cos θ cos θ' / d² dA`,
//! an integral that Lambert turned into one along the outline: for a polygon with corners
//! `a1, a2, …` as seen from the point, `E = L/2 Σ Θi (n·Γi)`, where `Θi` is the angle under which
//! the edge from `ai` to `ai+1` is seen, and `Γi` the unit normal of the plane through the edge and
//! the point. Only what is above the point's horizon counts, so edges are cut there. The cut
//! polygon has new edges in the plane of the horizon. They all lie on one line, where that plane
//! meets the light's; the angle of a place on this line can be told for each place alone, so each
//! cut adds its own, and it does not matter which of them an edge joins: concave outlines need no
//! more.
//!
//! A disc that the horizon does not cut has a closed form: its irradiance on a surface with normal
//! `n` is `n·F`, where `F` has a part along the axis and one towards it. Where the horizon cuts it,
//! a polygon of its area takes its place.
//!
//! What is computed is the mean `G` of `cos θ cos θ' / d²` over the shape, which tends to that of a
//! point as the shape becomes small; a shape that is seen under a hair's breadth counts as a point,
//! where single precision would lose the sum of angles.
//!
//! In:   a shape; a point and a unit normal in the same space. Out: `G`, 0 behind the light.
//! Cost: for each edge two divisions, a square root and a polynomial; for a disc three square
//!       roots.
//! Source: \[Lambert 1760\], \[Baum, Rushmeier & Winget 1989\]; the disc after \[Howell, Mengüç &
//!         Siegel 2010\].

use crate::AreaShape;
use std::f32::consts::{FRAC_PI_2, PI};
use vitral_math::lanes::{Lanes, V3, inlined};
use vitral_math::{DVec3, func};

/// Corners of the polygon that stands for a disc cut by the horizon.
const DISC_CORNERS: usize = 32;
/// A shape whose mean square radius is less than this part of the squared distance counts as a
/// point.
const TINY: f32 = 1e-5;
/// No mean is larger.
const LARGEST: f32 = 1e18;

/// A flat shape, made ready.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Shape {
    /// Mean of the shape's points, view space.
    pub(crate) centroid: [f32; 3],
    /// Unit normal of the shining side.
    pub(crate) normal: [f32; 3],
    /// Mean of the squared distances of its points from the centroid.
    pub(crate) spread: f32,
    /// Half of the inverse of the outline's area.
    half_density: f32,
    outline: Vec<Edge>,
    /// For a disc; its outline is that of the polygon in its place.
    radius: Option<f32>,
}

/// An edge of an outline, counter-clockwise as seen from the shining side.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Edge {
    from: [f32; 3],
    /// To the next corner.
    way: [f32; 3],
}

impl Shape {
    /// `None` for a shape without a normal, or with numbers beyond `farthest`.
    pub(crate) fn new(shape: &AreaShape, farthest: f64) -> Option<Self> {
        let sound = |p: &DVec3| p.abs().max_element() <= farthest;
        match shape {
            &AreaShape::Disc { center, normal, radius } => {
                let normal = normal.try_normalize()?;
                let radius = radius.abs();
                if !(sound(&center) && radius <= farthest) {
                    return None;
                }
                let spread = 0.5 * radius * radius;
                // As large as the disc.
                let angle = std::f64::consts::TAU / DISC_CORNERS as f64;
                let beyond = radius * (angle / func::sin(angle)).sqrt();
                let (x, y) = normal.any_orthonormal_pair();
                let corner = |i: usize| {
                    let (sin, cos) = func::sin_cos(angle * i as f64);
                    center + (x * cos + y * sin) * beyond
                };
                let corners: Vec<DVec3> = (0..DISC_CORNERS).map(corner).collect();
                let area = std::f64::consts::PI * radius * radius;
                Some(Self::of(&corners, center, normal, area, spread, Some(radius as f32)))
            }
            AreaShape::Polygon { corners } => {
                // Add up the triangles of a fan, weighted with their signed area along the
                // polygon's normal.
                let fan = || corners.windows(2).skip(1).map(|pair| (corners[0], pair[0], pair[1]));
                let twice: DVec3 = fan().map(|(a, b, c)| (b - a).cross(c - a)).sum();
                let normal = twice.try_normalize().filter(|_| corners.iter().all(sound))?;
                let share = |a: DVec3, b: DVec3, c: DVec3| {
                    (b - a).cross(c - a).dot(twice) / twice.length_squared()
                };
                let centroid: DVec3 =
                    fan().map(|(a, b, c)| (a + b + c) * (share(a, b, c) / 3.0)).sum();
                let spread: f64 = fan()
                    .map(|(a, b, c)| {
                        let [a, b, c] = [a, b, c].map(|p| p - centroid);
                        let squares = a.length_squared() + b.length_squared() + c.length_squared();
                        share(a, b, c) * (squares + (a + b + c).length_squared()) / 12.0
                    })
                    .sum();
                sound(&centroid).then(|| {
                    Self::of(corners, centroid, normal, 0.5 * twice.length(), spread, None)
                })
            }
        }
    }

    fn of(
        corners: &[DVec3],
        centroid: DVec3,
        normal: DVec3,
        area: f64,
        spread: f64,
        radius: Option<f32>,
    ) -> Self {
        let three = |v: DVec3| v.as_vec3().to_array();
        let edge = |i: usize| {
            let (from, to) = (corners[i], corners[(i + 1) % corners.len()]);
            Edge { from: three(from), way: three(to - from) }
        };
        Self {
            centroid: three(centroid),
            normal: three(normal),
            spread: spread.max(0.0) as f32,
            half_density: (0.5 / area).min(f64::from(LARGEST)) as f32,
            outline: (0..corners.len()).map(edge).collect(),
            radius,
        }
    }

    /// The mean of `cos θ cos θ' / d²` over the shape, at `position` on a surface with unit normal
    /// `n`; 0 where the light is not in front of the surface, or the point not in front of the
    /// light.
    #[inline(always)]
    pub(crate) fn mean<T: Lanes>(&self, position: V3<T>, n: V3<T>) -> T {
        let zero = position.x.splat(0.0);
        let light_normal = V3::splat(zero, self.normal);
        let to = V3::splat(zero, self.centroid) - position;
        let height = -to.dot(light_normal);
        let square = to.dot(to);

        // As a point.
        let inverse = zero.splat(1.0) / square;
        let point = (n.dot(to) * inverse).positive() * (height * inverse);

        let in_front = zero.lt(height) & square.le(zero.splat(LARGEST * LARGEST));
        let large = in_front & (square * TINY).lt(zero.splat(self.spread));
        let mut mean = point;
        if T::any(large) {
            let whole = match self.radius {
                Some(radius) => zero.outlined(
                    #[inline(always)]
                    || self.disc(position, n, to, height, radius),
                ),
                None => zero.outlined(
                    #[inline(always)]
                    || self.polygon(position, n, height),
                ),
            };
            mean = T::select(large, whole, mean);
        }
        T::select(in_front, mean.positive().min(zero.splat(LARGEST)), zero)
    }

    /// Of the outline, by Lambert's formula. `height` above the light's plane is positive.
    #[inline(always)]
    fn polygon<T: Lanes>(&self, position: V3<T>, n: V3<T>, height: T) -> T {
        let zero = height.splat(0.0);
        let one = height.splat(1.0);
        // Along the line where the horizon meets the light's plane.
        let along = V3::splat(zero, self.normal).cross(n);
        let corner = inlined(
            #[inline(always)]
            |edge: &Edge| V3::splat(zero, edge.from) - position,
        );
        let mut sum = zero;
        let Some(first) = self.outline.first() else { return zero };
        let mut a = corner(first);
        let mut a_height = n.dot(a);
        for (i, edge) in self.outline.iter().enumerate() {
            let next = &self.outline[if i + 1 == self.outline.len() { 0 } else { i + 1 }];
            let b = corner(next);
            let b_height = n.dot(b);
            let (a_above, b_above) = (zero.lt(a_height), zero.lt(b_height));
            let way = V3::splat(zero, edge.way);
            let across = way.cross(a);
            let above = a_above & b_above;
            let cut = (a_above | b_above) & !above;
            if !T::any(cut) {
                // The whole edge, or nothing of it.
                sum = sum + T::select(above, seen(across, a.dot(b), n), zero);
            } else {
                let share = a_height / (a_height - b_height);
                let at = a + way.scale(share);
                let kept = T::select(above, one, T::select(a_above, share, one - share));
                let (start, end) = (V3::select(a_above, a, at), V3::select(b_above, b, at));
                let edge = seen(across.scale(kept), start.dot(end), n);
                sum = sum + T::select(a_above | b_above, edge, zero);
                // The edges that close the polygon again leave from where it goes down and arrive
                // where it comes up.
                let side = at.dot(along);
                let angle = angle(side.abs(), height);
                let leaves = a_above;
                let positive = (zero.lt(side) & leaves) | (side.le(zero) & !leaves);
                sum = sum + T::select(cut, T::select(positive, angle, -angle), zero);
            }
            (a, a_height) = (b, b_height);
        }
        sum * self.half_density
    }

    /// Of a disc with this radius, `to` its centre.
    #[inline(always)]
    fn disc<T: Lanes>(&self, position: V3<T>, n: V3<T>, to: V3<T>, height: T, radius: f32) -> T {
        let zero = height.splat(0.0);
        let light_normal = V3::splat(zero, self.normal);
        // Towards the axis, and how far it is.
        let inwards = to + light_normal.scale(height);
        let r2 = inwards.dot(inwards);
        let (r, h2) = (r2.sqrt(), height * height);
        let (less, more) = (r - radius, r + radius);
        // With x = r² + h² + R² and y = r² + h² - R², s² = x² - 4 r² R² = y² + 4 h² R².
        let s = (less * less + h2).sqrt() * (more * more + h2).sqrt();
        let x = r2 + h2 + radius * radius;
        let y = r2 + h2 - radius * radius;
        // π F / A with F = (1 - y / s) / 2, without cancellation where y is positive.
        let far = h2 * 2.0 / (s * (s + y));
        let near = (-(y / s) + 1.0) * (0.5 / (radius * radius));
        let axial = T::select(zero.lt(y), far, near);
        // π F / A with F = (x / s - 1) h / 2 r.
        let radial = height * 2.0 / (s * (s + x));
        let whole = -n.dot(light_normal) * axial + n.dot(inwards) * radial;

        // Does the horizon cut it?
        let tilt = n.dot(light_normal);
        let reach = (-(tilt * tilt) + 1.0).positive().sqrt() * radius;
        let middle = n.dot(to);
        let (above, below) = (reach.le(middle), middle.le(-reach));
        let mut mean = T::select(above, whole, zero);
        let cut = !(above | below);
        if T::any(cut) {
            mean = T::select(cut, self.polygon(position, n, height), mean);
        }
        mean
    }
}

/// `Θ (n·Γ)` of an edge: `across` is along `Γ`, as long as the sine of the angle is; `along` is in
/// proportion to the cosine.
#[inline(always)]
fn seen<T: Lanes>(across: V3<T>, along: T, n: V3<T>) -> T {
    let zero = along.splat(0.0);
    let sine = across.dot(across).sqrt();
    let part = angle(sine, along) / sine * n.dot(across);
    // Seen end-on, or from the edge itself.
    T::select(zero.lt(sine), part, zero)
}

/// The angle between the x axis and the direction `(x, y)`, `y` not negative: `0..=π`, relative
/// error below 3e-7.
#[inline(always)]
fn angle<T: Lanes>(y: T, x: T) -> T {
    let size = x.abs();
    let steep = size.lt(y);
    let t = T::select(steep, size, y) / T::select(steep, y, size);
    // Chebyshev series of atan(t) / t in t², cut off below 1e-8.
    let t2 = t * t;
    let mut p = t.splat(0.002_834_064_2);
    for c in [
        -0.016_005_03,
        0.042_587_608,
        -0.074_954_46,
        0.106_367_54,
        -0.142_025_71,
        0.199_924_84,
        -0.333_330_66,
        1.0,
    ] {
        p = p * t2 + c;
    }
    let acute = p * t;
    let acute = T::select(steep, -acute + FRAC_PI_2, acute);
    T::select(x.lt(t.splat(0.0)), -acute + PI, acute)
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::dvec3;

    fn v3(v: DVec3) -> V3<f32> {
        V3::splat(0.0, v.as_vec3().to_array())
    }

    fn shape(shape: AreaShape) -> Shape {
        Shape::new(&shape, 1e18).unwrap()
    }

    /// The form factor from an element at the origin: the part of what it sends out that meets the
    /// shape.
    fn form_factor(shape: &Shape, n: DVec3, area: f64) -> f64 {
        f64::from(shape.mean(v3(DVec3::ZERO), v3(n))) * area / std::f64::consts::PI
    }

    /// A rectangle at height `h` above the origin, one corner on the z axis.
    fn ceiling(a: f64, b: f64, h: f64) -> Shape {
        let corners = vec![dvec3(0.0, 0.0, h), dvec3(0.0, b, h), dvec3(a, b, h), dvec3(a, 0.0, h)];
        shape(AreaShape::Polygon { corners })
    }

    #[test]
    fn the_centroid_of_a_concave_polygon_is_its_centre_of_mass() {
        // An L of three unit squares.
        let l = [[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]]
            .map(|[x, y]| dvec3(x, y, 0.0))
            .to_vec();
        let l = shape(AreaShape::Polygon { corners: l });
        let [x, y, z] = l.centroid.map(f64::from);
        assert!(
            dvec3(x, y, z).distance(dvec3(2.5 / 3.0, 2.5 / 3.0, 0.0)) < 1e-6
                && l.normal == [0.0, 0.0, 1.0]
        );
        assert!((l.half_density - 0.5 / 3.0).abs() < 1e-7);
        // A square's own is 1/6; the squared ways to the middles of the three are 2/9, 5/9, 5/9.
        assert!((f64::from(l.spread) - (1.0 / 6.0 + 4.0 / 9.0)).abs() < 1e-6, "{}", l.spread);
    }

    #[test]
    fn angles() {
        for i in 0..=1000 {
            let wanted = std::f64::consts::PI * f64::from(i) / 1000.0;
            let (sin, cos) = func::sin_cos(wanted);
            let found = angle(sin.abs() as f32 * 7.0, cos as f32 * 7.0);
            assert!((f64::from(found) - wanted).abs() < 4e-7, "{wanted}: {found}");
        }
    }

    #[test]
    fn a_parallel_rectangle_over_one_of_its_corners() {
        // F = (A atan(B / √(1 + A²)) / √(1 + A²) + B atan(A / √(1 + B²)) / √(1 + B²)) / 2π, with A
        // = a / h and B = b / h.
        for (a, b, h) in [(1.0, 1.0, 1.0), (2.0, 0.5, 1.0), (0.3, 0.4, 2.0), (5.0, 7.0, 0.5)] {
            let part = |a: f64, b: f64| {
                let root = (1.0 + a * a).sqrt();
                a / root * func::atan2(b, root)
            };
            let wanted = (part(a / h, b / h) + part(b / h, a / h)) / std::f64::consts::TAU;
            let found = form_factor(&ceiling(a, b, h), DVec3::Z, a * b);
            assert!((found - wanted).abs() < 1e-6, "{a} {b} {h}: {found}, {wanted}");
        }
        // The unit square a unit above its corner.
        let found = form_factor(&ceiling(1.0, 1.0, 1.0), DVec3::Z, 1.0);
        assert!((found - 0.138_532_1).abs() < 1e-6, "{found}");
    }

    #[test]
    fn a_perpendicular_rectangle() {
        // F = (atan(1 / Y) - Y / √(X² + Y²) atan(1 / √(X² + Y²))) / 2π, the rectangle as wide as b
        // and as high as a at distance c, with X = a / b and Y = c / b.
        for (a, b, c) in [(1.0, 1.0, 1.0), (2.0, 0.5, 1.5), (0.2, 3.0, 0.4)] {
            let (x, y) = (a / b, c / b);
            let root = f64::sqrt(x * x + y * y);
            let wanted =
                (func::atan2(1.0, y) - y / root * func::atan2(1.0, root)) / std::f64::consts::TAU;
            let wall = [dvec3(c, 0.0, 0.0), dvec3(c, 0.0, a), dvec3(c, b, a), dvec3(c, b, 0.0)];
            let found =
                form_factor(&shape(AreaShape::Polygon { corners: wall.to_vec() }), DVec3::Z, a * b);
            assert!((found - wanted).abs() < 1e-6, "{a} {b} {c}: {found}, {wanted}");
            // Twice as high, half of it below the horizon.
            let wall = [dvec3(c, 0.0, -a), dvec3(c, 0.0, a), dvec3(c, b, a), dvec3(c, b, -a)];
            let found = form_factor(
                &shape(AreaShape::Polygon { corners: wall.to_vec() }),
                DVec3::Z,
                2.0 * a * b,
            );
            assert!((found - wanted).abs() < 1e-6, "cut, {a} {b} {c}: {found}, {wanted}");
        }
    }

    #[test]
    fn a_disc_over_its_middle_and_beside_it() {
        for (radius, height) in [(1.0, 1.0), (0.01, 1.0), (3.0, 0.2), (1e-6, 4.0)] {
            let center = DVec3::Z * height;
            let disc = shape(AreaShape::Disc { center, normal: DVec3::NEG_Z, radius });
            let wanted = radius * radius / (radius * radius + height * height);
            let found = form_factor(&disc, DVec3::Z, std::f64::consts::PI * radius * radius);
            assert!(
                (found - wanted).abs() < 1e-6 * wanted.max(1e-3),
                "{radius} {height}: {found}, {wanted}"
            );
        }
        // Beside the axis, on a parallel and on a perpendicular surface: Z = 1 + H² + R², in units
        // of the way to the axis.
        for (radius, height, way) in [(0.5, 1.0, 1.0), (1.0, 0.3, 2.0), (2.0, 1.0, 0.7)] {
            let center = dvec3(way, 0.0, height);
            let disc = shape(AreaShape::Disc { center, normal: DVec3::NEG_Z, radius });
            let (h, r) = (height / way, radius / way);
            let z = 1.0 + h * h + r * r;
            let root = f64::sqrt(z * z - 4.0 * r * r);
            let area = std::f64::consts::PI * radius * radius;
            let parallel = form_factor(&disc, DVec3::Z, area);
            assert!((parallel - 0.5 * (1.0 - (z - 2.0 * r * r) / root)).abs() < 1e-6, "{parallel}");
            if radius <= way {
                let upright = form_factor(&disc, DVec3::X, area);
                assert!((upright - 0.5 * h * (z / root - 1.0)).abs() < 1e-6, "{upright}");
            }
        }
    }

    /// The mean over a shape by adding up many small pieces: midpoints of squares, clipped by the
    /// horizon.
    fn summed(
        corner: DVec3,
        sides: [DVec3; 2],
        inside: impl Fn(f64, f64) -> bool,
        n: DVec3,
    ) -> f64 {
        let normal = sides[0].cross(sides[1]).normalize();
        let count = 1000;
        let (mut sum, mut pieces) = (0.0, 0.0);
        for (i, k) in (0..count).flat_map(|i| (0..count).map(move |k| (i, k))) {
            let [u, v] = [i, k].map(|i| (f64::from(i) + 0.5) / f64::from(count));
            if !inside(u, v) {
                continue;
            }
            let p = corner + sides[0] * u + sides[1] * v;
            pieces += 1.0;
            sum += n.dot(p).max(0.0) * (-normal.dot(p)).max(0.0)
                / (p.length_squared() * p.length_squared());
        }
        sum / pieces
    }

    #[test]
    fn tilted_cut_and_concave_shapes_are_the_sum_of_their_pieces() {
        let normals = [
            DVec3::Z,
            dvec3(1.0, 0.3, 0.2),
            dvec3(-0.7, 0.2, 0.4),
            dvec3(0.2, -1.0, -0.4),
            dvec3(0.0, 0.0, -1.0),
        ];
        let (corner, sides) =
            (dvec3(-0.7, -0.4, 1.1), [dvec3(0.3, 1.5, 0.4), dvec3(2.0, -0.3, 0.1)]);
        let at = |u: f64, v: f64| corner + sides[0] * u + sides[1] * v;
        let square = vec![at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
        // A U: the horizon cuts it in up to three places.
        let u =
            [[0., 0.], [1., 0.], [1., 1.], [0., 1.], [0., 0.7], [0.8, 0.7], [0.8, 0.3], [0., 0.3]];
        let u = u.map(|[x, y]| at(x, y)).to_vec();
        let (square, u) = (
            shape(AreaShape::Polygon { corners: square }),
            shape(AreaShape::Polygon { corners: u }),
        );
        let mut cut = 0;
        for n in normals.map(DVec3::normalize) {
            let wanted = summed(corner, sides, |_, _| true, n);
            let found = f64::from(square.mean(v3(DVec3::ZERO), v3(n)));
            assert!((found - wanted).abs() < 1e-6, "{n}: {found}, {wanted}");
            let wanted = summed(corner, sides, |x, y| x > 0.8 || !(0.3..=0.7).contains(&y), n);
            let found = f64::from(u.mean(v3(DVec3::ZERO), v3(n)));
            assert!((found - wanted).abs() < 2e-6, "{n}: {found}, {wanted}");
            cut += u32::from(found > 0.0 && n.z < 0.5);
        }
        assert!(cut >= 3);
    }

    #[test]
    fn a_disc_that_the_horizon_cuts() {
        let (center, normal) = (dvec3(0.2, 0.1, 1.0), dvec3(0.3, -0.2, -1.0).normalize());
        let (x, y) = normal.any_orthonormal_pair();
        let disc = shape(AreaShape::Disc { center, normal, radius: 0.8 });
        let inside =
            |u: f64, v: f64| f64::sqrt((u - 0.5) * (u - 0.5) + (v - 0.5) * (v - 0.5)) < 0.5;
        for n in [dvec3(1.0, 0.2, 0.1), dvec3(-0.5, 1.0, 0.0), dvec3(0.3, 0.9, -0.3)]
            .map(DVec3::normalize)
        {
            let wanted = summed(center - (x + y) * 0.8, [x * 1.6, y * 1.6], inside, n);
            let found = f64::from(disc.mean(v3(DVec3::ZERO), v3(n)));
            assert!((found - wanted).abs() < 2e-3 * wanted, "{n}: {found}, {wanted}");
        }
        // No step where the horizon begins to cut.
        let steps = (0..2000).map(|i| {
            let (sin, cos) = func::sin_cos(f64::from(i) * 1e-3);
            f64::from(disc.mean(v3(DVec3::ZERO), v3(dvec3(sin, 0.0, cos))))
        });
        let steps: Vec<f64> = steps.collect();
        let largest =
            steps.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).abs()).fold(0.0, f64::max);
        assert!(largest < 2e-4 * steps[0], "{largest} of {}", steps[0]);
    }

    #[test]
    fn small_shapes_are_points() {
        let (from, n) = (dvec3(0.3, 0.4, 1.2), dvec3(0.1, 0.2, 1.0).normalize());
        let point = {
            let d = from.length();
            n.dot(from) / d * (from.z / d) / (d * d)
        };
        for size in [1e-9, 1e-6, 1e-4, 3e-3, 6e-3, 1e-2] {
            let corners = [[0., 0.], [0., 1.], [1., 1.], [1., 0.]];
            let corners = corners.map(|[x, y]| from + dvec3(x - 0.5, y - 0.5, 0.0) * size).to_vec();
            let square = shape(AreaShape::Polygon { corners });
            let disc = shape(AreaShape::Disc { center: from, normal: DVec3::NEG_Z, radius: size });
            for found in [square, disc].map(|s| f64::from(s.mean(v3(DVec3::ZERO), v3(n)))) {
                assert!((found / point - 1.0).abs() < 2e-4, "{size}: {found}, {point}");
            }
        }
        let disc = shape(AreaShape::Disc { center: from, normal: DVec3::NEG_Z, radius: 0.0 });
        assert!((f64::from(disc.mean(v3(DVec3::ZERO), v3(n))) / point - 1.0).abs() < 1e-6);
    }

    #[test]
    fn behind_the_light_on_it_and_in_its_plane_nothing_arrives() {
        let corners =
            [[0., 0.], [0., 1.], [1., 1.], [1., 0.]].map(|[x, y]| dvec3(x, y, 1.0)).to_vec();
        let square = shape(AreaShape::Polygon { corners });
        let disc = shape(AreaShape::Disc { center: DVec3::Z, normal: DVec3::NEG_Z, radius: 0.5 });
        for light in [square, disc] {
            for p in [dvec3(0.2, 0.2, 2.0), dvec3(0.2, 0.2, 1.0), dvec3(9.0, 3.0, 1.0), DVec3::Z] {
                for n in [DVec3::Z, DVec3::NEG_Z, DVec3::X] {
                    assert_eq!(light.mean(v3(p), v3(n)), 0.0, "{p} {n}");
                }
            }
            // Close before it all that is seen is light.
            let area = 0.5 / f64::from(light.half_density);
            let close = f64::from(light.mean(v3(dvec3(0.2, 0.2, 0.9999)), v3(DVec3::Z))) * area
                / std::f64::consts::PI;
            assert!((close - 1.0).abs() < 1e-3, "{close}");
        }
    }
}
