use super::*;
use crate::trace::{Observer, Step};
use std::sync::{Arc, Mutex};
use vitral_raster::{CornerPosition, NO_FACET, SamplePattern, Setup, TILE, TILE_PIXELS, Tile};

fn triangle(corners: [[i32; 2]; 3], z: [f32; 3], facet: u32) -> Setup {
    let [a, b, c] = [0, 1, 2].map(|i| CornerPosition {
        x: corners[i][0] * 256,
        y: corners[i][1] * 256,
        z: z[i],
    });
    Setup::new([a, b, c], Setup::doubled_area(a, b, c), facet)
}

/// Keeps the steps.
#[derive(Debug, Default)]
struct Steps(Mutex<Vec<Step>>);

impl Observer for Steps {
    fn step(&self, step: &Step) {
        self.0.lock().unwrap().push(step.clone());
    }
}

/// Facet and area of the visible polygons in a picture of this size, in the plain order or on all
/// threads.
fn visible_in(
    size: [i32; 2],
    setups: &[Setup],
    execution: &Execution,
) -> (Vec<(u32, f64)>, VisibilityCounters) {
    let polygons = Polygons::joined(setups, |facet| facet);
    let (sorted, held) = (in_first_order(&polygons), Charge::new(&execution.budget, STAGE));
    let sorting = AreaSorting { execution, polygons: &sorted, held: &held, keeps_outlines: false };
    let viewport = Viewport { width: size[0] as u32, height: size[1] as u32 };
    let found = sorting.run(viewport).unwrap();
    let facet = |number: u32| polygons.get(number as usize).facet();
    (found.visible.areas().map(|(number, area)| (facet(number), area)).collect(), found.counters)
}

/// The same in a picture of 64x64 pixels.
fn visible(setups: &[Setup]) -> (Vec<(u32, f64)>, VisibilityCounters) {
    visible_in([64; 2], setups, &Execution::default())
}

fn told(size: [i32; 2], setups: &[Setup]) -> (Vec<(u32, f64)>, VisibilityCounters, Vec<Step>) {
    let steps = Arc::new(Steps::default());
    let observer = Some(Arc::clone(&steps) as Arc<dyn Observer>);
    let execution = Execution { observer, ..Execution::default() };
    let (seen, counters) = visible_in(size, setups, &execution);
    let steps = std::mem::take(&mut *steps.0.lock().unwrap());
    (seen, counters, steps)
}

/// The area of a union: what the picture loses when everything is cut out of it.
fn union_area(side: i32, setups: &[Setup]) -> f64 {
    let picture = ConvexOutline::polygon(
        &[[0, 0], [side, 0], [side, side], [0, side]].map(|c| c.map(|v| v * 256)),
    );
    let (mut left, mut work) = (Region::polygon(&picture), Workspace::default());
    for setup in setups {
        let polygon = ConvexOutline::polygon(&[0, 1, 2].map(|i| [setup.x[i], setup.y[i]]));
        if let Clipped::Inside = left.clip(&polygon, &picture, &mut work) {
            return f64::from(side * side);
        }
    }
    f64::from(side * side) - left.area()
}

/// Random triangles, and the depths of their corners.
fn random(state: &mut u32, count: u32, side: i32, size: i32) -> Vec<Setup> {
    let mut next = |n: i32| {
        *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (*state >> 8) as i32 % n
    };
    (0..count)
        .filter_map(|facet| {
            let origin = [0; 2].map(|_| next(side + 16) - 8 - size / 2);
            let corners = [0; 3].map(|_| [0, 1].map(|k| origin[k] + next(size)));
            let z = [0; 3].map(|_| next(1000) as f32 / 1000.0);
            let [a, b, c] = corners.map(|[x, y]| CornerPosition { x, y, z: 0.0 });
            (Setup::doubled_area(a, b, c) != 0).then(|| triangle(corners, z, facet))
        })
        .collect()
}

const LARGE: [[i32; 2]; 3] = [[0, 0], [60, 0], [0, 60]];

#[test]
fn p24_a_polygon_in_front_cuts_a_hole() {
    let (seen, counters) = visible(&[
        triangle(LARGE, [0.2; 3], 0),
        triangle([[10, 10], [20, 10], [10, 20]], [0.8; 3], 1),
    ]);
    assert_eq!(seen, [(1, 50.0), (0, 1750.0)]);
    assert_eq!((counters.recursions, counters.splits), (0, 0));
}

#[test]
fn p24_the_preliminary_order_may_err() {
    // The large one comes nearer, but elsewhere: where they overlap, the small one is in front.
    let (seen, counters) = visible(&[
        triangle(LARGE, [0.1, 0.9, 0.1], 0),
        triangle([[2, 2], [12, 2], [2, 12]], [0.5; 3], 1),
    ]);
    let of = |facet: u32| seen.iter().filter(|s| s.0 == facet).map(|s| s.1).sum::<f64>();
    assert!((of(1) - 50.0).abs() < 1e-6 && (of(0) - 1750.0).abs() < 1e-6, "{seen:?}");
    assert!(counters.recursions > 0);
}

