//! What a context is asked to be, and whether that can be had.

use vitral_gl::enums;

/// Tokens of `GL/osmesa.h`.
pub(crate) mod tokens {
    pub(crate) use vitral_gl::enums::{RGB, RGBA, UNSIGNED_SHORT_5_6_5};
    pub(crate) const BGRA: u32 = 0x1;
    pub(crate) const ARGB: u32 = 0x2;
    pub(crate) const BGR: u32 = 0x4;
    pub(crate) const RGB_565: u32 = 0x5;
    pub(crate) const ROW_LENGTH: i32 = 0x10;
    pub(crate) const Y_UP: i32 = 0x11;
    pub(crate) const WIDTH: i32 = 0x20;
    pub(crate) const HEIGHT: i32 = 0x21;
    pub(crate) const FORMAT: i32 = 0x22;
    pub(crate) const TYPE: i32 = 0x23;
    pub(crate) const MAX_WIDTH: i32 = 0x24;
    pub(crate) const MAX_HEIGHT: i32 = 0x25;
    pub(crate) const DEPTH_BITS: i32 = 0x30;
    pub(crate) const STENCIL_BITS: i32 = 0x31;
    pub(crate) const ACCUM_BITS: i32 = 0x32;
    pub(crate) const PROFILE: i32 = 0x33;
    pub(crate) const CORE_PROFILE: i32 = 0x34;
    pub(crate) const COMPAT_PROFILE: i32 = 0x35;
    pub(crate) const CONTEXT_MAJOR_VERSION: i32 = 0x36;
    pub(crate) const CONTEXT_MINOR_VERSION: i32 = 0x37;
}
use tokens::*;

/// The OpenGL version that a context has.
const VERSION: (i32, i32) = (1, 5);

/// A context's buffers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Attributes {
    /// `OSMESA_RGBA` ...
    pub(crate) format: u32,
    /// 0, 16 or 24.
    pub(crate) depth_bits: i32,
    /// 0 or 8.
    pub(crate) stencil_bits: i32,
    /// 0 or 16.
    pub(crate) accum_bits: i32,
    /// OpenGL 2.0 or 2.1 was asked for, and `GL_VERSION` says so.
    pub(crate) says_2_1: bool,
}

impl Attributes {
    /// Checks the format, and rounds the bits up to what there is.
    pub(crate) fn new(format: i32, depth: i32, stencil: i32, accum: i32) -> Result<Self, String> {
        let format = format.cast_unsigned();
        if ![RGBA, BGRA, ARGB, RGB, BGR, RGB_565].contains(&format) {
            return Err(format!(
                "the format {format:#x} is none of OSMESA_RGBA, BGRA, ARGB, RGB, BGR, RGB_565"
            ));
        }
        if depth < 0 || stencil < 0 || accum < 0 {
            return Err(format!(
                "{depth} depth, {stencil} stencil and {accum} accumulation bits: none may be negative"
            ));
        }
        let stencil_bits = if stencil > 0 { 8 } else { 0 };
        let depth_bits = match depth {
            0 => 0,
            1..=16 if stencil == 0 => 16,
            _ => 24,
        };
        let accum_bits = if accum > 0 { 16 } else { 0 };
        Ok(Self { format, depth_bits, stencil_bits, accum_bits, says_2_1: false })
    }

    /// Reads pairs of attribute and value, in the order given. `lenient`: 1.5 is given to who asks
    /// for 2.0 or 2.1.
    pub(crate) fn from_list(
        pairs: &[(i32, i32)],
        lenient: impl Fn() -> bool,
    ) -> Result<Self, String> {
        let (mut format, mut depth, mut stencil, mut accum) = (RGBA.cast_signed(), 0, 0, 0);
        let (mut profile, mut major, mut minor) = (COMPAT_PROFILE, 1, 0);

        // Take the attributes' values, the last of each.
        for &(attribute, value) in pairs {
            match attribute {
                FORMAT => format = value,
                DEPTH_BITS => depth = value,
                STENCIL_BITS => stencil = value,
                ACCUM_BITS => accum = value,
                PROFILE => profile = value,
                CONTEXT_MAJOR_VERSION => major = value,
                CONTEXT_MINOR_VERSION => minor = value,
                _ => return Err(format!("the attribute {attribute:#x} is none of OSMesa's")),
            }
        }

        // Refuse unknown profiles and versions, and the core profile.
        if profile != COMPAT_PROFILE && profile != CORE_PROFILE {
            return Err(format!("the profile {profile:#x} is none of OSMesa's"));
        }
        if major < 1 || minor < 0 {
            return Err(format!("there is no OpenGL {major}.{minor}"));
        }
        if profile == CORE_PROFILE {
            return Err(format!(
                "OpenGL {major}.{minor} core was asked for, there is the compatibility profile of 1.5 alone: no shaders"
            ));
        }

        // Accept the versions that are there.
        if (major, minor) <= VERSION {
            return Self::new(format, depth, stencil, accum);
        }

        // A program may say 2.1 and use nothing of it: the user knows.
        let (has_major, has_minor) = VERSION;
        let refused = format!(
            "OpenGL {major}.{minor} was asked for, there is {has_major}.{has_minor}, without shaders"
        );
        match (major, minor) {
            (2, 0 | 1) if lenient() => {
                Ok(Self { says_2_1: true, ..Self::new(format, depth, stencil, accum)? })
            }
            (2, 0 | 1) => Err(format!(
                "{refused}; VITRAL_GL_COMPAT=2.1 gives 1.5 to a program that does not need more"
            )),
            _ => Err(refused),
        }
    }

