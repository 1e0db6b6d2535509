//! A context over an arena, for the tests of this room.

use crate::memory::Arena;
use crate::objects::Shared;
use crate::{Context, enums};
use std::sync::Arc;

/// Where the arena begins.
pub(crate) const BASE: usize = 0x1_0000;
/// Its size.
const LEN: usize = 1 << 20;

/// A context without a framebuffer.
pub(crate) fn context() -> Context {
    Context::new(Arc::new(Arena::new(BASE, LEN)), Arc::new(Shared::default()))
}

/// A context whose framebuffer of RGBA bytes lies in the upper half of the arena.
pub(crate) fn context_with(width: i32, height: i32) -> Context {
    let mut c = context();
    c.configure_default_framebuffer(enums::RGBA, 24, 8, 16);
    assert!(c.make_current(BASE + LEN / 2, enums::UNSIGNED_BYTE, width, height));
    c
}

/// Puts bytes into the arena.
pub(crate) fn put(c: &Context, address: usize, bytes: &[u8]) {
    assert!(c.memory.write(address, bytes));
}

/// Takes bytes from the arena.
pub(crate) fn get<const N: usize>(c: &Context, address: usize) -> [u8; N] {
    let mut bytes = [0; N];
    assert!(c.memory.read(address, &mut bytes));
    bytes
}

/// Takes a number from the arena.
pub(crate) fn read_u32(c: &Context, address: usize) -> u32 {
    u32::from_ne_bytes(get(c, address))
}

/// Takes floats from the arena.
pub(crate) fn read_floats<const N: usize>(c: &Context, address: usize) -> [f32; N] {
    std::array::from_fn(|i| f32::from_bits(read_u32(c, address + 4 * i)))
}
