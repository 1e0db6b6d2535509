//! Coverage of points, lines and polygons, smooth and aliased, each worked out by hand.

use crate::common::Stage;
use vitral_gl::enums as gl;

/// Sum of alpha over a window of black.
fn alpha_sum(c: &mut Stage) -> f32 {
    c.bytes().iter().map(|p| f32::from(p[3]) / 255.0).sum()
}

#[test]
fn a_smooth_point_covers_its_area() {
    let mut c = Stage::new(32, 32);
    c.pixels();
    c.enable(gl::POINT_SMOOTH);
    for size in [1.0, 1.5, 2.0, 3.3, 5.0, 10.0, 20.0] {
        for center in [[16.0, 16.0], [15.5, 15.5], [16.2, 15.9]] {
            c.clear(gl::COLOR_BUFFER_BIT);
            c.point_size(size);
            c.begin(gl::POINTS);
            c.vertex_2f(center[0], center[1]);
            c.end();
            let (sum, area) = (alpha_sum(&mut c), std::f32::consts::PI * size * size / 4.0);
            assert!(
                (sum / area - 1.0).abs() < 0.03,
                "{size} at {center:?}: {sum} instead of {area}"
            );
        }
    }
}

#[test]
fn a_smooth_line_has_the_coverage_of_its_rectangle() {
    let mut c = Stage::new(32, 32);
    c.pixels();
    c.enable(gl::LINE_SMOOTH);
    let line = |c: &mut Stage, width: f32, [x0, y0, x1, y1]: [f32; 4]| {
        c.clear(gl::COLOR_BUFFER_BIT);
        c.line_width(width);
        c.begin(gl::LINES);
        c.vertex_2f(x0, y0);
        c.vertex_2f(x1, y1);
        c.end();
    };
    // From x 4.25 to 20.5, y from 8.3 to 10.7.
    line(&mut c, 2.4, [4.25, 9.5, 20.5, 9.5]);
    let profile: Vec<f32> = (7..12).map(|y| f32::from(c.pixel(10, y)[3]) / 255.0).collect();
    for (found, expected) in profile.iter().zip([0.0, 0.7, 1.0, 0.7, 0.0]) {
        assert!((found - expected).abs() < 0.01, "{profile:?}");
    }
    let ends: Vec<f32> = [3, 4, 20, 21].map(|x| f32::from(c.pixel(x, 9)[3]) / 255.0).to_vec();
    for (found, expected) in ends.iter().zip([0.0, 0.75, 0.5, 0.0]) {
        assert!((found - expected).abs() < 0.01, "{ends:?}");
    }
    for (width, [x, y]) in
        [(1.0, [24.0, 4.0]), (1.0, [20.0, 13.0]), (3.0, [11.0, 27.0]), (5.5, [25.0, 25.0])]
    {
        line(&mut c, width, [4.0, 4.0, x, y]);
        let (sum, area) =
            (alpha_sum(&mut c), width * ((x - 4.0) * (x - 4.0) + (y - 4.0) * (y - 4.0)).sqrt());
        assert!((sum / area - 1.0).abs() < 0.03, "{width} to ({x}, {y}): {sum} instead of {area}");
    }
}

#[test]
fn an_aliased_line_is_as_wide_as_the_nearest_whole_number() {
    let mut c = Stage::new(16, 16);
    c.pixels();
    for (width, expected) in
        [(0.3, 1), (1.0, 1), (1.6, 2), (2.4, 2), (2.5, 3), (2.76, 3), (3.5, 4), (4.6, 5)]
    {
        for [x, y] in [[13.0, 8.5], [8.5, 13.0], [13.0, 12.0], [12.0, 13.0]] {
            c.clear(gl::COLOR_BUFFER_BIT);
            c.line_width(width);
            c.begin(gl::LINES);
            c.vertex_2f(if x == 8.5 { x } else { 3.0 }, if y == 8.5 { y } else { 3.0 });
            c.vertex_2f(x, y);
            c.end();
            let bytes = c.bytes();
            // Across the longer axis in its middle.
            let drawn = (0..16)
                .filter(|&i| bytes[if x > y { i * 16 + 8 } else { 8 * 16 + i }][0] == 255)
                .count();
            assert_eq!(drawn, expected, "{width} to ({x}, {y})");
        }
    }
}

