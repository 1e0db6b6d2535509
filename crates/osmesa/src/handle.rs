//! What an `OSMesaContext` points to.

use crate::attributes::Attributes;
use crate::environment;
use crate::memory::ProcessMemory;
use std::cell::UnsafeCell;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use vitral_gl::{Context, Shared};

/// The buffer that a context was last made current with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Binding {
    /// Address of the client's colour buffer.
    pub(crate) buffer: usize,
    /// Type of a component.
    pub(crate) kind: u32,
    /// Pixels.
    pub(crate) width: i32,
    /// Pixels.
    pub(crate) height: i32,
}

/// A context with what OSMesa itself keeps of it.
#[derive(Debug)]
pub(crate) struct Machine {
    /// The state machine.
    pub(crate) context: Context,
    /// What it was made as.
    pub(crate) attributes: Attributes,
    /// Where it draws, since it was first made current.
    pub(crate) binding: Option<Binding>,
    /// `OSMESA_ROW_LENGTH`; 0 is the width.
    pub(crate) row_length: i32,
    /// `OSMESA_Y_UP`.
    pub(crate) y_up: bool,
    /// What `OSMesaGetDepthBuffer` handed out: lowest row first.
    pub(crate) depth: DepthCopy,
}

/// Depth values at an address that stays while the size does.
#[derive(Debug)]
pub(crate) enum DepthCopy {
    /// Up to 16 bits.
    Bits16(Vec<u16>),
    /// More, in the low bits.
    Bits32(Vec<u32>),
}

/// What an `OSMesaContext` points to. One thread at a time may have the context current; others may destroy it: then
/// it goes when that thread lets go of it.
#[derive(Debug)]
pub(crate) struct Handle {
    /// For contexts that will share with this one.
    shared: Arc<Shared>,
    /// Buffers mapped by one context may be unmapped by another that shares them.
    memory: Arc<ProcessMemory>,
    /// Threads that have it current, plus one until it is destroyed.
    users: AtomicUsize,
    /// Only for the thread that has it current, or, while nobody has, for the one that calls an OSMesa function with it.
    machine: UnsafeCell<Machine>,
}

impl Handle {
    /// A new context in the client's hands: its address is an `OSMesaContext`.
    pub(crate) fn create(attributes: Attributes, share: Option<&Self>) -> *const Self {
        let (shared, memory) =
            share.map_or_else(Default::default, |other| (Arc::clone(&other.shared), Arc::clone(&other.memory)));
        let mut context = Context::new(Arc::<ProcessMemory>::clone(&memory), Arc::clone(&shared));
        context.set_threads(environment::threads());
        context.set_error_output(environment::debug().then_some(environment::say as fn(&str)));
        let depth =
            if attributes.depth_bits <= 16 { DepthCopy::Bits16(Vec::new()) } else { DepthCopy::Bits32(Vec::new()) };
        let machine = Machine { context, attributes, binding: None, row_length: 0, y_up: true, depth };
        Box::into_raw(Box::new(Self { shared, memory, users: AtomicUsize::new(1), machine: UnsafeCell::new(machine) }))
    }

    /// The machine.
    pub(crate) fn machine(&self) -> *mut Machine {
        self.machine.get()
    }

    /// One more thread has it current.
    pub(crate) fn acquire(&self) {
        self.users.fetch_add(1, Ordering::Relaxed);
    }

    /// A thread, or the client, lets go of it; the last one frees it.
    ///
    /// # Safety
    /// `handle` came from [`Handle::create`], and this is called once for the creation and once for each
    /// [`Handle::acquire`].
    pub(crate) unsafe fn release(handle: *const Self) {
        // SAFETY: one use is still counted, the caller's, so the handle is alive.
        let users = unsafe { &(*handle).users };
        if users.fetch_sub(1, Ordering::AcqRel) == 1 {
            // SAFETY: it was the last use; the box was made by `create`.
            drop(unsafe { Box::from_raw(handle.cast_mut()) });
        }
    }
}
