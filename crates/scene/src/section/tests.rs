use super::*;
use crate::builtin::solids;
use crate::{Node, Solidity};
use proptest::prelude::*;
use vitral_math::{DMat4, DVec3};

fn plane(point: [f64; 3], normal: [f64; 3]) -> SectionPlane {
    SectionPlane::new(point, normal).unwrap()
}

/// The meshes of a scene after a cut, in world space.
fn left(scene: &Scene, planes: &[SectionPlane]) -> Vec<Instance> {
    let world = World::new(&scene.cut(planes).unwrap()).unwrap();
    world.instances.iter().for_each(|instance| instance.mesh.check().unwrap());
    world.instances
}

/// The area of an instance's caps.
fn cap_area(instance: &Instance) -> f64 {
    let Some(section) = &instance.mesh.section else { return 0.0 };
    let faces = section.first_cap as usize..instance.mesh.face_count();
    let triangles = faces.flat_map(|face| instance.mesh.face_triangles(face));
    triangles
        .map(|t| {
            let [a, b, c] = instance.corners(t as u32);
            (b - a).cross(c - a).length() / 2.0
        })
        .sum()
}

/// The length of an instance's cuts.
fn outline_length(instance: &Instance) -> f64 {
    let outline = instance.mesh.section.as_ref().map_or(&[][..], |section| &section.outline);
    outline.iter().map(|edge| instance.place(edge[0]).distance(instance.place(edge[1]))).sum()
}

fn is_solid(mesh: &Mesh) -> bool {
    Solidity::of(mesh, &Workers::single()).is_solid()
}

/// A mesh's triangles alone.
fn bare(mesh: &Mesh) -> Mesh {
    Mesh::new(mesh.positions.clone(), mesh.triangles.clone())
}

/// Both meshes in one.
fn joined(a: &Mesh, b: &Mesh, turned: bool) -> Mesh {
    let shift = a.positions.len() as u32;
    let mut mesh = bare(a);
    mesh.positions.extend(&b.positions);
    mesh.triangles.extend(b.triangles.iter().map(|&[p, q, r]| {
        if turned { [p, r, q].map(|v| v + shift) } else { [p, q, r].map(|v| v + shift) }
    }));
    mesh.parts[0].triangles = 0..mesh.triangles.len() as u32;
    mesh
}

#[test]
fn half_a_cube_is_a_box_with_a_square_cap() {
    let scene = Scene::from_mesh(solids::cuboid(DVec3::splat(2.0)));
    let [half] = &left(&scene, &[plane([0.0, 0.0, 0.25], [0.0, 0.0, 3.0])])[..] else { panic!() };
    assert_eq!((cap_area(half), outline_length(half)), (4.0, 8.0));
    assert_eq!((half.bounds.max.z, half.mesh.face_count()), (0.25, 6));
    assert!(is_solid(&half.mesh), "closed and outward");
    // All faces are still quadrilaterals: no diagonal has become a side.
    assert!((0..6).all(|face| half.mesh.face_corners(face).len() >= 4), "{:?}", half.mesh.faces);
    // A second plane cuts the cap as well.
    let planes = [plane([0.0; 3], [0.0, 0.0, 1.0]), plane([0.0; 3], [1.0, 0.0, 0.0])];
    let [quarter] = &left(&scene, &planes)[..] else { panic!() };
    assert_eq!((cap_area(quarter), outline_length(quarter)), (4.0, 10.0));
    assert!(is_solid(&quarter.mesh) && scene.cut(&planes).unwrap().is_cut());
}

#[test]
fn planes_beside_and_along_faces_cut_nothing() {
    let scene = Scene::from_mesh(solids::cuboid(DVec3::splat(2.0)));
    for height in [1.0, 1.5] {
        let cut = scene.cut(&[plane([0.0, height, 0.0], [0.0, 1.0, 0.0])]).unwrap();
        assert!(!cut.is_cut() && cut.nodes[0].mesh == Some(0), "{height}");
    }
    assert!(left(&scene, &[plane([0.0, -1.5, 0.0], [0.0, 1.0, 0.0])]).is_empty());
    // Two boxes, one on the other, in one mesh: the lower one's top lies in the plane and is not
    // cut.
    let mut upper = solids::cuboid(DVec3::ONE);
    upper.positions.iter_mut().for_each(|p| p[1] += 1.5);
    let both = Scene::from_mesh(joined(&solids::cuboid(DVec3::splat(2.0)), &upper, false));
    let [lower] = &left(&both, &[plane([0.0, 1.0, 0.0], [0.0, 1.0, 0.0])])[..] else { panic!() };
    assert_eq!(
        (cap_area(lower), outline_length(lower), lower.mesh.triangles.len()),
        (0.0, 0.0, 12)
    );
    assert!(
        SectionPlane::new([0.0; 3], [0.0; 3]).is_none()
            && SectionPlane::new([f64::NAN; 3], [1.0; 3]).is_none()
    );
}

