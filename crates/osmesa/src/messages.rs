//! The way of a debug message from the state machine to the client's callback: it waits until the
//! call that caused it has ended, since the callback may itself call OpenGL.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use vitral_gl::{DebugHook, DebugMessage};

/// A message on its way.
pub(crate) struct Waiting {
    /// Address of the client's function.
    pub(crate) callback: usize,
    /// The client's parameter.
    pub(crate) user: usize,
    /// The message.
    pub(crate) message: DebugMessage,
}

/// Messages that wait.
#[derive(Default)]
pub(crate) struct Messages {
    /// Whether there are some.
    any: AtomicBool,
    queue: Mutex<VecDeque<Waiting>>,
}

impl std::fmt::Debug for Messages {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Messages").field("any", &self.any).finish_non_exhaustive()
    }
}

impl Messages {
    /// What the state machine calls.
    pub(crate) fn hook(self: &Arc<Self>) -> DebugHook {
        let messages = Arc::clone(self);
        Arc::new(move |callback, message, user| {
            let mut queue = messages.queue.lock().unwrap_or_else(PoisonError::into_inner);
            queue.push_back(Waiting { callback, user, message: message.clone() });
            messages.any.store(true, Ordering::Relaxed);
        })
    }

    /// Whether messages wait.
    #[inline]
    pub(crate) fn any(&self) -> bool {
        self.any.load(Ordering::Relaxed)
    }

    /// The oldest one.
    pub(crate) fn next(&self) -> Option<Waiting> {
        let mut queue = self.queue.lock().unwrap_or_else(PoisonError::into_inner);
        let next = queue.pop_front();
        self.any.store(!queue.is_empty(), Ordering::Relaxed);
        next
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_come_out_in_order() {
        let messages = Arc::new(Messages::default());
        let hook = messages.hook();
        assert!(!messages.any() && messages.next().is_none());
        for id in 0..3 {
            hook(1, &DebugMessage { source: 0, kind: 0, id, severity: 0, text: Vec::new() }, 2);
        }
        assert!(messages.any());
        let ids: Vec<u32> =
            std::iter::from_fn(|| messages.next()).map(|waiting| waiting.message.id).collect();
        assert_eq!(ids, [0, 1, 2]);
        assert!(!messages.any());
    }
}
