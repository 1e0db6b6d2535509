//! Facets take different ways through the rasteriser; pictures must not tell which.

#![expect(clippy::unwrap_used, reason = "a test")]

use crate::common::Stage;
use std::sync::{Arc, LazyLock};
use vitral_exec::Workers;
use vitral_gl::enums as gl;
use vitral_math::lanes::Level;
use vitral_raster::forward::Runner;

/// So many threads that tiles are cut into strips.
static THREADS: LazyLock<Arc<Runner>> =
    LazyLock::new(|| Arc::new(Runner::new(Workers::new(16), Level::new())));

/// What sends facets which way, and changes nothing.
#[derive(Clone, Copy, Debug)]
enum Way {
    /// Tiny ones eight at a time.
    Tiny,
    /// Tiny ones that change depths one by one: an alpha test that always passes has them written
    /// after colours are known.
    LateDepth,
    /// By blocks: a stencil is written that nobody asks for.
    Blocks,
    /// Row by row, with all operations that there are: a coverage of all samples is asked for.
    Everything,
}

/// What is drawn beside colours of vertices.
#[derive(Clone, Copy, Debug)]
enum With {
    Nothing,
    OneColor,
    Fog,
    Texture,
    Mipmaps,
    Cube,
    /// A texture and a shadow map, whose lookups decide, and fog.
    Shadow,
    Blending,
    /// Whatever is drawn again is added where it is.
    Adding,
    /// Some fragments are dropped for their colour.
    AlphaTest,
    FlatShade,
    Scissor,
    Stencil,
    StencilAlone,
}

