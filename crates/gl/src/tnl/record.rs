//! Recording: draws and other commands gather in a pass, which runs when the target changes or
//! someone looks. Of a long stream of vertices, the recorded part runs while the calling thread
//! takes in more.
//!
//! A picture that is left for a shadow map and gone on with is one pass: tiles are visited once,
//! and what they drew without the light is still at hand when they add it.

use super::geometry::{DrawGeometry, PointSizes};
use super::snapshot::{FogSource, Generation, LightCache, VertexSnapshot};
use crate::Context;
use crate::enums as gl;
use crate::state;
use crate::vertex::{CurrentState, Submission, VertexBatch};
use std::sync::{Arc, PoisonError};
use vitral_exec::{Started, Workers};
use vitral_math::Vec4;
use vitral_math::lanes::Level;
use vitral_raster::forward::{
    Command, FragmentState, Layout, NO_GRID, Pass, PrimitiveState, Runner, Target, WindowTransform,
};

/// Gives the threads that run passes; asked each time, since a process may have forked.
pub type RunnerSource = fn() -> Arc<Runner>;

/// Recorded passes that have not run.
#[derive(Default)]
pub(crate) struct Recorder {
    pass: Option<Pass>,
    /// A pass that was left for a shadow map, to be gone on with: so far, neither needs what the
    /// other draws.
    aside: Option<Pass>,
    source: Option<RunnerSource>,
    own: Option<Arc<Runner>>,
    lights: LightCache,
    /// Vertices that wait.
    waiting: usize,
    /// Bytes of images that came while something waits: what waits may be all that needs those
    /// before.
    images: usize,
    /// What runs while more is recorded: all that was recorded before.
    ahead: Option<Started>,
}

impl std::fmt::Debug for Recorder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Recorder").field("pass", &self.pass).finish_non_exhaustive()
    }
}

/// Most vertices that wait before they are drawn.
const MOST_WAITING: usize = 8 << 20;

/// Most commands that wait before they are drawn: each keeps some 2 KiB of state.
const MOST_COMMANDS: usize = 1 << 14;

/// Most bytes of images that come before what waits is drawn. A program that gives a texture new
/// images draw by draw would else fill the memory with those that it had.
const MOST_IMAGES: usize = 64 << 20;

impl Recorder {
    fn runner(&mut self) -> Arc<Runner> {
        match self.source {
            Some(source) => source(),
            None => self
                .own
                .get_or_insert_with(|| Arc::new(Runner::new(Workers::single(), Level::new())))
                .clone(),
        }
    }

    /// Runs everything.
    fn run(&mut self) {
        (self.waiting, self.images) = (0, 0);
        self.finish_ahead();
        for pass in [self.aside.take(), self.pass.take()].into_iter().flatten() {
            self.runner().run(&pass);
        }
    }

    fn finish_ahead(&mut self) {
        if let Some(ahead) = self.ahead.take() {
            ahead.wait();
        }
    }

    /// Makes way for commands on another target.
    fn turn_to(&mut self, target: &Target) {
        if let Some(aside) = self.aside.as_ref().filter(|aside| aside.target.same(target)) {
            let asks =
                |map: &Pass| aside.target.depth.as_ref().is_some_and(|depth| map.samples(depth));
            if self.pass.as_ref().is_some_and(asks) {
                // The map is to show what the picture draws.
                return self.run();
            }
            if let Some(map) = self.pass.take() {
                self.runner().run(&map);
            }
            self.pass = self.aside.take();
            return;
        }
        if self.aside.is_none()
            && let Some(picture) = self.pass.take_if(|pass| may_wait_for(pass, target))
        {
            self.finish_ahead();
            self.aside = Some(picture);
            return;
        }
        self.run();
    }

