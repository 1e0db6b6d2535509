//! Reading array elements in bulk, out of buffer objects or the client's memory.

use super::cache::Vertices;
use crate::enums;
use crate::memory::ClientMemory;
use crate::objects::BufferHandle;
use crate::pixels::float_from_half;
use crate::state::ArrayPointer;
use crate::vertices::client::{self, Component};
use std::ops::Range;
use std::sync::Arc;
use vitral_math::Fingerprint;

/// The size of an array of four components in the order blue, green, red, alpha.
pub(super) const BGRA: i32 = enums::BGRA as i32;

/// A half-precision number.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
struct Half(u16);

impl Component for Half {
    fn plain(self) -> f32 {
        float_from_half(self.0)
    }
    fn unit(self) -> f32 {
        float_from_half(self.0)
    }
}

/// Why elements cannot be read.
pub(super) type Refusal = &'static str;

const OUTSIDE: Refusal = "elements lie outside of the buffer";
const NOT_THERE: Refusal = "elements are not in the client's memory";

/// Bytes of client memory that are read at once.
const PIECE: usize = 1 << 16;

/// Most bytes of a run of elements of which a buffer does not hold all: more is a mistake.
const MOST_FILLED: usize = 1 << 24;

/// Room made for elements before they are read; more comes as they arrive.
const ROOM: usize = 1 << 20;

/// A buffer's present data.
#[derive(Clone, Debug)]
pub(super) struct Store {
    pub(super) buffer: u64,
    pub(super) version: u64,
    bytes: Arc<Vec<u8>>,
}

/// The data of a buffer.
pub(super) fn store(handle: &BufferHandle) -> Result<Store, Refusal> {
    match handle.lock() {
        Some(buffer) if buffer.is_mapped() => Err("a buffer is mapped"),
        Some(buffer) => {
            Ok(Store { buffer: handle.id(), version: buffer.version, bytes: buffer.bytes.clone() })
        }
        None => Err("a buffer was deleted"),
    }
}

/// A run of elements: first and count.
pub(super) type Run = (usize, usize);

/// Reads arrays.
pub(super) struct Reader {
    pub(super) memory: Arc<dyn ClientMemory>,
    /// Every buffer that the arrays lie in.
    pub(super) stores: Vec<Store>,
}

impl Reader {
    fn bytes(&self, buffer: u64) -> Result<&[u8], Refusal> {
        let store = self.stores.iter().find(|store| store.buffer == buffer);
        Ok(store.ok_or("a buffer was deleted")?.bytes.as_slice())
    }

    /// Whether an array in a buffer begins there.
    pub(super) fn has_some(&self, array: &ArrayPointer) -> bool {
        array.buffer.is_none()
            || self.bytes(array.buffer.id()).is_ok_and(|bytes| array.pointer < bytes.len())
    }

    /// The elements of `runs`, in order. Missing numbers come from `default`; `unit` maps whole
    /// numbers to 0..=1 or -1..=1.
    pub(super) fn elements<const N: usize>(
        &self,
        array: &ArrayPointer,
        runs: &[Run],
        unit: bool,
        default: [f32; N],
    ) -> Result<Vec<[f32; N]>, Refusal> {
        // Reserve memory only up to a limit, since counts come from the client.
        let layout = Layout::of(array);
        let count = runs.iter().map(|run| run.1).sum::<usize>();
        let mut elements = Vec::with_capacity(count.min(ROOM));
        let mut piece = Vec::new();
        for &(first, count) in runs {
            let start =
                first.checked_mul(layout.stride).and_then(|start| start.checked_add(array.pointer));
            let mut start = start.ok_or(OUTSIDE)?;

            // Convert elements of a buffer in place.
            if !array.buffer.is_none() {
                let span = layout.span(count).ok_or(OUTSIDE)?;
                let end = start.checked_add(span).ok_or(OUTSIDE)?;
                let all = self.bytes(array.buffer.id())?;
                if let Some(bytes) = all.get(start..end) {
                    layout.convert(bytes, count, unit, default, &mut elements);
                } else if span <= MOST_FILLED {
                    // What the buffer does not hold reads as zero.
                    let mut bytes = all.get(start..).unwrap_or_default().to_vec();
                    bytes.resize(span, 0);
                    layout.convert(&bytes, count, unit, default, &mut elements);
                } else {
                    return Err(OUTSIDE);
                }
                continue;
            }

            // Read client memory piece by piece.
            let at_once = if layout.is_sparse() { 1 } else { (PIECE / layout.stride).max(1) };
            let mut left = count;
            while left > 0 {
                let n = left.min(at_once);
                piece.resize(layout.span(n).ok_or(NOT_THERE)?, 0);
                if array.pointer == 0 || !self.memory.read(start, &mut piece) {
                    return Err(NOT_THERE);
                }
                layout.convert(&piece, n, unit, default, &mut elements);
                start = start.checked_add(n * layout.stride).ok_or(NOT_THERE)?;
                left -= n;
            }
        }

        // Swap colours that come as blue, green, red.
        if array.size == BGRA && N > 2 {
            elements.iter_mut().for_each(|element| element.swap(0, 2));
        }
        Ok(elements)
    }

