//! Client state: vertex arrays and pixel store.

use super::MAX_TEXTURE_UNITS;
use crate::enums;
use crate::objects::BufferHandle;

/// One vertex array.
#[derive(Debug, PartialEq)]
pub struct ArrayPointer {
    /// Client state enable.
    pub enabled: bool,
    /// Components.
    pub size: i32,
    /// Type of a component.
    pub kind: u32,
    /// Stride as given, bytes; 0 is tight.
    pub stride: i32,
    /// Address in client memory, or offset in `buffer`.
    pub pointer: usize,
    /// Buffer object bound when the pointer was given.
    pub buffer: BufferHandle,
    /// The number of static elements, of EXT_vertex_array.
    pub count: i32,
}

impl ArrayPointer {
    const fn new(size: i32) -> Self {
        Self {
            enabled: false,
            size,
            kind: enums::FLOAT,
            stride: 0,
            pointer: 0,
            buffer: BufferHandle::NONE,
            count: 0,
        }
    }
}

impl Clone for ArrayPointer {
    // Client states have many.
    #[inline(never)]
    fn clone(&self) -> Self {
        Self { buffer: self.buffer.clone(), ..*self }
    }
}

/// `PixelStore` of one direction.
#[derive(Clone, Debug, PartialEq)]
pub struct PixelStore {
    /// `SWAP_BYTES`.
    pub swap_bytes: bool,
    /// `LSB_FIRST`.
    pub lsb_first: bool,
    /// `ROW_LENGTH`, 0 is the width.
    pub row_length: i32,
    /// `IMAGE_HEIGHT`, 0 is the height.
    pub image_height: i32,
    /// `SKIP_ROWS`.
    pub skip_rows: i32,
    /// `SKIP_PIXELS`.
    pub skip_pixels: i32,
    /// `SKIP_IMAGES`.
    pub skip_images: i32,
    /// `ALIGNMENT`: 1, 2, 4 or 8.
    pub alignment: i32,
    /// `PACK_INVERT_MESA`: rows of read pixels begin with the highest.
    pub invert: bool,
    /// `PIXEL_PACK_BUFFER_BINDING` or `PIXEL_UNPACK_BUFFER_BINDING`: addresses are offsets in it,
    /// if there is one.
    pub buffer: BufferHandle,
}

impl Default for PixelStore {
    fn default() -> Self {
        Self {
            swap_bytes: false,
            lsb_first: false,
            row_length: 0,
            image_height: 0,
            skip_rows: 0,
            skip_pixels: 0,
            skip_images: 0,
            alignment: 4,
            invert: false,
            buffer: BufferHandle::NONE,
        }
    }
}

/// Everything that lives on the client's side.
#[derive(Clone, Debug, PartialEq)]
pub struct ClientState {
    /// Positions.
    pub vertex: ArrayPointer,
    /// Normals.
    pub normal: ArrayPointer,
    /// Colours.
    pub color: ArrayPointer,
    /// Secondary colours.
    pub secondary: ArrayPointer,
    /// Colour indices, kept for queries alone.
    pub index: ArrayPointer,
    /// Edge flags.
    pub edge: ArrayPointer,
    /// Fog coordinates.
    pub fog: ArrayPointer,
    /// Texture coordinates, one array a unit.
    pub tex: [ArrayPointer; MAX_TEXTURE_UNITS],
    /// `CLIENT_ACTIVE_TEXTURE - TEXTURE0`.
    pub active_unit: usize,
    /// `ARRAY_BUFFER_BINDING`.
    pub array_buffer: BufferHandle,
    /// `ELEMENT_ARRAY_BUFFER_BINDING`.
    pub element_buffer: BufferHandle,
    /// `COPY_READ_BUFFER` and `COPY_WRITE_BUFFER`: the buffers that are bound there.
    pub copy_buffers: [BufferHandle; 2],
    /// How pixels are read from the client.
    pub unpack: PixelStore,
    /// How pixels are written to the client.
    pub pack: PixelStore,
    /// `PRIMITIVE_RESTART_NV` and `PRIMITIVE_RESTART_INDEX_NV`.
    pub restart: (bool, u32),
    /// `VERTEX_ARRAY_BINDING`; the arrays of the bound object are kept here while it is bound.
    pub vertex_array: u32,
}

impl Default for ClientState {
    fn default() -> Self {
        Self {
            vertex: ArrayPointer::new(4),
            normal: ArrayPointer::new(3),
            color: ArrayPointer::new(4),
            secondary: ArrayPointer::new(3),
            index: ArrayPointer::new(1),
            edge: ArrayPointer::new(1),
            fog: ArrayPointer::new(1),
            tex: [const { ArrayPointer::new(4) }; MAX_TEXTURE_UNITS],
            active_unit: 0,
            array_buffer: BufferHandle::NONE,
            element_buffer: BufferHandle::NONE,
            copy_buffers: [BufferHandle::NONE; 2],
            unpack: PixelStore::default(),
            pack: PixelStore::default(),
            restart: (false, 0),
            vertex_array: 0,
        }
    }
}
