//! Scenes as bytes, for pickling.

use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::sync::Arc;
use vitral::internals::scene::{Animation, FreePart};
use vitral::{
    Attribute, Axis, Camera, DMat4, Encoding, Faces, Light, Material, Mesh, Node, NodeTransform,
    Part, Plane, Scene, Texture,
};

/// The version of the form.
const VERSION: u32 = 2;

#[derive(Serialize, Deserialize)]
struct Saved {
    version: u32,
    meshes: Vec<SavedMesh>,
    materials: Vec<Material>,
    textures: Vec<SavedTexture>,
    nodes: Vec<SavedNode>,
    roots: Vec<u32>,
    lights: Vec<Light>,
    cameras: Vec<Camera>,
    own_camera: Option<u32>,
    ambient: [f32; 3],
    ups: Vec<String>,
    warnings: Vec<String>,
    /// Names, and ends in seconds.
    animations: Vec<(String, f64)>,
}

type Values<T> = (Vec<T>, Option<Vec<[u32; 3]>>);
type Runs = Vec<(Range<u32>, Option<u32>)>;

#[derive(Serialize, Deserialize)]
struct SavedMesh {
    name: String,
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    polygons: Option<(Vec<u32>, Vec<u32>)>,
    parts: Vec<(String, Range<u32>, Option<u32>)>,
    normals: Option<Values<[f32; 3]>>,
    normals_stay: bool,
    tangents: Option<Values<[f32; 4]>>,
    uvs: Vec<Values<[f32; 2]>>,
    colors: Option<Values<[f32; 4]>>,
    colors_from_srgb: bool,
    lines: Vec<[u32; 2]>,
    points: Vec<u32>,
    line_parts: Runs,
    point_parts: Runs,
    smoothing_groups: Option<Vec<u32>>,
}

#[derive(Serialize, Deserialize)]
struct SavedTexture {
    name: String,
    size: [u32; 2],
    bytes: Vec<[u8; 4]>,
    encoding: Encoding,
}

#[derive(Serialize, Deserialize)]
struct SavedNode {
    name: String,
    matrix: [f64; 16],
    children: Vec<u32>,
    mesh: Option<u32>,
    light: Option<Light>,
    camera: Option<u32>,
}

fn taken<T: Clone>(attribute: &Attribute<T>) -> Values<T> {
    (attribute.values.clone(), attribute.corners.clone())
}

fn given<T>((values, corners): Values<T>) -> Attribute<T> {
    Attribute { values, corners }
}

fn runs(parts: &[FreePart]) -> Runs {
    parts.iter().map(|part| (part.elements.clone(), part.material)).collect()
}

fn free_parts(runs: Runs) -> Vec<FreePart> {
    runs.into_iter().map(|(elements, material)| FreePart { elements, material }).collect()
}

impl SavedMesh {
    fn of(mesh: &Mesh) -> Self {
        Self {
            name: mesh.name.clone(),
            positions: mesh.positions.clone(),
            triangles: mesh.triangles.clone(),
            polygons: match &mesh.faces {
                Faces::Triangles => None,
                Faces::Polygons { starts, corners } => Some((starts.clone(), corners.clone())),
            },
            parts: mesh
                .parts
                .iter()
                .map(|p| (p.name.clone(), p.triangles.clone(), p.material))
                .collect(),
            normals: mesh.normals.as_ref().map(taken),
            normals_stay: mesh.normals_stay,
            tangents: mesh.tangents.as_ref().map(taken),
            uvs: mesh.uvs.iter().map(taken).collect(),
            colors: mesh.colors.as_ref().map(taken),
            colors_from_srgb: mesh.colors_from_srgb,
            lines: mesh.lines.clone(),
            points: mesh.points.clone(),
            line_parts: runs(&mesh.line_parts),
            point_parts: runs(&mesh.point_parts),
            smoothing_groups: mesh.smoothing_groups.clone(),
        }
    }

