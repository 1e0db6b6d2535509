//! Topology: what a primitive's mode makes of a list of vertices, and which vertices it needs.
//!
//! Cost: linear in the number of indices. Source: [glTF 2.0], section 3.7.2.

use super::accessor::Source;
use crate::Error;
use gltf::json::accessor::Type;
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;
use std::ops::Range;
use vitral_scene::{Corners, Mesh};

/// Sets of joints and weights that are read, four influences each.
const JOINT_SETS: u32 = 2;

/// Accessors of the vertices of a primitive. Primitives with equal ones share their vertices.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Attributes {
    pub(crate) positions: usize,
    pub(crate) normals: Option<usize>,
    /// Only where there are normals, to which they belong.
    pub(crate) tangents: Option<usize>,
    pub(crate) uvs: [Option<usize>; 2],
    pub(crate) colors: Option<usize>,
    /// Joints and weights, set by set.
    pub(crate) influences: Vec<(usize, usize)>,
    /// Displacements of positions and normals of each morph target.
    pub(crate) targets: Vec<(Option<usize>, Option<usize>)>,
}

/// A primitive with its indices.
pub(crate) struct Outline {
    pub(crate) attributes: Attributes,
    pub(crate) mode: Mode,
    /// `None`: the vertices in their order.
    indices: Option<Vec<u32>>,
    /// The vertices that are used.
    pub(crate) used: Range<usize>,
}

impl Attributes {
    /// Finds the accessors of a primitive and checks that they have equally many elements. `None`:
    /// there are no positions, so there is nothing to draw. Adds passed-over parts to `warnings`.
    pub(crate) fn find(
        source: &Source<'_>,
        primitive: &Primitive,
        path: &str,
        warnings: &mut Vec<String>,
    ) -> Result<Option<Self>, Error> {
        // Find the positions and texture coordinates.
        let get = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).map(|a| a.value());
        let Some(positions) = get(Semantic::Positions) else { return Ok(None) };
        check_compression(source, primitive, positions, path)?;
        let uvs = [get(Semantic::TexCoords(0)), get(Semantic::TexCoords(1))];
        if uvs[0].is_none() && uvs[1].is_some() {
            warnings.push(format!(
                "{}: {path}: TEXCOORD_1 without TEXCOORD_0, which is taken as 0",
                source.file
            ));
        }

        // Warn of attributes that are not read.
        let mut unread: Vec<String> = primitive
            .attributes
            .keys()
            .filter(|key| match key {
                Checked::Valid(Semantic::TexCoords(set)) => *set > 1,
                Checked::Valid(Semantic::Colors(set)) => *set > 0,
                Checked::Valid(Semantic::Joints(set) | Semantic::Weights(set)) => {
                    *set >= JOINT_SETS
                }
                _ => false,
            })
            .map(ToString::to_string)
            .collect();
        if !unread.is_empty() {
            unread.sort();
            warnings.push(format!("{}: {path}: {} not used", source.file, unread.join(", ")));
        }

        // Find the influences of joints and the morph targets.
        let influences = (0..JOINT_SETS)
            .filter_map(|set| get(Semantic::Joints(set)).zip(get(Semantic::Weights(set))))
            .collect();
        let targets = primitive.targets.iter().flatten();
        let targets = targets
            .map(|t| (t.positions.map(|a| a.value()), t.normals.map(|a| a.value())))
            .collect();
        let found = Self {
            positions,
            normals: get(Semantic::Normals),
            tangents: get(Semantic::Normals).and(get(Semantic::Tangents)),
            uvs,
            colors: get(Semantic::Colors(0)),
            influences,
            targets,
        };
        found.check_counts(source, path)?;
        Ok(Some(found))
    }

    /// All accessors with the names that messages give them.
    fn named(&self) -> impl Iterator<Item = (String, usize)> + '_ {
        let attribute =
            |name: &str, index: Option<usize>| index.map(|i| (format!("attributes.{name}"), i));
        let influences =
            self.influences.iter().enumerate().flat_map(|(set, &(joints, weights))| {
                [
                    (format!("attributes.JOINTS_{set}"), joints),
                    (format!("attributes.WEIGHTS_{set}"), weights),
                ]
            });
        let targets = self.targets.iter().enumerate().flat_map(|(t, &(positions, normals))| {
            let named = |name: &str, index: Option<usize>| {
                index.map(|i| (format!("targets[{t}].{name}"), i))
            };
            [named("POSITION", positions), named("NORMAL", normals)].into_iter().flatten()
        });
        [
            attribute("NORMAL", self.normals),
            attribute("TANGENT", self.tangents),
            attribute("TEXCOORD_0", self.uvs[0]),
            attribute("TEXCOORD_1", self.uvs[1]),
            attribute("COLOR_0", self.colors),
        ]
        .into_iter()
        .flatten()
        .chain(influences)
        .chain(targets)
    }

    fn check_counts(&self, source: &Source<'_>, path: &str) -> Result<(), Error> {
        let vertices = source.count(self.positions)?;
        for (name, accessor) in self.named() {
            let count = source.root.accessors[accessor].count.0;
            if count != vertices as u64 {
                let what =
                    format!("accessor {accessor} has {count} elements, POSITION has {vertices}");
                return Err(source.error(format!("{path}.{name}"), what));
            }
        }
        Ok(())
    }

    /// Bytes that one vertex takes in a mesh.
    pub(crate) fn vertex_bytes(&self) -> u64 {
        let uvs = self.uvs.iter().flatten().count() as u64 * 8;
        12 + u64::from(self.normals.is_some()) * 12
            + u64::from(self.tangents.is_some()) * 16
            + uvs
            + u64::from(self.colors.is_some()) * 16
    }
}

