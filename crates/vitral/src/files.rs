//! Files: read up to a limit, written whole or not at all, and a model's folder that the model
//! cannot leave.

use crate::Error;
use std::fs::{self, File};
use std::io::{ErrorKind, Read, Write};
use std::path::{Component, Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use vitral_exec::Workers;
use vitral_io::{ResolveError, Resolver};

/// The files beside a model. Paths that are absolute, climb out of the folder with `..`, or pass
/// through a link that leaves it are refused, unless external files were allowed; so are devices,
/// pipes, and files above the limit.
#[derive(Clone, Debug)]
pub struct FolderResolver {
    folder: PathBuf,
    allow_external: bool,
    max_file_bytes: u64,
}

impl FolderResolver {
    /// The files in `folder` and below, each at most `max_file_bytes` long.
    pub fn new(folder: impl Into<PathBuf>, allow_external: bool, max_file_bytes: u64) -> Self {
        let folder: PathBuf = folder.into();
        let folder = if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder };
        Self { folder, allow_external, max_file_bytes }
    }

    /// Where `path` is, if the model may go there.
    fn locate(&self, path: &str) -> Result<PathBuf, ResolveError> {
        // `C:/x` and `C:x` are absolute for the model's author, wherever this runs.
        let drive = matches!(path.as_bytes(), [letter, b':', ..] if letter.is_ascii_alphabetic());
        if !self.allow_external && (drive || path.starts_with('\\')) {
            return Err(ResolveError::Outside);
        }
        match self.locate_below(Path::new(path)) {
            Err(ResolveError::NotFound) => {
                latin_1(path).map_or(Err(ResolveError::NotFound), |p| self.locate_below(&p))
            }
            found => found,
        }
    }

    fn locate_below(&self, relative: &Path) -> Result<PathBuf, ResolveError> {
        let inside = folded(relative);
        if !self.allow_external && inside.is_none() {
            return Err(ResolveError::Outside);
        }
        let place = self.folder.join(inside.as_deref().unwrap_or(relative));
        let found = fs::canonicalize(place).map_err(|e| told(&e))?;
        if !self.allow_external {
            let folder = fs::canonicalize(&self.folder).map_err(|e| told(&e))?;
            if !found.starts_with(folder) {
                return Err(ResolveError::Outside);
            }
        }
        Ok(found)
    }
}

/// `path` as a program that knew Latin-1 alone named its file; `None` where that is the same name,
/// or none at all.
#[cfg(unix)]
fn latin_1(path: &str) -> Option<PathBuf> {
    use std::os::unix::ffi::OsStringExt;
    let bytes: Option<Vec<u8>> = path.chars().map(|c| u8::try_from(c).ok()).collect();
    bytes.filter(|bytes| !bytes.is_ascii()).map(|bytes| std::ffi::OsString::from_vec(bytes).into())
}

/// Elsewhere names are Unicode.
#[cfg(not(unix))]
fn latin_1(_: &str) -> Option<PathBuf> {
    None
}

/// `path` without `.` and `..`, folded by its words alone; `None` if it leaves the folder that it
/// starts from.
fn folded(path: &Path) -> Option<PathBuf> {
    let mut folded = PathBuf::new();
    for component in path.components() {
        match component {
            Component::Normal(name) => folded.push(name),
            Component::CurDir => {}
            Component::ParentDir if folded.pop() => {}
            Component::ParentDir | Component::RootDir | Component::Prefix(_) => return None,
        }
    }
    Some(folded)
}

fn told(error: &std::io::Error) -> ResolveError {
    match error.kind() {
        ErrorKind::NotFound | ErrorKind::NotADirectory => ResolveError::NotFound,
        _ => ResolveError::Other(error.to_string()),
    }
}

impl Resolver for FolderResolver {
    fn read(&self, path: &str) -> Result<Vec<u8>, ResolveError> {
        let found = self.locate(path)?;
        // Opening a pipe would wait for its writer.
        if !fs::metadata(&found).map_err(|e| told(&e))?.is_file() {
            return Err(ResolveError::Other("it is not a regular file".to_owned()));
        }
        let file = File::open(&found).map_err(|e| told(&e))?;
        match read_up_to(file, self.max_file_bytes, &Workers::single()) {
            Ok(Some(bytes)) => Ok(bytes),
            Ok(None) => {
                Err(ResolveError::Other(format!("it has more than {} bytes", self.max_file_bytes)))
            }
            Err(e) => Err(told(&e)),
        }
    }

