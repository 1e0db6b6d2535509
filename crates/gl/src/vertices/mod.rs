//! Where vertices come from: Begin/End, arrays, display lists, evaluators; and where they go
//! besides the screen: feedback and selection.

mod arrays;
mod attribute;
mod buffers;
mod builder;
mod client;
mod compile;
mod evaluators;
mod feedback;
mod immediate;
mod lists;
mod merge;
mod names;
mod position;
mod provoking;
mod quick;
mod rect;

pub(crate) use arrays::Arrays;
pub use buffers::{Buffer, BufferHandle};
pub(crate) use builder::Builder;
pub(crate) use client::bytes as client_bytes;
pub(crate) use feedback::Feedback;
pub(crate) use lists::Lists;
pub use lists::{List, ListNames};

use crate::Context;
use crate::enums;
use crate::vertex::{CurrentState, Submission, VertexBatch};
use std::sync::Arc;

impl Context {
    /// Draws a batch: to the screen, or to the feedback or selection buffer.
    pub(crate) fn draw_batch(
        &mut self,
        batch: Arc<VertexBatch>,
        sent: Submission,
        given: &CurrentState,
    ) {
        if batch.primitives.is_empty() {
            return;
        }
        #[cfg(test)]
        self.builder.log.push(batch.clone());

        // Have the corner that colours an element come last where the first one is to.
        let lighting = &self.state.lighting;
        let is_first = lighting.provoking_vertex == enums::FIRST_VERTEX_CONVENTION;
        let batch = match is_first && lighting.shade_model == enums::FLAT {
            true => Arc::new(batch.with_first_corner_last()),
            false => batch,
        };

        // Hand it on.
        if self.feedback.mode == enums::RENDER {
            self.record_draw(batch, sent, given);
        } else if !self.refused_by_framebuffer("draw") {
            self.feed_batch(&batch);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::memory::Arena;
    use crate::{Context, Shared, enums};
    use std::sync::Arc;

    /// Where the client's memory begins.
    pub(super) const BASE: usize = 0x1000;

    /// A new context with 64 KiB of client memory at [`BASE`].
    pub(super) fn context() -> Context {
        let mut c = Context::new(Arc::new(Arena::new(BASE, 1 << 16)), Arc::new(Shared::default()));
        c.configure_default_framebuffer(enums::RGBA, 24, 8, 0);
        assert!(c.make_current(BASE + 0xF000, enums::UNSIGNED_BYTE, 16, 16));
        c
    }

    /// Numbers without order, some of them wild.
    struct Dice(u64);

    impl Dice {
        fn next(&mut self) -> u64 {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            self.0 >> 33
        }

        fn small(&mut self) -> i32 {
            const WILD: [i32; 4] = [i32::MAX, i32::MIN, -1, 1 << 12];
            if self.next().is_multiple_of(16) {
                WILD[self.next() as usize % 4]
            } else {
                (self.next() % 12) as i32
            }
        }

        fn address(&mut self) -> usize {
            if self.next().is_multiple_of(8) {
                self.small() as usize
            } else {
                BASE + self.next() as usize % 64
            }
        }

        fn one_of(&mut self, tokens: &[u32]) -> u32 {
            tokens[self.next() as usize % tokens.len()]
        }
    }

    /// Makes one call, whatever it is.
    fn call(c: &mut Context, d: &mut Dice) {
        let kinds =
            [enums::FLOAT, enums::SHORT, enums::UNSIGNED_BYTE, enums::INT, enums::DOUBLE, 7];
        let arrays = [
            enums::VERTEX_ARRAY,
            enums::COLOR_ARRAY,
            enums::EDGE_FLAG_ARRAY,
            enums::TEXTURE_COORD_ARRAY,
        ];
        let targets = [enums::ARRAY_BUFFER, enums::ELEMENT_ARRAY_BUFFER];
        let target = d.one_of(&targets);
        match d.next() % 34 {
            0..4 => c.begin(d.small() as u32),
            4..8 => c.end(),
            8..12 => c.vertex_2i(d.small(), 1),
            12 => c.color_4fv((d.small() > 0).then_some([0.25, 0.5, 0.75, f32::NAN])),
            13 => c.multi_tex_coord_1s(enums::TEXTURE0 + d.small() as u32 % 9, 1),
            14 => c.edge_flag(d.next() as u8 & 1),
            15 => c.new_list(
                d.small() as u32,
                d.one_of(&[enums::COMPILE, enums::COMPILE_AND_EXECUTE]),
            ),
            16..18 => c.end_list(),
            18 => c.call_lists(d.small(), d.one_of(&kinds), d.address()),
            19 => c.delete_lists(d.small() as u32, d.small()),
            20 => c.vertex_pointer(d.small(), d.one_of(&kinds), d.small(), d.address() % 0x1040),
            21 => c.color_pointer(d.small(), d.one_of(&kinds), d.small(), d.address()),
            22 => c.enable_client_state(d.one_of(&arrays)),
            23 => c.draw_arrays(d.small() as u32, d.small(), d.small()),
            24 => c.draw_elements(d.small() as u32, d.small(), d.one_of(&kinds), d.address()),
            25 => c.array_element(d.small()),
            26 => c.bind_buffer(target, d.small() as u32),
            27 => c.buffer_data(target, d.small() as isize, d.address(), enums::STATIC_DRAW),
            28 => c.buffer_sub_data(target, d.small() as isize, d.small() as isize, d.address()),
            29 => {
                _ = c.map_buffer_range(
                    target,
                    d.small() as isize,
                    d.small() as isize,
                    d.small() as u32,
                )
            }
            30 => _ = c.unmap_buffer(target),
            31 => c.bind_vertex_array(d.small() as u32 % 3),
            32 => c.eval_mesh_2(enums::FILL, d.small(), d.small(), d.small(), d.small()),
            _ => c.flush_vertices(),
        }
    }

    #[test]
    fn wild_calls_do_no_harm() {
        for seed in 0..20 {
            let (mut c, mut d) = (context(), Dice(seed));
            c.set_merging(seed % 2 == 0);
            c.gen_vertex_arrays(2, BASE);
            c.state.eval.map2_enabled = [true; 9];
            for _ in 0..2000 {
                call(&mut c, &mut d);
                c.error = enums::NO_ERROR;
            }
            for batch in &c.builder.log {
                let n = batch.positions.len();
                assert!(batch.colors.iter().all(|colors| colors.len() == n));
                assert!(batch.edges.iter().all(|edges| edges.len() == n));
                assert!(batch.tex.iter().flatten().all(|tex| tex.len() == n));
                let last = batch.primitives.iter().map(|p| p.first + p.count).max().unwrap();
                assert!((0..last).all(|i| batch.vertex(i) < n));
            }
        }
    }
}
