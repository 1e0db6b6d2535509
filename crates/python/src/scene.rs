//! Scenes: read from files, or built by hand.

use crate::errors::{Trouble, usage};
use crate::light::PyLight;
use crate::{interrupt, mesh_input, saved, values};
use numpy::{PyArray1, PyArray3};
use pyo3::exceptions::{PyIndexError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use vitral::internals::render::Error as RenderError;
use vitral::{
    DMat4, Error, LoadOptions, MaterialOverride, NoFiles, Scene, TextureRef, World, info,
    load_bytes_with, load_on, material_properties,
};
use vitral_cli::options::{Given, Purpose, Resolved};

/// Meshes, materials, lights, and instances that place meshes in the world.
///
/// ``Scene()`` is empty; :func:`load` reads files. Everything that is added gets a number, which
/// other methods take. Rendering works on the scene as it is then, so a scene may change between
/// pictures. A scene can be pickled.
///
/// >>> import numpy, vitral
/// >>> scene = vitral.Scene()
/// >>> red = scene.add_material(name="red", diffuse=(0.8, 0.1, 0.1), shininess=32)
/// >>> mesh = scene.add_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], material=red)
/// >>> instance = scene.add_instance(mesh, transform=numpy.eye(4))
/// >>> scene.bounds[1]
/// array([1., 1., 0.])
#[pyclass(frozen, name = "Scene", module = "vitral", weakref)]
#[derive(Debug)]
pub(crate) struct PyScene(Mutex<SceneData>);

/// A scene, and what renderers need to know to follow its changes.
#[derive(Debug, Default)]
pub(crate) struct SceneData {
    pub(crate) scene: Arc<Scene>,
    /// The node of each instance, in the order of the channel `ids`.
    pub(crate) instances: Vec<u32>,
    /// Whether every node is a root.
    flat: bool,
    /// Counts changes of anything but places.
    pub(crate) edition: u64,
    /// Counts changes of places.
    pub(crate) moves: u64,
    world: Option<Arc<World>>,
}

impl SceneData {
    /// The scene, to be changed.
    fn edit(&mut self) -> &mut Scene {
        self.edition += 1;
        self.world = None;
        Arc::make_mut(&mut self.scene)
    }

    /// The scene flattened.
    fn world(&mut self) -> Result<Arc<World>, Error> {
        if let Some(world) = &self.world {
            return Ok(Arc::clone(world));
        }
        let world = World::new(&self.scene).map_err(|e| Error::from(RenderError::World(e)))?;
        Ok(Arc::clone(self.world.insert(Arc::new(world))))
    }

    /// Makes instances independent of each other, as those who move them expect.
    pub(crate) fn flatten(&mut self) -> Result<(), Error> {
        if !self.flat {
            self.edit().flatten().map_err(|e| Error::from(RenderError::World(e)))?;
            self.flat = true;
        }
        Ok(())
    }

    /// The nodes of instances.
    pub(crate) fn nodes_of(&self, instances: &[usize]) -> PyResult<Vec<u32>> {
        let node = |&instance: &usize| {
            let there = self.instances.len();
            let none = || {
                PyIndexError::new_err(format!("there is no instance {instance}, there are {there}"))
            };
            self.instances.get(instance).copied().ok_or_else(none)
        };
        instances.iter().map(node).collect()
    }
}

impl PyScene {
    /// Takes a scene.
    fn of(scene: Scene) -> Result<Self, Error> {
        let mut data = SceneData { scene: Arc::new(scene), ..SceneData::default() };
        data.instances = data.world()?.instances.iter().map(|instance| instance.node).collect();
        Ok(Self(Mutex::new(data)))
    }

    pub(crate) fn lock(&self) -> MutexGuard<'_, SceneData> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// What models are read from.
enum Source {
    Paths(Vec<PathBuf>),
    Bytes(Vec<u8>, String),
}

impl Source {
    fn of(source: &Bound<'_, PyAny>, format: Option<&str>) -> PyResult<Self> {
        if let (Ok(bytes), Some(format)) = (source.extract::<Vec<u8>>(), format) {
            return Ok(Self::Bytes(bytes, format!("bytes.{}", format.trim_start_matches('.'))));
        }
        if let Ok(path) = source.extract::<PathBuf>() {
            return match format {
                Some(_) => Err(usage(
                    "format: the format of a file is told by its content and name",
                    "leave it out",
                )),
                None => Ok(Self::Paths(vec![path])),
            };
        }
        if source.extract::<Vec<u8>>().is_ok() && !source.is_instance_of::<pyo3::types::PyList>() {
            return Err(usage("source: bytes need a format", "such as format=\"stl\""));
        }
        let paths: PyResult<Vec<PathBuf>> =
            source.try_iter().and_then(|items| items.map(|item| item?.extract()).collect());
        let class = source.get_type().name()?;
        let needed = format!(
            "source: a path, a list of paths, or bytes with a format are needed, not {class}"
        );
        paths.map(Self::Paths).map_err(|_| PyTypeError::new_err(needed))
    }

    fn load(self, resolved: &Resolved) -> Result<Scene, Trouble> {
        let mut state = resolved.state.clone();
        let (load, execution) = (state.load_options(), resolved.execution()?);
        Ok(match self {
            Self::Paths(paths) => {
                state.models =
                    paths.iter().map(|path| path.to_string_lossy().into_owned()).collect();
                state.load_scene_by(|model| load_on(model, &load, &execution.workers))?
            }
            Self::Bytes(bytes, name) => {
                state.models = vec![name];
                state.load_scene_by(|name| load_bytes_with(&bytes, name, &NoFiles, &load))?
            }
        })
    }
}

/// Reads a scene: a path, a list of paths, ``"builtin:NAME"``, or bytes with their ``format``
/// (``"stl"``, ``"glb"``, ``"obj"``, ...).
///
/// Options are those of the command line: ``normals``, ``crease_angle`` (degrees), ``file_colors``
/// (``"srgb"`` or ``"linear"``: how MTL files mean their colours), ``material``
/// (``"NAME.PROPERTY=VALUE"`` or a list), ``allow_external``, ``all_rotation``,
/// ``all_translation``, ``max_memory``, ``threads``.
///
/// Raises :class:`InputError` for a file that is missing or malformed, with its ``path`` and
/// ``where``; :class:`UnsupportedError` for a format that is not known; :class:`UsageError` for
/// options that are not there.
///
/// >>> import vitral
/// >>> scene = vitral.load("builtin:teapot")
/// >>> vitral.load(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", format="obj").info()["triangles"]
/// 1
#[pyfunction]
#[pyo3(signature = (source, *, format=None, **options))]
pub(crate) fn load(
    py: Python<'_>,
    source: &Bound<'_, PyAny>,
    format: Option<&str>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<PyScene> {
    let resolved =
        Resolved::new(Purpose::Load, &values::options(options)?).map_err(Trouble::from)?;
    let source = Source::of(source, format)?;
    let load = move || source.load(&resolved).and_then(|scene| Ok(PyScene::of(scene)?));
    Ok(interrupt::run(py, &AtomicBool::default(), load)??)
}

#[pymethods]
impl PyScene {
    #[new]
    fn new() -> Self {
        Self(Mutex::new(SceneData { flat: true, ..SceneData::default() }))
    }

    /// Adds a material and gives its number.
    ///
    /// Properties are those of ``--material`` (docs/materials.md): ``diffuse``, ``specular``,
    /// ``ambient`` (linear RGB, 0 to 1, or a colour's name) with ``shininess``, or ``base_color``
    /// with ``metallic`` and ``roughness`` (0 to 1); ``opacity`` (1 opaque), ``ior``, ``mirror``,
    /// ``emission``, ``double_sided``, ``unlit`` and others. ``texture`` is an image that
    /// multiplies the colour: uint8, shape (height, width, 3) or (height, width, 4), sRGB.
    ///
    /// Raises :class:`UsageError` for a property that is not there or has another form.
    ///
    /// >>> import vitral
    /// >>> vitral.Scene().add_material(name="glass", diffuse=(0.1, 0.2, 0.1), opacity=0.3)
    /// 0
    #[pyo3(signature = (name="", *, texture=None, **properties))]
    fn add_material(
        &self,
        name: &str,
        texture: Option<&Bound<'_, PyAny>>,
        properties: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<u32> {
        // Let the properties change a material of a scene of its own.
        let mut one = Scene::default();
        let is_physical = |key: &str| matches!(key, "base_color" | "metallic" | "roughness");
        let options = values::options(properties)?;
        let material = match options.iter().any(|(key, _)| is_physical(key)) {
            true => vitral::Material::metal([0.8; 3], 0.5),
            false => vitral::Material::default(),
        };
        one.add_material(vitral::Material { name: "material".to_owned(), ..material });
        if options.iter().any(|(key, _)| is_physical(key))
            && !options.iter().any(|(key, _)| key == "metallic")
        {
            set(&mut one, "metallic", "0")?;
        }
        for (key, value) in options {
            let property = match COEFFICIENTS.iter().find(|(name, _)| *name == key) {
                Some((_, property)) => (*property).to_owned(),
                None => key.replace('_', "-"),
            };
            if !material_properties().any(|(known, _)| known == property) {
                let names = COEFFICIENTS.iter().map(|(name, _)| (*name).to_owned());
                let names =
                    names.chain(material_properties().map(|(name, _)| name.replace('-', "_")));
                let names: Vec<String> = names.collect();
                return Err(usage(
                    format!("materials have no property {key}"),
                    format!("there are {}", names.join(", ")),
                ));
            }
            let value = match value {
                Given::Switch(on) => on.to_string(),
                Given::Text(text) => text,
                Given::List(texts) => texts.join(","),
            };
            set(&mut one, &property, &value)?;
            // What reflects diffuse light reflects ambient light of that colour, unless it is said.
            if property == "kd"
                && !properties.is_some_and(|p| p.contains("ambient").unwrap_or(false))
            {
                set(&mut one, "ka", &value)?;
            }
        }

        // Take it over.
        let texture = texture.map(|image| mesh_input::texture(image, name)).transpose()?;
        let mut data = self.lock();
        let scene = data.edit();
        let mut material = one.materials.remove(0);
        name.clone_into(&mut material.name);
        if let Some(texture) = texture {
            scene.textures.push(Arc::new(texture));
            material.base_texture = Some(TextureRef::new(scene.textures.len() as u32 - 1));
        }
        Ok(scene.add_material(material))
    }

    /// Adds a mesh, without placing it, and gives its number for :meth:`add_instance`.
    ///
    /// ``vertices``: float, shape (n, 3), scene units. ``faces``: integers, shape (m, 3) or (m, k),
    /// or a list of convex polygons; indices from 0, counter-clockwise seen from outside.
    /// ``normals``: float, shape (n, 3); left out, they are made with edges where faces meet at
    /// more than ``crease_angle`` degrees (0: all faces are flat). ``uvs``: float, shape (n, 2),
    /// with (0, 0) at the image's top left. ``colors``: shape (n, 3) or (n, 4), uint8 for sRGB or
    /// float for linear RGB from 0 to 1. ``material``: the number of a material.
    ///
    /// Raises ``ValueError`` for another shape or an index that is not there, ``TypeError`` for
    /// another dtype.
    ///
    /// >>> import numpy, vitral
    /// >>> vitral.Scene().add_mesh(numpy.zeros((3, 3)), [[0, 1, 2]])
    /// 0
    #[pyo3(
        signature = (vertices, faces, *, material=None, name="", crease_angle=40.0, **attributes),
        text_signature = "($self, vertices, faces, *, normals=None, uvs=None, colors=None, material=None, name='', crease_angle=40.0)"
    )]
    fn add_mesh(
        &self,
        vertices: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        material: Option<u32>,
        name: &str,
        crease_angle: f64,
        attributes: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<u32> {
        let mut given = mesh_input::Given::new(vertices, faces, attributes)?;
        (given.material, given.name, given.crease_angle) = (material, name, crease_angle);
        let mesh = given.mesh()?;
        let mut data = self.lock();
        if let Some(material) = material.filter(|&m| m as usize >= data.scene.materials.len()) {
            let there = data.scene.materials.len();
            return Err(PyIndexError::new_err(format!(
                "there is no material {material}, there are {there}"
            )));
        }
        let scene = data.edit();
        scene.meshes.push(Arc::new(mesh));
        Ok(scene.meshes.len() as u32 - 1)
    }

    /// Shows a mesh at a place and gives the number of the instance, which the channel ``ids``
    /// shows.
    ///
    /// ``transform``: float64, shape (4, 4), row-major, column vectors: from the mesh's space to
    /// the world's.
    ///
    /// >>> import numpy, vitral
    /// >>> scene = vitral.Scene()
    /// >>> scene.add_instance(scene.add_mesh(numpy.eye(3), [[0, 1, 2]]))
    /// 0
    #[pyo3(signature = (mesh, transform=None))]
    fn add_instance(&self, mesh: u32, transform: Option<&Bound<'_, PyAny>>) -> PyResult<usize> {
        let transform = transform
            .map(|t| values::transform(t, "transform"))
            .transpose()?
            .unwrap_or(DMat4::IDENTITY);
        let mut data = self.lock();
        let there = data.scene.meshes.len();
        if mesh as usize >= there {
            return Err(PyIndexError::new_err(format!(
                "there is no mesh {mesh}, there are {there}"
            )));
        }
        let node = data.edit().add_instance(mesh, transform);
        data.instances.push(node);
        Ok(data.instances.len() - 1)
    }

    /// Moves instances. ``transforms``: float64, shape (k, 4, 4), from each mesh's space to the
    /// world's, for the k numbers in ``instances``. Meshes and what is known of them stay, so that
    /// moving costs little.
    ///
    /// The first move of a scene that was read makes its instances independent of each other and of
    /// the file's nodes.
    ///
    /// >>> import numpy, vitral
    /// >>> scene = vitral.load("builtin:teapot")
    /// >>> scene.set_transforms([0], numpy.eye(4)[None])
    fn set_transforms(&self, instances: Vec<usize>, transforms: &Bound<'_, PyAny>) -> PyResult<()> {
        let shape = [Some(instances.len()), Some(4), Some(4)];
        let (_, numbers) = values::numbers::<f64>(transforms, "transforms", &shape)?;
        let matrices = numbers
            .chunks(16)
            .map(|rows| values::affine(rows, "transforms"))
            .collect::<PyResult<Vec<_>>>()?;
        let mut data = self.lock();
        let nodes = data.nodes_of(&instances)?;
        data.flatten().map_err(Trouble::from)?;
        let scene = Arc::make_mut(&mut data.scene);
        for (node, matrix) in nodes.into_iter().zip(matrices) {
            scene.nodes[node as usize].transform = vitral::NodeTransform::Matrix(matrix);
        }
        data.moves += 1;
        data.world = None;
        Ok(())
    }

    /// Where the instances are: float64, shape (number of instances, 4, 4), from each mesh's space
    /// to the world's.
    #[getter]
    fn transforms<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let world = self.lock().world().map_err(Trouble::from)?;
        let rows = |m: &DMat4| (0..4).map(|row| m.row(row).to_array().to_vec()).collect::<Vec<_>>();
        let all: Vec<Vec<Vec<f64>>> =
            world.instances.iter().map(|instance| rows(&instance.world_from_model)).collect();
        match all.is_empty() {
            true => Ok(PyArray3::zeros(py, [0, 4, 4], false)),
            false => {
                PyArray3::from_vec3(py, &all).map_err(|e| PyValueError::new_err(e.to_string()))
            }
        }
    }

    /// Adds a light. A scene without lights is lit by pleasant ones that follow the camera.
    fn add_light(&self, light: &Bound<'_, PyLight>) {
        self.lock().edit().add_light(light.get().light.clone());
    }

    /// The box round all instances: two float64 arrays of shape (3,), the lowest and the highest
    /// corner. Raises ``ValueError`` for an empty scene.
    #[getter]
    #[allow(clippy::type_complexity)]
    fn bounds<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>)> {
        let bounds = self.lock().world().map_err(Trouble::from)?.bounds;
        if bounds.is_empty() {
            return Err(PyValueError::new_err("bounds: the scene shows nothing"));
        }
        let [low, high] =
            [bounds.min, bounds.max].map(|corner| PyArray1::from_slice(py, &corner.to_array()));
        Ok((low, high))
    }

    /// What is in the scene, as ``vitral info --json`` tells it of a model: counts, meshes,
    /// materials, lights, cameras, warnings.
    fn info<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let scene = Arc::clone(&self.lock().scene);
        let info = py.detach(|| info::info(&scene)).map_err(Trouble::from)?;
        values::object(py, &info)
    }

    /// What was odd in the files, a line each.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.lock().scene.warnings.clone()
    }

    /// The number of instances.
    fn __len__(&self) -> usize {
        self.lock().instances.len()
    }

    fn __bool__(&self) -> bool {
        true
    }

    fn __repr__(&self) -> String {
        let data = self.lock();
        let (meshes, materials) = (data.scene.meshes.len(), data.scene.materials.len());
        format!(
            "<vitral.Scene: {} instances, {meshes} meshes, {materials} materials>",
            data.instances.len()
        )
    }

    /// A scene of a ``trimesh.Trimesh`` or ``trimesh.Scene``, with its vertex colours, or texture
    /// and texture coordinates.
    #[staticmethod]
    fn from_trimesh<'py>(mesh: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        mesh.py().import("vitral._convert")?.call_method1("from_trimesh", (mesh,))
    }

    /// A scene of a ``pyvista.PolyData``.
    #[staticmethod]
    fn from_pyvista<'py>(mesh: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        mesh.py().import("vitral._convert")?.call_method1("from_pyvista", (mesh,))
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let data = slf.get().lock();
        let bytes = saved::bytes(&data.scene).map_err(PyValueError::new_err)?;
        let state = (PyBytes::new(slf.py(), &bytes), data.flat).into_pyobject(slf.py())?;
        Ok((slf.get_type().getattr("_from_state")?, state))
    }

    /// The scene that was pickled.
    #[staticmethod]
    fn _from_state(bytes: &[u8], flat: bool) -> PyResult<Self> {
        let scene = saved::scene(bytes).map_err(PyValueError::new_err)?;
        let scene = Self::of(scene).map_err(Trouble::from)?;
        scene.lock().flat = flat;
        Ok(scene)
    }
}

/// Properties of Phong's model by their full names.
const COEFFICIENTS: [(&str, &str); 3] = [("diffuse", "kd"), ("specular", "ks"), ("ambient", "ka")];

/// Sets a property of the only material.
fn set(scene: &mut Scene, property: &str, value: &str) -> Result<(), Trouble> {
    let (material, property, value) =
        ("material".to_owned(), property.to_owned(), value.to_owned());
    Ok(MaterialOverride { material, property, value }.apply(scene)?)
}

/// The crease angle of meshes that are read, in degrees.
pub(crate) const CREASE_DEGREES: f64 = 40.0;

const _: () = assert!(LoadOptions::CREASE_ANGLE == CREASE_DEGREES * std::f64::consts::PI / 180.0);
