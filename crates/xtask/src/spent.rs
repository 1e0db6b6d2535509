//! The cost of a step: time on the clock, and processor time where the system reports it.

use std::time::{Duration, Instant};

/// Processor time in `/proc` is in ticks; every Linux reports 100 a second.
const TICKS_PER_SECOND: u64 = 100;

/// Measures from its creation on.
pub(crate) struct Stopwatch {
    start: Instant,
    cpu_at_start: Option<Duration>,
}

impl Stopwatch {
    pub(crate) fn start() -> Self {
        Self { start: Instant::now(), cpu_at_start: cpu_time() }
    }

    /// The cost so far.
    pub(crate) fn spent(&self) -> Spent {
        let cpu = cpu_time().zip(self.cpu_at_start).map(|(end, start)| end.saturating_sub(start));
        Spent { wall: self.start.elapsed(), cpu }
    }
}

/// Time on the clock, and processor time of this process and of the children that ended.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spent {
    pub(crate) wall: Duration,
    pub(crate) cpu: Option<Duration>,
}

impl std::fmt::Display for Spent {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:7.1} s", self.wall.as_secs_f64())?;
        self.cpu.map_or(Ok(()), |cpu| write!(f, "  {:7.1} s of processor time", cpu.as_secs_f64()))
    }
}

/// Processor time of this process and of its children, as far as they were waited for.
fn cpu_time() -> Option<Duration> {
    parse_stat(&std::fs::read_to_string("/proc/self/stat").ok()?)
}

/// Adds `utime`, `stime`, `cutime` and `cstime` of proc_pid_stat(5), the 14th field to the 17th.
fn parse_stat(stat: &str) -> Option<Duration> {
    // The second field is the program's name in brackets, which may hold blanks and brackets.
    let fields = stat.rsplit_once(')')?.1;
    let ticks: Vec<u64> =
        fields.split_whitespace().skip(11).take(4).map_while(|field| field.parse().ok()).collect();
    let sum = (ticks.len() == 4).then(|| ticks.iter().sum::<u64>())?;
    Some(Duration::from_millis(sum * 1000 / TICKS_PER_SECOND))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn processor_time_is_read_behind_a_name_with_brackets() {
        let stat = "7 (a) b) S 1 7 7 0 -1 4194560 9 9 0 0 150 25 1000 3 20 0 1 0 8 9 9";
        assert_eq!(parse_stat(stat), Some(Duration::from_millis(11_780)));
        assert_eq!(parse_stat("7 (a) S 1 2"), None);
    }
}
