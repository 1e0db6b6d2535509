//! Tests of the algorithms. One program: linking and starting dominate the cost of many small ones.

mod coherence;
mod radiosity;
mod rays;
mod shadows;
mod structures;
