//! Puts the pieces of an OBJ file together: bases for the indices, one array of each kind,
//! triangles.

use super::chunk::{Chunk, FaceList, NONE, unpack};
use crate::color_range::ColorRange;
use crate::triangulate::triangulate;
use crate::warnings::Warnings;
use crate::{Error, Place};
use vitral_exec::Workers;
use vitral_math::color::{linear_from_srgb, linear_from_srgb_table};
use vitral_scene::{Attribute, Corners, Faces, Mesh};

/// How many values of each kind come before a piece.
#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    v: usize,
    vt: usize,
    vn: usize,
    faces: usize,
    corners: usize,
    triangles: usize,
    bare: usize,
}

/// What the pieces hold together.
#[derive(Debug)]
pub(super) struct Totals {
    /// For each piece what comes before it; then the sum of all.
    bases: Vec<Counts>,
    has_colors: bool,
    has_uvs: bool,
    has_normals: bool,
    all_triangles: bool,
    /// Whether texture coordinates and normals take the positions' indices throughout.
    uvs_like_positions: bool,
    normals_like_positions: bool,
}

impl Totals {
    /// Adds the pieces up.
    pub(super) fn new(chunks: &[Chunk], file: &str) -> Result<Self, Error> {
        let mut sum = Counts::default();
        let mut bases = vec![sum];
        for chunk in chunks {
            sum.v += chunk.positions.len();
            sum.vt += chunk.uvs.len();
            sum.vn += chunk.normals.len();
            sum.faces += chunk.faces.count;
            sum.corners += chunk.faces.v.len();
            sum.triangles += chunk.faces.triangles();
            sum.bare += chunk.faces.bare;
            bases.push(sum);
        }
        if [sum.v, sum.vt, sum.vn, sum.corners].iter().any(|&n| n > 1 << 31) {
            return Err(Error::malformed(
                file,
                Place::File,
                "more than 2147483648 vertices or corners",
            ));
        }
        let all = |f: fn(&Chunk) -> bool| chunks.iter().all(f);
        let same_base = |vt: fn(&Counts) -> usize| {
            // Relative indices mean the same only where as many values of both kinds came before.
            let relative = chunks.iter().zip(&bases).filter(|(c, _)| c.has_relative);
            vt(&sum) == sum.v && relative.into_iter().all(|(_, b)| vt(b) == b.v)
        };
        Ok(Self {
            has_colors: !all(|c| c.colors.is_empty()),
            has_uvs: !all(|c| c.faces.vt.is_empty()),
            has_normals: !all(|c| c.faces.vn.is_empty()),
            all_triangles: all(|c| c.faces.sizes.is_empty()),
            uvs_like_positions: all(|c| c.faces.vt_like_v) && same_base(|c| c.vt),
            normals_like_positions: all(|c| c.faces.vn_like_v) && same_base(|c| c.vn),
            bases,
        })
    }

    fn sum(&self) -> Counts {
        self.bases[self.bases.len() - 1]
    }
}

/// Whether an index of a piece before which `base` values were read leads nowhere, of `total` in
/// the file.
fn is_bad(packed: u32, base: usize, total: usize) -> bool {
    packed == NONE || !(0..total as i64).contains(&unpack(packed, base as u32))
}

/// What is wrong with an index that leads nowhere, of `total` things called `what`.
fn nowhere(index: i64, total: usize, what: &str) -> String {
    if index < 0 {
        format!("the index counts back {} {what} beyond the first", -index)
    } else {
        format!("index {}, the file has {total} {what}", index + 1)
    }
}

