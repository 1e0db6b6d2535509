//! Pictures with shadow maps between their draws: what is drawn in one pass, or after what came
//! later, is what would have been drawn one by one.

use crate::common::{Dice, Stage};
use vitral_gl::enums as gl;

const SIZE: i32 = 100;
/// Depth textures: of the picture, of shadow maps.
const PICTURE: u32 = 1;
const MAPS: [u32; 2] = [2, 3];
/// A texture with mipmaps.
const TILES: u32 = 4;
/// Lists: a floor of two triangles, a floor of many, a box's faces.
const LISTS: u32 = 3;

fn depth_texture(c: &mut Stage, name: u32) {
    c.bind_texture(gl::TEXTURE_2D, name);
    let internal = gl::DEPTH_COMPONENT24 as i32;
    c.tex_image_2d(gl::TEXTURE_2D, 0, internal, SIZE, SIZE, 0, gl::DEPTH_COMPONENT, gl::FLOAT, 0);
    for filter in [gl::TEXTURE_MIN_FILTER, gl::TEXTURE_MAG_FILTER] {
        c.tex_parameteri(gl::TEXTURE_2D, filter, gl::NEAREST as i32);
    }
    c.tex_parameteri(gl::TEXTURE_2D, gl::DEPTH_TEXTURE_MODE, gl::INTENSITY as i32);
    c.tex_parameteri(gl::TEXTURE_2D, gl::TEXTURE_COMPARE_MODE, gl::COMPARE_R_TO_TEXTURE as i32);
}

fn prepare(c: &mut Stage) {
    for name in [PICTURE, MAPS[0], MAPS[1]] {
        depth_texture(c, name);
        c.bind_framebuffer_ext(gl::FRAMEBUFFER, name);
        c.framebuffer_texture_2d(gl::FRAMEBUFFER, gl::DEPTH_ATTACHMENT, gl::TEXTURE_2D, name, 0);
        if name == PICTURE {
            c.bind_renderbuffer_ext(gl::RENDERBUFFER, 1);
            c.renderbuffer_storage(gl::RENDERBUFFER, gl::RGBA8, SIZE, SIZE);
            c.framebuffer_renderbuffer(gl::FRAMEBUFFER, gl::COLOR_ATTACHMENT0, gl::RENDERBUFFER, 1);
        } else {
            c.draw_buffer(gl::NONE);
            c.read_buffer(gl::NONE);
        }
        assert_eq!(c.check_framebuffer_status(gl::FRAMEBUFFER), gl::FRAMEBUFFER_COMPLETE);
        c.clear(gl::DEPTH_BUFFER_BIT | gl::COLOR_BUFFER_BIT);
    }
    c.bind_texture(gl::TEXTURE_2D, TILES);
    let texels = |size: i32| {
        (0..size * size).map(|i| [(i * 37) as u8, (i * i) as u8, 200, 255 - i as u8]).collect()
    };
    let levels: Vec<(i32, Vec<[u8; 4]>)> = [16, 8, 4, 2, 1].map(|size| (size, texels(size))).into();
    c.texture(&levels);
    c.tex_parameteri(gl::TEXTURE_2D, gl::TEXTURE_MIN_FILTER, gl::LINEAR_MIPMAP_LINEAR as i32);
    c.tex_parameteri(gl::TEXTURE_2D, gl::TEXTURE_MAG_FILTER, gl::LINEAR as i32);
    c.tex_envi(gl::TEXTURE_ENV, gl::TEXTURE_ENV_MODE, gl::MODULATE as i32);

    for list in 0..LISTS {
        c.new_list(list + 1, gl::COMPILE);
        c.begin(gl::QUADS);
        let cells = [1, 12, 2][list as usize];
        for (i, j) in (0..cells).flat_map(|i| (0..cells).map(move |j| (i, j))) {
            for [x, y] in [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]] {
                let [s, t] = [x, y].map(|v| v as f32 / cells as f32);
                c.tex_coord_2f(3.0 * s, 3.0 * t);
                c.normal_3f(0.0, 0.1, 1.0);
                c.vertex_3f(4.0 * s - 2.0, 4.0 * t - 2.0, if list == 2 { s * t } else { 0.0 });
            }
        }
        c.end();
        c.end_list();
    }

    c.matrix_mode(gl::PROJECTION);
    c.frustum(-0.5, 0.5, -0.5, 0.5, 1.0, 20.0);
    c.matrix_mode(gl::MODELVIEW);
    c.enable(gl::DEPTH_TEST);
    c.depth_func(gl::LEQUAL);
    c.enable(gl::LIGHT0);
    // Unit 1 asks a shadow map.
    c.active_texture(gl::TEXTURE1);
    for (coordinate, generation, row) in [
        (gl::S, gl::TEXTURE_GEN_S, [0.2f32, 0.0, 0.0, 0.5]),
        (gl::T, gl::TEXTURE_GEN_T, [0.0, 0.2, 0.0, 0.5]),
        (gl::R, gl::TEXTURE_GEN_R, [0.0, 0.0, -0.2, 0.05]),
        (gl::Q, gl::TEXTURE_GEN_Q, [0.0, 0.0, 0.0, 1.0]),
    ] {
        c.tex_geni(coordinate, gl::TEXTURE_GEN_MODE, gl::EYE_LINEAR as i32);
        let row = c.put(&row);
        c.tex_genfv(coordinate, gl::EYE_PLANE, row);
        c.enable(generation);
    }
    c.active_texture(gl::TEXTURE0);
    c.no_error();
}

