//! Options of the view and of lights, and options without effect.

use super::{Folder, code, errors, json, render};

#[test]
fn figures_are_seen_from_their_own_camera_unless_the_view_is_chosen() {
    let folder = Folder::new("figures");
    let picture = |name: &str, options: &[&str]| {
        let output = render(&folder, &[&["builtin:cornell", "-o", name][..], options].concat());
        assert_eq!(code(&output), 0, "{}", errors(&output));
        folder.read(&name.replace("{frame}", "0"))
    };
    let own = picture("own.png", &[]);
    assert_eq!(own, picture("camera.png", &["--camera-index", "0"]));
    let framed = picture("framed.png", &["--view", "iso"]);
    assert_ne!(own, framed);
    assert_ne!(own, picture("zoomed.png", &["--camera-zoom-factor", "1.5"]));
    // A turntable goes round the whole scene.
    assert_ne!(own, picture("turn-{frame}.png", &["--turntable", "2"]));
}

#[test]
fn a_scene_file_with_one_camera_is_seen_from_it() {
    let folder = Folder::new("one-camera");
    let camera = r#"{"position": [0, 0, 9], "focal-point": [0, 0, 0], "view-up": [0, 1, 0],
        "projection": {"type": "perspective", "view-angle": 0.9}}"#;
    let scene = |cameras: &str| {
        format!(
            r#"{{"vitral-scene": 1, "meshes": [{{"builtin": "sphere"}}], "cameras": [{cameras}]}}"#
        )
    };
    folder.file("none.json", scene(""));
    folder.file("one.json", scene(camera));
    folder.file("two.json", scene(&format!("{camera}, {camera}")));
    let picture = |arguments: &[&str]| {
        let output = render(&folder, &[arguments, &["-o", "a.png"]].concat());
        assert!(
            code(&output) == 0 && errors(&output).is_empty(),
            "{arguments:?}: {}",
            errors(&output)
        );
        folder.read("a.png")
    };
    let own = picture(&["one.json"]);
    assert_eq!(own, picture(&["one.json", "--camera-index", "0"]));
    // The sphere has a camera of its own, which is not the file's.
    let framed = picture(&["none.json"]);
    assert_eq!(framed, picture(&["two.json"]));
    assert_eq!(framed, picture(&["one.json", "--view", "three-quarter"]));
    for option in [
        "--eye-rotation=0,0,0",
        "--camera-zoom-factor=2",
        "--camera-direction=0,0,-1",
        "--camera-view-angle=20",
    ] {
        assert_eq!(picture(&["one.json", option]), picture(&["none.json", option]), "{option}");
    }
    // A state says what was chosen, and what was not.
    for view in [&[][..], &["--view", "three-quarter"]] {
        let first = picture(&[&["one.json", "--save-state", "s.json"], view].concat());
        assert_eq!(first, picture(&["--load-state", "s.json"]), "{view:?}");
    }
}

