//! Depths round a pixel at a step of an algorithm that compares them sample by sample: before the
//! facet of the step, and after.
//!
//! Source: the course, notes P, the z-buffer.

use crate::steps::Recording;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use vitral::explain::{FacetDepth, facets_over, spaces};
use vitral::internals::render::trace::Step;
use vitral::{DVec3, Error, Visibility};

/// The most facets of brute force that are listed.
const MOST_FACETS: usize = 2000;

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
        let hit: BTreeMap<u32, f32> =
            facets[0].iter().map(|found| (found.facet, found.depth)).collect();

        // List those over the sample, the nearest first, then the others, which were compared too.
        let over =
            facets[0].iter().map(|found| json!({"facet": found.facet, "depth": found.depth}));
        let others = (0..renderer.world().facet_count)
            .filter(|facet| !hit.contains_key(facet))
            .map(|facet| json!({"facet": facet, "depth": null}));
        return Ok(json!({"facets": over.chain(others).take(MOST_FACETS).collect::<Vec<_>>()}));
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
    let slope = match drawn(&recording.watched.steps[at].step) {
        Some(facet) => slope(&spaces(renderer, &camera, facet)?.screen),
        None => None,
    };
    Ok(json!({
        "x": corner[0],
        "y": corner[1],
        "size": SIZE,
        "before": nearest(at),
        "after": nearest(at + 1),
        "slope": slope,
    }))
}

/// How much depth changes from pixel to pixel in a plane `A x + B y + C z + D = 0` of the screen:
/// `-A/C` along a line, `-B/C` from line to line; `None` for an edge-on plane.
fn slope(corners: &[[f64; 3]]) -> Option<[f64; 2]> {
    let [p, q, r] = [0, 1, 2].map(|i| corners.get(i).copied().map(DVec3::from_array));
    let (p, q, r) = (p?, q?, r?);
    let normal = (q - p).cross(r - p);
    let slope = [-normal.x / normal.z, -normal.y / normal.z];
    slope.iter().all(|v| v.is_finite()).then_some(slope)
}

/// The facet that a step drew.
fn drawn(step: &Step) -> Option<u32> {
    match step {
        Step::Drawn { facet, .. } => Some(*facet),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn p17_depth_changes_by_the_same_number_from_pixel_to_pixel() {
        let plane = |x: f64, y: f64| [x, y, 0.5 + 0.01 * x - 0.02 * y];
        let corners = [plane(1.0, 2.0), plane(8.0, 3.0), plane(4.0, 9.0)];
        let [along, down] = slope(&corners).unwrap();
        assert!((along - 0.01).abs() < 1e-12 && (down + 0.02).abs() < 1e-12);
        assert_eq!(slope(&[[0.0; 3]; 3]), None);
    }
}
