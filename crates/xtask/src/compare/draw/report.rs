//! The tables of `cargo xtask compare draw` as Markdown.

use super::limits::Held;
use super::programs::{Figures, LIMIT, Work};
use super::subjects::{KNOTS, Subject, grouped};
use crate::shell::{command, output};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// A program and its seconds for each size of the knot.
type Knots = (String, [Option<f64>; 4]);

/// Collects figures.
pub(super) struct Report {
    head: String,
    /// Rows of each work's table.
    rows: BTreeMap<Work, String>,
    /// Seconds of a program's knots, by work.
    growth: BTreeMap<Work, Vec<Knots>>,
    limits: String,
}

impl Report {
    /// An empty report; the machine is described as it is at the start.
    pub(super) fn new(missing: &[String], rounds: usize) -> Self {
        let mut head = format!(
            "# Vector drawings, file to SVG\n\n`cargo xtask compare draw`: whole processes, {}, in turns; drawings that take more than \
             5 s are made once. Isometric view, parallel projection.\n\n{}",
            if rounds == 1 {
                "one round".to_owned()
            } else {
                format!("the median of {rounds} rounds")
            },
            machine()
        );
        for line in missing {
            let _ = writeln!(head, "* {line}");
        }
        Self { head, rows: BTreeMap::new(), growth: BTreeMap::new(), limits: String::new() }
    }

    /// Adds one row.
    pub(super) fn add(
        &mut self,
        work: Work,
        subject: &Subject,
        program: &str,
        result: Result<Figures, String>,
    ) {
        let rows = self.rows.entry(work).or_default();
        let _ = match &result {
            Ok(figures) => writeln!(rows, "| {} | {program} |{}", subject.name, cells(figures)),
            Err(why) => {
                writeln!(rows, "| {} | {program} | – | – | – | – | – | – | {why} |", subject.name)
            }
        };

        // Keep the seconds of knots.
        let step =
            subject.knot.and_then(|triangles| KNOTS.iter().position(|&known| known == triangles));
        if let Some(step) = step {
            let programs = self.growth.entry(work).or_default();
            let known = programs.iter().position(|(name, _)| name == program);
            let place = known.unwrap_or_else(|| {
                programs.push((program.to_owned(), [None; 4]));
                programs.len() - 1
            });
            programs[place].1[step] =
                result.ok().map(|figures| figures.processor.unwrap_or(figures.seconds));
        }
    }

    /// Adds one row of the table of limits.
    pub(super) fn add_limit(&mut self, held: &Held) {
        let code = held.code.map_or("–".to_owned(), |code| code.to_string());
        let kept = if held.kept { "yes" } else { "**no**" };
        let (seconds, peak) = (held.seconds, megabytes(held.peak));
        let _ = writeln!(
            self.limits,
            "| {} | `{}` | {code} | {seconds:.2} | {peak} | {kept} | {} |",
            held.mesh, held.options, held.said
        );
    }

    /// The whole text.
    pub(super) fn finish(&self) -> String {
        let mut text = self.head.clone();
        for (work, rows) in &self.rows {
            let head = "| model | program | s | processor s | drawing alone, s | memory, MB | SVG, MB | lines; regions |";
            let _ = write!(
                text,
                "\n## {}\n\n`vitral draw {}`\n\n{head} why not |\n|---|---|---:|---:|---:|---:|---:|---:|---|\n{rows}",
                work.title(),
                work.options()
            );
        }
        text += "\n## Growth\n\nExponents of processor time from one size of the knot to the next, the start of the program included.\n\n";
        text += "| work | program | 1 000 to 10 000 | to 100 000 | to 1 000 000 | 10 000 to 1 000 000 |\n|---|---|---:|---:|---:|---:|\n";
        for (work, programs) in &self.growth {
            for (program, seconds) in programs {
                let steps =
                    [(0, 1), (1, 2), (2, 3), (1, 3)].map(|(from, to)| exponent(seconds, from, to));
                let _ = writeln!(text, "| {} | {program} | {} |", work.title(), steps.join(" | "));
            }
        }
        text += "\n## Limits\n\nWithin .5 s of `--time-limit`, within 10 % of `--max-memory` in resident memory; code 7 says that a limit was reached.\n\n";
        text += "| mesh | `vitral draw` | code | s | memory, MB | kept | last line |\n|---|---|---:|---:|---:|---|---|\n";
        text + &self.limits
    }
}

