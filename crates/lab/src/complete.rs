//! The state with every field, and what it leads to: lights, materials, camera.

use crate::answer::{Answer, told};
use serde_json::{Value, json};
use vitral::internals::scene::lab::LabView;
use vitral::{Camera, DMat4, DVec3, Projection, Renderer, State};

/// Every setting with its value, the lights in force, the materials, and the camera.
pub(crate) fn complete(renderer: &mut Renderer, state: &State) -> Answer {
    let camera = renderer.frame_camera();

    // Dialogs show the lights whole, whichever of their terms the picture shows.
    let term = renderer.light_term.take();
    let lights = renderer.frame_lights(&camera);
    renderer.light_term = term;
    let (view_angle, parallel_height) = match camera.projection {
        Projection::Perspective { view_angle } => (Some(view_angle.to_degrees()), None),
        Projection::Parallel { height } => (None, Some(height)),
        Projection::Window { .. } => (None, None),
    };
    let refusal = renderer.check_settings().err().map(|error| told(&error));
    let answer = json!({
        "state": state,
        "refusal": refusal,
        "lights": lights,
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
        "matrices": matrices(&camera, state),
        "warnings": renderer.scene().warnings,
    });
    Ok((answer, Vec::new()))
}

/// The view transformation, that of all objects, and their product, row by row.
///
/// Source: the course, notes L, L16: the view transformation is made of eyeU and eyeT, that of the
/// objects of allU and allT.
fn matrices(camera: &Camera, state: &State) -> Value {
    let [all_u, all_t] = [state.objects.rotation, state.objects.translation].map(DVec3::from_array);
    let view = camera.view_from_world();
    let objects = LabView { all_u, all_t, ..LabView::default() }.world_from_model();
    let rows = |matrix: DMat4| [0, 1, 2, 3].map(|row| matrix.row(row).to_array());
    json!({"view": rows(view), "objects": rows(objects), "product": rows(view * objects)})
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn l16_the_product_brings_points_of_objects_before_the_eye() {
        let camera = Camera::look_at([0.0, 0.0, 10.0], [0.0; 3]);
        let mut state = State::default();
        state.objects.translation = [1.0, 2.0, 3.0];
        let told = matrices(&camera, &state);
        let column: Vec<f64> =
            (0..4).map(|row| told["product"][row][3].as_f64().unwrap()).collect();
        assert_eq!(column, [1.0, 2.0, -7.0, 1.0]);
        assert_eq!(told["objects"][0][3], 1.0);
    }
}
