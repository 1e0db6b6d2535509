//! Texture coordinate generation: TexGen and its queries.

use super::arguments::{Form, scalar_call, token, vector_call};
use super::capabilities::index_in;
use super::get::Value;
use crate::{Context, enums as gl};

fn form(pname: u32) -> Option<Form> {
    Some(match pname {
        gl::TEXTURE_GEN_MODE => Form::Scalar,
        gl::OBJECT_PLANE | gl::EYE_PLANE => Form::Vector(4),
        _ => return None,
    })
}

/// Whether coordinate `index` (s, t, r, q) may be generated so.
fn accepts(index: usize, mode: u32) -> bool {
    match mode {
        gl::OBJECT_LINEAR | gl::EYE_LINEAR => true,
        gl::SPHERE_MAP => index < 2,
        gl::REFLECTION_MAP | gl::NORMAL_MAP => index < 3,
        _ => false,
    }
}

impl Context {
    scalar_call!(tex_gend, "glTexGend", f64, form, exec_tex_gen, coord);
    scalar_call!(tex_genf, "glTexGenf", f32, form, exec_tex_gen, coord);
    scalar_call!(tex_geni, "glTexGeni", i32, form, exec_tex_gen, coord);
    vector_call!(tex_gendv, "glTexGendv", f64, form, exec_tex_gen, coord);
    vector_call!(tex_genfv, "glTexGenfv", f32, form, exec_tex_gen, coord);
    vector_call!(tex_geniv, "glTexGeniv", i32, form, exec_tex_gen, coord);

    fn exec_tex_gen(&mut self, call: &str, coord: u32, pname: u32, values: [f32; 4]) {
        let Some(index) = index_in(coord, gl::S, 4) else {
            return self.refuse_enum(call, "coord", coord);
        };
        let unit = self.state.active_unit;
        match pname {
            gl::TEXTURE_GEN_MODE => {
                let mode = token(values[0]);
                if accepts(index, mode) {
                    self.state.units[unit].generation[index].mode = mode;
                } else {
                    self.refuse_enum(call, "param", mode);
                }
            }
            gl::OBJECT_PLANE => self.state.units[unit].generation[index].object_plane = values,
            gl::EYE_PLANE => {
                let plane = self.eye_plane(values.map(f64::from));
                self.state.units[unit].generation[index].eye_plane = plane.map(|v| v as f32);
            }
            _ => self.refuse_enum(call, "pname", pname),
        }
    }

    fn generation_value(&mut self, call: &str, coord: u32, pname: u32) -> Option<Value> {
        if !self.may_set(call) {
            return None;
        }
        let Some(index) = index_in(coord, gl::S, 4) else {
            self.refuse_enum(call, "coord", coord);
            return None;
        };
        let generation = &self.state.units[self.state.active_unit].generation[index];
        Some(match pname {
            gl::TEXTURE_GEN_MODE => Value::token(generation.mode),
            gl::OBJECT_PLANE => Value::floats(&generation.object_plane),
            gl::EYE_PLANE => Value::floats(&generation.eye_plane),
            _ => {
                self.refuse_enum(call, "pname", pname);
                return None;
            }
        })
    }

    /// `glGetTexGendv`.
    pub fn get_tex_gendv(&mut self, coord: u32, pname: u32, params: usize) {
        let value = self.generation_value("glGetTexGendv", coord, pname);
        self.give_value::<f64>("glGetTexGendv", params, value);
    }

    /// `glGetTexGenfv`.
    pub fn get_tex_genfv(&mut self, coord: u32, pname: u32, params: usize) {
        let value = self.generation_value("glGetTexGenfv", coord, pname);
        self.give_value::<f32>("glGetTexGenfv", params, value);
    }

    /// `glGetTexGeniv`.
    pub fn get_tex_geniv(&mut self, coord: u32, pname: u32, params: usize) {
        let value = self.generation_value("glGetTexGeniv", coord, pname);
        self.give_value::<i32>("glGetTexGeniv", params, value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::testing::{RESULT, context, put, take};

    #[test]
    fn eye_planes_are_transformed_at_the_call() {
        let mut c = context();
        c.translatef(10.0, 0.0, 0.0);
        let at = put(&c, &[1.0_f64, 0.0, 0.0, 2.0]);
        c.tex_gendv(gl::S, gl::EYE_PLANE, at);
        c.tex_gendv(gl::S, gl::OBJECT_PLANE, at);
        c.load_identity();
        c.get_tex_gendv(gl::S, gl::EYE_PLANE, RESULT);
        assert_eq!(take::<f64, 4>(&c), [1.0, 0.0, 0.0, -8.0]);
        c.get_tex_geniv(gl::S, gl::OBJECT_PLANE, RESULT);
        assert_eq!(take::<i32, 4>(&c), [1, 0, 0, 2]);
    }

    #[test]
    fn modes_by_coordinate() {
        let mut c = context();
        let allowed = [
            (gl::OBJECT_LINEAR, 4),
            (gl::EYE_LINEAR, 4),
            (gl::SPHERE_MAP, 2),
            (gl::REFLECTION_MAP, 3),
            (gl::NORMAL_MAP, 3),
            (gl::REPEAT, 0),
        ];
        for (mode, count) in allowed {
            for i in 0..4 {
                c.tex_geni(gl::S + i, gl::TEXTURE_GEN_MODE, mode as i32);
                assert_eq!(c.get_error(), if i < count { gl::NO_ERROR } else { gl::INVALID_ENUM });
            }
        }
        c.tex_genf(gl::S, gl::FOG, 1.0);
        assert_eq!(c.get_error(), gl::INVALID_ENUM);
        c.tex_geni(gl::S + 4, gl::TEXTURE_GEN_MODE, gl::EYE_LINEAR as i32);
        assert_eq!(c.get_error(), gl::INVALID_ENUM);
    }
}
