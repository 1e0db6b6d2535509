//! The highlight of a light: its centroid, and the point that mirrors the light to the viewer.
//!
//! Source: the course, notes L, L20: a highlight is brightest where the mirror direction of the
//!         light meets the viewer.

use crate::answer::Answer;
use serde_json::json;
use vitral::{
    Channel, ColorSpace, DVec3, Error, Light, LightKind, LightTerm, Projection, Renderer,
};

/// The least cosine between mirrored light and viewer of a point that counts as a mirror: 5.7
/// degrees.
const LEAST_COSINE: f64 = 0.995;

/// Both places in pixels, the middle of a pixel at .5; `null` where there is none.
pub(crate) fn highlight(renderer: &mut Renderer, number: usize) -> Answer {
    let camera = renderer.frame_camera();
    let mut lights = renderer.frame_lights(&camera);
    let Some(light) = lights.get(number).cloned() else {
        return Err(Error::usage(
            format!("there is no light {number}"),
            format!("the scene has {}", lights.len()),
        ));
    };

    // Render the specular term of this light alone, in the course's numbers.
    lights.iter_mut().enumerate().for_each(|(i, other)| other.enabled &= i == number);
    renderer.lights = Some(lights);
    renderer.light_edits.clear();
    renderer.light_term = Some(LightTerm::Specular);
    let picture = &mut renderer.settings.picture;
    (picture.samples, picture.color_space) = (1, ColorSpace::Raw);
    Channel::Normal.request(&mut picture.channels);
    Channel::Depth.request(&mut picture.channels);
    let picture = renderer.render_from(&camera)?;
    let frame = &picture.frame;
    let (Some(color), Some(normal), Some(depth)) = (&frame.color, &frame.normal, &frame.depth)
    else {
        return Err(Error::usage("this picture has no colours, normals or depths", ""));
    };

    // Find the centroid of its brightness, and the pixel that mirrors best.
    let (mut weight, mut sum, mut best) = (0.0, [0.0; 2], (LEAST_COSINE, None));
    let world_from_clip = renderer.view_transform(&camera).clip_from_world().inverse();
    let size = [color.width(), color.height()].map(f64::from);
    for (i, pixel) in color.data().iter().enumerate() {
        if depth.data()[i] == 0.0 {
            continue;
        }
        let at = [i as u32 % color.width(), i as u32 / color.width()].map(|v| f64::from(v) + 0.5);
        let brightness: f64 = pixel[..3].iter().map(|&c| f64::from(c)).sum();
        weight += brightness;
        (0..2).for_each(|k| sum[k] += brightness * at[k]);

        // Reflect the light at the pixel's point.
        let clip = DVec3::new(
            at[0] / size[0] * 2.0 - 1.0,
            1.0 - at[1] / size[1] * 2.0,
            f64::from(depth.data()[i]),
        );
        let point = world_from_clip.project_point3(clip);
        let Some(l) = towards(&light, point) else { continue };
        let n = DVec3::from(normal.data()[i].map(f64::from));
        let v = match camera.projection {
            Projection::Parallel { .. } => (camera.position - camera.focal_point).normalize(),
            _ => (camera.position - point).normalize(),
        };
        let cosine = (n * (2.0 * n.dot(l)) - l).dot(v);
        if n.dot(l) > 0.0 && cosine > best.0 {
            best = (cosine, Some(at));
        }
    }
    let centroid = (weight > 0.0).then(|| sum.map(|v| v / weight));
    renderer.recycle(picture);
    Ok((json!({"centroid": centroid, "mirror": best.1}), Vec::new()))
}

/// The unit vector from a point to the light, where it comes from somewhere.
fn towards(light: &Light, point: DVec3) -> Option<DVec3> {
    match light.kind {
        LightKind::Directional { direction } => Some(-direction.normalize_or_zero()),
        LightKind::Point { position } | LightKind::Spot { position, .. } => {
            Some((position - point).normalize_or_zero())
        }
        _ => None,
    }
}
