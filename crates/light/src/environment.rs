//! Light from an image of the surroundings: what a polished surface mirrors, what a rough one
//! blurs, and what a matt one gathers.
//!
//! Idea: a rough surface mirrors a mean of the surroundings over the tilts of its facets. That mean
//! depends on the mirror direction and the roughness alone, if the surface is taken to be seen
//! straight on, so it is computed before the picture: a pyramid of images, one for each of some
//! roughnesses, and a lookup interpolates between two of them. A mean is a sum over tilts that the
//! distribution itself chooses; each looks up an image halved as often as the tilt stands for many
//! texels, so that a few dozen are enough. What a matt surface gathers varies so slowly that nine
//! spherical harmonics say it.
//!
//! How much is mirrored is Schlick's term with the rim of rough surfaces lowered, as for the
//! [`crate::Sky`]; what a dielectric does not mirror it reflects diffusely. In white surroundings
//! of radiance 1 a white dielectric is 1 all over.
//!
//! In:   a [`Panorama`]. Out: mirrored and diffuse light at points, linear RGB.
//! Cost: about two million lookups to build; three a point.
//! Source: \[Colbert & Krivanek 2007\] for the pyramid, \[Ramamoorthi & Hanrahan 2001\] for the
//! harmonics, \[Lagarde 2011\] for the Fresnel term. Departs from them: the distribution is that of
//! [`crate::cook_torrance`], Beckmann's.

use crate::cook_torrance::{LEAST_SLOPE, Microfacet};
use crate::sky::mirrored_share;
use crate::{Panorama, Rgb, Surface, reflect};
use std::f32::consts::PI;
use std::sync::Arc;
use vitral_math::func;
use vitral_math::lanes::{Lanes, V3};

/// Columns of the blurred images and tilts that each of their texels is a mean of, for roughnesses
/// in equal steps up to 1. A texel is about as wide as the lobe of its roughness, until more texels
/// show nothing.
const LEVELS: [(usize, u32); 8] =
    [(256, 16), (256, 24), (128, 32), (64, 64), (64, 64), (64, 64), (64, 64), (64, 64)];
/// Columns of the image that the harmonics are summed over, at the most.
const HARMONIC_COLUMNS: usize = 64;

/// An image of the surroundings, ready for any roughness.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentMap {
    /// The image itself, then the blurred ones.
    levels: Vec<Panorama>,
    /// Coefficients of what a white matt surface gathers, one for each of [`harmonics`].
    gathered: [Rgb; 9],
    /// Columns and rows of the file.
    size: [usize; 2],
}

impl EnvironmentMap {
    /// Blurs an image that came from a file of `size` columns and rows.
    pub fn new(image: Panorama, size: [usize; 2]) -> Self {
        let mut halves = vec![image];
        while halves.last().is_some_and(|last| last.size() != [1, 1]) {
            halves.extend(halves.last().map(Panorama::halved));
        }
        let coarse =
            halves.iter().find(|image| image.size()[0] <= HARMONIC_COLUMNS).unwrap_or(&halves[0]);
        let gathered = gathered(coarse);
        let step = 1.0 / LEVELS.len() as f32;
        let blur = |(i, &(columns, tilts)): (usize, &(usize, u32))| {
            let tilts = Tilts::new((i + 1) as f32 * step, tilts, &halves);
            Panorama::by_direction(columns, columns / 2, |normal| tilts.mean(normal, &halves))
        };
        let blurred: Vec<_> = LEVELS.iter().enumerate().map(blur).collect();
        halves.truncate(1);
        halves.extend(blurred);
        Self { levels: halves, gathered, size }
    }

