//! Where pictures go: formats, links, devices, animations, frames on standard output.

use super::*;
use vitral::internals::frame::Plane;
use vitral::internals::io::image::decode;

/// The first bytes of each format.
const STARTS: [(&str, &[u8]); 6] = [
    ("png", b"\x89PNG"),
    ("jpg", b"\xff\xd8\xff"),
    ("ppm", b"P6"),
    ("webp", b"RIFF"),
    ("gif", b"GIF89a"),
    ("apng", b"\x89PNG"),
];

fn decoded(bytes: &[u8]) -> Plane<[u8; 4]> {
    decode(bytes, "picture").unwrap()
}

#[test]
fn the_format_may_be_said() {
    let folder = Folder::new("format");
    for (name, start) in STARTS {
        for output in ["-", "/dev/stdout"] {
            let written = render(&folder, &["builtin:cubs", "-o", output, "--format", name]);
            assert_eq!(code(&written), 0, "{name}: {}", errors(&written));
            assert!(written.stdout.starts_with(start), "{name} {output}");
        }
        assert_eq!(
            code(&render(
                &folder,
                &["builtin:cubs", "-o", "bare", "--format", &name.to_uppercase()]
            )),
            0
        );
        assert!(folder.read("bare").starts_with(start), "{name}");
        assert_eq!(code(&render(&folder, &["builtin:cubs", "-o", &format!("a.{name}")])), 0);
        assert_eq!(folder.read(&format!("a.{name}")), folder.read("bare"), "{name}");
    }
    assert_eq!(
        decoded(&folder.read("a.webp")),
        decoded(&folder.read("a.png")),
        "WebP loses nothing"
    );
    let depth =
        render(&folder, &["builtin:cubs", "--channel", "depth", "-o", "-", "--format", "npy"]);
    assert!(depth.stdout.starts_with(b"\x93NUMPY"));
    for (arguments, expected, said) in [
        (&["-o", "bare2"][..], 4, "hint: add --format png"),
        (&["-o", "a.png", "--format", "npy"], 4, "the channel color cannot be written as NPY"),
        (&["-o", "a.png", "--format", "tiff"], 2, "invalid value 'tiff'"),
        (&["-o", "a.gif", "--channel", "depth"], 4, "the channel depth cannot be written as GIF"),
        (
            &["-o", "a.jpg", "--no-background", "--format", "jpg"],
            2,
            "JPEG files cannot be transparent",
        ),
    ] {
        let output = render(&folder, &[&["builtin:cubs"], arguments].concat());
        assert_eq!(code(&output), expected, "{arguments:?}: {}", errors(&output));
        assert!(errors(&output).contains(said), "{arguments:?}: {}", errors(&output));
    }
}

#[cfg(unix)]
#[test]
fn devices_and_links_are_written_to() {
    let folder = Folder::new("devices");
    for arguments in [
        &["-o", "/dev/null"][..],
        &["-o", "/dev/null", "--turntable", "3"],
        &["-o", "/dev/null", "--channel", "color", "--channel", "depth", "-o", "/dev/null"],
    ] {
        let output = render(&folder, &[&["builtin:cubs"], arguments].concat());
        assert_eq!(code(&output), 0, "{arguments:?}: {}", errors(&output));
    }
    std::os::unix::fs::symlink("new.png", folder.0.join("link.png")).unwrap();
    for _ in 0..2 {
        assert_eq!(code(&render(&folder, &["builtin:cubs", "-o", "link.png"])), 0);
        assert!(folder.read("new.png").starts_with(b"\x89PNG"));
        assert!(std::fs::symlink_metadata(folder.0.join("link.png")).unwrap().is_symlink());
    }
    std::os::unix::fs::symlink("no/new.png", folder.0.join("lost.png")).unwrap();
    let output = render(&folder, &["builtin:cubs", "-o", "lost.png"]);
    assert!(
        code(&output) == 5 && errors(&output).contains("there is no folder `no`"),
        "{}",
        errors(&output)
    );
}

#[test]
fn a_turntable_is_an_animation_or_a_stream() {
    let folder = Folder::new("animation");
    let turn = ["builtin:cubs", "--turntable", "3", "--samples", "1"];
    let with = |arguments: &[&str]| {
        let output = render(&folder, &[&turn, arguments].concat());
        assert_eq!(code(&output), 0, "{arguments:?}: {}", errors(&output));
        output.stdout
    };
    with(&["-o", "f{frame}.png"]);
    let frames = [0, 1, 2].map(|number| folder.read(&format!("f{number}.png")));

    // One after the other on standard output.
    assert!(with(&["-o", "-"]) == frames.concat());
    assert!(with(&["-o", "/dev/stdout", "--frames", "1-2"]) == frames[1..].concat());

    // Animations: the pictures and their times.
    for (name, count) in
        [("a.apng", &b"acTL\0\0\0\x03"[..]), ("a.webp", b"ANMF"), ("a.gif", b"NETSCAPE2.0")]
    {
        with(&["-o", name, "--frame-rate", "10"]);
        let bytes = folder.read(name);
        assert!(bytes.windows(count.len()).any(|w| w == count), "{name}");
        let first = decoded(&bytes);
        if name == "a.gif" {
            assert_eq!((first.width(), first.height()), (64, 48));
            let controls =
                bytes.windows(6).filter(|w| w[..3] == [0x21, 0xf9, 4] && w[4..] == [10, 0]).count();
            assert_eq!(controls, 3, "each is shown for ten hundredths of a second");
        } else {
            assert_eq!(first, decoded(&frames[0]), "{name}");
        }
    }
    let webp = folder.read("a.webp");
    assert_eq!(webp.windows(4).filter(|w| *w == b"ANMF").count(), 3);
    assert_eq!(webp.len(), 8 + u32::from_le_bytes(webp[4..8].try_into().unwrap()) as usize);
    with(&["-o", "g{frame}.gif", "--frames", "1-2"]);
    assert!(folder.has("g1.gif") && folder.has("g2.gif"));

    // Steps of an algorithm.
    let steps = [
        "builtin:cubs",
        "--visibility",
        "warnock",
        "--steps-video",
        "s.gif",
        "--steps-frames",
        "4",
    ];
    let output = render(&folder, &steps);
    assert_eq!(code(&output), 0, "{}", errors(&output));
    assert!(folder.read("s.gif").windows(11).any(|w| w == b"NETSCAPE2.0"));

    for (arguments, said) in [
        (&["-o", "one.png", "--turntable", "2"][..], "or write a .gif, .webp or .apng"),
        (&["-o", "one.png", "--frame-rate", "9"], "--frame-rate: no animation is written"),
        (
            &["-o", "one.gif", "--turntable", "2", "--frame-rate", "0"],
            "a number from 0.1 to 100 is required",
        ),
        (&["-o", "one.gif", "--turntable", "2", "--reference", "f0.png"], "--reference"),
    ] {
        let output = render(&folder, &[&["builtin:cubs"], arguments].concat());
        assert_eq!(code(&output), 2, "{arguments:?}: {}", errors(&output));
        assert!(errors(&output).contains(said), "{arguments:?}: {}", errors(&output));
    }
}
