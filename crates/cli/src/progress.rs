//! How far the work is: a bar on a terminal, lines elsewhere if they are wanted. Both tell per cent
//! and the time that is left.

use crate::render_args::ProgressWhen;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// A short bar, and a message that is cut where a terminal is narrow: it begins with what matters
/// most. 40 columns hold per cent and time.
const TEMPLATE: &str = "{bar:12} {wide_msg}";

/// Tells how many pictures are done.
pub(crate) enum Progress {
    /// Says nothing.
    Silent,
    /// A bar on standard error.
    Bar(ProgressBar, Counted),
    /// A line a picture, for files and pipes.
    Lines(Counted),
}

/// Pictures that are counted.
pub(crate) struct Counted {
    /// What they are, in the plural.
    unit: &'static str,
    /// How many in all.
    total: u64,
    /// How many are done.
    done: u64,
    start: Instant,
}

impl Progress {
    /// Progress over `total` pictures, which `unit` calls by their name. A single one has none
    /// unless it is always wanted.
    pub(crate) fn new(when: ProgressWhen, quiet: bool, total: u64, unit: &'static str) -> Self {
        let terminal = std::io::stderr().is_terminal();
        let counted = Counted { unit, total, done: 0, start: Instant::now() };
        match when {
            ProgressWhen::Never => Self::Silent,
            ProgressWhen::Auto if quiet || !terminal || total < 2 => Self::Silent,
            ProgressWhen::Always if !terminal => Self::Lines(counted),
            ProgressWhen::Auto | ProgressWhen::Always => Self::Bar(bar(total), counted),
        }
    }

    /// What tells how far the long stages of a single frame are.
    pub(crate) fn stages(when: ProgressWhen, quiet: bool) -> Option<Arc<vitral::Progress>> {
        let terminal = std::io::stderr().is_terminal();
        match when {
            ProgressWhen::Never => return None,
            ProgressWhen::Auto if quiet || !terminal => return None,
            ProgressWhen::Auto | ProgressWhen::Always => {}
        }
        let stage = Mutex::new(Stage::default());
        let bar = terminal.then(|| bar(1));
        Some(Arc::new(move |name, done, total| {
            let mut stage = stage.lock().unwrap_or_else(PoisonError::into_inner);
            let news = stage.reach(name, done, total);
            match &bar {
                Some(bar) => {
                    bar.set_length(total);
                    bar.set_message(stage.text_beside_bar(done, total));
                    bar.set_position(done);
                    if done >= total {
                        bar.finish_and_clear();
                    }
                }
                // A line for each tenth.
                None if news => crate::report::line(&stage.text(done, total)),
                None => {}
            }
        }))
    }

    /// So many pictures are done, or will not be.
    pub(crate) fn advance_to(&mut self, count: u64) {
        match self {
            Self::Silent => {}
            Self::Bar(bar, counted) => {
                counted.done = count;
                bar.set_message(counted.text_beside_bar());
                bar.set_position(count);
            }
            Self::Lines(counted) => counted.done = count,
        }
    }

    /// One more picture is done.
    pub(crate) fn step(&mut self) {
        match self {
            Self::Silent => {}
            Self::Bar(_, Counted { done, .. }) => {
                let count = *done + 1;
                self.advance_to(count);
            }
            Self::Lines(counted) => {
                counted.done += 1;
                crate::report::line(&counted.text());
            }
        }
    }

    /// All pictures are done.
    pub(crate) fn finish(&self) {
        if let Self::Bar(bar, _) = self {
            bar.finish_and_clear();
        }
    }
}

/// A bar of this length.
fn bar(length: u64) -> ProgressBar {
    let style = ProgressStyle::with_template(TEMPLATE).expect("the template is fixed and sound");
    ProgressBar::new(length).with_style(style)
}

impl Counted {
    /// `picture 3 of 8, 37 %, 5 s left`.
    fn text(&self) -> String {
        format!("{}, {}", self.position(), self.share())
    }

    /// `37 %, 5 s left, picture 3 of 8`.
    fn text_beside_bar(&self) -> String {
        format!("{}, {}", self.share(), self.position())
    }

