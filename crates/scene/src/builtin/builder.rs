//! Puts meshes together polygon by polygon, with separate indices for positions, normals and
//! texture coordinates.

use crate::{Attribute, Corners, Faces, Mesh, Part};
use vitral_math::{DVec2, DVec3};

/// A corner of a polygon: indices of its position, normal and texture coordinate.
pub(crate) type Corner = [u32; 3];

/// A mesh under construction.
pub(crate) struct Builder {
    mesh: Mesh,
    starts: Vec<u32>,
    corners: Vec<u32>,
    normals: Attribute<[f32; 3]>,
    uvs: Attribute<[f32; 2]>,
    normal_corners: Vec<Corners>,
    uv_corners: Vec<Corners>,
}

impl Builder {
    pub(crate) fn new(name: &str) -> Self {
        Self {
            mesh: Mesh { name: name.to_owned(), ..Mesh::default() },
            starts: vec![0],
            corners: Vec::new(),
            normals: Attribute::default(),
            uvs: Attribute::default(),
            normal_corners: Vec::new(),
            uv_corners: Vec::new(),
        }
    }

    /// Adds a position; gives its index.
    pub(crate) fn position(&mut self, p: DVec3) -> u32 {
        // Adding 0 makes -0 to 0: one place, one pattern of bits.
        self.mesh.positions.push((p + 0.0).as_vec3().to_array());
        self.mesh.positions.len() as u32 - 1
    }

    /// Adds a normal; gives its index.
    pub(crate) fn normal(&mut self, n: DVec3) -> u32 {
        self.normals.values.push((n + 0.0).as_vec3().to_array());
        self.normals.values.len() as u32 - 1
    }

    /// Adds a texture coordinate; gives its index.
    pub(crate) fn uv(&mut self, u: f64, v: f64) -> u32 {
        self.uvs.values.push(DVec2::new(u, v).as_vec2().to_array());
        self.uvs.values.len() as u32 - 1
    }

    /// Adds a convex polygon with at least three corners, counter-clockwise seen from outside, as a
    /// fan of triangles.
    pub(crate) fn polygon(&mut self, corners: &[Corner]) {
        self.corners.extend(corners.iter().map(|c| c[0]));
        self.starts.push(self.corners.len() as u32);
        for pair in corners[1..].windows(2) {
            let fan = |k: usize| [corners[0][k], pair[0][k], pair[1][k]];
            self.mesh.triangles.push(fan(0));
            self.normal_corners.push(fan(1));
            self.uv_corners.push(fan(2));
        }
    }

    /// Ends a part: the triangles since the last part.
    pub(crate) fn end_part(&mut self, name: &str) {
        let start = self.mesh.parts.last().map_or(0, |p| p.triangles.end);
        let triangles = start..self.mesh.triangles.len() as u32;
        self.mesh.parts.push(Part { name: name.to_owned(), triangles, material: None });
    }

    /// The mesh. Triangles after the last part become a part of their own.
    pub(crate) fn finish(mut self) -> Mesh {
        if self.mesh.parts.last().map_or(0, |p| p.triangles.end) < self.mesh.triangles.len() as u32
        {
            let name = self.mesh.name.clone();
            self.end_part(&name);
        }
        self.mesh.faces = Faces::Polygons { starts: self.starts, corners: self.corners };
        self.normals.corners = Some(self.normal_corners);
        self.uvs.corners = Some(self.uv_corners);
        self.mesh.normals = Some(self.normals);
        self.mesh.uvs = vec![self.uvs];
        self.mesh
    }
}
