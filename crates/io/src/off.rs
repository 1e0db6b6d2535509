//! OFF, Geomview's object file format: vertices, then polygons.
//!
//! The first word says what a vertex line holds, in this order: `[ST][C][N][4]OFF`: position (four
//! homogeneous coordinates with `4`), normal with `N`, colour with `C`, texture coordinates with
//! `ST`. Prefixes in another order and lower case, which exist, mean the same. A line with the
//! numbers of vertices, faces and edges follows (the last may be missing; it is not used; some
//! files have the first of them glued to the word, `OFF8 6 12`), then each vertex and each face:
//! the corner count, the corners, and possibly a colour. Both begin a line and may go on over
//! several, but a colour that may be left out is on the line of the values before it. `#` begins a
//! comment.
//!
//! Colours are sRGB, `0..=255` where they look like bytes, else `0..=1` (`color_range`); those of
//! faces count if vertices have none. Texture coordinates run upwards and are turned to `1 - v`.
//! Faces with fewer than three corners are left out with a warning. Binary and `n`-dimensional
//! files are not read.
//!
//! In:   text. Out: one mesh in model space.
//! Cost: `O(bytes)`; counts in the file allocate nothing.
//! Source: \[OFF\].

use crate::color_range::ColorRange;
use crate::far;
use crate::file_name::stem;
use crate::format::off_header::Header;
use crate::mesh_scene::with_mesh_at;
use crate::text::{Cursor, to_utf8};
use crate::warnings::Warnings;
use crate::{Error, Place};
use vitral_exec::Workers;
use vitral_math::color::linear_from_srgb;
use vitral_scene::{Attribute, Mesh, Part, Scene};

/// Reads an OFF file.
///
/// # Errors
/// [`Error::Malformed`] with the line at which the file breaks its own announcements;
/// [`Error::Unsupported`] for binary and `n`-dimensional files.
pub fn load(bytes: &[u8], file: &str, workers: &Workers) -> Result<Scene, Error> {
    let text = to_utf8(bytes);
    let (mut scene, offset) = read(&text, file, None, workers)?;
    if offset.is_some() {
        (scene, _) = read(&text, file, offset, workers)?;
    }
    Ok(scene)
}

/// Reads the text, and takes an offset from each position. Without one, gives that of a model far
/// from the origin.
fn read(
    text: &[u8],
    file: &str,
    offset: Option<[f64; 3]>,
    workers: &Workers,
) -> Result<(Scene, Option<[f64; 3]>), Error> {
    let mut reader =
        Reader { cursor: Cursor::new(text), file, warnings: Warnings::default(), offset };
    let header = reader.header()?;
    let [vertices, faces] = reader.counts()?;
    let mut lists = Lists::default();
    for _ in 0..vertices {
        reader.vertex(header, &mut lists)?;
    }
    for _ in 0..faces {
        reader.face(&mut lists)?;
    }
    if reader.cursor.next_content() {
        let place = Place::Line(reader.cursor.line());
        reader.warnings.note("", place, || "what follows the last face is left out".to_owned());
    }

    let wanted = far::offset(&lists.positions).filter(|_| offset.is_none());
    let mesh = lists.into_mesh(stem(file), header, &mut reader.warnings, workers);
    let scene = Scene { warnings: reader.warnings.into_messages(file), ..Scene::default() };
    Ok((with_mesh_at(scene, mesh, offset, file), wanted))
}

/// Everything read so far.
#[derive(Debug, Default)]
struct Lists {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    /// Encoded, as in the file.
    colors: Vec<[f32; 4]>,
    uvs: Vec<[f32; 2]>,
    sizes: Vec<u32>,
    corners: Vec<u32>,
    /// Encoded, one a face; `None` where the face has none.
    face_colors: Vec<Option<[f32; 4]>>,
}

struct Reader<'a> {
    cursor: Cursor<'a>,
    file: &'a str,
    warnings: Warnings,
    /// What is taken from each position.
    offset: Option<[f64; 3]>,
}

impl<'a> Reader<'a> {
    fn error(&self, what: impl Into<String>) -> Error {
        Error::malformed(self.file, Place::Line(self.cursor.line()), what)
    }