/// A picture of random triangles, most of them small, some across tiles, at many depths and in
/// perspective.
fn picture(
    (samples, multisample): (i32, bool),
    with: With,
    way: Way,
    strips: bool,
) -> Vec<[u8; 4]> {
    let mut c = Stage::new(150, 90);
    if strips {
        c.set_runner_source(|| Arc::clone(&THREADS));
    }
    let names = c.put(&[0u32; 16]);
    c.gen_framebuffers(1, names);
    c.gen_renderbuffers(2, names + 4);
    let [framebuffer, color, depth] = c.take::<u32>(names, 3).try_into().unwrap();
    if samples > 0 {
        c.bind_framebuffer(gl::FRAMEBUFFER, framebuffer);
        for (buffer, format, at) in [
            (color, gl::RGBA8, gl::COLOR_ATTACHMENT0),
            (depth, gl::DEPTH24_STENCIL8, gl::DEPTH_STENCIL_ATTACHMENT),
        ] {
            c.bind_renderbuffer(gl::RENDERBUFFER, buffer);
            c.renderbuffer_storage_multisample(gl::RENDERBUFFER, samples, format, 150, 90);
            c.framebuffer_renderbuffer(gl::FRAMEBUFFER, at, gl::RENDERBUFFER, buffer);
        }
        assert_eq!(c.check_framebuffer_status(gl::FRAMEBUFFER), gl::FRAMEBUFFER_COMPLETE);
    }
    c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT);
    c.enable(gl::DEPTH_TEST);
    if !multisample {
        c.disable(gl::MULTISAMPLE);
    }
    match with {
        With::Nothing => {}
        With::OneColor => c.color_4f(0.9, 0.3, 0.1, 0.7),
        With::Fog => {
            c.enable(gl::FOG);
            c.fogf(gl::FOG_DENSITY, 0.3);
        }
        With::Texture => {
            let texels =
                c.put(&[[255u8, 0, 0, 255], [0, 255, 0, 128], [0, 0, 255, 0], [255, 255, 255, 60]]);
            c.tex_image_2d(
                gl::TEXTURE_2D,
                0,
                gl::RGBA as i32,
                2,
                2,
                0,
                gl::RGBA,
                gl::UNSIGNED_BYTE,
                texels,
            );
            c.tex_parameteri(gl::TEXTURE_2D, gl::TEXTURE_MIN_FILTER, gl::LINEAR as i32);
            c.enable(gl::TEXTURE_2D);
        }
        With::Mipmaps => {
            let texels: Vec<u32> =
                (1..=20 * 12u32).map(|k| k.wrapping_mul(2_654_435_761)).collect();
            let texels = c.put(&texels);
            c.tex_parameteri(gl::TEXTURE_2D, gl::GENERATE_MIPMAP, 1);
            c.tex_image_2d(
                gl::TEXTURE_2D,
                0,
                gl::RGBA as i32,
                20,
                12,
                0,
                gl::RGBA,
                gl::UNSIGNED_BYTE,
                texels,
            );
            c.tex_parameteri(
                gl::TEXTURE_2D,
                gl::TEXTURE_MIN_FILTER,
                gl::LINEAR_MIPMAP_LINEAR as i32,
            );
            c.enable(gl::TEXTURE_2D);
        }
        With::Cube => {
            c.tex_parameteri(gl::TEXTURE_CUBE_MAP, gl::GENERATE_MIPMAP, 1);
            for face in 0..6 {
                let texels: Vec<u32> =
                    (1..=8 * 8u32).map(|k| (k + 64 * face).wrapping_mul(2_654_435_761)).collect();
                let (texels, face) = (c.put(&texels), gl::TEXTURE_CUBE_MAP_POSITIVE_X + face);
                c.tex_image_2d(
                    face,
                    0,
                    gl::RGBA as i32,
                    8,
                    8,
                    0,
                    gl::RGBA,
                    gl::UNSIGNED_BYTE,
                    texels,
                );
            }
            c.tex_parameteri(
                gl::TEXTURE_CUBE_MAP,
                gl::TEXTURE_MIN_FILTER,
                gl::LINEAR_MIPMAP_LINEAR as i32,
            );
            c.enable(gl::TEXTURE_CUBE_MAP_SEAMLESS);
            c.enable(gl::TEXTURE_CUBE_MAP);
        }
        With::Shadow => {
            let texels =
                c.put(&[[255u8, 40, 90, 255], [90, 255, 70, 255], [60, 80, 255, 255], [255; 4]]);
            c.tex_image_2d(
                gl::TEXTURE_2D,
                0,
                gl::RGB as i32,
                2,
                2,
                0,
                gl::RGBA,
                gl::UNSIGNED_BYTE,
                texels,
            );
            c.tex_parameteri(gl::TEXTURE_2D, gl::TEXTURE_MIN_FILTER, gl::NEAREST as i32);
            c.enable(gl::TEXTURE_2D);
            c.active_texture(gl::TEXTURE1);
            shadow_map(&mut c, names + 16);
            c.bind_framebuffer(gl::FRAMEBUFFER, if samples > 0 { framebuffer } else { 0 });
            c.enable(gl::TEXTURE_2D);
            c.enable(gl::ALPHA_TEST);
            c.alpha_func(gl::GEQUAL, 0.3);
            c.enable(gl::FOG);
            c.fogi(gl::FOG_MODE, gl::LINEAR as i32);
            c.fogf(gl::FOG_END, 2.0);
        }
        With::Adding => {
            c.enable(gl::BLEND);
            c.blend_func(gl::ONE, gl::ONE);
        }
        With::AlphaTest => {
            c.enable(gl::ALPHA_TEST);
            c.alpha_func(gl::GREATER, 0.4);
        }
        With::Blending => {
            c.enable(gl::BLEND);
            c.blend_func(gl::SRC_ALPHA, gl::ONE_MINUS_SRC_ALPHA);
        }
        With::FlatShade => c.shade_model(gl::FLAT),
        With::Stencil | With::StencilAlone => {
            // A slanted region, whose border divides samples of pixels.
            c.enable(gl::STENCIL_TEST);
            c.stencil_func(gl::ALWAYS, 1, 0xff);
            c.stencil_op(gl::KEEP, gl::KEEP, gl::REPLACE);
            c.color_mask(0, 0, 0, 0);
            c.depth_mask(0);
            c.begin(gl::TRIANGLES);
            for (x, y) in [(-0.9, -0.8), (0.8, -0.5), (0.1, 0.95)] {
                c.vertex_2f(x, y);
            }
            c.end();
            c.color_mask(1, 1, 1, 1);
            c.depth_mask(1);
            c.stencil_func(gl::EQUAL, 1, 0x0f);
            c.stencil_op(gl::KEEP, gl::KEEP, gl::KEEP);
            if matches!(with, With::StencilAlone) {
                c.disable(gl::DEPTH_TEST);
            }
        }
        With::Scissor => {
            c.enable(gl::SCISSOR_TEST);
            c.scissor(13, 7, 100, 71);
        }
    }
    match way {
        Way::Tiny => {}
        Way::LateDepth => c.enable(gl::ALPHA_TEST),
        Way::Blocks => {
            if !matches!(with, With::Stencil | With::StencilAlone) {
                c.enable(gl::STENCIL_TEST);
                c.stencil_func(gl::ALWAYS, 0, 0x0f);
            }
            c.stencil_op(gl::KEEP, gl::KEEP, gl::INVERT);
            c.stencil_mask(0x80);
        }
        // It covers all samples.
        Way::Everything => c.enable(gl::SAMPLE_COVERAGE),
    }
    triangles(&mut c, with);
    if matches!(with, With::Adding) {
        // With equal depths nothing but colours changes.
        c.depth_func(gl::LEQUAL);
        triangles(&mut c, with);
    }
    // Some rows are cleared to another colour, in the same pass as the rest.
    c.clear_color(0.2, 0.4, 0.6, 0.8);
    c.enable(gl::SCISSOR_TEST);
    c.scissor(0, 32, 150, 8);
    c.clear(gl::COLOR_BUFFER_BIT);
    if samples > 0 {
        c.bind_framebuffer(gl::DRAW_FRAMEBUFFER, 0);
        c.disable(gl::SCISSOR_TEST);
        c.blit_framebuffer(0, 0, 150, 90, 0, 0, 150, 90, gl::COLOR_BUFFER_BIT, gl::NEAREST);
        c.bind_framebuffer(gl::READ_FRAMEBUFFER, 0);
    }
    assert_eq!(c.get_error(), gl::NO_ERROR);
    c.bytes()
}

