//! PLY, the polygon file format from Stanford: a header that describes the elements, then their data.
//!
//! The header (`header`) lists elements (`vertex`, `face`, …), each with a count and properties: scalars of eight
//! types, or lists of them. The data are text, one line an element (`ascii`), or binary in either byte order
//! (`binary`). Both hand each element to `Content` as a `Row`: a fixed set of slots for what vitral understands,
//! and the list of corners. Binary data of the usual layouts go past the rows, block by block on all threads.
//!
//! * `vertex`: `x y z`, `nx ny nz`, `red green blue [alpha]` (sRGB; bytes in integers of 32 bits, others up to their
//!   type's largest value; floats `0..=1`, or `0..=255` if any exceeds 1),
//!   `s t`, `u v`, `texture_u texture_v` (upwards, turned to `1 - v`).
//! * `face`: `vertex_indices` or `vertex_index`; its colours count where vertices have none. Fewer than three corners:
//!   warning, left out.
//! * Textures as MeshLab writes them: `comment TextureFile NAME` in the header names images in order; a face has `texcoord`,
//!   a list of `u v` for each corner, and `texnumber`, the image's number (0 if not given). Files with texture coordinates of
//!   vertices show the first image.
//! * `tristrips`: `vertex_indices`, restarted by a negative index; triangles with two equal corners only steer the strip
//!   and are left out. `edge`: `vertex1 vertex2`, free lines.
//! * Faces and strips without that list, and edges without both ends, are left out with a warning. Elements without properties
//!   have no data, however many are announced.
//! * Without faces, strips and edges the vertices are a point cloud. Other elements and properties are passed over; a
//!   warning names them.
//!
//! In:   bytes. Out: one mesh in model space.
//! Cost: `O(bytes)`; counts in the header allocate nothing that the file could not hold.
//! Source: \[PLY\].

mod ascii;
mod binary;
mod header;
mod textured;

use crate::warnings::Warnings;
use crate::{Error, Place, Resolver};
use header::{Element, Encoding, Header, Kind, Property, Type};
use vitral_exec::Workers;
use vitral_math::color::linear_from_srgb;
use vitral_scene::{Attribute, Faces, Mesh, Part, Scene};

/// Reads a PLY file of any of the three encodings. `resolver` gives its textures; missing ones are warnings.
///
/// # Errors
/// [`Error::Malformed`] with the line (header, text) or byte (binary data) at which the file breaks its announcements.
pub fn load(bytes: &[u8], file: &str, resolver: &dyn Resolver, workers: &Workers) -> Result<Scene, Error> {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let mut warnings = Warnings::default();
    let header = Header::parse(bytes, file, &mut warnings)?;
    let layouts: Vec<Layout> = header.elements.iter().map(Layout::new).collect();
    note_unused(&header, &layouts, &mut warnings);
    let mut content = Content::new(&header, &layouts, file)?;
    let mut reading = Reading { header: &header, layouts: &layouts, file, warnings: &mut warnings };
    match header.encoding {
        Encoding::Ascii => ascii::read(bytes, &mut reading, &mut content)?,
        Encoding::LittleEndian | Encoding::BigEndian => binary::read(bytes, &mut reading, &mut content, workers)?,
    }
    content.decode_colors(&mut warnings, workers);
    let runs = content.texture_runs();
    let mut mesh = content.into_mesh(file, workers)?;
    let mut scene = Scene { warnings: warnings.into_messages(file), ..Scene::default() };
    textured::add(&mut mesh, &mut scene, &runs, &header.textures, file, resolver, workers);
    Ok(crate::finish(mesh, scene, file))
}

/// Colours that one worker takes at a time.
const COLORS: usize = 1 << 14;

/// What the encodings share while they read.
struct Reading<'a> {
    header: &'a Header,
    layouts: &'a [Layout],
    file: &'a str,
    warnings: &'a mut Warnings,
}

/// What an element means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    Vertex,
    Face,
    Strips,
    Edge,
    /// Faces or strips without corners, edges without ends.
    Incomplete,
    Unknown,
}

/// Slots of a [`Row`].
mod slot {
    pub(super) const POSITION: usize = 0;
    pub(super) const NORMAL: usize = 3;
    pub(super) const COLOR: usize = 6;
    pub(super) const UV: usize = 10;
    pub(super) const ENDS: usize = 12;
    pub(super) const IMAGE: usize = 14;
    pub(super) const COUNT: usize = 15;
}

