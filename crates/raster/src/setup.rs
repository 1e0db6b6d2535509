//! Triangle setup: from three snapped corners to edge functions and a depth plane.
//!
//! The depth of a facet at a sample is one function of the facet and the sample's position, with a
//! fixed order of operations, clamped to the facet's own range: [`Setup::depth`]. Every algorithm
//! that decides which facet is nearer calls it, so that all of them decide alike.
//!
//! Source: edge functions after [Pineda 1988].

use crate::SUBPIXEL;
#[cfg(any(test, feature = "forward"))]
use crate::screen::RESIDUE;
use bytemuck::{Pod, Zeroable};

/// A corner on the screen: `x`, `y` in 1/256 pixel from the top left, `z` is depth, 1 near, 0 far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CornerPosition {
    /// To the right.
    pub x: i32,
    /// Downwards.
    pub y: i32,
    /// Depth.
    pub z: f32,
}

/// Snaps a screen coordinate in pixels to the grid of 1/256 pixel. The caller has clipped it to the
/// guard band.
pub fn snap(pixels: f32) -> i32 {
    (pixels * SUBPIXEL as f32 + 0.5).floor() as i32
}

/// A triangle ready to be walked. Its corners run so that all edge functions are positive inside.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Setup {
    /// Corners' x in 1/256 pixel.
    pub x: [i32; 3],
    /// Corners' y in 1/256 pixel, downwards.
    pub y: [i32; 3],
    /// Depth at the plane's origin.
    pub z: f32,
    /// Change of depth for one pixel to the right.
    pub dz_dx: f32,
    /// Change of depth for one pixel downwards.
    pub dz_dy: f32,
    /// The plane's origin, in 1/256 pixel.
    pub origin: [i32; 2],
    /// Farthest depth of the facet.
    pub z_min: f32,
    /// Nearest depth of the facet.
    pub z_max: f32,
    /// The facet's id.
    pub facet: u32,
}

/// A depth plane through three corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DepthPlane {
    /// Depth at the origin: 1 on the near plane, 0 on the far plane.
    pub z: f32,
    /// Change of depth with a pixel to the right.
    pub dz_dx: f32,
    /// Change of depth with a pixel down.
    pub dz_dy: f32,
    /// Position of `z` on the screen, in 1/256 pixel.
    pub origin: [i32; 2],
    /// Farthest depth of the facet, to which depths are clamped.
    pub z_min: f32,
    /// Nearest depth of the facet.
    pub z_max: f32,
}

impl DepthPlane {
    /// The plane through `a`, `b`, `c`; `area` is twice their signed area in 1/65536 square pixels,
    /// not 0.
    #[inline(always)]
    pub(crate) fn new(a: CornerPosition, b: CornerPosition, c: CornerPosition, area: i64) -> Self {
        let (dx1, dy1) = ((b.x - a.x) as f32, (b.y - a.y) as f32);
        let (dx2, dy2) = ((c.x - a.x) as f32, (c.y - a.y) as f32);
        let (dz1, dz2) = (b.z - a.z, c.z - a.z);
        // Differences are in 1/256 pixel: one factor of 256 remains.
        let scale = SUBPIXEL as f32 / area as f32;
        Self {
            z: a.z,
            dz_dx: (dz1 * dy2 - dz2 * dy1) * scale,
            dz_dy: (dz2 * dx1 - dz1 * dx2) * scale,
            origin: [a.x, a.y],
            z_min: a.z.min(b.z).min(c.z),
            z_max: a.z.max(b.z).max(c.z),
        }
    }

