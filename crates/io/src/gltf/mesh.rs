//! From a glTF mesh to ours: its primitives become parts of one mesh, one after the other.
//!
//! Primitives with the same attribute accessors share their vertices, and only the range of
//! vertices that indices use is read: files that keep all vertices in one accessor are not
//! multiplied. A mesh shown in several poses (other morph weights, a skin) is built once a pose;
//! all other nodes share one.
//!
//! In:   primitives and their accessors. Out: a sound [`Mesh`] in model space (skinned: world
//!       space).
//! Cost: linear in vertices and indices. Memory is estimated before anything large is made, and
//! refused when a small file would unfold into a huge scene.
//! Source: [glTF 2.0], section 3.7.2. Departs from it: a mesh wholly without normals keeps none
//! (the renderer makes them with a crease angle, not flat).

use super::accessor::{Integers, Source};
use super::block::Block;
use super::deform;
use super::document::material_index;
use super::geometry::{Attributes, Outline};
use super::normals;
use crate::Error;
use vitral_math::DMat4;
use vitral_scene::{Attribute, Faces, FreePart, Mesh, Part};

/// A glTF mesh in one pose.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pose {
    pub(crate) mesh: usize,
    /// Morph weights, empty if all are zero.
    pub(crate) weights: Vec<f32>,
    pub(crate) skin: Option<usize>,
}

/// A mesh whose indices have been read.
pub(crate) struct Plan {
    name: String,
    /// Each primitive that draws something: its outline, its block, its material.
    outlines: Vec<(Outline, usize, Option<u32>)>,
    pub(crate) blocks: Vec<Block>,
    pub(crate) warnings: Vec<String>,
}

impl Plan {
    /// Reads the indices of all primitives of mesh `m` and lays out its vertices.
    pub(crate) fn new(source: &Source<'_>, m: usize) -> Result<Self, Error> {
        let mesh = &source.root.meshes[m];
        let name = mesh.name.clone().unwrap_or_default();
        let mut plan =
            Self { name, outlines: Vec::new(), blocks: Vec::new(), warnings: Vec::new() };

        // Read the outline of each primitive that has positions.
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let path = format!("meshes[{m}].primitives[{p}]");
            let Some(attributes) = Attributes::find(source, primitive, &path, &mut plan.warnings)?
            else {
                plan.warnings
                    .push(format!("{}: {path}: no POSITION, nothing is drawn", source.file));
                continue;
            };
            let outline = Outline::read(source, primitive, attributes, &path, &mut plan.warnings)?;

            // Share the block of vertices with the primitives of the same attributes.
            let block =
                plan.blocks.iter().position(|b| b.attributes == outline.attributes).unwrap_or_else(
                    || {
                        let attributes = outline.attributes.clone();
                        let range = outline.used.clone();
                        plan.blocks.push(Block {
                            attributes,
                            range,
                            base: 0,
                            path,
                            has_surface: false,
                        });
                        plan.blocks.len() - 1
                    },
                );

            // Widen the block to the vertices that the primitive uses.
            let shared = &mut plan.blocks[block];
            shared.has_surface |= outline.is_surface();
            if shared.range.is_empty() {
                shared.range = outline.used.clone();
            } else if !outline.used.is_empty() {
                let (start, end) = (
                    shared.range.start.min(outline.used.start),
                    shared.range.end.max(outline.used.end),
                );
                shared.range = start..end;
            }
            plan.outlines.push((outline, block, material_index(primitive)));
        }

