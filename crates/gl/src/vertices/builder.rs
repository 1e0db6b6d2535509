//! Begin/End: gathers vertices as they are given.
//!
//! An attribute gets an array once it has been given since Begin; if that is after the first
//! vertex, the earlier ones are filled with the value that was current until then. What was never
//! given stays `None`: the current value holds for all. So a vertex costs one push for each
//! attribute in use.
//!
//! If the caller promises to announce every call that changes what primitives are drawn with
//! ([`Context::set_merging`]), Begin/End pairs gather in one batch until then. Modelview matrices
//! and materials may change in between: they are kept with the vertices. Small batches from lists
//! and arrays gather with them; one that stays alone is drawn as it is. A long batch is
//! drawn while more is given; for that, long primitives whose elements share no vertices are cut.

use super::attribute::{CARRIED, COLOR};
use crate::primitive::is_independent;
use crate::state::Current;
use crate::vertex::{CurrentState, Submission, VertexBatch};
use crate::{Context, enums};
use std::sync::Arc;
use vitral_math::Mat4;

/// Vertices of a batch that waits for no more: whole points, lines, triangles and quadrilaterals.
const LONG_ENOUGH: usize = 12 * 2730;

/// How many batches are kept for their memory.
const MOST_KEPT: usize = 16;

/// Vertices of a batch whose memory is reused: fewer cost nothing to allocate, more are too much to
/// keep.
const REUSED: std::ops::Range<usize> = 1 << 10..1 << 21;

/// The primitive that is being given, and complete ones before it.
#[derive(Debug, Default)]
pub(crate) struct Builder {
    pub(crate) batch: VertexBatch,
    /// Attributes that have arrays in `batch`.
    pub(crate) seen: u32,
    open: bool,
    /// A Begin is open, or complete primitives wait to be drawn.
    gathering: bool,
    /// Whether complete primitives may wait, for more that are drawn alike.
    merging: bool,
    mode: u32,
    first: u32,
    /// With so many vertices the open primitive is long.
    pub(super) most: usize,
    /// Whether gathered primitives are cut like those of single draws.
    sent: Submission,
    /// As it was at the first Begin.
    given: CurrentState,
    /// The modelview matrix may have changed since the last Begin.
    moved: bool,
    /// All that is gathered: a batch that somebody else holds, too. Nothing is in `batch` then.
    lone: Option<Arc<VertexBatch>>,
    /// Batches being drawn. The memory of a drawn batch is reused for a later one.
    pub(super) drawn: Vec<Arc<VertexBatch>>,
    /// Empty vectors with memory, for the attributes of `batch`.
    spare: VertexBatch,
    /// What was drawn.
    #[cfg(test)]
    pub(crate) log: Vec<Arc<VertexBatch>>,
}

impl Builder {
    /// Whether a Begin is open.
    #[inline(always)]
    pub(crate) fn is_open(&self) -> bool {
        self.open
    }

    /// Mode of the open primitive.
    pub(crate) fn mode(&self) -> u32 {
        self.mode
    }

    /// First vertex of the open primitive.
    pub(crate) fn first(&self) -> usize {
        self.first as usize
    }

    /// Begins a primitive.
    pub(crate) fn open(&mut self, mode: u32) {
        self.open = true;
        self.gathering = true;
        self.mode = mode;
        self.first = self.batch.positions.len() as u32;
        self.most = self.batch.positions.len() + LONG_ENOUGH;
    }

    /// Ends the primitive.
    pub(crate) fn close(&mut self) {
        self.open = false;
        let count = self.batch.positions.len() as u32 - self.first;
        self.batch.add_primitive(self.mode, self.first, count);
    }

    /// Adds the primitives of a batch.
    fn add(&mut self, batch: &VertexBatch, current: &Current) {
        for which in batch.attributes() {
            self.see(which, current);
        }
        for primitive in &batch.primitives {
            self.open(primitive.mode);
            self.batch.append(batch, primitive.first..primitive.first + primitive.count, current);
            self.close();
        }
    }

    /// Forgets the open primitive, but not its vertices.
    pub(crate) fn abandon(&mut self) {
        self.open = false;
    }

    /// Begins a batch, in the memory of a drawn one if nobody else holds that.
    fn start(&mut self) {
        let free = self.drawn.iter().position(|drawn| Arc::strong_count(drawn) == 1);
        let Some(drawn) = free.and_then(|free| Arc::into_inner(self.drawn.swap_remove(free)))
        else {
            return;
        };
        let (spare, batch) = (&mut self.spare, &mut self.batch);
        *spare = drawn;
        spare.truncate_vertices(0);
        spare.materials.clear();
        spare.modelviews.clear();
        spare.primitives.clear();
        batch.positions = std::mem::take(&mut spare.positions);
        batch.materials = std::mem::take(&mut spare.materials);
        batch.modelviews = std::mem::take(&mut spare.modelviews);
        batch.primitives = std::mem::take(&mut spare.primitives);
    }

