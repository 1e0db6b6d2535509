//! The tree of files that a package installs, below a prefix such as `/usr`.

use super::{Built, desktop, licences, shown, text_of};
use crate::shell::{Outcome, command, output, run};
use std::fs;
use std::path::{Path, PathBuf};

/// Side of the symbol, in pixels.
const SYMBOL: &str = "256";

/// Whose customs the tree follows.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// For any prefix, as `/usr/local`.
    Archive,
    /// Debian's, for `/usr`.
    Debian,
}

/// Fills an empty folder.
pub(super) fn lay_out(built: &Built, prefix: &Path, kind: Kind) -> Outcome {
    // Copy the command, and the library into a folder of its own: programs find Mesa's by its name
    // unless they are told.
    copy(&built.command, &prefix.join("bin/vitral"), true)?;
    copy(&built.library, &prefix.join("lib/vitral/libOSMesa.so.8"), false)?;
    let link = prefix.join("lib/vitral/libOSMesa.so");
    #[cfg(unix)]
    std::os::unix::fs::symlink("libOSMesa.so.8", &link).map_err(|e| shown(&link, &e))?;
    #[cfg(not(unix))]
    copy(&built.library, &link, false)?;

    // Let the command write its manual and completions.
    let manual = made(prefix.join("share/man/man1"))?;
    run(command(&built.command).arg("man").arg(&manual))?;
    if kind == Kind::Debian {
        compress(&manual)?;
    }
    let zsh = match kind {
        Kind::Archive => "share/zsh/site-functions/_vitral",
        Kind::Debian => "share/zsh/vendor-completions/_vitral",
    };
    let places = [
        ("bash", "share/bash-completion/completions/vitral"),
        ("zsh", zsh),
        ("fish", "share/fish/vendor_completions.d/vitral.fish"),
    ];
    for (shell, place) in places {
        write(&prefix.join(place), &output(command(&built.command).args(["completions", shell]))?)?;
    }

    // Tell desktops.
    write(&prefix.join("share/thumbnailers/vitral.thumbnailer"), &desktop::thumbnailer())?;
    write(&prefix.join("share/mime/packages/vitral.xml"), &desktop::media_types())?;
    if built.has_lab {
        write(&prefix.join("share/applications/vitral.desktop"), &desktop::entry())?;
        let symbol = prefix.join("share/icons/hicolor/256x256/apps/vitral.png");
        made(symbol.parent().unwrap_or(prefix))?;
        run(command(&built.command)
            .args(["thumbnail", "builtin:teapot"])
            .arg(&symbol)
            .arg(SYMBOL))?;
    }

    // Add the licences.
    let documents = prefix.join("share/doc/vitral");
    match kind {
        Kind::Archive => {
            for name in ["LICENSE-MIT", "LICENSE-APACHE", "NOTICE", "README.md", "CHANGELOG.md"] {
                write(&documents.join(name), &text_of(name)?)?;
            }
            write(&documents.join("THIRD-PARTY"), &licences::third_party(&built.metadata)?)
        }
        Kind::Debian => {
            write(&documents.join("copyright"), &licences::copyright(&built.metadata)?)?;
            write(&documents.join("changelog"), &text_of("CHANGELOG.md")?)?;
            compress(&documents)?;
            // Policy has this one as it is.
            let packed = documents.join("copyright.gz");
            run(command("gzip").arg("-d").arg(&packed))
        }
    }
}

/// Packs each file of a folder.
fn compress(folder: &Path) -> Outcome {
    let files = fs::read_dir(folder)
        .map_err(|e| shown(folder, &e))?
        .filter_map(|entry| Some(entry.ok()?.path()));
    let mut files: Vec<PathBuf> = files.collect();
    files.sort();
    run(command("gzip").args(["-n", "-9", "--"]).args(files))
}

/// The folder, which is there afterwards.
fn made(folder: impl Into<PathBuf>) -> Result<PathBuf, String> {
    let folder = folder.into();
    fs::create_dir_all(&folder).map_err(|e| shown(&folder, &e))?;
    Ok(folder)
}

/// Copies a file to a place whose folders need not be there.
fn copy(file: &Path, place: &Path, is_program: bool) -> Outcome {
    made(place.parent().unwrap_or(place))?;
    fs::copy(file, place).map_err(|e| shown(file, &e))?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = fs::Permissions::from_mode(if is_program { 0o755 } else { 0o644 });
        fs::set_permissions(place, mode).map_err(|e| shown(place, &e))?;
    }
    #[cfg(not(unix))]
    let _ = is_program;
    Ok(())
}

/// Writes a text to a place whose folders need not be there.
fn write(place: &Path, text: &str) -> Outcome {
    made(place.parent().unwrap_or(place))?;
    fs::write(place, text).map_err(|e| shown(place, &e))
}
