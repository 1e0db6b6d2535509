//! Files whose nodes are without extent unless they are animated: scales of 0 that an animation lets grow. They are shown as
//! the first animation has them at time 0; all others are shown at rest.
//!
//! At time 0 a channel has the value of its first keyframe, whatever the interpolation: values before the first keyframe are
//! clamped to it.
//!
//! Cost: linear in the nodes and the channels of one animation. Source: [glTF 2.0], section 3.11.

use super::accessor::{Integers, Source};
use crate::Error;
use gltf::json::animation::{Animation, Interpolation, Property};
use gltf::json::validation::Checked;
use vitral_math::{DMat4, DQuat, DVec3, DVec4};
use vitral_scene::NodeTransform;

/// The placements of the first animation at time 0. `None`: there is no animation, or it makes no sense.
pub(crate) fn at_start(source: &Source<'_>, transforms: &[NodeTransform]) -> Option<Vec<NodeTransform>> {
    let mut moved = transforms.to_vec();
    apply_start(source, source.root.animations.first()?, &mut moved).ok()?;
    Some(moved)
}

/// Whether any mesh can be seen: its axes span at least a plane in the world.
pub(crate) fn has_extent(source: &Source<'_>, worlds: &[DMat4]) -> bool {
    let mut meshes = source.root.nodes.iter().zip(worlds).filter(|(node, _)| node.mesh.is_some());
    meshes.any(|(_, world)| spans_plane(world))
}

fn spans_plane(world: &DMat4) -> bool {
    let [x, y, z] = [world.x_axis, world.y_axis, world.z_axis].map(DVec4::truncate);
    [x.cross(y), y.cross(z), z.cross(x)].iter().any(|area| *area != DVec3::ZERO)
}

/// Gives the targets of all channels their values at time 0.
fn apply_start(source: &Source<'_>, animation: &Animation, transforms: &mut [NodeTransform]) -> Result<(), Error> {
    for (c, channel) in animation.channels.iter().enumerate() {
        let path = format!("animations[0].channels[{c}]");
        let node = channel.target.node.value();
        let Some(sampler) = animation.samplers.get(channel.sampler.value()) else { continue };
        let accessor = sampler.output.value();
        if node >= transforms.len() || accessor >= source.root.accessors.len() || source.count(accessor)? == 0 {
            continue;
        }

        // A cubic spline has a tangent before each value.
        let is_cubic = sampler.interpolation == Checked::Valid(Interpolation::CubicSpline);
        let first = usize::from(is_cubic);
        if first >= source.count(accessor)? {
            continue;
        }
        let three = || {
            source
                .floats::<3>(accessor, first..first + 1, Integers::AsDeclared, &path)
                .map(|v| DVec3::from_array(v[0].map(f64::from)))
        };
        let NodeTransform::Parts { mut translation, mut rotation, mut scale } = parts(&transforms[node]) else {
            continue;
        };
        match channel.target.path {
            Checked::Valid(Property::Translation) => translation = three()?,
            Checked::Valid(Property::Scale) => scale = three()?,
            Checked::Valid(Property::Rotation) => {
                let value =
                    source.floats::<4>(accessor, first..first + 1, Integers::AsDeclared, &path)?[0].map(f64::from);
                rotation = DQuat::from_vec4(DVec4::from_array(value).try_normalize().unwrap_or(DVec4::W));
            }
            Checked::Valid(Property::MorphTargetWeights) | Checked::Invalid => continue,
        }
        if translation.is_finite() && scale.is_finite() && rotation.is_finite() {
            transforms[node] = NodeTransform::Parts { translation, rotation, scale };
        }
    }
    Ok(())
}

/// A placement in parts. A matrix is none, unless it is that of a node without any.
fn parts(transform: &NodeTransform) -> NodeTransform {
    if *transform == NodeTransform::default() {
        return NodeTransform::Parts { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE };
    }
    *transform
}
