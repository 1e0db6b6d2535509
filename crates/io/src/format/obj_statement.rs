//! The statements of OBJ files, by which they are known.

use crate::text::Cursor;

/// What a line begins with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Statement {
    Position,
    Texture,
    Normal,
    Face,
    Line,
    Points,
    Group,
    Object,
    Smoothing,
    Material,
    Library,
    FreeForm,
    Unused,
    Unknown,
}

impl Statement {
    pub(crate) fn of(word: &[u8]) -> Self {
        match word {
            b"v" => Self::Position,
            b"vt" => Self::Texture,
            b"vn" => Self::Normal,
            b"f" | b"fo" => Self::Face,
            b"l" => Self::Line,
            b"p" => Self::Points,
            b"g" => Self::Group,
            b"o" => Self::Object,
            b"s" => Self::Smoothing,
            b"usemtl" => Self::Material,
            b"mtllib" => Self::Library,
            b"vp" | b"deg" | b"bmat" | b"step" | b"cstype" | b"curv" | b"curv2" | b"surf"
            | b"parm" | b"trim" | b"hole" | b"scrv" | b"sp" | b"end" | b"con" | b"cdc" | b"cdp"
            | b"bzp" | b"bsp" | b"res" => Self::FreeForm,
            b"mg" | b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"usemap" | b"maplib"
            | b"shadow_obj" | b"trace_obj" | b"ctech" | b"stech" | b"call" | b"csh" => Self::Unused,
            _ => Self::Unknown,
        }
    }
}

/// Whether the text reads like an OBJ file: a usual statement, behind nothing but seldom ones.
/// Words as `end` or `call` alone could begin anything.
pub(crate) fn begins(mut cursor: Cursor) -> bool {
    while cursor.next_content() {
        match Statement::of(cursor.word()) {
            Statement::Unknown => return false,
            Statement::Unused | Statement::FreeForm => cursor.next_line(),
            _ => return true,
        }
    }
    false
}
