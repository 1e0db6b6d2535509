//! What an `OSMesaContext` points to.

use crate::attributes::Attributes;
use crate::environment;
use crate::memory::ProcessMemory;
use crate::messages::Messages;
use crate::pool;
use std::cell::UnsafeCell;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use vitral_gl::{Context, Shared};

/// A context with what OSMesa itself keeps of it.
#[derive(Debug)]
pub(crate) struct Machine {
    /// The state machine.
    pub(crate) context: Context,
    /// What it was made as.
    pub(crate) attributes: Attributes,
    /// What `OSMesaGetDepthBuffer` handed out, in words so that it is aligned: lowest row first.
    pub(crate) depths: Vec<u32>,
}

/// Threads hand a machine on to each other.
const _: () = {
    const fn can_be_sent<T: Send>() {}
    can_be_sent::<Machine>();
};

/// What an `OSMesaContext` points to. One thread at a time may have the context current; others may
/// destroy it: then it goes when that thread lets go of it.
#[derive(Debug)]
pub(crate) struct Handle {
    /// Messages for the client's debug callback.
    pub(crate) messages: Arc<Messages>,
    /// For contexts that will share with this one.
    shared: Arc<Shared>,
    /// Buffers mapped by one context may be unmapped by another that shares them.
    memory: Arc<ProcessMemory>,
    /// Threads that have it current, plus one until it is destroyed.
    users: AtomicUsize,
    /// Only for the thread that has it current, or, while nobody has, for the one that calls an
    /// OSMesa function with it.
    machine: UnsafeCell<Machine>,
}

impl Handle {
    /// A new context in the client's hands: its address is an `OSMesaContext`.
    pub(crate) fn create(attributes: Attributes, share: Option<&Self>) -> *const Self {
        let (shared, memory) = match share {
            Some(other) => (Arc::clone(&other.shared), Arc::clone(&other.memory)),
            None => (Arc::new(Shared::with_own_names()), Arc::default()),
        };
        let messages = Arc::<Messages>::default();
        let mut context = Context::new(Arc::<ProcessMemory>::clone(&memory), Arc::clone(&shared));
        context.set_runner_source(pool::runner);
        context.set_merging(true);
        context.set_debug_printer(environment::debug().then_some(environment::say as fn(&str)));
        context.set_debug_hook(Some(messages.hook()));
        let Attributes { format, depth_bits, stencil_bits, accum_bits, .. } = attributes;
        if attributes.says_2_1 {
            context.say_2_1();
        }
        context.configure_default_framebuffer(format, depth_bits, stencil_bits, accum_bits);
        let machine = UnsafeCell::new(Machine { context, attributes, depths: Vec::new() });
        Box::into_raw(Box::new(Self {
            messages,
            shared,
            memory,
            users: AtomicUsize::new(1),
            machine,
        }))
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
    /// `handle` came from [`Handle::create`], and this is called once for the creation and once for
    /// each [`Handle::acquire`].
    pub(crate) unsafe fn release(handle: *const Self) {
        // SAFETY: one use is still counted, the caller's, so the handle is alive.
        let users = unsafe { &(*handle).users };
        if users.fetch_sub(1, Ordering::AcqRel) == 1 {
            // SAFETY: it was the last use; the box was made by `create`.
            drop(unsafe { Box::from_raw(handle.cast_mut()) });
        }
    }
}
