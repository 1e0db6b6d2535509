//! From the world to the page: vertices are welded, projected, clipped and snapped, each once.
//!
//! The window of the camera is the page: x and y of normalised device space become units of the
//! grid, [`PAGE_UNITS`] along the longer side. Depth is `z / w`, which is an affine function of
//! `1 / w` in perspective and of the distance in a parallel projection: planes of the world are
//! planes on the page. The depths in use are stretched to [`DEPTH_UNITS`] in perspective; in a
//! parallel projection they have the unit of the page, so that the grid's cells are cubes, unless
//! the scene is deeper than [`PARALLEL_DEPTH_UNITS`].
//!
//! In:   the world and a view. Out: vertices on the grid, and triangles that lie on the page,
//!       clipped where they cross its border, the near or the far plane.
//! Cost: linear in vertices and triangles.
//! Source: clipping in homogeneous coordinates is [Blinn & Newell 1978]; see `clip.rs`.

use crate::clip::{ClipVertex, Clipper, OUT_OF_NEAR, outcode};
use crate::page_mesh::{NONE, PAGE_UNITS, Source, Triangle};
use crate::run::Run;
use std::ops::Range;
use vitral_exec::Limit;
use vitral_math::exact::{GridPoint, orient2d};
use vitral_math::{DMat4, DVec3, DVec4};
use vitral_scene::weld::Weld;
use vitral_scene::{Instance, Solids, ViewTransform, World};

/// Units of depth in perspective.
const DEPTH_UNITS: f64 = (1u64 << 30) as f64;
/// Most units of depth in a parallel projection.
const PARALLEL_DEPTH_UNITS: f64 = (1u64 << 25) as f64;
/// Cosine of the angle between a face and the projectors' plane below which a face without area on
/// the page is seen edge-on.
const EDGE_ON: f64 = 1e-3;
/// Triangles and vertices in one piece of work.
const BATCH: usize = 1 << 14;
/// Bytes a vertex and a triangle take until the page's mesh is made.
const BYTES_A_VERTEX: u64 = 56;
const BYTES_A_TRIANGLE: u64 = 176;

/// Where in [`Facet::outline`] the bits of sides begin along which a plane of section has cut.
pub(crate) const CUT_SIDES: u32 = 3;

/// A triangle before it is snapped: welded vertices, the facet it was cut from, a bit for each side
/// that is part of the outline of its face, and above these one for each side along a cut.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facet {
    pub(crate) vertices: [u32; 3],
    pub(crate) source: u32,
    pub(crate) outline: u8,
}

/// The scene on the page, without edges.
#[derive(Debug, Default)]
pub(crate) struct Projected {
    /// Size of the page in units.
    pub(crate) size: [i32; 2],
    /// Vertices, snapped.
    pub(crate) vertices: Vec<GridPoint>,
    /// Triangles of each facet in the file's winding.
    pub(crate) facets: Vec<Facet>,
    /// The same on the page.
    pub(crate) triangles: Vec<Triangle>,
    /// What facets are part of.
    pub(crate) sources: Vec<Source>,
    /// Free lines, as pairs of vertices.
    pub(crate) lines: Vec<[u32; 2]>,
    /// Free points, as vertices, each once.
    pub(crate) points: Vec<u32>,
}

impl Projected {
    /// Makes triangles clear whose materials have an opacity below 1, back faces of solid bodies as
    /// well: they are seen through the others. Those of no opacity are not seen at all.
    pub(crate) fn let_through(&mut self, opacity: impl Fn(u32) -> f32) {
        for (facet, triangle) in self.facets.iter().zip(&mut self.triangles) {
            let opacity = opacity(self.sources[facet.source as usize].material);
            if opacity < 1.0 {
                triangle.hides = false;
                triangle.clear = opacity > 0.0 && !triangle.is_flat();
            }
        }
    }
}

impl Projected {
    /// Makes triangles neither hide nor show where a material that shows its front alone is seen
    /// from behind.
    pub(crate) fn leave_out_backs(&mut self, is_front_only: impl Fn(u32) -> bool) {
        for (facet, triangle) in self.facets.iter().zip(&mut self.triangles) {
            if triangle.facing < 0 && is_front_only(self.sources[facet.source as usize].material) {
                (triangle.hides, triangle.clear) = (false, false);
            }
        }
    }
}

