//! Whether colours are written as 0 to 1 or as bytes.
//!
//! Formats leave it open. Colours above 1 are bytes where they look like them: all of them whole
//! numbers and the largest at least 2, or the largest so far above 1 that no light is meant.
//! Otherwise a value slipped over the end by rounding, and is clamped.

/// The least largest value of bytes that are not whole numbers, as averages of bytes are.
const LEAST_LARGEST: f32 = 64.0;

/// Properties of the values of all colours in a file: the largest, and whether all are whole
/// numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ColorRange {
    pub(crate) largest: f32,
    pub(crate) is_whole: bool,
}

impl Default for ColorRange {
    fn default() -> Self {
        Self { largest: 0.0, is_whole: true }
    }
}

impl ColorRange {
    /// The range of `values`; those that are not finite do not count.
    pub(crate) fn of(values: impl Iterator<Item = f32>) -> Self {
        values.filter(|c| c.is_finite()).fold(Self::default(), |range, c| Self {
            largest: range.largest.max(c),
            is_whole: range.is_whole && c.fract() == 0.0,
        })
    }

    /// The range of two lists of colours.
    pub(crate) fn union(self, other: Self) -> Self {
        Self { largest: self.largest.max(other.largest), is_whole: self.is_whole && other.is_whole }
    }

    /// What stands for a full channel: 1 or 255.
    pub(crate) fn scale(self) -> f32 {
        let bytes = self.is_whole && self.largest >= 2.0 || self.largest >= LEAST_LARGEST;
        if bytes { 255.0 } else { 1.0 }
    }

    /// The warning about colours above 1, if there are any, which are called `what`.
    pub(crate) fn oddity(self, what: &str) -> Option<String> {
        let fate = if self.scale() > 1.0 { "are read as 0 to 255" } else { "are clamped" };
        (self.largest > 1.0).then(|| format!("{what} exceed 1 and {fate}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_whole_numbers_or_large() {
        let scale = |values: &[f32]| ColorRange::of(values.iter().copied()).scale();
        for bytes in [&[0.0, 255.0][..], &[2.0, 1.0], &[127.5, 3.25], &[f32::NAN, 255.0]] {
            assert_eq!(scale(bytes), 255.0, "{bytes:?}");
        }
        for unit in [&[0.0, 1.0][..], &[1.000_001, 0.0], &[1.5, 0.5], &[12.0, 0.5], &[]] {
            assert_eq!(scale(unit), 1.0, "{unit:?}");
        }
        let range = ColorRange::of([1.25].into_iter()).union(ColorRange::of([0.0].into_iter()));
        assert_eq!(range.oddity("colours").unwrap(), "colours exceed 1 and are clamped");
        assert_eq!(ColorRange::of([1.0].into_iter()).oddity("colours"), None);
    }
}
