//! Fingerprints of data: whether they are what they were.

/// Eight hashes side by side, so that no step waits for the one before. Data of one length that
/// differ in one word never have the same; others only by chance. Not for what someone may have
/// made on purpose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Fingerprint(pub [u64; 8]);

impl Fingerprint {
    /// That of some words.
    pub fn of(words: &[u32]) -> Self {
        let mut fingerprint = Self::default();
        fingerprint.add(words);
        fingerprint
    }

    /// Adds words. What it becomes depends on how they are cut into calls, too, unless all but the
    /// last have a multiple of 16.
    pub fn add(&mut self, words: &[u32]) {
        let (sixteens, rest) = words.as_chunks::<16>();
        // By value: hashes in memory would have to be written at each step.
        let mut hashes = self.0;
        for sixteen in sixteens {
            for (h, pair) in hashes.iter_mut().zip(sixteen.as_chunks::<2>().0) {
                *h = mixed(*h, u64::from(pair[0]) | u64::from(pair[1]) << 32);
            }
        }
        rest.iter().for_each(|&word| hashes[0] = mixed(hashes[0], u64::from(word)));
        self.0 = hashes;
    }
}

/// A hash with one more word. Different hashes stay different.
#[inline(always)]
pub fn mixed(hash: u64, word: u64) -> u64 {
    let product =
        (hash ^ word).wrapping_add(0x9e37_79b9_7f4a_7c15).wrapping_mul(0xd6e8_feb8_6659_fd93);
    product ^ product >> 29
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bit_counts_and_pieces_do_not() {
        let mut words: Vec<u32> = (0..100).map(|i| i * i).collect();
        let whole = Fingerprint::of(&words);
        let mut pieces = Fingerprint::default();
        words.chunks(32).for_each(|piece| pieces.add(piece));
        assert_eq!(whole, pieces);
        for i in 0..words.len() {
            for bit in 0..32 {
                words[i] ^= 1 << bit;
                assert_ne!(whole, Fingerprint::of(&words), "bit {bit} of word {i}");
                words[i] ^= 1 << bit;
            }
        }
        words.swap(3, 4);
        assert_ne!(whole, Fingerprint::of(&words));
    }
}
