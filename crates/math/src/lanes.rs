//! Eight numbers at a time, sixteen, or one: the only place that names SIMD types.
//!
//! A formula written over [`Lanes`] serves one vertex (`f32`) and eight pixels (`F32x8`) with the
//! same operations in the same order, so both give the same bits. One written over [`Floats`]
//! serves eight pixels or sixteen, and may use whole numbers. There is no fused multiply-add and no
//! approximate reciprocal; `exp2`/`log2` are polynomials of ours, made of exact operations only.
//!
//! Functions over lanes must be `#[inline(always)]`; one [`dispatch`] per pass chooses the
//! instruction set.

mod rows;

use fearless_simd::prelude::*;
pub use fearless_simd::{
    Level, Simd, dispatch, f32x4 as F32x4, f32x8 as F32x8, f32x16 as F32x16, f64x4 as F64x4,
    f64x8 as F64x8, i32x4 as I32x4, i32x8 as I32x8, i32x16 as I32x16, mask32x8 as Mask8,
    mask32x16 as Mask16, u8x16 as U8x16, u16x16 as U16x16, u16x32 as U16x32, u32x8 as U32x8,
    u32x16 as U32x16,
};
pub use rows::{columns_of_rows, narrowed, rows_of_columns, wide_points, widened};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// What fearless_simd's methods need in scope (`from_slice`, `store_slice`, `select`, comparisons
/// ...).
pub mod prelude {
    pub use fearless_simd::prelude::*;
}

/// How many lanes the wide types have.
pub const LANES: usize = 8;

/// How many lanes the widest [`Floats`] have.
pub const MOST_LANES: usize = 16;

