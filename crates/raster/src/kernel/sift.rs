//! Culling before setup, eight triangles at a time: which of them are seen, and their depth planes.
//!
//! Dropped are those outside the view volume, those that face away, and those that cover no sample.
//! Of small boxes the samples are tested themselves: many triangles of a fine mesh lie between
//! them, and one that is dropped here is neither set up nor sorted into a tile nor walked.
//! Triangles that clipping must cut and those that extend over more than a tile are left to the
//! caller.
//!
//! In:   corners on the screen. Out: [`CullResult8`], the same bits as [`DepthPlane::new`], or as
//!       [`DepthPlane::unsnapped`] if vertices keep what snapping took from them, and
//!       [`Setup::covers`](crate::Setup::covers).
//! Cost: constant for eight triangles; a few operations for each sample of a small box.

use super::traverse::{SMALL, biases};
use crate::SUBPIXEL;
use crate::screen::{RESIDUE, Screen, ScreenVertex, flag};
use crate::setup::{CornerPosition, DepthPlane};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, I32x8, LANES, Mask8, Simd};

/// At most so many samples of a box are tested themselves.
const TESTED: usize = 16;

/// Which triangles are dropped.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sieve {
    /// Those outside one of these planes with all corners, bits of [`flag`].
    pub outside: u32,
    /// Those with a corner of one of these bits must be cut, and are left to the caller.
    pub cut: u32,
    /// Of the eight those whose doubled area is negative, positive: a bit for each that is dropped
    /// then.
    pub culls: [u32; 2],
    /// Those without pixels in `[x0, y0, x1, y1]`, the upper ends excluded.
    pub clip: [i32; 4],
}

/// What is known of eight triangles. Sets are bits.
pub(crate) struct CullResult8 {
    /// Twice the areas, in 1/65536 square pixels.
    pub area: [i32; LANES],
    /// The pixels they may cover: x0, y0, x1, y1.
    pub pixels: [[i32; LANES]; 4],
    /// Depth planes, as in [`DepthPlane`]: depths at the first corners.
    z: [f32; LANES],
    /// Changes of depth with a pixel to the right.
    dz_dx: [f32; LANES],
    /// Changes of depth with a pixel down.
    dz_dy: [f32; LANES],
    /// Farthest depths.
    z_min: [f32; LANES],
    /// Nearest depths.
    z_max: [f32; LANES],
    /// These have a corner that is not finite, and are not in the other sets.
    pub not_finite: u32,
    /// These are outside the view volume, and not in the other sets.
    pub outside: u32,
    /// These must be looked at one by one, and are not in the following sets.
    pub others: u32,
    /// These have no area.
    pub degenerate: u32,
    /// Of those with an area, these are culled.
    pub culled: u32,
    /// These are seen. The rest covers no sample.
    pub seen: u32,
}

impl CullResult8 {
    /// The depth plane of a triangle, whose first corner this is.
    #[inline(always)]
    pub(crate) fn plane(&self, lane: usize, first: CornerPosition) -> DepthPlane {
        DepthPlane {
            z: self.z[lane],
            dz_dx: self.dz_dx[lane],
            dz_dy: self.dz_dy[lane],
            origin: [first.x, first.y],
            z_min: self.z_min[lane],
            z_max: self.z_max[lane],
        }
    }

    /// The pixels that a triangle may cover: x0, y0, x1, y1.
    #[inline(always)]
    pub(crate) fn pixels(&self, lane: usize) -> [u32; 4] {
        let p = &self.pixels;
        [p[0][lane] as u32, p[1][lane] as u32, p[2][lane] as u32, p[3][lane] as u32]
    }
}

/// Looks at eight triangles of `vertices`. A function of its own: all in one would be a function
/// over which compilers take minutes, where they must do without vectors. `UNSNAPPED`: depth planes
/// go through the corners' own places.
#[inline(never)]
pub(crate) fn sift<S: Simd, const UNSNAPPED: bool>(
    simd: S,
    screen: &Screen,
    sieve: &Sieve,
    vertices: &[ScreenVertex],
    triangles: &[[u32; 3]; LANES],
) -> CullResult8 {
    simd.vectorize(
        #[inline(always)]
        || sift_inlined::<S, UNSNAPPED>(simd, screen, sieve, vertices, triangles),
    )
}

/// A corner of eight triangles: x and y in 1/256 pixel, the bits of the depth, and the flags.
type Corner8<S> = [I32x8<S>; 4];

