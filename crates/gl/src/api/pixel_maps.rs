//! Pixel maps.

use super::arguments::unit;
use super::capabilities::index_in;
use crate::state::MAX_PIXEL_MAP_TABLE;
use crate::{ClientMemory, Context, enums as gl};
use bytemuck::Pod;
use std::sync::Arc;

/// An entry of a pixel map as the client has it. Maps I to I and S to S hold indices, all others
/// colours.
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
        // Check the map's name and size; these errors belong to the command in a display list.
        let index = index_in(map, gl::PIXEL_MAP_I_TO_I, 10);
        let length = usize::try_from(size).ok().filter(|n| (1..=MAX_PIXEL_MAP_TABLE).contains(n));
        // Maps that an index looks up have a power of two of entries: I to I, S to S, I to R, G, B,
        // A.
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

        // Read the values when the call is made.
        let mut given = vec![T::zeroed(); length];
        let there = match self.unpack_memory(values, size_of::<T>()) {
            Err((error, why)) => return self.record_error(error, call, why),
            Ok((memory, at)) => at != 0 && memory.read(at, bytemuck::cast_slice_mut(&mut given)),
        };
        if !there && !self.client.unpack.buffer.is_none() {
            return self.refuse_operation(call, "the map does not lie in the buffer");
        } else if !there {
            return self.refuse_value(call, "the map is not in readable memory");
        }

        // Convert the entries and keep or run the command.
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
        let Some(index) = index_in(map, gl::PIXEL_MAP_I_TO_I, 10) else {
            return self.refuse_enum(call, "map", map);
        };
        let entry =
            |v: &f32| if holds_indices(index) { T::from_index(*v) } else { T::from_color(*v) };
        let entries: Vec<T> = self.state.pixel.maps[index].values.iter().map(entry).collect();
        if self.client.pack.buffer.is_none() {
            self.give_results(call, values, &entries);
            return;
        }
        let write =
            |memory: &dyn ClientMemory, at: usize| memory.write(at, bytemuck::cast_slice(&entries));
        if let Err((error, why)) = self.pack_into(values, size_of::<T>(), write) {
            self.record_error(error, call, why);
        }
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
