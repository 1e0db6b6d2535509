//! Vertex arrays: pointers, draws, vertex array objects.

mod cache;
mod draw;
mod fetch;
mod interleaved;
mod objects;
mod pointers;
mod repeats;

use super::attribute::{COLOR, EDGE, FOG, INDEX, NORMAL, SECONDARY, TEX};
use crate::Context;
use crate::enums::BUFFER;
use crate::names::Names;
use crate::objects::BufferHandle;
use crate::state::{ArrayPointer, ClientState};

/// Positions, beside the attributes.
const POSITION: usize = super::attribute::COUNT;

/// What a context keeps about vertex arrays besides its client state.
#[derive(Debug, Default)]
pub(crate) struct Arrays {
    /// Batches built from buffer objects.
    cache: cache::Cache,
    /// Batches built from the client's memory.
    repeats: repeats::Repeats,
    /// Vertex array objects that are not bound; 0 is the default one.
    objects: Names<objects::VertexArray>,
    /// `LockArraysEXT`: first and count.
    pub(crate) locked: Option<(i32, i32)>,
}

impl ClientState {
    /// The array of attribute `which`, or of positions.
    fn array(&self, which: usize) -> &ArrayPointer {
        match which {
            POSITION => &self.vertex,
            NORMAL => &self.normal,
            COLOR => &self.color,
            SECONDARY => &self.secondary,
            FOG => &self.fog,
            EDGE => &self.edge,
            INDEX => &self.index,
            _ => &self.tex[which - TEX],
        }
    }

    /// The array of attribute `which`, or of positions, to change.
    fn array_mut(&mut self, which: usize) -> &mut ArrayPointer {
        match which {
            POSITION => &mut self.vertex,
            NORMAL => &mut self.normal,
            COLOR => &mut self.color,
            SECONDARY => &mut self.secondary,
            FOG => &mut self.fog,
            EDGE => &mut self.edge,
            INDEX => &mut self.index,
            _ => &mut self.tex[which - TEX],
        }
    }
}

impl Context {
    /// Unbinds a deleted buffer. Array objects that are not bound keep it, and so do other
    /// contexts.
    pub(super) fn forget_buffer(&mut self, buffer: &BufferHandle) {
        self.forget_label(BUFFER, buffer.name);
        let client = &mut self.client;
        let (pack, unpack) = (&mut client.pack.buffer, &mut client.unpack.buffer);
        let [read, write] = &mut client.copy_buffers;
        for binding in
            [&mut client.array_buffer, &mut client.element_buffer, pack, unpack, read, write]
        {
            if binding == buffer {
                *binding = BufferHandle::NONE;
            }
        }
        for which in 0..=POSITION {
            let array = client.array_mut(which);
            if array.buffer == *buffer {
                // What was an offset must not become an address.
                (array.buffer, array.pointer) = (BufferHandle::NONE, 0);
            }
        }
        self.arrays.cache.forget(buffer.id());
        self.arrays.repeats.forget(buffer.id());
    }
}
