//! The server and client attribute stacks.
//!
//! `PushAttrib` keeps a copy of each group in its mask; some fields are in two groups (an enable is in `ENABLE_BIT` and
//! in the group of its feature) and may come back twice.

use super::capabilities::saved_capabilities;
use super::foreign::BoundTextures;
use crate::state::{
    Blend, ClientState, ColorBuffer, Current, DepthState, Fog, Lighting, Lines, MAX_ATTRIB_STACK_DEPTH,
    MAX_CLIP_PLANES, MAX_TEXTURE_UNITS, PixelMode, PixelStore, PixelTransfer, Points, Polygons, RasterPosition,
    Scissor, StencilState, TextureUnit, Viewport,
};
use crate::{Context, enums as gl};
use std::sync::Arc;

/// The attribute stacks.
#[derive(Debug, Default)]
pub(crate) struct AttribStacks {
    server: Vec<Groups>,
    client: Vec<ClientGroups>,
}

impl AttribStacks {
    /// `ATTRIB_STACK_DEPTH`.
    pub(super) fn server_depth(&self) -> usize {
        self.server.len()
    }

    /// `CLIENT_ATTRIB_STACK_DEPTH`.
    pub(super) fn client_depth(&self) -> usize {
        self.client.len()
    }
}

/// What one `PushAttrib` kept.
#[derive(Debug)]
struct Groups {
    accum: Option<[f32; 4]>,
    color_buffer: Option<ColorGroup>,
    current: Option<Box<(Current, RasterPosition)>>,
    depth: Option<DepthState>,
    enable: Option<Enables>,
    eval: Option<EvalGroup>,
    fog: Option<(Fog, bool)>,
    hint: Option<[(u32, u32); 7]>,
    lighting: Option<Box<Lighting>>,
    line: Option<Lines>,
    list: Option<u32>,
    pixel_mode: Option<(PixelTransfer, PixelMode)>,
    point: Option<PointGroup>,
    polygon: Option<Polygons>,
    stipple: Option<Arc<[u32; 32]>>,
    scissor: Option<Scissor>,
    stencil: Option<StencilState>,
    texture: Option<Box<TextureGroup>>,
    transform: Option<TransformGroup>,
    viewport: Option<Viewport>,
    multisample: Option<MultisampleGroup>,
}

#[derive(Debug)]
struct ColorGroup {
    alpha_test: (bool, u32, f32),
    blend: Blend,
    dither: bool,
    logic_op: (bool, u32),
    index_logic_op: bool,
    buffer: ColorBuffer,
    framebuffer_srgb: bool,
}

#[derive(Debug)]
struct EvalGroup {
    enabled: [[bool; 9]; 2],
    auto_normal: bool,
    grid1: (i32, [f32; 2]),
    grid2: ([i32; 2], [f32; 2], [f32; 2]),
}

/// Coordinate replacement is set with `TexEnv` but goes with the points.
#[derive(Debug)]
struct PointGroup {
    points: Points,
    coord_replace: [bool; MAX_TEXTURE_UNITS],
}

#[derive(Debug)]
struct TextureGroup {
    units: [TextureUnit; MAX_TEXTURE_UNITS],
    active: usize,
    cube_map_seamless: bool,
    parameters: BoundTextures,
}

#[derive(Debug)]
struct TransformGroup {
    mode: u32,
    normalize: bool,
    rescale_normal: bool,
    clip_planes: [[f64; 4]; MAX_CLIP_PLANES],
    clip_plane_enabled: [bool; MAX_CLIP_PLANES],
    depth_clamp: bool,
    clip_control: (u32, u32),
}

#[derive(Debug)]
struct MultisampleGroup {
    multisample: bool,
    alpha_to_coverage: bool,
    alpha_to_one: bool,
    coverage: bool,
    coverage_value: (f32, bool),
}

#[derive(Debug)]
struct Enables {
    single: Vec<bool>,
    targets: [[bool; 5]; MAX_TEXTURE_UNITS],
    generation: [[bool; 4]; MAX_TEXTURE_UNITS],
}

