//! Recorded commands on one target, and how they run.
//!
//! Draws are cut into jobs of about equal size, which turn vertices into facets in parallel; then
//! every tile, in parallel, walks clears, images and the jobs' facets in the order of the commands.

use super::assemble::{Facet, Primitives, screen};
use super::environment::UNITS;
use super::fragment::{ColorTile, FragmentOps, TilePlanes};
use super::pending::{PendingDepth, PendingKind, pendable};
use super::plan::{Plan, PlanItem, plan, rounds};
use super::plane::{ColorPlane, DepthBuffer, Plane, PlaneTile, StencilPlane};
use super::repeated_textures::{TextureUse, repeated_uses, texture_uses};
use super::sample::PackedTexture;
use super::shade::{Layout, TexelCache};
use super::spare::{Assembly, SparePrimitives};
use super::state::{Clamping, FragmentState};
use super::strips::{TileCopy, cut, rows};
use super::tile::TileRun;
use crate::geometry::TileLists;
use crate::screen::Screen;
use crate::{SUBPIXEL, SamplePattern, TILE, Viewport};
use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use vitral_exec::Workers;
use vitral_math::lanes::{LANES, Level};

/// Where fragments go. All planes have the same number of samples.
#[derive(Clone, Debug)]
pub struct Target {
    /// Size in pixels: the area that all planes have.
    pub viewport: Viewport,
    /// Samples a pixel: 1 or 4.
    pub samples: usize,
    /// Colour; without one colours are dropped.
    pub color: Option<Arc<Mutex<ColorPlane>>>,
    /// Depth; without one the depth test passes.
    pub depth: Option<Arc<Mutex<DepthBuffer>>>,
    /// Stencil; without one the stencil test passes.
    pub stencil: Option<Arc<Mutex<StencilPlane>>>,
    /// [`DepthBuffer::scale`]; without depth any.
    pub depth_scale: f32,
}

impl Target {
    /// Whether both draw into the same planes.
    pub fn same(&self, other: &Self) -> bool {
        fn same<T>(a: &Option<Arc<Mutex<T>>>, b: &Option<Arc<Mutex<T>>>) -> bool {
            match (a, b) {
                (Some(a), Some(b)) => Arc::ptr_eq(a, b),
                (None, None) => true,
                _ => false,
            }
        }
        self.viewport == other.viewport
            && self.samples == other.samples
            && same(&self.color, &other.color)
            && same(&self.depth, &other.depth)
            && same(&self.stencil, &other.stencil)
    }

    /// Where samples lie: the centre, or the pattern of four that Direct3D made common.
    pub fn pattern(&self) -> SamplePattern {
        pattern(self.samples)
    }
}

/// One sample in the centre, or four.
pub(crate) fn pattern(samples: usize) -> SamplePattern {
    SamplePattern::at(places(samples).to_vec())
}

/// The places of a [`pattern`]'s samples, in 1/256 pixel.
pub(super) fn places(samples: usize) -> &'static [[i32; 2]] {
    if samples == 4 { &[[96, 32], [224, 96], [32, 160], [160, 224]] } else { &[[SUBPIXEL / 2; 2]] }
}

/// Sets a rectangle of the planes to constant values.
#[derive(Clone, Copy, Debug)]
pub struct Clear {
    /// Colour, and which components are masked.
    pub color: Option<([f32; 4], [bool; 4])>,
    /// Depth, 0..=1.
    pub depth: Option<f32>,
    /// Stencil value and write mask.
    pub stencil: Option<(u8, u8)>,
    /// Pixels x0, y0, x1, y1, the last two exclusive.
    pub clip: [i32; 4],
}

/// Colours of a pixel rectangle.
#[derive(Clone, Debug)]
pub enum ImageColors {
    /// RGBA.
    Floats(Vec<[f32; 4]>),
    /// Bytes, red in the lowest.
    Words(Vec<u32>),
}