    fn in_other_case(&self, path: &str) -> Option<String> {
        // Follow the path name by name: as it stands where that is there, else the first in order
        // that differs in case alone.
        let relative = folded(Path::new(path))?;
        let (mut folder, mut found) = (self.folder.clone(), Vec::new());
        for component in relative.components() {
            let wanted = component.as_os_str().to_str()?;
            let name = if folder.join(wanted).exists() {
                wanted.to_owned()
            } else {
                name_in_other_case(&folder, wanted)?
            };
            folder.push(&name);
            found.push(name);
        }
        Some(found.join("/")).filter(|found| found != path)
    }
}

/// A file that a model is read from: its own, or one that it names.
#[derive(Clone, Copy, Debug)]
pub struct ReadFile<'a> {
    /// As the model calls it, from its folder; of the model's own file the last part of its path.
    pub name: &'a str,
    /// Where it was found.
    pub path: &'a Path,
    /// All of it.
    pub bytes: &'a [u8],
}

/// The files beside a model, each of which is told when it is read.
pub(crate) struct ToldFiles<'a> {
    pub(crate) folder: FolderResolver,
    pub(crate) tell: &'a (dyn Fn(ReadFile<'_>) + Sync),
}

impl Resolver for ToldFiles<'_> {
    fn read(&self, name: &str) -> Result<Vec<u8>, ResolveError> {
        let bytes = self.folder.read(name)?;
        let path = self.folder.locate(name)?;
        (self.tell)(ReadFile { name, path: &path, bytes: &bytes });
        Ok(bytes)
    }

    fn in_other_case(&self, name: &str) -> Option<String> {
        self.folder.in_other_case(name)
    }
}

/// The first name in `folder`, in order, that differs from `wanted` in case alone.
fn name_in_other_case(folder: &Path, wanted: &str) -> Option<String> {
    let lower = wanted.to_lowercase();
    let names =
        fs::read_dir(folder).ok()?.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    names.filter(|name| name.to_lowercase() == lower).min()
}

/// Everything that `file` holds; `None` if that is more than `limit` bytes.
fn read_up_to(mut file: File, limit: u64, workers: &Workers) -> std::io::Result<Option<Vec<u8>>> {
    // Devices claim a length of 0 and never end: the limit holds for what is read, not for what is
    // claimed.
    let claimed = file.metadata()?.len();
    if claimed > limit {
        return Ok(None);
    }
    let mut bytes = Vec::new();
    bytes
        .try_reserve_exact(claimed as usize + 1)
        .map_err(|_| std::io::Error::from(ErrorKind::OutOfMemory))?;
    if claimed >= 2 * PIECE as u64 && workers.threads() > 1 {
        read_in_pieces(&mut file, claimed as usize, &mut bytes, workers)?;
    }
    let left = limit.saturating_add(1) - bytes.len() as u64;
    file.take(left).read_to_end(&mut bytes)?;
    Ok((bytes.len() as u64 <= limit).then_some(bytes))
}

/// Bytes that a thread reads in one go.
const PIECE: usize = 1 << 20;

/// Reads `length` bytes with all of `workers`: half of the time of reading goes into memory that is
/// new. Reads nothing where they are not all there, or where files have no places.
fn read_in_pieces(
    file: &mut File,
    length: usize,
    bytes: &mut Vec<u8>,
    workers: &Workers,
) -> std::io::Result<()> {
    #[cfg(unix)]
    {
        use std::io::{Seek, SeekFrom};
        use std::os::unix::fs::FileExt;
        // There is room for it. New pages are zero without being written.
        *bytes = Vec::new();
        let mut whole = vec![0; length];
        let (complete, shared) = (std::sync::atomic::AtomicBool::new(true), &*file);
        workers.for_each_chunk(&mut whole, PIECE, |number, piece| {
            if shared.read_exact_at(piece, (number * PIECE) as u64).is_err() {
                complete.store(false, Ordering::Relaxed);
            }
        });
        if complete.into_inner() {
            file.seek(SeekFrom::Start(length as u64))?;
            *bytes = whole;
        }
    }
    #[cfg(not(unix))]
    let _ = (file, length, bytes, workers);
    Ok(())
}

