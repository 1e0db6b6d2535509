//! GetString. The strings are static, so that their addresses stay good.

use crate::{Context, enums as gl};

const VENDOR: &str = "vitral\0";
const RENDERER: &str = "vitral software renderer\0";
const VERSION: &str = concat!("1.5 vitral ", env!("CARGO_PKG_VERSION"), "\0");
/// For programs that ask for 2.1, and use nothing of it.
const VERSION_2_1: &str =
    concat!("2.1 vitral ", env!("CARGO_PKG_VERSION"), ", OpenGL 1.5 in fact\0");
const EXTENSIONS: &str = "\
    GL_APPLE_packed_pixels GL_ARB_clip_control GL_ARB_color_buffer_float GL_ARB_copy_buffer \
    GL_ARB_depth_buffer_float GL_ARB_depth_clamp GL_ARB_depth_texture GL_ARB_draw_buffers \
    GL_ARB_draw_elements_base_vertex GL_ARB_framebuffer_object GL_ARB_framebuffer_sRGB GL_ARB_half_float_pixel \
    GL_ARB_half_float_vertex GL_ARB_map_buffer_range GL_ARB_multisample GL_ARB_multitexture GL_ARB_occlusion_query \
    GL_ARB_occlusion_query2 GL_ARB_pixel_buffer_object GL_ARB_point_parameters GL_ARB_point_sprite GL_ARB_provoking_vertex \
    GL_ARB_sampler_objects GL_ARB_seamless_cube_map GL_ARB_shadow GL_ARB_sync GL_ARB_texture_border_clamp \
    GL_ARB_texture_compression GL_ARB_texture_cube_map GL_ARB_texture_env_add GL_ARB_texture_env_combine \
    GL_ARB_texture_env_crossbar GL_ARB_texture_env_dot3 GL_ARB_texture_float GL_ARB_texture_mirrored_repeat \
    GL_ARB_texture_non_power_of_two GL_ARB_texture_rectangle GL_ARB_texture_rg GL_ARB_texture_storage \
    GL_ARB_texture_swizzle GL_ARB_transpose_matrix GL_ARB_vertex_array_bgra GL_ARB_vertex_array_object \
    GL_ARB_vertex_buffer_object GL_ARB_window_pos GL_ATI_draw_buffers GL_ATI_separate_stencil \
    GL_ATI_texture_env_combine3 GL_ATI_texture_mirror_once GL_EXT_abgr GL_EXT_bgra GL_EXT_blend_color \
    GL_EXT_blend_equation_separate GL_EXT_blend_func_separate GL_EXT_blend_logic_op GL_EXT_blend_minmax \
    GL_EXT_blend_subtract GL_EXT_compiled_vertex_array GL_EXT_copy_texture GL_EXT_draw_range_elements \
    GL_EXT_fog_coord GL_EXT_framebuffer_blit GL_EXT_framebuffer_multisample GL_EXT_framebuffer_object \
    GL_EXT_framebuffer_sRGB GL_EXT_multi_draw_arrays GL_EXT_packed_depth_stencil GL_EXT_packed_pixels \
    GL_EXT_pixel_buffer_object GL_EXT_point_parameters GL_EXT_polygon_offset GL_EXT_provoking_vertex GL_EXT_rescale_normal \
    GL_EXT_secondary_color GL_EXT_separate_specular_color GL_EXT_shadow_funcs GL_EXT_stencil_two_side \
    GL_EXT_stencil_wrap GL_EXT_subtexture GL_EXT_texture GL_EXT_texture3D GL_EXT_texture_compression_dxt1 \
    GL_EXT_texture_compression_s3tc GL_EXT_texture_cube_map GL_EXT_texture_edge_clamp GL_EXT_texture_env_add \
    GL_EXT_texture_env_combine GL_EXT_texture_env_dot3 GL_EXT_texture_filter_anisotropic GL_EXT_texture_lod_bias \
    GL_EXT_texture_mirror_clamp GL_EXT_texture_object GL_EXT_texture_rectangle GL_EXT_texture_sRGB \
    GL_EXT_texture_swizzle GL_EXT_vertex_array GL_EXT_vertex_array_bgra GL_IBM_rasterpos_clip \
    GL_IBM_texture_mirrored_repeat GL_INGR_blend_func_separate GL_KHR_debug GL_MESA_pack_invert GL_MESA_window_pos \
    GL_NV_blend_square GL_NV_fog_distance GL_NV_light_max_exponent GL_NV_packed_depth_stencil GL_NV_primitive_restart \
    GL_NV_texgen_reflection GL_NV_texture_rectangle GL_SGIS_generate_mipmap GL_SGIS_texture_border_clamp \
    GL_SGIS_texture_edge_clamp GL_SGIS_texture_lod GL_SUN_multi_draw_arrays\0";

impl Context {
    /// Has `VERSION` begin with 2.1, as the user wishes for a program that only asks.
    pub fn say_2_1(&mut self) {
        self.says_2_1 = true;
    }

    /// `glGetString`: the address of a string that lives as long as the program.
    pub fn get_string(&mut self, name: u32) -> usize {
        if !self.may_set("glGetString") {
            return 0;
        }
        let text = match name {
            gl::VENDOR => VENDOR,
            gl::RENDERER => RENDERER,
            gl::VERSION if self.says_2_1 => VERSION_2_1,
            gl::VERSION => VERSION,
            gl::EXTENSIONS => EXTENSIONS,
            _ => {
                self.refuse_enum("glGetString", "name", name);
                return 0;
            }
        };
        text.as_ptr().expose_provenance()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::testing::context;

    #[test]
    fn strings_end_with_their_only_nul() {
        for text in [VENDOR, RENDERER, VERSION, VERSION_2_1, EXTENSIONS] {
            assert_eq!(text.find('\0'), Some(text.len() - 1));
        }
        let mut c = context();
        assert_eq!(c.get_string(gl::VERSION), VERSION.as_ptr().addr());
        c.say_2_1();
        assert_eq!(c.get_string(gl::VERSION), VERSION_2_1.as_ptr().addr());
        assert_eq!(c.get_string(gl::FOG), 0);
        assert_eq!(c.get_error(), gl::INVALID_ENUM);
    }

    #[test]
    fn extensions_are_sorted_words() {
        let words: Vec<&str> = EXTENSIONS.trim_end_matches('\0').split(' ').collect();
        assert!(words.iter().all(|word| word.starts_with("GL_")) && words.is_sorted());
        for wanted in [
            "GL_ARB_framebuffer_object",
            "GL_ARB_vertex_buffer_object",
            "GL_ARB_clip_control",
            "GL_KHR_debug",
        ] {
            assert!(words.contains(&wanted));
        }
    }
}
