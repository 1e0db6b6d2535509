//! Where the libraries and the runner are, and how a process is run that may crash or hang.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Longest time that one run may take.
const LONGEST: Duration = Duration::from_secs(300);

/// Cargo's folder of this build: the one above that of the test programs.
fn build_folder() -> PathBuf {
    let program = std::env::current_exe().expect("the test program has a path");
    program.ancestors().nth(2).expect("the program lies in target/PROFILE/deps").to_path_buf()
}

/// Our library.
pub(crate) fn ours() -> PathBuf {
    let path = build_folder().join("deps/libOSMesa.so");
    assert!(path.exists(), "{} was not built", path.display());
    path
}

/// Mesa's library, as Debian installs it.
pub(crate) fn mesa() -> Option<PathBuf> {
    let folders =
        ["/usr/lib/x86_64-linux-gnu", "/usr/lib/aarch64-linux-gnu", "/usr/lib64", "/usr/lib"];
    folders.iter().map(|folder| Path::new(folder).join("libOSMesa.so.8")).find(|path| path.exists())
}

/// The program that draws the scenes.
pub(crate) fn runner() -> Command {
    let path = build_folder().join("examples/scene_runner");
    assert!(path.exists(), "{} was not built", path.display());
    let mut command = Command::new(path);
    command
        .stdin(Stdio::null())
        .env_remove("VITRAL_THREADS")
        .env_remove("VITRAL_GL_DEBUG")
        .env_remove("VITRAL_GL_COMPAT");
    command
}

/// How a process ended, and what it said.
#[derive(Debug)]
pub(crate) struct Ending {
    /// Exit code 0.
    pub(crate) fine: bool,
    /// Standard output.
    pub(crate) output: String,
    /// Standard error, and how it ended if not well.
    pub(crate) errors: String,
}

/// Runs a process to its end, at most [`LONGEST`].
pub(crate) fn run(command: &mut Command) -> Ending {
    let mut child =
        command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the runner starts");
    let output = read(child.stdout.take());
    let errors = read(child.stderr.take());
    let ended = wait(&mut child);
    let output = output.join().unwrap_or_default();
    let mut errors = errors.join().unwrap_or_default();
    let fine = ended.as_ref().is_ok_and(std::process::ExitStatus::success);
    match ended {
        Ok(status) if !status.success() => errors += &format!("({status})"),
        Ok(_) => {}
        Err(why) => errors += &format!("({why})"),
    }
    Ending { fine, output, errors }
}

fn wait(child: &mut Child) -> Result<std::process::ExitStatus, String> {
    let start = Instant::now();
    loop {
        match child.try_wait() {
            Ok(Some(status)) => return Ok(status),
            Ok(None) if start.elapsed() < LONGEST => std::thread::sleep(Duration::from_millis(5)),
            other => {
                let _ = child.kill();
                let _ = child.wait();
                return Err(
                    other.map_or_else(|e| e.to_string(), |_| format!("no end after {LONGEST:?}"))
                );
            }
        }
    }
}

fn read(pipe: Option<impl Read + Send + 'static>) -> std::thread::JoinHandle<String> {
    std::thread::spawn(move || {
        let mut text = Vec::new();
        let _ = pipe.map(|mut pipe| pipe.read_to_end(&mut text));
        String::from_utf8_lossy(&text).into_owned()
    })
}