    /// Starts the recorded draws while more come, unless those recorded before are still running.
    /// Depths alone are left to be drawn where they are looked at.
    fn start(&mut self) {
        // Wait for nothing: skip if the last part still runs, or if there are no colours to draw.
        if self.ahead.as_ref().is_some_and(|ahead| !ahead.is_done()) {
            return;
        }
        let runner = self.runner();
        if self.pass.as_ref().is_none_or(|pass| pass.target.color.is_none()) {
            return;
        }

        // Hand the recorded commands to a worker.
        self.finish_ahead();
        let Some(pass) = self.pass.as_mut() else { return };
        let commands = std::mem::take(&mut pass.commands);
        let recorded = Pass { target: pass.target.clone(), commands };
        let workers = runner.workers.clone();
        match workers.start(move || runner.run(&recorded)) {
            Ok(ahead) => self.ahead = Some(ahead),
            Err(run) => run(),
        }
        (self.waiting, self.images) = (0, 0);
    }
}

impl Context {
    /// Where the threads come from that run passes. Without it the calling thread works alone.
    pub fn set_runner_source(&mut self, source: RunnerSource) {
        self.recorder.source = Some(source);
    }

    /// The threads that run passes, for other work on planes.
    pub(crate) fn workers(&self) -> Workers {
        self.recorder.source.map_or_else(Workers::single, |source| source().workers.clone())
    }

    /// Records the drawing of `batch` with a snapshot of the state.
    pub(crate) fn record_draw(
        &mut self,
        batch: Arc<VertexBatch>,
        sent: Submission,
        given: &CurrentState,
    ) {
        if !self.draw_framebuffer_complete("draw") {
            return;
        }
        let area = self.drawn_area(&batch, given);
        let Some(target) = self.draw_target(area) else { return };
        let fragment = self.fragment_state_for(Some(&target), false);
        let count = batch.positions.len();
        let Some(geometry) = self.draw_geometry(batch, sent, given, &fragment, &target) else {
            return;
        };
        self.record_on(target, Command::Draw(Arc::new(geometry), fragment));
        self.recorder.waiting += count;
    }

    /// Records a command on the current draw target.
    pub(crate) fn record(&mut self, command: Command) {
        let area = match &command {
            Command::Clear(clear) => Some(clear.clip),
            Command::Image(image, state) => Some(image.bounds(state.clip)),
            Command::Draw(..) => None,
        };
        let Some(target) = self.draw_target(area) else { return };
        self.record_on(target, command);
    }

    fn record_on(&mut self, target: Target, command: Command) {
        let commands = self.recorder.pass.as_ref().map_or(0, |pass| pass.commands.len());
        if self.recorder.waiting > MOST_WAITING || commands >= MOST_COMMANDS {
            self.recorder.run();
        }
        if self.recorder.pass.as_ref().is_some_and(|pass| !pass.target.same(&target)) {
            self.recorder.turn_to(&target);
        }
        let pass = self.recorder.pass.get_or_insert_with(|| Pass { target, commands: Vec::new() });
        pass.commands.push(command);
    }

    /// Says that an image of that many bytes has come, for a texture or to be drawn.
    pub(crate) fn image_came(&mut self, bytes: usize) {
        if self.recorder.pass.is_some() || self.recorder.aside.is_some() {
            self.recorder.images = self.recorder.images.saturating_add(bytes);
            if self.recorder.images > MOST_IMAGES {
                self.recorder.run();
            }
        }
    }

    /// Has everything recorded run while the caller gives more.
    pub(crate) fn start_recorded(&mut self) {
        self.recorder.start();
    }

    /// Runs everything recorded: afterwards all planes and queries are up to date.
    pub(crate) fn flush_recorded(&mut self) {
        self.flush_vertices();
        self.recorder.run();
    }

    /// The current per-fragment state. `images` leaves out what does not apply to pixel rectangles
    /// (polygon stipple).
    pub(crate) fn fragment_state(&mut self, images: bool) -> Arc<FragmentState> {
        let target = self.target();
        self.fragment_state_for(target.as_ref(), images)
    }

