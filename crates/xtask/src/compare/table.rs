//! The tables that `cargo xtask compare` prints: times, ratios and the targets beside them, as
//! Markdown.

use super::TRIANGLES;
use super::measure::{Frames, Program, median};
use crate::shell::{Outcome, command, output};
use std::path::Path;
use std::time::Instant;

/// Least ratio of a peer's time to vitral's, and the models that it holds for.
struct Target {
    peer: &'static str,
    ratio: f64,
    models: &'static [&'static str],
}

/// A frame of the turntable.
const FRAME_TARGETS: [Target; 2] = [
    Target { peer: "F3D", ratio: 50.0, models: &["bunny", "peterbilt"] },
    Target { peer: "PyVista", ratio: 15.0, models: &["bunny", "peterbilt"] },
];

/// The whole process; it holds for every model.
const PROCESS_TARGETS: [Target; 1] = [Target { peer: "F3D", ratio: 12.0, models: &[] }];

/// The most that a whole process may take, as a multiple of its parts measured alone.
const MOST_OF_PARTS: f64 = 1.5;

/// The generated mesh: frames a second and million triangles a second.
const TORUS_TARGETS: (f64, f64) = (30.0, 25.0);

/// Collects results and prints them as tables.
pub(super) struct Report {
    names: Vec<&'static str>,
    versions: Vec<String>,
    frames: Vec<String>,
    processes: Vec<String>,
    notes: Vec<String>,
}

impl Report {
    /// An empty report; vitral, where it takes part, is the first program.
    pub(super) fn new(programs: &[Program]) -> Self {
        let names: Vec<_> = programs.iter().map(|p| p.name).collect();
        Self {
            versions: vec![String::new(); names.len()],
            names,
            frames: vec![],
            processes: vec![],
            notes: vec![],
        }
    }

    /// Adds one row of the turntable's table.
    pub(super) fn turntable(
        &mut self,
        model: &str,
        samples: u32,
        results: &[Result<Frames, String>],
    ) {
        self.note_failures(&format!("{model}, {samples} sample(s)"), results);
        let times: Vec<_> = results.iter().map(|r| r.as_ref().ok().map(|f| f.median_ms)).collect();
        let mut row = format!("| {model} | {samples} |");
        for (index, result) in results.iter().enumerate() {
            row += &match result {
                Ok(f) => {
                    let cpu = f.cpu_ms.map_or(String::new(), |ms| format!("; {ms:.1}"));
                    format!(" {:.1} ({:.1}{cpu}) |", f.median_ms, f.min_ms)
                }
                Err(_) => " failed |".to_owned(),
            };
            if let Ok(f) = result {
                self.versions[index].clone_from(&f.about);
            }
        }
        row += &self.ratios(&times, &FRAME_TARGETS, model);
        let coverage = results.iter().map(|r| r.as_ref().ok().and_then(|f| f.coverage));
        row += &format!(" {} |", coverage.map(share).collect::<Vec<_>>().join(" / "));
        self.frames.push(row);

        // Say what drawing alone costs a peer whose hand-over costs more than that.
        for (name, frames) in self.names.iter().zip(results) {
            if let Ok(Frames { render_only_ms: Some(ms), .. }) = frames {
                self.notes.push(format!(
                    "{model}, {samples} sample(s): {name} draws in {ms:.1} ms without handing the pixels over"
                ));
            }
        }
        if let (Some(&"vitral"), Some(&Some(ms)), true) =
            (self.names.first(), times.first(), model.contains("1M"))
        {
            let (frames, rate) = (1000.0 / ms, TRIANGLES as f64 / ms / 1000.0);
            let (least_frames, least_rate) = TORUS_TARGETS;
            self.notes.push(format!(
                "{model}, {samples} sample(s): vitral {frames:.1} frames/s (target {least_frames}), {rate:.1} Mtri/s (target {least_rate})"
            ));
        }
    }

    /// Adds one row of the whole processes' table.
    pub(super) fn processes(&mut self, model: &str, results: &[Result<f64, String>]) {
        self.note_failures(&format!("{model}, whole process"), results);
        let times: Vec<_> = results.iter().map(|r| r.as_ref().ok().copied()).collect();
        let mut row = format!("| {model} |");
        for time in &times {
            row += &time
                .map_or(" failed |".to_owned(), |seconds| format!(" {:.0} |", 1000.0 * seconds));
        }
        row += &self.ratios(&times, &PROCESS_TARGETS, model);
        self.processes.push(row);
    }

    /// Notes how vitral's whole process compares with its parts, one sample a pixel.
    pub(super) fn parts(&mut self, model: &str, whole: Option<f64>, parts_ms: Option<f64>) {
        if let Some((whole, parts)) = whole.zip(parts_ms) {
            let whole = 1000.0 * whole;
            self.notes.push(format!(
                "{model}: vitral's whole process takes {whole:.0} ms, {:.2}x of reading, drawing and encoding measured \
                 alone, {parts:.0} ms (target at most {MOST_OF_PARTS}x)",
                whole / parts
            ));
        }
    }

    /// Measures what Python and the peers' libraries cost before anything is loaded: part of the
    /// whole process.
    pub(super) fn start_up(&mut self, python: &Path, rounds: usize) -> Outcome {
        for module in ["f3d", "pyvista"] {
            let once = |_| {
                let start = Instant::now();
                output(command(python).args(["-c", &format!("import {module}")]))
                    .map(|_| start.elapsed().as_secs_f64())
            };
            let seconds = (0..rounds.max(1)).map(once).collect::<Result<Vec<_>, _>>()?;
            let ms = 1000.0 * median(seconds);
            self.notes.push(format!(
                "starting Python and importing {module}: {ms:.0} ms of each whole process"
            ));
        }
        Ok(())
    }

