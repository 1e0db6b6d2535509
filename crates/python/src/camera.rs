//! Cameras.

use crate::values;
use numpy::PyArray2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use vitral::{Camera, DMat4, DVec3, Projection};

/// How far the axes of a camera's matrix may be from unit length and from right angles.
const RIGID: f64 = 1e-6;

/// A viewer, made by :meth:`look_at`, :meth:`orthographic` or :meth:`from_matrix`. Lengths are in
/// scene units, angles in degrees.
///
/// A camera looks along its own -z axis, with x to the right and y up in the picture. ``near`` and
/// ``far`` are the distances of the clipping planes along the direction of view; left out, they are
/// fitted to the scene.
///
/// >>> import vitral
/// >>> camera = vitral.Camera.look_at((4, 3, 6), (0, 1, 0), view_angle=40)
/// >>> [round(x, 3) for x in camera.eye]
/// [4.0, 3.0, 6.0]
#[pyclass(frozen, name = "Camera", module = "vitral")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PyCamera {
    camera: Camera,
    /// Focal lengths and principal point in pixels: fx, fy, cx, cy.
    intrinsics: Option<[f64; 4]>,
}

impl PyCamera {
    /// The camera for a picture of this size.
    pub(crate) fn of_size(&self, size: [u32; 2]) -> Camera {
        match self.intrinsics {
            Some([fx, fy, cx, cy]) => self.camera.with_intrinsics([fx, fy], [cx, cy], size),
            None => self.camera,
        }
    }

    /// A camera of the library.
    pub(crate) fn of(camera: Camera) -> Self {
        Self { camera, intrinsics: None }
    }
}

/// Clipping planes: both or none.
fn clip(near: Option<f64>, far: Option<f64>, perspective: bool) -> PyResult<Option<(f64, f64)>> {
    match (near, far) {
        (None, None) => Ok(None),
        (Some(near), Some(far))
            if near < far && (near > 0.0 || !perspective) && (near - far).is_finite() =>
        {
            Ok(Some((near, far)))
        }
        _ => Err(PyValueError::new_err(
            "near and far: both or none are needed, near < far, and near > 0 in perspective",
        )),
    }
}

fn placed(
    eye: &Bound<'_, PyAny>,
    target: &Bound<'_, PyAny>,
    up: &Bound<'_, PyAny>,
) -> PyResult<Camera> {
    let (eye, target) = (values::vector(eye, "eye")?, values::vector(target, "target")?);
    let up = values::vector(up, "up")?;
    if eye == target || !DVec3::from(eye).is_finite() || !DVec3::from(target).is_finite() {
        return Err(PyValueError::new_err(
            "eye and target: two different, finite points are needed",
        ));
    }
    let forward = DVec3::from(target) - DVec3::from(eye);
    if forward.normalize().cross(DVec3::from(up).normalize_or_zero()).length() < 1e-9 {
        return Err(PyValueError::new_err(
            "up: a direction across the direction of view is needed",
        ));
    }
    Ok(Camera::look_at(eye, target).with_up(up))
}

#[pymethods]
impl PyCamera {
    /// A perspective camera at ``eye`` that looks at ``target`` (three numbers each), with ``up``
    /// upwards in the picture.
    ///
    /// ``view_angle`` is the vertical angle of view, above 0 and below 180 degrees. Raises
    /// ``ValueError`` for values outside their range.
    ///
    /// >>> import vitral
    /// >>> vitral.Camera.look_at((0, 0, 5), (0, 0, 0)).view_angle
    /// 30.0
    #[staticmethod]
    #[pyo3(signature = (eye, target, up=None, view_angle=30.0, near=None, far=None))]
    fn look_at(
        eye: &Bound<'_, PyAny>,
        target: &Bound<'_, PyAny>,
        up: Option<&Bound<'_, PyAny>>,
        view_angle: f64,
        near: Option<f64>,
        far: Option<f64>,
    ) -> PyResult<Self> {
        if !(view_angle > 0.0 && view_angle < 180.0) {
            return Err(PyValueError::new_err(
                "view_angle: an angle between 0 and 180 degrees is needed",
            ));
        }
        let default = PyTuple::new(eye.py(), [0, 1, 0])?.into_any();
        let camera =
            placed(eye, target, up.unwrap_or(&default))?.with_view_angle(view_angle.to_radians());
        Ok(Self::of(Camera { clip: clip(near, far, true)?, ..camera }))
    }

