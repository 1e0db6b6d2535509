//! Drawing from arrays.

use super::POSITION;
use super::cache::{Key, Vertices};
use super::fetch::{Reader, Refusal, Run, Store, store};
use crate::memory::can_have;
use crate::state::ArrayPointer;
use crate::vertex::{CurrentState, Submission, VertexBatch};
use crate::vertices::attribute::{COLOR, EDGE, FOG, INDEX, NORMAL, SECONDARY, TEX};
use crate::vertices::client;
use crate::vertices::compile::{Item, drawing_nothing};
use crate::{Context, enums};
use std::sync::Arc;

/// What stands against an index.
const BEFORE: Refusal = "an index with its base is negative or too large";

/// The most vertices a draw may take.
const MAX_VERTICES: usize = 1 << 28;

/// Memory that a vertex of a draw takes, roughly: attributes, indices, and the data derived from
/// them.
const BYTES_A_VERTEX: usize = 64;

impl Context {
    /// `glDrawArrays`.
    pub fn draw_arrays(&mut self, mode: u32, first: i32, count: i32) {
        self.draw_range("glDrawArrays", mode, first, count);
    }

    fn draw_range(&mut self, call: &'static str, mode: u32, first: i32, count: i32) {
        match (usize::try_from(first), usize::try_from(count)) {
            (Ok(first), Ok(count)) => {
                self.draw_vertices(call, mode, Vertices::Range { first, count })
            }
            _ => self.draw_error(
                enums::INVALID_VALUE,
                call,
                format!("first {first}, count {count} is negative"),
            ),
        }
    }

    /// `glDrawElements`.
    pub fn draw_elements(&mut self, mode: u32, count: i32, type_: u32, indices: usize) {
        self.draw_indexed("glDrawElements", mode, count, type_, indices, 0);
    }

    /// `glDrawRangeElements`.
    pub fn draw_range_elements(
        &mut self,
        mode: u32,
        start: u32,
        end: u32,
        count: i32,
        type_: u32,
        indices: usize,
    ) {
        self.draw_indexed_range(
            "glDrawRangeElements",
            mode,
            [start, end],
            count,
            type_,
            indices,
            0,
        );
    }

    fn draw_indexed_range(
        &mut self,
        call: &'static str,
        mode: u32,
        [start, end]: [u32; 2],
        count: i32,
        kind: u32,
        pointer: usize,
        base: i32,
    ) {
        if end < start {
            self.draw_error(
                enums::INVALID_VALUE,
                call,
                format!("end {end} lies before start {start}"),
            );
            return;
        }
        self.draw_indexed(call, mode, count, kind, pointer, base);
    }

    /// `glDrawElementsBaseVertex`.
    pub fn draw_elements_base_vertex(
        &mut self,
        mode: u32,
        count: i32,
        type_: u32,
        indices: usize,
        basevertex: i32,
    ) {
        self.draw_indexed("glDrawElementsBaseVertex", mode, count, type_, indices, basevertex);
    }

    /// `glDrawRangeElementsBaseVertex`.
    pub fn draw_range_elements_base_vertex(
        &mut self,
        mode: u32,
        start: u32,
        end: u32,
        count: i32,
        type_: u32,
        indices: usize,
        basevertex: i32,
    ) {
        self.draw_indexed_range(
            "glDrawRangeElementsBaseVertex",
            mode,
            [start, end],
            count,
            type_,
            indices,
            basevertex,
        );
    }

    fn draw_indexed(
        &mut self,
        call: &'static str,
        mode: u32,
        count: i32,
        kind: u32,
        pointer: usize,
        base: i32,
    ) {
        let Ok(count) = usize::try_from(count) else {
            self.draw_error(enums::INVALID_VALUE, call, format!("count {count} is negative"));
            return;
        };
        if !matches!(kind, enums::UNSIGNED_BYTE | enums::UNSIGNED_SHORT | enums::UNSIGNED_INT) {
            self.draw_error(
                enums::INVALID_ENUM,
                call,
                format!("type {kind:#x} is not one of indices"),
            );
            return;
        }
        let buffer = self.client.element_buffer.id();
        let restart = self.client.restart.0.then_some(self.client.restart.1);
        self.draw_vertices(
            call,
            mode,
            Vertices::Elements { count, kind, pointer, buffer, base, restart },
        );
    }

