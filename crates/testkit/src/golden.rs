//! Golden images: a picture is compared with the one that was once looked at and kept in
//! `tests/golden`.
//!
//! A test calls [`check`] (or [`check_everywhere`], which also demands the same bytes at every SIMD
//! level and thread count). On failure a page with expected, difference and actual is left in
//! `target/golden-failures`. `cargo xtask bless`, or `VITRAL_BLESS=1`, writes the references anew;
//! the review is the diff of the pictures.

use crate::matrix::{self, Setting};
use crate::{fixture, page};
use std::path::PathBuf;
use vitral_frame::{Plane, compare};

/// References are small, so that a repository with many of them stays light: bytes of one PNG file.
const LARGEST_REFERENCE: usize = 64 * 1024;

/// How far a picture may be from its reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Distance of a channel that counts as equal.
    pub per_channel: u8,
    /// Share of pixels, `0..=1`, that may be further apart than that.
    pub pixels: f64,
}

impl Tolerance {
    /// Every byte. All of vitral's own pictures are held to this: only operations that IEEE 754
    /// makes exact are used, so instruction set, thread count, compiler and machine cannot change a
    /// byte, and a change means that an algorithm changed.
    pub const EXACT: Self = Self { per_channel: 0, pixels: 0.0 };

    /// One step of an 8-bit channel, anywhere. For two ways to compute the same value in a
    /// different order (increments along a span against barycentric weights, stages against a fused
    /// path before its equality is proved): each may round the last bit of the byte differently,
    /// none may be further off.
    pub const ROUNDING: Self = Self { per_channel: 1, pixels: 0.0 };

    /// Two steps, and one pixel in two hundred further off. For pictures of another program (Mesa,
    /// mitsuba) kept as references: its snapping of vertices and its lines differ, which shows on
    /// silhouettes, but not on surfaces.
    pub const PEER: Self = Self { per_channel: 2, pixels: 0.005 };
}

/// Compares `actual` with the reference `name` (a path below `tests/golden` without its extension).
///
/// # Panics
/// If they differ by more than `tolerance`, or there is no reference; the message names the page
/// that shows it.
#[track_caller]
pub fn check(name: &str, actual: &Plane<[u8; 4]>, tolerance: Tolerance) {
    if let Err(message) = Golden::of_repository().check(name, actual, tolerance) {
        panic!("{message}");
    }
}

/// Renders at every SIMD level with several thread counts, demands equal bytes, and compares them
/// with the reference.
///
/// # Panics
/// As [`check`] and [`matrix::same_everywhere`].
#[track_caller]
pub fn check_everywhere(
    name: &str,
    tolerance: Tolerance,
    render: impl FnMut(&Setting) -> Plane<[u8; 4]>,
) {
    check(name, &matrix::same_everywhere(render), tolerance);
}

/// Where references are, where pages go, and whether references are being rewritten.
struct Golden {
    references: PathBuf,
    failures: PathBuf,
    bless: bool,
}

impl Golden {
    fn of_repository() -> Self {
        let repository = fixture::repository();
        Self {
            references: repository.join("tests/golden"),
            failures: repository.join("target/golden-failures"),
            bless: std::env::var("VITRAL_BLESS").is_ok_and(|value| value == "1"),
        }
    }

    fn check(
        &self,
        name: &str,
        actual: &Plane<[u8; 4]>,
        tolerance: Tolerance,
    ) -> Result<(), String> {
        let path = self.references.join(format!("{name}.png"));
        if self.bless {
            return self.rewrite(&path, actual);
        }
        if !path.exists() {
            return Err(self.fail(
                name,
                "there is no reference yet; look at the picture, then `cargo xtask bless`",
                None,
                actual,
            ));
        }
        let expected = page::read_png(&path)?;
        let difference = match compare::compare(&expected, actual, tolerance.per_channel) {
            Ok(difference) => difference,
            Err(sizes) => return Err(self.fail(name, &sizes.to_string(), Some(&expected), actual)),
        };
        if difference.share() <= tolerance.pixels {
            return Ok(());
        }
        let allowed = format!(
            "{difference}; allowed: {} a channel, {} of the pixels",
            tolerance.per_channel, tolerance.pixels
        );
        Err(self.fail(name, &allowed, Some(&expected), actual))
    }

