//! Texture environments: TexEnv and its queries.

use super::arguments::{Form, scalar_call, token, unit, vector_call};
use super::capabilities::index_in;
use super::get::Value;
use crate::state::{Combine, MAX_TEXTURE_UNITS};
use crate::{Context, enums as gl};

const MODES: [u32; 6] = [gl::MODULATE, gl::REPLACE, gl::DECAL, gl::BLEND, gl::ADD, gl::COMBINE];
/// Of RGB; alpha has the first nine.
const FUNCTIONS: [u32; 13] = [
    gl::REPLACE,
    gl::MODULATE,
    gl::ADD,
    gl::ADD_SIGNED,
    gl::INTERPOLATE,
    gl::SUBTRACT,
    gl::MODULATE_ADD_ATI,
    gl::MODULATE_SIGNED_ADD_ATI,
    gl::MODULATE_SUBTRACT_ATI,
    gl::DOT3_RGB,
    gl::DOT3_RGBA,
    gl::DOT3_RGB_EXT,
    gl::DOT3_RGBA_EXT,
];
const SOURCES: [u32; 6] =
    [gl::TEXTURE, gl::CONSTANT, gl::PRIMARY_COLOR, gl::PREVIOUS, gl::ZERO, gl::ONE];
/// Of RGB; alpha has the first two.
const OPERANDS: [u32; 4] =
    [gl::SRC_ALPHA, gl::ONE_MINUS_SRC_ALPHA, gl::SRC_COLOR, gl::ONE_MINUS_SRC_COLOR];

fn form(pname: u32) -> Option<Form> {
    Some(match pname {
        gl::TEXTURE_ENV_COLOR => Form::Color,
        gl::TEXTURE_ENV_MODE
        | gl::TEXTURE_LOD_BIAS
        | gl::COORD_REPLACE_ARB
        | gl::COMBINE_RGB
        | gl::COMBINE_ALPHA
        | gl::RGB_SCALE
        | gl::ALPHA_SCALE => Form::Scalar,
        _ if combine_slot(pname).is_some() => Form::Scalar,
        _ => return None,
    })
}

/// A source or operand of COMBINE.
#[derive(Clone, Copy)]
enum Slot {
    RgbSource(usize),
    AlphaSource(usize),
    RgbOperand(usize),
    AlphaOperand(usize),
}

fn combine_slot(pname: u32) -> Option<Slot> {
    let at = |first, slot: fn(usize) -> Slot| index_in(pname, first, 3).map(slot);
    at(gl::SOURCE0_RGB, Slot::RgbSource)
        .or_else(|| at(gl::SOURCE0_ALPHA, Slot::AlphaSource))
        .or_else(|| at(gl::OPERAND0_RGB, Slot::RgbOperand))
        .or_else(|| at(gl::OPERAND0_ALPHA, Slot::AlphaOperand))
}

fn slot_of(combine: &mut Combine, slot: Slot) -> &mut u32 {
    match slot {
        Slot::RgbSource(i) => &mut combine.rgb_sources[i],
        Slot::AlphaSource(i) => &mut combine.alpha_sources[i],
        Slot::RgbOperand(i) => &mut combine.rgb_operands[i],
        Slot::AlphaOperand(i) => &mut combine.alpha_operands[i],
    }
}

fn accepts(slot: Slot, value: u32) -> bool {
    match slot {
        Slot::RgbSource(_) | Slot::AlphaSource(_) => {
            SOURCES.contains(&value) || index_in(value, gl::TEXTURE0, MAX_TEXTURE_UNITS).is_some()
        }
        Slot::RgbOperand(_) => OPERANDS.contains(&value),
        Slot::AlphaOperand(_) => OPERANDS[..2].contains(&value),
    }
}

/// Whether `pname` is a parameter of `target`; `None` if there is no such target.
fn belongs(target: u32, pname: u32) -> Option<bool> {
    Some(match target {
        gl::TEXTURE_ENV => {
            form(pname).is_some() && !matches!(pname, gl::TEXTURE_LOD_BIAS | gl::COORD_REPLACE_ARB)
        }
        gl::TEXTURE_FILTER_CONTROL => pname == gl::TEXTURE_LOD_BIAS,
        gl::POINT_SPRITE_ARB => pname == gl::COORD_REPLACE_ARB,
        _ => return None,
    })
}

