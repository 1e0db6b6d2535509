//! Cube maps: a direction chooses a face and a point on it.
//!
//! Seamless filtering takes the texels beyond a face's edge from the face that meets it there; at a
//! corner of the cube, where three faces meet and a fourth texel is missing, the three others' mean
//! stands in for it.
//!
//! Source: OpenGL 1.5 specification, table 3.20; ARB_seamless_cube_map.

use super::depth::{by_mode, compared, reference};
use super::fetch::{Image, TexelWords, columns, interior, level_of, level_of_face, quads};
use super::halves::Halves;
use super::mip::{mipped, mix_rgba};
use super::packed_cube::PackedCube;
use super::wrap::{Axis, position};
use crate::forward::texture::{Level, Texels, Texture, Wrap};
use crate::forward::wide::{Rgba, abs, bits_of, every, mask_of, select, select_rgba, splat_rgba};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, Floats, I32x8, LANES, Lanes, Mask8, MaskOf, Simd, U32x8};

/// As [`super::sample`].
#[inline(never)]
pub(super) fn sample<S: Simd>(
    simd: S,
    texture: &Texture,
    coords: [F32x8<S>; 4],
    lod: F32x8<S>,
    active: u32,
) -> Rgba<S> {
    simd.vectorize(
        #[inline(always)]
        || {
            // Choose the face and the point on it.
            let is_depth =
                matches!(level_of(texture, 0).map(|l| l.texels()), Some(Texels::Depth(_)));
            let direction = [coords[0], coords[1], coords[2]];
            let chart = Chart::new(
                simd,
                if is_depth { direction } else { turned(simd, direction, coords[3]) },
            );
            let (face, point) = (chart.face(simd), chart.point());

            // Sample a packed map if there is one.
            if let Some(packed) = PackedCube::new(texture) {
                return packed.at(simd, (face, point), lod);
            }

            // Otherwise filter texel by texel.
            let face = face.bitcast::<U32x8<S>>().to_array();
            let reference = is_depth.then(
                #[inline(always)]
                || reference(texture, coords[3]),
            );
            let color = mipped(
                simd,
                texture,
                lod,
                active,
                #[inline(always)]
                |level, linear, lanes| {
                    lookup(simd, texture, level, linear, &face, point, lanes, reference)
                },
            );
            if is_depth { by_mode(simd, texture.depth_mode, color[0]) } else { color }
        },
    )
}

/// A vector divided by q, but for its length: a negative q turns it round.
#[inline(always)]
fn turned<S: Simd, V: Floats<S>>(simd: S, v: [V; 3], q: V) -> [V; 3] {
    let turn = q.simd_lt(every::<S, V>(simd, 0.0));
    lanes::three(
        #[inline(always)]
        |k| select(turn, -v[k], v[k]),
    )
}

/// Where directions pierce the cube: the face's two coordinates, and the one that is largest.
pub(crate) struct Chart<S: Simd, V: Floats<S> = F32x8<S>> {
    sc: V,
    tc: V,
    /// Magnitude of the major coordinate.
    major: V,
    x_major: MaskOf<S, V>,
    y_major: MaskOf<S, V>,
    negative: MaskOf<S, V>,
}

impl<S: Simd, V: Floats<S>> Chart<S, V> {
    #[inline(always)]
    pub(crate) fn new(simd: S, direction: [V; 3]) -> Self {
        let [x, y, z] = direction;
        let (ax, ay, az) = (abs(x), abs(y), abs(z));
        let x_major = ax.simd_ge(ay) & ax.simd_ge(az);
        let y_major = !x_major & ay.simd_ge(az);
        let along = select(x_major, x, select(y_major, y, z));
        let negative = along.simd_lt(every::<S, V>(simd, 0.0));
        let [sc, tc] = on_face(x_major, y_major, negative, direction);
        Self { sc, tc, major: abs(along), x_major, y_major, negative }
    }

    /// The face's number: +x -x +y -y +z -z.
    #[inline(always)]
    pub(crate) fn face(&self, simd: S) -> V::Ints {
        let number = lanes::inlined(
            #[inline(always)]
            |n: f32| every::<S, V>(simd, n),
        );
        let axis =
            select(self.x_major, number(0.0), select(self.y_major, number(2.0), number(4.0)));
        (axis + select(self.negative, number(1.0), number(0.0))).to_int()
    }

    /// The point on the face, 0..=1 along s and t.
    #[inline(always)]
    pub(crate) fn point(&self) -> [V; 2] {
        [self.coordinate(self.sc), self.coordinate(self.tc)]
    }

    /// From -major..=major to 0..=1.
    #[inline(always)]
    fn coordinate(&self, c: V) -> V {
        (c / self.major + 1.0) * 0.5
    }
}