/// Reads a file that the user named; `-` is standard input.
///
/// # Errors
/// [`Error::Read`]; [`Error::TooLarge`] for one with more than `limit` bytes.
pub fn read(path: impl AsRef<Path>, limit: u64) -> Result<Vec<u8>, Error> {
    read_with(path.as_ref(), limit, &Workers::single())
}

/// [`read`] with all of `workers`.
pub(crate) fn read_with(path: &Path, limit: u64, workers: &Workers) -> Result<Vec<u8>, Error> {
    if path.as_os_str() == "-" {
        return read_standard_input(limit);
    }
    let failed = |source| Error::Read { path: path.to_owned(), source };
    let file = File::open(path).map_err(failed)?;
    if file.metadata().map_err(failed)?.is_dir() {
        return Err(failed(std::io::Error::from(ErrorKind::IsADirectory)));
    }
    read_up_to(file, limit, workers)
        .map_err(failed)?
        .ok_or_else(|| Error::TooLarge { path: path.to_owned(), limit })
}

/// Reads standard input to its end.
fn read_standard_input(limit: u64) -> Result<Vec<u8>, Error> {
    let path = || PathBuf::from("standard input");
    let mut bytes = Vec::new();
    let read = std::io::stdin().lock().take(limit.saturating_add(1)).read_to_end(&mut bytes);
    read.map_err(|source| Error::Read { path: path(), source })?;
    if bytes.len() as u64 > limit {
        Err(Error::TooLarge { path: path(), limit })
    } else {
        Ok(bytes)
    }
}

/// Writes a file so that it appears complete or not at all: into a new file beside it, which then
/// takes its name. What is no regular file (a pipe, `/dev/stdout`) is written to directly. A link
/// keeps pointing where it did.
///
/// # Errors
/// [`Error::Write`]; nothing is left behind then.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let failed = |source| not_written(path, source);
    let target = followed(path);
    match fs::metadata(&target) {
        Ok(old) if old.is_dir() => {
            return Err(failed(std::io::Error::from(ErrorKind::IsADirectory)));
        }
        Ok(old) if !old.is_file() => return fs::write(&target, bytes).map_err(failed),
        _ => {}
    }
    let (temporary, mut file) = new_file_beside(&target).map_err(failed)?;
    let written = file.write_all(bytes);
    drop(file);
    written.and_then(|()| fs::rename(&temporary, &target)).map_err(|source| {
        // The first failure is the one to tell; that this one fails too says nothing new.
        let _ = fs::remove_file(&temporary);
        failed(source)
    })
}

/// Where a file of this name is: what a link points to, whether that is there or not.
fn followed(path: &Path) -> PathBuf {
    /// As many links as Linux follows.
    const MOST_LINKS: usize = 40;
    let mut place = path.to_owned();
    for _ in 0..MOST_LINKS {
        let Ok(target) = fs::read_link(&place) else { break };
        place = place.parent().unwrap_or(Path::new("")).join(target);
    }
    // What the kernel says of its own links (`/dev/stdout`) need not be a name.
    fs::canonicalize(path).unwrap_or(place)
}

/// Why a file cannot be written, in words: a folder that is not there is called that.
fn not_written(path: &Path, source: std::io::Error) -> Error {
    let place = followed(path);
    let folder = place
        .parent()
        .filter(|f| source.kind() == ErrorKind::NotFound && !f.as_os_str().is_empty());
    let source = match folder.filter(|f| !f.exists()) {
        Some(folder) => {
            std::io::Error::new(source.kind(), format!("there is no folder `{}`", folder.display()))
        }
        None => source,
    };
    Error::Write { path: path.to_owned(), source }
}