/// Takes away faces, free lines and free points with a vertex that leads nowhere, with a warning;
/// true if there were any, so that the totals change.
///
/// # Errors
/// The first of them, if no face, line or point of the file stays.
pub(super) fn leave_out_bad_elements(
    chunks: &mut [Chunk],
    totals: &Totals,
    (pieces, first_lines): (&[&[u8]], &[u64]),
    file: &str,
    (warnings, workers): (&mut Warnings, &Workers),
) -> Result<bool, Error> {
    let total = totals.sum().v;
    let first = workers
        .map(chunks.len(), |i| first_bad_vertex(&chunks[i], totals.bases[i].v, total, pieces[i]));
    let Some((line, what)) = first.iter().zip(first_lines).find_map(|(first, before)| {
        let (line, what) = first.as_ref()?;
        Some((line + before, what.clone()))
    }) else {
        return Ok(false);
    };

    // Take away what is bad, piece by piece.
    let jobs: Vec<_> = chunks
        .iter_mut()
        .zip(&totals.bases)
        .zip(&first)
        .filter(|(_, first)| first.is_some())
        .collect();
    let counts = std::sync::Mutex::new([0usize; 3]);
    workers.for_each(jobs, |((chunk, base), _)| {
        let gone = chunk.leave_out(|packed| is_bad(packed, base.v, total));
        let mut counts = counts.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        (0..3).for_each(|kind| counts[kind] += gone[kind]);
    });
    let counts = counts.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);

    // Refuse a file of which nothing is left.
    let place = Place::Line(line);
    let none_left = |c: &Chunk| c.faces.count == 0 && c.lines.is_empty() && c.points.is_empty();
    if chunks.iter().all(none_left) {
        return Err(Error::malformed(file, place, what));
    }
    let kinds = ["face", "line", "point"].iter().zip(counts).filter(|(_, count)| *count > 0);
    let list = kinds
        .map(|(kind, n)| format!("{n} {kind}{}", if n == 1 { "" } else { "s" }))
        .collect::<Vec<_>>();
    let verb = if counts.iter().sum::<usize>() == 1 { "is" } else { "are" };
    warnings.note("", place, || {
        format!("{what}; {} with vertices that are not there {verb} left out", list.join(", "))
    });
    Ok(true)
}

/// The first index of a vertex in a piece that leads nowhere: its line within the piece, and what
/// is wrong with it.
fn first_bad_vertex(
    chunk: &Chunk,
    base: usize,
    total: usize,
    text: &[u8],
) -> Option<(u64, String)> {
    let in_faces = chunk.faces.v.iter().position(|&p| is_bad(p, base, total));
    let in_faces = in_faces.map(|c| (Chunk::line_of_corner(text, c), chunk.faces.v[c]));
    let ends = chunk
        .lines
        .iter()
        .flat_map(|(ends, line)| ends.map(|e| (e, *line)))
        .chain(chunk.points.iter().copied());
    let in_free = ends
        .filter(|(packed, _)| is_bad(*packed, base, total))
        .map(|(packed, line)| (line, packed));
    let (line, packed) = in_faces.into_iter().chain(in_free).min_by_key(|found| found.0)?;
    match &chunk.impossible {
        Some((_, what)) if packed == NONE => Some((line, what.clone())),
        _ => Some((line, nowhere(unpack(packed, base as u32), total, "vertices"))),
    }
}

/// Takes texture coordinates and normals that lead nowhere away from their corners, with a warning;
/// true if there were any, so that the totals change.
pub(super) fn leave_out_bad_attributes(
    chunks: &mut [Chunk],
    totals: &Totals,
    (pieces, first_lines): (&[&[u8]], &[u64]),
    warnings: &mut Warnings,
    workers: &Workers,
) -> bool {
    let sum = totals.sum();

    // Find the first bad corner of each kind in each piece.
    let first = workers.map(chunks.len(), |i| {
        let (faces, base) = (&chunks[i].faces, totals.bases[i]);
        let kinds = [(&faces.vt, base.vt, sum.vt), (&faces.vn, base.vn, sum.vn)];
        kinds.map(|(list, base, total)| {
            list.iter().position(|&p| p != NONE && is_bad(p, base, total))
        })
    });

    // Warn of each bad corner; the place is that of the first one.
    let mut note =
        |i: usize, corner: usize, index: i64, count: usize, total: usize, kind: &'static str| {
            let place = Place::Line(Chunk::line_of_corner(pieces[i], corner) + first_lines[i]);
            let told = || format!("{}; left out", nowhere(index, total, kind));
            (0..count).for_each(|_| warnings.note(kind, place.clone(), told));
        };

    // Take one kind after the other, so that the order of the warnings does not tell the pieces.
    for (i, [corner, _]) in first.iter().enumerate() {
        let (Some(corner), base, faces) = (*corner, totals.bases[i].vt, &mut chunks[i].faces)
        else {
            continue;
        };
        let index = unpack(faces.vt[corner], base as u32);
        let count = faces.leave_out_uvs(|p| is_bad(p, base, sum.vt));
        note(i, corner, index, count, sum.vt, "texture coordinates");
    }
    for (i, [_, corner]) in first.iter().enumerate() {
        let (Some(corner), base, faces) = (*corner, totals.bases[i].vn, &mut chunks[i].faces)
        else {
            continue;
        };
        let index = unpack(faces.vn[corner], base as u32);
        let count = faces.leave_out_normals(|p| is_bad(p, base, sum.vn));
        note(i, corner, index, count, sum.vn, "normals");
    }
    first.iter().flatten().any(Option::is_some)
}

