//! The machine's clock, for budgets and for the times in [`Stats`](vitral_render::Stats).

use std::time::Instant;
use vitral_exec::Clock;

/// Seconds since the clock was made.
#[derive(Clone, Copy, Debug)]
pub struct SystemClock {
    start: Instant,
}

impl Default for SystemClock {
    fn default() -> Self {
        Self { start: Instant::now() }
    }
}

impl Clock for SystemClock {
    fn seconds(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_never_goes_back() {
        let clock = SystemClock::default();
        let (first, second) = (clock.seconds(), clock.seconds());
        assert!(0.0 <= first && first <= second);
    }
}
