//! The hemicube: form factors from a point to everything it sees.
//!
//! Half a cube stands on the point, its five faces cut into pixels. What is seen through a pixel is
//! found by the z-buffer, the renderer's own; the form factor of the pixel is known beforehand,
//! `ΔF = ΔA / (π (x² + y² + 1)²)` on the top and `z ΔA / (π (y² + z² + 1)²)` on a side. The factor
//! to an element is the sum over the pixels that show it. The factors of all pixels are scaled to
//! the sum 1, so that no light is lost or made.
//!
//! The z-buffer draws the facets, not the elements that they are cut into: where the pixel's ray
//! meets the facet, [`Targets`] say which element it is. So what a hemicube costs hardly grows with
//! the number of elements. Each hemicube is turned about the normal by another angle, so that the
//! steps of its pixels do not add up to patterns.
//!
//! In:   quadtrees over facets; point and normal. Out: elements and factors.
//! Cost: five small pictures of the facets, and a step for each element that a row of pixels
//!       crosses.
//! Source: \[Cohen & Greenberg 1985\]. Departs from it: facets are drawn in place of elements.

use super::patch::Trees;
use super::targets::{Sums, Targets};
use crate::shadow::clearance;
use crate::stats::CullCounters;
use crate::visible::{TileSink, resolve_in_passing};
use crate::{Execution, PreparedView, Settings};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Mutex;
use vitral_exec::{Limit, Workers};
use vitral_math::{DVec3, func};
use vitral_raster::{LayerList, NO_FACET, SamplePattern, TILE, Tile, Viewport};
use vitral_scene::{Camera, Projection};

/// The part of a quarter turn by which the first hemicube is turned about the normal, lest edges
/// along the axes pass through the middles of a whole row of pixels.
const FIRST_TURN: f64 = 0.35;
/// By which the next one is turned further: the golden section, which spreads any number of them
/// evenly.
const NEXT_TURN: f64 = 0.618_033_988_749_895;

/// Borders of elements that a pixel's width crosses, from which on pixels are looked at one by one.
const DENSE: f64 = 0.7;

/// A hemicube of some resolution.
#[derive(Debug)]
pub struct Hemicube {
    settings: Settings,
    /// Form factors of the pixels of the top, and of the upper half of a side. Each row begins with
    /// 0, and has for each pixel the sum up to it.
    sums: [Vec<f64>; 2],
    /// Of the scene.
    diagonal: f64,
}

impl Hemicube {
    /// With `side` pixels along an edge of the top, an even number, for a scene of this size.
    pub fn new(side: u32, diagonal: f64) -> Self {
        // Compute the form factor of each pixel of the top and of a wall.
        let step = 2.0 / f64::from(side);
        let at = |i: u32| (f64::from(i) + 0.5) * step - 1.0;
        let row = |wall: bool, row: u32| {
            let y = -at(row);
            let factors = (0..side).map(|column| {
                let (x, height) = (at(column), if wall { y } else { 1.0 });
                let square = x * x + y * y + 1.0;
                height * step * step / (PI * square * square)
            });
            factors.collect::<Vec<f64>>()
        };
        let top: Vec<_> = (0..side).map(|i| row(false, i)).collect();
        let wall: Vec<_> = (0..side / 2).map(|i| row(true, i)).collect();

        // Normalize them to a sum of one, and sum along the rows for spans.
        let sum = |rows: &[Vec<f64>]| rows.iter().flatten().sum::<f64>();
        let whole = sum(&top) + 4.0 * sum(&wall);
        let sums = [top, wall].map(|rows| {
            let up_to = rows.iter().flat_map(|row| {
                let mut sum = 0.0;
                let sums = row.iter().map(move |factor| {
                    sum += factor / whole;
                    sum
                });
                std::iter::once(0.0).chain(sums)
            });
            up_to.collect()
        });
        let settings = Settings::default().with_size(side, side).with_samples(1);
        Self { settings, sums, diagonal }
    }

    /// Pixels along an edge of the top.
    pub fn side(&self) -> u32 {
        self.settings.picture.width
    }

    /// What a point with unit normal sees: leaves of `trees`, by number, and form factors, in the
    /// order of leaves. The hemicube is turned as that of this `number`.
    ///
    /// # Errors
    /// A limit of the budget.
    pub fn look(
        &self,
        (targets, trees): (&Targets, &Trees),
        (point, normal): (DVec3, DVec3),
        number: usize,
        execution: &Execution,
    ) -> Result<Vec<(u32, f64)>, Limit> {
        let turn = (FIRST_TURN + NEXT_TURN * number as f64).fract();
        let ((u, v), (sin, cos)) = (normal.any_orthonormal_pair(), func::sin_cos(turn * FRAC_PI_2));
        let (u, v) = (u * cos + v * sin, v * cos - u * sin);
        // Whatever is nearer than this is the surface itself, rounded; the eye is lifted off it.
        let near = clearance(point, 0.5 * self.diagonal);
        let point = point + normal * near;
        // Points look from different threads: each draws alone.
        let execution =
            Execution { workers: Workers::single(), observer: None, ..execution.clone() };
        let mut seen = targets.sums();
        for (face, [towards, up]) in
            [[normal, u], [u, normal], [-u, normal], [v, normal], [-v, normal]]
                .into_iter()
                .enumerate()
        {
            let camera = Camera {
                position: point,
                focal_point: point + towards,
                view_up: up,
                projection: Projection::Perspective { view_angle: FRAC_PI_2 },
                clip: Some((near, 2.0 * self.diagonal)),
            };
            self.face(
                (targets, trees),
                &camera,
                &self.sums[usize::from(face > 0)],
                &execution,
                &mut seen,
            )?;
        }
        Ok(targets.finish(seen))
    }

