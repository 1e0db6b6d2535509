//! Tests of whole pictures. One program: linking and starting dominate the cost of many small ones.
//! Only `memory.rs` is a program of its own, because its counting allocator belongs to a whole
//! process.

mod examples;
mod golden;
mod pictures;
mod progress;
