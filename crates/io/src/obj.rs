//! Wavefront OBJ: polygons with separate indices for positions, texture coordinates and normals.
//!
//! The text is cut at line ends into pieces of equal size, which are read independently (`chunk`):
//! each gathers the vertices and faces of its lines. Positive indices are absolute; negative ones
//! count back from the vertices read so far, of which a piece only knows its own, so they are kept
//! relative to the piece's beginning. When all pieces are read, their vertex counts give the bases,
//! and the faces are put together and cut into triangles, again piece by piece (`stitch`);
//! materials and textures are read at the same time (`materials`).
//!
//! The file becomes one mesh and one node; each run of faces with one group (or object) and one
//! material is a part.
//!
//! * `v x y z [w]`: `w` is left out. Six or seven numbers: a colour `r g b` follows (sRGB, `0..=1`,
//!   or `0..=255` where they look like bytes: `color_range`); or ZBrush's comments `#MRGB` have
//!   them. `vt u [v [w]]`: `v` runs upwards in the file and becomes `1 - v`.
//! * `f`, `fo`: any number of corners, `v`, `v/vt`, `v//vn`, `v/vt/vn`. Fewer than three corners:
//!   warning, left out. Corners without texture coordinates get `(0, 0)`; corners without a normal,
//!   in a file that has some, the face's.
//! * `l`, `p`: free lines and points, with the material in force. A file of vertices alone is a
//!   point cloud.
//! * `o`, `g`, `s`, `usemtl`, `mtllib`. An unknown material is the default one, with a warning. In
//!   a file without any `usemtl`, everything has the material of its library, if that has a single
//!   one.
//! * A number with something glued to it (`3.1+e2`) counts up to there, with a warning; a word that
//!   is no number is an error that names the line. Faces, lines and points with the index of a
//!   vertex that leads nowhere are left out, with a warning, unless nothing else is there; so are
//!   texture coordinates and normals that lead nowhere.
//! * A model far from the origin keeps its shape: `far`.
//! * Free-form curves and surfaces are left out, with a warning.
//! * `\` at the end of a line joins the next one to it, in every statement but not in comments.
//!
//! In:   UTF-8 or UTF-16 text; names in Latin-1, too. Out: a scene in model space, right-handed,
//!       any orientation of axes.
//! Cost: `O(bytes)`; the memory of the mesh twice, for a moment.
//! Source: \[OBJ\].

mod chunk;
mod materials;
mod stitch;

use crate::far;
use crate::file_name::stem;
use crate::mesh_scene::with_mesh_at;
use crate::text::{cut_at_lines, to_utf8};
use crate::warnings::Warnings;
use crate::{Error, Place, Resolver};
use chunk::Chunk;
use vitral_exec::Workers;
use vitral_scene::Scene;

/// Bytes of a piece: so few that threads end at about the same time, since faces take longer to
/// read than vertices.
const PIECE: usize = 1 << 18;

/// Reads an OBJ file. `resolver` gives its material libraries and textures; missing ones are
/// warnings.
///
/// # Errors
/// [`Error::Malformed`] with the line of an index out of range, if all are, or of a statement that
/// has no number where one is due.
pub fn load(
    bytes: &[u8],
    file: &str,
    resolver: &dyn Resolver,
    workers: &Workers,
) -> Result<Scene, Error> {
    load_in_pieces(bytes, file, resolver, workers, PIECE)
}

fn load_in_pieces(
    bytes: &[u8],
    file: &str,
    resolver: &dyn Resolver,
    workers: &Workers,
    piece: usize,
) -> Result<Scene, Error> {
    let text = to_utf8(bytes);
    let pieces = cut_at_lines(&text, piece);
    let mut chunks = workers.map(pieces.len(), |i| Chunk::read(pieces[i]));

    // Gather what the pieces warn of, and refuse what cannot be read.
    let mut warnings = Warnings::default();
    let (first_lines, error) = gather(&mut chunks, file, &mut warnings);
    let understood = chunks.iter().any(|chunk| chunk.understood);
    if !understood
        && let Some(line) =
            chunks.iter().zip(&first_lines).find_map(|(c, l)| Some(c.first_unknown? + l))
    {
        return Err(Error::malformed(file, Place::Line(line), "no statement of an OBJ file"));
    }

    // Check all indices, and leave out what leads nowhere: attributes first, while each corner is
    // still there to be found in the text.
    if let Some(error) = error {
        return Err(error);
    }
    let mut totals = stitch::Totals::new(&chunks, file)?;
    let text_of = (&pieces[..], &first_lines[..]);
    if stitch::leave_out_bad_attributes(&mut chunks, &totals, text_of, &mut warnings, workers) {
        totals = stitch::Totals::new(&chunks, file)?;
    }
    if stitch::leave_out_bad_elements(
        &mut chunks,
        &totals,
        text_of,
        file,
        (&mut warnings, workers),
    )? {
        totals = stitch::Totals::new(&chunks, file)?;
    }
    let events = materials::Events::new(&chunks, &pieces, &first_lines);

    // Read the positions of a model far away once more.
    let boxes = workers.map(chunks.len(), |i| far::bounds(&chunks[i].positions));
    let bounds = boxes.into_iter().reduce(|[al, ah], [bl, bh]| {
        [std::array::from_fn(|k| al[k].min(bl[k])), std::array::from_fn(|k| ah[k].max(bh[k]))]
    });
    let offset = bounds.and_then(far::offset_of_box);
    if let Some(offset) = offset {
        let jobs = chunks.iter_mut().zip(&pieces).collect();
        workers.for_each(jobs, |(chunk, text)| chunk.read_positions(text, offset));
    }

    // Put the geometry together while the materials are read.
    let (mut mesh, library) = workers.join(
        || stitch::stitch(chunks, &totals, &mut warnings, workers),
        || materials::load(&events, file, resolver, workers),
    );
    events.apply(&mut mesh, &library);
    mesh.name = stem(file);
    let mut scene =
        Scene { materials: library.materials, textures: library.textures, ..Scene::default() };
    scene.warnings = warnings.into_messages(file);
    scene.warnings.extend(library.warnings);
    Ok(with_mesh_at(scene, mesh, offset, file))
}

/// The line before the first one of each piece, and the first error. The warnings of all pieces
/// become one list.
fn gather(chunks: &mut [Chunk], file: &str, warnings: &mut Warnings) -> (Vec<u64>, Option<Error>) {
    let mut first_lines = Vec::with_capacity(chunks.len());
    let (mut lines, mut error) = (0, None);
    for chunk in chunks {
        first_lines.push(lines);
        warnings.append(std::mem::take(&mut chunk.warnings), lines);
        if let Some((line, what)) = chunk.error.take() {
            error = error.or(Some(Error::malformed(file, Place::Line(line + lines), what)));
        }
        lines += chunk.line_count;
    }
    (first_lines, error)
}

#[cfg(test)]
mod tests;