    /// Keeps a batch that is drawn, for its memory.
    fn keep(&mut self, batch: &Arc<VertexBatch>) {
        if !REUSED.contains(&batch.positions.len()) {
            return;
        }
        self.drawn.push(Arc::clone(batch));
        let size = |drawn: &[Arc<VertexBatch>]| {
            drawn.iter().map(|kept| kept.positions.len()).sum::<usize>()
        };
        while self.drawn.len() > MOST_KEPT || size(&self.drawn) > REUSED.end {
            self.drawn.remove(0);
        }
    }

    /// Notes that primitives are given with this modelview matrix from here on.
    fn set_modelview(&mut self, modelview: Mat4) {
        let n = self.batch.positions.len() as u32;
        let all = &mut self.batch.modelviews;
        if all.last().map_or(&self.given.modelview, |(_, last)| last) == &modelview {
            return;
        }
        match all.last_mut() {
            Some((from, last)) if *from == n => *last = modelview,
            None if n == 0 => self.given.modelview = modelview,
            last => {
                if last.is_none() {
                    all.push((0, self.given.modelview));
                }
                all.push((n, modelview));
            }
        }
    }

    /// Hands out what was gathered.
    pub(crate) fn take(&mut self) -> VertexBatch {
        self.gathering = self.open;
        self.seen = 0;
        self.first = 0;
        std::mem::take(&mut self.batch)
    }

    /// Adds a vertex with the attributes of `current` that are in use.
    #[inline(always)]
    pub(crate) fn vertex(&mut self, position: [f32; 4], current: &Current) {
        self.batch.positions.push(position);
        if self.seen != 0 {
            self.push_seen(current);
        }
    }

    /// Adds what the last vertex has besides its position.
    #[inline(never)]
    pub(super) fn push_seen(&mut self, current: &Current) {
        self.batch.push_attributes(self.seen, current);
    }

    /// Whether attribute `which` may change as it is: it has an array, or nothing is being
    /// gathered.
    #[inline(always)]
    pub(super) fn holds(&self, which: usize) -> bool {
        !self.gathering || self.seen >> which & 1 == 1
    }

    /// Makes sure that attribute `which` has an array, before `current` changes.
    #[inline(always)]
    pub(crate) fn see(&mut self, which: usize, current: &Current) {
        let bit = 1 << which;
        if self.seen & bit == 0 && CARRIED & bit != 0 {
            self.batch.back_fill(which, current, &mut self.spare);
            self.seen |= bit;
        }
    }
}

impl Context {
    /// Whether a Begin is open, of the immediate stream.
    pub(crate) fn inside_begin(&self) -> bool {
        self.builder.is_open()
    }

    /// Records `INVALID_OPERATION` if a Begin is open.
    pub(crate) fn refused_inside_begin(&mut self, call: &str) -> bool {
        let inside = self.inside_begin();
        if inside {
            self.record_error(
                enums::INVALID_OPERATION,
                call,
                "not allowed between glBegin and glEnd",
            );
        }
        inside
    }

    pub(super) fn exec_begin(&mut self, mode: u32) {
        if self.inside_begin() {
            self.record_error(enums::INVALID_OPERATION, "glBegin", "a glBegin is open already");
        } else if mode > enums::POLYGON {
            self.record_error(
                enums::INVALID_ENUM,
                "glBegin",
                &format!("mode {mode:#x} is not a primitive"),
            );
        } else if !self.refused_by_framebuffer("glBegin") {
            self.gather(Submission::Now);
            self.builder.open(mode);
        }
    }

    /// Notes the current state for a primitive that begins.
    pub(super) fn gather(&mut self, sent: Submission) {
        if self.builder.sent != sent {
            self.flush_vertices();
        }
        self.take_in_lone();
        let builder = &mut self.builder;
        if !builder.gathering {
            builder.start();
            builder.gathering = true;
            builder.sent = sent;
            builder.given = CurrentState::current(&self.state);
        } else if builder.moved {
            builder.set_modelview(self.state.matrices.modelview.top());
        }
        builder.moved = false;
    }

    /// Puts a batch that was gathered alone with those that come.
    #[inline]
    fn take_in_lone(&mut self) {
        let builder = &mut self.builder;
        if let Some(lone) = builder.lone.take() {
            builder.start();
            builder.add(&lone, &self.state.current);
            if builder.given.material != self.state.lighting.material {
                self.material_changed();
            }
        }
    }

    /// Whether a batch is gathered rather than drawn; if so, it has been.
    pub(super) fn gathers(&mut self, batch: &Arc<VertexBatch>, sent: Submission) -> bool {
        if !batch.is_small() || !self.builder.merging || self.feedback.mode != enums::RENDER {
            return false;
        }
        if batch.primitives.is_empty() {
            return true;
        }
        // Indexed batches are cut like those of display lists.
        let sent = if batch.indices.is_some() { Submission::Listed } else { sent };
        if !self.builder.gathering {
            let given = CurrentState::current(&self.state);
            let builder = &mut self.builder;
            (builder.sent, builder.given, builder.moved) = (sent, given, false);
            (builder.lone, builder.gathering) = (Some(Arc::clone(batch)), true);
            return true;
        }
        self.gather(sent);
        let builder = &mut self.builder;
        builder.add(batch, &self.state.current);
        if builder.batch.positions.len() >= LONG_ENOUGH {
            self.draw_long();
        }
        true
    }

