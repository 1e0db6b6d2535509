//! A structure over the world's triangles, and what each of them is on the screen of a view.
//!
//! In:   a view's set-up triangles and a structure. Out: [`Cast`], which visitors of the structure
//!       look triangles up in.
//! Cost: linear in triangles and parts of the structure.

use super::eye::{DEPTH_ROUNDING, Eye};
use crate::raytrace::Structure;
use crate::trace::Passed;
use crate::visible::screen_setups::ScreenSetups;
use crate::{Execution, PreparedView};
use std::collections::HashSet;
use std::sync::Mutex;
use vitral_raster::Setup;

/// Triangles whose places are listed at once.
const CHUNK: usize = 16384;
/// No setup: nothing of this triangle is on the screen.
pub(super) const NONE: u32 = u32::MAX;

/// A structure, what its triangles are in this view, and the eye.
pub(super) struct Cast<'a, T> {
    pub(super) view: &'a PreparedView<'a>,
    pub(super) execution: &'a Execution,
    pub(super) structure: &'a T,
    pub(super) on_screen: ScreenSetups,
    /// What each triangle of the structure is on the screen.
    pub(super) triangles: Vec<ScreenTriangle>,
    /// For each part how wrong the depth of an opaque facet in it may be, then the same for layers;
    /// -∞ if there is none in it. No list of layers if there are none at all.
    pub(super) slack: [Vec<f32>; 2],
    pub(super) largest_slack: f32,
    pub(super) eye: Eye,
    /// Lists to reuse.
    stamps: Mutex<Vec<Stamps>>,
}

impl<'a, T: Structure> Cast<'a, T> {
    pub(super) fn new(
        view: &'a PreparedView<'a>,
        execution: &'a Execution,
        structure: &'a T,
        on_screen: ScreenSetups,
    ) -> Self {
        // Find each facet's setups, and how wrong their depths may be.
        let mut of_facet = vec![ScreenTriangle::ABSENT; view.session.world.facet_count as usize];
        let mut start = 0;
        for &(end, clipped) in &on_screen.runs {
            for (i, setup) in on_screen.setups[start..end].iter().enumerate() {
                of_facet[setup.facet as usize].add((start + i) as u32, setup, clipped);
            }
            start = end;
        }

        // Bring these to the order of the structure's triangles.
        let facets = &structure.triangles().facets;
        let mut triangles = vec![ScreenTriangle::ABSENT; facets.len()];
        execution.workers.for_each_chunk(&mut triangles, CHUNK, |chunk, triangles| {
            for (triangle, &f) in triangles.iter_mut().zip(&facets[chunk * CHUNK..]) {
                *triangle = of_facet[f as usize];
            }
        });

        // Bound that for each part of the structure.
        let opaque = on_screen.opaque as u32;
        let slack_of = |place: usize, layered: bool| {
            let triangle = &triangles[place];
            if (triangle.setups[0] >= opaque) == layered {
                triangle.slack
            } else {
                f32::NEG_INFINITY
            }
        };

        // Keep bounds for opaque and transparent triangles apart.
        let any_layered = on_screen.opaque < on_screen.setups.len();
        let slack = [
            structure.largest(&|place| slack_of(place, false)),
            if any_layered {
                structure.largest(&|place| slack_of(place, true))
            } else {
                Vec::new()
            },
        ];
        let largest_slack = slack.iter().flatten().copied().fold(f32::NEG_INFINITY, f32::max);
        let eye = Eye::new(view, structure.triangles());
        Self {
            view,
            execution,
            structure,
            on_screen,
            triangles,
            slack,
            largest_slack,
            eye,
            stamps: Mutex::default(),
        }
    }

    /// A facet's setups.
    #[inline(always)]
    pub(super) fn setups(&self, [first, end]: [u32; 2]) -> &[Setup] {
        &self.on_screen.setups[first as usize..end as usize]
    }

    /// Whether these are setups of a facet that becomes a layer.
    #[inline(always)]
    pub(super) fn is_layered(&self, [first, _]: [u32; 2]) -> bool {
        first as usize >= self.on_screen.opaque
    }

    pub(super) fn take_stamps(&self) -> Stamps {
        let spare = self.stamps.lock().expect("no thread panics while it holds stamps").pop();
        spare.unwrap_or_else(|| Stamps::new(if T::REPEATS { self.triangles.len() } else { 0 }))
    }

    pub(super) fn give_stamps(&self, stamps: Stamps) {
        self.stamps.lock().expect("no thread panics while it holds stamps").push(stamps);
    }
}