    /// One cell for each peer: its time over vitral's, with the target where there is one.
    fn ratios(&self, times: &[Option<f64>], targets: &[Target], model: &str) -> String {
        let Some((&"vitral", peers)) = self.names.split_first() else { return String::new() };
        let mut cells = String::new();
        for (peer, time) in peers.iter().zip(&times[1..]) {
            let ratio = time.zip(times[0]).map(|(theirs, ours)| theirs / ours);
            let target = targets
                .iter()
                .find(|t| t.peer == *peer && (t.models.is_empty() || t.models.contains(&model)));
            cells += &match (ratio, target) {
                (None, _) => " – |".to_owned(),
                (Some(ratio), None) => format!(" {ratio:.1}x |"),
                (Some(ratio), Some(t)) if ratio >= t.ratio => {
                    format!(" {ratio:.1}x (target {}x) |", t.ratio)
                }
                (Some(ratio), Some(t)) => {
                    format!(" **{ratio:.1}x (target {}x missed)** |", t.ratio)
                }
            };
        }
        cells
    }

    fn note_failures<T>(&mut self, what: &str, results: &[Result<T, String>]) {
        for (name, result) in self.names.iter().zip(results) {
            if let Err(why) = result {
                self.notes.push(format!("{what}: {name} failed: {why}"));
            }
        }
    }

    /// The head of a table whose rows start with the columns `first` and end with `last`.
    fn head(&self, first: &str, unit: &str, last: &str) -> String {
        let mut head = first.to_owned();
        self.names.iter().for_each(|name| head += &format!(" {name} {unit} |"));
        if let Some((&"vitral", peers)) = self.names.split_first() {
            peers.iter().for_each(|peer| head += &format!(" {peer} / vitral |"));
        }
        head += last;
        let rule = "---|".repeat(head.matches('|').count() - 1);
        format!("{head}\n|{rule}\n")
    }
}

impl std::fmt::Display for Report {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (name, version) in
            self.names.iter().zip(&self.versions).filter(|(_, version)| !version.is_empty())
        {
            writeln!(f, "* {name}: {version}")?;
        }
        let coverage = format!(" coverage {} |", self.names.join(" / "));
        write!(
            f,
            "\nOne frame of a turntable, ms: median (fastest; processor time of all threads)\n\n{}",
            self.head("| model | samples |", "ms", &coverage)
        )?;
        self.frames.iter().try_for_each(|row| writeln!(f, "{row}"))?;
        write!(
            f,
            "\nWhole process, file to PNG, one sample a pixel\n\n{}",
            self.head("| model |", "ms", "")
        )?;
        self.processes.iter().try_for_each(|row| writeln!(f, "{row}"))?;
        writeln!(f)?;
        self.notes.iter().try_for_each(|note| writeln!(f, "* {note}"))
    }
}

/// A share in percent.
fn share(share: Option<f64>) -> String {
    share.map_or("–".to_owned(), |s| format!("{:.1} %", 100.0 * s))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frames(median_ms: f64) -> Frames {
        Frames {
            median_ms,
            min_ms: median_ms,
            cpu_ms: Some(7.0),
            coverage: Some(0.5),
            render_only_ms: None,
            parts_ms: None,
            about: "4.0".to_owned(),
        }
    }

    fn report() -> Report {
        let python = Path::new("python");
        Report::new(&[Program::vitral(python), Program::f3d(python), Program::pyvista(python)])
    }

    #[test]
    fn ratios_stand_beside_their_targets() {
        let mut report = report();
        report.turntable("bunny", 1, &[Ok(frames(10.0)), Ok(frames(600.0)), Ok(frames(100.0))]);
        let text = report.to_string();
        assert!(
            text.contains(
                "| 60.0x (target 50x) | **10.0x (target 15x missed)** | 50.0 % / 50.0 % / 50.0 % |"
            ),
            "{text}"
        );
        let columns = |line: &str| line.matches('|').count();
        let table: Vec<_> = text.lines().filter(|line| line.starts_with('|')).take(3).collect();
        assert!(table.iter().all(|line| columns(line) == columns(table[0])), "{table:?}");
    }

    #[test]
    fn the_large_mesh_gives_rates() {
        let mut report = report();
        report.turntable(
            "torus, 1M triangles",
            4,
            &[Ok(frames(20.0)), Ok(frames(600.0)), Ok(frames(100.0))],
        );
        assert!(
            report.to_string().contains("50.0 frames/s (target 30), 50.0 Mtri/s (target 25)"),
            "{report}"
        );
    }

    #[test]
    fn the_whole_is_compared_with_its_parts() {
        let mut report = report();
        report.parts("bunny", Some(0.06), Some(50.0));
        report.parts("torus", None, Some(50.0));
        let text = report.to_string();
        assert!(text.contains("60 ms, 1.20x of") && !text.contains("torus"), "{text}");
    }

    #[test]
    fn a_failure_is_told() {
        let mut report = report();
        report.processes("bunny", &[Ok(0.1), Err("no GL".to_owned()), Ok(0.5)]);
        let text = report.to_string();
        assert!(text.contains("| bunny | 100 | failed | 500 | – | 5.0x |"), "{text}");
        assert!(text.contains("bunny, whole process: F3D failed: no GL"), "{text}");
    }
}