    /// The fingerprint of all bytes of the client's memory that [`Self::elements`] would read for
    /// these arrays; `None` where it would read them one by one, or not at all.
    pub(super) fn fingerprint(
        &self,
        arrays: &[(usize, ArrayPointer)],
        runs: &[Run],
    ) -> Option<Fingerprint> {
        // Collect the ranges of memory.
        let mut ranges: Vec<Range<usize>> = Vec::new();
        for (_, array) in arrays.iter().filter(|(_, array)| array.buffer.is_none()) {
            let layout = Layout::of(array);
            if layout.is_sparse() || array.pointer == 0 {
                return None;
            }
            for &(first, count) in runs {
                let start = first.checked_mul(layout.stride)?.checked_add(array.pointer)?;
                ranges.push(start..start.checked_add(layout.span(count)?)?);
            }
        }
        // Interleaved arrays are read once.
        ranges.sort_unstable_by_key(|range| range.start);
        ranges.dedup_by(|next, range| {
            let overlap = next.start <= range.end;
            if overlap {
                range.end = range.end.max(next.end);
            }
            overlap
        });

        // Hash them.
        let mut fingerprint = Fingerprint::default();
        ranges.into_iter().try_for_each(|range| self.add_bytes(&mut fingerprint, range))?;
        Some(fingerprint)
    }

    /// The fingerprint of indices in the client's memory; `None` if there are none or they cannot
    /// be read.
    pub(super) fn index_fingerprint(&self, vertices: Vertices) -> Option<Fingerprint> {
        let Vertices::Elements { count, kind, pointer, buffer: 0, .. } = vertices else {
            return None;
        };
        let end = count.checked_mul(type_size(kind))?.checked_add(pointer)?;
        let mut fingerprint = Fingerprint::default();
        self.add_bytes(&mut fingerprint, pointer..end)?;
        Some(fingerprint)
    }

    /// Adds bytes of the client's memory to a fingerprint.
    fn add_bytes(&self, fingerprint: &mut Fingerprint, range: Range<usize>) -> Option<()> {
        let mut words = vec![0u32; range.len().min(PIECE).div_ceil(4)];
        for start in range.clone().step_by(PIECE) {
            let len = (range.end - start).min(PIECE);
            let words = &mut words[..len.div_ceil(4)];
            words[len.div_ceil(4) - 1] = 0;
            if !self.memory.read(start, &mut bytemuck::cast_slice_mut(words)[..len]) {
                return None;
            }
            fingerprint.add(words);
        }
        Some(())
    }

