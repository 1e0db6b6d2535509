//! The crates below this one, for those who study or extend the algorithms. **There is no promise
//! of stability**: names in here change with any version. What programs need stands at the top of
//! the crate.

pub use vitral_draw as draw;
pub use vitral_exec as exec;
pub use vitral_frame as frame;
pub use vitral_io as io;
pub use vitral_light as light;
pub use vitral_math as math;
pub use vitral_raster as raster;
pub use vitral_render as render;
pub use vitral_scene as scene;
