//! Where the light of a source comes from, as seen from a point: a direction, a point, or samples
//! of a shape.
//!
//! An area light is cut into cells of equal area, and one place is chosen at random in each
//! (stratified sampling): the part of the places that see the point is the part of the light that
//! arrives. In the umbra none does, in the penumbra some do. Chance is a hash of the point's place
//! in the picture, so that a picture is the same however it is made, and neighbouring pixels err
//! differently: noise instead of bands.
//!
//! Places do not count alike. What a light wholly in view sends to a point is computed without
//! sampling, and shadows only say which part of it arrives; so each place counts with
//! `cos θ cos θ' / d²`, its share in that whole (a *ratio estimator*). Places below the horizon of
//! the point's facet have no share: they are not in the whole either.
//!
//! A disc's cells are squares of a square that is mapped to the disc ring by ring, which keeps
//! areas in proportion. A polygon's are squares of the rectangle round it, along its longest edge,
//! whose middle lies inside.
//!
//! In:   a light, world space. Out: places on it, less the scene's middle.
//! Cost: one ray for each cell.
//! Source: [Cook, Porter & Carpenter 1984]; the disc after [Shirley & Chiu 1997], shares after
//!         [Heitz, Hill & McGuire 2018].

use super::hash::hash;
use super::places::{LightVisibility, SurfacePoint, SurfacePoints};
use super::rounding::horizon;
use std::f64::consts::FRAC_PI_4;
use vitral_light::{AreaShape, Light, LightKind, Rgb};
use vitral_math::{DVec2, DVec3, DVec4, dvec2, func};

/// See the module.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum LightSource {
    /// It casts no shadows.
    Unoccluded,
    /// Unit vector towards the light.
    Infinity(DVec3),
    /// A light at one position.
    Point(DVec3),
    /// A flat shape.
    Area(Area),
}

/// A flat shape, cut into cells.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Area {
    shape: Shape,
    /// Lower corners of the cells, in coordinates of the shape.
    cells: Vec<DVec2>,
    /// Sides of a cell.
    size: DVec2,
    /// Places within the cells that are the same for all points.
    even: Vec<DVec2>,
    origin: DVec3,
    axes: [DVec3; 2],
    /// Unit normal.
    normal: DVec3,
}

/// A place that light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Emitter {
    /// Homogeneous, less the scene's middle: `w` is 0 for a direction.
    pub(super) at: DVec4,
    /// Unit normal of the shape; zero where there is none.
    normal: DVec3,
}

/// Adds up what arrives from the places of a light.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Shares {
    lit: Rgb,
    whole: f32,
}

#[derive(Clone, Debug, PartialEq)]
enum Shape {
    /// The unit disc.
    Disc,
    /// Its corners.
    Polygon(Vec<DVec2>),
}

impl LightSource {
    /// The light's, with about `samples` cells, less `center`.
    pub(super) fn new(light: &Light, samples: u32, center: DVec3) -> Self {
        if !light.shadow || !light.enabled {
            return Self::Unoccluded;
        }
        match &light.kind {
            LightKind::Ambient => Self::Unoccluded,
            LightKind::Directional { direction } => {
                (-*direction).try_normalize().map_or(Self::Unoccluded, Self::Infinity)
            }
            LightKind::Point { position } | LightKind::Spot { position, .. } => {
                Self::Point(*position - center)
            }
            LightKind::Area { shape } => {
                Area::new(shape, samples, center).map_or(Self::Unoccluded, Self::Area)
            }
        }
    }
}

impl LightSource {
    /// The places that light comes from, the same for all points. None if it casts no shadows.
    pub(super) fn places(&self) -> Vec<Emitter> {
        let only = |at: DVec4| vec![Emitter { at, normal: DVec3::ZERO }];
        match self {
            Self::Unoccluded => Vec::new(),
            Self::Infinity(towards) => only(towards.extend(0.0)),
            Self::Point(at) => only(at.extend(1.0)),
            Self::Area(area) => (0..area.count()).map(|i| area.emitter(i, 0)).collect(),
        }
    }
}