/// Fragments of a pixel rectangle or bitmap. The fragment of source pixel `(i, j)` covers the
/// pixels whose centres lie in `[x + zoom_x * i, x + zoom_x * (i + 1)) x [y + zoom_y * j, ...)`.
#[derive(Clone, Debug)]
pub struct ImageFragments {
    /// Window position of the first pixel's corner.
    pub origin: [f32; 2],
    /// Zoom; may be negative.
    pub zoom: [f32; 2],
    /// Source size.
    pub size: [u32; 2],
    /// Window depth of all fragments that bring none, 0..=1.
    pub z: f32,
    /// Colours for each source pixel.
    pub colors: Option<ImageColors>,
    /// Depths for each source pixel, 0..=1.
    pub depths: Option<Vec<f32>>,
    /// Stencil values for each source pixel: written through the stencil mask and nothing else.
    pub stencils: Option<Vec<u8>>,
    /// For bitmaps: which source pixels make a fragment.
    pub bits: Option<Vec<bool>>,
    /// Colour where there are no `colors`.
    pub color: [f32; 4],
    /// Secondary colour.
    pub secondary: [f32; 3],
    /// Texture coordinates of each unit.
    pub tex: [[f32; 4]; 8],
    /// Fog coordinate.
    pub fog: f32,
    /// Bits of `stencils` that are written.
    pub stencil_mask: u8,
}

/// Turns vertices into primitives, in parallel pieces.
pub trait Geometry: Send + Sync + std::fmt::Debug {
    /// How many pieces there are.
    fn pieces(&self) -> usize;
    /// About how many triangles a piece has.
    fn weight(&self, piece: usize) -> usize;
    /// Where its vertex records hold what.
    fn layout(&self) -> &Layout;
    /// Allowed pixels x0, y0, x1, y1 of filled polygons: the viewport.
    fn clip(&self) -> [i32; 4];
    /// Whether it may have lines or points, which the viewport does not cut.
    fn has_strokes(&self) -> bool;
    /// What tells whether another draw of the pass has the same vertices, as they were given.
    fn vertex_source(&self) -> usize;
    /// Adds a piece's primitives as draw number `draw` of the job.
    fn emit(
        &self,
        level: Level,
        piece: usize,
        draw: u32,
        screen: &ForwardScreen,
        out: &mut Primitives,
    );
    /// Colours, RGBA, of the vertices of its [`ColorGrid`](super::ColorGrid) from column
    /// `8 * eight` of row `row` on; beyond the row's end, any.
    fn grid_colors(&self, level: Level, row: u32, eight: u32) -> [[f32; 4]; LANES];
}

/// What geometry must know of the target.
#[derive(Clone, Debug)]
pub struct ForwardScreen {
    /// With one sample in the centre, with the target's.
    screens: [Screen; 2],
    /// Size of the target.
    pub viewport: Viewport,
    /// Samples a pixel.
    pub samples: usize,
}

impl ForwardScreen {
    /// The screen, for assemblers; draws that are not multisampled have one sample in the centre.
    pub fn screen(&self, multisample: bool) -> &Screen {
        &self.screens[usize::from(multisample)]
    }
}

/// A recorded command.
#[derive(Clone, Debug)]
pub enum Command {
    /// Sets a rectangle to constant values.
    Clear(Clear),
    /// A pixel rectangle or bitmap.
    Image(Arc<ImageFragments>, Arc<FragmentState>),
    /// Points, lines, triangles.
    Draw(Arc<dyn Geometry>, Arc<FragmentState>),
}

/// Commands on one target.
#[derive(Debug)]
pub struct Pass {
    /// Where they draw.
    pub target: Target,
    /// In order.
    pub commands: Vec<Command>,
}

