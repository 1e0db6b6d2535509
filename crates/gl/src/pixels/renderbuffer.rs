//! Renderbuffers.

use super::image::{Shared, lock, new_color_plane};
use super::internal_format::{Bits, InternalFormat};

use crate::Context;
use crate::enums::*;
use crate::memory::can_have;
use crate::state::{MAX_SAMPLES, MAX_TEXTURE_SIZE};
use std::sync::{Arc, Mutex};
use vitral_raster::Viewport;
use vitral_raster::forward::{ColorPlane, DepthBuffer, Plane, StencilPlane};

/// A renderbuffer that attachments share.
pub(crate) type RenderbufferHandle = Arc<Mutex<Renderbuffer>>;

/// Planes without an owner: of a renderbuffer or of framebuffer 0.
#[derive(Clone, Debug)]
pub(crate) struct RenderbufferStorage {
    /// The format of the stored pixels.
    pub format: InternalFormat,
    /// Size.
    pub viewport: Viewport,
    /// 0, or samples a pixel.
    pub samples: usize,
    /// Colours.
    pub color: Option<Shared<ColorPlane>>,
    /// Depths, if the format has them.
    pub depth: Option<Shared<DepthBuffer>>,
    /// Stencil values.
    pub stencil: Option<Shared<StencilPlane>>,
}

impl RenderbufferStorage {
    fn new(format: InternalFormat, viewport: Viewport, samples: usize) -> Self {
        let planes = samples.max(1);
        Self {
            format,
            viewport,
            samples,
            color: format
                .is_color()
                .then(|| Arc::new(Mutex::new(new_color_plane(&format, viewport, planes)))),
            depth: format.has_depth().then(|| {
                let plane = Plane::new(viewport, planes, 0.0);
                Arc::new(Mutex::new(DepthBuffer::new(plane, format.depth_scale())))
            }),
            stencil: format
                .has_stencil()
                .then(|| Arc::new(Mutex::new(Plane::new(viewport, planes, 0)))),
        }
    }
}

/// A renderbuffer object.
#[derive(Debug, Default)]
pub(crate) struct Renderbuffer {
    /// Its name.
    pub name: u32,
    /// What was asked for: format, width, height, samples.
    asked: Option<(InternalFormat, [i32; 2], usize)>,
    /// `None` if no storage was asked for, or of size 0.
    pub storage: Option<RenderbufferStorage>,
}

impl Context {
    /// `glGenRenderbuffers`.
    pub fn gen_renderbuffers(&mut self, n: i32, renderbuffers: usize) {
        if let Some(count) = self.name_count("glGenRenderbuffers", n) {
            let names = self.shared.names.generate(&mut lock(&self.shared.renderbuffers), count);
            self.write_names(&names, renderbuffers);
        }
    }

    /// `glDeleteRenderbuffers`.
    pub fn delete_renderbuffers(&mut self, n: i32, renderbuffers: usize) {
        if !self.outside_begin("glDeleteRenderbuffers") {
            return;
        }
        for name in self.read_names("glDeleteRenderbuffers", n, renderbuffers) {
            let removed =
                if name == 0 { None } else { lock(&self.shared.renderbuffers).remove(&name) };
            let Some(removed) = removed else { continue };
            self.forget_label(RENDERBUFFER, name);
            if let Some(renderbuffer) = removed {
                self.framebuffers.renderbuffer.take_if(|bound| Arc::ptr_eq(bound, &renderbuffer));
                self.detach_renderbuffer(&renderbuffer);
            }
        }
    }

    /// `glIsRenderbuffer`.
    pub fn is_renderbuffer(&mut self, renderbuffer: u32) -> u8 {
        u8::from(
            self.outside_begin("glIsRenderbuffer")
                && renderbuffer != 0
                && lock(&self.shared.renderbuffers).get(&renderbuffer).is_some_and(Option::is_some),
        )
    }

    /// `glBindRenderbuffer`: the name must have been generated.
    pub fn bind_renderbuffer(&mut self, target: u32, renderbuffer: u32) {
        self.bind_renderbuffer_name("glBindRenderbuffer", target, renderbuffer, true);
    }