impl Outline {
    /// Reads the indices of a primitive and finds the vertices that it uses. Adds to `warnings`
    /// what is left out.
    pub(crate) fn read(
        source: &Source<'_>,
        primitive: &Primitive,
        attributes: Attributes,
        path: &str,
        warnings: &mut Vec<String>,
    ) -> Result<Self, Error> {
        let vertices = source.count(attributes.positions)?;
        let Checked::Valid(mode) = primitive.mode else {
            return Err(source.error(format!("{path}.mode"), "unknown mode"));
        };
        let Some(accessor) = primitive.indices else {
            // A list of vertices that ends within a triangle has lost some.
            if let Some((of, name)) = group(mode).filter(|(of, _)| !vertices.is_multiple_of(*of)) {
                return Err(source
                    .error(path, format!("{vertices} vertices, {name} need a multiple of {of}")));
            }
            return Ok(Self { attributes, mode, indices: None, used: 0..vertices });
        };
        let path = format!("{path}.indices");
        let accessor = accessor.value();
        if source.shape(accessor) != Some(Type::Scalar) {
            return Err(source.error(path, format!("accessor {accessor} is not SCALAR")));
        }
        let mut indices =
            source.unsigned::<1>(accessor, 0..source.count(accessor)?, &path)?.into_flattened();
        leave_out_rest(&mut indices, mode, source, &path, warnings);

        // Find the range and check it at once; look for the culprit only if there is one.
        let (low, high) =
            indices.iter().fold((u32::MAX, 0), |(low, high), &i| (low.min(i), high.max(i)));
        if high as usize >= vertices && !indices.is_empty() {
            let at = indices.iter().position(|&i| i as usize >= vertices).unwrap_or(0);
            let what =
                format!("index {at} is {}, the primitive has {vertices} vertices", indices[at]);
            return Err(source.error(path, what));
        }
        let used = if indices.is_empty() { 0..0 } else { low as usize..high as usize + 1 };
        Ok(Self { attributes, mode, indices: Some(indices), used })
    }

    /// Number of vertices that the mode strings together.
    fn len(&self) -> usize {
        self.indices.as_ref().map_or(self.used.len(), Vec::len)
    }

    /// Adds what the primitive draws to `mesh`; its vertex `start` is vertex `base` of the mesh.
    pub(crate) fn add_to(&self, mesh: &mut Mesh, base: u32, start: u32) {
        let n = self.len();
        let at = |i: usize| match &self.indices {
            Some(indices) => indices[i] - start + base,
            None => i as u32 - start + base,
        };
        match self.mode {
            Mode::Points => mesh.points.extend((0..n).map(at)),
            Mode::Lines => mesh.lines.extend((0..n / 2).map(|i| [at(2 * i), at(2 * i + 1)])),
            Mode::LineStrip => mesh.lines.extend((1..n).map(|i| [at(i - 1), at(i)])),
            Mode::LineLoop if n >= 2 => mesh.lines.extend((0..n).map(|i| [at(i), at((i + 1) % n)])),
            Mode::LineLoop => {}
            Mode::Triangles => {
                mesh.triangles.extend((0..n / 3).map(|i| [at(3 * i), at(3 * i + 1), at(3 * i + 2)]))
            }
            // Every other triangle of a strip turns the other way round; two corners change places
            // to undo that.
            Mode::TriangleStrip => mesh.triangles.extend((2..n).map(|i| {
                let odd = i % 2;
                [at(i - 2), at(i - 1 + odd), at(i - odd)]
            })),
            Mode::TriangleFan => {
                mesh.triangles.extend((2..n).map(|i| -> Corners { [at(i - 1), at(i), at(0)] }))
            }
        }
    }

