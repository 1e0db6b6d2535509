//! Renderers.

use crate::camera::PyCamera;
use crate::channels::{Channel, Shelf, Target};
use crate::drawing::PyDrawing;
use crate::errors::Trouble;
use crate::picture::{PyPicture, PyTurntable};
use crate::scene::{PyScene, SceneData};
use crate::{interrupt, values};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use vitral::explain::{Deciders, explain};
use vitral::{Batch, Budget, Camera, DMat4, Renderer, SystemClock, Workers};
use vitral_cli::options::{Given, Purpose, Request, Resolved};

/// Makes pictures and drawings of a scene.
///
/// ``height`` and ``width`` are in pixels. Options are those of ``vitral render``, with ``_`` for
/// ``-``: ``visibility``, ``shadows``, ``samples``, ``shading``, ``background_color``, ``light``,
/// ``view``, ``camera_position``, ``threads``, ``time_limit`` (seconds a call), ``max_memory``, ...
/// Switches are bools, lists are sequences, lights may be :class:`Light`. Results do not depend on
/// ``threads``.
///
/// The renderer follows its scene: what is added to it or moved is in the next picture. Other
/// Python threads run while a picture is made, and Ctrl-C ends it. A renderer can be pickled, by
/// its scene and options.
///
/// Raises :class:`UsageError` for an option that is not there, with a suggestion, or has another
/// value.
///
/// >>> import vitral
/// >>> renderer = vitral.Renderer(vitral.load("builtin:teapot"), height=48, width=64, samples=1)
/// >>> rgb, depth, ids = renderer.render(channels=("rgb", "depth", "ids"))
/// >>> rgb.shape, str(rgb.dtype), str(depth.dtype), str(ids.dtype)
/// ((48, 64, 3), 'uint8', 'float32', 'int32')
#[pyclass(frozen, name = "Renderer", module = "vitral", weakref)]
pub(crate) struct PyRenderer {
    scene: Py<PyScene>,
    size: [u32; 2],
    /// The keyword arguments, for pickling.
    options: Py<PyDict>,
    engine: Mutex<Engine>,
}

/// What renders, as far as it knows the scene.
struct Engine {
    renderer: Renderer,
    resolved: Resolved,
    edition: u64,
    moves: u64,
    process: u32,
}

impl Engine {
    fn new(data: &SceneData, resolved: Resolved) -> Result<Self, Trouble> {
        let mut renderer =
            Renderer::with_execution(data.scene.as_ref().clone(), resolved.execution()?)?;
        resolved.state.apply(&mut renderer)?;
        Ok(Self {
            renderer,
            resolved,
            edition: data.edition,
            moves: data.moves,
            process: std::process::id(),
        })
    }

    /// Brings the scene up to date, and limits what follows.
    fn prepare(&mut self, scene: &PyScene, budget: Budget) -> Result<(), Trouble> {
        // A process that was forked has none of its parent's threads.
        let process = std::process::id();
        if process != self.process {
            let threads = self.renderer.execution().workers.threads();
            let lost = std::mem::replace(
                &mut self.renderer.execution_mut().workers,
                Workers::new(threads),
            );
            // Ending threads that are not there would wait for them.
            std::mem::forget(lost);
            self.process = process;
        }
        self.renderer.execution_mut().budget = budget;

        let data = scene.lock();
        if data.edition != self.edition {
            self.renderer.set_scene(data.scene.as_ref().clone())?;
        } else if data.moves != self.moves {
            let nodes = data.scene.nodes.iter().zip(&self.renderer.scene().nodes).enumerate();
            let moved = nodes.filter(|(_, (new, old))| new.transform != old.transform);
            let moved: Vec<(u32, DMat4)> =
                moved.map(|(i, (new, _))| (i as u32, new.transform.matrix())).collect();
            self.renderer.place(&moved)?;
        } else {
            return Ok(());
        }
        (self.edition, self.moves) = (data.edition, data.moves);
        drop(data);
        Ok(self.resolved.state.apply(&mut self.renderer)?)
    }
}

