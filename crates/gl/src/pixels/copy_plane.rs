//! Copies of plane to plane: equal rectangles tile by tile, with the resolve of samples, and scaled
//! ones.

use super::internal_format::InternalFormat;
use super::mipmap::average4;
use super::texels::{color_from_word, word_from_color};
use vitral_exec::Workers;
use vitral_raster::TILE;
use vitral_raster::forward::{ColorPlane, Plane, Resolve};

/// The first sample: depth and stencil.
pub(crate) fn first_sample<T: Copy>(samples: [&[T]; 4], out: &mut [T]) {
    out.copy_from_slice(samples[0]);
}

/// The average, rounded.
pub(crate) fn average_words([a, b, c, d]: [&[u32]; 4], out: &mut [u32]) {
    let sources = a.iter().zip(b).zip(c.iter().zip(d));
    for (out, ((&a, &b), (&c, &d))) in out.iter_mut().zip(sources) {
        *out = average4([a, b, c, d]);
    }
}

/// The average of colours.
pub(crate) fn average_colors([a, b, c, d]: [&[[f32; 4]]; 4], out: &mut [[f32; 4]]) {
    for (i, out) in out.iter_mut().enumerate() {
        *out = std::array::from_fn(|k| (a[i][k] + b[i][k] + c[i][k] + d[i][k]) * 0.25);
    }
}

/// A copy without scaling. `clip` (x0, y0, x1, y1) lies inside the destination, and shifted by
/// `shift` inside the source.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Job {
    pub clip: [u32; 4],
    pub shift: [i32; 2],
}

/// Tiles in one piece of work.
const TILES_A_JOB: usize = 8;

/// Copies a rectangle; a multisampled source is resolved into a destination of one sample.
pub(crate) fn copy<T: Copy + Send + Sync>(
    workers: &Workers,
    from: &Plane<T>,
    into: &mut Plane<T>,
    job: Job,
    resolve: Resolve<T>,
) {
    if job.clip[0] >= job.clip[2] || job.clip[1] >= job.clip[3] {
        return;
    }
    if job.shift == [0, 0] && from.viewport().tiles_x() == into.viewport().tiles_x() {
        copy_tiles(workers, from, into, job.clip, resolve);
    } else {
        copy_rows(from, into, job, resolve);
    }
}

fn copy_tiles<T: Copy + Send + Sync>(
    workers: &Workers,
    from: &Plane<T>,
    into: &mut Plane<T>,
    [x0, y0, x1, y1]: [u32; 4],
    resolve: Resolve<T>,
) {
    let side = TILE as u32;
    let viewport = into.viewport();
    let (source_samples, samples) = (from.samples(), into.samples());
    let row = viewport.tiles_x();
    // What of a tile is copied, and whether that is all of it; pixels outside the plane do not
    // count.
    let part = |index: usize| {
        let (left, low) = (index as u32 % row * side, index as u32 / row * side);
        let clip = [x0.max(left), y0.max(low), x1.min(left + side), y1.min(low + side)];
        (
            clip,
            clip == [left, low, viewport.width.min(left + side), viewport.height.min(low + side)],
        )
    };

    // Copy whole tiles in parallel.
    let source = |index: usize| from.tiles.get(index);
    workers.for_each_chunk(&mut into.tiles, TILES_A_JOB, |job, tiles| {
        for (index, tile) in (job * TILES_A_JOB..).zip(tiles) {
            if let (Some(source), (_, true)) = (source(index), part(index)) {
                source.copy_to(source_samples, tile, samples, resolve);
            }
        }
    });

    // Copy rows of the tiles that the rectangle cuts.
    for ty in y0 / side..y1.div_ceil(side) {
        for tx in x0 / side..x1.div_ceil(side) {
            let index = (ty * row + tx) as usize;
            if let (Some(_), (clip, false)) = (source(index), part(index)) {
                copy_rows(from, into, Job { clip, shift: [0, 0] }, resolve);
            }
        }
    }
}

