//! Which format a file has: by its content first, by its extension second.
//!
//! Formats with a magic number are certain. STL has none: a binary one is known by its length,
//! which its triangle count fixes, an ASCII one by its first word. OBJ is known by its first
//! statements, the two kinds of JSON by the keys of their outermost object, OFF without its first
//! word by its counts, where the name does not tell. What nobody claims is refused with the list of
//! what is read; formats that are known but not read are named.

use crate::file_name::extension;
use crate::format::{obj_statement, off_header, stl_size};
use crate::text::{Cursor, to_utf8};
use crate::{Error, Format, Place};

impl Format {
    /// The format of `bytes`, which were read from `file`. It may be one that this build leaves out
    /// ([`Self::is_read`]).
    ///
    /// # Errors
    /// [`Error::Malformed`] for an empty file, [`Error::Unsupported`] for a format that is not read
    /// or not known.
    pub fn detect(bytes: &[u8], file: &str) -> Result<Self, Error> {
        if bytes.is_empty() {
            return Err(Error::malformed(file, Place::File, "empty file"));
        }
        if let Some(format) = by_magic(bytes) {
            return Ok(format);
        }
        if let Some(name) = foreign_content(bytes) {
            return Err(not_read(file, name));
        }
        let head = to_utf8(&bytes[..bytes.len().min(1 << 16)]);
        if head.trim_ascii_start().first() == Some(&b'{') {
            return Ok(json_format(&to_utf8(bytes), file));
        }
        if let Some(format) = by_text(&head) {
            return Ok(format);
        }

        // The content does not tell: believe the name.
        let extension = extension(file);
        match Self::ALL.into_iter().find(|f| f.extensions().contains(&extension.as_str())) {
            Some(format) => Ok(format),
            None => match FOREIGN_EXTENSIONS.iter().find(|(e, _)| *e == extension) {
                Some((_, name)) => Err(not_read(file, name)),
                None if off_header::begins_bare(Cursor::new(&head)) => Ok(Self::Off),
                None if stl_size::is_unfinished(bytes) => Ok(Self::Stl),
                None => Err(not_read(file, "this format")),
            },
        }
    }
}

/// Formats that are known and not read.
const FOREIGN_EXTENSIONS: [(&str, &str); 26] = [
    ("3dm", "Rhino 3DM"),
    ("3ds", "3D Studio (3DS)"),
    ("3mf", "3MF"),
    ("abc", "Alembic"),
    ("ac", "AC3D"),
    ("ase", "3D Studio ASE"),
    ("blend", "a Blender file"),
    ("dae", "Collada (DAE)"),
    ("dxf", "DXF"),
    ("fbx", "FBX"),
    ("iges", "IGES"),
    ("igs", "IGES"),
    ("lwo", "LightWave (LWO)"),
    ("md5mesh", "MD5"),
    ("mtl", "an MTL file (the materials of an OBJ file)"),
    ("smd", "SMD"),
    ("step", "STEP"),
    ("stp", "STEP"),
    ("usd", "USD"),
    ("usda", "USD"),
    ("usdc", "USD"),
    ("usdz", "USD"),
    ("vtk", "VTK"),
    ("wrl", "VRML"),
    ("x", "DirectX (X)"),
    ("x3d", "X3D"),
];

fn not_read(file: &str, name: &str) -> Error {
    let read = Format::ALL.iter().filter(|format| format.is_read());
    let list: Vec<String> =
        read.map(|f| format!("{} (.{})", f.name(), f.extensions().join(", ."))).collect();
    Error::Unsupported {
        file: file.to_owned(),
        what: format!("{name} is not read; readable are {}", list.join(", ")),
    }
}

fn by_magic(bytes: &[u8]) -> Option<Format> {
    match bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes) {
        // Nothing else has this size by chance, and the header of an STL file may say anything.
        _ if stl_size::is_binary_size(bytes) => Some(Format::Stl),
        [b'g', b'l', b'T', b'F', ..] => Some(Format::Glb),
        [b'p', b'l', b'y', b'\n' | b'\r' | b' ' | b'\t', ..] => Some(Format::Ply),
        _ => None,
    }
}