/// Binds a shadow map of some random triangles to the current unit.
fn shadow_map(c: &mut Stage, names: usize) {
    c.gen_textures(1, names);
    c.gen_framebuffers(1, names + 4);
    let [texture, framebuffer] = c.take::<u32>(names, 2).try_into().unwrap();
    c.bind_texture(gl::TEXTURE_2D, texture);
    c.tex_image_2d(
        gl::TEXTURE_2D,
        0,
        gl::DEPTH_COMPONENT24 as i32,
        96,
        96,
        0,
        gl::DEPTH_COMPONENT,
        gl::UNSIGNED_INT,
        0,
    );
    for (parameter, value) in [
        (gl::TEXTURE_MIN_FILTER, gl::NEAREST),
        (gl::TEXTURE_MAG_FILTER, gl::NEAREST),
        (gl::TEXTURE_WRAP_S, gl::CLAMP_TO_EDGE),
        (gl::TEXTURE_WRAP_T, gl::CLAMP_TO_EDGE),
        (gl::TEXTURE_COMPARE_MODE, gl::COMPARE_R_TO_TEXTURE),
        (gl::TEXTURE_COMPARE_FUNC, gl::LEQUAL),
        (gl::DEPTH_TEXTURE_MODE, gl::INTENSITY),
    ] {
        c.tex_parameteri(gl::TEXTURE_2D, parameter, value as i32);
    }
    c.bind_framebuffer(gl::FRAMEBUFFER, framebuffer);
    c.framebuffer_texture_2d(gl::FRAMEBUFFER, gl::DEPTH_ATTACHMENT, gl::TEXTURE_2D, texture, 0);
    c.draw_buffer(gl::NONE);
    c.viewport(0, 0, 96, 96);
    c.clear(gl::DEPTH_BUFFER_BIT);
    c.color_mask(0, 0, 0, 0);
    let mut state = 7u32;
    let mut random = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 23) as f32 - 1.0
    };
    c.begin(gl::TRIANGLES);
    for _ in 0..40 {
        let middle = [random(), random(), random()];
        for _ in 0..3 {
            c.vertex_3f(
                middle[0] + random() * 0.3,
                middle[1] + random() * 0.3,
                middle[2] * 0.8 + random() * 0.1,
            );
        }
    }
    c.end();
    c.color_mask(1, 1, 1, 1);
    c.viewport(0, 0, 150, 90);
}

