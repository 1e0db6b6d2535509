//! State that other rooms keep, as queries and attribute stacks ask for it.

use crate::{Context, enums as gl};

/// What the draw framebuffer has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct FramebufferBits {
    /// Red, green, blue, alpha.
    pub color: [u32; 4],
    /// Depth; 32 for floating point.
    pub depth: u32,
    /// Stencil.
    pub stencil: u32,
    /// Red, green, blue, alpha of the accumulation buffer.
    pub accum: [u32; 4],
    /// 0 without multisampling.
    pub samples: u32,
    /// `DOUBLEBUFFER`.
    pub double_buffer: bool,
}

/// Parameters of the textures bound to all units, kept by `PushAttrib(TEXTURE_BIT)`.
#[derive(Clone, Debug, Default)]
pub(crate) struct BoundTextures {}

impl Context {
    /// Told after materials changed, which may happen between vertices.
    pub(crate) fn material_changed(&mut self) {}

    /// `DRAW_FRAMEBUFFER_BINDING`.
    pub(crate) fn draw_framebuffer_name(&self) -> u32 {
        0
    }

    /// `READ_FRAMEBUFFER_BINDING`.
    pub(crate) fn read_framebuffer_name(&self) -> u32 {
        0
    }

    /// `RENDERBUFFER_BINDING`.
    pub(crate) fn renderbuffer_name(&self) -> u32 {
        0
    }

    /// `DRAW_BUFFER` of the bound framebuffer.
    pub(crate) fn draw_buffer_token(&self) -> u32 {
        self.state.color_buffer.draw_buffer
    }

    /// `READ_BUFFER` of the bound framebuffer.
    pub(crate) fn read_buffer_token(&self) -> u32 {
        self.state.pixel_mode.read_buffer
    }

    /// Sets `DRAW_BUFFER` of the bound framebuffer to a value it had.
    pub(crate) fn set_draw_buffer_token(&mut self, token: u32) {
        self.state.color_buffer.draw_buffer = token;
    }

    /// Sets `READ_BUFFER` of the bound framebuffer to a value it had.
    pub(crate) fn set_read_buffer_token(&mut self, token: u32) {
        self.state.pixel_mode.read_buffer = token;
    }

    /// The bits of the draw framebuffer.
    pub(crate) fn framebuffer_bits(&mut self) -> FramebufferBits {
        FramebufferBits { color: [8; 4], depth: 24, stencil: 8, accum: [0; 4], samples: 0, double_buffer: false }
    }

    /// `RENDER_MODE`.
    pub(crate) fn render_mode_token(&self) -> u32 {
        gl::RENDER
    }

    /// Address, size and type of the feedback buffer.
    pub(crate) fn feedback_buffer_state(&self) -> (usize, i32, u32) {
        (0, 0, gl::_2D)
    }

    /// Address and size of the selection buffer.
    pub(crate) fn selection_buffer_state(&self) -> (usize, i32) {
        (0, 0)
    }

    /// `NAME_STACK_DEPTH`.
    pub(crate) fn name_stack_depth(&self) -> usize {
        0
    }

    /// `LIST_INDEX` and `LIST_MODE` of the list that is being compiled; 0 and 0 for none.
    pub(crate) fn compiling_list(&self) -> (u32, u32) {
        (0, 0)
    }

    /// `ARRAY_ELEMENT_LOCK_FIRST_EXT`, `ARRAY_ELEMENT_LOCK_COUNT_EXT`.
    pub(crate) fn locked_elements(&self) -> (i32, i32) {
        (0, 0)
    }

    /// Whether there is an object. `kind` is a token of `ObjectLabel` (`BUFFER`, `TEXTURE` ...).
    pub(crate) fn object_exists(&self, kind: u32, name: u32) -> bool {
        match kind {
            gl::QUERY => self.queries.is_object(name),
            _ => false,
        }
    }

    /// Keeps the parameters of all bound textures.
    pub(crate) fn save_bound_textures(&mut self) -> BoundTextures {
        BoundTextures::default()
    }

    /// Gives the textures that were bound then their parameters back, as far as they still exist.
    pub(crate) fn restore_bound_textures(&mut self, saved: &BoundTextures) {
        let _ = saved;
    }

    /// Binds a vertex array object: its arrays move to `client`, those of the one bound before move out.
    pub(crate) fn switch_vertex_array(&mut self, name: u32) {
        self.client.vertex_array = name;
    }
}
