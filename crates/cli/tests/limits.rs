//! What the command may take of the machine, whatever it is given: each damaged model ends within 1
//! s and 256 MB.
//!
//! The operating system holds the process to it, through `prlimit` of util-linux: processor time,
//! since other programs may be busy here, and data (heap, stacks, anonymous maps). A process that
//! goes beyond is killed or aborts, and so has none of the exit codes that are asked for.

use std::path::Path;
use std::process::{Command, Output, Stdio};
use vitral_testkit::fixture::{SKIPPED, shared_files};

/// Bytes of data that a process may have.
const BYTES: u64 = 256 << 20;
/// Seconds of processor time that it may take.
const SECONDS: u32 = 1;

/// `vitral render MODEL`, its picture dropped; held to so many bytes of data and to [`SECONDS`], if
/// any are given.
fn render(model: &Path, bytes: Option<u64>) -> std::io::Result<Output> {
    let vitral = env!("CARGO_BIN_EXE_vitral");
    let mut command = Command::new(if bytes.is_some() { "prlimit" } else { vitral });
    if let Some(bytes) = bytes {
        command.args([
            &format!("--data={bytes}"),
            &format!("--cpu={SECONDS}"),
            "--core=0",
            "--",
            vitral,
        ]);
    }
    command.arg("render").arg(model).args(["-o", "-"]);
    command
        .env("XDG_CONFIG_HOME", std::env::temp_dir())
        .env_remove("VITRAL_SIMD")
        .stdin(Stdio::null());
    command.output()
}

#[test]
fn damaged_models_end_within_256_mb_and_a_second() {
    // See that the limit is there and bites: a picture does not fit into 8 MB.
    let bites = render(Path::new("builtin:teapot"), Some(8 << 20))
        .is_ok_and(|output| !output.status.success());
    let bytes = bites.then_some(BYTES);
    let sound = render(Path::new("builtin:teapot"), bytes).unwrap();
    assert!(sound.status.success(), "{}", String::from_utf8_lossy(&sound.stderr));

    for path in shared_files("malformed") {
        let output = render(&path, bytes).unwrap();
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(
            matches!(output.status.code(), Some(0 | 3 | 4)),
            "{}: {}\n{message}",
            path.display(),
            output.status
        );
        assert!(!message.contains("panicked"), "{}: {message}", path.display());
    }
    if !bites {
        println!(
            "{SKIPPED}prlimit (util-linux) is absent or without effect: memory and time were not limited"
        );
    }
}
