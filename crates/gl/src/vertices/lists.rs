//! Display lists: making, calling, names.

use super::client;
use super::compile::{Call, Compiler, Item};
use crate::names::NameRange;
use crate::state::MAX_LIST_NESTING;
use crate::vertex::{CurrentState, Submission};
use crate::{Context, enums};
use std::collections::BTreeMap;
use std::sync::{Arc, MutexGuard, PoisonError};

/// A display list.
#[derive(Debug, Default)]
pub struct List {
    items: Vec<Item>,
}

/// Display lists by name.
pub type ListNames = BTreeMap<u32, Arc<List>>;

/// Display lists being made and called.
#[derive(Debug, Default)]
pub(crate) struct Lists {
    /// Whether calls are compiled: a list is open, and no list is being executed.
    pub(crate) recording: bool,
    compiler: Option<Box<Compiler>>,
    /// `LIST_INDEX`: the list that is open, or 0.
    pub(crate) name: u32,
    /// `LIST_MODE`: how it is open, or 0.
    pub(crate) mode: u32,
    /// How many lists are being executed, one within another.
    nesting: usize,
    /// How many lists may still be executed in this call.
    budget: u32,
}

/// How many lists one call may execute in all; lists that call themselves twice would never end.
const CALLS: u32 = 1 << 22;

/// How many names may be generated at once.
const MAX_RANGE: u32 = 1 << 22;

impl Context {
    /// Runs `call` at once, or keeps it in the list that is being compiled, or both
    /// (`COMPILE_AND_EXECUTE`).
    pub(crate) fn listable(&mut self, call: impl Fn(&mut Self) + Send + Sync + 'static) {
        self.listed(call, Item::Call);
    }

    /// [`Self::listable`] for a call that leaves waiting what waits to be drawn, or draws it
    /// itself.
    pub(crate) fn listable_keeping(&mut self, call: impl Fn(&mut Self) + Send + Sync + 'static) {
        self.listed(call, Item::Keeping);
    }

    fn listed(&mut self, call: impl Fn(&mut Self) + Send + Sync + 'static, item: fn(Call) -> Item) {
        if !self.lists.recording {
            call(self);
            return;
        }
        if self.lists.mode == enums::COMPILE_AND_EXECUTE {
            self.unrecorded(&call);
        }
        self.compile(|compiler| compiler.call(item(Box::new(call))));
    }

    /// Runs `call` with nothing being compiled.
    pub(super) fn unrecorded(&mut self, call: impl FnOnce(&mut Self)) {
        let recording = std::mem::take(&mut self.lists.recording);
        call(self);
        self.lists.recording = recording;
    }

    /// Adds to the open list. Whether the call is to be executed too.
    pub(super) fn compile(&mut self, add: impl FnOnce(&mut Compiler)) -> bool {
        if let Some(compiler) = &mut self.lists.compiler {
            add(compiler);
        }
        self.lists.mode == enums::COMPILE_AND_EXECUTE
    }

    #[inline(never)]
    pub(super) fn compile_attribute(&mut self, which: usize, value: [f32; 4]) -> bool {
        self.compile(|compiler| compiler.attribute(which, value))
    }

    #[inline(never)]
    pub(super) fn compile_vertex(&mut self, position: [f32; 4]) -> bool {
        self.compile(|compiler| compiler.vertex(position))
    }

    fn list_names(&self) -> MutexGuard<'_, ListNames> {
        self.shared.lists.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// `glNewList`.
    pub fn new_list(&mut self, list: u32, mode: u32) {
        if self.refused_inside_begin("glNewList") {
        } else if list == 0 {
            self.record_error(enums::INVALID_VALUE, "glNewList", "0 is not the name of a list");
        } else if !matches!(mode, enums::COMPILE | enums::COMPILE_AND_EXECUTE) {
            self.record_error(
                enums::INVALID_ENUM,
                "glNewList",
                &format!("{mode:#x} is not a mode"),
            );
        } else if self.lists.name != 0 {
            let open = format!("list {} is still being compiled", self.lists.name);
            self.record_error(enums::INVALID_OPERATION, "glNewList", &open);
        } else {
            let lists = &mut self.lists;
            (lists.name, lists.mode, lists.recording) = (list, mode, true);
            lists.compiler = Some(Box::default());
        }
    }

    /// `glEndList`.
    pub fn end_list(&mut self) {
        if self.refused_inside_begin("glEndList") {
            return;
        }
        let Some(compiler) = self.lists.compiler.take() else {
            self.record_error(enums::INVALID_OPERATION, "glEndList", "no list is being compiled");
            return;
        };
        let name = self.lists.name;
        (self.lists.name, self.lists.mode, self.lists.recording) = (0, 0, false);
        if compiler.is_out_of_memory() {
            return self.record_error(
                enums::OUT_OF_MEMORY,
                "glEndList",
                "there is no memory for so long a list",
            );
        }
        let list = Arc::new(List { items: compiler.finish() });
        let old = self.list_names().insert(name, list);
        drop(old);
    }

