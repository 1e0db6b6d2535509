//! From the state tables to the rasteriser's state.

use crate::Context;
use crate::enums as gl;
use crate::state::{self, State};
use std::sync::Arc;
use vitral_raster::forward as raster;
use vitral_raster::forward::{
    AlphaTest, Blend, BlendEquation, BlendFactor, Combine, CombineFunction, CombineOperand,
    CombineSource, Compare, DepthTest, EnvironmentMode, Fog, FogMode, FragmentState, LogicOp,
    SampleCoverage, Stencil, StencilFace, StencilOp, Target, Unit,
};

/// A comparison's token.
pub(crate) fn compare(token: u32) -> Compare {
    match token {
        gl::NEVER => Compare::Never,
        gl::LESS => Compare::Less,
        gl::EQUAL => Compare::Equal,
        gl::LEQUAL => Compare::LessOrEqual,
        gl::GREATER => Compare::Greater,
        gl::NOTEQUAL => Compare::NotEqual,
        gl::GEQUAL => Compare::GreaterOrEqual,
        _ => Compare::Always,
    }
}

fn stencil_op(token: u32) -> StencilOp {
    match token {
        gl::ZERO => StencilOp::Zero,
        gl::REPLACE => StencilOp::Replace,
        gl::INCR => StencilOp::Increment,
        gl::DECR => StencilOp::Decrement,
        gl::INVERT => StencilOp::Invert,
        gl::INCR_WRAP_EXT => StencilOp::IncrementWrap,
        gl::DECR_WRAP_EXT => StencilOp::DecrementWrap,
        _ => StencilOp::Keep,
    }
}

fn stencil_face(face: &state::StencilFace) -> StencilFace {
    StencilFace {
        func: compare(face.func),
        reference: face.reference.clamp(0, 255) as u8,
        mask: face.value_mask as u8,
        fail: stencil_op(face.ops[0]),
        depth_fail: stencil_op(face.ops[1]),
        pass: stencil_op(face.ops[2]),
        write_mask: face.write_mask as u8,
    }
}

fn blend_factor(token: u32) -> BlendFactor {
    match token {
        gl::ZERO => BlendFactor::Zero,
        gl::SRC_COLOR => BlendFactor::SrcColor,
        gl::ONE_MINUS_SRC_COLOR => BlendFactor::OneMinusSrcColor,
        gl::DST_COLOR => BlendFactor::DstColor,
        gl::ONE_MINUS_DST_COLOR => BlendFactor::OneMinusDstColor,
        gl::SRC_ALPHA => BlendFactor::SrcAlpha,
        gl::ONE_MINUS_SRC_ALPHA => BlendFactor::OneMinusSrcAlpha,
        gl::DST_ALPHA => BlendFactor::DstAlpha,
        gl::ONE_MINUS_DST_ALPHA => BlendFactor::OneMinusDstAlpha,
        gl::CONSTANT_COLOR => BlendFactor::ConstantColor,
        gl::ONE_MINUS_CONSTANT_COLOR => BlendFactor::OneMinusConstantColor,
        gl::CONSTANT_ALPHA => BlendFactor::ConstantAlpha,
        gl::ONE_MINUS_CONSTANT_ALPHA => BlendFactor::OneMinusConstantAlpha,
        gl::SRC_ALPHA_SATURATE => BlendFactor::SrcAlphaSaturate,
        _ => BlendFactor::One,
    }
}

fn blend_equation(token: u32) -> BlendEquation {
    match token {
        gl::FUNC_SUBTRACT => BlendEquation::Subtract,
        gl::FUNC_REVERSE_SUBTRACT => BlendEquation::ReverseSubtract,
        gl::MIN => BlendEquation::Min,
        gl::MAX => BlendEquation::Max,
        _ => BlendEquation::Add,
    }
}

fn blend(b: &state::Blend) -> Blend {
    Blend {
        source: b.source.map(blend_factor),
        destination: b.destination.map(blend_factor),
        equation: b.equation.map(blend_equation),
        color: b.color,
    }
}

