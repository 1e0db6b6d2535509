//! The groups of server state, and how they are saved.

use crate::api::capabilities::saved_capabilities;
use crate::pixels::SavedTextures;
use crate::state::{
    Blend, ColorBuffer, Current, DepthState, Fog, Lighting, Lines, MAX_CLIP_PLANES,
    MAX_TEXTURE_UNITS, PixelMode, PixelTransfer, Points, Polygons, RasterPosition, Scissor,
    StencilState, TextureUnit, Viewport,
};
use crate::{Context, enums as gl};
use std::sync::Arc;

/// What one `PushAttrib` kept.
#[derive(Debug)]
pub(super) struct Groups {
    pub(super) accum: Option<[f32; 4]>,
    pub(super) color_buffer: Option<ColorGroup>,
    pub(super) current: Option<Box<(Current, RasterPosition)>>,
    pub(super) depth: Option<DepthState>,
    pub(super) enable: Option<Enables>,
    pub(super) eval: Option<EvalGroup>,
    pub(super) fog: Option<(Fog, bool)>,
    pub(super) hint: Option<[(u32, u32); 7]>,
    pub(super) lighting: Option<Box<Lighting>>,
    pub(super) line: Option<Lines>,
    pub(super) list: Option<u32>,
    pub(super) pixel_mode: Option<(PixelTransfer, PixelMode)>,
    pub(super) point: Option<PointGroup>,
    pub(super) polygon: Option<Polygons>,
    pub(super) stipple: Option<Arc<[u32; 32]>>,
    pub(super) scissor: Option<Scissor>,
    pub(super) stencil: Option<StencilState>,
    pub(super) texture: Option<Box<TextureGroup>>,
    pub(super) transform: Option<TransformGroup>,
    pub(super) viewport: Option<Viewport>,
    pub(super) multisample: Option<MultisampleGroup>,
}

#[derive(Debug)]
pub(super) struct ColorGroup {
    pub(super) alpha_test: (bool, u32, f32),
    pub(super) blend: Blend,
    pub(super) dither: bool,
    pub(super) logic_op: (bool, u32),
    pub(super) index_logic_op: bool,
    pub(super) buffer: ColorBuffer,
    pub(super) framebuffer_srgb: bool,
}

#[derive(Debug)]
pub(super) struct EvalGroup {
    pub(super) enabled: [[bool; 9]; 2],
    pub(super) auto_normal: bool,
    pub(super) grid1: (i32, [f32; 2]),
    pub(super) grid2: ([i32; 2], [f32; 2], [f32; 2]),
}

/// Coordinate replacement is set with `TexEnv` but goes with the points.
#[derive(Debug)]
pub(super) struct PointGroup {
    pub(super) points: Points,
    pub(super) coord_replace: [bool; MAX_TEXTURE_UNITS],
}

#[derive(Debug)]
pub(super) struct TextureGroup {
    pub(super) units: [TextureUnit; MAX_TEXTURE_UNITS],
    pub(super) active: usize,
    pub(super) cube_map_seamless: bool,
    pub(super) bound: SavedTextures,
}

#[derive(Debug)]
pub(super) struct TransformGroup {
    pub(super) mode: u32,
    pub(super) normalize: bool,
    pub(super) rescale_normal: bool,
    pub(super) clip_planes: [[f64; 4]; MAX_CLIP_PLANES],
    pub(super) clip_plane_enabled: [bool; MAX_CLIP_PLANES],
    pub(super) depth_clamp: bool,
    pub(super) clip_control: (u32, u32),
}

#[derive(Debug)]
pub(super) struct MultisampleGroup {
    pub(super) multisample: bool,
    pub(super) alpha_to_coverage: bool,
    pub(super) alpha_to_one: bool,
    pub(super) coverage: bool,
    pub(super) coverage_value: (f32, bool),
}

#[derive(Debug)]
pub(super) struct Enables {
    pub(super) single: Vec<bool>,
    pub(super) targets: [[bool; 5]; MAX_TEXTURE_UNITS],
    pub(super) generation: [[bool; 4]; MAX_TEXTURE_UNITS],
}

/// Saving.
impl Context {
    pub(super) fn save_groups(&mut self, mask: u32) -> Groups {
        fn take<T>(wanted: bool, make: impl FnOnce() -> T) -> Option<T> {
            wanted.then(make)
        }

        // Bring the material up to date before it is saved.
        self.track_color_material();
        let has = |bit| mask & bit != 0;
        let enable = take(has(gl::ENABLE_BIT), || self.save_enables());
        let texture = take(has(gl::TEXTURE_BIT), || self.save_texture_group());
        let color_buffer = take(has(gl::COLOR_BUFFER_BIT), || self.save_color_group());

        // Copy the groups that the mask names.
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
            single: saved_capabilities()
                .map(|cap| self.capability(cap).is_some_and(|on| *on))
                .collect(),
            targets: std::array::from_fn(|i| self.state.units[i].enabled),
            generation: std::array::from_fn(|i| self.state.units[i].generation.map(|g| g.enabled)),
        }
    }

    fn save_texture_group(&mut self) -> Box<TextureGroup> {
        let bound = self.save_bound_textures();
        let s = &self.state;
        Box::new(TextureGroup {
            units: s.units.clone(),
            active: s.active_unit,
            cube_map_seamless: s.cube_map_seamless,
            bound,
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
