//! `cargo xtask sheets draw DIR`: every model in every style of `vitral draw`, as contact sheets to
//! look through.
//!
//! A drawing is an SVG file and a PNG file of it in `DIR/STYLE`; `DIR/STYLE-N.png` shows 20 of them
//! with their names. What fails is listed in `DIR/failures.txt`, with its command.

use crate::shell::{
    Outcome, cargo, command, output, relative, repository, run as run_command, succeeds,
    target_folder,
};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Folders that models are looked for in; the first that is there counts.
const MODELS: [&str; 2] = ["../shared/models", "examples/models"];

/// Endings of models; those of malformed files are left to the tests.
const ENDINGS: [&str; 8] = ["obj", "ply", "stl", "off", "gltf", "glb", "OBJ", "STL"];

/// Styles by the name of their folder, with their options.
const STYLES: [(&str, &str); 8] = [
    ("lines", ""),
    ("dashed", "--hidden dashed"),
    ("filled", "--style filled"),
    ("shadows", "--style filled-lines --shadows --transparency"),
    ("flat", "--style filled --color-by material --seams none"),
    ("weiler-atherton", "--algorithm weiler-atherton"),
    ("painter", "--algorithm painter"),
    ("bsp", "--algorithm bsp"),
];

/// Seconds that a drawing may take.
const LIMIT: &str = "60";

/// Drawings across a page, and down.
const PAGE: (usize, usize) = (5, 4);

/// Pixels of a cell of a page, without its name, and of the name.
const CELL: (usize, usize) = (300, 240);

/// Pixels of a name's line.
const NAME: usize = 18;

/// A program that makes PNG files of SVG files.
#[derive(Clone, Copy)]
enum Converter {
    RsvgConvert,
    Resvg,
}

/// Draws everything.
pub(crate) fn run(options: &[&str]) -> Outcome {
    // Read the arguments, and find the converter and the models.
    let (folder, vitral) = match options {
        [folder] => {
            run_command(cargo().args(["build", "--release", "--package", "vitral-cli"]))?;
            (folder, target_folder().join("release/vitral"))
        }
        [folder, "--vitral", path] => (folder, PathBuf::from(path)),
        _ => {
            return Err(
                "sheets draw: one folder is required, and --vitral PATH may follow".to_owned()
            );
        }
    };
    let folder = std::env::current_dir().map_err(|e| e.to_string())?.join(folder);
    let converter = converter()?;
    let models = models()?;

    // Draw all models in each style.
    let mut failures = String::new();
    for (style, words) in STYLES {
        let inside = folder.join(style);
        std::fs::create_dir_all(&inside).map_err(|e| format!("{}: {e}", inside.display()))?;
        let mut drawn = Vec::new();
        for (name, model) in &models {
            match draw(&vitral, model, words, &inside.join(name), converter) {
                Ok(()) => drawn.push(name.clone()),
                Err(why) => {
                    failures +=
                        &format!("vitral draw {} {words}: {}\n", relative(model), why.trim())
                }
            }
        }

        // Put the drawings on pages.
        for (number, names) in drawn.chunks(PAGE.0 * PAGE.1).enumerate() {
            let page = folder.join(format!("{style}-{}", number + 1));
            let svg = page.with_extension("svg");
            std::fs::write(&svg, contact_sheet(style, names))
                .map_err(|e| format!("{}: {e}", svg.display()))?;
            output(&mut converter.command(&svg, &page.with_extension("png"), None))?;
        }
        println!("{style}: {} of {} models", drawn.len(), models.len());
    }

    // List the failures.
    let list = folder.join("failures.txt");
    std::fs::write(&list, &failures).map_err(|e| format!("{}: {e}", list.display()))?;
    print!("{failures}");
    Ok(())
}

/// Makes one drawing, as SVG and PNG.
fn draw(
    vitral: &Path,
    model: &Path,
    words: &str,
    path: &Path,
    converter: Converter,
) -> Result<(), String> {
    let svg = path.with_added_extension("svg");
    let mut draw = command(vitral);
    draw.arg("draw").arg(model).arg("-o").arg(&svg).args(words.split_whitespace());
    output(draw.args(["--quiet", "--no-config", "--time-limit", LIMIT]))?;
    output(&mut converter.command(&svg, &path.with_added_extension("png"), Some(CELL)))?;
    Ok(())
}

