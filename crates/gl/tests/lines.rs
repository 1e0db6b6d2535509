//! Lines and outlines of polygons, fragment by fragment: what clipping adds, what stipples count, how far polygon offset moves.

mod common;

use common::Stage;
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

/// The specification leaves open which way halves are rounded; Mesa rounds those of points down, and those of lines up.
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

#[test]
fn edges_along_a_clip_plane_are_drawn() {
    let mut c = paper(8, 8);
    c.polygon_mode(gl::FRONT_AND_BACK, gl::LINE);
    clip(&mut c, gl::CLIP_PLANE0, [-1.0, 0.0, 0.0, 4.5]);
    half_flagged(&mut c);
    // The right edge is cut off, the upper one cut, the plane's edge new: the lower and the left one stay without flag.
    let expected = ["........", "....#...", "....#...", "....#...", "....#...", "....#...", "..###...", "........"];
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
    assert_eq!(picture(gl::LINE), ["........", "........", "######..", upright, upright, upright, upright, upright]);
    assert_eq!(
        picture(gl::POINT),
        ["........", "........", upright, "........", "........", "........", "........", "........"]
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
    let expected = ["........", "....#...", "........", "........", "........", "........", "....#...", "........"];
    assert_eq!(rows(&mut c), expected);
}

#[test]
fn colours_along_an_outline_cut_by_two_planes() {
    let mut c = paper(16, 16);
    c.polygon_mode(gl::FRONT_AND_BACK, gl::LINE);
    for (plane, equation) in [(gl::CLIP_PLANE0, [-1.0, 0.0, 0.0, 8.5]), (gl::CLIP_PLANE1, [0.0, -1.0, 0.0, 8.5])] {
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
            let expected = [255.0, (x as f32 + 0.5) / 16.0 * 255.0, (y as f32 + 0.5) / 16.0 * 255.0];
            let found = bytes[y * 16 + x];
            assert!((0..3).all(|k| (f32::from(found[k]) - expected[k]).abs() < 1.5), "{x}, {y}: {found:?}");
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
                let mut fragments: Vec<usize> = (0..whole.len()).filter(|&i| whole[i][0] > 0).collect();
                if from > to {
                    fragments.reverse();
                }
                assert_eq!(fragments.len(), 9);
                let passed: Vec<bool> = fragments.iter().map(|&i| found[i][0] > 0).collect();
                assert_eq!(passed, [true, false, true, false, true, false, true, false, true], "{from} to {to}");
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
    draw(&mut c, gl::LINE_STRIP, &[[0.7, 0.5], [2.7, 0.5], [2.75, 0.5], [5.7, 0.5], [5.7, 3.4], [5.7, 5.4]]);
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
    // Pieces of a pixel's length from 0.25 on, each second one: pixels hold three quarters of one or a quarter.
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
    for (mode, enable) in [(gl::LINE, gl::POLYGON_OFFSET_LINE), (gl::POINT, gl::POLYGON_OFFSET_POINT)] {
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
