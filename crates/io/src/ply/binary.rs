//! The data of a binary PLY file.
//!
//! Elements of a fixed size (vertices) are cut into blocks of rows, which are decoded on all
//! threads, one attribute after the other. Faces have lists, so that their size varies; but nearly
//! every file has polygons of one kind. So the rows are read as if all had the first one's length:
//! if each row, at its place, has that length, the guess was right. Else, and for everything
//! unusual, rows are read one after the other.

use super::content::{Content, Reading, Row};
use super::header::{Element, Encoding, Kind, Type};
use super::layout::{Layout, Role, Target, slot};
use crate::far;
use crate::{Error, Place};
use std::sync::atomic::{AtomicBool, Ordering};
use vitral_exec::Workers;
use vitral_math::color::linear_from_srgb_table;

/// Rows that one worker takes at a time.
const BLOCK: usize = 1 << 13;

/// Reads all elements.
pub(super) fn read(
    bytes: &[u8],
    reading: &mut Reading,
    content: &mut Content,
    workers: &Workers,
) -> Result<(), Error> {
    let big = reading.header.encoding == Encoding::BigEndian;
    let mut at = reading.header.data;
    for (element, layout) in reading.header.elements.iter().zip(reading.layouts) {
        let rows = Rows { bytes, at, element, layout, big };
        at = match element.stride() {
            // Elements without properties have no data, however many there are.
            Some(0) => at,
            Some(stride) => {
                let end = end_of_rows(bytes, at, element, stride, reading.file)?;
                match layout.role {
                    Role::Vertex => {
                        FixedRows { bytes: &bytes[at..end], stride, element, layout, big }
                            .vertices(content, workers)
                    }
                    Role::Edge => _ = rows.read(reading, content)?,
                    Role::Face | Role::Strips | Role::Incomplete | Role::Unknown => {}
                }
                end
            }
            None => match rows.read_uniform(content, workers) {
                Some(end) => end,
                None => rows.read(reading, content)?,
            },
        };
    }
    if at < bytes.len() {
        let rest = bytes.len() - at;
        let place = Place::Byte(at as u64);
        reading
            .warnings
            .note("", place, || format!("{rest} bytes after the last element are left out"));
    }
    Ok(())
}

/// Where `element.count` rows end, if the file is long enough.
fn end_of_rows(
    bytes: &[u8],
    at: usize,
    element: &Element,
    stride: usize,
    file: &str,
) -> Result<usize, Error> {
    let room = (bytes.len() - at) as u64;
    match element.count.checked_mul(stride as u64) {
        Some(size) if size <= room => Ok(at + size as usize),
        _ => {
            let there = room / stride as u64;
            let what = format!(
                "the file ends here: {} elements `{}` are announced, {there} are there",
                element.count, element.name
            );
            Err(Error::malformed(file, Place::Byte(bytes.len() as u64), what))
        }
    }
}

/// Reads one value; `bytes` must be long enough.
#[inline(always)]
fn scalar(bytes: &[u8], kind: Type, big: bool) -> f64 {
    fn take<const N: usize>(bytes: &[u8], big: bool) -> [u8; N] {
        let mut value: [u8; N] = std::array::from_fn(|i| bytes[i]);
        if big {
            value.reverse();
        }
        value
    }
    match kind {
        Type::I8 => f64::from(bytes[0] as i8),
        Type::U8 => f64::from(bytes[0]),
        Type::I16 => f64::from(i16::from_le_bytes(take(bytes, big))),
        Type::U16 => f64::from(u16::from_le_bytes(take(bytes, big))),
        Type::I32 => f64::from(i32::from_le_bytes(take(bytes, big))),
        Type::U32 => f64::from(u32::from_le_bytes(take(bytes, big))),
        Type::F32 => f64::from(f32::from_le_bytes(take(bytes, big))),
        Type::F64 => f64::from_le_bytes(take(bytes, big)),
    }
}

/// Rows of a fixed size.
struct FixedRows<'a> {
    bytes: &'a [u8],
    stride: usize,
    element: &'a Element,
    layout: &'a Layout,
    big: bool,
}