    /// The plane through `a`, `b`, `c` where they lay before they were snapped: `residues` are
    /// [`ScreenVertex::residue`]'s. Triangles in one plane get one plane so, up to rounding,
    /// however their corners were snapped.
    ///
    /// [`ScreenVertex::residue`]: crate::ScreenVertex::residue
    #[cfg(any(test, feature = "forward"))]
    #[inline(always)]
    pub(crate) fn unsnapped(
        corners: [CornerPosition; 3],
        residues: [[i32; 2]; 3],
        area: i64,
    ) -> Self {
        let [a, b, c] = corners;
        let rest = |k: usize, axis: usize| (residues[k][axis] - residues[0][axis]) as f32 * RESIDUE;
        let (ex1, ey1, ex2, ey2) = (rest(1, 0), rest(1, 1), rest(2, 0), rest(2, 1));
        let (dx1, dy1) = ((b.x - a.x) as f32, (b.y - a.y) as f32);
        let (dx2, dy2) = ((c.x - a.x) as f32, (c.y - a.y) as f32);

        // The area of the snapped corners is exact, and the rest is small: no digits cancel out.
        let (x1, y1, x2, y2) = (dx1 + ex1, dy1 + ey1, dx2 + ex2, dy2 + ey2);
        let (snapped, rest) = (area as f32, (dx1 * ey2 + ex1 * y2) - (dx2 * ey1 + ex2 * y1));
        if rest.abs() > snapped.abs() * 0.5 {
            // A sliver that snapping made or turned over.
            return Self::new(a, b, c, area);
        }
        let (dz1, dz2) = (b.z - a.z, c.z - a.z);
        let scale = SUBPIXEL as f32 / (snapped + rest);
        let (dz_dx, dz_dy) = ((dz1 * y2 - dz2 * y1) * scale, (dz2 * x1 - dz1 * x2) * scale);

        // Depths are those of the corners' own places: go back to where they were snapped to, so
        // that the range holds there, too.
        let unit = RESIDUE / SUBPIXEL as f32;
        let snapped = |corner: CornerPosition, [x, y]: [i32; 2]| {
            corner.z - (x as f32 * unit * dz_dx + y as f32 * unit * dz_dy)
        };
        let [za, zb, zc] =
            [snapped(a, residues[0]), snapped(b, residues[1]), snapped(c, residues[2])];
        let (z_min, z_max) = (za.min(zb).min(zc).max(0.0), za.max(zb).max(zc).min(1.0));
        Self { z: za, dz_dx, dz_dy, origin: [a.x, a.y], z_min, z_max }
    }

    /// Adds to all depths.
    #[cfg(any(test, feature = "forward"))]
    #[inline(always)]
    pub(crate) fn move_by(&mut self, offset: f32) {
        self.z += offset;
        self.z_min = (self.z_min + offset).clamp(0.0, 1.0);
        self.z_max = (self.z_max + offset).clamp(0.0, 1.0);
    }
}

/// The depths of a plane of the world on the screen, shared by all facets in it: these have equal
/// depths wherever they meet, whatever their corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SharedPlane {
    /// As in [`DepthPlane`].
    z: f32,
    /// As in [`DepthPlane`].
    dz_dx: f32,
    /// As in [`DepthPlane`].
    dz_dy: f32,
    /// As in [`DepthPlane`].
    origin: [i32; 2],
    /// Added to the depth of facets that face the viewer, taken from that of facets that face away.
    /// A front and a back facet may have an edge of the outline in common, and snapping moves its
    /// corners by up to half of 1/256 pixel: beside the edge the back one's plane may be the nearer
    /// of the two by as much as both planes change over that distance. Rounding is in it, too.
    apart: f32,
}

/// Change of depth over a pixel above which a plane is seen so much from the side that its facets
/// keep to their corners.
const STEEP: f64 = 1.0;

impl SharedPlane {
    /// The plane `a x + b y + c z + d = 0` of ndc (depth 1 near, 0 far), in a picture of this size;
    /// `None` if it is seen from the side.
    pub fn new([a, b, c, d]: [f64; 4], [width, height]: [u32; 2]) -> Option<Self> {
        // Solve for the depth in the middle of the picture and its change over a pixel.
        let [half_width, half_height] = [width, height].map(|side| f64::from(side) * 0.5);
        let (z, dz_dx, dz_dy) = (-d / c, -a / c / half_width, b / c / half_height);
        let slopes = [dz_dx.abs(), dz_dy.abs()];
        let greatest = z.abs() + slopes[0] * half_width + slopes[1] * half_height;
        let fits = greatest.is_finite() && slopes[0].max(slopes[1]) < STEEP;
        let origin = [width, height].map(|side| side as i32 * (SUBPIXEL / 2));

        // Four roundings to 24 bits for each of two facets, of numbers no larger than the sum.
        let rounding = greatest * f64::from(f32::EPSILON) * 4.0;
        let apart = ((slopes[0] + slopes[1]) / f64::from(2 * SUBPIXEL) + rounding) as f32;
        fits.then_some(Self {
            z: z as f32,
            dz_dx: dz_dx as f32,
            dz_dy: dz_dy as f32,
            origin,
            apart,
        })
    }