impl Emitter {
    /// The place's share in what the facet of `place` gets of the light; 0 if it looks away, 1 for
    /// a light of one place.
    pub(super) fn weight(&self, place: &SurfacePoint) -> f32 {
        let way = self.at.truncate() - place.position * self.at.w;
        let cos = place.normal.dot(way);
        if self.normal == DVec3::ZERO {
            return f32::from(u8::from(cos > horizon(place.position, self.at)));
        }
        // Behind the light, too, the places are told apart.
        let square = way.length_squared();
        let weight = cos * self.normal.dot(way).abs() / (square * square);
        if weight > 0.0 { weight.min(1e30) as f32 } else { 0.0 }
    }
}

impl Shares {
    /// Adds a place; `passing` tells what arrives of it, unless it does not count.
    pub(super) fn add(&mut self, weight: f32, passing: impl FnOnce() -> Rgb) {
        if weight > 0.0 {
            self.whole += weight;
            let passing = passing();
            self.lit = [0, 1, 2].map(|k| self.lit[k] + weight * passing[k]);
        }
    }

    /// The part of the whole that arrives.
    pub(super) fn part(&self) -> Rgb {
        self.lit.map(|channel| if self.whole > 0.0 { channel / self.whole } else { 0.0 })
    }

    /// Parts from what arrives at each of the places, weighted, and added in the order of the
    /// emitters.
    pub(super) fn normalize(
        emitters: impl Iterator<Item = Emitter> + Clone,
        places: &SurfacePoints,
        parts: &mut LightVisibility,
    ) {
        for (number, place) in places.iter().enumerate() {
            let whole: f32 = emitters.clone().map(|e| e.weight(&place)).sum();
            parts.set(number, Self { lit: parts.get(number), whole }.part());
        }
    }
}

impl Area {
    /// `None` for a shape without a normal.
    fn new(shape: &AreaShape, samples: u32, center: DVec3) -> Option<Self> {
        match shape {
            AreaShape::Disc { center: middle, normal, radius } => {
                let normal = normal.try_normalize()?;
                let (x, y) = normal.any_orthonormal_pair();
                let (cells, size) = cells([DVec2::NEG_ONE, DVec2::ONE], 1.0, samples, |_| true);
                let axes = [x * *radius, y * *radius];
                let even = even(&cells, size);
                Some(Self {
                    shape: Shape::Disc,
                    cells,
                    size,
                    even,
                    origin: *middle - center,
                    axes,
                    normal,
                })
            }
            AreaShape::Polygon { corners } => Self::polygon(corners, samples, center),
        }
    }

    fn polygon(corners: &[DVec3], samples: u32, center: DVec3) -> Option<Self> {
        // Compute the area, the normal and axes along the longest side.
        let edges = || (0..corners.len()).map(|i| (corners[i], corners[(i + 1) % corners.len()]));
        let normal: DVec3 = edges().map(|(a, b)| (a - corners[0]).cross(b - corners[0])).sum();
        let (area, normal) = (0.5 * normal.length(), normal.try_normalize()?);
        let longest =
            edges().map(|(a, b)| b - a).max_by(|a, b| a.length().total_cmp(&b.length()))?;
        let x = longest.try_normalize()?;
        let y = normal.cross(x);

        // Flatten the polygon to its plane.
        let flat: Vec<DVec2> = corners
            .iter()
            .map(|&c| dvec2((c - corners[0]).dot(x), (c - corners[0]).dot(y)))
            .collect();
        let bounds = flat.iter().fold([flat[0]; 2], |[low, high], &p| [low.min(p), high.max(p)]);

        // Choose cells so that about as many as asked for lie inside.
        let extent = bounds[1] - bounds[0];
        let share = area / (extent.x * extent.y);
        let (cells, size) = cells(bounds, share, samples, |p| contains(&flat, p));
        let origin = corners[0] - center;
        let even = even(&cells, size);
        (!cells.is_empty()).then_some(Self {
            shape: Shape::Polygon(flat),
            cells,
            size,
            even,
            origin,
            axes: [x, y],
            normal,
        })
    }

