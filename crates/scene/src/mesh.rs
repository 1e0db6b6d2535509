//! A mesh in model space: positions, faces as in the file, the triangles they were cut into, and
//! attributes.
//!
//! Positions are indexed by themselves; normals, texture coordinates and colours may have indices
//! of their own, as in OBJ. So a crease or a seam does not tear the surface apart, and edges are
//! found where the model has them.
//!
//! A **face** is a polygon as in the file (its number within the mesh gives the *surface id*).
//! Every polygon with `n` corners is cut into exactly `n - 2` triangles (its *facets*), in order,
//! so that triangle numbers follow from corner numbers.

use crate::KnownSolidity;
use crate::cut_marks::Section;
use std::ops::Range;
use std::sync::Arc;
use vitral_exec::Workers;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, LANES, Level, Simd, dispatch};
use vitral_math::{Aabb, DVec3};

/// Consecutive triangles that share a box of [`Mesh::run_bounds`].
pub const TRIANGLES_A_RUN: usize = 256;

/// Three indices, one a corner of a triangle.
pub type Corners = [u32; 3];

/// A mesh. Constructed by loaders and builders; [`Mesh::check`] tells whether it is sound.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// For messages; may be empty.
    pub name: String,
    /// Vertex positions, model space.
    pub positions: Vec<[f32; 3]>,
    /// Triangles as indices into `positions`, face by face.
    pub triangles: Vec<Corners>,
    /// How triangles form the file's faces.
    pub faces: Faces,
    /// Ranges of triangles with one material each, in order, together covering all triangles.
    pub parts: Vec<Part>,
    /// Shading normals, any positive length (need not be unit).
    pub normals: Option<Attribute<[f32; 3]>>,
    /// Normals are not the surface's: they stay as they are where its back is seen (exercise 5.2).
    pub normals_stay: bool,
    /// Directions in which the normal texture's u grows, model space, zero where none is known; `w`
    /// is 1 where its falling v, the upwards of the picture, is normal × tangent, and -1 where it
    /// is the opposite. `None`: made from normals and texture coordinates, see
    /// [`tangents`](crate::tangents::tangents).
    pub tangents: Option<Attribute<[f32; 4]>>,
    /// Up to two sets of texture coordinates, `(0, 0)` at the image's top left.
    pub uvs: Vec<Attribute<[f32; 2]>>,
    /// Linear RGBA that multiplies the material's diffuse or base colour.
    pub colors: Option<Attribute<[f32; 4]>>,
    /// Whether the file had `colors` in sRGB. They are linear here all the same; the raw colour
    /// space shows them as the file had them.
    pub colors_from_srgb: bool,
    /// Free line segments, as pairs of indices into `positions`.
    pub lines: Vec<[u32; 2]>,
    /// Free points, as indices into `positions`.
    pub points: Vec<u32>,
    /// Runs of `lines` with one material each, in order, from the first; lines behind the last run
    /// have none.
    pub line_parts: Vec<FreePart>,
    /// The same for `points`.
    pub point_parts: Vec<FreePart>,
    /// Smoothing group of each face (OBJ; 0 = none), if the file has any: faces of one group are
    /// smooth together.
    pub smoothing_groups: Option<Vec<u32>>,
    /// What was found out about the surface while normals were made; counts as long as positions
    /// and triangles stay as they were then.
    pub solidity: Option<KnownSolidity>,
    /// What planes of section have made of it ([`Scene::cut`](crate::Scene::cut)).
    pub section: Option<Arc<Section>>,
}

/// Values at corners.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attribute<T> {
    /// The values that corners or vertices refer to.
    pub values: Vec<T>,
    /// For each triangle, which values its corners take; `None`: the same indices as the positions.
    pub corners: Option<Vec<Corners>>,
}

impl<T: Copy> Attribute<T> {
    /// Values that go with the positions.
    pub fn per_vertex(values: Vec<T>) -> Self {
        Self { values, corners: None }
    }

    /// The values at the corners of triangle `t` of `mesh_triangles`.
    pub fn at(&self, t: usize, mesh_triangles: &[Corners]) -> [T; 3] {
        let corners = self.corners.as_deref().unwrap_or(mesh_triangles);
        corners[t].map(|i| self.values[i as usize])
    }
}

