//! Compiling a display list.
//!
//! Begin..End pairs with nothing but attributes between them gather in one batch. The compiler
//! knows the attributes that were set earlier in the same list; all others are those that are
//! current when the list is executed, and have no array. Where such an attribute is first set, what
//! came before cannot share its batch: complete primitives become a batch of their own; a primitive
//! that is open with vertices is written out call by call, as is one with other calls inside, or
//! without its End.

use super::attribute::{CARRIED, each};
use super::builder::Builder;
use super::merge::merge_equal;
use crate::Context;
use crate::enums;
use crate::memory::can_have;
use crate::state::Current;
use crate::vertex::VertexBatch;
use std::sync::Arc;

/// A call kept for later.
pub(crate) type Call = Box<dyn Fn(&mut Context) + Send + Sync>;

/// One step of a display list.
pub(crate) enum Item {
    /// Any call, before which what waits is drawn.
    Call(Call),
    /// A call that leaves it waiting.
    Keeping(Call),
    /// Complete primitives.
    Batch(Arc<VertexBatch>),
    /// Sets a current attribute.
    Attribute(usize, [f32; 4]),
    /// `Begin`, of a primitive that is written out call by call.
    Begin(u32),
    /// `Vertex`.
    Vertex([f32; 4]),
    /// `End`.
    End,
}

impl std::fmt::Debug for Item {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Call(_) | Self::Keeping(_) => f.write_str("Call"),
            Self::Batch(batch) => write!(f, "Batch of {} vertices", batch.positions.len()),
            Self::Attribute(which, value) => write!(f, "Attribute {which} {value:?}"),
            Self::Begin(mode) => write!(f, "Begin {mode}"),
            Self::Vertex(position) => write!(f, "Vertex {position:?}"),
            Self::End => f.write_str("End"),
        }
    }
}

/// A list on its way.
#[derive(Debug, Default)]
pub(crate) struct Compiler {
    items: Vec<Item>,
    builder: Builder,
    /// Attributes, as far as `known`.
    values: Current,
    /// Those set in this list, with no call since that might have changed them.
    known: u32,
    /// Those that have to be set after the pending batch.
    changed: u32,
    /// The open primitive is written out call by call.
    single: bool,
    /// A primitive without vertices ended, which draws nothing but may be an error.
    empty: bool,
    /// There is no memory for more: nothing is kept.
    out_of_memory: bool,
}

/// Vertices or items from which on memory for more is asked for before it is taken.
const LONG: usize = 1 << 16;

/// The call that remains of a draw of nothing: called between Begin and End, or with an incomplete
/// framebuffer, even that is an error.
pub(super) fn drawing_nothing(call: &'static str) -> Call {
    Box::new(move |c| {
        let _ = c.refused_inside_begin(call) || c.refused_by_framebuffer(call);
    })
}

impl Compiler {
    /// Whether there was no memory for the list.
    pub(crate) fn is_out_of_memory(&self) -> bool {
        self.out_of_memory
    }

    /// Whether there is memory for one more vertex or item. Arrays that are full double, and what
    /// they hold is copied once more where equal vertices are merged.
    fn has_room(&mut self) -> bool {
        let batch = &self.builder.batch;
        let grows = |len: usize, capacity: usize| len >= LONG && len == capacity;
        let vertices = grows(batch.positions.len(), batch.positions.capacity());
        if !vertices && !grows(self.items.len(), self.items.capacity()) {
            return !self.out_of_memory;
        }
        let attributes = 1 + (self.builder.seen.count_ones() as usize);
        let bytes =
            if vertices { batch.positions.len() * attributes * size_of::<[f32; 4]>() } else { 0 };
        if !can_have(4 * bytes + 3 * self.items.len() * size_of::<Item>()) {
            *self = Self { out_of_memory: true, ..Self::default() };
        }
        !self.out_of_memory
    }

    /// `Begin`.
    pub(crate) fn begin(&mut self, mode: u32) {
        if !self.has_room() {
            return;
        }
        if self.inside() {
            self.write_out();
            self.items.push(Item::Begin(mode));
        } else if mode > enums::POLYGON {
            self.flush();
            self.items.push(Item::Begin(mode));
        } else {
            self.open(mode);
        }
    }

    /// `End`.
    pub(crate) fn end(&mut self) {
        if !self.has_room() {
            return;
        }
        if self.builder.is_open() {
            self.builder.close();
            self.empty |= self.builder.batch.primitives.is_empty();
            return;
        }
        if !self.single {
            self.flush();
        }
        self.single = false;
        self.items.push(Item::End);
    }

