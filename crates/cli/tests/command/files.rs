//! Animations, lights and limits of model files, and the numbers of built-in scenes.

use super::*;

/// A file of the readers' fixtures.
fn fixture(name: &str) -> String {
    format!("{}/../io/tests/fixtures/{name}", env!("CARGO_MANIFEST_DIR"))
}

/// `vitral info` of a model as JSON.
fn info(folder: &Folder, model: &str) -> serde_json::Value {
    json(&folder.run(&["info", model, "--json"]))["models"][0].clone()
}

#[test]
fn animations_are_listed_and_shown() {
    let (folder, model) = (Folder::new("animation"), fixture("anim.gltf"));
    let listed = info(&folder, &model)["animations"].clone();
    assert_eq!(listed, serde_json::json!([{"name": "animation 0", "duration": 1.0}]));
    let text = folder.run(&["info", &model]);
    assert!(String::from_utf8_lossy(&text.stdout).contains("animation 0: `animation 0`, 1 s"));

    // At rest the node has no extent; the animation gives it some.
    let rest = render(&folder, &[&model, "-o", "rest.png"]);
    assert!(errors(&rest).contains("nothing has any extent at rest"), "{}", errors(&rest));
    let moments =
        [&["--animation-time", "1"][..], &["--animation", "0", "--animation-time", "0.5"]];
    for arguments in moments {
        let shown =
            render(&folder, &[&[&model, "-o", "shown.png", "--no-background"], arguments].concat());
        assert_eq!((code(&shown), errors(&shown)), (0, String::new()), "{arguments:?}");
    }

    // The choice is part of the state.
    let saved = ["--animation", "0", "--animation-time", "0.25", "--save-state", "s.json"];
    assert_eq!(code(&render(&folder, &[&[&model, "-o", "a.png"][..], &saved].concat())), 0);
    assert_eq!(code(&render(&folder, &["--load-state", "s.json", "-o", "b.png"])), 0);
    assert_eq!(folder.read("a.png"), folder.read("b.png"));
}

#[test]
fn animations_that_are_not_there_are_told() {
    let (folder, model) = (Folder::new("no-animation"), fixture("anim.gltf"));
    folder.file("a.obj", TRIANGLE);
    for (arguments, said) in [
        (&[model.as_str(), "--animation", "run"][..], "hint: 0 `animation 0`"),
        (&["a.obj", "--animation", "0"], "hint: glTF files have animations"),
        (&["builtin:cubs", "--animation-time", "1"], "hint: glTF files have animations"),
        (&["a.obj", "--animation-time", "-1"], "a number of at least 0 is required"),
    ] {
        let output = render(&folder, &[arguments, &["-o", "x.png"]].concat());
        assert!(
            code(&output) == 2 && errors(&output).contains(said),
            "{arguments:?}: {}",
            errors(&output)
        );
    }
}

#[test]
fn a_dark_file_gets_a_light_unless_it_is_decided_otherwise() {
    let (folder, model) = (Folder::new("dark"), fixture("sun-below.gltf"));
    let added = "a dim light from the viewer is added";
    let told = |arguments: &[&str]| {
        errors(&render(&folder, &[&[&model, "-o", "x.png"], arguments].concat()))
    };
    assert!(told(&[]).contains(added));
    for arguments in [&["--fill-light", "none"][..], &["--light", "Directional:Direction=0,0,-1"]] {
        assert!(!told(arguments).contains(added), "{arguments:?}");
    }
    let both =
        render(&folder, &[&model, "-o", "x.png", "--fill-light", "auto", "--light", "ambient"]);
    assert_eq!(code(&both), 2);
}

#[test]
fn built_in_scenes_take_numbers() {
    let folder = Folder::new("numbers");
    assert_eq!(info(&folder, "builtin:sphere?slices=8&stacks=4")["faces"], 32);
    let refused = render(&folder, &["builtin:sphere?sides=8", "-o", "x.png"]);
    assert_eq!(code(&refused), 2);
    assert!(
        errors(&refused).contains("hint: builtin:sphere takes slices=96"),
        "{}",
        errors(&refused)
    );
    let misspelt = render(&folder, &["builtin:spere?slices=8", "-o", "x.png"]);
    assert!(errors(&misspelt).contains("did you mean builtin:sphere?"), "{}", errors(&misspelt));
    let listed = folder.run(&["formats"]);
    let text = String::from_utf8_lossy(&listed.stdout);
    assert!(text.contains("builtin:teapot?divisions=N: divisions=12"), "{text}");
    let formats = json(&folder.run(&["formats", "--json"]));
    let sphere = formats["builtin"]
        .as_array()
        .unwrap()
        .iter()
        .find(|row| row["name"] == "builtin:sphere")
        .unwrap();
    assert_eq!(
        (&sphere["parameters"][1]["name"], &sphere["parameters"][1]["most"]),
        (&"stacks".into(), &4096.into())
    );
}

