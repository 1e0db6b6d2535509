//! Circles of source files: few files of a crate may import each other.
//!
//! An arrow leads from a file to each file of the same crate that defines an item it names, tests
//! excepted. A circle is a strongly connected component of that graph: each of its files reaches
//! every other one along arrows. A reader can understand none of them without the rest, so a circle
//! is as small as one thing to read.

mod arrows;
mod components;
mod modules;

use arrows::Arrows;
pub(super) use modules::Sources;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

/// Where the exceptions are, for messages.
const HERE: &str = "crates/xtask/src/check/circles/mod.rs";

/// Most files of a circle.
const MOST_FILES: usize = 3;

/// Most files that a message names.
const MOST_NAMED: usize = 4;

/// Files at which a crate's modules start.
const ROOTS: [&str; 2] = ["lib.rs", "main.rs"];

/// Circles that may be larger, and why.
const EXCEPTIONS: [Exception; 2] = [
    Exception {
        folder: "gl",
        allowed: Allowed::Through(&["context.rs"]),
        reason: "the context holds the state of every part, and each part adds its calls to the context",
    },
    Exception {
        folder: "raster",
        allowed: Allowed::Within(&["forward/"]),
        reason: "tiles, fragment operations, textures and sampling use each other's types",
    },
];

/// Leave for a crate to have a circle of more than [`MOST_FILES`].
struct Exception {
    /// The crate, by its folder in `crates`.
    folder: &'static str,
    allowed: Allowed,
    reason: &'static str,
}

/// What an exception allows. Paths are below `src`; one that ends in `/` stands for all files of a
/// folder.
enum Allowed {
    /// Circles that have no file outside of these paths.
    Within(&'static [&'static str]),
    /// Circles that come apart without the arrows to these files.
    Through(&'static [&'static str]),
}

impl Exception {
    /// The files whose arrows are not followed.
    fn hubs(&self) -> &'static [&'static str] {
        match self.allowed {
            Allowed::Through(files) => files,
            Allowed::Within(_) => &[],
        }
    }

    /// The paths within which circles may lie.
    fn paths(&self) -> &'static [&'static str] {
        match self.allowed {
            Allowed::Within(paths) => paths,
            Allowed::Through(_) => &[],
        }
    }

    /// Whether the file lies within these paths.
    fn covers(&self, file: &str) -> bool {
        self.paths().iter().any(|path| is_within(file, path))
    }
}

/// One line for each circle that is too large, and for each exception that no circle needs. The
/// crates are known by their folders.
pub(super) fn check(crates: &BTreeMap<&str, Sources<'_>>) -> Vec<String> {
    check_with(crates, &EXCEPTIONS)
}

fn check_with(crates: &BTreeMap<&str, Sources<'_>>, exceptions: &[Exception]) -> Vec<String> {
    let mut violations = Vec::new();
    let none = Sources::new();
    let folders: BTreeSet<&str> =
        crates.keys().copied().chain(exceptions.iter().map(|e| e.folder)).collect();
    for folder in folders {
        let graph = Graph::new(crates.get(folder).unwrap_or(&none));
        let own: Vec<&Exception> = exceptions.iter().filter(|e| e.folder == folder).collect();
        let hubs: Vec<&str> = own.iter().flat_map(|e| e.hubs()).copied().collect();
        let circles = graph.large_circles(&hubs);
        violations.extend(circles.iter().filter_map(|circle| objection(folder, circle, &own)));

        // Find the parts of exceptions that no circle needs.
        let inside = |path: &str| circles.iter().flatten().any(|file| is_within(file, path));
        let idle_paths = own.iter().flat_map(|e| e.paths()).filter(|path| !inside(path));
        let needed = |hub: &str| {
            let others: Vec<&str> = hubs.iter().copied().filter(|other| *other != hub).collect();
            graph.large_circles(&others).iter().flatten().any(|file| file == hub)
        };
        for path in idle_paths.chain(hubs.iter().filter(|hub| !needed(hub))) {
            violations
                .push(format!("crates/{folder}/src: no circle needs the exception for {path}; remove it from {HERE}"));
        }
    }
    violations
}

/// What is wrong with a circle of more than [`MOST_FILES`]; nothing if an exception covers it.
fn objection(folder: &str, circle: &[String], exceptions: &[&Exception]) -> Option<String> {
    let start = format!("crates/{folder}/src: {} files import each other", circle.len());
    let hint = format!("`cargo xtask circles {folder}` lists the arrows");
    let Some(exception) =
        exceptions.iter().find(|exception| circle.iter().any(|file| exception.covers(file)))
    else {
        let files = enumerate(&circle.iter().collect::<Vec<_>>());
        return Some(format!(
            "{start}: {files}; cut the circle, {MOST_FILES} is the limit ({hint})"
        ));
    };
    let strangers: Vec<&String> = circle.iter().filter(|file| !exception.covers(file)).collect();
    (!strangers.is_empty()).then(|| {
        let (strangers, paths) = (enumerate(&strangers), exception.paths().join(" and "));
        format!("{start}, which only {paths} may; cut {strangers} off ({hint})")
    })
}

