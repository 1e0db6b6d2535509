//! Images: rectangles of pixels with a zoom become fragments, eight pixels of a row at a time.

use super::TileRun;
use crate::forward::environment::fog::{color_sum, fog};
use crate::forward::environment::{UNITS, environment};
use crate::forward::fragment::{FragmentOps, PlaneRow, RowFragments, SAMPLES, stored_depth};
use crate::forward::fragment_ops::packed::unpack;
use crate::forward::pass::{ImageColors, ImageFragments};
use crate::forward::sample::sample;
use crate::forward::state::{Clamping, FragmentState};
use crate::forward::wide::{Rgba, splat, splat_rgba};
use crate::{TILE, TILE_PIXELS};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, LANES, Simd, U32x8, columns_of_rows};

impl TileRun<'_> {
    /// The fragments of an image.
    pub(super) fn image<S: Simd>(
        &mut self,
        simd: S,
        image: &ImageFragments,
        state: &FragmentState,
        ops: &FragmentOps,
    ) {
        simd.vectorize(
            #[inline(always)]
            || self.image_inlined(simd, image, state, ops),
        );
    }

    #[inline(always)]
    fn image_inlined<S: Simd>(
        &mut self,
        simd: S,
        image: &ImageFragments,
        state: &FragmentState,
        ops: &FragmentOps,
    ) {
        // Limit the image to this run's rows.
        let [x0, y0, x1, y1] = self.part(image.bounds(state.clip));
        if x0 >= x1 || y0 >= y1 {
            return;
        }
        // Source columns of the tile's columns, the same in all rows.
        let (mut shown, mut sources) = (0u64, [0; TILE]);
        for x in x0..x1 {
            if let Some(i) = image.source(0, self.x as i32 + x) {
                shown |= 1 << x;
                sources[x as usize] = i;
            }
        }

        // Walk the rows, eight pixels at a time.
        for y in y0..y1 {
            let Some(j) = image.source(1, self.y as i32 + y) else { continue };
            let row = j * image.size[0] as usize;
            for x in (x0 as usize & !(LANES - 1)..x1 as usize).step_by(LANES) {
                let mut bits = (shown >> x) as u32 & 0xff;
                if bits == 0 {
                    continue;
                }
                // Drop the pixels that a bitmap leaves out.
                let mut at = [row; LANES];
                for lane in 0..LANES {
                    at[lane] += sources[x + lane];
                }
                if let Some(set) = &image.bits {
                    for lane in 0..LANES {
                        bits &= !(u32::from(!set[at[lane]]) << lane);
                    }
                }
                if bits != 0 {
                    self.image_row(
                        simd,
                        image,
                        state,
                        ops,
                        PlaneRow { at: y as usize * TILE + x },
                        bits,
                        &at,
                    );
                }
            }
        }
    }

    #[inline(always)]
    fn image_row<S: Simd>(
        &mut self,
        simd: S,
        image: &ImageFragments,
        state: &FragmentState,
        ops: &FragmentOps,
        row: PlaneRow,
        bits: u32,
        at: &[usize; LANES],
    ) {
        // Write stencil values; an image without depths ends there.
        if let Some(stencils) = &image.stencils {
            if let Some(tile) = &mut self.planes.stencil {
                let (mask, samples) = (image.stencil_mask, self.planes.samples);
                let values = tile.stored(samples);
                for s in 0..samples {
                    for lane in (0..LANES).filter(|lane| bits >> lane & 1 == 1) {
                        let value = &mut values[s * TILE_PIXELS + row.at + lane];
                        *value = *value & !mask | stencils[at[lane]] & mask;
                    }
                }
            }
            if image.depths.is_none() {
                return;
            }
        }

        // Take the image's depths, or that of the raster position.
        let mut depth = [image.z; LANES];
        if let Some(depths) = &image.depths {
            for lane in 0..LANES {
                depth[lane] = depths[at[lane]];
            }
        }
        let scale = self.planes.depth.as_ref().map_or(1.0, |d| d.1);
        let depth = stored_depth(simd, F32x8::from_slice(simd, &depth), scale);

        // Run the fragment operations.
        let color = image_color(simd, image, state, bits, at);
        let bits = [bits; SAMPLES];
        let fragments = RowFragments { row, back: false, bits, depths: &[depth; SAMPLES], color };
        self.planes.fragments(simd, state, ops, fragments, false);
    }
}

impl ImageFragments {
    /// The pixels it may touch, within `clip`: x0, y0, x1, y1, the last two exclusive.
    pub fn bounds(&self, clip: [i32; 4]) -> [i32; 4] {
        let span = |k: usize| {
            let end = self.origin[k] + self.zoom[k] * self.size[k] as f32;
            let (low, high) = (self.origin[k].min(end), self.origin[k].max(end));
            let whole = |v: f32| v.clamp(-1e6, 1e6) as i32;
            (whole(low.floor()), whole(high.ceil()))
        };
        let ((x0, x1), (y0, y1)) = (span(0), span(1));
        [x0.max(clip[0]), y0.max(clip[1]), x1.min(clip[2]), y1.min(clip[3])]
    }

    /// Which source column (row) the pixel in window column (row) `at` shows.
    fn source(&self, axis: usize, at: i32) -> Option<usize> {
        let place = (at as f32 + 0.5 - self.origin[axis]) / self.zoom[axis];
        // The left and the lower boundary belong to a pixel's rectangle, whichever way the image
        // runs.
        let index = if self.zoom[axis] < 0.0 { place.ceil() - 1.0 } else { place.floor() };
        (index >= 0.0 && index < self.size[axis] as f32).then_some(index as usize)
    }
}

/// An image's colours after textures and fog.
#[inline(always)]
fn image_color<S: Simd>(
    simd: S,
    image: &ImageFragments,
    state: &FragmentState,
    bits: u32,
    at: &[usize; LANES],
) -> Rgba<S> {
    // Unpack the colours of the image.
    let mut primary = splat_rgba(simd, image.color);
    match &image.colors {
        Some(ImageColors::Floats(colors)) => {
            let [r, g, b, a] = columns_of_rows(
                simd,
                #[inline(always)]
                |lane| bytemuck::cast(colors[at[lane]]),
            );
            primary = [r.bitcast(), g.bitcast(), b.bitcast(), a.bitcast()];
        }
        Some(ImageColors::Words(words)) => {
            let mut eight = [0; LANES];
            for lane in 0..LANES {
                eight[lane] = words[at[lane]];
            }
            primary = unpack(U32x8::from_slice(simd, &eight));
        }
        None => {}
    }

    // Apply the textures, each sampled at one place.
    let mut color = primary;
    if !state.units.is_empty() {
        let mut textures = [splat_rgba(simd, [0.0; 4]); UNITS];
        for unit in &state.units {
            let coords = splat_rgba(simd, image.tex[unit.index % UNITS]);
            let lod = splat(simd, unit.lod_bias - 63.0);
            textures[unit.index % UNITS] = sample(simd, &unit.texture, None, coords, lod, bits);
        }
        for unit in &state.units {
            color = environment(
                simd,
                unit,
                &textures,
                &primary,
                color,
                state.clamping != Clamping::None,
            );
        }
    }

    // Apply the colour sum and fog.
    if state.color_sum {
        let s = image.secondary;
        color = color_sum(color, &[splat(simd, s[0]), splat(simd, s[1]), splat(simd, s[2])]);
    }
    if let Some(f) = &state.fog {
        color = fog(f, color, splat(simd, image.fog));
    }
    color
}
