//! Reading numbers from the client's memory, and their conversion to floating point.

use crate::memory::ClientMemory;
use bytemuck::Pod;

/// A number as the client may give it.
pub(crate) trait Component: Pod {
    /// Its value.
    fn plain(self) -> f32;
    /// As a colour or normal: whole numbers are mapped to 0..=1 or -1..=1.
    fn unit(self) -> f32;
}

macro_rules! component {
    ($($kind:ty: $value:ident => $unit:expr;)+) => {
        $(impl Component for $kind {
            #[inline(always)]
            fn plain(self) -> f32 {
                self as f32
            }
            #[inline(always)]
            fn unit(self) -> f32 {
                let $value = self;
                $unit
            }
        })+
    };
}

component! {
    i8: c => (2.0 * f32::from(c) + 1.0) / 255.0;
    u8: c => f32::from(c) / 255.0;
    i16: c => (2.0 * f32::from(c) + 1.0) / 65535.0;
    u16: c => f32::from(c) / 65535.0;
    i32: c => ((2.0 * f64::from(c) + 1.0) / 4_294_967_295.0) as f32;
    u32: c => (f64::from(c) / 4_294_967_295.0) as f32;
    f32: c => c;
    f64: c => c as f32;
}

/// How much is read at once where the client says how much there is: a wild length fails before it
/// is allocated.
const PIECE: usize = 1 << 20;

/// `len` bytes at `address`.
pub(crate) fn bytes(memory: &dyn ClientMemory, address: usize, len: usize) -> Option<Vec<u8>> {
    if len > 0 && address == 0 {
        return None;
    }
    let mut all = Vec::new();
    while all.len() < len {
        let start = all.len();
        let piece = PIECE.max(start).min(len - start);
        all.try_reserve(piece).ok()?;
        all.resize(start + piece, 0);
        if !memory.read(address.checked_add(start)?, &mut all[start..]) {
            return None;
        }
    }
    Some(all)
}

/// `count` numbers at `address`.
pub(crate) fn values<T: Pod>(
    memory: &dyn ClientMemory,
    address: usize,
    count: usize,
) -> Option<Vec<T>> {
    let bytes = bytes(memory, address, count.checked_mul(size_of::<T>())?)?;
    Some(bytes.chunks_exact(size_of::<T>()).map(bytemuck::pod_read_unaligned).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::Arena;

    #[test]
    fn whole_numbers_cover_the_unit_range() {
        assert_eq!((255u8.unit(), u16::MAX.unit(), u32::MAX.unit()), (1.0, 1.0, 1.0));
        assert_eq!((i8::MIN.unit(), i8::MAX.unit()), (-1.0, 1.0));
        assert_eq!((i32::MIN.unit(), i32::MAX.unit()), (-1.0, 1.0));
        assert_eq!(0i16.unit(), 1.0 / 65535.0);
        assert_eq!((-3i16).plain(), -3.0);
    }

    #[test]
    fn wild_lengths_fail_without_allocating() {
        let arena = Arena::new(16, 8);
        assert_eq!(bytes(&arena, 16, usize::MAX), None);
        assert_eq!(values::<f32>(&arena, 16, usize::MAX), None);
        assert_eq!(values::<i16>(&arena, 16, 4), Some(vec![0; 4]));
    }
}
