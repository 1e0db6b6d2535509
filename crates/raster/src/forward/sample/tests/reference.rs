//! A plain scalar sampler, written after the specification's formulas one texel at a time, against
//! the lanes on many pseudo-random look-ups.

use super::*;
use crate::forward::sample::packed::Packed;

/// How far a colour of bytes, filtered as bytes, may be from the exact one: three roundings, of
/// weights too.
const FILTERED: f32 = 3.0 / 255.0;

/// Whether texels of a level are mixed at this level of detail.
fn filters_within(sampler: &Sampler, lod: f32) -> bool {
    // Where both filters may be meant, the weaker promise.
    let minified = matches!(
        sampler.min,
        Filter::Linear | Filter::LinearMipmapNearest | Filter::LinearMipmapLinear
    );
    minified || sampler.mag == Filter::Linear && lod <= 0.5
}

/// A sequence that looks random.
struct Noise(u32);

impl Noise {
    fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        self.0 >> 8
    }

    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.bits() as f32 / (1 << 24) as f32
    }

    fn pick<T: Copy>(&mut self, items: &[T]) -> T {
        items[self.bits() as usize % items.len()]
    }
}

/// The texel `(i, j, k)` of a level without border: border colour outside.
fn texel(texture: &Texture, level: usize, at: [i32; 3]) -> [f32; 4] {
    let level = &texture.faces[0][level];
    if (0..3).any(|k| at[k] < 0 || at[k] >= level.size[k] as i32) {
        return texture.sampler.border;
    }
    let [w, h, _] = level.size.map(|s| s as i32);
    match level.texels() {
        Texels::Rgba8(words) => words[((at[2] * h + at[1]) * w + at[0]) as usize]
            .to_le_bytes()
            .map(|b| f32::from(b) / 255.0),
        _ => unreachable!("the reference knows bytes only"),
    }
}

/// Table 3.19 and EXT_texture_mirror_clamp: the coordinate in texels after wrapping.
fn wrapped(s: f32, size: f32, wrap: Wrap) -> f32 {
    let (s, wrap) = if wrap.mirrors_once() { (s.abs(), wrap.after_mirror()) } else { (s, wrap) };
    let half = 0.5 / size;
    size * match wrap {
        Wrap::Repeat => s - s.floor(),
        Wrap::MirroredRepeat => {
            let f = s - s.floor();
            let m = if s.floor() as i32 % 2 == 0 { f } else { 1.0 - f };
            m.clamp(half, 1.0 - half)
        }
        Wrap::Clamp => s.clamp(0.0, 1.0),
        Wrap::ClampToEdge => s.clamp(half, 1.0 - half),
        Wrap::ClampToBorder => s.clamp(-half, 1.0 + half),
        Wrap::MirrorClamp | Wrap::MirrorClampToEdge | Wrap::MirrorClampToBorder => {
            unreachable!("mirrored above")
        }
    }
}

fn one_level(
    texture: &Texture,
    level: usize,
    linear: bool,
    coords: [f32; 3],
    dimensions: usize,
) -> [f32; 4] {
    let size = texture.faces[0][level].size;
    let mut u = [0.0; 3];
    for k in 0..dimensions {
        u[k] = wrapped(coords[k], size[k] as f32, texture.sampler.wrap[k]);
    }
    let mut sum = [0.0; 4];
    for corner in 0..8usize {
        let mut weight = 1.0;
        let mut at = [0i32; 3];
        for k in 0..3 {
            let far = corner >> k & 1;
            if k >= dimensions || !linear {
                weight *= 1.0 - far as f32;
                // The far end belongs to the last texel, but for a border beyond it.
                let beyond = i32::from(texture.sampler.wrap[k] == Wrap::ClampToBorder);
                at[k] = if k < dimensions {
                    (u[k].floor() as i32).min(size[k] as i32 - 1 + beyond)
                } else {
                    0
                };
                continue;
            }
            let from = u[k] - 0.5;
            at[k] = from.floor() as i32 + far as i32;
            let part = from - from.floor();
            weight *= if far == 1 { part } else { 1.0 - part };
            if texture.sampler.wrap[k] == Wrap::Repeat {
                at[k] = at[k].rem_euclid(size[k] as i32);
            }
        }
        if weight > 0.0 {
            let color = texel(texture, level, at);
            for k in 0..4 {
                sum[k] += weight * color[k];
            }
        }
    }
    sum
}

