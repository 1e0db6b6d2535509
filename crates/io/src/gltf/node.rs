//! The node tree: transforms, which scene is shown, which nodes are hidden, cameras and lights.
//!
//! Cost: linear in the number of nodes; nothing recurses, so a deep tree is no danger.
//! Source: [glTF 2.0], sections 3.5, 3.10; KHR_lights_punctual, KHR_node_visibility.

use super::accessor::Source;
use super::animation::{self, NodePoses};
use super::document::VISIBILITY;
use crate::Error;
use crate::moment::Moment;
use gltf::json::Node as JsonNode;
use gltf::json::camera::{Camera as JsonCamera, Type as CameraType};
use gltf::json::extensions::scene::khr_lights_punctual::{Light as JsonLight, Type as LightType};
use gltf::json::validation::Checked;
use std::f32::consts::FRAC_1_PI;
use vitral_light::{Attenuation, Light, LightKind};
use vitral_math::{DMat4, DQuat, DVec3, DVec4};
use vitral_scene::{Camera, NodeTransform, Projection};

/// The tree as far as the chosen scene shows it.
pub(crate) struct Tree {
    /// Nodes that are shown, parents before their children.
    pub(crate) shown: Vec<usize>,
    /// The scene's roots, each shown once.
    pub(crate) roots: Vec<usize>,
    /// Children of every node.
    pub(crate) children: Vec<Vec<usize>>,
    /// Placement and morph weights of every node.
    pub(crate) poses: NodePoses,
    /// Placement of every node in the world, shown or not.
    pub(crate) worlds: Vec<DMat4>,
}

impl Tree {
    /// Checks that the nodes form trees and finds what the scene shows. Nodes that
    /// `KHR_node_visibility` hides are left out with all that is below them. `far_nodes` are places
    /// in double precision. Nodes are at rest, or where they are at a `moment`.
    pub(crate) fn read(
        source: &Source<'_>,
        far_nodes: &[(usize, [f64; 3])],
        moment: Option<&Moment>,
        warnings: &mut Vec<String>,
    ) -> Result<Self, Error> {
        let nodes = &source.root.nodes;
        let mut children: Vec<Vec<usize>> = nodes
            .iter()
            .map(|n| n.children.iter().flatten().map(|c| c.value()).collect())
            .collect();
        let parents = parents(source, &children)?;
        let mut transforms = nodes
            .iter()
            .enumerate()
            .map(|(i, node)| transform(source, node, i, warnings))
            .collect::<Result<Vec<_>, _>>()?;
        for &(n, place) in far_nodes {
            match &mut transforms[n] {
                NodeTransform::Matrix(matrix) => {
                    matrix.w_axis = DVec3::from_array(place).extend(1.0)
                }
                NodeTransform::Parts { translation, .. } => *translation = DVec3::from_array(place),
            }
        }

        // Place every node, parents first; whoever is not reached from a node without parent lies
        // on a cycle.
        let order = depth_first(&children, (0..nodes.len()).filter(|&n| parents[n].is_none()));
        let mut reached = vec![false; nodes.len()];
        order.iter().for_each(|&n| reached[n] = true);
        if let Some(n) = reached.iter().position(|r| !r) {
            return Err(source.error(format!("nodes[{n}]"), "the node is its own ancestor"));
        }
        let mut poses = NodePoses { weights: vec![None; transforms.len()], transforms };
        let mut worlds = worlds(&order, &parents, &poses.transforms);

        // Move the nodes to where they are at the moment. Where nothing can be seen at rest, show
        // the first animation.
        if let Some(moment) = moment {
            let number = animation::find(source, moment)?;
            animation::apply(source, number, moment.seconds, &mut poses)?;
            worlds = self::worlds(&order, &parents, &poses.transforms);
        } else if !source.root.animations.is_empty() && !animation::has_extent(source, &worlds) {
            let mut moved = poses.clone();
            let moved_worlds = animation::apply(source, 0, 0.0, &mut moved)
                .map(|()| self::worlds(&order, &parents, &moved.transforms))
                .ok()
                .filter(|worlds| animation::has_extent(source, worlds));
            if let Some(moved_worlds) = moved_worlds {
                (poses, worlds) = (moved, moved_worlds);
                let what = "nothing has any extent at rest; the first animation is shown at time 0";
                warnings.push(format!("{}: animations[0]: {what}", source.file));
            }
        }

        // Find what the scene shows, without what is hidden.
        let mut roots = roots(source, &parents, warnings);
        for list in children.iter_mut().chain([&mut roots]) {
            list.retain(|&n| is_visible(&nodes[n]));
        }
        let shown = depth_first(&children, roots.iter().copied());
        Ok(Self { shown, roots, children, poses, worlds })
    }
}

/// The placement of every node in the world. `order` has parents before their children.
fn worlds(order: &[usize], parents: &[Option<usize>], transforms: &[NodeTransform]) -> Vec<DMat4> {
    let mut worlds = vec![DMat4::IDENTITY; transforms.len()];
    for &n in order {
        worlds[n] = parents[n].map_or(DMat4::IDENTITY, |p| worlds[p]) * transforms[n].matrix();
    }
    worlds
}