impl Context {
    scalar_call!(tex_envf, "glTexEnvf", f32, form, exec_tex_env, target);
    scalar_call!(tex_envi, "glTexEnvi", i32, form, exec_tex_env, target);
    vector_call!(tex_envfv, "glTexEnvfv", f32, form, exec_tex_env, target);
    vector_call!(tex_enviv, "glTexEnviv", i32, form, exec_tex_env, target);

    /// Whether target and name go together; else records the error.
    fn check_tex_env(&mut self, call: &str, target: u32, pname: u32) -> bool {
        match belongs(target, pname) {
            Some(true) => return true,
            Some(false) => self.refuse_enum(call, "pname", pname),
            None => self.refuse_enum(call, "target", target),
        }
        false
    }

    fn exec_tex_env(&mut self, call: &str, target: u32, pname: u32, values: [f32; 4]) {
        if !self.check_tex_env(call, target, pname) {
            return;
        }
        let value = values[0];
        let environment = &mut self.state.units[self.state.active_unit].environment;
        match pname {
            gl::TEXTURE_ENV_COLOR => environment.color = values.map(unit),
            gl::TEXTURE_LOD_BIAS => environment.lod_bias = value,
            gl::COORD_REPLACE_ARB if value == 0.0 || value == 1.0 => {
                environment.coord_replace = value == 1.0
            }
            gl::COORD_REPLACE_ARB => {
                self.refuse_value(call, "the value is neither GL_TRUE nor GL_FALSE")
            }
            gl::RGB_SCALE | gl::ALPHA_SCALE if [1.0, 2.0, 4.0].contains(&value) => {
                environment.combine.scale[usize::from(pname == gl::ALPHA_SCALE)] = value;
            }
            gl::RGB_SCALE | gl::ALPHA_SCALE => {
                self.refuse_value(call, "the scale is not 1, 2 or 4")
            }
            _ => self.set_environment_token(call, pname, token(value)),
        }
    }

    fn set_environment_token(&mut self, call: &str, pname: u32, value: u32) {
        let environment = &mut self.state.units[self.state.active_unit].environment;
        let (good, field) = match (pname, combine_slot(pname)) {
            (_, Some(slot)) => (accepts(slot, value), slot_of(&mut environment.combine, slot)),
            (gl::COMBINE_RGB, _) => {
                (FUNCTIONS.contains(&value), &mut environment.combine.functions[0])
            }
            (gl::COMBINE_ALPHA, _) => {
                (FUNCTIONS[..9].contains(&value), &mut environment.combine.functions[1])
            }
            _ => (MODES.contains(&value), &mut environment.mode),
        };
        if good {
            *field = value;
        } else {
            self.refuse_enum(call, "param", value);
        }
    }

    fn environment_value(&mut self, call: &str, target: u32, pname: u32) -> Option<Value> {
        if !self.may_set(call) || !self.check_tex_env(call, target, pname) {
            return None;
        }
        let environment = &mut self.state.units[self.state.active_unit].environment;
        let combine = &mut environment.combine;
        Some(match pname {
            gl::TEXTURE_ENV_COLOR => Value::normalized(&environment.color),
            gl::TEXTURE_LOD_BIAS => Value::float(environment.lod_bias),
            gl::COORD_REPLACE_ARB => Value::boolean(environment.coord_replace),
            gl::RGB_SCALE => Value::float(combine.scale[0]),
            gl::ALPHA_SCALE => Value::float(combine.scale[1]),
            gl::COMBINE_RGB => Value::token(combine.functions[0]),
            gl::COMBINE_ALPHA => Value::token(combine.functions[1]),
            _ => match combine_slot(pname) {
                Some(slot) => Value::token(*slot_of(combine, slot)),
                None => Value::token(environment.mode),
            },
        })
    }

