//! Matrices and their stacks.

use crate::state::MatrixStack;
use crate::{Context, enums as gl};
use vitral_math::{DMat4, DVec3, Mat4, dvec3, dvec4, func};

/// Sine and cosine of an angle in degrees, exact at multiples of 90.
fn sin_cos_degrees(angle: f64) -> (f64, f64) {
    let turned = angle % 360.0;
    match turned {
        0.0 => (0.0, 1.0),
        90.0 | -270.0 => (1.0, 0.0),
        180.0 | -180.0 => (0.0, -1.0),
        270.0 | -90.0 => (-1.0, 0.0),
        _ => func::sin_cos(turned.to_radians()),
    }
}

/// The matrix of `Rotate`; the identity where the axis has no direction.
fn rotation(angle: f64, axis: DVec3) -> DMat4 {
    let length = (axis.x * axis.x + axis.y * axis.y + axis.z * axis.z).sqrt();
    if !(length > 0.0 && length.is_finite()) {
        return DMat4::IDENTITY;
    }
    let (x, y, z) = (axis.x / length, axis.y / length, axis.z / length);
    let (s, c) = sin_cos_degrees(angle);
    let d = 1.0 - c;
    DMat4::from_cols(
        dvec4(x * x * d + c, y * x * d + z * s, x * z * d - y * s, 0.0),
        dvec4(x * y * d - z * s, y * y * d + c, y * z * d + x * s, 0.0),
        dvec4(x * z * d + y * s, y * z * d - x * s, z * z * d + c, 0.0),
        dvec4(0.0, 0.0, 0.0, 1.0),
    )
}

/// The sides of a view volume: left, right, bottom, top, near, far.
type Sides = [f64; 6];

fn frustum([l, r, b, t, n, f]: Sides) -> DMat4 {
    DMat4::from_cols(
        dvec4(2.0 * n / (r - l), 0.0, 0.0, 0.0),
        dvec4(0.0, 2.0 * n / (t - b), 0.0, 0.0),
        dvec4((r + l) / (r - l), (t + b) / (t - b), -(f + n) / (f - n), -1.0),
        dvec4(0.0, 0.0, -2.0 * f * n / (f - n), 0.0),
    )
}

fn ortho([l, r, b, t, n, f]: Sides) -> DMat4 {
    DMat4::from_cols(
        dvec4(2.0 / (r - l), 0.0, 0.0, 0.0),
        dvec4(0.0, 2.0 / (t - b), 0.0, 0.0),
        dvec4(0.0, 0.0, -2.0 / (f - n), 0.0),
        dvec4(-(r + l) / (r - l), -(t + b) / (t - b), -(f + n) / (f - n), 1.0),
    )
}

/// `LoadMatrix`, `MultMatrix` and their transposed forms.
macro_rules! matrix_call {
    ($name:ident, $call:literal, $type:ty, $transposed:literal, $store:expr) => {
        #[doc = concat!("`", $call, "`.")]
        pub fn $name(&mut self, m: usize) {
            let Some(given) = self.take_arguments::<$type, 16>($call, m, 16) else { return };
            let matrix = Mat4::from_cols_array(&given.map(|v| v as f32));
            let matrix = if $transposed { matrix.transpose() } else { matrix };
            self.listable_keeping(move |c| c.change_matrix($call, |top| $store(top, matrix)));
        }
    };
}

fn load(top: &mut Mat4, matrix: Mat4) {
    *top = matrix;
}

fn multiply(top: &mut Mat4, matrix: Mat4) {
    *top *= matrix;
}

impl Context {
    /// The stack that `MatrixMode` chose, to be changed: what waits to be drawn keeps the matrices
    /// that it was given with.
    fn current_stack(&mut self) -> &mut MatrixStack {
        if matches!(self.state.matrices.mode, gl::PROJECTION | gl::TEXTURE) {
            self.flush_vertices();
        } else {
            self.modelview_changes();
        }
        let unit = self.state.active_unit;
        let matrices = &mut self.state.matrices;
        match matrices.mode {
            gl::PROJECTION => &mut matrices.projection,
            gl::TEXTURE => &mut matrices.texture[unit],
            _ => &mut matrices.modelview,
        }
    }

    fn change_matrix(&mut self, call: &str, change: impl Fn(&mut Mat4)) {
        if self.may_set(call) {
            change(self.current_stack().top_mut());
        }
    }

