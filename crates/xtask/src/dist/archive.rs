//! Trees of files as `.tar.gz` and `.deb`, the same for the same tree and time.

use super::{Built, shown};
use crate::shell::{Outcome, command, run};
use std::fs;
use std::io::Write;
use std::path::Path;

/// Packs `name` of a folder.
pub(super) fn tar(folder: &Path, name: &str, file: &Path, time: u64) -> Outcome {
    let mut tar = command("tar");
    tar.args([
        "--create",
        "--format=gnu",
        "--sort=name",
        "--owner=0",
        "--group=0",
        "--numeric-owner",
    ]);
    tar.args(["--mode=u=rwX,go=rX", "--use-compress-program=gzip -n -9"])
        .arg(format!("--mtime=@{time}"));
    tar.arg("--file").arg(file).arg("--directory").arg(folder).arg(name);
    run(tar.env("LC_ALL", "C"))
}

/// The name that Debian has for this processor.
pub(super) fn debian_processor() -> Result<&'static str, String> {
    match std::env::consts::ARCH {
        "x86_64" => Ok("amd64"),
        "aarch64" => Ok("arm64"),
        "riscv64" => Ok("riscv64"),
        other => Err(format!("Debian's name of the processor {other} is not known here")),
    }
}

/// Packs a tree as a Debian package, which is an archive of `ar` with two of `tar` inside.
pub(super) fn deb(built: &Built, tree: &Path, scratch: &Path, package: &Path) -> Outcome {
    let control = scratch.join("control");
    fs::create_dir_all(&control).map_err(|e| shown(&control, &e))?;
    let text = control_file(built, kilobytes(tree))?;
    fs::write(control.join("control"), text).map_err(|e| shown(&control, &e))?;
    let mut bytes = b"!<arch>\n".to_vec();
    add(&mut bytes, "debian-binary", b"2.0\n", built.time);
    for (name, folder) in [("control.tar.gz", control.as_path()), ("data.tar.gz", tree)] {
        let packed = scratch.join(name);
        tar(folder, ".", &packed, built.time)?;
        add(&mut bytes, name, &fs::read(&packed).map_err(|e| shown(&packed, &e))?, built.time);
    }
    fs::write(package, bytes).map_err(|e| shown(package, &e))
}

/// Adds a file to an archive of `ar`: a line of fixed columns, the bytes, and a newline where their
/// number is odd.
fn add(archive: &mut Vec<u8>, name: &str, bytes: &[u8], time: u64) {
    // Writing to a Vec cannot fail.
    let _ = writeln!(
        archive,
        "{name:<16}{time:<12}{:<6}{:<6}{:<8}{:<10}`",
        0,
        0,
        "100644",
        bytes.len()
    );
    archive.extend(bytes);
    if bytes.len() % 2 == 1 {
        archive.push(b'\n');
    }
}

/// What the package manager is told.
fn control_file(built: &Built, kilobytes: u64) -> Result<String, String> {
    let read = |file: &Path| fs::read(file).map_err(|e| shown(file, &e));
    let (command, library) = (read(&built.command)?, read(&built.library)?);
    let (major, minor) = newest_libc(&command)
        .max(newest_libc(&library))
        .ok_or("the programs name no version of libc")?;
    Ok(format!(
        "Package: vitral\nVersion: {}\nArchitecture: {}\nMaintainer: The vitral developers\n\
         Installed-Size: {kilobytes}\nDepends: libc6 (>= {major}.{minor}), libgcc-s1\nSection: graphics\nPriority: optional\n\
         Homepage: https://github.com/vitral/vitral\nDescription: classical software renderer of 3D models\n \
         A model file in, a picture or a drawing out, without GPU, display or GL driver.\n .\n \
         Thumbnails of models for file managers, and an OpenGL library (libOSMesa) for\n \
         programs that render off-screen, in a folder of its own.\n",
        built.version,
        debian_processor()?,
    ))
}

/// The newest version of the C library whose symbols a program wants: its string table names
/// `GLIBC_2.34`.
fn newest_libc(program: &[u8]) -> Option<(u32, u32)> {
    const NAME: &[u8] = b"GLIBC_";
    let versions =
        program.windows(NAME.len()).enumerate().filter(|(_, bytes)| *bytes == NAME).filter_map(
            |(start, _)| {
                let rest = &program[start + NAME.len()..];
                let end = rest.iter().position(|byte| !(byte.is_ascii_digit() || *byte == b'.'))?;
                let mut numbers = std::str::from_utf8(&rest[..end])
                    .ok()?
                    .split('.')
                    .map(|number| number.parse().ok());
                Some((numbers.next()??, numbers.next()??))
            },
        );
    versions.max()
}

/// What a tree takes on a disk.
fn kilobytes(tree: &Path) -> u64 {
    let entries = fs::read_dir(tree).into_iter().flatten().flatten();
    let size = |path: &Path| path.symlink_metadata().map_or(0, |data| data.len().div_ceil(1024));
    entries
        .map(|entry| entry.path())
        .map(|path| if path.is_dir() { kilobytes(&path) } else { size(&path) })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_an_archive_begin_at_even_bytes() {
        let mut archive = b"!<arch>\n".to_vec();
        add(&mut archive, "debian-binary", b"odd", 12);
        add(&mut archive, "b", b"", 12);
        let text = String::from_utf8(archive).unwrap();
        let line = |name: &str, size: usize| {
            format!("{name:<16}12          0     0     100644  {size:<10}`\n")
        };
        assert_eq!(text, format!("!<arch>\n{}odd\n{}", line("debian-binary", 3), line("b", 0)));
    }

    #[test]
    fn the_newest_version_counts_by_its_numbers() {
        let names = b"\0GLIBC_2.4\0GLIBC_2.34\0GLIBC_PRIVATE\0GLIBC_2.3.4\0";
        assert_eq!(newest_libc(names), Some((2, 34)));
        assert_eq!(newest_libc(b"nothing"), None);
    }
}
