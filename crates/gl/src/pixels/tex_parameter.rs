//! `TexParameter` and its queries.

use super::Failure;
use super::image::lock;
use super::texture::{ImageTarget, MAX_ANISOTROPY, TextureParameters, slot, slot_of};
use crate::Context;
use crate::api::integer_of_component;
use crate::enums::*;
use crate::memory::ClientMemory;

/// A parameter's value as it was given.
#[derive(Clone, Copy, Debug)]
pub(super) enum Value {
    Float(f32),
    Int(i32),
    Floats([f32; 4]),
    Ints([i32; 4]),
}

/// An integer as a component of a colour: the range of the type becomes -1..=1.
fn component(value: i32) -> f32 {
    ((2.0 * f64::from(value) + 1.0) / f64::from(u32::MAX)) as f32
}

/// What [`get`] gives, as integers: components of a colour by their whole range, others rounded.
pub(super) fn integers((values, color): (Vec<f64>, bool)) -> Vec<i32> {
    let convert = |v: f64| if color { integer_of_component(v) } else { v.round() as i32 };
    values.into_iter().map(convert).collect()
}

impl Value {
    fn float(self) -> f32 {
        match self {
            Self::Float(v) | Self::Floats([v, ..]) => v,
            Self::Int(v) | Self::Ints([v, ..]) => v as f32,
        }
    }

    /// Floats are rounded to the nearest integer.
    fn int(self) -> i32 {
        match self {
            Self::Float(v) | Self::Floats([v, ..]) => v.round() as i32,
            Self::Int(v) | Self::Ints([v, ..]) => v,
        }
    }

    fn token(self) -> u32 {
        self.int() as u32
    }

    fn tokens(self) -> Option<[u32; 4]> {
        match self {
            Self::Floats(v) => Some(v.map(|v| v.round() as i32 as u32)),
            Self::Ints(v) => Some(v.map(|v| v as u32)),
            Self::Float(_) | Self::Int(_) => None,
        }
    }

    fn color(self) -> Option<[f32; 4]> {
        match self {
            Self::Floats(v) => Some(v),
            Self::Ints(v) => Some(v.map(component)),
            Self::Float(_) | Self::Int(_) => None,
        }
    }
}

fn token_of(value: Value, allowed: &[u32]) -> Result<u32, Failure> {
    let token = value.token();
    allowed
        .contains(&token)
        .then_some(token)
        .ok_or((INVALID_ENUM, "the value is none that the parameter can have"))
}

fn level_of(value: Value) -> Result<i32, Failure> {
    let level = value.int();
    (level >= 0).then_some(level).ok_or((INVALID_VALUE, "a level is negative"))
}

/// Where a component may come from.
const SWIZZLES: [u32; 6] = [RED, GREEN, BLUE, ALPHA, ZERO, ONE];