    fn multiply_matrix(&mut self, call: &'static str, matrix: DMat4) {
        let matrix = matrix.as_mat4();
        self.listable_keeping(move |c| c.change_matrix(call, |top| multiply(top, matrix)));
    }

    /// `glMatrixMode`.
    pub fn matrix_mode(&mut self, mode: u32) {
        self.listable_keeping(move |c| {
            let call = "glMatrixMode";
            if c.may_set(call)
                && c.check_enum(call, "mode", mode, &[gl::MODELVIEW, gl::PROJECTION, gl::TEXTURE])
            {
                c.state.matrices.mode = mode;
            }
        });
    }

    /// `glPushMatrix`.
    pub fn push_matrix(&mut self) {
        self.listable_keeping(|c| {
            if !c.may_set("glPushMatrix") {
                return;
            }
            let stack = c.current_stack();
            if stack.matrices.len() >= stack.limit {
                c.record_error(gl::STACK_OVERFLOW, "glPushMatrix", "the matrix stack is full");
            } else {
                let top = stack.top();
                stack.matrices.push(top);
            }
        });
    }

    /// `glPopMatrix`.
    pub fn pop_matrix(&mut self) {
        self.listable_keeping(|c| {
            if !c.may_set("glPopMatrix") {
                return;
            }
            let stack = c.current_stack();
            if stack.matrices.len() <= 1 {
                c.record_error(
                    gl::STACK_UNDERFLOW,
                    "glPopMatrix",
                    "the matrix stack has one matrix",
                );
            } else {
                stack.matrices.pop();
            }
        });
    }

    /// `glLoadIdentity`.
    pub fn load_identity(&mut self) {
        self.listable_keeping(|c| c.change_matrix("glLoadIdentity", |top| *top = Mat4::IDENTITY));
    }

    matrix_call!(load_matrixf, "glLoadMatrixf", f32, false, load);
    matrix_call!(load_matrixd, "glLoadMatrixd", f64, false, load);
    matrix_call!(mult_matrixf, "glMultMatrixf", f32, false, multiply);
    matrix_call!(mult_matrixd, "glMultMatrixd", f64, false, multiply);
    matrix_call!(load_transpose_matrixf, "glLoadTransposeMatrixf", f32, true, load);
    matrix_call!(load_transpose_matrixd, "glLoadTransposeMatrixd", f64, true, load);
    matrix_call!(mult_transpose_matrixf, "glMultTransposeMatrixf", f32, true, multiply);
    matrix_call!(mult_transpose_matrixd, "glMultTransposeMatrixd", f64, true, multiply);

    /// `glRotated`.
    pub fn rotated(&mut self, angle: f64, x: f64, y: f64, z: f64) {
        self.multiply_matrix("glRotated", rotation(angle, dvec3(x, y, z)));
    }

    /// `glRotatef`.
    pub fn rotatef(&mut self, angle: f32, x: f32, y: f32, z: f32) {
        self.multiply_matrix(
            "glRotatef",
            rotation(angle.into(), dvec3(x.into(), y.into(), z.into())),
        );
    }

    /// `glScaled`.
    pub fn scaled(&mut self, x: f64, y: f64, z: f64) {
        self.multiply_matrix("glScaled", DMat4::from_scale(dvec3(x, y, z)));
    }

    /// `glScalef`.
    pub fn scalef(&mut self, x: f32, y: f32, z: f32) {
        self.multiply_matrix("glScalef", DMat4::from_scale(dvec3(x.into(), y.into(), z.into())));
    }

    /// `glTranslated`.
    pub fn translated(&mut self, x: f64, y: f64, z: f64) {
        self.multiply_matrix("glTranslated", DMat4::from_translation(dvec3(x, y, z)));
    }

    /// `glTranslatef`.
    pub fn translatef(&mut self, x: f32, y: f32, z: f32) {
        self.multiply_matrix(
            "glTranslatef",
            DMat4::from_translation(dvec3(x.into(), y.into(), z.into())),
        );
    }

    fn project(&mut self, call: &'static str, sides: Sides, perspective: bool) {
        self.listable_keeping(move |c| {
            if !c.may_set(call) {
                return;
            }
            let [l, r, b, t, n, f] = sides;
            if l == r || b == t || n == f || (perspective && !(n > 0.0 && f > 0.0)) {
                c.refuse_value(call, "the view volume is empty, or begins behind the eye");
                return;
            }
            let matrix = if perspective { frustum(sides) } else { ortho(sides) };
            multiply(c.current_stack().top_mut(), matrix.as_mat4());
        });
    }