impl Pass {
    /// Whether a command looks a plane up as a texture.
    pub fn samples(&self, plane: &Arc<Mutex<DepthBuffer>>) -> bool {
        self.commands.iter().any(|command| match command {
            Command::Draw(_, state) | Command::Image(_, state) => state
                .units
                .iter()
                .any(|unit| unit.texture.planes().any(|other| Arc::ptr_eq(other, plane))),
            Command::Clear(_) => false,
        })
    }
}

/// Threads, instruction set and memory that passes reuse.
#[derive(Debug)]
pub struct Runner {
    /// Threads.
    pub workers: Workers,
    /// Instruction set.
    pub level: Level,
    spare: SparePrimitives,
    spare_pending: SparePrimitives,
    assemblies: Mutex<Vec<Assembly>>,
    seen: Mutex<Vec<TexelCache>>,
}

/// Tiles of which a runner keeps the memory for what is seen there.
const MOST_SEEN: usize = 256;

/// What a tile walks, in order.
pub(crate) enum Item<'a> {
    Clear(&'a Clear),
    Image(&'a ImageFragments, &'a FragmentState, FragmentOps),
    Job { primitives: &'a Primitives, draws: Vec<DrawContext<'a>> },
}

/// A draw of a job.
pub(crate) struct DrawContext<'a> {
    pub geometry: &'a dyn Geometry,
    pub state: &'a FragmentState,
    pub layout: &'a Layout,
    pub ops: FragmentOps,
    /// Allowed pixels of filled polygons; those of lines and points are the state's.
    pub clip: [i32; 4],
    /// All samples of the target get tests of their own.
    pub multisample: bool,
    /// Colours matter: some are written, or decide.
    pub shaded: bool,
    /// A facet has one colour.
    pub constant: bool,
    /// Colours may leave `0..=1` before they are stored.
    pub unlimited: bool,
    /// Units with a common kind of texture.
    pub plain: Vec<(usize, PackedTexture<'a>)>,
    /// The unit whose texture a later draw shows with the same vertices, or an earlier one did.
    pub again: Option<usize>,
    /// Depth planes that units sample.
    pub planes: [Option<&'a DepthBuffer>; UNITS],
}

/// Depth planes that are held for a pass, with their addresses.
type Held<'a> = Vec<(*const Mutex<DepthBuffer>, MutexGuard<'a, DepthBuffer>)>;

impl Runner {
    /// A runner.
    pub fn new(workers: Workers, level: Level) -> Self {
        Self {
            workers,
            level,
            spare: SparePrimitives::default(),
            spare_pending: SparePrimitives::default(),
            assemblies: Mutex::default(),
            seen: Mutex::default(),
        }
    }

    /// Runs a pass.
    pub fn run(&self, pass: &Pass) {
        // Cut the commands into jobs of about equal work.
        let (plans, order) = plan(&pass.commands);
        let forward = ForwardScreen {
            screens: [pattern(1), pass.target.pattern()].map(|p| screen(pass.target.viewport, &p)),
            viewport: pass.target.viewport,
            samples: pass.target.samples,
        };

        // Leave a depth-only pass pending: its texels are computed when they are looked up.
        if let Some(kind) = self.pendable(pass) {
            let jobs = self.emit_all(&plans, 0..plans.len(), pass, &forward, Some(kind));
            return self.leave_pending(kind, pass, &plans, jobs);
        }

        // Lock the planes that the pass samples, and find the textures that are shown repeatedly.
        let again = repeated_uses(&pass.commands);
        let sampled = sampled_planes(&pass.commands);
        let (sampled, mut depth) = hold(&sampled, pass.target.depth.as_ref());
        let rounds = rounds(&order);
        // What was seen in a tile is kept from round to round.
        let mut seen = Vec::new();
        if rounds.len() > 1 && !again.is_empty() {
            seen = std::mem::take(&mut *lock(&self.seen));
            seen.iter_mut().for_each(TexelCache::clear);
            let viewport = pass.target.viewport;
            seen.resize_with(
                (viewport.tiles_x() * viewport.tiles_y()) as usize,
                TexelCache::default,
            );
        }

        // Assemble the primitives of each round, then walk the tiles.
        for round in rounds {
            let numbers = round.iter().filter_map(|item| match item {
                PlanItem::Job(number) => Some(*number),
                PlanItem::Command(_) => None,
            });
            let first = numbers.clone().next().unwrap_or(0);
            let numbers = first..first + numbers.count();
            let jobs = self.emit_all(&plans, numbers, pass, &forward, None);
            let items: Vec<Item<'_>> = round
                .iter()
                .map(|item| self.item(item, pass, &plans, (first, &jobs), (&sampled, &again)))
                .collect();
            self.tiles(&pass.target, &mut depth, &items, &mut seen);
            drop(items);
            self.spare.give(jobs);
        }

        // Keep what was looked up for the next pass.
        if !seen.is_empty() {
            seen.truncate(MOST_SEEN);
            *lock(&self.seen) = seen;
        }
    }

