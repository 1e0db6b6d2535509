//! Matrix stacks.

use super::{MAX_MATRIX_STACK_DEPTH, MAX_TEXTURE_STACK_DEPTH, MAX_TEXTURE_UNITS};
use crate::enums;
use vitral_math::Mat4;

/// A stack of matrices; never empty.
#[derive(Clone, Debug, PartialEq)]
pub struct MatrixStack {
    /// The top is the last.
    pub matrices: Vec<Mat4>,
    /// How many it may hold.
    pub limit: usize,
}

impl MatrixStack {
    /// One identity.
    pub fn new(limit: usize) -> Self {
        Self { matrices: vec![Mat4::IDENTITY], limit }
    }

    /// The current matrix.
    pub fn top(&self) -> Mat4 {
        self.matrices[self.matrices.len() - 1]
    }

    /// The current matrix, to change.
    pub fn top_mut(&mut self) -> &mut Mat4 {
        let last = self.matrices.len() - 1;
        &mut self.matrices[last]
    }
}

/// All stacks and the transform enables.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrices {
    /// `MATRIX_MODE`.
    pub mode: u32,
    /// Model to eye.
    pub modelview: MatrixStack,
    /// Eye to clip.
    pub projection: MatrixStack,
    /// Texture coordinates, one stack a unit.
    pub texture: [MatrixStack; MAX_TEXTURE_UNITS],
    /// Colour matrix stack is not there (imaging subset); `NORMALIZE`.
    pub normalize: bool,
    /// `RESCALE_NORMAL`.
    pub rescale_normal: bool,
}

impl Default for Matrices {
    fn default() -> Self {
        Self {
            mode: enums::MODELVIEW,
            modelview: MatrixStack::new(MAX_MATRIX_STACK_DEPTH),
            projection: MatrixStack::new(MAX_MATRIX_STACK_DEPTH),
            texture: std::array::from_fn(|_| MatrixStack::new(MAX_TEXTURE_STACK_DEPTH)),
            normalize: false,
            rescale_normal: false,
        }
    }
}
