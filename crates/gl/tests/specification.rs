//! Corners of the specification, each worked out by hand: clipping and depth, polygon offset,
//! provoking vertices, level selection, window-system buffers, pixel transfer, feedback,
//! evaluators, accumulation.

use crate::common::{BUFFER, Stage, assert_color};
use vitral_gl::{OSMESA_ARGB, OSMESA_BGR, OSMESA_BGRA, enums as gl};

#[test]
fn a_floor_through_the_eye_with_depth_clamp() {
    // Near 1, far 3: depth in ndc is 2 - 3 / d. The floor y = -1/2 is at distance 0.5 / |y| of a
    // pixel at y in ndc.
    for range in [[0.0, 1.0], [0.25, 0.75], [1.0, 0.0]] {
        let mut c = Stage::new(32, 32);
        c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT);
        c.frustum(-1.0, 1.0, -1.0, 1.0, 1.0, 3.0);
        c.enable(gl::DEPTH_TEST);
        c.depth_func(gl::ALWAYS);
        c.enable(gl::DEPTH_CLAMP);
        c.depth_range(range[0], range[1]);
        c.begin(gl::QUADS);
        for [x, z] in [[-500.0, 50.0], [500.0, 50.0], [500.0, -400.0], [-500.0, -400.0]] {
            c.vertex_3f(x, -0.5, z);
        }
        c.end();
        let (depths, colors) = (c.depths(), c.bytes());
        for y in 0..16 {
            let ndc = (y as f64 + 0.5) / 16.0 - 1.0;
            let depth = (2.0 - 3.0 / (0.5 / -ndc)).clamp(-1.0, 1.0) * 0.5 + 0.5;
            let expected = range[0] + depth * (range[1] - range[0]);
            for x in 0..32 {
                assert_eq!(colors[y * 32 + x][0], 255, "({x}, {y}) is not covered");
                let found = f64::from(depths[y * 32 + x]);
                assert!(
                    (found - expected).abs() < 1e-4,
                    "({x}, {y}): {found} instead of {expected}"
                );
            }
        }
        assert!(colors[17 * 32..].iter().all(|p| p[0] == 0));
    }
}

#[test]
fn depth_clamp_of_lines_and_points() {
    let mut c = Stage::new(32, 4);
    c.clear(gl::DEPTH_BUFFER_BIT);
    c.enable(gl::DEPTH_TEST);
    c.depth_func(gl::ALWAYS);
    c.enable(gl::DEPTH_CLAMP);
    c.begin(gl::LINES);
    c.vertex_3f(-1.0, 0.25, -3.0);
    c.vertex_3f(1.0, 0.25, 3.0);
    c.end();
    let depths = c.depths();
    for x in 0..32 {
        let expected = (((x as f32 + 0.5) / 16.0 - 1.0) * 3.0).clamp(-1.0, 1.0) * 0.5 + 0.5;
        assert!(
            (depths[2 * 32 + x] - expected).abs() < 1e-4,
            "{x}: {} instead of {expected}",
            depths[64 + x]
        );
    }
    c.depth_range(0.25, 0.5);
    c.begin(gl::POINTS);
    c.vertex_3f(0.0, -0.6, -9.0);
    c.vertex_3f(0.5, -0.6, 9.0);
    c.end();
    let depths = c.depths();
    assert!((depths[16] - 0.25).abs() < 1e-6 && (depths[24] - 0.5).abs() < 1e-6);
    // Without clamping they are clipped.
    c.disable(gl::DEPTH_CLAMP);
    c.clear(gl::DEPTH_BUFFER_BIT);
    c.begin(gl::POINTS);
    c.vertex_3f(0.0, -0.6, -9.0);
    c.end();
    assert_eq!(c.depths()[16], 1.0);
}

