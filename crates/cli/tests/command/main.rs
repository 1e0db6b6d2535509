//! The command as users meet it: a process with files, standard streams and an exit code.

mod batch;
mod choices;
mod course;
mod drawing;
mod files;
mod help;
mod mistakes;
mod models;
mod names;
mod outputs;
mod polygons;
mod process;
mod reports;
mod sections;
mod surroundings;
mod thumbnail;

use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

/// A folder of its own for a test, removed at its end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("vitral-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn file(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.join(name);
        std::fs::write(&path, content).unwrap();
        path
    }

    /// Runs `vitral` here with a small picture as the default and no configuration of the user's.
    fn run(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().unwrap()
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_vitral"));
        command.args(arguments).current_dir(&self.0).stdin(Stdio::null());
        command
            .env("XDG_CONFIG_HOME", &self.0)
            .env_remove("VITRAL_SIMD")
            .env_remove("VITRAL_THREADS");
        command
    }

    fn has(&self, name: &str) -> bool {
        self.0.join(name).exists()
    }

    fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.0.join(name)).unwrap()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn code(output: &Output) -> i32 {
    output.status.code().unwrap_or(-1)
}

fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

const SMALL: [&str; 2] = ["--resolution", "64x48"];
const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// `vitral render ARGUMENTS --resolution 64x48`.
fn render(folder: &Folder, arguments: &[&str]) -> Output {
    folder.run(&[&["render"], arguments, &SMALL].concat())
}

