//! Arguments out of the fuzzer's bytes.

use vitral_gl::memory::Arena;
use vitral_gl::{ClientMemory, enums as gl};

/// Where the client's memory begins.
pub(super) const BASE: usize = 0x10_0000;
/// Its size.
pub(super) const LEN: usize = 1 << 19;

/// The client's memory: a quarter each of floats about 0, small whole numbers, noise, and zeros.
pub(super) fn memory() -> Arena {
    let arena = Arena::new(BASE, LEN);
    let quarter = LEN / 4;
    let mut random = 1u32;
    let mut next = || {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        random >> 8
    };
    let floats: Vec<u8> =
        (0..quarter / 4).flat_map(|_| (next() as f32 / 4e6 - 2.0).to_ne_bytes()).collect();
    let numbers: Vec<u8> = (0..quarter / 4).flat_map(|_| (next() % 32).to_ne_bytes()).collect();
    let noise: Vec<u8> = (0..quarter).map(|_| next() as u8).collect();
    for (i, bytes) in [floats, numbers, noise].iter().enumerate() {
        assert!(arena.write(BASE + i * quarter, bytes));
    }
    arena
}

/// Bytes that are used up; behind their end come zeros.
#[derive(Debug)]
pub(crate) struct Source<'a> {
    bytes: &'a [u8],
}

/// What a call takes.
pub(super) trait Argument: Sized {
    /// A value that may well be valid.
    fn any(source: &mut Source<'_>) -> Self;
    /// A token.
    fn token(token: u32) -> Self;
}

impl<'a> Source<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    pub(crate) fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.bytes.split_first() else { return 0 };
        self.bytes = rest;
        *first
    }

    pub(crate) fn word(&mut self) -> u32 {
        u32::from_le_bytes(std::array::from_fn(|_| self.byte()))
    }

    /// One of so many, at most 65,536.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        let number =
            usize::from(self.byte()) | usize::from(if count > 256 { self.byte() } else { 0 }) << 8;
        number % count.max(1)
    }

    pub(super) fn any<A: Argument>(&mut self) -> A {
        A::any(self)
    }

    /// A value of the group, seldom two of its bits, or anything.
    pub(super) fn of<A: Argument>(&mut self, group: &[u32]) -> A {
        let kind = self.byte();
        let token = group[self.below(group.len())];
        match kind {
            0..=7 => A::any(self),
            8..=31 => A::token(token | group[self.below(group.len())]),
            _ => A::token(token),
        }
    }

    fn whole(&mut self) -> i64 {
        match self.byte() {
            0..=99 => i64::from(self.byte() % 5),
            100..=179 => i64::from(self.byte() % 65),
            180..=199 => -i64::from(self.byte() % 70),
            200..=229 => i64::from(VALUES[self.below(VALUES.len())]),
            230..=247 => i64::from(1u32 << (self.byte() % 16)) + i64::from(self.byte() % 3) - 1,
            248..=251 => i64::from(i32::MAX) - i64::from(self.byte()),
            252 => i64::from(i32::MIN),
            _ => i64::from(self.word() as i32),
        }
    }

    fn real(&mut self) -> f64 {
        match self.byte() {
            0..=79 => [0.0, 1.0, 0.5, -1.0, 2.0, 0.25, 3.0, 10.0][usize::from(self.byte() % 8)],
            80..=189 => f64::from(self.byte() as i8) / 64.0,
            190..=219 => f64::from(self.byte()) / 2.0,
            220..=239 => self.whole() as f64,
            240..=243 => f64::from(f32::MAX) * 0.5,
            244..=246 => 1e-38,
            247 => f64::NAN,
            248 => f64::INFINITY,
            249 => -1e30,
            _ => f64::from(f32::from_bits(self.word())),
        }
    }
}

/// What parameters without a group take: filters, wraps, comparisons, environments and their like.
const VALUES: &[u32] = &[
    gl::NEAREST,
    gl::LINEAR,
    gl::NEAREST_MIPMAP_NEAREST,
    gl::LINEAR_MIPMAP_NEAREST,
    gl::NEAREST_MIPMAP_LINEAR,
    gl::LINEAR_MIPMAP_LINEAR,
    gl::CLAMP,
    gl::REPEAT,
    gl::CLAMP_TO_EDGE,
    gl::CLAMP_TO_BORDER,
    gl::MIRRORED_REPEAT,
    gl::COMPARE_R_TO_TEXTURE,
    gl::LEQUAL,
    gl::GREATER,
    gl::MODULATE,
    gl::DECAL,
    gl::BLEND,
    gl::REPLACE,
    gl::ADD,
    gl::COMBINE,
    gl::INTERPOLATE,
    gl::DOT3_RGBA,
    gl::TEXTURE,
    gl::PREVIOUS,
    gl::CONSTANT,
    gl::PRIMARY_COLOR,
    gl::SRC_ALPHA,
    gl::ONE_MINUS_SRC_COLOR,
    gl::OBJECT_LINEAR,
    gl::EYE_LINEAR,
    gl::SPHERE_MAP,
    gl::REFLECTION_MAP,
    gl::NORMAL_MAP,
    gl::LUMINANCE,
    gl::INTENSITY,
    gl::EXP,
    gl::EXP2,
    gl::FOG_COORDINATE,
    gl::SEPARATE_SPECULAR_COLOR,
    gl::TEXTURE0,
    gl::TEXTURE2,
    gl::UPPER_LEFT,
    gl::TEXTURE_2D,
    gl::FLOAT,
    gl::UNSIGNED_BYTE,
    gl::RGBA,
    gl::DEPTH_COMPONENT24,
    gl::DEPTH24_STENCIL8,
    gl::RGBA8,
    gl::RGBA32F_ARB,
    gl::COLOR_ATTACHMENT0,
];

macro_rules! numbers {
    ($from:ident: $($kind:ty)*) => {
        $(impl Argument for $kind {
            fn any(source: &mut Source<'_>) -> Self {
                source.$from() as Self
            }
            fn token(token: u32) -> Self {
                token as Self
            }
        })*
    };
}

numbers!(whole: u8 i8 u16 i16 u32 i32 u64 isize);
numbers!(real: f32 f64);

impl Argument for usize {
    fn any(source: &mut Source<'_>) -> Self {
        match source.byte() {
            0..=199 => BASE + ((source.word() as usize % LEN) & !3),
            200..=219 => usize::from(source.byte()) * 4,
            220..=234 => 0,
            235..=244 => BASE + LEN - usize::from(source.byte()),
            245..=250 => BASE + LEN + source.word() as usize % (1 << 20),
            _ => (source.word() as usize).wrapping_shl(source.byte().into()),
        }
    }

    fn token(token: u32) -> Self {
        token as Self
    }
}

/// What a pointer at a few numbers points at; seldom nothing.
impl<T: Argument, const N: usize> Argument for Option<[T; N]> {
    fn any(source: &mut Source<'_>) -> Self {
        (source.byte() < 250).then(|| std::array::from_fn(|_| T::any(source)))
    }

    fn token(token: u32) -> Self {
        Some(std::array::from_fn(|_| T::token(token)))
    }
}
