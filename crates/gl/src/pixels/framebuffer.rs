//! Framebuffer objects: names, bindings, and the calls that attach images.

use super::Failure;
use super::attachments::{Attached, DEPTH_POINT, FramebufferObject, STENCIL_POINT};
use super::image::lock;
use super::renderbuffer::RenderbufferHandle;
use super::target::Resolved;
use super::texture::{ImageTarget, TextureHandle, slot};
use crate::Context;
use crate::enums::*;
use crate::names::Names;
use crate::state::MAX_3D_TEXTURE_SIZE;
use std::sync::Arc;

/// Framebuffer objects and the bound ones.
#[derive(Debug, Default)]
pub(crate) struct FramebufferBindings {
    /// By name.
    pub objects: Names<FramebufferObject>,
    /// `DRAW_FRAMEBUFFER_BINDING`.
    pub draw: u32,
    /// `READ_FRAMEBUFFER_BINDING`.
    pub read: u32,
    /// The renderbuffer that is bound: itself, for its name may be deleted elsewhere.
    pub renderbuffer: Option<RenderbufferHandle>,
    /// Grows with every change of bindings and attachments.
    pub version: u64,
    /// Where draws go, as long as nothing changes.
    pub resolved: Option<Resolved>,
}

impl FramebufferBindings {
    /// The object with that name.
    pub(crate) fn object(&self, name: u32) -> Option<&FramebufferObject> {
        self.objects.get(&name).and_then(Option::as_ref)
    }

    fn changed(&mut self) {
        self.version += 1;
    }
}

/// The attachment points that a token names.
fn points(attachment: u32) -> Result<&'static [usize], Failure> {
    const COLORS: [[usize; 1]; 8] = [[0], [1], [2], [3], [4], [5], [6], [7]];
    match attachment {
        COLOR_ATTACHMENT0..=COLOR_ATTACHMENT15 => COLORS
            .get((attachment - COLOR_ATTACHMENT0) as usize)
            .map(|p| &p[..])
            .ok_or((INVALID_OPERATION, "there are not so many colour attachments")),
        DEPTH_ATTACHMENT => Ok(&[DEPTH_POINT]),
        STENCIL_ATTACHMENT => Ok(&[STENCIL_POINT]),
        DEPTH_STENCIL_ATTACHMENT => Ok(&[DEPTH_POINT, STENCIL_POINT]),
        _ => Err((INVALID_ENUM, "attachment is not an attachment point")),
    }
}

impl Context {
    /// `glGenFramebuffers`.
    pub fn gen_framebuffers(&mut self, n: i32, framebuffers: usize) {
        if let Some(count) = self.name_count("glGenFramebuffers", n) {
            let names = self.shared.names.generate(&mut self.framebuffers.objects, count);
            self.write_names(&names, framebuffers);
        }
    }

    /// `glDeleteFramebuffers`.
    pub fn delete_framebuffers(&mut self, n: i32, framebuffers: usize) {
        if !self.outside_begin("glDeleteFramebuffers") {
            return;
        }
        for name in self.read_names("glDeleteFramebuffers", n, framebuffers) {
            if name == 0 || self.framebuffers.objects.remove(&name).is_none() {
                continue;
            }
            self.forget_label(FRAMEBUFFER, name);
            if self.framebuffers.draw == name {
                self.framebuffers.draw = 0;
            }
            if self.framebuffers.read == name {
                self.framebuffers.read = 0;
            }
            self.framebuffers.changed();
        }
    }

    /// `glIsFramebuffer`.
    pub fn is_framebuffer(&mut self, framebuffer: u32) -> u8 {
        u8::from(
            self.outside_begin("glIsFramebuffer")
                && framebuffer != 0
                && self.framebuffers.object(framebuffer).is_some(),
        )
    }

    /// `glBindFramebuffer`: the name must have been generated.
    pub fn bind_framebuffer(&mut self, target: u32, framebuffer: u32) {
        self.bind_framebuffer_name("glBindFramebuffer", target, framebuffer, true);
    }

    /// `glBindFramebufferEXT`: any name will do.
    pub fn bind_framebuffer_ext(&mut self, target: u32, framebuffer: u32) {
        self.bind_framebuffer_name("glBindFramebufferEXT", target, framebuffer, false);
    }