    fn header(&mut self) -> Result<Header, Error> {
        if !self.cursor.next_content() {
            return Err(self.error("the file ends here, `OFF` is required"));
        }
        // The word may be missing: then the file begins with its counts.
        let word = self.cursor.word_at(self.cursor.offset());
        let Some((header, length)) = Header::begin(word) else {
            if word.first().is_some_and(u8::is_ascii_digit) {
                return Ok(Header {
                    texture: false,
                    color: false,
                    normal: false,
                    homogeneous: false,
                    dimensions: false,
                });
            }
            let seen = String::from_utf8_lossy(&word[..word.len().min(40)]);
            return Err(self.error(format!("`{seen}`, `OFF` is required")));
        };
        self.cursor.advance(length);
        let is_binary = self.cursor.word_at(self.cursor.offset()).eq_ignore_ascii_case(b"BINARY");
        if header.dimensions || is_binary {
            let kind = if is_binary { "binary" } else { "n-dimensional" };
            return Err(Error::Unsupported {
                file: self.file.to_owned(),
                what: format!("{kind} OFF is not read"),
            });
        }
        Ok(header)
    }

    /// The numbers of vertices and faces, which the rest of the file must be able to hold.
    fn counts(&mut self) -> Result<[usize; 2], Error> {
        if !self.cursor.next_content() {
            return Err(self.error(
                "the file ends here, the numbers of vertices, faces and edges are required",
            ));
        }
        let mut counts = [0; 3];
        for (k, count) in counts.iter_mut().enumerate() {
            *count = match self.cursor.integer() {
                Some(n @ 0..) => n as u64,
                None if k == 2 && self.cursor.at_line_end() => 0,
                _ => {
                    return Err(self.error("the numbers of vertices, faces and edges are required"));
                }
            };
        }
        // A vertex takes six bytes with its line end, a face two.
        let room = self.cursor.remaining() as u64;
        for (count, size, what) in [(counts[0], 6, "vertices"), (counts[1], 2, "faces")] {
            if count > (room + 1) / size {
                return Err(self.error(format!(
                    "{count} {what} are announced, the file has {room} bytes left"
                )));
            }
        }
        self.cursor.next_line();
        Ok([counts[0] as usize, counts[1] as usize])
    }

    fn content(&mut self, what: &str) -> Result<(), Error> {
        match self.cursor.next_content() {
            true => Ok(()),
            false => Err(self.error(format!("the file ends here, {what} is required"))),
        }
    }

