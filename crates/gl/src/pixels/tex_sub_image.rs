//! `TexSubImage`: new texels for a part of an image.

use super::Failure;
use super::format::PixelFormat;
use super::image::lock;
use super::store::ClientImage;
use super::tex_image::{formats_agree, plausible};
use super::texels::{self, TexelData};
use super::texture::ImageTarget;
use super::transfer::Transfer;
use crate::Context;
use crate::enums::*;
use crate::memory::can_have;
use std::borrow::Cow;

/// Most bytes of texels that are copied for a change of a few of them, since draws that wait need
/// the old ones: to copy more takes longer than to run a small pass. Measured:
/// benches/results/2026-11-29-gl-updates.md.
const MOST_COPIED: usize = 64 << 10;

/// The arguments that all forms of `TexSubImage` share. Offsets count from the border.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoxArguments {
    pub call: &'static str,
    pub dimensions: usize,
    pub target: u32,
    pub level: i32,
    pub offset: [i32; 3],
    pub size: [i32; 3],
}

/// Where a box lies in an existing image.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CheckedBox {
    pub target: ImageTarget,
    pub level: usize,
    pub format: super::internal_format::InternalFormat,
    pub origin: [usize; 3],
    pub size: [usize; 3],
}

impl Context {
    /// Checks a box against the image that it names.
    pub(crate) fn check_box(&mut self, arguments: &BoxArguments) -> Result<CheckedBox, Failure> {
        // Check the target, the level and the size.
        let target = ImageTarget::new(arguments.target, Some(arguments.dimensions))
            .filter(|t| !t.proxy)
            .ok_or((INVALID_ENUM, "target is not an image target of this call"))?;
        let level = usize::try_from(arguments.level)
            .ok()
            .filter(|&l| l < target.max_levels())
            .ok_or((INVALID_VALUE, "level is negative or larger than the target allows"))?;
        if arguments.size[..arguments.dimensions].iter().any(|&s| s < 0) {
            return Err((INVALID_VALUE, "a size is negative"));
        }

        // Check that the box lies inside the image.
        let texture = self.target_texture(target);
        let mut texture = lock(&texture);
        let image = texture
            .image(target.face, level)
            .ok_or((INVALID_OPERATION, "the level has no image"))?;
        let mut origin = [0; 3];
        let mut size = [1; 3];
        for i in 0..arguments.dimensions {
            let first = i64::from(arguments.offset[i]) + i64::from(image.border);
            let end = first + i64::from(arguments.size[i]);
            if first < 0 || end > i64::from(image.size[i]) {
                return Err((INVALID_VALUE, "the box is not inside the image"));
            }
            origin[i] = first as usize;
            size[i] = arguments.size[i] as usize;
        }
        Ok(CheckedBox { target, level, format: image.format, origin, size })
    }

    /// Checks a box, and pixels of `format` for it.
    fn check_sub_image(
        &mut self,
        arguments: &BoxArguments,
        format: Result<PixelFormat, Failure>,
    ) -> Result<CheckedBox, Failure> {
        let checked = self.check_box(arguments)?;
        formats_agree(format?, &checked.format).map(|()| checked)
    }

    /// Puts texels into a checked box.
    pub(crate) fn write_box(&mut self, checked: &CheckedBox, data: &TexelData) {
        if checked.size.contains(&0) {
            return;
        }

        // Find how much would be copied for draws that wait.
        let texture = self.target_texture(checked.target);
        let changed: usize = checked.size.iter().product::<usize>() * checked.format.texel_bytes();
        let copied = {
            let mut texture = lock(&texture);
            // Without the snapshot, texels that no draw waits for change in place.
            texture.touch();
            texture
                .image(checked.target.face, checked.level)
                .map_or(0, |image| image.copied_bytes())
        };
        if copied.saturating_sub(changed) > MOST_COPIED {
            // What waits has the old texels. To draw it costs less than to copy them all.
            self.flush_recorded();
        } else {
            self.image_came(copied);
        }
        if copied > 0 && !can_have(copied) {
            return self.record_error(
                OUT_OF_MEMORY,
                "glTexSubImage",
                "there is no memory for a copy of the texture",
            );
        }
        // A plane must not change under recorded draws.
        let in_plane = lock(&texture)
            .image(checked.target.face, checked.level)
            .is_some_and(|image| image.has_planes());
        if in_plane {
            self.flush_recorded();
        }

        // Write the texels.
        {
            let mut texture = lock(&texture);
            texture.touch();
            if let Some(image) = texture.image(checked.target.face, checked.level) {
                image.write(checked.origin, checked.size, data);
            }
        }
        self.image_changed(checked.target, checked.level);
    }

