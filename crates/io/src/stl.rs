//! STL, the format of stereolithography: a soup of triangles, in ASCII or binary.
//!
//! A binary file is an 80-byte header, a 32-bit count `n` and `n` records of 50 bytes: normal, three corners (12
//! little-endian `f32`), 16 attribute bits. Headers that begin with `solid` exist, so the size decides: a file of
//! exactly `84 + 50 n` bytes is binary. An ASCII file is one or more `solid NAME … endsolid`, each of which becomes a
//! part of the one mesh.
//!
//! Corners at equal positions are welded (`weld`), since without shared vertices there are neither edges nor
//! smooth shading. Facet normals are left out: they follow from the corners and are wrong in many files. The attribute
//! bits, which some programs use for colours in incompatible ways, are left out with a warning.
//!
//! In:   bytes. Out: one mesh in model space.
//! Cost: `O(bytes)`, welding included; records are read where they lie.
//! Source: \[STL\].

use crate::file_name::stem;
use crate::format::stl_size::{HEADER, RECORD, claimed, is_binary_size};
use crate::mesh_scene::with_mesh;
use crate::text::{self, Cursor, to_utf8};
use crate::warnings::Warnings;
use crate::weld::weld;
use crate::{Error, Place};
use vitral_exec::Workers;
use vitral_scene::{Mesh, Part, Scene};

/// Reads an STL file of either kind.
///
/// # Errors
/// [`Error::Malformed`] with the byte at which a binary file ends too early, or the line of what is not STL in an ASCII
/// one.
pub fn load(bytes: &[u8], file: &str, workers: &Workers) -> Result<Scene, Error> {
    if is_binary_size(bytes) || !is_ascii(bytes) { binary(bytes, file, workers) } else { ascii(bytes, file, workers) }
}

/// Text that begins with `solid`. Binary data that happens to begin so has zero bytes early: in its count, its normals.
fn is_ascii(bytes: &[u8]) -> bool {
    let head = to_utf8(&bytes[..bytes.len().min(1024)]);
    let mut cursor = Cursor::new(&head);
    cursor.next_content() && cursor.word().eq_ignore_ascii_case(b"solid") && !head.contains(&0)
}

fn binary(bytes: &[u8], file: &str, workers: &Workers) -> Result<Scene, Error> {
    let size = bytes.len();
    let Some(count) = claimed(bytes) else {
        let what = format!("the file ends here: a binary STL file has at least {HEADER} bytes");
        return Err(Error::malformed(file, Place::Byte(size as u64), what));
    };
    let (records, rest) = bytes[HEADER..].as_chunks::<RECORD>();
    let mut warnings = Warnings::default();
    let count_wide = u64::from(count);
    if (records.len() as u64) < count_wide {
        let what = format!("the file ends here: {count} triangles are announced, {} are there", records.len());
        return Err(Error::malformed(file, Place::Byte(size as u64), what));
    }
    if records.len() as u64 > count_wide || !rest.is_empty() {
        let end = HEADER as u64 + RECORD as u64 * count_wide;
        warnings
            .note("", Place::Byte(end), || format!("{} bytes after the last triangle are left out", size as u64 - end));
    }
    let records = &records[..count as usize];
    check_count(records.len(), file)?;

    let corners = |t: usize| {
        let (numbers, _) = records[t][12..48].as_chunks::<12>();
        [0, 1, 2].map(|k| {
            let (words, _) = numbers[k].as_chunks::<4>();
            [0, 1, 2].map(|axis| f32::from_le_bytes(words[axis]))
        })
    };
    let (positions, triangles) = weld(records.len(), corners, workers);
    if records.iter().any(|r| r[48..50] != [0, 0]) {
        warnings.note("", Place::File, || "attribute bits (colours) of the facets are not used".to_owned());
    }
    let parts = vec![Part { name: String::new(), triangles: 0..count, material: None }];
    let mesh = Mesh { name: stem(file), positions, triangles, parts, ..Mesh::default() };
    Ok(with_mesh(Scene { warnings: warnings.into_messages(file), ..Scene::default() }, mesh, file))
}

fn check_count(triangles: usize, file: &str) -> Result<(), Error> {
    if triangles <= u32::MAX as usize / 3 {
        return Ok(());
    }
    Err(Error::malformed(file, Place::File, format!("{triangles} triangles, at most 1431655765 can be read")))
}

