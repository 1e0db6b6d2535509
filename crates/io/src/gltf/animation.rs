//! Animations: the nodes and morph weights at one moment.
//!
//! A channel moves one property of one node along keyframes: by steps, straight lines (rotations
//! along the shorter arc) or cubic splines. Before the first keyframe it has that one's value,
//! after the last one that one's.
//!
//! Files are shown at rest unless a moment is asked for. Files whose nodes are without extent at
//! rest, scales of 0 that an animation lets grow, are shown as the first animation begins.
//!
//! In:   a document, the number of an animation, seconds. Out: placements and morph weights of
//!       nodes.
//! Cost: linear in the nodes and the channels of one animation, logarithmic in the keyframes.
//! Source: [glTF 2.0], section 3.11 and appendix C.

use super::accessor::{Integers, Source};
use super::document::name_or;
use crate::Error;
use crate::moment::Moment;
use gltf::json::accessor::Type;
use gltf::json::animation::{
    Animation as JsonAnimation, Channel, Interpolation, Property, Sampler,
};
use gltf::json::validation::Checked;
use vitral_math::{DMat4, DQuat, DVec3, DVec4, func};
use vitral_scene::{Animation, NodeTransform};

/// Cosine of the angle between rotations that are so close that a straight line takes the place of
/// the arc.
const CLOSE: f64 = 0.9995;

/// Placements and morph weights of all nodes.
#[derive(Clone, Default)]
pub(crate) struct NodePoses {
    /// Placement of every node in its parent.
    pub(crate) transforms: Vec<NodeTransform>,
    /// Morph weights that take the place of the node's own.
    pub(crate) weights: Vec<Option<Vec<f32>>>,
}

/// The names and lengths of a document's animations.
pub(crate) fn list(source: &Source<'_>) -> Vec<Animation> {
    let animations = source.root.animations.iter().enumerate();
    animations
        .map(|(i, a)| Animation {
            name: name_or(&a.name, "animation", i),
            seconds: seconds(source, a),
        })
        .collect()
}

/// The last keyframe of all channels.
fn seconds(source: &Source<'_>, animation: &JsonAnimation) -> f64 {
    let last_key = |channel: &Channel| {
        let input = animation.samplers.get(channel.sampler.value())?.input.value();
        let last = source
            .root
            .accessors
            .get(input)
            .and_then(|_| source.count(input).ok())?
            .checked_sub(1)?;
        let keys =
            source.floats::<1>(input, last..last + 1, Integers::AsDeclared, "animations").ok()?;
        Some(f64::from(keys[0][0])).filter(|seconds| seconds.is_finite())
    };
    animation.channels.iter().filter_map(last_key).fold(0.0, f64::max)
}

/// The number of the animation that a moment names: by number, else by name, else by a name of
/// other case.
pub(crate) fn find(source: &Source<'_>, moment: &Moment) -> Result<usize, Error> {
    let (wanted, known) = (moment.animation.as_str(), list(source));
    let numbered = wanted.parse().ok().filter(|number| *number < known.len());
    let named = || known.iter().position(|a| a.name == wanted);
    let in_other_case =
        || known.iter().position(|a| a.name.to_lowercase() == wanted.to_lowercase());
    numbered.or_else(named).or_else(in_other_case).ok_or_else(|| {
        let names: Vec<_> =
            known.iter().enumerate().map(|(i, a)| format!("{i} `{}`", a.name)).collect();
        let there_are =
            if names.is_empty() { "the file has none".to_owned() } else { names.join(", ") };
        Error::Absent { what: format!("{}: no animation `{wanted}`", source.file), hint: there_are }
    })
}

