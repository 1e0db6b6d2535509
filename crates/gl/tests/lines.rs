//! Lines and outlines of polygons, fragment by fragment: what clipping adds, what stipples count,
//! how far polygon offset moves.

use crate::common::Stage;
use vitral_gl::enums as gl;

/// Rows from the bottom, `#` where something was drawn.
fn rows(c: &mut Stage) -> Vec<String> {
    let width = c.size[0] as usize;
    let mark = |p: &[u8; 4]| if p[0] > 0 { '#' } else { '.' };
    c.bytes().chunks(width).map(|row| row.iter().map(mark).collect()).collect()
}

/// A window with pixels for units, empty.
fn paper(width: i32, height: i32) -> Stage {
    let mut c = Stage::new(width, height);
    c.pixels();
    c.clear(gl::COLOR_BUFFER_BIT);
    c
}

fn draw(c: &mut Stage, mode: u32, vertices: &[[f32; 2]]) {
    c.begin(mode);
    vertices.iter().for_each(|[x, y]| c.vertex_2f(*x, *y));
    c.end();
}

fn clip(c: &mut Stage, plane: u32, equation: [f64; 4]) {
    let equation = c.put(&equation);
    c.clip_plane(plane, equation);
    c.enable(plane);
}

/// A square whose lower left edges have no edge flag.
fn half_flagged(c: &mut Stage) {
    c.begin(gl::QUADS);
    for ([x, y], edge) in [([1.5, 1.5], 0), ([6.5, 1.5], 1), ([6.5, 6.5], 1), ([1.5, 6.5], 0)] {
        c.edge_flag(edge);
        c.vertex_2f(x, y);
    }
    c.end();
}

/// The specification leaves open which way halves are rounded; Mesa rounds those of points down,
/// and those of lines up.
#[test]
fn halves_of_point_sizes_are_rounded_down() {
    for (size, side) in [(0.5, 1), (1.5, 1), (1.6, 2), (2.5, 2), (2.6, 3), (3.5, 3)] {
        let mut c = paper(8, 8);
        c.point_size(size);
        draw(&mut c, gl::POINTS, &[[4.1, 4.1]]);
        let drawn = rows(&mut c).concat().matches('#').count();
        assert_eq!(drawn, side * side, "{size}");
    }
}

/// The viewport bounds the places of points and the middles of lines, not what is drawn round them.
#[test]
fn wide_points_and_lines_reach_over_the_viewport() {
    type Draw = fn(&mut Stage);
    let point: Draw = |c| draw(c, gl::POINTS, &[[4.5, 4.5]]);
    let line: Draw = |c| draw(c, gl::LINES, &[[4.5, 4.5], [8.5, 4.5]]);
    let triangle: Draw = |c| draw(c, gl::TRIANGLES, &[[4.5, 4.5], [8.5, 4.5], [4.5, 8.5]]);
    let outline = |mode: u32, c: &mut Stage| c.polygon_mode(gl::FRONT_AND_BACK, mode);
    let fill: Draw = |c| draw(c, gl::TRIANGLES, &[[-9.0, 4.5], [40.0, 4.5], [4.5, 60.0]]);
    for (enabled, figure) in [
        (0, point),
        (gl::POINT_SMOOTH, point),
        (gl::POINT_SPRITE_ARB, point),
        (0, line),
        (gl::LINE_SMOOTH, line),
        (gl::LINE_STIPPLE, line),
        (gl::POINT, triangle),
        (gl::LINE, triangle),
    ] {
        // What the whole window shows, as if it were the viewport, a scissor, and the viewport with
        // a filled triangle.
        let picture = |view: bool, scissor: bool, filled: bool| {
            let mut c = paper(16, 16);
            match enabled {
                0 => {}
                gl::POINT | gl::LINE => outline(enabled, &mut c),
                _ => c.enable(enabled),
            }
            c.point_size(5.0);
            c.line_width(5.0);
            if scissor {
                c.scissor(4, 4, 8, 8);
                c.enable(gl::SCISSOR_TEST);
            }
            if view {
                c.viewport(4, 4, 8, 8);
                c.load_identity();
                c.ortho(4.0, 12.0, 4.0, 12.0, -1.0, 1.0);
            }
            figure(&mut c);
            if filled {
                c.polygon_mode(gl::FRONT_AND_BACK, gl::FILL);
                fill(&mut c);
            }
            rows(&mut c)
        };
        let whole = picture(false, false, false);
        assert!(whole[2].contains('#'), "{enabled:#x}: {whole:#?}");
        assert_eq!(picture(true, false, false), whole, "{enabled:#x}");
        assert_eq!(picture(true, true, false), picture(false, true, false), "{enabled:#x}");
        // Filled polygons end with it.
        let both = picture(true, false, true);
        let outside = |x: usize, y: usize| !(4..12).contains(&x) || !(4..12).contains(&y);
        for (y, (row, alone)) in both.iter().zip(&whole).enumerate() {
            let differ = |x: usize| row.as_bytes()[x] != alone.as_bytes()[x];
            assert!(!(0..16).any(|x| outside(x, y) && differ(x)), "{enabled:#x}: {both:#?}");
        }
    }
}