impl PyRenderer {
    fn engine(&self) -> MutexGuard<'_, Engine> {
        self.engine.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Does some work with the engine, which knows the scene as it is.
    fn work<R: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&mut Engine) -> Result<R, Trouble> + Send,
    ) -> PyResult<R> {
        let scene = self.scene.get();
        let budget = Budget::new(Arc::new(SystemClock::default()));
        let cancel = budget.cancel_flag();
        let prepared = move || {
            let mut engine = self.engine();
            let (time, memory) = (engine.resolved.time_limit(), engine.resolved.memory_limit());
            engine.prepare(scene, budget.with_time_limit(time).with_memory_limit(memory))?;
            work(&mut engine)
        };
        Ok(interrupt::run(py, &cancel, prepared)??)
    }

    /// The camera that was given, for pictures of this size.
    fn camera(&self, camera: Option<&Bound<'_, PyCamera>>) -> Option<Camera> {
        camera.map(|camera| camera.get().of_size(self.size))
    }

    /// A picture from a camera; also for turntables.
    pub(crate) fn make_picture(
        &self,
        py: Python<'_>,
        camera: Option<Camera>,
        channels: &[Channel],
    ) -> PyResult<PyPicture> {
        let request = Channel::request(channels);
        self.work(py, move |engine| {
            engine.renderer.settings.picture.channels = request;
            let camera = camera.unwrap_or_else(|| engine.renderer.frame_camera());
            let picture = engine.renderer.render_from(&camera)?;
            let view = engine.renderer.view_transform(&camera);
            Ok(PyPicture::new(picture, view))
        })
    }
}

