//! Fog.

use super::arguments::{Form, scalar_call, token, unit, vector_call};
use crate::{Context, enums as gl};

fn form(pname: u32) -> Option<Form> {
    Some(match pname {
        gl::FOG_MODE
        | gl::FOG_DENSITY
        | gl::FOG_START
        | gl::FOG_END
        | gl::FOG_INDEX
        | gl::FOG_COORD_SRC
        | gl::FOG_DISTANCE_MODE_NV => Form::Scalar,
        gl::FOG_COLOR => Form::Color,
        _ => return None,
    })
}

impl Context {
    scalar_call!(fogf, "glFogf", f32, form, exec_fog);
    scalar_call!(fogi, "glFogi", i32, form, exec_fog);
    vector_call!(fogfv, "glFogfv", f32, form, exec_fog);
    vector_call!(fogiv, "glFogiv", i32, form, exec_fog);

    fn exec_fog(&mut self, call: &str, pname: u32, values: [f32; 4]) {
        let value = values[0];
        match pname {
            gl::FOG_MODE => {
                if self.check_enum(call, "mode", token(value), &[gl::LINEAR, gl::EXP, gl::EXP2]) {
                    self.state.fog.mode = token(value);
                }
            }
            gl::FOG_COORD_SRC => {
                if self.check_enum(
                    call,
                    "source",
                    token(value),
                    &[gl::FOG_COORD, gl::FRAGMENT_DEPTH],
                ) {
                    self.state.fog.source = token(value);
                }
            }
            gl::FOG_DISTANCE_MODE_NV => {
                let modes = [gl::EYE_RADIAL_NV, gl::EYE_PLANE, gl::EYE_PLANE_ABSOLUTE_NV];
                if self.check_enum(call, "distance mode", token(value), &modes) {
                    self.state.fog.distance_mode = token(value);
                }
            }
            gl::FOG_DENSITY if value < 0.0 => self.refuse_value(call, "the density is negative"),
            gl::FOG_DENSITY => self.state.fog.density = value,
            gl::FOG_START => self.state.fog.start = value,
            gl::FOG_END => self.state.fog.end = value,
            gl::FOG_INDEX => self.state.fog.index = value,
            gl::FOG_COLOR => self.state.fog.color = values.map(unit),
            _ => self.refuse_enum(call, "pname", pname),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::testing::{context, put};

    #[test]
    fn fog_parameters() {
        let mut c = context();
        c.fogi(gl::FOG_MODE, gl::LINEAR as i32);
        c.fogf(gl::FOG_END, 9.0);
        let at = put(&c, &[i32::MAX, 0, i32::MIN, i32::MAX]);
        c.fogiv(gl::FOG_COLOR, at);
        assert_eq!(c.get_error(), gl::NO_ERROR);
        assert_eq!((c.state.fog.mode, c.state.fog.end), (gl::LINEAR, 9.0));
        assert_eq!(c.state.fog.color[0], 1.0);
        assert_eq!(c.state.fog.color[2], 0.0);
        let before = c.state.fog;
        c.fogf(gl::FOG_DENSITY, -1.0);
        assert_eq!(c.get_error(), gl::INVALID_VALUE);
        c.fogi(gl::FOG_MODE, -1);
        assert_eq!(c.get_error(), gl::INVALID_ENUM);
        assert_eq!(c.state.fog, before);
        c.fogi(gl::FOG_DISTANCE_MODE_NV, gl::EYE_LINEAR as i32);
        assert_eq!((c.get_error(), c.state.fog), (gl::INVALID_ENUM, before));
        c.fogi(gl::FOG_DISTANCE_MODE_NV, gl::EYE_RADIAL_NV as i32);
        assert_eq!((c.get_error(), c.state.fog.distance_mode), (gl::NO_ERROR, gl::EYE_RADIAL_NV));
        c.fogf(gl::FOG_COLOR, 0.5);
        assert_eq!((c.get_error(), c.state.fog.color), (gl::NO_ERROR, [0.5, 0.0, 0.0, 0.0]));
    }
}
