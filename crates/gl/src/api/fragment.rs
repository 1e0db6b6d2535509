//! Scissor, alpha, stencil and depth tests, masks, clear values.

use super::arguments::{unit, unit64};
use super::materials::faces;
use crate::state::StencilFace;
use crate::{Context, enums as gl};

/// Functions of the alpha, stencil and depth tests.
pub(super) const COMPARISONS: [u32; 8] =
    [gl::NEVER, gl::LESS, gl::EQUAL, gl::LEQUAL, gl::GREATER, gl::NOTEQUAL, gl::GEQUAL, gl::ALWAYS];
const STENCIL_OPERATIONS: [u32; 8] =
    [gl::KEEP, gl::ZERO, gl::REPLACE, gl::INCR, gl::DECR, gl::INVERT, gl::INCR_WRAP, gl::DECR_WRAP];
/// Tests.
impl Context {
    /// `glScissor`.
    pub fn scissor(&mut self, x: i32, y: i32, width: i32, height: i32) {
        self.listable(move |c| {
            if !c.may_set("glScissor") {
            } else if width < 0 || height < 0 {
                c.refuse_value("glScissor", "the size is negative");
            } else {
                c.state.scissor.rect = [x, y, width, height];
            }
        });
    }

    /// `glAlphaFunc`.
    pub fn alpha_func(&mut self, func: u32, reference: f32) {
        self.listable(move |c| {
            if c.may_set("glAlphaFunc") && c.check_enum("glAlphaFunc", "func", func, &COMPARISONS) {
                c.state.alpha_test.1 = func;
                c.state.alpha_test.2 = unit(reference);
            }
        });
    }

    /// `glDepthFunc`.
    pub fn depth_func(&mut self, func: u32) {
        self.listable(move |c| {
            if c.may_set("glDepthFunc") && c.check_enum("glDepthFunc", "func", func, &COMPARISONS) {
                c.state.depth.func = func;
            }
        });
    }
}

/// Stencil.
impl Context {
    /// The faces that the calls without `Separate` set: front and back, or the back of
    /// EXT_stencil_two_side.
    fn change_stencil(&mut self, change: impl Fn(&mut StencilFace)) {
        let stencil = &mut self.state.stencil;
        if stencil.active_face == 0 {
            stencil.faces[..2].iter_mut().for_each(change);
        } else {
            change(&mut stencil.faces[2]);
        }
    }

    /// `glStencilFunc`.
    pub fn stencil_func(&mut self, func: u32, reference: i32, mask: u32) {
        self.listable(move |c| {
            if c.may_set("glStencilFunc")
                && c.check_enum("glStencilFunc", "func", func, &COMPARISONS)
            {
                c.change_stencil(|face| {
                    (face.func, face.reference, face.value_mask) = (func, reference, mask)
                });
            }
        });
    }

    /// `glStencilOp`.
    pub fn stencil_op(&mut self, fail: u32, depth_fail: u32, pass: u32) {
        self.listable(move |c| {
            let ops = [fail, depth_fail, pass];
            let call = "glStencilOp";
            if c.may_set(call)
                && ops
                    .into_iter()
                    .all(|op| c.check_enum(call, "operation", op, &STENCIL_OPERATIONS))
            {
                c.change_stencil(|face| face.ops = ops);
            }
        });
    }

    /// `glStencilMask`.
    pub fn stencil_mask(&mut self, mask: u32) {
        self.listable(move |c| {
            if c.may_set("glStencilMask") {
                c.change_stencil(|face| face.write_mask = mask);
            }
        });
    }

    /// `glStencilOpSeparateATI`.
    pub fn stencil_op_separate_ati(&mut self, face: u32, fail: u32, depth_fail: u32, pass: u32) {
        self.listable(move |c| {
            let call = "glStencilOpSeparateATI";
            if !c.may_set(call) {
                return;
            }
            let Some(chosen) = faces(face) else { return c.refuse_enum(call, "face", face) };
            let ops = [fail, depth_fail, pass];
            if ops.into_iter().all(|op| c.check_enum(call, "operation", op, &STENCIL_OPERATIONS)) {
                for side in (0..2).filter(|side| chosen[*side]) {
                    c.state.stencil.faces[side].ops = ops;
                }
            }
        });
    }

