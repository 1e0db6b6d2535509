//! What a pixel's ray opens of the acceleration structure.

use crate::answer::Answer;
use serde_json::{Value, json};
use vitral::explain::{PartVolume, PathPart, ray_path};
use vitral::{Error, Renderer};

/// Parts that are listed at most.
const MOST_PARTS: usize = 2000;

/// The structure's space, and the parts that the ray through the pixel's centre opens, in order.
pub(crate) fn path(renderer: &mut Renderer, pixel: [u32; 2]) -> Answer {
    let camera = renderer.frame_camera();
    let path = ray_path(renderer, &camera, pixel)?;
    let listed = path.parts.iter().take(MOST_PARTS).map(part).collect::<Result<Vec<_>, _>>()?;
    let mut answer = json!({
        "acceleration": renderer.settings.acceleration.unwrap_or_default().name,
        "ray": {"origin": path.origin, "direction": path.direction},
        "space": path.space.map(|[min, max]| json!({"min": min, "max": max, "cells": path.cells})),
        "parts": listed,
        "boxes": path.boxes,
        "tests": path.tests,
        "hit": path.hit.map(|(facet, _)| facet),
        "distance": path.hit.map(|(_, distance)| distance),
        "count": path.count,
    });
    if path.parts.len() > MOST_PARTS {
        answer["more"] = json!(path.parts.len() - MOST_PARTS);
    }
    Ok((answer, Vec::new()))
}

/// A part; its volume where that is not the box round it.
fn part(part: &PathPart) -> Result<Value, Error> {
    let mut told = json!({
        "id": part.part,
        "parent": part.above,
        "name": part.name,
        "min": part.min,
        "max": part.max,
        "facets": part.facets,
    });
    if part.volume != PartVolume::AxisAlignedBox {
        told["volume"] =
            serde_json::to_value(part.volume).map_err(|e| Error::usage(e.to_string(), ""))?;
    }
    Ok(told)
}
