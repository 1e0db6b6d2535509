//! The floors of the house: imports only point down.
//!
//! Input: `cargo metadata --no-deps`. A crate may use crates of lower floors, and on its own floor
//! those that stand before it. Dev-dependencies are free: tests may look anywhere.
//!
//! Threads stay behind the face's feature `threads`: nothing in the house may turn on the default
//! features of `vitral-exec`, or a build for WebAssembly would bring a thread pool along.

use serde_json::Value;

/// Every crate's floor and its place on it. Equal places do not see each other.
const FLOORS: [(&str, u32, u32); 16] = [
    ("vitral-math", 0, 0),
    ("vitral-exec", 0, 0),
    ("vitral-frame", 1, 0),
    ("vitral-light", 1, 1),
    ("vitral-scene", 1, 2),
    ("vitral-raster", 2, 0),
    ("vitral-render", 3, 0),
    ("vitral-draw", 3, 0),
    ("vitral-io", 3, 0),
    ("vitral-gl", 3, 0),
    ("vitral", 4, 0),
    ("vitral-cli", 4, 1),
    ("vitral-lab", 4, 1),
    ("vitral-lab-wasm", 4, 2),
    ("vitral-osmesa", 4, 1),
    ("vitral-python", 4, 2),
];

/// Crates beside the house: they may use everything, nothing in the house may use them outside of
/// tests.
const BESIDE: [&str; 4] = ["vitral-testkit", "vitral-xtask", "vitral-wasm-probe", "vitral-fuzz"];

/// Where a crate stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Place {
    House(u32, u32),
    Beside,
}

fn place(name: &str) -> Option<Place> {
    if BESIDE.contains(&name) {
        return Some(Place::Beside);
    }
    FLOORS
        .iter()
        .find(|(crate_name, ..)| *crate_name == name)
        .map(|&(_, floor, order)| Place::House(floor, order))
}

/// The floor of the crate in `crates/FOLDER`; `None` beside the house or for a folder that is no
/// crate of ours.
pub(super) fn floor_of_folder(folder: &str) -> Option<u32> {
    let named = if folder == "vitral" { folder.to_owned() } else { format!("vitral-{folder}") };
    match place(&named) {
        Some(Place::House(floor, _)) => Some(floor),
        Some(Place::Beside) | None => None,
    }
}

/// One line for each import that points up, and for each crate that has no floor.
pub(super) fn check(metadata: &Value) -> Vec<String> {
    let mut violations = Vec::new();
    for package in list(&metadata["packages"]) {
        let name = package["name"].as_str().unwrap_or_default();
        let Some(from) = place(name) else {
            violations.push(format!(
                "{name}: has no floor; give it one in crates/xtask/src/check/floors.rs"
            ));
            continue;
        };

        // Look at the dependencies that lie in this workspace, those of tests excepted.
        for dependency in list(&package["dependencies"]) {
            let used = dependency["name"].as_str().unwrap_or_default();
            if dependency["path"].is_null() || dependency["kind"] == "dev" {
                continue;
            }
            let Some(to) = place(used) else { continue };
            if from != Place::Beside
                && used == "vitral-exec"
                && dependency["uses_default_features"] == true
            {
                violations.push(format!(
                    "{name}: uses {used} with its default features, which bring threads along"
                ));
            }
            match (from, to) {
                (Place::Beside, _) => {}
                (Place::House(..), Place::Beside) => {
                    violations.push(format!("{name}: uses {used}, which stands beside the house; only tests may"));
                }
                (Place::House(floor, _), Place::House(other, _)) if to >= from => violations
                    .push(format!("{name} (floor {floor}): uses {used} (floor {other}); imports only point down")),
                (Place::House(..), Place::House(..)) => {}
            }
        }
    }
    violations
}

fn list(value: &Value) -> impl Iterator<Item = &Value> {
    value.as_array().into_iter().flatten()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// The violations of one crate with one dependency.
    fn with(name: &str, dependency: &str, kind: Value) -> Vec<String> {
        let dependency = json!({"name": dependency, "kind": kind, "path": "crates/x"});
        check(&json!({"packages": [{"name": name, "dependencies": [dependency]}]}))
    }

    #[test]
    fn down_is_allowed_up_and_sideways_are_not() {
        assert!(with("vitral-render", "vitral-raster", Value::Null).is_empty());
        assert!(
            with("vitral-scene", "vitral-light", Value::Null).is_empty(),
            "scene stands after light"
        );
        assert!(with("vitral-cli", "vitral", Value::Null).is_empty());
        for (name, dependency) in [
            ("vitral-raster", "vitral-render"),
            ("vitral-light", "vitral-scene"),
            ("vitral-render", "vitral-io"),
            ("vitral-gl", "vitral-render"),
            ("vitral-math", "vitral-exec"),
            ("vitral", "vitral-cli"),
        ] {
            assert_eq!(with(name, dependency, Value::Null).len(), 1, "{name} uses {dependency}");
        }
        assert_eq!(
            with("vitral-raster", "vitral-render", json!("build")).len(),
            1,
            "build scripts too"
        );
    }

    #[test]
    fn only_tests_use_what_stands_beside_the_house() {
        assert_eq!(with("vitral-io", "vitral-testkit", Value::Null).len(), 1);
        assert!(with("vitral-io", "vitral-testkit", json!("dev")).is_empty());
        assert!(with("vitral-testkit", "vitral-io", Value::Null).is_empty());
    }

    #[test]
    fn a_crate_without_a_floor_is_refused_and_registry_crates_are_not_ours() {
        let violations =
            check(&json!({"packages": [{"name": "vitral-attic", "dependencies": []}]}));
        assert!(violations[0].contains("no floor"), "{violations:?}");
        let serde = json!({"name": "serde", "kind": null, "path": null});
        assert!(
            check(&json!({"packages": [{"name": "vitral-io", "dependencies": [serde]}]}))
                .is_empty()
        );
    }

    #[test]
    fn threads_are_not_brought_along() {
        let uses = |name: &str, defaults: bool| {
            let exec = json!({"name": "vitral-exec", "kind": null, "path": "x", "uses_default_features": defaults});
            check(&json!({"packages": [{"name": name, "dependencies": [exec]}]}))
        };
        assert!(uses("vitral-io", false).is_empty() && uses("vitral-testkit", true).is_empty());
        assert!(uses("vitral-io", true)[0].contains("default features"));
    }

    #[test]
    fn folders_have_floors() {
        assert_eq!(
            [floor_of_folder("math"), floor_of_folder("vitral"), floor_of_folder("xtask")],
            [Some(0), Some(4), None]
        );
    }
}
