//! The steps of algorithms in whole pictures, by hand.

use super::common::{exact, on_z, one};
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex};
use vitral::internals::render::trace::numbered::NumberedStep;
use vitral::internals::render::trace::replay::Replay;
use vitral::internals::render::trace::{Observer, SpanVerdict, Step};
use vitral::{
    Camera, Material, Mesh, Part, Projection, Renderer, Visibility, execution, load_builtin,
    load_bytes,
};

#[derive(Debug, Default)]
struct Steps(Mutex<Vec<Step>>);

impl Observer for Steps {
    fn step(&self, step: &Step) {
        self.0.lock().unwrap().push(step.clone());
    }
}

/// Triangles given by pixels, seen in parallel in a picture of 16 x 16; the second is nearer.
fn two_triangles() -> Renderer {
    let pixels = [[2.0, 1.0], [10.0, 1.0], [2.0, 9.0], [4.0, 2.0], [12.0, 10.0], [4.0, 10.0f32]];
    let place = |(i, [x, y]): (usize, [f32; 2])| [x - 8.0, 8.0 - y, if i < 3 { 0.0 } else { 1.0 }];
    let mesh = Mesh {
        positions: pixels.into_iter().enumerate().map(place).collect(),
        triangles: vec![[0, 1, 2], [3, 4, 5]],
        parts: vec![Part { name: String::new(), triangles: 0..2, material: None }],
        ..Mesh::default()
    };
    let mut renderer =
        exact(one(mesh, Material { double_sided: true, ..Material::default() }), 16, 16);
    renderer.camera =
        Some(Camera { projection: Projection::Parallel { height: 16.0 }, ..on_z(5.0, 1.0) });
    renderer.settings.visibility = Visibility::SCAN_LINE;
    renderer
}

#[test]
fn p19_tables_of_two_triangles_that_overlap() {
    let mut renderer = two_triangles();
    let steps = Arc::new(Steps::default());
    renderer.execution_mut().observer = Some(Arc::clone(&steps) as Arc<dyn Observer>);
    renderer.render().unwrap();
    let mut steps = std::mem::take(&mut *steps.0.lock().unwrap());
    steps.retain(|step| !matches!(step, Step::Box { .. }));

    // Both tables come before all lines.
    let Step::EdgeTable { rows, polygons, buckets } = &steps[0] else { panic!("{:?}", steps[0]) };
    assert_eq!(*rows, [0, 16]);
    assert_eq!(polygons.iter().map(|p| (p.facet, p.surface)).collect::<Vec<_>>(), [(0, 0), (1, 1)]);
    let table: Vec<_> = buckets
        .iter()
        .flat_map(|b| b.edges.iter().map(|e| (b.row, e.facet, e.x, e.dx, e.last[0])))
        .collect();
    for edge in
        [(1, 0, 2.0, 0.0, 8), (1, 0, 9.5, -1.0, 8), (2, 1, 4.0, 0.0, 9), (2, 1, 4.5, 1.0, 9)]
    {
        assert!(table.contains(&edge), "{edge:?} in {table:?}");
    }
    assert_eq!((table.len(), buckets.len()), (4, 2), "horizontal edges have no entry");

    // On each line the edges that it crosses and the spans between.
    let line = |wanted: u32| {
        let found = steps.iter().find_map(|s| match s {
            Step::Line { row, active_edges, spans, .. } if *row == wanted => {
                Some((active_edges, spans))
            }
            _ => None,
        });
        let (active, spans) = found.unwrap();
        let active: Vec<_> = active.iter().map(|e| (e.x, e.facet)).collect();
        let spans: Vec<_> =
            spans.iter().map(|s| (s.pixels, s.inside.clone(), s.verdict, s.facet)).collect();
        (active, spans)
    };
    let only = |pixels, facet| (pixels, vec![facet], SpanVerdict::Only, Some(facet));
    assert_eq!(line(0), (vec![], vec![]));
    assert_eq!(line(1), (vec![(2.0, 0), (9.5, 0)], vec![only([2, 9], 0)]));
    let both = |pixels| (pixels, vec![0, 1], SpanVerdict::Hides, Some(1));
    assert_eq!(
        line(3),
        (
            vec![(2.0, 0), (4.0, 1), (5.5, 1), (7.5, 0)],
            vec![only([2, 4], 0), both([4, 5]), only([5, 7], 0)]
        )
    );
    assert_eq!(
        line(5),
        (
            vec![(2.0, 0), (4.0, 1), (5.5, 0), (7.5, 1)],
            vec![only([2, 4], 0), both([4, 5]), only([5, 7], 1)]
        )
    );
    assert_eq!(line(9), (vec![(4.0, 1), (11.5, 1)], vec![only([4, 11], 1)]));
    assert_eq!(line(10), (vec![], vec![]));
}

