//! How many colours surfaces have in a picture, and how often each way of shading evaluates the
//! formula of illumination.
//!
//! Source: the course, notes L: L1, the number of colours; L6 to L8, once for each pixel, for each
//!         face, for each vertex.

use crate::answer::Answer;
use serde_json::json;
use std::collections::BTreeSet;
use vitral::bench::{Entrant, Task, measure};
use vitral::{Channel, Error, Renderer, Visibility};

/// The surface id of the background.
const NO_SURFACE: u32 = u32::MAX;

/// Colours of the pixels that show a surface, and evaluations for flat, Gouraud's and Phong's
/// shading of what is visible, all with one sample a pixel.
pub(crate) fn tally(renderer: &mut Renderer) -> Answer {
    renderer.settings.picture.samples = 1;
    Channel::Surface.request(&mut renderer.settings.picture.channels);
    let camera = renderer.frame_camera();

    // Count the colours, and the pixels that show a surface.
    let picture = renderer.render_from(&camera)?;
    let (Some(color), Some(surface)) = (&picture.frame.color, &picture.frame.surface) else {
        return Err(Error::usage("this picture has no colours", ""));
    };
    let seen = color.data().iter().zip(surface.data()).filter(|(_, id)| **id != NO_SURFACE);
    let colors: BTreeSet<[u8; 4]> = seen.clone().map(|(color, _)| *color).collect();
    let pixels = seen.count();
    renderer.recycle(picture);

    // Find the facets that are visible, and their vertices.
    let entrants = Entrant::all();
    let z_buffer = entrants.iter().find(|e| e.algorithm.choice() == Visibility::Z_BUFFER);
    let z_buffer = z_buffer.ok_or_else(|| Error::usage("there is no z-buffer", ""))?;
    let task = Task {
        scene: renderer.scene(),
        camera: &camera,
        settings: &renderer.settings,
        frames: 1,
        time_limit: None,
        memory_limit: None,
    };
    let facets = match measure(&task, z_buffer, renderer.execution())? {
        Ok(measured) => measured.seen.visible_facets(),
        Err(_) => BTreeSet::new(),
    };
    let world = renderer.world();
    let vertices = facets.iter().flat_map(|&facet| {
        let place = world.instance_of_facet(facet);
        let instance = &world.instances[place];
        let corners = instance.mesh.triangles[(facet - instance.first_facet) as usize];
        corners.map(|vertex| (place, vertex))
    });
    let vertices: BTreeSet<(usize, u32)> = vertices.collect();
    let answer = json!({
        "colors": colors.len(),
        "evaluations": {"flat": facets.len(), "gouraud": vertices.len(), "phong": pixels},
    });
    Ok((answer, Vec::new()))
}