    /// The primitives of some jobs.
    fn emit_all(
        &self,
        plans: &[Plan],
        numbers: Range<usize>,
        pass: &Pass,
        forward: &ForwardScreen,
        pending: Option<PendingKind>,
    ) -> Vec<Primitives> {
        let spare = if pending.is_some() { &self.spare_pending } else { &self.spare };
        let places = spare.take(numbers.len());
        self.workers.map(numbers.len(), |j| {
            let mut job = std::mem::take(&mut *lock(&places[j]));
            self.emit(&plans[numbers.start + j], &pass.commands, forward, &mut job, pending);
            job
        })
    }

    fn emit(
        &self,
        plan: &Plan,
        commands: &[Command],
        forward: &ForwardScreen,
        out: &mut Primitives,
        pending: Option<PendingKind>,
    ) {
        // Take an assembly's memory and empty it.
        let mut assembly = lock(&self.assemblies).pop().unwrap_or_default();
        assembly.exchange(out);
        out.pending = pending.is_some();
        out.batch.clear(if pending.is_some() { TileLists::WithBoxes } else { TileLists::Kept });
        out.facets.clear();
        out.shapes.clear();
        out.records.clear();
        out.grids.clear();
        out.grid_colors.clear();

        // Emit the pieces of each draw.
        for (draw, (command, pieces)) in plan.pieces.iter().enumerate() {
            if let Command::Draw(geometry, _) = &commands[*command] {
                for piece in pieces.clone() {
                    geometry.emit(self.level, piece, draw as u32, forward, out);
                }
            }
        }

        // Bin the primitives, or keep them pending, and give the memory back.
        match pending {
            None => out.batch.finish(forward.screen(false)),
            Some(kind) => kind.finish(out, forward),
        }
        assembly.exchange(out);
        lock(&self.assemblies).push(assembly);
    }

    /// How a pass can be left as it is that draws depths into a texture, if it can: [`pendable`].
    /// What is pending there is dropped, since the pass clears all of it; its memory serves this
    /// pass.
    fn pendable(&self, pass: &Pass) -> Option<PendingKind> {
        let mut target = lock(pass.target.depth.as_ref()?);
        if !target.sampled || target.viewport() != pass.target.viewport {
            return None;
        }
        let kind = pendable(pass, target.scale)?;
        if let Some(before) = target.pending.take() {
            self.spare_pending.give(before.into_primitives());
        }
        Some(kind)
    }

    /// Leaves a pass as it is; `jobs` are its primitives.
    fn leave_pending(&self, kind: PendingKind, pass: &Pass, plans: &[Plan], jobs: Vec<Primitives>) {
        let Some(target) = &pass.target.depth else { return };
        let draws = |plan: &Plan| {
            let draw = |(command, _): &(usize, Range<usize>)| match &pass.commands[*command] {
                Command::Draw(geometry, state) => {
                    Some((state.clone(), intersection(geometry.clip(), state.clip)))
                }
                _ => None,
            };
            plan.pieces.iter().filter_map(draw).collect()
        };
        let jobs = plans.iter().zip(jobs).map(|(plan, job)| (job, draws(plan))).collect();
        let mut target = lock(target);
        let pending = PendingDepth::new(kind, target.viewport(), jobs, &self.workers, self.level);
        target.pending = Some(Box::new(pending));
    }

