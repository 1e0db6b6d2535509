//! Counting along paths: which sides and caps a path meets, and the numbers of a whole batch of places.

use super::super::casters::{Casters, Solid, away, box_around, collect, near, ordered, wide};
use super::edges::Side;
use super::{LightVolumes, ODD, RUN};
use crate::VolumeCounting;
use crate::raytrace::beam::Beam;
use crate::raytrace::intersect::Ray;
use crate::raytrace::shaft::{Block, Shaft};
use crate::raytrace::{Probe, Structure};
use std::ops::Range;
use vitral_math::{DVec3, DVec4};

/// As many places are counted together.
const FEW: usize = 8;
/// Pairs of a place and a polygon that are sooner looked at than thinned out.
const FEW_PAIRS: usize = 320;

/// The volumes of one place of a light, and the triangles that cast them.
#[derive(Clone, Copy)]
pub(super) struct Lit<'a> {
    pub(super) volumes: &'a LightVolumes,
    pub(super) casters: &'a Casters,
    /// For each triangle its plane by its winding.
    pub(super) planes: &'a [DVec4],
}

/// `n · p + w`: twice the area, or more, times the height above a plane.
#[inline(always)]
pub(super) fn height(plane: DVec4, place: DVec3) -> f64 {
    (plane.x * place.x + plane.y * place.y) + (plane.z * place.z + plane.w)
}

/// The side of a plane on which a place is. Two paths that end and begin there agree about it.
#[inline(always)]
fn before(plane: DVec4, place: DVec3) -> bool {
    height(plane, place) > 0.0
}

