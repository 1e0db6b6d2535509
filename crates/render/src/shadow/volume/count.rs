//! Counting along paths: which sides and caps a path meets, and the numbers of a whole batch of
//! places.

use super::edges::{VolumeSide, before};
use super::light_volumes::LightVolumes;
use super::paths::{Boxes8, Paths};
use crate::VolumeCounting;
use crate::raytrace::beam::Beam;
use crate::raytrace::intersect::Ray;
use crate::raytrace::shaft::{Block, Shaft};
use crate::shadow::casters::{Casters, Solid, away, box_around, near, ordered, wide};
use std::ops::Range;
use vitral_math::lanes::{LANES, Level, Simd, dispatch};
use vitral_math::{DVec3, DVec4};

/// Pairs of a place and a polygon that are sooner looked at than thinned out.
const FEW_PAIRS: usize = 320;
/// No plane of a model is likely to run along it.
pub(super) const ODD: DVec3 = DVec3::new(0.7312, -0.3917, 0.5589);

/// The volumes of one place of a light, and the triangles that cast them.
#[derive(Clone, Copy)]
pub(super) struct Lit<'a> {
    pub(super) volumes: &'a LightVolumes,
    pub(super) casters: &'a Casters,
    /// For each triangle its plane by its winding.
    pub(super) planes: &'a [DVec4],
}

/// A straight path, to its end or to infinity: one alone, by the formulas of [`Paths`].
#[derive(Clone, Copy)]
struct Path {
    from: DVec3,
    /// Where it ends, or the direction in which it does not.
    to: DVec3,
    ends: bool,
    way: DVec3,
    /// Normal of the plane through the path and the light.
    normal: DVec3,
}

impl Path {
    /// To a place, or along a direction: homogeneous.
    fn new(from: DVec3, to: DVec4, light: DVec4) -> Self {
        let (to, ends) = (to.truncate(), to.w > 0.0);
        let way = if ends { to - from } else { to };
        Self { from, to, ends, way, normal: (-away(light, from)).cross(way) }
    }

    /// Whether the path crosses a plane: 1 along the normal, -1 against it.
    #[inline(always)]
    fn crosses(&self, plane: DVec4) -> i32 {
        let end =
            if self.ends { before(plane, self.to) } else { plane.truncate().dot(self.to) > 0.0 };
        i32::from(end) - i32::from(before(plane, self.from))
    }

    /// The side of the line from `a` to `b` on which the path passes.
    #[inline(always)]
    fn left_of(&self, a: DVec3, b: DVec3) -> bool {
        let value = |a: DVec3, b: DVec3| self.way.cross(a - self.from).dot(b - self.from) > 0.0;
        if ordered(a, b) { value(a, b) } else { !value(b, a) }
    }

    /// What a side adds to the count, if the path crosses its plane `along` the normal.
    #[inline(always)]
    fn side(&self, side: &VolumeSide, along: i32) -> i32 {
        if along == 0 {
            return 0;
        }
        let [a, b] = [side.a, side.b].map(|p| self.normal.dot(p - self.from) > 0.0);
        let enters = along > 0;
        if a == enters || b != enters {
            return 0;
        }
        let value = self.way.cross(side.a - self.from).dot(side.b - self.from) > 0.0;
        if value == enters { 0 } else { along * side.multiplicity }
    }

    /// Whether a path that crosses a triangle's plane `along` its normal meets the triangle.
    #[inline(always)]
    fn meets(&self, corners: &[DVec3; 3], along: i32) -> bool {
        let [a, b, c] = *corners;
        let left = along > 0;
        self.left_of(a, b) == left && self.left_of(b, c) == left && self.left_of(c, a) == left
    }
}

