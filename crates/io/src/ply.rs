//! PLY, the polygon file format from Stanford: a header that describes the elements, then their
//! data.
//!
//! The header (`header`) lists elements (`vertex`, `face`, …), each with a count and properties:
//! scalars of eight types, or lists of them. The data are text, one line an element (`ascii`), or
//! binary in either byte order (`binary`). Text whose values run over line ends is read, too. Both
//! hand each element to `Content` as a `Row`: a fixed set of slots for what vitral understands, and
//! the list of corners. Binary data of the usual layouts go past the rows, block by block on all
//! threads.
//!
//! * `vertex`: `x y z`, `nx ny nz`, `red green blue [alpha]` (sRGB; bytes in integers of 32 bits,
//!   others up to their type's largest value; 16 bits hold bytes if none exceeds 255; floats
//!   `0..=1`, or `0..=255` where they look like bytes: `color_range`), `s t`, `u v`,
//!   `texture_u texture_v` (upwards, turned to `1 - v`).
//! * `face`: `vertex_indices` or `vertex_index`; its colours count where vertices have none. Fewer
//!   than three corners: warning, left out.
//! * Textures as MeshLab writes them: `comment TextureFile NAME` in the header names images in
//!   order; a face has `texcoord`, a list of `u v` for each corner, and `texnumber`, the image's
//!   number (0 if not given). Files with texture coordinates of vertices show the first image.
//! * `tristrips`: `vertex_indices`, restarted by a negative index; triangles with two equal corners
//!   only steer the strip and are left out. `edge`: `vertex1 vertex2`, free lines.
//! * Faces and strips without that list, and edges without both ends, are left out with a warning.
//!   Elements without properties have no data, however many are announced.
//! * Without faces, strips and edges the vertices are a point cloud. Other elements and properties
//!   are passed over; a warning names them.
//!
//! In:   bytes. Out: one mesh in model space.
//! Cost: `O(bytes)`; counts in the header allocate nothing that the file could not hold.
//! Source: \[PLY\].

mod ascii;
mod binary;
mod content;
mod header;
mod layout;
mod textured;

use crate::mesh_scene::with_mesh_at;
use crate::warnings::Warnings;
use crate::{Error, Place, Resolver};
use content::{Content, Reading};
use header::{Encoding, Header};
use layout::{Layout, Role, Target};
use vitral_exec::Workers;
use vitral_scene::Scene;

/// Reads a PLY file of any of the three encodings. `resolver` gives its textures; missing ones are
/// warnings.
///
/// # Errors
/// [`Error::Malformed`] with the line (header, text) or byte (binary data) at which the file breaks
/// its announcements.
pub fn load(
    bytes: &[u8],
    file: &str,
    resolver: &dyn Resolver,
    workers: &Workers,
) -> Result<Scene, Error> {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let mut warnings = Warnings::default();
    let header = Header::parse(bytes, file, &mut warnings)?;
    let layouts: Vec<Layout> = header.elements.iter().map(Layout::new).collect();
    note_unused(&header, &layouts, &mut warnings);
    let mut content = Content::new(&header, &layouts, file)?;
    let mut reading = Reading { header: &header, layouts: &layouts, file, warnings: &mut warnings };
    match header.encoding {
        Encoding::Ascii => content = ascii::read(bytes, &mut reading)?,
        Encoding::LittleEndian | Encoding::BigEndian => {
            binary::read(bytes, &mut reading, &mut content, workers)?
        }
    }
    content.decode_colors(&mut warnings, workers);
    let runs = content.texture_runs();
    let offset = content.offset;
    let mut mesh = content.into_mesh(file, workers)?;
    let mut scene = Scene { warnings: warnings.into_messages(file), ..Scene::default() };
    textured::add(&mut mesh, &mut scene, &runs, &header.textures, file, resolver, workers);
    Ok(with_mesh_at(scene, mesh, offset, file))
}

/// Warns of elements and properties that are passed over.
fn note_unused(header: &Header, layouts: &[Layout], warnings: &mut Warnings) {
    for (element, layout) in header.elements.iter().zip(layouts) {
        let place = Place::Line(element.line);
        if layout.role == Role::Unknown {
            warnings.note("", place, || format!("element `{}` is not used", element.name));
            continue;
        }
        if layout.role == Role::Incomplete {
            let needed = if element.name == "edge" {
                "`vertex1` and `vertex2`"
            } else {
                "a list `vertex_indices`"
            };
            warnings.note("", place, || format!("`{}` without {needed} is left out", element.name));
            continue;
        }
        let named = element.properties.iter().zip(&layout.targets);
        let unused: Vec<&str> =
            named.filter(|(_, t)| **t == Target::Nothing).map(|(p, _)| p.name.as_str()).collect();
        if !unused.is_empty() {
            let list = unused.join("`, `");
            warnings.note("", place, || {
                format!("properties of `{}` that are not used: `{list}`", element.name)
            });
        }
    }
}

#[cfg(test)]
mod tests;
