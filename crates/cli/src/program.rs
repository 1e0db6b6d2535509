//! The program that this command is started by.

use std::ffi::OsString;
use std::process::Command;
use std::sync::OnceLock;

/// What starts this command in a process of its own, where that is not the program of this process.
static PROGRAM: OnceLock<Vec<OsString>> = OnceLock::new();

/// Says how the command is started, as a program and its first arguments, where it is part of
/// another program.
pub fn started_by(program: Vec<OsString>) {
    // Who says it first knows best.
    let _ = PROGRAM.set(program);
}

/// Starts the command, without arguments so far.
pub(crate) fn command() -> std::io::Result<Command> {
    match PROGRAM.get().and_then(|program| program.split_first()) {
        Some((program, first)) => {
            let mut command = Command::new(program);
            command.args(first);
            Ok(command)
        }
        None => std::env::current_exe().map(Command::new),
    }
}