    /// `glMultiDrawArrays`.
    pub fn multi_draw_arrays(&mut self, mode: u32, first: usize, count: usize, drawcount: i32) {
        const CALL: &str = "glMultiDrawArrays";
        let Some(n) = self.draw_count(CALL, mode, drawcount) else { return };
        let firsts = client::values::<i32>(&*self.memory, first, n);
        let counts = client::values::<i32>(&*self.memory, count, n);
        let (Some(firsts), Some(counts)) = (firsts, counts) else {
            self.draw_error(
                enums::INVALID_VALUE,
                CALL,
                "its ranges are not in the client's memory".to_owned(),
            );
            return;
        };
        if firsts.iter().chain(&counts).any(|v| *v < 0) {
            self.draw_error(enums::INVALID_VALUE, CALL, "a first or count is negative".to_owned());
            return;
        }
        for (first, count) in firsts.into_iter().zip(counts) {
            self.draw_range(CALL, mode, first, count);
        }
    }

    /// `glMultiDrawElements`.
    pub fn multi_draw_elements(
        &mut self,
        mode: u32,
        count: usize,
        type_: u32,
        indices: usize,
        drawcount: i32,
    ) {
        self.draw_indexed_many("glMultiDrawElements", mode, count, type_, indices, drawcount, None);
    }

    /// `glMultiDrawElementsBaseVertex`.
    pub fn multi_draw_elements_base_vertex(
        &mut self,
        mode: u32,
        count: usize,
        type_: u32,
        indices: usize,
        drawcount: i32,
        basevertex: usize,
    ) {
        let bases = Some(basevertex);
        self.draw_indexed_many(
            "glMultiDrawElementsBaseVertex",
            mode,
            count,
            type_,
            indices,
            drawcount,
            bases,
        );
    }

    fn draw_indexed_many(
        &mut self,
        call: &'static str,
        mode: u32,
        count: usize,
        kind: u32,
        indices: usize,
        drawcount: i32,
        bases: Option<usize>,
    ) {
        let Some(n) = self.draw_count(call, mode, drawcount) else { return };
        let counts = client::values::<i32>(&*self.memory, count, n);
        let pointers = client::values::<usize>(&*self.memory, indices, n);
        let bases = bases.map_or_else(
            || Some(vec![0; n]),
            |bases| client::values::<i32>(&*self.memory, bases, n),
        );
        let (Some(counts), Some(pointers), Some(bases)) = (counts, pointers, bases) else {
            self.draw_error(
                enums::INVALID_VALUE,
                call,
                "its ranges are not in the client's memory".to_owned(),
            );
            return;
        };
        if counts.iter().any(|v| *v < 0) {
            self.draw_error(enums::INVALID_VALUE, call, "a count is negative".to_owned());
            return;
        }
        for ((count, pointer), base) in counts.into_iter().zip(pointers).zip(bases) {
            self.draw_indexed(call, mode, count, kind, pointer, base);
        }
    }

    /// The number of draws of a call of many, if it may go on.
    fn draw_count(&mut self, call: &'static str, mode: u32, n: i32) -> Option<usize> {
        if self.refused_draw(call) {
            return None;
        }
        if mode > enums::POLYGON {
            self.draw_error(
                enums::INVALID_ENUM,
                call,
                format!("mode {mode:#x} is not a primitive"),
            );
            return None;
        }
        match usize::try_from(n) {
            Ok(0) => self.draw_nothing(call),
            Ok(n) => return Some(n),
            Err(_) => {
                self.draw_error(
                    enums::INVALID_VALUE,
                    call,
                    format!("the number of draws {n} is negative"),
                );
            }
        }
        None
    }

