//! The A-buffer: each pixel keeps a list of fragments with coverage masks, and packs it when all are there.
//!
//! A fragment is a facet in a pixel: which samples it covers (a bit mask) and how far it is there. Sorting a pixel's few
//! fragments once, by their ranges of depth, serves all its samples; laying one over the others is a loop over the bits of
//! its mask. That is right as long as fragments that share samples do not overlap in depth. Where they do, as where two
//! surfaces meet within a pixel, Carpenter estimates how much of each is in front; here the depths at the samples are
//! still known, so the pixel is sorted sample by sample, and the result is exact everywhere.
//!
//! In:   fragments of a pixel. Out: its samples; the same bytes in whatever order the fragments came.
//! Cost: n log n + n²/2 tests of masks for up to 32 fragments, beyond that as [`super::sorted`].
//! Source: \[Carpenter 1984\].

use super::{Fragment, MOST_SAMPLES, sorted};

/// Fragments up to which one order for all samples is looked for.
const FEW: usize = 32;

/// A fragment's number, and its range of depths.
#[derive(Clone, Copy, Default)]
struct Range {
    index: u8,
    far: f32,
    near: f32,
}

/// See the module.
pub fn lay(fragments: &[Fragment<'_>], samples: &mut [[f32; 4]]) {
    if fragments.len() > FEW {
        return sorted::lay(fragments, samples);
    }
    let mut ranges = [Range::default(); FEW];
    let ranges = &mut ranges[..fragments.len()];
    let of = |r: &Range| &fragments[usize::from(r.index)];
    for (i, fragment) in fragments.iter().enumerate() {
        let (mut far, mut near) = (f32::MAX, f32::MIN);
        for &depth in fragment.depths {
            far = if depth < far { depth } else { far };
            near = if depth > near { depth } else { near };
        }
        // They are few: each finds its place among those before it.
        let range = Range { index: i as u8, far, near };
        let farther = |r: &Range| r.far < far || (r.far == far && of(r).facet > fragment.facet);
        let mut place = i;
        while place > 0 && !farther(&ranges[place - 1]) {
            ranges[place] = ranges[place - 1];
            place -= 1;
        }
        ranges[place] = range;
    }
    let mixed = ranges
        .iter()
        .enumerate()
        .any(|(i, b)| ranges[..i].iter().any(|a| a.near >= b.far && of(a).mask & of(b).mask != 0));
    if mixed {
        return sorted::lay(fragments, samples);
    }
    let all = (1u32 << samples.len().min(MOST_SAMPLES)) - 1;
    let same_behind = samples.iter().all(|s| *s == samples[0]);
    if same_behind && fragments.iter().all(|f| f.mask == all) {
        // Panes that fill the pixel: one sample stands for all.
        ranges.iter().for_each(|r| of(r).over(&mut samples[0]));
        let color = samples[0];
        samples.fill(color);
        return;
    }
    ranges.iter().for_each(|r| of(r).over_all(samples));
}

#[cfg(test)]
mod tests {
    use super::super::tests::{laid, pane};
    use super::*;

    #[test]
    fn t7_stacks_of_one_to_eight_panes_are_the_closed_sum() {
        let depths: Vec<[f32; 1]> = (0..8).map(|i| [0.9 - 0.1 * i as f32]).collect();
        for n in 1..=8 {
            let panes: Vec<_> = (0..n).map(|i| pane(i as u32, &depths[i], 0.1 * (i + 1) as f32, 0.5)).collect();
            let halved = |times| (0..times).fold(1.0f32, |share, _| share * 0.5);
            let sum: f32 = (0..n).map(|i| halved(i + 1) * 0.1 * (i + 1) as f32).sum();
            let expected = sum + halved(n) * 0.7;
            assert!((laid(lay, &panes, 0.7) - expected).abs() < 1e-6, "{n} panes");
        }
    }

    #[test]
    fn surfaces_that_meet_within_a_pixel_are_sorted_sample_by_sample() {
        // Two crossing panes over four samples: which one is in front changes in the middle.
        let (rising, falling) = ([0.2, 0.4, 0.6, 0.8], [0.8, 0.6, 0.4, 0.2]);
        let fragment = |facet, depths, red: f32| Fragment {
            facet,
            mask: 0b1111,
            depths,
            color: [red * 0.5, 0.0, 0.0, 0.5],
            passes: [0.5; 3],
            behind: None,
        };
        for order in [[0, 1], [1, 0]] {
            let both = [fragment(0, &rising, 1.0), fragment(1, &falling, 0.0)];
            let mut samples = [[0.0, 0.0, 0.0, 1.0]; 4];
            lay(&order.map(|i| both[i]), &mut samples);
            assert_eq!(samples.map(|s| s[0]), [0.25, 0.25, 0.5, 0.5]);
        }
    }

    #[test]
    fn masks_say_which_samples_a_fragment_changes() {
        let half =
            Fragment { facet: 0, mask: 0b1001, depths: &[0.5, 0.5], color: [1.0; 4], passes: [0.0; 3], behind: None };
        let mut samples = [[0.0, 0.0, 0.0, 1.0]; 4];
        lay(&[half], &mut samples);
        assert_eq!(samples.map(|s| s[0]), [1.0, 0.0, 0.0, 1.0]);
    }
}
