//! One piece of an OBJ file: its lines, read without knowing the lines before.
//!
//! ZBrush writes colours of vertices as comments, `#MRGB` and eight hexadecimal digits for each
//! vertex in order: a mask, red, green, blue.

use crate::Place;
use crate::far;
use crate::format::obj_statement::Statement;
use crate::text::{Cursor, is_blank};
use crate::warnings::Warnings;
use std::ops::Range;

/// A corner without a texture coordinate or normal, or with the index of a vertex that no file can
/// have.
pub(super) const NONE: u32 = u32::MAX;

/// Set in an index that counts from the piece's beginning (`index - RELATIVE - ORIGIN`), clear in
/// an absolute one.
const RELATIVE: u32 = 1 << 31;
const ORIGIN: i64 = 1 << 30;

/// Packs an index of the file (`1..`, or `-1..` downwards from the `count` values that the piece
/// has so far). `None` for 0 and for indices that no file can have.
fn pack(index: i64, count: usize) -> Option<u32> {
    if index > 0 {
        return u32::try_from(index - 1).ok().filter(|&i| i < RELATIVE);
    }
    let relative = count as i64 + index + ORIGIN;
    let is_possible = index < 0 && (0..i64::from(RELATIVE) - 1).contains(&relative);
    is_possible.then_some(RELATIVE | relative as u32)
}

/// The absolute index that `packed` stands for, in a piece before which `base` values were read. It
/// may be out of range on both sides.
#[inline(always)]
pub(super) fn unpack(packed: u32, base: u32) -> i64 {
    if packed & RELATIVE == 0 {
        i64::from(packed)
    } else {
        i64::from(base) + i64::from(packed ^ RELATIVE) - ORIGIN
    }
}

/// A change of state between faces.
#[derive(Clone, Debug)]
pub(super) struct Event {
    /// Faces of this piece before it.
    pub(super) face: u32,
    /// Their triangles.
    pub(super) triangle: u32,
    /// Free line segments before it.
    pub(super) free_line: u32,
    /// Free points before it.
    pub(super) free_point: u32,
    /// Line within the piece, from 1.
    pub(super) line: u64,
    pub(super) change: Change,
}

/// What changes. Names are byte ranges of the piece.
#[derive(Clone, Debug)]
pub(super) enum Change {
    /// `o` or `g`.
    Name(Range<usize>),
    /// `usemtl`.
    Material(Range<usize>),
    /// `s`.
    Smoothing(u32),
    /// `mtllib`.
    Library(Range<usize>),
}

/// The corners of faces, one index list a kind. Empty lists of texture coordinates and normals: no
/// corner has any.
#[derive(Debug, Default)]
pub(super) struct FaceList {
    /// Corners of each face; empty while all are triangles.
    pub(super) sizes: Vec<u32>,
    pub(super) count: usize,
    pub(super) v: Vec<u32>,
    pub(super) vt: Vec<u32>,
    pub(super) vn: Vec<u32>,
    /// Faces with at least one corner without a normal.
    pub(super) bare: usize,
    /// Whether every corner takes the same number for all that it has.
    pub(super) vt_like_v: bool,
    pub(super) vn_like_v: bool,
}

impl FaceList {
    pub(super) fn triangles(&self) -> usize {
        self.v.len() - 2 * self.count
    }