fn logic_op(token: u32) -> LogicOp {
    use LogicOp::*;
    const IN_ORDER: [LogicOp; 16] = [
        Clear,
        And,
        AndReverse,
        Copy,
        AndInverted,
        Noop,
        Xor,
        Or,
        Nor,
        Equiv,
        Invert,
        OrReverse,
        CopyInverted,
        OrInverted,
        Nand,
        Set,
    ];
    IN_ORDER[(token.wrapping_sub(gl::CLEAR) & 15) as usize]
}

fn fog(f: &state::Fog) -> Fog {
    let mode = match f.mode {
        gl::LINEAR => FogMode::Linear { start: f.start, end: f.end },
        gl::EXP2 => FogMode::Exp2 { density: f.density },
        _ => FogMode::Exp { density: f.density },
    };
    let [r, g, b, _] = f.color.map(|c| c.clamp(0.0, 1.0));
    Fog { mode, color: [r, g, b] }
}

fn source(token: u32) -> CombineSource {
    match token {
        gl::TEXTURE => CombineSource::Texture,
        gl::CONSTANT => CombineSource::Constant,
        gl::PRIMARY_COLOR => CombineSource::PrimaryColor,
        gl::PREVIOUS => CombineSource::Previous,
        gl::ZERO => CombineSource::Zero,
        gl::ONE => CombineSource::One,
        unit => CombineSource::TextureUnit(unit.wrapping_sub(gl::TEXTURE0) as usize),
    }
}

fn operand(token: u32) -> CombineOperand {
    match token {
        gl::ONE_MINUS_SRC_COLOR => CombineOperand::OneMinusColor,
        gl::SRC_ALPHA => CombineOperand::Alpha,
        gl::ONE_MINUS_SRC_ALPHA => CombineOperand::OneMinusAlpha,
        _ => CombineOperand::Color,
    }
}

fn function(token: u32) -> CombineFunction {
    match token {
        gl::REPLACE => CombineFunction::Replace,
        gl::ADD => CombineFunction::Add,
        gl::ADD_SIGNED => CombineFunction::AddSigned,
        gl::INTERPOLATE => CombineFunction::Interpolate,
        gl::SUBTRACT => CombineFunction::Subtract,
        gl::MODULATE_ADD_ATI => CombineFunction::ModulateAdd,
        gl::MODULATE_SIGNED_ADD_ATI => CombineFunction::ModulateSignedAdd,
        gl::MODULATE_SUBTRACT_ATI => CombineFunction::ModulateSubtract,
        gl::DOT3_RGB | gl::DOT3_RGB_EXT => CombineFunction::Dot3Rgb,
        gl::DOT3_RGBA | gl::DOT3_RGBA_EXT => CombineFunction::Dot3Rgba,
        _ => CombineFunction::Modulate,
    }
}

fn environment_mode(e: &state::TextureEnvironment) -> EnvironmentMode {
    match e.mode {
        gl::REPLACE => EnvironmentMode::Replace,
        gl::DECAL => EnvironmentMode::Decal,
        gl::BLEND => EnvironmentMode::Blend,
        gl::ADD => EnvironmentMode::Add,
        gl::COMBINE => {
            let c = &e.combine;
            // The EXT tokens of the dot product know no scale.
            let scale = match c.functions[0] {
                gl::DOT3_RGB_EXT => [1.0, c.scale[1]],
                gl::DOT3_RGBA_EXT => [1.0; 2],
                _ => c.scale,
            };
            EnvironmentMode::Combine(Combine {
                functions: c.functions.map(function),
                rgb: [0, 1, 2].map(|k| (source(c.rgb_sources[k]), operand(c.rgb_operands[k]))),
                alpha: [0, 1, 2]
                    .map(|k| (source(c.alpha_sources[k]), operand(c.alpha_operands[k]))),
                scale,
            })
        }
        _ => EnvironmentMode::Modulate,
    }
}

