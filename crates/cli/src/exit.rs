//! What an error of the library means for the command: its exit code, and the hint that is shown
//! below it.

use crate::similar;
use vitral::internals::raster::MAX_SIDE;
use vitral::{Error, InputError, Limit, RenderError, SettingsError};

/// The exit code of a command that ends with this error: 2 usage, 3 input missing or malformed, 4
/// not supported, 5 cannot write, 7 a limit was reached, 130 interrupted, 1 anything else.
pub(crate) fn exit_code(error: &Error) -> u8 {
    match error {
        Error::Usage { .. } | Error::Sheet(_) => 2,
        Error::Read { .. } | Error::State { .. } => 3,
        Error::Unsupported { .. } => 4,
        Error::Write { .. } => 5,
        Error::TooLarge { .. } => 7,
        Error::Input(error) => match error {
            InputError::Malformed { .. } | InputError::Missing { .. } => 3,
            InputError::Unsupported { .. } | InputError::Encode { .. } => 4,
            _ => 1,
        },
        Error::Render(error) => match error {
            RenderError::Settings(SettingsError::Resolution { width, height }) => {
                if *width.max(height) > MAX_SIDE { 7 } else { 2 }
            }
            RenderError::Settings(_) => 2,
            RenderError::World(_) | RenderError::Scene(_) | RenderError::Radiosity(_) => 3,
            RenderError::Limit(Limit::Cancelled { .. }) => 130,
            RenderError::Limit(_) => 7,
            _ => 1,
        },
        _ => 1,
    }
}

/// What the user may do about it, if there is something to say.
pub(crate) fn hint(error: &Error) -> Option<String> {
    let text = match error {
        Error::Usage { hint, .. } | Error::Unsupported { hint, .. } => hint.clone(),
        Error::Read { path, source } if source.kind() == std::io::ErrorKind::NotFound => {
            return similar::for_missing(path);
        }
        Error::Input(InputError::Missing { why, .. }) if why.contains("outside") => {
            "if you trust the model, --allow-external lets it read files outside its folder".to_owned()
        }
        Error::Render(RenderError::Settings(SettingsError::ListOrder { .. })) => {
            "--visibility bsp or painter makes a list".to_owned()
        }
        Error::Render(RenderError::Settings(SettingsError::Translucent { material, .. })) => {
            format!("or --material {material}.transmission=transparent")
        }
        Error::Render(RenderError::Settings(SettingsError::OrderOfRays(_))) => {
            "leave out --transparency-order, or --global ray-trace".to_owned()
        }
        Error::Render(RenderError::Limit(Limit::Memory { .. })) => {
            "fewer samples, a smaller resolution, or in drawings fewer classes of --lines need less memory".to_owned()
        }
        Error::Render(RenderError::Limit(Limit::Segments { .. })) => {
            "draw fewer classes of --lines, or raise --max-segments".to_owned()
        }
        _ => String::new(),
    };
    Some(text).filter(|t| !t.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;
    use vitral::internals::{exec::Achieved, io::Place};

    #[test]
    fn every_kind_has_the_exit_code_of_the_table() {
        let not_found = || std::io::Error::from(std::io::ErrorKind::NotFound);
        let path = PathBuf::from("nowhere-at-all.obj");
        let read = Error::Read { path: path.clone(), source: not_found() };
        assert_eq!(exit_code(&read), 3);
        assert_eq!(hint(&read), None);
        assert_eq!(exit_code(&Error::Write { path: path.clone(), source: not_found() }), 5);
        assert_eq!(exit_code(&Error::TooLarge { path, limit: 9 }), 7);
        let code_of_io = |e: InputError| exit_code(&e.into());
        assert_eq!(code_of_io(InputError::malformed("f", Place::Line(3), "x")), 3);
        assert_eq!(code_of_io(InputError::Unsupported { file: "f".into(), what: "x".into() }), 4);
        let size = |width, height| {
            let error = RenderError::Settings(SettingsError::Resolution { width, height });
            exit_code(&error.into())
        };
        assert_eq!((size(0, 5), size(1, 99_999)), (2, 7));
        assert_eq!(exit_code(&Limit::Cancelled { stage: "x" }.into()), 130);
        assert_eq!(
            exit_code(
                &Limit::Time { limit: 1.0, stage: "x", achieved: Achieved::default() }.into()
            ),
            7
        );
    }

    #[test]
    fn hints_name_the_options_that_help() {
        let of = |error: SettingsError| hint(&RenderError::from(error).into()).unwrap();
        let list = SettingsError::ListOrder {
            visibility: vitral::Visibility::Z_BUFFER,
            choices: "painter, bsp".into(),
        };
        assert!(of(list).contains("--visibility"));
        let translucent = SettingsError::Translucent {
            material: "pane".into(),
            order: "two-buffer",
            choices: "a-buffer".into(),
        };
        assert!(of(translucent).contains("pane.transmission=transparent"));
        assert!(of(SettingsError::OrderOfRays("sorted")).contains("--transparency-order"));
    }
}
