//! ARB_sampler_objects: how textures are looked up, apart from the textures. A sampler bound to a
//! unit replaces the parameters of whatever texture the unit samples.
//!
//! Source: the ARB_sampler_objects specification.

use super::image::lock;
use super::tex_parameter::{Value, get, integers, read_vector, set};
use super::texture::{TextureParameters, slot};
use crate::Context;
use crate::enums::*;
use crate::state::MAX_TEXTURE_UNITS;
use std::sync::{Arc, Mutex};

/// A sampler object that units share.
pub(crate) type SamplerHandle = Arc<Mutex<SamplerObject>>;

/// A sampler object. Parameters that are the texture's alone keep their initial values.
#[derive(Debug)]
pub(crate) struct SamplerObject {
    /// Name.
    pub name: u32,
    /// `SamplerParameter`.
    pub parameters: TextureParameters,
}

/// Whether a texture's parameter is a sampler's too.
fn is_parameter(pname: u32) -> bool {
    matches!(
        pname,
        TEXTURE_WRAP_S
            | TEXTURE_WRAP_T
            | TEXTURE_WRAP_R
            | TEXTURE_MIN_FILTER
            | TEXTURE_MAG_FILTER
            | TEXTURE_BORDER_COLOR
            | TEXTURE_MIN_LOD
            | TEXTURE_MAX_LOD
            | TEXTURE_LOD_BIAS
            | TEXTURE_COMPARE_MODE
            | TEXTURE_COMPARE_FUNC
            | TEXTURE_MAX_ANISOTROPY_EXT
    )
}

impl Context {
    /// `glGenSamplers`.
    pub fn gen_samplers(&mut self, count: i32, samplers: usize) {
        let Some(count) = self.name_count("glGenSamplers", count) else { return };
        let names = {
            let mut objects = lock(&self.shared.samplers);
            let names = self.shared.names.generate(&mut objects, count);
            for &name in &names {
                let object = SamplerObject { name, parameters: TextureParameters::new(slot::TWO) };
                objects.insert(name, Some(Arc::new(Mutex::new(object))));
            }
            names
        };
        self.write_names(&names, samplers);
    }

    /// `glDeleteSamplers`. Units that it is bound to in this context are left without.
    pub fn delete_samplers(&mut self, count: i32, samplers: usize) {
        const CALL: &str = "glDeleteSamplers";
        if !self.outside_begin(CALL) {
            return;
        }
        for name in self.read_names(CALL, count, samplers) {
            if lock(&self.shared.samplers).remove(&name).is_none() {
                continue;
            }
            self.forget_label(SAMPLER, name);
            for unit in 0..MAX_TEXTURE_UNITS {
                if self.sampler_name(unit) == name {
                    self.textures.samplers[unit] = None;
                }
            }
        }
    }

    /// `glIsSampler`.
    pub fn is_sampler(&mut self, sampler: u32) -> u8 {
        u8::from(
            self.outside_begin("glIsSampler") && lock(&self.shared.samplers).contains_key(&sampler),
        )
    }

    /// `glBindSampler`.
    pub fn bind_sampler(&mut self, unit: u32, sampler: u32) {
        self.listable(move |c| c.exec_bind_sampler(unit, sampler));
    }

    fn exec_bind_sampler(&mut self, unit: u32, sampler: u32) {
        const CALL: &str = "glBindSampler";
        if !self.outside_begin(CALL) {
            return;
        }
        let found = lock(&self.shared.samplers).get(&sampler).cloned().flatten();
        if unit as usize >= MAX_TEXTURE_UNITS {
            self.record_error(INVALID_VALUE, CALL, "there is no such unit");
        } else if sampler != 0 && found.is_none() {
            self.record_error(
                INVALID_OPERATION,
                CALL,
                "sampler is not a name that glGenSamplers gave",
            );
        } else {
            self.textures.samplers[unit as usize] = found;
        }
    }

    /// `SAMPLER_BINDING` of a unit.
    pub(crate) fn sampler_name(&self, unit: usize) -> u32 {
        self.textures.samplers[unit].as_ref().map_or(0, |sampler| lock(sampler).name)
    }

    fn sampler(&mut self, call: &str, name: u32, pname: u32) -> Option<SamplerHandle> {
        if !self.outside_begin(call) {
            return None;
        }
        let found = lock(&self.shared.samplers).get(&name).cloned().flatten();
        if found.is_none() {
            self.record_error(INVALID_OPERATION, call, "sampler is not a sampler object");
        } else if !is_parameter(pname) {
            self.record_error(INVALID_ENUM, call, "pname is not a parameter of samplers");
            return None;
        }
        found
    }

