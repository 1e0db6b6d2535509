//! `cargo xtask check`: the floors, and the rules of the house that the compiler does not know.

mod floors;
mod source;
mod tokens;

use crate::shell::{self, Outcome, cargo, relative, repository};
use std::path::{Path, PathBuf};

/// Folders with sources of ours.
const FOLDERS: [&str; 6] = ["crates", "benches", "examples", "tests", "fuzz", "lab"];

/// Kinds of files that the line limit holds for.
const SOURCES: [&str; 5] = ["rs", "py", "ts", "mjs", "sh"];

/// Checks everything; fails with the number of violations, each printed as one line.
pub(crate) fn run() -> Outcome {
    let metadata = shell::output(cargo().args(["metadata", "--no-deps", "--offline", "--format-version", "1"]))?;
    let metadata = serde_json::from_str(&metadata).map_err(|e| format!("cargo metadata: {e}"))?;
    let mut violations = floors::check(&metadata);

    // Read every source file once.
    let mut files = Vec::new();
    FOLDERS.iter().for_each(|folder| collect(&repository().join(folder), &mut files));
    files.sort();
    for file in &files {
        let text = std::fs::read_to_string(file).map_err(|e| format!("{}: {e}", file.display()))?;
        violations.extend(source::check(&relative(file), &text));
    }

    violations.iter().for_each(|violation| println!("{violation}"));
    match violations.len() {
        0 => {
            println!("{} source files and the floors: nothing to object to", files.len());
            Ok(())
        }
        count => Err(format!("{count} violation(s)")),
    }
}

/// Adds the source files below `folder`, build outputs excepted.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let (path, name) = (entry.path(), entry.file_name().to_string_lossy().into_owned());
        if path.is_dir() {
            if !matches!(name.as_str(), "target" | "node_modules" | "dist" | "pkg" | "__pycache__" | "corpus") {
                collect(&path, files);
            }
        } else if path.extension().is_some_and(|e| SOURCES.iter().any(|s| e == *s)) {
            files.push(path);
        }
    }
}
