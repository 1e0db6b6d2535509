//! How groups come back.

use super::groups::{
    ColorGroup, Enables, EvalGroup, Groups, MultisampleGroup, PointGroup, TextureGroup,
    TransformGroup,
};
use crate::api::capabilities::saved_capabilities;
use crate::objects::BufferHandle;
use crate::state::{ClientState, ColorBuffer, PixelMode, PixelTransfer, Polygons};
use crate::{Context, enums as gl};

/// Stores the saved value, if there is one.
fn put<T>(saved: Option<T>, field: &mut T) {
    if let Some(saved) = saved {
        *field = saved;
    }
}

/// Restoring.
impl Context {
    pub(super) fn restore_groups(&mut self, saved: Groups) {
        self.track_color_material();
        let materials = saved.lighting.is_some();
        let s = &mut self.state;

        // Restore the groups that are stored as they are.
        if let Some(current) = saved.current {
            (s.current, s.raster_position) = *current;
        }
        put(saved.accum, &mut s.color_buffer.accum_clear);
        put(saved.depth, &mut s.depth);
        put(saved.hint, &mut s.hints);
        put(saved.line, &mut s.lines);
        put(saved.list, &mut s.list_base);
        put(saved.scissor, &mut s.scissor);
        put(saved.stencil, &mut s.stencil);
        put(saved.viewport, &mut s.viewport);

        // Restore the groups that keep a part of the current state.
        if let Some((fog, color_sum)) = saved.fog {
            (s.fog, s.color_sum) = (fog, color_sum);
        }
        if let Some(lighting) = saved.lighting {
            s.lighting = *lighting;
        }
        if let Some(polygons) = saved.polygon {
            let stipple_pattern = s.polygons.stipple_pattern.clone();
            s.polygons = Polygons { stipple_pattern, ..polygons };
        }
        put(saved.stipple, &mut s.polygons.stipple_pattern);

        // Restore the groups whose changes have consequences.
        saved.color_buffer.into_iter().for_each(|group| self.restore_color_group(group));
        saved.eval.into_iter().for_each(|group| self.restore_eval_group(&group));
        saved
            .pixel_mode
            .into_iter()
            .for_each(|(transfer, mode)| self.restore_pixel_group(transfer, mode));
        saved.transform.into_iter().for_each(|group| self.restore_transform_group(&group));
        saved.multisample.into_iter().for_each(|group| self.restore_multisample_group(&group));
        saved.texture.into_iter().for_each(|group| self.restore_texture_group(*group));
        saved.point.into_iter().for_each(|group| self.restore_point_group(&group));
        saved.enable.into_iter().for_each(|group| self.restore_enables(&group));

        // Recompute the material if lighting or the tracked colour may have changed.
        self.track_color_material();
        if materials || self.state.lighting.color_material.enabled {
            self.material_changed();
        }
    }

    fn restore_enables(&mut self, saved: &Enables) {
        for (cap, on) in saved_capabilities().zip(&saved.single) {
            if let Some(switch) = self.capability(cap) {
                *switch = *on;
            }
        }
        for (i, unit) in self.state.units.iter_mut().enumerate() {
            unit.enabled = saved.targets[i];
            for (generation, on) in unit.generation.iter_mut().zip(saved.generation[i]) {
                generation.enabled = on;
            }
        }
    }

    /// Clear values of the accumulation buffer are in a group of their own; the draw buffer may
    /// belong to a framebuffer object.
    fn restore_color_group(&mut self, saved: ColorGroup) {
        self.set_draw_buffer_token(saved.buffer.draw_buffer);
        let s = &mut self.state;
        s.alpha_test = saved.alpha_test;
        s.blend = saved.blend;
        s.dither = saved.dither;
        s.logic_op = saved.logic_op;
        s.index_logic_op = saved.index_logic_op;
        s.framebuffer_srgb = saved.framebuffer_srgb;
        let ColorBuffer { accum_clear, draw_buffer, .. } = s.color_buffer;
        s.color_buffer = ColorBuffer { accum_clear, draw_buffer, ..saved.buffer };
    }

    fn restore_eval_group(&mut self, saved: &EvalGroup) {
        let eval = &mut self.state.eval;
        [eval.map1_enabled, eval.map2_enabled] = saved.enabled;
        eval.auto_normal = saved.auto_normal;
        eval.grid1 = saved.grid1;
        eval.grid2 = saved.grid2;
    }

    /// Pixel maps are in no group.
    fn restore_pixel_group(&mut self, transfer: PixelTransfer, mode: PixelMode) {
        self.set_read_buffer_token(mode.read_buffer);
        let maps = self.state.pixel.maps.clone();
        self.state.pixel = PixelTransfer { maps, ..transfer };
        self.state.pixel_mode.zoom = mode.zoom;
    }

    fn restore_transform_group(&mut self, saved: &TransformGroup) {
        let s = &mut self.state;
        s.matrices.mode = saved.mode;
        s.matrices.normalize = saved.normalize;
        s.matrices.rescale_normal = saved.rescale_normal;
        s.clip_planes = saved.clip_planes;
        s.clip_plane_enabled = saved.clip_plane_enabled;
        s.depth_clamp = saved.depth_clamp;
        s.clip_control = saved.clip_control;
    }

    fn restore_multisample_group(&mut self, saved: &MultisampleGroup) {
        let s = &mut self.state;
        s.multisample = saved.multisample;
        s.sample_alpha_to_coverage = saved.alpha_to_coverage;
        s.sample_alpha_to_one = saved.alpha_to_one;
        s.sample_coverage = saved.coverage;
        s.sample_coverage_value = saved.coverage_value;
    }

    fn restore_texture_group(&mut self, saved: TextureGroup) {
        for (i, mut unit) in saved.units.into_iter().enumerate() {
            unit.environment.coord_replace = self.state.units[i].environment.coord_replace;
            self.state.units[i] = unit;
        }
        self.state.active_unit = saved.active;
        self.state.cube_map_seamless = saved.cube_map_seamless;
        self.restore_bound_textures(saved.bound);
    }

    fn restore_point_group(&mut self, saved: &PointGroup) {
        self.state.points = saved.points;
        for (unit, on) in self.state.units.iter_mut().zip(saved.coord_replace) {
            unit.environment.coord_replace = on;
        }
    }

    pub(super) fn restore_arrays(&mut self, saved: ClientState) {
        if saved.vertex_array != self.client.vertex_array {
            if saved.vertex_array != 0 && !self.object_exists(gl::VERTEX_ARRAY, saved.vertex_array)
            {
                return;
            }
            self.switch_vertex_array(saved.vertex_array);
        }
        let old = std::mem::replace(&mut self.client, saved);
        (self.client.unpack, self.client.pack) = (old.unpack, old.pack);
        // Buffers deleted since are not bound.
        if !self.is_named(&self.client.array_buffer) {
            self.client.array_buffer = BufferHandle::NONE;
        }
        if !self.is_named(&self.client.element_buffer) {
            self.client.element_buffer = BufferHandle::NONE;
        }
    }
}
