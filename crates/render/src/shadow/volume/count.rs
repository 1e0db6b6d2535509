//! Counting along paths: which sides and caps a path meets, and the numbers of a whole batch of places.

use super::super::casters::{Casters, Solid, box_around, collect, near};
use super::paths::{Boxes, Paths};
use super::{LightVolumes, ODD, RUN};
use crate::VolumeCounting;
use crate::raytrace::beam::Beam;
use crate::raytrace::intersect::Ray;
use crate::raytrace::shaft::{Block, Shaft};
use crate::raytrace::{Probe, Structure};
use std::ops::Range;
use vitral_math::lanes::{LANES, Level, Simd, dispatch};
use vitral_math::{DVec3, DVec4, Vec3};

/// Pairs of a place and a polygon that are sooner looked at than thinned out.
const FEW_PAIRS: usize = 320;

/// The volumes of one place of a light, and the triangles that cast them.
#[derive(Clone, Copy)]
pub(super) struct Lit<'a> {
    pub(super) volumes: &'a LightVolumes,
    pub(super) casters: &'a Casters,
    /// For each triangle its plane by its winding.
    pub(super) planes: &'a [DVec4],
    pub(super) level: Level,
}

/// Eight places, or the directions in which their paths do not end.
type Ends<'e> = (&'e [DVec3; LANES], bool);

impl Lit<'_> {
    fn light(&self) -> DVec4 {
        self.volumes.from.at
    }

    /// What the listed sides and caps add to the count along paths from a place.
    fn changes(&self, from: DVec3, to: Ends<'_>, sides: &[u32], caps: &[u32]) -> [i32; LANES] {
        dispatch!(self.level, simd => self.changes_in_lanes(simd, from, to, sides, caps))
    }

    #[inline(always)]
    fn changes_in_lanes<S: Simd>(
        &self,
        simd: S,
        from: DVec3,
        to: Ends<'_>,
        sides: &[u32],
        caps: &[u32],
    ) -> [i32; LANES] {
        let mut paths = Paths::new(simd, from, to, self.light());
        for &s in sides {
            paths.meet_side(&self.volumes.sides[s as usize]);
        }
        for &t in caps {
            let (plane, corners) = self.cap(t);
            paths.meet_cap(plane, corners, self.volumes.turned[t as usize]);
        }
        paths.changes
    }

    /// The plane and the corners of an opaque triangle.
    #[inline(always)]
    fn cap(&self, triangle: u32) -> (DVec4, &[Vec3; 3]) {
        (self.planes[triangle as usize], &self.casters.triangles().corners[triangle as usize])
    }

    /// The opaque triangles near a path to a homogeneous place.
    fn caps_near(&self, from: DVec3, to: DVec4) -> Vec<u32> {
        let extent = self.casters.extent();
        let way = if to.w > 0.0 { to.truncate() - from } else { to.truncate() };
        let scale = way.abs().max_element();
        let beam = Beam::around(&Ray::new(from.as_vec3(), (way / scale).as_vec3()), extent);
        let mut list = Vec::new();
        self.casters.opaque_near(&beam, &mut list);
        list
    }

    /// How many triangles stand between a place, or infinity in its direction, and the light.
    pub(super) fn around(&self, place: DVec4) -> i32 {
        let light = self.light();
        if place.w == 0.0 && light.w == 0.0 {
            return 0;
        }
        // From whichever is not at infinity to the other.
        let (from, to) = if place.w > 0.0 { (place.truncate(), light) } else { (light.truncate(), place) };
        let caps = self.caps_near(from, to);
        dispatch!(self.level, simd => self.caps_met(simd, from, to, &caps))
    }

    /// How many of the listed caps a path meets, from whichever side.
    #[inline(always)]
    fn caps_met<S: Simd>(&self, simd: S, from: DVec3, to: DVec4, caps: &[u32]) -> i32 {
        let paths = Paths::new(simd, from, (&[to.truncate(); LANES], to.w > 0.0), self.light());
        let met = caps.iter().filter(|&&t| {
            let (plane, corners) = self.cap(t);
            self.volumes.turned[t as usize] != 0 && paths.met(plane, corners).1 != 0
        });
        met.count() as i32
    }

    /// What the count changes along a path of any length, to a homogeneous place.
    fn along(&self, from: DVec3, to: DVec4) -> i32 {
        let end = to.truncate().extend(f64::from(u8::from(to.w > 0.0)));
        let mut sides = Vec::new();
        self.sides_near(&Shaft::triangle(from, [self.light(), end], self.casters.extent()), &mut sides);
        let to_end = (&[to.truncate(); LANES], to.w > 0.0);
        self.changes(from, to_end, &sides, &self.caps_near(from, to))[0]
    }

    /// Appends the sides near a probe.
    fn sides_near(&self, probe: &impl Probe, list: &mut Vec<u32>) {
        let mut runs = Vec::new();
        collect(&self.volumes.tree, probe, &mut runs);
        let (of_place, count) = (&self.volumes.tree.triangles().facets, self.volumes.sides.len());
        let run = |&place: &u32| {
            let first = of_place[place as usize] as usize * RUN;
            (first..count.min(first + RUN)).map(|s| s as u32)
        };
        list.extend(runs.iter().flat_map(run));
    }

    /// The count at a place, from the viewer or from infinity.
    fn at(&self, place: DVec3, counting: VolumeCounting, viewer: DVec4, around_viewer: i32) -> i32 {
        match counting {
            VolumeCounting::ZPass => around_viewer - self.along(place, viewer),
            VolumeCounting::ZFail => {
                let from_viewer = (place * viewer.w - viewer.truncate()).extend(0.0);
                self.around(from_viewer) - self.along(place, from_viewer)
            }
        }
    }
}

