//! The client's buffer: where its pixels lie, and how tiles of the colour plane are loaded from
//! there and stored there.
//!
//! Tiles that draws may change are loaded first, and those that have changed are stored: a program
//! that draws little and looks often pays for what it draws.

use super::decode;
use super::encode;
use super::format::PixelFormat;
use super::image::lock;
use super::texels::{color_from_word, word_from_color};
use crate::Context;
use crate::enums::*;
use crate::memory::ClientMemory;
use std::ops::Range;
use vitral_raster::forward::{ColorPlane, Plane};
use vitral_raster::{TILE, Viewport};

use super::default::{OSMESA_ARGB, OSMESA_BGR, OSMESA_BGRA};

/// The client's colour buffer: its memory, format and layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ClientBuffer {
    pub(super) address: usize,
    pub(super) kind: u32,
    pub(super) format: u32,
    pub(super) viewport: Viewport,
    /// Pixels from row to row; 0 is the width.
    pub(super) row_length: usize,
    pub(super) y_up: bool,
}

impl ClientBuffer {
    /// Which component is at each place of a pixel.
    fn places(&self) -> &'static [usize] {
        match self.format {
            OSMESA_BGRA => &[2, 1, 0, 3],
            OSMESA_ARGB => &[3, 0, 1, 2],
            RGB => &[0, 1, 2],
            OSMESA_BGR => &[2, 1, 0],
            _ => &[0, 1, 2, 3],
        }
    }

    fn pixel_bytes(&self) -> usize {
        match self.kind {
            UNSIGNED_SHORT_5_6_5 => 2,
            UNSIGNED_BYTE => self.places().len(),
            UNSIGNED_SHORT => 2 * self.places().len(),
            _ => 4 * self.places().len(),
        }
    }

    fn stride(&self) -> usize {
        let length =
            if self.row_length == 0 { self.viewport.width as usize } else { self.row_length };
        length * self.pixel_bytes()
    }

    /// The address of the pixel at `x` in window row `y`.
    fn pixel(&self, x: u32, y: u32) -> Option<usize> {
        let row = if self.y_up { y } else { self.viewport.height - 1 - y };
        let start = self.stride().checked_mul(row as usize)?.checked_add(self.address)?;
        start.checked_add(x as usize * self.pixel_bytes())
    }

    /// Whether the memory in which the pixels of parts of the window lie is still there.
    fn is_there(&self, memory: &dyn ClientMemory, parts: &[Part]) -> bool {
        let (mut first, mut behind) = (usize::MAX, 0);
        for part in parts {
            for y in [part.y.start, part.y.end - 1] {
                let ends = (self.pixel(part.x.start, y), self.pixel(part.x.end - 1, y));
                let (Some(start), Some(last)) = ends else { return false };
                (first, behind) =
                    (first.min(start), behind.max(last.saturating_add(self.pixel_bytes())));
            }
        }
        memory.is_there(first, behind.saturating_sub(first))
    }

    /// Appends colours as the client's pixels.
    fn pack(&self, colors: &[[f32; 4]], out: &mut Vec<u8>) {
        let first = out.len();
        out.resize(first + colors.len() * self.pixel_bytes(), 0);
        let out = &mut out[first..];
        if self.kind == UNSIGNED_SHORT_5_6_5 {
            let format = PixelFormat { format: RGB, kind: UNSIGNED_SHORT_5_6_5 };
            encode::colors(colors, format, out);
            return;
        }
        encode::components(colors, self.places(), self.kind, out);
    }

    fn pack_words(&self, words: &[u32], out: &mut Vec<u8>) {
        if self.kind != UNSIGNED_BYTE {
            let colors: Vec<_> = words.iter().map(|&w| color_from_word(w)).collect();
            return self.pack(&colors, out);
        }
        match *self.places() {
            _ if self.holds_words() => out.extend_from_slice(bytemuck::cast_slice(words)),
            [a, b, c, d] => place(words, out, |w| [w[a], w[b], w[c], w[d]]),
            [a, b, c] => place(words, out, |w| [w[a], w[b], w[c]]),
            _ => {}
        }
    }

    /// Whether its pixels are the plane's words.
    fn holds_words(&self) -> bool {
        cfg!(target_endian = "little")
            && self.kind == UNSIGNED_BYTE
            && *self.places() == [0, 1, 2, 3]
    }

    /// The colour of one of the client's pixels; alpha is 1 where there is none.
    fn unpack(&self, pixel: &[u8]) -> [f32; 4] {
        if self.kind == UNSIGNED_SHORT_5_6_5 {
            let v = u16::from_ne_bytes([pixel[0], pixel[1]]);
            let part =
                |shift: u32, largest: u16| f32::from((v >> shift) & largest) / f32::from(largest);
            return [part(11, 31), part(5, 63), part(0, 31), 1.0];
        }
        let mut numbers = Vec::with_capacity(4);
        decode::numbers(pixel, self.kind, &mut numbers);
        let mut color = [0.0, 0.0, 0.0, 1.0];
        self.places().iter().zip(numbers).for_each(|(&place, number)| color[place] = number);
        color
    }
}

