//! `cargo xtask dist`: what people install, in `target/dist`: an archive, a Debian package, the
//! wheel, a bill of materials, checksums.
//!
//! The same commit gives the same bytes with the same tools in the same folder: times are the
//! commit's, names are sorted, owners are 0.
//!
//! | file | what |
//! |---|---|
//! | `layout.rs` | the tree of files that a package installs |
//! | `desktop.rs` | what desktops are told: types of files, thumbnails, the Lab |
//! | `licences.rs` | texts of licences, of the crates that are built in as well |
//! | `archive.rs` | trees as `.tar.gz` and `.deb` |
//! | `materials.rs` | the bill of materials, CycloneDX |
//! | `trial.rs` | both packages tried in a root that holds little else |

mod archive;
mod desktop;
mod layout;
mod licences;
mod materials;
mod trial;

use crate::checks::{Check, CheckResult};
use crate::shell::{
    Outcome, cargo, command, output, profile_folder, relative, repository, run, target_folder,
};
use crate::{lab, osmesa, python, test};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// What is packed.
pub(crate) struct Built {
    /// The command.
    command: PathBuf,
    /// libOSMesa.
    library: PathBuf,
    /// Whether the command has the Lab inside.
    has_lab: bool,
    /// What `cargo metadata` says of all packages that are built in.
    metadata: Value,
    version: String,
    /// Seconds since 1970 that every file is dated.
    time: u64,
}

/// Makes everything, or tries it by `test`; `--profile NAME` builds with another profile than
/// release, `--no-lab` leaves the Lab and its desktop entry out.
pub(crate) fn run_all(options: &[&str]) -> Outcome {
    if options == ["test"] {
        return try_out();
    }

    // Read the options.
    let (mut profile, mut with_lab) = ("release", true);
    let mut words = options.iter();
    while let Some(word) = words.next() {
        match *word {
            "--no-lab" => with_lab = false,
            "--profile" => profile = words.next().ok_or("--profile: a name is wanted")?,
            other => {
                return Err(format!(
                    "dist: there is no option {other}; there are --profile NAME and --no-lab"
                ));
            }
        }
    }

    // Build and pack.
    if with_lab {
        lab::build_inside()?;
    }
    let built = build(profile, with_lab)?;
    let folder = target_folder().join("dist");
    let mut files = pack(&built, &folder)?;
    let wheels = target_folder().join("wheels");
    files.push(taken(&python::wheel_of(&wheels, profile, &built.library, built.time)?, &folder)?);
    files.push(materials::write(&built, &folder)?);
    files.push(sums(&folder, &files)?);

    // Tell what there is.
    for file in &files {
        let bytes = fs::metadata(file).map_err(|e| shown(file, &e))?.len();
        println!("{}: {:.2} MB", relative(file), bytes as f64 / 1e6);
    }
    if !with_lab {
        println!("without the Lab, and so without a desktop entry");
    }
    Ok(())
}

/// Runs the checks of `cargo xtask test` alone.
fn try_out() -> Outcome {
    let checks = test_all(test::PROFILE);
    checks.iter().for_each(|check| println!("test {} ... {}", check.name, check.result));
    match checks.iter().any(|check| matches!(check.result, CheckResult::Failed(_))) {
        true => Err("some checks failed".to_owned()),
        false => Ok(()),
    }
}

/// Packs what this profile builds, twice, and tries both packages.
pub(crate) fn test_all(profile: &str) -> Vec<Check> {
    let failed = |name, why| vec![Check { name, result: CheckResult::Failed(why) }];
    if !cfg!(target_os = "linux") {
        let why = "archives and Debian packages are made on Linux".to_owned();
        return vec![Check { name: "dist", result: CheckResult::Skipped(why) }];
    }
    let built = match build(profile, lab::is_built()) {
        Ok(built) => built,
        Err(why) => return failed("dist::build", why),
    };
    let folder = target_folder().join("dist-test");
    let packed = pack(&built, &folder).and_then(|mut files| {
        files.push(materials::write(&built, &folder)?);
        sums(&folder, &files).map(|_| files)
    });
    let files = match packed {
        Ok(files) => files,
        Err(why) => return failed("dist::pack", why),
    };
    let same =
        same_bytes(&built, &files).map_or_else(CheckResult::Failed, |()| CheckResult::Passed);
    let mut checks = vec![Check { name: "dist::same_bytes", result: same }];
    checks.extend(trial::all(&built, &files, &folder));
    checks
}

