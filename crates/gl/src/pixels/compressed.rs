//! Compressed images: S3TC in two dimensions.

use super::Failure;
use super::image::lock;
use super::s3tc::{self, Blocks, SIDE};
use super::tex_image::ImageArguments;
use super::tex_sub_image::{BoxArguments, CheckedBox};
use super::texels::TexelData;
use crate::Context;
use crate::enums::*;
use crate::memory::can_have;
use crate::vertices::client_bytes;
use std::sync::Arc;

/// What is wrong with a format here.
const NOT_COMPRESSED: Failure = (INVALID_ENUM, "the format is not a supported compressed format");

/// Checks the number of bytes that a call gives for an image.
fn check_bytes(token: u32, size: [i32; 3], bytes: i32) -> Result<(), Failure> {
    let size = [size[0], size[1]].map(|side| usize::try_from(side).unwrap_or(0));
    let good = usize::try_from(bytes).is_ok_and(|bytes| bytes == s3tc::image_bytes(token, size));
    if good { Ok(()) } else { Err((INVALID_VALUE, "imageSize is not that of the format and size")) }
}

impl Context {
    /// The blocks that a call gives; `None` without an address.
    fn read_blocks(&self, bytes: i32, data: usize) -> Result<Option<Vec<u8>>, Failure> {
        let bytes = usize::try_from(bytes).map_err(|_| (INVALID_VALUE, "imageSize is negative"))?;
        if data == 0 && self.client.unpack.buffer.is_none() {
            return Ok(None);
        }
        if !can_have(8 * bytes) {
            return Err((OUT_OF_MEMORY, "there is no memory for the image"));
        }
        let (memory, address) = self.unpack_memory(data, 1)?;
        match client_bytes(&*memory, address, bytes) {
            None if !self.client.unpack.buffer.is_none() => {
                Err((INVALID_OPERATION, "the buffer does not hold so many bytes"))
            }
            blocks => Ok(blocks),
        }
    }

    /// Reads the blocks of a call at once, and runs it or keeps it in the display list.
    fn compressed(
        &mut self,
        call: &'static str,
        (format, bytes, data): (u32, i32, usize),
        check: impl FnOnce(&mut Self) -> Result<(), Failure>,
        work: impl Fn(&mut Self, Option<&[u8]>) -> Result<(), Failure> + Send + Sync + 'static,
    ) {
        if !self.lists.recording && !self.outside_begin(call) {
            return;
        }
        let known = if s3tc::is_compressed(format) { Ok(()) } else { Err(NOT_COMPRESSED) };
        // What a list holds is checked when it is executed; nothing is read for a call that is an
        // error.
        let checked = if self.lists.recording { known } else { known.and_then(|()| check(self)) };
        let blocks = match checked.and_then(|()| self.read_blocks(bytes, data)) {
            Ok(blocks) => blocks,
            Err((error, why)) => return self.listable(move |c| c.record_error(error, call, why)),
        };
        self.listable(move |c| {
            if c.outside_begin(call)
                && let Err((error, why)) = work(c, blocks.as_deref())
            {
                c.record_error(error, call, why);
            }
        });
    }

    fn check_compressed_image(
        &mut self,
        arguments: &ImageArguments,
        bytes: i32,
    ) -> Result<(), Failure> {
        let checked =
            ImageArguments { internal: s3tc::base(arguments.internal), ..*arguments }.check()?;
        if arguments.border != 0 {
            return Err((INVALID_OPERATION, "compressed images have no borders"));
        }
        check_bytes(arguments.internal, arguments.size, bytes)?;
        self.may_get_image(checked.target)
    }

    fn exec_compressed_image(
        &mut self,
        arguments: &ImageArguments,
        bytes: i32,
        blocks: Option<&[u8]>,
    ) -> Result<(), Failure> {
        self.check_compressed_image(arguments, bytes)?;
        let token = arguments.internal;
        let checked = ImageArguments { internal: s3tc::base(token), ..*arguments }.check()?;
        if checked.target.proxy {
            self.set_proxy_image(&checked);
            return Ok(());
        }
        let size = [checked.size[0] as usize, checked.size[1] as usize];
        let data = blocks.map(|blocks| TexelData::Words(s3tc::decode(token, size, blocks)));
        self.store_image(arguments.call, &checked, data);
        let zero = || vec![0; s3tc::image_bytes(token, size)];
        self.keep_blocks(
            &checked.target,
            checked.level,
            token,
            blocks.map_or_else(zero, <[u8]>::to_vec),
        );
        Ok(())
    }

