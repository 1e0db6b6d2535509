//! `CopyTexImage` and `CopyTexSubImage`: from the read framebuffer to a texture.

use super::Failure;
use super::attachments::Surfaces;
use super::image::lock;
use super::internal_format::InternalFormat;
use super::read_pixels::{Rectangle, inside, read_colors, read_depths, read_stencils, read_words};
use super::tex_image::ImageArguments;
use super::tex_sub_image::BoxArguments;
use super::texels::{self, TexelData};
use super::transfer::{Transfer, clamp_colors};
use crate::Context;
use crate::enums::*;

/// Whether the framebuffer has what a texture of that format holds.
fn has_source(surfaces: &Surfaces, format: &InternalFormat) -> bool {
    if format.has_depth() {
        surfaces.depth.is_some() && (!format.has_stencil() || surfaces.stencil.is_some())
    } else {
        surfaces.color.is_some()
    }
}

impl Context {
    /// Texels of a rectangle of the framebuffer that lies inside it.
    fn copy_texels(
        &self,
        surfaces: &Surfaces,
        format: &InternalFormat,
        r: &Rectangle,
    ) -> Option<TexelData> {
        let transfer = Transfer::new(&self.state.pixel);

        // Read depths, and stencil values if the format has them.
        if format.has_depth() {
            let mut depths = read_depths(
                &self.workers(),
                &mut lock(surfaces.depth.as_ref()?.depth.as_ref()?),
                r,
            );
            transfer.depths(&mut depths);
            texels::round_depths(&mut depths, format);
            let stencils = match &surfaces.stencil {
                Some(s) if format.has_stencil() => {
                    let values = read_stencils(&lock(s.stencil.as_ref()?), r);
                    Some(
                        values
                            .into_iter()
                            .map(|v| (transfer.stencil(i64::from(v)) & 255) as u8)
                            .collect(),
                    )
                }
                _ => None,
            };
            return Some(TexelData::Depths(depths, stencils));
        }

        // Copy colours as words if neither transfer nor format changes them.
        let surface = surfaces.color.as_ref()?;
        let plane = lock(surface.color.as_ref()?);
        if transfer.keeps_colors()
            && let Some(words) = read_words(&plane, &surface.format, r)
        {
            return Some(texels::from_words(words, format));
        }

        // Otherwise convert colours through floats.
        let mut colors = read_colors(&self.workers(), &plane, &surface.format, r);
        transfer.colors(&mut colors);
        if surface.format.component_type() != FLOAT || format.component_type() != FLOAT {
            clamp_colors(&mut colors);
        }
        Some(texels::from_colors(colors, format))
    }

    fn copy_tex_image(&mut self, arguments: ImageArguments, x: i32, y: i32) {
        self.listable(move |c| {
            if c.outside_begin(arguments.call)
                && let Err((error, why)) = c.exec_copy_tex_image(&arguments, x, y)
            {
                c.record_error(error, arguments.call, why);
            }
        });
    }

    fn exec_copy_tex_image(
        &mut self,
        arguments: &ImageArguments,
        x: i32,
        y: i32,
    ) -> Result<(), Failure> {
        // Check the arguments.
        if InternalFormat::of_texture(arguments.internal).is_none()
            || (1..=4).contains(&arguments.internal)
        {
            return Err((INVALID_ENUM, "internalformat is not an internal format of this call"));
        }
        let checked = arguments.check()?;
        if checked.target.proxy {
            return Err((INVALID_ENUM, "a proxy has no texels"));
        }
        self.may_get_image(checked.target)?;

        // Check the read framebuffer.
        let [width, height, _] = checked.size.map(u32::cast_signed);
        let area = Some([x, y, width, height]);
        let Some(surfaces) = self.read_surfaces(arguments.call, true, area) else { return Ok(()) };
        if !has_source(&surfaces, &checked.format) {
            return Err((INVALID_OPERATION, "the read framebuffer has no such buffer"));
        }

        // Store the texels at once if all lie inside the framebuffer.
        let size = checked.size.map(|s| s as usize);
        let r = inside(&surfaces, x, y, size[0] as i32, size[1] as i32);
        if r.size == size[..2] {
            let data = self.copy_texels(&surfaces, &checked.format, &r);
            self.store_image(arguments.call, &checked, data);
            return Ok(());
        }
        // Texels from outside the framebuffer are undefined.
        let data = self.copy_texels(&surfaces, &checked.format, &r);
        self.store_image(arguments.call, &checked, None);
        let target = self.target_texture(checked.target);
        if let (Some(data), false) = (data, r.size.contains(&0)) {
            let mut target = lock(&target);
            target.touch();
            if let Some(image) = target.image(checked.target.face, checked.level) {
                image.write([r.skip[0], r.skip[1], 0], [r.size[0], r.size[1], 1], &data);
            }
        }
        self.image_changed(checked.target, checked.level);
        Ok(())
    }

    fn copy_tex_sub_image(&mut self, arguments: BoxArguments, x: i32, y: i32) {
        self.listable(move |c| {
            if c.outside_begin(arguments.call)
                && let Err((error, why)) = c.exec_copy_tex_sub_image(&arguments, x, y)
            {
                c.record_error(error, arguments.call, why);
            }
        });
    }

