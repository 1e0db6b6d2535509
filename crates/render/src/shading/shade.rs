//! Illuminating points of one object and material, eight at a time.

use super::FrameConstants;
use super::batch::{ShadingBatch8, each_pair};
use super::color_only::{has_color_only, is_uniform, shade_color_only};
use super::face_table::FaceTable;
use super::facets::FacetTable;
use super::geometry::{F, Record, Surface, surface};
use super::hits::Hit;
use super::lighting::lighting;
use super::material_constants::MaterialConstants;
use super::model::Model;
use super::points::Points;
use super::shaded_points::{Bounce, ShadedPoints, premultiplied};
use super::shadowed::GroupLight;
use super::slots::Slots;
use super::subject::{Subject, subject};
use super::surface_parameters::SurfaceParameters;
use super::{depth_cue, flat, glow, gouraud, hits, phong, shadowed};
use crate::Shading;
use crate::radiosity::Solution;
use crate::shadow::SurfacePoints;
use crate::transparency::{filtered, linear};
use vitral_light::Reflected;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, LANES, Simd, V3, Widest, dispatch};

/// Illuminates all points of a tile; `facets` is memory for the records of their facets.
pub(super) fn shade(
    points: &Points,
    facets: &mut FacetTable,
    constants: &FrameConstants<'_>,
    lit: &mut ShadedPoints,
) {
    lit.reset(points.len(), constants);
    dispatch!(constants.level, simd => shade_all(simd, points, facets, constants, lit));
}

