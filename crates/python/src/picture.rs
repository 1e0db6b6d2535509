//! Pictures with what is known of them, and turntables.

use crate::channels::{Channel, Target, fill_from};
use crate::errors::{Trouble, usage};
use crate::renderer::PyRenderer;
use crate::values;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::path::PathBuf;
use std::sync::Mutex;
use vitral::{Camera, Picture, PictureFormat, ViewTransform};

/// A picture, made by :meth:`Renderer.picture`. A notebook shows it.
///
/// >>> import vitral
/// >>> picture = vitral.Renderer(vitral.load("builtin:teapot"), height=48, width=64).picture()
/// >>> picture.numpy().shape, picture.warnings
/// ((48, 64, 3), [])
#[pyclass(frozen, name = "Picture", module = "vitral")]
#[derive(Debug)]
pub(crate) struct PyPicture {
    picture: Picture,
    view: ViewTransform,
}

impl PyPicture {
    pub(crate) fn new(picture: Picture, view: ViewTransform) -> Self {
        Self { picture, view }
    }
}

#[pymethods]
impl PyPicture {
    /// Width in pixels.
    #[getter]
    fn width(&self) -> u32 {
        self.picture.width()
    }

    /// Height in pixels.
    #[getter]
    fn height(&self) -> u32 {
        self.picture.height()
    }

    /// A channel as an array of its own, as :meth:`Renderer.render` describes it; ``rgb``, ``rgba``
    /// and those that were asked for.
    ///
    /// Raises :class:`UsageError` for a channel that was not rendered.
    #[pyo3(signature = (channel="rgb"))]
    fn numpy<'py>(&self, py: Python<'py>, channel: &str) -> PyResult<Bound<'py, PyAny>> {
        let channel = Channel::named(channel)?;
        if !channel.is_in(&self.picture) {
            return Err(usage(
                format!("the channel {} was not rendered", channel.name()),
                "name it in channels=",
            ));
        }
        let size = [self.picture.width(), self.picture.height()];
        let mut target = Target::new(py, channel, None, size, None)?;
        for pixels in &mut target.pictures(1)? {
            fill_from(channel, &self.picture, &self.view, pixels);
        }
        Target::result(py, vec![target])
    }

    /// Writes the colours into a file: ``.png``, ``.jpg`` or ``.ppm``. The file appears complete or
    /// not at all.
    ///
    /// Raises :class:`UnsupportedError` for another extension, :class:`Error` if the file cannot be
    /// written.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        Ok(py.detach(|| self.picture.save(path)).map_err(Trouble::from)?)
    }

    /// Counters and times, as a dict.
    #[getter]
    fn stats<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        values::object(py, &self.picture.stats)
    }

    /// What is not as it was asked for, a line each.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.picture.warnings.clone()
    }

    /// The picture as a PNG, for notebooks.
    fn _repr_png_<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let png = py.detach(|| self.picture.encode(PictureFormat::Png)).map_err(Trouble::from)?;
        Ok(PyBytes::new(py, &png))
    }

    fn __repr__(&self) -> String {
        format!("<vitral.Picture: {} x {}>", self.picture.width(), self.picture.height())
    }
}

/// The pictures of a turntable.
#[pyclass(frozen, name = "Turntable", module = "vitral")]
pub(crate) struct PyTurntable {
    renderer: Py<PyRenderer>,
    cameras: Vec<Camera>,
    next: Mutex<usize>,
}

impl PyTurntable {
    pub(crate) fn new(renderer: Py<PyRenderer>, cameras: Vec<Camera>) -> Self {
        Self { renderer, cameras, next: Mutex::new(0) }
    }
}

#[pymethods]
impl PyTurntable {
    fn __iter__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __len__(&self) -> usize {
        self.cameras.len()
    }

    fn __next__(&self, py: Python<'_>) -> PyResult<Option<PyPicture>> {
        let camera = {
            let mut next = self.next.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            let camera = self.cameras.get(*next).copied();
            *next += 1;
            camera
        };
        let picture = |camera| self.renderer.get().make_picture(py, Some(camera), &[Channel::Rgba]);
        camera.map(picture).transpose()
    }
}
