//! The vertex stages, eight vertices at a time: eye coordinates, normal, lighting, texture
//! coordinates, fog.
//!
//! In:   attributes of a batch, the snapshot of the state. Out: a record for each vertex, see
//!       [`Layout`].
//! Source: OpenGL 1.5 specification, sections 2.11 to 2.14 and 3.10.

use super::snapshot::{
    FogSource, Generation, LightingSnapshot, Tracked, Transform, UnitSnapshot, VertexSnapshot,
};
use crate::state::MaterialFace;
use crate::vertex::VertexBatch;
use vitral_light::{Illumination, Phong, Reflected, Surface, phong};
use vitral_math::lanes::prelude::*;
use vitral_math::lanes::{self, F32x8, LANES, Simd, V3};
use vitral_raster::forward::Layout;

type F<S> = F32x8<S>;
type F4<S> = [F32x8<S>; 4];

/// Up to eight vertices to be shaded.
pub(crate) struct VertexBatch8<'a> {
    /// Numbers in the batch; unused lanes repeat one.
    pub vertices: [u32; LANES],
    /// How many there are.
    pub count: usize,
    pub batch: &'a VertexBatch,
    /// All have the same.
    pub transform: &'a Transform,
    /// Only asked with lighting.
    pub faces: &'a LaneFaces,
}

/// One side's materials of eight vertices, by component.
#[derive(Clone)]
pub(crate) struct LaneFace {
    ambient: [[f32; LANES]; 3],
    /// With alpha.
    diffuse: [[f32; LANES]; 4],
    specular: [[f32; LANES]; 3],
    emission: [[f32; LANES]; 3],
    shininess: [f32; LANES],
    /// No specular colour anywhere.
    dull: bool,
}

impl LaneFace {
    fn new(each: &[&[MaterialFace; 2]; LANES], side: usize) -> Self {
        fn rows<const N: usize>(
            each: &[&[MaterialFace; 2]; LANES],
            side: usize,
            color: impl Fn(&MaterialFace) -> [f32; 4],
        ) -> [[f32; LANES]; N] {
            let colors = each.map(|faces| color(&faces[side]));
            std::array::from_fn(|k| colors.map(|c| c[k]))
        }
        let specular = rows(each, side, |m| m.specular);
        Self {
            ambient: rows(each, side, |m| m.ambient),
            diffuse: rows(each, side, |m| m.diffuse),
            specular,
            emission: rows(each, side, |m| m.emission),
            shininess: each.map(|faces| faces[side].shininess),
            dull: specular == [[0.0; LANES]; 3],
        }
    }
}

/// Materials of eight vertices.
#[derive(Clone)]
pub(crate) struct LaneFaces {
    front: LaneFace,
    /// With two-sided lighting.
    back: Option<LaneFace>,
}

impl LaneFaces {
    /// Those that were given with some vertices, or those of the snapshot.
    pub(crate) fn new(
        snapshot: &VertexSnapshot,
        batch: &VertexBatch,
        vertices: &[u32; LANES],
    ) -> Self {
        let (current, two_side) = match &snapshot.lighting {
            Some(lighting) => (&lighting.material, lighting.two_side),
            None => (&[MaterialFace::default(); 2], false),
        };
        // Each vertex may have its own.
        let mut near = vertices[0] as usize;
        let each = vertices.map(|v| batch.material(v, &mut near).unwrap_or(current));
        let back = two_side.then(|| LaneFace::new(&each, 1));
        Self { front: LaneFace::new(&each, 0), back }
    }
}

#[inline(always)]
fn splat<S: Simd>(simd: S, v: f32) -> F<S> {
    <F<S> as SimdBase<S>>::splat(simd, v)
}

#[inline(always)]
fn gather<S: Simd, const N: usize>(simd: S, of: &[[f32; N]], vertices: &[u32; LANES]) -> [F<S>; N] {
    let mut soa = [[0.0f32; LANES]; N];
    for lane in 0..LANES {
        let v = of[vertices[lane] as usize];
        for k in 0..N {
            soa[k][lane] = v[k];
        }
    }
    let mut out = [splat(simd, 0.0); N];
    for k in 0..N {
        out[k] = F32x8::from_slice(simd, &soa[k]);
    }
    out
}

/// An attribute, or its current value.
#[inline(always)]
fn attribute<S: Simd, const N: usize>(
    simd: S,
    of: &Option<Vec<[f32; N]>>,
    current: [f32; N],
    vertices: &[u32; LANES],
) -> [F<S>; N] {
    match of {
        Some(values) => gather(simd, values, vertices),
        None => {
            let mut out = [splat(simd, 0.0); N];
            for k in 0..N {
                out[k] = splat(simd, current[k]);
            }
            out
        }
    }
}