/// Where an element's properties go.
#[derive(Debug)]
struct Layout {
    role: Role,
    /// For each property its slot; lists of corners go to the row's list.
    targets: Vec<Target>,
    has_normals: bool,
    has_colors: bool,
    has_uvs: bool,
    /// Whether it has texture coordinates for the corners of faces.
    has_corner_uvs: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Target {
    Slot(usize),
    Corners,
    CornerUvs,
    Nothing,
}

impl Layout {
    fn new(element: &Element) -> Self {
        let role = match element.name.as_str() {
            "vertex" => Role::Vertex,
            "face" => Role::Face,
            "tristrips" => Role::Strips,
            "edge" => Role::Edge,
            _ => Role::Unknown,
        };
        let mut targets: Vec<Target> = element.properties.iter().map(|p| target(role, p)).collect();
        let lacks = element.count > 0 && !is_complete(role, &targets);
        let role = if lacks {
            targets.fill(Target::Nothing);
            Role::Incomplete
        } else {
            role
        };
        let has = |slots: std::ops::Range<usize>| slots.into_iter().all(|s| targets.contains(&Target::Slot(s)));
        Self {
            has_normals: has(slot::NORMAL..slot::NORMAL + 3),
            has_colors: has(slot::COLOR..slot::COLOR + 3),
            has_uvs: has(slot::UV..slot::UV + 2),
            has_corner_uvs: targets.contains(&Target::CornerUvs),
            role,
            targets,
        }
    }

    /// The type of what goes to `slot`.
    fn type_of(&self, element: &Element, slot: usize) -> Option<Type> {
        match element.properties[self.targets.iter().position(|t| *t == Target::Slot(slot))?].kind {
            Kind::Scalar(kind) => Some(kind),
            Kind::List { .. } => None,
        }
    }