/// Sets a parameter of a texture of `slot`.
pub(super) fn set(
    p: &mut TextureParameters,
    slot: usize,
    pname: u32,
    value: Value,
) -> Result<(), Failure> {
    let rectangle = slot == slot::RECTANGLE;
    match pname {
        // Wrap modes and filters; rectangles allow some of them.
        TEXTURE_WRAP_S | TEXTURE_WRAP_T | TEXTURE_WRAP_R => {
            set_wrap(p, rectangle, pname, value)?;
        }
        TEXTURE_MIN_FILTER => {
            let all = [
                NEAREST,
                LINEAR,
                NEAREST_MIPMAP_NEAREST,
                LINEAR_MIPMAP_NEAREST,
                NEAREST_MIPMAP_LINEAR,
                LINEAR_MIPMAP_LINEAR,
            ];
            p.min = token_of(value, if rectangle { &all[..2] } else { &all })?;
        }
        TEXTURE_MAG_FILTER => p.mag = token_of(value, &[NEAREST, LINEAR])?,
        TEXTURE_BORDER_COLOR => {
            p.border =
                value.color().ok_or((INVALID_ENUM, "TEXTURE_BORDER_COLOR needs a vector"))?;
        }

        // Levels of detail.
        TEXTURE_PRIORITY => p.priority = value.float().clamp(0.0, 1.0),
        TEXTURE_MIN_LOD => p.lod[0] = value.float(),
        TEXTURE_MAX_LOD => p.lod[1] = value.float(),
        TEXTURE_BASE_LEVEL => {
            let level = level_of(value)?;
            if rectangle && level != 0 {
                return Err((INVALID_OPERATION, "a rectangle texture has level 0 alone"));
            }
            p.levels[0] = level;
        }
        TEXTURE_MAX_LEVEL => p.levels[1] = level_of(value)?,
        TEXTURE_LOD_BIAS => p.lod_bias = value.float(),

        // Depth textures.
        DEPTH_TEXTURE_MODE => p.depth_mode = token_of(value, &[LUMINANCE, INTENSITY, ALPHA, RED])?,
        TEXTURE_COMPARE_MODE => p.compare_mode = token_of(value, &[NONE, COMPARE_R_TO_TEXTURE])?,
        TEXTURE_COMPARE_FUNC => {
            p.compare_func =
                token_of(value, &[LEQUAL, GEQUAL, LESS, GREATER, EQUAL, NOTEQUAL, ALWAYS, NEVER])?;
        }

        // Mipmaps and anisotropy.
        GENERATE_MIPMAP if rectangle && value.int() != 0 => {
            return Err((INVALID_VALUE, "a rectangle texture has no mipmaps"));
        }
        GENERATE_MIPMAP => p.generate_mipmap = value.float() != 0.0,
        TEXTURE_MAX_ANISOTROPY_EXT => {
            let amount = value.float();
            if amount.is_nan() || amount < 1.0 {
                return Err((INVALID_VALUE, "anisotropy is less than 1"));
            }
            p.anisotropy = amount.min(MAX_ANISOTROPY);
        }

        // Swizzles.
        TEXTURE_SWIZZLE_R..=TEXTURE_SWIZZLE_A => {
            p.swizzle[(pname - TEXTURE_SWIZZLE_R) as usize] = token_of(value, &SWIZZLES)?;
        }
        TEXTURE_SWIZZLE_RGBA => {
            let all =
                value.tokens().ok_or((INVALID_ENUM, "TEXTURE_SWIZZLE_RGBA needs a vector"))?;
            for token in all {
                token_of(Value::Int(token as i32), &SWIZZLES)?;
            }
            p.swizzle = all;
        }
        _ => return Err((INVALID_ENUM, "pname is not a texture parameter")),
    }
    Ok(())
}

/// Sets the wrap mode of an axis; rectangles allow the first three modes.
fn set_wrap(
    p: &mut TextureParameters,
    rectangle: bool,
    pname: u32,
    value: Value,
) -> Result<(), Failure> {
    let axis = [TEXTURE_WRAP_S, TEXTURE_WRAP_T, TEXTURE_WRAP_R]
        .iter()
        .position(|&t| t == pname)
        .unwrap_or(0);
    let all = [
        CLAMP,
        CLAMP_TO_EDGE,
        CLAMP_TO_BORDER,
        REPEAT,
        MIRRORED_REPEAT,
        MIRROR_CLAMP_EXT,
        MIRROR_CLAMP_TO_EDGE_EXT,
        MIRROR_CLAMP_TO_BORDER_EXT,
    ];
    p.wrap[axis] = token_of(value, if rectangle { &all[..3] } else { &all })?;
    Ok(())
}

/// The values of a parameter: numbers, and whether they are components of a colour.
pub(super) fn get(p: &TextureParameters, pname: u32) -> Option<(Vec<f64>, bool)> {
    let one = |v: f64| Some((vec![v], false));
    match pname {
        TEXTURE_WRAP_S => one(p.wrap[0].into()),
        TEXTURE_WRAP_T => one(p.wrap[1].into()),
        TEXTURE_WRAP_R => one(p.wrap[2].into()),
        TEXTURE_MIN_FILTER => one(p.min.into()),
        TEXTURE_MAG_FILTER => one(p.mag.into()),
        TEXTURE_BORDER_COLOR => {
            Some((p.border.map(|v| f64::from(v.clamp(0.0, 1.0))).to_vec(), true))
        }
        TEXTURE_PRIORITY => Some((vec![p.priority.into()], true)),
        TEXTURE_RESIDENT => one(1.0),
        TEXTURE_MIN_LOD => one(p.lod[0].into()),
        TEXTURE_MAX_LOD => one(p.lod[1].into()),
        TEXTURE_BASE_LEVEL => one(p.levels[0].into()),
        TEXTURE_MAX_LEVEL => one(p.levels[1].into()),
        TEXTURE_LOD_BIAS => one(p.lod_bias.into()),
        DEPTH_TEXTURE_MODE => one(p.depth_mode.into()),
        TEXTURE_COMPARE_MODE => one(p.compare_mode.into()),
        TEXTURE_COMPARE_FUNC => one(p.compare_func.into()),
        GENERATE_MIPMAP => one(f64::from(u8::from(p.generate_mipmap))),
        TEXTURE_MAX_ANISOTROPY_EXT => one(p.anisotropy.into()),
        TEXTURE_SWIZZLE_R..=TEXTURE_SWIZZLE_A => {
            one(p.swizzle[(pname - TEXTURE_SWIZZLE_R) as usize].into())
        }
        TEXTURE_SWIZZLE_RGBA => Some((p.swizzle.map(f64::from).to_vec(), false)),
        _ => None,
    }
}