    fn position(&self) -> String {
        format!("{} {} of {}", self.unit.trim_end_matches('s'), self.done, self.total)
    }

    fn share(&self) -> String {
        share(self.done, self.total, self.start.elapsed())
    }
}

/// A long stage of a frame.
#[derive(Default)]
struct Stage {
    name: String,
    start: Option<Instant>,
    /// The work that has been reported done.
    done: u64,
    tenth: u64,
}

impl Stage {
    /// The stage `name` has come so far; gives whether it has reached another tenth. What goes back
    /// begins anew.
    fn reach(&mut self, name: &str, done: u64, total: u64) -> bool {
        if self.name != name || done < self.done || self.start.is_none() {
            *self = Self { name: name.to_owned(), start: Some(Instant::now()), done, tenth: 0 };
        }
        self.done = done;
        let tenth = done.saturating_mul(10) / total.max(1);
        std::mem::replace(&mut self.tenth, tenth) < tenth
    }

    /// `ray tracing: 40 %, 12 s left`.
    fn text(&self, done: u64, total: u64) -> String {
        format!("{}: {}", self.name, self.share(done, total))
    }

    /// `40 %, 12 s left, ray tracing`.
    fn text_beside_bar(&self, done: u64, total: u64) -> String {
        format!("{}, {}", self.share(done, total), self.name)
    }

    fn share(&self, done: u64, total: u64) -> String {
        share(done, total, self.start.map_or(Duration::ZERO, |start| start.elapsed()))
    }
}

/// Per cent, and the time that is left if the work goes on as before.
fn share(done: u64, total: u64, elapsed: Duration) -> String {
    let percent = done.saturating_mul(100) / total.max(1);
    if done == 0 || done >= total {
        return format!("{percent} %");
    }
    let left = elapsed.as_secs_f64() * (total - done) as f64 / done as f64;
    format!("{percent} %, {} left", duration(left))
}

/// Seconds in words: `5 s`, `2 min 10 s`, `3 h 5 min`.
fn duration(seconds: f64) -> String {
    let seconds = seconds.ceil() as u64;
    match (seconds / 3600, seconds / 60 % 60, seconds % 60) {
        (0, 0, s) => format!("{s} s"),
        (0, min, s) => format!("{min} min {s} s"),
        (h, min, _) => format!("{h} h {min} min"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_follows_from_what_is_done() {
        let after = |done, seconds| share(done, 8, Duration::from_secs(seconds));
        assert_eq!(after(2, 10), "25 %, 30 s left");
        assert_eq!(after(1, 60), "12 %, 7 min 0 s left");
        assert_eq!(after(1, 3600), "12 %, 7 h 0 min left");
        assert_eq!((after(0, 5), after(8, 5)), ("0 %".to_owned(), "100 %".to_owned()));
    }

    #[test]
    fn per_cent_and_time_come_first_where_the_end_may_be_cut() {
        let start = Some(Instant::now());
        let stage = Stage { name: "radiosity".to_owned(), start, done: 8, tenth: 0 };
        assert_eq!(
            (stage.text(8, 8), stage.text_beside_bar(8, 8)),
            ("radiosity: 100 %".into(), "100 %, radiosity".into())
        );
        let counted = Counted { unit: "pictures", total: 3, done: 0, start: Instant::now() };
        assert_eq!(counted.text_beside_bar(), "0 %, picture 0 of 3");
        // The longest numbers beside the bar of 12 columns and a space.
        assert!("99 %, 59 min 59 s left".len() + 13 <= 40);
    }

    #[test]
    fn a_stage_is_told_at_each_tenth_and_begins_anew() {
        let mut stage = Stage::default();
        let told: Vec<_> = [("a", 1), ("a", 5), ("a", 9), ("a", 10), ("b", 3), ("b", 20)]
            .map(|(name, done)| stage.reach(name, done, 40))
            .into_iter()
            .collect();
        assert_eq!(told, [false, true, true, false, false, true]);
    }
}