fn ascii(bytes: &[u8], file: &str, workers: &Workers) -> Result<Scene, Error> {
    let text = to_utf8(bytes);
    let mut reader = Reader { cursor: Cursor::new(&text), file, soup: Vec::new(), solids: Vec::new() };
    let mut warnings = Warnings::default();
    reader.read(&mut warnings)?;
    check_count(reader.soup.len(), file)?;
    let Reader { soup, solids, .. } = reader;
    let (positions, triangles) = weld(soup.len(), |t| soup[t], workers);
    let ends = solids.iter().skip(1).map(|s| s.1).chain([soup.len() as u32]);
    let parts = solids.iter().zip(ends);
    let parts = parts.map(|((name, first), end)| Part { name: name.clone(), triangles: *first..end, material: None });
    let parts = parts.filter(|p| !p.triangles.is_empty()).collect();
    let mesh = Mesh { name: stem(file), positions, triangles, parts, ..Mesh::default() };
    Ok(with_mesh(Scene { warnings: warnings.into_messages(file), ..Scene::default() }, mesh, file))
}

/// Reads ASCII STL word by word: line breaks mean nothing but the end of a solid's name, and not even that where a facet
/// follows on the line.
struct Reader<'a> {
    cursor: Cursor<'a>,
    file: &'a str,
    soup: Vec<[[f32; 3]; 3]>,
    /// Name and first triangle of each solid.
    solids: Vec<(String, u32)>,
}

impl<'a> Reader<'a> {
    fn read(&mut self, warnings: &mut Warnings) -> Result<(), Error> {
        let mut open = false;
        loop {
            let line = self.cursor.line();
            let word = self.word();
            match word.to_ascii_lowercase().as_slice() {
                b"" => break,
                b"solid" => {
                    let name = self.name_before(&[b"facet", b"normal"]);
                    self.solids.push((name, self.soup.len() as u32));
                    open = true;
                }
                b"endsolid" => {
                    self.name_before(&[b"solid"]);
                    open = false;
                }
                b"facet" if open => self.facet(warnings)?,
                b"color" | b"colour" => {
                    self.cursor.rest_of_line();
                    warnings.note("color", Place::Line(line), || "colours are not used".to_owned());
                }
                _ => return Err(self.unexpected(word, if open { "`facet` or `endsolid`" } else { "`solid`" })),
            }
        }
        if open {
            warnings.note("", Place::Line(self.cursor.line()), || "the file ends without `endsolid`".to_owned());
        }
        Ok(())
    }