#[test]
fn hollow_bodies_have_caps_with_holes_and_open_ones_none() {
    let (outer, inner) = (solids::cuboid(DVec3::splat(3.0)), solids::cuboid(DVec3::ONE));
    let middle = [plane([0.1, 0.0, 0.0], [1.0, 0.0, 0.0])];
    let hollow = Scene::from_mesh(joined(&outer, &inner, true));
    let [half] = &left(&hollow, &middle)[..] else { panic!() };
    assert!((cap_area(half) - 8.0).abs() < 1e-6 && (outline_length(half) - 16.0).abs() < 1e-6);
    let caps = half.mesh.face_count() - half.mesh.section.as_ref().unwrap().first_cap as usize;
    assert_eq!(caps, 1, "one face with a hole");

    // A torus has two discs.
    let torus = Scene::from_mesh(solids::torus(2.0, 0.5, 24, 16));
    let [half] = &left(&torus, &middle)[..] else { panic!() };
    assert!(
        is_solid(&half.mesh) && (cap_area(half) - 2.0 * 0.25 * std::f64::consts::PI).abs() < 0.1
    );

    // Without its lid, a box has three lines.
    let mut open = bare(&outer);
    open.triangles.retain(|t| t.iter().any(|&v| open.positions[v as usize][1] < 0.0));
    open.parts[0].triangles = 0..open.triangles.len() as u32;
    let [half] = &left(&Scene::from_mesh(open), &middle)[..] else { panic!() };
    assert!(cap_area(half) == 0.0 && (outline_length(half) - 9.0).abs() < 1e-6);
}

#[test]
fn mirrored_and_twisted_bodies_are_closed_as_well() {
    let cut = [plane([0.0; 3], [0.0, 1.0, 1.0])];
    let area = 4.0 * 2f64.sqrt();
    let mut scene = Scene::default();
    scene
        .add_mesh(solids::cuboid(DVec3::splat(2.0)), DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0)));
    let [half] = &left(&scene, &cut)[..] else { panic!() };
    assert!((cap_area(half) - area).abs() < 1e-5 && is_solid(&half.mesh));
    // One triangle of the wrong winding.
    let mut twisted = bare(&solids::cuboid(DVec3::splat(2.0)));
    twisted.triangles[0].swap(0, 1);
    let [half] = &left(&Scene::from_mesh(twisted), &cut)[..] else { panic!() };
    assert!((cap_area(half) - area).abs() < 1e-5, "{}", cap_area(half));
}

#[test]
fn what_is_at_corners_is_interpolated_and_shared_meshes_stay() {
    let corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
    let mut mesh = Mesh::new(corners, [[0, 1, 2]]).with_uvs([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    mesh.lines = vec![[0, 1], [1, 2]];
    mesh.points = vec![0, 1];
    let mut scene = Scene::from_mesh(mesh);
    scene.add_instance(0, DMat4::from_translation(DVec3::new(-9.0, 0.0, 0.0)));
    scene.nodes.push(Node::default());
    let [cut, whole] = &left(&scene, &[plane([1.0, 0.0, 0.0], [1.0, 0.0, 0.0])])[..] else {
        panic!()
    };
    assert!(whole.mesh.section.is_none() && whole.mesh_index == 0);
    assert_eq!((cut.mesh.face_count(), cut.mesh.lines.len(), cut.mesh.points.len()), (1, 2, 1));
    for t in 0..cut.mesh.triangles.len() {
        let values = cut.mesh.uvs[0].at(t, &cut.mesh.triangles);
        for (uv, vertex) in values.iter().zip(cut.mesh.triangles[t]) {
            let at = cut.mesh.positions[vertex as usize];
            assert_eq!(*uv, [at[0] / 4.0, at[1] / 4.0]);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn what_planes_leave_of_a_solid_is_solid(
        normal in prop::array::uniform3(-1.0f64..1.0), offset in -0.9f64..0.9, second in prop::array::uniform3(-1.0f64..1.0),
    ) {
        let planes: Vec<SectionPlane> = [(normal, offset), (second, 0.1)].into_iter().filter_map(|(n, d)| {
            let n = DVec3::from_array(n);
            SectionPlane::new(n.normalize_or_zero() * d, n)
        }).collect();
        let scene = Scene::from_mesh(solids::torus(0.9, 0.4, 12, 9));
        for instance in left(&scene, &planes) {
            prop_assert!(is_solid(&instance.mesh));
            let section = instance.mesh.section.clone().unwrap_or_default();
            for vertex in section.outline.iter().flatten() {
                let at = instance.place(*vertex);
                prop_assert!(planes.iter().any(|plane| plane.distance(at).abs() < 1e-6));
            }
        }
    }

    #[test]
    fn any_triangles_can_be_cut(corners in prop::collection::vec(prop::array::uniform3(0u32..9), 1..24)) {
        // Vertices of a small lattice: on, above and below the plane.
        let positions: Vec<[f32; 3]> = (0..9u8).map(|i| [f32::from(i % 3), f32::from(i / 3) - 1.0, f32::from(i * 7 % 5)]).collect();
        let cut = left(&Scene::from_mesh(Mesh::new(positions, corners)), &[plane([0.0; 3], [0.0, 1.0, 0.0])]);
        prop_assert!(cut.iter().all(|instance| instance.bounds.max.y <= 0.0 || instance.mesh.triangles.is_empty()));
    }
}