/// [`sift`], for a caller that has entered the level's instruction set.
#[inline(always)]
fn sift_inlined<S: Simd, const UNSNAPPED: bool>(
    simd: S,
    screen: &Screen,
    sieve: &Sieve,
    vertices: &[ScreenVertex],
    triangles: &[[u32; 3]; LANES],
) -> CullResult8 {
    // Gather the corners of eight triangles, one register for each component.
    let corner = lanes::inlined(
        #[inline(always)]
        |k: usize| {
            lanes::columns_of_rows(
                simd,
                #[inline(always)]
                |lane| bytemuck::cast(vertices[triangles[lane][k] as usize]),
            )
        },
    );
    let corners = [corner(0), corner(1), corner(2)];

    // Find the triangles inside the view, and among them those that are neither cut nor large.
    let [finite, inside, regular] = classify(simd, sieve, &corners);
    let (low, high) = bounds(&corners);
    let limit = I32x8::splat(simd, SMALL);
    let regular = regular & (high[0] - low[0]).simd_lt(limit) & (high[1] - low[1]).simd_lt(limit);
    let ours = inside & regular;

    // Drop those that have no area or face the wrong way, and those whose box holds no sample.
    let edges = Edges8::new(&corners);
    let degenerate = ours & edges.area.simd_eq(I32x8::splat(simd, 0));
    let shown = shown(simd, sieve.culls, edges.area);
    let (pixels, holds) = pixels(simd, screen, sieve.clip, &low, &high);
    let mut seen = ours & shown & holds;

    // Test the samples of small boxes themselves.
    if let Some(side) = tested_side(screen.pattern().len()) {
        let most = I32x8::splat(simd, (side - 1) as i32);
        let narrow = (pixels[2] - pixels[0]).simd_le(most) & (pixels[3] - pixels[1]).simd_le(most);
        if (seen & narrow).any_true() {
            let first = [pixels[0] << 8, pixels[1] << 8];
            seen &= !narrow | cover(simd, screen, side, first, edges.area, corners);
        }
    }

    // Compute depth planes and return everything, one bit or lane for each triangle.
    let [z, dz_dx, dz_dy, z_min, z_max] = depth_planes::<S, UNSNAPPED>(simd, &corners, &edges);
    let bits = lanes::inlined(
        #[inline(always)]
        |mask: Mask8<S>| mask.to_bitmask() as u32 & 0xff,
    );
    CullResult8 {
        area: edges.area.to_array(),
        pixels: [
            pixels[0].to_array(),
            pixels[1].to_array(),
            pixels[2].to_array(),
            pixels[3].to_array(),
        ],
        z: z.to_array(),
        dz_dx: dz_dx.to_array(),
        dz_dy: dz_dy.to_array(),
        z_min: z_min.to_array(),
        z_max: z_max.to_array(),
        not_finite: bits(!finite),
        outside: bits(finite & !inside),
        others: bits(inside & !regular),
        degenerate: bits(degenerate),
        culled: bits(ours & !(shown | degenerate)),
        seen: bits(seen),
    }
}

/// Which triangles have finite corners, which of these are not outside one of the sieve's planes,
/// and which have no corner where they must be cut.
#[inline(always)]
fn classify<S: Simd>(simd: S, sieve: &Sieve, [a, b, c]: &[Corner8<S>; 3]) -> [Mask8<S>; 3] {
    let zero = I32x8::splat(simd, 0);
    let (any, all) = (a[3] | b[3] | c[3], a[3] & b[3] & c[3]);
    let finite = (any & flag::NOT_FINITE.cast_signed()).simd_eq(zero);
    let inside = (all & sieve.outside.cast_signed()).simd_eq(zero) & finite;
    let regular = (any & sieve.cut.cast_signed()).simd_eq(zero);
    [finite, inside, regular]
}

/// The lowest and the highest x and y.
#[inline(always)]
fn bounds<S: Simd>([a, b, c]: &[Corner8<S>; 3]) -> ([I32x8<S>; 2], [I32x8<S>; 2]) {
    let low = lanes::inlined(
        #[inline(always)]
        |k: usize| a[k].min(b[k]).min(c[k]),
    );
    let high = lanes::inlined(
        #[inline(always)]
        |k: usize| a[k].max(b[k]).max(c[k]),
    );
    ([low(0), low(1)], [high(0), high(1)])
}