#[test]
fn near_and_far_clip_polygons_by_their_depth() {
    // z runs from -3 to 3 across the window: a third of it is inside.
    let mut c = Stage::new(30, 4);
    c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT);
    c.enable(gl::DEPTH_TEST);
    c.begin(gl::QUADS);
    for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
        c.vertex_3f(x, y, 3.0 * x);
    }
    c.end();
    let (depths, colors) = (c.depths(), c.bytes());
    for x in 0..30 {
        let z = (x as f32 + 0.5) / 5.0 - 3.0;
        assert_eq!(colors[30 + x][0] == 255, z.abs() < 1.0, "{x}");
        if z.abs() < 1.0 {
            assert!((depths[30 + x] - (z * 0.5 + 0.5)).abs() < 1e-5);
        }
    }
}

#[test]
fn polygon_offset_is_slope_times_factor_and_units() {
    let mut c = Stage::new(8, 8);
    c.enable(gl::DEPTH_TEST);
    c.depth_func(gl::ALWAYS);
    let depths = |c: &mut Stage, factor: f32, units: f32, slope: f32| {
        c.polygon_offset(factor, units);
        c.begin(gl::QUADS);
        for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
            c.vertex_3f(x, y, -0.5 + slope * x);
        }
        c.end();
        f64::from(c.depths()[27]) * 16_777_215.0
    };
    let plain = depths(&mut c, 3.0, 8.0, 0.0);
    c.enable(gl::POLYGON_OFFSET_FILL);
    // The unit is two steps of 24 bits.
    for units in [1.0, 8.0, -64.0] {
        let moved = depths(&mut c, 3.0, units, 0.0);
        assert!(
            (moved - plain - 2.0 * f64::from(units)).abs() < 1.01,
            "{units}: {}",
            moved - plain
        );
    }
    // Depth changes by 0.25 * 0.5 / 4 for a pixel.
    c.disable(gl::POLYGON_OFFSET_FILL);
    let plain = depths(&mut c, 0.0, 0.0, 0.25);
    c.enable(gl::POLYGON_OFFSET_FILL);
    let moved = depths(&mut c, 2.0, 0.0, 0.25);
    assert!(((moved - plain) / 16_777_215.0 - 2.0 * 0.03125).abs() < 1e-6);
    // The result is clamped.
    assert_eq!(depths(&mut c, 0.0, 1e9, 0.0), 16_777_215.0);
    assert_eq!(depths(&mut c, 0.0, -1e9, 0.0), 0.0);
}

#[test]
fn provoking_vertices_of_all_primitives() {
    // Vertex i has red i * 20; the last pixel drawn by a primitive tells whose colour it has.
    let table: [(u32, &[[f32; 2]], u8); 9] = [
        (gl::TRIANGLES, &[[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]], 2),
        (gl::TRIANGLE_STRIP, &[[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]], 2),
        (gl::TRIANGLE_FAN, &[[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]], 2),
        (gl::QUADS, &[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]], 3),
        (gl::QUAD_STRIP, &[[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]], 3),
        (gl::POLYGON, &[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]], 0),
        (gl::LINES, &[[-1.0, 0.0], [1.0, 0.0]], 1),
        (gl::LINE_STRIP, &[[-1.0, 0.0], [1.0, 0.0]], 1),
        (gl::LINE_LOOP, &[[-1.0, 0.0], [1.0, 0.0]], 0),
    ];
    let mut c = Stage::new(8, 8);
    c.shade_model(gl::FLAT);
    c.line_width(9.0);
    for (mode, vertices, provoking) in table {
        c.clear(gl::COLOR_BUFFER_BIT);
        c.begin(mode);
        for (i, [x, y]) in vertices.iter().enumerate() {
            c.color_3ub(i as u8 * 20 + 10, 0, 0);
            c.vertex_2f(*x, *y);
        }
        c.end();
        for [x, y] in [[1, 3], [6, 4], [4, 4]] {
            assert_eq!(c.pixel(x, y)[0], provoking * 20 + 10, "{mode:#x} ({x}, {y})");
        }
    }
}

