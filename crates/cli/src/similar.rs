//! What a misspelt name may have meant: a file beside it, a built-in scene, a word of a list.

use std::path::Path;

/// Files that are named at most.
const MOST_FILES: usize = 3;

/// What may have been meant by a file that is not there.
pub(crate) fn for_missing(path: &Path) -> Option<String> {
    let text = path.to_string_lossy();
    if let Some(name) = text.strip_prefix("builtin:") {
        let name = name.split_once('?').map_or(name, |(name, _)| name);
        let listed = "`vitral formats` lists the built-in scenes";
        return Some(
            scene(name)
                .map_or(listed.to_owned(), |name| format!("did you mean builtin:{name}? {listed}")),
        );
    }

    // A folder that is missing is the first thing to tell.
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    if let Some(folder) = folder.filter(|folder| !folder.exists()) {
        return Some(format!("there is no folder `{}`", folder.display()));
    }
    let files = beside(folder.unwrap_or(Path::new(".")), &path.file_name()?.to_string_lossy());
    let files: Vec<String> = files
        .iter()
        .map(|name| folder.unwrap_or(Path::new("")).join(name).display().to_string())
        .collect();
    let scene =
        scene(&text).filter(|_| path.extension().is_none()).map(|name| format!("builtin:{name}"));
    let meant: Vec<String> = files.into_iter().chain(scene).collect();
    if meant.is_empty() { None } else { Some(format!("did you mean {}?", meant.join(" or "))) }
}

/// The files of a folder whose names are like `name`, the most similar first.
fn beside(folder: &Path, name: &str) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let mut near: Vec<_> = names
        .filter(|n| !n.starts_with('.'))
        .filter_map(|n| Some((distance(name, &n)?, n)))
        .collect();
    near.sort();
    near.into_iter().take(MOST_FILES).map(|(_, name)| name).collect()
}

/// How many letters differ between a name as typed and one that may have been meant, if it may be:
/// not more than a third, or the names differ in the extension alone.
fn distance(typed: &str, meant: &str) -> Option<usize> {
    let [typed, meant] = [typed, meant].map(str::to_lowercase);
    let stem = |name: &str| Path::new(name).file_stem().map(|stem| stem.to_os_string());
    let letters = strsim::osa_distance(&typed, &meant);
    let is_near = letters <= (typed.chars().count() / 3).max(1) || stem(&typed) == stem(&meant);
    is_near.then_some(letters)
}

/// The built-in scene of this name, or of the most similar one.
fn scene(name: &str) -> Option<&'static str> {
    nearest(name, vitral::builtin_names().iter().map(|(name, _)| *name))
}

/// The most similar of some names, if it may have been meant.
pub(crate) fn nearest<'n>(name: &str, names: impl IntoIterator<Item = &'n str>) -> Option<&'n str> {
    let near = names.into_iter().filter_map(|meant| Some((distance(name, meant)?, meant)));
    near.min_by_key(|(letters, _)| *letters).map(|(_, meant)| meant)
}

/// The message about a word that is none of a list's; `alone` says what else there is, such as
/// `; or none alone`.
pub(crate) fn not_one_of(word: &str, names: &[&str], alone: &str) -> String {
    let meant =
        nearest(word, names.iter().copied()).map(|name| format!("; did you mean `{name}`?"));
    format!("`{word}` is not one of {}{alone}{}", names.join(", "), meant.unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_letters_or_the_extension_may_be_wrong() {
        assert_eq!(distance("teapto.obj", "Teapot.OBJ"), Some(1));
        assert_eq!(distance("deer", "deer.obj"), Some(4));
        assert_eq!(distance("missing.obj", "a.obj"), None);
        assert_eq!(distance("a", "b"), Some(1));
        assert_eq!(distance("", "ab"), None);
        assert_eq!(nearest("creese", ["contour", "crease"]), Some("crease"));
        assert_eq!(
            not_one_of("x1y", &["frustum"], "; or none alone"),
            "`x1y` is not one of frustum; or none alone"
        );
        assert!(not_one_of("frustrum", &["frustum"], "").ends_with("; did you mean `frustum`?"));
    }

    #[test]
    fn scenes_are_found_with_and_without_their_prefix() {
        let meant = |name: &str| for_missing(Path::new(name)).unwrap_or_default();
        assert_eq!(meant("sphere"), "did you mean builtin:sphere?");
        assert!(
            meant("builtin:sphre?slices=8")
                .starts_with("did you mean builtin:sphere? `vitral formats`")
        );
        assert_eq!(meant("builtin:nothing"), "`vitral formats` lists the built-in scenes");
        assert_eq!(meant("no/such/a.obj"), "there is no folder `no/such`");
        assert_eq!(meant("x"), "");
    }
}
