//! How many colours surfaces have in a picture, and how often each way of shading evaluates the
//! formula of illumination.
//!
//! Source: the course, notes L: L1, the number of colours; L6 to L8, once for each pixel, for each
//!         face, for each vertex.

use crate::answer::Answer;
use serde_json::json;
use std::collections::BTreeSet;
use vitral::bench::{Entrant, Task, measure};
use vitral::internals::frame::Frame;
use vitral::{Channel, Error, Renderer, Visibility};

/// Colours of the pixels that show a surface, and evaluations for flat, Gouraud's and Phong's
/// shading of the visible facets, with one sample a pixel.
pub(crate) fn tally(renderer: &mut Renderer) -> Answer {
    renderer.settings.picture.samples = 1;
    Channel::Surface.request(&mut renderer.settings.picture.channels);
    let camera = renderer.frame_camera();

    // Count the colours, and the pixels that show a surface.
    let picture = renderer.render_from(&camera)?;
    let colors: BTreeSet<[u8; 4]> = surface_colors(&picture.frame).collect();
    let pixels = surface_colors(&picture.frame).count();
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

/// The colours of the pixels that show a surface, row by row; none of a picture without colours or
/// surfaces.
pub(crate) fn surface_colors(frame: &Frame) -> impl Iterator<Item = [u8; 4]> {
    let colors = frame.color.iter().flat_map(|plane| plane.data());
    let surfaces = frame.surface.iter().flat_map(|plane| plane.data());
    let seen = colors.zip(surfaces).filter(|(_, surface)| **surface != Frame::BACKGROUND);
    seen.map(|(color, _)| *color)
}