#[test]
fn p24_penetrating_polygons_are_cut_where_they_meet() {
    let (seen, counters) =
        visible(&[triangle(LARGE, [0.2, 0.8, 0.2], 0), triangle(LARGE, [0.8, 0.2, 0.8], 1)]);
    let of = |facet: u32| seen.iter().filter(|s| s.0 == facet).map(|s| s.1).sum::<f64>();
    // They meet at x = 30: a triangle of 450 square pixels remains right of it.
    assert!((of(0) - 450.0).abs() < 0.1 && (of(1) - 1350.0).abs() < 0.1, "{seen:?}");
    assert!(counters.splits > 0);
}

#[test]
fn p24_visible_areas_make_the_area_of_the_union() {
    let mut state = 3u32;
    for round in 0..40 {
        let setups = random(&mut state, 24, 64, 80);
        let (seen, _) = visible(&setups);
        let sum: f64 = seen.iter().map(|s| s.1).sum();
        let union = union_area(64, &setups);
        // Strips along the lines of penetration, 1/30000 pixel wide, are there twice.
        assert!(sum > union - 1e-6 && sum < union + 0.1, "round {round}: {sum} of {union}");
    }
}

#[test]
fn one_triangle_is_one_polygon_at_any_size() {
    for [width, height] in [[64, 64], [128, 128], [640, 480], [1280, 960], [16384, 16384]] {
        // Across the whole picture, and beyond its sides.
        for low in [0, -4000] {
            let setups =
                [triangle([[low, low], [width, 2], [low, height + 700]], [0.1, 0.5, 0.9], 7)];
            let (seen, counters) = visible_in([width, height], &setups, &Execution::default());
            assert_eq!(seen.len(), 1, "{width} x {height}");
            assert_eq!(counters, VisibilityCounters::default());
        }
    }
}

#[test]
fn a_square_with_a_hole_is_one_polygon_with_two_outlines() {
    for scale in [1, 2, 20] {
        let at = |corners: [[i32; 2]; 3]| corners.map(|c| c.map(|v| v * scale));
        let shared = |mut setup: Setup| {
            setup.origin = [0, 0];
            setup
        };
        let setups = [
            shared(triangle(at([[4, 4], [60, 4], [60, 60]]), [0.2; 3], 0)),
            shared(triangle(at([[4, 4], [60, 60], [4, 60]]), [0.2; 3], 0)),
            triangle(at([[20, 16], [40, 16], [20, 36]]), [0.8; 3], 1),
        ];
        let (seen, _, steps) = told([64 * scale; 2], &setups);
        let square = f64::from(scale * scale);
        assert_eq!(seen, [(1, 200.0 * square), (0, (56.0 * 56.0 - 200.0) * square)]);
        let outlines: Vec<Vec<_>> = steps
            .iter()
            .filter_map(|step| match step {
                Step::Visible { contours, .. } => {
                    Some(contours.iter().map(|c| (c.is_hole, c.corners.len())).collect())
                }
                _ => None,
            })
            .collect();
        assert_eq!(outlines, [vec![(false, 3)], vec![(false, 4), (true, 3)]]);
        let Step::NearestFirst { polygons } = &steps[0] else { panic!("{:?}", steps[0]) };
        assert_eq!(polygons.iter().map(|p| p.facet).collect::<Vec<_>>(), [1, 0]);
        assert_eq!(polygons[1].contours.len(), 1, "two triangles of one plane are one polygon");
        let Step::Clip {
            clip: 0,
            within: None,
            facet: 1,
            cut,
            inside,
            outside,
            hidden,
            again: false,
            ..
        } = &steps[1]
        else {
            panic!("{:?}", steps[1])
        };
        assert_eq!(
            (inside.as_slice(), outside.as_slice(), hidden.as_slice()),
            (&[1][..], &[0][..], &[0][..])
        );
        let lengths = |i: usize| {
            let cut = &cut[i];
            [&cut.before, &cut.inside, &cut.hidden, &cut.outside].map(Vec::len)
        };
        assert_eq!((cut.len(), lengths(0), lengths(1)), (2, [1, 1, 0, 0], [1, 0, 1, 2]));
        assert_eq!(steps.len(), 5);
    }
}

#[test]
fn clips_of_an_inside_list_name_the_clip_that_made_it() {
    let setups =
        [triangle(LARGE, [0.1, 0.9, 0.1], 0), triangle([[2, 2], [12, 2], [2, 12]], [0.5; 3], 1)];
    let (_, _, steps) = told([64; 2], &setups);
    let clips: Vec<_> = steps
        .iter()
        .filter_map(|step| match step {
            Step::Clip { clip, within, facet, again, .. } => Some((*clip, *within, *facet, *again)),
            _ => None,
        })
        .collect();
    assert_eq!(clips, [(0, None, 0, true), (1, Some(0), 1, false)]);
    let visible: Vec<_> = steps
        .iter()
        .filter_map(|step| match step {
            Step::Visible { facet, clip, .. } => Some((*facet, *clip)),
            _ => None,
        })
        .collect();
    assert_eq!(visible, [(1, Some(1)), (0, Some(0))]);
}

