//! Materials, and how they follow the current colour.

use super::arguments::{Form, Number};
use super::get::Value;
use crate::state::MaterialFace;
use crate::{Context, enums as gl};

fn material_form(pname: u32) -> Option<Form> {
    Some(match pname {
        gl::AMBIENT | gl::DIFFUSE | gl::SPECULAR | gl::EMISSION | gl::AMBIENT_AND_DIFFUSE => {
            Form::Color
        }
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

/// A material setter: allowed between Begin and End.
macro_rules! material_call {
    ($name:ident, $call:literal, scalar $type:ty) => {
        #[doc = concat!("`", $call, "`.")]
        pub fn $name(&mut self, face: u32, pname: u32, param: $type) {
            let values = [Number::plain(param), 0.0, 0.0, 0.0];
            self.listable_keeping(move |c| c.exec_material($call, face, pname, values));
        }
    };
    ($name:ident, $call:literal, vector $type:ty) => {
        #[doc = concat!("`", $call, "`.")]
        pub fn $name(&mut self, face: u32, pname: u32, params: usize) {
            let form = material_form(pname);
            let Some(given) = self.take_arguments::<$type, 4>($call, params, Form::count(form))
            else {
                return;
            };
            let values = if form == Some(Form::Color) {
                given.map(Number::normalized)
            } else {
                given.map(Number::plain)
            };
            self.listable_keeping(move |c| c.exec_material($call, face, pname, values));
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

        // Find the parameters that follow the current colour.
        let tracked = self.state.lighting.color_material;
        let tracked_faces = faces(tracked.face).filter(|_| tracked.enabled).unwrap_or([false; 2]);

        // Store the value on each chosen face.
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
            set_colors(
                &mut self.state.lighting.material[side],
                tracked.mode,
                self.state.current.color,
            );
        }
    }

    /// `glColorMaterial`.
    pub fn color_material(&mut self, face: u32, mode: u32) {
        self.listable(move |c| {
            let call = "glColorMaterial";
            let modes =
                [gl::EMISSION, gl::AMBIENT, gl::DIFFUSE, gl::SPECULAR, gl::AMBIENT_AND_DIFFUSE];
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
        c.materialf(gl::FRONT, gl::FOG, 1.0);
        assert_eq!(c.get_error(), gl::INVALID_ENUM);
        c.materialf(gl::LEFT, gl::SHININESS, 1.0);
        assert_eq!(c.get_error(), gl::INVALID_ENUM);
        c.get_materialfv(gl::FRONT_AND_BACK, gl::AMBIENT, RESULT);
        assert_eq!(c.get_error(), gl::INVALID_ENUM);
    }
}
