//! What is in a scene: sizes, materials, lights, cameras, and whether its surfaces are closed.

mod lights;

use serde::Serialize;
use std::fmt;
use vitral_exec::Workers;
use vitral_light::{AlphaMode, Material, Reflectance};
use vitral_math::{Aabb, DVec3};
use vitral_scene::{Instance, LightMeter, Mesh, Node, Scene, Topology, World};

pub use lights::{CameraInfo, LightInfo};

/// A scene in numbers. Meshes are counted once, however many instances they have, except where it
/// says otherwise.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Info {
    /// Nodes of the scene graph.
    pub nodes: usize,
    /// Meshes at places.
    pub instances: usize,
    /// Faces as in the file, of all instances.
    pub faces: u64,
    /// Triangles of all instances.
    pub triangles: u64,
    /// Vertices of all meshes.
    pub vertices: u64,
    /// Free line segments of all meshes.
    pub lines: u64,
    /// Free points of all meshes.
    pub points: u64,
    /// The box round everything, world space; none for an empty scene.
    pub bounds: Option<Bounds>,
    /// Every mesh with triangles is closed, and there is one.
    pub closed: bool,
    /// The meshes.
    pub meshes: Vec<MeshInfo>,
    /// The materials.
    pub materials: Vec<MaterialInfo>,
    /// The textures.
    pub textures: Vec<TextureInfo>,
    /// The lights, world space.
    pub lights: Vec<LightInfo>,
    /// The factor of photometric lights in a picture without further ambient light; 1 without such
    /// lights.
    pub exposure: f32,
    /// The scene has no light at all: a picture is lit by default ones.
    pub default_lights: bool,
    /// The cameras.
    pub cameras: Vec<CameraInfo>,
    /// The animations, which `--animation` takes by number or name.
    pub animations: Vec<AnimationInfo>,
    /// Global ambient light.
    pub ambient: [f32; 3],
    /// What was odd in the files.
    pub warnings: Vec<String>,
}

/// A box.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Bounds {
    /// The corner with the smallest coordinates.
    pub min: [f64; 3],
    /// The corner with the largest coordinates.
    pub max: [f64; 3],
}

impl Bounds {
    fn of(bounds: &Aabb) -> Option<Self> {
        (!bounds.is_empty())
            .then(|| Self { min: bounds.min.to_array(), max: bounds.max.to_array() })
    }
}

/// A mesh in numbers. Edges are counted after equal positions are welded.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct MeshInfo {
    /// Its name; may be empty.
    pub name: String,
    /// How often it is shown.
    pub instances: usize,
    /// Faces as in the file.
    pub faces: usize,
    /// Triangles of the mesh.
    pub triangles: usize,
    /// Vertices as in the file.
    pub vertices: usize,
    /// Vertices at different places that triangles use.
    pub distinct_vertices: usize,
    /// Free line segments.
    pub lines: usize,
    /// Free points.
    pub points: usize,
    /// Runs of faces with one material.
    pub parts: usize,
    /// It has normals (of the file, or made after loading).
    pub normals: bool,
    /// Sets of texture coordinates.
    pub texture_coordinate_sets: usize,
    /// It has vertex colours.
    pub colors: bool,
    /// The box round it, model space.
    pub bounds: Option<Bounds>,
    /// Every edge has exactly two triangles.
    pub closed: bool,
    /// Neighbours agree about which side is outside.
    pub consistent_winding: bool,
    /// Edges of triangles.
    pub edges: usize,
    /// Edges with one triangle.
    pub boundary_edges: usize,
    /// Edges with more than two triangles.
    pub non_manifold_edges: usize,
    /// Edges at which neighbours disagree about which side is outside.
    pub inconsistent_edges: usize,
    /// Triangles without area.
    pub degenerate_triangles: usize,
    /// Triangles that repeat another one.
    pub duplicate_triangles: usize,
    /// Sets of connected triangles.
    pub bodies: usize,
    /// Vertices with a coordinate that is NaN or infinite: what uses them is not drawn.
    pub non_finite_vertices: usize,
}

