//! Files of `vitral draw` as other programs read them.

use super::{Folder, errors};
use std::collections::HashSet;
use std::process::{Command, Output};
use vitral_testkit::fixture::SKIPPED;

/// A cube with a side of 20.
pub(crate) const CUBE: &str = "v 0 0 0\nv 20 0 0\nv 20 20 0\nv 0 20 0\nv 0 0 20\nv 20 0 20\nv 20 20 20\nv 0 20 20\n\
    f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

/// A folder with the cube in it.
pub(crate) struct CubeFolder(pub(crate) Folder);

impl CubeFolder {
    pub(crate) fn new(name: &str) -> Self {
        let folder = Folder::new(&format!("cube-{name}"));
        folder.file("cube.obj", CUBE);
        Self(folder)
    }

    /// Runs `vitral draw cube.obj ARGUMENTS`.
    pub(crate) fn draw(&self, arguments: &[&str]) -> Output {
        self.0.run(&[&["draw", "cube.obj"], arguments].concat())
    }

    /// The file that `vitral draw cube.obj ARGUMENTS -o NAME` writes.
    fn drawn(&self, name: &str, arguments: &[&str]) -> Vec<u8> {
        let output = self.draw(&[arguments, &["-o", name]].concat());
        assert!(output.status.success(), "{arguments:?}: {}", errors(&output));
        self.0.read(name)
    }

    /// The same as text.
    pub(crate) fn text(&self, name: &str, arguments: &[&str]) -> String {
        String::from_utf8_lossy(&self.drawn(name, arguments)).into_owned()
    }

    /// The output of another program in this folder; a line and `None` if it is not installed.
    fn ask(&self, program: &str, arguments: &[&str], package: &str) -> Option<String> {
        let Ok(output) = Command::new(program).args(arguments).current_dir(&self.0.0).output()
        else {
            println!("{SKIPPED}{program} is not installed (Debian: {package})");
            return None;
        };
        assert!(output.status.success(), "{program} {arguments:?}: {}", errors(&output));
        assert_eq!(errors(&output), "", "{program} {arguments:?}");
        Some(String::from_utf8_lossy(&output.stdout).into_owned())
    }
}

const FRONT: [&str; 4] = ["--view", "front", "--scale", "1:1"];
const HIDDEN: [&str; 4] = ["--view", "iso", "--hidden", "dashed"];

#[test]
fn svg_has_real_millimetres() {
    let folder = CubeFolder::new("svg");
    let text = folder.text("x.svg", &FRONT);
    assert!(text.contains("width=\"30mm\" height=\"30mm\" viewBox=\"0 0 30000 30000\""), "{text}");
    assert!(text.contains("20000") && text.matches("<path").count() == 1, "{text}");
    let half = folder
        .text("x.svg", &["--view", "front", "--scale", "1:2", "--unit", "cm", "--margin", "0"]);
    assert!(half.contains("width=\"100mm\""), "{half}");
    let coarse = folder
        .text("x.svg", &[&FRONT[..], &["--precision", ".1", "--stroke", "contour=1"]].concat());
    assert!(
        coarse.contains("viewBox=\"0 0 300 300\"") && coarse.contains("stroke-width=\"10\""),
        "{coarse}"
    );
    let filled = folder.text("x.svg", &["--style", "filled", "--svg-ids"]);
    assert!(filled.contains("data-face=\""), "{filled}");
}

#[test]
fn pdf_is_read_by_others() {
    let folder = CubeFolder::new("pdf");
    let arguments = [&FRONT[..], &["--hidden", "dashed", "--style", "filled-lines"]].concat();
    let file = folder.drawn("x.pdf", &arguments);
    assert!(file.starts_with(b"%PDF-1.5"));
    assert_eq!(file, folder.drawn("x.pdf", &arguments), "equal bytes");
    if let Some(told) = folder.ask("pdfinfo", &["x.pdf"], "poppler-utils") {
        assert!(told.contains("Page size:") && told.contains("85.0394 x 85.0394 pts"), "{told}");
    }
    folder.drawn("y.pdf", &HIDDEN);
    folder.ask("pdftocairo", &["-svg", "y.pdf", "y.svg"], "poppler-utils");
    if folder.ask("pdftocairo", &["-svg", "x.pdf", "x.svg"], "poppler-utils").is_some() {
        let text = String::from_utf8(folder.0.read("x.svg")).unwrap();
        assert!(text.contains("<path"), "{text}");
    }
    if let Some(told) =
        folder.ask("mutool", &["show", "y.pdf", "trailer/Root/OCProperties/OCGs"], "mupdf-tools")
    {
        assert_eq!(told.matches(" 0 R").count(), 3, "hidden, crease and contour: {told}");
    }
    folder.ask("mutool", &["draw", "-q", "-N", "-o", "x.png", "x.pdf"], "mupdf-tools");
}