    /// The snapshot for the vertex stages; `None` if nothing can be drawn.
    fn draw_geometry(
        &mut self,
        batch: Arc<VertexBatch>,
        sent: Submission,
        given: &CurrentState,
        fragment: &FragmentState,
        target: &Target,
    ) -> Option<DrawGeometry> {
        // Decide what the fragments need.
        let colored = target.color.is_some() && fragment.masked != [true; 4];
        let samples = target.samples > 1;
        let shaded =
            colored || fragment.alpha_test.is_some() || (fragment.alpha_to_coverage && samples);
        let units: Vec<usize> =
            if shaded { fragment.units.iter().map(|u| u.index).collect() } else { Vec::new() };
        let fog = shaded && fragment.fog.is_some();

        // Take the snapshot of the vertex stages and lay vertex records out.
        let mut snapshot =
            VertexSnapshot::new(&self.state, given, &units, fog, &mut self.recorder.lights);
        snapshot.clamps = !fragment.unclamped_vertices;
        let mut layout =
            if shaded { self.layout(fragment, &units, samples) } else { Layout::default() };

        // Triangulate all but small batches that are drawn at once.
        let primitive = self.primitive_state(fragment, target)?;
        let small = sent == Submission::Now && batch.is_small();
        let triangulation = (!small).then(|| batch.triangulation.get(&batch));
        // A flat grid becomes a rectangle where all that varies on it is linear.
        let flat = triangulation.as_ref().is_some_and(|triangulation| triangulation.grid.is_some());
        let grid = flat && self.draws_grids(&snapshot, &primitive, fragment);
        if grid && snapshot.fog == Some(FogSource::Depth) {
            snapshot.fog = Some(FogSource::Ahead);
        }

        // Use one colour for all fragments if nothing varies it.
        let colors_alone = shaded && layout.stride == layout.color + 4;
        layout.uniform = colors_alone && snapshot.lighting.is_none() && batch.colors.is_none();
        if grid && shaded && snapshot.lighting.is_some() {
            layout.grid = Some(layout.stride);
            layout.stride += 2;
        }

        // Collect the sizes of points.
        let s = &self.state;
        let multisample = s.multisample && samples;
        let points = PointSizes {
            size: s.points.size,
            limits: s.points.limits,
            attenuation: s.points.attenuation,
            fade: multisample.then_some(s.points.fade_threshold),
        };
        let first_diagonal = sent == Submission::Now && batch.indices.is_none() && !fragment.flat;
        Some(DrawGeometry {
            triangulation,
            batch,
            grid,
            first_diagonal,
            snapshot,
            primitive,
            layout,
            points,
        })
    }

    /// Whether everything that varies on a flat grid is linear, but the colours of one side.
    fn draws_grids(
        &self,
        snapshot: &VertexSnapshot,
        primitive: &PrimitiveState,
        fragment: &FragmentState,
    ) -> bool {
        let lit = snapshot.lighting.as_ref();
        // What a perspective projection shows lies ahead.
        let ahead = self.state.matrices.projection.top().row(3) == Vec4::NEG_Z;
        primitive.polygon_mode == [2, 2]
            && !primitive.polygon_smooth
            && !(lit.is_some() && fragment.flat)
            && lit.is_none_or(|lighting| !lighting.two_side && !lighting.separate_specular)
            && snapshot.units.iter().flat_map(|unit| &unit.generation).all(Generation::is_linear)
            && snapshot.fog.is_none_or(|fog| fog.is_linear() || (ahead && fog == FogSource::Depth))
    }

    /// Where vertex records hold what. `samples`: the target has several a pixel.
    fn layout(&self, fragment: &FragmentState, units: &[usize], samples: bool) -> Layout {
        // Lay colours out, then fog and texture coordinates.
        let s = &self.state;
        let two_side = s.lighting.enabled && s.lighting.model.two_side;
        let mut next = 1;
        let mut take = |count: usize| {
            next += count;
            next - count
        };
        let mut layout = Layout { color: take(4), ..Layout::default() };
        layout.secondary = fragment.color_sum.then(|| take(3));
        layout.back_color = two_side.then(|| take(4));
        layout.back_secondary = (two_side && fragment.color_sum).then(|| take(3));
        layout.fog = fragment.fog.is_some().then(|| take(1));
        for &unit in units {
            layout.tex[unit] = Some(take(4));
            if s.points.sprite && s.units[unit].environment.coord_replace {
                layout.sprites |= 1 << unit;
            }
        }

        // Decide which primitives are smooth.
        layout.stride = next;
        let sharp = s.multisample && samples;
        layout.smooth = [
            s.points.smooth && !sharp && !s.points.sprite,
            s.lines.smooth && !sharp,
            s.polygons.smooth && !sharp,
        ];
        layout.line_stipple = s.lines.stipple.then_some(s.lines.pattern);
        layout
    }