/// Where a slot's value lies in a row.
type Field = (usize, Type);

impl FixedRows<'_> {
    /// The field that goes to `slot`.
    fn field(&self, slot: usize) -> Option<Field> {
        let mut offset = 0;
        for (property, target) in self.element.properties.iter().zip(&self.layout.targets) {
            let Kind::Scalar(kind) = property.kind else { return None };
            if *target == Target::Slot(slot) {
                return Some((offset, kind));
            }
            offset += kind.size();
        }
        None
    }

    fn fields<const N: usize>(&self, first: usize) -> [Option<Field>; N] {
        std::array::from_fn(|k| self.field(first + k))
    }

    fn vertices(&self, content: &mut Content, workers: &Workers) {
        let count = content.vertex_count;
        let fields = self.fields(slot::POSITION);
        content.positions = self.column(fields, count, workers, |v| v);

        // Read doubles of a model far away once more.
        if fields.iter().flatten().any(|field| field.1 == Type::F64)
            && let Some(offset) = far::offset(&content.positions)
        {
            content.positions = self.moved_positions(fields, offset, count, workers);
            content.offset = Some(offset);
        }
        if let Some(normals) = &mut content.normals {
            *normals = self.column(self.fields(slot::NORMAL), count, workers, |v| v);
        }
        if let Some(uvs) = &mut content.uvs {
            *uvs =
                self.column(self.fields(slot::UV), count, workers, |[u, v]: [f32; 2]| [u, 1.0 - v]);
        }
        if let Some(colors) = &mut content.colors {
            (*colors, content.has_linear_colors) = self.colors(count, workers);
        }
    }

    /// The positions of all rows, less an offset.
    fn moved_positions(
        &self,
        fields: [Option<Field>; 3],
        offset: [f64; 3],
        count: usize,
        workers: &Workers,
    ) -> Vec<[f32; 3]> {
        let mut out = vec![[0.0f32; 3]; count];
        workers.for_each_chunk(&mut out, BLOCK, |block, out| {
            let rows = self.bytes[block * BLOCK * self.stride..].chunks_exact(self.stride);
            for (out, row) in out.iter_mut().zip(rows) {
                let value = |f: Option<Field>| {
                    f.map_or(0.0, |(at, kind)| scalar(&row[at..], kind, self.big))
                };
                *out = far::moved(fields.map(value), offset);
            }
        });
        out
    }

    /// One attribute of all rows. Fields that a row lacks are 1 (alpha).
    fn column<const N: usize>(
        &self,
        fields: [Option<Field>; N],
        count: usize,
        workers: &Workers,
        map: impl Fn([f32; N]) -> [f32; N] + Sync,
    ) -> Vec<[f32; N]> {
        // Floats in a row, the usual case, are copied as they lie.
        let first = fields[0].map_or(0, |f| f.0);
        let adjacent = (0..N).all(|k| fields[k] == Some((first + 4 * k, Type::F32)));
        let mut out = vec![[0.0f32; N]; count];
        workers.for_each_chunk(&mut out, BLOCK, |block, out| {
            let rows = self.bytes[block * BLOCK * self.stride..].chunks_exact(self.stride);
            if adjacent && !self.big {
                for (out, row) in out.iter_mut().zip(rows) {
                    let (words, _) = row[first..first + 4 * N].as_chunks::<4>();
                    *out = map(std::array::from_fn(|k| f32::from_le_bytes(words[k])));
                }
            } else {
                for (out, row) in out.iter_mut().zip(rows) {
                    let value = |f: Option<Field>| {
                        f.map_or(1.0, |(at, kind)| scalar(&row[at..], kind, self.big) as f32)
                    };
                    *out = map(fields.map(value));
                }
            }
        });
        out
    }

    /// Colours of all rows, and whether they are linear; else encoded.
    fn colors(&self, count: usize, workers: &Workers) -> (Vec<[f32; 4]>, bool) {
        let fields = self.fields::<4>(slot::COLOR);
        if fields.iter().flatten().all(|f| f.1 == Type::U8) {
            let table = linear_from_srgb_table();
            let mut colors = self.column(fields, count, workers, |c| {
                [table[c[0] as usize], table[c[1] as usize], table[c[2] as usize], c[3] / 255.0]
            });
            if fields[3].is_none() {
                colors.iter_mut().for_each(|c| c[3] = 1.0);
            }
            return (colors, true);
        }
        let scale = fields.map(|f| f.map_or(1.0, |f| f.1.full_scale() as f32));
        (
            self.column(fields, count, workers, |c: [f32; 4]| {
                std::array::from_fn(|k| c[k] / scale[k])
            }),
            false,
        )
    }
}

