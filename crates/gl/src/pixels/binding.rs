//! Names of textures: generate, bind, delete; the texture that a unit samples.

use super::image::lock;
use super::sampler::SamplerHandle;
use super::texture::{ImageTarget, TextureHandle, TextureObject, slot_of};
use crate::Context;
use crate::enums::*;
use crate::names::MAX_NAMES;
use crate::state::MAX_TEXTURE_UNITS;
use std::sync::{Arc, Mutex};
use vitral_raster::forward::Texture;

/// Textures of a context: the bound ones, and the default ones and the proxies, which have no
/// names.
#[derive(Debug)]
pub(crate) struct TextureBindings {
    /// By unit and slot; `None` is the default texture. Names may be deleted elsewhere.
    pub bound: [[Option<TextureHandle>; 5]; MAX_TEXTURE_UNITS],
    /// By slot.
    pub defaults: [TextureHandle; 5],
    /// By slot: images without texels.
    pub proxies: [TextureObject; 5],
    /// By unit: the sampler object that is bound.
    pub samplers: [Option<SamplerHandle>; MAX_TEXTURE_UNITS],
}

impl Default for TextureBindings {
    fn default() -> Self {
        Self {
            bound: Default::default(),
            defaults: std::array::from_fn(|slot| Arc::new(Mutex::new(TextureObject::new(0, slot)))),
            proxies: std::array::from_fn(|slot| TextureObject::new(0, slot)),
            samplers: Default::default(),
        }
    }
}

impl Context {
    /// The texture bound to a slot of a unit.
    pub(crate) fn bound_texture(&self, unit: usize, slot: usize) -> TextureHandle {
        self.textures.bound[unit][slot].as_ref().unwrap_or(&self.textures.defaults[slot]).clone()
    }

    /// The name of the texture bound to a slot of a unit; 0 is the default one.
    pub(crate) fn texture_name(&self, unit: usize, slot: usize) -> u32 {
        self.textures.bound[unit][slot].as_ref().map_or(0, |texture| lock(texture).name)
    }

    /// The texture bound to the active unit that an image call names.
    pub(crate) fn target_texture(&self, target: ImageTarget) -> TextureHandle {
        self.bound_texture(self.state.active_unit, target.slot)
    }

    fn sampled_object(&self, unit: usize) -> Option<TextureHandle> {
        let slot = self.state.units[unit].enabled.iter().rposition(|&enabled| enabled)?;
        Some(self.bound_texture(unit, slot))
    }

    /// The texture that unit `unit` samples: the enabled target of highest priority, if its texture
    /// is complete.
    pub(crate) fn sampled_texture(&mut self, unit: usize) -> Option<Arc<Texture>> {
        let object = self.sampled_object(unit)?;
        if lock(&object).is_stale() {
            self.flush_recorded();
        }
        let sampler =
            self.textures.samplers[unit].as_ref().map(|sampler| lock(sampler).parameters.clone());
        lock(&object).sampled(self.state.cube_map_seamless, sampler.as_ref())
    }

    /// `TEXTURE_LOD_BIAS` of the sampler object of unit `unit`, or of the texture that it samples.
    pub(crate) fn texture_lod_bias(&self, unit: usize) -> f32 {
        if let Some(sampler) = &self.textures.samplers[unit] {
            return lock(sampler).parameters.lod_bias;
        }
        self.sampled_object(unit).map_or(0.0, |object| lock(&object).parameters.lod_bias)
    }

    /// Checks a call that is not allowed between Begin and End.
    pub(crate) fn outside_begin(&mut self, call: &str) -> bool {
        let outside = !self.inside_begin();
        if !outside {
            self.record_error(INVALID_OPERATION, call, "called between glBegin and glEnd");
        }
        outside
    }

    /// Generates names in a store, and writes them to the client.
    pub(crate) fn write_names(&mut self, names: &[u32], address: usize) {
        if address != 0 && !names.is_empty() {
            self.memory.write(address, bytemuck::cast_slice(names));
        }
    }

    /// Reads `count` names from the client: none if it cannot be.
    pub(crate) fn read_names(&mut self, call: &str, count: i32, address: usize) -> Vec<u32> {
        let Ok(count) = usize::try_from(count) else {
            self.record_error(INVALID_VALUE, call, "n is negative");
            return Vec::new();
        };
        if address == 0 || count > MAX_NAMES {
            return Vec::new();
        }
        let mut names = vec![0u32; count];
        if count > 0 && !self.memory.read(address, bytemuck::cast_slice_mut(&mut names)) {
            names.clear();
        }
        names
    }