    /// Keeps an image's blocks beside its texels.
    fn keep_blocks(
        &mut self,
        target: &super::texture::ImageTarget,
        level: usize,
        token: u32,
        bytes: Vec<u8>,
    ) {
        let texture = self.target_texture(*target);
        if let Some(image) = lock(&texture).image(target.face, level) {
            image.blocks = Some(Blocks { token, bytes: Arc::new(bytes) });
        }
    }

    fn check_compressed_box(
        &mut self,
        arguments: &BoxArguments,
        format: u32,
        bytes: i32,
    ) -> Result<(CheckedBox, Blocks), Failure> {
        let checked = self.check_box(arguments)?;
        let texture = self.target_texture(checked.target);
        let mut texture = lock(&texture);
        let image = texture.image(checked.target.face, checked.level);
        let (size, blocks) =
            image.map_or(([0; 3], None), |image| (image.full(), image.blocks.clone()));
        let blocks = blocks
            .filter(|blocks| blocks.token == format)
            .ok_or((INVALID_OPERATION, "the image is not compressed in this format"))?;
        let whole = |k: usize| {
            let end = checked.origin[k] + checked.size[k];
            checked.origin[k].is_multiple_of(SIDE) && (end.is_multiple_of(SIDE) || end == size[k])
        };
        if !whole(0) || !whole(1) {
            return Err((INVALID_OPERATION, "the box does not consist of whole blocks"));
        }
        check_bytes(format, arguments.size, bytes)?;
        Ok((checked, blocks))
    }

    fn exec_compressed_box(
        &mut self,
        arguments: &BoxArguments,
        format: u32,
        bytes: i32,
        new: Option<&[u8]>,
    ) -> Result<(), Failure> {
        let (checked, mut blocks) = self.check_compressed_box(arguments, format, bytes)?;
        let Some(new) = new.filter(|_| !checked.size.contains(&0)) else { return Ok(()) };
        let texture = self.target_texture(checked.target);
        let width = lock(&texture)
            .image(checked.target.face, checked.level)
            .map_or(0, |image| image.full()[0]);

        // Put the texels into the image and the blocks among its blocks.
        let data = TexelData::Words(s3tc::decode(format, [checked.size[0], checked.size[1]], new));
        self.write_box(&checked, &data);
        let block = s3tc::block_bytes(format);
        let (row, new_row) = (width.div_ceil(SIDE) * block, checked.size[0].div_ceil(SIDE) * block);
        let all = Arc::make_mut(&mut blocks.bytes);
        for (y, from) in new.chunks_exact(new_row).enumerate() {
            let start = (checked.origin[1] / SIDE + y) * row + checked.origin[0] / SIDE * block;
            all[start..start + new_row].copy_from_slice(from);
        }
        if let Some(image) = lock(&texture).image(checked.target.face, checked.level) {
            image.blocks = Some(blocks);
        }
        Ok(())
    }

    /// Forms of S3TC in one and three dimensions do not exist.
    fn no_compressed(&mut self, call: &'static str, size: i32) {
        self.listable(move |c| {
            if !c.outside_begin(call) {
                return;
            }
            let (error, why) =
                if size < 0 { (INVALID_VALUE, "imageSize is negative") } else { NOT_COMPRESSED };
            c.record_error(error, call, why);
        });
    }

    /// `glCompressedTexImage1D`.
    pub fn compressed_tex_image_1d(
        &mut self,
        _target: u32,
        _level: i32,
        _internalformat: u32,
        _width: i32,
        _border: i32,
        image_size: i32,
        _data: usize,
    ) {
        self.no_compressed("glCompressedTexImage1D", image_size);
    }