#[derive(Debug)]
struct ClientGroups {
    pixel_store: Option<[PixelStore; 2]>,
    arrays: Option<Box<ClientState>>,
}

/// Saving.
impl Context {
    fn save_groups(&mut self, mask: u32) -> Groups {
        fn take<T>(wanted: bool, make: impl FnOnce() -> T) -> Option<T> {
            wanted.then(make)
        }
        self.track_color_material();
        let has = |bit| mask & bit != 0;
        let enable = take(has(gl::ENABLE_BIT), || self.save_enables());
        let texture = take(has(gl::TEXTURE_BIT), || self.save_texture_group());
        let color_buffer = take(has(gl::COLOR_BUFFER_BIT), || self.save_color_group());
        let s = &self.state;
        Groups {
            accum: take(has(gl::ACCUM_BUFFER_BIT), || s.color_buffer.accum_clear),
            color_buffer,
            current: take(has(gl::CURRENT_BIT), || Box::new((s.current, s.raster_position))),
            depth: take(has(gl::DEPTH_BUFFER_BIT), || s.depth),
            enable,
            eval: take(has(gl::EVAL_BIT), || self.save_eval_group()),
            fog: take(has(gl::FOG_BIT), || (s.fog, s.color_sum)),
            hint: take(has(gl::HINT_BIT), || s.hints),
            lighting: take(has(gl::LIGHTING_BIT), || Box::new(s.lighting.clone())),
            line: take(has(gl::LINE_BIT), || s.lines),
            list: take(has(gl::LIST_BIT), || s.list_base),
            pixel_mode: take(has(gl::PIXEL_MODE_BIT), || {
                let read_buffer = self.read_buffer_token();
                (s.pixel.clone(), PixelMode { read_buffer, ..s.pixel_mode })
            }),
            point: take(has(gl::POINT_BIT), || self.save_point_group()),
            polygon: take(has(gl::POLYGON_BIT), || s.polygons.clone()),
            stipple: take(has(gl::POLYGON_STIPPLE_BIT), || s.polygons.stipple_pattern.clone()),
            scissor: take(has(gl::SCISSOR_BIT), || s.scissor),
            stencil: take(has(gl::STENCIL_BUFFER_BIT), || s.stencil),
            texture,
            transform: take(has(gl::TRANSFORM_BIT), || self.save_transform_group()),
            viewport: take(has(gl::VIEWPORT_BIT), || s.viewport),
            multisample: take(has(gl::MULTISAMPLE_BIT), || self.save_multisample_group()),
        }
    }

    fn save_enables(&mut self) -> Enables {
        Enables {
            single: saved_capabilities().map(|cap| self.capability(cap).is_some_and(|on| *on)).collect(),
            targets: std::array::from_fn(|i| self.state.units[i].enabled),
            generation: std::array::from_fn(|i| self.state.units[i].generation.map(|g| g.enabled)),
        }
    }

    fn save_texture_group(&mut self) -> Box<TextureGroup> {
        let parameters = self.save_bound_textures();
        let s = &self.state;
        Box::new(TextureGroup {
            units: s.units.clone(),
            active: s.active_unit,
            cube_map_seamless: s.cube_map_seamless,
            parameters,
        })
    }

    fn save_color_group(&self) -> ColorGroup {
        let s = &self.state;
        ColorGroup {
            alpha_test: s.alpha_test,
            blend: s.blend,
            dither: s.dither,
            logic_op: s.logic_op,
            index_logic_op: s.index_logic_op,
            buffer: ColorBuffer { draw_buffer: self.draw_buffer_token(), ..s.color_buffer },
            framebuffer_srgb: s.framebuffer_srgb,
        }
    }

    fn save_eval_group(&self) -> EvalGroup {
        let eval = &self.state.eval;
        EvalGroup {
            enabled: [eval.map1_enabled, eval.map2_enabled],
            auto_normal: eval.auto_normal,
            grid1: eval.grid1,
            grid2: eval.grid2,
        }
    }

    fn save_point_group(&self) -> PointGroup {
        let coord_replace = std::array::from_fn(|i| self.state.units[i].environment.coord_replace);
        PointGroup { points: self.state.points, coord_replace }
    }