    fn sampler_parameter(
        &mut self,
        call: &'static str,
        name: u32,
        pname: u32,
        value: Option<Value>,
    ) {
        self.listable(move |c| c.exec_sampler_parameter(call, name, pname, value));
    }

    fn exec_sampler_parameter(&mut self, call: &str, name: u32, pname: u32, value: Option<Value>) {
        let (Some(sampler), Some(value)) = (self.sampler(call, name, pname), value) else { return };
        let result = set(&mut lock(&sampler).parameters, slot::TWO, pname, value);
        if let Err((error, why)) = result {
            self.record_error(error, call, why);
        }
    }

    /// `glSamplerParameteri`.
    pub fn sampler_parameteri(&mut self, sampler: u32, pname: u32, param: i32) {
        self.sampler_parameter("glSamplerParameteri", sampler, pname, Some(Value::Int(param)));
    }

    /// `glSamplerParameterf`.
    pub fn sampler_parameterf(&mut self, sampler: u32, pname: u32, param: f32) {
        self.sampler_parameter("glSamplerParameterf", sampler, pname, Some(Value::Float(param)));
    }

    /// `glSamplerParameteriv`.
    pub fn sampler_parameteriv(&mut self, sampler: u32, pname: u32, param: usize) {
        let value = read_vector(&*self.memory, pname, param).map(Value::Ints);
        self.sampler_parameter("glSamplerParameteriv", sampler, pname, value);
    }

    /// `glSamplerParameterfv`.
    pub fn sampler_parameterfv(&mut self, sampler: u32, pname: u32, param: usize) {
        let value = read_vector(&*self.memory, pname, param).map(Value::Floats);
        self.sampler_parameter("glSamplerParameterfv", sampler, pname, value);
    }

    /// As `glSamplerParameteriv`, but a border colour is of integers that no format here has: they
    /// are converted.
    pub fn sampler_parameter_iiv(&mut self, sampler: u32, pname: u32, param: usize) {
        let value = read_vector(&*self.memory, pname, param).map(|v: [i32; 4]| match pname {
            TEXTURE_BORDER_COLOR => Value::Floats(v.map(|v| v as f32)),
            _ => Value::Ints(v),
        });
        self.sampler_parameter("glSamplerParameterIiv", sampler, pname, value);
    }

    /// As [`Self::sampler_parameter_iiv`], unsigned.
    pub fn sampler_parameter_iuiv(&mut self, sampler: u32, pname: u32, param: usize) {
        let value = read_vector(&*self.memory, pname, param).map(|v: [u32; 4]| match pname {
            TEXTURE_BORDER_COLOR => Value::Floats(v.map(|v| v as f32)),
            _ => Value::Ints(v.map(|v| v as i32)),
        });
        self.sampler_parameter("glSamplerParameterIuiv", sampler, pname, value);
    }

    fn get_sampler(&mut self, call: &str, sampler: u32, pname: u32) -> Option<(Vec<f64>, bool)> {
        let sampler = self.sampler(call, sampler, pname)?;
        let sampler = lock(&sampler);
        get(&sampler.parameters, pname)
    }

    /// `glGetSamplerParameterfv`.
    pub fn get_sampler_parameterfv(&mut self, sampler: u32, pname: u32, params: usize) {
        let Some((values, _)) = self.get_sampler("glGetSamplerParameterfv", sampler, pname) else {
            return;
        };
        let values: Vec<f32> = values.iter().map(|&v| v as f32).collect();
        self.give_numbers(params, &values);
    }

    /// `glGetSamplerParameteriv`.
    pub fn get_sampler_parameteriv(&mut self, sampler: u32, pname: u32, params: usize) {
        let Some(found) = self.get_sampler("glGetSamplerParameteriv", sampler, pname) else {
            return;
        };
        self.give_numbers(params, &integers(found));
    }

    /// As `glGetSamplerParameteriv`, without converting a border colour.
    pub fn get_sampler_parameter_iiv(&mut self, sampler: u32, pname: u32, params: usize) {
        let Some((values, _)) = self.get_sampler("glGetSamplerParameterIiv", sampler, pname) else {
            return;
        };
        self.give_numbers(params, &integers((values, false)));
    }