    /// Columns and rows of the file.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        self.levels
            .iter()
            .map(|level| (level.size()[0] * level.size()[1] * size_of::<Rgb>()) as u64)
            .sum()
    }

    /// The light from a direction (unit, space of the image), mixed as roughness mixes it.
    pub fn radiance(&self, direction: [f32; 3], roughness: f32) -> Rgb {
        let level = roughness.clamp(0.0, 1.0) * LEVELS.len() as f32;
        let sharper = (level as usize).min(LEVELS.len());
        let part = level - sharper as f32;
        let sharp = self.levels[sharper].at(direction);
        if part == 0.0 {
            return sharp;
        }
        let blurred = self.levels[sharper + 1].at(direction);
        [0, 1, 2].map(|k| sharp[k] + (blurred[k] - sharp[k]) * part)
    }

    /// What a white matt surface with this normal (unit, space of the image) reflects of it.
    pub fn gathered(&self, normal: [f32; 3]) -> Rgb {
        let basis = harmonics(normal);
        let sum = |k: usize| (0..9).map(|i| self.gathered[i][k] * basis[i]).sum::<f32>().max(0.0);
        [0, 1, 2].map(sum)
    }
}

/// Tilts of a rough surface's facets, seen straight on: the directions that they mirror, round +z.
struct Tilts {
    /// Direction, its share, and which half of the image it looks up.
    towards: Vec<([f32; 3], f32, usize)>,
}

impl Tilts {
    /// `count` tilts in equal steps of Beckmann's distribution.
    fn new(roughness: f32, count: u32, halves: &[Panorama]) -> Self {
        let slope = (roughness * roughness).max(LEAST_SLOPE);
        let [columns, rows] = halves[0].size();
        let texel = 4.0 * PI / (columns * rows) as f32;
        let tilt = |i: u32| {
            // The inverse of the distribution, with numbers that fill the square evenly.
            let (u, v) =
                ((i as f32 + 0.5) / count as f32, i.reverse_bits() as f32 / 4_294_967_296.0);
            let tan2 = -slope * slope * func::ln32(1.0 - u);
            let cos2 = 1.0 / (1.0 + tan2);
            let (cos, sin) = (cos2.sqrt(), (1.0 - cos2).sqrt());
            let across = 2.0 * cos * sin;
            let towards = [
                across * func::cos32(2.0 * PI * v),
                across * func::sin32(2.0 * PI * v),
                2.0 * cos2 - 1.0,
            ];

            // Choose the half whose texels are as large as the solid angle that the tilt stands
            // for.
            let density =
                func::exp32(-tan2 / (slope * slope)) / (4.0 * PI * slope * slope * cos2 * cos2);
            let solid_angle = 1.0 / (count as f32 * density);
            let half = (0.5 * func::log2_32((solid_angle / texel).max(1.0))).round() as usize;
            (towards, towards[2], half.min(halves.len() - 1))
        };
        let mut towards: Vec<_> = (0..count).map(tilt).filter(|&(_, cos, _)| cos > 0.0).collect();
        let sum: f32 = towards.iter().map(|t| t.1).sum();
        towards.iter_mut().for_each(|t| t.1 /= sum);
        Self { towards }
    }

    /// What a surface with this normal mirrors.
    fn mean(&self, n: [f32; 3], halves: &[Panorama]) -> Rgb {
        let n = V3::splat(0.0f32, n);
        let aside = if n.y.abs() < 0.99 { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] };
        let right = V3::splat(0.0f32, aside).cross(n).normalize();
        let up = n.cross(right);
        let mut sum = [0.0; 3];
        for &([x, y, z], share, half) in &self.towards {
            let direction = right.scale(x) + up.scale(y) + n.scale(z);
            let light = halves[half].at(direction.to_array());
            (0..3).for_each(|k| sum[k] += share * light[k]);
        }
        sum
    }
}

/// The nine lowest spherical harmonics, each times the square root of 4π: their mean square over
/// the sphere is 1.
fn harmonics([x, y, z]: [f32; 3]) -> [f32; 9] {
    let [root3, root5, root15] = [3f32.sqrt(), 5f32.sqrt(), 15f32.sqrt()];
    [
        1.0,
        root3 * y,
        root3 * z,
        root3 * x,
        root15 * x * y,
        root15 * y * z,
        0.5 * root5 * (3.0 * z * z - 1.0),
        root15 * x * z,
        0.5 * root15 * (x * x - y * y),
    ]
}

