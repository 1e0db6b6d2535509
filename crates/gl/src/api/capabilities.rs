//! Enable, Disable, IsEnabled.

use crate::state::{MAX_CLIP_PLANES, MAX_LIGHTS, target};
use crate::{Context, enums as gl};

/// The index of `token` in a run of `count` tokens from `first`.
pub(super) fn index_in(token: u32, first: u32, count: usize) -> Option<usize> {
    let index = token.checked_sub(first)? as usize;
    (index < count).then_some(index)
}

/// The server capabilities that are there once, but lights, clip planes and evaluators.
pub(super) const SINGLE_CAPABILITIES: [u32; 36] = [
    gl::ALPHA_TEST,
    gl::AUTO_NORMAL,
    gl::BLEND,
    gl::COLOR_LOGIC_OP,
    gl::COLOR_MATERIAL,
    gl::COLOR_SUM,
    gl::CULL_FACE,
    gl::DEPTH_CLAMP,
    gl::DEPTH_TEST,
    gl::DITHER,
    gl::FOG,
    gl::FRAMEBUFFER_SRGB,
    gl::INDEX_LOGIC_OP,
    gl::LIGHTING,
    gl::LINE_SMOOTH,
    gl::LINE_STIPPLE,
    gl::MULTISAMPLE,
    gl::NORMALIZE,
    gl::POINT_SMOOTH,
    gl::POINT_SPRITE_ARB,
    gl::POLYGON_OFFSET_FILL,
    gl::POLYGON_OFFSET_LINE,
    gl::POLYGON_OFFSET_POINT,
    gl::POLYGON_SMOOTH,
    gl::POLYGON_STIPPLE,
    gl::RASTER_POSITION_UNCLIPPED_IBM,
    gl::RESCALE_NORMAL,
    gl::SAMPLE_ALPHA_TO_COVERAGE,
    gl::SAMPLE_ALPHA_TO_ONE,
    gl::SAMPLE_COVERAGE,
    gl::SCISSOR_TEST,
    gl::STENCIL_TEST,
    gl::STENCIL_TEST_TWO_SIDE_EXT,
    gl::TEXTURE_CUBE_MAP_SEAMLESS,
    gl::DEBUG_OUTPUT,
    gl::DEBUG_OUTPUT_SYNCHRONOUS,
];

/// The capabilities of `ENABLE_BIT` that are there once: all but the last two, of the debug output.
pub(super) fn saved_capabilities() -> impl Iterator<Item = u32> {
    let planes = (0..MAX_CLIP_PLANES as u32).map(|i| gl::CLIP_PLANE0 + i);
    let lights = (0..MAX_LIGHTS as u32).map(|i| gl::LIGHT0 + i);
    let maps = (0..9).flat_map(|i| [gl::MAP1_COLOR_4 + i, gl::MAP2_COLOR_4 + i]);
    SINGLE_CAPABILITIES[..SINGLE_CAPABILITIES.len() - 2]
        .iter()
        .copied()
        .chain(planes)
        .chain(lights)
        .chain(maps)
}

/// Where the enables of a texture target are.
pub(super) fn texture_target(token: u32) -> Option<usize> {
    Some(match token {
        gl::TEXTURE_1D => target::ONE,
        gl::TEXTURE_2D => target::TWO,
        gl::TEXTURE_RECTANGLE_ARB => target::RECTANGLE,
        gl::TEXTURE_3D => target::THREE,
        gl::TEXTURE_CUBE_MAP => target::CUBE,
        _ => return None,
    })
}

impl Context {
    /// The switch of a server capability.
    pub(super) fn capability(&mut self, cap: u32) -> Option<&mut bool> {
        if SINGLE_CAPABILITIES.contains(&cap) {
            return self.fragment_capability(cap);
        }
        let state = &mut self.state;
        if let Some(i) = index_in(cap, gl::LIGHT0, MAX_LIGHTS) {
            return Some(&mut state.lighting.lights[i].enabled);
        }
        if let Some(i) = index_in(cap, gl::CLIP_PLANE0, MAX_CLIP_PLANES) {
            return Some(&mut state.clip_plane_enabled[i]);
        }
        if let Some(i) = index_in(cap, gl::MAP1_COLOR_4, 9) {
            return Some(&mut state.eval.map1_enabled[i]);
        }
        if let Some(i) = index_in(cap, gl::MAP2_COLOR_4, 9) {
            return Some(&mut state.eval.map2_enabled[i]);
        }
        let unit = &mut state.units[state.active_unit];
        if let Some(i) = texture_target(cap) {
            return Some(&mut unit.enabled[i]);
        }
        index_in(cap, gl::TEXTURE_GEN_S, 4).map(|i| &mut unit.generation[i].enabled)
    }

