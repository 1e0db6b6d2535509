//! What the tests of this room share.

use crate::memory::Arena;
use crate::{Context, Shared};
use std::sync::Arc;

/// Where the arena begins.
pub(super) const BASE: usize = 0x1000;

/// A context with 64 KiB of client memory at [`BASE`].
pub(super) fn context() -> Context {
    Context::new(Arc::new(Arena::new(BASE, 1 << 16)), Arc::new(Shared::default()))
}

/// Puts values at [`BASE`]; returns that address.
pub(super) fn put<T: bytemuck::NoUninit>(c: &Context, values: &[T]) -> usize {
    assert!(c.memory.write(BASE, bytemuck::cast_slice(values)));
    BASE
}

/// Takes values from `BASE + 0x8000`, where the tests let results go.
pub(super) fn take<T: bytemuck::Pod, const N: usize>(c: &Context) -> [T; N] {
    super::arguments::read(&*c.memory, RESULT, N).unwrap()
}

/// Where results go.
pub(super) const RESULT: usize = BASE + 0x8000;
