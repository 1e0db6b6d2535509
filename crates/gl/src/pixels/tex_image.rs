//! `TexImage`: new images of textures and proxies.

use super::Failure;
use super::format::{Content, PixelFormat};
use super::image::{TextureImage, lock};
use super::internal_format::InternalFormat;
use super::store::ClientImage;
use super::texels;
use super::texture::{ImageTarget, slot};
use super::transfer::Transfer;
use crate::Context;
use crate::enums::*;
use std::borrow::Cow;

/// The arguments that all forms of `TexImage` share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ImageArguments {
    pub call: &'static str,
    pub dimensions: usize,
    pub target: u32,
    pub level: i32,
    pub internal: u32,
    pub size: [i32; 3],
    pub border: i32,
}

/// An image call that was found valid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CheckedImage {
    pub target: ImageTarget,
    pub level: usize,
    pub format: InternalFormat,
    pub size: [u32; 3],
    pub border: u32,
    /// A proxy's image does not fit.
    pub too_large: bool,
}

/// Size as unsigned numbers if each is neither negative nor beyond every limit.
pub(crate) fn plausible(size: [i32; 3]) -> Option<[usize; 3]> {
    let largest = crate::state::MAX_TEXTURE_SIZE as i32 + 2;
    size.iter().all(|s| (0..=largest).contains(s)).then(|| size.map(|s| s as usize))
}

impl ImageArguments {
    /// Checks everything but the client's format.
    pub(crate) fn check(&self) -> Result<CheckedImage, Failure> {
        // Check the target, the level and the format.
        let target = ImageTarget::new(self.target, Some(self.dimensions))
            .ok_or((INVALID_ENUM, "target is not an image target of this call"))?;
        let level = usize::try_from(self.level)
            .ok()
            .filter(|&l| l < target.max_levels())
            .ok_or((INVALID_VALUE, "level is negative or larger than the target allows"))?;
        let format = InternalFormat::of_texture(self.internal)
            .ok_or((INVALID_VALUE, "internalformat is not an internal format"))?;

        // Check the border and the size.
        if !(0..=1).contains(&self.border) || (target.slot == slot::RECTANGLE && self.border != 0) {
            return Err((INVALID_VALUE, "border is neither 0 nor 1, or not 0 of a rectangle"));
        }
        let border = self.border as u32;
        let mut size = [1u32; 3];
        for i in 0..self.dimensions {
            size[i] = u32::try_from(self.size[i])
                .ok()
                .filter(|&s| s >= 2 * border)
                .ok_or((INVALID_VALUE, "a size is negative or smaller than the borders"))?;
        }
        check_shape(target, &format, size)?;

        // Check the limits; a proxy reports them instead of an error.
        let limit = (target.max_size() >> level) as u32 + 2 * border;
        let too_large = !TextureImage::fits(&format, size);
        let beyond = size[..self.dimensions].iter().any(|&s| s > limit);
        if beyond && !target.proxy {
            return Err((INVALID_VALUE, "a size is larger than the target allows at this level"));
        }
        if too_large && !target.proxy {
            return Err((OUT_OF_MEMORY, "the image is too large"));
        }
        let too_large = too_large || beyond || is_skewed(target, size);
        Ok(CheckedImage { target, level, format, size, border, too_large })
    }
}

/// Whether a face of a cube map is not square.
pub(super) fn is_skewed(target: ImageTarget, size: [u32; 3]) -> bool {
    target.slot == slot::CUBE && size[0] != size[1]
}

/// Whether a target takes images of this format and shape. A proxy takes faces that are not square,
/// as it does images that are too large.
pub(super) fn check_shape(
    target: ImageTarget,
    format: &InternalFormat,
    size: [u32; 3],
) -> Result<(), Failure> {
    if !target.proxy && is_skewed(target, size) {
        return Err((INVALID_VALUE, "a cube map's face is not square"));
    }
    // OpenGL 1.5 has no depth cube maps; 3.0 has, and Mesa in every version.
    if format.has_depth() && target.slot == slot::THREE {
        return Err((INVALID_OPERATION, "depth formats are not for 3D textures"));
    }
    Ok(())
}

/// Whether pixels of `format` may become texels of `internal`.
pub(crate) fn formats_agree(format: PixelFormat, internal: &InternalFormat) -> Result<(), Failure> {
    let fits = match format.content() {
        Content::Stencil if internal.has_depth() => false,
        Content::Stencil => return Err((INVALID_ENUM, "stencil indices are no texels")),
        Content::Color | Content::Index => !internal.has_depth(),
        Content::Depth => internal.base == DEPTH_COMPONENT || internal.base == DEPTH_STENCIL,
        Content::DepthStencil => internal.base == DEPTH_STENCIL || internal.base == DEPTH_COMPONENT,
    };
    if fits {
        Ok(())
    } else {
        Err((INVALID_OPERATION, "format and internal format are not both of depth"))
    }
}