/// An instance on its way to the page.
struct Placed<'w> {
    instance: &'w Instance,
    /// For each position of the mesh its vertex, or [`NONE`].
    vertex_of: Vec<u32>,
    solid: SolidTriangles,
    /// Whether the transform mirrors: fronts are clockwise then.
    mirrored: bool,
}

/// Which triangles of an instance belong to solid bodies.
enum SolidTriangles {
    All,
    None,
    Some(Solids),
}

impl SolidTriangles {
    fn has(&self, t: usize) -> bool {
        match self {
            Self::All => true,
            Self::None => false,
            Self::Some(solids) => {
                solids.some().is_some_and(|bits| bits[t / 32] >> (t % 32) & 1 == 1)
            }
        }
    }
}

/// Width and height of a page of `aspect` (width by height) in units.
pub(crate) fn page_size(aspect: f64) -> [i32; 2] {
    let longer = f64::from(PAGE_UNITS);
    let size = if aspect >= 1.0 { [longer, longer / aspect] } else { [longer * aspect, longer] };
    size.map(|side| (side.round() as i32).clamp(1, PAGE_UNITS))
}

/// Projects a world; `aspect` is the page's width by its height.
pub(crate) fn project(
    world: &World,
    view: &ViewTransform,
    aspect: f64,
    run: &Run<'_>,
) -> Result<Projected, Limit> {
    let size = page_size(aspect);
    let vertex_count: usize = world.instances.iter().map(|i| i.mesh.positions.len()).sum();
    run.memory.add(
        vertex_count as u64 * BYTES_A_VERTEX + u64::from(world.facet_count) * BYTES_A_TRIANGLE,
    )?;

    // Weld each mesh once, and give each instance its vertices in clip space.
    let mut welds: Vec<Option<(Weld, Vec<u32>)>> = Vec::new();
    let (mut placed, mut clip) = (Vec::new(), Vec::new());
    for instance in &world.instances {
        run.budget.check("projection")?;
        let index = instance.mesh_index as usize;
        welds.resize_with(welds.len().max(index + 1), || None);
        let (weld, used) = welds[index].get_or_insert_with(|| {
            let weld = Weld::new(&instance.mesh.positions, run.workers);
            let used = used_vertices(instance, &weld);
            (weld, used)
        });
        placed.push(place(instance, weld, used, view, &mut clip, run));
    }

    // Keep triangles and lines on the page, and clip triangles and lines that cross its border.
    let mut projected = Projected { size, sources: sources(world, run), ..Projected::default() };
    let mut clipper = Clipper::new(&mut clip);
    for one in &placed {
        add_triangles(one, &mut clipper, &mut projected, run)?;
        add_lines(one, &mut clipper, &mut projected);
        add_points(one, &clipper, &mut projected);
    }
    snap(&mut projected, &clip, view, run);
    finish_triangles(&mut projected, world, &placed, view, run);
    Ok(projected)
}

/// The welded vertices that triangles, free lines and free points of an instance's mesh use, in
/// order.
fn used_vertices(instance: &Instance, weld: &Weld) -> Vec<u32> {
    let mesh = &instance.mesh;
    let mut used = vec![false; mesh.positions.len()];
    let named =
        mesh.triangles.as_flattened().iter().chain(mesh.lines.as_flattened()).chain(&mesh.points);
    named.for_each(|&v| used[weld.representative[v as usize] as usize] = true);
    (0..used.len() as u32).filter(|&v| used[v as usize]).collect()
}