/// A pass that draws depths alone into a texture may wait until someone looks.
#[test]
fn wide_points_reach_over_the_viewport_of_a_shadow_map() {
    let mut c = paper(16, 16);
    c.bind_texture(gl::TEXTURE_2D, 1);
    let internal = gl::DEPTH_COMPONENT24 as i32;
    c.tex_image_2d(gl::TEXTURE_2D, 0, internal, 16, 16, 0, gl::DEPTH_COMPONENT, gl::FLOAT, 0);
    c.bind_framebuffer_ext(gl::FRAMEBUFFER, 1);
    c.framebuffer_texture_2d(gl::FRAMEBUFFER, gl::DEPTH_ATTACHMENT, gl::TEXTURE_2D, 1, 0);
    c.draw_buffer(gl::NONE);
    c.read_buffer(gl::NONE);
    c.clear(gl::DEPTH_BUFFER_BIT);
    c.enable(gl::DEPTH_TEST);
    c.point_size(5.0);
    c.viewport(4, 4, 8, 8);
    c.load_identity();
    c.ortho(4.0, 12.0, 4.0, 12.0, -1.0, 1.0);
    draw(&mut c, gl::POINTS, &[[4.5, 4.5]]);
    draw(&mut c, gl::TRIANGLES, &[[-9.0, 9.5], [40.0, 9.5], [4.5, 60.0]]);
    let depths = c.depths();
    c.no_error();
    let drawn = |x: usize, y: usize| depths[16 * y + x] < 1.0;
    assert!(
        drawn(2, 2)
            && drawn(6, 2)
            && !drawn(1, 2)
            && drawn(5, 11)
            && !drawn(5, 12)
            && !drawn(3, 11)
    );
}

#[test]
fn edges_along_a_clip_plane_are_drawn() {
    let mut c = paper(8, 8);
    c.polygon_mode(gl::FRONT_AND_BACK, gl::LINE);
    clip(&mut c, gl::CLIP_PLANE0, [-1.0, 0.0, 0.0, 4.5]);
    half_flagged(&mut c);
    // The right edge is cut off, the upper one cut, the plane's edge new: the lower and the left
    // one stay without flag.
    let expected = [
        "........", "....#...", "....#...", "....#...", "....#...", "....#...", "..###...",
        "........",
    ];
    assert_eq!(rows(&mut c), expected);
}

#[test]
fn the_view_volume_makes_neither_edges_nor_points() {
    let picture = |mode: u32| {
        let mut c = paper(8, 8);
        c.polygon_mode(gl::FRONT_AND_BACK, mode);
        draw(&mut c, gl::TRIANGLES, &[[-8.0, 2.5], [5.5, 2.5], [5.5, 20.0]]);
        rows(&mut c)
    };
    // What is left of it reaches the left and the upper side.
    let upright = ".....#..";
    assert_eq!(
        picture(gl::LINE),
        ["........", "........", "######..", upright, upright, upright, upright, upright]
    );
    assert_eq!(
        picture(gl::POINT),
        [
            "........", "........", upright, "........", "........", "........", "........",
            "........"
        ]
    );
    // At the far plane the cut runs across the window, just above the fifth row.
    for (mode, cut) in [(gl::LINE, ".#....#."), (gl::POINT, "........")] {
        let mut c = paper(8, 8);
        c.polygon_mode(gl::FRONT_AND_BACK, mode);
        c.begin(gl::QUADS);
        for [x, y, z] in [[1.5, 1.5, 0.5], [6.5, 1.5, 0.5], [6.5, 6.5, -1.6], [1.5, 6.5, -1.6]] {
            c.vertex_3f(x, y, z);
        }
        c.end();
        assert_eq!(rows(&mut c)[4], cut);
    }
}

