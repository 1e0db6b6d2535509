//! Tries both packages: each in a root of its own that holds the package, the C library, and
//! nothing else.

use super::Built;
use crate::checks::{Check, CheckResult};
use crate::prepare::debian_packages;
use crate::shell::{Outcome, command, output, succeeds};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Why a check did not pass.
enum Trouble {
    /// What it needs is not there.
    Missing(String),
    Failed(String),
}

impl From<String> for Trouble {
    fn from(why: String) -> Self {
        Self::Failed(why)
    }
}

type Tried = Result<(), Trouble>;

/// A package that is unpacked.
struct Installed<'b> {
    built: &'b Built,
    /// What is to be `/`.
    root: PathBuf,
    /// Where the package lies in it, as `usr/local`.
    prefix: &'static str,
}

/// Tries the packages of a folder.
pub(super) fn all(built: &Built, files: &[PathBuf], folder: &Path) -> Vec<Check> {
    let mut checks = Vec::new();
    let root = |name: &str| folder.join("roots").join(name);
    let mut note = |name, tried: Tried| {
        let result = match tried {
            Ok(()) => CheckResult::Passed,
            Err(Trouble::Missing(why)) => CheckResult::Skipped(why),
            Err(Trouble::Failed(why)) => CheckResult::Failed(why),
        };
        checks.push(Check { name, result });
    };

    // Try what is the same in both by the archive.
    let [archive, package] = files.first_chunk().expect("both are packed");
    let installed = Installed { built, root: root("archive"), prefix: "usr/local" };
    match unpack_archive(archive, &installed) {
        Err(why) => note("dist::archive", Err(why.into())),
        Ok(()) => {
            note("dist::archive", installed.runs());
            note("dist::manual", installed.manual());
            note("dist::bash", installed.bash());
            note("dist::zsh", installed.reads("zsh", "-n", "share/zsh/site-functions/_vitral"));
            note(
                "dist::fish",
                installed.reads(
                    "fish",
                    "--no-execute",
                    "share/fish/vendor_completions.d/vitral.fish",
                ),
            );
            note("dist::media_types", installed.media_types());
            note("dist::desktop", installed.desktop());
        }
    }

    // Try that the package's own places work.
    let installed = Installed { built, root: root("debian"), prefix: "usr" };
    let unpacked = unpack_package(package, &installed);
    note("dist::debian", unpacked.and_then(|()| installed.runs()));
    note("dist::debian_needs", needs_are_met(package));
    checks
}

fn unpack_archive(archive: &Path, installed: &Installed<'_>) -> Outcome {
    let place = installed.place("");
    fs::create_dir_all(&place).map_err(|e| super::shown(&place, &e))?;
    let mut tar = command("tar");
    tar.arg("-xzf").arg(archive).args(["--strip-components=1", "-C"]).arg(&place);
    output(&mut tar).map(drop)
}

fn unpack_package(package: &Path, installed: &Installed<'_>) -> Tried {
    if !succeeds("dpkg", &["--version"]) {
        return Err(Trouble::Missing("dpkg is not there: the package was not unpacked".to_owned()));
    }
    output(command("dpkg").arg("-x").arg(package).arg(&installed.root))?;
    let told = output(command("dpkg").arg("--info").arg(package))?;
    if told.contains("Package: vitral\n") { Ok(()) } else { Err(Trouble::Failed(told)) }
}

/// Whether a system like this one has what the package depends on.
fn needs_are_met(package: &Path) -> Tried {
    if !succeeds("apt-get", &["--version"]) {
        return Err(Trouble::Missing(
            "apt-get is not there: nobody looked whether dependencies are met".to_owned(),
        ));
    }
    let told = output(command("apt-get").args(["install", "--simulate"]).arg(package))?;
    if told.contains("Inst vitral ") { Ok(()) } else { Err(Trouble::Failed(told)) }
}