impl MeshInfo {
    fn of(mesh: &Mesh, instances: usize, workers: &Workers) -> Self {
        let topology = Topology::of(mesh, workers);
        Self {
            name: mesh.name.clone(),
            instances,
            faces: mesh.face_count(),
            triangles: mesh.triangles.len(),
            vertices: mesh.positions.len(),
            distinct_vertices: topology.vertices,
            lines: mesh.lines.len(),
            points: mesh.points.len(),
            parts: mesh.parts.len(),
            normals: mesh.normals.is_some(),
            texture_coordinate_sets: mesh.uvs.len(),
            colors: mesh.colors.is_some(),
            bounds: Bounds::of(&mesh.bounds()),
            closed: topology.closed,
            consistent_winding: topology.is_consistent(),
            edges: topology.edges,
            boundary_edges: topology.boundary_edges,
            non_manifold_edges: topology.non_manifold_edges,
            inconsistent_edges: topology.inconsistent_edges,
            degenerate_triangles: topology.degenerate_triangles,
            duplicate_triangles: topology.duplicate_triangles,
            bodies: topology.components,
            non_finite_vertices: mesh
                .positions
                .iter()
                .filter(|p| p.iter().any(|c| !c.is_finite()))
                .count(),
        }
    }
}

/// A material in a line.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct MaterialInfo {
    /// Its name; may be empty.
    pub name: String,
    /// `phong` or `metallic-roughness`: the form of its coefficients.
    pub form: &'static str,
    /// Diffuse or base colour.
    pub color: [f32; 3],
    /// 1 opaque, 0 invisible.
    pub opacity: f32,
    /// `opaque`, `mask` or `blend`.
    pub alpha_mode: &'static str,
    /// Number of textures.
    pub textures: usize,
}

impl MaterialInfo {
    fn of(material: &Material) -> Self {
        let (form, color) = match material.reflectance {
            Reflectance::Phong { kd, .. } => ("phong", kd),
            Reflectance::MetallicRoughness { base_color, .. } => ("metallic-roughness", base_color),
        };
        Self {
            name: material.name.clone(),
            form,
            color,
            opacity: material.opacity,
            alpha_mode: match material.alpha_mode {
                AlphaMode::Opaque => "opaque",
                AlphaMode::Mask { .. } => "mask",
                AlphaMode::Blend => "blend",
            },
            textures: material.clone().textures_mut().count(),
        }
    }
}

/// A texture in a line.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct TextureInfo {
    /// Where it came from.
    pub name: String,
    /// Texels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// An animation in a line.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct AnimationInfo {
    /// Its name, or its kind and number.
    pub name: String,
    /// When it ends, seconds.
    pub duration: f64,
}

/// Counts what is in a scene.
///
/// # Errors
/// A mesh or a scene graph that is not sound.
pub fn info(scene: &Scene) -> Result<Info, crate::Error> {
    info_on(scene, &Workers::new(0))
}

/// [`info`] on these threads.
///
/// # Errors
/// As [`info`].
pub fn info_on(scene: &Scene, workers: &Workers) -> Result<Info, crate::Error> {
    let sound = scene.meshes.iter().try_for_each(|mesh| mesh.check_with(workers));
    sound.map_err(vitral_render::Error::Scene)?;
    let world = World::with_workers(scene, workers).map_err(vitral_render::Error::from)?;
    let shown =
        |index: usize| world.instances.iter().filter(|i| i.mesh_index as usize == index).count();
    let mesh =
        |(index, mesh): (usize, &std::sync::Arc<Mesh>)| MeshInfo::of(mesh, shown(index), workers);
    let meshes: Vec<MeshInfo> = scene.meshes.iter().enumerate().map(mesh).collect();
    let solid = |m: &&MeshInfo| m.triangles > 0;
    let sum = |count: fn(&MeshInfo) -> usize| meshes.iter().map(|m| count(m) as u64).sum();
    Ok(Info {
        nodes: scene.nodes.len(),
        instances: world.instances.len(),
        faces: u64::from(world.surface_count),
        triangles: u64::from(world.facet_count),
        vertices: sum(|m| m.vertices),
        lines: sum(|m| m.lines),
        points: sum(|m| m.points),
        bounds: Bounds::of(&bounds(&world)),
        closed: meshes.iter().any(|m| m.triangles > 0)
            && meshes.iter().filter(solid).all(|m| m.closed),
        materials: scene.materials.iter().map(MaterialInfo::of).collect(),
        textures: scene.textures.iter().map(|t| texture_info(t)).collect(),
        lights: world.lights.iter().map(LightInfo::of).collect(),
        exposure: LightMeter::read(&world).exposure(scene.ambient),
        default_lights: world.lights.is_empty() && scene.ambient == [0.0; 3],
        cameras: world.cameras.iter().map(CameraInfo::of).collect(),
        animations: scene.animations.iter().map(animation_info).collect(),
        ambient: scene.ambient,
        warnings: warnings(scene, &meshes),
        meshes,
    })
}

