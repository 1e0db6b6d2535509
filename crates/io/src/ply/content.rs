//! What has been read so far, element by element, and the mesh that it becomes.

use super::header::{Header, Type};
use super::layout::{Layout, Role, Target, slot};
use crate::color_range::ColorRange;
use crate::far;
use crate::file_name::stem;
use crate::polygons;
use crate::warnings::Warnings;
use crate::{Error, Place};
use vitral_exec::Workers;
use vitral_math::color::linear_from_srgb;
use vitral_scene::{Attribute, Faces, Mesh, Part};

/// Colours that one worker takes at a time.
const COLORS: usize = 1 << 14;

/// What the encodings share while they read.
pub(super) struct Reading<'a> {
    pub(super) header: &'a Header,
    pub(super) layouts: &'a [Layout],
    pub(super) file: &'a str,
    pub(super) warnings: &'a mut Warnings,
}

/// One element as read: numbers in their slots, colours scaled to `0..=1`, and the corners of a
/// face or strip.
#[derive(Debug, Default)]
pub(super) struct Row {
    pub(super) slots: [f64; slot::COUNT],
    pub(super) corners: Vec<i64>,
    /// Texture coordinates of the corners, `u v u v …`.
    pub(super) corner_uvs: Vec<f32>,
}

impl Row {
    /// Empties the row for the next element: all numbers are zero, the colour is opaque.
    pub(super) fn clear(&mut self) {
        self.slots = [0.0; slot::COUNT];
        self.slots[slot::COLOR + 3] = 1.0;
        self.corners.clear();
        self.corner_uvs.clear();
    }

    /// Stores a scalar of type `kind`; colours are scaled to `0..=1`.
    #[inline]
    pub(super) fn store(&mut self, target: Target, value: f64, kind: Type) {
        if let Target::Slot(slot) = target {
            let is_color = (slot::COLOR..slot::UV).contains(&slot);
            self.slots[slot] = if is_color { value / kind.full_scale() } else { value };
        }
    }

    /// Adds an item of a list.
    #[inline]
    pub(super) fn store_item(&mut self, target: Target, value: f64) -> Result<(), String> {
        match target {
            Target::Corners => self.corners.push(whole(value)?),
            Target::CornerUvs => self.corner_uvs.push(value as f32),
            Target::Slot(_) | Target::Nothing => {}
        }
        Ok(())
    }
}

/// A list item as an index.
#[inline]
fn whole(value: f64) -> Result<i64, String> {
    let index = value as i64;
    if index as f64 == value { Ok(index) } else { Err(format!("{value} is not an index")) }
}

/// Everything read so far.
#[derive(Debug, Default)]
pub(super) struct Content {
    pub(super) vertex_count: usize,
    pub(super) positions: Vec<[f32; 3]>,
    /// What was taken from each position.
    pub(super) offset: Option<[f64; 3]>,
    pub(super) normals: Option<Vec<[f32; 3]>>,
    /// Encoded, until [`Content::decode_colors`].
    pub(super) colors: Option<Vec<[f32; 4]>>,
    /// Whether `colors` are linear from the beginning.
    pub(super) has_linear_colors: bool,
    /// The types of the colours that count, and of their alpha.
    pub(super) color_types: [Option<Type>; 2],
    pub(super) uvs: Option<Vec<[f32; 2]>>,
    /// Faces as triangles, where all of them are; otherwise `sizes` and `corners`.
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) sizes: Vec<u32>,
    pub(super) corners: Vec<u32>,
    pub(super) face_colors: Option<Vec<[f32; 4]>>,
    /// Texture coordinates of `corners`, with `v` downwards.
    pub(super) corner_uvs: Option<Vec<[f32; 2]>>,
    /// The image of each face.
    pub(super) images: Option<Vec<i64>>,
    pub(super) lines: Vec<[u32; 2]>,
}