    fn mesh(self) -> Mesh {
        let faces = self.polygons.map(|(starts, corners)| Faces::Polygons { starts, corners });
        let part = |(name, triangles, material)| Part { name, triangles, material };
        Mesh {
            name: self.name,
            positions: self.positions,
            triangles: self.triangles,
            faces: faces.unwrap_or_default(),
            parts: self.parts.into_iter().map(part).collect(),
            normals: self.normals.map(given),
            normals_stay: self.normals_stay,
            tangents: self.tangents.map(given),
            uvs: self.uvs.into_iter().map(given).collect(),
            colors: self.colors.map(given),
            colors_from_srgb: self.colors_from_srgb,
            lines: self.lines,
            points: self.points,
            line_parts: free_parts(self.line_parts),
            point_parts: free_parts(self.point_parts),
            smoothing_groups: self.smoothing_groups,
            ..Mesh::default()
        }
    }
}

impl SavedTexture {
    fn of(texture: &Texture) -> Option<Self> {
        let base = texture.levels.first()?;
        let (name, size) = (texture.name.clone(), [base.width(), base.height()]);
        Some(Self { name, size, bytes: base.data().to_vec(), encoding: texture.encoding })
    }

    fn texture(self) -> Option<Texture> {
        Some(Texture::new(
            self.name,
            Plane::from_rows(self.size[0], self.size[1], self.bytes)?,
            self.encoding,
        ))
    }
}

impl SavedNode {
    fn of(node: &Node) -> Self {
        Self {
            name: node.name.clone(),
            matrix: node.transform.matrix().to_cols_array(),
            children: node.children.clone(),
            mesh: node.mesh,
            light: node.light.clone(),
            camera: node.camera,
        }
    }

    fn node(self) -> Node {
        let transform = NodeTransform::Matrix(DMat4::from_cols_array(&self.matrix));
        let Self { name, children, mesh, light, camera, .. } = self;
        Node { name, transform, children, mesh, light, camera }
    }
}

/// The scene as bytes.
pub(crate) fn bytes(scene: &Scene) -> Result<Vec<u8>, String> {
    let saved = Saved {
        version: VERSION,
        meshes: scene.meshes.iter().map(|mesh| SavedMesh::of(mesh)).collect(),
        materials: scene.materials.clone(),
        textures: scene.textures.iter().filter_map(|texture| SavedTexture::of(texture)).collect(),
        nodes: scene.nodes.iter().map(SavedNode::of).collect(),
        roots: scene.roots.clone(),
        lights: scene.lights.clone(),
        cameras: scene.cameras.clone(),
        own_camera: scene.own_camera,
        ambient: scene.ambient,
        ups: scene.ups.iter().map(Axis::to_string).collect(),
        warnings: scene.warnings.clone(),
        animations: scene
            .animations
            .iter()
            .map(|animation| (animation.name.clone(), animation.seconds))
            .collect(),
    };
    rmp_serde::to_vec_named(&saved).map_err(|e| e.to_string())
}

/// The scene that the bytes hold.
pub(crate) fn scene(bytes: &[u8]) -> Result<Scene, String> {
    let saved: Saved = rmp_serde::from_slice(bytes).map_err(|e| e.to_string())?;
    if saved.version != VERSION {
        return Err(format!("version {} is not known, only {VERSION}", saved.version));
    }
    let texture = |texture: SavedTexture| {
        texture.texture().map(Arc::new).ok_or("a texture of the wrong size")
    };
    Ok(Scene {
        meshes: saved.meshes.into_iter().map(|mesh| Arc::new(mesh.mesh())).collect(),
        materials: saved.materials,
        textures: saved.textures.into_iter().map(texture).collect::<Result<_, _>>()?,
        nodes: saved.nodes.into_iter().map(SavedNode::node).collect(),
        roots: saved.roots,
        lights: saved.lights,
        cameras: saved.cameras,
        own_camera: saved.own_camera,
        ambient: saved.ambient,
        ups: saved.ups.iter().filter_map(|up| up.parse().ok()).collect(),
        warnings: saved.warnings,
        animations: saved
            .animations
            .into_iter()
            .map(|(name, seconds)| Animation { name, seconds })
            .collect(),
    })
}
