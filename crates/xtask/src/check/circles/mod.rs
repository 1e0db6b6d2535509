//! Circles of source files: few files of a crate may import each other, directly or by way of others.

mod arrows;
mod components;
mod modules;

use arrows::Arrows;
use std::collections::{BTreeMap, BTreeSet};

/// Most files of a circle.
const MOST_FILES: usize = 3;

/// Files at which a crate's modules start.
const ROOTS: [&str; 2] = ["lib.rs", "main.rs"];

/// The arrows of a crate and its circles.
struct Graph {
    arrows: Arrows,
    circles: Vec<Vec<String>>,
}

impl Graph {
    fn new(sources: &modules::Sources<'_>) -> Self {
        let mut arrows = Arrows::new();
        for root in ROOTS.into_iter().filter(|root| sources.contains_key(root)) {
            for (ends, names) in arrows::arrows(&modules::read_modules(sources, root)) {
                arrows.entry(ends).or_default().extend(names);
            }
        }

        // Number the files.
        let files: BTreeSet<&str> = arrows.keys().flat_map(|(from, to)| [from.as_str(), to]).collect();
        let numbers: BTreeMap<&str, usize> = files.iter().copied().zip(0..).collect();
        let mut successors = vec![Vec::new(); files.len()];
        for (from, to) in arrows.keys() {
            successors[numbers[from.as_str()]].push(numbers[to.as_str()]);
        }

        let names: Vec<&str> = files.into_iter().collect();
        let named = |circle: Vec<usize>| circle.into_iter().map(|number| names[number].to_owned()).collect();
        let mut circles: Vec<Vec<String>> =
            components::components(&successors).into_iter().filter(|circle| circle.len() > 1).map(named).collect();
        circles.sort_by_key(|circle| (std::cmp::Reverse(circle.len()), circle[0].clone()));
        Self { arrows, circles }
    }
}

/// The listing of a crate: its circles with the arrows inside them, or all its arrows.
pub(super) fn listing(crate_name: &str, sources: &BTreeMap<&str, &str>, all: bool) -> String {
    let graph = Graph::new(sources);
    let line = |((from, to), names): (&(String, String), &BTreeSet<String>)| {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        format!("  {from} -> {to}: {}\n", names.join(", "))
    };
    if all {
        let lines: String = graph.arrows.iter().map(line).collect();
        return format!("{crate_name}: {} arrows\n{lines}", graph.arrows.len());
    }
    let mut text = String::new();
    for circle in &graph.circles {
        let inside: BTreeSet<&String> = circle.iter().collect();
        let lines = graph.arrows.iter().filter(|((from, to), _)| inside.contains(from) && inside.contains(to));
        text += &format!("{crate_name}: a circle of {} files\n", circle.len());
        text.extend(lines.map(line));
    }
    text
}
