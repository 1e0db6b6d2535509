//! ARB_texture_storage: all levels of a texture at once, for good.
//!
//! Source: the ARB_texture_storage specification.

use super::Failure;
use super::image::{TextureImage, lock};
use super::internal_format::{InternalFormat, is_sized};
use super::tex_image::{check_shape, is_skewed};
use super::texture::{ImageTarget, slot, slot_of};
use crate::Context;
use crate::enums::*;

/// A target that was found valid, and the most levels that an image of `size` has.
fn check_target(
    target: u32,
    dimensions: usize,
    size: [u32; 3],
) -> Result<(ImageTarget, usize), Failure> {
    const NOT_ONE: Failure = (INVALID_ENUM, "target is not a texture target of this call");
    let target = match slot_of(target) {
        Some(slot) => ImageTarget { slot, face: 0, proxy: false },
        None => ImageTarget::new(target, Some(dimensions)).filter(|t| t.proxy).ok_or(NOT_ONE)?,
    };
    let used = match target.slot {
        slot::ONE => 1,
        slot::THREE => 3,
        _ => 2,
    };
    if used != dimensions {
        return Err(NOT_ONE);
    }
    let most = if target.slot == slot::RECTANGLE {
        0
    } else {
        size.into_iter().max().unwrap_or(1).ilog2()
    };
    Ok((target, most as usize + 1))
}

impl Context {
    fn tex_storage(
        &mut self,
        call: &'static str,
        dimensions: usize,
        target: u32,
        levels: i32,
        token: u32,
        size: [i32; 3],
    ) {
        if self.outside_begin(call)
            && let Err((error, why)) =
                self.exec_tex_storage(dimensions, target, levels, token, size)
        {
            self.record_error(error, call, why);
        }
    }

    fn exec_tex_storage(
        &mut self,
        dimensions: usize,
        target: u32,
        levels: i32,
        token: u32,
        size: [i32; 3],
    ) -> Result<(), Failure> {
        // Check the format, the sizes and the levels.
        let format =
            InternalFormat::of_texture(token).filter(|f| f.token == token && is_sized(token));
        let format =
            format.ok_or((INVALID_ENUM, "internalformat is not a sized internal format"))?;
        if levels < 1 || size.iter().any(|&s| s < 1) {
            return Err((INVALID_VALUE, "the number of levels, or a size, is less than 1"));
        }
        let size = size.map(|s| s as u32);
        let (target, most) = check_target(target, dimensions, size)?;
        check_shape(target, &format, size)?;
        if levels as usize > most {
            return Err((INVALID_OPERATION, "images of this size have fewer levels"));
        }

        // Check the memory; a proxy reports it instead of an error.
        let beyond = size.iter().any(|&s| s as usize > target.max_size());
        let fits = TextureImage::fits(&format, size) && !beyond && !is_skewed(target, size);
        if target.proxy {
            let proxy = &mut self.textures.proxies[target.slot];
            proxy.set_images(format, if fits { levels as usize } else { 0 }, size);
            return Ok(());
        }

        // Check that the texture has no fixed levels yet.
        let texture = self.target_texture(target);
        let mut texture = lock(&texture);
        if texture.name == 0 {
            return Err((INVALID_OPERATION, "the default texture cannot be made immutable"));
        }
        if texture.immutable {
            return Err((INVALID_OPERATION, "the texture is immutable"));
        }
        if !fits {
            return Err((
                if beyond { INVALID_VALUE } else { OUT_OF_MEMORY },
                "the images are too large",
            ));
        }

        // Allocate all levels and fix them.
        if !texture.allocate(format, levels as usize, size) {
            return Err((OUT_OF_MEMORY, "there is no memory for the images"));
        }
        texture.immutable = true;
        texture.parameters.bound_levels(levels as usize);
        drop(texture);
        self.shared.storage_changed();
        Ok(())
    }

    /// `glTexStorage1D`.
    pub fn tex_storage_1d(&mut self, target: u32, levels: i32, internalformat: u32, width: i32) {
        self.tex_storage("glTexStorage1D", 1, target, levels, internalformat, [width, 1, 1]);
    }

    /// `glTexStorage2D`.
    pub fn tex_storage_2d(
        &mut self,
        target: u32,
        levels: i32,
        internalformat: u32,
        width: i32,
        height: i32,
    ) {
        self.tex_storage("glTexStorage2D", 2, target, levels, internalformat, [width, height, 1]);
    }