fn scalar(texture: &Texture, coords: [f32; 4], lod: f32, dimensions: usize) -> [f32; 4] {
    let Sampler { min, mag, lod: limits, .. } = texture.sampler;
    let lod = lod.max(limits[0]).min(limits[1]);
    let [s, t, r, q] = coords;
    let point = [s / q, t / q, r / q];
    let last = texture.faces[0].len() - 1;
    let nearest_within = matches!(min, Filter::NearestMipmapNearest | Filter::NearestMipmapLinear);
    let c = if mag == Filter::Linear && nearest_within { 0.5 } else { 0.0 };
    if lod <= c {
        return one_level(texture, 0, mag == Filter::Linear, point, dimensions);
    }
    let linear =
        matches!(min, Filter::Linear | Filter::LinearMipmapNearest | Filter::LinearMipmapLinear);
    match min {
        Filter::Nearest | Filter::Linear => one_level(texture, 0, linear, point, dimensions),
        Filter::NearestMipmapNearest | Filter::LinearMipmapNearest => {
            let level = if lod <= 0.5 { 0 } else { ((lod + 0.5).ceil() as usize - 1).min(last) };
            one_level(texture, level, linear, point, dimensions)
        }
        Filter::NearestMipmapLinear | Filter::LinearMipmapLinear => {
            if lod >= last as f32 {
                return one_level(texture, last, linear, point, dimensions);
            }
            let fine = lod as usize;
            let f = lod - lod.floor();
            let a = one_level(texture, fine, linear, point, dimensions);
            let b = one_level(texture, fine + 1, linear, point, dimensions);
            std::array::from_fn(|k| (1.0 - f) * a[k] + f * b[k])
        }
    }
}

const WRAPS: [Wrap; 5] =
    [Wrap::Repeat, Wrap::MirroredRepeat, Wrap::Clamp, Wrap::ClampToEdge, Wrap::ClampToBorder];
const FILTERS: [Filter; 6] = [
    Filter::Nearest,
    Filter::Linear,
    Filter::NearestMipmapNearest,
    Filter::LinearMipmapNearest,
    Filter::NearestMipmapLinear,
    Filter::LinearMipmapLinear,
];

/// A texture of noise with all its levels; sides may be no powers of two.
fn noise(noise: &mut Noise, kind: TextureKind, mut size: [u32; 3], sampler: Sampler) -> Texture {
    let mut levels = Vec::new();
    loop {
        let count = size.iter().product::<u32>();
        let words = (0..count).map(|_| noise.bits() << 8 ^ noise.bits()).collect();
        levels.push(level(size, 0, Texels::Rgba8(words)));
        if size == [1; 3] {
            return texture(kind, vec![levels], sampler);
        }
        size = size.map(|s| (s / 2).max(1));
    }
}

