//! Facets by their numbers: what they belong to, and where they are in the picture.

use crate::answer::Answer;
use serde_json::{Value, json};
use vitral::explain::{facet_names, facet_outlines};
use vitral::{Error, Renderer};

/// Facets that can be asked for at once.
const MOST_FACETS: usize = 500;

/// The surface, mesh and material of each facet, and its outline in pixels.
pub(crate) fn facets(renderer: &mut Renderer, facets: &[u32]) -> Answer {
    if facets.len() > MOST_FACETS {
        let told = format!("{} facets are too many", facets.len());
        return Err(Error::usage(told, format!("at most {MOST_FACETS} come at once")));
    }
    let outlines = facet_outlines(renderer, &renderer.frame_camera(), facets)?;
    let told = facets.iter().zip(outlines).map(|(&facet, outline)| {
        let names = facet_names(renderer, facet)?;
        Ok(json!({
            "facet": facet,
            "surface": names.surface,
            "mesh": names.mesh,
            "material": names.material,
            "outline": outline,
        }))
    });
    let told = told.collect::<Result<Vec<Value>, Error>>()?;
    Ok((json!({"facets": told}), Vec::new()))
}
