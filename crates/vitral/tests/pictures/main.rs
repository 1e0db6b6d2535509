//! Checks that need whole pictures: the course's (COURSE.md), the law of agreement, and what must never fail.

mod agreement;
mod common;
mod culling;
mod determinism;
mod hidden_line;
mod interpolation;
mod lighting;
mod marks;
mod normal_maps;
mod ray_trace;
mod robust;
mod translucent;
mod transparency;
mod traps;
