//! The name stack of selection. Outside of selection its calls do nothing.

use super::Feedback;
use crate::state::MAX_NAME_STACK_DEPTH;
use crate::{Context, enums};

impl Context {
    /// Lists a call that changes the name stack, unless something stands against that. What was hit
    /// until then is recorded under the old names; a call that is refused records nothing.
    fn name_call(
        &mut self,
        call: &'static str,
        refusal: impl Fn(&Feedback) -> Option<(u32, &'static str)> + Send + Sync + 'static,
        change: impl Fn(&mut Vec<u32>) + Send + Sync + 'static,
    ) {
        self.listable(move |c| {
            if c.refused_inside_begin(call) || c.feedback.mode != enums::SELECT {
                return;
            }
            if let Some((error, why)) = refusal(&c.feedback) {
                return c.record_error(error, call, why);
            }
            c.feedback.record_hit();
            change(&mut c.feedback.names);
        });
    }

    /// `glInitNames`.
    pub fn init_names(&mut self) {
        self.name_call("glInitNames", |_| None, Vec::clear);
    }

    /// `glLoadName`.
    pub fn load_name(&mut self, name: u32) {
        let refusal = |f: &Feedback| {
            f.names.is_empty().then_some((enums::INVALID_OPERATION, "the name stack is empty"))
        };
        self.name_call("glLoadName", refusal, move |names| {
            if let Some(top) = names.last_mut() {
                *top = name;
            }
        });
    }

    /// `glPushName`.
    pub fn push_name(&mut self, name: u32) {
        let is_full = |f: &Feedback| f.names.len() >= MAX_NAME_STACK_DEPTH;
        let refusal = move |f: &Feedback| {
            is_full(f).then_some((enums::STACK_OVERFLOW, "the name stack is full"))
        };
        self.name_call("glPushName", refusal, move |names| names.push(name));
    }

    /// `glPopName`.
    pub fn pop_name(&mut self) {
        let refusal = |f: &Feedback| {
            f.names.is_empty().then_some((enums::STACK_UNDERFLOW, "the name stack is empty"))
        };
        self.name_call("glPopName", refusal, |names| {
            names.pop();
        });
    }
}
