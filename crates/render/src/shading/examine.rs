//! Takes the shading of one pixel apart: the same steps as for a tile, with the numbers in between.
//!
//! In:   a tile's facets, what lies in front of them, the pixel. Out: its [`PixelLight`].
//! Cost: that of shading a few points.

use super::FrameConstants;
use super::batch::{ShadingBatch8, each_eight};
use super::collect::InFront;
use super::composite::{mean, opaque_of_pixel};
use super::face_table::FaceTable;
use super::facets::FacetTable;
use super::fragments::fragment;
use super::geometry::{F, Placed, Surface, blend3, surface};
use super::glow::glow;
use super::lighting::{Coefficients, towards_viewer};
use super::material_constants::MaterialConstants;
use super::model::Model;
use super::pixel_light::{
    CoefficientValues, DepthCueTerms, Evaluation, LayerLight, NumberedTerms, PixelLight,
    PointLight, SampleLight, ShadowOfLight,
};
use super::points::{NO_POINT, Points, Source};
use super::shade::{irradiance, shade};
use super::shaded_points::ShadedPoints;
use super::surface_parameters::SurfaceParameters;
use super::{flat, phong, shadowed};
use crate::Shading;
use crate::display::encode;
use crate::marks::MarkColors;
use crate::raytrace::triangles::Triangles;
use crate::shadow::{Occluders, SurfacePoint, blocker};
use crate::transparency::MOST_SAMPLES;
use vitral_light::{
    EnvironmentLight, Illumination, Light, Microfacet, Phong, Reflected, Rgb, ambient_term,
    microfacet_terms, phong_terms, sum_of_terms,
};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{Lanes, Simd, V3, dispatch};
use vitral_raster::{Layer, NO_FACET, SUBPIXEL, TILE, TILE_PIXELS, Tile};

/// What the pixels of a picture are examined with.
pub(crate) struct Examination<'a> {
    pub constants: &'a FrameConstants<'a>,
    pub marks: &'a MarkColors,
    /// The lights of the scene, world space.
    pub lights: &'a [Light],
    /// What keeps light from points, where there are shadows.
    pub occluders: &'a Occluders<'a>,
}

