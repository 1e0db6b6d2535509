//! Depth textures: comparison, modes, planes.

use super::*;
use crate::Viewport;
use crate::forward::plane::{DepthBuffer, Plane};
use crate::forward::state::Compare;
use std::sync::Mutex;

fn depths(sampler: Sampler) -> Texture {
    let image = level([2, 2, 1], 0, Texels::Depth(vec![0.2, 0.4, 0.6, 0.8]));
    let mut t = texture(TextureKind::Two, vec![vec![image]], sampler);
    t.format = BaseFormat::Depth;
    t
}

#[test]
fn every_comparison_has_the_reference_on_the_left() {
    for (func, below, equal, above) in [
        (Compare::Never, 0., 0., 0.),
        (Compare::Less, 1., 0., 0.),
        (Compare::Equal, 0., 1., 0.),
        (Compare::LessOrEqual, 1., 1., 0.),
        (Compare::Greater, 0., 0., 1.),
        (Compare::NotEqual, 1., 0., 1.),
        (Compare::GreaterOrEqual, 0., 1., 1.),
        (Compare::Always, 1., 1., 1.),
    ] {
        let t = depths(Sampler { compare: Some(func), ..NEAREST });
        let compare = |r: f32| at(&t, [0.75, 0.25, r, 1.0], 0.0)[0];
        assert_eq!([compare(0.3), compare(0.4), compare(0.5)], [below, equal, above], "{func:?}");
    }
    let t = depths(Sampler { compare: Some(Compare::Less), ..NEAREST });
    assert_eq!(at(&t, [1.5, 0.5, 0.6, 2.0], 0.0)[0], 1.0, "all coordinates are divided by q");
    let t = depths(Sampler { compare: Some(Compare::Less), ..linear(Wrap::ClampToEdge) });
    // Three of four texels are above 0.3; the point lies in the middle of all.
    assert_eq!(at(&t, [0.5, 0.5, 0.3, 1.0], 0.0)[0], 0.75);
    assert_eq!(at(&t, [0.375, 0.25, 0.3, 1.0], 0.0)[0], 0.25, "by their weights");
}

#[test]
fn the_reference_is_clamped() {
    let image = level([1, 1, 1], 0, Texels::Depth(vec![1.0]));
    let mut t = texture(
        TextureKind::Two,
        vec![vec![image]],
        Sampler { compare: Some(Compare::LessOrEqual), ..NEAREST },
    );
    assert_eq!([0.9, 1.0, 1.5].map(|r| at(&t, [0.5, 0.5, r, 1.0], 0.0)[0]), [1.0; 3]);
    t.float_depth = true;
    assert_eq!([0.9, 1.0, 1.5].map(|r| at(&t, [0.5, 0.5, r, 1.0], 0.0)[0]), [1.0, 1.0, 0.0]);
}

#[test]
fn modes_expand_the_depth() {
    let mut t = depths(NEAREST);
    let mut value = |mode| {
        t.depth_mode = mode;
        at(&t, [0.25, 0.75, 0.0, 1.0], 0.0)
    };
    assert_eq!(value(BaseFormat::Luminance), [0.6, 0.6, 0.6, 1.0]);
    assert_eq!(value(BaseFormat::Intensity), [0.6; 4]);
    assert_eq!(value(BaseFormat::Alpha), [0.0, 0.0, 0.0, 0.6]);
    let filtered = depths(linear(Wrap::ClampToEdge));
    assert!(close(at(&filtered, [0.5, 0.5, 0.0, 1.0], 0.0)[0], 0.5));
}

#[test]
fn the_border_is_compared_too() {
    let s = Sampler {
        compare: Some(Compare::GreaterOrEqual),
        border: [0.5, 0.0, 0.0, 0.0],
        wrap: [Wrap::ClampToBorder; 3],
        ..NEAREST
    };
    let t = depths(s);
    assert_eq!([0.4, 0.6].map(|r| at(&t, [7.0, 0.5, r, 1.0], 0.0)[0]), [0.0, 1.0]);
}

#[test]
fn planes_are_read_tile_by_tile() {
    // 100 x 70 pixels: tiles of 64; only tile (1, 0) is stored. 24 bits.
    let scale = (1 << 24) as f32 - 1.0;
    let mut plane = Plane::new(Viewport { width: 100, height: 70 }, 1, scale);
    plane.set(64, 0, 0, 0.0);
    plane.set(99, 63, 0, 8_388_608.0);
    let plane = Arc::new(Mutex::new(DepthBuffer::new(plane, scale)));
    let image = level([100, 70, 1], 0, Texels::DepthBuffer(plane));
    let t = texture(
        TextureKind::Two,
        vec![vec![image.clone()]],
        Sampler { wrap: [Wrap::ClampToEdge; 3], ..NEAREST },
    );
    let depth = |x: f32, y: f32| at(&t, [(x + 0.5) / 100.0, (y + 0.5) / 70.0, 0.0, 1.0], 0.0)[0];
    assert_eq!([depth(63.0, 0.0), depth(64.0, 0.0), depth(65.0, 0.0)], [1.0, 0.0, 1.0]);
    assert_eq!(
        [depth(99.0, 63.0), depth(99.0, 64.0), depth(0.0, 69.0)],
        [8_388_608.0 / scale, 1.0, 1.0]
    );
    let s = Sampler { compare: Some(Compare::GreaterOrEqual), ..linear(Wrap::ClampToEdge) };
    let shadow = texture(TextureKind::Two, vec![vec![image]], s);
    let lit = |x: f32, r: f32| at(&shadow, [x / 100.0, 0.5 / 70.0, r, 1.0], 0.0)[0];
    assert!(
        close(lit(64.0, 0.5), 0.5) && close(lit(64.75, 0.5), 0.75) && close(lit(66.0, 0.5), 0.0)
    );
}

#[test]
fn cube_maps_compare_with_q() {
    let face = |i: usize| vec![level([1, 1, 1], 0, Texels::Depth(vec![0.1 * (i + 1) as f32]))];
    let s = Sampler { compare: Some(Compare::LessOrEqual), ..NEAREST };
    let t = texture(TextureKind::Cube, (0..6).map(face).collect(), s);
    let lit = |z: f32, q: f32| at(&t, [0.1, 0.2, z, q], 0.0);
    assert_eq!(
        [lit(1.0, 0.45), lit(1.0, 0.55), lit(-1.0, 0.55)],
        [[1.0; 4], [0.0, 0.0, 0.0, 1.0], [1.0; 4]]
    );
}
