//! Tests of the OpenGL machine. One program: linking and starting dominate the cost of many small
//! ones.

mod clients;
mod common;
mod course;
mod course_surfaces;
mod coverage;
mod equal_planes;
mod errors;
mod extensions;
mod facets;
mod fuzz;
mod gathering;
mod lines;
mod operations;
mod passes;
mod situations;
mod specification;
