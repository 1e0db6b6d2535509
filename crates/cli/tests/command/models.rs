//! Several models: one scene or a picture each, names that are not Unicode.

use super::*;

/// `vitral ARGUMENTS --resolution 64x48` without a verb.
fn bare(folder: &Folder, arguments: &[&str]) -> Output {
    folder.run(&[arguments, &SMALL].concat())
}

#[test]
fn each_model_gives_a_picture_where_the_output_names_it() {
    let folder = Folder::new("apart");
    folder.file("a.obj", TRIANGLE);
    folder.file("b.obj", TRIANGLE.replace("0 1 0", "0 3 0"));
    let output = bare(
        &folder,
        &["a.obj", "b.obj", "builtin:cubs", "-o", "{model}.png", "--progress", "always"],
    );
    assert_eq!(code(&output), 0, "{}", errors(&output));
    assert!(errors(&output).contains("picture 3 of 3"), "{}", errors(&output));

    // Each is the picture that the model gives alone.
    for (model, file) in [("a.obj", "a.png"), ("b.obj", "b.png"), ("builtin:cubs", "cubs.png")] {
        assert_eq!(code(&bare(&folder, &[model, "-o", "alone.png"])), 0);
        assert_eq!(folder.read(file), folder.read("alone.png"), "{model}");
    }

    // One scene, as without {model}.
    assert_eq!(
        code(&bare(&folder, &["a.obj", "b.obj", "-o", "both-{model}.png", "--together"])),
        0
    );
    assert_eq!(code(&bare(&folder, &["a.obj", "b.obj", "-o", "scene.png"])), 0);
    assert_eq!(folder.read("both-a.png"), folder.read("scene.png"));
    assert!(!folder.has("both-b.png"));

    // Frames of each.
    let turned = ["a.obj", "b.obj", "-o", "{model}-{frame}.png", "--turntable", "2", "--json"];
    let told = json(&bare(&folder, &turned));
    assert_eq!(told["outputs"], serde_json::json!(["a-0.png", "a-1.png", "b-0.png", "b-1.png"]));
    assert_eq!(told["models"][1]["outputs"], serde_json::json!(["b-0.png", "b-1.png"]));
}

#[test]
fn a_bad_model_does_not_end_the_others() {
    let folder = Folder::new("bad-model");
    folder.file("a.obj", TRIANGLE);
    folder.file("bad.obj", "v 0 0 0\nf 1 2 3\n");
    folder.file("odd.dae", "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://x\"></COLLADA>");
    for (verb, end) in [("render", "png"), ("draw", "svg")] {
        let out = format!("{{model}}.{end}");
        let output = folder.run(&[verb, "bad.obj", "odd.dae", "a.obj", "missing.stl", "-o", &out]);
        let told = errors(&output);
        assert_eq!(code(&output), 3, "the first failure's: {told}");
        assert!(folder.has(&format!("a.{end}")) && !folder.has(&format!("bad.{end}")));
        for part in [
            "vitral: bad.obj: line 2: ",
            "vitral: odd.dae: ",
            "vitral: missing.stl: ",
            "3 of 4 models failed",
        ] {
            assert!(told.contains(part), "{part}: {told}");
        }
    }
    assert_eq!(code(&bare(&folder, &["odd.dae", "a.obj", "bad.obj", "-o", "{model}.png"])), 4);
    let output = bare(&folder, &["a.obj", "bad.obj", "-o", "{model}.png", "--json"]);
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(code(&output), 3);
    assert_eq!(
        (&told["models"][1]["exit-code"], &told["models"][1]["model"]),
        (&3.into(), &"bad.obj".into())
    );
    assert_eq!(told["outputs"], serde_json::json!(["a.png"]));

    // A limit that one of them reaches names it.
    let limited =
        bare(&folder, &["builtin:teapot", "a.obj", "-o", "{model}.png", "--time-limit", "1e-9"]);
    assert_eq!(code(&limited), 7);
    for name in ["builtin:teapot", "a.obj"] {
        let line =
            format!("vitral: {name}: the time limit of 0.000000001 s was reached during loading");
        assert!(errors(&limited).contains(&line), "{}", errors(&limited));
    }
}