/// A window filled with a texture whose level 0 is red, level 1 green, so large that `lod` levels
/// are skipped.
fn mixed_levels(mag: u32, min: u32, lod: f64) -> [u8; 4] {
    let mut c = Stage::new(16, 16);
    let level = |size: usize, color: [u8; 4]| (size as i32, vec![color; size * size]);
    let blue = [0, 0, 255, 255];
    c.texture(&[
        level(8, [255, 0, 0, 255]),
        level(4, [0, 255, 0, 255]),
        level(2, blue),
        level(1, blue),
    ]);
    c.tex_parameteri(gl::TEXTURE_2D, gl::TEXTURE_MAG_FILTER, mag as i32);
    c.tex_parameteri(gl::TEXTURE_2D, gl::TEXTURE_MIN_FILTER, min as i32);
    // The rectangle's coordinates run from 0 to 1 over 16 pixels: texels per pixel are 8 s / 16.
    let s = 2.0 * vitral_math::func::exp2(lod);
    c.matrix_mode(gl::TEXTURE);
    c.scaled(s, s, 1.0);
    c.clear(gl::COLOR_BUFFER_BIT);
    c.fill([1.0; 4], 0.0);
    c.no_error();
    c.pixel(5, 5)
}

#[test]
fn magnification_ends_at_a_half_for_linear_over_nearest_mipmap() {
    let near = |found: [u8; 4], red: f64| (f64::from(found[0]) - 255.0 * red).abs() < 4.0;
    // MAG LINEAR with NEAREST_MIPMAP_*: c = 1/2.
    let min = gl::NEAREST_MIPMAP_LINEAR;
    assert_eq!(mixed_levels(gl::LINEAR, min, 0.3), [255, 0, 0, 255]);
    assert!(near(mixed_levels(gl::LINEAR, min, 0.6), 0.4));
    assert_eq!(mixed_levels(gl::LINEAR, gl::NEAREST_MIPMAP_NEAREST, 0.45), [255, 0, 0, 255]);
    assert_eq!(mixed_levels(gl::LINEAR, gl::NEAREST_MIPMAP_NEAREST, 0.55), [0, 255, 0, 255]);
    // All others: c = 0.
    assert!(near(mixed_levels(gl::NEAREST, min, 0.3), 0.7));
    assert!(near(mixed_levels(gl::LINEAR, gl::LINEAR_MIPMAP_LINEAR, 0.3), 0.7));
}

#[test]
fn window_system_buffers_of_all_formats() {
    let table: [(u32, &[u8]); 5] = [
        (gl::RGBA, &[255, 51, 102, 204]),
        (OSMESA_BGRA, &[102, 51, 255, 204]),
        (OSMESA_ARGB, &[204, 255, 51, 102]),
        (gl::RGB, &[255, 51, 102]),
        (OSMESA_BGR, &[102, 51, 255]),
    ];
    for (format, expected) in table {
        let mut c = Stage::with_buffer(3, 2, format, gl::UNSIGNED_BYTE);
        c.fill([1.0, 0.2, 0.4, 0.8], 0.0);
        c.finish();
        let n = expected.len();
        let bytes: Vec<u8> = c.take(BUFFER, 6 * n);
        assert!(bytes.chunks(n).all(|pixel| pixel == expected), "{format:#x}: {bytes:?}");
    }
}

#[test]
fn each_component_has_its_own_pixel_map() {
    let mut c = Stage::new(2, 2);
    c.clear(gl::COLOR_BUFFER_BIT);
    let maps = [
        (gl::PIXEL_MAP_R_TO_R, [0.0f32, 0.2]),
        (gl::PIXEL_MAP_G_TO_G, [0.4, 0.6]),
        (gl::PIXEL_MAP_B_TO_B, [0.8, 1.0]),
        (gl::PIXEL_MAP_A_TO_A, [0.6, 0.0]),
    ];
    for (map, values) in maps {
        let at = c.put(&values);
        c.pixel_mapfv(map, 2, at);
    }
    c.pixel_transferi(gl::MAP_COLOR, 1);
    let pixels = c.put(&[[0u8, 0, 0, 0], [255, 255, 255, 255], [255, 0, 255, 0], [0, 255, 0, 255]]);
    c.raster_pos_2f(-1.0, -1.0);
    c.draw_pixels(2, 2, gl::RGBA, gl::UNSIGNED_BYTE, pixels);
    c.pixel_transferi(gl::MAP_COLOR, 0);
    let expected = [[0, 102, 204, 153], [51, 153, 255, 0], [51, 102, 255, 153], [0, 153, 204, 0]];
    assert_eq!(c.bytes(), expected);
}