#[test]
fn dxf_stands_an_audit() {
    let folder = CubeFolder::new("dxf");
    let text = folder.text("x.dxf", &[&HIDDEN[..], &["--scale", "1:1"]].concat());
    assert!(text.starts_with("0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n"), "{text}");
    folder.drawn("front.dxf", &FRONT);
    let script = "import ezdxf\n\
        for name in ('x.dxf', 'front.dxf'):\n    doc = ezdxf.readfile(name)\n    audit = doc.audit()\n\
        \x20   entities = list(doc.modelspace())\n\
        \x20   points = [p for e in entities if e.dxftype() == 'POLYLINE' for p in e.points()]\n\
        \x20   width = max([p[0] for p in points], default=0) - min([p[0] for p in points], default=0)\n\
        \x20   print(len(audit.errors), len(audit.fixes), sorted({e.dxf.layer for e in entities}), round(width, 3))\n\
        \x20   print([l.dxf.linetype for l in doc.layers if l.dxf.name == 'hidden'])\n";
    let python = ["/usr/bin/python3", "python3"].into_iter().find(|python| {
        Command::new(python)
            .args(["-c", "import ezdxf"])
            .output()
            .is_ok_and(|output| output.status.success())
    });
    let Some(python) = python else {
        println!("{SKIPPED}ezdxf is not installed (Debian: python3-ezdxf)");
        return;
    };
    let told = folder.ask(python, &["-c", script], "python3").unwrap();
    let lines: Vec<&str> = told.lines().collect();
    assert!(lines[0].starts_with("0 0 ['contour', 'crease', 'hidden'] "), "{told}");
    assert_eq!(lines[1..], ["['HIDDEN']", "0 0 ['contour'] 20.0", "[]"], "{told}");
}

#[test]
fn hpgl_draws_no_line_twice() {
    let folder = CubeFolder::new("hpgl");
    let text = folder.text("x.plt", &[&HIDDEN[..], &["--page", "A5"]].concat());
    assert!(
        text.starts_with("IN;PS5920,8400;\nSP1;PW0.5;\nPU") && text.ends_with("PU;SP0;\n"),
        "{text}"
    );
    assert!(text.contains("SP3;") && text.contains("SP8;PW0.18;"), "{text}");
    let (mut at, mut drawn) = ([0; 2], HashSet::new());
    for instruction in text.split(';').map(str::trim) {
        let Some((pen, points)) =
            instruction.split_at_checked(2).filter(|(name, _)| ["PU", "PD"].contains(name))
        else {
            continue;
        };
        let numbers: Vec<i32> =
            points.split(',').filter(|n| !n.is_empty()).map(|n| n.parse().unwrap()).collect();
        for point in numbers.chunks(2).map(|pair| [pair[0], pair[1]]) {
            assert!((0..=5920).contains(&point[0]) && (0..=8400).contains(&point[1]), "{point:?}");
            assert!(
                pen == "PU" || drawn.insert([at.min(point), at.max(point)]),
                "{at:?} to {point:?}"
            );
            at = point;
        }
    }
    assert!(drawn.len() >= 9, "{text}");
    let front = folder.text("x.hpgl", &FRONT);
    assert_eq!(front.matches("PU").count(), 2, "one line and the end: {front}");
    assert!(front.contains("1000,1000") && front.contains("200,200"), "{front}");
}

#[test]
fn plotters_get_numbered_layers_with_each_line_once() {
    let folder = CubeFolder::new("plotter");
    let text = folder.text("x.svg", &[&HIDDEN[..], &["--plotter"]].concat());
    assert!(
        text.contains("inkscape:label=\"1 contour\"")
            && text.contains("inkscape:label=\"8 hidden\""),
        "{text}"
    );
    assert!(
        !text.contains("dasharray") && text.matches("<path").count() > 20,
        "dashes are lines: {text}"
    );
    let simple = folder.text("x.svg", &["--view", "iso", "--plotter", "--simplify", "500"]);
    assert!(simple.len() < text.len());
}