    /// How many places are asked.
    pub(super) fn count(&self) -> usize {
        self.cells.len()
    }

    /// A place in cell `i`, by the chance that `seed` gives; for 0 the places are spread evenly.
    pub(super) fn emitter(&self, i: usize, seed: u32) -> Emitter {
        Emitter { at: self.place(i, seed).extend(1.0), normal: self.normal }
    }

    fn place(&self, i: usize, seed: u32) -> DVec3 {
        let p =
            self.cells[i] + self.size * if seed == 0 { self.even[i] } else { by_chance(i, seed) };
        let p = match &self.shape {
            Shape::Disc => disc_from_square(p),
            Shape::Polygon(corners) if contains(corners, p) => p,
            // A cell on the border: its middle is inside.
            Shape::Polygon(_) => self.cells[i] + self.size * 0.5,
        };
        self.origin + self.axes[0] * p.x + self.axes[1] * p.y
    }
}

/// A place in the unit square for each cell, where all points see the same places. Cells of one row
/// lie at different heights in theirs, and those of one column at different widths: along either
/// axis the places are spread as evenly as their number allows. What one offset rises by along a
/// row, the other falls by along a column, which makes a turned grid whose spread is the same in
/// all directions: edges of shadows are as wide as by any number of places, however they run.
fn even(cells: &[DVec2], size: DVec2) -> Vec<DVec2> {
    let low = cells.iter().fold(DVec2::INFINITY, |low, c| low.min(*c));
    let high = cells.iter().fold(DVec2::NEG_INFINITY, |high, c| high.max(*c));
    let counts = ((high - low) / size).round() + DVec2::ONE;
    let within = |cell: &DVec2| {
        let number = ((*cell - low) / size).round();
        dvec2((number.y + 0.5) / counts.y, (counts.x - number.x - 0.5) / counts.x)
    };
    cells.iter().map(within).collect()
}

/// A place in the unit square for cell `i`, another for each seed.
fn by_chance(i: usize, seed: u32) -> DVec2 {
    let chance = hash(seed ^ hash(i as u32 + 1));
    let [u, v] = [chance & 0xffff, chance >> 16].map(|bits| (f64::from(bits) + 0.5) / 65_536.0);
    dvec2(u, v)
}

/// About `samples` cells, as square as may be, whose middles are `inside`; `share` of the rectangle
/// is.
fn cells(
    bounds: [DVec2; 2],
    share: f64,
    samples: u32,
    inside: impl Fn(DVec2) -> bool,
) -> (Vec<DVec2>, DVec2) {
    let extent = bounds[1] - bounds[0];
    let wanted = (f64::from(samples) / share.clamp(1e-3, 1.0)).ceil().max(1.0);
    let mut columns = (wanted * extent.x / extent.y).sqrt().round().clamp(1.0, wanted);
    // As many rows as fill up the number wanted.
    let mut rows = (wanted / columns).round().max(1.0);
    loop {
        let size = extent / dvec2(columns, rows);
        let corner = |i: u64, k: u64| bounds[0] + size * dvec2(i as f64, k as f64);
        let all = (0..rows as u64).flat_map(|k| (0..columns as u64).map(move |i| corner(i, k)));
        let cells: Vec<DVec2> = all.filter(|&c| inside(c + size * 0.5)).collect();
        if !cells.is_empty() || columns * rows > 1e5 {
            return (cells, size);
        }
        (columns, rows) = (columns * 2.0, rows * 2.0);
    }
}

/// From the square `-1..1` to the unit disc: squares round the middle become circles.
fn disc_from_square(p: DVec2) -> DVec2 {
    if p.x == 0.0 && p.y == 0.0 {
        return DVec2::ZERO;
    }
    let (radius, angle) = if p.x.abs() > p.y.abs() {
        (p.x, FRAC_PI_4 * (p.y / p.x))
    } else {
        (p.y, 2.0 * FRAC_PI_4 - FRAC_PI_4 * (p.x / p.y))
    };
    let (sin, cos) = func::sin_cos(angle);
    dvec2(cos, sin) * radius
}

