//! `cargo xtask clients`: programs that others wrote draw with our libOSMesa and with Mesa's; the
//! pictures are compared.
//!
//! Needs Debian's libosmesa6, libglu1-mesa, gfsview-batch and a C compiler, and PyPI once.
//! Everything lies in `target/clients`; the clients are in `crates/osmesa/tests/clients`.

use crate::prepare::debian_packages;
use crate::shell::{Outcome, command, output, repository, run, target_folder};
use std::path::{Path, PathBuf};
use std::process::Command;

/// What the Python clients import, from PyPI.
const PACKAGES: [&str; 8] =
    ["mujoco", "gymnasium", "PyOpenGL", "glfw", "numpy", "pillow", "imageio", "packaging"];

/// Clients in Python, by the names of their files.
const PYTHON: [&str; 4] =
    ["mujoco_models", "gymnasium_environments", "pyopengl_glu", "glfw_window"];

/// The client in C.
const C: &str = "buffers";

/// Debian's viewer of flow simulations, by the number of dimensions, and what it is shown: NAME.gfs
/// as NAME.view says.
const GFSVIEW: [(&str, &str); 2] = [("gfsview-batch2D", "plane"), ("gfsview-batch3D", "box")];

/// Builds the library, runs every client with both libraries, prints the table.
pub(crate) fn run_all() -> Outcome {
    debian_packages(&[
        "libosmesa6",
        "libglu1-mesa",
        "libgl-dev",
        "python3-venv",
        "gcc",
        "libc6-dev",
    ])?;
    // The viewer starts OpenMPI, which needs its programs.
    debian_packages(&["gfsview-batch", "openmpi-bin"])?;
    crate::osmesa::run_all()?;
    crate::osmesa::check_size()?;
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
        let out = pictures(name);
        let _ = std::fs::remove_dir_all(&out);
        for client in PYTHON.into_iter().chain([C]) {
            println!("{client} with {name}");
            let mut words = if client == C {
                command(&program)
            } else {
                let mut words = command(&python);
                words.arg(sources.join(format!("{client}.py")));
                words
            };
            // GLU is linked with another libOpenGL: ours has to come first.
            let first = client == "pyopengl_glu";
            draw(words.arg(made(&out.join(client))?), library, first);
        }
        for (program, scene) in GFSVIEW {
            println!("{program} with {name}");
            let words = gfsview(
                program,
                &sources.join("gfsview").join(scene),
                &made(&out.join("gfsview"))?,
            )?;
            draw(&mut { words }, library, true);
        }
    }
    let compare = sources.join("compare.py");
    run(command(&python).arg(compare).arg(pictures("vitral")).arg(pictures("mesa")))
}

/// Runs a client with a library; `first` puts the library before all others that have its
/// functions.
fn draw(client: &mut Command, library: &Path, first: bool) {
    if first {
        client.env("LD_PRELOAD", library.join("libOSMesa.so.8"));
    }
    client
        .env("LD_LIBRARY_PATH", library)
        .env("MUJOCO_GL", "osmesa")
        .env("PYOPENGL_PLATFORM", "osmesa");
    if let Err(why) = output(client.env("PYTHONDONTWRITEBYTECODE", "1")) {
        println!("{why}");
    }
}

/// The viewer, with its commands as its input: the view, then what to save.
fn gfsview(program: &str, scene: &Path, out: &Path) -> Result<Command, String> {
    let failed = |path: &Path, e: std::io::Error| format!("{}: {e}", path.display());
    let view = scene.with_extension("view");
    let mut commands = std::fs::read_to_string(&view).map_err(|e| failed(&view, e))?;
    let picture = out.join(program).with_extension("ppm");
    commands +=
        &format!("Save {} {{ format = PPM width = 400 height = 300 }}\n", picture.display());
    let input = out.join(program).with_extension("commands");
    std::fs::write(&input, commands).map_err(|e| failed(&input, e))?;
    let mut words = command(program);
    words
        .arg(scene.with_extension("gfs"))
        .stdin(std::fs::File::open(&input).map_err(|e| failed(&input, e))?);
    // OpenMPI asks before it runs as root.
    words.env("OMPI_ALLOW_RUN_AS_ROOT", "1").env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
    Ok(words)
}

/// The folder, which is there afterwards.
fn made(folder: &Path) -> Result<PathBuf, String> {
    std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    Ok(folder.to_owned())
}

/// The folder of Mesa's library.
fn mesa() -> Result<PathBuf, String> {
    let folders =
        ["/usr/lib/x86_64-linux-gnu", "/usr/lib/aarch64-linux-gnu", "/usr/lib64", "/usr/lib"];
    let found =
        folders.iter().map(PathBuf::from).find(|folder| folder.join("libOSMesa.so.8").exists());
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
