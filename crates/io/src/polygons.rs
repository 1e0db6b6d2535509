//! Polygons from a list of corner counts and a list of corners: what PLY and OFF files have.

use crate::triangulate::triangulate;
use vitral_exec::Workers;
use vitral_scene::{Corners, Faces};

/// Faces that one worker takes at a time.
const BLOCK: usize = 1 << 14;

/// The faces and triangles of a mesh.
#[derive(Debug)]
pub(crate) struct Polygons {
    pub(crate) triangles: Vec<Corners>,
    pub(crate) faces: Faces,
}

/// Cuts polygons into triangles. `sizes` has at least 3 for each face, and their sum is the number
/// of `corners`, which are indices into `positions`.
pub(crate) fn build(
    positions: &[[f32; 3]],
    sizes: &[u32],
    corners: Vec<u32>,
    workers: &Workers,
) -> Polygons {
    if sizes.iter().all(|&s| s == 3) {
        return Polygons { triangles: corners.as_chunks().0.to_vec(), faces: Faces::Triangles };
    }
    let mut starts = Vec::with_capacity(sizes.len() + 1);
    starts.push(0u32);
    starts.extend(sizes.iter().scan(0u32, |end, &size| {
        *end += size;
        Some(*end)
    }));

    // Deal the triangles to blocks of faces.
    let mut triangles = vec![[0u32; 3]; corners.len() - 2 * sizes.len()];
    let mut rest = triangles.as_mut_slice();
    let mut jobs = Vec::new();
    for first in (0..sizes.len()).step_by(BLOCK) {
        let faces = first..sizes.len().min(first + BLOCK);
        let count = (starts[faces.end] - starts[first]) as usize - 2 * faces.len();
        let (mine, after) = rest.split_at_mut(count);
        rest = after;
        jobs.push((faces, mine));
    }
    workers.for_each(jobs, |(faces, out)| {
        let (mut cut, mut next) = (Vec::new(), 0);
        for f in faces {
            let outline = &corners[starts[f] as usize..starts[f + 1] as usize];
            cut.clear();
            triangulate(positions, outline, &mut cut);
            for local in &cut {
                out[next] = local.map(|k| outline[k as usize]);
                next += 1;
            }
        }
    });
    Polygons { triangles, faces: Faces::Polygons { starts, corners } }
}

/// For each triangle that [`build`] makes, which of `corners` its corners are.
pub(crate) fn places(positions: &[[f32; 3]], sizes: &[u32], corners: &[u32]) -> Vec<Corners> {
    let mut places = Vec::with_capacity(corners.len() - 2 * sizes.len());
    let (mut cut, mut start) = (Vec::new(), 0);
    for &size in sizes {
        cut.clear();
        triangulate(positions, &corners[start as usize..(start + size) as usize], &mut cut);
        places.extend(cut.iter().map(|local| local.map(|k| start + k)));
        start += size;
    }
    places
}

impl Polygons {
    /// For each triangle, three times the number of its face: the corners of an attribute with one
    /// value a face.
    pub(crate) fn per_face(&self, sizes: &[u32]) -> Vec<Corners> {
        let mut corners = Vec::with_capacity(self.triangles.len());
        for (f, &size) in sizes.iter().enumerate() {
            corners.resize(corners.len() + size as usize - 2, [f as u32; 3]);
        }
        corners
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pentagon_and_a_triangle() {
        let positions: Vec<[f32; 3]> = [[0, 0], [2, 0], [3, 1], [1, 3], [-1, 1]]
            .map(|p: [i32; 2]| [p[0] as f32, p[1] as f32, 0.0])
            .into();
        let built = build(&positions, &[5, 3], vec![0, 1, 2, 3, 4, 0, 2, 4], &Workers::single());
        assert_eq!(built.triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 2, 4]]);
        let corners = [0, 1, 2, 3, 4, 0, 2, 4];
        let named = places(&positions, &[5, 3], &corners)
            .into_iter()
            .map(|t| t.map(|k| corners[k as usize]));
        assert!(named.eq(built.triangles.iter().copied()));
        assert_eq!(built.per_face(&[5, 3]), [[0; 3], [0; 3], [0; 3], [1; 3]]);
    }
}
