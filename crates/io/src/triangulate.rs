//! Cuts a polygon with `n` corners into exactly `n - 2` triangles, by ear clipping.
//!
//! The polygon is seen along its average normal (Newell's sum), so that a slightly bent polygon has
//! a plane to live in. Three cases, from cheap to dear: a quadrangle is cut along the diagonal that
//! starts at its inward corner, if it has one; a strictly convex polygon becomes a fan; anything
//! else loses one *ear* after the other: a corner that bends outward and whose triangle holds no
//! other corner, or one that comes twice in a row. A polygon that crosses itself or has no area may
//! run out of ears; then corners that at least do not bend inward are cut, and at last any corner,
//! so that there are always `n - 2` triangles.
//!
//! In:   positions in model space and a polygon's corners, in order, either orientation.
//! Out:  triangles with the polygon's orientation, as corner numbers `0..n`. The same for every run
//!       and machine.
//! Cost: `O(n)` for convex polygons; ear clipping takes `O(n * r)` ear tests of `O(r)` with `r`
//!       inward corners. Its work is limited to a multiple of `n` plus a constant; the part left
//!       then becomes a fan (a polygon of 100 000 corners must not stop the program).
//! Source: [Meisters 1975] (every simple polygon has two ears); Newell's normal after
//! [Sutherland, Sproull & Schumacker 1974].

/// Cuts the polygon whose corners are `corners` (indices into `positions`, at least three) into
/// triangles and appends them to `out`. The triangles' indices count the polygon's corners: `0` is
/// `corners[0]`. Fewer than three corners give nothing. A polygon with a NaN or infinite coordinate
/// becomes a fan.
///
/// # Panics
/// If a corner is not an index into `positions`.
pub fn triangulate(positions: &[[f32; 3]], corners: &[u32], out: &mut Vec<[u32; 3]>) {
    match corners.len() {
        0..3 => {}
        3 => out.push([0, 1, 2]),
        4 => out.extend(quadrangle(std::array::from_fn(|k| positions[corners[k] as usize]))),
        _ => {
            let space: Vec<[f32; 3]> = corners.iter().map(|&c| positions[c as usize]).collect();
            let points = plane_axes(&space)
                .map(|axes| space.iter().map(|&p| along(p, axes)).collect::<Vec<_>>());
            match points {
                Some(points) if !is_convex(&points) => EarClipper::new(points).run(out),
                _ => fan(&(0..corners.len() as u32).collect::<Vec<_>>(), out),
            }
        }
    }
}

/// The unit normal of a polygon by its orientation; zero where it has no area or a coordinate is
/// not finite.
pub(crate) fn polygon_normal(positions: &[[f32; 3]], corners: &[u32]) -> [f32; 3] {
    let space: Vec<[f32; 3]> = corners.iter().map(|&c| positions[c as usize]).collect();
    let n = newell(&space);
    let length = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
    if length > 0.0 && length.is_finite() { n.map(|c| (c / length) as f32) } else { [0.0; 3] }
}

/// A point of the polygon's plane, in any scale.
type Point = [f64; 2];

/// Twice the signed area of a triangle; positive: counter-clockwise.
fn cross(a: Point, b: Point, c: Point) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Newell's normal: twice the areas of the projections along the axes. Relative to the first
/// corner, so that a small polygon far from the origin keeps its digits.
fn newell(space: &[[f32; 3]]) -> [f64; 3] {
    let origin = space[0].map(f64::from);
    let local = |p: [f32; 3]| {
        [f64::from(p[0]) - origin[0], f64::from(p[1]) - origin[1], f64::from(p[2]) - origin[2]]
    };
    let mut normal = [0.0; 3];
    let mut a = local(space[space.len() - 1]);
    for &p in space {
        let b = local(p);
        normal[0] += (a[1] - b[1]) * (a[2] + b[2]);
        normal[1] += (a[2] - b[2]) * (a[0] + b[0]);
        normal[2] += (a[0] - b[0]) * (a[1] + b[1]);
        a = b;
    }
    normal
}

/// The two axes to keep when the polygon is seen along the axis nearest to its normal, ordered so
/// that it appears counter-clockwise; `None` without area or with a coordinate that is not finite.
fn plane_axes(space: &[[f32; 3]]) -> Option<[usize; 2]> {
    let normal = newell(space);
    let axis =
        (0..3).fold(0, |best, k| if normal[k].abs() > normal[best].abs() { k } else { best });
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    if !normal.iter().all(|n| n.is_finite()) || normal[axis] == 0.0 {
        return None;
    }
    Some(if normal[axis] < 0.0 { [v, u] } else { [u, v] })
}