    pub(super) fn exec_end(&mut self) {
        if !self.inside_begin() {
            self.record_error(enums::INVALID_OPERATION, "glEnd", "no glBegin is open");
            return;
        }
        self.builder.close();
        if !self.builder.merging || self.feedback.mode != enums::RENDER {
            self.flush_vertices();
        } else if self.builder.batch.positions.len() >= LONG_ENOUGH {
            self.draw_long();
        }
    }

    /// Whether Begin/End pairs may wait for more. The caller then has to call
    /// [`Self::flush_vertices`] before every call but those that leave them waiting, or draw them
    /// where they must be: `begin`, `end`, `array_element`, all that give a vertex or set one of
    /// its attributes, matrices and materials, client arrays and draws from them, lists that are
    /// called, `enable`, `disable`, `bind_texture`, `shade_model`, names for selection, `get_...v`
    /// and `is_enabled`.
    pub fn set_merging(&mut self, merging: bool) {
        self.flush_vertices();
        self.builder.merging = merging;
    }

    /// Draws the primitives that wait. Does nothing between Begin and End.
    #[inline]
    pub fn flush_vertices(&mut self) {
        if self.builder.gathering && !self.builder.open {
            self.draw_gathered();
        }
    }

    /// To be called before a modelview matrix changes.
    pub(crate) fn modelview_changes(&mut self) {
        self.builder.moved = true;
    }

    /// Draws what the builder holds.
    #[inline(never)]
    pub(super) fn draw_gathered(&mut self) {
        let builder = &mut self.builder;
        let batch = match builder.lone.take() {
            Some(lone) => {
                builder.gathering = false;
                lone
            }
            None => {
                let batch = Arc::new(builder.take());
                builder.keep(&batch);
                batch
            }
        };
        let (sent, given) = (builder.sent, builder.given);
        self.draw_batch(batch, sent, &given);
    }

    #[inline(always)]
    pub(super) fn exec_vertex(&mut self, position: [f32; 4]) {
        if self.builder.is_open() {
            if self.builder.batch.positions.len() == self.builder.most {
                self.cut();
            }
            self.builder.vertex(position, &self.state.current);
        }
    }

    /// Draws what waits, while more is given.
    fn draw_long(&mut self) {
        self.flush_vertices();
        self.start_recorded();
    }

    /// Draws what there is of a long primitive whose elements share no vertices, and goes on with
    /// it.
    #[cold]
    #[inline(never)]
    fn cut(&mut self) {
        let builder = &mut self.builder;
        builder.most += LONG_ENOUGH;
        if !builder.merging || self.feedback.mode != enums::RENDER || !is_independent(builder.mode)
        {
            return;
        }
        let (mode, sent) = (builder.mode, builder.sent);
        builder.close();
        self.draw_long();
        self.gather(sent);
        self.builder.open(mode);
    }

    #[inline(always)]
    pub(super) fn exec_attribute(&mut self, which: usize, value: [f32; 4]) {
        if self.builder.gathering {
            self.sees(which);
        }
        self.state.current.set(which, value);
        if which == COLOR && self.state.lighting.color_material.enabled {
            self.follow_color();
        }
    }

    /// Keeps the value of an attribute for the gathered vertices, before it changes.
    #[inline(always)]
    fn sees(&mut self, which: usize) {
        if let Some(lone) = &self.builder.lone {
            if lone.has(which) {
                return;
            }
            self.take_in_lone();
        }
        self.builder.see(which, &self.state.current);
    }

    /// Sets the material properties that `COLOR_MATERIAL` ties to the current colour.
    pub(crate) fn follow_color(&mut self) {
        let color = self.state.current.color;
        let lighting = &mut self.state.lighting;
        let faces = match lighting.color_material.face {
            enums::FRONT => 0..1,
            enums::BACK => 1..2,
            _ => 0..2,
        };
        for material in &mut lighting.material[faces] {
            match lighting.color_material.mode {
                enums::AMBIENT => material.ambient = color,
                enums::DIFFUSE => material.diffuse = color,
                enums::SPECULAR => material.specular = color,
                enums::EMISSION => material.emission = color,
                _ => (material.ambient, material.diffuse) = (color, color),
            }
        }
    }

    /// To be called when `Material` has changed the materials: between vertices they are kept with
    /// the batch.
    pub(crate) fn material_changed(&mut self) {
        if !self.builder.gathering || self.builder.lone.is_some() {
            return;
        }
        let builder = &mut self.builder;
        let n = builder.batch.positions.len() as u32;
        let materials = &mut builder.batch.materials;
        if materials.is_empty() && n > 0 {
            materials.push((0, builder.given.material));
        }
        match materials.last_mut() {
            Some((from, material)) if *from == n => *material = self.state.lighting.material,
            _ => materials.push((n, self.state.lighting.material)),
        }
    }
}