    /// Takes away the faces with a vertex that is `bad`. Gives for each face whether it stays;
    /// `None` if all do.
    pub(super) fn leave_out_faces(&mut self, bad: impl Fn(u32) -> bool) -> Option<Vec<bool>> {
        if !self.v.iter().any(|&v| bad(v)) {
            return None;
        }
        let old = std::mem::take(self);
        (self.vt_like_v, self.vn_like_v) = (old.vt_like_v, old.vn_like_v);
        let mut stays = Vec::with_capacity(old.count);
        let mut start = 0;
        for f in 0..old.count {
            let size = old.sizes.get(f).map_or(3, |&size| size as usize);
            let corners = start..start + size;
            start += size;
            let good = !old.v[corners.clone()].iter().any(|&v| bad(v));
            stays.push(good);
            if !good {
                continue;
            }

            // Copy what the corners have.
            let normals = old.vn.get(corners.clone());
            self.count += 1;
            self.bare += usize::from(normals.is_none_or(|vn| vn.contains(&NONE)));
            self.vn.extend(normals.unwrap_or_default());
            self.vt.extend(old.vt.get(corners.clone()).unwrap_or_default());
            self.v.extend(&old.v[corners]);
            if !old.sizes.is_empty() {
                self.sizes.push(size as u32);
            }
        }

        // Lists that say nothing are empty.
        if self.sizes.iter().all(|&size| size == 3) {
            self.sizes.clear();
        }
        for list in [&mut self.vt, &mut self.vn] {
            if list.iter().all(|&index| index == NONE) {
                list.clear();
            }
        }
        Some(stays)
    }

    /// Takes the texture coordinates that are `bad` away from their corners; tells of how many.
    pub(super) fn leave_out_uvs(&mut self, bad: impl Fn(u32) -> bool) -> usize {
        let count = leave_out(&mut self.vt, bad);
        self.vt_like_v &= count == 0;
        count
    }

    /// Takes the normals that are `bad` away from their corners; tells of how many.
    pub(super) fn leave_out_normals(&mut self, bad: impl Fn(u32) -> bool) -> usize {
        let count = leave_out(&mut self.vn, bad);
        if count > 0 {
            self.vn_like_v = false;
            let mut start = 0;
            let bare = (0..self.count).filter(|&f| {
                let corners = start..start + self.sizes.get(f).map_or(3, |&size| size as usize);
                start = corners.end;
                self.vn.get(corners).is_none_or(|vn| vn.contains(&NONE))
            });
            self.bare = bare.count();
        }
        count
    }
}

/// Puts [`NONE`] where an index is `bad`; tells how often. A list without any other is emptied.
fn leave_out(packed: &mut Vec<u32>, bad: impl Fn(u32) -> bool) -> usize {
    let mut count = 0;
    for index in packed.iter_mut().filter(|i| **i != NONE && bad(**i)) {
        *index = NONE;
        count += 1;
    }
    if packed.iter().all(|&i| i == NONE) {
        packed.clear();
    }
    count
}

/// What a piece of the file holds.
#[derive(Debug, Default)]
pub(super) struct Chunk {
    pub(super) positions: Vec<[f32; 3]>,
    /// Colours of the positions as in the file; empty, or as many as positions.
    pub(super) colors: Vec<[f32; 3]>,
    pub(super) uvs: Vec<[f32; 2]>,
    pub(super) normals: Vec<[f32; 3]>,
    pub(super) faces: FaceList,
    /// Colours of vertices as ZBrush writes them, in order.
    pub(super) zbrush_colors: Vec<[u8; 3]>,
    /// What is wrong with the first index of a vertex that no file can have, and its line.
    pub(super) impossible: Option<(u64, String)>,
    /// Free line segments, packed, with the line they are on.
    pub(super) lines: Vec<([u32; 2], u64)>,
    /// Free points, packed, with the line they are on.
    pub(super) points: Vec<(u32, u64)>,
    pub(super) events: Vec<Event>,
    pub(super) warnings: Warnings,
    /// The first error: line within the piece, and what.
    pub(super) error: Option<(u64, String)>,
    pub(super) line_count: u64,
    /// Whether any index counts backwards.
    pub(super) has_relative: bool,
    /// Whether any statement was known.
    pub(super) understood: bool,
    /// Line of the first unknown statement.
    pub(super) first_unknown: Option<u64>,
}

impl Chunk {
    /// Reads all lines of a piece.
    pub(super) fn read(text: &[u8]) -> Self {
        let mut chunk = Self::default();
        (chunk.faces.vt_like_v, chunk.faces.vn_like_v) = (true, true);
        chunk.read_until(text, usize::MAX);
        if !chunk.colors.is_empty() {
            chunk.colors.resize(chunk.positions.len(), [1.0; 3]);
        }
        chunk
    }