/// Whether the node is not hidden by itself.
fn is_visible(node: &JsonNode) -> bool {
    let visible =
        node.extensions.as_ref().and_then(|e| e.others.get(VISIBILITY)?.get("visible")?.as_bool());
    visible.unwrap_or(true)
}

/// The parent of each node; two parents are an error.
fn parents(source: &Source<'_>, children: &[Vec<usize>]) -> Result<Vec<Option<usize>>, Error> {
    let mut parents: Vec<Option<usize>> = vec![None; children.len()];
    for (parent, list) in children.iter().enumerate() {
        for (k, &child) in list.iter().enumerate() {
            if let Some(other) = parents[child].replace(parent) {
                let what = format!("node {child} is a child of node {other} already");
                return Err(source.error(format!("nodes[{parent}].children[{k}]"), what));
            }
        }
    }
    Ok(parents)
}

/// All nodes below `roots`, parents before children, children in order.
fn depth_first(
    children: &[Vec<usize>],
    roots: impl DoubleEndedIterator<Item = usize>,
) -> Vec<usize> {
    let mut stack: Vec<usize> = roots.rev().collect();
    let mut order = Vec::new();
    while let Some(n) = stack.pop() {
        order.push(n);
        stack.extend(children[n].iter().rev());
    }
    order
}

/// The roots of the default scene, or of the first. A root that another root shows already is
/// passed over.
fn roots(source: &Source<'_>, parents: &[Option<usize>], warnings: &mut Vec<String>) -> Vec<usize> {
    let root = source.root;
    let Some(scene) = root.scenes.get(root.scene.map_or(0, |s| s.value())) else {
        warnings.push(format!("{}: there is no scene, nothing is shown", source.file));
        return Vec::new();
    };
    if scene.nodes.is_empty() {
        warnings.push(format!("{}: the scene has no nodes, nothing is shown", source.file));
    }
    let mut listed = vec![false; parents.len()];
    let unique: Vec<usize> = scene
        .nodes
        .iter()
        .map(|n| n.value())
        .filter(|&n| !std::mem::replace(&mut listed[n], true))
        .collect();
    let mut roots = Vec::with_capacity(unique.len());
    let mut covered = vec![None; parents.len()];
    for n in unique {
        if has_listed_ancestor(n, parents, &listed, &mut covered) {
            warnings.push(format!(
                "{}: scene root {n} lies below another root and is shown once",
                source.file
            ));
        } else {
            roots.push(n);
        }
    }
    roots
}

/// Whether a proper ancestor of `n` is listed. `known` keeps answers, so that all calls together
/// are linear.
fn has_listed_ancestor(
    n: usize,
    parents: &[Option<usize>],
    listed: &[bool],
    known: &mut [Option<bool>],
) -> bool {
    let mut path = Vec::new();
    let mut at = n;
    let answer = loop {
        if let Some(answer) = known[at] {
            break answer;
        }
        path.push(at);
        match parents[at] {
            None => break false,
            Some(parent) if listed[parent] => break true,
            Some(parent) => at = parent,
        }
    };
    for step in path {
        known[step] = Some(answer);
    }
    answer
}

/// A node's placement. Numbers must be finite; a rotation is made a unit quaternion.
fn transform(
    source: &Source<'_>,
    node: &JsonNode,
    index: usize,
    warnings: &mut Vec<String>,
) -> Result<NodeTransform, Error> {
    let not_finite =
        |name: &str| source.error(format!("nodes[{index}].{name}"), "a number is not finite");
    let mut warn = |what: &str| warnings.push(format!("{}: nodes[{index}]: {what}", source.file));

    // Take a matrix, whose last row must be that of an affine map.
    if let Some(columns) = node.matrix {
        let mut matrix = DMat4::from_cols_array(&columns.map(f64::from));
        if !matrix.is_finite() {
            return Err(not_finite("matrix"));
        }
        if matrix.row(3) != DVec4::W {
            warn("the last row of the matrix is not 0 0 0 1, it is taken so");
            for (column, last) in [(0, 0.0), (1, 0.0), (2, 0.0), (3, 1.0)] {
                matrix.col_mut(column).w = last;
            }
        }
        return Ok(NodeTransform::Matrix(matrix));
    }

    // Check translation and scale, and normalise the rotation.
    let vector = |v: Option<[f32; 3]>, default: DVec3, name: &str| {
        let v = v.map_or(default, |v| DVec3::from_array(v.map(f64::from)));
        if v.is_finite() { Ok(v) } else { Err(not_finite(name)) }
    };
    let translation = vector(node.translation, DVec3::ZERO, "translation")?;
    let scale = vector(node.scale, DVec3::ONE, "scale")?;
    let quaternion = DVec4::from_array(node.rotation.unwrap_or_default().0.map(f64::from));
    if !quaternion.is_finite() {
        return Err(not_finite("rotation"));
    }
    let unit = quaternion.try_normalize().unwrap_or_else(|| {
        warn("the rotation is zero, none is used");
        DVec4::W
    });

    // Keep the default if the node is not moved.
    if translation == DVec3::ZERO && scale == DVec3::ONE && unit == DVec4::W {
        return Ok(NodeTransform::default());
    }
    Ok(NodeTransform::Parts { translation, rotation: DQuat::from_vec4(unit), scale })
}

