//! Viewport, depth range, clip control, clip planes, the active texture unit.

use super::arguments::unit64;
use super::capabilities::index_in;
use crate::state::{MAX_CLIP_PLANES, MAX_TEXTURE_SIZE, MAX_TEXTURE_UNITS};
use crate::{Context, enums as gl};

impl Context {
    /// `glViewport`.
    pub fn viewport(&mut self, x: i32, y: i32, width: i32, height: i32) {
        self.listable(move |c| {
            if !c.may_set("glViewport") {
            } else if width < 0 || height < 0 {
                c.refuse_value("glViewport", "the size is negative");
            } else {
                let limit = MAX_TEXTURE_SIZE as i32;
                c.state.viewport.rect = [x, y, width.min(limit), height.min(limit)];
            }
        });
    }

    /// `glDepthRange`.
    pub fn depth_range(&mut self, near: f64, far: f64) {
        self.listable(move |c| {
            if c.may_set("glDepthRange") {
                c.state.viewport.depth_range.near = unit64(near);
                c.state.viewport.depth_range.far = unit64(far);
            }
        });
    }

    /// `glClipControl`.
    pub fn clip_control(&mut self, origin: u32, depth: u32) {
        self.listable(move |c| {
            let call = "glClipControl";
            if c.may_set(call)
                && c.check_enum(call, "origin", origin, &[gl::LOWER_LEFT, gl::UPPER_LEFT])
                && c.check_enum(call, "depth", depth, &[gl::NEGATIVE_ONE_TO_ONE, gl::ZERO_TO_ONE])
            {
                c.state.clip_control = (origin, depth);
            }
        });
    }

    /// `glClipPlane`.
    pub fn clip_plane(&mut self, plane: u32, equation: usize) {
        let index = index_in(plane, gl::CLIP_PLANE0, MAX_CLIP_PLANES);
        // For an invalid plane the equation is not read: its pointer may be invalid.
        let given =
            index.map_or(Some([0.0; 4]), |_| self.take_arguments("glClipPlane", equation, 4));
        let Some(given) = given else { return };
        self.listable(move |c| {
            if !c.may_set("glClipPlane") {
                return;
            }
            match index {
                Some(i) => c.state.clip_planes[i] = c.eye_plane(given),
                None => c.refuse_enum("glClipPlane", "plane", plane),
            }
        });
    }

    /// `glGetClipPlane`.
    pub fn get_clip_plane(&mut self, plane: u32, equation: usize) {
        if !self.may_set("glGetClipPlane") {
            return;
        }
        match index_in(plane, gl::CLIP_PLANE0, MAX_CLIP_PLANES) {
            Some(i) => {
                let values = self.state.clip_planes[i];
                self.give_results("glGetClipPlane", equation, &values);
            }
            None => self.refuse_enum("glGetClipPlane", "plane", plane),
        }
    }

    /// `glActiveTexture`.
    pub fn active_texture(&mut self, texture: u32) {
        self.listable(move |c| {
            if !c.may_set("glActiveTexture") {
                return;
            }
            match index_in(texture, gl::TEXTURE0, MAX_TEXTURE_UNITS) {
                Some(unit) => c.state.active_unit = unit,
                None => c.refuse_enum("glActiveTexture", "texture", texture),
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::testing::{RESULT, context, put, take};

    #[test]
    fn clip_planes_are_kept_in_eye_space() {
        let mut c = context();
        c.translatef(0.0, 0.0, -5.0);
        let at = put(&c, &[0.0_f64, 0.0, 1.0, 2.0]);
        c.clip_plane(gl::CLIP_PLANE0 + 7, at);
        c.load_identity();
        c.get_clip_plane(gl::CLIP_PLANE0 + 7, RESULT);
        // z >= -2 in the model is z >= -7 for the eye.
        assert_eq!(take::<f64, 4>(&c), [0.0, 0.0, 1.0, 7.0]);
        for at in [at, 0] {
            c.clip_plane(gl::CLIP_PLANE0 + 8, at);
            assert_eq!(c.get_error(), gl::INVALID_ENUM);
        }
        c.clip_plane(gl::CLIP_PLANE0, 0);
        assert_eq!(c.get_error(), gl::INVALID_VALUE);
        c.scalef(0.0, 0.0, 0.0);
        c.clip_plane(gl::CLIP_PLANE0, at);
        assert_eq!(c.state.clip_planes[0], [0.0, 0.0, 1.0, 2.0]);
    }

    #[test]
    fn viewport_limits() {
        let mut c = context();
        c.viewport(-3, 4, 100_000, 7);
        assert_eq!(c.state.viewport.rect, [-3, 4, 16384, 7]);
        c.viewport(0, 0, -1, 1);
        assert_eq!(c.get_error(), gl::INVALID_VALUE);
        assert_eq!(c.state.viewport.rect, [-3, 4, 16384, 7]);
        c.depth_range(-1.0, 2.0);
        let range = c.state.viewport.depth_range;
        assert_eq!((range.near, range.far), (0.0, 1.0));
        c.clip_control(gl::UPPER_LEFT, gl::UPPER_LEFT);
        assert_eq!(c.get_error(), gl::INVALID_ENUM);
        assert_eq!(c.state.clip_control, (gl::LOWER_LEFT, gl::NEGATIVE_ONE_TO_ONE));
    }
}