/// Brings nodes to where they are at `time`, seconds.
///
/// # Errors
/// A channel that points at nothing, or whose keyframes make no sense.
pub(crate) fn apply(
    source: &Source<'_>,
    number: usize,
    time: f64,
    poses: &mut NodePoses,
) -> Result<(), Error> {
    let animation = &source.root.animations[number];
    for (c, channel) in animation.channels.iter().enumerate() {
        let path = format!("animations[{number}].channels[{c}]");
        let node = channel.target.node.value();
        let Some(sampler) = animation.samplers.get(channel.sampler.value()) else {
            return Err(source.error(path, "a sampler that is not there"));
        };
        if node >= poses.transforms.len() {
            return Err(
                source.error(path, format!("node {node}, there are {}", poses.transforms.len()))
            );
        }

        // Morph weights, one for each target.
        if channel.target.path == Checked::Valid(Property::MorphTargetWeights) {
            let keyframes = Keyframes::new(source, sampler, time, &path)?;
            let targets = keyframes.values() / keyframes.keys;
            let weights =
                keyframes.vector(|k| keyframes.numbers(k * targets..(k + 1) * targets))?;
            poses.weights[node] = Some(weights.iter().map(|w| *w as f32).collect());
            continue;
        }

        // A part of the placement; a matrix is taken apart first.
        let (mut scale, mut rotation, mut translation) = parts(&poses.transforms[node]);
        let keyframes = || Keyframes::new(source, sampler, time, &path);
        match channel.target.path {
            Checked::Valid(Property::Translation) => translation = keyframes()?.three()?,
            Checked::Valid(Property::Scale) => scale = keyframes()?.three()?,
            Checked::Valid(Property::Rotation) => rotation = keyframes()?.rotation()?,
            Checked::Valid(Property::MorphTargetWeights) | Checked::Invalid => continue,
        }
        if !(translation.is_finite() && scale.is_finite() && rotation.is_finite()) {
            return Err(source.error(path, "a number is not finite"));
        }
        poses.transforms[node] = NodeTransform::Parts { translation, rotation, scale };
    }
    Ok(())
}

/// A placement as scale, rotation and translation.
fn parts(transform: &NodeTransform) -> (DVec3, DQuat, DVec3) {
    match *transform {
        NodeTransform::Parts { translation, rotation, scale } => (scale, rotation, translation),
        NodeTransform::Matrix(matrix) if matrix == DMat4::IDENTITY => {
            (DVec3::ONE, DQuat::IDENTITY, DVec3::ZERO)
        }
        NodeTransform::Matrix(matrix) => matrix.to_scale_rotation_translation(),
    }
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

/// A sampler at one time: which keyframes count, and how much.
struct Keyframes<'a> {
    source: &'a Source<'a>,
    output: usize,
    path: &'a str,
    interpolation: Interpolation,
    /// How many there are.
    keys: usize,
    /// The one before the time and the one after it; equal before the first and after the last.
    around: [usize; 2],
    /// Seconds between them, and how far the time is on its way, `0..=1`.
    step: f64,
    fraction: f64,
}

impl<'a> Keyframes<'a> {
    fn new(
        source: &'a Source<'a>,
        sampler: &Sampler,
        time: f64,
        path: &'a str,
    ) -> Result<Self, Error> {
        let (input, output) = (sampler.input.value(), sampler.output.value());
        let accessors = source.root.accessors.len();
        if input >= accessors || output >= accessors {
            return Err(
                source.error(path, format!("an accessor that is not there, there are {accessors}"))
            );
        }
        let Checked::Valid(interpolation) = sampler.interpolation else {
            return Err(source.error(path, "an interpolation that is not known"));
        };

        // Find the keyframes around the time.
        let keys = source.count(input)?;
        let times = source.floats::<1>(input, 0..keys, Integers::AsDeclared, path)?;
        let at = |k: usize| f64::from(times[k][0]);
        let spline = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        if keys == 0
            || source.count(output)? < keys * spline
            || !times.iter().all(|t| t[0].is_finite())
        {
            return Err(source.error(path, "keyframes without values"));
        }
        let after = times.partition_point(|t| f64::from(t[0]) <= time);
        let around = match after {
            0 => [0, 0],
            _ if after == keys => [keys - 1, keys - 1],
            _ => [after - 1, after],
        };
        let step = at(around[1]) - at(around[0]);
        let fraction = if step > 0.0 { (time - at(around[0])) / step } else { 0.0 };
        Ok(Self { source, output, path, interpolation, keys, around, step, fraction })
    }

    /// Vectors or numbers of the output that are values, without tangents.
    fn values(&self) -> usize {
        let all = self.source.count(self.output).unwrap_or(0);
        if self.interpolation == Interpolation::CubicSpline { all / 3 } else { all }
    }

