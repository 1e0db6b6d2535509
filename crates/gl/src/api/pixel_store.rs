//! Pixel store, pixel transfer, zoom.

use crate::state::PixelStore;
use crate::{Context, enums as gl};

/// Pixel store.
impl Context {
    /// `glPixelStoref`.
    pub fn pixel_storef(&mut self, pname: u32, param: f32) {
        // A logical parameter is true for anything but 0, so it must not be rounded to it.
        let logical = matches!(
            pname,
            gl::UNPACK_SWAP_BYTES
                | gl::UNPACK_LSB_FIRST
                | gl::PACK_SWAP_BYTES
                | gl::PACK_LSB_FIRST
                | gl::PACK_INVERT_MESA
        );
        let value = if logical { i32::from(param != 0.0) } else { param.round() as i32 };
        self.store("glPixelStoref", pname, value);
    }

    /// `glPixelStorei`.
    pub fn pixel_storei(&mut self, pname: u32, param: i32) {
        self.store("glPixelStorei", pname, param);
    }

    fn store(&mut self, call: &str, pname: u32, value: i32) {
        if !self.may_set(call) {
            return;
        }
        let client = &mut self.client;
        let stored = match pname {
            gl::UNPACK_SWAP_BYTES => store_logical(&mut client.unpack.swap_bytes, value),
            gl::UNPACK_LSB_FIRST => store_logical(&mut client.unpack.lsb_first, value),
            gl::PACK_SWAP_BYTES => store_logical(&mut client.pack.swap_bytes, value),
            gl::PACK_LSB_FIRST => store_logical(&mut client.pack.lsb_first, value),
            gl::PACK_INVERT_MESA => store_logical(&mut client.pack.invert, value),
            gl::UNPACK_ALIGNMENT => store_alignment(&mut client.unpack, value),
            gl::PACK_ALIGNMENT => store_alignment(&mut client.pack, value),
            gl::UNPACK_ROW_LENGTH => store_count(&mut client.unpack.row_length, value),
            gl::UNPACK_SKIP_ROWS => store_count(&mut client.unpack.skip_rows, value),
            gl::UNPACK_SKIP_PIXELS => store_count(&mut client.unpack.skip_pixels, value),
            gl::UNPACK_IMAGE_HEIGHT => store_count(&mut client.unpack.image_height, value),
            gl::UNPACK_SKIP_IMAGES => store_count(&mut client.unpack.skip_images, value),
            gl::PACK_ROW_LENGTH => store_count(&mut client.pack.row_length, value),
            gl::PACK_SKIP_ROWS => store_count(&mut client.pack.skip_rows, value),
            gl::PACK_SKIP_PIXELS => store_count(&mut client.pack.skip_pixels, value),
            gl::PACK_IMAGE_HEIGHT => store_count(&mut client.pack.image_height, value),
            gl::PACK_SKIP_IMAGES => store_count(&mut client.pack.skip_images, value),
            _ => return self.refuse_enum(call, "pname", pname),
        };
        if !stored {
            self.refuse_value(
                call,
                "the value is negative, or an alignment that is not 1, 2, 4 or 8",
            );
        }
    }
}

fn store_logical(field: &mut bool, value: i32) -> bool {
    *field = value != 0;
    true
}

fn store_count(field: &mut i32, value: i32) -> bool {
    if value >= 0 {
        *field = value;
    }
    value >= 0
}

fn store_alignment(store: &mut PixelStore, value: i32) -> bool {
    let good = matches!(value, 1 | 2 | 4 | 8);
    if good {
        store.alignment = value;
    }
    good
}

/// Pixel transfer and zoom.
impl Context {
    /// `glPixelTransferf`.
    pub fn pixel_transferf(&mut self, pname: u32, param: f32) {
        self.listable(move |c| {
            c.exec_pixel_transfer("glPixelTransferf", pname, param, param.round() as i32)
        });
    }

    /// `glPixelTransferi`.
    pub fn pixel_transferi(&mut self, pname: u32, param: i32) {
        self.listable(move |c| {
            c.exec_pixel_transfer("glPixelTransferi", pname, param as f32, param)
        });
    }

    fn exec_pixel_transfer(&mut self, call: &str, pname: u32, value: f32, whole: i32) {
        if !self.may_set(call) {
            return;
        }
        let pixel = &mut self.state.pixel;
        match pname {
            gl::MAP_COLOR => pixel.map_color = value != 0.0,
            gl::MAP_STENCIL => pixel.map_stencil = value != 0.0,
            gl::INDEX_SHIFT => pixel.index.0 = whole,
            gl::INDEX_OFFSET => pixel.index.1 = whole,
            gl::RED_SCALE => pixel.scale[0] = value,
            gl::GREEN_SCALE => pixel.scale[1] = value,
            gl::BLUE_SCALE => pixel.scale[2] = value,
            gl::ALPHA_SCALE => pixel.scale[3] = value,
            gl::RED_BIAS => pixel.bias[0] = value,
            gl::GREEN_BIAS => pixel.bias[1] = value,
            gl::BLUE_BIAS => pixel.bias[2] = value,
            gl::ALPHA_BIAS => pixel.bias[3] = value,
            gl::DEPTH_SCALE => pixel.depth.0 = value,
            gl::DEPTH_BIAS => pixel.depth.1 = value,
            _ => self.refuse_enum(call, "pname", pname),
        }
    }

    /// `glPixelZoom`.
    pub fn pixel_zoom(&mut self, x: f32, y: f32) {
        self.listable(move |c| {
            if c.may_set("glPixelZoom") {
                c.state.pixel_mode.zoom = [x, y];
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::testing::context;

    #[test]
    fn pixel_store() {
        let mut c = context();
        c.pixel_storef(gl::UNPACK_SWAP_BYTES, 0.25);
        c.pixel_storef(gl::PACK_ROW_LENGTH, 6.6);
        assert!(c.client.unpack.swap_bytes);
        assert_eq!(c.client.pack.row_length, 7);
        let before = c.client.clone();
        for (pname, value, error) in [
            (gl::UNPACK_ALIGNMENT, 3, gl::INVALID_VALUE),
            (gl::PACK_ALIGNMENT, 0, gl::INVALID_VALUE),
            (gl::PACK_SKIP_ROWS, -1, gl::INVALID_VALUE),
            (gl::MAP_COLOR, 1, gl::INVALID_ENUM),
        ] {
            c.pixel_storei(pname, value);
            assert_eq!(c.get_error(), error);
        }
        assert_eq!(c.client, before);
    }

    #[test]
    fn pixel_transfer() {
        let mut c = context();
        c.pixel_transferi(gl::MAP_COLOR, 1);
        c.pixel_transferf(gl::ALPHA_BIAS, 0.5);
        c.pixel_transferi(gl::INDEX_SHIFT, -3);
        let pixel = &c.state.pixel;
        assert!(pixel.map_color && pixel.bias[3] == 0.5 && pixel.index.0 == -3);
        c.pixel_transferi(gl::ZOOM_X, 1);
        assert_eq!(c.get_error(), gl::INVALID_ENUM);
    }
}
