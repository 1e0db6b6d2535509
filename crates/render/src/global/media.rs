//! What a ray is in: the stack of media that it entered and has not left.
//!
//! A ray that enters a body pushes the body's material; one that leaves it takes the material away,
//! wherever it is in the stack. The innermost is what light runs through, air where there is none.
//! So a bubble in a glass of water in air has the right neighbours on each of its surfaces, and
//! bodies that overlap instead of touching do no harm.
//!
//! In:   material, entering or leaving. Out: the materials before and behind the surface.
//! Cost: constant.
//! Source: \[Glassner 1989\]. Departs from it: beyond [`MAX_MEDIA`] media the outermost is
//!         forgotten.

/// Most media that are remembered.
pub const MAX_MEDIA: usize = 8;

/// See the module.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Media {
    stack: [u32; MAX_MEDIA],
    count: u8,
}

/// A surface between two media; `None` is air.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Border {
    /// Where the ray comes from.
    pub before: Option<u32>,
    /// Where it goes.
    pub behind: Option<u32>,
    /// What it is in then.
    pub then: Media,
}

impl Media {
    /// The innermost medium.
    pub fn innermost(&self) -> Option<u32> {
        self.stack[..usize::from(self.count)].last().copied()
    }

    /// The ray enters a body of `material`.
    pub fn enter(self, material: u32) -> Border {
        let mut then = self;
        if usize::from(then.count) == MAX_MEDIA {
            then.stack.copy_within(1.., 0);
            then.count -= 1;
        }
        then.stack[usize::from(then.count)] = material;
        then.count += 1;
        Border { before: self.innermost(), behind: Some(material), then }
    }

    /// The ray enters or leaves a body of `material`.
    pub fn cross(self, material: u32, entering: bool) -> Border {
        if entering { self.enter(material) } else { self.leave(material) }
    }

    /// The ray enters and leaves several bodies at one place, in any order; `None` if there are
    /// none. It enters first: so a body without thickness, or another of the same material behind,
    /// leaves nothing.
    pub fn cross_all(self, crossings: impl Iterator<Item = (u32, bool)> + Clone) -> Option<Border> {
        let entered = crossings.clone().filter(|(_, entering)| *entering);
        let left = crossings.filter(|(_, entering)| !entering);
        entered.chain(left).fold(None, |border: Option<Border>, (material, entering)| {
            let media = border.map_or(self, |b| b.then);
            let Border { before, behind, then } = media.cross(material, entering);
            Some(Border { before: border.map_or(before, |b| b.before), behind, then })
        })
    }

    /// The media round a place, to which a ray from outside of everything came through these
    /// crossings. Where rounding has put what leaves a body before what enters it, they cancel each
    /// other.
    pub fn around(crossings: impl Iterator<Item = (u32, bool)>) -> Self {
        let (mut media, mut owed) = (Self::default(), Vec::new());
        for (material, entering) in crossings {
            let debt = owed.iter().position(|&m| m == material);
            match (entering, debt) {
                (true, Some(debt)) => _ = owed.swap_remove(debt),
                (false, _) if !media.stack[..usize::from(media.count)].contains(&material) => {
                    owed.push(material)
                }
                _ => media = media.cross(material, entering).then,
            }
        }
        media
    }

    /// The ray leaves a body of `material`. If it never entered it, the viewer is in the body.
    pub fn leave(self, material: u32) -> Border {
        let count = usize::from(self.count);
        let Some(at) = self.stack[..count].iter().rposition(|&m| m == material) else {
            return Border { before: Some(material), behind: self.innermost(), then: self };
        };
        let mut then = self;
        then.stack.copy_within(at + 1..count, at);
        // Equal stacks are equal bytes.
        then.stack[count - 1] = 0;
        then.count -= 1;
        Border { before: self.innermost(), behind: then.innermost(), then }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bubble_in_water_in_glass() {
        let (glass, water, air) = (4, 7, None);
        let border = Media::default().enter(glass);
        assert_eq!((border.before, border.behind), (air, Some(glass)));
        let border = border.then.enter(water);
        assert_eq!((border.before, border.behind), (Some(glass), Some(water)));
        let border = border.then.leave(water);
        assert_eq!((border.before, border.behind), (Some(water), Some(glass)));
        let border = border.then.leave(glass);
        assert_eq!(
            (border.before, border.behind, border.then.innermost()),
            (Some(glass), air, air)
        );
    }

    #[test]
    fn overlapping_bodies_and_a_viewer_inside() {
        // Into A, into B, out of A, out of B: inside B nothing changes where A ends.
        let border = Media::default().enter(1).then.enter(2).then.leave(1);
        assert_eq!((border.before, border.behind), (Some(2), Some(2)));
        assert_eq!(border.then.leave(2).behind, None);
        assert_eq!(
            Media::default().leave(3),
            Border { before: Some(3), behind: None, then: Media::default() }
        );
        let deep = (0..20).fold(Media::default(), |media, m| media.enter(m).then);
        assert_eq!((deep.innermost(), deep.leave(19).behind), (Some(19), Some(18)));
    }

    #[test]
    fn what_is_crossed_at_one_place_is_one_border() {
        let glass = Media::default().enter(1).then;
        // From glass to water, in either order.
        for crossings in [[(1, false), (2, true)], [(2, true), (1, false)]] {
            let border = glass.cross_all(crossings.into_iter()).unwrap();
            assert_eq!((border.before, border.behind), (Some(1), Some(2)));
            assert_eq!(border.then, Media::default().enter(2).then);
        }
        // A body without thickness, and another block of the same glass.
        assert_eq!(
            Media::default().cross_all([(1, false), (1, true)].into_iter()).unwrap().then,
            Media::default()
        );
        let border = glass.cross_all([(1, false), (1, true)].into_iter()).unwrap();
        assert_eq!((border.before, border.behind, border.then), (Some(1), Some(1), glass));
        assert_eq!(glass.cross_all(std::iter::empty()), None);
    }

    #[test]
    fn the_viewer_is_in_what_was_entered_and_not_left() {
        let media = Media::around([(1, true), (2, true), (3, true), (2, false)].into_iter());
        assert_eq!(media, Media::default().enter(1).then.enter(3).then);
        // Of a thin body the far wall comes first.
        assert_eq!(Media::around([(4, false), (4, true)].into_iter()), Media::default());
    }
}