    /// The number of names to generate, if it can be done.
    pub(crate) fn name_count(&mut self, call: &str, count: i32) -> Option<usize> {
        if !self.outside_begin(call) {
            return None;
        }
        match usize::try_from(count) {
            Err(_) => self.record_error(INVALID_VALUE, call, "n is negative"),
            Ok(count) if count > MAX_NAMES => {
                self.record_error(OUT_OF_MEMORY, call, "n is too large")
            }
            Ok(count) => return Some(count),
        }
        None
    }

    /// `glGenTextures`.
    pub fn gen_textures(&mut self, n: i32, textures: usize) {
        if let Some(count) = self.name_count("glGenTextures", n) {
            let names = self.shared.names.generate(&mut lock(&self.shared.textures), count);
            self.write_names(&names, textures);
        }
    }

    /// `glGenTexturesEXT`.
    pub fn gen_textures_ext(&mut self, n: i32, textures: usize) {
        self.gen_textures(n, textures);
    }

    /// `glDeleteTextures`.
    pub fn delete_textures(&mut self, n: i32, textures: usize) {
        if !self.outside_begin("glDeleteTextures") {
            return;
        }
        for name in self.read_names("glDeleteTextures", n, textures) {
            let removed = if name == 0 { None } else { lock(&self.shared.textures).remove(&name) };
            let Some(removed) = removed else { continue };
            self.forget_label(TEXTURE, name);
            if let Some(texture) = removed {
                for bound in self.textures.bound.as_flattened_mut() {
                    bound.take_if(|bound| Arc::ptr_eq(bound, &texture));
                }
                self.detach_texture(&texture);
            }
        }
    }

    /// `glDeleteTexturesEXT`.
    pub fn delete_textures_ext(&mut self, n: i32, textures: usize) {
        self.delete_textures(n, textures);
    }

    /// `glIsTexture`.
    pub fn is_texture(&mut self, texture: u32) -> u8 {
        u8::from(
            self.outside_begin("glIsTexture")
                && texture != 0
                && lock(&self.shared.textures).get(&texture).is_some_and(Option::is_some),
        )
    }

    /// `glIsTextureEXT`.
    pub fn is_texture_ext(&mut self, texture: u32) -> u8 {
        self.is_texture(texture)
    }

    /// `glBindTexture`.
    pub fn bind_texture(&mut self, target: u32, texture: u32) {
        self.listable_keeping(move |c| c.exec_bind_texture(target, texture));
    }

    fn exec_bind_texture(&mut self, target: u32, name: u32) {
        const CALL: &str = "glBindTexture";
        if !self.outside_begin(CALL) {
            return;
        }
        let Some(slot) = slot_of(target) else {
            self.record_error(INVALID_ENUM, CALL, "target is not a texture target");
            return;
        };
        let new = || Arc::new(Mutex::new(TextureObject::new(name, slot)));
        let texture = (name != 0).then(|| {
            lock(&self.shared.textures).entry(name).or_default().get_or_insert_with(new).clone()
        });
        if texture.as_ref().is_some_and(|texture| lock(texture).slot != slot) {
            self.record_error(
                INVALID_OPERATION,
                CALL,
                "the texture was bound to another target before",
            );
            return;
        }
        let unit = self.state.active_unit;
        if self.textures.bound[unit][slot].as_ref().map(Arc::as_ptr)
            != texture.as_ref().map(Arc::as_ptr)
        {
            self.flush_vertices();
            self.textures.bound[unit][slot] = texture;
        }
    }

    /// `glPrioritizeTextures`.
    pub fn prioritize_textures(&mut self, n: i32, textures: usize, priorities: usize) {
        const CALL: &str = "glPrioritizeTextures";
        let names = self.read_names(CALL, n, textures);
        let mut values = vec![0.0f32; names.len()];
        let there =
            priorities != 0 && self.memory.read(priorities, bytemuck::cast_slice_mut(&mut values));
        // Between Begin and End even a call without names is an error.
        if !names.is_empty() && !there {
            return;
        }
        self.listable(move |c| {
            if !c.outside_begin(CALL) {
                return;
            }
            let textures = lock(&c.shared.textures);
            for (name, priority) in names.iter().zip(&values) {
                if let Some(Some(texture)) = textures.get(name) {
                    lock(texture).parameters.priority = priority.clamp(0.0, 1.0);
                }
            }
        });
    }

    /// `glAreTexturesResident`.
    pub fn are_textures_resident(&mut self, n: i32, textures: usize, residences: usize) -> u8 {
        const CALL: &str = "glAreTexturesResident";
        if !self.outside_begin(CALL) {
            return 0;
        }
        let names = self.read_names(CALL, n, textures);
        if n < 0 {
            return 0;
        }
        let known = {
            let textures = lock(&self.shared.textures);
            names.iter().all(|name| *name != 0 && textures.get(name).is_some_and(Option::is_some))
        };
        if !known {
            self.record_error(INVALID_VALUE, CALL, "a name is not a texture's");
            return 0;
        }
        // All are, so residences stays as it is.
        let _ = residences;
        1
    }

