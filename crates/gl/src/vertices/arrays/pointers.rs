//! Where arrays lie, and which are used.

use super::POSITION;
use super::fetch::BGRA;
use crate::state::{ArrayPointer, MAX_TEXTURE_UNITS};
use crate::vertices::attribute::{COLOR, EDGE, FOG, INDEX, NORMAL, SECONDARY, TEX};
use crate::{Context, enums};
use std::ops::RangeInclusive;

const REALS: &[u32] = &[enums::HALF_FLOAT_ARB, enums::FLOAT, enums::DOUBLE];
const SIGNED: &[u32] =
    &[enums::SHORT, enums::INT, enums::HALF_FLOAT_ARB, enums::FLOAT, enums::DOUBLE];
const SIGNED_AND_BYTE: &[u32] =
    &[enums::BYTE, enums::SHORT, enums::INT, enums::HALF_FLOAT_ARB, enums::FLOAT, enums::DOUBLE];
const INDICES: &[u32] =
    &[enums::UNSIGNED_BYTE, enums::SHORT, enums::INT, enums::FLOAT, enums::DOUBLE];
const FLAGS: &[u32] = &[enums::UNSIGNED_BYTE];
const ALL: &[u32] = &[
    enums::BYTE,
    enums::UNSIGNED_BYTE,
    enums::SHORT,
    enums::UNSIGNED_SHORT,
    enums::INT,
    enums::UNSIGNED_INT,
    enums::HALF_FLOAT_ARB,
    enums::FLOAT,
    enums::DOUBLE,
];

/// Sizes and types that the array of an attribute may have.
fn allowed(which: usize) -> (RangeInclusive<i32>, &'static [u32]) {
    match which {
        POSITION => (2..=4, SIGNED),
        NORMAL => (3..=3, SIGNED_AND_BYTE),
        COLOR => (3..=4, ALL),
        SECONDARY => (3..=3, ALL),
        FOG => (1..=1, REALS),
        INDEX => (1..=1, INDICES),
        EDGE => (1..=1, FLAGS),
        _ => (1..=4, SIGNED),
    }
}

impl Context {
    fn set_pointer(
        &mut self,
        call: &str,
        which: usize,
        [size, stride, count]: [i32; 3],
        kind: u32,
        pointer: usize,
    ) {
        if self.refused_inside_begin(call) {
            return;
        }
        let (sizes, kinds) = allowed(which);
        // EXT_vertex_array_bgra: the order is a size.
        let bgra = matches!(which, COLOR | SECONDARY) && size == BGRA;

        // Check the size, the type and the strides.
        let trouble = if bgra && kind != enums::UNSIGNED_BYTE {
            Some((enums::INVALID_OPERATION, "components in the order BGRA are bytes".to_owned()))
        } else if !bgra && !sizes.contains(&size) {
            Some((enums::INVALID_VALUE, format!("size {size} is not allowed")))
        } else if !kinds.contains(&kind) {
            Some((enums::INVALID_ENUM, format!("type {kind:#x} is not allowed")))
        } else if stride < 0 {
            Some((enums::INVALID_VALUE, format!("stride {stride} is negative")))
        } else if count < 0 {
            Some((enums::INVALID_VALUE, format!("count {count} is negative")))
        } else if self.client.vertex_array != 0
            && self.client.array_buffer.is_none()
            && pointer != 0
        {
            let why = "a vertex array object takes no arrays in client memory".to_owned();
            Some((enums::INVALID_OPERATION, why))
        } else {
            None
        };
        if let Some((error, why)) = trouble {
            self.record_error(error, call, &why);
            return;
        }

        // Store the pointer.
        self.place_array(which, size, kind, stride, pointer);
        self.client.array_mut(which).count = count;
    }

    /// Sets an array's pointer, which is valid.
    pub(super) fn place_array(
        &mut self,
        which: usize,
        size: i32,
        kind: u32,
        stride: i32,
        pointer: usize,
    ) {
        let buffer = self.client.array_buffer.clone();
        let array = self.client.array_mut(which);
        *array =
            ArrayPointer { enabled: array.enabled, size, kind, stride, pointer, buffer, count: 0 };
    }