    fn face(
        &self,
        (targets, trees): (&Targets, &Trees),
        camera: &Camera,
        sums: &[f64],
        execution: &Execution,
        seen: &mut Sums,
    ) -> Result<(), Limit> {
        let side = self.settings.picture.width;
        let viewport = Viewport { width: side, height: side };
        let (pattern, counters) = (SamplePattern::new(1), &mut CullCounters::default());
        let view = PreparedView::new(
            &targets.session,
            camera,
            &self.settings,
            viewport,
            pattern,
            execution,
            counters,
        );
        let (eye, forward, up) =
            (camera.position, camera.focal_point - camera.position, camera.view_up);
        let axes = [forward.cross(up), up, forward];
        let sink = Collector {
            sums,
            side: side as usize,
            targets,
            trees,
            eye,
            axes,
            seen: Mutex::new(seen),
        };
        // Of sides the upper half.
        let rows = (sums.len() / (side as usize + 1)).div_ceil(TILE) as u32;
        resolve_in_passing(&view, rows, execution, &sink)
    }
}

/// Adds up the factors of the pixels that show each leaf.
struct Collector<'a> {
    sums: &'a [f64],
    side: usize,
    targets: &'a Targets,
    trees: &'a Trees,
    eye: DVec3,
    /// Right, up, forward.
    axes: [DVec3; 3],
    /// A sum for each leaf.
    seen: Mutex<&'a mut Sums>,
}

impl Collector<'_> {
    /// Adds the factors of neighbours in a row, from this column on, that show one facet. `sums`
    /// has one more than there are pixels.
    fn add(&self, facet: u32, [column, row]: [usize; 2], sums: &[f64], seen: &mut Sums) {
        // A ray's direction is a sum of the corners as seen from the eye, with these weights times
        // some number. Along a row they change evenly, and so do the weights within any node.
        let [a, b, c] = self.targets.corners(facet).map(|corner| corner - self.eye);
        let (step, [right, up, forward]) = (2.0 / self.side as f64, self.axes);
        let at = |i: usize| (i as f64 + 0.5) * step - 1.0;
        let first = forward + right * at(column) - up * at(row);
        let edges = [b.cross(c), c.cross(a), a.cross(b)];
        let (mut start, mut slopes) =
            (edges.map(|n| n.dot(first)), edges.map(|n| n.dot(right) * step));
        if start.iter().sum::<f64>() < 0.0 {
            (start, slopes) = (start.map(|w| -w), slopes.map(|w| -w));
        }
        let (mut done, count) = (0, sums.len() - 1);
        let after = |pixels: usize| [0, 1, 2].map(|k| start[k] + pixels as f64 * slopes[k]);
        if self.targets.borders_crossed(facet, start, slopes) > DENSE {
            // Nearly every pixel shows another element: how far each goes on need not be known.
            for (i, factors) in sums.windows(2).enumerate() {
                seen.add(
                    self.targets.leaf_at(self.trees, facet, after(i)),
                    factors[1] - factors[0],
                );
            }
            return;
        }
        while done < count {
            let here = after(done);
            let (leaf, weights, slopes) = self.targets.leaf_along(self.trees, facet, here, slopes);
            // As far as no weight falls below 0.
            let ends = [0, 1, 2]
                .map(|k| if slopes[k] < 0.0 { weights[k] / -slopes[k] } else { f64::INFINITY });
            let length = ends[0].min(ends[1]).min(ends[2]).max(0.0) as usize;
            let next = done.saturating_add(length).saturating_add(1).min(count);
            seen.add(leaf, sums[next] - sums[done]);
            done = next;
        }
    }
}