    /// A camera with parallel projectors whose picture is ``height`` scene units high; else as
    /// :meth:`look_at`.
    ///
    /// >>> import vitral
    /// >>> vitral.Camera.orthographic((0, 0, 5), (0, 0, 0), height=2).height
    /// 2.0
    #[staticmethod]
    #[pyo3(signature = (eye, target, up=None, height=1.0, near=None, far=None))]
    fn orthographic(
        eye: &Bound<'_, PyAny>,
        target: &Bound<'_, PyAny>,
        up: Option<&Bound<'_, PyAny>>,
        height: f64,
        near: Option<f64>,
        far: Option<f64>,
    ) -> PyResult<Self> {
        if !(height > 0.0 && height.is_finite()) {
            return Err(PyValueError::new_err("height: a number above 0 is needed"));
        }
        let default = PyTuple::new(eye.py(), [0, 1, 0])?.into_any();
        let camera = placed(eye, target, up.unwrap_or(&default))?;
        let projection = Projection::Parallel { height };
        Ok(Self::of(Camera { projection, clip: clip(near, far, false)?, ..camera }))
    }

    /// A camera by its pose ``world_from_camera``, shape (4, 4), row-major, column vectors: a
    /// rotation and a translation.
    ///
    /// The camera looks along -z of its own space, with y up (as OpenGL and glTF have it; of a
    /// camera that looks along +z with y down, negate the second and third column). ``intrinsics``
    /// is the matrix K, shape (3, 3), in pixels: ``[[fx, 0, cx], [0, fy, cy], [0, 0, 1]]``; the
    /// picture's top left corner is at (0, 0), so that the middle is at (width / 2, height / 2).
    /// Without it, ``view_angle`` is the vertical angle of view in degrees.
    ///
    /// Raises ``ValueError`` for a matrix that is no rotation and translation, and for intrinsics
    /// of another form.
    ///
    /// >>> import numpy, vitral
    /// >>> pose = numpy.eye(4); pose[2, 3] = 5
    /// >>> K = [[500, 0, 320], [0, 500, 240], [0, 0, 1]]
    /// >>> vitral.Camera.from_matrix(pose, intrinsics=K).eye
    /// (0.0, 0.0, 5.0)
    #[staticmethod]
    #[pyo3(signature = (world_from_camera, intrinsics=None, view_angle=30.0, near=None, far=None))]
    fn from_matrix(
        world_from_camera: &Bound<'_, PyAny>,
        intrinsics: Option<&Bound<'_, PyAny>>,
        view_angle: f64,
        near: Option<f64>,
        far: Option<f64>,
    ) -> PyResult<Self> {
        // Take the pose apart.
        let pose = values::transform(world_from_camera, "world_from_camera")?;
        let axes = [pose.x_axis, pose.y_axis, pose.z_axis].map(|axis| axis.truncate());
        let [x, y, z] = axes;
        let is_rigid = axes.iter().all(|axis| (axis.length() - 1.0).abs() < RIGID)
            && x.cross(y).abs_diff_eq(z, RIGID);
        if !is_rigid {
            return Err(PyValueError::new_err(
                "world_from_camera: a rotation and a translation are needed, without scale",
            ));
        }
        let eye = pose.w_axis.truncate();
        let camera =
            Camera { clip: clip(near, far, true)?, ..Camera::look_at(eye, eye - z).with_up(y) };

        // Read the lens.
        let Some(intrinsics) = intrinsics else {
            if !(view_angle > 0.0 && view_angle < 180.0) {
                return Err(PyValueError::new_err(
                    "view_angle: an angle between 0 and 180 degrees is needed",
                ));
            }
            return Ok(Self::of(camera.with_view_angle(view_angle.to_radians())));
        };
        let (_, k) = values::numbers::<f64>(intrinsics, "intrinsics", &[Some(3), Some(3)])?;
        let is_plain = [k[1], k[3], k[6], k[7]].iter().all(|&v| v == 0.0) && k[8] == 1.0;
        if !(is_plain && k[0] > 0.0 && k[4] > 0.0 && k.iter().all(|v| v.is_finite())) {
            let needed = "[[fx, 0, cx], [0, fy, cy], [0, 0, 1]] with fx and fy above 0 is needed";
            return Err(PyValueError::new_err(format!("intrinsics: {needed}")));
        }
        Ok(Self { camera, intrinsics: Some([k[0], k[4], k[2], k[5]]) })
    }