    fn bind_framebuffer_name(&mut self, call: &str, target: u32, name: u32, generated: bool) {
        if !self.outside_begin(call) {
            return;
        }

        // Find the bindings that the target names.
        let (draw, read) = match target {
            FRAMEBUFFER => (true, true),
            DRAW_FRAMEBUFFER => (true, false),
            READ_FRAMEBUFFER => (false, true),
            _ => {
                self.record_error(INVALID_ENUM, call, "target is not a framebuffer target");
                return;
            }
        };

        // Create the object at its first binding.
        if name != 0 {
            if generated && !self.framebuffers.objects.contains_key(&name) {
                self.record_error(INVALID_OPERATION, call, "the name was not generated");
                return;
            }
            self.framebuffers.objects.entry(name).or_default().get_or_insert_default();
        }

        // Bind it.
        if draw && self.framebuffers.draw != name {
            self.framebuffers.draw = name;
            self.framebuffers.changed();
        }
        if read {
            self.framebuffers.read = name;
        }
    }

    /// The name bound to a framebuffer target.
    pub(crate) fn framebuffer_of(&mut self, call: &str, target: u32) -> Option<u32> {
        match target {
            FRAMEBUFFER | DRAW_FRAMEBUFFER => Some(self.framebuffers.draw),
            READ_FRAMEBUFFER => Some(self.framebuffers.read),
            _ => {
                self.record_error(INVALID_ENUM, call, "target is not a framebuffer target");
                None
            }
        }
    }

    fn attach(&mut self, call: &str, target: u32, attachment: u32, attached: Option<Attached>) {
        let Some(name) = self.framebuffer_of(call, target) else { return };
        let points = match points(attachment) {
            Ok(points) => points,
            Err((error, why)) => return self.record_error(error, call, why),
        };
        let Some(Some(object)) = self.framebuffers.objects.get_mut(&name) else {
            return self.record_error(INVALID_OPERATION, call, "framebuffer 0 has no attachments");
        };
        for &point in points {
            object.attachments[point] = attached.clone();
        }
        self.framebuffers.changed();
    }

    fn detach(&mut self, is_it: impl Fn(&Attached) -> bool) {
        let bound = [self.framebuffers.draw, self.framebuffers.read];
        for name in bound {
            if let Some(Some(object)) = self.framebuffers.objects.get_mut(&name) {
                for point in &mut object.attachments {
                    if point.as_ref().is_some_and(&is_it) {
                        *point = None;
                    }
                }
            }
        }
        self.framebuffers.changed();
    }

    /// Detaches a deleted texture from the bound framebuffers.
    pub(crate) fn detach_texture(&mut self, deleted: &TextureHandle) {
        self.detach(
            |a| matches!(a, Attached::Texture { texture, .. } if Arc::ptr_eq(texture, deleted)),
        );
    }

    /// Detaches a deleted renderbuffer from the bound framebuffers.
    pub(crate) fn detach_renderbuffer(&mut self, deleted: &RenderbufferHandle) {
        self.detach(|a| matches!(a, Attached::Renderbuffer(r) if Arc::ptr_eq(r, deleted)));
    }

    /// `glFramebufferRenderbuffer`.
    pub fn framebuffer_renderbuffer(
        &mut self,
        target: u32,
        attachment: u32,
        renderbuffertarget: u32,
        renderbuffer: u32,
    ) {
        const CALL: &str = "glFramebufferRenderbuffer";
        if !self.outside_begin(CALL) {
            return;
        }
        if renderbuffertarget != RENDERBUFFER {
            return self.record_error(INVALID_ENUM, CALL, "renderbuffertarget is not RENDERBUFFER");
        }
        let mut attached = None;
        if renderbuffer != 0 {
            let found = lock(&self.shared.renderbuffers).get(&renderbuffer).cloned().flatten();
            let Some(found) = found else {
                return self.record_error(INVALID_OPERATION, CALL, "there is no such renderbuffer");
            };
            attached = Some(Attached::Renderbuffer(found));
        }
        self.attach(CALL, target, attachment, attached);
    }

