//! Images in the client's memory: rows, strides and skips of `PixelStore`; byte and bit order.

use super::Failure;
use super::format::PixelFormat;
use crate::Context;
use crate::enums::{BITMAP, INVALID_OPERATION, OUT_OF_MEMORY};
use crate::memory::{ClientMemory, can_have};
use crate::state::PixelStore;
use std::ops::{Deref, DerefMut};

/// No image, in memory or in a texture, may be larger.
pub(crate) const MAX_IMAGE_BYTES: usize = 1 << 30;

/// An image taken from the client: tight rows, native byte order; a bitmap has one byte (0 or 1) a
/// pixel.
#[derive(Clone, Debug)]
pub(crate) struct ClientImage {
    /// What the pixels are.
    pub format: PixelFormat,
    /// Width, height, depth.
    pub size: [usize; 3],
    /// The pixels.
    pub bytes: Bytes,
}

/// Bytes that lie in words, so that pixels of four bytes can become texels without being copied
/// once more.
#[derive(Clone, Debug)]
pub(crate) struct Bytes {
    words: Vec<u32>,
    len: usize,
}

impl Bytes {
    fn zeroed(len: usize) -> Self {
        Self { words: vec![0; len.div_ceil(4)], len }
    }

    /// The bytes, four to a word in the order of memory; the last word may have more.
    pub(crate) fn into_words(self) -> Vec<u32> {
        self.words
    }
}

impl From<&[u8]> for Bytes {
    fn from(bytes: &[u8]) -> Self {
        let mut new = Self::zeroed(bytes.len());
        new.copy_from_slice(bytes);
        new
    }
}

impl Deref for Bytes {
    type Target = [u8];
    fn deref(&self) -> &[u8] {
        &bytemuck::cast_slice(&self.words)[..self.len]
    }
}

impl DerefMut for Bytes {
    fn deref_mut(&mut self) -> &mut [u8] {
        &mut bytemuck::cast_slice_mut(&mut self.words)[..self.len]
    }
}

/// A rectangle (or box) of an image in the client's memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Region {
    /// Size of the whole image.
    pub full: [usize; 3],
    /// First pixel of the region.
    pub origin: [usize; 3],
    /// Size of the region.
    pub size: [usize; 3],
    /// Whether `IMAGE_HEIGHT` and `SKIP_IMAGES` count.
    pub volume: bool,
}

impl Region {
    /// All of an image.
    pub(crate) fn whole(size: [usize; 3], volume: bool) -> Self {
        Self { full: size, origin: [0; 3], size, volume }
    }
}

/// Where the rows of a region lie.
struct Layout {
    /// Bytes from the client's address to the byte with the first pixel.
    start: usize,
    /// Pixels to skip in that byte, for bitmaps.
    bit: usize,
    row: usize,
    image: usize,
    /// Bytes of a row of the region.
    row_bytes: usize,
}

fn layout(store: &PixelStore, format: PixelFormat, region: &Region) -> Option<Layout> {
    let number = |value: i32| usize::try_from(value).ok();
    let or = |value: i32, other: usize| if value > 0 { value as usize } else { other };
    let length = or(store.row_length, region.full[0]);
    let alignment = number(store.alignment)?.max(1);
    let bitmap = format.kind == BITMAP;
    let row = if bitmap { length.div_ceil(8) } else { format.pixel_bytes().checked_mul(length)? };
    let row = row.checked_next_multiple_of(alignment)?;
    let rows = if region.volume { or(store.image_height, region.full[1]) } else { region.full[1] };
    let image = row.checked_mul(rows)?;
    let skip_images = if region.volume { number(store.skip_images)? } else { 0 };
    let x = number(store.skip_pixels)?.checked_add(region.origin[0])?;
    let y = number(store.skip_rows)?.checked_add(region.origin[1])?;
    let z = skip_images.checked_add(region.origin[2])?;
    let (first, bit) =
        if bitmap { (x / 8, x % 8) } else { (x.checked_mul(format.pixel_bytes())?, 0) };
    let start = first.checked_add(y.checked_mul(row)?)?.checked_add(z.checked_mul(image)?)?;
    let row_bytes = if bitmap {
        (bit + region.size[0]).div_ceil(8)
    } else {
        region.size[0].checked_mul(format.pixel_bytes())?
    };
    // The last byte must be addressable too.
    start
        .checked_add(image.checked_mul(region.size[2])?)?
        .checked_add(row.checked_mul(region.size[1])?)?;
    Some(Layout { start, bit, row, image, row_bytes })
}

