//! ASCII STL, word by word: line breaks mean nothing but the end of a solid's name, and not even
//! that where a facet follows on the line.
//!
//! Files in the wild vary. All of these are read, with one warning a kind: keywords in two words
//! (`end loop`), missing ones where the meaning is plain, comments (`# …`), loops of more than
//! three corners, which are cut into triangles, and a last facet that the file ends in, which is
//! left out.

use super::check_count;
use crate::far;
use crate::file_name::stem;
use crate::mesh_scene::with_mesh_at;
use crate::text::{self, Cursor, to_utf8};
use crate::triangulate::triangulate;
use crate::warnings::Warnings;
use crate::weld::weld;
use crate::{Error, Place};
use vitral_exec::Workers;
use vitral_scene::{Mesh, Part, Scene};

pub(super) fn read(bytes: &[u8], file: &str, workers: &Workers) -> Result<Scene, Error> {
    let text = to_utf8(bytes);
    let mut reader = Reader::new(&text, file, None);
    reader.read()?;
    check_count(reader.soup.len(), file)?;

    // Read a model far away once more.
    let offset = far::offset(reader.soup.as_flattened());
    if offset.is_some() {
        reader = Reader::new(&text, file, offset);
        reader.read()?;
    }

    // Weld the corners, and make a part of each solid.
    let Reader { soup, solids, warnings, .. } = reader;
    let (positions, triangles) = weld(soup.len(), |t| soup[t], workers);
    let ends = solids.iter().skip(1).map(|s| s.1).chain([soup.len() as u32]);
    let parts = solids.iter().zip(ends);
    let parts = parts.map(|((name, first), end)| Part {
        name: name.clone(),
        triangles: *first..end,
        material: None,
    });
    let parts = parts.filter(|p| !p.triangles.is_empty()).collect();
    let mesh = Mesh { name: stem(file), positions, triangles, parts, ..Mesh::default() };
    Ok(with_mesh_at(
        Scene { warnings: warnings.into_messages(file), ..Scene::default() },
        mesh,
        offset,
        file,
    ))
}

/// Where in the grammar the reader is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Before `solid`, behind `endsolid`.
    Outside,
    /// Behind `solid` or `endfacet`.
    Solid,
    /// Behind `facet normal`.
    Facet,
    /// Behind `outer loop`.
    Loop,
    /// Behind `endloop`.
    AfterLoop,
}

struct Reader<'a> {
    cursor: Cursor<'a>,
    file: &'a str,
    warnings: Warnings,
    stage: Stage,
    /// Corners of the open loop.
    corners: Vec<[f32; 3]>,
    soup: Vec<[[f32; 3]; 3]>,
    /// Name and first triangle of each solid.
    solids: Vec<(String, u32)>,
    /// What is taken from each corner.
    offset: Option<[f64; 3]>,
}

impl<'a> Reader<'a> {
    fn new(text: &'a [u8], file: &'a str, offset: Option<[f64; 3]>) -> Self {
        Self {
            cursor: Cursor::new(text),
            file,
            warnings: Warnings::default(),
            stage: Stage::Outside,
            corners: Vec::new(),
            soup: Vec::new(),
            solids: Vec::new(),
            offset,
        }
    }

    fn read(&mut self) -> Result<(), Error> {
        // Read keyword by keyword; files may leave some out.
        loop {
            let mut word = self.word().to_ascii_lowercase();
            if word == b"end" {
                word = self.split_keyword();
            }
            match word.as_slice() {
                b"" => break,
                b"solid" => self.begin_solid(),
                b"endsolid" => {
                    self.demand("endsolid", &[Stage::Solid]);
                    self.finish_loop();
                    self.name_before(&[b"solid"]);
                    self.stage = Stage::Outside;
                }
                b"facet" => self.begin_facet(),
                b"outer" | b"loop" if self.stage != Stage::Outside => self.begin_loop(&word),
                b"vertex" if matches!(self.stage, Stage::Facet | Stage::Loop) => {
                    self.demand("vertex", &[Stage::Loop]);
                    self.stage = Stage::Loop;
                    if !self.vertex()? {
                        break;
                    }
                }
                b"endloop" if matches!(self.stage, Stage::Facet | Stage::Loop) => {
                    self.demand("endloop", &[Stage::Loop]);
                    self.finish_loop();
                    self.stage = Stage::AfterLoop;
                }
                b"endfacet" if self.stage != Stage::Outside => {
                    self.demand("endfacet", &[Stage::AfterLoop]);
                    self.finish_loop();
                    self.stage = Stage::Solid;
                }
                // Skip colours.
                b"color" | b"colour" => {
                    let place = Place::Line(self.cursor.line());
                    self.cursor.rest_of_line();
                    self.warnings.note("color", place, || "colours are not used".to_owned());
                }
                _ => return Err(self.unexpected(&word)),
            }
        }
        self.finish_file()
    }

