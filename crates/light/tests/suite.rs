//! Tests of lights and reflection, as one program.

mod course;
mod lanes;
