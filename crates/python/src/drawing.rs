//! Vector drawings.

use crate::errors::Trouble;
use numpy::PyArray2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::path::PathBuf;
use vitral::Drawing;
use vitral_cli::options::Request;

/// A vector drawing, made by :meth:`Renderer.draw`. A notebook shows it.
///
/// >>> import vitral
/// >>> drawing = vitral.Renderer(vitral.load("builtin:cubs")).draw(page="fit")
/// >>> sorted(drawing.lines)
/// ['contour', 'crease']
#[pyclass(frozen, name = "Drawing", module = "vitral")]
#[derive(Debug)]
pub(crate) struct PyDrawing {
    request: Request,
    drawing: Drawing,
    warnings: Vec<String>,
}

impl PyDrawing {
    pub(crate) fn new(request: Request, drawing: Drawing, warnings: Vec<String>) -> Self {
        Self { request, drawing, warnings }
    }
}

#[pymethods]
impl PyDrawing {
    /// Width and height of the page in millimetres.
    #[getter]
    fn size(&self) -> (f64, f64) {
        (self.drawing.width, self.drawing.height)
    }

    /// The lines by class: a dict from the class (``contour``, ``boundary``, ``crease``,
    /// ``material``, ``intersection``, ``section``, ``smooth``, ``hatch``) to a list of polylines,
    /// float64 of shape (k, 2), millimetres, x to the right and y upwards from the lower left
    /// corner. Hidden lines are in classes of their own, ``hidden-contour`` and so on.
    #[getter]
    fn lines<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let lines = PyDict::new(py);
        for line in &self.drawing.lines {
            let hidden = if line.layers > 0 { "hidden-" } else { "" };
            let class = format!("{hidden}{}", line.class.name());
            let points: Vec<Vec<f64>> = line.points.iter().map(|point| point.to_vec()).collect();
            let points = PyArray2::from_vec2(py, &points)
                .map_err(|e| PyValueError::new_err(e.to_string()))?;
            if !lines.contains(&class)? {
                lines.set_item(&class, PyList::empty(py))?;
            }
            if let Some(list) = lines.get_item(&class)? {
                list.call_method1("append", (points,))?;
            }
        }
        Ok(lines)
    }

    /// The number of filled regions.
    #[getter]
    fn regions(&self) -> usize {
        self.drawing.regions.len()
    }

    /// What is not as it was asked for, a line each.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// Writes the drawing into a file: ``.svg``, ``.pdf``, ``.dxf``, ``.hpgl`` or ``.plt``. The
    /// file appears complete or not at all.
    ///
    /// Raises :class:`UnsupportedError` for another extension, :class:`UsageError` for options that
    /// the format cannot express.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let write = || -> Result<(), Trouble> {
            let bytes = self.request.encode(self.drawing.clone(), path.clone())?;
            Ok(vitral::picture::write(&path, &bytes)?)
        };
        Ok(py.detach(write)?)
    }

    /// The drawing as SVG, for notebooks.
    fn _repr_svg_(&self, py: Python<'_>) -> PyResult<String> {
        let encode = || self.request.encode(self.drawing.clone(), PathBuf::from("-"));
        let bytes = py.detach(encode).map_err(Trouble::from)?;
        String::from_utf8(bytes).map_err(|e| PyValueError::new_err(e.to_string()))
    }

    fn __repr__(&self) -> String {
        let (width, height) = self.size();
        format!(
            "<vitral.Drawing: {} lines on {width:.1} x {height:.1} mm>",
            self.drawing.lines.len()
        )
    }
}
