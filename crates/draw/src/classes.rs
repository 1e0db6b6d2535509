//! What an edge is, before any question of visibility.
//!
//! An edge may be several things at once: the outline of a box is a contour and a crease. It is drawn as a section if it is one, or else
//! as the first of the classes in the order of [`LineClass::ALL`] that the user wants.
//!
//! | class | an edge |
//! |---|---|
//! | contour | of two or more faces that all lie on one side of it on the page; faces seen edge-on lie on no side |
//! | boundary | of one face |
//! | crease | of two faces at an angle above the crease angle, or of more than two |
//! | material | of faces with different materials |
//! | section | along which a plane of section has cut a face |
//! | smooth | of any face |
//!
//! Diagonals of faces that are not flat are contours where the face turns away between their corners, and nothing else.
//!
//! Source: the classes are those of [Bénard & Hertzmann 2019], section 2.

use crate::page_mesh::{Source, Triangle};
use std::ops::BitOr;
use vitral_frame::drawing::LineClass;

/// A set of line classes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Classes(u8);

impl Classes {
    /// No class.
    pub const EMPTY: Self = Self(0);
    /// What drawings show if nothing else is said.
    pub const USUAL: Self = Self(
        1 << LineClass::Contour as u8
            | 1 << LineClass::Boundary as u8
            | 1 << LineClass::Crease as u8
            | 1 << LineClass::Material as u8
            | 1 << LineClass::Intersection as u8
            | 1 << LineClass::Section as u8,
    );
    /// Every edge of a face.
    pub const ALL: Self = Self(0x7f);

    /// The set of one class.
    pub fn one(class: LineClass) -> Self {
        Self(1 << class as u8)
    }

    /// Whether a class is in the set.
    pub fn has(self, class: LineClass) -> bool {
        self.0 >> class as u8 & 1 == 1
    }

    /// Whether no class is in the set.
    pub fn is_empty(self) -> bool {
        self == Self::EMPTY
    }

    /// What is in both.
    #[must_use]
    pub fn common(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    /// The most important class in the set: sections are drawn as such, whatever else they are.
    pub fn first(self) -> Option<LineClass> {
        if self.has(LineClass::Section) {
            return Some(LineClass::Section);
        }
        LineClass::ALL.iter().map(|row| row.0).find(|&class| self.has(class))
    }
}

impl BitOr for Classes {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl FromIterator<LineClass> for Classes {
    fn from_iter<I: IntoIterator<Item = LineClass>>(classes: I) -> Self {
        classes.into_iter().fold(Self::EMPTY, |set, class| set | Self::one(class))
    }
}

/// A face at an edge.
#[derive(Clone, Copy)]
pub(crate) struct Side<'a> {
    /// The triangle.
    pub(crate) triangle: &'a Triangle,
    /// What it was cut from.
    pub(crate) source: &'a Source,
    /// Whether the face, as in the file, runs from the edge's second end to its first.
    pub(crate) reversed: bool,
}

/// The classes of an edge that is part of the outlines of these faces. `threshold` is the cosine of the crease angle.
pub(crate) fn classes_of(sides: &[Side<'_>], threshold: f32) -> Classes {
    let mut classes = Classes::one(LineClass::Smooth);
    if let [_] = sides {
        return classes | Classes::one(LineClass::Boundary);
    }

    // A face is to the left of the edge where it is seen from its front and runs along the edge, or neither.
    let signs = sides.iter().map(|s| if s.reversed { -s.triangle.facing } else { s.triangle.facing });
    let (left, right) = (signs.clone().any(|s| s > 0), signs.clone().any(|s| s < 0));
    if left != right {
        classes = classes | Classes::one(LineClass::Contour);
    }
    if sides.len() > 2 || cosine(&sides[0], &sides[1]) < threshold {
        classes = classes | Classes::one(LineClass::Crease);
    }
    if sides.iter().any(|s| s.source.material != sides[0].source.material) {
        classes = classes | Classes::one(LineClass::Material);
    }
    classes
}

/// The cosine of the angle between the normals of two faces, one of them turned where they run along the edge in the same direction.
fn cosine(a: &Side<'_>, b: &Side<'_>) -> f32 {
    let (n, m) = (a.source.normal, b.source.normal);
    let dot = n[0] * m[0] + n[1] * m[1] + n[2] * m[2];
    if a.reversed == b.reversed { -dot } else { dot }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UP: [f32; 3] = [0.0, 0.0, 1.0];
    const ASIDE: [f32; 3] = [1.0, 0.0, 0.0];

    fn of(sides: &[(i8, [f32; 3], u32, bool)]) -> Vec<LineClass> {
        let parts: Vec<(Triangle, Source)> = sides
            .iter()
            .map(|&(facing, normal, material, _)| {
                let triangle = Triangle { facing, ..Triangle::new([[0; 3]; 3], [0, 1, 2]) };
                (triangle, Source { surface: 0, material, normal })
            })
            .collect();
        let sides: Vec<Side<'_>> = parts
            .iter()
            .zip(sides)
            .map(|((triangle, source), side)| Side { triangle, source, reversed: side.3 })
            .collect();
        let found = classes_of(&sides, 0.8);
        LineClass::ALL.iter().map(|row| row.0).filter(|&class| found.has(class)).collect()
    }

    #[test]
    fn edges_are_what_the_table_says() {
        use LineClass::{Boundary, Contour, Crease, Material, Smooth};
        assert_eq!(of(&[(1, UP, 0, false)]), [Boundary, Smooth]);
        assert_eq!(of(&[(1, UP, 0, false), (1, UP, 0, true)]), [Smooth]);
        assert_eq!(of(&[(1, UP, 0, false), (1, UP, 7, true)]), [Material, Smooth]);
        assert_eq!(of(&[(1, UP, 0, false), (1, ASIDE, 0, true)]), [Crease, Smooth]);
        assert_eq!(of(&[(1, UP, 0, false), (-1, ASIDE, 0, true)]), [Contour, Crease, Smooth]);
        // A side of a box that is seen edge-on.
        assert_eq!(of(&[(1, UP, 0, false), (0, ASIDE, 0, true)]), [Contour, Crease, Smooth]);
        assert_eq!(of(&[(0, UP, 0, false), (0, UP, 0, true)]), [Smooth]);
        // A neighbour of the other winding lies on the other side all the same.
        assert_eq!(of(&[(1, UP, 0, false), (-1, [0.0, 0.0, -1.0], 0, false)]), [Smooth]);
        assert_eq!(of(&[(1, UP, 0, false), (1, UP, 0, true), (1, UP, 0, true)]), [Crease, Smooth]);
    }

    #[test]
    fn sets_have_an_order() {
        assert_eq!(Classes::ALL.first(), Some(LineClass::Section));
        let uncut: Classes = [LineClass::Smooth, LineClass::Contour].into_iter().collect();
        assert_eq!(uncut.first(), Some(LineClass::Contour));
        assert_eq!((Classes::EMPTY.first(), Classes::USUAL.has(LineClass::Smooth)), (None, false));
        let two: Classes = [LineClass::Smooth, LineClass::Material].into_iter().collect();
        assert_eq!(two.common(Classes::USUAL), Classes::one(LineClass::Material));
    }
}
