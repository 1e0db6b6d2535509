//! `GetTexImage` and `GetTexLevelParameter`.

use super::Failure;
use super::encode;
use super::format::{Content, PixelFormat};
use super::image::lock;
use super::internal_format::Bits;
use super::store::{Region, write_region};
use super::texture::{ImageTarget, TextureObject};
use super::transfer::clamp_colors;
use crate::Context;
use crate::enums::*;

/// A level's parameter. Levels without an image have the initial values.
fn level_parameter(
    texture: &mut TextureObject,
    face: usize,
    level: usize,
    pname: u32,
) -> Result<i32, Failure> {
    // Take the values of the image, or the initial ones.
    let image = texture.image(face, level);
    let blocks = image.as_ref().and_then(|i| i.blocks.clone());
    let (size, border, token, bits, kind) = match &image {
        Some(i) => (i.size, i.border, i.format.token, i.format.bits(), i.format.component_type()),
        None => ([0; 3], 0, 1, Bits::default(), NONE),
    };
    let token = blocks.as_ref().map_or(token, |blocks| blocks.token);

    // Report the parameter.
    let of = |bits: i32| if bits > 0 { kind as i32 } else { NONE as i32 };
    Ok(match pname {
        TEXTURE_WIDTH => size[0] as i32,
        TEXTURE_HEIGHT => size[1] as i32,
        TEXTURE_DEPTH => size[2] as i32,
        TEXTURE_BORDER => border as i32,
        TEXTURE_INTERNAL_FORMAT => token as i32,
        TEXTURE_RED_SIZE => bits.rgba[0],
        TEXTURE_GREEN_SIZE => bits.rgba[1],
        TEXTURE_BLUE_SIZE => bits.rgba[2],
        TEXTURE_ALPHA_SIZE => bits.rgba[3],
        TEXTURE_LUMINANCE_SIZE => bits.luminance,
        TEXTURE_INTENSITY_SIZE => bits.intensity,
        TEXTURE_DEPTH_SIZE => bits.depth,
        TEXTURE_STENCIL_SIZE => bits.stencil,
        TEXTURE_RED_TYPE_ARB => of(bits.rgba[0]),
        TEXTURE_GREEN_TYPE_ARB => of(bits.rgba[1]),
        TEXTURE_BLUE_TYPE_ARB => of(bits.rgba[2]),
        TEXTURE_ALPHA_TYPE_ARB => of(bits.rgba[3]),
        TEXTURE_LUMINANCE_TYPE_ARB => of(bits.luminance),
        TEXTURE_INTENSITY_TYPE_ARB => of(bits.intensity),
        TEXTURE_DEPTH_TYPE_ARB => of(bits.depth),
        TEXTURE_COMPRESSED => i32::from(blocks.is_some()),
        TEXTURE_COMPRESSED_IMAGE_SIZE if blocks.is_some() => {
            blocks.map_or(0, |blocks| blocks.bytes.len() as i32)
        }
        TEXTURE_COMPRESSED_IMAGE_SIZE => {
            return Err((INVALID_OPERATION, "the image is not compressed"));
        }
        _ => return Err((INVALID_ENUM, "pname is not a parameter of a level")),
    })
}

impl Context {
    pub(crate) fn query_target(
        &self,
        target: u32,
        level: i32,
        proxies: bool,
    ) -> Result<(ImageTarget, usize), Failure> {
        let target = ImageTarget::new(target, None)
            .filter(|t| proxies || !t.proxy)
            .ok_or((INVALID_ENUM, "target is not an image target of this call"))?;
        let level = usize::try_from(level)
            .ok()
            .filter(|&l| l < target.max_levels())
            .ok_or((INVALID_VALUE, "level is negative or larger than the target allows"))?;
        Ok((target, level))
    }

    fn tex_level_parameter(
        &mut self,
        call: &str,
        target: u32,
        level: i32,
        pname: u32,
    ) -> Option<i32> {
        if !self.outside_begin(call) {
            return None;
        }
        let value = self.query_target(target, level, true).and_then(|(target, level)| {
            if target.proxy {
                return level_parameter(
                    &mut self.textures.proxies[target.slot],
                    target.face,
                    level,
                    pname,
                );
            }
            let texture = self.target_texture(target);
            let mut texture = lock(&texture);
            level_parameter(&mut texture, target.face, level, pname)
        });
        value.map_err(|(error, why)| self.record_error(error, call, why)).ok()
    }