impl Examination<'_> {
    /// Examines the pixel with this number in its tile.
    pub(crate) fn pixel(&self, tile: &Tile, layers: &[Layer], pixel: usize) -> PixelLight {
        // Leave the pixel alone in the tile.
        let (mut alone, samples) = (tile.clone(), self.constants.view.pattern.len());
        alone.facet.fill(NO_FACET);
        for at in (0..samples).map(|s| s * TILE_PIXELS + pixel).filter(|&at| at < tile.facet.len())
        {
            alone.facet[at] = tile.facet[at];
        }
        let layers: Vec<Layer> =
            layers.iter().filter(|l| l.at as usize % TILE_PIXELS == pixel).copied().collect();

        // Shade it, and take apart how.
        let (mut points, mut facets, mut lit) =
            (Points::default(), FacetTable::default(), ShadedPoints::default());
        points.collect(&alone, InFront::Samples(&layers), self.constants, self.marks);
        points.ground = self.constants.ground_shadow(&alone);
        shade(&points, &mut facets, self.constants, &mut lit);
        let mut found = vec![None; points.len()];
        if !self.constants.surfaces_are_background {
            dispatch!(self.constants.level, simd => self.points(simd, &points, &mut facets, &lit, &mut found));
        }
        let numbers = Numbers::of(&found);
        self.compose(&alone, &points, &lit, pixel, &numbers, found.into_iter().flatten().collect())
    }

    #[inline(always)]
    fn points<S: Simd>(
        &self,
        simd: S,
        points: &Points,
        facets: &mut FacetTable,
        lit: &ShadedPoints,
        found: &mut [Option<PointLight>],
    ) {
        let mut rays = 0;
        let asks = |material: &MaterialConstants<'_>| material.model.needs_light_visibility();
        each_eight(simd, points, facets, self.constants, (asks, &mut rays), |eight| {
            self.eight(simd, eight, points, lit, found);
        });
    }

    /// Examines up to eight points.
    fn eight<S: Simd>(
        &self,
        simd: S,
        eight: &ShadingBatch8<'_>,
        points: &Points,
        lit: &ShadedPoints,
        found: &mut [Option<PointLight>],
    ) {
        let &ShadingBatch8 { subject, material, slots, records, .. } = eight;
        let constants = self.constants;

        // Place the points and vary the material, as for a picture.
        let mut surface = surface(simd, records, slots);
        surface.screen_linear = subject.viewing.screen_linear();
        let mut parameters =
            SurfaceParameters::new(simd, subject.mesh, slots, &surface, material, constants.raw);
        parameters.let_through(simd, &surface, material, constants, None);
        parameters.occlude(simd, eight);
        let places =
            shadowed::world_places(simd, constants, subject, slots, &surface.place_weights());

        // Evaluate the model where the shading model does.
        let wanted = self.evaluations(simd, eight, &surface, &parameters);

        // Find the interreflected light, the glow of translucent sheets, and colours without
        // lights.
        let received = constants.radiosity.filter(|_| material.model.needs_light_visibility()).map(
            |solution| {
                let k = parameters.coefficients(simd, material, parameters.base);
                k.diffuse_part().times(irradiance(simd, solution, subject, slots, &surface))
            },
        );
        let shines = material.scatters.is_some() && material.model.needs_light_visibility();
        let glow = shines.then(|| glow(simd, eight, &parameters, &surface, constants));
        let own = unlit_color(simd, material, &parameters);

        // Take each lane by itself.
        for (lane, &p) in eight.points.iter().enumerate() {
            let number = |v: F<S>| v.to_array()[lane];
            let triple = |v: V3<F<S>>| [number(v.x), number(v.y), number(v.z)];
            let visibility: Vec<Rgb> =
                eight.light_visibility.iter().map(|parts| parts.get(eight.first + lane)).collect();
            let evaluations: Vec<_> =
                wanted.iter().map(|w| self.evaluate(w, material, lane, &visibility)).collect();
            let emission = match material.model {
                Model::Constant(_) => [0.0; 3],
                _ => triple(parameters.emission),
            };

            // Sum up the depth cue and the reflected light.
            let row = points.place[p as usize][1] as u32;
            let depth_cue = constants.fade.as_ref().map(|fade| DepthCueTerms {
                kept: fade.kept(-number(surface.position().z)),
                into: fade.into(constants.background.color(row)),
            });
            let place = &places[lane];
            let weights = surface.weights.map(number);
            let reflected = match own.map(triple) {
                Some(own) => {
                    Reflected { diffuse: V3::from_array(own), specular: V3::from_array([0.0; 3]) }
                }
                None => together(&evaluations, weights, triple(parameters.texture)),
            };

            // Collect everything.
            let filtered = constants.transparency.tints();
            found[p as usize] = Some(PointLight {
                facet: points.facet[p as usize],
                at: points.place[p as usize],
                world: (place.position + Triangles::center_of(&constants.view.session.world))
                    .to_array(),
                weights,
                model: model_name(material.model),
                shading: constants.shading.name(),
                shadows: self.shadows(&visibility, place),
                evaluations,
                texture: triple(parameters.texture),
                base: triple(parameters.base),
                diffuse: reflected.diffuse.to_array(),
                specular: reflected.specular.to_array(),
                interreflection: received.map(triple),
                emission,
                alpha: number(parameters.alpha),
                coverage: number(parameters.coverage),
                keeps_specular: material.blend && (filtered || material.material.glass),
                glow: glow.map(triple),
                depth_cue,
                color: lit.colors[p as usize],
            });
        }
    }

    /// Where the model is evaluated for up to eight points, and with what; nowhere without lights.
    fn evaluations<S: Simd>(
        &self,
        simd: S,
        eight: &ShadingBatch8<'_>,
        surface: &Surface<F<S>>,
        parameters: &SurfaceParameters<S>,
    ) -> Vec<Wanted<S>> {
        let &ShadingBatch8 { subject, material, slots, .. } = eight;

        // Models without lights are not evaluated.
        if !material.model.needs_light_visibility() {
            return Vec::new();
        }

        // Set up an evaluation at a single place, towards the viewer.
        let viewer =
            |position: &V3<F<S>>| towards_viewer(simd, position, None, subject.viewing.perspective);
        let of_point = |placed: Placed<F<S>>| {
            let v = viewer(&placed.position);
            vec![Wanted {
                corner: None,
                placed,
                v,
                coefficients: parameters.coefficients(simd, material, parameters.base),
                weight: parameters.alpha.splat(1.0),
            }]
        };

        // Evaluate where the shading model does: at the point, on the face, or at the corners.
        match self.constants.shading {
            Shading::Phong => of_point(phong::placed(
                surface,
                parameters.mapped_normal(simd, subject, slots, surface, material),
            )),
            Shading::Flat => {
                let mesh = subject.mesh;
                let faces =
                    self.constants.faces.get_or_build(subject.mesh_index, || FaceTable::new(mesh));
                of_point(flat::placed(simd, (mesh, faces), subject.instance, slots, surface))
            }
            Shading::Gouraud => {
                let corner = |k: usize| Wanted {
                    corner: Some(k as u8),
                    placed: Placed {
                        position: surface.positions[k],
                        normal: surface.normals[k].normalize(),
                    },
                    v: viewer(&surface.positions[k]),
                    coefficients: parameters.coefficients(
                        simd,
                        material,
                        parameters.corner_colors[k],
                    ),
                    weight: surface.weights[k],
                };
                [0, 1, 2].map(corner).into()
            }
        }
    }

    /// Evaluates the model in one lane, light by light.
    fn evaluate<S: Simd>(
        &self,
        wanted: &Wanted<S>,
        material: &MaterialConstants<'_>,
        lane: usize,
        visibility: &[Rgb],
    ) -> Evaluation {
        let constants = self.constants;

        // Take the lane's surface and coefficients.
        let number = |v: F<S>| v.to_array()[lane];
        let triple = |v: V3<F<S>>| V3::new(number(v.x), number(v.y), number(v.z));
        let Placed { position, normal } = wanted.placed;
        let s = vitral_light::Surface {
            position: triple(position),
            n: triple(normal),
            v: triple(wanted.v),
        };
        let coefficients =
            Coefficients::from_numbers(material.model, wanted.coefficients.numbers().map(number));
        let seen = |j: usize| visibility.get(j).copied().unwrap_or([1.0; 3]);

        // Evaluate each light's terms.
        let lights = constants.lights.iter().enumerate();
        let microfacet = match &coefficients {
            Coefficients::Microfacet(m) => Some(*m),
            Coefficients::Empirical(_) => None,
        };
        let (terms, ambient, coefficients): (Vec<_>, _, _) = match coefficients {
            Coefficients::Empirical(k) => {
                let model = match material.model {
                    Model::Empirical(illumination) => illumination,
                    _ => Illumination::Phong,
                };
                let terms =
                    lights.map(|(j, light)| phong_terms(model, light, &s, &k, seen(j))).collect();
                let Phong { ka, kd, ks, shininess } = k;
                let [ka, kd, ks] = [ka, kd, ks].map(V3::to_array);
                let values = CoefficientValues::Empirical { ka, kd, ks, shininess };
                (terms, ambient_term(ka, constants.ambient), values)
            }
            Coefficients::Microfacet(m) => {
                let terms =
                    lights.map(|(j, light)| microfacet_terms(light, &s, &m, seen(j))).collect();
                let Microfacet { base_color, metallic, roughness, occlusion } = m;
                let ambient =
                    ambient_term(base_color.scale(occlusion).to_array(), constants.ambient);
                let base_color = base_color.to_array();
                (
                    terms,
                    ambient,
                    CoefficientValues::Microfacet { base_color, metallic, roughness, occlusion },
                )
            }
        };

        // Find what the surroundings add.
        let (gathered, environment) = self.environment_terms(material, &s, microfacet);

        // Sum the terms of the lights and the surroundings.
        let mut sum = sum_of_terms(ambient, &terms);
        gathered.into_iter().for_each(|gathered| sum.diffuse = sum.diffuse + gathered);
        environment.into_iter().for_each(|mirrored| sum.specular = sum.specular + mirrored);

        // Collect the terms.
        let lights = constants.light_numbers.iter().zip(terms);
        Evaluation {
            corner: wanted.corner,
            weight: number(wanted.weight),
            position: s.position.to_array(),
            normal: s.n.to_array(),
            viewer: s.v.to_array(),
            coefficients,
            ambient,
            lights: lights.map(|(&light, terms)| NumberedTerms { light, terms }).collect(),
            gathered: gathered.map(V3::to_array),
            environment: environment.map(V3::to_array),
            diffuse: sum.diffuse.to_array(),
            specular: sum.specular.to_array(),
        }
    }

    /// The diffuse and the mirrored light of the surroundings, which only microfacets reflect.
    fn environment_terms(
        &self,
        material: &MaterialConstants<'_>,
        s: &vitral_light::Surface<f32>,
        microfacet: Option<Microfacet<f32>>,
    ) -> (Option<V3<f32>>, Option<V3<f32>>) {
        let sky = self.constants.sky.filter(|_| material.mirrors_sky);
        match (sky, &self.constants.environment, microfacet) {
            (Some(sky), _, Some(m)) => (None, Some(sky.mirrored(s, &m))),
            (None, Some(image), Some(m)) => {
                let [gathered, mirrored] =
                    EnvironmentLight::reflected(s, &m, |n, towards, roughness| {
                        image
                            .arriving(n.to_array(), towards.to_array(), roughness)
                            .map(V3::from_array)
                    });
                (Some(gathered), Some(mirrored).filter(|_| material.mirrors_sky))
            }
            _ => (None, None),
        }
    }

    /// The shadow of each light at a place.
    fn shadows(&self, visibility: &[Rgb], place: &SurfacePoint) -> Vec<ShadowOfLight> {
        let session = self.constants.view.session;
        let of_light = |(&light, &visibility): (&usize, &Rgb)| {
            let mut shadow =
                ShadowOfLight { light, visibility, attached: false, blocker: None, distance: None };
            if visibility == [1.0; 3] {
                return shadow;
            }
            shadow.attached =
                faces_away(&self.lights[light], place, Triangles::center_of(&session.world));
            let found = blocker(session, self.occluders, &self.lights[light], place)
                .filter(|_| !shadow.attached);
            (shadow.blocker, shadow.distance) = (found.map(|b| b.facet), found.map(|b| b.distance));
            shadow
        };
        self.constants.light_numbers.iter().zip(visibility).map(of_light).collect()
    }

    /// Makes the pixel of its points.
    fn compose(
        &self,
        tile: &Tile,
        points: &Points,
        lit: &ShadedPoints,
        pixel: usize,
        numbers: &Numbers,
        explained: Vec<PointLight>,
    ) -> PixelLight {
        // Find the pixel's surface and background.
        let (constants, count) = (self.constants, self.constants.view.pattern.len());
        let (x, y) = (tile.x + (pixel % TILE) as u32, tile.y + (pixel / TILE) as u32);
        let source = points.pixels.first().map_or(Source::Point(NO_POINT), |p| p.source);
        let background = points.background(tile, pixel, &constants.background);
        let behind =
            |point: u32| if point == NO_POINT { background } else { lit.colors[point as usize] };

        // Lay the layers over the opaque samples.
        let mut below = [[0.0; 4]; MOST_SAMPLES];
        let below = &mut below[..count];
        opaque_of_pixel(source, points, behind, below);
        let opaque = below.to_vec();
        let color_of = |f| fragment(f, tile, points, lit, constants, self.marks);
        let fragments: Vec<_> = points.fragments.iter().map(color_of).collect();
        if !fragments.is_empty() {
            (constants.lay)(&fragments, below);
        }

        // Describe each sample with its layers.
        let sample = |s: usize| {
            let point = match source {
                Source::Point(point) => point,
                Source::Mixed(start) => points.mixed[start as usize + s],
            };
            let over = points.fragments.iter().zip(&fragments).filter(|(f, _)| f.covers(s as u32));
            let layer = |(f, colored): (
                &super::points::FragmentPoint,
                &crate::transparency::Fragment<'_>,
            )| LayerLight {
                point: (!f.is_mark).then(|| numbers.number(f.source)).flatten(),
                depth: points.depth(f, s as u32),
                color: colored.color,
                passes: colored.passes,
            };
            let mut layers: Vec<_> = over.map(layer).collect();
            layers.sort_by(|a, b| b.depth.total_cmp(&a.depth));
            let [right, down] =
                constants.view.pattern.position(s).map(|p| p as f32 / SUBPIXEL as f32);
            SampleLight {
                at: [x as f32 + right, y as f32 + down],
                point: numbers.number(point),
                behind: opaque[s],
                layers,
                color: below[s],
            }
        };
        let samples = (0..count).map(sample).collect();

        // One point that fills the pixel is its own mean.
        let average = match source {
            Source::Point(_) if fragments.is_empty() => opaque[0],
            _ => mean(below.iter().copied()),
        };
        finished(explained, samples, average, constants)
    }
}

