//! A soft shadow on the ground: darkest where a model touches it, and faded out a little way off.
//!
//! It is the ambient occlusion of the ground ([`super::ambient_occlusion`]), which does not depend
//! on where lights or viewers are. A picture would show the noise of few rays on an even ground, so
//! the shadow is computed on a grid over the model's footprint, once for a scene: sixteen sets of
//! directions alternate from cell to cell, and each value is the mean of the sixteen cells round
//! it, so that few rays a cell are many a value. Between values the shadow is interpolated.
//!
//! In:   a scene, which way is up. Out: the part of light that is kept away from a place of the
//!       ground.
//! Cost: a million and a half short rays for a square footprint, whatever the picture's size; a
//!       lookup afterwards.
//! Source: \[Keller & Heidrich 2001\] for sets of samples that alternate.

use super::ambient_occlusion::{AmbientOcclusion, RADIUS};
use super::hash::hash;
use super::places::{SurfacePoint, SurfacePoints};
use crate::{Cached, Execution, Session, Settings, Transparency};
use std::sync::Arc;
use vitral_exec::Limit;
use vitral_math::{DVec2, DVec3, dvec2};
use vitral_scene::Axis;

/// Cells along the longer side of the grid: about three pixels of a picture of 1024 columns each.
const CELLS: f64 = 256.0;
/// Rays of a cell.
const RAYS: u32 = 24;
/// Cells along a side of the square whose mean is a value; as many sets of directions as it has
/// cells.
const MIXED: usize = 4;
/// The part of the occlusion that shows: grounds are lit from below as well, and black is ugly.
const STRENGTH: f32 = 0.8;

/// See the module.
pub(super) struct ContactShadow {
    /// Unit vectors along the grid's axes.
    axes: [DVec3; 2],
    /// The first value's place on them, from the scene's middle.
    first: DVec2,
    cell: f64,
    columns: usize,
    rows: usize,
    dark: Vec<f32>,
}

impl Cached for ContactShadow {
    type Key = (Axis, Transparency);
}

impl ContactShadow {
    /// The shadow of a scene whose corners lie between `least` and `most` along `axes`, on the
    /// ground at this height.
    ///
    /// # Errors
    /// A limit of the budget.
    pub(super) fn of(
        session: &Session,
        (settings, execution): (&Settings, &Execution),
        up: Axis,
        height: f64,
        (axes, least, most): ([DVec3; 2], DVec2, DVec2),
    ) -> Result<Arc<Self>, Limit> {
        let key = (up, settings.transparency.model);
        session.cache.get_or_build(key, || {
            // Lay a grid over the model's footprint, with a margin as wide as the shadow's radius.
            let radius = RADIUS * session.world.bounds.bounding_sphere().radius;
            let cell = ((most - least).max_element() + 2.0 * radius) / CELLS;
            let margin = DVec2::splat(radius + MIXED as f64 * cell);
            let (start, size) = (least - margin, most - least + 2.0 * margin);
            let [columns, rows] = size.to_array().map(|length| (length / cell).ceil() as usize);
            let rays = (columns * rows) as u64 * u64::from(RAYS);
            let occlusion =
                AmbientOcclusion::with(session, (settings, execution), (RAYS, radius), rays)?;

            // Find how open each cell is.
            let place = |column: usize, row: usize| {
                let at = start + dvec2(column as f64 + 0.5, row as f64 + 0.5) * cell;
                SurfacePoint {
                    position: axes[0] * at.x + axes[1] * at.y + up.vector() * height,
                    normal: up.vector(),
                    facet: u32::MAX,
                    seed: hash((row % MIXED * MIXED + column % MIXED) as u32),
                    pixel: None,
                }
            };
            let row = |row: usize| {
                execution.budget.check("the shadow on the ground")?;
                let places: SurfacePoints = (0..columns).map(|column| place(column, row)).collect();
                Ok(occlusion.open(&places, &mut 0))
            };
            let open =
                execution.workers.map(rows, row).into_iter().collect::<Result<Vec<_>, Limit>>()?;

            // Mix neighbours.
            let [across, down] = [columns, rows].map(|count| count + 1 - MIXED);
            let mixed = |i: usize| {
                let (column, row) = (i % across, i / across);
                let sum: f32 = open[row..row + MIXED]
                    .iter()
                    .flat_map(|row| &row[column..column + MIXED])
                    .sum();
                STRENGTH * (1.0 - sum / (MIXED * MIXED) as f32).max(0.0)
            };
            let dark = (0..across * down).map(mixed).collect();
            let first = start + DVec2::splat(0.5 * MIXED as f64 * cell);
            Ok(Self { axes, first, cell, columns: across, rows: down, dark })
        })
    }

    /// The part of light that is kept away from a place.
    pub(super) fn at(&self, position: DVec3) -> f32 {
        let [x, y] = self.axes.map(|axis| axis.dot(position));
        let on_grid = (dvec2(x, y) - self.first) / self.cell;
        let (inside, last) = (on_grid.floor(), dvec2(self.columns as f64, self.rows as f64) - 1.0);
        if !(inside.cmpge(DVec2::ZERO).all() && inside.cmplt(last).all()) {
            return 0.0;
        }
        let ([x, y], (column, row)) =
            ((on_grid - inside).as_vec2().to_array(), (inside.x as usize, inside.y as usize));
        let along = |row: usize| {
            let [a, b] = [0, 1].map(|next| self.dark[row * self.columns + column + next]);
            a + (b - a) * x
        };
        let (upper, lower) = (along(row), along(row + 1));
        upper + (lower - upper) * y
    }
}
