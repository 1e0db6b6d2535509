//! From vertices in clip space to primitives in tile lists, with OpenGL's culling, clipping,
//! polygon modes, offset, lines and points.
//!
//! Vertices are shaded after this, and only those that a primitive uses: an assembler hands out a
//! *slot* for each, the place of the vertex's record in [`Primitives::records`]. A vertex made by
//! clipping is a weighted sum of three others.
//!
//! In:   clip-space vertices, projected ones, corners of primitives.
//! Out:  [`Primitives`]: setups, tile lists, facets, and which vertices to shade.

mod clipped;
mod eight;
mod lines;
mod outlined;

use self::clipped::Derived;
use super::boxes::Boxes;
use super::color_grid::{ColorGrid, GridColors};
use super::environment::UNITS;
use super::hard_line::HardLine;
use super::project::WindowTransform;
use super::shade::Layout;
use crate::screen::{Screen, ScreenVertex, covered_pixels, flag};
use crate::setup::{CornerPosition, DepthPlane, Setup};
use crate::{Batch, GUARD_BAND, SUBPIXEL, SamplePattern, Viewport};
use std::mem::take;
use vitral_math::lanes::{LANES, Level};

/// How a facet's interior is found and coloured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FacetKind {
    /// A polygon's interior.
    Polygon,
    /// A line with soft borders or a stipple: its local coordinates are in [`Facet::shape`].
    Line,
    /// A point that is soft, a sprite, or fades.
    Point,
    /// A line or a point that is nothing of this: its fragments are those of a polygon without
    /// stipple.
    Plain,
}

/// What the facets of a primitive share.
#[derive(Clone, Copy, Debug)]
struct FacetAttributes {
    /// Slot of the vertex whose colours flat shading takes.
    provoking: u32,
    kind: FacetKind,
    /// A back-facing polygon.
    back: bool,
    /// See [`Facet::shape`].
    shape: u32,
}

impl FacetAttributes {
    /// A filled polygon's.
    #[inline(always)]
    fn polygon(provoking: u32, back: bool) -> Self {
        Self { provoking, kind: FacetKind::Polygon, back, shape: NONE }
    }
}

/// A triangle of a primitive, by the number in its setup.
#[derive(Clone, Copy, Debug)]
pub struct Facet {
    /// Slots of the corners, in the order of the setup's.
    pub corners: [u32; 3],
    /// Slot of the vertex whose colours flat shading takes.
    pub provoking: u32,
    /// Which draw of the job it belongs to.
    pub draw: u32,
    /// What it is part of.
    pub kind: FacetKind,
    /// A back-facing polygon.
    pub back: bool,
    /// Index into [`Primitives::shapes`] of a line, point or piece of a smooth polygon.
    pub shape: u32,
    /// Index into [`Primitives::grids`] of where its colours come from, if not from its corners.
    pub grid: u32,
}

impl Facet {
    /// What is drawn of it.
    #[inline(always)]
    pub(super) fn extent<'a>(&self, primitives: &'a Primitives) -> Extent<'a> {
        if self.kind == FacetKind::Polygon {
            return Extent::Whole;
        }
        match primitives.shapes.get(self.shape as usize) {
            Some(Shape::Point { pixels: Some([x0, y0, x1, y1]), .. }) => {
                Extent::Box([*x0 as i32, *y0 as i32, *x1 as i32 + 1, *y1 as i32 + 1])
            }
            Some(Shape::Line { hard: Some(line), .. }) => Extent::Line(line),
            _ => Extent::Whole,
        }
    }
}

/// What is drawn of a facet.
pub(super) enum Extent<'a> {
    /// All that it covers.
    Whole,
    /// That, as far as it lies within pixels x0, y0, x1, y1 of the target, the last two exclusive.
    Box([i32; 4]),
    /// Another area in its plane.
    Line(&'a HardLine),
}