/// The colour of a material whose model needs no lights.
#[inline(always)]
fn unlit_color<S: Simd>(
    simd: S,
    material: &MaterialConstants<'_>,
    parameters: &SurfaceParameters<S>,
) -> Option<V3<F<S>>> {
    match material.model {
        Model::Own => Some(parameters.own(simd, material)),
        Model::Constant(color) => Some(V3::splat(parameters.alpha, color).times(parameters.base)),
        Model::Empirical(_) | Model::Microfacet => None,
    }
}

/// Where a model is evaluated for up to eight points, and with what.
struct Wanted<S: Simd> {
    corner: Option<u8>,
    placed: Placed<F<S>>,
    v: V3<F<S>>,
    coefficients: Coefficients<F<S>>,
    weight: F<S>,
}

/// The numbers of the points that were taken apart.
struct Numbers(Vec<Option<usize>>);

impl Numbers {
    fn of(found: &[Option<PointLight>]) -> Self {
        let mut next = 0..;
        Self(found.iter().map(|point| point.as_ref().and_then(|_| next.next())).collect())
    }

    fn number(&self, point: u32) -> Option<usize> {
        self.0.get(point as usize).copied().flatten()
    }
}

/// What a point reflects by its evaluations: the only one, or those of the corners, weighed, times
/// the texture.
fn together(evaluations: &[Evaluation], weights: [f32; 3], texture: Rgb) -> Reflected<f32> {
    let of = |e: &Evaluation| [V3::from_array(e.diffuse), V3::from_array(e.specular)];
    match evaluations {
        [a, b, c] => {
            let [a, b, c] = [of(a), of(b), of(c)];
            let blended = [0, 1].map(|k| blend3(&weights, &[a[k], b[k], c[k]]));
            Reflected { diffuse: blended[0].times(V3::from_array(texture)), specular: blended[1] }
        }
        [only, ..] => Reflected {
            diffuse: V3::from_array(only.diffuse),
            specular: V3::from_array(only.specular),
        },
        [] => Reflected { diffuse: V3::from_array([0.0; 3]), specular: V3::from_array([0.0; 3]) },
    }
}

