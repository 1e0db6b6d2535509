//! What programs ask of shaders when something went wrong: that they failed, and why.
#![allow(non_snake_case)]

use crate::unsupported::refuse;
use std::ffi::c_char;
use std::ptr;

/// `COMPILE_STATUS`, `LINK_STATUS` and `VALIDATE_STATUS` (`gl.xml`; those of ARB_shader_objects
/// have the same numbers) are false. `INFO_LOG_LENGTH` is that of [`LOG`] with its end.
const INFO_LOG_LENGTH: u32 = 0x8b84;

/// What all logs say.
const LOG: &[u8] = b"libOSMesa of vitral draws OpenGL 1.5: there are no shaders\0";

/// Writes the log, as much as `room` bytes hold with the end, and its length without the end.
///
/// # Safety
/// `length` is null or can be written, `log` is null or has `room` bytes.
unsafe fn write_log(room: i32, length: *mut i32, log: *mut c_char) {
    let room = usize::try_from(room).unwrap_or(0);
    let count = if log.is_null() { 0 } else { (LOG.len() - 1).min(room.saturating_sub(1)) };
    if !log.is_null() && room > 0 {
        // SAFETY: the client's promise: there is room for the text and its end.
        unsafe {
            ptr::copy_nonoverlapping(LOG.as_ptr(), log.cast(), count);
            log.add(count).write(0);
        }
    }
    if !length.is_null() {
        // SAFETY: not null, and the client promises the rest.
        unsafe { length.write_unaligned(count as i32) };
    }
}

/// Writes what is known of a shader or program that does not exist.
///
/// # Safety
/// `value` is null, or can be written.
unsafe fn write_parameter(pname: u32, value: *mut i32) {
    if !value.is_null() {
        // SAFETY: not null, and the client promises the rest.
        unsafe {
            value.write_unaligned(if pname == INFO_LOG_LENGTH { LOG.len() as i32 } else { 0 })
        };
    }
}

macro_rules! logs {
    ($($name:ident)+) => {
        $(
            /// # Safety
            /// `length` is null or can be written, `log` is null or has `room` bytes.
            #[unsafe(no_mangle)]
            pub(crate) unsafe extern "C" fn $name(_object: u32, room: i32, length: *mut i32, log: *mut c_char) {
                refuse(stringify!($name));
                // SAFETY: promised by the client.
                unsafe { write_log(room, length, log) };
            }
        )+
    };
}

macro_rules! parameters {
    ($($name:ident)+) => {
        $(
            /// # Safety
            /// `value` is null, or can be written.
            #[unsafe(no_mangle)]
            pub(crate) unsafe extern "C" fn $name(_object: u32, pname: u32, value: *mut i32) {
                refuse(stringify!($name));
                // SAFETY: promised by the client.
                unsafe { write_parameter(pname, value) };
            }
        )+
    };
}

logs! { glGetInfoLogARB glGetProgramInfoLog glGetShaderInfoLog }
parameters! { glGetObjectParameterivARB glGetProgramiv glGetShaderiv }

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logs_say_that_there_are_no_shaders_in_the_room_there_is() {
        let (mut length, mut log) = (-1, [1 as c_char; 100]);
        // SAFETY: both have the room that is told.
        unsafe { glGetShaderInfoLog(1, 100, &raw mut length, log.as_mut_ptr()) };
        let text: Vec<u8> =
            log.iter().take_while(|&&c| c != 0).map(|&c| c.cast_unsigned()).collect();
        assert_eq!((text.len(), &text[..]), (length as usize, &LOG[..LOG.len() - 1]));
        // SAFETY: as above.
        unsafe { glGetProgramInfoLog(1, 5, &raw mut length, log.as_mut_ptr()) };
        assert_eq!((length, log[3], log[4], log[5]), (4, LOG[3] as c_char, 0, LOG[5] as c_char));
        let mut value = 7;
        // SAFETY: one number.
        unsafe { glGetShaderiv(1, 0x8b81, &raw mut value) };
        assert_eq!(value, 0);
        // SAFETY: one number.
        unsafe { glGetProgramiv(1, INFO_LOG_LENGTH, &raw mut value) };
        assert_eq!(value as usize, LOG.len());
        // SAFETY: null and no room are allowed.
        unsafe { glGetInfoLogARB(1, 0, ptr::null_mut(), ptr::null_mut()) };
    }
}