    fn tex_sub_image(&mut self, arguments: BoxArguments, format: u32, kind: u32, pixels: usize) {
        let pair = PixelFormat::new(format, kind);
        // What a list holds is checked when it is executed; nothing else is read for a call that is
        // an error.
        let good = self.lists.recording || self.check_sub_image(&arguments, pair).is_ok();
        let image = match (pair, plausible(arguments.size)) {
            (Ok(pair), Some(size)) if good => {
                self.read_image(pair, size, arguments.dimensions == 3, pixels)
            }
            _ => Ok(None),
        };
        let image = match image {
            Ok(image) => image,
            Err((error, why)) => return self.record_error(error, arguments.call, why),
        };
        if !self.lists.recording {
            return self.exec_tex_sub_image(&arguments, pair, image.map(Cow::Owned));
        }
        self.listable(move |c| {
            c.exec_tex_sub_image(&arguments, pair, image.as_ref().map(Cow::Borrowed))
        });
    }

    fn exec_tex_sub_image(
        &mut self,
        arguments: &BoxArguments,
        format: Result<PixelFormat, Failure>,
        image: Option<Cow<'_, ClientImage>>,
    ) {
        if !self.outside_begin(arguments.call) {
            return;
        }
        match (self.check_sub_image(arguments, format), image) {
            (Err((error, why)), _) => self.record_error(error, arguments.call, why),
            (Ok(_), None) => {}
            (Ok(checked), Some(image)) => {
                let data = texels::from_client(
                    &self.workers(),
                    image,
                    &checked.format,
                    &Transfer::new(&self.state.pixel),
                );
                self.write_box(&checked, &data);
            }
        }
    }

    /// `glTexSubImage1D`.
    pub fn tex_sub_image_1d(
        &mut self,
        target: u32,
        level: i32,
        xoffset: i32,
        width: i32,
        format: u32,
        type_: u32,
        pixels: usize,
    ) {
        let call = "glTexSubImage1D";
        let (offset, size) = ([xoffset, 0, 0], [width, 1, 1]);
        self.tex_sub_image(
            BoxArguments { call, dimensions: 1, target, level, offset, size },
            format,
            type_,
            pixels,
        );
    }

    /// `glTexSubImage2D`.
    pub fn tex_sub_image_2d(
        &mut self,
        target: u32,
        level: i32,
        xoffset: i32,
        yoffset: i32,
        width: i32,
        height: i32,
        format: u32,
        type_: u32,
        pixels: usize,
    ) {
        let call = "glTexSubImage2D";
        let (offset, size) = ([xoffset, yoffset, 0], [width, height, 1]);
        self.tex_sub_image(
            BoxArguments { call, dimensions: 2, target, level, offset, size },
            format,
            type_,
            pixels,
        );
    }

