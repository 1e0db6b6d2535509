//! What an edge is, before any question of visibility.
//!
//! An edge may be several things at once: the outline of a box is a contour and a crease. It is
//! drawn as a section if it is one, or else as the first of the classes in the order of
//! [`LineClass::ALL`] that the user wants.
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
//! Where the normals of its two faces agree within a degree, an edge is a tangent edge: the joint
//! of a plane and a fillet, a line on a flat wall. If these are not wanted, it is a contour or
//! nothing.
//!
//! Diagonals of faces that are not flat are contours where the face turns away between their
//! corners, and nothing else.
//!
//! Source: the classes are those of [Bénard & Hertzmann 2019], section 2.

use crate::page_mesh::{Source, Triangle};
use vitral_frame::drawing::LineClass;

pub use vitral_frame::LineClasses as Classes;

/// A face at an edge.
#[derive(Clone, Copy)]
pub(crate) struct Side<'a> {
    /// The triangle beside the edge.
    pub(crate) triangle: &'a Triangle,
    /// What it was cut from.
    pub(crate) source: &'a Source,
    /// Whether the face, as in the file, runs from the edge's second end to its first.
    pub(crate) reversed: bool,
}

/// Cosines of the angles between faces that decide about classes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Thresholds {
    /// Of the crease angle: edges at larger angles are creases.
    pub(crate) crease: f32,
    /// Of the angle below which edges are tangent ones, if these are left out.
    pub(crate) tangent: Option<f32>,
}

/// The classes of an edge that is part of the outlines of these faces.
pub(crate) fn classes_of(sides: &[Side<'_>], thresholds: Thresholds) -> Classes {
    let mut classes = Classes::one(LineClass::Smooth);
    if let [_] = sides {
        return classes | Classes::one(LineClass::Boundary);
    }

    // A face is to the left of the edge where it is seen from its front and runs along the edge, or
    // neither.
    let signs =
        sides.iter().map(|s| if s.reversed { -s.triangle.facing } else { s.triangle.facing });
    let (left, right) = (signs.clone().any(|s| s > 0), signs.clone().any(|s| s < 0));
    if left != right {
        classes = classes | Classes::one(LineClass::Contour);
    }

    // Compare the angle with the crease's, and the materials.
    let flat = cosine(&sides[0], &sides[1]);
    if sides.len() > 2 || flat < thresholds.crease {
        classes = classes | Classes::one(LineClass::Crease);
    }
    if sides.iter().any(|s| s.source.material != sides[0].source.material) {
        classes = classes | Classes::one(LineClass::Material);
    }

    // Leave tangent edges out unless they are contours.
    let is_left_out = sides.len() == 2 && thresholds.tangent.is_some_and(|tangent| flat > tangent);
    if is_left_out { classes.common(Classes::one(LineClass::Contour)) } else { classes }
}

/// The cosine of the angle between the normals of two faces, one of them turned where they run
/// along the edge in the same direction.
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
        with(None, sides)
    }

    fn with(tangent: Option<f32>, sides: &[(i8, [f32; 3], u32, bool)]) -> Vec<LineClass> {
        let parts: Vec<(Triangle, Source)> = sides
            .iter()
            .map(|&(facing, normal, material, _)| {
                let triangle = Triangle { facing, ..Triangle::new([[0; 3]; 3], [0, 1, 2]) };
                (triangle, Source { facet: 0, surface: 0, material, normal })
            })
            .collect();
        let sides: Vec<Side<'_>> = parts
            .iter()
            .zip(sides)
            .map(|((triangle, source), side)| Side { triangle, source, reversed: side.3 })
            .collect();
        let found = classes_of(&sides, Thresholds { crease: 0.8, tangent });
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
    fn tangent_edges_are_contours_or_nothing() {
        let hidden = |sides: &[(i8, [f32; 3], u32, bool)]| with(Some(0.99), sides);
        let [near, far] = [[0.1, 0.0, 0.995], [0.2, 0.0, 0.98]];
        assert_eq!(hidden(&[(1, UP, 0, false), (1, near, 7, true)]), []);
        assert_eq!(
            hidden(&[(1, UP, 0, false), (1, far, 7, true)]),
            [LineClass::Material, LineClass::Smooth]
        );
        assert_eq!(hidden(&[(1, UP, 0, false), (-1, near, 0, true)]), [LineClass::Contour]);
        assert_eq!(hidden(&[(1, UP, 0, false)]), [LineClass::Boundary, LineClass::Smooth]);
        assert_eq!(
            hidden(&[(1, UP, 0, false), (1, UP, 0, true), (1, UP, 0, true)]).len(),
            2,
            "not two faces"
        );
    }
}