/// Local geometry of lines and points, in pixels.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    /// From one end to the other.
    Line {
        /// Start.
        from: [f32; 2],
        /// End.
        to: [f32; 2],
        /// Width in pixels.
        width: f32,
        /// Along the longer axis, the centre of the pixel where an aliased line starts; others are
        /// rectangles.
        first: Option<f32>,
        /// Stipple count at the start.
        stipple: u32,
        /// What it covers, if its facet alone does not say so.
        hard: Option<HardLine>,
    },
    /// A triangle of a smooth polygon, whose setup is wider by a border.
    Polygon {
        /// The triangle's own corners, in the setup's order and units.
        x: [i32; 3],
        /// See `x`.
        y: [i32; 3],
        /// Which of the edges from these corners are the polygon's.
        boundary: [bool; 3],
    },
    /// A point of a diameter; `fade` multiplies its alpha.
    Point {
        /// Centre.
        center: [f32; 2],
        /// Diameter.
        size: f32,
        /// Factor for alpha.
        fade: f32,
        /// All that is drawn of the facet, if not all that it covers: first column and row, last
        /// column and row.
        pixels: Option<[u32; 4]>,
    },
}

/// How primitives become facets: the part of the state that needs no vertex.
#[derive(Clone, Debug)]
pub struct PrimitiveState {
    /// Clip space to the window.
    pub window: WindowTransform,
    /// Clip-space planes of the user, inside is >= 0; distances come with the vertices.
    pub user_planes: usize,
    /// Near and far do not clip.
    pub depth_clamp: bool,
    /// Front faces run counter-clockwise.
    pub counter_clockwise: bool,
    /// The window's y runs against the clip space's.
    pub flipped: bool,
    /// Front faces, back faces are culled.
    pub cull: [bool; 2],
    /// Polygon offset factor and units for points, lines, fill; 0 when disabled.
    pub offset: [[f32; 2]; 3],
    /// The unit of polygon offset; 0 for floating point, where it depends on the depth.
    pub depth_step: f32,
    /// How front and back polygons are drawn: 0 points, 1 lines, 2 filled.
    pub polygon_mode: [u8; 2],
    /// Line width in pixels.
    pub line_width: f32,
    /// Lines are smooth: their rectangle is widened for the soft border.
    pub line_smooth: bool,
    /// Multisample lines and points are true rectangles and circles.
    pub multisample: bool,
    /// Points are smooth.
    pub point_smooth: bool,
    /// Points are sprites: true squares round their places.
    pub point_sprite: bool,
    /// Polygons are smooth.
    pub polygon_smooth: bool,
    /// Allowed pixels x0, y0, x1, y1 for filled polygons: scissor, target and viewport.
    pub clip: [i32; 4],
    /// The same for lines and points: scissor and target. Of them the viewport bounds the centres
    /// alone.
    pub stroke_clip: [i32; 4],
    /// The draw's number in its job.
    pub draw: u32,
    /// See [`Facet::grid`]; [`NO_GRID`] for colours of corners.
    pub grid: u32,
}

/// What jobs make: primitives of several draws, in order.
#[derive(Debug, Default)]
pub struct Primitives {
    /// The pass stays pending: setups name their draws, and there are neither facets nor records.
    pub(super) pending: bool,
    /// What finds triangles then.
    pub(super) boxes: Boxes,
    /// Setups and tile lists; a setup's facet indexes `facets`.
    pub batch: Batch,
    /// See there.
    pub facets: Vec<Facet>,
    /// Lines' and points' geometry.
    pub shapes: Vec<Shape>,
    /// Shaded vertices, by slot.
    pub records: Vec<f32>,
    /// Grids of colours.
    pub grids: Vec<ColorGrid>,
    /// Their vertices' colours, as far as pixels asked for them.
    pub grid_colors: GridColors,
    /// Memory of the piece that is being assembled.
    pub scratch: PieceScratch,
}