/// The box round all that is seen, world space. An instance's own box is a mesh's box as it lies in
/// the world, which is larger where the mesh is turned: such meshes are gone through.
fn bounds(world: &World) -> Aabb {
    let seen = |instance: &Instance| {
        let matrix = &instance.world_from_model;
        let is_turned = (0..3).any(|k| {
            [matrix.x_axis, matrix.y_axis, matrix.z_axis].iter().filter(|c| c[k] != 0.0).count() > 1
        });
        if !is_turned {
            return instance.bounds;
        }
        let mesh = &instance.mesh;
        let used = mesh
            .triangles
            .as_flattened()
            .iter()
            .chain(mesh.lines.as_flattened())
            .chain(&mesh.points);
        let positions = used.filter_map(|&i| mesh.positions.get(i as usize));
        let positions =
            positions.map(|p| DVec3::from_array(p.map(f64::from))).filter(|p| p.is_finite());
        Aabb::from_points(positions.map(|p| matrix.transform_point3(p)))
    };
    world.instances.iter().map(seen).fold(Aabb::EMPTY, |all, one| all.union(&one))
}

fn animation_info(animation: &vitral_scene::Animation) -> AnimationInfo {
    AnimationInfo { name: animation.name.clone(), duration: animation.seconds }
}

fn texture_info(texture: &vitral_frame::Texture) -> TextureInfo {
    let (width, height) = texture.levels.first().map_or((0, 0), |l| (l.width(), l.height()));
    TextureInfo { name: texture.name.clone(), width, height }
}

/// The loader's warnings, and what the numbers say.
fn warnings(scene: &Scene, meshes: &[MeshInfo]) -> Vec<String> {
    let mut warnings = scene.warnings.clone();
    let mut found: Vec<(String, usize)> = Vec::new();
    for (index, mesh) in meshes.iter().enumerate() {
        let name = called(scene, index, mesh);
        let mut warn = |count: usize, (one, many): (&str, &str), what: &str| {
            if count > 0 {
                let warning = format!("{name}: {} {what}", counted(count, one, many));
                match found.iter_mut().find(|(known, _)| *known == warning) {
                    Some((_, times)) => *times += 1,
                    None => found.push((warning, 1)),
                }
            }
        };
        let (triangle, edge) = (("triangle", "triangles"), ("edge", "edges"));
        warn(mesh.degenerate_triangles, triangle, "without area");
        warn(
            mesh.duplicate_triangles,
            ("triangle that repeats", "triangles that repeat"),
            "another one",
        );
        warn(mesh.non_manifold_edges, edge, "with more than two triangles");
        warn(mesh.inconsistent_edges, edge, "at which neighbours disagree about the outside");
        let boundary = ("boundary edge:", "boundary edges:");
        let backs = if shows_backs(scene, index) {
            "it is open, so its back faces are drawn too"
        } else {
            "it is open"
        };
        warn(mesh.boundary_edges, boundary, backs);
    }
    // Meshes of one name that are odd in the same way.
    let told = |(warning, times)| {
        if times > 1 { format!("{warning} ({times} such meshes)") } else { warning }
    };
    warnings.extend(found.into_iter().map(told));
    warnings
}

/// Whether a mesh has faces that are seen from behind.
fn shows_backs(scene: &Scene, mesh: usize) -> bool {
    let material = |m: Option<u32>| m.and_then(|m| scene.materials.get(m as usize));
    let parts = &scene.meshes[mesh].parts;
    parts.is_empty()
        || parts
            .iter()
            .any(|p| material(p.material).is_none_or(|m| m.double_sided || !m.front_only))
}

/// A mesh by its name, else by that of a node that shows it, else by its number.
fn called(scene: &Scene, index: usize, mesh: &MeshInfo) -> String {
    let shows = |node: &&Node| node.mesh == Some(index as u32) && !node.name.is_empty();
    match scene.nodes.iter().find(shows) {
        _ if !mesh.name.is_empty() => format!("mesh `{}`", mesh.name),
        Some(node) => format!("mesh of node `{}`", node.name),
        None => format!("mesh {index}"),
    }
}

