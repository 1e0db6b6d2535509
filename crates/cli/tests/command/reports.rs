//! What the command tells: steps, structures, pixels, statistics.

use super::{Folder, code, errors, json, render};

#[test]
fn steps_are_traced_and_drawn() {
    let folder = Folder::new("steps");
    let algorithms = json(&folder.run(&["algorithms", "--json"]));
    for algorithm in algorithms["visibility"].as_array().unwrap() {
        let name = algorithm["name"].as_str().unwrap();
        let arguments = ["builtin:cubs", "-o", "a.png", "--samples", "1", "--visibility", name];
        let output = render(&folder, &[&arguments[..], &["--trace", "t.jsonl"]].concat());
        assert_eq!(code(&output), 0, "{}", errors(&output));
        let text = String::from_utf8(folder.read("t.jsonl")).unwrap();
        let steps: Vec<serde_json::Value> =
            text.lines().map(|l| serde_json::from_str(l).unwrap()).collect();
        assert!(!steps.is_empty() && steps.iter().all(|s| s["step"].is_string()), "{name}");
        let numbers = steps.iter().map(|s| s["number"].as_u64().unwrap());
        assert!(numbers.eq(0..steps.len() as u64), "{name}");
        let untraced = render(&folder, &["builtin:cubs", "-o", "b.png", "--samples", "1"]);
        assert_eq!(
            (code(&untraced), folder.read("a.png") == folder.read("b.png")),
            (0, true),
            "{name}"
        );
        let drawn = render(&folder, &[&arguments[..], &["--channel", "steps"]].concat());
        assert_eq!(code(&drawn), 0, "{}", errors(&drawn));
        assert_ne!(folder.read("a.png"), folder.read("b.png"), "{name} shows its steps");
    }
    assert_eq!(
        code(&render(&folder, &["builtin:cubs", "--pixel", "1,1", "--trace", "t.jsonl"])),
        2
    );
}

#[test]
fn pictures_after_steps_are_drawn_one_by_one() {
    let folder = Folder::new("after-steps");
    let cubs = ["builtin:cubs", "--visibility", "warnock"];
    let steps = |more: &[&str]| render(&folder, &[&cubs[..], more].concat());
    let last = steps(&["-o", "last.png", "--channel", "steps", "--step", "99999"]);
    let told = errors(&last);
    assert_eq!(code(&last), 2, "{told}");
    let count: u32 =
        told.split("takes ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    for (name, number) in [("early.png", 1), ("late.png", count - 1)] {
        let output = steps(&["-o", name, "--channel", "steps", "--step", &number.to_string()]);
        assert_eq!(code(&output), 0, "{}", errors(&output));
    }
    assert_ne!(folder.read("early.png"), folder.read("late.png"));

    // Seven of the steps' pictures, the last of which is that after the last step.
    let output = steps(&["--steps-video", "s-{frame:2}.png", "--steps-frames", "7"]);
    assert_eq!(code(&output), 0, "{}", errors(&output));
    assert!(folder.has("s-00.png") && folder.has("s-06.png") && !folder.has("s-07.png"));
    assert_eq!(folder.read("s-06.png"), folder.read("late.png"));

    for (arguments, told) in [
        (&["-o", "a.png", "--step", "3"][..], "--step 3: no picture of steps is written"),
        (&["--steps-video", "s.png"], "put {frame} or {frame:4} into its name"),
        (&["--steps-video", "nowhere/{frame}.png"], "nowhere"),
        (&["-o", "a.png", "--steps-frames", "3"], "--steps-video"),
    ] {
        let output = steps(arguments);
        assert_ne!(code(&output), 0, "{arguments:?}");
        assert!(errors(&output).contains(told), "{arguments:?}: {}", errors(&output));
    }
}

#[test]
fn structures_are_drawn_of_algorithms_that_have_one() {
    let folder = Folder::new("structures");
    for (name, title) in
        [("bsp", ">BSP tree: "), ("painter", ">Depth sort: "), ("warnock", ">Area subdivision: ")]
    {
        let arguments = [
            "builtin:cubs",
            "-o",
            "a.png",
            "--visibility",
            name,
            "--structure",
            "s.svg",
            "--trace",
            "t.jsonl",
        ];
        let output = render(&folder, &arguments);
        assert_eq!(code(&output), 0, "{}", errors(&output));
        let svg = String::from_utf8(folder.read("s.svg")).unwrap();
        assert!(svg.starts_with("<svg ") && svg.contains(title), "{name}: {svg}");
        assert!(!folder.read("t.jsonl").is_empty());
    }
    let refused = render(&folder, &["builtin:cubs", "-o", "a.png", "--structure", "s.svg"]);
    assert_eq!(code(&refused), 2);
    assert!(
        errors(&refused).contains("z-buffer")
            && errors(&refused).contains("warnock or painter or bsp"),
        "{}",
        errors(&refused)
    );
    let nothing = ["builtin:cubs", "--pixel", "1,1", "--visibility", "bsp", "--structure", "s.svg"];
    assert_eq!(code(&render(&folder, &nothing)), 2);
}