        // Lay the blocks out one after the other.
        let mut next = 0usize;
        for block in &mut plan.blocks {
            block.base = next as u32;
            next += block.range.len();
        }
        if u32::try_from(next).is_err() {
            return Err(source.error(
                format!("meshes[{m}]"),
                format!("{next} vertices, at most 4294967295 are read"),
            ));
        }
        Ok(plan)
    }

    /// Bytes that the mesh will take.
    pub(crate) fn bytes(&self) -> u64 {
        let vertices: u64 =
            self.blocks.iter().map(|b| b.range.len() as u64 * b.attributes.vertex_bytes()).sum();
        vertices + self.outlines.iter().map(|(outline, ..)| outline.bytes()).sum::<u64>()
    }

    /// Builds the mesh in a pose. `joints` are the matrices of the pose's skin.
    pub(crate) fn build(
        &self,
        source: &Source<'_>,
        pose: &Pose,
        joints: Option<&[DMat4]>,
    ) -> Result<(Mesh, Vec<String>), Error> {
        let mut mesh = Mesh { name: self.name.clone(), faces: Faces::Triangles, ..Mesh::default() };
        let mut warnings = Vec::new();
        self.add_topology(&mut mesh);

        // Read the vertices, in the pose.
        let mut block_normals = Vec::with_capacity(self.blocks.len());
        for block in &self.blocks {
            let (positions, normals) = read_posed(source, block, pose, joints, &mut warnings)?;
            mesh.positions.extend(positions);
            block_normals.push(normals);
        }
        self.add_colors_and_uvs(source, &mut mesh, &mut warnings)?;
        if pose.weights.is_empty() && joints.is_none() {
            mesh.tangents = self.tangents(source)?;
        }
        let label = format!("{}: meshes[{}]", source.file, pose.mesh);
        let infinite = mesh.positions.iter().filter(|p| !p.iter().all(|c| c.is_finite())).count();
        if infinite > 0 {
            let total = mesh.positions.len();
            warnings
                .push(format!("{label}: {infinite} of {total} positions are not finite; what uses them is not drawn"));
        }
        mesh.normals = normals::assemble(&self.blocks, block_normals, &mesh, &label, &mut warnings);
        Ok((mesh, warnings))
    }

    /// Adds triangles, lines and points, part by part.
    fn add_topology(&self, mesh: &mut Mesh) {
        for (outline, block, material) in &self.outlines {
            let (block, first) = (&self.blocks[*block], mesh.triangles.len() as u32);
            let (lines, points) = (mesh.lines.len(), mesh.points.len());
            outline.add_to(mesh, block.base, block.range.start as u32);
            if outline.is_surface() {
                let triangles = first..mesh.triangles.len() as u32;
                mesh.parts.push(Part { name: String::new(), triangles, material: *material });
            }
            FreePart::extend(&mut mesh.line_parts, lines..mesh.lines.len(), *material);
            FreePart::extend(&mut mesh.point_parts, points..mesh.points.len(), *material);
        }
    }

    /// The file's tangents, if all surfaces have some. Who changes the pose gets made ones, as
    /// where there are none.
    fn tangents(&self, source: &Source<'_>) -> Result<Option<Attribute<[f32; 4]>>, Error> {
        let mut surfaces = self.blocks.iter().filter(|b| b.has_surface).peekable();
        if surfaces.peek().is_none() || surfaces.any(|b| b.attributes.tangents.is_none()) {
            return Ok(None);
        }
        let mut values = Vec::new();
        for block in &self.blocks {
            let first = values.len();
            match block.attributes.tangents {
                Some(accessor) => {
                    let path = format!("{}.attributes.TANGENT", block.path);
                    values.extend(source.floats::<4>(
                        accessor,
                        block.range.clone(),
                        Integers::AsDeclared,
                        &path,
                    )?);
                }
                None => values.resize(first + block.range.len(), [0.0; 4]),
            }
            // What is no direction is made from the texture coordinates of the triangle.
            values[first..]
                .iter_mut()
                .filter(|t| !t.iter().all(|c| c.is_finite()))
                .for_each(|t| *t = [0.0; 4]);
        }
        Ok(Some(Attribute::per_vertex(values)))
    }

    /// Adds vertex colours and texture coordinates; blocks without them get white and the origin.
    fn add_colors_and_uvs(
        &self,
        source: &Source<'_>,
        mesh: &mut Mesh,
        warnings: &mut Vec<String>,
    ) -> Result<(), Error> {
        let any = |f: &dyn Fn(&Attributes) -> bool| self.blocks.iter().any(|b| f(&b.attributes));
        let mut bad = 0;

        // Join the colours of all blocks.
        if any(&|a| a.colors.is_some()) {
            let mut values = Vec::with_capacity(mesh.positions.len());
            for block in &self.blocks {
                match block.attributes.colors {
                    Some(accessor) => values.extend(read_colors(source, block, accessor)?),
                    None => values.resize(values.len() + block.range.len(), [1.0; 4]),
                }
            }
            bad += made_finite(values.as_flattened_mut());

            // Join each set of texture coordinates.
            mesh.colors = Some(Attribute::per_vertex(values));
        }
        let sets =
            (0..2).rev().find(|&set| any(&|a| a.uvs[set].is_some())).map_or(0, |last| last + 1);
        for set in 0..sets {
            let mut values = Vec::with_capacity(mesh.positions.len());
            for block in &self.blocks {
                let path = format!("{}.attributes.TEXCOORD_{set}", block.path);
                match block.attributes.uvs[set] {
                    Some(a) => values.extend(source.floats::<2>(
                        a,
                        block.range.clone(),
                        Integers::AsDeclared,
                        &path,
                    )?),
                    None => values.resize(values.len() + block.range.len(), [0.0; 2]),
                }
            }
            bad += made_finite(values.as_flattened_mut());
            mesh.uvs.push(Attribute::per_vertex(values));
        }
        if bad > 0 {
            // Warn of numbers that were made finite.
            let path = self.blocks.first().map_or("", |b| &b.path);
            warnings.push(format!(
                "{}: {path}: {bad} colours or texture coordinates are not finite, taken as 0",
                source.file
            ));
        }
        Ok(())
    }
}