/// Random triangles, most of them small.
fn triangles(c: &mut Stage, with: With) {
    let mut state = 5u32;
    let mut random = move |below: f32| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32 * below
    };
    c.begin(gl::TRIANGLES);
    for k in 0..3000 {
        let size = if k % 50 == 0 { 60.0 } else { 9.0 };
        let middle = [random(150.0), random(90.0), random(2.0) - 1.0];
        for _ in 0..3 {
            let color = [random(1.0), random(1.0), random(1.0), random(1.0)];
            if !matches!(with, With::OneColor) {
                c.color_4f(color[0], color[1], color[2], color[3]);
            }
            let cube = matches!(with, With::Cube);
            let (s, t, r) = (random(2.0), random(2.0), if cube { random(2.0) - 1.0 } else { 0.0 });
            c.tex_coord_4f(s, t, r, if cube && k % 3 == 0 { random(2.0) - 1.0 } else { 1.0 });
            if matches!(with, With::Shadow) {
                c.multi_tex_coord_4f(
                    gl::TEXTURE1,
                    random(1.6),
                    random(1.6),
                    random(1.6),
                    1.0 + random(0.6),
                );
            }
            // The eye is near to some.
            let w = 1.0 + random(if k % 7 == 0 { 30.0 } else { 2.0 });
            let (x, y) =
                ((middle[0] + random(size)) / 75.0 - 1.0, (middle[1] + random(size)) / 45.0 - 1.0);
            c.vertex_4f(x * w, y * w, (middle[2] * 0.9 + random(0.1)) * w, w);
        }
    }
    c.end();
}

#[test]
fn facets_look_the_same_whichever_way_they_go() {
    for samples in [(0, true), (4, true), (4, false)] {
        for with in [
            With::Nothing,
            With::OneColor,
            With::Fog,
            With::Texture,
            With::Mipmaps,
            With::Cube,
            With::Shadow,
            With::Blending,
            With::Adding,
            With::AlphaTest,
            With::FlatShade,
            With::Scissor,
            With::Stencil,
            With::StencilAlone,
        ] {
            let tiny = picture(samples, with, Way::Tiny, false);
            assert!(tiny.iter().filter(|pixel| **pixel != [0; 4]).count() > 2000, "{with:?}");
            let strips = [(Way::Tiny, true), (Way::Blocks, true), (Way::Everything, true)];
            for (way, strips) in [Way::LateDepth, Way::Blocks, Way::Everything]
                .map(|w| (w, false))
                .into_iter()
                .chain(strips)
            {
                let differ = tiny
                    .iter()
                    .zip(&picture(samples, with, way, strips))
                    .filter(|(a, b)| a != b)
                    .count();
                assert_eq!(
                    differ, 0,
                    "{samples:?} samples with {with:?}: {way:?}, strips: {strips}"
                );
            }
        }
    }
}

