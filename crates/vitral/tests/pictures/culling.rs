//! Culling never changes a picture, and saves work (docs/course.md P10, P14).

use super::common::{exact, exact_builtin, on_z};
use vitral::{
    AlphaMode, Camera, DMat4, DVec3, Material, Mesh, Part, Picture, Projection, Renderer, Scene,
    solids,
};

/// The picture with the given culling.
fn culled(renderer: &mut Renderer, frustum: bool, back_face: bool) -> Picture {
    (renderer.settings.cull.frustum, renderer.settings.cull.back_face) = (frustum, back_face);
    renderer.render().unwrap()
}

/// Cameras from afar, from near, and from among the objects.
fn cameras() -> [Camera; 4] {
    let from = |position, focal_point| Camera { position, focal_point, ..on_z(1.0, 0.9) };
    [
        from(DVec3::new(3.0, 4.0, 9.0), DVec3::new(0.0, 0.5, 0.0)),
        from(DVec3::new(2.0, 0.7, 2.5), DVec3::new(-1.0, 0.5, -1.0)),
        from(DVec3::new(0.1, 0.5, 0.2), DVec3::new(1.0, 0.8, 1.0)),
        Camera {
            projection: Projection::Parallel { height: 2.0 },
            ..from(DVec3::new(5.0, 5.0, 1.0), DVec3::ZERO)
        },
    ]
}

#[test]
fn p10_p14_culling_changes_no_picture() {
    for name in ["cubs", "sphere", "scene0", "scene1", "teapot"] {
        let mut renderer = exact_builtin(name, 160, 120);
        renderer.settings.picture.samples = 4;
        for (i, camera) in cameras().into_iter().enumerate() {
            renderer.camera = Some(camera);
            let reference = culled(&mut renderer, false, false).frame;
            for (frustum, back_face) in [(true, false), (false, true), (true, true)] {
                let frame = culled(&mut renderer, frustum, back_face).frame;
                assert!(
                    frame == reference,
                    "{name}, camera {i}, frustum {frustum}, back faces {back_face}"
                );
            }
        }
    }
}

#[test]
fn inner_walls_are_seen_through_a_window() {
    // Five walls and a pane in one closed mesh: what is seen through the pane are back faces of the
    // walls.
    let mut room = solids::cuboid(DVec3::splat(2.0));
    let part =
        |triangles, material| Part { name: String::new(), triangles, material: Some(material) };
    room.parts = vec![part(0..10, 0), part(10..12, 1)];
    let front = room.triangles[10]
        .map(|corner| DVec3::from(room.positions[corner as usize].map(f64::from)));
    let outwards = (front[1] - front[0]).cross(front[2] - front[0]).normalize();
    let mut scene = Scene::default();
    let wall = Material { unlit: true, ..Material::default() };
    scene.add_material(wall.clone());
    scene.add_material(Material { opacity: 0.1, alpha_mode: AlphaMode::Blend, ..wall });
    scene.add_mesh(room, DMat4::IDENTITY);
    let mut renderer = exact(scene, 60, 60);
    let view_up = outwards.any_orthogonal_vector();
    renderer.camera = Some(Camera {
        position: outwards * 6.0,
        focal_point: DVec3::ZERO,
        view_up,
        ..on_z(1.0, 0.9)
    });
    let culled_away = culled(&mut renderer, true, true).frame;
    assert_eq!(culled_away, culled(&mut renderer, false, false).frame);
    // The wall, raw 0.8, through the pane; without the wall the pane alone would be a tenth of it.
    assert!(culled_away.color.unwrap().at(30, 30)[0] > 190);
    // Without transparency the walls hide each other, and culling pays again.
    renderer.settings.transparency.model = vitral::Transparency::None;
    assert_eq!(culled(&mut renderer, true, true).stats.cull.back_face_culled_instances, 1);
}

#[test]
fn p10_one_test_rejects_a_million_triangles() {
    let mut renderer = exact(Scene::from_mesh(solids::grid_torus(1_000_000)), 32, 32);
    let away = Camera {
        focal_point: DVec3::new(0.0, 0.0, 90.0),
        clip: Some((1.0, 50.0)),
        ..on_z(20.0, 0.5)
    };
    renderer.camera = Some(away);
    let stats = culled(&mut renderer, true, true).stats;
    assert_eq!(
        (stats.cull.box_tests, stats.cull.instances_culled, stats.cull.triangles_culled),
        (1, 1, 1_000_000)
    );
    assert_eq!((stats.geometry.vertices, stats.geometry.triangles), (0, 0));
    // Close by, most of it is outside the view: runs of triangles are rejected.
    renderer.camera = Some(Camera {
        position: DVec3::new(1.0, 0.3, 0.6),
        focal_point: DVec3::new(1.0, 0.0, 0.0),
        ..on_z(1.0, 0.4)
    });
    let near = culled(&mut renderer, true, true).stats;
    assert!(
        near.cull.triangles_culled > 500_000 && near.cull.triangles_culled < 1_000_000,
        "{:?}",
        near.cull
    );
    assert!(near.cull.box_tests < 1_000_000 / 256, "{:?}", near.cull);
}

