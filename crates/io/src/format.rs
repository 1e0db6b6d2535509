//! Which format a file has: by its content first, by its extension second.
//!
//! Formats with a magic number are certain. STL has none: a binary one is known by its length, which its triangle count
//! fixes, an ASCII one by its first word. OBJ is known by its first statements, the two kinds of JSON by the keys of their
//! outermost object, OFF without its first word by its counts, where the name does not tell. What nobody claims is refused
//! with the list of what is read; formats that are known but not read are named.

pub(crate) mod obj_statement;
pub(crate) mod off_header;
pub(crate) mod stl_size;

use crate::text::{Cursor, to_utf8};
use crate::{Error, Place};

/// A model format that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// glTF 2.0, JSON with buffers beside or inside it.
    Gltf,
    /// glTF 2.0 in one binary file.
    Glb,
    /// Wavefront OBJ with MTL.
    Obj,
    /// Stereolithography, ASCII and binary.
    Stl,
    /// Polygon file format (Stanford), ASCII and binary.
    Ply,
    /// Object file format (Geomview).
    Off,
    /// A scene file of vitral's own.
    SceneJson,
}

impl Format {
    /// Every format that is read.
    pub const ALL: [Self; 7] = [Self::Gltf, Self::Glb, Self::Obj, Self::Stl, Self::Ply, Self::Off, Self::SceneJson];

    /// Its short name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gltf => "glTF",
            Self::Glb => "GLB",
            Self::Obj => "OBJ",
            Self::Stl => "STL",
            Self::Ply => "PLY",
            Self::Off => "OFF",
            Self::SceneJson => "scene JSON",
        }
    }

    /// Its usual file extensions, lower case, without the dot.
    pub fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::Gltf => &["gltf"],
            Self::Glb => &["glb"],
            Self::Obj => &["obj"],
            Self::Stl => &["stl"],
            Self::Ply => &["ply"],
            Self::Off => &["off"],
            Self::SceneJson => &["json"],
        }
    }

    /// One line for the user.
    pub fn description(self) -> &'static str {
        match self {
            Self::Gltf => "glTF 2.0, JSON with embedded or separate buffers and textures",
            Self::Glb => "glTF 2.0, one binary file",
            Self::Obj => "Wavefront OBJ with MTL materials and textures",
            Self::Stl => "Stereolithography, ASCII and binary",
            Self::Ply => "Polygon file format, ASCII and binary of both byte orders",
            Self::Off => "Object file format, ASCII, with colours and normals",
            Self::SceneJson => "vitral's own scenes: models, lights, cameras, materials",
        }
    }

    /// The feature of this crate that reads it; `None`: always read.
    pub fn feature(self) -> Option<&'static str> {
        match self {
            Self::Gltf | Self::Glb => Some("gltf"),
            Self::Obj => Some("obj"),
            Self::Stl => Some("stl"),
            Self::Ply => Some("ply"),
            Self::Off => Some("off"),
            Self::SceneJson => None,
        }
    }

    /// Whether this build reads it.
    pub fn is_read(self) -> bool {
        match self {
            Self::Gltf | Self::Glb => cfg!(feature = "gltf"),
            Self::Obj => cfg!(feature = "obj"),
            Self::Stl => cfg!(feature = "stl"),
            Self::Ply => cfg!(feature = "ply"),
            Self::Off => cfg!(feature = "off"),
            Self::SceneJson => true,
        }
    }

    /// Why `file` is refused where this build does not read the format.
    #[cfg(not(all(feature = "gltf", feature = "obj", feature = "stl", feature = "ply", feature = "off")))]
    pub(crate) fn left_out(self, file: &str) -> Error {
        let what = left_out(self.name(), self.feature().unwrap_or_default());
        Error::Unsupported { file: file.to_owned(), what }
    }

    /// The format of `bytes`, which were read from `file`. It may be one that this build leaves out
    /// ([`Self::is_read`]).
    ///
    /// # Errors
    /// [`Error::Malformed`] for an empty file, [`Error::Unsupported`] for a format that is not read or not known.
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
        let extension = extension_of(file);
        match Self::ALL.into_iter().find(|f| f.extensions().contains(&extension.as_str())) {
            Some(format) => Ok(format),
            None => match FOREIGN_EXTENSIONS.iter().find(|(e, _)| *e == extension) {
                Some((_, name)) => Err(not_read(file, name)),
                None if off_header::begins_bare(Cursor::new(&head)) => Ok(Self::Off),
                None => Err(not_read(file, "this format")),
            },
        }
    }
}