    /// `glCompressedTexImage2D`.
    pub fn compressed_tex_image_2d(
        &mut self,
        target: u32,
        level: i32,
        internalformat: u32,
        width: i32,
        height: i32,
        border: i32,
        image_size: i32,
        data: usize,
    ) {
        let call = "glCompressedTexImage2D";
        let size = [width, height, 1];
        let arguments = ImageArguments {
            call,
            dimensions: 2,
            target,
            level,
            internal: internalformat,
            size,
            border,
        };
        self.compressed(
            call,
            (internalformat, image_size, data),
            |c| c.check_compressed_image(&arguments, image_size),
            move |c, blocks| c.exec_compressed_image(&arguments, image_size, blocks),
        );
    }

    /// `glCompressedTexImage3D`.
    pub fn compressed_tex_image_3d(
        &mut self,
        _target: u32,
        _level: i32,
        _internalformat: u32,
        _width: i32,
        _height: i32,
        _depth: i32,
        _border: i32,
        image_size: i32,
        _data: usize,
    ) {
        self.no_compressed("glCompressedTexImage3D", image_size);
    }

    /// `glCompressedTexSubImage1D`.
    pub fn compressed_tex_sub_image_1d(
        &mut self,
        _target: u32,
        _level: i32,
        _xoffset: i32,
        _width: i32,
        _format: u32,
        image_size: i32,
        _data: usize,
    ) {
        self.no_compressed("glCompressedTexSubImage1D", image_size);
    }

    /// `glCompressedTexSubImage2D`.
    pub fn compressed_tex_sub_image_2d(
        &mut self,
        target: u32,
        level: i32,
        xoffset: i32,
        yoffset: i32,
        width: i32,
        height: i32,
        format: u32,
        image_size: i32,
        data: usize,
    ) {
        let call = "glCompressedTexSubImage2D";
        let (offset, size) = ([xoffset, yoffset, 0], [width, height, 1]);
        let arguments = BoxArguments { call, dimensions: 2, target, level, offset, size };
        self.compressed(
            call,
            (format, image_size, data),
            |c| c.check_compressed_box(&arguments, format, image_size).map(drop),
            move |c, blocks| c.exec_compressed_box(&arguments, format, image_size, blocks),
        );
    }

    /// `glCompressedTexSubImage3D`.
    pub fn compressed_tex_sub_image_3d(
        &mut self,
        _target: u32,
        _level: i32,
        _xoffset: i32,
        _yoffset: i32,
        _zoffset: i32,
        _width: i32,
        _height: i32,
        _depth: i32,
        _format: u32,
        image_size: i32,
        _data: usize,
    ) {
        self.no_compressed("glCompressedTexSubImage3D", image_size);
    }