    /// `glStencilFuncSeparate`.
    pub fn stencil_func_separate(&mut self, face: u32, func: u32, reference: i32, mask: u32) {
        self.listable(move |c| {
            let call = "glStencilFuncSeparate";
            if !c.may_set(call) {
                return;
            }
            let Some(chosen) = faces(face) else { return c.refuse_enum(call, "face", face) };
            if c.check_enum(call, "func", func, &COMPARISONS) {
                for side in (0..2).filter(|side| chosen[*side]) {
                    let face = &mut c.state.stencil.faces[side];
                    (face.func, face.reference, face.value_mask) = (func, reference, mask);
                }
            }
        });
    }

    /// `glStencilMaskSeparate`.
    pub fn stencil_mask_separate(&mut self, face: u32, mask: u32) {
        self.listable(move |c| {
            let call = "glStencilMaskSeparate";
            if !c.may_set(call) {
                return;
            }
            let Some(chosen) = faces(face) else { return c.refuse_enum(call, "face", face) };
            for side in (0..2).filter(|side| chosen[*side]) {
                c.state.stencil.faces[side].write_mask = mask;
            }
        });
    }

    /// `OSMesaColorClamp`: whether colours of fragments are clamped even on their way to buffers of
    /// floats.
    pub fn set_fragment_clamp(&mut self, on: bool) {
        self.state.color_buffer.clamps[1] = if on { gl::TRUE } else { gl::FIXED_ONLY };
    }

    /// `glClampColorARB`.
    pub fn clamp_color(&mut self, target: u32, clamp: u32) {
        self.listable(move |c| {
            let call = "glClampColorARB";
            let targets = [gl::CLAMP_VERTEX_COLOR, gl::CLAMP_FRAGMENT_COLOR, gl::CLAMP_READ_COLOR];
            if c.may_set(call)
                && c.check_enum(call, "target", target, &targets)
                && c.check_enum(call, "clamp", clamp, &[gl::TRUE, gl::FALSE, gl::FIXED_ONLY])
                && let Some(which) = targets.iter().position(|&t| t == target)
            {
                c.state.color_buffer.clamps[which] = clamp;
            }
        });
    }

    /// `glStencilFuncSeparateATI`.
    pub fn stencil_func_separate_ati(&mut self, front: u32, back: u32, reference: i32, mask: u32) {
        self.listable(move |c| {
            let call = "glStencilFuncSeparateATI";
            let funcs = [front, back];
            if c.may_set(call)
                && funcs.into_iter().all(|func| c.check_enum(call, "func", func, &COMPARISONS))
            {
                for (face, func) in c.state.stencil.faces.iter_mut().zip(funcs) {
                    (face.func, face.reference, face.value_mask) = (func, reference, mask);
                }
            }
        });
    }

    /// `glActiveStencilFaceEXT`.
    pub fn active_stencil_face_ext(&mut self, face: u32) {
        self.listable(move |c| {
            let call = "glActiveStencilFaceEXT";
            if c.may_set(call) && c.check_enum(call, "face", face, &[gl::FRONT, gl::BACK]) {
                c.state.stencil.active_face = usize::from(face == gl::BACK);
            }
        });
    }
}

/// A setter that accepts everything.
macro_rules! plain_call {
    ($name:ident($($arg:ident: $type:ty),*), $call:literal, |$c:ident| $store:expr) => {
        #[doc = concat!("`", $call, "`.")]
        pub fn $name(&mut self, $($arg: $type),*) {
            self.listable(move |$c| {
                if $c.may_set($call) {
                    $store;
                }
            });
        }
    };
}

/// Masks and clear values.
impl Context {
    plain_call!(color_mask(red: u8, green: u8, blue: u8, alpha: u8), "glColorMask", |c| {
        c.state.color_buffer.mask = [red, green, blue, alpha].map(|on| on != 0)
    });
    plain_call!(index_mask(mask: u32), "glIndexMask", |c| c.state.color_buffer.index_mask = mask);
    plain_call!(depth_mask(flag: u8), "glDepthMask", |c| c.state.depth.write = flag != 0);
    plain_call!(clear_color(red: f32, green: f32, blue: f32, alpha: f32), "glClearColor", |c| {
        c.state.color_buffer.clear = [red, green, blue, alpha]
    });
    plain_call!(clear_accum(red: f32, green: f32, blue: f32, alpha: f32), "glClearAccum", |c| {
        c.state.color_buffer.accum_clear = [red, green, blue, alpha].map(|v| if v >= -1.0 { v.min(1.0) } else { -1.0 })
    });
    plain_call!(clear_index(index: f32), "glClearIndex", |c| c.state.color_buffer.clear_index = index);
    plain_call!(clear_depth(depth: f64), "glClearDepth", |c| c.state.depth.clear = unit64(depth));
    plain_call!(clear_stencil(s: i32), "glClearStencil", |c| c.state.stencil.clear = s);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::testing::context;
    use crate::state::StencilState;