/// Values of a piece's vertices while it is assembled; kept, so that memory need not be
/// asked for and cleared. The vectors may be longer than the piece.
#[derive(Debug, Default)]
pub struct PieceScratch {
    /// In clip space.
    pub clip: Vec<[f32; 4]>,
    /// In the window.
    pub screen: Vec<ScreenVertex>,
    slots: Vec<u32>,
    used: Vec<u32>,
}

impl PieceScratch {
    /// Hands out `clip` and `screen`, with room for `count` vertices.
    pub fn take(&mut self, count: usize) -> (Vec<[f32; 4]>, Vec<ScreenVertex>) {
        if self.clip.len() < count {
            self.clip.resize(count, [0.0; 4]);
            self.screen.resize(count, ScreenVertex::default());
        }
        (take(&mut self.clip), take(&mut self.screen))
    }
}

/// The facet's colours come from its corners.
pub const NO_GRID: u32 = u32::MAX;

/// How far over a smooth polygon's edge pixels may be that it covers in part.
const SOFT_BORDER: f32 = 0.75;

/// Flags of which one is enough for a triangle to be cut, if it is not dropped.
const CUT: u32 = flag::CLIP | flag::USERS;

/// No slot yet, no shape.
const NONE: u32 = u32::MAX;

/// Collects the primitives of one piece of a draw.
#[derive(Debug)]
pub struct Assembler<'a> {
    /// State of the draw.
    pub state: &'a PrimitiveState,
    screen: &'a Screen,
    out: &'a mut Primitives,
    /// Numbers a record has.
    stride: u32,
    vertices: &'a Vertices<'a>,
    slots: Vec<u32>,
    /// Vertices to shade, in the order of their slots; derived ones are `NONE`.
    used: Vec<u32>,
    /// Vertices that are made of others.
    derived: Vec<Derived>,
    first_slot: u32,
    /// All vertices have the first slot.
    one_slot: bool,
    /// Points, lines are [`FacetKind::Plain`] if they do not fade.
    plain: [bool; 2],
    /// Where records hold the coordinates that point sprites replace.
    sprites: [Option<usize>; UNITS],
}

/// A piece's vertices. All slices have the same length but `user`, which has `planes` numbers a
/// vertex.
#[derive(Clone, Copy, Debug)]
pub struct Vertices<'a> {
    /// Clip space.
    pub clip: &'a [[f32; 4]],
    /// In the window, after [`flag_user_planes`].
    pub screen: &'a [ScreenVertex],
    /// Distances to the user's planes.
    pub user: &'a [f32],
    /// Point sizes and fade factors; empty where no points are drawn.
    pub sizes: &'a [[f32; 2]],
}

impl Drop for Assembler<'_> {
    fn drop(&mut self) {
        self.out.scratch.slots = take(&mut self.slots);
        self.out.scratch.used = take(&mut self.used);
    }
}

impl<'a> Assembler<'a> {
    /// Collects into `out`; records are as `layout` says and begin where `out.records` ends.
    pub fn new(
        state: &'a PrimitiveState,
        screen: &'a Screen,
        out: &'a mut Primitives,
        layout: &Layout,
        vertices: &'a Vertices<'a>,
    ) -> Self {
        let first_slot = out.records.len() as u32;
        let (mut slots, mut used) = (take(&mut out.scratch.slots), take(&mut out.scratch.used));
        let one_slot = out.pending || layout.uniform;
        slots.clear();
        slots.resize(if one_slot { 0 } else { vertices.clip.len() }, NONE);
        used.clear();
        used.extend((layout.uniform && !out.pending && !vertices.clip.is_empty()).then_some(0));
        let stride = layout.stride as u32;
        let plain = [!layout.smooth[0], !layout.smooth[1] && layout.line_stipple.is_none()];
        let sprites = std::array::from_fn(|unit| {
            layout.tex[unit].filter(|_| layout.sprites >> unit & 1 == 1)
        });
        let derived = Vec::new();
        Self {
            state,
            screen,
            out,
            stride,
            vertices,
            slots,
            used,
            derived,
            first_slot,
            one_slot,
            plain,
            sprites,
        }
    }