/// Packs once more, elsewhere, and compares.
fn same_bytes(built: &Built, files: &[PathBuf]) -> Outcome {
    let folder = target_folder().join("dist-test-twice");
    let mut twice = pack(built, &folder)?;
    twice.push(materials::write(built, &folder)?);
    for (first, second) in files.iter().zip(&twice) {
        let read = |file: &Path| fs::read(file).map_err(|e| shown(file, &e));
        if read(first)? != read(second)? {
            return Err(format!("{} is not the same twice", relative(first)));
        }
    }
    fs::remove_dir_all(&folder).map_err(|e| shown(&folder, &e))
}

/// Builds the command and the library.
fn build(profile: &str, has_lab: bool) -> Result<Built, String> {
    let mut words = cargo();
    words.args(["build", "--quiet", "--profile", profile, "--package", "vitral-cli"]);
    let features = ["--features", "vitral-cli/lab"];
    if has_lab {
        words.args(features);
    }
    run(&mut words)?;
    let library = osmesa::build(profile)?;
    let command = profile_folder(profile).join("vitral");
    let metadata = metadata(if has_lab { &features } else { &[] })?;
    let version = metadata["packages"]
        .as_array()
        .into_iter()
        .flatten()
        .find(|package| package["name"] == "vitral-cli");
    let version = version
        .and_then(|package| package["version"].as_str())
        .ok_or("cargo metadata tells no version")?;
    Ok(Built { command, library, has_lab, version: version.to_owned(), metadata, time: time()? })
}

/// What cargo knows of the packages of this platform.
fn metadata(features: &[&str]) -> Result<Value, String> {
    let host = output(command("rustc").arg("-vV"))?;
    let host =
        host.lines().find_map(|line| line.strip_prefix("host: ")).ok_or("rustc tells no host")?;
    let mut words = cargo();
    words
        .args(["metadata", "--format-version", "1", "--locked", "--filter-platform", host])
        .args(features);
    serde_json::from_str(&output(&mut words)?).map_err(|e| format!("cargo metadata: {e}"))
}

/// The time of the commit, or what `SOURCE_DATE_EPOCH` says.
fn time() -> Result<u64, String> {
    let told = std::env::var("SOURCE_DATE_EPOCH").ok().filter(|text| !text.is_empty());
    let text = match told {
        Some(text) => text,
        None => output(command("git").args(["log", "-1", "--format=%ct"])).map_err(|why| {
            format!(
                "no time for the files: {why}\nhint: set SOURCE_DATE_EPOCH outside of a git clone"
            )
        })?,
    };
    text.trim()
        .parse()
        .map_err(|_| format!("SOURCE_DATE_EPOCH={text}: seconds since 1970 are wanted"))
}

/// Makes the archive and the Debian package in an empty folder; gives their paths.
fn pack(built: &Built, folder: &Path) -> Result<Vec<PathBuf>, String> {
    let _ = fs::remove_dir_all(folder);
    fs::create_dir_all(folder).map_err(|e| shown(folder, &e))?;
    let scratch = folder.join("scratch");

    let name = format!("vitral-{}-{}-linux", built.version, std::env::consts::ARCH);
    layout::lay_out(built, &scratch.join("archive").join(&name), layout::Kind::Archive)?;
    let archive = folder.join(format!("{name}.tar.gz"));
    archive::tar(&scratch.join("archive"), &name, &archive, built.time)?;

    let tree = scratch.join("debian");
    layout::lay_out(built, &tree.join("usr"), layout::Kind::Debian)?;
    let package =
        folder.join(format!("vitral_{}_{}.deb", built.version, archive::debian_processor()?));
    archive::deb(built, &tree, &scratch, &package)?;
    fs::remove_dir_all(&scratch).map_err(|e| shown(&scratch, &e))?;
    Ok(vec![archive, package])
}

/// Copies a file into a folder; gives its path there.
fn taken(file: &Path, folder: &Path) -> Result<PathBuf, String> {
    let place = folder.join(file.file_name().unwrap_or_default());
    fs::copy(file, &place).map_err(|e| shown(file, &e))?;
    Ok(place)
}

/// Writes the checksums of files of a folder.
fn sums(folder: &Path, files: &[PathBuf]) -> Result<PathBuf, String> {
    let mut names: Vec<_> = files.iter().filter_map(|file| file.file_name()).collect();
    names.sort();
    let sums = output(command("sha256sum").current_dir(folder).arg("--").args(names))?;
    let place = folder.join("SHA256SUMS");
    fs::write(&place, sums).map_err(|e| shown(&place, &e))?;
    Ok(place)
}

/// A failure about a file.
fn shown(path: &Path, error: &std::io::Error) -> String {
    format!("{}: {error}", path.display())
}

/// A text of the repository.
fn text_of(path: &str) -> Result<String, String> {
    let path = repository().join(path);
    fs::read_to_string(&path).map_err(|e| shown(&path, &e))
}