/// Puts 0 where a value is not finite; tells how often.
fn made_finite(values: &mut [f32]) -> usize {
    let mut bad = 0;
    for v in values {
        if !v.is_finite() {
            *v = 0.0;
            bad += 1;
        }
    }
    bad
}

type Vectors = Vec<[f32; 3]>;

/// Positions and normals of a block, morphed and skinned.
fn read_posed(
    source: &Source<'_>,
    block: &Block,
    pose: &Pose,
    joints: Option<&[DMat4]>,
    warnings: &mut Vec<String>,
) -> Result<(Vectors, Option<Vectors>), Error> {
    let (attributes, range, path) = (&block.attributes, &block.range, &block.path);
    let read = |accessor, name: &str| {
        source.floats::<3>(
            accessor,
            range.clone(),
            Integers::AsDeclared,
            &format!("{path}.attributes.{name}"),
        )
    };
    let mut positions = read(attributes.positions, "POSITION")?;
    let mut normals = attributes.normals.map(|accessor| read(accessor, "NORMAL")).transpose()?;
    deform::morph(
        source,
        attributes,
        range,
        &pose.weights,
        &mut positions,
        normals.as_mut(),
        path,
    )?;
    if let Some(joints) = joints {
        if attributes.influences.is_empty() {
            warnings.push(format!(
                "{}: {path}: a skin, but no JOINTS_0 and WEIGHTS_0; not moved",
                source.file
            ));
        }
        deform::skin(source, attributes, range, joints, &mut positions, normals.as_mut(), path)?;
    }
    Ok((positions, normals))
}

/// Linear RGBA; three components get an alpha of 1.
fn read_colors(
    source: &Source<'_>,
    block: &Block,
    accessor: usize,
) -> Result<Vec<[f32; 4]>, Error> {
    let path = format!("{}.attributes.COLOR_0", block.path);
    if source.shape(accessor).is_some_and(|s| s.multiplicity() == 3) {
        let rgb = source.floats::<3>(accessor, block.range.clone(), Integers::Normalized, &path)?;
        return Ok(rgb.into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect());
    }
    source.floats::<4>(accessor, block.range.clone(), Integers::Normalized, &path)
}