#[test]
fn steps_do_not_depend_on_threads_or_on_what_a_session_knows() {
    for row in Visibility::all() {
        let mut told: Vec<Vec<NumberedStep>> = Vec::new();
        for threads in [1, 2, 3] {
            let mut renderer =
                Renderer::with_execution(load_builtin("cubs").unwrap(), execution(threads))
                    .unwrap();
            (renderer.settings.picture.width, renderer.settings.picture.height) = (150, 110);
            renderer.settings.visibility = row;
            let camera = renderer.frame_camera();
            // The second picture is made with what the first one found out.
            for _ in 0..2 {
                told.push(renderer.watch_steps(&camera).unwrap().steps);
            }
        }
        let first = &told[0];
        assert!(first.len() > 5, "{}", row.name);
        for (number, step) in first.iter().enumerate() {
            assert_eq!(step.number as usize, number, "{}", row.name);
            assert!(
                step.parent.is_none_or(|parent| parent < step.number),
                "{}: {step:?}",
                row.name
            );
        }
        for other in &told[1..] {
            let differing = first.iter().zip(other).find(|(a, b)| a != b);
            assert_eq!(differing, None, "{}", row.name);
            assert_eq!(first.len(), other.len(), "{}", row.name);
        }
    }
}

#[test]
fn the_last_step_leaves_the_picture() {
    for row in Visibility::all() {
        let mut renderer = exact(load_builtin("cubs").unwrap(), 90, 70);
        renderer.settings.visibility = row;
        let camera = renderer.frame_camera();
        let watched = renderer.watch_steps(&camera).unwrap();
        let (mut replay, picture) =
            (Replay::new(&watched), renderer.render().unwrap().frame.color.unwrap());
        let shown = |replay: &Replay<'_>| {
            let after = replay.picture();
            after.data().iter().zip(picture.data()).filter(|(a, b)| a == b).count()
        };
        let before = shown(&replay);
        replay.go_to(watched.steps.len());
        // What the last step is about is outlined.
        let after = shown(&replay);
        assert!(
            after > 90 * 70 * 9 / 10 && after > before,
            "{}: {before} of 6300 pixels, then {after}",
            row.name
        );
    }
}

/// Adds the names in a JSON value, at any depth.
fn names_in(value: &serde_json::Value, names: &mut BTreeSet<String>) {
    match value {
        serde_json::Value::Object(fields) => {
            for (name, value) in fields {
                names.insert(name.clone());
                names_in(value, names);
            }
        }
        serde_json::Value::Array(values) => values.iter().for_each(|value| names_in(value, names)),
        _ => {}
    }
}

#[test]
fn the_page_about_traces_names_every_step_and_field() {
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/trace.md"))
        .unwrap();
    let mut names = BTreeSet::new();
    for scene in ["cubs", "scene0"] {
        for row in Visibility::all() {
            let mut renderer = exact(load_builtin(scene).unwrap(), 40, 30);
            renderer.settings.visibility = row;
            let camera = renderer.frame_camera();
            for step in renderer.watch_steps(&camera).unwrap().steps {
                let value = serde_json::to_value(&step).unwrap();
                names.insert(value["step"].as_str().unwrap().to_owned());
                names_in(&value, &mut names);
            }
        }
    }
    for name in names {
        assert!(page.contains(&format!("`{name}`")), "docs/trace.md says nothing of `{name}`");
    }
}

