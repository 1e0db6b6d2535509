//! The same calls with our library and with Mesa's, compared. Skipped, with a line, where Mesa's
//! library is not installed.

use crate::common::{mesa, ours, run, runner};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A scene as the runner lists it.
struct Scene {
    group: String,
    name: String,
    agreement: Agreement,
}

/// How well the libraries must agree.
#[derive(Clone, Copy)]
enum Agreement {
    Exact,
    Rounded,
    Close,
}

/// All scenes.
fn scenes() -> Vec<Scene> {
    let listed = run(runner().arg("--list"));
    assert!(listed.fine, "{listed:?}");
    let scene = |line: &str| {
        let mut words = line.split(' ').map(str::to_owned);
        let (group, name, agreement) = (words.next()?, words.next()?, words.next()?);
        let agreement = match agreement.as_str() {
            "Exact" => Agreement::Exact,
            "Rounded" => Agreement::Rounded,
            "Close" => Agreement::Close,
            _ => return None,
        };
        Some(Scene { group, name, agreement })
    };
    listed
        .output
        .lines()
        .map(|line| scene(line).unwrap_or_else(|| panic!("not understood: {line}")))
        .collect()
}

/// What a library made of a scene.
struct Result {
    size: [u32; 2],
    rgba: Vec<u8>,
    depth: Vec<f32>,
    numbers: Vec<f32>,
}

fn floats(path: &Path) -> Option<Vec<f32>> {
    let bytes = std::fs::read(path).ok()?;
    Some(bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect())
}

fn read(folder: &Path, scene: &str) -> Option<Result> {
    let mut rgba = std::fs::read(folder.join(format!("{scene}.rgba"))).ok()?;
    let pixels = rgba.split_off(8);
    let number = |at: usize| u32::from_le_bytes(std::array::from_fn(|i| rgba[at + i]));
    let depth = floats(&folder.join(format!("{scene}.depth")))?;
    let numbers = floats(&folder.join(format!("{scene}.numbers")))?;
    Some(Result { size: [number(0), number(4)], rgba: pixels, depth, numbers })
}

/// Draws scenes with a library; gives what went wrong for those that ended the runner.
fn draw(library: &Path, folder: &Path, names: &[&str]) -> BTreeMap<String, String> {
    let _ = std::fs::remove_dir_all(folder);
    let mut failed = BTreeMap::new();
    let mut rest = names;
    while !rest.is_empty() {
        let ended = run(runner().env("SCENE_PICTURES", "1").arg(library).arg(folder).args(rest));
        if ended.fine {
            break;
        }
        // The last one named did not come to its end; go on behind it.
        let last = ended.output.lines().last().unwrap_or(rest[0]).to_owned();
        let at = rest.iter().position(|name| *name == last).unwrap_or(0);
        failed.insert(rest[at].to_owned(), ended.errors);
        rest = &rest[at + 1..];
    }
    failed
}

/// Pixels that differ by more than this are counted.
const TOLERANCE: u8 = 8;

/// What is wrong, if anything.
fn compare(agreement: Agreement, ours: &Result, mesa: &Result) -> std::result::Result<(), String> {
    if ours.size != mesa.size || ours.rgba.len() != mesa.rgba.len() {
        return Err(format!("sizes {:?} and {:?}", ours.size, mesa.size));
    }
    let mut problems = Vec::new();

    // Colours.
    let apart =
        |(a, b): (&[u8], &[u8])| a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0);
    let apart: Vec<u8> =
        ours.rgba.chunks_exact(4).zip(mesa.rgba.chunks_exact(4)).map(apart).collect();
    let worst = apart.iter().copied().max().unwrap_or(0);
    let share = |count: usize| count as f64 / apart.len() as f64;
    let far = share(apart.iter().filter(|d| **d > TOLERANCE).count());
    let wrong = match agreement {
        Agreement::Exact => worst > 0,
        Agreement::Rounded => worst > 2,
        Agreement::Close => far > 0.01,
    };
    if wrong {
        problems.push(format!(
            "{:.2} % of pixels differ by more than {TOLERANCE} (worst {worst})",
            100.0 * far
        ));
    }

    // Depths.
    let depths =
        ours.depth.iter().zip(&mesa.depth).filter(|(a, b)| (**a - **b).abs() > 1e-3).count();
    if share(depths) > 0.01 || ours.depth.len() != mesa.depth.len() {
        problems.push(format!("{:.2} % of depths differ", 100.0 * share(depths)));
    }

    // Numbers. Codes of errors are near each other, yet different.
    let is_error = |number: f32| number.fract() == 0.0 && (1280.0..=1286.0).contains(&number);
    let equal = |(a, b): &(&f32, &f32)| {
        let near = if is_error(**a) && is_error(**b) { 0.0 } else { 0.01_f32.max(b.abs() * 1e-3) };
        (**a - **b).abs() <= near || (a.is_nan() && b.is_nan())
    };
    if ours.numbers.len() != mesa.numbers.len() {
        problems.push(format!("{} numbers instead of {}", ours.numbers.len(), mesa.numbers.len()));
    } else if let Some(at) = ours.numbers.iter().zip(&mesa.numbers).position(|pair| !equal(&pair)) {
        let count = ours.numbers.iter().zip(&mesa.numbers).filter(|pair| !equal(pair)).count();
        let (a, b) = (ours.numbers[at], mesa.numbers[at]);
        problems.push(format!(
            "{count} of {} numbers differ, number {at} is {a} instead of {b}",
            ours.numbers.len()
        ));
    }
    if problems.is_empty() { Ok(()) } else { Err(problems.join("; ")) }
}

