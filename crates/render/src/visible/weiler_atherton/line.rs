//! Lines with whole coefficients, and the points where they cross, compared exactly.
//!
//! A point is not rounded: it is the crossing of two lines, and which side of a third line it lies
//! on is the sign of a whole number. Most questions are decided by floating-point numbers that are
//! far enough from zero; only close ones are computed with 128 bits.
//!
//! Bits, in units of 1/256 pixel: a picture has at most 16384 pixels a side, 2^22 units. Corners
//! lie in the guard band, at most 16384 pixels from the picture's middle, so their coordinates are
//! below 2^23 and their differences at most 2^23. A side has `a, b <= 2^23` and `c < 2^48`; where
//! two planes meet, `a, b <= 2^25` and `c < 2^49`. Two such lines cross at `(x / w, y / w)` with
//! `w <= 2^51`. Ends of edges lie in the picture: `x, y <= 2^22 w <= 2^73`. The side of a line is
//! the sign of `a x + b y + c w < 2^102`. Two points are compared by `x1 w2` and `x2 w1`, below
//! 2^124: they fit into 128 bits.
//!
//! Source: points as crossings after [Bernstein & Fussell 2009].

use std::cmp::Ordering;

/// The greatest `|a|` and `|b|` of a line.
pub(super) const MAX_SLOPE: i64 = 1 << 25;

/// The greatest `|c|` of a line that crosses a picture.
pub(super) const MAX_OFFSET: i64 = 1 << 49;

/// `a x + b y + c`, positive on the inner side. The line runs in the direction `(b, -a)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Line {
    /// Factor of x.
    pub(super) a: i32,
    /// Factor of y.
    pub(super) b: i32,
    pub(super) c: i64,
}

/// A point on the screen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    /// About where it is, 1/256 pixel. A corner is exactly there.
    pub(super) about: [f64; 2],
    /// Two lines through it that are not parallel.
    lines: [Line; 2],
    /// Whether it is a corner of the grid.
    is_corner: bool,
}

/// Beyond this, in 1/256 pixel, the rounding of [`Point::about`] cannot matter: it is below 2^-28
/// in a picture.
pub(super) const ROUNDING: f64 = 1e-6;

impl Point {
    /// A corner of the grid, where two lines cross.
    pub(super) fn corner(corner: [i32; 2], lines: [Line; 2]) -> Self {
        Self { about: corner.map(f64::from), lines, is_corner: true }
    }

    /// `(x / w, y / w)`, `w` positive.
    fn exact(&self) -> [i128; 3] {
        if self.is_corner {
            return [self.about[0] as i128, self.about[1] as i128, 1];
        }
        let [[a, b, c], [d, e, f]] =
            self.lines.map(|l| [l.a.into(), l.b.into(), l.c].map(i128::from));
        let (x, y, w) = (b * f - e * c, c * d - f * a, a * e - d * b);
        if w < 0 { [-x, -y, -w] } else { [x, y, w] }
    }

    /// Compares x (`axis` 0) or y.
    pub(super) fn compare(&self, other: &Self, axis: usize) -> Ordering {
        let gap = self.about[axis] - other.about[axis];
        if gap.abs() > ROUNDING || (self.is_corner && other.is_corner) {
            return gap.partial_cmp(&0.0).unwrap_or(Ordering::Equal);
        }
        let (one, two) = (self.exact(), other.exact());
        (one[axis] * two[2]).cmp(&(two[axis] * one[2]))
    }

    /// Compares x, and of equal ones y.
    pub(super) fn compare_both(&self, other: &Self) -> Ordering {
        self.compare(other, 0).then_with(|| self.compare(other, 1))
    }

    /// The smallest whole number that is not less than its y.
    pub(super) fn y_up(&self) -> i32 {
        let y = self.about[1];
        let nearest = y.round();
        if self.is_corner || (y - nearest).abs() > ROUNDING {
            return y.ceil() as i32;
        }
        let [_, y, w] = self.exact();
        let nearest = nearest as i128;
        (if y > nearest * w { nearest + 1 } else { nearest }) as i32
    }
}

impl Line {
    /// The line through two corners of the grid.
    pub(super) fn through(from: [i32; 2], to: [i32; 2]) -> Self {
        let [dx, dy] = [0, 1].map(|k| to[k] - from[k]);
        let c = i64::from(dy) * i64::from(from[0]) - i64::from(dx) * i64::from(from[1]);
        Self { a: -dy, b: dx, c }
    }

    pub(super) fn reversed(self) -> Self {
        Self { a: -self.a, b: -self.b, c: -self.c }
    }

    /// Its value at a corner of the grid.
    pub(super) fn at(&self, [x, y]: [i32; 2]) -> i64 {
        i64::from(self.a) * i64::from(x) + i64::from(self.b) * i64::from(y) + self.c
    }

    /// Its value at about a place.
    pub(super) fn about(&self, [x, y]: [f64; 2]) -> f64 {
        f64::from(self.a) * x + f64::from(self.b) * y + self.c as f64
    }

    /// What [`Self::about`] says more or less at a place that is up to 1/100 unit away.
    pub(super) fn slack(&self) -> f64 {
        (f64::from(self.a).abs() + f64::from(self.b).abs()) * 0.01 + (self.c as f64).abs() * 1e-14
    }