/// Gives an instance its vertices.
fn place<'w>(
    instance: &'w Instance,
    weld: &Weld,
    used: &[u32],
    view: &ViewTransform,
    clip: &mut Vec<ClipVertex>,
    run: &Run<'_>,
) -> Placed<'w> {
    let mesh = &instance.mesh;

    // Bring the vertices in use to clip space.
    let clip_from_model: DMat4 = view.clip_from_world() * instance.world_from_model;
    let first = clip.len();
    clip.resize(first + used.len(), ClipVertex::default());
    run.workers.for_each_chunk(&mut clip[first..], BATCH, |chunk, vertices| {
        for (vertex, &v) in vertices.iter_mut().zip(&used[chunk * BATCH..]) {
            let position = DVec3::from_array(mesh.positions[v as usize].map(f64::from));
            let at = clip_from_model * position.extend(1.0);
            *vertex = ClipVertex { at, outcode: outcode(at) };
        }
    });

    // Number the vertices; welded ones share a number.
    let mut vertex_of = vec![NONE; mesh.positions.len()];
    used.iter().enumerate().for_each(|(i, &v)| vertex_of[v as usize] = (first + i) as u32);
    if weld.distinct < weld.representative.len() {
        for v in 0..vertex_of.len() {
            vertex_of[v] = vertex_of[weld.representative[v] as usize];
        }
    }

    // A viewer inside a body, or a near plane that cuts it, sees its back faces.
    let cut = clip[first..].iter().any(|v| v.outcode & OUT_OF_NEAR != 0);
    let solids = if cut { Solids::default() } else { Solids::of(mesh, run.workers) };
    let solid = match (solids.solidity.is_solid(), solids.some().is_some()) {
        (true, _) => SolidTriangles::All,
        (false, true) => SolidTriangles::Some(solids),
        (false, false) => SolidTriangles::None,
    };
    Placed { instance, vertex_of, solid, mirrored: instance.world_from_model.determinant() < 0.0 }
}

/// What all facets of the world are part of.
fn sources(world: &World, run: &Run<'_>) -> Vec<Source> {
    let mut all = Vec::with_capacity(world.facet_count as usize);
    for instance in &world.instances {
        let mesh = &instance.mesh;
        let count = mesh.triangles.len();
        let pieces = run.workers.map(count.div_ceil(BATCH), |piece| {
            let range = piece * BATCH..count.min((piece + 1) * BATCH);
            sources_of(instance, range)
        });
        pieces.into_iter().for_each(|piece| all.extend(piece));
    }
    all
}

/// What a facet of the world is part of.
pub(crate) fn source_of_facet(world: &World, facet: u32) -> Source {
    let instance = &world.instances[world.instance_of_facet(facet)];
    let t = (facet - instance.first_facet) as usize;
    let face = instance.mesh.face_of_triangle(t);
    source_of(instance, t, face, outline_normal(instance, instance.mesh.face_corners(face)))
}

/// The source of a triangle whose face has this normal. An outline that crosses itself may have
/// none, since its halves cancel out: each triangle has its own normal there.
fn source_of(instance: &Instance, t: usize, face: usize, normal: [f32; 3]) -> Source {
    let mesh = &instance.mesh;
    let is_cancelled = normal == [0.0; 3];
    Source {
        facet: instance.first_facet + t as u32,
        surface: instance.first_surface + face as u32,
        material: mesh.material_of_triangle(t).unwrap_or(NONE),
        normal: if is_cancelled { outline_normal(instance, &mesh.triangles[t]) } else { normal },
    }
}

/// The sources of some triangles of an instance. Neighbours often belong to one face, whose normal
/// is computed once.
fn sources_of(instance: &Instance, triangles: Range<usize>) -> Vec<Source> {
    let mesh = &instance.mesh;
    let (mut last, mut normal) = (usize::MAX, [0.0; 3]);
    let source = |t: usize| {
        let face = mesh.face_of_triangle(t);
        if face != last {
            (last, normal) = (face, outline_normal(instance, mesh.face_corners(face)));
        }
        source_of(instance, t, face, normal)
    };
    triangles.map(source).collect()
}

/// The unit normal of an outline of vertices, world space, by Newell's method; zero for one without
/// area.
fn outline_normal(instance: &Instance, corners: &[u32]) -> [f32; 3] {
    let origin = instance.place(corners[0]);
    let mut sum = DVec3::ZERO;
    let mut before = DVec3::ZERO;
    for &corner in &corners[1..] {
        let at = instance.place(corner) - origin;
        sum += before.cross(at);
        before = at;
    }
    let outward = if instance.world_from_model.determinant() < 0.0 { -sum } else { sum };
    outward.try_normalize().unwrap_or(DVec3::ZERO).as_vec3().to_array()
}