/// Appends the bytes that `pixel` makes of each word's.
#[inline]
fn place<const N: usize>(words: &[u32], out: &mut Vec<u8>, pixel: impl Fn([u8; 4]) -> [u8; N]) {
    let first = out.len();
    out.resize(first + N * words.len(), 0);
    for (bytes, word) in out[first..].chunks_exact_mut(N).zip(words) {
        bytes.copy_from_slice(&pixel(word.to_le_bytes()));
    }
}

/// Which tiles of the colour plane hold what the client's buffer held there.
#[derive(Debug, Default)]
pub(super) struct LoadedTiles {
    /// All of them.
    all: bool,
    /// By number; empty before the first is loaded.
    tiles: Vec<bool>,
}

impl LoadedTiles {
    /// Takes all tiles to be loaded.
    pub(super) fn set_all(&mut self) {
        self.all = true;
    }

    /// Takes none to be loaded.
    pub(super) fn clear(&mut self) {
        self.all = false;
        self.tiles.clear();
    }

    /// Takes a tile to be loaded; whether it was not.
    fn insert(&mut self, tile: usize) -> bool {
        if self.tiles.len() <= tile {
            self.tiles.resize(tile + 1, false);
        }
        !std::mem::replace(&mut self.tiles[tile], true)
    }
}

/// Pixels of the window: neighbouring tiles of a row of tiles.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Part {
    x: Range<u32>,
    y: Range<u32>,
}

/// The parts of a window that tiles make for which `wanted` says so, in rows and columns of tiles.
fn parts(
    viewport: Viewport,
    rows: Range<u32>,
    columns: Range<u32>,
    mut wanted: impl FnMut(usize) -> bool,
) -> Vec<Part> {
    let (side, mut parts) = (TILE as u32, Vec::<Part>::new());
    for row in rows {
        let y = row * side..((row + 1) * side).min(viewport.height);
        for column in columns.clone() {
            if !wanted((row * viewport.tiles_x() + column) as usize) {
                continue;
            }
            let x = column * side..((column + 1) * side).min(viewport.width);
            match parts.last_mut() {
                Some(part) if part.y == y && part.x.end == x.start => part.x.end = x.end,
                _ => parts.push(Part { x, y: y.clone() }),
            }
        }
    }
    parts
}

