//! What is drawn: generated meshes and models, and the work on each.

use super::programs::Work;
use crate::shell::{command, output, relative, repository, target_folder};
use std::path::PathBuf;

/// A model and what is drawn of it.
pub(super) struct Subject {
    /// Its name in the tables.
    pub(super) name: String,
    /// What vitral reads.
    pub(super) model: PathBuf,
    /// The same as triangles, for peers.
    pub(super) mesh: PathBuf,
    /// Whether its faces enclose a volume and none can be seen from behind.
    pub(super) closed: bool,
    /// Steps of the growth tables: triangles of a generated knot.
    pub(super) knot: Option<u64>,
    /// What is drawn.
    pub(super) works: &'static [Work],
}

/// Triangles of the knots.
pub(super) const KNOTS: [u64; 4] = [1_000, 10_000, 100_000, 1_000_000];

/// What is drawn of knots and scans.
const ALL: [Work; 4] = [Work::AllEdges, Work::Creases, Work::Partition, Work::Filled];

/// What is drawn of models made by hand.
const MODELLED: [Work; 3] = [Work::Lines, Work::LinesAndFill, Work::Partition];

/// Models with their names, files and works. Those below `../shared` may be absent.
const MODELS: [(&str, &str, &[Work]); 8] = [
    ("teapot", "../shared/models/classics/utah-teapot.obj", &ALL),
    ("bunny", "../shared/models/classics/stanford-bunny.obj", &ALL),
    ("deer", "examples/models/deer/deer.obj", &MODELLED),
    ("stoneLantern", "examples/models/stoneLantern/stoneLantern.obj", &MODELLED),
    ("pianoAQueue", "../shared/models/furniture-cc0/pianoAQueue/pianoAQueue.obj", &MODELLED),
    ("kitchenaid", "../shared/models/furniture-cc0/kitchenaid/kitchenaid.obj", &MODELLED),
    ("poolTable", "../shared/models/furniture-cc0/poolTable/poolTable.obj", &MODELLED),
    ("peterbilt", "../shared/models/furniture-cc0/peterbilt/peterbilt.obj", &MODELLED),
];

/// All subjects; generated files are made once.
pub(super) fn subjects() -> Result<Vec<Subject>, String> {
    // Add closed knots of several sizes, for all works.
    let mut subjects = Vec::new();
    for triangles in KNOTS {
        let mesh = generated("knot", triangles)?;
        let name = format!("torus knot, {}", grouped(triangles));
        subjects.push(Subject {
            name,
            model: mesh.clone(),
            mesh,
            closed: true,
            knot: Some(triangles),
            works: &ALL,
        });
    }

    // Add triangles that cross each other, and many small ones.
    for (kind, triangles, name) in
        [("slivers", 3_000, "crossing slivers"), ("small", 100_000, "random triangles")]
    {
        let mesh = generated(kind, triangles)?;
        let works = &[Work::AllEdges, Work::Partition, Work::Filled];
        let name = format!("{} {name}", grouped(triangles));
        subjects.push(Subject {
            name,
            model: mesh.clone(),
            mesh,
            closed: false,
            knot: None,
            works,
        });
    }

    // Add the scene for shadows and glass.
    let glass = generated("glass", 10_000)?;
    let works = &[Work::ShadowsAndGlass];
    let name = "knot, floor and glass ball, 10 000".to_owned();
    subjects.push(Subject {
        name,
        model: glass.clone(),
        mesh: glass,
        closed: false,
        knot: None,
        works,
    });

    // Add the models that are there.
    for (name, path, works) in MODELS {
        let model = repository().join(path);
        if !model.exists() {
            println!("left out: {} is not there", relative(&model));
            continue;
        }
        let mesh = folder()?.join(format!("{name}.ply"));
        if !mesh.exists() {
            output(command("python3").args([MESHES, "triangles"]).arg(&model).arg(&mesh))?;
        }
        subjects.push(Subject {
            name: name.to_owned(),
            model,
            mesh,
            closed: false,
            knot: None,
            works,
        });
    }
    Ok(subjects)
}

/// What makes the meshes.
const MESHES: &str = "benches/peers/draw/meshes.py";

/// A generated model of `triangles` triangles, made once.
pub(super) fn generated(kind: &str, triangles: u64) -> Result<PathBuf, String> {
    let extension = if kind == "glass" { "obj" } else { "ply" };
    let path = folder()?.join(format!("{kind}-{triangles}.{extension}"));
    if !path.exists() {
        output(command("python3").args([MESHES, kind, &triangles.to_string()]).arg(&path))?;
    }
    Ok(path)
}

/// Where meshes and drawings lie.
pub(super) fn folder() -> Result<PathBuf, String> {
    let folder = target_folder().join("compare-draw");
    std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    Ok(folder)
}

/// `1 234 567`.
pub(super) fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_stand_in_groups_of_three() {
        assert_eq!([0, 999, 1_000, 1_234_567].map(grouped), ["0", "999", "1 000", "1 234 567"]);
    }
}