/// The parts of the mesh's arrays that one piece fills.
struct Job<'a> {
    chunk: Chunk,
    base: Counts,
    triangles: &'a mut [Corners],
    uv_corners: Option<&'a mut [Corners]>,
    normal_corners: Option<&'a mut [Corners]>,
    /// Normals of faces that have none, behind the file's own.
    flat_normals: &'a mut [[f32; 3]],
    outline: Option<(&'a mut [u32], &'a mut [u32])>,
}

/// What the faces of all pieces become.
struct FaceArrays {
    triangles: Vec<Corners>,
    faces: Faces,
    uv_corners: Option<Vec<Corners>>,
    normal_corners: Option<Vec<Corners>>,
    /// Normals of faces that have none.
    flat_normals: Vec<[f32; 3]>,
}

/// Makes the mesh. All indices must have been checked.
pub(super) fn stitch(
    mut chunks: Vec<Chunk>,
    totals: &Totals,
    warnings: &mut Warnings,
    workers: &Workers,
) -> Mesh {
    let sum = totals.sum();
    let zbrush = zbrush_colors(&chunks, totals, warnings);
    let colors =
        totals.has_colors.then(|| linear_colors(&mut chunks, totals, warnings, workers)).or(zbrush);
    let positions =
        concatenate(chunks.iter_mut().map(|c| std::mem::take(&mut c.positions)), sum.v, workers);
    let mut uvs =
        concatenate(chunks.iter_mut().map(|c| std::mem::take(&mut c.uvs)), sum.vt, workers);
    let mut normals =
        concatenate(chunks.iter_mut().map(|c| std::mem::take(&mut c.normals)), sum.vn, workers);
    let (lines, points) = free_elements(&chunks, totals);
    let FaceArrays { triangles, faces, uv_corners, normal_corners, flat_normals } =
        fill_faces(chunks, totals, &positions, workers);

    // Faces without texture coordinates take (0, 0).
    if uv_corners.is_some() {
        uvs.push([0.0; 2]);
    }
    normals.extend(flat_normals);

    // A file of vertices alone is a point cloud, whose normals go with its vertices.
    let no_elements = sum.faces == 0 && lines.is_empty() && points.is_empty();
    let cloud_normals = no_elements && sum.vn == sum.v && sum.v > 0;
    Mesh {
        triangles,
        faces,
        uvs: if totals.has_uvs {
            vec![Attribute { values: uvs, corners: uv_corners }]
        } else {
            Vec::new()
        },
        normals: (totals.has_normals || cloud_normals)
            .then_some(Attribute { values: normals, corners: normal_corners }),
        colors_from_srgb: colors.is_some(),
        colors: colors.map(Attribute::per_vertex),
        lines,
        points: if no_elements { (0..sum.v as u32).collect() } else { points },
        positions,
        ..Mesh::default()
    }
}

/// The free lines and points of all pieces.
fn free_elements(chunks: &[Chunk], totals: &Totals) -> (Vec<[u32; 2]>, Vec<u32>) {
    let (mut lines, mut points) = (Vec::new(), Vec::new());
    for (chunk, base) in chunks.iter().zip(&totals.bases) {
        let vertex = |packed: u32| unpack(packed, base.v as u32) as u32;
        lines.extend(chunk.lines.iter().map(|(ends, _)| ends.map(vertex)));
        points.extend(chunk.points.iter().map(|&(p, _)| vertex(p)));
    }
    (lines, points)
}