/// Coefficients of what a white matt surface gathers of an image: those of the image, each band
/// weakened as the cosine weakens it.
fn gathered(image: &Panorama) -> [Rgb; 9] {
    const BANDS: [f32; 9] = [1.0, 2.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0, 0.25, 0.25, 0.25, 0.25, 0.25];

    // Take the mean apart: the harmonics of other bands, added up at the middles of texels, are not
    // quite 0 for it.
    let (mut mean, mut whole) = ([0.0; 3], 0.0);
    for (_, color, part) in image.parts() {
        (0..3).for_each(|k| mean[k] += color[k] * part);
        whole += part;
    }
    let mean = mean.map(|sum| sum / whole);

    // Add up the rest by harmonics.
    let mut sums = [[0.0; 3]; 9];
    for (direction, color, part) in image.parts() {
        for (sum, (basis, band)) in sums.iter_mut().zip(harmonics(direction).into_iter().zip(BANDS))
        {
            (0..3).for_each(|k| sum[k] += (color[k] - mean[k]) * basis * band * part);
        }
    }
    (0..3).for_each(|k| sums[0][k] += mean[k]);
    sums
}

/// The surroundings of a picture, in the space of shading.
#[derive(Clone, Debug)]
pub struct EnvironmentLight {
    map: Arc<EnvironmentMap>,
    /// Rows of the matrix from the space of shading to the image's.
    image_from_shading: [[f32; 3]; 3],
    /// Factors of the diffuse and of the mirrored light.
    factors: [f32; 2],
}

impl EnvironmentLight {
    /// Light from `map`, turned, its diffuse and its mirrored part multiplied.
    pub fn new(
        map: Arc<EnvironmentMap>,
        image_from_shading: [[f32; 3]; 3],
        factors: [f32; 2],
    ) -> Self {
        Self { map, image_from_shading, factors }
    }

    /// What is seen in a direction (unit, space of shading).
    pub fn seen(&self, direction: [f32; 3]) -> Rgb {
        self.map.radiance(self.turned(direction), 0.0).map(|c| c * self.factors[1])
    }

    /// What a white matt surface with this normal reflects, and what a white mirror of this
    /// roughness shows in a direction (both unit).
    pub fn arriving(&self, normal: [f32; 3], direction: [f32; 3], roughness: f32) -> [Rgb; 2] {
        let [diffuse, mirrored] = self.factors;
        let gathered = self.map.gathered(self.turned(normal)).map(|c| c * diffuse);
        [gathered, self.map.radiance(self.turned(direction), roughness).map(|c| c * mirrored)]
    }

    /// The diffuse and the mirrored light of a point. `arriving` is [`Self::arriving`], lane by
    /// lane.
    #[inline(always)]
    pub fn reflected<T: Lanes>(
        s: &Surface<T>,
        m: &Microfacet<T>,
        arriving: impl FnOnce(V3<T>, V3<T>, T) -> [V3<T>; 2],
    ) -> [V3<T>; 2] {
        let share = mirrored_share(s, m);
        let [gathered, mirrored] = arriving(s.n, reflect(s.n, s.v), m.roughness.saturate());
        let matt = m.base_color.scale(-m.metallic.saturate() + 1.0).times(share.map(
            #[inline(always)]
            |share| -share + 1.0,
        ));
        [matt.times(gathered).scale(m.occlusion), share.times(mirrored).scale(m.occlusion)]
    }

