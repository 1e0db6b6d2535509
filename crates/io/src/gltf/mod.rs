//! glTF 2.0, as JSON with files beside it or as one GLB.
//!
//! The way of the data: `document.rs` takes the container apart and checks every index (`untidy.rs`
//! helps it); `buffers.rs` fetches bytes; `accessor.rs` makes typed arrays of them; `geometry.rs`,
//! `mesh.rs`, `normals.rs` and `deform.rs` make meshes; `texture.rs` and `material.rs` say what
//! they look like; `node.rs`, `animation.rs` and `instances.rs` say where they are.
//!
//! In:   the file's bytes and a resolver for the files that it names. Out: a [`Scene`].
//! Cost: linear in the bytes; meshes and images are made on all workers.
//! Source: [glTF 2.0], and the extensions named in `document.rs`.

mod accessor;
mod animation;
mod block;
mod budget;
mod buffers;
mod deform;
mod document;
mod geometry;
mod instances;
mod material;
mod mesh;
mod node;
mod normals;
mod specular_glossiness;
mod texture;
mod untidy;

use crate::mesh_scene::{is_blank, nothing_to_show};
use crate::moment::Moment;
use crate::{Error, Place, Resolver};
use accessor::Source;
use buffers::Buffers;
use mesh::{Plan, Pose};
use node::Tree;
use std::sync::Arc;
use vitral_exec::Workers;
use vitral_math::DMat4;
use vitral_scene::{Node, Scene};

/// Reads a glTF or GLB file. `file` is its name, for messages.
///
/// # Errors
/// What breaks the format is [`Error::Malformed`] at a JSON path, a buffer that cannot be had
/// [`Error::Missing`], a required extension that is not read [`Error::Unsupported`]. Everything
/// else that is odd (a missing image, bad normals, an empty scene) is a warning in the scene.
pub fn load(
    bytes: &[u8],
    file: &str,
    resolver: &dyn Resolver,
    workers: &Workers,
) -> Result<Scene, Error> {
    load_at(bytes, file, resolver, workers, None)
}

/// [`load`] at a moment of an animation.
///
/// # Errors
/// As [`load`]; [`Error::Absent`] for an animation that the file does not have.
pub fn load_at(
    bytes: &[u8],
    file: &str,
    resolver: &dyn Resolver,
    workers: &Workers,
    moment: Option<&Moment>,
) -> Result<Scene, Error> {
    if bytes.is_empty() {
        return Err(Error::malformed(file, Place::File, "empty file"));
    }
    let mut document = document::parse(bytes, file)?;
    let mut warnings = std::mem::take(&mut document.warnings);
    let mut buffers = Buffers::fetch(&document, file, resolver)?;
    warnings.append(&mut buffers.warnings);
    let source = Source { root: &document.root, buffers: &buffers, file };
    let tree = Tree::read(&source, &document.far_nodes, moment, &mut warnings)?;

    // Materials first: they know which images are wanted.
    let mut wanted = texture::Wanted::default();
    let count = source.root.materials.len();
    let mut materials = (0..count)
        .map(|i| material::read(&source, i, &mut wanted, &mut warnings))
        .collect::<Result<Vec<_>, _>>()?;
    let (meshes, images) = workers
        .join(|| build_meshes(&source, &tree, workers), || wanted.load(&source, resolver, workers));
    let (poses, meshes) = meshes?;
    let textures = texture::settle(&mut materials, images, &mut warnings);

    let mut scene =
        Scene { materials, textures, animations: animation::list(&source), ..Scene::default() };
    for (mesh, told) in meshes {
        scene.meshes.push(Arc::new(mesh));
        warnings.extend(told);
    }
    add_nodes(&source, &tree, &poses, &mut scene, &mut warnings);
    instances::spread(&source, &tree, &mut scene, &mut warnings)?;
    // A scene without nodes was told before.
    let is_blank = scene.meshes.iter().all(|m| is_blank(m));
    if is_blank && !tree.shown.is_empty() {
        warnings.push(nothing_to_show(file));
    }
    scene.warnings = warnings;
    Ok(scene)
}

/// A mesh with what was odd in it.
type Built = (vitral_scene::Mesh, Vec<String>);