impl Content {
    /// The arrays that the header promises, all of them empty.
    pub(super) fn new(header: &Header, layouts: &[Layout], file: &str) -> Result<Self, Error> {
        // Find the vertices, and check that they can be read.
        let Some(v) = layouts.iter().position(|l| l.role == Role::Vertex) else {
            return Err(Error::malformed(file, Place::File, "the header has no element `vertex`"));
        };
        let (element, layout) = (&header.elements[v], &layouts[v]);
        let place = Place::Line(element.line);
        if let Some(again) = layouts.iter().skip(v + 1).position(|l| l.role == Role::Vertex) {
            let place = Place::Line(header.elements[v + 1 + again].line);
            return Err(Error::malformed(
                file,
                place,
                "a second element `vertex`, one is required",
            ));
        }
        if !layout.has_slots(slot::POSITION, 3) {
            return Err(Error::malformed(
                file,
                place,
                "`vertex` must have the properties `x`, `y` and `z`",
            ));
        }
        let Some(vertex_count) =
            usize::try_from(element.count).ok().filter(|&n| n <= u32::MAX as usize)
        else {
            let what = format!("{} vertices, at most {} can be read", element.count, u32::MAX);
            return Err(Error::malformed(file, place, what));
        };

        // Colours and texture coordinates of faces count where vertices have none.
        let face_colors =
            layouts.iter().any(|l| l.role == Role::Face && l.has_colors) && !layout.has_colors;
        let colored =
            layouts.iter().position(|l| l.has_colors && (l.role == Role::Vertex || face_colors));
        let color_types = [slot::COLOR, slot::COLOR + 3]
            .map(|slot| colored.and_then(|e| layouts[e].type_of(&header.elements[e], slot)));

        // Prefer texture coordinates of corners to those of vertices, and look for image numbers.
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
    pub(super) fn push(
        &mut self,
        role: Role,
        row: &Row,
        place: impl Fn() -> Place,
        warnings: &mut Warnings,
    ) -> Result<(), String> {
        match role {
            Role::Vertex => self.push_vertex(row),
            Role::Face => {
                // Leave out faces with fewer than three corners.
                if row.corners.len() < 3 {
                    warnings.note("few corners", place(), || {
                        format!(
                            "a face with {} corners, three are required; it is left out",
                            row.corners.len()
                        )
                    });
                    return Ok(());
                }

                // Add the corners.
                for &index in &row.corners {
                    let index = self.vertex(index)?;
                    self.corners.push(index);
                }
                self.sizes.push(row.corners.len() as u32);

                // Add the face's colour, image and texture coordinates.
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
        self.positions.push(match self.offset {
            Some(offset) => far::moved([row.slots[0], row.slots[1], row.slots[2]], offset),
            None => three(slot::POSITION),
        });
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
                format!(
                    "{seen} texture coordinates, a face with {corners} corners needs {}; left out",
                    2 * corners
                )
            });
        }
        uvs.resize(self.corners.len(), [0.0; 2]);
    }