/// Reads a parameter's vector: four values of a border colour or swizzle, else one.
pub(super) fn read_vector<T: bytemuck::Pod + Default>(
    memory: &dyn ClientMemory,
    pname: u32,
    address: usize,
) -> Option<[T; 4]> {
    let mut values = [T::default(); 4];
    let count = if matches!(pname, TEXTURE_BORDER_COLOR | TEXTURE_SWIZZLE_RGBA) { 4 } else { 1 };
    (address != 0 && memory.read(address, bytemuck::cast_slice_mut(&mut values[..count])))
        .then_some(values)
}

impl Context {
    fn tex_parameter(&mut self, call: &'static str, target: u32, pname: u32, value: Value) {
        self.listable(move |c| {
            if !c.outside_begin(call) {
                return;
            }
            let Some(slot) = slot_of(target) else {
                c.record_error(INVALID_ENUM, call, "target is not a texture target");
                return;
            };

            // Set the parameter on a copy.
            let texture = c.target_texture(ImageTarget { slot, face: 0, proxy: false });
            let mut texture = lock(&texture);
            let mut parameters = texture.parameters.clone();
            let result = set(&mut parameters, slot, pname, value);
            if let Some(levels) = texture.immutable_levels() {
                parameters.bound_levels(levels);
            }

            // Store it if it has changed.
            match result {
                Err((error, why)) => {
                    drop(texture);
                    c.record_error(error, call, why);
                }
                Ok(()) if parameters != texture.parameters => {
                    texture.parameters = parameters;
                    texture.touch();
                }
                Ok(()) => {}
            }
        });
    }

    fn read_parameter<T: bytemuck::Pod + Default>(
        &self,
        pname: u32,
        address: usize,
    ) -> Option<[T; 4]> {
        read_vector(&*self.memory, pname, address)
    }

    /// `glTexParameterf`. A list keeps it, as Mesa's does, as a call with `v`: a border colour is
    /// no error there.
    pub fn tex_parameterf(&mut self, target: u32, pname: u32, param: f32) {
        let value = if self.lists.recording {
            Value::Floats([param, 0.0, 0.0, 0.0])
        } else {
            Value::Float(param)
        };
        self.tex_parameter("glTexParameterf", target, pname, value);
    }

    /// `glTexParameteri`.
    pub fn tex_parameteri(&mut self, target: u32, pname: u32, param: i32) {
        let value =
            if self.lists.recording { Value::Ints([param, 0, 0, 0]) } else { Value::Int(param) };
        self.tex_parameter("glTexParameteri", target, pname, value);
    }

    /// `glTexParameterfv`.
    pub fn tex_parameterfv(&mut self, target: u32, pname: u32, params: usize) {
        if let Some(values) = self.read_parameter(pname, params) {
            self.tex_parameter("glTexParameterfv", target, pname, Value::Floats(values));
        }
    }

    /// `glTexParameteriv`.
    pub fn tex_parameteriv(&mut self, target: u32, pname: u32, params: usize) {
        if let Some(values) = self.read_parameter(pname, params) {
            self.tex_parameter("glTexParameteriv", target, pname, Value::Ints(values));
        }
    }

