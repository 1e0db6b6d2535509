//! The hemicube: form factors from a point to everything it sees.
//!
//! Half a cube stands on the point, its five faces cut into pixels. What is seen through a pixel is found by the
//! z-buffer, the renderer's own; the form factor of the pixel is known beforehand,
//! `ΔF = ΔA / (π (x² + y² + 1)²)` on the top and `z ΔA / (π (y² + z² + 1)²)` on a side. The factor to an element is the sum
//! over the pixels that show it. The factors of all pixels are scaled to the sum 1, so that no light is lost or made.
//!
//! The z-buffer draws the facets, not the elements that they are cut into: where the pixel's ray meets the facet, the
//! quadtree says which element it is. So what a hemicube costs hardly grows with the number of elements.
//!
//! In:   quadtrees over facets; point and normal. Out: elements and factors.
//! Cost: five small pictures of the facets, and a step for each pixel and level of the quadtrees.
//! Source: \[Cohen & Greenberg 1985\]. Departs from it: sides are drawn whole, their lower halves unused; facets are
//! drawn in place of elements.

use super::patch::{NONE, Trees};
use crate::stats::CullCounters;
use crate::visible::{TileSink, VisibleSurface, zbuffer::ZBuffer};
use crate::{Execution, PreparedView, Session, Settings};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::{Arc, Mutex};
use vitral_exec::{Limit, Workers};
use vitral_math::{DVec3, func};
use vitral_raster::{LayerList, NO_FACET, SamplePattern, TILE, Tile, TileGrid, Viewport};
use vitral_scene::{Camera, Mesh, Part, Projection, Scene};

/// Radians by which a hemicube is turned about the normal.
const TURN: f64 = 0.55;

/// A hemicube of some resolution.
#[derive(Debug)]
pub struct Hemicube {
    settings: Settings,
    /// Form factors of the pixels of the top, and of the upper half of a side.
    factors: [Vec<f64>; 2],
    /// Distances of the near and far planes.
    clip: (f64, f64),
}

impl Hemicube {
    /// With `side` pixels along an edge of the top, an even number, for a scene of this size.
    pub fn new(side: u32, diagonal: f64) -> Self {
        let step = 2.0 / f64::from(side);
        let at = |i: u32| (f64::from(i) + 0.5) * step - 1.0;
        let (mut top, mut wall) = (Vec::new(), Vec::new());
        for row in 0..side {
            for column in 0..side {
                let (x, y) = (at(column), -at(row));
                let square = x * x + y * y + 1.0;
                let factor = step * step / (PI * square * square);
                top.push(factor);
                if row < side / 2 {
                    wall.push(y * factor);
                }
            }
        }
        let whole = top.iter().sum::<f64>() + 4.0 * wall.iter().sum::<f64>();
        top.iter_mut().chain(&mut wall).for_each(|f| *f /= whole);
        let settings = Settings { width: side, height: side, samples: 1, ..Settings::default() };
        Self { settings, factors: [top, wall], clip: (diagonal * 1e-4, diagonal * 2.0) }
    }

    /// What a point with unit normal sees: leaves of `trees`, by number, and form factors, in the order of leaves.
    pub fn look(
        &self,
        targets: &Targets,
        trees: &Trees,
        point: DVec3,
        normal: DVec3,
        execution: &Execution,
    ) -> Result<Vec<(u32, f64)>, Limit> {
        // Turned, lest edges along the axes pass through the middles of a whole row of pixels.
        let ((u, v), (sin, cos)) = (normal.any_orthonormal_pair(), func::sin_cos(TURN));
        let (u, v) = (u * cos + v * sin, v * cos - u * sin);
        // Points look from different threads: each draws alone.
        let execution = Execution { workers: Workers::single(), observer: None, ..execution.clone() };
        let mut seen = vec![0.0; targets.leaves];
        for (face, [towards, up]) in
            [[normal, u], [u, normal], [-u, normal], [v, normal], [-v, normal]].into_iter().enumerate()
        {
            let camera = Camera {
                position: point,
                focal_point: point + towards,
                view_up: up,
                projection: Projection::Perspective { view_angle: FRAC_PI_2 },
                clip: Some(self.clip),
            };
            self.face((targets, trees), &camera, &self.factors[usize::from(face > 0)], &execution, &mut seen)?;
        }
        Ok((0..).zip(seen).filter(|(_, factor)| *factor > 0.0).collect())
    }

    fn face(
        &self,
        (targets, trees): (&Targets, &Trees),
        camera: &Camera,
        factors: &[f64],
        execution: &Execution,
        seen: &mut Vec<f64>,
    ) -> Result<(), Limit> {
        let side = self.settings.width;
        let viewport = Viewport { width: side, height: side };
        let (pattern, counters) = (SamplePattern::new(1), &mut CullCounters::default());
        let view = PreparedView::new(&targets.session, camera, &self.settings, viewport, pattern, execution, counters);
        let mut grid = TileGrid::new(viewport, 1);
        let (eye, forward, up) = (camera.position, camera.focal_point - camera.position, camera.view_up);
        let axes = [forward.cross(up), up, forward];
        let seen_here = Mutex::new(std::mem::take(seen));
        let sink = Collector { factors, side: side as usize, targets, trees, eye, axes, seen: seen_here };
        ZBuffer.resolve(&view, None, &mut grid, execution, &sink)?;
        *seen = sink.seen.into_inner().expect("no thread panics while it collects");
        Ok(())
    }
}

