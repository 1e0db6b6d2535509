//! Binary STL: an 80-byte header, a 32-bit count `n` and `n` records of 50 bytes: normal, three
//! corners (12 little-endian `f32`), 16 attribute bits.
//!
//! The count is wrong in many files: programs that write into a pipe cannot go back to fill it in.
//! Where it does not fit, the size decides, and all coordinates must be finite, or the data are no
//! STL at all. Some files have as many bytes behind each record as its attribute says; these are
//! skipped, if the file ends with the last of them.
//!
//! The attribute bits are colours in two ways. Magics writes `COLOR=` and the colour of the object,
//! four bytes, into the header; a facet whose bit 15 is clear has a colour of its own, five bits
//! each of red, green and blue, red lowest. VisCAM and SolidView have no mark in the header; a
//! facet whose bit 15 is set has a colour, blue lowest. Colours are sRGB.

use super::check_count;
use crate::file_name::stem;
use crate::format::stl_size::{HEADER, RECORD, claimed};
use crate::mesh_scene::with_mesh;
use crate::warnings::Warnings;
use crate::weld::weld;
use crate::{Error, Place};
use vitral_exec::Workers;
use vitral_math::color::linear_from_srgb;
use vitral_scene::{Attribute, Mesh, Part, Scene};

/// Set in the attribute of a facet with a colour (VisCAM), clear there (Magics).
const FLAG: u16 = 1 << 15;

pub(super) fn read(bytes: &[u8], file: &str, workers: &Workers) -> Result<Scene, Error> {
    let mut warnings = Warnings::default();
    let records = Records::find(bytes, file, &mut warnings)?;
    check_count(records.count, file)?;

    // Weld the corners, and take the attribute bits for colours where they are.
    let (positions, triangles) = weld(records.count, |t| records.corners(t), workers);
    let colors = facet_colors(bytes, &records, &mut warnings);
    let colors = colors.map(|values| Attribute {
        corners: Some((0..values.len() as u32).map(|t| [t; 3]).collect()),
        values,
    });
    let parts =
        vec![Part { name: String::new(), triangles: 0..triangles.len() as u32, material: None }];
    let colors_from_srgb = colors.is_some();
    let mesh = Mesh {
        name: stem(file),
        positions,
        triangles,
        parts,
        colors,
        colors_from_srgb,
        ..Mesh::default()
    };
    Ok(with_mesh(Scene { warnings: warnings.into_messages(file), ..Scene::default() }, mesh, file))
}

/// Where the records of a file lie.
struct Records<'a> {
    bytes: &'a [u8],
    count: usize,
    /// The byte at which each begins, where bytes between them are skipped; otherwise they follow
    /// each other.
    starts: Option<Vec<usize>>,
}

impl<'a> Records<'a> {
    /// Finds the records by the count of the header and the size of the file.
    fn find(bytes: &'a [u8], file: &str, warnings: &mut Warnings) -> Result<Self, Error> {
        let size = bytes.len();
        let Some(announced) = claimed(bytes).map(|count| count as usize) else {
            let what = format!("the file ends here: a binary STL file has at least {HEADER} bytes");
            return Err(Error::malformed(file, Place::Byte(size as u64), what));
        };
        let (room, rest) = ((size - HEADER) / RECORD, (size - HEADER) % RECORD);
        let in_a_row = |count| Self { bytes, count, starts: None };
        if room == announced && rest == 0 {
            return Ok(in_a_row(announced));
        }

        // Take records with bytes behind them, if these lead to the very end of the file.
        if let Some(starts) = starts_over_attributes(bytes, announced) {
            warnings.note("", Place::File, || {
                "attribute bytes behind the facets are skipped".to_owned()
            });
            return Ok(Self { bytes, count: announced, starts: Some(starts) });
        }

        // Take the announced records, if there are as many and more follows.
        if announced > 0 && announced < room && rest != 0 || announced > 0 && announced == room {
            let end = HEADER + RECORD * announced;
            let what = || format!("{} bytes after the last triangle are left out", size - end);
            warnings.note("", Place::Byte(end as u64), what);
            return Ok(in_a_row(announced));
        }
        if announced > room && (rest != 0 || room == 0) {
            let what = format!(
                "the file ends here: {announced} triangles are announced, {room} are there"
            );
            return Err(Error::malformed(file, Place::Byte(size as u64), what));
        }

        // Let the size decide, if what is there makes sense.
        let records = in_a_row(room);
        if let Some(bad) =
            (0..room).find(|&t| records.corners(t).as_flattened().iter().any(|c| !c.is_finite()))
        {
            let what = format!(
                "{announced} triangles are announced, the file has room for {room}, and here is no triangle of numbers"
            );
            return Err(Error::malformed(file, Place::Byte((HEADER + RECORD * bad) as u64), what));
        }
        let what = || {
            format!(
                "{announced} triangles are announced, the {room} are read that the file has room for"
            )
        };
        warnings.note("", Place::Byte(HEADER as u64 - 4), what);
        if rest != 0 {
            let end = HEADER + RECORD * room;
            let what = || format!("{rest} bytes after the last triangle are left out");
            warnings.note("", Place::Byte(end as u64), what);
        }
        Ok(records)
    }

