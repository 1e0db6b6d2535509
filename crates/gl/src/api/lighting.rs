//! Lights, the light model, materials.

use super::arguments::{Form, scalar_call, token, vector_call};
use super::capabilities::index_in;
use super::get::Value;
use crate::state::{Light, MAX_LIGHTS, MaterialFace};
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
        gl::LIGHT_MODEL_LOCAL_VIEWER | gl::LIGHT_MODEL_TWO_SIDE | gl::LIGHT_MODEL_COLOR_CONTROL => Form::Scalar,
        _ => return None,
    })
}

fn material_form(pname: u32) -> Option<Form> {
    Some(match pname {
        gl::AMBIENT | gl::DIFFUSE | gl::SPECULAR | gl::EMISSION | gl::AMBIENT_AND_DIFFUSE => Form::Color,
        gl::SHININESS => Form::Scalar,
        gl::COLOR_INDEXES => Form::Vector(3),
        _ => return None,
    })
}

/// Front, back: whether `face` names them; `None` if it is no face.
pub(super) fn faces(face: u32) -> Option<[bool; 2]> {
    Some(match face {
        gl::FRONT => [true, false],
        gl::BACK => [false, true],
        gl::FRONT_AND_BACK => [true, true],
        _ => return None,
    })
}

/// Whether `COLOR_MATERIAL_PARAMETER` `mode` covers the material parameter `pname`.
fn covers(mode: u32, pname: u32) -> bool {
    mode == pname || (mode == gl::AMBIENT_AND_DIFFUSE && matches!(pname, gl::AMBIENT | gl::DIFFUSE))
}

/// The colours that the material parameter `pname` names.
fn set_colors(face: &mut MaterialFace, pname: u32, color: [f32; 4]) {
    match pname {
        gl::AMBIENT => face.ambient = color,
        gl::DIFFUSE => face.diffuse = color,
        gl::SPECULAR => face.specular = color,
        gl::EMISSION => face.emission = color,
        _ => {
            face.ambient = color;
            face.diffuse = color;
        }
    }
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
        let [value, ..] = values;
        let good = match pname {
            gl::SPOT_EXPONENT => (0.0..=128.0).contains(&value),
            gl::SPOT_CUTOFF => (0.0..=90.0).contains(&value) || value == 180.0,
            gl::CONSTANT_ATTENUATION | gl::LINEAR_ATTENUATION | gl::QUADRATIC_ATTENUATION => value >= 0.0,
            _ => true,
        };
        if !good {
            return self.refuse_value(call, "the value is out of range");
        }
        let position = self.modelview64() * dvec4(value.into(), values[1].into(), values[2].into(), values[3].into());
        let direction = DMat3::from_mat4(self.modelview64()) * dvec3(value.into(), values[1].into(), values[2].into());
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
                if self.check_enum(call, "control", control, &[gl::SINGLE_COLOR, gl::SEPARATE_SPECULAR_COLOR]) {
                    self.state.lighting.model.color_control = control;
                }
            }
            _ => self.refuse_enum(call, "pname", pname),
        }
    }

    /// `glShadeModel`.
    pub fn shade_model(&mut self, mode: u32) {
        self.listable(move |c| {
            let call = "glShadeModel";
            if c.may_set(call) && c.check_enum(call, "mode", mode, &[gl::FLAT, gl::SMOOTH]) {
                c.state.lighting.shade_model = mode;
            }
        });
    }
}

/// A material setter: allowed between Begin and End.
macro_rules! material_call {
    ($name:ident, $call:literal, scalar $type:ty) => {
        #[doc = concat!("`", $call, "`.")]
        pub fn $name(&mut self, face: u32, pname: u32, param: $type) {
            let value = super::arguments::Number::plain(param);
            self.listable(move |c| match material_form(pname) {
                Some(Form::Scalar) => c.exec_material($call, face, pname, [value; 4]),
                _ => c.refuse_enum($call, "pname", pname),
            });
        }
    };
    ($name:ident, $call:literal, vector $type:ty) => {
        #[doc = concat!("`", $call, "`.")]
        pub fn $name(&mut self, face: u32, pname: u32, params: usize) {
            use super::arguments::Number;
            let form = material_form(pname);
            let Some(given) = self.take_arguments::<$type, 4>($call, params, Form::count(form)) else { return };
            let values =
                if form == Some(Form::Color) { given.map(Number::normalized) } else { given.map(Number::plain) };
            self.listable(move |c| c.exec_material($call, face, pname, values));
        }
    };
}

/// Materials.
impl Context {
    material_call!(materialf, "glMaterialf", scalar f32);
    material_call!(materiali, "glMateriali", scalar i32);
    material_call!(materialfv, "glMaterialfv", vector f32);
    material_call!(materialiv, "glMaterialiv", vector i32);

    /// Parameters that follow the current colour are not changed.
    fn exec_material(&mut self, call: &str, face: u32, pname: u32, values: [f32; 4]) {
        let Some(chosen) = faces(face) else { return self.refuse_enum(call, "face", face) };
        if material_form(pname).is_none() {
            return self.refuse_enum(call, "pname", pname);
        }
        if pname == gl::SHININESS && !(0.0..=128.0).contains(&values[0]) {
            return self.refuse_value(call, "the exponent is not in 0..=128");
        }
        let tracked = self.state.lighting.color_material;
        let tracked_faces = faces(tracked.face).filter(|_| tracked.enabled).unwrap_or([false; 2]);
        for side in (0..2).filter(|side| chosen[*side]) {
            let material = &mut self.state.lighting.material[side];
            match pname {
                gl::SHININESS => material.shininess = values[0],
                gl::COLOR_INDEXES => material.indexes = [values[0], values[1], values[2]],
                gl::AMBIENT_AND_DIFFUSE => {
                    for pname in [gl::AMBIENT, gl::DIFFUSE] {
                        if !(tracked_faces[side] && covers(tracked.mode, pname)) {
                            set_colors(material, pname, values);
                        }
                    }
                }
                _ if tracked_faces[side] && covers(tracked.mode, pname) => {}
                _ => set_colors(material, pname, values),
            }
        }
        self.material_changed();
    }