/// Whether a path of an exception names the file or its folder.
fn is_within(file: &str, path: &str) -> bool {
    file == path || (path.ends_with('/') && file.starts_with(path))
}

/// The first names, and how many more there are.
fn enumerate(names: &[&String]) -> String {
    let named: Vec<&str> = names.iter().take(MOST_NAMED).map(|name| name.as_str()).collect();
    match names.len() - named.len() {
        0 => named.join(", "),
        more => format!("{} and {more} more", named.join(", ")),
    }
}

/// The listing of a crate: its circles with the arrows inside them, or all its arrows.
pub(super) fn list(folder: &str, sources: &Sources<'_>, all: bool) -> String {
    list_with(folder, sources, all, &EXCEPTIONS)
}

fn list_with(folder: &str, sources: &Sources<'_>, all: bool, exceptions: &[Exception]) -> String {
    let graph = Graph::new(sources);
    let line = |((from, to), names): (&(String, String), &BTreeSet<String>)| {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        format!("  {from} -> {to}: {}\n", names.join(", "))
    };
    if all {
        let lines: String = graph.arrows.iter().map(line).collect();
        return format!("{folder}: {} arrows\n{lines}", graph.arrows.len());
    }

    // Say what is left out.
    let (mut text, mut hubs) = (String::new(), Vec::new());
    for exception in exceptions.iter().filter(|e| e.folder == folder && !e.hubs().is_empty()) {
        text += &format!(
            "{folder}: without the arrows to {}: {}\n",
            exception.hubs().join(", "),
            exception.reason
        );
        hubs.extend(exception.hubs());
    }

    // List each circle, with the reason if it is large and may be.
    let circles = graph.circles(&hubs);
    for circle in &circles {
        let mut allowing = exceptions
            .iter()
            .filter(|e| e.folder == folder && circle.iter().all(|file| e.covers(file)));
        let exception = allowing.next().filter(|_| circle.len() > MOST_FILES);
        let reason = exception.map_or(String::new(), |exception| format!(": {}", exception.reason));
        text += &format!("{folder}: a circle of {} files{reason}\n", circle.len());
        let inside = graph
            .arrows
            .iter()
            .filter(|((from, to), _)| circle.contains(from) && circle.contains(to));
        text.extend(inside.map(line));
    }
    if circles.is_empty() {
        text += &format!("{folder}: no circle\n");
    }
    text
}

/// The arrows of a crate.
struct Graph {
    arrows: Arrows,
}

impl Graph {
    fn new(sources: &Sources<'_>) -> Self {
        let mut all = Arrows::new();
        for root in ROOTS.into_iter().filter(|root| sources.contains_key(root)) {
            for (ends, names) in arrows::arrows(&modules::read_modules(sources, root)) {
                all.entry(ends).or_default().extend(names);
            }
        }
        Self { arrows: all }
    }

    /// The circles of more than [`MOST_FILES`].
    fn large_circles(&self, hubs: &[&str]) -> Vec<Vec<String>> {
        self.circles(hubs).into_iter().filter(|circle| circle.len() > MOST_FILES).collect()
    }

    /// The files of each circle, the largest first; arrows to `hubs` are not followed.
    fn circles(&self, hubs: &[&str]) -> Vec<Vec<String>> {
        // Number the files.
        let files: BTreeSet<&str> =
            self.arrows.keys().flat_map(|(from, to)| [from.as_str(), to]).collect();
        let files: Vec<&str> = files.into_iter().collect();
        let numbers: BTreeMap<&str, usize> = files.iter().copied().zip(0..).collect();
        let mut successors = vec![Vec::new(); files.len()];
        for (from, to) in self.arrows.keys().filter(|(_, to)| !hubs.contains(&to.as_str())) {
            successors[numbers[from.as_str()]].push(numbers[to.as_str()]);
        }

        let components =
            components::components(&successors).into_iter().filter(|component| component.len() > 1);
        let named = |component: Vec<usize>| {
            component.into_iter().map(|number| files[number].to_owned()).collect()
        };
        let mut circles: Vec<Vec<String>> = components.map(named).collect();
        circles.sort_by_key(|circle| (Reverse(circle.len()), circle[0].clone()));
        circles
    }
}

#[cfg(test)]
mod tests;
