//! The data of a text PLY file: one line an element. An element whose line ends too early goes on
//! on the next, with a warning. If the file cannot be read so, it may be wrapped: then all values
//! are one sequence, whatever the lines.

use super::content::{Content, Reading, Row};
use super::header::{Element, Kind, Property, Type};
use super::layout::{Layout, Role};
use crate::far;
use crate::text::{Cursor, is_blank, to_utf8};
use crate::warnings::Warnings;
use crate::{Error, Place};

/// What line ends mean.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Lines {
    /// Each element begins on one.
    Elements,
    /// Nothing: values follow each other.
    Wrapped,
}

/// Reads all elements, those of a model far from the origin once more.
pub(super) fn read(bytes: &[u8], reading: &mut Reading) -> Result<Content, Error> {
    let text = to_utf8(&bytes[reading.header.data..]);
    let before = reading.warnings.clone();
    let content = read_with(&text, reading, None)?;
    match far::offset(&content.positions) {
        None => Ok(content),
        offset => {
            *reading.warnings = before;
            read_with(&text, reading, offset)
        }
    }
}

/// Reads all elements, and takes an offset from each position.
fn read_with(
    text: &[u8],
    reading: &mut Reading,
    offset: Option<[f64; 3]>,
) -> Result<Content, Error> {
    let before = reading.warnings.clone();
    let mut content =
        Content { offset, ..Content::new(reading.header, reading.layouts, reading.file)? };
    let Err(error) = read_elements(text, reading, &mut content, Lines::Elements) else {
        return Ok(content);
    };

    // Read it as wrapped; what is wrong with it is told of the usual form.
    *reading.warnings = before;
    let place = Place::Line(reading.header.data_line);
    reading.warnings.note("", place, || {
        "values run over line ends; they are read one after the other".to_owned()
    });
    let mut content =
        Content { offset, ..Content::new(reading.header, reading.layouts, reading.file)? };
    read_elements(text, reading, &mut content, Lines::Wrapped).map_or(Err(error), |()| Ok(content))
}

fn read_elements(
    text: &[u8],
    reading: &mut Reading,
    content: &mut Content,
    lines: Lines,
) -> Result<(), Error> {
    let mut cursor = Cursor::at_line(text, reading.header.data_line);
    let mut row = Row::default();
    for (element, layout) in reading.header.elements.iter().zip(reading.layouts) {
        // Elements without properties have no data; every other one has a line.
        if element.properties.is_empty() {
            continue;
        }

        // Refuse a count that the file cannot hold: an element takes at least a digit and a line
        // end.
        let room = cursor.remaining() as u64 / 2 + 1;
        if element.count > room {
            let what = format!(
                "{} elements `{}` are announced, the file has {} bytes left",
                element.count,
                element.name,
                cursor.remaining()
            );
            return Err(Error::malformed(reading.file, Place::Line(cursor.line()), what));
        }

        // Read the elements, line by line.
        for n in 0..element.count {
            if !next_row(&mut cursor) {
                let what = format!(
                    "the file ends here: {} elements `{}` are announced, {n} are there",
                    element.count, element.name
                );
                return Err(Error::malformed(reading.file, Place::Line(cursor.line()), what));
            }
            let place = Place::Line(cursor.line());
            let result =
                read_row(&mut cursor, (element, layout), &mut row, lines, reading.warnings)
                    .and_then(|()| {
                        content.push(layout.role, &row, || place.clone(), reading.warnings)
                    });
            if let Err(what) = result {
                return Err(Error::malformed(reading.file, place, what));
            }
            if cursor.take_ill_formed() {
                reading.warnings.note("number", place, || {
                    "ill-formed number; only its beginning counts".to_owned()
                });
            }
            if lines == Lines::Elements {
                cursor.next_line();
            }
        }
    }
    if next_row(&mut cursor) {
        let place = Place::Line(cursor.line());
        if lines == Lines::Wrapped {
            return Err(Error::malformed(reading.file, place, "values follow the last element"));
        }
        reading.warnings.note("", place, || "what follows the last element is left out".to_owned());
    }
    Ok(())
}

