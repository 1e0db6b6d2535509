//! Filled triangles eight at a time. Those that clipping must cut, and those that extend over more
//! than a tile, go one by one; all come in their order, with the results of
//! [`Assembler::triangle`].

use super::{Assembler, CUT, FacetAttributes};
use crate::ScreenVertex;
use crate::kernel::sift::{CullResult8, Sieve, sift};
use crate::setup::CornerPosition;
use vitral_math::lanes::{self, LANES, Level, Simd, dispatch};

impl Assembler<'_> {
    /// Triangles; the last corner provokes.
    pub(super) fn by_eights(&mut self, level: Level, triangles: &[[u32; 3]]) {
        dispatch!(level, simd => self.by_eights_inlined(simd, triangles));
    }

    #[inline(always)]
    fn by_eights_inlined<S: Simd>(&mut self, simd: S, triangles: &[[u32; 3]]) {
        // Cull eight triangles at a time.
        let culls = [-1, 1]
            .map(|area| if self.state.cull[usize::from(self.is_back(area))] { 0xff } else { 0 });
        let sieve = Sieve { outside: self.outside(), cut: CUT, culls, clip: self.state.clip };
        let (eights, rest) = triangles.as_chunks::<LANES>();
        for corners in eights {
            let eight = sift::<S, true>(simd, self.screen, &sieve, self.vertices.screen, corners);
            // Add the visible ones; those that are cut or large take the general path.
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

        // Add the remaining triangles one by one.
        for corners in rest {
            self.triangle(*corners, corners[2]);
        }
    }

    /// Adds a triangle that was found to be seen.
    #[inline(always)]
    fn add_seen(&mut self, eight: &CullResult8, lane: usize, corners: [u32; 3]) {
        let position = lanes::inlined(
            #[inline(always)]
            |k: usize| {
                let ScreenVertex { x, y, z, .. } = self.vertices.screen[corners[k] as usize];
                CornerPosition { x, y, z }
            },
        );
        let positions = [position(0), position(1), position(2)];
        let area = i64::from(eight.area[lane]);
        let plane = self.offset(eight.plane(lane, positions[0]), 2);
        let pixels = eight.pixels(lane);
        let slots = [self.slot(corners[0]), self.slot(corners[1]), self.slot(corners[2])];
        let back = self.is_back(area);
        self.push(positions, area, &plane, pixels, slots, FacetAttributes::polygon(slots[2], back));
    }
}