    /// Texture coordinates of the active client unit.
    pub(super) fn active_coordinates(&self) -> usize {
        TEX + self.client.active_unit.min(MAX_TEXTURE_UNITS - 1)
    }

    /// `glVertexPointer`.
    pub fn vertex_pointer(&mut self, size: i32, type_: u32, stride: i32, pointer: usize) {
        self.set_pointer("glVertexPointer", POSITION, [size, stride, 0], type_, pointer);
    }

    /// `glNormalPointer`.
    pub fn normal_pointer(&mut self, type_: u32, stride: i32, pointer: usize) {
        self.set_pointer("glNormalPointer", NORMAL, [3, stride, 0], type_, pointer);
    }

    /// `glColorPointer`.
    pub fn color_pointer(&mut self, size: i32, type_: u32, stride: i32, pointer: usize) {
        self.set_pointer("glColorPointer", COLOR, [size, stride, 0], type_, pointer);
    }

    /// `glSecondaryColorPointer`.
    pub fn secondary_color_pointer(&mut self, size: i32, type_: u32, stride: i32, pointer: usize) {
        self.set_pointer("glSecondaryColorPointer", SECONDARY, [size, stride, 0], type_, pointer);
    }

    /// `glTexCoordPointer`.
    pub fn tex_coord_pointer(&mut self, size: i32, type_: u32, stride: i32, pointer: usize) {
        let which = self.active_coordinates();
        self.set_pointer("glTexCoordPointer", which, [size, stride, 0], type_, pointer);
    }

    /// `glFogCoordPointer`.
    pub fn fog_coord_pointer(&mut self, type_: u32, stride: i32, pointer: usize) {
        self.set_pointer("glFogCoordPointer", FOG, [1, stride, 0], type_, pointer);
    }

    /// `glIndexPointer`.
    pub fn index_pointer(&mut self, type_: u32, stride: i32, pointer: usize) {
        self.set_pointer("glIndexPointer", INDEX, [1, stride, 0], type_, pointer);
    }

    /// `glEdgeFlagPointer`.
    pub fn edge_flag_pointer(&mut self, stride: i32, pointer: usize) {
        self.set_pointer("glEdgeFlagPointer", EDGE, [1, stride, 0], enums::UNSIGNED_BYTE, pointer);
    }

    /// `glVertexPointerEXT`. EXT_vertex_array tells how many elements are static: kept for queries
    /// alone.
    pub fn vertex_pointer_ext(
        &mut self,
        size: i32,
        type_: u32,
        stride: i32,
        count: i32,
        pointer: usize,
    ) {
        self.set_pointer("glVertexPointerEXT", POSITION, [size, stride, count], type_, pointer);
    }

    /// `glNormalPointerEXT`.
    pub fn normal_pointer_ext(&mut self, type_: u32, stride: i32, count: i32, pointer: usize) {
        self.set_pointer("glNormalPointerEXT", NORMAL, [3, stride, count], type_, pointer);
    }

    /// `glColorPointerEXT`.
    pub fn color_pointer_ext(
        &mut self,
        size: i32,
        type_: u32,
        stride: i32,
        count: i32,
        pointer: usize,
    ) {
        self.set_pointer("glColorPointerEXT", COLOR, [size, stride, count], type_, pointer);
    }

    /// `glTexCoordPointerEXT`.
    pub fn tex_coord_pointer_ext(
        &mut self,
        size: i32,
        type_: u32,
        stride: i32,
        count: i32,
        pointer: usize,
    ) {
        let which = self.active_coordinates();
        self.set_pointer("glTexCoordPointerEXT", which, [size, stride, count], type_, pointer);
    }

    /// `glIndexPointerEXT`.
    pub fn index_pointer_ext(&mut self, type_: u32, stride: i32, count: i32, pointer: usize) {
        self.set_pointer("glIndexPointerEXT", INDEX, [1, stride, count], type_, pointer);
    }

    /// `glEdgeFlagPointerEXT`.
    pub fn edge_flag_pointer_ext(&mut self, stride: i32, count: i32, pointer: usize) {
        self.set_pointer(
            "glEdgeFlagPointerEXT",
            EDGE,
            [1, stride, count],
            enums::UNSIGNED_BYTE,
            pointer,
        );
    }

