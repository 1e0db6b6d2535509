//! Floor 0: who works, and how much work is allowed. [`Workers`] run loops over threads, a
//! [`Budget`] may stop them.
//!
//! Results never depend on the number of threads: work is cut by size, never by thread, and each
//! piece writes its own output.
#![forbid(unsafe_code)]

mod budget;
mod charge;
#[cfg(all(feature = "threads", target_os = "linux", not(miri)))]
mod placement;
mod spare;
mod started;
mod surround;
mod workers;

pub use budget::{Achieved, Budget, Clock, Limit, MAX_STEPS, NoClock, Progress};
pub use charge::Charge;
pub use spare::Spare;
pub use started::{Started, born_of_fork, forked, hold_for_fork};
pub use surround::surround_thread_starts;
pub use workers::Workers;