/// Colours and depths after large triangles, of which many cover whole blocks, were drawn, small
/// ones and a clear among them, and then the large ones again, in a pass of their own, where `func`
/// lets them.
fn again(
    samples: i32,
    depth_format: u32,
    func: u32,
    way: Way,
    strips: bool,
) -> (Vec<[u8; 4]>, Vec<f32>) {
    let mut c = Stage::new(150, 90);
    if strips {
        c.set_runner_source(|| Arc::clone(&THREADS));
    }
    let names = c.put(&[0u32; 16]);
    c.gen_framebuffers(2, names);
    c.gen_renderbuffers(4, names + 8);
    let [framebuffer, resolved] = c.take::<u32>(names, 2).try_into().unwrap();
    let buffers = c.take::<u32>(names + 8, 4);
    for (framebuffer, buffers, samples) in
        [(resolved, &buffers[2..], 0), (framebuffer, &buffers[..2], samples)]
    {
        c.bind_framebuffer(gl::FRAMEBUFFER, framebuffer);
        for (buffer, format, at) in [
            (buffers[0], gl::RGBA8, gl::COLOR_ATTACHMENT0),
            (buffers[1], depth_format, gl::DEPTH_ATTACHMENT),
        ] {
            c.bind_renderbuffer(gl::RENDERBUFFER, buffer);
            c.renderbuffer_storage_multisample(gl::RENDERBUFFER, samples, format, 150, 90);
            c.framebuffer_renderbuffer(gl::FRAMEBUFFER, at, gl::RENDERBUFFER, buffer);
        }
        assert_eq!(c.check_framebuffer_status(gl::FRAMEBUFFER), gl::FRAMEBUFFER_COMPLETE);
    }
    c.clear_depth(0.0);
    c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT);
    c.enable(gl::DEPTH_TEST);
    match way {
        Way::LateDepth => c.enable(gl::ALPHA_TEST),
        // It covers all samples.
        Way::Everything => c.enable(gl::SAMPLE_COVERAGE),
        Way::Tiny | Way::Blocks => {}
    }
    let triangles = |c: &mut Stage, seed: u32, count: u32, size: f32| {
        let mut state = seed;
        let mut random = move |below: f32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32 * below
        };
        c.begin(gl::TRIANGLES);
        for _ in 0..count {
            let middle = [random(150.0), random(90.0), random(1.6) - 0.8];
            for _ in 0..3 {
                c.color_4f(random(0.4), random(0.4), random(0.4), 1.0);
                let (x, y) =
                    (middle[0] + random(size) - size / 2.0, middle[1] + random(size) - size / 2.0);
                c.vertex_3f(x / 75.0 - 1.0, y / 45.0 - 1.0, middle[2] + random(0.4) - 0.2);
            }
        }
        c.end();
    };
    c.depth_func(gl::GEQUAL);
    triangles(&mut c, 3, 12, 220.0);
    c.finish();
    triangles(&mut c, 4, 20, 12.0);
    c.enable(gl::SCISSOR_TEST);
    c.scissor(90, 20, 17, 30);
    c.clear(gl::DEPTH_BUFFER_BIT);
    c.disable(gl::SCISSOR_TEST);
    c.finish();
    c.depth_func(func);
    c.enable(gl::BLEND);
    c.blend_func(gl::ONE, gl::ONE);
    triangles(&mut c, 3, 12, 220.0);
    c.bind_framebuffer(gl::DRAW_FRAMEBUFFER, resolved);
    c.blit_framebuffer(
        0,
        0,
        150,
        90,
        0,
        0,
        150,
        90,
        gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT,
        gl::NEAREST,
    );
    c.bind_framebuffer(gl::READ_FRAMEBUFFER, resolved);
    let found = (c.bytes(), c.depths());
    assert_eq!(c.get_error(), gl::NO_ERROR);
    found
}