/// The edges of eight triangles that start at the first corner, and what they span.
struct Edges8<S: Simd> {
    /// From the first corner to the second, in 1/256 pixel.
    dx1: I32x8<S>,
    dy1: I32x8<S>,
    /// From the first corner to the third, in 1/256 pixel.
    dx2: I32x8<S>,
    dy2: I32x8<S>,
    /// Twice the areas.
    area: I32x8<S>,
}

impl<S: Simd> Edges8<S> {
    /// The edges between these corners.
    #[inline(always)]
    fn new([a, b, c]: &[Corner8<S>; 3]) -> Self {
        let (dx1, dy1) = (b[0] - a[0], b[1] - a[1]);
        let (dx2, dy2) = (c[0] - a[0], c[1] - a[1]);
        Self { dx1, dy1, dx2, dy2, area: dx1 * dy2 - dx2 * dy1 }
    }
}

/// Which triangles have an area, and not of the sign that is culled.
#[inline(always)]
fn shown<S: Simd>(simd: S, culls: [u32; 2], area: I32x8<S>) -> Mask8<S> {
    let zero = I32x8::splat(simd, 0);
    let mut shown = !area.simd_eq(zero);
    let kept = lanes::inlined(
        #[inline(always)]
        |dropped: u32| Mask8::from_bitmask(simd, u64::from(!dropped & 0xff)),
    );
    if culls[1] != 0 {
        shown &= area.simd_lt(zero) | kept(culls[1]);
    }
    if culls[0] != 0 {
        shown &= area.simd_gt(zero) | kept(culls[0]);
    }
    shown
}

/// The depth planes' depths at the first corners, slopes along x and y, least and greatest depths:
/// the operations of [`DepthPlane::new`] or [`DepthPlane::unsnapped`], in their order.
#[inline(always)]
fn depth_planes<S: Simd, const UNSNAPPED: bool>(
    simd: S,
    [a, b, c]: &[Corner8<S>; 3],
    edges: &Edges8<S>,
) -> [F32x8<S>; 5] {
    // Span depths and edges from the first corner.
    let (z0, z1, z2): (F32x8<S>, F32x8<S>, F32x8<S>) =
        (a[2].bitcast(), b[2].bitcast(), c[2].bitcast());
    let (dz1, dz2) = (z1 - z0, z2 - z0);
    let real = lanes::inlined(
        #[inline(always)]
        |v: I32x8<S>| -> F32x8<S> { v.to_float() },
    );
    let mut spanned =
        [real(edges.dx1), real(edges.dy1), real(edges.dx2), real(edges.dy2), real(edges.area)];

    // Replace snapped edges by those before snapping.
    let mut moved = None;
    if UNSNAPPED {
        let corners;
        (spanned, corners) = unsnapped(simd, [a[3], b[3], c[3]], spanned);
        moved = Some(corners);
    }

    // Solve for the slopes of depth along x and y.
    let [x1, y1, x2, y2, area] = spanned;
    let scale = <F32x8<S> as SimdBase<S>>::splat(simd, SUBPIXEL as f32) / area;
    let dz_dx = (dz1 * y2 - dz2 * y1) * scale;
    let dz_dy = (dz2 * x1 - dz1 * x2) * scale;

    // Move the depths of the unsnapped corners back to the snapped ones.
    let [z0, z1, z2] = match moved {
        None => [z0, z1, z2],
        Some([a, b, c]) => {
            let back = lanes::inlined(
                #[inline(always)]
                |z: F32x8<S>, [x, y]: [F32x8<S>; 2]| z - (x * dz_dx + y * dz_dy),
            );
            [back(z0, a), back(z1, b), back(z2, c)]
        }
    };

    // Bound the depths by those of the corners.
    let mut z_min = lanes::Lanes::min(lanes::Lanes::min(z0, z1), z2);
    let mut z_max = lanes::Lanes::max(lanes::Lanes::max(z0, z1), z2);
    if UNSNAPPED {
        z_min = lanes::Lanes::max(z_min, F32x8::splat(simd, 0.0));
        z_max = lanes::Lanes::min(z_max, F32x8::splat(simd, 1.0));
    }
    [z0, dz_dx, dz_dy, z_min, z_max]
}

