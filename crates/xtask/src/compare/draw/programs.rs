//! Programs that draw, how each is called, and what it tells.

use super::process::{Finished, watch};
use super::subjects::{Subject, folder};
use crate::prepare::debian_packages;
use crate::shell::{command, output, repository, run, succeeds, target_folder};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Seconds that a drawing may take. Vitral ends by itself then, peers are killed.
pub(super) const LIMIT: f64 = 60.0;

/// A kind of drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Work {
    AllEdges,
    Creases,
    Lines,
    Partition,
    Filled,
    LinesAndFill,
    ShadowsAndGlass,
}

impl Work {
    /// All, in the order of the tables.
    pub(super) const ALL: [Self; 7] = [
        Self::AllEdges,
        Self::Creases,
        Self::Lines,
        Self::Partition,
        Self::Filled,
        Self::LinesAndFill,
        Self::ShadowsAndGlass,
    ];

    /// The heading of its table.
    pub(super) fn title(self) -> &'static str {
        match self {
            Self::AllEdges => "All edges",
            Self::Creases => "Contours and creases alone",
            Self::Lines => {
                "The usual lines: contours, boundaries, creases, materials and intersections"
            }
            Self::Partition => "Filled partition",
            Self::Filled => "Filled, with the usual seams",
            Self::LinesAndFill => "Filled regions and the usual lines",
            Self::ShadowsAndGlass => "Two lights with shadows, and glass",
        }
    }

    /// Options of `vitral draw`.
    pub(super) fn options(self) -> &'static str {
        match self {
            Self::AllEdges => "--lines all",
            Self::Creases => "--lines contour,boundary,crease",
            Self::Lines => "--style hidden-line",
            Self::Partition => "--style filled --seams none",
            Self::Filled => "--style filled",
            Self::LinesAndFill => "--style filled-lines",
            Self::ShadowsAndGlass => {
                "--style filled-lines --shadows --transparency --light directional:direction=-1,-2,-.5 --light point:position=-2,6,5"
            }
        }
    }
}

/// What one drawing took.
#[derive(Clone, Debug)]
pub(super) struct Figures {
    pub(super) seconds: f64,
    pub(super) processor: Option<f64>,
    /// Seconds of drawing alone, without reading, writing and the start of the program.
    pub(super) draw: Option<f64>,
    pub(super) peak: Option<u64>,
    pub(super) bytes: u64,
    pub(super) lines: Option<u64>,
    pub(super) regions: Option<u64>,
}

/// A program that draws.
pub(super) struct Program {
    /// Its name in the tables.
    pub(super) name: &'static str,
    kind: Kind,
}

enum Kind {
    Vitral(PathBuf),
    /// A script in `benches/peers/draw`, its tasks by work.
    Script {
        python: PathBuf,
        script: &'static str,
        tasks: Tasks,
    },
    Gl2ps {
        program: PathBuf,
        sort: &'static str,
    },
}

/// The name of a script's task by work.
type Tasks = &'static [(Work, &'static str)];

