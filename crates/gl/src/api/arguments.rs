//! Arguments from and results to the client's memory, and calls that differ in nothing but the type
//! of a parameter.

use crate::{ClientMemory, Context, enums as gl};
use bytemuck::{NoUninit, Pod};

/// A number a client may hand over.
pub(super) trait Number: Pod {
    /// The value.
    fn plain(self) -> f32;
    /// The value as a colour component: the range of an integer type becomes -1..=1.
    fn normalized(self) -> f32;
}

impl Number for f32 {
    fn plain(self) -> f32 {
        self
    }
    fn normalized(self) -> f32 {
        self
    }
}

impl Number for f64 {
    fn plain(self) -> f32 {
        self as f32
    }
    fn normalized(self) -> f32 {
        self as f32
    }
}

impl Number for i32 {
    fn plain(self) -> f32 {
        self as f32
    }
    fn normalized(self) -> f32 {
        ((2.0 * f64::from(self) + 1.0) / f64::from(u32::MAX)) as f32
    }
}

/// What a parameter name takes.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    /// One number.
    Scalar,
    /// So many numbers.
    Vector(usize),
    /// Four colour components: integers are normalised.
    Color,
}

impl Form {
    /// How many numbers are read; none for an unknown name.
    pub(super) fn count(form: Option<Self>) -> usize {
        match form {
            None => 0,
            Some(Self::Scalar) => 1,
            Some(Self::Vector(n)) => n,
            Some(Self::Color) => 4,
        }
    }
}

/// A token that came as a number; any other number becomes an invalid one.
pub(super) fn token(value: f32) -> u32 {
    if value >= 0.0 { value as u32 } else { u32::MAX }
}

/// `value` in `0..=1`; NaN becomes 0.
pub(super) fn unit(value: f32) -> f32 {
    if value > 0.0 { value.min(1.0) } else { 0.0 }
}

/// As [`unit`].
pub(super) fn unit64(value: f64) -> f64 {
    if value > 0.0 { value.min(1.0) } else { 0.0 }
}

/// Reads `count` values; the rest of the array is 0. `None` if the memory cannot be read.
pub(super) fn read<T: Pod, const N: usize>(
    memory: &dyn ClientMemory,
    address: usize,
    count: usize,
) -> Option<[T; N]> {
    let mut values = [T::zeroed(); N];
    let readable = count == 0
        || (address != 0 && memory.read(address, bytemuck::cast_slice_mut(&mut values[..count])));
    readable.then_some(values)
}

/// A string of `length` bytes, or up to its NUL if `length` is negative; no longer than `limit`
/// bytes.
pub(super) fn read_string(
    memory: &dyn ClientMemory,
    address: usize,
    length: i32,
    limit: usize,
) -> Text {
    if address == 0 {
        return Text::Unreadable;
    }

    // Read a string of known length at once.
    if let Ok(length) = usize::try_from(length) {
        if length >= limit {
            return Text::TooLong;
        }
        let mut bytes = vec![0; length];
        return if memory.read(address, &mut bytes) {
            Text::Bytes(bytes)
        } else {
            Text::Unreadable
        };
    }

    // Otherwise read byte by byte up to the NUL.
    let mut bytes = Vec::new();
    while bytes.len() < limit {
        let mut byte = [0];
        match address.checked_add(bytes.len()) {
            Some(at) if memory.read(at, &mut byte) => {}
            _ => return Text::Unreadable,
        }
        if byte[0] == 0 {
            return Text::Bytes(bytes);
        }
        bytes.push(byte[0]);
    }
    Text::TooLong
}

/// What [`read_string`] found.
pub(super) enum Text {
    /// The string.
    Bytes(Vec<u8>),
    /// It has the limit's length or more.
    TooLong,
    /// Not the client's memory.
    Unreadable,
}

impl Context {
    /// Reads `count` arguments; the rest of the array is 0. Records an error if the memory cannot
    /// be read.
    pub(super) fn take_arguments<T: Pod, const N: usize>(
        &mut self,
        call: &str,
        address: usize,
        count: usize,
    ) -> Option<[T; N]> {
        let values = read(&*self.memory, address, count);
        if values.is_none() {
            self.refuse_value(call, "the parameters are not in readable memory");
        }
        values
    }