    fn item<'a>(
        &self,
        item: &PlanItem,
        pass: &'a Pass,
        plans: &[Plan],
        (first, jobs): (usize, &'a [Primitives]),
        (sampled, again): (&'a Held<'a>, &[TextureUse]),
    ) -> Item<'a> {
        let samples = pass.target.samples;

        // Walk commands as they are, and jobs with what each of their draws needs.
        match item {
            PlanItem::Command(c) => match &pass.commands[*c] {
                Command::Clear(clear) => Item::Clear(clear),
                Command::Image(image, state) => {
                    Item::Image(image, state, FragmentOps::new(state, samples))
                }
                Command::Draw(..) => unreachable!("draws are in jobs"),
            },
            PlanItem::Job(j) => {
                let draws = plans[*j].pieces.iter().filter_map(|(command, _)| {
                    match &pass.commands[*command] {
                        Command::Draw(geometry, state) => {
                            Some(draw_context(&**geometry, state, pass, (sampled, again)))
                        }
                        _ => None,
                    }
                });
                let draws = draws.collect();
                Item::Job { primitives: &jobs[*j - first], draws }
            }
        }
    }

    /// Walks all tiles. `depth` is the target's depth plane; `seen` is what was seen in each tile
    /// before, or empty.
    fn tiles(
        &self,
        target: &Target,
        depth: &mut Option<MutexGuard<'_, DepthBuffer>>,
        items: &[Item<'_>],
        seen: &mut [TexelCache],
    ) {
        // Open the planes tile by tile.
        let mut color = target.color.as_ref().map(|p| lock(p));
        let mut stencil = target.stencil.as_ref().map(|p| lock(p));
        let count = (target.viewport.tiles_x() * target.viewport.tiles_y()) as usize;
        let mut colors = color_tiles(&mut color, target.viewport);
        let scale = depth.as_ref().map_or(1.0, |d| d.scale);
        let mut depths = plane_tiles(depth.as_mut().map(|d| d.resolved()), target.viewport);
        let mut stencils = plane_tiles(stencil.as_deref_mut(), target.viewport);

        // Take the tiles in which something happens.
        let across = target.viewport.tiles_x();
        let mut tiles: Vec<(usize, TilePlanes<'_>)> = Vec::new();
        for index in 0..count {
            let (color, depth, stencil) = (colors.next(), depths.next(), stencils.next());
            if items.iter().any(|item| item.touches(index, across)) {
                let mut planes =
                    TilePlanes::new(color, depth.map(|d| (d, scale)), stencil, target.samples);
                planes.set_changed();
                tiles.push((index, planes));
            }
        }

        // The first strip of a tile that is cut is drawn in the tile, the others in copies.
        let (strips, cut) =
            cut(self.workers.threads(), tiles.iter().map(|(index, _)| *index), items);
        let others: Vec<(usize, Range<usize>)> = cut
            .iter()
            .flat_map(|&at| (1..strips).map(move |strip| (at, rows(strip, strips))))
            .collect();
        let mut copies: Vec<TileCopy> =
            others.iter().map(|(at, _)| TileCopy::of(&tiles[*at].1)).collect();
        let numbers: Vec<usize> = others.iter().map(|(at, _)| tiles[*at].0).collect();

        // Run all strips in parallel.
        let run =
            |index, rows, planes, seen| TileRun::new(index, rows, target.viewport, planes, seen);
        let mut runs = Vec::with_capacity(tiles.len() + copies.len());
        let mut seen = seen.iter_mut().enumerate();
        for (at, (index, tile)) in tiles.iter_mut().enumerate() {
            let strips = if cut.contains(&at) { strips } else { 1 };
            let seen = seen.find(|(number, _)| number == index).map(|(_, seen)| seen);
            runs.push(run(*index, rows(0, strips), tile.reborrow(), seen));
        }
        for ((index, (_, rows)), copy) in numbers.into_iter().zip(&others).zip(&mut copies) {
            runs.push(run(index, rows.clone(), copy.planes(scale, target.samples), None));
        }
        let (many, one) = (pattern(target.samples), pattern(1));
        self.workers.for_each(runs, |mut run| run.run(self.level, items, &many, &one));

        // Copy the strips back into their tiles.
        for ((at, rows), copy) in others.iter().zip(copies) {
            copy.give_back(rows, &mut tiles[*at].1);
        }
    }
}

impl Item<'_> {
    /// Whether something may happen in tile number `index` of rows of `across` tiles.
    fn touches(&self, index: usize, across: u32) -> bool {
        let meets = |[x0, y0, x1, y1]: [i32; 4]| {
            let side = TILE as i32;
            let (x, y) = (index as i32 % across as i32 * side, index as i32 / across as i32 * side);
            x0.max(x) < x1.min(x + side) && y0.max(y) < y1.min(y + side)
        };
        match self {
            Item::Clear(clear) => meets(clear.clip),
            Item::Image(image, state, _) => meets(image.bounds(state.clip)),
            Item::Job { primitives, .. } => !primitives.batch.tile_range(index).is_empty(),
        }
    }
}

