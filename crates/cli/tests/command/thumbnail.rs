//! Thumbnails, as file managers call for them.

use super::*;
use vitral_testkit::fixture::{SKIPPED, shared_models};

/// Width, height and pixels of a PNG with transparency.
fn pixels(file: &std::path::Path) -> (u32, u32, Vec<u8>) {
    let mut reader =
        png::Decoder::new(std::io::Cursor::new(std::fs::read(file).unwrap())).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!(info.color_type, png::ColorType::Rgba, "{}", file.display());
    (info.width, info.height, pixels)
}

/// `vitral thumbnail ARGUMENTS`.
fn thumbnail(folder: &Folder, arguments: &[&str]) -> Output {
    folder.run(&[&["thumbnail"], arguments].concat())
}

#[test]
fn a_thumbnail_is_a_square_on_nothing_whatever_it_is_called() {
    let folder = Folder::new("thumbnail");
    folder.file("flat.obj", "v 0 0 0\nv 4 0 0\nv 4 1 0\nv 0 1 0\nf 1 2 3 4\n");
    // The user's defaults are for pictures.
    std::fs::create_dir_all(folder.0.join("vitral")).unwrap();
    folder
        .file("vitral/config.json", r#"{"settings": {"shading": "flat", "background": "black"}}"#);
    let made = thumbnail(&folder, &["flat.obj", "flat.thumbnail", "128"]);
    assert_eq!((code(&made), errors(&made).as_str()), (0, ""));

    // The model is wider than high: it touches no edge, and is seen over more columns than rows.
    let (width, height, pixels) = pixels(&folder.0.join("flat.thumbnail"));
    assert_eq!((width, height), (128, 128));
    let is_seen = |x: u32, y: u32| pixels[((y * 128 + x) * 4 + 3) as usize] > 0;
    let columns = (0..128).filter(|&x| (0..128).any(|y| is_seen(x, y))).count();
    let rows = (0..128).filter(|&y| (0..128).any(|x| is_seen(x, y))).count();
    assert!(columns > rows && rows > 16, "{columns} columns, {rows} rows");
    assert!(
        (0..128).all(|i| !is_seen(i, 0) && !is_seen(0, i) && !is_seen(i, 127) && !is_seen(127, i))
    );
}

#[test]
fn what_gives_no_thumbnail_leaves_no_file() {
    let folder = Folder::new("no-thumbnail");
    folder.file("empty.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    folder.file("broken.glb", "glTF");
    folder.file("text.txt", "no model\n");
    folder.file("a.obj", TRIANGLE);
    for (arguments, expected) in [
        (["empty.obj", "x.png", "64"], 4),
        (["broken.glb", "x.png", "64"], 3),
        (["text.txt", "x.png", "64"], 4),
        (["absent.obj", "x.png", "64"], 3),
        (["a.obj", "x.png", "0"], 2),
        (["a.obj", "x.png", "5000"], 2),
        (["a.obj", "absent/x.png", "64"], 5),
    ] {
        let made = thumbnail(&folder, &arguments);
        assert_eq!(code(&made), expected, "{arguments:?}: {}", errors(&made));
        assert!(errors(&made).starts_with("vitral: ") || expected == 2, "{}", errors(&made));
        assert!(!folder.has("x.png"), "{arguments:?}");
    }
}

/// `vitral` with these arguments where there is nothing but `/usr`, the folder of the model, and
/// that of the picture: no environment, no network, no `/proc`. `None` where no such place can be
/// made.
#[cfg(target_os = "linux")]
fn jailed(models: &std::path::Path, folder: &Folder, arguments: &[&str]) -> Option<Output> {
    let mut command = Command::new("bwrap");
    command.args(["--unshare-all", "--clearenv", "--die-with-parent", "--ro-bind", "/usr", "/usr"]);
    command.args(["--symlink", "usr/lib", "/lib", "--symlink", "usr/lib64", "/lib64"]);
    command.arg("--ro-bind").arg(env!("CARGO_BIN_EXE_vitral")).arg("/vitral");
    command.arg("--ro-bind").arg(models).arg("/models").arg("--bind").arg(&folder.0).arg("/out");
    command.arg("/vitral").args(arguments).stdin(Stdio::null()).output().ok()
}

/// Forty files of the corpus, of all formats that are read, the largest models among them.
#[cfg(target_os = "linux")]
#[test]
fn forty_models_have_thumbnails_in_a_jail() {
    // Look for models, and for a jail.
    let folder = Folder::new("jail");
    let mut found = shared_models("", &["obj", "stl", "ply", "off", "gltf", "glb"]);
    found.retain(|path| !path.components().any(|part| part.as_os_str() == "malformed"));
    if found.is_empty() {
        return;
    }
    let root = vitral_testkit::fixture::repository().join("../shared/models");
    let version = jailed(&root, &folder, &["--version"]).filter(|output| code(output) == 0);
    if version.is_none() {
        println!("{SKIPPED}bwrap is not installed or makes no jail here");
        return;
    }

    // The largest files first, then every so many of the rest.
    found.sort_by_key(|path| {
        std::cmp::Reverse(std::fs::metadata(path).map_or(0, |data| data.len()))
    });
    let rest = found.split_off(10);
    let step = (rest.len() / 30).max(1);
    found.extend(rest.into_iter().step_by(step).take(30));
    assert_eq!(found.len(), 40);
    let mut seen = 0;
    for model in &found {
        let inside = format!("/models/{}", model.strip_prefix(&root).unwrap().display());
        let made = jailed(&root, &folder, &["thumbnail", &inside, "/out/x.png", "256"]).unwrap();
        let told = errors(&made);
        match code(&made) {
            0 => {
                let (width, height, pixels) = pixels(&folder.0.join("x.png"));
                assert_eq!((width, height), (256, 256), "{inside}");
                assert!(pixels.chunks(4).any(|pixel| pixel[3] > 0), "{inside}: nothing is seen");
                std::fs::remove_file(folder.0.join("x.png")).unwrap();
                seen += 1;
            }
            // A model without a surface has none; what a reader refuses, it refuses everywhere.
            refused => assert!(
                [3, 4].contains(&refused) && told.starts_with("vitral: "),
                "{inside}: {refused} {told}"
            ),
        }
    }
    assert!(seen >= 36, "{seen} of 40 models have thumbnails");
}

/// A ball of `rows` x `rows` quads, two triangles each, as a binary STL.
fn ball(rows: u32) -> Vec<u8> {
    let point = |row: u32, column: u32| -> [f32; 3] {
        let (height, turn) =
            (f64::from(row) / f64::from(rows), f64::from(column % rows) / f64::from(rows));
        // A double cone is round enough.
        let radius = 1.0 - (2.0 * height - 1.0).abs();
        let side = |turn: f64| 1.0 - 4.0 * ((turn % 1.0) - 0.5).abs();
        [(radius * side(turn)) as f32, (radius * side(turn + 0.25)) as f32, height as f32]
    };
    let mut bytes = vec![0; 80];
    bytes.extend((rows * rows * 2).to_le_bytes());
    for (row, column) in (0..rows).flat_map(|row| (0..rows).map(move |column| (row, column))) {
        let corners = [(row, column), (row, column + 1), (row + 1, column + 1), (row + 1, column)];
        let [a, b, c, d] = corners.map(|(row, column)| point(row, column));
        for triangle in [[a, b, c], [a, c, d]] {
            let numbers = [[0.0; 3]].into_iter().chain(triangle).flatten();
            bytes.extend(numbers.flat_map(f32::to_le_bytes));
            bytes.extend([0, 0]);
        }
    }
    bytes
}

#[cfg(target_os = "linux")]
#[test]
fn a_hundred_thousand_triangles_take_less_than_half_a_gigabyte() {
    let folder = Folder::new("thumbnail-memory");
    folder.file("ball.stl", ball(224));
    // Addresses, of which the process uses fewer as memory. Threads reserve 8 MB for each stack.
    let line = "ulimit -v 524288; exec \"$0\" thumbnail ball.stl ball.png 256";
    let mut command = Command::new("sh");
    command.args(["-c", line, env!("CARGO_BIN_EXE_vitral")]).current_dir(&folder.0);
    let made = command.output().unwrap();
    assert_eq!(code(&made), 0, "{}", errors(&made));
    assert_eq!(pixels(&folder.0.join("ball.png")).0, 256);
}