    fn save_transform_group(&self) -> TransformGroup {
        let s = &self.state;
        TransformGroup {
            mode: s.matrices.mode,
            normalize: s.matrices.normalize,
            rescale_normal: s.matrices.rescale_normal,
            clip_planes: s.clip_planes,
            clip_plane_enabled: s.clip_plane_enabled,
            depth_clamp: s.depth_clamp,
            clip_control: s.clip_control,
        }
    }

    fn save_multisample_group(&self) -> MultisampleGroup {
        let s = &self.state;
        MultisampleGroup {
            multisample: s.multisample,
            alpha_to_coverage: s.sample_alpha_to_coverage,
            alpha_to_one: s.sample_alpha_to_one,
            coverage: s.sample_coverage,
            coverage_value: s.sample_coverage_value,
        }
    }
}

/// Stores what is there.
fn put<T>(saved: Option<T>, field: &mut T) {
    if let Some(saved) = saved {
        *field = saved;
    }
}

/// Restoring.
impl Context {
    fn restore_groups(&mut self, saved: Groups) {
        self.track_color_material();
        let s = &mut self.state;
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
        saved.color_buffer.into_iter().for_each(|group| self.restore_color_group(group));
        saved.eval.into_iter().for_each(|group| self.restore_eval_group(&group));
        saved.pixel_mode.into_iter().for_each(|(transfer, mode)| self.restore_pixel_group(transfer, mode));
        saved.transform.into_iter().for_each(|group| self.restore_transform_group(&group));
        saved.multisample.into_iter().for_each(|group| self.restore_multisample_group(&group));
        saved.texture.into_iter().for_each(|group| self.restore_texture_group(*group));
        saved.point.into_iter().for_each(|group| self.restore_point_group(&group));
        saved.enable.into_iter().for_each(|group| self.restore_enables(&group));
        self.track_color_material();
        self.material_changed();
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

    /// Clear values of the accumulation buffer are in a group of their own; the draw buffer may belong to a framebuffer
    /// object.
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

    /// Textures deleted since are replaced by the default one.
    fn restore_texture_group(&mut self, saved: TextureGroup) {
        for (i, mut unit) in saved.units.into_iter().enumerate() {
            for name in &mut unit.bindings {
                if *name != 0 && !self.object_exists(gl::TEXTURE, *name) {
                    *name = 0;
                }
            }
            unit.environment.coord_replace = self.state.units[i].environment.coord_replace;
            self.state.units[i] = unit;
        }
        self.state.active_unit = saved.active;
        self.state.cube_map_seamless = saved.cube_map_seamless;
        self.restore_bound_textures(&saved.parameters);
    }

    fn restore_point_group(&mut self, saved: &PointGroup) {
        self.state.points = saved.points;
        for (unit, on) in self.state.units.iter_mut().zip(saved.coord_replace) {
            unit.environment.coord_replace = on;
        }
    }

    fn restore_arrays(&mut self, saved: ClientState) {
        if saved.vertex_array != self.client.vertex_array {
            if saved.vertex_array != 0 && !self.object_exists(gl::VERTEX_ARRAY, saved.vertex_array) {
                return;
            }
            self.switch_vertex_array(saved.vertex_array);
        }
        let (unpack, pack) = (self.client.unpack, self.client.pack);
        self.client = ClientState { unpack, pack, ..saved };
        for binding in [saved.array_buffer, saved.element_buffer] {
            if binding != 0 && !self.object_exists(gl::BUFFER, binding) {
                self.drop_buffer_binding(binding);
            }
        }
    }

    fn drop_buffer_binding(&mut self, name: u32) {
        for binding in [&mut self.client.array_buffer, &mut self.client.element_buffer] {
            if *binding == name {
                *binding = 0;
            }
        }
    }
}

/// The calls.
impl Context {
    /// `glPushAttrib`.
    pub fn push_attrib(&mut self, mask: u32) {
        self.listable(move |c| {
            let call = "glPushAttrib";
            if !c.may_set(call) {
            } else if c.stacks.server.len() >= MAX_ATTRIB_STACK_DEPTH {
                c.record_error(gl::STACK_OVERFLOW, call, "the attribute stack is full");
            } else {
                let groups = c.save_groups(mask);
                c.stacks.server.push(groups);
            }
        });
    }

