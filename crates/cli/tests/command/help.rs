//! Help, lists and manual pages.

use super::*;

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
