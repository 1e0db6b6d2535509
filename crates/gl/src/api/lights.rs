//! Lights, the light model, the shade model.

use super::arguments::{Form, scalar_call, token, vector_call};
use super::capabilities::index_in;
use super::get::Value;
use crate::state::{Light, MAX_LIGHTS};
use crate::{Context, enums as gl};
use vitral_math::{DMat3, dvec3, dvec4};

fn light_form(pname: u32) -> Option<Form> {
    Some(match pname {
        gl::AMBIENT | gl::DIFFUSE | gl::SPECULAR => Form::Color,
        gl::POSITION => Form::Vector(4),
        gl::SPOT_DIRECTION => Form::Vector(3),
        gl::SPOT_EXPONENT
        | gl::SPOT_CUTOFF
        | gl::CONSTANT_ATTENUATION
        | gl::LINEAR_ATTENUATION
        | gl::QUADRATIC_ATTENUATION => Form::Scalar,
        _ => return None,
    })
}

fn model_form(pname: u32) -> Option<Form> {
    Some(match pname {
        gl::LIGHT_MODEL_AMBIENT => Form::Color,
        gl::LIGHT_MODEL_LOCAL_VIEWER | gl::LIGHT_MODEL_TWO_SIDE | gl::LIGHT_MODEL_COLOR_CONTROL => {
            Form::Scalar
        }
        _ => return None,
    })
}

/// Lights.
impl Context {
    scalar_call!(lightf, "glLightf", f32, light_form, exec_light, light);
    scalar_call!(lighti, "glLighti", i32, light_form, exec_light, light);
    vector_call!(lightfv, "glLightfv", f32, light_form, exec_light, light);
    vector_call!(lightiv, "glLightiv", i32, light_form, exec_light, light);

    fn exec_light(&mut self, call: &str, light: u32, pname: u32, values: [f32; 4]) {
        let Some(index) = index_in(light, gl::LIGHT0, MAX_LIGHTS) else {
            return self.refuse_enum(call, "light", light);
        };

        // Check the range of the value.
        let [value, ..] = values;
        let good = match pname {
            gl::SPOT_EXPONENT => (0.0..=128.0).contains(&value),
            gl::SPOT_CUTOFF => (0.0..=90.0).contains(&value) || value == 180.0,
            gl::CONSTANT_ATTENUATION | gl::LINEAR_ATTENUATION | gl::QUADRATIC_ATTENUATION => {
                value >= 0.0
            }
            _ => true,
        };
        if !good {
            return self.refuse_value(call, "the value is out of range");
        }

        // Transform positions and directions to eye space.
        let position = self.modelview64()
            * dvec4(value.into(), values[1].into(), values[2].into(), values[3].into());
        let direction = DMat3::from_mat4(self.modelview64())
            * dvec3(value.into(), values[1].into(), values[2].into());

        // Store the value.
        let light = &mut self.state.lighting.lights[index];
        match pname {
            gl::AMBIENT => light.ambient = values,
            gl::DIFFUSE => light.diffuse = values,
            gl::SPECULAR => light.specular = values,
            gl::POSITION => light.position = position.as_vec4().to_array(),
            gl::SPOT_DIRECTION => light.spot_direction = direction.as_vec3().to_array(),
            gl::SPOT_EXPONENT => light.spot_exponent = value,
            gl::SPOT_CUTOFF => light.spot_cutoff = value,
            gl::CONSTANT_ATTENUATION => light.attenuation[0] = value,
            gl::LINEAR_ATTENUATION => light.attenuation[1] = value,
            gl::QUADRATIC_ATTENUATION => light.attenuation[2] = value,
            _ => self.refuse_enum(call, "pname", pname),
        }
    }

    fn light_value(&mut self, call: &str, light: u32, pname: u32) -> Option<Value> {
        if !self.may_set(call) {
            return None;
        }
        let Some(index) = index_in(light, gl::LIGHT0, MAX_LIGHTS) else {
            self.refuse_enum(call, "light", light);
            return None;
        };
        let light: &Light = &self.state.lighting.lights[index];
        Some(match pname {
            gl::AMBIENT => Value::normalized(&light.ambient),
            gl::DIFFUSE => Value::normalized(&light.diffuse),
            gl::SPECULAR => Value::normalized(&light.specular),
            gl::POSITION => Value::floats(&light.position),
            gl::SPOT_DIRECTION => Value::floats(&light.spot_direction),
            gl::SPOT_EXPONENT => Value::float(light.spot_exponent),
            gl::SPOT_CUTOFF => Value::float(light.spot_cutoff),
            gl::CONSTANT_ATTENUATION => Value::float(light.attenuation[0]),
            gl::LINEAR_ATTENUATION => Value::float(light.attenuation[1]),
            gl::QUADRATIC_ATTENUATION => Value::float(light.attenuation[2]),
            _ => {
                self.refuse_enum(call, "pname", pname);
                return None;
            }
        })
    }

