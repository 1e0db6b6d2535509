//! Sections and exploded views of `vitral draw` through the command line.

use super::drawing::{CUBE, CubeFolder};
use super::errors;

const HALF: [&str; 6] = ["--section-plane", "10,10,10,0,0,1", "--view", "front", "--scale", "1:1"];

#[test]
fn a_cut_has_its_layers_in_all_formats() {
    let folder = CubeFolder::new("section-layers");
    let svg = folder.text("x.svg", &HALF);
    for label in ["6 section", "10 hatch"] {
        assert!(svg.contains(&format!("inkscape:label=\"{label}\"")), "{svg}");
    }
    // A square of 20 mm: seven lines on each side of the diagonal, 2 mm apart, and one outline.
    assert_eq!(svg.matches("<path").count(), 15 + 1, "{svg}");
    assert!(svg.contains("stroke-width=\"700\"") && svg.contains("stroke-width=\"180\""), "{svg}");
    let wide =
        folder.text("x.svg", &[&HALF[..], &["--hatch", "0,4mm", "--stroke", "hatch=.25"]].concat());
    assert_eq!(
        (wide.matches("<path").count(), wide.contains("stroke-width=\"250\"")),
        (5 + 1, true),
        "{wide}"
    );
    let none = folder.text("x.svg", &[&HALF[..], &["--hatch", "none"]].concat());
    assert_eq!(none.matches("<path").count(), 1, "{none}");
    let dxf = folder.text("x.dxf", &HALF);
    assert!(dxf.contains("8\nhatch\n") && dxf.contains("8\nsection\n"));
    let hpgl = folder.text("x.plt", &HALF);
    assert!(hpgl.contains("SP10;PW0.18;") && hpgl.contains("SP6;PW0.7;"), "{hpgl}");
    assert!(folder.text("x.pdf", &HALF).contains("(10 hatch)"));
    let plotter = folder.text("x.svg", &[&HALF[..], &["--plotter"]].concat());
    assert!(plotter.contains("data-class=\"hatch\""), "{plotter}");
    let filled = folder.text("x.svg", &[&HALF[..], &["--style", "filled"]].concat());
    assert!(filled.contains("data-class=\"fill\"") && !filled.contains("hatch"), "{filled}");
    let one =
        folder.text("x.svg", &[&HALF[..], &["--lines", "section", "--threads", "1"]].concat());
    assert_eq!(
        one,
        folder.text("x.svg", &[&HALF[..], &["--lines", "section", "--threads", "3"]].concat())
    );
}

#[test]
fn parts_move_apart_before_they_are_cut() {
    let folder = CubeFolder::new("section-explode");
    let second = CUBE.lines().map(|line| match line.strip_prefix("v ") {
        Some(place) => {
            let (x, rest) = place.split_once(' ').unwrap();
            format!("v {} {rest}\n", x.parse::<i32>().unwrap() + 20)
        }
        None => format!("{line}\n"),
    });
    folder.0.file("second.obj", second.collect::<String>());
    let width = |arguments: &[&str]| {
        let file = [&["-o", "-", "--view", "front", "--scale", "1:1", "--margin", "0"], arguments]
            .concat();
        let output = folder.draw(&[&["second.obj"], &file[..]].concat());
        assert!(output.status.success(), "{}", errors(&output));
        let text = String::from_utf8(output.stdout).unwrap();
        text.split_once("width=\"").unwrap().1.split_once("mm\"").unwrap().0.to_owned()
    };
    // Centres at 10 and 30 move to 0 and 40.
    assert_eq!(
        (width(&[]), width(&["--explode", "0"]), width(&["--explode", "1"])),
        ("40".into(), "40".into(), "60".into())
    );
    assert_eq!(width(&["--explode", "1", "--section-plane", "40,0,0,1,0,0"]), "50");
}

#[test]
fn mistakes_are_told() {
    let folder = CubeFolder::new("section-mistakes");
    let cut = &HALF[..2];
    for (arguments, code, said) in [
        (&["--lines", "section"][..], 2, "add --section-plane"),
        (&["--stroke", "section=1"], 2, "add --section-plane"),
        (&["--stroke", "hatch=1"], 2, "there is no hatching"),
        (&["--hatch", "45,2mm"], 2, "--section-plane"),
        (&["--section-plane", "0,0,0,0,0,0"], 2, "the normal NX,NY,NZ must not be 0,0,0"),
        (&["--section-plane", "0,0,0,1"], 2, "six numbers"),
        (&["--explode", "-1"], 2, "--explode"),
        (&[cut[0], cut[1], "--hatch", "45"], 2, "ANGLE,DISTANCE is required"),
        (&[cut[0], cut[1], "--hatch", "none", "--stroke", "hatch=1"], 2, "there is no hatching"),
        (&[cut[0], cut[1], "--style", "filled", "--hatch", "45,2mm"], 2, "draws no lines"),
        (&["--section-plane", "0,0,50,0,0,1"], 0, "no plane cuts the model"),
        (&["--section-plane", "0,0,-1,0,0,1"], 0, "nothing is left of the model"),
        (&["--lines", "all"], 0, ""),
    ] {
        let output = folder.draw(&[arguments, &["-o", "x.svg"]].concat());
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {}", errors(&output));
        assert!(errors(&output).contains(said), "{arguments:?}: {}", errors(&output));
    }
}
