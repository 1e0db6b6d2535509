//! A context: all state of one OpenGL machine.

use crate::api::{AttribStacks, DebugState, Queries};
use crate::enums;
use crate::memory::ClientMemory;
use crate::objects::Shared;
use crate::pixels::{DefaultFramebuffer, FramebufferBindings, TextureBindings};
use crate::state::{ClientState, State};
use crate::tnl::Recorder;
use crate::vertices::{Arrays, Builder, Feedback, Lists};
use std::sync::Arc;

/// An OpenGL context.
#[derive(Debug)]
pub struct Context {
    /// Server state.
    pub state: State,
    /// Client state.
    pub client: ClientState,
    /// Objects, perhaps shared with other contexts.
    pub shared: Arc<Shared>,
    /// The client's memory.
    pub(crate) memory: Arc<dyn ClientMemory>,
    /// The oldest error not yet asked for.
    pub(crate) error: u32,
    /// KHR_debug and the debug variable.
    pub(crate) debug: DebugState,
    /// `PushAttrib`, `PushClientAttrib`.
    pub(crate) stacks: AttribStacks,
    /// Occlusion queries.
    pub(crate) queries: Queries,
    /// Vertex arrays, beyond the client state.
    pub(crate) arrays: Arrays,
    /// Begin/End.
    pub(crate) builder: Builder,
    /// Display lists being made and called.
    pub(crate) lists: Lists,
    /// Feedback and selection.
    pub(crate) feedback: Feedback,
    /// Textures that are bound, default and proxy ones.
    pub(crate) textures: TextureBindings,
    /// Framebuffer objects and their bindings.
    pub(crate) framebuffers: FramebufferBindings,
    /// What the window system (OSMesa) gave.
    pub(crate) default_framebuffer: DefaultFramebuffer,
    /// Recorded passes.
    pub(crate) recorder: Recorder,
    /// `VERSION` begins with 2.1.
    pub(crate) says_2_1: bool,
}

impl Context {
    /// A context in its initial state, without a framebuffer. Objects are shared with every context
    /// that has the same `shared`.
    pub fn new(memory: Arc<dyn ClientMemory>, shared: Arc<Shared>) -> Self {
        Self {
            state: State::default(),
            client: ClientState::default(),
            shared,
            memory,
            error: enums::NO_ERROR,
            debug: DebugState::default(),
            stacks: AttribStacks::default(),
            queries: Queries::default(),
            arrays: Arrays::default(),
            builder: Builder::default(),
            lists: Lists::default(),
            feedback: Feedback::default(),
            textures: TextureBindings::default(),
            framebuffers: FramebufferBindings::default(),
            default_framebuffer: DefaultFramebuffer::default(),
            recorder: Recorder::default(),
            says_2_1: false,
        }
    }
}