    fn has_slots(&self, first: usize, count: usize) -> bool {
        (first..first + count).all(|s| self.targets.contains(&Target::Slot(s)))
    }
}

/// Whether the element has what makes it one.
fn is_complete(role: Role, targets: &[Target]) -> bool {
    match role {
        Role::Face | Role::Strips => targets.contains(&Target::Corners),
        Role::Edge => [slot::ENDS, slot::ENDS + 1].into_iter().all(|s| targets.contains(&Target::Slot(s))),
        // That vertices have positions is asked where they are counted.
        Role::Vertex | Role::Incomplete | Role::Unknown => true,
    }
}

fn target(role: Role, property: &Property) -> Target {
    let is_list = matches!(property.kind, Kind::List { .. });
    match (role, property.name.as_str()) {
        (Role::Face | Role::Strips, "vertex_indices" | "vertex_index") if is_list => Target::Corners,
        (Role::Face, "texcoord") if is_list => Target::CornerUvs,
        (Role::Unknown, _) | (_, _) if is_list => Target::Nothing,
        (Role::Face, "texnumber") => Target::Slot(slot::IMAGE),
        (Role::Vertex, "x") => Target::Slot(slot::POSITION),
        (Role::Vertex, "y") => Target::Slot(slot::POSITION + 1),
        (Role::Vertex, "z") => Target::Slot(slot::POSITION + 2),
        (Role::Vertex, "nx") => Target::Slot(slot::NORMAL),
        (Role::Vertex, "ny") => Target::Slot(slot::NORMAL + 1),
        (Role::Vertex, "nz") => Target::Slot(slot::NORMAL + 2),
        (Role::Vertex | Role::Face, "red" | "diffuse_red" | "r") => Target::Slot(slot::COLOR),
        (Role::Vertex | Role::Face, "green" | "diffuse_green" | "g") => Target::Slot(slot::COLOR + 1),
        (Role::Vertex | Role::Face, "blue" | "diffuse_blue" | "b") => Target::Slot(slot::COLOR + 2),
        (Role::Vertex | Role::Face, "alpha" | "diffuse_alpha" | "a") => Target::Slot(slot::COLOR + 3),
        (Role::Vertex, "s" | "u" | "texture_u" | "texture_s") => Target::Slot(slot::UV),
        (Role::Vertex, "t" | "v" | "texture_v" | "texture_t") => Target::Slot(slot::UV + 1),
        (Role::Edge, "vertex1") => Target::Slot(slot::ENDS),
        (Role::Edge, "vertex2") => Target::Slot(slot::ENDS + 1),
        _ => Target::Nothing,
    }
}

fn note_unused(header: &Header, layouts: &[Layout], warnings: &mut Warnings) {
    for (element, layout) in header.elements.iter().zip(layouts) {
        let place = Place::Line(element.line);
        if layout.role == Role::Unknown {
            warnings.note("", place, || format!("element `{}` is not used", element.name));
            continue;
        }
        if layout.role == Role::Incomplete {
            let needed = if element.name == "edge" { "`vertex1` and `vertex2`" } else { "a list `vertex_indices`" };
            warnings.note("", place, || format!("`{}` without {needed} is left out", element.name));
            continue;
        }
        let named = element.properties.iter().zip(&layout.targets);
        let unused: Vec<&str> = named.filter(|(_, t)| **t == Target::Nothing).map(|(p, _)| p.name.as_str()).collect();
        if !unused.is_empty() {
            let list = unused.join("`, `");
            warnings.note("", place, || format!("properties of `{}` that are not used: `{list}`", element.name));
        }
    }
}

/// One element as read: numbers in their slots, colours scaled to `0..=1`, and the corners of a face or strip.
#[derive(Debug, Default)]
struct Row {
    slots: [f64; slot::COUNT],
    corners: Vec<i64>,
    /// Texture coordinates of the corners, `u v u v …`.
    corner_uvs: Vec<f32>,
}

/// Everything read so far.
#[derive(Debug, Default)]
struct Content {
    vertex_count: usize,
    positions: Vec<[f32; 3]>,
    normals: Option<Vec<[f32; 3]>>,
    /// Encoded, until [`Content::decode_colors`].
    colors: Option<Vec<[f32; 4]>>,
    /// Whether `colors` are linear from the beginning.
    has_linear_colors: bool,
    /// The types of the colours that count, and of their alpha.
    color_types: [Option<Type>; 2],
    uvs: Option<Vec<[f32; 2]>>,
    /// Faces as triangles, where all of them are; otherwise `sizes` and `corners`.
    triangles: Vec<[u32; 3]>,
    sizes: Vec<u32>,
    corners: Vec<u32>,
    face_colors: Option<Vec<[f32; 4]>>,
    /// Texture coordinates of `corners`, with `v` downwards.
    corner_uvs: Option<Vec<[f32; 2]>>,
    /// The image of each face.
    images: Option<Vec<i64>>,
    lines: Vec<[u32; 2]>,
}

impl Content {
    fn new(header: &Header, layouts: &[Layout], file: &str) -> Result<Self, Error> {
        let Some(v) = layouts.iter().position(|l| l.role == Role::Vertex) else {
            return Err(Error::malformed(file, Place::File, "the header has no element `vertex`"));
        };
        let (element, layout) = (&header.elements[v], &layouts[v]);
        let place = Place::Line(element.line);
        if let Some(again) = layouts.iter().skip(v + 1).position(|l| l.role == Role::Vertex) {
            let place = Place::Line(header.elements[v + 1 + again].line);
            return Err(Error::malformed(file, place, "a second element `vertex`, one is required"));
        }
        if !layout.has_slots(slot::POSITION, 3) {
            return Err(Error::malformed(file, place, "`vertex` must have the properties `x`, `y` and `z`"));
        }
        let Some(vertex_count) = usize::try_from(element.count).ok().filter(|&n| n <= u32::MAX as usize) else {
            let what = format!("{} vertices, at most {} can be read", element.count, u32::MAX);
            return Err(Error::malformed(file, place, what));
        };
        let face_colors = layouts.iter().any(|l| l.role == Role::Face && l.has_colors) && !layout.has_colors;
        let colored = layouts.iter().position(|l| l.has_colors && (l.role == Role::Vertex || face_colors));
        let color_types = [slot::COLOR, slot::COLOR + 3]
            .map(|slot| colored.and_then(|e| layouts[e].type_of(&header.elements[e], slot)));
        let corner_uvs = layouts.iter().any(|l| l.has_corner_uvs);
        let images = layouts.iter().any(|l| l.targets.contains(&Target::Slot(slot::IMAGE)));
        Ok(Self {
            vertex_count,
            color_types,
            normals: layout.has_normals.then(Vec::new),
            colors: layout.has_colors.then(Vec::new),
            uvs: (layout.has_uvs && !corner_uvs).then(Vec::new),
            corner_uvs: corner_uvs.then(Vec::new),
            images: images.then(Vec::new),
            face_colors: face_colors.then(Vec::new),
            ..Self::default()
        })
    }

