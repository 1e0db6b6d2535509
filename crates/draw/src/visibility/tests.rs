use super::*;
use crate::testing::{mesh_of, with_run};
use proptest::prelude::*;
use vitral_frame::drawing::LineClass;
use vitral_math::exact::GridPoint;

const SIZE: i32 = 1 << 12;

fn found(mesh: &PageMesh, brute: bool, most_layers: u32, threads: usize) -> Vec<Fragment> {
    with_run(threads, |run| {
        let grid = Grid::new(mesh, |t| t.hides, run).unwrap();
        let search = if brute { Search::All } else { Search::Grid(&grid) };
        fragments(
            mesh,
            search,
            Wanted { classes: Classes::ALL, most_layers, most_segments: None },
            run,
        )
        .unwrap()
        .0
    })
}

/// Length on the page of the fragments with so many layers.
fn length(mesh: &PageMesh, fragments: &[Fragment], layers: u32) -> f64 {
    let of = |f: &Fragment| {
        let segment = Segment { mesh, ends: mesh.ends(&mesh.edges[f.edge as usize]) };
        let [a, b] = [segment.point(&f.from), segment.point(&f.to)];
        let [dx, dy] = [a[0] - b[0], a[1] - b[1]];
        (dx * dx + dy * dy).sqrt()
    };
    fragments.iter().filter(|f| f.layers == layers).map(of).sum()
}

/// The grid and brute force find the same, with any number of threads; visible parts are those of
/// no layer.
fn check(mesh: &PageMesh) -> Result<(), TestCaseError> {
    for most_layers in [0, u32::MAX] {
        let fast = found(mesh, false, most_layers, 1);
        for threads in [2, 3, 7] {
            prop_assert_eq!(&fast, &found(mesh, false, most_layers, threads));
        }
        let slow = found(mesh, true, most_layers, 1);
        prop_assert_eq!(fast.len(), slow.len(), "{:?}\n{:?}", fast, slow);
        for (a, b) in fast.iter().zip(&slow) {
            let segment = Segment { mesh, ends: mesh.ends(&mesh.edges[a.edge as usize]) };
            let same =
                segment.compare(&a.from, &b.from).is_eq() && segment.compare(&a.to, &b.to).is_eq();
            prop_assert!(same && (a.edge, a.layers) == (b.edge, b.layers), "{:?} {:?}", a, b);
        }
    }
    let (visible, all) = (found(mesh, false, 0, 1), found(mesh, false, u32::MAX, 1));
    let none: Vec<Fragment> = all.into_iter().filter(|f| f.layers == 0).collect();
    prop_assert_eq!(visible.len(), none.len());
    prop_assert!((length(mesh, &visible, 0) - length(mesh, &none, 0)).abs() < 1e-6);
    Ok(())
}

fn point(size: i32, step: i32) -> impl Strategy<Value = GridPoint> {
    prop::array::uniform3(0..=size / step).prop_map(move |p| p.map(|c| c * step))
}

/// Triangles anywhere: they cross, pierce and overlap in cycles.
fn soup(step: i32) -> impl Strategy<Value = Vec<[GridPoint; 3]>> {
    prop::collection::vec(prop::array::uniform3(point(SIZE, step)), 1..40)
}

/// Small triangles among a few that cover the page.
fn before_and_behind_walls() -> impl Strategy<Value = Vec<[GridPoint; 3]>> {
    let small = (point(SIZE, 1), prop::array::uniform2(point(200, 1))).prop_map(|(at, by)| {
        let moved = |d: GridPoint| [0, 1, 2].map(|k| (at[k] + d[k]).min(SIZE));
        [at, moved(by[0]), moved(by[1])]
    });
    let wall = prop::array::uniform3(0..SIZE)
        .prop_map(|z| [[0, 0, z[0]], [SIZE, 0, z[1]], [0, SIZE, z[2]]]);
    (prop::collection::vec(small, 1..120), prop::collection::vec(wall, 1..3)).prop_map(
        |(mut all, walls)| {
            all.extend(walls);
            all
        },
    )
}

/// Triangles with everything that touches them: a copy, one turned over, halves that meet a side in
/// its middle, one that stands on an edge in their plane, and one that lies in it.
fn touching() -> impl Strategy<Value = Vec<[GridPoint; 3]>> {
    let one = (prop::array::uniform3(point(SIZE, 8)), point(SIZE, 8), 0u8..32);
    let triangles = |([a, b, c], p, kinds): ([GridPoint; 3], GridPoint, u8)| {
        // All corners are multiples of 8, so that these are places of the grid.
        let mean = |weights: [i32; 3]| {
            [0, 1, 2].map(|k| (weights[0] * a[k] + weights[1] * b[k] + weights[2] * c[k]) / 4)
        };
        let (middle, inside) =
            (mean([2, 2, 0]), [mean([2, 1, 1]), mean([1, 2, 1]), mean([1, 1, 2])]);
        let others = [
            vec![[a, b, c]],
            vec![[b, a, c]],
            vec![[a, middle, p], [middle, b, p]],
            vec![[inside[0], inside[1], p]],
            vec![inside],
        ];
        let wanted = others.into_iter().enumerate().filter(move |(kind, _)| kinds >> kind & 1 == 1);
        std::iter::once([a, b, c])
            .chain(wanted.flat_map(|(_, triangles)| triangles))
            .collect::<Vec<_>>()
    };
    prop::collection::vec(one.prop_map(triangles), 1..6).prop_map(|all| all.concat())
}

