//! `cargo xtask check`: the floors, the bibliography, and the rules of the house that the compiler
//! does not know.
//!
//! `cargo xtask circles` lists what one of these rules looks at: which source files of a crate
//! import each other.

mod bibliography;
mod circles;
mod comments;
mod floors;
mod functions;
mod source;
mod tokens;

use crate::shell::{self, Outcome, cargo, relative, repository};
use std::collections::BTreeMap;
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
    let metadata = shell::output(cargo().args([
        "metadata",
        "--no-deps",
        "--offline",
        "--format-version",
        "1",
    ]))?;
    let metadata = serde_json::from_str(&metadata).map_err(|e| format!("cargo metadata: {e}"))?;
    let mut violations = floors::check(&metadata);

    // Check each source file by itself.
    let mut texts = read_sources()?;
    let count = texts.len();
    let table =
        texts.iter().find(|(path, _)| path == functions::ENTRY_POINTS).map_or("", |(_, text)| text);
    let entry_points = functions::EntryPoints::read(table);
    for (path, text) in &texts {
        violations.extend(source::check(path, text));
        if path.ends_with(".rs") {
            violations.extend(functions::check(path, text, &entry_points));
            violations.extend(comments::check(path, text));
        }
    }

    // Check which files of a crate import each other.
    violations.extend(circles::check(&sources_of_crates(&texts)));

    // Look citations up, those of the documentation too.
    texts.retain(|(path, _)| path.ends_with(".rs"));
    for path in DOCUMENTS {
        texts.push((path.to_owned(), read(&repository().join(path))?));
    }
    let cited_in = texts.iter().map(|(path, text)| (path.as_str(), text.as_str()));
    violations
        .extend(bibliography::check(&read(&repository().join(bibliography::FILE))?, cited_in));

    violations.iter().for_each(|violation| println!("{violation}"));
    match violations.len() {
        0 => {
            println!("{count} source files, the floors and the bibliography: nothing to object to");
            Ok(())
        }
        count => Err(format!("{count} violation(s)")),
    }
}

/// Prints the circles of source files of one crate or of all, with the names that make them.
/// `--all` prints every arrow from file to file. A crate is known by its folder.
pub(crate) fn list_circles(options: &[&str]) -> Outcome {
    let (flags, named): (Vec<&str>, Vec<&str>) =
        options.iter().partition(|option| option.starts_with("--"));
    if let Some(flag) = flags.iter().find(|flag| **flag != "--all") {
        return Err(format!("circles: no option {flag}; there is --all"));
    }
    let texts = read_sources()?;
    let crates = sources_of_crates(&texts);
    if let Some(name) = named.iter().find(|name| !crates.contains_key(**name)) {
        return Err(format!("circles: no folder {name} in crates"));
    }
    for (folder, sources) in
        crates.iter().filter(|(folder, _)| named.is_empty() || named.contains(folder))
    {
        print!("{}", circles::list(folder, sources, !flags.is_empty()));
    }
    Ok(())
}

/// Every source file of ours: its path relative to the repository's top, with `/`, and its text.
fn read_sources() -> Result<Vec<(String, String)>, String> {
    let mut files = Vec::new();
    FOLDERS.iter().for_each(|folder| collect(&repository().join(folder), &mut files));
    files.sort();
    files.iter().map(|file| Ok((relative(file).replace('\\', "/"), read(file)?))).collect()
}

fn read(path: &Path) -> Result<String, String> {
    std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))
}

/// The Rust files below `crates/FOLDER/src`, by folder and path.
fn sources_of_crates(texts: &[(String, String)]) -> BTreeMap<&str, circles::Sources<'_>> {
    let mut crates: BTreeMap<&str, circles::Sources<'_>> = BTreeMap::new();
    for (path, text) in texts.iter().filter(|(path, _)| path.ends_with(".rs")) {
        if let Some((folder, below)) =
            path.strip_prefix("crates/").and_then(|path| path.split_once("/src/"))
        {
            crates.entry(folder).or_default().insert(below, text);
        }
    }
    crates
}

/// Adds the source files below `folder`, build outputs excepted.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let (path, name) = (entry.path(), entry.file_name().to_string_lossy().into_owned());
        if path.is_dir() {
            if !matches!(
                name.as_str(),
                "target" | "node_modules" | "dist" | "pkg" | "__pycache__" | "corpus"
            ) {
                collect(&path, files);
            }
        } else if path.extension().is_some_and(|e| SOURCES.iter().any(|s| e == *s)) {
            files.push(path);
        }
    }
}
