//! The state changes of an OBJ file in order, and the materials and textures behind them.

use super::chunk::{Change, Chunk};
use crate::mtl::{self, MtlMaterial};
use crate::resolve::read_first;
use crate::text::{self, without_comment};
use crate::textures::{Alpha, Loaded, Requests};
use crate::warnings::Warnings;
use crate::{Place, Resolver};
use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::Arc;
use vitral_exec::Workers;
use vitral_frame::Texture;
use vitral_light::{AlphaMode, Material};
use vitral_scene::{FreePart, Mesh, Part};

/// A stretch of triangles with one name and one material.
#[derive(Debug)]
struct Run<'a> {
    name: Cow<'a, str>,
    /// Index into `Events::used`; `None` before the first `usemtl`.
    material: Option<usize>,
    first_triangle: u32,
}

/// The changes of all pieces.
#[derive(Debug, Default)]
pub(super) struct Events<'a> {
    runs: Vec<Run<'a>>,
    /// Smoothing group from this face on.
    smoothing: Vec<(u32, u32)>,
    /// `mtllib` lines.
    libraries: Vec<(u64, Cow<'a, str>)>,
    /// Materials in order of their first use, with its line.
    used: Vec<(u64, Cow<'a, str>)>,
    /// The first free line and the first free point with a material (index into `used`).
    free: Vec<([usize; 2], usize)>,
    /// How many lines and points the file names.
    free_count: [usize; 2],
}

impl<'a> Events<'a> {
    /// Walks the changes of all pieces.
    pub(super) fn new(chunks: &[Chunk], pieces: &[&'a [u8]], first_lines: &[u64]) -> Self {
        // Begin with a run that has neither name nor material.
        let mut events = Self::default();
        let mut number: HashMap<&[u8], usize> = HashMap::new();
        let (mut faces, mut triangles, mut free) = (0, 0, [0, 0]);
        let mut name = Cow::Borrowed("");
        let mut material = None;
        events.start_run(name.clone(), material, 0);

        // Follow the changes in the order of the file.
        for ((chunk, &text), first_line) in chunks.iter().zip(pieces).zip(first_lines) {
            for event in &chunk.events {
                let line = event.line + first_line;
                match &event.change {
                    Change::Name(range) => {
                        name = match text::name(&text[range.clone()]) {
                            Cow::Borrowed(name) => Cow::Borrowed(without_comment(name)),
                            Cow::Owned(name) => Cow::Owned(without_comment(&name).to_owned()),
                        }
                    }
                    Change::Material(range) => {
                        let wanted = &text[range.clone()];
                        let chosen = *number.entry(wanted).or_insert_with(|| {
                            events.used.push((line, text::name(wanted)));
                            events.used.len() - 1
                        });
                        material = Some(chosen);
                        let first = [
                            free[0] + event.free_line as usize,
                            free[1] + event.free_point as usize,
                        ];
                        events.free.push((first, chosen));
                    }
                    Change::Smoothing(group) => events.smoothing.push((faces + event.face, *group)),
                    Change::Library(range) => {
                        events.libraries.push((line, text::name(&text[range.clone()])))
                    }
                }

                // Start a run at the triangle where the change stands.
                events.start_run(name.clone(), material, triangles + event.triangle);
            }

            // Count the elements of the piece, which the next one follows.
            faces += chunk.faces.count as u32;
            triangles += chunk.faces.triangles() as u32;
            free = [free[0] + chunk.lines.len(), free[1] + chunk.points.len()];
        }
        events.free_count = free;
        events
    }

    /// Begins a run, unless it goes on with what there is; a run without triangles is overwritten.
    fn start_run(&mut self, name: Cow<'a, str>, material: Option<usize>, first_triangle: u32) {
        if self.runs.last().is_some_and(|r| r.first_triangle == first_triangle) {
            self.runs.pop();
        }
        if self.runs.last().is_none_or(|r| r.name != name || r.material != material) {
            self.runs.push(Run { name, material, first_triangle });
        }
    }

    /// Gives the mesh its parts and smoothing groups.
    pub(super) fn apply(&self, mesh: &mut Mesh, library: &Library) {
        let total = mesh.triangles.len() as u32;
        let index = &library.index;
        let material = |m: Option<usize>| m.map_or(library.single, |m| index[m]);
        let ends = self.runs.iter().skip(1).map(|r| r.first_triangle).chain([total]);
        let parts = self.runs.iter().zip(ends).map(|(run, end)| Part {
            name: run.name.clone().into_owned(),
            triangles: run.first_triangle..end,
            material: material(run.material),
        });
        mesh.parts = parts.filter(|p| !p.triangles.is_empty()).collect();
        let ends = self.free.iter().skip(1).map(|f| f.0).chain([self.free_count]);
        for (&(first, chosen), end) in self.free.iter().zip(ends) {
            FreePart::extend(&mut mesh.line_parts, first[0]..end[0], index[chosen]);
            FreePart::extend(&mut mesh.point_parts, first[1]..end[1], index[chosen]);
        }
        if library.single.is_some() {
            FreePart::extend(&mut mesh.line_parts, 0..self.free_count[0], library.single);
            FreePart::extend(&mut mesh.point_parts, 0..self.free_count[1], library.single);
        }

        // Each group reaches to the next statement.
        if !self.smoothing.is_empty() {
            let mut groups = vec![0; mesh.face_count()];
            let ends = self
                .smoothing
                .iter()
                .skip(1)
                .map(|s| s.0 as usize)
                .chain([groups.len()])
                .collect::<Vec<_>>();
            for (&(first, group), end) in self.smoothing.iter().zip(ends) {
                groups[first as usize..end].fill(group);
            }
            mesh.smoothing_groups = Some(groups);
        }
    }
}

/// What was found for the materials that the file uses.
#[derive(Debug, Default)]
pub(super) struct Library {
    pub(super) materials: Vec<Material>,
    pub(super) textures: Vec<Arc<Texture>>,
    /// For each used material, its index in `materials`.
    pub(super) index: Vec<Option<u32>>,
    /// The material of a file that chooses none and whose library has a single one.
    pub(super) single: Option<u32>,
    pub(super) warnings: Vec<String>,
}

/// The materials of all libraries.
#[derive(Debug, Default)]
struct Known {
    /// With the library that each comes from.
    materials: Vec<(String, MtlMaterial)>,
    /// Numbers by names as they stand, and by those that have a comment behind them, without it.
    whole: HashMap<String, usize>,
    plain: HashMap<String, usize>,
}

impl Known {
    /// Of two materials with one name the first counts.
    fn add(&mut self, library: &str, material: MtlMaterial) {
        let number = self.materials.len();
        let plain = without_comment(&material.name);
        if plain != material.name {
            self.plain.entry(plain.to_owned()).or_insert(number);
        }
        self.whole.entry(material.name.clone()).or_insert(number);
        self.materials.push((library.to_owned(), material));
    }

    /// The number of the material `name`, and its name: as it stands, for a name may hold a `#`,
    /// else without comments.
    fn find<'a>(&self, name: &'a str) -> Option<(&'a str, usize)> {
        let plain = without_comment(name);
        let names =
            [(name, &self.whole), (name, &self.plain), (plain, &self.whole), (plain, &self.plain)];
        names.into_iter().find_map(|(name, numbers)| Some((name, *numbers.get(name)?)))
    }
}

/// Reads the libraries and makes the materials that are used, with their textures. Materials that
/// no face asks for are left in their library.
pub(super) fn load(
    events: &Events,
    file: &str,
    resolver: &dyn Resolver,
    workers: &Workers,
) -> Library {
    let mut library = Library::default();
    let mut warnings = Warnings::default();
    let mut known = Known::default();

    // Parse all libraries.
    for (line, names) in &events.libraries {
        for (name, bytes) in read_libraries(*line, names, resolver, &mut warnings) {
            let mut own = Warnings::default();
            mtl::parse(&bytes, &mut own).into_iter().for_each(|m| known.add(&name, m));
            library.warnings.extend(own.into_messages(&name));
        }
    }

    // Build the materials that faces use, in the order of first use.
    let mut requests = Requests::default();
    let mut built = HashMap::new();
    for (line, name) in &events.used {
        library.index.push(known.find(name).map(|(called, number)| {
            *built.entry(number).or_insert_with(|| {
                let (source, material) = &known.materials[number];
                library.materials.push(Material {
                    name: called.to_owned(),
                    ..material.build(source, &mut requests)
                });
                library.materials.len() as u32 - 1
            })
        }));
        if library.index.last() == Some(&None) {
            warnings.note("material", Place::Line(*line), || {
                format!("unknown material `{name}`; the default one is used")
            });
        }
    }

    // Give a file without `usemap` the only material of its library.
    if events.used.is_empty()
        && let [(source, material)] = known.materials.as_slice()
    {
        library.materials.push(Material {
            name: material.name.clone(),
            ..material.build(source, &mut requests)
        });
        library.single = Some(0);
    }

    // Replace requests by textures; a material does without one that cannot be had.
    let loaded = requests.load(resolver, workers);
    for material in &mut library.materials {
        take_textures(material, &loaded);
    }
    library.textures = loaded.textures;
    library.warnings.splice(0..0, warnings.into_messages(file));
    library.warnings.extend(loaded.warnings);
    library
}

/// Replaces the requests in a material by textures.
fn take_textures(material: &mut Material, loaded: &Loaded) {
    // The alpha of a texture makes holes in a surface that is opaque otherwise.
    if material.alpha_mode == AlphaMode::Opaque
        && let Some(base) = &material.base_texture
    {
        material.alpha_mode = match loaded.alpha[base.texture as usize] {
            Alpha::None => AlphaMode::Opaque,
            Alpha::Hard => AlphaMode::Mask { cutoff: 0.5 },
            Alpha::Soft => AlphaMode::Blend,
        };
    }
    for slot in material.texture_slots_mut() {
        if let Some(texture) = slot {
            match loaded.index[texture.texture as usize] {
                Some(found) => texture.texture = found,
                None => *slot = None,
            }
        }
    }

    // Without its texture the surface has the colour that was given beside it.
    if material.base_texture.is_none() {
        material.multiply_texture();
    }
}

/// The libraries of one `mtllib` line: the whole rest of the line as one name, else this without a
/// comment, else each of its words, else what is called as the last part of the path, which may be
/// that of another machine. Names in other case come last.
fn read_libraries(
    line: u64,
    names: &str,
    resolver: &dyn Resolver,
    warnings: &mut Warnings,
) -> Vec<(String, Vec<u8>)> {
    let plain = without_comment(names);
    let whole = &mtl::file_name(plain);
    let mut wholes = vec![mtl::file_name(names), whole.clone()];
    wholes.dedup();
    for name in wholes {
        if let Ok(bytes) = resolver.read(&name) {
            return vec![(name, bytes)];
        }
    }

    // Try the words, where there are several.
    let words = words(plain);
    let mut found = Vec::new();
    let mut failures = Vec::new();
    for word in words.into_iter().filter(|word| word != whole) {
        match read_first(resolver, std::slice::from_ref(&word)) {
            Ok(file) => found.push(file),
            Err(why) => failures.push((word, why)),
        }
    }

    // Else try the last part of the path.
    let mut why = None;
    if found.is_empty() {
        let bare = whole.rsplit('/').next().unwrap_or(whole);
        match read_first(resolver, &[whole.clone(), bare.to_owned()]) {
            Ok(file) => {
                found.push(file);
                failures.clear();
            }
            Err(e) => why = Some(e),
        }
    }

    // Tell the missing files: the words, where some of them were found or quotes part them, else
    // the whole.
    let mut missing = |name: &str, why: &crate::ResolveError| {
        warnings.note("", Place::Line(line), || {
            format!("material library `{name}` is left out: {why}")
        });
    };
    match &why {
        Some(why) if !whole.contains('"') => missing(whole, why),
        _ => failures.iter().for_each(|(word, why)| missing(word, why)),
    }
    for oddity in found.iter_mut().filter_map(|file| file.oddity.take()) {
        warnings.note("", Place::Line(line), || oddity);
    }
    found.into_iter().map(|file| (file.name, file.bytes)).collect()
}

/// The names on a line; a blank between quotes or behind `\` belongs to a name.
fn words(line: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let (mut quoted, mut escaped) = (false, false);
    for letter in line.chars() {
        quoted ^= letter == '"';
        if letter.is_ascii_whitespace() && !quoted && !escaped {
            words.push(String::new());
        } else if let Some(word) = words.last_mut() {
            word.push(letter);
        }
        escaped = letter == '\\';
    }
    words.iter().filter(|w| !w.is_empty()).map(|w| mtl::file_name(w)).collect()
}