/// Takes the client's pixels of a part into the plane where they are not what the plane would
/// store.
fn load(
    buffer: &ClientBuffer,
    memory: &dyn ClientMemory,
    plane: &mut ColorPlane,
    part: &Part,
) -> Option<()> {
    // Reserve rows.
    let width = part.x.len();
    let bytes = buffer.pixel_bytes();
    let (mut words, mut colors) = (vec![0; width], vec![[0.0; 4]; width]);
    let mut ours = Vec::with_capacity(width * bytes);
    let mut theirs = vec![0; width * bytes];
    for y in part.y.clone() {
        // Compare the client's bytes with those that the plane would store.
        if !memory.read(buffer.pixel(part.x.start, y)?, &mut theirs) {
            return None;
        }
        ours.clear();
        match &*plane {
            ColorPlane::Rgba8(plane) => {
                plane.read_row(part.x.start, y, 0, &mut words);
                buffer.pack_words(&words, &mut ours);
            }
            ColorPlane::RgbaF32(plane) => {
                plane.read_row(part.x.start, y, 0, &mut colors);
                buffer.pack(&colors, &mut ours);
            }
        }
        if ours == theirs {
            continue;
        }

        // Convert the pixels that differ.
        let pixels = theirs.chunks_exact(bytes).zip(ours.chunks_exact(bytes)).enumerate();
        for (x, (theirs, _)) in pixels.filter(|(_, (theirs, ours))| theirs != ours) {
            colors[x] = buffer.unpack(theirs);
            words[x] = word_from_color(colors[x]);
        }

        // Write the row back to the plane.
        match &mut *plane {
            ColorPlane::Rgba8(plane) => plane.write_row(part.x.start, y, &words),
            ColorPlane::RgbaF32(plane) => plane.write_row(part.x.start, y, &colors),
        }
    }
    Some(())
}

/// Writes the plane's colours of a part to the client's buffer.
fn store(
    buffer: &ClientBuffer,
    memory: &dyn ClientMemory,
    plane: &ColorPlane,
    part: &Part,
) -> Option<()> {
    let width = part.x.len();
    let (mut words, mut colors) = (Vec::new(), Vec::new());
    let mut bytes = Vec::with_capacity(width * buffer.pixel_bytes());
    for y in part.y.clone() {
        // Convert the row to the client's format.
        bytes.clear();
        match plane {
            ColorPlane::Rgba8(plane) => {
                words.resize(width, 0);
                plane.read_row(part.x.start, y, 0, &mut words);
                if !buffer.holds_words() {
                    buffer.pack_words(&words, &mut bytes);
                }
            }
            ColorPlane::RgbaF32(plane) => {
                colors.resize(width, [0.0; 4]);
                plane.read_row(part.x.start, y, 0, &mut colors);
                buffer.pack(&colors, &mut bytes);
            }
        }

        // Write it to the client's memory.
        let bytes = if buffer.holds_words() { bytemuck::cast_slice(&words) } else { &bytes[..] };
        if !memory.write(buffer.pixel(part.x.start, y)?, bytes) {
            return None;
        }
    }
    Some(())
}

/// Which tiles have changed since this was last asked.
fn changed_tiles(plane: &mut ColorPlane) -> Vec<bool> {
    fn take<T: Copy>(plane: &mut Plane<T>) -> Vec<bool> {
        plane.tiles.iter_mut().map(|tile| tile.take_changed()).collect()
    }
    match plane {
        ColorPlane::Rgba8(plane) => take(plane),
        ColorPlane::RgbaF32(plane) => take(plane),
    }
}

/// Takes the tiles of a part to hold what the client's buffer holds.
fn take_as_stored(plane: &mut ColorPlane, viewport: Viewport, part: &Part) {
    let side = TILE as u32;
    let first = part.y.start / side * viewport.tiles_x();
    let tiles =
        (first + part.x.start / side) as usize..(first + part.x.end.div_ceil(side)) as usize;
    match plane {
        ColorPlane::Rgba8(plane) => {
            plane.tiles[tiles].iter_mut().for_each(|tile| _ = tile.take_changed())
        }
        ColorPlane::RgbaF32(plane) => {
            plane.tiles[tiles].iter_mut().for_each(|tile| _ = tile.take_changed())
        }
    }
}

