//! What light goes between: elements, which receive it, and patches, which send it.
//!
//! Both have two sides, each with a number of its own: `2 e` is the front of `e`, from which its
//! corners run counter-clockwise, `2 e + 1` its back.

use vitral_math::DVec3;

/// Red, green, blue.
pub type Color = [f64; 3];

/// The form factors from one side of an element to sides of others.
pub type FormFactors = Vec<(u32, f64)>;

/// A small triangle.
#[derive(Clone, Copy, Debug)]
pub struct Element {
    /// Its node in the trees.
    pub node: u32,
    /// The patch that sends what the element reflects.
    pub patch: u32,
    /// Middle, world space less the scene's.
    pub center: DVec3,
    /// Unit normal of the front.
    pub normal: DVec3,
    /// Of the parts that are there, in squares of the world's unit.
    pub area: f64,
    /// A bit for each of 16 parts: those that are not cut out.
    pub there: u16,
    /// Reflected part of diffuse light.
    pub reflectance: Color,
}

/// A triangle that sends light, or a group of small ones.
#[derive(Clone, Copy, Debug)]
pub struct Patch {
    /// Middle; of a group the middle of the element that is nearest to the group's.
    pub center: DVec3,
    /// Unit normal of the front there.
    pub normal: DVec3,
    /// It is a group; the corners are those of one of them.
    pub is_group: bool,
    /// Corners, counter-clockwise seen from the front.
    pub corners: [DVec3; 3],
}

/// 1 for the front of an element or a patch, -1 for its back, by the number of the side.
pub(super) fn turned(side: usize) -> f64 {
    1.0 - 2.0 * (side & 1) as f64
}
