//! What help texts of several verbs share: headings, the options that most people need, texts.

use clap::{Arg, ArgAction, Command};

/// The end of every help text.
pub(crate) const EXIT_CODES: &str = "Exit codes: 0 done, 1 other failure, 2 usage, 3 input missing or malformed, \
    4 format or feature not supported, 5 cannot write, 6 images differ, 7 a limit was reached, 130 interrupted";

/// Widest help text, in columns.
pub(crate) const WIDTH: usize = 100;

// Headings of the groups.
pub(crate) const OUTPUT: &str = "Output";
pub(crate) const ANIMATION: &str = "Animation";
pub(crate) const PICTURE: &str = "Picture";
pub(crate) const ALGORITHMS: &str = "Algorithms";
pub(crate) const TRANSPARENCY: &str = "Transparency";
pub(crate) const SHADOWS: &str = "Shadows";
pub(crate) const GLOBAL: &str = "Global illumination";
pub(crate) const LINES: &str = "Lines";
pub(crate) const SURFACES: &str = "Surfaces";
pub(crate) const LIGHTS: &str = "Lights";
pub(crate) const MATERIALS: &str = "Materials";
pub(crate) const SECTIONS: &str = "Sections";
pub(crate) const PAGE: &str = "Page";
pub(crate) const CAMERA: &str = "Camera";
pub(crate) const LAB3D: &str = "Lab3D";
pub(crate) const FILES: &str = "Files";
pub(crate) const LIMITS: &str = "Limits";
pub(crate) const REPORTS: &str = "Reports";
pub(crate) const MEASUREMENT: &str = "Measurement";

/// The options that most people need, of each verb that shows its options by groups.
pub(crate) const ESSENTIAL: [(&str, &[&str]); 3] = [
    (
        "render",
        &[
            "output",
            "resolution",
            "samples",
            "background_color",
            "no_background",
            "turntable",
            "visibility",
            "shading",
            "shadows",
            "global",
            "edges",
            "view",
            "up",
        ],
    ),
    (
        "draw",
        &[
            "output",
            "style",
            "lines",
            "hidden",
            "color_by",
            "shadows",
            "section_plane",
            "page",
            "scale",
            "views",
            "view",
            "up",
            "perspective",
        ],
    ),
    ("bench", &["visibility", "resolution", "samples", "frames", "report", "time_limit", "json"]),
];

/// The help of MODEL.
pub(crate) fn model_help() -> &'static str {
    "Model files, `-` for standard input, or `builtin:NAME`, a scene that needs no file; `vitral formats` lists both"
}

/// The help of MODEL at length, with the names of scenes.
pub(crate) fn model_long_help() -> String {
    let names: Vec<_> = vitral::builtin_names().iter().map(|(name, _)| *name).collect();
    format!(
        "Model files, `-` for standard input, which may name files in the current folder, or `builtin:NAME`, a scene that needs \
         no file; `vitral formats` says what each shows: {}",
        names.join(", ")
    )
}

/// The definition of a verb with the option of help that knows groups, if the verb shows its
/// options by groups.
pub(crate) fn with_groups(verb: Command) -> Command {
    if essential(verb.get_name()).is_none() {
        return verb;
    }
    let about = "Print the help: a summary, or one of the groups of options as in `--help camera`; -h is shorter";
    let help = Arg::new("help")
        .short('h')
        .long("help")
        .action(ArgAction::Help)
        .help(about)
        .help_heading(REPORTS);
    verb.disable_help_flag(true).arg(help)
}

/// The options of a verb that most people need; `None`: the verb does not show its options by
/// groups.
pub(crate) fn essential(verb: &str) -> Option<&'static [&'static str]> {
    ESSENTIAL.iter().find(|row| row.0 == verb).map(|row| row.1)
}
