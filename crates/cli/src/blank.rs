//! Pictures on which nothing of the models is seen, and why.

use vitral::{Frame, Lines, Picture, Renderer};

/// Why no surface of the models is in the picture; `None` if one is, or if there are none.
pub(crate) fn why(renderer: &Renderer, picture: &Picture) -> Option<&'static str> {
    let (scene, stats) = (renderer.scene(), &picture.stats);
    let has_lines =
        scene.meshes.iter().any(|mesh| !mesh.lines.is_empty() || !mesh.points.is_empty());
    if renderer.world().facet_count == 0
        || has_lines
        || renderer.settings.picture.lines != Lines::None
    {
        return None;
    }

    // A surface that is there and lets everything through.
    let opacities = renderer.opacities();
    let materials =
        scene.meshes.iter().flat_map(|mesh| mesh.parts.iter()).map(|part| part.material);
    let is_clear =
        |material: Option<u32>| material.is_some_and(|m| opacities.get(m as usize) == Some(&0.0));
    let materials: Vec<Option<u32>> = materials.collect();
    if !materials.is_empty() && materials.iter().all(|&material| is_clear(material)) {
        return Some("nothing is seen, since the opacity of all surfaces is 0");
    }
    if stats.picture.covered_pixels > 0
        || stats.picture.layer_samples > 0
        || stats.picture.pixels == 0
    {
        return None;
    }
    if picture.frame.color.is_none() && data_show(&picture.frame) {
        return None;
    }

    // What became of the triangles.
    let (cull, geometry) = (&stats.cull, &stats.geometry);
    Some(if cull.triangles_culled + geometry.outside >= cull.triangles {
        "nothing is seen, since all surfaces lie outside of the view"
    } else if geometry.set_up > 0 {
        "nothing is seen, since no surface covers the middle of a sample, or all that do are cut out by textures"
    } else if geometry.back_facing > 0 {
        "nothing is seen, since all surfaces in view are turned away (their backs are not shown)"
    } else if geometry.no_sample > 0 {
        "nothing is seen, since the surfaces in view are too small to cover a sample"
    } else {
        "nothing is seen, since the surfaces in view have no area"
    })
}

/// Whether a picture without colours, of which no pixels are counted, shows a surface in its data,
/// or has none that could tell.
fn data_show(frame: &Frame) -> bool {
    let Frame { depth, surface, object, material, normal, .. } = frame;
    let ids = [surface, object, material].into_iter().flatten();
    let tells = depth.is_some() || normal.is_some() || ids.clone().next().is_some();
    let is_near = depth.iter().any(|plane| plane.data().iter().any(|&depth| depth > 0.0));
    let has_normal =
        normal.iter().any(|plane| plane.data().iter().any(|&normal| normal != [0.0; 3]));
    let has_id =
        ids.into_iter().any(|plane| plane.data().iter().any(|&id| id != Frame::BACKGROUND));
    !tells || is_near || has_normal || has_id
}