/// A straight path, to its end or to infinity.
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
        let end = if self.ends { before(plane, self.to) } else { plane.truncate().dot(self.to) > 0.0 };
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
    fn side(&self, side: &Side, along: i32) -> i32 {
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

    /// What the near cap of a triangle adds to the count along a path that crosses its plane `along` its normal.
    #[inline(always)]
    fn cap(&self, path: &Path, triangle: u32, along: i32) -> i32 {
        let t = triangle as usize;
        let corners = &self.casters.triangles().corners[t];
        if along != 0 && path.meets(&wide(corners), along) { -along * i32::from(self.volumes.turned[t]) } else { 0 }
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

    /// The same along paths from one place to a few others: each side and cap is looked at once.
    fn changes(&self, paths: &[Path], sides: &[u32], caps: &[u32]) -> [i32; FEW] {
        let mut changes = [0; FEW];
        let Some(first) = paths.first() else { return changes };
        for &s in sides {
            let side = self.side(s);
            add_crossings(side.plane, first.from, paths.iter(), &mut changes, |path, along| path.side(side, along));
        }
        for &t in caps {
            let plane = self.planes[t as usize];
            add_crossings(plane, first.from, paths.iter(), &mut changes, |path, along| self.cap(path, t, along));
        }
        changes
    }

    /// The opaque triangles near a path.
    fn caps_near(&self, path: &Path) -> Vec<u32> {
        let extent = self.casters.extent();
        let scale = path.way.abs().max_element();
        let beam = Beam::around(&Ray::new(path.from.as_vec3(), (path.way / scale).as_vec3()), extent);
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
        self.sides_near(&shaft, &mut sides);
        self.change(path, &sides, &self.caps_near(path))
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

    #[inline(always)]
    fn side(&self, number: u32) -> &Side {
        &self.volumes.sides[number as usize]
    }

    /// The count at a place, from the viewer or from infinity.
    fn at(&self, place: DVec3, counting: VolumeCounting, viewer: DVec4, around_viewer: i32) -> i32 {
        match counting {
            VolumeCounting::ZPass => around_viewer - self.along(&Path::new(place, viewer, self.light())),
            VolumeCounting::ZFail => {
                let from_viewer = (place * viewer.w - viewer.truncate()).extend(0.0);
                self.around(from_viewer) - self.along(&Path::new(place, from_viewer, self.light()))
            }
        }
    }
}

/// For each path from one place that crosses a plane, adds to its change what `met` says: of the path, and whether it goes along
/// the normal.
#[inline(always)]
fn add_crossings<'a>(
    plane: DVec4,
    from: DVec3,
    paths: impl Iterator<Item = &'a Path>,
    changes: &mut [i32],
    met: impl Fn(&Path, i32) -> i32,
) {
    let start = before(plane, from);
    for (path, change) in paths.zip(changes) {
        let end = before(plane, path.to);
        if end != start {
            *change += met(path, i32::from(end) - i32::from(start));
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
    /// What the second half keeps, while a list is gone through.
    second: Vec<u32>,
}

/// Half of a part: the box round its places, and the way there.
struct Half {
    middle: DVec3,
    half: DVec3,
    path: Path,
}

/// Part of a batch: what is known of it, and where its lists are.
struct Part {
    places: Range<usize>,
    /// A place, and how many volumes it is in.
    known: (DVec3, i32),
    lists: [Range<usize>; 3],
}

impl Batch {
    pub(super) fn reset(&mut self, places: impl Iterator<Item = (u32, DVec3)>) {
        self.places.clear();
        self.places.extend(places);
    }

    /// Calls `found` for each place: which, where, its count, and the transparent triangles that may filter its light.
    pub(super) fn count(
        &mut self,
        lit: &Lit<'_>,
        counting: VolumeCounting,
        viewer: DVec4,
        around_viewer: i32,
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
        let [sides, caps, filters] = part.lists.clone();
        let pairs = part.places.len() * (sides.len() + caps.len() + filters.len());
        if part.places.len() <= FEW || pairs <= FEW_PAIRS {
            let [sides, caps, filters] = [(0, sides), (1, caps), (2, filters)].map(|(k, r)| &self.lists[k][r]);
            for places in self.places[part.places].chunks(FEW) {
                // Places that are not there repeat the last.
                let path = |k: usize| Path::new(from, places[k.min(places.len() - 1)].1.extend(1.0), lit.light());
                let paths: [Path; FEW] = std::array::from_fn(path);
                let changes = lit.changes(&paths[..places.len()], sides, caps);
                for (&(index, place), change) in places.iter().zip(changes) {
                    found(index as usize, place, count + change, filters);
                }
            }
            return;
        }
        // Cut at the median of the longest axis.
        let places = &mut self.places[part.places.clone()];
        let (_, half) = box_around(places.iter().map(|p| p.1), 0.0);
        let axis = (1..3).fold(0, |k, other| if half[other] > half[k] { other } else { k });
        let at = places.len() / 2;
        places.select_nth_unstable_by(at, |(i, p), (j, q)| p[axis].total_cmp(&q[axis]).then(i.cmp(j)));
        let Range { start, end } = part.places;
        let ranges = [start..start + at, start + at..end];
        let halves = [0, 1].map(|k: usize| {
            let (middle, half) = box_around(self.places[ranges[k].clone()].iter().map(|p| p.1), slack);
            let to = inner(middle, half);
            Half { middle, half, path: Path::new(from, to.extend(1.0), lit.light()) }
        });
        let lengths = [0, 1, 2].map(|k: usize| self.lists[k].len());
        let (changes, lists) = self.narrow(lit, &part.lists, &halves);
        for (((places, half), change), lists) in ranges.into_iter().zip(&halves).zip(changes).zip(lists) {
            self.part(lit, Part { places, known: (half.path.to, count + change), lists }, slack, found);
        }
        for (list, length) in self.lists.iter_mut().zip(lengths) {
            list.truncate(length);
        }
    }

    /// Appends what of the lists touches the boxes of two halves, and gives what the lists add to the counts on the ways there.
    fn narrow(
        &mut self,
        lit: &Lit<'_>,
        lists: &[Range<usize>; 3],
        halves: &[Half; 2],
    ) -> ([i32; 2], [[Range<usize>; 3]; 2]) {
        let opaque = lit.casters.triangles();
        let least = near(lit.light(), lit.casters.extent());
        let (mut changes, from) = ([0; 2], halves[0].path.from);
        let paths = || halves.iter().map(|half| &half.path);
        let sides = self.halve(0, lists[0].clone(), |s| {
            let side = lit.side(s);
            add_crossings(side.plane, from, paths(), &mut changes, |path, along| path.side(side, along));
            let touches = |half: &Half| side.touches(half.middle, half.half);
            [touches(&halves[0]), touches(&halves[1])]
        });
        let caps = self.halve(1, lists[1].clone(), |t| {
            let plane = lit.planes[t as usize];
            add_crossings(plane, from, paths(), &mut changes, |path, along| lit.cap(path, t, along));
            let [a, b, c] = wide(&opaque.corners[t as usize]);
            let (min, max) = (a.min(b).min(c), a.max(b).max(c));
            let touches = |half: &Half| {
                // Room for the rounding of a height.
                let reach = plane.truncate().abs().dot(half.half) * (1.0 + 1e-9);
                height(plane, half.middle).abs() <= reach
                    && !(min.cmpgt(half.middle + half.half) | max.cmplt(half.middle - half.half)).any()
            };
            [touches(&halves[0]), touches(&halves[1])]
        });
        let filters = self.halve(2, lists[2].clone(), |t| {
            let solid = Solid::new(&lit.casters.filter(t), lit.light(), least);
            let touches = |half: &Half| solid.is_some_and(|s| s.touches(half.middle, half.half));
            [touches(&halves[0]), touches(&halves[1])]
        });
        (changes, [0, 1].map(|k: usize| [sides[k].clone(), caps[k].clone(), filters[k].clone()]))
    }

    /// Appends to a list those of its range that `keep` keeps for the first half, then those for the second.
    fn halve(&mut self, list: usize, range: Range<usize>, mut keep: impl FnMut(u32) -> [bool; 2]) -> [Range<usize>; 2] {
        let list = &mut self.lists[list];
        let start = list.len();
        self.second.clear();
        for i in range {
            let number = list[i];
            let [first, second] = keep(number);
            if first {
                list.push(number);
            }
            if second {
                self.second.push(number);
            }
        }
        let middle = list.len();
        list.extend_from_slice(&self.second);
        [start..middle, middle..list.len()]
    }
}

/// A place in a box that is unlikely to be in the plane of anything.
fn inner(middle: DVec3, half: DVec3) -> DVec3 {
    middle + half * ODD * 0.6
}
