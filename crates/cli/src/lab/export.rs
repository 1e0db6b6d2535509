//! The page as one file, or as a folder for any web server.

use super::begin::{Begin, not_written};
use super::site::{ENGINE, FILES, MODULE, PAGE, SINGLE, START};
use crate::report::{self, Failure};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use miniz_oxide::deflate::compress_to_vec;
use std::fmt::Write;
use std::path::Path;

/// How hard the engine is compressed, of 10.
const LEVEL: u8 = 9;

/// Writes the page to `path`: a file if it ends in `.html`, else a folder.
pub(super) fn export(path: &Path, begin: &Begin) -> Result<(), Failure> {
    let is_file = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("html") || e.eq_ignore_ascii_case("htm"));
    if is_file { report::write(path, single(begin).as_bytes()) } else { folder(path, begin) }
}

/// The page with everything inside, in text.
fn single(begin: &Begin) -> String {
    let mut start = begin.start(|_| None);
    for file in &begin.files {
        let name = file.name.replace('&', "&amp;").replace('"', "&quot;").replace('<', "&lt;");
        // Writing to a String cannot fail.
        let _ = write!(
            start,
            "\n<script type=\"application/octet-stream;base64\" data-name=\"{name}\" class=\"lab-file\">{}</script>",
            STANDARD.encode(&file.bytes)
        );
    }
    let engine = format!(
        "<script type=\"application/octet-stream;base64\" id=\"lab-wasm\" data-encoding=\"deflate-raw\">{}</script>",
        STANDARD.encode(compress_to_vec(ENGINE.bytes, LEVEL))
    );
    SINGLE.replace(START, &start).replace(MODULE, &engine)
}

/// The page, its files and the models as files.
fn folder(path: &Path, begin: &Begin) -> Result<(), Failure> {
    let models = path.join("models");
    let made = if begin.files.is_empty() { path } else { &models };
    std::fs::create_dir_all(made).map_err(|e| not_written(made, e))?;
    let page = PAGE.replace(START, &begin.start(|number| Some(format!("models/{number}"))));
    report::write(&path.join("index.html"), page.as_bytes())?;
    for file in &FILES {
        report::write(&path.join(file.name), file.bytes)?;
    }
    for (number, file) in begin.files.iter().enumerate() {
        report::write(&models.join(number.to_string()), &file.bytes)?;
    }
    Ok(())
}