#[test]
fn p10_a_close_up_of_a_large_mesh_transforms_the_vertices_near_by_alone() {
    let mut renderer = exact(Scene::from_mesh(solids::grid_torus(100_000)), 120, 90);
    renderer.settings.picture.samples = 4;
    for (distance, most) in [(0.05, 20_000), (0.2, 30_000), (4.0, 60_000)] {
        let position = DVec3::new(1.0, 0.0, 0.3 + distance);
        renderer.camera =
            Some(Camera { position, focal_point: DVec3::new(1.0, 0.05, 0.0), ..on_z(1.0, 0.4) });
        let near = culled(&mut renderer, true, true);
        let all = culled(&mut renderer, false, true);
        assert!(near.frame == all.frame, "{distance}");
        let vertices = near.stats.geometry.vertices;
        assert!(
            vertices > 0 && vertices <= most && vertices <= all.stats.geometry.vertices,
            "{distance}: {vertices}"
        );
    }
}

#[test]
fn p14_about_half_of_a_closed_mesh_faces_away() {
    for mesh in
        [solids::sphere(1.0, 64, 32), solids::torus(1.0, 0.4, 64, 32), solids::cuboid(DVec3::ONE)]
    {
        let name = mesh.name.clone();
        let mut renderer = exact(Scene::from_mesh(mesh), 256, 256);
        renderer.camera = Some(Camera { position: DVec3::new(7.0, 9.0, 11.0), ..on_z(1.0, 0.3) });
        let stats = culled(&mut renderer, true, true).stats;
        assert_eq!(stats.cull.back_face_culled_instances, 1, "{name}");
        let share = stats.geometry.back_facing as f64 / stats.geometry.triangles as f64;
        assert!((0.4..0.6).contains(&share), "{name}: {share}");
    }
}

#[test]
fn p14_open_and_inside_out_meshes_keep_their_back_faces() {
    let mut inside_out = solids::cuboid(DVec3::ONE);
    inside_out.faces = vitral::Faces::Triangles;
    inside_out.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    (inside_out.normals, inside_out.uvs) = (None, Vec::new());
    for mesh in [solids::plane(1.0, 1.0, 2, 2), inside_out] {
        let mut renderer = exact(Scene::from_mesh(mesh), 64, 64);
        renderer.camera = Some(Camera { position: DVec3::new(1.0, -3.0, 2.0), ..on_z(1.0, 0.6) });
        let rendered = culled(&mut renderer, true, true);
        assert_eq!(
            (rendered.stats.cull.back_face_culled_instances, rendered.stats.geometry.back_facing),
            (0, 0)
        );
        assert!(rendered.stats.picture.covered_pixels > 200, "it is seen");
    }
}

#[test]
fn p14_solid_bodies_of_an_open_mesh_lose_their_back_faces() {
    // A ball, a torus that pierces it, an open sheet and a pane of glass in one mesh.
    let mut mesh = solids::sphere(1.0, 48, 24);
    (mesh.faces, mesh.normals, mesh.uvs) = (vitral::Faces::Triangles, None, Vec::new());
    let solid = mesh.triangles.len() + solids::torus(1.2, 0.3, 48, 24).triangles.len();
    for (more, z) in [
        (solids::torus(1.2, 0.3, 48, 24), 0.2),
        (solids::plane(3.0, 3.0, 4, 4), 0.1),
        (solids::plane(1.0, 1.0, 1, 1), 2.0),
    ] {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(more.positions.iter().map(|p| [p[0], p[1], p[2] + z]));
        mesh.triangles.extend(more.triangles.iter().map(|t| t.map(|i| i + first)));
    }
    let all = mesh.triangles.len() as u32;
    let part =
        |triangles, material| Part { name: String::new(), triangles, material: Some(material) };
    mesh.parts = vec![part(0..all - 2, 0), part(all - 2..all, 1)];
    let mut scene = Scene::default();
    scene.add_material(Material::default());
    scene.add_material(Material {
        opacity: 0.3,
        alpha_mode: AlphaMode::Blend,
        ..Material::default()
    });
    for x in [1.0, -1.0] {
        scene.add_mesh(
            mesh.clone(),
            DMat4::from_translation(DVec3::X * 3.0 * x)
                * DMat4::from_scale(DVec3::new(x, 1.0, 1.0)),
        );
    }
    let mut renderer = exact(scene, 200, 150);
    for position in
        [DVec3::new(4.0, -7.0, 6.0), DVec3::new(-3.0, 5.0, -7.0), DVec3::new(0.0, 0.0, 9.0)]
    {
        renderer.camera = Some(Camera { position, ..on_z(1.0, 0.9) });
        let kept = culled(&mut renderer, true, false);
        let dropped = culled(&mut renderer, true, true);
        assert_eq!(
            (kept.stats.geometry.back_facing, dropped.stats.cull.back_face_culled_instances),
            (0, 2)
        );
        let share = dropped.stats.geometry.back_facing as f64 / (2 * solid) as f64;
        assert!((0.35..0.65).contains(&share), "{share}");
        assert!(dropped.frame == kept.frame, "from {position}");
    }
    // From among them nothing may be dropped.
    renderer.camera = Some(Camera {
        position: DVec3::new(3.0, 0.0, 0.5),
        focal_point: DVec3::new(3.0, 1.0, 0.5),
        ..on_z(1.0, 1.2)
    });
    assert_eq!(culled(&mut renderer, true, true).stats.geometry.back_facing, 0);
}