    fn set_array_enabled(&mut self, call: &str, array: u32, enabled: bool) {
        if self.refused_inside_begin(call) {
            return;
        }
        if array == enums::PRIMITIVE_RESTART_NV {
            self.client.restart.0 = enabled;
            return;
        }

        // Find the array.
        let which = match array {
            enums::VERTEX_ARRAY => POSITION,
            enums::NORMAL_ARRAY => NORMAL,
            enums::COLOR_ARRAY => COLOR,
            enums::INDEX_ARRAY => INDEX,
            enums::TEXTURE_COORD_ARRAY => self.active_coordinates(),
            enums::EDGE_FLAG_ARRAY => EDGE,
            enums::FOG_COORD_ARRAY => FOG,
            enums::SECONDARY_COLOR_ARRAY => SECONDARY,
            _ => {
                self.record_error(
                    enums::INVALID_ENUM,
                    call,
                    &format!("{array:#x} is not an array"),
                );
                return;
            }
        };
        self.client.array_mut(which).enabled = enabled;
    }

    /// `glEnableClientState`.
    pub fn enable_client_state(&mut self, array: u32) {
        self.set_array_enabled("glEnableClientState", array, true);
    }

    /// `glDisableClientState`.
    pub fn disable_client_state(&mut self, array: u32) {
        self.set_array_enabled("glDisableClientState", array, false);
    }

    /// `glPrimitiveRestartIndexNV`.
    pub fn primitive_restart_index_nv(&mut self, index: u32) {
        if !self.refused_inside_begin("glPrimitiveRestartIndexNV") {
            self.client.restart.1 = index;
        }
    }

    /// `glClientActiveTexture`.
    pub fn client_active_texture(&mut self, texture: u32) {
        let unit = texture.wrapping_sub(enums::TEXTURE0) as usize;
        if self.refused_inside_begin("glClientActiveTexture") {
        } else if unit < MAX_TEXTURE_UNITS {
            self.client.active_unit = unit;
        } else {
            let why = format!("{texture:#x} is not a texture unit");
            self.record_error(enums::INVALID_ENUM, "glClientActiveTexture", &why);
        }
    }

    /// `glLockArraysEXT`: a promise that elements do not change, kept for queries alone.
    pub fn lock_arrays_ext(&mut self, first: i32, count: i32) {
        if self.refused_inside_begin("glLockArraysEXT") {
        } else if self.arrays.locked.is_some() {
            self.record_error(
                enums::INVALID_OPERATION,
                "glLockArraysEXT",
                "arrays are locked already",
            );
        } else if first < 0 || count <= 0 {
            self.record_error(
                enums::INVALID_VALUE,
                "glLockArraysEXT",
                &format!("{first}, {count} is not a range"),
            );
        } else {
            self.arrays.locked = Some((first, count));
        }
    }

    /// `glUnlockArraysEXT`.
    pub fn unlock_arrays_ext(&mut self) {
        if self.refused_inside_begin("glUnlockArraysEXT") {
        } else if self.arrays.locked.take().is_none() {
            self.record_error(
                enums::INVALID_OPERATION,
                "glUnlockArraysEXT",
                "arrays are not locked",
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::tests::context;
    use super::*;

    #[test]
    fn wrong_pointers_change_nothing() {
        let mut c = context();
        let before = c.client.clone();
        for (size, kind, stride, error) in [
            (1, enums::FLOAT, 0, enums::INVALID_VALUE),
            (3, enums::BYTE, 0, enums::INVALID_ENUM),
            (3, enums::FLOAT, -4, enums::INVALID_VALUE),
        ] {
            c.vertex_pointer(size, kind, stride, 16);
            assert_eq!(std::mem::take(&mut c.error), error);
        }
        assert_eq!(c.client, before);
        c.client_active_texture(enums::TEXTURE0 + 2);
        c.tex_coord_pointer(2, enums::SHORT, 12, 16);
        c.enable_client_state(enums::TEXTURE_COORD_ARRAY);
        let array = &c.client.tex[2];
        assert_eq!((array.size, array.stride, array.pointer, array.enabled), (2, 12, 16, true));
    }
}
