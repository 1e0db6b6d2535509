//! The 16 parts of an element: its triangle, cut in four at the middles of its edges, and each
//! quarter cut again.

use vitral_math::DVec3;

/// Parts of an element.
pub(super) const PARTS: usize = 16;
/// All of them are there.
pub(super) const WHOLE: u16 = u16::MAX;

/// A triangle's parts between the middles of its edges, all turned as it is.
pub(super) fn quarters([a, b, c]: [DVec3; 3]) -> [[DVec3; 3]; 4] {
    let [ab, bc, ca] = [a.midpoint(b), b.midpoint(c), c.midpoint(a)];
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [bc, ca, ab]]
}

/// The parts of a triangle; four neighbours that make a quarter of it come one after another.
pub(super) fn parts(corners: [DVec3; 3]) -> [[DVec3; 3]; PARTS] {
    let quarters = quarters(corners).map(quarters);
    std::array::from_fn(|i| quarters[i / 4][i % 4])
}

/// The middle of a triangle.
pub(super) fn middle([a, b, c]: [DVec3; 3]) -> DVec3 {
    (a + b + c) / 3.0
}
