//! Feedback and selection: what would be drawn goes to a buffer of numbers, or is only looked at.

mod clip;
mod names;
mod primitives;

use crate::state::State;
use crate::tnl::{ProcessedVertex, Wanted};
use crate::vertex::VertexBatch;
use crate::{Context, enums};
use clip::View;

/// Feedback and selection.
#[derive(Debug)]
pub(crate) struct Feedback {
    /// `RENDER_MODE`.
    pub(crate) mode: u32,
    /// `FEEDBACK_BUFFER_POINTER`, `_SIZE`, `_TYPE`.
    pub(crate) buffer: Option<(usize, usize, u32)>,
    /// `SELECTION_BUFFER_POINTER`, `_SIZE`.
    pub(crate) selection: Option<(usize, usize)>,
    /// The name stack.
    pub(crate) names: Vec<u32>,
    /// Feedback so far.
    values: Vec<f32>,
    /// Hit records so far.
    records: Vec<u32>,
    hits: i32,
    /// Something had no room.
    overflow: bool,
    /// Least and greatest window depth of what was hit since the name stack changed.
    hit: Option<(f32, f32)>,
}

impl Default for Feedback {
    fn default() -> Self {
        Self {
            mode: enums::RENDER,
            buffer: None,
            selection: None,
            names: Vec::new(),
            values: Vec::new(),
            records: Vec::new(),
            hits: 0,
            overflow: false,
            hit: None,
        }
    }
}

/// A vertex, with the coordinates that feedback tells: those of unit 0.
type Vertex = ProcessedVertex<1>;

/// A vertex as feedback tells it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct FeedbackVertex {
    /// Window x, y, z; clip w.
    window: [f32; 4],
    color: [f32; 4],
    tex: [f32; 4],
}

impl Feedback {
    /// Something was hit at a window depth.
    pub(super) fn hit(&mut self, z: f32) {
        if self.mode == enums::SELECT {
            let (least, greatest) = self.hit.unwrap_or((z, z));
            self.hit = Some((least.min(z), greatest.max(z)));
        }
    }

    /// Adds values, as far as there is room.
    fn push(&mut self, values: &[f32]) {
        let room = self.buffer.map_or(0, |(_, size, _)| size).saturating_sub(self.values.len());
        self.values.extend_from_slice(&values[..values.len().min(room)]);
        self.overflow |= values.len() > room;
    }

    /// Which parts of vertices are told: how many window coordinates, whether colours, whether
    /// coordinates of textures.
    fn parts(&self) -> (usize, bool, bool) {
        match self.buffer.map_or(enums::_2D, |(_, _, kind)| kind) {
            enums::_2D => (2, false, false),
            enums::_3D => (3, false, false),
            enums::_3D_COLOR => (3, true, false),
            enums::_3D_COLOR_TEXTURE => (3, true, true),
            _ => (4, true, true),
        }
    }

    /// What vertices need besides their places.
    fn wanted(&self) -> Wanted {
        match self.parts() {
            _ if self.mode == enums::SELECT => Wanted::Places,
            (_, false, _) => Wanted::Places,
            (_, true, false) => Wanted::Colors,
            (_, true, true) => Wanted::All,
        }
    }

    /// A primitive: its token, the number of vertices if that is told, and the vertices.
    fn primitive(&mut self, token: u32, count: Option<usize>, vertices: &[FeedbackVertex]) {
        // Count a hit in selection.
        if self.mode == enums::SELECT {
            vertices.iter().for_each(|vertex| self.hit(vertex.window[2]));
            return;
        }

        // Write the token and the vertices in feedback.
        self.push(&[token as f32]);
        if let Some(count) = count {
            self.push(&[count as f32]);
        }
        let (window, color, tex) = self.parts();
        for vertex in vertices {
            self.push(&vertex.window[..window]);
            if color {
                self.push(&vertex.color);
            }
            if tex {
                self.push(&vertex.tex);
            }
        }
    }

    /// Writes the hit record, if something was hit since the last.
    fn record_hit(&mut self) {
        let Some((least, greatest)) = self.hit.take() else { return };
        if self.overflow {
            return;
        }
        let size = self.selection.map_or(0, |(_, size)| size);
        let depth = |z: f32| (f64::from(z.clamp(0.0, 1.0)) * f64::from(u32::MAX)).round() as u32;
        let head = [self.names.len() as u32, depth(least), depth(greatest)];
        for value in head.iter().chain(&self.names) {
            if self.records.len() < size { self.records.push(*value) } else { self.overflow = true }
        }
        if !self.overflow {
            self.hits += 1;
        }
    }
}

