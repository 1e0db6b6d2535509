//! From the scene file's form to a scene.
//!
//! Meshes, materials and textures come first. Then the nodes; a node whose mesh is a reference gets
//! the nodes of that model as children, each time it is used a copy of the nodes, never of the
//! meshes.

use super::form::{self, MeshForm, NodeForm, TextureForm};
use super::mesh;
use super::reference::{Origin, Reference};
use crate::uri::{self, Target};
use crate::{Error, Place, image};
use std::ops::Range;
use std::sync::Arc;
use vitral_frame::Texture;
use vitral_math::{DMat4, DQuat, DVec3, DVec4};
use vitral_scene::{Axis, Camera, Node, NodeTransform, Projection, Scene};

/// Most nodes, meshes, materials, textures or cameras of a scene.
const MAX_ENTRIES: usize = 1 << 20;

/// What an entry of `meshes` became.
enum Entry {
    /// A mesh of the scene.
    Mesh(u32),
    /// A model that nodes bring in.
    Model(Model),
}

/// A model that is named in `meshes`.
struct Model {
    scene: Arc<Scene>,
    /// Material for all of it.
    material: Option<u32>,
    /// Its nodes and its roots in the scene, once it has been brought in.
    placed: Option<(Range<u32>, Vec<u32>)>,
}

/// Errors of one file.
struct Report<'a> {
    file: &'a str,
}

impl Report<'_> {
    fn at(&self, path: impl Into<String>, what: impl Into<String>) -> Error {
        Error::malformed(self.file, Place::Json(path.into()), what)
    }

    /// An index into `count` things.
    fn index(
        &self,
        path: impl Into<String>,
        what: &str,
        index: u32,
        count: usize,
    ) -> Result<(), Error> {
        if (index as usize) < count {
            Ok(())
        } else {
            Err(self.at(path, format!("{what} {index}, there are {count}")))
        }
    }
}

/// Reads a scene file that stands at `origin`.
pub(super) fn read(bytes: &[u8], file: &str, origin: &Origin<'_>) -> Result<Scene, Error> {
    let form = form::parse(bytes, file)?;
    let report = Report { file };
    let lights = form.lights.into_iter().map(Into::into).collect();
    let mut scene =
        Scene { lights, cameras: form.cameras, ambient: form.ambient, ..Scene::default() };
    for (i, light) in scene.lights.iter().enumerate() {
        light.check().map_err(|what| report.at(format!("lights[{i}]"), what))?;
    }
    if !form.ambient.iter().all(|&channel| channel >= 0.0) {
        return Err(report.at("ambient", "intensities of at least 0 are required"));
    }
    for (i, camera) in scene.cameras.iter().enumerate() {
        check_camera(camera, &format!("cameras[{i}]"), &report)?;
    }
    let own_camera = (scene.cameras.len() == 1).then_some(0);
    let places = add_textures(form.textures, &mut scene, &report, origin)?;
    scene.materials = form.materials;
    settle_materials(&mut scene, &places, &report)?;
    let mut entries = add_meshes(form.meshes, &mut scene, &report, origin)?;

    // Without a list of nodes every mesh is shown once, where it is.
    let nodes = form.nodes.unwrap_or_else(|| {
        (0..entries.len() as u32)
            .map(|m| NodeForm { mesh: Some(m), ..NodeForm::default() })
            .collect()
    });
    let used = add_nodes(nodes, form.roots, &mut scene, &entries, &report)?;
    place_free_cameras(&mut scene);
    for (node, entry) in used {
        if let Entry::Model(model) = &mut entries[entry] {
            let children = place(model, &mut scene, &report)?;
            scene.nodes[node].children.extend(children);
        }
    }
    if scene.ups.is_empty() {
        scene.ups.push(Axis::PlusY);
    }
    // Models that nodes brought in have cameras, too.
    scene.own_camera = own_camera;
    Ok(scene)
}

/// A camera needs an angle or a height, and planes in order.
fn check_camera(camera: &Camera, path: &str, report: &Report<'_>) -> Result<(), Error> {
    let (lens, field) = match camera.projection {
        Projection::Perspective { view_angle } => {
            (view_angle > 0.0 && view_angle < std::f64::consts::PI, "0 < view-angle < 3.14159")
        }
        Projection::Parallel { height } => (height > 0.0, "0 < height"),
        Projection::Window { across, upwards } => (
            across[0] < across[1] && upwards[0] < upwards[1],
            "across and upwards from the smaller to the larger border",
        ),
    };
    if !lens {
        return Err(report.at(format!("{path}.projection"), format!("{field} is needed")));
    }
    let perspective = !matches!(camera.projection, Projection::Parallel { .. });
    match camera.clip {
        Some((near, far)) if near >= far || (perspective && near <= 0.0) => Err(report
            .at(format!("{path}.clip"), "near < far is needed, and 0 < near for a perspective")),
        _ => Ok(()),
    }
}

