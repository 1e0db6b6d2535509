//! ARB_sync: fences.
//!
//! Placing a fence runs the recorded commands, so that each fence is passed when the call returns:
//! nobody ever waits.
//!
//! Source: the ARB_sync specification.

use crate::{Context, enums as gl};
use std::sync::{MutexGuard, PoisonError};

/// The fences of one or more contexts.
#[derive(Debug, Default)]
pub(crate) struct Fences {
    /// The handles of those that there are: they rise.
    names: Vec<usize>,
    last: usize,
}

impl Fences {
    /// None so far; the first will have the handle after `last`.
    pub(crate) fn after(last: usize) -> Self {
        Self { names: Vec::new(), last }
    }

    /// Where in the list a fence is.
    fn find(&self, sync: usize) -> Option<usize> {
        self.names.binary_search(&sync).ok()
    }
}

impl Context {
    fn fences(&self) -> MutexGuard<'_, Fences> {
        self.shared.fences.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether a call may go on with this fence; else records the error.
    pub(super) fn knows_fence(&mut self, call: &str, sync: usize) -> bool {
        if !self.may_set(call) {
            return false;
        }
        let known = self.fences().find(sync).is_some();
        if !known {
            self.refuse_value(call, "sync is not a sync object");
        }
        known
    }

    /// `glFenceSync`: a handle, or 0.
    pub fn fence_sync(&mut self, condition: u32, flags: u32) -> usize {
        let call = "glFenceSync";
        if !self.may_set(call)
            || !self.check_enum(call, "condition", condition, &[gl::SYNC_GPU_COMMANDS_COMPLETE])
        {
            return 0;
        }
        if flags != 0 {
            self.refuse_value(call, "flags are not 0");
            return 0;
        }
        self.flush_recorded();
        let mut fences = self.fences();
        fences.last += 1;
        let name = fences.last;
        fences.names.push(name);
        name
    }

    /// `glIsSync`.
    pub fn is_sync(&mut self, sync: usize) -> u8 {
        u8::from(self.may_set("glIsSync") && self.fences().find(sync).is_some())
    }

    /// `glDeleteSync`.
    pub fn delete_sync(&mut self, sync: usize) {
        let call = "glDeleteSync";
        if (sync != 0 || !self.may_set(call)) && self.knows_fence(call, sync) {
            let mut fences = self.fences();
            if let Some(at) = fences.find(sync) {
                fences.names.remove(at);
            }
            drop(fences);
            self.forget_label(gl::SYNC_FENCE, sync as u32);
        }
    }

    /// `glClientWaitSync`: `ALREADY_SIGNALED`, or `WAIT_FAILED` with an error.
    pub fn client_wait_sync(&mut self, sync: usize, flags: u32, _timeout: u64) -> u32 {
        let call = "glClientWaitSync";
        if !self.knows_fence(call, sync) {
            return gl::WAIT_FAILED;
        }
        if flags & !gl::SYNC_FLUSH_COMMANDS_BIT != 0 {
            self.refuse_value(call, "flags have unknown bits");
            return gl::WAIT_FAILED;
        }
        gl::ALREADY_SIGNALED
    }

    /// `glWaitSync`.
    pub fn wait_sync(&mut self, sync: usize, flags: u32, timeout: u64) {
        let call = "glWaitSync";
        if self.knows_fence(call, sync) && (flags != 0 || timeout != u64::MAX) {
            self.refuse_value(call, "flags are not 0, or timeout is not TIMEOUT_IGNORED");
        }
    }

    /// `glGetSynciv`.
    pub fn get_synciv(
        &mut self,
        sync: usize,
        pname: u32,
        count: i32,
        length: usize,
        values: usize,
    ) {
        let call = "glGetSynciv";
        if !self.knows_fence(call, sync) {
            return;
        }
        let value = match pname {
            gl::OBJECT_TYPE => gl::SYNC_FENCE,
            gl::SYNC_STATUS => gl::SIGNALED,
            gl::SYNC_CONDITION => gl::SYNC_GPU_COMMANDS_COMPLETE,
            gl::SYNC_FLAGS => 0,
            _ => return self.refuse_enum(call, "pname", pname),
        };
        if count < 0 {
            return self.refuse_value(call, "the number of values is negative");
        }
        let given = count.min(1);
        if given == 1 {
            self.give_results(call, values, &[value]);
        }
        if length != 0 {
            self.give_results(call, length, &[given]);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::api::testing::context;
    use crate::enums as gl;

    #[test]
    fn a_fence_is_passed_until_it_is_deleted() {
        let mut c = context();
        assert_eq!((c.fence_sync(gl::FOG, 0), c.get_error()), (0, gl::INVALID_ENUM));
        assert_eq!(
            (c.fence_sync(gl::SYNC_GPU_COMMANDS_COMPLETE, 1), c.get_error()),
            (0, gl::INVALID_VALUE)
        );
        let fence = c.fence_sync(gl::SYNC_GPU_COMMANDS_COMPLETE, 0);
        assert_ne!(fence, 0);
        assert_eq!(c.is_sync(fence), 1);
        assert_eq!(c.client_wait_sync(fence, gl::SYNC_FLUSH_COMMANDS_BIT, 0), gl::ALREADY_SIGNALED);
        c.wait_sync(fence, 0, u64::MAX);
        assert_eq!(c.get_error(), gl::NO_ERROR);
        c.wait_sync(fence, 0, 1);
        assert_eq!(c.get_error(), gl::INVALID_VALUE);
        c.delete_sync(fence);
        c.delete_sync(0);
        assert_eq!((c.is_sync(fence), c.get_error()), (0, gl::NO_ERROR));
        assert_eq!(c.client_wait_sync(fence, 0, 0), gl::WAIT_FAILED);
        assert_eq!(c.get_error(), gl::INVALID_VALUE);
        assert_ne!(c.fence_sync(gl::SYNC_GPU_COMMANDS_COMPLETE, 0), fence);
    }
}