fn copy_rows<T: Copy>(from: &Plane<T>, into: &mut Plane<T>, job: Job, resolve: Resolve<T>) {
    // Reserve a row for each sample.
    let [x0, y0, x1, y1] = job.clip;
    let source_x = (x0 as i32 + job.shift[0]) as u32;
    let width = (x1 - x0) as usize;
    let value = from.get(source_x, (y0 as i32 + job.shift[1]) as u32, 0);
    let mut rows = vec![vec![value; width]; from.samples()];
    let mut out = vec![value; width];
    for y in y0..y1 {
        // Read the row of each sample.
        let source_y = (y as i32 + job.shift[1]) as u32;
        for (s, row) in rows.iter_mut().enumerate() {
            from.read_row(source_x, source_y, s, row);
        }

        // Write it: as it is, resolved to one sample, or sample by sample.
        if from.samples() == 1 {
            into.write_row(x0, y, &rows[0]);
        } else if into.samples() == 1 {
            resolve(std::array::from_fn(|s| &rows[s % rows.len()][..]), &mut out);
            into.write_row(x0, y, &out);
        } else {
            for s in 0..into.samples() {
                for x in 0..width {
                    into.set(x0 + x as u32, y, s, rows[s][x]);
                }
            }
        }
    }
}

fn map<T: Copy, U: Copy>(plane: &Plane<T>, f: impl Fn(T) -> U) -> Plane<U> {
    let first = plane.get(0, 0, 0);
    let mut out = Plane::new(plane.viewport(), plane.samples(), f(first));
    for (tile, source) in out.tiles.iter_mut().zip(&plane.tiles) {
        *tile = source.map(&f);
    }
    out
}

/// A plane's colours as a framebuffer of `format` keeps them.
pub(crate) fn kept(plane: &ColorPlane, format: &InternalFormat) -> ColorPlane {
    match plane {
        ColorPlane::Rgba8(p) => ColorPlane::Rgba8(map(p, |w| format.kept_word(w))),
        ColorPlane::RgbaF32(p) => ColorPlane::RgbaF32(map(p, |c| format.kept(c))),
    }
}

/// A plane of the other kind with the same colours.
pub(crate) fn converted(plane: &ColorPlane, bytes: bool) -> ColorPlane {
    match plane {
        ColorPlane::Rgba8(p) if !bytes => ColorPlane::RgbaF32(map(p, color_from_word)),
        ColorPlane::RgbaF32(p) if bytes => ColorPlane::Rgba8(map(p, word_from_color)),
        same => same.clone(),
    }
}

/// Where the pixels of a scaled rectangle come from, along one axis.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    /// First pixel of the destination.
    pub first: u32,
    /// For each pixel of the destination: the place in the source, in pixels; `None` if it is
    /// outside.
    pub places: Vec<Option<f64>>,
}

impl Axis {
    /// Maps `to` (clipped to `clip`) onto `from`, either of which may run backwards; `size` is the
    /// source's.
    pub(crate) fn new(from: [i32; 2], to: [i32; 2], clip: [i32; 2], size: u32) -> Self {
        let [s0, s1] = from.map(f64::from);
        let [d0, d1] = to.map(f64::from);
        let start = to[0].min(to[1]).max(clip[0]);
        let end = to[0].max(to[1]).min(clip[1]);
        let place = |d: i32| {
            let s = s0 + (f64::from(d) + 0.5 - d0) * (s1 - s0) / (d1 - d0);
            (s >= 0.0 && s < f64::from(size)).then_some(s)
        };
        Self { first: start.max(0) as u32, places: (start..end.max(start)).map(place).collect() }
    }
}

/// Scales by taking the nearest pixel.
pub(crate) fn scale_nearest<T: Copy>(from: &Plane<T>, into: &mut Plane<T>, x: &Axis, y: &Axis) {
    for (j, v) in y.places.iter().enumerate() {
        let Some(v) = v else { continue };
        for (i, u) in x.places.iter().enumerate() {
            let Some(u) = u else { continue };
            let value = from.get(*u as u32, *v as u32, 0);
            for s in 0..into.samples() {
                into.set(x.first + i as u32, y.first + j as u32, s, value);
            }
        }
    }
}