/// Cuts the faces of all pieces into triangles, each piece into its own part of the arrays.
fn fill_faces(
    chunks: Vec<Chunk>,
    totals: &Totals,
    positions: &[[f32; 3]],
    workers: &Workers,
) -> FaceArrays {
    let sum = totals.sum();

    // Allocate the arrays that the faces need.
    let has_uv_corners = totals.has_uvs && !totals.uvs_like_positions;
    let has_normal_corners = totals.has_normals && !totals.normals_like_positions;
    let is_mixed = !totals.all_triangles;
    let mut triangles = vec![[0u32; 3]; sum.triangles];
    let mut uv_corners = has_uv_corners.then(|| vec![[0u32; 3]; sum.triangles]);
    let mut normal_corners = has_normal_corners.then(|| vec![[0u32; 3]; sum.triangles]);
    let mut starts = if is_mixed { vec![0u32; sum.faces + 1] } else { Vec::new() };
    let mut corners = if is_mixed { vec![0u32; sum.corners] } else { Vec::new() };
    let mut flat_normals = vec![[0.0f32; 3]; if has_normal_corners { sum.bare } else { 0 }];

    // Deal the arrays to the pieces, and let each fill its own part.
    {
        let mut triangles = triangles.as_mut_slice();
        let mut uv_corners = uv_corners.as_deref_mut();
        let mut normal_corners = normal_corners.as_deref_mut();
        let mut flat_normals = flat_normals.as_mut_slice();
        let mut outline = is_mixed.then(|| (&mut starts[1..], corners.as_mut_slice()));
        let jobs = chunks.into_iter().zip(&totals.bases).map(|(chunk, &base)| {
            let count = chunk.faces.triangles();
            let bare = if has_normal_corners { chunk.faces.bare } else { 0 };
            Job {
                triangles: front(&mut triangles, count),
                uv_corners: uv_corners.as_mut().map(|c| front(c, count)),
                normal_corners: normal_corners.as_mut().map(|c| front(c, count)),
                flat_normals: front(&mut flat_normals, bare),
                outline: outline
                    .as_mut()
                    .map(|(s, c)| (front(s, chunk.faces.count), front(c, chunk.faces.v.len()))),
                chunk,
                base,
            }
        });
        workers.for_each(jobs.collect(), |job| job.fill(positions, sum));
    }
    let faces = if is_mixed { Faces::Polygons { starts, corners } } else { Faces::Triangles };
    FaceArrays { triangles, faces, uv_corners, normal_corners, flat_normals }
}

/// Takes the first `count` elements off a slice.
fn front<'a, T>(slice: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    let (front, rest) = std::mem::take(slice).split_at_mut(count);
    *slice = rest;
    front
}

/// One array from many; each is given back to the allocator as soon as it is copied.
fn concatenate<T: Copy + Default + Send>(
    parts: impl Iterator<Item = Vec<T>>,
    total: usize,
    workers: &Workers,
) -> Vec<T>
where
    Vec<T>: Send,
{
    let parts: Vec<Vec<T>> = parts.collect();
    if parts.len() == 1 {
        return parts.into_iter().next().unwrap_or_default();
    }
    let mut whole = vec![T::default(); total];
    let mut rest = whole.as_mut_slice();
    let jobs: Vec<_> = parts.into_iter().map(|part| (front(&mut rest, part.len()), part)).collect();
    workers.for_each(jobs, |(slice, part)| slice.copy_from_slice(&part));
    whole
}

/// Vertex colours as linear RGBA; vertices without a colour are white.
fn linear_colors(
    chunks: &mut [Chunk],
    totals: &Totals,
    warnings: &mut Warnings,
    workers: &Workers,
) -> Vec<[f32; 4]> {
    let of_chunks = workers
        .map(chunks.len(), |i| ColorRange::of(chunks[i].colors.as_flattened().iter().copied()));
    let range = of_chunks.into_iter().fold(ColorRange::default(), ColorRange::union);
    let scale = range.scale();
    if let Some(what) = range.oddity("vertex colours") {
        warnings.note("", Place::File, || what);
    }
    let mut colors = vec![[1.0f32; 4]; totals.sum().v];
    let mut rest = colors.as_mut_slice();
    let jobs: Vec<_> = chunks
        .iter_mut()
        .map(|c| (front(&mut rest, c.positions.len()), std::mem::take(&mut c.colors)))
        .collect();
    workers.for_each(jobs, |(slice, encoded)| {
        for (out, rgb) in slice.iter_mut().zip(encoded) {
            let [r, g, b] = rgb.map(|c| {
                if c.is_finite() { linear_from_srgb((c / scale).clamp(0.0, 1.0)) } else { 1.0 }
            });
            *out = [r, g, b, 1.0];
        }
    });
    colors
}