#[test]
fn what_one_scene_gives_is_refused_for_several() {
    let folder = Folder::new("apart-refused");
    folder.file("a.obj", TRIANGLE);
    std::fs::create_dir_all(folder.0.join("other")).unwrap();
    folder.file("other/a.stl", "");
    let models = ["a.obj", "other/a.stl", "-o", "{model}.png"];
    let output = bare(&folder, &models);
    assert_eq!(code(&output), 2);
    assert!(
        errors(&output).contains("a.obj and other/a.stl would both be written to a.png"),
        "{}",
        errors(&output)
    );
    assert_eq!(code(&folder.run(&["a.obj", "other/a.stl", "-o", "{model}.svg"])), 2);

    let two = ["a.obj", "builtin:cubs", "-o", "{model}.png"];
    for (arguments, said) in [
        (&["--pixel", "1,1"][..], "--pixel: it works with one scene"),
        (&["--trace", "t"], "--trace: it works with one scene"),
        (&["--dump", "d"], "hint: add --together"),
        (&["--reference", "a.png"], "--reference"),
        (
            &["--channel", "color", "--channel", "depth", "-o", "d.npy"],
            "--output d.npy: every model would be written to this file",
        ),
    ] {
        let output = bare(&folder, &[&two, arguments].concat());
        assert_eq!(code(&output), 2, "{arguments:?}: {}", errors(&output));
        assert!(errors(&output).contains(said), "{arguments:?}: {}", errors(&output));
    }
}

#[test]
fn without_a_verb_the_extension_says_whether_to_draw() {
    let folder = Folder::new("no-verb");
    folder.file("a.obj", TRIANGLE);
    for (name, start) in [("a.svg", &b"<"[..]), ("a.pdf", b"%PDF"), ("a.png", b"\x89PNG")] {
        let output = folder.run(&["a.obj", "-o", name]);
        assert_eq!(code(&output), 0, "{name}: {}", errors(&output));
        assert!(folder.read(name).starts_with(start), "{name}");
    }
    assert_eq!(code(&folder.run(&["a.obj", "builtin:cubs", "--output={model}.dxf"])), 0);
    assert!(folder.has("a.dxf") && folder.has("cubs.dxf"));
}

#[cfg(target_os = "linux")]
#[test]
fn names_need_not_be_unicode() {
    use std::ffi::{OsStr, OsString};
    use std::os::unix::ffi::{OsStrExt, OsStringExt};
    let folder = Folder::new("not-unicode");
    let name = |bytes: &[u8]| OsString::from_vec(bytes.to_vec());
    std::fs::write(folder.0.join(name(b"T\xfcr.obj")), TRIANGLE).unwrap();
    std::fs::write(folder.0.join(name(b"T\xfb.obj")), TRIANGLE).unwrap();
    let run = |arguments: &[&OsStr]| folder.command(&[]).args(arguments).output().unwrap();
    let words = |bytes: &[&[u8]]| bytes.iter().map(|b| name(b)).collect::<Vec<_>>();
    for (arguments, made) in [
        (&[&b"T\xfcr.obj"[..], b"-o", b"{model}.png"][..], &b"T\xfcr.png"[..]),
        (&[b"render", b"T\xfcr.obj", b"-o", b"\xff.png"], b"\xff.png"),
        (&[b"T\xfcr.obj", b"T\xfb.obj", b"-o", b"{model}-\xe9.png"], b"T\xfb-\xe9.png"),
        (&[b"T\xfcr.obj", b"-o", b"{model}.svg"], b"T\xfcr.svg"),
        (&[b"T\xfcr.obj", b"-o", b"x.png", b"--stats-file", b"\xfe.json"], b"\xfe.json"),
        (&[b"T\xfcr.obj", b"--dump", b"d\xfc"], b"d\xfc"),
        (
            &[
                b"builtin:scene0",
                b"--shadows",
                b"volume",
                b"--export-shadow-polygons",
                b"s\xfc.obj",
            ],
            b"s\xfc.obj",
        ),
        (
            &[
                b"T\xfcr.obj",
                b"-o",
                b"y.png",
                b"--visibility",
                b"bsp",
                b"--structure",
                b"s\xfc.svg",
            ],
            b"s\xfc.svg",
        ),
        (&[b"compare", b"\xff.png", b"T\xfcr.png", b"--diff", b"d\xfc.png"], b"d\xfc.png"),
    ] {
        let typed = words(arguments);
        let output = run(&typed.iter().map(OsString::as_os_str).collect::<Vec<_>>());
        assert_eq!(code(&output), 0, "{typed:?}: {}", errors(&output));
        assert!(folder.0.join(name(made)).exists(), "{typed:?}");
    }

    // Told as given.
    let told = run(&[OsStr::new("info"), OsStr::from_bytes(b"T\xfcr.obj")]);
    assert!(told.stdout.starts_with(b"T\xfcr.obj\n"), "{told:?}");
    let bench = ["bench", "--frames", "1", "--resolution", "32x24", "--visibility", "z-buffer"]
        .map(OsStr::new);
    assert_eq!(code(&run(&[&bench[..], &[OsStr::from_bytes(b"T\xfcr.obj")]].concat())), 0);

    // JSON holds Unicode alone.
    let saved =
        run(&[OsStr::from_bytes(b"T\xfcr.obj"), OsStr::new("--save-state"), OsStr::new("s.json")]);
    assert_eq!(code(&saved), 2);
    assert!(errors(&saved).contains("is not Unicode"), "{}", errors(&saved));
}