/// The name of a format that is known by its first bytes and not read.
fn foreign_content(bytes: &[u8]) -> Option<&'static str> {
    const MAGIC: [(&[u8], &str); 18] = [
        (b"\x1f\x8b", "a gzip file (unpack it first)"),
        (b"\x28\xb5\x2f\xfd", "a Zstandard file (unpack it first)"),
        (b"BZh", "a bzip2 file (unpack it first)"),
        (b"\xfd7zXZ", "an xz file (unpack it first)"),
        (b"PK\x03\x04", "a zip container (3MF, USDZ)"),
        (b"Kaydara FBX", "FBX"),
        (b"BLENDER", "a Blender file"),
        (b"xof 0", "DirectX (X)"),
        (b"#VRML", "VRML"),
        (b"#X3D", "X3D"),
        (b"#usda", "USD"),
        (b"PXR-USDC", "USD"),
        (b"ISO-10303", "STEP"),
        (b"# vtk DataFile", "VTK"),
        (b"AC3D", "AC3D"),
        (b"MD5Version", "MD5"),
        (b"*3DSMAX_ASCIIEXPORT", "3D Studio ASE"),
        (b"DRACO", "a bare Draco stream"),
    ];
    if let Some((_, name)) = MAGIC.iter().find(|(magic, _)| bytes.starts_with(magic)) {
        return Some(name);
    }

    // 3DS: the main chunk's length is the file's.
    if let [0x4D, 0x4D, length @ ..] = bytes
        && let Some(length) = length.first_chunk::<4>()
        && u32::from_le_bytes(*length) as usize == bytes.len()
    {
        return Some("3D Studio (3DS)");
    }
    let text = bytes.trim_ascii_start();
    if !text.starts_with(b"<") {
        return None;
    }
    let holds = |word: &[u8]| text[..text.len().min(4096)].windows(word.len()).any(|w| w == word);
    match () {
        () if holds(b"<COLLADA") => Some("Collada (DAE)"),
        () if holds(b"<X3D") => Some("X3D"),
        () => Some("XML"),
    }
}

/// The kind of JSON file: by the first root key that one kind must have and the other cannot, else
/// by the name. One pass over the text at most.
fn json_format(text: &[u8], file: &str) -> Format {
    let by_name = if extension(file) == "gltf" { Format::Gltf } else { Format::SceneJson };
    let (mut depth, mut at) = (0usize, 0);
    while let Some(step) =
        text[at..].iter().position(|b| matches!(b, b'"' | b'{' | b'[' | b'}' | b']'))
    {
        at += step + 1;
        match text[at - 1] {
            b'"' => {
                let Some(length) = string_length(&text[at..]) else { break };
                let (string, rest) = (&text[at..at + length], &text[at + length + 1..]);
                if depth == 1 && rest.trim_ascii_start().first() == Some(&b':') {
                    match string {
                        b"vitral-scene" => return Format::SceneJson,
                        b"asset" => return Format::Gltf,
                        _ => {}
                    }
                }
                at += length + 1;
            }
            b'{' | b'[' => depth += 1,
            _ if depth <= 1 => break,
            _ => depth -= 1,
        }
    }
    by_name
}

/// The bytes of a JSON string before the quote that ends it.
fn string_length(text: &[u8]) -> Option<usize> {
    let mut at = 0;
    loop {
        at += text.get(at..)?.iter().position(|b| matches!(b, b'"' | b'\\'))?;
        if text[at] == b'"' {
            return Some(at);
        }
        at += 2;
    }
}