#[test]
fn options_without_effect_are_told_and_change_nothing() {
    let folder = Folder::new("no-effect");
    let picture = |arguments: &[&str]| {
        let channel = if arguments.contains(&"--channel") { "a.npy" } else { "a.png" };
        let output = render(&folder, &[arguments, &["-o", channel, "--samples", "1"]].concat());
        assert_eq!(code(&output), 0, "{arguments:?}: {}", errors(&output));
        (folder.read(channel), errors(&output))
    };
    // Model and options, then the option that changes nothing beside them, then why.
    let (dark, constant) = (
        &["builtin:sphere", "--lighting", "off"][..],
        &["builtin:sphere", "--illumination", "constant"][..],
    );
    let (wires, data) =
        (&["builtin:cubs", "--wireframe"][..], &["builtin:cubs", "--channel", "depth"][..]);
    let own = "show their own colours";
    let black = "no colour picture";
    for (rest, option, why) in [
        (dark, &["--shading", "flat"][..], own),
        (dark, &["--shading", "gouraud"], own),
        (dark, &["--illumination", "lambert"], own),
        (dark, &["--shadows", "ray"], own),
        (dark, &["--light", "ambient:"], own),
        (dark, &["--light-edit", "LIGHT0.diffuse=red"], own),
        (dark, &["--light-intensity", "2"], own),
        (constant, &["--shading", "flat"], own),
        (constant, &["--shadows", "volume"], own),
        (constant, &["--light", "ambient:"], own),
        (constant, &["--light-edit", "LIGHT0.diffuse=red"], own),
        (constant, &["--light-intensity", "2"], own),
        (
            &["builtin:scene0", "--illumination", "ambient"],
            &["--shadows", "ray"],
            "has a direction",
        ),
        (wires, &["--shading", "gouraud"], "edges alone"),
        (wires, &["--illumination", "lambert"], "edges alone"),
        (wires, &["--shadows", "ray"], "edges alone"),
        (wires, &["--interpolation", "linear"], "edges alone"),
        (&["builtin:lens", "--wireframe"], &["--transparency", "kay"], "edges alone"),
        (&["builtin:lens", "--wireframe"], &["--transparency-order", "sorted"], "edges alone"),
        (&["builtin:cubs", "--wireframe-hidden-line"], &["--shading", "flat"], "edges alone"),
        (data, &["--edges"], black),
        (data, &["--wireframe-hidden-line"], black),
        (data, &["--light", "ambient:"], black),
        (data, &["--light-edit", "LIGHT0.diffuse=red"], black),
        (data, &["--normals", "made"], black),
        (data, &["--crease-angle", "60"], black),
        (wires, &["--normals", "made"], "edges alone"),
        (dark, &["--normals", "none"], own),
        (&["builtin:sphere", "--camera-index", "0"], &["--up", "+Z"], "its own"),
        (data, &["--background-color", "red"], black),
        (data, &["--no-background"], black),
        (data, &["--color-space", "raw"], black),
        (data, &["--depth-cue"], black),
        (data, &["--illumination", "lambert"], black),
        (data, &["--shading", "flat"], black),
        (data, &["--interpolation", "linear"], black),
        (data, &["--shadows", "ray"], black),
        (data, &["--light-intensity", "2"], black),
        (&["builtin:lens", "--channel", "depth"], &["--transparency", "kay"], black),
        (&["builtin:lens", "--channel", "depth"], &["--transparency-order", "sorted"], black),
        (&["builtin:scene0", "--camera-orthographic"], &["--interpolation", "linear"], "parallel"),
        (&["builtin:scene0", "--camera-orthographic"], &["--camera-view-angle", "50"], "parallel"),
        (&["builtin:cubs"], &["--transparency", "kay"], "no transparent surfaces"),
        (&["builtin:cubs"], &["--transparency-order", "sorted"], "no transparent surfaces"),
        (
            &["builtin:cubs", "--transparency", "kay"],
            &["--kay-exponent", "2"],
            "no transparent surfaces",
        ),
        (
            &["builtin:lens", "--transparency", "none"],
            &["--transparency-order", "sorted"],
            "is opaque",
        ),
        (&["builtin:lens", "--transparency", "none"], &["--scatter-samples", "8"], "is opaque"),
        (&["builtin:lens"], &["--scatter-samples", "8"], "no translucent surfaces"),
        (&["builtin:cubs", "--light", "ambient:"], &["--shadows", "ray"], "no light casts shadows"),
        (
            &["builtin:scene0", "--shadows", "ray"],
            &["--light-samples", "4"],
            "no light has an area",
        ),
        (&["builtin:scene0", "--shading", "flat"], &["--normals", "made"], "its own normal"),
        (&["builtin:sphere", "--camera-index", "0"], &["--view", "top"], "decides the view"),
        (&["builtin:sphere", "--camera-direction=1,0,-1"], &["--view", "top"], "decides the view"),
        (
            &["builtin:sphere", "--camera-position=5,4,3", "--camera-view-up=0,1,0"],
            &["--view", "top"],
            "decide the view",
        ),
        (
            &["builtin:sphere", "--camera-position=5,4,3", "--camera-view-up=0,1,0"],
            &["--up", "-Z"],
            "other camera options",
        ),
        (wires, &["--light", "ambient:"], "edges alone"),
        (wires, &["--light-edit", "LIGHT0.diffuse=red"], "edges alone"),
        (wires, &["--light-intensity", "2"], "edges alone"),
        (wires, &["--lighting", "off"], "edges alone"),
        (wires, &["--visibility", "bsp"], "all edges are drawn"),
        (wires, &["--depth-bits", "16"], "all edges are drawn"),
        (data, &["--lighting", "off"], black),
        (data, &["--global", "radiosity"], black),
        (
            &["builtin:cubs", "--light", "ambient:", "--shadows", "map"],
            &["--shadow-map-size", "64"],
            "no light casts",
        ),
        (&["builtin:cubs"], &["--together"], "there is one model"),
        (&["builtin:cubs"], &["--environment", "sky"], "no surface has metal or roughness"),
        (
            &["builtin:cubs", "--global", "radiosity"],
            &["--environment", "sky"],
            "radiosity computes",
        ),
        (
            &["builtin:cubs", "--global", "radiosity"],
            &["--ambient-occlusion=4"],
            "radiosity computes",
        ),
        (dark, &["--ambient-occlusion=4"], own),
        (data, &["--ambient-occlusion=4"], black),
        (wires, &["--ambient-occlusion=4"], "edges alone"),
        (
            &["builtin:cubs", "--light", "point:position=3,4,5,ambient=0"],
            &["--ambient-occlusion=4"],
            "no light comes from everywhere",
        ),
        (dark, &["--ground-shadow"], own),
        (data, &["--ground-shadow"], black),
        (wires, &["--ground-shadow"], "edges alone"),
        (&["builtin:cubs", "--light", "ambient:"], &["--ground-shadow"], "no light casts shadows"),
        (&["builtin:cubs", "--view", "bottom"], &["--ground-shadow"], "below the ground"),
    ] {
        let ((plain, before), (with, told)) = (picture(rest), picture(&[rest, option].concat()));
        let expected = format!("{}: warning: no effect, ", option[0].split('=').next().unwrap());
        assert!(told.contains(&expected) && told.contains(why), "{rest:?} {option:?}: {told}");
        assert!(!before.contains(&expected), "{rest:?}: {before}");
        assert!(plain == with, "{rest:?} {option:?}: the picture changes");
    }
    // What has an effect, is what holds anyway, or comes from a state is not told; nor is anything
    // that was not typed.
    let state = r#"{"settings": {"lighting": false, "shading": "flat", "shadows": "ray"}, "light-intensity": 2}"#;
    folder.file("s.json", state);
    for arguments in [
        &["builtin:sphere", "--load-state", "s.json"][..],
        &[
            "builtin:sphere",
            "--lighting",
            "off",
            "--shading",
            "phong",
            "--illumination",
            "auto",
            "--shadows",
            "none",
        ],
        &["builtin:sphere", "--lighting", "off", "--illumination", "constant"],
        &["builtin:cubs", "--shading", "flat", "--illumination", "lambert"],
        &[
            "builtin:lens",
            "--transparency",
            "kay",
            "--kay-exponent",
            "2",
            "--transparency-order",
            "sorted",
        ],
        &[
            "builtin:scene0",
            "--shadows",
            "volume",
            "--light-intensity",
            "2",
            "--interpolation",
            "linear",
        ],
        &[
            "builtin:scene0",
            "--camera-index",
            "0",
            "--camera-orthographic",
            "--camera-view-angle",
            "50",
        ],
        &["builtin:scene0", "--camera-position=5,4,3", "--up", "+Z"],
        &[
            "builtin:scene0",
            "--camera-position=5,4,3",
            "--camera-view-up=0,1,0",
            "--camera-focal-point=0,0,0",
        ],
        &["builtin:scene0", "--camera-direction=-1,-1,-1", "--camera-view-up=0,0,1"],
        &["builtin:scene0", "--view", "top", "--up", "+X"],
        &["builtin:cubs", "--wireframe-hidden-line", "--visibility", "bsp"],
        &["builtin:cubs", "--ambient-occlusion=4", "--occlusion-radius", "1", "--ground-shadow"],
        &["builtin:cubs", "--illumination", "cook-torrance", "--environment", "sky"],
        &[
            "builtin:cubs",
            "--light",
            "area:center=0,9,0,normal=0,-1,0,radius=1",
            "--ground-shadow",
            "--light-samples=4",
        ],
    ] {
        let (_, told) = picture(arguments);
        assert!(!told.contains("no effect"), "{arguments:?}: {told}");
    }
    let quiet = render(
        &folder,
        &[
            "builtin:sphere",
            "--lighting",
            "off",
            "--shading",
            "flat",
            "-o",
            "a.png",
            "--quiet",
            "--json",
        ],
    );
    assert_eq!(errors(&quiet), "");
    assert!(json(&quiet)["warnings"][0].as_str().unwrap().starts_with("--shading: no effect"));
}

