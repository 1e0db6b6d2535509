//! The bill of materials: every crate that is built in, by `cargo metadata` and the lock file, as
//! CycloneDX 1.5.

use super::{Built, shown, text_of};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// What is handed out.
const PROGRAMS: [&str; 3] = ["vitral-cli", "vitral-osmesa", "vitral-python"];

/// Writes `vitral-VERSION.cdx.json`.
pub(super) fn write(built: &Built, folder: &Path) -> Result<PathBuf, String> {
    let place = folder.join(format!("vitral-{}.cdx.json", built.version));
    let text = serde_json::to_string_pretty(&bill(built)?).map_err(|e| e.to_string())?;
    fs::write(&place, text + "\n").map_err(|e| shown(&place, &e))?;
    Ok(place)
}

/// The bill.
fn bill(built: &Built) -> Result<Value, String> {
    // List the components, without ours: these are what is described.
    let sums = checksums(&text_of("Cargo.lock")?);
    let all = built_in(&built.metadata)?;
    let component = |package: &&Value| {
        let (name, version) = (text(package, "name"), text(package, "version"));
        let mut component = json!({
            "type": "library", "bom-ref": reference(package), "name": name, "version": version, "purl": reference(package),
        });
        if let Some(licence) = package["license"].as_str() {
            // Some crates write `MIT/Apache-2.0`, which means the same.
            component["licenses"] = json!([{"expression": licence.replace('/', " OR ")}]);
        }
        if let Some(sum) = sums.get(&(name.to_owned(), version.to_owned())) {
            component["hashes"] = json!([{"alg": "SHA-256", "content": sum}]);
        }
        if let Some(url) = package["repository"].as_str() {
            component["externalReferences"] = json!([{"type": "vcs", "url": url}]);
        }
        component
    };
    let components: Vec<Value> = all.iter().map(component).collect();

    // Tell who needs whom.
    let names: BTreeMap<&str, String> =
        all.iter().map(|package| (text(package, "id"), reference(package))).collect();
    let mut dependencies = vec![json!({"ref": "vitral", "dependsOn": all.iter()
        .filter(|package| PROGRAMS.contains(&text(package, "name"))).map(|package| reference(package)).collect::<Vec<_>>()})];
    for (id, name) in &names {
        let needed: BTreeSet<&String> =
            needs(&built.metadata, id).iter().filter_map(|id| names.get(id)).collect();
        dependencies.push(json!({"ref": name, "dependsOn": needed}));
    }
    Ok(json!({
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {
            "timestamp": date(built.time),
            "component": {
                "type": "application", "bom-ref": "vitral", "name": "vitral", "version": built.version,
                "licenses": [{"expression": "MIT OR Apache-2.0"}],
            },
        },
        "components": components,
        "dependencies": dependencies,
    }))
}

/// The packages that the programs are built of, in the order of their names and versions.
pub(super) fn built_in(metadata: &Value) -> Result<Vec<&Value>, String> {
    // Follow what is needed at run time; macros and build scripts stay behind.
    let packages = || metadata["packages"].as_array().into_iter().flatten();
    let is_program = |package: &&Value| PROGRAMS.contains(&text(package, "name"));
    let mut waiting: Vec<&str> =
        packages().filter(is_program).map(|package| text(package, "id")).collect();
    if waiting.len() != PROGRAMS.len() {
        return Err("cargo metadata does not tell of all programs".to_owned());
    }
    let macros: BTreeSet<&str> =
        packages().filter(|package| is_macro(package)).map(|package| text(package, "id")).collect();
    let mut found = BTreeSet::new();
    while let Some(id) = waiting.pop() {
        if !macros.contains(id) && found.insert(id) {
            waiting.extend(needs(metadata, id));
        }
    }
    let mut all: Vec<&Value> =
        packages().filter(|package| found.contains(text(package, "id"))).collect();
    all.sort_by_key(|package| (text(package, "name"), text(package, "version")));
    Ok(all)
}

/// Whether a package is of this workspace.
pub(super) fn is_own(package: &Value) -> bool {
    package["source"].is_null()
}

/// Whether a package is a macro, which runs in the compiler.
fn is_macro(package: &Value) -> bool {
    let targets = package["targets"].as_array().into_iter().flatten();
    targets
        .flat_map(|target| target["kind"].as_array().into_iter().flatten())
        .any(|kind| kind == "proc-macro")
}

