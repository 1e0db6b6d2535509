//! Functions that std computes differently from machine to machine, computed the same everywhere.
//!
//! `+ - * / sqrt` are exact in IEEE 754; everything else that the project needs is here, from the
//! `libm` crate, which is plain Rust arithmetic. The lane-wise versions that shading uses are in
//! [`crate::lanes`].

macro_rules! forward {
    ($($(#[$doc:meta])* $name:ident($($arg:ident),+) = $f64:ident, $f32:ident as $name32:ident;)*) => {$(
        $(#[$doc])* #[inline] pub fn $name($($arg: f64),+) -> f64 { libm::$f64($($arg),+) }
        $(#[$doc])* #[inline] pub fn $name32($($arg: f32),+) -> f32 { libm::$f32($($arg),+) }
    )*};
}

forward! {
    /// Sine of an angle in radians.
    sin(x) = sin, sinf as sin32;
    /// Cosine of an angle in radians.
    cos(x) = cos, cosf as cos32;
    /// Tangent of an angle in radians.
    tan(x) = tan, tanf as tan32;
    /// Arc sine in `-π/2 ..= π/2`; NaN outside `-1 ..= 1`.
    asin(x) = asin, asinf as asin32;
    /// Arc cosine in `0 ..= π`; NaN outside `-1 ..= 1`.
    acos(x) = acos, acosf as acos32;
    /// Angle of the point `(x, y)` in `-π ..= π`.
    atan2(y, x) = atan2, atan2f as atan2_32;
    /// `x` to the power `y`.
    pow(x, y) = pow, powf as pow32;
    /// `e` to the power `x`.
    exp(x) = exp, expf as exp32;
    /// 2 to the power `x`.
    exp2(x) = exp2, exp2f as exp2_32;
    /// Natural logarithm.
    ln(x) = log, logf as ln32;
    /// Logarithm to base 2.
    log2(x) = log2, log2f as log2_32;
}

/// Sine and cosine of an angle in radians.
#[inline]
pub fn sin_cos(x: f64) -> (f64, f64) {
    (sin(x), cos(x))
}
