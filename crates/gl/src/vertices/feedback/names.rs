//! The name stack of selection. Outside of selection its calls do nothing.

use super::Feedback;
use crate::state::MAX_NAME_STACK_DEPTH;
use crate::{Context, enums};

impl Context {
    /// Lists a call that changes the name stack, or tells what stands against that.
    fn name_call(
        &mut self,
        call: &'static str,
        change: impl Fn(&mut Feedback) -> Result<(), (u32, &'static str)> + Send + Sync + 'static,
    ) {
        self.listable(move |c| {
            if c.refused_inside_begin(call) || c.feedback.mode != enums::SELECT {
                return;
            }
            c.feedback.record_hit();
            if let Err((error, why)) = change(&mut c.feedback) {
                c.record_error(error, call, why);
            }
        });
    }

    /// `glInitNames`.
    pub fn init_names(&mut self) {
        self.name_call("glInitNames", |feedback| {
            feedback.names.clear();
            Ok(())
        });
    }

    /// `glLoadName`.
    pub fn load_name(&mut self, name: u32) {
        self.name_call("glLoadName", move |feedback| {
            let top = feedback.names.last_mut().ok_or((enums::INVALID_OPERATION, "the name stack is empty"))?;
            *top = name;
            Ok(())
        });
    }

    /// `glPushName`.
    pub fn push_name(&mut self, name: u32) {
        self.name_call("glPushName", move |feedback| {
            if feedback.names.len() >= MAX_NAME_STACK_DEPTH {
                return Err((enums::STACK_OVERFLOW, "the name stack is full"));
            }
            feedback.names.push(name);
            Ok(())
        });
    }

    /// `glPopName`.
    pub fn pop_name(&mut self) {
        self.name_call("glPopName", |feedback| {
            feedback.names.pop().map(|_| ()).ok_or((enums::STACK_UNDERFLOW, "the name stack is empty"))
        });
    }
}