#[test]
fn index_shift_and_offset_come_before_the_maps() {
    let mut c = Stage::new(4, 1);
    c.clear(gl::COLOR_BUFFER_BIT);
    // Index 2 i + 1 for i = 0..4 in maps of 8.
    for (map, scale) in [
        (gl::PIXEL_MAP_I_TO_R, 0.1f32),
        (gl::PIXEL_MAP_I_TO_G, 0.05),
        (gl::PIXEL_MAP_I_TO_B, 0.0),
        (gl::PIXEL_MAP_I_TO_A, 0.125),
    ] {
        let values: Vec<f32> = (0..8).map(|i| i as f32 * scale).collect();
        let at = c.put(&values);
        c.pixel_mapfv(map, 8, at);
    }
    c.pixel_transferi(gl::INDEX_SHIFT, 1);
    c.pixel_transferi(gl::INDEX_OFFSET, 1);
    let pixels = c.put(&[0u8, 1, 2, 3]);
    c.raster_pos_2f(-1.0, -1.0);
    c.draw_pixels(4, 1, gl::COLOR_INDEX, gl::UNSIGNED_BYTE, pixels);
    for (i, found) in c.bytes().into_iter().enumerate() {
        let index = (2 * i + 1) as f32;
        assert_color(found, [index * 0.1, index * 0.05, 0.0, index * 0.125]);
    }
    // A bitmap of indices: bits are the numbers 0 and 1.
    c.pixel_transferi(gl::INDEX_SHIFT, 0);
    c.pixel_transferi(gl::INDEX_OFFSET, 0);
    let bits = c.put(&[0b0101_0000u8]);
    c.draw_pixels(4, 1, gl::COLOR_INDEX, gl::BITMAP, bits);
    c.no_error();
    for (i, found) in c.bytes().into_iter().enumerate() {
        let bit = (i % 2) as f32;
        assert_color(found, [bit * 0.1, bit * 0.05, 0.0, bit * 0.125]);
    }
}

#[test]
fn fog_reaches_images_by_the_raster_distance() {
    let mut c = Stage::new(2, 2);
    c.clear(gl::COLOR_BUFFER_BIT);
    let color = c.put(&[0.0f32, 1.0, 0.0, 1.0]);
    c.fogfv(gl::FOG_COLOR, color);
    c.fogi(gl::FOG_MODE, gl::LINEAR as i32);
    c.fogf(gl::FOG_START, 0.0);
    c.fogf(gl::FOG_END, 1.0);
    c.enable(gl::FOG);
    c.raster_pos_3f(-1.0, -1.0, -0.25);
    let pixels = c.put(&[[1.0f32, 0.0, 0.0, 0.5]; 4]);
    c.draw_pixels(2, 2, gl::RGBA, gl::FLOAT, pixels);
    // f = 1 - 0.25.
    assert_color(c.pixel(0, 0), [0.75, 0.25, 0.0, 0.5]);
    assert_color(c.pixel(1, 1), [0.75, 0.25, 0.0, 0.5]);
}