    fn record(&self, t: usize) -> &[u8; RECORD] {
        let start = self.starts.as_ref().map_or(HEADER + RECORD * t, |starts| starts[t]);
        // Every record was found within the file.
        self.bytes[start..].first_chunk().unwrap_or(&[0; RECORD])
    }

    fn corners(&self, t: usize) -> [[f32; 3]; 3] {
        let (numbers, _) = self.record(t)[12..48].as_chunks::<12>();
        [0, 1, 2].map(|k| {
            let (words, _) = numbers[k].as_chunks::<4>();
            [0, 1, 2].map(|axis| f32::from_le_bytes(words[axis]))
        })
    }

    fn attribute(&self, t: usize) -> u16 {
        let record = self.record(t);
        u16::from_le_bytes([record[48], record[49]])
    }
}

/// Where `count` records begin, each followed by as many bytes as its attribute says; `None` unless
/// the last of them ends the file.
fn starts_over_attributes(bytes: &[u8], count: usize) -> Option<Vec<usize>> {
    let mut starts = Vec::new();
    let mut at = HEADER;
    for _ in 0..count {
        starts.push(at);
        let length = bytes.get(at + RECORD - 2..at + RECORD)?;
        at += RECORD + usize::from(u16::from_le_bytes([length[0], length[1]]));
    }
    (count > 0 && at == bytes.len()).then_some(starts)
}

/// The colours of all facets, linear; `None` if the file has none.
fn facet_colors(bytes: &[u8], records: &Records, warnings: &mut Warnings) -> Option<Vec<[f32; 4]>> {
    let object = object_color(&bytes[..HEADER - 4]);
    let has_bits =
        records.starts.is_none() && (0..records.count).any(|t| records.attribute(t) != 0);
    if !has_bits {
        return object.map(|color| vec![color; records.count]);
    }

    // Magics, by its mark.
    if let Some(object) = object {
        let color = |bits: u16| {
            if bits & FLAG == 0 { five_bits([bits, bits >> 5, bits >> 10]) } else { object }
        };
        return Some((0..records.count).map(|t| color(records.attribute(t))).collect());
    }

    // VisCAM, if any facet is marked; facets without a colour are white.
    if !(0..records.count).any(|t| records.attribute(t) & FLAG != 0) {
        warnings.note("", Place::File, || {
            "attribute bits of the facets are no colours; they are not used".to_owned()
        });
        return None;
    }
    let color = |bits: u16| {
        if bits & FLAG != 0 { five_bits([bits >> 10, bits >> 5, bits]) } else { [1.0; 4] }
    };
    Some((0..records.count).map(|t| color(records.attribute(t))).collect())
}

/// The colour behind `COLOR=` in a header. Its alpha does not count: programs disagree about which
/// end is opaque.
fn object_color(header: &[u8]) -> Option<[f32; 4]> {
    const MARK: &[u8] = b"COLOR=";
    let at = header.windows(MARK.len()).position(|window| window == MARK)? + MARK.len();
    let [red, green, blue] = *header.get(at..at + 3)?.first_chunk::<3>()?;
    let linear = |c: u8| linear_from_srgb(f32::from(c) / 255.0);
    Some([linear(red), linear(green), linear(blue), 1.0])
}

/// An opaque colour from the lowest five bits each of red, green and blue.
fn five_bits(rgb: [u16; 3]) -> [f32; 4] {
    let [red, green, blue] = rgb.map(|c| linear_from_srgb(f32::from(c & 31) / 31.0));
    [red, green, blue, 1.0]
}