    /// Draws what the arrays hold at the call, or compiles it.
    fn draw_vertices(&mut self, call: &'static str, mode: u32, vertices: Vertices) {
        if self.refused_draw(call) {
            return;
        }

        // Check the mode and the number of vertices.
        if mode > enums::POLYGON {
            self.draw_error(
                enums::INVALID_ENUM,
                call,
                format!("mode {mode:#x} is not a primitive"),
            );
            return;
        }
        let (Vertices::Range { count, .. } | Vertices::Elements { count, .. }) = vertices;
        if count == 0 || !self.client.vertex.enabled {
            self.draw_nothing(call);
            return;
        }
        if count > MAX_VERTICES {
            self.record_error(
                enums::OUT_OF_MEMORY,
                call,
                &format!("{count} vertices are too many"),
            );
            return;
        }
        if !can_have(count * BYTES_A_VERTEX) {
            self.record_error(
                enums::OUT_OF_MEMORY,
                call,
                &format!("there is no memory for {count} vertices"),
            );
            return;
        }

        // Read the arrays, or find the batch of an earlier draw.
        let batch = match self.array_batch(mode, vertices) {
            Ok(batch) => batch,
            Err(why) => {
                self.draw_error(enums::INVALID_OPERATION, call, why.to_owned());
                return;
            }
        };

        // Compile the batch, draw it, or both.
        if self.lists.recording {
            self.compile(|compiler| compiler.batch(Arc::unwrap_or_clone(batch.clone())));
        }
        if self.executes() && !self.gathers(&batch, Submission::Now) {
            self.flush_vertices();
            self.draw_batch(batch, Submission::Now, &CurrentState::current(&self.state));
        }
    }

    /// Whether draws happen at the call, be they compiled or not.
    fn executes(&self) -> bool {
        !self.lists.recording || self.lists.mode == enums::COMPILE_AND_EXECUTE
    }

    /// A draw's error: a list that is being compiled has it, and raises it when it is executed.
    #[cold]
    fn draw_error(&mut self, error: u32, call: &'static str, why: String) {
        self.listable(move |c| {
            if !c.refused_inside_begin(call) {
                c.record_error(error, call, &why);
            }
        });
    }

    /// Whether an open Begin stands against a draw that happens at the call.
    fn refused_draw(&mut self, call: &'static str) -> bool {
        let refused = self.executes() && self.refused_inside_begin(call);
        if refused {
            self.compile_refusal(call);
        }
        refused
    }

    /// A draw of nothing: only the framebuffer may stand against it.
    fn draw_nothing(&mut self, call: &'static str) {
        if self.executes() {
            self.refused_by_framebuffer(call);
        }
        self.compile_refusal(call);
    }

    /// A list gets a draw of nothing.
    fn compile_refusal(&mut self, call: &'static str) {
        if self.lists.recording {
            self.compile(|compiler| compiler.call(Item::Call(drawing_nothing(call))));
        }
    }

    /// Enabled arrays, with what they are for.
    fn enabled_arrays(&self) -> Vec<(usize, ArrayPointer)> {
        let all = (0..=POSITION).map(|which| (which, self.client.array(which)));
        let enabled = all.filter(|(_, array)| array.enabled);
        enabled
            .map(|(which, array)| (which, ArrayPointer { buffer: array.buffer.mark(), ..*array }))
            .collect()
    }

    /// Whether a draw may use an array. One that it does not use may be too short, or lie in memory
    /// that is gone.
    fn may_use(&self, which: usize) -> bool {
        let textured = |unit: usize| self.state.units[unit].enabled != [false; 5];
        let drawn = !self.lists.recording && self.feedback.mode == enums::RENDER;
        match which {
            POSITION | COLOR | SECONDARY | FOG | EDGE | INDEX => true,
            _ if !drawn => true,
            NORMAL => self.state.lighting.enabled || (0..self.state.units.len()).any(textured),
            _ => textured(which - TEX),
        }
    }

    /// Whether at least one element of the positions lies in their buffer.
    fn has_positions(reader: &Reader, arrays: &[(usize, ArrayPointer)]) -> bool {
        arrays
            .iter()
            .filter(|(which, _)| *which == POSITION)
            .all(|(_, array)| reader.has_some(array))
    }