fn along(p: [f32; 3], axes: [usize; 2]) -> Point {
    axes.map(|k| f64::from(p[k]))
}

/// Two triangles; the diagonal starts at the inward corner.
fn quadrangle(space: [[f32; 3]; 4]) -> [[u32; 3]; 2] {
    let from_0 = [[0, 1, 2], [0, 2, 3]];
    let Some(axes) = plane_axes(&space) else { return from_0 };
    let p = space.map(|p| along(p, axes));
    // The diagonal 0-2 leaves the triangles 1 and 3; the other one leaves 0 and 2.
    let outward = [
        cross(p[3], p[0], p[1]),
        cross(p[0], p[1], p[2]),
        cross(p[1], p[2], p[3]),
        cross(p[2], p[3], p[0]),
    ];
    if outward[1] > 0.0 && outward[3] > 0.0 {
        from_0
    } else if outward[0] > 0.0 && outward[2] > 0.0 {
        [[0, 1, 3], [1, 2, 3]]
    } else {
        from_0
    }
}

/// Whether every corner bends outward and the outline goes round once.
fn is_convex(points: &[Point]) -> bool {
    let n = points.len();
    let mut turns = 0;
    for i in 0..n {
        let (a, b, c) = (points[i], points[(i + 1) % n], points[(i + 2) % n]);
        if cross(a, b, c) <= 0.0 {
            return false;
        }
        // Going round once, the outline turns from upwards to downwards once, and back once.
        turns += usize::from((b[1] > a[1]) != (c[1] > b[1]));
    }
    turns <= 2
}

fn fan(corners: &[u32], out: &mut Vec<[u32; 3]>) {
    out.extend(corners.windows(2).skip(1).map(|w| [corners[0], w[0], w[1]]));
}

/// What a corner must be, to be cut: requirements are given up one after the other when no corner
/// meets them.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Demand {
    /// Bends outward, and its triangle holds no other corner; or holds nothing at all.
    Ear,
    /// Bends outward or not at all.
    NotInward,
    /// Nothing.
    Any,
}

/// A polygon that loses one corner after the other. Corners form a ring of links.
struct EarClipper {
    points: Vec<Point>,
    next: Vec<u32>,
    previous: Vec<u32>,
    /// Corners that do not bend outward: only they can lie in an ear. A corner that bends outward
    /// stays so in a simple polygon; those that were cut or have become outward are removed lazily.
    inward: Vec<u32>,
    is_inward: Vec<bool>,
    /// Point tests left.
    work: u64,
}

impl EarClipper {
    fn new(points: Vec<Point>) -> Self {
        let n = points.len() as u32;
        let mut clipper = Self {
            next: (0..n).map(|i| (i + 1) % n).collect(),
            previous: (0..n).map(|i| (i + n - 1) % n).collect(),
            inward: Vec::new(),
            is_inward: Vec::new(),
            work: 40_000_000 + 256 * u64::from(n),
            points,
        };
        clipper.is_inward = (0..n).map(|i| clipper.bend(i) <= 0.0).collect();
        clipper.inward = (0..n).filter(|&i| clipper.is_inward[i as usize]).collect();
        clipper
    }

    fn corner(&self, i: u32) -> [u32; 3] {
        [self.previous[i as usize], i, self.next[i as usize]]
    }

    /// Positive where the corner bends outward.
    fn bend(&self, i: u32) -> f64 {
        let [a, b, c] = self.corner(i).map(|k| self.points[k as usize]);
        cross(a, b, c)
    }

    fn run(mut self, out: &mut Vec<[u32; 3]>) {
        let mut left = self.points.len() as u32;
        let (mut i, mut refused, mut demand) = (0, 0, Demand::Ear);
        while left > 3 {
            // Out of time: a fan of what is left.
            if self.work == 0 {
                let ring: Vec<u32> =
                    std::iter::successors(Some(i), |&k| Some(self.next[k as usize]))
                        .take(left as usize)
                        .collect();
                return fan(&ring, out);
            }
            if self.meets(i, demand) {
                out.push(self.corner(i));
                i = self.cut(i);
                left -= 1;
                (refused, demand) = (0, Demand::Ear);
                continue;
            }
            // A whole round without success: ask for less.
            i = self.next[i as usize];
            refused += 1;
            if refused >= left {
                demand = if demand == Demand::Ear { Demand::NotInward } else { Demand::Any };
                refused = 0;
            }
        }
        out.push(self.corner(i));
    }

    fn meets(&mut self, i: u32, demand: Demand) -> bool {
        self.work = self.work.saturating_sub(1);
        match demand {
            Demand::Ear => self.is_hair(i) || self.bend(i) > 0.0 && self.is_empty_ear(i),
            Demand::NotInward => self.bend(i) >= 0.0,
            Demand::Any => true,
        }
    }