/// What hemicubes look at: facets, each the root of a quadtree.
#[derive(Debug)]
pub struct Targets {
    /// The facets as a scene of their own.
    session: Session,
    /// The root of each of the scene's facets.
    roots: Vec<u32>,
    /// The number of each node that is a leaf.
    numbers: Vec<u32>,
    leaves: usize,
}

impl Targets {
    /// The leaves of `trees`, in their order.
    pub fn new(trees: &Trees) -> Self {
        let roots: Vec<u32> = trees.roots.iter().copied().filter(|&root| root != NONE).collect();
        let mut numbers = vec![NONE; trees.nodes.len()];
        let leaves = trees.leaves();
        (0..).zip(&leaves).for_each(|(number, &leaf)| numbers[leaf as usize] = number);
        let positions = roots.iter().flat_map(|&root| trees.places(root)).map(|v| v.as_vec3().to_array()).collect();
        let triangles: Vec<_> = (0..roots.len() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
        let parts = vec![Part { name: String::new(), triangles: 0..roots.len() as u32, material: None }];
        let mesh = Mesh { positions, triangles, parts, ..Mesh::default() };
        let session = Session::new(Arc::new(Scene::from_mesh(mesh))).expect("a mesh of its own triangles is sound");
        Self { session, roots, numbers, leaves: leaves.len() }
    }
}

/// Adds up the factors of the pixels that show each leaf.
struct Collector<'a> {
    factors: &'a [f64],
    side: usize,
    targets: &'a Targets,
    trees: &'a Trees,
    eye: DVec3,
    /// Right, up, forward.
    axes: [DVec3; 3],
    /// A sum for each leaf.
    seen: Mutex<Vec<f64>>,
}

impl Collector<'_> {
    /// Adds the factors of neighbours in a row, from this column on, that show one facet.
    fn add(&self, facet: u32, [column, row]: [usize; 2], factors: &[f64], seen: &mut [f64]) {
        let (root, trees) = (self.targets.roots[facet as usize], self.trees);
        if trees.nodes[root as usize].children == NONE {
            seen[self.targets.numbers[root as usize] as usize] += factors.iter().sum::<f64>();
            return;
        }
        // A ray's direction is a sum of the corners as seen from the eye, with these weights times some number. Along a
        // row they change evenly, and so do the weights within any node.
        let [a, b, c] = trees.places(root).map(|corner| corner - self.eye);
        let (step, [right, up, forward]) = (2.0 / self.side as f64, self.axes);
        let at = |i: usize| (i as f64 + 0.5) * step - 1.0;
        let first = forward + right * at(column) - up * at(row);
        let edges = [b.cross(c), c.cross(a), a.cross(b)];
        let (mut start, mut slopes) = (edges.map(|n| n.dot(first)), edges.map(|n| n.dot(right) * step));
        if start.iter().sum::<f64>() < 0.0 {
            (start, slopes) = (start.map(|w| -w), slopes.map(|w| -w));
        }
        let mut done = 0;
        while done < factors.len() {
            let here = [0, 1, 2].map(|k| start[k] + done as f64 * slopes[k]);
            let (leaf, weights, slopes) = trees.leaf_along(root, here, slopes);
            // As far as no weight falls below 0.
            let ends = (0..3).filter(|&k| slopes[k] < 0.0).map(|k| weights[k] / -slopes[k]);
            let length = ends.fold(f64::INFINITY, f64::min).max(0.0) as usize;
            let next = done.saturating_add(length).saturating_add(1).min(factors.len());
            seen[self.targets.numbers[leaf as usize] as usize] += factors[done..next].iter().sum::<f64>();
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
            let at = (top + row) * self.side + left;
            let Some(factors) = self.factors.get(at..at + columns) else { break };
            let mut column = 0;
            for run in tile.facet[row * TILE..row * TILE + columns].chunk_by(|a, b| a == b) {
                if run[0] != NO_FACET {
                    let place = [left + column, top + row];
                    self.add(run[0], place, &factors[column..column + run.len()], &mut seen);
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
            Some(if f == 0 { [corners[0], corners[1], corners[2]] } else { [corners[0], corners[2], corners[3]] })
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
            let seen = hemicube.look(&targets, trees, point, DVec3::Z, &execution).unwrap();
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
        let (point, trees) = (dvec3(0.2, 0.35, 0.0), square(DVec3::Z * 0.5, DVec3::Y, DVec3::X, 0.4));
        let hemicube = Hemicube::new(512, 2.0);
        let seen = hemicube.look(&Targets::new(&trees), &trees, point, DVec3::Z, &Execution::default()).unwrap();
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
    fn all_pixels_together_are_one() {
        for side in [2, 64, 130] {
            let hemicube = Hemicube::new(side, 1.0);
            let sum: f64 = hemicube.factors[0].iter().sum::<f64>() + 4.0 * hemicube.factors[1].iter().sum::<f64>();
            assert!((sum - 1.0).abs() < 1e-12);
        }
    }
}
