//! The page that a failed golden test leaves behind: expected, difference and actual side by side.

use std::path::{Path, PathBuf};
use vitral_frame::{Plane, compare};
use vitral_io::encode;

/// Writes `NAME.html` and its pictures into `folder`; gives the page's path. `expected` is `None`
/// where there is no reference yet, or one of another size.
pub(crate) fn write(
    folder: &Path,
    name: &str,
    message: &str,
    expected: Option<&Plane<[u8; 4]>>,
    actual: &Plane<[u8; 4]>,
) -> Result<PathBuf, String> {
    // Write the pictures that there are, and a figure for each.
    let difference = expected.and_then(|expected| compare::picture(expected, actual).ok());
    let mut figures = String::new();
    for (what, picture) in
        [("expected", expected), ("difference", difference.as_ref()), ("actual", Some(actual))]
    {
        let Some(picture) = picture else { continue };
        let file = format!("{name}.{what}.png");
        put(&folder.join(&file), &encode_png(picture)?)?;
        let file = file.rsplit('/').next().unwrap_or_default();
        let (width, height) = (picture.width(), picture.height());
        figures += &format!(
            "<figure><img src=\"{file}\" width=\"{}\" alt=\"{what}\"><figcaption>{what}, {width}x{height}</figcaption></figure>\n",
            width.max(256)
        );
    }

    // Write the page round them.
    let page = format!(
        "<!doctype html>\n<meta charset=\"utf-8\">\n<title>{name}</title>\n\
         <style>body {{ font: 16px sans-serif }} figure {{ display: inline-block; margin: 8px }} \
         img {{ image-rendering: pixelated; background: repeating-conic-gradient(#ddd 0 25%, #fff 0 50%) 0 0 / 16px 16px }}\
         </style>\n<h1>{name}</h1>\n<p>{}</p>\n{figures}",
        escape(message)
    );
    let path = folder.join(format!("{name}.html"));
    put(&path, page.as_bytes())?;
    Ok(path)
}

/// The bytes of a PNG file.
pub(crate) fn encode_png(picture: &Plane<[u8; 4]>) -> Result<Vec<u8>, String> {
    encode::png(picture, encode::PngOptions::default()).map_err(|e| e.to_string())
}

/// Reads a PNG file.
pub(crate) fn read_png(path: &Path) -> Result<Plane<[u8; 4]>, String> {
    let name = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|e| format!("{name}: {e}"))?;
    encode::decode_picture(&bytes, &name).map_err(|e| e.to_string())
}

/// Writes a file, with the folders above it.
pub(crate) fn put(path: &Path, bytes: &[u8]) -> Result<(), String> {
    path.parent()
        .map_or(Ok(()), std::fs::create_dir_all)
        .and_then(|()| std::fs::write(path, bytes))
        .map_err(|e| format!("{}: {e}", path.display()))
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