    /// `glAreTexturesResidentEXT`.
    pub fn are_textures_resident_ext(&mut self, n: i32, textures: usize, residences: usize) -> u8 {
        self.are_textures_resident(n, textures, residences)
    }

    /// Whether `name` is bound anywhere here.
    #[cfg(test)]
    pub(crate) fn is_bound(&self, name: u32) -> bool {
        self.textures
            .bound
            .as_flattened()
            .iter()
            .flatten()
            .any(|texture| lock(texture).name == name)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{BASE, context, read_u32};
    use super::*;
    use crate::state::target;

    #[test]
    fn names_become_textures_when_bound() {
        let mut c = context();
        c.gen_textures(2, BASE);
        let [a, b] = [read_u32(&c, BASE), read_u32(&c, BASE + 4)];
        assert_ne!(a, b);
        assert_eq!(c.is_texture(a), 0);
        c.bind_texture(TEXTURE_2D, a);
        assert_eq!(c.is_texture(a), 1);
        c.bind_texture(TEXTURE_3D, a);
        assert_eq!(c.error, INVALID_OPERATION);
        c.error = NO_ERROR;
        c.delete_textures(2, BASE);
        assert!(!c.is_bound(a));
        assert_eq!(c.is_texture(a), 0);
        c.bind_texture(TEXTURE_CUBE_MAP_POSITIVE_X, 0);
        assert_eq!(c.error, INVALID_ENUM);
    }

    #[test]
    fn what_is_deleted_elsewhere_stays_bound() {
        let mut c = context();
        let mut other = Context::new(c.memory.clone(), c.shared.clone());
        c.bind_texture(TEXTURE_CUBE_MAP, 5);
        c.tex_image_2d(
            TEXTURE_CUBE_MAP_NEGATIVE_Z,
            0,
            RGBA as i32,
            2,
            2,
            0,
            RGBA,
            UNSIGNED_BYTE,
            0,
        );
        c.bind_renderbuffer_ext(RENDERBUFFER, 5);
        c.renderbuffer_storage(RENDERBUFFER, RGBA8, 7, 7);
        c.bind_buffer(ARRAY_BUFFER, 5);
        c.buffer_data(ARRAY_BUFFER, 9, 0, STATIC_DRAW);
        super::super::testing::put(&c, BASE, &5u32.to_ne_bytes());
        other.delete_textures(1, BASE);
        other.delete_renderbuffers(1, BASE);
        other.delete_buffers(1, BASE);
        // Another texture, of another target, gets the name.
        other.bind_texture(TEXTURE_2D, 5);
        other.bind_renderbuffer_ext(RENDERBUFFER, 5);
        other.bind_buffer(ARRAY_BUFFER, 5);
        c.get_tex_level_parameteriv(TEXTURE_CUBE_MAP_NEGATIVE_Z, 0, TEXTURE_WIDTH, BASE);
        assert_eq!(read_u32(&c, BASE), 2);
        c.tex_image_2d(
            TEXTURE_CUBE_MAP_NEGATIVE_Z,
            0,
            RGBA as i32,
            4,
            4,
            0,
            RGBA,
            UNSIGNED_BYTE,
            0,
        );
        c.get_renderbuffer_parameteriv(RENDERBUFFER, RENDERBUFFER_WIDTH, BASE);
        assert_eq!(read_u32(&c, BASE), 7);
        c.get_buffer_parameteriv(ARRAY_BUFFER, BUFFER_SIZE, BASE);
        assert_eq!((read_u32(&c, BASE), c.texture_name(0, target::CUBE)), (9, 5));
        c.push_attrib(TEXTURE_BIT);
        c.pop_attrib();
        assert_eq!(c.texture_name(0, target::CUBE), 5);
        // Bound again, the name is the new texture.
        c.bind_texture(TEXTURE_CUBE_MAP, 5);
        assert_eq!(std::mem::take(&mut c.error), INVALID_OPERATION);
        c.bind_texture(TEXTURE_CUBE_MAP, 0);
        c.bind_texture(TEXTURE_2D, 5);
        assert!(Arc::ptr_eq(
            &c.bound_texture(0, target::TWO),
            &other.bound_texture(0, target::TWO)
        ));
        assert_eq!(c.error, NO_ERROR);
    }

    #[test]
    fn the_highest_enabled_target_counts() {
        let mut c = context();
        c.state.units[0].enabled = [true, true, false, false, false];
        lock(&c.bound_texture(0, target::TWO)).parameters.lod_bias = 2.0;
        assert_eq!(c.texture_lod_bias(0), 2.0);
        assert!(c.sampled_texture(0).is_none());
    }
}