/// Whether a program is there, once it was tried to install its package.
fn there(program: &str, package: &str) -> Tried {
    let is_there = || succeeds("sh", &["-c", &format!("command -v {program}")]);
    if is_there() || debian_packages(&[package]).is_ok() && is_there() {
        return Ok(());
    }
    Err(Trouble::Missing(format!("{program} is not there (Debian: {package})")))
}

impl Installed<'_> {
    /// A file of the package.
    fn place(&self, name: &str) -> PathBuf {
        self.root.join(self.prefix).join(name)
    }

    /// The same as a program in the root sees it.
    fn inside(&self, name: &str) -> String {
        format!("/{}/{name}", self.prefix)
    }

    /// The command and the library work there.
    fn runs(&self) -> Tried {
        // Make the root: the libraries that the linker finds for both, and a folder for what is
        // written.
        there("bwrap", "bubblewrap")?;
        if !succeeds("bwrap", &["--unshare-all", "--ro-bind", "/", "/", "true"]) {
            return Err(Trouble::Missing(
                "bwrap may not make namespaces here: nothing ran in a bare root".to_owned(),
            ));
        }
        let libraries = self.libraries()?;
        let loader = libraries
            .iter()
            .find(|path| path.contains("/ld-"))
            .ok_or("no loader is named".to_owned())?;
        let out = self.root.join("out");
        fs::create_dir_all(&out).map_err(|e| super::shown(&out, &e))?;
        let jailed = |words: &[&str]| output(self.jail(&libraries).args(words));

        // A picture is the one that the built command makes.
        let command_inside = self.inside("bin/vitral");
        let words = ["render", "builtin:teapot", "--resolution", "64x48", "-o"];
        jailed(&[&[command_inside.as_str()], &words[..], &["/out/teapot.png"]].concat())?;
        let expected = self.root.join("expected.png");
        output(command(&self.built.command).args(words).arg(&expected).arg("--no-config"))?;
        let read = |path: PathBuf| fs::read(&path).map_err(|e| super::shown(&path, &e));
        if read(out.join("teapot.png"))? != read(expected)? {
            return Err(Trouble::Failed("the picture is another one than outside".to_owned()));
        }

        // A thumbnail is made, and the library is found, with all that it is linked with.
        jailed(&[&command_inside, "thumbnail", "builtin:teapot", "/out/thumbnail.png", "128"])?;
        read(out.join("thumbnail.png"))?;
        let (line, folder) = (jailed(&[&command_inside, "osmesa-env"])?, self.inside("lib/vitral"));
        if !line.contains(&format!("LD_LIBRARY_PATH={folder} ")) {
            return Err(Trouble::Failed(format!("osmesa-env: {line}")));
        }
        let linked = jailed(&[loader, "--list", &format!("{folder}/libOSMesa.so.8")])?;
        if linked.contains("not found") || !linked.contains("libc.so") {
            return Err(Trouble::Failed(format!("libOSMesa.so.8 is linked with:\n{linked}")));
        }
        Ok(())
    }

    /// A program in the root, without environment or network.
    fn jail(&self, libraries: &[String]) -> Command {
        let mut jail = command("bwrap");
        jail.args(["--unshare-all", "--clearenv", "--die-with-parent", "--bind"])
            .arg(&self.root)
            .arg("/");
        for library in libraries {
            jail.args(["--ro-bind", library, library]);
        }
        jail.args(["--proc", "/proc", "--chdir", "/out"]);
        jail
    }

    /// The system's libraries that the command and the library are linked with, the loader among
    /// them.
    fn libraries(&self) -> Result<Vec<String>, String> {
        let mut found = Vec::new();
        for name in ["bin/vitral", "lib/vitral/libOSMesa.so.8"] {
            let told = output(command("ldd").arg(self.place(name)))?;
            let paths = told.split_whitespace().filter(|word| word.starts_with('/'));
            found.extend(paths.map(str::to_owned));
        }
        found.sort();
        found.dedup();
        Ok(found)
    }

    /// There is a page for each verb, which `man` can show.
    fn manual(&self) -> Tried {
        let help = output(command(&self.built.command).arg("--help"))?;
        let verbs = help
            .lines()
            .skip_while(|line| *line != "Commands:")
            .skip(1)
            .take_while(|line| !line.is_empty());
        let starts_verb = |line: &&str| line.starts_with("  ") && !line.starts_with("   ");
        let names: Vec<&str> =
            verbs.filter(starts_verb).filter_map(|line| line.split_whitespace().next()).collect();
        if !names.contains(&"thumbnail") {
            return Err(Trouble::Failed(format!("the help names no verbs: {names:?}")));
        }
        let pages: Vec<PathBuf> = std::iter::once("vitral.1".to_owned())
            .chain(names.iter().map(|name| format!("vitral-{name}.1")))
            .map(|page| self.place("share/man/man1").join(page))
            .collect();
        if let Some(missing) = pages.iter().find(|page| !page.exists()) {
            return Err(Trouble::Failed(format!("{} is not there", missing.display())));
        }
        there("man", "man-db")?;
        for page in pages {
            let shown = output(
                command("man").args(["-P", "cat", "-l"]).arg(&page).env("LC_ALL", "C.UTF-8"),
            )?;
            if !shown.contains("SYNOPSIS") || !shown.contains("EXAMPLES") {
                return Err(Trouble::Failed(format!("{}: man shows\n{shown}", page.display())));
            }
        }
        Ok(())
    }

    /// Bash completes a verb and an option.
    fn bash(&self) -> Tried {
        there("bash", "bash")?;
        let script = self.place("share/bash-completion/completions/vitral");
        for (words, expected) in
            [("vitral thu", "thumbnail"), ("vitral render --visib", "--visibility")]
        {
            let last = words.rsplit(' ').next().unwrap_or_default();
            let before = words[..words.len() - last.len()]
                .split_whitespace()
                .next_back()
                .unwrap_or_default();
            let line = format!(
                "source \"$0\"; COMP_WORDS=({words}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); \
                 _vitral vitral {last} {before}; echo \"${{COMPREPLY[@]}}\""
            );
            let told = output(command("bash").args(["--norc", "-c", &line]).arg(&script))?;
            if !told.split_whitespace().any(|word| word == expected) {
                return Err(Trouble::Failed(format!("bash completes `{words}` with: {told}")));
            }
        }
        Ok(())
    }

    /// Another shell reads its script.
    fn reads(&self, shell: &str, option: &str, script: &str) -> Tried {
        there(shell, shell)?;
        Ok(output(command(shell).arg(option).arg(self.place(script))).map(drop)?)
    }

    /// The database of types takes ours, and knows models by their names and by how they begin.
    fn media_types(&self) -> Tried {
        there("update-mime-database", "shared-mime-info")?;
        let folder = self.place("share/mime");
        output(command("update-mime-database").arg(&folder))?;
        let globs =
            fs::read_to_string(folder.join("globs2")).map_err(|e| super::shown(&folder, &e))?;
        match globs.contains("model/stl:*.stl") && folder.join("model/gltf-binary.xml").exists() {
            true => Ok(()),
            false => Err(Trouble::Failed(format!("the database knows: {globs}"))),
        }
    }

    /// The entry of desktops is as these want it.
    fn desktop(&self) -> Tried {
        if !self.built.has_lab {
            return Err(Trouble::Missing(
                "the Lab was not built, and without it there is no desktop entry".to_owned(),
            ));
        }
        there("desktop-file-validate", "desktop-file-utils")?;
        let told = output(
            command("desktop-file-validate").arg(self.place("share/applications/vitral.desktop")),
        )?;
        if told.is_empty() { Ok(()) } else { Err(Trouble::Failed(told)) }
    }
}