/// A number of things.
fn counted(count: impl TryInto<u64>, one: &str, many: &str) -> String {
    let count = count.try_into().unwrap_or(u64::MAX);
    format!("{count} {}", if count == 1 { one } else { many })
}

impl fmt::Display for Info {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Write the counts.
        writeln!(f, "{}", surfaces(self.triangles, self.faces, self.vertices))?;
        if self.lines + self.points > 0 {
            let (lines, points) =
                (counted(self.lines, "line", "lines"), counted(self.points, "point", "points"));
            writeln!(f, "{lines}, {points}")?;
        }
        let instances = counted(self.instances, "instance", "instances");
        let (meshes, nodes) =
            (counted(self.meshes.len(), "mesh", "meshes"), counted(self.nodes, "node", "nodes"));
        writeln!(f, "{meshes}, {instances}, {nodes}")?;

        // Write the extent.
        if let Some(bounds) = &self.bounds {
            let size = [0, 1, 2].map(|k| bounds.max[k] - bounds.min[k]);
            writeln!(
                f,
                "bounds {} to {}, size {}",
                triple(bounds.min),
                triple(bounds.max),
                triple(size)
            )?;
        }
        writeln!(f, "{}", if self.closed { "closed" } else { "not closed" })?;

        // Write meshes, materials and textures.
        for mesh in &self.meshes {
            write_mesh(f, mesh)?;
        }
        for m in &self.materials {
            let color = triple(m.color.map(f64::from));
            write!(f, "material {}: {}, colour {color}", quoted(&m.name), m.form)?;
            if m.alpha_mode != "opaque" {
                write!(f, ", {} with opacity {}", m.alpha_mode, m.opacity)?;
            }
            let textures = counted(m.textures, "texture", "textures");
            writeln!(
                f,
                "{}",
                if m.textures > 0 { format!(", {textures}") } else { String::new() }
            )?;
        }
        for t in &self.textures {
            writeln!(f, "texture {}: {} x {}", quoted(&t.name), t.width, t.height)?;
        }

        // Write the lights.
        self.lights.iter().try_for_each(|light| writeln!(f, "{light}"))?;
        if self.exposure != 1.0 {
            writeln!(f, "exposure: photometric lights are multiplied by {:.4e}", self.exposure)?;
        }
        if self.default_lights {
            writeln!(f, "no lights: default ones are used, which follow the camera")?;
        }
        if self.ambient != [0.0; 3] {
            writeln!(f, "ambient light {}", triple(self.ambient.map(f64::from)))?;
        }

        // Write cameras, animations and warnings.
        self.cameras.iter().try_for_each(|camera| writeln!(f, "camera: {camera}"))?;
        for (number, a) in self.animations.iter().enumerate() {
            writeln!(f, "animation {number}: {}, {} s", quoted(&a.name), short(a.duration))?;
        }
        self.warnings.iter().try_for_each(|w| writeln!(f, "warning: {w}"))
    }
}

fn write_mesh(f: &mut fmt::Formatter<'_>, m: &MeshInfo) -> fmt::Result {
    write!(f, "mesh {}: {}", quoted(&m.name), surfaces(m.triangles, m.faces, m.vertices))?;
    if m.instances != 1 {
        write!(f, ", shown {} times", m.instances)?;
    }
    if m.triangles > 0 {
        let boundary = counted(m.boundary_edges, "boundary edge", "boundary edges");
        let closed = if m.closed { "closed".to_owned() } else { boundary };
        write!(f, "; {closed}, {}", counted(m.bodies, "body", "bodies"))?;
    }
    if m.non_finite_vertices > 0 {
        let bad = counted(m.non_finite_vertices, "vertex", "vertices");
        write!(f, ", {bad} with a NaN or infinite coordinate")?;
    }
    writeln!(f)
}

/// How many triangles in how many faces, with how many vertices.
fn surfaces<T: TryInto<u64>>(triangles: T, faces: T, vertices: T) -> String {
    let triangles = counted(triangles, "triangle", "triangles");
    let (faces, vertices) =
        (counted(faces, "face", "faces"), counted(vertices, "vertex", "vertices"));
    format!("{triangles} in {faces}, {vertices}")
}

fn quoted(name: &str) -> String {
    if name.is_empty() { "without name".to_owned() } else { format!("`{name}`") }
}

/// A number with four digits behind the point or so.
fn short(x: f64) -> String {
    if x == 0.0 || (1e-3..1e6).contains(&x.abs()) {
        // Adding 0 makes -0 to 0.
        format!("{}", (x * 1e4).round() / 1e4 + 0.0)
    } else {
        format!("{x:.3e}")
    }
}

