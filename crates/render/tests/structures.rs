//! Structures for rays give the hits that asking every triangle gives: P15, P16.

use std::sync::Arc;
use vitral_exec::{Budget, Workers};
use vitral_math::{Vec3, vec3};
use vitral_render::raytrace::bsp::KdTree;
use vitral_render::raytrace::bvh::Bvh;
use vitral_render::raytrace::grid::Grid;
use vitral_render::raytrace::intersect::Ray;
use vitral_render::raytrace::octree::Octree;
use vitral_render::raytrace::triangles::Triangles;
use vitral_render::raytrace::volumes::{Shape, Volumes};
use vitral_render::raytrace::{Counters, Structure};
use vitral_scene::{World, builtin};

/// All structures over the same triangles.
struct All {
    triangles: Arc<Triangles>,
    bvh: Bvh,
    octree: Octree,
    bsp: KdTree,
    grid: Grid,
    /// Boxes, oriented boxes, spheres.
    volumes: [Volumes; 3],
}

const SHAPES: [Shape; 3] = [Shape::Aligned, Shape::Oriented, Shape::Sphere];

impl All {
    /// Every so many triangles are an object.
    const OBJECT: u32 = 12;

    fn over(triangles: Triangles) -> Self {
        let first_facets: Vec<u32> =
            (0..triangles.count() as u32).step_by(Self::OBJECT as usize).collect();
        Self::over_objects(triangles, &first_facets)
    }

    fn over_objects(triangles: Triangles, first_facets: &[u32]) -> Self {
        let (triangles, workers, budget) =
            (Arc::new(triangles), Workers::new(2), Budget::default());
        Self {
            bvh: Bvh::build(&triangles, &workers, &budget).unwrap(),
            octree: Octree::build(&triangles, &workers, &budget).unwrap(),
            bsp: KdTree::build(&triangles, &workers, &budget).unwrap(),
            grid: Grid::build(&triangles, &budget).unwrap(),
            volumes: SHAPES.map(|shape| {
                Volumes::build(&triangles, first_facets.iter().copied(), shape, &workers, &budget)
                    .unwrap()
            }),
            triangles,
        }
    }

    fn over_builtin(name: &str) -> Self {
        let world = World::new(&builtin::scene(name).unwrap()).unwrap();
        Self::over(Triangles::of_world(&world, &Workers::single()))
    }

    fn over_corners(corners: Vec<[Vec3; 3]>) -> Self {
        let extent = corners.iter().flatten().fold(0.0f32, |m, p| m.max(p.abs().max_element()));
        let facets = (0..corners.len() as u32).collect();
        Self::over(Triangles { extent, corners, facets, ..Triangles::default() })
    }

    /// Compares all structures on one ray; whether it hits.
    fn agree(&self, origin: Vec3, direction: Vec3, what: &str) -> bool {
        let ray = Ray::new(origin, direction);
        let expected = self.triangles.closest_hit(&ray, &mut Counters::default());
        let counters = &mut Counters::default();
        assert_eq!(self.bvh.closest_hit(&ray, counters), expected, "{what}, bvh: {ray:?}");
        assert_eq!(self.octree.closest_hit(&ray, counters), expected, "{what}, octree: {ray:?}");
        assert_eq!(self.bsp.closest_hit(&ray, counters), expected, "{what}, bsp: {ray:?}");
        assert_eq!(self.grid.closest_hit(&ray, counters), expected, "{what}, grid: {ray:?}");
        for (volumes, shape) in self.volumes.iter().zip(SHAPES) {
            assert_eq!(volumes.closest_hit(&ray, counters), expected, "{what}, {shape:?}: {ray:?}");
        }
        expected.is_some()
    }
}

/// Numbers in `-1..1` that look random.
fn random(state: &mut u64) -> f32 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 40) as f32 / (1 << 23) as f32 - 1.0
}

fn point(state: &mut u64) -> Vec3 {
    vec3(random(state), random(state), random(state))
}