impl Context {
    /// `glFeedbackBuffer`.
    pub fn feedback_buffer(&mut self, size: i32, type_: u32, buffer: usize) {
        const CALL: &str = "glFeedbackBuffer";
        if self.refused_inside_begin(CALL) {
        } else if self.feedback.mode == enums::FEEDBACK {
            self.record_error(enums::INVALID_OPERATION, CALL, "the render mode is feedback");
        } else if !(enums::_2D..=enums::_4D_COLOR_TEXTURE).contains(&type_) {
            self.record_error(
                enums::INVALID_ENUM,
                CALL,
                &format!("type {type_:#x} is not one of feedback"),
            );
        } else if let Ok(size) = usize::try_from(size) {
            self.feedback.buffer = Some((buffer, size, type_));
        } else {
            self.record_error(enums::INVALID_VALUE, CALL, &format!("size {size} is negative"));
        }
    }

    /// `glSelectBuffer`.
    pub fn select_buffer(&mut self, size: i32, buffer: usize) {
        const CALL: &str = "glSelectBuffer";
        if self.refused_inside_begin(CALL) {
        } else if self.feedback.mode == enums::SELECT {
            self.record_error(enums::INVALID_OPERATION, CALL, "the render mode is selection");
        } else if let Ok(size) = usize::try_from(size) {
            self.feedback.selection = Some((buffer, size));
        } else {
            self.record_error(enums::INVALID_VALUE, CALL, &format!("size {size} is negative"));
        }
    }

    /// `glRenderMode`: what the mode that is left has gathered; -1 if that had no room.
    pub fn render_mode(&mut self, mode: u32) -> i32 {
        const CALL: &str = "glRenderMode";
        if self.refused_inside_begin(CALL) {
            return 0;
        }

        // Check that the new mode has a buffer.
        let buffer = match mode {
            enums::RENDER => true,
            enums::FEEDBACK => self.feedback.buffer.is_some(),
            enums::SELECT => self.feedback.selection.is_some(),
            _ => {
                self.record_error(
                    enums::INVALID_ENUM,
                    CALL,
                    &format!("mode {mode:#x} is not a render mode"),
                );
                return 0;
            }
        };
        if !buffer {
            self.record_error(enums::INVALID_OPERATION, CALL, "that mode has no buffer");
            return 0;
        }

        // Leave the old mode and reset the counters.
        let result = self.leave_mode();
        let feedback = &mut self.feedback;
        feedback.mode = mode;
        feedback.names.clear();
        (feedback.hits, feedback.overflow, feedback.hit) = (0, false, None);
        result
    }

    /// Hands what was gathered to the client.
    fn leave_mode(&mut self) -> i32 {
        let feedback = &mut self.feedback;
        if feedback.mode == enums::SELECT {
            feedback.record_hit();
        }

        // Choose what the mode has gathered.
        let (values, records) =
            (std::mem::take(&mut feedback.values), std::mem::take(&mut feedback.records));
        let (address, bytes, count): (_, &[u8], _) = match feedback.mode {
            enums::FEEDBACK => (
                feedback.buffer.map_or(0, |buffer| buffer.0),
                bytemuck::cast_slice(&values),
                values.len() as i32,
            ),
            enums::SELECT => (
                feedback.selection.map_or(0, |buffer| buffer.0),
                bytemuck::cast_slice(&records),
                feedback.hits,
            ),
            _ => return 0,
        };

        // Write it to the client's buffer.
        let result = if feedback.overflow { -1 } else { count };
        if !bytes.is_empty() && (address == 0 || !self.memory.write(address, bytes)) {
            self.record_error(enums::INVALID_VALUE, "glRenderMode", "the buffer cannot be written");
        }
        result
    }

    /// `glPassThrough`.
    pub fn pass_through(&mut self, token: f32) {
        self.listable(move |c| {
            if !c.refused_inside_begin("glPassThrough") && c.feedback.mode == enums::FEEDBACK {
                c.feedback.push(&[enums::PASS_THROUGH_TOKEN as f32, token]);
            }
        });
    }

    /// Whether fragments are drawn; else primitives go to feedback or selection.
    pub(crate) fn renders(&self) -> bool {
        self.feedback.mode == enums::RENDER
    }