    /// The next word of the text, on whatever line; empty at its end.
    fn word(&mut self) -> &'a [u8] {
        loop {
            let word = self.cursor.word();
            if !word.is_empty() || self.cursor.at_end() {
                return word;
            }
            self.cursor.next_line();
        }
    }

    /// The rest of the line up to these words in a row, if facets follow there.
    fn name_before(&mut self, words: &[&[u8]]) -> String {
        let (start, mut ahead) = (self.cursor, self.cursor);
        let rest = ahead.rest_of_line();
        let has_facet = rest.windows(5).any(|w| w.eq_ignore_ascii_case(b"facet"));
        let mut name = Vec::new();
        if has_facet {
            loop {
                let mut after = self.cursor;
                if words.iter().all(|word| after.word().eq_ignore_ascii_case(word)) {
                    return text::name(&name.join(&b' ')).into_owned();
                }
                match self.cursor.word() {
                    b"" => break,
                    word => name.push(word),
                }
            }
        }
        self.cursor = start;
        text::name(self.cursor.rest_of_line()).into_owned()
    }

    fn unexpected(&self, word: &[u8], wanted: &str) -> Error {
        let seen = match word {
            b"" => "the file ends here".to_owned(),
            word => format!("`{}`", String::from_utf8_lossy(&word[..word.len().min(40)])),
        };
        Error::malformed(self.file, Place::Line(self.cursor.line()), format!("{seen}, {wanted} is required"))
    }

    fn expect(&mut self, wanted: &str) -> Result<(), Error> {
        let word = self.word();
        if word.eq_ignore_ascii_case(wanted.as_bytes()) {
            return Ok(());
        }
        Err(self.unexpected(word, &format!("`{wanted}`")))
    }

    /// Goes behind `outer`, over what stands for a normal.
    fn skip_normal(&mut self) -> Result<(), Error> {
        for _ in 0..3 {
            if self.word().eq_ignore_ascii_case(b"outer") {
                return Ok(());
            }
        }
        self.expect("outer")
    }

    /// What follows `facet`: a normal, which is passed over, and a loop of three vertices.
    fn facet(&mut self, warnings: &mut Warnings) -> Result<(), Error> {
        self.expect("normal")?;
        self.skip_normal()?;
        self.expect("loop")?;
        let mut triangle = [[0.0; 3]; 3];
        for corner in &mut triangle {
            self.expect("vertex")?;
            for coordinate in corner {
                let Some(value) = self.cursor.float() else {
                    let word = self.cursor.word();
                    return Err(self.unexpected(word, "a coordinate"));
                };
                *coordinate = value;
            }
            if self.cursor.take_ill_formed() {
                warnings.note("number", Place::Line(self.cursor.line()), || {
                    "ill-formed number; only its beginning counts".to_owned()
                });
            }
        }
        self.expect("endloop")?;
        self.expect("endfacet")?;
        self.soup.push(triangle);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn binary_file(header: &[u8], triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
        let mut bytes = header.to_vec();
        bytes.resize(80, b' ');
        bytes.extend((triangles.len() as u32).to_le_bytes());
        for t in triangles {
            bytes.extend([0; 12]);
            bytes.extend(t.as_flattened().iter().flat_map(|c| c.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    const TWO: [[[f32; 3]; 3]; 2] =
        [[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [-0.0, 1.0, 0.0]]];

    fn facet(t: &[[f32; 3]; 3]) -> String {
        let v: String = t.iter().map(|p| format!("  VERTEX {} {} {:e}\n", p[0], p[1], p[2])).collect();
        format!("facet normal 0 0 nan\n outer loop\r\n{v} endloop endfacet\n")
    }

    fn read(bytes: &[u8]) -> Result<Scene, Error> {
        load(bytes, "t.stl", &Workers::single())
    }

    #[test]
    fn both_kinds_give_the_same_welded_mesh() {
        let from_binary = read(&binary_file(b"solid but binary", &TWO)).unwrap();
        let text = format!("solid a b\n{}{}endsolid a b\n", facet(&TWO[0]), facet(&TWO[1]));
        let from_text = read(text.as_bytes()).unwrap();
        let (a, b) = (&from_binary.meshes[0], &from_text.meshes[0]);
        a.check().unwrap();
        assert_eq!((&a.positions, &a.triangles), (&b.positions, &b.triangles));
        assert_eq!((a.positions.len(), &a.triangles), (4, &vec![[0, 1, 2], [1, 3, 2]]));
        assert_eq!(b.parts[0].name, "a b");
        assert!(from_binary.warnings.is_empty() && from_text.warnings.is_empty());
    }

    #[test]
    fn one_line_is_enough() {
        let text = format!("solid a b {}endsolid a b solid c {}endsolid c", facet(&TWO[0]), facet(&TWO[1]));
        for end in ["", "\n", "\r\n"] {
            let scene = read(format!("{}{end}", text.replace(['\r', '\n'], " ")).as_bytes()).unwrap();
            let parts = &scene.meshes[0].parts;
            let parts: Vec<_> = parts.iter().map(|p| (p.name.as_str(), p.triangles.clone())).collect();
            assert_eq!((parts, scene.warnings), (vec![("a b", 0..1), ("c", 1..2)], vec![]));
        }
        // A name is a name, whatever it says.
        let named = format!("solid my facet\n{}endsolid my solid facet\n", facet(&TWO[0]));
        assert_eq!(read(named.as_bytes()).unwrap().meshes[0].parts[0].name, "my facet");
        let bare = format!("solid\n{}endsolid", facet(&TWO[0]).replace("0 0 nan", ""));
        assert_eq!(read(bare.as_bytes()).unwrap().meshes[0].triangles.len(), 1);
    }

    #[test]
    fn each_solid_is_a_part() {
        let text = format!("solid a\n{}endsolid a\nsolid\nendsolid\nsolid c\n{}", facet(&TWO[0]), facet(&TWO[1]));
        let scene = read(text.as_bytes()).unwrap();
        let parts: Vec<_> = scene.meshes[0].parts.iter().map(|p| (p.name.as_str(), p.triangles.clone())).collect();
        assert_eq!(parts, [("a", 0..1), ("c", 1..2)]);
        assert_eq!(scene.warnings, ["t.stl: line 18: the file ends without `endsolid`"]);
    }

    #[test]
    fn broken_files_are_refused_with_their_place() {
        let refusal = |bytes: &[u8]| read(bytes).unwrap_err().to_string();
        let whole = binary_file(b"x", &TWO);
        assert_eq!(
            refusal(&whole[..183]),
            "t.stl: byte 183: the file ends here: 2 triangles are announced, 1 are there"
        );
        assert!(refusal(&whole[..50]).starts_with("t.stl: byte 50: the file ends here: a binary"));
        assert_eq!(
            refusal(b"solid\nfacet normal 0 0 1\nouter loop\nvertex 1 2\n"),
            "t.stl: line 4: the file ends here, a coordinate is required"
        );
        assert_eq!(refusal(b"solid\n vertex"), "t.stl: line 2: `vertex`, `facet` or `endsolid` is required");
        let longer = [whole, vec![7; 60]].concat();
        assert_eq!(read(&longer).unwrap().warnings, ["t.stl: byte 184: 60 bytes after the last triangle are left out"]);
    }
}
