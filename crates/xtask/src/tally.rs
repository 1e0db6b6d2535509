//! Adds up what test programs print.
//!
//! Input: the lines of `cargo test -- --show-output`, errors and output in one stream, so that
//! cargo's headings stand before the lines of their programs. A passing test that printed a line
//! starting with `skip` (`skipped: ../shared/models/x.obj is not there`) has tested nothing and
//! counts as skipped, as an ignored one does.

use std::time::Duration;

/// How many tests passed, failed and were skipped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Tally {
    pub(crate) passed: u64,
    pub(crate) failed: u64,
    pub(crate) skipped: u64,
}

impl std::fmt::Display for Tally {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} passed, {} failed, {} skipped", self.passed, self.failed, self.skipped)
    }
}

/// A test program, or the documentation tests of a crate, and how long it ran.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Program {
    pub(crate) name: String,
    pub(crate) wall: Duration,
}

/// Reads the output line by line.
#[derive(Debug, Default)]
pub(crate) struct Reader {
    tally: Tally,
    /// The passing test whose output is being read, and whether a skip line was seen in it.
    current: Option<(String, bool)>,
    /// Inside the part that shows what passing tests printed.
    successes: bool,
    /// Skips seen in the test program that is being read.
    skips: u64,
    /// What was skipped and why, in order.
    pub(crate) reasons: Vec<String>,
    /// The program that runs, and when it started.
    running: Option<(String, Duration)>,
    /// The programs that ended, in order.
    pub(crate) programs: Vec<Program>,
}

impl Reader {
    /// Takes one line, which was read at the time `now`; says whether a person should see it (the
    /// chatter of passing tests is not shown).
    pub(crate) fn line(&mut self, line: &str, now: Duration) -> bool {
        if let Some(program) = heading(line) {
            self.end_program(now);
            self.running = Some((program, now));
            return true;
        }
        if let Some(result) = line.strip_prefix("test result: ") {
            self.close(result);
            return true;
        }
        match line {
            "successes:" => self.successes = true,
            "failures:" => self.successes = false,
            _ => {}
        }
        if !self.successes {
            return true;
        }
        if let Some(name) =
            line.strip_prefix("---- ").and_then(|rest| rest.strip_suffix(" stdout ----"))
        {
            self.current = Some((name.to_owned(), false));
        } else if line.trim_start().get(..4).is_some_and(|start| start.eq_ignore_ascii_case("skip"))
        {
            self.skip(line.trim());
        }
        false
    }

    /// Ends the program that runs, if there is one.
    pub(crate) fn end_program(&mut self, now: Duration) {
        if let Some((name, start)) = self.running.take() {
            self.programs.push(Program { name, wall: now.saturating_sub(start) });
        }
    }

    /// The sum so far.
    pub(crate) fn tally(&self) -> Tally {
        self.tally
    }

    /// Counts the current test as skipped, once.
    fn skip(&mut self, why: &str) {
        if let Some((name, seen)) = &mut self.current {
            if !*seen {
                self.skips += 1;
                self.reasons.push(format!("{name}: {why}"));
            }
            *seen = true;
        }
    }

    /// Adds the summary of one test program: `ok. 5 passed; 0 failed; 1 ignored; ...`.
    fn close(&mut self, result: &str) {
        let count = |what: &str| {
            let before = result.split(what).next().filter(|before| before.len() < result.len());
            before
                .and_then(|before| before.split_whitespace().last())
                .and_then(|n| n.parse().ok())
                .unwrap_or(0u64)
        };
        let skips = std::mem::take(&mut self.skips);
        self.tally.passed += count(" passed").saturating_sub(skips);
        self.tally.failed += count(" failed");
        self.tally.skipped += count(" ignored") + skips;
        (self.current, self.successes) = (None, false);
    }
}

/// The program that cargo announces:
/// `Running unittests src/lib.rs (target/debug/deps/vitral_gl-0123456789abcdef)`,
/// `Running tests/suite.rs (target/debug/deps/gl_suite-0123456789abcdef)` or `Doc-tests vitral_gl`.
fn heading(line: &str) -> Option<String> {
    let line = line.trim_start();
    if let Some(crate_name) = line.strip_prefix("Doc-tests ") {
        return Some(format!("{crate_name}, documentation"));
    }
    let (source, path) = line.strip_prefix("Running ")?.strip_suffix(')')?.split_once(".rs (")?;
    let file = path.rsplit(['/', '\\']).next()?;
    let (name, _hash) = file.rsplit_once('-')?;
    Some(if source.starts_with("unittests") {
        format!("{name}, unit tests")
    } else {
        name.to_owned()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> (Reader, Vec<&str>) {
        let mut reader = Reader::default();
        let shown = text.lines().filter(|line| reader.line(line, Duration::ZERO)).collect();
        (reader, shown)
    }

    #[test]
    fn programs_add_up() {
        let (reader, _) = read(
            "test result: ok. 5 passed; 0 failed; 1 ignored; 0 measured; 0 filtered out; finished in 0.01s\n\
             test result: FAILED. 2 passed; 3 failed; 0 ignored; 0 measured; 7 filtered out; finished in 0.01s\n",
        );
        assert_eq!(reader.tally(), Tally { passed: 7, failed: 3, skipped: 1 });
        assert_eq!(reader.tally().to_string(), "7 passed, 3 failed, 1 skipped");
    }

    #[test]
    fn a_test_that_printed_skip_counts_once_and_chatter_is_hidden() {
        let (reader, shown) = read(
            "running 2 tests\ntest a ... ok\ntest b ... ok\n\nsuccesses:\n\n---- a stdout ----\nskipped: no models\n\
             Skipping the rest\n\n---- b stdout ----\nhello, we skip nothing\n\n\nsuccesses:\n    a\n    b\n\n\
             test result: ok. 2 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.00s\n",
        );
        assert_eq!(reader.tally(), Tally { passed: 1, failed: 0, skipped: 1 });
        assert_eq!(reader.reasons, ["a: skipped: no models"]);
        assert!(!shown.iter().any(|line| line.contains("hello")), "{shown:?}");
        assert!(shown.contains(&"test b ... ok"));
    }

    #[test]
    fn failures_are_shown_and_are_not_skips() {
        let (reader, shown) = read(
            "successes:\n\n---- a stdout ----\nx\n\nfailures:\n\n---- b stdout ----\nskipped: half, then wrong\n\n\
             test result: FAILED. 1 passed; 1 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.00s\n",
        );
        assert_eq!(reader.tally(), Tally { passed: 1, failed: 1, skipped: 0 });
        assert!(shown.contains(&"skipped: half, then wrong"));
    }

    #[test]
    fn each_program_has_its_time() {
        let mut reader = Reader::default();
        let lines = [
            (1, "     Running unittests src/lib.rs (target/debug/deps/vitral_gl-0123456789abcdef)"),
            (
                2,
                "test result: ok. 5 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.01s",
            ),
            (4, "     Running tests/suite.rs (target/debug/deps/gl_suite-0123456789abcdef)"),
            (9, "   Doc-tests vitral_gl"),
            (10, "Running out of names (in a message)"),
        ];
        lines.iter().for_each(|(now, line)| {
            reader.line(line, Duration::from_secs(*now));
        });
        reader.end_program(Duration::from_secs(12));
        let found: Vec<_> = reader
            .programs
            .iter()
            .map(|program| (program.name.as_str(), program.wall.as_secs()))
            .collect();
        assert_eq!(
            found,
            [("vitral_gl, unit tests", 3), ("gl_suite", 5), ("vitral_gl, documentation", 3)]
        );
    }
}