#[inline(always)]
fn transform<S: Simd>(m: &[f32; 16], p: &F4<S>) -> F4<S> {
    let row = lanes::inlined(
        #[inline(always)]
        |r: usize| p[0] * m[r] + p[1] * m[4 + r] + p[2] * m[8 + r] + p[3] * m[12 + r],
    );
    [row(0), row(1), row(2), row(3)]
}

#[inline(always)]
fn dot4<S: Simd>(plane: &[f32; 4], p: &F4<S>) -> F<S> {
    p[0] * plane[0] + p[1] * plane[1] + p[2] * plane[2] + p[3] * plane[3]
}

/// A colour, brought into `0..=1` if it is to be clamped.
#[inline(always)]
fn limited<S: Simd>(clamps: bool, color: F4<S>) -> F4<S> {
    if clamps { saturate4(color) } else { color }
}

#[inline(always)]
fn saturate4<S: Simd>(c: F4<S>) -> F4<S> {
    let s = lanes::inlined(
        #[inline(always)]
        |v: F<S>| lanes::Lanes::saturate(v),
    );
    [s(c[0]), s(c[1]), s(c[2]), s(c[3])]
}

/// The specular colour, where it is kept apart.
type Secondary<S> = Option<V3<F<S>>>;

/// A vertex as the rasteriser or feedback wants it.
pub(crate) struct Shaded<S: Simd> {
    pub color: F4<S>,
    pub secondary: Secondary<S>,
    pub back: Option<(F4<S>, Secondary<S>)>,
    pub fog: F<S>,
}

/// Shades up to eight vertices into `records`; record `i` begins at `i * layout.stride`.
/// `inverse_w` is theirs.
pub(crate) fn shade<S: Simd>(
    simd: S,
    snapshot: &VertexSnapshot,
    layout: &Layout,
    eight: &VertexBatch8<'_>,
    inverse_w: &[f32; LANES],
    records: &mut [f32],
) {
    simd.vectorize(
        #[inline(always)]
        || {
            let stride = layout.stride;
            let put = lanes::inlined(
                #[inline(always)]
                |records: &mut [f32], at: usize, value: F<S>| {
                    let value = value.to_array();
                    for lane in 0..eight.count {
                        records[lane * stride + at] = value[lane];
                    }
                },
            );
            for lane in 0..eight.count {
                records[lane * stride] = inverse_w[lane];
            }

            // Transform positions and normals to eye space, and light them.
            let position: F4<S> = gather(simd, &eight.batch.positions, &eight.vertices);
            let eye = transform(&eight.transform.modelview, &position);
            let normal = eye_normal(simd, snapshot, eight);
            let shaded = colors(simd, snapshot, eight, &eye, normal);
            for k in 0..4 {
                put(records, layout.color + k, shaded.color[k]);
            }

            // Store the other colours that the draw needs.
            if let (Some(at), Some(c)) = (layout.secondary, shaded.secondary) {
                put(records, at, c.x);
                put(records, at + 1, c.y);
                put(records, at + 2, c.z);
            }
            if let (Some(at), Some((c, _))) = (layout.back_color, &shaded.back) {
                for k in 0..4 {
                    put(records, at + k, c[k]);
                }
            }
            if let (Some(at), Some((_, Some(c)))) = (layout.back_secondary, &shaded.back) {
                put(records, at, c.x);
                put(records, at + 1, c.y);
                put(records, at + 2, c.z);
            }

            // Store the fog coordinate.
            if let Some(at) = layout.fog {
                put(records, at, shaded.fog);
            }

            // Generate or fetch texture coordinates, and transform them.
            for unit in &snapshot.units {
                if let Some(at) = layout.tex[unit.index] {
                    let coords = texture(simd, snapshot, unit, eight, &position, &eye, normal);
                    for k in 0..4 {
                        put(records, at + k, coords[k]);
                    }
                }
            }
        },
    );
}

/// The front colours of up to eight vertices alone.
pub(crate) fn front_colors<S: Simd>(
    simd: S,
    snapshot: &VertexSnapshot,
    eight: &VertexBatch8<'_>,
) -> [[f32; LANES]; 4] {
    simd.vectorize(
        #[inline(always)]
        || {
            let position: F4<S> = gather(simd, &eight.batch.positions, &eight.vertices);
            let eye = transform(&eight.transform.modelview, &position);
            let normal = eye_normal(simd, snapshot, eight);
            let [r, g, b, a] = colors(simd, snapshot, eight, &eye, normal).color;
            [r.to_array(), g.to_array(), b.to_array(), a.to_array()]
        },
    )
}

