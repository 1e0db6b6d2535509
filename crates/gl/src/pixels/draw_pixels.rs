//! `DrawPixels` and `CopyPixels`: recorded images at the raster position.

use super::Failure;
use super::decode;
use super::format::{Content, PixelFormat};
use super::image::lock;
use super::read_pixels::{has_content, inside, read_colors, read_depths, read_stencils};
use super::store::{ClientImage, drawable};
use super::transfer::{Transfer, clamp_colors, clamp_unit};
use crate::Context;
use crate::enums::*;
use std::borrow::Cow;
use std::sync::Arc;
use vitral_raster::forward::{
    Clamping, Command, Compare, DepthTest, FragmentState, ImageColors, ImageFragments,
};

/// What a pixel rectangle brings.
#[derive(Default)]
struct Pixels {
    colors: Option<ImageColors>,
    depths: Option<Vec<f32>>,
    stencils: Option<Vec<u8>>,
}

impl Context {
    /// Fragments of `size` source pixels at `origin` that take everything from the raster position.
    pub(crate) fn raster_fragments(
        &self,
        origin: [f32; 2],
        zoom: [f32; 2],
        size: [usize; 2],
    ) -> ImageFragments {
        let raster = &self.state.raster_position;
        ImageFragments {
            origin,
            zoom,
            size: size.map(|s| s as u32),
            z: raster.window[2],
            colors: None,
            depths: None,
            stencils: None,
            bits: None,
            color: raster.color,
            secondary: raster.secondary,
            tex: raster.tex,
            fog: raster.distance,
            stencil_mask: (self.state.stencil.faces[0].write_mask & 255) as u8,
        }
    }

    /// Records a rectangle at the raster position, `skip` source pixels away from its corner.
    fn record_pixels(&mut self, mut pixels: Pixels, skip: [usize; 2], size: [usize; 2]) {
        // Account for the memory of the image.
        let bytes = if matches!(pixels.colors, Some(ImageColors::Words(_))) { 4 } else { 16 };
        self.image_came(bytes * size[0] * size[1]);

        // Place the rectangle by raster position and zoom.
        let zoom = self.state.pixel_mode.zoom;
        let raster = self.state.raster_position.window;
        let origin = std::array::from_fn(|i| raster[i] + skip[i] as f32 * zoom[i]);
        let clamped = self.clamping() != Clamping::None;
        if let Some(ImageColors::Floats(colors)) = pixels.colors.as_mut().filter(|_| clamped) {
            clamp_colors(colors);
        }
        let fragments = self.raster_fragments(origin, zoom, size);

        // Write stencil values without other operations.
        if let Some(stencils) = pixels.stencils {
            let state = self.fragment_state(true);
            let image = ImageFragments { stencils: Some(stencils), ..fragments.clone() };
            self.record(Command::Image(Arc::new(image), state));
            // Depths that come with stencil values are written through the depth mask and nothing
            // else.
            if let Some(depths) = pixels.depths.filter(|_| self.state.depth.write) {
                let state = self.fragment_state(true);
                let plain = FragmentState {
                    depth: Some(DepthTest { func: Compare::Always, write: true }),
                    masked: [true; 4],
                    clip: state.clip,
                    ..FragmentState::default()
                };
                let image = ImageFragments { depths: Some(depths), ..fragments };
                self.record(Command::Image(Arc::new(image), Arc::new(plain)));
            }
            return;
        }

        // Draw colours and depths as fragments.
        let state = self.fragment_state(true);
        let image = ImageFragments { colors: pixels.colors, depths: pixels.depths, ..fragments };
        self.record(Command::Image(Arc::new(image), state));
    }

    /// Whether something is drawn at the raster position; in feedback and selection mode, notes
    /// `token` instead.
    pub(crate) fn raster_draws(&mut self, token: u32) -> bool {
        if !self.state.raster_position.valid {
            return false;
        }
        if !self.renders() {
            self.feedback_image(token);
            return false;
        }
        true
    }

    /// `glDrawPixels`.
    pub fn draw_pixels(&mut self, width: i32, height: i32, format: u32, type_: u32, pixels: usize) {
        let pair = PixelFormat::new(format, type_);
        let image = match pair {
            Ok(pair) => drawable([width, height])
                .map_or(Ok(None), |size| self.read_image(pair, size, false, pixels)),
            Err(_) => Ok(None),
        };
        let image = match image {
            Ok(image) => image.map(Arc::new),
            Err((error, why)) => return self.record_error(error, "glDrawPixels", why),
        };
        self.listable(move |c| c.exec_draw_pixels([width, height], pair, image.as_deref()));
    }

