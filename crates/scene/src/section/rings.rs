//! The outline of a face that is given as triangles.
//!
//! A ring grows from one triangle: each side with a triangle beyond it that is not in the ring is
//! replaced by that triangle's other two sides. So a ring of `n` corners has `n - 2` triangles, as
//! the faces of a mesh have; where the triangles leave a hole, the ring goes to it and back along a
//! bridge.
//!
//! In:   triangles that share sides. Out: a ring for each connected set of them.
//! Cost: linear, expected.

use crate::Corners;
use std::collections::HashMap;

/// A connected set of triangles.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Ring {
    /// Numbers of its triangles.
    pub(super) triangles: Vec<u32>,
    /// Corners of its outline.
    pub(super) corners: Vec<u32>,
}

/// The rings of triangles.
pub(super) fn rings(triangles: &[Corners]) -> Vec<Ring> {
    if let [corners] = triangles {
        return vec![Ring { triangles: vec![0], corners: corners.to_vec() }];
    }

    // Find the triangle at each directed side; of several, the first.
    let mut at = HashMap::with_capacity(triangles.len() * 3);
    for (t, corners) in triangles.iter().enumerate() {
        for k in 0..3 {
            at.entry([corners[k], corners[(k + 1) % 3]]).or_insert((t as u32, k));
        }
    }

    // Grow a ring from each triangle that is in none.
    let mut is_taken = vec![false; triangles.len()];
    let mut rings = Vec::new();
    for first in 0..triangles.len() as u32 {
        if std::mem::replace(&mut is_taken[first as usize], true) {
            continue;
        }
        let mut ring = Ring { triangles: vec![first], corners: Vec::new() };
        let mut sides = vec![(first, 2), (first, 1), (first, 0)];
        while let Some((t, k)) = sides.pop() {
            let (from, to) = (triangles[t as usize][k], triangles[t as usize][(k + 1) % 3]);
            match at.get(&[to, from]) {
                Some(&(beyond, side)) if !is_taken[beyond as usize] => {
                    is_taken[beyond as usize] = true;
                    ring.triangles.push(beyond);
                    sides.extend([(beyond, (side + 2) % 3), (beyond, (side + 1) % 3)]);
                }
                _ => ring.corners.push(from),
            }
        }
        rings.push(ring);
    }
    rings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_has_two_corners_more_than_triangles() {
        let square = rings(&[[0, 1, 2], [0, 2, 3]]);
        assert_eq!(square, [Ring { triangles: vec![0, 1], corners: vec![0, 1, 2, 3] }]);
        // A corner alone joins nothing.
        let two = rings(&[[0, 1, 2], [2, 3, 4]]);
        assert_eq!(two.iter().map(|r| &r.corners[..]).collect::<Vec<_>>(), [[0, 1, 2], [2, 3, 4]]);
        // A square frame: eight triangles round a hole.
        let frame: Vec<Corners> = (0..4)
            .flat_map(|k| {
                let next = (k + 1) % 4;
                [[k, next, next + 4], [k, next + 4, k + 4]]
            })
            .collect();
        let ring = &rings(&frame)[0];
        assert_eq!((ring.triangles.len(), ring.corners.len()), (8, 10));
        assert_eq!(
            (0..8).map(|v| ring.corners.iter().filter(|&&c| c == v).count()).sum::<usize>(),
            10
        );
    }
}
