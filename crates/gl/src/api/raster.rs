//! Points, lines, polygons, hints, multisampling.

use super::arguments::{Form, scalar_call, unit, vector_call};
use super::materials::faces;
use crate::{Context, enums as gl};

fn point_form(pname: u32) -> Option<Form> {
    Some(match pname {
        gl::POINT_SIZE_MIN | gl::POINT_SIZE_MAX | gl::POINT_FADE_THRESHOLD_SIZE => Form::Scalar,
        gl::POINT_DISTANCE_ATTENUATION => Form::Vector(3),
        _ => return None,
    })
}

/// Points and lines.
impl Context {
    /// `glPointSize`.
    pub fn point_size(&mut self, size: f32) {
        self.listable(move |c| {
            if !c.may_set("glPointSize") {
            } else if size > 0.0 {
                c.state.points.size = size;
            } else {
                c.refuse_value("glPointSize", "the size is not positive");
            }
        });
    }

    scalar_call!(point_parameterf, "glPointParameterf", f32, point_form, exec_point_parameter);
    scalar_call!(point_parameteri, "glPointParameteri", i32, point_form, exec_point_parameter);
    vector_call!(point_parameterfv, "glPointParameterfv", f32, point_form, exec_point_parameter);
    vector_call!(point_parameteriv, "glPointParameteriv", i32, point_form, exec_point_parameter);

    fn exec_point_parameter(&mut self, call: &str, pname: u32, values: [f32; 4]) {
        let points = &mut self.state.points;
        match pname {
            gl::POINT_DISTANCE_ATTENUATION => {
                points.attenuation = [values[0], values[1], values[2]]
            }
            gl::POINT_SIZE_MIN | gl::POINT_SIZE_MAX | gl::POINT_FADE_THRESHOLD_SIZE
                if values[0].is_nan() || values[0] < 0.0 =>
            {
                self.refuse_value(call, "the size is negative");
            }
            gl::POINT_SIZE_MIN => points.limits[0] = values[0],
            gl::POINT_SIZE_MAX => points.limits[1] = values[0],
            gl::POINT_FADE_THRESHOLD_SIZE => points.fade_threshold = values[0],
            _ => self.refuse_enum(call, "pname", pname),
        }
    }

    /// `glLineWidth`.
    pub fn line_width(&mut self, width: f32) {
        self.listable(move |c| {
            if !c.may_set("glLineWidth") {
            } else if width > 0.0 {
                c.state.lines.width = width;
            } else {
                c.refuse_value("glLineWidth", "the width is not positive");
            }
        });
    }

    /// `glLineStipple`.
    pub fn line_stipple(&mut self, factor: i32, pattern: u16) {
        self.listable(move |c| {
            if c.may_set("glLineStipple") {
                c.state.lines.pattern = (factor.clamp(1, 256), pattern);
            }
        });
    }
}

/// Polygons.
impl Context {
    /// `glCullFace`.
    pub fn cull_face(&mut self, mode: u32) {
        self.listable(move |c| {
            let call = "glCullFace";
            if c.may_set(call)
                && c.check_enum(call, "mode", mode, &[gl::FRONT, gl::BACK, gl::FRONT_AND_BACK])
            {
                c.state.polygons.cull_mode = mode;
            }
        });
    }

    /// `glFrontFace`.
    pub fn front_face(&mut self, mode: u32) {
        self.listable(move |c| {
            if c.may_set("glFrontFace")
                && c.check_enum("glFrontFace", "mode", mode, &[gl::CW, gl::CCW])
            {
                c.state.polygons.front_face = mode;
            }
        });
    }

    /// `glPolygonMode`.
    pub fn polygon_mode(&mut self, face: u32, mode: u32) {
        self.listable(move |c| {
            let call = "glPolygonMode";
            if !c.may_set(call)
                || !c.check_enum(call, "mode", mode, &[gl::POINT, gl::LINE, gl::FILL])
            {
                return;
            }
            let Some(chosen) = faces(face) else { return c.refuse_enum(call, "face", face) };
            for side in (0..2).filter(|side| chosen[*side]) {
                c.state.polygons.mode[side] = mode;
            }
        });
    }

    /// `glPolygonOffset`.
    pub fn polygon_offset(&mut self, factor: f32, units: f32) {
        self.listable(move |c| {
            if c.may_set("glPolygonOffset") {
                c.state.polygons.offset = [factor, units];
            }
        });
    }

