//! The Python package `vitral`: scenes, cameras and lights from Python's values, pictures as numpy
//! arrays. No rendering logic lives here; everything is in crate `vitral`, and options are those of
//! the command line.
#![forbid(unsafe_code)]

mod camera;
mod channels;
mod drawing;
mod errors;
mod interrupt;
mod light;
mod mesh_input;
mod picture;
mod renderer;
mod saved;
mod scene;
mod values;

use pyo3::prelude::*;
use std::ffi::OsString;
use std::path::PathBuf;

/// Runs the command ``vitral`` with these arguments, of which the first is its name; gives its exit
/// code.
#[pyfunction]
#[pyo3(signature = (arguments, library=None, program=None))]
fn command(
    py: Python<'_>,
    arguments: Vec<OsString>,
    library: Option<PathBuf>,
    program: Option<Vec<OsString>>,
) -> u8 {
    if let Some(program) = program {
        vitral_cli::started_by(program);
    }
    if let Some(library) = library {
        vitral_cli::osmesa_lies_in(library);
    }
    py.detach(|| vitral_cli::command(arguments))
}

/// The module with what is not Python's own; the package's other files name it.
#[pymodule]
fn _vitral(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<scene::PyScene>()?;
    module.add_class::<light::PyLight>()?;
    module.add_class::<camera::PyCamera>()?;
    module.add_class::<renderer::PyRenderer>()?;
    module.add_class::<picture::PyPicture>()?;
    module.add_class::<picture::PyTurntable>()?;
    module.add_class::<drawing::PyDrawing>()?;
    module.add_function(wrap_pyfunction!(scene::load, module)?)?;
    module.add_function(wrap_pyfunction!(command, module)?)
}