/// The edges from the first corner, x and y of one and the other, and twice the area that they
/// span, before the corners were snapped, of those after; and by how many pixels each corner was
/// moved. Slivers keep to their snapped corners.
#[inline(always)]
fn unsnapped<S: Simd>(
    simd: S,
    [a, b, c]: [I32x8<S>; 3],
    [dx1, dy1, dx2, dy2, area]: [F32x8<S>; 5],
) -> ([F32x8<S>; 5], [[F32x8<S>; 2]; 3]) {
    // Unpack the remainders of snapping, which are stored in the flags.
    let residue = lanes::inlined(
        #[inline(always)]
        |flags: I32x8<S>| {
            [flags << flag::RESIDUE_BITS >> flag::RESIDUE_Y, flags >> flag::RESIDUE_Y]
        },
    );
    let real = lanes::inlined(
        #[inline(always)]
        |v: I32x8<S>| -> F32x8<S> { v.to_float() },
    );
    let ([ax, ay], [bx, by], [cx, cy]) = (residue(a), residue(b), residue(c));

    // Correct the edges and the area by the differences of remainders.
    let (ex1, ey1) = (real(bx - ax) * RESIDUE, real(by - ay) * RESIDUE);
    let (ex2, ey2) = (real(cx - ax) * RESIDUE, real(cy - ay) * RESIDUE);
    let (x1, y1, x2, y2) = (dx1 + ex1, dy1 + ey1, dx2 + ex2, dy2 + ey2);
    let rest = (dx1 * ey2 + ex1 * y2) - (dx2 * ey1 + ex2 * y1);

    // Keep the snapped values where the correction exceeds half the area.
    let kept = rest.abs().simd_le(area.abs() * 0.5);
    let select = lanes::inlined(
        #[inline(always)]
        |[own, snapped]: [F32x8<S>; 2]| kept.select(own, snapped),
    );
    let spanned = [[x1, dx1], [y1, dy1], [x2, dx2], [y2, dy2], [area + rest, area]];
    let spanned = [
        select(spanned[0]),
        select(spanned[1]),
        select(spanned[2]),
        select(spanned[3]),
        select(spanned[4]),
    ];
    let (zero, unit) = (F32x8::splat(simd, 0.0), RESIDUE / SUBPIXEL as f32);
    let moved = lanes::inlined(
        #[inline(always)]
        |[x, y]: [I32x8<S>; 2]| [select([real(x) * unit, zero]), select([real(y) * unit, zero])],
    );
    (spanned, [moved([ax, ay]), moved([bx, by]), moved([cx, cy])])
}

/// The side, in pixels, of boxes whose samples are tested themselves.
#[inline(always)]
fn tested_side(samples: usize) -> Option<usize> {
    (1..=4).rev().find(|side| side * side * samples <= TESTED)
}

/// The pixels that eight boxes may cover within `clip`, x0, y0, x1, y1 inclusive, and which of them
/// hold any; as [`crate::screen::covered_pixels`].
#[inline(always)]
fn pixels<S: Simd>(
    simd: S,
    screen: &Screen,
    clip: [i32; 4],
    low: &[I32x8<S>; 2],
    high: &[I32x8<S>; 2],
) -> ([I32x8<S>; 4], Mask8<S>) {
    let mut pixels = [low[0], low[1], high[0], high[1]];
    let zero = I32x8::splat(simd, 0);
    let mut holds = zero.simd_eq(zero);
    for axis in 0..2 {
        let (line, samples, size) = screen.along(axis);
        let (low, high) = (low[axis], high[axis]);
        let [offset, shift] = line;
        holds &= ((high - offset) >> shift as u32).simd_gt((low - (1 + offset)) >> shift as u32);
        let first = (low - (samples[1] - SUBPIXEL + 1)) >> 8;
        let last = (high - samples[0]) >> 8;
        let first = first.max(I32x8::splat(simd, clip[axis].max(0)));
        let last = last.min(I32x8::splat(simd, (clip[axis + 2] - 1).min(size as i32 - 1)));
        holds &= first.simd_le(last);
        (pixels[axis], pixels[axis + 2]) = (first, last);
    }
    (pixels, holds)
}