#[test]
fn fog_takes_the_distance_that_its_mode_says() {
    let radius = (1.0f32 + 1.0 + 0.0625).sqrt();
    let modes = [
        (gl::EYE_PLANE_ABSOLUTE_NV, -0.25, 0.25),
        (gl::EYE_PLANE_ABSOLUTE_NV, 0.25, 0.25),
        (gl::EYE_PLANE, -0.25, 0.25),
        (gl::EYE_PLANE, 0.25, 0.0),
        (gl::EYE_RADIAL_NV, -0.25, radius),
        (gl::EYE_RADIAL_NV, 0.25, radius),
    ];
    for (mode, z, distance) in modes {
        let mut c = Stage::new(2, 2);
        c.clear(gl::COLOR_BUFFER_BIT);
        c.fogi(gl::FOG_MODE, gl::LINEAR as i32);
        c.fogf(gl::FOG_END, 2.0);
        c.fogi(gl::FOG_DISTANCE_MODE_NV, mode as i32);
        c.enable(gl::FOG);
        let f = 1.0 - distance / 2.0;

        // By the raster position.
        c.raster_pos_3f(-1.0, -1.0, z);
        let pixels = c.put(&[[1.0f32, 0.5, 0.0, 1.0]; 4]);
        c.draw_pixels(2, 2, gl::RGBA, gl::FLOAT, pixels);
        assert_color(c.pixel(0, 0), [f, 0.5 * f, 0.0, 1.0]);

        // By the corners of a square, which all are as far away.
        c.clear(gl::COLOR_BUFFER_BIT);
        c.color_3f(1.0, 0.5, 0.0);
        c.begin(gl::QUADS);
        for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
            c.vertex_3f(x, y, z);
        }
        c.end();
        assert_color(c.pixel(1, 0), [f, 0.5 * f, 0.0, 1.0]);
    }
}

#[test]
fn the_first_or_the_last_corner_colours_a_flat_element() {
    let colors = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 0, 255]];
    let corners = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]];
    let drawn = |mode: u32, convention: u32, order: [usize; 4], count: usize, at: [i32; 2]| {
        let mut c = Stage::new(8, 8);
        c.clear(gl::COLOR_BUFFER_BIT);
        c.shade_model(gl::FLAT);
        c.provoking_vertex(convention);
        assert_eq!(c.get_error(), gl::NO_ERROR);
        c.begin(mode);
        for k in &order[..count] {
            let [r, g, b, _] = colors[*k].map(|v: u8| f32::from(v) / 255.0);
            c.color_3f(r, g, b);
            c.vertex_2f(corners[*k][0], corners[*k][1]);
        }
        c.end();
        let color = c.pixel(at[0], at[1]);
        colors.iter().position(|known| *known == color).unwrap_or(9)
    };
    let (first, last) = (gl::FIRST_VERTEX_CONVENTION, gl::LAST_VERTEX_CONVENTION);
    for (mode, order, count, at, expected) in [
        (gl::TRIANGLES, [0, 1, 2, 3], 3, [1, 1], [0, 2]),
        (gl::TRIANGLE_STRIP, [0, 1, 2, 3], 4, [1, 1], [0, 2]),
        (gl::TRIANGLE_STRIP, [0, 1, 2, 3], 4, [6, 6], [1, 3]),
        (gl::TRIANGLE_FAN, [0, 1, 3, 2], 4, [6, 1], [1, 3]),
        (gl::QUADS, [0, 1, 3, 2], 4, [6, 1], [2, 2]),
        (gl::POLYGON, [0, 1, 3, 2], 4, [6, 1], [0, 0]),
    ] {
        let found = [first, last].map(|convention| drawn(mode, convention, order, count, at));
        assert_eq!(found, expected, "{mode:#x}");
    }
}