#[test]
fn title_blocks_are_a_layer_below_the_drawing() {
    let folder = CubeFolder::new("title");
    let rows = ["--title-block", "Part=Cube", "--title-block", "Scale=1:1"];
    let text = folder.text("x.svg", &[&FRONT[..], &rows].concat());
    assert!(
        text.contains("inkscape:label=\"9 title\"") && text.contains("viewBox=\"0 0 37833 45000\""),
        "{text}"
    );
    let sheet =
        folder.text("x.svg", &[&rows[..], &["--page", "A6", "--stroke", "title=.3"]].concat());
    assert!(
        sheet.contains("viewBox=\"0 0 105000 148000\"") && sheet.contains("stroke-width=\"300\""),
        "{sheet}"
    );
}

#[test]
fn options_that_do_not_suit_the_file_are_told() {
    let folder = CubeFolder::new("mistakes");
    for (arguments, code, said) in [
        (&["-o", "x.png"][..], 4, "choose .svg, .pdf, .dxf, .hpgl, .plt"),
        (&["-o", "x.svg", "--stroke", "outline=1"], 2, "`outline` is not one of contour, boundary"),
        (&["-o", "x.svg", "--stroke", "hidden=1"], 2, "add --hidden dashed"),
        (&["-o", "x.dxf", "--stroke", "contour=1"], 2, "choose .svg, .pdf or .hpgl"),
        (&["-o", "x.dxf", "--style", "filled"], 2, "give --style filled-lines"),
        (&["-o", "x.hpgl", "--precision", ".1"], 2, "1/40 mm"),
        (&["-o", "x.svg", "--precision", ".3"], 2, "1, .1, .01 or .001 is required"),
        (&["-o", "x.svg", "--svg-ids"], 2, "add --style filled"),
        (&["-o", "x.pdf", "--style", "filled", "--svg-ids"], 2, "choose .svg"),
        (&["-o", "x.svg", "--title-block", "Part=ß"], 2, "there is no stroke letter for `ß`"),
        (&["-o", "x.svg", "--title-block", "Part=Cube", "--page", "20x20mm"], 2, "leaves no room"),
        (&["-o", "x.svg", "--stroke", "title=1"], 2, "add --title-block"),
        (&["-o", "x.svg", "--unit", "m"], 2, "--scale"),
        (&["-o", "x.svg", "--scale", "0:1"], 2, "is not a scale"),
        (
            &["-o", "x.svg", "--scale", "1:1", "--camera-view-angle", "30"],
            2,
            "add --camera-orthographic",
        ),
        (
            &["-o", "x.svg", "--view", "front", "--scale", "15:1", "--page", "A4"],
            2,
            "has 300.0 x 300.0 mm, the sheet has room for 200.0 x 287.0 mm",
        ),
        (
            &["-o", "x.svg", "--view", "front", "--scale", "1:1", "--unit", "m"],
            2,
            "--scale 1:2 fits",
        ),
        (
            &["-o", "x.dxf", "--style", "filled-lines"],
            0,
            "x.dxf: warning: filled regions are left out",
        ),
        (&["-o", "x.svg", "--view", "front", "--scale", "10:1", "--page", "A4"], 0, ""),
    ] {
        let output = folder.draw(arguments);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {}", errors(&output));
        assert!(errors(&output).contains(said), "{arguments:?}: {}", errors(&output));
    }
}

#[test]
fn a_drawing_without_anything_in_it_is_told() {
    let folder = Folder::new("empty-drawing");
    folder.file("point.obj", "v 0 0 0\nv 1 1 0\np 1\np 2\n");
    let output = folder.run(&["draw", "point.obj", "--style", "filled", "-o", "x.svg"]);
    assert!(
        output.status.success() && errors(&output).contains("the drawing is empty"),
        "{}",
        errors(&output)
    );
    let output = folder.run(&["draw", "point.obj", "-o", "x.svg"]);
    assert!(
        output.status.success() && !errors(&output).contains("the drawing is empty"),
        "{}",
        errors(&output)
    );
}