/// The coordinates of a vector along the face's s and t.
#[inline(always)]
fn on_face<V: Lanes>(x_major: V::Mask, y_major: V::Mask, negative: V::Mask, v: [V; 3]) -> [V; 2] {
    let [x, y, z] = v;
    let sc_x = select(negative, z, -z);
    let sc_z = select(negative, -x, x);
    let tc_y = select(negative, -z, z);
    [select(x_major, sc_x, select(y_major, x, sc_z)), select(y_major, tc_y, -y)]
}

/// How many texels of a face of `size` texels a step to the right and a step up cross.
#[inline(always)]
pub(crate) fn derivatives<S: Simd, V: Floats<S>>(
    simd: S,
    size: f32,
    chart: &Chart<S, V>,
    along: [[V; 3]; 2],
) -> [[V; 2]; 2] {
    let scale = every::<S, V>(simd, size * 0.5) / chart.major;
    let mut steps = [[every(simd, 0.0); 2]; 2];
    for (step, d) in steps.iter_mut().zip(along) {
        // d(sc / ma) = (dsc - sc / ma * dma) / ma.
        let [dsc, dtc] = on_face(chart.x_major, chart.y_major, chart.negative, d);
        let along = select(chart.x_major, d[0], select(chart.y_major, d[1], d[2]));
        let dma = select(chart.negative, -along, along);
        step[0] = (dsc - chart.sc / chart.major * dma) * scale;
        step[1] = (dtc - chart.tc / chart.major * dma) * scale;
    }
    steps
}

/// One level, filtered.
#[inline(always)]
fn lookup<S: Simd>(
    simd: S,
    texture: &Texture,
    level: usize,
    filtered: bool,
    face: &[u32; LANES],
    point: [F32x8<S>; 2],
    lanes: u32,
    reference: Option<F32x8<S>>,
) -> Rgba<S> {
    // Most rows of pixels see one face: then all is as on a flat image.
    let first = lanes.trailing_zeros() as usize % LANES;
    let Some(shape) = level_of_face(texture, (face[first] % 6) as usize, level) else {
        return splat_rgba(simd, [0.0, 0.0, 0.0, 1.0]);
    };

    // Find the texels and weights along both axes.
    let size = interior(shape, 2);
    let seamless = texture.sampler.seamless && shape.border == 0 && size[0] == size[1];
    let wrap = match (seamless, filtered) {
        (true, true) => [Wrap::ClampToBorder; 2],
        (true, false) => [Wrap::ClampToEdge; 2],
        (false, _) => [texture.sampler.wrap[0], texture.sampler.wrap[1]],
    };
    let x = Axis::new(simd, position(simd, point[0], size[0], wrap[0]), size[0], wrap[0], filtered);
    let y = Axis::new(simd, position(simd, point[1], size[1], wrap[1]), size[1], wrap[1], filtered);

    // Filter eight lanes at once where all see the inside of one face.
    let one_face = bits_of(U32x8::from_slice(simd, face).simd_eq(face[first])) & lanes == lanes;
    let inside = bits_of(crosses(simd, &x, size[0]) | crosses(simd, &y, size[1])) & lanes == 0;
    if one_face
        && inside
        && shape.border == 0
        && let Some(words) = TexelWords::new(shape)
        && let Some(columns) = if filtered {
            shape.columns(shape.size[0] as usize * shape.size[1] as usize)
        } else {
            Some(&[][..])
        }
    {
        let color = if filtered {
            bilinear(simd, (columns, size[0]), words, &x, &y)
        } else {
            words.colors(simd, y.near * size[0] as i32 + x.near)
        };
        return words.finish(color);
    }

    // Otherwise go lane by lane.
    let spot = Spot { level, shape, face, x, y, lanes, seamless, filtered, reference };
    general(simd, texture, &spot)
}

/// Raw colours inside an image.
#[inline(always)]
fn bilinear<S: Simd>(
    simd: S,
    (columns, width): (&[[u32; 2]], u32),
    words: TexelWords<'_>,
    x: &Axis<S>,
    y: &Axis<S>,
) -> Rgba<S> {
    let quads = quads::<S, F32x8<S>>(
        simd,
        #[inline(always)]
        |_| columns,
        y.near * (width as i32 + 1) + x.near,
    );
    if !words.is_encoded() {
        return Halves::filter(simd, quads, [x.weight, y.weight]).unpack();
    }
    let [a, b, c, d] = quads;
    let lower = mix_rgba(words.meaning(simd, a), words.meaning(simd, b), x.weight);
    let upper = mix_rgba(words.meaning(simd, c), words.meaning(simd, d), x.weight);
    mix_rgba(lower, upper, y.weight)
}