    fn exec_copy_tex_sub_image(
        &mut self,
        arguments: &BoxArguments,
        x: i32,
        y: i32,
    ) -> Result<(), Failure> {
        let mut checked = self.check_box(arguments)?;
        let area = Some([x, y, checked.size[0] as i32, checked.size[1] as i32]);
        let Some(surfaces) = self.read_surfaces(arguments.call, true, area) else { return Ok(()) };
        if !has_source(&surfaces, &checked.format) {
            return Err((INVALID_OPERATION, "the read framebuffer has no such buffer"));
        }
        let r = inside(&surfaces, x, y, checked.size[0] as i32, checked.size[1] as i32);
        if let Some(data) = self.copy_texels(&surfaces, &checked.format, &r) {
            for i in 0..2 {
                checked.origin[i] += r.skip[i];
                checked.size[i] = r.size[i];
            }
            self.write_box(&checked, &data);
        }
        Ok(())
    }

    /// `glCopyTexImage1D`.
    pub fn copy_tex_image_1d(
        &mut self,
        target: u32,
        level: i32,
        internalformat: u32,
        x: i32,
        y: i32,
        width: i32,
        border: i32,
    ) {
        let (call, internal, size) = ("glCopyTexImage1D", internalformat, [width, 1, 1]);
        self.copy_tex_image(
            ImageArguments { call, dimensions: 1, target, level, internal, size, border },
            x,
            y,
        );
    }

    /// `glCopyTexImage2D`.
    pub fn copy_tex_image_2d(
        &mut self,
        target: u32,
        level: i32,
        internalformat: u32,
        x: i32,
        y: i32,
        width: i32,
        height: i32,
        border: i32,
    ) {
        let (call, internal, size) = ("glCopyTexImage2D", internalformat, [width, height, 1]);
        self.copy_tex_image(
            ImageArguments { call, dimensions: 2, target, level, internal, size, border },
            x,
            y,
        );
    }

    /// `glCopyTexSubImage1D`.
    pub fn copy_tex_sub_image_1d(
        &mut self,
        target: u32,
        level: i32,
        xoffset: i32,
        x: i32,
        y: i32,
        width: i32,
    ) {
        let (call, offset, size) = ("glCopyTexSubImage1D", [xoffset, 0, 0], [width, 1, 1]);
        self.copy_tex_sub_image(
            BoxArguments { call, dimensions: 1, target, level, offset, size },
            x,
            y,
        );
    }

    /// `glCopyTexSubImage2D`.
    pub fn copy_tex_sub_image_2d(
        &mut self,
        target: u32,
        level: i32,
        xoffset: i32,
        yoffset: i32,
        x: i32,
        y: i32,
        width: i32,
        height: i32,
    ) {
        let (call, offset, size) =
            ("glCopyTexSubImage2D", [xoffset, yoffset, 0], [width, height, 1]);
        self.copy_tex_sub_image(
            BoxArguments { call, dimensions: 2, target, level, offset, size },
            x,
            y,
        );
    }

    /// `glCopyTexSubImage3D`.
    pub fn copy_tex_sub_image_3d(
        &mut self,
        target: u32,
        level: i32,
        xoffset: i32,
        yoffset: i32,
        zoffset: i32,
        x: i32,
        y: i32,
        width: i32,
        height: i32,
    ) {
        let (call, offset, size) =
            ("glCopyTexSubImage3D", [xoffset, yoffset, zoffset], [width, height, 1]);
        self.copy_tex_sub_image(
            BoxArguments { call, dimensions: 3, target, level, offset, size },
            x,
            y,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{BASE, context_with, get};
    use super::*;
    use vitral_raster::forward::ColorPlane;

    #[test]
    fn colours_reach_the_texture() {
        let mut c = context_with(2, 2);
        assert!(c.draw_target(None).is_some());
        if let ColorPlane::Rgba8(plane) = &mut *lock(&c.draw_color().unwrap().0) {
            plane.write_row(0, 1, &[0x0403_0201, 0x0807_0605]);
        }
        c.copy_tex_image_2d(TEXTURE_2D, 0, RGB, 0, 1, 2, 1, 0);
        c.client.pack.alignment = 1;
        c.get_tex_image(TEXTURE_2D, 0, RGB, UNSIGNED_BYTE, BASE);
        assert_eq!(get(&c, BASE), [1, 2, 3, 5, 6, 7]);
        // Partly from outside: only the inside is copied.
        c.copy_tex_sub_image_2d(TEXTURE_2D, 0, 0, 0, 1, 1, 2, 1);
        c.get_tex_image(TEXTURE_2D, 0, RGB, UNSIGNED_BYTE, BASE);
        assert_eq!(get(&c, BASE), [5, 6, 7, 5, 6, 7]);
        assert_eq!(c.error, NO_ERROR);
        c.copy_tex_image_2d(TEXTURE_2D, 0, 3, 0, 1, 2, 1, 0);
        assert_eq!(c.error, INVALID_ENUM);
    }

    #[test]
    fn depths_reach_the_texture() {
        let mut c = context_with(2, 2);
        c.copy_tex_image_1d(TEXTURE_1D, 0, DEPTH_COMPONENT16, 0, 0, 2, 0);
        c.get_tex_image(TEXTURE_1D, 0, DEPTH_COMPONENT, UNSIGNED_SHORT, BASE);
        assert_eq!(get(&c, BASE), [255; 4]);
        assert_eq!(c.error, NO_ERROR);
    }
}
