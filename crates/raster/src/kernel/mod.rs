//! The hot loops, generic over the instruction set. Each is entered through one dispatch a batch or
//! tile.

pub(crate) mod block;
pub(crate) mod nearest;
pub(crate) mod plane;
pub(crate) mod sift;
pub(crate) mod slender;
#[cfg(any(test, feature = "forward"))]
pub(crate) mod tiny;
pub(crate) mod transform;
pub(crate) mod traverse;