impl Converter {
    /// The command that makes a PNG file, on white, within a size.
    fn command(self, svg: &Path, png: &Path, size: Option<(usize, usize)>) -> Command {
        let mut words = command(match self {
            Self::RsvgConvert => "rsvg-convert",
            Self::Resvg => "resvg",
        });
        match self {
            Self::RsvgConvert => {
                if let Some((width, height)) = size {
                    words.args([
                        "--keep-aspect-ratio",
                        "-w",
                        &width.to_string(),
                        "-h",
                        &height.to_string(),
                    ]);
                }
                words
                    .args(["--unlimited", "--background-color", "white"])
                    .arg(svg)
                    .arg("-o")
                    .arg(png);
            }
            Self::Resvg => {
                if let Some((width, height)) = size {
                    words.args(["-w", &width.to_string(), "-h", &height.to_string()]);
                }
                words.args(["--background", "white"]).arg(svg).arg(png);
            }
        }
        words
    }
}

/// The converter that is there.
fn converter() -> Result<Converter, String> {
    if succeeds("rsvg-convert", &["--version"]) {
        Ok(Converter::RsvgConvert)
    } else if succeeds("resvg", &["--version"]) {
        Ok(Converter::Resvg)
    } else {
        Err("sheets draw: no converter from SVG to PNG (`apt-get install librsvg2-bin` or `cargo install resvg`)"
            .to_owned())
    }
}

/// All models with names that are names of files.
fn models() -> Result<Vec<(String, PathBuf)>, String> {
    let root = MODELS.iter().map(|path| repository().join(path)).find(|path| path.exists());
    let root = root.ok_or("sheets draw: there are no models")?;
    let mut models = Vec::new();
    let mut folders = vec![root.clone()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).map_err(|e| format!("{}: {e}", folder.display()))? {
            let path = entry.map_err(|e| e.to_string())?.path();
            let ending = path.extension().unwrap_or_default().to_string_lossy();
            if path.is_dir() && !path.ends_with("malformed") {
                folders.push(path);
            } else if ENDINGS.contains(&&*ending) {
                let name = path
                    .strip_prefix(&root)
                    .unwrap_or(&path)
                    .to_string_lossy()
                    .replace(['/', ' '], "+");
                models.push((name, path));
            }
        }
    }
    models.sort();
    Ok(models)
}

/// A page that shows the PNG files of a style's folder.
fn contact_sheet(style: &str, names: &[String]) -> String {
    let (width, height) = (PAGE.0 * CELL.0, PAGE.1 * (CELL.1 + NAME));
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" width=\"{width}\" height=\"{height}\">\n"
    );
    for (index, name) in names.iter().enumerate() {
        let (x, y) = (index % PAGE.0 * CELL.0, index / PAGE.0 * (CELL.1 + NAME));
        let shown = name.rsplit('+').next().unwrap_or(name);
        text += &format!(
            "<image x=\"{x}\" y=\"{}\" width=\"{}\" height=\"{}\" xlink:href=\"{style}/{name}.png\"/>\n\
             <text x=\"{}\" y=\"{}\" font-family=\"sans-serif\" font-size=\"13\">{shown}</text>\n",
            y + NAME,
            CELL.0,
            CELL.1,
            x + 4,
            y + NAME - 4
        );
    }
    text + "</svg>\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_has_rows() {
        let names: Vec<String> = (0..6).map(|n| format!("folder+{n}.obj")).collect();
        let page = contact_sheet("lines", &names);
        assert!(
            page.contains(
                "<image x=\"1200\" y=\"18\" width=\"300\" height=\"240\" xlink:href=\"lines/folder+4.obj.png\"/>"
            ),
            "{page}"
        );
        assert!(
            page.contains(
                "<text x=\"4\" y=\"272\" font-family=\"sans-serif\" font-size=\"13\">5.obj</text>"
            ),
            "{page}"
        );
    }
}
