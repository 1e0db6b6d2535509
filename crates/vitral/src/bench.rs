//! Every visible-surface algorithm on one view: time, memory, counters, and whether it sees what
//! the z-buffer sees.
//!
//! What is measured is finding the surface of each sample (culling, preparing, the algorithm),
//! without shading. The first picture also builds what outlives a frame (a BSP tree, boxes round
//! triangles); the median is that of the ones after it. Memory is what the algorithm charged to its
//! budget at the most: its own lists, trees and facets, not the picture's tiles, which all have.
//! The z-buffer keeps nothing that grows with the model beyond one round of triangles, which it
//! does not charge.

use std::collections::BTreeSet;
use std::sync::Arc;
use vitral_exec::Limit;
use vitral_raster::{NO_FACET, SamplePattern, TILE_PIXELS, TileGrid, Viewport};
use vitral_render::registry::{VISIBILITY, VisibilityAlgorithm};
use vitral_render::stats::{CullCounters, GeometryStats, VisibilityCounters};
use vitral_render::visible::NullSink;
use vitral_render::{
    Acceleration, Channels, Error, Execution, PreparedView, Session, Settings, TransparencyOrder,
    Visibility,
};
use vitral_scene::{Camera, Scene};

/// An algorithm of the registry, and for rays the structure.
#[derive(Clone, Copy)]
pub struct Entrant {
    /// The algorithm of visible surfaces that is measured.
    pub algorithm: &'static VisibilityAlgorithm,
    /// The structure, where it casts rays.
    pub acceleration: Option<Acceleration>,
}

impl std::fmt::Debug for Entrant {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.name())
    }
}

impl Entrant {
    /// All algorithms; those that cast rays once for each structure that is made for many
    /// triangles. The z-buffer comes first.
    pub fn all() -> Vec<Self> {
        let structures: Vec<_> = Acceleration::all().filter(|a| a.grows_slowly).map(Some).collect();
        let of = |algorithm: &'static VisibilityAlgorithm| {
            let choices = if algorithm.casts_rays { structures.clone() } else { vec![None] };
            choices.into_iter().map(move |acceleration| Self { algorithm, acceleration })
        };
        VISIBILITY.iter().flat_map(of).collect()
    }

    /// These settings with the algorithm. It decides about opaque surfaces, since not every one has
    /// all orders of transparent ones.
    pub(crate) fn settings(&self, settings: &Settings) -> Settings {
        let mut settings = Settings {
            visibility: self.algorithm.choice(),
            acceleration: self.acceleration,
            ..settings.clone()
        };
        settings.transparency.order = TransparencyOrder::default();
        settings.depth_bits =
            settings.depth_bits.filter(|_| settings.visibility == Visibility::Z_BUFFER);
        settings.picture.channels =
            Channels { passes: false, buffers: false, ..settings.picture.channels };
        settings
    }

    /// The algorithm's name, with the structure.
    pub fn name(&self) -> String {
        match self.acceleration {
            Some(structure) => format!("{} ({structure})", self.algorithm.name),
            None => self.algorithm.name.to_owned(),
        }
    }
}

/// What is to be measured.
#[derive(Clone, Copy, Debug)]
pub struct Task<'a> {
    /// The scene that is rendered.
    pub scene: &'a Arc<Scene>,
    /// The viewer.
    pub camera: &'a Camera,
    /// Size, samples, culling.
    pub settings: &'a Settings,
    /// Pictures at most.
    pub frames: usize,
    /// Seconds that an algorithm may take for all its pictures.
    pub time_limit: Option<f64>,
    /// Bytes that an algorithm may charge.
    pub memory_limit: Option<u64>,
}

/// What an algorithm took.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Seconds of the first picture, with whatever is built once.
    pub first_seconds: f64,
    /// Median of the seconds of the pictures after it; the first one's where there is no other.
    pub median_seconds: f64,
    /// The least seconds of any of these pictures: what other processes add is the least here.
    pub fastest_seconds: f64,
    /// Pictures that were finished.
    pub frames: usize,
    /// Bytes charged at one time, at the most.
    pub bytes: u64,
    /// Triangles on their way to the screen.
    pub geometry: GeometryStats,
    /// Counters of the first picture.
    pub counters: VisibilityCounters,
    /// What is seen.
    pub seen: VisibilityDigest,
}

/// What is seen at each sample of the picture: facets and depths, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct VisibilityDigest {
    facets: Vec<u32>,
    depths: Vec<f32>,
}

impl VisibilityDigest {
    /// The facets that are seen at some sample.
    pub fn visible_facets(&self) -> BTreeSet<u32> {
        self.facets.iter().copied().filter(|&facet| facet != NO_FACET).collect()
    }

    fn of(grid: &TileGrid, viewport: Viewport, samples: usize) -> Self {
        // Some algorithms fill tiles beyond the border of the picture, others do not.
        let pixels = || {
            (0..viewport.height).flat_map(|y| (0..viewport.width).map(move |x| grid.locate(x, y)))
        };
        let places = || {
            pixels().flat_map(|(tile, at)| (0..samples).map(move |s| (tile, s * TILE_PIXELS + at)))
        };
        let (facets, depths) = places().map(|(tile, at)| (tile.facet[at], tile.depth[at])).unzip();
        Self { facets, depths }
    }