/// One `f32` or eight of them.
pub trait Lanes:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f32, Output = Self>
    + Sub<f32, Output = Self>
    + Mul<f32, Output = Self>
    + Div<f32, Output = Self>
{
    /// One truth value for each lane.
    type Mask: Copy
        + BitAnd<Output = Self::Mask>
        + BitOr<Output = Self::Mask>
        + Not<Output = Self::Mask>;

    /// `value` in every lane (`self` only lends its instruction set).
    fn splat(self, value: f32) -> Self;
    /// Square root; NaN for negative values.
    fn sqrt(self) -> Self;
    /// Magnitude.
    fn abs(self) -> Self;
    /// Largest whole number not above.
    fn floor(self) -> Self;
    /// `self < other`.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self <= other`.
    fn le(self, other: Self) -> Self::Mask;
    /// `self` where the mask is true, else `other`.
    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self;
    /// Whether any lane is true.
    fn any(mask: Self::Mask) -> bool;
    /// `2^n` for whole `n` in `-126..=127`.
    fn exp2_whole(self) -> Self;
    /// For a positive normal number: its exponent as a whole number, and its mantissa in `1..2`.
    fn split_exponent(self) -> (Self, Self);
    /// What `f` gives, in a function of its own: for what is large and seldom needed. Functions in
    /// which everything is inlined grow until compilers take minutes over one.
    fn outlined<R>(self, f: impl FnOnce() -> R) -> R;

    /// The larger; `other` if either is NaN.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(other.lt(self), self, other)
    }

    /// The smaller; `other` if either is NaN.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }

    /// Clamped to `0..=1`; NaN gives 0.
    #[inline(always)]
    fn saturate(self) -> Self {
        self.max(self.splat(0.0)).min(self.splat(1.0))
    }

    /// `max(self, 0)`; NaN gives 0.
    #[inline(always)]
    fn positive(self) -> Self {
        self.max(self.splat(0.0))
    }

    /// 2 to the power `self`, relative error below 2e-7. Below -126 the result is 0, above 127 it
    /// stays at `2^127`.
    #[inline(always)]
    fn exp2(self) -> Self {
        let underflow = self.lt(self.splat(-126.0));
        let x = self.max(self.splat(-126.0)).min(self.splat(127.0));
        let whole = (x + 0.5).floor();
        let f = x - whole;
        // Taylor series of 2^f, |f| <= 0.5: the coefficients are ln2^k / k!, and 2^0 is exactly 1.
        let mut p = self.splat(1.525273380e-05);
        for c in [
            1.540353039e-04,
            1.333355815e-03,
            9.618129108e-03,
            5.550410866e-02,
            2.402265070e-01,
            std::f32::consts::LN_2,
            1.0,
        ] {
            p = p * f + c;
        }
        Self::select(underflow, self.splat(0.0), p * whole.exp2_whole())
    }

    /// Logarithm to base 2 of a positive number, absolute error below 2e-7 near 1 (relative
    /// elsewhere). Zero, negative and subnormal numbers count as `2^-126`.
    #[inline(always)]
    fn log2(self) -> Self {
        let (mut e, mut m) = self.max(self.splat(f32::MIN_POSITIVE)).split_exponent();
        let big = m.splat(std::f32::consts::SQRT_2).lt(m);
        m = Self::select(big, m * 0.5, m);
        e = Self::select(big, e + 1.0, e);
        // log2 m = 2/ln2 * atanh((m-1)/(m+1)), |t| <= 0.1716.
        let t = (m - 1.0) / (m + 1.0);
        let t2 = t * t;
        let mut p = self.splat(2.885_390_1 / 11.0);
        for c in [
            2.885_390_1 / 9.0,
            2.885_390_1 / 7.0,
            2.885_390_1 / 5.0,
            2.885_390_1 / 3.0,
            2.885_390_1,
        ] {
            p = p * t2 + c;
        }
        e + p * t
    }

    /// `self` to the power `exponent` for `self >= 0`: 1 for exponent 0, else 0 at 0.
    #[inline(always)]
    fn pow(self, exponent: Self) -> Self {
        let zero = self.splat(0.0);
        let p = (self.log2() * exponent).exp2();
        let p = Self::select(self.le(zero), zero, p);
        Self::select(exponent.le(zero) & zero.le(exponent), self.splat(1.0), p)
    }

    /// Linear light from an sRGB-encoded value.
    #[inline(always)]
    fn linear_from_srgb(self) -> Self {
        let curve = ((self + 0.055) / 1.055).positive().pow(self.splat(2.4));
        Self::select(self.le(self.splat(0.040_45)), self / 12.92, curve)
    }

    /// sRGB-encoded value from linear light.
    #[inline(always)]
    fn srgb_from_linear(self) -> Self {
        let curve = self.positive().pow(self.splat(1.0 / 2.4)) * 1.055 - 0.055;
        Self::select(self.le(self.splat(0.003_130_8)), self * 12.92, curve)
    }
}

impl Lanes for f32 {
    type Mask = bool;

    #[inline(always)]
    fn splat(self, value: f32) -> Self {
        value
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f32::sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f32::abs(self)
    }
    #[inline(always)]
    fn floor(self) -> Self {
        f32::floor(self)
    }
    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self < other
    }
    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self <= other
    }
    #[inline(always)]
    fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
        if mask { if_true } else { if_false }
    }
    #[inline(always)]
    fn any(mask: bool) -> bool {
        mask
    }
    #[inline(always)]
    fn exp2_whole(self) -> Self {
        f32::from_bits(((self as i32 + 127) as u32) << 23)
    }
    #[inline(always)]
    fn split_exponent(self) -> (Self, Self) {
        let bits = self.to_bits();
        (((bits >> 23) as i32 - 127) as f32, f32::from_bits((bits & 0x007f_ffff) | 0x3f80_0000))
    }
    #[inline(always)]
    fn outlined<R>(self, f: impl FnOnce() -> R) -> R {
        f()
    }
}