    /// `glPolygonOffsetEXT`: `bias` is in window depth rather than in units of resolvable depth.
    pub fn polygon_offset_ext(&mut self, factor: f32, bias: f32) {
        self.listable(move |c| {
            if c.may_set("glPolygonOffsetEXT") {
                c.state.polygons.offset = [factor, bias * c.depth_units()];
            }
        });
    }

    /// How many resolvable steps depth 1 has.
    pub(super) fn depth_units(&mut self) -> f32 {
        ((1_u64 << self.framebuffer_bits().depth.min(24)) - 1) as f32
    }
}

/// Hints and sample coverage.
impl Context {
    /// `glHint`.
    pub fn hint(&mut self, target: u32, mode: u32) {
        self.listable(move |c| {
            let call = "glHint";
            if !c.may_set(call)
                || !c.check_enum(call, "mode", mode, &[gl::FASTEST, gl::NICEST, gl::DONT_CARE])
            {
                return;
            }
            match c.state.hints.iter_mut().find(|hint| hint.0 == target) {
                Some(hint) => hint.1 = mode,
                None => c.refuse_enum(call, "target", target),
            }
        });
    }

    /// `glSampleCoverage`.
    pub fn sample_coverage(&mut self, value: f32, invert: u8) {
        self.listable(move |c| {
            if c.may_set("glSampleCoverage") {
                c.state.sample_coverage_value = (unit(value), invert != 0);
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::testing::{RESULT, context, put};
    use crate::state::{Lines, Points, Polygons};

    #[test]
    fn wrong_arguments_change_nothing() {
        let mut c = context();
        type Call = fn(&mut Context);
        let calls: [(Call, u32); 12] = [
            (|c| c.point_size(0.0), gl::INVALID_VALUE),
            (|c| c.point_size(f32::NAN), gl::INVALID_VALUE),
            (|c| c.line_width(-1.0), gl::INVALID_VALUE),
            (|c| c.cull_face(gl::CW), gl::INVALID_ENUM),
            (|c| c.front_face(gl::FRONT), gl::INVALID_ENUM),
            (|c| c.polygon_mode(gl::LEFT, gl::LINE), gl::INVALID_ENUM),
            (|c| c.polygon_mode(gl::FRONT, gl::POINTS), gl::INVALID_ENUM),
            (|c| c.point_parameterf(gl::POINT_SIZE_MAX, -1.0), gl::INVALID_VALUE),
            (|c| c.point_parameterf(gl::POINT_SIZE, 1.0), gl::INVALID_ENUM),
            (|c| c.point_parameteri(gl::POINT_SIZE, 1), gl::INVALID_ENUM),
            (|c| c.hint(gl::FOG, gl::NICEST), gl::INVALID_ENUM),
            (|c| c.hint(gl::FOG_HINT, gl::FOG), gl::INVALID_ENUM),
        ];
        for (i, (call, error)) in calls.into_iter().enumerate() {
            call(&mut c);
            assert_eq!(c.get_error(), error, "{i}");
        }
        assert_eq!(c.state.points, Points::default());
        assert_eq!(c.state.lines, Lines::default());
        assert_eq!(c.state.polygons, Polygons::default());
    }

    #[test]
    fn setters() {
        let mut c = context();
        c.configure_default_framebuffer(gl::RGBA, 24, 8, 0);
        assert!(c.make_current(RESULT, gl::UNSIGNED_BYTE, 1, 1));
        c.polygon_mode(gl::BACK, gl::LINE);
        c.line_stipple(1000, 0x0F0F);
        let at = put(&c, &[1.0_f32, 2.0, 3.0]);
        c.point_parameterfv(gl::POINT_DISTANCE_ATTENUATION, at);
        c.polygon_offset_ext(1.0, 1.0);
        c.hint(gl::GENERATE_MIPMAP_HINT, gl::NICEST);
        c.sample_coverage(2.0, 1);
        assert_eq!(c.get_error(), gl::NO_ERROR);
        assert_eq!(c.state.polygons.mode, [gl::FILL, gl::LINE]);
        assert_eq!(c.state.lines.pattern, (256, 0x0F0F));
        assert_eq!(c.state.points.attenuation, [1.0, 2.0, 3.0]);
        assert_eq!(c.state.polygons.offset, [1.0, 16_777_215.0]);
        assert_eq!(c.state.sample_coverage_value, (1.0, true));
    }
}