    /// `glCallList`.
    pub fn call_list(&mut self, list: u32) {
        self.listable_keeping(move |c| c.execute_lists(&[list]));
    }

    /// `glCallLists`.
    pub fn call_lists(&mut self, n: i32, type_: u32, lists: usize) {
        let offsets = match offsets(self, n, type_, lists) {
            Ok(offsets) => offsets,
            Err((error, why)) => {
                self.listable(move |c| c.record_error(error, "glCallLists", why));
                return;
            }
        };
        self.listable_keeping(move |c| {
            let base = c.state.list_base;
            let names: Vec<u32> = offsets.iter().map(|offset| base.wrapping_add(*offset)).collect();
            c.execute_lists(&names);
        });
    }

    /// `glListBase`.
    pub fn list_base(&mut self, base: u32) {
        self.listable(move |c| {
            if !c.refused_inside_begin("glListBase") {
                c.state.list_base = base;
            }
        });
    }

    fn execute_lists(&mut self, names: &[u32]) {
        // Limit nesting, and the number of lists that one call may run.
        if self.lists.nesting == 0 {
            self.lists.budget = CALLS;
        }
        if self.lists.nesting >= MAX_LIST_NESTING {
            return;
        }
        self.lists.nesting += 1;

        // Run each list.
        for name in names {
            let list = self.list_names().get(name).cloned();
            let Some(list) = list.filter(|list| !list.items.is_empty()) else { continue };
            if self.lists.budget == 0 {
                self.record_error(
                    enums::OUT_OF_MEMORY,
                    "glCallList",
                    "lists that call each other have no end",
                );
                break;
            }
            self.lists.budget -= 1;
            self.unrecorded(|c| list.items.iter().for_each(|item| c.execute(item)));
        }
        self.lists.nesting -= 1;
    }

    fn execute(&mut self, item: &Item) {
        match item {
            Item::Call(call) => {
                self.flush_vertices();
                call(self);
            }
            Item::Keeping(call) => call(self),
            Item::Batch(batch) => {
                if !self.refused_inside_begin("glBegin") && !self.gathers(batch, Submission::Listed)
                {
                    self.flush_vertices();
                    self.draw_batch(
                        batch.clone(),
                        Submission::Listed,
                        &CurrentState::current(&self.state),
                    );
                }
            }
            Item::Attribute(which, value) => self.exec_attribute(*which, *value),
            Item::Begin(mode) => self.exec_begin(*mode),
            Item::Vertex(position) => self.exec_vertex(*position),
            Item::End => self.exec_end(),
        }
    }

    /// `glGenLists`.
    pub fn gen_lists(&mut self, range: i32) -> u32 {
        if self.refused_inside_begin("glGenLists") {
            return 0;
        }

        // Check the range.
        let Ok(range) = u32::try_from(range) else {
            self.record_error(
                enums::INVALID_VALUE,
                "glGenLists",
                &format!("range {range} is negative"),
            );
            return 0;
        };
        if range == 0 {
            return 0;
        }

        // Reserve names in a row.
        let first = if range <= MAX_RANGE {
            free_run(&self.list_names(), self.shared.names, range)
        } else {
            None
        };
        let Some(first) = first else {
            self.record_error(
                enums::OUT_OF_MEMORY,
                "glGenLists",
                &format!("no {range} names in a row are free"),
            );
            return 0;
        };
        let empty = Arc::new(List::default());
        self.list_names().extend((first..=first + (range - 1)).map(|name| (name, empty.clone())));
        first
    }

    /// `glDeleteLists`.
    pub fn delete_lists(&mut self, list: u32, range: i32) {
        if self.refused_inside_begin("glDeleteLists") {
            return;
        }
        let Ok(range) = u32::try_from(range) else {
            self.record_error(
                enums::INVALID_VALUE,
                "glDeleteLists",
                &format!("range {range} is negative"),
            );
            return;
        };
        if range == 0 {
            return;
        }
        let mut names = self.list_names();
        let doomed: Vec<u32> =
            names.range(list..=list.saturating_add(range - 1)).map(|(name, _)| *name).collect();
        let lists: Vec<_> = doomed.iter().filter_map(|name| names.remove(name)).collect();
        drop(names);
        drop(lists);
        doomed.iter().for_each(|&name| self.forget_label(enums::DISPLAY_LIST, name));
    }

