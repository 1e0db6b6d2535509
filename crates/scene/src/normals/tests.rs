use super::*;
use crate::builtin::solids;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_6};
use vitral_math::DVec3;

fn bare(mut mesh: Mesh) -> Mesh {
    mesh.normals = None;
    mesh
}

fn with_normals(mesh: Mesh, crease_angle: f64) -> Mesh {
    let mut one = bare(mesh);
    let mut many = one.clone();
    generate(&mut one, crease_angle, &Workers::single());
    generate(&mut many, crease_angle, &Workers::new(3));
    assert_eq!(one.normals, many.normals, "normals do not depend on threads");
    one.parts = vec![crate::Part {
        name: String::new(),
        triangles: 0..one.triangles.len() as u32,
        material: None,
    }];
    one.check().unwrap();
    one
}

fn normals(mesh: &Mesh) -> &Attribute<[f32; 3]> {
    mesh.normals.as_ref().unwrap()
}

fn close(a: [f32; 3], b: [f32; 3]) -> bool {
    (0..3).all(|k| (a[k] - b[k]).abs() < 1e-6)
}

/// docs/course.md L8: the vertex normals of a cube are `(±1, ±1, ±1)/√3`, cut into triangles or
/// not.
#[test]
fn l8_cube_vertex_normals_are_diagonals_for_quads_and_for_triangles() {
    let quads = solids::cuboid(DVec3::splat(2.0));
    let mut triangles = quads.clone();
    triangles.faces = Faces::Triangles;
    for mesh in [quads, triangles] {
        let mesh = with_normals(mesh, PI);
        assert!(normals(&mesh).corners.is_none() && normals(&mesh).values.len() == 8);
        for (n, p) in normals(&mesh).values.iter().zip(&mesh.positions) {
            assert!(close(*n, p.map(|c| c / 3f32.sqrt())), "{n:?} at {p:?}");
        }
    }
}

#[test]
fn a_crease_angle_below_a_right_angle_keeps_the_cube_sharp() {
    let mesh = with_normals(solids::cuboid(DVec3::ONE), FRAC_PI_6);
    assert_eq!(normals(&mesh).values.len(), 24, "three normals at each of eight corners");
    for t in 0..mesh.triangles.len() {
        let face = face_normal(&mesh, mesh.face_of_triangle(t));
        assert!(normals(&mesh).at(t, &mesh.triangles).iter().all(|n| close(*n, face)));
    }
    // Corners that are told apart, as in STL, are welded and make no more.
    let mut soup = solids::cuboid(DVec3::ONE);
    soup.positions =
        soup.triangles.as_flattened().iter().map(|&v| soup.positions[v as usize]).collect();
    soup.triangles = (0..12).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    soup.faces = Faces::Triangles;
    let soup = with_normals(soup, FRAC_PI_6);
    assert_eq!(normals(&soup).values.len(), 24);
    for t in 0..12 {
        assert!(
            normals(&soup).at(t, &soup.triangles).iter().all(|n| close(*n, face_normal(&soup, t)))
        );
    }
    let right = with_normals(solids::cuboid(DVec3::ONE), FRAC_PI_2);
    assert!(normals(&right).corners.is_none(), "a right angle is not more than a right angle");
}

#[test]
fn smoothing_groups_decide_instead_of_the_angle() {
    let mut mesh = solids::cuboid(DVec3::ONE);
    // Two faces in group 7, two in group 8, two without: only equal non-zero groups are smooth.
    mesh.smoothing_groups = Some(vec![7, 8, 7, 8, 0, 0]);
    let mesh = with_normals(mesh, PI);
    let groups = mesh.smoothing_groups.clone().unwrap();
    for t in 0..mesh.triangles.len() {
        let f = mesh.face_of_triangle(t);
        for (k, n) in normals(&mesh).at(t, &mesh.triangles).into_iter().enumerate() {
            let v = mesh.triangles[t][k];
            let together = (0..6).filter(|&g| g == f || groups[g] == groups[f] && groups[f] != 0);
            let sum = together
                .filter(|&g| mesh.face_corners(g).contains(&v))
                .fold(DVec3::ZERO, |s, g| {
                    s + DVec3::from_array(face_normal(&mesh, g).map(f64::from))
                });
            assert!(close(n, sum.normalize().as_vec3().to_array()), "triangle {t}, corner {k}");
        }
    }
}