/// Reverses the bytes of each element.
fn swap(bytes: &mut [u8], element: usize) {
    if element > 1 {
        bytes.chunks_exact_mut(element).for_each(<[u8]>::reverse);
    }
}

/// Runs `f` on each row of a region: address, and range in a tight buffer.
fn rows(
    layout: &Layout,
    region: &Region,
    address: usize,
    mut f: impl FnMut(usize, std::ops::Range<usize>) -> bool,
) -> bool {
    let tight = layout.row_bytes;
    let [_, height, depth] = region.size;
    if layout.row == tight && (depth == 1 || layout.image == tight * height) {
        return address
            .checked_add(layout.start)
            .is_some_and(|at| f(at, 0..tight * height * depth));
    }
    for z in 0..depth {
        for y in 0..height {
            let offset = layout.start + z * layout.image + y * layout.row;
            let first = (z * height + y) * tight;
            if !address.checked_add(offset).is_some_and(|at| f(at, first..first + tight)) {
                return false;
            }
        }
    }
    true
}

/// Which pixel of a byte bit number `i` from the left is.
fn mask(i: usize, lsb_first: bool) -> u8 {
    if lsb_first { 1 << (i % 8) } else { 0x80 >> (i % 8) }
}

/// Reads a region of an image. `None` if it is too large or not the client's memory.
pub(crate) fn read_region(
    memory: &dyn ClientMemory,
    store: &PixelStore,
    format: PixelFormat,
    region: &Region,
    address: usize,
) -> Option<Bytes> {
    // Check the size.
    let layout = layout(store, format, region)?;
    let [width, height, depth] = region.size;
    let total = layout.row_bytes.checked_mul(height)?.checked_mul(depth)?;
    let pixels = width.checked_mul(height)?.checked_mul(depth)?;
    if total > MAX_IMAGE_BYTES || pixels > MAX_IMAGE_BYTES {
        return None;
    }
    if pixels == 0 {
        return Some(Bytes::zeroed(0));
    }

    // Read tight rows.
    let mut bytes = Bytes::zeroed(total);
    if !rows(&layout, region, address, |at, range| memory.read(at, &mut bytes[range])) {
        return None;
    }

    // Spread bits to bytes.
    if format.kind == BITMAP {
        let mut spread = Vec::with_capacity(pixels);
        for row in bytes.chunks_exact(layout.row_bytes) {
            let bit = |x: usize| {
                u8::from(row[(layout.bit + x) / 8] & mask(layout.bit + x, store.lsb_first) != 0)
            };
            spread.extend((0..width).map(bit));
        }
        return Some(Bytes::from(&*spread));
    }

    // Swap bytes.
    if store.swap_bytes {
        swap(&mut bytes, format.element_bytes());
    }
    Some(bytes)
}

/// Writes a region of an image from tight rows (of a bitmap: one byte a pixel). `false` if that is
/// not the client's memory.
pub(crate) fn write_region(
    memory: &dyn ClientMemory,
    store: &PixelStore,
    format: PixelFormat,
    region: &Region,
    address: usize,
    mut bytes: Vec<u8>,
) -> bool {
    let Some(layout) = layout(store, format, region) else { return false };
    let [width, height, depth] = region.size;
    if width * height * depth == 0 {
        return true;
    }
    // Pack bytes to bits.
    if format.kind == BITMAP {
        // Bits beside the region stay as they are.
        let mut packed = vec![0; layout.row_bytes * height * depth];
        if !rows(&layout, region, address, |at, range| memory.read(at, &mut packed[range])) {
            return false;
        }
        for (row, source) in
            packed.chunks_exact_mut(layout.row_bytes).zip(bytes.chunks_exact(width))
        {
            for (x, value) in source.iter().enumerate() {
                let mask = mask(layout.bit + x, store.lsb_first);
                let byte = &mut row[(layout.bit + x) / 8];
                *byte = if value & 1 != 0 { *byte | mask } else { *byte & !mask };
            }
        }
        bytes = packed;
    } else if store.swap_bytes {
        swap(&mut bytes, format.element_bytes());
    }

    // Write the rows.
    rows(&layout, region, address, |at, range| memory.write(at, &bytes[range]))
}

/// More pixels than this are not drawn at once.
const MAX_DRAWN_PIXELS: usize = 1 << 26;