    fn parameter_values(
        &mut self,
        call: &str,
        target: u32,
        pname: u32,
    ) -> Option<(Vec<f64>, bool)> {
        if !self.outside_begin(call) {
            return None;
        }
        let Some(slot) = slot_of(target) else {
            self.record_error(INVALID_ENUM, call, "target is not a texture target");
            return None;
        };
        let texture = self.target_texture(ImageTarget { slot, face: 0, proxy: false });
        let values = match pname {
            TEXTURE_IMMUTABLE_FORMAT => {
                Some((vec![f64::from(u8::from(lock(&texture).immutable))], false))
            }
            _ => get(&lock(&texture).parameters, pname),
        };
        if values.is_none() {
            self.record_error(INVALID_ENUM, call, "pname is not a texture parameter");
        }
        values
    }

    /// `glGetTexParameterfv`.
    pub fn get_tex_parameterfv(&mut self, target: u32, pname: u32, params: usize) {
        if let Some((values, _)) = self.parameter_values("glGetTexParameterfv", target, pname) {
            let values: Vec<f32> = values.iter().map(|&v| v as f32).collect();
            self.give_numbers(params, &values);
        }
    }

    /// `glGetTexParameteriv`.
    pub fn get_tex_parameteriv(&mut self, target: u32, pname: u32, params: usize) {
        if let Some(found) = self.parameter_values("glGetTexParameteriv", target, pname) {
            self.give_numbers(params, &integers(found));
        }
    }

    /// Writes a parameter's values where the client wants them.
    pub(super) fn give_numbers<T: bytemuck::NoUninit>(&self, address: usize, values: &[T]) {
        if address != 0 {
            self.memory.write(address, bytemuck::cast_slice(values));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{BASE, context, put, read_floats, read_u32};
    use super::*;

    #[test]
    fn values_are_checked_and_kept() {
        let mut c = context();
        c.tex_parameteri(TEXTURE_2D, TEXTURE_MIN_FILTER, LINEAR as i32);
        c.get_tex_parameteriv(TEXTURE_2D, TEXTURE_MIN_FILTER, BASE);
        assert_eq!(read_u32(&c, BASE), LINEAR);
        c.tex_parameterf(TEXTURE_2D, TEXTURE_MAG_FILTER, LINEAR_MIPMAP_LINEAR as f32);
        assert_eq!(c.error, INVALID_ENUM);
        c.error = NO_ERROR;
        c.tex_parameteri(TEXTURE_2D, TEXTURE_MAX_LEVEL, -1);
        assert_eq!(c.error, INVALID_VALUE);
        c.error = NO_ERROR;
        c.tex_parameteri(TEXTURE_RECTANGLE_ARB, TEXTURE_WRAP_S, REPEAT as i32);
        assert_eq!(c.error, INVALID_ENUM);
        c.error = NO_ERROR;
        c.tex_parameterf(TEXTURE_2D, TEXTURE_BORDER_COLOR, 1.0);
        assert_eq!(c.error, INVALID_ENUM);
    }

    #[test]
    fn border_colours_convert() {
        let mut c = context();
        put(&c, BASE, bytemuck::cast_slice(&[i32::MAX, i32::MIN, 0, i32::MAX]));
        c.tex_parameteriv(TEXTURE_3D, TEXTURE_BORDER_COLOR, BASE);
        c.get_tex_parameterfv(TEXTURE_3D, TEXTURE_BORDER_COLOR, BASE + 64);
        let values = read_floats::<4>(&c, BASE + 64);
        assert_eq!([values[0], values[1], values[3]], [1.0, 0.0, 1.0]);
        c.get_tex_parameteriv(TEXTURE_3D, TEXTURE_PRIORITY, BASE);
        assert_eq!(read_u32(&c, BASE), i32::MAX as u32);
        put(&c, BASE, bytemuck::cast_slice(&[0.0f32, 1.0, 0.5, 0.0]));
        c.tex_parameterfv(TEXTURE_3D, TEXTURE_BORDER_COLOR, BASE);
        c.get_tex_parameteriv(TEXTURE_3D, TEXTURE_BORDER_COLOR, BASE + 64);
        assert_eq!(
            [0, 4, 8, 12].map(|i| read_u32(&c, BASE + 64 + i) as i32),
            [0, i32::MAX, i32::MAX / 2, 0]
        );
    }
}
