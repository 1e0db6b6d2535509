//! Illuminating points of one object and material, eight at a time.

use super::FrameConstants;
use super::facets::{FacetTable, Record, Subject, Viewing};
use super::frame_constants::MaterialConstants;
use super::geometry::{F, Slots, Surface, surface};
use super::hits::{Along, Hit};
use super::lighting::{Coefficients, lighting};
use super::looks::Looks;
use super::points::{Group, Points};
use super::together::{is_simple, is_unvaried, shade_together};
use super::{flat, glow, gouraud, hits, phong, shadowed};
use crate::radiosity::Solution;
use crate::shadow::{Parts, Place, Places};
use crate::transparency::{filtered, linear};
use crate::{Shading, Transparency};
use vitral_light::{Illumination, Material, Reflected, Rgb, constant_color};
use vitral_math::DVec3;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, LANES, Lanes, Simd, V3, Widest};

/// What a material's points go through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Model {
    /// The surface's own colour, without lights: lighting is off, or the material is unlit.
    Own,
    /// Self-luminous: `I = ki`.
    Constant(Rgb),
    /// Ambient, Lambert, Phong or Blinn–Phong.
    Empirical(Illumination),
    /// Cook–Torrance.
    Microfacet,
}

/// The model that a material gets.
pub(crate) fn model(material: &Material, illumination: Illumination, lighting: bool) -> Model {
    match illumination.for_reflectance(&material.reflectance) {
        Illumination::Constant => Model::Constant(constant_color(material)),
        _ if !lighting || material.unlit => Model::Own,
        Illumination::CookTorrance => Model::Microfacet,
        other => Model::Empirical(other),
    }
}

/// What comes of a tile's points, in the space in which pictures are composed.
#[derive(Default)]
pub(crate) struct Lit {
    /// Premultiplied RGBA.
    pub colors: Vec<[f32; 4]>,
    /// What passes of the light from behind; empty where that is `1 - A` in all channels.
    pub passes: Vec<[f32; 3]>,
    /// How rays go on from there; kept for materials that let them, and empty where none are followed.
    pub bounces: Vec<Bounce>,
    /// Rays that were followed to lights.
    pub shadow_rays: u64,
}

/// How rays go on from a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounce {
    /// Unit shading normal, view space.
    pub normal: [f32; 3],
    /// What the mirror image is weighed with.
    pub mirror: Rgb,
    /// The point in the world.
    pub place: Place,
}

impl Default for Bounce {
    fn default() -> Self {
        let place = Place { position: DVec3::ZERO, normal: DVec3::ZERO, facet: u32::MAX, seed: 0, pixel: None };
        Self { normal: [0.0; 3], mirror: [0.0; 3], place }
    }
}

impl Lit {
    /// Makes room for `count` points.
    pub(crate) fn reset(&mut self, count: usize, constants: &FrameConstants<'_>) {
        let filtered = constants.transparency == Transparency::Filtered;
        // What is left from before is written over.
        self.colors.resize(count, [0.0; 4]);
        self.passes.clear();
        self.passes.resize(if filtered { count } else { 0 }, [0.0; 3]);
        self.bounces.clear();
        self.bounces.resize(if constants.follows_rays() { count } else { 0 }, Bounce::default());
        self.shadow_rays = 0;
    }
}

