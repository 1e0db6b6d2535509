//! `libOSMesa.so.8`: the C interface of [`vitral_gl`], a drop-in for Mesa's library of the same
//! name.
//!
//! Shims only: each exported function finds the calling thread's context and calls the method of
//! the same name. All memory of the client is reached in `memory.rs`, all state of OSMesa itself is
//! in `handle.rs` and `api.rs`.
#![allow(unsafe_code, non_snake_case)]
#![deny(unsafe_op_in_unsafe_fn)]

mod api;
mod attributes;
#[cfg(test)]
mod client;
mod current;
mod entry_points;
mod environment;
mod floating;
mod handle;
mod memory;
mod messages;
mod pool;
mod presence;
mod procedure;
mod procedures;
mod shader_logs;
mod signals;
mod unsupported;