/// The message about a format whose feature is switched off.
#[cfg(not(all(
    feature = "gltf",
    feature = "obj",
    feature = "stl",
    feature = "ply",
    feature = "off",
    feature = "images"
)))]
pub(crate) fn left_out(name: &str, feature: &str) -> String {
    format!("{name} is left out of this build; the feature `{feature}` of the crate brings it")
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
    let list: Vec<String> = Format::ALL
        .iter()
        .filter(|f| f.is_read())
        .map(|f| format!("{} (.{})", f.name(), f.extensions().join(", .")))
        .collect();
    Error::Unsupported { file: file.to_owned(), what: format!("{name} is not read; readable are {}", list.join(", ")) }
}

/// The extension of `file` in lower case, without the dot; empty if there is none.
pub(crate) fn extension_of(file: &str) -> String {
    let name = file.rsplit(['/', '\\']).next().unwrap_or(file);
    name.rsplit_once('.').map_or(String::new(), |(_, extension)| extension.to_ascii_lowercase())
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

/// The kind of JSON file: by the first root key that one kind must have and the other cannot, else by the name. One pass
/// over the text at most.
fn json_format(text: &[u8], file: &str) -> Format {
    let by_name = if extension_of(file) == "gltf" { Format::Gltf } else { Format::SceneJson };
    let (mut depth, mut at) = (0usize, 0);
    while let Some(step) = text[at..].iter().position(|b| matches!(b, b'"' | b'{' | b'[' | b'}' | b']')) {
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
    if word.eq_ignore_ascii_case(b"solid") && !head.contains(&0) {
        return Some(Format::Stl);
    }
    (obj_statement::begins(start) && !head.contains(&0)).then_some(Format::Obj)
}

/// What a format holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FormatKind {
    /// Meshes, materials, lights, cameras.
    Model,
    /// Pixels.
    Picture,
}

/// A row of [`formats`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FormatRow {
    /// Short name.
    pub name: &'static str,
    /// Extensions, lower case, without the dot.
    pub extensions: &'static [&'static str],
    /// One line for the user.
    pub description: &'static str,
    /// What it holds.
    pub kind: FormatKind,
    /// Whether it can be read (pictures: as textures).
    pub read: bool,
    /// Whether it can be written.
    pub write: bool,
}

