//! Names of textures: generate, bind, delete; the texture that a unit samples.

use super::image::lock;
use super::names;
use super::sampler::SamplerHandle;
use super::texture::{ImageTarget, TextureHandle, TextureObject, slot_of};
use crate::Context;
use crate::enums::*;
use std::sync::{Arc, Mutex};
use vitral_raster::forward::Texture;

/// Textures of a context that have no names: the default ones and the proxies.
#[derive(Debug)]
pub(crate) struct UnnamedTextures {
    /// By slot.
    pub defaults: [TextureHandle; 5],
    /// By slot: images without texels.
    pub proxies: [TextureObject; 5],
    /// By unit: the sampler object that is bound.
    pub samplers: [Option<SamplerHandle>; crate::state::MAX_TEXTURE_UNITS],
}

impl Default for UnnamedTextures {
    fn default() -> Self {
        Self {
            defaults: std::array::from_fn(|slot| Arc::new(Mutex::new(TextureObject::new(0, slot)))),
            proxies: std::array::from_fn(|slot| TextureObject::new(0, slot)),
            samplers: Default::default(),
        }
    }
}

impl Context {
    /// The texture bound to a slot of a unit.
    pub(crate) fn bound_texture(&self, unit: usize, slot: usize) -> TextureHandle {
        let name = self.state.units[unit].bindings[slot];
        if name != 0
            && let Some(Some(texture)) = lock(&self.shared.textures).get(&name)
        {
            return texture.clone();
        }
        self.textures.defaults[slot].clone()
    }

    /// Whether there is a texture of that name that belongs to a slot.
    pub(crate) fn is_texture_of(&self, name: u32, slot: usize) -> bool {
        lock(&self.shared.textures).get(&name).is_some_and(|t| t.as_ref().is_some_and(|t| lock(t).slot == slot))
    }

    /// The texture bound to the active unit that an image call names.
    pub(crate) fn target_texture(&self, target: ImageTarget) -> TextureHandle {
        self.bound_texture(self.state.active_unit, target.slot)
    }

    fn sampled_object(&self, unit: usize) -> Option<TextureHandle> {
        let slot = self.state.units[unit].enabled.iter().rposition(|&enabled| enabled)?;
        Some(self.bound_texture(unit, slot))
    }

    /// The texture that unit `unit` samples: the enabled target of highest priority, if its texture is complete.
    pub(crate) fn sampled_texture(&mut self, unit: usize) -> Option<Arc<Texture>> {
        let object = self.sampled_object(unit)?;
        if lock(&object).is_stale() {
            self.flush_recorded();
        }
        let sampler = self.textures.samplers[unit].as_ref().map(|sampler| lock(sampler).parameters.clone());
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
        if address == 0 || count > names::MAX_NAMES {
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
            Ok(count) if count > names::MAX_NAMES => self.record_error(OUT_OF_MEMORY, call, "n is too large"),
            Ok(count) => return Some(count),
        }
        None
    }

    /// `glGenTextures`.
    pub fn gen_textures(&mut self, n: i32, textures: usize) {
        if let Some(count) = self.name_count("glGenTextures", n) {
            let names = names::generate(&mut lock(&self.shared.textures), count);
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
            for unit in &mut self.state.units {
                unit.bindings.iter_mut().filter(|bound| **bound == name).for_each(|bound| *bound = 0);
            }
            if let Some(texture) = removed {
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
        if name != 0 {
            let mut textures = lock(&self.shared.textures);
            let entry = textures.entry(name).or_default();
            let object = entry.get_or_insert_with(|| Arc::new(Mutex::new(TextureObject::new(name, slot))));
            let fits = lock(object).slot == slot;
            drop(textures);
            if !fits {
                self.record_error(INVALID_OPERATION, CALL, "the texture was bound to another target before");
                return;
            }
        }
        let unit = self.state.active_unit;
        if self.state.units[unit].bindings[slot] != name {
            self.flush_vertices();
            self.state.units[unit].bindings[slot] = name;
        }
    }

    /// `glPrioritizeTextures`.
    pub fn prioritize_textures(&mut self, n: i32, textures: usize, priorities: usize) {
        const CALL: &str = "glPrioritizeTextures";
        let names = self.read_names(CALL, n, textures);
        let mut values = vec![0.0f32; names.len()];
        let there = priorities != 0 && self.memory.read(priorities, bytemuck::cast_slice_mut(&mut values));
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
        self.state.units.iter().any(|unit| unit.bindings.contains(&name))
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
    fn the_highest_enabled_target_counts() {
        let mut c = context();
        c.state.units[0].enabled = [true, true, false, false, false];
        lock(&c.bound_texture(0, target::TWO)).parameters.lod_bias = 2.0;
        assert_eq!(c.texture_lod_bias(0), 2.0);
        assert!(c.sampled_texture(0).is_none());
    }
}
