//! Installs what the tests need beside a Rust toolchain, where that is possible without asking
//! anyone, and says plainly what is missing after that.

use crate::shell::{self, command, succeeds};

/// The target that everything below the faces builds for.
pub(crate) const WASM_TARGET: &str = "wasm32-unknown-unknown";

/// What is there for the WebAssembly test.
pub(crate) struct Prepared {
    /// Why the WebAssembly test cannot run, if it cannot.
    pub(crate) no_wasm: Option<String>,
}

/// Looks for node, the WebAssembly target, Mesa's OSMesa and readers of drawings, and installs them
/// if they are missing.
pub(crate) fn prepare() -> Prepared {
    let problems: Vec<String> =
        [wasm_target(), node()].into_iter().filter_map(Result::err).collect();
    for problem in problems
        .iter()
        .cloned()
        .chain([mesa(), drawing_readers()].into_iter().filter_map(Result::err))
    {
        println!("could not install: {problem}");
    }
    Prepared { no_wasm: (!problems.is_empty()).then(|| problems.join("; ")) }
}

/// Debian packages; installed only when we are root, since nobody is there to type a password.
pub(crate) fn debian_packages(names: &[&str]) -> shell::Outcome {
    let missing: Vec<&str> =
        names.iter().copied().filter(|name| !succeeds("dpkg", &["-s", name])).collect();
    if missing.is_empty() {
        return Ok(());
    }
    let wanted = missing.join(" ");
    let root = shell::output(command("id").arg("-u")).is_ok_and(|id| id.trim() == "0");
    if !root || !succeeds("apt-get", &["--version"]) {
        return Err(format!("Debian packages {wanted} (needs root and apt-get)"));
    }
    println!("installing Debian packages {wanted}");
    let apt = |arguments: &[&str]| {
        let mut apt = command("apt-get");
        apt.env("DEBIAN_FRONTEND", "noninteractive")
            .args(["-qq", "-y", "-o", "DPkg::Lock::Timeout=120"])
            .args(arguments);
        shell::output(&mut apt)
    };
    let installed = apt(&["update"])
        .and_then(|_| apt(&[&["install", "--no-install-recommends"], missing.as_slice()].concat()));
    installed.map(|_| ()).map_err(|why| format!("Debian packages {wanted}: {why}"))
}

fn wasm_target() -> shell::Outcome {
    let installed = || {
        let root = shell::output(command("rustc").args(["--print", "sysroot"])).unwrap_or_default();
        std::path::Path::new(root.trim()).join("lib/rustlib").join(WASM_TARGET).exists()
    };
    if installed() {
        return Ok(());
    }
    println!("installing the Rust target {WASM_TARGET}");
    match shell::output(command("rustup").args(["target", "add", WASM_TARGET])) {
        Ok(_) if installed() => Ok(()),
        Ok(_) => Err(format!("the Rust target {WASM_TARGET}: rustup serves another toolchain")),
        Err(why) => Err(format!("the Rust target {WASM_TARGET}: {why}")),
    }
}

/// Mesa's library, which ours is compared with, and what reads a library's tables. Tests that want
/// them say so when they are not there.
fn mesa() -> shell::Outcome {
    debian_packages(&["libosmesa6", "binutils"])
}

/// Node's package manager, and a node that is new enough for the page of the Lab; why they are not
/// there otherwise.
pub(crate) fn npm() -> shell::Outcome {
    node()?;
    let version = shell::output(command("node").arg("--version"))?;
    if !is_new_enough(version.trim()) {
        return Err(format!(
            "the Lab's page needs node {}.{} or newer, here is {}",
            NODE.0,
            NODE.1,
            version.trim()
        ));
    }
    if succeeds("npm", &["--version"]) {
        return Ok(());
    }
    debian_packages(&["npm"])?;
    if succeeds("npm", &["--version"]) {
        Ok(())
    } else {
        Err("npm: installed, but does not run".to_owned())
    }
}

/// The oldest node, major and minor version, that the tools of the page run on.
const NODE: (u32, u32) = (20, 19);

/// Whether a version, `v20.19.5`, is at least [`NODE`].
fn is_new_enough(version: &str) -> bool {
    let mut numbers =
        version.trim_start_matches('v').split('.').map_while(|number| number.parse().ok());
    (numbers.next().unwrap_or(0), numbers.next().unwrap_or(0)) >= NODE
}

/// A browser for the page of the Lab. Its tests say so when there is none.
pub(crate) fn browser() -> shell::Outcome {
    let there = ["chromium", "chromium-browser", "google-chrome"]
        .iter()
        .any(|name| succeeds(name, &["--version"]));
    if there || std::env::var_os("CHROMIUM").is_some() {
        Ok(())
    } else {
        debian_packages(&["chromium"])
    }
}

/// Programs that read PDF and DXF files of drawings. Tests that want them say so when they are not
/// there.
fn drawing_readers() -> shell::Outcome {
    debian_packages(&["poppler-utils", "mupdf-tools", "python3-ezdxf"])
}

fn node() -> shell::Outcome {
    if succeeds("node", &["--version"]) {
        return Ok(());
    }
    debian_packages(&["nodejs"])?;
    if succeeds("node", &["--version"]) {
        Ok(())
    } else {
        Err("node: installed, but does not run".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_of_node_are_compared_by_their_numbers() {
        assert!(
            ["v20.19.0", "v20.20.1", "v22.1.0", "v100.0"]
                .iter()
                .all(|version| is_new_enough(version))
        );
        assert!(
            ["v20.9.0", "v18.20.4", "", "nonsense"].iter().all(|version| !is_new_enough(version))
        );
    }
}