    /// Takes away faces, free line segments and free points with a vertex that is `bad`; tells of
    /// how many.
    pub(super) fn leave_out(&mut self, bad: impl Fn(u32) -> bool) -> [usize; 3] {
        let faces = self.faces.leave_out_faces(&bad).unwrap_or_default();
        let lines: Vec<bool> =
            self.lines.iter().map(|(ends, _)| !ends.iter().any(|&end| bad(end))).collect();
        let points: Vec<bool> = self.points.iter().map(|&(point, _)| !bad(point)).collect();
        let mut keep = lines.iter();
        self.lines.retain(|_| keep.next() == Some(&true));
        let mut keep = points.iter();
        self.points.retain(|_| keep.next() == Some(&true));

        // Count anew what comes before each event.
        let left = |stays: &[bool], before: u32| {
            let gone = stays.iter().take(before as usize).filter(|stays| !**stays).count();
            before - gone as u32
        };
        let mut triangles = vec![0u32];
        triangles.extend((0..self.faces.count).scan(0, |sum, f| {
            *sum += self.faces.sizes.get(f).map_or(1, |&size| size - 2);
            Some(*sum)
        }));
        for event in &mut self.events {
            event.face = left(&faces, event.face);
            event.triangle = triangles[event.face as usize];
            event.free_line = left(&lines, event.free_line);
            event.free_point = left(&points, event.free_point);
        }
        [faces, lines, points].map(|stays| stays.iter().filter(|stays| !**stays).count())
    }

    /// The line within the piece, from 1, of the face that has corner number `corner` of the piece.
    pub(super) fn line_of_corner(text: &[u8], corner: usize) -> u64 {
        Self::default().read_until(text, corner)
    }

    /// Reads the positions once more, in double precision, less an offset. They were found sound
    /// before.
    pub(super) fn read_positions(&mut self, text: &[u8], offset: [f64; 3]) {
        let mut cursor = Cursor::new(text);
        self.positions.clear();
        while cursor.next_content() {
            if Statement::of(cursor.word()) == Statement::Position {
                let position = [0; 3].map(|_| cursor.double().unwrap_or(f64::NAN));
                self.positions.push(far::moved(position, offset));
            }
            cursor.next_line();
        }
    }

    /// Reads lines until there are more than `corners` face corners; gives the line reached.
    fn read_until(&mut self, text: &[u8], corners: usize) -> u64 {
        let mut cursor = Cursor::new(text);
        loop {
            // The commonest statements first; what they leave on their line is passed over.
            cursor.skip_blanks();
            let line = cursor.line();
            match cursor.peek() {
                b'\n' if cursor.at_end() => break,
                b'\n' => {}
                b'#' => self.comment(&mut cursor),
                _ => self.statement(text, &mut cursor),
            }
            if cursor.take_ill_formed() {
                self.warnings.note("number", Place::Line(line), || {
                    "ill-formed number; only its beginning counts".to_owned()
                });
            }
            if self.faces.v.len() > corners {
                return line;
            }
            cursor.next_line();
        }
        self.line_count = cursor.line() - 1;
        cursor.line()
    }

    /// Takes the colours out of a comment of ZBrush's.
    fn comment(&mut self, cursor: &mut Cursor) {
        let mut ahead = *cursor;
        if ahead.word() != b"#MRGB" {
            return;
        }
        let (digits, _) = ahead.word().as_chunks::<8>();
        let channel = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok();
        let color =
            |d: &[u8; 8]| Some([channel(&d[2..4])?, channel(&d[4..6])?, channel(&d[6..8])?]);
        self.zbrush_colors.extend(digits.iter().map_while(color));
    }