    /// Takes an element; an `Err` says what is wrong with it.
    fn push(
        &mut self,
        role: Role,
        row: &Row,
        place: impl Fn() -> Place,
        warnings: &mut Warnings,
    ) -> Result<(), String> {
        match role {
            Role::Vertex => self.push_vertex(row),
            Role::Face => {
                if row.corners.len() < 3 {
                    warnings.note("few corners", place(), || {
                        format!("a face with {} corners, three are required; it is left out", row.corners.len())
                    });
                    return Ok(());
                }
                for &index in &row.corners {
                    let index = self.vertex(index)?;
                    self.corners.push(index);
                }
                self.sizes.push(row.corners.len() as u32);
                if let Some(colors) = &mut self.face_colors {
                    colors.push(encoded_color(row));
                }
                if let Some(images) = &mut self.images {
                    images.push(row.slots[slot::IMAGE] as i64);
                }
                self.push_corner_uvs(row, place, warnings);
            }
            Role::Strips => self.push_strips(&row.corners)?,
            Role::Edge => {
                let ends = [row.slots[slot::ENDS], row.slots[slot::ENDS + 1]];
                let ends = [self.vertex(ends[0] as i64)?, self.vertex(ends[1] as i64)?];
                self.lines.push(ends);
            }
            Role::Incomplete | Role::Unknown => {}
        }
        Ok(())
    }

    fn vertex(&self, index: i64) -> Result<u32, String> {
        match usize::try_from(index) {
            Ok(i) if i < self.vertex_count => Ok(index as u32),
            _ => Err(format!("index {index}, the file has {} vertices", self.vertex_count)),
        }
    }

    fn push_vertex(&mut self, row: &Row) {
        let number = |slot: usize| row.slots[slot] as f32;
        let three = |first: usize| [number(first), number(first + 1), number(first + 2)];
        self.positions.push(three(slot::POSITION));
        if let Some(normals) = &mut self.normals {
            normals.push(three(slot::NORMAL));
        }
        if let Some(colors) = &mut self.colors {
            colors.push(encoded_color(row));
        }
        if let Some(uvs) = &mut self.uvs {
            uvs.push([number(slot::UV), 1.0 - number(slot::UV + 1)]);
        }
    }

    /// Texture coordinates for the face that was pushed last.
    fn push_corner_uvs(&mut self, row: &Row, place: impl Fn() -> Place, warnings: &mut Warnings) {
        let Some(uvs) = &mut self.corner_uvs else { return };
        let (pairs, rest) = row.corner_uvs.as_chunks::<2>();
        if pairs.len() == row.corners.len() && rest.is_empty() {
            uvs.extend(pairs.iter().map(|&[u, v]| [u, 1.0 - v]));
            return;
        }
        // Without coordinates is one thing, with some of them another.
        if !row.corner_uvs.is_empty() {
            let (seen, corners) = (row.corner_uvs.len(), row.corners.len());
            warnings.note("texcoord", place(), || {
                format!("{seen} texture coordinates, a face with {corners} corners needs {}; left out", 2 * corners)
            });
        }
        uvs.resize(self.corners.len(), [0.0; 2]);
    }

    /// Cuts strips into triangles; every second one is turned, so that all have the strip's orientation.
    fn push_strips(&mut self, indices: &[i64]) -> Result<(), String> {
        for strip in indices.split(|&i| i < 0) {
            for (k, w) in strip.windows(3).enumerate() {
                let [a, b, c] = [self.vertex(w[0])?, self.vertex(w[1])?, self.vertex(w[2])?];
                if a != b && b != c && c != a {
                    self.corners.extend(if k % 2 == 0 { [a, b, c] } else { [b, a, c] });
                    self.sizes.push(3);
                    if let Some(colors) = &mut self.face_colors {
                        colors.push([f32::NAN; 4]);
                    }
                    if let Some(images) = &mut self.images {
                        images.push(0);
                    }
                    if let Some(uvs) = &mut self.corner_uvs {
                        uvs.resize(self.corners.len(), [0.0; 2]);
                    }
                }
            }
        }
        Ok(())
    }