    /// What `read` finds on this line or, if that is at its end, on the next with something on it.
    fn here_or_below<T>(&mut self, read: impl Fn(&mut Cursor<'a>) -> Option<T>) -> Option<T> {
        let here = read(&mut self.cursor);
        if here.is_none() && self.cursor.at_line_end() && self.cursor.next_content() {
            return read(&mut self.cursor);
        }
        here
    }

    /// Numbers that belong together, on one line or several.
    fn floats<const N: usize>(&mut self, what: &str) -> Result<[f32; N], Error> {
        self.numbers(Cursor::float, what)
    }

    /// The same in double precision.
    fn doubles<const N: usize>(&mut self, what: &str) -> Result<[f64; N], Error> {
        self.numbers(Cursor::double, what)
    }

    fn numbers<T: Copy + Default, const N: usize>(
        &mut self,
        read: impl Fn(&mut Cursor<'a>) -> Option<T>,
        what: &str,
    ) -> Result<[T; N], Error> {
        let mut values = [T::default(); N];
        for (k, value) in values.iter_mut().enumerate() {
            *value = match self.here_or_below(&read) {
                Some(value) => value,
                None => return Err(self.no_number(k, what, N)),
            };
        }
        if self.cursor.take_ill_formed() {
            let place = Place::Line(self.cursor.line());
            self.warnings.note("number", place, || {
                "ill-formed number; only its beginning counts".to_owned()
            });
        }
        Ok(values)
    }

    /// A word, or the end of the file, where the number `k` of `count` is due.
    #[cold]
    fn no_number(&mut self, k: usize, what: &str, count: usize) -> Error {
        match self.cursor.word() {
            b"" => self.error(format!("the file ends here: {k} numbers, a {what} has {count}")),
            word => {
                let seen = String::from_utf8_lossy(&word[..word.len().min(40)]).into_owned();
                self.error(format!("`{seen}` is not a number, a {what} has {count}"))
            }
        }
    }

    fn vertex(&mut self, header: Header, lists: &mut Lists) -> Result<(), Error> {
        self.content("a vertex")?;
        let position = if header.homogeneous {
            let [x, y, z, w] = self.floats("vertex")?;
            let offset = self.offset.unwrap_or_default();
            std::array::from_fn(|k| (f64::from([x, y, z][k]) / f64::from(w) - offset[k]) as f32)
        } else if let Some(offset) = self.offset {
            far::moved(self.doubles("vertex")?, offset)
        } else {
            self.floats("vertex")?
        };
        lists.positions.push(position);
        if header.normal {
            lists.normals.push(self.floats("normal")?);
        }
        if header.color {
            // Three or four numbers, unless texture coordinates follow.
            let rgb = self.floats::<3>("colour")?;
            let alpha = if header.texture || !self.cursor.at_line_end() {
                Some(self.floats::<1>("colour")?[0])
            } else {
                None
            };
            lists.colors.push([rgb[0], rgb[1], rgb[2], alpha.unwrap_or(f32::NAN)]);
        }
        if header.texture {
            let [u, v] = self.floats("texture coordinate")?;
            lists.uvs.push([u, 1.0 - v]);
        }
        if !self.cursor.at_line_end() {
            let place = Place::Line(self.cursor.line());
            self.warnings.note("vertex tail", place, || {
                "more numbers than a vertex has; left out".to_owned()
            });
        }
        self.cursor.next_line();
        Ok(())
    }

    fn face(&mut self, lists: &mut Lists) -> Result<(), Error> {
        self.content("a face")?;
        let line = self.cursor.line();
        let Some(size @ 0..) = self.cursor.integer() else {
            return Err(self.error("a face begins with the number of its corners"));
        };
        let start = lists.corners.len();
        for k in 0..size {
            match self.here_or_below(Cursor::integer) {
                Some(index) if (0..lists.positions.len() as i64).contains(&index) => {
                    lists.corners.push(index as u32)
                }
                Some(index) => {
                    return Err(self.error(format!(
                        "index {index}, the file has {} vertices",
                        lists.positions.len()
                    )));
                }
                None => return Err(self.error(format!("{k} indices, the face has {size} corners"))),
            }
        }
        let color = self.face_color();
        self.cursor.next_line();
        if size < 3 {
            lists.corners.truncate(start);
            self.warnings.note("few corners", Place::Line(line), || {
                format!("a face with {size} corners, three are required; it is left out")
            });
            return Ok(());
        }
        lists.sizes.push(size as u32);
        lists.face_colors.push(color);
        Ok(())
    }

    /// What follows a face's corners: nothing, an index into a colour map that is not there, or
    /// three or four numbers.
    fn face_color(&mut self) -> Option<[f32; 4]> {
        let mut values = [f32::NAN; 4];
        let mut count = 0;
        while count < 4 && !self.cursor.at_line_end() {
            let Some(value) = self.cursor.float() else { break };
            values[count] = value;
            count += 1;
        }
        if count >= 3 {
            return Some(values);
        }
        if count > 0 {
            let place = Place::Line(self.cursor.line());
            self.warnings.note("color map", place, || "colour map indices are not used".to_owned());
        }
        None
    }
}

impl Lists {
    fn into_mesh(
        self,
        name: String,
        header: Header,
        warnings: &mut Warnings,
        workers: &Workers,
    ) -> Mesh {
        let built = crate::polygons::build(&self.positions, &self.sizes, self.corners, workers);

        // Take the colours of the vertices, or else those of the faces.
        let colors = if header.color {
            Some(Attribute::per_vertex(decode(&self.colors, warnings)))
        } else if self.face_colors.iter().any(Option::is_some) {
            let colors: Vec<[f32; 4]> =
                self.face_colors.iter().map(|c| c.unwrap_or([f32::NAN; 4])).collect();
            Some(Attribute {
                values: decode(&colors, warnings),
                corners: Some(built.per_face(&self.sizes)),
            })
        } else {
            None
        };

        // Assemble the mesh.
        Mesh {
            name,
            parts: vec![Part {
                name: String::new(),
                triangles: 0..built.triangles.len() as u32,
                material: None,
            }],
            triangles: built.triangles,
            faces: built.faces,
            normals: header.normal.then_some(Attribute::per_vertex(self.normals)),
            uvs: if header.texture { vec![Attribute::per_vertex(self.uvs)] } else { Vec::new() },
            colors_from_srgb: colors.is_some(),
            colors,
            // Vertices without faces are a point cloud.
            points: if self.sizes.is_empty() {
                (0..self.positions.len() as u32).collect()
            } else {
                Vec::new()
            },
            positions: self.positions,
            ..Mesh::default()
        }
    }
}

/// Linear colours from encoded ones; NaN is 1 (white, opaque). Bytes are whole numbers as the
/// format has them; other values above 1 are told.
fn decode(encoded: &[[f32; 4]], warnings: &mut Warnings) -> Vec<[f32; 4]> {
    let range = ColorRange::of(encoded.iter().flat_map(|c| [c[0], c[1], c[2]]));
    let (scale, alpha_scale) =
        (range.scale(), ColorRange::of(encoded.iter().map(|c| c[3])).scale());
    if let Some(what) = range.oddity("colours").filter(|_| !range.is_whole) {
        warnings.note("", Place::File, || what);
    }
    let unit = |c: f32, scale: f32| if c.is_nan() { 1.0 } else { (c / scale).clamp(0.0, 1.0) };
    encoded
        .iter()
        .map(|&[r, g, b, a]| {
            let [r, g, b] = [r, g, b].map(|c| linear_from_srgb(unit(c, scale)));
            [r, g, b, unit(a, alpha_scale)]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use vitral_scene::Faces;

    fn read(text: &str) -> Result<Scene, Error> {
        let scene = load(text.as_bytes(), "t.off", &Workers::single())?;
        scene.meshes.iter().for_each(|m| m.check().unwrap());
        Ok(scene)
    }

    #[test]
    fn polygons_and_comments() {
        let s = read(
            "OFF # a square\n\n4 2 0\n0 0 0\n1 0 0 # corner\n1 1 0\n0 1 0\n4 0 1 2 3\n3 0 1 2\n",
        )
        .unwrap();
        let m = &s.meshes[0];
        assert_eq!(
            m.faces,
            Faces::Polygons { starts: vec![0, 4, 7], corners: vec![0, 1, 2, 3, 0, 1, 2] }
        );
        assert_eq!((m.triangles.len(), s.warnings.len()), (3, 0));
    }

    #[test]
    fn every_prefix_is_read_in_its_order() {
        let s = read("STCN4OFF 3 1 0\n2 4 6 2  0 0 1  255 0 0 128  .5 .25\n1 0 0 1 0 0 1 0 0 0 255 0 0\n0 1 0 1 0 0 1 0 0 0 255 0 0\n3 0 1 2")
            .unwrap();
        let m = &s.meshes[0];
        assert_eq!((m.positions[0], m.uvs[0].values[0]), ([1.0, 2.0, 3.0], [0.5, 0.75]));
        assert_eq!(m.colors.as_ref().unwrap().values[0], [1.0, 0.0, 0.0, 128.0 / 255.0]);
        assert_eq!(m.normals.as_ref().unwrap().values[0], [0.0, 0.0, 1.0]);
        assert_eq!(m.faces, Faces::Triangles);
        assert_eq!(Header::parse(b"xOFF"), None);
    }

    #[test]
    fn headers_in_every_order_and_case() {
        let parse = |word: &str| Header::parse(word.as_bytes());
        for (word, usual) in [
            ("off", "OFF"),
            ("Off", "OFF"),
            ("NCOFF", "CNOFF"),
            ("cnoff", "CNOFF"),
            ("CSTOFF", "STCOFF"),
            ("NSTCOFF", "STCNOFF"),
            ("4NCSTOFF", "STCN4OFF"),
        ] {
            assert!(parse(word).is_some());
            assert_eq!(parse(word), parse(usual), "{word}");
        }
        assert!(parse("nOFF").unwrap().dimensions && parse("4nOFF").unwrap().dimensions);
        assert_eq!(
            [parse("CCOFF"), parse("SOFF"), parse("OF"), parse("F"), parse("OFFS")],
            [None; 5]
        );
        let normals = "0 0 1  255 0 0 255";
        let s = read(&format!(
            "NCOFF 3 1 0\n0 0 0 {normals}\n1 0 0 {normals}\n0 1 0 {normals}\n3 0 1 2\n"
        ))
        .unwrap();
        let m = &s.meshes[0];
        assert_eq!(
            (m.normals.as_ref().unwrap().values[2], m.colors.as_ref().unwrap().values[2][0]),
            ([0.0, 0.0, 1.0], 1.0)
        );
    }

    #[test]
    fn counts_may_be_glued_to_the_header() {
        let rest = " 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
        for head in ["OFF3", "off3", "# c\n OFF3", "OFF\n3"] {
            let s = read(&format!("{head}{rest}")).unwrap();
            assert_eq!((s.meshes[0].triangles.len(), s.warnings.len()), (1, 0), "{head}");
        }
        let begin = |word: &str| {
            Header::begin(word.as_bytes()).map(|(header, length)| (Some(header), length))
        };
        for (word, header) in
            [("COFF12", "COFF"), ("4OFF8", "4OFF"), ("STCN4OFF", "STCN4OFF"), ("OFF", "OFF")]
        {
            assert_eq!(
                begin(word),
                Some((Header::parse(header.as_bytes()), header.len())),
                "{word}"
            );
        }
        assert_eq!([begin("OFF8x"), begin("12"), begin("8OFF"), begin("")], [None; 4]);
        let text = format!("OFF3{rest}");
        assert_eq!(crate::Format::detect(text.as_bytes(), "-").unwrap(), crate::Format::Off);
    }

    #[test]
    fn vertices_and_faces_may_go_over_lines() {
        let s = read(
            "off\r\n# c\r\n4\t1 0\r\n0 0\r\n\t0 # first\r\n1\r\n\r\n0 0\r\n1 1 0\r\n0 1 0\r\n4 0 1 # more\r\n 2 3",
        )
        .unwrap();
        let m = &s.meshes[0];
        assert_eq!(
            (m.positions[1], m.face_corners(0), s.warnings.len()),
            ([1.0, 0.0, 0.0], &[0, 1, 2, 3][..], 0)
        );
    }

    #[test]
    fn faces_may_have_colours() {
        let s =
            read("OFF\n3 3 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\n3 0 1 2\n3 0 1 2 7").unwrap();
        let colors = s.meshes[0].colors.as_ref().unwrap();
        assert_eq!(colors.at(0, &s.meshes[0].triangles), [[1.0, 0.0, 0.0, 1.0]; 3]);
        assert_eq!(colors.at(1, &s.meshes[0].triangles), [[1.0; 4]; 3]);
        assert_eq!(s.warnings, ["t.off: line 8: colour map indices are not used"]);
    }

    #[test]
    fn false_announcements_are_refused() {
        let refusal = |text: &str| read(text).unwrap_err().to_string();
        assert_eq!(
            refusal("OFF\n3 4\n0 0 0\n"),
            "t.off: line 2: 3 vertices are announced, the file has 7 bytes left"
        );
        assert_eq!(
            refusal("OFF\n3\n0 0 0\n"),
            "t.off: line 2: the numbers of vertices, faces and edges are required"
        );
        assert_eq!(
            refusal("OFF\n9999999999 0 0\n"),
            "t.off: line 2: 9999999999 vertices are announced, the file has 1 bytes left"
        );
        assert_eq!(
            refusal("OFF\n1 2 0\n0 0 0\n3 0 0 1"),
            "t.off: line 4: index 1, the file has 1 vertices"
        );
        assert_eq!(
            refusal("OFF\n1 1 0\n0 0 0\n3 0 0"),
            "t.off: line 4: 2 indices, the face has 3 corners"
        );
        assert_eq!(
            refusal("OFF\n1 1 0\n0 0 0\n"),
            "t.off: line 4: the file ends here, a face is required"
        );
        assert_eq!(
            refusal("OFF\n1 0 0\n0 zero 0\n"),
            "t.off: line 3: `zero` is not a number, a vertex has 3"
        );
        assert_eq!(
            refusal("OFF\n1 0 0\n0 00000\n"),
            "t.off: line 4: the file ends here: 2 numbers, a vertex has 3"
        );
        assert_eq!(refusal("OFF BINARY\n"), "t.off: binary OFF is not read");
    }
}