/// One of few places: surfaces shall be met again.
fn place(c: &mut Stage, d: &mut Dice) {
    c.load_identity();
    match d.below(5) {
        0 => c.translatef(0.0, 0.0, -4.0),
        // Turned about its first corner.
        4 => {
            c.translatef(-0.5, -0.5, -3.0);
            c.rotatef(-10.0 * d.below(4) as f32, 1.0, 0.4, 0.0);
            c.translatef(2.0, 2.0, 0.0);
        }
        1 => {
            c.translatef(0.0, -0.5, -4.0);
            c.rotatef(-60.0, 1.0, 0.0, 0.0);
        }
        2 => {
            c.translatef(0.3, 0.2, -3.0);
            c.rotatef(35.0, 0.3, 1.0, 0.0);
        }
        _ => c.translatef(d.number(), d.number(), -3.0),
    }
}

fn draw(c: &mut Stage, d: &mut Dice) {
    place(c, d);
    c.color_4f(0.5, 0.25 + 0.25 * d.number(), 0.5, 1.0);
    c.call_list(1 + d.below(LISTS));
}

/// Textures and blending for draws in the picture; the map if there is one to ask.
fn look(c: &mut Stage, d: &mut Dice, map: Option<u32>) {
    let set =
        |c: &mut Stage, on: bool, what: u32| if on { c.enable(what) } else { c.disable(what) };
    set(c, d.below(3) > 0, gl::BLEND);
    c.blend_func(gl::ONE, gl::ONE);
    set(c, d.below(2) == 0, gl::LIGHTING);
    set(c, d.below(5) > 0, gl::TEXTURE_2D);
    c.active_texture(gl::TEXTURE1);
    set(c, map.is_some(), gl::TEXTURE_2D);
    c.bind_texture(gl::TEXTURE_2D, map.unwrap_or(0));
    c.active_texture(gl::TEXTURE0);
}

/// A program without order; every step is waited for, or none.
fn run(c: &mut Stage, seed: u64, waits: bool) {
    let mut d = Dice(seed);
    prepare(c);
    for _ in 0..40 {
        match d.below(6) {
            // The picture, with a map or without.
            0..3 => {
                c.bind_framebuffer_ext(gl::FRAMEBUFFER, PICTURE);
                let map = (d.below(2) == 0).then(|| MAPS[d.below(2) as usize]);
                look(c, &mut d, map);
                for _ in 0..=d.below(3) {
                    draw(c, &mut d);
                }
            }
            // A map: cleared whole, in part or not at all.
            3 | 4 => {
                c.bind_framebuffer_ext(gl::FRAMEBUFFER, MAPS[d.below(2) as usize]);
                // Now and then what is seen in the picture decides what comes into the map.
                let asks = d.below(6) == 0;
                look(c, &mut d, asks.then_some(PICTURE));
                if asks {
                    c.enable(gl::ALPHA_TEST);
                    c.alpha_func(gl::GREATER, 0.3);
                }
                match d.below(4) {
                    0 => {}
                    1 => {
                        c.enable(gl::SCISSOR_TEST);
                        c.scissor(10, 20, 50, 30);
                        c.clear(gl::DEPTH_BUFFER_BIT);
                        c.disable(gl::SCISSOR_TEST);
                    }
                    _ => c.clear(gl::DEPTH_BUFFER_BIT),
                }
                for _ in 0..d.below(4) {
                    draw(c, &mut d);
                }
                c.disable(gl::ALPHA_TEST);
            }
            _ => {
                c.bind_framebuffer_ext(gl::FRAMEBUFFER, PICTURE);
                c.clear(
                    gl::DEPTH_BUFFER_BIT | if d.below(3) == 0 { gl::COLOR_BUFFER_BIT } else { 0 },
                );
            }
        }
        if waits {
            c.finish();
        }
    }
    c.no_error();
    c.bind_framebuffer_ext(gl::FRAMEBUFFER, PICTURE);
}

#[test]
fn what_waits_for_shadow_maps_is_what_was_drawn_before_them() {
    let mut rich = 0;
    for seed in 0..200 {
        let [mut apart, mut together] = [Stage::new(SIZE, SIZE), Stage::new(SIZE, SIZE)];
        run(&mut apart, seed, true);
        run(&mut together, seed, false);
        let (a, b) = (apart.bytes(), together.bytes());
        assert_eq!(a.iter().zip(&b).filter(|(a, b)| a != b).count(), 0, "pixels of program {seed}");
        assert!(apart.depths() == together.depths(), "depths of program {seed}");
        rich += usize::from(a.iter().collect::<std::collections::HashSet<_>>().len() > 100);
    }
    assert!(rich > 120, "{rich} programs draw more than a hundred colours");
}