/// The options with the size among them.
fn with_size(
    height: Option<u32>,
    width: Option<u32>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Vec<(String, Given)>> {
    let mut given = values::options(options)?;
    let has_resolution = given.iter().any(|(name, _)| name == "resolution");
    if (height.is_some() || width.is_some()) && has_resolution {
        return Err(PyValueError::new_err(
            "resolution: the size is given twice, as height and width, too",
        ));
    }
    if !has_resolution {
        let size = format!("{}x{}", width.unwrap_or(1024), height.unwrap_or(768));
        given.push(("resolution".to_owned(), Given::Text(size)));
    }
    Ok(given)
}

#[pymethods]
impl PyRenderer {
    #[new]
    #[pyo3(signature = (scene, height=None, width=None, **options))]
    fn new(
        py: Python<'_>,
        scene: &Bound<'_, PyScene>,
        height: Option<u32>,
        width: Option<u32>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let given = with_size(height, width, options)?;
        let resolved = Resolved::new(Purpose::Render, &given).map_err(Trouble::from)?;
        let size = [resolved.state.settings.picture.width, resolved.state.settings.picture.height];
        let kept = options.map_or_else(|| Ok(PyDict::new(py)), |options| options.copy())?;
        kept.set_item("height", size[1])?;
        kept.set_item("width", size[0])?;
        if kept.contains("resolution")? {
            kept.del_item("resolution")?;
        }
        let of = scene.get();
        let engine = py.detach(|| Engine::new(&of.lock(), resolved))?;
        Ok(Self {
            scene: scene.clone().unbind(),
            size,
            options: kept.unbind(),
            engine: Mutex::new(engine),
        })
    }

    /// The scene.
    #[getter]
    fn scene(&self, py: Python<'_>) -> Py<PyScene> {
        self.scene.clone_ref(py)
    }

    /// The picture's height in pixels.
    #[getter]
    fn height(&self) -> u32 {
        self.size[1]
    }

    /// The picture's width in pixels.
    #[getter]
    fn width(&self) -> u32 {
        self.size[0]
    }

    /// Renders one picture. ``camera`` left out: the camera of the options, or one that frames the
    /// scene.
    ///
    /// ``channels`` names what is returned, as one array or as a tuple in that order; H and W are
    /// height and width, row 0 is the top:
    ///
    /// - ``rgb`` uint8 (H, W, 3) and ``rgba`` uint8 (H, W, 4), sRGB, straight alpha
    /// - ``depth`` float32 (H, W): distance along the direction of view in scene units, ``inf``
    ///   where nothing is
    /// - ``ids``, ``faces``, ``materials`` int32 (H, W): instance, face, material at the pixel's
    ///   centre, -1 where none is
    /// - ``normals`` float32 (H, W, 3), world space; ``attached_shadow`` and ``cast_shadow``
    ///   float32 (H, W), 0 to 1
    ///
    /// ``out`` is filled instead of new arrays: an array, or a sequence of one for each channel,
    /// C-contiguous and of that shape and dtype.
    ///
    /// Raises :class:`UsageError` for what cannot be rendered, :class:`LimitError` at a limit,
    /// ``ValueError`` or ``TypeError`` for an ``out`` that does not fit, ``KeyboardInterrupt`` at
    /// Ctrl-C.
    ///
    /// >>> import numpy, vitral
    /// >>> renderer = vitral.Renderer(vitral.load("builtin:teapot"), height=48, width=64)
    /// >>> out = numpy.empty((48, 64, 3), numpy.uint8)
    /// >>> renderer.render(vitral.Camera.look_at((4, 3, 6), (0, 1, 0)), out=out) is out
    /// True
    #[pyo3(signature = (camera=None, *, channels=None, out=None))]
    fn render<'py>(
        &self,
        py: Python<'py>,
        camera: Option<&Bound<'py, PyCamera>>,
        channels: Option<&Bound<'py, PyAny>>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let channels = Channel::all_named(channels)?;
        let mut targets = self.targets(py, &channels, None, out)?;
        let (camera, request) = (self.camera(camera), Channel::request(&channels));
        let shelf = Shelf::new(&channels, &mut targets, 1)?;
        self.work(py, |engine| {
            let renderer = &mut engine.renderer;
            renderer.settings.picture.channels = request;
            let camera = camera.unwrap_or_else(|| renderer.frame_camera());
            let picture = renderer.render_from(&camera)?;
            shelf.fill(0, &picture, renderer, &camera);
            renderer.recycle(picture);
            Ok(())
        })?;
        drop(shelf);
        Target::result(py, targets)
    }

    /// Renders N pictures on all threads, each as :meth:`render` makes it, byte for byte.
    ///
    /// ``cameras``: a sequence of N :class:`Camera` or ``None``. ``transforms``: float64, shape (N,
    /// K, 4, 4): where the K instances of the scene are in each picture; the scene is left as it
    /// was. Meshes and what is known of them are shared by all pictures. Arrays are those of
    /// :meth:`render` with N in front: ``rgb`` has shape (N, H, W, 3). Raises as :meth:`render`
    /// does, at the first picture that cannot be made.
    ///
    /// >>> import vitral
    /// >>> renderer = vitral.Renderer(vitral.load("builtin:teapot"), height=24, width=32, samples=1)
    /// >>> renderer.render_batch(renderer.turntable_cameras(5)).shape
    /// (5, 24, 32, 3)
    #[pyo3(signature = (cameras, transforms=None, *, channels=None, out=None))]
    fn render_batch<'py>(
        &self,
        py: Python<'py>,
        cameras: &Bound<'py, PyAny>,
        transforms: Option<&Bound<'py, PyAny>>,
        channels: Option<&Bound<'py, PyAny>>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        // Read the channels and cameras, and prepare the arrays.
        let channels = Channel::all_named(channels)?;
        let cameras = cameras
            .try_iter()?
            .map(|camera| self.batch_camera(&camera?))
            .collect::<PyResult<Vec<_>>>()?;
        let count = cameras.len();
        let mut targets = self.targets(py, &channels, Some(count), out)?;

        // Take the transforms, and make instances independent of each other.
        let (nodes, transforms) = match transforms {
            None => (Vec::new(), Vec::new()),
            Some(transforms) => {
                let mut data = self.scene.get().lock();
                let shape = [Some(count), Some(data.instances.len()), Some(4), Some(4)];
                let (_, numbers) = values::numbers::<f64>(transforms, "transforms", &shape)?;
                let matrices = numbers.chunks(16).map(|rows| values::affine(rows, "transforms"));
                let matrices = matrices.collect::<PyResult<Vec<_>>>()?;
                data.flatten().map_err(Trouble::from)?;
                (data.instances.clone(), matrices)
            }
        };

        // Render the pictures, and put each into its part of the arrays.
        let request = Channel::request(&channels);
        let shelf = Shelf::new(&channels, &mut targets, count)?;
        self.work(py, |engine| {
            engine.renderer.settings.picture.channels = request;
            let batch = Batch { cameras: &cameras, nodes: &nodes, transforms: &transforms };
            engine.renderer.render_batch(&batch, |i, renderer, camera, picture| {
                shelf.fill(i, picture, renderer, camera);
                Ok(())
            })?;
            Ok(())
        })?;
        drop(shelf);
        Target::result(py, targets)
    }

    /// Renders one picture as a :class:`Picture`, which a notebook shows.
    ///
    /// >>> import vitral
    /// >>> vitral.Renderer(vitral.load("builtin:teapot"), height=48, width=64).picture()
    /// <vitral.Picture: 64 x 48>
    #[pyo3(signature = (camera=None, *, channels=None))]
    fn picture(
        &self,
        py: Python<'_>,
        camera: Option<&Bound<'_, PyCamera>>,
        channels: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PyPicture> {
        let mut channels = Channel::all_named(channels)?;
        channels.push(Channel::Rgba);
        self.make_picture(py, self.camera(camera), &channels)
    }

    /// Draws the scene as lines and filled regions. Options are those of ``vitral draw``:
    /// ``style``, ``lines``, ``hidden``, ``page``, ``scale``, ``section_plane``, ``views``, ... A
    /// camera, and the renderer's view and lights, hold where these say nothing else.
    ///
    /// Raises :class:`UsageError` for options that are not there or do not suit each other.
    ///
    /// >>> import vitral
    /// >>> drawing = vitral.Renderer(vitral.load("builtin:cubs")).draw(style="hidden-line", page="A5")
    /// >>> drawing.size
    /// (148.0, 210.0)
    #[pyo3(signature = (camera=None, **options))]
    fn draw(
        &self,
        py: Python<'_>,
        camera: Option<&Bound<'_, PyCamera>>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<PyDrawing> {
        let (given, camera) = (values::options(options)?, self.camera(camera));
        self.work(py, move |engine| {
            let request = Request::new(&given, &engine.resolved.state)?;
            let execution = engine.renderer.execution().clone();
            let (drawing, warnings) = request.draw(&engine.renderer, camera, execution)?;
            Ok(PyDrawing::new(request, drawing, warnings))
        })
    }

    /// Explains pixel ``x``, ``y`` (from the top left corner): the object of ``vitral render
    /// --pixel``, with the facets over it, how its colour comes about, and what the visibility
    /// algorithm decided.
    ///
    /// >>> import vitral
    /// >>> renderer = vitral.Renderer(vitral.load("builtin:teapot"), height=48, width=64)
    /// >>> renderer.explain(32, 24)["pixel"]
    /// [32, 24]
    #[pyo3(signature = (x, y, camera=None))]
    fn explain<'py>(
        &self,
        py: Python<'py>,
        x: u32,
        y: u32,
        camera: Option<&Bound<'py, PyCamera>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let camera = self.camera(camera);
        let explained = self.work(py, move |engine| {
            let camera = camera.unwrap_or_else(|| engine.renderer.frame_camera());
            Ok(explain(
                &engine.renderer,
                &camera,
                [x, y],
                &Deciders::Chosen,
                engine.resolved.time_limit(),
            )?)
        })?;
        values::object(py, &explained)
    }

    /// The pictures of ``count`` views around the scene, one after the other, as an iterator of
    /// :class:`Picture`.
    ///
    /// >>> import vitral
    /// >>> renderer = vitral.Renderer(vitral.load("builtin:teapot"), height=24, width=32)
    /// >>> [picture.numpy().shape for picture in renderer.turntable(2)]
    /// [(24, 32, 3), (24, 32, 3)]
    fn turntable(slf: &Bound<'_, Self>, count: usize) -> PyResult<PyTurntable> {
        let cameras = slf.get().cameras_around(slf.py(), count)?;
        Ok(PyTurntable::new(slf.clone().unbind(), cameras))
    }

    /// The cameras of ``count`` views around the scene, counter-clockwise seen from above.
    fn turntable_cameras(&self, py: Python<'_>, count: usize) -> PyResult<Vec<PyCamera>> {
        Ok(self.cameras_around(py, count)?.into_iter().map(PyCamera::of).collect())
    }

    /// The camera of pictures without one of their own.
    #[getter(camera)]
    fn frame_camera(&self, py: Python<'_>) -> PyResult<PyCamera> {
        self.work(py, |engine| Ok(PyCamera::of(engine.renderer.frame_camera())))
    }

    fn __repr__(&self) -> String {
        format!("<vitral.Renderer: {} x {}>", self.size[0], self.size[1])
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let (py, this) = (slf.py(), slf.get());
        let state = (this.scene.clone_ref(py), this.options.clone_ref(py)).into_pyobject(py)?;
        Ok((py.import("vitral._convert")?.getattr("renderer")?, state))
    }
}

