//! The shared library, tested as programs meet it: loaded at run time, in processes of its own.

mod common;
mod library;
mod scenes;
