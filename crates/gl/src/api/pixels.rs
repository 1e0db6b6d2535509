//! Pixel store, pixel transfer, pixel maps, zoom.

use super::arguments::unit;
use super::capabilities::index_in;
use crate::state::{MAX_PIXEL_MAP_TABLE, PixelStore};
use crate::{Context, enums as gl};
use bytemuck::Pod;
use std::sync::Arc;

/// Pixel store.
impl Context {
    /// `glPixelStoref`.
    pub fn pixel_storef(&mut self, pname: u32, param: f32) {
        // A logical parameter is true for anything but 0, so it must not be rounded to it.
        let logical =
            matches!(pname, gl::UNPACK_SWAP_BYTES | gl::UNPACK_LSB_FIRST | gl::PACK_SWAP_BYTES | gl::PACK_LSB_FIRST);
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
            self.refuse_value(call, "the value is negative, or an alignment that is not 1, 2, 4 or 8");
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
        self.listable(move |c| c.exec_pixel_transfer("glPixelTransferf", pname, param, param as i32));
    }

    /// `glPixelTransferi`.
    pub fn pixel_transferi(&mut self, pname: u32, param: i32) {
        self.listable(move |c| c.exec_pixel_transfer("glPixelTransferi", pname, param as f32, param));
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

/// An entry of a pixel map as the client has it. Maps I to I and S to S hold indices, all others colours.
trait MapEntry: Pod {
    fn index(self) -> f32;
    fn color(self) -> f32;
    fn from_index(value: f32) -> Self;
    fn from_color(value: f32) -> Self;
}

impl MapEntry for f32 {
    fn index(self) -> f32 {
        self
    }
    fn color(self) -> f32 {
        self
    }
    fn from_index(value: f32) -> Self {
        value
    }
    fn from_color(value: f32) -> Self {
        value
    }
}

macro_rules! whole_entry {
    ($($type:ty)*) => {$(
        impl MapEntry for $type {
            fn index(self) -> f32 {
                self as f32
            }
            fn color(self) -> f32 {
                (f64::from(self) / f64::from(<$type>::MAX)) as f32
            }
            fn from_index(value: f32) -> Self {
                value.round() as $type
            }
            fn from_color(value: f32) -> Self {
                (f64::from(value) * f64::from(<$type>::MAX)).round() as $type
            }
        }
    )*};
}

whole_entry!(u32 u16);

fn holds_indices(map: usize) -> bool {
    map < 2
}

/// Pixel maps.
impl Context {
    fn set_map<T: MapEntry>(&mut self, call: &'static str, map: u32, size: i32, values: usize) {
        let index = index_in(map, gl::PIXEL_MAP_I_TO_I, 10);
        let length = usize::try_from(size).ok().filter(|n| (1..=MAX_PIXEL_MAP_TABLE).contains(n));
        // Maps that an index looks up have a power of two of entries: I to I, S to S, I to R, G, B, A.
        let length = length.filter(|n| n.is_power_of_two() || index.is_none_or(|i| i >= 6));
        let Some(index) = index else {
            return self.listable(move |c| {
                if c.may_set(call) {
                    c.refuse_enum(call, "map", map);
                }
            });
        };
        let Some(length) = length else {
            return self.listable(move |c| {
                if c.may_set(call) {
                    c.refuse_value(call, "the map's size is not allowed");
                }
            });
        };
        let mut given = vec![T::zeroed(); length];
        if values == 0 || !self.memory.read(values, bytemuck::cast_slice_mut(&mut given)) {
            return self.refuse_value(call, "the map is not in readable memory");
        }
        let entry = |v: T| if holds_indices(index) { v.index() } else { unit(v.color()) };
        let entries = Arc::new(given.into_iter().map(entry).collect::<Vec<f32>>());
        self.listable(move |c| {
            if c.may_set(call) {
                c.state.pixel.maps[index].values = entries.clone();
            }
        });
    }

    fn get_map<T: MapEntry>(&mut self, call: &str, map: u32, values: usize) {
        if !self.may_set(call) {
            return;
        }
        let Some(index) = index_in(map, gl::PIXEL_MAP_I_TO_I, 10) else { return self.refuse_enum(call, "map", map) };
        let entry = |v: &f32| if holds_indices(index) { T::from_index(*v) } else { T::from_color(*v) };
        let entries: Vec<T> = self.state.pixel.maps[index].values.iter().map(entry).collect();
        self.give_results(call, values, &entries);
    }

    /// `glPixelMapfv`.
    pub fn pixel_mapfv(&mut self, map: u32, mapsize: i32, values: usize) {
        self.set_map::<f32>("glPixelMapfv", map, mapsize, values);
    }

    /// `glPixelMapuiv`.
    pub fn pixel_mapuiv(&mut self, map: u32, mapsize: i32, values: usize) {
        self.set_map::<u32>("glPixelMapuiv", map, mapsize, values);
    }

    /// `glPixelMapusv`.
    pub fn pixel_mapusv(&mut self, map: u32, mapsize: i32, values: usize) {
        self.set_map::<u16>("glPixelMapusv", map, mapsize, values);
    }

    /// `glGetPixelMapfv`.
    pub fn get_pixel_mapfv(&mut self, map: u32, values: usize) {
        self.get_map::<f32>("glGetPixelMapfv", map, values);
    }

    /// `glGetPixelMapuiv`.
    pub fn get_pixel_mapuiv(&mut self, map: u32, values: usize) {
        self.get_map::<u32>("glGetPixelMapuiv", map, values);
    }

    /// `glGetPixelMapusv`.
    pub fn get_pixel_mapusv(&mut self, map: u32, values: usize) {
        self.get_map::<u16>("glGetPixelMapusv", map, values);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::testing::{BASE, RESULT, context, put, take};
    use crate::state::PixelTransfer;

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

    #[test]
    fn pixel_maps() {
        let mut c = context();
        let at = put(&c, &[0_u16, 0xFFFF, 0x8000]);
        c.pixel_mapusv(gl::PIXEL_MAP_R_TO_R, 3, at);
        c.pixel_mapusv(gl::PIXEL_MAP_S_TO_S, 2, at);
        assert_eq!(c.get_error(), gl::NO_ERROR);
        c.get_pixel_mapusv(gl::PIXEL_MAP_R_TO_R, RESULT);
        assert_eq!(take::<u16, 3>(&c), [0, 0xFFFF, 0x8000]);
        c.get_pixel_mapfv(gl::PIXEL_MAP_S_TO_S, RESULT);
        assert_eq!(take::<f32, 2>(&c), [0.0, 65535.0]);
        c.get_pixel_mapuiv(gl::PIXEL_MAP_R_TO_R, RESULT);
        assert_eq!(take::<u32, 2>(&c), [0, u32::MAX]);
    }

    #[test]
    fn wrong_maps_change_nothing() {
        let mut c = context();
        c.pixel_mapusv(gl::PIXEL_MAP_I_TO_R, 3, BASE);
        assert_eq!(c.get_error(), gl::INVALID_VALUE);
        c.pixel_mapfv(gl::PIXEL_MAP_R_TO_R, 65537, BASE);
        assert_eq!(c.get_error(), gl::INVALID_VALUE);
        c.pixel_mapfv(gl::PIXEL_MAP_R_TO_R, 0, BASE);
        assert_eq!(c.get_error(), gl::INVALID_VALUE);
        c.pixel_mapfv(gl::PIXEL_MAP_A_TO_A + 1, 1, BASE);
        assert_eq!(c.get_error(), gl::INVALID_ENUM);
        c.pixel_mapfv(gl::PIXEL_MAP_R_TO_R, 65536, BASE);
        assert_eq!(c.get_error(), gl::INVALID_VALUE);
        assert_eq!(c.state.pixel, PixelTransfer::default());
    }
}