    /// Whether the primitive is made of triangles.
    pub(crate) fn is_surface(&self) -> bool {
        matches!(self.mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)
    }

    /// Bytes that the topology takes in a mesh.
    pub(crate) fn bytes(&self) -> u64 {
        self.len() as u64 * 12
    }
}

/// Refuses a primitive whose only vertices are compressed. Some files have them a second time for
/// readers like this one.
fn check_compression(
    source: &Source<'_>,
    primitive: &Primitive,
    positions: usize,
    path: &str,
) -> Result<(), Error> {
    const DRACO: &str = "KHR_draco_mesh_compression";
    let accessor = &source.root.accessors[positions];
    let has_bytes = accessor.buffer_view.is_some() || accessor.sparse.is_some();
    if has_bytes || !primitive.extensions.as_ref().is_some_and(|e| e.others.contains_key(DRACO)) {
        return Ok(());
    }
    let what = format!("{path} is compressed with {DRACO}, which is not supported");
    Err(Error::Unsupported { file: source.file.to_owned(), what })
}

/// Of how many vertices a mode makes one line or triangle, and its name; `None` where vertices are
/// shared.
fn group(mode: Mode) -> Option<(usize, &'static str)> {
    match mode {
        Mode::Lines => Some((2, "LINES")),
        Mode::Triangles => Some((3, "TRIANGLES")),
        _ => None,
    }
}

/// Leaves out the indices behind the last whole line or triangle, as OpenGL does.
fn leave_out_rest(
    indices: &mut Vec<u32>,
    mode: Mode,
    source: &Source<'_>,
    path: &str,
    warnings: &mut Vec<String>,
) {
    let Some((of, name)) = group(mode) else { return };
    let count = indices.len();
    if !count.is_multiple_of(of) {
        let what = format!("{count} indices, {name} need a multiple of {of}; the rest is left out");
        warnings.push(format!("{}: {path}: {what}", source.file));
        indices.truncate(count - count % of);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outline(mode: Mode, indices: Option<Vec<u32>>) -> Outline {
        let attributes = Attributes {
            positions: 0,
            normals: None,
            tangents: None,
            uvs: [None; 2],
            colors: None,
            influences: vec![],
            targets: vec![],
        };
        Outline { attributes, mode, indices, used: 0..5 }
    }

    fn drawn(mode: Mode, indices: Option<Vec<u32>>) -> Mesh {
        let mut mesh = Mesh::default();
        outline(mode, indices).add_to(&mut mesh, 10, 0);
        mesh
    }

    #[test]
    fn every_mode_by_hand() {
        assert_eq!(drawn(Mode::Points, None).points, [10, 11, 12, 13, 14]);
        assert_eq!(drawn(Mode::Lines, Some(vec![0, 1, 2, 3])).lines, [[10, 11], [12, 13]]);
        assert_eq!(drawn(Mode::LineStrip, Some(vec![4, 0, 2])).lines, [[14, 10], [10, 12]]);
        assert_eq!(
            drawn(Mode::LineLoop, Some(vec![4, 0, 2])).lines,
            [[14, 10], [10, 12], [12, 14]]
        );
        assert_eq!(drawn(Mode::LineLoop, Some(vec![4])).lines, [[0; 2]; 0]);
        assert_eq!(drawn(Mode::Triangles, Some(vec![4, 0, 2])).triangles, [[14, 10, 12]]);
        assert_eq!(
            drawn(Mode::TriangleStrip, None).triangles,
            [[10, 11, 12], [11, 13, 12], [12, 13, 14]]
        );
        assert_eq!(
            drawn(Mode::TriangleFan, None).triangles,
            [[11, 12, 10], [12, 13, 10], [13, 14, 10]]
        );
        assert_eq!(drawn(Mode::TriangleFan, Some(vec![])).triangles, [[0; 3]; 0]);
    }
}
