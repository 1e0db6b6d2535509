//! P21, P22: painter's list and the BSP tree over the faces of the file, counted by hand, and the
//! steps that tell them.

use super::common::exact;
use super::traps;
use std::sync::{Arc, Mutex};
use vitral::internals::render::stats::VisibilityCounters;
use vitral::internals::render::trace::lists::{ListTest, ListVerdict, PlaneSide};
use vitral::internals::render::trace::structure::{bsp_tree_svg, depth_sort_svg};
use vitral::internals::render::trace::{Observer, Step};
use vitral::{
    Camera, DMat4, DVec3, Execution, Mesh, Projection, Renderer, Scene, Visibility, Workers,
    load_builtin, load_bytes, solids,
};

#[derive(Debug, Default)]
struct Steps(Mutex<Vec<Step>>);

impl Observer for Steps {
    fn step(&self, step: &Step) {
        self.0.lock().unwrap().push(step.clone());
    }
}

/// The steps of a picture and its counters.
fn steps(renderer: &mut Renderer, visibility: Visibility) -> (Vec<Step>, VisibilityCounters) {
    let kept = Arc::new(Steps::default());
    renderer.settings.visibility = visibility;
    renderer.execution_mut().observer = Some(Arc::clone(&kept) as Arc<dyn Observer>);
    let counters = renderer.render().unwrap().stats.visibility;
    renderer.execution_mut().observer = None;
    let mut steps = std::mem::take(&mut *kept.0.lock().unwrap());
    steps.retain(|step| !matches!(step, Step::Box { .. }));
    (steps, counters)
}

/// A scene of the course, seen by its own camera.
fn fixture(bytes: &[u8]) -> Renderer {
    let mut renderer = exact(load_bytes(bytes, "scene.json").unwrap(), 128, 128);
    renderer.camera = Some(renderer.world().cameras[0]);
    renderer
}

fn cyclic_triple() -> Renderer {
    fixture(include_bytes!("../fixtures/cyclic-triple.json"))
}

fn four_squares() -> Renderer {
    fixture(include_bytes!("../fixtures/four-squares.json"))
}

#[test]
fn p21_three_bars_in_a_circle_are_cut_once() {
    let (steps, counters) = steps(&mut cyclic_triple(), Visibility::PAINTER);
    assert_eq!((counters.cycles, counters.splits, counters.pieces), (1, 1, 4), "{counters:?}");

    // The first order has the three faces, each from depth to depth alike: the highest facet first.
    let Step::FirstOrder { polygons } = &steps[0] else { panic!("{:?}", steps[0]) };
    let facets: Vec<_> = polygons.iter().map(|p| p.facet).collect();
    assert_eq!(facets.len(), 3, "{polygons:?}");
    assert!(
        polygons.windows(2).all(|p| p[0].far <= p[1].far)
            && polygons.iter().all(|p| p.far < p.near)
    );

    // The first to be painted waits for a second, that for the third, and that for the first.
    let told: Vec<_> =
        steps.iter().filter(|s| !matches!(s, Step::Compared { .. } | Step::Piece { .. })).collect();
    let [Step::FirstOrder { .. }, Step::Turn { facet: first, .. }, rest @ ..] = &told[..] else {
        panic!("{told:?}")
    };
    let [
        Step::Moved { facet: second, before, .. },
        Step::Moved { facet: third, before: waits, .. },
        rest @ ..,
    ] = rest
    else {
        panic!("{told:?}")
    };
    assert_eq!((first, second), (before, waits));
    let [Step::Circle { facets, .. }, Step::Split { facet: split, by_facet, parts, .. }, ..] = rest
    else {
        panic!("{told:?}")
    };
    assert_eq!(facets, &[*first, *second, *third]);
    assert!(facets.contains(split) && facets.contains(by_facet) && split != by_facet);
    assert!(parts.iter().all(|part| part.facet == *split) && parts.len() == 2);

    // Three comparisons say that the other has to come first, one for each pair of the circle.
    let after: Vec<_> = steps
        .iter()
        .filter_map(|step| match step {
            Step::Compared { facet, with_facet, test, verdict: ListVerdict::After, .. } => {
                assert!(matches!(
                    test,
                    ListTest::Overlap | ListTest::ExchangedBehind | ListTest::ExchangedInFront
                ));
                Some((*facet, *with_facet))
            }
            _ => None,
        })
        .collect();
    assert_eq!(after[..3], [(*first, *second), (*second, *third), (*third, *first)]);
    let order: Vec<_> = steps.iter().filter(|s| matches!(s, Step::Piece { .. })).collect();
    let painted: Vec<_> = steps.iter().filter(|s| matches!(s, Step::Painted { .. })).collect();
    assert_eq!((order.len(), painted.len()), (4, 4));
    assert!(depth_sort_svg(&steps).contains("3 polygon(s), 4 in the final list"));
}