    /// Where the viewer is, three numbers in scene units.
    #[getter]
    fn eye(&self) -> (f64, f64, f64) {
        self.camera.position.into()
    }

    /// The point looked at.
    #[getter]
    fn target(&self) -> (f64, f64, f64) {
        self.camera.focal_point.into()
    }

    /// Upwards in the picture.
    #[getter]
    fn up(&self) -> (f64, f64, f64) {
        self.camera.view_up.into()
    }

    /// The vertical angle of view in degrees; ``None`` for parallel projectors and for intrinsics.
    #[getter]
    fn view_angle(&self) -> Option<f64> {
        match (self.camera.projection, self.intrinsics) {
            // Degrees that went through radians come back round.
            (Projection::Perspective { view_angle }, None) => {
                Some((view_angle.to_degrees() * 1e10).round() / 1e10)
            }
            _ => None,
        }
    }

    /// The height of the picture in scene units; ``None`` in perspective.
    #[getter]
    fn height(&self) -> Option<f64> {
        match self.camera.projection {
            Projection::Parallel { height } => Some(height),
            _ => None,
        }
    }

    /// The pose: float64, shape (4, 4), row-major.
    #[getter]
    fn world_from_camera<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        matrix(py, self.camera.view_from_world().inverse())
    }

    /// A camera that shows ``factor`` times as much enlarged (above 1: larger).
    fn zoomed(&self, factor: f64) -> Self {
        let scaled = self.intrinsics.map(|[fx, fy, cx, cy]| [fx * factor, fy * factor, cx, cy]);
        Self { camera: self.camera.zoomed(factor), intrinsics: scaled }
    }

    /// A camera that has walked round the target by ``degrees``, counter-clockwise seen from above.
    fn azimuth(&self, degrees: f64) -> Self {
        Self { camera: self.camera.azimuth(degrees.to_radians()), ..*self }
    }

    /// A camera that has climbed over the target by ``degrees``.
    fn elevation(&self, degrees: f64) -> Self {
        Self { camera: self.camera.elevation(degrees.to_radians()), ..*self }
    }

    fn __repr__(&self) -> String {
        let [eye, target] = [self.camera.position, self.camera.focal_point]
            .map(|p| format!("({}, {}, {})", p.x, p.y, p.z));
        format!("<vitral.Camera at {eye} looking at {target}>")
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get() == self)
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let this = slf.get();
        let text = serde_json::to_string(&(this.camera, this.intrinsics))
            .map_err(|e| PyValueError::new_err(e.to_string()))?;
        Ok((slf.get_type().getattr("_from_state")?, PyTuple::new(slf.py(), [text])?))
    }

    /// The camera that was pickled.
    #[staticmethod]
    fn _from_state(text: &str) -> PyResult<Self> {
        let (camera, intrinsics) =
            serde_json::from_str(text).map_err(|e| PyValueError::new_err(e.to_string()))?;
        Ok(Self { camera, intrinsics })
    }
}

/// A matrix as a numpy array, row by row.
pub(crate) fn matrix(py: Python<'_>, matrix: DMat4) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let rows: Vec<Vec<f64>> = (0..4).map(|row| matrix.row(row).to_array().to_vec()).collect();
    PyArray2::from_vec2(py, &rows).map_err(|e| PyValueError::new_err(e.to_string()))
}