    fn statement(&mut self, text: &[u8], cursor: &mut Cursor) {
        let line = cursor.line();
        let word = cursor.word();
        let statement = Statement::of(word);

        // Read the statement, or warn that it is not read.
        let result = match statement {
            Statement::Position => self.position(cursor),
            Statement::Texture => self.texture_coordinate(cursor),
            Statement::Normal => self.normal(cursor),
            Statement::Face => self.face(cursor),
            Statement::Line => self.line(cursor),
            Statement::Points => self.points(cursor),
            Statement::Group | Statement::Object => self.event(cursor, text, Change::Name),
            Statement::Material => self.event(cursor, text, Change::Material),
            Statement::Library => self.event(cursor, text, Change::Library),
            Statement::Smoothing => self.smoothing(cursor),
            Statement::FreeForm => {
                self.warnings.note("free form", Place::Line(line), || {
                    "free-form curves and surfaces are not read".to_owned()
                });
                Ok(())
            }
            Statement::Unused => {
                self.warnings
                    .note("unused", Place::Line(line), || format!("`{}` is not used", show(word)));
                Ok(())
            }
            Statement::Unknown => {
                self.first_unknown = self.first_unknown.or(Some(line));
                self.warnings.note("unknown", Place::Line(line), || {
                    format!("unknown statement `{}`", show(word))
                });
                Ok(())
            }
        };

        // Note whether any statement is known, and keep the first error.
        self.understood |= statement != Statement::Unknown;
        if let Err(what) = result
            && self.error.is_none()
        {
            self.error = Some((line, what));
        }
    }

    fn position(&mut self, cursor: &mut Cursor) -> Result<(), String> {
        let mut values = [0.0f32; 8];
        let count = floats(cursor, &mut values);
        if count < 3 {
            return Err(too_few(cursor, count, "vertex"));
        }
        if count >= 6 {
            self.colors.resize(self.positions.len(), [1.0; 3]);
            self.colors.push([values[3], values[4], values[5]]);
        }
        self.positions.push([values[0], values[1], values[2]]);
        Ok(())
    }

    fn texture_coordinate(&mut self, cursor: &mut Cursor) -> Result<(), String> {
        let mut values = [0.0f32; 3];
        if floats(cursor, &mut values) == 0 {
            return Err(match cursor.word() {
                b"" => "a texture coordinate without a number".to_owned(),
                word => format!("`{}` is not a number, a texture coordinate needs one", show(word)),
            });
        }
        self.uvs.push([values[0], 1.0 - values[1]]);
        Ok(())
    }

    fn normal(&mut self, cursor: &mut Cursor) -> Result<(), String> {
        let mut values = [0.0f32; 3];
        let count = floats(cursor, &mut values);
        if count < 3 {
            return Err(too_few(cursor, count, "normal"));
        }
        self.normals.push(values);
        Ok(())
    }

    fn face(&mut self, cursor: &mut Cursor) -> Result<(), String> {
        let line = cursor.line();
        let start = self.faces.v.len();
        let mut bare = false;
        while !cursor.at_line_end() {
            let corner = match self.corner(cursor) {
                Ok(corner) => corner,
                Err(what) => {
                    self.drop_corners(start);
                    return Err(what);
                }
            };
            bare |= self.push_corner(corner);
        }

        // A face needs three corners.
        let count = self.faces.v.len() - start;
        if count < 3 {
            self.drop_corners(start);
            self.warnings.note("few corners", Place::Line(line), || {
                format!("a face with {count} corners, three are required; it is left out")
            });
            return Ok(());
        }
        if count != 3 || !self.faces.sizes.is_empty() {
            self.faces.sizes.resize(self.faces.count, 3);
            self.faces.sizes.push(count as u32);
        }
        self.faces.count += 1;
        self.faces.bare += usize::from(bare);
        Ok(())
    }

    /// Appends a corner; tells whether it has no normal.
    #[inline]
    fn push_corner(&mut self, [v, vt, vn]: [u32; 3]) -> bool {
        let faces = &mut self.faces;
        let before = faces.v.len();
        faces.v.push(v);
        if vt != NONE || !faces.vt.is_empty() {
            faces.vt.resize(before, NONE);
            faces.vt.push(vt);
        }
        if vn != NONE || !faces.vn.is_empty() {
            faces.vn.resize(before, NONE);
            faces.vn.push(vn);
        }
        faces.vt_like_v &= vt == v;
        faces.vn_like_v &= vn == v;
        vn == NONE
    }

