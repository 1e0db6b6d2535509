//! `vitral lab`: serves or exports the page that `cargo xtask lab` built in.

#[cfg(feature = "lab")]
mod begin;
#[cfg(feature = "lab")]
mod export;
#[cfg(feature = "lab")]
mod server;
#[cfg(feature = "lab")]
mod site;

use crate::lab_args::LabPageArgs;
use crate::report::Failure;

/// Runs the verb; gives the exit code.
#[cfg(feature = "lab")]
pub(crate) fn run(args: &LabPageArgs) -> Result<u8, Failure> {
    let begin = begin::Begin::new(args)?;
    match &args.export {
        Some(path) => export::export(path, &begin).map(|()| 0),
        None => server::serve(args, begin),
    }
}

/// Tells how to build it in.
#[cfg(not(feature = "lab"))]
pub(crate) fn run(args: &LabPageArgs) -> Result<u8, Failure> {
    let LabPageArgs { models: _, load_state: _, port: _, no_open: _, export: _, allow_external: _ } =
        args;
    const NOT_SUPPORTED: u8 = 4;
    let what = "this build of vitral does not contain the Lab";
    Err(Failure::with_code(NOT_SUPPORTED, what)
        .with_hint("`cargo xtask lab` builds one that does; it needs Node and npm"))
}