/// The pixels of both: x0, y0, x1, y1.
pub(super) fn intersection(a: [i32; 4], b: [i32; 4]) -> [i32; 4] {
    [a[0].max(b[0]), a[1].max(b[1]), a[2].min(b[2]), a[3].min(b[3])]
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Locks the depth planes that a pass samples, and the one that it draws to, in the order of their
/// addresses: passes of other threads, which may draw to what this one samples, do the same.
fn hold<'a>(
    sampled: &'a [Arc<Mutex<DepthBuffer>>],
    drawn: Option<&'a Arc<Mutex<DepthBuffer>>>,
) -> (Held<'a>, Option<MutexGuard<'a, DepthBuffer>>) {
    let held = |plane: &'a Arc<Mutex<DepthBuffer>>| (Arc::as_ptr(plane), lock(plane));
    let before = |plane: &Arc<Mutex<DepthBuffer>>| {
        drawn.is_some_and(|drawn| Arc::as_ptr(plane) < Arc::as_ptr(drawn))
    };
    let (before, behind) = sampled.split_at(sampled.partition_point(before));
    let mut all: Held<'a> = before.iter().map(held).collect();
    let depth = drawn.map(|plane| lock(plane));
    all.extend(behind.iter().map(held));
    (all, depth)
}

/// The target's tiles of the colour plane, one after the other; none if there is no plane.
fn color_tiles<'a>(
    plane: &'a mut Option<MutexGuard<'_, ColorPlane>>,
    target: Viewport,
) -> Box<dyn Iterator<Item = ColorTile<'a>> + 'a> {
    match plane.as_deref_mut() {
        None => Box::new(std::iter::empty()),
        Some(ColorPlane::Rgba8(p)) => Box::new(plane_tiles(Some(p), target).map(ColorTile::Rgba8)),
        Some(ColorPlane::RgbaF32(p)) => {
            Box::new(plane_tiles(Some(p), target).map(ColorTile::RgbaF32))
        }
    }
}

/// The tiles of a plane that lie in a target, which may be smaller.
fn plane_tiles<T: Copy>(
    plane: Option<&mut Plane<T>>,
    target: Viewport,
) -> impl Iterator<Item = &mut PlaneTile<T>> {
    let across = plane.as_ref().map_or(1, |p| p.viewport().tiles_x() as usize);
    let (x, y) = (target.tiles_x() as usize, target.tiles_y() as usize);
    let tiles = plane.map_or([].iter_mut(), |p| p.tiles.iter_mut());
    tiles.enumerate().filter(move |(i, _)| i % across < x && i / across < y).map(|(_, tile)| tile)
}

