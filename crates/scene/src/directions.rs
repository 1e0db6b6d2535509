//! Directions in single precision: length, and angles by their cosines.

/// The normal of a vertex without any face that has one.
pub(crate) const DEFAULT_NORMAL: [f32; 3] = [0.0, 0.0, 1.0];
/// Sums shorter than this (they are weighted by radians) have cancelled out.
pub(crate) const CANCELLED: f32 = 1e-5;

/// `v` with length 1, unless it has cancelled out.
#[inline]
pub(crate) fn unit(v: [f32; 3]) -> Option<[f32; 3]> {
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    (length > CANCELLED).then(|| v.map(|c| c / length))
}

/// Whether a face's normal is within an angle of another direction; a face without area always is.
#[inline]
pub(crate) fn is_near(direction: [f32; 3], normal: [f32; 3], cosine: f32) -> bool {
    dot(direction, normal) >= cosine || normal == [0.0; 3]
}

/// The dot product.
#[inline]
pub(crate) fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