/// The size of a rectangle to draw, if it is neither negative nor absurd.
pub(crate) fn drawable([width, height]: [i32; 2]) -> Option<[usize; 3]> {
    let size = [usize::try_from(width).ok()?, usize::try_from(height).ok()?];
    (size[0].checked_mul(size[1])? <= MAX_DRAWN_PIXELS).then_some([size[0], size[1], 1])
}

impl Context {
    /// Reads an image with the unpacking state. `None` without an address, between Begin and End,
    /// where no image belongs, or if the memory is not the client's. What a bound buffer does not
    /// hold is an error.
    pub(crate) fn read_image(
        &self,
        format: PixelFormat,
        size: [usize; 3],
        volume: bool,
        address: usize,
    ) -> Result<Option<ClientImage>, Failure> {
        let bound = !self.client.unpack.buffer.is_none();
        if (address == 0 && !bound) || (self.inside_begin() && !self.lists.recording) {
            return Ok(None);
        }
        // The pixels and the texels made of them: rarely more.
        let bytes = size.iter().try_fold(2 * format.pixel_bytes(), |n, &side| n.checked_mul(side));
        if !bytes.is_some_and(can_have) {
            return Err((OUT_OF_MEMORY, "there is no memory for so many pixels"));
        }
        let (memory, address) = self.unpack_memory(address, format.element_bytes())?;
        let region = Region::whole(size, volume);
        match read_region(&*memory, &self.client.unpack, format, &region, address) {
            Some(bytes) => Ok(Some(ClientImage { format, size, bytes })),
            None if bound => Err((INVALID_OPERATION, "the buffer does not hold so many pixels")),
            None => Ok(None),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::enums::*;
    use crate::memory::Arena;

    fn arena(bytes: &[u8]) -> Arena {
        let arena = Arena::new(4096, 256);
        assert!(arena.write(4096, bytes));
        arena
    }

    #[test]
    fn rows_are_padded_to_the_alignment() {
        // RGB bytes, width 1: rows of 3 bytes lie 4 apart.
        let arena = arena(&[1, 2, 3, 99, 4, 5, 6, 99]);
        let format = PixelFormat::new(RGB, UNSIGNED_BYTE).unwrap();
        let region = Region::whole([1, 2, 1], false);
        let read = read_region(&arena, &PixelStore::default(), format, &region, 4096).unwrap();
        assert_eq!(*read, [1, 2, 3, 4, 5, 6]);
    }

    #[test]
    fn skips_row_length_and_swapping() {
        let arena = arena(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11]);
        let store = PixelStore {
            swap_bytes: true,
            row_length: 3,
            skip_rows: 1,
            skip_pixels: 1,
            alignment: 1,
            ..PixelStore::default()
        };
        let format = PixelFormat::new(RED, UNSIGNED_SHORT).unwrap();
        let read =
            read_region(&arena, &store, format, &Region::whole([2, 1, 1], false), 4096).unwrap();
        assert_eq!(*read, [9, 8, 11, 10]);
    }

    #[test]
    fn bitmaps_skip_bits_in_either_order() {
        let arena = arena(&[0b0100_0001, 0b1000_0000]);
        let format = PixelFormat::new(COLOR_INDEX, BITMAP).unwrap();
        let store = PixelStore { skip_pixels: 1, alignment: 1, ..PixelStore::default() };
        let region = Region::whole([8, 1, 1], false);
        let read = read_region(&arena, &store, format, &region, 4096).unwrap();
        assert_eq!(*read, [1, 0, 0, 0, 0, 0, 1, 1]);
        let store = PixelStore { lsb_first: true, ..store };
        let read = read_region(&arena, &store, format, &region, 4096).unwrap();
        assert_eq!(*read, [0, 0, 0, 0, 0, 1, 0, 0]);
        // Written back, the bit before the region keeps its value.
        assert!(write_region(&arena, &store, format, &region, 4096, vec![1; 8]));
        let mut bytes = [0; 2];
        assert!(arena.read(4096, &mut bytes));
        assert_eq!(bytes, [0b1111_1111, 0b1000_0001]);
    }

    #[test]
    fn wild_sizes_are_refused() {
        let arena = arena(&[]);
        let format = PixelFormat::new(RGBA, FLOAT).unwrap();
        let store =
            PixelStore { skip_rows: i32::MAX, row_length: i32::MAX, ..PixelStore::default() };
        let region = Region::whole([1 << 31, 1 << 31, 1 << 31], true);
        assert!(read_region(&arena, &store, format, &region, 4096).is_none());
    }
}