/// Illuminates all points.
#[inline(always)]
pub(crate) fn shade_all<S: Simd>(
    simd: S,
    points: &Points,
    facets: &mut FacetTable,
    constants: &FrameConstants<'_>,
    lit: &mut Lit,
) {
    if constants.surfaces_are_background {
        for (color, place) in lit.colors.iter_mut().zip(&points.place) {
            *color = constants.background.color(place[1] as u32);
        }
        return;
    }
    let mut rays = 0;
    each_pair(
        simd,
        points,
        facets,
        constants,
        (asks, &mut rays),
        #[inline(always)]
        |first, second| {
            // A second way through the same formulas is more than WebAssembly's compiler takes in minutes.
            if cfg!(target_family = "wasm") {
                shade_eight(simd, first, constants, lit);
                if let Some(second) = second {
                    shade_eight(simd, second, constants, lit);
                }
                return;
            }
            let simple = is_simple(first.material, constants);
            let unvaried = simple && is_unvaried(first, constants);
            match second {
                Some(second) if simple && lanes::has_sixteen(simd.level()) => {
                    shade_together::<S, Widest<S>>(simd, [first, second], unvaried, constants, lit);
                }
                _ => {
                    for eight in std::iter::once(first).chain(second) {
                        if unvaried {
                            shade_together::<S, F32x8<S>>(simd, [eight; 2], true, constants, lit);
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

/// Whether a material's look depends on what of the lights arrives.
pub(super) fn asks(material: &MaterialConstants<'_>) -> bool {
    matches!(material.model, Model::Empirical(_) | Model::Microfacet)
}

/// Up to eight points of one object and material.
pub(crate) struct Eight<'a> {
    pub subject: &'a Subject<'a>,
    pub material: &'a MaterialConstants<'a>,
    /// Indices of the points.
    pub points: &'a [u32],
    pub slots: &'a Slots,
    pub records: &'a [Record],
    /// The rays that see them, if it is not the eye.
    pub along: Option<&'a Along>,
    /// What of each light comes to all points of the group; empty without shadows, or if nobody asks.
    pub arriving: &'a [Parts],
    /// The same for the other side of a translucent sheet.
    pub arriving_behind: &'a [Parts],
    /// The place of the first point in the group.
    pub first: usize,
}

/// Goes through the points of all groups, eight at a time. `asks` says for which materials light's ways are looked at,
/// and `rays` counts those that are followed for it.
#[inline(always)]
pub(crate) fn each_eight<S: Simd>(
    simd: S,
    points: &Points,
    facets: &mut FacetTable,
    constants: &FrameConstants<'_>,
    asks_and_rays: (impl Fn(&MaterialConstants<'_>) -> bool, &mut u64),
    mut visit: impl FnMut(&Eight<'_>),
) {
    each_pair(
        simd,
        points,
        facets,
        constants,
        asks_and_rays,
        #[inline(always)]
        |first, second| {
            visit(first);
            second.into_iter().for_each(&mut visit);
        },
    );
}

/// [`each_eight`], two at a time where a group has two more.
#[inline(always)]
fn each_pair<S: Simd>(
    simd: S,
    points: &Points,
    facets: &mut FacetTable,
    constants: &FrameConstants<'_>,
    (asks, rays): (impl Fn(&MaterialConstants<'_>) -> bool, &mut u64),
    mut visit: impl FnMut(&Eight<'_>, Option<&Eight<'_>>),
) {
    for group in &points.groups {
        let order = &points.order[group.start as usize..group.end as usize];
        let (subject, material) = subject(group, constants);
        facets.fill(simd, points, order, &subject);
        let [arriving, behind] = if asks(material) {
            shadowed::arriving(simd, constants, (&subject, material), points, order, facets, rays)
        } else {
            [Vec::new(), Vec::new()]
        };
        for (i, (order, records)) in order.chunks(2 * LANES).zip(facets.of_point.chunks(2 * LANES)).enumerate() {
            let count = order.len().min(LANES);
            let ((mine, next), (my_records, next_records)) = (order.split_at(count), records.split_at(count));
            let eight = |points, slots, first| Eight {
                subject: &subject,
                material,
                points,
                slots,
                records: &facets.records,
                along: None,
                arriving: &arriving,
                arriving_behind: &behind,
                first,
            };
            let place = 2 * LANES * i;
            let my_slots = slots(points, mine, my_records, subject.first_facet);
            let mine = eight(mine, &my_slots, place);
            if next.is_empty() {
                visit(&mine, None);
            } else {
                let next_slots = slots(points, next, next_records, subject.first_facet);
                visit(&mine, Some(&eight(next, &next_slots, place + LANES)));
            }
        }
    }
}

/// Illuminates what rays hit; `points` holds the facets in groups, `hits` the same in the same order.
#[inline(always)]
pub(crate) fn shade_hits<S: Simd>(
    simd: S,
    points: &Points,
    hits: &[Hit],
    constants: &FrameConstants<'_>,
    lit: &mut Lit,
) {
    let mut records = [Record([0.0; 32]); LANES];
    let mut together = Vec::with_capacity(LANES);
    for group in &points.groups {
        let order = &points.order[group.start as usize..group.end as usize];
        let (subject, material) = subject(group, constants);
        let [arriving, behind] = if asks(material) {
            let places: Places = order.iter().map(|&p| hits[p as usize].place).collect();
            shadowed::arriving_on_sides(constants, material.scatters.is_some(), places, &mut lit.shadow_rays)
        } else {
            [Vec::new(), Vec::new()]
        };
        for (i, eight) in order.chunks(LANES).enumerate() {
            together.clear();
            together.extend(eight.iter().map(|&p| hits[p as usize]));
            let (slots, along) = hits::prepare(simd, &subject, &together, &mut records);
            let (subject, along) = (&subject, Some(&along));
            let (slots, records, arriving, first) = (&slots, &records, &arriving, i * LANES);
            let arriving_behind = &behind;
            let eight =
                Eight { subject, material, points: eight, slots, records, along, arriving, arriving_behind, first };
            shade_eight(simd, &eight, constants, lit);
        }
    }
}

/// The object that a group's points belong to, and its material.
pub(crate) fn subject<'a>(
    group: &Group,
    constants: &'a FrameConstants<'_>,
) -> (Subject<'a>, &'a MaterialConstants<'a>) {
    let world_instance = &constants.view.session.world.instances[group.instance as usize];
    let mesh = &*world_instance.mesh;
    let material = constants.material(mesh.parts[group.part as usize].material);
    let viewing = Viewing {
        interpolation: constants.interpolation,
        perspective: constants.view.view.perspective,
        double_sided: material.material.double_sided,
        layered: material.is_layered(),
    };
    let instance = &constants.instances[group.instance as usize];
    let normal_set = material.normal.as_ref().map(|texture| texture.reference.uv_set);
    let subject = Subject {
        mesh,
        tangents: normal_set.and_then(|set| constants.view.session.tangents(world_instance.mesh_index, set)),
        instance,
        first_facet: world_instance.first_facet,
        mesh_index: world_instance.mesh_index,
        instance_index: group.instance,
        viewing,
    };
    (subject, material)
}

/// The slots of up to eight points of a group.
#[inline(always)]
pub(crate) fn slots(points: &Points, eight: &[u32], records: &[u32], first_facet: u32) -> Slots {
    let mut slots = Slots { triangle: [0; LANES], record: [0; LANES], x: [0.0; LANES], y: [0.0; LANES] };
    if let (&[first, .., last], Ok(records)) = (eight, records.try_into())
        && last - first == LANES as u32 - 1
        && let (Some(facets), Some(places)) = (
            points.facet[first as usize..].first_chunk::<LANES>(),
            points.place[first as usize..].first_chunk::<LANES>(),
        )
    {
        // Neighbours, as where a tile shows one object only.
        slots.triangle = facets.map(|facet| facet - first_facet);
        slots.record = records;
        for lane in 0..LANES {
            [slots.x[lane], slots.y[lane]] = places[lane];
        }
        return slots;
    }
    for lane in 0..LANES {
        let here = lane.min(eight.len() - 1);
        let p = eight[here] as usize;
        slots.triangle[lane] = points.facet[p] - first_facet;
        slots.record[lane] = records[here];
        [slots.x[lane], slots.y[lane]] = points.place[p];
    }
    slots
}

/// One instruction-set function: kept out of line, so that each level compiles it once.
fn shade_eight<S: Simd>(simd: S, eight: &Eight<'_>, constants: &FrameConstants<'_>, lit: &mut Lit) {
    simd.vectorize(
        #[inline(always)]
        || illuminate(simd, eight, constants, lit),
    );
}

#[inline(always)]
fn illuminate<S: Simd>(simd: S, eight: &Eight<'_>, constants: &FrameConstants<'_>, lit: &mut Lit) {
    let &Eight { subject, material, points, slots, records, along, .. } = eight;
    let (mesh, instance) = (subject.mesh, subject.instance);
    let mut surface = surface(simd, records, slots);
    surface.screen_linear = along.is_none() && subject.viewing.screen_linear();
    let mut looks = Looks::new(simd, mesh, slots, &surface, material, constants.raw);
    looks.let_through(simd, &surface, material, constants, along);

    let lighting = lighting(eight, constants);
    let mut reflected = match material.model {
        Model::Own => Reflected { diffuse: looks.own(simd, material), specular: V3::splat(looks.alpha, [0.0; 3]) },
        Model::Constant(color) => {
            let color = V3::splat(looks.alpha, color);
            Reflected { diffuse: color.times(looks.base), specular: V3::splat(looks.alpha, [0.0; 3]) }
        }
        Model::Empirical(_) | Model::Microfacet => match constants.shading {
            Shading::Phong => {
                let k = looks.coefficients(simd, material, looks.base);
                let normal = looks.mapped_normal(simd, subject, slots, &surface, material);
                phong::shade(simd, &surface, normal, &lighting, &k)
            }
            Shading::Flat => {
                let k = looks.coefficients(simd, material, looks.base);
                let faces = constants.faces.get_or_build(subject.mesh_index, || flat::FaceTable::new(mesh));
                flat::shade(simd, mesh, faces, instance, slots, &surface, &lighting, &k)
            }
            Shading::Gouraud => {
                let colors = &looks.corner_colors;
                let corners = [
                    looks.coefficients(simd, material, colors[0]),
                    looks.coefficients(simd, material, colors[1]),
                    looks.coefficients(simd, material, colors[2]),
                ];
                let r = gouraud::shade(simd, &surface, &lighting, &corners);
                Reflected { diffuse: r.diffuse.times(looks.texture), specular: r.specular }
            }
        },
    };

    // Light from other surfaces.
    if let (Some(solution), Model::Empirical(_) | Model::Microfacet) = (constants.radiosity, material.model) {
        let kd = match looks.coefficients(simd, material, looks.base) {
            Coefficients::Empirical(k) => k.kd,
            Coefficients::Microfacet(m) => m.base_color.scale(-m.metallic + 1.0),
        };
        reflected.diffuse = reflected.diffuse + kd.times(irradiance(simd, solution, subject, slots, &surface));
    }

    // Premultiply and hand on.
    let emitted = match material.model {
        Model::Constant(_) => V3::splat(looks.alpha, [0.0; 3]),
        _ => looks.emission,
    };
    let filtered = constants.transparency == Transparency::Filtered;
    let color = premultiplied(material, filtered, &reflected, emitted, looks.alpha, looks.coverage);
    if filtered && material.blend {
        let passes = filtered::passes(looks.coverage, looks.kt, material.material.filter);
        let soa = [passes.x.to_array(), passes.y.to_array(), passes.z.to_array()];
        for (lane, &p) in points.iter().enumerate() {
            lit.passes[p as usize] = [soa[0][lane], soa[1][lane], soa[2][lane]];
        }
    } else if filtered {
        let gap = linear::opacity(looks.alpha).to_array();
        points.iter().enumerate().for_each(|(lane, &p)| lit.passes[p as usize] = [gap[lane]; 3]);
    }
    let color = match (material.scatters, material.model) {
        (Some(_), Model::Empirical(_) | Model::Microfacet) => {
            color + glow::glow(simd, eight, &looks, &surface, constants)
        }
        _ => color,
    };
    let color = match &constants.fade {
        Some(fade) => fade.faded_eight(simd, (color, looks.alpha), &surface, (slots, along), &constants.background),
        None => color,
    };
    if material.follows && !lit.bounces.is_empty() {
        let normal = match constants.shading {
            Shading::Flat => surface.facet_normal,
            _ => looks
                .mapped_normal(simd, subject, slots, &surface, material)
                .unwrap_or_else(|| phong::interpolated_normal(&surface)),
        };
        let mirror = looks.mirror(simd, material).scale(looks.coverage);
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
    put_colors(simd, points, [color.x, color.y, color.z, looks.alpha], lit);
}

/// What a surface reflects and shines, premultiplied.
#[inline(always)]
pub(super) fn premultiplied<T: Lanes>(
    material: &MaterialConstants<'_>,
    filtered: bool,
    reflected: &Reflected<T>,
    emitted: V3<T>,
    alpha: T,
    coverage: T,
) -> V3<T> {
    if material.blend && (filtered || material.material.glass) {
        (reflected.diffuse + emitted).scale(alpha) + reflected.specular.scale(coverage)
    } else {
        (reflected.diffuse + reflected.specular + emitted).scale(alpha)
    }
}

/// Hands the colours of up to eight points on: red, green, blue, alpha.
#[inline(always)]
pub(super) fn put_colors<S: Simd>(simd: S, points: &[u32], [r, g, b, a]: [F<S>; 4], lit: &mut Lit) {
    lanes::rows_of_columns(
        simd,
        [r.bitcast(), g.bitcast(), b.bitcast(), a.bitcast()],
        #[inline(always)]
        |lane, row| {
            if let Some(&p) = points.get(lane) {
                lit.colors[p as usize] = bytemuck::cast(row);
            }
        },
    );
}

/// What arrives at eight points from other surfaces.
#[inline(always)]
fn irradiance<S: Simd>(
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
    V3::new(F32x8::from_slice(simd, &soa[0]), F32x8::from_slice(simd, &soa[1]), F32x8::from_slice(simd, &soa[2]))
}
