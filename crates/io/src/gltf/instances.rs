//! Many copies of one mesh in a node (`EXT_mesh_gpu_instancing`): the node gets a child for each,
//! all with the same mesh.
//!
//! Cost: linear in the copies. Memory: a node for each; refused where a small file would unfold
//!       into very many.
//! Source: EXT_mesh_gpu_instancing.

use super::accessor::{Integers, Source};
use super::budget::unfolded_bytes;
use super::document::INSTANCING;
use super::node::Tree;
use crate::Error;
use gltf::json::accessor::ComponentType;
use gltf::json::validation::Checked;
use serde_json::Value;
use vitral_math::{DQuat, DVec3, DVec4};
use vitral_scene::{Node, NodeTransform, Scene};

/// What places a copy in its node; other attributes are not read.
const ATTRIBUTES: [&str; 3] = ["TRANSLATION", "ROTATION", "SCALE"];

/// The accessors of [`ATTRIBUTES`].
type Accessors = [Option<usize>; 3];

/// Spreads the meshes of the scene's nodes, which begins with those of `tree.shown`, over their
/// copies.
pub(crate) fn spread(
    source: &Source<'_>,
    tree: &Tree,
    scene: &mut Scene,
    warnings: &mut Vec<String>,
) -> Result<(), Error> {
    let most = unfolded_bytes(source) / size_of::<Node>() as u64;
    let mut total = 0;
    for (number, &n) in tree.shown.iter().enumerate() {
        let path = format!("nodes[{n}].extensions.{INSTANCING}");
        let Some((accessors, count)) = find(source, n, &path)? else { continue };
        if source.root.nodes[n].skin.is_some() {
            warnings.push(format!("{}: {path}: a skinned mesh is shown once", source.file));
            continue;
        }
        let Some(mesh) = scene.nodes[number].mesh.take() else { continue };
        total += count as u64;
        if total > most {
            return Err(source.error(path, format!("more than {most} copies of meshes in all")));
        }
        let first = scene.nodes.len() as u32;
        let transforms = transforms(source, accessors, count, &path, warnings)?;
        let copy = |transform| Node { transform, mesh: Some(mesh), ..Node::default() };
        scene.nodes.extend(transforms.into_iter().map(copy));
        scene.nodes[number].children.extend(first..first + count as u32);
    }
    Ok(())
}

/// The accessors that place a node's copies, and how many these are. `None`: there are no copies.
fn find(source: &Source<'_>, node: usize, path: &str) -> Result<Option<(Accessors, usize)>, Error> {
    let extensions = source.root.nodes[node].extensions.as_ref();
    let Some(attributes) = extensions.and_then(|e| e.others.get(INSTANCING)?.get("attributes"))
    else {
        return Ok(None);
    };
    let mut accessors = [None; 3];
    let mut counted: Option<(&str, usize)> = None;
    for (accessor, name) in accessors.iter_mut().zip(ATTRIBUTES) {
        let Some(value) = attributes.get(name) else { continue };
        let path = format!("{path}.attributes.{name}");
        let index = accessor_index(source, value, name, &path)?;
        let count = source.count(index)?;
        match counted {
            Some((other, expected)) if count != expected => {
                let what = format!("accessor {index} has {count} elements, {other} has {expected}");
                return Err(source.error(path, what));
            }
            _ => counted = Some((name, count)),
        }
        *accessor = Some(index);
    }
    Ok(counted.map(|(_, count)| (accessors, count)))
}

/// An accessor of floats or, for rotations, normalised integers.
fn accessor_index(
    source: &Source<'_>,
    value: &Value,
    name: &str,
    path: &str,
) -> Result<usize, Error> {
    let index = value.as_u64().and_then(|index| usize::try_from(index).ok());
    let Some((index, accessor)) = index.and_then(|i| Some((i, source.root.accessors.get(i)?)))
    else {
        let what = format!("{value} is no accessor, there are {}", source.root.accessors.len());
        return Err(source.error(path, what));
    };
    match &accessor.component_type {
        Checked::Valid(component) if component.0 == ComponentType::F32 => Ok(index),
        Checked::Valid(component)
            if name == "ROTATION"
                && matches!(component.0, ComponentType::I8 | ComponentType::I16) =>
        {
            Ok(index)
        }
        _ => {
            let needed =
                if name == "ROTATION" { "floats or normalised signed integers" } else { "floats" };
            Err(source.error(path, format!("accessor {index} has other components than {needed}")))
        }
    }
}

/// The placement of each copy in its node.
fn transforms(
    source: &Source<'_>,
    [translations, rotations, scales]: Accessors,
    count: usize,
    path: &str,
    warnings: &mut Vec<String>,
) -> Result<Vec<NodeTransform>, Error> {
    // Read the attributes; the missing ones take their defaults.
    let translations = vectors::<3>(
        source,
        translations,
        count,
        [0.0; 3],
        &format!("{path}.attributes.TRANSLATION"),
    )?;
    let rotations = vectors::<4>(
        source,
        rotations,
        count,
        [0.0, 0.0, 0.0, 1.0],
        &format!("{path}.attributes.ROTATION"),
    )?;
    let scales =
        vectors::<3>(source, scales, count, [1.0; 3], &format!("{path}.attributes.SCALE"))?;

    // Combine them to the placement of each copy, without a rotation where it is zero.
    let mut zeros = 0;
    let transforms = translations.into_iter().zip(rotations).zip(scales).map(|((t, r), s)| {
        let unit = DVec4::from_array(r.map(f64::from)).try_normalize().unwrap_or_else(|| {
            zeros += 1;
            DVec4::W
        });
        NodeTransform::Parts {
            translation: DVec3::from_array(t.map(f64::from)),
            rotation: DQuat::from_vec4(unit),
            scale: DVec3::from_array(s.map(f64::from)),
        }
    });
    let transforms = transforms.collect();

    // Warn of all zero rotations at once.
    if zeros > 0 {
        warnings.push(format!(
            "{}: {path}: {zeros} of {count} rotations are zero, none is used there",
            source.file
        ));
    }
    Ok(transforms)
}

/// The vectors of an attribute, or `count` times its default. Numbers must be finite.
fn vectors<const N: usize>(
    source: &Source<'_>,
    accessor: Option<usize>,
    count: usize,
    default: [f32; N],
    path: &str,
) -> Result<Vec<[f32; N]>, Error> {
    let Some(accessor) = accessor else { return Ok(vec![default; count]) };
    let values = source.floats::<N>(accessor, 0..count, Integers::Normalized, path)?;
    match values.iter().position(|v| !v.iter().all(|c| c.is_finite())) {
        Some(k) => {
            Err(source.error(path, format!("element {k} of accessor {accessor} is not finite")))
        }
        None => Ok(values),
    }
}
