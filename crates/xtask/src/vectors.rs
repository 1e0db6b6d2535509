//! `cargo xtask vectors`: looks for vector operations that became calls in what is built for
//! release.
//!
//! A pass is compiled for each instruction set, with all that is inlined into it. A closure or
//! function that takes lanes and is not inlined is compiled for the least of them: each of its
//! vector operations is a call then, and such a pass may take ten times as long, with the same
//! results. Which closures the compiler inlines may change with code far away, so that only the
//! machine code tells.

use crate::shell::{Outcome, cargo, command, relative, run, target_folder};
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::Stdio;

/// The released command is stripped, which would hide the names of its functions.
const KEEP_SYMBOLS: &str = "profile.release.package.vitral-cli.strip=\"none\"";

/// What the functions are called that hold one operation of an instruction set.
const OPERATION: &str = "__fearless_simd_kernel";

/// Builds the command and libOSMesa in release and looks through both.
pub(crate) fn run_all() -> Outcome {
    let mut found = 0;
    for (arguments, file) in [
        (&["--package", "vitral-cli"][..], "release/vitral"),
        (&["--package", "vitral-osmesa", "--lib"], "release/libOSMesa.so"),
    ] {
        run(cargo().args(["build", "--release", "--config", KEEP_SYMBOLS]).args(arguments))?;
        let path = target_folder().join(file);
        let calls = calls_in(&path)?;
        println!("{}: {} operations are calls", relative(&path), calls.values().sum::<usize>());
        for (function, count) in &calls {
            println!("{count:6} in {function}");
        }
        found += calls.len();
    }
    if found == 0 {
        Ok(())
    } else {
        Err(format!("{found} functions do without their instruction set"))
    }
}

fn calls_in(path: &Path) -> Result<BTreeMap<String, usize>, String> {
    let told = |error: std::io::Error| format!("objdump: {error}");
    let mut objdump = command("objdump");
    objdump.args(["-d", "-C", "--no-show-raw-insn"]).arg(path).stdout(Stdio::piped());
    let mut child = objdump.spawn().map_err(told)?;
    let lines = child
        .stdout
        .take()
        .into_iter()
        .flat_map(|out| BufReader::new(out).lines().map_while(Result::ok));
    let calls = count_calls(lines)?;
    let status = child.wait().map_err(told)?;
    if status.success() { Ok(calls) } else { Err(format!("objdump: {status}")) }
}

/// How many operations each function calls, given the disassembly.
fn count_calls(lines: impl Iterator<Item = String>) -> Result<BTreeMap<String, usize>, String> {
    let (mut function, mut functions, mut calls) = (String::new(), 0, BTreeMap::new());
    for line in lines {
        if let Some(name) = line.strip_suffix(">:").and_then(|line| line.split_once(" <")) {
            function = name.1.to_owned();
            functions += 1;
        } else if line.contains("call") && line.contains(OPERATION) {
            *calls.entry(function.clone()).or_insert(0) += 1;
        }
    }
    // A file without names would look as if all were well.
    if functions < 100 {
        Err("objdump found no functions: are the symbols stripped?".to_owned())
    } else {
        Ok(calls)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn calls_count_for_the_function_they_are_in() {
        let mut text = "\
0000000000001000 <first::pass>:
    1000:\tvaddps %ymm0,%ymm1,%ymm2
    1004:\tcall   2000 <<Avx2 as Simd>::add_f32x8::kernel::__fearless_simd_kernel>
    1009:\tcall   2000 <<Avx2 as Simd>::add_f32x8::kernel::__fearless_simd_kernel>

0000000000001010 <other<A>::pass::{{closure}}>:
    1010:\tcall   3000 <memcpy@plt>
    1015:\tcall   2040 <<Avx2 as Simd>::splat_f32x8::kernel::__fearless_simd_kernel>
"
        .to_owned();
        assert!(count_calls(text.lines().map(str::to_owned)).is_err());
        (0..100).for_each(|i| text += &format!("00000000000030{i:02} <f{i}>:\n"));
        let calls = count_calls(text.lines().map(str::to_owned)).unwrap();
        let expected = [("first::pass", 2), ("other<A>::pass::{{closure}}", 1)];
        assert_eq!(calls, expected.map(|(name, count)| (name.to_owned(), count)).into());
    }
}