/// Builds every mesh that is shown, once a pose, in the order in which nodes first show them.
fn build_meshes(
    source: &Source<'_>,
    tree: &Tree,
    workers: &Workers,
) -> Result<(Vec<Pose>, Vec<Built>), Error> {
    let mut poses: Vec<Pose> = Vec::new();
    let mut used: Vec<usize> = Vec::new();
    let mut seen = std::collections::BTreeMap::new();
    for pose in tree.shown.iter().filter_map(|&n| pose_of(source, tree, n)) {
        let bits: Vec<u32> = pose.weights.iter().map(|w| w.to_bits()).collect();
        seen.entry((pose.mesh, pose.skin, bits)).or_insert_with(|| {
            used.push(pose.mesh);
            poses.push(pose);
        });
    }
    used.sort_unstable();
    used.dedup();

    // Refuse what would unfold beyond measure: first by the indices, then by the vertices that they
    // use.
    let limit = budget::unfolded_bytes(source);
    let check = |bytes: u64| {
        let what = format!("the meshes unfold into more than {limit} bytes");
        if bytes > limit { Err(Error::malformed(source.file, Place::File, what)) } else { Ok(()) }
    };
    check(used.iter().map(|&m| index_bytes(source, m)).sum())?;
    let plans = workers
        .map(used.len(), |i| Plan::new(source, used[i]))
        .into_iter()
        .collect::<Result<Vec<_>, _>>()?;
    let plan_of = |pose: &Pose| used.binary_search(&pose.mesh).map(|i| &plans[i]);
    check(poses.iter().filter_map(|p| plan_of(p).ok()).map(Plan::bytes).sum())?;

    let skins = skin_matrices(source, tree, &poses)?;
    let built = workers.map(poses.len(), |i| match plan_of(&poses[i]) {
        Ok(plan) => plan.build(source, &poses[i], poses[i].skin.map(|s| skins[s].as_slice())),
        Err(_) => Ok(Built::default()),
    });
    let mut built = built.into_iter().collect::<Result<Vec<_>, _>>()?;

    // What was odd in a mesh as such is told once, however many poses it has.
    for (&m, plan) in used.iter().zip(plans) {
        if let Some(i) = poses.iter().position(|p| p.mesh == m) {
            built[i].1.splice(0..0, plan.warnings);
        }
    }
    Ok((poses, built))
}

/// The joint matrices of every skin that is used.
fn skin_matrices(
    source: &Source<'_>,
    tree: &Tree,
    poses: &[Pose],
) -> Result<Vec<Vec<DMat4>>, Error> {
    let skins = source.root.skins.iter().enumerate();
    skins
        .map(|(s, skin)| {
            let used = poses.iter().any(|p| p.skin == Some(s));
            if used {
                deform::joint_matrices(source, skin, s, &tree.worlds)
            } else {
                Ok(Vec::new())
            }
        })
        .collect()
}

/// The mesh that a node shows, and how.
fn pose_of(source: &Source<'_>, tree: &Tree, n: usize) -> Option<Pose> {
    let node = &source.root.nodes[n];
    let mesh = node.mesh?.value();
    let at_rest = node.weights.as_ref().or(source.root.meshes[mesh].weights.as_ref());
    let weights = tree.poses.weights[n].as_ref().or(at_rest);
    let weights = weights.filter(|w| w.iter().any(|&w| w != 0.0)).cloned().unwrap_or_default();
    Some(Pose { mesh, weights, skin: node.skin.map(|s| s.value()) })
}

/// Bytes that the topology of a mesh takes at most.
fn index_bytes(source: &Source<'_>, mesh: usize) -> u64 {
    let primitives = &source.root.meshes[mesh].primitives;
    let count = |accessor: usize| source.root.accessors[accessor].count.0;
    primitives
        .iter()
        .filter_map(|p| p.indices)
        .map(|i| count(i.value()).saturating_mul(12))
        .fold(0, u64::saturating_add)
}

/// Adds the nodes that are shown, with their meshes, lights and cameras.
fn add_nodes(
    source: &Source<'_>,
    tree: &Tree,
    poses: &[Pose],
    scene: &mut Scene,
    warnings: &mut Vec<String>,
) {
    // Number the nodes that are shown, and the meshes with their poses.
    let root = source.root;
    let mut numbers = vec![0u32; root.nodes.len()];
    for (number, &n) in tree.shown.iter().enumerate() {
        numbers[n] = number as u32;
    }
    let mesh_numbers: std::collections::BTreeMap<_, _> = poses
        .iter()
        .enumerate()
        .map(|(i, p)| ((p.mesh, p.skin, weight_bits(p)), i as u32))
        .collect();

    // Convert the cameras and lights.
    let cameras: Vec<_> = root
        .cameras
        .iter()
        .enumerate()
        .map(|(i, c)| node::camera(source, c, i, warnings))
        .collect();
    let lights = AsRef::<[_]>::as_ref(root).iter().enumerate();
    let lights: Vec<_> = lights.map(|(i, l)| node::light(source, l, i, warnings)).collect();

    // Add node after node, and set skinned meshes aside.
    let mut skinned = Vec::new();
    for &n in &tree.shown {
        let json = &root.nodes[n];
        let mut node = Node {
            name: json.name.clone().unwrap_or_default(),
            transform: tree.poses.transforms[n],
            children: tree.children[n].iter().map(|&c| numbers[c]).collect(),
            ..Node::default()
        };
        if let Some(pose) = pose_of(source, tree, n) {
            let mesh = mesh_numbers.get(&(pose.mesh, pose.skin, weight_bits(&pose))).copied();
            if pose.skin.is_some() {
                skinned.push((node.name.clone(), mesh))
            } else {
                node.mesh = mesh
            }
        }
        if let Some(camera) = json.camera.and_then(|c| cameras[c.value()]) {
            scene.cameras.push(camera);
            node.camera = Some(scene.cameras.len() as u32 - 1);
        }
        let punctual = json.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
        node.light = punctual.and_then(|l| lights.get(l.light.value()).cloned().flatten());
        scene.nodes.push(node);
    }
    scene.roots = tree.roots.iter().map(|&n| numbers[n]).collect();

    // Add the skinned meshes beside the tree: they are in world space already.
    for (name, mesh) in skinned {
        scene.add_root(Node { name, mesh, ..Node::default() });
    }
}

fn weight_bits(pose: &Pose) -> Vec<u32> {
    pose.weights.iter().map(|w| w.to_bits()).collect()
}
