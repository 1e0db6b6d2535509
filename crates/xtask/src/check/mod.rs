//! `cargo xtask check`: the floors, the bibliography, and the rules of the house that the compiler does not know.

mod bibliography;
mod circles;
mod floors;
mod functions;
mod source;
mod tokens;

use crate::shell::{self, Outcome, cargo, relative, repository};
use std::path::{Path, PathBuf};

/// Folders with sources of ours.
const FOLDERS: [&str; 5] = ["crates", "benches", "examples", "tests", "fuzz"];

/// Texts that may cite.
const DOCUMENTS: [&str; 5] =
    ["README.md", "ARCHITECTURE.md", "docs/materials.md", "docs/osmesa.md", "docs/scene-format.md"];

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
    let read = |path: &Path| std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()));
    let mut texts = Vec::new();
    for file in &files {
        let (path, text) = (relative(file).replace('\\', "/"), read(file)?);
        violations.extend(source::check(&path, &text));
        if path.ends_with(".rs") {
            violations.extend(functions::check(&path, &text));
        }
        texts.push((path, text));
    }

    // Look citations up, those of the documentation too.
    texts.retain(|(path, _)| path.ends_with(".rs"));
    for path in DOCUMENTS {
        texts.push((path.to_owned(), read(&repository().join(path))?));
    }
    let cited_in = texts.iter().map(|(path, text)| (path.as_str(), text.as_str()));
    violations.extend(bibliography::check(&read(&repository().join(bibliography::FILE))?, cited_in));

    violations.iter().for_each(|violation| println!("{violation}"));
    match violations.len() {
        0 => {
            println!("{} source files, the floors and the bibliography: nothing to object to", files.len());
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

/// Prints the circles of a crate's source files, or of every crate; with `--all`, all arrows between them.
pub(crate) fn list_circles(options: &[&str]) -> Outcome {
    let all = options.contains(&"--all");
    let mut files = Vec::new();
    collect(&repository().join("crates"), &mut files);
    let mut crates: std::collections::BTreeMap<String, Vec<(String, String)>> = Default::default();
    for file in &files {
        let path = relative(file).replace('\\', "/");
        if let Some((name, below)) = path.strip_prefix("crates/").and_then(|p| p.split_once("/src/")) {
            let text = std::fs::read_to_string(file).map_err(|e| format!("{}: {e}", file.display()))?;
            crates.entry(name.to_owned()).or_default().push((below.to_owned(), text));
        }
    }
    for (name, files) in &crates {
        if options.iter().any(|o| !o.starts_with("--")) && !options.contains(&name.as_str()) {
            continue;
        }
        let sources = files.iter().map(|(p, t)| (p.as_str(), t.as_str())).collect();
        print!("{}", circles::listing(name, &sources, all));
    }
    Ok(())
}
