//! Illuminating points of one object and material, eight at a time.

use super::FrameConstants;
use super::facets::{FacetTable, Record, Subject, Viewing};
use super::frame_constants::{MaterialConstants, TextureConstants};
use super::geometry::{F, Slots, Surface, blend, constant, gather, surface};
use super::hits::{Along, Hit};
use super::points::{Group, Points};
use super::{flat, gouraud, hits, phong, shadowed};
use crate::radiosity::Solution;
use crate::shadow::Place;
use crate::transparency::{filtered, kay, linear};
use crate::{Shading, Transparency};
use vitral_light::{
    DIELECTRIC_F0, Illumination, Material, Microfacet, Phong, PreparedLight, Reflectance, Reflected, Rgb,
    constant_color, cook_torrance, microfacet_from_phong, phong_from_microfacet,
};
use vitral_math::DVec3;
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, LANES, Simd, V3};
use vitral_scene::{Attribute, Mesh};

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

/// Reflection coefficients at eight points.
pub(crate) enum Coefficients<S: Simd> {
    Empirical(Phong<F<S>>),
    Microfacet(Microfacet<F<S>>),
}

/// The lights of a frame and the way to use them.
pub(crate) struct Lighting<'a> {
    lights: &'a [PreparedLight],
    ambient: Rgb,
    illumination: Illumination,
    perspective: bool,
    /// The rays that see the points, if it is not the eye.
    along: Option<&'a Along>,
    /// Which part of each colour of each light arrives at each point; empty without shadows.
    arriving: Vec<[[f32; LANES]; 3]>,
}

impl Lighting<'_> {
    /// Light reflected towards the viewer; position and unit normal in view space.
    pub(crate) fn reflect<S: Simd>(
        &self,
        simd: S,
        position: &V3<F<S>>,
        n: &V3<F<S>>,
        coefficients: &Coefficients<S>,
    ) -> Reflected<F<S>> {
        simd.vectorize(
            #[inline(always)]
            || {
                let one = constant(simd, 1.0);
                let v = match self.along {
                    Some(along) => (along.origin(simd) - *position).normalize(),
                    None if self.perspective => (-*position).normalize(),
                    None => V3::splat(one, [0.0, 0.0, 1.0]),
                };
                let surface = vitral_light::Surface { position: *position, n: *n, v };
                let lit = lanes::inlined(
                    #[inline(always)]
                    |j: usize| match self.arriving.get(j) {
                        Some([r, g, b]) => {
                            let lanes = |part| F32x8::from_slice(simd, part);
                            V3::new(lanes(r), lanes(g), lanes(b))
                        }
                        None => V3::new(one, one, one),
                    },
                );
                match coefficients {
                    Coefficients::Empirical(k) => {
                        vitral_light::phong(self.illumination, self.lights, self.ambient, &surface, k, lit)
                    }
                    Coefficients::Microfacet(m) => cook_torrance(self.lights, self.ambient, &surface, m, lit),
                }
            },
        )
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
        let place = Place { position: DVec3::ZERO, normal: DVec3::ZERO, facet: u32::MAX, seed: 0 };
        Self { normal: [0.0; 3], mirror: [0.0; 3], place }
    }
}