    /// `glBindRenderbufferEXT`: any name will do.
    pub fn bind_renderbuffer_ext(&mut self, target: u32, renderbuffer: u32) {
        self.bind_renderbuffer_name("glBindRenderbufferEXT", target, renderbuffer, false);
    }

    fn bind_renderbuffer_name(&mut self, call: &str, target: u32, name: u32, generated: bool) {
        if !self.renderbuffer_target(call, target) {
            return;
        }
        let mut bound = None;
        if name != 0 {
            let shared = self.shared.clone();
            let mut names = lock(&shared.renderbuffers);
            if generated && !names.contains_key(&name) {
                self.record_error(INVALID_OPERATION, call, "the name was not generated");
                return;
            }
            let new = || Arc::new(Mutex::new(Renderbuffer { name, ..Renderbuffer::default() }));
            bound = Some(names.entry(name).or_default().get_or_insert_with(new).clone());
        }
        self.framebuffers.renderbuffer = bound;
    }

    fn renderbuffer_target(&mut self, call: &str, target: u32) -> bool {
        if !self.outside_begin(call) {
            return false;
        }
        if target != RENDERBUFFER {
            self.record_error(INVALID_ENUM, call, "target is not RENDERBUFFER");
        }
        target == RENDERBUFFER
    }

    fn bound_renderbuffer(&mut self, call: &str) -> Option<RenderbufferHandle> {
        let bound = self.framebuffers.renderbuffer.clone();
        if bound.is_none() {
            self.record_error(INVALID_OPERATION, call, "no renderbuffer is bound");
        }
        bound
    }

    /// `glRenderbufferStorage`.
    pub fn renderbuffer_storage(
        &mut self,
        target: u32,
        internalformat: u32,
        width: i32,
        height: i32,
    ) {
        self.set_renderbuffer_storage(
            "glRenderbufferStorage",
            target,
            0,
            internalformat,
            width,
            height,
        );
    }

    /// `glRenderbufferStorageMultisample`.
    pub fn renderbuffer_storage_multisample(
        &mut self,
        target: u32,
        samples: i32,
        internalformat: u32,
        width: i32,
        height: i32,
    ) {
        let call = "glRenderbufferStorageMultisample";
        self.set_renderbuffer_storage(call, target, samples, internalformat, width, height);
    }

    fn set_renderbuffer_storage(
        &mut self,
        call: &str,
        target: u32,
        samples: i32,
        internal: u32,
        width: i32,
        height: i32,
    ) {
        if !self.renderbuffer_target(call, target) {
            return;
        }

        // Check the format, the size and the samples.
        let Some(format) = InternalFormat::of_renderbuffer(internal) else {
            self.record_error(INVALID_ENUM, call, "internalformat cannot be rendered to");
            return;
        };
        let side = 0..=MAX_TEXTURE_SIZE as i32;
        if !side.contains(&width) || !side.contains(&height) {
            self.record_error(
                INVALID_VALUE,
                call,
                "a size is negative or larger than MAX_RENDERBUFFER_SIZE",
            );
            return;
        }
        if !(0..=MAX_SAMPLES as i32).contains(&samples) {
            self.record_error(
                INVALID_VALUE,
                call,
                "samples is negative or larger than MAX_SAMPLES",
            );
            return;
        }

        // Check the memory.
        let Some(renderbuffer) = self.bound_renderbuffer(call) else { return };
        let samples = if samples == 0 { 0 } else { MAX_SAMPLES };
        let viewport = Viewport::new(width as u32, height as u32);
        let pixels = width as usize * height as usize * samples.max(1);
        if !can_have(pixels * format.texel_bytes()) {
            return self.record_error(
                OUT_OF_MEMORY,
                call,
                "there is no memory for so many samples",
            );
        }

        // Replace the storage.
        let mut renderbuffer = lock(&renderbuffer);
        renderbuffer.asked = Some((format, [width, height], samples));
        renderbuffer.storage = viewport.map(|v| RenderbufferStorage::new(format, v, samples));
        self.shared.storage_changed();
    }

