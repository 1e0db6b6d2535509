//! Developer commands:
//! `cargo xtask test | check | circles | bless | lab | osmesa | wheel | dist | clients | sanitize | vectors | compare | sheets`.
#![forbid(unsafe_code)]

mod bless;
mod check;
mod checks;
mod clients;
mod compare;
mod dist;
mod lab;
mod osmesa;
mod prepare;
mod python;
mod sanitize;
mod sheets;
mod shell;
mod spent;
mod tally;
mod test;
mod vectors;
mod wasm;

use std::process::ExitCode;

const USAGE: &str = "\
cargo xtask test                  install what the tests need, run all of them, close with the count
cargo xtask check                 the floors and the rules of the house that the compiler does not know
cargo xtask circles [CRATE...] [--all]
                                  which source files import each other, and by which names (all imports)
cargo xtask bless [FILTER]        write the golden images anew (of the tests whose name contains FILTER)
cargo xtask lab                   build the Lab: its page, its engine, and target/release/vitral with both inside
cargo xtask osmesa                build libOSMesa and lay it out in target/osmesa
cargo xtask wheel                 build the Python package: one wheel, in target/wheels
cargo xtask dist [--profile NAME] [--no-lab]
                                  build what people install, in target/dist: archive, Debian package, wheel, bill of
                                  materials, checksums
cargo xtask dist test             pack what the tests build, and try it in a bare root
cargo xtask clients               run MuJoCo, Gymnasium, PyOpenGL, GLFW and a C program with it and with Mesa's, compare
cargo xtask sanitize [TOOL...]    Miri, Valgrind and the sanitizers watch libOSMesa (miri, valgrind, thread, address)
cargo xtask vectors               look for vector operations that became calls in the release build
cargo xtask compare [--quick] [--peers-only]
                                  install the peers, run them in turns with vitral, print ratios
cargo xtask compare draw [--quick] [--no-peers] [--vitral PATH]
                                  `vitral draw` (or the built command at PATH) and its peers; into benches/results
cargo xtask sheets draw DIR [--vitral PATH]
                                  draw every model in every style; contact sheets, 20 drawings a page, in DIR";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let result = match words.as_slice() {
        ["test"] => test::run(),
        ["check"] => check::run(),
        ["circles", options @ ..] => check::list_circles(options),
        ["bless"] => bless::run(None),
        ["bless", filter] => bless::run(Some(filter)),
        ["clients"] => clients::run_all(),
        ["sanitize", tools @ ..] => sanitize::run_all(tools),
        ["lab"] => lab::run_all(),
        ["osmesa"] => osmesa::run_all(),
        ["wheel"] => python::wheel(),
        ["dist", options @ ..] => dist::run_all(options),
        ["vectors"] => vectors::run_all(),
        ["compare", "draw", options @ ..] => compare::draw::run(options),
        ["compare", options @ ..] => compare::run(options),
        ["sheets", "draw", options @ ..] => sheets::run(options),
        _ => Err(format!("usage:\n{USAGE}")),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}
