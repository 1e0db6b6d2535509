//! Installs the peers below `target/peers` and makes the generated mesh.

use crate::prepare::debian_packages;
use crate::shell::{command, output, relative, repository, run, succeeds};
use std::path::{Path, PathBuf};

/// What VTK's wheels need to draw without a display: EGL and Mesa's software rasteriser.
const PACKAGES: [&str; 5] = ["libegl1", "libegl-mesa0", "libgl1", "libgl1-mesa-dri", "libxrender1"];

/// Installs what is missing; gives the Python that has the peers.
pub(super) fn install() -> Result<PathBuf, String> {
    if let Err(why) = debian_packages(&PACKAGES) {
        println!("could not install: {why}; the peers may find their GL elsewhere");
    }
    let folder = repository().join("target/peers");
    let python = folder.join("bin/python");
    if !python.exists() {
        run(command("python3").args(["-m", "venv"]).arg(&folder))?;
    }
    if !succeeds(&python.to_string_lossy(), &["-c", "import f3d, pyvista"]) {
        println!("installing F3D and PyVista into {}", relative(&folder));
        let wanted = "benches/peers/requirements.txt";
        output(command(&python).args([
            "-m",
            "pip",
            "install",
            "--quiet",
            "--disable-pip-version-check",
            "-r",
            wanted,
        ]))?;
    }
    Ok(python)
}

/// The torus of `triangles` triangles as binary PLY, made once.
pub(super) fn generate(python: &Path, triangles: u64) -> Result<PathBuf, String> {
    let path = repository().join(format!("target/peers/torus-{triangles}.ply"));
    if !path.exists() {
        output(
            command(python).arg("benches/peers/torus.py").arg(&path).arg(triangles.to_string()),
        )?;
    }
    Ok(path)
}
