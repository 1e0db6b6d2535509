//! The law of agreement: which of two facets is seen at a sample. All algorithms ask this function,
//! so their pictures are equal.
//!
//! In:   depth, 1 near, and facet of each.
//! Source: the law stands in ARCHITECTURE.md.

/// Whether depth `a` of facet `fa` hides depth `b` of facet `fb` at one sample: the greater depth
/// does, of equal ones the lower facet's.
#[inline]
pub(crate) fn nearer((a, fa): (f32, u32), (b, fb): (f32, u32)) -> bool {
    a > b || (a == b && fa < fb)
}