    /// `glIsList`.
    pub fn is_list(&mut self, list: u32) -> u8 {
        if self.refused_inside_begin("glIsList") {
            return 0;
        }
        u8::from(self.list_names().contains_key(&list))
    }
}

/// The first of `count` free names in a row, in the range `own` if there is room.
fn free_run(names: &ListNames, own: NameRange, count: u32) -> Option<u32> {
    // Above all others of the range.
    let highest = names
        .range(own.first()..=own.last())
        .next_back()
        .map_or(own.first() - 1, |(name, _)| *name);
    if own.last() - highest >= count {
        return Some(highest + 1);
    }

    // In the first gap, wherever that is.
    let mut first = 1u32;
    for name in names.keys() {
        if name - first >= count {
            return Some(first);
        }
        first = name.checked_add(1)?;
    }
    first.checked_add(count - 1).map(|_| first)
}

/// What `CallLists` adds to the list base.
fn offsets(c: &Context, n: i32, kind: u32, lists: usize) -> Result<Vec<u32>, (u32, &'static str)> {
    let n = usize::try_from(n).map_err(|_| (enums::INVALID_VALUE, "n is negative"))?;
    let memory = &*c.memory;
    let joined = |width: usize| -> Option<Vec<u32>> {
        let bytes = client::bytes(memory, lists, n.checked_mul(width)?)?;
        let join = |name: &[u8]| name.iter().fold(0, |high, byte| high << 8 | u32::from(*byte));
        Some(bytes.chunks_exact(width).map(join).collect())
    };

    // Read the names by their type.
    let offsets =
        match kind {
            enums::BYTE => client::values::<i8>(memory, lists, n)
                .map(|v| v.iter().map(|&x| x as u32).collect()),
            enums::SHORT => client::values::<i16>(memory, lists, n)
                .map(|v| v.iter().map(|&x| x as u32).collect()),
            enums::UNSIGNED_SHORT => client::values::<u16>(memory, lists, n)
                .map(|v| v.iter().map(|&x| x.into()).collect()),
            enums::INT | enums::UNSIGNED_INT => client::values::<u32>(memory, lists, n),
            enums::FLOAT => client::values::<f32>(memory, lists, n)
                .map(|v| v.iter().map(|&x| x as i64 as u32).collect()),
            enums::UNSIGNED_BYTE => joined(1),
            enums::_2_BYTES => joined(2),
            enums::_3_BYTES => joined(3),
            enums::_4_BYTES => joined(4),
            _ => return Err((enums::INVALID_ENUM, "type is not one of list names")),
        };
    offsets.ok_or((enums::INVALID_VALUE, "the names are not in the client's memory"))
}

#[cfg(test)]
mod tests {
    use super::super::tests::context;
    use super::*;
    use crate::vertex::{Primitive, VertexBatch};

    fn quad(c: &mut Context, x: f32) {
        c.begin(enums::QUADS);
        c.vertex_2f(x, 0.0);
        c.vertex_2f(x + 1.0, 0.0);
        c.vertex_2f(x + 1.0, 1.0);
        c.vertex_2f(x, 1.0);
        c.end();
    }

    fn compiled(c: &mut Context, make: impl FnOnce(&mut Context)) -> Arc<List> {
        c.new_list(1, enums::COMPILE);
        make(c);
        c.end_list();
        c.list_names()[&1].clone()
    }

    fn batches(list: &List) -> Vec<Arc<VertexBatch>> {
        let batch =
            |item: &Item| if let Item::Batch(batch) = item { Some(batch.clone()) } else { None };
        list.items.iter().filter_map(batch).collect()
    }

    #[test]
    fn pairs_join_and_share_vertices() {
        let mut c = context();
        let list = compiled(&mut c, |c| {
            c.normal_3f(0.0, 1.0, 0.0);
            (0..4).for_each(|i| quad(c, i as f32));
        });
        let batches = batches(&list);
        assert_eq!(batches.len(), 1);
        assert_eq!(batches[0].primitives, [Primitive { mode: enums::QUADS, first: 0, count: 16 }]);
        assert_eq!(batches[0].positions.len(), 10);
        assert_eq!(batches[0].normals, Some(vec![[0.0, 1.0, 0.0]; 10]));
        assert!(c.builder.log.is_empty());
        c.call_list(1);
        assert!(Arc::ptr_eq(&c.builder.log[0], &batches[0]));
        assert_eq!(c.state.current.normal, [0.0, 1.0, 0.0]);
    }