/// [`Lanes`] of a vector type.
macro_rules! lanes {
    ($floats:ident, $mask:ident, $ints:ident, $abs:ident, $max:ident, $min:ident) => {
        impl<S: Simd> Lanes for $floats<S> {
            type Mask = $mask<S>;

            #[inline(always)]
            fn splat(self, value: f32) -> Self {
                <Self as SimdBase<S>>::splat(self.token(), value)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                SimdFloat::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                self.token().$abs(self)
            }
            #[inline(always)]
            fn floor(self) -> Self {
                SimdFloat::floor(self)
            }
            #[inline(always)]
            fn lt(self, other: Self) -> Self::Mask {
                self.simd_lt(other)
            }
            #[inline(always)]
            fn le(self, other: Self) -> Self::Mask {
                self.simd_le(other)
            }
            #[inline(always)]
            fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self {
                Select::select(mask, if_true, if_false)
            }
            #[inline(always)]
            fn any(mask: Self::Mask) -> bool {
                mask.any_true()
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                if takes_second(self.token().level()) {
                    self.token().$max(self, other)
                } else {
                    Self::select(Lanes::lt(other, self), self, other)
                }
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                if takes_second(self.token().level()) {
                    self.token().$min(self, other)
                } else {
                    Self::select(Lanes::lt(self, other), self, other)
                }
            }
            #[inline(always)]
            fn exp2_whole(self) -> Self {
                let whole: $ints<S> = self.to_int();
                ((whole + 127) << 23).bitcast()
            }
            #[inline(always)]
            fn split_exponent(self) -> (Self, Self) {
                let bits: $ints<S> = self.bitcast();
                let exponent: Self = ((bits >> 23) - 127).to_float();
                (exponent, ((bits & 0x007f_ffff) | 0x3f80_0000).bitcast())
            }
            #[inline(always)]
            fn outlined<R>(self, f: impl FnOnce() -> R) -> R {
                outlined(self.token(), f)
            }
        }
    };
}

lanes!(F32x8, Mask8, I32x8, abs_f32x8, max_f32x8, min_f32x8);
lanes!(F32x16, Mask16, I32x16, abs_f32x16, max_f32x16, min_f32x16);

/// A truth value for each lane of `V`.
pub type MaskOf<S, V> = <V as SimdBase<S>>::Mask;

/// Eight floats or sixteen, and the whole numbers of as many lanes: [`F32x8`], [`F32x16`]. Where
/// the two traits share a name, say which is meant.
pub trait Floats<S: Simd>:
    SimdFloat<S, Element = f32> + SimdCvtFloat<Self::Ints> + Lanes<Mask = <Self as SimdBase<S>>::Mask>
{
    /// Signed integers.
    type Ints: SimdInt<S, Element = i32, Mask = <Self as SimdBase<S>>::Mask, ByteVector = Self::ByteVector>
        + SimdCvtTruncate<Self>;
    /// Unsigned integers.
    type Words: SimdInt<S, Element = u32, Mask = <Self as SimdBase<S>>::Mask, ByteVector = Self::ByteVector>;
    /// Two unsigned integers of 16 bits for each lane.
    type Halves: SimdInt<S, Element = u16, ByteVector = Self::ByteVector>;

    /// What `f` makes of eight lanes at a time, for what is written for eight; it is also told the
    /// first lane.
    fn by_eights<const IN: usize, const OUT: usize>(
        simd: S,
        numbers: [Self; IN],
        f: impl FnMut(usize, [F32x8<S>; IN]) -> [F32x8<S>; OUT],
    ) -> [Self; OUT];
}

impl<S: Simd> Floats<S> for F32x8<S> {
    type Ints = I32x8<S>;
    type Words = U32x8<S>;
    type Halves = U16x16<S>;

    #[inline(always)]
    fn by_eights<const IN: usize, const OUT: usize>(
        _: S,
        numbers: [Self; IN],
        mut f: impl FnMut(usize, [F32x8<S>; IN]) -> [F32x8<S>; OUT],
    ) -> [Self; OUT] {
        f(0, numbers)
    }
}

impl<S: Simd> Floats<S> for F32x16<S> {
    type Ints = I32x16<S>;
    type Words = U32x16<S>;
    type Halves = U16x32<S>;

    #[inline(always)]
    fn by_eights<const IN: usize, const OUT: usize>(
        simd: S,
        numbers: [Self; IN],
        mut f: impl FnMut(usize, [F32x8<S>; IN]) -> [F32x8<S>; OUT],
    ) -> [Self; OUT] {
        let zero = <F32x8<S> as SimdBase<S>>::splat(simd, 0.0);
        let (mut low, mut high) = ([zero; IN], [zero; IN]);
        for k in 0..IN {
            (low[k], high[k]) = simd.split_f32x16(numbers[k]);
        }
        let (low, high) = (f(0, low), f(LANES, high));
        let mut both = [<Self as SimdBase<S>>::splat(simd, 0.0); OUT];
        for k in 0..OUT {
            both[k] = simd.combine_f32x8(low[k], high[k]);
        }
        both
    }
}