/// The normal in eye space, if anything needs it.
#[inline(always)]
fn eye_normal<S: Simd>(simd: S, snapshot: &VertexSnapshot, eight: &VertexBatch8<'_>) -> V3<F<S>> {
    let generates = snapshot
        .units
        .iter()
        .flat_map(|u| &u.generation)
        .any(|g| matches!(g, Generation::Sphere | Generation::Reflection | Generation::Normal));
    if snapshot.lighting.is_none() && !generates {
        return V3::splat(splat(simd, 0.0), [0.0, 0.0, 1.0]);
    }
    let [x, y, z] = attribute(simd, &eight.batch.normals, snapshot.current.normal, &eight.vertices);
    let m = &eight.transform.normal_rows;
    let n = V3::new(
        x * m[0][0] + y * m[0][1] + z * m[0][2],
        x * m[1][0] + y * m[1][1] + z * m[1][2],
        x * m[2][0] + y * m[2][1] + z * m[2][2],
    );
    if snapshot.normalize { n.normalize() } else { n }
}

/// Colours of both sides, lit or given, and the fog coordinate.
#[inline(always)]
pub(crate) fn colors<S: Simd>(
    simd: S,
    snapshot: &VertexSnapshot,
    eight: &VertexBatch8<'_>,
    eye: &F4<S>,
    normal: V3<F<S>>,
) -> Shaded<S> {
    // Fetch the colour and the fog coordinate.
    let color = attribute(simd, &eight.batch.colors, snapshot.current.color, &eight.vertices);
    let fog = match snapshot.fog {
        Some(FogSource::Given) => match &eight.batch.fog {
            Some(values) => {
                let mut row = [0.0; LANES];
                for lane in 0..LANES {
                    row[lane] = values[eight.vertices[lane] as usize];
                }
                F32x8::from_slice(simd, &row)
            }
            None => splat(simd, snapshot.current.fog),
        },
        Some(FogSource::Ahead) => -eye[2],
        Some(FogSource::Radial) => (eye[0] * eye[0] + eye[1] * eye[1] + eye[2] * eye[2]).sqrt(),
        _ => lanes::Lanes::abs(eye[2]),
    };

    // Without lighting, clamp the given colours.
    let Some(lighting) = &snapshot.lighting else {
        let secondary = if snapshot.color_sum {
            let [r, g, b] = attribute(
                simd,
                &eight.batch.secondary,
                snapshot.current.secondary,
                &eight.vertices,
            );
            let c = limited(snapshot.clamps, [r, g, b, r]);
            Some(V3::new(c[0], c[1], c[2]))
        } else {
            None
        };
        return Shaded { color: limited(snapshot.clamps, color), secondary, back: None, fog };
    };

    // Light the front, and the back with the opposite normal.
    let one = splat(simd, 1.0);
    let inverse = one / eye[3];
    let position = V3::new(eye[0] * inverse, eye[1] * inverse, eye[2] * inverse);
    let clamps = snapshot.clamps;
    let (front, secondary) = lit(
        simd,
        lighting,
        &eight.faces.front,
        &lighting.tracked[0],
        &color,
        position,
        normal,
        clamps,
    );
    let back = eight.faces.back.as_ref().map(
        #[inline(always)]
        |face| lit(simd, lighting, face, &lighting.tracked[1], &color, position, -normal, clamps),
    );
    Shaded { color: front, secondary, back, fog }
}