/// Whether a polygon contains a point: a line to the right crosses its outline an odd number of
/// times.
fn contains(corners: &[DVec2], p: DVec2) -> bool {
    let mut inside = false;
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * ((p.y - a.y) / (b.y - a.y)) {
            inside = !inside;
        }
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_math::dvec3;

    fn area(shape: AreaShape, samples: u32) -> Area {
        Area::new(&shape, samples, DVec3::ZERO).unwrap()
    }

    #[test]
    fn each_cell_of_a_square_has_one_place() {
        let corners =
            [[0., 0.], [2., 0.], [2., 2.], [0., 2.]].map(|[x, y]| dvec3(x, y, 5.0)).to_vec();
        let square = area(AreaShape::Polygon { corners }, 16);
        assert_eq!(square.count(), 16);
        let mut seen = vec![0; 16];
        for i in 0..16 {
            let p = square.place(i, 77);
            assert_eq!(p.z, 5.0);
            let (x, y) = ((p.x * 2.0) as usize, (p.y * 2.0) as usize);
            seen[y * 4 + x] += 1;
        }
        assert_eq!(seen, [1; 16]);
    }

    #[test]
    fn the_same_places_for_all_points_are_spread_evenly_along_both_axes() {
        let corners =
            [[0., 0.], [4., 0.], [4., 4.], [0., 4.]].map(|[x, y]| dvec3(x, y, 0.0)).to_vec();
        let square = area(AreaShape::Polygon { corners }, 16);
        for axis in 0..2 {
            let mut along: Vec<f64> = (0..16).map(|i| square.place(i, 0)[axis]).collect();
            along.sort_by(f64::total_cmp);
            assert!(
                along.iter().zip(0..).all(|(v, i)| (v - (f64::from(i) + 0.5) / 4.0).abs() < 1e-12),
                "{along:?}"
            );
        }
    }

    #[test]
    fn places_stay_on_concave_polygons_and_discs() {
        let l = [[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]]
            .map(|[x, y]| dvec3(x, y, 0.0))
            .to_vec();
        let l = area(AreaShape::Polygon { corners: l }, 48);
        assert_eq!(l.count(), 48);
        let disc = AreaShape::Disc { center: DVec3::Z, normal: DVec3::Z * 3.0, radius: 2.0 };
        let disc = area(disc, 100);
        assert_eq!(disc.count(), 100);
        let mut inner = 0;
        for seed in 0..50 {
            for i in 0..48 {
                let p = l.place(i, seed);
                assert!(
                    p.x >= 0.0 && p.y >= 0.0 && p.max_element() <= 2.0 && p.min_element() <= 1.0
                );
            }
            for i in 0..100 {
                let p = disc.place(i, seed) - DVec3::Z;
                assert!(p.z.abs() < 1e-12 && p.length() <= 2.0 + 1e-12);
                inner += usize::from(p.length() < 2.0 / 2.0f64.sqrt());
            }
        }
        assert!(
            (2400..2600).contains(&inner),
            "half of the area holds half of the places: {inner} of 5000"
        );
    }

    #[test]
    fn shapes_without_area_are_no_sources() {
        let line = AreaShape::Polygon { corners: vec![DVec3::ZERO, DVec3::X, DVec3::X * 2.0] };
        assert_eq!(Area::new(&line, 4, DVec3::ZERO), None);
        assert_eq!(Area::new(&AreaShape::Polygon { corners: Vec::new() }, 4, DVec3::ZERO), None);
        // A disc of radius 0 is a point.
        let point = area(AreaShape::Disc { center: DVec3::X, normal: DVec3::Z, radius: 0.0 }, 4);
        assert!((0..4).all(|i| point.place(i, 9) == DVec3::X));
    }
}