#[test]
fn zoomed_pixels_have_their_left_and_lower_boundaries() {
    for (zoom, origin) in
        [(-1.5f32, 20.0f32), (-0.5, 20.0), (-1.0, 20.5), (-1.0, 20.0), (1.0, 4.5), (1.5, 4.0)]
    {
        // What columns show is the same for rows, and for pixels that are copied.
        for (axis, copied) in [(0, false), (1, false), (0, true), (1, true)] {
            let mut c = Stage::new(32, 32);
            c.clear(gl::COLOR_BUFFER_BIT);
            let size = if axis == 0 { [8, 1] } else { [1, 8] };
            let pixels =
                c.put(&std::array::from_fn::<[u8; 4], 8, _>(|i| [10 * (i as u8 + 1), 0, 0, 255]));
            let start = |c: &mut Stage, origin: f32| {
                c.window_pos_2f(
                    if axis == 0 { origin } else { 28.0 },
                    if axis == 0 { 28.0 } else { origin },
                );
            };
            if copied {
                start(&mut c, 22.0);
                c.draw_pixels(size[0], size[1], gl::RGBA, gl::UNSIGNED_BYTE, pixels);
            }
            start(&mut c, origin);
            c.pixel_zoom(if axis == 0 { zoom } else { 1.0 }, if axis == 0 { 1.0 } else { zoom });
            if copied {
                let from = if axis == 0 { [22, 28] } else { [28, 22] };
                c.copy_pixels(from[0], from[1], size[0], size[1], gl::COLOR);
            } else {
                c.draw_pixels(size[0], size[1], gl::RGBA, gl::UNSIGNED_BYTE, pixels);
            }
            for at in 0..22 {
                let center = at as f32 + 0.5;
                let ends = |i: usize| [origin + zoom * i as f32, origin + zoom * (i + 1) as f32];
                let holds = |i: &usize| {
                    ends(*i)[0].min(ends(*i)[1]) <= center && center < ends(*i)[0].max(ends(*i)[1])
                };
                let expected = (0..8).find(holds).map_or(0, |i| 10 * (i as u8 + 1));
                let found = if axis == 0 { c.pixel(at, 28) } else { c.pixel(28, at) };
                assert_eq!(
                    found[0], expected,
                    "zoom {zoom} from {origin}, axis {axis}, copied {copied}, {at}"
                );
            }
        }
    }
}

#[test]
fn luminance_of_unsigned_integers_is_scaled_by_their_largest() {
    let mut c = Stage::new(2, 1);
    let pixels = c.put(&[u32::MAX / 5, u32::MAX]);
    c.raster_pos_2f(-1.0, -1.0);
    c.draw_pixels(2, 1, gl::LUMINANCE, gl::UNSIGNED_INT, pixels);
    assert_eq!(c.bytes(), [[51, 51, 51, 255], [255; 4]]);
    // Read back, luminance is the sum of red, green and blue, clamped.
    let into = c.put(&[0u32; 2]);
    c.read_pixels(0, 0, 2, 1, gl::LUMINANCE, gl::UNSIGNED_INT, into);
    let found: Vec<u32> = c.take(into, 2);
    assert!(
        (f64::from(found[0]) / f64::from(u32::MAX) - 0.6).abs() < 1e-6 && found[1] == u32::MAX,
        "{found:?}"
    );
}

#[test]
fn border_texels_are_sampled_beyond_the_edge() {
    // 1 x 1 inside, a border of one texel: blue inside, red around.
    let mut c = Stage::new(6, 6);
    let red = [255u8, 0, 0, 255];
    let mut texels = vec![red; 9];
    texels[4] = [0, 0, 255, 255];
    let at = c.put(&texels);
    c.tex_image_2d(gl::TEXTURE_2D, 0, gl::RGBA as i32, 3, 3, 1, gl::RGBA, gl::UNSIGNED_BYTE, at);
    for (name, value) in [
        (gl::TEXTURE_MIN_FILTER, gl::NEAREST),
        (gl::TEXTURE_MAG_FILTER, gl::NEAREST),
        (gl::TEXTURE_WRAP_S, gl::CLAMP_TO_BORDER),
        (gl::TEXTURE_WRAP_T, gl::CLAMP_TO_BORDER),
    ] {
        c.tex_parameteri(gl::TEXTURE_2D, name, value as i32);
    }
    c.tex_envi(gl::TEXTURE_ENV, gl::TEXTURE_ENV_MODE, gl::REPLACE as i32);
    c.enable(gl::TEXTURE_2D);
    // Coordinates from -1 to 2 over the window.
    c.matrix_mode(gl::TEXTURE);
    c.translatef(-1.0, -1.0, 0.0);
    c.scalef(3.0, 3.0, 1.0);
    c.fill([1.0; 4], 0.0);
    c.no_error();
    let found = c.bytes();
    for (i, pixel) in found.into_iter().enumerate() {
        let inside = [i % 6, i / 6].iter().all(|k| (2..4).contains(k));
        assert_eq!(pixel, if inside { [0, 0, 255, 255] } else { red }, "{i}");
    }
    // CLAMP with LINEAR: half of the border at coordinate 1.
    for (name, value) in [
        (gl::TEXTURE_MIN_FILTER, gl::LINEAR),
        (gl::TEXTURE_MAG_FILTER, gl::LINEAR),
        (gl::TEXTURE_WRAP_S, gl::CLAMP),
        (gl::TEXTURE_WRAP_T, gl::CLAMP_TO_EDGE),
    ] {
        c.tex_parameteri(gl::TEXTURE_2D, name, value as i32);
    }
    c.fill([1.0; 4], 0.0);
    assert_color(c.pixel(5, 3), [0.5, 0.0, 0.5, 1.0]);
}