/// Encodes the mean of the samples.
fn finished(
    points: Vec<PointLight>,
    samples: Vec<SampleLight>,
    average: [f32; 4],
    constants: &FrameConstants<'_>,
) -> PixelLight {
    // Divide by alpha.
    let [r, g, b, alpha] = average;
    let inverse = match alpha {
        1.0.. => 1.0,
        _ if alpha > 0.0 => 1.0 / alpha,
        _ => 0.0,
    };
    let straight = [r * inverse, g * inverse, b * inverse];

    // Encode the channels.
    let encode_one = |channel: f32| {
        let channel = channel.clamp(0.0, 1.0);
        if constants.raw { channel * 255.0 } else { Lanes::srgb_from_linear(channel) * 255.0 }
    };
    let [r, g, b] = straight.map(encode_one);
    let mut bytes = [[0; 4]];
    encode(constants.level, &[0], &[average], constants.raw, &mut bytes);
    PixelLight {
        points,
        samples,
        average,
        straight,
        clamped: straight.iter().any(|c| !(0.0..=1.0).contains(c)),
        encoded: [r, g, b, alpha.clamp(0.0, 1.0) * 255.0],
        bytes: bytes[0],
    }
}

/// Whether the facet of a place faces away from a light.
fn faces_away(light: &Light, place: &SurfacePoint, center: vitral_math::DVec3) -> bool {
    use vitral_light::{AreaShape, LightKind};
    let at = |p: vitral_math::DVec3| place.normal.dot(p - center - place.position) <= 0.0;
    match &light.kind {
        LightKind::Ambient => false,
        LightKind::Directional { direction } => place.normal.dot(-*direction) <= 0.0,
        LightKind::Point { position } | LightKind::Spot { position, .. } => at(*position),
        // A part of a light with a shape may still be above the horizon.
        LightKind::Area { shape: AreaShape::Disc { center: middle, normal, radius } } => {
            let tilt = place.normal.dot(normal.normalize_or_zero());
            let above = place.normal.dot(*middle - center - place.position);
            above + radius * (1.0 - tilt * tilt).max(0.0).sqrt() <= 0.0
        }
        LightKind::Area { shape: AreaShape::Polygon { corners } } => {
            corners.iter().all(|&corner| at(corner))
        }
    }
}

/// The name of a formula.
fn model_name(model: Model) -> &'static str {
    match model {
        Model::Own => "own",
        Model::Constant(_) => "constant",
        Model::Empirical(illumination) => illumination.name(),
        Model::Microfacet => Illumination::CookTorrance.name(),
    }
}