/// Compares all scenes of a group.
fn group(wanted: &str) {
    let Some(mesa) = mesa() else {
        println!("skipped: Mesa's libOSMesa is not installed (Debian: libosmesa6)");
        return;
    };
    let scenes: Vec<Scene> = scenes().into_iter().filter(|scene| scene.group == wanted).collect();
    assert!(!scenes.is_empty(), "there is no group {wanted}");
    let names: Vec<&str> = scenes.iter().map(|scene| scene.name.as_str()).collect();
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("scenes").join(wanted);
    let (our_folder, mesa_folder): (PathBuf, PathBuf) =
        (folder.join("vitral"), folder.join("mesa"));
    let refused = draw(&mesa, &mesa_folder, &names);
    assert!(refused.is_empty(), "Mesa: {refused:?}");
    let failed = draw(&ours(), &our_folder, &names);

    // Every scene is looked at, so that one run tells all.
    let verdict = |scene: &Scene| -> std::result::Result<(), String> {
        if let Some(why) = failed.get(&scene.name) {
            return Err(format!("ended the runner: {}", why.trim()));
        }
        let ours = read(&our_folder, &scene.name).ok_or("nothing was drawn")?;
        let mesa = read(&mesa_folder, &scene.name).ok_or("Mesa drew nothing")?;
        compare(scene.agreement, &ours, &mesa)
    };
    let tell = |scene: &Scene| verdict(scene).err().map(|why| format!("  {}: {why}", scene.name));
    let problems: Vec<String> = scenes.iter().filter_map(tell).collect();
    assert!(
        problems.is_empty(),
        "{} of {} scenes differ from Mesa; pictures are in {}\n{}",
        problems.len(),
        scenes.len(),
        folder.display(),
        problems.join("\n")
    );
}

/// A test for each group.
macro_rules! groups {
    ($($name:ident)+) => {
        $(
            #[test]
            fn $name() {
                group(stringify!($name));
            }
        )+

        #[test]
        fn every_group_has_its_test() {
            let tested = [$(stringify!($name)),+];
            let untested = scenes().into_iter().find(|scene| !tested.contains(&scene.group.as_str()));
            assert!(untested.is_none(), "{:?}", untested.map(|scene| scene.group));
        }
    };
}

groups! {
    lines polygons lighting fog texgen textures texture_images environment alpha_stencil blending images reading lists
    arrays framebuffers queries surfaces extensions
}

#[test]
fn differences_are_seen() {
    let result = |rgba: [u8; 4], depth: f32, number: f32| Result {
        size: [1, 1],
        rgba: rgba.to_vec(),
        depth: vec![depth],
        numbers: vec![number],
    };
    let with = |agreement, rgba, depth, number| {
        compare(agreement, &result(rgba, depth, number), &result([100; 4], 0.5, 7.0)).is_ok()
    };
    assert!(with(Agreement::Exact, [100; 4], 0.5, 7.0));
    assert!(!with(Agreement::Exact, [100, 101, 100, 100], 0.5, 7.0));
    assert!(with(Agreement::Rounded, [98, 102, 100, 100], 0.5, 7.0));
    assert!(!with(Agreement::Rounded, [97, 100, 100, 100], 0.5, 7.0));
    assert!(with(Agreement::Close, [92, 108, 100, 100], 0.5005, 7.005));
    assert!(!with(Agreement::Close, [91, 100, 100, 100], 0.5, 7.0));
    assert!(!with(Agreement::Close, [100; 4], 0.6, 7.0));
    assert!(!with(Agreement::Close, [100; 4], 0.5, 8.0));
}