/// The vertex colours that ZBrush writes as comments, if there is one for each vertex.
fn zbrush_colors(
    chunks: &[Chunk],
    totals: &Totals,
    warnings: &mut Warnings,
) -> Option<Vec<[f32; 4]>> {
    let count: usize = chunks.iter().map(|c| c.zbrush_colors.len()).sum();
    if count == 0 {
        return None;
    }
    if count != totals.sum().v || totals.has_colors {
        let what =
            || format!("{count} colours (#MRGB) for {} vertices are not used", totals.sum().v);
        warnings.note("", Place::File, what);
        return None;
    }
    let table = linear_from_srgb_table();
    let linear = |rgb: &[u8; 3]| {
        let [r, g, b] = rgb.map(|c| table[usize::from(c)]);
        [r, g, b, 1.0]
    };
    Some(chunks.iter().flat_map(|c| &c.zbrush_colors).map(linear).collect())
}

impl Job<'_> {
    /// Cuts the piece's faces into triangles.
    fn fill(mut self, positions: &[[f32; 3]], sum: Counts) {
        let faces = std::mem::take(&mut self.chunk.faces);
        // The common case: triangles, all with the same attributes.
        if faces.sizes.is_empty() && self.outline.is_none() && self.normal_corners.is_none() {
            self.fill_triangles(&faces, sum);
        } else {
            self.fill_polygons(&faces, positions, sum);
        }
    }

    /// Copies faces that are triangles and have no normals of their own.
    fn fill_triangles(self, faces: &FaceList, sum: Counts) {
        let vertex = |corner: usize| unpack(faces.v[corner], self.base.v as u32) as u32;
        for (t, out) in self.triangles.iter_mut().enumerate() {
            *out = [vertex(3 * t), vertex(3 * t + 1), vertex(3 * t + 2)];
        }
        if let Some(out) = self.uv_corners {
            for (t, out) in out.iter_mut().enumerate() {
                *out = [0, 1, 2].map(|k| texture(&faces.vt, 3 * t + k, self.base.vt, sum.vt));
            }
        }
    }

    /// Cuts faces of any number of corners.
    fn fill_polygons(mut self, faces: &FaceList, positions: &[[f32; 3]], sum: Counts) {
        let vertex = |corner: usize| unpack(faces.v[corner], self.base.v as u32) as u32;
        let (mut corner, mut triangle, mut bare) = (0, 0, 0);
        let (mut polygon, mut cut) = (Vec::new(), Vec::new());
        for f in 0..faces.count {
            let size = faces.sizes.get(f).map_or(3, |&s| s as usize);
            polygon.clear();
            polygon.extend((corner..corner + size).map(vertex));
            if let Some((starts, corners)) = &mut self.outline {
                corners[corner..corner + size].copy_from_slice(&polygon);
                starts[f] = (self.base.corners + corner + size) as u32;
            }
            cut.clear();
            triangulate(positions, &polygon, &mut cut);

            // A face with a corner that has no normal gets one of its own.
            let flat = self.normal_corners.is_some()
                && (faces.vn.is_empty() || faces.vn[corner..corner + size].contains(&NONE));
            if flat {
                self.flat_normals[bare] = crate::triangulate::polygon_normal(positions, &polygon);
            }

            // Write the triangles, with the attributes of their corners.
            for local in &cut {
                self.triangles[triangle] = local.map(|k| polygon[k as usize]);
                if let Some(out) = &mut self.uv_corners {
                    out[triangle] = local
                        .map(|k| texture(&faces.vt, corner + k as usize, self.base.vt, sum.vt));
                }
                if let Some(out) = &mut self.normal_corners {
                    let own = (sum.vn + self.base.bare + bare) as u32;
                    out[triangle] = local.map(|k| match faces.vn.get(corner + k as usize) {
                        Some(&packed) if packed != NONE => {
                            unpack(packed, self.base.vn as u32) as u32
                        }
                        _ => own,
                    });
                }
                triangle += 1;
            }
            bare += usize::from(flat);
            corner += size;
        }
    }
}

/// The texture coordinate of a corner; `total`, behind the file's own, where it has none.
#[inline(always)]
fn texture(packed: &[u32], corner: usize, base: usize, total: usize) -> u32 {
    match packed.get(corner) {
        Some(&packed) if packed != NONE => unpack(packed, base as u32) as u32,
        _ => total as u32,
    }
}
