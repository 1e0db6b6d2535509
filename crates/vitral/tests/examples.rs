//! The numbered examples do what they say: each runs to its end.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The names of the numbered examples, in teaching order.
fn names() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let stems = files.filter_map(|file| Some(file.file_stem()?.to_string_lossy().into_owned()));
    let mut names: Vec<String> =
        stems.filter(|name| name.starts_with(|c: char| c.is_ascii_digit())).collect();
    names.sort();
    names
}

/// What an example is called with, so that it writes into `folder` and little of it.
fn arguments(name: &str, folder: &Path) -> Vec<PathBuf> {
    match name {
        "02_load_a_model" => vec!["builtin:scene1".into(), folder.join("model.png")],
        "06_turntable" => vec!["builtin:cubs".into(), folder.into(), "2".into()],
        _ => vec![folder.into()],
    }
}

#[test]
fn every_numbered_example_runs_to_its_end() {
    // Cargo puts examples beside the folder of the test programs.
    let program = std::env::current_exe().unwrap();
    let built = program.ancestors().nth(2).unwrap().join("examples");
    let folder = std::env::temp_dir().join(format!("vitral-examples-{}", std::process::id()));
    let names = names();
    assert!(names.len() >= 7, "{names:?}");
    for name in names {
        let example = built.join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
        if !example.exists() {
            println!(
                "skipped: the example {name} is not built (cargo test builds it, with --test add --examples)"
            );
            continue;
        }
        let mut command = Command::new(example);
        command.args(arguments(&name, &folder)).stdin(Stdio::null()).env_remove("VITRAL_SIMD");
        let output = command.output().unwrap();
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    }
    let _ = std::fs::remove_dir_all(folder);
}
