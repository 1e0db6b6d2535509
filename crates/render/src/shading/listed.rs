//! The layers of a pixel in the order of a list: what is drawn, piece by piece.
//!
//! A list of the painter's algorithm or of a BSP tree has its order from planes in space. The depth
//! of a sample comes from corners that were snapped to 1/256 pixel: at samples within such a hair
//! of the line in which two surfaces meet, the two disagree. As for opaque surfaces
//! ([`vitral_raster::PrioritySink`]) the depth function has the last word there, since it is the
//! law for all algorithms; everywhere else the list is the order, and how often it was overruled is
//! counted.

use super::FrameConstants;
use super::points::{FragmentPoint, LayerPoint, Points, samples_in};
use crate::marks::MarkColors;
use crate::visible::nearer;

impl Points {
    /// A pixel's layers in the order of a list. What comes one after the other of one facet is a
    /// fragment; all fragments of a facet share a point, the same as without a list.
    pub(super) fn collect_listed(
        &mut self,
        pixel: u32,
        here: &mut [LayerPoint],
        place: [f32; 2],
        constants: &FrameConstants<'_>,
        marks: &MarkColors,
    ) {
        // One point for each facet, in the order of the scene.
        let mut facets: Vec<_> = here.iter().map(|l| (l.facet, 1u32 << l.sample, 0)).collect();
        facets.sort_unstable();
        facets.dedup_by(|next, facet| {
            let same = next.0 == facet.0;
            if same {
                facet.1 |= next.1;
            }
            same
        });
        for (facet, mask, source) in &mut facets {
            *source = match marks.index(*facet) {
                Some(mark) => mark,
                None => self.push(*facet, constants.middle(place, *mask)),
            };
        }

        // One fragment for each piece; a sample on the common border of clipped pieces belongs to
        // the first.
        let mut drawn = Vec::new();
        for piece in here.chunk_by_mut(|a, b| a.facet == b.facet) {
            let facet = piece[0].facet;
            piece.sort_by_key(|l| l.sample);
            let Ok(known) = facets.binary_search_by_key(&facet, |f| f.0) else { continue };
            let (_, undrawn, source) = &mut facets[known];
            let (start, mut mask) = (self.depths.len() as u32, 0);
            for layer in piece.iter().filter(|l| *undrawn >> l.sample & 1 == 1) {
                if mask >> layer.sample & 1 == 0 {
                    mask |= 1 << layer.sample;
                    self.depths.push(layer.depth);
                }
            }
            *undrawn &= !mask;
            let (is_mark, source) = (marks.index(facet).is_some(), *source);
            if is_mark {
                // It may have another place at each sample.
                let samples = samples_in(mask).map(|s| 1u32 << s);
                let at_sample = |place| self.fragment((pixel, facet), place, (source, is_mark));
                drawn.extend(samples.zip(start..).map(at_sample));
            } else if mask != 0 {
                drawn.push(self.fragment((pixel, facet), (mask, start), (source, is_mark)));
            }
        }
        self.overrule(&mut drawn);
        self.place_marks(&mut drawn);
        self.fragments.append(&mut drawn);
    }

    /// Where a fragment is farther, at a sample, than the one that the list puts behind it there,
    /// it goes behind that one at this sample, and behind all that are nearer than it. `drawn`
    /// holds no marks but at its end.
    fn overrule(&mut self, drawn: &mut Vec<FragmentPoint>) {
        let mut i = 1;
        while i < drawn.len() && !drawn[i].is_mark {
            // Find the samples at which depth contradicts the list.
            let f = drawn[i];
            let (mut left, mut contradicted) = (f.mask, 0);
            for before in drawn[..i].iter().rev() {
                let common = before.mask & left;
                for s in samples_in(common) {
                    contradicted |= u32::from(self.is_in_front(before, &f, s)) << s;
                }
                left &= !common;
                if left == 0 {
                    break;
                }
            }
            if contradicted == 0 {
                i += 1;
                continue;
            }

            // What agrees with the list stays, the other samples become fragments of their own.
            let of = |mask, start| ((f.pixel, f.facet), (mask, start), (f.source, f.is_mark));
            drawn.remove(i);
            let mut next = i;
            for s in samples_in(contradicted) {
                let (start, depth) = (self.depths.len() as u32, self.depth(&f, s));
                self.depths.push(depth);
                let (place, at, source) = of(1 << s, start);
                let single = self.fragment(place, at, source);
                let behind = drawn[..next]
                    .iter()
                    .rposition(|b| b.covers(s) && !self.is_in_front(b, &single, s));
                drawn.insert(behind.map_or(0, |b| b + 1), single);
                next += 1;
                self.overruled += 1;
            }

            // Store what agrees.
            let agreed = f.mask & !contradicted;
            if agreed != 0 {
                let start = self.depths.len() as u32;
                for s in samples_in(agreed) {
                    self.depths.push(self.depth(&f, s));
                }
                let (place, at, source) = of(agreed, start);
                drawn.insert(next, self.fragment(place, at, source));
                next += 1;
            }
            i = next;
        }
    }

    /// Whether `a` hides `b` at a sample that both cover.
    fn is_in_front(&self, a: &FragmentPoint, b: &FragmentPoint, sample: u32) -> bool {
        nearer((self.depth(a, sample), a.facet), (self.depth(b, sample), b.facet))
    }

    /// Marks come after the list, sample by sample. Puts each in front of the last fragment that is
    /// farther than it.
    fn place_marks(&self, drawn: &mut [FragmentPoint]) {
        let first = drawn.iter().position(|f| f.is_mark).unwrap_or(drawn.len());
        for i in first..drawn.len() {
            let mark = drawn[i];
            let in_front = |f: &FragmentPoint| {
                let common = f.mask & mark.mask;
                common != 0
                    && self.depth(f, common.trailing_zeros())
                        > self.depth(&mark, common.trailing_zeros())
            };
            let behind = drawn[..i].iter().rposition(|f| !in_front(f) && f.mask & mark.mask != 0);
            let place = behind.map_or(0, |b| b + 1);
            drawn[place..=i].rotate_right(1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_has_the_last_word_sample_by_sample() {
        let mut points = Points::default();
        // By the list 0, 1, 2 from back to front, over samples 0 and 1. At sample 1 facet 2 is
        // behind both others, at sample 0 the list is right.
        let mut drawn = Vec::new();
        for (facet, depths) in [(0, [0.1, 0.5]), (1, [0.2, 0.6]), (2, [0.3, 0.4])] {
            let start = points.depths.len() as u32;
            points.depths.extend(depths);
            drawn.push(points.fragment((7, facet), (0b11, start), (facet, false)));
        }
        points.overrule(&mut drawn);
        let at = |s: u32| {
            drawn
                .iter()
                .filter(|f| f.covers(s))
                .map(|f| (f.facet, points.depth(f, s)))
                .collect::<Vec<_>>()
        };
        assert_eq!(at(0), [(0, 0.1), (1, 0.2), (2, 0.3)]);
        assert_eq!(at(1), [(2, 0.4), (0, 0.5), (1, 0.6)]);
        assert_eq!(points.overruled, 1);

        // Where it agrees with the depths, the list stays as it is.
        let before = drawn.len();
        points.overrule(&mut drawn);
        assert_eq!((drawn.len(), points.overruled), (before, 1));
    }
}