#[test]
fn threads_and_the_plain_order_find_the_same_polygons() {
    let mut state = 11u32;
    for (count, size) in [(40, 200), (600, 30), (320, 80)] {
        let mut setups = random(&mut state, count, 120, size);
        // Something large that lies behind, before and across the others.
        for (facet, z) in
            [[0.0, 0.1, 0.0], [0.9, 0.0, 0.5], [1.0, 0.1, 0.1]].into_iter().enumerate()
        {
            setups.push(triangle([[-900, -900], [900, -700], [-800, 900]], z, 5000 + facet as u32));
        }
        let sorted = |mut seen: Vec<(u32, f64)>| {
            seen.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
            seen
        };
        let (plain, counters, steps) = told([120; 2], &setups);
        assert_eq!(steps.iter().filter(|s| matches!(s, Step::Visible { .. })).count(), plain.len());
        let plain = sorted(plain);
        for threads in [1, 3] {
            let workers = vitral_exec::Workers::new(threads);
            let execution = Execution { workers, ..Execution::default() };
            let (spread, spread_counters) = visible_in([120; 2], &setups, &execution);
            assert_eq!(spread_counters, counters, "{count} of {size}");
            let spread = sorted(spread);
            assert_eq!(spread.len(), plain.len());
            for (a, b) in spread.iter().zip(&plain) {
                assert!(a.0 == b.0 && (a.1 - b.1).abs() < 1e-5, "{a:?} {b:?}");
            }
            assert!(execution.budget.peak() > 0);
            assert!(execution.budget.charge(0, "nothing").is_ok());
        }
        let (again, _, others) = told([120; 2], &setups);
        assert!(sorted(again) == plain && others == steps);
    }
}

/// The facet at each sample of a picture of four tiles and a little, as the visible polygons are
/// drawn.
fn drawn(
    viewport: Viewport,
    pattern: &SamplePattern,
    polygons: &Polygons<'_>,
    execution: &Execution,
) -> TileGrid {
    let (sorted, held) = (in_first_order(polygons), Charge::new(&execution.budget, STAGE));
    let found = AreaSorting { execution, polygons: &sorted, held: &held, keeps_outlines: false }
        .run(viewport)
        .unwrap();
    let rows = found.visible.rows(viewport);
    let filling = Filling { viewport, pattern, polygons, visible: &found.visible };
    let mut grid = TileGrid::new(viewport, pattern.len());
    for (row, tiles) in grid.tiles.chunks_mut(viewport.tiles_x() as usize).enumerate() {
        tiles.iter_mut().for_each(Tile::clear);
        filling.row(row, &rows[row], tiles, &execution.budget).unwrap();
    }
    grid
}

#[test]
fn samples_are_those_of_the_nearest_facets() {
    let (viewport, mut state) = (Viewport { width: 150, height: 70 }, 29u32);
    for (round, size) in [10, 40, 150, 400].into_iter().cycle().take(8).enumerate() {
        let pattern = SamplePattern::new([1, 4][round / 4]);
        let mut setups = random(&mut state, [400, 60][round % 2], 150, size);
        // Squares of two facets in one plane, whose ids mix, over each other, and some in the plane
        // of others.
        for facet in 0..4 {
            let [low, high] = [facet * 11, facet * 11 + 50].map(|v| v as i32);
            for (half, tip) in [[high, low], [low, high]].into_iter().enumerate() {
                let corners = if half == 0 {
                    [[low, low], tip, [high, high]]
                } else {
                    [[low, low], [high, high], tip]
                };
                let z = if facet < 3 { 0.5 } else { 0.75 };
                let own = triangle(corners, [z; 3], 9000 + facet + 4 * half as u32);
                setups.push(Setup { origin: [0, 0], dz_dx: 0.0, dz_dy: 0.0, ..own });
            }
        }
        let polygons = Polygons::joined(&setups, |facet| facet % 4);
        let grid = drawn(viewport, &pattern, &polygons, &Execution::default());
        for tile in &grid.tiles {
            let rows = TILE.min((viewport.height - tile.y) as usize);
            let columns = TILE.min((viewport.width - tile.x) as usize);
            let samples = (0..pattern.len()).flat_map(|s| (0..rows).map(move |row| (s, row)));
            for (s, row, column) in
                samples.flat_map(|(s, row)| (0..columns).map(move |column| (s, row, column)))
            {
                let [sx, sy] = pattern.position(s);
                let [x, y] = [(tile.x as usize + column, sx), (tile.y as usize + row, sy)]
                    .map(|(p, o)| p as i32 * 256 + o);
                let candidates = setups
                    .iter()
                    .filter(|setup| setup.covers(x, y))
                    .map(|f| (f.depth(x, y), f.facet));
                let expected =
                    candidates.reduce(|a, b| if crate::visible::nearer(b, a) { b } else { a });
                let found = tile.facet[s * TILE_PIXELS + row * TILE + column];
                assert_eq!(found, expected.map_or(NO_FACET, |e| e.1), "round {round}: {x}, {y}");
            }
        }
    }
}