#[test]
fn a_model_that_needs_too_much_memory_does_not_end_the_others() {
    let folder = Folder::new("too-large");
    folder.file("a.obj", TRIANGLE);
    // 30 MB of triangles, of 50 bytes each: the file alone would fit.
    let mut large = vec![0u8; 84 + 50 * 600_000];
    large[80..84].copy_from_slice(&600_000u32.to_le_bytes());
    folder.file("large.stl", large);
    for (verb, end) in [("render", "png"), ("draw", "svg")] {
        let out = format!("{{model}}.{end}");
        let output = folder.run(&[verb, "large.stl", "a.obj", "-o", &out, "--max-memory", "40M"]);
        let told = errors(&output);
        assert_eq!(code(&output), 7, "{verb}: {told}");
        assert!(
            told.contains("vitral: large.stl: loading needs ")
                && told.contains("1 of 2 models failed"),
            "{told}"
        );
        assert!(folder.has(&format!("a.{end}")) && !folder.has(&format!("large.{end}")));
    }
}

#[test]
fn edges_have_a_width_a_colour_and_classes() {
    let folder = Folder::new("edges");
    let styled = [
        "--edges",
        "--line-width",
        "3",
        "--edge-color",
        "red",
        "--edge-classes",
        "Contour,boundary",
    ];
    let output = render(&folder, &[&["builtin:cubs", "-o", "x.png"], &styled[..]].concat());
    assert_eq!((code(&output), errors(&output)), (0, String::new()));
    for (arguments, said) in [
        (&["--edges", "--line-width", "0"][..], "a number from 0.1 to 64 is required"),
        (&["--edges", "--edge-classes", "contours"], "did you mean `contour`?"),
    ] {
        let refused = render(&folder, &[&["builtin:cubs", "-o", "x.png"], arguments].concat());
        assert!(code(&refused) == 2 && errors(&refused).contains(said), "{}", errors(&refused));
    }
    let idle = render(
        &folder,
        &["builtin:cubs", "-o", "x.png", "--edge-classes", "crease", "--line-width", "2"],
    );
    assert!(
        errors(&idle).contains("--edge-classes") && errors(&idle).contains("--line-width"),
        "{}",
        errors(&idle)
    );
}

#[test]
fn an_animation_gives_frames() {
    let (folder, model) = (Folder::new("frames"), fixture("anim.gltf"));
    let output = render(
        &folder,
        &[
            &model,
            "--animation-frames",
            "3",
            "-o",
            "f{frame}.png",
            "--camera-position",
            "1,1,8",
            "--camera-focal-point",
            "1,1,0",
        ],
    );
    assert_eq!((code(&output), errors(&output)), (0, String::new()));

    // Each is the picture of its moment, by the same camera.
    for (frame, seconds) in [(0, "0"), (1, "0.3333333333333333"), (2, "0.6666666666666666")] {
        let alone = [
            "--animation-time",
            seconds,
            "--camera-position",
            "1,1,8",
            "--camera-focal-point",
            "1,1,0",
            "-o",
            "alone.png",
        ];
        assert_eq!(code(&render(&folder, &[&[model.as_str()], &alone[..]].concat())), 0);
        assert!(folder.read(&format!("f{frame}.png")) == folder.read("alone.png"), "{frame}");
    }
    assert!(folder.read("f1.png") != folder.read("f2.png"));
    assert_eq!(code(&render(&folder, &[&model, "--animation-frames", "4", "-o", "a.gif"])), 0);
    assert!(folder.read("a.gif").starts_with(b"GIF"));
    for arguments in [&["-o", "one.png"][..], &["-o", "{frame}.png", "--turntable", "2"]] {
        assert_eq!(
            code(&render(
                &folder,
                &[&[model.as_str(), "--animation-frames", "2"], arguments].concat()
            )),
            2
        );
    }
}