    /// `glGetTexLevelParameterfv`.
    pub fn get_tex_level_parameterfv(
        &mut self,
        target: u32,
        level: i32,
        pname: u32,
        params: usize,
    ) {
        if let Some(value) =
            self.tex_level_parameter("glGetTexLevelParameterfv", target, level, pname)
            && params != 0
        {
            self.memory.write(params, &(value as f32).to_ne_bytes());
        }
    }

    /// `glGetTexLevelParameteriv`.
    pub fn get_tex_level_parameteriv(
        &mut self,
        target: u32,
        level: i32,
        pname: u32,
        params: usize,
    ) {
        if let Some(value) =
            self.tex_level_parameter("glGetTexLevelParameteriv", target, level, pname)
            && params != 0
        {
            self.memory.write(params, &value.to_ne_bytes());
        }
    }

    /// `glGetTexImage`.
    pub fn get_tex_image(
        &mut self,
        target: u32,
        level: i32,
        format: u32,
        type_: u32,
        pixels: usize,
    ) {
        const CALL: &str = "glGetTexImage";
        if !self.outside_begin(CALL) {
            return;
        }
        if let Err((error, why)) = self.read_texture(target, level, format, type_, pixels) {
            self.record_error(error, CALL, why);
        }
    }

    fn read_texture(
        &mut self,
        target: u32,
        level: i32,
        format: u32,
        kind: u32,
        pixels: usize,
    ) -> Result<(), Failure> {
        // Check the arguments.
        let (target, level) = self.query_target(target, level, false)?;
        let format = PixelFormat::new(format, kind)?;
        if matches!(format.content(), Content::Index | Content::Stencil) {
            return Err((INVALID_ENUM, "a texture has no indices"));
        }

        // Finish the draws into the texture.
        let texture = self.target_texture(target);
        let pending = lock(&texture).needs_flush();
        if pending {
            self.flush_recorded();
        }

        // Check that the texture holds the requested components.
        let mut texture = lock(&texture);
        let dimensions = texture.dimensions();
        let Some(image) = texture.image(target.face, level) else { return Ok(()) };
        let fits = match format.content() {
            Content::Depth => image.format.has_depth(),
            Content::DepthStencil => image.format.has_stencil(),
            _ => image.format.is_color(),
        };
        if !fits {
            return Err((INVALID_OPERATION, "the texture does not hold what format asks for"));
        }
        let full = image.full();
        if (pixels == 0 && self.client.pack.buffer.is_none()) || full.contains(&0) {
            return Ok(());
        }
        // No pixel transfer here, unlike in `ReadPixels`.
        let mut bytes = vec![0; full.iter().product::<usize>() * format.pixel_bytes()];
        let encode_words = |words: &[u32]| {
            let mut bytes = vec![0; words.len() * format.pixel_bytes()];
            encode::words(words, format, &mut bytes);
            bytes
        };

        // Encode words directly if the format allows it.
        if encode::takes_words(format)
            && let Some(encoded) = image.with_words(encode_words)
        {
            bytes = encoded;
        } else if format.content() == Content::Color {
            let mut colors = image.colors();
            if image.format.component_type() != FLOAT || !matches!(kind, FLOAT | HALF_FLOAT_ARB) {
                clamp_colors(&mut colors);
            }
            if matches!(format.format, LUMINANCE | LUMINANCE_ALPHA) {
                // Not their sum as in `ReadPixels`: a texture's luminance is its red.
                colors.iter_mut().for_each(|c| *c = [c[0], 0.0, 0.0, c[3]]);
            }
            encode::colors(&colors, format, &mut bytes);
        } else {
            let depths = image.depths();
            if format.content() == Content::Depth {
                encode::depths(&depths, format, &mut bytes);
            } else {
                encode::depth_stencils(&depths, &image.stencils(), kind, &mut bytes);
            }
        }

        // Write the bytes to the client's memory or the bound buffer.
        let region = Region::whole(full, dimensions == 3);
        self.pack_into(pixels, format.element_bytes(), |memory, address| {
            write_region(memory, &self.client.pack, format, &region, address, bytes)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{BASE, context, get, put, read_floats};
    use super::*;

    #[test]
    fn luminance_is_read_as_red() {
        let mut c = context();
        put(&c, BASE, &[100, 200]);
        c.tex_image_1d(
            TEXTURE_1D,
            0,
            LUMINANCE_ALPHA as i32,
            1,
            0,
            LUMINANCE_ALPHA,
            UNSIGNED_BYTE,
            BASE,
        );
        c.get_tex_image(TEXTURE_1D, 0, RGBA, UNSIGNED_BYTE, BASE);
        assert_eq!(get(&c, BASE), [100, 0, 0, 200]);
        c.get_tex_image(TEXTURE_1D, 0, LUMINANCE, UNSIGNED_BYTE, BASE);
        assert_eq!(get(&c, BASE), [100]);
        assert_eq!(c.error, NO_ERROR);
        c.get_tex_image(TEXTURE_1D, 0, DEPTH_COMPONENT, UNSIGNED_BYTE, BASE);
        assert_eq!(c.error, INVALID_OPERATION);
    }

    #[test]
    fn wide_formats_keep_their_precision() {
        let mut c = context();
        put(&c, BASE, &[1, 2, 3, 4, 5, 6, 7, 8]);
        c.tex_image_1d(TEXTURE_1D, 0, RGBA16 as i32, 1, 0, RGBA, UNSIGNED_SHORT, BASE);
        c.get_tex_image(TEXTURE_1D, 0, RGBA, UNSIGNED_SHORT, BASE + 64);
        assert_eq!(get(&c, BASE + 64), [1, 2, 3, 4, 5, 6, 7, 8]);
        put(&c, BASE, bytemuck::cast_slice(&[-2.5f32, 1000.0, 0.1]));
        c.tex_image_1d(TEXTURE_1D, 0, RGB32F_ARB as i32, 1, 0, RGB, FLOAT, BASE);
        c.get_tex_image(TEXTURE_1D, 0, RGB, FLOAT, BASE + 64);
        assert_eq!(read_floats(&c, BASE + 64), [-2.5, 1000.0, 0.1]);
    }

    #[test]
    fn pixel_transfer_leaves_texels_alone() {
        let mut c = context();
        put(&c, BASE, &[10, 20, 30, 40]);
        c.tex_image_1d(TEXTURE_1D, 0, RGBA as i32, 1, 0, RGBA, UNSIGNED_BYTE, BASE);
        c.pixel_transferf(RED_SCALE, 2.0);
        c.pixel_transferf(GREEN_BIAS, 0.5);
        c.get_tex_image(TEXTURE_1D, 0, RGBA, UNSIGNED_BYTE, BASE + 64);
        assert_eq!(get(&c, BASE + 64), [10, 20, 30, 40]);
        put(&c, BASE, &0x1234_5678u32.to_ne_bytes());
        c.tex_image_1d(
            TEXTURE_1D,
            0,
            DEPTH24_STENCIL8 as i32,
            1,
            0,
            DEPTH_STENCIL,
            UNSIGNED_INT_24_8,
            BASE,
        );
        c.pixel_transferf(DEPTH_SCALE, 0.5);
        c.pixel_transferi(INDEX_OFFSET, 1);
        c.get_tex_image(TEXTURE_1D, 0, DEPTH_STENCIL, UNSIGNED_INT_24_8, BASE + 64);
        assert_eq!(get(&c, BASE + 64), 0x1234_5678u32.to_ne_bytes());
        assert_eq!(c.error, NO_ERROR);
    }

    #[test]
    fn depth_and_stencil_come_back() {
        let mut c = context();
        put(&c, BASE, &0x1234_5678u32.to_ne_bytes());
        c.tex_image_1d(
            TEXTURE_1D,
            0,
            DEPTH24_STENCIL8 as i32,
            1,
            0,
            DEPTH_STENCIL,
            UNSIGNED_INT_24_8,
            BASE,
        );
        c.get_tex_image(TEXTURE_1D, 0, DEPTH_STENCIL, UNSIGNED_INT_24_8, BASE + 64);
        assert_eq!(get(&c, BASE + 64), 0x1234_5678u32.to_ne_bytes());
        assert_eq!(c.error, NO_ERROR);
    }
}
