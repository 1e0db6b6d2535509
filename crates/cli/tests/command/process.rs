//! The process: memory, threads, progress, streams, the manual.

use super::*;

/// `vitral ARGUMENTS` by a shell, after `before`.
#[cfg(target_os = "linux")]
fn by_shell(folder: &Folder, before: &str, arguments: &str) -> Output {
    let mut command = Command::new("sh");
    command.args([
        "-c",
        &format!("{before}; exec \"$0\" {arguments}"),
        env!("CARGO_BIN_EXE_vitral"),
    ]);
    command
        .current_dir(&folder.0)
        .env("XDG_CONFIG_HOME", &folder.0)
        .stdin(Stdio::null())
        .output()
        .unwrap()
}

#[cfg(target_os = "linux")]
#[test]
fn memory_that_runs_out_is_a_limit() {
    let folder = Folder::new("memory");
    // 200 MB of addresses hold the program, but not a picture of 12000 x 12000 pixels.
    let large = "builtin:cubs -o x.png --resolution 12000x12000 --threads 1";
    let output = by_shell(&folder, "ulimit -v 200000", large);
    let told = errors(&output);
    assert_eq!(code(&output), 7, "{told}");
    assert!(told.starts_with("vitral: the system has no memory left: "), "{told}");
    assert!(
        told.contains("more bytes were asked for\nhint: ") && told.lines().count() == 2,
        "{told}"
    );
    let small = by_shell(
        &folder,
        "ulimit -v 200000",
        "builtin:cubs -o y.png --resolution 64x48 --threads 1",
    );
    assert_eq!(code(&small), 0, "{}", errors(&small));
}

/// A black PNG of a bit a pixel.
fn large_png(side: u32) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, side, side);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::One);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&vec![0; (side.div_ceil(8) * side) as usize]).unwrap();
    writer.finish().unwrap();
    file
}