    /// Whether buffers may have this type of component.
    pub(crate) fn takes(&self, kind: u32) -> bool {
        match kind {
            UNSIGNED_SHORT_5_6_5 => self.format == RGB_565,
            enums::UNSIGNED_BYTE | enums::UNSIGNED_SHORT | enums::FLOAT => self.format != RGB_565,
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_rounded_up_to_what_there_is() {
        let bits = |d, s, a| {
            Attributes::new(0x1908, d, s, a).map(|b| (b.depth_bits, b.stencil_bits, b.accum_bits))
        };
        assert_eq!(bits(0, 0, 0), Ok((0, 0, 0)));
        assert_eq!(bits(16, 0, 16), Ok((16, 0, 16)));
        assert_eq!(bits(16, 8, 1), Ok((24, 8, 16)), "packed with stencil");
        assert_eq!(bits(32, 1, 0), Ok((24, 8, 0)));
        assert!(bits(-1, 0, 0).is_err());
        assert!(Attributes::new(0x1900, 0, 0, 0).is_err(), "colour index");
    }

    #[test]
    fn versions_and_profiles_beyond_ours_are_refused() {
        let made = |pairs: &[(i32, i32)]| Attributes::from_list(pairs, || false).is_ok();
        assert!(made(&[]));
        assert!(made(&[(FORMAT, 2), (DEPTH_BITS, 24), (PROFILE, COMPAT_PROFILE)]));
        assert!(made(&[(CONTEXT_MAJOR_VERSION, 1), (CONTEXT_MINOR_VERSION, 5)]));
        for refused in [
            [(PROFILE, CORE_PROFILE)],
            [(PROFILE, 7)],
            [(CONTEXT_MAJOR_VERSION, 2)],
            [(CONTEXT_MAJOR_VERSION, 0)],
            [(CONTEXT_MINOR_VERSION, 6)],
            [(0x99, 0)],
            [(FORMAT, 3)],
        ] {
            assert!(!made(&refused), "{refused:?}");
        }
    }

    #[test]
    fn who_asks_for_2_1_gets_1_5_if_the_user_says_so() {
        let asked = |major, minor, lenient| {
            Attributes::from_list(
                &[(CONTEXT_MAJOR_VERSION, major), (CONTEXT_MINOR_VERSION, minor)],
                || lenient,
            )
        };
        assert_eq!(asked(2, 1, true).map(|made| made.says_2_1), Ok(true));
        assert_eq!(asked(2, 0, true).map(|made| made.says_2_1), Ok(true));
        assert_eq!(asked(1, 4, true).map(|made| made.says_2_1), Ok(false));
        assert!(asked(2, 1, false).is_err_and(|why| why.contains("VITRAL_GL_COMPAT=2.1")));
        assert!(asked(3, 0, true).is_err_and(|why| !why.contains("COMPAT")));
    }

    #[test]
    fn formats_have_their_types() {
        let with = |format| Attributes::new(format, 0, 0, 0).unwrap();
        for format in [0x1908, 1, 2, 0x1907, 4] {
            assert!(
                [enums::UNSIGNED_BYTE, enums::UNSIGNED_SHORT, enums::FLOAT]
                    .iter()
                    .all(|k| with(format).takes(*k))
            );
            assert!(!with(format).takes(UNSIGNED_SHORT_5_6_5) && !with(format).takes(enums::BYTE));
        }
        assert!(with(5).takes(UNSIGNED_SHORT_5_6_5) && !with(5).takes(enums::UNSIGNED_BYTE));
    }
}