/// The cells of one drawing.
fn cells(figures: &Figures) -> String {
    let seconds =
        |seconds: Option<f64>| seconds.map_or("–".to_owned(), |seconds| format!("{seconds:.2}"));
    let number = |number: Option<u64>| number.map_or("–".to_owned(), grouped);
    format!(
        " {} | {} | {} | {} | {:.2} | {}; {} | |",
        seconds(Some(figures.seconds)),
        seconds(figures.processor),
        seconds(figures.draw),
        megabytes(figures.peak),
        figures.bytes as f64 / 1e6,
        number(figures.lines),
        number(figures.regions)
    )
}

/// Bytes in megabytes.
fn megabytes(bytes: Option<u64>) -> String {
    bytes.map_or("–".to_owned(), |bytes| format!("{:.0}", bytes as f64 / 1e6))
}

/// How seconds grow with triangles between two knots.
fn exponent(seconds: &[Option<f64>; 4], from: usize, to: usize) -> String {
    match (seconds[from], seconds[to]) {
        (Some(few), Some(many)) if few > 0.0 && many > 0.0 => {
            format!("{:.2}", (many / few).log10() / (KNOTS[to] as f64 / KNOTS[from] as f64).log10())
        }
        _ => "–".to_owned(),
    }
}

/// Describes the machine, its load, and the limit of time.
fn machine() -> String {
    let read = |path: &str| std::fs::read_to_string(path).unwrap_or_default();
    let after = |text: &str, key: &str| {
        let line = text.lines().find(|line| line.starts_with(key)).unwrap_or_default();
        line.split_once([':', '='])
            .map_or("unknown", |(_, value)| value)
            .trim()
            .trim_matches('"')
            .to_owned()
    };
    let (cpu, memory, system) =
        (read("/proc/cpuinfo"), read("/proc/meminfo"), read("/etc/os-release"));
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let kibibytes: f64 =
        after(&memory, "MemTotal").trim_end_matches("kB").trim().parse().unwrap_or(0.0);
    let load: Vec<String> = read("/proc/loadavg").split(' ').take(3).map(str::to_owned).collect();
    let rust = output(command("rustc").arg("--version")).unwrap_or_default();
    format!(
        "* Machine: {cores} cores of {}, {:.0} GiB, {}. {}. Load at the start: {}.\n\
         * *s* is on the clock, *processor s* of all threads; *memory* is the most that was resident. A busy machine lengthens the first \
         most.\n\
         * A program has {LIMIT} s for a drawing. Peers get triangles as binary PLY, and their time contains the start of Python where they \
         are libraries of it; *drawing alone* does not.\n",
        after(&cpu, "model name"),
        kibibytes / 1024.0 / 1024.0,
        after(&system, "PRETTY_NAME"),
        rust.trim(),
        load.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_compare_knots() {
        let seconds = [None, Some(0.1), Some(1.0), Some(20.0)];
        assert_eq!(exponent(&seconds, 1, 2), "1.00");
        assert_eq!(exponent(&seconds, 1, 3), "1.15");
        assert_eq!(exponent(&seconds, 0, 1), "–");
    }

    #[test]
    fn rows_have_as_many_cells_as_the_head() {
        let mesh = std::path::PathBuf::from("a.ply");
        let subject = Subject {
            name: "knot".to_owned(),
            model: mesh.clone(),
            mesh,
            closed: true,
            knot: Some(10_000),
            works: &Work::ALL,
        };
        let figures = Figures {
            seconds: 1.5,
            processor: None,
            draw: Some(0.25),
            peak: Some(12_000_000),
            bytes: 2_500_000,
            lines: Some(1234),
            regions: None,
        };
        let mut report = Report::new(&["X is not there".to_owned()], 3);
        report.add(Work::Creases, &subject, "vitral", Ok(figures));
        report.add(Work::Creases, &subject, "other", Err("killed after 60 s".to_owned()));
        let text = report.finish();
        assert!(
            text.contains("| knot | vitral | 1.50 | – | 0.25 | 12 | 2.50 | 1 234; – | |"),
            "{text}"
        );
        assert!(text.contains("* X is not there"), "{text}");
        let table = text
            .lines()
            .skip_while(|line| !line.starts_with("| model"))
            .take_while(|line| line.starts_with('|'));
        assert!(
            table.clone().count() == 4
                && table.map(|line| line.matches('|').count()).all(|bars| bars == 10),
            "{text}"
        );
    }
}