#[test]
fn p19_a_flat_convex_face_is_one_polygon() {
    let bytes = include_bytes!("../fixtures/three-flat-squares.json");
    let mut renderer = exact(load_bytes(bytes, "three-flat-squares.json").unwrap(), 192, 192);
    renderer.settings.visibility = Visibility::SCAN_LINE;
    let camera = renderer.world().cameras[0];
    let steps = renderer.watch_steps(&camera).unwrap().steps;
    let tables = steps.iter().filter_map(|numbered| match &numbered.step {
        Step::EdgeTable { polygons, buckets, .. } => {
            let edges = buckets
                .iter()
                .flat_map(|b| &b.edges)
                .map(|e| (e.polygon, e.edge))
                .collect::<Vec<_>>();
            Some((polygons.iter().map(|p| p.surface).collect::<Vec<_>>(), edges.len()))
        }
        _ => None,
    });
    // Three bands: the square at the upper right is in two, the large one at the lower left in two,
    // the small one in one.
    let tables: Vec<_> = tables.collect();
    assert_eq!(tables, [(vec![1], 2), (vec![0, 1], 4), (vec![0, 2], 4)]);
    // A line through two squares crosses four edges, upright ones, and is cut in three spans.
    let line = steps.iter().find_map(|numbered| match &numbered.step {
        Step::Line { active_edges, spans, .. } if spans.len() == 3 => Some((active_edges, spans)),
        _ => None,
    });
    let (active, spans) = line.unwrap();
    let crossed: Vec<_> = active.iter().map(|edge| (edge.x, edge.polygon)).collect();
    assert_eq!(crossed.len(), 4, "{crossed:?}");
    assert!(crossed.is_sorted_by(|a, b| a.0 < b.0) && crossed[1].1 == crossed[2].1, "{crossed:?}");
    assert_eq!(spans.iter().map(|s| s.inside.len()).collect::<Vec<_>>(), [1, 2, 1]);
}

/// With `UPDATE_DOCS=1` the page is written.
#[test]
fn the_page_about_steps_tells_what_is_drawn() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/steps.md");
    let page = vitral::internals::render::trace::legend::page(
        Visibility::all().map(|row| (row.name, row.steps)),
    );
    if std::env::var_os("UPDATE_DOCS").is_some() {
        std::fs::write(path, &page).unwrap();
    }
    assert_eq!(
        std::fs::read_to_string(path).unwrap(),
        page,
        "docs/steps.md: run this test with UPDATE_DOCS=1"
    );
}

#[test]
fn p19_the_tables_can_be_dumped() {
    let mut renderer = two_triangles();
    let (camera, mut text) = (renderer.frame_camera(), String::new());
    let keep = |name: &str, bytes: &[u8]| {
        if name == "8-edge-table.txt" {
            text = String::from_utf8(bytes.to_vec()).unwrap();
        }
        Ok(())
    };
    vitral::dump::dump(&mut renderer, &camera, keep).unwrap();
    let line = |row: u32| {
        text.split(&format!("\n  row {row}\n"))
            .nth(1)
            .unwrap()
            .split("\n  row")
            .next()
            .unwrap()
            .to_owned()
    };
    assert!(
        text.starts_with("rows 0 to 15\n  polygon table\n    0: facet 0, surface 0, depth "),
        "{text}"
    );
    assert!(text.contains("(facet 1): x 4.5 dx 1 to row 9\n"), "{text}");
    assert!(line(3).contains("    span 4 to 4: in 0 1; facet 1 hides the others"), "{text}");
    assert!(
        !text.contains("row 10\n") && !text.contains("row 0\n"),
        "lines without edges are left out: {text}"
    );
}