    /// For a facet with these corners on the screen. Between its corners it is never clamped.
    #[inline(always)]
    pub(crate) fn of_facet(&self, corners: &[CornerPosition], faces_away: bool) -> DepthPlane {
        let z = if faces_away { self.z - self.apart } else { self.z + self.apart };

        // Take the plane's depths at the snapped corners as the range: those of the corners
        // themselves may be off the plane.
        let (mut z_min, mut z_max) = (f32::INFINITY, f32::NEG_INFINITY);
        for corner in corners {
            let away = |v: i32, k: usize| (v - self.origin[k]) as f32 / SUBPIXEL as f32;
            let depth = z + away(corner.y, 1) * self.dz_dy + away(corner.x, 0) * self.dz_dx;
            (z_min, z_max) = (z_min.min(depth), z_max.max(depth));
        }
        DepthPlane {
            z,
            dz_dx: self.dz_dx,
            dz_dy: self.dz_dy,
            origin: self.origin,
            z_min: (z_min - self.apart).clamp(0.0, 1.0),
            z_max: (z_max + self.apart).clamp(0.0, 1.0),
        }
    }
}

impl Setup {
    /// Its depths.
    #[cfg(any(test, feature = "forward"))]
    #[inline(always)]
    pub(crate) fn plane(&self) -> DepthPlane {
        let Self { z, dz_dx, dz_dy, origin, z_min, z_max, .. } = *self;
        DepthPlane { z, dz_dx, dz_dy, origin, z_min, z_max }
    }

    /// Twice the signed area, in 1/65536 square pixels: negative for corners that run
    /// counter-clockwise as the viewer sees them (y points down).
    #[inline(always)]
    pub fn doubled_area(a: CornerPosition, b: CornerPosition, c: CornerPosition) -> i64 {
        i64::from(b.x - a.x) * i64::from(c.y - a.y) - i64::from(c.x - a.x) * i64::from(b.y - a.y)
    }

    /// Sets up a triangle of non-zero doubled area `area` with its own depth plane.
    #[inline(always)]
    pub fn new(corners: [CornerPosition; 3], area: i64, facet: u32) -> Self {
        let [a, b, c] = corners;
        Self::with_plane(corners, area, &DepthPlane::new(a, b, c, area), facet)
    }

    #[inline(always)]
    pub(crate) fn with_plane(
        [a, b, c]: [CornerPosition; 3],
        area: i64,
        plane: &DepthPlane,
        facet: u32,
    ) -> Self {
        let (b, c) = if area > 0 { (b, c) } else { (c, b) };
        Self {
            x: [a.x, b.x, c.x],
            y: [a.y, b.y, c.y],
            z: plane.z,
            dz_dx: plane.dz_dx,
            dz_dy: plane.dz_dy,
            origin: plane.origin,
            z_min: plane.z_min,
            z_max: plane.z_max,
            facet,
        }
    }

    /// Its corners, 1/256 pixel.
    #[inline]
    pub fn corners(&self) -> [[i32; 2]; 3] {
        [0, 1, 2].map(|i| [self.x[i], self.y[i]])
    }

    /// Depth at `(x, y)` in 1/256 pixel.
    #[inline]
    pub fn depth(&self, x: i32, y: i32) -> f32 {
        self.depth_along(self.depth_of_line(y), x)
    }

    /// The plane's depth on the line at `y` in 1/256 pixel, straight above or below its origin; not
    /// clamped.
    #[inline]
    pub fn depth_of_line(&self, y: i32) -> f32 {
        self.z + (y - self.origin[1]) as f32 / SUBPIXEL as f32 * self.dz_dy
    }

    /// Depth at `x` in 1/256 pixel, on the line of [`Self::depth_of_line`].
    #[inline]
    pub fn depth_along(&self, line: f32, x: i32) -> f32 {
        let z = line + (x - self.origin[0]) as f32 / SUBPIXEL as f32 * self.dz_dx;
        // The order of comparisons is the lanes': a NaN plane (overflow on a needle) falls to
        // z_min.
        let z = if self.z_min < z { z } else { self.z_min };
        if z < self.z_max { z } else { self.z_max }
    }

    /// Whether the sample at `(x, y)` in 1/256 pixel is covered: all edge functions positive, or
    /// zero on a top or left edge.
    #[inline]
    pub fn covers(&self, x: i32, y: i32) -> bool {
        (0..3).all(|i| {
            let j = (i + 1) % 3;
            let (dx, dy) = (self.x[j] - self.x[i], self.y[j] - self.y[i]);
            let e =
                i64::from(dx) * i64::from(y - self.y[i]) - i64::from(dy) * i64::from(x - self.x[i]);
            e > 0 || (e == 0 && is_top_left(dx, dy))
        })
    }