    /// Copies the current colour to the material parameters that follow it.
    pub(crate) fn track_color_material(&mut self) {
        let tracked = self.state.lighting.color_material;
        let Some(chosen) = faces(tracked.face).filter(|_| tracked.enabled) else { return };
        for side in (0..2).filter(|side| chosen[*side]) {
            set_colors(&mut self.state.lighting.material[side], tracked.mode, self.state.current.color);
        }
    }

    /// `glColorMaterial`.
    pub fn color_material(&mut self, face: u32, mode: u32) {
        self.listable(move |c| {
            let call = "glColorMaterial";
            let modes = [gl::EMISSION, gl::AMBIENT, gl::DIFFUSE, gl::SPECULAR, gl::AMBIENT_AND_DIFFUSE];
            if !c.may_set(call)
                || !c.check_enum(call, "face", face, &[gl::FRONT, gl::BACK, gl::FRONT_AND_BACK])
                || !c.check_enum(call, "mode", mode, &modes)
            {
                return;
            }
            // What was tracked until now keeps the colour.
            c.track_color_material();
            c.state.lighting.color_material.face = face;
            c.state.lighting.color_material.mode = mode;
            c.track_color_material();
            c.material_changed();
        });
    }

    fn material_value(&mut self, call: &str, face: u32, pname: u32) -> Option<Value> {
        if !self.may_set(call) || !self.check_enum(call, "face", face, &[gl::FRONT, gl::BACK]) {
            return None;
        }
        self.track_color_material();
        let material = &self.state.lighting.material[usize::from(face == gl::BACK)];
        Some(match pname {
            gl::AMBIENT => Value::normalized(&material.ambient),
            gl::DIFFUSE => Value::normalized(&material.diffuse),
            gl::SPECULAR => Value::normalized(&material.specular),
            gl::EMISSION => Value::normalized(&material.emission),
            gl::SHININESS => Value::float(material.shininess),
            gl::COLOR_INDEXES => Value::floats(&material.indexes),
            _ => {
                self.refuse_enum(call, "pname", pname);
                return None;
            }
        })
    }

    /// `glGetMaterialfv`.
    pub fn get_materialfv(&mut self, face: u32, pname: u32, params: usize) {
        let call = "glGetMaterialfv";
        let value = self.material_value(call, face, pname);
        self.give_value::<f32>(call, params, value);
    }

    /// `glGetMaterialiv`.
    pub fn get_materialiv(&mut self, face: u32, pname: u32, params: usize) {
        let call = "glGetMaterialiv";
        let value = self.material_value(call, face, pname);
        self.give_value::<i32>(call, params, value);
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
            (gl::LIGHT0, gl::POSITION, 1.0, gl::INVALID_ENUM),
            (gl::LIGHT0 + 128, gl::SPOT_CUTOFF, 1.0, gl::INVALID_ENUM),
        ] {
            c.lightf(light, pname, value);
            assert_eq!(c.get_error(), error);
        }
        c.lightf(gl::LIGHT0, gl::SPOT_CUTOFF, 180.0);
        assert_eq!(c.get_error(), gl::NO_ERROR);
        assert_eq!(c.state.lighting, before);
    }

    #[test]
    fn materials_follow_the_color() {
        let mut c = context();
        c.state.current.color = [0.1, 0.2, 0.3, 0.4];
        c.color_material(gl::FRONT, gl::DIFFUSE);
        c.enable(gl::COLOR_MATERIAL);
        assert_eq!(c.state.lighting.material[0].diffuse, [0.1, 0.2, 0.3, 0.4]);
        assert_eq!(c.state.lighting.material[1].diffuse, [0.8, 0.8, 0.8, 1.0]);
        let at = put(&c, &[1.0_f32; 4]);
        c.materialfv(gl::FRONT_AND_BACK, gl::AMBIENT_AND_DIFFUSE, at);
        assert_eq!(c.state.lighting.material[0].diffuse, [0.1, 0.2, 0.3, 0.4]);
        assert_eq!(c.state.lighting.material[0].ambient, [1.0; 4]);
        assert_eq!(c.state.lighting.material[1].diffuse, [1.0; 4]);
        c.state.current.color = [0.5; 4];
        c.disable(gl::COLOR_MATERIAL);
        c.state.current.color = [0.7; 4];
        c.get_materialfv(gl::FRONT, gl::DIFFUSE, RESULT);
        assert_eq!(take::<f32, 4>(&c), [0.5; 4]);
    }

    #[test]
    fn material_errors() {
        let mut c = context();
        c.materialf(gl::FRONT, gl::SHININESS, 129.0);
        assert_eq!(c.get_error(), gl::INVALID_VALUE);
        c.materialf(gl::FRONT, gl::AMBIENT, 1.0);
        assert_eq!(c.get_error(), gl::INVALID_ENUM);
        c.materialf(gl::LEFT, gl::SHININESS, 1.0);
        assert_eq!(c.get_error(), gl::INVALID_ENUM);
        c.get_materialfv(gl::FRONT_AND_BACK, gl::AMBIENT, RESULT);
        assert_eq!(c.get_error(), gl::INVALID_ENUM);
    }
}