    /// Attaches a level of a texture; `textarget` is missing in `FramebufferTextureLayer`.
    fn attach_texture(
        &mut self,
        call: &str,
        target: u32,
        attachment: u32,
        textarget: Option<(u32, usize)>,
        name: u32,
        level: i32,
        layer: i32,
    ) {
        if !self.outside_begin(call) {
            return;
        }

        // Detach with name 0.
        if name == 0 {
            return self.attach(call, target, attachment, None);
        }

        // Look the texture up.
        let Some(texture) = lock(&self.shared.textures).get(&name).cloned().flatten() else {
            return self.record_error(INVALID_OPERATION, call, "there is no such texture");
        };

        // Check that the texture has the face or layer.
        let kind = lock(&texture).slot;
        let face = match textarget {
            None if kind == slot::THREE => 0,
            None => return self.record_error(INVALID_OPERATION, call, "the texture has no layers"),
            Some((textarget, dimensions)) => {
                match ImageTarget::new(textarget, None).filter(|t| !t.proxy) {
                    None => {
                        return self.record_error(
                            INVALID_ENUM,
                            call,
                            "textarget is not an image target",
                        );
                    }
                    Some(t)
                        if t.slot != kind
                            || ImageTarget::new(textarget, Some(dimensions)).is_none() =>
                    {
                        return self.record_error(
                            INVALID_OPERATION,
                            call,
                            "textarget does not fit the texture",
                        );
                    }
                    Some(t) => t.face,
                }
            }
        };

        // Check the level and the layer.
        let levels = ImageTarget { slot: kind, face, proxy: false }.max_levels();
        let Some(level) = usize::try_from(level).ok().filter(|&l| l < levels) else {
            return self.record_error(
                INVALID_VALUE,
                call,
                "level is negative or larger than the target allows",
            );
        };
        let Some(layer) = usize::try_from(layer).ok().filter(|&l| l < MAX_3D_TEXTURE_SIZE) else {
            return self.record_error(INVALID_VALUE, call, "the layer is negative or too large");
        };

        // Attach the level.
        self.attach(
            call,
            target,
            attachment,
            Some(Attached::Texture { texture, face, level, layer }),
        );
    }

    /// `glFramebufferTexture1D`.
    pub fn framebuffer_texture_1d(
        &mut self,
        target: u32,
        attachment: u32,
        textarget: u32,
        texture: u32,
        level: i32,
    ) {
        let call = "glFramebufferTexture1D";
        self.attach_texture(call, target, attachment, Some((textarget, 1)), texture, level, 0);
    }

    /// `glFramebufferTexture2D`.
    pub fn framebuffer_texture_2d(
        &mut self,
        target: u32,
        attachment: u32,
        textarget: u32,
        texture: u32,
        level: i32,
    ) {
        let call = "glFramebufferTexture2D";
        self.attach_texture(call, target, attachment, Some((textarget, 2)), texture, level, 0);
    }

    /// `glFramebufferTexture3D`.
    pub fn framebuffer_texture_3d(
        &mut self,
        target: u32,
        attachment: u32,
        textarget: u32,
        texture: u32,
        level: i32,
        zoffset: i32,
    ) {
        let call = "glFramebufferTexture3D";
        self.attach_texture(
            call,
            target,
            attachment,
            Some((textarget, 3)),
            texture,
            level,
            zoffset,
        );
    }

    /// `glFramebufferTextureLayer`.
    pub fn framebuffer_texture_layer(
        &mut self,
        target: u32,
        attachment: u32,
        texture: u32,
        level: i32,
        layer: i32,
    ) {
        self.attach_texture(
            "glFramebufferTextureLayer",
            target,
            attachment,
            None,
            texture,
            level,
            layer,
        );
    }

    /// The draw or read buffer of a bound framebuffer object changed.
    pub(crate) fn set_object_buffer(&mut self, draw: bool, buffer: u32) {
        let name = if draw { self.framebuffers.draw } else { self.framebuffers.read };
        if let Some(Some(object)) = self.framebuffers.objects.get_mut(&name) {
            // A read buffer that is missing makes a framebuffer incomplete, too.
            *(if draw { &mut object.draw_buffer } else { &mut object.read_buffer }) = buffer;
            self.framebuffers.changed();
        }
    }
}