    #[test]
    fn colours_known_later_split_the_batch() {
        let mut c = context();
        let list = compiled(&mut c, |c| {
            quad(c, 0.0);
            c.color_3f(1.0, 0.0, 0.0);
            quad(c, 1.0);
            c.begin(enums::QUADS);
            c.color_3f(0.0, 1.0, 0.0);
            c.end();
            quad(c, 2.0);
        });
        let batches = batches(&list);
        assert_eq!(batches.len(), 2);
        assert_eq!(batches[0].colors, None);
        let colors = batches[1].colors.as_ref().unwrap();
        assert_eq!((colors[0], colors[7]), ([1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0]));
    }

    #[test]
    fn a_colour_unknown_at_the_first_vertex_is_that_of_execution() {
        let mut c = context();
        compiled(&mut c, |c| {
            quad(c, 5.0);
            c.begin(enums::LINES);
            c.vertex_2f(0.0, 0.0);
            c.color_3f(1.0, 0.0, 0.0);
            c.vertex_2f(1.0, 0.0);
            c.end();
        });
        c.color_3f(0.0, 0.0, 1.0);
        c.call_list(1);
        let line = &c.builder.log[1];
        assert_eq!(line.colors, Some(vec![[0.0, 0.0, 1.0, 1.0], [1.0, 0.0, 0.0, 1.0]]));
        assert_eq!(line.positions.len(), 2);
    }

    #[test]
    fn a_list_may_hold_half_a_primitive() {
        let mut c = context();
        compiled(&mut c, |c| {
            c.color_3f(1.0, 0.0, 0.0);
            c.vertex_2f(0.0, 0.0);
        });
        c.begin(enums::POINTS);
        c.call_list(1);
        c.end();
        assert_eq!(c.builder.log[0].colors, Some(vec![[1.0, 0.0, 0.0, 1.0]]));
        compiled(&mut c, |c| {
            c.begin(enums::POINTS);
            c.vertex_2f(3.0, 0.0);
        });
        c.call_list(1);
        assert!(c.inside_begin());
        c.end();
        assert_eq!(c.builder.log[1].positions, [[3.0, 0.0, 0.0, 1.0]]);
    }

    #[test]
    fn compile_and_execute_does_both() {
        let mut c = context();
        c.new_list(1, enums::COMPILE_AND_EXECUTE);
        quad(&mut c, 0.0);
        c.list_base(7);
        c.end_list();
        assert_eq!((c.builder.log.len(), c.state.list_base), (1, 7));
        c.state.list_base = 0;
        c.call_list(1);
        assert_eq!((c.builder.log.len(), c.state.list_base), (2, 7));
    }

    #[test]
    fn lists_that_call_themselves_end() {
        let mut c = context();
        compiled(&mut c, |c| {
            quad(c, 0.0);
            c.call_list(1);
        });
        c.call_list(1);
        assert_eq!(c.builder.log.len(), MAX_LIST_NESTING);
    }

    #[test]
    fn names_of_all_types() {
        let mut c = context();
        let first = c.gen_lists(300);
        assert_eq!((first, c.is_list(300), c.is_list(301)), (1, 1, 0));
        c.new_list(258, enums::COMPILE);
        c.begin(enums::POINTS);
        c.vertex_2f(0.0, 0.0);
        c.end();
        c.end_list();
        c.memory.write(0x1000, &[1, 2, 0xff, 0xff]);
        c.call_lists(1, enums::_2_BYTES, 0x1000);
        c.list_base(256);
        c.call_lists(2, enums::UNSIGNED_BYTE, 0x1000);
        c.list_base(259);
        c.call_lists(1, enums::BYTE, 0x1002);
        assert_eq!(c.builder.log.len(), 3);
        c.call_lists(i32::MAX, enums::FLOAT, 0x1000);
        assert_eq!(std::mem::take(&mut c.error), enums::INVALID_VALUE);
        c.call_lists(1, enums::DOUBLE, 0x1000);
        assert_eq!(std::mem::take(&mut c.error), enums::INVALID_ENUM);
        c.delete_lists(2, i32::MAX);
        assert_eq!((c.is_list(1), c.is_list(2)), (1, 0));
    }

    #[test]
    fn free_names_between_others_are_found() {
        let empty = Arc::new(List::default());
        let own = NameRange::default();
        let mut names: ListNames = [2, 5, u32::MAX].map(|name| (name, empty.clone())).into();
        assert_eq!(free_run(&names, own, 1), Some(6), "above all others");
        names.insert(own.last(), empty.clone());
        assert_eq!(free_run(&names, own, 1), Some(1));
        assert_eq!(free_run(&names, own, 2), Some(3));
        assert_eq!(free_run(&names, own, 3), Some(6));
        assert_eq!(free_run(&names, own, own.last()), Some(own.last() + 1));
        assert_eq!(free_run(&names, own, u32::MAX - own.last()), None);
    }
}