/// How triangles form faces.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Faces {
    /// Each triangle is a face.
    #[default]
    Triangles,
    /// Polygons. Face `f` has the corners `corners[starts[f]..starts[f + 1]]`, at least three, as
    /// indices into the positions; its triangles are
    /// `starts[f] - 2 f .. starts[f + 1] - 2 (f + 1)`.
    Polygons {
        /// One more than there are faces; the first is 0.
        starts: Vec<u32>,
        /// Outlines, one after the other.
        corners: Vec<u32>,
    },
}

/// Triangles with one material.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Group or object name; may be empty.
    pub name: String,
    /// Which triangles.
    pub triangles: Range<u32>,
    /// Index into the scene's materials; `None`: the default material.
    pub material: Option<u32>,
}

/// Free lines or points with one material, one after the other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FreePart {
    /// Which lines or points.
    pub elements: Range<u32>,
    /// Index into the scene's materials; `None`: they have none.
    pub material: Option<u32>,
}

impl FreePart {
    /// Gives the lines or points `elements`, behind all that have a part, a material.
    pub fn extend(parts: &mut Vec<Self>, elements: Range<usize>, material: Option<u32>) {
        let (start, end) = (elements.start as u32, elements.end as u32);
        if material.is_none() || start == end {
            return;
        }
        let reached = parts.last().map_or(0, |p| p.elements.end);
        match parts.last_mut() {
            Some(last) if last.material == material && reached == start => last.elements.end = end,
            _ => {
                if reached < start {
                    parts.push(Self { elements: reached..start, material: None });
                }
                parts.push(Self { elements: start..end, material });
            }
        }
    }

    /// The material of line or point `i`.
    pub fn material_of(parts: &[Self], i: usize) -> Option<u32> {
        let part = parts.partition_point(|p| p.elements.end as usize <= i);
        parts.get(part).and_then(|p| p.material)
    }
}