/// Standard output as JSON.
fn json(output: &Output) -> serde_json::Value {
    assert_eq!(code(output), 0, "{}", errors(output));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn p25_a_bench_has_a_row_for_every_algorithm_and_goes_on_after_a_limit() {
    let folder = Folder::new("bench");
    let arguments = ["bench", "builtin:cubs", "--resolution", "64x48", "--frames", "1"];
    let told = json(&folder.run(&[&arguments[..], &["--json"]].concat()));
    let rows = told["algorithms"].as_array().unwrap();
    assert!(rows.len() >= 8 && rows[0]["algorithm"] == "z-buffer", "{told}");
    assert!(
        rows.iter().all(|r| r["differing"] == 0 && r["median-seconds"].as_f64().unwrap() > 0.0),
        "{told}"
    );
    let limited = folder.run(&[&arguments[..], &["--time-limit", "1e-9"]].concat());
    let table = String::from_utf8(limited.stdout.clone()).unwrap();
    assert_eq!(
        table.matches("the time limit of 0.000000001 s was reached").count(),
        rows.len(),
        "{table}"
    );
    assert!(errors(&limited).contains("1 of "), "progress is on standard error");
    // The report begins with the command, and the camera is that of render's options.
    assert!(
        table.starts_with(
            "vitral bench builtin:cubs --resolution 64x48 --frames 1 --time-limit 1e-9\n"
        ),
        "{table}"
    );
    let z_buffer = ["--visibility", "z-buffer", "--json"];
    let seen = |camera: &[&str]| {
        let told = json(&folder.run(&[&arguments[..], &z_buffer, camera].concat()));
        let expected = [&["vitral"], &arguments[..], &z_buffer, camera].concat().join(" ");
        assert_eq!(told["command"], expected);
        told["algorithms"][0]["geometry"].clone()
    };
    let framed = seen(&[]);
    assert_eq!(framed, seen(&["--view", "three-quarter"]));
    for camera in
        [&["--camera-zoom-factor", "6"][..], &["--eye-rotation", "0,80,0"], &["--view", "top"]]
    {
        assert_ne!(framed, seen(camera), "{camera:?}");
    }
    assert_eq!(code(&folder.run(&[&arguments[..], &["--camera-index", "7"]].concat())), 2);
    assert_eq!(code(&folder.run(&["bench", "--report", "r", "--view", "top"])), 2);
    assert_eq!(code(&folder.run(&["bench"])), 2);
}

#[test]
fn models_on_standard_input_name_files_in_the_current_folder() {
    let folder = Folder::new("beside");
    folder.file("m.mtl", "newmtl red\nKd 1 0 0\n");
    for (text, warnings) in
        [("mtllib m.mtl\nusemtl red\n", ""), ("mtllib ../n.mtl\n", "outside the model's folder")]
    {
        let mut child = folder.command(&["info", "-"]);
        let mut child = child
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        child.stdin.take().unwrap().write_all(format!("{text}{TRIANGLE}").as_bytes()).unwrap();
        let output = child.wait_with_output().unwrap();
        assert_eq!(code(&output), 0);
        let told = String::from_utf8(output.stdout).unwrap();
        assert_eq!(told.contains("material library"), !warnings.is_empty(), "{told}");
        assert!(told.contains(warnings), "{told}");
    }
}

#[test]
fn coherence_is_a_choice_of_what_the_algorithm_has() {
    let folder = Folder::new("coherence");
    let with = |algorithm: &str, list: &str, name: &str| {
        render(
            &folder,
            &["builtin:cubs", "-o", name, "--visibility", algorithm, "--coherence", list],
        )
    };
    for (list, name) in
        [("none", "a.png"), ("edge,scan-line", "b.png"), ("face,area,implied-edge", "c.png")]
    {
        assert_eq!(code(&with("scan-line", list, name)), 0, "{list}");
        assert_eq!(folder.read("a.png"), folder.read(name), "{list}");
    }
    for algorithm in json(&folder.run(&["algorithms", "--json"]))["visibility"].as_array().unwrap()
    {
        let name = algorithm["name"].as_str().unwrap();
        let output = with(name, "all", "all.png");
        assert_eq!(code(&output), 0, "{name}: {}", errors(&output));
    }
    let refused = with("warnock", "face", "d.png");
    assert_eq!(code(&refused), 2);
    assert!(errors(&refused).contains("object, area, depth, frame"), "{}", errors(&refused));
}

#[test]
fn a_model_becomes_a_picture() {
    let folder = Folder::new("picture");
    folder.file("a.obj", TRIANGLE);
    for (name, magic) in [("a.png", &b"\x89PNG"[..]), ("a.jpg", b"\xff\xd8\xff"), ("a.ppm", b"P6")]
    {
        let output = render(&folder, &["a.obj", "-o", name]);
        assert_eq!(code(&output), 0, "{}", errors(&output));
        assert!(folder.read(name).starts_with(magic), "{name}");
    }
    // Without a verb.
    assert_eq!(code(&folder.run(&["a.obj", "-o", "b.png", "--resolution", "64x48"])), 0);
    assert_eq!(folder.read("a.png"), folder.read("b.png"));
}

#[test]
fn shadow_polygons_are_models_again() {
    let folder = Folder::new("shadow-polygons");
    for (algorithm, groups) in
        [("object-precision", &["lit"][..]), ("volume", &["near-cap", "far-cap", "side"])]
    {
        let file = format!("{algorithm}.obj");
        let light = "point:position=3,6,2";
        let exported = folder.run(&[
            "render",
            "builtin:scene0",
            "--shadows",
            algorithm,
            "--light",
            light,
            "--export-shadow-polygons",
            &file,
        ]);
        assert_eq!(code(&exported), 0, "{}", errors(&exported));
        let text = String::from_utf8(folder.read(&file)).unwrap();
        for group in groups {
            assert!(text.lines().any(|l| l == format!("g light0-{group}")), "{group}");
        }
        assert_eq!(code(&render(&folder, &[&file, "-o", "x.png"])), 0);
    }
}

#[test]
fn p21_a_model_becomes_a_drawing() {
    let folder = Folder::new("drawing");
    folder.file("a.obj", TRIANGLE);
    let output = folder.run(&["draw", "a.obj", "-o", "{model}.svg", "--view", "front", "--stats"]);
    assert_eq!(code(&output), 0, "{}", errors(&output));
    let stats: serde_json::Value = serde_json::from_slice(&output.stderr).unwrap();
    assert_eq!(
        [&stats["triangles"], &stats["edges"], &stats["polylines"], &stats["points"]],
        [1, 3, 1, 4]
    );
    // A right triangle with legs of 180 mm.
    let expected = 180.0 * (2.0 + 2f64.sqrt());
    assert!((stats["visible-millimetres"].as_f64().unwrap() - expected).abs() < 0.01, "{stats}");
    let file = String::from_utf8(folder.read("a.svg")).unwrap();
    assert!(
        file.contains("viewBox=\"0 0 190000 190000\"") && file.contains("data-class=\"boundary\""),
        "{file}"
    );

    // Standard output, filled, on a sheet.
    let output = folder.run(&[
        "draw",
        "a.obj",
        "-o",
        "-",
        "--style",
        "filled",
        "--page",
        "A4",
        "--landscape",
    ]);
    let filled = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(code(&output), 0, "{}", errors(&output));
    assert!(
        filled.contains("width=\"297mm\" height=\"210mm\"") && filled.matches("<path").count() == 1,
        "{filled}"
    );
}

#[test]
fn standard_streams() {
    let folder = Folder::new("streams");
    let mut child = folder
        .command(&["render", "-", "-o", "-", "--resolution", "64x48"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(TRIANGLE.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.stdout.starts_with(b"\x89PNG"));
    assert_eq!(code(&output), 0);
}

#[test]
fn channels_go_to_their_outputs() {
    let folder = Folder::new("channels");
    let output = render(
        &folder,
        &[
            "builtin:cubs",
            "--json",
            "--channel",
            "depth",
            "-o",
            "d.npy",
            "--channel",
            "id",
            "-o",
            "i.npy",
        ],
    );
    assert_eq!(code(&output), 0, "{}", errors(&output));
    assert!(folder.read("d.npy").starts_with(b"\x93NUMPY"));
    let ids = folder.read("i.npy");
    let header = String::from_utf8_lossy(&ids[..128]).into_owned();
    assert!(header.contains("'<u4'") && header.contains("(48, 64)"), "{header}");
    let said: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(said["outputs"], serde_json::json!(["d.npy", "i.npy"]));
    assert_eq!(
        code(&render(
            &folder,
            &["builtin:cubs", "--channel", "depth", "-o", "a.png", "-o", "b.png"]
        )),
        2
    );
}

#[test]
fn a_turntable_names_its_frames() {
    let folder = Folder::new("turn");
    let output = render(
        &folder,
        &["builtin:cubs", "--turntable", "4", "-o", "{model}-{frame:3}.png", "--frames", "1-2"],
    );
    assert_eq!(code(&output), 0, "{}", errors(&output));
    assert!(folder.has("cubs-001.png") && folder.has("cubs-002.png"));
    assert!(!folder.has("cubs-000.png") && !folder.has("cubs-003.png"));
    assert_eq!(code(&render(&folder, &["builtin:cubs", "--turntable", "4", "-o", "one.png"])), 2);
}

#[test]
fn state_and_configuration() {
    let folder = Folder::new("state");
    let first = [
        "builtin:scene0",
        "-o",
        "a.png",
        "--shading",
        "flat",
        "--view",
        "front",
        "--save-state",
        "s.json",
    ];
    assert_eq!(code(&render(&folder, &first)), 0);
    assert_eq!(code(&folder.run(&["render", "--load-state", "s.json", "-o", "b.png"])), 0);
    assert_eq!(folder.read("a.png"), folder.read("b.png"), "a loaded state gives the same picture");

    // The command line is above the state, the state above the configuration, and that above the
    // defaults.
    folder.file("c.json", r#"{"settings": {"shading": "gouraud", "samples": 1}}"#);
    let saved = |arguments: &[&str]| {
        let output = folder
            .run(&[&["render", "builtin:cubs", "--save-state", "t.json"], arguments].concat());
        assert_eq!(code(&output), 0, "{}", errors(&output));
        let state: serde_json::Value = serde_json::from_slice(&folder.read("t.json")).unwrap();
        (state["settings"]["shading"].clone(), state["settings"]["samples"].clone())
    };
    assert_eq!(saved(&["--config", "c.json"]), ("gouraud".into(), 1.into()));
    assert_eq!(saved(&["--config", "c.json", "--load-state", "s.json"]), ("flat".into(), 4.into()));
    assert_eq!(saved(&["--config", "c.json", "--shading", "phong"]), ("phong".into(), 1.into()));
    folder.file("broken.json", "{\n  \"settings\": {\"shadin\": 1}\n}");
    let output = render(&folder, &["builtin:cubs", "-o", "x.png", "--config", "broken.json"]);
    assert!(errors(&output).contains("broken.json: line 2"), "{}", errors(&output));
}

#[test]
fn paths_in_a_state_file_begin_in_its_folder() {
    let folder = Folder::new("state-paths");
    for name in ["models", "states", "other"] {
        std::fs::create_dir_all(folder.0.join(name)).unwrap();
    }
    std::fs::write(folder.0.join("models/a.obj"), TRIANGLE).unwrap();
    assert_eq!(
        code(&render(&folder, &["models/a.obj", "-o", "a.png", "--save-state", "states/s.json"])),
        0
    );
    let state: serde_json::Value = serde_json::from_slice(&folder.read("states/s.json")).unwrap();
    assert_eq!(state["models"], serde_json::json!(["../models/a.obj"]));
    let mut elsewhere =
        folder.command(&["render", "--load-state", "../states/s.json", "-o", "b.png"]);
    let output = elsewhere.current_dir(folder.0.join("other")).output().unwrap();
    assert_eq!(code(&output), 0, "{}", errors(&output));
    assert_eq!(folder.read("a.png"), folder.read("other/b.png"));
    // Paths of the command line begin where it runs, and standard output is in no folder.
    let output = render(
        &folder,
        &["models/a.obj", "--load-state", "states/s.json", "-o", "c.png", "--save-state", "-"],
    );
    let state: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(state["models"], serde_json::json!(["models/a.obj"]));
    for option in ["--load-state", "--config"] {
        let output = render(&folder, &["builtin:cubs", "-o", "x.png", option, "none.json"]);
        let told = errors(&output);
        assert_eq!(code(&output), 3, "{told}");
        assert!(
            told.contains("none.json: ")
                && told.contains("--save-state")
                && !told.contains("builtin:"),
            "{told}"
        );
    }
}

#[test]
fn comparing_pictures() {
    let folder = Folder::new("compare");
    assert_eq!(code(&render(&folder, &["builtin:cubs", "-o", "a.png"])), 0);
    assert_eq!(
        code(&render(
            &folder,
            &["builtin:cubs", "-o", "b.png", "--shading", "flat", "--view", "top"]
        )),
        0
    );
    assert_eq!(code(&folder.run(&["compare", "a.png", "a.png"])), 0);
    assert_eq!(code(&folder.run(&["compare", "a.png", "b.png", "--diff", "d.png"])), 6);
    assert!(folder.has("d.png"));
    assert_eq!(code(&folder.run(&["compare", "a.png", "b.png", "--threshold", "1"])), 0);

    // Every format that is written can be compared; PPM, like PNG, loses nothing.
    assert_eq!(code(&render(&folder, &["builtin:cubs", "-o", "a.ppm"])), 0);
    assert_eq!(code(&render(&folder, &["builtin:cubs", "-o", "a.jpg"])), 0);
    assert_eq!(code(&folder.run(&["compare", "a.ppm", "a.png"])), 0);
    assert_eq!(code(&folder.run(&["compare", "a.ppm", "a.jpg"])), 6);
    folder.file("a.ktx2", b"\xabKTX 20");
    let output = folder.run(&["compare", "a.ktx2", "a.png"]);
    assert_eq!(code(&output), 4);
    assert!(
        errors(&output)
            .contains("KTX is not read; PNG, JPEG, TGA, BMP, GIF, WebP, TIFF, DDS and PPM are"),
        "{}",
        errors(&output)
    );

    // A reference that holds leaves nothing written.
    assert_eq!(code(&render(&folder, &["builtin:cubs", "-o", "c.png", "--reference", "a.png"])), 0);
    assert!(!folder.has("c.png"));
    assert_eq!(code(&render(&folder, &["builtin:cubs", "-o", "c.png", "--reference", "b.png"])), 6);
    assert!(folder.has("c.png"));
}

#[test]
fn info_tells_warnings_once_or_not_at_all() {
    let folder = Folder::new("info");
    folder.file("odd.obj", format!("{TRIANGLE}strange 1\n"));
    let told = |arguments: &[&str]| {
        let output = folder.run(&[&["info", "odd.obj"], arguments].concat());
        let both = String::from_utf8_lossy(&output.stdout).into_owned() + &errors(&output);
        both.matches("unknown statement `strange`").count()
    };
    assert_eq!([told(&[]), told(&["--json"]), told(&["-q"])], [1, 1, 0]);
}

#[test]
fn the_stages_can_be_dumped() {
    let folder = Folder::new("dump");
    assert_eq!(code(&render(&folder, &["builtin:cubs", "--dump", "stages"])), 0);
    for file in [
        "1-scene.json",
        "2-world.json",
        "3-cull.json",
        "4-lights.json",
        "5-view.json",
        "9-framebuffer.png",
    ] {
        assert!(folder.has(&format!("stages/{file}")), "{file}");
    }
    // Those of the turntable's first frame that is made.
    let frame =
        ["builtin:scene0", "--turntable", "6", "--frames", "2-2", "--camera-azimuth-angle", "20"];
    let output =
        render(&folder, &[&frame[..], &["-o", "f-{frame}.png", "--dump", "turn"]].concat());
    assert_eq!(code(&output), 0, "{}", errors(&output));
    assert_eq!(folder.read("turn/9-framebuffer.png"), folder.read("f-2.png"));
}

#[test]
fn transparency_that_cannot_be_shown_is_refused_with_a_hint() {
    let folder = Folder::new("transparency");
    for (arguments, what, hint) in [
        (
            &["--transparency-order", "back-to-front"][..],
            "`z-buffer` does not",
            "--visibility bsp or painter",
        ),
        (
            &["--transparency-order", "sorted", "--global", "ray-trace"],
            "`sorted`",
            "leave out --transparency-order",
        ),
        (
            &["--material", "glass.transmission=translucent", "--transparency-order", "two-buffer"],
            "`glass` is translucent",
            "glass.transmission=transparent",
        ),
        (&["--material", "glass.kt=1.5"], "a number from 0 to 1 is required", "kt: 1 - opacity"),
        (
            &["--material", "glass.opacity=-1"],
            "a number from 0 to 1 is required",
            "opacity: 1 opaque",
        ),
        (
            &["--material", "glass.ior=0"],
            "a number above 0 is required",
            "ior: index of refraction",
        ),
        (
            &["--material", "glass.filter=1,2,1"],
            "from 0 to 1",
            "filter: colour of light that passes",
        ),
        (&["--scatter-samples", "0"], "1 to 4096", ""),
        (
            &["--kay-exponent", "2"],
            "it needs Kay's model of transparency",
            "add --transparency kay",
        ),
        (&["--transparency", "kay", "--kay-exponent", "0"], "above 0", ""),
        (
            &["--material", "glass.kt-min=2"],
            "a number from 0 to 1 is required",
            "kt-min: what passes",
        ),
        (&["--depth-cue=near=2"], "no key `near`", "back-scale"),
        (&["--depth-cue=front=2,back=1"], "farther away", ""),
        (&["--depth-cue", "--no-background"], "colour to fade into", ""),
        (&["--normals", "none", "--crease-angle", "30"], "no normals are made", ""),
        (&["--crease-angle", "200"], "0 to 180", ""),
    ] {
        let all = [&["render", "builtin:lens", "-o", "a.png"], &SMALL[..], arguments].concat();
        let output = folder.run(&all);
        let told = errors(&output);
        assert_eq!(code(&output), 2, "{arguments:?}: {told}");
        assert!(told.contains(what) && told.contains(hint), "{arguments:?}: {told}");
        assert!(!folder.has("a.png"));
    }
    let translucent = ["render", "builtin:lens", "--material", "glass.transmission=translucent"];
    let lists = [
        "--visibility",
        "bsp",
        "--transparency-order",
        "back-to-front",
        "--scatter-samples",
        "8",
        "-o",
        "b.png",
    ];
    let output = folder.run(&[&translucent[..], &SMALL, &lists].concat());
    assert_eq!(code(&output), 0, "{}", errors(&output));
    let output = folder.run(
        &[
            &["render", "builtin:lens", "--dump", "d", "--transparency-order", "multi-pass"],
            &SMALL[..],
        ]
        .concat(),
    );
    assert_eq!(code(&output), 0, "{}", errors(&output));
    // A ball has two layers.
    assert!(folder.has("d/9-pass-00.png") && folder.has("d/9-pass-02.png"));
    assert_eq!(folder.read("d/9-pass-02.png"), folder.read("d/9-framebuffer.png"));
}

#[test]
fn textures_outside_the_folder_need_permission() {
    let folder = Folder::new("external");
    std::fs::create_dir_all(folder.0.join("in")).unwrap();
    folder.file("secret.mtl", "newmtl m\nKd 1 0 0\n");
    std::fs::write(
        folder.0.join("in/a.obj"),
        format!("mtllib ../secret.mtl\nusemtl m\n{TRIANGLE}"),
    )
    .unwrap();
    let refused = render(&folder, &["in/a.obj", "-o", "a.png"]);
    assert_eq!(code(&refused), 0);
    assert!(errors(&refused).contains("--allow-external"), "{}", errors(&refused));
    let allowed = render(&folder, &["in/a.obj", "-o", "b.png", "--allow-external"]);
    assert!(!errors(&allowed).contains("--allow-external"));
    assert_ne!(folder.read("a.png"), folder.read("b.png"));
}
