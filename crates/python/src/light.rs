//! Lights.

use crate::errors::usage;
use crate::values;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use vitral::Light;
use vitral_cli::options;

/// A light source, made by one of the static methods, or from the text of the option ``--light``.
///
/// All constructors take the keyword arguments ``name`` (str), ``ambient``, ``diffuse``,
/// ``specular`` (linear RGB: one number, three, or a colour's name; above 1 for stronger lights;
/// specular follows diffuse) and ``shadow`` (bool, casts shadows). Those with a place take
/// ``attenuation``: ``"none"``, ``"inverse-square"``, three numbers c1, c2, c3 for ``min(1/(c1 + c2
/// d + c3 d^2), 1)``, ``"gl,constant,linear,quadratic"`` or ``"range,distance"``. Positions are in
/// scene units, directions are those in which light travels, angles are degrees.
///
/// Raises :class:`UsageError` for a field that is not there or has another form.
///
/// >>> import vitral
/// >>> vitral.Light.point(position=(1, 2, 3), diffuse=(1, 0.9, 0.8))
/// vitral.Light('point:position=1,2,3,diffuse=1,0.9,0.8')
/// >>> vitral.Light("ambient:ambient=0.3") == vitral.Light.ambient(ambient=0.3)
/// True
#[pyclass(frozen, name = "Light", module = "vitral")]
#[derive(Debug)]
pub(crate) struct PyLight {
    pub(crate) spec: String,
    pub(crate) light: Light,
}

impl PyLight {
    fn parse(spec: String) -> PyResult<Self> {
        let light = options::light(&spec).map_err(|what| usage(format!("light: {what}"), ""))?;
        Ok(Self { spec, light })
    }

    /// A light of a kind with required fields and others.
    fn of(
        kind: &str,
        required: &[(&str, &Bound<'_, PyAny>)],
        others: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let mut fields = Vec::new();
        for (name, value) in required {
            fields.push(format!("{name}={}", values::text(value)?));
        }
        for (name, value) in others.into_iter().flatten() {
            if !value.is_none() {
                let (name, value) = (name.extract::<String>()?, values::text(&value)?);
                let value = if name == "shadow" {
                    value.replace("true", "on").replace("false", "off")
                } else {
                    value
                };
                fields.push(format!("{name}={value}"));
            }
        }
        let colon = if fields.is_empty() { "" } else { ":" };
        Self::parse(format!("{kind}{colon}{}", fields.join(",")))
    }
}

#[pymethods]
impl PyLight {
    #[new]
    fn new(spec: String) -> PyResult<Self> {
        Self::parse(spec)
    }

    /// Light from everywhere.
    #[staticmethod]
    #[pyo3(signature = (**fields))]
    fn ambient(fields: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        Self::of("ambient", &[], fields)
    }

    /// Parallel rays that travel along ``direction`` (three numbers).
    #[staticmethod]
    #[pyo3(signature = (direction, **fields))]
    fn directional(
        direction: &Bound<'_, PyAny>,
        fields: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        Self::of("directional", &[("direction", direction)], fields)
    }

    /// Light from a point.
    #[staticmethod]
    #[pyo3(signature = (position, **fields))]
    fn point(position: &Bound<'_, PyAny>, fields: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        Self::of("point", &[("position", position)], fields)
    }

    /// Light from a point into a cone; ``cutoff`` and ``inner`` are half angles in degrees,
    /// ``exponent`` its fall-off.
    #[staticmethod]
    #[pyo3(signature = (position, direction, **fields))]
    fn spot(
        position: &Bound<'_, PyAny>,
        direction: &Bound<'_, PyAny>,
        fields: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        Self::of("spot", &[("position", position), ("direction", direction)], fields)
    }

    /// Light from a disc, to the side of its normal; its shadows are soft.
    #[staticmethod]
    #[pyo3(signature = (center, normal, radius, **fields))]
    fn disc(
        center: &Bound<'_, PyAny>,
        normal: &Bound<'_, PyAny>,
        radius: &Bound<'_, PyAny>,
        fields: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        Self::of("area", &[("center", center), ("normal", normal), ("radius", radius)], fields)
    }

    /// Light from a planar polygon (n corners, shape (n, 3)), to the side from which they run
    /// counter-clockwise.
    #[staticmethod]
    #[pyo3(signature = (corners, **fields))]
    fn polygon(corners: &Bound<'_, PyAny>, fields: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        Self::of("area", &[("corners", corners)], fields)
    }

    /// Its name; may be empty.
    #[getter]
    fn name(&self) -> &str {
        &self.light.name
    }

    fn __repr__(&self) -> String {
        format!("vitral.Light('{}')", self.spec)
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get().light == self.light)
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        Ok((slf.get_type().into_any(), PyTuple::new(slf.py(), [&slf.get().spec])?))
    }
}
