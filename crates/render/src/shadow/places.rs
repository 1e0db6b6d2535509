//! Places of a group and what arrives at them, in eights: each number of eight neighbours lies in a
//! row, for algorithms that answer eight together; others ask for them one by one.

use vitral_light::Rgb;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{F32x8, LANES, Simd, V3};
use vitral_math::{DVec3, dvec3};

/// A point of a surface that asks for light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// World space less [`crate::raytrace::triangles::Triangles::center`].
    pub position: DVec3,
    /// Unit normal of the facet on the side that is seen, world space; zero for a facet without
    /// area.
    pub normal: DVec3,
    /// Id of the facet that it lies on.
    pub facet: u32,
    /// Chooses the places on area lights that are asked; neighbours should differ.
    pub seed: u32,
    /// Where it is seen, in pixels of the picture, if the viewer sees it straight: places with one
    /// `y` that are on one facet are on one line.
    pub pixel: Option<[f32; 2]>,
}

/// Eight places, by their numbers; see [`SurfacePoint`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfacePoints8 {
    /// World space less the scene's middle, by axis.
    pub(super) position: [[f64; LANES]; 3],
    /// Unit normals of the facets, by axis.
    pub(super) normal: [[f64; LANES]; 3],
    /// The facets.
    pub(super) facet: [u32; LANES],
    /// Not numbers where a place is in no pixel.
    pub(super) pixel: [[f32; LANES]; 2],
    /// As in [`SurfacePoint`].
    pub(super) seed: [u32; LANES],
}

impl SurfacePoints8 {
    fn of(place: impl Fn(usize) -> SurfacePoint) -> Self {
        let places: [SurfacePoint; LANES] = std::array::from_fn(place);
        let pixel = |place: &SurfacePoint| place.pixel.unwrap_or([f32::NAN; 2]);
        Self {
            position: [0, 1, 2].map(|k| places.map(|place| place.position[k])),
            normal: [0, 1, 2].map(|k| places.map(|place| place.normal[k])),
            facet: places.map(|place| place.facet),
            pixel: [0, 1].map(|k| places.map(|place| pixel(&place)[k])),
            seed: places.map(|place| place.seed),
        }
    }

    /// One of them.
    pub(crate) fn get(&self, lane: usize) -> SurfacePoint {
        let at = |v: &[[f64; LANES]; 3]| dvec3(v[0][lane], v[1][lane], v[2][lane]);
        let pixel = [self.pixel[0][lane], self.pixel[1][lane]];
        SurfacePoint {
            position: at(&self.position),
            normal: at(&self.normal),
            facet: self.facet[lane],
            seed: self.seed[lane],
            pixel: (!pixel[0].is_nan()).then_some(pixel),
        }
    }
}

/// Any number of places.
#[derive(Clone, Debug, Default)]
pub struct SurfacePoints {
    eights: Vec<SurfacePoints8>,
    count: usize,
}

impl SurfacePoints {
    /// None yet, but memory for `count`.
    pub(crate) fn with_capacity(count: usize) -> Self {
        Self { eights: Vec::with_capacity(count.div_ceil(LANES)), count: 0 }
    }

    /// Adds the first `count` of eight. All before them were whole eights.
    #[inline(always)]
    pub(crate) fn push(&mut self, eight: SurfacePoints8, count: usize) {
        self.eights.push(eight);
        self.count += count;
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// One of them.
    pub fn get(&self, number: usize) -> SurfacePoint {
        self.eights[number / LANES].get(number % LANES)
    }

    /// Where one of them is.
    #[inline(always)]
    pub(super) fn position(&self, number: usize) -> DVec3 {
        let [x, y, z] = self.eights[number / LANES].position.map(|axis| axis[number % LANES]);
        dvec3(x, y, z)
    }

    /// Eight of them, by their numbers.
    #[inline(always)]
    pub(super) fn pick(&self, numbers: [usize; LANES]) -> SurfacePoints8 {
        let from = numbers.map(|number| &self.eights[number / LANES]);
        let mut picked = *from[0];
        for (lane, (eight, number)) in from.into_iter().zip(numbers).enumerate() {
            let own = number % LANES;
            for k in 0..3 {
                picked.position[k][lane] = eight.position[k][own];
                picked.normal[k][lane] = eight.normal[k][own];
            }
            (picked.facet[lane], picked.seed[lane]) = (eight.facet[own], eight.seed[own]);
            (0..2).for_each(|k| picked.pixel[k][lane] = eight.pixel[k][own]);
        }
        picked
    }

    /// One after the other.
    pub fn iter(&self) -> impl Iterator<Item = SurfacePoint> + Clone + '_ {
        (0..self.count).map(|number| self.get(number))
    }