/// Where an axis reaches beyond the image.
#[inline(always)]
pub(super) fn crosses<S: Simd, V: Floats<S>>(
    simd: S,
    axis: &Axis<S, V>,
    size: u32,
) -> MaskOf<S, V> {
    axis.near.simd_lt(V::Ints::splat(simd, 0)) | axis.far.simd_ge(V::Ints::splat(simd, size as i32))
}

/// A lookup in one level, ready but for the texels.
struct Spot<'a, S: Simd> {
    level: usize,
    shape: &'a Level,
    /// The face of each lane, 0 to 5.
    face: &'a [u32; LANES],
    x: Axis<S>,
    y: Axis<S>,
    /// Bits of the lanes that are looked up.
    lanes: u32,
    seamless: bool,
    filtered: bool,
    /// The depth to compare with, of depth textures.
    reference: Option<F32x8<S>>,
}

/// Several faces, edges, borders, any texels.
#[inline(never)]
fn general<S: Simd>(simd: S, texture: &Texture, spot: &Spot<'_, S>) -> Rgba<S> {
    simd.vectorize(
        #[inline(always)]
        || {
            // Fetch the corners of each cell, each from the face it lies on.
            let image = Image::new(spot.shape);
            let border = splat_rgba(simd, image.raw(texture.sampler.border));
            let corners = if spot.filtered { 4 } else { 1 };
            let mut colors = [border; 4];
            let mut missing = [0u32; 4];
            for corner in 0..corners {
                let x = if corner & 1 == 0 { spot.x.near } else { spot.x.far };
                let y = if corner & 2 == 0 { spot.y.near } else { spot.y.far };
                let place = texel_coords(simd, spot, x, y);
                let mut color = texels(simd, texture, spot, &place);
                color = select_rgba(place.outside, border, color);
                if let Some(reference) = spot.reference {
                    color[0] = compared(simd, texture, reference, color[0]);
                }
                colors[corner] = color;
                missing[corner] = place.missing;
            }

            // Fill the missing corners at the cube's corners and filter.
            if spot.filtered {
                fill_missing(&mut colors, missing.map(|bits| mask_of(simd, bits)));
                let lower = mix_rgba(colors[0], colors[1], spot.x.weight);
                let upper = mix_rgba(colors[2], colors[3], spot.x.weight);
                colors[0] = mix_rgba(lower, upper, spot.y.weight);
            }
            image.finish(colors[0])
        },
    )
}

/// One raw texel a lane, each from its face.
#[inline(always)]
fn texels<S: Simd>(
    simd: S,
    texture: &Texture,
    spot: &Spot<'_, S>,
    place: &TexelCoords8<S>,
) -> Rgba<S> {
    let index = place.index.to_array();
    // Fetch packed words lane by lane.
    if let Some(first) = TexelWords::new(spot.shape) {
        let mut words = [0u32; LANES];
        for lane in 0..LANES {
            let shape = level_of_face(texture, (place.face[lane] % 6) as usize, spot.level);
            if let Some(texels) = shape.and_then(TexelWords::new) {
                words[lane] =
                    texels.texels.get(index[lane] as u32 as usize).copied().unwrap_or_default();
            }
        }
        return first.meaning(simd, U32x8::from_slice(simd, &words));
    }

    // Fetch other texels as colours.
    let mut colors = [[0.0f32; 4]; LANES];
    for lane in 0..LANES {
        if spot.lanes >> lane & 1 == 1
            && let Some(shape) = level_of_face(texture, (place.face[lane] % 6) as usize, spot.level)
        {
            colors[lane] = Image::new(shape).color(index[lane] as usize);
        }
    }
    columns(simd, &colors)
}

/// Texels of one corner.
struct TexelCoords8<S: Simd> {
    /// The face of each lane, 0 to 5.
    face: [u32; LANES],
    /// The texel's number in its face.
    index: I32x8<S>,
    /// Lanes of the border colour.
    outside: Mask8<S>,
    /// Lanes for which there is no texel: beyond a corner of the cube.
    missing: u32,
}