    /// `glGetTexEnvfv`.
    pub fn get_tex_envfv(&mut self, target: u32, pname: u32, params: usize) {
        let value = self.environment_value("glGetTexEnvfv", target, pname);
        self.give_value::<f32>("glGetTexEnvfv", params, value);
    }

    /// `glGetTexEnviv`.
    pub fn get_tex_enviv(&mut self, target: u32, pname: u32, params: usize) {
        let value = self.environment_value("glGetTexEnviv", target, pname);
        self.give_value::<i32>("glGetTexEnviv", params, value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::testing::{RESULT, context, put, take};
    use crate::state::TextureEnvironment;

    fn queried(c: &mut Context, pname: u32) -> u32 {
        c.get_tex_enviv(gl::TEXTURE_ENV, pname, RESULT);
        take::<i32, 1>(c)[0] as u32
    }

    #[test]
    fn what_is_set_is_got() {
        let mut c = context();
        for (pname, value) in [
            (gl::TEXTURE_ENV_MODE, gl::COMBINE),
            (gl::COMBINE_RGB, gl::DOT3_RGBA),
            (gl::COMBINE_ALPHA, gl::SUBTRACT),
            (gl::SOURCE2_RGB, gl::TEXTURE0 + 7),
            (gl::SOURCE0_ALPHA, gl::PRIMARY_COLOR),
            (gl::OPERAND1_RGB, gl::ONE_MINUS_SRC_COLOR),
            (gl::OPERAND2_ALPHA, gl::ONE_MINUS_SRC_ALPHA),
            (gl::RGB_SCALE, 4),
        ] {
            c.tex_envi(gl::TEXTURE_ENV, pname, value as i32);
            assert_eq!(queried(&mut c, pname), value);
        }
        let at = put(&c, &[0.5_f32, 2.0, -1.0, 1.0]);
        c.tex_envfv(gl::TEXTURE_ENV, gl::TEXTURE_ENV_COLOR, at);
        c.get_tex_envfv(gl::TEXTURE_ENV, gl::TEXTURE_ENV_COLOR, RESULT);
        assert_eq!(take::<f32, 4>(&c), [0.5, 1.0, 0.0, 1.0]);
        c.tex_envi(gl::POINT_SPRITE_ARB, gl::COORD_REPLACE_ARB, 1);
        c.tex_envf(gl::TEXTURE_FILTER_CONTROL, gl::TEXTURE_LOD_BIAS, -2.5);
        assert_eq!(c.state.units[0].environment.lod_bias, -2.5);
        assert!(c.state.units[0].environment.coord_replace);
        assert_eq!(c.get_error(), gl::NO_ERROR);
    }

    #[test]
    fn errors_change_nothing() {
        let mut c = context();
        for (target, pname, value, error) in [
            (gl::TEXTURE_2D, gl::TEXTURE_ENV_MODE, gl::ADD, gl::INVALID_ENUM),
            (gl::TEXTURE_ENV, gl::TEXTURE_LOD_BIAS, 0, gl::INVALID_ENUM),
            (gl::TEXTURE_ENV, gl::TEXTURE_ENV_MODE, gl::SUBTRACT, gl::INVALID_ENUM),
            (gl::TEXTURE_ENV, gl::COMBINE_ALPHA, gl::DOT3_RGB, gl::INVALID_ENUM),
            (gl::TEXTURE_ENV, gl::SOURCE0_RGB, gl::TEXTURE8, gl::INVALID_ENUM),
            (gl::TEXTURE_ENV, gl::OPERAND0_ALPHA, gl::SRC_COLOR, gl::INVALID_ENUM),
            (gl::TEXTURE_ENV, gl::ALPHA_SCALE, 3, gl::INVALID_VALUE),
            (gl::POINT_SPRITE_ARB, gl::COORD_REPLACE_ARB, 2, gl::INVALID_VALUE),
        ] {
            c.tex_envi(target, pname, value as i32);
            assert_eq!(c.get_error(), error, "{pname:x}");
        }
        assert_eq!(c.state.units[0].environment, TextureEnvironment::default());
    }
}