#[test]
fn a_pixel_is_explained() {
    let folder = Folder::new("pixel");
    let told = json(&render(&folder, &["builtin:cubs", "--pixel", "32,20", "--json"]));
    let nearest = &told["pixel"]["surfaces"][0]["facet"];
    assert!(nearest.is_u64(), "{told}");
    assert!(
        told["pixel"]["decisions"].as_array().unwrap().iter().all(|d| d["facet"] == *nearest),
        "{told}"
    );
    let output = render(&folder, &["builtin:cubs", "--pixel", "32,20"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.contains("surface(s) cover its centre") && text.contains("z-buffer: facet"),
        "{text}"
    );
    assert!(text.contains("a back face, culled") && !text.contains("warnock"), "{text}");
    let asked = json(&render(
        &folder,
        &["builtin:cubs", "--pixel", "32,20", "--json", "--pixel-algorithms", "all"],
    ));
    let decisions = asked["pixel"]["decisions"].as_array().unwrap();
    assert!(decisions.len() > 5 && decisions.iter().all(|d| d["facet"] == *nearest), "{asked}");
    let one = render(
        &folder,
        &["builtin:cubs", "--pixel", "32,20", "--pixel-algorithms", "warnock,painter"],
    );
    let text = String::from_utf8(one.stdout).unwrap();
    assert!(
        text.contains("warnock: facet")
            && text.contains("painter: facet")
            && !text.contains("z-buffer:"),
        "{text}"
    );
    let refused =
        render(&folder, &["builtin:cubs", "--pixel", "32,20", "--pixel-algorithms", "best"]);
    assert!(
        code(&refused) == 2 && errors(&refused).contains("`best` is not one of all, z-buffer"),
        "{}",
        errors(&refused)
    );
    assert_eq!(code(&render(&folder, &["builtin:cubs", "--pixel", "64,0"])), 2);
}

#[test]
fn a_pixel_outside_the_picture_is_refused() {
    let folder = Folder::new("pixel-outside");
    for (pixel, fits) in
        [("63,47", true), ("64,0", false), ("0,48", false), ("4294967295,4294967295", false)]
    {
        let output = render(&folder, &["builtin:cubs", "--pixel", pixel]);
        assert_eq!(code(&output), if fits { 0 } else { 2 }, "{pixel}: {}", errors(&output));
        let told = format!("--pixel {pixel}: the picture has 64x48 pixels");
        assert_eq!(errors(&output).contains(&told), !fits, "{}", errors(&output));
    }
}

#[test]
fn stats_are_json() {
    let folder = Folder::new("stats");
    let output = render(
        &folder,
        &["builtin:cubs", "-o", "a.png", "--stats-file", "s.json", "--threads", "1"],
    );
    assert_eq!(code(&output), 0);
    let stats: serde_json::Value = serde_json::from_slice(&folder.read("s.json")).unwrap();
    assert!(stats["frames"][0]["geometry"]["triangles"].as_u64().unwrap() > 0);
    for stage in ["prepare", "geometry", "tiles", "total"] {
        assert!(stats["frames"][0]["seconds"][stage].as_f64().unwrap() > 0.0, "{stage}: {stats}");
    }
    let all = [
        "-o",
        "a.png",
        "--dump",
        "d",
        "--pixel",
        "9,9",
        "--shadows",
        "volume",
        "--export-shadow-polygons",
        "s.obj",
    ];
    let output = render(&folder, &[&["builtin:cubs", "--stats-file", "s.json"], &all[..]].concat());
    assert_eq!(code(&output), 0, "{}", errors(&output));
    let stats: serde_json::Value = serde_json::from_slice(&folder.read("s.json")).unwrap();
    for stage in ["load", "dump", "shadow-polygons", "frames", "pixel"] {
        assert!(stats["seconds"][stage].as_f64().unwrap() > 0.0, "{stage}: {stats}");
    }
    let panels =
        ["builtin:cubs", "--shadows", "map", "--panels", "-o", "p.png", "--stats-file", "s.json"];
    assert_eq!(code(&render(&folder, &panels)), 0);
    let stats: serde_json::Value = serde_json::from_slice(&folder.read("s.json")).unwrap();
    let of = |stage: &str| stats["frames"][0]["seconds"][stage].as_f64().unwrap();
    assert!(of("panels") > of("total"), "{stats}");
}

#[test]
fn standard_output_takes_state_statistics_and_trace() {
    let folder = Folder::new("dash");
    let printed = |option: &str| {
        let output =
            render(&folder, &["builtin:cubs", "-o", "a.png", "--samples", "1", option, "-"]);
        assert_eq!(code(&output), 0, "{option}: {}", errors(&output));
        assert!(!folder.has("-"), "{option} makes no file of that name");
        String::from_utf8(output.stdout).unwrap()
    };
    let state: serde_json::Value = serde_json::from_str(&printed("--save-state")).unwrap();
    assert_eq!(
        (&state["models"], &state["settings"]["width"]),
        (&serde_json::json!(["builtin:cubs"]), &64.into())
    );
    let stats: serde_json::Value = serde_json::from_str(&printed("--stats-file")).unwrap();
    assert!(stats["frames"][0]["geometry"]["triangles"].as_u64().unwrap() > 0, "{stats}");
    let steps = printed("--trace");
    assert!(steps.lines().count() > 0);
    for line in steps.lines() {
        let step: serde_json::Value = serde_json::from_str(line).unwrap();
        assert!(step["step"].is_string(), "{step}");
    }
    let both =
        render(&folder, &["builtin:cubs", "-o", "a.png", "--save-state", "-", "--stats-file", "-"]);
    assert_eq!(code(&both), 2);
    assert!(
        errors(&both).contains("--save-state - and --stats-file - both write to standard output"),
        "{}",
        errors(&both)
    );
}

#[test]
fn statistics_are_told_apart_from_the_result_and_in_it() {
    let folder = Folder::new("stats-json");
    let output = render(
        &folder,
        &["builtin:cubs", "-o", "a.png", "--json", "--stats", "--progress", "never"],
    );
    let result = json(&output);
    let stats: serde_json::Value = serde_json::from_slice(&output.stderr).unwrap();
    assert_eq!(result["stats"], stats);
    assert!(stats["frames"][0]["geometry"]["triangles"].as_u64().unwrap() > 0, "{stats}");
    let without = json(&render(&folder, &["builtin:cubs", "-o", "a.png", "--json"]));
    assert!(without.get("stats").is_none(), "{without}");
}

#[test]
fn a_picture_on_which_nothing_is_seen_says_why() {
    let folder = Folder::new("blank");
    folder.file("clear.mtl", "newmtl m\nKd 0.8 0.1 0.1\nd 0\n");
    folder.file("clear.obj", "mtllib clear.mtl\nv 0 0 0\nv 2 0 0\nv 2 2 0\nusemtl m\nf 1 2 3\n");
    let clear = render(&folder, &["clear.obj", "-o", "a.png"]);
    assert!(
        code(&clear) == 0 && errors(&clear).contains("the opacity of all surfaces is 0"),
        "{}",
        errors(&clear)
    );
    let failed = render(&folder, &["clear.obj", "-o", "a.png", "--fail-if-blank"]);
    assert!(code(&failed) == 6 && folder.has("a.png"), "{}", errors(&failed));
    let away_words = |name| {
        ["builtin:cubs", "--camera-position", "0,0,9", "--camera-focal-point", "0,0,20", "-o", name]
    };
    let away = render(&folder, &[&away_words("b.png")[..], &["--fail-if-blank"]].concat());
    assert!(code(&away) == 6 && errors(&away).contains("outside of the view"), "{}", errors(&away));
    let seen = render(&folder, &["builtin:cubs", "-o", "c.png", "--fail-if-blank"]);
    assert!(code(&seen) == 0 && !errors(&seen).contains("nothing is seen"), "{}", errors(&seen));

    // Data tell it, too, where no colours are asked for.
    for channel in ["depth", "id", "normal", "steps"] {
        let command = ["builtin:cubs", "-o", "c.npy", "--channel", channel, "--fail-if-blank"];
        let command = if channel == "steps" {
            command.map(|word| if word == "c.npy" { "c.png" } else { word })
        } else {
            command
        };
        let seen = render(&folder, &command);
        assert!(code(&seen) == 0 && errors(&seen).is_empty(), "{channel}: {}", errors(&seen));
    }
    let depth = render(
        &folder,
        &[&["--channel", "depth", "--fail-if-blank"], &away_words("d.npy")[..]].concat(),
    );
    assert!(
        code(&depth) == 6 && errors(&depth).contains("outside of the view"),
        "{}",
        errors(&depth)
    );
}