#[test]
fn an_incomplete_2d_texture_switches_its_unit_off_even_with_1d_enabled() {
    let mut c = Stage::new(2, 2);
    let at = c.put(&[[0u8, 255, 0, 255]]);
    c.tex_image_1d(gl::TEXTURE_1D, 0, gl::RGBA as i32, 1, 0, gl::RGBA, gl::UNSIGNED_BYTE, at);
    c.tex_parameteri(gl::TEXTURE_1D, gl::TEXTURE_MIN_FILTER, gl::NEAREST as i32);
    c.tex_envi(gl::TEXTURE_ENV, gl::TEXTURE_ENV_MODE, gl::REPLACE as i32);
    c.enable(gl::TEXTURE_1D);
    c.fill([1.0, 0.0, 0.0, 1.0], 0.0);
    assert_eq!(c.pixel(0, 0), [0, 255, 0, 255]);
    // The higher dimension is the one in use; it is incomplete, so that texturing is as if
    // disabled.
    c.enable(gl::TEXTURE_2D);
    c.fill([1.0, 0.0, 0.0, 1.0], 0.0);
    assert_eq!(c.pixel(0, 0), [255, 0, 0, 255]);
}

/// What feedback of 2D vertices gives for `draw`.
fn feedback(c: &mut Stage, draw: impl FnOnce(&mut Stage)) -> Vec<f32> {
    let into = c.put(&[0.0f32; 64]);
    c.feedback_buffer(64, gl::_2D, into);
    c.render_mode(gl::FEEDBACK);
    draw(c);
    let count = c.render_mode(gl::RENDER);
    c.take(into, count as usize)
}

#[test]
fn feedback_of_lines_tells_where_the_stipple_begins_anew() {
    let mut c = Stage::new(16, 16);
    c.pixels();
    let strip = feedback(&mut c, |c| {
        c.begin(gl::LINE_STRIP);
        for [x, y] in [[1.0, 1.0], [5.0, 1.0], [5.0, 6.0]] {
            c.vertex_2f(x, y);
        }
        c.end();
    });
    let (reset, line) = (gl::LINE_RESET_TOKEN as f32, gl::LINE_TOKEN as f32);
    assert_eq!(strip, [reset, 1.0, 1.0, 5.0, 1.0, line, 5.0, 1.0, 5.0, 6.0]);
    let apart = feedback(&mut c, |c| {
        c.begin(gl::LINES);
        for [x, y] in [[1.0, 1.0], [5.0, 1.0], [5.0, 6.0], [2.0, 2.0]] {
            c.vertex_2f(x, y);
        }
        c.end();
    });
    assert_eq!(apart, [reset, 1.0, 1.0, 5.0, 1.0, reset, 5.0, 6.0, 2.0, 2.0]);
}

