//! State calls, one file per chapter of the specification.

mod arguments;
mod attributes;
mod blending;
mod capabilities;
mod debug;
mod fog;
mod foreign;
mod fragment;
mod get;
mod lights;
mod materials;
mod matrices;
mod pixel_maps;
mod pixel_store;
mod queries;
mod raster;
mod stipple;
mod sync;
#[cfg(test)]
mod testing;
mod texture_environment;
mod texture_generation;
mod transform;

pub(crate) use attributes::AttribStacks;
pub(crate) use debug::DebugState;
pub(crate) use debug::Labels;
pub use debug::{DebugHook, DebugMessage};
pub(crate) use get::integer_of_component;
pub(crate) use queries::Queries;
pub(crate) use sync::Fences;

use crate::{Context, enums as gl};

/// The token of an error, as the specification spells it.
fn error_name(error: u32) -> &'static str {
    match error {
        gl::INVALID_ENUM => "GL_INVALID_ENUM",
        gl::INVALID_VALUE => "GL_INVALID_VALUE",
        gl::INVALID_OPERATION => "GL_INVALID_OPERATION",
        gl::STACK_OVERFLOW => "GL_STACK_OVERFLOW",
        gl::STACK_UNDERFLOW => "GL_STACK_UNDERFLOW",
        gl::OUT_OF_MEMORY => "GL_OUT_OF_MEMORY",
        gl::INVALID_FRAMEBUFFER_OPERATION => "GL_INVALID_FRAMEBUFFER_OPERATION",
        _ => "unknown error",
    }
}

/// Tokens in the client's memory.
pub(crate) fn read_tokens<const N: usize>(
    memory: &dyn crate::ClientMemory,
    address: usize,
) -> Option<[u32; N]> {
    arguments::read(memory, address, N)
}

impl Context {
    /// Records `error` if none is pending, and tells the debug output: `call` is the entry point
    /// (`glEnable`), `why` a sentence.
    pub fn record_error(&mut self, error: u32, call: &str, why: &str) {
        if self.error == gl::NO_ERROR {
            self.error = error;
        }
        self.report_error(error, &format!("{} in {call}: {why}", error_name(error)));
    }

    /// `glGetError`.
    pub fn get_error(&mut self) -> u32 {
        if !self.may_set("glGetError") {
            return gl::NO_ERROR;
        }
        std::mem::replace(&mut self.error, gl::NO_ERROR)
    }

    /// `glFlush`.
    pub fn flush(&mut self) {
        if self.may_set("glFlush") {
            self.flush_recorded();
            self.store_default_framebuffer();
        }
    }

    /// `glFinish`.
    pub fn finish(&mut self) {
        if self.may_set("glFinish") {
            self.flush_recorded();
            self.store_default_framebuffer();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::testing::context;
    use crate::enums as gl;

    #[test]
    fn the_first_error_sticks() {
        let mut c = context();
        c.enable(0xFFFF);
        c.line_width(-1.0);
        assert_eq!(c.get_error(), gl::INVALID_ENUM);
        assert_eq!(c.get_error(), gl::NO_ERROR);
        assert_eq!(c.state.lines.width, 1.0);
    }
}