    fn drop_corners(&mut self, start: usize) {
        self.faces.v.truncate(start);
        self.faces.vt.truncate(start);
        self.faces.vn.truncate(start);
    }

    /// `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    #[inline]
    fn corner(&mut self, cursor: &mut Cursor) -> Result<[u32; 3], String> {
        let v = self.vertex_index(cursor)?;
        let (mut vt, mut vn) = (NONE, NONE);
        if cursor.peek() == b'/' {
            cursor.advance(1);
            if !matches!(cursor.peek(), b'/' | b'\n' | b'#') && !is_blank(cursor.peek()) {
                vt = self.attribute_index(cursor, self.uvs.len(), "texture coordinate")?;
            }
            if cursor.peek() == b'/' {
                cursor.advance(1);
                if cursor.peek() != b'\n' && !is_blank(cursor.peek()) {
                    vn = self.attribute_index(cursor, self.normals.len(), "normal")?;
                }
            }
        }
        let next = cursor.peek();
        if next == b'\n' || is_blank(next) || next == b'#' || next == b'\\' {
            return Ok([v, vt, vn]);
        }
        Err(format!("`{}` does not belong to a corner", show(cursor.word())))
    }

    /// An index as it stands in the file.
    #[inline]
    fn written_index(&mut self, cursor: &mut Cursor, what: &str) -> Result<i64, String> {
        let index = cursor
            .integer()
            .ok_or_else(|| format!("`{}` is not a {what} index", show(cursor.word())))?;
        self.has_relative |= index < 0;
        Ok(index)
    }

    /// The index of a vertex: [`NONE`] for one that no file can have.
    #[inline]
    fn vertex_index(&mut self, cursor: &mut Cursor) -> Result<u32, String> {
        let start = cursor.offset();
        let index = self.written_index(cursor, "vertex")?;
        Ok(pack(index, self.positions.len()).unwrap_or_else(|| {
            let told = || (cursor.line(), no_index(index, cursor.word_at(start), "vertex"));
            self.impossible.get_or_insert_with(told);
            NONE
        }))
    }

    /// An index of what a corner can do without: [`NONE`] with a warning for one that no file can
    /// have.
    #[inline]
    fn attribute_index(
        &mut self,
        cursor: &mut Cursor,
        count: usize,
        what: &str,
    ) -> Result<u32, String> {
        let start = cursor.offset();
        let index = self.written_index(cursor, what)?;
        Ok(pack(index, count).unwrap_or_else(|| {
            let told = || format!("{}; left out", no_index(index, cursor.word_at(start), what));
            self.warnings.note("no index", Place::Line(cursor.line()), told);
            NONE
        }))
    }

    fn line(&mut self, cursor: &mut Cursor) -> Result<(), String> {
        let line = cursor.line();
        let mut previous = None;
        let before = self.lines.len();
        while !cursor.at_line_end() {
            let [end, ..] = self.corner(cursor)?;
            self.lines.extend(previous.map(|start| ([start, end], line)));
            previous = Some(end);
        }
        if self.lines.len() == before {
            self.warnings.note("short line", Place::Line(line), || {
                "a line with fewer than two ends; it is left out".to_owned()
            });
        }
        Ok(())
    }

    fn points(&mut self, cursor: &mut Cursor) -> Result<(), String> {
        let line = cursor.line();
        while !cursor.at_line_end() {
            let [point, ..] = self.corner(cursor)?;
            self.points.push((point, line));
        }
        Ok(())
    }

