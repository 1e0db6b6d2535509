//! Blending and logic operations.

use crate::{Context, enums as gl};

/// Of the source; the destination has no `SRC_ALPHA_SATURATE`.
const FACTORS: [u32; 15] = [
    gl::SRC_ALPHA_SATURATE,
    gl::ZERO,
    gl::ONE,
    gl::SRC_COLOR,
    gl::ONE_MINUS_SRC_COLOR,
    gl::DST_COLOR,
    gl::ONE_MINUS_DST_COLOR,
    gl::SRC_ALPHA,
    gl::ONE_MINUS_SRC_ALPHA,
    gl::DST_ALPHA,
    gl::ONE_MINUS_DST_ALPHA,
    gl::CONSTANT_COLOR,
    gl::ONE_MINUS_CONSTANT_COLOR,
    gl::CONSTANT_ALPHA,
    gl::ONE_MINUS_CONSTANT_ALPHA,
];
/// `LOGIC_OP` (EXT_blend_logic_op) is allowed for colour and alpha together only.
const EQUATIONS: [u32; 6] =
    [gl::LOGIC_OP, gl::FUNC_ADD, gl::FUNC_SUBTRACT, gl::FUNC_REVERSE_SUBTRACT, gl::MIN, gl::MAX];

impl Context {
    /// `glBlendFunc`.
    pub fn blend_func(&mut self, source: u32, destination: u32) {
        self.listable(move |c| c.exec_blend_func("glBlendFunc", [source; 2], [destination; 2]));
    }

    /// `glBlendFuncSeparate`.
    pub fn blend_func_separate(
        &mut self,
        source_rgb: u32,
        destination_rgb: u32,
        source_alpha: u32,
        destination_alpha: u32,
    ) {
        let (source, destination) =
            ([source_rgb, source_alpha], [destination_rgb, destination_alpha]);
        self.listable(move |c| c.exec_blend_func("glBlendFuncSeparate", source, destination));
    }

    fn exec_blend_func(&mut self, call: &str, source: [u32; 2], destination: [u32; 2]) {
        if self.may_set(call)
            && source
                .into_iter()
                .all(|factor| self.check_enum(call, "source factor", factor, &FACTORS))
            && destination
                .into_iter()
                .all(|factor| self.check_enum(call, "destination factor", factor, &FACTORS[1..]))
        {
            self.state.blend.source = source;
            self.state.blend.destination = destination;
        }
    }

    /// `glBlendEquation`.
    pub fn blend_equation(&mut self, mode: u32) {
        self.listable(move |c| {
            if c.may_set("glBlendEquation")
                && c.check_enum("glBlendEquation", "mode", mode, &EQUATIONS)
            {
                c.state.blend.equation = [mode; 2];
            }
        });
    }

    /// `glBlendEquationSeparateEXT`.
    pub fn blend_equation_separate_ext(&mut self, rgb: u32, alpha: u32) {
        self.listable(move |c| {
            let call = "glBlendEquationSeparateEXT";
            if c.may_set(call)
                && c.check_enum(call, "modeRGB", rgb, &EQUATIONS[1..])
                && c.check_enum(call, "modeAlpha", alpha, &EQUATIONS[1..])
            {
                c.state.blend.equation = [rgb, alpha];
            }
        });
    }

    /// `glBlendColor`.
    pub fn blend_color(&mut self, red: f32, green: f32, blue: f32, alpha: f32) {
        self.listable(move |c| {
            if c.may_set("glBlendColor") {
                c.state.blend.color = [red, green, blue, alpha];
            }
        });
    }

    /// `glLogicOp`.
    pub fn logic_op(&mut self, opcode: u32) {
        self.listable(move |c| {
            if !c.may_set("glLogicOp") {
            } else if (gl::CLEAR..=gl::SET).contains(&opcode) {
                c.state.logic_op.1 = opcode;
            } else {
                c.refuse_enum("glLogicOp", "opcode", opcode);
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::testing::context;
    use crate::state::Blend;

    #[test]
    fn blend_factors() {
        let mut c = context();
        for source in FACTORS {
            for destination in FACTORS {
                c.blend_func(source, destination);
                let good = destination != gl::SRC_ALPHA_SATURATE;
                assert_eq!(c.get_error(), if good { gl::NO_ERROR } else { gl::INVALID_ENUM });
                if good {
                    assert_eq!(
                        (c.state.blend.source, c.state.blend.destination),
                        ([source; 2], [destination; 2])
                    );
                }
            }
        }
        c.blend_func_separate(gl::ONE, gl::ZERO, gl::SRC_ALPHA, gl::DST_ALPHA);
        assert_eq!(c.state.blend.source, [gl::ONE, gl::SRC_ALPHA]);
        assert_eq!(c.state.blend.destination, [gl::ZERO, gl::DST_ALPHA]);
    }

    #[test]
    fn wrong_tokens_change_nothing() {
        let mut c = context();
        type Call = fn(&mut Context);
        let calls: [Call; 5] = [
            |c| c.blend_func(gl::ONE, 2),
            |c| c.blend_func_separate(gl::ONE, gl::ZERO, gl::FOG, gl::ZERO),
            |c| c.blend_equation(gl::ADD),
            |c| c.blend_equation_separate_ext(gl::MIN, gl::LOGIC_OP),
            |c| c.logic_op(0x1510),
        ];
        for (i, call) in calls.into_iter().enumerate() {
            call(&mut c);
            assert_eq!(c.get_error(), gl::INVALID_ENUM, "{i}");
        }
        assert_eq!(c.state.blend, Blend::default());
        c.blend_equation(gl::LOGIC_OP);
        assert!(!c.state.blend.is_logic_op());
        c.enable(gl::BLEND);
        assert!(c.state.blend.is_logic_op());
    }
}
