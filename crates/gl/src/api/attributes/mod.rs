//! The server and client attribute stacks.
//!
//! `PushAttrib` keeps a copy of each group in its mask; some fields are in two groups (an enable is
//! in `ENABLE_BIT` and in the group of its feature) and may come back twice.

mod groups;
mod restore;

use crate::state::{ClientState, MAX_ATTRIB_STACK_DEPTH, PixelStore};
use crate::{Context, enums as gl};
use groups::Groups;

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

#[derive(Debug)]
struct ClientGroups {
    pixel_store: Option<[PixelStore; 2]>,
    arrays: Option<Box<ClientState>>,
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
                pixel_store: (mask & gl::CLIENT_PIXEL_STORE_BIT != 0)
                    .then(|| [&client.unpack, &client.pack].map(Clone::clone)),
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
            return self.record_error(
                gl::STACK_UNDERFLOW,
                call,
                "the client attribute stack is empty",
            );
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
    use crate::api::capabilities::saved_capabilities;
    use crate::api::testing::context;
    use crate::state::{State, target};
    use std::sync::Arc;

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
        for cap in
            saved_capabilities().chain([gl::TEXTURE_2D, gl::TEXTURE_GEN_R]).collect::<Vec<_>>()
        {
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
        c.push_attrib(
            gl::POLYGON_BIT | gl::TEXTURE_BIT | gl::COLOR_BUFFER_BIT | gl::PIXEL_MODE_BIT,
        );
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
        assert!(
            c.client.vertex.enabled && c.client.active_unit == 0 && c.client.unpack.alignment == 1
        );
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