impl Context {
    /// Stores a checked image; without texels they are undefined.
    pub(crate) fn store_image(
        &mut self,
        call: &str,
        checked: &CheckedImage,
        data: Option<texels::TexelData>,
    ) {
        let mut image = TextureImage::new(checked.format, checked.size, checked.border);
        if data.is_none() && !image.allocate() {
            return self.record_error(OUT_OF_MEMORY, call, "there is no memory for the image");
        }
        self.image_came(image.bytes());
        if let Some(data) = data.filter(|_| !checked.size.contains(&0)) {
            image.replace(data);
        }
        self.shared.storage_changed();
        let texture = self.target_texture(checked.target);
        lock(&texture).set_image(checked.target.face, checked.level, Some(image));
        self.image_changed(checked.target, checked.level);
    }

    /// What follows a change of a level's texels: `GENERATE_MIPMAP`.
    pub(crate) fn image_changed(&mut self, target: ImageTarget, level: usize) {
        let texture = self.target_texture(target);
        let mut texture = lock(&texture);
        texture.touch();
        if texture.parameters.generate_mipmap && texture.base_level() == Some(level) {
            super::mipmap::generate(&mut texture, target.face..target.face + 1);
            self.shared.storage_changed();
        }
    }

    fn tex_image(&mut self, arguments: ImageArguments, format: u32, kind: u32, pixels: usize) {
        let pair = PixelFormat::new(format, kind);
        let size = arguments.size;
        let checked = arguments.check();

        // Answer proxies without texels.
        if ImageTarget::new(arguments.target, Some(arguments.dimensions)).is_some_and(|t| t.proxy) {
            if self.outside_begin(arguments.call) {
                self.proxy_image(&arguments, pair);
            }
            return;
        }

        // Read the client's pixels if the call is good so far.
        let image = match (&pair, &checked) {
            (Ok(pair), Ok(checked))
                if formats_agree(*pair, &checked.format).is_ok()
                    && (self.lists.recording || self.may_get_image(checked.target).is_ok()) =>
            {
                plausible(size).map_or(Ok(None), |s| {
                    self.read_image(*pair, s, arguments.dimensions == 3, pixels)
                })
            }
            _ => Ok(None),
        };
        let image = match image {
            Ok(image) => image,
            Err((error, why)) => return self.record_error(error, arguments.call, why),
        };

        // Run the call, or keep it in the display list.
        if !self.lists.recording {
            return self.exec_tex_image(&arguments, pair, image.map(Cow::Owned));
        }
        self.listable(move |c| {
            c.exec_tex_image(&arguments, pair, image.as_ref().map(Cow::Borrowed))
        });
    }

    fn exec_tex_image(
        &mut self,
        arguments: &ImageArguments,
        format: Result<PixelFormat, Failure>,
        image: Option<Cow<'_, ClientImage>>,
    ) {
        if !self.outside_begin(arguments.call) {
            return;
        }
        let checked = arguments.check().and_then(|c| formats_agree(format?, &c.format).map(|()| c));
        match checked.and_then(|c| self.may_get_image(c.target).map(|()| c)) {
            Err((error, why)) => self.record_error(error, arguments.call, why),
            Ok(checked) => {
                let transfer = Transfer::new(&self.state.pixel);
                let data = image.map(|image| {
                    texels::from_client(&self.workers(), image, &checked.format, &transfer)
                });
                self.store_image(arguments.call, &checked, data);
            }
        }
    }

    fn proxy_image(&mut self, arguments: &ImageArguments, format: Result<PixelFormat, Failure>) {
        let checked = arguments.check().and_then(|c| formats_agree(format?, &c.format).map(|()| c));
        match checked {
            // What does not fit clears the proxy's state, other mistakes are errors as always.
            Err((error, why)) => self.record_error(error, arguments.call, why),
            Ok(checked) => self.set_proxy_image(&checked),
        }
    }

    /// Gives a proxy what a checked image would be.
    pub(crate) fn set_proxy_image(&mut self, checked: &CheckedImage) {
        let image = (!checked.too_large)
            .then(|| TextureImage::new(checked.format, checked.size, checked.border));
        self.textures.proxies[checked.target.slot].set_image(0, checked.level, image);
    }

