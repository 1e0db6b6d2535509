//! Ray tracing where surfaces of glass coincide or touch.

use super::common::{colors, exact, on_z, poster};
use super::ray_trace::{above, add, cuboid, differing, glass, tinted, traced};
use vitral::{Background, Camera, DMat4, DVec3, Mesh, Part, Renderer, Scene, solids};

#[test]
fn coincident_panes_are_layers_in_the_order_of_the_scene() {
    // Panes of one shape, whose order is seen, and panes that are cut in different triangles, which
    // rounding orders as it likes.
    let looks = [
        ([0.9, 0.1, 0.2], 0.7),
        ([0.1, 0.8, 0.3], 0.5),
        ([0.2, 0.1, 0.9], 0.3),
        ([0.9, 0.8, 0.1], 0.8),
    ];
    for turn in
        [DMat4::from_rotation_x(1.5), DMat4::from_rotation_z(0.4) * DMat4::from_rotation_x(0.9)]
    {
        for (order, columns) in
            [([0, 1, 2, 3], 1), ([3, 1, 0, 2], 1), ([2, 3, 1, 0], 1), ([1, 1, 1, 1], 3)]
        {
            let mut scene = Scene::default();
            cuboid(
                &mut scene,
                DVec3::splat(1.5),
                DVec3::new(0.0, 0.0, -3.0),
                poster([1.0, 0.6, 0.2]),
            );
            for (k, look) in order.into_iter().enumerate() {
                let (color, kt) = looks[look];
                let pane = solids::plane(3.0, 3.0, if k % 2 == 0 { 1 } else { columns }, 1);
                add(&mut scene, pane, tinted(color, kt, 1.0), turn);
            }
            let mut sorted = exact(scene, 80, 60);
            sorted.camera = Some(Camera { position: DVec3::new(0.7, 0.4, 6.0), ..on_z(6.0, 0.7) });
            let expected = colors(&mut sorted);
            let differing = differing(&colors(&mut traced(sorted)), &expected, 1);
            assert!(differing <= 2, "{order:?}: {differing}");
        }
    }
}

#[test]
fn what_glass_touches_is_seen_through_it() {
    // Two boxes on the floor that share a wall, and one on top of both. Or they are `apart`: what
    // is met first at one place, as it comes first in the scene, stands before the other.
    let scene = |ior: f32, turn: f64, apart: f64| {
        let mut scene = Scene::default();
        let mut stand = |min: [f64; 3], max: [f64; 3], material| {
            let (min, max) = (DVec3::from_array(min), DVec3::from_array(max));
            let to = DMat4::from_rotation_y(turn) * DMat4::from_translation((min + max) * 0.5);
            add(&mut scene, solids::cuboid(max - min), material, to);
        };
        stand([-2.0, apart, -1.0], [apart, 1.0, 1.0], tinted([0.8, 0.2, 0.2], 0.7, ior));
        stand([0.0, apart, -1.0], [1.0, 1.0, 1.0], tinted([0.2, 0.2, 0.8], 0.6, ior));
        stand([-0.5, 1.0 - apart, -0.5], [0.5, 1.5, 0.5], tinted([0.7, 0.7, 0.1], 0.5, ior));
        let floor = DMat4::from_rotation_y(0.2);
        add(&mut scene, solids::plane(7.0, 7.0, 3, 2), poster([0.2, 0.8, 0.2]), floor);
        let mut r = exact(scene, 120, 90);
        (r.camera, r.settings.picture.background) =
            (Some(above()), Background::Color { color: [1.0, 0.0, 1.0] });
        r
    };
    for turn in [0.0, 0.37] {
        // Where nothing bends, rays find the layers of the picture, but for where the boxes'
        // outlines are moved.
        let expected = colors(&mut scene(1.0, turn, 1e-3));
        let found = differing(&colors(&mut traced(scene(1.0, turn, 0.0))), &expected, 1);
        assert!(found <= 40, "turned by {turn}: {found}");
        // Where light bends, no background shines through the floor.
        let background = |p: &&[u8; 4]| p[0] > 150 && p[1] < 60 && p[2] > 150;
        let visible = |r: Renderer| colors(&mut traced(r)).iter().filter(background).count();
        let found = visible(scene(1.5, turn, 0.0)).abs_diff(visible(scene(1.0, turn, 0.0)));
        assert!(found <= 20, "bent, turned by {turn}: {found}");
    }
}

#[test]
fn a_liquid_that_touches_its_glass_is_one_border_with_it() {
    // Light bends from glass to water, not from glass to air to water: as where the two overlap a
    // little.
    let picture = |width: f64| {
        let mut scene = Scene::default();
        for k in 0..16 {
            let color = if k % 2 == 0 { [1.0, 0.1, 0.1] } else { [0.1, 0.1, 1.0] };
            cuboid(
                &mut scene,
                DVec3::new(0.5, 8.0, 0.1),
                DVec3::new(-3.75 + 0.5 * k as f64, 0.0, -4.0),
                poster(color),
            );
        }
        let (wall, hollow) = (solids::cuboid(DVec3::splat(2.0)), solids::cuboid(DVec3::splat(1.6)));
        let inwards = hollow.triangles.iter().map(|[a, b, c]| [a + 8, c + 8, b + 8]);
        let cup = Mesh {
            positions: [wall.positions, hollow.positions].concat(),
            triangles: wall.triangles.into_iter().chain(inwards).collect(),
            parts: vec![Part { name: String::new(), triangles: 0..24, material: None }],
            ..Mesh::default()
        };
        add(&mut scene, cup, glass(1.0, 1.5), DMat4::IDENTITY);
        cuboid(&mut scene, DVec3::splat(width), DVec3::ZERO, glass(1.0, 1.33));
        let mut r = traced(exact(scene, 120, 90));
        r.camera = Some(Camera {
            position: DVec3::new(2.0, 1.0, 4.0),
            focal_point: DVec3::ZERO,
            ..on_z(4.0, 0.61)
        });
        colors(&mut r)
    };
    let found = differing(&picture(1.6), &picture(1.6005), 8);
    assert!(found < 150, "{found}");
}
