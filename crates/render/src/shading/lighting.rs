//! What points reflect of the lights of a frame.
//!
//! In:   positions, normals and coefficients, eight or sixteen; lights in view space. Out: light
//!       towards the viewer.
//! Cost: linear in points, times the number of lights.

use super::FrameConstants;
use super::batch::ShadingBatch8;
use super::geometry::every;
use super::hits::Along;
use super::model::Model;
use crate::shadow::LightVisibility;
use vitral_light::{
    EnvironmentLight, Illumination, Microfacet, Phong, PreparedLight, Reflected, Rgb, Sky, Surface,
    cook_torrance,
};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, Floats, LANES, Lanes, Simd, V3};

/// Reflection coefficients at points, a lane each.
pub(crate) enum Coefficients<T> {
    Empirical(Phong<T>),
    Microfacet(Microfacet<T>),
}

/// Numbers of [`Coefficients`].
pub(super) const NUMBERS: usize = 10;

impl<T: Lanes> Coefficients<T> {
    /// As numbers; those of the microfacets are fewer, and the last is repeated.
    #[inline(always)]
    pub(super) fn numbers(&self) -> [T; NUMBERS] {
        match self {
            Self::Empirical(Phong { ka, kd, ks, shininess }) => {
                [ka.x, ka.y, ka.z, kd.x, kd.y, kd.z, ks.x, ks.y, ks.z, *shininess]
            }
            Self::Microfacet(Microfacet {
                base_color: b,
                metallic: m,
                roughness: r,
                occlusion: o,
            }) => [b.x, b.y, b.z, *m, *r, *o, *o, *o, *o, *o],
        }
    }

    /// The part of light from everywhere that is reflected diffusely.
    #[inline(always)]
    pub(super) fn diffuse_part(&self) -> V3<T> {
        match self {
            Self::Empirical(k) => k.kd,
            Self::Microfacet(m) => m.base_color.scale(-m.metallic + 1.0),
        }
    }

    /// The way back.
    #[inline(always)]
    pub(super) fn from_numbers(model: Model, n: [T; NUMBERS]) -> Self {
        match model {
            Model::Microfacet => Self::Microfacet(Microfacet {
                base_color: V3::new(n[0], n[1], n[2]),
                metallic: n[3],
                roughness: n[4],
                occlusion: n[5],
            }),
            _ => Self::Empirical(Phong {
                ka: V3::new(n[0], n[1], n[2]),
                kd: V3::new(n[3], n[4], n[5]),
                ks: V3::new(n[6], n[7], n[8]),
                shininess: n[9],
            }),
        }
    }
}

/// The lights of a frame and the way to use them.
pub(crate) struct Lighting<'a> {
    lights: &'a [PreparedLight],
    ambient: Rgb,
    /// What polished surfaces mirror, where rays do not show it.
    sky: Option<&'a Sky>,
    /// The image of the surroundings, and whether it is mirrored here.
    environment: Option<(&'a EnvironmentLight, bool)>,
    illumination: Illumination,
    perspective: bool,
    /// The rays that see the points, if it is not the eye.
    along: Option<&'a Along>,
    /// Which part of each light reaches the group's points; empty without shadows.
    light_visibility: &'a [LightVisibility],
    /// The first of the eight points in the group.
    first: usize,
}

/// Unit vector from a position (view space) to the eye, or to where the rays come from.
#[inline(always)]
pub(crate) fn towards_viewer<S: Simd, V: Floats<S>>(
    simd: S,
    position: &V3<V>,
    along: Option<&Along>,
    perspective: bool,
) -> V3<V> {
    match along {
        Some(along) => {
            let origin = V::by_eights(
                simd,
                [],
                #[inline(always)]
                |_, []| along.origin(simd).to_array(),
            );
            (V3::from_array(origin) - *position).normalize()
        }
        None if perspective => (-*position).normalize(),
        None => V3::splat(every(simd, 1.0), [0.0, 0.0, 1.0]),
    }
}