    /// `count` indices of a type, in the element buffer `buffer` or the client's memory.
    pub(super) fn indices(
        &self,
        buffer: u64,
        kind: u32,
        count: usize,
        pointer: usize,
    ) -> Result<Vec<u32>, Refusal> {
        // Find the bytes in the buffer or in the client's memory.
        let size = type_size(kind);
        let owned;
        let bytes = if buffer == 0 {
            let len = count.checked_mul(size).ok_or(NOT_THERE)?;
            owned = client::bytes(&*self.memory, pointer, len).ok_or(NOT_THERE)?;
            owned.as_slice()
        } else {
            let end =
                count.checked_mul(size).and_then(|len| len.checked_add(pointer)).ok_or(OUTSIDE)?;
            self.bytes(buffer)?.get(pointer..end).ok_or(OUTSIDE)?
        };

        // Widen the indices.
        Ok(match kind {
            enums::UNSIGNED_BYTE => bytes.iter().map(|&i| i.into()).collect(),
            enums::UNSIGNED_SHORT => bytes
                .chunks_exact(2)
                .map(|i| bytemuck::pod_read_unaligned::<u16>(i).into())
                .collect(),
            _ => bytes.chunks_exact(4).map(bytemuck::pod_read_unaligned).collect(),
        })
    }
}

/// Size of a number.
fn type_size(kind: u32) -> usize {
    match kind {
        enums::BYTE | enums::UNSIGNED_BYTE => 1,
        enums::SHORT | enums::UNSIGNED_SHORT | enums::HALF_FLOAT_ARB => 2,
        enums::DOUBLE => 8,
        _ => 4,
    }
}

/// How elements lie in memory.
#[derive(Clone, Copy)]
struct Layout {
    kind: u32,
    components: usize,
    size: usize,
    stride: usize,
}

impl Layout {
    fn of(array: &ArrayPointer) -> Self {
        let components = if array.size == BGRA { 4 } else { array.size as usize };
        let size = components * type_size(array.kind);
        let stride = if array.stride == 0 { size } else { array.stride as usize };
        Self { kind: array.kind, components, size, stride }
    }

    /// Elements far apart are read one by one: what lies between may not be the client's.
    fn is_sparse(&self) -> bool {
        self.stride > 4 * self.size + 256
    }

    /// Bytes from the first to the end of the last of `count` elements.
    fn span(&self, count: usize) -> Option<usize> {
        match count.checked_sub(1) {
            Some(last) => last.checked_mul(self.stride)?.checked_add(self.size),
            None => Some(0),
        }
    }

    fn convert<const N: usize>(
        &self,
        bytes: &[u8],
        count: usize,
        unit: bool,
        default: [f32; N],
        to: &mut Vec<[f32; N]>,
    ) {
        match self.kind {
            enums::FLOAT => match self.components {
                1 => self.floats::<1, N>(bytes, count, default, to),
                2 => self.floats::<2, N>(bytes, count, default, to),
                3 => self.floats::<3, N>(bytes, count, default, to),
                _ => self.floats::<4, N>(bytes, count, default, to),
            },
            enums::BYTE => self.numbers::<i8, N>(bytes, count, unit, default, to),
            enums::UNSIGNED_BYTE => self.numbers::<u8, N>(bytes, count, unit, default, to),
            enums::SHORT => self.numbers::<i16, N>(bytes, count, unit, default, to),
            enums::UNSIGNED_SHORT => self.numbers::<u16, N>(bytes, count, unit, default, to),
            enums::INT => self.numbers::<i32, N>(bytes, count, unit, default, to),
            enums::UNSIGNED_INT => self.numbers::<u32, N>(bytes, count, unit, default, to),
            enums::HALF_FLOAT_ARB => self.numbers::<Half, N>(bytes, count, unit, default, to),
            _ => self.numbers::<f64, N>(bytes, count, unit, default, to),
        }
    }

    fn floats<const S: usize, const N: usize>(
        &self,
        bytes: &[u8],
        count: usize,
        default: [f32; N],
        to: &mut Vec<[f32; N]>,
    ) {
        to.extend((0..count).map(|i| {
            let from = &bytes[i * self.stride..][..4 * S];
            let mut element = default;
            for k in 0..S.min(N) {
                element[k] = bytemuck::pod_read_unaligned(&from[4 * k..4 * k + 4]);
            }
            element
        }));
    }