    /// Writes the reference unless the same pixels are there already, so that a bless changes only
    /// what changed.
    fn rewrite(&self, path: &std::path::Path, actual: &Plane<[u8; 4]>) -> Result<(), String> {
        if path.exists() && page::read_png(path).is_ok_and(|old| old == *actual) {
            return Ok(());
        }
        let bytes = page::encode_png(actual)?;
        if bytes.len() > LARGEST_REFERENCE {
            let (shown, size) = (path.display(), bytes.len());
            return Err(format!(
                "{shown}: {size} bytes, a reference has at most {LARGEST_REFERENCE}: render it smaller"
            ));
        }
        page::put(path, &bytes)
    }

    fn fail(
        &self,
        name: &str,
        message: &str,
        expected: Option<&Plane<[u8; 4]>>,
        actual: &Plane<[u8; 4]>,
    ) -> String {
        match page::write(&self.failures, name, message, expected, actual) {
            Ok(page) => format!("golden image `{name}`: {message}\nsee {}", page.display()),
            Err(error) => format!("golden image `{name}`: {message}\n(no page: {error})"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A golden folder of this test's own, removed at the end.
    struct Sandbox(PathBuf);

    impl Sandbox {
        fn new(name: &str) -> Self {
            Self(std::env::temp_dir().join(format!("vitral-golden-{name}-{}", std::process::id())))
        }
        fn golden(&self, bless: bool) -> Golden {
            Golden {
                references: self.0.join("references"),
                failures: self.0.join("failures"),
                bless,
            }
        }
    }

    impl Drop for Sandbox {
        fn drop(&mut self) {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }

    fn grey(value: u8) -> Plane<[u8; 4]> {
        Plane::filled(5, 4, [value, value, value, 255])
    }

    #[test]
    fn a_blessed_picture_passes_and_another_does_not() {
        let sandbox = Sandbox::new("bless");
        sandbox.golden(true).check("a/grey", &grey(100), Tolerance::EXACT).unwrap();
        let golden = sandbox.golden(false);
        golden.check("a/grey", &grey(100), Tolerance::EXACT).unwrap();
        golden.check("a/grey", &grey(101), Tolerance::ROUNDING).unwrap();
        let message = golden.check("a/grey", &grey(101), Tolerance::EXACT).unwrap_err();
        assert!(message.contains("20 of 20 pixels"), "{message}");
        for file in
            ["a/grey.html", "a/grey.expected.png", "a/grey.difference.png", "a/grey.actual.png"]
        {
            assert!(golden.failures.join(file).exists(), "{file} is left behind");
        }
        let page = std::fs::read_to_string(golden.failures.join("a/grey.html")).unwrap();
        assert!(
            page.contains("src=\"grey.difference.png\""),
            "pictures are named relative to the page: {page}"
        );
    }

    #[test]
    fn a_missing_reference_fails_and_shows_the_picture() {
        let sandbox = Sandbox::new("missing");
        let golden = sandbox.golden(false);
        let message = golden.check("new", &grey(7), Tolerance::EXACT).unwrap_err();
        assert!(message.contains("no reference yet"), "{message}");
        assert_eq!(page::read_png(&golden.failures.join("new.actual.png")).unwrap(), grey(7));
        assert!(!golden.references.exists(), "nothing becomes a reference by itself");
    }

    #[test]
    fn sizes_and_large_files_are_refused() {
        let sandbox = Sandbox::new("sizes");
        sandbox.golden(true).check("x", &grey(1), Tolerance::EXACT).unwrap();
        let message = sandbox
            .golden(false)
            .check("x", &Plane::filled(2, 2, [0; 4]), Tolerance::PEER)
            .unwrap_err();
        assert!(message.contains("5x4 pixels, the second 2x2"), "{message}");
        let mut state = 1u32;
        let noise = Plane::filled(200, 200, 0).map(|_: &u8| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            state.to_be_bytes()
        });
        let message = sandbox.golden(true).check("noise", &noise, Tolerance::EXACT).unwrap_err();
        assert!(message.contains("render it smaller"), "{message}");
    }
}
