//! `cargo xtask osmesa`: builds libOSMesa and lays it out as a folder that programs can be pointed
//! at.

use crate::shell::{Outcome, cargo, profile_folder, relative, repository, run, target_folder};
use std::path::{Path, PathBuf};

/// What programs are linked with; the name that is looked for at run time.
const SONAME: &str = "libOSMesa.so.8";

/// Further names: what linkers look for, and what programs were linked with before Mesa 9.
const LINKS: [&str; 2] = ["libOSMesa.so", "libOSMesa.so.6"];

/// What the stripped library's file stays under, in bytes: it is copied into images of containers
/// and packages.
const BELOW: u64 = 5_000_000;

/// pkg-config's file; `pcfiledir` is the folder that it lies in, so that the whole folder can be
/// moved.
const PKG_CONFIG: &str = "\
prefix=${pcfiledir}/..
libdir=${prefix}
includedir=${prefix}/include

Name: osmesa
Description: OpenGL without a screen, by vitral
Version: 8.0.0
Libs: -L${libdir} -lOSMesa
Cflags: -I${includedir}
";

/// Builds the library in release and fills `target/osmesa`.
pub(crate) fn run_all() -> Outcome {
    let (built, folder) = (build("release")?, target_folder().join("osmesa"));
    lay_out(&built, &folder).map_err(|e| format!("{}: {e}", folder.display()))?;

    let shown = relative(&folder);
    println!("{shown}/{SONAME}: {:.2} MB", size()? as f64 / 1e6);
    println!(
        "{shown}/libOSMesa.so, {shown}/libOSMesa.so.6, {shown}/include/GL/osmesa.h, {shown}/pkgconfig/osmesa.pc"
    );
    println!();
    println!("Run a program with it:");
    println!("  eval \"$(cargo run --release --quiet -- osmesa-env --lib {shown})\"");
    println!(
        "  MUJOCO_GL=osmesa PYOPENGL_PLATFORM=osmesa LD_LIBRARY_PATH={shown} python3 PROGRAM.py"
    );
    println!("Build a program with it:");
    println!(
        "  cc PROGRAM.c $(PKG_CONFIG_PATH={shown}/pkgconfig pkg-config --cflags --libs osmesa)"
    );
    println!("docs/osmesa.md tells more.");
    Ok(())
}

/// Builds the library with a profile; gives its path.
pub(crate) fn build(profile: &str) -> Result<PathBuf, String> {
    let mut options = Vec::new();
    if profile == "release" {
        // Names of its own functions are a sixth of the file, and of no use to programs. Entry
        // points begin with a cache line: one that is called a million times a frame took up to 1.4
        // times as long where it did not.
        options.extend(["--", "-C", "strip=symbols", "-C", "llvm-args=-align-all-functions=6"]);
        if cfg!(all(target_os = "linux", target_arch = "x86_64")) {
            // There rustc brings a linker that can keep functions with the same code once.
            options.extend(["-C", "link-arg=-Wl,--icf=all"]);
        }
    }
    let words = [
        "rustc",
        "--profile",
        profile,
        "--package",
        "vitral-osmesa",
        "--lib",
        "--crate-type",
        "cdylib",
    ];
    run(cargo().args(words).args(options))?;
    Ok(profile_folder(profile).join("libOSMesa.so"))
}

/// Whether the library in `target/osmesa` is as small as it is to stay; an error tells its size.
pub(crate) fn check_size() -> Outcome {
    match size()? {
        bytes if bytes < BELOW => Ok(()),
        bytes => Err(format!("{SONAME} has {bytes} bytes; it is to stay below {BELOW}")),
    }
}

/// Size of the library in `target/osmesa`, bytes.
fn size() -> Result<u64, String> {
    let library = target_folder().join("osmesa").join(SONAME);
    Ok(std::fs::metadata(&library).map_err(|e| format!("{}: {e}", library.display()))?.len())
}

fn lay_out(built: &Path, folder: &Path) -> std::io::Result<()> {
    for part in ["include/GL", "pkgconfig"] {
        std::fs::create_dir_all(folder.join(part))?;
    }
    // A library that a process has loaded must not be written over: the new one takes the old one's
    // place.
    let library = folder.join(SONAME);
    let fresh = folder.join(format!("{SONAME}.new"));
    std::fs::copy(built, &fresh)?;
    std::fs::rename(&fresh, &library)?;
    for name in LINKS {
        let link = folder.join(name);
        let _ = std::fs::remove_file(&link);
        #[cfg(unix)]
        std::os::unix::fs::symlink(SONAME, &link)?;
        #[cfg(not(unix))]
        std::fs::copy(&library, &link)?;
    }
    std::fs::copy(
        repository().join("crates/osmesa/include/GL/osmesa.h"),
        folder.join("include/GL/osmesa.h"),
    )?;
    std::fs::write(folder.join("pkgconfig/osmesa.pc"), PKG_CONFIG)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_folder_is_complete_and_can_be_made_again() {
        let folder =
            std::env::temp_dir().join(format!("vitral-xtask-osmesa-{}", std::process::id()));
        let built = folder.join("built.so");
        std::fs::create_dir_all(&folder).unwrap();
        for content in ["one", "two"] {
            std::fs::write(&built, content).unwrap();
            lay_out(&built, &folder).unwrap();
            for name in [SONAME, "libOSMesa.so", "libOSMesa.so.6"] {
                assert_eq!(std::fs::read_to_string(folder.join(name)).unwrap(), content);
            }
        }
        assert!(
            folder.join("include/GL/osmesa.h").exists()
                && folder.join("pkgconfig/osmesa.pc").exists()
        );
        assert!(!folder.join("libOSMesa.so.8.new").exists());
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