impl Lit<'_> {
    fn light(&self) -> DVec4 {
        self.volumes.from.at
    }

    /// What the near cap of a triangle adds to the count along a path that crosses its plane
    /// `along` its normal.
    #[inline(always)]
    fn cap(&self, path: &Path, triangle: u32, along: i32) -> i32 {
        let t = triangle as usize;
        let corners = &self.casters.triangles().corners[t];
        if along != 0 && path.meets(&wide(corners), along) {
            -along * i32::from(self.volumes.turned[t])
        } else {
            0
        }
    }

    /// What the listed sides and caps add to the count along a path.
    fn change(&self, path: &Path, sides: &[u32], caps: &[u32]) -> i32 {
        let of_side = |&s: &u32| {
            let side = self.side(s);
            path.side(side, path.crosses(side.plane))
        };
        let of_cap = |&t: &u32| self.cap(path, t, path.crosses(self.planes[t as usize]));
        sides.iter().map(of_side).sum::<i32>() + caps.iter().map(of_cap).sum::<i32>()
    }

    /// The opaque triangles near a path.
    fn caps_near(&self, path: &Path) -> Vec<u32> {
        let extent = self.casters.extent();
        let scale = path.way.abs().max_element();
        let beam =
            Beam::around(&Ray::new(path.from.as_vec3(), (path.way / scale).as_vec3()), extent);
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
        let (from, to) = if place.w > 0.0 { (place, light) } else { (light, place) };
        let path = Path::new(from.truncate(), to, light);
        let met = |&t: &u32| self.cap(&path, t, path.crosses(self.planes[t as usize])).abs();
        self.caps_near(&path).iter().map(met).sum()
    }

    /// What the count changes along a path of any length.
    fn along(&self, path: &Path) -> i32 {
        let end = path.to.extend(f64::from(u8::from(path.ends)));
        let shaft = Shaft::triangle(path.from, [self.light(), end], self.casters.extent());
        let mut sides = Vec::new();
        self.volumes.sides_near(&shaft, &mut sides);
        self.change(path, &sides, &self.caps_near(path))
    }

    #[inline(always)]
    fn side(&self, number: u32) -> &VolumeSide {
        &self.volumes.sides[number as usize]
    }

    /// The count at a place, from the viewer or from infinity.
    fn at(&self, place: DVec3, counting: VolumeCounting, viewer: DVec4, around_viewer: i32) -> i32 {
        match counting {
            VolumeCounting::ZPass => {
                around_viewer - self.along(&Path::new(place, viewer, self.light()))
            }
            VolumeCounting::ZFail => {
                let from_viewer = (place * viewer.w - viewer.truncate()).extend(0.0);
                self.around(from_viewer) - self.along(&Path::new(place, from_viewer, self.light()))
            }
        }
    }
}

/// Places in one batch.
#[derive(Default)]
pub(super) struct Batch {
    /// Which, and where (lifted).
    places: Vec<(u32, DVec3)>,
    /// Lists of sides, caps and filters: those of a part are behind those of the part that it was
    /// cut from.
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

    /// Calls `found` for each place: which, where, its count, and the transparent triangles that
    /// may filter its light.
    pub(super) fn count(
        &mut self,
        level: Level,
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
        lit.volumes.sides_near(&shaft, &mut self.lists[0]);
        lit.casters.opaque_near(&Block::new(min, max), &mut self.lists[1]);
        lit.casters.filters_near(&shaft, &mut self.lists[2]);
        let from = inner(middle, half);
        let known = (from, lit.at(from, counting, viewer, around_viewer));
        let lists = [0, 1, 2].map(|k| 0..self.lists[k].len());
        self.part(
            level,
            lit,
            Part { places: 0..self.places.len(), known, lists },
            slack,
            &mut found,
        );
    }

