//! `vitral draw --algorithm`: polygons of the course's algorithms as other programs read them.

use super::Folder;

/// Three bars, each in front of the next: a circle that no order from back to front has.
const BARS: &str = r#"{"vitral-scene": 1, "meshes": [{"positions": [
    [-58.5, -42, -10], [58.5, -42, 10], [58.5, -28, 10], [-58.5, -28, -10],
    [57.851, -43.568, -10], [-0.649, 60.432, 10], [-12.851, 53.568, 10], [45.649, -50.432, -10],
    [0.649, 60.432, -10], [-57.851, -43.568, 10], [-45.649, -50.432, 10], [12.851, 53.568, -10]],
    "faces": [[0, 1, 2, 3], [4, 5, 6, 7], [8, 9, 10, 11]]}],
    "cameras": [{"position": [0, 0, 100], "focal-point": [0, 0, 0], "view-up": [0, 1, 0],
    "projection": {"type": "parallel", "height": 128}, "clip": [1, 200]}]}"#;
/// Four squares of which a BSP tree cuts three.
const SQUARES: &str = r#"{"vitral-scene": 1, "meshes": [{"positions": [
    [-40, -40, 0], [10, -40, 0], [10, 10, 0], [-40, 10, 0], [-20, -20, 20], [30, -20, 20], [30, 30, 20], [-20, 30, 20],
    [-50, -5, -30], [50, -5, -30], [50, -5, 50], [-50, -5, 50], [-10, -50, -30], [50, -50, 30], [50, 50, 30], [-10, 50, -30]],
    "faces": [[0, 1, 2, 3], [4, 5, 6, 7], [8, 9, 10, 11], [12, 13, 14, 15]]}],
    "cameras": [{"position": [20, 40, 100], "focal-point": [0, 0, 0], "view-up": [0, 1, 0],
    "projection": {"type": "parallel", "height": 128}, "clip": [1, 300]}]}"#;
const TRIANGLE: &str = "v -5 -5 0\nv 5 -5 0\nv 0 5 0\nf 1 2 3\n";

/// A folder with the scenes in it.
struct SceneFolder(Folder);

impl SceneFolder {
    fn new(name: &str) -> Self {
        let folder = Folder::new(&format!("polygons-{name}"));
        for (file, text) in
            [("bars.json", BARS), ("squares.json", SQUARES), ("triangle.obj", TRIANGLE)]
        {
            folder.file(file, text);
        }
        Self(folder)
    }

    /// The SVG of a drawing, and its statistics.
    fn drawn(&self, arguments: &[&str]) -> (String, serde_json::Value) {
        let output = self.0.run(&[&["draw"], arguments, &["--stats", "-o", "-"]].concat());
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{arguments:?}: {errors}");
        (String::from_utf8(output.stdout).unwrap(), serde_json::from_str(&errors).unwrap())
    }