#[test]
fn the_lanes_agree_with_the_scalar_sampler() {
    let mut n = Noise(1);
    for (kind, dimensions, size) in [
        (TextureKind::One, 1, [13, 1, 1]),
        (TextureKind::One, 1, [16, 1, 1]),
        (TextureKind::Two, 2, [16, 8, 1]),
        (TextureKind::Two, 2, [5, 12, 1]),
        (TextureKind::Two, 2, [1, 1, 1]),
        (TextureKind::Three, 3, [4, 7, 3]),
    ] {
        for min in FILTERS {
            for mag in [Filter::Nearest, Filter::Linear] {
                for wrap in WRAPS {
                    let sampler = Sampler {
                        min,
                        mag,
                        wrap: [wrap, n.pick(&WRAPS), n.pick(&WRAPS)],
                        border: [0.1, 0.9, 0.3, 0.6],
                        ..NEAREST
                    };
                    let texture = noise(&mut n, kind, size, sampler);
                    let coords = std::array::from_fn(|_| {
                        let q = n.between(0.5, 2.0);
                        [n.between(-3.0, 4.0), n.between(-3.0, 4.0), n.between(-3.0, 4.0), q]
                    });
                    // Two neighbouring levels of detail in a row, as it is usual, or any.
                    let base = n.between(-1.0, 5.0);
                    let spread = n.pick(&[0.0, 0.3, 4.0]);
                    let lods = std::array::from_fn(|_| base + n.between(0.0, 1.0) * spread);
                    let out = look(&texture, coords, lods, 0xff);
                    for lane in 0..8 {
                        let expected = scalar(&texture, coords[lane], lods[lane], dimensions);
                        let as_bytes = Packed::new(&texture).is_some()
                            && filters_within(&texture.sampler, lods[lane]);
                        let most = if as_bytes { FILTERED } else { 1e-4 };
                        for k in 0..4 {
                            assert!(
                                (out[lane][k] - expected[k]).abs() < most,
                                "{kind:?} {size:?} {:?} at {:?} lod {}: {:?}, expected {expected:?}",
                                texture.sampler,
                                coords[lane],
                                lods[lane],
                                out[lane]
                            );
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn the_packed_path_agrees_with_the_general_one() {
    let mut n = Noise(7);
    // Large images have no columns.
    let large = [(Filter::LinearMipmapLinear, [4096, 1030, 1])];
    for (min, size) in FILTERS.map(|filter| (filter, [12, 8, 1])).into_iter().chain(large) {
        for wrap in WRAPS {
            let border = [0.2, 0.6, 1.0, 0.4];
            let sampler = Sampler { min, mag: Filter::Linear, wrap: [wrap; 3], border, ..NEAREST };
            let mut texture = noise(&mut n, TextureKind::Two, size, sampler);
            let coords: [[f32; 8]; 2] =
                std::array::from_fn(|_| std::array::from_fn(|_| n.between(-3.0, 4.0)));
            let lods: [f32; 8] = std::array::from_fn(|_| n.between(-1.0, 4.0));
            for srgb in [false, true] {
                if srgb {
                    for level in &mut texture.faces[0] {
                        let Texels::Rgba8(words) = level.texels().clone() else {
                            unreachable!("made of bytes")
                        };
                        *level = super::level(level.size, 0, Texels::Srgb8(words));
                    }
                }
                for (name, simd_level) in available_levels() {
                    let (a, b) = dispatch!(simd_level, simd => {
                        let load = |v: &[f32; 8]| F32x8::from_slice(simd, v);
                        let zero = crate::forward::wide::splat(simd, 0.0);
                        let at = [load(&coords[0]), load(&coords[1]), zero, zero + 1.0];
                        let packed = Packed::new(&texture).expect("two dimensions, bytes");
                        assert_eq!(texture.faces[0][0].columns(1 << 20).is_none(), size[0] == 4096);
                        let a = crate::forward::sample::packed::sample(simd, &packed, at, load(&lods), 0xff);
                        let b = crate::forward::sample::flat::sample(simd, &texture, at, load(&lods), 0xff);
                        let array = |c: [F32x8<_>; 4]| [0, 1, 2, 3].map(|k: usize| c[k].to_array());
                        (array(a), array(b))
                    });
                    for k in 0..4 {
                        for lane in 0..8 {
                            // Bytes that are no light are filtered as bytes.
                            let as_bytes = !srgb && filters_within(&sampler, lods[lane]);
                            let most = if as_bytes { FILTERED } else { 1e-6 };
                            assert!(
                                (a[k][lane] - b[k][lane]).abs() < most,
                                "{name} {min:?} {wrap:?}"
                            );
                        }
                    }
                }
            }
        }
    }
}