/// A name for messages and the bytes of an image file, or why there are none.
type ImageFile = (String, Result<Vec<u8>, String>);

/// The image file of texture `i`.
fn image_file(
    i: usize,
    form: &TextureForm,
    report: &Report<'_>,
    origin: &Origin<'_>,
) -> Result<ImageFile, Error> {
    match (&form.file, &form.data) {
        (Some(file), None) => Ok((file.clone(), origin.read(file).map_err(|e| e.to_string()))),
        (None, Some(data)) => match uri::resolve(data) {
            Ok(Target::Inline(bytes)) => Ok((format!("texture {i}"), Ok(bytes))),
            Ok(Target::File(_)) => {
                Err(report.at(format!("textures[{i}].data"), "this is no data URI"))
            }
            Err(what) => Err(report.at(format!("textures[{i}].data"), what)),
        },
        _ => Err(report.at(format!("textures[{i}]"), "either `file` or `data` is needed")),
    }
}

/// Reads all textures at once. Gives each entry's index in the scene; an image that cannot be had
/// is a warning.
fn add_textures(
    forms: Vec<TextureForm>,
    scene: &mut Scene,
    report: &Report<'_>,
    origin: &Origin<'_>,
) -> Result<Vec<Option<u32>>, Error> {
    let sources = forms.iter().enumerate().map(|(i, form)| image_file(i, form, report, origin));
    let sources = sources.collect::<Result<Vec<_>, _>>()?;
    let loaded = origin.workers.map(forms.len(), |i| {
        let (source, bytes) = &sources[i];
        let bytes = bytes.as_ref().map_err(String::clone)?;
        let (plane, odd) = image::decode_texture(bytes, source).map_err(|e| e.to_string())?;
        let name = forms[i].name.clone().unwrap_or_else(|| source.clone());
        Ok::<_, String>((Texture::new(name, plane, forms[i].encoding), odd))
    });
    let mut places = Vec::with_capacity(loaded.len());
    for (i, texture) in loaded.into_iter().enumerate() {
        match texture {
            Ok((texture, odd)) => {
                scene
                    .warnings
                    .extend(odd.map(|what| format!("{}: textures[{i}]: {what}", report.file)));
                places.push(Some(scene.textures.len() as u32));
                scene.textures.push(Arc::new(texture));
            }
            Err(why) => {
                places.push(None);
                let name = &sources[i].0;
                scene
                    .warnings
                    .push(format!("{}: textures[{i}]: `{name}` is left out: {why}", report.file));
            }
        }
    }
    Ok(places)
}

/// Checks the materials and gives their textures the final numbers.
fn settle_materials(
    scene: &mut Scene,
    places: &[Option<u32>],
    report: &Report<'_>,
) -> Result<(), Error> {
    for (i, material) in scene.materials.iter_mut().enumerate() {
        let path = format!("materials[{i}]");
        material
            .check()
            .map_err(|what| report.at(path.as_str(), format!("`{}`: {what}", material.name)))?;
        for texture in material.textures_mut() {
            report.index(path.as_str(), "texture", texture.texture, places.len())?;
            if texture.uv_set > 1 {
                return Err(
                    report.at(path, format!("uv-set {}, there are 0 and 1", texture.uv_set))
                );
            }
        }
        for slot in material.texture_slots_mut() {
            *slot = slot.and_then(|mut r| {
                r.texture = places[r.texture as usize]?;
                Some(r)
            });
        }
    }
    Ok(())
}

