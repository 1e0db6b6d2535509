//! Meshes and textures from arrays.

use crate::scene::CREASE_DEGREES;
use crate::values::{numbers, shown};
use pyo3::exceptions::{PyIndexError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use vitral::internals::math::color::linear_from_srgb;
use vitral::{Attribute, Encoding, Mesh, Plane, Texture};

/// What a mesh is made of.
pub(crate) struct Given<'a, 'py> {
    vertices: &'a Bound<'py, PyAny>,
    faces: &'a Bound<'py, PyAny>,
    normals: Option<Bound<'py, PyAny>>,
    uvs: Option<Bound<'py, PyAny>>,
    colors: Option<Bound<'py, PyAny>>,
    pub(crate) material: Option<u32>,
    pub(crate) name: &'a str,
    pub(crate) crease_angle: f64,
}

impl<'a, 'py> Given<'a, 'py> {
    /// Vertices and faces, and attributes by their names.
    pub(crate) fn new(
        vertices: &'a Bound<'py, PyAny>,
        faces: &'a Bound<'py, PyAny>,
        attributes: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Self> {
        let mut given = Self {
            vertices,
            faces,
            normals: None,
            uvs: None,
            colors: None,
            material: None,
            name: "",
            crease_angle: CREASE_DEGREES,
        };
        for (name, value) in attributes.into_iter().flatten() {
            let name: String = name.extract()?;
            let attribute = match name.as_str() {
                "normals" => &mut given.normals,
                "uvs" => &mut given.uvs,
                "colors" => &mut given.colors,
                _ => {
                    return Err(PyTypeError::new_err(format!(
                        "add_mesh() got an unexpected keyword argument '{name}'"
                    )));
                }
            };
            *attribute = Some(value).filter(|value| !value.is_none());
        }
        Ok(given)
    }

    /// The mesh, checked.
    pub(crate) fn mesh(&self) -> PyResult<Mesh> {
        if !(0.0..=180.0).contains(&self.crease_angle) {
            return Err(PyValueError::new_err(
                "crease_angle: an angle from 0 to 180 degrees is needed",
            ));
        }
        let (shape, positions) = numbers::<f32>(self.vertices, "vertices", &[None, Some(3)])?;
        let count = shape[0];
        let mut mesh = faces(self.faces, count)?
            .mesh(positions.as_chunks::<3>().0.to_vec())
            .with_name(self.name);
        if let Some(material) = self.material {
            mesh = mesh.with_material(material);
        }

        // Take the attributes over.
        if let Some(uvs) = &self.uvs {
            let (_, uvs) = numbers::<f32>(uvs, "uvs", &[Some(count), Some(2)])?;
            mesh = mesh.with_uvs(uvs.as_chunks::<2>().0.to_vec());
        }
        if let Some(colors) = &self.colors {
            mesh.colors = Some(Attribute::per_vertex(vertex_colors(colors, count)?));
        }
        if let Some(normals) = &self.normals {
            let (_, normals) = numbers::<f32>(normals, "normals", &[Some(count), Some(3)])?;
            mesh = mesh.with_normals(normals.as_chunks::<3>().0.to_vec());
        }
        mesh.check().map_err(PyValueError::new_err)?;
        let makes_normals =
            self.normals.is_none() && self.crease_angle > 0.0 && !mesh.triangles.is_empty();
        Ok(if makes_normals {
            mesh.with_smooth_normals(self.crease_angle.to_radians())
        } else {
            mesh
        })
    }
}

/// Faces as they were given.
enum Faces {
    Triangles(Vec<[u32; 3]>),
    Polygons(Vec<Vec<u32>>),
}

impl Faces {
    fn mesh(self, positions: Vec<[f32; 3]>) -> Mesh {
        match self {
            Self::Triangles(triangles) => Mesh::new(positions, triangles),
            Self::Polygons(polygons) => Mesh::from_polygons(positions, polygons),
        }
    }
}

/// Faces from an array, or from a list of polygons.
fn faces(value: &Bound<'_, PyAny>, vertices: usize) -> PyResult<Faces> {
    // Check that an index names a vertex.
    let index = |index: i64| {
        let there = u32::try_from(index).ok().filter(|&index| (index as usize) < vertices);
        there.ok_or_else(|| {
            PyIndexError::new_err(format!(
                "faces: there is no vertex {index}, there are {vertices}"
            ))
        })
    };
    let rows = value.len()?;
    if rows == 0 {
        return Ok(Faces::Triangles(Vec::new()));
    }

    // Rows of one length are an array.
    let first = value.get_item(0)?;
    let is_array = value.hasattr("dtype")?;
    let corners = first.len().unwrap_or(0);
    let is_even = is_array
        || (0..rows)
            .all(|row| value.get_item(row).and_then(|row| row.len()).is_ok_and(|n| n == corners));
    if is_even {
        let (shape, indices) = numbers::<i64>(value, "faces", &[None, None])?;
        if shape[1] < 3 {
            let needed = "faces: an array of shape (m, 3) or a list of polygons is needed";
            return Err(PyValueError::new_err(format!(
                "{needed}, got {}",
                shown(&[Some(shape[0]), Some(shape[1])])
            )));
        }
        let indices = indices.into_iter().map(index).collect::<PyResult<Vec<_>>>()?;
        return Ok(match shape[1] {
            3 => Faces::Triangles(indices.as_chunks::<3>().0.to_vec()),
            corners => Faces::Polygons(indices.chunks(corners).map(<[u32]>::to_vec).collect()),
        });
    }

    // Read other rows polygon by polygon.
    let polygon = |polygon: Bound<'_, PyAny>| {
        let (shape, corners) = numbers::<i64>(&polygon, "faces", &[None])?;
        if shape[0] < 3 {
            return Err(PyValueError::new_err(format!(
                "faces: a polygon has at least three corners, got {}",
                shape[0]
            )));
        }
        corners.into_iter().map(index).collect()
    };
    Ok(Faces::Polygons(value.try_iter()?.map(|row| polygon(row?)).collect::<PyResult<_>>()?))
}

/// The kind of an array's dtype, as numpy names it, and the number of its columns.
fn kind_and_columns(value: &Bound<'_, PyAny>) -> PyResult<(String, usize)> {
    let array = value.py().import("numpy")?.call_method1("asarray", (value,))?;
    let shape: Vec<usize> = array.getattr("shape")?.extract()?;
    Ok((array.getattr("dtype")?.getattr("kind")?.extract()?, shape.last().copied().unwrap_or(0)))
}

/// Linear RGBA of each vertex.
fn vertex_colors(value: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<[f32; 4]>> {
    let (kind, columns) = kind_and_columns(value)?;
    let columns = if columns == 4 { 4 } else { 3 };
    let (_, numbers) = numbers::<f32>(value, "colors", &[Some(count), Some(columns)])?;
    let is_bytes = kind != "f";
    let limit = if is_bytes { 255.0 } else { 1.0 };
    if numbers.iter().any(|v| !(0.0..=limit).contains(v)) {
        return Err(PyValueError::new_err(
            "colors: bytes from 0 to 255, or floats from 0 to 1 are needed",
        ));
    }
    let color = |v: &[f32]| {
        let channel = |k: usize| if is_bytes { linear_from_srgb(v[k] / 255.0) } else { v[k] };
        let alpha = v.get(3).map_or(1.0, |alpha| alpha / limit);
        [channel(0), channel(1), channel(2), alpha]
    };
    Ok(numbers.chunks(columns).map(color).collect())
}

/// A texture from an image, uint8, shape (height, width, 3) or (height, width, 4).
pub(crate) fn texture(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Texture> {
    let (kind, columns) = kind_and_columns(value)?;
    if kind != "u" {
        return Err(PyTypeError::new_err(format!(
            "texture: uint8 is needed, got dtype kind {kind}"
        )));
    }
    let columns = if columns == 4 { 4 } else { 3 };
    let (shape, bytes) = numbers::<u8>(value, "texture", &[None, None, Some(columns)])?;
    let texel = |v: &[u8]| [v[0], v[1], v[2], v.get(3).copied().unwrap_or(255)];
    let texels: Vec<[u8; 4]> = bytes.chunks(columns).map(texel).collect();
    let plane = Plane::from_rows(shape[1] as u32, shape[0] as u32, texels);
    let plane = plane.ok_or_else(|| PyValueError::new_err("texture: an image is needed"))?;
    Ok(Texture::new(name.to_owned(), plane, Encoding::Srgb))
}