    fn smoothing(&mut self, cursor: &mut Cursor) -> Result<(), String> {
        let line = cursor.line();
        let word = cursor.word();
        let number = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
        let group = match word {
            b"off" | b"" => 0,
            b"on" => 1,
            _ => number.unwrap_or_else(|| {
                self.warnings.note("smoothing", Place::Line(line), || {
                    format!("smoothing group `{}` is not a number; taken as off", show(word))
                });
                0
            }),
        };
        self.push_event(line, Change::Smoothing(group));
        Ok(())
    }

    fn event(
        &mut self,
        cursor: &mut Cursor,
        text: &[u8],
        change: fn(Range<usize>) -> Change,
    ) -> Result<(), String> {
        let line = cursor.line();
        cursor.skip_blanks();
        let start = cursor.offset();
        let length = cursor.rest_of_line().len();
        debug_assert!(start + length <= text.len());
        self.push_event(line, change(start..start + length));
        Ok(())
    }

    fn push_event(&mut self, line: u64, change: Change) {
        let (face, triangle) = (self.faces.count as u32, self.faces.triangles() as u32);
        let (free_line, free_point) = (self.lines.len() as u32, self.points.len() as u32);
        self.events.push(Event { face, triangle, free_line, free_point, line, change });
    }
}

/// Reads numbers until the line ends, `values` are full or something else comes; gives their count.
#[inline(always)]
fn floats(cursor: &mut Cursor, values: &mut [f32]) -> usize {
    for (k, slot) in values.iter_mut().enumerate() {
        match cursor.float() {
            Some(value) => *slot = value,
            None => return k,
        }
    }
    values.len()
}

/// What is wrong where three coordinates were due and `count` were read.
#[cold]
fn too_few(cursor: &mut Cursor, count: usize, what: &str) -> String {
    match cursor.word() {
        [] | [b'#', ..] => format!("a {what} has {count} coordinates, three are required"),
        word => format!("`{}` is not a number, a {what} needs three", show(word)),
    }
}

/// What is wrong with an index that no file can have, in `word`.
#[cold]
fn no_index(index: i64, word: &[u8], what: &str) -> String {
    if index == 0 {
        return format!("{what} index 0: indices begin with 1, or count back from -1");
    }
    let number = word.split(|&b| b == b'/').next().unwrap_or(word);
    format!("{what} index {}: a file has at most {RELATIVE} of a kind", show(number))
}

fn show(word: &[u8]) -> String {
    String::from_utf8_lossy(&word[..word.len().min(40)]).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_survive_packing() {
        assert_eq!(unpack(pack(5, 0).unwrap(), 100), 4);
        assert_eq!(unpack(pack(-1, 3).unwrap(), 100), 102);
        assert_eq!(unpack(pack(-50, 3).unwrap(), 100), 53);
        assert_eq!(unpack(pack(-200, 3).unwrap(), 100), -97);
        assert_eq!((pack(0, 3), pack(1 << 40, 3), pack(-(1 << 40), 3)), (None, None, None));
    }

    #[test]
    fn corners_in_all_forms() {
        let chunk = Chunk::read(b"f 1 2/3 4//5 6/7/8\nf 1/ 2/// 3\nf 1 2 3\n");
        assert_eq!(chunk.faces.v, [0, 1, 3, 5, 0, 1, 2]);
        assert_eq!(chunk.faces.vt, [NONE, 2, NONE, 6, NONE, NONE, NONE]);
        assert_eq!(chunk.faces.vn, [NONE, NONE, 4, 7, NONE, NONE, NONE]);
        assert_eq!((chunk.faces.count, chunk.faces.bare, chunk.faces.sizes), (2, 2, vec![4, 3]));
        assert_eq!(chunk.error.unwrap(), (2, "`/` is not a normal index".to_owned()));
    }

    #[test]
    fn lines_are_counted_over_continuations() {
        let text = b"v 1 2 3\nf 1 2 \\\n 3\n\nf 1 1 1\n# end";
        let chunk = Chunk::read(text);
        assert_eq!((chunk.line_count, chunk.faces.count), (5, 2));
        assert_eq!((Chunk::line_of_corner(text, 2), Chunk::line_of_corner(text, 3)), (2, 5));
    }
}
