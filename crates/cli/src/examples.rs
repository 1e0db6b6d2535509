//! Examples of each verb, for its help and its manual page.

/// A command line, and what it does.
pub(crate) type Example = (&'static str, &'static str);

/// The examples of each verb; the first row is that of the command.
const EXAMPLES: [(&str, &[Example]); 14] = [
    (
        "vitral",
        &[
            ("vitral builtin:teapot -o teapot.png", "A picture of a scene that needs no file."),
            ("vitral part.stl -o part.svg", "A drawing: the extension says which."),
            ("vitral *.stl -o '{model}.png'", "A picture of each model."),
        ],
    ),
    (
        "render",
        &[
            ("vitral render builtin:scene0 -o scene.png --shadows map", "Shadows by shadow maps."),
            (
                "vitral render builtin:cornell -o box.png --global radiosity",
                "Light from other surfaces.",
            ),
            ("vitral render builtin:cubs -o turn.gif --turntable 36", "An animation of 36 views."),
            (
                "vitral render builtin:cubs -o - --turntable 36 | ffmpeg -f image2pipe -i - turn.mp4",
                "One PNG after the other, for another program.",
            ),
            ("vitral render builtin:cubs -o d.npy --channel depth", "Depths as numbers."),
        ],
    ),
    (
        "draw",
        &[
            (
                "vitral draw builtin:scene0 -o scene.svg --hidden dashed",
                "Visible lines, hidden ones dashed.",
            ),
            (
                "vitral draw builtin:scene1 -o steps.pdf --style filled --page A4",
                "Visible regions on a sheet.",
            ),
        ],
    ),
    (
        "batch",
        &[
            (
                "vitral batch jobs.jsonl --shard 1/8",
                "An eighth of many jobs; what is done already is skipped.",
            ),
            (
                "vitral batch --glob 'models/**/*.stl' -o 'thumbs/{model}.png'",
                "A picture of each file that matches.",
            ),
        ],
    ),
    ("lab", &[("vitral lab builtin:scene0", "The Lab, with a scene to begin with.")]),
    ("info", &[("vitral info builtin:scene0 --json", "What is in a scene, for programs.")]),
    (
        "thumbnail",
        &[(
            "vitral thumbnail part.stl part.png 256",
            "A picture of 256 x 256 pixels on a transparent background.",
        )],
    ),
    (
        "compare",
        &[(
            "vitral compare a.png b.png --threshold 0.02 --diff d.png",
            "How far two pictures are apart.",
        )],
    ),
    ("bench", &[("vitral bench builtin:cubs --frames 3", "Time and counters of each algorithm.")]),
    ("algorithms", &[("vitral algorithms", "All algorithms, with their sources.")]),
    ("formats", &[("vitral formats", "All formats and built-in scenes.")]),
    (
        "osmesa-env",
        &[("eval \"$(vitral osmesa-env)\"", "Programs that are started next draw with vitral.")],
    ),
    ("completions", &[("vitral completions bash > vitral.bash", "Completions for bash.")]),
    ("man", &[("vitral man /usr/share/man/man1", "A page for each verb.")]),
];

/// The examples of a verb, or of the command.
pub(crate) fn of(verb: &str) -> &'static [Example] {
    EXAMPLES.iter().find(|row| row.0 == verb).map_or(&[], |row| row.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args;

    #[test]
    fn each_verb_has_examples_that_the_command_line_takes() {
        let command = args::command();
        for verb in command.get_subcommands().filter(|verb| !verb.is_hide_set()) {
            assert!(EXAMPLES.iter().any(|row| row.0 == verb.get_name()), "{}", verb.get_name());
        }
        for (line, _) in EXAMPLES.iter().flat_map(|row| row.1) {
            // What a shell would make of it, up to the first pipe.
            let words = line
                .split_whitespace()
                .map(|word| word.trim_matches('\''))
                .take_while(|w| !["|", ">"].contains(w));
            let typed: Vec<std::ffi::OsString> = words.map(Into::into).collect();
            if typed[0] == "vitral" {
                let parsed = args::command().try_get_matches_from(args::with_verb(typed));
                assert!(parsed.is_ok(), "{line}: {}", parsed.unwrap_err());
            }
        }
    }
}