    /// As [`Self::get_sampler_parameter_iiv`], unsigned.
    pub fn get_sampler_parameter_iuiv(&mut self, sampler: u32, pname: u32, params: usize) {
        let Some((values, _)) = self.get_sampler("glGetSamplerParameterIuiv", sampler, pname)
        else {
            return;
        };
        let values: Vec<u32> = values.into_iter().map(|v| v.round() as u32).collect();
        self.give_numbers(params, &values);
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{BASE, context, read_u32};
    use super::*;

    #[test]
    fn a_sampler_replaces_the_textures_parameters_while_it_is_bound() {
        let mut c = context();
        c.tex_image_2d(TEXTURE_2D, 0, RGBA as i32, 4, 4, 0, RGBA, UNSIGNED_BYTE, 0);
        c.enable(TEXTURE_2D);
        // Without mipmaps the texture is not complete for its own filter.
        assert!(c.sampled_texture(0).is_none());
        c.gen_samplers(1, BASE);
        let sampler = read_u32(&c, BASE);
        c.sampler_parameteri(sampler, TEXTURE_MIN_FILTER, NEAREST as i32);
        c.bind_sampler(0, sampler);
        let with = c.sampled_texture(0).unwrap();
        assert_eq!(with.sampler.min, vitral_raster::forward::Filter::Nearest);
        assert!(Arc::ptr_eq(&with, &c.sampled_texture(0).unwrap()));
        c.sampler_parameterf(sampler, TEXTURE_LOD_BIAS, 2.0);
        assert_eq!(c.texture_lod_bias(0), 2.0);
        c.get_integerv(SAMPLER_BINDING, BASE);
        assert_eq!((read_u32(&c, BASE), c.error), (sampler, NO_ERROR));
        crate::pixels::testing::put(&c, BASE, &sampler.to_ne_bytes());
        c.delete_samplers(1, BASE);
        assert!(c.sampled_texture(0).is_none());
        assert_eq!(c.is_sampler(sampler), 0);
    }

    #[test]
    fn lists_hold_samplers_and_their_parameters() {
        let mut c = context();
        c.gen_samplers(1, BASE);
        let sampler = read_u32(&c, BASE);
        c.new_list(1, COMPILE);
        c.bind_sampler(2, sampler);
        c.sampler_parameteri(sampler, TEXTURE_WRAP_S, CLAMP_TO_EDGE as i32);
        crate::pixels::testing::put(&c, BASE, &2.0f32.to_ne_bytes());
        c.sampler_parameterfv(sampler, TEXTURE_LOD_BIAS, BASE);
        c.sampler_parameteri(sampler, TEXTURE_BASE_LEVEL, 0);
        c.end_list();
        crate::pixels::testing::put(&c, BASE, &[0; 4]);
        let wrap = |c: &mut Context| {
            c.get_sampler_parameteriv(sampler, TEXTURE_WRAP_S, BASE);
            read_u32(c, BASE)
        };
        assert_eq!((c.error, c.sampler_name(2), wrap(&mut c)), (NO_ERROR, 0, REPEAT));
        c.call_list(1);
        assert_eq!(
            (c.error, c.sampler_name(2), wrap(&mut c)),
            (INVALID_ENUM, sampler, CLAMP_TO_EDGE)
        );
        assert_eq!(c.texture_lod_bias(2), 2.0);
    }

    #[test]
    fn border_colours_are_given_as_other_colours_are() {
        let mut c = context();
        c.gen_samplers(1, BASE);
        c.get_sampler_parameteriv(1, TEXTURE_BORDER_COLOR, BASE);
        assert_eq!((read_u32(&c, BASE), c.error), (0, NO_ERROR));
    }

    #[test]
    fn mistakes_change_nothing() {
        let mut c = context();
        c.bind_sampler(0, 7);
        assert_eq!(std::mem::take(&mut c.error), INVALID_OPERATION);
        c.gen_samplers(1, BASE);
        c.bind_sampler(MAX_TEXTURE_UNITS as u32, 1);
        assert_eq!(std::mem::take(&mut c.error), INVALID_VALUE);
        c.sampler_parameteri(1, TEXTURE_BASE_LEVEL, 0);
        assert_eq!(std::mem::take(&mut c.error), INVALID_ENUM);
        c.sampler_parameteri(1, TEXTURE_WRAP_S, NEAREST as i32);
        assert_eq!(std::mem::take(&mut c.error), INVALID_ENUM);
        c.get_sampler_parameteriv(1, TEXTURE_WRAP_S, BASE);
        assert_eq!((read_u32(&c, BASE), c.error), (REPEAT, NO_ERROR));
    }
}