impl Context {
    /// Takes the client's pixels into the tiles of the plane that meet `area` (x0, y0, x1, y1, the
    /// last two exclusive): only once until the next [`Self::store_default_framebuffer`].
    pub(crate) fn load_default_framebuffer(&mut self, area: [i32; 4]) {
        let fb = &mut self.default_framebuffer;
        if fb.loaded.all {
            return;
        }
        let (Some(buffer), Some(plane)) = (fb.buffer, fb.color_plane()) else { return };
        let Viewport { width, height } = buffer.viewport;
        let [x0, x1] = [area[0], area[2]].map(|x| x.clamp(0, width as i32) as u32);
        let [y0, y1] = [area[1], area[3]].map(|y| y.clamp(0, height as i32) as u32);
        if x0 >= x1 || y0 >= y1 {
            return;
        }

        // Load the tiles that were not, if the memory is still there.
        let (side, loaded) = (TILE as u32, &mut fb.loaded);
        let (rows, columns) = (y0 / side..y1.div_ceil(side), x0 / side..x1.div_ceil(side));
        let missing = parts(buffer.viewport, rows, columns, |tile| loaded.insert(tile));
        if missing.is_empty() || !buffer.is_there(&*self.memory, &missing) {
            return;
        }
        let mut plane = lock(&plane);
        for part in missing {
            let there = load(&buffer, &*self.memory, &mut plane, &part).is_some();
            take_as_stored(&mut plane, buffer.viewport, &part);
            if !there {
                return;
            }
        }
    }

    /// Runs the recorded commands and writes the colours that have changed to the client's buffer.
    /// To be called by `Flush`, `Finish` and whatever lets the client look.
    pub fn store_default_framebuffer(&mut self) {
        self.store_colors(true);
    }

    /// The same where nobody asks for it: the buffer may be gone.
    pub(super) fn store_unasked(&mut self) {
        self.store_colors(false);
    }

    fn store_colors(&mut self, asked: bool) {
        self.flush_vertices();
        if !self.default_framebuffer.drawn {
            return;
        }
        self.flush_recorded();
        let fb = &mut self.default_framebuffer;
        fb.drawn = false;
        let (Some(buffer), Some(plane)) = (fb.buffer, fb.color_plane()) else { return };
        // The client may draw into its buffer from here on.
        fb.loaded.clear();
        let mut plane = lock(&plane);
        let changed = changed_tiles(&mut plane);
        let (rows, columns) = (0..buffer.viewport.tiles_y(), 0..buffer.viewport.tiles_x());
        let parts = parts(buffer.viewport, rows, columns, |tile| changed[tile]);
        if !asked && !buffer.is_there(&*self.memory, &parts) {
            return;
        }
        for part in parts {
            if store(&buffer, &*self.memory, &plane, &part).is_none() {
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{BASE, context, get, put};
    use super::*;

    #[test]
    fn neighbouring_tiles_are_one_part() {
        let viewport = Viewport::new(150, 70).unwrap();
        let all = parts(viewport, 0..2, 0..3, |tile| tile != 4);
        let part = |x, y| Part { x, y };
        assert_eq!(all, [part(0..150, 0..64), part(0..64, 64..70), part(128..150, 64..70)]);
    }

    #[test]
    fn only_what_is_drawn_is_loaded_and_stored() {
        let mut c = context();
        assert!(c.configure_default_framebuffer(RGBA, 0, 0, 0));
        assert!(c.make_current(BASE, UNSIGNED_BYTE, 65, 1));
        c.enable(SCISSOR_TEST);
        c.scissor(64, 0, 1, 1);
        c.clear_color(1.0, 0.0, 0.0, 1.0);
        c.clear(COLOR_BUFFER_BIT);
        // Written between the draw and the end, in a tile that nothing is drawn in.
        put(&c, BASE, &[1, 2, 3, 4]);
        c.finish();
        assert_eq!((get(&c, BASE), get(&c, BASE + 4 * 64)), ([1, 2, 3, 4], [255, 0, 0, 255]));
        // Reading takes what the client has written.
        c.read_pixels(0, 0, 1, 1, RGBA, UNSIGNED_BYTE, BASE + 1024);
        assert_eq!(get(&c, BASE + 1024), [1, 2, 3, 4]);
        assert_eq!(c.get_error(), NO_ERROR);
    }
}
