//! The A-buffer: each pixel keeps a list of fragments with coverage masks, and packs it when all
//! are there.
//!
//! A fragment is a facet in a pixel: which samples it covers (a bit mask) and how far it is there.
//! Sorting a pixel's few fragments once, by their ranges of depth, serves all its samples; laying
//! one over the others is a loop over the bits of its mask. That is right as long as fragments that
//! share samples do not overlap in depth. Where they do, as where two surfaces meet within a pixel,
//! Carpenter estimates how much of each is in front; here the depths at the samples are still
//! known, so the pixel is sorted sample by sample, and the result is exact everywhere.
//!
//! In:   fragments of a pixel. Out: its samples; the same bytes in whatever order the fragments
//!       came.
//! Cost: n²/4 comparisons for up to 32 fragments in the worst order, beyond that as
//!       [`super::sorted`].
//! Source: \[Carpenter 1984\].

use super::fragment::{Fragment, MOST_SAMPLES};
use super::sorted;

/// Fragments of a pixel up to which one order for all samples is looked for.
const MAX_COMMON_ORDER: usize = 32;

/// See the module.
pub fn lay(fragments: &[Fragment<'_>], samples: &mut [[f32; 4]]) {
    match fragments.len() {
        0 => {}
        1 => fragments[0].over_all(samples),
        2..=8 => pack::<8>(fragments, samples),
        9..=MAX_COMMON_ORDER => pack::<MAX_COMMON_ORDER>(fragments, samples),
        _ => sorted::lay(fragments, samples),
    }
}

/// [`lay`] for at most `MAX` fragments.
fn pack<const MAX: usize>(fragments: &[Fragment<'_>], samples: &mut [[f32; 4]]) {
    // They are few: each finds its place among those before it, from far to near.
    let mut order = [(0.0f32, 0u32); MAX];
    let order = &mut order[..fragments.len().min(MAX)];
    let of = |&(_, index): &(f32, u32)| &fragments[index as usize];
    for (i, fragment) in fragments.iter().enumerate() {
        let far = fragment.far;
        let mut place = i;
        while place > 0 {
            let before = order[place - 1];
            if before.0 < far || (before.0 == far && of(&before).facet > fragment.facet) {
                break;
            }
            order[place] = before;
            place -= 1;
        }
        order[place] = (far, i as u32);
    }

    // As long as fragments fill the pixel, one sample stands for all.
    let all = u32::MAX >> (MOST_SAMPLES - samples.len().clamp(1, MOST_SAMPLES));
    let same = samples.iter().all(|s| *s == samples[0]);
    let (mut color, mut nearest, mut count) = (samples[0], f32::MIN, 0);
    while let Some(fragment) =
        order.get(count).map(of).filter(|f| same && f.mask == all && f.far > nearest)
    {
        fragment.over(&mut color);
        (nearest, count) = (fragment.near, count + 1);
    }
    if count == order.len() {
        return samples.fill(color);
    }

    // Beyond, each sample knows how near the nearest fragment is that was laid over it: another
    // that is not nearer all over may cross it.
    let (mut laid, mut nearest) = ([color; MOST_SAMPLES], [nearest; MOST_SAMPLES]);
    if count == 0 {
        laid[..samples.len()].copy_from_slice(samples);
    }
    for fragment in order[count..].iter().map(of) {
        let (mut mask, mut crossing) = (fragment.mask, false);
        while mask != 0 {
            let s = mask.trailing_zeros() as usize % MOST_SAMPLES;
            mask &= mask - 1;
            crossing |= nearest[s] >= fragment.far;
            nearest[s] = if fragment.near > nearest[s] { fragment.near } else { nearest[s] };
            fragment.over(&mut laid[s]);
        }
        if crossing {
            return sorted::lay(fragments, samples);
        }
    }
    samples.copy_from_slice(&laid[..samples.len()]);
}

#[cfg(test)]
mod tests {
    use super::super::fragment::tests::{laid, pane};
    use super::*;

    #[test]
    fn t7_stacks_of_one_to_eight_panes_are_the_closed_sum() {
        let depths: Vec<[f32; 1]> = (0..8).map(|i| [0.9 - 0.1 * i as f32]).collect();
        for n in 1..=8 {
            let panes: Vec<_> =
                (0..n).map(|i| pane(i as u32, &depths[i], 0.1 * (i + 1) as f32, 0.5)).collect();
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
        let fragment = |facet, depths, red: f32| {
            Fragment::new(facet, (0b1111, depths), [red * 0.5, 0.0, 0.0, 0.5], [0.5; 3])
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
        let half = Fragment::new(0, (0b1001, &[0.5, 0.5]), [1.0; 4], [0.0; 3]);
        let mut samples = [[0.0, 0.0, 0.0, 1.0]; 4];
        lay(&[half], &mut samples);
        assert_eq!(samples.map(|s| s[0]), [1.0, 0.0, 0.0, 1.0]);
    }
}