    /// `glFrustum`.
    pub fn frustum(&mut self, left: f64, right: f64, bottom: f64, top: f64, near: f64, far: f64) {
        self.project("glFrustum", [left, right, bottom, top, near, far], true);
    }

    /// `glOrtho`.
    pub fn ortho(&mut self, left: f64, right: f64, bottom: f64, top: f64, near: f64, far: f64) {
        self.project("glOrtho", [left, right, bottom, top, near, far], false);
    }

    /// The current modelview matrix, in double precision.
    pub(super) fn modelview64(&self) -> DMat4 {
        self.state.matrices.modelview.top().as_dmat4()
    }

    /// A plane of model space in eye space: times the inverse of the current modelview matrix.
    /// Where that has none, the plane stays as it is.
    pub(super) fn eye_plane(&self, plane: [f64; 4]) -> [f64; 4] {
        let modelview = self.modelview64();
        let determinant = modelview.determinant();
        if determinant == 0.0 || !determinant.is_finite() {
            return plane;
        }
        (modelview.inverse().transpose() * dvec4(plane[0], plane[1], plane[2], plane[3])).to_array()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::testing::{context, put};

    fn top(c: &Context) -> [f32; 16] {
        c.state.matrices.modelview.top().to_cols_array()
    }

    #[test]
    fn transforms_multiply_from_the_right() {
        let mut c = context();
        c.translatef(1.0, 2.0, 3.0);
        c.rotatef(90.0, 0.0, 0.0, 2.0);
        c.scalef(2.0, 3.0, 4.0);
        // x axis: scaled by 2, turned to y; y axis: scaled by 3, turned to -x.
        let expected =
            [0.0, 2.0, 0.0, 0.0, -3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 1.0, 2.0, 3.0, 1.0];
        assert_eq!(top(&c), expected);
    }

    #[test]
    fn projections() {
        let mut c = context();
        c.ortho(0.0, 4.0, 0.0, 2.0, -1.0, 1.0);
        assert_eq!(top(&c), [0.5, 0., 0., 0., 0., 1., 0., 0., 0., 0., -1., 0., -1., -1., 0., 1.]);
        c.load_identity();
        c.frustum(-1.0, 1.0, -1.0, 1.0, 1.0, 3.0);
        assert_eq!(top(&c), [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., -2., -1., 0., 0., -3., 0.]);
        let before = top(&c);
        for (n, f) in [(0.0, 1.0), (-1.0, 1.0), (2.0, 2.0)] {
            c.frustum(-1.0, 1.0, -1.0, 1.0, n, f);
            assert_eq!(c.get_error(), gl::INVALID_VALUE);
        }
        assert_eq!(top(&c), before);
    }

    #[test]
    fn transposed_loads() {
        let mut c = context();
        let m: [f32; 16] = std::array::from_fn(|i| i as f32);
        let at = put(&c, &m);
        c.load_transpose_matrixf(at);
        assert_eq!(top(&c)[1], 4.0);
        c.load_matrixf(at);
        assert_eq!(top(&c), m);
        c.load_matrixf(0);
        assert_eq!(c.get_error(), gl::INVALID_VALUE);
        assert_eq!(top(&c), m);
    }

    #[test]
    fn stacks_end_at_both_ends() {
        let mut c = context();
        for (mode, limit) in [(gl::MODELVIEW, 32), (gl::PROJECTION, 32), (gl::TEXTURE, 10)] {
            c.matrix_mode(mode);
            for _ in 1..limit {
                c.push_matrix();
            }
            assert_eq!(c.get_error(), gl::NO_ERROR);
            c.push_matrix();
            assert_eq!(c.get_error(), gl::STACK_OVERFLOW);
            for _ in 1..limit {
                c.pop_matrix();
            }
            assert_eq!(c.get_error(), gl::NO_ERROR);
            c.pop_matrix();
            assert_eq!(c.get_error(), gl::STACK_UNDERFLOW);
        }
        c.matrix_mode(gl::COLOR);
        assert_eq!(c.get_error(), gl::INVALID_ENUM);
        assert_eq!(c.state.matrices.mode, gl::TEXTURE);
    }
}