/// Which of eight triangles cover a sample of the `side` by `side` pixels at `first` (1/256 pixel),
/// which they touch.
#[inline(always)]
fn cover<S: Simd>(
    simd: S,
    screen: &Screen,
    side: usize,
    first: [I32x8<S>; 2],
    area: I32x8<S>,
    [a, b, c]: [Corner8<S>; 3],
) -> Mask8<S> {
    // Turn all triangles the same way round.
    let zero = I32x8::splat(simd, 0);
    let clockwise = area.simd_gt(zero);
    let select = lanes::inlined(
        #[inline(always)]
        |k: usize| [clockwise.select(b[k], c[k]), clockwise.select(c[k], b[k])],
    );
    let ([bx, cx], [by, cy]) = (select(0), select(1));

    // Set up edge functions, with corners as seen from the first pixel, so that products stay below
    // 2^29.
    let x = [a[0] - first[0], bx - first[0], cx - first[0]];
    let y = [a[1] - first[1], by - first[1], cy - first[1]];
    let (mut right, mut down, mut at_pixel) = ([zero; 3], [zero; 3], [zero; 3]);
    for i in 0..3 {
        let j = (i + 1) % 3;
        let (dx, dy) = (x[j] - x[i], y[j] - y[i]);
        at_pixel[i] = dy * x[i] - dx * y[i] + biases(simd, dx, dy);
        (right[i], down[i]) = (dy, dx);
    }

    // Step through the pixels for each sample; a triangle that is outside of some edge everywhere
    // covers nothing.
    let [xs, ys] = screen.pattern().axes();
    let mut outside = I32x8::splat(simd, -1);
    for s in 0..screen.pattern().len() {
        let mut row = at_pixel;
        for i in 0..3 {
            row[i] += down[i] * ys[s] - right[i] * xs[s];
        }
        for _ in 0..side {
            let mut e = row;
            for _ in 0..side {
                outside &= e[0] | e[1] | e[2];
                for i in 0..3 {
                    e[i] -= right[i] << 8;
                }
            }
            for i in 0..3 {
                row[i] += down[i] << 8;
            }
        }
    }
    outside.simd_ge(zero)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BackFaces, Batch, Draw, SamplePattern, Setup, Viewport};
    use vitral_math::Mat4;
    use vitral_math::lanes::{available_levels, dispatch};

    const VIEWPORT: Viewport = Viewport { width: 100, height: 70 };

    /// Corners of triangles of all sizes, on, beside and around the picture, some with flags.
    fn vertices(triangles: usize) -> Vec<ScreenVertex> {
        let mut state = 7u32;
        let mut random = |range: i32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as i32 % range
        };
        let mut vertices = Vec::new();
        for triangle in 0..triangles {
            let size = [90, 300, 700, 1500, 9000, 30_000][triangle % 6];
            let middle =
                [random(110 * SUBPIXEL) - 5 * SUBPIXEL, random(80 * SUBPIXEL) - 5 * SUBPIXEL];
            for _ in 0..3 {
                let [x, y] = middle.map(|m| m + random(size) - size / 2);
                // Corners on samples and on lines between pixels are the hardest.
                let coarse = |v: i32| if triangle % 5 == 0 { v & !31 } else { v };
                let flags = [0, flag::LEFT, flag::NOT_FINITE, flag::LEFT | flag::TOP]
                    [random(40).max(36) as usize - 36];
                vertices.push(ScreenVertex {
                    x: coarse(x),
                    y: coarse(y),
                    z: random(1000) as f32 / 1000.0,
                    flags,
                });
            }
        }
        vertices
    }

    fn samples_of(setup: &Setup, pattern: &SamplePattern) -> bool {
        let mut pixels = (0..VIEWPORT.height as i32)
            .flat_map(|y| (0..VIEWPORT.width as i32).map(move |x| [x, y]));
        pixels.any(|[x, y]| {
            (0..pattern.len()).map(|s| pattern.position(s)).any(|[sx, sy]| {
                let place = [x * SUBPIXEL + sx, y * SUBPIXEL + sy];
                let near =
                    |v: [i32; 3], at: i32| v.iter().any(|&v| v <= at) && v.iter().any(|&v| v >= at);
                near(setup.x, place[0])
                    && near(setup.y, place[1])
                    && setup.covers(place[0], place[1])
            })
        })
    }

    #[test]
    fn planes_through_the_corners_own_places_are_the_same_eight_at_a_time() {
        const COUNT: usize = 800;
        let mut vertices = vertices(COUNT);
        for (i, vertex) in vertices.iter_mut().enumerate() {
            vertex.flags |= (i as u32).wrapping_mul(0x9e37_79b9) & !0 << flag::RESIDUE_X;
        }
        let screen = Screen::new(VIEWPORT, &SamplePattern::new(1));
        let clip = [0, 0, VIEWPORT.width as i32, VIEWPORT.height as i32];
        let sieve = Sieve { outside: flag::FRUSTUM, cut: flag::CLIP, culls: [0; 2], clip };
        let (mut compared, mut moved) = (0, 0);
        for first in (0..COUNT as u32).step_by(LANES) {
            let corners =
                std::array::from_fn(|lane| [0, 1, 2].map(|k| 3 * (first + lane as u32) + k));
            for (name, level) in available_levels() {
                let eight = dispatch!(level, simd => sift::<_, true>(simd, &screen, &sieve, &vertices, &corners));
                for lane in (0..LANES).filter(|lane| eight.seen >> lane & 1 == 1) {
                    let own = corners[lane].map(|i: u32| vertices[i as usize]);
                    let (places, area) =
                        (own.map(ScreenVertex::corner), i64::from(eight.area[lane]));
                    let one = DepthPlane::unsnapped(places, own.map(ScreenVertex::residue), area);
                    assert_eq!(eight.plane(lane, places[0]), one, "{name}: {own:?}");
                    compared += 1;
                    moved +=
                        usize::from(one != DepthPlane::new(places[0], places[1], places[2], area));
                }
            }
        }
        assert!(compared > 300 && moved > compared / 2, "{compared} {moved}");
    }

    #[test]
    fn eight_at_a_time_drops_what_covers_no_sample_and_keeps_all_else_as_one_by_one() {
        const COUNT: usize = 301;
        let vertices = vertices(COUNT);
        let triangles: Vec<[u32; 3]> =
            (0..COUNT as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        // Some are solid, in no regular order.
        let solid: Vec<u32> =
            (1..=COUNT.div_ceil(32) as u32).map(|word| word.wrapping_mul(0x9e37_79b9)).collect();
        for (samples, (back_faces, mirrored)) in [
            (1, (BackFaces::Kept, false)),
            (4, (BackFaces::Dropped, false)),
            (2, (BackFaces::Dropped, true)),
            (16, (BackFaces::Kept, true)),
            (1, (BackFaces::DroppedOf(&solid), true)),
            (4, (BackFaces::DroppedOf(&solid), false)),
        ] {
            let pattern = SamplePattern::new(samples);
            let screen = Screen::new(VIEWPORT, &pattern);
            // One by one, without a look at the samples.
            let mut reference = Batch::default();
            for (facet, corners) in triangles.iter().enumerate() {
                let [a, b, c] = corners.map(|i| vertices[i as usize]);
                if (a.flags | b.flags | c.flags) & flag::NOT_FINITE != 0 {
                    reference.counters.not_finite += 1;
                } else if a.flags & b.flags & c.flags != 0 {
                    reference.counters.outside += 1;
                } else {
                    let corners = [a, b, c].map(|v| CornerPosition { x: v.x, y: v.y, z: v.z });
                    let cull_back = back_faces.drops(facet as u32);
                    reference.add_corners(
                        corners,
                        cull_back,
                        mirrored,
                        None,
                        facet as u32,
                        &screen,
                    );
                }
            }
            let draw = Draw {
                positions: &[],
                triangles: &triangles,
                ranges: Vec::new(),
                clip_from_model: Mat4::IDENTITY,
                first_facet: 0,
                back_faces,
                planes: &[],
                mirrored,
            };
            for (name, level) in available_levels() {
                let mut batch = Batch::default();
                batch.add(level, &draw, &vertices, 0..5, &screen);
                batch.add(level, &draw, &vertices, 5..COUNT as u32, &screen);
                let mut kept = batch.setups().iter().peekable();
                let mut dropped = 0;
                for setup in reference.setups() {
                    if kept.next_if_eq(&setup).is_none() {
                        assert!(
                            !samples_of(setup, &pattern),
                            "{name}, {samples} samples: {setup:?}"
                        );
                        dropped += 1;
                    }
                }
                assert_eq!(
                    kept.next(),
                    None,
                    "{name}: only those of the reference, in their order"
                );
                assert!(dropped > 20, "{name}, {samples} samples: {dropped}");
                let mut expected = reference.counters;
                expected.triangles = COUNT as u64;
                expected.no_sample += dropped;
                assert_eq!(batch.counters, expected, "{name}, {samples} samples");
            }
        }
    }
}