/// Scales with linear interpolation; beyond the source's edge its last pixels go on.
pub(crate) fn scale_linear<T: Copy, U: Copy>(
    from: &Plane<T>,
    into: &mut Plane<U>,
    x: &Axis,
    y: &Axis,
    color: impl Fn(T) -> [f32; 4],
    value: impl Fn([f32; 4]) -> U,
) {
    let viewport = from.viewport();

    // Find the two pixels around a place and the weight of the second.
    let pair = |place: f64, size: u32| {
        let place = (place - 0.5).clamp(0.0, f64::from(size - 1));
        let low = place as u32;
        (low, (low + 1).min(size - 1), (place - f64::from(low)) as f32)
    };
    for (j, v) in y.places.iter().enumerate() {
        let Some(v) = v else { continue };
        let (y0, y1, ty) = pair(*v, viewport.height);
        for (i, u) in x.places.iter().enumerate() {
            let Some(u) = u else { continue };
            let (x0, x1, tx) = pair(*u, viewport.width);
            let corners =
                [(x0, y0), (x1, y0), (x0, y1), (x1, y1)].map(|(x, y)| color(from.get(x, y, 0)));

            // Mix the four pixels around the place.
            let mixed = std::array::from_fn(|c| {
                let low = corners[0][c] + (corners[1][c] - corners[0][c]) * tx;
                let high = corners[2][c] + (corners[3][c] - corners[2][c]) * tx;
                low + (high - low) * ty
            });
            for s in 0..into.samples() {
                into.set(x.first + i as u32, y.first + j as u32, s, value(mixed));
            }
        }
    }
}

/// A plane of one sample with the resolved pixels of another.
pub(crate) fn resolved<T: Copy + Send + Sync>(
    workers: &Workers,
    from: &Plane<T>,
    resolve: Resolve<T>,
) -> Plane<T> {
    let viewport = from.viewport();
    let mut out = Plane::new(viewport, 1, from.get(0, 0, 0));
    copy(
        workers,
        from,
        &mut out,
        Job { clip: [0, 0, viewport.width, viewport.height], shift: [0, 0] },
        resolve,
    );
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_raster::Viewport;

    fn plane(width: u32, height: u32, samples: usize) -> Plane<u32> {
        Plane::new(Viewport::new(width, height).unwrap(), samples, 7)
    }

    #[test]
    fn cleared_tiles_stay_cleared_and_others_are_averaged() {
        let mut from = plane(100, 70, 4);
        (0..4).for_each(|s| from.set(70, 3, s, [0, 4, 8, 12][s]));
        let mut into = plane(100, 70, 1);
        into.clear(1);
        copy(
            &Workers::new(2),
            &from,
            &mut into,
            Job { clip: [0, 0, 100, 70], shift: [0, 0] },
            average_words,
        );
        assert_eq!(into.tiles[0].uniform(), Some(7));
        assert_eq!(into.tiles[3].uniform(), Some(7));
        assert_eq!((into.get(70, 3, 0), into.get(71, 3, 0)), (6, 7));
        // A part of a cleared tile.
        into.clear(1);
        copy(
            &Workers::new(2),
            &from,
            &mut into,
            Job { clip: [2, 2, 5, 4], shift: [0, 0] },
            average_words,
        );
        assert_eq!(
            [into.get(1, 2, 0), into.get(2, 2, 0), into.get(4, 3, 0), into.get(5, 3, 0)],
            [1, 7, 7, 1]
        );
    }

    #[test]
    fn shifted_copies_agree_with_aligned_ones() {
        let mut from = plane(80, 10, 4);
        for (x, s) in (0..80).flat_map(|x| (0..4).map(move |s| (x, s))) {
            from.set(x, 5, s, x + s as u32);
        }
        let mut into = plane(80, 10, 1);
        copy(
            &Workers::new(2),
            &from,
            &mut into,
            Job { clip: [0, 4, 78, 5], shift: [2, 1] },
            average_words,
        );
        assert_eq!(into.get(0, 4, 0), 4);
        assert_eq!(into.get(77, 4, 0), 81);
        let mut all = plane(80, 10, 4);
        copy(
            &Workers::new(2),
            &from,
            &mut all,
            Job { clip: [0, 4, 78, 5], shift: [2, 1] },
            average_words,
        );
        assert_eq!(all.get(0, 4, 3), 5);
    }

    #[test]
    fn scaled_axes_run_backwards_and_leave_the_source() {
        let axis = Axis::new([0, 2], [4, 0], [0, 10], 2);
        assert_eq!(axis.places, [Some(1.75), Some(1.25), Some(0.75), Some(0.25)]);
        let axis = Axis::new([-1, 1], [0, 2], [1, 10], 2);
        assert_eq!((axis.first, axis.places), (1, vec![Some(0.5)]));
        assert!(Axis::new([0, 1], [5, 5], [0, 10], 2).places.is_empty());
        let wild = Axis::new([i32::MIN, i32::MAX], [i32::MIN, i32::MAX], [0, 4], 4);
        assert_eq!(wild.places.len(), 4);
    }
}
