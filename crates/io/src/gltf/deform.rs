//! The default pose: morph targets at their default weights, skins at the joints' places in the
//! node tree.
//!
//! Morphing adds weighted displacements. Skinning moves each vertex by the weighted mean of its
//! joints' matrices `world_from_joint * joint_from_mesh`, so that the result is in world space and
//! the node's own place is not used.
//!
//! Cost: vertices times targets, vertices times influences. Source: [glTF 2.0], sections 3.7.2.2
//! and 3.7.3. Departs from it: weights are scaled to a sum of 1; a vertex without weights stays
//! where it is.

use super::accessor::{Integers, Source};
use super::geometry::Attributes;
use crate::Error;
use gltf::json::Skin;
use std::ops::Range;
use vitral_math::{DMat3, DMat4, DVec3};

/// Adds the displacements of all targets whose weight is not zero.
pub(crate) fn morph(
    source: &Source<'_>,
    attributes: &Attributes,
    range: &Range<usize>,
    weights: &[f32],
    positions: &mut [[f32; 3]],
    mut normals: Option<&mut Vec<[f32; 3]>>,
    path: &str,
) -> Result<(), Error> {
    for (t, (&(moves, turns), &weight)) in attributes.targets.iter().zip(weights).enumerate() {
        if weight == 0.0 {
            continue;
        }
        let displaced =
            |to: &mut [[f32; 3]], accessor: Option<usize>, name: &str| -> Result<(), Error> {
                let Some(accessor) = accessor else { return Ok(()) };
                let path = format!("{path}.targets[{t}].{name}");
                let by =
                    source.floats::<3>(accessor, range.clone(), Integers::AsDeclared, &path)?;
                for (p, d) in to.iter_mut().zip(by) {
                    for k in 0..3 {
                        p[k] += weight * d[k];
                    }
                }
                Ok(())
            };
        displaced(positions, moves, "POSITION")?;
        if let Some(normals) = normals.as_deref_mut() {
            displaced(normals, turns, "NORMAL")?;
        }
    }
    Ok(())
}

/// The matrices that carry a mesh's vertices with each joint, world space.
pub(crate) fn joint_matrices(
    source: &Source<'_>,
    skin: &Skin,
    index: usize,
    worlds: &[DMat4],
) -> Result<Vec<DMat4>, Error> {
    let joints = skin.joints.len();
    let inverse_bind = match skin.inverse_bind_matrices {
        None => vec![DMat4::IDENTITY; joints],
        Some(accessor) => {
            let path = format!("skins[{index}].inverseBindMatrices");
            let count = source.count(accessor.value())?;
            if count < joints {
                return Err(source.error(path, format!("{count} matrices for {joints} joints")));
            }
            let matrices =
                source.floats::<16>(accessor.value(), 0..joints, Integers::AsDeclared, &path)?;
            matrices.iter().map(|m| DMat4::from_cols_array(&m.map(f64::from))).collect()
        }
    };
    Ok(skin
        .joints
        .iter()
        .zip(inverse_bind)
        .map(|(joint, bind)| worlds[joint.value()] * bind)
        .collect())
}

/// Moves vertices with their joints.
pub(crate) fn skin(
    source: &Source<'_>,
    attributes: &Attributes,
    range: &Range<usize>,
    matrices: &[DMat4],
    positions: &mut [[f32; 3]],
    mut normals: Option<&mut Vec<[f32; 3]>>,
    path: &str,
) -> Result<(), Error> {
    let blend = blended_matrices(source, attributes, range, matrices, path)?;
    for (i, matrix) in blend.iter().enumerate() {
        let Some(matrix) = matrix else { continue };
        positions[i] = matrix.transform_point3(widened(positions[i])).as_vec3().to_array();
        if let Some(normals) = normals.as_deref_mut() {
            normals[i] = turned_normal(matrix, widened(normals[i])).as_vec3().to_array();
        }
    }
    Ok(())
}

fn widened(v: [f32; 3]) -> DVec3 {
    DVec3::new(f64::from(v[0]), f64::from(v[1]), f64::from(v[2]))
}

/// A normal goes with the cofactors of the matrix, which are its inverse transpose up to a factor
/// and exist always.
fn turned_normal(matrix: &DMat4, normal: DVec3) -> DVec3 {
    let m = DMat3::from_mat4(*matrix);
    let cofactors = DMat3::from_cols(
        m.y_axis.cross(m.z_axis),
        m.z_axis.cross(m.x_axis),
        m.x_axis.cross(m.y_axis),
    );
    let turned = cofactors * normal;
    let turned = if m.determinant() < 0.0 { -turned } else { turned };
    turned.try_normalize().unwrap_or(normal)
}

/// The weighted mean of each vertex's joint matrices; `None` where all weights are zero.
fn blended_matrices(
    source: &Source<'_>,
    attributes: &Attributes,
    range: &Range<usize>,
    matrices: &[DMat4],
    path: &str,
) -> Result<Vec<Option<DMat4>>, Error> {
    let mut sums = vec![(DMat4::ZERO, 0.0f64); range.len()];
    for (set, &(joints, weights)) in attributes.influences.iter().enumerate() {
        let joints_path = format!("{path}.attributes.JOINTS_{set}");
        let joints = source.unsigned::<4>(joints, range.clone(), &joints_path)?;
        let weights_path = format!("{path}.attributes.WEIGHTS_{set}");
        let weights =
            source.floats::<4>(weights, range.clone(), Integers::Normalized, &weights_path)?;
        for (v, ((matrix, sum), (joints, weights))) in
            sums.iter_mut().zip(joints.iter().zip(weights)).enumerate()
        {
            for (&joint, weight) in joints.iter().zip(weights) {
                if weight == 0.0 {
                    continue;
                }
                let Some(by) = matrices.get(joint as usize) else {
                    let what = format!(
                        "vertex {} has joint {joint}, the skin has {}",
                        range.start + v,
                        matrices.len()
                    );
                    return Err(source.error(joints_path, what));
                };
                *matrix += *by * f64::from(weight);
                *sum += f64::from(weight);
            }
        }
    }
    Ok(sums.into_iter().map(|(matrix, sum)| (sum > 0.0).then(|| matrix * (1.0 / sum))).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_stay_perpendicular_under_uneven_scale_and_mirrors() {
        let stretch = DMat4::from_scale(DVec3::new(2.0, 1.0, 1.0));
        let n = turned_normal(&stretch, DVec3::new(1.0, 1.0, 0.0));
        assert!(n.dot(stretch.transform_vector3(DVec3::new(1.0, -1.0, 0.0))).abs() < 1e-15);
        let mirror = DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        assert_eq!(turned_normal(&mirror, DVec3::X), DVec3::NEG_X);
        let flat = DMat4::from_scale(DVec3::new(1.0, 1.0, 0.0));
        assert_eq!(
            turned_normal(&flat, DVec3::X),
            DVec3::X,
            "a singular matrix keeps what it cannot turn"
        );
    }
}
