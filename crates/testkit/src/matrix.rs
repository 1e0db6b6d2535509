//! The same picture at every SIMD level and with any number of threads.

use vitral_exec::Workers;
use vitral_math::lanes::{Level, available_levels};

/// Thread counts that tests try: alone, an even split, and more than most test machines have.
pub const THREADS: [usize; 3] = [1, 2, 5];

/// One way to run: an instruction set and a number of workers.
#[derive(Clone, Debug)]
pub struct Setting {
    /// The level's name, as in `VITRAL_SIMD`.
    pub level_name: &'static str,
    /// The instruction set.
    pub level: Level,
    /// The workers.
    pub workers: Workers,
}

impl std::fmt::Display for Setting {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} with {} thread(s)", self.level_name, self.workers.threads())
    }
}

/// Every level of this machine with every count of [`THREADS`]; the slowest level with one thread
/// comes first. Plain scalar code is among the levels where vitral is built with the feature
/// `scalar`.
pub fn settings() -> Vec<Setting> {
    let mut settings = Vec::new();
    for (level_name, level) in available_levels() {
        settings.extend(THREADS.map(|threads| Setting {
            level_name,
            level,
            workers: Workers::new(threads),
        }));
    }
    settings
}

/// Calls `make` once for each setting and demands the same result every time; gives that result.
///
/// # Panics
/// If two settings disagree; the message names them.
#[track_caller]
pub fn same_everywhere<T: PartialEq>(mut make: impl FnMut(&Setting) -> T) -> T {
    let settings = settings();
    let (reference, others) = settings.split_first().expect("a machine has at least one level");
    let expected = make(reference);
    for setting in others {
        assert!(make(setting) == expected, "{setting} gives another result than {reference}");
    }
    expected
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reference_comes_first_and_all_threads_are_tried() {
        let settings = settings();
        assert_eq!(
            (settings[0].level_name, settings[0].workers.threads()),
            (available_levels()[0].0, 1)
        );
        assert_eq!(settings.len() % THREADS.len(), 0);
        assert_eq!(same_everywhere(|setting| setting.workers.map(3, |i| i * 2)), [0, 2, 4]);
    }

    #[test]
    #[should_panic(expected = "with 1 thread(s)")]
    fn a_disagreement_is_named() {
        same_everywhere(|setting| setting.workers.threads());
    }
}
