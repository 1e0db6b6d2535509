//! Two points of one projector, before and after the perspective transformation.
//!
//! Source: the course, notes P, P8: before it, points P and Q hide each other if
//! `xP / zP = xQ / zQ` and `yP / zP = yQ / zQ`, four divisions; after it, where two divisions a
//! point have been done once, if `xP = xQ` and `yP = yQ`.

use serde_json::{Value, json};
use vitral::explain::Surface;
use vitral::{Camera, DVec3, Projection, Renderer};

/// The two nearest points over a pixel, or the nearest one and another twice as far. `null` where
/// nothing is seen.
pub(crate) fn projector(
    renderer: &Renderer,
    camera: &Camera,
    pixel: [u32; 2],
    surfaces: &[Surface],
) -> Value {
    let Some(nearest) = surfaces.first() else { return Value::Null };
    let size = [renderer.settings.picture.width, renderer.settings.picture.height].map(f64::from);
    let transform = renderer.view_transform(camera);
    let view_from_clip = transform.clip_from_view.inverse();
    let [x, y] = [0, 1].map(|k| (f64::from(pixel[k]) + 0.5) / size[k] * 2.0 - 1.0);
    let point = |depth: f64| view_from_clip.project_point3(DVec3::new(x, -y, depth));

    let first = point(f64::from(nearest.depth));
    let mut points = vec![(nearest.mesh.as_str(), first)];
    match surfaces.get(1) {
        Some(second) => points.push((&second.mesh, point(f64::from(second.depth)))),
        None if matches!(camera.projection, Projection::Perspective { .. }) => {
            points.push(("", first * 2.0))
        }
        None => points.push(("", first + DVec3::new(0.0, 0.0, first.z))),
    }
    let told = points.into_iter().map(|(mesh, view)| {
        let after = transform.clip_from_view.project_point3(view);
        let quotients = transform.perspective.then(|| [view.x / view.z, view.y / view.z]);
        json!({"mesh": mesh, "view": view.to_array(), "quotients": quotients, "after": after.to_array()})
    });
    told.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral::explain::{Deciders, explain};
    use vitral::load_builtin;

    #[test]
    fn p8_points_of_a_projector_have_equal_x_and_y_after_the_transformation() {
        let mut renderer = Renderer::new(load_builtin("cubs").unwrap()).unwrap();
        (renderer.settings.picture.width, renderer.settings.picture.height) = (640, 480);
        let camera = renderer.frame_camera();
        for (pixel, surfaces) in [([340, 200], 2), ([310, 320], 1)] {
            let told = explain(&renderer, &camera, pixel, &Deciders::Chosen, None).unwrap();
            assert_eq!(told.surfaces.len(), surfaces);
            let points = projector(&renderer, &camera, pixel, &told.surfaces);
            let number = |i: usize, what: &str, k: usize| points[i][what][k].as_f64().unwrap();
            for k in 0..2 {
                assert!(
                    (number(0, "quotients", k) - number(1, "quotients", k)).abs() < 1e-12,
                    "{points}"
                );
                assert!((number(0, "after", k) - number(1, "after", k)).abs() < 1e-12, "{points}");
            }
            // The nearer point has the larger depth, and the smaller distance along -z.
            assert!(
                number(0, "after", 2) > number(1, "after", 2)
                    && number(0, "view", 2) > number(1, "view", 2)
            );
            assert!((number(0, "after", 2) - f64::from(told.surfaces[0].depth)).abs() < 1e-6);
        }
        assert!(projector(&renderer, &camera, [0, 0], &[]).is_null());
    }
}