    /// `glTexImage1D`.
    pub fn tex_image_1d(
        &mut self,
        target: u32,
        level: i32,
        internalformat: i32,
        width: i32,
        border: i32,
        format: u32,
        type_: u32,
        pixels: usize,
    ) {
        let call = "glTexImage1D";
        let internal = internalformat as u32;
        let size = [width, 1, 1];
        let arguments =
            ImageArguments { call, dimensions: 1, target, level, internal, size, border };
        self.tex_image(arguments, format, type_, pixels);
    }

    /// `glTexImage2D`.
    pub fn tex_image_2d(
        &mut self,
        target: u32,
        level: i32,
        internalformat: i32,
        width: i32,
        height: i32,
        border: i32,
        format: u32,
        type_: u32,
        pixels: usize,
    ) {
        let call = "glTexImage2D";
        let internal = internalformat as u32;
        let size = [width, height, 1];
        let arguments =
            ImageArguments { call, dimensions: 2, target, level, internal, size, border };
        self.tex_image(arguments, format, type_, pixels);
    }

    /// `glTexImage3D`.
    pub fn tex_image_3d(
        &mut self,
        target: u32,
        level: i32,
        internalformat: i32,
        width: i32,
        height: i32,
        depth: i32,
        border: i32,
        format: u32,
        type_: u32,
        pixels: usize,
    ) {
        let call = "glTexImage3D";
        let internal = internalformat as u32;
        let size = [width, height, depth];
        let arguments =
            ImageArguments { call, dimensions: 3, target, level, internal, size, border };
        self.tex_image(arguments, format, type_, pixels);
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{BASE, context, context_with, put, read_u32};
    use super::*;
    use std::sync::{Arc, Weak};
    use vitral_raster::forward::Texture;

    fn level_parameter(c: &mut Context, target: u32, level: i32, pname: u32) -> u32 {
        c.get_tex_level_parameteriv(target, level, pname, BASE + 1024);
        read_u32(c, BASE + 1024)
    }

    #[test]
    fn an_image_keeps_its_size_and_bits() {
        let mut c = context();
        c.tex_image_2d(TEXTURE_2D, 0, RGB5 as i32, 3, 5, 0, RGB, UNSIGNED_BYTE, 0);
        assert_eq!(c.error, NO_ERROR);
        assert_eq!(level_parameter(&mut c, TEXTURE_2D, 0, TEXTURE_WIDTH), 3);
        assert_eq!(level_parameter(&mut c, TEXTURE_2D, 0, TEXTURE_HEIGHT), 5);
        assert_eq!(level_parameter(&mut c, TEXTURE_2D, 0, TEXTURE_RED_SIZE), 8);
        assert_eq!(level_parameter(&mut c, TEXTURE_2D, 0, TEXTURE_ALPHA_SIZE), 0);
        assert_eq!(level_parameter(&mut c, TEXTURE_2D, 1, TEXTURE_INTERNAL_FORMAT), 1);
    }

    /// Gives the texture a new image of 16 MiB.
    fn give_image(c: &mut Context) {
        c.tex_image_2d(TEXTURE_2D, 0, RGBA8 as i32, 2048, 2048, 0, RGBA, UNSIGNED_BYTE, 0);
    }

    /// A context that draws with such an image.
    fn textured() -> Context {
        let mut c = context_with(4, 4);
        c.enable(TEXTURE_2D);
        c.tex_parameteri(TEXTURE_2D, TEXTURE_MIN_FILTER, NEAREST as i32);
        give_image(&mut c);
        c
    }

    /// Draws with the texture as it is, which the draw holds while it waits.
    fn draw(c: &mut Context) -> Weak<Texture> {
        c.rectf(0.0, 0.0, 1.0, 1.0);
        Arc::downgrade(&c.sampled_texture(0).unwrap())
    }

    #[test]
    fn images_do_not_pile_up_behind_draws() {
        let mut c = textured();
        let drawn = draw(&mut c);
        // The second draw holds another image, and both wait.
        give_image(&mut c);
        draw(&mut c);
        assert_eq!(drawn.strong_count(), 1);
        (0..4).for_each(|_| give_image(&mut c));
        assert_eq!(drawn.strong_count(), 0);
    }

    #[test]
    fn parts_do_not_pile_up_behind_draws() {
        let mut c = textured();
        for _ in 0..3 {
            let drawn = draw(&mut c);
            assert!(drawn.strong_count() > 0);
            // No copy of so large a level is made for one texel: the draw that waits is run with
            // the old texels.
            c.tex_sub_image_2d(TEXTURE_2D, 0, 0, 0, 1, 1, RGBA, UNSIGNED_BYTE, BASE);
            assert_eq!(drawn.strong_count(), 0);
        }
    }

    #[test]
    fn mistakes_change_nothing() {
        let mut c = context();
        let mut error = |target, level, internal: u32, size: i32, border, format, kind| {
            c.error = NO_ERROR;
            c.tex_image_2d(target, level, internal as i32, size, size, border, format, kind, 0);
            c.error
        };
        assert_eq!(error(TEXTURE_3D, 0, RGBA, 4, 0, RGBA, FLOAT), INVALID_ENUM);
        assert_eq!(error(TEXTURE_2D, 20, RGBA, 4, 0, RGBA, FLOAT), INVALID_VALUE);
        assert_eq!(error(TEXTURE_2D, 0, 99, 4, 0, RGBA, FLOAT), INVALID_VALUE);
        assert_eq!(error(TEXTURE_2D, 0, RGBA, -1, 0, RGBA, FLOAT), INVALID_VALUE);
        assert_eq!(error(TEXTURE_2D, 0, RGBA, i32::MAX, 0, RGBA, FLOAT), INVALID_VALUE);
        assert_eq!(error(TEXTURE_2D, 0, RGBA, 4, 2, RGBA, FLOAT), INVALID_VALUE);
        assert_eq!(error(TEXTURE_2D, 0, RGBA, 4, 0, DEPTH_COMPONENT, FLOAT), INVALID_OPERATION);
        assert_eq!(error(TEXTURE_2D, 0, RGBA, 4, 0, STENCIL_INDEX, FLOAT), INVALID_ENUM);
        assert_eq!(error(TEXTURE_CUBE_MAP, 0, RGBA, 4, 0, RGBA, FLOAT), INVALID_ENUM);
        assert_eq!(error(PROXY_TEXTURE_2D, 0, RGBA, 1 << 20, 0, RGBA, FLOAT), NO_ERROR);
        assert_eq!(level_parameter(&mut c, PROXY_TEXTURE_2D, 0, TEXTURE_WIDTH), 0);
        assert_eq!(level_parameter(&mut c, TEXTURE_2D, 0, TEXTURE_WIDTH), 0);
    }

    #[test]
    fn compressed_formats_are_taken_and_stay_uncompressed() {
        let mut c = context();
        c.tex_image_2d(TEXTURE_2D, 0, COMPRESSED_RGB_S3TC_DXT1_EXT as i32, 4, 4, 0, RGBA, FLOAT, 0);
        assert_eq!(c.error, NO_ERROR);
        assert_eq!(level_parameter(&mut c, TEXTURE_2D, 0, TEXTURE_WIDTH), 4);
        assert_eq!(level_parameter(&mut c, TEXTURE_2D, 0, TEXTURE_COMPRESSED), 0);
    }

    #[test]
    fn a_proxy_of_a_skewed_cube_has_no_size() {
        let mut c = context();
        for (height, kept) in [(16, 16), (8, 0)] {
            c.tex_image_2d(PROXY_TEXTURE_CUBE_MAP, 0, RGBA as i32, 16, height, 0, RGBA, FLOAT, 0);
            assert_eq!(level_parameter(&mut c, PROXY_TEXTURE_CUBE_MAP, 0, TEXTURE_WIDTH), kept);
        }
        assert_eq!(c.error, NO_ERROR);
        c.tex_image_2d(TEXTURE_CUBE_MAP_POSITIVE_X, 0, RGBA as i32, 16, 8, 0, RGBA, FLOAT, 0);
        assert_eq!(c.error, INVALID_VALUE);
    }

    #[test]
    fn pixels_come_back() {
        let mut c = context();
        put(&c, BASE, &[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]);
        c.client.unpack.alignment = 1;
        c.client.pack.alignment = 1;
        c.tex_image_2d(TEXTURE_2D, 0, RGB as i32, 2, 2, 0, RGB, UNSIGNED_BYTE, BASE);
        c.tex_sub_image_2d(TEXTURE_2D, 0, 1, 0, 1, 1, BGR, UNSIGNED_BYTE, BASE);
        c.get_tex_image(TEXTURE_2D, 0, RGB, UNSIGNED_BYTE, BASE + 512);
        assert_eq!(
            super::super::testing::get(&c, BASE + 512),
            [1, 2, 3, 3, 2, 1, 7, 8, 9, 10, 11, 12]
        );
        assert_eq!(c.error, NO_ERROR);
    }
}