impl Mesh {
    /// The materials that parts, lines and points name.
    pub fn materials(&self) -> impl Iterator<Item = u32> + '_ {
        let free = self.line_parts.iter().chain(&self.point_parts).filter_map(|p| p.material);
        self.parts.iter().filter_map(|p| p.material).chain(free)
    }

    /// The materials of parts, lines and points, to be changed.
    pub fn materials_mut(&mut self) -> impl Iterator<Item = &mut Option<u32>> + '_ {
        let free = self.line_parts.iter_mut().chain(&mut self.point_parts).map(|p| &mut p.material);
        self.parts.iter_mut().map(|p| &mut p.material).chain(free)
    }

    /// Number of faces.
    pub fn face_count(&self) -> usize {
        match &self.faces {
            Faces::Triangles => self.triangles.len(),
            Faces::Polygons { starts, .. } => starts.len().saturating_sub(1),
        }
    }

    /// The triangles of face `f`.
    pub fn face_triangles(&self, f: usize) -> Range<usize> {
        match &self.faces {
            Faces::Triangles => f..f + 1,
            Faces::Polygons { starts, .. } => {
                starts[f] as usize - 2 * f..starts[f + 1] as usize - 2 * (f + 1)
            }
        }
    }

    /// The corners of face `f`, as indices into the positions.
    pub fn face_corners(&self, f: usize) -> &[u32] {
        match &self.faces {
            Faces::Triangles => &self.triangles[f],
            Faces::Polygons { starts, corners } => {
                &corners[starts[f] as usize..starts[f + 1] as usize]
            }
        }
    }

    /// The face that triangle `t` belongs to.
    pub fn face_of_triangle(&self, t: usize) -> usize {
        match &self.faces {
            Faces::Triangles => t,
            Faces::Polygons { starts, .. } => {
                // First triangles `starts[f] - 2 f` grow strictly with f: binary search.
                let (mut low, mut high) = (0, starts.len() - 1);
                while high - low > 1 {
                    let middle = (low + high) / 2;
                    if starts[middle] as usize - 2 * middle <= t {
                        low = middle
                    } else {
                        high = middle
                    }
                }
                low
            }
        }
    }

    /// The outlines of all faces, one after the other.
    pub(crate) fn corner_list(&self) -> &[u32] {
        match &self.faces {
            Faces::Triangles => self.triangles.as_flattened(),
            Faces::Polygons { corners, .. } => corners,
        }
    }

    /// Where face `f` begins in [`Self::corner_list`].
    pub(crate) fn first_corner(&self, f: usize) -> usize {
        match &self.faces {
            Faces::Triangles => 3 * f,
            Faces::Polygons { starts, .. } => starts[f] as usize,
        }
    }

    /// The position of vertex `i`.
    pub(crate) fn position(&self, i: u32) -> DVec3 {
        DVec3::from_array(self.positions[i as usize].map(f64::from))
    }

    /// The boxes round the finite corners of each [`TRIANGLES_A_RUN`] triangles in order, model
    /// space.
    pub fn run_bounds(&self, workers: &Workers) -> Vec<Aabb> {
        const BATCH: usize = 64;
        let mut boxes = vec![Aabb::EMPTY; self.triangles.len().div_ceil(TRIANGLES_A_RUN)];
        workers.for_each_chunk(&mut boxes, BATCH, |batch, boxes| {
            let runs = self.triangles[batch * BATCH * TRIANGLES_A_RUN..].chunks(TRIANGLES_A_RUN);
            for (of_run, run) in boxes.iter_mut().zip(runs) {
                *of_run = self.bounds_of(run.as_flattened());
            }
        });
        boxes
    }

    /// The box round all finite positions that something uses, model space: a stray vertex is not
    /// to be seen.
    pub fn bounds(&self) -> Aabb {
        self.bounds_from(&self.run_bounds(&Workers::single()))
    }

    /// [`Self::bounds`] where the result of [`Self::run_bounds`] is known.
    pub fn bounds_from(&self, run_bounds: &[Aabb]) -> Aabb {
        let free = self.bounds_of(self.lines.as_flattened()).union(&self.bounds_of(&self.points));
        run_bounds.iter().fold(free, |all, run| all.union(run))
    }

    /// The box round the finite ones among these vertices.
    fn bounds_of(&self, vertices: &[u32]) -> Aabb {
        dispatch!(Level::new(), simd => self.bounds_in_lanes(simd, vertices))
    }

    /// [`Self::bounds_of`], in single precision throughout, which is exact.
    #[inline(always)]
    fn bounds_in_lanes<S: Simd>(&self, simd: S, vertices: &[u32]) -> Aabb {
        let splat = lanes::inlined(
            #[inline(always)]
            |value: f32| F32x8::splat(simd, value),
        );
        let (zero, most) = (splat(0.0), splat(f32::INFINITY));
        let (mut min, mut max) = ([most; 3], [-most; 3]);
        for eight in vertices.chunks(LANES) {
            let columns = lanes::columns_of_rows(
                simd,
                #[inline(always)]
                |lane| {
                    let vertex = eight[lane.min(eight.len() - 1)] as usize;
                    let [x, y, z] = self.positions.get(vertex).copied().unwrap_or([f32::NAN; 3]);
                    bytemuck::cast([x, y, z, 0.0])
                },
            );
            let p: [F32x8<S>; 3] =
                [columns[0].bitcast(), columns[1].bitcast(), columns[2].bitcast()];
            // Only a finite number times 0 is 0.
            let finite = (p[0] * 0.0 + p[1] * 0.0 + p[2] * 0.0).simd_eq(zero);
            for k in 0..3 {
                min[k] = lanes::Lanes::min(finite.select(p[k], most), min[k]);
                max[k] = lanes::Lanes::max(finite.select(p[k], -most), max[k]);
            }
        }
        // Which of two zeros is the lesser is left to the processor: plus 0.0, both are 0.0.
        let least =
            |of: F32x8<S>| f64::from(of.to_array().into_iter().fold(f32::INFINITY, f32::min) + 0.0);
        let greatest = |of: F32x8<S>| {
            f64::from(of.to_array().into_iter().fold(f32::NEG_INFINITY, f32::max) + 0.0)
        };
        Aabb {
            min: DVec3::new(least(min[0]), least(min[1]), least(min[2])),
            max: DVec3::new(greatest(max[0]), greatest(max[1]), greatest(max[2])),
        }
    }

    /// The material of triangle `t`.
    pub fn material_of_triangle(&self, t: usize) -> Option<u32> {
        let i = self.parts.partition_point(|p| p.triangles.end as usize <= t);
        self.parts.get(i).and_then(|p| p.material)
    }

    /// Tells what is unsound: an index out of range, a part list with gaps, attribute counts that
    /// do not fit.
    ///
    /// # Errors
    /// The first unsound thing, in words.
    pub fn check(&self) -> Result<(), String> {
        self.check_with(&Workers::single())
    }

    /// [`Self::check`] with all of `workers`.
    ///
    /// # Errors
    /// As [`Self::check`].
    pub fn check_with(&self, workers: &Workers) -> Result<(), String> {
        self.check_primitives(workers)?;
        self.check_faces(workers)?;
        self.check_parts()?;
        self.check_free_parts("line", &self.line_parts, self.lines.len())?;
        self.check_free_parts("point", &self.point_parts, self.points.len())?;
        self.check_attributes(workers)?;
        if self.smoothing_groups.as_ref().is_some_and(|g| g.len() != self.face_count()) {
            return Err(format!("mesh `{}`: smoothing groups do not fit the faces", self.name));
        }
        Ok(())
    }

    /// Refuses an index that is not below `count`.
    fn check_indices(
        &self,
        what: &str,
        indices: &[u32],
        count: usize,
        workers: &Workers,
    ) -> Result<(), String> {
        const PIECE: usize = 1 << 17;
        // The greatest is found many at a time; which one is bad only matters where one is.
        let greatest = workers.map(indices.len().div_ceil(PIECE), |piece| {
            let piece = &indices[piece * PIECE..indices.len().min((piece + 1) * PIECE)];
            piece.iter().fold(0, |greatest, &index| index.max(greatest))
        });
        if greatest.into_iter().max().is_none_or(|greatest| (greatest as usize) < count) {
            return Ok(());
        }
        let k = indices.iter().position(|&i| i as usize >= count).unwrap_or_default();
        Err(format!("mesh `{}`: {what} {k}: index {}, there are {count}", self.name, indices[k]))
    }

    /// That triangles, lines and points are made of vertices.
    fn check_primitives(&self, workers: &Workers) -> Result<(), String> {
        let vertices = self.positions.len();
        self.check_indices("triangle corner", self.triangles.as_flattened(), vertices, workers)?;
        self.check_indices("line end", self.lines.as_flattened(), vertices, workers)?;
        self.check_indices("point", &self.points, vertices, workers)
    }

    /// That faces are polygons with as many triangles as they need.
    fn check_faces(&self, workers: &Workers) -> Result<(), String> {
        let Faces::Polygons { starts, corners } = &self.faces else { return Ok(()) };
        self.check_indices("face corner", corners, self.positions.len(), workers)?;
        let ordered = starts.first() == Some(&0) && starts.windows(2).all(|w| w[1] >= w[0] + 3);
        let fits = starts.last().is_some_and(|&last| {
            last as usize == corners.len()
                && last as usize == self.triangles.len() + 2 * (starts.len() - 1)
        });
        if ordered && fits {
            Ok(())
        } else {
            Err(format!("mesh `{}`: faces and triangles do not fit", self.name))
        }
    }

    /// That parts cover all triangles without a gap.
    fn check_parts(&self) -> Result<(), String> {
        let mut next = 0;
        for part in &self.parts {
            if part.triangles.start != next || part.triangles.end < next {
                return Err(format!("mesh `{}`: parts leave a gap at triangle {next}", self.name));
            }
            next = part.triangles.end;
        }
        if next as usize != self.triangles.len() {
            return Err(format!(
                "mesh `{}`: parts end at {next} of {} triangles",
                self.name,
                self.triangles.len()
            ));
        }
        Ok(())
    }

    /// That parts of `count` lines or points follow each other without a gap.
    fn check_free_parts(&self, what: &str, parts: &[FreePart], count: usize) -> Result<(), String> {
        let mut next = 0;
        for part in parts {
            if part.elements.start != next || part.elements.end < next {
                return Err(format!(
                    "mesh `{}`: {what} parts leave a gap at {what} {next}",
                    self.name
                ));
            }
            next = part.elements.end;
        }
        if next as usize > count {
            return Err(format!(
                "mesh `{}`: {what} parts end at {next} of {count} {what}s",
                self.name
            ));
        }
        Ok(())
    }

    /// That every corner has its value of each attribute.
    fn check_attributes(&self, workers: &Workers) -> Result<(), String> {
        let vertices = self.positions.len();
        let check = |what: &str, count: usize, corners: Option<&[Corners]>| match corners {
            Some(c) if c.len() != self.triangles.len() => Err(format!(
                "mesh `{}`: {what} for {} of {} triangles",
                self.name,
                c.len(),
                self.triangles.len()
            )),
            Some(c) => self.check_indices(what, c.as_flattened(), count, workers),
            None if count != vertices => {
                Err(format!("mesh `{}`: {count} {what}s for {vertices} vertices", self.name))
            }
            None => Ok(()),
        };
        if let Some(n) = &self.normals {
            check("normal", n.values.len(), n.corners.as_deref())?;
        }
        if let Some(t) = &self.tangents {
            check("tangent", t.values.len(), t.corners.as_deref())?;
        }
        for uv in &self.uvs {
            check("texture coordinate", uv.values.len(), uv.corners.as_deref())?;
        }
        if let Some(c) = &self.colors {
            check("colour", c.values.len(), c.corners.as_deref())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A triangle, a quad and a triangle.
    fn strip() -> Mesh {
        Mesh {
            positions: vec![[0.0; 3]; 6],
            triangles: vec![[0, 1, 2], [1, 2, 3], [1, 3, 4], [3, 4, 5]],
            faces: Faces::Polygons {
                starts: vec![0, 3, 7, 10],
                corners: vec![0, 1, 2, 1, 2, 3, 4, 3, 4, 5],
            },
            parts: vec![Part { name: String::new(), triangles: 0..4, material: None }],
            ..Mesh::default()
        }
    }

    #[test]
    fn triangles_and_faces_find_each_other() {
        let mesh = strip();
        mesh.check().unwrap();
        assert_eq!(mesh.face_count(), 3);
        assert_eq!((0..4).map(|t| mesh.face_of_triangle(t)).collect::<Vec<_>>(), [0, 1, 1, 2]);
        assert_eq!(mesh.face_triangles(1), 1..3);
        assert_eq!(mesh.face_corners(1), [1, 2, 3, 4]);
    }

    #[test]
    fn stray_vertices_do_not_count() {
        let mut mesh = strip();
        mesh.positions[5] = [1.0, 2.0, 3.0];
        mesh.positions.push([9.0; 3]);
        assert_eq!(mesh.bounds().max, DVec3::new(1.0, 2.0, 3.0));
    }

    #[test]
    fn lines_have_materials_run_by_run() {
        let mut parts = Vec::new();
        for (elements, material) in
            [(0..2, None), (2..3, Some(4)), (3..5, Some(4)), (5..5, Some(1)), (6..7, Some(0))]
        {
            FreePart::extend(&mut parts, elements, material);
        }
        let runs: Vec<_> = parts.iter().map(|p| (p.elements.clone(), p.material)).collect();
        assert_eq!(runs, [(0..2, None), (2..5, Some(4)), (5..6, None), (6..7, Some(0))]);
        let of = |i| FreePart::material_of(&parts, i);
        assert_eq!(
            [of(1), of(2), of(4), of(5), of(6), of(7)],
            [None, Some(4), Some(4), None, Some(0), None]
        );
        let mut mesh = strip();
        (mesh.lines, mesh.line_parts) = (vec![[0, 1]; 6], parts);
        assert!(mesh.check().unwrap_err().contains("line parts end at 7 of 6"));
        mesh.lines.push([1, 2]);
        mesh.check().unwrap();
        mesh.line_parts.remove(1);
        assert!(mesh.check().unwrap_err().contains("leave a gap at line 2"));
    }

    #[test]
    fn unsound_meshes_are_told() {
        let mut mesh = strip();
        mesh.triangles[2][1] = 6;
        assert!(mesh.check().unwrap_err().contains("index 6, there are 6"));
        let mut mesh = strip();
        mesh.parts[0].triangles = 0..3;
        assert!(mesh.check().unwrap_err().contains("parts end at 3 of 4"));
    }
}