    /// Cuts strips into triangles; every second one is turned, so that all have the strip's
    /// orientation.
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
    pub(super) fn decode_colors(&mut self, warnings: &mut Warnings, workers: &Workers) {
        let colors = match (&mut self.colors, &mut self.face_colors) {
            (Some(colors), _) if !self.has_linear_colors => colors,
            (None, Some(colors)) => colors,
            _ => return,
        };

        // Find the range of the colours and that of their alpha.
        let of_blocks = workers.map(colors.len().div_ceil(COLORS), |block| {
            let colors = &colors[block * COLORS..colors.len().min((block + 1) * COLORS)];
            let rgb = ColorRange::of(colors.iter().flat_map(|c| [c[0], c[1], c[2]]));
            [rgb, ColorRange::of(colors.iter().map(|c| c[3]))]
        });
        let union = |a: [ColorRange; 2], b: [ColorRange; 2]| [a[0].union(b[0]), a[1].union(b[1])];
        let ranges = of_blocks.into_iter().fold([ColorRange::default(); 2], union);

        // Find what a full channel is.
        let scale =
            [0, 1].map(|k| self.color_types[k].map_or(1.0, |kind| full_channel(kind, ranges[k])));
        if let Some(what) = self.color_types[0].and_then(|kind| oddity(kind, ranges[0])) {
            warnings.note("", Place::File, || what);
        }

        // Decode in place.
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
    pub(super) fn texture_runs(&self) -> Vec<(u32, i64)> {
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

    /// The mesh of all that was read.
    pub(super) fn into_mesh(mut self, file: &str, workers: &Workers) -> Result<Mesh, Error> {
        if self.corners.len() > u32::MAX as usize {
            return Err(Error::malformed(file, Place::File, "more than 4294967295 face corners"));
        }

        // Cut the polygons into triangles. Triangles that came in blocks need no cut, unless there
        // are polygons, too.
        let mut corner_uvs = None;
        let (triangles, faces, face_corners) = if self.sizes.is_empty() {
            let corners = self
                .face_colors
                .as_ref()
                .map(|_| (0..self.triangles.len() as u32).map(|t| [t; 3]).collect());
            (self.triangles, Faces::Triangles, corners)
        } else {
            self.add_block_triangles();
            if let Some(uvs) = &mut self.corner_uvs {
                // Those that came in blocks have none.
                uvs.splice(0..0, std::iter::repeat_n([0.0; 2], self.corners.len() - uvs.len()));
                let corners = polygons::places(&self.positions, &self.sizes, &self.corners);
                corner_uvs =
                    Some(Attribute { values: std::mem::take(uvs), corners: Some(corners) });
            }
            let built = polygons::build(&self.positions, &self.sizes, self.corners, workers);
            let corners = self.face_colors.as_ref().map(|_| built.per_face(&self.sizes));
            (built.triangles, built.faces, corners)
        };

        // Take the colours of faces, or else of vertices.
        let colors = match self.face_colors {
            Some(values) => Some(Attribute { values, corners: face_corners }),
            None => self.colors.map(Attribute::per_vertex),
        };
        let is_cloud = triangles.is_empty() && self.lines.is_empty();
        Ok(Mesh {
            name: stem(file),
            parts: vec![Part {
                name: String::new(),
                triangles: 0..triangles.len() as u32,
                material: None,
            }],
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

/// What a full channel is, in terms of the type's usual full channel. Values above that are taken
/// as 0 to the type's wide range, floats where they look like bytes; 16 bits that hold nothing
/// above 255 are bytes.
fn full_channel(kind: Type, range: ColorRange) -> f32 {
    let (full, wide) = (kind.full_scale() as f32, kind.wide_scale() as f32);
    match kind {
        _ if kind.is_float() => range.scale(),
        Type::I16 | Type::U16 if holds_bytes(kind, range) => 255.0 / full,
        _ if range.largest > 1.0 => wide / full,
        _ => 1.0,
    }
}

/// Whether a channel of 16 bits holds nothing above 255.
fn holds_bytes(kind: Type, range: ColorRange) -> bool {
    let is_wide = matches!(kind, Type::I16 | Type::U16);
    is_wide && range.largest > 0.0 && f64::from(range.largest) * kind.full_scale() < 255.5
}

/// The warning about colours outside their type's usual range.
fn oddity(kind: Type, range: ColorRange) -> Option<String> {
    let (full, wide) = (kind.full_scale(), kind.wide_scale());
    match kind {
        _ if kind.is_float() => range.oddity("colours"),
        _ if holds_bytes(kind, range) => {
            Some("colours of 16 bits do not exceed 255 and are read as 0 to 255".to_owned())
        }
        _ if range.largest > 1.0 && wide > full => {
            Some(format!("colours exceed {full} and are read as 0 to {wide}"))
        }
        _ => None,
    }
}

/// A row's colour, as in the file but for the scale of its type.
fn encoded_color(row: &Row) -> [f32; 4] {
    [0, 1, 2, 3].map(|k| row.slots[slot::COLOR + k] as f32)
}