#[inline(never)]
fn outlined<S: Simd, R>(simd: S, f: impl FnOnce() -> R) -> R {
    simd.vectorize(f)
}

/// Whether the instruction for the larger (smaller) of two numbers gives the second where they do
/// not compare, which is what [`Lanes::max`] promises. The instructions of x86 do; elsewhere it
/// takes a comparison and a selection.
#[inline(always)]
fn takes_second(level: Level) -> bool {
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    if matches!(level, Level::Sse2(_) | Level::Sse4_2(_) | Level::Avx2(_) | Level::Avx512(_)) {
        return true;
    }
    let _ = level;
    false
}

/// Whether a machine has no more than every x86-64 of 2003 had: its code is the longest, and hardly
/// anybody runs it.
#[inline(always)]
pub fn is_oldest(level: Level) -> bool {
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    if matches!(level, Level::Sse2(_)) {
        return true;
    }
    let _ = level;
    false
}

/// Whether registers hold sixteen numbers: where two must hold them, formulas of many numbers are
/// better off with eight.
#[inline(always)]
pub fn has_sixteen(level: Level) -> bool {
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    if matches!(level, Level::Avx512(_)) {
        return true;
    }
    let _ = level;
    false
}

/// What sixteen numbers are computed with where registers may hold as many; elsewhere [`F32x8`], so
/// that nobody compiles what nobody calls.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
pub type Widest<S> = F32x16<S>;
/// What sixteen numbers are computed with where registers may hold as many; elsewhere [`F32x8`], so
/// that nobody compiles what nobody calls.
#[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
pub type Widest<S> = F32x8<S>;

/// A vector of three lanes: eight directions or points, or one.
#[derive(Clone, Copy, Debug)]
pub struct V3<T> {
    /// First component.
    pub x: T,
    /// Second component.
    pub y: T,
    /// Third component.
    pub z: T,
}

impl<T: Lanes> V3<T> {
    /// From components.
    #[inline(always)]
    pub fn new(x: T, y: T, z: T) -> Self {
        Self { x, y, z }
    }
    /// The same three numbers in every lane of `like`'s kind.
    #[inline(always)]
    pub fn splat(like: T, v: [f32; 3]) -> Self {
        Self { x: like.splat(v[0]), y: like.splat(v[1]), z: like.splat(v[2]) }
    }
    /// From components.
    #[inline(always)]
    pub fn from_array([x, y, z]: [T; 3]) -> Self {
        Self { x, y, z }
    }
    /// Components.
    #[inline(always)]
    pub fn to_array(self) -> [T; 3] {
        [self.x, self.y, self.z]
    }
    /// Inner product.
    #[inline(always)]
    pub fn dot(self, o: Self) -> T {
        self.x * o.x + self.y * o.y + self.z * o.z
    }
    /// Cross product.
    #[inline(always)]
    pub fn cross(self, o: Self) -> Self {
        Self::new(
            self.y * o.z - self.z * o.y,
            self.z * o.x - self.x * o.z,
            self.x * o.y - self.y * o.x,
        )
    }
    /// Each component times `s`.
    #[inline(always)]
    pub fn scale(self, s: T) -> Self {
        Self::new(self.x * s, self.y * s, self.z * s)
    }
    /// Component-wise product.
    #[inline(always)]
    pub fn times(self, o: Self) -> Self {
        Self::new(self.x * o.x, self.y * o.y, self.z * o.z)
    }
    /// Each component through `f`.
    #[inline(always)]
    pub fn map(self, f: impl Fn(T) -> T) -> Self {
        Self::new(f(self.x), f(self.y), f(self.z))
    }
    /// Unit vector; the zero vector stays zero.
    #[inline(always)]
    pub fn normalize(self) -> Self {
        let length2 = self.dot(self);
        let zero = length2.splat(0.0);
        let inverse = T::select(zero.lt(length2), length2.splat(1.0) / length2.sqrt(), zero);
        self.scale(inverse)
    }
    /// `if_true` where the mask is true, else `if_false`.
    #[inline(always)]
    pub fn select(mask: T::Mask, if_true: Self, if_false: Self) -> Self {
        Self::new(
            T::select(mask, if_true.x, if_false.x),
            T::select(mask, if_true.y, if_false.y),
            T::select(mask, if_true.z, if_false.z),
        )
    }
}