    /// `glGetLightfv`.
    pub fn get_lightfv(&mut self, light: u32, pname: u32, params: usize) {
        let call = "glGetLightfv";
        let value = self.light_value(call, light, pname);
        self.give_value::<f32>(call, params, value);
    }

    /// `glGetLightiv`.
    pub fn get_lightiv(&mut self, light: u32, pname: u32, params: usize) {
        let call = "glGetLightiv";
        let value = self.light_value(call, light, pname);
        self.give_value::<i32>(call, params, value);
    }
}

/// The light model and the shade model.
impl Context {
    scalar_call!(light_modelf, "glLightModelf", f32, model_form, exec_light_model);
    scalar_call!(light_modeli, "glLightModeli", i32, model_form, exec_light_model);
    vector_call!(light_modelfv, "glLightModelfv", f32, model_form, exec_light_model);
    vector_call!(light_modeliv, "glLightModeliv", i32, model_form, exec_light_model);

    fn exec_light_model(&mut self, call: &str, pname: u32, values: [f32; 4]) {
        let model = &mut self.state.lighting.model;
        match pname {
            gl::LIGHT_MODEL_AMBIENT => model.ambient = values,
            gl::LIGHT_MODEL_LOCAL_VIEWER => model.local_viewer = values[0] != 0.0,
            gl::LIGHT_MODEL_TWO_SIDE => model.two_side = values[0] != 0.0,
            gl::LIGHT_MODEL_COLOR_CONTROL => {
                let control = token(values[0]);
                if self.check_enum(
                    call,
                    "control",
                    control,
                    &[gl::SINGLE_COLOR, gl::SEPARATE_SPECULAR_COLOR],
                ) {
                    self.state.lighting.model.color_control = control;
                }
            }
            _ => self.refuse_enum(call, "pname", pname),
        }
    }

    /// `glShadeModel`.
    pub fn shade_model(&mut self, mode: u32) {
        self.listable_keeping(move |c| {
            let call = "glShadeModel";
            let allowed =
                c.may_set(call) && c.check_enum(call, "mode", mode, &[gl::FLAT, gl::SMOOTH]);
            if allowed && c.state.lighting.shade_model != mode {
                c.flush_vertices();
                c.state.lighting.shade_model = mode;
            }
        });
    }

    /// `glProvokingVertex`.
    pub fn provoking_vertex(&mut self, mode: u32) {
        self.listable_keeping(move |c| {
            let call = "glProvokingVertex";
            let modes = [gl::FIRST_VERTEX_CONVENTION, gl::LAST_VERTEX_CONVENTION];
            let allowed = c.may_set(call) && c.check_enum(call, "mode", mode, &modes);
            if allowed && c.state.lighting.provoking_vertex != mode {
                c.flush_vertices();
                c.state.lighting.provoking_vertex = mode;
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::testing::{RESULT, context, put, take};

    #[test]
    fn positions_and_directions_are_transformed_at_the_call() {
        let mut c = context();
        c.translatef(1.0, 2.0, 3.0);
        c.rotatef(90.0, 0.0, 0.0, 1.0);
        let at = put(&c, &[1.0_f32, 0.0, 0.0, 1.0]);
        c.lightfv(gl::LIGHT0 + 99, gl::POSITION, at);
        c.lightfv(gl::LIGHT0 + 99, gl::SPOT_DIRECTION, at);
        c.load_identity();
        assert_eq!(c.state.lighting.lights[99].position, [1.0, 3.0, 3.0, 1.0]);
        assert_eq!(c.state.lighting.lights[99].spot_direction, [0.0, 1.0, 0.0]);
        c.get_lightiv(gl::LIGHT0 + 99, gl::POSITION, RESULT);
        assert_eq!(take::<i32, 4>(&c), [1, 3, 3, 1]);
    }

    #[test]
    fn light_errors_change_nothing() {
        let mut c = context();
        let before = c.state.lighting.clone();
        for (light, pname, value, error) in [
            (gl::LIGHT0, gl::SPOT_CUTOFF, 91.0, gl::INVALID_VALUE),
            (gl::LIGHT0, gl::SPOT_EXPONENT, 128.5, gl::INVALID_VALUE),
            (gl::LIGHT0, gl::LINEAR_ATTENUATION, -0.5, gl::INVALID_VALUE),
            (gl::LIGHT0, gl::SPOT_CUTOFF, f32::NAN, gl::INVALID_VALUE),
            (gl::LIGHT0, gl::FOG, 1.0, gl::INVALID_ENUM),
            (gl::LIGHT0 + 128, gl::SPOT_CUTOFF, 1.0, gl::INVALID_ENUM),
        ] {
            c.lightf(light, pname, value);
            assert_eq!(c.get_error(), error);
        }
        c.lightf(gl::LIGHT0, gl::SPOT_CUTOFF, 180.0);
        assert_eq!(c.get_error(), gl::NO_ERROR);
        assert_eq!(c.state.lighting, before);
    }
}