    fn fragment_capability(&mut self, cap: u32) -> Option<&mut bool> {
        Some(match cap {
            gl::ALPHA_TEST => &mut self.state.alpha_test.0,
            gl::BLEND => &mut self.state.blend.enabled,
            gl::COLOR_LOGIC_OP => &mut self.state.logic_op.0,
            gl::INDEX_LOGIC_OP => &mut self.state.index_logic_op,
            gl::DEPTH_TEST => &mut self.state.depth.enabled,
            gl::DITHER => &mut self.state.dither,
            gl::FRAMEBUFFER_SRGB => &mut self.state.framebuffer_srgb,
            gl::MULTISAMPLE => &mut self.state.multisample,
            gl::SAMPLE_ALPHA_TO_COVERAGE => &mut self.state.sample_alpha_to_coverage,
            gl::SAMPLE_ALPHA_TO_ONE => &mut self.state.sample_alpha_to_one,
            gl::SAMPLE_COVERAGE => &mut self.state.sample_coverage,
            gl::SCISSOR_TEST => &mut self.state.scissor.enabled,
            gl::STENCIL_TEST => &mut self.state.stencil.enabled,
            gl::STENCIL_TEST_TWO_SIDE_EXT => &mut self.state.stencil.two_side,
            gl::DEBUG_OUTPUT => &mut self.state.debug_output.0,
            gl::DEBUG_OUTPUT_SYNCHRONOUS => &mut self.state.debug_output.1,
            _ => return self.geometry_capability(cap),
        })
    }

    fn geometry_capability(&mut self, cap: u32) -> Option<&mut bool> {
        let s = &mut self.state;
        Some(match cap {
            gl::AUTO_NORMAL => &mut s.eval.auto_normal,
            gl::COLOR_MATERIAL => &mut s.lighting.color_material.enabled,
            gl::COLOR_SUM => &mut s.color_sum,
            gl::CULL_FACE => &mut s.polygons.cull,
            gl::DEPTH_CLAMP => &mut s.depth_clamp,
            gl::FOG => &mut s.fog.enabled,
            gl::LIGHTING => &mut s.lighting.enabled,
            gl::LINE_SMOOTH => &mut s.lines.smooth,
            gl::LINE_STIPPLE => &mut s.lines.stipple,
            gl::NORMALIZE => &mut s.matrices.normalize,
            gl::POINT_SMOOTH => &mut s.points.smooth,
            gl::POINT_SPRITE_ARB => &mut s.points.sprite,
            gl::POLYGON_OFFSET_POINT => &mut s.polygons.offset_enabled[0],
            gl::POLYGON_OFFSET_LINE => &mut s.polygons.offset_enabled[1],
            gl::POLYGON_OFFSET_FILL => &mut s.polygons.offset_enabled[2],
            gl::POLYGON_SMOOTH => &mut s.polygons.smooth,
            gl::POLYGON_STIPPLE => &mut s.polygons.stipple,
            gl::RASTER_POSITION_UNCLIPPED_IBM => &mut s.raster_position_unclipped,
            gl::RESCALE_NORMAL => &mut s.matrices.rescale_normal,
            gl::TEXTURE_CUBE_MAP_SEAMLESS => &mut s.cube_map_seamless,
            _ => return None,
        })
    }

    /// The switch of a client capability.
    pub(super) fn client_capability(&mut self, cap: u32) -> Option<&mut bool> {
        let client = &mut self.client;
        if cap == gl::PRIMITIVE_RESTART_NV {
            return Some(&mut client.restart.0);
        }
        let array = match cap {
            gl::VERTEX_ARRAY => &mut client.vertex,
            gl::NORMAL_ARRAY => &mut client.normal,
            gl::COLOR_ARRAY => &mut client.color,
            gl::INDEX_ARRAY => &mut client.index,
            gl::EDGE_FLAG_ARRAY => &mut client.edge,
            gl::TEXTURE_COORD_ARRAY => &mut client.tex[client.active_unit],
            gl::FOG_COORD_ARRAY => &mut client.fog,
            gl::SECONDARY_COLOR_ARRAY => &mut client.secondary,
            _ => return None,
        };
        Some(&mut array.enabled)
    }