/// Goes to the next line that is not blank; false at the end of the file.
fn next_row(cursor: &mut Cursor) -> bool {
    loop {
        cursor.skip_blanks();
        if cursor.at_end() {
            return false;
        }
        if cursor.peek() != b'\n' {
            return true;
        }
        cursor.next_line();
    }
}

/// Reads an element into `row`.
fn read_row(
    cursor: &mut Cursor,
    (element, layout): (&Element, &Layout),
    row: &mut Row,
    lines: Lines,
    warnings: &mut Warnings,
) -> Result<(), String> {
    row.clear();
    let is_wrapped = lines == Lines::Wrapped;

    // Store each property of the element.
    for (property, &target) in element.properties.iter().zip(&layout.targets) {
        match property.kind {
            Kind::Scalar(kind) => {
                if is_wrapped {
                    next_row(cursor);
                }
                let value = next_number(cursor, kind, property, warnings)?;
                row.store(target, value, kind);
            }
            Kind::List { item, .. } => {
                cursor.skip_blanks();
                if is_wrapped {
                    next_row(cursor);
                } else if cursor.peek() == b'\n' {
                    let line = cursor.line();
                    warnings.note("no list", Place::Line(line), || {
                        format!("the line ends before the list `{}`; taken as empty", property.name)
                    });
                    continue;
                }
                // Read the list's length and its items.
                let Some(count @ 0..) = cursor.integer() else {
                    return Err(missing(cursor, &property.name));
                };
                for _ in 0..count {
                    if is_wrapped {
                        next_row(cursor);
                    }
                    let value = next_number(cursor, item, property, warnings)?;
                    row.store_item(target, value)?;
                }
            }
        }
    }

    // Warn of values beyond the last property.
    cursor.skip_blanks();
    if !is_wrapped && cursor.peek() != b'\n' && layout.role != Role::Unknown {
        let line = cursor.line();
        warnings.note("row tail", Place::Line(line), || {
            "more values than the element has; left out".to_owned()
        });
    }
    Ok(())
}

/// A number of the wanted type, on this line or, if it is at its end, on the next.
#[inline]
fn next_number(
    cursor: &mut Cursor,
    kind: Type,
    property: &Property,
    warnings: &mut Warnings,
) -> Result<f64, String> {
    match number(cursor, kind) {
        Some(value) => Ok(value),
        None => number_on_next_line(cursor, kind, property, warnings),
    }
}

#[cold]
fn number_on_next_line(
    cursor: &mut Cursor,
    kind: Type,
    property: &Property,
    warnings: &mut Warnings,
) -> Result<f64, String> {
    cursor.skip_blanks();
    let line = cursor.line();
    if cursor.peek() == b'\n' && next_row(cursor) {
        warnings.note("split", Place::Line(line), || {
            format!("the line ends before `{}`; the element goes on on the next", property.name)
        });
    }
    number(cursor, kind).ok_or_else(|| missing(cursor, &property.name))
}

#[cold]
fn missing(cursor: &mut Cursor, property: &str) -> String {
    match cursor.word() {
        b"" => format!("the file ends before `{property}`"),
        word => {
            let seen = String::from_utf8_lossy(&word[..word.len().min(40)]).into_owned();
            format!("`{seen}` is no number, `{property}` is required")
        }
    }
}

/// A number of the wanted type; integers may be written with a point.
fn number(cursor: &mut Cursor, kind: Type) -> Option<f64> {
    if !kind.is_float() {
        let mut ahead = *cursor;
        let value = ahead.integer();
        if value.is_some() && (is_blank(ahead.peek()) || ahead.peek() == b'\n') {
            *cursor = ahead;
            return value.map(|v| v as f64);
        }
    }
    if kind == Type::F64 { cursor.double() } else { cursor.float().map(f64::from) }
}
