//! Texts of licences: vitral's own, and those of the crates that are built in.

use super::materials::{built_in, is_own};
use super::{shown, text_of};
use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// Debian's file `copyright`: all texts in one.
pub(super) fn copyright(metadata: &Value) -> Result<String, String> {
    let mut text = String::from("vitral is licensed under MIT or Apache-2.0, as you like.\n");
    for name in ["LICENSE-MIT", "LICENSE-APACHE", "NOTICE"] {
        // Writing to a String cannot fail.
        let _ = write!(text, "\n\n==== {name}\n\n{}", text_of(name)?);
    }
    let _ = write!(text, "\n\n==== Crates that are built in\n\n{}", third_party(metadata)?);
    Ok(text)
}

/// The crates that are built in, each with its licence; then each text once, with the crates that
/// it came with.
pub(super) fn third_party(metadata: &Value) -> Result<String, String> {
    let mut text = String::new();
    let mut texts: Vec<(String, Vec<String>)> = Vec::new();
    for package in built_in(metadata)?.into_iter().filter(|package| !is_own(package)) {
        let word = |key: &str| package[key].as_str().unwrap_or_default();
        let name = format!("{} {}", word("name"), word("version"));
        let _ = writeln!(text, "{name}: {}", word("license"));
        for found in texts_beside(Path::new(word("manifest_path")))? {
            match texts.iter_mut().find(|(known, _)| *known == found) {
                Some((_, names)) => names.push(name.clone()),
                None => texts.push((found, vec![name.clone()])),
            }
        }
    }
    for (found, names) in texts {
        let _ = write!(text, "\n\n---- {}\n\n{}\n", names.join(", "), found.trim_end());
    }
    Ok(text)
}

/// The texts of licences that lie beside a manifest, in the order of their names.
fn texts_beside(manifest: &Path) -> Result<Vec<String>, String> {
    let folder = manifest.parent().unwrap_or(manifest);
    let files = fs::read_dir(folder)
        .map_err(|e| shown(folder, &e))?
        .filter_map(|entry| Some(entry.ok()?.path()));
    let is_licence = |path: &std::path::PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
        path.is_file()
            && ["license", "licence", "copying", "notice"].iter().any(|word| name.starts_with(word))
    };
    let mut files: Vec<_> = files.filter(is_licence).collect();
    files.sort();
    let read = |file: &std::path::PathBuf| fs::read(file).map_err(|e| shown(file, &e));
    files.iter().map(|file| Ok(String::from_utf8_lossy(&read(file)?).into_owned())).collect()
}