/// Adds the triangles of an instance that are on the page: whole ones first, then the pieces of
/// clipped ones.
fn add_triangles(
    placed: &Placed<'_>,
    clipper: &mut Clipper<'_>,
    to: &mut Projected,
    run: &Run<'_>,
) -> Result<(), Limit> {
    let (instance, sources) = (placed.instance, &to.sources);
    let count = instance.mesh.triangles.len();
    let vertices = clipper.vertices();

    // Sort the triangles of each batch: whole, clipped, or outside.
    let sorted = run.workers.map(count.div_ceil(BATCH), |piece| {
        let (mut whole, mut partly, mut outline) = (Vec::new(), Vec::new(), Outline::new());
        for t in piece * BATCH..count.min((piece + 1) * BATCH) {
            let facet = Facet {
                vertices: instance.mesh.triangles[t].map(|v| placed.vertex_of[v as usize]),
                source: instance.first_facet + t as u32,
                outline: outline.sides_of(instance, t),
            };
            let [a, b, c] = facet.vertices;
            if a == b || b == c || c == a || sources[facet.source as usize].normal == [0.0; 3] {
                continue;
            }
            let codes = facet.vertices.map(|v| vertices[v as usize].outcode);
            if codes[0] & codes[1] & codes[2] != 0 {
                continue;
            }
            let list = if codes == [0; 3] { &mut whole } else { &mut partly };
            list.push(facet);
        }
        (whole, partly)
    });

    // Append the whole ones and clip the others.
    for (whole, partly) in sorted {
        run.budget.check("clipping")?;
        to.facets.extend(whole);
        partly.iter().for_each(|facet| clipper.clip(facet, &mut to.facets));
    }
    Ok(())
}

/// The sides of the face that is looked at: neighbours ask about the same one.
struct Outline {
    face: usize,
    sides: Vec<[u32; 2]>,
}

impl Outline {
    fn new() -> Self {
        Self { face: usize::MAX, sides: Vec::new() }
    }

    /// A bit for each side of a triangle: whether it is a side of its face as well, and no
    /// diagonal; and three more for cuts.
    fn sides_of(&mut self, instance: &Instance, t: usize) -> u8 {
        // Mark the sides that lie along a cut.
        let mesh = &instance.mesh;
        let face = mesh.face_of_triangle(t);
        let corners = mesh.face_corners(face);
        let [a, b, c] = mesh.triangles[t];
        let is_cut =
            |a: u32, b: u32| mesh.section.as_ref().is_some_and(|section| section.has_edge(a, b));
        let cuts = [(a, b), (b, c), (c, a)].into_iter().enumerate();
        let cuts = cuts
            .fold(0, |bits, (k, (a, b))| bits | u8::from(is_cut(a, b)) << (k as u32 + CUT_SIDES));

        // Mark the sides of the face; all sides of a triangular one.
        if corners.len() == 3 {
            return cuts | 0b111;
        }
        if self.face != face {
            self.face = face;
            self.sides.clear();
            let next = corners.iter().cycle().skip(1);
            self.sides.extend(corners.iter().zip(next).map(|(&a, &b)| [a.min(b), a.max(b)]));
            self.sides.sort_unstable();
        }
        let is_side =
            |a: u32, b: u32| u8::from(self.sides.binary_search(&[a.min(b), a.max(b)]).is_ok());
        cuts | is_side(a, b) | is_side(b, c) << 1 | is_side(c, a) << 2
    }
}

/// Adds the free lines of an instance.
fn add_lines(placed: &Placed<'_>, clipper: &mut Clipper<'_>, to: &mut Projected) {
    for line in &placed.instance.mesh.lines {
        let ends = line.map(|v| placed.vertex_of[v as usize]);
        if let Some(clipped) = clipper.clip_line(ends).filter(|[a, b]| a != b) {
            to.lines.push(clipped);
        }
    }
}

