//! Lines, points and edges: those that are nearest to the viewer lie just behind the fitted near plane.

use crate::common::{colors, exact, one};
use vitral::math::DVec3;
use vitral::render::Lines;
use vitral::scene::builtin::solids;
use vitral::{Camera, Material, Mesh, Projection};

/// Seen along z from `distance`, or without a perspective.
fn camera(distance: f64, perspective: bool) -> Camera {
    let projection =
        if perspective { Projection::Perspective { view_angle: 0.6 } } else { Projection::Parallel { height: 3.0 } };
    Camera {
        position: DVec3::new(0.0, 0.0, distance),
        focal_point: DVec3::ZERO,
        view_up: DVec3::Y,
        projection,
        clip: None,
    }
}

/// How many pixels of a picture of the mesh are light: edges on black ground are, and lines of this material.
fn light_pixels(mesh: Mesh, lines: Lines, (side, samples): (u32, u32), camera: Camera) -> usize {
    let white = vitral::light::Reflectance::Phong { ka: [0.0; 3], kd: [1.0; 3], ks: [0.0; 3], shininess: 1.0 };
    let mut renderer = exact(one(mesh, Material { reflectance: white, ..Material::default() }), side, side);
    (renderer.settings.lines, renderer.settings.samples) = (lines, samples);
    // What is no edge stays dark.
    renderer.lights = Some(Vec::new());
    renderer.camera = Some(camera);
    colors(&mut renderer).iter().filter(|c| c[0] > 100).count()
}

#[test]
fn edges_of_the_nearest_face_are_seen_at_every_size() {
    for perspective in [true, false] {
        for (side, samples) in [(60, 1), (60, 4), (200, 4), (700, 1)] {
            let distance = if perspective { 4.5 } else { 3.0 };
            for lines in [Lines::Edges, Lines::Wireframe, Lines::WireframeHiddenLine] {
                let count = light_pixels(
                    solids::cuboid(DVec3::splat(2.0)),
                    lines,
                    (side, samples),
                    camera(distance, perspective),
                );
                // The front face fills at least half of the picture's side.
                let border = 4 * side as usize / 2;
                assert!(count > border, "{lines:?}, {side} pixels, {samples} samples: {count} of {border}");
            }
        }
    }
}

#[test]
fn flat_models_of_lines_and_points_alone_are_seen() {
    let positions = vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    let lines = Mesh { positions: positions.clone(), lines: vec![[0, 1], [1, 2], [2, 3], [3, 0]], ..Mesh::default() };
    let points = Mesh { positions, points: vec![0, 1, 2, 3], ..Mesh::default() };
    for perspective in [true, false] {
        for side in [60, 200, 700] {
            for (mesh, least) in [(&lines, side as usize), (&points, 4 * 4)] {
                let white = Mesh { line_material: Some(0), ..mesh.clone() };
                let count = light_pixels(white, Lines::None, (side, 1), camera(5.0, perspective));
                assert!(count >= least, "{side} pixels: {count} of {least}");
            }
        }
    }
}