    fn turned(&self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        self.image_from_shading.map(|row| row[0] * x + row[1] * y + row[2] * z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(color: impl Fn([f32; 3]) -> Rgb) -> EnvironmentMap {
        EnvironmentMap::new(Panorama::by_direction(128, 64, color), [128, 64])
    }

    fn directions() -> impl Iterator<Item = [f32; 3]> {
        let round = |i: usize| {
            V3::splat(0.0f32, [(i % 5) as f32 - 2.1, (i % 7) as f32 - 3.2, (i % 3) as f32 - 0.9])
        };
        (0..105).map(move |i| round(i).normalize().to_array())
    }

    #[test]
    fn in_even_surroundings_everything_is_as_bright_as_they_are() {
        let white = map(|_| [1.0, 0.5, 0.25]);
        for direction in directions() {
            let close = |a: Rgb| a.iter().zip([1.0, 0.5, 0.25]).all(|(a, b)| (a - b).abs() < 1e-4);
            assert!(close(white.gathered(direction)), "{:?}", white.gathered(direction));
            assert!((0..=20).all(|r| close(white.radiance(direction, r as f32 / 20.0))));
        }
        // A white dielectric neither takes nor adds light; a metal has its colour.
        let even = EnvironmentLight::new(
            Arc::new(map(|_| [1.0; 3])),
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            [1.0; 2],
        );
        let n = V3::new(0.0f32, 0.0, 1.0);
        for (metallic, roughness) in [(0.0, 0.0), (0.0, 0.3), (0.0, 1.0), (1.0, 0.4)] {
            for cos in [1.0f32, 0.5, 0.1] {
                let s = Surface { position: n, n, v: V3::new((1.0 - cos * cos).sqrt(), 0.0, cos) };
                let m = Microfacet {
                    base_color: V3::new(1.0f32, 1.0, 1.0),
                    metallic,
                    roughness,
                    occlusion: 1.0,
                };
                let [matt, mirrored] =
                    EnvironmentLight::reflected(&s, &m, |n, towards, roughness| {
                        even.arriving(n.to_array(), towards.to_array(), roughness)
                            .map(V3::from_array)
                    });
                assert!(
                    (matt.x + mirrored.x - 1.0).abs() < 1e-3,
                    "{metallic} {roughness} {cos}: {matt:?} {mirrored:?}"
                );
            }
        }
    }

    #[test]
    fn a_matt_surface_gathers_by_the_cosine() {
        // Radiance 1 + y: the mean over the hemisphere round n, weighted by the cosine, is 1 + 2/3
        // n.y.
        let sloped = map(|[_, y, _]| [1.0 + y, 0.0, 0.0]);
        for n in directions() {
            let expected = 1.0 + 2.0 / 3.0 * n[1];
            assert!(
                (sloped.gathered(n)[0] - expected).abs() < 5e-3,
                "{n:?}: {:?}",
                sloped.gathered(n)
            );
        }
        // Half a sphere of light gives half of it to a wall, all to the floor.
        let sky = map(|[_, y, _]| [if y > 0.0 { 1.0 } else { 0.0 }; 3]);
        assert!((sky.gathered([1.0, 0.0, 0.0])[0] - 0.5).abs() < 0.01);
        assert!((sky.gathered([0.0, 1.0, 0.0])[0] - 1.0).abs() < 0.07);
    }

    #[test]
    fn roughness_spreads_a_lamp_and_keeps_its_light() {
        // A lamp about 11 degrees wide, straight ahead.
        let lamp = map(|[_, _, z]| [if z < -0.995 { 100.0 } else { 0.0 }; 3]);
        let ahead = |roughness| lamp.radiance([0.0, 0.0, -1.0], roughness)[0];
        let aside = |roughness| lamp.radiance([0.5, 0.0, -(0.75f32).sqrt()], roughness)[0];
        assert!(ahead(0.0) > 99.0 && aside(0.0) == 0.0 && aside(0.25) < 0.5);
        let steps: Vec<f32> = (0..=8).map(|i| ahead(i as f32 / 8.0)).collect();
        assert!(steps.windows(2).all(|w| w[1] < w[0] + 0.5), "{steps:?}");
        assert!(aside(0.6) > 1.0 && ahead(1.0) < 5.0, "{} {steps:?}", aside(0.6));
        // The mean over all directions stays: 100 times the lamp's part of the sphere, 0.0025.
        for level in &lamp.levels {
            let mean: f32 = level.parts().map(|(_, color, part)| color[0] * part).sum();
            assert!((mean - 0.25).abs() < 0.06, "{mean}");
        }
    }

    #[test]
    fn between_levels_light_is_mixed() {
        let map = map(|[x, y, z]| [x.max(0.0), y.max(0.0), z.max(0.0)]);
        let towards = [0.6, 0.64, 0.48];
        let [a, half, b] = [0.25, 0.3125, 0.375].map(|r| map.radiance(towards, r));
        assert!((0..3).all(|k| (half[k] - 0.5 * (a[k] + b[k])).abs() < 1e-6));
        assert_eq!(map.radiance(towards, 7.0), map.radiance(towards, 1.0));
    }
}