#[test]
fn feedback_of_a_quad_is_one_polygon() {
    let mut c = Stage::new(16, 16);
    c.pixels();
    let found = feedback(&mut c, |c| {
        c.pass_through(7.0);
        c.begin(gl::QUADS);
        for [x, y] in [[1.0, 1.0], [5.0, 1.0], [5.0, 6.0], [1.0, 6.0]] {
            c.vertex_2f(x, y);
        }
        c.end();
    });
    let head = [gl::PASS_THROUGH_TOKEN as f32, 7.0, gl::POLYGON_TOKEN as f32, 4.0];
    assert_eq!(found[..4], head);
    assert_eq!(found[4..], [1.0, 1.0, 5.0, 1.0, 5.0, 6.0, 1.0, 6.0]);
}

#[test]
fn evaluation_leaves_the_current_values_alone() {
    let mut c = Stage::new(8, 8);
    let points = c.put(&[-1.0f32, 0.1, 0.0, 1.0, 0.1, 0.0]);
    let colors = c.put(&[0.0f32, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0]);
    c.map_1f(gl::MAP1_VERTEX_3, 0.0, 1.0, 3, 2, points);
    c.map_1f(gl::MAP1_COLOR_4, 0.0, 1.0, 4, 2, colors);
    c.enable(gl::MAP1_VERTEX_3);
    c.enable(gl::MAP1_COLOR_4);
    c.clear(gl::COLOR_BUFFER_BIT);
    c.color_3f(1.0, 0.0, 0.0);
    c.begin(gl::LINES);
    c.eval_coord_1f(0.0);
    c.eval_coord_1f(1.0);
    c.end();
    assert_eq!(c.pixel(4, 4), [0, 255, 0, 255]);
    assert_eq!(c.get(gl::CURRENT_COLOR), [1.0, 0.0, 0.0, 1.0]);
}

#[test]
fn accumulation_holds_more_than_one() {
    let mut c = Stage::new(2, 2);
    c.clear_color(0.8, 0.4, 0.2, 1.0);
    c.clear(gl::COLOR_BUFFER_BIT | gl::ACCUM_BUFFER_BIT);
    // The range of the buffer is at least -1..1; sums of weights up to 1 are exact, and RETURN
    // clamps.
    c.accum(gl::LOAD, 0.5);
    c.accum(gl::ACCUM, 0.5);
    c.clear(gl::COLOR_BUFFER_BIT);
    c.accum(gl::RETURN, 1.0);
    assert_color(c.pixel(0, 0), [0.8, 0.4, 0.2, 1.0]);
    c.accum(gl::RETURN, 2.0);
    assert_color(c.pixel(0, 0), [1.0, 0.8, 0.4, 1.0]);
    c.clear_color(0.8, 0.4, 0.2, 1.0);
    c.clear(gl::COLOR_BUFFER_BIT);
    c.accum(gl::LOAD, 1.0);
    c.accum(gl::MULT, 0.5);
    c.accum(gl::ADD, 0.1);
    c.accum(gl::RETURN, 1.0);
    assert_color(c.pixel(1, 1), [0.5, 0.3, 0.2, 0.6]);
}

#[test]
fn what_does_nothing_is_still_not_allowed_between_begin_and_end() {
    let mut c = Stage::new(4, 4);
    let calls: [fn(&mut Stage); 5] = [
        |c| c.prioritize_textures(0, 0, 0),
        |c| c.multi_draw_arrays(gl::POINTS, 0, 0, 0),
        |c| c.multi_draw_elements(gl::POINTS, 0, gl::UNSIGNED_INT, 0, 0),
        |c| c.copy_buffer_sub_data(0, 0, 0, 0, 0),
        |c| c.draw_arrays(gl::POINTS, 0, 0),
    ];
    for (i, call) in calls.into_iter().enumerate() {
        for listed in [false, true] {
            // Of what a list cannot hold the error comes at once.
            if listed && i == 3 {
                continue;
            }
            if listed {
                c.new_list(1, gl::COMPILE);
                call(&mut c);
                c.end_list();
                c.no_error();
            }
            c.begin(gl::POINTS);
            if listed {
                c.call_list(1)
            } else {
                call(&mut c)
            }
            c.end();
            assert_eq!(c.get_error(), gl::INVALID_OPERATION, "call {i}");
        }
    }
}
