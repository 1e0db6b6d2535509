//! Options about what surrounds a model: the environment, ambient occlusion, the shadow on the
//! ground.

use super::{Folder, code, errors, render};
use vitral::Plane;
use vitral::internals::io::encode::{PngOptions, png};

/// An HDR file of 16 by 8 texels, twice as bright as white, and green.
fn hdr() -> Vec<u8> {
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n".to_vec();
    (0..16 * 8).for_each(|_| bytes.extend([0, 128, 0, 130]));
    bytes
}

fn png_of(width: u32, height: u32, color: [u8; 4]) -> Vec<u8> {
    png(&Plane::filled(width, height, color), PngOptions::default()).unwrap()
}

const SMALL: [&str; 4] = ["--samples", "1", "--illumination", "cook-torrance"];

#[test]
fn an_environment_comes_from_a_file_and_goes_through_a_state() {
    let folder = Folder::new("environment");
    folder.file("green.hdr", hdr());
    folder.file("blue.png", png_of(16, 8, [0, 0, 255, 255]));
    let picture = |arguments: &[&str]| {
        let output = render(&folder, &[arguments, &SMALL, &["-o", "a.png"]].concat());
        assert!(
            code(&output) == 0 && errors(&output).is_empty(),
            "{arguments:?}: {}",
            errors(&output)
        );
        folder.read("a.png")
    };
    let plain = picture(&["builtin:teapot"]);
    let green =
        picture(&["builtin:teapot", "--environment", "green.hdr", "--save-state", "states.json"]);
    let blue = picture(&["builtin:teapot", "--environment", "blue.png"]);
    assert!(plain != green && green != blue);
    let text = String::from_utf8(folder.read("states.json")).unwrap();
    assert!(text.contains("\"environment-image\": \"green.hdr\""), "{text}");
    assert!(picture(&["--load-state", "states.json"]) == green);
    // The option typed later counts.
    assert!(picture(&["--load-state", "states.json", "--environment", "blue.png"]) == blue);
    assert!(picture(&["--load-state", "states.json", "--environment", "auto"]) == plain);
}

#[test]
fn images_that_cannot_be_used_are_told() {
    let folder = Folder::new("environments");
    folder.file("square.png", png_of(9, 9, [99, 99, 99, 255]));
    folder.file("broken.hdr", &hdr()[..90]);
    folder.file("broken.exr", b"\x76\x2f\x31\x01 and no more");
    folder.file("text.png", "no image");
    let run = |value: &str| {
        let output = render(
            &folder,
            &[&["builtin:teapot", "--environment", value, "-o", "a.png"], &SMALL[..]].concat(),
        );
        (code(&output), errors(&output))
    };
    for (value, exit, what) in [
        ("absent.hdr", 3, "absent.hdr: "),
        ("broken.hdr", 3, "broken.hdr: Radiance HDR: "),
        ("broken.exr", 3, "broken.exr: OpenEXR: "),
        ("text.png", 4, "text.png: this image format is not read"),
        ("studio", 2, "auto, sky, none, or a file"),
    ] {
        let (code, told) = run(value);
        assert!(code == exit && told.contains(what), "{value}: {code} {told}");
    }
    let (code, told) = run("square.png");
    assert!(code == 0 && told.contains("an image of 9 x 9"), "{told}");
    // A state says one of both.
    folder.file(
        "s.json",
        r#"{"environment-image": "square.png", "settings": {"environment": "sky"}}"#,
    );
    let output = render(&folder, &["builtin:teapot", "--load-state", "s.json", "-o", "a.png"]);
    assert!(
        code == 0 && errors(&output).contains("settings.environment must be auto"),
        "{}",
        errors(&output)
    );
    assert_eq!(super::code(&output), 3);
}

#[test]
fn occlusion_and_the_ground_go_through_a_state() {
    let folder = Folder::new("occlusion");
    let picture = |arguments: &[&str]| {
        let output = render(&folder, &[arguments, &["-o", "a.png"]].concat());
        assert!(
            code(&output) == 0 && errors(&output).is_empty(),
            "{arguments:?}: {}",
            errors(&output)
        );
        folder.read("a.png")
    };
    let plain = picture(&["builtin:teapot"]);
    let both = [
        "--ambient-occlusion=9",
        "--occlusion-radius",
        "0.8",
        "--ground-shadow=soft",
        "--save-state",
        "s.json",
    ];
    let shown = picture(&[&["builtin:teapot"], &both[..]].concat());
    assert!(plain != shown);
    assert!(picture(&["--load-state", "s.json"]) == shown);
    let one = |option: &str| picture(&["builtin:teapot", option]);
    assert!(
        one("--ambient-occlusion") == one("--ambient-occlusion=32")
            && one("--ambient-occlusion") != plain
    );
    assert!(
        one("--ground-shadow") == one("--ground-shadow=soft"),
        "in the default lights it is soft"
    );
    assert!(one("--ground-shadow=lights") != one("--ground-shadow=soft"));
    for (arguments, what) in [
        (&["--ambient-occlusion=0"][..], "1 to 4096"),
        (&["--occlusion-radius", "2"], "--ambient-occlusion"),
        (&["--ambient-occlusion", "--occlusion-radius", "0"], "above 0"),
        (&["--ground-shadow=hard"], "soft"),
    ] {
        let output = render(&folder, &[&["builtin:teapot", "-o", "b.png"], arguments].concat());
        assert!(
            code(&output) == 2 && errors(&output).contains(what),
            "{arguments:?}: {}",
            errors(&output)
        );
    }
    for option in ["--ambient-occlusion", "--ground-shadow", "--environment=a.hdr"] {
        let output = folder.run(&["draw", "builtin:teapot", "-o", "a.svg", option]);
        assert_eq!(code(&output), 2, "{option}: {}", errors(&output));
    }
}