    /// [`Self::covers`] for samples a pixel apart, `columns` by `rows` of them, at most 8 by 8,
    /// from the one at `(x, y)` in 1/256 pixel to the right and down: bit `8 * row + column`.
    #[inline]
    pub fn covered(&self, [x, y]: [i32; 2], columns: usize, rows: usize) -> u64 {
        let edge = |i: usize| {
            let j = (i + 1) % 3;
            let (dx, dy) = (self.x[j] - self.x[i], self.y[j] - self.y[i]);
            let corner =
                i64::from(dx) * i64::from(y - self.y[i]) - i64::from(dy) * i64::from(x - self.x[i]);
            let right = -i64::from(dy) * i64::from(SUBPIXEL);
            (corner - i64::from(!is_top_left(dx, dy)), right, i64::from(dx) * i64::from(SUBPIXEL))
        };
        let ([(mut a, ax, ay), (mut b, bx, by), (mut c, cx, cy)], mut mask) =
            ([edge(0), edge(1), edge(2)], 0);
        for row in 0..rows.min(8) {
            let (mut e, mut f, mut g) = (a, b, c);
            for column in 0..columns.min(8) {
                mask |= u64::from(e | f | g >= 0) << (8 * row + column);
                (e, f, g) = (e + ax, f + bx, g + cx);
            }
            (a, b, c) = (a + ay, b + by, c + cy);
        }
        mask
    }

    /// Whether a sample from `low` to `high`, x and y in 1/256 pixel, may be covered: no edge has
    /// all of them outside.
    #[inline]
    pub fn reaches(&self, [low, high]: [[i32; 2]; 2]) -> bool {
        (0..3).all(|i| {
            let j = (i + 1) % 3;
            let (dx, dy) = (self.x[j] - self.x[i], self.y[j] - self.y[i]);
            // The corner where the edge function is largest.
            let x = if dy > 0 { low[0] } else { high[0] };
            let y = if dx > 0 { high[1] } else { low[1] };
            i64::from(dx) * i64::from(y - self.y[i]) >= i64::from(dy) * i64::from(x - self.x[i])
        })
    }
}