fn draw_context<'a>(
    geometry: &'a dyn Geometry,
    state: &'a FragmentState,
    pass: &Pass,
    (sampled, again): (&'a Held<'a>, &[TextureUse]),
) -> DrawContext<'a> {
    // Borrow the depth planes that the draw samples.
    let mut planes = [None; UNITS];
    for unit in &state.units {
        if let Some(plane) = unit.texture.sole_plane() {
            let guard = sampled.iter().find(|(p, _)| *p == Arc::as_ptr(plane));
            planes[unit.index % UNITS] = guard.map(|(_, guard)| &**guard);
        }
    }

    // Pack the textures that eight or sixteen lanes can sample at once.
    let plain = state.units.iter().filter(|unit| unit.texture.sampler.anisotropy <= 1.0);
    let plain: Vec<(usize, PackedTexture<'_>)> = plain
        .filter_map(|unit| {
            Some((unit.index, PackedTexture::new(&unit.texture, planes[unit.index % UNITS])?))
        })
        .collect();
    let is_flat = |shown: &TextureUse| {
        plain
            .iter()
            .any(|(unit, common)| *unit == shown.unit && matches!(common, PackedTexture::Flat(_)))
    };

    // Find the texture whose colours are kept for repeated draws.
    let again = texture_uses(geometry, state).find(|shown| is_flat(shown) && again.contains(shown));

    // Decide which fragment operations need colours.
    let samples = pass.target.samples;
    let clip = intersection(geometry.clip(), state.clip);
    let decides = state.alpha_test.is_some() || (state.alpha_to_coverage && samples > 1);
    let decides = decides || geometry.layout().line_stipple.is_some();
    let shaded = decides || (pass.target.color.is_some() && state.masked != [true; 4]);
    DrawContext {
        geometry,
        state,
        layout: geometry.layout(),
        ops: FragmentOps::new(state, samples),
        clip,
        multisample: samples > 1 && state.multisample,
        shaded,
        unlimited: state.clamping == Clamping::None
            && (state.unclamped_vertices || state.units.iter().any(|unit| unit.texture.is_float())),
        constant: geometry.layout().uniform
            || (state.flat && state.units.is_empty() && state.fog.is_none() && !state.color_sum),
        again: again.map(|shown| shown.unit),
        plain,
        planes,
    }
}

/// The depth planes that are held for the whole pass, each once, in the order of their addresses:
/// those that draws sample as textures of one level. Others are locked at each lookup, and must not
/// be held besides.
fn sampled_planes(commands: &[Command]) -> Vec<Arc<Mutex<DepthBuffer>>> {
    // Collect the planes that draws sample, those of one level apart.
    let (mut sole, mut others): (Vec<_>, Vec<_>) = (Vec::new(), Vec::new());
    for command in commands {
        let (Command::Draw(_, state) | Command::Image(_, state)) = command else { continue };
        for unit in &state.units {
            let drawn = matches!(command, Command::Draw(..));
            match unit.texture.sole_plane().filter(|_| drawn) {
                Some(plane) => sole.push(plane),
                None => others.extend(unit.texture.planes()),
            }
        }
    }

    // Keep each sole plane once, in the order of addresses, so that locks cannot deadlock.
    sole.retain(|plane| !others.iter().any(|other| Arc::ptr_eq(plane, other)));
    sole.sort_by_key(|plane| Arc::as_ptr(plane));
    sole.dedup_by(|a, b| Arc::ptr_eq(a, b));
    sole.into_iter().cloned().collect()
}

/// The facet of a setup.
pub(crate) fn facet_of(primitives: &Primitives, number: u32) -> &Facet {
    &primitives.facets[number as usize]
}