/// Makes meshes of inline entries and loads the models that the others name.
fn add_meshes(
    forms: Vec<MeshForm>,
    scene: &mut Scene,
    report: &Report<'_>,
    origin: &Origin<'_>,
) -> Result<Vec<Entry>, Error> {
    let mut entries = Vec::with_capacity(forms.len());
    for (i, form) in forms.into_iter().enumerate() {
        let path = format!("meshes[{i}]");

        // Check the materials that the entry names.
        let materials = scene.materials.len();
        let parts = form.parts.iter().flatten().filter_map(|p| p.material);
        let free = [&form.line_parts, &form.point_parts]
            .into_iter()
            .flatten()
            .flatten()
            .filter_map(|p| p.material);
        for material in parts.chain(free).chain(form.material).chain(form.line_material) {
            report.index(path.as_str(), "material", material, materials)?;
        }

        // Make the mesh of an inline entry, or load the model that the entry names.
        let inline = !form.positions.is_empty()
            || form.faces.is_some()
            || form.triangles.is_some()
            || form.parts.is_some();
        let model = match (&form.file, &form.builtin) {
            (Some(_), Some(_)) => return Err(report.at(path, "either `file` or `builtin`")),
            (Some(_), None) | (None, Some(_)) if inline => {
                return Err(report.at(path, "a reference has no arrays of its own"));
            }
            (Some(file), None) => referenced(origin, file, report.file, &Place::Json(path))?,
            (None, Some(name)) => origin.builtin(name, report.file, Place::Json(path))?,
            (None, None) => {
                let mesh =
                    mesh::from_form(form, origin.workers).map_err(|what| report.at(path, what))?;
                scene.meshes.push(Arc::new(mesh));
                entries.push(Entry::Mesh(scene.meshes.len() as u32 - 1));
                continue;
            }
        };
        entries.push(Entry::Model(Model { scene: model, material: form.material, placed: None }));
    }
    Ok(entries)
}

/// The scene of the model or scene file `path`, which `file` names at `place`.
fn referenced(
    origin: &Origin<'_>,
    path: &str,
    file: &str,
    place: &Place,
) -> Result<Arc<Scene>, Error> {
    match origin.model(path, file, place)? {
        Reference::Scene(scene) => Ok(scene),
        Reference::SceneFile { bytes, path, origin } => {
            let scene = read(&bytes, &path, &origin)?;
            Ok(origin.keep(path, scene))
        }
    }
}

/// Adds the nodes; gives those that show a model, with its entry.
fn add_nodes(
    forms: Vec<NodeForm>,
    roots: Option<Vec<u32>>,
    scene: &mut Scene,
    entries: &[Entry],
    report: &Report<'_>,
) -> Result<Vec<(usize, usize)>, Error> {
    // Check the tree, and find its roots.
    if forms.len() > MAX_ENTRIES {
        return Err(
            report.at("nodes", format!("{} nodes, at most {MAX_ENTRIES} are read", forms.len()))
        );
    }
    let has_parent = check_tree(&forms, report)?;
    let roots = roots
        .unwrap_or_else(|| (0..forms.len() as u32).filter(|&n| !has_parent[n as usize]).collect());
    check_roots(&roots, has_parent, report)?;
    scene.roots = roots;

    // Add node after node, and note those that show a model.
    let mut models = Vec::new();
    for (i, form) in forms.into_iter().enumerate() {
        let path = format!("nodes[{i}]");
        let transform = transform(&form).map_err(|what| report.at(path.as_str(), what))?;
        let unlit = form.light.as_ref().and_then(|light| light.check().err());
        unlit.map_or(Ok(()), |what| Err(report.at(format!("{path}.light"), what)))?;
        let mut node = Node {
            name: form.name,
            transform,
            children: form.children,
            light: form.light,
            ..Node::default()
        };

        // Attach the camera, and the mesh unless the entry is a model.
        if let Some(camera) = form.camera {
            report.index(format!("{path}.camera"), "camera", camera, scene.cameras.len())?;
            node.camera = Some(camera);
        }
        if let Some(mesh) = form.mesh {
            report.index(format!("{path}.mesh"), "mesh", mesh, entries.len())?;
            match entries[mesh as usize] {
                Entry::Mesh(index) => node.mesh = Some(index),
                Entry::Model(_) => models.push((i, mesh as usize)),
            }
        }
        scene.nodes.push(node);
    }
    Ok(models)
}

/// Checks that every root is a node, without a parent, and listed once.
fn check_roots(roots: &[u32], mut in_tree: Vec<bool>, report: &Report<'_>) -> Result<(), Error> {
    for (k, &root) in roots.iter().enumerate() {
        let path = format!("roots[{k}]");
        report.index(path.as_str(), "node", root, in_tree.len())?;
        if std::mem::replace(&mut in_tree[root as usize], true) {
            return Err(report.at(path, format!("node {root} is in the tree already")));
        }
    }
    Ok(())
}

/// Cameras that no node names stand in the world as they are.
fn place_free_cameras(scene: &mut Scene) {
    let mut named = vec![false; scene.cameras.len()];
    scene.nodes.iter().filter_map(|n| n.camera).for_each(|c| named[c as usize] = true);
    for free in (0..named.len()).filter(|&c| !named[c]) {
        scene.add_root(Node { camera: Some(free as u32), ..Node::default() });
    }
}