#[test]
fn one_field_of_a_light_is_edited() {
    let folder = Folder::new("light-edit");
    let entry = r#"{"name": "LIGHT0", "diffuse": [1, 0, 0]}"#;
    let mesh = r#""vitral-scene": 1, "meshes": [{"builtin": "teapot"}]"#;
    folder.file("red.json", format!(r#"{{{mesh}, "lights": [{entry}]}}"#));
    let picture = |arguments: &[&str]| {
        let output =
            render(&folder, &[arguments, &["-o", "a.png", "--save-state", "s.json"]].concat());
        assert_eq!(code(&output), 0, "{arguments:?}: {}", errors(&output));
        folder.read("a.png")
    };
    let course = ["builtin:teapot", "--exercise", "4.2"];
    let red = picture(&[&course[..], &["--light-edit", "LIGHT0.diffuse=1,0,0"]].concat());
    assert_ne!(red, picture(&course));
    for same in ["LIGHT0.diffuse=red", "0.diffuse=#ff0000", "*.diffuse=1,0,0"] {
        assert_eq!(red, picture(&[&course[..], &["--light-edit", same]].concat()), "{same}");
    }
    assert_eq!(red, picture(&["--load-state", "s.json"]));
    assert_eq!(red, picture(&["red.json"]), "a scene file keeps what its light leaves out");
    // The later edit wins.
    let twice = ["--light-edit", "LIGHT0.diffuse=0,1,0", "--light-edit", "LIGHT0.diffuse=1,0,0"];
    assert_eq!(red, picture(&[&course[..], &twice].concat()));
    for (edit, said) in [
        ("LIGHT3.diffuse=1", "there is no light `LIGHT3`\nhint: there is LIGHT0"),
        ("LIGHT0.colour=1", "lights have no field `colour`; there are ambient, diffuse"),
        (
            "LIGHT0.cutoff=30",
            "light `LIGHT0` has no `cutoff`\nhint: a point light has ambient, diffuse",
        ),
        ("LIGHT0.diffuse=-1", "intensities of at least 0 are required"),
        ("LIGHT0", "LIGHT.FIELD=VALUE is required"),
    ] {
        let output =
            render(&folder, &[&course[..], &["-o", "x.png", "--light-edit", edit]].concat());
        assert_eq!(code(&output), 2, "{edit}: {}", errors(&output));
        assert!(
            errors(&output).contains(said) && !folder.has("x.png"),
            "{edit}: {}",
            errors(&output)
        );
    }
}

#[test]
fn exercises_of_the_course_start_from_their_scenes() {
    let folder = Folder::new("exercises");
    let picture = |number: &str, more: &[&str]| {
        let arguments =
            [&["--exercise", number, "-o", "a.png", "--save-state", "s.json"], more].concat();
        let output = render(&folder, &arguments);
        assert_eq!(code(&output), 0, "{}", errors(&output));
        folder.read("a.png")
    };
    let pictures = ["4.1", "4.2", "4.3", "5.1", "5.2"].map(|number| picture(number, &[]));
    for (i, one) in pictures.iter().enumerate() {
        assert!(!pictures[..i].contains(one), "exercise {i} looks like another");
    }
    // The state holds what the exercise set, and options override it.
    let again = render(&folder, &["--load-state", "s.json", "-o", "b.png"]);
    assert_eq!(
        (code(&again), folder.read("b.png")),
        (0, pictures[4].clone()),
        "{}",
        errors(&again)
    );
    assert_ne!(picture("4.3", &["--lighting", "on"]), pictures[2]);
    for option in [
        "--eye-rotation=-20,30,0",
        "--eye-translation=1,1,20",
        "--all-rotation=0,30,0",
        "--all-translation=0,3,0",
    ] {
        let moved = picture("4.1", &[option, "--background-color", "black"]);
        assert_ne!(moved, picture("4.1", &["--background-color", "black"]), "{option}");
    }
    let unknown = render(&folder, &["--exercise", "6.1", "-o", "b.png"]);
    let listed =
        ["4.1", "4.2", "4.3", "5.1", "5.2"].iter().all(|number| errors(&unknown).contains(number));
    assert!(code(&unknown) == 2 && listed, "{}", errors(&unknown));
    assert_eq!(
        code(&render(
            &folder,
            &["builtin:cubs", "-o", "b.png", "--view", "top", "--eye-rotation", "0,0,0"]
        )),
        2
    );
}