    fn array_batch(&mut self, mode: u32, vertices: Vertices) -> Result<Arc<VertexBatch>, Refusal> {
        // Colour indices have no effect: whether and where they lie does not matter.
        let mut arrays = self.enabled_arrays();
        arrays.retain(|(which, _)| *which != INDEX && self.may_use(*which));
        let element_buffer = match vertices {
            // Open the buffers.
            Vertices::Elements { buffer, .. } => Some(buffer),
            Vertices::Range { .. } => None,
        };
        let reader = self.array_reader(&arrays, element_buffer.is_some())?;
        if !Self::has_positions(&reader, &arrays) {
            return Err("the buffer of positions holds none");
        }

        // Keep batches that lie in buffers as a whole; compare the client's bytes of the others.
        let constant =
            element_buffer != Some(0) && arrays.iter().all(|(_, array)| !array.buffer.is_none());
        let versions = reader.stores.iter().map(|store| store.version).collect();
        let key = Key { mode, vertices, arrays, versions };
        if !constant {
            return self.arrays.repeats.batch(&reader, key);
        }

        // Find the batch in the cache, or build it.
        if let Some(batch) = self.arrays.cache.find(&key) {
            return Ok(batch);
        }
        let batch = Arc::new(build(&reader, &key.arrays, mode, vertices)?.0);
        self.arrays.cache.insert(key, batch.clone());
        Ok(batch)
    }

    fn array_reader(
        &self,
        arrays: &[(usize, ArrayPointer)],
        indexed: bool,
    ) -> Result<Reader, Refusal> {
        let buffers = arrays.iter().map(|(which, _)| &self.client.array(*which).buffer);
        let mut stores: Vec<Store> = Vec::new();
        for buffer in buffers.chain(indexed.then_some(&self.client.element_buffer)) {
            if !buffer.is_none() && stores.iter().all(|store| store.buffer != buffer.id()) {
                stores.push(store(buffer)?);
            }
        }
        Ok(Reader { memory: self.memory.clone(), stores })
    }

    /// `glArrayElement`.
    pub fn array_element(&mut self, i: i32) {
        const CALL: &str = "glArrayElement";
        let Ok(i) = usize::try_from(i) else {
            self.listable(move |c| {
                c.record_error(enums::INVALID_VALUE, CALL, &format!("index {i} is negative"))
            });
            return;
        };
        let arrays = self.enabled_arrays();
        let read = |reader: Reader| -> Result<Vec<[f32; 4]>, Refusal> {
            let one = |(which, array): &(usize, ArrayPointer)| {
                let unit = matches!(*which, NORMAL | COLOR | SECONDARY);
                Ok(reader.elements(array, &[(i, 1)], unit, [0.0, 0.0, 0.0, 1.0])?[0])
            };
            arrays.iter().map(one).collect()
        };
        match self.array_reader(&arrays, false).and_then(read) {
            Err(why) => self.listable(move |c| c.record_error(enums::INVALID_OPERATION, CALL, why)),
            // The position is the last.
            Ok(values) => {
                for ((which, _), value) in arrays.iter().zip(values) {
                    if *which == POSITION {
                        self.give_vertex(value)
                    } else {
                        self.give_attribute(*which, value)
                    }
                }
            }
        }
    }
}

