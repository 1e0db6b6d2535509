//! The per-fragment operations, on rows of eight pixels: coverage, alpha, stencil and depth tests,
//! blending, logic operations, masks. Each is one function; their order is the caller's.

pub(crate) mod blend;
pub(crate) mod compare;
pub(crate) mod coverage;
pub(crate) mod logic;
pub(crate) mod packed;
pub(crate) mod stencil;