    /// `glGetRenderbufferParameteriv`.
    pub fn get_renderbuffer_parameteriv(&mut self, target: u32, pname: u32, params: usize) {
        const CALL: &str = "glGetRenderbufferParameteriv";
        if !self.renderbuffer_target(CALL, target) {
            return;
        }
        let Some(renderbuffer) = self.bound_renderbuffer(CALL) else { return };

        // Find the storage that was asked for.
        let asked = lock(&renderbuffer).asked;
        let (token, bits) =
            asked.map_or((RGBA, Bits::default()), |(format, ..)| (format.token, format.bits()));
        let ([width, height], samples) =
            asked.map_or(([0; 2], 0), |(_, size, samples)| (size, samples));

        // Report the parameter.
        let value = match pname {
            RENDERBUFFER_WIDTH => width,
            RENDERBUFFER_HEIGHT => height,
            RENDERBUFFER_INTERNAL_FORMAT => token as i32,
            RENDERBUFFER_SAMPLES => samples as i32,
            RENDERBUFFER_RED_SIZE => bits.rgba[0],
            RENDERBUFFER_GREEN_SIZE => bits.rgba[1],
            RENDERBUFFER_BLUE_SIZE => bits.rgba[2],
            RENDERBUFFER_ALPHA_SIZE => bits.rgba[3],
            RENDERBUFFER_DEPTH_SIZE => bits.depth,
            RENDERBUFFER_STENCIL_SIZE => bits.stencil,
            _ => {
                self.record_error(INVALID_ENUM, CALL, "pname is not a renderbuffer parameter");
                return;
            }
        };
        if params != 0 {
            self.memory.write(params, &value.to_ne_bytes());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{BASE, context, read_u32};
    use super::*;

    #[test]
    fn storage_reports_what_it_has() {
        let mut c = context();
        c.bind_renderbuffer(RENDERBUFFER, 7);
        assert_eq!(c.error, INVALID_OPERATION);
        c.error = NO_ERROR;
        c.gen_renderbuffers(1, BASE);
        let name = read_u32(&c, BASE);
        c.bind_renderbuffer(RENDERBUFFER, name);
        c.renderbuffer_storage_multisample(RENDERBUFFER, 2, DEPTH32F_STENCIL8, 640, 480);
        let mut get = |pname| {
            c.get_renderbuffer_parameteriv(RENDERBUFFER, pname, BASE);
            read_u32(&c, BASE)
        };
        assert_eq!(get(RENDERBUFFER_SAMPLES), 4);
        assert_eq!(get(RENDERBUFFER_DEPTH_SIZE), 32);
        assert_eq!(get(RENDERBUFFER_STENCIL_SIZE), 8);
        assert_eq!(get(RENDERBUFFER_WIDTH), 640);
        // Nothing to draw to is something to ask about.
        c.renderbuffer_storage(RENDERBUFFER, DEPTH_COMPONENT24, 0, 5);
        let mut get = |pname| {
            c.get_renderbuffer_parameteriv(RENDERBUFFER, pname, BASE);
            read_u32(&c, BASE)
        };
        assert_eq!(
            [RENDERBUFFER_WIDTH, RENDERBUFFER_HEIGHT, RENDERBUFFER_DEPTH_SIZE].map(&mut get),
            [0, 5, 24]
        );
        assert_eq!(get(RENDERBUFFER_INTERNAL_FORMAT), DEPTH_COMPONENT24);
        let mut error = |samples, format, width| {
            c.error = NO_ERROR;
            c.renderbuffer_storage_multisample(RENDERBUFFER, samples, format, width, 1);
            c.error
        };
        assert_eq!(error(5, RGBA8, 1), INVALID_VALUE);
        assert_eq!(error(0, RGBA8, -1), INVALID_VALUE);
        assert_eq!(error(0, COMPRESSED_RGB, 1), INVALID_ENUM);
    }
}