    fn primitive_state(&self, fragment: &FragmentState, target: &Target) -> Option<PrimitiveState> {
        let s = &self.state;

        // Find the transform to the window.
        let [x, y, w, h] = s.viewport.rect;
        if w <= 0 || h <= 0 {
            return None;
        }
        let (origin, depth_mode) = s.clip_control;
        let flipped = origin == gl::UPPER_LEFT;
        let range = [s.viewport.depth_range.near, s.viewport.depth_range.far];
        let window =
            WindowTransform::new([x, y, w, h], range, depth_mode == gl::ZERO_TO_ONE, flipped);

        // Translate culling and polygon modes.
        let culled = |face: u32| {
            s.polygons.cull
                && (s.polygons.cull_mode == face || s.polygons.cull_mode == gl::FRONT_AND_BACK)
        };
        let mode = |token: u32| match token {
            gl::POINT => 0,
            gl::LINE => 1,
            _ => 2,
        };

        // Limit the pixels to scissor and viewport.
        let multisample = s.multisample && target.samples > 1;
        let offset =
            |k: usize| if s.polygons.offset_enabled[k] { s.polygons.offset } else { [0.0; 2] };
        let c = fragment.clip;
        let clip = [
            c[0].max(x),
            c[1].max(y),
            c[2].min(x.saturating_add(w)),
            c[3].min(y.saturating_add(h)),
        ];
        Some(PrimitiveState {
            window,
            user_planes: s.clip_plane_enabled.iter().filter(|e| **e).count(),
            depth_clamp: s.depth_clamp,
            counter_clockwise: s.polygons.front_face == gl::CCW,
            flipped,
            cull: [culled(gl::FRONT), culled(gl::BACK)],
            offset: [offset(0), offset(1), offset(2)],
            depth_step: depth_step(target),
            polygon_mode: s.polygons.mode.map(mode),
            line_width: s.lines.width.clamp(1.0, state::MAX_POINT_SIZE),
            line_smooth: s.lines.smooth && !multisample,
            multisample,
            polygon_smooth: s.polygons.smooth && !multisample,
            point_sprite: s.points.sprite,
            point_smooth: s.points.smooth && !multisample && !s.points.sprite,
            clip,
            stroke_clip: c,
            draw: 0,
            grid: NO_GRID,
        })
    }
}

/// Whether a pass can wait while `target`, a shadow map, is drawn: it is a picture that does not
/// need the target's present contents.
fn may_wait_for(pass: &Pass, target: &Target) -> bool {
    let Some(map) = target.depth.as_ref().filter(|_| target.color.is_none()) else { return false };
    let same = pass.target.depth.as_ref().is_some_and(|depth| Arc::ptr_eq(depth, map));
    let sampled = map.lock().unwrap_or_else(PoisonError::into_inner).sampled;
    let stencil = |target: &Target| target.stencil.as_ref().map(Arc::as_ptr);
    let apart = stencil(target).is_none() || stencil(target) != stencil(&pass.target);
    pass.target.color.is_some() && sampled && !same && apart && !pass.samples(map)
}

/// The unit of polygon offset in a fixed-point depth plane: two of its steps, since rounding may
/// swallow part of one. 0 for floating point.
fn depth_step(target: &Target) -> f32 {
    if target.depth_scale == 1.0 { 0.0 } else { 2.0 / (target.depth_scale + 1.0) }
}