impl Lit {
    /// Makes room for `count` points.
    pub(crate) fn reset(&mut self, count: usize, constants: &FrameConstants<'_>) {
        let filtered = constants.transparency == Transparency::Filtered;
        self.colors.clear();
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
            *color = constants.background[(place[1] as usize).min(constants.background.len() - 1)];
        }
        return;
    }
    for group in &points.groups {
        let order = &points.order[group.start as usize..group.end as usize];
        let (subject, material) = subject(group, constants);
        facets.fill(simd, points, order, &subject);
        for (eight, records) in order.chunks(LANES).zip(facets.of_point.chunks(LANES)) {
            let slots = slots(points, eight, records, subject.first_facet);
            shade_eight(simd, &subject, material, eight, &slots, &facets.records, constants, None, lit);
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
        for eight in order.chunks(LANES) {
            together.clear();
            together.extend(eight.iter().map(|&p| hits[p as usize]));
            let (slots, along) = hits::prepare(simd, &subject, &together, &mut records);
            shade_eight(simd, &subject, material, eight, &slots, &records, constants, Some(&along), lit);
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
    };
    let instance = &constants.instances[group.instance as usize];
    let subject = Subject {
        mesh,
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
fn shade_eight<S: Simd>(
    simd: S,
    subject: &Subject<'_>,
    material: &MaterialConstants<'_>,
    eight: &[u32],
    slots: &Slots,
    records: &[Record],
    constants: &FrameConstants<'_>,
    along: Option<&Along>,
    lit: &mut Lit,
) {
    simd.vectorize(
        #[inline(always)]
        || shade_eight_inlined(simd, subject, material, eight, slots, records, constants, along, lit),
    );
}

#[inline(always)]
fn shade_eight_inlined<S: Simd>(
    simd: S,
    subject: &Subject<'_>,
    material: &MaterialConstants<'_>,
    eight: &[u32],
    slots: &Slots,
    records: &[Record],
    constants: &FrameConstants<'_>,
    along: Option<&Along>,
    lit: &mut Lit,
) {
    let (mesh, instance) = (subject.mesh, subject.instance);
    let surface = surface(simd, records, slots);
    let mut looks = Looks::new(simd, mesh, slots, &surface, material, constants.raw);
    looks.let_through(simd, &surface, material, constants, along);

    let lighting = Lighting {
        lights: &constants.lights,
        ambient: constants.ambient,
        illumination: match material.model {
            Model::Empirical(illumination) => illumination,
            _ => Illumination::Phong,
        },
        perspective: subject.viewing.perspective,
        along,
        arriving: match material.model {
            Model::Empirical(_) | Model::Microfacet => {
                shadowed::arriving(constants, subject, slots, &surface, along, &mut lit.shadow_rays)
            }
            _ => Vec::new(),
        },
    };
    let mut reflected = match material.model {
        Model::Own => Reflected { diffuse: looks.own(simd, material), specular: V3::splat(looks.alpha, [0.0; 3]) },
        Model::Constant(color) => {
            let color = V3::splat(looks.alpha, color);
            Reflected { diffuse: color.times(looks.base), specular: V3::splat(looks.alpha, [0.0; 3]) }
        }
        Model::Empirical(_) | Model::Microfacet => match constants.shading {
            Shading::Phong => {
                let k = looks.coefficients(simd, material, looks.base);
                let normal = looks.mapped_normal(simd, mesh, slots, &surface, material);
                phong::shade(simd, &surface, normal, &lighting, &k)
            }
            Shading::Flat => {
                let k = looks.coefficients(simd, material, looks.base);
                let faces = constants.view.session.faces(subject.mesh_index);
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
    let mut color = (reflected.diffuse + reflected.specular + emitted).scale(looks.alpha);
    if constants.transparency == Transparency::Filtered && material.blend {
        color = (reflected.diffuse + emitted).scale(looks.alpha) + reflected.specular.scale(looks.coverage);
        let passes = filtered::passes(looks.coverage, looks.kt, material.material.filter);
        let soa = [passes.x.to_array(), passes.y.to_array(), passes.z.to_array()];
        for (lane, &p) in eight.iter().enumerate() {
            lit.passes[p as usize] = [soa[0][lane], soa[1][lane], soa[2][lane]];
        }
    } else if constants.transparency == Transparency::Filtered {
        let gap = linear::opacity(looks.alpha).to_array();
        eight.iter().enumerate().for_each(|(lane, &p)| lit.passes[p as usize] = [gap[lane]; 3]);
    }
    if material.follows && !lit.bounces.is_empty() {
        let normal = match constants.shading {
            Shading::Flat => surface.facet_normal,
            _ => looks
                .mapped_normal(simd, mesh, slots, &surface, material)
                .unwrap_or_else(|| phong::interpolated_normal(&surface)),
        };
        let mirror = looks.mirror(simd, material).scale(looks.coverage);
        let places = match along {
            Some(along) => along.places,
            None => shadowed::world_places(constants, subject, slots, shadowed::weights(&surface)),
        };
        let soa = [normal, mirror].map(|v| [v.x.to_array(), v.y.to_array(), v.z.to_array()]);
        for (lane, &p) in eight.iter().enumerate() {
            let [normal, mirror] = soa.map(|v| v.map(|channel| channel[lane]));
            lit.bounces[p as usize] = Bounce { normal, mirror, place: places[lane] };
        }
    }
    let soa = [color.x.to_array(), color.y.to_array(), color.z.to_array(), looks.alpha.to_array()];
    for (lane, &p) in eight.iter().enumerate() {
        lit.colors[p as usize] = [soa[0][lane], soa[1][lane], soa[2][lane], soa[3][lane]];
    }
}

/// What arrives at eight points from other surfaces.
#[inline(always)]
fn irradiance<S: Simd>(
    simd: S,
    solution: &Solution,
    subject: &Subject<'_>,
    slots: &Slots,
    surface: &Surface<S>,
) -> V3<F<S>> {
    // Which side is seen? The facet's normal was turned to it.
    let [a, b, c] = surface.positions;
    let turned = (b - a).cross(c - a).dot(surface.facet_normal).to_array();
    let weights = shadowed::weights(surface);
    let mut soa = [[0.0; LANES]; 3];
    for lane in 0..LANES {
        let front = (turned[lane] >= 0.0) != subject.instance.mirrored;
        let facet = subject.first_facet + slots.triangle[lane];
        let light = solution.irradiance(facet, weights.map(|w| w[lane]), front);
        (0..3).for_each(|k| soa[k][lane] = light[k]);
    }
    V3::new(F32x8::from_slice(simd, &soa[0]), F32x8::from_slice(simd, &soa[1]), F32x8::from_slice(simd, &soa[2]))
}

/// What textures and vertex colours make of a material at eight points.
struct Looks<S: Simd> {
    /// Texture colour alone.
    texture: V3<F<S>>,
    /// Texture colour times vertex colour: multiplies the diffuse or base colour.
    base: V3<F<S>>,
    /// Vertex colours at the three corners.
    corner_colors: [V3<F<S>>; 3],
    specular: V3<F<S>>,
    emission: V3<F<S>>,
    metallic_factor: F<S>,
    roughness_factor: F<S>,
    /// How much of the ambient light arrives.
    occlusion: F<S>,
    /// How much of the point textures and vertex colours leave of the surface.
    coverage: F<S>,
    /// Transmission of the surface where it is.
    kt: F<S>,
    /// Opacity, both together.
    alpha: F<S>,
}

impl<S: Simd> Looks<S> {
    #[inline(always)]
    fn new(
        simd: S,
        mesh: &Mesh,
        slots: &Slots,
        surface: &Surface<S>,
        material: &MaterialConstants<'_>,
        raw: bool,
    ) -> Self {
        let one = constant(simd, 1.0);
        let white = V3::new(one, one, one);
        let lookup = lanes::inlined(
            #[inline(always)]
            |texture: &Option<TextureConstants<'_>>| match texture {
                Some(t) => sample(simd, mesh, slots, surface, t),
                None => None,
            },
        );

        // Vertex colours are kept linear; the raw colour space wants them as they were in the file.
        let (mut corner_colors, mut vertex_color, mut alpha) = ([white; 3], white, one);
        if let Some(attribute) = &mesh.colors {
            let corners = gather_attribute(simd, attribute, mesh, slots);
            for c in 0..3 {
                let [r, g, b, _] = corners[c];
                corner_colors[c] = V3::new(r, g, b);
                if raw {
                    let encode = lanes::Lanes::srgb_from_linear;
                    corner_colors[c] = V3::new(encode(r), encode(g), encode(b));
                }
            }
            vertex_color = super::geometry::blend3(&surface.weights, &corner_colors);
            alpha = blend(&surface.weights, [corners[0][3], corners[1][3], corners[2][3]]);
        }

        let base_texture = lookup(&material.base);
        let mut texture = white;
        if let Some(t) = &base_texture {
            texture = V3::new(t[0], t[1], t[2]);
            alpha *= t[3];
        }
        if let Some(t) = lookup(&material.opacity) {
            alpha *= t[0];
        }
        // Only blended surfaces have degrees of opacity; Kay's model changes it later.
        let opacity = material.material.opacity;
        let coverage = lanes::Lanes::saturate(alpha);
        let kt = constant(simd, if material.blend { linear::opacity(opacity) } else { 0.0 });
        let alpha = lanes::Lanes::saturate(alpha * opacity);
        let alpha = match (material.cutoff, material.blend) {
            (Some(cutoff), _) => {
                let gone = lanes::Lanes::lt(alpha, constant(simd, cutoff));
                gone.select(constant(simd, 0.0), one)
            }
            (None, true) => alpha,
            (None, false) => one,
        };
        let mut emission = V3::splat(one, material.material.emission);
        if let Some([r, g, b, _]) = lookup(&material.emission) {
            emission = emission.times(V3::new(r, g, b));
        }
        let mut specular = white;
        if let Some([r, g, b, _]) = lookup(&material.specular) {
            specular = V3::new(r, g, b);
        }
        let (mut metallic_factor, mut roughness_factor) = (one, one);
        if let Some([_, g, b, _]) = lookup(&material.metallic_roughness) {
            (metallic_factor, roughness_factor) = (b, g);
        }
        let mut occlusion = one;
        if let Some([r, ..]) = lookup(&material.occlusion) {
            occlusion = one + (r - one) * material.material.occlusion_strength;
        }
        Self {
            texture,
            base: texture.times(vertex_color),
            corner_colors,
            specular,
            emission,
            metallic_factor,
            roughness_factor,
            occlusion,
            coverage,
            kt,
            alpha,
        }
    }

    /// Kay's model: how much light a blended surface lets through depends on how it is turned.
    #[inline(always)]
    fn let_through(
        &mut self,
        simd: S,
        surface: &Surface<S>,
        material: &MaterialConstants<'_>,
        constants: &FrameConstants<'_>,
        along: Option<&Along>,
    ) {
        if constants.transparency != Transparency::Kay || !material.blend {
            return;
        }
        let flat = constants.shading == Shading::Flat;
        let n = if flat { surface.facet_normal } else { phong::interpolated_normal(surface) };
        let facing = match along {
            Some(along) => {
                let position = super::geometry::blend3(&surface.weights, &surface.positions);
                n.dot((along.origin(simd) - position).normalize())
            }
            None => n.z,
        };
        let least = constant(simd, constants.kay.least);
        let least = lanes::Lanes::min(least, self.kt);
        self.kt = kay::transmission(least, self.kt, facing, constant(simd, constants.kay.exponent));
        self.alpha = self.coverage * linear::opacity(self.kt);
    }

    /// The surface's own colour.
    #[inline(always)]
    fn own(&self, simd: S, material: &MaterialConstants<'_>) -> V3<F<S>> {
        let color = match material.material.reflectance {
            Reflectance::Phong { kd, .. } => kd,
            Reflectance::MetallicRoughness { base_color, .. } => base_color,
        };
        V3::splat(constant(simd, 1.0), color).times(self.base)
    }

    /// What the mirror image is weighed with: the specular coefficient of mirrors.
    #[inline(always)]
    fn mirror(&self, simd: S, material: &MaterialConstants<'_>) -> V3<F<S>> {
        let one = constant(simd, 1.0);
        if !material.material.mirror {
            return V3::splat(one, [0.0; 3]);
        }
        match material.material.reflectance {
            Reflectance::Phong { ks, .. } => V3::splat(one, ks).times(self.specular),
            Reflectance::MetallicRoughness { base_color, metallic, .. } => {
                let metallic = lanes::Lanes::saturate(self.metallic_factor * metallic);
                let metal = V3::splat(one, base_color).times(self.base).scale(metallic);
                let dielectric = (one - metallic) * DIELECTRIC_F0;
                metal + V3::new(dielectric, dielectric, dielectric)
            }
        }
    }

    /// Coefficients for the material's model, with `color` multiplying the diffuse or base colour.
    fn coefficients(&self, simd: S, material: &MaterialConstants<'_>, color: V3<F<S>>) -> Coefficients<S> {
        simd.vectorize(
            #[inline(always)]
            || self.coefficients_inlined(simd, material, color),
        )
    }

    #[inline(always)]
    fn coefficients_inlined(&self, simd: S, material: &MaterialConstants<'_>, color: V3<F<S>>) -> Coefficients<S> {
        let one = constant(simd, 1.0);
        match (material.material.reflectance, material.model) {
            (Reflectance::Phong { ka, kd, ks, shininess }, model) => {
                let k = Phong {
                    ka: V3::splat(one, ka).times(color).scale(self.occlusion),
                    kd: V3::splat(one, kd).times(color),
                    ks: V3::splat(one, ks).times(self.specular),
                    shininess: constant(simd, shininess),
                };
                match model {
                    Model::Microfacet => {
                        let m = microfacet_from_phong(&k);
                        Coefficients::Microfacet(Microfacet { occlusion: self.occlusion, ..m })
                    }
                    _ => Coefficients::Empirical(k),
                }
            }
            (Reflectance::MetallicRoughness { base_color, metallic, roughness }, model) => {
                let m = Microfacet {
                    base_color: V3::splat(one, base_color).times(color),
                    metallic: self.metallic_factor * metallic,
                    roughness: self.roughness_factor * roughness,
                    occlusion: self.occlusion,
                };
                match model {
                    Model::Microfacet => Coefficients::Microfacet(m),
                    _ => Coefficients::Empirical(phong_from_microfacet(&m)),
                }
            }
        }
    }

    /// The shading normal bent by the normal texture, if there is one and the mesh has texture coordinates.
    fn mapped_normal(
        &self,
        simd: S,
        mesh: &Mesh,
        slots: &Slots,
        surface: &Surface<S>,
        material: &MaterialConstants<'_>,
    ) -> Option<V3<F<S>>> {
        let texture = material.normal.as_ref()?;
        simd.vectorize(
            #[inline(always)]
            || self.bend_normal(simd, mesh, slots, surface, material, texture),
        )
    }

    #[inline(always)]
    fn bend_normal(
        &self,
        simd: S,
        mesh: &Mesh,
        slots: &Slots,
        surface: &Surface<S>,
        material: &MaterialConstants<'_>,
        texture: &TextureConstants<'_>,
    ) -> Option<V3<F<S>>> {
        let texel = sample(simd, mesh, slots, surface, texture)?;
        let attribute = mesh.uvs.get(texture.reference.uv_set as usize)?;
        let uv = gather_attribute(simd, attribute, mesh, slots);
        let n = phong::interpolated_normal(surface);

        // The tangent runs along growing u, the bitangent completes a right-handed frame (glTF's convention).
        let (e1, e2) = (surface.positions[1] - surface.positions[0], surface.positions[2] - surface.positions[0]);
        let (dv1, dv2) = (uv[1][1] - uv[0][1], uv[2][1] - uv[0][1]);
        let (du1, du2) = (uv[1][0] - uv[0][0], uv[2][0] - uv[0][0]);
        let zero = constant(simd, 0.0);
        let flipped = lanes::Lanes::lt(du1 * dv2 - du2 * dv1, zero);
        let tangent = e1.scale(dv2) - e2.scale(dv1);
        let tangent = V3::select(flipped, -tangent, tangent);
        let tangent = (tangent - n.scale(n.dot(tangent))).normalize();
        let bitangent = n.cross(tangent);
        let scale = material.material.normal_scale;
        let (x, y, z) = ((texel[0] * 2.0 - 1.0) * scale, (texel[1] * 2.0 - 1.0) * scale, texel[2] * 2.0 - 1.0);
        Some((tangent.scale(x) + bitangent.scale(y) + n.scale(z)).normalize())
    }
}

/// The values of an attribute at the corners of each lane's facet.
#[inline(always)]
fn gather_attribute<S: Simd, const N: usize>(
    simd: S,
    attribute: &Attribute<[f32; N]>,
    mesh: &Mesh,
    slots: &Slots,
) -> [[F<S>; N]; 3] {
    let corners = attribute.corners.as_deref().unwrap_or(&mesh.triangles);
    gather(
        simd,
        #[inline(always)]
        |lane| {
            let [a, b, c] = corners[slots.triangle[lane] as usize];
            [attribute.values[a as usize], attribute.values[b as usize], attribute.values[c as usize]]
        },
    )
}

/// Looks a texture up at eight points; `None` if the mesh has no such texture coordinates.
fn sample<S: Simd>(
    simd: S,
    mesh: &Mesh,
    slots: &Slots,
    surface: &Surface<S>,
    t: &TextureConstants<'_>,
) -> Option<[F<S>; 4]> {
    simd.vectorize(
        #[inline(always)]
        || sample_inlined(simd, mesh, slots, surface, t),
    )
}

#[inline(always)]
fn sample_inlined<S: Simd>(
    simd: S,
    mesh: &Mesh,
    slots: &Slots,
    surface: &Surface<S>,
    t: &TextureConstants<'_>,
) -> Option<[F<S>; 4]> {
    let attribute = mesh.uvs.get(t.reference.uv_set as usize)?;
    let m = &t.reference.transform;
    let corners = gather_attribute(simd, attribute, mesh, slots);
    let coordinate = lanes::inlined(
        #[inline(always)]
        |r: usize, c: usize| corners[c][0] * m[r][0] + corners[c][1] * m[r][1] + m[r][2],
    );
    let u = [coordinate(0, 0), coordinate(0, 1), coordinate(0, 2)];
    let v = [coordinate(1, 0), coordinate(1, 1), coordinate(1, 2)];
    let here = (blend(&surface.weights, u), blend(&surface.weights, v));

    // Level of detail: the longer side of the pixel's footprint, in texels.
    let base = t.texture.levels.first()?;
    let (w, h) = (base.width() as f32, base.height() as f32);
    let [right, down] = surface.neighbours();
    let length2 = lanes::inlined(
        #[inline(always)]
        |weights: &[F<S>; 3]| {
            let (du, dv) = ((blend(weights, u) - here.0) * w, (blend(weights, v) - here.1) * h);
            du * du + dv * dv
        },
    );
    let lod = lanes::Lanes::log2(lanes::Lanes::max(length2(&right), length2(&down))) * 0.5;
    let (us, vs, lods) = (here.0.to_array(), here.1.to_array(), lod.to_array());
    let mut soa = [[0.0f32; LANES]; 4];
    for lane in 0..LANES {
        let texel = t.texture.sample(&t.reference.sampler, us[lane], vs[lane], lods[lane], t.decode);
        for k in 0..4 {
            soa[k][lane] = texel[k];
        }
    }
    Some([
        F32x8::from_slice(simd, &soa[0]),
        F32x8::from_slice(simd, &soa[1]),
        F32x8::from_slice(simd, &soa[2]),
        F32x8::from_slice(simd, &soa[3]),
    ])
}