    /// The counts of a part, whose box holds the known place too.
    fn part(
        &mut self,
        level: Level,
        lit: &Lit<'_>,
        part: Part,
        slack: f64,
        found: &mut impl FnMut(usize, DVec3, i32, &[u32]),
    ) {
        // Count small parts place by place.
        let polygons: usize = part.lists.iter().map(ExactSizeIterator::len).sum();
        if part.places.len() <= LANES || part.places.len() * polygons <= FEW_PAIRS {
            let filters = &self.lists[2][part.lists[2].clone()];
            for places in self.places[part.places.clone()].chunks(LANES) {
                // Places that are not there repeat the last.
                let to = std::array::from_fn(|k| places[k.min(places.len() - 1)].1);
                let changes = dispatch!(level, simd => self.changes(simd, lit, &part, &to));
                for (&(index, place), change) in places.iter().zip(changes) {
                    found(index as usize, place, part.known.1 + change, filters);
                }
            }
            return;
        }

        // Cut the part into eight and bound each.
        let places = self.cut(part.places.clone());
        let boxes =
            places.clone().map(|range| box_around(self.places[range].iter().map(|p| p.1), slack));
        let (middle, half) = (boxes.map(|b| b.0), boxes.map(|b| b.1));
        let to = boxes.map(|(middle, half)| inner(middle, half));
        let lengths = [0, 1, 2].map(|k: usize| self.lists[k].len());

        // Count from the known place to a place in each, and narrow the lists to what touches it.
        let changes = dispatch!(level, simd => self.changes(simd, lit, &part, &to));
        let lists = dispatch!(level, simd => self.narrow(simd, lit, &part.lists, (&middle, &half)));

        // Recurse, then drop the narrowed lists.
        for (k, (places, lists)) in places.into_iter().zip(lists).enumerate() {
            let known = (to[k], part.known.1 + changes[k]);
            self.part(level, lit, Part { places, known, lists }, slack, found);
        }
        for (list, length) in self.lists.iter_mut().zip(lengths) {
            list.truncate(length);
        }
    }

    /// Cuts more than eight places into eight parts: each at the median of its longest axis, three
    /// times.
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
                places.select_nth_unstable_by(at, |(i, p), (j, q)| {
                    p[axis].total_cmp(&q[axis]).then(i.cmp(j))
                });
                (parts[2 * k], parts[2 * k + 1]) = (start..start + at, start + at..end);
            }
        }
        parts
    }

    /// What a part's lists add to the count on the ways from its known place to eight others.
    #[inline(always)]
    fn changes<S: Simd>(
        &self,
        simd: S,
        lit: &Lit<'_>,
        part: &Part,
        to: &[DVec3; LANES],
    ) -> [i32; LANES] {
        let mut paths = Paths::new(simd, part.known.0, to, lit.light());
        for &s in &self.lists[0][part.lists[0].clone()] {
            paths.meet_side(lit.side(s));
        }
        for &t in &self.lists[1][part.lists[1].clone()] {
            let t = t as usize;
            paths.meet_cap(
                lit.planes[t],
                &lit.casters.triangles().corners[t],
                lit.volumes.turned[t],
            );
        }
        paths.changes
    }

    /// Appends what of the lists touches each of eight boxes, given by their middles and half their
    /// sides.
    #[inline(always)]
    fn narrow<S: Simd>(
        &mut self,
        simd: S,
        lit: &Lit<'_>,
        lists: &Lists,
        (middle, half): (&[DVec3; LANES], &[DVec3; LANES]),
    ) -> [Lists; LANES] {
        // Deal sides, caps and filters to the boxes they touch.
        let boxes = Boxes8::new(simd, middle, half);
        let least = near(lit.light(), lit.casters.extent());
        let sides = self.deal(
            (0, lists[0].clone()),
            #[inline(always)]
            |s| boxes.touched_by_side(lit.side(s)),
        );
        let caps = self.deal(
            (1, lists[1].clone()),
            #[inline(always)]
            |t| {
                boxes.touched_by_triangle(
                    lit.planes[t as usize],
                    &lit.casters.triangles().corners[t as usize],
                )
            },
        );
        let filters = self.deal((2, lists[2].clone()), |t| {
            let solid = Solid::new(&lit.casters.filter(t), lit.light(), least);
            let touched =
                |k: &usize| solid.as_ref().is_some_and(|s| s.touches(middle[*k], half[*k]));
            (0..LANES).filter(touched).fold(0, |bits, k| bits | 1 << k)
        });
        std::array::from_fn(|k| [sides[k].clone(), caps[k].clone(), filters[k].clone()])
    }

    /// Appends to a list those of its range that `touched` gives to the first part, one bit for
    /// each, then those of the second, and so on.
    #[inline(always)]
    fn deal(
        &mut self,
        (list, range): (usize, Range<usize>),
        touched: impl Fn(u32) -> u32,
    ) -> [Range<usize>; LANES] {
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