#[test]
fn what_is_drawn_again_meets_its_own_depths() {
    for (samples, format) in [
        (0, gl::DEPTH_COMPONENT24),
        (0, gl::DEPTH_COMPONENT32F),
        (4, gl::DEPTH_COMPONENT24),
        (4, gl::DEPTH_COMPONENT32F),
    ] {
        for func in [gl::GEQUAL, gl::LEQUAL, gl::EQUAL, gl::GREATER, gl::NOTEQUAL, gl::ALWAYS] {
            let (colors, depths) = again(samples, format, func, Way::Everything, false);
            assert!(colors.iter().filter(|pixel| **pixel != [0; 4]).count() > 9000);
            for (way, strips) in [
                (Way::Tiny, false),
                (Way::LateDepth, false),
                (Way::Tiny, true),
                (Way::Everything, true),
            ] {
                let (other_colors, other_depths) = again(samples, format, func, way, strips);
                let case = format!(
                    "{samples} samples of {format:#x}, {func:#x}: {way:?}, strips: {strips}"
                );
                assert_eq!(
                    colors.iter().zip(&other_colors).filter(|(a, b)| a != b).count(),
                    0,
                    "{case}"
                );
                let differ = depths
                    .iter()
                    .zip(&other_depths)
                    .filter(|(a, b)| a.to_bits() != b.to_bits())
                    .count();
                assert_eq!(differ, 0, "depths, {case}");
            }
        }
    }
}

/// Random small triangles, some across the near plane, and lines and points between them, of one
/// colour: given once, or with every vertex.
fn one_color(again: bool, prepare: fn(&mut Stage)) -> Vec<[u8; 4]> {
    let mut c = Stage::new(150, 90);
    prepare(&mut c);
    c.enable(gl::BLEND);
    c.blend_func(gl::SRC_ALPHA, gl::ONE_MINUS_SRC_ALPHA);
    let mut state = 9u32;
    let mut random = move |below: f32| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32 * below
    };
    for (mode, count) in [(gl::TRIANGLES, 300), (gl::LINES, 60), (gl::POINTS, 60)] {
        for color in [[1.5, 0.3, -0.2, 0.4], [0.1, 0.6, 0.9, 0.8]] {
            c.color_4f(color[0], color[1], color[2], color[3]);
            c.begin(mode);
            for _ in 0..count / 3 {
                let middle = [random(2.0) - 1.0, random(2.0) - 1.0, random(2.2) - 1.1];
                for _ in 0..6 {
                    if again {
                        c.color_4f(color[0], color[1], color[2], color[3]);
                    }
                    let w = 1.0 + random(2.0);
                    let at = |k: usize, away: f32| (middle[k] + away) * w;
                    c.vertex_4f(at(0, random(0.4)), at(1, random(0.4)), at(2, random(0.3)), w);
                }
            }
            c.end();
        }
    }
    assert_eq!(c.get_error(), gl::NO_ERROR);
    c.bytes()
}

#[test]
fn one_color_for_all_vertices_looks_like_the_same_color_at_each() {
    let prepare: [fn(&mut Stage); 4] = [
        |_| {},
        |c| c.enable(gl::LINE_SMOOTH),
        |c| {
            c.enable(gl::POINT_SMOOTH);
            c.enable(gl::POLYGON_SMOOTH);
            c.point_size(3.0);
        },
        |c| {
            c.enable(gl::LINE_STIPPLE);
            c.line_stipple(2, 0x5a5a);
            c.polygon_mode(gl::FRONT, gl::LINE);
        },
    ];
    for (number, prepare) in prepare.into_iter().enumerate() {
        let (once, again) = (one_color(false, prepare), one_color(true, prepare));
        assert!(once.iter().filter(|pixel| **pixel != [0; 4]).count() > 2000);
        let away =
            |(a, b): (&[u8; 4], &[u8; 4])| (0..4).map(|k| a[k].abs_diff(b[k])).max().unwrap();
        // Where a triangle is clipped, interpolation of equal colours may round.
        let differ = |by: u8| once.iter().zip(&again).filter(|pair| away(*pair) > by).count();
        assert!(
            differ(0) <= 10 && differ(1) == 0,
            "case {number}: {} and {}",
            differ(0),
            differ(1)
        );
    }
}