    /// `glTexStorage3D`.
    pub fn tex_storage_3d(
        &mut self,
        target: u32,
        levels: i32,
        internalformat: u32,
        width: i32,
        height: i32,
        depth: i32,
    ) {
        self.tex_storage(
            "glTexStorage3D",
            3,
            target,
            levels,
            internalformat,
            [width, height, depth],
        );
    }

    /// Whether the texture that an image call names may get a new image.
    pub(crate) fn may_get_image(&self, target: ImageTarget) -> Result<(), Failure> {
        let immutable = !target.proxy && lock(&self.target_texture(target)).immutable;
        if immutable { Err((INVALID_OPERATION, "the texture is immutable")) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{BASE, context, read_u32};
    use super::*;

    #[test]
    fn levels_are_made_at_once_and_stay() {
        let mut c = context();
        c.bind_texture(TEXTURE_2D, 5);
        c.tex_storage_2d(TEXTURE_2D, 3, RGBA8, 8, 2);
        assert_eq!(c.error, NO_ERROR);
        let mut level = |level, pname| {
            c.get_tex_level_parameteriv(TEXTURE_2D, level, pname, BASE);
            read_u32(&c, BASE)
        };
        assert_eq!(
            [level(0, TEXTURE_WIDTH), level(1, TEXTURE_WIDTH), level(2, TEXTURE_WIDTH)],
            [8, 4, 2]
        );
        assert_eq!(
            [level(1, TEXTURE_HEIGHT), level(2, TEXTURE_HEIGHT), level(3, TEXTURE_WIDTH)],
            [1, 1, 0]
        );
        // Mipmapping ends with the last level that there is.
        c.enable(TEXTURE_2D);
        assert_eq!(c.sampled_texture(0).unwrap().faces[0].len(), 3);
        c.get_tex_parameteriv(TEXTURE_2D, TEXTURE_IMMUTABLE_FORMAT, BASE);
        assert_eq!((read_u32(&c, BASE), c.error), (1, NO_ERROR));
        // Which levels there are bounds which are used.
        c.tex_parameteri(TEXTURE_2D, TEXTURE_MAX_LEVEL, 9);
        c.get_tex_parameteriv(TEXTURE_2D, TEXTURE_MAX_LEVEL, BASE);
        assert_eq!(read_u32(&c, BASE), 2);
        c.tex_image_2d(TEXTURE_2D, 0, RGBA8 as i32, 8, 2, 0, RGBA, UNSIGNED_BYTE, 0);
        assert_eq!(std::mem::take(&mut c.error), INVALID_OPERATION);
        c.tex_storage_2d(TEXTURE_2D, 1, RGBA8, 8, 2);
        assert_eq!(std::mem::take(&mut c.error), INVALID_OPERATION);
        c.tex_sub_image_2d(TEXTURE_2D, 2, 0, 0, 1, 1, RGBA, UNSIGNED_BYTE, BASE);
        assert_eq!(c.error, NO_ERROR);
    }

    #[test]
    fn mistakes_change_nothing() {
        let mut c = context();
        let mut error = |name, target, levels, format, size| {
            c.bind_texture(TEXTURE_2D, name);
            c.tex_storage_2d(target, levels, format, size, 4);
            std::mem::take(&mut c.error)
        };
        assert_eq!(error(0, TEXTURE_2D, 1, RGBA8, 4), INVALID_OPERATION);
        assert_eq!(error(1, TEXTURE_3D, 1, RGBA8, 4), INVALID_ENUM);
        assert_eq!(error(1, TEXTURE_2D, 1, RGBA, 4), INVALID_ENUM);
        assert_eq!(error(1, TEXTURE_2D, 0, RGBA8, 4), INVALID_VALUE);
        assert_eq!(error(1, TEXTURE_2D, 4, RGBA8, 4), INVALID_OPERATION);
        assert_eq!(error(1, TEXTURE_2D, 1, RGBA8, 1 << 20), INVALID_VALUE);
        assert_eq!(error(1, PROXY_TEXTURE_2D, 1, RGBA8, 1 << 20), NO_ERROR);
        assert_eq!(error(1, PROXY_TEXTURE_CUBE_MAP, 1, RGBA8, 8), NO_ERROR);
        assert_eq!(error(1, TEXTURE_CUBE_MAP, 1, RGBA8, 8), INVALID_VALUE);
        assert_eq!(error(1, TEXTURE_2D, 3, RGBA8, 4), NO_ERROR);
    }
}