    /// Whether the corner is that of the next one again, or the end of an edge to and fro: without
    /// it the outline is round the same area, and with it neither it nor its double would ever
    /// bend.
    fn is_hair(&self, i: u32) -> bool {
        let [a, b, c] = self.corner(i).map(|k| self.points[k as usize]);
        b == c || a == c
    }

    /// Whether no inward corner lies in the triangle at `i`, its border included. Corners at the
    /// place of the triangle's own are passed over: outlines with a bridge to a hole visit such
    /// places twice.
    fn is_empty_ear(&mut self, i: u32) -> bool {
        let ear = self.corner(i);
        let [a, b, c] = ear.map(|k| self.points[k as usize]);
        let mut inward = std::mem::take(&mut self.inward);
        inward.retain(|&k| self.is_inward[k as usize]);
        self.work = self.work.saturating_sub(inward.len() as u64);
        let holds = |&k: &u32| {
            let p = self.points[k as usize];
            !ear.contains(&k)
                && p != a
                && p != b
                && p != c
                && cross(a, b, p) >= 0.0
                && cross(b, c, p) >= 0.0
                && cross(c, a, p) >= 0.0
        };
        let empty = !inward.iter().any(holds);
        self.inward = inward;
        empty
    }

    /// Removes corner `i` and gives the one to go on with: one further than the next, so that ears
    /// are taken all round and no corner collects a fan of slivers.
    fn cut(&mut self, i: u32) -> u32 {
        let [before, _, after] = self.corner(i);
        self.next[before as usize] = after;
        self.previous[after as usize] = before;
        self.is_inward[i as usize] = false;
        for k in [before, after] {
            let inward = self.bend(k) <= 0.0;
            if inward && !self.is_inward[k as usize] {
                self.inward.push(k);
            }
            self.is_inward[k as usize] = inward;
        }
        self.next[after as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cut(outline: &[[f32; 3]]) -> Vec<[u32; 3]> {
        let corners: Vec<u32> = (0..outline.len() as u32).collect();
        let mut out = Vec::new();
        triangulate(outline, &corners, &mut out);
        assert_eq!(out.len(), outline.len().saturating_sub(2));
        assert!(out.as_flattened().iter().all(|&i| (i as usize) < outline.len()));
        out
    }

    /// Sum of the triangles' areas, each with its sign as seen from +z, and without signs.
    fn areas(outline: &[[f32; 3]], triangles: &[[u32; 3]]) -> (f64, f64) {
        let flat = |i: u32| [f64::from(outline[i as usize][0]), f64::from(outline[i as usize][1])];
        let each = triangles.iter().map(|t| cross(flat(t[0]), flat(t[1]), flat(t[2])) / 2.0);
        (each.clone().sum(), each.map(f64::abs).sum())
    }

    #[test]
    fn an_arrow_head_is_cut_at_its_notch() {
        let arrow = [[0.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 2.0, 0.0], [1.0, 1.0, 0.0]];
        assert_eq!(cut(&arrow), [[0, 1, 3], [1, 2, 3]]);
        let turned = [arrow[3], arrow[0], arrow[1], arrow[2]];
        assert_eq!(cut(&turned), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn a_concave_outline_keeps_its_area() {
        // A comb with three teeth, standing in the plane z = x.
        let comb = [[0, 0], [6, 0], [6, 3], [5, 1], [4, 3], [3, 1], [2, 3], [1, 1], [0, 3]];
        let flat: Vec<[f32; 3]> =
            comb.iter().map(|p| [p[0] as f32, p[1] as f32, p[0] as f32]).collect();
        let (signed, unsigned) = areas(&flat, &cut(&flat));
        assert_eq!((signed, unsigned), (12.0, 12.0));
        let reversed: Vec<[f32; 3]> = flat.iter().rev().copied().collect();
        assert_eq!(areas(&reversed, &cut(&reversed)), (-12.0, 12.0));
    }

    #[test]
    fn doubled_corners_and_hairs_hold_nothing() {
        // An L whose corners come twice, and one with an edge to and fro.
        let corner = |p: [i32; 2]| [p[0] as f32, p[1] as f32, 0.0];
        let ell = [[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]].map(corner);
        let doubled: Vec<[f32; 3]> = ell.iter().flat_map(|&p| [p, p, p]).collect();
        for shift in 0..doubled.len() {
            let mut outline = doubled.clone();
            outline.rotate_left(shift);
            assert_eq!(areas(&outline, &cut(&outline)), (6.0, 6.0), "{shift}");
        }
        let mut hairy = ell.to_vec();
        hairy.splice(3..3, [[3, 1], [3, 2], [3, 1]].map(corner));
        assert_eq!(areas(&hairy, &cut(&hairy)), (6.0, 6.0));
    }

    #[test]
    fn corners_on_a_straight_edge_make_no_empty_triangles() {
        let square: Vec<[f32; 3]> = [[0, 0], [1, 0], [2, 0], [2, 2], [1, 2], [0, 2]]
            .map(|p: [i32; 2]| [p[0] as f32, p[1] as f32, 0.0])
            .into();
        let triangles = cut(&square);
        assert!(triangles.iter().all(|t| areas(&square, &[*t]).0 > 0.0), "{triangles:?}");
    }

    #[test]
    fn degenerate_outlines_still_give_all_triangles() {
        cut(&[[1.0; 3]; 7]);
        cut(&[
            [f32::NAN, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
            [-1.0, 0.5, 0.0],
        ]);
        let round = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        cut(&round.repeat(200));
        // A pentagram goes round twice: no fan, still three triangles.
        cut(&[
            [0.0, 3.0, 0.0],
            [-2.0, -3.0, 0.0],
            [3.0, 1.0, 0.0],
            [-3.0, 1.0, 0.0],
            [2.0, -3.0, 0.0],
        ]);
    }

    #[test]
    fn a_huge_star_does_not_hang() {
        let n = 100_000;
        let star: Vec<[f32; 3]> = (0..n)
            .map(|i| {
                let (s, c) =
                    vitral_math::func::sin_cos(f64::from(i) * std::f64::consts::TAU / f64::from(n));
                let r = if i % 2 == 0 { 2.0 } else { 1.0 };
                [(r * c) as f32, (r * s) as f32, 0.0]
            })
            .collect();
        cut(&star);
    }

    proptest! {
        /// A star-shaped outline is simple: the triangles cover it once, whatever its radii.
        #[test]
        fn star_shaped_outlines_are_covered_once(radii in proptest::collection::vec(0.2f64..2.0, 5..40)) {
            let n = radii.len() as f64;
            let outline: Vec<[f32; 3]> = radii.iter().enumerate().map(|(i, r)| {
                let (s, c) = vitral_math::func::sin_cos(i as f64 / n * std::f64::consts::TAU);
                [(r * c) as f32, (r * s) as f32, 0.0]
            }).collect();
            let (signed, unsigned) = areas(&outline, &cut(&outline));
            prop_assert!((signed - unsigned).abs() <= 1e-9 * unsigned, "{signed} {unsigned}");
        }

        /// Corners that come several times change nothing: the triangles have the outline's area
        /// and cover each point once.
        #[test]
        fn doubled_corners_change_nothing(
            spokes in proptest::collection::vec((0.2f64..2.0, 0usize..4), 5..30),
            first in 0usize..100,
            reverse: bool,
        ) {
            let n = spokes.len() as f64;
            let at = |i: usize, part: f64| {
                let (s, c) = vitral_math::func::sin_cos(i as f64 / n * std::f64::consts::TAU);
                [(part * spokes[i].0 * c) as f32, (part * spokes[i].0 * s) as f32, 0.0]
            };
            let once: Vec<[f32; 3]> = (0..spokes.len()).map(|i| at(i, 1.0)).collect();
            let copies = |(i, spoke): (usize, &(f64, usize))| std::iter::repeat_n(once[i], 1 + spoke.1 % 3);
            let mut outline: Vec<[f32; 3]> = spokes.iter().enumerate().flat_map(copies).collect();
            let shift = first % outline.len();
            outline.rotate_left(shift);
            if reverse {
                outline.reverse();
            }
            let triangles = cut(&outline);
            let (signed, unsigned) = areas(&outline, &triangles);
            let (expected, _) = areas(&once, &cut(&once));
            prop_assert!((signed.abs() - expected).abs() <= 1e-9 * expected, "{signed} for {expected}");
            prop_assert!((unsigned - expected).abs() <= 1e-9 * expected, "{unsigned} for {expected}");
            for i in 0..spokes.len() {
                let flat = |p: [f32; 3]| [f64::from(p[0]), f64::from(p[1])];
                let p = flat(at(i, 0.618));
                let holds = |t: &&[u32; 3]| {
                    let [a, b, c] = t.map(|k| flat(outline[k as usize]));
                    let sides = [cross(a, b, p), cross(b, c, p), cross(c, a, p)];
                    sides.iter().all(|&s| s > 0.0) || sides.iter().all(|&s| s < 0.0)
                };
                // None where the point is on a cut.
                prop_assert!(triangles.iter().filter(holds).count() <= 1);
            }
        }
    }
}