#[test]
fn p21_steps_and_counters_of_the_tests_agree() {
    let mut renderer = exact(load_builtin("cubs").unwrap(), 96, 72);
    let (steps, c) = steps(&mut renderer, Visibility::PAINTER);
    let count = |wanted: &[ListTest]| {
        let is = |s: &&Step| matches!(s, Step::Compared { test, verdict: ListVerdict::Before, .. } if wanted.contains(test));
        steps.iter().filter(is).count() as u64
    };
    assert_eq!(count(&[ListTest::DepthExtent]), c.by_depth_extent);
    assert_eq!(count(&[ListTest::XExtent]), c.by_x_extent);
    assert_eq!(count(&[ListTest::YExtent]), c.by_y_extent);
    assert_eq!(count(&[ListTest::BehindPlane]), c.by_plane_of_nearer);
    assert_eq!(count(&[ListTest::InFrontOfPlane]), c.by_plane_of_farther);
    assert_eq!(count(&[ListTest::Projection]), c.by_projection);
    let moved = steps.iter().filter(|s| matches!(s, Step::Moved { .. })).count() as u64;
    assert_eq!(moved, c.reordered);
    let pieces = steps.iter().filter(|s| matches!(s, Step::Piece { .. })).count() as u64;
    assert_eq!(pieces, c.pieces);
}

/// What a node of the tree says: its number, parent, side, splitter, and its four sets.
type NodeTold = (u32, Option<u32>, Option<PlaneSide>, Option<u32>, [Vec<u32>; 4]);

/// What the nodes of the tree say.
fn nodes(steps: &[Step]) -> Vec<NodeTold> {
    let node = |step: &Step| match step {
        Step::TreeNode {
            node,
            above: parent,
            side,
            splitter,
            coincident,
            front,
            back,
            cut,
            ..
        } => {
            let sets = [coincident, front, back, cut].map(|set| set.facets.clone());
            Some((*node, *parent, *side, *splitter, sets))
        }
        _ => None,
    };
    steps.iter().filter_map(node).collect()
}

#[test]
fn p22_four_squares_are_cut_three_times() {
    let (steps, counters) = steps(&mut four_squares(), Visibility::BSP);
    let nodes = nodes(&steps);
    assert_eq!(
        (counters.splits, counters.fragments, counters.pieces),
        (3, 7, 7),
        "{counters:?} {nodes:?}"
    );

    // The root comes first, each node after its parent, and the sets follow from one another.
    assert_eq!((nodes[0].0, nodes[0].1, nodes[0].2), (0, None, None));
    let below = |set: &[Vec<u32>; 4]| {
        [0, 2, 4, 6].into_iter().filter(|f| set.iter().any(|s| s.contains(f))).count()
    };
    assert_eq!(below(&nodes[0].4), 4);
    for (i, (number, parent, side, splitter, [coincident, ..])) in nodes.iter().enumerate() {
        assert!(coincident.contains(&splitter.unwrap()), "{nodes:?}");
        let Some(parent) = parent else { continue };
        let above = nodes[..i].iter().find(|above| above.0 == *parent).expect("parents come first");
        let [_, front, back, _] = &above.4;
        let own: &[u32] = if *side == Some(PlaneSide::Front) { front } else { back };
        let [own_coincident, own_front, own_back, own_cut] = &nodes[i].4;
        let mut all = [&own_coincident[..], own_front, own_back].concat();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all, own, "node {number}");
        assert!(own_cut.iter().all(|f| own_front.contains(f) && own_back.contains(f)));
    }
    let cut: usize = nodes.iter().map(|n| n.4[3].len()).sum();
    let within: usize = nodes.iter().map(|n| n.4[0].len()).sum();
    assert_eq!((cut, within), (3, 7));

    // The walk comes to each node once, and draws what is in its plane.
    let visits: Vec<_> = steps
        .iter()
        .filter_map(|step| match step {
            Step::TreeVisit { order, node, polygons, .. } => {
                Some((*order, *node, polygons.clone()))
            }
            _ => None,
        })
        .collect();
    assert_eq!(visits.len(), nodes.len());
    assert!(visits.iter().enumerate().all(|(i, visit)| visit.0 == i as u32));
    let walked: Vec<u32> = visits.iter().flat_map(|visit| visit.2.clone()).collect();
    let listed: Vec<u32> = steps
        .iter()
        .filter_map(|s| if let Step::Piece { facet, .. } = s { Some(*facet) } else { None })
        .collect();
    assert_eq!(walked, listed, "all of them have samples");
    assert!(bsp_tree_svg(&steps).contains("3 cut(s), 7 polygon(s)"));
}