/// Scissor within a target.
fn clip(state: &State, target: &Target) -> [i32; 4] {
    let (w, h) = (target.viewport.width as i32, target.viewport.height as i32);
    if !state.scissor.enabled {
        return [0, 0, w, h];
    }
    let [x, y, sw, sh] = state.scissor.rect;
    [x.max(0), y.max(0), x.saturating_add(sw).min(w), y.saturating_add(sh).min(h)]
}

impl Context {
    /// The current per-fragment state. `images` leaves out what does not apply to pixel rectangles
    /// (polygon stipple).
    pub(crate) fn fragment_state_for(
        &mut self,
        target: Option<&Target>,
        images: bool,
    ) -> Arc<FragmentState> {
        // Derive what needs more than the state.
        let units = self.sampled_units(target);
        let missing = self.missing_components();
        let (clamping, srgb, one) = (self.clamping(), self.encodes_srgb(), self.stored_one());
        let unclamped_vertices = !self.clamps_vertices();
        let s = &self.state;
        let lit_apart =
            s.lighting.enabled && s.lighting.model.color_control == gl::SEPARATE_SPECULAR_COLOR;

        // Translate the state.
        let logic = s.logic_op.0 || s.blend.is_logic_op();
        Arc::new(FragmentState {
            units,
            color_sum: if s.lighting.enabled { lit_apart } else { s.color_sum },
            fog: s.fog.enabled.then(|| fog(&s.fog)),
            alpha_test: s
                .alpha_test
                .0
                .then(|| {
                    AlphaTest::new(compare(s.alpha_test.1), s.alpha_test.2.clamp(0.0, 1.0), one)
                })
                .flatten(),
            stencil: s.stencil.enabled.then(|| Stencil {
                front: stencil_face(s.stencil.front()),
                back: stencil_face(s.stencil.back()),
            }),
            depth: s
                .depth
                .enabled
                .then(|| DepthTest { func: compare(s.depth.func), write: s.depth.write }),
            blend: (s.blend.enabled && !logic).then(|| blend(&s.blend)),
            logic_op: logic.then(|| logic_op(s.logic_op.1)),
            masked: [0, 1, 2, 3].map(|k| !s.color_buffer.mask[k] || missing[k]),
            clip: target.map_or([0; 4], |t| clip(s, t)),
            polygon_stipple: (s.polygons.stipple && !images)
                .then(|| s.polygons.stipple_pattern.clone()),
            multisample: s.multisample,
            alpha_to_coverage: s.sample_alpha_to_coverage,
            alpha_to_one: s.sample_alpha_to_one,
            sample_coverage: s.sample_coverage.then_some(SampleCoverage {
                value: s.sample_coverage_value.0,
                invert: s.sample_coverage_value.1,
            }),
            flat: s.lighting.shade_model == gl::FLAT,
            depth_clamp: s.depth_clamp,
            clamping,
            unclamped_vertices,
            srgb,
            query: self.queries.active(),
        })
    }

    /// The units that sample a complete texture which is not being drawn to.
    fn sampled_units(&mut self, target: Option<&Target>) -> Vec<Unit> {
        let mut units = Vec::new();
        for index in 0..state::MAX_TEXTURE_UNITS {
            if self.state.units[index].enabled == [false; 5] {
                continue;
            }
            let Some(texture) = self.sampled_texture(index) else { continue };
            if target.is_some_and(|t| draws_to(t, &texture)) {
                continue;
            }
            let environment = &self.state.units[index].environment;
            let (mode, color) = (environment_mode(environment), environment.color);
            let most = state::MAX_TEXTURE_LOD_BIAS;
            let lod_bias = (environment.lod_bias + self.texture_lod_bias(index)).clamp(-most, most);
            units.push(Unit { index, texture, mode, color, lod_bias });
        }
        units
    }
}

/// Whether a texture shows the target's own depth plane: what it would read is undefined.
fn draws_to(target: &Target, texture: &raster::Texture) -> bool {
    let Some(depth) = &target.depth else { return false };
    let levels = texture.faces.iter().flatten();
    levels.into_iter().any(
        |level| matches!(level.texels(), raster::Texels::DepthBuffer(p) if Arc::ptr_eq(p, depth)),
    )
}