    /// The message of a command line that is refused with exit code 2.
    fn mistake(&self, arguments: &[&str]) -> String {
        let output = self.0.run(&[&["draw", "bars.json"], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        String::from_utf8_lossy(&output.stderr).into_owned()
    }
}

#[test]
fn hand_counts_of_cuts_and_pieces() {
    let folder = SceneFolder::new("counts");
    // Model, algorithm, splits, pieces.
    let counted = [
        ("bars.json", "painter", 1, 4),
        ("bars.json", "weiler-atherton", 0, 4),
        ("squares.json", "bsp", 3, 7),
        ("triangle.obj", "painter", 0, 1),
        ("triangle.obj", "bsp", 0, 1),
        ("triangle.obj", "weiler-atherton", 0, 1),
    ];
    for (model, algorithm, splits, pieces) in counted {
        let camera: &[&str] = if model.ends_with("json") { &["--camera-index", "0"] } else { &[] };
        let (svg, stats) = folder.drawn(&[&[model, "--algorithm", algorithm], camera].concat());
        let found = (&stats["splits"], &stats["pieces"], &stats["regions"]);
        assert_eq!(found, (&splits.into(), &pieces.into(), &pieces.into()), "{model} {algorithm}");
        assert_eq!(svg.matches("fill=\"#").count(), pieces, "{svg}");
        let again = stats["square-millimetres-drawn-again"].as_f64().unwrap();
        let overlaps = model != "triangle.obj" && algorithm != "weiler-atherton";
        assert_eq!(again > 1.0, overlaps, "{model} {algorithm}: {again}");
    }
}

#[test]
fn styles_of_lists_and_of_visible_polygons() {
    let folder = SceneFolder::new("styles");
    let svg = |algorithm: &str, more: &[&str]| {
        folder
            .drawn(
                &[&["bars.json", "--camera-index", "0", "--algorithm", algorithm], more].concat(),
            )
            .0
    };
    // A list is outlined in its order, with white polygons for hidden lines.
    let usual = svg("painter", &[]);
    assert!(
        usual.contains("stroke=\"#000\" stroke-width=\"180\"") && usual.matches("<g ").count() == 1,
        "{usual}"
    );
    assert_eq!(usual, svg("painter", &["--style", "filled-lines"]));
    assert_eq!(svg("painter", &["--style", "hidden-line"]).matches("fill=\"#ffffff\"").count(), 4);
    assert!(!svg("bsp", &["--style", "filled"]).contains("stroke"));
    assert!(svg("bsp", &["--stroke", "smooth=0.5"]).contains("stroke-width=\"500\""));
    // Visible polygons have lines of their own, each part once.
    let lines = svg("weiler-atherton", &["--style", "hidden-line"]);
    assert!(
        lines.contains("data-class=\"smooth\"") && !lines.contains("data-class=\"fill\""),
        "{lines}"
    );
    assert_eq!(svg("weiler-atherton", &[]).matches("<g ").count(), 2);
    let exact = svg("exact", &["--style", "filled"]);
    let page =
        |svg: &str| svg.split("viewBox").nth(1).unwrap().split('>').next().unwrap().to_owned();
    assert_eq!([page(&usual), page(&lines)], [page(&exact), page(&exact)], "the same page");
    // DXF and plotters get lines.
    let dxf = folder.0.run(&[
        "draw",
        "bars.json",
        "--algorithm",
        "weiler-atherton",
        "--style",
        "hidden-line",
        "-o",
        "x.dxf",
    ]);
    assert!(
        dxf.status.success()
            && String::from_utf8(folder.0.read("x.dxf")).unwrap().contains("POLYLINE")
    );
}

#[test]
fn shadows_are_told_and_the_page_stays() {
    let folder = SceneFolder::new("shadows");
    for algorithm in ["painter", "weiler-atherton"] {
        let arguments = ["builtin:scene0", "--algorithm", algorithm, "--style", "filled"];
        let (plain, _) = folder.drawn(&arguments);
        let (svg, stats) = folder.drawn(&[&arguments[..], &["--shadows"]].concat());
        assert!(svg.contains("data-shadow=\"0\"") && !plain.contains("data-shadow"));
        assert!(stats["shadowed-regions"].as_u64().unwrap() > 3, "{stats}");
        let page = |svg: &str| svg.lines().next().unwrap().to_owned();
        assert_eq!(page(&plain), page(&svg));
    }
}

#[test]
fn what_has_no_effect_is_refused() {
    let folder = SceneFolder::new("refused");
    let painter = ["--algorithm", "painter"];
    let svg = ["-o", "x.svg"];
    for option in [
        &["--lines", "all"][..],
        &["--hidden", "dashed"],
        &["--hidden-max-layers", "2"],
        &["--crease-angle", "9"],
    ] {
        let said = folder.mistake(&[&painter[..], option, &svg].concat());
        assert!(said.contains(option[0]) && said.contains("--algorithm exact"), "{said}");
    }
    let said = folder.mistake(&[&painter[..], &["--stroke", "contour=1"], &svg].concat());
    assert!(said.contains("--stroke smooth=MM"), "{said}");
    assert!(
        folder.mistake(&[&painter[..], &["--simplify", "1"], &svg].concat()).contains("--simplify")
    );
    assert!(folder.mistake(&["--shadows", "-o", "x.svg"]).contains("give --style filled"));
    for file in ["x.dxf", "x.plt"] {
        let said = folder.mistake(&[&painter[..], &["-o", file]].concat());
        assert!(said.contains("choose weiler-atherton or exact; or .svg or .pdf"), "{said}");
    }
    assert!(
        folder.mistake(&["--algorithm", "z-buffer", "-o", "x.svg"]).contains("weiler-atherton")
    );
}

#[test]
fn the_report_compares_all_algorithms() {
    let folder = SceneFolder::new("report");
    let bench =
        ["bench", "--drawings", "--report", ".", "triangle.obj", "--frames", "1", "--quiet"];
    let output = folder.0.run(&bench);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(folder.0.read("drawing-report.md")).unwrap();
    for name in ["exact", "painter", "bsp", "weiler-atherton"] {
        assert_eq!(text.matches(&format!("\n| {name} |")).count(), 6, "{text}");
        let picture =
            String::from_utf8(folder.0.read(&format!("drawing-bars-{name}.svg"))).unwrap();
        assert!(
            text.contains(&format!("drawing-bars-{name}.svg")) && picture.len() < 4000,
            "{picture}"
        );
    }
    let refused = folder.0.run(&["bench", "--report", ".", "triangle.obj"]);
    assert_eq!(refused.status.code(), Some(2));
}