#[test]
fn corners_that_clipping_makes_are_points() {
    let mut c = paper(8, 8);
    c.polygon_mode(gl::FRONT_AND_BACK, gl::POINT);
    clip(&mut c, gl::CLIP_PLANE0, [-1.0, 0.0, 0.0, 4.5]);
    half_flagged(&mut c);
    // The new corners begin the plane's edge and the rest of the upper one.
    let expected = [
        "........", "....#...", "........", "........", "........", "........", "....#...",
        "........",
    ];
    assert_eq!(rows(&mut c), expected);
}

#[test]
fn colours_along_an_outline_cut_by_two_planes() {
    let mut c = paper(16, 16);
    c.polygon_mode(gl::FRONT_AND_BACK, gl::LINE);
    for (plane, equation) in
        [(gl::CLIP_PLANE0, [-1.0, 0.0, 0.0, 8.5]), (gl::CLIP_PLANE1, [0.0, -1.0, 0.0, 8.5])]
    {
        clip(&mut c, plane, equation);
    }
    c.begin(gl::POLYGON);
    for [x, y] in [[0.5, 0.5], [15.5, 0.5], [15.5, 15.5], [0.5, 15.5]] {
        c.color_3f(1.0, x / 16.0, y / 16.0);
        c.vertex_2f(x, y);
    }
    c.end();
    let bytes = c.bytes();
    for i in 1..8 {
        for [x, y] in [[8, i], [i, 8]] {
            let expected =
                [255.0, (x as f32 + 0.5) / 16.0 * 255.0, (y as f32 + 0.5) / 16.0 * 255.0];
            let found = bytes[y * 16 + x];
            assert!(
                (0..3).all(|k| (f32::from(found[k]) - expected[k]).abs() < 1.5),
                "{x}, {y}: {found:?}"
            );
        }
    }
}

#[test]
fn a_stipple_counts_fragments() {
    // Whatever the fractions of its ends, a line draws each second fragment, the first included.
    for start in [0.5, 0.7, 0.9, 0.1, 0.3] {
        for [from, to] in [[start, start + 9.0], [start + 9.0, start]] {
            for y_major in [false, true] {
                let mut c = paper(12, 12);
                let at = |along: f32| if y_major { [5.5, along] } else { [along, 5.5] };
                draw(&mut c, gl::LINES, &[at(from), at(to)]);
                let whole = c.bytes();
                c.clear(gl::COLOR_BUFFER_BIT);
                c.enable(gl::LINE_STIPPLE);
                c.line_stipple(1, 0x5555);
                draw(&mut c, gl::LINES, &[at(from), at(to)]);
                let found = c.bytes();
                let mut fragments: Vec<usize> =
                    (0..whole.len()).filter(|&i| whole[i][0] > 0).collect();
                if from > to {
                    fragments.reverse();
                }
                assert_eq!(fragments.len(), 9);
                let passed: Vec<bool> = fragments.iter().map(|&i| found[i][0] > 0).collect();
                assert_eq!(
                    passed,
                    [true, false, true, false, true, false, true, false, true],
                    "{from} to {to}"
                );
            }
        }
    }
}

#[test]
fn a_stipple_goes_on_along_a_strip() {
    // Three segments of 2, 0 and 3 fragments, then two of 3 and 2: each third fragment shows.
    let mut c = paper(12, 12);
    c.enable(gl::LINE_STIPPLE);
    c.line_stipple(1, 0x9249);
    draw(
        &mut c,
        gl::LINE_STRIP,
        &[[0.7, 0.5], [2.7, 0.5], [2.75, 0.5], [5.7, 0.5], [5.7, 3.4], [5.7, 5.4]],
    );
    let found = rows(&mut c);
    assert_eq!(&found[0], "#..#........");
    assert_eq!(&found[1], ".....#......");
    assert_eq!(&found[4], ".....#......");
    // Each segment of LINES begins anew.
    c.clear(gl::COLOR_BUFFER_BIT);
    draw(&mut c, gl::LINES, &[[0.7, 0.5], [2.7, 0.5], [2.7, 0.5], [5.7, 0.5]]);
    assert_eq!(&rows(&mut c)[0], "#.#.........");
}