    #[test]
    fn wrong_tokens_change_nothing() {
        let mut c = context();
        type Call = fn(&mut Context);
        let calls: [(Call, u32); 6] = [
            (|c| c.stencil_func(0x208, 1, 1), gl::INVALID_ENUM),
            (|c| c.stencil_op(gl::ZERO, gl::ZERO, gl::ONE), gl::INVALID_ENUM),
            (
                |c| c.stencil_op_separate_ati(gl::LEFT, gl::ZERO, gl::ZERO, gl::ZERO),
                gl::INVALID_ENUM,
            ),
            (|c| c.depth_func(0), gl::INVALID_ENUM),
            (|c| c.alpha_func(0, 0.5), gl::INVALID_ENUM),
            (|c| c.scissor(0, 0, 1, -1), gl::INVALID_VALUE),
        ];
        for (i, (call, error)) in calls.into_iter().enumerate() {
            call(&mut c);
            assert_eq!(c.get_error(), error, "{i}");
        }
        assert_eq!(c.state.stencil, StencilState::default());
        assert_eq!(c.state.alpha_test, (false, gl::ALWAYS, 0.0));
    }

    #[test]
    fn stencil_faces() {
        let mut c = context();
        c.stencil_op(gl::KEEP, gl::KEEP, gl::INCR);
        assert_eq!(c.state.stencil.back().ops[2], gl::INCR);
        c.stencil_op_separate_ati(gl::BACK, gl::KEEP, gl::KEEP, gl::DECR);
        assert_eq!(
            (c.state.stencil.front().ops[2], c.state.stencil.back().ops[2]),
            (gl::INCR, gl::DECR)
        );
        c.active_stencil_face_ext(gl::BACK);
        c.stencil_op(gl::KEEP, gl::KEEP, gl::INVERT);
        c.active_stencil_face_ext(gl::FRONT);
        c.stencil_mask(0x0F);
        assert_eq!(c.state.stencil.back().ops[2], gl::DECR);
        c.enable(gl::STENCIL_TEST_TWO_SIDE_EXT);
        assert_eq!(
            (c.state.stencil.back().ops[2], c.state.stencil.back().write_mask),
            (gl::INVERT, u32::MAX)
        );
        c.stencil_func_separate(gl::BACK, gl::EQUAL, 9, 1);
        c.stencil_mask_separate(gl::FRONT, 3);
        let faces = c.state.stencil.faces;
        assert_eq!([faces[0].func, faces[1].func], [gl::ALWAYS, gl::EQUAL]);
        assert_eq!([faces[0].write_mask, faces[1].write_mask], [3, 0x0F]);
        c.stencil_func_separate_ati(gl::LESS, gl::GREATER, 3, 7);
        assert_eq!(
            (c.state.stencil.faces[0].func, c.state.stencil.faces[1].func),
            (gl::LESS, gl::GREATER)
        );
    }

    #[test]
    fn values_are_clamped() {
        let mut c = context();
        c.clear_color(2.0, -1.0, 0.5, f32::NAN);
        let at = crate::api::testing::RESULT;
        c.get_floatv(gl::COLOR_CLEAR_VALUE, at);
        assert_eq!(crate::api::testing::take::<f32, 4>(&c), [1.0, 0.0, 0.5, 0.0]);
        c.clear_accum(2.0, -2.0, 0.5, -0.5);
        assert_eq!(c.state.color_buffer.accum_clear, [1.0, -1.0, 0.5, -0.5]);
        c.clear_depth(1.5);
        assert_eq!(c.state.depth.clear, 1.0);
        c.alpha_func(gl::GEQUAL, 3.0);
        assert_eq!(c.state.alpha_test.2, 1.0);
    }
}