/// Reads everything that a draw takes; also says which elements that are.
pub(super) fn build(
    reader: &Reader,
    arrays: &[(usize, ArrayPointer)],
    mode: u32,
    vertices: Vertices,
) -> Result<(VertexBatch, Vec<Run>), Refusal> {
    // Find the runs of elements: a range, or what the indices name.
    let mut batch = VertexBatch::default();
    let mut pieces = Vec::new();
    let runs = match vertices {
        Vertices::Range { first, count } => {
            pieces.push(count);
            vec![(first, count)]
        }
        Vertices::Elements { count, kind, pointer, buffer, base, restart } => {
            let mut indices = reader.indices(buffer, kind, count, pointer)?;

            // Cut primitives at the restart index, which names no element.
            if let Some(restart) = restart {
                pieces.extend(indices.split(|&index| index == restart).map(<[u32]>::len));
                indices.retain(|&index| index != restart);
            } else {
                pieces.push(count);
            }

            // Add the base vertex, and renumber the indices from 0.
            if base != 0 {
                for index in &mut indices {
                    *index = index.checked_add_signed(base).ok_or(BEFORE)?;
                }
            }
            let runs = compact(&mut indices);
            batch.indices = Some(indices);
            runs
        }
    };

    // Read each array.
    for (which, array) in arrays {
        match *which {
            POSITION => {
                batch.positions = reader.elements(array, &runs, false, [0.0, 0.0, 0.0, 1.0])?
            }
            NORMAL => batch.normals = Some(reader.elements(array, &runs, true, [0.0; 3])?),
            COLOR => {
                batch.colors = Some(reader.elements(array, &runs, true, [0.0, 0.0, 0.0, 1.0])?)
            }
            SECONDARY => batch.secondary = Some(reader.elements(array, &runs, true, [0.0; 3])?),
            FOG => batch.fog = Some(reader.elements(array, &runs, false, [0.0])?.into_flattened()),
            EDGE => {
                let flags = reader.elements(array, &runs, false, [0.0])?;
                batch.edges = Some(flags.into_iter().map(|[flag]| flag != 0.0).collect());
            }
            INDEX => {}
            _ => {
                batch.tex[which - TEX] =
                    Some(reader.elements(array, &runs, false, [0.0, 0.0, 0.0, 1.0])?)
            }
        }
    }

    // Add the primitives between restarts.
    let mut first = 0;
    for count in pieces {
        batch.add_primitive(mode, first, count as u32);
        first += count as u32;
    }
    Ok((batch, runs))
}