    fn exec_draw_pixels(
        &mut self,
        size: [i32; 2],
        format: Result<PixelFormat, Failure>,
        image: Option<&ClientImage>,
    ) {
        const CALL: &str = "glDrawPixels";
        if !self.outside_begin(CALL) {
            return;
        }

        // Check the size and the format.
        if size.iter().any(|&s| s < 0) {
            return self.record_error(INVALID_VALUE, CALL, "a size is negative");
        }
        if drawable(size).is_none() {
            return self.record_error(OUT_OF_MEMORY, CALL, "the image is too large");
        }
        let format = match format {
            Ok(format) => format,
            Err((error, why)) => return self.record_error(error, CALL, why),
        };

        // Check the framebuffer.
        if !self.draw_framebuffer_complete(CALL) {
            return;
        }
        let content = format.content();
        if !matches!(content, Content::Color | Content::Index)
            && !has_content(&self.draw_surfaces(), content)
        {
            return self.record_error(
                INVALID_OPERATION,
                CALL,
                "the draw framebuffer has no such buffer",
            );
        }
        if !self.raster_draws(DRAW_PIXEL_TOKEN) {
            return;
        }

        // Decode the pixels with transfer.
        let Some(image) = image.filter(|i| !i.size.contains(&0)) else { return };
        let transfer = Transfer::new(&self.state.pixel);
        let mut pixels = Pixels::default();
        match content {
            Content::Color | Content::Index => {
                // Five and six bits are more than bytes hold of them.
                let bytes = transfer.keeps_colors() && image.format.kind != UNSIGNED_SHORT_5_6_5;
                let words = bytes.then(|| decode::words(Cow::Borrowed(image)).ok()).flatten();
                let floats =
                    || ImageColors::Floats(decode::colors(&self.workers(), image, &transfer));
                pixels.colors = Some(words.map_or_else(floats, ImageColors::Words));
            }
            Content::Depth => pixels.depths = Some(decode::depths(image, &transfer, true)),
            Content::Stencil => pixels.stencils = Some(decode::stencils(image, &transfer)),
            Content::DepthStencil => {
                pixels.depths = Some(decode::depths(image, &transfer, true));
                pixels.stencils = Some(decode::stencils(image, &transfer));
            }
        }

        // Record them.
        self.record_pixels(pixels, [0, 0], [image.size[0], image.size[1]]);
    }

    /// `glCopyPixels`.
    pub fn copy_pixels(&mut self, x: i32, y: i32, width: i32, height: i32, type_: u32) {
        self.listable(move |c| c.exec_copy_pixels(x, y, width, height, type_));
    }

    fn exec_copy_pixels(&mut self, x: i32, y: i32, width: i32, height: i32, kind: u32) {
        const CALL: &str = "glCopyPixels";
        if !self.outside_begin(CALL) {
            return;
        }

        // Check the size and the kind of values.
        if width < 0 || height < 0 {
            return self.record_error(INVALID_VALUE, CALL, "a size is negative");
        }
        let content = match kind {
            COLOR => Content::Color,
            DEPTH => Content::Depth,
            STENCIL => Content::Stencil,
            DEPTH_STENCIL => Content::DepthStencil,
            _ => {
                return self.record_error(
                    INVALID_ENUM,
                    CALL,
                    "type is not COLOR, DEPTH, STENCIL or DEPTH_STENCIL",
                );
            }
        };

        // Check both framebuffers.
        if !self.draw_framebuffer_complete(CALL) {
            return;
        }
        let read = self.surfaces_of(self.framebuffers.read, false);
        let to = self.draw_surfaces();
        let missing = |s| s == FRAMEBUFFER_COMPLETE && !has_content(&read, content);
        if missing(read.status) || (content != Content::Color && !has_content(&to, content)) {
            return self.record_error(INVALID_OPERATION, CALL, "a framebuffer has no such buffer");
        }

        // Feed back or select instead of drawing.
        if !self.renders() {
            self.raster_draws(COPY_PIXEL_TOKEN);
            return;
        }

        // Read the rectangle's part inside the framebuffer.
        let Some(from) = self.read_surfaces(CALL, true, Some([x, y, width, height])) else {
            return;
        };
        let r = inside(&from, x, y, width, height);
        if !self.raster_draws(COPY_PIXEL_TOKEN) || r.size.contains(&0) {
            return;
        }

        // Read the values and apply pixel transfer.
        let transfer = Transfer::new(&self.state.pixel);
        let mut pixels = Pixels::default();
        if let (Content::Color, Some(s)) = (content, &from.color)
            && let Some(plane) = &s.color
        {
            let mut colors = read_colors(&self.workers(), &lock(plane), &s.format, &r);
            transfer.colors(&mut colors);
            pixels.colors = Some(ImageColors::Floats(colors));
        }
        if let (Content::Depth | Content::DepthStencil, Some(s)) = (content, &from.depth)
            && let Some(plane) = &s.depth
        {
            let mut depths = read_depths(&self.workers(), &mut lock(plane), &r);
            transfer.depths(&mut depths);
            depths.iter_mut().for_each(|d| *d = clamp_unit(*d));
            pixels.depths = Some(depths);
        }
        if let (Content::Stencil | Content::DepthStencil, Some(s)) = (content, &from.stencil)
            && let Some(plane) = &s.stencil
        {
            let values = read_stencils(&lock(plane), &r);
            pixels.stencils = Some(
                values.into_iter().map(|v| (transfer.stencil(i64::from(v)) & 255) as u8).collect(),
            );
        }

        // Record them.
        self.record_pixels(pixels, r.skip, r.size);
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{BASE, context_with};
    use super::*;

    #[test]
    fn mistakes_are_told() {
        let mut c = context_with(4, 4);
        let mut error = |width, format, kind| {
            c.error = NO_ERROR;
            c.draw_pixels(width, 1, format, kind, BASE);
            c.error
        };
        assert_eq!(error(-1, RGBA, UNSIGNED_BYTE), INVALID_VALUE);
        assert_eq!(error(1, RGBA, BITMAP), INVALID_ENUM);
        assert_eq!(error(1, RGB, UNSIGNED_SHORT_4_4_4_4), INVALID_OPERATION);
        assert_eq!(error(1, STENCIL_INDEX, UNSIGNED_BYTE), NO_ERROR);
        c.copy_pixels(0, 0, 1, 1, RGBA);
        assert_eq!(c.error, INVALID_ENUM);
        c.error = NO_ERROR;
        c.configure_default_framebuffer(RGBA, 0, 0, 0);
        assert!(c.make_current(BASE, UNSIGNED_BYTE, 2, 2));
        c.copy_pixels(0, 0, 1, 1, DEPTH);
        assert_eq!(c.error, INVALID_OPERATION);
    }
}
