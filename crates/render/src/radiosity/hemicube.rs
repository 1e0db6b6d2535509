//! The hemicube: form factors from a point to everything it sees.
//!
//! Half a cube stands on the point, its five faces cut into pixels. What is seen through a pixel is found by the
//! z-buffer, the renderer's own; the form factor of the pixel is known beforehand,
//! `ΔF = ΔA / (π (x² + y² + 1)²)` on the top and `z ΔA / (π (y² + z² + 1)²)` on a side. The factor to an element is the sum
//! over the pixels that show it. The factors of all pixels are scaled to the sum 1, so that no light is lost or made.
//!
//! In:   elements as a scene of their own, a facet each (world space); point and normal. Out: elements and factors.
//! Cost: five small pictures of the scene.
//! Source: \[Cohen & Greenberg 1985\]. Departs from it: sides are drawn whole, their lower halves unused.

use crate::stats::CullCounters;
use crate::visible::{TileSink, VisibleSurface, zbuffer::ZBuffer};
use crate::{Execution, PreparedView, Session, Settings};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Mutex;
use vitral_exec::{Limit, Workers};
use vitral_math::DVec3;
use vitral_raster::{LayerList, NO_FACET, SamplePattern, TILE, Tile, TileGrid, Viewport};
use vitral_scene::{Camera, Projection};

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

    /// What a point with unit normal sees: facets and form factors, in the order of facets.
    pub fn look(
        &self,
        session: &Session,
        point: DVec3,
        normal: DVec3,
        execution: &Execution,
    ) -> Result<Vec<(u32, f64)>, Limit> {
        let (u, v) = normal.any_orthonormal_pair();
        // Points look from different threads: each draws alone.
        let execution = Execution { workers: Workers::single(), observer: None, ..execution.clone() };
        let mut seen = vec![0.0; session.world.facet_count as usize];
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
            self.face(session, &camera, &self.factors[usize::from(face > 0)], &execution, &mut seen)?;
        }
        Ok((0..).zip(seen).filter(|(_, factor)| *factor > 0.0).collect())
    }

    fn face(
        &self,
        session: &Session,
        camera: &Camera,
        factors: &[f64],
        execution: &Execution,
        seen: &mut Vec<f64>,
    ) -> Result<(), Limit> {
        let side = self.settings.width;
        let viewport = Viewport { width: side, height: side };
        let (pattern, counters) = (SamplePattern::new(1), &mut CullCounters::default());
        let view = PreparedView::new(session, camera, &self.settings, viewport, pattern, execution, counters);
        let mut grid = TileGrid::new(viewport, 1);
        let sink = Collector { factors, side: side as usize, seen: Mutex::new(std::mem::take(seen)) };
        ZBuffer.resolve(&view, None, &mut grid, execution, &sink)?;
        *seen = sink.seen.into_inner().expect("no thread panics while it collects");
        Ok(())
    }
}

/// Adds up the factors of the pixels that show each facet.
struct Collector<'a> {
    factors: &'a [f64],
    side: usize,
    /// A sum for each facet.
    seen: Mutex<Vec<f64>>,
}

impl TileSink for Collector<'_> {
    fn tile(&self, _: usize, tile: &Tile, _: &mut LayerList) {
        let mut seen = self.seen.lock().expect("no thread panics while it collects");
        let mut put = |(facet, sum): (u32, f64)| {
            if facet != NO_FACET {
                seen[facet as usize] += sum;
            }
        };
        let (left, top) = (tile.x as usize, tile.y as usize);
        let (columns, rows) = (TILE.min(self.side - left), TILE.min(self.side - top));
        // Pixels of one facet mostly come in runs.
        let mut run = (NO_FACET, 0.0);
        for row in 0..rows {
            let at = (top + row) * self.side + left;
            let Some(factors) = self.factors.get(at..at + columns) else { break };
            for (&facet, &factor) in tile.facet[row * TILE..].iter().zip(factors) {
                if facet != run.0 {
                    put(std::mem::replace(&mut run, (facet, 0.0)));
                }
                run.1 += factor;
            }
        }
        put(run);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use vitral_math::dvec3;
    use vitral_scene::{Mesh, Part, Scene};

    /// A square from corner along two directions, as a scene.
    fn square(corner: DVec3, u: DVec3, v: DVec3) -> Session {
        let corners = [corner, corner + u, corner + u + v, corner + v];
        let mesh = Mesh {
            positions: corners.map(|c| c.as_vec3().to_array()).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            parts: vec![Part { name: String::new(), triangles: 0..2, material: None }],
            ..Mesh::default()
        };
        Session::new(Arc::new(Scene::from_mesh(mesh))).unwrap()
    }

    /// The mean over points of the unit square in the plane z = 0.
    fn mean(session: &Session, steps: u32) -> f64 {
        let hemicube = Hemicube::new(256, 2.0);
        let execution = Execution::default();
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(steps);
        let points = execution.workers.map((steps * steps) as usize, |i| {
            let point = dvec3(at(i as u32 % steps), at(i as u32 / steps), 0.0);
            let seen = hemicube.look(session, point, DVec3::Z, &execution).unwrap();
            seen.iter().map(|(_, f)| f).sum::<f64>()
        });
        points.iter().sum::<f64>() / f64::from(steps * steps)
    }

    #[test]
    fn squares_have_the_factors_of_the_handbooks() {
        let parallel = mean(&square(DVec3::Z, DVec3::Y, DVec3::X), 12);
        assert!((parallel - 0.199_824_895_7).abs() < 1e-3, "{parallel}");
        let perpendicular = mean(&square(DVec3::ZERO, DVec3::Y, DVec3::Z), 24);
        assert!((perpendicular - 0.200_043_776_1).abs() < 1e-3, "{perpendicular}");
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
