//! Depths round a pixel at a step of an algorithm that compares them sample by sample: before the
//! facet of the step, and after.
//!
//! Source: the course, notes P, the z-buffer.

use crate::steps::Recording;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use vitral::explain::{FacetDepth, facets_over};
use vitral::internals::render::trace::Step;
use vitral::{Error, Visibility};

/// Pixels along the square.
const SIZE: u32 = 9;

/// For the z-buffer what a square of pixels holds before and after the step, for brute force what
/// the pixel is compared with; `null` for other algorithms.
pub(crate) fn depths(recording: &Recording, at: usize, pixel: [u32; 2]) -> Result<Value, Error> {
    let renderer = &recording.renderer;
    let camera = renderer.frame_camera();
    let visibility = renderer.settings.visibility;
    if visibility == Visibility::BRUTE_FORCE {
        let facets = facets_over(renderer, &camera, pixel.map(i64::from), 1)?;
        let told =
            facets[0].iter().map(|found| json!({"facet": found.facet, "depth": found.depth}));
        return Ok(json!({"facets": told.collect::<Vec<_>>()}));
    }
    if visibility != Visibility::Z_BUFFER {
        return Ok(Value::Null);
    }

    // Find out which facets came before which.
    let steps = recording.watched.steps.iter().enumerate();
    let came: BTreeMap<u32, usize> =
        steps.filter_map(|(place, told)| Some((drawn(&told.step)?, place))).collect();
    let corner = pixel.map(|place| i64::from(place) - i64::from(SIZE / 2));
    let facets = facets_over(renderer, &camera, corner, SIZE)?;
    let nearest = |limit: usize| -> Vec<f32> {
        let there = |found: &&FacetDepth| came.get(&found.facet).is_some_and(|step| *step < limit);
        facets.iter().map(|over| over.iter().find(there).map_or(0.0, |found| found.depth)).collect()
    };
    Ok(
        json!({"x": corner[0], "y": corner[1], "size": SIZE, "before": nearest(at), "after": nearest(at + 1)}),
    )
}

/// The facet that a step drew.
fn drawn(step: &Step) -> Option<u32> {
    match step {
        Step::Drawn { facet, .. } => Some(*facet),
        _ => None,
    }
}