/// Places in one batch.
#[derive(Default)]
pub(super) struct Batch {
    /// Which, and where (lifted).
    places: Vec<(u32, DVec3)>,
    /// Lists of sides, caps and filters: those of a part are behind those of the part that it was cut from.
    lists: [Vec<u32>; 3],
    /// What each of eight parts keeps, while a list is gone through.
    dealt: [Vec<u32>; LANES],
}

/// Part of a batch: what is known of it, and where its lists are.
struct Part {
    places: Range<usize>,
    /// A place, and how many volumes it is in.
    known: (DVec3, i32),
    lists: Lists,
}

/// Where a part's lists of sides, caps and filters are.
type Lists = [Range<usize>; 3];

impl Batch {
    pub(super) fn reset(&mut self, places: impl Iterator<Item = (u32, DVec3)>) {
        self.places.clear();
        self.places.extend(places);
    }

    /// Calls `found` for each place: which, where, its count, and the transparent triangles that may filter its light.
    pub(super) fn count(
        &mut self,
        lit: &Lit<'_>,
        (counting, viewer, around_viewer): (VolumeCounting, DVec4, i32),
        mut found: impl FnMut(usize, DVec3, i32, &[u32]),
    ) {
        if self.places.is_empty() {
            return;
        }
        // A margin, so that a place in the box is near no plane.
        let extent = lit.casters.extent();
        let slack = f64::from(extent) * 1e-5;
        let (middle, half) = box_around(self.places.iter().map(|p| p.1), slack);
        let (min, max) = (middle - half, middle + half);
        self.lists.iter_mut().for_each(Vec::clear);
        let shaft = Shaft::between(min, max, lit.light(), extent);
        lit.sides_near(&shaft, &mut self.lists[0]);
        lit.casters.opaque_near(&Block::new(min, max), &mut self.lists[1]);
        lit.casters.filters_near(&shaft, &mut self.lists[2]);
        let from = inner(middle, half);
        let known = (from, lit.at(from, counting, viewer, around_viewer));
        let lists = [0, 1, 2].map(|k| 0..self.lists[k].len());
        self.part(lit, Part { places: 0..self.places.len(), known, lists }, slack, &mut found);
    }