    /// `glPopAttrib`.
    pub fn pop_attrib(&mut self) {
        self.listable(|c| {
            let call = "glPopAttrib";
            if !c.may_set(call) {
                return;
            }
            match c.stacks.server.pop() {
                Some(groups) => c.restore_groups(groups),
                None => c.record_error(gl::STACK_UNDERFLOW, call, "the attribute stack is empty"),
            }
        });
    }

    /// `glPushClientAttrib`.
    pub fn push_client_attrib(&mut self, mask: u32) {
        let call = "glPushClientAttrib";
        if !self.may_set(call) {
        } else if self.stacks.client.len() >= MAX_ATTRIB_STACK_DEPTH {
            self.record_error(gl::STACK_OVERFLOW, call, "the client attribute stack is full");
        } else {
            let client = &self.client;
            self.stacks.client.push(ClientGroups {
                pixel_store: (mask & gl::CLIENT_PIXEL_STORE_BIT != 0).then_some([client.unpack, client.pack]),
                arrays: (mask & gl::CLIENT_VERTEX_ARRAY_BIT != 0).then(|| Box::new(client.clone())),
            });
        }
    }

    /// `glPopClientAttrib`.
    pub fn pop_client_attrib(&mut self) {
        let call = "glPopClientAttrib";
        if !self.may_set(call) {
            return;
        }
        let Some(saved) = self.stacks.client.pop() else {
            return self.record_error(gl::STACK_UNDERFLOW, call, "the client attribute stack is empty");
        };
        if let Some([unpack, pack]) = saved.pixel_store {
            (self.client.unpack, self.client.pack) = (unpack, pack);
        }
        if let Some(arrays) = saved.arrays {
            self.restore_arrays(*arrays);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::testing::context;
    use crate::state::{State, target};

    #[test]
    fn stacks_end_at_both_ends() {
        let mut c = context();
        for _ in 0..MAX_ATTRIB_STACK_DEPTH {
            c.push_attrib(gl::ALL_ATTRIB_BITS);
            c.push_client_attrib(gl::CLIENT_ALL_ATTRIB_BITS);
        }
        assert_eq!(c.get_error(), gl::NO_ERROR);
        c.push_attrib(0);
        assert_eq!(c.get_error(), gl::STACK_OVERFLOW);
        c.push_client_attrib(0);
        assert_eq!(c.get_error(), gl::STACK_OVERFLOW);
        for _ in 0..MAX_ATTRIB_STACK_DEPTH {
            c.pop_attrib();
            c.pop_client_attrib();
        }
        assert_eq!(c.get_error(), gl::NO_ERROR);
        c.pop_attrib();
        assert_eq!(c.get_error(), gl::STACK_UNDERFLOW);
        c.pop_client_attrib();
        assert_eq!(c.get_error(), gl::STACK_UNDERFLOW);
    }

    /// Changes something of every group, through calls.
    fn stir(c: &mut Context) {
        c.state.current.fog = 3.0;
        c.point_size(2.0);
        c.tex_envi(gl::POINT_SPRITE_ARB, gl::COORD_REPLACE_ARB, 1);
        c.line_width(2.0);
        c.cull_face(gl::FRONT);
        c.state.polygons.stipple_pattern = Arc::new([7; 32]);
        c.pixel_zoom(2.0, 2.0);
        c.pixel_transferi(gl::RED_BIAS, 1);
        c.shade_model(gl::FLAT);
        c.fogi(gl::FOG_MODE, gl::LINEAR as i32);
        c.depth_func(gl::ALWAYS);
        c.clear_accum(1.0, 1.0, 1.0, 1.0);
        c.stencil_mask(1);
        c.viewport(1, 2, 3, 4);
        c.matrix_mode(gl::TEXTURE);
        c.clip_control(gl::UPPER_LEFT, gl::ZERO_TO_ONE);
        c.clear_color(1.0, 1.0, 1.0, 1.0);
        c.blend_func(gl::ZERO, gl::ONE);
        c.hint(gl::FOG_HINT, gl::NICEST);
        c.state.eval.grid1.0 = 5;
        c.state.list_base = 9;
        c.active_texture(gl::TEXTURE2);
        c.tex_envi(gl::TEXTURE_ENV, gl::TEXTURE_ENV_MODE, gl::DECAL as i32);
        c.scissor(1, 1, 1, 1);
        c.sample_coverage(0.5, 1);
        for cap in saved_capabilities().chain([gl::TEXTURE_2D, gl::TEXTURE_GEN_R]).collect::<Vec<_>>() {
            let on = c.is_enabled(cap) == 0;
            if on {
                c.enable(cap)
            } else {
                c.disable(cap)
            };
        }
        assert_eq!(c.get_error(), gl::NO_ERROR);
    }

    fn show(state: &State) -> String {
        format!("{state:?}")
    }

    #[test]
    fn all_bits_restore_all_state() {
        let mut c = context();
        let before = show(&c.state);
        c.push_attrib(gl::ALL_ATTRIB_BITS);
        stir(&mut c);
        assert_ne!(show(&c.state), before);
        c.pop_attrib();
        assert_eq!(show(&c.state), before);
    }

    #[test]
    fn no_bits_restore_nothing_and_enables_restore_switches() {
        let mut c = context();
        c.push_attrib(gl::ENABLE_BIT);
        c.push_attrib(0);
        stir(&mut c);
        let stirred = show(&c.state);
        c.pop_attrib();
        assert_eq!(show(&c.state), stirred);
        c.pop_attrib();
        c.active_texture(gl::TEXTURE0);
        let on: Vec<u32> = saved_capabilities().filter(|cap| c.is_enabled(*cap) == 1).collect();
        assert_eq!(on, [gl::DITHER, gl::MULTISAMPLE]);
        assert!(!c.state.units[2].enabled[target::TWO] && !c.state.units[2].generation[2].enabled);
        assert_eq!(c.state.depth.func, gl::ALWAYS);
    }

    #[test]
    fn neighbours_of_a_group_stay() {
        let mut c = context();
        c.push_attrib(gl::POLYGON_BIT | gl::TEXTURE_BIT | gl::COLOR_BUFFER_BIT | gl::PIXEL_MODE_BIT);
        stir(&mut c);
        c.pop_attrib();
        assert_eq!(c.state.polygons.cull_mode, gl::BACK);
        assert_eq!(c.state.polygons.stipple_pattern[0], 7);
        assert_eq!(c.state.color_buffer.accum_clear, [1.0; 4]);
        assert_eq!(c.state.color_buffer.clear, [0.0; 4]);
        assert!(c.state.units[0].environment.coord_replace);
        assert_eq!(c.state.pixel.bias[0], 0.0);
    }

    #[test]
    fn client_groups() {
        let mut c = context();
        c.push_client_attrib(gl::CLIENT_PIXEL_STORE_BIT);
        c.pixel_storei(gl::UNPACK_ALIGNMENT, 1);
        c.client.vertex.enabled = true;
        c.push_client_attrib(gl::CLIENT_VERTEX_ARRAY_BIT);
        c.client.vertex.enabled = false;
        c.client.active_unit = 3;
        c.pop_client_attrib();
        assert!(c.client.vertex.enabled && c.client.active_unit == 0 && c.client.unpack.alignment == 1);
        c.pop_client_attrib();
        assert!(c.client.vertex.enabled && c.client.unpack.alignment == 4);
    }

    #[test]
    fn materials_and_colors_come_back_together() {
        let mut c = context();
        c.enable(gl::COLOR_MATERIAL);
        c.state.current.color = [0.25; 4];
        c.push_attrib(gl::CURRENT_BIT);
        c.state.current.color = [0.75; 4];
        c.pop_attrib();
        assert_eq!(c.state.lighting.material[1].diffuse, [0.25; 4]);
    }
}
