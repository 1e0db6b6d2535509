//! `vitral osmesa-env`: the line that makes programs use our OpenGL library.

use crate::args::OsmesaEnvArgs;
use crate::report::{self, Failure};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// The library's name at run time.
const LIBRARY: &str = "libOSMesa.so.8";

/// Where the library may be, seen from the folder of this program: beside it, in an installation,
/// in cargo's folder, and there for programs in `target/PROFILE/deps` too.
const PLACES: [&str; 5] = [".", "../lib", "../lib/vitral", "../osmesa", "../../osmesa"];

/// Where the library is, if the program that runs the command knows.
static FOLDER: OnceLock<PathBuf> = OnceLock::new();

/// Says in which folder the library lies, for programs that bring it along. The first word counts.
pub fn osmesa_lies_in(folder: PathBuf) {
    let _ = FOLDER.set(folder);
}

/// Exit code for a missing library.
const MISSING: u8 = 3;

/// Runs the verb; gives the exit code.
pub(crate) fn run(args: &OsmesaEnvArgs) -> Result<u8, Failure> {
    // Without `/proc`, the system does not tell where this program lies. Who started it may have.
    let typed = || std::env::args_os().next().map(PathBuf::from).filter(|path| path.is_absolute());
    let program = std::env::current_exe().ok().or_else(typed);
    let beside = program.as_deref().and_then(Path::parent);
    let brought = FOLDER.get().filter(|folder| folder.join(LIBRARY).is_file());
    let folder = find(args.lib.as_deref().or(brought.map(PathBuf::as_path)), beside)?;
    let before = std::env::var_os("LD_LIBRARY_PATH");
    report::print(line(&folder, before.as_deref())?.as_bytes()).map(|()| 0)
}

/// The folder with the library.
fn find(chosen: Option<&Path>, beside: Option<&Path>) -> Result<PathBuf, Failure> {
    let places: Vec<PathBuf> = match (chosen, beside) {
        (Some(folder), _) => vec![folder.to_path_buf()],
        (None, Some(beside)) => PLACES.iter().map(|place| beside.join(place)).collect(),
        (None, None) => Vec::new(),
    };
    let Some(folder) = places.iter().find(|folder| folder.join(LIBRARY).is_file()) else {
        let looked: Vec<String> = places.iter().map(|place| place.display().to_string()).collect();
        let message = match looked.is_empty() {
            true => format!(
                "{LIBRARY} is looked for beside this program, and the system does not tell where that is"
            ),
            false => format!("{LIBRARY} is not in {}", looked.join(", ")),
        };
        return Err(Failure::with_code(MISSING, message)
            .with_hint("`cargo xtask osmesa` builds it into target/osmesa; --lib DIR names the folder where it is"));
    };
    folder
        .canonicalize()
        .map_err(|e| Failure::with_code(MISSING, format!("{}: {e}", folder.display())))
}

/// The line, for POSIX shells. What was in `LD_LIBRARY_PATH` stays behind our folder.
fn line(folder: &Path, before: Option<&OsStr>) -> Result<String, Failure> {
    let Some(folder) = folder.to_str() else {
        return Err(Failure::other(format!("{}: the path is not Unicode", folder.display())));
    };
    if folder.contains(':') {
        return Err(Failure::other(format!(
            "{folder}: LD_LIBRARY_PATH cannot name a folder with a colon"
        )));
    }
    // Said twice, it is still there once.
    let before = before.map(OsStr::to_string_lossy).unwrap_or_default();
    let rest = before.split(':').filter(|part| !part.is_empty() && *part != folder);
    let path: Vec<&str> = std::iter::once(folder).chain(rest).collect();
    let path = quoted(&path.join(":"));
    Ok(format!("export LD_LIBRARY_PATH={path} MUJOCO_GL=osmesa PYOPENGL_PLATFORM=osmesa\n"))
}

/// A word that a POSIX shell reads as it is.
fn quoted(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-:+,@%=".contains(c);
    if text.chars().all(plain) {
        text.to_owned()
    } else {
        format!("'{}'", text.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_folder_comes_first_and_once() {
        let line =
            |before: Option<&str>| line(Path::new("/a b/osmesa"), before.map(OsStr::new)).unwrap();
        let rest = "MUJOCO_GL=osmesa PYOPENGL_PLATFORM=osmesa\n";
        assert_eq!(line(None), format!("export LD_LIBRARY_PATH='/a b/osmesa' {rest}"));
        assert_eq!(
            line(Some("/x:/a b/osmesa::/y")),
            format!("export LD_LIBRARY_PATH='/a b/osmesa:/x:/y' {rest}")
        );
        assert!(super::line(Path::new("/a:b"), None).is_err());
        assert_eq!([quoted("/a-b.c"), quoted("it's")], ["/a-b.c", "'it'\\''s'"]);
    }

    #[test]
    fn the_library_is_looked_for_beside_the_program() {
        let top = std::env::temp_dir().join(format!("vitral-osmesa-env-{}", std::process::id()));
        let (bin, lib) = (top.join("bin"), top.join("lib"));
        std::fs::create_dir_all(&bin).unwrap();
        std::fs::create_dir_all(&lib).unwrap();
        assert!(find(None, None).unwrap_err().message().contains("does not tell where"));
        assert!(find(None, Some(&bin)).is_err());
        assert!(find(Some(&lib), Some(&bin)).is_err());
        std::fs::write(lib.join(LIBRARY), "").unwrap();
        assert_eq!(find(None, Some(&bin)).unwrap(), lib.canonicalize().unwrap());
        assert_eq!(find(Some(&lib), None).unwrap(), lib.canonicalize().unwrap());
        std::fs::remove_dir_all(&top).unwrap();
    }
}
