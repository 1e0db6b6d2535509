//! Draws small scenes with an OSMesa library and writes what came out, for comparison with another
//! library.
//!
//! `scene_runner --list` prints each scene's group, its name and how exactly two libraries must
//! agree on it. `scene_runner LIBRARY FOLDER [SCENE...]` draws those scenes, or all; it prints the
//! name of each before drawing it, and writes `FOLDER/SCENE.rgba` (width and height as
//! little-endian 32-bit numbers, then the colour buffer as RGBA bytes, lowest row first),
//! `FOLDER/SCENE.depth` (32-bit floats) and `FOLDER/SCENE.numbers` (32-bit floats: what the scene
//! noted, the error last). With `SCENE_PICTURES` set it writes `FOLDER/SCENE.ppm` as well.
//!
//! `scene_runner --lifecycle MODE LIBRARY` tries what is not in pictures: see `lifecycle.rs`.
//!
//! Each scene has a context of its own. A library is loaded once: two of them cannot be in one
//! process, since they export the same names.
#![allow(unsafe_code, clippy::disallowed_methods)]

mod gl;
mod lifecycle;
mod scenes;
mod situations;
mod stage;

use scenes::Scene;
use stage::Stage;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.as_slice() {
        [list] if list == "--list" => {
            for (group, scenes) in scenes::GROUPS {
                scenes
                    .iter()
                    .for_each(|scene| println!("{group} {} {:?}", scene.name, scene.agreement));
            }
            ExitCode::SUCCESS
        }
        [option, mode, library] if option == "--lifecycle" => match lifecycle::run(mode, library) {
            Ok(()) => ExitCode::SUCCESS,
            Err(why) => {
                eprintln!("{mode}: {why}");
                ExitCode::FAILURE
            }
        },
        [library, folder, wanted @ ..] => match run(library, Path::new(folder), wanted) {
            Ok(()) => ExitCode::SUCCESS,
            Err(why) => {
                eprintln!("{why}");
                ExitCode::FAILURE
            }
        },
        _ => {
            eprintln!(
                "usage: scene_runner --list | --lifecycle MODE LIBRARY | LIBRARY FOLDER [SCENE...]"
            );
            ExitCode::FAILURE
        }
    }
}

fn run(library: &str, folder: &Path, wanted: &[String]) -> Result<(), String> {
    let gl = gl::Gl::load(library)?;
    std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    for scene in scenes::all()
        .filter(|scene| wanted.is_empty() || wanted.iter().any(|name| name == scene.name))
    {
        println!("{}", scene.name);
        std::io::stdout().flush().map_err(|e| e.to_string())?;
        draw(&gl, scene, folder)?;
    }
    Ok(())
}

/// Draws a scene and writes its files.
fn draw(gl: &gl::Gl, scene: &Scene, folder: &Path) -> Result<(), String> {
    let mut stage =
        Stage::new(gl, scene.surface).map_err(|why| format!("{}: {why}", scene.name))?;
    (scene.draw)(&mut stage);
    let result = stage.finish();
    let write = |kind: &str, bytes: &[u8]| {
        let path = folder.join(format!("{}.{kind}", scene.name));
        std::fs::write(&path, bytes).map_err(|e| format!("{}: {e}", path.display()))
    };
    let bytes = |numbers: &[f32]| numbers.iter().flat_map(|n| n.to_le_bytes()).collect::<Vec<u8>>();
    let size = [result.width, result.height].map(u32::to_le_bytes).concat();
    write("depth", &bytes(&result.depth))?;
    write("numbers", &bytes(&result.numbers))?;
    if std::env::var_os("SCENE_PICTURES").is_some() {
        let mut picture = format!("P6 {} {} 255\n", result.width, result.height).into_bytes();
        for row in result.rgba.chunks_exact(4 * result.width as usize).rev() {
            row.chunks_exact(4).for_each(|pixel| picture.extend_from_slice(&pixel[..3]));
        }
        write("ppm", &picture)?;
    }
    // Written last: where it is, the scene was drawn to its end.
    write("rgba", &[size, result.rgba].concat())
}