/// The rows of one element, from byte `at` of the file on.
#[derive(Clone, Copy)]
struct Rows<'a> {
    bytes: &'a [u8],
    at: usize,
    element: &'a Element,
    layout: &'a Layout,
    big: bool,
}

impl Rows<'_> {
    /// Reads faces as if all had as many corners as the first, and gives where they end. `None`:
    /// they have not, or the element is of another kind.
    fn read_uniform(&self, content: &mut Content, workers: &Workers) -> Option<usize> {
        let shape = Shape::of(self)?;
        let size = self.element.count.checked_mul(shape.stride as u64)?;
        let is_new = content.triangles.is_empty() && content.sizes.is_empty();
        let is_plain = content.face_colors.is_none()
            && content.corner_uvs.is_none()
            && content.images.is_none();
        if size > (self.bytes.len() - self.at) as u64 || !is_new || !is_plain {
            return None;
        }
        let end = self.at + size as usize;
        let (rows, count) = (&self.bytes[self.at..end], self.element.count as usize);

        // Decode, watching the lengths and the largest index.
        let ok = AtomicBool::new(true);
        let limit = content.vertex_count as u32;
        let decode = |block: usize, out: &mut [u32]| {
            let rows = rows[block * BLOCK * shape.stride..].chunks_exact(shape.stride);
            let (uniform, largest) = shape.decode(rows, out, self.big);
            if !uniform || largest >= limit {
                ok.store(false, Ordering::Relaxed);
            }
        };
        let (mut triangles, mut corners) = (Vec::new(), Vec::new());
        if shape.corners == 3 {
            triangles = vec![[0u32; 3]; count];
            workers.for_each_chunk(&mut triangles, BLOCK, |block, out| {
                decode(block, out.as_flattened_mut())
            });
        } else {
            corners = vec![0u32; count * shape.corners];
            workers.for_each_chunk(&mut corners, BLOCK * shape.corners, decode);
        }

        // A wrong index is reported by the reader of single rows, which knows its place.
        if !ok.into_inner() {
            return None;
        }
        if shape.corners == 3 {
            content.triangles = triangles;
        } else {
            content.sizes = vec![shape.corners as u32; count];
            content.corners = corners;
        }
        Some(end)
    }

    /// Reads elements one after the other; gives the end of the last.
    fn read(&self, reading: &mut Reading, content: &mut Content) -> Result<usize, Error> {
        let mut row = Row::default();
        let mut at = self.at;
        for n in 0..self.element.count {
            let start = at;
            let place = || Place::Byte(start as u64);
            let malformed =
                |place: Place, what: String| Error::malformed(reading.file, place, what);
            let wrong = |what: String| {
                malformed(place(), format!("element {n} of `{}`: {what}", self.element.name))
            };
            self.read_row(&mut at, &mut row).map_err(|flaw| match flaw {
                Flaw::Wrong(what) => wrong(what),
                Flaw::Truncated => {
                    let name = &self.element.name;
                    let what = format!(
                        "the file ends here: {} elements `{name}` are announced, {n} are there",
                        self.element.count
                    );
                    malformed(Place::Byte(self.bytes.len() as u64), what)
                }
            })?;
            content.push(self.layout.role, &row, place, reading.warnings).map_err(wrong)?;
        }
        Ok(at)
    }

    /// Reads the element at `at` into `row`, and moves `at` behind it.
    #[inline]
    fn read_row(&self, at: &mut usize, row: &mut Row) -> Result<(), Flaw> {
        row.clear();
        for (property, &target) in self.element.properties.iter().zip(&self.layout.targets) {
            match property.kind {
                Kind::Scalar(kind) => row.store(target, self.take(at, kind)?, kind),
                Kind::List { count, item } => {
                    // Check that the list fits into the file before anything is stored.
                    let length = self.take(at, count)?;
                    let size = length * item.size() as f64;
                    if length < 0.0 {
                        return Err(Flaw::Wrong(format!("a list has {length} items")));
                    }
                    if size > (self.bytes.len() - *at) as f64 {
                        return Err(Flaw::Truncated);
                    }
                    if matches!(target, Target::Slot(_) | Target::Nothing) {
                        *at += size as usize;
                        continue;
                    }
                    for _ in 0..length as usize {
                        row.store_item(target, self.take(at, item)?).map_err(Flaw::Wrong)?;
                    }
                }
            }
        }
        Ok(())
    }

    /// The value at `at`, which moves behind it.
    #[inline]
    fn take(&self, at: &mut usize, kind: Type) -> Result<f64, Flaw> {
        let value = self.bytes.get(*at..*at + kind.size()).map(|b| scalar(b, kind, self.big));
        *at += kind.size();
        value.ok_or(Flaw::Truncated)
    }
}