/// Names what rays went through, each part once, and empties the list.
pub(super) fn names(structure: &impl Structure, passed: &mut Vec<u32>) -> Passed {
    let mut seen = HashSet::new();
    passed.retain(|part| seen.insert(*part));
    let names = structure.names(passed);
    passed.clear();
    names
}

/// What a triangle is on the screen: little enough to be looked at before its setups are.
#[derive(Clone, Copy, Debug)]
pub(super) struct ScreenTriangle {
    /// The first setup and the one behind the last, or `NONE`.
    pub(super) setups: [u32; 2],
    /// Left and right pixel column, top and bottom row, of the box round them.
    pub(super) columns: [i16; 2],
    pub(super) rows: [i16; 2],
    /// The nearest depth.
    pub(super) nearest: f32,
    /// How wrong depths may be, -∞ where there are none.
    pub(super) slack: f32,
}

impl ScreenTriangle {
    const ABSENT: Self = Self {
        setups: [NONE; 2],
        columns: [i16::MAX, i16::MIN],
        rows: [i16::MAX, i16::MIN],
        nearest: 0.0,
        slack: f32::NEG_INFINITY,
    };

    /// Adds the setup of this number, which is the first or the one behind those before it.
    fn add(&mut self, number: u32, setup: &Setup, clipped: bool) {
        self.setups = [self.setups[0].min(number), number + 1];
        // Setups lie within the guard band, which 16 bits can hold.
        let pixel = |v: i32| (v >> 8).clamp(i32::from(i16::MIN), i32::from(i16::MAX)) as i16;
        for (range, v) in [(&mut self.columns, &setup.x), (&mut self.rows, &setup.y)] {
            let (low, high) = (v[0].min(v[1]).min(v[2]), v[0].max(v[1]).max(v[2]));
            *range = [range[0].min(pixel(low)), range[1].max(pixel(high))];
        }
        self.nearest = self.nearest.max(setup.z_max);
        self.slack = self.slack.max(depth_slack(setup, clipped));
    }
}

/// How many setups were tested, and of which facets, if somebody wants to know.
#[derive(Default)]
pub(super) struct Tests {
    pub(super) count: u64,
    pub(super) facets: Option<Vec<u32>>,
}

impl Tests {
    /// None so far; facets are noted for an observer.
    pub(super) fn new(execution: &Execution) -> Self {
        Self { count: 0, facets: execution.observer.is_some().then(Vec::new) }
    }

    #[inline(always)]
    pub(super) fn add(&mut self, facet: u32) {
        self.count += 1;
        if let Some(facets) = &mut self.facets {
            facets.push(facet);
        }
    }

    /// The facets noted since the last call.
    pub(super) fn take(&mut self) -> Vec<u32> {
        self.facets.as_mut().map(std::mem::take).unwrap_or_default()
    }
}

/// Who was already asked: a structure may show a triangle to the same ray several times.
pub(super) struct Stamps {
    seen: Vec<u32>,
    now: u32,
}

impl Stamps {
    fn new(count: usize) -> Self {
        Self { seen: vec![0; count], now: 0 }
    }

    /// Begins another ray.
    #[inline(always)]
    pub(super) fn next(&mut self) {
        self.now = self.now.wrapping_add(1);
        if self.now == 0 {
            self.seen.fill(0);
            self.now = 1;
        }
    }

    /// Whether the triangle at `place` has not been asked since [`Self::next`].
    #[inline(always)]
    pub(super) fn first_time(&mut self, place: usize) -> bool {
        std::mem::replace(&mut self.seen[place], self.now) != self.now
    }
}

/// By how much `Setup::depth` can differ from the exact interpolation of the corners' depths:
/// rounding grows with the square of the length over the area, but not beyond the range that depths
/// are clamped to.
fn depth_slack(setup: &Setup, clipped: bool) -> f32 {
    let range = setup.z_max - setup.z_min + setup.z_max * DEPTH_ROUNDING;
    if clipped {
        return range;
    }
    let extent = |v: &[i32; 3]| (v[0].max(v[1]).max(v[2]) - v[0].min(v[1]).min(v[2])) as f32;
    let (dx, dy) = (extent(&setup.x), extent(&setup.y));
    let [x, y] = [&setup.x, &setup.y].map(|v| [v[1] - v[0], v[2] - v[0]].map(i64::from));
    let area = (x[0] * y[1] - x[1] * y[0]) as f32;
    range.min(DEPTH_ROUNDING * (range * (dx * dx + dy * dy) / area + setup.z_max))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stamps_tell_the_first_time() {
        let mut stamps = Stamps::new(2);
        stamps.now = u32::MAX - 1;
        for _ in 0..3 {
            stamps.next();
            assert!(stamps.first_time(1) && !stamps.first_time(1) && stamps.first_time(0));
        }
    }
}
