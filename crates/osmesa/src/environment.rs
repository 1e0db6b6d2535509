//! Environment variables: `VITRAL_THREADS`, `VITRAL_GL_DEBUG` and `VITRAL_GL_COMPAT`.

use std::sync::OnceLock;

/// Threads when nobody chose: more rarely pay.
const MOST_THREADS: usize = 8;

/// How many threads draw: `VITRAL_THREADS`, else as many as the process may use (affinity, cgroup),
/// at most 8.
pub(crate) fn threads() -> usize {
    let chosen = std::env::var("VITRAL_THREADS").ok();
    chosen.and_then(|text| threads_of(&text)).unwrap_or_else(|| {
        std::thread::available_parallelism().map_or(1, usize::from).min(MOST_THREADS)
    })
}

/// A number of threads as typed; nothing else counts.
fn threads_of(text: &str) -> Option<usize> {
    text.trim().parse().ok().filter(|count| (1..=1024).contains(count))
}

/// Whether errors are told on standard error: `VITRAL_GL_DEBUG` is set to something other than 0.
pub(crate) fn debug() -> bool {
    static DEBUG: OnceLock<bool> = OnceLock::new();
    *DEBUG.get_or_init(|| {
        std::env::var_os("VITRAL_GL_DEBUG").is_some_and(|value| !value.is_empty() && value != "0")
    })
}

/// Whether programs that ask for OpenGL 2.0 or 2.1 get 1.5: `VITRAL_GL_COMPAT` is 2.1.
pub(crate) fn gives_1_5_for_2_1() -> bool {
    let Ok(text) = std::env::var("VITRAL_GL_COMPAT") else { return false };
    let asked = text.trim() == "2.1";
    if !asked && !text.trim().is_empty() {
        say(&format!("VITRAL_GL_COMPAT={text} has no meaning: 2.1 is the one value"));
    }
    asked
}

/// A line on standard error, if the user asked for that.
pub(crate) fn tell(text: &str) {
    if debug() {
        say(text);
    }
}

/// A line on standard error. If that cannot be written there is nobody left to tell.
pub(crate) fn say(text: &str) {
    use std::io::Write;
    let _ = writeln!(std::io::stderr().lock(), "vitral: {text}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_sensible_numbers_of_threads_count() {
        assert_eq!(
            [threads_of("1"), threads_of(" 12 "), threads_of("1024")],
            [Some(1), Some(12), Some(1024)]
        );
        for text in ["", "0", "-1", "two", "1025", "1.5"] {
            assert_eq!(threads_of(text), None, "{text}");
        }
    }
}
