//! Exit codes, and what the command says of mistakes.

use super::*;

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
    // The model is missing, too: the message is about the first mistake found.
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