/// Lighting of one side: primary colour, and the secondary one with separate specular.
fn lit<S: Simd>(
    simd: S,
    lighting: &LightingSnapshot,
    m: &LaneFace,
    tracked: &Tracked,
    color: &F4<S>,
    position: V3<F<S>>,
    n: V3<F<S>>,
    clamps: bool,
) -> (F4<S>, Option<V3<F<S>>>) {
    simd.vectorize(
        #[inline(always)]
        || {
            let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));

            // Choose the material's colours: given, or following the vertex colour.
            let given = V3::new(color[0], color[1], color[2]);
            let row = lanes::inlined(
                #[inline(always)]
                |values: &[f32; LANES]| F32x8::from_slice(simd, values),
            );
            let of = lanes::inlined(
                #[inline(always)]
                |follows: bool, c: &[[f32; LANES]]| {
                    if follows { given } else { V3::new(row(&c[0]), row(&c[1]), row(&c[2])) }
                },
            );
            let k = Phong {
                ka: of(tracked.ambient, &m.ambient),
                kd: of(tracked.diffuse, &m.diffuse),
                ks: of(tracked.specular, &m.specular),
                shininess: row(&m.shininess),
            };

            // Find the direction to the viewer.
            let v = if lighting.local_viewer {
                (-position).normalize()
            } else {
                V3::splat(one, [0.0, 0.0, 1.0])
            };
            let surface = Surface { position, n, v };
            let visible = lanes::inlined(
                #[inline(always)]
                |_: usize| V3::new(one, one, one),
            );
            // Without a specular colour the halfway vectors need not be computed.
            let dull = !tracked.specular && m.dull;

            // Evaluate all lights.
            let model = if dull { Illumination::Lambert } else { Illumination::BlinnPhong };
            let Reflected { diffuse, specular } =
                phong(model, &lighting.lights, lighting.ambient, &surface, &k, visible, |_| zero);

            // Sum up: specular light stays apart or is added.
            let primary = diffuse + of(tracked.emission, &m.emission);
            let alpha = if tracked.diffuse { color[3] } else { row(&m.diffuse[3]) };
            if lighting.separate_specular {
                let s = limited(clamps, [specular.x, specular.y, specular.z, one]);
                return (
                    limited(clamps, [primary.x, primary.y, primary.z, alpha]),
                    Some(V3::new(s[0], s[1], s[2])),
                );
            }
            let sum = primary + specular;
            (limited(clamps, [sum.x, sum.y, sum.z, alpha]), None)
        },
    )
}

/// Texture coordinates of a unit: given or generated, through the texture matrix.
#[inline(always)]
fn texture<S: Simd>(
    simd: S,
    snapshot: &VertexSnapshot,
    unit: &UnitSnapshot,
    eight: &VertexBatch8<'_>,
    position: &F4<S>,
    eye: &F4<S>,
    n: V3<F<S>>,
) -> F4<S> {
    let u = unit.index;
    let mut coords: F4<S> =
        attribute(simd, &eight.batch.tex[u], snapshot.current.tex[u], &eight.vertices);
    if unit.generation != [Generation::None; 4] {
        generate(simd, unit, position, eye, n, &mut coords);
    }
    match &unit.matrix {
        Some(m) => transform(m, &coords),
        None => coords,
    }
}

#[inline(always)]
fn generate<S: Simd>(
    simd: S,
    unit: &UnitSnapshot,
    position: &F4<S>,
    eye: &F4<S>,
    n: V3<F<S>>,
    coords: &mut F4<S>,
) {
    // Reflect the vector to the vertex at the normal.
    let inverse = splat(simd, 1.0) / eye[3];
    let u = V3::new(eye[0] * inverse, eye[1] * inverse, eye[2] * inverse).normalize();
    let r = u - n.scale(n.dot(u) * 2.0);

    // Generate each coordinate by its mode.
    for k in 0..4 {
        coords[k] = match &unit.generation[k] {
            Generation::None => coords[k],
            Generation::Object(plane) => dot4(plane, position),
            Generation::Eye(plane) => dot4(plane, eye),
            Generation::Sphere => {
                let z = r.z + 1.0;
                let m = lanes::Lanes::sqrt(r.x * r.x + r.y * r.y + z * z) * 2.0;
                (if k == 0 { r.x } else { r.y }) / m + 0.5
            }
            Generation::Reflection => [r.x, r.y, r.z, r.z][k],
            Generation::Normal => [n.x, n.y, n.z, n.z][k],
        };
    }
}

/// All stages for feedback and the raster position: the shaded colours, coordinates of all units.
#[inline(always)]
pub(crate) fn process<S: Simd>(
    simd: S,
    snapshot: &VertexSnapshot,
    eight: &VertexBatch8<'_>,
) -> (F4<S>, Shaded<S>, [F4<S>; 8]) {
    let position: F4<S> = gather(simd, &eight.batch.positions, &eight.vertices);
    let eye = transform(&eight.transform.modelview, &position);
    let normal = eye_normal(simd, snapshot, eight);
    let shaded = colors(simd, snapshot, eight, &eye, normal);
    let zero = splat(simd, 0.0);
    let mut tex = [[zero; 4]; 8];
    for unit in &snapshot.units {
        tex[unit.index] = texture(simd, snapshot, unit, eight, &position, &eye, normal);
    }
    (eye, shaded, tex)
}