/// Whether an edge of a triangle whose edge functions are positive inside (y downwards) is a top or
/// a left edge.
#[inline(always)]
pub(crate) fn is_top_left(dx: i32, dy: i32) -> bool {
    // Positive inside with y down means clockwise on the screen: left edges go up, top edges go
    // right.
    dy < 0 || (dy == 0 && dx > 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner(x: i32, y: i32, z: f32) -> CornerPosition {
        CornerPosition { x: x * 256, y: y * 256, z }
    }

    #[test]
    fn covered_samples_are_those_that_it_covers() {
        for setup in crate::testing::triangles(2000, 0) {
            let (columns, rows) = (1 + setup.facet as usize % 8, 1 + setup.facet as usize / 8 % 8);
            let first = [setup.x[0] / 256 * 256 - 768 + 96, setup.y[1] / 256 * 256 - 512 + 32];
            let mask = setup.covered(first, columns, rows);
            for (row, column) in (0..8).flat_map(|row| (0..8).map(move |column| (row, column))) {
                let inside = row < rows && column < columns;
                let covers = inside
                    && setup.covers(first[0] + column as i32 * 256, first[1] + row as i32 * 256);
                assert_eq!(mask >> (8 * row + column) & 1 == 1, covers, "{setup:?}");
            }
        }
    }

    #[test]
    fn a_square_of_two_triangles_covers_each_sample_once() {
        let q = [corner(0, 0, 0.5), corner(4, 0, 0.5), corner(4, 4, 0.5), corner(0, 4, 0.5)];
        let make = |a: usize, b: usize, c: usize| {
            Setup::new([q[a], q[b], q[c]], Setup::doubled_area(q[a], q[b], q[c]), 0)
        };
        for (first, second) in [(make(0, 1, 2), make(0, 2, 3)), (make(2, 1, 0), make(1, 3, 2))] {
            let _ = second;
            assert!(first.covers(3 * 256, 128) && !first.covers(128, 3 * 256));
        }
        let (first, second) = (make(0, 1, 2), make(0, 2, 3));
        for y in -1..=5 {
            for x in -1..=5 {
                // Samples on corners and edges: the hardest places.
                let count = u32::from(first.covers(x * 256, y * 256))
                    + u32::from(second.covers(x * 256, y * 256));
                assert_eq!(
                    count,
                    u32::from((0..4).contains(&x) && (0..4).contains(&y)),
                    "({x}, {y})"
                );
            }
        }
    }

    #[test]
    fn a_triangle_reaches_where_it_covers_and_not_beside_an_edge() {
        let mut state = 1u32;
        let mut random = |range: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as i32 % range as i32
        };
        let mut beside = 0;
        for _ in 0..300 {
            let corners =
                [(); 3].map(|()| CornerPosition { x: random(4000), y: random(4000), z: 0.5 });
            let [a, b, c] = corners;
            let area = Setup::doubled_area(a, b, c);
            if area == 0 {
                continue;
            }
            let setup = Setup::new(corners, area, 0);
            let low = [random(4000), random(4000)];
            let high = low.map(|v| v + 500);
            let mut samples =
                (0..=25).flat_map(|y| (0..=25).map(move |x| [low[0] + x * 20, low[1] + y * 20]));
            let covered = samples.any(|[x, y]| setup.covers(x, y));
            assert!(setup.reaches([low, high]) || !covered, "{setup:?} {low:?}");
            beside += u32::from(!setup.reaches([low, high]));
        }
        assert!(beside > 100, "{beside}");
        // Its box holds the block, its long edge passes the block by.
        let (a, b, c) = (corner(0, 0, 0.5), corner(64, 64, 0.5), corner(0, 2, 0.5));
        let slanting = Setup::new([a, b, c], Setup::doubled_area(a, b, c), 0);
        assert!(!slanting.reaches([[40 * 256, 8 * 256], [47 * 256, 15 * 256]]));
        assert!(slanting.reaches([[8 * 256, 8 * 256], [15 * 256, 15 * 256]]));
    }

    #[test]
    fn planes_through_unsnapped_corners_are_the_plane_that_the_corners_lie_in() {
        // Corners in 1/131072 pixel, in the plane 0.2 + 0.011 x - 0.007 y of pixels.
        let mut state = 3u32;
        let mut random = |range: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as i32 % range as i32
        };
        let depth = |[x, y]: [f64; 2]| 0.2 + 0.011 * x - 0.007 * y;
        let (mut worst, mut worst_snapped, mut count) = (0.0f64, 0.0f64, 0);
        for _ in 0..2000 {
            let exact = [(); 3].map(|()| [random(5 << 17), random(5 << 17)]);
            let snapped = exact.map(|p| p.map(|v| (v + 256) >> 9));
            let residues = [0, 1, 2].map(|i| [0, 1].map(|k| exact[i][k] - (snapped[i][k] << 9)));
            let places = exact.map(|p| p.map(|v| f64::from(v) / 131_072.0));
            let corners = [0, 1, 2].map(|i| CornerPosition {
                x: snapped[i][0],
                y: snapped[i][1],
                z: depth(places[i]) as f32,
            });
            let [a, b, c] = corners;
            let area = Setup::doubled_area(a, b, c);
            if area.abs() < 256 * 256 {
                continue;
            }
            let off = |plane: &DepthPlane| {
                let setup = Setup::with_plane(corners, area, plane, 0);
                let middle = [0, 1].map(|k| (snapped[0][k] + snapped[1][k] + snapped[2][k]) / 3);
                let expected = depth(middle.map(|v| f64::from(v) / f64::from(SUBPIXEL)));
                (f64::from(setup.depth(middle[0], middle[1])) - expected).abs()
            };
            worst = worst.max(off(&DepthPlane::unsnapped(corners, residues, area)));
            worst_snapped = worst_snapped.max(off(&DepthPlane::new(a, b, c, area)));
            count += 1;
        }
        assert!(
            count > 1000 && worst < 1e-7 && worst_snapped > 1e-5,
            "{count} {worst} {worst_snapped}"
        );
        // A sliver that snapping turned over keeps to its corners.
        let (a, b, c) =
            (corner(0, 0, 0.2), corner(9, 0, 0.6), CornerPosition { x: 1000, y: 1, z: 0.4 });
        let residues = [[0; 2], [0; 2], [0, -256 - 255]];
        let area = Setup::doubled_area(a, b, c);
        assert_eq!(
            DepthPlane::unsnapped([a, b, c], residues, area),
            DepthPlane::new(a, b, c, area)
        );
    }

    #[test]
    fn p17_depth_is_linear_on_the_screen_and_clamped() {
        let (a, b, c) = (corner(0, 0, 0.2), corner(8, 0, 0.6), corner(0, 8, 0.4));
        let setup = Setup::new([a, b, c], Setup::doubled_area(a, b, c), 7);
        assert!((setup.depth(4 * 256, 0) - 0.4).abs() < 1e-7);
        assert!((setup.depth(256, 256) - 0.275).abs() < 1e-6);
        // P17: along a span, each step adds dz/dx.
        let span: Vec<f32> = (0..4).map(|x| setup.depth(x * 256, 256)).collect();
        assert!(span.windows(2).all(|w| (w[1] - w[0] - setup.dz_dx).abs() < 1e-6));
        assert_eq!(setup.depth(-100 * 256, 0), 0.2);
        assert_eq!(setup.depth(100 * 256, 0), 0.6);
    }
}