#[test]
fn a_point_sprite_covers_the_centres_in_its_square_and_counts_from_its_place() {
    let mut c = Stage::new(16, 16);
    c.pixels();
    c.enable(gl::POINT_SPRITE_ARB);
    c.tex_envi(gl::POINT_SPRITE_ARB, gl::COORD_REPLACE_ARB, 1);
    let texels: Vec<[u8; 4]> = (0..=255).map(|s| [s, 0, 0, 255]).collect();
    let texels = c.put(&texels);
    c.tex_image_2d(
        gl::TEXTURE_2D,
        0,
        gl::RGBA as i32,
        256,
        1,
        0,
        gl::RGBA,
        gl::UNSIGNED_BYTE,
        texels,
    );
    c.tex_parameteri(gl::TEXTURE_2D, gl::TEXTURE_MIN_FILTER, gl::NEAREST as i32);
    c.tex_parameteri(gl::TEXTURE_2D, gl::TEXTURE_MAG_FILTER, gl::NEAREST as i32);
    c.tex_envi(gl::TEXTURE_ENV, gl::TEXTURE_ENV_MODE, gl::REPLACE as i32);
    c.enable(gl::TEXTURE_2D);
    for (size, x, y) in [
        (2.0f32, 8.5f32, 7.5f32),
        (2.0, 8.25, 7.75),
        (3.5, 8.25, 6.0),
        (4.25, 5.5, 9.75),
        (1.0, 8.0, 8.0),
    ] {
        c.clear(gl::COLOR_BUFFER_BIT);
        c.point_size(size);
        c.begin(gl::POINTS);
        c.vertex_2f(x, y);
        c.end();
        for (i, pixel) in c.bytes().into_iter().enumerate() {
            let (px, py) = ((i % 16) as f32 + 0.5, (i / 16) as f32 + 0.5);
            let inside = |p: f32, middle: f32| p >= middle - size / 2.0 && p < middle + size / 2.0;
            let s = 0.5 + (px - x) / size;
            let expected =
                if inside(px, x) && inside(py, y) { [(s * 256.0) as u8, 255] } else { [0, 0] };
            assert_eq!(
                [pixel[0], pixel[3]],
                expected,
                "size {size} at ({x}, {y}): pixel ({px}, {py})"
            );
        }
    }
}

#[test]
fn a_smooth_polygon_covers_its_area() {
    let mut c = Stage::new(32, 32);
    c.pixels();
    c.enable(gl::POLYGON_SMOOTH);
    let triangles =
        [[[4.3, 5.1], [27.2, 9.4], [11.6, 26.8]], [[3.0, 3.0], [25.0, 3.0], [3.0, 25.0]]];
    for [a, b, d] in triangles {
        c.clear(gl::COLOR_BUFFER_BIT);
        c.begin(gl::TRIANGLES);
        for [x, y] in [a, b, d] {
            c.vertex_2f(x, y);
        }
        c.end();
        let area: f32 = ((b[0] - a[0]) * (d[1] - a[1]) - (b[1] - a[1]) * (d[0] - a[0])) / 2.0;
        let sum = alpha_sum(&mut c);
        assert!((sum / area - 1.0).abs() < 0.03, "{sum} instead of {area}");
        assert!(c.bytes().iter().any(|p| (40..=215).contains(&p[3])), "no soft border");
    }
    // The diagonal of a quad is no edge.
    c.clear(gl::COLOR_BUFFER_BIT);
    c.begin(gl::QUADS);
    for [x, y] in [[4.25, 4.5], [20.5, 4.5], [20.5, 17.0], [4.25, 17.0]] {
        c.vertex_2f(x, y);
    }
    c.end();
    let found = [[10, 4], [4, 10], [4, 4], [20, 12], [10, 17]]
        .map(|[x, y]| f32::from(c.pixel(x, y)[3]) / 255.0);
    for (found, expected) in found.iter().zip([0.5, 0.75, 0.375, 0.5, 0.0]) {
        assert!((found - expected).abs() < 0.01, "{found} instead of {expected}");
    }
    assert!((5..20).all(|x| (5..17).all(|y| c.bytes()[y * 32 + x][3] == 255)));
}