/// What is wrong with an element.
enum Flaw {
    /// The file ends within it.
    Truncated,
    /// A value cannot be what it stands for.
    Wrong(String),
}

/// The row of a face whose list has a known length.
struct Shape {
    stride: usize,
    count_at: usize,
    count_type: Type,
    item_type: Type,
    corners: usize,
}

impl Shape {
    /// The shape of the first row: scalars and one list, of corners with 32-bit indices, at least
    /// three of them.
    fn of(rows: &Rows) -> Option<Self> {
        let Rows { bytes, at, element, layout, big } = *rows;
        let bytes = &bytes[at..];
        if layout.role != Role::Face || element.count == 0 {
            return None;
        }
        let (mut offset, mut shape) = (0, None);
        for (property, target) in element.properties.iter().zip(&layout.targets) {
            match property.kind {
                Kind::Scalar(kind) => offset += kind.size(),
                Kind::List { count, item: item @ (Type::I32 | Type::U32) }
                    if *target == Target::Corners && shape.is_none() =>
                {
                    let corners = scalar(bytes.get(offset..)?.get(..count.size())?, count, big);
                    if !(3.0..=255.0).contains(&corners) {
                        return None;
                    }
                    let corners = corners as usize;
                    shape = Some(Self {
                        stride: 0,
                        count_at: offset,
                        count_type: count,
                        item_type: item,
                        corners,
                    });
                    offset += count.size() + corners * item.size();
                }
                Kind::List { .. } => return None,
            }
        }
        shape.map(|s| Self { stride: offset, ..s })
    }

    /// Reads rows into `out`; tells whether all lists have the right length, and the largest index
    /// (negative ones are larger than any).
    fn decode<'a>(
        &self,
        rows: impl Iterator<Item = &'a [u8]>,
        out: &mut [u32],
        big: bool,
    ) -> (bool, u32) {
        debug_assert_eq!(self.item_type.size(), 4);
        let list_at = self.count_at + self.count_type.size();
        let (mut uniform, mut largest) = (true, 0);
        let word = |bytes: [u8; 4]| {
            if big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) }
        };
        if self.corners == 3 && self.count_type == Type::U8 {
            for (out, row) in out.as_chunks_mut::<3>().0.iter_mut().zip(rows) {
                uniform &= row[self.count_at] == 3;
                let (words, _) = row[list_at..list_at + 12].as_chunks::<4>();
                *out = [word(words[0]), word(words[1]), word(words[2])];
                largest = largest.max(out[0]).max(out[1]).max(out[2]);
            }
        } else {
            for (out, row) in out.chunks_exact_mut(self.corners).zip(rows) {
                uniform &=
                    scalar(&row[self.count_at..], self.count_type, big) == self.corners as f64;
                for (out, bytes) in out.iter_mut().zip(row[list_at..].as_chunks::<4>().0) {
                    *out = word(*bytes);
                    largest = largest.max(*out);
                }
            }
        }
        (uniform, largest)
    }
}