    /// Makes colours linear; NaN is 1 (white, opaque).
    fn decode_colors(&mut self, warnings: &mut Warnings, workers: &Workers) {
        let colors = match (&mut self.colors, &mut self.face_colors) {
            (Some(colors), _) if !self.has_linear_colors => colors,
            (None, Some(colors)) => colors,
            _ => return,
        };
        let most = |a: [f32; 2], b: [f32; 2]| [a[0].max(b[0]), a[1].max(b[1])];
        let of_blocks = workers.map(colors.len().div_ceil(COLORS), |block| {
            let colors = colors[block * COLORS..].iter().take(COLORS);
            colors.map(|&[r, g, b, a]| [r.max(g).max(b), a]).fold([0.0; 2], most)
        });
        let largest = of_blocks.into_iter().fold([0.0; 2], most);
        let scale = [0, 1].map(|k| match self.color_types[k] {
            Some(kind) if largest[k] > 1.0 => (kind.wide_scale() / kind.full_scale()) as f32,
            _ => 1.0,
        });
        if let Some(kind) = self.color_types[0].filter(|_| scale[0] > 1.0) {
            let (full, wide) = (kind.full_scale(), kind.wide_scale());
            warnings.note("", Place::File, || format!("colours exceed {full} and are read as 0 to {wide}"));
        }
        workers.for_each_chunk(colors, COLORS, |_, colors| {
            let unit = |c: f32| if c.is_nan() { 1.0 } else { c.clamp(0.0, 1.0) };
            for color in colors {
                let [r, g, b, a] = *color;
                let [r, g, b] = [r, g, b].map(|c| linear_from_srgb(unit(c / scale[0])));
                *color = [r, g, b, unit(a / scale[1])];
            }
        });
    }

    /// Runs of triangles with one image: the end of each, and the image's number.
    fn texture_runs(&self) -> Vec<(u32, i64)> {
        let Some(images) = &self.images else { return Vec::new() };
        let (mut runs, mut end): (Vec<(u32, i64)>, u32) = (Vec::new(), self.triangles.len() as u32);
        for (&image, &size) in images.iter().zip(&self.sizes) {
            end += size - 2;
            match runs.last_mut() {
                Some(last) if last.1 == image => last.0 = end,
                _ => runs.push((end, image)),
            }
        }
        runs
    }

    fn into_mesh(mut self, file: &str, workers: &Workers) -> Result<Mesh, Error> {
        if self.corners.len() > u32::MAX as usize {
            return Err(Error::malformed(file, Place::File, "more than 4294967295 face corners"));
        }
        let mut corner_uvs = None;
        // Triangles that came in blocks go before the rows' polygons only if there are none of these.
        let (triangles, faces, face_corners) = if self.sizes.is_empty() {
            let corners = self.face_colors.as_ref().map(|_| (0..self.triangles.len() as u32).map(|t| [t; 3]).collect());
            (self.triangles, Faces::Triangles, corners)
        } else {
            self.add_block_triangles();
            if let Some(uvs) = &mut self.corner_uvs {
                // Those that came in blocks have none.
                uvs.splice(0..0, std::iter::repeat_n([0.0; 2], self.corners.len() - uvs.len()));
                let places = crate::polygons::places(&self.positions, &self.sizes, &self.corners);
                corner_uvs = Some(Attribute { values: std::mem::take(uvs), corners: Some(places) });
            }
            let built = crate::polygons::build(&self.positions, &self.sizes, self.corners, workers);
            let corners = self.face_colors.as_ref().map(|_| built.per_face(&self.sizes));
            (built.triangles, built.faces, corners)
        };
        let colors = match self.face_colors {
            Some(values) => Some(Attribute { values, corners: face_corners }),
            None => self.colors.map(Attribute::per_vertex),
        };
        let is_cloud = triangles.is_empty() && self.lines.is_empty();
        Ok(Mesh {
            name: crate::stem(file),
            parts: vec![Part { name: String::new(), triangles: 0..triangles.len() as u32, material: None }],
            triangles,
            faces,
            normals: self.normals.map(Attribute::per_vertex),
            uvs: corner_uvs.into_iter().chain(self.uvs.map(Attribute::per_vertex)).collect(),
            colors_from_srgb: colors.is_some(),
            colors,
            lines: self.lines,
            points: if is_cloud { (0..self.positions.len() as u32).collect() } else { Vec::new() },
            positions: self.positions,
            ..Mesh::default()
        })
    }

    /// Puts triangles that were read in blocks before the polygons that were read in rows.
    fn add_block_triangles(&mut self) {
        if self.triangles.is_empty() {
            return;
        }
        self.sizes.splice(0..0, std::iter::repeat_n(3, self.triangles.len()));
        let triangles = std::mem::take(&mut self.triangles);
        self.corners.splice(0..0, triangles.into_flattened());
    }
}

/// A row's colour, as in the file but for the scale of its type.
fn encoded_color(row: &Row) -> [f32; 4] {
    [0, 1, 2, 3].map(|k| row.slots[slot::COLOR + k] as f32)
}

#[cfg(test)]
mod tests;
