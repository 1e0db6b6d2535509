//! Meshes without rhyme or reason: nothing panics, nothing is NaN, counts agree with counting by
//! hand, and the number of threads does not show.

use proptest::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use vitral_exec::Workers;
use vitral_math::{Aabb, DVec3, Obb, Sphere};
use vitral_scene::edges::{EdgeKind, edges};
use vitral_scene::{Faces, Mesh, Part, Solidity, Solids, Topology, is_closed, normals};

/// Up to 12 vertices on a small grid (so that many coincide), some of them not finite, and up to 30
/// faces.
fn mesh() -> impl Strategy<Value = Mesh> {
    let coordinate =
        prop_oneof![20 => (-1i8..=1).prop_map(f32::from), 1 => Just(f32::NAN), 1 => Just(f32::MAX)];
    let positions = prop::collection::vec(prop::array::uniform3(coordinate), 3..12);
    let outlines = prop::collection::vec(prop::collection::vec(0u32..1000, 3..7), 0..30);
    (positions, outlines, prop::option::of(0u32..3), any::<bool>()).prop_map(
        |(positions, outlines, groups, polygons)| {
            let n = positions.len() as u32;
            let (mut triangles, mut starts, mut corners) = (Vec::new(), vec![0], Vec::new());
            for outline in &outlines {
                let outline: Vec<u32> = outline.iter().map(|i| i % n).collect();
                triangles.extend(outline[1..].windows(2).map(|w| [outline[0], w[0], w[1]]));
                corners.extend(&outline);
                starts.push(corners.len() as u32);
            }
            let faces =
                if polygons { Faces::Polygons { starts, corners } } else { Faces::Triangles };
            let parts = vec![Part {
                name: String::new(),
                triangles: 0..triangles.len() as u32,
                material: None,
            }];
            let mut mesh = Mesh { positions, triangles, faces, parts, ..Mesh::default() };
            mesh.smoothing_groups =
                groups.map(|g| (0..mesh.face_count() as u32).map(|f| f % (g + 1)).collect());
            mesh
        },
    )
}

/// The name of a vertex's position: what is as small as the rounding of the largest coordinate is
/// 0.
fn place(mesh: &Mesh, i: u32) -> [u32; 3] {
    let finite = mesh.positions.as_flattened().iter().filter(|c| c.is_finite());
    let zero = finite.fold(0.0f32, |most, c| most.max(c.abs())) / (1 << 22) as f32;
    mesh.positions[i as usize].map(|c| if c.abs() <= zero { 0 } else { c.to_bits() })
}

