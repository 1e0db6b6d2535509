//! Shading normals of a mesh put together from blocks, some of which may have none, or bad ones.
//!
//! No block has normals: the mesh has none. Some have: the others get flat ones, as the
//! specification asks. A few bad ones (zero, not finite) among good ones: the mean of the faces
//! round the vertex. Mostly bad ones: as if the block had none.
//!
//! Cost: linear in vertices and triangles. Source: [glTF 2.0], section 3.7.2.1.

use super::block::Block;
use vitral_math::Vec3;
use vitral_scene::{Attribute, Corners, Mesh};

/// Makes the normals of `mesh`, which already has its positions and triangles, from those of its
/// blocks.
pub(crate) fn assemble(
    blocks: &[Block],
    mut normals: Vec<Option<Vec<[f32; 3]>>>,
    mesh: &Mesh,
    label: &str,
    warnings: &mut Vec<String>,
) -> Option<Attribute<[f32; 3]>> {
    let bad = mend(blocks, &mut normals, mesh);
    if bad > 0 {
        warnings.push(format!("{label}: {bad} normals are zero or not finite and were recomputed"));
    }
    if !blocks.iter().zip(&normals).any(|(b, n)| b.has_surface && n.is_some()) {
        return None;
    }

    // Put the blocks one behind the other; a block of lines or points only needs something in its
    // place.
    let missing =
        |(block, values): (&Block, &Option<Vec<[f32; 3]>>)| block.has_surface && values.is_none();
    let flat: Vec<(u32, u32)> = blocks
        .iter()
        .zip(&normals)
        .filter(|&pair| missing(pair))
        .map(|(b, _)| (b.base, b.base + b.range.len() as u32))
        .collect();
    let mut values: Vec<[f32; 3]> = Vec::with_capacity(mesh.positions.len());
    for (block, normals) in blocks.iter().zip(normals) {
        match normals {
            Some(normals) => values.extend(normals),
            None => values.resize(values.len() + block.range.len(), [0.0, 0.0, 1.0]),
        }
    }
    if flat.is_empty() {
        return Some(Attribute::per_vertex(values));
    }
    let corners = with_flat(&flat, mesh, &mut values);
    Some(Attribute { values, corners: Some(corners) })
}

/// Repairs a few bad normals, drops those of a block where most are bad; tells how many were bad.
fn mend(blocks: &[Block], normals: &mut [Option<Vec<[f32; 3]>>], mesh: &Mesh) -> usize {
    let mut bad = 0;
    for (block, slot) in blocks.iter().zip(normals) {
        let Some(values) = slot else { continue };
        let here = values.iter().filter(|n| is_bad(n)).count();
        bad += here;
        if 2 * here > values.len() {
            *slot = None;
        } else if here > 0 {
            repair(values, block.base, mesh);
        }
    }
    bad
}

fn is_bad(n: &[f32; 3]) -> bool {
    *n == [0.0; 3] || n.iter().any(|c| !c.is_finite())
}

/// Twice the area of a triangle times its unit normal; zero where a corner is not finite.
fn facing(mesh: &Mesh, corners: Corners) -> Vec3 {
    let [a, b, c] = corners.map(|i| Vec3::from(mesh.positions[i as usize]));
    let cross = (b - a).cross(c - a);
    if cross.is_finite() { cross } else { Vec3::ZERO }
}

/// Replaces bad normals by the mean of the faces round their vertices, weighted by area.
fn repair(values: &mut [[f32; 3]], base: u32, mesh: &Mesh) {
    let mut sums = vec![Vec3::ZERO; values.len()];
    for &corners in &mesh.triangles {
        if corners.iter().any(|&i| i < base || (i - base) as usize >= values.len()) {
            continue;
        }
        let facing = facing(mesh, corners);
        for i in corners {
            sums[(i - base) as usize] += facing;
        }
    }
    for (value, sum) in values.iter_mut().zip(sums) {
        if is_bad(value) {
            *value = sum.normalize_or(Vec3::Z).to_array();
        }
    }
}

/// Corners that take the vertices' normals, except triangles of the blocks in `flat`, which get a
/// normal each.
fn with_flat(flat: &[(u32, u32)], mesh: &Mesh, values: &mut Vec<[f32; 3]>) -> Vec<Corners> {
    let mut corners = Vec::with_capacity(mesh.triangles.len());
    for &triangle in &mesh.triangles {
        if flat.iter().any(|&(start, end)| (start..end).contains(&triangle[0])) {
            values.push(facing(mesh, triangle).normalize_or(Vec3::Z).to_array());
            corners.push([values.len() as u32 - 1; 3]);
        } else {
            corners.push(triangle);
        }
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_normals_take_the_mean_of_their_faces() {
        let mesh = Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        let mut values = vec![[0.0, 0.0, 1.0], [f32::NAN; 3], [0.0; 3], [1.0, 0.0, 0.0]];
        repair(&mut values, 0, &mesh);
        assert_eq!(values[1], [0.0, 0.0, 1.0]);
        let half = 0.5f32.sqrt();
        assert!((Vec3::from(values[2]) - Vec3::new(half, 0.0, half)).length() < 1e-6);
        assert_eq!((values[0], values[3]), ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]), "good ones stay");
        let corners = with_flat(&[(0, 4)], &mesh, &mut values);
        assert_eq!((corners[1], values[5]), ([5; 3], [1.0, 0.0, 0.0]));
    }
}
