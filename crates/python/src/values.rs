//! What Python hands in: options, vectors, arrays.

use crate::light::PyLight;
use numpy::{Element, PyArrayDyn, PyArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyList, PyString};
use vitral::DMat4;
use vitral_cli::options::Given;

/// Keyword arguments as options. `None` leaves an option out.
pub(crate) fn options(given: Option<&Bound<'_, PyDict>>) -> PyResult<Vec<(String, Given)>> {
    let mut options = Vec::new();
    for (name, value) in given.into_iter().flatten() {
        let name: String = name.extract()?;
        if !value.is_none() {
            let value = given_as(&value).map_err(|e| named(&name, e, value.py()))?;
            options.push((name, value));
        }
    }
    Ok(options)
}

/// The error with the option's name in front.
fn named(name: &str, error: PyErr, py: Python<'_>) -> PyErr {
    PyTypeError::new_err(format!("{name}: {}", error.value(py)))
}

fn given_as(value: &Bound<'_, PyAny>) -> PyResult<Given> {
    if let Ok(switch) = value.cast::<PyBool>() {
        return Ok(Given::Switch(switch.is_true()));
    }
    if let Ok(list) = value.cast::<PyList>() {
        return Ok(Given::List(list.iter().map(|item| text(&item)).collect::<PyResult<_>>()?));
    }
    text(value).map(Given::Text)
}

/// A value as it is typed on the command line: numbers of a sequence with commas between them.
pub(crate) fn text(value: &Bound<'_, PyAny>) -> PyResult<String> {
    if let Ok(text) = value.cast::<PyString>() {
        return text.extract();
    }
    if let Ok(switch) = value.cast::<PyBool>() {
        return Ok(if switch.is_true() { "true" } else { "false" }.to_owned());
    }
    if let Ok(light) = value.cast::<PyLight>() {
        return Ok(light.get().spec.clone());
    }
    if let Ok(whole) = value.extract::<i64>() {
        return Ok(whole.to_string());
    }
    if let Ok(number) = value.extract::<f64>() {
        return Ok(number.to_string());
    }
    if let Ok(items) = value.try_iter() {
        let items: Vec<String> = items.map(|item| text(&item?)).collect::<PyResult<_>>()?;
        return Ok(items.join(","));
    }
    if value.hasattr("__fspath__")? {
        return value.call_method0("__fspath__")?.extract();
    }
    let class = value.get_type().name()?;
    Err(PyTypeError::new_err(format!(
        "a text, a number, or a sequence of them is required, not {class}"
    )))
}

/// Three numbers.
pub(crate) fn vector(value: &Bound<'_, PyAny>, name: &str) -> PyResult<[f64; 3]> {
    let (_, values) = numbers::<f64>(value, name, &[Some(3)])?;
    Ok([values[0], values[1], values[2]])
}

/// Numbers of an array, row by row, and its shape, in which `None` stands for any length.
pub(crate) fn numbers<T: Element + Copy>(
    value: &Bound<'_, PyAny>,
    name: &str,
    shape: &[Option<usize>],
) -> PyResult<(Vec<usize>, Vec<T>)> {
    let py = value.py();
    let array = py.import("numpy")?.call_method1("asarray", (value,));
    let array = array.map_err(|e| PyValueError::new_err(format!("{name}: {}", e.value(py))))?;

    // Whole numbers are needed where T is one.
    let wanted = T::get_dtype(py);
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    let is_float = wanted.getattr("kind")?.extract::<String>()? == "f";
    let is_empty = array.getattr("size")?.extract::<usize>()? == 0;
    if !is_empty && !(if is_float { "fiu" } else { "iu" }).contains(&kind) {
        let needed = if is_float { "numbers are" } else { "integers are" };
        return Err(PyTypeError::new_err(format!(
            "{name}: {needed} needed, got dtype {}",
            array.getattr("dtype")?
        )));
    }
    let found: Vec<usize> = array.getattr("shape")?.extract()?;
    let fits =
        |(wanted, found): (&Option<usize>, &usize)| wanted.is_none_or(|wanted| wanted == *found);
    if found.len() != shape.len() || !shape.iter().zip(&found).all(fits) {
        let (needed, got) =
            (shown(shape), shown(&found.iter().copied().map(Some).collect::<Vec<_>>()));
        return Err(PyValueError::new_err(format!(
            "{name}: an array of shape {needed} is needed, got {got}"
        )));
    }
    let array = py.import("numpy")?.call_method1("ascontiguousarray", (array, wanted))?;
    let array = array.cast::<PyArrayDyn<T>>()?;
    Ok((found, array.readonly().as_slice()?.to_vec()))
}

/// A shape as Python writes it.
pub(crate) fn shown(shape: &[Option<usize>]) -> String {
    let sides: Vec<String> =
        shape.iter().map(|side| side.map_or("n".to_owned(), |side| side.to_string())).collect();
    if let [side] = &sides[..] { format!("({side},)") } else { format!("({})", sides.join(", ")) }
}

/// A matrix of 16 numbers, row by row, that keeps points points.
pub(crate) fn affine(rows: &[f64], name: &str) -> PyResult<DMat4> {
    let matrix: [f64; 16] = rows
        .try_into()
        .map_err(|_| PyValueError::new_err(format!("{name}: 16 numbers are needed")))?;
    let matrix = DMat4::from_cols_array(&matrix).transpose();
    if !matrix.is_finite() || matrix.row(3).to_array() != [0.0, 0.0, 0.0, 1.0] {
        let needed =
            "finite numbers and a last row of 0, 0, 0, 1 are needed (row-major, column vectors)";
        return Err(PyValueError::new_err(format!("{name}: {needed}")));
    }
    Ok(matrix)
}

/// A transform, shape (4, 4).
pub(crate) fn transform(value: &Bound<'_, PyAny>, name: &str) -> PyResult<DMat4> {
    affine(&numbers::<f64>(value, name, &[Some(4), Some(4)])?.1, name)
}

/// JSON as Python's objects.
pub(crate) fn object<'py>(
    py: Python<'py>,
    value: &impl serde::Serialize,
) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(|e| PyValueError::new_err(e.to_string()))?;
    py.import("json")?.call_method1("loads", (text,))
}