    /// On which side a point lies.
    pub(super) fn side(&self, p: &Point) -> Ordering {
        if p.is_corner {
            return self.at(p.about.map(|v| v as i32)).cmp(&0);
        }
        // Rounding of the point, and of the sum, whose parts may be large.
        let value = self.about(p.about);
        let slack = (f64::from(self.a).abs() + f64::from(self.b).abs()) * ROUNDING
            + (self.c as f64).abs() * 1e-14;
        if value.abs() > slack {
            return value.total_cmp(&0.0);
        }
        if p.lines.iter().any(|line| line == self || line.reversed() == *self) {
            return Ordering::Equal;
        }
        let [x, y, w] = p.exact();
        let [a, b, c] = [self.a.into(), self.b.into(), self.c].map(i128::from);
        (a * x + b * y + c * w).cmp(&0)
    }

    /// How steeply another line falls to its negative side, on the way along this one: 0 for
    /// parallel lines.
    pub(super) fn cross(&self, other: &Self) -> i64 {
        i64::from(self.a) * i64::from(other.b) - i64::from(other.a) * i64::from(self.b)
    }

    /// Where two lines that are not parallel cross.
    pub(super) fn crossing(&self, other: &Self) -> Point {
        let w = self.cross(other) as f64;
        // The products need up to 74 bits, and may cancel.
        let [[a, b, c], [d, e, f]] =
            [self, other].map(|l| [l.a.into(), l.b.into(), l.c].map(i128::from));
        let about = [(b * f - e * c) as f64 / w, (c * d - f * a) as f64 / w];
        Point { about, lines: [*self, *other], is_corner: false }
    }

    /// Which of two points on the line comes first.
    pub(super) fn compare(&self, one: &Point, two: &Point) -> Ordering {
        let (axis, forwards) =
            if self.b.abs() >= self.a.abs() { (0, self.b > 0) } else { (1, self.a < 0) };
        let order = one.compare(two, axis);
        if forwards { order } else { order.reverse() }
    }
}

/// A piece of a boundary, directed, with the region on the positive side of its line.
#[derive(Clone, Copy, Debug)]
pub(super) struct RegionEdge {
    pub(super) line: Line,
    /// About where it begins and ends.
    pub(super) about: [[f64; 2]; 2],
    /// Lines that cross its own there.
    across: [Line; 2],
    is_corner: [bool; 2],
}

impl RegionEdge {
    /// Between two points on a line.
    pub(super) fn new(line: Line, ends: [Point; 2]) -> Self {
        let across =
            ends.map(|p| if line.cross(&p.lines[0]) == 0 { p.lines[1] } else { p.lines[0] });
        Self { line, about: ends.map(|p| p.about), across, is_corner: ends.map(|p| p.is_corner) }
    }

    /// Where it begins (0) or ends (1).
    pub(super) fn end(&self, which: usize) -> Point {
        let lines = [self.line, self.across[which]];
        Point { about: self.about[which], lines, is_corner: self.is_corner[which] }
    }

    /// Whether its box touches one: smallest x and y, largest x and y.
    pub(super) fn touches(&self, around: [f64; 4]) -> bool {
        (0..2).all(|k| {
            let [from, to] = self.about.map(|p| p[k]);
            from.min(to) <= around[k + 2] + ROUNDING && from.max(to) >= around[k] - ROUNDING
        })
    }

    /// The same edge of what lies on the other side.
    pub(super) fn reversed(&self) -> Self {
        let [from, to] = [self.end(0), self.end(1)];
        Self::new(self.line.reversed(), [to, from])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_greatest_numbers_are_compared_exactly() {
        // Nearly parallel lines with the greatest coefficients, that cross in the picture's far
        // corner.
        let [x, y] = [1i64 << 22; 2];
        let through =
            |a: i64, b: i64, off: i64| Line { a: a as i32, b: b as i32, c: -(a * x + b * y) + off };
        let (m, n) = (MAX_SLOPE, MAX_SLOPE - 1);
        let one = through(m, -n, 0).crossing(&through(-n, m, 0));
        let two = through(m, -n, 1).crossing(&through(-n, m, 0));
        let corner = Point::corner([1 << 22; 2], [through(1, 0, 0), through(0, 1, 0)]);
        assert_eq!([0, 1].map(|k| one.compare(&corner, k)), [Ordering::Equal; 2]);
        assert_eq!([0, 1].map(|k| two.compare(&corner, k)), [Ordering::Less; 2], "{two:?}");
        assert_eq!((one.y_up(), two.y_up()), (1 << 22, 1 << 22));
        assert_eq!(through(m, m, 0).side(&one), Ordering::Equal);
        assert_eq!(through(m, m, 1).side(&one), Ordering::Greater);
        assert!(through(m, m, 0).c.abs() <= MAX_OFFSET);
    }

    #[test]
    fn edges_keep_their_ends() {
        let [a, b, c] = [[0, 0], [1024, 0], [300, 700]];
        let sides = [Line::through(a, b), Line::through(b, c), Line::through(c, a)];
        let edge = RegionEdge::new(
            sides[0],
            [Point::corner(a, [sides[2], sides[0]]), sides[0].crossing(&sides[1])],
        );
        let turned = edge.reversed();
        for (one, two) in [(0, 1), (1, 0)] {
            assert_eq!(edge.end(one).compare_both(&turned.end(two)), Ordering::Equal);
        }
        assert_eq!(
            sides.map(|side| side.side(&edge.end(1))),
            [Ordering::Equal, Ordering::Equal, Ordering::Greater]
        );
    }
}