    /// Writes results; `false` if the memory cannot be written, which is an error.
    pub(super) fn give_results<T: NoUninit>(
        &mut self,
        call: &str,
        address: usize,
        values: &[T],
    ) -> bool {
        let bytes: &[u8] = bytemuck::cast_slice(values);
        let written = bytes.is_empty() || (address != 0 && self.memory.write(address, bytes));
        if !written {
            self.refuse_value(call, "the result has no writable memory");
        }
        written
    }

    /// Whether a call that is not allowed between Begin and End may go on; else records the error.
    pub(super) fn may_set(&mut self, call: &str) -> bool {
        let outside = !self.inside_begin();
        if !outside {
            self.record_error(gl::INVALID_OPERATION, call, "not allowed between glBegin and glEnd");
        }
        outside
    }

    /// Records INVALID_ENUM for the argument `name`.
    pub(super) fn refuse_enum(&mut self, call: &str, name: &str, value: u32) {
        self.record_error(gl::INVALID_ENUM, call, &format!("{name} 0x{value:04X} is not accepted"));
    }

    /// Records INVALID_VALUE.
    pub(super) fn refuse_value(&mut self, call: &str, why: &str) {
        self.record_error(gl::INVALID_VALUE, call, why);
    }

    /// Records INVALID_OPERATION.
    pub(super) fn refuse_operation(&mut self, call: &str, why: &str) {
        self.record_error(gl::INVALID_OPERATION, call, why);
    }

    /// Whether `value` is one of `allowed`; else records INVALID_ENUM.
    pub(super) fn check_enum(
        &mut self,
        call: &str,
        name: &str,
        value: u32,
        allowed: &[u32],
    ) -> bool {
        let good = allowed.contains(&value);
        if !good {
            self.refuse_enum(call, name, value);
        }
        good
    }
}

/// A setter of one number: `glFogf`. `form` is a function from parameter name to [`Form`]; `exec`
/// checks and stores. The specification does not say what it does to a parameter that has several
/// numbers; as in Mesa the others become 0.
macro_rules! scalar_call {
    ($name:ident, $call:literal, $type:ty, $form:path, $exec:ident $(, $key:ident)*) => {
        #[doc = concat!("`", $call, "`.")]
        pub fn $name(&mut self, $($key: u32,)* pname: u32, param: $type) {
            let values = [$crate::api::arguments::Number::plain(param), 0.0, 0.0, 0.0];
            let known = $form(pname).is_some();
            self.listable(move |c| {
                if !c.may_set($call) {
                } else if known {
                    c.$exec($call, $($key,)* pname, values);
                } else {
                    c.refuse_enum($call, "pname", pname);
                }
            });
        }
    };
}

/// A setter of several numbers: `glFogfv`.
macro_rules! vector_call {
    ($name:ident, $call:literal, $type:ty, $form:path, $exec:ident $(, $key:ident)*) => {
        #[doc = concat!("`", $call, "`.")]
        pub fn $name(&mut self, $($key: u32,)* pname: u32, params: usize) {
            use $crate::api::arguments::{Form, Number};
            let form = $form(pname);
            let Some(given) = self.take_arguments::<$type, 4>($call, params, Form::count(form)) else { return };
            let values = if form == Some(Form::Color) { given.map(Number::normalized) } else { given.map(Number::plain) };
            self.listable(move |c| {
                if c.may_set($call) {
                    c.$exec($call, $($key,)* pname, values);
                }
            });
        }
    };
}

pub(super) use {scalar_call, vector_call};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers_become_colours() {
        assert_eq!(i32::MAX.normalized(), 1.0);
        assert_eq!(i32::MIN.normalized(), -1.0);
        assert_eq!(token(-1.0), u32::MAX);
        assert_eq!(token(f32::NAN), u32::MAX);
        assert_eq!(unit(f32::NAN), 0.0);
    }
}