    /// What a pixel rectangle or bitmap (`token`) tells where it is not drawn.
    pub(crate) fn feedback_image(&mut self, token: u32) {
        let position = &self.state.raster_position;
        if self.feedback.mode == enums::FEEDBACK && position.valid {
            let vertex = FeedbackVertex {
                window: position.window,
                color: position.color,
                tex: position.tex[0],
            };
            self.feedback.primitive(token, None, &[vertex]);
        }
    }

    /// Sends a batch to feedback or selection.
    pub(super) fn feed_batch(&mut self, batch: &VertexBatch) {
        let processed = self.process_batch(batch, self.feedback.wanted());
        if processed.len() == batch.positions.len() {
            let view = View::of(&self.state);
            primitives::feed(batch, &processed, &view, &mut self.feedback);
        }
    }
}

/// Whether polygons of a facing are dropped.
fn is_culled(state: &State, front: bool) -> bool {
    let polygons = &state.polygons;
    polygons.cull
        && match polygons.cull_mode {
            enums::FRONT => front,
            enums::BACK => !front,
            _ => true,
        }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{BASE, context};
    use super::*;
    use crate::vertices::client;

    #[test]
    fn images_and_marks_are_told() {
        let mut c = context();
        assert_eq!(c.render_mode(enums::FEEDBACK), 0);
        assert_eq!(std::mem::take(&mut c.error), enums::INVALID_OPERATION);
        c.feedback_buffer(6, enums::_3D, BASE);
        c.render_mode(enums::FEEDBACK);
        assert!(!c.renders());
        c.window_pos_2i(7, 8);
        c.feedback_image(enums::BITMAP_TOKEN);
        c.pass_through(5.0);
        assert_eq!(c.render_mode(enums::RENDER), 6);
        let told = client::values::<f32>(&*c.memory, BASE, 6).unwrap();
        assert_eq!(
            told,
            [enums::BITMAP_TOKEN as f32, 7.0, 8.0, 0.0, enums::PASS_THROUGH_TOKEN as f32, 5.0]
        );
        c.render_mode(enums::FEEDBACK);
        (0..4).for_each(|_| c.pass_through(1.0));
        assert_eq!((c.render_mode(enums::RENDER), c.error), (-1, 0));
    }

    #[test]
    fn hits_are_recorded_with_their_names() {
        let mut c = context();
        c.push_name(1);
        c.select_buffer(9, BASE);
        assert_eq!((c.render_mode(enums::SELECT), c.error), (0, 0));
        c.load_name(3);
        assert_eq!(std::mem::take(&mut c.error), enums::INVALID_OPERATION);
        c.push_name(7);
        c.push_name(8);
        c.window_pos_3f(0.0, 0.0, 1.0);
        c.window_pos_3f(0.0, 0.0, 0.0);
        c.load_name(9);
        c.pop_name();
        c.window_pos_3f(0.0, 0.0, 1.0);
        assert_eq!(c.render_mode(enums::RENDER), 2);
        let told = client::values::<u32>(&*c.memory, BASE, 9).unwrap();
        assert_eq!(told, [2, 0, u32::MAX, 7, 8, 1, u32::MAX, u32::MAX, 7]);
        c.render_mode(enums::SELECT);
        c.pop_name();
        assert_eq!(std::mem::take(&mut c.error), enums::STACK_UNDERFLOW);
        (0..129).for_each(|name| c.push_name(name));
        assert_eq!(std::mem::take(&mut c.error), enums::STACK_OVERFLOW);
        c.window_pos_2i(0, 0);
        assert_eq!(c.render_mode(enums::RENDER), -1);
    }

    #[test]
    fn refused_names_record_nothing() {
        type Call = fn(&mut Context);
        let calls: [(Call, usize); 3] =
            [(|c| c.load_name(3), 0), (|c| c.pop_name(), 0), (|c| c.push_name(3), 128)];
        for (call, names) in calls {
            let mut c = context();
            c.select_buffer(400, BASE);
            c.render_mode(enums::SELECT);
            (0..names).for_each(|name| c.push_name(name as u32));
            c.window_pos_3f(0.0, 0.0, 1.0);
            call(&mut c);
            assert_ne!(std::mem::take(&mut c.error), 0);
            c.window_pos_3f(0.0, 0.0, 0.0);
            assert_eq!(c.render_mode(enums::RENDER), 1, "one record over both depths");
            assert_eq!(
                client::values::<u32>(&*c.memory, BASE, 3).unwrap(),
                [names as u32, 0, u32::MAX]
            );
        }
    }
}
