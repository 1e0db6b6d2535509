//! The law of agreement, for the z-buffer: each pixel holds what looking at every facet for every pixel finds
//! (COURSE.md P3, P4, P17). No tolerance: ids and depths are equal.

use crate::common::{all_channels, exact, exact_builtin};
use vitral::math::DVec3;
use vitral::raster::{SUBPIXEL, SamplePattern, Setup};
use vitral::render::PreparedView;
use vitral::render::stats::CullCounters;
use vitral::{Camera, Frame, Projection, Renderer};

const WIDTH: u32 = 96;
const HEIGHT: u32 = 72;

/// Approach 1 of the course, `O(n p)`: for each pixel centre, the nearest of all facets that cover it, of equal ones
/// the lower. Gives surface and depth.
fn brute_force(renderer: &Renderer) -> Vec<(u32, f32)> {
    let viewport = renderer.settings.check().unwrap();
    let (camera, pattern) = (renderer.frame_camera(), SamplePattern::new(1));
    let counters = &mut CullCounters::default();
    let execution = renderer.execution();
    let view =
        PreparedView::new(renderer.session(), &camera, &renderer.settings, viewport, pattern, execution, counters);
    let world = renderer.world();
    let setups: Vec<Setup> = (0..world.facet_count).flat_map(|facet| view.setups(facet, false)).collect();
    let center = |pixel: u32| pixel as i32 * SUBPIXEL + SUBPIXEL / 2;
    let mut out = Vec::new();
    for y in 0..HEIGHT {
        for x in 0..WIDTH {
            let (x, y) = (center(x), center(y));
            let mut nearest: Option<(f32, u32)> = None;
            for setup in setups.iter().filter(|s| s.covers(x, y)) {
                let depth = setup.depth(x, y);
                if nearest.is_none_or(|(d, f)| depth > d || (depth == d && setup.facet < f)) {
                    nearest = Some((depth, setup.facet));
                }
            }
            out.push(nearest.map_or((Frame::BACKGROUND, 0.0), |(d, f)| (world.surface_of_facet(f), d)));
        }
    }
    out
}

/// Compares the z-buffer with brute force, with and without culling.
fn agree(renderer: &mut Renderer, what: &str) {
    renderer.settings.channels = all_channels();
    let expected = brute_force(renderer);
    assert!(expected.iter().any(|(id, _)| *id != Frame::BACKGROUND), "{what}: something is seen");
    for cull in [true, false] {
        (renderer.settings.cull.frustum, renderer.settings.cull.back_face) = (cull, cull);
        let frame = renderer.render().unwrap().frame;
        let seen = frame.surface.unwrap().into_data().into_iter().zip(frame.depth.unwrap().into_data());
        let wrong: Vec<_> = (0..).zip(seen.zip(&expected)).filter(|(_, (a, b))| a != *b).collect();
        assert!(
            wrong.is_empty(),
            "{what}, culling {cull}: {} pixels differ: {:?}",
            wrong.len(),
            &wrong[..wrong.len().min(5)]
        );
    }
}

#[test]
fn p4_p17_the_z_buffer_equals_brute_force() {
    for name in ["cubs", "sphere", "scene0", "scene1", "teapot"] {
        agree(&mut exact_builtin(name, WIDTH, HEIGHT), name);
    }
}

#[test]
fn p3_perspective_and_parallel_projection_have_the_same_oracle() {
    for name in ["cubs", "scene1"] {
        let mut renderer = exact_builtin(name, WIDTH, HEIGHT);
        let camera = renderer.frame_camera();
        let flat = Camera { projection: Projection::Parallel { height: 5.0 }, ..camera };
        let wide = Camera { projection: Projection::Perspective { view_angle: 1.9 }, ..camera };
        let from_below = Camera { position: DVec3::new(1.0, -4.0, 3.0), focal_point: DVec3::ZERO, ..flat };
        for (camera, what) in [(flat, "parallel"), (wide, "wide angle"), (from_below, "parallel, from below")] {
            renderer.camera = Some(camera);
            agree(&mut renderer, &format!("{name}, {what}"));
        }
    }
}

#[test]
fn p4_facets_that_are_clipped_agree_too() {
    // The eye is between the objects: facets cross the near plane and pass behind the eye.
    let mut renderer = exact_builtin("scene0", WIDTH, HEIGHT);
    let camera = renderer.frame_camera();
    for (position, target) in [
        (DVec3::new(0.0, 0.6, 0.0), DVec3::new(1.0, 0.5, 1.0)),
        (DVec3::new(-1.0, 0.2, 0.3), DVec3::new(0.7, 0.8, 1.2)),
    ] {
        let projection = Projection::Perspective { view_angle: 1.4 };
        let clip = Some((0.05, 20.0));
        renderer.camera = Some(Camera { position, focal_point: target, projection, clip, ..camera });
        agree(&mut renderer, &format!("the eye at {position}"));
    }
}

#[test]
fn p4_coplanar_faces_go_to_the_lower_surface() {
    // The same square twice, and once more with the other diagonal.
    let square = vitral::scene::builtin::solids::plane(2.0, 2.0, 1, 1);
    let mut scene = vitral::Scene::from_mesh(square.clone());
    let mut other = square.clone();
    other.triangles = vec![[1, 3, 0], [3, 2, 0]];
    other.faces = vitral::scene::Faces::Triangles;
    (other.normals, other.uvs) = (None, Vec::new());
    scene.add_mesh(square, vitral::math::DMat4::IDENTITY);
    scene.add_mesh(other, vitral::math::DMat4::IDENTITY);
    let mut renderer = exact(scene, WIDTH, HEIGHT);
    agree(&mut renderer, "three coplanar squares");
}