/// Renumbers indices from 0; the result says which elements to read for that.
fn compact(indices: &mut [u32]) -> Vec<Run> {
    let (Some(&least), Some(&most)) = (indices.iter().min(), indices.iter().max()) else {
        return Vec::new();
    };
    let span = (most - least) as usize + 1;
    if span <= 2 * indices.len() + 64 {
        indices.iter_mut().for_each(|i| *i -= least);
        return vec![(least as usize, span)];
    }
    // Few elements of many: only those that are named.
    let mut named = indices.to_vec();
    named.sort_unstable();
    named.dedup();
    for i in indices.iter_mut() {
        *i = named.binary_search(i).map_or(0, |at| at as u32);
    }
    let mut runs: Vec<Run> = Vec::new();
    for name in named {
        match runs.last_mut() {
            Some((first, count)) if *first + *count == name as usize => *count += 1,
            _ => runs.push((name as usize, 1)),
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::super::super::tests::{BASE, context};
    use super::*;
    use crate::primitive::Primitive;

    fn with_square() -> Context {
        let mut c = context();
        let corners = [[0.0f32, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        c.memory.write(BASE, bytemuck::cast_slice(&corners));
        c.memory.write(BASE + 100, &[0, 1, 2, 0, 2, 3]);
        c.vertex_pointer(2, enums::FLOAT, 0, BASE);
        c.enable_client_state(enums::VERTEX_ARRAY);
        c
    }

    #[test]
    fn ranges_and_elements() {
        let mut c = with_square();
        c.draw_arrays(enums::TRIANGLES, 1, 3);
        c.draw_elements(enums::TRIANGLES, 6, enums::UNSIGNED_BYTE, BASE + 100);
        c.draw_range_elements(enums::LINES, 2, 3, 2, enums::UNSIGNED_BYTE, BASE + 104);
        let log = &c.builder.log;
        assert_eq!(log[0].positions[0], [1.0, 0.0, 0.0, 1.0]);
        assert_eq!(log[0].primitives, [Primitive { mode: enums::TRIANGLES, first: 0, count: 3 }]);
        assert_eq!(log[1].indices, Some(vec![0, 1, 2, 0, 2, 3]));
        assert_eq!(log[1].positions.len(), 4);
        assert_eq!(
            (log[2].indices.clone(), log[2].positions[0]),
            (Some(vec![0, 1]), [1.0, 1.0, 0.0, 1.0])
        );
        assert_eq!(c.error, 0);
    }

    #[test]
    fn what_cannot_be_read_is_refused() {
        let mut c = with_square();
        c.draw_arrays(enums::POINTS, 0, i32::MAX);
        assert_eq!(std::mem::take(&mut c.error), enums::OUT_OF_MEMORY);
        c.draw_arrays(enums::POINTS, i32::MAX, 1);
        assert_eq!(std::mem::take(&mut c.error), enums::INVALID_OPERATION);
        c.draw_arrays(enums::POINTS, 0, -1);
        assert_eq!(std::mem::take(&mut c.error), enums::INVALID_VALUE);
        c.draw_elements(enums::POINTS, 1, enums::FLOAT, BASE);
        assert_eq!(std::mem::take(&mut c.error), enums::INVALID_ENUM);
        c.bind_buffer(enums::ARRAY_BUFFER, 1);
        c.vertex_pointer(2, enums::FLOAT, 0, 0);
        c.draw_arrays(enums::POINTS, 0, 1);
        assert_eq!(std::mem::take(&mut c.error), enums::INVALID_OPERATION);
        assert!(c.builder.log.is_empty());
    }

    #[test]
    fn the_same_draw_from_buffers_is_the_same_batch() {
        let mut c = with_square();
        c.bind_buffer(enums::ARRAY_BUFFER, 1);
        c.buffer_data(enums::ARRAY_BUFFER, 32, BASE, enums::STATIC_DRAW);
        c.vertex_pointer(2, enums::FLOAT, 0, 0);
        c.bind_buffer(enums::ELEMENT_ARRAY_BUFFER, 2);
        c.buffer_data(enums::ELEMENT_ARRAY_BUFFER, 6, BASE + 100, enums::STATIC_DRAW);
        for _ in 0..2 {
            c.draw_elements(enums::TRIANGLES, 6, enums::UNSIGNED_BYTE, 0);
        }
        c.buffer_sub_data(enums::ARRAY_BUFFER, 0, 4, BASE + 8);
        c.draw_elements(enums::TRIANGLES, 6, enums::UNSIGNED_BYTE, 0);
        let log = &c.builder.log;
        assert!(Arc::ptr_eq(&log[0], &log[1]) && !Arc::ptr_eq(&log[0], &log[2]));
        assert_eq!((log[0].positions[0][0], log[2].positions[0][0]), (0.0, 1.0));
    }

    #[test]
    fn a_list_keeps_what_the_arrays_held() {
        let mut c = with_square();
        c.new_list(1, enums::COMPILE);
        c.draw_arrays(enums::POINTS, 0, 1);
        c.begin(enums::POINTS);
        c.array_element(2);
        c.end();
        c.end_list();
        c.memory.write(BASE, &[0xff; 32]);
        assert!(c.builder.log.is_empty());
        c.call_list(1);
        assert_eq!(c.builder.log[0].positions, [[0.0, 0.0, 0.0, 1.0]]);
        assert_eq!(c.builder.log[1].positions, [[1.0, 1.0, 0.0, 1.0]]);
    }

    #[test]
    fn a_list_with_a_draw_of_nothing_is_refused_inside_begin() {
        let mut c = context();
        c.new_list(1, enums::COMPILE);
        c.draw_arrays(enums::POINTS, 0, 4);
        c.end_list();
        c.call_list(1);
        assert_eq!(c.error, 0);
        c.begin(enums::POINTS);
        c.call_list(1);
        c.end();
        assert_eq!(c.error, enums::INVALID_OPERATION);
    }

    #[test]
    fn far_indices_are_read_one_by_one() {
        let mut indices = [5, 4_000_000_000, 6, 5];
        assert_eq!(compact(&mut indices), [(5, 2), (4_000_000_000, 1)]);
        assert_eq!(indices, [0, 2, 1, 0]);
    }

    #[test]
    fn many_draws() {
        let mut c = with_square();
        c.memory.write(BASE + 200, bytemuck::cast_slice(&[0i32, 2, 2, 2]));
        c.multi_draw_arrays(enums::LINES, BASE + 200, BASE + 208, 2);
        assert_eq!(c.builder.log[1].positions[0], [1.0, 1.0, 0.0, 1.0]);
        c.multi_draw_arrays(enums::LINES, BASE + 200, BASE + 208, i32::MAX);
        assert_eq!(c.error, enums::INVALID_VALUE);
    }
}
