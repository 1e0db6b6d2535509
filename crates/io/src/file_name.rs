//! What the name of a file tells: the stem, which names meshes, and the extension, which names a
//! format.

/// The name of a file without folder and extension, for meshes that have no name of their own.
pub(crate) fn stem(file: &str) -> String {
    let name = without_folder(file);
    name.rsplit_once('.')
        .map_or(name, |(stem, _)| if stem.is_empty() { name } else { stem })
        .to_owned()
}

/// The extension of `file` in lower case, without the dot; empty if there is none.
pub(crate) fn extension(file: &str) -> String {
    without_folder(file)
        .rsplit_once('.')
        .map_or(String::new(), |(_, extension)| extension.to_ascii_lowercase())
}

/// The name behind the last slash of either kind.
fn without_folder(file: &str) -> &str {
    file.rsplit(['/', '\\']).next().unwrap_or(file)
}
