//! Generating and reading names of objects.

use super::client;
use crate::names::MAX_NAMES;
use crate::{Context, enums};

impl Context {
    /// The common part of `Gen*`: checks, takes names and writes them to the client.
    pub(super) fn give_names(
        &mut self,
        call: &str,
        n: i32,
        to: usize,
        take: impl FnOnce(&mut Self, usize) -> Vec<u32>,
    ) {
        if self.refused_inside_begin(call) {
            return;
        }
        match usize::try_from(n) {
            Err(_) => self.record_error(enums::INVALID_VALUE, call, &format!("n {n} is negative")),
            Ok(0) => {}
            Ok(n) if n > MAX_NAMES => {
                self.record_error(enums::OUT_OF_MEMORY, call, &format!("{n} names are too many"))
            }
            Ok(n) => {
                let names = take(self, n);
                if to == 0 || !self.memory.write(to, bytemuck::cast_slice(&names)) {
                    self.record_error(enums::INVALID_VALUE, call, "names cannot be written there");
                }
            }
        }
    }

    /// The common part of `Delete*`: checks, and reads the names.
    pub(super) fn doomed_names(&mut self, call: &str, n: i32, from: usize) -> Vec<u32> {
        if self.refused_inside_begin(call) {
            return Vec::new();
        }
        let Ok(n) = usize::try_from(n) else {
            self.record_error(enums::INVALID_VALUE, call, &format!("n {n} is negative"));
            return Vec::new();
        };
        let names = client::values(&*self.memory, from, n);
        if names.is_none() {
            self.record_error(
                enums::INVALID_VALUE,
                call,
                "its names are not in the client's memory",
            );
        }
        names.unwrap_or_default()
    }
}
