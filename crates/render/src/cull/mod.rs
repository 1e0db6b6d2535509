//! Throwing away early what cannot be seen. Nothing here changes a picture.

pub mod backface;
pub mod bounds_tree;
pub mod frustum;
pub(crate) mod opacity;
pub(crate) mod window;