/// Three of them.
fn triple(v: [f64; 3]) -> String {
    format!("({}, {}, {})", short(v[0]), short(v[1]), short(v[2]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load_builtin;
    use vitral_math::DMat4;
    use vitral_scene::Part;

    #[test]
    fn eight_cubes_are_counted() {
        let info = info(&load_builtin("cubs").unwrap()).unwrap();
        assert_eq!((info.meshes.len(), info.faces, info.triangles, info.closed), (8, 48, 96, true));
        assert_eq!((info.lights.len(), info.cameras.len(), info.materials.len()), (2, 1, 8));
        let cube = &info.meshes[0];
        assert_eq!(
            (cube.edges, cube.boundary_edges, cube.bodies, cube.consistent_winding),
            (18, 0, 1, true)
        );
        assert!(info.warnings.is_empty());
        let text = info.to_string();
        assert!(
            text.starts_with("96 triangles in 48 faces") && text.contains("; closed, 1 body"),
            "{text}"
        );
        let json = serde_json::to_value(&info).unwrap();
        assert_eq!(json["meshes"][0]["boundary-edges"], 0);
        assert!((json["bounds"]["min"][0].as_f64().unwrap() + 1.2).abs() < 1e-6);
    }

    #[test]
    fn bounds_are_those_of_what_is_seen_however_it_is_turned() {
        let mut scene = Scene::default();
        let corners = vec![
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [-1.0, 0.0, 0.0],
            [9.0, 9.0, 9.0],
            [0.0, f32::NAN, 0.0],
        ];
        let parts = vec![Part { name: String::new(), triangles: 0..2, material: None }];
        let mesh = Mesh {
            positions: corners,
            triangles: vec![[0, 1, 2], [0, 2, 4]],
            parts,
            ..Mesh::default()
        };
        // By 45 degrees: the box round the turned box would reach to 1.41 and -0.71.
        scene.add_mesh(mesh, DMat4::from_rotation_z(std::f64::consts::FRAC_PI_4));
        let bounds = info(&scene).unwrap().bounds.unwrap();
        let half = std::f64::consts::FRAC_1_SQRT_2;
        for (seen, expected) in
            bounds.min.iter().chain(&bounds.max).zip([-half, -half, 0.0, half, half, 0.0])
        {
            assert!((seen - expected).abs() < 1e-9, "{bounds:?}");
        }
    }

    #[test]
    fn an_open_mesh_and_bad_vertices_are_told() {
        let mut mesh = vitral_scene::builtin::solids::plane(1.0, 1.0, 1, 1);
        mesh.positions[0][1] = f32::NAN;
        let info = info(&Scene::from_mesh(mesh)).unwrap();
        assert!(!info.closed && info.meshes[0].non_finite_vertices == 1);
        assert!(
            info.to_string().contains("1 vertex with a NaN") && info.warnings[0].contains("open")
        );
        assert!(super::info(&Scene::default()).unwrap().bounds.is_none());
    }

    #[test]
    fn a_mesh_that_is_not_sound_is_an_error() {
        let mut mesh = vitral_scene::builtin::solids::plane(1.0, 1.0, 1, 1);
        mesh.triangles[0][1] = 99;
        let error = info(&Scene::from_mesh(mesh)).unwrap_err();
        assert!(matches!(error, crate::Error::Render(vitral_render::Error::Scene(_))), "{error}");
        assert!(error.to_string().contains("index 99"), "{error}");
    }

    #[test]
    fn meshes_without_names_are_told_apart_and_equal_warnings_once() {
        let open =
            Mesh { name: String::new(), ..vitral_scene::builtin::solids::plane(1.0, 1.0, 1, 1) };
        let named = Mesh { name: "sheet".to_owned(), ..open.clone() };
        let mut scene = Scene::default();
        for mesh in [open.clone(), open, named.clone(), named] {
            scene.add_mesh(mesh, DMat4::IDENTITY);
        }
        scene.nodes[1].name = "roof".to_owned();
        let info = info(&scene).unwrap();
        let open = "4 boundary edges: it is open, so its back faces are drawn too";
        assert_eq!(
            info.warnings,
            [
                format!("mesh 0: {open}"),
                format!("mesh of node `roof`: {open}"),
                format!("mesh `sheet`: {open} (2 such meshes)")
            ]
        );
    }
}
