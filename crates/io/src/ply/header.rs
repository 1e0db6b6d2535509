//! The header of a PLY file: lines of text up to `end_header`.

use crate::warnings::Warnings;
use crate::{Error, Place};

/// How the data are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// A scalar type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Type {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Type {
    fn parse(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes of a binary value.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    pub(super) fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }

    /// What a full colour channel of this type is.
    pub(super) fn full_scale(self) -> f64 {
        match self {
            Self::F32 | Self::F64 => 1.0,
            Self::I8 => 127.0,
            Self::I16 => 32767.0,
            Self::U16 => 65535.0,
            // Wider integers hold bytes, as far as known.
            Self::U8 | Self::I32 | Self::U32 => 255.0,
        }
    }

    /// What a full channel is in files that exceed [`Self::full_scale`]: floats that are bytes,
    /// text that takes signed for unsigned types. The same for types that nothing exceeds but a
    /// slip.
    pub(super) fn wide_scale(self) -> f64 {
        match self {
            Self::F32 | Self::F64 | Self::I8 => 255.0,
            Self::I16 => 65535.0,
            Self::U8 | Self::U16 | Self::I32 | Self::U32 => self.full_scale(),
        }
    }
}

/// Scalar or list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Scalar(Type),
    List { count: Type, item: Type },
}

#[derive(Clone, Debug)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: Kind,
}

#[derive(Clone, Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
    /// The header line that announces it.
    pub(super) line: u64,
}

impl Element {
    /// Bytes of one element in a binary file; `None` if it has lists.
    pub(super) fn stride(&self) -> Option<usize> {
        self.properties.iter().try_fold(0, |sum, p| match p.kind {
            Kind::Scalar(t) => Some(sum + t.size()),
            Kind::List { .. } => None,
        })
    }
}

#[derive(Clone, Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Where the data begin.
    pub(super) data: usize,
    /// The line on which they begin, for text.
    pub(super) data_line: u64,
    /// Images that comments name as textures, with their lines.
    pub(super) textures: Vec<(u64, String)>,
}

/// The name in a comment `TextureFile NAME`, as MeshLab writes it.
fn texture_file(line: &str) -> Option<&str> {
    let comment = line.trim_start().strip_prefix("comment")?;
    let (keyword, name) = comment.trim_start().split_once(|c: char| c.is_ascii_whitespace())?;
    let name = name.trim().trim_matches('"');
    (keyword.eq_ignore_ascii_case("TextureFile") && !name.is_empty()).then_some(name)
}

impl Header {
    /// Reads the header.
    pub(super) fn parse(bytes: &[u8], file: &str, warnings: &mut Warnings) -> Result<Self, Error> {
        // Lines end as the first one does.
        let first_end =
            bytes.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(bytes.len());
        let old_mac =
            bytes[first_end..].first() == Some(&b'\r') && bytes.get(first_end + 1) != Some(&b'\n');
        let end = if old_mac { b'\r' } else { b'\n' };

        // Read line after line until `end_header`.
        let (mut encoding, mut elements, mut textures) = (None, Vec::new(), Vec::new());
        let (mut at, mut line) = (0, 0);
        loop {
            line += 1;
            let error = |what: String| Error::malformed(file, Place::Line(line), what);
            if at >= bytes.len() {
                return Err(error("the file ends here, `end_header` is required".to_owned()));
            }

            // Cut the next line into words.
            let length = bytes[at..].iter().position(|&b| b == end).unwrap_or(bytes.len() - at);
            let text = crate::text::name(&bytes[at..at + length]);
            at = (at + length + 1).min(bytes.len());
            let words: Vec<&str> = text.split_ascii_whitespace().collect();

            // Take the line by its first word.
            match words.as_slice() {
                ["ply", ..] if line == 1 => {}
                _ if line == 1 => return Err(error("the first line must be `ply`".to_owned())),
                ["format", name, ..] => encoding = Some(parse_encoding(name).map_err(error)?),
                ["element", name, count, ..] => {
                    let Ok(count) = count.parse() else {
                        return Err(error(format!("`{count}` is not a number of elements")));
                    };
                    elements.push(Element {
                        name: (*name).to_owned(),
                        count,
                        properties: Vec::new(),
                        line,
                    });
                }
                ["property", rest @ ..] => {
                    let property = parse_property(rest).map_err(error)?;
                    let Some(element) = elements.last_mut() else {
                        return Err(error("`property` before any `element`".to_owned()));
                    };
                    element.properties.push(property);
                }
                ["end_header", ..] => break,
                ["comment", ..] => {
                    textures.extend(texture_file(&text).map(|name| (line, name.replace('\\', "/"))))
                }
                ["obj_info", ..] | [] => {}
                _ => warnings.note("ply header", Place::Line(line), || {
                    format!(
                        "header line `{}` is not understood",
                        text.trim().chars().take(40).collect::<String>()
                    )
                }),
            }
        }

        // Check that the encoding is known.
        let Some(encoding) = encoding else {
            return Err(Error::malformed(
                file,
                Place::Line(line),
                "the header has no `format` line",
            ));
        };
        Ok(Self { encoding, elements, data: at, data_line: line + 1, textures })
    }
}

fn parse_encoding(name: &str) -> Result<Encoding, String> {
    match name {
        "ascii" => Ok(Encoding::Ascii),
        "binary_little_endian" => Ok(Encoding::LittleEndian),
        "binary_big_endian" => Ok(Encoding::BigEndian),
        _ => Err(format!(
            "format `{name}`; `ascii`, `binary_little_endian` or `binary_big_endian` is required"
        )),
    }
}

fn parse_property(words: &[&str]) -> Result<Property, String> {
    let scalar = |name: &str| Type::parse(name).ok_or_else(|| format!("unknown type `{name}`"));
    match words {
        ["list", count, item, name, ..] => {
            let kind = Kind::List { count: scalar(count)?, item: scalar(item)? };
            match kind {
                Kind::List { count, .. } if count.is_float() => {
                    Err("the length of a list must be an integer".to_owned())
                }
                _ => Ok(Property { name: (*name).to_owned(), kind }),
            }
        }
        [kind, name, ..] => {
            Ok(Property { name: (*name).to_owned(), kind: Kind::Scalar(scalar(kind)?) })
        }
        _ => Err("`property` needs a type and a name".to_owned()),
    }
}