/// `count` triangles about places in a cube, `size` large.
fn soup(count: usize, size: Vec3, seed: u64) -> Vec<[Vec3; 3]> {
    let mut state = seed;
    (0..count)
        .map(|_| {
            let place = point(&mut state);
            [(); 3].map(|()| place + point(&mut state) * size)
        })
        .collect()
}

#[test]
fn p15_p16_random_rays_agree_on_the_built_in_scenes() {
    let mut state = 7;
    for name in ["cubs", "sphere", "scene0", "scene1", "teapot"] {
        let all = All::over_builtin(name);
        let extent = all.triangles.extent;
        let mut hits = 0;
        for _ in 0..700 {
            let (a, b) = (point(&mut state) * extent * 1.5, point(&mut state) * extent * 0.8);
            hits += u32::from(all.agree(a, b - a, name));
        }
        assert!(hits > 100, "{name}: {hits} hits");
    }
}

#[test]
fn random_rays_agree_on_needles_dust_and_walls() {
    let mut state = 11;
    let scenes = [
        ("needles", soup(300, vec3(2.0, 0.0005, 0.0005), 3)),
        ("dust", soup(1500, Vec3::splat(0.02), 5)),
        ("walls", soup(60, Vec3::splat(2.0), 9)),
    ];
    for (name, corners) in scenes {
        let all = All::over_corners(corners);
        let mut hits = 0;
        for i in 0..1000 {
            // Every other ray is aimed at a triangle, from inside the scene or from far away.
            let distance = [0.5, 3.0, 300.0][i % 3];
            let origin = point(&mut state) * distance;
            let aim = all.triangles.corners[i % all.triangles.count()];
            let aim = if i % 2 == 0 { (aim[0] + aim[1] + aim[2]) / 3.0 } else { point(&mut state) };
            hits += u32::from(all.agree(origin, aim - origin, name));
        }
        assert!(hits > 100, "{name}: {hits} hits");
    }
}

#[test]
fn rays_parallel_to_slabs_and_in_the_planes_of_boxes_agree() {
    let all = All::over_builtin("cubs");
    let extent = all.triangles.extent;
    let mut hits = 0;
    for i in -10..=10 {
        for j in -10..=10 {
            for axis in [Vec3::X, Vec3::NEG_Y, Vec3::Z, vec3(1.0, 1.0, 0.0), vec3(0.0, -1.0, 1.0)] {
                // These places hold faces, edges and corners of the cubes.
                let place = vec3(i as f32, j as f32, (i + j) as f32 * 0.5) * (extent * 0.1);
                hits += u32::from(all.agree(place - axis * extent * 3.0, axis, "cubs"));
                hits += u32::from(all.agree(place, axis, "cubs, from inside"));
            }
        }
    }
    assert!(hits > 300, "{hits} hits");
}

#[test]
fn flat_boxes_agree() {
    // A chequered plane across each axis: boxes without height, and rays within the plane, along it
    // and through it.
    for axis in 0..3 {
        let turn = |p: Vec3| Vec3::from_array([p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]]);
        let corner = |i: i32, j: i32| vec3(i as f32, j as f32, 1.0);
        let squares = (0..144).map(|n| (n % 12, n / 12));
        let corners = squares.flat_map(|(i, j)| {
            let [a, b, c, d] =
                [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)].map(turn);
            [[a, b, c], [a, c, d]]
        });
        let all = All::over_corners(corners.collect());
        let mut hits = 0;
        for i in 0..13 {
            for j in 0..13 {
                let p = corner(i, j);
                for (origin, direction) in [
                    (p - Vec3::Z * 2.0, Vec3::Z),
                    (p + vec3(0.25, 0.0, 7.0), Vec3::NEG_Z),
                    (p - vec3(20.0, 0.0, 0.0), Vec3::X),
                    (p, Vec3::Y),
                    (p, Vec3::Z),
                    (p - vec3(3.0, 2.0, 1.0), vec3(3.0, 2.0, 1.0)),
                ] {
                    hits += u32::from(all.agree(turn(origin), turn(direction), "plane"));
                }
            }
        }
        assert!(hits > 300, "{hits} hits");
    }
}

