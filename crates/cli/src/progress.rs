//! How far a turntable is: a bar on a terminal, lines elsewhere if they are wanted.

use crate::render_args::ProgressWhen;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Tells how many frames are done.
pub(crate) enum Progress {
    /// Says nothing.
    Silent,
    /// A bar on standard error.
    Bar(ProgressBar),
    /// A line a frame, for files and pipes.
    Lines {
        /// Frames in all.
        total: u64,
        /// Frames done.
        done: u64,
    },
}

impl Progress {
    /// Progress over `total` frames. A single frame has none unless it is always wanted.
    pub(crate) fn new(when: ProgressWhen, quiet: bool, total: u64) -> Self {
        let terminal = std::io::stderr().is_terminal();
        match when {
            ProgressWhen::Never => Self::Silent,
            ProgressWhen::Auto if quiet || !terminal || total < 2 => Self::Silent,
            ProgressWhen::Always if !terminal => Self::Lines { total, done: 0 },
            ProgressWhen::Auto | ProgressWhen::Always => {
                let style = ProgressStyle::with_template("{bar:40} {pos}/{len} frames, {per_sec}, {eta} left");
                Self::Bar(ProgressBar::new(total).with_style(style.expect("the template is fixed and sound")))
            }
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
        if !terminal {
            // A line for each tenth.
            let last = AtomicU64::new(0);
            return Some(Arc::new(move |stage, done, total| {
                let tenth = done * 10 / total.max(1);
                if last.swap(tenth, Ordering::Relaxed) != tenth {
                    crate::report::line(&format!("{stage}: {} %", tenth * 10));
                }
            }));
        }
        let style = ProgressStyle::with_template("{bar:40} {msg}").expect("the template is fixed and sound");
        let bar = ProgressBar::new(1).with_style(style);
        Some(Arc::new(move |stage, done, total| {
            bar.set_length(total);
            bar.set_message(stage.to_owned());
            bar.set_position(done);
            if done >= total {
                bar.finish_and_clear();
            }
        }))
    }

    /// One more frame is done.
    pub(crate) fn step(&mut self) {
        match self {
            Self::Silent => {}
            Self::Bar(bar) => bar.inc(1),
            Self::Lines { total, done } => {
                *done += 1;
                crate::report::line(&format!("frame {done} of {total}"));
            }
        }
    }

    /// All frames are done.
    pub(crate) fn finish(&self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}