#[test]
fn p14_a_mirrored_instance_shows_its_outside() {
    let mut scene = Scene::default();
    scene.add_mesh(solids::torus(1.0, 0.4, 48, 24), DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0)));
    let mut renderer = exact(scene, 128, 128);
    let rendered = culled(&mut renderer, true, true);
    assert_eq!(rendered.stats.cull.back_face_culled_instances, 1);
    assert!(rendered.frame == culled(&mut renderer, true, false).frame);
}

#[test]
fn p11_windows_that_overlap_only_mean_a_closer_look() {
    // The figure's two triangles: their windows are apart (a), or overlap while the triangles do
    // not (b). Both are aslant, so that neither depth nor a plane tells them apart.
    let pair = |shift: [f32; 2]| {
        let lower = [[0.0, 0.0, 0.0], [4.0, 0.0, 2.0], [0.0, 4.0, 0.0]];
        let upper = [[4.0f32, 4.0], [2.0, 4.0], [4.0, 2.0]]
            .map(|[x, y]| [x + shift[0], y + shift[1], 0.6 * y - 0.48]);
        let mesh = Mesh {
            positions: lower.into_iter().chain(upper).collect(),
            triangles: vec![[0, 1, 2], [3, 4, 5]],
            parts: vec![Part { name: String::new(), triangles: 0..2, material: None }],
            ..Mesh::default()
        };
        let mut renderer = exact(Scene::from_mesh(mesh), 120, 120);
        let position = DVec3::new(4.0, 4.0, 20.0);
        let projection = Projection::Parallel { height: 12.0 };
        renderer.camera = Some(Camera {
            position,
            focal_point: DVec3::new(4.0, 4.0, 0.0),
            projection,
            ..on_z(1.0, 0.9)
        });
        renderer.settings.picture.channels.surface = true;
        renderer.settings.cull.back_face = false;
        let ids = |r: &mut Renderer, name: &str| {
            r.settings.visibility = name.parse().unwrap();
            let rendered = r.render().unwrap();
            (rendered.frame.surface.unwrap(), rendered.stats.visibility)
        };
        let (expected, _) = ids(&mut renderer, "z-buffer");
        for name in ["painter", "bsp", "weiler-atherton", "warnock", "scan-line", "ray-cast"] {
            assert!(ids(&mut renderer, name).0 == expected, "{name}");
        }
        let seen = |id: u32| expected.data().iter().filter(|&&found| found == id).count() as f64;
        // A pixel is a hundredth of a unit of area.
        assert!(
            (seen(0) - 800.0).abs() < 25.0 && (seen(1) - 200.0).abs() < 15.0,
            "{} {}",
            seen(0),
            seen(1)
        );
        ids(&mut renderer, "painter").1
    };
    let apart_in_x = pair([3.0, 0.0]);
    assert_eq!(
        (apart_in_x.by_x_extent, apart_in_x.by_y_extent, apart_in_x.by_projection),
        (1, 0, 0),
        "{apart_in_x:?}"
    );
    let apart_in_y = pair([0.0, 3.0]);
    assert_eq!(
        (apart_in_y.by_x_extent, apart_in_y.by_y_extent, apart_in_y.by_projection),
        (0, 1, 0),
        "{apart_in_y:?}"
    );
    let closer = pair([0.0, 0.0]);
    assert_eq!(
        (closer.by_x_extent, closer.by_y_extent, closer.by_projection),
        (0, 0, 1),
        "{closer:?}"
    );
    assert_eq!((closer.splits, closer.by_overlap), (0, 0), "{closer:?}");
}
