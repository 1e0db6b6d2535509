//! What `--environment` names: a kind, or a file with an image of the surroundings.

use vitral::Environment;

/// See the module.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum EnvironmentSource {
    Kind(Environment),
    File(String),
}

/// Reads a kind by its name; all else is a file.
pub(crate) fn parse(text: &str) -> Result<EnvironmentSource, String> {
    let kind = Environment::ALL.iter().find(|(_, name, _)| name.eq_ignore_ascii_case(text));
    match kind {
        Some((kind, ..)) => Ok(EnvironmentSource::Kind(*kind)),
        None if text.contains(['.', '/', '\\']) => Ok(EnvironmentSource::File(text.to_owned())),
        None => Err(format!(
            "there is no environment of this name: {}, or a file such as studio.hdr",
            names()
        )),
    }
}

/// The help of `--environment`.
pub(crate) fn help() -> String {
    let kinds = Environment::ALL
        .iter()
        .map(|(_, name, what)| format!("{name} ({what})"))
        .collect::<Vec<_>>();
    format!(
        "What surfaces of metal and with roughness (glTF, MTL's Pr and Pm) mirror: {}; or an image of all directions, .hdr .exr .png \
         .jpg, twice as wide as high, which lights them as well and is seen by rays that mirrors and glass turn (--light-intensity \
         multiplies it) [default: auto]",
        kinds.join(", ")
    )
}

fn names() -> String {
    Environment::ALL.iter().map(|row| row.1).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_and_files_are_told_apart() {
        assert_eq!(parse("Sky"), Ok(EnvironmentSource::Kind(Environment::Sky)));
        assert_eq!(parse("sky.hdr"), Ok(EnvironmentSource::File("sky.hdr".to_owned())));
        assert_eq!(parse("./sky"), Ok(EnvironmentSource::File("./sky".to_owned())));
        assert!(parse("studio").unwrap_err().contains("auto, sky, none, or a file"));
    }
}