    /// Sets a server capability; `false` if there is none of that name. What waits is drawn before
    /// it changes.
    pub(super) fn set_capability(&mut self, cap: u32, on: bool) -> bool {
        match self.capability(cap) {
            None => return false,
            Some(switch) if *switch == on => return true,
            Some(_) => self.flush_vertices(),
        }
        let coloring = cap == gl::COLOR_MATERIAL;
        if coloring {
            // What the current colour did to the material stays when tracking ends.
            self.track_color_material();
        }
        let Some(switch) = self.capability(cap) else { return false };
        *switch = on;
        if coloring {
            self.track_color_material();
        }
        true
    }

    fn exec_capability(&mut self, call: &'static str, cap: u32, on: bool) {
        if !self.may_set(call) {
            return;
        }
        if !self.set_capability(cap, on) {
            self.refuse_enum(call, "cap", cap);
        } else if cap == gl::COLOR_MATERIAL {
            self.material_changed();
        }
    }

    /// Arrays are client state: EXT_vertex_array enables them with Enable, which is then not
    /// compiled into lists.
    fn switch(&mut self, call: &'static str, cap: u32, on: bool) {
        if self.client_capability(cap).is_none() {
            self.listable_keeping(move |c| c.exec_capability(call, cap, on));
        } else if self.may_set(call)
            && let Some(switch) = self.client_capability(cap)
        {
            *switch = on;
        }
    }

    /// `glEnable`.
    pub fn enable(&mut self, cap: u32) {
        self.switch("glEnable", cap, true);
    }

    /// `glDisable`.
    pub fn disable(&mut self, cap: u32) {
        self.switch("glDisable", cap, false);
    }

    /// `glIsEnabled`.
    pub fn is_enabled(&mut self, cap: u32) -> u8 {
        if !self.may_set("glIsEnabled") {
            return 0;
        }
        let switch = self
            .capability(cap)
            .map(|on| *on)
            .or_else(|| self.client_capability(cap).map(|on| *on));
        if switch.is_none() {
            self.refuse_enum("glIsEnabled", "cap", cap);
        }
        u8::from(switch == Some(true))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::testing::context;

    #[test]
    fn every_capability_switches_alone() {
        let mut c = context();
        let textures = [
            gl::TEXTURE_1D,
            gl::TEXTURE_2D,
            gl::TEXTURE_3D,
            gl::TEXTURE_CUBE_MAP,
            gl::TEXTURE_RECTANGLE_ARB,
        ];
        let generation = (0..4).map(|i| gl::TEXTURE_GEN_S + i);
        let all: Vec<u32> = saved_capabilities().chain(textures).chain(generation).collect();
        for cap in &all {
            let initially = matches!(*cap, gl::DITHER | gl::MULTISAMPLE);
            assert_eq!(c.is_enabled(*cap) == 1, initially, "{cap:x}");
        }
        for cap in &all {
            c.disable(gl::DITHER);
            c.disable(gl::MULTISAMPLE);
            c.enable(*cap);
            let on: Vec<u32> = all.iter().copied().filter(|cap| c.is_enabled(*cap) == 1).collect();
            assert_eq!(on, [*cap]);
            c.disable(*cap);
        }
        assert_eq!(c.get_error(), gl::NO_ERROR);
    }

    #[test]
    fn texture_enables_belong_to_the_active_unit() {
        let mut c = context();
        c.active_texture(gl::TEXTURE3);
        c.enable(gl::TEXTURE_2D);
        c.enable(gl::TEXTURE_GEN_T);
        assert!(c.state.units[3].enabled[target::TWO] && c.state.units[3].generation[1].enabled);
        assert!(!c.state.units[0].enabled[target::TWO]);
    }

    #[test]
    fn unknown_capabilities() {
        let mut c = context();
        assert_eq!(c.is_enabled(0x1234), 0);
        assert_eq!(c.get_error(), gl::INVALID_ENUM);
        c.disable(gl::LIGHT0 + MAX_LIGHTS as u32);
        assert_eq!(c.get_error(), gl::INVALID_ENUM);
        c.enable(gl::VERTEX_ARRAY);
        assert!(c.client.vertex.enabled);
        assert_eq!(c.get_error(), gl::NO_ERROR);
    }
}