#[test]
fn p21_p22_steps_are_the_same_with_more_threads_and_in_a_used_session() {
    for visibility in [Visibility::PAINTER, Visibility::BSP] {
        for name in ["cubs", "teapot", "scene1"] {
            let told = |threads: usize| {
                let execution =
                    Execution { workers: Workers::new(threads), ..Execution::default() };
                let mut renderer =
                    Renderer::with_execution(load_builtin(name).unwrap(), execution).unwrap();
                (renderer.settings.picture.width, renderer.settings.picture.height) = (150, 100);
                let first = steps(&mut renderer, visibility).0;
                let second = steps(&mut renderer, visibility).0;
                assert!(first == second, "{name}: a used session tells the same");
                first
            };
            let one = told(1);
            assert!(one.len() > 10, "{name}");
            assert!(one == told(3), "{name}: three threads tell the same");
        }
    }
}

/// The same square twice in one plane, facing both ways, and a small one in it.
fn sheet() -> Scene {
    let mut scene = Scene::default();
    let corners = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    let place = DMat4::from_rotation_y(0.37) * DMat4::from_rotation_x(0.5);
    scene.add_mesh(Mesh::new(corners, [[1, 0, 3], [3, 2, 1]]), place);
    scene.add_mesh(Mesh::new(corners, [[0, 1, 2], [0, 2, 3]]), place);
    let small = DMat4::from_rotation_x(std::f64::consts::FRAC_PI_2);
    scene.add_mesh(solids::plane(0.7, 0.5, 5, 4), place * small);
    scene
}

#[test]
fn p21_p22_depth_overrules_no_list_of_coplanar_faces() {
    let decal = fixture(include_bytes!("../fixtures/coplanar-decal.json"));
    let mut scenes = vec![("decal", decal), ("sheet", exact(sheet(), 128, 128))];
    scenes.extend(
        traps::all()
            .into_iter()
            .filter(|(name, _)| *name == "coplanar")
            .map(|(n, s)| (n, exact(s, 96, 96))),
    );
    assert_eq!(scenes.len(), 3);
    for (name, mut renderer) in scenes {
        for i in 0..12 {
            let turn = DMat4::from_rotation_y(f64::from(i) * 0.55);
            let position = turn.transform_point3(DVec3::new(4.0, 1.5 + 0.03 * f64::from(i), 0.0));
            let projection = match i % 3 {
                0 => Projection::Parallel { height: 4.5 },
                _ => Projection::Perspective { view_angle: 0.9 },
            };
            renderer.camera = Some(Camera { projection, ..Camera::look_at(position, DVec3::ZERO) });
            for visibility in [Visibility::PAINTER, Visibility::BSP] {
                let (steps, counters) = steps(&mut renderer, visibility);
                assert_eq!(
                    counters.overruled, 0,
                    "{name} from {position}, {visibility:?}: {counters:?}"
                );
                assert!(!steps.iter().any(|step| matches!(step, Step::Overruled { .. })));
            }
        }
    }
}