/// A camera in its node's space, looking along -z. `None` with a warning if its numbers make no
/// picture.
pub(crate) fn camera(
    source: &Source<'_>,
    json: &JsonCamera,
    index: usize,
    warnings: &mut Vec<String>,
) -> Option<Camera> {
    let (projection, near, far) = match (&json.type_, &json.perspective, &json.orthographic) {
        (Checked::Valid(CameraType::Perspective), Some(p), _) => {
            let view_angle = f64::from(p.yfov);
            let valid = view_angle > 0.0 && view_angle < std::f64::consts::PI && p.znear > 0.0;
            (valid.then_some(Projection::Perspective { view_angle }), p.znear, p.zfar)
        }
        (Checked::Valid(CameraType::Orthographic), _, Some(o)) => {
            let height = 2.0 * f64::from(o.ymag).abs();
            (
                (height > 0.0 && height.is_finite()).then_some(Projection::Parallel { height }),
                o.znear,
                Some(o.zfar),
            )
        }
        _ => (None, 0.0, None),
    };
    let Some(projection) = projection else {
        warnings.push(format!(
            "{}: cameras[{index}]: its angle or size is not positive, left out",
            source.file
        ));
        return None;
    };
    // Without a far plane both are fitted to the scene.
    let clip = far
        .map(|far| (f64::from(near), f64::from(far)))
        .filter(|&(n, f)| n < f && f.is_finite() && n >= 0.0);
    let (position, focal_point, view_up) = (DVec3::ZERO, DVec3::NEG_Z, DVec3::Y);
    Some(Camera { position, focal_point, view_up, projection, clip })
}

/// A light in its node's space, shining along -z. Candela and lux are divided by pi: that is in the
/// specification's diffuse reflection, not in ours. `None` with a warning for a type that is not
/// known.
pub(crate) fn light(
    source: &Source<'_>,
    json: &JsonLight,
    index: usize,
    warnings: &mut Vec<String>,
) -> Option<Light> {
    // Leave out lights of unknown types.
    let Checked::Valid(kind) = json.type_ else {
        let path = format!("extensions.KHR_lights_punctual.lights[{index}]");
        warnings.push(format!(
            "{}: {path}: a light of a type that is not known, left out",
            source.file
        ));
        return None;
    };

    // Multiply the colour by the intensity, and replace values that are not finite by zero.
    let intensity =
        if json.intensity.is_finite() { json.intensity.max(0.0) * FRAC_1_PI } else { 0.0 };
    let color = json
        .color
        .map(|c| if c.is_finite() { (c.max(0.0) * intensity).min(f32::MAX) } else { 0.0 });

    // Place the light at the origin, along -z.
    let (position, direction) = (DVec3::ZERO, DVec3::NEG_Z);
    let kind = match (kind, &json.spot) {
        (LightType::Spot, Some(spot)) => {
            let angle = |a: f32| f64::from(a).clamp(0.0, std::f64::consts::FRAC_PI_2);
            let cutoff = angle(spot.outer_cone_angle);
            let inner = angle(spot.inner_cone_angle).min(cutoff);
            LightKind::Spot { position, direction, cutoff, inner, exponent: 0.0 }
        }
        (LightType::Point | LightType::Spot, _) => LightKind::Point { position },
        (LightType::Directional, _) => LightKind::Directional { direction },
    };

    // Choose how it falls off with the distance.
    let attenuation = match (&kind, json.range) {
        (LightKind::Directional { .. }, _) => Attenuation::None,
        (_, Some(range)) if range > 0.0 && range.is_finite() => {
            Attenuation::Range { range: f64::from(range) }
        }
        _ => Attenuation::InverseSquare,
    };
    let name = json.name.clone().unwrap_or_default();
    Some(Light {
        name,
        kind,
        diffuse: color,
        specular: color,
        attenuation,
        photometric: true,
        ..Light::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ancestors_are_found() {
        // 0 - 1 - 2 and 3 alone.
        let parents = [None, Some(0), Some(1), None];
        let listed = [true, false, true, true];
        let mut known = [None; 4];
        assert!(has_listed_ancestor(2, &parents, &listed, &mut known));
        assert!(!has_listed_ancestor(0, &parents, &listed, &mut known));
        assert!(!has_listed_ancestor(3, &parents, &listed, &mut known));
        assert_eq!(
            depth_first(&[vec![2, 1], vec![], vec![3], vec![]], [0].into_iter()),
            [0, 2, 3, 1]
        );
    }
}
