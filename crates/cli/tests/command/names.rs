//! Names that are misspelt: files, scenes, choices.

use super::*;

#[test]
fn similar_names_are_told() {
    let folder = Folder::new("similar");
    folder.file("teapot.obj", TRIANGLE);
    std::fs::create_dir_all(folder.0.join("parts")).unwrap();
    folder.file("parts/wheel.stl", "");
    for (arguments, expected, hint) in [
        (&["teapto.obj", "-o", "x.png"][..], 3, "hint: did you mean teapot.obj?"),
        (&["parts/weel.stl", "-o", "x.png"], 3, "hint: did you mean parts/wheel.stl?"),
        (&["part/wheel.stl", "-o", "x.png"], 3, "hint: there is no folder `part`"),
        (&["render", "sphere", "-o", "x.png"], 3, "hint: did you mean builtin:sphere?"),
        (&["sphere", "-o", "x.png"], 2, "hint: did you mean builtin:sphere?"),
        (&["Teapot", "-o", "x.png"], 2, "hint: did you mean teapot.obj or builtin:teapot?"),
        (
            &["builtin:teepot", "-o", "x.png"],
            3,
            "hint: did you mean builtin:teapot? `vitral formats`",
        ),
        (
            &["builtin:nothing", "-o", "x.png"],
            3,
            "hint: `vitral formats` lists the built-in scenes",
        ),
        (&["compare", "teapot.ob", "x.png"], 3, "hint: did you mean teapot.obj?"),
        (&["draw", "teapot.off", "-o", "x.svg"], 3, "hint: did you mean teapot.obj?"),
        (&["info", "nothing-like-it.obj"], 3, ""),
    ] {
        let output = folder.run(arguments);
        let told = errors(&output);
        assert_eq!(code(&output), expected, "{arguments:?}: {told}");
        assert!(
            told.contains(hint) && told.contains("hint:") != hint.is_empty(),
            "{arguments:?}: {told}"
        );
        assert!(!told.contains("defect-"), "scenes are not listed: {told}");
    }
    let listed = String::from_utf8(folder.run(&["formats"]).stdout).unwrap();
    assert!(listed.contains("builtin:teapot") && listed.contains("builtin:defect-normals"));
}

#[test]
fn choices_are_the_same_in_upper_and_lower_case() {
    let folder = Folder::new("case");
    let picture = |arguments: &[&str]| {
        let output = render(&folder, &[&["builtin:scene0", "-o", "a.png"], arguments].concat());
        assert_eq!(code(&output), 0, "{arguments:?}: {}", errors(&output));
        folder.read("a.png")
    };
    for (lower, upper) in [
        (&["--visibility", "bsp"][..], &["--visibility", "BSP"][..]),
        (&["--shadows", "map", "--view", "top"], &["--shadows", "Map", "--view", "TOP"]),
        (
            &["--illumination", "blinn-phong", "--cull", "none"],
            &["--illumination", "Blinn-Phong", "--cull", "None"],
        ),
        (&["--coherence", "none", "--up", "-z"], &["--coherence", "NONE", "--up", "-Z"]),
    ] {
        assert_eq!(picture(lower), picture(upper), "{upper:?}");
    }
    assert_eq!(
        code(&folder.run(&[
            "draw",
            "builtin:cubs",
            "-o",
            "a.svg",
            "--lines",
            "Contour",
            "--style",
            "Filled-Lines"
        ])),
        0
    );
    for (arguments, said) in [
        (&["--visibility", "warnok"][..], "a similar value exists: 'warnock'"),
        (&["--visibility", "Painters"], "a similar value exists: 'painter'"),
        (&["--cull", "frustrum"], "did you mean `frustum`?"),
        (&["--coherence", "edges"], "did you mean `edge`?"),
        (&["--pixel", "1,1", "--pixel-algorithms", "BSP,warnok"], "did you mean `warnock`?"),
    ] {
        let output = render(&folder, &[&["builtin:cubs", "-o", "a.png"], arguments].concat());
        assert_eq!(code(&output), 2, "{arguments:?}: {}", errors(&output));
        assert!(errors(&output).contains(said), "{arguments:?}: {}", errors(&output));
    }
    let drawn = folder.run(&["draw", "builtin:cubs", "-o", "a.svg", "--lines", "creese"]);
    assert!(errors(&drawn).contains("did you mean `crease`?"), "{}", errors(&drawn));
}