    fn numbers<T: Component, const N: usize>(
        &self,
        bytes: &[u8],
        count: usize,
        unit: bool,
        default: [f32; N],
        to: &mut Vec<[f32; N]>,
    ) {
        to.extend((0..count).map(|i| {
            let from = &bytes[i * self.stride..][..self.size];
            let mut element = default;
            for (number, bytes) in element.iter_mut().zip(from.chunks_exact(size_of::<T>())) {
                let value: T = bytemuck::pod_read_unaligned(bytes);
                *number = if unit { value.unit() } else { value.plain() };
            }
            element
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::Arena;

    fn array(size: i32, kind: u32, stride: i32, pointer: usize) -> ArrayPointer {
        ArrayPointer {
            enabled: true,
            size,
            kind,
            stride,
            pointer,
            buffer: BufferHandle::NONE,
            count: 0,
        }
    }

    #[test]
    fn elements_of_all_strides() {
        let arena = Arc::new(Arena::new(16, 4096));
        for i in 0..1000u16 {
            arena.write(16 + 4 * usize::from(i), bytemuck::bytes_of(&[i, 65535]));
        }
        let reader = Reader { memory: arena, stores: Vec::new() };
        let found = reader.elements(
            &array(2, enums::UNSIGNED_SHORT, 0, 16),
            &[(1, 2), (7, 1)],
            false,
            [9.0; 3],
        );
        assert_eq!(found, Ok(vec![[1.0, 65535.0, 9.0], [2.0, 65535.0, 9.0], [7.0, 65535.0, 9.0]]));
        let overlapping =
            reader.elements(&array(2, enums::UNSIGNED_SHORT, 2, 18), &[(0, 2)], true, [0.0; 4]);
        assert_eq!(overlapping.unwrap()[1], [1.0 / 65535.0, 1.0, 0.0, 0.0]);
        let wide = reader.elements(&array(1, enums::SHORT, 2000, 16), &[(0, 4)], false, [0.0]);
        assert_eq!(wide, Err(NOT_THERE));
        assert_eq!(
            reader.elements(&array(1, enums::SHORT, 2000, 16), &[(0, 2)], false, [0.0]),
            Ok(vec![[0.0], [500.0]])
        );
    }

    #[test]
    fn halves_and_colours_in_the_other_order() {
        let arena = Arc::new(Arena::new(16, 64));
        arena.write(16, bytemuck::bytes_of(&[0x3c00_u16, 0xc000, 0x3800]));
        arena.write(32, &[51, 102, 153, 204]);
        let reader = Reader { memory: arena, stores: Vec::new() };
        let halves = reader.elements(
            &array(3, enums::HALF_FLOAT_ARB, 0, 16),
            &[(0, 1)],
            true,
            [0.0, 0.0, 0.0, 1.0],
        );
        assert_eq!(halves, Ok(vec![[1.0, -2.0, 0.5, 1.0]]));
        let bgra = array(BGRA, enums::UNSIGNED_BYTE, 0, 32);
        assert_eq!(
            reader.elements(&bgra, &[(0, 1)], true, [0.0; 4]),
            Ok(vec![[0.6, 0.4, 0.2, 0.8]])
        );
        assert_eq!(reader.elements(&bgra, &[(0, 1)], true, [0.0; 3]), Ok(vec![[0.6, 0.4, 0.2]]));
    }

    #[test]
    fn wild_ranges_are_refused() {
        let arena = Arc::new(Arena::new(16, 64));
        let bytes = Arc::new(vec![0; 64]);
        let buffer = BufferHandle::new(1);
        let id = buffer.id();
        let reader =
            Reader { memory: arena, stores: vec![Store { buffer: id, version: 0, bytes }] };
        let mut from = array(3, enums::FLOAT, i32::MAX, 16);
        assert_eq!(reader.elements(&from, &[(usize::MAX, 1)], false, [0.0; 3]), Err(OUTSIDE));
        assert_eq!(
            reader.elements(&from, &[(0, i32::MAX as usize)], false, [0.0; 3]),
            Err(NOT_THERE)
        );
        from.buffer = buffer;
        assert!(reader.elements(&from, &[(0, 1)], false, [0.0; 3]).is_ok());
        assert_eq!(reader.elements(&from, &[(0, 2)], false, [0.0; 3]), Err(OUTSIDE));
        assert_eq!(reader.indices(id, enums::UNSIGNED_INT, 16, 1), Err(OUTSIDE));
        assert_eq!(reader.indices(id, enums::UNSIGNED_INT, 15, 1).map(|v| v.len()), Ok(15));
    }
}