/// Whether there is a place for a file of this name.
///
/// # Errors
/// [`Error::Write`], as [`write`] would give it for want of a folder, or because the name is that
/// of one.
pub(crate) fn check_place(path: &Path) -> Result<(), Error> {
    let place = followed(path);
    let folder = place.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match fs::metadata(path) {
        Ok(old) if old.is_dir() => Err(not_written(path, ErrorKind::IsADirectory.into())),
        // A new name in a folder, or a link that points to none yet.
        Err(e) if e.kind() == ErrorKind::NotFound && folder.is_dir() => Ok(()),
        Err(e) => Err(not_written(path, e)),
        Ok(_) => Ok(()),
    }
}

/// Makes a file in the same folder that nobody else has.
fn new_file_beside(target: &Path) -> std::io::Result<(PathBuf, File)> {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let name = target
        .file_name()
        .ok_or_else(|| std::io::Error::from(ErrorKind::InvalidInput))?
        .to_string_lossy();
    loop {
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let temporary =
            target.with_file_name(format!(".{name}.{}-{number}.part", std::process::id()));
        match File::create_new(&temporary) {
            Err(e) if e.kind() == ErrorKind::AlreadyExists => {}
            made => return made.map(|file| (temporary, file)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A new folder for one test.
    fn folder(name: &str) -> PathBuf {
        let folder =
            std::env::temp_dir().join(format!("vitral-files-{name}-{}", std::process::id()));
        fs::create_dir_all(folder.join("model/textures")).unwrap();
        folder
    }

    #[test]
    fn names_in_other_case_are_found_in_order() {
        let folder = folder("case");
        for name in ["textures/Wood.PNG", "b.MTL", "B.mtl"] {
            fs::write(folder.join("model").join(name), name).unwrap();
        }
        let resolver = FolderResolver::new(folder.join("model"), false, 100);
        let other = |path: &str| resolver.in_other_case(path);
        assert_eq!(other("TEXTURES/wood.png").as_deref(), Some("textures/Wood.PNG"));
        assert_eq!(other("b.mtl").as_deref(), Some("B.mtl"), "the first in order");
        assert_eq!(
            [other("none.png"), other("../model/b.mtl"), other("textures/Wood.PNG")],
            [None, None, None]
        );
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_model_cannot_leave_its_folder() {
        let folder = folder("leave");
        fs::write(folder.join("secret.png"), b"secret").unwrap();
        fs::write(folder.join("model/textures/a b.png"), b"texture").unwrap();
        #[cfg(unix)]
        std::os::unix::fs::symlink(folder.join("secret.png"), folder.join("model/link.png"))
            .unwrap();
        let closed = FolderResolver::new(folder.join("model"), false, 100);
        assert_eq!(closed.read("textures/a b.png").unwrap(), b"texture");
        assert_eq!(closed.read("./textures/a b.png").unwrap(), b"texture");
        assert_eq!(closed.read("textures/../none/../textures/a b.png").unwrap(), b"texture");
        assert_eq!(closed.read("nothing.png"), Err(ResolveError::NotFound));
        let absolute = folder.join("secret.png").to_string_lossy().into_owned();
        for path in [
            "../secret.png",
            "textures/../../secret.png",
            "../model/textures/a b.png",
            &absolute,
            "C:/secret.png",
            "\\\\host\\x",
        ] {
            assert_eq!(closed.read(path), Err(ResolveError::Outside), "{path}");
        }
        #[cfg(unix)]
        assert_eq!(closed.read("link.png"), Err(ResolveError::Outside));
        let open = FolderResolver::new(folder.join("model"), true, 100);
        assert_eq!(open.read("../secret.png").unwrap(), b"secret");
        assert_eq!(open.read(&absolute).unwrap(), b"secret");
        fs::remove_dir_all(folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn names_in_latin_1_are_found() {
        use std::os::unix::ffi::OsStrExt;
        let folder = folder("latin");
        fs::write(folder.join("model").join(std::ffi::OsStr::from_bytes(b"T\xFCr.png")), b"bytes")
            .unwrap();
        fs::write(folder.join("model/\u{e9}.png"), b"utf8").unwrap();
        let closed = FolderResolver::new(folder.join("model"), false, 100);
        assert_eq!(closed.read("T\u{fc}r.png").unwrap(), b"bytes");
        assert_eq!(closed.read("\u{e9}.png").unwrap(), b"utf8");
        assert_eq!(closed.read("\u{3b1}.png"), Err(ResolveError::NotFound));
        assert_eq!(closed.read("../\u{fc}"), Err(ResolveError::Outside));
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn threads_read_large_files_together() {
        let folder = folder("large");
        let path = folder.join("model/large");
        let bytes: Vec<u8> =
            (0..3 * PIECE as u32 + 5).map(|i| (i.wrapping_mul(0x9e37_79b9) >> 24) as u8).collect();
        fs::write(&path, &bytes).unwrap();
        for workers in [Workers::single(), Workers::new(3)] {
            assert!(
                read_with(&path, bytes.len() as u64, &workers).unwrap() == bytes,
                "{workers:?}"
            );
            let short = read_with(&path, bytes.len() as u64 - 1, &workers);
            assert!(matches!(short, Err(Error::TooLarge { .. })));
        }
        // A file that ends before it was said to.
        let mut read = Vec::new();
        let mut file = File::open(&path).unwrap();
        read_in_pieces(&mut file, bytes.len() + 1, &mut read, &Workers::new(2)).unwrap();
        assert!(read.is_empty());
        file.read_to_end(&mut read).unwrap();
        assert!(read == bytes);
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn limits_hold_for_files_and_devices() {
        let folder = folder("limits");
        fs::write(folder.join("model/a"), b"12345").unwrap();
        assert!(matches!(read(folder.join("model/a"), 4), Err(Error::TooLarge { limit: 4, .. })));
        assert_eq!(read(folder.join("model/a"), 5).unwrap(), b"12345");
        assert!(matches!(read(&folder, 5), Err(Error::Read { .. })));
        #[cfg(unix)]
        assert!(matches!(read("/dev/zero", 1000), Err(Error::TooLarge { .. })));
        let closed = FolderResolver::new(folder.join("model"), false, 4);
        assert!(closed.read("a").unwrap_err().to_string().contains("more than 4"));
        assert!(closed.read("textures").unwrap_err().to_string().contains("regular"));
        fs::remove_dir_all(folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_to_what_they_point_to() {
        use std::os::unix::fs::symlink;
        let folder = folder("links");
        fs::write(folder.join("old"), b"old").unwrap();
        for (link, target) in [("a", "old"), ("b", "new"), ("c", "b"), ("d", "none/new")] {
            symlink(target, folder.join(link)).unwrap();
        }
        symlink(folder.join("model/far"), folder.join("e")).unwrap();
        for (link, target) in [("a", "old"), ("b", "new"), ("c", "new"), ("e", "model/far")] {
            assert!(check_place(&folder.join(link)).is_ok(), "{link}");
            write(&folder.join(link), link.as_bytes()).unwrap();
            assert_eq!(fs::read(folder.join(target)).unwrap(), link.as_bytes());
            assert!(
                fs::symlink_metadata(folder.join(link)).unwrap().is_symlink(),
                "{link} stays a link"
            );
        }
        let told = [check_place(&folder.join("d")), write(&folder.join("d"), b"x")]
            .map(|e| e.unwrap_err().to_string());
        assert!(told[0] == told[1] && told[0].contains("there is no folder `"), "{told:?}");
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn writing_replaces_the_whole_file_and_leaves_nothing_beside() {
        let folder = folder("write");
        let path = folder.join("a.png");
        write(&path, b"first").unwrap();
        write(&path, b"second").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"second");
        let lost = write(&folder.join("none/a.png"), b"x").unwrap_err();
        assert!(
            matches!(lost, Error::Write { .. })
                && lost.to_string().contains("there is no folder `"),
            "{lost}"
        );
        assert!(matches!(write(&folder, b"x"), Err(Error::Write { .. })));
        for path in [folder.join("none/a.png"), folder.clone(), path.join("b.png")] {
            let told = [check_place(&path), write(&path, b"x")].map(|e| e.unwrap_err().to_string());
            assert_eq!(told[0], told[1], "told beforehand as afterwards");
        }
        assert!(
            [folder.join("b.png"), path.clone(), PathBuf::from("b.png")]
                .iter()
                .all(|p| check_place(p).is_ok())
        );
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 2, "the folder `model` and the picture");
        fs::remove_dir_all(folder).unwrap();
    }
}