/// The name of a program and its script's tasks.
type Variant = (&'static str, Tasks);

const LINE_ART: [(Work, &str); 3] =
    [(Work::AllEdges, "all"), (Work::Creases, "creases"), (Work::Lines, "lines")];
const OCCT_EXACT: [(Work, &str); 1] = [(Work::AllEdges, "exact")];
const OCCT_POLYGONS: [(Work, &str); 1] = [(Work::AllEdges, "polygons")];

impl Program {
    /// The command at this path.
    pub(super) fn vitral(path: &Path) -> Self {
        Self { name: "vitral", kind: Kind::Vitral(path.to_path_buf()) }
    }

    /// Draws once; `None` where the program does no such work.
    pub(super) fn draw(&self, subject: &Subject, work: Work) -> Option<Result<Figures, String>> {
        let drawing = match folder() {
            Ok(folder) => folder.join("drawing.svg"),
            Err(why) => return Some(Err(why)),
        };
        let _ = std::fs::remove_file(&drawing);
        let mut words = self.command(subject, work, &drawing)?;
        let seconds = if matches!(self.kind, Kind::Vitral(_)) { 2.0 * LIMIT } else { LIMIT };
        Some(match watch(&mut words, seconds) {
            Err(why) => Err(why),
            Ok(None) => Err(format!("killed after {seconds} s")),
            Ok(Some(finished)) => figures(&finished, &drawing),
        })
    }

    /// The command line for a subject.
    fn command(&self, subject: &Subject, work: Work, drawing: &Path) -> Option<Command> {
        match &self.kind {
            Kind::Vitral(path) => {
                // Run vitral without the user's configuration, and let it report its times.
                let mut words = command(path);
                words
                    .arg("draw")
                    .arg(&subject.model)
                    .arg("-o")
                    .arg(drawing)
                    .args(work.options().split(' '));
                words.args([
                    "--stats",
                    "--quiet",
                    "--no-config",
                    "--time-limit",
                    &LIMIT.to_string(),
                ]);
                Some(words)
            }
            Kind::Script { python, script, tasks } => {
                // Run the peer's script, if it knows the work.
                let task = tasks.iter().find(|(known, _)| *known == work)?.1;
                let mut words = command(python);
                words
                    .arg(format!("benches/peers/draw/{script}"))
                    .arg(&subject.mesh)
                    .arg(drawing)
                    .arg(task);
                Some(words)
            }
            Kind::Gl2ps { program, sort } => {
                // Run gl2ps, which only partitions.
                if work != Work::Partition {
                    return None;
                }
                let mut words = command(program);
                words.arg(&subject.mesh).arg(drawing).arg(sort);
                if subject.closed {
                    words.arg("cull");
                }
                Some(words)
            }
        }
    }
}

/// Reads what a program tells and the drawing that it wrote.
fn figures(finished: &Finished, drawing: &Path) -> Result<Figures, String> {
    if !finished.status.success() {
        let last = finished
            .output
            .lines()
            .rev()
            .find(|line| !line.trim().is_empty())
            .unwrap_or("no message");
        return Err(format!("{:.1} s, {}: {last}", finished.seconds, finished.status));
    }
    let text = &finished.output;
    let object = text.find('{').zip(text.rfind('}')).and_then(|(from, to)| text.get(from..=to));
    let told: Value =
        object.and_then(|object| serde_json::from_str(object).ok()).unwrap_or(Value::Null);
    let svg = std::fs::read(drawing).map_err(|e| format!("no drawing: {e}"))?;
    let polygons = count(&svg, b"<polygon ") as u64;
    Ok(Figures {
        seconds: finished.seconds,
        processor: finished.processor,
        draw: told["seconds"]["draw"].as_f64(),
        peak: finished.peak,
        bytes: svg.len() as u64,
        lines: told["polylines"]
            .as_u64()
            .or_else(|| told["lines"].as_u64())
            .filter(|&lines| lines > 0),
        regions: told["regions"].as_u64().or(Some(polygons)).filter(|&regions| regions > 0),
    })
}

/// How often `word` stands in `text`.
fn count(text: &[u8], word: &[u8]) -> usize {
    text.windows(word.len()).filter(|window| window == &word).count()
}

/// The peers that are there or could be installed; what is missing is told with the way to install
/// it.
pub(super) fn peers() -> (Vec<Program>, Vec<String>) {
    let (mut programs, mut missing) = (Vec::new(), Vec::new());
    match gl2ps() {
        Ok(program) => programs.extend(["bsp", "simple"].map(|sort| Program {
            name: if sort == "bsp" { "gl2ps, BSP sort" } else { "gl2ps, simple sort" },
            kind: Kind::Gl2ps { program: program.clone(), sort },
        })),
        Err(why) => missing
            .push(format!("gl2ps is not there (`apt-get install libgl2ps-dev libosmesa6-dev gcc libc6-dev`): {why}")),
    }
    let python = target_folder().join("peers-draw/bin/python");
    let scripts: [(_, _, _, &[Variant]); 2] = [
        ("bpy", "bpy==5.0.1", "line_art.py", &[("Line Art", &LINE_ART)]),
        (
            "OCP",
            "cadquery-ocp-novtk==8.0.1.1.0",
            "occt.py",
            &[("OCCT, exact", &OCCT_EXACT), ("OCCT, polygons", &OCCT_POLYGONS)],
        ),
    ];
    for (module, package, script, variants) in scripts {
        match python_package(&python, module, package) {
            Ok(()) => programs.extend(variants.iter().map(|&(name, tasks)| Program {
                name,
                kind: Kind::Script { python: python.clone(), script, tasks },
            })),
            Err(why) => {
                let names: Vec<_> = variants.iter().map(|variant| variant.0).collect();
                missing.push(format!(
                    "{} is not there (`pip install {package} numpy`): {why}",
                    names.join(", ")
                ));
            }
        }
    }
    (programs, missing)
}

/// Builds the program of gl2ps.
fn gl2ps() -> Result<PathBuf, String> {
    debian_packages(&["libgl2ps-dev", "libosmesa6-dev", "gcc", "libc6-dev"])?;
    let program = folder()?.join("gl2ps");
    let source = repository().join("benches/peers/draw/gl2ps.c");
    run(command("cc")
        .arg("-O2")
        .arg(source)
        .arg("-o")
        .arg(&program)
        .args(["-lgl2ps", "-lOSMesa", "-lm"]))?;
    Ok(program)
}

/// Installs a package of PyPI into an environment of its own, unless its module can be imported.
fn python_package(python: &Path, module: &str, package: &str) -> Result<(), String> {
    let folder = target_folder().join("peers-draw");
    if !python.exists() {
        run(command("python3").args(["-m", "venv"]).arg(&folder))?;
    }
    if succeeds(&python.to_string_lossy(), &["-c", &format!("import numpy, {module}")]) {
        return Ok(());
    }
    println!("installing {package} into {}", folder.display());
    let pip = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", package, "numpy"];
    output(command(python).args(pip)).map(|_| ())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_counted() {
        assert_eq!(count(b"<polygon a/><polyline/><polygon b/>", b"<polygon "), 2);
    }

    #[test]
    fn a_program_does_its_own_works() {
        let mesh = PathBuf::from("a.ply");
        let subject = Subject {
            name: String::new(),
            model: mesh.clone(),
            mesh,
            closed: true,
            knot: None,
            works: &Work::ALL,
        };
        let gl2ps = Program {
            name: "gl2ps",
            kind: Kind::Gl2ps { program: PathBuf::from("gl2ps"), sort: "bsp" },
        };
        assert!(gl2ps.command(&subject, Work::AllEdges, Path::new("a.svg")).is_none());
        let words = gl2ps.command(&subject, Work::Partition, Path::new("a.svg")).unwrap();
        let words: Vec<_> = words.get_args().map(|word| word.to_string_lossy()).collect();
        assert_eq!(words, ["a.ply", "a.svg", "bsp", "cull"]);
    }
}