#[test]
fn limits_hold_while_files_are_read() {
    let folder = Folder::new("read-limits");
    let mesh = "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";
    folder.file("m.mtl", "newmtl m\nKd 1 1 1\nmap_Kd large.png\n");
    folder.file("a.obj", mesh);
    folder.file("large.png", large_png(16_000));
    for verb in ["render", "draw"] {
        let out = if verb == "draw" { "x.svg" } else { "x.png" };
        let output = folder.run(&[verb, "a.obj", "-o", out, "--max-memory", "100M"]);
        let told = errors(&output);
        assert_eq!(code(&output), 7, "{verb}: {told}");
        assert!(
            told.contains("loading needs ")
                && told.contains("the memory limit is 104857600\nhint: "),
            "{told}"
        );
    }
    folder.file("large.png", large_png(16));
    let small =
        render(&folder, &["a.obj", "-o", "x.png", "--max-memory", "100M", "--time-limit", "60"]);
    assert_eq!(code(&small), 0, "{}", errors(&small));

    // A pipe that nobody writes to ends with the time, and so does a file that takes longer to
    // read.
    let mut child = folder.command(&["render", "-", "-o", "x.png", "--time-limit", "0.3"]);
    let mut child = child.stdin(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let held = child.stdin.take();
    let output = child.wait_with_output().unwrap();
    drop(held);
    assert_eq!(code(&output), 7);
    assert!(
        errors(&output).contains("the time limit of 0.3 s was reached during loading"),
        "{}",
        errors(&output)
    );
    let facets = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    folder.file("large.stl", format!("solid a\n{}endsolid a\n", facets.repeat(200_000)));
    let output = render(&folder, &["large.stl", "-o", "x.png", "--time-limit", "0.01"]);
    assert_eq!(code(&output), 7);
    assert!(
        errors(&output).contains("the time limit of 0.01 s was reached during "),
        "{}",
        errors(&output)
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_closed_standard_output_is_an_error() {
    let folder = Folder::new("closed");
    for arguments in [
        "info builtin:cubs",
        "info builtin:cubs --json",
        "formats",
        "builtin:cubs -o -",
        "--help",
        "man",
    ] {
        let output = by_shell(&folder, "exec >&-", arguments);
        assert_eq!(code(&output), 5, "{arguments}: {}", errors(&output));
        assert!(
            errors(&output).contains("standard output: it is closed"),
            "{arguments}: {}",
            errors(&output)
        );
    }
    assert_eq!(code(&by_shell(&folder, "exec >&-", "builtin:cubs -o x.png --resolution 64x48")), 0);
    assert_eq!(code(&by_shell(&folder, "exec >/dev/null", "info builtin:cubs")), 0);
}

#[test]
fn empty_variables_count_as_unset() {
    let folder = Folder::new("empty-variables");
    let mut command = folder.command(&["builtin:cubs", "-o", "x.png", "--resolution", "64x48"]);
    let output = command.env("VITRAL_THREADS", "").env("VITRAL_SIMD", "").output().unwrap();
    assert_eq!(code(&output), 0, "{}", errors(&output));
}

#[test]
fn progress_tells_per_cent_and_the_time_left() {
    let folder = Folder::new("progress");
    for (global, stage) in [("ray-trace", "ray tracing"), ("radiosity", "radiosity")] {
        let arguments = [
            "builtin:cornell",
            "-o",
            "x.png",
            "--global",
            global,
            "--progress",
            "always",
            "--resolution",
            "160x120",
        ];
        let told = errors(&folder.run(&arguments));
        let lines: Vec<&str> =
            told.lines().filter(|line| line.starts_with(&format!("vitral: {stage}: "))).collect();
        assert!(lines.len() > 2 && lines.iter().all(|line| line.contains(" %")), "{told}");
        assert!(lines.iter().any(|line| line.ends_with(" left")), "{told}");
    }
    let turned = errors(&render(
        &folder,
        &["builtin:cubs", "-o", "{frame}.png", "--turntable", "4", "--progress", "always"],
    ));
    assert!(
        turned.contains("vitral: frame 1 of 4, 25 %, ") && turned.contains("frame 4 of 4, 100 %"),
        "{turned}"
    );
}

#[test]
fn verbose_says_where_the_time_went() {
    let folder = Folder::new("verbose");
    let told = errors(&render(&folder, &["builtin:cubs", "-o", "x.png", "-v"]));
    let times = told.lines().find(|line| line.starts_with("vitral: time: ")).unwrap_or_default();
    assert!(
        times.contains("load ") && times.contains("frames ") && times.contains("encode "),
        "{told}"
    );
}

#[test]
fn numbers_in_json_have_the_digits_of_the_file() {
    let folder = Folder::new("digits");
    let text = "newmtl m\nKd 0.8 0.1 0.3\nNs 10\n";
    folder.file("m.mtl", text);
    folder.file("a.obj", "mtllib m.mtl\nusemtl m\nv 0.1 0 0\nv 1 0 0\nv 0 1.7 0\nf 1 2 3\n");
    let output = folder.run(&["info", "a.obj", "--json"]);
    let told = String::from_utf8(output.stdout).unwrap();
    let long = |word: &str| word.trim_matches(|c: char| !c.is_ascii_digit()).len() > 12;
    assert!(!told.split_whitespace().any(long), "{told}");
    let json =
        folder.run(&["render", "builtin:cubs", "-o", "x.png", "--pixel", "400,300", "--json"]);
    assert!(!String::from_utf8(json.stdout).unwrap().contains("0.800000011920929"));
}

#[test]
fn the_manual_has_a_page_for_each_verb() {
    let folder = Folder::new("manual");
    assert_eq!(code(&folder.run(&["man", "pages"])), 0);
    let page = |name: &str| String::from_utf8(folder.read(&format!("pages/{name}.1"))).unwrap();
    for name in ["vitral", "vitral-render", "vitral-draw", "vitral-info", "vitral-man"] {
        let text = page(name);
        for section in
            ["NAME", "SYNOPSIS", "\"EXIT STATUS\"", "ENVIRONMENT", "EXAMPLES", "\"SEE ALSO\""]
        {
            assert!(text.contains(&format!(".SH {section}\n")), "{name}: {section}");
        }
    }
    assert!(
        page("vitral").contains("vitral\\-render (1)")
            && page("vitral-render").contains("VITRAL_THREADS")
    );
    assert!(
        page("vitral-render").contains("\\-\\-visibility")
            && !page("vitral-info").contains("\\-\\-visibility")
    );
    let whole = String::from_utf8(folder.run(&["man"]).stdout).unwrap();
    assert!(whole.starts_with(&page("vitral")) && whole.contains(&page("vitral-draw")));
    let help = String::from_utf8(folder.run(&["render", "--help", "all"]).stdout).unwrap();
    assert!(!help.contains("course's arithmetic") && !help.contains("exercise 5.2"));
}
