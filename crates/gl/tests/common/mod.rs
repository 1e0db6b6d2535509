//! A context over an arena, with what the tests ask of it.

use std::ops::{Deref, DerefMut};
use std::sync::Arc;
use vitral_gl::memory::Arena;
use vitral_gl::{ClientMemory, Context, Shared, enums as gl};

const BASE: usize = 0x10_0000;
const LEN: usize = 1 << 22;
/// Where the colour buffer lies.
pub(crate) const BUFFER: usize = BASE + LEN / 2;
/// Where results go.
const RESULT: usize = BASE + LEN / 4;

/// A context that draws.
pub(crate) struct Stage {
    c: Context,
    memory: Arc<Arena>,
    next: usize,
    pub(crate) size: [i32; 2],
}

impl Deref for Stage {
    type Target = Context;
    fn deref(&self) -> &Context {
        &self.c
    }
}

impl DerefMut for Stage {
    fn deref_mut(&mut self) -> &mut Context {
        &mut self.c
    }
}

impl Stage {
    /// RGBA bytes, 24 bits of depth, 8 of stencil, accumulation; clip space is the window.
    pub(crate) fn new(width: i32, height: i32) -> Self {
        Self::with_buffer(width, height, gl::RGBA, gl::UNSIGNED_BYTE)
    }

    /// A buffer of this format and type.
    pub(crate) fn with_buffer(width: i32, height: i32, format: u32, kind: u32) -> Self {
        let memory = Arc::new(Arena::new(BASE, LEN));
        let mut c = Context::new(memory.clone(), Arc::new(Shared::default()));
        c.configure_default_framebuffer(format, 24, 8, 16);
        assert!(c.make_current(BUFFER, kind, width, height));
        c.pixel_storei(gl::PACK_ALIGNMENT, 1);
        c.pixel_storei(gl::UNPACK_ALIGNMENT, 1);
        Self { c, memory, next: BASE, size: [width, height] }
    }

    /// Values in the client's memory.
    pub(crate) fn put<T: bytemuck::NoUninit>(&mut self, values: &[T]) -> usize {
        let (at, bytes) = (self.next, bytemuck::cast_slice::<T, u8>(values));
        assert!(at + bytes.len() < RESULT && self.memory.write(at, bytes));
        self.next += bytes.len().next_multiple_of(16);
        at
    }

    /// Writes where the client says.
    pub(crate) fn raw_write(&mut self, address: usize, bytes: &[u8]) {
        assert!(self.memory.write(address, bytes));
    }

    /// Values from the client's memory.
    pub(crate) fn take<T: bytemuck::Pod>(&self, address: usize, count: usize) -> Vec<T> {
        let mut values = vec![T::zeroed(); count];
        assert!(self.memory.read(address, bytemuck::cast_slice_mut(&mut values)));
        values
    }

    /// `glReadPixels` of the whole window.
    fn read<T: bytemuck::Pod>(&mut self, format: u32, kind: u32, per_pixel: usize) -> Vec<T> {
        let [w, h] = self.size;
        self.c.read_pixels(0, 0, w, h, format, kind, RESULT);
        self.take(RESULT, (w * h) as usize * per_pixel)
    }

    pub(crate) fn bytes(&mut self) -> Vec<[u8; 4]> {
        bytemuck::cast_slice(&self.read::<u8>(gl::RGBA, gl::UNSIGNED_BYTE, 4)).to_vec()
    }

    pub(crate) fn floats(&mut self) -> Vec<[f32; 4]> {
        bytemuck::cast_slice(&self.read::<f32>(gl::RGBA, gl::FLOAT, 4)).to_vec()
    }

    pub(crate) fn depths(&mut self) -> Vec<f32> {
        self.read(gl::DEPTH_COMPONENT, gl::FLOAT, 1)
    }

    pub(crate) fn stencils(&mut self) -> Vec<u8> {
        self.read(gl::STENCIL_INDEX, gl::UNSIGNED_BYTE, 1)
    }

    pub(crate) fn pixel(&mut self, x: i32, y: i32) -> [u8; 4] {
        let at = (y * self.size[0] + x) as usize;
        self.bytes()[at]
    }

    /// Results of `glGetFloatv`.
    pub(crate) fn get<const N: usize>(&mut self, name: u32) -> [f32; N] {
        self.c.get_floatv(name, RESULT);
        let values = self.take(RESULT, N);
        std::array::from_fn(|i| values[i])
    }

    /// A rectangle in clip space at depth `z`.
    pub(crate) fn rectangle(&mut self, [x0, y0, x1, y1]: [f32; 4], z: f32) {
        self.c.begin(gl::QUADS);
        for [x, y] in [[x0, y0], [x1, y0], [x1, y1], [x0, y1]] {
            self.c.tex_coord_2f((x + 1.0) / 2.0, (y + 1.0) / 2.0);
            self.c.vertex_3f(x, y, z);
        }
        self.c.end();
    }

    /// The whole window in a colour.
    pub(crate) fn fill(&mut self, [r, g, b, a]: [f32; 4], z: f32) {
        self.c.color_4f(r, g, b, a);
        self.rectangle([-1.0, -1.0, 1.0, 1.0], z);
    }

    /// Makes units of clip space into pixels.
    pub(crate) fn pixels(&mut self) {
        let [w, h] = self.size.map(f64::from);
        self.c.ortho(0.0, w, 0.0, h, -1.0, 1.0);
    }

    /// A texture of RGBA bytes with these levels, bound to `TEXTURE_2D`, nearest and enabled.
    pub(crate) fn texture(&mut self, levels: &[(i32, Vec<[u8; 4]>)]) {
        for (level, (size, texels)) in levels.iter().enumerate() {
            let at = self.put(texels);
            let (level, rgba) = (level as i32, gl::RGBA);
            self.c.tex_image_2d(
                gl::TEXTURE_2D,
                level,
                rgba as i32,
                *size,
                *size,
                0,
                rgba,
                gl::UNSIGNED_BYTE,
                at,
            );
        }
        for filter in [gl::TEXTURE_MIN_FILTER, gl::TEXTURE_MAG_FILTER] {
            self.c.tex_parameteri(gl::TEXTURE_2D, filter, gl::NEAREST as i32);
        }
        self.c.tex_envi(gl::TEXTURE_ENV, gl::TEXTURE_ENV_MODE, gl::REPLACE as i32);
        self.c.enable(gl::TEXTURE_2D);
    }

    #[track_caller]
    pub(crate) fn no_error(&mut self) {
        assert_eq!(self.c.get_error(), gl::NO_ERROR);
    }
}

/// Numbers without order.
pub(crate) struct Dice(pub(crate) u64);

impl Dice {
    pub(crate) fn below(&mut self, n: u32) -> u32 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as u32 % n
    }

    /// -1 to 1, with few digits.
    pub(crate) fn number(&mut self) -> f32 {
        (self.below(65) as f32 - 32.0) / 32.0
    }

    pub(crate) fn color(&mut self) -> [f32; 4] {
        [0; 4].map(|_| self.below(9) as f32 / 8.0)
    }
}

/// Whether bytes agree with colours to one step.
#[track_caller]
pub(crate) fn assert_color(found: [u8; 4], expected: [f32; 4]) {
    for k in 0..4 {
        let error = (f32::from(found[k]) - (expected[k].clamp(0.0, 1.0) * 255.0).round()).abs();
        assert!(error <= 1.0, "{found:?} instead of {:?}", expected.map(|v| v * 255.0));
    }
}