impl TileSink for Collector<'_> {
    fn tile(&self, _: usize, tile: &Tile, _: &mut LayerList) {
        let mut seen = self.seen.lock().expect("no thread panics while it collects");
        let (left, top) = (tile.x as usize, tile.y as usize);
        let (columns, rows) = (TILE.min(self.side - left), TILE.min(self.side - top));
        for row in 0..rows {
            let at = (top + row) * (self.side + 1) + left;
            let Some(sums) = self.sums.get(at..at + columns + 1) else { break };
            let mut column = 0;
            for run in tile.facet[row * TILE..row * TILE + columns].chunk_by(|a, b| a == b) {
                if run[0] != NO_FACET {
                    let place = [left + column, top + row];
                    self.add(run[0], place, &sums[column..column + run.len() + 1], &mut seen);
                }
                column += run.len();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::radiosity::form_factor::from_point;
    use vitral_math::dvec3;

    /// A square from corner along two directions, cut until no edge is longer than `longest`.
    fn square(corner: DVec3, u: DVec3, v: DVec3, longest: f64) -> Trees {
        let corners = [corner, corner + u, corner + u + v, corner + v];
        let facet = |f: u32| {
            Some(if f == 0 {
                [corners[0], corners[1], corners[2]]
            } else {
                [corners[0], corners[2], corners[3]]
            })
        };
        Trees::new(2, facet, longest, 1 << 16).unwrap()
    }

    /// The mean over points of the unit square in the plane z = 0.
    fn mean(trees: &Trees, steps: u32) -> f64 {
        let hemicube = Hemicube::new(256, 2.0);
        let (execution, targets) = (Execution::default(), Targets::new(trees));
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(steps);
        let points = execution.workers.map((steps * steps) as usize, |i| {
            let point = dvec3(at(i as u32 % steps), at(i as u32 / steps), 0.0);
            let seen = hemicube.look((&targets, trees), (point, DVec3::Z), i, &execution).unwrap();
            seen.iter().map(|(_, f)| f).sum::<f64>()
        });
        points.iter().sum::<f64>() / f64::from(steps * steps)
    }

    #[test]
    fn squares_have_the_factors_of_the_handbooks() {
        let parallel = mean(&square(DVec3::Z, DVec3::Y, DVec3::X, 0.3), 12);
        assert!((parallel - 0.199_824_895_7).abs() < 1e-3, "{parallel}");
        let perpendicular = mean(&square(DVec3::ZERO, DVec3::Y, DVec3::Z, 2.0), 24);
        assert!((perpendicular - 0.200_043_776_1).abs() < 1e-3, "{perpendicular}");
    }

    #[test]
    fn rays_find_the_elements_that_they_meet() {
        // Seen from outside the middle, so that nothing is symmetric.
        let (point, trees) =
            (dvec3(0.2, 0.35, 0.0), square(DVec3::Z * 0.5, DVec3::Y, DVec3::X, 0.4));
        let hemicube = Hemicube::new(512, 2.0);
        let targets = Targets::new(&trees);
        let seen =
            hemicube.look((&targets, &trees), (point, DVec3::Z), 0, &Execution::default()).unwrap();
        let leaves = trees.leaves();
        assert_eq!(seen.len(), leaves.len());
        for (number, factor) in seen {
            // Counter-clockwise as seen from below.
            let [a, b, c] = trees.places(leaves[number as usize]);
            let exact = from_point(point, DVec3::Z, &[a, b, c]);
            assert!((factor - exact).abs() < 2e-4 + 0.01 * exact, "{number}: {factor}, {exact}");
        }
    }

    #[test]
    fn what_is_near_hides_what_is_behind_it_in_large_scenes() {
        // A ceiling, and a lid a fiftieth of a thousandth of the scene's diagonal above the eye.
        let (diagonal, height) = (1000.0, 0.02);
        let at = |f: u32, size: f64, z: f64| {
            let [a, b, c, d] = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)]
                .map(|(x, y)| dvec3(x * size, y * size, z));
            if f == 0 { [a, b, c] } else { [a, c, d] }
        };
        let corners =
            |f: u32| Some(if f < 2 { at(f, 100.0, 100.0) } else { at(f - 2, 2.0, height) });
        let trees = Trees::new(4, corners, 1000.0, 1 << 10).unwrap();
        let (hemicube, targets) = (Hemicube::new(64, diagonal), Targets::new(&trees));
        let seen = hemicube
            .look((&targets, &trees), (DVec3::ZERO, DVec3::Z), 0, &Execution::default())
            .unwrap();
        let leaf = |number: u32| trees.nodes[trees.leaves()[number as usize] as usize];
        assert!(
            seen.len() == 2 && seen.iter().all(|&(number, _)| leaf(number).facet >= 2),
            "{seen:?}"
        );
        assert!(seen.iter().map(|(_, factor)| factor).sum::<f64>() > 0.999, "{seen:?}");
    }

    #[test]
    fn all_pixels_together_are_one() {
        for side in [2, 64, 130] {
            let hemicube = Hemicube::new(side, 1.0);
            let sum = |face: usize| {
                hemicube.sums[face]
                    .iter()
                    .skip(side as usize)
                    .step_by(side as usize + 1)
                    .sum::<f64>()
            };
            let sum = sum(0) + 4.0 * sum(1);
            assert!((sum - 1.0).abs() < 1e-12);
        }
    }
}