#[test]
fn coinciding_triangles_go_to_the_lowest_and_empty_scenes_have_no_hits() {
    let corners = [vec3(0.0, 0.0, 1.0), vec3(1.0, 0.0, 1.0), vec3(0.0, 1.0, 1.0)];
    let all = All::over_corners(vec![corners; 500]);
    let ray = Ray::new(vec3(0.2, 0.3, -1.0), Vec3::Z);
    assert_eq!(all.octree.closest_hit(&ray, &mut Counters::default()), Some((0, 2.0)));
    assert!(all.agree(ray.origin, ray.direction, "coinciding"));
    assert!(!All::over_corners(Vec::new()).agree(ray.origin, ray.direction, "empty"));
}

#[test]
fn p13_the_volume_is_tested_first_and_tests_of_triangles_drop() {
    // Rods that lie askew: boxes along the axes and spheres are large, boxes that are turned fit.
    let mut state = 5;
    let mut corners = Vec::new();
    for _ in 0..40 {
        let (at, way) = (point(&mut state) * 20.0, point(&mut state).normalize_or(Vec3::X) * 5.0);
        let thick = way.any_orthonormal_vector() * 0.1;
        let side = way.cross(thick).normalize_or(Vec3::X) * 0.1;
        for (a, b) in [(thick, side), (side, -thick), (-thick, -side), (-side, thick)] {
            corners.push([at - way + a, at + way + a, at + way + b]);
            corners.push([at - way + a, at + way + b, at - way + b]);
        }
    }
    let (count, first_facets) = (corners.len() as u64, (0..40).map(|i| i * 8).collect::<Vec<_>>());
    let extent = corners.iter().flatten().fold(0.0f32, |m, p| m.max(p.abs().max_element()));
    let facets = (0..count as u32).collect();
    let all = All::over_objects(
        Triangles { extent, corners, facets, ..Triangles::default() },
        &first_facets,
    );
    let (mut counters, mut hits) = ([Counters::default(); 3], 0);
    for i in 0..2000 {
        let a = point(&mut state) * 30.0;
        let aim = all.triangles.corners[i * 7 % count as usize][i % 3];
        let b = if i % 2 == 0 { point(&mut state) * 20.0 } else { aim + point(&mut state) };
        hits += u32::from(all.agree(a, b - a, "rods"));
        for (volumes, counters) in all.volumes.iter().zip(&mut counters) {
            volumes.closest_hit(&Ray::new(a, b - a), counters);
        }
    }
    assert!(hits > 100, "{hits} hits");
    let [aligned, oriented, sphere] = counters;
    assert!(counters.iter().all(|c| c.boxes == 2000 * 40), "{counters:?}");
    // Every triangle is asked without volumes.
    let without = 2000 * count;
    assert!(
        aligned.triangles * 4 < without && sphere.triangles * 2 < without,
        "{counters:?} of {without}"
    );
    assert!(
        oriented.triangles * 3 < aligned.triangles && aligned.triangles < sphere.triangles,
        "{counters:?}"
    );
}

#[test]
fn structures_save_tests() {
    let all = All::over_builtin("teapot");
    let mut state = 3;
    let mut counters = [Counters::default(); 5];
    for _ in 0..300 {
        let (a, b) = (
            point(&mut state) * all.triangles.extent * 1.5,
            point(&mut state) * all.triangles.extent * 0.5,
        );
        let ray = Ray::new(a, b - a);
        all.triangles.closest_hit(&ray, &mut counters[0]);
        all.bvh.closest_hit(&ray, &mut counters[1]);
        all.octree.closest_hit(&ray, &mut counters[2]);
        all.bsp.closest_hit(&ray, &mut counters[3]);
        all.grid.closest_hit(&ray, &mut counters[4]);
    }
    assert_eq!(counters[0].triangles, 300 * all.triangles.count() as u64);
    for (name, c) in ["bvh", "octree", "bsp", "grid"].iter().zip(&counters[1..]) {
        assert!(c.boxes > 0 && c.triangles * 20 < counters[0].triangles, "{name}: {c:?}");
    }
}