impl PyRenderer {
    fn cameras_around(&self, py: Python<'_>, count: usize) -> PyResult<Vec<Camera>> {
        self.work(py, move |engine| Ok(engine.renderer.turntable_cameras(count)))
    }

    fn batch_camera(&self, camera: &Bound<'_, PyAny>) -> PyResult<Option<Camera>> {
        if camera.is_none() {
            return Ok(None);
        }
        let class = camera.get_type().name()?;
        let camera = camera.cast::<PyCamera>();
        let camera = camera.map_err(|_| {
            PyTypeError::new_err(format!("cameras: a Camera or None is needed, not {class}"))
        })?;
        Ok(self.camera(Some(camera)))
    }

    /// The arrays of channels: new ones, or those of `out`.
    fn targets<'py>(
        &self,
        py: Python<'py>,
        channels: &[Channel],
        pictures: Option<usize>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Vec<Target<'py>>> {
        let outs: Vec<Option<Bound<'py, PyAny>>> = match out {
            None => vec![None; channels.len()],
            Some(out) if channels.len() == 1 && out.hasattr("dtype")? => vec![Some(out.clone())],
            Some(out) => {
                let outs: Vec<_> = out.try_iter()?.collect::<PyResult<_>>()?;
                if outs.len() != channels.len() {
                    let (given, needed) = (outs.len(), channels.len());
                    return Err(PyValueError::new_err(format!(
                        "out: {needed} arrays are needed, one a channel, got {given}"
                    )));
                }
                outs.into_iter().map(Some).collect()
            }
        };
        let target = |(&channel, out): (&Channel, Option<Bound<'py, PyAny>>)| {
            Target::new(py, channel, pictures, self.size, out.as_ref())
        };
        channels.iter().zip(outs).map(target).collect()
    }
}
