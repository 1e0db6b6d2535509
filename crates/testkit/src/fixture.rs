//! Where test models are.
//!
//! Small ones live in the repository (`examples/`, `crates/*/fixtures`). The large corpus lies
//! beside the checkout, in `../shared/models`, and may be absent: a test that needs it says so with
//! one printed line and passes. `cargo xtask test` counts tests that print such a line as skipped.

use std::path::{Path, PathBuf};

/// What a line of a test's output starts with when the test could not run. `cargo xtask test` looks
/// for it.
pub const SKIPPED: &str = "skipped: ";

/// The repository's top folder.
pub fn repository() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.ancestors().nth(2).unwrap_or(here).to_path_buf()
}

/// A file of the shared corpus, such as `classics/utah-teapot.obj`; prints a skip line and gives
/// `None` if it is absent.
pub fn shared_model(path: &str) -> Option<PathBuf> {
    let found = find(path);
    if found.is_none() {
        println!("{SKIPPED}../shared/models/{path} is not there");
    }
    found
}

/// A file of the shared corpus, if it is there.
fn find(path: &str) -> Option<PathBuf> {
    Some(repository().join("../shared/models").join(path)).filter(|found| found.exists())
}

/// All files of the shared corpus below `folder` whose extension (in lower case) is in
/// `extensions`, sorted by path. Empty, with a skip line, if the folder is absent.
pub fn shared_models(folder: &str, extensions: &[&str]) -> Vec<PathBuf> {
    let mut found = shared_files(folder);
    found.retain(|path| {
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        extension.is_some_and(|e| extensions.contains(&e.as_str()))
    });
    found
}

/// All files of the shared corpus below `folder`, sorted by path. Empty, with a skip line, if the
/// folder is absent.
pub fn shared_files(folder: &str) -> Vec<PathBuf> {
    shared_model(folder).map(|folder| files_below(&folder)).unwrap_or_default()
}

/// All files below `folder`, sorted by path.
pub fn files_below(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.is_dir() { folders.push(path) } else { found.push(path) }
        }
    }
    found.sort();
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_repository_is_found() {
        assert!(
            repository().join("Cargo.toml").exists()
                && repository().join("crates/testkit").exists()
        );
    }

    #[test]
    fn an_absent_model_is_none() {
        assert_eq!(find("no/such/model.obj"), None);
    }

    #[test]
    fn models_are_found_by_extension() {
        let Some(_) = shared_model("classics") else { return };
        let found = shared_models("classics", &["obj"]);
        assert!(found.len() >= 5 && found.is_sorted(), "{found:?}");
        assert!(found.iter().all(|p| p.extension().is_some_and(|e| e == "obj")));
    }
}