    /// `glGetCompressedTexImage`.
    pub fn get_compressed_tex_image(&mut self, target: u32, level: i32, img: usize) {
        const CALL: &str = "glGetCompressedTexImage";
        if !self.outside_begin(CALL) {
            return;
        }
        let result = self.query_target(target, level, false).and_then(|(target, level)| {
            let texture = self.target_texture(target);
            let blocks =
                lock(&texture).image(target.face, level).and_then(|image| image.blocks.clone());
            let blocks = blocks.ok_or((INVALID_OPERATION, "the image is not compressed"))?;
            if img == 0 && self.client.pack.buffer.is_none() {
                return Ok(());
            }
            self.pack_into(img, 1, |memory, address| memory.write(address, &blocks.bytes))
        });
        if let Err((error, why)) = result {
            self.record_error(error, CALL, why);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{BASE, context, get, put, read_u32};
    use super::*;

    /// Four blocks of one colour each: red, green, blue, white.
    const BLOCKS: [[u8; 8]; 4] = [
        [0, 0xf8, 0, 0, 0, 0, 0, 0],
        [0xe0, 7, 0, 0, 0, 0, 0, 0],
        [0x1f, 0, 0, 0, 0, 0, 0, 0],
        [0xff, 0xff, 0, 0, 0, 0, 0, 0],
    ];

    fn texel(c: &mut Context, at: usize) -> [u8; 4] {
        c.get_tex_image(TEXTURE_2D, 0, RGBA, UNSIGNED_BYTE, BASE + 1024);
        get(c, BASE + 1024 + 4 * at)
    }

    #[test]
    fn blocks_become_texels_and_come_back() {
        let mut c = context();
        put(&c, BASE, &BLOCKS.concat());
        let format = COMPRESSED_RGB_S3TC_DXT1_EXT;
        c.compressed_tex_image_2d(TEXTURE_2D, 0, format, 8, 6, 0, 32, BASE);
        assert_eq!(
            [0, 7, 40, 47].map(|at| texel(&mut c, at)),
            [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 255, 255]]
        );
        let mut level = |pname| {
            c.get_tex_level_parameteriv(TEXTURE_2D, 0, pname, BASE + 512);
            read_u32(&c, BASE + 512)
        };
        let asked = [TEXTURE_COMPRESSED, TEXTURE_COMPRESSED_IMAGE_SIZE, TEXTURE_INTERNAL_FORMAT];
        assert_eq!(asked.map(&mut level), [1, 32, format]);

        // The upper left block becomes that of the lower right one.
        c.compressed_tex_sub_image_2d(TEXTURE_2D, 0, 0, 4, 4, 2, format, 8, BASE + 24);
        assert_eq!(texel(&mut c, 40), [255; 4]);
        c.get_compressed_tex_image(TEXTURE_2D, 0, BASE + 64);
        assert_eq!(
            get::<32>(&c, BASE + 64),
            *[BLOCKS[0], BLOCKS[1], BLOCKS[3], BLOCKS[3]].concat()
        );
        assert_eq!(c.error, NO_ERROR);

        // Other texels end the compression.
        c.tex_sub_image_2d(TEXTURE_2D, 0, 0, 0, 1, 1, RGBA, UNSIGNED_BYTE, BASE);
        c.get_compressed_tex_image(TEXTURE_2D, 0, BASE + 64);
        assert_eq!(c.error, INVALID_OPERATION);
    }

    #[test]
    fn wrong_blocks_are_refused() {
        let mut c = context();
        let format = COMPRESSED_RGBA_S3TC_DXT5_EXT;
        let mut image = |format, width, border, bytes| {
            c.error = NO_ERROR;
            c.compressed_tex_image_2d(TEXTURE_2D, 0, format, width, 4, border, bytes, BASE);
            c.error
        };
        assert_eq!(image(RGBA, 4, 0, 16), INVALID_ENUM);
        assert_eq!(image(format, 4, 0, 15), INVALID_VALUE);
        assert_eq!(image(format, 4, 0, -16), INVALID_VALUE);
        assert_eq!(image(format, 4, 1, 16), INVALID_OPERATION);
        assert_eq!(image(format, 9, 0, 48), NO_ERROR);
        let mut part = |x, width, format, bytes| {
            c.error = NO_ERROR;
            c.compressed_tex_sub_image_2d(TEXTURE_2D, 0, x, 0, width, 4, format, bytes, BASE);
            c.error
        };
        assert_eq!(part(8, 1, format, 16), NO_ERROR);
        assert_eq!(part(4, 3, format, 16), INVALID_OPERATION);
        assert_eq!(part(2, 4, format, 16), INVALID_OPERATION);
        assert_eq!(part(0, 4, COMPRESSED_RGBA_S3TC_DXT3_EXT, 16), INVALID_OPERATION);
        c.error = NO_ERROR;
        c.compressed_tex_image_1d(TEXTURE_1D, 0, format, 4, 0, 16, BASE);
        assert_eq!(c.error, INVALID_ENUM);
    }

    #[test]
    fn a_list_keeps_blocks() {
        let mut c = context();
        put(&c, BASE, &BLOCKS[2]);
        c.new_list(1, COMPILE);
        c.compressed_tex_image_2d(TEXTURE_2D, 0, COMPRESSED_RGBA_S3TC_DXT1_EXT, 1, 1, 0, 8, BASE);
        c.end_list();
        put(&c, BASE, &[0; 8]);
        c.call_list(1);
        assert_eq!((texel(&mut c, 0), c.error), ([0, 0, 255, 255], NO_ERROR));
        // Whoever gives texels gets them uncompressed.
        c.tex_image_2d(
            TEXTURE_2D,
            0,
            COMPRESSED_RGBA_S3TC_DXT5_EXT as i32,
            1,
            1,
            0,
            RGBA,
            UNSIGNED_BYTE,
            BASE,
        );
        c.get_tex_level_parameteriv(TEXTURE_2D, 0, TEXTURE_COMPRESSED, BASE + 512);
        assert_eq!((read_u32(&c, BASE + 512), c.error), (0, NO_ERROR));
    }
}
