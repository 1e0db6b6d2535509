//! Help texts that several verbs share.

/// The end of every help text.
pub(crate) const EXIT_CODES: &str = "Exit codes: 0 done, 1 other failure, 2 usage, 3 input missing or malformed, \
    4 format or feature not supported, 5 cannot write, 6 images differ, 7 a limit was reached, 130 interrupted";

/// The help of MODEL.
pub(crate) fn model_help() -> String {
    let names: Vec<_> = vitral::builtin_names().iter().map(|(name, _)| *name).collect();
    format!(
        "Model files, `-` for standard input, which may name files in the current folder, or `builtin:NAME`, a scene that needs \
         no file; `vitral formats` tells what each shows: {}",
        names.join(", ")
    )
}
