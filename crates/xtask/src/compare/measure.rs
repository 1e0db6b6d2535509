//! One program's turntable, and one program's whole process.

use crate::shell::{command, output, target_folder};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Size of every picture.
const RESOLUTION: &str = "1024x768";

/// What a turntable gave.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Frames {
    /// Median milliseconds of a frame.
    pub(super) median_ms: f64,
    /// The fastest frame's milliseconds.
    pub(super) min_ms: f64,
    /// Median milliseconds of processor time of all threads, if the program says it.
    pub(super) cpu_ms: Option<f64>,
    /// Share of pixels that show the model, if the program says it.
    pub(super) coverage: Option<f64>,
    /// Milliseconds of drawing alone, without handing the pixels over, if the program says it.
    pub(super) render_only_ms: Option<f64>,
    /// Milliseconds of the parts of a whole process, one by one, if the program says it.
    pub(super) parts_ms: Option<f64>,
    /// The program's version and renderer, for the report.
    pub(super) about: String,
}

impl Frames {
    /// Reads the JSON object that is the last line of a program's output.
    fn parse(text: &str) -> Result<Self, String> {
        let line = text
            .lines()
            .rev()
            .find(|line| line.starts_with('{'))
            .ok_or("printed no JSON object")?;
        let value: Value = serde_json::from_str(line).map_err(|e| e.to_string())?;
        let number = |key: &str| value[key].as_f64();
        let about = ["version", "renderer"].iter().filter_map(|key| value[*key].as_str());
        Ok(Self {
            median_ms: number("median_ms").ok_or("printed no `median_ms`")?,
            min_ms: number("min_ms").ok_or("printed no `min_ms`")?,
            cpu_ms: number("cpu_ms"),
            coverage: number("coverage"),
            render_only_ms: number("render_only_ms"),
            parts_ms: number("parts_ms"),
            about: about.collect::<Vec<_>>().join(", "),
        })
    }

    /// The median round; the fastest frame of all rounds.
    pub(super) fn median(rounds: Vec<Self>) -> Self {
        let min_ms = rounds.iter().map(|r| r.min_ms).fold(f64::INFINITY, f64::min);
        let mut rounds = rounds;
        rounds.sort_by(|a, b| a.median_ms.total_cmp(&b.median_ms));
        let middle = rounds.len() / 2;
        Self { min_ms, ..rounds.swap_remove(middle) }
    }
}

/// The middle value; of an even number the upper middle one.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// A program to measure.
pub(super) struct Program {
    /// Its name in the tables.
    pub(super) name: &'static str,
    kind: Kind,
}

enum Kind {
    /// The folder with `vitral` and `examples/turntable_bench`.
    Vitral(PathBuf),
    /// A script in `benches/peers`.
    Script { python: PathBuf, script: &'static str },
}

impl Program {
    /// Vitral, from cargo's release folder.
    pub(super) fn vitral(release: &Path) -> Self {
        Self { name: "vitral", kind: Kind::Vitral(release.to_path_buf()) }
    }

    /// F3D's Python package.
    pub(super) fn f3d(python: &Path) -> Self {
        let script = "benches/peers/f3d_turntable.py";
        Self { name: "F3D", kind: Kind::Script { python: python.to_path_buf(), script } }
    }

    /// PyVista.
    pub(super) fn pyvista(python: &Path) -> Self {
        let script = "benches/peers/pyvista_turntable.py";
        Self { name: "PyVista", kind: Kind::Script { python: python.to_path_buf(), script } }
    }

    /// Runs a turntable in one process.
    pub(super) fn turntable(
        &self,
        model: &Path,
        samples: u32,
        frames: usize,
    ) -> Result<Frames, String> {
        let (samples, frames) = (samples.to_string(), frames.to_string());
        let mut program = match &self.kind {
            Kind::Vitral(folder) => {
                let mut bench = command(folder.join("examples/turntable_bench"));
                bench.arg(model).args([&frames, &samples]);
                bench
            }
            Kind::Script { python, script } => {
                let mut peer = command(python);
                peer.arg(script).arg(model).args(["--samples", &samples, "--frames", &frames]);
                peer.args(["--resolution", RESOLUTION]);
                peer
            }
        };
        Frames::parse(&output(&mut program)?).map_err(|why| format!("{}: {why}", self.name))
    }

    /// Seconds from the start of the process to its end, one model file to one PNG file, one sample
    /// a pixel.
    pub(super) fn whole_process(&self, model: &Path) -> Result<f64, String> {
        let picture = target_folder().join(format!("compare-{}.png", self.name));
        let mut program = match &self.kind {
            Kind::Vitral(folder) => {
                let mut vitral = command(folder.join("vitral"));
                vitral.arg("render").arg(model).arg("-o").arg(&picture);
                vitral
            }
            Kind::Script { python, script } => {
                let mut peer = command(python);
                peer.arg(script).arg(model).arg("--output").arg(&picture);
                peer
            }
        };
        program.args(["--resolution", RESOLUTION, "--samples", "1"]);
        let start = Instant::now();
        output(&mut program)?;
        Ok(start.elapsed().as_secs_f64())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_object_counts() {
        let text = "hello\n{\"median_ms\": 1}\n{\"median_ms\": 2.5, \"min_ms\": 2, \"coverage\": 0.25, \"version\": \"4\"}\n";
        let frames = Frames::parse(text).unwrap();
        assert_eq!(
            (frames.median_ms, frames.min_ms, frames.coverage, frames.about.as_str()),
            (2.5, 2.0, Some(0.25), "4")
        );
        assert!(Frames::parse("nothing").is_err() && Frames::parse("{}").is_err());
    }

    #[test]
    fn the_middle_round_counts() {
        let round = |median_ms: f64, min_ms: f64| Frames {
            median_ms,
            min_ms,
            cpu_ms: None,
            coverage: None,
            render_only_ms: None,
            parts_ms: None,
            about: String::new(),
        };
        let middle = Frames::median(vec![round(9.0, 1.0), round(2.0, 2.0), round(5.0, 3.0)]);
        assert_eq!((middle.median_ms, middle.min_ms), (5.0, 1.0));
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
    }
}
