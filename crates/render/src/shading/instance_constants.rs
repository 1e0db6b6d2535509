//! The matrices of an instance of a mesh in a frame.

use crate::prepare::{is_solid, mirrors};
use crate::{Execution, PreparedView, Settings};
use vitral_math::{DMat4, DVec4};

/// Matrices of an instance, as rows.
#[derive(Clone, Debug)]
pub(crate) struct InstanceConstants {
    /// Model space to `(X, Y, W)` with `X / W`, `Y / W` in pixels.
    pub screen_from_model: [[f32; 4]; 3],
    /// Model space to view space.
    pub view_from_model: [[f32; 4]; 3],
    /// Normals, model to view space, up to a positive factor.
    pub view_from_model_normal: [[f32; 3]; 3],
    /// Back faces can be seen and are lit like front faces.
    pub two_sided: bool,
    /// The transform turns right into left: geometric normals change sign.
    pub mirrored: bool,
}

impl InstanceConstants {
    /// Of an instance of the world, by its index.
    pub(super) fn new(
        view: &PreparedView<'_>,
        index: usize,
        settings: &Settings,
        execution: &Execution,
    ) -> Self {
        let instance = &view.session.world.instances[index];
        let view_from_model = view.view.view_from_world * instance.world_from_model;
        let clip = view.view.clip_from_view * view_from_model;
        let (w, h) = (f64::from(view.viewport.width) * 0.5, f64::from(view.viewport.height) * 0.5);
        let [x, y, clip_w] = [clip.row(0), clip.row(1), clip.row(3)];
        let screen: [DVec4; 3] = [x * w + clip_w * w, clip_w * h - y * h, clip_w];
        // The cofactor matrix is the inverse transpose times the determinant, and exists for flat
        // transforms too.
        let [a, b, c] = [0, 1, 2].map(|k| view_from_model.col(k).truncate());
        let cofactor = [b.cross(c), c.cross(a), a.cross(b)];
        let mirrored = mirrors(&instance.world_from_model);
        let sign = if mirrored { -1.0 } else { 1.0 };
        let scale = cofactor.iter().map(|v| v.length()).fold(0.0, f64::max);
        let scale = if scale > 0.0 { sign / scale } else { 0.0 };
        let normal_row = |r: usize| [0, 1, 2].map(|k| (cofactor[k][r] * scale) as f32);
        Self {
            screen_from_model: screen.map(|r| r.as_vec4().to_array()),
            view_from_model: rows(&view_from_model),
            view_from_model_normal: [0, 1, 2].map(normal_row),
            two_sided: !is_solid(
                view.session,
                instance,
                &view.camera,
                &view.view,
                settings,
                execution,
            ),
            mirrored,
        }
    }
}

fn rows(m: &DMat4) -> [[f32; 4]; 3] {
    [0, 1, 2].map(|r| m.row(r).as_vec4().to_array())
}