    /// In eights; the last one's repeat a place where there are not eight.
    pub(super) fn eights(&self) -> &[SurfacePoints8] {
        &self.eights
    }

    /// The same places on the other side of their facets.
    pub(crate) fn turned(mut self) -> Self {
        for normal in self.eights.iter_mut().flat_map(|eight| &mut eight.normal) {
            normal.iter_mut().for_each(|number| *number = -*number);
        }
        self
    }
}

impl FromIterator<SurfacePoint> for SurfacePoints {
    fn from_iter<I: IntoIterator<Item = SurfacePoint>>(places: I) -> Self {
        let places: Vec<SurfacePoint> = places.into_iter().collect();
        let eight =
            |eight: &[SurfacePoint]| SurfacePoints8::of(|lane| eight[lane.min(eight.len() - 1)]);
        Self { eights: places.chunks(LANES).map(eight).collect(), count: places.len() }
    }
}

/// The part of each colour of a light that arrives at each of some places.
#[derive(Clone, Debug, PartialEq)]
pub struct LightVisibility(Vec<[[f32; LANES]; 3]>);

impl LightVisibility {
    /// The same for `count` places, filled up to whole eights.
    pub fn new(count: usize, part: Rgb) -> Self {
        Self(vec![part.map(|channel| [channel; LANES]); count.div_ceil(LANES)])
    }

    /// The same for all.
    pub fn fill(&mut self, part: Rgb) {
        self.0.fill(part.map(|channel| [channel; LANES]));
    }

    /// What arrives at one.
    pub fn get(&self, place: usize) -> Rgb {
        self.0[place / LANES].map(|channel| channel[place % LANES])
    }

    /// Sets what arrives at one.
    pub fn set(&mut self, place: usize, part: Rgb) {
        for (channel, value) in self.0[place / LANES].iter_mut().zip(part) {
            channel[place % LANES] = value;
        }
    }

    /// Adds something, weighted, to what arrives at one.
    pub(super) fn add(&mut self, place: usize, weight: f32, part: Rgb) {
        for (channel, value) in self.0[place / LANES].iter_mut().zip(part) {
            channel[place % LANES] += weight * value;
        }
    }

    /// In eights.
    pub(super) fn eights_mut(&mut self) -> &mut [[[f32; LANES]; 3]] {
        &mut self.0
    }

    /// At eight places from `first` on, which is one of whole eights.
    #[inline(always)]
    pub(crate) fn eight<S: Simd>(&self, simd: S, first: usize) -> V3<F32x8<S>> {
        let [r, g, b] = &self.0[first / LANES];
        V3::new(F32x8::from_slice(simd, r), F32x8::from_slice(simd, g), F32x8::from_slice(simd, b))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_parts_come_back_one_by_one() {
        let place = |i: usize| SurfacePoint {
            position: dvec3(i as f64, 1.0, 2.0),
            normal: DVec3::Y * (i as f64 + 1.0),
            facet: 7 + i as u32,
            seed: 99 - i as u32,
            pixel: i.is_multiple_of(2).then_some([i as f32, 0.5]),
        };
        for count in [0, 1, 8, 11] {
            let all: Vec<SurfacePoint> = (0..count).map(place).collect();
            let places: SurfacePoints = all.iter().copied().collect();
            assert_eq!((places.len(), places.is_empty()), (count, count == 0));
            assert!(places.iter().eq(all.iter().copied()), "{count}");
            if let Some(last) = count.checked_sub(1) {
                let numbers = std::array::from_fn(|lane| (5 * lane).min(last));
                let picked = places.pick(numbers);
                assert!((0..LANES).all(|lane| picked.get(lane) == all[numbers[lane]]));
                assert_eq!(places.position(last), all[last].position);
            }
            let back = places.turned();
            assert!(
                back.iter()
                    .zip(&all)
                    .all(|(b, a)| b.normal == -a.normal && b.position == a.position)
            );

            let mut parts = LightVisibility::new(count, [0.5; 3]);
            for i in 0..count {
                parts.set(i, [i as f32, 0.0, 1.0]);
                parts.add(i, 2.0, [1.0, 0.25, 0.0]);
            }
            assert!((0..count).all(|i| parts.get(i) == [i as f32 + 2.0, 0.5, 1.0]));
            parts.fill([1.0; 3]);
            assert_eq!(parts, LightVisibility::new(count, [1.0; 3]));
        }
    }
}