    /// `Vertex`.
    pub(crate) fn vertex(&mut self, position: [f32; 4]) {
        if !self.has_room() {
            return;
        }
        if self.builder.is_open() {
            self.builder.vertex(position, &self.values);
            return;
        }
        if !self.single {
            self.flush();
        }
        self.items.push(Item::Vertex(position));
    }

    /// A call that sets an attribute.
    pub(crate) fn attribute(&mut self, which: usize, value: [f32; 4]) {
        if !self.has_room() {
            return;
        }

        // Separate the open batch if it lacks the attribute.
        let bit = 1 << which;
        let new = CARRIED & !self.builder.seen & bit != 0;
        if new && !self.builder.batch.positions.is_empty() {
            self.separate();
        }

        // Store the call, or the value for the next vertices.
        if self.single {
            self.items.push(Item::Attribute(which, value));
        } else {
            self.changed |= bit;
            if self.builder.is_open() {
                self.builder.see(which, &self.values);
            }
        }
        self.values.set(which, value);
        self.known |= bit;
    }

    /// Any other call.
    pub(crate) fn call(&mut self, call: Item) {
        if !self.has_room() {
            return;
        }
        self.settle();
        self.items.push(call);
        self.known = 0;
    }

    /// Vertices from arrays.
    pub(crate) fn batch(&mut self, mut batch: VertexBatch) {
        if !self.has_room() {
            return;
        }
        self.settle();
        merge_equal(&mut batch);
        self.items.push(Item::Batch(Arc::new(batch)));
    }

    /// The end of the list.
    pub(crate) fn finish(mut self) -> Vec<Item> {
        self.settle();
        self.items.shrink_to_fit();
        self.items
    }

    fn inside(&self) -> bool {
        self.single || self.builder.is_open()
    }

    /// Makes items of everything that is pending.
    fn settle(&mut self) {
        if self.builder.is_open() {
            self.write_out();
        } else if !self.single {
            self.flush();
        }
    }

    fn open(&mut self, mode: u32) {
        if self.builder.batch.positions.is_empty() {
            for which in each(self.known & CARRIED) {
                self.builder.see(which, &self.values);
            }
        }
        self.builder.open(mode);
    }

    /// Makes items of the complete primitives and of what was set since.
    fn flush(&mut self) {
        let mut batch = self.builder.take();
        let empty = std::mem::take(&mut self.empty);
        if !batch.primitives.is_empty() {
            merge_equal(&mut batch);
            self.items.push(Item::Batch(Arc::new(batch)));
        } else if empty {
            self.items.push(Item::Call(drawing_nothing("glBegin")));
        }
        for which in each(std::mem::take(&mut self.changed)) {
            self.items.push(Item::Attribute(which, self.values.get(which)));
        }
    }

    /// An attribute comes up that the vertices so far took from what will be current: they cannot
    /// share its batch.
    fn separate(&mut self) {
        if !self.builder.is_open() {
            self.flush();
        } else if self.builder.first() == self.builder.batch.positions.len() {
            let mode = self.builder.mode();
            self.builder.abandon();
            self.flush();
            self.open(mode);
        } else {
            self.write_out();
        }
    }

    /// Writes the open primitive out call by call, and goes on so.
    fn write_out(&mut self) {
        if self.single {
            return;
        }
        self.single = true;

        // Turn the vertices gathered so far into calls.
        let (mode, first, seen) = (self.builder.mode(), self.builder.first(), self.builder.seen);
        let mut calls = vec![Item::Begin(mode)];
        let mut last = None;
        let batch = &self.builder.batch;
        for i in first..batch.positions.len() {
            let mut now = self.values;
            batch.load_attributes(i, &mut now);
            push_changes(&mut calls, seen, last.as_ref(), &now);
            calls.push(Item::Vertex(batch.positions[i]));
            last = Some(now);
        }
        push_changes(&mut calls, seen, last.as_ref(), &self.values);

        // Drop them from the batch, and continue with single calls.
        self.builder.batch.truncate_vertices(first);
        self.builder.abandon();
        self.flush();
        self.items.append(&mut calls);
    }
}

/// Items for those attributes in `seen` that differ between `last` and `now`.
fn push_changes(items: &mut Vec<Item>, seen: u32, last: Option<&Current>, now: &Current) {
    for which in each(seen) {
        let value = now.get(which);
        if last.is_none_or(|last| last.get(which).map(f32::to_bits) != value.map(f32::to_bits)) {
            items.push(Item::Attribute(which, value));
        }
    }
}