/// Checks that no node has two parents or is its own ancestor; tells which ones have a parent.
fn check_tree(forms: &[NodeForm], report: &Report<'_>) -> Result<Vec<bool>, Error> {
    let mut has_parent = vec![false; forms.len()];
    for (i, form) in forms.iter().enumerate() {
        for (k, &child) in form.children.iter().enumerate() {
            let path = format!("nodes[{i}].children[{k}]");
            report.index(path.as_str(), "node", child, forms.len())?;
            if std::mem::replace(&mut has_parent[child as usize], true) {
                return Err(report.at(path, format!("node {child} has a parent already")));
            }
        }
    }
    // Whoever is not reached from a node without parent lies on a cycle.
    let mut stack: Vec<usize> = (0..forms.len()).filter(|&n| !has_parent[n]).collect();
    let mut reached = vec![false; forms.len()];
    while let Some(n) = stack.pop() {
        reached[n] = true;
        stack.extend(forms[n].children.iter().map(|&c| c as usize));
    }
    match reached.iter().position(|r| !r) {
        Some(n) => Err(report.at(format!("nodes[{n}]"), "the node is its own ancestor")),
        None => Ok(has_parent),
    }
}

/// A node's placement: a matrix, or translation, rotation and scale.
fn transform(form: &NodeForm) -> Result<NodeTransform, String> {
    let parts = form.translation.is_some() || form.rotation.is_some() || form.scale.is_some();
    match form.matrix {
        Some(_) if parts => Err("either `matrix` or `translation`, `rotation`, `scale`".to_owned()),
        Some(columns) => {
            let matrix = DMat4::from_cols_array(&columns);
            if matrix.row(3) == DVec4::W {
                Ok(NodeTransform::Matrix(matrix))
            } else {
                Err("the matrix, column by column, needs 0 0 0 1 as its last row".to_owned())
            }
        }
        None if parts => {
            let rotation = DVec4::from_array(form.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
            // What is unit already keeps its digits.
            let unit = (rotation.length_squared() - 1.0).abs() < 1e-9;
            let rotation = if unit { Some(rotation) } else { rotation.try_normalize() };
            Ok(NodeTransform::Parts {
                translation: DVec3::from_array(form.translation.unwrap_or_default()),
                rotation: DQuat::from_vec4(
                    rotation.ok_or("the rotation, a quaternion x y z w, is zero")?,
                ),
                scale: DVec3::from_array(form.scale.unwrap_or([1.0; 3])),
            })
        }
        None => Ok(NodeTransform::default()),
    }
}

/// Brings a model in, the first time with all it has, later as copies of its nodes. Gives the roots
/// of this copy.
fn place(model: &mut Model, scene: &mut Scene, report: &Report<'_>) -> Result<Vec<u32>, Error> {
    let (was, more) = (sizes(scene), sizes(&model.scene));
    let total = |k: usize| was[k] + more[k];
    if (0..was.len()).any(|k| total(k) > MAX_ENTRIES) {
        let what = format!(
            "with all references there are more than {MAX_ENTRIES} nodes, meshes, materials, textures or cameras"
        );
        return Err(report.at("meshes", what));
    }
    if let Some((nodes, roots)) = &model.placed {
        let shift = scene.nodes.len() as u32 - nodes.start;
        for n in nodes.clone() {
            let mut node = scene.nodes[n as usize].clone();
            node.children.iter_mut().for_each(|c| *c += shift);
            scene.nodes.push(node);
        }
        return Ok(roots.iter().map(|r| r + shift).collect());
    }

    // Lights of the model as a whole become nodes, so that they are placed with it.
    let mut incoming = Scene::clone(&model.scene);
    for light in std::mem::take(&mut incoming.lights) {
        incoming.add_root(Node { name: light.name.clone(), light: Some(light), ..Node::default() });
    }
    let (first_node, first_root, first_mesh) =
        (scene.nodes.len(), scene.roots.len(), scene.meshes.len());
    scene.append(incoming);
    if let Some(material) = model.material {
        for mesh in &mut scene.meshes[first_mesh..] {
            let mesh = Arc::make_mut(mesh);
            mesh.parts.iter_mut().for_each(|p| p.material = Some(material));
            let free = mesh.line_parts.iter_mut().chain(&mut mesh.point_parts);
            free.for_each(|p| p.material = p.material.map(|_| material));
        }
    }
    let roots = scene.roots.split_off(first_root);
    model.placed = Some((first_node as u32..scene.nodes.len() as u32, roots.clone()));
    Ok(roots)
}

fn sizes(scene: &Scene) -> [usize; 5] {
    let nodes = scene.nodes.len() + scene.lights.len();
    [nodes, scene.meshes.len(), scene.materials.len(), scene.textures.len(), scene.cameras.len()]
}
