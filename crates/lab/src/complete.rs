//! The state with every field, and what it leads to: lights, materials, camera.

use crate::answer::Answer;
use serde_json::json;
use vitral::{Projection, Renderer, State};

/// Every setting with its value, the lights in force, the materials, and the camera.
pub(crate) fn complete(renderer: &mut Renderer, state: &State) -> Answer {
    let camera = renderer.frame_camera();
    let (view_angle, parallel_height) = match camera.projection {
        Projection::Perspective { view_angle } => (Some(view_angle.to_degrees()), None),
        Projection::Parallel { height } => (None, Some(height)),
        Projection::Window { .. } => (None, None),
    };
    let answer = json!({
        "state": state,
        "lights": renderer.frame_lights(&camera),
        "ambient": renderer.frame_ambient(),
        "materials": renderer.scene().materials,
        "camera": {
            "position": camera.position.to_array(),
            "focal-point": camera.focal_point.to_array(),
            "view-up": camera.view_up.to_array(),
            "view-angle": view_angle,
            "parallel-height": parallel_height,
            "camera-index": state.viewpoint.or_own(renderer.world()).camera_index,
            "clip": camera.clip,
        },
        "warnings": renderer.scene().warnings,
    });
    Ok((answer, Vec::new()))
}