/// What a package needs at run time.
fn needs<'m>(metadata: &'m Value, id: &str) -> Vec<&'m str> {
    let mut nodes = metadata["resolve"]["nodes"].as_array().into_iter().flatten();
    let node = nodes.find(|node| text(node, "id") == id);
    let needed = node.and_then(|node| node["deps"].as_array()).into_iter().flatten();
    let at_run_time = |dep: &&Value| {
        dep["dep_kinds"].as_array().into_iter().flatten().any(|kind| kind["kind"].is_null())
    };
    needed.filter(at_run_time).map(|dep| text(dep, "pkg")).collect()
}

/// A package's name in the whole world.
fn reference(package: &Value) -> String {
    format!("pkg:cargo/{}@{}", text(package, "name"), text(package, "version"))
}

fn text<'v>(value: &'v Value, key: &str) -> &'v str {
    value[key].as_str().unwrap_or_default()
}

/// The checksums of a lock file, by name and version.
fn checksums(lock: &str) -> BTreeMap<(String, String), String> {
    let block = |block: &str| {
        let value = |key: &str| {
            let line =
                block.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(" = \""))?;
            Some(line.trim_end_matches('"').to_owned())
        };
        Some(((value("name")?, value("version")?), value("checksum")?))
    };
    lock.split("[[package]]").filter_map(block).collect()
}

/// A time as ISO 8601 has it, by the days of the civil calendar since 1970.
fn date(seconds: u64) -> String {
    let (days, rest) = (seconds / 86_400, seconds % 86_400);
    let is_leap = |year: u64| {
        year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400))
    };
    let (mut year, mut day) = (1970, days);
    while day >= 365 + u64::from(is_leap(year)) {
        day -= 365 + u64::from(is_leap(year));
        year += 1;
    }
    let mut month = 1;
    for length in [31, 28 + u64::from(is_leap(year)), 31, 30, 31, 30, 31, 31, 30, 31, 30, 31] {
        if day < length {
            break;
        }
        day -= length;
        month += 1;
    }
    let (hour, minute, second) = (rest / 3600, rest / 60 % 60, rest % 60);
    format!("{year:04}-{month:02}-{:02}T{hour:02}:{minute:02}:{second:02}Z", day + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_dates() {
        assert_eq!(date(0), "1970-01-01T00:00:00Z");
        assert_eq!(date(951_782_400), "2000-02-29T00:00:00Z");
        assert_eq!(date(1_795_913_847), "2026-11-29T00:57:27Z");
    }

    #[test]
    fn checksums_are_read_by_package() {
        let lock = "version = 4\n\n[[package]]\nname = \"a\"\nversion = \"1.0.0\"\n\n[[package]]\nname = \"b\"\nversion = \"2.0.0\"\n\
                    source = \"registry\"\nchecksum = \"00ff\"\n";
        let sums = checksums(lock);
        assert_eq!(
            sums.into_iter().collect::<Vec<_>>(),
            [(("b".to_owned(), "2.0.0".to_owned()), "00ff".to_owned())]
        );
    }

    #[test]
    fn what_is_needed_only_to_build_is_not_built_in() {
        let package = |name: &str, kind: &str| json!({"name": name, "version": "1.0.0", "id": name, "targets": [{"kind": [kind]}]});
        let dep = |name: &str, kind: Value| json!({"pkg": name, "dep_kinds": [{"kind": kind}]});
        let metadata = json!({
            "packages": [
                package("vitral-python", "cdylib"), package("vitral-osmesa", "cdylib"), package("vitral-cli", "bin"),
                package("a", "lib"), package("b", "lib"), package("c", "lib"), package("d", "proc-macro"),
            ],
            "resolve": {"nodes": [
                {"id": "vitral-cli", "deps": [dep("a", Value::Null), dep("b", json!("build")), dep("d", Value::Null)]},
                {"id": "a", "deps": [dep("c", Value::Null)]},
            ]},
        });
        let names: Vec<&str> =
            built_in(&metadata).unwrap().into_iter().map(|package| text(package, "name")).collect();
        assert_eq!(names, ["a", "c", "vitral-cli", "vitral-osmesa", "vitral-python"]);
        assert_eq!(reference(&metadata["packages"][3]), "pkg:cargo/a@1.0.0");
    }
}