    /// The slot of a vertex: where its record begins.
    #[inline(always)]
    fn slot(&mut self, vertex: u32) -> u32 {
        if self.one_slot {
            return self.first_slot;
        }
        let slot = &mut self.slots[vertex as usize];
        if *slot == NONE {
            *slot = self.first_slot + self.used.len() as u32 * self.stride;
            self.used.push(vertex);
        }
        *slot
    }

    /// Triangles that are filled; the last corner provokes.
    pub fn triangles(&mut self, level: Level, triangles: &[[u32; 3]]) {
        self.by_eights(level, triangles);
    }

    /// A filled triangle.
    pub fn triangle(&mut self, corners: [u32; 3], provoking: u32) {
        let s = self.vertices.screen;
        let [a, b, c] = [s[corners[0] as usize], s[corners[1] as usize], s[corners[2] as usize]];

        // Reject triangles outside the view volume, and clip those that cross it.
        let (any, all) = (a.flags | b.flags | c.flags, a.flags & b.flags & c.flags);
        if all & self.outside() != 0 || any & flag::NOT_FINITE != 0 {
            return;
        }
        if any & CUT != 0 {
            return self.clipped(&corners, provoking, None);
        }

        // Drop triangles without area, culled faces and those that cover no sample.
        let positions = [a.corner(), b.corner(), c.corner()];
        let area = Setup::doubled_area(positions[0], positions[1], positions[2]);
        if area == 0 {
            return;
        }
        let back = self.is_back(area);
        if self.state.cull[usize::from(back)] {
            return;
        }
        let Some(pixels) = self.pixels(&positions) else { return };

        // Compute the depth plane and emit the facet.
        let plane = self.plane([a, b, c], area);
        let slots = [self.slot(corners[0]), self.slot(corners[1]), self.slot(corners[2])];
        let provoking = self.slot(provoking);
        self.push(
            positions,
            area,
            &plane,
            pixels,
            slots,
            FacetAttributes::polygon(provoking, back),
        );
    }

    /// The flags any of which puts a primitive out of view if all its vertices have it.
    #[inline(always)]
    fn outside(&self) -> u32 {
        let ignored = if self.state.depth_clamp { flag::NEAR | flag::FAR } else { 0 };
        (flag::FRUSTUM | flag::USERS) & !ignored
    }

    /// With y upwards in the window, counter-clockwise corners have a positive area.
    #[inline(always)]
    fn is_back(&self, area: i64) -> bool {
        (area > 0) != (self.state.counter_clockwise != self.state.flipped)
    }

    /// The pixels a filled triangle may cover, if any are allowed.
    #[inline(always)]
    fn pixels(&self, positions: &[CornerPosition; 3]) -> Option<[u32; 4]> {
        self.pixels_within(positions, self.state.clip)
    }

    #[inline(always)]
    fn pixels_within(&self, positions: &[CornerPosition; 3], clip: [i32; 4]) -> Option<[u32; 4]> {
        let [x0, y0, x1, y1] = covered_pixels(positions, self.screen)?;
        let (x0, y0) = ((x0 as i32).max(clip[0]), (y0 as i32).max(clip[1]));
        let (x1, y1) = ((x1 as i32).min(clip[2] - 1), (y1 as i32).min(clip[3] - 1));
        (x0 <= x1 && y0 <= y1).then_some([x0 as u32, y0 as u32, x1 as u32, y1 as u32])
    }

    /// The depth plane of a filled polygon, with its offset.
    #[inline(always)]
    fn plane(&self, corners: [ScreenVertex; 3], area: i64) -> DepthPlane {
        let [a, b, c] = corners;
        let residues = [a.residue(), b.residue(), c.residue()];
        self.offset(DepthPlane::unsnapped([a.corner(), b.corner(), c.corner()], residues, area), 2)
    }

