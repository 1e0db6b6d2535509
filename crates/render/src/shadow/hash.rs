//! A hash of 32 bits: chance that is the same on every machine and for every order of work.

/// Mixes the bits of a number, so that numbers that differ in one bit give unrelated results.
pub(crate) fn hash(value: u32) -> u32 {
    let mut h = value.wrapping_mul(0x9e37_79b9);
    h = (h ^ h >> 16).wrapping_mul(0x85eb_ca6b);
    h = (h ^ h >> 13).wrapping_mul(0xc2b2_ae35);
    h ^ h >> 16
}