/// Every format, models first. What this build leaves out can be neither read nor written.
pub fn formats() -> Vec<FormatRow> {
    let model = |f: Format| FormatRow {
        name: f.name(),
        extensions: f.extensions(),
        description: f.description(),
        kind: FormatKind::Model,
        read: f.is_read(),
        write: f == Format::SceneJson,
    };
    let picture = |name, extensions, description, read| FormatRow {
        name,
        extensions,
        description,
        kind: FormatKind::Picture,
        read,
        write: true,
    };
    let coded = cfg!(feature = "images");
    let texture =
        |name, extensions, description| FormatRow { write: false, ..picture(name, extensions, description, coded) };
    let mut rows: Vec<FormatRow> = Format::ALL.into_iter().map(model).collect();
    rows.push(picture("PNG", &["png"], "Portable network graphics, lossless, with transparency", true));
    let jpeg = picture("JPEG", &["jpg", "jpeg"], "JPEG, lossy, without transparency", coded);
    rows.push(FormatRow { write: coded, ..jpeg });
    rows.push(texture("TGA", &["tga"], "Truevision TGA, as textures"));
    rows.push(texture("BMP", &["bmp"], "Windows bitmap, as textures"));
    rows.push(texture("GIF", &["gif"], "GIF, the first picture, as textures"));
    rows.push(texture("WebP", &["webp"], "WebP, the first picture, as textures"));
    rows.push(texture("TIFF", &["tif", "tiff"], "TIFF, the first picture, as textures"));
    rows.push(texture("DDS", &["dds"], "DirectDraw surface, packed by S3TC (DXT1, DXT3, DXT5), as textures"));
    rows.push(picture(
        "PPM",
        &["ppm"],
        "Portable pixmap, plain pixels; no textures, but `vitral compare` reads it",
        false,
    ));
    rows.push(picture("NPY", &["npy"], "numpy array: depth, ids and normals without loss", false));
    rows
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
        let late = format!("{{\"buffers\": [{{\"uri\": \"{}\"}}], \"asset\": {{}}}}", "A".repeat(1 << 17));
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
        for header in
            [&b"solid"[..], b"ply\nformat", b"glTF\x02", b"OFF 1 2", b"v 1 2 3", b"PK\x03\x04", b"\xEF\xBB\xBFply\n"]
        {
            stl[..header.len()].copy_from_slice(header);
            assert_eq!(detect(&stl, "x"), Format::Stl);
        }
        assert_eq!(detect(b"\xEF\xBB\xBFply\nformat", "-"), Format::Ply);
        for text in ["vp 0 1\nv 0 0 0", "# c\ncstype bezier\ndeg 3 \\\n3\nv 1 2 3", "mg 0\nlod 1\nbevel on\ng a\n"] {
            assert_eq!(detect(text.as_bytes(), "-"), Format::Obj, "{text}");
        }
        assert_eq!(detect(b"# c\n3 1 0 # counts\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "-"), Format::Off);
        assert_eq!(detect(b"# nothing but a comment", "dir.ply/X.OBJ"), Format::Obj);
    }

    #[test]
    fn what_is_not_read_is_named() {
        let refuse = |bytes: &[u8], file: &str| Format::detect(bytes, file).unwrap_err().to_string();
        assert_eq!(refuse(b"", "e.x"), "e.x: empty file");
        assert!(
            refuse(b"<?xml?><COLLADA>", "m").starts_with("m: Collada (DAE) is not read; readable are glTF (.gltf), ")
        );
        assert!(refuse(b"PK\x03\x04", "m.3mf").contains("3MF"));
        assert!(refuse(b"\x1f\x8b\x08\0", "m.obj").starts_with("m.obj: a gzip file (unpack it first) is not read; "));
        assert!(refuse(b"?", "m.blend").contains("Blender"));
        for text in ["call\nme\n", "1 2 3\n", "1 2 3\n4 5 six\n", "1 2 3 4\n5 6 7\n"] {
            assert!(refuse(text.as_bytes(), "-").contains("this format is not read"), "{text}");
        }
        assert!(refuse(b"hello", "m.txt").starts_with("m.txt: this format is not read"));
    }

    #[test]
    fn all_textures_that_are_read_are_listed() {
        let read = formats().into_iter().filter(|r| r.kind == FormatKind::Picture && r.read);
        let names: Vec<&str> = read.map(|r| r.name).collect();
        assert_eq!(names, ["PNG", "JPEG", "TGA", "BMP", "GIF", "WebP", "TIFF", "DDS"]);
    }

    #[test]
    fn the_table_names_every_extension_once() {
        let mut extensions: Vec<&str> = formats().iter().flat_map(|r| r.extensions.iter().copied()).collect();
        let count = extensions.len();
        extensions.sort_unstable();
        extensions.dedup();
        assert_eq!(extensions.len(), count);
    }
}