    /// The counts of a part, whose box holds the known place too.
    fn part(&mut self, lit: &Lit<'_>, part: Part, slack: f64, found: &mut impl FnMut(usize, DVec3, i32, &[u32])) {
        let (from, count) = part.known;
        let polygons: usize = part.lists.iter().map(ExactSizeIterator::len).sum();
        if part.places.len() <= LANES || part.places.len() * polygons <= FEW_PAIRS {
            let [sides, caps, filters] = [0, 1, 2].map(|k: usize| &self.lists[k][part.lists[k].clone()]);
            for places in self.places[part.places].chunks(LANES) {
                // Places that are not there repeat the last.
                let to = std::array::from_fn(|k| places[k.min(places.len() - 1)].1);
                let changes = lit.changes(from, (&to, true), sides, caps);
                for (&(index, place), change) in places.iter().zip(changes) {
                    found(index as usize, place, count + change, filters);
                }
            }
            return;
        }
        let places = self.cut(part.places);
        let boxes = places.clone().map(|range| box_around(self.places[range].iter().map(|p| p.1), slack));
        let (middle, half) = (boxes.map(|b| b.0), boxes.map(|b| b.1));
        let to = boxes.map(|(middle, half)| inner(middle, half));
        let lengths = [0, 1, 2].map(|k: usize| self.lists[k].len());
        let [sides, caps] = [0, 1].map(|k: usize| &self.lists[k][part.lists[k].clone()]);
        let changes = lit.changes(from, (&to, true), sides, caps);
        let lists = dispatch!(lit.level, simd => self.narrow(simd, lit, &part.lists, (&middle, &half)));
        for (k, (places, lists)) in places.into_iter().zip(lists).enumerate() {
            self.part(lit, Part { places, known: (to[k], count + changes[k]), lists }, slack, found);
        }
        for (list, length) in self.lists.iter_mut().zip(lengths) {
            list.truncate(length);
        }
    }

    /// Cuts more than eight places into eight parts: each at the median of its longest axis, three times.
    fn cut(&mut self, all: Range<usize>) -> [Range<usize>; LANES] {
        let mut parts = [const { 0..0 }; LANES];
        parts[0] = all;
        for count in [1, 2, 4] {
            for k in (0..count).rev() {
                let Range { start, end } = parts[k].clone();
                let places = &mut self.places[start..end];
                let (_, half) = box_around(places.iter().map(|p| p.1), 0.0);
                let axis = (1..3).fold(0, |k, other| if half[other] > half[k] { other } else { k });
                let at = places.len() / 2;
                places.select_nth_unstable_by(at, |(i, p), (j, q)| p[axis].total_cmp(&q[axis]).then(i.cmp(j)));
                (parts[2 * k], parts[2 * k + 1]) = (start..start + at, start + at..end);
            }
        }
        parts
    }

    /// Appends what of the lists touches each of eight boxes, given by their middles and half their sides.
    #[inline(always)]
    fn narrow<S: Simd>(
        &mut self,
        simd: S,
        lit: &Lit<'_>,
        lists: &Lists,
        (middle, half): (&[DVec3; LANES], &[DVec3; LANES]),
    ) -> [Lists; LANES] {
        let boxes = Boxes::new(simd, middle, half);
        let least = near(lit.light(), lit.casters.extent());
        let sides = self.deal(
            (0, lists[0].clone()),
            #[inline(always)]
            |s| boxes.touched_by_side(&lit.volumes.sides[s as usize]),
        );
        let caps = self.deal(
            (1, lists[1].clone()),
            #[inline(always)]
            |t| {
                let (plane, corners) = lit.cap(t);
                boxes.touched_by_triangle(plane, corners)
            },
        );
        let filters = self.deal((2, lists[2].clone()), |t| {
            let solid = Solid::new(&lit.casters.filter(t), lit.light(), least);
            let touched = |k: &usize| solid.as_ref().is_some_and(|s| s.touches(middle[*k], half[*k]));
            (0..LANES).filter(touched).fold(0, |bits, k| bits | 1 << k)
        });
        std::array::from_fn(|k| [sides[k].clone(), caps[k].clone(), filters[k].clone()])
    }

    /// Appends to a list those of its range that `touched` gives to the first part, one bit for each, then those of the second, and so
    /// on.
    #[inline(always)]
    fn deal(&mut self, (list, range): (usize, Range<usize>), touched: impl Fn(u32) -> u32) -> [Range<usize>; LANES] {
        let list = &mut self.lists[list];
        self.dealt.iter_mut().for_each(Vec::clear);
        for &number in &list[range] {
            let mut parts = touched(number);
            while parts != 0 {
                self.dealt[parts.trailing_zeros() as usize % LANES].push(number);
                parts &= parts - 1;
            }
        }
        self.dealt.each_ref().map(|dealt| {
            let start = list.len();
            list.extend_from_slice(dealt);
            start..list.len()
        })
    }
}

/// A place in a box that is unlikely to be in the plane of anything.
fn inner(middle: DVec3, half: DVec3) -> DVec3 {
    middle + half * ODD * 0.6
}