impl<T: Lanes> Add for V3<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self::new(self.x + o.x, self.y + o.y, self.z + o.z)
    }
}

impl<T: Lanes> Sub for V3<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self::new(self.x - o.x, self.y - o.y, self.z - o.z)
    }
}

impl<T: Lanes> Neg for V3<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

/// Gives `f` back. A closure in a call may carry `#[inline(always)]`; one on its own may not, and a
/// closure that is not inlined computes without the pass's instruction set.
#[inline(always)]
pub fn inlined<F>(f: F) -> F {
    f
}

/// `[f(0), f(1), f(2)]`, surely inlined.
#[inline(always)]
pub fn three<U>(f: impl Fn(usize) -> U) -> [U; 3] {
    [f(0), f(1), f(2)]
}

/// `[f(0), f(1), f(2), f(3)]`, surely inlined.
#[inline(always)]
pub fn four<U>(f: impl Fn(usize) -> U) -> [U; 4] {
    [f(0), f(1), f(2), f(3)]
}

/// Whether the instruction set has an instruction that puts bytes into any order.
pub fn orders_bytes(level: Level) -> bool {
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    return matches!(level, Level::Sse4_2(_) | Level::Avx2(_) | Level::Avx512(_));
    #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
    {
        let _ = level;
        cfg!(any(target_arch = "aarch64", target_feature = "simd128"))
    }
}

/// The instruction set to use: the machine's best, or what the environment variable `VITRAL_SIMD`
/// names (`scalar`, `sse2`, `avx2`, `avx512`, `best`).
///
/// # Errors
/// A name that is unknown or not available; the text lists those that are.
pub fn level_from_environment() -> Result<Level, String> {
    match std::env::var("VITRAL_SIMD") {
        Err(_) => Ok(Level::new()),
        Ok(name) => level_by_name(&name).ok_or_else(|| {
            let available: Vec<_> = available_levels().iter().map(|(n, _)| *n).collect();
            format!("VITRAL_SIMD={name}: this machine has {}", available.join(", "))
        }),
    }
}

/// A level by its name, if this machine has it.
pub fn level_by_name(name: &str) -> Option<Level> {
    if name == "best" {
        return Some(Level::new());
    }
    available_levels().into_iter().find(|(n, _)| *n == name).map(|(_, level)| level)
}

/// Every level that can run here, slowest first. Pictures do not depend on it.
pub fn available_levels() -> Vec<(&'static str, Level)> {
    #[allow(unused_mut)]
    let mut levels: Vec<(&'static str, Level)> = Vec::new();
    #[cfg(feature = "scalar")]
    levels.push(("scalar", Level::fallback()));
    // Where there is nothing else, it needs no feature.
    #[cfg(not(any(
        feature = "scalar",
        target_arch = "x86_64",
        target_arch = "aarch64",
        target_feature = "simd128"
    )))]
    levels.push(("scalar", Level::new()));
    #[cfg(target_arch = "x86_64")]
    {
        let best = Level::new();
        levels.extend(best.as_sse2().map(|s| ("sse2", s.level())));
        levels.extend(best.as_avx2().map(|s| ("avx2", s.level())));
        levels.extend(best.as_avx512().map(|s| ("avx512", s.level())));
    }
    #[cfg(target_arch = "aarch64")]
    levels.extend(Level::new().as_neon().map(|s| ("neon", s.level())));
    #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
    levels.push(("simd128", Level::new()));
    levels
}

#[cfg(test)]
mod tests;