fn by_text(head: &[u8]) -> Option<Format> {
    let mut cursor = Cursor::new(head);
    if !cursor.next_content() {
        return None;
    }
    let start = cursor;
    let word = cursor.word();
    if off_header::Header::begin(word).is_some() {
        return Some(Format::Off);
    }
    let begins_facet =
        word.eq_ignore_ascii_case(b"facet") && cursor.word().eq_ignore_ascii_case(b"normal");
    if (word.eq_ignore_ascii_case(b"solid") || begins_facet) && !head.contains(&0) {
        return Some(Format::Stl);
    }
    (obj_statement::begins(start) && !head.contains(&0)).then_some(Format::Obj)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_wins_over_the_name() {
        let detect = |bytes: &[u8], file: &str| Format::detect(bytes, file).unwrap();
        assert_eq!(detect(b"ply\nformat", "a.stl"), Format::Ply);
        assert_eq!(detect(b"# c\n\nv 1 2 3", "-"), Format::Obj);
        assert_eq!(detect(b"  SOLID x\n facet", "x.obj"), Format::Stl);
        assert_eq!(detect(b"# c\nCNOFF 1 2 3", "x"), Format::Off);
        assert_eq!(detect(b"glTF\x02\0\0\0", "x"), Format::Glb);
        assert_eq!(detect(b" {\"asset\":{}}", "x"), Format::Gltf);
        assert_eq!(detect(b"{\"nodes\":[]}", "x"), Format::SceneJson);
        let late =
            format!("{{\"buffers\": [{{\"uri\": \"{}\"}}], \"asset\": {{}}}}", "A".repeat(1 << 17));
        assert_eq!(detect(late.as_bytes(), "-"), Format::Gltf);
        for scene in [
            r#"{"nodes": [{"name": "asset"}], "vitral-scene": 1}"#,
            r#"{"nodes": [{"asset": 1}], "x": "asset", "\"": "\\", "vitral-scene": 1, "asset": {}}"#,
            r#"{"vitral-scene": 1, "meshes": ["#,
            r#"{"nodes": "asset\": "#,
            r#"{} "asset": "#,
        ] {
            assert_eq!(detect(scene.as_bytes(), "x"), Format::SceneJson, "{scene}");
        }
        assert_eq!(detect(br#"{"vitral-scene": 1}"#, "x.gltf"), Format::SceneJson);
        assert_eq!(detect(b"{\"nodes\":[]}", "x.gltf"), Format::Gltf);
        let mut stl = vec![b' '; 84 + 50];
        stl[..5].copy_from_slice(b"solid");
        stl[80..84].copy_from_slice(&1u32.to_le_bytes());
        for header in [
            &b"solid"[..],
            b"ply\nformat",
            b"glTF\x02",
            b"OFF 1 2",
            b"v 1 2 3",
            b"PK\x03\x04",
            b"\xEF\xBB\xBFply\n",
        ] {
            stl[..header.len()].copy_from_slice(header);
            assert_eq!(detect(&stl, "x"), Format::Stl);
        }
        assert_eq!(detect(b"\xEF\xBB\xBFply\nformat", "-"), Format::Ply);
        assert_eq!(detect(b"facet normal 0 0 1\nouter loop", "-"), Format::Stl);
        assert_eq!(detect(&vec![0; 84 + 150], "-"), Format::Stl, "written into a pipe");
        for text in [
            "vp 0 1\nv 0 0 0",
            "# c\ncstype bezier\ndeg 3 \\\n3\nv 1 2 3",
            "mg 0\nlod 1\nbevel on\ng a\n",
        ] {
            assert_eq!(detect(text.as_bytes(), "-"), Format::Obj, "{text}");
        }
        assert_eq!(
            detect(b"# c\n3 1 0 # counts\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "-"),
            Format::Off
        );
        assert_eq!(detect(b"# nothing but a comment", "dir.ply/X.OBJ"), Format::Obj);
    }

    #[test]
    fn what_is_not_read_is_named() {
        let refuse =
            |bytes: &[u8], file: &str| Format::detect(bytes, file).unwrap_err().to_string();
        assert_eq!(refuse(b"", "e.x"), "e.x: empty file");
        assert!(
            refuse(b"<?xml?><COLLADA>", "m")
                .starts_with("m: Collada (DAE) is not read; readable are glTF (.gltf), ")
        );
        assert!(refuse(b"PK\x03\x04", "m.3mf").contains("3MF"));
        assert!(
            refuse(b"\x1f\x8b\x08\0", "m.obj")
                .starts_with("m.obj: a gzip file (unpack it first) is not read; ")
        );
        assert!(refuse(b"?", "m.blend").contains("Blender"));
        for text in ["call\nme\n", "1 2 3\n", "1 2 3\n4 5 six\n", "1 2 3 4\n5 6 7\n"] {
            assert!(refuse(text.as_bytes(), "-").contains("this format is not read"), "{text}");
        }
        assert!(refuse(b"hello", "m.txt").starts_with("m.txt: this format is not read"));
    }
}
