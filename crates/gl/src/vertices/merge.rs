//! Merging of equal vertices, so that each is transformed once.
//!
//! Vertices go one by one into an open-addressing table of those already kept; two are equal if all
//! bits of all attributes are. Linear in the number of vertices.

use crate::vertex::VertexBatch;

const FREE: u32 = u32::MAX;

/// Replaces equal vertices of a batch without indices by one, named by indices. Batches that would
/// gain nothing, and those with materials (which hold from vertex to vertex), stay as they are.
pub(crate) fn merge_equal(batch: &mut VertexBatch) {
    let n = batch.positions.len();
    if n < 2 || n >= FREE as usize / 2 || batch.indices.is_some() || !batch.materials.is_empty() {
        return;
    }

    // Hash the vertices into an open table.
    let hashes = hashes(batch);
    let mask = (2 * n).next_power_of_two() - 1;
    let mut table = vec![FREE; mask + 1];
    let mut kept: Vec<u32> = Vec::with_capacity(n);
    let mut indices = Vec::with_capacity(n);
    // Find an equal vertex, or keep this one.
    for i in 0..n {
        // The high bits are the well mixed ones.
        let mut at = (hashes[i] >> 32) as usize & mask;
        let index = loop {
            match table[at] {
                FREE => {
                    table[at] = kept.len() as u32;
                    kept.push(i as u32);
                    break table[at];
                }
                index => {
                    let other = kept[index as usize] as usize;
                    if hashes[other] == hashes[i] && equal(batch, other, i) {
                        break index;
                    }
                    at = (at + 1) & mask;
                }
            }
        };
        indices.push(index);
    }

    // Replace the vertices if some were equal.
    if kept.len() < n {
        batch.select_vertices(&kept);
        batch.indices = Some(indices);
    }
}

/// One hash a vertex.
fn hashes(batch: &VertexBatch) -> Vec<u64> {
    fn mix<const N: usize>(hashes: &mut [u64], values: &[[f32; N]]) {
        for (hash, value) in hashes.iter_mut().zip(values) {
            for x in value {
                *hash = (hash.rotate_left(5) ^ u64::from(x.to_bits()))
                    .wrapping_mul(0x517c_c1b7_2722_0a95);
            }
        }
    }
    let mut hashes = vec![0; batch.positions.len()];
    mix(&mut hashes, &batch.positions);
    batch.normals.iter().for_each(|values| mix(&mut hashes, values));
    batch.colors.iter().for_each(|values| mix(&mut hashes, values));
    // Secondary colours, fog and edges seldom tell vertices apart that are equal up to here.
    batch.tex.iter().flatten().for_each(|values| mix(&mut hashes, values));
    for hash in &mut hashes {
        *hash ^= *hash >> 29;
        *hash = hash.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
    hashes
}

/// Whether all bits of vertices `a` and `b` agree.
fn equal(batch: &VertexBatch, a: usize, b: usize) -> bool {
    fn same<T: bytemuck::Pod>(values: &[T], a: usize, b: usize) -> bool {
        bytemuck::bytes_of(&values[a]) == bytemuck::bytes_of(&values[b])
    }
    same(&batch.positions, a, b)
        && batch.normals.iter().all(|values| same(values, a, b))
        && batch.colors.iter().all(|values| same(values, a, b))
        && batch.secondary.iter().all(|values| same(values, a, b))
        && batch.fog.iter().all(|values| same(values, a, b))
        && batch.edges.iter().all(|values| values[a] == values[b])
        && batch.tex.iter().flatten().all(|values| same(values, a, b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_triangles_of_a_square_share_two_vertices() {
        let corner = |x: f32, y: f32| [x, y, 0.0, 1.0];
        let [a, b, c, d] = [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
        let mut batch = VertexBatch { positions: vec![a, b, c, a, c, d], ..VertexBatch::default() };
        merge_equal(&mut batch);
        assert_eq!(batch.positions, [a, b, c, d]);
        assert_eq!(batch.indices, Some(vec![0, 1, 2, 0, 2, 3]));
    }

    #[test]
    fn every_attribute_tells_vertices_apart() {
        let mut batch = VertexBatch {
            positions: vec![[0.0; 4]; 3],
            edges: Some(vec![true, false, true]),
            fog: Some(vec![0.0, 0.0, -0.0]),
            ..VertexBatch::default()
        };
        merge_equal(&mut batch);
        assert_eq!(batch.indices, None);
        assert_eq!(batch.positions.len(), 3);
    }
}