/// Finds the texels `(x, y)` of the faces, which may lie one beyond their edges.
#[inline(always)]
fn texel_coords<S: Simd>(simd: S, spot: &Spot<'_, S>, x: I32x8<S>, y: I32x8<S>) -> TexelCoords8<S> {
    // Clamp the texel to the face.
    let Spot { shape, face, lanes, seamless, .. } = *spot;
    let (zero, last) = (I32x8::splat(simd, 0), I32x8::splat(simd, shape.size[0] as i32 - 1));
    let last_y = I32x8::splat(simd, shape.size[1] as i32 - 1);
    let (x, y) = (x + shape.border as i32, y + shape.border as i32);
    let outside = x.simd_lt(zero) | x.simd_gt(last) | y.simd_lt(zero) | y.simd_gt(last_y);
    let beyond = outside.to_bitmask() as u32 & lanes;
    let index = y.min(last_y).max(zero) * shape.size[0] as i32 + x.min(last).max(zero);
    if !seamless || beyond == 0 {
        return TexelCoords8 { face: *face, index, outside, missing: 0 };
    }

    // Few lanes cross an edge: one by one.
    let (x, y) = (x.to_array(), y.to_array());
    let (mut faces, mut numbers, mut missing) = (*face, index.to_array(), 0);
    for lane in 0..LANES {
        if beyond >> lane & 1 == 1 {
            match neighbour(face[lane], x[lane], y[lane], shape.size[0] as i32) {
                Some((face, x, y)) => {
                    faces[lane] = face;
                    numbers[lane] = y * shape.size[0] as i32 + x;
                }
                None => missing |= 1 << lane,
            }
        }
    }
    let index = I32x8::from_slice(simd, &numbers);
    TexelCoords8 { face: faces, index, outside: mask_of(simd, 0), missing }
}

/// The face and texel next to `face` at `(x, y)`, one of which lies one texel beyond `0..size`;
/// `None` if both do.
///
/// Texel centres are odd multiples of half a texel on a cube of `2 * size` halves. Folding a texel
/// over the edge swaps its place along the axis that it leaves with the face's own axis.
pub(super) fn neighbour(face: u32, x: i32, y: i32, size: i32) -> Option<(u32, i32, i32)> {
    let (sc, tc) = (2 * x + 1 - size, 2 * y + 1 - size);
    if sc.abs() > size && tc.abs() > size {
        return None;
    }
    // The point on the cube: on the old face's plane, then folded over the edge.
    let fold = |c: i32| c.clamp(-size, size);
    let major = size - 1;
    let p = match face {
        0 => [major, -fold(tc), -fold(sc)],
        1 => [-major, -fold(tc), fold(sc)],
        2 => [fold(sc), major, fold(tc)],
        3 => [fold(sc), -major, -fold(tc)],
        4 => [fold(sc), -fold(tc), major],
        _ => [-fold(sc), -fold(tc), -major],
    };

    // Find the face whose plane the point lies on and its place there.
    let axis = p.iter().position(|c| c.abs() == size)?;
    let (face, sc, tc) = match (axis, p[axis] > 0) {
        (0, true) => (0, -p[2], -p[1]),
        (0, false) => (1, p[2], -p[1]),
        (1, true) => (2, p[0], p[2]),
        (1, false) => (3, p[0], -p[2]),
        (_, true) => (4, p[0], -p[1]),
        (_, false) => (5, -p[0], -p[1]),
    };
    Some((face, (sc + size - 1) / 2, (tc + size - 1) / 2))
}

/// Puts the mean of the three others where a corner has no texel.
#[inline(always)]
pub(super) fn fill_missing<V: Lanes>(colors: &mut [[V; 4]; 4], missing: [V::Mask; 4]) {
    let [a, b, c, d] = *colors;
    for k in 0..4 {
        let sum = a[k] + b[k] + c[k] + d[k];
        for corner in 0..4 {
            let mean = (sum - colors[corner][k]) / 3.0;
            colors[corner][k] = select(missing[corner], mean, colors[corner][k]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::neighbour;

    #[test]
    fn folding_over_an_edge_and_back_returns() {
        let size = 4;
        for face in 0..6 {
            for i in 0..size {
                for (x, y) in [(-1, i), (size, i), (i, -1), (i, size)] {
                    let (other, u, v) = neighbour(face, x, y, size).unwrap();
                    assert!(
                        other != face && other / 2 != face / 2,
                        "the opposite face is no neighbour"
                    );
                    assert!((0..size).contains(&u) && (0..size).contains(&v));
                    // From there one step back over the same edge leads to the texel inside the
                    // first face.
                    let inside = (x.clamp(0, size - 1), y.clamp(0, size - 1));
                    let steps = [(u - 1, v), (u + 1, v), (u, v - 1), (u, v + 1)];
                    let back = steps
                        .into_iter()
                        .filter(|&(u, v)| !(0..size).contains(&u) || !(0..size).contains(&v));
                    assert!(
                        back.clone().any(|(u, v)| neighbour(other, u, v, size)
                            == Some((face, inside.0, inside.1))),
                        "face {face} ({x}, {y})"
                    );
                }
            }
        }
        assert_eq!(neighbour(0, -1, size, size), None);
        // Table by hand: +x's left edge (s = 0) meets +z's right edge; its lower edge (t = 0) is
        // +y's right edge.
        assert_eq!(neighbour(0, -1, 1, 4), Some((4, 3, 1)));
        assert_eq!(neighbour(0, 1, -1, 4), Some((2, 3, 2)));
    }
}