/// So many triangles that a pass draws them in several rounds; each shows, as later ones mix with
/// what is there.
fn many(flush: bool) -> Vec<[u8; 4]> {
    let mut c = Stage::new(150, 90);
    c.enable(gl::BLEND);
    c.blend_func(gl::SRC_ALPHA, gl::ONE_MINUS_SRC_ALPHA);
    c.enable(gl::DEPTH_TEST);
    c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT);
    for part in 0..14u32 {
        c.begin(gl::TRIANGLES);
        for k in 0..10_000u32 {
            let number = (part * 10_000 + k).wrapping_mul(2_654_435_761);
            let (x, y, z) = (number >> 22, number >> 12 & 0x3ff, number & 0xfff);
            let at = |v: u32| v as f32 / 512.0 - 1.0;
            c.color_4f((k % 7) as f32 / 6.0, (k % 5) as f32 / 4.0, part as f32 / 13.0, 0.5);
            c.vertex_3f(at(x), at(y), z as f32 / 4096.0);
            c.vertex_3f(at(x) + 0.03, at(y), z as f32 / 4096.0);
            c.vertex_3f(at(x), at(y) + 0.03, 0.0);
        }
        c.end();
        if part == 6 {
            c.enable(gl::SCISSOR_TEST);
            c.scissor(20, 20, 40, 40);
            c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT);
            c.disable(gl::SCISSOR_TEST);
        }
        if flush {
            c.finish();
        }
    }
    assert_eq!(c.get_error(), gl::NO_ERROR);
    c.bytes()
}

#[test]
fn a_pass_in_rounds_draws_what_passes_one_after_the_other_draw() {
    let differ = many(false).iter().zip(&many(true)).filter(|(a, b)| a != b).count();
    assert_eq!(differ, 0);
}

/// A floor that reaches behind the eye is cut near it, far outside of the picture: depth is still
/// that of the plane.
#[test]
fn a_cut_floor_has_the_depths_of_its_plane() {
    const SIDE: i32 = 84;
    let (near, far, height, half) = (0.08, 400.0, 6.0, 0.414);
    for (reach, turn) in [(40.0, 90.0), (100.0, 60.0), (400.0, 45.0), (400.0, 90.0)] {
        let mut c = Stage::new(SIDE, SIDE);
        c.matrix_mode(gl::PROJECTION);
        c.frustum(-half * near, half * near, -half * near, half * near, near, far);
        c.matrix_mode(gl::MODELVIEW);
        c.rotatef(35.0, 1.0, 0.0, 0.0);
        c.translatef(0.0, -6.0, 0.0);
        c.rotatef(turn, 0.0, 1.0, 0.0);
        c.enable(gl::DEPTH_TEST);
        c.clear(gl::DEPTH_BUFFER_BIT);
        c.begin(gl::QUADS);
        for [x, z] in [[-reach, -reach], [reach, -reach], [reach, reach], [-reach, reach]] {
            c.vertex_3f(x, 0.0, z);
        }
        c.end();
        let down = 35f64.to_radians();
        let (sine, cosine) = (vitral_math::func::sin(down), vitral_math::func::cos(down));
        let mut seen = 0;
        for (i, depth) in c.depths().into_iter().enumerate().filter(|(_, depth)| *depth < 1.0) {
            let up = ((i as i32 / SIDE) as f64 + 0.5) / f64::from(SIDE) * 2.0 - 1.0;
            let distance = height / (sine - cosine * half * up);
            let expected = far / (far - near) * (1.0 - near / distance);
            let error = (f64::from(depth) - expected) * f64::from(1 << 24);
            assert!(error.abs() < 10.0, "{error} units at {i}, {reach} wide, turned by {turn}");
            seen += 1;
        }
        assert!(seen > 1000, "{seen}");
    }
}