    /// The next word of the text, on whatever line and behind comments; empty at its end.
    fn word(&mut self) -> &'a [u8] {
        loop {
            let word = self.cursor.word();
            if word.first() == Some(&b'#') {
                let place = Place::Line(self.cursor.line());
                self.warnings.note("comment", place, || {
                    "comments are no part of the format; passed over".to_owned()
                });
            } else if !word.is_empty() || self.cursor.at_end() {
                return word;
            }
            self.cursor.next_line();
        }
    }

    /// A keyword whose `end` stands apart, in one word.
    fn split_keyword(&mut self) -> Vec<u8> {
        let place = Place::Line(self.cursor.line());
        let mut ahead = self.cursor;
        let second = ahead.word().to_ascii_lowercase();
        if !matches!(second.as_slice(), b"loop" | b"facet" | b"solid") {
            return b"end".to_vec();
        }
        self.cursor = ahead;
        let word = [b"end", second.as_slice()].concat();
        self.warnings.note("split", place, || {
            let second = String::from_utf8_lossy(&second);
            format!("`end {second}` is taken for `end{second}`")
        });
        word
    }

    /// Warns if a keyword stands where another is due that is missing.
    fn demand(&mut self, keyword: &str, stages: &[Stage]) {
        if stages.contains(&self.stage) {
            return;
        }
        let due = due(self.stage);
        let place = Place::Line(self.cursor.line());
        self.warnings
            .note("missing", place, || format!("`{keyword}` where {due} is due; taken as missing"));
    }

    fn begin_solid(&mut self) {
        self.demand("solid", &[Stage::Outside]);
        self.finish_loop();
        let name = self.name_before(&[b"facet", b"normal"]);
        self.solids.push((name, self.soup.len() as u32));
        self.stage = Stage::Solid;
    }

    /// What follows `facet`: `normal` and three numbers, which are passed over, whatever they are.
    fn begin_facet(&mut self) {
        self.demand("facet", &[Stage::Solid]);
        self.finish_loop();
        if self.stage == Stage::Outside {
            self.solids.push((String::new(), self.soup.len() as u32));
        }
        self.stage = Stage::Facet;
        let keywords: [&[u8]; 4] = [b"outer", b"loop", b"vertex", b"endfacet"];
        for _ in 0..4 {
            let start = self.cursor;
            let word = self.word();
            if word.is_empty() || keywords.iter().any(|keyword| word.eq_ignore_ascii_case(keyword))
            {
                self.cursor = start;
                return;
            }
        }
    }

    fn begin_loop(&mut self, word: &[u8]) {
        self.demand("outer loop", &[Stage::Facet]);
        self.finish_loop();
        self.stage = Stage::Loop;
        if word == b"outer" {
            let mut ahead = self.cursor;
            if ahead.word().eq_ignore_ascii_case(b"loop") {
                self.cursor = ahead;
            }
        }
    }

    /// The coordinates of a corner; false if the file ends before they do.
    fn vertex(&mut self) -> Result<bool, Error> {
        let mut corner = [0.0; 3];
        for (k, coordinate) in corner.iter_mut().enumerate() {
            let value = match self.offset {
                None => self.cursor.float(),
                Some(offset) => self.cursor.double().map(|value| (value - offset[k]) as f32),
            };
            let Some(value) = value else {
                let word = self.word();
                if word.is_empty() {
                    return Ok(false);
                }
                let seen = show(word);
                return Err(self.error(format!("{seen}, a coordinate is required")));
            };
            *coordinate = value;
        }
        if self.cursor.take_ill_formed() {
            self.warnings.note("number", Place::Line(self.cursor.line()), || {
                "ill-formed number; only its beginning counts".to_owned()
            });
        }
        self.corners.push(corner);
        Ok(true)
    }

    /// Makes triangles of the open loop, if there is one.
    fn finish_loop(&mut self) {
        let place = Place::Line(self.cursor.line());
        let corners = std::mem::take(&mut self.corners);
        match *corners.as_slice() {
            [a, b, c] => self.soup.push([a, b, c]),
            [_, _, _, ..] => {
                let count = corners.len();
                self.warnings.note("polygon", place, || {
                    format!(
                        "a facet with {count} corners, three are required; it is cut into triangles"
                    )
                });
                let outline: Vec<u32> = (0..count as u32).collect();
                let mut cut = Vec::new();
                triangulate(&corners, &outline, &mut cut);
                self.soup.extend(cut.iter().map(|t| t.map(|k| corners[k as usize])));
            }
            _ if self.stage == Stage::Loop => {
                let count = corners.len();
                self.warnings.note("few corners", place, || {
                    format!("a facet with {count} corners, three are required; it is left out")
                });
            }
            _ => {}
        }
    }

    /// Ends the file: a facet that is not whole is left out.
    fn finish_file(&mut self) -> Result<(), Error> {
        let place = Place::Line(self.cursor.line());
        match self.stage {
            Stage::Outside => {}
            Stage::Solid => {
                self.warnings.note("", place, || "the file ends without `endsolid`".to_owned())
            }
            Stage::Facet | Stage::Loop | Stage::AfterLoop => {
                // A facet without its end may lack digits of its last number.
                self.corners.clear();
                if self.soup.is_empty() {
                    return Err(
                        self.error(format!("the file ends here, {} is required", due(self.stage)))
                    );
                }
                let whole = self.stage == Stage::AfterLoop;
                let fate = if whole { "" } else { "; it is left out" };
                self.warnings
                    .note("", place, || format!("the file ends within its last facet{fate}"));
            }
        }
        if self.solids.is_empty() {
            return Err(self.error("the file ends here, `solid` is required"));
        }
        Ok(())
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

    fn error(&self, what: impl Into<String>) -> Error {
        Error::malformed(self.file, Place::Line(self.cursor.line()), what)
    }

    fn unexpected(&self, word: &[u8]) -> Error {
        self.error(format!("{}, {} is required", show(word), due(self.stage)))
    }
}

/// What the grammar demands at a stage.
fn due(stage: Stage) -> &'static str {
    match stage {
        Stage::Outside => "`solid`",
        Stage::Solid => "`facet` or `endsolid`",
        Stage::Facet => "`outer loop`",
        Stage::Loop => "`vertex` or `endloop`",
        Stage::AfterLoop => "`endfacet`",
    }
}

fn show(word: &[u8]) -> String {
    format!("`{}`", String::from_utf8_lossy(&word[..word.len().min(40)]))
}