/// Adds the free points of an instance that are on the page.
fn add_points(placed: &Placed<'_>, clipper: &Clipper<'_>, to: &mut Projected) {
    let first = to.points.len();
    let vertices = placed.instance.mesh.points.iter().map(|&v| placed.vertex_of[v as usize]);
    to.points.extend(vertices.filter(|&v| clipper.vertices()[v as usize].outcode == 0));
    to.points[first..].sort_unstable();
    to.points.dedup();
}

/// Snaps the vertices in use to the grid.
fn snap(to: &mut Projected, clip: &[ClipVertex], view: &ViewTransform, run: &Run<'_>) {
    // Find the range of depths in use.
    let used = clip.iter().filter(|v| v.outcode == 0).map(|v| v.at.z / v.at.w);
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    used.for_each(|depth| (low, high) = (low.min(depth), high.max(depth)));
    let range = high - low;
    let page = to.size.map(f64::from);
    let units = if view.perspective {
        DEPTH_UNITS
    } else {
        // A unit of the page in world space is 2 / (width in units) in clip space, divided by the
        // projection's scale.
        let world_per_unit = 2.0 / (page[0] * view.clip_from_view.x_axis.x);
        (range * (view.far - view.near) / world_per_unit).min(PARALLEL_DEPTH_UNITS)
    };
    let scale = if range > 0.0 { units / range } else { 0.0 };

    // Round the vertices to the grid of the page.
    to.vertices.resize(clip.len(), [0; 3]);
    run.workers.for_each_chunk(&mut to.vertices, BATCH, |chunk, vertices| {
        for (vertex, at) in
            vertices.iter_mut().zip(&clip[chunk * BATCH..]).filter(|(_, at)| at.outcode == 0)
        {
            let DVec4 { x, y, z, w } = at.at;
            let across = [x, y].map(|c| c / w * 0.5 + 0.5);
            let on_page = |k: usize| (across[k] * page[k]).round().clamp(0.0, page[k]) as i32;
            *vertex = [on_page(0), on_page(1), ((z / w - low) * scale).round() as i32];
        }
    });
}

/// Makes the page's triangles of the facets.
fn finish_triangles(
    to: &mut Projected,
    world: &World,
    placed: &[Placed<'_>],
    view: &ViewTransform,
    run: &Run<'_>,
) {
    let (facets, vertices, sources) = (&to.facets, &to.vertices, &to.sources);

    // Find the direction to the viewer.
    let world_from_view = view.view_from_world.inverse();
    let eye = world_from_view.transform_point3(DVec3::ZERO);
    let backwards = world_from_view.transform_vector3(DVec3::Z);

    // Make the triangles, a batch on each thread.
    let pieces = run.workers.map(facets.len().div_ceil(BATCH), |piece| {
        let mut triangles = Vec::with_capacity(BATCH);
        for facet in &facets[piece * BATCH..facets.len().min((piece + 1) * BATCH)] {
            let corners = facet.vertices.map(|v| vertices[v as usize]);
            let mut triangle = Triangle::new(corners, facet.vertices);
            let index = world.instance_of_facet(facet.source);
            let (one, t) = (&placed[index], facet.source - placed[index].instance.first_facet);

            // Decide which side faces the viewer.
            if orient2d(corners[0], corners[1], corners[2]) == 0 {
                // Ask the plane in the world where snapping has left no area.
                let corner = one.instance.corners(t)[0];
                let towards =
                    if view.perspective { (eye - corner).normalize_or_zero() } else { backwards };
                let [x, y, z] = sources[facet.source as usize].normal.map(f64::from);
                let cosine = towards.dot(DVec3::new(x, y, z));
                triangle.facing = i8::from(cosine > EDGE_ON) - i8::from(cosine < -EDGE_ON);
            } else if one.mirrored {
                triangle.facing = -triangle.facing;
            }

            // Let back faces of closed bodies hide nothing.
            triangle.hides &= triangle.facing >= 0 || !one.solid.has(t as usize);
            triangles.push(triangle);
        }
        triangles
    });
    to.triangles = pieces.concat();
}