    /// Numbers of the output.
    fn numbers(&self, range: std::ops::Range<usize>) -> Result<Vec<f64>, Error> {
        let numbers =
            self.source.floats::<1>(self.output, range, Integers::AsDeclared, self.path)?;
        Ok(numbers.iter().map(|n| f64::from(n[0])).collect())
    }

    /// Vector `k` of the output.
    fn element<const N: usize>(&self, k: usize) -> Result<Vec<f64>, Error> {
        let shape = if N == 3 { Type::Vec3 } else { Type::Vec4 };
        if self.source.shape(self.output) != Some(shape) {
            return Err(self
                .source
                .error(self.path, format!("vectors of {N} numbers are required")));
        }
        let vectors =
            self.source.floats::<N>(self.output, k..k + 1, Integers::AsDeclared, self.path)?;
        Ok(vectors[0].iter().map(|n| f64::from(*n)).collect())
    }

    /// The value, each number by itself. `element` gives vectors of the output by number.
    fn vector(
        &self,
        element: impl Fn(usize) -> Result<Vec<f64>, Error>,
    ) -> Result<Vec<f64>, Error> {
        let ([before, after], t) = (self.around, self.fraction);
        let combine = |weighted: &[(f64, Vec<f64>)]| {
            let sum = |i: usize| weighted.iter().map(|(weight, vector)| weight * vector[i]).sum();
            (0..weighted[0].1.len()).map(sum).collect()
        };
        match self.interpolation {
            Interpolation::Step => element(before),
            Interpolation::Linear if before == after => element(before),
            Interpolation::Linear => {
                Ok(combine(&[(1.0 - t, element(before)?), (t, element(after)?)]))
            }
            // Each keyframe is an in-tangent, a value, an out-tangent.
            Interpolation::CubicSpline if before == after => element(3 * before + 1),
            Interpolation::CubicSpline => {
                let (t2, t3) = (t * t, t * t * t);
                Ok(combine(&[
                    (2.0 * t3 - 3.0 * t2 + 1.0, element(3 * before + 1)?),
                    (self.step * (t3 - 2.0 * t2 + t), element(3 * before + 2)?),
                    (-2.0 * t3 + 3.0 * t2, element(3 * after + 1)?),
                    (self.step * (t3 - t2), element(3 * after)?),
                ]))
            }
        }
    }

    /// A translation or scale.
    fn three(&self) -> Result<DVec3, Error> {
        Ok(DVec3::from_slice(&self.vector(|k| self.element::<3>(k))?))
    }

    /// A rotation; straight lines become arcs.
    fn rotation(&self) -> Result<DQuat, Error> {
        let quaternion = |k: usize| Ok(unit(DVec4::from_slice(&self.element::<4>(k)?)));
        if self.interpolation == Interpolation::Linear {
            return Ok(arc(
                quaternion(self.around[0])?,
                quaternion(self.around[1])?,
                self.fraction,
            ));
        }
        Ok(DQuat::from_vec4(unit(DVec4::from_slice(&self.vector(|k| self.element::<4>(k))?))))
    }
}

/// The unit quaternion in a direction; none at all stands for no rotation.
fn unit(quaternion: DVec4) -> DVec4 {
    quaternion.try_normalize().unwrap_or(DVec4::W)
}

/// The rotation at `t` of the shorter arc between two.
fn arc(from: DVec4, to: DVec4, t: f64) -> DQuat {
    let cos = from.dot(to);
    let (to, cos) = if cos < 0.0 { (-to, -cos) } else { (to, cos) };
    if cos > CLOSE {
        return DQuat::from_vec4(unit(from + (to - from) * t));
    }
    let angle = func::acos(cos);
    DQuat::from_vec4(unit(from * func::sin((1.0 - t) * angle) + to * func::sin(t * angle)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotations_take_the_shorter_arc() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let (none, quarter) = (DVec4::W, DVec4::new(0.0, 0.0, half, half));
        let eighth = arc(none, quarter, 0.5);
        let expected = DQuat::from_xyzw(0.0, 0.0, func::sin(std::f64::consts::PI / 8.0), 0.0).z;
        assert!((eighth.z - expected).abs() < 1e-15);
        assert!(
            (arc(none, -quarter, 0.5).z - expected).abs() < 1e-15,
            "the same rotation by the other sign"
        );
        assert_eq!(arc(none, none, 0.3), DQuat::IDENTITY);
    }
}