/// A quarter of a turn of the page leaves the length of lines behind each number of layers.
fn check_turned(corners: &[[GridPoint; 3]]) -> Result<(), TestCaseError> {
    let turned: Vec<_> = corners.iter().map(|t| t.map(|[x, y, z]| [SIZE - y, x, z])).collect();
    let meshes = [mesh_of([SIZE; 2], corners), mesh_of([SIZE; 2], &turned)];
    let all = [&meshes[0], &meshes[1]].map(|mesh| found(mesh, false, u32::MAX, 1));
    let most = all.iter().flatten().map(|fragment| fragment.layers).max().unwrap_or(0);
    for layers in 0..=most {
        let [before, after] = [0, 1].map(|i| length(&meshes[i], &all[i], layers));
        prop_assert!(
            (before - after).abs() < 1e-6 * (1.0 + before),
            "{} layers: {} {}",
            layers,
            before,
            after
        );
    }
    Ok(())
}

#[test]
fn a_square_before_another_hides_its_middle() {
    let square = |low: i32, high: i32, z: i32| {
        let p = [[low, low, z], [high, low, z], [high, high, z], [low, high, z]];
        [[p[0], p[1], p[2]], [p[0], p[2], p[3]]]
    };
    let mesh = mesh_of([SIZE; 2], &[square(1000, 3000, 500), square(0, 4000, 0)].concat());
    assert_eq!(mesh.edges.len(), 10);
    let all = found(&mesh, false, u32::MAX, 1);
    // The diagonal of the one behind runs under that of the one before: one layer, not two.
    let diagonal = 2f64.sqrt() * 2000.0;
    assert!(
        (length(&mesh, &all, 1) - diagonal).abs() < 1e-6 && length(&mesh, &all, 2) == 0.0,
        "{all:?}"
    );
    let outlines = 4.0 * (2000.0 + 4000.0);
    assert!((length(&mesh, &all, 0) - outlines - 2.0 * diagonal).abs() < 1e-6);
}

#[test]
fn layers_are_counted_up_to_the_wanted_number() {
    let wall = |z: i32| [[0, 0, z], [4000, 0, z], [0, 4000, z]];
    let line = [[100, 100, 0], [900, 100, 0], [100, 101, 0]];
    let mesh = mesh_of([SIZE; 2], &[wall(300), wall(200), wall(100), line]);
    let lengths = |most| {
        let all = found(&mesh, false, most, 1);
        [0, 1, 2, 3].map(|layers| length(&mesh, &all, layers).round() as i32)
    };
    let (each, last) = (8000 + 5657, 2 * 800 + 1);
    // The outlines of the walls lie behind one another: a closed outline hides the lines behind it.
    assert_eq!(lengths(0), [each, 0, 0, 0]);
    assert_eq!(lengths(1), [each, each, 0, 0]);
    assert_eq!(lengths(9), [each, each, each, last]);
}

#[test]
fn a_face_over_the_same_corners_hides_nothing_more() {
    let triangle = [[0, 0, 900], [4000, 0, 900], [0, 4000, 900]];
    let turned = [triangle[1], triangle[0], triangle[2]];
    let mesh =
        mesh_of([SIZE; 2], &[triangle, turned, [[100, 100, 0], [900, 100, 0], [100, 900, 0]]]);
    assert_eq!((mesh.edges.len(), mesh.triangles.iter().filter(|t| t.hides).count()), (6, 2));
    let all = found(&mesh, false, u32::MAX, 1);
    assert!(all.iter().all(|f| f.layers < 2) && mesh.edges[0].classes.has(LineClass::Boundary));
}

#[test]
fn limits_stop_a_walk() {
    let mesh = mesh_of([SIZE; 2], &[[[0, 0, 0], [4000, 0, 0], [0, 4000, 0]]]);
    let (workers, budget) = (vitral_exec::Workers::single(), vitral_exec::Budget::default());
    budget.cancel_flag().store(true, std::sync::atomic::Ordering::Relaxed);
    let run = Run::new(&workers, &budget);
    let wanted = Wanted { classes: Classes::ALL, most_layers: 0, most_segments: None };
    assert!(matches!(fragments(&mesh, Search::All, wanted, &run), Err(Limit::Cancelled { .. })));
    let small = vitral_exec::Budget::default().with_memory_limit(Some(8));
    assert!(matches!(
        Grid::new(&mesh, |_| true, &Run::new(&workers, &small)),
        Err(Limit::Memory { .. })
    ));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn the_grid_finds_what_brute_force_finds_among_crossing_triangles(corners in soup(1)) {
        check(&mesh_of([SIZE; 2], &corners))?;
    }

    #[test]
    fn and_on_lattices_where_everything_coincides(corners in soup(SIZE / 4)) {
        check(&mesh_of([SIZE; 2], &corners))?;
    }

    #[test]
    fn and_where_faces_coincide_and_edges_lie_in_faces_or_end_on_sides(corners in touching()) {
        check(&mesh_of([SIZE; 2], &corners))?;
    }

    #[test]
    fn lengths_do_not_depend_on_how_the_page_lies(any in soup(1), lattice in soup(SIZE / 4), touching in touching()) {
        for corners in [any, lattice, touching] {
            check_turned(&corners)?;
        }
    }

    #[test]
    fn and_where_faces_cover_whole_cells(corners in before_and_behind_walls()) {
        check(&mesh_of([SIZE; 2], &corners))?;
    }
}
