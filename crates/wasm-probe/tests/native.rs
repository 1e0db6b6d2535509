//! The native program: built here with the tests, so that the comparison with WebAssembly finds it.

use std::process::Command;

#[test]
fn the_program_prints_one_hash() {
    let output = Command::new(env!("CARGO_BIN_EXE_vitral-wasm-probe")).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let expected = vitral_wasm_probe::fnv1a(&vitral_wasm_probe::picture());
    assert_eq!(u64::from_str_radix(text.trim(), 16), Ok(expected), "{text}");
}
