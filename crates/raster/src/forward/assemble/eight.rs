//! Filled triangles eight at a time: which of them are seen, and their depth planes. Those that clipping must cut, and those that
//! extend over more than a tile, go one by one; all come in their order, with the results of [`Assembler::triangle`].

use super::{Assembler, FacetKind, NONE};
use crate::geometry::{Screen, flag};
use crate::kernel::traverse::SMALL;
use crate::setup::{CornerPosition, DepthPlane};
use crate::{SUBPIXEL, ScreenVertex};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, I32x8, LANES, Level, Mask8, Simd, dispatch};

/// What is known of eight triangles, and bits of those that are left.
struct Eight {
    /// Twice the areas, in 1/65536 square pixels.
    area: [i32; LANES],
    /// The pixels they may cover: x0, y0, x1, y1.
    pixels: [[i32; LANES]; 4],
    dz_dx: [f32; LANES],
    dz_dy: [f32; LANES],
    z_min: [f32; LANES],
    z_max: [f32; LANES],
    /// These are seen.
    seen: u32,
    /// These must be looked at one by one.
    others: u32,
}

impl Assembler<'_> {
    /// Triangles without planes of the user; the last corner provokes.
    pub(super) fn by_eights(&mut self, level: Level, triangles: &[[u32; 3]]) {
        dispatch!(level, simd => self.by_eights_inlined(simd, triangles));
    }

    #[inline(always)]
    fn by_eights_inlined<S: Simd>(&mut self, simd: S, triangles: &[[u32; 3]]) {
        let (eights, rest) = triangles.as_chunks::<LANES>();
        for corners in eights {
            let eight = self.sift(simd, corners);
            let mut left = eight.seen | eight.others;
            while left != 0 {
                let lane = left.trailing_zeros() as usize % LANES;
                left &= left - 1;
                if eight.others >> lane & 1 == 1 {
                    self.triangle(corners[lane], corners[lane][2]);
                } else {
                    self.add_seen(&eight, lane, corners[lane]);
                }
            }
        }
        for corners in rest {
            self.triangle(*corners, corners[2]);
        }
    }

    /// Culls and sets up eight triangles. A function of its own: all in one would be a function over which compilers take
    /// minutes, where they must do without vectors.
    #[inline(never)]
    fn sift<S: Simd>(&self, simd: S, triangles: &[[u32; 3]; LANES]) -> Eight {
        simd.vectorize(
            #[inline(always)]
            || self.sift_inlined(simd, triangles),
        )
    }

    #[inline(always)]
    fn sift_inlined<S: Simd>(&self, simd: S, triangles: &[[u32; 3]; LANES]) -> Eight {
        let vertices = self.vertices.screen;
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
        let (a, b, c) = (corner(0), corner(1), corner(2));
        let zero = I32x8::splat(simd, 0);
        let (any, all) = (a[3] | b[3] | c[3], a[3] & b[3] & c[3]);
        let outside = (all & self.outside().cast_signed()) | (any & flag::NOT_FINITE.cast_signed());
        let clipped = any & flag::CLIP.cast_signed();
        let (inside, regular) = (outside.simd_eq(zero), clipped.simd_eq(zero));

        let low = lanes::inlined(
            #[inline(always)]
            |k: usize| a[k].min(b[k]).min(c[k]),
        );
        let high = lanes::inlined(
            #[inline(always)]
            |k: usize| a[k].max(b[k]).max(c[k]),
        );
        let (low, high) = ([low(0), low(1)], [high(0), high(1)]);
        let limit = I32x8::splat(simd, SMALL);
        let small = (high[0] - low[0]).simd_lt(limit) & (high[1] - low[1]).simd_lt(limit);

        let (dx1, dy1) = (b[0] - a[0], b[1] - a[1]);
        let (dx2, dy2) = (c[0] - a[0], c[1] - a[1]);
        let area = dx1 * dy2 - dx2 * dy1;
        let (culls_positive, culls_negative) =
            (self.state.cull[usize::from(self.is_back(1))], self.state.cull[usize::from(self.is_back(-1))]);
        let mut shown = !area.simd_eq(zero);
        if culls_positive {
            shown &= area.simd_lt(zero);
        }
        if culls_negative {
            shown &= area.simd_gt(zero);
        }
        let (pixels, covers) = covered(simd, self.screen, self.state.clip, &low, &high);

        // The operations of `DepthPlane::new`, in their order.
        let (z0, z1, z2): (F32x8<S>, F32x8<S>, F32x8<S>) = (a[2].bitcast(), b[2].bitcast(), c[2].bitcast());
        let (dz1, dz2) = (z1 - z0, z2 - z0);
        let real = lanes::inlined(
            #[inline(always)]
            |v: I32x8<S>| -> F32x8<S> { v.to_float() },
        );
        let scale = <F32x8<S> as SimdBase<S>>::splat(simd, SUBPIXEL as f32) / real(area);
        let dz_dx = (dz1 * real(dy2) - dz2 * real(dy1)) * scale;
        let dz_dy = (dz2 * real(dx1) - dz1 * real(dx2)) * scale;
        let z_min = lanes::Lanes::min(lanes::Lanes::min(z0, z1), z2);
        let z_max = lanes::Lanes::max(lanes::Lanes::max(z0, z1), z2);
        let bits = lanes::inlined(
            #[inline(always)]
            |mask: Mask8<S>| mask.to_bitmask() as u32 & 0xff,
        );
        Eight {
            area: area.to_array(),
            pixels: [pixels[0].to_array(), pixels[1].to_array(), pixels[2].to_array(), pixels[3].to_array()],
            dz_dx: dz_dx.to_array(),
            dz_dy: dz_dy.to_array(),
            z_min: z_min.to_array(),
            z_max: z_max.to_array(),
            seen: bits(inside & regular & small & shown & covers),
            others: bits(inside & !(regular & small)),
        }
    }

    /// Adds a triangle that was found to be seen.
    #[inline(always)]
    fn add_seen(&mut self, eight: &Eight, lane: usize, corners: [u32; 3]) {
        let position = lanes::inlined(
            #[inline(always)]
            |k: usize| {
                let ScreenVertex { x, y, z, .. } = self.vertices.screen[corners[k] as usize];
                CornerPosition { x, y, z }
            },
        );
        let positions = [position(0), position(1), position(2)];
        let area = i64::from(eight.area[lane]);
        let plane = DepthPlane {
            z: positions[0].z,
            dz_dx: eight.dz_dx[lane],
            dz_dy: eight.dz_dy[lane],
            origin: [positions[0].x, positions[0].y],
            z_min: eight.z_min[lane],
            z_max: eight.z_max[lane],
        };
        let plane = self.offset(plane, 2);
        let p = &eight.pixels;
        let pixels = [p[0][lane] as u32, p[1][lane] as u32, p[2][lane] as u32, p[3][lane] as u32];
        let slots = [self.slot(corners[0]), self.slot(corners[1]), self.slot(corners[2])];
        let back = self.is_back(area);
        self.push(positions, area, &plane, pixels, slots, slots[2], FacetKind::Polygon, back, NONE);
    }
}

/// The pixels that eight boxes may cover within `clip`, x0, y0, x1, y1 inclusive, and which of them hold any; as
/// [`crate::geometry::covered_pixels`].
#[inline(always)]
fn covered<S: Simd>(
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
