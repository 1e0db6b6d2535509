//! Exercises about algorithms for visible surfaces.
//!
//! Source: the course, notes P, P7, P17 and P19 to P22.

use super::exercise::{Exercise, NO_PIXEL, Solution, wants};
use vitral::Visibility;
use vitral::internals::render::trace::{Step, WindowVerdict};

/// Edges that are many on a line.
const MANY_EDGES: usize = 8;

/// Pixels along a window that is large.
const LARGE_WINDOW: u32 = 8;

pub(super) const EXERCISES: [Exercise; 6] = [
    Exercise {
        id: "P7",
        title: "What coherence saves",
        page: "visibility",
        text: "The scan-line algorithm uses what one line says about the next. Counters tell what each kind of coherence saves. Switch \
               off one that saves something: the picture stays, the work grows.",
        hint: "Settings, Coherence: take a tick away.",
        start: r#"{"models": ["builtin:scene0"], "settings": {"visibility": "scan-line"}}"#,
        notes: None,
        check: |solution| {
            let used = solution.renderer.settings.coherence();
            let off: Vec<_> = solution
                .renderer
                .settings
                .visibility
                .coherence
                .iter()
                .filter(|kind| !used.has(**kind))
                .collect();
            if off.is_empty() {
                return Ok(wants(false, "every kind of coherence is used"));
            }

            // See what the kinds that are switched off would have saved.
            solution.renderer.settings.coherence = None;
            let saved = serde_json::to_value(solution.stats()?.visibility).unwrap_or_default();
            let saves = |name: &str| {
                saved[format!("saved-by-{name}")].as_u64().is_some_and(|count| count > 0)
            };
            let saves_some = off.iter().any(|kind| saves(kind.name()));
            Ok(wants(saves_some, "what is switched off saves nothing in this scene"))
        },
    },
    Exercise {
        id: "P17",
        title: "Too few bits of depth",
        page: "visibility",
        text: "Two surfaces lie close behind each other. Take so many bits from the z-buffer that it mistakes one for the other.",
        hint: "Settings, Depth bits.",
        start: r#"{"models": ["builtin:scene1"], "settings": {"visibility": "z-buffer"}}"#,
        notes: None,
        check: |solution| {
            let mut open = wants(
                solution.state.settings.visibility == Visibility::Z_BUFFER,
                "the algorithm is not the z-buffer",
            );
            if open.is_empty() {
                let few = solution.surfaces()?;
                solution.renderer.settings.depth_bits = None;
                let wrong = solution.surfaces()?.iter().zip(&few).filter(|(a, b)| a != b).count();
                open.extend(wants(wrong > 0, "every pixel shows the right surface"));
            }
            Ok(open)
        },
    },
    Exercise {
        id: "P19",
        title: "A busy line",
        page: "visibility",
        text: "The active edge table holds the edges that the scan line crosses. Find a line with at least 8 active edges, and inspect a \
               pixel of it.",
        hint: "Step through the lines and look at the active edge table; or look where the outline of many objects is crossed.",
        start: r#"{"models": ["builtin:scene0"], "settings": {"visibility": "scan-line"}}"#,
        notes: None,
        check: |solution| {
            let Some([_, y]) = solution.pixel else { return Ok(wants(false, NO_PIXEL)) };
            let mut open =
                wants_algorithm(solution, Visibility::SCAN_LINE, "the algorithm is not scan-line");
            if open.is_empty() {
                let is_busy = |step: &Step| matches!(step, Step::Line { row, sample: 0, active_edges, .. } if *row == y && active_edges.len() >= MANY_EDGES);
                let is_found = solution.steps()?.iter().any(is_busy);
                open.extend(wants(is_found, "fewer than 8 edges are active on its line"));
            }
            Ok(open)
        },
    },
    Exercise {
        id: "P20",
        title: "A window that a polygon surrounds",
        page: "visibility",
        text: "Warnock cuts windows until each is simple. Find a pixel in a window of at least 8 by 8 pixels that needs no further cut \
               since a polygon surrounds it, and inspect it.",
        hint: "Channels shown, Steps: large windows lie within large faces.",
        start: r#"{"models": ["builtin:cubs"], "settings": {"visibility": "warnock"}}"#,
        notes: None,
        check: |solution| {
            let Some(pixel) = solution.pixel else { return Ok(wants(false, NO_PIXEL)) };
            let mut open =
                wants_algorithm(solution, Visibility::WARNOCK, "the algorithm is not Warnock's");
            if open.is_empty() {
                let is_large = |step: &Step| match step {
                    Step::Window {
                        pixels: [_, _, width, height],
                        verdict: WindowVerdict::Surrounded,
                        ..
                    } => *width >= LARGE_WINDOW && *height >= LARGE_WINDOW && step.concerns(pixel),
                    _ => false,
                };
                let is_found = solution.steps()?.iter().any(is_large);
                open.extend(wants(is_found, "the pixel lies in no such window"));
            }
            Ok(open)
        },
    },
    Exercise {
        id: "P21",
        title: "A list without an order",
        page: "visibility",
        text: "The painter's list has no order where polygons penetrate each other, or wait for each other in a circle: one must be \
               cut. No cube does that. Find a scene in which the painter cuts.",
        hint: "Settings, Model: where bodies stand in each other, polygons penetrate.",
        start: r#"{"models": ["builtin:cubs"], "settings": {"visibility": "painter"}}"#,
        notes: None,
        check: |solution| {
            let mut open = wants_algorithm(
                solution,
                Visibility::PAINTER,
                "the algorithm is not the painter's",
            );
            if open.is_empty() {
                open.extend(wants(solution.stats()?.visibility.splits > 0, "no polygon is cut"));
            }
            Ok(open)
        },
    },
    Exercise {
        id: "P22",
        title: "One tree for every eye",
        page: "visibility",
        text: "The BSP tree does not depend on the eye, the walk through it does. Turn the camera so that another polygon comes first, \
               back to front, in the same tree.",
        hint: "Turn to the other side of the cubes.",
        start: r#"{"models": ["builtin:cubs"], "settings": {"visibility": "bsp"}}"#,
        notes: None,
        check: |solution| {
            let mut open = solution.wants_model("builtin:cubs");
            open.extend(wants_algorithm(solution, Visibility::BSP, "the algorithm is not BSP"));
            if open.is_empty() {
                let walked = first_visit(&solution.steps()?);
                solution.start.apply(solution.renderer)?;
                let first = first_visit(&solution.steps()?);
                open.extend(wants(walked != first, "the walk begins with the same polygon"));
            }
            Ok(open)
        },
    },
];

fn wants_algorithm(solution: &Solution<'_>, algorithm: Visibility, message: &str) -> Vec<String> {
    wants(solution.state.settings.visibility == algorithm, message)
}

/// The polygons of the node that the walk comes to first.
fn first_visit(steps: &[Step]) -> Option<Vec<u32>> {
    steps.iter().find_map(|step| match step {
        Step::TreeVisit { polygons, .. } => Some(polygons.clone()),
        _ => None,
    })
}