    /// `glTexSubImage3D`.
    pub fn tex_sub_image_3d(
        &mut self,
        target: u32,
        level: i32,
        xoffset: i32,
        yoffset: i32,
        zoffset: i32,
        width: i32,
        height: i32,
        depth: i32,
        format: u32,
        type_: u32,
        pixels: usize,
    ) {
        let call = "glTexSubImage3D";
        let (offset, size) = ([xoffset, yoffset, zoffset], [width, height, depth]);
        self.tex_sub_image(
            BoxArguments { call, dimensions: 3, target, level, offset, size },
            format,
            type_,
            pixels,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{BASE, context};
    use super::*;
    use crate::memory::ClientMemory;
    use crate::objects::Shared;
    use std::sync::Arc;

    #[test]
    fn boxes_must_lie_inside() {
        let mut c = context();
        let mut error = |x, width| {
            c.error = NO_ERROR;
            c.tex_sub_image_1d(TEXTURE_1D, 0, x, width, RGBA, UNSIGNED_BYTE, BASE);
            c.error
        };
        assert_eq!(error(0, 1), INVALID_OPERATION);
        c.tex_image_1d(TEXTURE_1D, 0, RGBA as i32, 6, 1, RGBA, UNSIGNED_BYTE, 0);
        let mut error = |x, width| {
            c.error = NO_ERROR;
            c.tex_sub_image_1d(TEXTURE_1D, 0, x, width, RGBA, UNSIGNED_BYTE, BASE);
            c.error
        };
        assert_eq!(error(-1, 6), NO_ERROR);
        assert_eq!(error(-2, 1), INVALID_VALUE);
        assert_eq!(error(0, 6), INVALID_VALUE);
        assert_eq!(error(0, -1), INVALID_VALUE);
        assert_eq!(error(i32::MAX, i32::MAX), INVALID_VALUE);
    }

    /// Memory that nobody may touch.
    #[derive(Debug)]
    struct Forbidden;

    impl ClientMemory for Forbidden {
        fn read(&self, _address: usize, _out: &mut [u8]) -> bool {
            panic!("the client's memory is read")
        }
        fn write(&self, _address: usize, _bytes: &[u8]) -> bool {
            panic!("the client's memory is written")
        }
        fn map(&self, _bytes: Vec<u8>) -> usize {
            0
        }
        fn unmap(&self, _address: usize) -> Option<Vec<u8>> {
            None
        }
    }

    #[test]
    fn wrong_calls_read_nothing() {
        let mut c = Context::new(Arc::new(Forbidden), Arc::new(Shared::default()));
        c.tex_image_2d(TEXTURE_2D, 0, RGBA as i32, 4, 4, 0, RGBA, UNSIGNED_BYTE, 0);
        let mut error = |target, level, size, format| {
            c.error = NO_ERROR;
            c.tex_sub_image_2d(target, level, 0, 0, size, size, format, UNSIGNED_BYTE, BASE);
            c.error
        };
        assert_eq!(error(TEXTURE_2D, 0, 100, RGBA), INVALID_VALUE);
        assert_eq!(error(TEXTURE_2D, 3, 4, RGBA), INVALID_OPERATION);
        assert_eq!(error(TEXTURE_2D, 0, 4, DEPTH_COMPONENT), INVALID_OPERATION);
        assert_eq!(error(PROXY_TEXTURE_2D, 0, 4, RGBA), INVALID_ENUM);
        c.error = NO_ERROR;
        c.begin(POINTS);
        c.tex_sub_image_2d(TEXTURE_2D, 0, 0, 0, 4, 4, RGBA, UNSIGNED_BYTE, BASE);
        c.tex_image_2d(TEXTURE_2D, 0, RGBA as i32, 4, 4, 0, RGBA, UNSIGNED_BYTE, BASE);
        c.draw_pixels(4, 4, RGBA, UNSIGNED_BYTE, BASE);
        c.end();
        assert_eq!(std::mem::take(&mut c.error), INVALID_OPERATION);
        c.bind_texture(TEXTURE_2D, 1);
        c.tex_storage_2d(TEXTURE_2D, 1, RGBA8, 4, 4);
        assert_eq!(c.error, NO_ERROR);
        c.tex_image_2d(TEXTURE_2D, 0, RGBA as i32, 4, 4, 0, RGBA, UNSIGNED_BYTE, BASE);
        assert_eq!(c.error, INVALID_OPERATION);
    }
}
