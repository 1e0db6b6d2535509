//! Lines on the screen along which facets are cut, and what is left of a triangle between them.
//!
//! Whether a sample lies on the kept side of a line is one function, the same for both halves of a
//! cut. Outlines, by contrast, are computed with rounding: they err outwards.

use vitral_raster::{SUBPIXEL, Setup};

/// A facet's depth as a linear function of the place, not clamped: `at_zero + slope . (x, y)` in
/// 1/256 pixel.
#[derive(Clone, Copy)]
pub(super) struct Depth {
    /// Change of depth with 1/256 pixel along x and y.
    pub(super) slope: [f64; 2],
    /// Depth at the screen's origin.
    pub(super) at_zero: f64,
}

impl Depth {
    pub(super) fn of(setup: &Setup) -> Self {
        let slope = [setup.dz_dx, setup.dz_dy].map(|d| f64::from(d) / f64::from(SUBPIXEL));
        let origin = setup.origin.map(f64::from);
        Self { slope, at_zero: f64::from(setup.z) - slope[0] * origin[0] - slope[1] * origin[1] }
    }

    pub(super) fn minus(self, other: Self) -> Self {
        let slope = [self.slope[0] - other.slope[0], self.slope[1] - other.slope[1]];
        Self { slope, at_zero: self.at_zero - other.at_zero }
    }

    pub(super) fn at(self, [x, y]: [f64; 2]) -> f64 {
        self.at_zero + self.slope[0] * x + self.slope[1] * y
    }
}

/// A line `a x + b y + c = 0` on the screen (1/256 pixel), and the side of it that is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cut {
    /// Factor of x.
    pub(super) a: f64,
    /// Factor of y.
    pub(super) b: f64,
    /// Constant.
    pub(super) c: f64,
    /// Keeps where the value is not negative, else where it is (or is not a number).
    pub(super) positive: bool,
}

impl Cut {
    /// The value at a point. Monotonic in x and in y, rounding included.
    #[inline]
    pub(super) fn value(&self, [x, y]: [f64; 2]) -> f64 {
        (self.c + self.b * y) + self.a * x
    }

    /// Whether a sample lies on the kept side.
    #[inline]
    pub(super) fn keeps(&self, p: [f64; 2]) -> bool {
        (self.value(p) >= 0.0) == self.positive
    }

    /// The same line, the other side.
    pub(super) fn opposite(self) -> Self {
        Self { positive: !self.positive, ..self }
    }

    /// Whether a box, given by its smallest and largest corner, lies on the kept side with room to
    /// spare.
    pub(super) fn holds_box(&self, [[x0, y0], [x1, y1]]: [[f64; 2]; 2]) -> bool {
        let x = if (self.a > 0.0) == self.positive { x0 } else { x1 };
        let y = if (self.b > 0.0) == self.positive { y0 } else { y1 };
        self.holds(&[[x, y]])
    }

    /// Whether a polygon lies on the kept side with room to spare, so that no sample in it can be
    /// beyond.
    pub(super) fn holds(&self, polygon: &[[f64; 2]]) -> bool {
        polygon.iter().all(|&[x, y]| {
            let v = self.value([x, y]);
            let room = (self.c.abs() + (self.b * y).abs() + (self.a * x).abs()) * 1e-9;
            if self.positive { v > room } else { v < -room }
        })
    }

    /// How far inside a point is, made a little larger than rounding could make it smaller.
    fn inside(&self, [x, y]: [f64; 2]) -> f64 {
        let v = self.value([x, y]);
        let slack = (self.c.abs() + (self.b * y).abs() + (self.a * x).abs()) * 1e-14;
        if self.positive { v + slack } else { slack - v }
    }
}

/// The corners of a triangle on the screen.
pub(super) fn corners(setup: &Setup) -> [[f64; 2]; 3] {
    [0, 1, 2].map(|i| [f64::from(setup.x[i]), f64::from(setup.y[i])])
}

/// Smallest and largest corner of the box round a triangle.
pub(super) fn around(setup: &Setup) -> [[f64; 2]; 2] {
    let range = |v: &[i32; 3]| [v[0].min(v[1]).min(v[2]), v[0].max(v[1]).max(v[2])].map(f64::from);
    let ([x0, x1], [y0, y1]) = (range(&setup.x), range(&setup.y));
    [[x0, y0], [x1, y1]]
}

/// Cuts a convex polygon along a line, erring outwards.
pub(super) fn clip_outline(polygon: &mut Vec<[f64; 2]>, scratch: &mut Vec<[f64; 2]>, cut: &Cut) {
    // A line without numbers cuts nothing off.
    if !(cut.a + cut.b + cut.c).is_finite() {
        return;
    }

    // Walk the outline: keep inner corners and add crossings.
    let Some(&(mut from)) = polygon.last() else { return };
    let mut d_from = cut.inside(from);
    let outside = |d: f64| d < 0.0;
    scratch.clear();
    for &to in polygon.iter() {
        let d_to = cut.inside(to);
        if outside(d_from) != outside(d_to) {
            let t = d_from / (d_from - d_to);
            scratch.push([from[0] + (to[0] - from[0]) * t, from[1] + (to[1] - from[1]) * t]);
        }
        if !outside(d_to) {
            scratch.push(to);
        }
        (from, d_from) = (to, d_to);
    }
    std::mem::swap(polygon, scratch);
}

/// Smallest and largest corner of the box round a polygon.
pub(super) fn bounds(polygon: &[[f64; 2]]) -> [[f64; 2]; 2] {
    polygon.iter().fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], p| {
        [[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]]
    })
}