#[test]
fn seams_with_repeated_positions_stay_smooth() {
    // A sphere torn into separate triangles.
    let sphere = solids::sphere(1.0, 24, 12);
    let positions: Vec<_> =
        sphere.triangles.as_flattened().iter().map(|&i| sphere.positions[i as usize]).collect();
    let triangles: Vec<_> =
        (0..sphere.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let torn = with_normals(Mesh { positions, triangles, ..Mesh::default() }, PI);
    for (n, p) in normals(&torn).values.iter().zip(&torn.positions) {
        let cosine = n[0] * p[0] + n[1] * p[1] + n[2] * p[2];
        assert!(cosine > 0.995, "{n:?} at {p:?}");
    }
}

#[test]
fn degenerate_faces_have_no_say_and_lone_vertices_have_the_default() {
    let positions = vec![
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [2.0, 0.0, 0.0],
        [9.0; 3],
        [f32::NAN; 3],
    ];
    let triangles = vec![[0, 1, 2], [0, 1, 3], [3, 3, 3], [0, 1, 5]];
    for crease in [PI, 0.5] {
        let mesh = with_normals(
            Mesh { positions: positions.clone(), triangles: triangles.clone(), ..Mesh::default() },
            crease,
        );
        assert!(
            normals(&mesh).values.iter().all(|n| *n == [0.0, 0.0, 1.0]),
            "{:?}",
            normals(&mesh)
        );
    }
}

#[test]
fn sheets_back_to_back_get_a_normal_all_the_same() {
    let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let mesh = Mesh { positions, triangles: vec![[0, 1, 2], [0, 2, 1]], ..Mesh::default() };
    assert_eq!(normals(&with_normals(mesh.clone(), PI)).values, [[0.0, 0.0, 1.0]; 3]);
    let sharp = with_normals(mesh, 1.0);
    assert_eq!(normals(&sharp).at(1, &sharp.triangles), [[0.0, 0.0, -1.0]; 3]);
}

#[test]
fn only_missing_normals_are_made() {
    let mut mesh = bare(solids::cuboid(DVec3::ONE));
    let given = vec![[0.0, 0.6, 0.8], [0.0; 3], [f32::NAN, 0.0, 0.0]];
    let corners: Vec<Corners> = (0..12).map(|t| if t < 6 { [0; 3] } else { [1, 2, 1] }).collect();
    mesh.normals = Some(Attribute { values: given, corners: Some(corners) });
    generate(&mut mesh, 0.1, &Workers::single());
    mesh.check().unwrap();
    for t in 0..12 {
        let expected = if t < 6 { [0.0, 0.6, 0.8] } else { face_normal(&mesh, t / 2) };
        assert!(normals(&mesh).at(t, &mesh.triangles).iter().all(|n| close(*n, expected)));
    }
    let complete = mesh.clone();
    generate(&mut mesh, PI, &Workers::single());
    assert_eq!(mesh, complete, "nothing is missing any more");
}

#[test]
fn the_tip_of_a_fine_cone_and_a_long_outline_are_no_trouble() {
    // 20000 faces at the tip, and a base with 20000 corners.
    let cone = with_normals(solids::cone(1.0, 1.0, 20_000), FRAC_PI_6);
    assert!(
        normals(&cone)
            .values
            .iter()
            .all(|n| (n.iter().map(|c| c * c).sum::<f32>() - 1.0).abs() < 1e-5)
    );
    let t = mesh_triangle_at(&cone, [1.0, -0.5, 0.0]);
    let face = face_normal(&cone, cone.face_of_triangle(t));
    for n in normals(&cone).at(t, &cone.triangles) {
        assert!(n[0] * face[0] + n[1] * face[1] + n[2] * face[2] > 0.85, "{n:?} is near {face:?}");
    }
    let mut grouped = solids::cone(1.0, 1.0, 20_000);
    grouped.smoothing_groups = Some(vec![0; grouped.face_count()]);
    with_normals(grouped, PI);
}

/// A side triangle of the cone that has a corner at `p`.
fn mesh_triangle_at(mesh: &Mesh, p: [f32; 3]) -> usize {
    (0..mesh.triangles.len())
        .find(|&t| mesh.triangles[t].iter().any(|&i| close(mesh.positions[i as usize], p)))
        .unwrap()
}

#[test]
fn concave_corners_weigh_with_their_reflex_angle() {
    // An L in the plane: one corner of 270 degrees, five of 90.
    let positions = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]
        .map(|[x, y]: [i8; 2]| [f32::from(x), f32::from(y), 0.0])
        .to_vec();
    let mesh = Mesh {
        positions,
        triangles: vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]],
        faces: Faces::Polygons { starts: vec![0, 6], corners: vec![0, 1, 2, 3, 4, 5] },
        ..Mesh::default()
    };
    let data = face_data(&mesh, &Workers::single());
    assert_eq!(data.normals, [[0.0, 0.0, 1.0]]);
    for (k, angle) in data.weights.iter().enumerate() {
        assert!((f64::from(*angle) - if k == 3 { 3.0 } else { 1.0 } * FRAC_PI_2).abs() < 1e-6);
    }
}

#[test]
fn normals_of_any_length_can_be_squared() {
    let values = vec![
        [3e-30, 0.0, -4e-30],
        [0.0, 1e30, 0.0],
        [0.0, 2.0, 0.0],
        [0.0; 3],
        [f32::NAN, 0.0, 0.0],
    ];
    let mut mesh =
        Arc::new(Mesh { normals: Some(Attribute::per_vertex(values)), ..Mesh::default() });
    let shared = Arc::clone(&mesh);
    make_measurable(&mut mesh, &Workers::single());
    let made = &mesh.normals.as_ref().unwrap().values;
    assert_eq!(made[..4], [[0.6, 0.0, -0.8], [0.0, 1.0, 0.0], [0.0, 2.0, 0.0], [0.0; 3]]);
    assert!(made[4][0].is_nan() && shared.normals.as_ref().unwrap().values[1] == [0.0, 1e30, 0.0]);
}
