//! The command as users meet it: a process with files, standard streams and an exit code.

mod batch;
mod choices;
mod course;
mod drawing;
mod files;
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
fn exit_codes() {
    let folder = Folder::new("codes");
    folder.file("a.obj", TRIANGLE);
    folder.file("bad.obj", "v 0 0 0\nf 1 2 3\n");
    folder.file("empty.stl", "");
    folder.file("a.dae", "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://x\"></COLLADA>");
    let cases: [(&[&str], i32, &str); 33] = [
        (&["a.obj", "-o", "x.png"], 0, ""),
        (&["a.obj", "-o", "x.png", "--no-background"], 0, ""),
        (
            &["a.obj", "-o", "x.jpg", "--no-background"],
            2,
            "--no-background: JPEG files cannot be transparent",
        ),
        (&["a.obj", "-o", "x.png", "--no-such-option"], 2, "--no-such-option"),
        (
            &["a.obj", "-o", "x.png", "--panels"],
            2,
            "`none` has no figure of panels: choose map, object-precision",
        ),
        (&["a.obj", "-o", "x.png", "--shadows", "map", "--panels"], 0, ""),
        (
            &["a.obj", "-o", "x.npy", "--channel", "depth", "--shadows", "map", "--panels"],
            2,
            "not the channel depth",
        ),
        (&["a.obj", "-o", "x.png", "--max-depth", "3"], 2, "--max-depth: no rays are traced"),
        (
            &["a.obj", "-o", "x.png", "--global", "ray-trace", "--patch-size", "1"],
            2,
            "radiosity is not computed",
        ),
        (
            &["a.obj", "-o", "x.png", "--global", "radiosity", "--load-radiosity", "a.obj"],
            3,
            "no stored solution",
        ),
        (
            &["a.obj", "--dump", "d", "--global", "radiosity", "--save-radiosity", "r"],
            2,
            "no colour picture is made",
        ),
        (&["a.obj", "-o", "x.png", "--global", "ray-trace", "--max-depth", "3"], 0, ""),
        (&["a.obj", "-o", "x.png", "--shadows", "umbra"], 2, "invalid value 'umbra'"),
        (
            &["a.obj", "--shadows", "ray", "--export-shadow-polygons", "s.obj"],
            2,
            "choose volume, scan-line, object-precision",
        ),
        (
            &["a.obj", "--shadows", "volume", "--export-shadow-polygons", "s.stl"],
            2,
            "only .obj files are written",
        ),
        (
            &["a.obj", "-o", "x.png", "--shadows", "ray", "--volume-counting", "z-pass"],
            2,
            "is `ray`: choose volume",
        ),
        (
            &["a.obj", "-o", "x.png", "--terminator", "exact"],
            2,
            "--terminator: no shadows are computed",
        ),
        (
            &["a.obj", "-o", "x.png", "--camera-clip", "3,2"],
            2,
            "two distances are required, the nearer first",
        ),
        (
            &["a.obj", "-o", "x.png", "--shadows", "ray", "--shadow-map-size", "512"],
            2,
            "no shadow maps are drawn",
        ),
        (&["a.obj", "-o", "x.png", "--shadow-cascades", "4"], 2, "add --shadows map"),
        (
            &["a.obj", "-o", "x.png", "--shadows", "map", "--shadow-map-size", "9000"],
            2,
            "16 to 8192",
        ),
        (
            &[
                "a.obj",
                "-o",
                "x.png",
                "--shadows",
                "map",
                "--shadow-map-size",
                "64",
                "--shadow-cascades",
                "4",
            ],
            0,
            "",
        ),
        (&["a.obj", "-o", "x.png", "--visibility", "ray-cast", "--acceleration", "octree"], 0, ""),
        (
            &["a.obj", "-o", "x.png", "--acceleration", "grid"],
            2,
            "`z-buffer` casts no rays, nor does anything else: choose the visibility ray-cast",
        ),
        (&["a.obj", "-o", "x.png", "--light", "point:position=0,0,1,shadow=maybe"], 2, "shadow"),
        (&["missing.obj", "-o", "x.png"], 3, "missing.obj: "),
        (&["bad.obj", "-o", "x.png"], 3, "bad.obj: line 2: "),
        (&["empty.stl", "-o", "x.png"], 3, "empty file"),
        (&["builtin:nothing", "-o", "x.png"], 3, "`vitral formats` lists the built-in scenes"),
        (&["a.dae", "-o", "x.png"], 4, "readable are glTF"),
        (&["a.obj", "-o", "x.bmp"], 4, ".bmp"),
        (&["a.obj", "-o", "no/such/folder/x.png"], 5, "no/such/folder/x.png"),
        (&["a.obj", "-o", "x.png", "--max-memory", "1K"], 7, "limit"),
    ];
    for (arguments, expected, said) in cases {
        let output = render(&folder, arguments);
        assert_eq!(code(&output), expected, "{arguments:?}: {}", errors(&output));
        assert!(errors(&output).contains(said), "{arguments:?}: {}", errors(&output));
        let first = errors(&output);
        assert!(first.is_empty() || first.starts_with("vitral: "), "{first}");
    }
    assert_eq!(code(&folder.run(&["render", "a.obj", "-o", "x.png", "--resolution", "0x4"])), 2);
    assert_eq!(
        code(&folder.run(&["render", "a.obj", "-o", "x.png", "--resolution", "99999x4"])),
        7
    );
    assert_eq!(code(&folder.run(&["batch"])), 2);
    assert_eq!(code(&folder.run(&["batch", "a.obj", "--dry-run"])), 1);
    if cfg!(not(feature = "lab")) {
        let output = folder.run(&["lab", "a.obj"]);
        assert!(
            code(&output) == 4 && errors(&output).contains("cargo xtask lab"),
            "{}",
            errors(&output)
        );
    }
    assert_eq!(code(&folder.run(&[])), 2);
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
fn mistakes_in_drawings_are_told() {
    let folder = Folder::new("drawing-mistakes");
    folder.file("a.obj", TRIANGLE);
    for (arguments, expected, said) in [
        (&["-o", "x.png"][..], 4, "drawings are not written in this format"),
        (&["-o", "x.svg", "--explode", "-2"], 2, "--explode"),
        (&["-o", "x.svg", "--lines", "section"], 2, "add --section-plane"),
        (&["-o", "x.svg", "--shadows"], 2, "give --style filled"),
        (
            &["-o", "x.svg", "--style", "filled", "--color-by", "part", "--shades", "4"],
            2,
            "give --color-by shading",
        ),
        (&["-o", "x.svg", "--style", "filled", "--flatten"], 2, "--transparency"),
        (
            &["-o", "x.svg", "--style", "filled", "--shadows", "--lighting", "off"],
            2,
            "the lights are off",
        ),
        (&["-o", "x.svg", "--algorithm", "bsp", "--seams", "none"], 2, "choose --algorithm exact"),
        (&["-o", "x.svg", "--lines", "edges"], 2, "contour"),
        (&["-o", "x.svg", "--hidden-max-layers", "2"], 2, "--hidden dashed"),
        (&["-o", "x.svg", "--style", "filled", "--lines", "all"], 2, "filled-lines"),
        (&["-o", "x.svg", "--page", "A4", "--margin", "200"], 2, "no room is left"),
        (&["-o", "x.svg", "--landscape"], 2, "--page"),
        (&["-o", "x.svg", "--max-memory", "300"], 7, "memory"),
        (&["-o", "nowhere/x.svg"], 5, "nowhere"),
        (&[], 2, "--output"),
    ] {
        let output = folder.run(&[&["draw", "a.obj"], arguments].concat());
        assert_eq!(code(&output), expected, "{arguments:?}: {}", errors(&output));
        assert!(errors(&output).contains(said), "{arguments:?}: {}", errors(&output));
    }
    assert!(!folder.has("x.svg"));
}

#[test]
fn mistakes_in_outputs_are_told_before_the_work() {
    let folder = Folder::new("early");
    std::fs::create_dir_all(folder.0.join("folder")).unwrap();
    folder.file("text.png", "no picture");
    let volumes = ["--shadows", "volume", "--export-shadow-polygons", "no/s.obj"];
    // The model is missing, too: what is told is what was looked at first.
    for (arguments, expected, said) in [
        (&["-o", "x{fr}.png"][..], 2, "the word in braces is not known"),
        (&["-o", "x.npy"], 4, "the channel color cannot be written as NPY"),
        (&["-o", "x.jpg", "--channel", "depth"], 4, "the channel depth cannot be written as JPEG"),
        (&["-o", "no/x.png"], 5, "there is no folder `no`"),
        (&["-o", "{model}/x.png"], 5, "there is no folder `missing`"),
        (&["-o", "folder/{frame}/x.png", "--turntable", "3"], 5, "there is no folder `folder/0`"),
        (&["-o", "text.png/x.png"], 5, "text.png/x.png: "),
        (&["-o", "x.png", "--stats-file", "no/s.json"], 5, "there is no folder `no`"),
        (&["-o", "x.png", "--stats-file", "folder"], 5, "is a directory"),
        (
            &["-o", "x.png", "--global", "radiosity", "--save-radiosity", "no/r"],
            5,
            "there is no folder `no`",
        ),
        (&volumes, 5, "there is no folder `no`"),
        (&["-o", "x.png", "--reference", "no.png"], 3, "no.png: "),
        (&["-o", "x.png", "--reference", "text.png"], 4, "text.png: this image format is not read"),
    ] {
        let output = render(&folder, &[&["missing.obj"], arguments].concat());
        assert_eq!(code(&output), expected, "{arguments:?}: {}", errors(&output));
        assert!(errors(&output).contains(said), "{arguments:?}: {}", errors(&output));
    }
}

#[test]
fn mistakes_are_told_in_words_of_our_own() {
    let folder = Folder::new("mistakes");
    folder.file("a.obj", TRIANGLE);
    let required = |range: &str| format!("a whole number from {range} is required");
    for (arguments, said) in [
        (&["--samples", "17"][..], "a whole number from 1 to 16, or 32, is required".to_owned()),
        (&["--threads", "-1"], required("0 to 1024")),
        (&["--camera-index", "-1"], required("0 to 4294967295")),
        (&["--resolution", "-5x5"], "`-5x5` is not a size".to_owned()),
        (&["--size", "5x5"], "hint: --resolution".to_owned()),
        (&["--light-samples", "4"], "hint: add --shadows ray".to_owned()),
        (
            &["--camera-position", "1,1,1", "--camera-focal-point", "1,1,1"],
            "stands at its focal point".to_owned(),
        ),
    ] {
        let output = folder.run(&[&["a.obj", "-o", "x.png"], arguments].concat());
        assert_eq!(code(&output), 2, "{arguments:?}: {}", errors(&output));
        assert!(errors(&output).contains(&said), "{arguments:?}: {}", errors(&output));
    }
    let told = |arguments: &[&str]| errors(&folder.run(arguments));
    let verb = told(&["inof", "a.obj"]);
    assert!(
        verb.contains("inof: there is no such verb, and no file of that name\nhint: did you mean the verb `info`?"),
        "{verb}"
    );
    assert!(told(&["a.obj", "-o", "a"]).contains("a: the name has no extension"));
    assert!(told(&["a.obj", "-o", "no/a.png"]).contains("there is no folder `no`"));
    assert!(
        told(&["a.obj", "-o", "x.jpg", "--no-background"])
            .contains("hint: write a .png, or give --background-color")
    );
    let away =
        ["a.obj", "-o", "x.png", "--camera-position", "0,0,5", "--camera-focal-point", "0,0,9"];
    assert!(told(&away).contains("warning: nothing is in view"));
    assert_eq!(told(&away[..3]), "");
    let output =
        folder.command(&["a.obj", "-o", "x.png"]).env("VITRAL_THREADS", "two").output().unwrap();
    assert!(
        code(&output) == 2 && errors(&output).contains("VITRAL_THREADS=two"),
        "{}",
        errors(&output)
    );
}

#[test]
fn the_help_goes_into_pipes() {
    let folder = Folder::new("help");
    assert!(String::from_utf8(folder.run(&["help"]).stdout).unwrap().contains("compare"));
    assert_eq!(folder.run(&["help", "render"]).stdout, folder.run(&["render", "--help"]).stdout);
    let output = folder.run(&["render", "--help", "all"]);
    let help = String::from_utf8(output.stdout).unwrap();
    assert!(help.contains("--visibility") && help.contains("z-buffer"));
    let words = help.split_whitespace().collect::<Vec<_>>().join(" ");
    for part in [
        "gl,constant,linear,quadratic",
        "inner (half angle",
        "occlusion-strength, normal-scale",
        "* for all",
    ] {
        assert!(words.contains(part), "{part}");
    }
    assert!(!help.contains('\u{1b}'), "no colours in a pipe");
}

#[test]
fn each_verb_has_help_in_two_sizes_and_by_groups() {
    let folder = Folder::new("groups");
    folder.file("a.obj", TRIANGLE);
    let help = |arguments: &[&str]| {
        let output = folder.run(arguments);
        assert_eq!((code(&output), errors(&output).as_str()), (0, ""), "{arguments:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    let listed = help(&["--help"]);
    let verbs = listed
        .lines()
        .skip_while(|line| *line != "Commands:")
        .skip(1)
        .take_while(|line| !line.is_empty());
    let starts_verb = |line: &&str| line.starts_with("  ") && !line.starts_with("   ");
    let verbs: Vec<&str> =
        verbs.filter(starts_verb).filter_map(|line| line.split_whitespace().next()).collect();
    assert!(verbs.contains(&"render") && verbs.contains(&"thumbnail"), "{verbs:?}");
    for verb in verbs {
        // A summary of at most two screens, and a form of at most that length.
        let (long, short) = (help(&[verb, "--help"]), help(&[verb, "-h"]));
        assert!(long.lines().count() <= 100 && short.len() <= long.len(), "{verb}: {long}");
        assert!(
            long.lines().chain(short.lines()).all(|line| line.chars().count() <= 100),
            "{verb}: {long}"
        );
        assert!(
            help(&[verb, "--help", "all"]).len() >= long.len() && help(&["help", verb]) == long
        );

        // A group, in both forms; or a line that says there is none.
        let output = folder.run(&[verb, "--help", "camera"]);
        assert_eq!(folder.run(&[verb, "--help=camera"]).stdout, output.stdout);
        if ["render", "draw", "bench"].contains(&verb) {
            let text = String::from_utf8(output.stdout).unwrap();
            assert!(
                text.contains("--camera-view-angle") && !text.contains("--threads"),
                "{verb}: {text}"
            );
        } else {
            assert!(
                code(&output) == 2 && errors(&output).contains("have no groups"),
                "{}",
                errors(&output)
            );
        }
        let output = folder.run(&[verb, "--help", "alg"]);
        assert!(
            code(&output) == 2 && errors(&output).contains("hint: "),
            "{verb}: {}",
            errors(&output)
        );
    }
    let told = errors(&folder.run(&["render", "--help", "alg"]));
    assert!(told.contains("hint: did you mean `vitral render --help algorithms`?"), "{told}");
    let algorithms = help(&["render", "--help", "algorithms"]);
    assert!(
        algorithms.contains("--visibility") && !algorithms.contains("--camera"),
        "{algorithms}"
    );
    assert_eq!(help(&["a.obj", "--help=algorithms"]), algorithms);
    assert_eq!(help(&["render", "a.obj", "--help"]), help(&["render", "--help"]));
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
fn lists_and_pages() {
    let folder = Folder::new("lists");
    let text = |arguments: &[&str]| String::from_utf8(folder.run(arguments).stdout).unwrap();
    assert!(text(&["algorithms"]).contains("z-buffer"));
    assert!(text(&["formats"]).contains(".gltf"));
    let json: serde_json::Value = serde_json::from_str(&text(&["algorithms", "--json"])).unwrap();
    assert_eq!(json["visibility"][0]["name"], "z-buffer");
    let json: serde_json::Value = serde_json::from_str(&text(&["formats", "--json"])).unwrap();
    assert!(json["formats"].as_array().unwrap().len() >= 7);
    // Built-in scenes are told wherever somebody may look for them.
    let (formats, page) = (text(&["formats"]), text(&["man"]).replace("\\-", "-"));
    let helps = ["render", "info", "bench"].map(|verb| {
        text(&[verb, "--help", "all"]).split_whitespace().collect::<Vec<_>>().join(" ")
    });
    for (i, (name, about)) in vitral::builtin_names().iter().enumerate() {
        let line =
            formats.lines().find(|line| line.trim_start().starts_with(&format!("builtin:{name} ")));
        assert!(line.is_some_and(|line| line.ends_with(about)), "{name}");
        assert_eq!(json["builtin"][i]["name"], format!("builtin:{name}"));
        assert_eq!(json["builtin"][i]["description"], *about);
        assert!(helps.iter().all(|help| help.contains(name)) && page.contains(name), "{name}");
    }
    assert!(text(&["completions", "bash"]).contains("_vitral"));
    assert!(text(&["man"]).contains(".TH vitral"));
    let info: serde_json::Value =
        serde_json::from_str(&text(&["info", "builtin:cubs", "--json"])).unwrap();
    assert_eq!(info["models"][0]["file"], "builtin:cubs");
    assert!(text(&["info", "builtin:teapot"]).contains("triangles"));
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