    #[inline(always)]
    fn offset(&self, mut plane: DepthPlane, offset: usize) -> DepthPlane {
        if self.state.offset[offset] != [0.0; 2] {
            plane.move_by(self.offset_of(&plane, offset));
        }
        plane
    }

    /// What polygon offset adds to the depths of a polygon in this plane.
    #[inline(always)]
    fn offset_of(&self, plane: &DepthPlane, offset: usize) -> f32 {
        let [factor, units] = self.state.offset[offset];
        let slope = plane.dz_dx.abs().max(plane.dz_dy.abs());
        // A step of floating-point depth: 2^(exponent - 23).
        let float_step = f32::from_bits(plane.z_max.to_bits() & 0x7f80_0000) * (1.0 / 8_388_608.0);
        let step = if self.state.depth_step > 0.0 { self.state.depth_step } else { float_step };
        slope * factor + step * units
    }

    /// Adds a facet and its setup, with the slots of its corners, where it may cover these pixels.
    #[inline(always)]
    fn push(
        &mut self,
        positions: [CornerPosition; 3],
        area: i64,
        plane: &DepthPlane,
        pixels: [u32; 4],
        corners: [u32; 3],
        attributes: FacetAttributes,
    ) {
        let facet = self.push_facet(area, corners, attributes);
        self.out.batch.push(Setup::with_plane(positions, area, plane, facet), pixels, self.screen);
    }

    /// Adds a facet, and gives what its setup has to name.
    #[inline(always)]
    fn push_facet(&mut self, area: i64, [a, b, c]: [u32; 3], attributes: FacetAttributes) -> u32 {
        let FacetAttributes { provoking, kind, back, shape } = attributes;
        let (draw, grid) = (self.state.draw, self.state.grid);
        if self.out.pending {
            return draw;
        }
        // The setup turns clockwise triangles over.
        let corners = if area > 0 { [a, b, c] } else { [a, c, b] };
        self.out.facets.push(Facet { corners, provoking, draw, kind, back, shape, grid });
        self.out.facets.len() as u32 - 1
    }

    /// A piece of a smooth polygon. It knows its own edges alone: where a diagonal meets a corner,
    /// the pixel shows the coverage of one edge. Edges that clipping makes are hard.
    fn smooth_triangle(
        &mut self,
        corners: [u32; 3],
        boundary: [bool; 3],
        provoking: u32,
        back: bool,
    ) {
        // Reject triangles outside the user's planes, and clip those that cross a plane.
        let v = corners.map(|v| self.vertices.screen[v as usize]);
        if v[0].flags & v[1].flags & v[2].flags & flag::USERS != 0 {
            return;
        }
        if (v[0].flags | v[1].flags | v[2].flags) & CUT != 0 {
            return self.clipped(&corners, provoking, Some(boundary));
        }

        // Emit the triangle with the edges that are the polygon's own.
        let own = v.map(ScreenVertex::corner);
        let area = Setup::doubled_area(own[0], own[1], own[2]);
        if area == 0 {
            return;
        }
        let plane = self.plane(v, area);
        let slots = [self.slot(corners[0]), self.slot(corners[1]), self.slot(corners[2])];
        let provoking = self.slot(provoking);
        self.push_smooth(own, area, &plane, boundary, slots, provoking, back);
    }

