//! Tests of the command, as one program.

mod command;
mod limits;
