//! `cargo xtask compare draw`: `vitral draw` and other programs that make vector drawings of
//! meshes, file to SVG.
//!
//! Peers: Blender's Line Art (the `bpy` package), OCCT's hidden-line removal (the
//! `cadquery-ocp-novtk` package) and gl2ps over Mesa's OSMesa. Those that cannot be installed are
//! told, with the way to install them. Every figure is that of a whole process; the programs run in
//! turns, and the median over the rounds counts.

mod limits;
mod process;
mod programs;
mod report;
mod subjects;

use crate::shell::{
    Outcome, cargo, command, output, repository, run as run_command, target_folder,
};
use programs::{Figures, Program, Work, peers};
use report::Report;
use std::collections::BTreeMap;
use std::path::PathBuf;
use subjects::Subject;

/// A drawing that takes longer is made once, seconds.
const ONCE_ABOVE: f64 = 5.0;

/// What to measure.
struct Choices {
    rounds: usize,
    with_peers: bool,
    /// The command to measure, instead of one that is built.
    vitral: Option<PathBuf>,
}

/// Installs, builds, measures, prints and writes the results.
pub(crate) fn run(options: &[&str]) -> Outcome {
    let choices = read(options)?;
    let vitral = match &choices.vitral {
        Some(path) => path.clone(),
        None => {
            run_command(cargo().args(["build", "--release", "--package", "vitral-cli"]))?;
            target_folder().join("release/vitral")
        }
    };
    let (others, missing) = if choices.with_peers { peers() } else { (Vec::new(), Vec::new()) };
    let mut programs = vec![Program::vitral(&vitral)];
    programs.extend(others);
    let subjects = subjects::subjects()?;

    // Draw everything, work after work; then try the limits.
    let mut report = Report::new(&missing, choices.rounds);
    let mut slow = BTreeMap::new();
    for work in Work::ALL {
        for subject in subjects.iter().filter(|subject| subject.works.contains(&work)) {
            eprintln!("{}: {}", work.title(), subject.name);
            for (program, result) in in_turns(&programs, subject, work, choices.rounds, &mut slow) {
                report.add(work, subject, program, result);
            }
            write(&report.finish())?;
        }
    }
    for held in limits::measure(&vitral)? {
        report.add_limit(&held);
    }
    let text = report.finish();
    print!("{text}");
    write(&text)
}

/// Reads the options.
fn read(options: &[&str]) -> Result<Choices, String> {
    let mut choices = Choices { rounds: 3, with_peers: true, vitral: None };
    let mut words = options.iter();
    while let Some(option) = words.next() {
        match *option {
            "--quick" => choices.rounds = 1,
            "--no-peers" => choices.with_peers = false,
            "--vitral" => {
                let path = words
                    .next()
                    .ok_or("compare draw: --vitral needs the path of a built command")?;
                choices.vitral = Some(PathBuf::from(path));
            }
            other => {
                return Err(format!(
                    "compare draw: unknown option `{other}` (there are --quick, --no-peers and --vitral PATH)"
                ));
            }
        }
    }
    Ok(choices)
}

/// Draws with every program that does such work, in turns; gives each program's median.
///
/// `slow` holds, for a program and a kind of work, the largest knot that it did not end: larger
/// ones are not tried.
fn in_turns<'a>(
    programs: &'a [Program],
    subject: &Subject,
    work: Work,
    rounds: usize,
    slow: &mut BTreeMap<(&'a str, Work), u64>,
) -> Vec<(&'a str, Result<Figures, String>)> {
    let mut results: Vec<(&str, Result<Vec<Figures>, String>)> = Vec::new();
    for round in 0..rounds {
        let mut turn = 0;
        for program in programs {
            // Leave out what failed, what takes long and what would take longer still.
            if round > 0 {
                let Some((name, result)) = results.get(turn) else { break };
                if *name != program.name {
                    continue;
                }
                turn += 1;
                if !result
                    .as_ref()
                    .is_ok_and(|done| done.iter().all(|figures| figures.seconds < ONCE_ABOVE))
                {
                    continue;
                }
            } else if let (Some(triangles), Some(&least)) =
                (subject.knot, slow.get(&(program.name, work)))
                && triangles > least
            {
                let why = format!("not tried: {} triangles are too many", subjects::grouped(least));
                results.push((program.name, Err(why)));
                continue;
            }

            // Draw.
            let Some(one) = program.draw(subject, work) else { continue };
            if let (Err(_), Some(triangles)) = (&one, subject.knot) {
                slow.insert((program.name, work), triangles);
            }
            match (round, one) {
                (0, one) => results.push((program.name, one.map(|figures| vec![figures]))),
                (_, one) => {
                    let place = &mut results[turn - 1].1;
                    match (place.as_mut(), one) {
                        (Ok(done), Ok(figures)) => done.push(figures),
                        (_, Err(why)) => *place = Err(why),
                        (Err(_), Ok(_)) => {}
                    }
                }
            }
        }
    }

    // Take the median of each program's rounds.
    results.into_iter().map(|(name, result)| (name, result.map(median))).collect()
}

/// The round of the middle time; the most memory of all.
fn median(mut rounds: Vec<Figures>) -> Figures {
    let peak = rounds.iter().filter_map(|figures| figures.peak).max();
    rounds.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let middle = rounds.len() / 2;
    Figures { peak, ..rounds.swap_remove(middle) }
}

/// Writes the report to `benches/results`; what stands under `## Notes` in a file of the same day
/// stays.
fn write(report: &str) -> Outcome {
    let date = output(command("date").arg("+%F"))?;
    let path = repository().join(format!("benches/results/{}-draw.md", date.trim()));
    let notes = std::fs::read_to_string(&path).ok().and_then(|old| notes(&old)).unwrap_or_default();
    std::fs::write(&path, format!("{report}{notes}"))
        .map_err(|e| format!("{}: {e}", path.display()))
}

/// The part of a results file that was written by hand, with a blank line before it.
fn notes(old: &str) -> Option<String> {
    old.find("\n## Notes").map(|start| old[start..].to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_read() {
        let choices = read(&["--quick", "--vitral", "a/vitral"]).unwrap();
        assert_eq!(
            (choices.rounds, choices.with_peers, choices.vitral),
            (1, true, Some(PathBuf::from("a/vitral")))
        );
        assert!(read(&["--vitral"]).is_err() && read(&["--fast"]).is_err());
    }

    #[test]
    fn notes_stay() {
        assert_eq!(notes("# A\n| 1 |\n\n## Notes\n\nb\n").unwrap(), "\n## Notes\n\nb\n");
        assert_eq!(notes("# A\n"), None);
    }

    #[test]
    fn the_median_keeps_the_largest_peak() {
        let round = |seconds, peak| Figures {
            seconds,
            processor: None,
            draw: None,
            peak: Some(peak),
            bytes: 0,
            lines: None,
            regions: None,
        };
        let middle = median(vec![round(3.0, 1), round(1.0, 9), round(2.0, 4)]);
        assert_eq!((middle.seconds, middle.peak), (2.0, Some(9)));
    }
}
