//! Get: one table from name to value, four types to ask in.

mod arrays;
mod fragment;
mod limits;
mod strings;
mod transform;

use crate::{Context, enums as gl};

/// How a value turns into another type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// 0 or 1.
    Boolean,
    /// Whole numbers and tokens; masks wrap.
    Integer,
    /// Rounded to integers.
    Float,
    /// 1.0 becomes the largest integer, -1.0 the smallest.
    Normalized,
}

/// Up to 16 numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Value {
    kind: Kind,
    len: usize,
    numbers: [f64; 16],
}

impl Value {
    fn new(kind: Kind, values: impl IntoIterator<Item = f64>) -> Self {
        let mut value = Self { kind, len: 0, numbers: [0.0; 16] };
        for (slot, number) in value.numbers.iter_mut().zip(values) {
            *slot = number;
            value.len += 1;
        }
        value
    }

    pub(super) fn boolean(on: bool) -> Self {
        Self::booleans(&[on])
    }

    pub(super) fn booleans(on: &[bool]) -> Self {
        Self::new(Kind::Boolean, on.iter().map(|on| f64::from(u8::from(*on))))
    }

    pub(super) fn token(token: u32) -> Self {
        Self::tokens(&[token])
    }

    pub(super) fn tokens(tokens: &[u32]) -> Self {
        Self::new(Kind::Integer, tokens.iter().copied().map(f64::from))
    }

    pub(super) fn integer(value: i32) -> Self {
        Self::integers(&[value])
    }

    pub(super) fn integers(values: &[i32]) -> Self {
        Self::new(Kind::Integer, values.iter().copied().map(f64::from))
    }

    pub(super) fn size(value: usize) -> Self {
        Self::new(Kind::Integer, [value as f64])
    }

    pub(super) fn float(value: f32) -> Self {
        Self::floats(&[value])
    }

    pub(super) fn floats(values: &[f32]) -> Self {
        Self::new(Kind::Float, values.iter().copied().map(f64::from))
    }

    pub(super) fn normalized(values: &[f32]) -> Self {
        Self::new(Kind::Normalized, values.iter().copied().map(f64::from))
    }

    pub(super) fn normalized64(values: &[f64]) -> Self {
        Self::new(Kind::Normalized, values.iter().copied())
    }
}

/// A component of a colour as an integer: -1..=1 becomes the range of the type, and 0.0 becomes 0.
pub(crate) fn integer_of_component(number: f64) -> i32 {
    ((number * f64::from(u32::MAX) - 1.0) / 2.0) as i32
}

/// A type that can be asked for.
pub(super) trait Answer: bytemuck::Pod {
    /// One number of a value.
    fn convert(kind: Kind, number: f64) -> Self;
}

impl Answer for u8 {
    fn convert(_: Kind, number: f64) -> Self {
        Self::from(number != 0.0)
    }
}

impl Answer for i32 {
    fn convert(kind: Kind, number: f64) -> Self {
        match kind {
            Kind::Boolean | Kind::Integer => number as i64 as Self,
            Kind::Float => number.round() as Self,
            Kind::Normalized => integer_of_component(number),
        }
    }
}

impl Answer for i64 {
    fn convert(kind: Kind, number: f64) -> Self {
        match kind {
            Kind::Normalized => ((number * u64::MAX as f64 - 1.0) / 2.0) as Self,
            Kind::Boolean | Kind::Integer | Kind::Float => number.round() as Self,
        }
    }
}

impl Answer for f32 {
    fn convert(_: Kind, number: f64) -> Self {
        number as Self
    }
}

impl Answer for f64 {
    fn convert(_: Kind, number: f64) -> Self {
        number
    }
}

impl Context {
    /// Writes a value, if there is one, to the client.
    pub(super) fn give_value<T: Answer>(
        &mut self,
        call: &str,
        address: usize,
        value: Option<Value>,
    ) {
        if let Some(value) = value {
            let answers = value.numbers.map(|number| T::convert(value.kind, number));
            self.give_results(call, address, &answers[..value.len]);
        }
    }

    /// The table: the value of every queryable token; `None` for others.
    fn get(&mut self, pname: u32) -> Option<Value> {
        let switch = self
            .capability(pname)
            .map(|on| *on)
            .or_else(|| self.client_capability(pname).map(|on| *on));
        if let Some(on) = switch {
            return Some(Value::boolean(on));
        }
        self.get_current(pname)
            .or_else(|| self.get_transform(pname))
            .or_else(|| self.get_lighting(pname))
            .or_else(|| self.get_primitives(pname))
            .or_else(|| self.get_tests(pname))
            .or_else(|| self.get_stencil(pname))
            .or_else(|| self.get_blending(pname))
            .or_else(|| self.get_pixels(pname))
            .or_else(|| self.get_texturing(pname))
            .or_else(|| self.get_framebuffer(pname))
            .or_else(|| self.get_evaluators(pname))
            .or_else(|| self.get_arrays(pname))
            .or_else(|| self.get_array_buffers(pname))
            .or_else(|| self.get_lists(pname))
            .or_else(|| self.get_limits(pname))
            .or_else(|| self.get_debug(pname))
    }

    fn get_any<T: Answer>(&mut self, call: &str, pname: u32, data: usize) {
        if !self.may_set(call) {
            return;
        }
        let value = self.get(pname);
        if value.is_none() {
            self.refuse_enum(call, "pname", pname);
        }
        self.give_value::<T>(call, data, value);
    }

    /// `glGetBooleanv`.
    pub fn get_booleanv(&mut self, pname: u32, data: usize) {
        self.get_any::<u8>("glGetBooleanv", pname, data);
    }

    /// `glGetIntegerv`.
    pub fn get_integerv(&mut self, pname: u32, data: usize) {
        self.get_any::<i32>("glGetIntegerv", pname, data);
    }

    /// `glGetInteger64v`.
    pub fn get_integer64v(&mut self, pname: u32, data: usize) {
        self.get_any::<i64>("glGetInteger64v", pname, data);
    }

    /// `glGetFloatv`.
    pub fn get_floatv(&mut self, pname: u32, data: usize) {
        self.get_any::<f32>("glGetFloatv", pname, data);
    }

    /// `glGetDoublev`.
    pub fn get_doublev(&mut self, pname: u32, data: usize) {
        self.get_any::<f64>("glGetDoublev", pname, data);
    }

    /// Whether an error in `get` of a token would be recorded; for the tests of the tables.
    #[cfg(test)]
    fn knows(&mut self, pname: u32) -> bool {
        self.get(pname).is_some()
    }

    fn get_debug(&mut self, pname: u32) -> Option<Value> {
        Some(match pname {
            gl::DEBUG_LOGGED_MESSAGES => Value::size(self.debug.logged()),
            gl::DEBUG_NEXT_LOGGED_MESSAGE_LENGTH => Value::size(self.debug.next_length()),
            gl::DEBUG_GROUP_STACK_DEPTH => Value::size(self.debug.depth()),
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests;