#[test]
fn a_clipped_line_counts_what_it_draws() {
    let mut c = paper(12, 4);
    c.enable(gl::LINE_STIPPLE);
    c.line_stipple(2, 0x5555);
    draw(&mut c, gl::LINE_STRIP, &[[-7.3, 1.5], [5.5, 1.5], [30.0, 1.5]]);
    assert_eq!(&rows(&mut c)[1], "##..##..##..");
}

#[test]
fn pieces_of_a_smooth_line() {
    // Pieces of a pixel's length from 0.25 on, each second one: pixels hold three quarters of one
    // or a quarter.
    let mut c = paper(8, 3);
    c.enable(gl::LINE_STIPPLE);
    c.enable(gl::LINE_SMOOTH);
    c.enable(gl::BLEND);
    c.blend_func(gl::SRC_ALPHA, gl::ZERO);
    c.line_stipple(1, 0x5555);
    draw(&mut c, gl::LINES, &[[0.25, 1.5], [6.25, 1.5]]);
    let bytes = c.bytes();
    for x in 0..8 {
        let expected = if x > 5 {
            0.0
        } else if x % 2 == 0 {
            0.75
        } else {
            0.25
        };
        let found = f32::from(bytes[8 + x][0]) / 255.0;
        assert!((found - expected).abs() < 0.01, "{x}: {found} instead of {expected}");
    }
}

#[test]
fn polygon_offset_of_edges_and_corners_has_the_slope_of_the_polygon() {
    // Depth grows by 1/16 for a row; the lower edge itself is level.
    for (mode, enable) in
        [(gl::LINE, gl::POLYGON_OFFSET_LINE), (gl::POINT, gl::POLYGON_OFFSET_POINT)]
    {
        let mut c = Stage::new(8, 8);
        c.clear(gl::DEPTH_BUFFER_BIT);
        c.enable(gl::DEPTH_TEST);
        c.depth_func(gl::ALWAYS);
        c.polygon_mode(gl::FRONT_AND_BACK, mode);
        c.polygon_offset(2.0, 0.0);
        c.enable(enable);
        c.begin(gl::QUADS);
        for [x, y] in [[-0.875, -0.875], [0.625, -0.875], [0.625, 0.625], [-0.875, 0.625]] {
            c.vertex_3f(x, y, 0.5 * y);
        }
        c.end();
        let expected = 0.5 + 0.25 * -0.875 + 2.0 * 0.0625;
        let found = c.depths()[0];
        assert!((found - expected).abs() < 1e-5, "{found} instead of {expected}");
    }
}

/// What has no area is a back face; it has no inside, but edges and corners.
#[test]
fn polygons_without_area_have_edges_and_corners() {
    let flat: [&[[f32; 2]]; 2] =
        [&[[1.5, 1.5], [1.5, 1.5], [6.5, 1.5]], &[[1.5, 1.5], [3.5, 1.5], [6.5, 1.5]]];
    for corners in flat {
        for (mode, expected) in
            [(gl::FILL, "........"), (gl::LINE, ".######."), (gl::POINT, ".#....#.")]
        {
            let mut c = paper(8, 3);
            c.polygon_mode(gl::FRONT_AND_BACK, mode);
            draw(&mut c, gl::TRIANGLES, corners);
            let row = rows(&mut c)[1].clone();
            let middle = mode == gl::POINT && corners[1] == [3.5, 1.5];
            assert_eq!(row, if middle { ".#.#..#." } else { expected }, "{corners:?} {mode:#x}");
            for (side, drawn) in [(gl::BACK, false), (gl::FRONT, mode != gl::FILL)] {
                let mut c = paper(8, 3);
                c.enable(gl::CULL_FACE);
                c.cull_face(side);
                c.polygon_mode(gl::FRONT_AND_BACK, mode);
                draw(&mut c, gl::TRIANGLES, corners);
                assert_eq!(rows(&mut c)[1].contains('#'), drawn, "{corners:?} {mode:#x} {side:#x}");
            }
        }
    }
    // Seen edge-on.
    let mut c = Stage::new(32, 32);
    c.clear(gl::COLOR_BUFFER_BIT);
    c.polygon_mode(gl::FRONT_AND_BACK, gl::LINE);
    c.begin(gl::QUADS);
    for [x, z] in [[-0.8, -0.8], [0.8, -0.8], [0.8, 0.8], [-0.8, 0.8]] {
        c.vertex_3f(x, 0.0, z);
    }
    c.end();
    assert_eq!(rows(&mut c).concat().matches('#').count(), 26);
}