    /// A triangle that also reaches the pixels which it covers but in part along its boundary
    /// edges.
    fn push_smooth(
        &mut self,
        own: [CornerPosition; 3],
        area: i64,
        plane: &DepthPlane,
        boundary: [bool; 3],
        slots: [u32; 3],
        provoking: u32,
        back: bool,
    ) {
        let Some(wide) = widened(own, boundary, area) else { return };
        let Some(pixels) = self.pixels(&wide) else { return };
        let shape = self.out.shapes.len() as u32;
        let (order, boundary) = if area > 0 {
            ([0, 1, 2], boundary)
        } else {
            ([0, 2, 1], [boundary[2], boundary[1], boundary[0]])
        };
        let (x, y) = (order.map(|k| own[k].x), order.map(|k| own[k].y));
        self.out.shapes.push(Shape::Polygon { x, y, boundary });
        let attributes = FacetAttributes { shape, ..FacetAttributes::polygon(provoking, back) };
        self.push(wide, area, plane, pixels, slots, attributes);
    }

    /// Makes records for the vertices that primitives use. `shade` gets up to eight of them, and
    /// their records to fill; those that clipping made ([`Self::is_own`] tells) are filled
    /// afterwards, from their parents'.
    pub fn shade(&mut self, mut shade: impl FnMut(&[u32], &mut [f32])) {
        let (start, stride) = (self.out.records.len(), self.stride as usize);
        if stride == 0 {
            return;
        }
        self.out.records.resize(start + self.used.len() * stride, 0.0);
        for (eight, records) in
            self.used.chunks(LANES).zip(self.out.records[start..].chunks_mut(LANES * stride))
        {
            shade(eight, records);
        }
        self.derive();
    }

    /// Whether a used vertex is one of the piece's own.
    pub fn is_own(vertex: u32) -> bool {
        vertex != NONE
    }
}

/// Flags the vertices beyond the user's planes, of whose distances each has as many as there are
/// planes.
pub fn flag_user_planes(user: &[f32], screen: &mut [ScreenVertex]) {
    let Some(planes) = user.len().checked_div(screen.len()).filter(|planes| *planes > 0) else {
        return;
    };
    for (vertex, distances) in screen.iter_mut().zip(user.chunks_exact(planes)) {
        for (plane, distance) in distances.iter().enumerate() {
            // NaN is beyond.
            vertex.flags |= u32::from(distance.is_nan() || *distance < 0.0) * (flag::USER << plane);
        }
    }
}

/// A triangle of doubled area `area` with its boundary edges moved outwards; `None` if it has no
/// area.
fn widened(
    corners: [CornerPosition; 3],
    boundary: [bool; 3],
    area: i64,
) -> Option<[CornerPosition; 3]> {
    if area == 0 {
        return None;
    }
    let scale = SUBPIXEL as f32;
    // Inner normals and distances of the moved edges.
    let edges: [[f32; 3]; 3] = std::array::from_fn(|i| {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        let (dx, dy) = ((b.x - a.x) as f32, (b.y - a.y) as f32);
        let length = (dx * dx + dy * dy).sqrt().copysign(area as f32);
        let (nx, ny) = (-dy / length, dx / length);
        let border = if boundary[i] { SOFT_BORDER * scale } else { 0.0 };
        [nx, ny, nx * a.x as f32 + ny * a.y as f32 - border]
    });

    // Intersect neighbouring edges, snapped to the grid and limited to the guard band.
    let whole = |v: f32| ((v / scale).clamp(-GUARD_BAND, GUARD_BAND) * scale + 0.5).floor() as i32;
    let wide: [CornerPosition; 3] = std::array::from_fn(|i| {
        let ([a, b, c], [d, e, f]) = (edges[(i + 2) % 3], edges[i]);
        let determinant = a * e - b * d;
        let (x, y) = ((c * e - b * f) / determinant, (a * f - c * d) / determinant);
        CornerPosition { x: whole(x), y: whole(y), z: corners[i].z }
    });

    // Keep the triangle if it still has its orientation.
    let wide_area = Setup::doubled_area(wide[0], wide[1], wide[2]);
    (wide_area != 0 && (wide_area > 0) == (area > 0)).then_some(wide)
}

/// The screen for a target.
pub(crate) fn screen(viewport: Viewport, pattern: &SamplePattern) -> Screen {
    Screen::new(viewport, pattern)
}
