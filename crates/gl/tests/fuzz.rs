//! Random calls: no panic, no call that runs on and on. The same streams every time.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::time::{Duration, Instant};
use vitral_testkit::fuzz_gl::run;

/// Bytes of a stream, about a thousand calls.
const STREAM: usize = 12_000;

fn stream(seed: u64) -> Vec<u8> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 32) as u8
    };
    (0..STREAM).map(|_| next()).collect()
}

/// Runs a stream; what goes wrong is said with the calls before it.
fn replay(seed: u64) {
    let (mut names, mut slowest, mut last) = (Vec::new(), (Duration::ZERO, ""), Instant::now());
    let bytes = stream(seed);
    let ended = catch_unwind(AssertUnwindSafe(|| {
        run(&bytes, |name| {
            let spent = last.elapsed();
            if spent > slowest.0 {
                slowest = (spent, names.last().copied().unwrap_or(""));
            }
            last = Instant::now();
            names.push(name);
        });
    }));
    if let Err(panic) = ended {
        let tail = &names[names.len().saturating_sub(12)..];
        eprintln!("stream {seed}, after {} calls, the last of them {tail:?}", names.len());
        resume_unwind(panic);
    }
    assert!(
        slowest.0 < Duration::from_secs(20),
        "stream {seed}: {} took {:?}",
        slowest.1,
        slowest.0
    );
}

#[test]
fn random_calls_are_survived() {
    (0..6).for_each(replay);
}

/// More of them by
/// `GL_FUZZ=1000..2000 cargo test -p vitral-gl --test gl_suite fuzz:: -- --nocapture`; two without
/// it.
#[test]
fn chosen_random_calls_are_survived() {
    let range = std::env::var("GL_FUZZ").unwrap_or_else(|_| "6..8".to_owned());
    let (first, end) = range.split_once("..").expect("a range");
    let [first, end]: [u64; 2] = [first, end].map(|n| n.parse().expect("a number"));
    let failed: Vec<u64> =
        (first..end).filter(|&seed| catch_unwind(|| replay(seed)).is_err()).collect();
    assert!(failed.is_empty(), "{failed:?}");
}
