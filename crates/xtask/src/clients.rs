//! `cargo xtask clients`: programs that others wrote draw with our libOSMesa and with Mesa's; the pictures are compared.
//!
//! Needs Debian's libosmesa6, libglu1-mesa and a C compiler, and PyPI once. Everything lies in `target/clients`; the
//! clients are in `crates/osmesa/tests/clients`.

use crate::prepare::debian_packages;
use crate::shell::{Outcome, command, output, repository, run, target_folder};
use std::path::{Path, PathBuf};

/// What the Python clients import, from PyPI.
const PACKAGES: [&str; 8] = ["mujoco", "gymnasium", "PyOpenGL", "glfw", "numpy", "pillow", "imageio", "packaging"];

/// Clients in Python, by the names of their files.
const PYTHON: [&str; 4] = ["mujoco_models", "gymnasium_environments", "pyopengl_glu", "glfw_window"];

/// The client in C.
const C: &str = "buffers";

/// Builds the library, runs every client with both libraries, prints the table.
pub(crate) fn run_all() -> Outcome {
    debian_packages(&["libosmesa6", "libglu1-mesa", "libgl-dev", "python3-venv", "gcc", "libc6-dev"])?;
    crate::osmesa::run_all()?;
    let folder = target_folder().join("clients");
    let python = environment(&folder.join("venv"))?;
    let sources = repository().join("crates/osmesa/tests/clients");
    let program = folder.join(C);
    let library = target_folder().join("osmesa");
    run(command("cc")
        .arg(sources.join(format!("{C}.c")))
        .arg(format!("-I{}", library.join("include").display()))
        .arg(format!("-L{}", library.display()))
        .args(["-O1", "-lOSMesa", "-lm", "-o"])
        .arg(&program))?;

    // Draw everything twice. What fails draws nothing, which the table tells.
    let pictures = |library: &str| folder.join("pictures").join(library);
    for (name, library) in [("vitral", library.as_path()), ("mesa", mesa()?.as_path())] {
        let _ = std::fs::remove_dir_all(pictures(name));
        for client in PYTHON.into_iter().chain([C]) {
            let out = pictures(name).join(client);
            std::fs::create_dir_all(&out).map_err(|e| format!("{}: {e}", out.display()))?;
            let mut words = if client == C {
                command(&program)
            } else {
                let mut words = command(&python);
                words.arg(sources.join(format!("{client}.py")));
                words
            };
            // GLU is linked with another libOpenGL: ours has to come first.
            let preload = if client == "pyopengl_glu" { library.join("libOSMesa.so.8") } else { PathBuf::new() };
            words.env("LD_PRELOAD", preload).env("LD_LIBRARY_PATH", library);
            words.env("MUJOCO_GL", "osmesa").env("PYOPENGL_PLATFORM", "osmesa").env("PYTHONDONTWRITEBYTECODE", "1");
            println!("{client} with {name}");
            if let Err(why) = output(words.arg(&out)) {
                println!("{why}");
            }
        }
    }
    let compare = sources.join("compare.py");
    run(command(&python).arg(compare).arg(pictures("vitral")).arg(pictures("mesa")))
}

/// The folder of Mesa's library.
fn mesa() -> Result<PathBuf, String> {
    let folders = ["/usr/lib/x86_64-linux-gnu", "/usr/lib/aarch64-linux-gnu", "/usr/lib64", "/usr/lib"];
    let found = folders.iter().map(PathBuf::from).find(|folder| folder.join("libOSMesa.so.8").exists());
    found.ok_or_else(|| "Mesa's libOSMesa.so.8 is not installed (Debian: libosmesa6)".to_owned())
}

/// A virtual environment with the clients' packages; gives its Python.
fn environment(folder: &Path) -> Result<PathBuf, String> {
    let python = folder.join("bin/python");
    if !python.exists() {
        run(command("python3").args(["-m", "venv"]).arg(folder))?;
    }
    let imports = "import mujoco, gymnasium, OpenGL, glfw, numpy, PIL, imageio, packaging";
    if output(command(&python).args(["-c", imports])).is_err() {
        println!("installing {}", PACKAGES.join(", "));
        run(command(&python).args(["-m", "pip", "install", "--quiet"]).args(PACKAGES))?;
    }
    Ok(python)
}