impl Lighting<'_> {
    /// Light reflected towards the viewer; position and unit normal in view space.
    pub(crate) fn reflect<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        position: &V3<V>,
        n: &V3<V>,
        coefficients: &Coefficients<V>,
    ) -> Reflected<V> {
        simd.vectorize(
            #[inline(always)]
            || {
                let one = every(simd, 1.0);
                // As in `shade_all`.
                if !cfg!(target_family = "wasm") && self.light_visibility.is_empty() {
                    // Factors of 1 that are known to be that are left out.
                    let all = lanes::inlined(
                        #[inline(always)]
                        |_: usize| V3::new(one, one, one),
                    );
                    return self.reflect_of(simd, position, n, coefficients, all);
                }
                let lit = lanes::inlined(
                    #[inline(always)]
                    |j: usize| match self.light_visibility.get(j) {
                        Some(parts) => V3::from_array(V::by_eights(
                            simd,
                            [],
                            #[inline(always)]
                            |lane, []| parts.eight(simd, self.first + lane).to_array(),
                        )),
                        None => V3::new(one, one, one),
                    },
                );
                self.reflect_of(simd, position, n, coefficients, lit)
            },
        )
    }

    /// [`Self::reflect`] of light of which `lit` says how much arrives.
    #[inline(always)]
    fn reflect_of<S: Simd, V: Floats<S>>(
        &self,
        simd: S,
        position: &V3<V>,
        n: &V3<V>,
        coefficients: &Coefficients<V>,
        lit: impl Fn(usize) -> V3<V>,
    ) -> Reflected<V> {
        // Set up the surface, with the direction to the viewer.
        let v = towards_viewer(simd, position, self.along, self.perspective);
        let surface = Surface { position: *position, n: *n, v };
        match coefficients {
            Coefficients::Empirical(k) => {
                // Evaluate the empirical model, with what rounding may add to the cosine of a
                // light.
                let grazing = lanes::inlined(
                    #[inline(always)]
                    |light: &PreparedLight| light.direction_rounding(*position),
                );
                vitral_light::phong(
                    self.illumination,
                    self.lights,
                    self.ambient,
                    &surface,
                    k,
                    lit,
                    grazing,
                )
            }
            Coefficients::Microfacet(m) => {
                // Evaluate the microfacet model, and add what the sky and the environment
                // contribute.
                let mut reflected = cook_torrance(self.lights, self.ambient, &surface, m, lit);
                if let Some(sky) = self.sky {
                    reflected.specular = reflected.specular + sky.mirrored(&surface, m);
                }
                if let Some((environment, is_mirrored)) = self.environment {
                    let [diffuse, mirrored] = of_surroundings(simd, environment, &surface, m);
                    reflected.diffuse = reflected.diffuse + diffuse;
                    if is_mirrored {
                        reflected.specular = reflected.specular + mirrored;
                    }
                }
                reflected
            }
        }
    }
}

/// The diffuse and the mirrored light of the surroundings.
#[inline(never)]
fn of_surroundings<S: Simd, V: Floats<S>>(
    simd: S,
    environment: &EnvironmentLight,
    surface: &Surface<V>,
    m: &Microfacet<V>,
) -> [V3<V>; 2] {
    let lookup = |n: V3<V>, towards: V3<V>, roughness: V| {
        let arriving = V::by_eights(
            simd,
            [n.x, n.y, n.z, towards.x, towards.y, towards.z, roughness],
            |_, eight| {
                let eight = eight.map(|number| number.to_array());
                let mut found = [[0.0; LANES]; 6];
                for lane in 0..LANES {
                    let at = |k: usize| [eight[k][lane], eight[k + 1][lane], eight[k + 2][lane]];
                    let [gathered, mirrored] = environment.arriving(at(0), at(3), eight[6][lane]);
                    (0..3).for_each(|k| {
                        (found[k][lane], found[k + 3][lane]) = (gathered[k], mirrored[k])
                    });
                }
                found.map(|number| F32x8::from_slice(simd, &number))
            },
        );
        let [a, b, c, d, e, f] = arriving;
        [V3::new(a, b, c), V3::new(d, e, f)]
    };
    EnvironmentLight::reflected(surface, m, lookup)
}

/// The lights of a frame for some points and those that follow in their group.
#[inline(always)]
pub(super) fn lighting<'a>(
    eight: &ShadingBatch8<'a>,
    constants: &'a FrameConstants<'_>,
) -> Lighting<'a> {
    Lighting {
        lights: &constants.lights,
        ambient: constants.ambient,
        sky: constants.sky.as_ref().filter(|_| eight.material.mirrors_sky),
        environment: constants
            .environment
            .as_ref()
            .map(|image| (image, eight.material.mirrors_sky)),
        illumination: match eight.material.model {
            Model::Empirical(illumination) => illumination,
            _ => Illumination::Phong,
        },
        perspective: eight.subject.viewing.perspective,
        along: eight.along,
        light_visibility: eight.light_visibility,
        first: eight.first,
    }
}