/// [`shade`] with the instructions of a level.
#[inline(always)]
fn shade_all<S: Simd>(
    simd: S,
    points: &Points,
    facets: &mut FacetTable,
    constants: &FrameConstants<'_>,
    lit: &mut ShadedPoints,
) {
    // Show the background where surfaces only hide lines.
    if constants.surfaces_are_background {
        for (color, place) in lit.colors.iter_mut().zip(&points.place) {
            *color = constants.background.color(place[1] as u32);
        }
        return;
    }

    // Shade sixteen or eight points at a time.
    let mut rays = 0;
    each_pair(
        simd,
        points,
        facets,
        constants,
        (|material: &MaterialConstants<'_>| material.model.needs_light_visibility(), &mut rays),
        #[inline(always)]
        |first, second| {
            // A second way through the same formulas is more than WebAssembly's compiler takes in
            // minutes.
            if cfg!(target_family = "wasm") {
                shade_eight(simd, first, constants, lit);
                if let Some(second) = second {
                    shade_eight(simd, second, constants, lit);
                }
                return;
            }
            let simple = has_color_only(first.material, constants);
            let uniform = simple && is_uniform(first, constants);
            match second {
                Some(second) if simple && lanes::has_sixteen(simd.level()) => {
                    shade_color_only::<S, Widest<S>>(
                        simd,
                        [first, second],
                        uniform,
                        constants,
                        lit,
                    );
                }
                _ => {
                    for eight in std::iter::once(first).chain(second) {
                        if uniform {
                            shade_color_only::<S, F32x8<S>>(simd, [eight; 2], true, constants, lit);
                        } else {
                            shade_eight(simd, eight, constants, lit);
                        }
                    }
                }
            }
        },
    );
    lit.shadow_rays += rays;
}

/// Illuminates what rays hit; `points` holds the facets in groups, `hits` the same in the same
/// order.
#[inline(always)]
pub(crate) fn shade_hits<S: Simd>(
    simd: S,
    points: &Points,
    hits: &[Hit],
    constants: &FrameConstants<'_>,
    lit: &mut ShadedPoints,
) {
    // Reuse one buffer of records and one of hits for all batches.
    let mut records = [Record([0.0; 32]); LANES];
    let mut together = Vec::with_capacity(LANES);

    for group in &points.groups {
        let order = &points.order[group.start as usize..group.end as usize];
        let (subject, material) = subject(group, constants);

        // Find which lights reach the group's hits.
        let light = if material.model.needs_light_visibility() {
            let places: SurfacePoints = order.iter().map(|&p| hits[p as usize].place).collect();
            GroupLight::of_places(
                constants,
                material.scatters.is_some(),
                places,
                &mut lit.shadow_rays,
            )
        } else {
            GroupLight::default()
        };

        // Shade eight hits at a time.
        for (i, eight) in order.chunks(LANES).enumerate() {
            together.clear();
            together.extend(eight.iter().map(|&p| hits[p as usize]));
            let (slots, along) = hits::prepare(simd, &subject, &together, &mut records);
            let (subject, along) = (&subject, Some(&along));
            let (slots, records, first) = (&slots, &records, i * LANES);
            let (light_visibility, light_visibility_behind, open) =
                (&light.seen, &light.behind, &light.open);
            let eight = ShadingBatch8 {
                subject,
                material,
                points: eight,
                slots,
                records,
                along,
                light_visibility,
                light_visibility_behind,
                open,
                first,
            };
            shade_eight(simd, &eight, constants, lit);
        }
    }
}

/// One instruction-set function: kept out of line, so that each level compiles it once.
fn shade_eight<S: Simd>(
    simd: S,
    eight: &ShadingBatch8<'_>,
    constants: &FrameConstants<'_>,
    lit: &mut ShadedPoints,
) {
    simd.vectorize(
        #[inline(always)]
        || illuminate(simd, eight, constants, lit),
    );
}

/// Illuminates up to eight points: light reflected from the lights and from other surfaces,
/// transparency, depth cueing.
#[inline(always)]
fn illuminate<S: Simd>(
    simd: S,
    eight: &ShadingBatch8<'_>,
    constants: &FrameConstants<'_>,
    lit: &mut ShadedPoints,
) {
    let &ShadingBatch8 { subject, material, slots, records, along, .. } = eight;
    let is_lit = material.model.needs_light_visibility();

    // Place the points on their facets, and let textures and vertex colours vary the
    // material.
    let mut surface = surface(simd, records, slots);
    surface.screen_linear = along.is_none() && subject.viewing.screen_linear();
    let mut parameters =
        SurfaceParameters::new(simd, subject.mesh, slots, &surface, material, constants.raw);
    parameters.let_through(simd, &surface, material, constants, along);
    parameters.occlude(simd, eight);

    // Reflect the lights, and the light of other surfaces.
    let mut reflected = reflect_lights(simd, eight, &parameters, &surface, constants);
    if let (Some(solution), true) = (constants.radiosity, is_lit) {
        let kd = parameters.coefficients(simd, material, parameters.base).diffuse_part();
        reflected.diffuse =
            reflected.diffuse + kd.times(irradiance(simd, solution, subject, slots, &surface));
    }

    // Premultiply.
    let emitted = match material.model {
        Model::Constant(_) => V3::splat(parameters.alpha, [0.0; 3]),
        _ => parameters.emission,
    };
    let filtered = constants.transparency.tints();
    let mut color = premultiplied(
        material,
        filtered,
        &reflected,
        emitted,
        parameters.alpha,
        parameters.coverage,
    );

    // Add the light that comes through translucent surfaces, and fade with the distance.
    if material.scatters.is_some() && is_lit {
        color = color + glow::glow(simd, eight, &parameters, &surface, constants);
    }
    if let Some(fade) = &constants.fade {
        let rows = &constants.background;
        color = depth_cue::faded_eight(
            simd,
            fade,
            (color, parameters.alpha),
            &surface,
            (slots, along),
            rows,
        );
    }

    // Hand on the colours, what passes of the light from behind, and how rays go on.
    lit.put_colors(simd, eight.points, [color.x, color.y, color.z, parameters.alpha]);
    if filtered {
        put_passes(eight, &parameters, lit);
    }
    if material.follows && !lit.bounces.is_empty() {
        put_bounces(simd, eight, &parameters, &surface, constants, lit);
    }
}

/// What up to eight points reflect of the lights, by the model of their material and the frame's
/// shading.
#[inline(always)]
fn reflect_lights<S: Simd>(
    simd: S,
    eight: &ShadingBatch8<'_>,
    parameters: &SurfaceParameters<S>,
    surface: &Surface<F<S>>,
    constants: &FrameConstants<'_>,
) -> Reflected<F<S>> {
    let &ShadingBatch8 { subject, material, slots, .. } = eight;
    let lighting = lighting(eight, constants);
    match material.model {
        // Take a colour that needs no lights as it is.
        Model::Own => Reflected {
            diffuse: parameters.own(simd, material),
            specular: V3::splat(parameters.alpha, [0.0; 3]),
        },
        Model::Constant(color) => {
            let color = V3::splat(parameters.alpha, color);
            Reflected {
                diffuse: color.times(parameters.base),
                specular: V3::splat(parameters.alpha, [0.0; 3]),
            }
        }

        // Evaluate the illumination model where the shading model does.
        Model::Empirical(_) | Model::Microfacet => match constants.shading {
            Shading::Phong => {
                // Evaluate at the point, with the interpolated or mapped normal.
                let k = parameters.coefficients(simd, material, parameters.base);
                let normal = parameters.mapped_normal(simd, subject, slots, surface, material);
                phong::shade(simd, surface, normal, &lighting, &k)
            }
            Shading::Flat => {
                // Evaluate with the normal of the face.
                let k = parameters.coefficients(simd, material, parameters.base);
                let faces = constants
                    .faces
                    .get_or_build(subject.mesh_index, || FaceTable::new(subject.mesh));
                flat::shade(
                    simd,
                    subject.mesh,
                    faces,
                    subject.instance,
                    slots,
                    surface,
                    &lighting,
                    &k,
                )
            }
            Shading::Gouraud => {
                // Evaluate at the corners, and interpolate the results.
                let colors = &parameters.corner_colors;
                let corners = [
                    parameters.coefficients(simd, material, colors[0]),
                    parameters.coefficients(simd, material, colors[1]),
                    parameters.coefficients(simd, material, colors[2]),
                ];
                let r = gouraud::shade(simd, surface, &lighting, &corners);
                Reflected { diffuse: r.diffuse.times(parameters.texture), specular: r.specular }
            }
        },
    }
}

/// Keeps what passes of the light from behind up to eight points, which filtered transparency
/// tints.
#[inline(always)]
fn put_passes<S: Simd>(
    eight: &ShadingBatch8<'_>,
    parameters: &SurfaceParameters<S>,
    lit: &mut ShadedPoints,
) {
    let &ShadingBatch8 { material, points, .. } = eight;
    if material.blend {
        let passes = filtered::passes(parameters.coverage, parameters.kt, material.material.filter);
        let soa = [passes.x.to_array(), passes.y.to_array(), passes.z.to_array()];
        for (lane, &p) in points.iter().enumerate() {
            lit.passes[p as usize] = [soa[0][lane], soa[1][lane], soa[2][lane]];
        }
    } else {
        let gap = linear::opacity(parameters.alpha).to_array();
        points.iter().enumerate().for_each(|(lane, &p)| lit.passes[p as usize] = [gap[lane]; 3]);
    }
}

/// Keeps how rays go on from up to eight points.
#[inline(always)]
fn put_bounces<S: Simd>(
    simd: S,
    eight: &ShadingBatch8<'_>,
    parameters: &SurfaceParameters<S>,
    surface: &Surface<F<S>>,
    constants: &FrameConstants<'_>,
    lit: &mut ShadedPoints,
) {
    let &ShadingBatch8 { subject, material, points, slots, along, .. } = eight;
    let normal = match constants.shading {
        Shading::Flat => surface.facet_normal,
        _ => parameters
            .mapped_normal(simd, subject, slots, surface, material)
            .unwrap_or_else(|| surface.interpolated_normal()),
    };
    let mirror = parameters.mirror(simd, material).scale(parameters.coverage);
    let places = match along {
        Some(along) => along.places,
        None => shadowed::world_places(simd, constants, subject, slots, &surface.place_weights()),
    };
    let soa = [normal, mirror].map(|v| [v.x.to_array(), v.y.to_array(), v.z.to_array()]);
    for (lane, &p) in points.iter().enumerate() {
        let [normal, mirror] = soa.map(|v| v.map(|channel| channel[lane]));
        lit.bounces[p as usize] = Bounce { normal, mirror, place: places[lane] };
    }
}

/// What arrives at eight points from other surfaces.
#[inline(always)]
pub(super) fn irradiance<S: Simd>(
    simd: S,
    solution: &Solution,
    subject: &Subject<'_>,
    slots: &Slots,
    surface: &Surface<F<S>>,
) -> V3<F<S>> {
    // Which side is seen? The facet's normal was turned to it.
    let [a, b, c] = surface.positions;
    let turned = (b - a).cross(c - a).dot(surface.facet_normal).to_array();
    let [a, b, c] = surface.place_weights();
    let weights = [a.to_array(), b.to_array(), c.to_array()];
    let mut soa = [[0.0; LANES]; 3];
    for lane in 0..LANES {
        let front = (turned[lane] >= 0.0) != subject.instance.mirrored;
        let facet = subject.first_facet + slots.triangle[lane];
        let light = solution.irradiance(facet, weights.map(|w| w[lane]), front);
        (0..3).for_each(|k| soa[k][lane] = light[k]);
    }
    V3::new(
        F32x8::from_slice(simd, &soa[0]),
        F32x8::from_slice(simd, &soa[1]),
        F32x8::from_slice(simd, &soa[2]),
    )
}