proptest! {
    #[test]
    fn normals_are_unit_at_every_corner(mesh in mesh(), crease in prop_oneof![0.0f64..3.2, Just(f64::NAN)]) {
        let mut mesh = mesh;
        let mut again = mesh.clone();
        normals::generate(&mut mesh, crease, &Workers::single());
        normals::generate(&mut again, crease, &Workers::new(3));
        prop_assert_eq!(mesh.normals.as_ref().map(|n| &n.corners), again.normals.as_ref().map(|n| &n.corners));
        prop_assert_eq!(mesh.normals.is_some(), !mesh.triangles.is_empty());
        prop_assert_eq!(mesh.check(), Ok(()));
        for n in mesh.normals.iter().flat_map(|n| &n.values) {
            let length = n.iter().map(|c| c * c).sum::<f32>().sqrt();
            prop_assert!((length - 1.0).abs() < 1e-5, "{n:?}");
        }
    }

    #[test]
    fn topology_counts_as_one_counts_by_hand(mesh in mesh()) {
        let mut sides: BTreeMap<_, Vec<bool>> = BTreeMap::new();
        let mut vertices = BTreeSet::new();
        let mut corners = BTreeSet::new();
        for t in &mesh.triangles {
            let t = t.map(|i| place(&mesh, i));
            vertices.extend(t);
            let mut sorted = t;
            sorted.sort_unstable();
            corners.insert(sorted);
            for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                sides.entry((a.min(b), a.max(b))).or_default().push(a <= b);
            }
        }
        let count = |f: &dyn Fn(&Vec<bool>) -> bool| sides.values().filter(|s| f(s)).count();
        let twisted = |((a, b), s): &(&([u32; 3], [u32; 3]), &Vec<bool>)| a != b && s.len() == 2 && s[0] == s[1];
        let t = Topology::of(&mesh, &Workers::single());
        prop_assert_eq!(&t, &Topology::of(&mesh, &Workers::new(3)));
        prop_assert_eq!((t.vertices, t.edges, t.triangles), (vertices.len(), sides.len(), mesh.triangles.len()));
        prop_assert_eq!(t.boundary_edges, count(&|s| s.len() == 1));
        prop_assert_eq!(t.non_manifold_edges, count(&|s| s.len() > 2));
        prop_assert_eq!(t.inconsistent_edges, sides.iter().filter(twisted).count());
        prop_assert_eq!(t.duplicate_triangles, mesh.triangles.len() - corners.len());
        prop_assert_eq!(t.closed, is_closed(&mesh, &Workers::single()));
        let solids = Solids::of(&mesh, &Workers::single());
        prop_assert_eq!(&solids, &Solids::of(&mesh, &Workers::new(3)));
        let solidity = solids.solidity;
        prop_assert!(!solidity.outward || solidity.closed && solidity.consistent);

        // The same of sound triangles alone, and what normals find out on the way.
        let mut sound: BTreeMap<_, Vec<bool>> = BTreeMap::new();
        for [a, b, c] in mesh.triangles.iter().map(|t| t.map(|i| place(&mesh, i))) {
            for (a, b) in [(a, b), (b, c), (c, a)].into_iter().filter(|_| a != b && b != c && c != a) {
                sound.entry((a.min(b), a.max(b))).or_default().push(a < b);
            }
        }
        prop_assert_eq!(solidity.closed, !sound.is_empty() && sound.values().all(|s| s.len() == 2));
        let opposite = |s: &Vec<bool>| s.len() != 2 || s[0] != s[1];
        prop_assert_eq!(solidity.consistent, !mesh.triangles.is_empty() && sound.values().all(opposite));
        let mut triangles = Mesh { faces: Faces::Triangles, smoothing_groups: None, ..mesh.clone() };
        normals::generate(&mut triangles, 0.5, &Workers::single());
        prop_assert_eq!(Solids::of(&triangles, &Workers::single()), solids.clone());
        prop_assert_eq!(Solidity::of(&triangles, &Workers::single()), solidity);

        // The triangles of solid bodies together run along every edge as often one way as the
        // other.
        let is_solid = |t: usize| solids.some().is_some_and(|words| words[t / 32] >> (t % 32) & 1 == 1);
        let mut balance: BTreeMap<_, i32> = BTreeMap::new();
        for t in (0..mesh.triangles.len()).filter(|t| is_solid(*t)) {
            let [a, b, c] = mesh.triangles[t].map(|i| place(&mesh, i));
            for (a, b) in [(a, b), (b, c), (c, a)] {
                prop_assert!(a != b, "of area");
                *balance.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
            }
        }
        prop_assert!(balance.values().all(|b| *b == 0));
    }

    #[test]
    fn edges_are_the_sides_of_the_outlines(mesh in mesh()) {
        let mut sides: BTreeMap<_, Vec<u32>> = BTreeMap::new();
        for f in 0..mesh.face_count() {
            let outline: Vec<_> = mesh.face_corners(f).iter().map(|&i| place(&mesh, i)).collect();
            let next = |k: usize| outline[(k + 1) % outline.len()];
            let real: Vec<usize> = (0..outline.len()).filter(|&k| outline[k] != next(k)).collect();
            for &k in real.iter().filter(|_| real.len() >= 3) {
                sides.entry((outline[k].min(next(k)), outline[k].max(next(k)))).or_default().push(f as u32);
            }
        }
        let found = edges(&mesh, 0.5, &Workers::single());
        prop_assert_eq!(&found, &edges(&mesh, 0.5, &Workers::new(3)));
        prop_assert_eq!(found.len(), sides.len());
        for edge in &found {
            let [a, b] = edge.ends.map(|i| place(&mesh, i));
            let faces = &sides[&(a.min(b), a.max(b))];
            prop_assert_eq!(edge.faces[0], faces[0]);
            prop_assert_eq!(edge.faces[1], faces.get(1).copied().unwrap_or(u32::MAX));
            prop_assert_eq!(edge.kind == EdgeKind::Boundary, faces.len() == 1);
            prop_assert_eq!(edge.kind == EdgeKind::NonManifold, faces.len() > 2);
            prop_assert!((-1.0..=1.0).contains(&edge.cosine));
        }
    }

    #[test]
    fn p13_bounding_volumes_hold_all_vertices(mesh in mesh()) {
        let points: Vec<DVec3> = mesh.positions.iter().map(|p| DVec3::from_array(p.map(f64::from))).collect();
        let finite = || points.iter().copied().filter(|p| p.is_finite());
        let bounds = mesh.bounds();
        let indices = || mesh.triangles.as_flattened().iter().chain(mesh.lines.as_flattened()).chain(&mesh.points);
        let used = || indices().map(|&i| points[i as usize]);
        prop_assert_eq!(bounds, Aabb::from_points(used()));
        prop_assert!(used().filter(|p| p.is_finite()).all(|p| bounds.contains(p)));
        let (obb, sphere) = (Obb::from_points(&points), Sphere::from_points(&points));
        prop_assert_eq!(obb.is_some(), finite().next().is_some());
        prop_assert!(obb.is_none_or(|o| finite().all(|p| o.contains(p))));
        prop_assert!(sphere.is_none_or(|s| finite().all(|p| s.contains(p))));
    }
}