    /// Samples where the facet or the depth is another.
    pub fn differing(&self, other: &Self) -> u64 {
        let pairs = |s: &Self, i: usize| (s.facets[i], s.depths[i].to_bits());
        (0..self.facets.len().min(other.facets.len()))
            .filter(|&i| pairs(self, i) != pairs(other, i))
            .count() as u64
    }
}

/// Measures one algorithm, with a session of its own. The outer error is one of the task, the inner
/// one the limit at which the algorithm gave up before its first picture was finished.
///
/// # Errors
/// Settings or a scene that cannot be.
pub fn measure(
    task: &Task<'_>,
    entrant: &Entrant,
    execution: &Execution,
) -> Result<Result<Measured, Limit>, Error> {
    // Set up a session and a budget for this algorithm alone.
    let settings = entrant.settings(task.settings);
    let viewport = settings.check()?;
    let session = Session::with_workers(Arc::clone(task.scene), &execution.workers)?;
    let budget = execution
        .budget
        .renewed()
        .with_time_limit(task.time_limit)
        .with_memory_limit(task.memory_limit);
    let execution = Execution { budget, ..execution.clone() };

    // Resolve and time one picture a call.
    let samples = settings.picture.samples as usize;
    let mut grid = TileGrid::new(viewport, samples);
    let picture = |grid: &mut TileGrid| -> Result<_, Limit> {
        let start = execution.budget.elapsed();
        let pattern = SamplePattern::new(samples);
        let culled = &mut CullCounters::default();
        let view = PreparedView::new(
            &session,
            task.camera,
            &settings,
            viewport,
            pattern,
            &execution,
            culled,
        );
        let resolved =
            entrant.algorithm.algorithm.resolve(&view, None, grid, &execution, &NullSink)?;
        Ok((execution.budget.elapsed() - start, resolved))
    };

    // Time the first picture, with all that is built once.
    let (first_seconds, resolved) = match picture(&mut grid) {
        Ok(first) => first,
        Err(limit) => return Ok(Err(limit)),
    };

    // Digest what is visible, then time the remaining pictures.
    let seen = VisibilityDigest::of(&grid, viewport, samples);
    let mut seconds = Vec::new();
    while seconds.len() + 1 < task.frames {
        // A limit here means fewer pictures, no failure.
        let Ok((more, _)) = picture(&mut grid) else { break };
        seconds.push(more);
    }

    // Report the times, the memory and the counters.
    Ok(Ok(Measured {
        first_seconds,
        fastest_seconds: seconds.iter().copied().reduce(f64::min).unwrap_or(first_seconds),
        median_seconds: median(&mut seconds).unwrap_or(first_seconds),
        frames: seconds.len() + 1,
        bytes: execution.budget.peak(),
        geometry: resolved.geometry,
        counters: resolved.counters,
        seen,
    }))
}

/// The middle value.
fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => None,
        n if n % 2 == 1 => Some(values[middle]),
        _ => Some((values[middle - 1] + values[middle]) / 2.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Renderer, execution, load_builtin};
    use vitral_math::DVec3;

    #[test]
    fn p25_every_algorithm_is_measured_and_agrees() {
        let mut renderer = Renderer::new(load_builtin("cubs").unwrap()).unwrap();
        (
            renderer.settings.picture.width,
            renderer.settings.picture.height,
            renderer.settings.picture.samples,
        ) = (48, 36, 1);
        // The nearest cubes reach beyond the lower border.
        let camera = Camera::look_at(DVec3::new(3.0, 3.0, 3.0), DVec3::ZERO);
        let execution = execution(1);
        let (scene, settings) = (renderer.scene(), &renderer.settings);
        let task = Task {
            scene,
            camera: &camera,
            settings,
            frames: 2,
            time_limit: None,
            memory_limit: None,
        };
        let all = Entrant::all();
        let measured: Vec<_> =
            all.iter().map(|e| measure(&task, e, &execution).unwrap().unwrap()).collect();
        assert!(measured[0].seen.facets.iter().any(|&f| f != u32::MAX), "something is seen");
        for (entrant, m) in all.iter().zip(&measured) {
            assert_eq!(
                (m.seen.differing(&measured[0].seen), m.frames),
                (0, 2),
                "{}",
                entrant.name()
            );
            assert!(m.bytes > 0 || entrant.algorithm.name == "z-buffer", "{}", entrant.name());
        }
        let other = VisibilityDigest { facets: vec![0; 9], depths: vec![0.5; 9] };
        let shifted = VisibilityDigest { facets: vec![0; 9], depths: vec![0.25; 9] };
        assert_eq!(other.differing(&shifted), 9);
    }

    #[test]
    fn an_algorithm_at_its_limit_says_which() {
        let renderer = Renderer::new(load_builtin("cubs").unwrap()).unwrap();
        let (camera, execution) = (renderer.frame_camera(), execution(1));
        let (scene, settings) = (renderer.scene(), &renderer.settings);
        let task = Task {
            scene,
            camera: &camera,
            settings,
            frames: 2,
            time_limit: Some(0.0),
            memory_limit: None,
        };
        let first = measure(&task, &Entrant::all()[0], &execution).unwrap();
        assert!(matches!(first, Err(Limit::Time { .. })));
    }

    #[test]
    fn medians() {
        assert_eq!(
            [median(&mut []), median(&mut [3.0, 1.0, 2.0]), median(&mut [4.0, 1.0])],
            [None, Some(2.0), Some(2.5)]
        );
    }
}
